"""Response spectra, measures and transforms of the core against closed forms and SciPy."""

import numpy as np
import pytest
from interrupting import interrupted
from scipy import signal

from extrados import _core
from extrados.core import motion as core
from extrados.core.errors import Cancelled, CoreError
from extrados.motions import processing
from extrados.motions.records import locate, read_record, record_motion

G = 9.80665


@pytest.fixture(scope="module")
def el_centro() -> tuple[np.ndarray, float]:
    from pathlib import Path

    motion = record_motion(read_record(locate("extrados:el-centro-1940", Path())))
    return motion.ground.samples[0], motion.ground.step


def scipy_peaks(a: np.ndarray, step: float, period: float, damping: float) -> np.ndarray:
    """Peaks of |u|, |u'|, |absolute acceleration| by SciPy's first-order hold, on the same instants, with the free
    vibration of half a cycle after the end."""
    parts = 1
    while period * parts < core.POINTS_PER_CYCLE * step:
        parts *= 2
    h = step / parts
    time = np.arange((len(a) - 1) * parts + 1) * h
    fine = np.interp(time, np.arange(len(a)) * step, a)
    w = 2.0 * np.pi / period
    system = signal.StateSpace(
        [[0, 1], [-(w**2), -2 * damping * w]], [[0], [-1]], [[1, 0], [0, 1], [-(w**2), -2 * damping * w]], np.zeros((3, 1))
    )
    _, y, x = signal.lsim(system, fine, time)
    tail = int(np.ceil(0.5 * period / (h * np.sqrt(1.0 - damping**2))))
    _, free, _ = signal.lsim(system, np.zeros(tail + 1), np.arange(tail + 1) * h, X0=x[-1])
    return np.maximum(np.abs(y).max(axis=0), np.abs(free).max(axis=0))


def test_spectra_against_scipy(el_centro) -> None:
    a, step = el_centro
    periods, dampings = np.array([0.02, 0.05, 0.11, 0.3, 0.41, 1.0, 3.7, 10.0, 20.0]), [0.0, 0.02, 0.05, 0.2, 0.7]
    s = core.response_spectra(a, step, periods, dampings, threads=2)
    for i, damping in enumerate(dampings):
        for j, period in enumerate(periods):
            expected = scipy_peaks(a, step, period, damping)
            found = [s.sd[i, j], s.sv[i, j], s.sa[i, j]]
            np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_published_ordinates(el_centro) -> None:
    """Chopra, Dynamics of Structures, Figs 6.4.1 and 6.6.2: El Centro 1940, 2 % damping, printed to three digits."""
    a, step = el_centro
    s = core.response_spectra(a, step, [0.5, 1.0, 2.0], [0.02])
    np.testing.assert_allclose(s.sd[0] / 0.0254, [2.67, 5.97, 7.47], rtol=3e-3)
    np.testing.assert_allclose(s.psv[0] / 0.0254, [33.7, 37.5, 23.5], rtol=3e-3)
    np.testing.assert_allclose(s.psa[0] / G, [1.09, 0.610, 0.191], rtol=4e-3)


def test_step_load_doubles() -> None:
    """An undamped oscillator under constant acceleration swings to twice the static displacement."""
    s = core.response_spectra(np.full(4001, 3.0), 0.001, [0.5, 1.0], [0.0])
    np.testing.assert_allclose(s.psa[0], 6.0, rtol=1e-6)


def test_free_vibration_after_the_end_counts() -> None:
    """A pulse shorter than a fortieth of the period: the peak is impulse / w, a quarter cycle after it."""
    pulse = np.array([0.0, 1.0, 0.0])
    s = core.response_spectra(pulse, 0.01, [4.0], [0.0])
    assert s.sd[0, 0] == pytest.approx(0.01 / (2.0 * np.pi / 4.0), rel=1e-4)


def test_free_vibration_is_not_sampled_without_end() -> None:
    """A motion of a nanosecond under periods of seconds: the half cycle after it has 1e10 of its steps, and the same peak."""
    s = core.response_spectra(np.array([1.0, 1.0]), 1e-9, [0.5, 10.0], [0.0])
    np.testing.assert_allclose(s.sd[0], 1e-9 * np.array([0.5, 10.0]) / (2.0 * np.pi), rtol=1e-9)


