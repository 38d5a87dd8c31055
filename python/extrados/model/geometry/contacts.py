"""Joints of polygons that touch, and one list of all gaps and overlaps between them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import following, inside

#: How far apart stones that face each other may stand to be told as a near miss: 50 tolerances, within these bounds
#: [m], or twice the tolerance.
NEAR = 50.0
NEAR_BOUNDS = (1e-3, 1e-2)
#: Of the tolerance: gaps and overlaps below it are rounding.
ROUNDING = 1e-3
#: Cosine of the angle by which stretches of one face may differ.
SAME_WAY = 0.7
#: Edges are compared with edges and places so many at a time, at most; and those of one contact or gap are kept
AT_ONCE, MOST_COMPARED, MOST_KEPT = 1_000_000, 100_000_000, 2_000_000
PAIRS_OF_BOXES = 5_000_000
#: Pairs of neighbours that are looked at: so many, or so many times the blocks; in masonry a block has about eight.
MOST_PAIRS, MOST_NEIGHBOURS = 100_000, 50


class Overlap(BadGeometry):
    """Two blocks lie in the same place; the text names them."""


@dataclass(frozen=True)
class Flaw:
    """Two blocks that do not lie on each other as drawn; `second` is -1 where it is the ground.

    depth [m]: the widest part of a gap along the faces (length [m] of them), or how deep the two lie in each other.
    """

    kind: Literal["gap", "overlap"]
    first: int
    second: int
    depth: float
    place: tuple[float, float]
    length: float = 0.0


@dataclass(frozen=True)
class Contacts:
    """p, q (k, 2) [m] midway between the faces that touch, block a to the left; b is -1 on the ground.

    flaws: every gap and overlap beyond rounding, those within the tolerance too, the deepest first.
    """

    p: np.ndarray
    q: np.ndarray
    a: np.ndarray
    b: np.ndarray
    flaws: list[Flaw]


def shortest_joint(tolerance: float) -> float:
    """Length [m] below which a shared stretch is a point: ten tolerances, or three where that is above 1 mm."""
    return min(10.0 * tolerance, max(1e-3, 3.0 * tolerance))


def find_contacts(outlines: list[np.ndarray], ground: np.ndarray, tolerance: float) -> Contacts:
    """Contacts of counter-clockwise outlines with each other and with ground segments (k, 4) x, y, x, y.

    Faces touch where they run opposite ways within `tolerance` [m] of each other; stretches of one face that bends by
    less than `shortest_joint` are one joint. Overlaps are listed, not refused.
    """
    start = np.cumsum([0, *map(len, outlines)])
    first = np.concatenate(outlines)
    last = np.concatenate([following(o) for o in outlines])
    owner = np.repeat(np.arange(len(outlines)), np.diff(start))
    reach = max(float(np.clip(NEAR * tolerance, *NEAR_BOUNDS)), 2.0 * tolerance)
    shortest = shortest_joint(tolerance)
    near = _Near(outlines, start, first, last, reach)
    one, two = near.edges()
    rows, gaps = [], []

    def meet(e: np.ndarray, begin: np.ndarray, end: np.ndarray, other: np.ndarray, middle: bool) -> None:
        """Joints and gaps of edges e with opposite edges begin -> end of the blocks `other`."""
        low, high, at_low, at_high = _shared(first[e], last[e], begin, end)
        faces = high - low > shortest
        gap = np.maximum(np.abs(at_low), np.abs(at_high))
        on = faces & (gap <= tolerance)
        half = 0.5 if middle else 0.0
        rows.append(_stretches(first, last, e[on], low[on], high[on], half * at_low[on], half * at_high[on], owner[e[on]], other[on]))
        apart = np.maximum(-at_low, -at_high)  # the other lies to the right, outside
        for k in np.flatnonzero(faces & (apart > ROUNDING * tolerance) & (gap <= reach)).tolist():
            along = (last[e[k]] - first[e[k]]) / np.hypot(*(last[e[k]] - first[e[k]]))
            place = first[e[k]] + (low[k] if -at_low[k] > -at_high[k] else high[k]) * along
            gaps.append(Flaw("gap", int(owner[e[k]]), int(other[k]), float(apart[k]), _xy(place), float(high[k] - low[k])))

    meet(one, first[two], last[two], owner[two], middle=True)
    if len(ground):
        g, e = near.beside(ground)
        for begin, end in ((ground[:, :2], ground[:, 2:]), (ground[:, 2:], ground[:, :2])):
            meet(e, begin[g], end[g], np.full(len(e), -1), middle=False)
    table = _joined(np.concatenate(rows), shortest)
    flaws = _distinct([*gaps, *_overlaps(outlines, near, owner, one, two, ROUNDING * tolerance)], shortest)
    return Contacts(table[:, 2:4], table[:, 4:6], table[:, 0].astype(int), table[:, 1].astype(int), flaws)


def facing_edges(outlines: list[np.ndarray], farthest: float, tolerance: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges of different counter-clockwise outlines (n, 2) [m] that look at each other: their numbers in a row, and how far apart they
    are at most [m], up to `farthest`. Edges that lie in each other by more than a tolerance [m] are none."""
    first = np.concatenate(outlines)
    last = np.concatenate([following(o) for o in outlines])
    near = _Near(outlines, np.cumsum([0, *map(len, outlines)]), first, last, farthest)
    one, two = near.edges()
    low, high, at_low, at_high = _shared(first[one], last[one], first[two], last[two])
    apart = np.maximum(-at_low, -at_high)
    kept = (high - low > shortest_joint(tolerance)) & (apart <= farthest) & (np.maximum(at_low, at_high) <= tolerance)
    return one[kept], two[kept], np.maximum(apart[kept], 0.0)


