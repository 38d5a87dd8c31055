"""Analysis kind of the codes: code-checks."""

from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import model_validator

from extrados.analyses.table import BuildingAnalysis
from extrados.schema.quantities import Acceleration, Angle, Force, Length, Stress, Time, Velocity
from extrados.schema.spectrum import CodeSpectrum
from extrados.schema.table import Table, key

if TYPE_CHECKING:
    from extrados.views.building import Building


class CodeChecks(BuildingAnalysis):
    """Checks by the code of the deck: a rigid body that rocks, or a wall as a pier. Each rule has its source."""

    kind: Literal["code-checks"]
    uses: ClassVar = ("material.density", "material.compressive_strength", "joints.friction", "joints.cohesion", "joints.restitution")
    beside: ClassVar = ("joints.energy_ratio", "initial.rotation_ratio", "supports.abutting_wall", "supports.stiffness")
    view: ClassVar = ""
    structures: ClassVar = ("block", "column", "panel", "brickwork")
    spectrum: CodeSpectrum | None = key(
        None, "elastic spectrum of the code at the site, for the demand; default: the spectrum of a `compatible` motion"
    )
    peak_acceleration: Acceleration | None = key(None, "demand a_g S, as an acceleration; default: from the spectrum", gt=0)
    peak_velocity: Velocity | None = key(None, "peak ground velocity: demand for the rule of Ishiyama", gt=0)
    motion_spectrum: bool = key(
        False, "if no code spectrum is given: use the response spectrum and the peak velocity of the motion in the deck"
    )
    pulse_period: Time | None = key(
        None, "period of a sine pulse. If given, the formula of Housner for one half cycle of this sine is also checked", gt=0
    )
    behaviour_factor: float | None = key(
        None,
        "behaviour factor q, for the linear check of a mechanism and for the demand on a pier (for ASCE "
        "41: its m factor); default 2 (NTC), 1.5 (EN 1998), 1 (ASCE 41)",
        ge=1,
        le=6,
        source="Circ. 7/2019, C8.7.1.2.1.7",
    )
    confidence_factor: float | None = key(
        None, "confidence factor FC; default: value of [code]", ge=1, le=2, source="Circ. 7/2019, Table C8.5.IV"
    )
    partial_factor: float | None = key(
        None,
        "partial factor gamma_M for a pier by NTC; default: 2 for a linear check with q, otherwise 1",
        ge=1,
        le=3,
        source="NTC 2018 7.8.1.1",
    )
    axial_load: Force | None = key(None, "vertical load on top of the wall. If given, the rules for piers are also checked", ge=0)
    thickness: Length | None = key(None, "thickness of the pier; default: the depth of the block", gt=0)
    sliding_friction: float = key(
        0.4, "coefficient of friction for sliding along a bed joint, as given by the code", gt=0, le=2, source="NTC 2018"
    )
    diagonal_strength: Stress | None = key(
        None, "tau_0: shear strength of the masonry without compression. If given, diagonal cracking is also checked", gt=0
    )
    interlocking_ratio: float | None = key(
        None,
        "phi = h_b/l of a pier of regular masonry: height of a unit / overlap. If given, stepped cracking is also checked",
        gt=0,
        le=5,
        source="Circ. 7/2019 [C8.7.1.17]",
    )
    unit_strength: Stress | None = key(None, "f_b, compressive strength of the units, which limits the shear strength of the pier", gt=0)
    fixity: Literal["cantilever", "double"] = key("cantilever", "rotation of the top of the pier. cantilever: free; double: fixed")

    def reckons_with(self, building: "Building") -> set[str]:
        """Strength and cohesion are of piers, impacts and the start of what rocks."""
        found = super().reckons_with(building)
        if self.axial_load is None:
            found -= {"material.compressive_strength", "joints.cohesion"}
        if building.structure is not None and building.structure.rocks_as == "piers":
            found -= {"joints.friction", "joints.restitution", "joints.energy_ratio", "initial.rotation_ratio", "supports.stiffness"}
        return found


