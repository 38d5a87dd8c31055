"""Blocks in space that roll, wobble and rock: against equations of motion by another integrator; order in step and stiffness."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from rolling_oracle import arm, rolled, steady
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from test_dem3_core import DENSITY, solids

from extrados.core import dem3
from extrados.core.dem3 import Law, Options, Solids
from extrados.core.ground import Ground
from extrados.model.geometry.solids.assembly import mass_properties
from extrados.model.geometry.solids.polyhedra import Polyhedron, prism
from extrados.model.geometry.solids.sections import drawn_out
from extrados.model.structures.arch import make_arch
from extrados.schema.constants import GRAVITY
from extrados.views.solids.supports import supports_of

RADIUS, SIDES = 0.5, 96
COIN, DRUM = 0.1, 2.0  # heights


def cylinder(height: float, sides: int = SIDES) -> tuple[Polyhedron, tuple[float, float]]:
    """Drum upright on the ground, and its inertia over its mass about a diameter and about the axis."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    drum = prism(RADIUS * np.column_stack([np.cos(angle), np.sin(angle)]), 0.0, height)
    mass, _, inertia = mass_properties([drum], DENSITY)
    return drum, (inertia[0, 0] / mass, inertia[2, 2] / mass)


def let_go(
    height: float, tilt: float, share: float, stiffness: float | None, times: np.ndarray, sides: int = SIDES
) -> tuple[dem3.Run, np.ndarray, np.ndarray]:
    """A cylinder on its rim that leans towards +x, with a share of the spin of steady rolling: the run, its axis over time, and
    that of a circular one that rolls without sliding. Without a stiffness on rigid contacts."""
    drum, inertia = cylinder(height, sides)
    leaning = drum.moved(Rotation.from_rotvec([0.0, tilt, 0.0]).as_matrix())
    leaning = leaning.moved(np.eye(3), np.array([0, 0, -leaning.low[2]]))
    axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    spin = share * steady(tilt, inertia, RADIUS, height)[0]
    speed = -np.cross(spin, arm(axis, RADIUS, height))
    rigid = Options(end_time=float(times[-1]), step=2e-4, rigid=True)
    run = dem3.run(
        solids([leaning], Law(stiffness or 1.0, stiffness or 1.0, 2.0)),
        replace(rigid, step=0.0, rigid=False, fraction=0.1) if stiffness else rigid,
        rate=np.array([[*speed, *spin], [0.0] * 6]),
        times=times,
    )
    return run, run.turn[:, 0] @ axis, rolled(axis, spin, inertia, RADIUS, height, times)


def test_a_thin_steady_disk_goes_round_as_eulers() -> None:
    """4 g / (r sin tilt) under the root, and the axis of the oracle goes round at that rate without leaning otherwise."""
    thin = (0.25 * RADIUS**2, 0.5 * RADIUS**2)
    assert steady(0.4, thin, RADIUS, 1e-9)[1] == pytest.approx(np.sqrt(4.0 * GRAVITY / (RADIUS * np.sin(0.4))), rel=1e-6)
    inertia = cylinder(COIN)[1]
    spin, rate = steady(0.4, inertia, RADIUS, COIN)
    times = np.linspace(0.0, 1.0, 51)
    axis = rolled(np.array([np.sin(0.4), 0.0, np.cos(0.4)]), spin, inertia, RADIUS, COIN, times)
    assert np.unwrap(np.arctan2(axis[:, 1], axis[:, 0])) == pytest.approx(rate * times, rel=1e-6, abs=1e-6)
    assert axis[:, 2] == pytest.approx(np.cos(0.4), abs=1e-6)


def test_a_spinning_coin_gains_no_energy_and_goes_round_by_its_law() -> None:
    """Euler's disk: the rate that belongs to the lean at each moment. Every facet is a blow that takes energy, less and less as there
    are more of them."""
    times, off = np.linspace(0.0, 0.5, 201), []
    for sides in (48, SIDES):
        run, axis, _ = let_go(COIN, 0.4, 1.0, 1e10, times, sides)
        energy = run.energy["kinetic"] + run.energy["potential"] + run.energy["elastic"]
        assert np.diff(energy).max() < 1e-4 * run.energy["kinetic"][0] and run.residual < 2e-3
        assert energy[-1] < energy[0] and run.energy["friction"][-1] > 0.0
        at = np.unwrap(np.arctan2(axis[:, 1], axis[:, 0]))
        inertia = cylinder(COIN, sides)[1]
        by_law = [steady(lean, inertia, RADIUS, COIN)[1] for lean in np.arccos(axis[:, 2])]
        off.append((at[-1] - at[0]) / np.trapezoid(by_law, times) - 1.0)
        assert at[-1] - at[0] > 2.0 * np.pi
    assert 0.0 < off[1] < 0.02 and off[1] < 0.4 * off[0]


def test_a_wobbling_drum_rolls_as_its_equations_say() -> None:
    """Set down on its rim: the springs let it pivot on a patch, less and less as they are stiffer."""
    times = np.linspace(0.0, 0.5, 101)
    off = []
    for stiffness in (1e10, 1e11):
        run, axis, exact = let_go(DRUM, 0.12, 0.3, stiffness, times)
        off.append(np.linalg.norm(axis - exact, axis=1).max() / np.linalg.norm(exact - exact[0], axis=1).max())
        assert run.residual < 1e-3
    assert off[1] < 0.03 and off[1] < 0.4 * off[0]


