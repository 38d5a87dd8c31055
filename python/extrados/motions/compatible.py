"""Accelerograms whose response spectrum matches a target (Gasparini and Vanmarcke 1976, then corrected in time).

1. Target -> power spectral density by random vibration; sines with random phases under an envelope.
2. Fourier amplitudes are multiplied by target over computed spectrum, a few times.
3. What is left is taken out by wavelets, each the mirrored impulse response of one oscillator about the time of its
   peak (Lilhanand and Tseng 1988): the acceleration of least energy that changes that peak.
Every motion is baseline corrected before it is measured against the target.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from extrados.core import motion as core
from extrados.core.rocking import Ground
from extrados.motions import processing
from extrados.motions.code_spectra import Spectrum
from extrados.motions.generated import envelope_parameters

_COARSE_ROUNDS, _FINE_ROUNDS = 12, 40
_DRAWS = 5  # sets of phases tried for one motion
_PER_DECADE = 60  # periods at which the spectrum is matched; checked between them too


class NotMatched(ArithmeticError):
    """A motion could not be brought within the tolerance."""


@dataclass(frozen=True)
class CompatibleSet:
    """Motions k = 0, 1, ... of one seed that match `target` at `damping` within `tolerance` from shortest to longest [s]."""

    target: Spectrum
    damping: float
    shortest: float
    longest: float
    tolerance: float
    duration: float
    step: float
    seed: int
    envelope: str = "trapezoid"
    rise: float | None = None
    decay: float | None = None

    @property
    def points(self) -> int:
        return round(self.duration / self.step) + 1

    def _periods(self, per_decade: int) -> np.ndarray:
        return np.geomspace(self.shortest, self.longest, int(per_decade * np.log10(self.longest / self.shortest)) + 2)

    def motion(self, k: int) -> np.ndarray:
        """Motion k (points) [m/s^2]; NotMatched where no draw of phases comes within the tolerance."""
        misfits = []
        for draw in range(_DRAWS):
            motion = self._matched(k, draw)
            misfits.append(self.misfit(motion))
            if misfits[-1] <= self.tolerance:
                return motion
        raise NotMatched(
            f"motion {k + 1} of seed {self.seed} stays {100 * min(misfits):.0f} % off its target in {_DRAWS} draws; "
            "widen the tolerance, narrow the band or lengthen the motion"
        )

    def _matched(self, k: int, draw: int) -> np.ndarray:
        periods, between = self._periods(_PER_DECADE), self._periods(4 * _PER_DECADE)
        wanted = self.target(periods)
        motion = best = self._level(self._first(k, draw))
        least = np.inf
        for _ in range(_COARSE_ROUNDS):
            psa = core.response_spectra(motion, self.step, periods, [self.damping]).psa[0]
            off = float(np.max(np.abs(psa / wanted - 1.0)))
            if off < least:
                best, least = motion, off
            motion = self._level(self._filtered(motion, periods, wanted / psa))
        motion = best
        for _ in range(_FINE_ROUNDS):
            if self.misfit(motion, between) <= 0.97 * self.tolerance:
                break
            motion = self._level(self._with_wavelets(motion, periods, wanted))
        return motion

    def motions(self, count: int, first: int = 0) -> Iterator[np.ndarray]:
        """Motions first .. first + count - 1, one at a time."""
        for k in range(first, first + count):
            yield self.motion(k)

    def ground(self, k: int) -> Ground:
        """Motion k as the rocking core takes it."""
        return Ground(samples=self.motion(k)[None, :], step=self.step)

    def misfit(self, motion: np.ndarray, periods: np.ndarray | None = None) -> float:
        """Largest relative deviation of the spectrum from the target over the band."""
        periods = self._periods(4 * _PER_DECADE) if periods is None else periods
        psa = core.response_spectra(motion, self.step, periods, [self.damping]).psa[0]
        return float(np.max(np.abs(psa / self.target(periods) - 1.0)))

    def _window(self) -> np.ndarray:
        parameters = list(envelope_parameters(self.envelope, self.duration, 0.0, self.rise, self.decay))
        if self.envelope == "jennings":  # its decay comes after the level: both must fit into the motion
            fall = 0.4 * self.duration if self.decay is None else self.decay
            parameters[1] = self.duration - fall
            parameters[2] = min(parameters[2], parameters[1])
        return core.envelope(self.envelope, parameters, self.points, self.step)

    def _density(self, w: np.ndarray) -> np.ndarray:
        """One-sided power spectral density at w [rad/s], Gasparini and Vanmarcke (1976).

        G(w) [pi/(4 zeta_s) - 1] w = (w Sv / r)^2 - int_0^w G: damping zeta_s that grows over the strong part, peak
        factor r of the response for median peaks.
        """
        strong = 0.5 * self.duration
        damping = self.damping / (1.0 - np.exp(-2.0 * self.damping * w * strong))
        crossings = np.maximum(w * strong / (2.0 * np.pi), 1.5)
        factor = np.sqrt(2.0 * np.log(2.8 * crossings))
        psa = self.target(np.clip(2.0 * np.pi / w, 0.0, self.longest))
        spread = np.maximum(np.pi / (4.0 * damping) - 1.0, 1.0)
        density, below = np.zeros_like(w), 0.0
        step = np.gradient(w)
        for i in range(len(w)):
            density[i] = max((psa[i] / factor[i]) ** 2 - below, 0.0) / (w[i] * spread[i])
            below += density[i] * step[i]
        return density

    def _length(self) -> int:
        return 1 << int(np.ceil(np.log2(2 * self.points)))

    def _first(self, k: int, draw: int) -> np.ndarray:
        length = self._length()
        frequency = np.arange(length // 2 + 1) / (length * self.step)
        inside = (frequency >= 0.5 / self.longest) & (frequency <= min(1.5 / self.shortest, 0.45 / self.step))
        w = 2.0 * np.pi * frequency[inside]
        amplitude = np.sqrt(2.0 * self._density(w) * (w[1] - w[0]))
        transform = np.zeros(length // 2 + 1, dtype=complex)
        transform[inside] = 0.5 * length * amplitude * np.exp(1j * core.phases(self.seed + draw * 2**32, k, len(w)))
        return core.fourier_inverse(transform, length)[: self.points] * self._window()

    def _filtered(self, motion: np.ndarray, periods: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        length = self._length()
        frequency = np.arange(length // 2 + 1) / (length * self.step)
        factor = np.interp(np.log(np.maximum(frequency, 1e-9)), np.log(1.0 / periods[::-1]), ratio[::-1])
        return core.fourier_inverse(core.fourier(motion, length) * factor, length)[: self.points]

    def _level(self, motion: np.ndarray) -> np.ndarray:
        """Ends brought to zero over 2 % of the motion, velocity and displacement brought back near zero."""
        ends = max(2, self.points // 50)
        ramp = 0.5 - 0.5 * np.cos(np.pi * np.arange(ends) / ends)
        out = motion.copy()
        out[:ends] *= ramp
        out[-ends:] *= ramp[::-1]
        return processing.baseline(out, self.step, "quadratic")

    def _with_wavelets(self, motion: np.ndarray, periods: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        w = 2.0 * np.pi / periods
        wd = w * np.sqrt(1.0 - self.damping**2)
        t = np.arange(self.points) * self.step
        missing, mirrored = np.zeros(len(w)), np.zeros((len(w), self.points))
        for j, period in enumerate(periods):
            u, _ = core.oscillator(motion, self.step, period, self.damping)
            top = int(np.argmax(np.abs(u)))
            value = w[j] ** 2 * u[top]
            missing[j] = np.sign(value) * (wanted[j] - abs(value))
            before = t[top] - t[: top + 1]
            mirrored[j, : top + 1] = (
                -(w[j] ** 2) * np.exp(-self.damping * w[j] * before) * np.sin(wd[j] * before) / wd[j]
            )
        response = mirrored @ mirrored.T * self.step
        # neighbours are almost alike: a little damping of the least squares keeps the wavelets small
        scale = np.sqrt(np.diag(response))
        weight = response / np.outer(scale, scale)
        factor = np.linalg.solve(weight + 0.02 * np.eye(len(w)), missing / scale) / scale
        return motion + 0.7 * factor @ mirrored
