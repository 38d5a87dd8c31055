"""Discrete elements in space: free rotation, rest, friction in any direction, the plane solver, limit analysis, the ledger."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from extrados.core import dem, dem3, dem_run
from extrados.core.dem3 import Law, Options, Solids
from extrados.core.errors import CoreError
from extrados.core.ground import Ground, as_motion_set
from extrados.limit.solids import Programme, SolidLimit
from extrados.model.geometry.solids.assembly import Stone, assemble, mass_properties
from extrados.model.geometry.solids.polyhedra import Polyhedron, box, prism
from extrados.schema.constants import GRAVITY

DENSITY = 2000.0
FLOOR = box((-20, -20, -1), (20, 20, 0))


def solids(parts: list[Polyhedron], law: Law, *, floor: bool = True) -> Solids:
    """Bodies of a part each, on a floor whose top is level 0."""
    found = [mass_properties([p], DENSITY) for p in parts]
    mass, centre, inertia = ([row[k] for row in found] for k in range(3))
    if floor:
        parts = [*parts, FLOOR]
        mass, centre, inertia = [*mass, 0.0], [*centre, np.array([0, 0, -0.5])], [*inertia, np.eye(3)]
    return Solids(
        np.array(centre),
        np.array(mass),
        np.array(inertia),
        [p.vertices for p in parts],
        [p.faces for p in parts],
        list(range(len(parts))),
        [law],
    )


def test_a_free_body_turns_as_euler_says() -> None:
    """About its middle axis, where free rotation tumbles; against the equations of a rigid body by another integrator."""
    body = box((0, 0, 0), (0.3, 0.5, 0.9)).moved(Rotation.from_rotvec([0.4, -0.2, 0.7]).as_matrix())
    inertia = mass_properties([body], DENSITY)[2]
    spin = np.array([0.3, 4.0, 0.2])
    still = Options(end_time=2.0, step=2e-4, output_step=0.5, gravity=(0, 0, 0))
    run = dem3.run(solids([body], Law(1e3, 1e3, 0.5), floor=False), still, rate=np.array([[0, 0, 0, *spin]]))
    assert run.reason == "end"
    swing = inertia @ spin

    def euler(_: float, state: np.ndarray) -> np.ndarray:
        turn = state.reshape(3, 3)
        x, y, z = turn @ np.linalg.solve(inertia, turn.T @ swing)
        return (np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ turn).ravel()

    exact = solve_ivp(euler, (0.0, 2.0), np.eye(3).ravel(), rtol=1e-11, atol=1e-12, t_eval=run.time)
    assert run.turn[:, 0] == pytest.approx(exact.y.T.reshape(-1, 3, 3), abs=2e-6)
    for turn, rate in zip(run.turn[:, 0], run.rate[:, 0], strict=True):
        assert (turn @ inertia @ turn.T) @ rate[3:] == pytest.approx(swing, rel=1e-6)


def test_a_block_settles_as_far_as_its_joint_gives() -> None:
    run = dem3.run(solids([box((0, 0, 0), (1, 1, 4))], Law(1e9, 1e9, 0.6, damping=1e-4)), Options(end_time=0.2))
    assert run.reason == "end" and 2.0 - run.place[-1, 0, 2] == pytest.approx(DENSITY * GRAVITY * 4.0 / 1e9, rel=1e-5)
    assert run.residual < 1e-9


@pytest.mark.parametrize("sides", [48, 96])
def test_round_drums_are_in_contact_over_all_of_their_faces(sides: int) -> None:
    """Two drums settle level, by what the whole polygons give."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = 0.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    run = dem3.run(solids([prism(ring, k * 1.0, k + 1.0) for k in range(2)], Law(1e9, 1e9, 0.6, damping=1e-4)), Options(end_time=0.05))
    assert [0.5 - run.place[-1, 0, 2], 1.5 - run.place[-1, 1, 2]] == pytest.approx(
        [DENSITY * GRAVITY * 2.0 / 1e9, DENSITY * GRAVITY * 3.0 / 1e9], rel=1e-3
    )
    assert run.turn[-1, :2] == pytest.approx(np.broadcast_to(np.eye(3), (2, 3, 3)), abs=2e-6)


def test_a_tiny_step_of_the_run_keeps_nothing_from_rest() -> None:
    block = solids([box((0, 0, 0), (1, 1, 4))], Law(1e9, 1e9, 0.6, damping=1e-4))
    run = dem3.run(block, Options(end_time=1e-5, step=1e-6, settle_steps=4000))
    assert run.reason == "end" and run.settling_steps < 4000 and run.step == pytest.approx(1e-6)


def test_an_energy_ledger_that_does_not_close_names_the_fastest_body() -> None:
    pile = solids([box((0, 0, z), (1, 1, z + 1)) for z in (0, 1)], Law(1e8, 1e8, 0.6))
    quick = np.array([[0, 0, 0, 0, 0, 0], [2.0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]])
    run = dem3.run(pile, Options(end_time=1.0, residual_limit=1e-14), rate=quick)
    assert run.reason == "blow-up" and run.blamed == [1] and run.stop_time < 1.0


