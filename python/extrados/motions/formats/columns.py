"""Plain columns: acceleration alone; time and acceleration; time and several components; components; rows of a series.

Blanks, tabs, commas or semicolons between, any header of words, comments after '#'. A layout that the file does not
make plain is refused, with what was seen: numbers of a header, several columns without time, a time that jumps.
"""

import re
from typing import Literal

import numpy as np

from extrados.motions.formats.record import (
    LONGEST_STEP,
    MEAN_STEP,
    SHORTEST_STEP,
    TIME,
    Lines,
    Record,
    fortran_columns,
    quantities_in,
    tidy,
    time_unit_in,
    unit_in,
)

#: What several columns without time are: rows of one series, or a component each
Columns = Literal["series", "components"]
MOST_HEADER = 60
ROUNDED = 3.0  # units of the last decimal in a step, at least, for uneven steps to be rounding
HEAD = 16  # rows in which numbers of a header are looked for
FEWEST = 10  # samples by which a column that ascends is known as a time


def read(text: Lines, columns: Columns | None = None) -> list[Record]:
    """Every acceleration, velocity or displacement of a text in columns; `columns` where the file does not make it plain."""
    header, rows = _split(text)
    if not rows:
        raise text.error(0, "this file contains no numbers; expected acceleration, or time and acceleration, in columns")
    _refuse_decimal_commas(text, [at for at, _ in rows])
    width = len(rows[0][1])
    if odd := next((row for row in rows[:-1] if len(row[1]) != width), None):
        raise text.error(odd[0], f"this line has {len(odd[1])} columns, but the lines above have {width}{_header_hint(odd[0])}")
    short = len(rows[-1][1]) != width  # the last row of a series may be
    table = text.numbers(rows[:-1] if short else rows).reshape(-1, width)
    said = "\n".join(tidy(line).strip() for line in header)
    _refuse_factor(text, said)
    (names, sure), rounded = _names(header, width), _resolution(rows) if width > 1 else 0.0
    timed = width > 1 and (_called_time(names[:1]) or _ascends(table[:, 0], 3) or _is_time(table[:, 0], rounded))
    names = names if sure or not timed else []  # words of a sentence
    counted = _counted(said)
    if columns == "series" or width == 1 or (not timed and columns is None and _said_series(said, width, counted, rows)):
        values = np.append(table.ravel(), text.numbers(rows[-1:])) if short else table.ravel()
        step, rounded, notes, data, names = _stated_step(text, said), 0.0, [], values[:, None], []
        for stride in range(1, max(4, width) + 1):
            if _ascends(values[::stride]):
                what = "the values increase like times" if stride == 1 else f"values that are {stride} places apart increase like times"
                raise text.error(rows[0][0], f"{what}: give time and acceleration in two columns")
    elif short:
        last = f"the last line has {len(rows[-1][1])} columns, but the lines above have {width}"
        raise text.error(rows[-1][0], f"{last}, so the file is cut off{_or_series(timed)}")
    elif timed:
        given = time_unit_in(names[0]) if names else None
        per = TIME[given or "s"]
        step, uneven = _step(text, rows, table[:, 0], rounded, given)
        stated = _stated_step(text, said)
        if stated is not None and abs(stated - step) > 0.02 * step:
            raise text.error(
                rows[0][0], f"the header states a time step of {stated:g} s, but the times have a step of {step:g} s: delete the wrong one"
            )
        notes = [f"the times of {text.path.name} are in {given}"] if given not in (None, "s") else []
        if uneven:
            notes.append(f"the times of {text.path.name} are rounded to {1e3 * per * rounded:g} ms; {MEAN_STEP}")
        data, names, rounded = table[:, 1:], names[1:] or [f"column {k + 2}" for k in range(width - 1)], per * rounded
    elif columns == "components" or names:
        step, rounded, notes, data = _stated_step(text, said), 0.0, [], table
        names = names or [f"column {k + 1}" for k in range(width)]
    else:
        raise text.error(
            rows[0][0],
            f"the row has {width} columns, and the first is not a time with equal steps. If each column is a component, give the "
            f'number of one of them as `channel` (1 to {width}). If the numbers are one series, row after row, give columns = "series"',
        )
    if not timed or columns == "series":
        _refuse_header_numbers(text, rows, data)
    if counted is not None and counted not in (len(table), data.size):
        raise text.error(
            len(text) - 1, f"the header states {counted} values, but {data.size} follow: the file is cut off, or its header is wrong"
        )
    title = next((line.strip() for line in header if _is_title(line)), "")
    found = []
    for k in range(data.shape[1]):
        name = names[k] if k < len(names) else ""
        if _called_time([name]) or (width > 1 and _ascends(data[:, k])):
            raise text.error(
                rows[0][0], f"column {k + 1 + timed} contains times, but the first column does not: put the times in the first column"
            )
        quantity = _quantity(text, name if sure else "", said)
        found.append(
            Record(
                text.path.stem,
                data[:, k].copy(),
                step,
                (unit_in(name, quantity) if sure else None) or unit_in(said, quantity),
                quantity,
                component=name if data.shape[1] > 1 else "",
                notes=list(notes),
                title=title,
                rounded=rounded,
            )
        )
    return found


