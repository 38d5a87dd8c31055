"""What an event curve says: envelope, peak, bilinear idealisation."""

from dataclasses import dataclass

import numpy as np


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
        return self.ultimate_displacement / self.yield_displacement


def envelope(displacement: np.ndarray, load: np.ndarray, bins: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Monotone envelope of equilibrium points: the greatest load in each of `bins` steps of displacement.

    Displacements count positive in the sense they have at the peak.
    """
    if not len(load):
        return np.zeros(1), np.zeros(1)
    displacement = np.copysign(1.0, displacement[load.argmax()]) * displacement
    span = displacement.max()
    if not span > 0.0:
        return np.zeros(1), np.zeros(1)
    forward = displacement > 0.0
    d, p = displacement[forward], load[forward]
    number = np.minimum((d / span * bins).astype(int), bins - 1)
    order = np.lexsort((-p, number))
    _, first = np.unique(number[order], return_index=True)
    best = np.sort(order[first])
    best = best[np.argsort(d[best], kind="stable")]
    return np.append(0.0, d[best]), np.append(0.0, p[best])


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
