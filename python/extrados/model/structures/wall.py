"""Walls in running bond with openings, around corners: legs of masonry whose courses pass through the corners in turn."""

import itertools
from collections.abc import Callable
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.boxes import Box, openings_within
from extrados.model.geometry.solids.assembly import MOST_SOLIDS, SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import Polyhedron, box
from extrados.model.places import Opening
from extrados.model.structures.brickwork import Bond, Bonded, laid, levels_of, lintels_of
from extrados.model.structures.spatial import Spatial
from extrados.schema.quantities import Length
from extrados.schema.table import Table, key

LEFT = np.array([[0.0, -1.0], [1.0, 0.0]])


class Leg(Table):
    """A straight stretch of wall, from corner to corner or to a free end."""

    length: Length = key(about="total length of the leg, including the corners at its ends", gt=0, le=1e4)
    turn: Literal["left", "right"] = key(
        "left", "side of the previous leg on which this leg begins, at a right angle; no effect on the first leg"
    )
    openings: list[Opening] = key([], "rectangular openings: x along the leg from its start, y upward", max_length=200)


def make_wall(
    bond: Bond, thickness: float, height: float, legs: list[tuple[float, bool, list[Box]]], closed: bool = False, density: float = 2000.0
) -> SolidAssembly:
    """Legs (length [m], whether it turns left, openings) of a wall of a thickness and height [m], one unit thick.

    The first leg runs from the origin along x with its thickness to the left. At a corner the courses of both legs pass
    through in turn, so that its quoins bond them. closed: the last leg meets the first by a left turn. BadGeometry where an
    opening or a lintel runs into a corner, or the legs of a closed wall do not meet.
    """
    ways, starts = _plan(legs, thickness)
    if closed:
        _close(ways, starts, legs)
    small = min(bond.length, bond.height, thickness)
    openings, lintels = [], []
    for i, (length, _, holes) in enumerate(legs):
        here = openings_within(length, height, holes, small)
        beams = list(lintels_of(bond, length, height, here).values()) if bond.lintels else []
        before, after = i > 0 or closed, i < len(legs) - 1 or closed
        low, high = thickness * before, length - thickness * after
        for what, boxes in (("an opening", here), ("a lintel", beams)):
            for x0, x1, *_ in boxes:
                if (before and x0 < low - 1e-9) or (after and x1 > high + 1e-9):
                    raise BadGeometry(
                        f"wall: {what} of leg {i + 1}, x {x0:.4g} to {x1:.4g} m, overlaps a corner; expected {low:.4g} to {high:.4g} m"
                    )
        openings.append(here)
        lintels.append(beams)
    taken = [[*one, *two] for one, two in zip(openings, lintels, strict=True)]
    levels = levels_of(bond, height, [b for boxes in taken for b in boxes])
    least = bond.least_unit * bond.length
    stones: list[Stone] = []
    for i, (length, _, _) in enumerate(legs):
        place = _placed(starts[i], ways[i], thickness)
        before, after = i > 0 or closed, i < len(legs) - 1 or closed
        for course, (low, high) in enumerate(itertools.pairwise(levels)):
            own_end = (course + i) % 2 == 0  # the corner after this leg is its own in this course
            own_start = (course + (i - 1 if i else len(legs) - 1)) % 2 == 1
            first = thickness if before and not own_start else 0.0
            last = length - thickness if after and not own_end else length
            whole = (course % 2 == 0) == (bond.begins == "whole")
            shift = first if before or after else (0.0 if whole else 0.5 * bond.length)
            heads = _heads(bond.length, shift, last, before, after, least)
            for number, unit in enumerate(laid(heads, (first, last), low, high, taken[i], least), start=1):
                stones.append(Stone(f"unit {number} of course {course + 1}, leg {i + 1}", [place(unit)], density))
        for number, beam in enumerate(lintels[i], start=1):
            stones.append(Stone(f"lintel {number} of leg {i + 1}", [place(beam)], density))
    return assemble(stones, ground=[0.0], what="wall")


def _heads(unit: float, first: float, last: float, before: bool, after: bool, least: float) -> np.ndarray:
    """Head joints of a course from `first` to `last` [m]: whole units from its corners on, what is left over at its free end,
    or in its middle where it has corners at both."""
    count = int((last - first) / unit) + 1
    rising, falling = first + unit * np.arange(1, count + 1), last - unit * np.arange(count, 0, -1)
    if not (before and after):
        return falling if after else rising
    middle = 0.5 * (first + last)
    rising, falling = rising[rising < middle], falling[falling >= middle]
    if len(rising) and len(falling) and falling[0] - rising[-1] < least:
        rising = rising[:-1]
    return np.concatenate([rising, falling])


