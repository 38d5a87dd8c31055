"""Which reader a file needs, by its content alone."""

from pathlib import Path

from extrados.motions.formats import columns as plain
from extrados.motions.formats import cosmos, csmip, esm, knet, peer, seismology, smc
from extrados.motions.formats.columns import Columns
from extrados.motions.formats.record import Lines, Record, RecordError, read_file, read_lines
from extrados.schema.files import File

READERS = {"COSMOS": cosmos, "K-NET": knet, "ESM": esm, "SMC": smc, "CSMIP": csmip, "PEER": peer}


def format_of(text: Lines) -> str:
    """The name of the format: a key of READERS, or 'columns'."""
    return next((name for name, reader in READERS.items() if reader.recognises(text)), "columns")


def read_records(source: File | Path, columns: Columns | None = None) -> list[Record]:
    """Every channel and quantity of a file; RecordError says file, line and what was expected.

    columns: what several columns without time are, in a file of plain columns.
    """
    file = source if isinstance(source, File) else read_file(source)
    if seismology.recognises(file):
        return seismology.read(file)
    text = read_lines(file)
    name = format_of(text)
    return READERS[name].read(text) if name in READERS else plain.read(text, columns)


def read_record(source: File | Path, channel: str | int | None = None, columns: Columns | None = None) -> Record:
    """The acceleration record of a file, or the one of a channel: its number from 1 or a part of its name.

    A file with several accelerations and no channel named is refused, with the names. A channel of a file of plain
    columns is a column, unless `columns` says otherwise.
    """
    path = source.path if isinstance(source, File) else source
    records = read_records(source, columns or ("components" if channel is not None else None))
    wanted = [r for r in records if r.quantity == "acceleration"] or records
    if isinstance(channel, int):
        if not 1 <= channel <= len(wanted):
            raise RecordError(f"{path}: channel {channel} does not exist; expected 1 to {len(wanted)}")
        return wanted[channel - 1]
    if channel is not None:
        found = [r for r in wanted if channel.lower() in r.component.lower()]
        if len(found) != 1:
            raise RecordError(f"{path}: {len(found)} channels have the name '{channel}'; the channels are {_names(wanted)}")
        return found[0]
    if len(wanted) > 1:
        raise RecordError(f"{path}: this file has {len(wanted)} channels. Select one with channel = 1 to {len(wanted)}: {_names(wanted)}")
    return wanted[0]


def _names(records: list[Record]) -> str:
    return ", ".join(f"{k} '{r.component}'" for k, r in enumerate(records, start=1))
