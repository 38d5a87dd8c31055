"""Analysis kinds of the rocking statistics: fragility, resonance, spectra, code checks."""

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.analyses.rocking.tables import HOLDS, SOFT_BASE, RockingTable, hand_over_cells
from extrados.schema.quantities import Acceleration, Angle, Frequency, OrText, Time, factor, parse
from extrados.schema.table import Table, key

if TYPE_CHECKING:
    from extrados.views.building import Building

#: Measures of levels that have a dimension: SI unit, and the unit of a bare number
LEVELS = {"pga": ("m/s^2", "g"), "sa": ("m/s^2", "g"), "arias": ("m/s", "m/s")}
WITHOUT_UNIT = ["pga-ratio", "pgv-ratio", "scale", "size"]
Level = Annotated[float, OrText()]
#: Uncertain values by the kind of structure; others that rock by a mechanism know those of STONES
UNCERTAIN = {
    "block": ("width", "height", "centre_height", "toe_right", "toe_left", "friction", "restitution"),
    "column": ("width", "top_width", "height", "density", "friction", "restitution"),
    "arch": ("radius", "thickness", "corners", "density", "friction", "imperfection", "restitution"),
    "stack": ("lower_width", "lower_height", "upper_width", "upper_height", "density", "friction"),
}
STONES = ("density", "friction", "imperfection", "restitution")
#: Of two free blocks that rock as a stack: impacts have no rule that could vary
STACK = ("density", "friction")
#: Keys of [supports] that are uncertain where the base gives way, instead of restitution
BASE = ("stiffness", "damping_ratio")
Rate = Annotated[float, Field(gt=0, le=100)]


class Hazard(Table):
    """Seismic hazard of the site: how often a year each intensity is exceeded, in the measure of the levels."""

    intensities: list[Level] | None = key(
        None,
        "intensities of the hazard curve, in increasing order: numbers in the unit of the measure, or text",
        min_length=2,
        max_length=1000,
    )
    annual_rates: list[Rate] | None = key(
        None,
        "mean annual rates at which the `intensities` are exceeded, in decreasing order; interpolated linearly in the logarithms",
        min_length=2,
        max_length=1000,
    )
    file: str | None = key(
        None, "CSV file with both columns, instead of `intensities` and `annual_rates`; lines that begin with # are ignored"
    )
    years: float = key(50.0, "number of years for which the probability of collapse is given", gt=0, le=1e5)
    acceptable_rate: Rate | None = key(None, "acceptable annual rate of collapse. The verdict compares the calculated rate with this value")

    @model_validator(mode="after")
    def _curve(self) -> "Hazard":
        lists = (self.intensities, self.annual_rates)
        if (self.file is None) == (None in lists) or (self.file is not None and lists != (None, None)):
            raise ValueError("give either `intensities` and `annual_rates`, or a `file`")
        if self.intensities is not None and self.annual_rates is not None:
            check_hazard(self.intensities, self.annual_rates)
        return self


def check_hazard(intensities: list[float], rates: list[float]) -> None:
    """ValueError where these are no hazard curve."""
    if len(intensities) != len(rates):
        raise ValueError(f"{len(intensities)} intensities and {len(rates)} `annual_rates` were given; expected equal numbers")
    if min(intensities) <= 0.0 or any(b <= a for a, b in pairwise(intensities)):
        raise ValueError("intensities must be above zero and increase")
    if min(rates) <= 0.0 or any(b >= a for a, b in pairwise(rates)):
        raise ValueError("`annual_rates` must be above zero and decrease, because stronger motions are rarer")


