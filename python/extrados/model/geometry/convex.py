"""Plane polygons cut into convex parts."""

import numpy as np

from extrados.model.geometry.polygons import signed_area as area

#: A turn below this sine is straight.
STRAIGHT = 1e-9


def turns(polygon: np.ndarray) -> np.ndarray:
    """Sine of the turn at each vertex, positive to the left."""
    after = np.roll(polygon, -1, axis=0) - polygon
    after = after / np.hypot(*after.T)[:, None]
    before = np.roll(after, 1, axis=0)
    return before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]


def clean(polygon: np.ndarray) -> np.ndarray:
    """The polygon counter-clockwise, without repeated and without straight vertices."""
    polygon = np.asarray(polygon, dtype=float)
    if area(polygon) < 0.0:
        polygon = polygon[::-1]
    size = float(np.ptp(polygon, axis=0).max())
    apart = np.hypot(*(polygon - np.roll(polygon, 1, axis=0)).T) > 1e-9 * size
    polygon = polygon[apart]
    return polygon[np.abs(turns(polygon)) > STRAIGHT] if len(polygon) > 3 else polygon


def is_convex(polygon: np.ndarray) -> bool:
    """True for a counter-clockwise polygon that nowhere turns to the right."""
    return bool((turns(polygon) > -STRAIGHT).all())


def hull(points: np.ndarray) -> np.ndarray:
    """Convex hull, counter-clockwise (Andrew's monotone chain)."""
    order = points[np.lexsort((points[:, 1], points[:, 0]))]

    def chain(sequence: np.ndarray) -> list[np.ndarray]:
        out: list[np.ndarray] = []
        for point in sequence:
            while len(out) > 1:
                u, v = out[-1] - out[-2], point - out[-1]
                if u[0] * v[1] - u[1] * v[0] > STRAIGHT * np.hypot(*u) * np.hypot(*v):
                    break
                out.pop()
            out.append(point)
        return out[:-1]

    return np.array(chain(order) + chain(order[::-1]))


def _ears(polygon: np.ndarray) -> list[list[int]]:
    """Triangles of a simple polygon by cutting ears, as indices."""
    left = list(range(len(polygon)))
    triangles = []
    while len(left) > 3:
        best = None
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            triangle = polygon[[a, b, c]]
            if area(triangle) <= 0.0:
                continue
            others = polygon[[i for i in left if i not in (a, b, c)]]
            edges = np.roll(triangle, -1, axis=0) - triangle
            inside = np.ones(len(others), dtype=bool)
            for p, e in zip(triangle, edges, strict=True):
                inside &= e[0] * (others[:, 1] - p[1]) - e[1] * (others[:, 0] - p[0]) > -1e-12 * abs(area(triangle))
            if inside.any():
                continue
            # The roundest ear first: slivers make poor contacts.
            quality = area(triangle) / float((edges**2).sum())
            if best is None or quality > best[0]:
                best = (quality, k, [a, b, c])
        if best is None:
            raise ValueError("the polygon crosses itself")
        triangles.append(best[2])
        left.pop(best[1])
    return [*triangles, left]


def _joined(one: list[int], other: list[int]) -> list[int] | None:
    """Two index polygons with a common edge as one; None where they have none."""
    for i, a in enumerate(one):
        b = one[(i + 1) % len(one)]
        for j, c in enumerate(other):
            if c == b and other[(j + 1) % len(other)] == a:
                return one[i + 1 :] + one[: i + 1] + [other[(j + 2 + k) % len(other)] for k in range(len(other) - 2)]
    return None


