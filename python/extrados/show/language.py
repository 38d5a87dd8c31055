"""The language of a report: its fixed text from catalogues, numbers with the decimal sign and units of engineers.

A catalogue is languages/CODE.po, the text format of GNU gettext; English is the text itself.
"""

import ast
import math
import re
from functools import cache
from pathlib import Path

from extrados.schema.constants import GRAVITY

FOLDER = Path(__file__).parent / "languages"
#: Languages by their codes, each in its own words
NAMES = {"en": "English", "it": "italiano", "es": "español", "fr": "français", "de": "Deutsch"}
#: SI unit -> engineering units from the smallest: factor by which the value is multiplied, unit, least size
UNITS: dict[str, tuple[tuple[float, str, float], ...]] = {
    "N": ((1e-3, "kN", 0.0),),
    "N m": ((1e-3, "kN m", 0.0),),
    "N/m": ((1.0, "N/m", 0.0), (1e-3, "kN/m", 1e3)),
    "Pa": ((1e-3, "kPa", 0.0), (1e-6, "MPa", 1e4)),
    "Pa/m": ((1e-9, "N/mm³", 0.0),),
    "m": ((1e3, "mm", 0.0), (1.0, "m", 1.0)),
    "kg": ((1.0, "kg", 0.0), (1e-3, "t", 1e3)),
    "m/s^2": ((1.0 / GRAVITY, "g", 0.0),),
}
#: Digits of an exponent
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Language:
    """Words of a report in one language; a text that its catalogue lacks stays English."""

    def __init__(self, code: str = "en"):
        if code not in NAMES:
            raise ValueError(f"language '{code}' is unknown; expected one of {', '.join(NAMES)}")
        self.code = code
        self.catalogue = {} if code == "en" else catalogue(code)

    def __call__(self, text: str, **fields: object) -> str:
        """The text in this language, with its {fields} filled in."""
        told = self.catalogue.get(text) or text
        return told.format(**fields) if fields else told

    def pair(self, label: str, text: str) -> str:
        """A label and its text: French has a space before the colon, at which no line ends."""
        return f"{label}\u00a0: {text}" if self.code == "fr" else f"{label}: {text}"

    def has(self, text: str) -> bool:
        """Whether the catalogue of this language contains the text."""
        return self.code == "en" or bool(self.catalogue.get(text))

    def number(self, value: float, figures: int = 3) -> str:
        """A number of some significant figures."""
        if not math.isfinite(value):
            return "∞" if value > 0 else "−∞" if value < 0 else "?"
        if value == 0.0:
            return "0"
        size = math.floor(math.log10(abs(float(f"{value:.{figures - 1}e}"))))
        if not -4 <= size < 7:
            mantissa = self.number(value / 10.0**size, figures)
            return f"{mantissa} × 10{str(size).translate(RAISED)}"
        places = max(0, figures - 1 - size)
        return self._signed(f"{round(value, figures - 1 - size):.{places}f}")

    def given(self, value: float) -> str:
        """A number as somebody gave it: all its figures, six at most, no zeros behind them."""
        text = self.number(value, 6)
        sign = "." if self.code == "en" else ","
        head, _, tail = text.partition(" ")
        if sign in head:
            head = head.rstrip("0").rstrip(sign)
        return f"{head} {tail}".strip()

    def quantity(self, value: float, unit: str, given: bool = False) -> str:
        """A value in SI as engineers write it: kN, MPa, mm, with three figures, or with those that were given."""
        factor, shown, _ = next((row for row in reversed(UNITS.get(unit, ())) if abs(value) >= row[2]), (1.0, unit, 0.0))
        shown = re.sub(r"\^(\d)", lambda found: found[1].translate(RAISED), shown)
        text = self.given(value * factor) if given else self.number(value * factor)
        return f"{text} {self(shown)}".strip()

    def _signed(self, text: str) -> str:
        return text.replace("-", "−").replace(".", "." if self.code == "en" else ",")


@cache
def catalogue(code: str) -> dict[str, str]:
    """English text -> its translation; ValueError where a line of the catalogue is none of its format."""
    found: dict[str, str] = {}
    parts = {"msgid": "", "msgstr": ""}
    now = "msgid"
    for number, line in enumerate((FOLDER / f"{code}.po").read_text(encoding="utf-8").splitlines(), start=1):
        word, _, rest = line.strip().partition(" ")
        if not word or word.startswith("#"):
            continue
        if word in parts:
            if word == "msgid" and now == "msgstr":
                found[parts["msgid"]] = parts["msgstr"]
            now, parts[word] = word, ""
        else:
            rest = line.strip()
        if not (rest.startswith('"') and rest.endswith('"')):
            raise ValueError(f"{code}.po:{number}: expected msgid or msgstr and text in quotes")
        parts[now] += ast.literal_eval(rest)
    found[parts["msgid"]] = parts["msgstr"]
    found.pop("", None)
    return found
