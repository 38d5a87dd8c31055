"""Plain columns: acceleration alone; time and acceleration; time and several components.

Blanks, tabs, commas or semicolons between, any header, comments after '#'. Rows of several numbers without a time
column are one series, as OpenSees reads a path file.
"""

import re

import numpy as np

from extrados.motions.formats.record import Lines, Record, tidy, unit_in

MOST_HEADER = 60


def read(text: Lines) -> list[Record]:
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
    unit = unit_in(said)
    if width > 1 and (width == 2 or _is_time(table[:, 0])):
        if short:
            raise text.error(rows[-1][0], f"{len(rows[-1][1])} columns where {width} stood before: the file is cut off")
        step = _step(text, rows, table[:, 0])
        names = _names(header, width)
        return [
            Record(
                text.path.stem,
                table[:, k].copy(),
                step,
                unit_in(names[k]) or unit,
                component=names[k] if width > 2 else "",
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
    return [Record(text.path.stem, values, step, unit)]


def _split(text: Lines) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header lines and (line, tokens) of the numbers."""
    header: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    for at, line in enumerate(text.lines):
        bare, _, comment = line.partition("#")
        tokens = [token for token in re.split(r"[\s,;]+", bare) if token]
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
    for at in lines:
        words = [w for w in re.split(r"[\s;]+", text[at].partition("#")[0]) if w]
        if len(words) > 1 and any(re.fullmatch(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?", w) for w in words):
            raise text.error(at, f"'{text[at].strip()[:40]}' holds decimal commas; the decimal sign is a point")
    sample = [text[at].partition("#")[0] for at in lines]
    if all(re.fullmatch(r"\s*[+-]?\d+,\d+(?:[eE][+-]?\d+)?\s*", line) for line in sample):
        raise text.error(lines[0], f"'{sample[0].strip()[:40]}' holds decimal commas; the decimal sign is a point")


def _is_time(column: np.ndarray) -> bool:
    """True for a column that ascends in equal steps."""
    steps = np.diff(column)
    return len(column) > 2 and bool(
        np.all(steps > 0.0) and np.all(np.abs(steps - np.median(steps)) <= 0.02 * np.median(steps))
    )


def _step(text: Lines, rows: list[tuple[int, list[str]]], time: np.ndarray) -> float:
    if len(time) < 3:
        raise text.error(rows[-1][0], f"only {len(time)} samples; a record has at least three")
    steps = np.diff(time)
    step = float(np.median(steps))
    if not step > 0.0:
        raise text.error(rows[int(np.argmin(steps)) + 1][0], "the time column does not ascend")
    off = np.flatnonzero(np.abs(steps - step) > 0.02 * step)
    if off.size:
        k = int(off[0])
        raise text.error(
            rows[k + 1][0], f"the time step is {steps[k]:g} s here and {step:g} s elsewhere; resample to equal steps"
        )
    return float(np.round((time[-1] - time[0]) / (len(time) - 1), 9))


def _names(header: list[str], width: int) -> list[str]:
    """Column names from the last header line that has as many words as columns."""
    for line in reversed(header):
        words = [w.strip() for w in re.split(r"[,;\t]", line)]
        if len(words) == width:
            return words
        if len(line.split()) == width:
            return line.split()
    return [f"column {k + 1}" for k in range(width)]
