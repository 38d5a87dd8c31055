"""Pulses, impulses, classification, shake table and the two analyses, from decks as a user writes them."""

import json
from pathlib import Path

import motion_files as files
import numpy as np
import pytest
from typer.testing import CliRunner

import extrados
from extrados.analyses.motion.members import Generated
from extrados.cli import app
from extrados.core import motion as core
from extrados.decks.reader import DeckError, make_deck, read_text
from extrados.motions import processing, pulses
from extrados.motions.from_deck import generated_set, make_motion, suite_motions
from extrados.motions.impulse import primary_impulses
from extrados.motions.shake_table import Table, fit, make_drive
from extrados.motions.wavelet_pulse import classify, classify_directions

G = 9.80665


def record(folder: Path, name: str = "r.at2", factor: float = 1.0) -> Path:
    path = folder / name
    path.write_text(files.at2(factor * files.series()))
    return path


# --- pulses


@pytest.mark.parametrize(
    ("motion", "end", "velocity"),
    [
        (pulses.pulse("rectangular", 2.0, 0.5), 0.5, 1.0),
        (pulses.pulse("half-sine", 2.0, 0.5), 0.25, 2.0 * 0.5 / np.pi),
        (pulses.pulse("cosine", 2.0, 0.5), 0.5, 0.0),
        (pulses.pulse("ricker", 2.0, 0.5), 1.4, 0.0),
        (pulses.sine_pulse(2.0, 0.5), 0.5, 0.0),
        (pulses.velocity_pulse(0.4, 0.8, 1.5, 0.0), 1.2, 0.0),
        (pulses.velocity_pulse(0.4, 0.8, 2.2, 70.0), 1.76, 0.0),
    ],
)
def test_pulses_leave_the_velocity_they_should(motion, end, velocity) -> None:
    assert motion.end == pytest.approx(end)
    t = np.linspace(0.0, motion.end * (1 - 1e-12), 20001)
    a = motion.sample(t)
    assert np.trapezoid(a, t) == pytest.approx(velocity, abs=2e-4)


def test_velocity_pulse_is_that_of_the_paper() -> None:
    t = np.linspace(0.0, 2.0, 20001)[:-1]
    a = pulses.velocity_pulse(0.5, 1.0, 2.0, 30.0).sample(t)
    s = t - 1.0
    v = 0.25 * (1 + np.cos(np.pi * s)) * np.cos(2 * np.pi * s + np.radians(30.0))
    np.testing.assert_allclose(a[1:-1], np.gradient(v, t)[1:-1], atol=2e-5)


# --- primary impulse and classification


def test_impulses_of_a_known_sum_are_found() -> None:
    """Two single sines of either sign and some noise: amplitude, period, start, sign, in order of strength."""
    t = 0.01 * np.arange(1001)
    noise = 0.02 * np.random.default_rng(0).standard_normal(len(t))

    def one(amplitude: float, period: float, start: float) -> np.ndarray:
        s = t - start
        return np.where((s >= 0) & (s <= period), amplitude * np.sin(2 * np.pi * s / period), 0.0)

    found = primary_impulses(t, one(-3.0, 0.83, 2.017) + one(2.0, 0.4, 6.3) + noise, 2)
    for impulse, (amplitude, period, start) in zip(found, ((-3.0, 0.83, 2.017), (2.0, 0.4, 6.3)), strict=True):
        assert impulse.amplitude == pytest.approx(amplitude, rel=0.01)
        assert impulse.period == pytest.approx(period, rel=0.01)
        assert impulse.start == pytest.approx(start, abs=0.01)
        assert impulse.goodness > 0.99


@pytest.mark.parametrize("period", [0.2, 0.5, 1.3])
def test_a_sine_pulse_is_its_own_impulse(period) -> None:
    """Although the motion is no longer than the impulse."""
    t, a = pulses.sine_pulse(-3.0, period).series()
    (impulse,) = primary_impulses(t, a, 1)
    assert (impulse.amplitude, impulse.period) == (pytest.approx(-3.0, rel=2e-3), pytest.approx(period, rel=2e-3))
    assert impulse.start == pytest.approx(0.0, abs=2e-3 * period) and impulse.goodness > 0.9999


