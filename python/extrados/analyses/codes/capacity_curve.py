"""Displacement demand on a capacity curve, and its displacement capacity by limit states.

The curve of base shear over control displacement becomes an oscillator of one degree of freedom (Fajfar 2000, Earthquake
Spectra 16): d* = d/Gamma, F* = F/Gamma, m* = sum m phi, Gamma = m*/sum m phi^2, with phi = 1 at the control displacement.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from extrados.analyses.sla.curve import Bilinear, bilinear, cut_at, drop_of
from extrados.schema.constants import GRAVITY

#: Pseudo-acceleration [m/s^2] over period [s] and damping ratio
Spectrum = Callable[[float, float], float]

#: Part of the greatest base shear at which the stiffness is taken: NTC 2018 7.8.1.6 for masonry, C7.3.4.2 in general
MASONRY, GENERAL = 0.7, 0.6
#: Damping ratio of the elastic spectrum
DAMPING = 0.05
#: Displacement capacity by limit state: of which displacement, and which part. NTC: C8.7.1.3.1; EN 1998-3 C.3 (verify clause);
#: NZSEE C2 (verify clause)
CAPACITY = {
    "SLC": ("ultimate", 1.0),
    "SLV": ("ultimate", 0.75),
    "SLD": ("yield", 1.0),
    "SLO": ("yield", 2.0 / 3.0),
    "NC": ("ultimate", 1.0),
    "SD": ("ultimate", 0.75),
    "DL": ("yield", 1.0),
    "ULS": ("ultimate", 1.0),
}
#: Greatest q* of existing masonry (C8.7.1.3.1)
GREATEST_Q = {"SLV": 3.0, "SLC": 4.0}
#: Part of the greatest base shear below which piers at their strength do not end SLD (C8.7.1.3.1)
NOT_BEFORE = 0.75
#: Periods at which the corner of a spectrum is looked for [s]
PERIODS = np.arange(0.01, 2.0, 0.005)
#: Site factor a of C_1, the least and so the safe one (ASCE 41-13 7.4.3.3.2, verify clause)
SITE = 60.0
#: Halvings of an interval, and doublings of its upper end
HALVINGS, DOUBLINGS = 60, 40


@dataclass(frozen=True)
class CapacityCurve:
    """A capacity curve and the masses that move with it.

    displacement: of the control point from the state under the constant loads, ascending from 0 (points) [m]; force: base
    shear (points) [N]; mass (nodes) [kg]; shape: phi at the masses (nodes), 1 at the control displacement. limits: control
    displacements [m] at which all piers of a storey of a wall are at their limit drift ("drift") or strength ("strength").
    """

    displacement: np.ndarray
    force: np.ndarray
    mass: np.ndarray
    shape: np.ndarray
    limits: Mapping[str, float] = field(default_factory=dict)

    @property
    def equivalent_mass(self) -> float:
        """m* = sum m phi [kg]."""
        return float(self.mass @ self.shape)

    @property
    def participation(self) -> float:
        """Gamma = m*/sum m phi^2."""
        return self.equivalent_mass / float(self.mass @ self.shape**2)

    @property
    def ultimate(self) -> float:
        """Displacement of collapse [m]: a drop of the base shear by 20 %, all piers of a storey of a wall at their limit
        drift, or the end of the curve."""
        drop = drop_of(self.displacement, self.force)
        return min(self.displacement[-1] if drop is None else drop, self.limits.get("drift", np.inf))

    @property
    def ended_by(self) -> Literal["drop", "drift", "end"]:
        """ "drop" or "drift", whichever is first; "end": the curve ends before either, the capacity is a lower bound."""
        if self.limits.get("drift", np.inf) <= self.ultimate:
            return "drift"
        return "end" if drop_of(self.displacement, self.force) is None else "drop"


@dataclass(frozen=True)
class Oscillator:
    """The equivalent oscillator: m* [kg], Gamma, and its elastic-plastic law in d* [m] and F* [N]."""

    mass: float
    participation: float
    law: Bilinear

    @property
    def period(self) -> float:
        """T* = 2 pi sqrt(m*/k*) [s]."""
        return 2.0 * np.pi * float(np.sqrt(self.mass / self.law.stiffness))


def oscillator_of(curve: CapacityCurve, secant: float = MASONRY) -> Oscillator | None:
    """The equivalent oscillator of a curve; None where the curve has no rising branch."""
    gamma = curve.participation
    law = bilinear(curve.displacement / gamma, curve.force / gamma, secant, curve.ultimate / gamma)
    return None if law is None else Oscillator(curve.equivalent_mass, gamma, law)


def corner_period(spectrum: Spectrum) -> float:
    """T_C [s]: 2 pi times the greatest pseudo-velocity over the greatest pseudo-acceleration, of periods up to 2 s. For a
    spectrum with a plateau followed by constant velocity this is the end of the plateau."""
    return corner_of(np.array([spectrum(float(t), DAMPING) for t in PERIODS]))


def corner_of(values: np.ndarray) -> float:
    """T_C [s] of pseudo-accelerations at PERIODS."""
    return float((values * PERIODS).max() / values.max())


def strength_ratio(oscillator: Oscillator, spectrum: Spectrum) -> float:
    """q* = S_e(T*) m*/F_y*."""
    return spectrum(oscillator.period, DAMPING) * oscillator.mass / oscillator.law.yield_load


def n2_displacement(oscillator: Oscillator, spectrum: Spectrum, corner: float) -> float:
    """Displacement demand d* [m] by the N2 method: NTC 2018 [C7.3.8], [C7.3.9]; EN 1998-1 Eqs B.8 to B.11. corner: T_C [s]."""
    period, ratio = oscillator.period, strength_ratio(oscillator, spectrum)
    elastic = spectrum(period, DAMPING) * (period / (2.0 * np.pi)) ** 2
    if period >= corner or ratio <= 1.0:
        return elastic
    return max(elastic / ratio * (1.0 + (ratio - 1.0) * corner / period), elastic)


def n2_factor(oscillator: Oscillator, spectrum: Spectrum, corner: float, capacity: float) -> float:
    """Factor on the spectrum at which the N2 demand reaches a capacity d* [m]: the inverse of `n2_displacement`."""
    ductility, period = capacity / oscillator.law.yield_displacement, oscillator.period
    carried = 1.0 + (ductility - 1.0) * period / corner if period < corner and ductility > 1.0 else ductility
    return carried / strength_ratio(oscillator, spectrum)


def annex_b_oscillator(curve: CapacityCurve, until: float) -> Oscillator | None:
    """The oscillator of EN 1998-1 Annex B (read in prEN 1998-1:2003, Eqs B.1 to B.6): F_y* the greatest force up to d_m*, d_y* = 2
    (d_m* - E_m*/F_y*).
    until: d_m* [m]. None where that has no elastic part."""
    gamma = curve.participation
    d, p = cut_at(curve.displacement / gamma, curve.force / gamma, until)
    force = float(p.max())
    start = 2.0 * (until - float(np.trapezoid(p, d)) / force) if force > 0.0 else 0.0
    if not start > 0.0:
        return None
    return Oscillator(curve.equivalent_mass, gamma, Bilinear(force / start, force, start, until))


def annex_b(curve: CapacityCurve, spectrum: Spectrum, corner: float) -> tuple[Oscillator, float] | None:
    """Oscillator and displacement demand d* [m] of EN 1998-1 Annex B with the iteration that it allows: d_m* is the demand
    itself, at most the displacement of collapse, from which the iteration starts."""
    end = curve.ultimate / curve.participation
    until, found = end, None
    for _ in range(HALVINGS):
        oscillator = annex_b_oscillator(curve, until)
        if oscillator is None:
            return found
        demand = n2_displacement(oscillator, spectrum, corner)
        found = oscillator, demand
        if abs(min(demand, end) - until) <= 1e-12 * end:
            break
        until = min(demand, end)
    return found


def capacity_spectrum_factors(curve: CapacityCurve, spectrum: Spectrum, quality: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements d* [m] up to collapse, and the factor on the spectrum whose performance point each is.

    The damping is 5 % and quality times that of the elastic-plastic loop of equal area (C7.3.4.2, ATC-40): 63.7 quality
    (F_y d - F d_y)/(F d), where equal areas A make F_y d - F d_y = 2 A - F d.
    """
    gamma = curve.participation
    end = curve.ultimate / gamma
    d = end * np.arange(1, 2001) / 2000.0
    known, force = cut_at(curve.displacement / gamma, curve.force / gamma, end)
    p = np.interp(d, known, force)
    area = np.append(0.0, np.cumsum(0.5 * np.diff(known) * (force[1:] + force[:-1])))
    # trapezoids between the points of the curve, so that the area is exact at every displacement
    k = np.clip(np.searchsorted(known, d, side="right") - 1, 0, len(known) - 2)
    done = area[k] + 0.5 * (d - known[k]) * (force[k] + p)
    damping = DAMPING + 0.637 * quality * np.maximum(2.0 * done - p * d, 0.0) / (p * d)
    period = 2.0 * np.pi * np.sqrt(curve.equivalent_mass * d / p)
    asked = [spectrum(float(t), float(x)) * (t / (2.0 * np.pi)) ** 2 for t, x in zip(period, damping, strict=True)]
    return d, d / np.array(asked)


