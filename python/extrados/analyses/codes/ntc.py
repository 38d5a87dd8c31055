"""Local mechanisms by NTC 2018 with Circolare 7/2019: the checks of C8.7.1.2.1, and the floor spectrum of C7.2.3."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.codes.code_rules import Line
from extrados.motions.code_spectra import damping_factor
from extrados.schema.constants import GRAVITY

#: Pseudo-acceleration [m/s^2] over period [s] and damping ratio
Spectrum = Callable[[float, float], float]

#: Of the displacement d_0 at which the capacity vanishes: d_SLV and d_SLC (C8.7.1.2.1.6)
SLV, SLC = 0.4, 0.6
#: T_SLV = 1.68 pi sqrt(d_SLV/a(d_SLV)) [C8.7.1.10], T_SLC = 1.56 pi sqrt(d_SLC/a(d_SLC)) [C8.7.1.11], and the damping of the
#: mechanism in each (C8.7.1.2.1.8)
PERIOD, DAMPING = 1.68, 0.08
COLLAPSE_PERIOD, COLLAPSE_DAMPING = 1.56, 0.10
#: Of the floor spectrum: a and b between which it is greatest, and the damping of the building [%]. 1.1 xi^-0.5 is how many times a
#: part of 5 % that sways with the building feels its acceleration (C7.2.3). The text gives xi in percent, as sqrt(1 + 0.0004 xi^2)
#: needs it; in the former it can only be the ratio, for 1.1/sqrt(5) would weaken what the text says is amplified (Table C7.2.II: 5 times).
A, B, BUILDING_DAMPING = 0.8, 1.1, 5.0
#: FC of the knowledge level LC1
LC1 = 1.35
#: Periods up to T_SLV at which the demand is looked for
GRID = 60


def equivalent_period(a0: float, d0: float, part: float = SLV, factor: float = PERIOD) -> float:
    """T_SLV [s] on the straight capacity curve from a0 [m/s^2] to 0 at d0 [m]; T_SLC by its own part of d0 and factor."""
    return float(factor * np.pi * np.sqrt(part * d0 / (a0 * (1.0 - part))))


def displacement(spectrum: Spectrum, period: float, damping: float = DAMPING, peak: float | None = None) -> float:
    """Spectral displacement [m]: the greatest up to the period, since that of a record may fall again (C8.7.1.2.1.8).

    peak: a period [s] at which a floor spectrum begins to fall [C8.7.1.12].
    """
    periods = (period * np.arange(1, GRID + 1) / GRID).tolist()
    if peak is not None and peak < period:
        periods.append(peak)
    return max(spectrum(t, damping) * (t / (2.0 * np.pi)) ** 2 for t in periods)


@dataclass(frozen=True)
class FloorMode:
    """A mode of the building at the height of the part: T_k [s], gamma_k psi_k(z), damping ratio xi_k."""

    period: float
    part: float
    damping: float = 0.01 * BUILDING_DAMPING

    def acceleration(self, ground: Spectrum) -> float:
        """a_Z,k(z) [m/s^2], [C7.2.7]."""
        xi = 100.0 * self.damping
        return ground(self.period, self.damping) * abs(self.part) * float(np.sqrt(1.0 + 4e-4 * xi**2))

    def spectrum(self, ground: Spectrum, period: float, damping: float) -> float:
        """S_eZ,k(T, xi, z) [m/s^2], [C7.2.6]."""
        # the text gives xi_k in percent; only the ratio amplifies, see A and B
        amplified = 1.1 / float(np.sqrt(self.damping)) * damping_factor(damping)
        top, rise = amplified * self.acceleration(ground), amplified - 1.0
        if period < A * self.period:
            return float(top / (1.0 + rise * (1.0 - period / (A * self.period)) ** 1.6))
        if period >= B * self.period:
            return float(top / (1.0 + rise * (period / (B * self.period) - 1.0) ** 1.2))
        return float(top)


@dataclass(frozen=True)
class Floor:
    """The spectrum at a height of a building by its modes, that of the longest period first: square root of the sum of squares [C7.2.5]."""

    ground: Spectrum
    modes: tuple[FloorMode, ...]

    @property
    def first(self) -> float:
        """T_1 [s]."""
        return self.modes[0].period

    @property
    def acceleration(self) -> float:
        """a_Z(z) [m/s^2]."""
        return float(np.sqrt(sum(m.acceleration(self.ground) ** 2 for m in self.modes)))

    def __call__(self, period: float, damping: float) -> float:
        """S_eZ(T, xi, z) [m/s^2], from T_1 on not below that of the ground [C7.2.5]."""
        found = float(np.sqrt(sum(m.spectrum(self.ground, period, damping) ** 2 for m in self.modes)))
        return found if period <= self.first else max(found, self.ground(period, damping))


def first_period(building: float) -> float:
    """T_1 = 0.05 H^0.75 [s] of a building so high [m] (EN 1998-1 Eq. 4.6)."""
    return 0.05 * building**0.75


def floor(ground: Spectrum, height: float, building: float, storeys: int, period: float | None, damping: float = 0.05) -> Floor:
    """Of a place at `height` in a building so high [m], with so many storeys: psi_1 = z/H, gamma_1 = 3 n/(2 n + 1)
    [C7.2.10]; T_1 = 0.05 H^0.75 where none is known."""
    part = height / building * 3.0 * storeys / (2.0 * storeys + 1.0)
    return Floor(ground, (FloorMode(period or first_period(building), part, damping),))


#: T_0 = kappa lambda L sqrt(w/(E g)) [C8.7.1.7]: kappa of a cantilever
CANTILEVER = 6.2


def own_period(height: float, thickness: float, density: float, young: float) -> float:
    """T_0 [s] of a free part, a cantilever of height L and slenderness lambda = L/t [C8.7.1.7]; sizes [m], kg/m^3, Pa."""
    return CANTILEVER * height / thickness * height * float(np.sqrt(density / young))


#: Friction of teeth of masonry, and the share of the force by which every course holds [C8.7.1.2]
TOOTH_FRICTION, TOOTH_SHARE = 0.577, 0.8


def toothed_edge(courses: int, unit_height: float, overlap: float, thickness: float, weight: float) -> tuple[float, float]:
    """Friction F by which a toothed edge holds a wall, F = 0.4 n (n + 1) phi mu l^2 t_s w with phi = h_b/l [C8.7.1.2], and how far [m]
    below the top of the teeth it acts: every course holds by the weight of those above, so that it is two thirds of the depth.

    Courses n of height h_b and overlap l in a side wall of thickness t_s [m]; weight w per volume: F has its force.
    """
    n = courses
    force = 0.5 * TOOTH_SHARE * n * (n + 1) * unit_height / overlap * TOOTH_FRICTION * overlap**2 * thickness * weight
    return force, unit_height * (2 * n + 1) / 3.0


def below_lc1(fc: float) -> str:
    """What is wrong with a lesser FC where the multiplier takes no strength into account (C8.7.1.2.1.3)."""
    return (
        f"FC is {fc:g}, but the multiplier neglects crushing of the masonry: C8.7.1.2.1.3 then requires FC {LC1:g} "
        f"(LC1). Give `compressive_strength`, or FC {LC1:g}."
    )


#: The code whose checks these are
CODE = "NTC 2018"
#: What the kinematic analysis of C8.7.1.2.1 is for
SCOPE = "part of an existing masonry building, or block, that moves as rigid bodies without disintegrating; any restraint; any height"


@dataclass(frozen=True)
class Capacities:
    """What the checks compare: a0 = alpha_0 g/(e* FC) [m/s^2]; d0 [m], where the capacity vanishes, None where it does not; alone: a0
    of the curve to d0 without ties that may not last to collapse; note: on what they rest."""

    a0: float
    d0: float | None
    alone: float
    note: str


@dataclass(frozen=True)
class Place:
    """Where the mechanism stands. raised: above the ground, where the demand is that of the floor, by `at_height`, and not known where
    that is None; shaken: whether the action itself is the motion of its floor; free: whether it is a part that vibrates at its own
    period, `period` [s], None: not known [C8.7.1.9]."""

    raised: bool = False
    at_height: Floor | None = None
    free: bool = False
    period: float | None = None
    shaken: bool = False

    def acceleration(self, spectrum: Spectrum | None, peak: float | None) -> float | None:
        """Demand on a rigid part [m/s^2], or on a free one at its own period; None where it is not known."""
        if self.free:
            felt = self.at_height if self.raised else spectrum
            return None if felt is None or self.period is None else felt(self.period, 0.05)
        if not self.raised:
            return peak
        # near the ground the first mode alone would ask for less than the ground itself does
        return None if self.at_height is None else max(self.at_height.acceleration, peak or 0.0)


def checks(found: Capacities, q: float, state: str, peak: float | None, spectrum: Spectrum | None, place: Place) -> list[Line]:
    """The checks of a limit state.

    SLD: the mechanism does not start. SLV: it keeps within d_SLV or does not start at all, since a_g,SLV is not taken below a_g,SLD
    (C8.7.1.2.1.8); the factor q is for mechanisms of which only the multiplier is known (C8.7.1.2.1.7). SLC: it keeps within d_SLC.

    peak: a_g S [m/s^2].
    """
    if state == "SLC":
        return [] if found.d0 is None else [_nonlinear(found, state, spectrum, place)]
    where, quantity = ("at height z", "a_Z") if place.raised else ("at the ground", "a_g S")
    if place.shaken:
        where, quantity = "on its floor", "peak"
    if place.free:
        quantity = "S_eZ(T_0)"
    felt = place.acceleration(spectrum, peak)
    demand = None if felt is None else felt / GRAVITY
    unknown = (
        (
            "a part that vibrates freely responds at its own period T_0, and its demand is S_eZ(T_0) "
            "[C8.7.1.9]. Give `young` of [material], or `period`"
        )
        if place.free and place.period is None
        else ""
    )
    note = found.note if place.period is None or not place.free else f"{found.note}, T_0 {place.period:.3g} s"
    starts = (
        "[C8.7.1.9]: alpha_0 g/(e* FC) >= S_eZ(T_0)" if place.free else "[C8.7.1.8]: alpha_0 g/(e* FC) >= a_Z; at the ground a_Z = a_g S"
    )
    common: dict[str, Any] = {"scope": f"{SCOPE}; rigid until it starts", "state": state}

    def activation(name: str, **more: Any) -> Line:
        source = f"NTC 2018, Circ. 7/2019 {starts}: the mechanism does not start"
        return Line(name, quantity, found.a0 / GRAVITY, demand, "g", source, note, CODE, **common, barred=unknown, **more)

    if state == "SLD":
        return [activation(f"NTC activation at SLD ({where})")]
    lines = []
    compared = False
    if found.d0 is not None:
        lines.append(_nonlinear(found, state, spectrum, place))
        compared = lines[0].demand is not None
    if compared:
        lines.append(activation(f"NTC activation ({where})", alternative=state))
    known = (
        ("the displacement is checked instead: q applies only if the multiplier is the only known result of the mechanism (C8.7.1.2.1.7)")
        if compared
        else ""
    )
    lines.append(
        Line(
            f"NTC linear ({where})",
            quantity,
            q * found.a0 / GRAVITY,
            demand,
            "g",
            "NTC 2018, Circ. 7/2019 C8.7.1.2.1.7: q alpha_0 g/(e* FC) >= a_Z (at the ground a_Z = a_g S); [C8.7.1.8], [C8.7.1.9], [C7.2.8]",
            f"{note}, q {q:g}",
            CODE,
            scope=f"{SCOPE}; rigid until the mechanism starts; without a displacement check",
            state=state,
            alternative=state,
            barred=unknown or known,
        )
    )
    return lines


def _nonlinear(found: Capacities, state: str, spectrum: Spectrum | None, place: Place) -> Line:
    """The displacement at SLV or SLC against that of the spectrum, or of the floor's."""
    assert found.d0 is not None
    late = state == "SLC"
    share, factor, damping = (SLC, COLLAPSE_PERIOD, COLLAPSE_DAMPING) if late else (SLV, PERIOD, DAMPING)
    period, demand = equivalent_period(found.alone, found.d0, share, factor), None
    if place.at_height is not None:
        demand = displacement(place.at_height, period, damping, peak=B * place.at_height.first)
    elif spectrum is not None and not place.raised:
        demand = displacement(spectrum, period, damping)
    return Line(
        "NTC nonlinear at SLC" if late else "NTC nonlinear",
        "displacement",
        share * found.d0,
        demand,
        "m",
        f"NTC 2018, Circ. 7/2019 C8.7.1.2.1.8: d_{state} = {share:g} d_0 >= S_D(T_{state}) at {100 * damping:.0f} %, T_{state} = "
        f"{factor:g} pi sqrt(d_{state}/a(d_{state})) [C8.7.1.{11 if late else 10}], [C8.7.1.12]",
        f"T_{state} = {period:.3f} s",
        CODE,
        scope=SCOPE,
        state=state,
        alternative="" if late else state,
    )
