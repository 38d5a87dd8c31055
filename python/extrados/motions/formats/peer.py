"""PEER strong-motion files: AT2 (acceleration in g), VT2 (cm/s), DT2 (cm), old and new headers."""

import re

from extrados.motions.formats.record import Lines, Record, quantities_in, unit_in

#: What a suffix of PEER stands for
SUFFIXES = {".at2": "acceleration", ".vt2": "velocity", ".dt2": "displacement"}
HEADER = 12  # NPTS stands in the first lines, below any free text


def recognises(text: Lines) -> bool:
    """Whether the header is that of PEER."""
    return any("NPTS" in text[at].upper() for at in range(HEADER)) or "PEER " in text[0].upper()


def read(text: Lines) -> list[Record]:
    """The one record of the file."""
    for at in range(HEADER):
        line = text.words(at)
        if "NPTS" not in line.upper():
            continue
        named = re.search(r"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*([^\s,]+)", line, re.I)
        bare = re.match(r"\s*(\d+)\s+(\S+)\s+NPTS", line, re.I)
        found = named or bare
        if not found:
            raise text.error(at, "this line gives no number of points and no step; expected 'NPTS= 4000, DT= .0100 SEC'")
        count, step = text.integer(found[1], at), text.step(found[2].rstrip(","), at)
        break
    else:
        raise text.error(0, "the PEER file has no line 'NPTS= 4000, DT= .0100 SEC'")
    header = "\n".join(text.words(k).strip() for k in range(at + 1)).upper()
    quantity = next((q for q in ("velocity", "displacement") if f"{q.upper()} TIME" in header), None)
    if quantity is None:
        said = quantities_in(header) or ["acceleration"]
        if len(said) > 1:
            raise text.error(0, f"the header names {' and '.join(said)}; expected one quantity, as in 'ACCELERATION TIME SERIES'")
        quantity = said[0]
    if (other := SUFFIXES.get(text.path.suffix.lower(), quantity)) != quantity:
        raise text.error(0, f"the header names {quantity}, but the suffix {text.path.suffix} of the file means {other}: rename the file")
    rows: list[tuple[int, list[str]]] = []
    have = 0
    for number, row in text.blanks(at + 1):
        if have >= count and not re.match(r"[+-]?\.?\d", row[0]):
            break  # words after the data, such as '*** End Data ***'
        rows.append((number, row))
        have += len(row)
    values, notes = text.check_count(text.numbers(rows), count, at)
    if count < 3:
        raise text.error(at, f"NPTS is {count}; a record has at least three samples")
    title, station = _said(text[1])
    return [Record(text.path.stem, values, step, unit_in(header, quantity), quantity, notes=notes, title=title, station=station)]


def _said(line: str) -> tuple[str, str]:
    """Event, with its date, and station, with the component, of the second line: 'Event, date, station, component'."""
    parts = [part.strip() for part in line.split(",")]
    if len(parts) < 3 or "NPTS" in line.upper():
        return "", ""
    cut = 2 if re.search(r"\d", parts[1]) and len(parts) > 3 else 1
    return ", ".join(parts[:cut]), ", ".join(parts[cut:])
