"""The blow when an open mechanism closes: what the joints of the whole section let go on moving."""

import numpy as np

from extrados.building.geometry.assembly import GROUND, Assembly
from extrados.limit.linkage import laden

#: More blocks make the dense problem slow.
MOST_BLOCKS = 400


def inelastic_impact(assembly: Assembly, velocity: np.ndarray) -> np.ndarray:
    """Velocities (blocks, 3) after all joints close at once without rebound and without sliding.

    velocity (blocks, 3): x, y, spin before, of the blocks with their fill. The impulses of the joints press and
    shear; the velocity after is the nearest, in kinetic energy, at which no joint overlaps or slides (Moreau 1988,
    "Unilateral contact and dry friction in finite freedom dynamics"): many hinges may open at once. For one block
    it is Housner's impact.
    """
    from scipy.optimize import nnls  # takes a fifth of a second to load

    mass, centroid, inertia = laden(assembly)
    count = len(mass)
    root = np.sqrt(np.stack([mass, mass, inertia], axis=1))
    joints = len(assembly.a)
    press, shear = np.zeros((2, joints, count, 3)), np.zeros((joints, count, 3))
    for side, sign in ((assembly.a, 1.0), (assembly.b, -1.0)):
        held = np.flatnonzero(side != GROUND)
        block = side[held]
        for k, end in enumerate((assembly.p, assembly.q)):
            press[k, held, block] += sign * _row(end[held] - centroid[block], assembly.normal[held])
        shear[held, block] += sign * _row(assembly.p[held] - centroid[block], assembly.tangent[held])
    rows = np.concatenate([press.reshape(2 * joints, -1), shear.reshape(joints, -1), -shear.reshape(joints, -1)])
    weighted = (rows / root.ravel()).T
    impulse, _ = nnls(weighted, -(root * velocity).ravel(), maxiter=100 * rows.shape[0])
    return velocity + (weighted @ impulse).reshape(count, 3) / root


def energy_kept(assembly: Assembly, velocity: np.ndarray) -> float:
    """Share of the kinetic energy that is left after `inelastic_impact`."""
    mass, _, inertia = laden(assembly)
    weight = np.stack([mass, mass, inertia], axis=1)
    after = inelastic_impact(assembly, velocity)
    return float((weight * after**2).sum() / (weight * velocity**2).sum())


def _row(arm: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Velocity of points at arms [m] from the centroids in given directions, by x, y, spin of the blocks (n, 3)."""
    return np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])
