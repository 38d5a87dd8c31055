"""Ground motions in the core (fortran/motion, c/quake): generated sets, response spectra, measures, Fourier."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import long_call, real, room_for, thread_count
from extrados.core.errors import check

ENVELOPES = lists.numbers("envelope")
SPACINGS = lists.numbers("spacing")
SCALINGS = lists.numbers("scaling")
#: Points on the shortest oscillator period: sampled peaks are at most 1.2 % below the true ones.
POINTS_PER_CYCLE = 20
_I64 = 2**63 - 1


def _step(step: float) -> float:
    if not (np.isfinite(step) and step > 0.0):
        raise ValueError(f"time step is {step} s, expected a number above zero")
    return float(step)


def _batch(motions: npt.ArrayLike) -> np.ndarray:
    """(count, points) or (points,) as the core's (points, count)."""
    motions = np.atleast_2d(np.asarray(motions, dtype=float))
    if motions.ndim != 2 or motions.shape[1] < 2:
        raise ValueError(f"motions have shape {motions.shape}, expected (count, points) with at least two points")
    return real("motions", np.ascontiguousarray(motions).T, (None, None))


def envelope(kind: str, parameters: npt.ArrayLike, points: int, step: float) -> np.ndarray:
    """Envelope at 0, step, ... (points). parameters: start, duration [s] and two of the kind, see c/quake/envelope.c."""
    room_for(points)
    value, status = _core.api_motion.envelope(ENVELOPES[kind], real("parameters", parameters, (4,)), int(points), _step(step))
    check(status, f"{kind} envelope")
    return value


def line_spectrum(
    intensity: npt.ArrayLike, frequency: npt.ArrayLike, amplitude: npt.ArrayLike, wanted: float, lines: npt.ArrayLike
) -> np.ndarray:
    """Fourier amplitudes (n) at `lines` (n) [Hz] for an intensity that is wanted.

    amplitude (intensities, frequencies): known at each intensity and frequency [Hz]; log-log in between.
    """
    intensity, frequency = real("intensity", intensity, (None,)), real("frequency", frequency, (None,))
    table = real("amplitude", np.asarray(amplitude).T, (frequency.size, intensity.size))
    value, status = _core.api_motion.line_spectrum(intensity, frequency, table, float(wanted), real("lines", lines, (None,)))
    check(status, f"spectrum of intensity {wanted:g}")
    return value


def line_widths(lines: npt.ArrayLike, spacing: str) -> np.ndarray:
    """Share of the band (n) that each of the lines (n) stands for [Hz]; bin edges at geometric (log) or arithmetic (uniform) means."""
    width, status = _core.api_motion.line_widths(SPACINGS[spacing], real("lines", lines, (None,)))
    check(status, "widths of the lines")
    return width


def line_amplitudes(value: npt.ArrayLike, width: npt.ArrayLike, scaling: str, factor: float, duration: float) -> np.ndarray:
    """Amplitudes (n) of the sines [unit of value / s] from value and width (n) [Hz] of each line; duration: integral of
    the squared envelope [s]. Thesis Eq. 6.6."""
    value = real("value", value, (None,))
    amplitude, status = _core.api_motion.line_amplitudes(
        SCALINGS[scaling], float(factor), float(duration), value, real("width", width, value.shape)
    )
    check(status, "amplitudes of the lines")
    return amplitude


def phases(seed: int, index: int, count: int) -> np.ndarray:
    """Random phases (count) in [0, 2 pi) of motion `index` of the set `seed`."""
    room_for(count)
    phase, status = _core.api_motion.phases(int(seed), int(index), int(count))
    check(status, "random phases")
    return phase


def generate(
    lines: npt.ArrayLike, amplitude: npt.ArrayLike, window: npt.ArrayLike, step: float, seed: int, first: int, count: int, threads: int = 1
) -> np.ndarray:
    """Motions first .. first + count - 1 of the set `seed` (count, points), thesis Eqs 6.6 to 6.8.

    lines (n) [Hz] and the amplitude (n) of each [m/s^2]; window (points): envelope at 0, step [s], ... The bits of motion
    k depend on neither count, first nor threads.
    """
    lines, window = real("lines", lines, (None,)), real("window", window, (None,))
    if not (-_I64 <= seed <= _I64 and first >= 0 and count >= 1):
        raise ValueError(f"seed {seed}, first {first} or count {count} is out of range")
    room_for(window.size, count)
    room_for(window.size, 2 * lines.size)
    motions, status = long_call(
        _core.api_motion.generate,
        lines,
        real("amplitude", amplitude, lines.shape),
        _step(step),
        window,
        int(seed),
        int(first),
        int(count),
        thread_count(threads),
    )
    check(status, "generated motions")
    return motions.T


@dataclass(frozen=True)
class Spectra:
    """Response spectra (..., dampings, periods) over period [s]: displacement SD [m], relative velocity SV [m/s],
    absolute acceleration SA [m/s^2], and the pseudo-spectra of the displacement."""

    period: np.ndarray
    damping: np.ndarray
    sd: np.ndarray
    sv: np.ndarray
    sa: np.ndarray

    @property
    def psv(self) -> np.ndarray:
        """Pseudo-velocity [m/s]."""
        return self.sd * (2.0 * np.pi / self.period)

    @property
    def psa(self) -> np.ndarray:
        """Pseudo-acceleration [m/s^2]."""
        return self.sd * (2.0 * np.pi / self.period) ** 2


