"""Ties, struts and springs with a yield force, against moments by hand and against other solvers."""

from dataclasses import replace

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.limit.common import loads_of
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.answer import assess
from extrados.limit.coulomb import CoulombProblem
from extrados.limit.interior import CollapseProblem
from extrados.limit.loads import tilt_loads
from extrados.limit.programme import LimitAnalysis, NoEquilibrium
from extrados.limit.solver import BOUND
from extrados.model.geometry.assembly import GROUND
from extrados.model.structures.arch import make_arch
from extrados.results.model import Result
from extrados.results.verdict import SelfWeight

G = 9.80665
PIER = {"kind": "block", "width": 1.0, "height": 4.0}
STONES = [[[-3, 0], [-2, 0], [0, 3], [0, 4]], [[3, 0], [2, 0], [0, 3], [0, 4]]]
FRAME = {"kind": "blocks", "block": [{"name": n, "points": p} for n, p in zip(("left", "right"), STONES, strict=True)]}
ROLLER = {"friction": "no-sliding", "types": [{"joints": ["left on the ground"], "friction": 0.0}]}
ROD = {"start": [-2.2, 0.2], "end": [2.2, 0.2]}
WALL = {"kind": "brickwork", "units": 5, "courses": 10, "unit_length": 0.4, "unit_height": 0.2}


def run(structure: dict, ties: list[dict], *analyses: dict, **tables) -> list[Result]:
    deck = {"structure": structure, "ties": ties, "analysis": list(analyses), **tables}
    return run_analyses(Context(make_deck(deck), threads=1))


@pytest.mark.parametrize("works_in", ["tension", "compression", "both"])
def test_a_pier_held_by_a_tie_overturns_by_moments(works_in: str) -> None:
    """About its toe: weight times half the width, and the tie by its arm; a tie is slack where the pier comes nearer."""
    tie = {"start": [-0.5, 4.0], "ground": [-3.5, 0.0], "yield_force": 1e4, "works_in": works_in}
    (found,) = run(PIER, [tie], {"kind": "tilt"}, joints={"friction": "no-sliding"})
    weight = 2000.0 * G * 4.0
    arms = {1: 4.0 * 0.6 + 1.0 * 0.8, -1: 4.0 * 0.6}  # of the tie about the right and the left toe, along (-.6, -.8)
    r = found.results
    by_hand = {
        sense: (0.5 * weight + (arms[sense] * 1e4 if works_in in (kind, "both") else 0.0)) / (2.0 * weight)
        for sense, kind in ((1, "tension"), (-1, "compression"))
    }
    assert r.collapse_acceleration_g == pytest.approx(by_hand[1], rel=1e-9)
    assert r.collapse_acceleration_opposite_g == pytest.approx(by_hand[-1], rel=1e-9)
    there = 1e4 if works_in != "compression" else 0.0
    assert r.ties[0].force_N == pytest.approx(there) and r.ties[0].state == ("yields" if there else "slack")
    assert r.ties_opposite[0].force_N == pytest.approx(-1e4 if works_in != "tension" else 0.0)
    assert r.duality_gap < 1e-9


def frame_by_hand() -> tuple[float, float]:
    """Weight of a stone [N] and x of its centroid [m]."""
    points = np.array(STONES[0], dtype=float)
    x, y = points.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = 0.5 * cross.sum()
    return abs(area) * 2000.0 * G, float(((x + np.roll(x, -1)) * cross).sum() / (6.0 * area))


def test_two_leaning_stones_stand_by_the_tie_between_their_feet() -> None:
    """One foot slides freely: tie times its arm below the crown is what weight and load turn about the foot."""
    weight, x = frame_by_hand()
    needed = weight * (x + 2.0) / 3.8
    load = {"kind": "moving-load", "places": [0.0]}
    for share, stands in ((0.999, False), (1.001, True)):
        tie = {**ROD, "yield_force": share * needed}
        (found,) = run(FRAME, [tie], {"kind": "tilt"}, joints=ROLLER)
        assert isinstance(found.results, SelfWeight) is not stands, found.reason
    (found,) = run(FRAME, [{**ROD, "name": "rod", "yield_force": 2e4}], load, joints=ROLLER)
    assert found.results.collapse_load_N == pytest.approx(2e4 * 3.8 - weight * (x + 2.0), rel=1e-7)
    assert found.results.ties[0].name == "rod" and found.results.ties[0].state == "yields"
    assert "Rod yields at 20.0 kN in tension" in found.answer
    (never,) = run(FRAME, [ROD], {"kind": "tilt"}, load, joints=ROLLER)[1:]
    assert "no load of this kind causes collapse" in never.reason  # nothing yields: it is pressed together


