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
    duration: Time = key(10.0, "duration of the acceleration", gt=0)


class StepPulse(Motion):
    """Step pulse: the amplitude for the duration, then minus half of the amplitude for twice the duration (final velocity zero)."""

    kind: Literal["step-pulse"]
    amplitude: Acceleration = key(about="amplitude a_p of the first part")
    duration: Time = key(about="duration t_p of the first part", gt=0)


class SinePulse(Motion):
    """One full cycle of a sine."""

    kind: Literal["sine-pulse"]
    amplitude: Acceleration = key(about="amplitude A_p of the sine")
    period: Time = key(about="period T_p of the sine", gt=0)


class Harmonic(Motion):
    """Harmonic motion: constant amplitude, amplitude that increases over `ramp`, or a sinusoidal carrier (thesis 5.3.2)."""

    kind: Literal["harmonic"]
    amplitude: Acceleration = key(about="greatest amplitude")
    frequency: Frequency = key(about="frequency in Hz (not in rad/s)", gt=0, le=1000)
    duration: Time = key(10.0, "duration of the motion", gt=0)
    phase: Literal["sine", "cosine"] = key("sine", "phase at the start. sine: starts at zero; cosine: starts at the amplitude")
    ramp: Time = key(0.0, "time over which the amplitude increases linearly from zero", ge=0)
    carrier: Frequency | None = key(None, "frequency of a sinusoidal carrier, whose amplitude the motion modulates", gt=0, le=1000)

    @model_validator(mode="after")
    def _one_envelope(self) -> "Harmonic":
        if self.ramp > 0.0 and self.carrier is not None:
            raise ValueError("give either the key `ramp` or the key `carrier`, not both")
        return self


class Pulse(Motion):
    """A single pulse of another shape; `sine-pulse` and `step-pulse` are separate kinds."""

    kind: Literal["pulse"]
    starter: ClassVar = {"shape": '"ricker"'}
    shape: Literal["rectangular", "half-sine", "cosine", "ricker"] = key(
        about="shape of the pulse. rectangular: constant; half-sine: half of a sine; cosine: one full cosine; ricker: the "
        "symmetric Ricker wavelet"
    )
    amplitude: Acceleration = key(about="greatest acceleration")
    period: Time = key(about="full period T_p (a half-sine lasts half of it); for a rectangular pulse, the duration", gt=0)


class VelocityPulse(Motion):
    """Near-fault pulse: a cosine of the velocity under a cosine bell."""

    kind: Literal["velocity-pulse"]
    starter: ClassVar = {"velocity": '"60 cm/s"', "period": "1.0"}
    velocity: Velocity = key(about="amplitude A of the velocity", source="Mavroeidis and Papageorgiou 2003")
    period: Time = key(about="prevailing period T_p", gt=0)
    cycles: float = key(1.5, "gamma: number of cycles under the bell-shaped envelope", gt=1, le=50)
    phase: Angle = key(0.0, "nu: phase of the cosine; 0 is symmetric, 90 antisymmetric")


