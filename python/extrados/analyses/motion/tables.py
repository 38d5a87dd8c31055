"""Analysis kinds of ground motions alone: motion, shake-table."""

from typing import ClassVar, Literal

from pydantic import model_validator

from extrados.analyses.table import Analysis
from extrados.schema.quantities import Area, FlowRate, Force, Frequency, Length, Mass, Time, Velocity
from extrados.schema.table import key

INCH, POUND, GALLON = 0.0254, 0.45359237, 231.0 * 0.0254**3


class MotionStudy(Analysis):
    """Properties of a ground motion: peaks, intensity measures, spectra, pulses; figures, tables and export."""

    kind: Literal["motion"]
    starter: ClassVar = {"count": "10"}
    needs_motion: ClassVar = True
    count: int = key(100, "number of motions taken from a generated set", ge=1, le=1_000_000)
    dampings: list[float] = key([0.02, 0.05, 0.10], "damping ratios of the response spectra", min_length=1, max_length=8)
    shortest: Time = key(0.02, "shortest period of the spectra", ge=0.005)
    longest: Time = key(10.0, "longest period of the spectra", le=50)
    periods: int = key(200, "number of periods of the spectra; the ratio of neighbouring periods is constant", ge=10, le=4000)
    impulses: int = key(3, "number of impulses that are fitted, the strongest first", ge=1, le=20, source="thesis 5.3.2")
    max_period: Time = key(4.0, "longest period of the impulses searched", gt=0)
    export: list[Literal["AT2", "columns"]] = key(["AT2", "columns"], "formats in which the motion is written")

    @model_validator(mode="after")
    def _ranges(self) -> "MotionStudy":
        if self.longest <= self.shortest:
            raise ValueError("longest must be above shortest")
        if any(not 0.0 <= d < 1.0 for d in self.dampings):
            raise ValueError("dampings must be 0 or above, and below 1")
        return self


class ShakeTable(Analysis):
    """Can the table play the motion? Limits against frequency, drive displacement, scales that make it fit.

    The defaults are the table of thesis Appendix C.
    """

    kind: Literal["shake-table"]
    needs_motion: ClassVar = False
    stroke: Length = key(2.0 * INCH, "greatest displacement of the table in each sense", gt=0, source="thesis C.2")
    flow: FlowRate = key(0.75 * GALLON / 60.0, "flow of the pump", gt=0, source="thesis C.2")
    piston_area: Area = key(0.40 * INCH**2, "area of the actuator's piston", gt=0, source="thesis C.2")
    max_force: Force = key(1100.0 * POUND * 9.80665, "greatest force of the actuator", gt=0, source="thesis C.2")
    max_velocity: Velocity | None = key(None, "greatest velocity of a table without a pump; replaces `flow` and `piston_area`", gt=0)
    masses: list[Mass] = key(
        [500.0 * POUND, 1000.0 * POUND],
        "moving masses, each including the table; one capacity curve for each",
        min_length=1,
        max_length=10,
        source="thesis Fig. C-1",
    )
    lowest: Frequency = key(0.1, "lowest frequency of the capacity curves", gt=0)
    highest: Frequency = key(20.0, "highest frequency of the capacity curves", le=200)
    low_cut: Frequency = key(0.1, "corner frequency of the high-pass filter that removes drift from the drive signal", gt=0)
    keep: Literal["amplitude", "time"] = key(
        "amplitude",
        "method of fitting a motion that exceeds the limits. amplitude: the time is compressed; time: the amplitude is reduced",
        source="thesis 5.3.2",
    )
