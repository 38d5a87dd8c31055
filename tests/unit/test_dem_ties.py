"""Ties, chains and hoops in discrete elements: oscillators and falls in closed form, the ledger, limit analysis, states."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from dem_models import G, block_on_floor, cosine, model, rectangle
from test_dem3_core import solids

import extrados
from extrados.core import dem, dem3
from extrados.core.dem_run import STILL, Ties
from extrados.core.errors import CoreError
from extrados.core.ground import as_motion_set
from extrados.model.geometry.solids.polyhedra import box

LAW = dem.Law(1e9, 1e9, 0.6, damping=1e-4)
#: Square metre blocks of 2,000 kg far above the floor
MASS = 2000.0


def ties(
    *lines: list[tuple[int, list[float]]],
    stiffness: float = 8e5,
    prestress: float = 0.0,
    least: float = 0.0,
    most: float = np.inf,
    closed: bool = False,
) -> Ties:
    """Lines of points, each a body (-1 the ground) and a place [m]."""
    count = len(lines)
    return Ties(
        *(np.full(count, value) for value in (stiffness, prestress, least, most)),
        np.cumsum([0, *map(len, lines)])[:-1],
        np.full(count, closed),
        np.array([body for line in lines for body, _ in line]),
        np.arange(sum(map(len, lines))),
        np.array([place for line in lines for _, place in line]),
    )


def free_block(tie: Ties) -> dem.Bodies:
    bodies = model([rectangle(-0.5, 0.5, 4.5, 5.5)], [rectangle(-20.0, 20.0, -1.0, 0.0)], LAW)
    return replace(bodies, ties=tie)


TO_THE_SIDE = [(0, [0.0, 5.0]), (-1, [-3.0, 5.0])]
FLOATING = dem.Options(0.6, 0.01, step=2e-4, gravity=(0.0, 0.0))


@pytest.mark.parametrize("rigid", [False, True])
def test_a_block_on_a_spring_oscillates(rigid: bool) -> None:
    """x = v / w sin w t with w = sqrt(k / m): 20 rad/s, in the plane and in space."""
    spring = ties(TO_THE_SIDE, least=-np.inf)
    start = np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    run = dem.run(free_block(spring), replace(FLOATING, rigid=rigid), shift=np.zeros((2, 3)), rate=start)
    exact = 0.5 / 20.0 * np.sin(20.0 * run.time)
    assert run.place[:, 0, 0] == pytest.approx(exact, abs=1e-6)
    assert run.tension[:, 0] == pytest.approx(8e5 * exact, abs=10.0)
    assert run.residual < 1e-8
    high = replace(spring, place=np.array([[0.0, 0.0, 5.0], [-3.0, 0.0, 5.0]]))
    body = replace(solids([box((-0.5, -0.5, 4.5), (0.5, 0.5, 5.5))], LAW), ties=high)
    space = dem3.Options(0.6, 0.01, step=2e-4, gravity=(0.0, 0.0, 0.0), rigid=rigid)
    rates = np.zeros((2, 6))
    rates[0, 0] = 0.5
    there = dem3.run(body, space, rate=rates)
    assert there.place[:, 0, 0] == pytest.approx(exact, abs=1e-6)
    assert there.tension == pytest.approx(run.tension, abs=1e-3)
    assert there.residual < 1e-8


def test_an_eccentric_spring_turns_the_block() -> None:
    """A spring along x at the arm e: the sum of the spin's momentum about the ground's axis is that of the force."""
    spring = ties([(0, [0.0, 5.3]), (-1, [-300.0, 5.3])], least=-np.inf)
    start = np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    run = dem.run(free_block(spring), FLOATING, shift=np.zeros((2, 3)), rate=start)
    impulse = MASS * (run.rate[:, 0, 0] - 0.5)
    inertia = MASS / 6.0
    assert inertia * run.rate[:, 0, 2] == pytest.approx(-0.3 * impulse, abs=0.02 * np.abs(impulse).max())
    assert run.residual < 1e-6


def test_a_tie_yields_and_the_ledger_closes() -> None:
    """Thrown at 1 m/s against 10 kN: stops where the work m v^2 / 2 is F (s - F / 2k), and leaves the plastic part."""
    yielding = ties(TO_THE_SIDE, most=1e4)
    start = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    run = dem.run(free_block(yielding), replace(FLOATING, end_time=0.25), shift=np.zeros((2, 3)), rate=start)
    elastic = 1e4 / 8e5
    farthest = 0.5 * MASS / 1e4 + 0.5 * elastic
    assert run.place[:, 0, 0].max() == pytest.approx(farthest, rel=1e-3)  # between two outputs
    assert run.tension.max() == 1e4 == run.extreme[0, 1]
    assert run.extreme[0, 2] == pytest.approx(farthest - elastic, rel=1e-3)
    assert run.energy["friction"][-1] == pytest.approx(1e4 * (farthest - elastic), rel=1e-3)
    assert run.residual < 1e-4


def test_a_slack_tie_carries_nothing() -> None:
    """Thrown towards its anchor the block flies on; a strut in the same place pushes it back."""
    start = np.array([[-0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    slack = dem.run(free_block(ties(TO_THE_SIDE)), FLOATING, shift=np.zeros((2, 3)), rate=start)
    assert slack.place[:, 0, 0] == pytest.approx(-0.5 * slack.time, abs=1e-12) and not slack.tension.any()
    strut = dem.run(free_block(ties(TO_THE_SIDE, least=-np.inf, most=0.0)), FLOATING, shift=np.zeros((2, 3)), rate=start)
    assert strut.place[:, 0, 0].min() == pytest.approx(-0.025, rel=1e-3)
    assert strut.tension.min() == pytest.approx(-2e4, rel=1e-3)


def test_a_chain_runs_over_a_block() -> None:
    """From the ground over a block and back: the block feels the tension twice, w^2 = 4 k / m."""
    over = ties([(-1, [-3.0, 5.0]), (0, [0.0, 5.0]), (-1, [-3.0, 5.0 + 1e-9])], least=-np.inf)
    start = np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    run = dem.run(free_block(over), FLOATING, shift=np.zeros((2, 3)), rate=start)
    assert run.place[:, 0, 0] == pytest.approx(0.5 / 40.0 * np.sin(40.0 * run.time), abs=5e-6)


def test_a_hoop_holds_four_blocks_apart() -> None:
    """Four blocks that fly from the centre stretch the hoop by the change of its perimeter: w^2 = 4 sqrt(2) sqrt(2) k / m / 2."""
    way = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]], dtype=float)
    centre = 3.0 * way + [0.0, 10.0]
    blocks = [rectangle(x - 0.5, x + 0.5, y - 0.5, y + 0.5) for x, y in centre]
    hoop = ties([(k, list(place)) for k, place in enumerate(centre)], closed=True)
    bodies = replace(model(blocks, [rectangle(-20.0, 20.0, -1.0, 0.0)], LAW), ties=hoop)
    start = np.zeros((5, 3))
    start[:4, :2] = 0.2 * way
    run = dem.run(bodies, FLOATING, shift=np.zeros((5, 3)), rate=start)
    # Perimeter 4 sqrt(2) r; each block is pulled by sqrt(2) T.
    omega = np.sqrt(8.0 * 8e5 / MASS)
    taut = run.time < np.pi / omega
    moved = run.place[taut, 0, 0] - 3.0
    assert moved == pytest.approx(0.2 / omega * np.sin(omega * run.time[taut]), abs=2e-6)
    assert run.tension[taut, 0] == pytest.approx(8e5 * 4.0 * np.sqrt(2.0) * moved, abs=20.0)


def test_a_short_prestressed_tie_shortens_the_step() -> None:
    """Across a tie of tension T and length l its geometric stiffness T / l acts: a block oscillates with sqrt(T / (l m))."""
    short = ties([(0, [0.0, 4.5]), (-1, [0.0, 4.3])], stiffness=1.0, prestress=1e5)
    start = np.array([[0.01, 0.0, 0.0], [0.0, 0.0, 0.0]])
    asked = replace(FLOATING, step=0.0, rigid=True, fraction=0.3)
    bodies = free_block(short)
    run = dem.run(replace(bodies, inertia=bodies.inertia * 1e6), asked, shift=np.zeros((2, 3)), rate=start)
    assert run.critical_step <= 2.0 / np.sqrt(1e5 / 0.2 / MASS)
    assert run.reason == "end"


@pytest.mark.parametrize(("share", "stable"), [(0.99, True), (1.01, False)])
def test_the_critical_step_is_that_of_the_tie(share: float, stable: bool) -> None:
    """2 / w of a block on a spring, exactly: above it the motion grows without bound."""
    spring = ties(TO_THE_SIDE, least=-np.inf, stiffness=8e9)
    start = np.array([[1e-6, 0.0, 0.0], [0.0, 0.0, 0.0]])
    asked = replace(FLOATING, step=share * 2.0 / np.sqrt(8e9 / MASS), rigid=True, residual_limit=1e300)
    if not stable:
        assert dem.run(free_block(spring), asked, shift=np.zeros((2, 3)), rate=start).reason == "step"
        return
    run = dem.run(free_block(spring), asked, shift=np.zeros((2, 3)), rate=start)
    assert run.reason == "end" and np.abs(run.place[:, 0, 0]).max() < 1e-4


def test_a_moving_base_and_its_body_force_agree() -> None:
    """The ground end moves with the base: the same response, the ledger closed in both frames."""
    shaken = replace(block_on_floor(1.0, 3.0, LAW), ties=ties([(0, [0.5, 2.9]), (-1, [-5.0, 2.9])], most=2e4, stiffness=3e6))
    options = dem.Options(1.5, 0.02, collapse=2.0)
    runs = [dem.run(shaken, replace(options, moving_base=moving), cosine(0.45 * G, 5.0)) for moving in (False, True)]
    assert runs[0].tension.max() == 2e4  # it has yielded
    assert runs[1].place[:, 0] == pytest.approx(runs[0].place[:, 0], abs=2e-5)
    assert runs[1].residual == pytest.approx(runs[0].residual, rel=0.01) and runs[0].residual < 0.01


@pytest.mark.parametrize("rigid", [False, True])
def test_a_state_with_ties_goes_on_with_the_same_bits(rigid: bool) -> None:
    shaken = replace(block_on_floor(1.0, 3.0, LAW), ties=ties([(0, [0.5, 2.9]), (-1, [-5.0, 2.9])], most=2e4))
    options = dem.Options(1.0, 0.02, rigid=rigid)
    with dem.Model(shaken, options) as one, as_motion_set([cosine(0.45 * G, 5.0)]) as motions:
        states: list[np.ndarray] = []
        whole = one.run(motions, watch=lambda _: states.append(one.state()))
    with dem.Model(shaken, options) as other, as_motion_set([cosine(0.45 * G, 5.0)]) as motions:
        again = other.run(motions, state=states[len(states) // 2])
    assert np.array_equal(again.tension, whole.tension) and np.array_equal(again.place, whole.place)
    bare = replace(shaken, ties=None)
    with dem.Model(bare, options) as third, as_motion_set([STILL]) as motions, pytest.raises(ValueError, match="to a run of another model"):
        third.run(motions, state=states[0])


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"stiffness": np.array([0.0])}, CoreError),
        ({"prestress": np.array([-1.0])}, CoreError),
        ({"body": np.array([0, 7])}, IndexError),
        ({"place": np.full((2, 2), np.nan)}, ValueError),
        ({"point": np.array([0, 2])}, ValueError),
    ],
)
def test_wrong_ties_are_refused(change: dict, error: type[Exception]) -> None:
    with pytest.raises(error):
        dem.run(free_block(replace(ties(TO_THE_SIDE), **change)), FLOATING)


def deck(kind: dict, **tie: Any) -> dict:
    table = {"start": [0.5, 2.9], "ground": [-6.0, 2.9], "start_stone": "block", **tie}
    return {
        "structure": {"kind": "block", "width": 1.0, "height": 3.0},
        "material": {"density": 2000.0, "young": 5e9},
        "joints": {"friction": 0.9},
        "ties": [table],
        "analysis": [kind],
    }


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_a_tied_block_collapses_where_limit_analysis_says(solver: str) -> None:
    """(W b / 2 + F h_t) / (W h / 2), less what the tie lengthens until it yields, at most 1 % with EA/L of 2 MN/m."""
    weight = 6000.0 * G
    found = extrados.run(deck({"kind": "dem", "test": "tilt", "solver": solver}, stiffness=2e6, yield_force=1e4)).results[0]
    exact = (0.5 * weight + 1e4 * 2.9) / (1.5 * weight)
    assert exact > found["collapse_acceleration_g"] > 0.99 * exact
    assert found["collapse_acceleration_opposite_g"] == pytest.approx(1.0 / 3.0, rel=2e-3)
    assert found["ties"][0]["state"] == "yielded" and found["ties"][0]["peak_force_N"] == 1e4
    assert "tie 1" in found.answer.lower()


def test_a_tie_without_stiffness_is_refused() -> None:
    found = extrados.run(deck({"kind": "dem", "test": "tilt"}, yield_force=1e4)).results[0]
    assert found.status == "refused" and "stiffness EA/L" in found.reason


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_a_tied_block_in_space(solver: str) -> None:
    """Pushed across: (W d / 2 + F h_t) / (W h / 2) with its depth d, by the cone programme and by elements."""
    asked = {"direction": 90.0}
    table = {"start": [0.5, 0.0, 2.9], "ground": [0.5, -6.0, 2.9], "start_stone": "block"}
    tied = deck({"kind": "dem", "test": "tilt", "solver": solver, **asked}, **table, stiffness=2e6, yield_force=1e4)
    tied["structure"]["depth"] = 0.8
    tied["analysis"].append({"kind": "tilt", **asked})
    found, exact = extrados.run(tied).results
    weight = 2000.0 * 2.4 * G
    assert exact["collapse_acceleration_g"] == pytest.approx((0.4 * weight + 1e4 * 2.9) / (1.5 * weight), rel=1e-6)
    assert exact["collapse_acceleration_g"] > found["collapse_acceleration_g"] > 0.985 * exact["collapse_acceleration_g"]
    assert found["ties"][0]["state"] == "yielded"


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize(("power", "damping"), [(1.0, 4e3), (2.0, 1.5e4), (0.5, 800.0)])
def test_a_dashpot_slows_a_block(power: float, damping: float, rigid: bool) -> None:
    """m dv/dt = -c v^n in closed form, in the plane and in space; what it loses is the energy of motion."""
    line = ties(TO_THE_SIDE, stiffness=0.0, least=0.0, most=0.0)
    dash = replace(line, damping=np.array([damping]), power=np.array([power]))
    start = np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    run = dem.run(free_block(dash), replace(FLOATING, rigid=rigid), shift=np.zeros((2, 3)), rate=start)
    k, v, t = damping / MASS, 0.5, run.time
    exact = v * np.exp(-k * t) if power == 1.0 else np.maximum(v ** (1.0 - power) - (1.0 - power) * k * t, 0.0) ** (1.0 / (1.0 - power))
    assert run.rate[:, 0, 0] == pytest.approx(exact, abs=2e-4)
    assert run.energy["damping"][-1] == pytest.approx(0.5 * MASS * (v**2 - exact[-1] ** 2), rel=2e-3)
    assert run.residual < 1e-4
    assert run.tension[-1, 0] == pytest.approx(damping * exact[-1] ** power, rel=1e-2)
    high = replace(dash, place=np.array([[0.0, 0.0, 5.0], [-3.0, 0.0, 5.0]]))
    body = replace(solids([box((-0.5, -0.5, 4.5), (0.5, 0.5, 5.5))], LAW), ties=high)
    rates = np.zeros((2, 6))
    rates[0, 0] = 0.5
    there = dem3.run(body, dem3.Options(0.6, 0.01, step=2e-4, gravity=(0.0, 0.0, 0.0), rigid=rigid), rate=rates)
    assert there.rate[:, 0, 0] == pytest.approx(exact, abs=2e-4)


def test_a_stiff_dashpot_shortens_the_step_and_stops_the_block() -> None:
    dash = replace(ties(TO_THE_SIDE, stiffness=0.0, least=0.0, most=0.0), damping=np.array([1e8]), power=np.array([1.0]))
    start = np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    run = dem.run(free_block(dash), replace(FLOATING, end_time=0.01, step=0.0), shift=np.zeros((2, 3)), rate=start)
    assert run.critical_step == pytest.approx(MASS / 1e8, rel=0.05)
    assert abs(run.rate[-1, 0, 0]) < 1e-3 and run.reason == "end"


@pytest.mark.parametrize("rigid", [False, True])
def test_a_dashpot_brings_a_block_to_rest_in_coarse_steps(rigid: bool) -> None:
    """c v^0.5 changes a small rate by more than itself in a step: the block never turns back, no step gives it energy."""
    step, law = 0.05, dem.Law(1e4, 1e4, 0.6)  # contacts as soft as the step is long; nothing touches
    line = ties(TO_THE_SIDE, stiffness=0.0, least=0.0, most=0.0)
    dash = replace(line, damping=np.array([4e3]), power=np.array([0.5]))
    start = np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    options = replace(FLOATING, end_time=2.0, output_step=step, step=step, rigid=rigid)
    plane = dem.run(replace(free_block(dash), laws=[law]), options, shift=np.zeros((2, 3)), rate=start)
    high = replace(dash, place=np.array([[0.0, 0.0, 5.0], [-3.0, 0.0, 5.0]]))
    body = replace(solids([box((-0.5, -0.5, 4.5), (0.5, 0.5, 5.5))], law), ties=high)
    rates = np.zeros((2, 6))
    rates[0, 0] = 0.5
    space = dem3.run(body, dem3.Options(2.0, step, step=step, gravity=(0.0, 0.0, 0.0), rigid=rigid), rate=rates)
    for run in (plane, space):
        gone = np.diff(run.place[:, 0, 0])
        assert gone.min() >= 0.0 and run.rate[:, 0, 0].min() >= 0.0 and run.rate[-1, 0, 0] < 1e-9
        assert np.diff(run.energy["kinetic"]).max() <= 0.0 and np.diff(run.energy["leapfrog"]).max() <= 0.0
        assert run.energy["damping"][-1] == pytest.approx(0.5 * MASS * 0.5**2, rel=1e-12) and run.residual < 1e-12


def shaken(analysis: dict[str, Any], dampers: list[dict[str, Any]]) -> tuple[np.ndarray, np.ndarray, Any]:
    """Times, greatest displacement of the centroid and results of a block under a sine pulse."""
    kind = str(analysis["kind"])
    deck = {
        "structure": {"kind": "block", "width": 1.0, "height": 4.0},
        "motion": {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.8},
        "dampers": dampers,
        "analysis": {"end_time": 3.0, **analysis},
    }
    run = extrados.run(deck)
    results, arrays = run[kind], run.arrays[kind]
    if "turn" in arrays:  # in space, about y
        return arrays["time"].numbers, arrays["turn"].numbers[:, 0, 1], results
    rotation = arrays["rotation"].numbers
    return arrays["time"].numbers, rotation if rotation.ndim == 1 else rotation[:, 0], results


VISCOUS: dict[str, Any] = {"start": [0.5, 3.5], "ground": [3.5, 3.5], "damping": "8 kN*s/m"}
SLIDING: dict[str, Any] = {"start": [0.5, 3.5], "ground": [3.5, 3.5], "slip_force": "3 kN", "stiffness": "5 MN/m"}


@pytest.mark.parametrize("solver", ["nonsmooth", "compliant", "space"])
@pytest.mark.parametrize("damper", [VISCOUS, SLIDING])
def test_a_damped_block_rocks_as_by_the_equation_of_rocking(damper: dict[str, Any], solver: str) -> None:
    """Elements against the one degree of freedom with Housner's impacts and the law of the damper."""
    if solver == "space":
        high = {**damper, "start": [0.5, 0.0, 3.5], "ground": [3.5, 0.0, 3.5]}
        time, rotation, results = shaken({"kind": "dem", "solver": "nonsmooth", "direction": 0.0}, [high])
    else:
        time, rotation, results = shaken({"kind": "dem", "solver": solver}, [damper])
    by_equation, free = (np.interp(time, *shaken({"kind": "rocking"}, dampers)[:2]) for dampers in ([damper], []))
    most = float(np.abs(by_equation).max())
    assert np.abs(by_equation - free).max() > 0.2 * most  # the damper matters
    assert rotation == pytest.approx(by_equation, abs=0.06 * most)
    assert results.ties[0].state == ("viscous" if "damping" in damper else "yielded")


