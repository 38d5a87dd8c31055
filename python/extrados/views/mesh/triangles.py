"""Triangles within a ring of given nodes: none of its edges is divided or lost."""

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import following, inside, signed_area

CLEAR = 0.55  # of the size: inner points keep this far from the ring


def fill_ring(ring: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes, those of the ring first, and counter-clockwise triangles of about `size` within a simple ring (n, 2).

    Delaunay's triangles where they keep every edge of the ring; else ears are cut from it and their diagonals flipped
    where that makes the least angle larger. BadGeometry where the ring crosses itself.
    """
    from scipy.spatial import Delaunay, QhullError, cKDTree

    low, high = ring.min(axis=0), ring.max(axis=0)
    axes = [np.arange(a + 0.5 * size, b, size) for a, b in zip(low, high, strict=True)]
    grid = np.column_stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")])
    if len(grid):
        grid = grid[inside(ring, grid)]
    edge = following(ring) - ring
    if len(grid):
        grid = grid[cKDTree(np.concatenate([ring, ring + 0.5 * edge])).query(grid)[0] > CLEAR * size]
    xy = np.concatenate([ring, grid])
    try:
        triangles = Delaunay(xy).simplices
    except QhullError:
        triangles = np.empty((0, 3), dtype=int)
    if len(triangles):
        triangles = triangles[inside(ring, xy[triangles].mean(axis=1))]
        triangles = _counter_clockwise(xy, triangles)
    if not _whole(xy, triangles, ring):
        xy, triangles = ring, _flipped(ring, _ears(ring))
        if not _whole(xy, triangles, ring):
            raise BadGeometry("without the thickness of the joints, the outline of this block crosses itself: use smaller elements")
    return xy, triangles


def _areas(xy: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (xy[triangles[:, k]] for k in range(3))
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def _counter_clockwise(xy: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    area = _areas(xy, triangles)
    triangles = np.where((area < 0.0)[:, None], triangles[:, [0, 2, 1]], triangles)
    longest = np.max([np.hypot(*(xy[triangles[:, k]] - xy[triangles[:, k - 1]]).T) for k in range(3)], axis=0)
    return triangles[np.abs(area) > 1e-9 * longest**2]


def _whole(xy: np.ndarray, triangles: np.ndarray, ring: np.ndarray) -> bool:
    """True where the triangles hold every edge of the ring once, the right way round, and have its area."""
    if not len(triangles):
        return False
    area = _areas(xy, triangles)
    if not (area > 0.0).all() or abs(area.sum() - signed_area(ring)) > 1e-9 * signed_area(ring):
        return False
    n = len(ring)
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    codes, counts = np.unique(sides[:, 0] * len(xy) + sides[:, 1], return_counts=True)
    wanted = np.arange(n) * len(xy) + np.roll(np.arange(n), -1)
    return bool((counts == 1).all() and np.isin(wanted, codes).all())


def _ears(ring: np.ndarray) -> np.ndarray:
    """Triangles of a simple ring by cutting off, each time, the ear of the largest least angle."""
    left = list(range(len(ring)))
    triangles = []
    while len(left) > 3:
        points = ring[left]
        a, c = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
        quality = _least_sine(a, points, c)
        best = None
        for k in np.argsort(-quality, kind="stable"):
            if quality[k] <= 0.0:
                break
            others = np.delete(np.arange(len(left)), [k, k - 1, (k + 1) % len(left)])
            if not _within(a[k], points[k], c[k], points[others]).any():
                best = int(k)
                break
        if best is None:
            break
        triangles.append([left[best - 1], left[best], left[(best + 1) % len(left)]])
        del left[best]
    if len(left) == 3:
        triangles.append(left)
    return np.array(triangles, dtype=int).reshape(-1, 3)


def _least_sine(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the area over the square of the longest side: negative where clockwise."""
    twice = (b - a)[..., 0] * (c - a)[..., 1] - (b - a)[..., 1] * (c - a)[..., 0]
    longest = np.max([((p - q) ** 2).sum(axis=-1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    return twice / longest


def _within(a: np.ndarray, b: np.ndarray, c: np.ndarray, points: np.ndarray) -> np.ndarray:
    def left(p: np.ndarray, q: np.ndarray) -> np.ndarray:
        return (q[0] - p[0]) * (points[:, 1] - p[1]) - (q[1] - p[1]) * (points[:, 0] - p[0])

    return (left(a, b) >= 0.0) & (left(b, c) >= 0.0) & (left(c, a) >= 0.0)


def _flipped(xy: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Diagonals turned where the worse of the two triangles becomes better."""
    rows = [list(t) for t in triangles.tolist()]
    owner: dict[tuple[int, int], int] = {}
    for i, t in enumerate(rows):
        for k in range(3):
            owner[t[k], t[(k + 1) % 3]] = i
    queue = sorted(edge for edge in owner if edge[0] < edge[1] and edge[::-1] in owner)
    turns = 0
    while queue and turns < 20 * len(rows):
        a, b = queue.pop()
        if (a, b) not in owner or (b, a) not in owner:
            continue
        i, j = owner[a, b], owner[b, a]
        c = next(v for v in rows[i] if v not in (a, b))
        d = next(v for v in rows[j] if v not in (a, b))
        before = min(_least_sine(xy[a], xy[b], xy[c]), _least_sine(xy[b], xy[a], xy[d]))
        after = min(_least_sine(xy[d], xy[b], xy[c]), _least_sine(xy[a], xy[d], xy[c]))
        if after <= before * (1.0 + 1e-9):
            continue
        del owner[a, b], owner[b, a]
        rows[i], rows[j] = [d, b, c], [a, d, c]
        for number, t in ((i, rows[i]), (j, rows[j])):
            for k in range(3):
                owner[t[k], t[(k + 1) % 3]] = number
        queue += [(min(e), max(e)) for e in ((a, d), (d, b), (b, c), (c, a))]
        turns += 1
    return np.array(rows, dtype=int)
