"""Generated and spectrum-compatible motions: the spectra they stand for, uniform phases, the same bits anywhere."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from extrados.core import motion as core
from extrados.core.errors import CoreError
from extrados.motions import code_spectra, line_spectra, point_source
from extrados.motions.compatible import CompatibleSet, NotMatched
from extrados.motions.generated import Window, generated
from extrados.motions.line_spectra import SpectrumFileError, load_spectrum

G = 9.80665


def test_same_bits_in_any_batch_and_on_any_thread() -> None:
    made = generated(7, 6.0, seed=12)
    whole = made.batch(0, 200, threads=1)
    assert np.array_equal(whole, made.batch(0, 200, threads=2))
    assert np.array_equal(whole[57], made.motion(57)) and np.array_equal(whole[130:160], made.batch(130, 30))
    streamed = np.concatenate([batch for _, batch in made.batches(200, size=33, threads=2)])
    assert np.array_equal(whole, streamed)
    assert [first for first, _ in made.batches(200, first=1000, size=90)] == [1000, 1090, 1180]


def test_motion_is_the_sum_of_equation_6_6() -> None:
    made = generated(6, 3.0, seed=-5, scaling="thesis", factor=5.0)
    t = made.step * np.arange(made.points)
    window = (np.arctan((t - 0.5) / 0.1) - np.arctan((t - 3.5) / 0.1)) / np.pi
    np.testing.assert_allclose(made.window, window, atol=1e-15)
    phases = core.phases(-5, 41, 15)
    amplitude = 5.0 * made.spectrum * made.widths
    expected = window * sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in zip(amplitude, made.lines, phases, strict=True))
    np.testing.assert_allclose(made.motion(41), expected, atol=1e-12)


def test_seeds_and_members_differ() -> None:
    first = np.array([core.phases(seed, k, 1)[0] for seed in (0, 1, 2, 4357, -1) for k in range(20000)])
    # 100,000 draws of a 32-bit generator: about one pair is equal by chance
    assert len(np.unique(first)) > 99_990
    with pytest.raises(CoreError):
        core.phases(1, -1, 3)
    with pytest.raises(CoreError):
        core.phases(1, 2**32, 3)


def test_phases_are_uniform_and_independent() -> None:
    phases = np.array([core.phases(3, k, 15) for k in range(20000)]) / (2 * np.pi)
    assert phases.min() >= 0.0 and phases.max() < 1.0
    # 15 lines and their sum modulo 1, Bonferroni at 1 %
    for column in (*phases.T, phases.sum(axis=1) % 1.0):
        assert stats.kstest(column, "uniform").pvalue > 0.01 / 16
    z = np.exp(2j * np.pi * phases)
    between_lines = np.abs(z.conj().T @ z / len(z))[np.triu_indices(15, 1)]
    between_motions = np.abs((z[1:].conj() * z[:-1]).mean(axis=0))
    # |mean of n unit phasors|^2 n is exponential: 5.5 standard deviations
    assert max(between_lines.max(), between_motions.max()) < 5.5 / np.sqrt(len(z) - 1)


@pytest.mark.parametrize("scaling", ["thesis", "fourier", "energy"])
@pytest.mark.parametrize("envelope", ["arctangent", "trapezoid", "jennings", "saragoni-hart"])
def test_ensemble_mean_spectrum(scaling, envelope) -> None:
    """The mean square Fourier amplitude is the sum over lines of A^2/4 times that of the window shifted to the line."""
    made = generated(7, 5.0, seed=8, scaling=scaling, window=Window(envelope), factor=1.5)
    count, length = 4000, 2048
    power = np.zeros(length // 2 + 1)
    for _, batch in made.batches(count):
        power += (np.abs(np.fft.rfft(batch, length)) ** 2).sum(axis=0)
    power /= count
    t = made.step * np.arange(made.points)
    expected = np.zeros_like(power)
    for amplitude, f in zip(made.amplitude, made.lines, strict=True):
        up = np.fft.rfft(made.window * np.cos(2 * np.pi * f * t), length)
        side = np.fft.rfft(made.window * np.sin(2 * np.pi * f * t), length)
        expected += 0.5 * amplitude**2 * (np.abs(up) ** 2 + np.abs(side) ** 2)
    # the power at a frequency is a sum of nearly independent terms, no wider than an exponential variable's
    np.testing.assert_allclose(power, expected, atol=0.0, rtol=6.0 / np.sqrt(count))
    # and all frequencies together are ten times as sure
    assert power.sum() == pytest.approx(expected.sum(), rel=0.6 / np.sqrt(count))


@pytest.mark.parametrize("envelope", ["arctangent", "trapezoid", "jennings", "saragoni-hart"])
@pytest.mark.parametrize("lines", [15, 40])
def test_energy_scaling_keeps_the_energy(envelope, lines) -> None:
    """Whatever duration, envelope and number of lines, the Arias intensity is that of the spectrum."""
    for duration in (3.0, 12.0):
        made = generated(6, duration, seed=4, lines=lines, window=Window(envelope))
        arias = core.measures(made.batch(0, 1500), made.step).arias.mean()
        assert arias == pytest.approx(made.expected()["arias"], rel=0.012)


def test_line_sets_of_the_notes() -> None:
    """Bin widths and amplitudes of the substitute spectrum, printed to three digits."""
    made = generated(6, 3.0)
    np.testing.assert_allclose(made.widths[[0, 1, 7, 14]], [0.0997, 0.1279, 0.5685, 3.2409], rtol=1e-3)
    np.testing.assert_allclose(
        100 * made.spectrum,
        [15.75, 17.86, 19.70, 21.04, 22.06, 22.74, 23.12, 23.02, 22.26, 20.78, 18.66, 16.07, 13.05, 9.91, 6.91],
        rtol=1e-3,
    )
    uniform = generated(6, 3.0, spacing="uniform")
    np.testing.assert_allclose(uniform.lines, 0.4 + 0.9 * np.arange(15))
    np.testing.assert_allclose(uniform.widths, 0.9)


def test_shipped_spectrum_is_that_of_the_point_source() -> None:
    table = load_spectrum()
    for k, intensity in enumerate(table.intensity):
        source = point_source.source_of(intensity)
        np.testing.assert_allclose(table.amplitude[k], source.spectrum(table.frequency), rtol=1e-5)
        pga, pgv = source.peaks()
        assert pga == pytest.approx(point_source.worden_pga(intensity), rel=1e-6)
        assert pgv == pytest.approx(point_source.worden_pgv(intensity), rel=1e-6)
    assert point_source.worden_pga(7) == pytest.approx(2.11, rel=1e-3)
    assert point_source.worden_pgv(7) == pytest.approx(0.1998, rel=1e-3)


@pytest.mark.parametrize("mmi", [5, 6, 7, 8, 9])
def test_energy_scaling_gives_motions_of_the_intensity(mmi) -> None:
    """With the source's own duration the medians come out near those the spectrum was matched to."""
    made = generated(mmi, point_source.source_of(mmi).duration, seed=2, lines=40, window=Window("saragoni-hart"))
    m = core.measures(made.batch(0, 1000), made.step)
    assert 0.6 < np.median(m.pga) / made.expected()["pga"] < 1.6
    assert 0.6 < np.median(m.pgv) / made.expected()["pgv"] < 1.6


