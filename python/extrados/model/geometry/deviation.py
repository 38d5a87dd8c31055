"""Another survey of the same stones: every measured point somewhere within a deviation of where it was."""

from dataclasses import replace

import numpy as np

from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.polygons import properties


def resurveyed(assembly: Assembly, deviation: float, random: np.random.Generator) -> Assembly:
    """The assembly with all corners of stones and all ends of joints moved, each for itself and evenly within a circle of
    radius `deviation` [m]; which stones touch stays. Masses, centroids and inertias follow the outlines."""

    def moved(points: np.ndarray) -> np.ndarray:
        radius = deviation * np.sqrt(random.uniform(size=len(points)))
        angle = random.uniform(0.0, 2.0 * np.pi, len(points))
        return points + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])

    outlines = [moved(o) for o in assembly.outlines]
    before, after = (list(map(properties, some)) for some in (assembly.outlines, outlines))
    share = np.array([new[0] / old[0] for old, new in zip(before, after, strict=True)])
    shift = np.array([new[1] - old[1] for old, new in zip(before, after, strict=True)])
    turn = np.array([new[2] / old[2] for old, new in zip(before, after, strict=True)])
    return replace(
        assembly,
        outlines=outlines,
        mass=assembly.mass * share,
        centroid=assembly.centroid + shift,
        inertia=assembly.inertia * turn,
        p=moved(assembly.p),
        q=moved(assembly.q),
    )
