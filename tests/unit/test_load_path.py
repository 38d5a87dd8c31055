"""Sliding without dilatancy as an interval, in space and in the plane: load paths, least states, their certificates."""

import os
import signal
import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from test_dilatancy import coursed
from test_noisy_solids import corner

from extrados import _core, interrupts
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.context import Context
from extrados.analyses.limit import solids as driver
from extrados.analyses.limit.paths import follow_beside
from extrados.analyses.limit.solid_sliding import slide
from extrados.analyses.sequence import run_analyses
from extrados.core.calls import cancel_requested, interruptible
from extrados.core.errors import Cancelled
from extrados.decks.reader import make_deck
from extrados.limit.certificate import Certificate, certify
from extrados.limit.coulomb import CoulombProblem
from extrados.limit.errors import NoAnswer
from extrados.limit.least_load import LeastLoad
from extrados.limit.load_path import ELASTIC_LOAD, FIRST, RATIOS, LoadPath
from extrados.limit.plane_path import collapse_along_path
from extrados.limit.programme import LimitAnalysis
from extrados.limit.solids import Programme, SolidLimit
from extrados.model.geometry.solids.assembly import assemble
from extrados.model.structures.dome import make_dome
from extrados.results import limit as results
from extrados.results.limit import judge_design
from extrados.results.model import Result

WALL = {"kind": "brickwork", "units": 5, "courses": 6, "unit_length": 0.4, "unit_height": 0.175, "begins": "half"}
#: Ferris and Tin-Loi 2001, wall 3: printed .40369 associated, .35582 without dilatancy
OPENING = {
    "kind": "brickwork",
    "unit_length": 0.4,
    "unit_height": 0.175,
    "units": 4,
    "courses": 11,
    "lintels": False,
    "openings": [{"x": [0.6, 1.0], "y": [0.525, 1.4]}],
}


def run(structure: dict[str, Any], friction: Any = 0.65, **keys: Any) -> Result:
    tables = {"structure": structure, "joints": {"friction": friction}, "analysis": {"kind": "tilt", **keys}}
    return run_analyses(Context(make_deck(tables), threads=1))[0]


def asked(peak_g: float) -> Demanded:
    return Demanded(peak_g, "", 0.0, 0.0)


@pytest.mark.parametrize(
    ("direction", "associated", "paths", "least"), [(90.0, 0.4532, (0.2535, 0.2595), 0.25), (270.0, 0.3419, (0.2499, 0.2503), 0.25)]
)
def test_the_corner_of_the_reference(direction: float, associated: float, paths: tuple[float, float], least: float) -> None:
    """Another program: paths .254 to .259 and .2500 to .2502 g, least .2500, where an iteration to the greatest ends at .3562."""
    limit = SolidLimit(assemble(corner()), 0.65)
    row, state = slide(limit, direction, None, 2)
    found = [p.collapse_acceleration_g for p in row.load_paths]
    assert all(p.certified for p in row.load_paths) and all(paths[0] < g < paths[1] for g in found if g is not None)
    assert row.load_path_g == min(g for g in found if g is not None)
    assert row.least_g == pytest.approx(least, abs=1e-5) and state is not None
    assert len(row.starts_g) == 2 * len(RATIOS) + 2, (
        "the ends of the paths, what they descend to, and random compressions lead to certified states too"
    )
    upper = limit.push(direction)
    assert isinstance(upper, Programme) and upper.gamma == pytest.approx(associated, abs=5e-5)


def test_a_dome_of_the_reference() -> None:
    """Another program: associated .497, load path .364 (12 lunes, t/R .1)."""
    limit = SolidLimit(make_dome(10.0, 1.0, 180.0, 8, 8), 0.7)
    upper = limit.push(0.0)
    row, _ = slide(limit, 0.0, None, 0)
    assert isinstance(upper, Programme) and row.load_path_g is not None and row.least_g is not None
    assert row.least_g <= row.load_path_g < upper.gamma - 0.05
    assert np.ptp([p.collapse_acceleration_g for p in row.load_paths]) < 0.01


