"""Rigid contacts in space (Moreau-Jean time stepping): exact solutions, the plane solver, Housner's block, the ledger."""

from dataclasses import replace

import numpy as np
import pytest
from dem_models import G, block_on_floor, constant, cosine, housner, pieces
from interrupting import interrupted
from scipy.spatial.transform import Rotation
from test_dem3_core import solids

from extrados import _core
from extrados.core import dem, dem3, dem_run
from extrados.core.errors import CoreError
from extrados.core.ground import as_motion_set
from extrados.model.geometry.solids.assembly import mass_properties
from extrados.model.geometry.solids.polyhedra import Polyhedron, box, prism

ANY = 1e9  # stiffness: rigid contacts do not ask for it


def law(friction: float) -> dem3.Law:
    return dem3.Law(ANY, ANY, friction)


def options(end: float, output: float = 0.01, **keys: object) -> dem3.Options:
    return dem3.Options(end, output, rigid=True, **keys)


def drums(count: int, sides: int = 12, height: float = 1.0) -> list[Polyhedron]:
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = 0.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    return [prism(ring, k * height, (k + 1) * height) for k in range(count)]


def slope(tangent: float, direction: float) -> tuple[float, float, float]:
    """Gravity as a slope in a direction [degrees] feels it."""
    angle, turn = np.arctan(tangent), np.radians(direction)
    along = G * np.sin(angle)
    return (float(along * np.cos(turn)), float(along * np.sin(turn)), float(-G * np.cos(angle)))


STILL = np.zeros((2, 6))


@pytest.mark.parametrize("direction", [0.0, 33.0, 120.0, 251.0])
def test_sliding_down_a_slope_in_any_direction(direction: float) -> None:
    """Coulomb's cone to rounding: straight down the slope, at g (sin - mu cos), whichever way the block lies."""
    mu, gravity, turn = 0.3, slope(np.tan(np.radians(25.0)), direction), np.radians(direction)
    run = dem3.run(solids([box((-1, -1, 0), (1, 1, 0.2))], law(mu)), options(1.0, 0.5, gravity=gravity, step=1e-3), rate=STILL)
    gone = run.place[-1, 0] - run.place[0, 0]
    exact = 0.5 * (np.hypot(*gravity[:2]) + mu * gravity[2]) * run.time[-1] ** 2
    assert gone == pytest.approx(exact * np.array([np.cos(turn), np.sin(turn), 0.0]), abs=1e-10 * exact)
    assert run.turn[-1, 0] == pytest.approx(np.eye(3), abs=1e-12)
    assert run.effort.open_steps == 0 and run.effort.residual <= 1e-5 and run.residual < 1e-6


def test_a_block_in_the_air_falls_freely() -> None:
    """Searches on its way find nothing that touches: a problem without a single point."""
    up = np.zeros((2, 6))
    up[0, :3] = 0.5, 0.0, 3.0
    run = dem3.run(solids([box((-1, -1, 0), (1, 1, 0.2))], law(0.3)), options(0.6, 0.1, gravity=(0.0, 0.0, -G), step=1e-3), rate=up)
    t = run.time
    assert run.place[:, 0] - run.place[0, 0] == pytest.approx(np.column_stack([0.5 * t, 0.0 * t, 3.0 * t - 0.5 * G * t**2]), abs=2e-3)
    assert run.searches > 2 and run.effort.factors < 0.1 * run.effort.steps


@pytest.mark.parametrize("direction", [0.0, 45.0, 200.0])
def test_what_friction_holds_does_not_creep(direction: float) -> None:
    for share, moves in ((0.9999, False), (1.0001, True)):
        block = solids([box((-1, -1, 0), (1, 1, 0.2))], law(0.6))
        run = dem3.run(block, options(1.0, gravity=slope(0.6 * share, direction)), rate=STILL)
        gone = float(np.linalg.norm(run.place[-1, 0] - run.place[0, 0]))
        assert gone > 1e-5 if moves else gone < 1e-12


def test_a_block_that_spins_is_stopped_by_its_corners() -> None:
    """Each carries a quarter of the weight and slides across its arm r: the spin falls by mu g r m / J to nothing."""
    block, mu, spin = box((-0.5, -0.3, 0), (0.5, 0.3, 0.2)), 0.4, 3.0
    mass, _, inertia = mass_properties([block], 2000.0)
    rate = STILL.copy()
    rate[0, 5] = spin
    run = dem3.run(solids([block], law(mu)), options(1.0, 0.02, step=1e-3), rate=rate)
    lost = mu * G * np.hypot(0.5, 0.3) * mass / inertia[2, 2]
    assert run.rate[:, 0, 5] == pytest.approx(np.maximum(spin - lost * run.time, 0.0), abs=1e-3 * spin)
    assert run.energy["friction"][-1] == pytest.approx(0.5 * inertia[2, 2] * spin**2, rel=2e-3)
    assert np.abs(run.place[-1, 0] - run.place[0, 0]).max() < 1e-9


