"""Times of records in their units and as rounded, what a motion's page says of it, smoothed spectra, units of keys."""

from pathlib import Path
from typing import Any

import motion_files as files
import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.motions.formats.record import RecordError, time_unit_in
from extrados.motions.measures import fourier_spectrum, konno_ohmachi
from extrados.motions.records import Treatment, read_record, record_motion
from extrados.motions.wavelet_pulse import classify
from extrados.results.model import Result
from extrados.running.run import compute


def column_file(path: Path, name: str, times: list[str], unit: str = "g") -> Path:
    values = 0.1 * np.sin(np.arange(len(times)))
    rows = [f"{t},{v:.6f}" for t, v in zip(times, values, strict=True)]
    path.write_text("\n".join([f"{name},acceleration ({unit})", *rows]) + "\n")
    return path


def study(path: Path, **motion: Any) -> Result:
    data = {"motion": {"kind": "record", "file": path.name, **motion}, "analysis": {"kind": "motion"}}
    return run_analyses(Context(make_deck(data, path.parent), threads=1))[0]


# --- times


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("time_ms", "ms"),
        ("t [ms]", "ms"),
        ("Time (msec)", "ms"),
        ("milliseconds", "ms"),
        ("time_us", "us"),
        ("time (s)", "s"),
        ("t_s", "s"),
        ("Time [sec]", "s"),
        ("time", None),
        ("t", None),
        ("samples", None),
        ("time (min)", "min"),
        ("item", None),
    ],
)
def test_unit_of_a_time_column(name: str, unit: str | None) -> None:
    assert time_unit_in(name) == unit


def test_milliseconds_are_not_read_as_seconds(tmp_path: Path) -> None:
    path = column_file(tmp_path / "ms.csv", "time_ms", [f"{5 * k}" for k in range(400)])
    record = read_record(path)
    assert record.step == pytest.approx(0.005) and "are in ms" in record.notes[0]
    found = study(path)
    assert found["pga_time_s"] < 2.0 and any("are in ms" in w for w in found.warnings)
    bare = column_file(tmp_path / "bare.csv", "time", [f"{5 * k}" for k in range(400)])
    with pytest.raises(RecordError, match=r"bare\.csv:2: the time step is 5 s, .* name their column `time_ms`"):
        read_record(bare)


def test_times_rounded_at_128_hz(tmp_path: Path) -> None:
    """1/128 s written to 1 ms: steps of 7 and 8 ms. The deck's step is taken; without it their mean, which is told."""
    path = column_file(tmp_path / "rounded.csv", "time (s)", [f"{k / 128:.3f}" for k in range(1000)])
    record = read_record(path)
    assert record.step == pytest.approx(1 / 128, rel=2e-4) and record.rounded == pytest.approx(1e-3)
    assert any("are rounded to 1 ms; the program uses their mean time step" in w for w in study(path).warnings)
    given = study(path, time_step=1 / 128)
    assert given["time_step_s"] == 1 / 128
    assert any("`time_step` of the deck is used" in w for w in given.warnings)
    assert not any("mean time step" in w for w in given.warnings)
    wrong = study(path, time_step=0.0079)
    assert wrong.status == "refused" and "the deck gives 0.0079 s" in wrong.reason
    # Several components beside rounded times are columns too.
    rows = [f"{k / 128:.3f} {0.1 * np.sin(k):.5f} {0.1 * np.cos(k):.5f}" for k in range(500)]
    (tmp_path / "two.txt").write_text("time (s) acc1 (g) acc2 (g)\n".replace(" (", "_(") + "\n".join(rows) + "\n")
    assert read_record(tmp_path / "two.txt", 2).values[0] == pytest.approx(0.1)
    # A step that is lost is no rounding.
    lost = [k / 128 for k in range(1000) if k != 500]
    with pytest.raises(RecordError, match="resample the record to equal steps"):
        read_record(column_file(tmp_path / "lost.csv", "time (s)", [f"{t:.3f}" for t in lost]))