def response_spectra(
    motions: npt.ArrayLike,
    step: float,
    periods: npt.ArrayLike,
    dampings: npt.ArrayLike = (0.05,),
    *,
    threads: int = 1,
    points_per_cycle: int = POINTS_PER_CYCLE,
) -> Spectra:
    """Response spectra of one motion (points) or several (count, points) [m/s^2], from rest.

    motions: samples every `step` [s]; periods [s] and dampings (share of the critical) of the oscillators.
    Exact for samples joined by straight lines (Nigam and Jennings 1969); free vibration after the end counts.
    """
    batch = _batch(motions)
    periods, dampings = real("periods", periods, (None,)), real("dampings", dampings, (None,))
    if periods.size < 1 or dampings.size < 1 or np.any(dampings < 0.0) or np.any(dampings >= 1.0):
        raise ValueError("response spectra require at least one period, and damping ratios from 0 to below 1")
    if periods.min() * 4096 < points_per_cycle * _step(step):
        raise ValueError(f"period {periods.min():g} s is too short for a time step of {step:g} s")
    room_for(3, periods.size, dampings.size, batch.shape[1])
    peak, status = long_call(_core.api_motion.spectra, batch, _step(step), periods, dampings, int(points_per_cycle), thread_count(threads))
    check(status, "response spectra")
    peak = np.moveaxis(peak, (0, 1, 2, 3), (0, 3, 2, 1))
    if np.ndim(motions) == 1:
        peak = peak[:, 0]
    return Spectra(periods, dampings, *np.ascontiguousarray(peak))


def oscillator(motion: npt.ArrayLike, step: float, period: float, damping: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (points) [m] and velocity [m/s] of one oscillator relative to the ground at the samples of a motion
    (points) [m/s^2], from rest; step and period [s], damping as share of the critical."""
    u, v, status = _core.api_motion.oscillator(
        real("motion", motion, (None,)), _step(step), float(period), float(damping), POINTS_PER_CYCLE
    )
    check(status, "oscillator")
    return u, v


@dataclass(frozen=True)
class Measures:
    """Intensity measures, one entry per motion, SI. duration is that from 5 to 95 % of the Arias intensity."""

    pga: np.ndarray
    pga_time: np.ndarray
    pgv: np.ndarray
    pgd: np.ndarray
    arias: np.ndarray
    cav: np.ndarray
    t05: np.ndarray
    t75: np.ndarray
    t95: np.ndarray

    @property
    def duration(self) -> np.ndarray:
        """Significant duration 5-95 % (count) [s]."""
        return self.t95 - self.t05

    @property
    def duration_75(self) -> np.ndarray:
        """Significant duration 5-75 % (count) [s]."""
        return self.t75 - self.t05


def measures(motions: npt.ArrayLike, step: float, threads: int = 1) -> Measures:
    """Measures of motions, one (points) or several (count, points) [m/s^2]; exact for straight lines between samples."""
    value, status = long_call(_core.api_motion.motion_measure, _batch(motions), _step(step), thread_count(threads))
    check(status, "intensity measures")
    return Measures(*value)


def kinematics(motion: npt.ArrayLike, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocity (points) [m/s] and displacement [m] at the samples of a motion (points) [m/s^2] every `step` [s], from rest."""
    return _core.api_motion.kinematics(real("motion", motion, (None,)), _step(step))


def _affordable(length: int) -> int:
    """The length of a transform. GSL takes a time of it times each prime factor above 7, and cannot be stopped: some seconds at most."""
    room_for(length)
    left, slow, factor = length, 0, 2
    while factor * factor <= left:
        while left % factor == 0:
            left //= factor
            slow += factor if factor > 7 else 0
        factor += 1
    slow += left if left > 7 else 0
    if length * slow > 1e9:
        raise ValueError(f"the length of a Fourier transform is {length}, expected a product of small prime factors, such as a power of 2")
    return length


def fourier(series: npt.ArrayLike, length: int | None = None) -> np.ndarray:
    """Transform (length // 2 + 1,) complex of a real series (n) padded with zeros to `length`; GSL, not scaled.

    ValueError for a length of large prime factors, which would take minutes, or of more values than there may be."""
    series = real("series", series, (None,))
    length = int(length or series.size)
    if length < max(2, series.size):
        raise ValueError(f"the length of a Fourier transform is {length}, expected at least {max(2, series.size)}")
    re, im, status = _core.api_motion.fourier(series, _affordable(length), length // 2 + 1)
    check(status, "Fourier transform")
    return re + 1j * im


def fourier_inverse(transform: npt.ArrayLike, length: int) -> np.ndarray:
    """Real series (length) of a transform made by `fourier`."""
    transform = np.asarray(transform)
    half = _affordable(int(length)) // 2 + 1
    series, status = _core.api_motion.fourier_inverse(
        real("transform", transform.real, (half,)), real("transform", transform.imag, (half,)), int(length)
    )
    check(status, "inverse Fourier transform")
    return series
