"""A building of walls on a plan: storeys, openings, flanges, floors, rods (`building`)."""

from collections import Counter
from itertools import pairwise
from math import cos, radians, tan
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import distance, inside, signed_area
from extrados.model.places import Opening, Range
from extrados.model.structure import Structure
from extrados.schema.quantities import Angle, Area, Force, Length, Stiffness, Stress
from extrados.schema.table import Table, key

#: Distance within which two walls meet [m]
MEETS = 1e-6
#: Greatest ratio of neutral axis to effective depth of a reinforced ring beam, EN 1992-1-1, 5.5(4) (verify clause)
DEEPEST_AXIS = 0.45
#: Depth of the rectangular stress block over that of the neutral axis, EN 1992-1-1, (3.19), concrete up to 50 MPa
BLOCK_DEPTH = 0.8
#: Cosine of the angle of walls that run side by side
PARALLEL = 0.99
#: Greatest rise of a gable over the length of its wall; of a roof with the greatest pitch, 75 degrees, it is 1.87
STEEP = 2.0
#: Ratio by which the ridge of a roof and that of a gable can differ without a remark
RIDGES = 0.05
PlanPoint = Annotated[list[Length], Field(min_length=2, max_length=2)]
Place = Annotated[list[Length], Field(min_length=3, max_length=3)]


class Lintel(Table):
    """A beam over an opening that stays elastic, of the wall's thickness."""

    depth: Length = key(about="height of the beam", gt=0)
    bearing: Length = key(0.0, "bearing length of the lintel on the wall at each side", ge=0)
    material: str | None = key(None, "material of the lintel: a name in [materials]; default: [material] without cracking")


class WallOpening(Table):
    """A rectangular door or window."""

    storey: int = key(1, "number of the storey of the opening, from 1 at the ground", ge=1)
    x: Range = key(about="[from, to] along the wall, from its start")
    z: Range = key(about="[from, to] above the floor of the storey")
    lintel: Lintel | None = key(None, "beam over it")
    through: bool = key(
        False,
        "whether the opening extends through the floors above; sill and head in `z` are then both heights above the floor of `storey`",
    )

    @model_validator(mode="after")
    def _area(self) -> "WallOpening":
        Opening(x=self.x, y=self.z)
        for name, (low, high) in (("x", self.x), ("z", self.z)):
            if high - low <= 2 * MEETS:
                raise ValueError(f"{name}: the width or height of the opening is {high - low:.3g} m; expected more than {2 * MEETS:g} m")
        return self


class Gable(Table):
    """A triangular top of a wall, of the material and thickness of the highest storey of the wall."""

    rise: Length = key(about="height of the ridge above the top of the wall; at most twice the length of the wall", gt=0)
    ridge: Length | None = key(None, "distance of the ridge from the start of the wall; default: the middle", ge=0)


class PlanWall(Table):
    """A plane wall: a line on the plan, of one thickness or one for each storey."""

    name: str = key(about="name in results", min_length=1, max_length=40)
    start: PlanPoint = key(about="[x, y] in plan of the start of the middle plane of the wall")
    end: PlanPoint = key(about="[x, y] of its end")
    thickness: Length | None = key(None, "thickness; or give thicknesses", gt=0)
    thicknesses: list[Length] = key([], "thickness of the wall in each of its storeys, from the lowest upwards", max_length=50)
    storeys: list[int] | None = key(None, "[first, last] storey; default all", min_length=2, max_length=2)
    openings: list[WallOpening] = key([], "doors and windows", max_length=200)
    material: str | None = key(None, "material of the wall: a name in [materials]; default: [material]")
    materials: list[str] = key([], "material of each storey of the wall, from the lowest upwards: names in [materials]", max_length=50)
    gable: Gable | None = key(None, "gable: triangular top of the wall above its highest storey")

    @model_validator(mode="after")
    def _long(self) -> "PlanWall":
        if not self.length > MEETS:
            raise ValueError("start and end have the same position")
        if (self.thickness is None) == (not self.thicknesses):
            raise ValueError("expected either thickness or thicknesses")
        if self.material is not None and self.materials:
            raise ValueError("expected either material or materials")
        if not all(t > 0.0 for t in self.thicknesses):
            raise ValueError("thicknesses: each thickness must be above 0")
        if self.gable is not None and self.gable.ridge is not None and self.gable.ridge > self.length + MEETS:
            raise ValueError(f"gable.ridge: {self.gable.ridge:g} m is beyond the end of the wall, whose length is {self.length:g} m")
        if self.gable is not None and self.gable.rise > STEEP * self.length + MEETS:
            raise ValueError(
                f"gable.rise: wall '{self.name}': {self.gable.rise:g} m is more than {STEEP:g} times the length of the wall, {self.length:g} m"
            )
        return self

    @property
    def gable_outline(self) -> list[tuple[float, float]]:
        """Distance along the wall and height above its top [m] of the eaves and the ridge of its gable; empty without a gable."""
        if self.gable is None:
            return []
        ridge = 0.5 * self.length if self.gable.ridge is None else min(self.gable.ridge, self.length)
        return [(0.0, 0.0), (ridge, self.gable.rise), (self.length, 0.0)]

    @property
    def length(self) -> float:
        """Length on the plan [m]."""
        return float(np.hypot(*np.subtract(self.end, self.start)))

    @property
    def direction(self) -> np.ndarray:
        """Unit vector on the plan from start to end."""
        return np.subtract(self.end, self.start) / self.length


