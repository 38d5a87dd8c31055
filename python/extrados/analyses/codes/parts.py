"""A part of a building by the rules of other codes than NTC: EN 1998-1 4.3.5, ASCE 41 out of plane, NZSEE C8.

Each rule states its scope and answers that it does not apply anywhere else.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes.code_rules import Line
from extrados.schema.constants import GRAVITY

#: EN 1998-1 Table 4.4, q_a: cantilevers, and walls (the same values as Table C7.2.I of Circolare 7/2019)
PART_FACTOR = {"parapet": 1.0, "gable": 1.0, "chimney": 1.0, "wall": 2.0, "facade": 2.0, "vertical-bending": 2.0, "horizontal-bending": 2.0}
#: ASCE 41 height over thickness up to which no out-of-plane check is required, for S_X1 up to 0.24 g, up to 0.37 g, above
SLENDER = {"one-story": (20, 16, 13), "first": (20, 18, 15), "top": (14, 14, 9), "other": (20, 16, 13)}
#: ASCE 41 height over thickness of parapets: life safety in low and moderate seismicity, else
PARAPET = (2.5, 1.5)
#: ASCE 41 Table 2-5: S_XS and S_X1 [g] from which seismicity is high
HIGH = (0.5, 0.2)
#: NZSEE C8: usable part of the displacement of instability: of a parapet, and of a wall that spans between floors
USABLE, USABLE_WALL = 0.3, 0.6


@dataclass(frozen=True)
class Part:
    """What turns: its element (a mechanism of the table), alpha_0, height and thickness [m] above the hinge, None of a chain of blocks;
    z [m] and H [m], of a part of a building, else 0 and None; loaded: floors rest on it; anchored: ties or floors hold its top; load [N]
    on its top, `arm` [m] behind its outer face; weight [N]; period T_a of the part, and T_1 of the building [s], None: not known; shaken: whether the action
    is the motion of the floor below it, to which no coefficient of height applies."""

    element: str
    multiplier: float
    height: float | None
    thickness: float | None
    place: float
    building: float | None
    loaded: bool = False
    anchored: bool = False
    load: float = 0.0
    arm: float = 0.0
    weight: float = 0.0
    period: float | None = None
    first: float | None = None
    shaken: bool = False

    @property
    def elevated(self) -> bool:
        """Whether it stands on a building, above the ground."""
        return self.place > 0.0 and self.building is not None


def en1998(part: Part, peak: float | None, state: str = "SD", spectrum: Callable[[float, float], float] | None = None) -> list[Line]:
    """Action on a non-structural element, F_a = S_a W_a/q_a, against the weight that holds it; peak: a_g S [m/s^2]. spectrum [m/s^2] over
    period and damping ratio: of a part shaken by its floor, whose S_a is the response at T_a."""
    q_a, barred, asked = PART_FACTOR.get(part.element), "", None
    # the least favourable ratio, resonance, where a period is not known
    known = part.period is not None and part.first is not None
    tuned = part.period / part.first if part.period is not None and part.first is not None else 1.0
    if q_a is None:
        barred = f"Table 4.4 gives no q_a for this kind of element ({part.element})"
    elif part.loaded:
        barred = "a wall that carries floors is a structural element, not a part"
    elif not part.elevated:
        barred = "the part is assumed to be supported by the ground: for a part of a building, give `base_height` and `building_height`"
    elif part.shaken:
        if part.period is None:
            barred = (
                "T_a is not known. The action is the motion of the floor, so S_a is the response to this motion at T_a: give "
                "`period`. For a part that vibrates freely, `young` of [material] also gives the period"
            )
        elif spectrum is not None:
            asked = spectrum(part.period, 0.05) / GRAVITY
    elif peak is not None:
        assert part.building is not None
        shape = 3.0 * (1.0 + part.place / part.building) / (1.0 + (1.0 - tuned) ** 2) - 0.5
        asked = peak / GRAVITY * max(shape, 1.0)
    return [
        Line(
            "EN 1998-1 part of a building",
            "S_a",
            None if q_a is None else part.multiplier * q_a,
            asked,
            "g",
            "EN 1998-1:2004 4.3.5.2 Eqs (4.24), (4.25): F_a = S_a W_a gamma_a/q_a, S_a = a_g S (3 (1 + z/H)/(1 + (1 - T_a/T_1)^2) - 0.5) "
            ">= a_g S, gamma_a 1; Table 4.4 (verify clause)",
            (
                "S_a is the response to the motion of the floor at T_a"
                if part.shaken
                else f"T_a/T_1 {tuned:.3g}"
                if known
                else "T_a or T_1 is not known, so resonance is assumed (T_a/T_1 = 1)"
            )
            + ("" if q_a is None else f", q_a {q_a:g}"),
            "EN 1998-1",
            state=state,
            barred=barred,
            scope="non-structural element (parapet, gable, chimney, wall without floors on it); fixed at its foot; on a building, at z > 0",
        ),
        Line(
            "EN 1998-3 local mechanism",
            "",
            None,
            None,
            "",
            "EN 1998-3:2005 Annex C (verify clause)",
            "",
            "EN 1998-3",
            state=state,
            scope="masonry walls in their plane",
            barred="Annex C of the 2005 edition has only rules for in-plane failure of walls. It has no rules for out-of-plane mechanisms",
        ),
    ]


def asce41(part: Part, s_x1: float | None, storey: str, s_xs: float | None = None, state: str = "LS") -> list[Line]:
    """Height over thickness up to which no out-of-plane check is required, and that of parapets; s_x1, s_xs: spectral acceleration at 1 s
    and of short periods [m/s^2]."""
    slender = None if part.height is None or part.thickness is None else part.height / part.thickness
    barred = ""
    if part.element not in ("facade", "vertical-bending") or not part.anchored:
        barred = "Table 11-5 covers walls between anchored diaphragms: " + (
            "no anchor holds the top of this facade" if part.element == "facade" else f"this element is a {part.element}"
        )
    elif state == "IO":
        barred = "Table 11-5 limits stability at LS and CP. At IO no cracking is permitted, and this program does not check cracking"
    limit = None if s_x1 is None else SLENDER[storey][0 if s_x1 <= 0.24 * GRAVITY else 1 if s_x1 <= 0.37 * GRAVITY else 2]
    unknown = "S_X1 is not known" + (": the action is the motion of a floor, not of the ground" if part.shaken else "")
    told = unknown if s_x1 is None else f"S_X1 {s_x1 / GRAVITY:.3g} g"
    free = "" if part.element == "parapet" else f"the limit covers parapets only; this element is a {part.element}"
    high = s_x1 is not None and (s_x1 >= HIGH[1] * GRAVITY or (s_xs or 0.0) >= HIGH[0] * GRAVITY)
    most = None if s_x1 is None else PARAPET[1 if high or state == "CP" else 0]
    return [
        Line(
            "ASCE 41 slenderness",
            "h/t",
            None if limit is None else float(limit),
            slender,
            "",
            "ASCE 41-13 11.3.3.3 Table 11-5 (verify clause)",
            f"{storey}, {told}",
            "ASCE 41",
            scope="wall between anchored diaphragms; held at foot and top; any storey",
            state=state,
            barred=barred,
        ),
        Line(
            "ASCE 41 parapet",
            "h/t",
            most,
            slender,
            "",
            "ASCE 41-13 13.6.5: at life safety h/t is at most 2.5 in low and moderate seismicity, otherwise 1.5 (verify clause)",
            f"{told}, {'high' if high else 'low or moderate'} seismicity" if s_x1 is not None else told,
            "ASCE 41",
            scope="parapet of unreinforced masonry, laterally unsupported; on a building",
            state=state,
            barred=free,
        ),
    ]


def height_coefficient(height: float, building: float) -> float:
    """C_Hi of NZS 1170.5 section 8, of a part at a height [m] in a building so high [m]."""
    low = []
    if height < 12.0:
        low.append(1.0 + height / 6.0)
    if height < 0.2 * building:
        low.append(1.0 + 10.0 * height / building)
    return min([*low, 3.0])


def shape_coefficient(period: float) -> float:
    """C_i(T_p) of NZS 1170.5 section 8, by the period of the part [s]."""
    return float(np.clip(2.0 * (1.75 - period), 0.5, 2.0))


def nzsee(part: Part, spectrum: Callable[[float, float], float] | None, state: str = "ULS") -> list[Line]:
    """A parapet, and a wall that spans one way between floors: displacement against the usable part of that of instability."""
    return [_nz_parapet(part, spectrum, state), _nz_wall(part, spectrum, state)]


def _nz_parapet(part: Part, spectrum: Callable[[float, float], float] | None, state: str) -> Line:
    h, t = float(part.height or 0.0), float(part.thickness or 0.0)
    barred, demand, note, capacity = "", None, "", None
    if part.element != "parapet":
        barred = f"the constants are valid for a parapet of constant thickness; this part is a {part.element}"
    else:
        slope, capacity = 1.0 + (t / h) ** 2, USABLE * t
        period = float(np.sqrt(0.65 * h * slope))
        note = f"T_p {period:.3f} s"
        if not part.elevated:
            barred = (
                "the demand of the parapet is not known, because its height above the ground is not given: give "
                "`base_height` and `building_height`"
            )
        else:
            felt, told = _part_coefficient(part, part.place, period, spectrum)
            note += told
            demand = None if felt is None else 1.5 / slope * felt * (period / (2.0 * np.pi)) ** 2
    return Line(
        "NZSEE C8 parapet",
        "displacement",
        capacity,
        demand,
        "m",
        "NZSEE/MBIE 2017 C8: %NBS = 30 D_i/D_ph; displacement of instability D_i = t; displacement demand D_ph; period "
        "T_p = sqrt(0.65 h (1 + (t/h)^2)); participation factor gamma = 1.5/(1 + (t/h)^2); height h, thickness t (verify clause); "
        "NZS 1170.5 section 8: C_p = C(0) C_Hi C_i",
        note,
        "NZSEE",
        scope="parapet; cantilever; on a building, at z > 0",
        state=state,
        barred=barred,
    )


def _nz_wall(part: Part, spectrum: Callable[[float, float], float] | None, state: str) -> Line:
    """The wall cracks at mid height into two halves of one thickness; the load on top acts at the middle of the wall's half."""
    barred, demand, capacity, note = "", None, None, ""
    if part.element != "vertical-bending":
        barred = f"the rule applies only to walls that span one way between floors; this wall does not ({part.element})"
    elif part.load < 0.0 or part.height is None or part.thickness is None:
        barred = "the dimensions of the wall are not known"
    elif part.shaken:
        barred = (
            "the action is the motion of the floor below. The floor above moves differently, so the demand is not known: give a spectrum"
        )
    else:
        found = one_way(part.height, part.thickness, part.weight, part.load)
        capacity = USABLE_WALL * found.instability
        felt, told = _part_coefficient(part, part.place + 0.5 * part.height, found.period, spectrum)
        note = f"T_p {found.period:.3f} s, gamma {found.participation:.3g}, D_i {found.instability:.3g} m{told}"
        demand = None if felt is None else found.participation * felt * (found.period / (2.0 * np.pi)) ** 2
    return Line(
        "NZSEE C8 one-way wall",
        "displacement",
        capacity,
        demand,
        "m",
        "NZSEE/MBIE 2017 C8: %NBS = 60 D_i/D_ph, D_i = b h/(2 a), T_p = 4.07 sqrt(J/a), D_ph = gamma (T_p/2 pi)^2 C_p g, hinge at mid height, "
        "e_o = e_b = e_t = t_e/2, e_p = 0 (verify clause); NZS 1170.5 section 8: C_p = C(0) C_Hi C_i",
        note,
        "NZSEE",
        scope="wall that spans one way between floors; held at foot and top by stiff diaphragms; any storey",
        state=state,
        barred=barred,
    )