class Verification(Table):
    """Verification of a capacity curve by displacement, by the code of the deck."""

    #: The action of a capacity curve is a spectrum
    peak_acceleration: ClassVar = None
    method: Literal["N2", "capacity-spectrum", "coefficient"] | None = key(
        None,
        "method that gives the displacement demand. N2: equivalent oscillator (EN 1998-1, Annex B); capacity-spectrum: capacity "
        "spectrum method; coefficient: coefficient method of ASCE 41. Default: coefficient (ASCE41), N2 (others)",
    )
    secant: float = key(
        0.7,
        "share of the greatest base shear at which the elastic branch of the bilinear curve meets the capacity "
        "curve; 0.6 is the general rule of C7.3.4.2",
        ge=0.5,
        le=0.9,
        source="NTC 2018 7.8.1.6",
    )
    quality: float = key(
        0.33,
        "factor k on the hysteretic damping, in the capacity spectrum method: 1, 0.66 or 0.33 for high, moderate or low dissipation",
        ge=0,
        le=1,
        source="Circ. 7/2019 [C7.3.10]",
    )
    shape: Literal["displaced", "mode"] = key(
        "displaced",
        "mode shape phi for the equivalent mass. displaced: elastic displacement under the horizontal forces; mode: mode with the "
        "greatest participating mass along the load (this mass can be small with flexible floors)",
        source="Circ. 7/2019 C7.3.4.2: first mode",
    )
    spectrum: CodeSpectrum | None = key(
        None, "elastic spectrum of the limit state that gives the verdict; default: the spectrum of [code] or of a `compatible` motion"
    )
    motion_spectrum: bool = key(False, "if no code spectrum is given: use the response spectrum of the motion in the deck")

    motions: int | None = key(
        None,
        "number of motions of the set in [motion] for a fragility curve: N2 with the spectrum of each motion; default: no fragility curve",
        ge=2,
        le=10_000,
    )

    @model_validator(mode="after")
    def _of_the_method(self) -> "Verification":
        if "quality" in self.model_fields_set and self.method != "capacity-spectrum":
            raise ValueError('quality: needs method = "capacity-spectrum"')
        return self


class Floor(Table):
    """A floor, roof or vault that rests on the wall."""

    height: Length = key(about="height at which the load acts, above the foot of the wall", ge=0)
    load: Force = key(0.0, "weight of a load that rests on the wall (P)", ge=0, source="Circ. 7/2019 [C8.7.1.1]")
    pushing: Force = key(
        0.0,
        "weight Q of a load that does not rest on the wall: its mass pushes the wall, and its weight does not stabilise the wall",
        ge=0,
        source="Circ. 7/2019 [C8.7.1.1]",
    )
    arm: Length | None = key(None, "horizontal distance from the hinge to the load, inwards; default: the middle of the wall", ge=0)
    sways: bool = key(True, "whether the wall accelerates the mass of the load; false if other walls restrain the load")
    thrust: Force = key(0.0, "outward horizontal thrust of the load without earthquake")


class WallTie(Table):
    """A tie that holds the wall."""

    height: Length = key(about="height of the tie above the foot of the wall", gt=0)
    force: Force = key(about="strength of the tie: the least of steel, anchorage and masonry", gt=0)


class Wing(Table):
    """A further part of a facade that overturns with it: a wing of another height, or an upper wall of another thickness."""

    height: Length = key(about="height of the top of this part above the foot of the wall", gt=0)
    thickness: Length = key(about="thickness of this part", gt=0)
    width: Length = key(about="length of this part", gt=0)
    foot: Length = key(0.0, "height of the foot of this part above the foot of the wall", ge=0)
    setback: Length = key(0.0, "distance by which the outer face of this part is set back from the outer face of the wall", ge=0)

    @model_validator(mode="after")
    def _upright(self) -> "Wing":
        if self.foot >= self.height:
            raise ValueError(f"foot: {self.foot:g} m is not below the top of this part, {self.height:g} m")
        return self


