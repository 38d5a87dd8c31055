"""Random triangles within an outline drawn as DXF: the outer closed polyline and those of the openings."""

from pathlib import Path

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.files import LARGEST_FILE, read
from extrados.model.geometry.dxf import read_dxf
from extrados.model.geometry.polygons import signed_area

JITTER = 0.33  # of the spacing: Delaunay triangles stay well shaped and keep to straight edges


def fill_outline(drawing: str, unit: str | None, folder: Path, size: float, seed: int) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Nodes (n, 2) [m] and triangles (m, 3) within the outline of a DXF file, about `size` [m] apart, and what is to be said of
    the file."""
    from matplotlib.path import Path as Ring
    from scipy.spatial import Delaunay, cKDTree

    drawn = read_dxf(read(drawing, LARGEST_FILE, folder, ("structure", "outline")), unit)
    rings = sorted((np.asarray(p.points) for p in drawn.blocks), key=lambda r: -abs(signed_area(r)))
    if not rings:
        raise BadGeometry(f"{drawing}: the drawing contains no closed polyline, so the wall has no outline")
    outer, holes = Ring(rings[0]), [Ring(r) for r in rings[1:]]
    for ring in rings[1:]:
        if not outer.contains_points(ring, radius=1e-9).any():
            raise BadGeometry(f"{drawing}: a polyline lies outside the largest polyline, which is taken as the outline of the wall")

    def inside(points: np.ndarray) -> np.ndarray:
        found = outer.contains_points(points)
        for hole in holes:
            found &= ~hole.contains_points(points)
        return found

    edge = np.concatenate([_divide(r, size) for r in rings])
    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    axes = [np.arange(a + 0.5 * size, b, size) for a, b in zip(low, high, strict=True)]
    grid = np.column_stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")])
    grid = grid + np.random.default_rng(seed).uniform(-JITTER, JITTER, grid.shape) * size
    grid = grid[inside(grid)]
    if len(grid):
        grid = grid[cKDTree(edge).query(grid)[0] > 0.55 * size]
    xy = np.concatenate([edge, grid])
    triangles = Delaunay(xy).simplices
    triangles = triangles[inside(xy[triangles].mean(axis=1))]
    a, b, c = (xy[triangles[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    triangles = np.where((area < 0)[:, None], triangles[:, [0, 2, 1]], triangles)
    triangles, area = triangles[np.abs(area) > 1e-8 * size**2], np.abs(area)
    wanted = abs(signed_area(rings[0])) - sum(abs(signed_area(r)) for r in rings[1:])
    if abs(area.sum() - wanted) > 1e-6 * wanted:
        raise BadGeometry(
            f"{drawing}: triangles of {size:g} m do not follow the outline (their area is {area.sum():.4g} m2, that of the "
            f"outline {wanted:.4g} m2): use smaller elements"
        )
    return xy, triangles, drawn.notes


def _divide(ring: np.ndarray, size: float) -> np.ndarray:
    """Points along a closed ring, its corners among them, at most `size` apart."""
    if np.allclose(ring[0], ring[-1]):
        ring = ring[:-1]
    parts = []
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.hypot(*(b - a)) / size - 1e-9)))
        parts.append(a + (b - a) * np.arange(count)[:, None] / count)
    return np.concatenate(parts)