def convex_parts(polygon: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Convex parts of a simple polygon, each with a mask of the edges that lie on the outline.

    Ear cutting, then merging across diagonals while parts stay convex (after Hertel and Mehlhorn 1983).
    ValueError where the polygon crosses itself.
    """
    polygon = clean(polygon)
    if is_convex(polygon):
        return [(polygon, np.ones(len(polygon), dtype=bool))]
    pieces = _ears(polygon)
    merging = True
    while merging:
        merging = False
        for i in range(len(pieces)):
            for j in range(i + 1, len(pieces)):
                joined = _joined(pieces[i], pieces[j])
                if joined is not None and is_convex(polygon[joined]):
                    pieces[i] = joined
                    pieces.pop(j)
                    merging = True
                    break
            if merging:
                break
    n = len(polygon)
    return [(polygon[piece], np.array([(b - a) % n == 1 for a, b in zip(piece, piece[1:] + piece[:1], strict=True)])) for piece in pieces]


def rounded(polygon: np.ndarray, radius: float, steps: int = 3) -> np.ndarray:
    """A convex polygon with its corners worn to arcs of a radius, each arc of `steps` chords.

    ValueError where the radius takes more than an edge has.
    """
    before = polygon - np.roll(polygon, 1, axis=0)
    after = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(*after.T)
    u, v = -before / np.hypot(*before.T)[:, None], after / length[:, None]
    half = 0.5 * np.arccos(np.clip((u * v).sum(axis=1), -1.0, 1.0))
    cut = radius / np.tan(half)
    if (cut + np.roll(cut, -1) >= length).any():
        raise ValueError(
            f"an edge has a length of {length.min():.4g} m, so nothing of this edge remains if corners are worn to a radius of "
            f"{radius:g} m: give a smaller radius"
        )
    out = []
    for point, a, b, angle, c in zip(polygon, u, v, half, cut, strict=True):
        if np.pi - 2.0 * angle < 0.2:  # a corner of a drawn arc, not of a block
            out.append(point)
            continue
        bisector = (a + b) / np.hypot(*(a + b))
        centre = point + radius / np.sin(angle) * bisector
        first = point + c * a - centre
        sweep = np.pi - 2.0 * angle
        for k in range(steps + 1):
            turn = sweep * k / steps
            out.append(
                centre + np.array([np.cos(turn) * first[0] - np.sin(turn) * first[1], np.sin(turn) * first[0] + np.cos(turn) * first[1]])
            )
    return np.array(out)


def overlap(one: np.ndarray, other: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """How deep two convex polygons overlap along the edge that separates them best [m], negative where they do not; the
    direction from one to the other square to it, and a point midway between the two faces."""
    found: list[tuple[float, np.ndarray, np.ndarray]] = []
    for a, b, sense in ((one, other, 1.0), (other, one, -1.0)):
        edges = np.roll(a, -1, axis=0) - a
        normal = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
        distance = (b @ normal.T - (a * normal).sum(axis=1)).min(axis=0)
        k = int(distance.argmax())
        found.append((-float(distance[k]), sense * normal[k], a[k] + 0.5 * distance[k] * normal[k]))
    return min(found, key=lambda item: item[0])


def overlap_depth(one: np.ndarray, other: np.ndarray) -> float:
    """How deep two convex polygons overlap [m]; negative: the gap along the best separating edge."""
    return overlap(one, other)[0]


def crossings(one: np.ndarray, other: np.ndarray, small: float) -> np.ndarray:
    """Places where the outlines of two polygons cross, those within `small` [m] of each other as one (k, 2) [m]; parallel
    edges do not cross."""
    u, v = (np.roll(polygon, -1, axis=0) - polygon for polygon in (one, other))
    u, v, away = u[:, None], v[None], other[None] - one[:, None]
    area = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        on_one = (away[..., 0] * v[..., 1] - away[..., 1] * v[..., 0]) / area
        on_other = (away[..., 0] * u[..., 1] - away[..., 1] * u[..., 0]) / area
    slanted = np.abs(area) > STRAIGHT * np.linalg.norm(u, axis=-1) * np.linalg.norm(v, axis=-1)
    met = slanted & (on_one >= 0.0) & (on_one <= 1.0) & (on_other >= 0.0) & (on_other <= 1.0)
    found: list[np.ndarray] = []
    for i, k in np.argwhere(met):
        place = one[i] + on_one[i, k] * u[i, 0]
        if all(np.hypot(*(place - known)) > small for known in found):
            found.append(place)
    return np.reshape(found, (-1, 2))