def test_what_slides_and_turns_at_once_takes_few_factorisations() -> None:
    """Newton's matrix knows how friction turns with the sliding: without that it takes some 300 a step."""
    rate = STILL.copy()
    rate[0] = [1.0, 0.3, 0.0, 0.0, 0.0, 3.0]
    run = dem3.run(solids([box((-0.5, -0.3, 0), (0.5, 0.3, 0.2))], law(0.4)), options(0.3, step=1e-3), rate=rate)
    assert run.effort.open_steps == 0 and run.effort.factors < 30 * run.effort.steps
    lost = run.energy["kinetic"][0] - run.energy["kinetic"][-1]
    assert run.energy["friction"][-1] == pytest.approx(lost, rel=1e-3) and lost > 0.5 * run.energy["kinetic"][0]


@pytest.mark.parametrize("rebound", [0.0, 0.5, 0.8])
def test_a_flat_fall_rebounds_as_newton_says(rebound: float) -> None:
    block = box((0, 0, 0), (1, 1, 1)).moved(np.eye(3), np.array([0.0, 0.0, 0.1]))
    run = dem3.run(solids([block], law(0.6)), options(0.5, 1e-3, step=1e-4, rebound=rebound), rate=STILL)
    fall = np.sqrt(2.0 * 0.1 / G)
    before = run.time < fall
    assert run.place[before, 0, 2] - 0.6 == pytest.approx(-0.5 * G * run.time[before] ** 2, abs=1e-12)
    height = run.place[run.time > fall * (1.0 + 0.5 * rebound), 0, 2] - 0.5
    assert height.max() == pytest.approx(0.1 * rebound**2, abs=1e-4)
    assert run.turn[-1, 0] == pytest.approx(np.eye(3), abs=1e-9)


def rocked(step: float, way: tuple[float, float, float] = (1.0, 0.0, 0.0)) -> tuple[np.ndarray, dem3.Run]:
    """Rotation of a block of 1 x 1 x 4 m towards the way of the ground, .5 g cos 10.88 t over 5 s, and the run."""
    block = solids([box((-0.5, -0.5, 0), (0.5, 0.5, 4))], law(2.0))
    run = dem3.run(block, options(5.0, step=step, way=way), cosine(0.5 * G, 10.88))
    up = run.turn[:, 0, :, 2]
    return np.arctan2(up @ np.array(way), up[:, 2]), run


@pytest.mark.parametrize(("step", "most", "apart"), [(1e-3, 2.5e-3, 1e-3), (2.5e-4, 8e-4, 2e-3)])
@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_a_rocking_block_follows_housner_and_the_plane_solver(
    step: float, most: float, apart: float, way: tuple[float, float, float]
) -> None:
    """In both planes: RMS over 5 s over alpha; the plane solver through all impacts within a share of its greatest turn."""
    turn, run = rocked(step, way)
    exact = housner(1.0, 4.0, 0.5 * G, 10.88, run.time)
    assert np.sqrt(np.mean((turn - exact) ** 2)) / np.arctan(0.25) < most
    plane = dem.run(block_on_floor(1.0, 4.0, dem.Law(ANY, ANY, 2.0)), dem.Options(5.0, rigid=True, step=step), cosine(0.5 * G, 10.88))
    assert np.abs(turn + plane.place[:, 0, 2]).max() < apart * np.abs(turn).max()
    across = [k for k in range(2) if not way[k]]
    assert np.abs(run.place[:, 0, across]).max() < 1e-9
    assert run.effort.open_steps == 0 and run.residual < 0.01


@pytest.mark.parametrize(("ratio", "topples"), [(0.999, False), (1.001, True)])
def test_a_block_topples_at_its_slenderness_across_an_edge(ratio: float, topples: bool) -> None:
    """Along 30 degrees the edge that it turns about stands at half its width over the cosine."""
    turn = np.radians(30.0)
    block = solids([box((-0.5, -0.5, 0), (0.5, 0.5, 4))], law(2.0))
    given = options(8.0, 0.1, collapse=0.5, step=2e-3, way=(np.cos(turn), np.sin(turn), 0.0))
    run = dem3.run(block, given, constant(ratio * 0.25 * G / np.cos(turn)))
    assert (run.reason == "collapse") == topples
    if not topples:
        assert np.abs(run.place[:, 0] - run.settled[0]).max() < 1e-9


@pytest.mark.parametrize("direction", [0.0, 50.0])
def test_without_inertia_it_falls_where_statics_say(direction: float) -> None:
    """A push that grows slowly: a column of three drums of 12 sides falls at the reach of the polygon over half its height."""
    turn = np.radians(direction)
    given = options(10.0, 0.05, collapse=0.1, quasi_static=True, way=(np.cos(turn), np.sin(turn), 0.0), stop_at_rest=False)
    ramp = replace(pieces([0.0, 20.0], [0.0]), linear=np.array([[[0.0, 0.05 * G]]]))
    run = dem3.run(solids(drums(3), law(2.0)), given, ramp)
    reach = 0.5 * np.cos(np.radians(15.0)) / np.cos(np.radians(direction % 30.0 - 15.0))
    assert run.reason == "collapse"
    assert 0.05 * run.stop_time == pytest.approx(reach / 1.5, rel=0.01)


