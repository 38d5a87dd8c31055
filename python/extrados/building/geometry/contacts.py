"""Joints of polygons that touch: shared stretches of their edges; overlaps and near misses are named."""

from dataclasses import dataclass

import numpy as np

from extrados.building.errors import BadGeometry
from extrados.building.geometry.polygons import following, inside

NEAR = 50.0  # times the tolerance: gaps up to this are reported as near misses


class Overlap(BadGeometry):
    """Two blocks lie in the same place; the text names them."""


@dataclass(frozen=True)
class Contacts:
    """p, q (k, 2) [m] along the edges of block a, which lies to the left; b is -1 on the ground.

    near: (block, block, gap in m) of pairs that face each other without touching.
    """

    p: np.ndarray
    q: np.ndarray
    a: np.ndarray
    b: np.ndarray
    near: list[tuple[int, int, float]]


def find_contacts(outlines: list[np.ndarray], ground: np.ndarray, tolerance: float, names: list[str]) -> Contacts:
    """Contacts of counter-clockwise outlines with each other and with ground segments (k, 4) x, y, x, y.

    Edges touch where they run opposite ways within `tolerance` [m] of one line. Stretches shorter than ten
    tolerances are points, not joints. Overlap names blocks that lie in each other by more than the tolerance.
    """
    start = np.cumsum([0, *map(len, outlines)])
    first = np.concatenate(outlines)
    last = np.concatenate([following(o) for o in outlines])
    owner = np.repeat(np.arange(len(outlines)), np.diff(start))
    one, two = _edge_pairs(outlines, start, NEAR * tolerance)
    _refuse_overlaps(outlines, first, last, owner, one, two, tolerance, names)

    low, high, gap = _shared(first[one], last[one], first[two], last[two])
    long_enough = high - low > 10.0 * tolerance
    touch = long_enough & (gap <= tolerance)
    near: dict[tuple[int, int], float] = {}
    for i, j, g in zip(
        owner[one[long_enough & ~touch]], owner[two[long_enough & ~touch]], gap[long_enough & ~touch], strict=True
    ):
        if g <= NEAR * tolerance:
            near[i, j] = min(g, near.get((i, j), np.inf))
    rows = [_stretches(first, last, one[touch], low[touch], high[touch], owner[one[touch]], owner[two[touch]])]

    if len(ground):
        g = np.repeat(np.arange(len(ground)), len(first))
        e = np.tile(np.arange(len(first)), len(ground))
        for begin, end in ((ground[:, :2], ground[:, 2:]), (ground[:, 2:], ground[:, :2])):
            low, high, gap = _shared(first[e], last[e], begin[g], end[g])
            on = (high - low > 10.0 * tolerance) & (gap <= tolerance)
            rows.append(_stretches(first, last, e[on], low[on], high[on], owner[e[on]], np.full(int(on.sum()), -1)))
    table = _joined(np.concatenate(rows), 10.0 * tolerance)
    touching = {(int(r[0]), int(r[1])) for r in table}
    misses = [
        (int(i), int(j), float(g)) for (i, j), g in near.items() if (i, j) not in touching and (j, i) not in touching
    ]
    return Contacts(table[:, 2:4], table[:, 4:6], table[:, 0].astype(int), table[:, 1].astype(int), misses)


