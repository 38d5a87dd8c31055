"""What an event curve says: envelope, peak, bilinear idealisation."""

from dataclasses import dataclass

import numpy as np

#: Displacements at which an envelope is given, and at most as many points: with the peak and the start
BINS = 400
MOST_ENVELOPE = BINS + 2
#: A peak was passed where the last tenth of the envelope's way lies this much below it
LAST, FALLEN = 0.1, 0.02


@dataclass(frozen=True)
class Bilinear:
    """Elastic-plastic idealisation of equal area up to the ultimate displacement (load down to 80 % of the peak,
    or the last); stiffness secant at 60 % of the peak."""

    stiffness: float  # [N/m]
    yield_load: float  # [N]
    yield_displacement: float  # [m]
    ultimate_displacement: float  # [m]

    @property
    def ductility(self) -> float:
        """Ultimate over yield displacement."""
        return self.ultimate_displacement / self.yield_displacement


def envelope(
    displacement: np.ndarray, load: np.ndarray, start: float = 0.0, bins: int = BINS
) -> tuple[np.ndarray, np.ndarray]:
    """Monotone envelope of the polyline through (start, 0) and the equilibrium points: at each of `bins`
    displacements the greatest load on it. Displacements count positive in the sense they have, from the start, at
    the peak; `start` is the displacement of the constant loads alone.
    """
    if not len(load):
        return np.full(1, start), np.zeros(1)
    turn = float(np.copysign(1.0, displacement[load.argmax()] - start))
    d = np.append(0.0, turn * (displacement - start))
    p = np.append(0.0, load)
    if not d.max() > 0.0:
        return np.full(1, turn * start), np.zeros(1)
    # The peak and the end must be on the envelope, whatever the bins
    grid = np.union1d(np.linspace(0.0, d.max(), bins + 1), np.maximum(d[p.argmax()], 0.0))
    best = np.full(len(grid), -np.inf)
    low, high = np.minimum(d[:-1], d[1:]), np.maximum(d[:-1], d[1:])
    first, last = np.searchsorted(grid, low, "left"), np.searchsorted(grid, high, "right")
    count = last - first
    segment = np.repeat(np.arange(len(low)), count)
    at = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    span = d[segment + 1] - d[segment]
    share = np.where(span != 0.0, (grid[at] - d[segment]) / np.where(span != 0.0, span, 1.0), 0.0)
    np.maximum.at(best, at, p[segment] + share * (p[segment + 1] - p[segment]))
    kept = np.isfinite(best)
    return grid[kept] + turn * start, best[kept]


def fallen(d: np.ndarray, p: np.ndarray) -> bool:
    """Does an envelope end below its peak for good, not only by a tooth?"""
    end = p[np.abs(d - d[0]) >= (1.0 - LAST) * abs(d[-1] - d[0])]
    return bool(end.max() < (1.0 - FALLEN) * p.max())


def bilinear(d: np.ndarray, p: np.ndarray) -> Bilinear | None:
    """Idealisation of an envelope that starts at the origin; None where it has no rising branch."""
    peak = int(p.argmax())
    if peak == 0 or not p[peak] > 0.0:
        return None
    rising = np.maximum.accumulate(p[: peak + 1])
    at = float(np.interp(0.6 * p[peak], rising, d[: peak + 1]))
    if not at > 0.0:
        return None
    stiffness = 0.6 * p[peak] / at
    below = np.flatnonzero(p[peak:] < 0.8 * p[peak])
    if len(below):
        i = peak + int(below[0])
        share = (p[i - 1] - 0.8 * p[peak]) / (p[i - 1] - p[i])
        ultimate = float(d[i - 1] + share * (d[i] - d[i - 1]))
        d, p = np.append(d[:i], ultimate), np.append(p[:i], 0.8 * p[peak])
    else:
        ultimate = float(d[-1])
    area = float(np.trapezoid(p, d))
    inside = ultimate**2 - 2.0 * area / stiffness
    yield_load = stiffness * (ultimate - np.sqrt(max(inside, 0.0)))
    return Bilinear(float(stiffness), float(yield_load), float(yield_load / stiffness), ultimate)