@pytest.mark.parametrize("damping", ["1 kN*s/m", "100 MN*s/m"])
@pytest.mark.parametrize("solver", ["nonsmooth", "compliant", "space"])
def test_a_viscous_damper_takes_no_part_in_a_tilt_test(solver: str, damping: str) -> None:
    """b/h = 0.25 g whatever its damping, which carried up to eight times as much while the push was brought in."""
    damper: dict[str, Any] = {**VISCOUS, "damping": damping}
    asked: dict[str, Any] = {"kind": "dem", "test": "tilt", "solver": "nonsmooth"}
    if solver == "space":
        asked["direction"] = 0.0
        damper |= {"start": [0.5, 0.0, 3.5], "ground": [3.5, 0.0, 3.5]}
    else:
        asked["solver"] = solver
    structure = {"kind": "block", "width": 1.0, "height": 4.0}
    joints = {"friction": 0.7, "normal_stiffness": 2e10}
    found = extrados.run({"structure": structure, "joints": joints, "dampers": [damper], "analysis": asked}).results[0]
    assert found["collapse_acceleration_g"] == pytest.approx(0.25, rel=5e-3)
    assert found["collapse_acceleration_opposite_g"] == pytest.approx(0.25, rel=5e-3)
    assert any("dem does not use this key: a viscous damper has no force in statics" in text for text in found.warnings)
    assert "ties" not in found.results