def _edge_pairs(outlines: list[np.ndarray], start: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Edge numbers of all pairs of blocks whose boxes come within `reach`, the lower block first."""
    low = np.array([o.min(axis=0) for o in outlines]) - 0.5 * reach
    high = np.array([o.max(axis=0) for o in outlines]) + 0.5 * reach
    order = np.argsort(low[:, 0])
    reach_to = np.searchsorted(low[order, 0], high[order, 0], side="right")
    count = np.maximum(reach_to - np.arange(len(order)) - 1, 0)
    i = np.repeat(np.arange(len(order)), count)
    j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(count) - count, count)
    i, j = order[i], order[j]
    meet = (low[i, 1] <= high[j, 1]) & (low[j, 1] <= high[i, 1])
    i, j = np.minimum(i, j)[meet], np.maximum(i, j)[meet]
    edges_i, edges_j = np.diff(start)[i], np.diff(start)[j]
    total = edges_i * edges_j
    within = np.arange(total.sum()) - np.repeat(np.cumsum(total) - total, total)
    per = np.repeat(edges_j, total)
    return np.repeat(start[i], total) + within // per, np.repeat(start[j], total) + within % per


def _shared(
    a0: np.ndarray, a1: np.ndarray, b0: np.ndarray, b1: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stretch of edges a that opposite edges b share, as distances along a, and their gap there."""
    along = a1 - a0
    length = np.hypot(along[:, 0], along[:, 1])
    t = along / length[:, None]
    u0, u1 = b0 - a0, b1 - a0
    s0, s1 = (u0 * t).sum(axis=1), (u1 * t).sum(axis=1)
    d0, d1 = t[:, 0] * u0[:, 1] - t[:, 1] * u0[:, 0], t[:, 0] * u1[:, 1] - t[:, 1] * u1[:, 0]
    low, high = np.maximum(s1, 0.0), np.minimum(s0, length)
    # Edges that run the same way share nothing; the gap is taken at the ends of the shared stretch.
    run = np.where(s0 > s1, s0 - s1, 1.0)
    slope = (d0 - d1) / run
    gap = np.maximum(np.abs(d1 + slope * (low - s1)), np.abs(d1 + slope * (high - s1)))
    return low, np.where(s0 > s1, high, low), gap


def _stretches(
    first: np.ndarray,
    last: np.ndarray,
    edge: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
) -> np.ndarray:
    """Rows a, b, p, q."""
    along = last[edge] - first[edge]
    t = along / np.hypot(along[:, 0], along[:, 1])[:, None]
    return np.column_stack([a, b, first[edge] + low[:, None] * t, first[edge] + high[:, None] * t])


def _joined(rows: np.ndarray, slack: float) -> np.ndarray:
    """Stretches of one line between the same two blocks, end to end, made one; sorted by blocks."""
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    kept: list[np.ndarray] = []
    for row in rows:
        for other in reversed(kept):
            if other[0] != row[0] or other[1] != row[1]:
                kept.append(row)
                break
            t = (other[4:6] - other[2:4]) / np.hypot(*(other[4:6] - other[2:4]))
            off = np.array([row[2:4] - other[2:4], row[4:6] - other[2:4]])
            s, d = off @ t, off @ np.array([-t[1], t[0]])
            length = float((other[4:6] - other[2:4]) @ t)
            if np.abs(d).max() < slack and s.min() < length + slack and s.max() > -slack:
                begin, end = min(0.0, s.min()), max(length, s.max())
                other[4:6] = other[2:4] + end * t
                other[2:4] = other[2:4] + begin * t
                break
        else:
            kept.append(row)
    return np.array(kept).reshape(-1, 6)


def _refuse_overlaps(
    outlines: list[np.ndarray], first: np.ndarray, last: np.ndarray, owner: np.ndarray, one: np.ndarray, two: np.ndarray,
    tolerance: float, names: list[str],
) -> None:  # fmt: skip
    """Overlap where two blocks lie in each other: their edges cross, or one holds a place of the other."""

    def offsets(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        t = last[a] - first[a]
        t = t / np.hypot(t[:, 0], t[:, 1])[:, None]
        begin, end = (t[:, 0] * (e[b] - first[a])[:, 1] - t[:, 1] * (e[b] - first[a])[:, 0] for e in (first, last))
        return begin, end

    (b0, b1), (a0, a1) = offsets(one, two), offsets(two, one)
    cross = (np.minimum(b0, b1) < -tolerance) & (np.maximum(b0, b1) > tolerance)
    cross &= (np.minimum(a0, a1) < -tolerance) & (np.maximum(a0, a1) > tolerance)
    if cross.any():
        k = int(np.flatnonzero(cross)[0])
        raise Overlap(_say(names, owner[one[k]], owner[two[k]], 0.5 * (first[one[k]] + last[one[k]])))
    # No edges cross: then one lies in the other only with all of it. Corners, middles of edges and a place
    # inside tell, among them those that lie on the other's outline.
    start = np.searchsorted(owner, np.arange(len(outlines) + 1))
    pairs = np.unique(np.column_stack([owner[one], owner[two]]), axis=0) if len(one) else np.empty((0, 2), int)
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    probes = [np.concatenate([o, 0.5 * (o + following(o)), _within(o)]) for o in outlines]
    begin = np.cumsum([0, *map(len, probes)])
    points = np.concatenate(probes)
    for some in np.array_split(pairs, max(1, len(pairs) // PAIRS_AT_ONCE)):
        probe_count, edge_count = np.diff(begin)[some[:, 0]], np.diff(start)[some[:, 1]]
        pair = np.repeat(np.arange(len(some)), probe_count)
        probe = (
            begin[some[pair, 0]] + np.arange(len(pair)) - np.repeat(np.cumsum(probe_count) - probe_count, probe_count)
        )
        edges = edge_count[pair]
        group = np.cumsum(edges) - edges
        at = np.repeat(np.arange(len(pair)), edges)
        edge = start[some[pair[at], 1]] + np.arange(len(at)) - group[at]
        deep = _depth(points[probe[at]], first[edge], last[edge], group) > tolerance
        if deep.any():
            k = int(np.flatnonzero(deep)[0])
            i, j = some[pair[k]].tolist()
            raise Overlap(_say(names, i, j, points[probe[k]]))


PAIRS_AT_ONCE = 5000


def _within(outline: np.ndarray) -> np.ndarray:
    """A place inside an outline (1, 2): its mean where that lies inside, else next to an edge's middle."""
    mean = outline.mean(axis=0, keepdims=True)
    if inside(outline, mean)[0]:
        return mean
    along = following(outline) - outline
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    places = outline + 0.5 * along + 1e-3 * inward
    return places[inside(outline, places)][:1]


def _depth(points: np.ndarray, a: np.ndarray, b: np.ndarray, group: np.ndarray) -> np.ndarray:
    """How deep points lie inside outlines: rows pair each point with each edge, `group` is where points start."""
    x, y = points.T
    spans = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        right = x < a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    crossed = np.add.reduceat((spans & right).astype(int), group) % 2 == 1
    along = b - a
    share = np.clip(((points - a) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    near = np.minimum.reduceat(np.hypot(*(a + share[:, None] * along - points).T), group)
    return np.where(crossed, near, 0.0)


def _say(names: list[str], i: int, j: int, place: np.ndarray) -> str:
    return f"blocks '{names[i]}' and '{names[j]}' overlap near x = {place[0]:.4g} m, y = {place[1]:.4g} m"