def test_classification() -> None:
    """A near-fault pulse is one, noise is not, and neither is a pulse that comes late or is weak."""
    _, a = pulses.velocity_pulse(0.8, 2.0, 1.5, 90.0).series(0.01)
    noise = np.random.default_rng(1).standard_normal(2000) * np.sin(np.linspace(0, np.pi, 2000)) ** 2
    noise = processing.band_pass(noise, 0.01, 1.0, 20.0)  # without the long waves that white noise holds
    quiet = np.zeros(2000)
    quiet[300 : 300 + len(a)] = a
    pulse = classify(quiet + noise, 0.01)
    assert pulse.pulse_like and pulse.indicator > 0.95 and pulse.period == pytest.approx(2.0, rel=0.1)
    assert pulse.peak_velocity == pytest.approx(0.8, rel=0.25)
    weak = classify(0.2 * quiet, 0.01)
    assert weak.indicator > 0.95 and not weak.pulse_like
    assert not classify(10.0 * noise, 0.01).pulse_like
    late = classify(np.concatenate([12.0 * noise, quiet]), 0.01)
    assert late.period == pytest.approx(2.0, rel=0.1) and not late.early and not late.pulse_like
    assert classify(np.zeros(100), 0.01).indicator == 0.0


@pytest.mark.parametrize("degrees", [0.0, 35.0, 90.0, -60.0])
def test_a_pulse_is_found_in_its_direction(degrees: float) -> None:
    """Of two components: direction, period and class of a pulse in noise; the same noise without it, or a weak pulse, is none."""
    _, a = pulses.velocity_pulse(0.8, 2.0, 1.5, 90.0).series(0.01)
    noise = np.random.default_rng(2).standard_normal((2, 2000)) * np.sin(np.linspace(0, np.pi, 2000)) ** 2
    noise = np.array([processing.band_pass(row, 0.01, 1.0, 20.0) for row in noise])
    way = np.array([[np.cos(np.radians(degrees))], [np.sin(np.radians(degrees))]])
    quiet = np.zeros(2000)
    quiet[300 : 300 + len(a)] = a
    first = classify_directions(way * quiet + noise, 0.01)[0]
    apart = np.degrees(first.angle) - degrees
    assert abs((apart + 90.0) % 180.0 - 90.0) < 3.0 and first.pulse_like
    assert first.period == pytest.approx(2.0, rel=0.1) and first.pgv == pytest.approx(0.8, rel=0.25)
    assert not any(one.pulse_like for one in classify_directions(10.0 * noise, 0.01))
    assert not any(one.pulse_like for one in classify_directions(0.1 * way * quiet, 0.01))
    late = classify_directions(np.concatenate([12.0 * noise, way * quiet], axis=1), 0.01)[0]
    assert late.before > 0.17 and not late.pulse_like
    assert classify_directions(np.zeros((2, 100)), 0.01) == []


# --- shake table


def test_appendix_c() -> None:
    """Fig. C-1 from its own data: 0.75 gal/min through 0.40 in^2, 2 in, 1.1 kip, 500 and 1000 lb."""
    inch, pound = 0.0254, 0.45359237
    table = Table(2 * inch, 0.75 * 231 * inch**3 / 60 / (0.4 * inch**2), 1100 * pound * G)
    assert table.velocity == pytest.approx(7.21875 * inch)
    heavy, light = table.corner_frequencies(1000 * pound), table.corner_frequencies(500 * pound)
    assert heavy["stroke_to_flow"] == pytest.approx(7.21875 / 2 / (2 * np.pi))
    # the text: below 1000 lb the pump governs (over the frequencies used, 2 to 10 Hz)
    assert 9.0 < heavy["flow_to_force"] < 10.0 < light["flow_to_force"]
    w = 2 * np.pi * 4.0
    limits = table.amplitudes(np.array([4.0]), 1000 * pound)
    assert limits["flow"][0] == pytest.approx(7.21875 * inch / w)
    assert limits["force"][0] == pytest.approx(1.1 * G / w**2)


