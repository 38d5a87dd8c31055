"""Associated sliding is an upper bound and says so; states without dilatancy beside it, certified; what cannot stand, proven."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.context import Context
from extrados.analyses.limit import common, tilt
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.certificate import certify
from extrados.limit.coulomb import CoulombProblem
from extrados.limit.errors import NoAnswer
from extrados.limit.programme import LimitAnalysis
from extrados.model.structures.arch import make_arch
from extrados.results.limit import DILATANT, Tilt, judge_interval
from extrados.results.model import Result
from extrados.results.verdict import SelfWeight

THIN = {"kind": "arch", "radius": 10.0, "thickness": 0.5, "embrace": 180.0, "voussoirs": 20}
ARCH = {**THIN, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
WALL = {"kind": "brickwork", "units": 5, "courses": 6, "unit_length": 0.4, "unit_height": 0.175, "begins": "half"}


def coursed(seed: int, courses: int = 4) -> dict[str, Any]:
    """A wall of random courses: 3 to 6 stones each, joints at least 30 mm off those of the course below."""
    draw = np.random.default_rng(seed)
    width, low, stones, below = draw.uniform(1.2, 2.5), 0.0, [], np.array([])
    for _ in range(courses):
        high = low + draw.uniform(0.15, 0.35)
        while True:
            cuts = np.sort(draw.uniform(0.0, width, int(draw.integers(3, 7)) - 1))
            ends = np.concatenate([[0.0], cuts, [width]])
            if np.diff(ends).min() > 0.12 and np.abs(cuts[:, None] - below).min(initial=1.0) > 0.03:
                break
        for left, right in itertools.pairwise(ends.tolist()):
            stones.append({"points": [[left, low], [right, low], [right, high], [left, high]]})
        below, low = cuts, high
    return {"kind": "blocks", "block": stones}


def run(structure: dict[str, Any], friction: Any = 0.65, folder: Path | None = None, **analysis: Any) -> Result:
    deck = make_deck({"structure": structure, "joints": {"friction": friction}, "analysis": analysis}, folder)
    return run_analyses(Context(deck, threads=1))[0]


def asked(peak_g: float) -> Demanded:
    return Demanded(peak_g, "", 0.0, 0.0)


def test_a_sliding_wall_has_an_interval() -> None:
    """Below the design value it stands, above the associated bound it collapses, between them the outcome is open."""
    result = run(coursed(2), kind="tilt")
    r = result.results
    assert isinstance(r, Tilt) and r.dilating_joints and DILATANT in result.answer
    for opposite in (False, True):
        least, most = r.interval(opposite)
        assert least is not None and 0.3 < least < most < 0.65
    assert r.non_dilatant.certified and r.non_dilatant.zero_gap_g < 1e-12
    assert r.non_dilatant.associated_g == pytest.approx(r.collapse_acceleration_g, abs=1e-9)
    assert r.admissible_interval_g == pytest.approx([-r.collapse_acceleration_opposite_g, r.collapse_acceleration_g], abs=1e-9)
    least, most = (min(r.interval(o)[k] for o in (False, True)) for k in (0, 1))
    design = min(r.capacity(o) for o in (False, True))
    assert least - 1e-6 <= design < most
    spread = max(r.non_dilatant.spread_g, r.non_dilatant_opposite.spread_g)
    for peak, outcome in ((0.99 * (least - spread), "stands"), (0.5 * (least + most), "open"), (1.01 * most, "collapses")):
        verdict = r.judged(asked(peak))
        assert (verdict.outcome, verdict.capacity) == (outcome, design) and DILATANT in verdict.statement
        assert verdict.ratio == pytest.approx(design / peak)
        place = {
            "stands": "below the design value",
            "open": "between the design value and the upper bound",
            "collapses": "above the upper bound",
        }
        assert place[outcome] in verdict.statement


def test_a_demand_just_below_the_least_state_is_open() -> None:
    """The least of several states is no lower bound: within their spread below it nothing is decided."""
    verdicts = [judge_interval(0.342, 0.5, 0.03, asked(peak)) for peak in (0.311, 0.313, 0.341, 0.343)]
    assert [v.outcome for v in verdicts] == ["stands", "open", "open", "open"]
    assert "less than the scatter of the values found (0.03 g)" in verdicts[1].statement
    assert all(v.capacity == 0.342 for v in verdicts)
    assert judge_interval(0.342, 0.5, 0.0, asked(0.341)).outcome == "stands"


def test_the_rule_of_the_deck_does_not_change_the_verdict() -> None:
    wall = coursed(1)
    both = [run(wall, kind="tilt", friction_rule=rule).results for rule in ("associated", "non-associated")]
    verdicts = [r.judged(asked(0.56)) for r in both]
    assert verdicts[0] == verdicts[1] and verdicts[0].outcome == "open"
    assert both[1].collapse_acceleration_g == both[0].collapse_acceleration_non_associated_g


def test_no_word_where_nothing_slides() -> None:
    result = run(ARCH, 0.7, kind="tilt")
    assert result.results.dilating_joints == [] and result.results.non_dilatant is None
    assert DILATANT not in result.answer and result.results.judged(asked(0.2)).outcome == "stands"


def test_joints_that_only_part_do_not_dilate() -> None:
    """A column of three drums that turns about an edge, and a wall whose head joints open: friction has no part in it."""
    limit = LimitAnalysis(make_arch(10.0, 1.5, 157.5, 7), 0.7)
    assert limit.dilating(limit.collapse()[1]) == []
    limit = LimitAnalysis(make_arch(10.0, 1.5, 157.5, 7), 0.4)
    assert limit.dilating(limit.collapse()[1])


def test_a_bound_without_a_state_decides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of large walls no state is sought: the bound is told as such, and nothing stands by it."""
    monkeypatch.setattr(common, "MOST_BESIDE", 10)
    r = run(WALL, kind="tilt").results
    assert r.non_dilatant is None and "more than 10 joints" in r.non_associated_reason
    below, above = (r.judged(asked(share * r.collapse_acceleration_g)) for share in (0.5, 1.01))
    assert (below.outcome, below.bound) == ("open", "upper") and DILATANT in below.statement
    assert above.outcome == "collapses"


