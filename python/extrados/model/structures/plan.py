"""A building of walls on a plan: storeys, openings, flanges, floors, rods (`building`)."""

from itertools import pairwise
from math import radians, tan
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import distance, inside, signed_area
from extrados.model.structure import Structure
from extrados.model.structures.plan_parts import (
    MEETS,
    PARALLEL,
    Bed,
    Corner,
    PlanWall,
    Prestress,
    Prop,
    RingBeam,
    Rod,
    StoreyFloor,
    WallOpening,
    meeting,
)
from extrados.schema.quantities import Length, Stiffness
from extrados.schema.table import key

#: Greatest ratio of neutral axis to effective depth of a reinforced ring beam, EN 1992-1-1, 5.5(4) (verify clause)
DEEPEST_AXIS = 0.45
#: Ratio by which the ridge of a roof and that of a gable can differ without a remark
RIDGES = 0.05


class Plan(Structure):
    """Building of plane walls and floors in several storeys, given by its plan; z is upward, the ground is at z = 0."""

    word: ClassVar = "building"
    kind: Literal["building"]
    starter_analysis: ClassVar = "pushover"
    starter: ClassVar = {
        "storeys": '["3.0 m", "2.8 m"]',
        "walls": """[
    { name = "front", start = [0, 0], end = [6, 0], thickness = 0.3, openings = [{ storey = 1, x = [1, 2], z = [0, 2.1] }, { storey = 2, x = [1, 2], z = [0.9, 2.1] }] },
    { name = "right", start = [6, 0], end = [6, 5], thickness = 0.3 },
    { name = "back", start = [6, 5], end = [0, 5], thickness = 0.3 },
    { name = "left", start = [0, 5], end = [0, 0], thickness = 0.3 },
]""",
        "floors": '[{ storey = 1, young = "50 MPa", thickness = "5 cm", load = "2 kPa" }, { storey = 2, young = "50 MPa", thickness = "5 cm", load = "1 kPa" }]',
    }
    storeys: list[Length] = key(about="height of each storey, from the ground up", min_length=1, max_length=50)
    walls: list[PlanWall] = key(about="walls of the building, [[structure.walls]]", min_length=1, max_length=200)
    corners: list[Corner] = key([], "corners where walls meet without being bonded, [[structure.corners]]", max_length=1000)
    beds: list[Bed] = key([], "bed joints that can slide, [[structure.beds]]", max_length=100)
    floors: list[StoreyFloor] = key([], "floors and roofs, [[structure.floors]]", max_length=200)
    rods: list[Rod] = key([], "tie rods, [[structure.rods]]", max_length=200)
    props: list[Prop] = key([], "props at the tops of walls, [[structure.props]]", max_length=200)
    prestress: list[Prestress] = key([], "vertical forces on walls, [[structure.prestress]]", max_length=200)
    ring_beams: list[RingBeam] = key([], "ring beams, [[structure.ring_beams]]", max_length=50)
    assumed: list[str] = key([], "assumptions of the deck that its sources do not state; each result repeats them", max_length=100)
    foundation_stiffness: Stiffness | None = key(
        None, "vertical stiffness of the ground per area of the soles of the walls; default: rigid", gt=0
    )

    @model_validator(mode="after")
    def _sound(self) -> "Plan":
        if not all(h > 0.0 for h in self.storeys):
            raise ValueError("storeys: every height must be above 0")
        names = [wall.name for wall in self.walls]
        for w, wall in enumerate(self.walls):
            if wall.name in names[:w]:
                raise ValueError(f"walls[{w}].name: the name '{wall.name}' occurs twice")
            self._check_wall(w, wall)
        for what, named in (
            *((f"corners[{k}].walls", corner.walls) for k, corner in enumerate(self.corners)),
            *((f"beds[{k}].walls", bed.walls) for k, bed in enumerate(self.beds)),
            *((f"floors[{k}].walls", floor.walls or []) for k, floor in enumerate(self.floors)),
            *((f"floors[{k}].bears_on", floor.bears_on) for k, floor in enumerate(self.floors)),
            *((f"prestress[{k}].wall", [part.wall]) for k, part in enumerate(self.prestress)),
            *((f"ring_beams[{k}].walls", beam.walls) for k, beam in enumerate(self.ring_beams)),
            *((f"props[{k}].wall", [part.wall]) for k, part in enumerate(self.props)),
        ):
            if strange := [name for name in named if name not in names]:
                raise ValueError(f"{what}: wall '{strange[0]}' does not exist; the walls are {', '.join(names)}")
        heights: dict[float, int] = {}
        for k, bed in enumerate(self.beds):
            if bed.storey > len(self.storeys):
                raise ValueError(f"beds[{k}].storey: storey {bed.storey} does not exist; the number of storeys is {len(self.storeys)}")
            if bed.z >= self.storeys[bed.storey - 1]:
                raise ValueError(
                    f"beds[{k}].z: {bed.z:g} m is not below the top of a storey of {self.storeys[bed.storey - 1]:g} m. A bed joint at "
                    "the top has z = 0 in the next storey"
                )
            if (first := heights.setdefault(round(self.bed_height(bed), 9), k)) != k:
                raise ValueError(f"beds[{k}]: bed {first + 1} has the same height: name all walls of the joint in one of the two tables")
        names_of_joints = self.joint_names
        for k, name in enumerate(names_of_joints):
            if name in names_of_joints[:k]:
                raise ValueError(f"beds: the name '{name}' of a joint occurs twice")
        told: dict[frozenset[str], int] = {}
        for k, corner in enumerate(self.corners):
            if (first := told.setdefault(frozenset(corner.walls), k)) != k:
                raise ValueError(f"corners[{k}].walls: corner {first + 1} has the same two walls")
        for k, prop in enumerate(self.props):
            if np.abs(self.wall(prop.wall).direction).max() < 1.0 - 1e-9:
                raise ValueError(f"props[{k}].wall: wall '{prop.wall}' is oblique in plan, but only a wall along x or y can have a prop")
            self._check_storey(f"props[{k}].storey", prop.wall, prop.storey)
        for k, part in enumerate(self.prestress):
            if part.level is not None:
                self._check_storey(f"prestress[{k}].level", part.wall, part.level)
            length = self.wall(part.wall).length
            if part.x is not None and not 0.0 <= part.x[0] < part.x[1] <= length + MEETS:
                raise ValueError(
                    f"prestress[{k}].x: {part.x[0]:g} to {part.x[1]:g} m is not on wall '{part.wall}', whose length is {length:g} m"
                )
        held: dict[tuple[str, int], int] = {}
        for k, beam in enumerate(self.ring_beams):
            self._check_ring_beam(k, beam, held)
        for k, floor in enumerate(self.floors):
            self._check_floor(k, floor)
        return self

    def _check_storey(self, what: str, wall: str, storey: int) -> None:
        first, last = self.reach(self.wall(wall))
        if not first <= storey <= last:
            raise ValueError(f"{what}: wall '{wall}' has no storey {storey}; its storeys are {first} to {last}")

    def _check_floor(self, k: int, floor: StoreyFloor) -> None:
        if floor.storey > len(self.storeys):
            raise ValueError(f"floors[{k}].storey: storey {floor.storey} does not exist; the number of storeys is {len(self.storeys)}")
        if floor.roof not in ("rafters", "trusses"):
            return
        one, two = (self.wall(name) for name in dict.fromkeys(floor.bears_on))
        if abs(float(one.direction @ two.direction)) < PARALLEL:
            raise ValueError(
                f"floors[{k}].bears_on: {floor.roof} span between parallel walls, but walls '{one.name}' and '{two.name}' are not parallel"
            )
        for wall in (one, two):
            if wall.gable is not None and self.reach(wall)[1] == floor.storey:
                raise ValueError(
                    f"floors[{k}].bears_on: {floor.roof} rest on the walls of the eaves, but wall '{wall.name}' has a gable on top of storey "
                    f"{floor.storey}. Give the two walls without gables, or a roof of purlins"
                )

    def _check_ring_beam(self, k: int, beam: RingBeam, held: dict[tuple[str, int], int]) -> None:
        for wall in self.of_ring_beam(beam):
            if (first := held.setdefault((wall.name, beam.storey), k)) != k:
                raise ValueError(
                    f"ring_beams[{k}].walls: wall '{wall.name}' has ring beam {first + 1} on storey {beam.storey} already; one wall can have "
                    "one ring beam on a level. Name the walls of each beam, or give one beam with the depth of both"
                )
            self._check_storey(f"ring_beams[{k}].storey", wall.name, beam.storey)
            low = self.storeys[beam.storey - 1] - beam.depth
            for i, opening in enumerate(wall.openings):
                if self.part_in(wall, opening, beam.storey)[1] > low + MEETS:
                    raise ValueError(
                        f"ring_beams[{k}].depth: wall '{wall.name}', opening {i + 1} at x {opening.x[0]:g} to {opening.x[1]:g} m reaches "
                        f"{self.part_in(wall, opening, beam.storey)[1]:g} m above the floor of storey {beam.storey}; the beam begins at {low:g} m"
                    )
        if beam.storey > len(self.storeys) or beam.depth >= self.storeys[beam.storey - 1] or not self.of_ring_beam(beam):
            raise ValueError(f"ring_beams[{k}]: no wall in storey {beam.storey} is as high as the beam")

    def of_ring_beam(self, beam: RingBeam) -> list[PlanWall]:
        """The walls that a ring beam runs along."""
        if beam.walls:
            return [self.wall(name) for name in beam.walls]
        return [wall for wall in self.walls if self.reach(wall)[0] <= beam.storey <= self.reach(wall)[1]]

    def ring_beam_on(self, wall: PlanWall, level: int) -> RingBeam | None:
        """The ring beam of a wall on a level, if it has one."""
        return next((beam for beam in self.ring_beams if beam.storey == level and wall in self.of_ring_beam(beam)), None)

    def material_of(self, wall: PlanWall, storey: int) -> str | None:
        """Name of a wall's material in a storey; None: [material]."""
        return wall.materials[storey - self.reach(wall)[0]] if wall.materials else wall.material

    def _check_wall(self, w: int, wall: PlanWall) -> None:
        first, last = self.reach(wall)
        if not 1 <= first <= last <= len(self.storeys):
            raise ValueError(
                f"walls[{w}].storeys: wall '{wall.name}': storeys {first} to {last} were given; possible are 1 to {len(self.storeys)}"
            )
        for name, given in (("thicknesses", wall.thicknesses), ("materials", wall.materials)):
            if given and len(given) != last - first + 1:
                raise ValueError(
                    f"walls[{w}].{name}: wall '{wall.name}' has {len(given)} {name} for {last - first + 1} storeys; expected one for "
                    "each storey"
                )
        for i, opening in enumerate(wall.openings):
            at, said = f"walls[{w}].openings[{i}]", f"wall '{wall.name}', opening {i + 1}"
            if not first <= opening.storey <= last:
                raise ValueError(f"{at}: {said}: the wall has no storey {opening.storey}")
            if opening.x[0] < 0.0 or opening.x[1] > wall.length:
                raise ValueError(
                    f"{at}: {said}: x from {opening.x[0]:g} to {opening.x[1]:g} m, but the length of the wall is {wall.length:g} m"
                )
            tall = self.storeys[opening.storey - 1]
            above = float(sum(self.storeys[opening.storey - 1 : last])) - opening.z[1]
            z = f"z from {opening.z[0]:g} to {opening.z[1]:g} m"
            if opening.through and not (0.0 <= opening.z[0] < tall <= opening.z[1] and above > 0.0):
                raise ValueError(
                    f"{at}: {said}: {z} does not pass through the floor at {tall:g} m and end below the top of the wall, "
                    f"{above + opening.z[1]:g} m above the floor of storey {opening.storey}"
                )
            if not opening.through and (opening.z[0] < 0.0 or opening.z[1] >= tall):
                more = "; for an opening through several storeys give through = true" if opening.z[1] >= tall and above > 0.0 else ""
                raise ValueError(f"{at}: {said}: {z} does not fit in a storey of {tall:g} m{more}")
            if opening.lintel is not None and opening.lintel.depth > above + MEETS:
                raise ValueError(
                    f"{at}.lintel: {said}: a lintel with a depth of {opening.lintel.depth:g} m does not fit under {above:g} m of wall"
                )

    def part_in(self, wall: PlanWall, opening: WallOpening, storey: int) -> tuple[float, float]:
        """Lower and upper height [m] above the floor of a storey of the part of an opening in this storey; equal without a part."""
        foot = float(self.levels[storey - 1] - self.levels[opening.storey - 1])
        low, high = (min(max(z - foot, 0.0), self.storeys[storey - 1]) for z in opening.z)
        return (low, high) if high - low > MEETS else (0.0, 0.0)

    def openings_in(self, wall: PlanWall, storey: int) -> list[WallOpening]:
        """Openings of a wall in a storey, z above its floor; of an opening through several storeys its part there, which has the
        lintel in the highest of them. None in a storey that the wall does not reach."""
        found: list[WallOpening] = []
        for opening in wall.openings if storey <= self.reach(wall)[1] else ():
            low, high = self.part_in(wall, opening, storey)
            if not opening.through and opening.storey == storey:
                found.append(opening)
            elif opening.through and high > low:
                lintel = opening.lintel if high < self.storeys[storey - 1] - MEETS else None
                found.append(opening.model_copy(update={"storey": storey, "z": [low, high], "lintel": lintel}))
        return found

    def reach(self, wall: PlanWall) -> tuple[int, int]:
        """First and last storey of a wall."""
        return (wall.storeys[0], wall.storeys[1]) if wall.storeys is not None else (1, len(self.storeys))

    def bed_height(self, bed: Bed) -> float:
        """Height of a bed joint above the ground [m]."""
        return float(self.levels[bed.storey - 1] + bed.z)

    @property
    def joint_names(self) -> list[str]:
        """Of the joints between walls, then of the bed joints."""
        between = ["-".join(corner.walls) for corner in self.corners if corner.bond == "joint"]
        return between + [bed.name or f"bed {k}" for k, bed in enumerate(self.beds, 1)]

    @property
    def levels(self) -> np.ndarray:
        """Heights of the ground and of the top of each storey [m]."""
        return np.concatenate([[0.0], np.cumsum(self.storeys)])

    def thickness_of(self, wall: PlanWall, storey: int) -> float:
        """Thickness of a wall in a storey that it reaches [m]."""
        return wall.thickness or wall.thicknesses[storey - self.reach(wall)[0]]

    def foot_area(self, axis: int) -> float:
        """Area of the walls' soles at the ground without doors [m^2], each times the share of its direction along x (0) or
        y (1)."""
        total = 0.0
        for wall in self.walls:
            if self.reach(wall)[0] == 1:
                sole = self.strips(wall, 1)[0][0]
                total += self.thickness_of(wall, 1) * sole * abs(wall.direction[axis])
        return float(total)

    @property
    def wall_area(self) -> float:
        """Of all walls in their planes, openings not deducted [m^2]."""
        return float(sum(wall.length * np.diff(self.levels[[r[0] - 1, r[1]]])[0] for wall in self.walls if (r := self.reach(wall))))

    def strips(self, wall: PlanWall, storey: int) -> list[tuple[float, float, float]]:
        """Masonry of a wall in a storey, from the bottom up: length, bottom and top above its floor [m] of each strip between
        sills and heads of openings. What openings share is left out once."""
        holes = self.openings_in(wall, storey)
        heights = sorted({0.0, self.storeys[storey - 1], *(z for o in holes for z in o.z)})
        found = []
        for low, high in pairwise(heights):
            cut, end = 0.0, 0.0
            for left, right in sorted(tuple(o.x) for o in holes if o.z[0] < high and low < o.z[1]):
                cut += max(right - max(left, end), 0.0)
                end = max(end, right)
            found.append((wall.length - cut, low, high))
        return found

    def wall(self, name: str) -> PlanWall:
        """The wall of a name; StopIteration where there is none."""
        return next(wall for wall in self.walls if wall.name == name)

    def bond(self, one: str, two: str) -> Corner | None:
        """What a deck says of the corner of two walls; None where they are one masonry."""
        return next((c for c in self.corners if set(c.walls) == {one, two} and c.bond != "bonded"), None)

    def around(self, floor: StoreyFloor) -> list[tuple[int, float, float]]:
        """The walls around a floor in order: number, and the places along it where the one before and the one after meet it
        [m]; BadGeometry where they make no ring."""
        what = f"floor on storey {floor.storey}"
        reach = [self.reach(wall) for wall in self.walls]
        names = floor.walls or [w.name for w, r in zip(self.walls, reach, strict=True) if r[0] <= floor.storey <= r[1]]
        walls = [next(i for i, w in enumerate(self.walls) if w.name == name) for name in names]
        if floor.walls is None:
            walls = _in_order(self, walls, what)
        corners = []
        for a, b in zip(walls, walls[1:] + walls[:1], strict=True):
            at = meeting(self.walls[a], self.walls[b])
            if at is None:
                raise BadGeometry(f"{what}: walls '{self.walls[a].name}' and '{self.walls[b].name}' do not meet")
            corners.append(at)
        return [(w, corners[k - 1][1], corners[k][0]) for k, w in enumerate(walls)]

    def outline(self, around: list[tuple[int, float, float]]) -> np.ndarray:
        """Corners (n, 2) of a floor on the plan [m], from the walls `around` it."""
        return np.array([np.asarray(self.walls[w].start) + s * self.walls[w].direction for w, _, s in around])

    def bearing(self, floor: StoreyFloor, around: list[tuple[int, float, float]]) -> list[tuple[int, float, float]]:
        """The parts of the walls around a floor that carry its load; BadGeometry if a wall of `bears_on` is not around it."""
        names = [self.walls[w].name for w, _, _ in around]
        if strange := [name for name in floor.bears_on if name not in names]:
            raise BadGeometry(
                f"floor on storey {floor.storey}: wall '{strange[0]}' of `bears_on` is not adjacent to the floor; "
                f"the walls around it are {', '.join(names)}"
            )
        return [part for part in around if self.walls[part[0]].name in floor.bears_on] or around

    @property
    def floor_remarks(self) -> list[str]:
        """Walls within a floor that it does not join, roofs whose ridge [m] differs from that of a gable beside them, and rafters
        without thrust."""
        found = []
        for floor in self.floors:
            if crossed := self._crossed(floor):
                found.append(
                    f"Floor on storey {floor.storey}: walls {', '.join(map(repr, crossed))} pass below the floor, which neither rests on "
                    "them nor joins them. Give a separate floor for each area between walls, with the walls around it as `walls`."
                )
            if floor.roof == "rafters" and floor.kind == "rigid":
                found.append(
                    f"Floor on storey {floor.storey}: the rigid floor ties the rafters at the eaves, so the rafters have no thrust."
                )
            around = floor.walls or [wall.name for wall in self.walls]
            for wall in self.walls:
                if floor.pitch is None or wall.gable is None or wall.name not in around or self.reach(wall)[1] != floor.storey:
                    continue
                rise = wall.gable.rise
                heights = [run * tan(radians(floor.pitch)) for run in self._roof_runs(floor, wall)]
                if all(abs(height - rise) > RIDGES * max(height, rise) for height in heights):
                    ridge = min(heights, key=lambda height: abs(height - rise))
                    found.append(
                        f"Floor on storey {floor.storey}: with a pitch of {floor.pitch:g} degrees, the ridge of the {floor.roof} "
                        f"is {ridge:.3g} m above the eaves, but the gable of wall '{wall.name}' rises {rise:.3g} m. Load and "
                        "thrust follow the pitch; the masonry follows the gable."
                    )
        return found

    def _crossed(self, floor: StoreyFloor) -> list[str]:
        """Names of the walls of the storey that pass through the inside of a floor; none of a floor whose walls make no ring."""
        try:
            around = self.around(floor)
        except BadGeometry:
            return []
        outline, ring = self.outline(around), {w for w, _, _ in around}
        found = []
        for w, wall in enumerate(self.walls):
            first, last = self.reach(wall)
            places = np.asarray(wall.start) + np.linspace(0.0, wall.length, 17)[1:-1, None] * wall.direction
            within = inside(outline, places) & (distance(outline, places) > MEETS)
            if w not in ring and first <= floor.storey <= last and within.any():
                found.append(wall.name)
        return found

    def _roof_runs(self, floor: StoreyFloor, wall: PlanWall) -> list[float]:
        """Horizontal lengths [m] of the slopes of a roof: half the span of rafters and trusses; of purlins from both ends of the
        wall of a gable to its ridge."""
        if floor.roof == "purlins":
            ridge = wall.gable_outline[1][0]
            return [ridge, wall.length - ridge]
        one, two = (self.wall(name) for name in dict.fromkeys(floor.bears_on))
        across = 0.5 * np.add(two.start, two.end) - np.asarray(one.start)
        return [0.5 * abs(float(one.direction[0] * across[1] - one.direction[1] * across[0]))]

    def thrusts(self, floor: StoreyFloor, around: list[tuple[int, float, float]]) -> list[tuple[int, float, float, np.ndarray]]:
        """Thrust of rafters on the walls that carry them: wall, from and to along it [m], force (2) on the plan, outward [N]."""
        corners = self.outline(around)
        total = floor.thrust_ratio * floor.weight * abs(signed_area(corners))
        found = []
        for w, a, b in self.bearing(floor, around) if total > 0.0 else ():
            wall = self.walls[w]
            out = np.array([-wall.direction[1], wall.direction[0]])
            aside = float(out @ (np.asarray(wall.start) - corners.mean(axis=0)))
            found.append((w, min(a, b), max(a, b), total * np.sign(aside) * out))
        return found


def _in_order(plan: Plan, walls: list[int], what: str) -> list[int]:
    """Walls that meet two others each, in the order of the ring they make."""
    meets = {a: [b for b in walls if b != a and meeting(plan.walls[min(a, b)], plan.walls[max(a, b)])] for a in walls}
    odd = next((a for a, others in meets.items() if len(others) != 2), None)
    if odd is not None:
        wall = plan.walls[odd]
        met = ", ".join(f"'{plan.walls[b].name}'" for b in meets[odd]) or "none"
        (x0, y0), (x1, y1) = wall.start, wall.end
        raise BadGeometry(
            f"{what}: the walls of the storey do not form a simple ring: wall '{wall.name}' from ({x0:g}, {y0:g}) to ({x1:g}, "
            f"{y1:g}) m meets {met} of these walls, expected two. Give the walls around the floor by `walls`"
        )
    ring = [walls[0], meets[walls[0]][0]]
    while len(ring) < len(walls):
        after = [b for b in meets[ring[-1]] if b != ring[-2]]
        if after[0] in ring:
            raise BadGeometry(f"{what}: the walls of the storey form more than one ring: give the walls around the floor by `walls`")
        ring.append(after[0])
    return ring
