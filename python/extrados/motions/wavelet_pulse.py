"""Baker's classification of near-fault pulses (2007, Bull. Seism. Soc. Am. 97:1486-1501)."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from extrados.core import motion as core

#: Low-pass filter of the fourth-order Daubechies wavelet
_DB4 = np.array(
    [
        0.23037781330885523,
        0.7148465705525415,
        0.6308807679295904,
        -0.02798376941698385,
        -0.18703481171888114,
        0.030841381835986965,
        0.032883011666982945,
        -0.010597401784997278,
    ]
)
_CENTRE = 5.0 / 7.0  # cycles per unit of the mother wavelet's time, whose support is 7 units
SHORTEST, LONGEST = 0.25, 15.0  # s: periods of pulses
_WAVELETS = 10  # of one scale make up the pulse
LEAST_PGV = 0.30  # m/s
LIKE = 0.85  # indicator


@dataclass(frozen=True)
class PulseClass:
    """indicator: above 0.85 pulse-like, below 0.15 not. period [s] and peak velocity [m/s] of the extracted pulse;
    early: it arrives early in the motion; pulse_like: all three of Baker's conditions (PGV above 0.30 m/s); fails: in
    words, those that are not met."""

    indicator: float
    period: float
    peak_velocity: float
    pgv_ratio: float
    energy_ratio: float
    early: bool
    pulse_like: bool
    velocity: np.ndarray
    fails: tuple[str, ...] = ()


@cache
def _mother(levels: int = 10) -> np.ndarray:
    """The db4 wavelet on its support of 7 units, 2^levels points a unit, by the cascade of its filters."""
    high = _DB4[::-1] * (-1.0) ** np.arange(8)
    wave = high
    for _ in range(levels - 1):
        up = np.zeros(2 * len(wave) - 1)
        up[::2] = wave
        wave = np.convolve(up, _DB4)
    return wave * 2.0 ** (levels / 2.0)


def _wavelet(length: int) -> np.ndarray:
    """Unit-energy wavelet on `length` samples."""
    mother = _mother()
    wave = np.interp(np.linspace(0.0, 1.0, length), np.linspace(0.0, 1.0, len(mother)), mother)
    return wave / np.sqrt(wave @ wave)


def classify(acceleration: np.ndarray, step: float) -> PulseClass:
    """Extract the strongest velocity pulse of an acceleration (points) [m/s^2] and classify the motion by it.

    The pulse is the wavelet of the greatest coefficient over all scales and times, and up to nine more of the same
    scale within half its length, each taken from what the ones before left.
    """
    from scipy.signal import fftconvolve  # takes half a second to load

    velocity, _ = core.kinematics(acceleration, step)
    pgv = float(np.abs(velocity).max())
    if pgv == 0.0:
        return _none(velocity, "nothing moves")
    if step * len(velocity) < 0.1 * SHORTEST:  # a wavelet would have samples without end
        return _none(velocity, f"the motion is over within {step * len(velocity):.3g} s, much before any pulse")
    # energy off the time grid's ends: a wavelet may reach beyond the record
    top = min(LONGEST, 0.9 * step * len(velocity) * _CENTRE)
    periods = np.geomspace(SHORTEST, max(top, 1.01 * SHORTEST), 80)
    lengths = np.unique(np.maximum(8, np.round(7.0 * _CENTRE * periods / step).astype(int)))
    best = (0.0, 0, 0)
    for length in lengths:
        coefficient = np.abs(fftconvolve(velocity, _wavelet(length)[::-1]))
        k = int(coefficient.argmax())
        if coefficient[k] > best[0]:
            best = (float(coefficient[k]), int(length), k)
    _, length, centre = best
    wave = _wavelet(length)
    rest, near = velocity.copy(), length // 2
    for _ in range(_WAVELETS):
        coefficient = fftconvolve(rest, wave[::-1])
        low, high = max(0, centre - near), min(len(coefficient), centre + near + 1)
        k = low + int(np.argmax(np.abs(coefficient[low:high])))
        start = k - (length - 1)
        a, b = max(0, start), min(len(rest), start + length)
        rest[a:b] -= coefficient[k] * wave[a - start : b - start]
    pulse = velocity - rest
    pgv_ratio = float(np.abs(rest).max()) / pgv
    energy_ratio = float((rest / pgv) @ (rest / pgv)) / float((velocity / pgv) @ (velocity / pgv))
    indicator = float(1.0 / (1.0 + np.exp(-23.3 + 14.6 * pgv_ratio + 20.5 * energy_ratio)))
    early = _time_of(pulse, 0.10) < _time_of(velocity, 0.20)
    fails = []
    if indicator <= LIKE:
        fails.append(f"the pulse indicator {indicator:.2f} is not above {LIKE:g}")
    if not early:
        fails.append("the pulse does not arrive early in the motion")
    if pgv <= LEAST_PGV:
        fails.append(f"the peak velocity of {100.0 * pgv:.3g} cm/s is not above {100.0 * LEAST_PGV:g} cm/s")
    return PulseClass(
        indicator,
        float(length * step / (7.0 * _CENTRE)),
        float(np.abs(pulse).max()),
        pgv_ratio,
        energy_ratio,
        early,
        not fails,
        pulse,
        tuple(fails),
    )


def _none(velocity: np.ndarray, reason: str) -> PulseClass:
    """No pulse at all, and why."""
    return PulseClass(0.0, 0.0, 0.0, 1.0, 1.0, False, False, np.zeros_like(velocity), (reason,))


def _time_of(velocity: np.ndarray, share: float) -> int:
    """Sample at which the cumulative squared velocity reaches a share of its end."""
    total = np.cumsum(velocity**2)
    return int(np.searchsorted(total, share * total[-1]))
