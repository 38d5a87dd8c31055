"""Closed outlines in loose linework: lines whose ends nearly meet, cross or stand on each other, made one net."""

from dataclasses import dataclass

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.contacts import box_pairs
from extrados.model.geometry.polygons import inside, properties, signed_area

YIELDS = 1e-9  # weight of a line beside a firm one
#: Pairs of lines that are looked at: so many, or so many times the lines
MOST_PAIRS, MOST_NEIGHBOURS = 2_000_000, 50


@dataclass(frozen=True)
class LooseEnd:
    """A line that ends nowhere: its place [m], and how far [m] the nearest other line is; None where none is near."""

    place: tuple[float, float]
    gap: float | None


@dataclass(frozen=True)
class Net:
    """faces: outlines (n, 2) [m], counter-clockwise; source: the line that each edge of them comes from; loose: lines
    that bound none because they end nowhere."""

    faces: list[np.ndarray]
    source: list[np.ndarray]
    loose: list[LooseEnd]


def net_of(lines: np.ndarray, tolerance: float, near: float, firm: np.ndarray | None = None) -> Net:
    """The smallest closed outlines that straight lines (k, 4) x, y, x, y make [m].

    Lines are cut where they cross. Ends within `tolerance` of each other are one point, midway, or where the lines
    end that are `firm` (k); an end within it of another line lies on that line. Lines that end nowhere bound
    nothing and are told, with the gap to the nearest other up to `near`.
    """
    lines = np.asarray(lines, dtype=float).reshape(-1, 4)
    weight = np.ones(len(lines)) if firm is None else np.where(firm, 1.0, YIELDS)
    lines, weight, of = _once(lines, weight)
    ends, edges, source = _knotted(lines, weight, tolerance)
    kept, loose = _pruned(ends, edges, tolerance, near)
    faces, sides = _faces(ends, edges[kept])
    return Net(faces, [of[source[kept][side]] for side in sides], loose)


