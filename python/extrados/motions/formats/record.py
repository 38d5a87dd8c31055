"""What a reader returns, and how a file is read with suspicion."""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from extrados.schema import files
from extrados.schema.files import File

LARGEST = 50_000_000  # bytes: three hours at 200 samples a second, ten times what a record needs

LONGEST_WORDS = 2000  # characters of a header line that are looked at
LONGEST_NUMBER = 60  # characters
ALIKE = 20  # numbers of equally many decimals by which a last one with fewer is known to be cut off
SHORTEST_STEP, LONGEST_STEP = 1e-4, 0.5  # s: sampling steps that a file of a strong motion may have

#: How the note on rounded times ends; a time_step of the deck replaces this note
MEAN_STEP = "the program uses their mean time step"

#: Units a file or a deck may name, in SI. gal is cm/s^2.
ACCELERATION = {"g": 9.80665, "m/s^2": 1.0, "cm/s^2": 0.01, "gal": 0.01, "mm/s^2": 0.001, "in/s^2": 0.0254, "mg": 9.80665e-3}
VELOCITY = {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001, "in/s": 0.0254}
DISPLACEMENT = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
QUANTITIES = {"acceleration": ACCELERATION, "velocity": VELOCITY, "displacement": DISPLACEMENT}

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d{1,3})?\Z", re.ASCII)
_PLAIN = re.compile(r"[0-9eE+\-. ]*\Z", re.ASCII)


class RecordError(ValueError):
    """A record cannot be read or used; the text begins with file and, where known, line."""


@dataclass(frozen=True)
class Record:
    """Samples as in the file [unit of the file] at `step` [s]; step or unit None where the file has none.

    component: the channel's own name or direction; title, station: of the event and where it was recorded, as the file
    says. notes: what was mended or ought to be known. rounded: to which the times are rounded that give the step [s].
    """

    name: str
    values: np.ndarray
    step: float | None
    unit: str | None
    quantity: str = "acceleration"
    component: str = ""
    notes: list[str] = field(default_factory=list)
    title: str = ""
    station: str = ""
    rounded: float = 0.0


