"""Classification of near-fault pulses of one component (Baker 2007, Bull. Seism. Soc. Am. 97:1486-1501) and over all directions (Shahi
and Baker 2014, Bull. Seism. Soc. Am. 104:2456-2466)."""

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
_SCALES = 50  # over all directions
_CANDIDATES = 5
_NEAR = 10.0 / 25.0  # of a scale (a seventh of a wavelet): where further wavelets lie, and what a candidate blocks
LATE = 0.17  # share of the energy of the motion before the pulse begins


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
        return _none(velocity, f"the motion ends after {step * len(velocity):.3g} s, which is too short for a pulse")
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
    rest = _without(velocity, length, centre, length // 2)
    pulse = velocity - rest
    pgv_ratio = float(np.abs(rest).max()) / pgv
    energy_ratio = float((rest / pgv) @ (rest / pgv)) / float((velocity / pgv) @ (velocity / pgv))
    indicator = float(1.0 / (1.0 + np.exp(-23.3 + 14.6 * pgv_ratio + 20.5 * energy_ratio)))
    early = _time_of(pulse, 0.10) < _time_of(velocity, 0.20)
    fails = []
    if indicator <= LIKE:
        fails.append(f"the pulse indicator is {indicator:.2f}, not above {LIKE:g}")
    if not early:
        fails.append("the pulse does not arrive early in the motion")
    if pgv <= LEAST_PGV:
        fails.append(f"the peak velocity is {100.0 * pgv:.3g} cm/s, not above {100.0 * LEAST_PGV:g} cm/s")
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


def _without(velocity: np.ndarray, length: int, centre: int, near: int) -> np.ndarray:
    """What ten wavelets of a length leave of a velocity (points), each taken from what the ones before left: the strongest within `near`
    samples of `centre`, the others of the first one; centre: last sample of a wavelet."""
    from scipy.signal import fftconvolve

    wave, rest = _wavelet(length), velocity.copy()
    for number in range(_WAVELETS):
        coefficient = fftconvolve(rest, wave[::-1])
        low, high = max(0, centre - near), min(len(coefficient), centre + near + 1)
        k = low + int(np.argmax(np.abs(coefficient[low:high])))
        centre = centre if number else k
        start = k - (length - 1)
        a, b = max(0, start), min(len(rest), start + length)
        rest[a:b] -= coefficient[k] * wave[a - start : b - start]
    return rest


@dataclass(frozen=True)
class DirectedPulse:
    """A pulse in its own direction, `angle` from the first component [rad]: period [s], peak velocity of the motion in that direction [m/s],
    ratios of peak velocity and of energy that the motion without the pulse has, share of its energy before the pulse begins; indicator:
    above 0 pulse-like, if not late."""

    indicator: float
    period: float
    angle: float
    pgv: float
    pgv_ratio: float
    energy_ratio: float
    before: float

    @property
    def pulse_like(self) -> bool:
        """Whether the motion is pulse-like by this pulse."""
        return self.indicator > 0.0 and self.before < LATE


def classify_directions(components: np.ndarray, step: float, shortest: float = SHORTEST, longest: float = LONGEST) -> list[DirectedPulse]:
    """Up to five candidates, strongest first, of two horizontal accelerations (2, points) [m/s^2]; none where nothing moves or the motion is
    over before a pulse. The sum of both squared coefficients of a wavelet is that in the direction of its greatest one."""
    from scipy.signal import fftconvolve

    velocity = np.array([core.kinematics(row, step)[0] for row in components])
    points = velocity.shape[1]
    unit = _CENTRE / step  # samples of the wavelet's time unit for a period of 1 s
    least = max(2.0, np.floor(shortest * unit))
    if not velocity.any() or step * points < shortest:
        return []
    scales = least + np.ceil((longest * unit - least) / _SCALES) * np.arange(_SCALES + 1)
    waves = [_wavelet(round(7.0 * scale)) for scale in scales]
    pairs = np.array([[fftconvolve(row, wave[::-1])[_middle(len(wave), points)] for row in velocity] for wave in waves])
    energy = (pairs**2).sum(axis=1)
    found = []
    for _ in range(_CANDIDATES):
        row, at = np.unravel_index(int(energy.argmax()), energy.shape)
        if energy[row, at] == 0.0:
            break
        angle = float(np.arctan2(pairs[row, 1, at], pairs[row, 0, at]))
        angle -= np.pi * np.round(angle / np.pi)  # a pulse and its opposite have one direction
        signal = np.cos(angle) * velocity[0] + np.sin(angle) * velocity[1]
        finer = np.arange(scales[max(row - 1, 0)], scales[min(row + 1, _SCALES)] + 1.0)
        scale = float(finer[int(np.argmax([abs(_coefficient(signal, round(7.0 * one), int(at))) for one in finer]))])
        found.append(_directed(signal, scale, int(at), float(angle), step))
        near = _NEAR * scales[row]
        energy[:, max(0, int(np.ceil(at - near))) : int(at + near) + 1] = 0.0
    return found


def _middle(length: int, points: int) -> slice:
    """Of a whole convolution with a wavelet of a length, those centred on the samples of the motion."""
    return slice(length // 2, length // 2 + points)


def _coefficient(velocity: np.ndarray, length: int, centre: int) -> float:
    """Of the wavelet of a length that is centred on a sample."""
    start = centre + length // 2 - (length - 1)
    a, b = max(0, start), min(len(velocity), start + length)
    return float(velocity[a:b] @ _wavelet(length)[a - start : b - start])


def _directed(signal: np.ndarray, scale: float, at: int, angle: float, step: float) -> DirectedPulse:
    """The pulse of a scale [samples] about a sample of the velocity in its direction, and the indicator of Shahi and Baker (cm/s)."""
    length = round(7.0 * scale)
    rest = _without(signal, length, at + length // 2, int(np.ceil(_NEAR * scale)))
    pgv = float(np.abs(signal).max())
    pgv_ratio, energy_ratio = float(np.abs(rest).max()) / pgv, float(rest @ rest) / float(signal @ signal)
    pulse = np.cumsum((signal - rest) ** 2)
    begins = max(int(np.searchsorted(pulse, 0.05 * pulse[-1], side="right")) - 1, 0)
    total = np.cumsum(signal**2)
    p = (0.63 * pgv_ratio + 0.777 * energy_ratio - 1.208421) / 0.2462717
    v = (100.0 * pgv - 11.58861) / 18.88015
    indicator = -7.817 - 0.5679 * p**2 - 0.1516 * v**2 - 3.0253 * p - 1.7396 * v - 2.7156 * p * v
    return DirectedPulse(float(indicator), scale * step / _CENTRE, angle, pgv, pgv_ratio, energy_ratio, float(total[begins] / total[-1]))


def _none(velocity: np.ndarray, reason: str) -> PulseClass:
    """No pulse at all, and why."""
    return PulseClass(0.0, 0.0, 0.0, 1.0, 1.0, False, False, np.zeros_like(velocity), (reason,))


def _time_of(velocity: np.ndarray, share: float) -> int:
    """Sample at which the cumulative squared velocity reaches a share of its end."""
    total = np.cumsum(velocity**2)
    return int(np.searchsorted(total, share * total[-1]))
