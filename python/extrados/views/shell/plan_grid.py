"""Walls of a plan as grids that share the nodes of their corners."""

import itertools
from collections.abc import Iterable

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, PlanWall, RingBeam

#: A warning is given if two mesh lines are closer than this fraction of the element size
SLIVER = 0.2


class WallGrid:
    """One wall as a grid: its lines, and which cells are there."""

    def __init__(self, wall: PlanWall, s: np.ndarray, z: np.ndarray):
        self.wall, self.s, self.z = wall, s, z
        self.there = np.ones((len(s) - 1, len(z) - 1), dtype=bool)
        self.first = 0  # number of its first node, before walls are joined

    def number(self, i: np.ndarray, k: np.ndarray) -> np.ndarray:
        return self.first + i * len(self.z) + k

    def cells(self, s: tuple[float, float], z: tuple[float, float]) -> np.ndarray:
        """Cells (columns, rows) whose middles lie within two ranges."""
        x, y = 0.5 * (self.s[1:] + self.s[:-1]), 0.5 * (self.z[1:] + self.z[:-1])
        return ((x > s[0]) & (x < s[1]))[:, None] & ((y > z[0]) & (y < z[1]))

    def points(self) -> np.ndarray:
        place = np.asarray(self.wall.start) + self.s[:, None] * self.wall.direction
        return np.column_stack([np.repeat(place, len(self.z), axis=0), np.tile(self.z, len(self.s))])


def _lines(breaks: Iterable[float], length: float, size: float, what: str, warnings: list[str]) -> np.ndarray:
    """Grid lines through all breaks within 0 and `length`, evenly in between."""
    kept = [0.0]
    for value in sorted(b for b in breaks if MEETS < b <= length + MEETS):
        if value - kept[-1] > MEETS:
            kept.append(min(value, length))
    kept[-1] = length
    thin = min((b - a for a, b in itertools.pairwise(kept)), default=length)
    if thin < SLIVER * size:
        warnings.append(
            f"{what}: two mesh lines are only {1000.0 * thin:.3g} mm apart, although elements of {size:.3g} m were "
            "requested: move the lines, or give a smaller size"
        )
    parts = [np.zeros(1)]
    for a, b in itertools.pairwise(kept):
        count = max(1, round((b - a) / size))
        parts.append(a + (b - a) * np.arange(1, count + 1) / count)
    return np.concatenate(parts)


def holes_of(plan: Plan, wall: PlanWall) -> list[tuple[float, float, float, float]]:
    """Openings of a wall: s from, to, z from, to [m]."""
    return [(*o.x, plan.levels[o.storey - 1] + o.z[0], plan.levels[o.storey - 1] + o.z[1]) for o in wall.openings]


def lintels_of(plan: Plan, wall: PlanWall) -> list[tuple[float, float, float, float, str | None]]:
    """Lintels of a wall: s from, to, z from, to [m], material."""
    found = []
    for opening, hole in zip(wall.openings, holes_of(plan, wall), strict=True):
        if opening.lintel is not None:
            beam = opening.lintel
            low, high = max(0.0, hole[0] - beam.bearing), min(wall.length, hole[1] + beam.bearing)
            found.append((low, high, hole[3], hole[3] + beam.depth, beam.material))
    return found


def ring_beams_of(plan: Plan, wall: PlanWall) -> list[tuple[RingBeam, float, float, float, float]]:
    """Ring beams of a wall: s from, to, z from, to [m]."""
    tops = [(beam, float(plan.levels[beam.storey])) for beam in plan.ring_beams if wall in plan.of_ring_beam(beam)]
    return [(beam, 0.0, wall.length, top - beam.depth, top) for beam, top in tops]


def _loaded(plan: Plan, wall: PlanWall) -> list[float]:
    """Ends of the forces on parts of a wall [m]."""
    return [s for part in plan.prestress if part.wall == wall.name and part.x is not None for s in part.x]