@dataclass(frozen=True)
class Lines:
    """The lines of a file, counted from 0; complaints count from 1 as editors do. ended: whether the last one has its end."""

    path: Path
    lines: list[str]
    ended: bool = True

    def __len__(self) -> int:
        return len(self.lines)

    def __getitem__(self, at: int) -> str:
        return self.lines[at] if at < len(self.lines) else ""

    def words(self, at: int) -> str:
        """The line as a header is read; see `tidy`."""
        return tidy(self[at])

    def error(self, at: int, what: str) -> RecordError:
        """A complaint about line `at`."""
        return RecordError(f"{self.path}:{min(at, max(len(self.lines) - 1, 0)) + 1}: {what}")

    def cut(self, have: int, want: int) -> RecordError:
        """The complaint of a file that ends too early."""
        return self.error(len(self.lines) - 1, f"the file ends after {have} of {want} values: it is cut off, or its header is wrong")

    def number(self, token: str, at: int) -> float:
        """A token as a finite number, no NaN, no decimal comma, no Python spelling."""
        token = token.strip()
        if len(token) > LONGEST_NUMBER:
            raise self.error(at, f"'{token[:30]}...' has {len(token)} characters, but a number has at most {LONGEST_NUMBER}")
        if not _NUMBER.match(token):
            hint = "; the decimal sign is a point" if re.fullmatch(r"[+-]?\d*,\d+", token) else ""
            raise self.error(at, f"'{token[:30]}' is not a number{hint}")
        value = float(token.replace("d", "e").replace("D", "e"))
        if not np.isfinite(value):
            raise self.error(at, f"'{token[:30]}' is too large for a number")
        return value

    def integer(self, token: str, at: int) -> int:
        """A token as a whole number."""
        if not re.fullmatch(r"\s*[+-]?\d{1,12}\s*", token, re.ASCII):
            raise self.error(at, f"'{token.strip()[:30]}' is not a whole number")
        return int(token)

    def step(self, token: str, at: int) -> float:
        """A token as a time step [s]."""
        value = self.number(token, at)
        if not SHORTEST_STEP <= value < LONGEST_STEP:
            raise self.error(at, f"the time step is {value:g} s, expected {SHORTEST_STEP:g} s to less than {LONGEST_STEP:g} s")
        return value

    def numbers(self, rows: list[tuple[int, list[str]]]) -> np.ndarray:
        """All tokens of (line, tokens) rows as one array; the first bad token is named with its line."""
        self._refuse_cut_number(rows)
        tokens = [token for _, row in rows for token in row]
        if all(map(_PLAIN.match, tokens)) and max(map(len, tokens), default=0) <= LONGEST_NUMBER:
            try:
                values = np.array(tokens, dtype=float)
                if np.isfinite(values).all():
                    return values
            except ValueError:
                pass
        return np.array([self.number(token, at) for at, row in rows for token in row])

    def _refuse_cut_number(self, rows: list[tuple[int, list[str]]]) -> None:
        """RecordError where the last number of the file has fewer decimals than all of those above it, which have equally many,
        and its line has no end."""
        if self.ended or len(rows) <= ALIKE or rows[-1][0] < len(self.lines) - 1:
            return
        decimals = {len(row[-1].strip().partition(".")[2]) for _, row in rows[-1 - ALIKE : -1]}
        at, last = rows[-1][0], rows[-1][1][-1].strip()
        if len(decimals) == 1 and len(last.partition(".")[2]) < max(decimals):
            raise self.error(
                at,
                f"the last number '{last[:30]}' has fewer decimals than the numbers above, so the file is cut off there: complete "
                "this number, or delete the last line",
            )

    def blanks(self, start: int) -> list[tuple[int, list[str]]]:
        """Rows of tokens between blanks; empty lines are left out."""
        rows = ((at, self.lines[at].split()) for at in range(start, len(self.lines)))
        return [(at, row) for at, row in rows if row]

    def fixed(self, start: int, count: int, width: int, columns: int) -> tuple[np.ndarray, int]:
        """`count` values in columns of fixed width (they may touch), and the line after them."""
        rows: list[tuple[int, list[str]]] = []
        have, at = 0, start
        while have < count:
            if at >= len(self.lines):
                raise self.cut(have, count)
            line = self.lines[at].rstrip()
            row = [line[k : k + width] for k in range(0, min(len(line), width * columns), width)]
            row = row[: count - have]
            if len(row) < min(columns, count - have):
                raise (
                    self.cut(have + len(row), count)
                    if at >= len(self.lines) - 1
                    else self.error(
                        at, f"this line has {len(row)} values, expected {min(columns, count - have)} values of {width} characters each"
                    )
                )
            if len(row[-1]) < width and at == len(self.lines) - 1 and have + len(row) == count and len(line) % width:
                raise self.error(at, "the last value is cut off")
            rows.append((at, row))
            have += len(row)
            at += 1
        return self.numbers(rows), at

    def check_count(self, values: np.ndarray, count: int, at: int) -> tuple[np.ndarray, list[str]]:
        """The first `count` values; a few too many are cut with a note, too few are refused."""
        if len(values) < count:
            raise self.cut(len(values), count)
        if len(values) == count:
            return values, []
        if len(values) - count > max(8, count // 100):
            raise self.error(at, f"the header states {count} values, but {len(values)} follow")
        return values[:count], [f"{self.path.name}: the header states {count} values, but {len(values)} follow; the rest is ignored"]


def tidy(text: str) -> str:
    """Words of a header, their first LONGEST_WORDS characters, with at most two blanks between.

    What is looked for in headers is looked for again from every place where it might begin: without a bound the time
    would grow with the square of a line of blanks.
    """
    return re.sub(r"\s{3,}", "  ", text[: 100 * LONGEST_WORDS])[:LONGEST_WORDS]


def read_file(file: str | Path, folder: Path | None = None) -> File:
    """The file that a deck in `folder` names, or the one at a path; RecordError where it cannot be read."""
    try:
        return files.read(file, LARGEST, folder)
    except files.BadFile as error:
        raise RecordError(str(error)) from None


def read_lines(file: File) -> Lines:
    """The lines of a record; refuses what is no text."""
    path, raw = file.path, file.content
    if not raw.strip():
        raise RecordError(f"{path}: this file is empty; expected an accelerogram")
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise RecordError(f"{path}:1: this file is UTF-16 text: save it as UTF-8 or ASCII")
    if b"\0" in raw:
        line = raw[: raw.index(b"\0")].count(b"\n") + 1
        raise RecordError(f"{path}:{line}: this file is binary; expected text")
    text = raw.decode("utf-8-sig", errors="replace")
    ended = text.endswith(("\n", "\r", "\x1a"))
    return Lines(path, re.split(r"\r\n|\n|\r", text.rstrip("\r\n \t\x1a")), ended)


def said_in(lines: list[str]) -> tuple[str, str]:
    """Event and station of header lines: the first that speaks of an earthquake, and what follows 'station'; "" where
    they say neither."""
    event = next((line.strip() for line in lines if re.search(r"\bearthquake\b", line, re.I)), "")
    found = (
        re.search(r"\bsta(?:tion|tn|\b)\s*(?:no\b\.?)?\s*[:=.]?\s+(?=\S)(.+?)\s*(?:\bcomponent\s*=.*)?$", line, re.I)
        for line in lines
        if not re.search(r"\bsta(?:tion|tn)?\s+chan", line, re.I)
    )
    station = next((match[1] for match in found if match), "")
    return " ".join(re.sub(r"(?i)^(?:record|rcrd) of ", "", event).split()), " ".join(station.split())


def fortran_columns(text: str) -> tuple[int, int] | None:
    """(columns, width) of a Fortran format such as (8F10.5), 8E10.4 or (10I8) in a text; None if there is none."""
    found = re.search(r"\(\s*(\d{1,2})\s*[FEGDI]\s*(\d{1,2})(?:\.\d+)?\s*\)", tidy(text), re.I)
    return (int(found[1]), int(found[2])) if found and int(found[1]) and int(found[2]) else None


#: Units of time that a column may be in, in seconds
TIME = {"ms": 1e-3, "us": 1e-6, "min": 60.0, "s": 1.0}
_TIMES = (
    ("ms", r"m(?:illi)?s(?:ec(?:ond)?s?)?"),
    ("us", r"[uµμ]s(?:ec)?|microsec(?:ond)?s?"),
    ("min", r"min(?:ute)?s?"),
    ("s", r"s(?:ec(?:ond)?s?)?"),
)


def time_unit_in(name: str) -> str | None:
    """The unit of time that the name of a column ends in, such as time_ms, t [s] or Time (sec); None without one."""
    low = name.strip().lower()
    for unit, words in _TIMES:
        if re.search(rf"(?:^|[\s_\[(/,])(?:{words})[\])]?\s*$", low):
            return unit
    return None


_SECOND = r" ?/ ?(?:s(?:ec)?(?: ?(?:\^|\*\*) ?)?2(?!\d)|s(?:ec)? ?[/*.] ?s(?:ec)?|s²|sec\^?2)"
_BEFORE = r"\bunits?\b(?:\s+(?:are|is|of|in)\b)*\s*[:=]?\s*|\bin\s+|[\(\[_]\s*"

_VALUE = rf"\d\s*(?:(?:mm|cm|m)(?:{_SECOND}|\s*/\s*s(?:ec)?)?|in(?:{_SECOND}|\s*/\s*s(?:ec)?)|gals?|m?g)(?![a-z])"


def _gravities(low: str, unit: str) -> bool:
    """Whether a text names g, or mg, as a unit and not as a letter of a name."""
    pattern = rf"(?:{_BEFORE})[\(\[\"]?{unit}(?:'?s)?\"?(?![a-z0-9/*])|[,;]\s*{unit}\s*(?=[,;\n]|$)"
    return re.search(pattern, low) is not None


def units_in(text: str, quantity: str = "acceleration") -> list[str]:
    """All units of a quantity that a header text names; a value with its unit, such as a peak, names none."""
    low = re.sub(_VALUE, " ", tidy(text).lower())
    if quantity == "acceleration":
        found = [f"{length}/s^2" for length in ("cm", "mm", "in", "m") if re.search(rf"(?<![a-z]){length}{_SECOND}", low)]
        found += ["gal"] if re.search(r"(?<![a-z])gals?(?![a-z])", low) else []
        return found + [unit for unit in ("mg", "g") if _gravities(low, unit)]
    found = []
    for unit in QUANTITIES[quantity]:
        length, _, per = unit.partition("/")
        rate = rf"(?!{_SECOND})\s*/\s*s(?:ec)?(?![a-z])" if per else r"(?![a-z/])"
        inch = r"(?<![a-z])inch|[\(\[]\s*in\.?\s*[\)\]]"  # "in" is a word too
        found += [unit] if re.search(inch if unit == "in" else rf"(?<![a-z]){length}{rate}", low) else []
    return found


def unit_in(text: str, quantity: str = "acceleration") -> str | None:
    """The one unit that a header text names; None where it names none, or several of different size."""
    found = units_in(text, quantity)
    return found[0] if len({QUANTITIES[quantity][unit] for unit in found}) == 1 else None


_WORDS = {
    "acceleration": r"(?<![a-z])acc(?![io])",
    "velocity": r"(?<![a-z])vel(?:oc\w*)?(?![a-z])",
    "displacement": r"(?<![a-z])displ?(?:acem\w*)?(?![a-z])",
}
_WAVES = r"(?:shear|s|p|secondary|primary)[\s-]+(?:wave\s+)?velocity|velocity\s+(?:model|structure)|vs_?30"


def quantities_in(text: str) -> list[str]:
    """What a header says that its numbers are, by its words and units: none, one, or several of QUANTITIES."""
    low = re.sub(_WAVES, "", tidy(text).lower())
    found = [name for name, word in _WORDS.items() if re.search(word, low) or (name != "displacement" and units_in(low, name))]
    sure = [name for name in found if units_in(low, name)]
    return sure if len(sure) == 1 else found