def capacity_spectrum_displacement(curve: CapacityCurve, spectrum: Spectrum, quality: float) -> float | None:
    """Displacement demand d* [m] by the capacity spectrum: the first performance point; None without one before
    collapse."""
    d, factor = capacity_spectrum_factors(curve, spectrum, quality)
    reached = np.flatnonzero(factor >= 1.0)
    if not len(reached):
        return None
    k = int(reached[0])
    if k == 0:
        return float(d[0] / factor[0])
    return float(np.interp(1.0, factor[k - 1 : k + 1], d[k - 1 : k + 1]))


def coefficient_displacement(oscillator: Oscillator, spectrum: Spectrum, weight: float) -> float:
    """Target displacement of the control point [m] by the coefficient method of ASCE 41-13 Eq. 7-28 (verify clause), C_0 =
    Gamma, C_m = 1, a = 60. weight: of the building [N], which makes mu_strength = S_a W/(V_y g)."""
    period, felt = oscillator.period, spectrum(oscillator.period, DAMPING)
    yielded = oscillator.law.yield_load * oscillator.participation
    ratio = max(felt * weight / GRAVITY / yielded, 1.0)
    c1 = 1.0 if period > 1.0 else 1.0 + (ratio - 1.0) / (SITE * max(period, 0.2) ** 2)
    c2 = 1.0 if period > 0.7 else 1.0 + ((ratio - 1.0) / period) ** 2 / 800.0
    return oscillator.participation * c1 * c2 * felt * (period / (2.0 * np.pi)) ** 2