def make_grids(plan: Plan, junctions: dict, size: float, warnings: list[str]) -> list[WallGrid]:
    """The grid of each wall, with lines at corners, openings, storeys and loads [m]; warnings: of lines that are close to each other."""
    heights = {*plan.levels.tolist(), *(plan.bed_height(bed) for bed in plan.beds)}
    for wall in plan.walls:
        beams = (*(lintel[:4] for lintel in lintels_of(plan, wall)), *(beam[1:] for beam in ring_beams_of(plan, wall)))
        for box in (*holes_of(plan, wall), *beams):
            heights.update(box[2:4])
    z = _lines(heights, float(plan.levels[-1]), size, "the heights of openings and of storeys", warnings)
    grids: list[WallGrid] = []
    for w, wall in enumerate(plan.walls):
        breaks = {0.0, wall.length, *_loaded(plan, wall)}
        for beam in (*holes_of(plan, wall), *(lintel[:4] for lintel in lintels_of(plan, wall))):
            breaks.update(beam[:2])
        for (a, b), (s, t) in junctions.items():
            breaks.update([s] if a == w else [t] if b == w else [])
        grid = WallGrid(wall, _lines(breaks, wall.length, size, f"wall '{wall.name}'", warnings), z)
        first, last = plan.reach(wall)
        grid.there &= grid.cells((-np.inf, np.inf), (plan.levels[first - 1], plan.levels[last]))
        for hole in holes_of(plan, wall):
            grid.there &= ~grid.cells(hole[:2], hole[2:])
        grid.first = grids[-1].first + len(grids[-1].s) * len(z) if grids else 0
        grids.append(grid)
    return grids


def join_grids(plan: Plan, grids: list[WallGrid], junctions: dict) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of all walls, those of walls that hang together once; the number of each node of the grids."""
    xyz = np.concatenate([grid.points() for grid in grids])
    owner = np.arange(len(xyz))

    def root(n: int) -> int:
        while owner[n] != n:
            owner[n] = owner[owner[n]]
            n = int(owner[n])
        return n

    for (a, b), (s, t) in junctions.items():
        corner = plan.bond(plan.walls[a].name, plan.walls[b].name)
        if corner is not None and corner.bond in ("open", "joint"):
            continue
        one, two = grids[a], grids[b]
        i, j = int(np.abs(one.s - s).argmin()), int(np.abs(two.s - t).argmin())
        for k in range(len(one.z)):
            p, q = root(int(one.number(i, k))), root(int(two.number(j, k)))
            owner[max(p, q)] = min(p, q)
    found = np.array([root(n) for n in range(len(xyz))])
    alone, number = np.unique(found, return_inverse=True)
    return xyz[alone], number


def thickness_at(plan: Plan, wall: PlanWall, height: np.ndarray) -> np.ndarray:
    """Thickness of a wall at some heights [m]."""
    first, last = plan.reach(wall)
    thick = wall.thicknesses or [wall.thickness] * (last - first + 1)
    return np.asarray(thick, dtype=float)[np.searchsorted(plan.levels, height) - 1 - (first - 1)]


def index_of(name: str, names: list[str], what: str) -> int:
    """Number of a material from 0; BadGeometry if the deck does not give it."""
    if name not in names:
        raise BadGeometry(f"{what}: the deck has no [materials.{name}]")
    return 1 + names.index(name)


def level_nodes(plan: Plan, storey: int, grid: WallGrid, number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nodes of a wall on top of a storey that are there, and their distances along it."""
    k = int(np.abs(grid.z - plan.levels[storey]).argmin())
    there = np.zeros(len(grid.s), dtype=bool)
    for row in (k - 1, k):
        if 0 <= row < grid.there.shape[1]:
            there[:-1] |= grid.there[:, row]
            there[1:] |= grid.there[:, row]
    i = np.flatnonzero(there)
    return number[grid.number(i, np.full(len(i), k))], grid.s[i]
