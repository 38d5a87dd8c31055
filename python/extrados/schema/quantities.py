"""Numbers with units: SI numbers, or text "NUMBER UNIT" under a strict grammar.

pint sees the unit alone: given a whole string it reads "1,5 m" as 15 m, evaluates "2*3 m" and hangs on
powers of powers. In decks `g` is gravity, not gram.
"""

import contextlib
import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, get_args

from pydantic import BaseModel, BeforeValidator

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
FACTOR = r"[A-Za-z_%°]\w*(?:(?:\*\*|\^)-?\d|[²³])?"
QUANTITY = re.compile(rf"({NUMBER}) +({FACTOR}(?: ?[*/] ?{FACTOR})*)", re.ASCII)
LONGEST = 60

_EXAMPLE = {
    "m": "20 cm",
    "s": "0.2 s",
    "m/s^2": "0.5 g",
    "m/s": "12 cm/s",
    "Hz": "2 Hz",
    "deg": "157.5 deg",
    "kg/m^3": "2000 kg/m^3",
    "Pa": "3 MPa",
    "N": "55.6 kN",
    "N/m": "60 N/m",
    "Pa/m": "10 GPa/m",
    "rad/s": "3 rad/s",
    "kg*m^2": "12 kg*m^2",
    "m^2": "0.4 in^2",
    "m^3/s": "0.75 gallon/min",
    "N*s/m": "40 kN*s/m",
    "N*m": "5 kN*m",
    "N*m*s": "30 kN*m*s",
}


#: SI unit -> units that need no library, with their factors: reading pint's definitions takes half a second
COMMON: dict[str, dict[str, float]] = {
    "m": {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254},
    "s": {"s": 1.0, "ms": 0.001, "min": 60.0},
    "m/s^2": {"g": 9.80665, "m/s^2": 1.0, "cm/s^2": 0.01, "mm/s^2": 0.001},
    "m/s": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001},
    "Hz": {"Hz": 1.0},
    "deg": {"deg": 1.0, "rad": 57.29577951308232},
    "kg/m^3": {"kg/m^3": 1.0},
    "kg": {"kg": 1.0, "g": 0.001},
    "kg*m^2": {"kg*m^2": 1.0},
    "N": {"N": 1.0, "kN": 1000.0, "MN": 1000000.0},
    "N/m": {"N/m": 1.0, "kN/m": 1000.0, "J/m^2": 1.0, "N/mm": 1000.0},
    "Pa": {"Pa": 1.0, "kPa": 1000.0, "MPa": 1000000.0, "GPa": 1000000000.0, "N/mm^2": 1000000.0},
    "Pa/m": {"Pa/m": 1.0, "MPa/m": 1000000.0, "GPa/m": 1000000000.0},
    "m^2": {"m^2": 1.0, "cm^2": 0.0001, "mm^2": 1e-06},
    "m^3/s": {"m^3/s": 1.0},
    "N*s/m": {"N*s/m": 1.0, "kN*s/m": 1000.0},
    "N*m": {"N*m": 1.0, "kN*m": 1000.0},
    "N*m*s": {"N*m*s": 1.0, "kN*m*s": 1000.0},
}


#: SI unit -> factors and names of the units of engineers, with the least value [SI] that each shows, the greatest unit first
ENGINEERING: dict[str, tuple[tuple[float, str, float], ...]] = {
    "Pa": ((1e9, "GPa", 1e9), (1e6, "MPa", 1e5), (1e3, "kPa", 1e2)),
    "Pa/m": ((1e9, "GPa/m", 1e9), (1e6, "MPa/m", 1e5)),
    "N": ((1e6, "MN", 1e7), (1e3, "kN", 1e2)),
    "N/m": ((1e6, "MN/m", 1e6), (1e3, "kN/m", 1e3)),
}


def engineering(value: float, si: str) -> str:
    """A value in an SI unit with three figures and the unit of engineers: 3e6 Pa is "3.00 MPa"; other units stay."""
    for factor_, unit, least in ENGINEERING.get(si, ()):
        if abs(value) >= least:
            return f"{three_figures(value / factor_)} {unit}"
    return f"{three_figures(value)} {si}".rstrip()


def three_figures(value: float) -> str:
    """Three significant figures without an exponent: 3.00, 41.2, 1250; zero is 0."""
    rounded = float(f"{value:.3g}")
    if rounded == 0.0:
        return "0"
    return f"{rounded:.{max(0, 2 - math.floor(math.log10(abs(rounded))))}f}"


def pattern(si: str) -> str:
    """Regular expression of JSON Schema for text that may be a quantity in `si`: no common unit of another kind."""
    si = "m/s^2" if si == "g" else si
    others = sorted({unit for kind, there in COMMON.items() if kind != si for unit in there} - set(COMMON[si]))
    strange = "|".join(re.escape(unit) for unit in others)
    return rf"^\s*{NUMBER} +(?!(?:{strange})\s*$){FACTOR}(?: ?[*/] ?{FACTOR})*\s*$"


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    units: Any = pint.UnitRegistry()
    units.define("gravity_unit = 9.80665 m/s**2")
    return units