def test_long_periods_keep_their_digits() -> None:
    """The displacement spectrum tends to the peak ground displacement; closed forms lose it to cancellation."""
    t = 0.001 * np.arange(2001)
    a = np.sin(np.pi * t) * np.sin(2 * np.pi * 3 * t)
    _, d = core.kinematics(a, 0.001)
    w, wd = 2 * np.pi / 2000.0, 2 * np.pi / 2000.0 * np.sqrt(1 - 0.05**2)
    u, _ = core.oscillator(a, 0.001, 2000.0, 0.05)
    impulse = np.exp(-0.05 * w * t) * np.sin(wd * t) / wd
    exact = -np.array([np.trapezoid(a[: k + 1] * impulse[k::-1], dx=0.001) for k in (500, 1000, 2000)])
    np.testing.assert_allclose(u[[500, 1000, 2000]], exact, rtol=2e-5)
    assert np.abs(u).max() == pytest.approx(np.abs(d).max(), rel=1e-3)


def test_bits_depend_on_nothing_but_the_oscillator(el_centro) -> None:
    """Threads, neighbours in the list and the other motions of a batch change no bit."""
    a, step = el_centro
    periods = np.geomspace(0.02, 10.0, 37)
    one = core.response_spectra(a, step, periods, [0.02, 0.05], threads=1)
    two = core.response_spectra(np.stack([a[::-1], a, 2 * a]), step, periods, [0.02, 0.05], threads=2)
    assert np.array_equal(one.sd, two.sd[1]) and np.array_equal(one.sa, two.sa[1]) and np.array_equal(one.sv, two.sv[1])
    for k in (0, 9, 36):
        alone = core.response_spectra(a, step, periods[k : k + 1], [0.05])
        assert alone.sd[0, 0] == one.sd[1, k]


def test_fourier_against_numpy() -> None:
    rng = np.random.default_rng(0)
    for points, length in ((1000, 1024), (999, 999), (997, 997), (2, 2), (5, 16)):
        a = rng.standard_normal(points)
        x = core.fourier(a, length)
        np.testing.assert_allclose(x, np.fft.rfft(a, length), atol=1e-10)
        np.testing.assert_allclose(core.fourier_inverse(x, length)[:points], a, atol=1e-12)


def test_measures_of_a_sine() -> None:
    step, amplitude, f = 0.001, 2.0, 2.0
    t = step * np.arange(10001)
    m = core.measures(amplitude * np.sin(2 * np.pi * f * t), step)
    assert m.pga[0] == pytest.approx(amplitude) and m.pga_time[0] == pytest.approx(0.125)
    assert m.pgv[0] == pytest.approx(amplitude / (np.pi * f), rel=1e-4)
    assert m.arias[0] == pytest.approx(np.pi / (2 * G) * amplitude**2 / 2 * 10.0, rel=1e-9)
    assert m.cav[0] == pytest.approx(amplitude * 2 / np.pi * 10.0, rel=1e-4)
    assert m.duration[0] == pytest.approx(9.0, abs=0.03) and m.duration_75[0] == pytest.approx(7.0, abs=0.03)


def test_kinematics_are_exact_for_straight_lines() -> None:
    v, d = core.kinematics([0.0, 1.0, 1.0, -1.0], 0.5)
    np.testing.assert_allclose(v, [0.0, 0.25, 0.75, 0.75])
    np.testing.assert_allclose(d, [0.0, 1 / 24, 1 / 24 + 0.25, 1 / 24 + 0.25 + 0.375 + 0.25 * (2 - 1) / 6])
    # velocity turns between samples: the peak is found there
    assert core.measures([0.0, 1.0, 1.0, -1.0], 0.5).pgv[0] == pytest.approx(0.75 + 0.125)