@pytest.mark.parametrize("direction", [0.0, 30.0])
def test_a_block_that_slides_has_no_interval(direction: float) -> None:
    """Coulomb: the friction, by any flow rule."""
    block = {"kind": "column", "width": 2.0, "height": 0.5, "drums": 1}
    limit = SolidLimit(make_deck({"structure": block, "analysis": {"kind": "tilt"}}).building.solids(), 0.4)
    row, _ = slide(limit, direction, None, 1)
    assert [p.collapse_acceleration_g for p in row.load_paths] == pytest.approx([0.4] * 3, abs=1e-6)
    assert row.least_g == pytest.approx(0.4, abs=1e-6)


def test_dowels_along_a_path() -> None:
    """Friction plus the strength over the weight of the upper drum, as with dilatancy."""
    drums = {"kind": "column", "width": 1.0, "height": 1.0, "drums": 2, "section": "round", "sides": 20, "dowels": 2000.0}
    tables = {
        "structure": drums,
        "joints": {"friction": 0.2, "types": [{"joints": ["ground"], "friction": 5.0}]},
        "analysis": {"kind": "tilt"},
    }
    building = make_deck(tables).building
    solids = building.solids()
    limit = SolidLimit(solids, building.friction(solids))
    upper = limit.push(20.0)
    end = LoadPath(limit.contact_points(20.0), 0.5).follow()
    assert isinstance(upper, Programme) and end.gamma == pytest.approx(upper.gamma, abs=1e-5)
    assert limit.certify(20.0, end)[1].holds(end.gamma)


def test_paths_in_the_plane_end_at_printed_states() -> None:
    limit = LimitAnalysis(make_deck({"structure": OPENING, "analysis": {"kind": "tilt"}}).building.blocks(), 0.65, associated=False)
    for direction in (1, -1):
        state, mechanism = collapse_along_path(limit, direction, 0.5)
        assert direction * state.gamma == pytest.approx(0.35582, abs=1e-5)
        assert certify(limit.assembly, limit.loads, 0.65, state, mechanism, None).holds(state.gamma)


def test_threads_change_nothing() -> None:
    """Both directions and all ratios side by side give the results of one thread, digit by digit."""
    tables = {"structure": {**WALL, "units": 3, "courses": 3}, "joints": {"friction": 0.65}, "analysis": {"kind": "tilt"}}
    tables["analysis"]["friction_rule"] = "non-associated"
    shown: list[tuple[float, float]] = []
    rows = []
    for threads in (1, 2):
        context = Context(make_deck(tables), threads=threads, progress=lambda done, total, text: shown.append((done, total)))
        rows.append(run_analyses(context)[0].results)
    assert rows[0] == rows[1] and len(rows[0].load_paths) == len(rows[0].load_paths_opposite) == len(RATIOS)
    assert {done for done, _ in shown} == set(range(2 * len(RATIOS) + 1)) and {total for _, total in shown} == {2 * len(RATIOS)}


def test_ctrl_c_ends_a_path() -> None:
    limit = LimitAnalysis(make_deck({"structure": WALL, "analysis": {"kind": "tilt"}}).building.blocks(), 0.65, associated=False)
    with interruptible(), pytest.raises(Cancelled):
        _core.api_support.set_cancel(1)
        try:
            collapse_along_path(limit, 1, 0.5)
        finally:
            _core.api_support.set_cancel(0)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_tilt_after_an_interruption_is_not_interrupted(threads: int) -> None:
    """The flag that an earlier Ctrl-C left says nothing about the load paths of a later analysis."""
    before = len(interrupts.asked)
    with interruptible():
        signal.raise_signal(signal.SIGINT)
        assert cancel_requested()
    del interrupts.asked[before:]
    tables = {"structure": {**WALL, "units": 2, "courses": 2}, "joints": {"friction": 0.3}, "analysis": {"kind": "tilt"}}
    (result,) = run_analyses(Context(make_deck(tables), threads=threads))
    assert result.status == "ok" and all(row.certified for row in result.results.load_paths)