@pytest.mark.parametrize("direction", [0.0, 33.0, 120.0, 251.0])
def test_sliding_down_a_slope_in_any_direction(direction: float) -> None:
    """Coulomb's cone: straight down the slope, at g (sin - mu cos), whichever way the block lies."""
    slope, mu, turn = np.radians(25.0), 0.3, np.radians(direction)
    gravity = GRAVITY * np.array([np.sin(slope) * np.cos(turn), np.sin(slope) * np.sin(turn), -np.cos(slope)])
    model = solids([box((-1, -1, 0), (1, 1, 0.2))], Law(1e9, 1e9, mu, damping=1e-4))
    run = dem3.run(model, Options(end_time=1.0, gravity=tuple(gravity), output_step=0.5), rate=np.zeros((2, 6)))
    gone = run.place[-1, 0, :2] - run.place[0, 0, :2]
    exact = 0.5 * GRAVITY * (np.sin(slope) - mu * np.cos(slope)) * run.time[-1] ** 2
    assert gone == pytest.approx(exact * np.array([np.cos(turn), np.sin(turn)]), abs=1e-5 * exact)
    assert run.turn[-1, 0] == pytest.approx(np.eye(3), abs=1e-6) and run.residual < 1e-9
    held = dem3.run(replace(model, laws=[Law(1e9, 1e9, 0.5, damping=1e-4)]), Options(end_time=0.5, gravity=tuple(gravity)))
    assert np.abs(held.place[-1, 0] - held.place[0, 0]).max() < 1e-7  # tan 25 = .466 < .5


K, MU, BETA, WIDE, HIGH = 1e9, 0.7, 2e-4, 1.0, 4.0


def shaken(seconds: float) -> Ground:
    """The thesis' rocking block, Fig. 7-1: .5 g cos 10.88 t."""
    t = np.arange(0.0, seconds + 1e-9, 1e-3)
    return Ground(samples=(0.5 * GRAVITY * np.cos(10.88 * t))[None], step=1e-3)


def rocking(seconds: float, way: tuple[float, float, float] = (1.0, 0.0, 0.0), **options: Any) -> tuple[np.ndarray, dem3.Run]:
    """Rotation towards the way of the ground over time, and the run."""
    half = np.array([0.5 * WIDE, 0.5, 0.0]) if way[0] else np.array([0.5, 0.5 * WIDE, 0.0])
    given = Options(**{"end_time": seconds, "step": 5e-5, "way": way, **options})
    run = dem3.run(solids([box(-half, half + np.array([0, 0, HIGH]))], Law(K, K, MU, damping=BETA)), given, shaken(seconds))
    up = run.turn[:, 0, :, 2]
    return np.arctan2(up @ np.array(way), up[:, 2]), run


def test_a_plane_problem_is_that_of_the_plane_solver() -> None:
    """Two impacts: the same history within what the springs give; nothing leaves the plane."""
    outline = np.array([[-0.5 * WIDE, 0], [0.5 * WIDE, 0], [0.5 * WIDE, HIGH], [-0.5 * WIDE, HIGH]])
    floor = np.array([[-20, -1], [20, -1], [20, 0], [-20, 0.0]])
    mass = DENSITY * WIDE * HIGH
    bodies = dem.Bodies(
        np.array([[0, 0.5 * HIGH], [0, -0.5]]),
        np.array([mass, 0.0]),
        np.array([mass * (WIDE**2 + HIGH**2) / 12.0, 0.0]),
        [outline, floor],
        [0, 1],
        [np.ones(4, dtype=bool)] * 2,
        1.0,
        [dem.Law(K, K, MU, damping=BETA)],
    )
    for step in (2e-4, 5e-5):
        plane = -dem.run(bodies, dem.Options(end_time=1.5, step=step), shaken(1.5)).place[:, 0, 2]
        space, run = rocking(1.5, step=step)
        assert np.abs(plane - space).max() < 1.5e-3 * np.abs(plane).max()
        assert np.abs(run.place[:, 0, 1]).max() < 1e-6 and np.abs(run.turn[:, 0, 1, 0]).max() < 1e-6
        assert run.residual < 1e-4


def test_a_block_that_slides_off_an_edge_falls_as_in_the_plane() -> None:
    """The contact goes with the last of the face that bears it, and holds nothing beside the edge."""
    size, at = 0.2, 20.0 - 0.2
    outline = np.array([[at, 0], [at + size, 0], [at + size, size], [at, size]]) - np.array([0.5 * size, 0.0])
    floor = np.array([[-20, -1], [20, -1], [20, 0], [-20, 0.0]])
    mass = DENSITY * size**2
    bodies = dem.Bodies(
        np.array([[at, 0.5 * size], [0, -0.5]]),
        np.array([mass, 0.0]),
        np.array([mass * size**2 / 6.0, 0.0]),
        [outline, floor],
        [0, 1],
        [np.ones(4, dtype=bool)] * 2,
        1.0,
        [dem.Law(1e9, 1e9, 0.0, damping=1e-5)],
    )
    block = box((at - 0.5 * size, -0.5, 0), (at + 0.5 * size, 0.5, size))
    for speed in (1.0, 3.0):
        given = {"end_time": 0.4 / speed + 0.2, "step": 5e-6, "residual_limit": 1.0}
        plane = dem.run(bodies, dem.Options(**given), rate=np.array([[speed, 0, 0], np.zeros(3)]))
        space = dem3.run(
            solids([block], Law(1e9, 1e9, 0.0, damping=1e-5)), Options(**given), rate=np.array([[speed, 0, 0, 0, 0, 0], np.zeros(6)])
        )
        fallen = plane.place[0, 0, 1] - plane.place[-1, 0, 1]
        assert fallen > 0.1
        assert space.place[0, 0, 2] - space.place[-1, 0, 2] == pytest.approx(fallen, rel=5e-3)


