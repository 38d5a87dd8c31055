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
from extrados.core.ground import Ground
from extrados.motions import processing
from extrados.motions.code_spectra import Spectrum
from extrados.motions.generated import envelope_parameters

_COARSE_ROUNDS, _FINE_ROUNDS = 12, 40
_DRAWS = 5  # sets of phases tried for one motion
_PER_DAMPING = 3.0  # matched periods per decade are this over the damping: resonance peaks are that narrow


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
    known_to: float = np.inf  # longest period at which the target may be asked [s]

    @property
    def points(self) -> int:
        """Samples of a motion."""
        return round(self.duration / self.step) + 1

    def _periods(self, per_decade: int) -> np.ndarray:
        return np.geomspace(self.shortest, self.longest, int(per_decade * np.log10(self.longest / self.shortest)) + 2)

    @property
    def _per_decade(self) -> int:
        return round(_PER_DAMPING / min(self.damping, 0.05))

    def _wide_periods(self) -> np.ndarray:
        """The band and as much again beyond its long end, so that no strong long waves are left there."""
        step = 10.0 ** (1.0 / self._per_decade)
        beyond = [t for t in self.longest * step ** np.arange(1.0, 0.4 * self._per_decade) if t <= self.known_to]
        return np.concatenate([self._periods(self._per_decade), beyond])

    def motion(self, k: int) -> np.ndarray:
        """Motion k (points) [m/s^2]; NotMatched where no draw of phases comes within the tolerance."""
        misfits = []
        for draw in range(_DRAWS):
            motion = self._matched(k, draw)
            misfits.append(self.misfit(motion))
            if misfits[-1] <= self.tolerance:
                return motion
        raise NotMatched(
            f"motion {k + 1} of seed {self.seed} still differs from its target spectrum by {100 * min(misfits):.0f} "
            f"% after {_DRAWS} attempts. Increase `tolerance`, use a narrower band, or lengthen the motion"
        )

    def _matched(self, k: int, draw: int) -> np.ndarray:
        periods, between = self._wide_periods(), self._periods(8 * self._per_decade)
        wanted = self.target(periods)
        motion = best = self._level(self._first(k, draw))
        least = np.inf
        for _ in range(_COARSE_ROUNDS):
            psa = core.response_spectra(motion, self.step, periods, [self.damping]).psa[0]
            off = float(np.max(np.abs(psa / wanted - 1.0)))
            if off < least:
                best, least = motion, off
            motion = self._level(self._filtered(motion, periods, wanted / psa))
        motion, trail = best, []
        for _ in range(_FINE_ROUNDS):
            off = self.misfit(motion, between)
            trail.append(off)
            if off <= min(trail):
                best = motion
            # done, or no better than eight rounds ago: another draw is cheaper
            if off <= 0.95 * self.tolerance or (len(trail) > 8 and min(trail[-8:]) > 0.95 * min(trail[:-8])):
                break
            motion = self._level(self._with_wavelets(motion, periods, wanted))
        return best

    def motions(self, count: int, first: int = 0) -> Iterator[np.ndarray]:
        """Motions first .. first + count - 1, one at a time."""
        for k in range(first, first + count):
            yield self.motion(k)

    def ground(self, k: int) -> Ground:
        """Motion k as the rocking core takes it."""
        return Ground(samples=self.motion(k)[None, :], step=self.step)

    def misfit(self, motion: np.ndarray, periods: np.ndarray | None = None) -> float:
        """Largest relative deviation of the spectrum from the target over the band."""
        periods = self._periods(8 * self._per_decade) if periods is None else periods
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
        psa = self.target(np.clip(2.0 * np.pi / w, 0.0, min(2.5 * self.longest, max(self.known_to, self.longest))))
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
        inside = (frequency >= 0.4 / self.longest) & (frequency <= min(1.5 / self.shortest, 0.45 / self.step))
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
        """Waves far longer than the band taken out, ends faded over 2 % of the motion, at rest at the end."""
        long = self._length()
        frequency = np.arange(long // 2 + 1) / (long * self.step) * self.longest
        kept = 0.5 - 0.5 * np.cos(np.pi * np.clip((frequency - 0.15) / 0.2, 0.0, 1.0))
        out = core.fourier_inverse(core.fourier(motion, long) * kept, long)[: self.points]
        ends = max(2, self.points // 50)
        ramp = 0.5 - 0.5 * np.cos(np.pi * np.arange(ends) / ends)
        out[:ends] *= ramp
        out[-ends:] *= ramp[::-1]
        return processing.at_rest(out, self.step)

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
            mirrored[j, : top + 1] = -(w[j] ** 2) * np.exp(-self.damping * w[j] * before) * np.sin(wd[j] * before) / wd[j]
        response = mirrored @ mirrored.T * self.step
        # neighbours are almost alike: a little damping of the least squares keeps the wavelets small
        scale = np.sqrt(np.diag(response))
        weight = response / np.outer(scale, scale)
        factor = np.linalg.solve(weight + 0.02 * np.eye(len(w)), missing / scale) / scale
        return motion + 0.7 * factor @ mirrored
