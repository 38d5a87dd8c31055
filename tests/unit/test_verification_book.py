"""Rows of the cases, their origins, the strategies of the verification book, and the table of model uncertainty of the package."""

import re
import sys
from math import exp, log
from pathlib import Path
from statistics import mean, stdev

import pytest

from extrados import kinds
from extrados.results.uncertainty import read_uncertainties, uncertainties_of

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))

import expectations
import verification_book as book

ROWS = [row for case in expectations.load_cases() for row in case.rows]


def found(case: str, quantity: str, kind: str, value: float, result: float, **more) -> book.Found:
    row = expectations.Row(quantity, value, 0.1, True, kind, "TRRL", (), "", **more)
    return book.Found(case, row, result)


def test_every_outside_number_has_an_origin() -> None:
    """Every row but calibrations and regressions; and every entry has rows."""
    missing = [row for row in ROWS if row.kind not in ("calibration", "regression") and not expectations.origin_of(row)]
    assert missing == []
    used = {str(expectations.origin_of(row)) for row in ROWS}
    assert [o["name"] for o in expectations.origins() if str(o) not in used] == []


def test_rows_called_printed_have_no_assumed_sizes() -> None:
    """The dissertation's numbers count only where its sizes are printed."""
    words = re.compile(r"inferred|guess|assumed|from memory", re.I)
    assert [row for row in ROWS if row.kind == "thesis" and words.search(row.source + row.note)] == []


def test_every_analysis_with_rows_belongs_to_one_strategy() -> None:
    named = [analysis for strategy in book.strategies() for analysis in strategy["analyses"]]
    assert len(named) == len(set(named)) and set(named) <= set(kinds.ANALYSES)
    assert all(book.strategy_of(row) for row in ROWS)
    assert all(strategy["not_covered"] for strategy in book.strategies())


@pytest.mark.parametrize(
    ("row", "fits", "fails"),
    [
        ({"at_least": 1.0, "kind": "bound"}, 1.0, 0.99),
        ({"at_most": 1.0, "kind": "bound"}, -5.0, 1.01),
        ({"value": 2.0, "tolerance": 0.1, "kind": "exact"}, 2.05, 2.2),
    ],
)
def test_bounds_are_one_sided_and_have_no_ratio(row: dict, fits: float, fails: float) -> None:
    made = expectations.read_row({"quantity": "tilt.x", "source": "s", **row}, Path("x"))
    assert made.fits(fits) and not made.fits(fails)
    assert (book.Found("x", made, fits).ratio is None) == (row["kind"] == "bound")


@pytest.mark.parametrize(
    "row",
    [
        {"kind": "bound", "value": 1.0, "source": "s"},
        {"kind": "bound", "source": "s"},
        {"kind": "exact", "value": 1.0, "at_least": 0.0, "source": "s"},
        {"kind": "experiment", "value": 1.0, "source": "no scatter"},
        {"kind": "exact", "value": 1.0, "tolerance": 0.2, "source": "a wide row without its reason"},
        {"kind": "exact", "value": 1.0, "tolerance": 0.01, "source": "s", "wide": "a reason of no need"},
        {"kind": "regression", "value": 1.0, "source": "s"},
    ],
)
def test_a_row_that_lacks_what_its_kind_needs_is_refused(row: dict) -> None:
    with pytest.raises(ValueError, match=r"bad row|wide"):
        expectations.read_row({"quantity": "tilt.x", **row}, Path("x"))


def test_bias_and_scatter_by_hand() -> None:
    """Inferred sizes, calibrations, bounds and regressions do not enter."""
    quantity = "moving-load.collapse_load_N"
    ratios = (0.5, 2.0, 1.2)
    rows = [found(f"c{i}", quantity, "experiment", 10.0, 10.0 * r) for i, r in enumerate(ratios)]
    rows += [found("no", quantity, kind, 10.0, 90.0) for kind in ("inferred", "calibration", "regression")]
    (line,) = book.statistics_of(rows)
    logs = [log(r) for r in ratios]
    assert (line["count"], line["worst_ratio"]) == (3, "0.5000")
    assert [float(line[k]) for k in ("bias", "scatter")] == pytest.approx([exp(mean(logs)), stdev(logs)], abs=1e-4)


def test_the_package_has_the_scatter_of_the_bridges() -> None:
    """The table is that of the tests: six bridges, computed over measured."""
    (bridges,) = uncertainties_of("moving-load")
    assert (bridges.count, bridges.strategy) == (6, "live load on bridges")
    assert bridges.bias == pytest.approx(0.67, abs=0.02) and bridges.scatter == pytest.approx(0.56, abs=0.03)
    assert [row.quantity for row in uncertainties_of("rocking")] == ["restitution"]
    (frames,) = uncertainties_of("frame-pushover")
    assert (frames.count, frames.quantity) == (126, "peak load")
    assert {row.comparison for row in read_uncertainties()} <= set(expectations.PROOFS)


def test_a_series_of_tests_is_judged_by_its_statistics() -> None:
    """A wall of a table is neither wrong nor wide by itself, and enters bias and scatter."""
    quantity = "frame-pushover.peak_load_N"
    row = expectations.Row(quantity, 100.0, 0.1, True, "experiment", "table", (), "failure S", scatter="one test")
    series = [book.Found(f"wall {k}", row, value, series=True) for k, value in enumerate((50.0, 200.0))]
    assert not any(one.wrong for one in series) and book.Found("case", row, 50.0).wrong
    (line,) = book.statistics_of(series)
    assert (line["count"], line["bias"]) == (2, "1.0000")
    assert "±" not in book.line(series[0]) and "differs" not in book.line(series[0])


def test_the_book_states_the_time_of_long_cases() -> None:
    text = "\n".join(book.long_cases({"a/quick": 2.0, "b/long": 75.4, "c/older": 0}))
    assert "| b/long | 75 |" in text and "a/quick" not in text and "c/older" not in text
    assert book.long_cases({}) == []
