"""Walls with openings divided into rigid nodes, piers, spandrels and ring beams."""

import itertools

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, PlanWall, WallOpening
from extrados.views.frame.frame import Node, Strip
from extrados.views.frame.options import FrameOptions
from extrados.views.frame.rules import Side, deformable

#: Piers above each other belong to one node where they overlap by more than this part of the narrower
OVERLAP = 0.25


class Division:
    """The walls of a plan, divided one by one by `divide_wall`."""

    def __init__(self, plan: Plan, options: FrameOptions):
        self.plan, self.options = plan, options
        self.remarks: list[str] = []
        self.nodes: list[Node] = []
        self.at: dict[tuple[int, int], list[int]] = {}  # wall and level: its nodes from start to end
        self.strips: list[Strip] = []

    def divide_wall(self, w: int, wall: PlanWall) -> None:
        """Nodes, piers, spandrels and ring beams of a wall; BadGeometry if a storey has no pier."""
        plan, (_, last) = self.plan, self.plan.reach(wall)
        pieces = {storey: _between(wall, plan.openings_in(wall, storey)) for storey in range(1, last + 1)}
        for storey, found in pieces.items():
            if not found:
                raise BadGeometry(f"wall '{wall.name}', storey {storey}: the openings leave no pier")
        for level in range(last + 1):
            below, above = pieces.get(level, []), pieces.get(level + 1, [])
            groups = _groups([p[:2] for p in below], [p[:2] for p in above])
            if level and any(len(g) > 2 for g in groups):
                self.remarks.append(
                    f"Wall '{wall.name}', level {level}: piers above and below do not lie above each other. Piers "
                    "that overlap share one rigid node."
                )
            for group in groups:
                if level and not any(side == 0 for side, _ in group):
                    ends = [above[k][:2] for _, k in group]
                    self.remarks.append(
                        f"Wall '{wall.name}', level {level}: the pier at {ends[0][0]:.3g} to {ends[0][1]:.3g} m is above an opening, so "
                        "only spandrels support it."
                    )
                ends = [(below, above)[side][k][:2] for side, k in group]
                self.at.setdefault((w, level), []).append(len(self.nodes))
                self.nodes.append(Node(w, level, min(e[0] for e in ends), max(e[1] for e in ends)))
            self.at[w, level].sort(key=lambda k: self.nodes[k].start)
        for storey, found in pieces.items():
            tall, foot = plan.storeys[storey - 1], float(plan.levels[storey - 1])
            for k, (start, end, left, right) in enumerate(found):
                low, height = deformable(self.options.heights, end - start, tall, left, right)
                s = 0.5 * (start + end)
                self.strips.append(
                    Strip(
                        "pier",
                        f"{wall.name}, storey {storey}, pier {k + 1}",
                        w,
                        storey,
                        (start, end, foot, foot + tall),
                        (start, end, foot + low, foot + low + height),
                        plan.thickness_of(wall, storey),
                        (self.node_at(w, storey - 1, s), self.node_at(w, storey, s)),
                    )
                )
        for level in range(1, last + 1):
            own = self.at[w, level]
            for k, (i, j) in enumerate(itertools.pairwise(own)):
                self._spandrel(w, wall, level, k, i, j)
                self._ring_beam(w, wall, level, k, i, j)

    def node_at(self, w: int, level: int, s: float) -> int:
        """The node at or nearest to a place along a wall."""
        return min(self.at[w, level], key=lambda k: max(self.nodes[k].start - s, s - self.nodes[k].end, 0.0))

    def _spandrel(self, w: int, wall: PlanWall, level: int, k: int, i: int, j: int) -> None:
        plan = self.plan
        gap = (self.nodes[i].end, self.nodes[j].start)
        below, above = (
            [o for o in plan.openings_in(wall, storey) if o.x[0] < gap[1] - MEETS and o.x[1] > gap[0] + MEETS]
            for storey in (level, level + 1)
        )
        z = float(plan.levels[level])
        low = max((float(plan.levels[level - 1]) + o.z[1] for o in below), default=z)
        ring = self.ring_depth(wall, level)
        high = min((z + o.z[0] for o in above), default=z - ring)
        if high - low - (ring if above else 0.0) < MEETS or not (below or above):
            return
        held = [o for o in below if o.lintel is not None]
        if self.options.spandrels == "none" or (self.options.spandrels == "lintels" and below and not held):
            return
        edges = [(min(o.x[0] for o in group), max(o.x[1] for o in group)) for group in (below, above) if group]
        start, end = (float(np.mean([edge[side] for edge in edges])) for side in (0, 1))
        self.strips.append(
            Strip(
                "spandrel",
                f"{wall.name}, level {level}, spandrel {k + 1}",
                w,
                level,
                (*gap, low, high),
                (start, end, low, high),
                plan.thickness_of(wall, level),
                (i, j),
            )
        )

    def ring_depth(self, wall: PlanWall, level: int) -> float:
        """Height of the ring beam of a wall on a level; 0 without one [m]."""
        beam = self.plan.ring_beam_on(wall, level)
        return 0.0 if beam is None else beam.depth

    def _ring_beam(self, w: int, wall: PlanWall, level: int, k: int, i: int, j: int) -> None:
        depth = self.ring_depth(wall, level)
        start, end, z = self.nodes[i].end, self.nodes[j].start, float(self.plan.levels[level])
        if depth > 0.0 and end - start > MEETS:
            box = (start, end, z - depth, z)
            thickness = self.plan.thickness_of(wall, level)
            self.strips.append(Strip("ring beam", f"{wall.name}, level {level}, ring beam {k + 1}", w, level, box, box, thickness, (i, j)))


