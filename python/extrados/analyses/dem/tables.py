"""Analysis kinds of the discrete elements: dem, dem-domain, dem-fragility, dem-parameters."""

import itertools
import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.analyses.statistics.tables import Hazard, Level, levels_in_units
from extrados.analyses.table import Animated, BuildingAnalysis
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import Acceleration, Angle, Density, Gravities, Length, Time
from extrados.schema.table import Table, key

if TYPE_CHECKING:
    from extrados.views.building import Building

#: Properties of a building that rigid contacts do not look at
SPRINGS = ("material.young", "joints.normal_stiffness", "joints.damping")
#: What says how stiff and damped springs are
OF_SPRINGS = {"material.young"} | {
    f"joints.{name}"
    for name in (
        "normal_stiffness",
        "stiffness_rule",
        "shear_stiffness",
        "shear_ratio",
        "damping",
        "damping_ratio",
        "beta",
        "restitution",
        "energy_ratio",
    )
}
#: Time step over the critical one. In space mirrored columns differ by 0.5 % of the displacement after their impacts at 0.6
IN_PLANE, IN_SPACE = 0.3, 0.5
Positive = Annotated[float, Field(gt=0.0)]


def of_springs(building: "Building") -> set[str]:
    """What of OF_SPRINGS counts: a value that is given goes before the rule that would make one."""
    joints, found = building.joints, set(OF_SPRINGS)
    if joints.normal_stiffness is not None:
        found -= {"material.young", "joints.stiffness_rule"}
    if joints.shear_stiffness is not None:
        found.discard("joints.shear_ratio")
    if joints.beta is not None:
        found -= {"joints.damping", "joints.damping_ratio"}
    if joints.beta is None and joints.damping == "restitution":
        return found - {"joints.damping_ratio"}
    return found - {"joints.restitution", "joints.energy_ratio"}


class DemTable(BuildingAnalysis):
    """What all analyses with discrete elements ask."""

    considers: ClassVar = ("[[ties]]", "[[dampers]]")

    uses: ClassVar = (
        "material.density",
        "material.young",
        "joints.friction",
        "joints.cohesion",
        "joints.tension",
        "joints.normal_stiffness",
        "joints.damping",
    )
    beside: ClassVar = (
        "joints.shear_stiffness",
        "joints.shear_ratio",
        "joints.stiffness_rule",
        "joints.damping_ratio",
        "joints.beta",
        "joints.restitution",
        "joints.energy_ratio",
        "joints.worn_corners",
        "supports.stiffness",
        "initial.rotation_ratio",
        "initial.movements",
    )
    solver: Literal["compliant", "nonsmooth"] = key(
        "compliant",
        "model of the joints. compliant: springs and dashpots; nonsmooth: rigid contacts without overlap "
        "or tension (Moreau 1988, Jean 1999). Rigid contacts require no stiffness and no damping, and "
        "allow large time steps. Each model can be used to check the other",
    )
    rebound: float = key(
        0.0,
        "for solver = \"nonsmooth\": Newton's coefficient of restitution at each contact point; 0 gives the energy loss of Housner's block",
        ge=0,
        le=1,
    )
    mass_damping: float = key(0.0, "mass-proportional damping alpha in 1/s; not physical for rocking blocks", ge=0, le=1e4)
    merge: Literal["none", "three-bars"] = key(
        "none", "three-bars: the voussoirs of an arch are merged into the three rigid bars of its four-hinge mechanism"
    )
    fraction: float | None = key(
        None, "time step, as a fraction of the critical time step. Default: 0.3 in the plane, 0.5 in space", gt=0, le=0.9
    )
    time_step: Time | None = key(
        None,
        'time step. Default: `fraction` times the critical time step; for solver = "nonsmooth", 1/500 of '
        "the time of free fall over the size of the smallest block",
        gt=0,
    )
    floor: Length | None = key(
        None,
        "height of a level floor on which detached blocks land and slide. Default: no floor; each joint to the ground has a footing "
        "that extends beyond the joint by a quarter of its length on both sides",
    )

    @property
    def rigid(self) -> bool:
        """Without springs?"""
        return self.solver == "nonsmooth"

    def step_fraction(self, *, space: bool) -> float:
        """The time step over the critical one."""
        return self.fraction or (IN_SPACE if space else IN_PLANE)

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """As it says: rigid contacts do not ask how stiff and damped they are."""
        told = super().rests_on(building)
        return {key: fixed for key, fixed in told.items() if not (self.rigid and key in SPRINGS)}

    def reckons_with(self, building: "Building") -> set[str]:
        """Rigid contacts refuse a compliant base, and look at nothing else that springs have."""
        found = {*self.uses, *self.beside} - OF_SPRINGS
        return found if self.rigid else found | of_springs(building)

    @model_validator(mode="after")
    def _one_solver(self) -> "DemTable":
        """What only the other solver knows is refused."""
        given = self.model_fields_set
        if self.rigid and (wrong := sorted(given & {"mass_damping", "fraction", "vary_damping", "vary_stiffness", "crushing"})):
            raise ValueError(f'{wrong[0]} is used only with solver = "compliant": rigid contacts have no stiffness and no damping')
        if not self.rigid and (wrong := sorted(given & {"rebound", "quasi_static"})):
            raise ValueError(f'{wrong[0]} needs solver = "nonsmooth"')
        return self


