"""The blow when an open mechanism closes: what the joints of the whole section let go on moving."""

import numpy as np

from extrados.core.mechanism import inelastic_blow
from extrados.limit.linkage import laden
from extrados.model.geometry.assembly import Assembly

#: Beyond these it takes longer than a second.
MOST_BLOCKS = 1000


def inelastic_impact(assembly: Assembly, velocity: np.ndarray) -> np.ndarray:
    """Velocities (blocks, 3) after all joints close at once without rebound and without sliding.

    velocity (blocks, 3): x, y, spin before, of the blocks with their fill. The impulses of the joints press and
    shear; the velocity after is the nearest, in kinetic energy, at which no joint overlaps or slides (Moreau 1988,
    "Unilateral contact and dry friction in finite freedom dynamics"): many hinges may open at once, energy never
    grows, and the result is continuous in the geometry. For one block it is Housner's impact.
    """
    a = assembly
    mass, centroid, inertia = laden(a)
    return inelastic_blow(
        mass,
        inertia,
        centroid,
        np.stack([a.a, a.b], axis=1),
        np.stack([a.p, a.q], axis=1),
        np.stack([a.normal, a.tangent], axis=1),
        velocity,
    )


def energy_kept(assembly: Assembly, velocity: np.ndarray) -> float:
    """Share of the kinetic energy that is left after `inelastic_impact`."""
    mass, _, inertia = laden(assembly)
    weight = np.stack([mass, mass, inertia], axis=1)
    after = inelastic_impact(assembly, velocity)
    return float((weight * after**2).sum() / (weight * velocity**2).sum())
