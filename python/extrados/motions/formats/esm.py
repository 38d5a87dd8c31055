"""ESM and ITACA dynamic files (.ASC): 64 lines 'KEY: value' from EVENT_NAME on, then one column in cm/s^2."""

from extrados.motions.formats.record import Lines, Record, unit_in

HEADER = 64
_QUANTITY = {"ACC": "acceleration", "VEL": "velocity", "DIS": "displacement"}


def recognises(text: Lines) -> bool:
    """Whether the header is that of ESM."""
    return text[0].startswith("EVENT_NAME:") and text[1].startswith("EVENT_ID:")


def read(text: Lines) -> list[Record]:
    """The one record of the file."""
    if len(text) <= HEADER:
        raise text.error(len(text) - 1, f"the file ends within the {HEADER} header lines, so it is cut off")
    keys: dict[str, tuple[int, str]] = {}
    for at in range(HEADER):
        key, colon, entry = text[at].partition(":")
        if not colon:
            raise text.error(at, f"'{text[at][:30]}' is not a header line; expected 'KEY: value'")
        keys[key.strip()] = (at, entry.strip())

    def value(key: str) -> tuple[int, str]:
        if key not in keys:
            raise text.error(HEADER - 1, f"the header has no {key}")
        return keys[key]

    at, said = value("SAMPLING_INTERVAL_S")
    step = text.step(said, at)
    at, said = value("NDATA")
    count = text.integer(said, at)
    if count < 3:
        raise text.error(at, f"NDATA is {count}; a record has at least three samples")
    values, notes = text.check_count(text.numbers(text.blanks(HEADER)), count, at)
    _, kind = keys.get("DATA_TYPE", (0, "ACCELERATION"))
    quantity = _QUANTITY.get(kind[:3].upper(), "acceleration")
    unit = unit_in(keys.get("UNITS", (0, ""))[1], quantity)
    default = {"acceleration": "cm/s^2", "velocity": "cm/s", "displacement": "cm"}[quantity]

    def told(*names: str) -> str:
        return " ".join(said for name in names if (said := keys.get(name, (0, ""))[1]))

    return [
        Record(
            text.path.stem,
            values,
            step,
            unit or default,
            quantity,
            told("STREAM"),
            notes,
            title=told("EVENT_NAME", "EVENT_DATE_YYYYMMDD"),
            station=told("NETWORK", "STATION_CODE", "STATION_NAME"),
        )
    ]