def test_ctrl_c_ends_the_search_for_states_without_dilatancy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of both directions side by side: each ends with its step."""
    steps: list[Any] = []
    pressed, step = threading.Event(), CoulombProblem._step

    def interrupted(*given: Any) -> Any:
        steps.append(given)
        if len(steps) == 1:
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(500):
                if cancel_requested():
                    break
                time.sleep(0.01)
            pressed.set()
        pressed.wait(10.0)
        return step(*given)

    monkeypatch.setattr(CoulombProblem, "_step", interrupted)
    before = len(interrupts.asked)
    tables = {"structure": {**WALL, "units": 10, "courses": 10}, "joints": {"friction": 0.6}, "analysis": {"kind": "tilt"}}
    tables["analysis"]["friction_rule"] = "non-associated"
    (result,) = run_analyses(Context(make_deck(tables), threads=2))
    del interrupts.asked[before:]
    assert result.status == "interrupted" and len(steps) <= 2


def test_progress_comes_from_one_thread_at_a_time() -> None:
    told: list[int] = []
    here = threading.Lock()

    def progress(done: int, total: int) -> None:
        assert here.acquire(blocking=False)
        time.sleep(0.002)
        told.append(done)
        here.release()

    def follow(ratio: float, effort: int) -> Any:
        raise NoAnswer("nothing to follow")

    rows = follow_beside([follow] * 4, 4, progress)
    assert told == list(range(4 * len(RATIOS) + 1)) and len(rows) == 4


def test_the_first_step_is_that_of_bonded_joints(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where joints open under self-weight, so that other factors replace those of bonded joints."""
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.2, "embrace": 180, "voussoirs": 9}
    limit = LimitAnalysis(make_deck({"structure": arch, "analysis": {"kind": "tilt"}}).building.blocks(), 0.8, associated=False)
    points = limit.contact_points(1)
    path, works = LoadPath(points, 0.5), []
    assert path._factor(path._bonded(), 0.0)
    expected = FIRST * ELASTIC_LOAD * float(points.live @ path.stiffness.solve(points.live)[0])
    newton = path._newton

    def recorded(old: Any, u: Any, gamma: float, work: float | None, *hold: Any) -> Any:
        if work is None:
            return newton(old, u, gamma, work, *hold)
        works.append(work)
        raise NoAnswer("seen")

    monkeypatch.setattr(path, "_newton", recorded)
    with pytest.raises(NoAnswer, match="seen"):
        path.follow()
    assert works == [pytest.approx(expected, rel=1e-9)]


def test_plane_and_space_have_one_path() -> None:
    """A plane wall in space, whose corners share what the ends of its joints carry."""
    plane = run(coursed(2))
    space = run(coursed(2), direction=0.0, rose=4, starts=1)
    assert space.results.collapse_acceleration_load_path_g == pytest.approx(plane.results.collapse_acceleration_load_path_g, abs=2e-3)
    for r in (plane.results, space.results):
        least, design, most = (r.collapse_acceleration_non_associated_g, r.collapse_acceleration_load_path_g, r.collapse_acceleration_g)
        assert least <= design + 1e-6 and design < most
    r = plane.results
    verdict = r.judged(asked(0.5 * (design + most)))
    assert (verdict.outcome, verdict.capacity) == ("open", pytest.approx(r.capacity(), abs=1e-9))
    assert r.judged(asked(0.9 * least)).outcome == "stands" and r.judged(asked(1.01 * most)).outcome == "collapses"


def test_the_rule_of_a_deck_of_solids_gives_the_least_state() -> None:
    result = run(coursed(2), direction=0.0, rose=4, starts=1, friction_rule="non-associated")
    r = result.results
    assert r.collapse_acceleration_g == r.collapse_acceleration_non_associated_g < r.non_dilatant[0].associated_g
    assert [row.direction_deg for row in r.non_dilatant] == [0.0, 90.0, 180.0, 270.0]
    assert "design value" in result.answer


