"""Another survey of the same stones: every measured point somewhere within a deviation of where it was."""

from dataclasses import replace

import numpy as np

from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.polygons import properties
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.polyhedra import moments


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


def resurveyed_solids(assembly: SolidAssembly, deviation: float, random: np.random.Generator) -> SolidAssembly:
    """The blocks with the corners of their parts and of their contacts moved, each for itself and evenly within a ball of radius
    `deviation` [m]; which blocks touch stays, and so do their pictures. Masses and centroids follow the parts, normals the contacts."""

    def moved(points: np.ndarray) -> np.ndarray:
        way = random.normal(size=points.shape)
        radius = deviation * np.cbrt(random.uniform(size=len(points)))
        return points + (radius / np.linalg.norm(way, axis=1))[:, None] * way

    count = len(assembly.mass)
    volume, moment = np.zeros((2, count)), np.zeros((2, count, 3))
    for part, block in zip(assembly.parts, assembly.owner.tolist(), strict=True):
        for k, vertices in enumerate((part.vertices, moved(part.vertices))):
            size, centre, _ = moments(vertices, part.triangles)
            volume[k, block] += size
            moment[k, block] += size * centre
    before, after = moment / volume[:, :, None]
    share = volume[1] / volume[0]
    polygon = [moved(points) for points in assembly.polygon]
    return replace(
        assembly,
        mass=assembly.mass * share,
        centroid=assembly.centroid + after - before,
        inertia=assembly.inertia * share[:, None, None],
        polygon=polygon,
        normal=np.array([_normal(points) for points in polygon]).reshape(-1, 3),
    )


def _normal(points: np.ndarray) -> np.ndarray:
    """Unit normal of corners (k, 3) that are nearly in one plane (Newell)."""
    arm = points - points[0]
    across = np.cross(arm[:-1], arm[1:]).sum(axis=0)
    unit: np.ndarray = across / np.linalg.norm(across)
    return unit