# --- what the page says


def test_why_a_motion_is_not_pulse_like() -> None:
    step = 0.01
    time = step * np.arange(2000)
    pulse = 2.0 * np.pi / 1.5 * np.cos(2.0 * np.pi * (time - 2.0) / 1.5) * ((time > 2.0) & (time < 3.5))
    strong, weak, late = classify(0.8 * pulse, step), classify(0.2 * pulse, step), classify(0.8 * pulse[::-1], step)
    assert strong.pulse_like and strong.fails == ()
    assert not weak.pulse_like and len(weak.fails) == 1 and weak.fails[0].startswith("the peak velocity is 20")
    noise = classify(np.random.default_rng(1).normal(0.0, 3.0, 4000), step)
    assert any("the pulse indicator" in why and "not above 0.85" in why for why in noise.fails)
    assert late.pulse_like == (late.fails == ())
    over = classify(pulse[:2000], 1e-12)
    assert not over.pulse_like and over.fails == ("the motion ends after 2e-09 s, which is too short for a pulse",)


def test_a_motion_too_slow_for_its_spectra_is_refused() -> None:
    data = {"motion": {"kind": "step-pulse", "amplitude": "1 g", "duration": 1e9}, "analysis": {"kind": "motion"}}
    (row,) = compute(Context(make_deck(data), threads=1)).analyses
    assert row["status"] == "refused" and "time step of 3e+03 s is too long" in row["reason"]


def test_the_page_says_why_which_station_and_which_event(tmp_path: Path) -> None:
    values = " ".join(f"{0.01 * np.sin(0.3 * k):.7e}" for k in range(1000))
    (tmp_path / "RSN6.AT2").write_text(
        "PEER NGA STRONG MOTION DATABASE RECORD\nImperial Valley-02, 5/19/1940, El Centro Array #9, 180\n"
        f"ACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 1000, DT= .0100 SEC,\n{values}\n"
    )
    found = study(tmp_path / "RSN6.AT2")
    assert found["title"] == "Imperial Valley-02, 5/19/1940" and found["station"] == "El Centro Array #9, 180"
    assert "RSN6 (Imperial Valley-02, 5/19/1940, El Centro Array #9, 180): peak" in found.answer
    assert "not pulse-like: " in found.answer and "not above 30 cm/s" in found.answer
    assert found["wavelet_pulse"]["fails"]
    shipped = make_deck({"motion": {"kind": "record", "file": "extrados:el-centro-1940"}, "analysis": {"kind": "motion"}})
    page = run_analyses(Context(shipped, threads=1))[0]
    assert page["title"].startswith("El Centro, Imperial Valley earthquake, 18 May 1940")


@pytest.mark.parametrize(
    ("text", "title", "station"),
    [
        (files.cosmos([[("acceleration", "cm/sec2(04)", files.series())]]), "Test Earthquake", "02-001795 Code:NP-1795"),
        (files.cdmg_v1(np.round(files.series() / 980.665, 6)), "TEST EARTHQUAKE", ""),
        (files.smc(files.series()), "1989 10 18 0004 Test", "Test Dam, crest"),
        (files.knet(np.arange(1000)), "2011/03/11 14:46:00", "MYG004"),
        (files.esm(files.series()), "TEST", ""),
    ],
)
def test_event_and_station_of_other_formats(tmp_path: Path, text: str, title: str, station: str) -> None:
    (tmp_path / "record").write_text(text)
    record = read_record(tmp_path / "record")
    assert (record.title, record.station) == (title, station)


# --- Konno and Ohmachi


