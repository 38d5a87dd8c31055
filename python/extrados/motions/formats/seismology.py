"""miniSEED and SAC through obspy, an extra: pip install 'extrados[seismo]'."""

import io
import warnings

import numpy as np

from extrados.motions.formats.record import Record, RecordError
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.files import File


def recognises(file: File) -> bool:
    """miniSEED begins with a six-digit sequence number and a quality letter; SAC is named so."""
    if file.path.suffix.lower() == ".sac":
        return True
    head = file.content[:8]
    return len(head) == 8 and head[:6].isdigit() and head[6:7] in b"DRQM" and head[7:8] in b" \0"


def read(file: File) -> list[Record]:
    """One record per trace, without a unit: the deck says what the numbers are. A process of its own reads."""
    path = file.path
    try:
        found = read_contained("extrados.motions.formats.seismology:parse", file.content, ["obspy"])
    except Unreadable as error:
        raise RecordError(f"{path}: {error}") from None
    return [Record(path.stem, values, step, None, component=trace) for values, step, trace in found]


def parse(content: bytes) -> list[tuple[np.ndarray, float, str]]:
    """Samples, step [s] and name of each trace. The contained process calls this; Unreadable gives the reason."""
    try:
        import obspy
    except ImportError:
        raise Unreadable("miniSEED and SAC require obspy. Install it by pip install 'extrados[seismo]'") from None
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            stream = obspy.read(io.BytesIO(content))
    except MemoryError:
        raise
    except Exception as error:  # obspy raises many kinds on broken files
        raise Unreadable(f"obspy cannot read this file: {type(error).__name__}: {str(error)[:200]}") from None
    damage = [str(w.message) for w in said if issubclass(w.category, UserWarning)]
    if damage:
        raise Unreadable(f"is damaged, obspy says: {damage[0][:200]}")
    found = []
    for trace in stream:
        values: np.ndarray = np.ma.filled(np.ma.asarray(trace.data, dtype=float), np.nan)
        if not np.isfinite(values).all():
            raise Unreadable(f"trace {trace.id} has gaps or values that are not finite")
        found.append((values, float(trace.stats.delta), str(trace.id)))
    if not found:
        raise Unreadable("holds no traces")
    return found
