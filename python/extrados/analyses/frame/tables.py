"""The deck tables of frames of macro-elements."""

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from extrados import kinds
from extrados.analyses.codes.tables import Verification
from extrados.analyses.table import BuildingAnalysis
from extrados.model.structures.plan import Plan
from extrados.schema.quantities import Angle, Time
from extrados.schema.table import key
from extrados.views.frame.options import FrameOptions

if TYPE_CHECKING:
    from extrados.views.building import Building

#: Properties of the building that frames use
ELASTIC = ("material.density", "material.young", "material.poisson")
STRENGTHS = ("material.compressive_strength", "joints.cohesion")
#: Uncertain values: of the masonry, and of [analysis.frame]
MASONRY = ("density", "young", "compressive_strength")
OPTIONS = ("diagonal_strength", "friction", "drift_flexure", "drift_shear", "stiffness")
#: All of them; `strength` is one factor on all strengths of the masonry
UNCERTAIN = (*MASONRY, "strength", "cohesion", *OPTIONS, "floor_stiffness")


class FrameAnalysis(BuildingAnalysis):
    """Base of the analyses of frames."""

    view: ClassVar = "frame"
    structures: ClassVar = tuple(kind for kind, parts in kinds.STRUCTURES.items() if isinstance(parts.frame, str))
    uses: ClassVar[tuple[str, ...]] = (*ELASTIC, *STRENGTHS)
    starter_structure: ClassVar = "building"
    frame: FrameOptions = key(FrameOptions(), "properties of piers and spandrels, [analysis.frame]")

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """A cohesion that the key of the frame replaces is not among them."""
        found = super().rests_on(building)
        if self.frame.cohesion is not None:
            found.pop("joints.cohesion", None)
        return found

    def reckons_with(self, building: "Building") -> set[str]:
        """Also the strength of tie rods and ring beams, where [material] gives none that this analysis neglects."""
        found = super().reckons_with(building)
        plan = building.structure
        tied = isinstance(plan, Plan) and (plan.rods or plan.ring_beams)
        if tied and "joints.cohesion" in self.uses and building.material.tensile_strength is None:
            found |= {"material.tensile_strength", "material.fracture_energy"}
        return found


class FrameModes(FrameAnalysis):
    """Periods, mode shapes and participating masses of a building under its weight, as a frame of macro-elements."""

    kind: Literal["frame-modes"]
    uses: ClassVar = ELASTIC
    modes: int = key(6, "number of modes", ge=1, le=100)


class Modes(BuildingAnalysis):
    """Natural frequencies, mode shapes and participating masses of an arch, a vault or other plane blocks with closed joints."""

    kind: Literal["modes"]
    view: ClassVar = "blocks"
    uses: ClassVar = (*ELASTIC, "joints.normal_stiffness", "joints.shear_stiffness", "joints.shear_ratio")
    starter_structure: ClassVar = "arch"
    modes: int = key(6, "number of modes", ge=1, le=100)


class FramePushover(FrameAnalysis):
    """Pushover of a building as a frame of macro-elements, in several directions and senses, with several patterns and eccentricities."""

    kind: Literal["frame-pushover"]
    directions: list[Annotated[Angle, Field(ge=-360, le=360)]] = key(
        [0.0, 90.0], "directions of the load in plan, counter-clockwise from x", min_length=1, max_length=8
    )
    senses: list[Literal["+", "-"]] = key(["+", "-"], "senses of the load in each direction", min_length=1, max_length=2)
    patterns: list[Literal["uniform", "static", "modal"]] = key(
        ["uniform", "static"],
        "patterns of the horizontal forces. uniform: in proportion to the masses; static: in proportion to the masses times their "
        "height; modal: in proportion to the masses times the mode with the greatest participating mass",
        min_length=1,
        max_length=3,
        source="NTC 2018, 7.3.4.2",
    )
    eccentricities: list[Annotated[float, Field(ge=-0.5, le=0.5)]] = key(
        [0.0, 0.05, -0.05],
        "accidental eccentricities of the horizontal forces, each divided by the length of the building perpendicular to the load",
        min_length=1,
        max_length=9,
        source="EN 1998-1, 4.3.2",
    )
    verification: Verification = key(Verification(), "verification by displacement, [analysis.verification]")
    out_of_plane: bool = key(
        True,
        "with a seismic action: check each wall, above the foot of each storey, for out-of-plane failure "
        "by `local-mechanism`. The floor spectrum uses the period of the frame",
    )
    deflected_walls: bool = key(
        True,
        "calculate the greatest constant acceleration that each wall carries out of its plane, with "
        "cracking, crushing and second-order effects of its deflection between rigid floors",
        source="after Vanin, Penna and Beyer 2020",
    )
    control_level: int | None = key(
        None,
        "number of the control storey. The control displacement is the mean displacement at the top of "
        "this storey, weighted by the masses; default: the highest storey with masses",
        ge=1,
    )
    target_drift: float = key(0.02, "greatest control displacement, divided by the height of the control level", gt=0, le=0.2)
    steps: int = key(200, "number of steps up to the target; a step is divided if necessary", ge=10, le=10_000)
    drop: float = key(
        0.5,
        "share of the greatest base shear: the run ends when the base shear drops below this share; 0.8 is the 20 % decrease of codes",
        ge=0,
        le=0.95,
    )

    @model_validator(mode="after")
    def _once(self) -> "FramePushover":
        for name in ("directions", "senses", "patterns", "eccentricities"):
            values = getattr(self, name)
            if len(set(values)) < len(values):
                raise ValueError(f"{name}: each value may occur only once, found {values}")
        return self