def _between(wall: PlanWall, openings: list[WallOpening]) -> list[tuple[float, float, Side, Side]]:
    """Piers between the openings of a storey from start to end: s from, to, and the openings beside them."""
    merged: list[list[float]] = []
    for opening in sorted(openings, key=lambda o: o.x[0]):
        if merged and opening.x[0] < merged[-1][1] + MEETS:
            last = merged[-1]
            merged[-1] = [last[0], max(last[1], opening.x[1]), min(last[2], opening.z[0]), max(last[3], opening.z[1])]
        else:
            merged.append([*opening.x, *opening.z])
    found, start, left = [], 0.0, Side()
    for a, b, sill, head in [*merged, [wall.length, wall.length, np.nan, np.nan]]:
        right = Side() if np.isnan(sill) else Side(sill, head)
        if a - start > MEETS:
            found.append((start, a, left, right))
        start, left = b, right
    return found


def parts_around_openings(own: list[WallOpening], tall: float) -> list[tuple[float, float, float, bool]]:
    """Masonry above and below the openings of a storey: s from, to, height, whether above."""
    breaks = sorted({x for o in own for x in o.x})
    found = []
    for a, b in itertools.pairwise(breaks):
        over = sorted((o.z[0], o.z[1]) for o in own if o.x[0] < b - MEETS and o.x[1] > a + MEETS)
        if not over:
            continue
        low, high = over[0][0], max(z[1] for z in over)
        found += [(a, b, height, upper) for height, upper in ((low, False), (tall - high, True)) if height > MEETS]
        between, top = 0.0, over[0][1]
        for sill, head in over[1:]:
            between += max(sill - top, 0.0)
            top = max(top, head)
        if between > MEETS:
            found.append((a, b, between, True))
    return found


def _groups(below: list[tuple[float, float]], above: list[tuple[float, float]]) -> list[list[tuple[int, int]]]:
    """Piers below (0, k) and above (1, k) a level that share a node: those that overlap."""
    members = [(0, k) for k in range(len(below))] + [(1, k) for k in range(len(above))]
    owner = {one: one for one in members}

    def root(one: tuple[int, int]) -> tuple[int, int]:
        while owner[one] != one:
            one = owner[one]
        return one

    for i, p in enumerate(below):
        for j, q in enumerate(above):
            common = min(p[1], q[1]) - max(p[0], q[0])
            if common > OVERLAP * min(p[1] - p[0], q[1] - q[0]):
                owner[root((1, j))] = root((0, i))
    groups: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for one in members:
        groups.setdefault(root(one), []).append(one)
    return list(groups.values())