@pytest.mark.parametrize("senses", [(1, -1), (-1,)])
@pytest.mark.parametrize("followed", [True, False])
def test_without_a_state_of_the_rule_the_bounds_are_given(senses: tuple[int, ...], followed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The upper bound by dilatant friction, the load paths and the reason; the bound alone lets nothing stand."""
    small = {**WALL, "units": 2, "courses": 2}
    bound, least = run(small, 0.3, kind="tilt").results, CoulombProblem.least
    monkeypatch.setattr(CoulombProblem, "least", lambda self, *given: None if self.sense in senses else least(self, *given))
    if not followed:
        monkeypatch.setattr(tilt, "collapse_along_path", given_up)
    result = run(small, 0.3, kind="tilt", friction_rule="non-associated")
    r = result.results
    assert result.status == "ok" and "no collapse state without dilatancy" in r.non_associated_reason and "-0.0" not in result.answer
    assert r.collapse_acceleration_opposite_g == pytest.approx(bound.collapse_acceleration_opposite_g, abs=1e-9)
    assert r.collapse_acceleration_non_associated_opposite_g is None and (r.non_dilatant is None) is (1 in senses)
    verdict = r.judged_towards(asked(0.5 * r.collapse_acceleration_opposite_g), (True,))
    assert r.judged_towards(asked(1.01 * r.collapse_acceleration_opposite_g), (True,)).outcome == "collapses"
    if followed:
        assert r.collapse_acceleration_load_path_opposite_g <= r.collapse_acceleration_opposite_g + 1e-6
        assert verdict.capacity == r.collapse_acceleration_load_path_opposite_g and "no lower value is certified" in verdict.statement
        assert "the design value to -x" in result.answer
    else:
        assert all(row.reason == "given up" for row in r.load_paths_opposite) and r.collapse_acceleration_load_path_opposite_g is None
        assert (verdict.outcome, verdict.bound) == ("open", "upper") and r.non_associated_reason in verdict.statement


def given_up(*given: Any) -> Any:
    """A load path that leads nowhere."""
    raise NoAnswer("given up")


@pytest.mark.parametrize("strength", [None, 2e6])
def test_the_certificate_sees_what_is_wrong(strength: float | None) -> None:
    """Forces and velocities of a state pass; each disturbed alone does not; nor does a dilatant mechanism."""
    building = make_deck({"structure": WALL, "joints": {"friction": 0.65}, "analysis": {"kind": "tilt"}}).building
    assembly = building.blocks()
    limit = LimitAnalysis(assembly, 0.65, associated=False, strength=strength, starts=2)
    state, mechanism = limit.collapse()

    def proof(state, mechanism=mechanism):
        return certify(assembly, limit.loads, 0.65, state, mechanism, strength)

    assert proof(state).holds(state.gamma) and proof(state).zero_gap < 1e-8
    assert not proof(replace(state, gamma=state.gamma + 1e-3)).holds(state.gamma)
    assert proof(replace(state, gamma=state.gamma + 1e-3)).zero_gap == pytest.approx(1e-3, rel=1e-3)
    heavier = state.normal.copy()
    heavier[3] += 1e-3 * limit.loads.scale
    assert proof(replace(state, normal=heavier)).equilibrium > 1e-4
    assert proof(replace(state, position=state.position - 0.6)).tension > 1e-4
    assert proof(state, replace(mechanism, velocity=-mechanism.velocity)).zero_gap > 1e-3
    dilatant = LimitAnalysis(assembly, 0.65, strength=strength)
    assert not proof(*dilatant.collapse()).holds(1.0)


def test_solids_are_labelled() -> None:
    """In space a wall that slides has an upper bound, a design value by load paths and a least state (test_load_path)."""
    sliding, turning = (run(s, f, kind="tilt", direction=0.0, rose=4) for s, f in ((WALL, 0.65), (ARCH, 0.7)))
    assert sliding.results.dilating_contacts and DILATANT in sliding.answer
    assert sliding.results.non_dilatant is None and "without dilatancy is calculated only with" in sliding.results.non_associated_reason, (
        "contacts are many"
    )
    assert sliding.results.judged(asked(0.1)).outcome == "open", "an upper bound alone"
    sliding = run(WALL, 0.65, kind="tilt", direction=0.0, rose=4, friction_rule="non-associated")
    design = min(row.load_path_g for row in sliding.results.non_dilatant)
    assert sliding.results.judged(asked(0.9 * design)).outcome == "stands"
    column = {"kind": "column", "width": 0.8, "height": 4.0, "drums": 2}
    assert run(column, 0.7, kind="tilt", direction=0.0, rose=4).results.dilating_contacts == 0
    assert turning.status == "ok"


def test_sweeps_trains_and_lines_are_labelled() -> None:
    swept = run(ARCH, kind="sweep", vary="joints.friction", values=[0.4, 0.45, 0.6], locate=False)
    assert swept.results.upper_bound_values == [0.4, 0.45] and DILATANT in swept.answer
    assert swept.results.judged(asked(0.1)).bound == "upper"
    train = run(ARCH, 0.3, kind="moving-load", count=11, force=1e5)
    assert train.results.dilating_joints and train.results.judged(asked(0.1)).bound == "upper"
    assert train.results.judged(asked(0.1)).outcome in ("open", "collapses")
    assert run(ARCH, 0.7, kind="moving-load", count=11, force=1e5).results.dilating_joints == []
    line = run(ARCH, 0.4, kind="thrust")
    assert line.results.dilating and DILATANT in line.answer
    assert not run(ARCH, 0.7, kind="thrust").results.dilating


#: The questions of limit analysis about one section
KINDS: list[dict[str, Any]] = [
    {"kind": "tilt"},
    {"kind": "thrust"},
    {"kind": "moving-load"},
    {"kind": "supports"},
    {"kind": "imperfections", "deviation": "5 mm", "count": 10},
    {"kind": "tilt", "friction_rule": "non-associated"},
    {"kind": "tilt", "direction": 0.0},
]


@pytest.mark.parametrize("keys", KINDS, ids=lambda k: "-".join(map(str, k.values())))
def test_what_cannot_stand_is_proven_in_every_question(keys: dict[str, Any]) -> None:
    """A semicircle of t/R .05, of which .107 is the least that stands."""
    result = run(THIN, 0.7, **keys)
    assert result.status == "ok" and isinstance(result.results, SelfWeight), result.reason
    assert "ertificate: " in result.results.certificate
    assert result.results.judged(asked(0.1)).outcome == "cannot-stand"


def test_rows_that_cannot_stand_have_capacity_zero(tmp_path: Path) -> None:
    swept = run(THIN, 0.7, kind="sweep", vary="thickness", values=[0.5, 1.0, 1.2, -1.0, 1.5], locate=False).results
    assert swept.values == [-1.0, 0.5, 1.0, 1.2, 1.5] and swept.collapse_accelerations_g[:3] == [None, 0.0, 0.0]
    assert [gap.status for gap in swept.gaps] == ["no-answer", "cannot-stand", "cannot-stand"]
    assert all("ertificate: a mechanism" in gap.reason for gap in swept.gaps[1:])
    none = run(THIN, 0.7, kind="sweep", vary="thickness", values=[0.5, 0.6])
    assert isinstance(none.results, SelfWeight)
    (tmp_path / "s.csv").write_text("name,thickness\nstout,1.5\nthin,0.5\n")
    survey = run(THIN, 0.7, tmp_path, kind="survey", file="s.csv").results
    assert (survey.weakest, survey.weakest_collapse_acceleration_g, survey.standing) == ("thin", 0.0, 1)
    assert "ertificate: a mechanism" in survey.cannot_stand[0].reason and survey.without_answer == []


def test_partial_factors_may_bring_it_down() -> None:
    """An arch that stands at a friction of 0.7 and not at 0.07: no train is crossed, and none "brings nothing down"."""
    whole = run(ARCH, 0.7, kind="moving-load", count=11)
    reduced = run(ARCH, 0.7, kind="moving-load", count=11, factors={"friction": 10.0})
    assert whole.results.collapse_load_N > 0.0
    assert isinstance(reduced.results, SelfWeight) and "partial factors" in reduced.results.certificate


def test_no_survey_cannot_stand_without_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the programmes find no state and no motion proves it, a random survey has no answer."""
    from extrados.analyses.limit import imperfections

    def nothing(limit: LimitAnalysis) -> None:
        raise imperfections.NoAnswer("no motion proves it")

    thin = {**THIN, "thickness": 1.08, "voussoirs": 14}
    found = run(thin, 0.7, kind="imperfections", deviation="20 mm", count=20).results
    assert found.cannot_stand > 0 and found.without_answer == 0
    monkeypatch.setattr(imperfections, "cannot_stand", nothing)
    without = run(thin, 0.7, kind="imperfections", deviation="20 mm", count=20).results
    assert (without.cannot_stand, without.without_answer) == (0, found.cannot_stand)


def test_a_dome_too_thin_for_its_weight() -> None:
    dome = {"kind": "dome", "radius": 10.0, "thickness": 0.3, "rings": 6, "lunes": 8}
    result = run(dome, 0.7, kind="tilt")
    assert isinstance(result.results, SelfWeight) and "ertificate: a mechanism" in result.results.certificate


def test_a_survey_with_an_open_joint_says_what_closing_it_gives() -> None:
    """Two halves of an arch 2 mm apart at the crown: each leans alone and falls; closed they carry the whole arch's load."""

    def nave(gap: float) -> dict[str, Any]:
        edge = np.radians(np.linspace(168.75, 11.25, 9))
        ends = np.stack([np.stack([r * np.cos(edge), r * np.sin(edge)], axis=1) for r in (5.0, 6.0)])
        shift = np.array([[gap, 0.0]])
        stones = [np.stack([ends[0, k + 1], ends[1, k + 1], ends[1, k], ends[0, k]]) + shift * (k > 3) for k in range(8)]
        pier = np.array([ends[0, 0], ends[1, 0], [-9.0, 1.2], [-9.0, -4.0], [ends[0, 0, 0], -4.0]])
        stones += [pier, (pier * (-1.0, 1.0))[::-1] + shift]
        return {"kind": "blocks", "block": [{"points": np.round(stone, 9).tolist()} for stone in stones]}

    whole, open_joint = run(nave(0.0), 0.7, kind="tilt"), run(nave(0.002), 0.7, kind="tilt")
    assert isinstance(open_joint.results, SelfWeight)
    assert "with all gaps closed" in open_joint.results.certificate
    told = float(open_joint.results.certificate.split("to +x is ")[1].split(" g")[0])
    assert told == pytest.approx(whole.results.collapse_acceleration_g, rel=1e-3)


def by_codes(peak_g: float, structure: dict[str, Any]) -> Result:
    return run(structure, kind="local-mechanism", mechanism="building", base_height=0.0, peak_acceleration=f"{peak_g} g")


def test_codes_use_the_lower_end() -> None:
    """The multiplier of codes is the least state of limit analysis; a check that fails by it and holds by the upper bound is open."""
    tilt = run(coursed(2), kind="tilt").results
    least = min(tilt.interval(opposite)[0] for opposite in (False, True))
    found = by_codes(0.01, coursed(2))
    r = found.results
    assert r.multiplier == pytest.approx(least, rel=1e-6) and r.multiplier < r.multiplier_associated and r.bound is None
    assert found.verdict.outcome == "stands" and r.margin_associated > r.least() > 1.0
    weakest, strongest = 0.01 * r.least(), 0.01 * r.margin_associated
    between, above = by_codes(0.5 * (weakest + strongest), coursed(2)), by_codes(1.05 * strongest, coursed(2))
    assert between.verdict.outcome == "open" and DILATANT in between.verdict.statement
    assert above.verdict.outcome == "collapses"


def test_codes_without_a_state_beside_the_bound_stay_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(common, "MOST_BESIDE", 1)
    found = by_codes(0.01, coursed(2))
    assert (found.verdict.outcome, found.verdict.bound) == ("open", "upper")
    assert any(DILATANT in w and "Collapse without dilatancy is not given" in w for w in found.warnings)


def test_a_block_that_slides_on_one_joint_has_no_interval() -> None:
    """Coulomb: the multiplier is the friction by either flow rule, and the codes decide by it."""
    block = {"kind": "column", "width": 1.0, "height": 2.0, "drums": 1}
    found = run(block, 0.3, kind="local-mechanism", mechanism="building", peak_acceleration="0.2 g")
    assert found.results.multiplier == pytest.approx(0.3) and found.results.multiplier_associated is None
    assert found.results.bound is None and found.verdict.outcome == "stands"


def test_an_assessment_uses_the_lower_end() -> None:
    """The row of limit analysis has the least state for its capacity, and is open between it and the upper bound."""
    deck = make_deck(
        {
            "structure": coursed(2),
            "joints": {"friction": 0.65},
            "motion": {"kind": "sine-pulse", "amplitude": "0.45 g", "period": 0.5},
            "analysis": {"kind": "assess", "strategies": ["tilt"]},
        }
    )
    (result,) = run_analyses(Context(deck, threads=1))
    (row,) = result.results.verdicts
    tilt = run(coursed(2), kind="tilt").results
    least = min(tilt.interval(opposite)[0] for opposite in (False, True))
    assert row.outcome == "open" and row.capacity == pytest.approx(least) and row.margin == pytest.approx(least / 0.45)
    assert DILATANT in row.statement