class Fragility(RockingTable):
    """Probability of uplift and collapse over many motions.

    With `levels` or `cloud`, the probability is a function of an intensity measure; a `hazard` curve gives the annual rate of collapse.
    """

    kind: Literal["fragility"]
    considers: ClassVar = (*HOLDS, *SOFT_BASE)
    soft_base: ClassVar = True
    needs_motion: ClassVar = True
    starter_motion: ClassVar = "generated"
    count: int | None = key(None, "number of motions; default 1000, or the whole set", ge=1, le=10_000_000)
    seed: int | None = key(
        None,
        "seed of the random numbers, for the uncertain values and for a generated set of motions; replaces the seed in [motion]",
        ge=0,
        le=2**62,
    )
    durations: list[Time] | None = key(
        None,
        "durations t_d of the generated motions. The analysis is repeated for each duration",
        source="thesis Fig. 6-8",
        min_length=1,
        max_length=100,
    )
    intensity: Literal["pga", "pga-ratio", "pgv-ratio", "sa", "arias", "scale"] = key(
        "pga",
        "intensity measure of the keys `levels`, `cloud` and `hazard`. pga: PGA [g]; pga-ratio: PGA/(g "
        "tan alpha); pgv-ratio: p PGV/(g tan alpha); sa: SA(`sa_period`) [g]; arias: Arias intensity "
        "[m/s]; scale: the scale factor itself. alpha: slenderness angle, p: frequency parameter",
        source="Dimitrakopoulos and Paraskeva 2015",
    )
    levels: list[Level] | None = key(
        None,
        'intensities to which each motion is scaled: numbers in the unit of the measure, or text such as "0.1 g"',
        min_length=1,
        max_length=500,
    )
    cloud: bool = key(False, "fit fragility curves over the intensities of the unscaled motions", source="Jalayer and others 2017")
    rotation_limits: list[Annotated[float, Field(gt=0, le=1)]] = key(
        [], "for a cloud: also fit fragility curves for exceeding these values of rotation divided by critical rotation", max_length=20
    )
    hazard: Hazard | None = key(None, "hazard curve of the site, which gives the annual rate of collapse")
    histories: int = key(0, "number of motions that are drawn with their responses", ge=0, le=12, source="thesis Fig. 6-6")
    sa_period: Time | None = key(None, "period of SA", gt=0)
    sa_damping: float = key(0.05, "damping ratio of SA", ge=0, lt=1)
    uncertain: dict[str, float] = key(
        {},
        "coefficients of variation of width, height, thickness and restitution; of the thickness lost at worn `corners`; of the "
        "`density` of each block; of the `friction` of all joints together; of `stiffness` and `damping_ratio` of a compliant base. "
        "`imperfection`: random displacement of corners and joints of blocks, divided by the shortest joint. The values are sampled by "
        "a Sobol sequence",
    )
    sensitivity: int | None = key(
        None,
        "number of samples (a power of 2) for Sobol indices of `uncertain` values and of the motion; this requires "
        "samples times (values + 2) runs",
        ge=16,
        le=2**20,
        source="Saltelli and others 2010",
    )
    confidence: float = key(0.95, "confidence level of all intervals", gt=0, lt=1)
    bootstrap: int = key(500, "number of bootstrap samples for the confidence band of the fitted curve", ge=0, le=100_000)
    bins: int = key(20, "number of bins of the histogram, from zero to the critical rotation", ge=2, le=1000)
    settle: Time | None = key(
        None,
        "time after the motion in which the structure must come to rest or collapse; default: 40 times the natural time (blocks: 1/p)",
        ge=0,
    )
    hand_over: bool = key(
        False,
        "if joints slide or hinges form at other joints than those of the mechanism, continue the run with rigid "
        "contacts; if false, a warning states the share of such runs",
        source="Moreau 1988",
    )
    tolerance: float = key(1e-8, "relative tolerance of the integrator", ge=1e-13, le=1e-3)

    @model_validator(mode="before")
    @classmethod
    def _units(cls, data: Any) -> Any:
        """Levels and intensities given as text, in the unit of their measure."""
        return levels_in_units(data) if isinstance(data, dict) else data

    @property
    def watches_samples(self) -> bool:
        """Whether the joints of each sampled building are checked, and not those of the nominal one alone."""
        return self.hand_over or "friction" in self.uncertain

    @model_validator(mode="after")
    def _sensible(self) -> "Fragility":
        if self.hand_over and {"density", "imperfection"} & set(self.uncertain):
            raise ValueError("`hand_over` uses the nominal blocks: remove uncertain.density and uncertain.imperfection")
        if self.hand_over and self.sensitivity is not None:
            raise ValueError("the key `sensitivity` uses only runs of the mechanism: remove `sensitivity` or `hand_over`")
        if "friction" in self.uncertain and self.sensitivity is not None:
            raise ValueError(
                "friction does not change an outcome of the mechanism, so its Sobol index is zero: remove "
                "uncertain.friction or `sensitivity`"
            )
        if self.levels is not None and min(self.levels) <= 0.0:
            raise ValueError("levels must be above zero")
        if self.levels is not None and self.durations is not None:
            raise ValueError("give either the key `levels` or the key `durations`, not both")
        if (self.levels is not None or self.cloud) and (self.intensity == "sa") != (self.sa_period is not None):
            raise ValueError('intensity = "sa" requires `sa_period`, and `sa_period` requires intensity = "sa"')
        if self.cloud and (self.levels is not None or self.durations is not None):
            raise ValueError("a cloud uses unscaled motions: remove the keys `levels` and `durations`")
        if self.cloud and self.intensity == "scale":
            raise ValueError(
                'the motions of a cloud are not scaled, so intensity = "scale" has the same value for all of '
                "them: give another intensity measure"
            )
        if self.rotation_limits and not self.cloud:
            raise ValueError("`rotation_limits` is used only with cloud = true")
        if self.histories and (self.levels is not None or self.durations is not None):
            raise ValueError("the key `histories` shows the unscaled motions: remove the keys `levels` and `durations`")
        if self.hazard is not None and (self.intensity == "scale" or not (self.cloud or self.levels)):
            raise ValueError("a hazard curve requires the key `levels`, or a cloud with an intensity measure")
        if self.sensitivity is not None:
            if not self.uncertain or self.levels is not None or self.durations is not None:
                raise ValueError("the key `sensitivity` requires uncertain values, and excludes the keys `levels` and `durations`")
            if self.sensitivity & (self.sensitivity - 1):
                raise ValueError(f"sensitivity is {self.sensitivity}, expected a power of 2")
        known = sorted({name for names in (*UNCERTAIN.values(), STONES, BASE) for name in names})
        for name, value in self.uncertain.items():
            if name not in known:
                raise ValueError(f"uncertain.{name} is unknown; expected {', '.join(known)}")
            if not 0.0 < value <= 0.5:
                raise ValueError(f"uncertain.{name} is {value:g}, expected a coefficient of variation above 0, at most 0.5")
        return self