@lru_cache(maxsize=4096)
def factor(unit: str, si: str) -> float:
    """How many `si` one `unit` is; a specific weight stands for its density. ValueError says what is wrong with the unit."""
    unit = unit.replace("²", "^2").replace("³", "^3")
    unit = re.sub(r"(?<=[A-Za-z])([23])(?=$| ?[*/])", r"^\1", unit)  # "m3" is "m^3"
    if known := COMMON.get(si, {}).get(unit):
        return known
    try:
        return _by_pint(unit, si)
    except ValueError as error:
        if si == "kg/m^3" and unit.endswith("^3"):  # not stiffness, Pa/m, which is the same to pint
            with contextlib.suppress(ValueError):
                return _by_pint(unit, "N/m^3") / COMMON["m/s^2"]["g"]
        raise error


def _by_pint(unit: str, si: str) -> float:
    """The factor of any unit that pint knows."""
    import pint

    known = re.sub(r"\bg\b", "gravity_unit", unit) if si == "m/s^2" else unit
    try:
        if si == "Hz" and re.match(r"rad(ian)?s?\b", unit):  # pint takes a radian per second for a hertz
            return _by_pint(unit, "rad/s") / (2.0 * math.pi)
        return float(_registry().Quantity(1.0, known.replace("^", "**")).to(si.replace("^", "**")).magnitude)
    except pint.UndefinedUnitError:
        raise ValueError(f"unknown unit '{unit}'") from None
    except pint.DimensionalityError:
        raise ValueError(f"'{unit}' is not a unit of {si}") from None
    except Exception as error:  # pint raises many kinds on malformed units
        raise ValueError(f"'{unit}' is not a unit ({type(error).__name__})") from None


def parse(text: str, si: str) -> float:
    """The value of "NUMBER UNIT" in `si`; ValueError says what is wrong and what was expected."""
    wanted = f"expected a number and a unit such as '{_EXAMPLE.get(si, '1 ' + si)}'"
    found = QUANTITY.fullmatch(text.strip()) if len(text) <= LONGEST else None
    if not found:
        hint = "; the decimal sign is a point" if re.search(r"\d,\d", text) else ""
        raise ValueError(f"'{text[:LONGEST]}' is not a quantity: {wanted}{hint}")
    try:
        return float(found[1]) * factor(found[2], si)
    except ValueError as error:
        raise ValueError(f"{error}: {wanted}") from None


@dataclass(frozen=True)
class Unit:
    """Marks a field's JSON Schema with its unit; a plain schema extra would be lost where a key has its own.

    bare: whether a number without a unit is taken.
    """

    si: str
    bare: bool = True

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> dict[str, Any]:
        return {**handler(core_schema), "unit": self.si} | ({} if self.bare else {"bare": False})


def quantity(si: str, *, bare: bool = True) -> Any:
    """Field type for a number in `si`; with bare=False a number without a unit is refused."""

    def read(value: Any) -> Any:
        if isinstance(value, str):
            return parse(value, si)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"expected a number in {si}, or text such as '{_EXAMPLE.get(si, '1 ' + si)}'")
        if not bare:
            raise ValueError(f'a number without a unit is ambiguous here: write "{value} g" or "{value} m/s^2"')
        try:
            return float(value)
        except OverflowError:
            raise ValueError(f"the whole number has {len(str(abs(value)))} digits and is too large") from None

    return Annotated[float, BeforeValidator(read), Unit(si, bare)]


def _in_gravity(value: Any) -> Any:
    """A number is in g; text may be any acceleration."""
    if isinstance(value, str):
        return parse(value, "m/s^2") / COMMON["m/s^2"]["g"]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("expected a number in g or text such as '0.5 g'")
    return float(value)


@dataclass(frozen=True)
class OrText:
    """Marks a number that may be given as text with a unit, which unit depends on other keys."""

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": rf"^\s*{NUMBER} +\S.*$"}]}


#: An acceleration whose bare number is in g
Gravities = Annotated[float, BeforeValidator(_in_gravity), Unit("g")]
Length = quantity("m")
Time = quantity("s")
Acceleration = quantity("m/s^2", bare=False)
Velocity = quantity("m/s")
Frequency = quantity("Hz")
Angle = quantity("deg")
Density = quantity("kg/m^3")
Mass = quantity("kg")
Inertia = quantity("kg*m^2")
Force = quantity("N")
LineForce = quantity("N/m")
AxialStiffness = quantity("N/m")
Damping = quantity("N*s/m")
Moment = quantity("N*m")
TurningDamping = quantity("N*m*s")
Stress = quantity("Pa")
Energy = quantity("N/m")
Stiffness = quantity("Pa/m")
Area = quantity("m^2")
FlowRate = quantity("m^3/s")


@lru_cache(maxsize=1024)
def unit_of(model: type[BaseModel], name: str) -> str:
    """Unit of a key of a table; "" where it has none, or is a table itself."""
    mark = mark_of(model, name)
    return "" if mark is None else mark.si


@lru_cache(maxsize=1024)
def mark_of(model: type[BaseModel], name: str) -> Unit | None:
    """What a key of a table says of its unit; None where it has none, or is a table itself."""
    field = model.model_fields.get(name)
    if field is None:
        return None
    marks, places = list(field.metadata), [field.annotation]
    while places:
        place = places.pop()
        marks += getattr(place, "__metadata__", ())
        places += [p for p in get_args(place) if not isinstance(p, str)]
    return next((mark for mark in marks if isinstance(mark, Unit)), None)