class Corner(Table):
    """How two walls that meet hang together."""

    walls: list[str] = key(about="names of the two walls; the second wall abuts on the first", min_length=2, max_length=2)
    bond: Literal["bonded", "weak", "joint", "open"] = key(
        about="connection of the two walls. bonded: one masonry; weak: beside the corner, the elements of the "
        "second wall have a lower strength; joint: a joint of [joints] between the walls, which opens, "
        "slides up and down, and crushes; open: connected only by floors"
    )
    strength: float = key(
        0.5, "for a weak corner: tensile strength at the corner, divided by the tensile strength of the second wall", gt=0, le=1
    )

    @model_validator(mode="after")
    def _two(self) -> "Corner":
        if self.walls[0] == self.walls[1]:
            raise ValueError(f"walls: '{self.walls[0]}' occurs twice; expected two walls that meet")
        return self


class Bed(Table):
    """A bed joint of [joints] all along a height of some walls: it opens, slides along the wall, and crushes."""

    name: str | None = key(None, 'name in the results and in [[joints.types]]; default: "bed 1" and so on', max_length=40)
    storey: int = key(1, "number of the storey of the bed joint, from 1 at the ground", ge=1)
    z: Length = key(0.0, "height above the floor of the storey; 0 in the first storey is the base of the wall", ge=0)
    walls: list[str] = key([], "names of the walls through which the joint runs; default: all walls of the storey", max_length=200)


class Seat(Table):
    """Where the ends of a floor rest on its walls, without a connection."""

    length: Length = key(about="length of the seat, perpendicular to the wall", gt=0)
    friction: float = key(about="coefficient of friction between floor and wall", gt=0)


