"""Lateral strength of wall piers in their plane: NTC 2018, EN 1998-3 annex C, ASCE 41-13."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes.code_rules import Line

PIER = "wall or pier without openings in its plane; its foot fixed, its top free or fixed; any height"
#: NTC 2018, C8.7.1.17: local friction of the joints of regular masonry
JOINT_FRICTION = 0.577
#: EN 1998-3 C.4: NC over SD; NTC C7.8.2.2.1: drift at SLC
NEAR_COLLAPSE = 4.0 / 3.0


@dataclass(frozen=True)
class Pier:
    """A rectangle of masonry: sizes [m], load on its top and its own weight [N], double: its top does not rotate.

    Mean strengths [Pa]: compression f_m; cohesion f_v0, without compression; diagonal tau_0, None where it is not known; units f_b,
    None likewise. friction of bed joints; interlocking phi = h_b/l of regular masonry, None of irregular.
    """

    width: float
    height: float
    thickness: float
    axial: float
    weight: float
    double: bool
    strength: float
    cohesion: float
    friction: float
    diagonal: float | None = None
    interlocking: float | None = None
    units: float | None = None

    @property
    def load(self) -> float:
        """Vertical force N at the foot [N]."""
        return self.axial + self.weight

    @property
    def area(self) -> float:
        """Gross area l t [m^2]."""
        return self.width * self.thickness

    @property
    def stress(self) -> float:
        """Mean compression sigma_0 [Pa]."""
        return self.load / self.area

    @property
    def shear_span(self) -> float:
        """H_0 [m]: from the section where flexural strength is reached to the point of contraflexure."""
        return self.height / 2.0 if self.double else self.height

    def flexure(self, strength: float, block: float) -> float:
        """Lateral strength [N] at which the foot crushes: N l/(2 H_0) (1 - sigma_0/(block f))."""
        share = max(0.0, 1.0 - self.stress / (block * strength))
        return self.load * self.width * share / (2.0 * self.shear_span)

    def sliding(self, cohesion: float, most: float | None) -> tuple[float, float]:
        """Lateral strength [N] along a bed joint and the compressed length l' [m] under it, (c + mu sigma) l' t, stress at most `most` [Pa].

        The foot cracks where the eccentricity V H_0/N exceeds l/6; then l' = 3 (l/2 - V H_0/N). Flexure bounds the force.
        """
        n, h, t, whole = self.load, self.shear_span, self.thickness, self.width
        force = cohesion * self.area + self.friction * n
        if most is not None:
            force = min(force, most * self.area)
        if not n > 0.0 or force * h / n <= whole / 6.0:
            return force, whole
        force = (1.5 * cohesion * whole * t + self.friction * n) / (1.0 + 3.0 * cohesion * t * h / n)
        if most is not None:
            force = min(force, 1.5 * most * whole * t / (1.0 + 3.0 * most * t * h / n))
        force = min(force, n * whole / (2.0 * h))
        return force, max(0.0, 3.0 * (0.5 * whole - force * h / n))


def ntc_piers(p: Pier, factor: float, partial: float, demand: float | None, state: str) -> list[Line]:
    """Flexure, sliding, diagonal cracking by NTC 2018 with strengths f/(FC gamma_M); demand [N] on the pier."""
    d = factor * partial
    f, c = p.strength / d, p.cohesion / d
    told = f"FC {factor:.3g}, gamma_M {partial:.3g}"
    slid, pressed = p.sliding(c, None if p.units is None else 0.065 * p.units / (0.7 * d))
    lines = [
        _strength(
            "NTC flexure",
            p.flexure(f, 0.85),
            demand,
            "NTC 2018 7.8.2.2.1 Eq. [7.8.2]: M_u = (l^2 t sigma_0/2)(1 - sigma_0/(0.85 f_d)), V = M_u/H_0",
            told,
            "NTC 2018",
            state,
        ),
        _strength(
            "NTC sliding",
            slid,
            demand,
            "NTC 2018 7.8.2.2.2 Eq. [7.8.3]: V = l' t f_vd; l' is the compressed length, f_vd = f_v0d + 0.4 sigma_n",
            f"{told}, l' {pressed:.3g} m",
            "NTC 2018",
            state,
            ""
            if p.cohesion > 0.0
            else "the deck gives no f_v0 ([joints] cohesion). Regular masonry requires it for stepped cracking. For irregular masonry only diagonal cracking is checked",
        ),
    ]
    b = float(np.clip(p.height / p.width, 1.0, 1.5))
    if p.diagonal is None:
        irregular = "the deck does not give tau_0 (key `diagonal_strength`)"
    else:
        irregular = "" if p.interlocking is None else "interlocking is given, so the masonry is regular [C8.7.1.17]"
    tension = 1.5 * (p.diagonal or 0.0) / d
    cracked = None if not tension else p.area * tension / b * float(np.sqrt(1.0 + p.stress / tension))
    lines.append(
        _strength(
            "NTC diagonal cracking",
            cracked,
            demand,
            "Circ. 7/2019 [C8.7.1.16]: V_t = l t (1.5 tau_0d/b) sqrt(1 + sigma_0/(1.5 tau_0d)), 1 <= b = h/l <= 1.5",
            f"{told}, b {b:.3g}",
            "NTC 2018",
            state,
            irregular,
            "irregular masonry",
        )
    )
    if p.interlocking is not None:
        stepped = p.area / b * (c + JOINT_FRICTION * p.stress) / (1.0 + JOINT_FRICTION * p.interlocking)
        note = f"{told}, b {b:.3g}"
        if p.units is not None:
            split = 0.1 * p.units / d
            stepped = min(stepped, p.area * split / (2.3 * b) * float(np.sqrt(1.0 + p.stress / split)))
            note += f", f_btd {split / 1e6:.3g} MPa"
        lines.append(
            _strength(
                "NTC stepped cracking",
                stepped,
                demand,
                "Circ. 7/2019 [C8.7.1.17]: V_t = (l t/b)(f_v0d + mu sigma_0)/(1 + mu phi), mu 0.577, units at most "
                "(l t f_btd/(2.3 b)) sqrt(1 + sigma_0/f_btd), f_bt = 0.1 f_b",
                note,
                "NTC 2018",
                state,
                "" if p.cohesion > 0.0 else "the deck does not give f_v0 ([joints] cohesion)",
                "regular masonry",
            )
        )
    rule = (
        "NTC 2018 7.8.2.2, Circ. 7/2019 C8.7.1.3.1.1: drift at SLC 0.01 in flexure and 0.005 in shear; SLV is 3/4 of SLC "
        "on the bilinear curve"
    )
    share = 0.75 if state == "SLV" else 1.0
    drifts = (("flexure", 0.01), ("shear", 0.005))
    return lines + [_drift(f"NTC drift in {name}", drift * share, rule, state) for name, drift in drifts]


def en1998_piers(p: Pier, factor: float, demand: float | None, state: str) -> list[Line]:
    """Flexure and shear of EN 1998-3 annex C with mean strengths over the confidence factor."""
    f, c = p.strength / factor, p.cohesion / factor
    told = f"CF {factor:.3g}"
    slid, pressed = p.sliding(c, 0.065 * f)
    worse = NEAR_COLLAPSE if state == "NC" else 1.0
    return [
        _strength(
            "EN 1998-3 flexure",
            p.flexure(f, 1.0 / 1.15),
            demand,
            "EN 1998-3:2005 C.4.2.1: V_f = D N (1 - 1.15 nu_d)/(2 H_0), nu_d = N/(D t f_d) (verify clause)",
            told,
            "EN 1998-3",
            state,
        ),
        _strength(
            "EN 1998-3 shear",
            slid,
            demand,
            "EN 1998-3:2005 C.4.3.1: V_f = f_vd D' t, D' compressed length, f_vd = f_vm0 + 0.4 N/(D' t) <= 0.065 f_m (verify clause)",
            f"{told}, D' {pressed:.3g} m",
            "EN 1998-3",
            state,
        ),
        _drift(
            "EN 1998-3 drift in flexure",
            worse * 0.008 * p.shear_span / p.width,
            "EN 1998-3:2005 C.4.2.1: drift 0.008 H_0/D of primary walls at SD; at NC 4/3 of this value (verify clause)",
            state,
        ),
        _drift(
            "EN 1998-3 drift in shear",
            worse * 0.004,
            "EN 1998-3:2005 C.4.3.1: drift 0.004 of primary walls at SD; at NC 4/3 of this value (verify clause)",
            state,
        ),
    ]


def asce41_piers(p: Pier, factor: float, demand: float | None, ductility: float, state: str) -> list[Line]:
    """Rocking, sliding, toe crushing, diagonal tension of ASCE 41-13; capacities times the knowledge factor 1/`factor`.

    ductility: m, by which the demand of rocking and sliding (deformation-controlled) is divided.
    """
    book = "as in Advanced Design Examples of Seismic Retrofit of Structures, Eq."
    toes = ((1.0 if p.double else 0.5) * p.axial + 0.5 * p.weight) * p.width / p.height
    # Gravity loads count 1.1 times where they press (ASCE 41-13 Eq. 7-1)
    pressed = 1.1 * p.stress
    eased = None if demand is None else demand / ductility
    told = f"kappa {1.0 / factor:.3g}, m {ductility:.3g}"
    forced = f"kappa {1.0 / factor:.3g}, force-controlled (lower-bound strength)"
    lines = [
        _strength(
            "ASCE 41 rocking of a pier",
            0.9 * toes / factor,
            eased,
            f"ASCE 41-13 11.3.2.2: V_r = 0.9 (alpha P_D + 0.5 P_W) L/h_eff, alpha 0.5 free, 1 fixed at the top ({book} 2.31)",
            told,
            "ASCE 41",
            state,
        ),
        _strength(
            "ASCE 41 bed-joint sliding",
            0.5 * (0.75 * p.cohesion * p.area + p.axial) / factor,
            eased,
            f"ASCE 41-13 11.3.2.2: V_bjs1 = 0.75 (0.75 v_te + P_D/A_n)/1.5 A_n, v_te = cohesion ({book} 2.33)",
            told,
            "ASCE 41",
            state,
            ""
            if state == "IO"
            else f"V_bjs1 is the strength of the uncracked joint, valid at IO; at {state} the residual strength V_bjs2 applies",
            "at IO",
        ),
        _strength(
            "ASCE 41 residual sliding",
            0.5 * p.axial / factor,
            eased,
            f"ASCE 41-13 11.3.2.2: V_bjs2 = 0.5 P_D, residual strength of the cracked joint ({book} 2.34)",
            told,
            "ASCE 41",
            state,
            "V_bjs2 is the residual strength, valid beyond IO" if state == "IO" else "",
            "beyond IO",
            "residual strength",
        ),
        _strength(
            "ASCE 41 toe crushing",
            toes * max(0.0, 1.0 - pressed / (0.7 * p.strength)) / factor,
            demand,
            f"ASCE 41-13 11.3.2.2: V_tc = (alpha P_D + 0.5 P_W) L/h_eff (1 - f_a/(0.7 f_m)), f_a of 1.1 times the loads ({book} 2.35)",
            forced,
            "ASCE 41",
            state,
        ),
    ]
    beta = float(np.clip(p.width / p.height, 0.67, 1.0))
    tension = 1.5 * (p.diagonal or 0.0)
    split = None if not tension else beta * p.area * tension * float(np.sqrt(1.0 + pressed / tension)) / factor
    lines.append(
        _strength(
            "ASCE 41 diagonal tension",
            split,
            demand,
            f"ASCE 41-13 11.3.2.2: V_dt = f_dt A_n beta sqrt(1 + f_a/f_dt), f_dt = 1.5 tau_0, 0.67 <= beta = L/h_eff <= 1 ({book} 2.36)",
            forced,
            "ASCE 41",
            state,
            "" if split else "the deck does not give tau_0 (key `diagonal_strength`)",
        )
    )
    return lines


def nzsee_piers() -> list[Line]:
    """No rule: the equations of C8 in the plane could not be read."""
    return [
        Line(
            "NZSEE C8 in-plane strength",
            "lateral strength",
            None,
            None,
            "N",
            "NZSEE/MBIE 2017 C8.8 (verify clause)",
            "",
            "NZSEE",
            scope=PIER,
            barred="the equations of C8 for in-plane strength of piers are not included in this program: their text was not available",
        )
    ]


def weakest(lines: Sequence[Line]) -> Line | None:
    """The applicable rule of the code with the least strength [N]; residual strengths are not among them."""
    own = [x for x in lines if x.quantity == "lateral strength" and x.code and not x.barred and x.capacity is not None]
    return min(own, key=lambda x: x.capacity or 0.0, default=None)


def _strength(
    rule: str,
    capacity: float | None,
    demand: float | None,
    source: str,
    note: str,
    code: str,
    state: str,
    barred: str = "",
    more: str = "",
    quantity: str = "lateral strength",
) -> Line:
    scope = f"{PIER}; {more}" if more else PIER
    return Line(rule, quantity, capacity, demand, "N", source, note, code, scope=scope, state=state, barred=barred)


def _drift(rule: str, drift: float, source: str, state: str) -> Line:
    """A drift that a displacement-based analysis compares; no check by itself."""
    return Line(rule, "drift", drift, None, "", source, "for the displacements of a pushover analysis", scope=PIER, state=state)