def test_envelopes() -> None:
    t = 0.01 * np.arange(2001)
    trapezoid = core.envelope("trapezoid", (1.0, 10.0, 2.0, 3.0), 2001, 0.01)
    np.testing.assert_allclose(trapezoid, np.interp(t, [1, 3, 8, 11], [0, 1, 1, 0]), atol=1e-12)
    jennings = core.envelope("jennings", (1.0, 6.0, 2.0, 0.5), 2001, 0.01)
    expected = np.where(t < 1, 0, np.where(t < 3, ((t - 1) / 2) ** 2, np.where(t <= 7, 1.0, np.exp(-0.5 * (t - 7)))))
    np.testing.assert_allclose(jennings, expected, atol=1e-12)
    hart = core.envelope("saragoni-hart", (0.0, 20.0, 0.2, 0.05), 2001, 0.01)
    assert hart.argmax() == 400 and hart.max() == pytest.approx(1.0) and hart[-1] == pytest.approx(0.05)
    for kind, bad in (
        ("trapezoid", (0, 1, 0.8, 0.4)),
        ("jennings", (0, 1, 2, 1)),
        ("saragoni-hart", (0, 1, 1.2, 0.1)),
        ("arctangent", (0, 1, 0, 0)),
    ):
        with pytest.raises(CoreError):
            core.envelope(kind, bad, 10, 0.1)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"mmi": 3.9}, "expected 4 to 9"),
        ({"lines": [0.1, 1.0]}, "expected 0.4 to 13"),
        ({"lines": 1}, "at least 2"),
        ({"step": 0.05}, "requires a time step below"),
        ({"duration": 0.0}, "above zero"),
        ({"lines": [2.0, 1.0]}, "increasing"),
        ({"spectrum": "nowhere.csv"}, "no such file"),
        ({"window": Window("square")}, "unknown envelope"),
    ],
)
def test_refusals(keys, words) -> None:
    with pytest.raises(ValueError, match=words):
        generated(**({"mmi": 6, "duration": 3.0} | keys))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mmi,f,a\n", ":1: the header"),
        ("mmi,frequency_Hz,amplitude_cm_s\n6,1\n", ":2: expected three numbers"),
        ("mmi,frequency_Hz,amplitude_cm_s\n6,1,nan\n", ":2: expected intensity"),
        ("mmi,frequency_Hz,amplitude_cm_s\n6,1,2\n6,1,2\n", ":3: .*occurs twice"),
        ("mmi,frequency_Hz,amplitude_cm_s\n6,1,2\n7,2,2\n", "all of them at the same"),
        ("", ":1: the header"),
    ],
)
def test_bad_spectrum_files(tmp_path, text, words) -> None:
    (tmp_path / "s.csv").write_text(text)
    with pytest.raises(SpectrumFileError, match=words):
        load_spectrum("s.csv", tmp_path)


