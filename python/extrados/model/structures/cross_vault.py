"""Groin vaults: two barrels that cross over a bay."""

from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.geometry.solids.assembly import MOST_SOLIDS, SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import Polyhedron, cut
from extrados.model.geometry.solids.sections import body
from extrados.model.structures.spatial import Spatial
from extrados.schema.quantities import Angle, Length
from extrados.schema.table import key

LEAST_PIECE = 0.3  # of a stone's length: where the bed of a piece is shorter, it joins its neighbour
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
SWAP = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
CORNERS = ("north-east", "north-west", "south-west", "south-east")
WEBS = ("north", "west", "south", "east")


def make_cross_vault(
    radius: float,
    thickness: float,
    embrace: float,
    voussoirs: int,
    edge: float,
    stone_length: float | None = None,
    springers: int = 1,
    across: float = 1.0,
    density: float = 2000.0,
) -> SolidAssembly:
    """Two equal barrels over a bay: radius of the centre line, thickness, edge [m], embrace [deg].

    Four webs meet along the diagonals and reach `edge` beyond the corner of the extrados at the springing. A half web has
    voussoirs / 2 courses, divided in stones of `stone_length` along the barrel, set off by half in every other course; those
    of both webs at the groin are one voussoir with an arm in either, while whole courses are mitred there. The lowest
    `springers` courses of both webs of a corner are one stone. across: length over width of the bay, by which the whole is
    stretched in y; the barrel across the width is then an ellipse of the same rise.
    """
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    half = np.radians(0.5 * embrace)
    angle = np.linspace(half, 0.0, voussoirs // 2 + 1)  # from the springing at +x to the crown
    reach = outer * np.sin(half) + edge
    courses = [_course(inner, outer, angle[i], angle[i + 1], reach, stone_length, bool(i % 2)) for i in range(voussoirs // 2)]
    down = np.array([np.cos(half), 0.0, -np.sin(half)])  # out of the lowest bed
    stretch = np.diag([1.0, across, 1.0])
    stones: list[Stone] = []
    feet: dict[int, np.ndarray] = {}  # of parts that stand on the ground, by their identity
    for k in range(4):
        turn = stretch @ np.linalg.matrix_power(QUARTER, k)
        ways = ((turn, f"right of the {WEBS[k]} web"), (turn @ SWAP, f"left of the {WEBS[k - 1]} web"))
        springer: list[Polyhedron] = []
        for i, course in enumerate(courses):
            webs = {where: [piece.moved(way) for piece in course] for way, where in ways}
            if i == 0:
                for piece, *placed in zip(course, *webs.values(), strict=True):
                    foot = int((piece.normals @ down).argmax())
                    feet |= {id(part): part.vertices[list(part.faces[foot])][::-1] for part in placed}
            if i < springers:
                springer += [part for web in webs.values() for part in web]
                continue
            if stone_length is not None:
                groin = [web.pop() for web in webs.values()]
                stones.append(Stone(f"groin voussoir of course {i + 1}, {CORNERS[k]}", groin, density))
            stones += [
                Stone(f"stone {n} of course {i + 1}, {where}", [part], density)
                for where, web in webs.items()
                for n, part in enumerate(web, start=1)
            ]
        if springers:
            stones.append(Stone(f"springer {CORNERS[k]}", springer, density))
    seats = [(n, feet[id(part)]) for n, stone in enumerate(stones) for part in stone.parts if id(part) in feet]
    return assemble(stones, seats=seats, what="cross-vault")


def _course(inner: float, outer: float, low: float, high: float, reach: float, length: float | None, half: bool) -> list[Polyhedron]:
    """The stones of a course of the half web x > 0, y > x, between two angles from the vertical, from its edge to the groin;
    `half`: it begins with half a stone. The groin leans inwards as it rises: the last stone reaches beyond its bed."""
    section = [[r * np.sin(a), r * np.cos(a)] for r, a in ((inner, low), (outer, low), (outer, high), (inner, high))]
    rest = cut(body(np.array(section), 0.0, reach), np.zeros(3), np.array([-1.0, 1.0, 0.0]))
    assert rest is not None  # the edge lies beyond the groin
    found: list[Polyhedron] = []
    across = np.array([0.0, 1.0, 0.0])
    place = reach - (length or reach) * (0.5 if half else 1.0)
    bed = outer * np.sin(low)  # where that of the last stone begins
    while length is not None and place > bed + LEAST_PIECE * length:
        stone, beyond = cut(rest, place * across, across), cut(rest, place * across, -across)
        if stone is None or beyond is None:
            break
        found.append(stone)
        rest, place = beyond, place - length
    return [*found, rest]


class CrossVault(Spatial):
    """Groin vault over a square or oblong bay: two barrels that cross. Groin voussoirs belong to both barrels."""

    word: ClassVar = "cross-vault"
    kind: Literal["cross-vault"]
    halved: ClassVar = {"voussoirs": 2, "stone_length": 0.5}
    starter: ClassVar = {"radius": "3.0", "thickness": "0.4", "embrace": "140", "voussoirs": "16"}
    radius: Length = key(about="radius of the centre line of the barrels", gt=0, le=1e4)
    thickness: Length = key(about="thickness of the webs", gt=0, le=1e4)
    embrace: Angle = key(about="angle of embrace of the barrels, from springing to springing", ge=20, le=180)
    voussoirs: int = key(about="number of courses of a barrel from springing to springing; an even number", ge=4, le=400)
    edge: Length | None = key(
        None,
        "horizontal distance by which the webs extend over the support, beyond the point of the extrados "
        "at the springing; default: the thickness",
        ge=0,
    )
    stone_length: Length | None = key(
        None, "length of a block along the barrel; default: each course is one block, mitred along the groins", gt=0
    )
    springers: int = key(
        1,
        "number of courses above the springing that form a single block in each corner; with 0, each web has its own support",
        ge=0,
        le=100,
    )
    oblong: float = key(
        1.0, "length of the bay, divided by its width; if it is not 1, the barrel across the bay is an ellipse", gt=0.2, lt=5
    )
    thickness_factor: float = key(1.0, "effective thickness, divided by the real thickness; 0.8 for worn corners", gt=0, le=1)

    @model_validator(mode="after")
    def _plausible(self) -> "CrossVault":
        if self.thickness >= self.radius:
            raise ValueError(f"thickness {self.thickness:g} m is not below the radius {self.radius:g} m")
        if self.voussoirs % 2:
            raise ValueError(f"voussoirs: {self.voussoirs} is odd; expected an even number, so that the groins meet at a joint")
        if self.springers >= self.voussoirs // 2:
            raise ValueError(f"springers: {self.springers} courses reach the crown; expected fewer than {self.voussoirs // 2}")
        if self.stone_length is not None:
            count = 8 * self.voussoirs // 2 * 2.0 * self.radius / self.stone_length
            if count > MOST_SOLIDS:
                raise ValueError(f"stone_length: the vault would have about {count:.0f} blocks; at most {MOST_SOLIDS} are allowed")
        return self

    def solids(self, density: float) -> SolidAssembly:
        edge = self.thickness if self.edge is None else self.edge
        return make_cross_vault(
            self.radius,
            self.thickness * self.thickness_factor,
            self.embrace,
            self.voussoirs,
            edge,
            self.stone_length,
            self.springers,
            self.oblong,
            density,
        )