def levels_in_units(data: dict[str, Any]) -> dict[str, Any]:
    """The keys of a table with its `levels` and the `intensities` of its `hazard` as numbers in the unit of its `intensity`."""
    hazard, measure = data.get("hazard"), data.get("intensity", "pga")
    found = {**data, "levels": numbers_in(data.get("levels"), measure, "levels")} if "levels" in data else data
    if isinstance(hazard, dict) and "intensities" in hazard:
        numbers = numbers_in(hazard["intensities"], measure, "hazard.intensities")
        found = {**found, "hazard": {**hazard, "intensities": numbers}}
    return found


def numbers_in(values: Any, intensity: Any, key: str) -> Any:
    """Numbers in the unit of a measure for those given as text with a unit; anything else stays for pydantic to judge."""
    if not isinstance(values, list) or not any(isinstance(v, str) for v in values):
        return values
    if intensity in WITHOUT_UNIT:
        raise ValueError(f"{key}: for intensity = {intensity!r} expected numbers without a unit")
    # A measure that is none is complained of by itself.
    si, unit = LEVELS[intensity if intensity in list(LEVELS) else "pga"]
    try:
        return [parse(v, si) / factor(unit, si) if isinstance(v, str) else v for v in values]
    except ValueError as error:
        raise ValueError(f"{key}: {error}") from None


class Resonance(RockingTable):
    """Motion with a limited acceleration that supplies the most energy to a block, and the least limit that can cause overturning."""

    kind: Literal["resonance"]
    considers: ClassVar = ()
    cap: Acceleration | None = key(
        None, "cap (greatest value) of the ground acceleration; default: 0.6 times the uplift acceleration", gt=0, source="thesis Eq. 6.5"
    )
    half_cycles: int = key(40, "greatest number of half cycles", ge=1, le=400)
    impulse_amplitude: Acceleration | None = key(
        None,
        "amplitude of the sine impulses that supply energy to free rocking; default: half of the uplift acceleration",
        gt=0,
        source="thesis 6.2.3",
    )


class RockingSpectrum(RockingTable):
    """Rocking spectra of a motion: greatest rotation of blocks over 2 pi/p and alpha, or of the arch of the deck in all sizes."""

    kind: Literal["rocking-spectrum"]
    considers: ClassVar = ()
    view: ClassVar = ""
    needs_motion: ClassVar = True
    periods: list[Time] | None = key(
        None, "periods 2 pi/p (for arches, 2 pi sqrt(R/g)); default: 60 values from 0.2 to 8 s", min_length=1, max_length=5000
    )
    slenderness: list[Angle] = key([10.0, 15.0, 20.0, 25.0], "slenderness angles alpha of the blocks", min_length=1, max_length=50)

    @model_validator(mode="after")
    def _angles(self) -> "RockingSpectrum":
        if not all(0.0 < a < 45.0 for a in self.slenderness):
            raise ValueError("`slenderness` is alpha in degrees, expected above 0 and below 45")
        return self

    def reckons_with(self, building: "Building") -> set[str]:
        """They start at rest. Of blocks it takes the restitution alone, and refuses what it does not take of impacts and of the
        ground."""
        if building.structure is not None and building.structure.kind == "arch":
            return super().reckons_with(building) - {"initial.rotation_ratio"}
        return {"joints.restitution", "joints.friction", "joints.energy_ratio", "supports.stiffness"}


class HarmonicMap(RockingTable):
    """Response to harmonic ground motions over frequency and amplitude: rest, rocking (with the greatest rotation), or overturning."""

    kind: Literal["harmonic-map"]
    considers: ClassVar = (*HOLDS, *SOFT_BASE)
    soft_base: ClassVar = True
    starter: ClassVar = {"amplitudes": "24"}
    frequencies: list[Frequency] | None = key(
        None,
        "frequencies of the motion in Hz; default: 40 values of omega/p from 1 to 12 (p: frequency "
        "parameter of rocking, omega: 2 pi times the frequency)",
        min_length=1,
        max_length=1000,
    )
    max_amplitude: Acceleration | None = key(None, "greatest amplitude; default: 6 times the uplift acceleration", gt=0)
    amplitudes: int = key(48, "number of amplitudes", ge=2, le=1000)
    cycles: int = key(30, "number of cycles of the motion", ge=2, le=1000, source="Spanos and Koh 1984")
    hand_over_cells: int = hand_over_cells()
