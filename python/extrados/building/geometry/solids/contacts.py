"""Where solids touch: pairs that are near each other, faces that lie on each other, and the polygons they share."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from extrados.building.errors import BadGeometry
from extrados.building.geometry.solids.polyhedra import Polyhedron, overlap_depth

GROUND = -1
Point = tuple[float, float]
PARALLEL = 1e-3  # sine of the angle between faces that may still lie on each other
#: Pairs of parts that are looked at: so many, or so many times the parts; in masonry a stone has about ten neighbours
MOST_PAIRS, MOST_NEIGHBOURS = 100_000, 50
SMALLEST = 1e-6  # of the greater face: less that two faces share is an edge, no contact


@dataclass
class Touching:
    """polygon: corners (k, 3) [m] of each contact, counter-clockwise about normal (nj, 3), which points into block a;
    overlaps: (block, block, depth [m]); gaps: the same of faces that nearly touch."""

    polygon: list[np.ndarray] = field(default_factory=list)
    normal: list[np.ndarray] = field(default_factory=list)
    a: list[int] = field(default_factory=list)
    b: list[int] = field(default_factory=list)
    overlaps: list[tuple[int, int, float]] = field(default_factory=list)
    gaps: list[tuple[int, int, float]] = field(default_factory=list)


def near_pairs(low: np.ndarray, high: np.ndarray, owner: np.ndarray, reach: float) -> np.ndarray:
    """Pairs (m, 2) of parts of different owners whose boxes come nearer than `reach`, by sweeping along the longest axis."""
    axis = int(np.ptp(np.concatenate([low, high]), axis=0).argmax())
    order = np.argsort(low[:, axis], kind="stable")
    start = low[order, axis]
    last = np.searchsorted(start, high[order, axis] + reach, side="right")
    found, total = [], 0
    others = [k for k in range(3) if k != axis]
    for k, i in enumerate(order):
        j = order[k + 1 : last[k]]
        near = (low[j][:, others] <= high[i, others] + reach) & (high[j][:, others] >= low[i, others] - reach)
        j = j[near.all(axis=1) & (owner[j] != owner[i])]
        found.append(np.column_stack([np.full(len(j), i), j]))
        total += len(j)
        if total > (most := max(MOST_PAIRS, MOST_NEIGHBOURS * len(low))):
            raise BadGeometry(
                f"the boxes around {len(low)} solids meet in more than {most:,} pairs, the most that are looked at: many of "
                "them lie over each other"
            )
    pairs = np.concatenate(found) if found else np.empty((0, 2), dtype=int)
    pairs = np.sort(pairs, axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def touching(parts: Sequence[Polyhedron], owner: np.ndarray, tolerance: float, near: float) -> Touching:
    """Contacts of the blocks that own the parts; faces nearer than `tolerance` touch, gaps up to `near` are told [m]."""
    found = Touching()
    low, high = (np.array([getattr(part, end) for part in parts]) for end in ("low", "high"))
    for i, j in near_pairs(low, high, owner, near).tolist():
        _meet(found, parts[i], parts[j], int(owner[i]), int(owner[j]), tolerance, near)
    return found


def _meet(found: Touching, one: Polyhedron, two: Polyhedron, a: int, b: int, tolerance: float, near: float) -> None:
    """Contacts, overlap or gap of two parts."""
    opposed = one.normals @ two.normals.T
    # how far the second face lies from the first, along the normal of the first
    apart = -(one.offsets[:, None] + two.offsets[None])
    if not (facing := (opposed < -1.0 + 0.5 * PARALLEL**2)).any() or not (facing & (np.abs(apart) < near)).any():
        depth = overlap_depth(one, two)
        if depth > tolerance:
            found.overlaps.append((a, b, depth))
        return
    touched = False
    gap = np.inf
    for f, g in np.argwhere(facing & (np.abs(apart) < near)).tolist():
        shared = shared_polygon(one, f, two, g)
        if shared is None:
            continue
        # offsets of faces that are not quite parallel say little far from the origin
        away = float(((shared - two.vertices[two.faces[g][0]]) @ two.normals[g]).max())
        if abs(away) <= tolerance:
            touched = True
            found.polygon.append(shared[::-1])  # counter-clockwise about the outward normal of the second
            found.normal.append(-one.normals[f])
            found.a.append(a)
            found.b.append(b)
        elif 0.0 < away < near:
            gap = min(gap, away)
    if not touched:
        depth = overlap_depth(one, two)
        if depth > tolerance:
            found.overlaps.append((a, b, depth))
        elif gap < near:
            found.gaps.append((a, b, gap))


def shared_polygon(one: Polyhedron, f: int, two: Polyhedron, g: int) -> np.ndarray | None:
    """What face f of one body and face g of another share, in the plane of the first (k, 3), counter-clockwise about its
    outward normal; None where that is less than an edge."""
    normal = one.normals[f]
    axis = int(np.abs(normal).argmax())
    plane = [(axis + 1) % 3, (axis + 2) % 3]  # dropping the axis keeps the sense where the normal points along it
    first, second = one.vertices[list(one.faces[f])], two.vertices[list(two.faces[g])]
    subject, clip = first[:, plane], second[:, plane]
    if (subject.min(axis=0) >= clip.max(axis=0)).any() or (clip.min(axis=0) >= subject.max(axis=0)).any():
        return None
    if normal[axis] < 0.0:
        subject = subject[::-1]
    else:
        clip = clip[::-1]
    one_ring, two_ring = ([(float(x), float(y)) for x, y in ring.tolist()] for ring in (subject, clip))
    area = max(_area(one_ring), _area(two_ring))
    found = clipped(one_ring, two_ring, 1e-9 * area**0.5)
    if len(found) < 3 or _area(found) < SMALLEST * area:
        return None
    shared = np.array(found)
    xyz = np.empty((len(shared), 3))
    xyz[:, plane] = shared
    xyz[:, axis] = (normal @ first.mean(axis=0) - shared @ normal[plane]) / normal[axis]
    return xyz if normal[axis] > 0.0 else xyz[::-1]


def clipped(subject: list[Point], clip: list[Point], same: float) -> list[Point]:
    """The part of a convex polygon within another (Sutherland and Hodgman), both counter-clockwise, without corners nearer
    than `same`. In plain numbers: of so few corners arrays take ten times as long."""
    kept = subject
    for (ax, ay), (bx, by) in zip(clip, [*clip[1:], clip[0]], strict=True):
        if not kept:
            break
        ex, ey = bx - ax, by - ay
        length = (ex * ex + ey * ey) ** 0.5
        if length <= same:
            continue
        side = [((y - ay) * ex - (x - ax) * ey) / length for x, y in kept]
        out: list[Point] = []
        for k, (x, y) in enumerate(kept):
            s, t = side[k - 1], side[k]
            if (s < -same and t > same) or (s > same and t < -same):
                px, py = kept[k - 1]
                share = s / (s - t)
                out.append((px + share * (x - px), py + share * (y - py)))
            if t >= -same:
                out.append((x, y))
        kept = out
    return [
        (x, y)
        for (x, y), (px, py) in zip(kept, [*kept[-1:], *kept[:-1]], strict=True)
        if (x - px) ** 2 + (y - py) ** 2 > same * same
    ]


def _area(polygon: list[Point]) -> float:
    return 0.5 * sum(x * v - u * y for (x, y), (u, v) in zip(polygon, [*polygon[1:], polygon[0]], strict=True))
