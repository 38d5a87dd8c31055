"""What an event curve says: which events are states, envelope, peak, bilinear idealisation."""

from dataclasses import dataclass

import numpy as np

from extrados.core import lists
from extrados.core import sla as core
from extrados.results.sla import DROP

#: Displacements at which an envelope is given, and at most as many points: with the peak and the start
BINS = 400
MOST_ENVELOPE = BINS + 2
#: A peak was passed where the last tenth of the envelope's way lies this much below it
LAST, FALLEN = 0.1, 0.02
#: Displacements are taken as small: part of the structure's greatest extent beyond which an event is no state
FAR = 0.1
#: Times the peak load beyond which an event is no state
FAR_ABOVE = 10.0
#: Of the way to the peak: so much further a load must stay below a fraction of the peak to have fallen below it; what lies
#: this much behind the furthest state is no part of the envelope (fortran/sla/events.f90 has the same)
FURTHER = 0.1
#: Rounding of a load that ends at a part of its peak
ROUNDING = 1e-9
#: How a run ends whose load fell below `stop_fraction` of its peak, one whose displacements are no longer small, and one whose constant
#: loads are no longer carried
FELL, TOO_FAR, AXIAL = (core.STOPS[lists.number("sla_stop", name)] for name in ("fraction", "far", "axial"))
#: How a run ends in which a floor has left its seat, or has moved as far along its wall
SLID_OFF, SLID_ALONG = "a floor has slid off its seat", "a floor has slid along its walls by the length of its seat"


@dataclass(frozen=True)
class Bilinear:
    """Elastic-plastic idealisation of equal area up to the ultimate displacement; stiffness secant at a part of the peak."""

    stiffness: float  # [N/m]
    yield_load: float  # [N]
    yield_displacement: float  # [m]
    ultimate_displacement: float  # [m]

    @property
    def ductility(self) -> float:
        """Ultimate over yield displacement."""
        return self.ultimate_displacement / self.yield_displacement


