"""Formulas of other origin than the code of a report: for rocking blocks, and for wall piers. They are compared and decide nothing."""

from collections.abc import Callable

import numpy as np

from extrados.analyses.codes.code_rules import Line
from extrados.schema.constants import GRAVITY

BLOCK = "rigid block that rocks on the ground, without anchors"
PIER = "wall or pier without openings in its plane; foot fixed; top free or fixed"


def west(tan_alpha: float, pga: float | None) -> Line:
    """Uplift: a = g tan alpha."""
    return Line("uplift", "PGA", tan_alpha, pga, "g", "West's formula, quoted by Milne 1882", scope=BLOCK)


def housner(p: float, alpha: float, pga: float | None, period: float) -> Line:
    """Half of a sine of period T = 2 pi/w: a = g tan alpha sqrt(1 + (w/p)^2); unconservative (see the theory page)."""
    x = float(np.hypot(1.0, 2.0 * np.pi / (period * p)))
    note = f"for a half sine of {period:.3g} s"
    return Line("Housner half sine", "PGA", x * np.tan(alpha), pga, "g", "Housner 1963, Eq. 15 (verify clause)", note, scope=BLOCK)


def ishiyama(width: float, height: float, pga: float | None, pgv: float | None) -> tuple[Line, Line]:
    """Overturning needs both PGA >= (B/H) g and PGV >= 10 B/sqrt(H) cm/s with B, H in cm."""
    source = "Ishiyama 1982 (verify clause)"
    speed = 10.0 * 100.0 * width / np.sqrt(100.0 * height) / 100.0
    note = "for overturning, the motion must exceed both limits"
    return (
        Line("Ishiyama acceleration", "PGA", width / height, pga, "g", source, note, scope=BLOCK),
        Line("Ishiyama velocity", "PGV", float(speed), pgv, "m/s", source, note, scope=BLOCK),
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
    source, scope = "ASCE/SEI 43-05, App. A (verify clause)", f"{BLOCK}; coefficient of restitution by Housner above 0"
    if not c_r > 0.0:
        return Line(
            "ASCE 43 rocking",
            "SA",
            capacity,
            None,
            "g",
            source,
            scope=scope,
            barred=f"the block of b/h = {ratio:.3g} does not rock: its coefficient of restitution by Housner is {c_r:.3g}, which "
            "gives no equivalent damping",
        )
    gamma = -2.0 * np.log(c_r)
    damping = float(gamma / np.sqrt(4.0 * np.pi**2 + gamma**2))
    demand = None if sa is None else sa(1.0 / frequency, damping)
    return Line(
        "ASCE 43 rocking",
        "SA",
        capacity,
        demand,
        "g",
        source,
        f"equivalent frequency {frequency:.3f} Hz and damping {100 * damping:.1f} %, at the rotation alpha",
        scope=scope,
    )


def formulas_of_piers(
    width: float, height: float, thickness: float, load: float, strength: float, cohesion: float, friction: float, double: bool
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
    cracked = thickness * width * (1.5 * cohesion + friction * stress) / (1.0 + 3.0 * cohesion * slenderness / max(stress, 1e-300))
    shear = area * (cohesion + friction * stress) / (1.0 + slenderness)
    return [
        Line("FEMA 356 rocking", "lateral strength", fema, None, "N", "FEMA 356 Eq. 7-4: 0.9 alpha P L/h (verify clause)", scope=PIER),
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
        Line("Magenes-Calvi rocking", "lateral strength", rocking, None, "N", "Magenes and Calvi 1997, Eq. 1 (verify clause)", scope=PIER),
        Line("Magenes-Calvi shear", "lateral strength", shear, None, "N", "Magenes and Calvi 1997, Eq. 6 (verify clause)", scope=PIER),
        Line("Magenes-Calvi sliding", "lateral strength", cracked, None, "N", "Magenes and Calvi 1997, Eq. 4 (verify clause)", scope=PIER),
    ]