class SpatialDem(DemTable):
    """What looks at sections and at solids."""

    solid: ClassVar = True
    direction: Angle | None = key(
        None,
        "direction of the horizontal motion or load in plan: angle from +x towards +y. If this key is "
        "given, or if the structure has no plane section, the blocks are solids",
        ge=-360,
        le=360,
    )

    crushing: bool = key(
        False,
        "crushing at the corners of joints: the pressure is at most the compressive strength of the material, which moves hinges "
        "inward. Only for springs, without mortar",
    )

    @property
    def way(self) -> tuple[float, float, float]:
        """Unit vector of the horizontal motion."""
        turn = math.radians(self.direction or 0.0)
        return (math.cos(turn), math.sin(turn), 0.0)

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """Corners that crush depend on the strength."""
        return {**super().rests_on(building), **({"material.compressive_strength": None} if self.crushing else {})}

    def reckons_with(self, building: "Building") -> set[str]:
        """Corners crush at the strength of the material."""
        return super().reckons_with(building) | ({"material.compressive_strength"} if self.crushing else set())


class Water(Table):
    """Still water on one side of a plane section: constant pressure on the faces that it reaches, and in joints below its level."""

    level: Length = key(about="height of the water surface, in the coordinates of the structure")
    side: Literal["left", "right"] = key("left", "side of the structure on which the water is; left: towards -x")
    uplift: Literal["none", "linear", "full"] = key(
        "full",
        "pressure in joints below the water surface. full: pressure of the water at the same height; linear: this pressure at the wet "
        "face, decreasing along horizontal lines to zero at the other face of the section; none: zero",
    )
    density: Density = key(1000.0, "density of the water", gt=0)