def test_refusals(el_centro) -> None:
    a, step = el_centro
    for bad in (
        {"step": 0.0},
        {"step": np.nan},
        {"periods": [0.0]},
        {"periods": []},
        {"dampings": [1.0]},
        {"dampings": [-0.1]},
        {"threads": 0},
        {"periods": [1e-6]},
        {"motions": [1.0]},
        {"motions": [1.0, np.nan]},
        {"points_per_cycle": 4},
    ):
        keys = {"motions": a, "step": step, "periods": [1.0], "dampings": [0.05]} | bad
        with pytest.raises((ValueError, CoreError)):
            core.response_spectra(**keys)
    with pytest.raises(ValueError, match="use smaller batches"):
        core.generate([1.0], [1.0], np.ones(1000), 0.01, 1, 0, 10**7)


def test_a_long_call_can_be_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(core, "long_call", interrupted(core.long_call, 0.3, lambda: _core.api_support.set_cancel(1)))
    with pytest.raises(Cancelled):
        core.response_spectra(np.ones((20, 200_000)), 0.001, np.geomspace(0.02, 10, 1000), [0.05])
    _core.api_support.set_cancel(0)


def test_filter_takes_out_what_it_should() -> None:
    step = 0.005
    t = step * np.arange(8000)
    slow, fast = np.sin(2 * np.pi * 0.05 * t), np.sin(2 * np.pi * 2.0 * t)
    out = processing.band_pass(slow + fast, step, 0.4, 20.0)
    middle = slice(2000, 6000)
    np.testing.assert_allclose(out[middle], fast[middle], atol=2e-3)  # no phase, no slow part
    with pytest.raises(ValueError, match="not below"):
        processing.band_pass(fast, step, 5.0, 1.0)
    with pytest.raises(ValueError, match="half of the sampling rate"):
        processing.band_pass(fast, step, None, 100.0)


@pytest.mark.parametrize(("kind", "degree"), [("mean", 0), ("linear", 1), ("quadratic", 2), ("cubic", 3)])
def test_baseline_takes_a_trend_out(kind, degree) -> None:
    step, t = 0.01, 0.01 * np.arange(3000)
    trend = (t / 30.0) ** degree
    clean = np.sin(2 * np.pi * t) * np.sin(np.pi * t / 30.0) ** 2
    left = processing.baseline(trend, step, kind)
    assert np.abs(left).max() < 2e-3
    out = processing.baseline(clean + trend, step, kind)
    np.testing.assert_allclose(out, processing.baseline(clean, step, kind), atol=2e-3)
    assert np.array_equal(processing.baseline(clean, step, "none"), clean)


def test_resampling() -> None:
    step, t = 0.01, 0.01 * np.arange(3001)
    a = np.sin(2 * np.pi * 1.3 * t)
    finer = processing.resample(a, step, 0.0025)
    np.testing.assert_array_equal(finer[::4], a)
    coarser = processing.resample(a + np.sin(2 * np.pi * 40 * t), step, 0.04)
    assert len(coarser) == 751
    np.testing.assert_allclose(coarser[50:-50], np.sin(2 * np.pi * 1.3 * 0.04 * np.arange(751))[50:-50], atol=5e-3)


@pytest.mark.parametrize("measure", ["pga", "pgv", "arias", "sa"])
def test_scaling_reaches_its_measure(el_centro, measure) -> None:
    a, step = el_centro
    factor = processing.factor_to(a, step, **{measure: 0.7}, period=0.8 if measure == "sa" else None)
    if measure == "sa":
        assert core.response_spectra(factor * a, step, [0.8]).psa[0, 0] == pytest.approx(0.7)
    else:
        assert getattr(core.measures(factor * a, step), measure)[0] == pytest.approx(0.7)
    with pytest.raises(ValueError, match="the motion is zero"):
        processing.factor_to(0 * a, step, **{measure: 0.7}, period=0.8)


def test_at_rest() -> None:
    a = np.random.default_rng(1).standard_normal(2000)
    v, d = core.kinematics(processing.at_rest(a, 0.01), 0.01)
    assert abs(v[-1]) < 1e-12 and abs(d[-1]) < 1e-12
