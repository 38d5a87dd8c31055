"""The table [code]: the one code by which a report assesses the building, and its seismic action at the site."""

from math import exp, log
from typing import Annotated, Literal

from pydantic import Field, model_validator

from extrados.schema.quantities import Acceleration, Time
from extrados.schema.spectrum import CodeSpectrum
from extrados.schema.table import Table, key

Jurisdiction = Literal["NTC", "EN1998", "ASCE41", "NZSEE", "none"]
Research = Literal["West", "Housner", "Ishiyama", "ASCE 43", "FEMA 356", "Magenes-Calvi"]
Years = Annotated[float, Field(ge=1, le=1e5)]

#: Editions whose rules are here; the first is the default
EDITIONS = {"NTC": ("2018",), "EN1998": ("2004",), "ASCE41": ("2013",), "NZSEE": ("2017",), "none": ()}
#: Each code and edition in words
NAMES = {
    "NTC": "NTC 2018 with Circolare 7/2019",
    "EN1998": "EN 1998-1:2004 and EN 1998-3:2005",
    "ASCE41": "ASCE 41-13",
    "NZSEE": "NZSEE/MBIE Guidelines C8 (2017) with NZS 1170.5",
    "none": "no code",
}
#: Limit states of each code; the first of DEFAULT is that of collapse prevention or life safety by which a report concludes
LIMIT_STATES = {
    "NTC": ("SLO", "SLD", "SLV", "SLC"),
    "EN1998": ("DL", "SD", "NC"),
    "ASCE41": ("IO", "LS", "CP"),
    "NZSEE": ("ULS",),
    "none": (),
}
DEFAULT = {"NTC": "SLV", "EN1998": "SD", "ASCE41": "LS", "NZSEE": "ULS"}
#: Confidence factor by knowledge level: Circ. 7/2019 Table C8.5.IV; EN 1998-3:2005 Table 3.1 (verify clause). For ASCE 41 1 over
#: the knowledge factor of Table 6-1 (verify clause)
KNOWLEDGE = {
    "NTC": {"LC1": 1.35, "LC2": 1.2, "LC3": 1.0},
    "EN1998": {"KL1": 1.35, "KL2": 1.2, "KL3": 1.0},
    "ASCE41": {"minimum": 1.0 / 0.75, "usual": 1.0, "comprehensive": 1.0},
    "NZSEE": {},
    "none": {},
}
#: NTC 2018 Table 2.4.II, coefficient of use C_U; EN 1998-1 4.2.5, importance factor gamma_I, recommended values (verify clause)
IMPORTANCE = {"NTC": {"I": 0.7, "II": 1.0, "III": 1.5, "IV": 2.0}, "EN1998": {"I": 0.8, "II": 1.0, "III": 1.2, "IV": 1.4}}
#: NTC 2018 Table 3.2.I: probability of exceedance in the reference life V_R
EXCEEDED = {"SLO": 0.81, "SLD": 0.63, "SLV": 0.10, "SLC": 0.05}
#: NZS 1170.5 Table 3.5, read in two public implementations: return period [years], factor R
RETURN_FACTOR = (
    (20.0, 0.2),
    (25.0, 0.25),
    (50.0, 0.35),
    (100.0, 0.5),
    (250.0, 0.75),
    (500.0, 1.0),
    (1000.0, 1.3),
    (2000.0, 1.7),
    (2500.0, 1.8),
)
#: The keys of the seismic action that each code takes
ACTION = {
    "NTC": ("ground", "topography", "accelerations", "amplifications", "corner_periods"),
    "EN1998": ("ground", "spectrum_type", "accelerations"),
    "ASCE41": ("short_accelerations", "one_second_accelerations", "long_period"),
    "NZSEE": ("ground", "hazard_factor"),
    "none": (),
}
#: Keys of the seismic action with one value for each limit state
LISTS = ("accelerations", "amplifications", "corner_periods", "short_accelerations", "one_second_accelerations")


