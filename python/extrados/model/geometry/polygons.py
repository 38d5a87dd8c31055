"""Plane polygons: area, centroid, inertia, cutting and overlap."""

import numpy as np

EDGES_AT_ONCE = 200_000  # pairs of edges that are looked at together


def following(values: np.ndarray) -> np.ndarray:
    """Each vertex replaced by the next (np.roll is several times slower on a few rows)."""
    return np.concatenate([values[1:], values[:1]])


def signed_area(outline: np.ndarray) -> float:
    """Positive where the vertices (n, 2) run counter-clockwise [m^2]."""
    x, y = outline.T
    return 0.5 * float(x @ following(y) - following(x) @ y)


def properties(outline: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Area [m^2], centroid [m] and polar moment of area about it [m^4] of a counter-clockwise outline."""
    origin = outline.sum(axis=0) / len(outline)
    p = outline - origin
    r = following(p)
    cross = p[:, 0] * r[:, 1] - p[:, 1] * r[:, 0]
    area = 0.5 * float(cross.sum())
    centre = ((p + r) * cross[:, None]).sum(axis=0) / (6.0 * area)
    second = float((((p * p) + (p * r) + (r * r)).sum(axis=1) * cross).sum()) / 12.0
    return area, centre + origin, second - area * float(centre @ centre)


def cut(outline: np.ndarray, point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """What of an outline lies on the side of the line through `point` that `normal` points to (Sutherland-Hodgman).

    A concave outline may come back in parts joined along the line; its area and centroid are right.
    """
    side = (outline - point) @ normal
    kept: list[np.ndarray] = []
    for i in range(len(outline)):
        j = (i + 1) % len(outline)
        if side[i] >= 0.0:
            kept.append(outline[i])
        if (side[i] > 0.0 > side[j]) or (side[i] < 0.0 < side[j]):
            kept.append(outline[i] + side[i] / (side[i] - side[j]) * (outline[j] - outline[i]))
    return np.array(kept).reshape(-1, 2)


def crossings(outline: np.ndarray, y: float) -> np.ndarray:
    """Sorted x where the horizontal line at y meets the outline."""
    x0, y0 = outline.T
    x1, y1 = following(x0), following(y0)
    met = (np.minimum(y0, y1) <= y) & (y < np.maximum(y0, y1))
    return np.sort(x0[met] + (y - y0[met]) / (y1[met] - y0[met]) * (x1[met] - x0[met]))


def reach(outline: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Least and greatest x (k, 2) where the horizontal lines at some levels meet the outline; infinite, the greater first,
    where they do not."""
    x0, y0 = outline.T
    x1, y1 = following(x0), following(y0)
    level = levels[:, None]
    met = (np.minimum(y0, y1) <= level) & (level < np.maximum(y0, y1))
    x = x0 + (level - y0) / np.where(y1 == y0, 1.0, y1 - y0) * (x1 - x0)
    return np.column_stack([np.where(met, x, np.inf).min(axis=1), np.where(met, x, -np.inf).max(axis=1)])


def below(outline: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Area and its first moments, integrals of x and of y (k, 3), of what lies below each level.

    Green's theorem: integrals of x, x^2 / 2 and x y over dy along the counter-clockwise edges, each up to the level.
    """
    x0, y0 = outline.T
    x1, y1 = following(x0), following(y0)
    slope, level = (x1 - x0) / np.where(y1 == y0, 1.0, y1 - y0), levels[:, None]
    start, end = np.minimum(y0, level), np.minimum(y1, level)
    xs, xe, sixth = x0 + (start - y0) * slope, x0 + (end - y0) * slope, (end - start) / 6.0
    found = np.empty((3, len(levels)))
    found[0] = (3.0 * sixth * (xs + xe)).sum(axis=1)
    found[1] = (sixth * (xs * xs + xs * xe + xe * xe)).sum(axis=1)
    found[2] = (sixth * (xs * (start + start + end) + xe * (start + end + end))).sum(axis=1)
    return found.T


def inside(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether each of the points (k, 2) lies in the outline, by counting crossings to its right."""
    x, y = points[:, 0, None], points[:, 1, None]
    x0, y0 = outline.T
    x1, y1 = following(x0), following(y0)
    spans = (y0 > y) != (y1 > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = x0 + (y - y0) / (y1 - y0) * (x1 - x0)
    return ((spans & (x < reach)).sum(axis=1) % 2).astype(bool)


def distance(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Distance of points (k, 2) from the edges of the outline (k) [m]."""
    edge = following(outline) - outline
    away = points[:, None] - outline
    along = np.clip((away * edge).sum(axis=2) / (edge**2).sum(axis=1), 0.0, 1.0)
    return np.hypot(*np.moveaxis(away - along[..., None] * edge, -1, 0)).min(axis=1)


def crossing_edges(outline: np.ndarray) -> tuple[int, int] | None:
    """Two edges of an outline that cross each other, by their first vertices; None where it is simple."""
    n = len(outline)
    a, b = outline, following(outline)

    def turn(o: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return (u[..., 0] - o[..., 0]) * (v[..., 1] - o[..., 1]) - (u[..., 1] - o[..., 1]) * (v[..., 0] - o[..., 0])

    at_once = max(1, EDGES_AT_ONCE // n)
    for begin in range(0, n, at_once):  # so that the memory is bounded
        i, j = np.triu_indices(min(at_once, n - begin), begin + 2, n)
        i = i + begin
        apart = ~((i == 0) & (j == n - 1))
        i, j = i[apart], j[apart]
        one = turn(a[i], b[i], a[j]) * turn(a[i], b[i], b[j])
        two = turn(a[j], b[j], a[i]) * turn(a[j], b[j], b[i])
        crossed = np.flatnonzero((one < 0.0) & (two < 0.0))
        if len(crossed):
            return int(i[crossed[0]]), int(j[crossed[0]])
    return None