@dataclass(frozen=True)
class OneWay:
    """A one-way wall: effective thickness t_e, displacement of instability [m], period T_p [s], participation gamma; a [N m], b [N m], J [kg m^2]."""

    effective: float
    instability: float
    period: float
    participation: float
    a: float
    b: float
    inertia: float


def one_way(height: float, thickness: float, weight: float, load: float) -> OneWay:
    """NZSEE C8: a wall of weight W [N] under a load P [N], cracked at mid height, at rest without inclination (psi 0)."""
    effective = thickness * (0.975 - 0.025 * load / weight)
    half, arm = 0.5 * weight, 0.25 * height
    offset = 0.5 * effective  # e_o, e_b, e_t
    a = half * arm + half * (height - 0.25 * height) + load * height
    b = half * offset + half * 3.0 * offset + load * 3.0 * offset
    own = 2.0 * half / GRAVITY / 12.0 * ((0.5 * height) ** 2 + effective**2)
    inertia = own + half / GRAVITY * (offset**2 + arm**2) + half / GRAVITY * ((3.0 * offset) ** 2 + arm**2)
    inertia += load / GRAVITY * (3.0 * offset) ** 2
    participation = 2.0 * half * arm * height / (2.0 * GRAVITY * inertia)
    return OneWay(effective, b * height / (2.0 * a), float(4.07 * np.sqrt(inertia / a)), participation, a, b, inertia)


def _part_coefficient(
    part: Part, height: float, period: float, spectrum: Callable[[float, float], float] | None
) -> tuple[float | None, str]:
    """C_p(T_p) [m/s^2] of a part at a height [m], None without a spectrum, and its factors in words; of a part shaken by its floor the
    response at T_p."""
    if part.shaken:
        return None if spectrum is None else spectrum(period, 0.05), ", C_p is the response to the motion of the floor at T_p"
    building = part.building or part.place + (part.height or 0.0)
    at, by = height_coefficient(height, building), shape_coefficient(period)
    return (None if spectrum is None else spectrum(0.0, 0.05) * at * by), f", C_Hi {at:.3g}, C_i {by:.3g}"