def states(
    equilibrium: np.ndarray, load: np.ndarray, way: np.ndarray, compliance: np.ndarray, most_way: float, most_compliance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Which events are states of the structure, and which lie out of reach (both (events), bool).

    A state is in equilibrium (bool) on a structure that is no mechanism (compliance <= most_compliance), has gone no
    further than displacements that are small (way <= most_way [m]), and carries at most FAR_ABOVE times the peak load
    of the states, to either sense. Out of reach is what exceeds a bound on the way or the load, in equilibrium or not:
    results count it, figures do not draw it.
    """
    near = way <= most_way
    found = equilibrium & near & (compliance <= most_compliance)
    most = FAR_ABOVE * float(load[found].max(initial=0.0)) if found.any() else np.inf
    below = np.abs(load) <= (most if most > 0.0 else np.inf)
    return found & below, ~(near & below)


def has_fallen(displacement: np.ndarray, load: np.ndarray, start: float, fraction: float) -> bool:
    """Has the load fallen below a fraction of its peak: does it stay below it over a further tenth of the way to the peak?

    As the event loop judges at each state (fortran/sla/events.f90).
    """
    peak = int(load.argmax())
    way = float(np.copysign(1.0, displacement[peak] - start)) * (displacement - start)
    last = int(np.flatnonzero(load >= fraction * load[peak])[-1])  # not below it
    ahead = np.append(0.0, np.maximum.accumulate(np.maximum(way, 0.0)))[:-1]
    below = np.flatnonzero(way[last + 1 :] > ahead[last + 1 :]) + last + 1
    return bool(len(below) and way[-1] >= way[below[0]] + FURTHER * abs(way[peak]))


def envelope(displacement: np.ndarray, load: np.ndarray, start: float = 0.0, bins: int = BINS) -> tuple[np.ndarray, np.ndarray]:
    """Monotone envelope of the polyline through (start, 0) and states: at each of `bins` displacements the greatest load on
    it. What comes back after the peak, by more than FURTHER of the way to the peak, has no part in it.

    Displacements count positive in the sense they have, from the start, at the peak; states of the other sense, of the
    displacement or of the load, have no part either. `start` is the displacement of the constant loads alone.
    """
    if not len(load) or not load.max() > 0.0:
        return np.full(1, start), np.zeros(1)
    turn = float(np.copysign(1.0, displacement[load.argmax()] - start))
    along = turn * (displacement - start)
    same = (along >= 0.0) & (load >= 0.0)
    d = np.append(0.0, along[same])
    p = np.append(0.0, load[same])
    if not d.max() > 0.0:
        return np.full(1, turn * start), np.zeros(1)
    peak = int(p.argmax())
    behind = np.maximum.accumulate(d)[:-1] - FURTHER * d[peak]
    behind[:peak] = -np.inf
    # The peak and the end must be on the envelope, whatever the bins
    grid = np.union1d(np.linspace(0.0, d.max(), bins + 1), d[peak])
    best = np.full(len(grid), -np.inf)
    low, high = np.minimum(d[:-1], d[1:]), np.maximum(d[:-1], d[1:])
    first, last = np.searchsorted(grid, low, "left"), np.searchsorted(grid, high, "right")
    count = last - first
    segment = np.repeat(np.arange(len(low)), count)
    at = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    span = d[segment + 1] - d[segment]
    share = np.where(span != 0.0, (grid[at] - d[segment]) / np.where(span != 0.0, span, 1.0), 0.0)
    value = np.where(grid[at] >= behind[segment], p[segment] + share * (p[segment + 1] - p[segment]), -np.inf)
    np.maximum.at(best, at, value)
    kept = np.isfinite(best)
    return grid[kept] + turn * start, best[kept]


def fallen(d: np.ndarray, p: np.ndarray) -> bool:
    """Does an envelope end below its peak for good, not only by a tooth?"""
    end = p[np.abs(d - d[0]) >= (1.0 - LAST) * abs(d[-1] - d[0])]
    return bool(end.max() < (1.0 - FALLEN) * p.max())


def drop_of(d: np.ndarray, p: np.ndarray) -> float | None:
    """Displacement at which an envelope has dropped to DROP times its peak; None where it does not."""
    peak = int(p.argmax())
    below = np.flatnonzero(p[peak:] <= DROP * p[peak] * (1.0 + ROUNDING))
    if not len(below):
        return None
    i = peak + int(below[0])
    share = (p[i - 1] - DROP * p[peak]) / (p[i - 1] - p[i])
    return float(d[i - 1] + min(share, 1.0) * (d[i] - d[i - 1]))


def cut_at(d: np.ndarray, p: np.ndarray, end: float) -> tuple[np.ndarray, np.ndarray]:
    """An envelope up to a displacement between its ends."""
    inside = d < end
    return np.append(d[inside], end), np.append(p[inside], np.interp(end, d, p))


def bilinear(d: np.ndarray, p: np.ndarray, secant: float = 0.6, ultimate: float | None = None) -> Bilinear | None:
    """Idealisation of an envelope that starts at the origin; None where it has no rising branch.

    secant: part of the peak at which the stiffness is taken; ultimate: displacement up to which the areas are equal [m],
    by default where the load has fallen to DROP times its peak, or the last.
    """
    if ultimate is None:
        drop = drop_of(d, p)
        ultimate = float(d[-1]) if drop is None else drop
    d, p = cut_at(d, p, ultimate)
    peak = int(p.argmax())
    if peak == 0 or not p[peak] > 0.0:
        return None
    rising = np.maximum.accumulate(p[: peak + 1])
    at = float(np.interp(secant * p[peak], rising, d[: peak + 1]))
    if not at > 0.0:
        return None
    stiffness = secant * p[peak] / at
    area = float(np.trapezoid(p, d))
    inside = ultimate**2 - 2.0 * area / stiffness
    yield_load = stiffness * (ultimate - np.sqrt(max(inside, 0.0)))
    return Bilinear(float(stiffness), float(yield_load), float(yield_load / stiffness), ultimate)