def _plan(legs: list[tuple[float, bool, list[Box]]], thickness: float) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Direction and start of each leg; its thickness lies to the left of the line from there."""
    way, start = np.array([1.0, 0.0]), np.zeros(2)
    ways, starts = [way], [start]
    for (length, _, _), (_, left, _) in itertools.pairwise(legs):
        if left:
            start, way = start + length * way, LEFT @ way
        else:
            start, way = start + (length - thickness) * way + thickness * (LEFT @ way), -LEFT @ way
        ways.append(way)
        starts.append(start)
    return ways, starts


def _close(ways: list[np.ndarray], starts: list[np.ndarray], legs: list[tuple[float, bool, list[Box]]]) -> None:
    end = starts[-1] + legs[-1][0] * ways[-1]
    if len(legs) % 2 or np.abs(LEFT @ ways[-1] - ways[0]).max() > 1e-9 or np.abs(end - starts[0]).max() > 1e-6:
        raise BadGeometry(
            f"wall: the legs are not closed: the last leg ends at x = {end[0]:.4g}, y = {end[1]:.4g} m; expected 0, 0 and a "
            "left-hand corner at the first leg"
        )


def _placed(start: np.ndarray, way: np.ndarray, thickness: float) -> Callable[[Box], Polyhedron]:
    """What makes a solid of a box along a leg."""

    def place(unit: Box) -> Polyhedron:
        x0, x1, low, high = unit
        ends = np.array([start + x0 * way, start + x1 * way + thickness * (LEFT @ way)])
        return box((*ends.min(axis=0), low), (*ends.max(axis=0), high))

    return place


class Wall(Bonded, Spatial):
    """Walls in running bond, one unit thick, with openings and lintels. The courses alternate at corners."""

    word: ClassVar = "wall"
    kind: Literal["wall"]
    halved: ClassVar = {"unit_length": 0.5, "unit_height": 0.5}
    bonds: ClassVar = {"begins": ("whole", "half")}
    starter: ClassVar = {
        "unit_length": '"40 cm"',
        "unit_height": '"20 cm"',
        "thickness": '"20 cm"',
        "height": "2.4",
        "legs": "[{ length = 3.0 }, { length = 2.0 }]",
    }
    unit_length: Length = key(about="length of a unit; twice the thickness gives half bond around corners", gt=0)
    unit_height: Length = key(about="height of a unit", gt=0)
    thickness: Length = key(about="thickness of the wall, equal to the width of a unit", gt=0)
    height: Length = key(about="height of the wall", gt=0, le=1e3)
    legs: list[Leg] = key(
        about="straight parts (legs) of the wall in order, each at a right angle to the previous one", min_length=1, max_length=200
    )
    closed: bool = key(False, "whether the last leg ends at the start of the first one, with a left-hand corner, as around a courtyard")
    begins: Literal["whole", "half"] = key("whole", "first unit of the lowest course at a free end of the wall: whole or half")

    @model_validator(mode="after")
    def _sensible(self) -> "Wall":
        count = sum(leg.length for leg in self.legs) * self.height / (self.unit_length * self.unit_height)
        if count > MOST_SOLIDS:
            raise ValueError(f"the wall would have {count:.0f} units; at most {MOST_SOLIDS} are allowed")
        for i, leg in enumerate(self.legs, start=1):
            if len(self.legs) > 1 and leg.length < 2.0 * self.thickness:
                raise ValueError(f"legs: leg {i} has a length of {leg.length:g} m, less than two thicknesses of {self.thickness:g} m")
            for o in leg.openings:
                if o.is_outside(leg.length, self.height):
                    raise ValueError(f"legs: the opening x {o.x}, y {o.y} is outside leg {i}")
        if self.closed and len(self.legs) < 4:
            raise ValueError(f"the key `closed` requires at least four legs, found {len(self.legs)}")
        return self

    def solids(self, density: float) -> SolidAssembly:
        legs = [(leg.length, leg.turn == "left", [o.box for o in leg.openings]) for leg in self.legs]
        return make_wall(self.bond(self.unit_length, self.unit_height), self.thickness, self.height, legs, self.closed, density)
