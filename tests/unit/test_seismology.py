"""miniSEED and SAC through obspy, where it is installed; a clear word where it is not."""

import sys

import numpy as np
import pytest

from extrados.motions.formats import seismology
from extrados.motions.formats.recognise import read_record
from extrados.motions.formats.record import RecordError
from extrados.motions.records import Treatment, record_motion
from extrados.schema.contained import Unreadable


def _trace():
    obspy = pytest.importorskip("obspy", reason="obspy (extra seismo) is not installed")
    trace = obspy.Trace(np.round(1000 * np.sin(0.1 * np.arange(500))).astype(np.int32))
    trace.stats.delta, trace.stats.station, trace.stats.channel = 0.01, "ABC", "HNE"
    return obspy, trace


@pytest.mark.parametrize("kind", ["MSEED", "SAC"])
def test_read_back(tmp_path, kind) -> None:
    _, trace = _trace()
    path = tmp_path / f"x.{kind.lower()}"
    trace.write(str(path), format=kind)
    record = read_record(path)
    assert record.step == pytest.approx(0.01, rel=1e-6) and "ABC" in record.component
    np.testing.assert_allclose(record.values, trace.data)
    with pytest.raises(RecordError, match="no unit"):
        record_motion(record)
    assert record_motion(record, Treatment(unit="mm/s^2")).peak == pytest.approx(1.0)


def test_damaged_and_several_traces(tmp_path) -> None:
    obspy, trace = _trace()
    path = tmp_path / "x.mseed"
    other = trace.copy()
    other.stats.channel = "HNN"
    obspy.Stream([trace, other]).write(str(path), format="MSEED")
    with pytest.raises(RecordError, match="2 channels"):
        read_record(path)
    assert read_record(path, "HNN").component.endswith("HNN")
    raw = path.read_bytes()
    for cut in range(8, len(raw), 397):
        path.write_bytes(raw[:cut])
        try:
            record = read_record(path, 1)
        except RecordError as error:
            assert str(path) in str(error)
            continue
        np.testing.assert_array_equal(record.values, trace.data)  # the cut fell into the second trace


def test_without_obspy(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "obspy", None)
    with pytest.raises(Unreadable, match=r"pip install 'extrados\[seismo\]'"):
        seismology.parse(b"000001D ABC" + bytes(500))


def test_what_is_no_record_is_refused_with_its_file(tmp_path) -> None:
    path = tmp_path / "x.mseed"
    path.write_bytes(b"000001D ABC" + bytes(500))
    with pytest.raises(RecordError, match=r"x\.mseed: (miniSEED and SAC require obspy|obspy cannot read this file)"):
        read_record(path)