class FrameMotion(FrameAnalysis):
    """Base of the analyses of frames in motion."""

    needs_motion: ClassVar = True
    direction: Angle = key(0.0, "direction of the ground motion in plan, counter-clockwise from x", ge=-360, le=360)
    time_step: Time = key(0.005, "time step of the integration; a step is divided if necessary", gt=0, le=0.1)
    damping_ratio: float = key(0.03, "damping ratio of the Rayleigh damping at its two frequencies", ge=0, le=0.5)
    damping_frequencies: list[Annotated[float, Field(gt=0)]] | None = key(
        None,
        "two frequencies in Hz at which the damping ratio applies; default: the first frequency along "
        "the motion, and three times this value",
        min_length=2,
        max_length=2,
    )


class FrameHistory(FrameMotion):
    """Response of a building under a ground motion, as a frame of macro-elements, by Newmark's method."""

    kind: Literal["frame-history"]
    starter_motion: ClassVar = "sine-pulse"
    end_time: Time | None = key(None, "end of the calculation; default: the end of the motion plus two seconds", gt=0)


class FrameFragility(FrameMotion):
    """Fragility of a building as a frame of macro-elements over many motions, with uncertain materials, drift limits and floors."""

    kind: Literal["frame-fragility"]
    starter_motion: ClassVar = "generated"
    by: Literal["history", "pushover"] = key(
        "history",
        "method. history: response of the frame to each record; pushover: N2 with the spectrum of each "
        "record, for the capacity curves in both senses",
        source="Fajfar 2000",
    )
    patterns: list[Literal["uniform", "static", "modal"]] = key(
        ["uniform", "static"], 'for by = "pushover": patterns of the horizontal forces, as in `frame-pushover`', min_length=1, max_length=3
    )
    target_drift: float = key(
        0.02, 'for by = "pushover": greatest control displacement, divided by the height of the highest level', gt=0, le=0.2
    )
    count: int | None = key(None, "number of motions; default 100, or the whole set", ge=2, le=1_000_000)
    seed: int | None = key(
        None,
        "seed of the random numbers, for the uncertain values and for a generated set of motions; replaces the seed in [motion]",
        ge=0,
        le=2**62,
    )
    intensity: Literal["pga", "sa"] = key("pga", "intensity measure of the motions. pga: PGA [g]; sa: SA(`sa_period`) [g]")
    sa_period: Time | None = key(None, "period of SA", gt=0)
    levels: list[Annotated[float, Field(gt=0, le=100)]] | None = key(
        None,
        'for by = "history": intensities [g] to which each motion is scaled; default: the motions are not scaled',
        min_length=1,
        max_length=200,
    )
    uncertain: dict[str, float] = key(
        {},
        "coefficients of variation of "
        + ", ".join(f"`{name}`" for name in UNCERTAIN)
        + (
            ". Each factor is lognormal with a mean of 1, applies to the whole building and is sampled by a Sobol sequence; "
            "`strength` multiplies all strengths of the masonry"
        ),
    )
    confidence: float = key(0.95, "confidence level of all intervals", gt=0, lt=1)
    bootstrap: int = key(500, "number of bootstrap samples for the confidence intervals of the curves", ge=0, le=100_000)

    @model_validator(mode="after")
    def _sensible(self) -> "FrameFragility":
        if (self.intensity == "sa") != (self.sa_period is not None):
            raise ValueError('intensity = "sa" requires `sa_period`, and `sa_period` requires intensity = "sa"')
        if self.by == "pushover" and self.levels is not None:
            raise ValueError(
                'the key `levels` is used only with by = "history", because N2 calculates the intensity at which '
                "each motion reaches a limit state: remove `levels`"
            )
        for name, value in self.uncertain.items():
            if name not in UNCERTAIN:
                raise ValueError(f"uncertain.{name} is unknown; expected {', '.join(UNCERTAIN)}")
            if not 0.0 < value <= 1.0:
                raise ValueError(f"uncertain.{name} is {value:g}, expected a coefficient of variation above 0, at most 1")
        return self