class Mode(Table):
    """A mode of the building that carries the part, for the floor spectrum."""

    period: Time = key(about="period T_k", gt=0)
    participation: float = key(about="modal participation factor gamma_k of the mode")
    shape: float = key(about="psi_k(z): mode shape at the height of the part")
    damping: float = key(0.05, "damping ratio xi_k", gt=0, le=0.3)


class SideWalls(Table):
    """Walls at right angles of which wedges go with the facade."""

    thickness: Length = key(about="thickness of each side wall", gt=0)
    crack_angle: Angle = key(about="angle of the crack from the vertical", gt=0, lt=80)
    count: int = key(2, "number of side walls", ge=1, le=4)


class Interlocking(Table):
    """Teeth by which side walls hold the whole height of a wall that turns; they slip out before collapse."""

    unit_height: Length = key(about="height h_b of the units, equal to one course", gt=0)
    overlap: Length = key(about="overlap l of the units: the length of a tooth of the interlocking", gt=0)
    thickness: Length = key(about="thickness t_s of each side wall", gt=0)
    count: int = key(2, "number of toothed edges", ge=1, le=4)


class LocalMechanism(BuildingAnalysis):
    """A local mechanism by the kinematic analysis of codes: multiplier, participating mass, linear and nonlinear checks."""

    kind: Literal["local-mechanism"]
    uses: ClassVar = ("material.density", "material.compressive_strength")
    beside: ClassVar = ("joints.friction", "supports.abutting_wall", "material.young")
    view: ClassVar = ""
    considers: ClassVar = ("[[ties]]", "[[dampers]]", "[[hinges]]", "[supports] abutting_wall")
    starter: ClassVar = {
        "mechanism": '"facade"',
        "height": "6.0",
        "thickness": '"60 cm"',
        "width": "1.0",
        "peak_acceleration": '"0.15 g"',
        "floors": '[{ height = 5.8, load = "10 kN", arm = 0.4 }]',
    }
    mechanism: Literal[
        "facade", "corner", "gable", "parapet", "chimney", "wall", "tower", "vertical-bending", "horizontal-bending", "building"
    ] = key(
        about="kind of mechanism. For a part of a building: facade, corner of two walls, gable, parapet or chimney on a "
        "building, free-standing wall, tower as one body, vertical bending between floors, horizontal "
        "bending between side walls. `building`: the collapse mechanism of the [structure] of the deck "
        "(triumphal arches, bridges, vaults), or the walls of a building in plan"
    )
    height: Length | None = key(None, "height of the body that overturns, above the foot of the wall", gt=0)
    thickness: Length | None = key(None, "thickness at the hinge", gt=0)
    width: Length | None = key(None, "length of the wall that overturns; default 1 m, for a tower its thickness", gt=0)
    hinge_height: Length = key(0.0, "height of the hinge: the crack about which the wall rotates", ge=0)
    crack_angle: Angle | None = key(None, "for a corner: angle of the cracks in both walls from the vertical", gt=0, lt=80)
    floors: list[Floor] = key([], "floors, roofs and vaults that load the part", max_length=50)
    ties: list[WallTie] = key([], "ties that restrain the part", max_length=50)
    side_walls: SideWalls | None = key(None, "wedges of the side walls that move with the part")
    wings: list[Wing] = key([], "further parts that overturn with a facade", max_length=20)
    abutment_force: Force | None = key(
        None,
        "for horizontal bending: force H that each side wall (or its tie) resists against the thrust of the strip. Default: the side "
        "walls do not move, for instance between neighbouring walls; the strip then crushes at `compressive_strength` of [material]",
        gt=0,
    )
    interlocking: Interlocking | None = key(
        None, "interlocking of the units with the side walls, which restrains a facade by friction", source="Circ. 7/2019 [C8.7.1.2]"
    )
    spectrum: CodeSpectrum | None = key(
        None, "elastic spectrum of the site; default: the spectrum of a `compatible` motion", source="EN 1998-1 3.2.2; NTC 2018 3.2.3"
    )
    peak_acceleration: Acceleration | None = key(None, "demand a_g S, as an acceleration; default: from the spectrum", gt=0)
    collapse_spectrum: CodeSpectrum | None = key(
        None,
        "elastic spectrum of the site for the limit state of collapse, SLC; adds the check of d_SLC to the checks at SLV",
        source="Circ. 7/2019, C8.7.1.2.1.8",
    )
    motion_spectrum: bool = key(False, "if no code spectrum is given: use the response spectrum of the motion in the deck")
    behaviour_factor: float = key(
        2.0,
        "behaviour factor q of the linear check of NTC, which applies to mechanisms without a displacement check",
        ge=1,
        le=6,
        source="Circ. 7/2019, C8.7.1.2.1.7",
    )
    confidence_factor: float | None = key(
        None,
        "confidence factor FC; default: from [code]; that of LC1 (1.35) if the compressive strength is neglected",
        ge=1,
        le=2,
        source="Circ. 7/2019, C8.7.1.2.1.3, Table C8.5.IV",
    )
    base_height: Length | None = key(
        None,
        "height z of the mechanism above the foundation. If z is above 0, the building amplifies the motion. Default for blocks: the "
        "lowest hinge between moving and fixed parts; for a table: `hinge_height`",
        ge=0,
    )
    building_height: Length | None = key(
        None, "height H of the building, required if z is above 0. Default for blocks: the top of all parts; for a table: `height`", gt=0
    )
    building_period: Time | None = key(None, "first period T_1 of the building; default 0.05 H^0.75", gt=0, source="EN 1998-1 Eq. 4.6")
    storeys: int | None = key(
        None,
        "number N of storeys of the building, for the modal participation; default: one storey for each 3 m of its height, rounded up",
        ge=1,
        le=50,
    )
    modes: list[Mode] = key(
        [],
        "modes of the building for the floor spectrum; default: the first mode only, linear over the height",
        source="Circ. 7/2019 C7.2.3",
        max_length=20,
    )
    period: Time | None = key(
        None,
        "period T_0 of a part that vibrates freely; default: calculated from `young` of [material], if given",
        gt=0,
        source="Circ. 7/2019 [C8.7.1.7]",
    )
    one_second_acceleration: Acceleration | None = key(
        None,
        "spectral acceleration S_X1. If given, the slenderness limits of ASCE 41 for walls anchored at their top are also checked",
        gt=0,
    )
    storey: Literal["one-story", "first", "top", "other"] = key("one-story", "position of the wall in the building, for ASCE 41")

    @model_validator(mode="after")
    def _one_building(self) -> "LocalMechanism":
        if self.modes and (given := sorted({"building_period", "storeys"} & self.model_fields_set)):
            raise ValueError(f"{given[0]}: remove this key, because the key `modes` already gives its value")
        return self

    @model_validator(mode="after")
    def _elevated(self) -> "LocalMechanism":
        if self.base_height and self.mechanism != "building" and self.building_height is None:
            raise ValueError("base_height above 0 needs building_height")
        return self

    def reckons_with(self, building: "Building") -> set[str]:
        """Joints, and a wall beside them, are of the stones that turn as the deck draws them."""
        found = super().reckons_with(building)
        if self.mechanism not in ("parapet", "gable", "chimney") or self.period is not None:
            found -= {"material.young"}
        return found if self.of_stones(building) else found - {"joints.friction", "supports.abutting_wall"}

    def of_stones(self, building: "Building") -> bool:
        """Whether the mechanism is that of the deck's stones, not of a body by itself or of the walls of a plan."""
        structure = building.structure
        return self.mechanism == "building" and (structure is None or "blocks" not in building.kind.lacks)
