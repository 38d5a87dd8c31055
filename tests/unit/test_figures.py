"""Figures can be read: no text is cut by the edge or lies over another. Here a few; of all cases in tests/cases."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from figure_faults import faults, watch_figures

import extrados
from extrados.analyses.assess.hazard import Demanded
from extrados.show import report, style
from extrados.show.sla import near_the_peak

CASES = Path(__file__).resolve().parents[2] / "cases"
#: Quick decks whose figures are unlike each other
SOME = ("vault/vezelay-like", "arch/readme", "rocking/facade", "dem/column", "limit/tied-frame", "codes/facade")


@pytest.mark.parametrize("case", SOME)
def test_figures_can_be_read(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    watch = watch_figures(extrados.run(CASES / f"{case}.toml"), tmp_path, monkeypatch)
    assert watch.found and not watch.wrong


def test_the_test_finds_what_cannot_be_read() -> None:
    with style.figure(3.0, 2.0) as (fig, (ax,)):
        ax.set_title("a title that is far too long for a figure as narrow as this one is")
        ax.text(0.5, 0.5, "under", transform=ax.transAxes)
        ax.text(0.5, 0.5, "over", transform=ax.transAxes)
        fig.get_layout_engine().execute(fig)
        told = faults(fig)
    assert any("is cut" in t for t in told) and any("'under' and 'over' cover" in t for t in told)
    with style.figure(4.0, 3.0) as (fig, (ax,)):
        ax.plot([0, 1], [0, 1], label="line")
        ax.set_title("short")
        ax.legend()
        fig.get_layout_engine().execute(fig)
        assert faults(fig) == []


def test_a_plateau_of_a_mechanism_does_not_shrink_its_curve() -> None:
    """An envelope that goes on for metres is drawn by the way to nearly its greatest load, from where it starts."""
    displacement, load = np.array([0.1, 0.2, 0.3, 50.0]), np.array([0.0, 5.0, 9.9, 10.0])
    assert near_the_peak(displacement, load) == pytest.approx(0.2)
    assert near_the_peak(-displacement, load) == pytest.approx(0.2)
    assert near_the_peak(np.zeros(1), np.zeros(1)) == 0.0


def test_an_ensemble_without_runs_has_no_histogram(tmp_path: Path) -> None:
    """Buildings of the sample that part along their joints rock as nothing: no share, and a report without a histogram."""
    rows = [[0.0, 0.6, 1.2, 2.0], [0.0, 0.3, 0.9, 1.5, 2.0]]
    stones = [
        {"name": f"{k} {n}", "points": [[x, 0.3 * k], [y, 0.3 * k], [y, 0.3 * k + 0.3], [x, 0.3 * k + 0.3]]}
        for k, row in enumerate(rows)
        for n, (x, y) in enumerate(itertools.pairwise(row))
    ]
    run = extrados.run(
        {
            "structure": {"kind": "blocks", "block": stones},
            "motion": {"kind": "sine-pulse", "amplitude": "0.3 g", "period": 0.5},
            "analysis": [{"kind": "fragility", "uncertain": {"imperfection": 0.01}, "count": 3}],
        }
    )
    r = run.results[0].results
    assert r.count == 0 and r.collapse_probability is None and r.judged(Demanded(0.3)).outcome == "open"
    assert all("histogram" not in figure[0] for figures in report.draw(run, tmp_path).values() for figure in figures)
