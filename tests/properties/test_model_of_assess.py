"""A model of what assess concludes, over random tables of rows: verdict, ranking and folders follow from the rows."""

import itertools
import math
import tempfile
from pathlib import Path

import numpy as np
from assess_model import FACTORS, QUICK, TABLES, concluded
from hypothesis import given, settings
from hypothesis import strategies as st

from extrados.analyses.assess.hazard import Demanded
from extrados.results.assess import StrategyVerdict
from extrados.running.survey import Assessed, decks_of


def turns(row: StrategyVerdict) -> float:
    """The least factor on the hazard at which a row may turn to collapse, as it says."""
    if row.margin is not None:
        return row.margin
    known = row.margin_at_least if row.outcome == "stands" else row.margin_below
    return math.inf if known is None else known


@QUICK
@given(TABLES)
def test_the_overall_answer_follows_from_the_rows(table: list[StrategyVerdict]) -> None:
    found = concluded(table)
    judged = {row.outcome for row in table if row.status == "ok"} - {"not-applicable"}
    if "cannot-stand" in judged:
        want = "cannot stand"
    elif {"stands", "collapses"} <= judged:
        want = "depends"
    elif judged == {"stands"} or judged == {"collapses"}:
        want = f"{judged.pop()} under all"
    else:
        want = "open"
    assert found.overall == want
    verdict = found.judged(Demanded(0.2, "sine", 0.4, 0.2))
    assert verdict.outcome == {"stands under all": "stands", "collapses under all": "collapses", "cannot stand": "cannot-stand"}.get(
        want, "open"
    )
    for row in table:
        if row.status == "ok" and row.outcome != "not-applicable" and (len(judged) > 1 or want == "open"):
            assert row.label in found.statement or (want == "cannot stand" and row.outcome == "collapses")
        if row.status != "ok":
            assert row.label in found.statement
    assert [(r.strategy, r.outcome) for r in found.verdicts] == [(r.strategy, r.outcome) for r in table]


@QUICK
@given(TABLES)
def test_the_least_margin_is_that_of_the_rows(table: list[StrategyVerdict]) -> None:
    found = concluded(table)
    known = {row.strategy: turns(row) for row in table if row.status == "ok" and row.outcome != "not-applicable"}
    least = min(known.values(), default=math.inf)
    if least == math.inf:
        assert found.least_margin is None and found.least_margin_strategy is None
    else:
        assert found.least_margin == least and known[found.least_margin_strategy] == least
        assert found.overall != "stands under all" or least >= 1.0
        assert found.overall not in ("collapses under all", "cannot stand") or least <= 1.1


@QUICK
@given(TABLES)
def test_agreement_and_reasons_follow_from_the_rows(table: list[StrategyVerdict]) -> None:
    found = concluded(table)
    judged = {row.strategy: row for row in table if row.status == "ok" and row.outcome != "not-applicable"}
    assert set(found.agreement) == set(judged)
    differing = set()
    for a, b in itertools.combinations(judged, 2):
        one, other = judged[a], judged[b]
        said = found.agreement[a][b]
        assert said == found.agreement[b][a]
        collapse = {"collapses", "cannot-stand"}
        alike = one.outcome == other.outcome or {one.outcome, other.outcome} == collapse
        if not alike:
            assert said == ("open" if "open" in (one.outcome, other.outcome) else "disagree")
        else:
            assert said in ("agree", "apart")
        if said != "agree":
            differing.add(frozenset((a, b)))
    explained = {frozenset(pair) for reason in found.reasons for pair in reason.explains}
    assert explained <= differing
    assert {frozenset(pair) for pair in found.unexplained} == differing - explained


OVERALL = st.sampled_from(["stands under all", "collapses under all", "cannot stand", "depends", "open"])


BUILDINGS = st.builds(
    lambda overall, margin, status: Assessed(
        "a", overall if status == "ok" else "", margin if status == "ok" else np.nan, "", status, "", Path()
    ),
    OVERALL,
    st.just(np.nan) | FACTORS,
    st.sampled_from(["ok", "ok", "failed", "refused"]),
)


@QUICK
@given(st.lists(BUILDINGS, max_size=8))
def test_a_ranking_puts_the_worst_first(buildings: list[Assessed]) -> None:
    ranked = sorted(buildings, key=lambda b: b.order)
    for worse, better in itertools.pairwise(ranked):
        assert better.overall != "cannot stand" or worse.overall == "cannot stand"
        if worse.overall == "stands under all" and not np.isfinite(worse.least_margin):
            assert better.overall == "stands under all" and not np.isfinite(better.least_margin)
        if np.isfinite(worse.least_margin) and np.isfinite(better.least_margin) and "cannot stand" not in (worse.overall, better.overall):
            assert worse.least_margin <= better.least_margin
        if np.isfinite(worse.least_margin) and worse.overall != "cannot stand":
            assert np.isfinite(better.least_margin) or better.overall == "stands under all"


@settings(QUICK, max_examples=20)
@given(st.sets(st.sampled_from("abcdef"), min_size=1, max_size=4), st.booleans())
def test_a_folder_is_all_of_its_decks_and_nothing_else(names: set[str], common: bool) -> None:
    with tempfile.TemporaryDirectory() as place:
        structure = '[structure]\nkind = "block"\nwidth = 1.0\nheight = 3.0\n'
        motion = '[motion]\nkind = "sine-pulse"\namplitude = "0.2 g"\nperiod = 0.5\n'
        for name in names:
            (Path(place) / f"{name}.toml").write_text(structure + ("" if common else motion))
            (Path(place) / f"{name}.expect.toml").write_text("no deck")
        if common:
            (Path(place) / "common.toml").write_text(motion)
        tables = '[[analysis]]\nkind = "tilt"\n[[analysis]]\nkind = "assess"\nbudget = 7.0\n[[analysis]]\nkind = "assess"\nbudget = 9.0\n'
        (Path(place) / "several.toml").write_text(structure + motion + tables)
        (Path(place) / "notes.txt").write_text("no deck")
        found = decks_of(Path(place))
    assert list(found) == sorted([*names, "several"])
    assert all("sine-pulse" in text and text.count('kind = "assess"') == 1 and '"tilt"' not in text for text in found.values())
    assert "budget = 7" in found["several"]  # the first of its assessments