class Treated(Motion):
    """What may be done to records, in this order: time_scale, filter, baseline, resampling, scaling, scale."""

    time_step: Time | None = key(None, "time step of the samples, if the file gives none", ge=1e-4, le=10)
    unit: Literal["g", "m/s^2", "cm/s^2", "mm/s^2", "gal", "mg", "in/s^2"] | None = key(None, "unit of the values, if the file gives none")
    columns: Literal["series", "components"] | None = key(
        None,
        "meaning of several columns in a file without times. series: the rows are one series, row after "
        "row; components: each column is one component, chosen by `channel`",
    )
    scale: float = key(1.0, "factor on the acceleration, applied after all other processing")
    time_scale: float = key(1.0, "factor on the time axis; accelerations do not change", gt=0)
    low_cut: Frequency | None = key(None, "lower corner of a zero-phase Butterworth filter", gt=0)
    high_cut: Frequency | None = key(None, "upper corner of a zero-phase Butterworth filter", gt=0)
    baseline: Literal["none", "mean", "linear", "quadratic", "cubic"] = key(
        "none", "polynomial trend that is removed from the acceleration; its coefficients are fitted to the velocity"
    )
    resample: Time | None = key(None, "new sampling step", gt=0)
    pga: Acceleration | None = key(
        None,
        "scale the motion to this horizontal peak acceleration in the plane of the structure, with one factor for all components",
        gt=0,
    )
    pgv: Velocity | None = key(None, "scale the motion to this peak velocity (one factor for all components)", gt=0)
    arias: Velocity | None = key(None, "scale the motion to this Arias intensity (one factor for all components)", gt=0)
    sa: Acceleration | None = key(None, "scale the motion to this pseudo-acceleration at `sa_period` (one factor for all components)", gt=0)
    sa_period: Time | None = key(None, "period at which `sa` is given", gt=0)
    sa_damping: float = key(0.05, "damping ratio for which `sa` is given", ge=0, le=0.5)

    @model_validator(mode="after")
    def _one_target(self) -> "Treated":
        if sum(v is not None for v in (self.pga, self.pgv, self.arias, self.sa)) > 1:
            raise ValueError("give only one of the keys `pga`, `pgv`, `arias` and `sa`")
        if (self.sa is None) != (self.sa_period is None):
            raise ValueError("`sa` and `sa_period` require each other: give both, or neither")
        if self.low_cut is not None and self.high_cut is not None and self.low_cut >= self.high_cut:
            raise ValueError(f"`low_cut` {self.low_cut:g} Hz is not below `high_cut` {self.high_cut:g} Hz")
        return self


class Components(Table):
    """Where the components of one record lie: one horizontal, perhaps the other, perhaps the vertical."""

    file: str = key(
        about="path of the record, inside the folder of the deck, or `extrados:NAME` for a shipped record", min_length=1, max_length=1024
    )
    channel: int | str | None = key(None, "channel of a file with several channels: its number (from 1), or a part of its name")
    second: str | None = key(None, "file of the second horizontal component, perpendicular to the first", min_length=1, max_length=1024)
    second_channel: int | str | None = key(None, "channel of the second horizontal component, in the file `second` or in `file`")
    angle: Angle | None = key(
        None,
        "angle from the first component to the plane of the structure. The motion in this plane is the first component "
        "times cos(angle) plus the second component times sin(angle)",
    )
    vertical: str | None = key(None, "file of the vertical component", min_length=1, max_length=1024)
    vertical_channel: int | str | None = key(None, "channel of the vertical component, in the file `vertical` or in `file`")

    @model_validator(mode="after")
    def _plane(self) -> "Components":
        if (self.angle is not None) != (self.second is not None or self.second_channel is not None):
            raise ValueError("the key `angle` requires `second` or `second_channel`, which gives the second horizontal component")
        return self


class Record(Components, Treated):
    """A recorded ground motion; the format is recognised by content. `extrados:el-centro-1940` is shipped."""

    kind: Literal["record"]