def test_drive_of_a_sine() -> None:
    """A burst of 2 Hz: the table goes through a/w^2, is at rest before and after, and its acceleration is the motion's."""
    step, w = 0.005, 2 * np.pi * 2.0
    t = step * np.arange(4001)
    a = np.sin(w * t) * np.sin(np.pi * t / 20.0) ** 2
    drive = make_drive(a, step, 0.1)
    inside = (drive.time >= -1e-9) & (drive.time <= 20.0 + 1e-9)
    np.testing.assert_allclose(drive.acceleration[inside], a, atol=2e-4)
    middle = np.abs(drive.time - 10.0) < 2.0
    assert np.abs(drive.displacement[middle]).max() == pytest.approx(1.0 / w**2, rel=2e-3)
    assert np.abs(drive.displacement[[0, -1]]).max() < 1e-6 and np.abs(drive.velocity[[0, -1]]).max() < 1e-6
    # the drive's own second difference is its acceleration
    second = np.diff(drive.displacement, 2) / step**2
    np.testing.assert_allclose(second, drive.acceleration[1:-1], atol=4e-3)


def test_fitting_scales() -> None:
    step = 0.01
    t = step * np.arange(3001)
    drive = make_drive(8.0 * np.sin(2 * np.pi * t) * np.sin(np.pi * t / 30.0) ** 2, step, 0.1)
    table = Table(0.075, 0.6, 100.0)
    squeezed = fit(table, drive, 10.0)
    assert not squeezed.fits and squeezed.governing == "stroke" and squeezed.amplitude == 1.0
    played = drive.squeezed(squeezed.time_scale, squeezed.amplitude)
    again = fit(table, played, 10.0)
    assert max(again.stroke, again.flow) == pytest.approx(1.0) and again.fits
    lowered = fit(table, drive, 10.0, keep="time")
    assert lowered.time_scale == 1.0 and fit(table, drive.squeezed(1.0, lowered.amplitude), 10.0).fits
    # force does not fall with time: it needs the amplitude
    heavy = fit(table, drive, 30.0)
    assert heavy.amplitude < 1.0 and fit(table, drive.squeezed(heavy.time_scale, heavy.amplitude), 30.0).fits


# --- decks


MOTIONS = {
    "constant": {"amplitude": "0.1 g", "duration": 1.0},
    "step-pulse": {"amplitude": "1 g", "duration": 0.2},
    "sine-pulse": {"amplitude": "1 g", "period": 0.5},
    "harmonic": {"amplitude": "0.3 g", "frequency": 2.0, "duration": 4.0, "carrier": 0.125},
    "pulse": {"shape": "ricker", "amplitude": "0.4 g", "period": "0.6 s"},
    "velocity-pulse": {"velocity": "40 cm/s", "period": 1.0, "cycles": 1.4, "phase": 30.0},
    "record": {"file": "r.at2", "vertical": "v.at2", "pgv": "20 cm/s", "low_cut": "0.2 Hz", "baseline": "linear", "resample": 0.01},
    "suite": {"pattern": "*.at2", "sa": "0.3 g", "sa_period": 0.5},
    "generated": {"mmi": 6.5, "duration": 4.0, "envelope": "trapezoid"},
    "compatible": {"code": "EN1998-1", "acceleration": "0.2 g", "ground": "B", "duration": 12.0},
}