class StoreyFloor(Table):
    """A floor or roof on top of a storey: a membrane between walls, or joists, and what it carries."""

    storey: int = key(about="number of the storey below the floor", ge=1)
    kind: Literal["rigid", "flexible", "joists", "none"] = key(
        "flexible",
        "kind of floor. flexible: membrane with the stiffness `young` times `thickness`; rigid: practically rigid (concrete slab of 30 "
        "GPa and 0.2 m); joists: bars across the floor in one direction; none: only the load of the floor acts",
    )
    walls: list[str] | None = key(
        None, "names of the walls around the floor, in order; default: all walls of the storey, if they form a single ring", min_length=3
    )
    young: Stress | None = key(None, "for a flexible floor: its elastic modulus; for joists: the elastic modulus of their wood", gt=0)
    thickness: Length | None = key(None, "of a flexible floor", gt=0)
    poisson: float = key(0.25, "of a flexible floor", ge=0, lt=0.5)
    joist_area: Annotated[Area, Field(gt=0)] | None = key(None, "for joists: cross-section of one joist")
    joist_spacing: Length | None = key(None, "of joists: their distance", gt=0)
    load: Stress = key(0.0, "weight per area of the floor and its loads; for a roof, per area of its slopes", ge=0)
    pitch: Angle | None = key(None, "slope of a roof from the horizontal", gt=0, le=75)
    roof: Literal["rafters", "trusses", "purlins"] | None = key(
        None,
        "structure of a pitched roof. rafters: pairs of rafters that meet in the middle between the two walls of `bears_on` and push "
        "these walls apart (not if a rigid floor ties them); trusses: rafters with ties, without thrust; purlins: beams along the ridge "
        "between the two walls of `bears_on`, without thrust",
    )
    bears_on: list[str] = key(
        [], "walls that carry the load, in proportion to their length; default: all walls around the floor", max_length=100
    )
    seat: Seat | None = key(
        None,
        "seat of the floor on the walls of `bears_on`: only friction under its load restrains the "
        "floor, and the floor slides off if the wall moves away by more than the length of the seat. Only shells "
        "consider this. Default: the floor is connected to its walls",
    )

    @model_validator(mode="after")
    def _whole(self) -> "StoreyFloor":
        needed = {"flexible": ("young", "thickness"), "joists": ("young", "joist_area", "joist_spacing")}.get(self.kind, ())
        for name in ("young", "thickness", "joist_area", "joist_spacing"):
            if (getattr(self, name) is None) == (name in needed):
                raise ValueError(f"a floor of kind '{self.kind}' {'requires' if name in needed else 'takes no'} {name}")
        if self.kind == "joists" and len(set(self.bears_on)) != 2:
            raise ValueError("bears_on: for joists, expected the names of two different walls, between which the joists span")
        if (self.pitch is None) != (self.roof is None):
            raise ValueError("a roof requires both `pitch` and `roof` (rafters, trusses or purlins)")
        if self.roof is not None and len(set(self.bears_on)) != 2:
            raise ValueError(f"bears_on: for a roof of {self.roof}, expected the names of two different walls")
        if self.roof is not None and not self.load > 0.0:
            raise ValueError(f"a roof of {self.roof} requires `load`, the weight per area of its slopes, above 0")
        if self.roof == "rafters" and self.kind == "joists":
            raise ValueError(
                "roof = 'rafters' pushes the two walls apart, but joists tie them: give roof = 'trusses', or another kind of floor"
            )
        if self.seat is not None and (self.kind == "none" or self.roof is not None or not self.load > 0.0 or not self.bears_on):
            raise ValueError("seat: expected a level floor of kind 'joists', 'flexible' or 'rigid', with `load` above 0 and `bears_on`")
        if self.walls is not None and (twice := [name for name, n in Counter(self.walls).items() if n > 1]):
            raise ValueError(f"walls: wall '{twice[0]}' occurs twice")
        return self

    @property
    def weight(self) -> float:
        """Weight per area on the plan [Pa]: that of the slopes over the cosine of the pitch."""
        return self.load / self.flatness

    @property
    def flatness(self) -> float:
        """Cosine of the pitch; 1 of a level floor."""
        return 1.0 if self.pitch is None else cos(radians(self.pitch))

    @property
    def thrust_ratio(self) -> float:
        """Thrust on each of the two walls that carry rafters over the weight of the roof: of a three-hinged arch of span l and rise
        f = l/2 tan(pitch) the thrust is w l^2/(8 f). 0 of other floors, and of a rigid floor, which ties the rafters at the eaves."""
        if self.roof != "rafters" or self.pitch is None or self.kind == "rigid":
            return 0.0
        return 0.25 / tan(radians(self.pitch))


class Rod(Table):
    """A tie rod between the nodes nearest to two places."""

    start: Place = key(about="[x, y, z] of one end")
    end: Place = key(about="[x, y, z] of the other end")
    area: Annotated[float, Field(gt=0)] = key(about="cross-section in m^2")
    material: str = key(about="a name of [materials]")
    prestress: Force = key(0.0, "tensile force in the rod before the building deforms", ge=0)


class Prop(Table):
    """The top of a storey of a wall that cannot move across its plane: what holds it does not move."""

    wall: str = key(about="name of the wall, which must run along x or y")
    storey: int = key(about="on top of this storey", ge=1)


class Prestress(Table):
    """A vertical force on top of a wall, of post-tensioning or of a beam that rests on a part of it."""

    wall: str = key(about="name of the wall")
    force: Force = key(about="downward, in all, spread evenly", gt=0)
    x: Range | None = key(None, "[from, to] along the wall from its start, for instance the bearing of a beam; default: the whole length")
    level: Annotated[int, Field(ge=1)] | None = key(None, "storey on whose top the force acts; default: the highest storey of the wall")


class Reinforcement(Table):
    """Longitudinal bars of a ring beam of concrete, half of them at its upper and half at its lower face."""

    area: Annotated[Area, Field(gt=0)] = key(about="cross-section of all bars")
    yield_strength: Stress = key(about="yield strength of the bars", gt=0)
    cover: Length = key(0.04, "distance of the bars from the upper and the lower face of the beam", gt=0)

    @property
    def tension(self) -> float:
        """Axial strength in tension [N]."""
        return self.area * self.yield_strength

    def plastic_moment(self, depth: float, width: float, concrete: float) -> float:
        """Moment [N m] of a section by the stress block of 0.85 of a compressive strength [Pa]; bars in compression are neglected."""
        force = 0.5 * self.tension
        return force * (depth - self.cover - 0.5 * force / (0.85 * concrete * width))

    def relative_axis(self, depth: float, width: float, concrete: float) -> float:
        """Depth of the neutral axis over the effective depth [-] of a section by the same stress block."""
        return 0.5 * self.tension / (0.85 * concrete * width) / BLOCK_DEPTH / (depth - self.cover)