class Selection(TargetSpectrum):
    """The records of a suite whose response spectra, each times a factor, come closest to a target."""

    count: int = key(about="number of records to select: those that differ least from the target spectrum", ge=1, le=2000)
    shortest: Time = key(0.05, "shortest period that is compared", ge=0.01)
    longest: Time = key(2.0, "longest period that is compared", le=10)
    damping: float = key(0.05, "damping ratio of the spectra", ge=0.005, le=0.3)
    least_factor: float = key(0.25, "least factor on a record", gt=0)
    greatest_factor: float = key(4.0, "greatest factor on a record", gt=0, le=100)
    flatfile: str | None = key(
        None,
        "CSV table (flatfile) with a column `file` and columns with properties of the records, such as magnitude, to which `limits` refer",
        min_length=1,
        max_length=1024,
    )
    limits: dict[str, Annotated[list[float], Field(min_length=2, max_length=2)]] = key(
        {}, "limits on columns of the flatfile: least and greatest value of each, such as `magnitude = [6, 7.5]`"
    )

    @model_validator(mode="after")
    def _band(self) -> "Selection":
        if self.longest <= self.shortest:
            raise ValueError("longest must be above shortest")
        if self.conditional_period is not None and not self.shortest <= self.conditional_period <= self.longest:
            raise ValueError(
                f"conditional_period: {self.conditional_period:g} s is outside the compared periods, {self.shortest:g} to "
                f"{self.longest:g} s: change shortest or longest"
            )
        if self.least_factor > self.greatest_factor:
            raise ValueError("least_factor is above greatest_factor")
        if bool(self.limits) != (self.flatfile is not None):
            raise ValueError("`flatfile` and `limits` require each other: give both, or neither")
        if self.code == "ASCE7" and self.damping != 0.05:
            raise ValueError("the spectrum of ASCE 7 is defined for 5 % damping only")
        return self


class Suite(Treated):
    """Several records: a list, a pattern or a folder inside the folder of the deck, or a table for each record.

    A table gives the components of a record. Single runs use one of the records.
    """

    kind: Literal["suite"]
    starter: ClassVar = {"files": '["extrados:el-centro-1940"]'}
    files: list[str] | None = key(None, "files of the records", min_length=1, max_length=2000)
    pattern: str | None = key(None, "pattern of the names of the files, such as `records/*.AT2`", min_length=1, max_length=1024)
    folder: str | None = key(None, "folder whose records form the suite", min_length=1, max_length=1024)
    records: list[Components] | None = key(
        None, "records with several components or channels, [[motion.records]]", min_length=1, max_length=2000
    )
    member: int = key(1, "number (from 1) of the record that a single run uses", ge=1)
    selection: Selection | None = key(
        None,
        "select only the records closest to a target spectrum, each with a scale factor, [motion.selection]",
        source="Baker and Lee 2018",
    )

    @model_validator(mode="after")
    def _selected(self) -> "Suite":
        if self.selection is not None and any(v is not None for v in (self.pga, self.pgv, self.arias, self.sa)):
            raise ValueError("a selection gives each record its own factor: remove `pga`, `pgv`, `arias` and `sa`")
        return self

    @model_validator(mode="after")
    def _one_source(self) -> "Suite":
        if any("*" in name or "?" in name for name in self.files or []):
            raise ValueError('the key `files` takes names without wildcards; for wildcards give pattern = "records/*.AT2"')
        if sum(v is not None for v in (self.files, self.pattern, self.folder, self.records)) != 1:
            raise ValueError("give only one of the keys `files`, `pattern`, `folder` and `records`")
        return self


