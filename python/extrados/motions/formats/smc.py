"""USGS SMC files: 11 text lines, 48 integers (8I10), 50 reals (5E15.7), '|' comments, data in eight columns of ten.

Acceleration in cm/s^2. Files without a sampling rate hold pairs of unequally spaced time and acceleration and are
refused; their corrected companions are equally spaced.
"""

import re

from extrados.motions.formats.record import Lines, Record, said_in

_MISSING = 1.7e38
_QUANTITY = {"VELOCITY": ("velocity", "cm/s"), "DISPLACEMENT": ("displacement", "cm")}


def recognises(text: Lines) -> bool:
    """Whether the header is that of SMC."""
    return text[1].strip().startswith("*") and re.match(r"\s*(?:\d\s+\S|\*)", text.words(0)) is not None


def read(text: Lines) -> list[Record]:
    """The one record of the file."""
    whole, at = text.fixed(11, 48, 10, 8)
    real, at = text.fixed(at, 50, 15, 5)
    missing, rate = real[0], real[1]
    comments, count = int(whole[15]), int(whole[16])
    if not 0 <= comments <= 10_000 or not 3 <= count <= 100_000_000:
        raise text.error(12, f"the header states {comments} comment lines and {count} values, which is not possible")
    if rate == missing or not 0.0 < rate < 1e5:
        raise text.error(17, "the file has no sampling rate, because its times are unequally spaced: use the corrected file of this record")
    for k in range(comments):
        if at + k < len(text) and not text[at + k].lstrip().startswith("|"):
            raise text.error(at + k, f"expected comment line {k + 1} of {comments}, beginning with '|'")
    quantity, unit = next((q for word, q in _QUANTITY.items() if word in text[0].upper()), ("acceleration", "cm/s^2"))
    values, _ = text.fixed(at + comments, count, 10, 8)
    if (abs(values) >= _MISSING).any():
        raise text.error(at + comments, "holds values marked as missing")
    found = re.search(r"component\s*=\s*(\S+)", text.words(5))
    _, station = said_in(text.lines[:11])
    event = " ".join(text[3].split())
    component = found[1] if found else ""
    return [Record(text.path.stem, values, 1.0 / rate, unit, quantity, component, title=event, station=station)]