def test_the_tie_of_an_arch_on_a_free_foot_carries_its_thrust() -> None:
    """Of all lines that of least thrust asks least of the tie at the springings: the least thrust of the arch on firm ground."""
    arch = make_arch(5.0, 1.0, 180.0, 24)
    least = assess(arch).least["arch"]
    joints = arch.chains["arch"]
    thrust = abs(float(least.force(arch)[joints[0], 0]))
    structure = {"kind": "arch", "radius": 5.0, "thickness": 1.0, "embrace": 180.0, "voussoirs": 24}
    foot = arch.joint_names[joints[0]]
    ends = {"start": [-5.0, 0.0], "end": [5.0, 0.0], "start_stone": arch.block_names[0], "end_stone": arch.block_names[-1]}
    joints = {"friction": "no-sliding", "types": [{"joints": [foot], "friction": 0.0}]}
    for share, stands in ((1.0 - 1e-6, False), (1.0 + 1e-6, True)):
        (found,) = run(structure, [{**ends, "yield_force": share * thrust}], {"kind": "tilt"}, joints=joints)
        assert (found.status == "ok") is stands, found.reason
    (lines,) = run(structure, [{**ends, "yield_force": 10.0 * thrust}], {"kind": "thrust"}, joints=joints)
    assert lines.results.least.horizontal_N == pytest.approx(0.0, abs=1e-6)
    assert lines.results.central.ties[0].state == "carries"
    assert lines.results.central.ties[0].force_N > thrust


def walled(ties: list[dict], friction: float = 0.9):
    """A wall of many loops with ties: its stones, loads and friction."""
    deck = make_deck({"structure": WALL, "ties": ties, "joints": {"friction": friction}, "analysis": {"kind": "tilt"}})
    building = deck.building
    assembly = building.blocks()
    return assembly, loads_of(assembly, deck.analyses[0], building), friction


TIES = [
    {"start": [0.3, 1.95], "end": [1.75, 1.95], "yield_force": 500.0},
    {"start": [0.3, 1.35], "ground": [-1.0, 0.0], "yield_force": 800.0},
    {"start": [1.9, 0.75], "ground": [3.0, 0.0], "yield_force": 300.0, "works_in": "both"},
    {"start": [1.9, 0.95], "ground": [3.0, 0.95], "works_in": "compression", "yield_force": 200.0},
]


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_methods_agree_on_a_wall(count: int) -> None:
    """Interior point, sparse and reduced programmes: one load, and bounds from its mechanism."""
    assembly, loads, friction = walled(TIES[:count])
    found = []
    for form in ("sparse", "reduced"):
        limit = LimitAnalysis(assembly, friction, loads=loads, form=form)
        for sense in (1, -1):
            state, mechanism = limit._by_programme(sense)
            inner, misfit = CollapseProblem(limit.equations, limit._mu, sense, dilates=True).state()
            assert state.gamma == pytest.approx(mechanism.upper_bound, abs=1e-8)
            assert sense * inner.gamma == pytest.approx(state.gamma, abs=1e-7) and misfit < 1e-6
            found.append(state.gamma)
    bare = LimitAnalysis(assembly, friction).collapse()[0].gamma
    assert found[0] == pytest.approx(found[2], abs=1e-8) and found[1] == pytest.approx(found[3], abs=1e-8)
    assert found[0] > bare + (1e-4 if count < 3 else 1e-2)


def test_forces_of_ties_are_in_equilibrium() -> None:
    assembly, loads, friction = walled(TIES)
    state, _ = LimitAnalysis(assembly, friction, loads=loads).collapse()
    force = loads.dead + state.gamma * loads.live + loads.resistance.on_blocks(state.mobilised, len(assembly.mass))
    joint, at = state.force(assembly), state.points(assembly)
    wrench = np.column_stack([joint, at[:, 0] * joint[:, 1] - at[:, 1] * joint[:, 0]])
    for ends, sign in ((assembly.a, 1.0), (assembly.b, -1.0)):
        held = ends != GROUND
        np.add.at(force, ends[held], sign * wrench[held])
    assert np.abs(force).max() < 1e-7 * loads.scale