def test_a_dashpot_foresees_what_shear_does_to_its_speed() -> None:
    """A leaning rod that lands: friction at its foot turns it, and so slows the foot. A step that is fifty times the finest
    is off by 1.0e-5 m; without that foresight by 2.1e-5."""
    rod = box((-0.05, -0.05, -1), (0.05, 0.05, 1)).moved(Rotation.from_rotvec([0, np.radians(30.0), 0]).as_matrix())
    rod = rod.moved(np.eye(3), np.array([0, 0, 1e-4 - rod.vertices[:, 2].min()]))
    model, rate = solids([rod], Law(1e9, 1e9, 1.0, damping=1e-2)), np.array([[0.5, 0, -1.0, 0, 0, 0], np.zeros(6)])

    def way(step: float) -> np.ndarray:
        return dem3.run(model, Options(end_time=0.06, step=step, residual_limit=1.0), rate=rate).place[:, 0]

    fine = way(2e-6)
    assert np.abs(fine - fine[0]).max() > 0.04
    assert np.abs(way(1e-4) - fine).max() < 1.5e-5


def test_both_planes_rock_alike() -> None:
    along, _ = rocking(0.8)
    across, _ = rocking(0.8, (0.0, 1.0, 0.0))
    assert across == pytest.approx(along, abs=1e-7)


def test_two_components_are_one_along_their_sum() -> None:
    """A motion along 30 degrees is its parts along x and y, whichever of them is called along."""
    block = solids([box((-0.5, -0.5, 0), (0.5, 0.5, HIGH))], Law(K, K, MU, damping=BETA))
    one, turn = shaken(0.3), np.radians(30.0)
    assert one.samples is not None
    part = [Ground(samples=f * one.samples, step=one.step) for f in (np.cos(turn), np.sin(turn), -np.cos(turn))]
    given = Options(end_time=0.3, step=2e-4)
    whole = dem3.run(block, replace(given, way=(np.cos(turn), np.sin(turn), 0.0)), one)
    along_x = dem3.run(block, given, part[0], across=part[1])
    along_y = dem3.run(block, replace(given, way=(0.0, 1.0, 0.0)), part[1], across=part[2])
    assert np.abs(whole.place[:, 0] - whole.settled[0]).max() > 0.01
    for run in (along_x, along_y):
        assert run.place == pytest.approx(whole.place, abs=1e-9) and run.residual < 1e-2
    with dem3.Model(block, given) as model, as_motion_set(part[:2]) as motions:
        with pytest.raises(IndexError, match="motion number 5 does not exist: the set has 2"):
            model.run(motions, across=5)


def test_sliding_on_ground_that_moves_in_a_circle() -> None:
    """Against the equation of a point with Coulomb friction, u'' = -a(t) - mu g u'/|u'|, by another integrator."""
    mu, strength, pace = 0.3, 0.5 * GRAVITY, 4.0 * np.pi
    grounds = [
        Ground(breaks=np.array([0.0, 1.0]), linear=np.zeros((1, 1, 2)), harmonic=np.array([[[[strength, 0.0, pace, phase]]]]))
        for phase in (0.5 * np.pi, 0.0)
    ]
    slab = solids([box((-1, -1, 0), (1, 1, 0.2))], Law(1e10, 1e10, mu, damping=1e-5))
    run = dem3.run(slab, Options(end_time=1.0), grounds[0], across=grounds[1])

    def point(t: float, state: np.ndarray) -> np.ndarray:
        speed = max(float(np.hypot(*state[2:])), 1e-12)
        pull = -strength * np.array([np.cos(pace * t), np.sin(pace * t)])
        return np.concatenate([state[2:], pull - mu * GRAVITY * state[2:] / speed])

    start = 1e-6  # it slides from the first
    exact = solve_ivp(point, (0.0, 1.0), [0.0, 0.0, -start * (strength - mu * GRAVITY), 0.0], rtol=1e-9, atol=1e-12, t_eval=run.time)
    gone = run.place[:, 0, :2] - run.settled[0, :2]
    assert np.linalg.norm(gone, axis=1).max() > 0.02
    assert gone == pytest.approx(exact.y[:2].T, abs=2e-3 * np.abs(gone).max())