@pytest.mark.parametrize("kind", MOTIONS)
def test_every_motion_kind_is_studied_and_played(tmp_path, kind) -> None:
    record(tmp_path)
    record(tmp_path, "v.at2", 0.5)
    deck = tmp_path / "deck.toml"
    keys = "\n".join(f"{k} = {json.dumps(v)}" for k, v in MOTIONS[kind].items())
    deck.write_text(
        f'[motion]\nkind = "{kind}"\n{keys}\n[[analysis]]\nkind = "motion"\ncount = 3\nperiods = 30\n[[analysis]]\nkind = "shake-table"\n'
    )
    drawn = kind in ("record", "compatible")  # the other figures are the same two
    run = extrados.run(deck, tmp_path / "out", figures=drawn)
    assert [a["status"] for a in run.analyses] == ["ok", "ok"], run.analyses[0]["reason"] + run.analyses[1]["reason"]
    if drawn:
        names = {p.name for p in (tmp_path / "out" / "figures").iterdir()}
        assert {"motion-spectra.png", "shake-table-capacity.png", "shake-table-drive.png"} <= names
    if kind not in ("suite", "generated", "compatible"):
        r = run["motion"]
        assert r["pga_g"] > 0.0 and r["primary_impulse"].keys() >= {"amplitude_g", "period_s", "start_s"}
        assert (tmp_path / "out" / "motion.csv").exists() and (tmp_path / "out" / "motion.AT2").exists()
    if kind == "record":
        assert run["motion"]["pgv_m_s"] == pytest.approx(0.2, rel=1e-6) and run["motion"]["vertical_pga_g"] > 0.0


def test_members(tmp_path) -> None:
    record(tmp_path, "a.at2"), record(tmp_path, "b.at2", 0.5)
    deck = make_deck({"motion": {"kind": "suite", "folder": ".", "member": 2}, "analysis": {"kind": "motion"}}, tmp_path)
    assert make_motion(deck.motion, tmp_path).name == "b"
    assert [m.name for m in suite_motions(deck.motion, tmp_path)] == ["a", "b"]
    deck = make_deck({"motion": {"kind": "generated", "mmi": 7, "duration": 3.0, "member": 4}, "analysis": {"kind": "motion"}})
    (member,) = Generated(generated_set(deck.motion, tmp_path)).motions(3, 1, 1)
    assert member.name == make_motion(deck.motion, tmp_path).name == "generated motion 4"
    assert np.array_equal(member.ground.samples, make_motion(deck.motion, tmp_path).ground.samples)


def test_exported_record_is_the_motion(tmp_path) -> None:
    out = extrados.run({"motion": {"kind": "record", "file": "extrados:el-centro-1940"}, "analysis": {"kind": "motion"}}, tmp_path / "o")
    r = out["motion"]
    assert r["pga_g"] == pytest.approx(0.31882) and r["pga_time_s"] == pytest.approx(2.04)
    again = extrados.run(
        {"motion": {"kind": "record", "file": str(tmp_path / "o" / "motion.AT2")}, "analysis": {"kind": "motion"}}, tmp_path / "p"
    )["motion"]
    for key in ("pga_g", "pgv_m_s", "arias_m_s", "cav_m_s", "housner_intensity_m"):
        assert again[key] == pytest.approx(r[key], rel=1e-6)