def test_a_viscous_damper_has_no_force_in_a_quasi_static_run() -> None:
    run = {"kind": "dem", "solver": "nonsmooth", "quasi_static": True, "end_time": 0.1}
    deck = {"structure": {"kind": "block", "width": 1.0, "height": 4.0}, "dampers": [VISCOUS, SLIDING], "analysis": run}
    found = extrados.run(deck).results[0]
    assert [text for text in found.warnings if "dem does not use this key: a viscous damper has no force in statics" in text]
    assert [row.name for row in found["ties"]] == ["damper 2"]


def test_a_viscous_damper_acts_in_a_domain() -> None:
    asked = {"kind": "dem-domain", "amplitudes": ["0.7 g"], "durations": [0.2, 0.8], "accuracy": 0.1}
    free, held = ({"structure": {"kind": "block", "width": 1.0, "height": 4.0}, "dampers": d, "analysis": asked} for d in ([], [VISCOUS]))
    found = [extrados.run(deck).results[0] for deck in (free, held)]
    assert [run.status for run in found] == ["ok", "ok"]
    assert not any("damper" in text for text in found[1].warnings)
    shortest = [float(run["shortest_durations_s"][0]) for run in found]
    assert shortest[1] > 1.5 * shortest[0]


def test_dampers_in_space_need_three_coordinates() -> None:
    with pytest.raises(Exception, match=r"blocks in space need \[x, y, z\] of both ends of a damper"):
        shaken({"kind": "dem", "direction": 0.0}, [VISCOUS])
    with pytest.raises(Exception, match=r"in a plane section a damper requires points"):
        shaken({"kind": "dem"}, [{**VISCOUS, "start": [0.5, 0.0, 3.5], "ground": [3.5, 0.0, 3.5]}])