def test_no_bit_depends_on_threads_pauses_or_a_state_taken_back(monkeypatch) -> None:
    """A wall of six stones in two courses that rocks and slides; a state of another run is refused."""
    parts = [box((x, 0, z), (x + 0.5, 0.3, z + 0.25)) for z in (0.0, 0.25) for x in (0.0, 0.5, 1.0)]
    model, options = (solids(parts, Law(1e9, 1e9, 0.5, damping=1e-4)), Options(end_time=0.02, output_step=0.005, way=(0.6, 0.8, 0.0)))
    once = dem3.run(model, options, shaken(1.0), scale=3.0)
    assert once.reason == "end" and np.abs(once.place[-1] - once.place[0]).max() > 1e-5
    monkeypatch.setattr(dem_run, "FIRST_PAUSE", 5)
    kept = []
    with dem3.Model(model, replace(options, threads=2)) as other, as_motion_set([shaken(1.0)]) as motions:
        paused = other.run(motions, scale=3.0, watch=lambda reached: kept.append(other.state()))
    with dem3.Model(model, options) as other, as_motion_set([shaken(1.0)]) as motions:
        resumed = other.run(motions, scale=3.0, state=kept[len(kept) // 2])
        for wrong in (kept[0][:-9], np.where(np.arange(len(kept[0])) == 40, 7, kept[0])):
            with pytest.raises(ValueError, match="damaged"):
                other.run(motions, state=wrong)
    with dem3.Model(solids(parts[:3], Law(1e9, 1e9, 0.5)), options) as other, as_motion_set([shaken(1.0)]) as motions:
        with pytest.raises(ValueError, match="another model"):
            other.run(motions, state=kept[0])
    for run in (paused, resumed):
        for name in ("place", "turn", "rate", "settled"):
            assert (getattr(run, name) == getattr(once, name)).all()
        assert run.steps == once.steps and run.residual == once.residual


def test_one_contact_keeps_exact_energy() -> None:
    """A block that falls on its four springs without damping: weight, spring and motion change into each other, and it
    comes back to where it fell from. A dashpot takes away what the ledger says."""
    block = box((0, 0, 0), (1, 1, 1)).moved(np.eye(3), np.array([0.0, 0.0, 0.01]))
    for step, off in ((4e-4, 1e-2), (1e-4, 1e-3)):
        run = dem3.run(solids([block], Law(1e7, 1e7, 0.0)), Options(end_time=0.3, step=step, output_step=step), rate=np.zeros((2, 6)))
        fall = np.ptp(run.place[:, 0, 2])
        assert fall == pytest.approx(0.01 + (r := 2000 * GRAVITY / 1e7) + np.sqrt(r**2 + 0.02 * r), rel=1e-3)
        assert run.residual < off
        assert run.energy["elastic"].max() == pytest.approx(2000.0 * GRAVITY * fall, rel=1e-3)
    damped = dem3.run(solids([block], Law(1e7, 1e7, 0.0, damping=2e-3)), Options(end_time=0.5, step=1e-4), rate=np.zeros((2, 6)))
    lost = damped.energy["damping"][-1]
    assert lost > 0.3 * 2000.0 * GRAVITY * 0.01 and damped.residual < 1e-3


@pytest.mark.verify
@pytest.mark.parametrize("direction", [20.0, 75.0])
def test_a_column_falls_where_limit_analysis_says(direction: float) -> None:
    """Three drums of twelve sides under a constant push along a direction: they stand at .99 of it and fall at 1.01."""
    angle = 2.0 * np.pi * np.arange(12) / 12
    ring = 0.4 * np.column_stack([np.cos(angle), np.sin(angle)])
    parts = [prism(ring, k * 1.0, k + 1.0) for k in range(3)]
    limit = SolidLimit(assemble([Stone(f"drum {k}", [p], DENSITY) for k, p in enumerate(parts)]), 0.7).push(direction)
    assert isinstance(limit, Programme)
    turn = np.radians(direction)
    found = []
    for share in (0.99, 1.01):
        push = share * limit.gamma * GRAVITY
        gravity = (push * np.cos(turn), push * np.sin(turn), -GRAVITY)
        run = dem3.run(
            solids(parts, Law(1e11, 1e11, 0.7, damping=1e-5)),
            Options(end_time=2.0, gravity=gravity, settle_steps=0, collapse=0.05, output_step=0.1),
            rate=np.zeros((4, 6)),
        )
        found.append((run.reason, float(np.linalg.norm(run.place[-1, 2] - run.place[0, 2]))))
    assert run.residual < 1e-3  # of the fall; where it stands next to no energy goes round
    assert found[0][0] == "end" and found[0][1] < 5e-3
    assert found[1][0] == "collapse"


def test_a_wobbling_cylinder_keeps_its_energy_and_its_swing_about_the_vertical() -> None:
    """Set down on its rim and turning, without friction: gravity and the floor have no moment about the vertical."""
    angle = 2.0 * np.pi * np.arange(48) / 48
    drum = prism(0.5 * np.column_stack([np.cos(angle), np.sin(angle)]), 0.0, 2.0)
    tilt = Rotation.from_rotvec([0.0, 0.12, 0.0]).as_matrix()
    tilted = drum.moved(tilt)
    tilted = tilted.moved(np.eye(3), np.array([0, 0, -tilted.low[2]]))
    inertia = mass_properties([tilted], DENSITY)[2]
    spin = np.array([0.0, 0.0, 0.8])
    run = dem3.run(
        solids([tilted], Law(1e9, 1e9, 0.0)),
        Options(end_time=1.5, output_step=0.05, fraction=0.1),
        rate=np.array([[0, 0, 0, *spin], [0.0] * 6]),
    )
    assert run.reason == "end" and run.residual < 2e-3
    swing = [((turn @ inertia @ turn.T) @ rate[3:])[2] for turn, rate in zip(run.turn[:, 0], run.rate[:, 0], strict=True)]
    assert swing == pytest.approx([(inertia @ spin)[2]] * len(swing), rel=1e-6)
    # it turned about the vertical by much, and did not fall
    low = np.arctan2(run.turn[:, 0, 1, 2], run.turn[:, 0, 0, 2])
    assert np.ptp(np.unwrap(low)) > 0.5 and run.turn[:, 0, 2, 2].min() > 0.9


@pytest.mark.parametrize("angle", [90.0, 50.0])
def test_bars_that_cross_rest_on_each_other_by_their_edges(angle: float) -> None:
    """Two bars on edge, one across the other: no face bears the upper one."""
    side = np.array([[0.0, -0.1], [0.1, 0.0], [0.0, 0.1], [-0.1, 0.0]])
    lower = prism(side, -1.0, 1.0).moved(Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix())
    across = Rotation.from_rotvec([0, 0, np.radians(angle)]) * Rotation.from_rotvec([0, np.pi / 2, 0])
    upper = prism(side, -1.5, 1.5).moved(across.as_matrix(), np.array([0, 0, 0.2]))
    model = solids([upper, lower], Law(1e10, 1e10, 0.5, damping=1e-4), floor=False)
    model = replace(model, mass=np.array([model.mass[0], 0.0]))
    run = dem3.run(model, Options(end_time=0.05, output_step=0.01), rate=np.zeros((2, 6)))
    assert run.reason == "end"
    assert abs(run.place[-1, 0, 2] - 0.2) < 1e-3  # in free fall it would be 12 mm lower
    assert run.turn[-1, 0] == pytest.approx(run.turn[0, 0], abs=1e-6)  # they touch under its centroid
    apart = replace(
        model, centroid=model.centroid + np.array([[0, 0, 0.05], [0, 0, 0]]), vertices=[model.vertices[0] + [0, 0, 0.05], model.vertices[1]]
    )
    free = dem3.run(apart, Options(end_time=0.05, output_step=0.01), rate=np.zeros((2, 6)))
    assert free.place[-1, 0, 2] - free.place[0, 0, 2] == pytest.approx(-0.5 * GRAVITY * free.time[-1] ** 2, rel=1e-3)


def test_the_critical_step_knows_which_neighbour_moves() -> None:
    """Between two equal blocks a spring is felt twice: the step is smaller by the root of two."""
    cubes, law = [box((0, 0, k), (1, 1, k + 1)) for k in range(2)], Law(1e9, 1e9, 0.5)
    floating = Options(end_time=1e-3, fraction=0.1, gravity=(0, 0, 0))
    fixed = solids(cubes, law, floor=False)
    fixed = replace(fixed, mass=np.array([0.0, fixed.mass[1]]))
    steps = [dem3.run(m, floating, rate=np.zeros((2, 6))).step for m in (fixed, solids(cubes, law, floor=False))]
    assert steps[0] / steps[1] == pytest.approx(np.sqrt(2.0), rel=5e-3)


def test_dashpots_between_blocks_that_both_move() -> None:
    """Two cubes meet with half of critical damping at a large step: each feels what one feels that meets a support with
    twice the stiffness and the same beta."""
    stiffness, apart, speed, step = 1e9, 1e-4, 0.1, 2e-4
    mass = DENSITY
    beta = 2.0 * 0.5 * np.sqrt(0.5 * mass / stiffness)  # of the reduced mass m / 2
    given = Options(end_time=0.02, output_step=0.001, step=step, gravity=(0, 0, 0), residual_limit=1e9)
    cubes = [box((0, 0, 0), (1, 1, 1)), box((0, 0, 1 + apart), (1, 1, 2 + apart))]
    both = dem3.run(
        solids(cubes, Law(stiffness, stiffness, 0.0, damping=beta), floor=False),
        given,
        rate=np.array([[0, 0, speed, 0, 0, 0], [0, 0, -speed, 0, 0, 0]]),
    )
    wall = solids([cubes[0], box((0, 0, 1 + 0.5 * apart), (1, 1, 2))], Law(2 * stiffness, 2 * stiffness, 0.0, damping=beta), floor=False)
    one = dem3.run(replace(wall, mass=np.array([mass, 0.0])), given, rate=np.array([[0, 0, speed, 0, 0, 0], [0, 0, 0, 0, 0, 0]]))
    assert both.rate[-1, 0, 2] == pytest.approx(-both.rate[-1, 1, 2], rel=1e-9)
    assert -speed < one.rate[-1, 0, 2] < -0.05 * speed
    assert both.rate[-1, 0, 2] == pytest.approx(one.rate[-1, 0, 2], rel=1e-6)


def test_wrong_models_are_refused() -> None:
    good = solids([box((0, 0, 0), (1, 1, 1))], Law(1e9, 1e9, 0.6))
    options = Options(end_time=0.1)
    with pytest.raises(ValueError, match="a face has 97 corners, expected at most 96"):
        angle = 2.0 * np.pi * np.arange(97) / 97
        dem3.run(solids([prism(np.column_stack([np.cos(angle), np.sin(angle)]), 0.0, 1.0)], Law(1e9, 1e9, 0.6)), options)
    with pytest.raises(ValueError, match="stiffnesses"):
        Law(0.0, 1e9, 0.6)
    with pytest.raises(ValueError, match="law that does not exist"):
        dem3.run(replace(good, joints={(0, 1): 3}), options)
    with pytest.raises(IndexError, match="joints contains the index 7"):
        dem3.run(replace(good, joints={(0, 7): 0}), options)
    with pytest.raises(IndexError, match="owner contains the index 5"):
        dem3.run(replace(good, owner=[0, 5]), options)
    with pytest.raises(ValueError, match="not finite"):
        dem3.run(replace(good, vertices=[good.vertices[0] * np.nan, good.vertices[1]]), options)
    with pytest.raises(CoreError, match="outside its range"):
        dem3.run(replace(good, faces=[((0, 1, 99), *good.faces[0][1:]), good.faces[1]]), options)


def hanging(law: Law) -> Solids:
    """A cube of a metre below a support of the same size."""
    model = solids([box((-0.5, -0.5, k), (0.5, 0.5, k + 1)) for k in (0, 1)], law, floor=False)
    dry = replace(law, cohesion=0.0, tension=0.0)
    return replace(model, mass=np.array([model.mass[0], 0.0]), laws=[dry, law], joints={(0, 1): 1})


@pytest.mark.parametrize("share", [0.95, 1.6])
def test_mortar_carries_the_weight_that_hangs_on_it(share: float) -> None:
    """Below its strength a cube hangs, drawn out by weight over stiffness; above it falls freely and the ledger closes."""
    weight, stiffness = DENSITY * GRAVITY, 1e9
    law = Law(stiffness, stiffness, 0.5, damping=2e-3, cohesion=weight, tension=share * weight)
    run = dem3.run(hanging(law), Options(end_time=0.3, output_step=0.01), rate=np.zeros((2, 6)))
    fall = run.place[0, 0, 2] - run.place[-1, 0, 2]
    if share > 1.0:
        assert fall == pytest.approx(weight / stiffness, rel=1e-2)
    else:
        assert fall == pytest.approx(0.5 * GRAVITY * 0.3**2, rel=0.03)
    assert run.residual < 5e-3


@pytest.mark.parametrize("share", [0.95, 1.05])
def test_mortar_must_carry_the_weight_at_rest_after_settling(share: float) -> None:
    """Not the overshoot of a weight that comes at once, which without dashpots is twice as much."""
    weight, stiffness = DENSITY * GRAVITY, 1e9
    law = Law(stiffness, stiffness, 0.5, damping=0.0, cohesion=weight, tension=share * weight)
    run = dem3.run(hanging(law), Options(end_time=0.1, output_step=0.01, settlement=1e-3))
    if share > 1.0:
        assert run.reason == "end" and abs(run.place[:, 0, 2] + 0.5 - 1.0 + weight / stiffness).max() < 1e-3 * weight / stiffness
    else:
        assert run.reason == "unsettled" and run.blamed == [0]


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-4])
@pytest.mark.parametrize("share", [0.9, 2.5])
def test_mortar_carries_shear_by_cohesion(share: float, gap: float) -> None:
    """On a slope without enough friction a cube sticks by cohesion; once that is broken for good, friction alone brakes it."""
    weight, mu, slope = DENSITY * GRAVITY, 0.2, np.radians(35.0)
    pull = GRAVITY * np.array([np.sin(slope), 0.0, -np.cos(slope)])
    needed = weight * (np.sin(slope) - mu * np.cos(slope))
    law = Law(1e9, 1e9, mu, damping=2e-3, cohesion=share * needed, tension=weight)
    cubes = solids([box((-0.5, -0.5, gap), (0.5, 0.5, 1 + gap))], law)  # of a drawing that is not exact: mortar fills it
    model = replace(cubes, laws=[replace(law, cohesion=0.0, tension=0.0), law], joints={(0, 1): 1})
    run = dem3.run(model, Options(end_time=0.5, output_step=0.01, gravity=tuple(pull)), rate=np.zeros((2, 6)))
    way = run.place[-1, 0, 0] - run.place[0, 0, 0]
    if share > 1.0:
        assert way < 1e-4
    else:
        assert way == pytest.approx(0.5 * needed / DENSITY * 0.5**2, rel=0.03)
    assert run.residual < 5e-3