def capacity_of(curve: CapacityCurve, oscillator: Oscillator, state: str) -> float:
    """Displacement capacity of the control point at a limit state [m], of CAPACITY."""
    of, part = CAPACITY[state]
    if of == "ultimate":
        return part * curve.ultimate
    start = oscillator.participation * oscillator.law.yield_displacement
    strength = curve.limits.get("strength")
    if strength is not None:
        high = np.flatnonzero(curve.force >= NOT_BEFORE * curve.force.max())[0]
        start = min(start, max(strength, float(curve.displacement[high])))
    return part * min(start, curve.ultimate)


def greatest_factor(demand: Callable[[float], float | None], capacity: float) -> float:
    """Factor on the action at which a demand that grows with it reaches the capacity, by bisection; a demand of None is
    beyond collapse."""

    def within(factor: float) -> bool:
        value = demand(factor)
        return value is not None and value <= capacity

    high = 1.0
    for _ in range(DOUBLINGS):
        if not within(high):
            break
        high *= 2.0
    low = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if within(middle) else (low, middle)
    return low


def return_period(acceleration: float, known: Mapping[float, float]) -> float | None:
    """Return period [years] of an acceleration [m/s^2] by straight lines of the logarithms between those of the limit states;
    None outside them. known: return period [years] -> acceleration [m/s^2]."""
    points = sorted((a, years) for years, a in known.items())
    if len(points) < 2 or not points[0][0] <= acceleration <= points[-1][0]:
        return None
    a, years = (np.log(np.array(column)) for column in zip(*points, strict=True))
    return float(np.exp(np.interp(np.log(acceleration), a, years)))