def test_a_users_own_spectrum(tmp_path) -> None:
    (tmp_path / "s.csv").write_text("mmi,frequency_Hz,amplitude_cm_s\n6,1,10\n6,4,40\n8,1,40\n8,4,160\n")
    made = generated(7, 3.0, spectrum="s.csv", folder=tmp_path, lines=[1.0, 2.0, 4.0])
    # log-log in between: the geometric means
    np.testing.assert_allclose(made.spectrum, [0.2, 0.4, 0.8], rtol=1e-12)
    assert line_spectra.load_spectrum("s.csv", tmp_path).band == (1.0, 4.0)


# --- spectra of codes and motions compatible with them


def test_code_spectra_at_printed_points() -> None:
    """EN 1998-1 Eqs 3.2 to 3.5, NTC 2018 and ASCE 7 worked by hand."""
    se = code_spectra.en1998(1, "C", 0.25 * G)
    np.testing.assert_allclose(
        se(np.array([0.0, 0.1, 0.2, 0.6, 1.2, 2.0, 4.0])) / G,
        [0.2875, 0.2875 * 1.75, 0.71875, 0.71875, 0.359375, 0.215625, 0.05390625],
        rtol=1e-12,
    )
    assert code_spectra.damping_factor(0.05) == 1.0 and code_spectra.damping_factor(0.3) == 0.55
    se = code_spectra.ntc("B", 0.2 * G, 2.4, 0.35)
    soil, corner = 1.4 - 0.4 * 2.4 * 0.2, 1.1 * 0.35**-0.2 * 0.35
    assert soil > 1.2 and se(np.array([0.0]))[0] == pytest.approx(0.2 * G * 1.2)
    assert se(np.array([corner]))[0] == pytest.approx(0.2 * G * 1.2 * 2.4)
    assert se(np.array([2.4]))[0] == pytest.approx(0.2 * G * 1.2 * 2.4 * corner / 2.4)
    se = code_spectra.asce7(1.0 * G, 0.6 * G, 8.0)
    np.testing.assert_allclose(se(np.array([0.0, 0.12, 0.6, 1.2, 16.0])) / G, [0.4, 1.0, 1.0, 0.5, 0.6 * 8 / 256], rtol=1e-12)


@pytest.mark.parametrize(
    ("target", "damping", "band"),
    [
        (code_spectra.en1998(1, "A", 2.0), 0.05, (0.05, 2.0)),
        (code_spectra.en1998(2, "D", 1.5), 0.05, (0.05, 2.0)),
        (code_spectra.ntc("C", 2.0, 2.4, 0.35), 0.05, (0.05, 3.0)),
        (code_spectra.asce7(9.0, 5.0, 8.0), 0.05, (0.05, 2.0)),
        (code_spectra.en1998(1, "B", 3.0, 0.02), 0.02, (0.1, 2.0)),
    ],
)
def test_compatible_motions(target, damping, band) -> None:
    """Within 10 % of the target at other periods than those that were matched, and at rest at the end."""
    made = CompatibleSet(target, damping, *band, 0.1, 20.0, 0.01, 3)
    for motion in made.motions(2):
        periods = np.geomspace(*band, 777)
        psa = core.response_spectra(motion, 0.01, periods, [damping]).psa[0]
        assert np.max(np.abs(psa / target(periods) - 1.0)) < 0.1005
        v, d = core.kinematics(motion, 0.01)
        assert abs(v[-1]) < 1e-9 * np.abs(v).max() and abs(d[-1]) < 1e-9 * np.abs(d).max()
        assert max(abs(motion[0]), abs(motion[-1])) < 0.01 * np.abs(motion).max()
    assert np.array_equal(made.motion(1), motion), "one seed, one motion"
    assert not np.allclose(made.motion(0), motion)


def test_impossible_targets_are_refused() -> None:
    made = CompatibleSet(code_spectra.en1998(1, "A", 2.0), 0.05, 0.2, 1.0, 0.001, 3.0, 0.02, 1)
    with pytest.raises(NotMatched, match="Increase `tolerance`"):
        made.motion(0)


def test_spectrum_tables(tmp_path) -> None:
    path = Path(tmp_path / "t.csv")
    path.write_text("period_s,sa_g\n0,0.1\n1,0.3\n")
    assert code_spectra.read_table(path)(np.array([0.5]))[0] == pytest.approx(0.2 * G)
    with pytest.raises(ValueError, match="ends at 1 s"):
        code_spectra.read_table(path)(np.array([1.5]))
    for text, words in (
        ("a,b\n", ":1: the header"),
        ("period_s,sa_g\n1,2\n1,3\n", ":3: the periods must increase"),
        ("period_s,sa_g\n1,x\n", ":2:"),
    ):
        path.write_text(text)
        with pytest.raises(ValueError, match=words):
            code_spectra.read_table(path)