class RingBeam(Table):
    """A beam of the wall's thickness along the top of some walls; elastic, or in frames with the strength of its reinforcement."""

    storey: int = key(about="storey on whose top the ring beam lies; the upper face of the beam is level with the floor", ge=1)
    depth: Length = key(about="height of the beam", gt=0)
    material: str = key(about="a name of [materials]")
    walls: list[str] = key([], "names of the walls; default: all walls of the storey", max_length=200)
    reinforcement: Reinforcement | None = key(
        None,
        "bars of the beam. In frames, the bars limit the tension of the beam and give it plastic hinges; its material then requires "
        "`compressive_strength`. Default: the beam remains elastic",
    )

    @model_validator(mode="after")
    def _room(self) -> "RingBeam":
        if self.reinforcement is not None and 2.0 * self.reinforcement.cover >= self.depth:
            raise ValueError(
                f"reinforcement.cover: {self.reinforcement.cover:g} m from both faces does not fit in a beam with a depth of {self.depth:g} m"
            )
        return self


class Plan(Structure):
    """A building of plane walls on a plan, storey upon storey; z is up, the ground at 0."""

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
    walls: list[PlanWall] = key(about="[[structure.walls]]", min_length=1, max_length=200)
    corners: list[Corner] = key([], "corners where walls meet without being bonded, [[structure.corners]]", max_length=1000)
    beds: list[Bed] = key([], "bed joints that can slide, [[structure.beds]]", max_length=100)
    floors: list[StoreyFloor] = key([], "[[structure.floors]]", max_length=200)
    rods: list[Rod] = key([], "[[structure.rods]]", max_length=200)
    props: list[Prop] = key([], "[[structure.props]]", max_length=200)
    prestress: list[Prestress] = key([], "vertical forces on walls, [[structure.prestress]]", max_length=200)
    ring_beams: list[RingBeam] = key([], "[[structure.ring_beams]]", max_length=50)
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


def nearly_meeting(one: PlanWall, two: PlanWall) -> float | None:
    """How far an end of one of two walls that do not meet stays from the middle of the other [m], where their thicknesses
    reach over that; None elsewhere, and of walls side by side."""
    if abs(float(np.dot(one.direction, two.direction))) > PARALLEL:
        return None
    gaps = []
    for wall, other in ((one, two), (two, one)):
        for end in (wall.start, wall.end):
            along = np.clip(float(np.subtract(end, other.start) @ other.direction), 0.0, other.length)
            gaps.append(float(np.hypot(*(np.asarray(other.start) + along * other.direction - end))))
    reach = 0.5 * sum(max([wall.thickness or 0.0, *wall.thicknesses]) for wall in (one, two))
    return min(gaps) if min(gaps) < reach else None


def meeting(one: PlanWall, two: PlanWall) -> tuple[float, float] | None:
    """Distances along two walls from their starts to where they meet [m]; None where they do not."""
    a, b = np.asarray(one.start), np.asarray(two.start)
    d, e = one.direction, two.direction
    cross = d[0] * e[1] - d[1] * e[0]
    if abs(cross) < 1e-9:  # side by side, or in one line: end to end
        low, high = sorted((float((b - a) @ d), float((np.asarray(two.end) - a) @ d)))
        aside = abs((b - a)[0] * d[1] - (b - a)[1] * d[0])
        if aside < MEETS and min(high, one.length) - max(low, 0.0) > MEETS:
            raise BadGeometry(f"walls '{one.name}' and '{two.name}' overlap in plan; give one wall, with `thicknesses` by storey")
        for s, p in ((0.0, one.start), (one.length, one.end)):
            for t, q in ((0.0, two.start), (two.length, two.end)):
                if np.hypot(*np.subtract(p, q)) < MEETS:
                    return s, t
        return None
    gap = b - a
    s, t = (gap[0] * e[1] - gap[1] * e[0]) / cross, (gap[0] * d[1] - gap[1] * d[0]) / cross
    if not (-MEETS <= s <= one.length + MEETS and -MEETS <= t <= two.length + MEETS):
        return None
    return float(np.clip(s, 0.0, one.length)), float(np.clip(t, 0.0, two.length))


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