def _distinct(flaws: list[Flaw], apart: float) -> list[Flaw]:
    """The deepest first; of those between the same two blocks and `apart` [m] or less from each other, the deepest."""
    told: dict[tuple[str, int, int], list[tuple[float, float]]] = {}
    found = []
    for flaw in sorted(flaws, key=lambda flaw: (-flaw.depth, flaw.first, flaw.second)):
        places = told.setdefault((flaw.kind, flaw.first, flaw.second), [])
        if all(math.hypot(x - flaw.place[0], y - flaw.place[1]) > apart for x, y in places):
            places.append(flaw.place)
            found.append(flaw)
    return found


def nearest(outlines: list[np.ndarray], ground: np.ndarray, block: int) -> Flaw | None:
    """The gap between a block and what stands nearest to it, another block or the ground; None where there is nothing."""
    best: Flaw | None = None
    edges = [(j, o, following(o)) for j, o in enumerate(outlines) if j != block]
    edges += [(-1, ground[:, :2], ground[:, 2:])] if len(ground) else []
    own = outlines[block]
    for j, a, b in edges:
        for points, (begin, end) in ((own, (a, b)), (np.concatenate([a, b]), (own, following(own)))):
            distance = _distance(points[:, None], begin, end)
            k = int(distance.min(axis=1).argmin())
            if best is None or distance[k].min() < best.depth:
                first, second = (block, j) if j < 0 else (min(block, j), max(block, j))
                best = Flaw("gap", first, second, float(distance[k].min()), _xy(points[k]))
    return best