def test_mortar_that_is_sheared_off_is_gone() -> None:
    """A cube sheared off by a jolt comes to rest, and then slides under what friction alone cannot hold, and mortar could."""
    weight, mu = DENSITY * GRAVITY, 0.2
    law = Law(1e9, 1e9, mu, damping=2e-3, cohesion=0.5 * weight, tension=weight)
    cubes = solids([box((-0.5, -0.5, 0), (0.5, 0.5, 1))], law)
    model = replace(cubes, laws=[replace(law, cohesion=0.0, tension=0.0), law], joints={(0, 1): 1})
    t = np.arange(0.0, 1.0, 1e-3)
    for jolt, way in ((0.3, 0.0), (0.9, 0.5 * (0.4 - mu) * GRAVITY * 0.4**2)):
        samples = np.where(t < 0.05, -jolt, np.where(t < 0.6, 0.0, -0.4)) * GRAVITY
        run = dem3.run(model, Options(end_time=0.999, output_step=0.001), Ground(samples=samples[None], step=1e-3))
        at = [int(np.searchsorted(run.time, when)) for when in (0.55, 0.59)]
        assert abs(run.rate[at[0], 0, 0]) < 1e-4
        assert run.place[-1, 0, 0] - run.place[at[1], 0, 0] == pytest.approx(way, rel=0.03, abs=1e-4)