def _once(lines: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines that are drawn several times, either way round, taken once: the first, as firm as the firmest."""
    turned = (lines[:, 0] > lines[:, 2]) | ((lines[:, 0] == lines[:, 2]) & (lines[:, 1] > lines[:, 3]))
    way = np.where(turned[:, None], lines[:, [2, 3, 0, 1]], lines)
    _, first, number = np.unique(way, axis=0, return_index=True, return_inverse=True)
    firmest = np.zeros(len(first))
    np.maximum.at(firmest, number.reshape(-1), weight)
    order = np.argsort(first)
    return lines[first[order]], firmest[order], first[order]


def _knotted(lines: np.ndarray, weight: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 2), edges (k, 2) between them, and the line that each edge is part of."""
    begin, end = lines[:, :2], lines[:, 2:]
    along = end - begin
    length = np.hypot(*along.T)
    keep = length > tolerance
    index = np.flatnonzero(keep)
    begin, end, along, length = begin[keep], end[keep], along[keep], length[keep]
    low, high = np.minimum(begin, end) - tolerance, np.maximum(begin, end) + tolerance
    i, j = box_pairs(low, high, max(MOST_PAIRS, MOST_NEIGHBOURS * len(begin)))
    cuts: list[tuple[np.ndarray, np.ndarray]] = [
        (np.arange(len(begin)), np.zeros(len(begin))),
        (np.arange(len(begin)), np.ones(len(begin))),
    ]
    # Ends that stand on another line cut it at their foot.
    for one, two in ((i, j), (j, i)):
        for point in (begin, end):
            share = ((point[one] - begin[two]) * along[two]).sum(axis=1) / length[two] ** 2
            off = point[one] - begin[two] - share[:, None] * along[two]
            on = (np.hypot(*off.T) <= tolerance) & (share > 0.0) & (share < 1.0)
            cuts.append((two[on], share[on]))
    cross = along[i, 0] * along[j, 1] - along[i, 1] * along[j, 0]
    flat = np.abs(cross) < 1e-12 * length[i] * length[j]
    safe = np.where(flat, 1.0, cross)
    apart = begin[j] - begin[i]
    at_i = (apart[:, 0] * along[j, 1] - apart[:, 1] * along[j, 0]) / safe
    at_j = (apart[:, 0] * along[i, 1] - apart[:, 1] * along[i, 0]) / safe
    met = ~flat & (at_i > 0.0) & (at_i < 1.0) & (at_j > 0.0) & (at_j < 1.0)
    cuts += [(i[met], at_i[met]), (j[met], at_j[met])]
    line = np.concatenate([c[0] for c in cuts])
    share = np.concatenate([c[1] for c in cuts])
    order = np.lexsort((share, line))
    line, share = line[order], share[order]
    points = begin[line] + share[:, None] * along[line]
    knot, count = _clusters(points, tolerance)
    own = weight[index[line]]
    weighed = np.stack([np.bincount(knot, own * x, count) for x in points.T], axis=1)
    middle = weighed / np.bincount(knot, own, count)[:, None]
    follows = line[1:] == line[:-1]
    edges = np.column_stack([knot[:-1], knot[1:]])[follows]
    source = index[line[:-1][follows]]
    real = edges[:, 0] != edges[:, 1]
    edges, source = edges[real], source[real]
    _, first = np.unique(np.sort(edges, axis=1), axis=0, return_index=True)
    return middle, edges[first], source[first]


def _clusters(points: np.ndarray, tolerance: float) -> tuple[np.ndarray, int]:
    """Number of the knot of each point: points within the tolerance of each other, in steps, are one."""
    from scipy.sparse import coo_array  # these take a third of a second to load, and few decks name a drawing
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    count, knot = connected_components(graph, directed=False)
    return knot, int(count)


def _pruned(ends: np.ndarray, edges: np.ndarray, tolerance: float, near: float) -> tuple[np.ndarray, list[LooseEnd]]:
    """Edges that remain when those with a free end are taken away, again and again; and the free ends to begin with."""
    degree = np.bincount(edges.ravel(), minlength=len(ends))
    free = np.flatnonzero(degree == 1)
    gaps = _gaps(ends, edges, free, near)
    loose = [
        LooseEnd((x, y), gap if tolerance < gap <= near else None) for (x, y), gap in zip(ends[free].tolist(), gaps.tolist(), strict=True)
    ]
    kept = np.ones(len(edges), dtype=bool)
    at = np.argsort(edges.ravel(), kind="stable") // 2  # the edges at each point, point by point
    begin = np.concatenate([[0], np.cumsum(degree)]).tolist()
    left, waiting = degree.tolist(), free.tolist()
    while waiting:
        k = waiting.pop()
        if left[k] != 1:
            continue
        (edge,) = (e for e in at[begin[k] : begin[k + 1]].tolist() if kept[e])
        kept[edge] = False
        for end in edges[edge].tolist():
            left[end] -= 1
            if left[end] == 1:
                waiting.append(end)
    return kept, loose


def _gaps(ends: np.ndarray, edges: np.ndarray, free: np.ndarray, near: float) -> np.ndarray:
    """How far each free end is from the nearest edge that does not meet its own; infinite where none is within `near`."""
    gaps = np.full(len(free), np.inf)
    number = np.full(len(ends), -1)
    number[free] = np.arange(len(free))
    own = np.empty(len(free), dtype=int)  # the one edge of each, and where that begins
    for side in (0, 1):
        here = np.flatnonzero(number[edges[:, side]] >= 0)
        own[number[edges[here, side]]] = here
    root = edges[own].sum(axis=1) - free
    a, b = ends[edges[:, 0]], ends[edges[:, 1]]
    low = np.concatenate([np.minimum(a, b), ends[free] - near])
    high = np.concatenate([np.maximum(a, b), ends[free] + near])
    try:
        first, second = box_pairs(low, high, max(MOST_PAIRS, MOST_NEIGHBOURS * len(low)))
    except BadGeometry:
        return gaps  # of a hatch, or all in one place: no gap says anything there
    edge, k = np.minimum(first, second), np.maximum(first, second) - len(edges)
    other = (edge < len(edges)) & (k >= 0)
    edge, k = edge[other], k[other]
    # A line that shares the other end of this one is near it whatever this end does.
    other = (edge != own[k]) & (edges[edge] != root[k, None]).all(axis=1)
    edge, k = edge[other], k[other]
    along, off = b[edge] - a[edge], ends[free[k]] - a[edge]
    share = np.clip((off * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    np.minimum.at(gaps, k, np.hypot(*(off - share[:, None] * along).T))
    return gaps


def _faces(ends: np.ndarray, edges: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Bounded faces of a plane net, counter-clockwise, and the edges along them: always the next edge to the right."""
    if not len(edges):
        return [], []
    start = np.concatenate([edges[:, 0], edges[:, 1]])
    to = np.concatenate([edges[:, 1], edges[:, 0]])
    m = len(edges)
    twin = np.concatenate([np.arange(m) + m, np.arange(m)])
    angle = np.arctan2(*(ends[to] - ends[start]).T[::-1])
    order = np.lexsort((angle, start))
    place = np.empty(2 * m, dtype=int)
    place[order] = np.arange(2 * m)
    begin = np.searchsorted(start[order], np.arange(len(ends) + 1))
    # After an edge comes the one just clockwise of its twin, around the point where it ends.
    back = place[twin]
    first = begin[to]
    follows = order[np.where(back > first, back - 1, begin[to + 1] - 1)]
    seen = np.zeros(2 * m, dtype=bool)
    faces, sides = [], []
    for k in range(2 * m):
        if seen[k]:
            continue
        way = []
        while not seen[k]:
            seen[k] = True
            way.append(k)
            k = int(follows[k])
        outline = ends[start[way]]
        if len(way) > 2 and signed_area(outline) > 0.0:
            faces.append(outline)
            sides.append(np.array(way) % m)
    return faces, sides


def place_in(face: np.ndarray) -> np.ndarray:
    """The middle of a face, or else, where that lies outside, a place beside its longest edge (2)."""
    middle = properties(face)[1]
    if not inside(face, middle[None])[0]:
        along = np.roll(face, -1, axis=0) - face
        k = int(np.hypot(*along.T).argmax())
        middle = face[k] + 0.5 * along[k] + 1e-3 * np.array([-along[k, 1], along[k, 0]])
    return middle
