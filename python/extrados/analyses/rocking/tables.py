"""Analysis kinds of the arch: rocking, failure domain, assessment."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.analyses.table import Animated, BuildingAnalysis
from extrados.building.properties import NO_SLIDING
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import Acceleration, Time
from extrados.schema.table import key


class RockingTable(BuildingAnalysis):
    """What all analyses by the single-degree-of-freedom mechanism ask."""

    view: ClassVar = "rocker"
    uses: ClassVar = ("material.density", "joints.restitution", "joints.friction", "initial.rotation_ratio")
    method: ClassVar = {"joints.friction": NO_SLIDING}
    form: Literal["nonlinear", "linear"] = key(
        "nonlinear", "full equations, or the linear form of slender blocks", source="Housner 1963"
    )


class Rocking(RockingTable, Animated):
    """Rocking of the single-degree-of-freedom mechanism, impacts and all, until collapse, rest or end time."""

    kind: Literal["rocking"]
    needs_motion: ClassVar = True
    end_time: Time | None = key(None, "when to stop; default the end of the motion and some time after", gt=0)
    output_step: Time = key(0.005, "spacing of the history", gt=0)
    tolerance: float = key(1e-8, "relative tolerance of the integrator", ge=1e-13, le=1e-3)
    thrust_line_times: list[Annotated[Time, Field(ge=0)]] = key(
        [], "draw the structure and its thrust line at these times", max_length=24
    )


class FailureDomain(RockingTable):
    """Which pulses bring an arch or a block down: Mode I (after an impact) and Mode II (without impact)."""

    kind: Literal["failure-domain"]
    pulse: Literal["step", "sine", "half-sine", "rectangular", "cosine", "ricker"] = key(
        "step", "step pulse of duration t_p, one sine of period T_p, or another shape of `pulse`", source="thesis 5.2.3"
    )
    durations: list[Annotated[Time, Field(gt=0)]] | None = key(
        None, "t_p or T_p; default 40 values scaled to the structure", min_length=1, max_length=2000
    )
    amplitudes: int = key(40, "number of amplitudes of the map", ge=2, le=2000)
    max_amplitude: Acceleration = key(1.5 * GRAVITY, "cap of the search", gt=0)
    accuracy: float = key(1e-4, "accuracy of the curves, in g (and of durations in s)", ge=1e-9, le=0.1)
    at_amplitudes: list[Annotated[Acceleration, Field(gt=0)]] = key(
        [], "also find the shortest failing durations at these amplitudes", max_length=200
    )


class Assessment(RockingTable):
    """Eq. 5.8: does the primary impulse of the motion fall above the failure curve of the arch?"""

    kind: Literal["assessment"]
    needs_motion: ClassVar = True
    impulses: int = key(3, "how many of the strongest impulses are tried", ge=1, le=20)
    min_period: Time | None = key(None, "shortest impulse sought; default 4 sampling steps", gt=0)
    max_period: Time = key(4.0, "longest impulse sought", gt=0)

    @model_validator(mode="after")
    def _range(self) -> "Assessment":
        if self.min_period is not None and self.min_period >= self.max_period:
            raise ValueError(f"min_period {self.min_period:g} s is not below max_period {self.max_period:g} s")
        return self
