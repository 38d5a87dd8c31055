"""COSMOS strong-motion files, versions 1.0x to 1.20: V1, V2 (three quantities) and V2c (one a file).

A channel is: text lines whose number stands in line 1; an integer, a real and a comment header, each with its own
count; then blocks of data, each with count, unit code and Fortran format; 'End-of-data'. Counts (V0) are refused:
they need the instrument's response.
"""

import re
from dataclasses import replace

from extrados.motions.formats.record import Lines, Record, fortran_columns, said_in

#: COSMOS table of unit codes
_UNITS = {2: "g", 4: "cm/s^2", 5: "cm/s", 6: "cm", 7: "in/s^2", 8: "in/s", 9: "in", 10: "gal", 11: "mg", 50: "counts"}
_STEP = 61  # real header, from 0: sampling interval of the data that follow [ms]


def recognises(text: Lines) -> bool:
    """Whether the first line is that of COSMOS."""
    return re.search(r"\(format\s+v", text.words(0), re.I) is not None


def read(text: Lines) -> list[Record]:
    """The records of all channels."""
    records: list[Record] = []
    at = 0
    while at < len(text):
        at, channel = _channel(text, at)
        records += channel
        while at < len(text) and not recognises(Lines(text.path, [text[at]])):
            at += 1
    if not records:
        raise text.error(0, "a COSMOS file without data")
    return records


def _channel(text: Lines, at: int) -> tuple[int, list[Record]]:
    found = re.search(r"with\s+(\d+)\s+text lines", text.words(at), re.I)
    first = at
    at += int(found[1]) if found else 13
    event, station = said_in(text.lines[first : min(at, len(text))])
    name = next((text[k] for k in range(first, min(at, len(text))) if re.match(r"\s*sta(?:tn)?\s+chan", text.words(k), re.I)), "")
    for _ in range(4):  # some files count the line after the text lines in, some do not
        if re.search(r"integer-header", text.words(at), re.I):
            break
        at += 1
    at, _ = _header(text, at, "integer-header")
    at, real = _header(text, at, "real-header")
    found = re.match(r"\s*(\d+)\s+comment", text.words(at), re.I)
    if not found:
        raise text.error(at, "expected the line 'n Comment line(s) follow'")
    at += 1 + int(found[1])
    if len(real) <= _STEP or not real[_STEP] > 0.0:
        raise text.error(at, "the header of real numbers has no sampling interval (value 62)")
    step = text.step(repr(real[_STEP] / 1000.0), at)
    records = []
    while at < len(text) and not re.match(r"\s*end-of-data", text.words(at), re.I):
        if not text[at].strip():
            at += 1
            continue
        at, record = _block(text, at, step, " ".join(name.split()))
        records.append(replace(record, title=event, station=station))
    if at >= len(text):
        raise text.error(at, "the file ends without 'End-of-data', so it is cut off")
    return at + 1, records


def _header(text: Lines, at: int, word: str) -> tuple[int, list[float]]:
    line = text.words(at)
    found = re.match(rf"\s*(\d+)\s+{word} values follow on\s+(\d+)\s+lines", line, re.I)
    shape = fortran_columns(line)
    if not found or not shape:
        raise text.error(at, f"expected the line 'n {word.title()} values follow on m lines, Format=(...)'")
    columns, width = shape
    values, end = text.fixed(at + 1, int(found[1]), width, columns)
    return end, values.tolist()


def _block(text: Lines, at: int, step: float, name: str) -> tuple[int, Record]:
    line = text.words(at)
    found = re.match(r"\s*(\d+)\s+(.*?)\s*(?:pts|points|values)", line, re.I)
    code = re.search(r"units?\s*=\s*[^(]*\(\s*(\d+)\s*\)", line, re.I)
    shape = fortran_columns(line)
    if not found or not code or not shape:
        raise text.error(at, "expected the line 'n acceleration pts, approx x secs, units=cm/sec2(04), Format=(8F10.5)'")
    unit = _UNITS.get(int(code[1]))
    if unit == "counts":
        raise text.error(at, "the file contains raw counts (V0), which require the response of the instrument: use the V1 or V2 file")
    what = found[2].lower()
    quantity = "velocity" if "vel" in what else "displacement" if "disp" in what else "acceleration"
    columns, width = shape
    values, end = text.fixed(at + 1, int(found[1]), width, columns)
    return end, Record(text.path.stem, values, step, unit, quantity, name)
