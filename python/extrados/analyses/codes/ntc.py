"""Local mechanisms by NTC 2018 with Circolare 7/2019: the checks of C8.7.1.2.1, and the floor spectrum of C7.2.3."""

from collections.abc import Callable
from dataclasses import dataclass

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
#: Of the floor spectrum: a and b between which it is greatest, the damping of the building [%], and 1.1 xi^-0.5, how many times a
#: part of 5 % that sways with the building feels its acceleration (C7.2.3). The text gives xi in percent, as sqrt(1 + 0.0004 xi^2)
#: needs it; here it can only be the ratio, for 1.1/sqrt(5) would weaken what the text says is amplified (Table C7.2.II: 5 times).
A, B, BUILDING_DAMPING = 0.8, 1.1, 5.0
AMPLIFIED = 1.1 / float(np.sqrt(0.01 * BUILDING_DAMPING))
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
class Floor:
    """The spectrum at a height of a building that sways in its first mode: period T_1 [s], gamma_1 psi_1(z)."""

    ground: Spectrum
    first: float
    part: float

    @property
    def acceleration(self) -> float:
        """a_Z(z) [m/s^2], [C7.2.7]."""
        xi = BUILDING_DAMPING
        return self.ground(self.first, 0.01 * xi) * abs(self.part) * float(np.sqrt(1.0 + 4e-4 * xi**2))

    def __call__(self, period: float, damping: float) -> float:
        """S_eZ(T, xi, z) [m/s^2], [C7.2.6], from T_1 on not below that of the ground [C7.2.5]."""
        amplified = AMPLIFIED * damping_factor(damping)
        top, rise = amplified * self.acceleration, amplified - 1.0
        if period < A * self.first:
            return float(top / (1.0 + rise * (1.0 - period / (A * self.first)) ** 1.6))
        if period >= B * self.first:
            top = top / (1.0 + rise * (period / (B * self.first) - 1.0) ** 1.2)
        return float(top if period <= self.first else max(top, self.ground(period, damping)))


def floor(ground: Spectrum, height: float, building: float, storeys: int, period: float | None) -> Floor:
    """Of a place at `height` in a building so high [m], with so many storeys: psi_1 = z/H, gamma_1 = 3 n/(2 n + 1)
    [C7.2.10]; T_1 = 0.05 H^0.75 where none is known."""
    return Floor(ground, period or 0.05 * building**0.75, height / building * 3.0 * storeys / (2.0 * storeys + 1.0))


#: Friction of teeth of masonry, and the share of the force by which every course holds [C8.7.1.2]
TOOTH_FRICTION, TOOTH_SHARE = 0.577, 0.8


def toothed_edge(
    courses: int, unit_height: float, overlap: float, thickness: float, weight: float
) -> tuple[float, float]:
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
        f"FC is {fc:g}, but the multiplier neglects that masonry crushes: C8.7.1.2.1.3 then requires FC {LC1:g} (LC1). Give "
        f"compressive_strength, or FC {LC1:g}."
    )


#: What the kinematic analysis of C8.7.1.2.1 is for
SCOPE = "part of an existing masonry building or block that moves as rigid bodies and does not come apart; any restraint; any height"