def test_on_rigid_contacts_it_rolls_so_too_and_gains_no_energy() -> None:
    """No spring lets the drum pivot: it stays nearer to its equations than on springs."""
    times = np.linspace(0.0, 0.5, 101)
    run, axis, exact = let_go(DRUM, 0.12, 0.3, None, times)
    assert np.linalg.norm(axis - exact, axis=1).max() < 0.01 * np.linalg.norm(exact - exact[0], axis=1).max()
    assert run.effort.open_steps == 0 and run.residual < 2e-3
    run, axis, _ = let_go(COIN, 0.4, 1.0, None, times)
    energy = run.energy["kinetic"] + run.energy["potential"]
    assert np.diff(energy).max() < 1e-5 * run.energy["kinetic"][0] and energy[-1] < energy[0]
    at, inertia = np.unwrap(np.arctan2(axis[:, 1], axis[:, 0])), cylinder(COIN)[1]
    by_law = [steady(lean, inertia, RADIUS, COIN)[1] for lean in np.arccos(axis[:, 2])]
    assert (at[-1] - at[0]) / np.trapezoid(by_law, times) == pytest.approx(1.0, abs=0.03)
    assert run.effort.open_steps == 0 and run.residual < 2e-3


def test_free_rocking_on_a_facet() -> None:
    """A drum that leans over one of its facets comes down when a block of that reach does."""
    height, sides, tilt = 4.0, 16, 0.1
    drum, inertia = cylinder(height, sides)
    reach = RADIUS * np.cos(np.pi / sides)
    drum = drum.moved(Rotation.from_rotvec([0.0, 0.0, np.pi / sides]).as_matrix())  # a facet looks along +x
    leaning = drum.moved(Rotation.from_rotvec([0.0, tilt, 0.0]).as_matrix())
    leaning = leaning.moved(np.eye(3), np.array([0, 0, -leaning.low[2]]))
    arm_length, alpha = np.hypot(reach, 0.5 * height), np.arctan(2.0 * reach / height)
    about = inertia[0] + arm_length**2

    def down(_: float, state: np.ndarray) -> float:
        return state[0]

    down.terminal = True
    exact = solve_ivp(
        lambda _, s: [s[1], -GRAVITY * arm_length / about * np.sin(alpha - s[0])],
        (0.0, 5.0),
        [tilt, 0.0],
        events=down,
        rtol=1e-10,
        atol=1e-12,
        dense_output=True,
    )
    impact = float(exact.t_events[0][0])
    off = []
    for stiffness in (1e10, 1e11):
        times = np.linspace(0.0, 0.95 * impact, 60)
        run = dem3.run(
            solids([leaning], Law(stiffness, stiffness, 1.0)),
            Options(end_time=float(times[-1]), fraction=0.1),
            rate=np.zeros((2, 6)),
            times=times,
        )
        axis = run.turn[:, 0] @ np.array([np.sin(tilt), 0.0, np.cos(tilt)])
        off.append(np.abs(np.arctan2(axis[:, 0], axis[:, 2]) - exact.sol(times)[0]).max() / tilt)
        assert np.abs(axis[:, 1]).max() < 1e-6
    assert off[1] < 1e-2 and off[1] < 0.4 * off[0]


def test_order_in_the_step() -> None:
    """A block that shakes on its springs without leaving them, undamped: the error falls by four as the step is halved."""
    stiffness, depth = 1e8, DENSITY * GRAVITY * 2.0 / 1e8
    block = prism(np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]), -depth, 2.0 - depth)
    model = solids([block], Law(stiffness, stiffness, 2.0))
    start = np.array([[0.01, 0.005, 0.01, 0.003, -0.004, 0.002], [0.0] * 6])
    ends = []
    for step in (4e-4, 2e-4, 1e-4, 5e-5):
        run = dem3.run(model, Options(end_time=0.1, step=step), rate=start, times=np.array([0.0, 0.1]))
        ends.append(np.concatenate([run.place[-1, 0], run.turn[-1, 0].ravel()]))
    apart = [float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(ends)]
    assert [a / b for a, b in itertools.pairwise(apart)] == pytest.approx([4.0, 4.0], rel=0.1)


@pytest.mark.parametrize(("stiffness", "off"), [(1e10, 0.025), (1e11, 0.01)])
def test_the_ledger_of_an_arch_closes(stiffness: float, off: float) -> None:
    """Oppenheim's arch drawn out, under a pulse through its first impacts: what is gained as contacts are found anew is a share of
    what the springs hold, which is less the stiffer they are."""
    section = make_arch(10.0, 1.5, 157.5, 7)
    arch = drawn_out(section)
    below = supports_of(arch).bodies
    parts, n = [*arch.parts, *below], len(arch.mass)
    middle = np.array([part.vertices.mean(axis=0) for part in below])
    model = Solids(
        np.concatenate([arch.centroid, middle]),
        np.concatenate([arch.mass, np.zeros(len(below))]),
        np.concatenate([arch.inertia, np.tile(np.eye(3), (len(below), 1, 1))]),
        [p.vertices for p in parts],
        [p.faces for p in parts],
        [*arch.owner.tolist(), *range(n, n + len(below))],
        [Law(stiffness, stiffness, 0.7, damping=1e6 / stiffness)],
    )
    pulse = Ground(
        breaks=np.array([0.0, 0.2, 0.6]), linear=GRAVITY * np.array([[[-1.0, 0.0]], [[0.5, 0.0]]]), harmonic=np.zeros((2, 1, 0, 4))
    )
    run = dem3.run(model, Options(end_time=1.0), pulse)
    assert np.linalg.norm(run.place[:, :n] - run.settled[:n], axis=2).max() > 0.2
    assert run.residual < off