def _quantity(text: Lines, name: str, said: str) -> str:
    """What a column holds, by its name or else by the header; acceleration where neither says so."""
    found = quantities_in(name) or quantities_in(said) or ["acceleration"]
    if len(found) > 1:
        raise text.error(0, f"the header names {' and '.join(found)}: keep only the quantity that the numbers give")
    return found[0]


def _header_hint(at: int) -> str:
    return "; put # before the lines of a header" if at < HEAD else ""


def _or_series(timed: bool) -> str:
    return "" if timed else '; if the rows are one series, row after row, give columns = "series"'


def _called_time(names: list[str]) -> bool:
    """Whether the (first) name is that of a time."""
    return bool(names) and re.match(r"\s*(?:time|t)\b|\s*(?:time|t)_m?s(?:ec)?\b", names[0], re.I) is not None


def _ascends(column: np.ndarray, fewest: int = FEWEST) -> bool:
    """True for values that grow nearly always, as times do and accelerations do not."""
    if len(column) < fewest or column[-1] <= column[0]:
        return False
    steps = np.diff(column)
    return bool((steps >= 0.0).all() or (np.mean(steps >= 0.0) >= 0.9 and np.mean(steps > 0.0) >= 0.5))


def _stated_step(text: Lines, said: str) -> float | None:
    """The step that the words of a header state [s]."""
    found = re.search(
        r"(?:\bdt|time\s*step|(?:equal\s+)?spacing|sampling\s+(?:interval|step))\s*(?:of|=|:|is)?\s*(\d+\.?\d*|\.\d+)\s*(ms|s)", said, re.I
    )
    return text.step(repr(float(found[1]) * TIME[found[2].lower()]), 0) if found else None


def _counted(said: str) -> int | None:
    """The number of samples that the words of a header state."""
    found = re.search(r"\b(\d{2,9})\s+(?:data\s+)?(?:points|samples|values)\b", said, re.I)
    return int(found[1]) if found else None


def _said_series(said: str, width: int, counted: int | None, rows: list[tuple[int, list[str]]]) -> bool:
    """Whether a header makes it plain that rows of several numbers are one series: by its format, or by their count."""
    form = fortran_columns(f"({found[0]})") if (found := re.search(r"\b\d{1,2}[FEG]\d{1,2}\.\d+", said, re.I)) else None
    form = form or fortran_columns(said)
    return (form is not None and form[0] == width) or counted == sum(len(row) for _, row in rows)


def _refuse_factor(text: Lines, said: str) -> None:
    """A factor that the header states and that the numbers are without."""
    found = re.search(
        r"\b(?:scal\w*|conversion|multipl\w*)\s*(?:factor|by)?\s*(?:=|:|of|is|by)?\s*(\d+\.?\d*(?:e[+-]?\d+)?|\.\d+)", said, re.I
    )
    if found and float(found[1]) != 1.0:
        raise text.error(
            0,
            f"the header states '{found[0].strip()}', but the program does not apply a factor from a header: multiply the "
            "values by this factor and delete these words",
        )


