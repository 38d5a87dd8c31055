"""The equivalent frame of a building: its piers, spandrels and ring beams, nodes, masses, stiffness and weight."""

from dataclasses import dataclass, field

import numpy as np

from extrados.core.frame import Frame, Link, MacroElement
from extrados.model.structures.plan import Plan
from extrados.views.frame.flanges import Flange


@dataclass(frozen=True)
class Strip:
    """A pier, spandrel or ring beam: its wall, storey (of the others that below their level), its name, its whole masonry and its
    deformable part as s from, to and z from, to [m]."""

    kind: str
    name: str
    wall: int
    storey: int
    masonry: tuple[float, float, float, float]
    part: tuple[float, float, float, float]
    thickness: float
    nodes: tuple[int, int]


@dataclass
class Node:
    """A rigid node of a wall on a level, its extent along the wall, its freedoms (w, rotation)."""

    wall: int
    level: int
    start: float
    end: float
    freedoms: tuple[int, int] = (-1, -1)

    @property
    def s(self) -> float:
        """Its middle along the wall [m]."""
        return 0.5 * (self.start + self.end)


@dataclass(frozen=True)
class PointMass:
    """A mass [kg] at a place x, y, z [m] and the rows (2, n) by which freedoms displace it along x and y."""

    mass: float
    place: tuple[float, float, float]
    rows: np.ndarray
    level: int


@dataclass(frozen=True)
class Trace:
    """A place of a wall on a level, x and y [m], and the rows (2, n) by which freedoms displace it along x and y."""

    wall: int
    level: int
    place: tuple[float, float]
    rows: np.ndarray


@dataclass
class EquivalentFrame:
    """`strips` goes with `elements`. inertia (n): masses of the nodes that move up and down, and turn; `remarks` states what is
    neglected."""

    plan: Plan
    nodes: list[Node]
    strips: list[Strip]
    elements: list[MacroElement]
    links: list[Link]
    linear: np.ndarray
    weight: np.ndarray
    masses: list[PointMass]
    inertia: np.ndarray
    total_weight: float
    remarks: list[str] = field(default_factory=list)
    flanges: list[Flange] = field(default_factory=list)
    #: Wall and level: freedom of its displacement along the wall
    along: dict[tuple[int, int], int] = field(default_factory=dict)
    #: Remarks on strengths, which vibration does not use
    weaknesses: list[str] = field(default_factory=list)
    #: Ends and corners of every wall on every level above the ground, along the wall
    traces: list[Trace] = field(default_factory=list)

    @property
    def piers(self) -> int:
        """How many of the elements are piers."""
        return len(self.piers_at)

    @property
    def spandrels(self) -> int:
        """How many are spandrels."""
        return sum(s.kind == "spandrel" for s in self.strips)

    @property
    def piers_at(self) -> list[int]:
        """Their numbers among the elements."""
        return [k for k, e in enumerate(self.elements) if e.pier]

    @property
    def mass(self) -> np.ndarray:
        """Masses (n, n) [kg] that move horizontally, by the freedoms."""
        total = np.zeros_like(self.linear)
        for one in self.masses:
            total += one.mass * one.rows.T @ one.rows
        return total

    def unit(self, direction: np.ndarray) -> np.ndarray:
        """Displacements (n) of a unit motion along a direction on the plan."""
        found = np.zeros(len(self.weight))
        for (wall, _), freedom in self.along.items():
            found[freedom] = self.plan.walls[wall].direction @ direction
        return found

    def core(self) -> Frame:
        """The frame in the core."""
        return Frame(self.elements, self.links, self.linear, self.weight, self.mass + np.diag(self.inertia))

    def control(self, direction: np.ndarray, level: int) -> np.ndarray:
        """Row (n) that gives the displacement along a direction of the masses on a level, their mean."""
        own = [one for one in self.masses if one.level == level]
        return sum(one.mass * direction @ one.rows for one in own) / sum(one.mass for one in own)