def test_smoothing_is_the_mean_under_the_window() -> None:
    rng = np.random.default_rng(5)
    frequency = np.arange(0, 2001) * 0.02
    amplitude = rng.uniform(0.5, 1.5, len(frequency))
    for centre in (0.5, 3.0, 20.0):
        u = 40.0 * np.log10(frequency[1:] / centre)
        with np.errstate(invalid="ignore", divide="ignore"):
            window = np.where(np.abs(u) < 1e-12, 1.0, (np.sin(u) / u) ** 4)
        whole = float((window * amplitude[1:]).sum() / window.sum())
        assert konno_ohmachi(frequency, amplitude, np.array([centre]))[0] == pytest.approx(whole, rel=2e-3)
    flat = konno_ohmachi(frequency, np.full(len(frequency), 3.0), np.geomspace(0.05, 40.0, 50))
    assert flat == pytest.approx(3.0, rel=1e-12)
    rough = konno_ohmachi(frequency, amplitude, np.geomspace(1.0, 30.0, 50))
    smoother = konno_ohmachi(frequency, amplitude, np.geomspace(1.0, 30.0, 50), bandwidth=10.0)
    assert smoother.std() < 0.7 * rough.std() < 0.7 * amplitude.std()


def test_smoothed_spectrum_beside_the_raw_one(tmp_path: Path) -> None:
    path = column_file(tmp_path / "a.csv", "time (s)", [f"{0.01 * k:.2f}" for k in range(1000)])
    found = study(path)
    motion = record_motion(read_record(path), Treatment())
    frequency, amplitude = fourier_spectrum(motion.ground.samples[0], 0.01)
    assert found["fourier"] == pytest.approx(amplitude)
    assert found["fourier_smooth"] == pytest.approx(konno_ohmachi(frequency, amplitude, found["smooth_frequency"]))


# --- units of keys


def test_levels_have_units() -> None:
    def levels(values: list, **keys: Any) -> list[float]:
        deck = make_deck(
            {
                "structure": {"kind": "block", "width": 1.0, "height": 5.0},
                "motion": {"kind": "generated", "mmi": 7, "duration": 5.0},
                "analysis": {"kind": "fragility", "count": 10, "levels": values, **keys},
            }
        )
        return deck.analyses[0].levels

    assert levels(["0.1 g", 0.2, "2.9419950 m/s^2"]) == pytest.approx([0.1, 0.2, 0.3])
    assert levels(["50 cm/s"], intensity="arias") == [0.5]
    assert levels(["0.3 g"], intensity="sa", sa_period=0.5) == pytest.approx([0.3])
    for values, keys, words in (
        (["0.1 m"], {}, "is not a unit of m/s"),
        (["2 g"], {"intensity": "scale"}, "numbers without a unit"),
        (["2 g"], {"intensity": "pgx"}, "input should be 'pga'"),
        (["2 g"], {"intensity": ["pga", 3]}, "input should be 'pga'"),
        (["2 g"], {"intensity": {}}, "input should be 'pga'"),
        (["-0.1 g"], {}, "above zero"),
    ):
        with pytest.raises(DeckError, match=words):
            levels(values, **keys)


def test_other_keys_with_units() -> None:
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 150.0, "voussoirs": 12}

    def results(**analysis: Any) -> Result:
        return run_analyses(Context(make_deck({"structure": arch, "analysis": analysis}), threads=1))[0]

    assert results(kind="thrust", gamma="0.98066500 m/s^2")["gamma_g"] == pytest.approx(0.1)
    swept = results(kind="sweep", vary="thickness", start="120 cm", stop=1.6, count=3, locate=False)
    assert swept["values"] == pytest.approx([1.2, 1.4, 1.6]) and swept["unit"] == "m"
    assert "is not a unit of m" in results(kind="sweep", vary="thickness", values=["1 kg", 2.0]).reason
    assert "has no unit" in results(kind="sweep", vary="joints.friction", values=["1 m", 2.0]).reason
    church = {"kind": "aisled-vault", "preset": "vezelay-like"}
    deck = make_deck(
        {"structure": church, "analysis": {"kind": "sweep", "vary": "right.buttress_width", "values": ["120 cm", "1.4 m"], "locate": False}}
    )
    found = run_analyses(Context(deck, threads=1))[0]
    assert found["values"] == pytest.approx([1.2, 1.4]) and found["unit"] == "m"