def _refuse_header_numbers(text: Lines, rows: list[tuple[int, list[str]]], data: np.ndarray) -> None:
    """Numbers of a header that stand before the samples as if they were some: counts, dates, codes."""
    hint = "if this line is part of the header, put # before the lines of the header; if it is a sample, write the values with decimals"
    whole = [all(re.fullmatch(r"[+-]?\d+", token) for token in row) for _, row in rows]
    first = whole.index(False) if False in whole else len(whole)
    digits = [any(token.strip("+-0") for token in row) for _, row in rows[:first]]
    if 0 < first < len(rows) and any(digits) and np.mean(whole[first:]) < 0.1:
        at = rows[digits.index(True)][0]
        raise text.error(
            at,
            f"'{text[at].strip()[:40]}' contains whole numbers, but the samples have decimals, so this line seems to belong "
            f"to a header; {hint}",
        )
    left = sum(len(row) for _, row in rows)
    for k, (at, row) in enumerate(rows[:HEAD]):
        left -= len(row)
        if any(re.fullmatch(r"\d{2,9}", token) and int(token) in (left, left + len(row) - 1, len(rows) - k - 1) for token in row):
            raise text.error(
                at,
                f"'{text[at].strip()[:40]}' contains a number equal to the count of the values that follow, so this line seems to "
                f"belong to a header; {hint}",
            )
    per = max(1, data.size // max(len(rows), 1)) if data.shape[1] == 1 else 1
    if len(data) >= 6 * HEAD * per:
        peaks = np.abs(data[: HEAD * per]).max(axis=1), np.abs(data[HEAD * per :]).max()
        if peaks[0].max() > 2.0 * peaks[1] and peaks[1] > 0.0:
            at = rows[int(peaks[0].argmax()) // per][0]
            raise text.error(
                at,
                f"'{text[at].strip()[:40]}' exceeds twice the greatest value below the first {HEAD} rows, so this line seems to "
                f"belong to a header; {hint}",
            )


def _split(text: Lines) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header lines and (line, tokens) of the numbers."""
    header: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    for at, line in enumerate(text.lines):
        bare, _, comment = line.partition("#")
        tokens = bare.replace(",", " ").replace(";", " ").split()
        if not rows and (not tokens or not re.match(r"[+-]?(?:\.?\d|nan\b|inf)", tokens[0], re.I) or _wordy(tokens)):
            header.append(comment if not tokens else bare)
            if len(header) > MOST_HEADER:
                raise text.error(at, f"the first {MOST_HEADER} lines contain no numbers")
            continue
        if tokens:
            rows.append((at, tokens))
    return header, rows


def _wordy(tokens: list[str]) -> bool:
    """True for a header line that begins with a number, such as '1559 points at equal spacing'."""
    return any(re.fullmatch(r"[A-Za-z]{3,}.*", token) and token.lower() not in ("nan", "inf", "infinity") for token in tokens)


def _refuse_decimal_commas(text: Lines, lines: list[int]) -> None:
    """'0,02 0,0063' is refused; '0,0' as the first row of comma-separated columns is not."""
    bare = {at: line for at in lines if "," in (line := text[at].partition("#")[0])}
    for at, line in bare.items():
        words = line.replace(";", " ").split()
        if len(words) > 1 and any(re.fullmatch(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?", w) for w in words):
            raise text.error(at, f"'{text[at].strip()[:40]}' contains decimal commas: use a decimal point")
    parts = [line.replace(" ", "").split(",") for line in bare.values()]
    if len(bare) == len(lines) and all(
        len(row) % 2 == 0 and all(re.fullmatch(r"[+-]?\d+", w) for w in row[::2]) and all(map(_fraction, row[1::2])) for row in parts
    ):
        raise text.error(lines[0], f"'{bare[lines[0]].strip()[:40]}' contains decimal commas: use a decimal point")


def _fraction(word: str) -> bool:
    """Whether a word may be what follows a decimal sign."""
    return re.fullmatch(r"\d+(?:[eE][+-]?\d+)?", word) is not None


def _is_title(line: str) -> bool:
    """True for a line of words about the record, none of which is the name of a column."""
    words = re.findall(r"[A-Za-z]{3,}", line)
    return len(words) > 1 and not re.search(r"\b(?:time|acc\w*|spac\w+|points|dt|npts|units?)\b", line, re.I)


def _resolution(rows: list[tuple[int, list[str]]]) -> float:
    """To which the numbers of the first column are rounded: a unit of their last decimal; 0 where some have an exponent."""
    first = [row[0] for _, row in rows]
    if re.search(r"[eEdD]", " ".join(first)):
        return 0.0
    return float(10.0 ** -max(len(token.partition(".")[2]) for token in first))


def _even(column: np.ndarray, rounded: float) -> bool:
    """True where times lie within their rounding of equal steps, which are several times as long."""
    count = len(column) - 1
    step = (column[-1] - column[0]) / max(count, 1)
    even = column[0] + step * np.arange(count + 1)
    return bool(step > ROUNDED * rounded and np.abs(column - even).max() <= 1.001 * rounded)


def _is_time(column: np.ndarray, rounded: float) -> bool:
    """True for a column that ascends in equal steps."""
    steps = np.diff(column)
    if len(column) < 3 or not (steps > 0.0).all():
        return False
    usual = _median(steps)
    return bool(np.all(np.abs(steps - usual) <= 0.02 * usual)) or _even(column, rounded)


def _median(values: np.ndarray) -> float:
    """As numpy's, which for it alone loads the arrays with masks: a fiftieth of the time of `extrados check`."""
    ordered = np.sort(values)
    half = len(ordered) // 2
    return float(ordered[half] if len(ordered) % 2 else 0.5 * (ordered[half - 1] + ordered[half]))


def _step(text: Lines, rows: list[tuple[int, list[str]]], time: np.ndarray, rounded: float, given: str | None) -> tuple[float, bool]:
    """The step [s] of a time column in a unit (seconds where none is given), and whether only rounding makes it uneven."""
    if len(time) < 3:
        raise text.error(rows[-1][0], f"the file has only {len(time)} samples; a record has at least three")
    steps = np.diff(time)
    step = _median(steps)
    if not step > 0.0:
        raise text.error(rows[int(np.argmin(steps)) + 1][0], "the times in the first column do not increase")
    off = np.flatnonzero(np.abs(steps - step) > 0.02 * step)
    uneven = bool(off.size) and _even(time, rounded)
    if off.size and not uneven:
        k = int(off[0])
        raise text.error(
            rows[k + 1][0], f"the time step is {steps[k]:g} s here and {step:g} s elsewhere: resample the record to equal steps"
        )
    step = TIME[given or "s"] * (time[-1] - time[0]) / (len(time) - 1)
    if not SHORTEST_STEP <= step < LONGEST_STEP:
        raise text.error(
            rows[0][0],
            f"the time step is {step:g} s, which is not plausible for an accelerogram. If the times are in milliseconds, name their "
            "column `time_ms`. If the column contains sample numbers, delete the column",
        )
    return float(np.round(step, 9)), uneven


def _names(header: list[str], width: int) -> tuple[list[str], bool]:
    """Column names, where the last line of words has as many as there are columns, and whether these words are surely names:
    separated by more than blanks, or the first is that of a time."""
    last = next((line for line in reversed(header) if line.strip()), "")
    for words in ([w.strip() for w in re.split(r"[,;\t]", last)], last.split()):
        if len(words) == width and not any(re.fullmatch(r"[+-]?\d*\.?\d*", w) for w in words):
            return words, words != last.split() or _called_time(words[:1])
    return [], False
