"""Walls of units in running bond: the maker, the keys by which a wall is laid, and the kind `brickwork`."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.boxes import SAME, Box, contacts, openings_within, outline
from extrados.model.places import Opening
from extrados.model.structure import RocksAs, Structure
from extrados.model.structures.masonry import stones_and_joints
from extrados.model.structures.piers import make_piers
from extrados.schema.quantities import Length
from extrados.schema.table import Table, key

MOST_UNITS = 20000


@dataclass(frozen=True)
class Bond:
    """How a wall is laid: sizes of a unit [m], which course has whole units, lintels, and the least cut unit.

    lintel_height and lintel_bearing [m]: a course and half a unit where None. least_unit: share of a unit's length or
    height below which a cut piece joins its neighbour.
    """

    length: float
    height: float
    begins: str = "whole"
    lintels: bool = True
    lintel_height: float | None = None
    lintel_bearing: float | None = None
    least_unit: float = 0.25


@dataclass
class _Units:
    """Stones as boxes with their names, course by course; a lintel has no course."""

    boxes: list[Box] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    place: list[tuple[int, int]] = field(default_factory=list)  # course, number in it

    def add(self, box: Box, name: str, course: int, number: int) -> None:
        self.boxes.append(box)
        self.names.append(name)
        self.place.append((course, number))


def make_brickwork(
    bond: Bond, length: float, height: float, openings: Sequence[Box] = (), density: float = 1800.0, depth: float = 0.25
) -> Assembly:
    """A wall of length x height [m] on the ground, its lower left corner at the origin, with openings cut out.

    Every other course begins with half a unit. Bed and head joints nearer to an edge of an opening than the least cut
    unit move to that edge or are left out; all other edges cut the units. BadGeometry where nothing is left, the units
    are too many or a lintel has no place.
    """
    if length * height > MOST_UNITS * bond.length * bond.height * (1.0 + 1e-9):
        raise BadGeometry(f"the wall would have {length * height / bond.length / bond.height:.0f} units; at most {MOST_UNITS} are allowed")
    small = min(bond.length, bond.height)
    holes = openings_within(length, height, openings, small)
    beams = lintels_of(bond, length, height, holes) if bond.lintels else {}
    taken = [*holes, *beams.values()]
    wall = _Units()
    levels = levels_of(bond, height, taken)
    for course, (low, high) in enumerate(itertools.pairwise(levels)):
        for number, box in enumerate(_course(bond, length, course, low, high, taken), start=1):
            wall.add(box, f"unit {number} of course {course + 1}", course, number)
    for i, box in beams.items():
        wall.add(box, f"lintel {i + 1}", -1, i + 1)
    if not wall.boxes:
        raise BadGeometry("the openings occupy the whole wall")
    joints = _joints(wall, small)
    if all(b != GROUND for *_, b in joints):
        raise BadGeometry(
            "at ground level the openings occupy the full width, so no masonry remains there. Make the openings narrower, or raise them"
        )
    made = stones_and_joints([outline(box) for box in wall.boxes], wall.names, joints, density, depth)
    heads = [j for j, (name, *_) in enumerate(joints) if name.startswith("head ")]
    beds = sorted({*range(len(joints))} - {*heads})
    made.groups.update({name: found for name, found in (("beds", beds), ("heads", heads)) if found})
    return made


def lintels_of(bond: Bond, length: float, height: float, holes: list[Box]) -> dict[int, Box]:
    """The lintel over each opening that has masonry above it, by the number of the opening.

    It bears on the wall at both sides, on half a pier where the next opening has a lintel at its level, and ends at
    the jamb of an opening beside it.
    """
    tall = bond.height if bond.lintel_height is None else bond.lintel_height
    bearing = 0.5 * bond.length if bond.lintel_bearing is None else bond.lintel_bearing
    small = SAME * min(bond.length, bond.height)
    found: dict[int, Box] = {}
    for i, (left, right, _, head) in enumerate(holes):
        if head >= height:
            continue
        over = [o for k, o in enumerate(holes) if k != i and o[0] < right and o[1] > left]
        if any(o[2] <= head < o[3] for o in over):
            raise BadGeometry(f"opening {i + 1} overlaps another opening, so there is no place for a lintel: give lintels = false")
        top = min([head + tall, height, *(o[2] for o in over if o[2] > head)])
        low, high = max(0.0, left - bearing), min(length, right + bearing)
        for k, (a, b, c, d) in enumerate(holes):
            its_lintel = d < top and head < d + tall and d < height
            if k == i or not (its_lintel or (c < top and head < d)):
                continue
            if a >= right:
                high = min(high, 0.5 * (right + a) if its_lintel else a)
            if b <= left:
                low = max(low, 0.5 * (left + b) if its_lintel else b)
        # A hair beyond the wall or the top of a course would leave a sliver.
        top = height if height - top < small else top
        found[i] = (low, high, head, top)
    return found


def levels_of(bond: Bond, height: float, holes: list[Box]) -> list[float]:
    """Levels of the bed joints, ground and top included [m]."""
    least = bond.least_unit * bond.height
    full = int(np.floor(height / bond.height + SAME))
    levels = [k * bond.height for k in range(full + 1)]
    if full and height - levels[-1] < least:
        levels[-1] = height
    else:
        levels.append(height)
    moved: set[int] = set()
    for edge in sorted({e for h in holes for e in h[2:] if 0.0 < e < height}):
        k = int(np.abs(np.array(levels) - edge).argmin())
        if 0 < k < len(levels) - 1 and k not in moved and abs(levels[k] - edge) < max(least, SAME * bond.height):
            levels[k] = edge
            moved.add(k)
    return levels


def _course(bond: Bond, length: float, course: int, low: float, high: float, holes: list[Box]) -> list[Box]:
    """Units of a course from left to right; those over and under an opening are as high as it leaves them."""
    whole = (course % 2 == 0) == (bond.begins == "whole")
    heads = (np.arange(int(length / bond.length) + 2) + (0.0 if whole else 0.5)) * bond.length
    return laid(heads, (0.0, length), low, high, holes, bond.least_unit * bond.length)


def laid(heads: np.ndarray, ends: tuple[float, float], low: float, high: float, holes: Sequence[Box], least: float) -> list[Box]:
    """Units of a course between its ends, divided at the head joints and cut by openings, from left to right.

    Head joints nearer than `least` [m] to an end or an opening are left out.
    """
    here = [h for h in holes if h[2] < high and h[3] > low]
    inside = (x for h in here for x in h[:2] if ends[0] < x < ends[1])
    cuts = sorted({*ends, *inside})
    least *= 1.0 - SAME
    found: list[Box] = []
    for left, right in itertools.pairwise(cuts):
        free, start = [], low
        for _, _, y0, y1 in sorted((h for h in here if h[0] <= left and h[1] >= right), key=lambda h: h[2]):
            if y0 > start:
                free.append((start, y0))
            start = max(start, y1)
        if start < high:
            free.append((start, high))
        inner = heads[(heads > left + least) & (heads < right - least)].tolist()
        found += [(a, b, c, d) for a, b in itertools.pairwise([left, *inner, right]) for c, d in free]
    return found


def _joints(wall: _Units, size: float) -> list[tuple[str, np.ndarray, np.ndarray, int, int]]:
    """Joints of each stone with those to its left and below it, and with the ground."""
    joints = []
    for i, k, p, q in contacts(wall.boxes, size):
        (course, number), name = wall.place[i], wall.names[i]
        if k == GROUND:
            label = f"base of unit {number}" if course >= 0 else f"base of {name}"
        elif p[1] == q[1]:
            label = f"bed joint of {name} on {wall.names[k]}"
        elif course >= 0 and wall.place[k] == (course, number - 1):
            label = f"head joint {number - 1} of course {course + 1}"
        else:
            label = f"head joint of {name} and {wall.names[k]}"
        joints.append((label, p, q, i, k))
    return joints


class Bonded(Table):
    """Keys of walls in running bond, in a plane or around corners."""

    begins: Literal["whole", "half"] = key("whole", "first unit of the lowest course (whole or half); the courses above alternate")
    lintels: bool = key(
        True, "true: a single block is the lintel over each opening; false: the units above rest on the units beside the opening"
    )
    lintel_height: Length | None = key(None, "height of the lintels; default: one course", gt=0)
    lintel_bearing: Length | None = key(None, "bearing length of a lintel at each side; default: half a unit", gt=0)
    least_unit: float = key(
        0.25, "a cut piece that is smaller than this share of the length or height of a unit is joined to its neighbour", ge=0, le=0.5
    )

    def bond(self, unit_length: float, unit_height: float) -> Bond:
        """How this wall is laid, of a unit [m]."""
        return Bond(unit_length, unit_height, self.begins, self.lintels, self.lintel_height, self.lintel_bearing, self.least_unit)


class Laid(Bonded):
    """Keys of plane walls that are laid in running bond."""

    openings: list[Opening] = key([], "rectangular openings", max_length=1000)

    @property
    def holes(self) -> list[Box]:
        """The openings [m]."""
        return [o.box for o in self.openings]

    def check_openings(self, length: float, height: float) -> None:
        """ValueError names an opening that lies beside the wall [m]."""
        for o in self.openings:
            if o.is_outside(length, height):
                raise ValueError(f"the opening x {o.x}, y {o.y} is outside the wall")


class Brickwork(Laid, Structure):
    """Wall of equal units in running bond on the ground, loaded in its plane. Half units end every other course."""

    word: ClassVar = "wall"
    kind: Literal["brickwork"]
    rocks_as: ClassVar[RocksAs] = "piers"
    starter: ClassVar = {"unit_length": '"40 cm"', "unit_height": '"20 cm"', "units": "5", "courses": "8"}
    unit_length: Length = key(about="length of a unit", gt=0)
    unit_height: Length = key(about="height of a unit", gt=0)
    units: int = key(about="number of units in a course", ge=1, le=500)
    courses: int = key(about="number of courses", ge=1, le=500)
    depth: Length = key(0.25, "thickness of the wall", gt=0)

    @model_validator(mode="after")
    def _sensible(self) -> "Brickwork":
        if self.units * self.courses > MOST_UNITS:
            raise ValueError(f"the wall would have {self.units * self.courses} units; at most {MOST_UNITS} are allowed")
        self.check_openings(*self.size)
        return self

    @property
    def size(self) -> tuple[float, float]:
        """Length and height of the wall [m]."""
        return self.units * self.unit_length, self.courses * self.unit_height

    def assembly(self, density: float, folder: Path) -> Assembly:
        bond = self.bond(self.unit_length, self.unit_height)
        return make_brickwork(bond, *self.size, self.holes, density, self.depth)

    def pier_assembly(self, density: float) -> Assembly:
        return make_piers(*self.size, self.holes, density, self.depth)
