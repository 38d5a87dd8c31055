"""miniSEED and SAC through obspy, an extra: pip install 'extrados[seismo]'."""

import io
import warnings

import numpy as np

from extrados.motions.formats.record import Record, RecordError
from extrados.schema.files import File


def recognises(file: File) -> bool:
    """miniSEED begins with a six-digit sequence number and a quality letter; SAC is named so."""
    if file.path.suffix.lower() == ".sac":
        return True
    head = file.content[:8]
    return len(head) == 8 and head[:6].isdigit() and head[6:7] in b"DRQM" and head[7:8] in b" \0"


def read(file: File) -> list[Record]:
    """One record per trace, without a unit: the deck says what the numbers are."""
    path = file.path
    try:
        import obspy
    except ImportError:
        raise RecordError(f"{path}: miniSEED and SAC need obspy: pip install 'extrados[seismo]'") from None
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            stream = obspy.read(io.BytesIO(file.content))
    except Exception as error:  # obspy raises many kinds on broken files
        raise RecordError(f"{path}: obspy cannot read it: {type(error).__name__}: {str(error)[:200]}") from None
    damage = [str(w.message) for w in said if issubclass(w.category, UserWarning)]
    if damage:
        raise RecordError(f"{path}: is damaged, obspy says: {damage[0][:200]}")
    records = []
    for trace in stream:
        values: np.ndarray = np.ma.filled(np.ma.asarray(trace.data, dtype=float), np.nan)
        if not np.isfinite(values).all():
            raise RecordError(f"{path}: trace {trace.id} has gaps or values that are not finite")
        records.append(Record(path.stem, values, float(trace.stats.delta), None, component=trace.id))
    if not records:
        raise RecordError(f"{path}: holds no traces")
    return records