def doweled_cube(strength: float, reach: float = np.inf, stiffness: float = 1e9) -> Solids:
    """A cube on a floor, with a dowel in the middle of its base."""
    model = solids([box((-0.5, -0.5, 0), (0.5, 0.5, 1))], Law(1e9, 1e9, 0.2, damping=1e-4))
    one = dem3.Dowels(
        np.array([[1, 0]]),
        np.zeros((1, 3)),
        np.array([[0.0, 0.0, 1.0]]),
        np.array([stiffness]),
        np.array([strength]),
        np.array([reach]),
        1e-4,
    )
    return replace(model, dowels=one)


@pytest.mark.parametrize("way", [0.0, 50.0, 200.0])
def test_a_dowel_carries_shear_in_any_direction(way: float) -> None:
    """On a slope: an unbroken dowel holds what friction does not, drawn out by that over its stiffness; one that gives way
    brakes with its strength."""
    weight, mu, slope = DENSITY * GRAVITY, 0.2, np.radians(35.0)
    down = np.array([np.cos(np.radians(way)), np.sin(np.radians(way)), 0.0])
    pull = tuple(GRAVITY * (np.sin(slope) * down - [0.0, 0.0, np.cos(slope)]))
    needed = weight * (np.sin(slope) - mu * np.cos(slope))
    given = Options(end_time=0.5, output_step=0.01, gravity=pull)
    held = dem3.run(doweled_cube(np.inf), given)
    assert np.linalg.norm(held.place[-1, 0] - held.place[0, 0]) < 1e-6
    assert held.dowel_slip[0] == 0.0
    strength = 0.4 * needed
    run = dem3.run(doweled_cube(strength), given, rate=np.zeros((2, 6)))
    moved = run.place[-1, 0] - run.place[0, 0]
    assert moved @ down == pytest.approx(0.5 * (needed - strength) / DENSITY * 0.5**2, rel=5e-3)
    assert np.linalg.norm(moved[:2] - (moved @ down) * down[:2]) < 1e-4
    assert run.dowel_slip[0] == pytest.approx(moved @ down, abs=2e-3)  # but for what the cube leans
    assert run.residual < 1e-3


