"""miniSEED and SAC through obspy, an extra: pip install 'extrados[seismo]'."""

import warnings
from pathlib import Path

import numpy as np

from extrados.motions.formats.record import LARGEST, Record, RecordError


def recognises(path: Path) -> bool:
    """miniSEED begins with a six-digit sequence number and a quality letter; SAC is named so."""
    if path.suffix.lower() == ".sac":
        return True
    try:
        with path.open("rb") as file:
            head = file.read(8)
    except (OSError, ValueError):
        return False
    return len(head) == 8 and head[:6].isdigit() and head[6:7] in b"DRQM" and head[7:8] in b" \0"


def read(path: Path) -> list[Record]:
    """One record per trace, without a unit: the deck says what the numbers are."""
    try:
        import obspy
    except ImportError:
        raise RecordError(f"{path}: miniSEED and SAC need obspy: pip install 'extrados[seismo]'") from None
    if path.is_file() and path.stat().st_size > LARGEST:
        raise RecordError(f"{path}: is larger than {LARGEST / 1e6:.0f} MB")
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            stream = obspy.read(str(path))
    except Exception as error:  # obspy raises many kinds on broken files
        raise RecordError(f"{path}: obspy cannot read it: {type(error).__name__}: {str(error)[:200]}") from None
    damage = [str(w.message) for w in said if issubclass(w.category, UserWarning)]
    if damage:
        raise RecordError(f"{path}: is damaged, obspy says: {damage[0][:200]}")
    records = []
    for trace in stream:
        values = np.ma.filled(np.ma.asarray(trace.data, dtype=float), np.nan)
        if not np.isfinite(values).all():
            raise RecordError(f"{path}: trace {trace.id} has gaps or values that are not finite")
        records.append(Record(path.stem, values, float(trace.stats.delta), None, component=trace.id))
    if not records:
        raise RecordError(f"{path}: holds no traces")
    return records