def _xy(place: np.ndarray) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def _distance(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance [m] of points from segments a -> b, shapes that broadcast."""
    along = b - a
    share = np.clip(((points - a) * along).sum(axis=-1) / np.maximum((along**2).sum(axis=-1), 1e-300), 0.0, 1.0)
    off = a + share[..., None] * along - points
    return np.hypot(off[..., 0], off[..., 1])


def _spread(first: np.ndarray, count: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Ranges of `count` numbers from `first` on, one after the other: the range of each number, and the number; about
    AT_ONCE together, so that the memory is bounded."""
    parts = np.flatnonzero(np.diff(np.cumsum(count) // AT_ONCE)) + 1
    for some in np.split(np.arange(len(count)), parts):
        each = count[some]
        of = np.repeat(some, each)
        yield of, first[of] + np.arange(len(of)) - np.repeat(np.cumsum(each) - each, each)


class _Near:
    """What lies within `reach` [m] of each other: blocks, their edges first -> last, places and edges.

    BadGeometry where outlines of many points lie so close that too much would have to be compared.
    """

    def __init__(self, outlines: list[np.ndarray], start: np.ndarray, first: np.ndarray, last: np.ndarray, reach: float):
        self.start, self.size, self.first, self.last = start[:-1], np.diff(start), first, last
        self.grown = 0.5 * reach
        self.low, self.high = np.minimum(first, last) - self.grown, np.maximum(first, last) + self.grown
        self.box_low = np.array([o.min(axis=0) for o in outlines]) - self.grown
        self.box_high = np.array([o.max(axis=0) for o in outlines]) + self.grown
        self.i, self.j = box_pairs(self.box_low, self.box_high, max(MOST_PAIRS, MOST_NEIGHBOURS * len(outlines)))
        self._compared = 0

    def _against(self, numbers: np.ndarray, count: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Ranges of edges, counted among what is compared."""
        self._compared += int(count.sum())
        if self._compared > MOST_COMPARED:
            raise BadGeometry(
                f"the drawing is too dense: its {len(self.size)} outlines have more than {MOST_COMPARED:,} pairs of edges that are near "
                "each other, the limit of this program. Give the outlines fewer points, and the ground fewer segments"
            )
        return _spread(numbers, count)

    def _kept(self, pairs: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        return tuple(np.concatenate([np.empty((2, 0), dtype=int), *pairs], axis=1))

    def _add(self, pairs: list[np.ndarray], one: np.ndarray, two: np.ndarray) -> None:
        pairs.append(np.stack([one, two]))
        if sum(len(p[0]) for p in pairs) > max(MOST_KEPT, 10 * len(self.first)):
            raise BadGeometry(
                f"more than {MOST_KEPT:,} pairs of edges of outlines or ground are parallel and adjacent: much of "
                "the drawing is doubled. Remove the duplicates"
            )

    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the edges of neighbours whose boxes meet, the edge of the lower block first."""
        found: list[np.ndarray] = []
        for pair, e in _spread(self.start[self.i], self.size[self.i]):
            other = self.j[pair]
            near = ((self.low[e] <= self.box_high[other]) & (self.box_low[other] <= self.high[e])).all(axis=1)
            e, other = e[near], other[near]
            for row, f in self._against(self.start[other], self.size[other]):
                meet = ((self.low[e[row]] <= self.high[f]) & (self.low[f] <= self.high[e[row]])).all(axis=1)
                self._add(found, e[row[meet]], f[meet])
        return self._kept(found)

    def beside(self, ground: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Segments of the ground (k, 4) and edges whose boxes meet."""
        low = np.minimum(ground[:, :2], ground[:, 2:]) - self.grown
        high = np.maximum(ground[:, :2], ground[:, 2:]) + self.grown
        found: list[np.ndarray] = []
        every = np.full(len(ground), len(self.first))
        for g, e in self._against(np.zeros(len(ground), dtype=int), every):
            meet = ((low[g] <= self.high[e]) & (self.low[e] <= high[g])).all(axis=1)
            self._add(found, g[meet], e[meet])
        return self._kept(found)

    def depths(
        self, points: np.ndarray, begin: np.ndarray, count: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
        """How deep places of each block (`count` points from `begin` on) lie in its neighbours: block, neighbour, depth and
        point, where that is in the neighbour's box."""
        pairs = np.unique(np.column_stack([self.i, self.j]), axis=0)
        a, b = np.concatenate([pairs, pairs[:, ::-1]]).T
        for pair, probe in _spread(begin[a], count[a]):
            place, other = points[probe], b[pair]
            within = ((self.box_low[other] <= place) & (place <= self.box_high[other])).all(axis=1)
            pair, probe, other = pair[within], probe[within], other[within]
            for row, edge in self._against(self.start[other], self.size[other]):
                group = np.flatnonzero(np.diff(row, prepend=-1))
                at = row[group]
                deep = _depth(points[probe[row]], self.first[edge], self.last[edge], group)
                yield a[pair[at]], other[at], deep, probe[at]


def box_pairs(low: np.ndarray, high: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i < j of boxes (k, 2) low .. high that meet, by a sweep along x; BadGeometry where there are more than
    `most`."""
    order = np.argsort(low[:, 0])
    reach_to = np.searchsorted(low[order, 0], high[order, 0], side="right")
    count = np.maximum(reach_to - np.arange(len(order)) - 1, 0)
    found, total = [], 0
    # As many boxes at a time as are near some millions of others, so that the memory is bounded
    parts = np.searchsorted(np.cumsum(count), np.arange(PAIRS_OF_BOXES, int(count.sum()), PAIRS_OF_BOXES), side="right")
    for some in np.split(np.arange(len(order)), parts):
        i = np.repeat(some, count[some])
        j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(count[some]) - count[some], count[some])
        i, j = order[i], order[j]
        meet = (low[i, 1] <= high[j, 1]) & (low[j, 1] <= high[i, 1])
        found.append(np.stack([np.minimum(i, j)[meet], np.maximum(i, j)[meet]]))
        total += int(meet.sum())
        if total > most:
            raise BadGeometry(
                f"the boxes around {len(order)} outlines or lines intersect in more than {most:,} pairs, the limit "
                "of this program: much of the drawing is doubled. Remove the duplicates"
            )
    return tuple(np.concatenate(found, axis=1))


def _shared(a0: np.ndarray, a1: np.ndarray, b0: np.ndarray, b1: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Stretch of edges a that opposite edges b share, as distances along a, and where b lies at its ends, positive to
    the left of a. Edges that run the same way share nothing."""
    along = a1 - a0
    length = np.hypot(along[:, 0], along[:, 1])
    t = along / length[:, None]
    u0, u1 = b0 - a0, b1 - a0
    s0, s1 = (u0 * t).sum(axis=1), (u1 * t).sum(axis=1)
    d0, d1 = t[:, 0] * u0[:, 1] - t[:, 1] * u0[:, 0], t[:, 0] * u1[:, 1] - t[:, 1] * u1[:, 0]
    low, high = np.maximum(s1, 0.0), np.minimum(s0, length)
    run = np.where(s0 > s1, s0 - s1, 1.0)
    slope = (d0 - d1) / run
    return low, np.where(s0 > s1, high, low), d1 + slope * (low - s1), d1 + slope * (high - s1)


def _stretches(
    first: np.ndarray,
    last: np.ndarray,
    edge: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    at_low: np.ndarray,
    at_high: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
) -> np.ndarray:
    """Rows a, b, p, q; at_low and at_high shift p and q to the left of the edge [m]."""
    along = last[edge] - first[edge]
    t = along / np.hypot(along[:, 0], along[:, 1])[:, None]
    left = np.column_stack([-t[:, 1], t[:, 0]])
    p = first[edge] + low[:, None] * t + at_low[:, None] * left
    q = first[edge] + high[:, None] * t + at_high[:, None] * left
    return np.column_stack([a, b, p, q])


def _joined(rows: np.ndarray, slack: float) -> np.ndarray:
    """Stretches of one face between the same two blocks, end to end and within `slack` of one line, made one; sorted
    by blocks."""
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    # pair, the ends (n, 2) of its stretches, two first, and the box around them: a face has few neighbours of many
    kept: list[tuple[tuple[float, float], np.ndarray, list[float]]] = []
    for row in rows:
        pair, face = (row[0], row[1]), row[2:].reshape(2, 2)
        box = _box(face, 4.0 * slack)
        k = len(kept) - 1
        while k >= 0 and kept[k][0] == pair:
            west, south, east, north = kept[k][2]
            if west <= box[2] and box[0] <= east and south <= box[3] and box[1] <= north:
                if (together := _in_line(kept[k][1], face, slack)) is not None:
                    face, box = together, _box(together, 4.0 * slack)
                    del kept[k]
                    k = len(kept)  # longer now, it may meet those that it did not meet before
            k -= 1
        kept.append((pair, face, box))
    return np.array([[*pair, *face[0], *face[1]] for pair, face, _ in kept]).reshape(-1, 6)


def _box(points: np.ndarray, grown: float) -> list[float]:
    """Least x and y, greatest x and y."""
    return [*(points.min(axis=0) - grown).tolist(), *(points.max(axis=0) + grown).tolist()]


def _in_line(face: np.ndarray, more: np.ndarray, slack: float) -> np.ndarray | None:
    """Ends of two stretches (n, 2) and (m, 2) as those of one, the outermost two first; None where they make no one line."""
    one, two = face[1] - face[0], more[1] - more[0]
    if one @ two < SAME_WAY * np.hypot(*one) * np.hypot(*two):
        return None
    together = np.concatenate([face, more])
    s = together @ ((one + two) / np.hypot(*(one + two)))
    n = len(face)
    if s[n:].min() > s[:n].max() + slack or s[n:].max() < s[:n].min() - slack:
        return None
    first, last = int(s.argmin()), int(s.argmax())
    t = (together[last] - together[first]) / np.hypot(*(together[last] - together[first]))
    off = together - together[first]
    if np.abs(off[:, 1] * t[0] - off[:, 0] * t[1]).max() >= slack:
        return None
    rest = [k for k in range(len(together)) if k not in (first, last)]
    return together[[first, last, *rest]]


def _overlaps(outlines: list[np.ndarray], near: _Near, owner: np.ndarray, one: np.ndarray, two: np.ndarray, rounding: float) -> list[Flaw]:
    """Where two blocks lie in each other by more than `rounding`: their edges cross, or one holds a place of the other."""
    first, last = near.first, near.last
    rows: list[np.ndarray] = []  # block i, block j, depth, x, y

    def add(i: np.ndarray, j: np.ndarray, depth: np.ndarray, place: np.ndarray) -> None:
        rows.append(np.column_stack([np.minimum(i, j), np.maximum(i, j), depth, place]))

    def offsets(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        t = last[a] - first[a]
        t = t / np.hypot(t[:, 0], t[:, 1])[:, None]
        begin, end = (t[:, 0] * (e[b] - first[a])[:, 1] - t[:, 1] * (e[b] - first[a])[:, 0] for e in (first, last))
        return begin, end

    (b0, b1), (a0, a1) = offsets(one, two), offsets(two, one)
    crossing = np.minimum.reduce([-np.minimum(b0, b1), np.maximum(b0, b1), -np.minimum(a0, a1), np.maximum(a0, a1)])
    k = np.flatnonzero(crossing > rounding)
    where = first[two[k]] + (b0[k] / (b0[k] - b1[k]))[:, None] * (last[two[k]] - first[two[k]])
    add(owner[one[k]], owner[two[k]], crossing[k], where)
    # Where no edges cross, one lies in the other only with all of it. Corners, middles of edges and a place
    # inside tell, among them those that lie on the other's outline.
    probes = [np.concatenate([o, 0.5 * (o + following(o)), _within(o)]) for o in outlines]
    count = np.array([len(p) for p in probes])
    points = np.concatenate(probes)
    for a, b, deep, probe in near.depths(points, np.cumsum(count) - count, count):
        k = np.flatnonzero(deep > rounding)
        add(a[k], b[k], deep[k], points[probe[k]])
    table = np.concatenate(rows)
    table = table[np.lexsort((-table[:, 2], table[:, 1], table[:, 0]))]
    deepest = np.ones(len(table), dtype=bool)
    deepest[1:] = (table[1:, :2] != table[:-1, :2]).any(axis=1)
    return [Flaw("overlap", int(i), int(j), depth, (x, y)) for i, j, depth, x, y in table[deepest].tolist()]


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
    near = np.minimum.reduceat(_distance(points, a, b), group)
    return np.where(crossed, near, 0.0)
