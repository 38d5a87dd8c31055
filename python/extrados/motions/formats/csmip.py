"""CSMIP and CDMG volume 1 (uncorrected) and volume 2 (corrected) files, one or more channels.

Headers of several styles are passed over: each block of data announces itself by a line such as
'7500 points of accel data equally spaced at .010 sec, in cm/sec2. (8f10.6)' or
'12001 POINTS OF ACCEL DATA EQUALLY SPACED AT .005 SEC. (UNITS: G)'; columns have fixed width and may touch.
"""

import re

from extrados.motions.formats.record import Lines, Record, fortran_columns, said_in, unit_in

HEADER = 12  # the first lines, which speak of event and station
_BLOCK = re.compile(r"\s*(\d+)\s+points\s+of\s+(?:\w+[\s-]+)*?(accel|veloc|displ)\w*\s+data\s+equally\s+spaced\s+at\s+([\d.]+)\s*sec", re.I)
_TITLE = re.compile(r"(?:un)?corrected accelerogram", re.I)
_QUANTITY = {"accel": "acceleration", "veloc": "velocity", "displ": "displacement"}


def recognises(text: Lines) -> bool:
    """Whether the first line is that of CSMIP, and no SMC file."""
    return _TITLE.search(text.words(0)) is not None and text[1].strip() != "*"


def read(text: Lines) -> list[Record]:
    """The records of all channels."""
    records, name, at = [], "", 0
    event, station = said_in(text.lines[:HEADER])
    while at < len(text):
        line = text.words(at)
        if channel := re.search(r"\bchan(?:nel)?\s*(\d+)\s*:\s*(.*?)(?:\s{2,}|\s*from\b|$)", line, re.I):
            name = f"chan {channel[1]}: {channel[2].strip()}"
        found = _BLOCK.match(line)
        if not found:
            at += 1
            continue
        count, quantity = int(found[1]), _QUANTITY[found[2].lower()]
        step = text.step(found[3].rstrip("."), at)
        if count == 0:
            at += 1
            continue
        # volume 1 states no format: eight columns of nine
        columns, width = fortran_columns(line) or (8, _width(text[at + 1]))
        values, end = text.fixed(at + 1, count, width, columns)
        records.append(Record(text.path.stem, values, step, unit_in(line, quantity), quantity, name, title=event, station=station))
        at = end
    if not records:
        raise text.error(
            len(text) - 1, "the file has no line '... points of accel data equally spaced at ... sec': it is cut off, or of another format"
        )
    return records


def _width(line: str) -> int:
    """Width of one of eight columns, from a full line."""
    length = len(line.rstrip())
    return length // 8 if length % 8 == 0 and length >= 48 else 9