def test_sliding_without_dilatancy_goes_with_ties() -> None:
    """A state whose residuals are none: a tie that the motion stretches yields, one that it slackens carries nothing."""
    assembly, loads, friction = walled(TIES)
    limit = LimitAnalysis(assembly, friction, associated=False, loads=loads)
    state, mechanism = limit.collapse()
    found = limit.coulomb[1]
    assert found.residuals.worst < 1e-9
    lower, upper = limit.without_dilatancy_between(1)
    assert lower - 1e-9 <= state.gamma <= upper + 1e-9
    assert state.gamma == pytest.approx(mechanism.upper_bound, abs=1e-9)
    problem = CoulombProblem(limit.equations, limit._mu, 1)
    gamma, corners, twist = found.gamma, found.corners, found.twist.ravel()
    over = found.share.copy()
    over[0] = 1.1
    assert problem.residuals(gamma, corners, over, twist).tension == pytest.approx(0.1)
    moved = np.flatnonzero(np.abs(problem.answers_t @ twist) > 1e-3)
    assert len(moved)
    under = found.share.copy()
    under[moved] = -0.5
    assert problem.residuals(gamma, corners, under, twist).complementarity > 1e-4


def test_what_never_yields_is_met_by_all_methods() -> None:
    tie = {"start": [0.3, 1.35], "ground": [-1.0, 0.0]}
    assembly, loads, friction = walled([tie])
    limit = LimitAnalysis(assembly, friction, loads=loads)
    state, mechanism = limit.collapse()
    assert state.gamma == pytest.approx(mechanism.upper_bound, abs=1e-7)
    point, misfit = CollapseProblem(limit.equations, limit._mu, 1, dilates=True).state()
    assert misfit < 1e-6 and point.gamma == pytest.approx(state.gamma, abs=1e-7)
    firm = LimitAnalysis(assembly, friction, loads=walled([{**tie, "yield_force": 1e6}])[1]).collapse()[0]
    assert firm.gamma == pytest.approx(state.gamma, abs=1e-7)
    assert abs(state.mobilised[0]) < 0.01 * BOUND


def test_a_proof_that_nothing_stands_counts_what_ties_take() -> None:
    arch = make_arch(5.0, 0.2, 170.0, 20)  # too thin
    bare = LimitAnalysis(arch)
    assert bare.certificate() is not None
    deck = make_deck(
        {
            "structure": {"kind": "arch", "radius": 5.0, "thickness": 0.2, "embrace": 170.0, "voussoirs": 20},
            "ties": [
                {"start": list(arch.centroid[k]), "ground": [float(arch.centroid[k, 0]), -9.0], "works_in": "compression"}
                for k in range(20)
            ],
            "analysis": {"kind": "tilt"},
        }
    )
    loads = loads_of(arch, deck.analyses[0], deck.building)
    held = LimitAnalysis(arch, loads=loads)  # every stone stands on a strut of its own
    assert held.stands() and held.certificate() is None
    weak = replace(loads.resistance, low=1e-4 * np.maximum(loads.resistance.low, -1.0))
    with pytest.raises(NoEquilibrium):
        limit = LimitAnalysis(arch, loads=replace(tilt_loads(arch), resistance=weak))
        assert limit.certificate() is not None
        limit.collapse(1)
        limit.collapse(-1)
        assert not limit.stands()
        raise NoEquilibrium


def test_moving_supports_stretch_ties() -> None:
    """The frame's foot moves out by 2 cm: the rod, which the stones follow, keeps its yield force."""
    move = {"movements": [{"joint": "left on the ground", "dx": -0.02}]}
    (found,) = run(FRAME, [{**ROD, "yield_force": 5e3}], {"kind": "supports"}, initial=move, joints={"friction": "no-sliding"})
    assert found.results.ties[0].state == "yields"
    assert found.results.work_gap_J < 1e-9 * found.results.work_J
    assert found.results.openings[0].opening_mm == pytest.approx(20.0 / 4.0)  # turned by 20 mm over the height of the crown
    ends = {"start": [-4.9, 1.0], "end": [4.9, 1.0], "start_stone": "voussoir 1", "end_stone": "voussoir 16"}
    arch = {"kind": "arch", "radius": 5.0, "thickness": 1.0, "embrace": 160.0, "voussoirs": 16}
    (spread,) = run(arch, [{**ends, "yield_force": 1e3}], {"kind": "supports"})  # not followed to its fall
    assert spread.results.movement_at_fall_m is None and spread.results.ties[0].state == "yields"


