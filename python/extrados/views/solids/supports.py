"""What solids stand on as they move: footings under the contacts to the ground, or a level floor that a deck names."""

from dataclasses import dataclass

import numpy as np

from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.contacts import GROUND
from extrados.model.geometry.solids.polyhedra import Polyhedron, box, hull, overlap_depth
from extrados.views.rigid import FOOTING

DEEP = 0.25  # of the size: how deep footings and floors reach down
WIDE = 12.0  # sizes of the structure to which a floor reaches on all sides
LEVEL = 1e-6  # of the size: soles that are nearer to a floor lie on it


@dataclass(frozen=True)
class Supports:
    """Fixed bodies, and for each contact of the assembly the one that bears it, -1 where it is not on the ground."""

    bodies: list[Polyhedron]
    of_joint: np.ndarray


def supports_of(assembly: SolidAssembly, floor: float | None = None) -> Supports:
    """A footing under each contact to the ground, a quarter wider than it on all sides where no stone stands there; what lies
    on a floor at a height [m] has that instead."""
    found: list[Polyhedron] = []
    of_joint = np.full(len(assembly.a), -1)
    deep = DEEP * assembly.size
    if floor is not None:
        points = np.concatenate([p.vertices for p in assembly.parts])
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))[:2]
        reach = WIDE * assembly.size
        found.append(box([*(middle - reach), floor - deep], [*(middle + reach), floor]))
    for j in np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND)).tolist():
        polygon, up = assembly.polygon[j], assembly.normal[j] if assembly.b[j] == GROUND else -assembly.normal[j]
        if floor is not None and np.abs(polygon[:, 2] - floor).max() < LEVEL * assembly.size:
            of_joint[j] = 0
            continue
        of_joint[j] = len(found)
        found.append(_footing(assembly, polygon, up, deep if up[2] > 1.0 - 1e-9 else 0.5 * _width(polygon)))
    return Supports(found, of_joint)


def _footing(assembly: SolidAssembly, polygon: np.ndarray, up: np.ndarray, deep: float) -> Polyhedron:
    """Wider than the contact, unless it would then reach into a stone, which it would throw out at the start."""
    middle = polygon.mean(axis=0)
    own, wide = (
        hull(np.concatenate([top, top - deep * up]))
        for top in (middle + (1.0 + 2.0 * share) * (polygon - middle) for share in (0.0, FOOTING))
    )
    return wide if _pierced(assembly, wide) <= _pierced(assembly, own) + LEVEL * assembly.size else own


def _pierced(assembly: SolidAssembly, body: Polyhedron) -> float:
    """How deep a body reaches into any stone [m]."""
    near = (part for part in assembly.parts if (part.low < body.high).all() and (part.high > body.low).all())
    return max((overlap_depth(body, part) for part in near), default=0.0)


def _width(points: np.ndarray) -> float:
    """Greatest extent of points [m]."""
    return float(np.ptp(points, axis=0).max())