def test_a_cube_swings_on_its_dowel() -> None:
    """Without friction, as an oscillator on the stiffness of the dowel with beta times omega / 2 of critical damping."""
    speed, stiffness, beta, mass = 0.01, 1e6, 1e-2, DENSITY
    model = doweled_cube(np.inf, stiffness=stiffness)
    model = replace(model, laws=[Law(1e9, 1e9, 0.0, damping=1e-3)], dowels=replace(model.dowels, damping=beta))
    run = dem3.run(model, Options(end_time=0.6, output_step=0.002), rate=np.array([[speed, 0, 0, 0, 0, 0], np.zeros(6)]))
    omega = np.sqrt(stiffness / mass)
    ratio = 0.5 * beta * omega
    damped = omega * np.sqrt(1.0 - ratio**2)
    exact = speed / damped * np.exp(-ratio * omega * run.time) * np.sin(damped * run.time)
    assert run.place[:, 0, 0] - run.place[0, 0, 0] == pytest.approx(exact, abs=0.01 * exact.max())


def test_the_critical_step_knows_dowels() -> None:
    """Two floating cubes, half a metre of arm each: omega^2 = 2 k (1 / m + r^2 / J), each as if the other gave way as much."""
    stiffness = 1e12
    apart = solids([box((-0.5, -0.5, k), (0.5, 0.5, k + 1)) for k in (0.0, 1.1)], Law(1e9, 1e9, 0.5), floor=False)
    one = replace(doweled_cube(np.inf).dowels, body=np.array([[0, 1]]), place=np.array([[0.0, 0.0, 1.05]]), stiffness=np.array([stiffness]))
    options = Options(end_time=1e-7, fraction=0.1, gravity=(0, 0, 0))
    step = dem3.run(replace(apart, dowels=one), options, rate=np.zeros((2, 6))).step
    omega2 = 2.0 * stiffness / DENSITY * (1.0 + 6.0 * 0.55**2)
    assert step == pytest.approx(0.1 * 2.0 / np.sqrt(omega2), rel=0.04)


def test_a_dowel_keeps_momentum_and_energy() -> None:
    """Two cubes that float, turning apart, held in the joint by a dowel alone: momentum, moment of momentum and energy."""
    cubes = [box((-0.5, -0.5, k), (0.5, 0.5, k + 0.99)) for k in range(2)]
    model = solids(cubes, Law(1e9, 1e9, 0.0), floor=False)
    one = dem3.Dowels(
        np.array([[0, 1]]),
        np.array([[0.2, 0.1, 0.995]]),
        np.array([[0.0, 0.0, 1.0]]),
        np.array([1e6]),
        np.array([np.inf]),
        np.array([np.inf]),
    )
    rate = np.array([[0.05, 0.02, -0.2, 0.1, 0.0, 0.3], [-0.05, 0.0, 0.2, 0.0, -0.1, -0.2]])
    options = Options(end_time=0.5, output_step=0.05, gravity=(0, 0, 0), step=1e-5)
    run = dem3.run(replace(model, dowels=one), options, rate=rate)
    inertia = run.turn @ model.inertia @ np.swapaxes(run.turn, 2, 3)
    spin = np.einsum("tnij,tnj->tni", inertia, run.rate[:, :, 3:])
    linear = model.mass[:, None] * run.rate[:, :, :3]
    moment = (spin + np.cross(run.place, linear)).sum(axis=1)
    assert np.abs(np.diff(linear.sum(axis=1), axis=0)).max() < 1e-9 * np.abs(linear).max()
    assert np.abs(moment - moment[0]).max() < 1e-4 * np.abs(spin).max()
    assert run.energy["elastic"].max() > 5e-3 * run.energy["kinetic"][0]
    total = run.energy["kinetic"] + run.energy["elastic"]
    assert total == pytest.approx(total[0], rel=1e-4)


