"""Seismic hazard curves, and the annual rate of what they bring about."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

#: Gauss points in each piece of the integral, and the greatest length of a piece in ln(intensity): a curve of the
#: dispersion 0.05 is then integrated to ten digits
POINTS, PIECE = 8, 0.02
#: How far below its first point the curve is continued to see what it leaves out, as a factor on the intensity
BELOW = 1e4

#: Probability (..., x) that an intensity brings something about
Probability = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class HazardCurve:
    """Mean annual rate [1/year] at which each intensity is exceeded; straight lines between the points of the
    logarithms. Intensities ascend, rates descend."""

    intensity: np.ndarray
    rate: np.ndarray

    def at(self, x: np.ndarray) -> np.ndarray:
        """Rate of exceedance of x; NaN outside the curve."""
        found = np.interp(np.log(x), np.log(self.intensity), np.log(self.rate), left=np.nan, right=np.nan)
        return np.exp(found)

    def density(self, x: np.ndarray) -> np.ndarray:
        """-d rate / d ln x, the rate of intensities by their logarithm [1/year]; the last slope holds beyond the curve."""
        slope = -np.diff(np.log(self.rate)) / np.diff(np.log(self.intensity))
        piece = np.clip(np.searchsorted(self.intensity, x, side="right") - 1, 0, len(slope) - 1)
        return slope[piece] * self.rate[piece] * (x / self.intensity[piece]) ** -slope[piece]

    def rate_of(self, probability: Probability) -> np.ndarray:
        """Annual rate of an event of that probability: the integral of P(x) |d rate(x)| [1/year] (Cornell and Krawinkler
        2000, PEER Center News 3(2)). Intensities above the last point count with the probability there."""
        return self._integral(probability, self.intensity) + self.rate[-1] * probability(self.intensity[-1:])[..., 0]

    def left_out(self, probability: Probability) -> np.ndarray:
        """What `rate_of` misses beyond the ends of the curve [1/year]: at most what intensities above its last point can
        add, and what those below its first would add were the first slope to go on."""
        low = self._integral(probability, np.array([self.intensity[0] / BELOW, self.intensity[0]]))
        return low + self.rate[-1] * (1.0 - probability(self.intensity[-1:])[..., 0])

    def _integral(self, probability: Probability, ends: np.ndarray) -> np.ndarray:
        """Integral of P over the density between the ends, none of whose intervals crosses a corner of the curve."""
        pieces = [np.linspace(a, b, int(np.ceil((b - a) / PIECE)) + 1) for a, b in zip(np.log(ends[:-1]), np.log(ends[1:]), strict=True)]
        start = np.concatenate([p[:-1] for p in pieces])
        length = np.concatenate([np.diff(p) for p in pieces])
        place, weight = np.polynomial.legendre.leggauss(POINTS)
        x = np.exp(start[:, None] + 0.5 * length[:, None] * (place + 1.0)).ravel()
        share = (0.5 * length[:, None] * weight).ravel()
        return probability(x) @ (share * self.density(x))