class Dem(SpatialDem, Animated):
    """Discrete elements: rigid blocks that rock, hinge, slide and fall (thesis chapter 7)."""

    starter_motion: ClassVar = "step-pulse"
    kind: Literal["dem"]
    quasi_static: bool = key(False, 'for solver = "nonsmooth": neglect inertia, to follow large displacements of supports up to collapse')
    test: Literal["motion", "tilt"] = key(
        "motion", "type of the test. motion: the motion acts; tilt: find the constant acceleration that causes collapse"
    )
    end_time: Time | None = key(
        None,
        "end of the run. Default: the end of the motion plus the time to come to rest or to collapse; the run ends "
        "earlier if all blocks are at rest",
        gt=0,
    )
    output_step: Time = key(0.01, "spacing of the history", ge=1e-6)
    base: Literal["body-force", "moving"] = key(
        "body-force",
        "representation of the ground motion. body-force: inertia forces on the blocks; moving: the ground moves. Both "
        "give the same result",
    )
    collapse_displacement: Length | None = key(
        None,
        "displacement of a block that counts as collapse if the block also rotates or loses height (in a "
        "tilt test, also if it slides). Default: 1/5 of the size of the structure; in a tilt test, 1/20",
        gt=0,
    )
    domain: float = key(
        10.0, "distance of a block from the structure at which the run ends, divided by the size of the structure", gt=1, le=1000
    )
    stop_at_collapse: bool = key(True, "end the run when a block has moved by the collapse displacement")
    perturbed: bool = key(
        True,
        "repeat the run with the motion times 1 + 1e-6, to find whether the response is chaotic. The analysis then takes twice the "
        "time, or ten times the time if the perturbation grows a thousandfold",
    )
    thrust: bool = key(
        False,
        "also calculate the place of the force in each joint and the stress at its ends or corners; drawings and the film show these forces",
    )
    water: Water | None = key(
        None,
        "water on one side of a plane section, also if this section is drawn out to solids. Its forces are calculated for the structure at "
        "rest; their directions and values do not change as blocks move",
    )
    track: list[str] = key([], "names of the blocks whose rotation is recorded; default: all, at most 24", max_length=200)
    snapshot_times: list[Time] = key([], "times at which the structure is drawn; default: six characteristic times", max_length=24)
    vtk: bool = key(False, "write VTU files and a PVD collection")
    vary_damping: list[Positive] = key(
        [], "repeat the run with beta (stiffness-proportional damping) multiplied by each of these factors", max_length=50
    )
    vary_stiffness: list[Positive] = key([], "repeat the run with joint stiffnesses multiplied by each of these factors", max_length=50)
    vary_friction: list[Positive] = key(
        [], "repeat the run with each of these coefficients of friction at all joints, including those of [[joints.types]]", max_length=50
    )
    find_friction: bool = key(False, "also find the least coefficient of friction, equal at all joints, at which no joint slides")
    slip: Length = key(1e-4, "slip that counts as sliding, in the search for the least coefficient of friction", gt=0)
    tilt_limit: Acceleration = key(2.0 * GRAVITY, "greatest acceleration in the tilt test", gt=0)
    tilt_accuracy: Gravities = key(1e-3, "accuracy of the collapse acceleration in the tilt test", ge=1e-6, le=0.1)

    @model_validator(mode="after")
    def _places_of_forces(self) -> "Dem":
        if self.thrust and self.crushing:
            raise ValueError("the key `thrust` assumes elastic springs, which do not crush: remove `thrust` or `crushing`")
        return self

    @property
    def has_rates(self) -> bool:
        """A tilt test finds the force at which no equilibrium is left, and a quasi-static run follows states of equilibrium."""
        return self.test == "motion" and not self.quasi_static


class DemDomain(SpatialDem):
    """Discrete elements: pulses that cause collapse. Failure curves of the four-hinge mechanism are compared where they exist."""

    kind: Literal["dem-domain"]
    starter_structure: ClassVar = "block"
    starter: ClassVar = {"amplitudes": '["0.5 g", "0.7 g"]', "durations": "[0.2, 0.4, 0.8]", "accuracy": "0.02"}
    pulse: Literal["step", "sine"] = key("step", "shape of the pulse: step pulse of duration t_p, or a single sine of period T_p")
    amplitudes: list[Acceleration] = key(
        about="amplitudes of the pulses; at each, the shortest duration that causes collapse is searched", min_length=1, max_length=200
    )
    durations: list[Time] = key(about="durations that are tried first, in increasing order", min_length=2, max_length=500)
    accuracy: Time = key(0.005, "accuracy of the shortest durations that cause collapse", ge=1e-6)
    settle: Time | None = key(None, "time after the pulse in which the structure must come to rest or collapse", gt=0)
    collapse_displacement: Length | None = key(
        None,
        "displacement of a block that counts as collapse, if the block also rotates or loses height; default: 1/5 of the "
        "size of the structure",
        gt=0,
    )
    mode_II: bool = key(
        False,
        "also calculate the shortest pulses that cause collapse in the first swing, before any impact. "
        'With merge = "three-bars", the curve of the four-hinge model is given for comparison',
        source="thesis Fig. 7-11",
    )
    cross_check: bool = key(
        False,
        "also calculate the failure curve with the other solver, and the share of cells (pairs of amplitude and duration) with the "
        "same outcome",
    )
    vary_damping: list[Positive] = key(
        [], "also calculate failure curves with beta (stiffness-proportional damping) multiplied by each of these factors", max_length=20
    )
    vary_stiffness: list[Positive] = key(
        [], "also calculate failure curves with joint stiffnesses multiplied by each of these factors", max_length=20
    )
    vary_friction: list[Positive] = key(
        [],
        "also calculate failure curves with each of these coefficients of friction at all joints, including those of [[joints.types]]",
        max_length=20,
    )

    @model_validator(mode="after")
    def _ascending(self) -> "DemDomain":
        if any(b <= a for a, b in itertools.pairwise(self.durations)) or self.durations[0] <= 0.0:
            raise ValueError("`durations` must be above zero and increase")
        if min(self.amplitudes) <= 0.0:
            raise ValueError("amplitudes must be above zero")
        return self

    def reckons_with(self, building: "Building") -> set[str]:
        """Beside an arch stands its four-hinge curve; a check by the other solver looks at springs, too."""
        found = super().reckons_with(building) | (of_springs(building) if self.cross_check else set())
        arch = self.direction is None and building.structure is not None and building.structure.kind == "arch"
        return found | {"joints.restitution"} if arch else found