def test_a_dowel_comes_out_where_stones_part_farther_than_it_reaches() -> None:
    """Thrown up by less than the reach it lands on its dowel, by more it has lost it and is free to slide."""
    slope = np.radians(35.0)
    pull = (GRAVITY * np.sin(slope), 0.0, -GRAVITY * np.cos(slope))
    for speed, out in ((0.5, False), (1.5, True)):
        height = 0.5 * speed**2 / (GRAVITY * np.cos(slope))
        assert (height > 0.1) == out
        run = dem3.run(
            doweled_cube(np.inf, 0.1),
            Options(end_time=0.8, output_step=0.01, gravity=pull, residual_limit=1.0),
            rate=np.array([[0, 0, speed, 0, 0, 0], [0, 0, 0, 0, 0, 0]]),
        )
        assert bool(run.dowel_out[0]) == out
        assert (run.place[-1, 0, 0] > 0.2) == out


@pytest.mark.parametrize(("reach", "out"), [(0.049, True), (0.051, False)])
def test_a_dowel_reaches_so_far(reach: float, out: bool) -> None:
    """A cube that leaves the floor by 5 cm, without weight."""
    options = Options(end_time=0.5, output_step=0.1, gravity=(0, 0, 0))
    run = dem3.run(doweled_cube(np.inf, reach), options, rate=np.array([[0, 0, 0.1, 0, 0, 0], np.zeros(6)]))
    assert bool(run.dowel_out[0]) == out


def test_dowels_are_checked_and_threads_and_pauses_change_no_bit(monkeypatch) -> None:
    drums = [box((-0.5, -0.5, k), (0.5, 0.5, k + 1)) for k in range(3)]
    model = solids(drums, Law(1e9, 1e9, 0.6, damping=1e-4, tension=1e4, cohesion=1e4))
    pairs = np.array([[3, 0], [0, 1], [1, 2]])
    places, axes, n = np.array([[0, 0, 0.0], [0, 0, 1.0], [0, 0, 2.0]]), np.tile([0.0, 0.0, 1.0], (3, 1)), np.ones(3)
    whole = replace(model, dowels=dem3.Dowels(pairs, places, axes, 1e8 * n, 200.0 * n, [1e-4, 1.0, 1.0] * n, 1e-4))
    options = Options(end_time=0.6, output_step=0.01, residual_limit=1.0)
    runs = [dem3.run(whole, replace(options, threads=k), shaken(0.6), scale=1.5) for k in (1, 2)]
    assert runs[0].dowel_slip.max() > 0.0 and runs[0].dowel_out.any()
    kept = []
    monkeypatch.setattr(dem_run, "FIRST_PAUSE", 50)
    with dem3.Model(whole, options) as other, as_motion_set([shaken(0.6)]) as motions:
        runs.append(other.run(motions, scale=1.5, watch=lambda reached: kept.append(other.state())))
    with dem3.Model(whole, options) as other, as_motion_set([shaken(0.6)]) as motions:
        runs.append(other.run(motions, scale=1.5, state=kept[-1]))
    for run in runs[1:]:
        for name in ("place", "dowel_slip", "dowel_out"):
            assert (getattr(run, name) == getattr(runs[0], name)).all()
    for wrong, error in (
        (replace(whole.dowels, body=pairs + 9), IndexError),
        (replace(whole.dowels, body=pairs * 0), CoreError),
        (replace(whole.dowels, stiffness=-n), CoreError),
        (replace(whole.dowels, axis=2 * axes), CoreError),
        (replace(whole.dowels, place=places * np.nan), ValueError),
        (replace(whole.dowels, reach=n[:2]), ValueError),
    ):
        with pytest.raises(error):
            dem3.Model(replace(model, dowels=wrong), options)


def test_a_contact_that_becomes_deep_gives_no_energy() -> None:
    """Two cubes overlap in a sliver along an edge, too narrow to be a contact, and one moves on over the other: as the contact
    comes to be, half a millimetre deep, it must not throw the cube up."""
    over = [box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), box((1.0 - 3e-4, 0.0, -4e-4), (2.0 - 3e-4, 1.0, 1.0 - 4e-4))]
    model = solids(over, Law(1e9, 1e9, 0.0), floor=False)
    model = replace(model, mass=np.array([0.0, model.mass[1]]))
    rate = np.zeros((2, 6))
    rate[1, 0] = -0.1
    run = dem3.run(model, Options(end_time=0.05, output_step=1e-3, gravity=(0.0, 0.0, -1e-6)), rate=rate)
    assert np.abs(run.rate[:, 1, 2]).max() < 1e-3 and run.energy["kinetic"].max() < 1.001 * run.energy["kinetic"][0]
    assert run.place[-1, 1, 0] - run.place[0, 1, 0] == pytest.approx(-0.1 * 0.05, rel=1e-2)