def test_without_inertia_nothing_goes_on_by_itself() -> None:
    rate = STILL.copy()
    rate[0] = [0.3, 0.1, 0.0, 0.0, 0.0, 3.0]
    block = solids([box((-0.5, -0.3, 0), (0.5, 0.3, 0.2))], law(0.0))
    run = dem3.run(block, options(1.0, quasi_static=True), rate=rate)
    assert run.reason == "end" and np.abs(run.turn[-1, 0] - np.eye(3)).max() < 1e-12
    assert np.abs(run.place[-1, 0] - run.place[0, 0]).max() < 1e-12


def test_energy_is_never_gained() -> None:
    """A drum set down on its rim and turning wobbles: what moves and what is lifted only falls, as do the losses rise."""
    drum = drums(1, 24, 2.0)[0].moved(Rotation.from_rotvec([0.0, 0.12, 0.0]).as_matrix())
    drum = drum.moved(np.eye(3), np.array([0.0, 0.0, -drum.low[2]]))
    rate = STILL.copy()
    rate[0, 5] = 0.8
    run = dem3.run(solids([drum], law(0.6)), options(3.0, 0.01, step=5e-4), rate=rate)
    whole = run.energy["leapfrog"] + run.energy["potential"]
    most = np.ptp(run.energy["potential"]) + run.energy["kinetic"].max()
    assert run.reason == "end" and run.residual < 0.01
    assert np.diff(whole).max() < 1e-3 * most
    assert whole[0] - whole[-1] == pytest.approx(run.energy["friction"][-1] + run.energy["damping"][-1], abs=0.01 * most)
    assert run.energy["damping"][-1] > 0.1 * most


@pytest.mark.parametrize("rebound", [0.2, 0.8])
def test_a_rebound_takes_no_more_than_it_keeps(rebound: float) -> None:
    """A look at the ledger in the midst of a rebound, when half of its impulse is booked, is no alarm: in both rooms."""
    ground, given = cosine(0.6 * G, 2.0 * np.pi / 0.6), {"end_time": 0.6, "output_step": 0.002, "rigid": True}
    space = dem3.run(solids(drums(2, 8), law(0.7)), dem3.Options(**given, rebound=rebound), ground)
    plane = dem.run(block_on_floor(1.0, 2.0, dem.Law(ANY, ANY, 0.7)), dem.Options(**given, rebound=rebound), ground)
    for run in (space, plane):
        assert run.reason == "end" and run.residual < 1e-3
        assert run.bounces[0] > 0 and run.energy["damping"][-1] > 0.0


def pile() -> dem3.Solids:
    """A wall of six stones in two courses."""
    parts = [box((x, 0, z), (x + 0.5, 0.3, z + 0.25)) for z in (0.0, 0.25) for x in (0.0, 0.5, 1.0)]
    return solids(parts, law(0.5))


def test_threads_and_pauses_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    given = options(0.3, 0.02, way=(0.6, 0.8, 0.0))
    monkeypatch.setattr(dem_run, "FIRST_PAUSE", 50)
    with as_motion_set([cosine(8.0, 12.0, 0.3)]) as motions:
        with dem3.Model(pile(), given) as one:
            whole = one.run(motions)
        states: list[np.ndarray] = []
        with dem3.Model(pile(), replace(given, threads=2)) as two:
            watched = two.run(motions, watch=lambda t: states.append(two.state()))
        with dem3.Model(pile(), given) as three:
            resumed = three.run(motions, state=states[0])
    assert whole.energy["friction"][-1] > 0.0 and whole.effort.steps > 100
    for other in (watched, resumed):
        for name in ("place", "turn", "rate"):
            np.testing.assert_array_equal(getattr(other, name), getattr(whole, name))
        assert other.effort == whole.effort


def test_cancel_answers_with_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dem_run, "long_call", interrupted(dem_run.long_call, 0.5, lambda: _core.api_support.set_cancel(1)))
    block = solids([box((-0.5, -0.5, 0), (0.5, 0.5, 4))], law(2.0))
    run = dem3.run(block, options(36000.0, 0.5), cosine(0.5 * G, 10.88, 36000.0))
    _core.api_support.set_cancel(0)
    assert run.interrupted and len(run.time) > 1 and np.isfinite(run.place).all()


def test_what_is_no_number_ends_the_run() -> None:
    block = solids([box((-0.5, -0.5, 0), (0.5, 0.5, 4))], law(2.0))
    rate = STILL.copy()
    rate[0, :3] = 1e306
    with pytest.raises(CoreError, match="finite"):
        dem3.run(block, options(0.1, step=1e-3), rate=rate)


def test_a_rebound_out_of_bounds_is_refused() -> None:
    with pytest.raises(CoreError, match="rebound of rigid contacts"):
        dem3.run(pile(), options(0.1, rebound=1.5))
