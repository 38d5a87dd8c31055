"""Where solids touch: pairs that are near each other, faces that lie on each other, and the polygons they share."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.solids.polyhedra import Polyhedron, overlap_depth

GROUND = -1
Point = tuple[float, float]
FACING = -0.7  # cosine between the normals of faces that may lie on each other
#: Pairs of parts that are looked at: so many, or so many times the parts; in masonry a stone has about ten neighbours
MOST_PAIRS, MOST_NEIGHBOURS = 100_000, 50
SAME = 1e-9  # of the size of a face: what two faces share and is narrower is an edge, as drawn


@dataclass
class Touching:
    """polygon: corners (k, 3) [m] of each contact, counter-clockwise about normal (nj, 3), which points into block a;
    apart: the least tolerance with which it is one [m]; faces: both as part and number of the face. overlaps: (block, block, depth [m]); gaps: the same of faces
    that nearly touch; slivers: (block, block, width [m]) of contacts narrower than the tolerance, which carry nothing."""

    polygon: list[np.ndarray] = field(default_factory=list)
    normal: list[np.ndarray] = field(default_factory=list)
    a: list[int] = field(default_factory=list)
    b: list[int] = field(default_factory=list)
    apart: list[float] = field(default_factory=list)
    faces: list[tuple[tuple[int, int], tuple[int, int]]] = field(default_factory=list)
    overlaps: list[tuple[int, int, float]] = field(default_factory=list)
    gaps: list[tuple[int, int, float]] = field(default_factory=list)
    slivers: list[tuple[int, int, float]] = field(default_factory=list)


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
                f"the boxes around {len(low)} solids intersect in more than {most:,} pairs, the limit of this program: many solids overlap"
            )
    pairs = np.concatenate(found) if found else np.empty((0, 2), dtype=int)
    pairs = np.sort(pairs, axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def touching(parts: Sequence[Polyhedron], owner: np.ndarray, tolerance: float, near: float, mortar: float = 0.0) -> Touching:
    """Contacts of the blocks that own the parts [m]. Two faces touch where their fitted planes lie within `tolerance` of each
    other in the middle of what the faces share, and are as parallel as corners within it leave them; the contact lies midway.
    It is narrow where its area over its diameter is below the tolerance. Gaps up to `near` are told by what would close them.
    mortar [m]: faces apart by up to that much touch, too.
    """
    found = Touching()
    low, high = (np.array([getattr(part, end) for part in parts]) for end in ("low", "high"))
    for i, j in near_pairs(low, high, owner, near).tolist():
        _meet(found, parts, (i, j), (int(owner[i]), int(owner[j])), tolerance, near, mortar)
    return found


def slant(sine: np.ndarray, width: np.ndarray) -> np.ndarray:
    """The tolerance [m] that leaves two faces parallel whose normals differ by an angle: corners of a square face that each
    lie within a quarter of it off their planes turn the normals of both by up to half of that."""
    return sine * width / 2.0**0.5


def _meet(
    found: Touching,
    parts: Sequence[Polyhedron],
    pair: tuple[int, int],
    owners: tuple[int, int],
    tolerance: float,
    near: float,
    mortar: float,
) -> None:
    """Contacts, slivers, overlap or gap of two parts."""
    (i, j), (a, b) = pair, owners
    one, two = parts[i], parts[j]
    opposed = one.normals @ two.normals.T
    sine = np.sqrt(np.clip(1.0 - opposed * opposed, 0.0, None))
    turned = slant(sine, np.minimum(one.widths[:, None], two.widths[None]))
    # how far the plane of the second face lies from the middle of the first
    apart = one.middles @ two.normals.T - two.offsets[None]
    facing = (opposed < FACING) & (turned < near)
    facing &= np.abs(apart) < near + sine * np.linalg.norm(one.high - one.low)
    touched = False
    closing = np.inf
    for f, g in np.argwhere(facing).tolist():
        shared = shared_polygon(one, f, two, g)
        if shared is None:
            continue
        points, normal, gap, width = shared
        needed = max(abs(gap), float(turned[f, g]))
        if needed > (max(tolerance, mortar) if gap > 0.0 else tolerance):
            if -tolerance < gap and needed < near and width > tolerance:
                closing = min(closing, needed)
        elif width < tolerance:
            found.slivers.append((a, b, width))
        else:
            touched = True
            found.polygon.append(points[::-1])  # counter-clockwise about the outward normal of the second
            found.normal.append(-normal)
            found.a.append(a)
            found.b.append(b)
            found.apart.append(needed)
            found.faces.append(((i, f), (j, g)))
    if not touched:
        depth = overlap_depth(one, two)
        if depth > tolerance:
            found.overlaps.append((a, b, depth))
        elif closing < near:
            found.gaps.append((a, b, closing))


def shared_polygon(one: Polyhedron, f: int, two: Polyhedron, g: int) -> tuple[np.ndarray, np.ndarray, float, float] | None:
    """What face f of one body and face g of another share: its corners in the plane midway between both faces (k, 3),
    counter-clockwise about the normal of that plane, which points to the second body, this normal, the gap between the planes of
    the faces in its middle [m], and its area over its diameter [m]; None where that is no more than an edge."""
    normal = one.normals[f] - two.normals[g]
    normal = normal / np.linalg.norm(normal)
    plane = _frame(normal)
    first, second = one.vertices[list(one.faces[f])], two.vertices[list(two.faces[g])]
    origin = first[0]
    subject, clip = (first - origin) @ plane, (second - origin) @ plane
    if (subject.min(axis=0) >= clip.max(axis=0)).any() or (clip.min(axis=0) >= subject.max(axis=0)).any():
        return None
    one_ring, two_ring = ([(float(x), float(y)) for x, y in ring.tolist()] for ring in (subject, clip[::-1]))
    same = SAME * max(one.areas[f], two.areas[g]) ** 0.5
    shared = clipped(one_ring, two_ring, same)
    if len(shared) < 3:
        return None
    points, area = np.array(shared), _area(shared)
    width = area / _diameter(points)
    if width < same:
        return None
    middle = origin + plane @ _centre(shared, area)
    # along the normal from the middle to either plane
    below = (one.offsets[f] - one.normals[f] @ middle) / (one.normals[f] @ normal)
    above = (two.offsets[g] - two.normals[g] @ middle) / (two.normals[g] @ normal)
    return origin + points @ plane.T + 0.5 * (below + above) * normal, normal, float(above - below), width


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
    return [(x, y) for (x, y), (px, py) in zip(kept, [*kept[-1:], *kept[:-1]], strict=True) if (x - px) ** 2 + (y - py) ** 2 > same * same]


def _area(polygon: list[Point]) -> float:
    return 0.5 * sum(x * v - u * y for (x, y), (u, v) in zip(polygon, [*polygon[1:], polygon[0]], strict=True))


def _diameter(points: np.ndarray) -> float:
    """Greatest distance between two of the points (k, n)."""
    apart = points[:, None] - points[None]
    return float(np.sqrt((apart * apart).sum(axis=2).max()))


def _centre(polygon: list[Point], area: float) -> list[float]:
    """Centroid of a polygon of a known area."""
    ox, oy = polygon[0]
    sx = sy = 0.0
    for (x, y), (u, v) in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
        x, y, u, v = x - ox, y - oy, u - ox, v - oy
        cross = x * v - u * y
        sx += (x + u) * cross
        sy += (y + v) * cross
    return [ox + sx / (6.0 * area), oy + sy / (6.0 * area)]


def _frame(normal: np.ndarray) -> np.ndarray:
    """Two unit vectors (3, 2) that make a right-handed frame with a normal."""
    x, y, z = normal.tolist()
    u = [(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)][int(np.abs(normal).argmin())]
    length = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) ** 0.5
    a, b, c = (part / length for part in u)
    return np.array([[a, y * c - z * b], [b, z * a - x * c], [c, x * b - y * a]])