def checks(
    a0: float, d0: float | None, q: float, peak: float | None, spectrum: Spectrum | None, note: str, at_height: Floor | None = None,
    alone: float | None = None, raised: bool = False, free: bool = False,
) -> list[Line]:  # fmt: skip
    """The checks at SLV; at a height all ask the floor.

    With a displacement check (a curve to d0 and a spectrum) the mechanism must keep within d_SLV or not start at all, since
    a_g,SLV is not taken below a_g,SLD (C8.7.1.2.1.8); the factor q is for mechanisms of which only the multiplier is known
    (C8.7.1.2.1.7).

    a0: alpha_0 g/(e* FC) [m/s^2]; d0 [m]: where the capacity vanishes, None where it does not; peak: a_g S [m/s^2];
    alone: a0 of the curve to d0 where it is another, without ties that may not last to collapse; raised: whether it stands at
    a height, where without a floor nothing is known of the demand; free: whether it is a part free to vibrate, as a parapet,
    which answers at a period of its own [C8.7.1.9], so that a_Z is no demand of it.
    """
    demand, where, quantity = (None, "at height z", "a_Z") if raised else (peak, "at the ground", "a_g S")
    if at_height is not None:
        # near the ground the first mode alone would ask for less than the ground itself does
        demand = max(at_height.acceleration, peak or 0.0)
    felt = None if demand is None else demand / GRAVITY
    lines, asked = [], None
    if d0 is not None:
        period = equivalent_period(a0 if alone is None else alone, d0)
        if at_height is not None:
            asked = displacement(at_height, period, peak=B * at_height.first)
        elif spectrum is not None and not raised:
            asked = displacement(spectrum, period)
        lines += [
            Line("NTC nonlinear", "displacement", SLV * d0, asked, "m",
                 "NTC 2018, Circ. 7/2019 C8.7.1.2.1.8: d_SLV = 0.4 d_0 >= S_D(T_SLV) at 8 %, T_SLV = 1.68 pi sqrt(d_SLV/a(d_SLV)) "
                 "[C8.7.1.10], [C8.7.1.12]", f"T_SLV = {period:.3f} s", "NTC 2018", scope=SCOPE, alternative="SLV"),
        ]  # fmt: skip
    vibrates = (
        "a part free to vibrate answers at its own period T_0: its demand is S_eZ(T_0) [C8.7.1.9], not a_Z"
        if free
        else ""
    )
    if asked is not None:
        lines.append(
            Line(f"NTC activation ({where})", quantity, a0 / GRAVITY, felt, "g",
                 "NTC 2018, Circ. 7/2019 [C8.7.1.8]: alpha_0 g/(e* FC) >= a_Z, at the ground a_g S: the mechanism does not start",
                 note, "NTC 2018", scope=f"{SCOPE}; rigid until it starts", alternative="SLV", barred=vibrates)
        )  # fmt: skip
    compared = "the displacement is checked: q is for mechanisms of which only the multiplier is known (C8.7.1.2.1.7)"
    lines.append(
        Line(f"NTC linear ({where})", quantity, q * a0 / GRAVITY, felt, "g",
             "NTC 2018, Circ. 7/2019 C8.7.1.2.1.7: q alpha_0 g/(e* FC) >= a_Z, at the ground a_g S; [C8.7.1.8], [C7.2.8]",
             f"{note}, q {q:g}", "NTC 2018", scope=f"{SCOPE}; rigid until it starts; no displacement check", alternative="SLV",
             barred=vibrates or (compared if asked is not None else ""))
    )  # fmt: skip
    return lines


def collapse_check(alone: float, d0: float, spectrum: Spectrum | None, at_height: Floor | None) -> Line:
    """The displacement at SLC, by the spectrum of SLC or the floor's of it; what holds at SLV does not stand for it.

    alone: a0* [m/s^2] of the curve that falls to 0 at d0 [m].
    """
    period = equivalent_period(alone, d0, SLC, COLLAPSE_PERIOD)
    asked = None
    if at_height is not None:
        asked = displacement(at_height, period, COLLAPSE_DAMPING, peak=B * at_height.first)
    elif spectrum is not None:
        asked = displacement(spectrum, period, COLLAPSE_DAMPING)
    return Line(
        "NTC nonlinear at SLC", "displacement", SLC * d0, asked, "m",
        "NTC 2018, Circ. 7/2019 C8.7.1.2.1.8: d_SLC = 0.6 d_0 >= S_D(T_SLC) at 10 %, T_SLC = 1.56 pi sqrt(d_SLC/a(d_SLC)) [C8.7.1.11]",
        f"T_SLC = {period:.3f} s", "NTC 2018, SLC", scope=SCOPE,
    )  # fmt: skip
