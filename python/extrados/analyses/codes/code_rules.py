"""Rules of codes and simple formulas for rocking bodies and wall piers, each with its source.

Clauses marked "verify clause" are quoted from memory of the standards: compare with the text before use. The others were
read: the Circolare in its text, ASCE 41-13 in the worked example of *Advanced Design Examples of Seismic Retrofit of
Structures*, section 2.7.5, whose equations are quoted.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from extrados.results.codes import Applied, Check
from extrados.results.model import TableData
from extrados.schema.constants import GRAVITY


@dataclass(frozen=True)
class Line:
    """One rule: its capacity and demand in `unit`, and where it comes from; verdict "" where there is no demand.

    scope: the element, its restraint and its height that the rule is for. code: whose check it is, "" for a formula for comparison.
    alternative: checks of one code with the same word are alternatives by that code, of which one that holds suffices; any other
    must hold by itself. barred: why the rule does not apply, "" where it does.
    """

    rule: str
    quantity: str
    capacity: float | None
    demand: float | None
    unit: str
    source: str
    note: str = ""
    code: str = ""
    scope: str = field(kw_only=True)
    alternative: str = field(default="", kw_only=True)
    barred: str = field(default="", kw_only=True)

    @property
    def verdict(self) -> Applied:
        """ "not-applicable" out of its scope; else whether it "holds", the demand being no more than the capacity, or "fails"; ""
        without a demand."""
        if self.barred:
            return "not-applicable"
        if self.demand is None or self.capacity is None:
            return ""
        return "holds" if self.demand <= self.capacity else "fails"

    def check(self) -> Check:
        """The rule as a result."""
        return Check(
            capacity=self.capacity, demand=self.demand, unit=self.unit, verdict=self.verdict, source=self.source, note=self.note,
            code=self.code, scope=self.scope, alternative=self.alternative, reason=self.barred,
        )  # fmt: skip


def table(lines: list[Line]) -> TableData:
    """The rules as rows."""
    return TableData({
        "rule": [x.rule for x in lines], "quantity": [x.quantity for x in lines],
        "capacity": [np.nan if x.capacity is None else x.capacity for x in lines],
        "demand": [np.nan if x.demand is None else x.demand for x in lines], "unit": [x.unit for x in lines],
        "verdict": [x.verdict for x in lines], "source": [x.source for x in lines], "note": [x.note for x in lines],
        "code": [x.code for x in lines], "scope": [x.scope for x in lines], "reason": [x.barred for x in lines],
    })  # fmt: skip


BLOCK = "rigid block that rocks on the ground, not anchored"
PIER = "wall or pier without openings in its plane; its foot fixed, its top free or fixed"


def west(tan_alpha: float, pga: float | None) -> Line:
    """Uplift: a = g tan alpha."""
    return Line("uplift", "PGA", tan_alpha, pga, "g", "West's formula, quoted by Milne 1882", scope=BLOCK)


def housner(p: float, alpha: float, pga: float | None, period: float) -> Line:
    """Half of a sine of period T = 2 pi/w: a = g tan alpha sqrt(1 + (w/p)^2); unconservative (see the theory page)."""
    x = float(np.hypot(1.0, 2.0 * np.pi / (period * p)))
    note = f"for half a sine of {period:.3g} s"
    return Line(
        "Housner half sine",
        "PGA",
        x * np.tan(alpha),
        pga,
        "g",
        "Housner 1963, Eq. 15 (verify clause)",
        note,
        scope=BLOCK,
    )


def ishiyama(width: float, height: float, pga: float | None, pgv: float | None) -> tuple[Line, Line]:
    """Overturning needs both PGA >= (B/H) g and PGV >= 10 B/sqrt(H) cm/s with B, H in cm."""
    source = "Ishiyama 1982 (verify clause)"
    speed = 10.0 * 100.0 * width / np.sqrt(100.0 * height) / 100.0
    note = "overturns only where both limits are passed"
    return (
        Line(
            "Ishiyama acceleration",
            "PGA",
            width / height,
            pga,
            "g",
            source,
            note,
            "Ishiyama",
            scope=BLOCK,
            alternative="overturning needs both",
        ),
        Line(
            "Ishiyama velocity",
            "PGV",
            float(speed),
            pgv,
            "m/s",
            source,
            note,
            "Ishiyama",
            scope=BLOCK,
            alternative="overturning needs both",
        ),
    )


def asce43(width: float, height: float, sa: Callable[[float, float], float] | None) -> Line:
    """Rocking as an equivalent oscillator, capacity at the rotation alpha (Makris and Konstantinidis 2003 object).

    Not applicable to a block so squat that Housner's coefficient of restitution, 1 - 2 (b/h)^2/c_3, is not above 0.
    """
    # b/h is that of the half sizes, h the height of the centre of mass; theta is the rotation of the best estimate.
    ratio, h = width / height, 0.5 * height
    theta = float(np.arctan(ratio))
    f1 = np.cos(theta) + ratio * np.sin(theta) - 1.0
    c3 = 4.0 / 3.0 * (1.0 + ratio**2)
    c_r = 1.0 - 2.0 * ratio**2 / c3
    frequency = float(np.sqrt(2.0 * f1 * GRAVITY / (c3 * theta**2 * h)) / (2.0 * np.pi))
    capacity = float(2.0 * f1 / (c3 * theta))
    source, scope = "ASCE/SEI 43-05, App. A (verify clause)", f"{BLOCK}; Housner's coefficient of restitution above 0"
    if not c_r > 0.0:
        return Line("ASCE 43 rocking", "SA", capacity, None, "g", source, "", "ASCE 43", scope=scope,
                    barred=f"the block of b/h = {ratio:.3g} does not rock: Housner's coefficient of restitution is {c_r:.3g}, and "
                    "gives no equivalent damping")  # fmt: skip
    gamma = -2.0 * np.log(c_r)
    damping = float(gamma / np.sqrt(4.0 * np.pi**2 + gamma**2))
    demand = None if sa is None else sa(1.0 / frequency, damping)
    return Line("ASCE 43 rocking", "SA", capacity, demand, "g", source,
                f"equivalent frequency {frequency:.3f} Hz, damping {100 * damping:.1f} %, at rotation alpha", "ASCE 43", scope=scope)  # fmt: skip


def piers(
    width: float,
    height: float,
    thickness: float,
    load: float,
    strength: float,
    cohesion: float,
    friction: float,
    double: bool,
) -> list[Line]:
    """Lateral strength of a wall pier, `load` [N] in all at its base; lengths [m], stresses [Pa]."""
    area = width * thickness
    stress = load / area
    effective = height / 2.0 if double else height
    slenderness = effective / width
    share = max(0.0, 1.0 - stress / (0.85 * strength))
    factor = 1.0 if double else 0.5
    fema = 0.9 * factor * load * width / height
    sliding_fema = area * 0.75 * (0.75 * cohesion + stress) / 1.5
    crushing = factor * load * width / height * max(0.0, 1.0 - stress / (0.7 * strength))
    rocking = width * load * share / (2.0 * effective)
    # Magenes and Calvi 1997: bed-joint sliding of the cracked base, and diagonal cracking of the units left out
    cracked = (
        thickness
        * width
        * (1.5 * cohesion + friction * stress)
        / (1.0 + 3.0 * cohesion * slenderness / max(stress, 1e-300))
    )
    shear = area * (cohesion + friction * stress) / (1.0 + slenderness)
    return [
        Line(
            "FEMA 356 rocking",
            "lateral strength",
            fema,
            None,
            "N",
            "FEMA 356 Eq. 7-4: 0.9 alpha P L/h (verify clause)",
            scope=PIER,
        ),
        Line(
            "FEMA 356 bed-joint sliding",
            "lateral strength",
            sliding_fema,
            None,
            "N",
            "FEMA 356 Eqs 7-1, 7-3: v_me = 0.75 (0.75 v_te + P/A)/1.5, v_te = cohesion (verify clause)",
            scope=PIER,
        ),
        Line(
            "FEMA 356 toe crushing",
            "lateral strength",
            crushing,
            None,
            "N",
            "FEMA 356 Eq. 7-6: alpha P L/h (1 - f_a/(0.7 f_m)) (verify clause)",
            scope=PIER,
        ),
        Line(
            "Magenes-Calvi rocking",
            "lateral strength",
            rocking,
            None,
            "N",
            "Magenes and Calvi 1997, Eq. 1 (verify clause)",
            scope=PIER,
        ),
        Line(
            "Magenes-Calvi shear",
            "lateral strength",
            shear,
            None,
            "N",
            "Magenes and Calvi 1997, Eq. 6 (verify clause)",
            scope=PIER,
        ),
        Line(
            "Magenes-Calvi sliding",
            "lateral strength",
            cracked,
            None,
            "N",
            "Magenes and Calvi 1997, Eq. 4 (verify clause)",
            scope=PIER,
        ),
    ]


def more_piers(
    width: float, height: float, thickness: float, axial: float, weight: float, strength: float, cohesion: float, friction: float,
    diagonal: float | None, double: bool,
) -> list[Line]:  # fmt: skip
    """Rules that tell the load on top from the pier's own weight [N], and those of EN 1998-3 and NTC; lengths m, stresses Pa.

    diagonal: tau_0, the shear strength without compression of the rule of diagonal cracking; None leaves it out.
    """
    area, load = width * thickness, axial + weight
    stress = load / area
    effective = height / 2.0 if double else height
    factor = 1.0 if double else 0.5
    # Gravity loads count 1.1 times where they press (ASCE 41-13 Eq. 7-1)
    pressed = 1.1 * stress
    book = "as in Advanced Design Examples of Seismic Retrofit of Structures, Eq."
    toes = (factor * axial + 0.5 * weight) * width / height
    lines = [
        Line("ASCE 41 rocking of a pier", "lateral strength", 0.9 * toes, None, "N",
             f"ASCE 41-13: V_r = 0.9 (alpha P_D + 0.5 P_W) L/h_eff, alpha 0.5 free, 1 fixed at the top ({book} 2.31)", scope=PIER),
        Line("ASCE 41 bed-joint sliding", "lateral strength", 0.5 * (0.75 * cohesion * area + axial), None, "N",
             f"ASCE 41-13: V_bjs1 = 0.75 (0.75 v_te + P_D/A_n)/1.5 A_n, v_te = cohesion ({book} 2.33)", scope=PIER),
        Line("ASCE 41 sliding once cracked", "lateral strength", 0.5 * axial, None, "N",
             f"ASCE 41-13: V_bjs2 = 0.5 P_D, what is left of it ({book} 2.34)", scope=PIER),
        Line("ASCE 41 toe crushing", "lateral strength", toes * max(0.0, 1.0 - pressed / (0.7 * strength)), None, "N",
             f"ASCE 41-13: V_tc = (alpha P_D + 0.5 P_W) L/h_eff (1 - f_a/(0.7 f_m)), f_a of 1.1 times the loads ({book} 2.35)", scope=PIER),
        Line("EN 1998-3 flexure", "lateral strength", max(0.0, width * load / (2.0 * effective) * (1.0 - 1.15 * stress / strength)), None,
             "N", "EN 1998-3:2005 C.4.2.1: V_f = D N (1 - 1.15 nu_d)/(2 H_0) (verify clause)", scope=PIER),
    ]  # fmt: skip
    lines.append(
        Line("EN 1998-3 shear", "lateral strength", area * min(cohesion + friction * stress, 0.065 * strength),
             None, "N", "EN 1998-3:2005 C.4.3.1: V_f = f_vd D' t, f_vd = f_vm0 + 0.4 N/(D' t) <= 0.065 f_m, whole length pressed (verify clause)", scope=PIER)
    )  # fmt: skip
    if diagonal is not None:
        b = min(max(height / width, 1.0), 1.5)
        tension = 1.5 * diagonal
        beta = min(max(width / height, 0.67), 1.0)
        lines += [
            Line("NTC diagonal cracking", "lateral strength", area * tension / b * float(np.sqrt(1.0 + stress / tension)), None, "N",
                 "NTC 2018, Circ. 7/2019 [C8.7.1.16]: V_t = l t (1.5 tau_0/b) sqrt(1 + sigma_0/(1.5 tau_0)), 1 <= b = h/l <= 1.5", scope=PIER),
            Line("ASCE 41 diagonal tension", "lateral strength", beta * area * tension * float(np.sqrt(1.0 + pressed / tension)), None, "N",
                 f"ASCE 41-13: V_dt = f_dt A_n beta sqrt(1 + f_a/f_dt), f_dt = 1.5 tau_0, 0.67 <= beta = L/h_eff <= 1 ({book} 2.36)", scope=PIER),
        ]  # fmt: skip
    return lines