class Generated(Motion):
    """Random earthquakes of an expected intensity: sine lines with random phases under an envelope."""

    kind: Literal["generated"]
    starter: ClassVar = {"mmi": "7", "duration": "10.0"}
    mmi: float = key(about="modified Mercalli intensity", ge=1, le=12)
    duration: Time = key(about="duration t_d of the motion, without `lead` and `tail`", gt=0, le=600, source="thesis Eq. 6.7")
    seed: int = key(1, "seed of the random numbers: the same seed gives the same set", ge=-(2**62), le=2**62)
    member: int = key(1, "number of the motion of the set that a single run uses, counted from 1", ge=1, le=2**31)
    spectrum: str = key(
        "boore-worden",
        "Fourier spectra by intensity: `boore-worden`, or a CSV file with the columns mmi,frequency_Hz,amplitude_cm_s",
        min_length=1,
        max_length=1024,
        source="thesis Fig. 6-5",
    )
    lines: int | list[Frequency] = key(15, "number of sine lines over the band of the spectrum, or their frequencies")
    spacing: Literal["log", "uniform"] = key(
        "log", "spacing of the spectral lines. log: equal ratios of the frequencies; uniform: equal distances"
    )
    scaling: Literal["thesis", "fourier", "energy"] = key(
        "energy",
        "rule for the amplitude of each spectral line. thesis: factor |X| df; fourier: 2 |X| df; energy: 2 |X| sqrt(df "
        "/ int P^2 dt), which keeps the energy of the spectrum. |X|: amplitude of the Fourier spectrum, df: frequency "
        "step, P: envelope, factor: the key `factor`",
        source="thesis Eq. 6.6",
    )
    factor: float = key(
        1.0,
        'factor on the amplitudes. With scaling = "thesis", it includes the unit of the frequency step, which the thesis does not give',
        gt=0,
    )
    dispersion: float = key(
        0.0,
        "scatter of the amplitudes from motion to motion: standard deviation of the logarithm of the factor by which each "
        "motion is multiplied (lognormal, median 1)",
        ge=0,
        le=2,
    )
    envelope: Literal["arctangent", "trapezoid", "jennings", "saragoni-hart"] = key(
        "arctangent",
        "envelope: how the amplitude varies over time",
        source="thesis Eq. 6.7; Hou 1968; Jennings 1968; Saragoni and Hart 1974",
    )
    rise: Time | None = key(
        None,
        "for the arctangent envelope: width of the rise (default 0.1 s); for other envelopes: time until the full "
        "amplitude (default 0.2 times t_d for saragoni-hart, otherwise 0.15 times t_d)",
        gt=0,
    )
    decay: Time | None = key(
        None,
        "for a trapezoid: duration of the decay at the end of t_d; for jennings: time after t_d until the envelope is "
        "5 %; default 0.4 times t_d",
        gt=0,
    )
    lead: Time = key(0.5, "time t_0 before the duration t_d", ge=0, le=60)
    tail: Time = key(2.0, "time after the duration t_d", ge=0, le=600)
    time_step: Time = key(0.01, "sampling step", ge=1e-4, le=0.1)

    @model_validator(mode="after")
    def _lines(self) -> "Generated":
        count = self.lines if isinstance(self.lines, int) else len(self.lines)
        if not 2 <= count <= 2000:
            raise ValueError(f"{count} lines were given, expected 2 to 2000")
        return self


class Compatible(TargetSpectrum, Motion):
    """Random earthquakes whose response spectrum matches the spectrum of a code or of a table, with baseline correction."""

    kind: Literal["compatible"]
    starter: ClassVar = {"code": '"EN1998-1"', "ground": '"B"', "acceleration": '"0.2 g"', "tolerance": "0.15"}
    damping: float = key(0.05, "damping ratio of the spectrum", ge=0.005, le=0.3)
    shortest: Time = key(0.05, "shortest period that is matched", ge=0.02)
    longest: Time = key(2.0, "longest period that is matched", le=6)
    tolerance: float = key(
        0.1, "greatest relative deviation from the target spectrum in the band from `shortest` to `longest`", ge=0.02, le=0.5
    )
    duration: Time = key(20.0, "length of the motion", ge=2, le=200)
    envelope: Literal["trapezoid", "jennings", "saragoni-hart"] = key("trapezoid", "envelope: how the amplitude varies over time")
    rise: Time | None = key(None, "time until the full amplitude", gt=0)
    decay: Time | None = key(None, "duration of the decay of the envelope, as for `generated` motions", gt=0)
    seed: int = key(1, "seed of the random numbers: the same seed gives the same set", ge=-(2**62), le=2**62)
    member: int = key(1, "number of the motion of the set that a single run uses, counted from 1", ge=1, le=2**31)
    time_step: Time = key(0.01, "sampling step", ge=1e-3, le=0.05)

    @model_validator(mode="after")
    def _complete(self) -> "Compatible":
        if self.code == "ASCE7" and self.damping != 0.05:
            raise ValueError("the spectrum of ASCE 7 is defined for 5 % damping only")
        if self.longest <= 2.0 * self.shortest:
            raise ValueError("the period `longest` must be more than twice the period `shortest`")
        return self
