"""The properties of the building that an answer rests on: their values, and who set them."""

from typing import Any, Literal

from extrados.results.fields import ResultModel, fact
from extrados.schema.quantities import ENGINEERING, engineering

#: Who set a property
Origin = Literal["default", "deck", "analysis", "method"]
#: The key that every answer which rests on it tells, whatever its value
FRICTION = "joints.friction"
NO_SLIDING = "no-sliding"
#: Keys whose names in words differ from the keys
LABELS = {"young": "Young's modulus", "poisson": "Poisson's ratio"}


class Assumption(ResultModel):
    """One property of the building as an analysis used it."""

    value: Any = fact("value, in `unit`; null if the deck gives no value and the analysis needs none")
    unit: str = fact("unit of the value")
    origin: Origin = fact(
        "origin of the value: default of the program, table of the deck, table of the analysis, or the method (if the "
        "method allows one value only)",
        name="from",
    )
    exceptions: bool = fact("whether some joints or parts have different values")


def spoken(assumptions: dict[str, Assumption]) -> str:
    """One sentence such as "Friction 0.7 (default), density 2000 kg/m^3 (deck)."; friction first, what is not given or
    zero by default left out; "" without assumptions."""
    order = sorted(assumptions, key=lambda name: name != FRICTION)
    words = [_words(name, assumptions[name]) for name in order if name == FRICTION or not _silent(assumptions[name])]
    text = ", ".join(words)
    return text[:1].upper() + text[1:] + "." if text else ""


def _silent(one: Assumption) -> bool:
    return one.value is None or (one.value == 0 and one.origin == "default" and not one.exceptions)


def _words(name: str, one: Assumption) -> str:
    key = name.rpartition(".")[2]
    word = LABELS.get(key, key.replace("_", " "))
    if one.unit in ENGINEERING and isinstance(one.value, int | float):
        said = f"{word} {engineering(one.value, one.unit)}"
    else:
        said = "no sliding" if one.value == NO_SLIDING else f"{word} {shown(one.value)} {one.unit}".rstrip()
    return f"{said} ({one.origin}{', some differ' if one.exceptions else ''})"


def shown(value: Any) -> str:
    """A value as words tell it."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
