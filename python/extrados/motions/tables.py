"""Motion kinds: positive ground acceleration points to +x."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.schema.quantities import Acceleration, Angle, Frequency, Time, Velocity
from extrados.schema.spectrum import TargetSpectrum
from extrados.schema.table import Motion, Table, key


class Constant(Motion):
    """Constant ground acceleration from time zero."""

    kind: Literal["constant"]
    amplitude: Acceleration = key(about="ground acceleration")
    duration: Time = key(10.0, "how long it acts", gt=0)


class StepPulse(Motion):
    """Amplitude for the duration, then minus half of it for twice as long (no velocity is left)."""

    kind: Literal["step-pulse"]
    amplitude: Acceleration = key(about="a_p, of the first part")
    duration: Time = key(about="t_p, of the first part", gt=0)


class SinePulse(Motion):
    """One full cycle of a sine."""

    kind: Literal["sine-pulse"]
    amplitude: Acceleration = key(about="A_p")
    period: Time = key(about="T_p", gt=0)


class Harmonic(Motion):
    """Harmonic motion; amplitude constant, growing over `ramp`, or under a sinusoidal carrier (thesis 5.3.2)."""

    kind: Literal["harmonic"]
    amplitude: Acceleration = key(about="greatest amplitude")
    frequency: Frequency = key(about="in Hz, not rad/s", gt=0, le=1000)
    duration: Time = key(10.0, "how long it acts", gt=0)
    phase: Literal["sine", "cosine"] = key("sine", "starts at zero (sine) or at the amplitude (cosine)")
    ramp: Time = key(0.0, "the amplitude grows linearly from zero over this time", ge=0)
    carrier: Frequency | None = key(None, "frequency of a sinusoidal carrier that modulates the amplitude", gt=0, le=1000)

    @model_validator(mode="after")
    def _one_envelope(self) -> "Harmonic":
        if self.ramp > 0.0 and self.carrier is not None:
            raise ValueError("give ramp or carrier, not both")
        return self


class Pulse(Motion):
    """A single pulse of another shape; `sine-pulse` and `step-pulse` are kinds of their own."""

    kind: Literal["pulse"]
    starter: ClassVar = {"shape": '"ricker"'}
    shape: Literal["rectangular", "half-sine", "cosine", "ricker"] = key(
        about="constant; half a sine of the period; one full cosine; the symmetric Ricker wavelet"
    )
    amplitude: Acceleration = key(about="greatest acceleration")
    period: Time = key(about="full period T_p (half-sine lasts half of it); duration of a rectangular pulse", gt=0)


class VelocityPulse(Motion):
    """Near-fault pulse: a cosine of the velocity under a cosine bell."""

    kind: Literal["velocity-pulse"]
    starter: ClassVar = {"velocity": '"60 cm/s"', "period": "1.0"}
    velocity: Velocity = key(about="amplitude A of the velocity", source="Mavroeidis and Papageorgiou 2003")
    period: Time = key(about="prevailing period T_p", gt=0)
    cycles: float = key(1.5, "gamma, number of cycles under the bell", gt=1, le=50)
    phase: Angle = key(0.0, "nu, phase of the cosine; 0 symmetric, 90 antisymmetric")


class Treated(Motion):
    """What may be done to records, in this order: time_scale, filter, baseline, resampling, scaling, scale."""

    time_step: Time | None = key(None, "sampling step where the file has none", ge=1e-4, le=10)
    unit: Literal["g", "m/s^2", "cm/s^2", "mm/s^2", "gal", "mg", "in/s^2"] | None = key(None, "unit where the file has none")
    columns: Literal["series", "components"] | None = key(
        None, "a file of several columns without time: its rows are one series, or each column is a component; `channel` says which"
    )
    scale: float = key(1.0, "factor on the acceleration, last of all")
    time_scale: float = key(1.0, "factor on the time axis; accelerations keep their size", gt=0)
    low_cut: Frequency | None = key(None, "lower corner of a zero-phase Butterworth filter", gt=0)
    high_cut: Frequency | None = key(None, "upper corner of a zero-phase Butterworth filter", gt=0)
    baseline: Literal["none", "mean", "linear", "quadratic", "cubic"] = key(
        "none", "degree of the acceleration's trend that is taken off, fitted to the velocity"
    )
    resample: Time | None = key(None, "new sampling step", gt=0)
    pga: Acceleration | None = key(
        None, "scale to this peak of the horizontal acceleration in the plane; one factor for all components", gt=0
    )
    pgv: Velocity | None = key(None, "scale to this peak velocity, measured and applied like pga", gt=0)
    arias: Velocity | None = key(None, "scale to this Arias intensity, measured and applied like pga", gt=0)
    sa: Acceleration | None = key(None, "scale to this pseudo-acceleration at sa_period, measured and applied like pga", gt=0)
    sa_period: Time | None = key(None, "period for sa", gt=0)
    sa_damping: float = key(0.05, "damping ratio for sa", ge=0, le=0.5)

    @model_validator(mode="after")
    def _one_target(self) -> "Treated":
        if sum(v is not None for v in (self.pga, self.pgv, self.arias, self.sa)) > 1:
            raise ValueError("give one of pga, pgv, arias and sa")
        if (self.sa is None) != (self.sa_period is None):
            raise ValueError("sa and sa_period go together")
        if self.low_cut is not None and self.high_cut is not None and self.low_cut >= self.high_cut:
            raise ValueError(f"low_cut {self.low_cut:g} Hz is not below high_cut {self.high_cut:g} Hz")
        return self


class Components(Table):
    """Where the components of one record lie: one horizontal, perhaps the other, perhaps the vertical."""

    file: str = key(about="path inside the deck's folder, or `extrados:NAME` for a shipped record", min_length=1, max_length=1024)
    channel: int | str | None = key(None, "which channel of a file with several: its number from 1, or a part of its name")
    second: str | None = key(None, "file of the other horizontal component, at right angles to the first", min_length=1, max_length=1024)
    second_channel: int | str | None = key(None, "channel of the other horizontal, in `second` or in `file`")
    angle: Angle | None = key(None, "from the first component to the plane of the structure: it sees first cos(angle) + second sin(angle)")
    vertical: str | None = key(None, "file of the vertical component", min_length=1, max_length=1024)
    vertical_channel: int | str | None = key(None, "channel of the vertical component, in `vertical` or in `file`")

    @model_validator(mode="after")
    def _plane(self) -> "Components":
        if (self.angle is not None) != (self.second is not None or self.second_channel is not None):
            raise ValueError("angle goes together with second or second_channel, the other horizontal component")
        return self


class Record(Components, Treated):
    """A recorded ground motion; the format is recognised by content. `extrados:el-centro-1940` is shipped."""

    kind: Literal["record"]


class Selection(TargetSpectrum):
    """The records of a suite whose response spectra, each times a factor, come closest to a target."""

    count: int = key(about="number of records that are taken, those of the least misfit", ge=1, le=2000)
    shortest: Time = key(0.05, "shortest period that is compared", ge=0.01)
    longest: Time = key(2.0, "longest period that is compared", le=10)
    damping: float = key(0.05, "damping ratio of the spectra", ge=0.005, le=0.3)
    least_factor: float = key(0.25, "least factor on a record", gt=0)
    greatest_factor: float = key(4.0, "greatest factor on a record", gt=0, le=100)
    flatfile: str | None = key(
        None, "CSV table with a column `file` and values of the records, such as magnitude, for `limits`", min_length=1, max_length=1024
    )
    limits: dict[str, Annotated[list[float], Field(min_length=2, max_length=2)]] = key(
        {}, "column of the flatfile -> least and greatest value, such as `magnitude = [6, 7.5]`"
    )

    @model_validator(mode="after")
    def _band(self) -> "Selection":
        if self.longest <= self.shortest:
            raise ValueError("longest must be above shortest")
        if self.conditional_period is not None and not self.shortest <= self.conditional_period <= self.longest:
            raise ValueError(
                f"conditional_period: {self.conditional_period:g} s is outside the periods that are compared, "
                f"{self.shortest:g} to {self.longest:g} s; change shortest or longest"
            )
        if self.least_factor > self.greatest_factor:
            raise ValueError("least_factor is above greatest_factor")
        if bool(self.limits) != (self.flatfile is not None):
            raise ValueError("flatfile and limits go together")
        if self.code == "ASCE7" and self.damping != 0.05:
            raise ValueError("the spectrum of ASCE 7 is that of 5 % damping")
        return self


class Suite(Treated):
    """Several records: a list, a pattern or a folder inside the deck's folder, or a table for each with its components.

    Single runs take one of them.
    """

    kind: Literal["suite"]
    starter: ClassVar = {"files": '["extrados:el-centro-1940"]'}
    files: list[str] | None = key(None, "the records", min_length=1, max_length=2000)
    pattern: str | None = key(None, "such as `records/*.AT2`", min_length=1, max_length=1024)
    folder: str | None = key(None, "a folder whose record files are taken", min_length=1, max_length=1024)
    records: list[Components] | None = key(
        None, "[[motion.records]], records of several components or channels", min_length=1, max_length=2000
    )
    member: int = key(1, "which record a single run takes, from 1", ge=1)
    selection: Selection | None = key(
        None, "[motion.selection], the records closest to a target spectrum alone, each times a factor", source="Baker and Lee 2018"
    )

    @model_validator(mode="after")
    def _selected(self) -> "Suite":
        if self.selection is not None and any(v is not None for v in (self.pga, self.pgv, self.arias, self.sa)):
            raise ValueError("a selection has a factor for each record: remove pga, pgv, arias and sa")
        return self

    @model_validator(mode="after")
    def _one_source(self) -> "Suite":
        if any("*" in name or "?" in name for name in self.files or []):
            raise ValueError('files takes names; for wildcards use pattern = "records/*.AT2"')
        if sum(v is not None for v in (self.files, self.pattern, self.folder, self.records)) != 1:
            raise ValueError("give one of files, pattern, folder and records")
        return self


class Generated(Motion):
    """Random earthquakes of an expected intensity: sine lines with random phases under an envelope."""

    kind: Literal["generated"]
    starter: ClassVar = {"mmi": "7", "duration": "10.0"}
    mmi: float = key(about="modified Mercalli intensity", ge=1, le=12)
    duration: Time = key(about="t_d", gt=0, le=600, source="thesis Eq. 6.7")
    seed: int = key(1, "one seed gives one set; motion k of a set is always the same", ge=-(2**62), le=2**62)
    member: int = key(1, "which motion of the set a single run takes, from 1", ge=1, le=2**31)
    spectrum: str = key(
        "boore-worden",
        "Fourier spectra by intensity: `boore-worden`, or a CSV file mmi,frequency_Hz,amplitude_cm_s",
        min_length=1,
        max_length=1024,
        source="thesis Fig. 6-5",
    )
    lines: int | list[Frequency] = key(15, "number of sine lines over the spectrum's band, or their frequencies")
    spacing: Literal["log", "uniform"] = key("log", "lines in equal ratios or at equal distances")
    scaling: Literal["thesis", "fourier", "energy"] = key(
        "energy", "amplitude of a line: factor |X| df, 2 |X| df, or 2 |X| sqrt(df / int P^2 dt)", source="thesis Eq. 6.6"
    )
    factor: float = key(1.0, "factor on the amplitudes; with scaling = thesis the unit of the frequency step", gt=0)
    dispersion: float = key(
        0.0, "scatter of the strength from motion to motion: standard deviation of the logarithm of a factor of median 1", ge=0, le=2
    )
    envelope: Literal["arctangent", "trapezoid", "jennings", "saragoni-hart"] = key(
        "arctangent", "how the strength grows and fades", source="thesis Eq. 6.7; Hou 1968; Jennings 1968; Saragoni and Hart 1974"
    )
    rise: Time | None = key(None, "arctangent: its width (0.1 s); else time to full strength (0.15 or 0.2 t_d)", gt=0)
    decay: Time | None = key(None, "trapezoid: at the end of t_d; jennings: after it, to 5 % (0.4 t_d)", gt=0)
    lead: Time = key(0.5, "time before t_d, t_0", ge=0, le=60)
    tail: Time = key(2.0, "time after t_d", ge=0, le=600)
    time_step: Time = key(0.01, "sampling step", ge=1e-4, le=0.1)

    @model_validator(mode="after")
    def _lines(self) -> "Generated":
        count = self.lines if isinstance(self.lines, int) else len(self.lines)
        if not 2 <= count <= 2000:
            raise ValueError(f"{count} lines, expected 2 to 2000")
        return self


class Compatible(TargetSpectrum, Motion):
    """Random earthquakes whose response spectrum matches that of a code or table, baseline corrected."""

    kind: Literal["compatible"]
    starter: ClassVar = {"code": '"EN1998-1"', "ground": '"B"', "acceleration": '"0.2 g"', "tolerance": "0.15"}
    damping: float = key(0.05, "damping ratio of the spectrum", ge=0.005, le=0.3)
    shortest: Time = key(0.05, "shortest period that is matched", ge=0.02)
    longest: Time = key(2.0, "longest period that is matched", le=6)
    tolerance: float = key(0.1, "largest deviation from the target in that band", ge=0.02, le=0.5)
    duration: Time = key(20.0, "length of the motion", ge=2, le=200)
    envelope: Literal["trapezoid", "jennings", "saragoni-hart"] = key("trapezoid", "how the strength grows and fades")
    rise: Time | None = key(None, "time to full strength", gt=0)
    decay: Time | None = key(None, "see `generated`", gt=0)
    seed: int = key(1, "one seed gives one set", ge=-(2**62), le=2**62)
    member: int = key(1, "which motion of the set a single run takes, from 1", ge=1, le=2**31)
    time_step: Time = key(0.01, "sampling step", ge=1e-3, le=0.05)

    @model_validator(mode="after")
    def _complete(self) -> "Compatible":
        if self.code == "ASCE7" and self.damping != 0.05:
            raise ValueError("the spectrum of ASCE 7 is that of 5 % damping")
        if self.longest <= 2.0 * self.shortest:
            raise ValueError("longest must be above twice shortest")
        return self
