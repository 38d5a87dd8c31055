"""Six random blocks under two components of motion: against MuJoCo, and how far small changes of the start carry them."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_dem3_core import solids

from extrados.core import dem3
from extrados.core.dem3 import Law, Options
from extrados.core.ground import Ground
from extrados.model.geometry.solids.polyhedra import Polyhedron, box
from extrados.schema.constants import GRAVITY

STIFF, SOFT = 1e11, 1e10  # [Pa/m]
TIMES = np.linspace(0.0, 1.5, 151)
EARLY = 0.6  # [s]
SEEDS = [5, 6]


def portal(seed: int) -> list[Polyhedron]:
    """Two piers of two blocks, a lintel, a block on it; sizes, places and turns about the vertical at random."""
    rng = np.random.default_rng(seed)
    heights = [0.6 + 0.2 * rng.random(), 0.6 + 0.2 * rng.random()]
    found: list[Polyhedron] = []

    def add(x: float, z: float, wide: float, deep: float, high: float, turn: float) -> None:
        block = box((-0.5 * wide, -0.5 * deep, 0), (0.5 * wide, 0.5 * deep, high))
        at = np.array([x + rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), z])
        found.append(block.moved(Rotation.from_rotvec([0, 0, turn]).as_matrix(), at))

    level = 0.0
    for height in heights:
        for x in (-0.6, 0.6):
            add(x, level, 0.3 + 0.06 * rng.random(), 0.3 + 0.06 * rng.random(), height, rng.uniform(-0.3, 0.3))
        level += height
    add(0.0, level, 1.5, 0.3, 0.25, rng.uniform(-0.05, 0.05))
    add(0.0, level + 0.25, 0.25 + 0.1 * rng.random(), 0.25 + 0.1 * rng.random(), 0.6, rng.uniform(-0.3, 0.3))
    return found


def sine(amplitude: float, period: float) -> Ground:
    wave = np.array([[[[amplitude, 0.0, 2.0 * np.pi / period, 0.0]]]])
    return Ground(breaks=np.array([0.0, period]), linear=np.zeros((1, 1, 2)), harmonic=wave)


def shaken(strength: float) -> tuple[Ground, Ground]:
    return sine(0.5 * strength * GRAVITY, 0.5), sine(0.3 * strength * GRAVITY, 0.4)


@cache
def moved(seed: int, strength: float, stiffness: float = SOFT) -> np.ndarray:
    """Displacements (time, block, 3) [m]; the energy ledger closes."""
    along, across = shaken(strength)
    model = solids(portal(seed), Law(stiffness, stiffness, 0.7, damping=1e6 / stiffness))
    run = dem3.run(model, Options(end_time=TIMES[-1]), along, across=across, times=TIMES)
    assert run.reason == "end" and run.residual < 5e-3
    return run.place[:, :6] - run.settled[:6]


def apart(one: np.ndarray, other: np.ndarray, until: float) -> float:
    """Greatest RMS distance of a block between two runs up to a time, over the greatest displacement of any."""
    use = until + 1e-9 >= TIMES
    rms = np.sqrt(((one - other)[use] ** 2).sum(axis=2).mean(axis=0))
    return float(rms.max() / np.linalg.norm(other[use], axis=2).max())


def test_a_long_lintel_that_leans_keeps_its_energy() -> None:
    """Its ends dip deep below the plane of a pier's top, beside the pier: what touches is told by the polygon of both faces."""
    found = moved(5, 1.0, 1e9)
    assert np.linalg.norm(found, axis=2).max() > 0.5


@pytest.mark.verify
@pytest.mark.parametrize("seed", SEEDS)
def test_six_random_blocks_fall_as_in_mujoco(seed: int) -> None:
    """At its step of .1 ms: 3 % of the greatest displacement until .6 s, 8 % until they have fallen."""
    pytest.importorskip("mujoco")
    from solid_peers import mujoco

    model = solids(portal(seed), Law(STIFF, STIFF, 0.7, damping=1e6 / STIFF))
    peer = mujoco(model, *shaken(1.0), end=float(TIMES[-1]), dt=1e-4, every=100)
    theirs = np.concatenate([np.zeros((1, 6, 3)), peer.moved])
    ours = moved(seed, 1.0, STIFF)
    assert np.linalg.norm(ours, axis=2).max() > 0.5
    assert apart(ours, theirs, EARLY) < 0.03 and apart(ours, theirs, float(TIMES[-1])) < 0.08


@pytest.mark.verify
@pytest.mark.parametrize("seed", SEEDS)
def test_after_many_impacts_histories_are_a_band(seed: int) -> None:
    """Motions whose strength differs by 1e-4 part by a tenth of the greatest displacement in 1.5 s where the portal rocks and
    stands, while it hardly matters to the fall; MuJoCo is no farther off than 1.5 times that."""
    factors = 1.0 + 1e-4 * np.random.default_rng(1).uniform(-1.0, 1.0, 6)
    fall = max(apart(moved(seed, float(f)), moved(seed, 1.0), float(TIMES[-1])) for f in factors)
    stands = [apart(moved(seed, 0.6 * float(f)), moved(seed, 0.6), float(TIMES[-1])) for f in factors]
    early = max(apart(moved(seed, 0.6 * float(f)), moved(seed, 0.6), 0.3) for f in factors)
    assert np.linalg.norm(moved(seed, 0.6), axis=2).max() < 0.15  # it stands
    assert early < 0.02 and fall < 0.1 and 0.05 < max(stands) < 0.4
    pytest.importorskip("mujoco")
    from solid_peers import mujoco

    model = solids(portal(seed), Law(STIFF, STIFF, 0.7, damping=1e6 / STIFF))
    peer = mujoco(model, *shaken(0.6), end=float(TIMES[-1]), dt=1e-4, every=100)
    theirs = np.concatenate([np.zeros((1, 6, 3)), peer.moved])
    assert apart(moved(seed, 0.6, STIFF), theirs, float(TIMES[-1])) < 1.5 * max(stands)


@pytest.mark.verify
@pytest.mark.parametrize("seed", SEEDS)
def test_stiffer_joints_converge(seed: int) -> None:
    """Before the impacts part the histories: 1e10 Pa/m is nearer to 1e11 than 1e9 is."""
    stiff = moved(seed, 1.0, STIFF)
    off = [apart(moved(seed, 1.0, k), stiff, EARLY) for k in (1e9, SOFT)]
    assert off[1] < 0.05 and off[1] < 0.5 * off[0]
