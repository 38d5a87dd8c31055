"""Analysis kinds of the arch: rocking, failure domain, assessment."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.analyses.table import Animated, BuildingAnalysis
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import Acceleration, Time
from extrados.schema.table import key
from extrados.views.building import Building

#: What a rocking structure may be held by
HOLDS = ("[[ties]]", "[[dampers]]", "[[hinges]]", "[supports] abutting_wall")
#: What says of [supports] stiffness how the base gives way
SOFT_BASE = ("[supports] foundation", "[supports] damping_ratio")


def hand_over_cells() -> Any:
    """Key of analyses that draw a map."""
    return key(
        100,
        "greatest number of cells of the map that are continued with rigid contacts. These are the cells in which joints slide or "
        "hinges form outside the mechanism. If there are more of them, none is continued; 0: never",
        ge=0,
        le=1_000_000,
        source="Moreau 1988",
    )


class RockingTable(BuildingAnalysis):
    """What all analyses by the single-degree-of-freedom mechanism ask; soft_base: whether they follow a block on a base that
    gives way, too."""

    view: ClassVar = "rocker"
    uses: ClassVar = ("material.density", "joints.restitution", "joints.friction", "initial.rotation_ratio")
    beside: ClassVar = (
        "joints.energy_ratio",
        "initial.movements",
        "supports.abutting_wall",
        "supports.rebound",
        "supports.stiffness",
        "supports.foundation",
        "supports.damping_ratio",
    )
    considers: ClassVar[tuple[str, ...]] = HOLDS
    soft_base: ClassVar = False
    form: Literal["nonlinear", "linear"] = key(
        "nonlinear",
        "form of the equations of motion. nonlinear: full equations; linear: equations for slender blocks and small rotations",
        source="Housner 1963",
    )

    def rests_on(self, building: Building) -> dict[str, str | None]:
        """An energy ratio stands in place of the restitution; on a compliant base the impact follows from it; a wall
        throws back what falls against it."""
        found = super().rests_on(building)
        if building.supports.abutting_wall is not None:
            found.pop("joints.restitution", None)
            found["supports.rebound"] = "three impacts" if building.supports.rebound is None else None
        elif building.joints.energy_ratio is not None:
            found = {key.replace("restitution", "energy_ratio"): fixed for key, fixed in found.items()}
        if self.soft_base and building.supports.stiffness is not None:
            found.pop("joints.restitution", None)
            found |= {f"supports.{key}": None for key in ("stiffness", "foundation", "damping_ratio")}
        return found

    def reckons_with(self, building: Building) -> set[str]:
        """Two stacked blocks take impacts without rebound, whatever the deck says."""
        found = super().reckons_with(building)
        if building.structure is not None and building.structure.rocks_as == "stack":
            found.discard("joints.restitution")
        return found


class Rocking(RockingTable, Animated):
    """Rocking of the single-degree-of-freedom mechanism with impacts, until collapse, rest or the end time."""

    kind: Literal["rocking"]
    considers: ClassVar = (*HOLDS, *SOFT_BASE)
    soft_base: ClassVar = True
    needs_motion: ClassVar = True
    end_time: Time | None = key(None, "end of the run; default: the end of the motion plus the time to come to rest or to collapse", gt=0)
    output_step: Time = key(0.005, "spacing of the history", gt=0)
    tolerance: float = key(1e-8, "relative tolerance of the integrator", ge=1e-13, le=1e-3)
    hand_over: bool = key(
        True,
        "if joints slide or hinges form outside the rocking mechanism, continue the run with rigid "
        "contacts from that state; false leaves the outcome open",
        source="Moreau 1988",
    )
    thrust_line_times: list[Annotated[Time, Field(ge=0)]] = key(
        [], "times at which the structure and its thrust line are drawn", max_length=24
    )

    def rests_on(self, building: Building) -> dict[str, str | None]:
        """The friction of the deck, with which that of the motion is compared whatever acts on the structure."""
        return super().rests_on(building) | {"joints.friction": None}


class FailureDomain(RockingTable):
    """Pulses that cause collapse of an arch or a block: Mode I (after an impact) and Mode II (without impact)."""

    kind: Literal["failure-domain"]
    considers: ClassVar = (*HOLDS, *SOFT_BASE)
    soft_base: ClassVar = True
    pulse: Literal["step", "sine", "half-sine", "rectangular", "cosine", "ricker"] = key(
        "step",
        "shape of the pulse: step pulse of duration t_p, single sine of period T_p, or another shape of `pulse`",
        source="thesis 5.2.3",
    )
    durations: list[Annotated[Time, Field(gt=0)]] | None = key(
        None, "durations t_p or periods T_p; default: 40 values scaled to the structure", min_length=1, max_length=2000
    )
    amplitudes: int = key(40, "number of amplitudes of the map", ge=2, le=2000)
    max_amplitude: Acceleration = key(1.5 * GRAVITY, "greatest amplitude of the search", gt=0)
    accuracy: float = key(1e-4, "accuracy of the failure curves, in g for amplitudes and in s for durations", ge=1e-9, le=0.1)
    hand_over_cells: int = hand_over_cells()
    at_amplitudes: list[Annotated[Acceleration, Field(gt=0)]] = key(
        [], "also find the shortest durations that cause collapse at these amplitudes", max_length=200
    )


class FailureCurves(RockingTable):
    """Failure curves of several structures, or for trains of sines, in one figure with the primary impulses of the motions."""

    kind: Literal["failure-curves"]
    considers: ClassVar = (*HOLDS, *SOFT_BASE)
    soft_base: ClassVar = True
    variants: list[dict[str, int | float | str]] = key(
        [],
        "changes of [structure], with one failure curve for each, such as `{ radius = 5.0 }`; default: only the structure of the deck",
        max_length=24,
    )
    pulse: Literal["step", "sine", "half-sine", "rectangular", "cosine", "ricker"] = key(
        "sine", "shape of the pulses", source="thesis Figs 5-4, 5-5, 5-15"
    )
    cycles: list[Annotated[int, Field(ge=1, le=100)]] = key(
        [1], "numbers of cycles of a train of sines, with one failure curve for each", min_length=1, max_length=12, source="thesis 5.3.4"
    )
    durations: list[Annotated[Time, Field(gt=0)]] | None = key(
        None, "durations t_p or periods T_p; default: `count` values scaled to each structure", min_length=2, max_length=2000
    )
    count: int = key(40, "number of durations of each failure curve, if `durations` is not given", ge=2, le=2000)
    amplitudes: int = key(
        60, "number of amplitudes up to `max_amplitude` that are tried; the lowest one that causes collapse is then refined", ge=2, le=2000
    )
    max_amplitude: Acceleration = key(1.5 * GRAVITY, "greatest amplitude of the search", gt=0)
    accuracy: float = key(1e-4, "accuracy of the failure curves, in g", ge=1e-9, le=0.1)
    motions: int = key(12, "greatest number of motions of a suite or a generated set that the figure shows", ge=1, le=200)
    max_period: Time = key(4.0, "longest period of a primary impulse", gt=0)
    fits: bool = key(
        False,
        "for arches: also fit Eq. 5.5 of the thesis to each curve, and apply the criterion of Eq. 5.8 with Table 5.3",
        source="thesis Fig. 5-14",
    )

    @model_validator(mode="after")
    def _trains(self) -> "FailureCurves":
        if self.pulse != "sine" and self.cycles != [1]:
            raise ValueError(
                f"the key `cycles` is only for sine pulses, and a pulse of shape '{self.pulse}' has one cycle: remove `cycles`"
            )
        if self.fits and (self.pulse != "sine" or self.cycles != [1]):
            raise ValueError(
                'the key `fits` requires failure curves of single sines: give pulse = "sine" and cycles = [1], or remove `fits`'
            )
        if len(set(self.cycles)) < len(self.cycles):
            raise ValueError("cycles holds a number twice")
        if max(1, len(self.variants)) * len(self.cycles) > 24:
            raise ValueError("variants times cycles give more than 24 curves, the most that a figure can show: give fewer")
        return self


class Assessment(RockingTable):
    """Comparison of the primary impulse of the motion with the failure curve of the arch (thesis Eq. 5.8)."""

    kind: Literal["assessment"]
    considers: ClassVar = ()
    needs_motion: ClassVar = True
    impulses: int = key(3, "number of impulses that are checked, the strongest first", ge=1, le=20)
    min_period: Time | None = key(None, "shortest period of the impulses searched; default: 4 time steps", gt=0)
    max_period: Time = key(4.0, "longest period of the impulses searched", gt=0)

    @model_validator(mode="after")
    def _range(self) -> "Assessment":
        if self.min_period is not None and self.min_period >= self.max_period:
            raise ValueError(f"min_period = {self.min_period:g} s is not below max_period = {self.max_period:g} s")
        return self
