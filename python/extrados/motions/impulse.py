"""The primary impulse of a motion: the single sine that fits it best (thesis 5.3.2, 5.4.2)."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np


@dataclass(frozen=True)
class Impulse:
    """One cycle of a sine, A_p sin(2 pi (t - start)/T_p).

    amplitude [m/s^2], signed; period, start [s]. explained: share of the motion's total squared
    acceleration that it takes away; goodness: 1 - (squared misfit)/(squared motion) over its own span.
    """

    amplitude: float
    period: float
    start: float
    explained: float
    goodness: float


def primary_impulses(
    time: np.ndarray, acceleration: np.ndarray, count: int = 3, min_period: float | None = None, max_period: float = 4.0
) -> list[Impulse]:
    """The strongest impulses, first the primary one; later ones do not overlap earlier ones.

    Least squares over amplitude, period, start and sign: for a given period and start the amplitude is
    linear, and the misfit falls by (a . s)^2/(s . s), so that quantity is greatest. Its greatest value over
    a grid of periods (all starts at once by FFT) is then polished continuously. time ascending in equal
    steps [s], acceleration [m/s^2].
    """
    step = float(time[1] - time[0])
    low = max(min_period or 4.0 * step, 4.0 * step)
    high = min(max_period, float(time[-1] - time[0]))
    total = float(acceleration @ acceleration)
    if high <= low or total <= 0.0:
        return []
    rest = acceleration.astype(float).copy()
    free = np.ones(len(rest), dtype=bool)
    periods = np.geomspace(low, high, max(40, int(40 * np.log(high / low))))
    found: list[Impulse] = []
    for _ in range(count):
        best = _best_on_grid(rest, free, step, periods)
        if best is None:
            break
        period, start = _polish(rest, free, step, *best, low, high)
        gain, amplitude, inside = _gain(rest, step, period, start)
        if gain <= 0.0:
            break
        here = acceleration[inside]
        offset = np.arange(inside.start, inside.stop) * step - start
        misfit = here - amplitude * np.sin(2.0 * np.pi * offset / period)
        found.append(Impulse(amplitude, period, float(time[0]) + start, gain / total, 1.0 - float(misfit @ misfit) / float(here @ here)))
        free[inside] = False
        rest[inside] = 0.0
    return found


def _best_on_grid(rest: np.ndarray, free: np.ndarray, step: float, periods: np.ndarray) -> tuple[float, float] | None:
    """Period and start of the greatest gain over the grid; impulses lie wholly in the free samples."""
    n = len(rest)
    size = 1 << int(np.ceil(np.log2(2 * n)))
    spectrum = np.fft.rfft(rest, size)
    blocked = np.concatenate([[0], np.cumsum(~free)])
    best, answer = 0.0, None
    block = max(1, _BLOCK // size)
    for first in range(0, len(periods), block):
        some = tuple(periods[first : first + block].tolist())
        lengths, squares, waves = _waves(some, step, size) if size <= _CACHED else _waves.__wrapped__(some, step, size)
        products = np.fft.irfft(spectrum * waves, size)
        for period, length, square, product in zip(some, lengths, squares, products, strict=True):
            if length > n:
                continue
            gain = product[: n - length + 1] ** 2 / square
            gain[blocked[length : length + len(gain)] > blocked[: len(gain)]] = 0.0
            k = int(gain.argmax())
            if gain[k] > best:
                best, answer = float(gain[k]), (period, k * step)
    return answer


#: Values of a block of correlations (8 MB), and the longest transforms whose waves are kept for the next motion.
_BLOCK, _CACHED = 1_000_000, 16384


@lru_cache(maxsize=8)
def _waves(periods: tuple[float, ...], step: float, size: int) -> tuple[list[int], list[float], np.ndarray]:
    """Samples, sum of squares and conjugate transform of one sine of each period."""
    lengths, squares, transforms = [], [], np.empty((len(periods), size // 2 + 1), dtype=complex)
    for k, period in enumerate(periods):
        length = int(period / step) + 1
        wave = np.sin(2.0 * np.pi * np.arange(length) * step / period)
        lengths.append(length)
        squares.append(float(wave @ wave))
        transforms[k] = np.conj(np.fft.rfft(wave, size))
    return lengths, squares, transforms


def _gain(rest: np.ndarray, step: float, period: float, start: float) -> tuple[float, float, slice]:
    """Fall of the squared misfit, the amplitude that gives it, and the samples inside the impulse."""
    first = max(0, int(np.ceil(start / step - 1e-9)))
    inside = slice(first, min(len(rest), int(np.floor((start + period) / step + 1e-9)) + 1))
    wave = np.sin((2.0 * np.pi / period) * (np.arange(inside.start, inside.stop) * step - start))
    square = float(wave @ wave)
    if square <= 0.0:
        return 0.0, 0.0, inside
    product = float(wave @ rest[inside])
    return product**2 / square, product / square, inside


def _polish(rest: np.ndarray, free: np.ndarray, step: float, period: float, start: float, low: float, high: float) -> tuple[float, float]:
    """Greatest gain near a grid point, over period and start between the samples."""
    from scipy.optimize import minimize  # takes 0.2 s to load

    def loss(x: np.ndarray) -> float:
        p, s = x
        if not low <= p <= high or s < 0.0 or s + p > (len(rest) - 1 + 1e-9) * step:
            return 0.0
        gain, _, inside = _gain(rest, step, p, s)
        return 0.0 if not free[inside].all() else -gain

    begin = loss(np.array([period, start]))
    corners = np.array([[period, start], [1.03 * period, start], [period, start + step]])
    rules = {"initial_simplex": corners, "xatol": 1e-5, "fatol": -1e-9 * begin, "maxiter": 400, "maxfev": 10_000}
    found = minimize(loss, corners[0], method="Nelder-Mead", options=rules)
    return (float(found.x[0]), float(found.x[1])) if found.fun <= begin else (period, start)