class DemFragility(SpatialDem):
    """Discrete elements under many motions: probability of collapse at levels of an intensity, or for several sizes of the structure."""

    kind: Literal["dem-fragility"]
    needs_motion: ClassVar = True
    starter_structure: ClassVar = "block"
    starter_motion: ClassVar = "generated"
    starter: ClassVar = {"count": "4", "levels": '["0.3 g", "0.6 g"]'}
    count: int | None = key(None, "number of motions; default: 100, or the whole set", ge=1, le=1_000_000)
    seed: int | None = key(
        None,
        "seed of the random numbers, for the uncertain values and for a generated set of motions; replaces the seed in [motion]",
        ge=0,
        le=2**62,
    )
    intensity: Literal["pga", "sa", "arias", "scale", "size"] = key(
        "pga",
        "quantity of the levels. pga: PGA [g]; sa: SA(sa_period) [g]; arias: Arias intensity [m/s]; scale: factor of the motions; size: "
        "factor of all lengths of [structure] under the unscaled motions, as in a rocking spectrum",
    )
    levels: list[Level] = key(
        about='levels of the intensity: numbers in the unit of the measure, or text such as "0.1 g"', min_length=1, max_length=100
    )
    sa_period: Time | None = key(None, "period of SA", gt=0)
    sa_damping: float = key(0.05, "damping ratio of SA", ge=0, lt=1)
    hazard: Hazard | None = key(None, "hazard curve of the site, from which the annual rate of collapse is calculated")
    uncertain: dict[str, float] = key(
        {},
        "coefficients of variation of any length of [structure]; of the `friction` of all joints together; of `stiffness` and "
        "`damping` of springs; of the `density` of each block. `imperfection`, for plane sections: deviation of corners and joints of "
        "blocks, divided by the shortest joint. The values are sampled by a Sobol sequence, with one building for each motion",
    )
    settle: Time | None = key(
        None, "time after the motion in which the blocks must come to rest or collapse; default: 15 times the root of size / g", ge=0
    )
    output_step: Time = key(0.01, "interval at which openings, slips and displacements are recorded", ge=1e-6)
    collapse_displacement: Length | None = key(
        None,
        "displacement of a block that counts as collapse, if the block also rotates or loses height; default: 1/5 of the "
        "size of the structure",
        gt=0,
    )
    confidence: float = key(0.95, "confidence level of all intervals", gt=0, lt=1)
    bootstrap: int = key(500, "number of bootstrap samples for the band of the fitted curve", ge=0, le=100_000)

    @model_validator(mode="before")
    @classmethod
    def _units(cls, data: Any) -> Any:
        """Levels and intensities given as text, in the unit of their measure."""
        return levels_in_units(data) if isinstance(data, dict) else data

    @model_validator(mode="after")
    def _sensible(self) -> "DemFragility":
        if min(self.levels) <= 0.0:
            raise ValueError("levels must be above zero")
        if len(set(self.levels)) < len(self.levels):
            raise ValueError("levels: the same level is given twice")
        if (self.intensity == "sa") != (self.sa_period is not None):
            raise ValueError('intensity = "sa" requires sa_period, and sa_period requires intensity = "sa"')
        if self.hazard is not None and self.intensity in ("scale", "size"):
            raise ValueError('a hazard curve requires the intensity "pga", "sa" or "arias"')
        for name, value in self.uncertain.items():
            if not 0.0 < value <= 0.5:
                raise ValueError(f"uncertain.{name} is {value:g}, expected a coefficient of variation above 0, at most 0.5")
        return self

    def reckons_with(self, building: "Building") -> set[str]:
        """The blocks start at rest on supports that move with the ground alone."""
        return super().reckons_with(building) - {"initial.rotation_ratio", "initial.movements"}


class DemParameters(DemTable):
    """Joint stiffnesses, impact frequencies and damping by the rules of thesis 7.3, without a run."""

    kind: Literal["dem-parameters"]

    def reckons_with(self, building: "Building") -> set[str]:
        """What stiffens and damps joints across them: nothing moves."""
        shear = {"joints.shear_stiffness", "joints.shear_ratio"}
        return {"material.density", "supports.stiffness", *of_springs(building)} - shear