class Code(Table):
    """The code for the checks: the rules of one jurisdiction give the verdict. Without this table, the rules of NTC 2018 are applied."""

    jurisdiction: Jurisdiction = key(
        about="code of the checks: NTC (Italy), EN1998 (Eurocode 8), ASCE41 (United States), NZSEE (New "
        "Zealand), or none (no code: formulas of mechanics and research only)"
    )
    edition: str | None = key(None, "edition of the code: NTC 2018, EN1998 2004, ASCE41 2013, NZSEE 2017")
    nominal_life: Years = key(50.0, "nominal life V_N of the building in years (NTC)", source="NTC 2018, 2.4.1")
    importance: Literal["I", "II", "III", "IV"] | None = key(
        None,
        "class of use (NTC: coefficient C_U) or importance class (EN 1998-1: factor gamma_I); default II",
        source="NTC 2018 Table 2.4.II; EN 1998-1 4.2.5",
    )
    limit_states: list[Literal["SLO", "SLD", "SLV", "SLC", "DL", "SD", "NC", "IO", "LS", "CP", "ULS"]] = key(
        [], "limit states that are checked; default SLV (NTC), SD (EN 1998), LS (ASCE 41) or ULS (NZSEE)", max_length=4
    )
    return_periods: list[Years] = key([], "return period in years of each limit state; default for NTC: from V_N and C_U", max_length=4)
    knowledge_level: Literal["LC1", "LC2", "LC3", "KL1", "KL2", "KL3", "minimum", "usual", "comprehensive"] | None = key(
        None, "knowledge level of the masonry; default: the lowest level of the code"
    )
    confidence_factor: float | None = key(
        None, "confidence factor, by which mean strengths are divided; default: from the knowledge level", ge=1, le=2
    )
    ground: Literal["A", "B", "C", "D", "E"] = key("A", "ground type (NTC, EN 1998-1) or site subsoil class (NZS 1170.5)")
    topography: float = key(1.0, "topographic amplification S_T, of NTC", ge=1, le=2)
    spectrum_type: Literal[1, 2] = key(1, "spectrum of EN 1998-1: type 1 or 2")
    accelerations: list[Annotated[Acceleration, Field(gt=0)]] = key(
        [], "a_g on ground A for each limit state (NTC); a_gR, which is multiplied by gamma_I (EN 1998-1)", max_length=4
    )
    amplifications: list[Annotated[float, Field(ge=1, le=10)]] = key([], "F_0 for each limit state (NTC); default 2.5", max_length=4)
    corner_periods: list[Annotated[Time, Field(gt=0, le=2)]] = key([], "T_C* for each limit state (NTC); default 0.35 s", max_length=4)
    short_accelerations: list[Annotated[Acceleration, Field(gt=0)]] = key(
        [], "S_XS at the site for each limit state (ASCE 41)", max_length=4
    )
    one_second_accelerations: list[Annotated[Acceleration, Field(gt=0)]] = key(
        [], "S_X1 at the site for each limit state (ASCE 41)", max_length=4
    )
    long_period: Time = key(8.0, "T_L of ASCE 7", gt=0)
    hazard_factor: Annotated[float, Field(gt=0, le=1)] | None = key(None, "hazard factor Z of NZS 1170.5")
    research: list[Research] = key(
        [], "formulas of other origin, which are listed for comparison only and do not affect the verdict", max_length=6
    )

    @model_validator(mode="after")
    def _of_one_code(self) -> "Code":
        own, given = self.jurisdiction, self.model_fields_set
        if self.edition is not None and self.edition not in EDITIONS[own]:
            known = " or ".join(EDITIONS[own]) or "none"
            raise ValueError(f"edition: this program includes edition {known} of {own}, not {self.edition}")
        if strange := [s for s in self.limit_states if s not in LIMIT_STATES[own]]:
            raise ValueError(f"limit_states: {strange[0]} is not a limit state of {own}; expected {_list(LIMIT_STATES[own])}")
        if len(set(self.limit_states)) < len(self.limit_states):
            raise ValueError("limit_states: a limit state occurs twice")
        if self.knowledge_level is not None and self.knowledge_level not in KNOWLEDGE[own]:
            raise ValueError(f"knowledge_level: {self.knowledge_level} is not a level of {own}; expected {_list(KNOWLEDGE[own])}")
        unused = {name for keys in ACTION.values() for name in keys} - set(ACTION[own])
        unused |= {"nominal_life"} if own != "NTC" else set()
        unused |= {"importance"} if own not in IMPORTANCE else set()
        unused |= {"confidence_factor"} if not KNOWLEDGE[own] else set()
        unused |= {"limit_states", "return_periods"} if own == "none" else set()
        if wrong := sorted(unused & given):
            raise ValueError(f"{wrong[0]}: {own} does not use this key: remove it")
        count = len(self.states)
        for name in ("return_periods", *LISTS):
            if (values := getattr(self, name)) and len(values) != count:
                raise ValueError(f"{name}: expected one value for each limit state ({_list(self.states)}), found {len(values)}")
        for name in ("amplifications", "corner_periods"):
            if getattr(self, name) and not self.accelerations:
                raise ValueError(f"{name}: needs accelerations")
        if bool(self.short_accelerations) != bool(self.one_second_accelerations):
            raise ValueError("short_accelerations and one_second_accelerations go together")
        return self

    @property
    def name(self) -> str:
        """Code and edition in words."""
        return NAMES[self.jurisdiction]

    @property
    def states(self) -> tuple[str, ...]:
        """The limit states that are checked."""
        default = DEFAULT.get(self.jurisdiction)
        return tuple(self.limit_states) or (() if default is None else (default,))

    @property
    def concluding(self) -> str:
        """The limit state of life safety: that of a spectrum which an analysis gives by itself."""
        return DEFAULT.get(self.jurisdiction, "")

    @property
    def factor(self) -> float:
        """Confidence factor of the knowledge level, or that of the table."""
        levels = KNOWLEDGE[self.jurisdiction]
        if self.confidence_factor is not None:
            return self.confidence_factor
        return levels[self.knowledge_level] if self.knowledge_level else next(iter(levels.values()), 1.0)

    def return_period(self, state: str) -> float | None:
        """Return period of a limit state [years]; of NTC by default -V_N C_U/ln(1 - P) (3.2.0, reference life of 35 years at least)."""
        if self.return_periods and state in self.states:
            return self.return_periods[self.states.index(state)]
        if self.jurisdiction == "NTC" and state in EXCEEDED:
            life = max(35.0, self.nominal_life * IMPORTANCE["NTC"][self.importance or "II"])
            return -life / log(1.0 - EXCEEDED[state])
        return 500.0 if self.jurisdiction == "NZSEE" else None

    def spectrum(self, state: str) -> CodeSpectrum | None:
        """Elastic spectrum of the site at a limit state; None where the table does not give the action."""
        if state not in self.states:
            return None
        k = self.states.index(state)
        match self.jurisdiction:
            case "NTC" if self.accelerations:
                more = {n: getattr(self, f"{n}s")[k] for n in ("amplification", "corner_period") if getattr(self, f"{n}s")}
                return CodeSpectrum.model_construct(
                    code="NTC", ground=self.ground, acceleration=self.accelerations[k], topography=self.topography, **more
                )
            case "EN1998" if self.accelerations:
                importance = IMPORTANCE["EN1998"][self.importance or "II"]
                return CodeSpectrum.model_construct(
                    code=f"EN1998-{self.spectrum_type}", ground=self.ground, acceleration=importance * self.accelerations[k]
                )
            case "ASCE41" if self.short_accelerations:
                return CodeSpectrum.model_construct(
                    code="ASCE7", sds=self.short_accelerations[k], sd1=self.one_second_accelerations[k], long_period=self.long_period
                )
            case "NZSEE" if self.hazard_factor is not None:
                return CodeSpectrum.model_construct(
                    code="NZS1170",
                    ground=self.ground,
                    hazard_factor=self.hazard_factor,
                    return_factor=return_factor(self.return_period(state) or 500.0),
                )
        return None


def return_factor(years: float) -> float:
    """R of NZS 1170.5 Table 3.5, between its rows by straight lines of the logarithms."""
    (low, r), *rest = RETURN_FACTOR
    if years <= low:
        return r
    for high, s in rest:
        if years <= high:
            return exp(log(r) + (log(s) - log(r)) * log(years / low) / log(high / low))
        low, r = high, s
    return r


def _list(words: object) -> str:
    return ", ".join(str(w) for w in words)  # type: ignore[attr-defined]
