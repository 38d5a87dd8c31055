"""Parts of a building of walls on a plan: walls, openings, floors, rods, ring beams; where walls meet."""

from collections import Counter
from math import cos, radians, tan
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from extrados.model.errors import BadGeometry
from extrados.model.places import Opening, Range
from extrados.schema.quantities import Angle, Area, Force, Length, Stress
from extrados.schema.table import Table, key

#: Distance within which two walls meet [m]
MEETS = 1e-6
#: Depth of the rectangular stress block over that of the neutral axis, EN 1992-1-1, (3.19), concrete up to 50 MPa
BLOCK_DEPTH = 0.8
#: Cosine of the angle of walls that run side by side
PARALLEL = 0.99
#: Greatest rise of a gable over the length of its wall; of a roof with the greatest pitch, 75 degrees, it is 1.87
STEEP = 2.0
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
    lintel: Lintel | None = key(None, "lintel: beam over the opening")
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
    end: PlanPoint = key(about="[x, y] in plan of the end of the middle plane of the wall")
    thickness: Length | None = key(None, "thickness of the wall; alternatively give `thicknesses`", gt=0)
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
    thickness: Length | None = key(None, "for a flexible floor: thickness of the membrane", gt=0)
    poisson: float = key(0.25, "for a flexible floor: Poisson's ratio of the membrane", ge=0, lt=0.5)
    joist_area: Annotated[Area, Field(gt=0)] | None = key(None, "for joists: cross-section of one joist")
    joist_spacing: Length | None = key(None, "for joists: distance between neighbouring joists", gt=0)
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
    material: str = key(about="material of the rod: a name in [materials]")
    prestress: Force = key(0.0, "tensile force in the rod before the building deforms", ge=0)


class Prop(Table):
    """The top of a storey of a wall that cannot move across its plane: what holds it does not move."""

    wall: str = key(about="name of the wall, which must run along x or y")
    storey: int = key(about="storey at whose top the wall is propped", ge=1)


class Prestress(Table):
    """A vertical force on top of a wall, of post-tensioning or of a beam that rests on a part of it."""

    wall: str = key(about="name of the wall")
    force: Force = key(about="total downward force, distributed evenly", gt=0)
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
    material: str = key(about="material of the beam: a name in [materials]")
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