@pytest.mark.parametrize("kind", ["assessment", "rocking-spectrum"])
def test_who_does_not_reckon_with_ties_says_so(kind: str) -> None:
    more = {"dem-domain": {"durations": [0.1, 0.2], "amplitudes": ["0.5 g"]}}
    motion = {"kind": "step-pulse", "amplitude": "0.5 g", "duration": 0.2}
    tie = {"start": [-0.5, 4.0], "ground": [-3.5, 0.0]}
    (found,) = run(PIER, [tie], {"kind": kind, **more.get(kind, {})}, motion=motion)
    assert found.status == "refused" and "[[ties]]" in found.reason


def test_sweeps_and_surveys_reckon_with_ties() -> None:
    tie = {"start": [-0.5, 4.0], "ground": [-3.5, 0.0], "yield_force": 1e4}
    tilt, swept, band = run(
        PIER,
        [tie],
        {"kind": "tilt"},
        {"kind": "sweep", "vary": "width", "values": [1.0, 1.0001], "locate": False},
        {"kind": "imperfections", "deviation": 1e-9, "count": 10},
        joints={"friction": "no-sliding"},
    )
    capacity = tilt.results.collapse_acceleration_g
    assert swept.results.collapse_accelerations_g[0] == pytest.approx(capacity)
    assert band.arrays["gamma"].data[:, 0] == pytest.approx(np.full(10, capacity), rel=1e-6)
    (by_force,) = run(
        PIER,
        [tie],
        {"kind": "sweep", "vary": "ties.0.yield_force", "values": ["5 kN", "10 kN"], "locate": False},
        joints={"friction": "no-sliding"},
    )
    half, whole = by_force.results.collapse_accelerations_g
    assert whole == pytest.approx(capacity) and half == pytest.approx(0.25 + 0.5 * (capacity - 0.25))


@pytest.mark.parametrize(
    ("tie", "word"),
    [
        ({"start": [9.0, 9.0], "ground": [0.0, 0.0]}, "no block is at x = 9"),
        ({"start": [0.0, 3.5], "ground": [0.0, 5.0]}, "lies between 'left', 'right'"),
        ({"start": [-2.5, 0.2], "end": [-2.4, 0.3]}, "both ends of the tie are in block 'left'"),
        ({"start": [0.0, 3.5], "ground": [0.0, 5.0], "start_stone": "middle"}, "block 'middle' does not exist"),
    ],
)
def test_anchors_are_named_where_they_are_wrong(tie: dict, word: str) -> None:
    (found,) = run(FRAME, [tie], {"kind": "tilt"})
    assert found.status == "refused" and word in found.reason


@pytest.mark.parametrize(
    ("ties", "word"),
    [
        ([{"start": [0, 1]}], "expected either the key `end`"),
        ([{"start": [0, 1], "end": [0, 1]}], "both ends have the same position"),
        ([{**ROD, "prestress": 3.0, "works_in": "compression"}], "exceeds the range that the tie can carry"),
        ([{**ROD, "prestress": 30.0, "yield_force": 20.0}], "exceeds the range that the tie can carry"),
        ([{**ROD, "name": "a"}, {**ROD, "name": "a"}], "two ties are called 'a'"),
        ([{"start": [0, 1], "ground": [0, 0], "end_stone": "left"}], "requires the key `end`"),
        ({"start": [0, 1]}, "expected tables [[ties]]"),
        ([{**ROD, "yield_force": "20 s"}], "not a unit of N"),
    ],
)
def test_a_wrong_tie_is_complained_of(ties, word: str) -> None:
    with pytest.raises(DeckError, match=r"ties") as error:
        make_deck({"structure": FRAME, "ties": ties, "analysis": {"kind": "tilt"}})
    assert word in str(error.value)
