"""K-NET and KiK-net ASCII: 17 header lines from 'Origin Time' to 'Memo.', then integer counts.

Acceleration in gal is count times scale factor, with the mean taken off: the counts carry the sensor's offset.
"""

import re

from extrados.motions.formats.record import Lines, Record, tidy

HEADER = 17


def recognises(text: Lines) -> bool:
    """Whether the header is that of K-NET and KiK-net."""
    return text[0].startswith("Origin Time")


def read(text: Lines) -> list[Record]:
    """The one record of the file."""
    keys = {text[at][:18].strip(): (at, text[at][18:].strip()) for at in range(HEADER)}

    def value(key: str) -> tuple[int, str]:
        if key not in keys:
            raise text.error(HEADER - 1, f"'{key}' is missing in the first {HEADER} lines: the file is cut off, or of another format")
        return keys[key]

    at, said = value("Sampling Freq(Hz)")
    rate = text.number(re.sub(r"\s*Hz$", "", tidy(said), flags=re.I), at)
    if not 0.1 <= rate <= 1e5:
        raise text.error(at, f"the sampling frequency is {rate:g} Hz, expected 0.1 to 100000")
    at, said = value("Scale Factor")
    scale = re.fullmatch(r"(\S+?)\(gal\)/(\S+)", tidy(said))
    if not scale:
        raise text.error(at, f"'{said[:30]}' is not a scale; expected a text such as '3920(gal)/6182761'")
    divisor = text.number(scale[2], at)
    if divisor == 0.0:
        raise text.error(at, "the divisor of the scale factor is zero")
    factor = text.number(scale[1], at) / divisor
    value("Memo.")
    rows = text.blanks(HEADER)
    counts = text.numbers(rows)
    at, said = value("Duration Time(s)")
    expected = round(text.number(said, at) * rate)
    if len(counts) < expected:
        raise text.cut(len(counts), expected)
    if len(counts) < 3:
        raise text.error(HEADER, f"the file has only {len(counts)} samples; a record has at least three")
    counts = counts - counts.mean()
    return [
        Record(
            text.path.stem,
            counts * factor,
            1.0 / rate,
            "gal",
            component=keys.get("Dir.", (0, ""))[1],
            notes=["mean taken off"],
            title=keys.get("Origin Time", (0, ""))[1],
            station=keys.get("Station Code", (0, ""))[1],
        )
    ]