@pytest.mark.parametrize(
    ("deck", "words"),
    [
        ('kind = "record"\nfile = "x"\npga = 0.3', "motion.pga: a number without a unit is ambiguous"),
        ('kind = "record"\nfile = "x"\npga = "0.3 g"\npgv = 0.1', "give only one of the keys `pga`"),
        ('kind = "record"\nfile = "x"\nsa = "0.3 g"', "sa and sa_period are only valid together"),
        ('kind = "suite"', "give only one of the keys `files`, `pattern`, `folder` and `records`"),
        ('kind = "generated"\nmmi = 6\nduration = 3\nscaling = "sokolov"', "'thesis', 'fourier' or 'energy'"),
        ('kind = "generated"\nmmi = 6\nduration = 3\nlines = [1.0]', "expected 2 to 2000"),
        ('kind = "compatible"\ncode = "ASCE7"\nsds = "1 g"', "requires sd1"),
        ('kind = "velocity-pulse"\nvelocity = 0.3\nperiod = 1\ncycles = 0.5', "greater than 1"),
    ],
)
def test_wrong_decks(deck, words) -> None:
    with pytest.raises(DeckError) as error:
        read_text(f'[motion]\n{deck}\n[analysis]\nkind = "motion"\n'.encode())
    assert any(words in c for c in error.value.complaints), error.value.complaints


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        ({"kind": "record", "file": "none.at2"}, "no such file"),
        ({"kind": "record", "file": "../x"}, "out of the deck's folder"),
        ({"kind": "suite", "pattern": "*.none"}, "no records match"),
        ({"kind": "suite", "files": ["r.at2"], "member": 2}, "has only 1 records"),
        ({"kind": "generated", "mmi": 11, "duration": 3.0}, "expected 4 to 9"),
        ({"kind": "generated", "mmi": 6, "duration": 3.0, "spectrum": "../s.csv"}, "out of the deck's folder"),
        ({"kind": "compatible", "code": "table", "table": "t.csv"}, "no such file"),
        ({"kind": "record", "file": "r.at2", "high_cut": 500.0}, "half of the sampling rate"),
    ],
)
def test_refused_with_a_reason(tmp_path, motion, words) -> None:
    record(tmp_path)
    deck = make_deck({"motion": motion, "analysis": {"kind": "shake-table"}}, tmp_path)
    from extrados.analyses.context import Context
    from extrados.analyses.sequence import run_analyses

    result = run_analyses(Context(deck))[0]
    assert result.status == "refused" and words in result.reason, result.reason


def test_command_line(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    record(tmp_path)
    runner = CliRunner()
    answer = runner.invoke(app, ["motion", "r.at2", "--baseline", "linear"])
    assert answer.exit_code == 0 and "pga_g" in answer.output and "impulse 1" in answer.output
    assert (tmp_path / "results" / "r" / "report.html").exists()
    (tmp_path / "bare.txt").write_text("".join(f"{v}\n" for v in files.series()))
    answer = runner.invoke(app, ["motion", "bare.txt", "--no-figures"])
    assert answer.exit_code == 3 and "time step" in answer.output
    answer = runner.invoke(app, ["motion", "bare.txt", "--time-step", "0.005", "--unit", "cm/s^2", "--no-figures", "--json"])
    assert answer.exit_code == 0
    assert json.loads(answer.output)["analyses"][0]["results"]["time_step_s"] == 0.005
    assert runner.invoke(app, ["motion", "r.at2", "--unit", "furlong"]).exit_code == 2


def test_measures_of_spectra_agree_with_their_definitions() -> None:
    from extrados.motions.measures import fourier_spectrum, spectral_measures

    step, f = 0.005, 2.5
    a = np.sin(2 * np.pi * f * step * np.arange(4000))
    s = spectral_measures(a, step)
    assert s.predominant_period == pytest.approx(1 / f, rel=0.03) and s.mean_period == pytest.approx(1 / f, rel=0.03)
    band = np.linspace(0.1, 2.5, 1201)
    assert s.housner_intensity == pytest.approx(np.trapezoid(core.response_spectra(a, step, band).psv[0], band), rel=3e-3)
    frequency, amplitude = fourier_spectrum(a, step)
    # Parseval: int a^2 dt = 2 int |X|^2 df
    assert 2 * np.trapezoid(amplitude**2, frequency) == pytest.approx(np.sum(a**2) * step, rel=1e-3)


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"\xff\xfe0\x001\x00",
        b"\0" * 100,
        b"0,1\n0,2\n0,3\n",
        b"0 1\n1 nan\n2 3\n",
        files.at2(files.series())[:900].encode(),
        b"\xe9" * 400,
    ],
    ids=["empty", "utf-16", "binary", "commas", "nan", "cut", "latin"],
)
def test_hostile_files_on_the_command_line(tmp_path, monkeypatch, raw) -> None:
    """A message with the file and exit code 3, never a traceback."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.at2").write_bytes(raw)
    answer = CliRunner().invoke(app, ["motion", "x.at2", "--no-figures"])
    assert answer.exit_code == 3 and "x.at2" in answer.output and "Traceback" not in answer.output
    assert isinstance(answer.exception, SystemExit)