def test_large_structures_are_followed_on_request(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "MOST_BESIDE", 10)
    r = run(coursed(2), direction=0.0, rose=4).results
    assert r.non_dilatant is None and "so collapse without dilatancy is calculated only with" in r.non_associated_reason
    assert r.judged(asked(0.1)).outcome == "open"


def test_the_certificate_of_solids_sees_what_is_wrong() -> None:
    limit = SolidLimit(assemble(corner()), 0.65)
    points = limit.contact_points(90.0)
    end = LoadPath(points, 0.5).follow()

    def proof(state):
        return limit.certify(90.0, state)[1]

    assert proof(end).holds(end.gamma)
    assert proof(replace(end, gamma=end.gamma + 1e-3)).zero_gap == pytest.approx(1e-3, rel=1e-2)
    force = end.force.copy()
    force[5, 0] += 0.1
    assert proof(replace(end, force=force)).equilibrium > 1e-4
    force = end.force.copy()
    force[:, 1:] *= 1.1
    assert proof(replace(end, force=force)).friction > 1e-5
    assert proof(replace(end, motion=-end.motion)).closing > 0.1
    upper = limit.push(90.0)
    assert isinstance(upper, Programme)
    motion = upper.motion.copy()
    motion[:, 3:] *= limit.assembly.size
    dilatant = replace(end, gamma=upper.gamma, force=upper.force / limit.scale, motion=motion.ravel())
    assert not proof(dilatant).holds(upper.gamma) and proof(dilatant).equilibrium < 1e-8


def test_a_descent_never_rises() -> None:
    limit = SolidLimit(assemble(corner()), 0.65)
    points = limit.contact_points(90.0)
    end = LoadPath(points, 1.0).follow()
    lower = LeastLoad(points).descended(end)
    assert lower.gamma < end.gamma - 1e-3 and limit.certify(90.0, lower)[1].holds(lower.gamma)


def test_no_path_under_crushing() -> None:
    limit = LimitAnalysis(
        make_deck({"structure": WALL, "analysis": {"kind": "tilt"}}).building.blocks(), 0.65, strength=2e6, associated=False
    )
    with pytest.raises(NoAnswer, match="crushing"):
        collapse_along_path(limit, 1, 0.5)


def test_the_verdict_warns_above_the_least_state() -> None:
    verdicts = [judge_design(0.3, 0.2, 0.5, asked(peak)) for peak in (0.1, 0.25, 0.4, 0.5)]
    assert [v.outcome for v in verdicts] == ["stands", "stands", "open", "collapses"]
    assert [("Warning" in v.statement) for v in verdicts] == [False, True, False, False]
    assert all(v.capacity == 0.3 for v in verdicts)


@pytest.mark.parametrize("wrong", ["equilibrium", "friction", "tension", "closing", "zero_gap"])
def test_a_certificate_holds_by_all_that_it_states(wrong: str) -> None:
    good = Certificate(1e-9, 1e-9, 1e-9, 1e-9, 1e-9)
    assert good.holds(0.3) and not replace(good, **{wrong: 1e-3}).holds(0.3)


def test_the_design_value_is_of_certified_paths() -> None:
    """The least path counts only with its certificate; without any there is no design value."""

    def path(gamma: float | None, certified: bool) -> results.LoadPath:
        return results.LoadPath(
            shear_stiffness_ratio=1.0,
            collapse_acceleration_g=gamma,
            certified=certified,
            zero_gap_g=None,
            equilibrium_residual=None,
            friction_residual=None,
            overlap_residual=None,
        )

    assert results.design_value([path(0.2, False), path(0.3, True), path(0.25, True), path(None, False)]) == 0.25
    assert results.design_value([path(0.2, False)]) is None and results.design_value(None) is None


def test_no_path_without_a_live_load() -> None:
    limit = LimitAnalysis(make_deck({"structure": WALL, "analysis": {"kind": "tilt"}}).building.blocks(), 0.65, associated=False)
    points = limit.contact_points(1)
    with pytest.raises(NoAnswer, match="no live load"):
        LoadPath(replace(points, live=np.zeros_like(points.live)), 0.5)
