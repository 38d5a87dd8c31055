"""Plain columns: acceleration alone; time and acceleration; time and several components.

Blanks, tabs, commas or semicolons between, any header, comments after '#'. Rows of several numbers without a time
column are one series, as OpenSees reads a path file.
"""

import re

import numpy as np

from extrados.motions.formats.record import TIME, Lines, Record, tidy, time_unit_in, unit_in

MOST_HEADER = 60
LONGEST_STEP = 0.5  # s: longer steps of a column that names no unit are milliseconds, or no record
ROUNDED = 3.0  # units of the last decimal in a step, at least, for uneven steps to be rounding


def read(text: Lines) -> list[Record]:
    """The one record of a text in columns: acceleration, or time [s] and acceleration."""
    header, rows = _split(text)
    if not rows:
        raise text.error(0, "holds no numbers; expected acceleration, or time and acceleration, in columns")
    _refuse_decimal_commas(text, [at for at, _ in rows])
    width = len(rows[0][1])
    odd = next((at for at, row in rows[:-1] if len(row) != width), None)
    if odd is not None:
        raise text.error(odd, f"{len(text[odd].split())} columns where {width} stood before")
    short = len(rows[-1][1]) != width  # the last row of a path file may be
    table = text.numbers(rows[:-1] if short else rows).reshape(-1, width)
    said = " \n".join(map(tidy, header))
    title = next((line.strip() for line in header if _is_title(line)), "")
    unit = unit_in(said)
    rounded = _resolution(rows) if width > 1 else 0.0
    if width > 1 and (width == 2 or _is_time(table[:, 0], rounded)):
        if short:
            raise text.error(rows[-1][0], f"{len(rows[-1][1])} columns where {width} stood before: the file is cut off")
        names = _names(header, width)
        given = time_unit_in(names[0])
        per = TIME[given or "s"]
        step, uneven = _step(text, rows, table[:, 0], rounded, given)
        notes = [f"times of {text.path.name} are in {given}"] if given not in (None, "s") else []
        if uneven:
            notes.append(
                f"times of {text.path.name} are rounded to {1e3 * per * rounded:g} ms; their mean step is taken"
            )
        return [
            Record(
                text.path.stem,
                table[:, k].copy(),
                step,
                unit_in(names[k]) or unit,
                component=names[k] if width > 2 else "",
                notes=list(notes),
                title=title,
                rounded=per * rounded,
            )
            for k in range(1, width)
        ]
    values = np.append(table.ravel(), text.numbers(rows[-1:])) if short else table.ravel()
    steps = re.search(
        r"(?:\bdt|time\s*step|(?:equal\s+)?spacing|sampling\s+(?:interval|step))\s*(?:of|=|:|is)?\s*(\d+\.?\d*|\.\d+)\s*s",
        said,
        re.I,
    )
    step = text.step(steps[1], 0) if steps else None
    return [Record(text.path.stem, values, step, unit, title=title)]


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
                raise text.error(at, f"no numbers in the first {MOST_HEADER} lines")
            continue
        if tokens:
            rows.append((at, tokens))
    return header, rows


def _wordy(tokens: list[str]) -> bool:
    """True for a header line that begins with a number, such as '1559 points at equal spacing'."""
    return any(
        re.fullmatch(r"[A-Za-z]{3,}.*", token) and token.lower() not in ("nan", "inf", "infinity") for token in tokens
    )


def _refuse_decimal_commas(text: Lines, lines: list[int]) -> None:
    """'0,02 0,0063' is refused; '0,0' as the first row of comma-separated columns is not."""
    bare = {at: line for at in lines if "," in (line := text[at].partition("#")[0])}
    for at, line in bare.items():
        words = line.replace(";", " ").split()
        if len(words) > 1 and any(re.fullmatch(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?", w) for w in words):
            raise text.error(at, f"'{text[at].strip()[:40]}' holds decimal commas; the decimal sign is a point")
    alone = r"\s*[+-]?\d+,\d+(?:[eE][+-]?\d+)?\s*"
    if len(bare) == len(lines) and all(re.fullmatch(alone, line) for line in bare.values()):
        raise text.error(lines[0], f"'{bare[lines[0]].strip()[:40]}' holds decimal commas; the decimal sign is a point")


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


def _step(
    text: Lines, rows: list[tuple[int, list[str]]], time: np.ndarray, rounded: float, given: str | None
) -> tuple[float, bool]:
    """The step [s] of a time column in a unit (seconds where none is given), and whether only rounding makes it uneven."""
    if len(time) < 3:
        raise text.error(rows[-1][0], f"only {len(time)} samples; a record has at least three")
    steps = np.diff(time)
    step = _median(steps)
    if not step > 0.0:
        raise text.error(rows[int(np.argmin(steps)) + 1][0], "the time column does not ascend")
    off = np.flatnonzero(np.abs(steps - step) > 0.02 * step)
    uneven = bool(off.size) and _even(time, rounded)
    if off.size and not uneven:
        k = int(off[0])
        raise text.error(
            rows[k + 1][0], f"the time step is {steps[k]:g} s here and {step:g} s elsewhere; resample to equal steps"
        )
    step = TIME[given or "s"] * (time[-1] - time[0]) / (len(time) - 1)
    if given is None and step >= LONGEST_STEP:
        raise text.error(
            rows[0][0],
            f"the time step is {step:g} s, which is no accelerogram's; if the times are milliseconds, call their column time_ms",
        )
    return float(np.round(step, 9)), uneven


def _names(header: list[str], width: int) -> list[str]:
    """Column names from the last header line that has as many words as columns."""
    for line in reversed(header):
        words = [w.strip() for w in re.split(r"[,;\t]", line)]
        if len(words) == width:
            return words
        if len(line.split()) == width:
            return line.split()
    return [f"column {k + 1}" for k in range(width)]
