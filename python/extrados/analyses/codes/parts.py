"""Rules of codes for a part of a building out of its plane, beside those of NTC: EN 1998-1 4.3.5, ASCE 41 Table 11-5, NZSEE C8.

Each says what it is for, and answers that it does not apply anywhere else.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes.code_rules import Line
from extrados.schema.constants import GRAVITY

#: EN 1998-1 Table 4.4, q_a: cantilevers, and walls (the same values as Table C7.2.I of Circolare 7/2019)
PART_FACTOR = {"parapet": 1.0, "gable": 1.0, "wall": 2.0, "facade": 2.0}
#: ASCE 41 height over thickness up to which no out-of-plane check is asked, for S_X1 up to 0.24 g, up to 0.37 g, above
SLENDER = {"one-story": (20, 16, 13), "first": (20, 18, 15), "top": (14, 14, 9), "other": (20, 16, 13)}
#: NZSEE C8: usable part of the displacement of instability of a parapet; a wall that spans between floors may use twice as much
USABLE = 0.3


@dataclass(frozen=True)
class Part:
    """What turns: its element (a mechanism of the table), alpha_0, height and thickness [m] above the hinge, None of a chain of stones;
    z [m] and H [m], of a part of a building, else 0 and None; loaded: floors rest on it; anchored: ties hold its top."""

    element: str
    multiplier: float
    height: float | None
    thickness: float | None
    place: float
    building: float | None
    loaded: bool = False
    anchored: bool = False

    @property
    def elevated(self) -> bool:
        """Whether it stands on a building, above the ground."""
        return self.place > 0.0 and self.building is not None


def en1998(part: Part, peak: float | None) -> Line:
    """Action on a non-structural element, F_a = S_a W_a/q_a, against the weight that holds it; peak: a_g S [m/s^2]."""
    q_a, barred, asked = PART_FACTOR.get(part.element), "", None
    if q_a is None:
        barred = f"Table 4.4 gives no q_a for this element ({part.element})"
    elif part.loaded:
        barred = "the wall carries floors: a wall with floors is no non-structural element"
    elif not part.elevated:
        barred = "the part does not stand on a building, above the ground"
    elif peak is not None:
        assert part.building is not None
        asked = peak / GRAVITY * (3.0 * (1.0 + part.place / part.building) / 2.0 - 0.5)
    return Line(
        "EN 1998-1 part of a building", "S_a", None if q_a is None else part.multiplier * q_a, asked, "g",
        "EN 1998-1:2004 4.3.5.2: S_a = a_g S (3 (1 + z/H)/(1 + (1 - T_a/T_1)^2) - 0.5), T_a = 0; Table 4.4: q_a 1 of cantilevers, 2 of "
        "walls (verify clause)", "rigid until it rocks" + ("" if q_a is None else f", q_a {q_a:g}"), "EN 1998-1",
        scope="non-structural element (parapet, gable, wall without floors on it); fixed at its foot; on a building, at z > 0", barred=barred,
    )  # fmt: skip


def asce41(part: Part, s_x1: float, storey: str) -> Line:
    """Height over thickness up to which no out-of-plane check is required; s_x1: spectral acceleration at 1 s [m/s^2]."""
    barred, demand = "", None
    if part.element != "facade" or not part.anchored:
        barred = (
            "Table 11-5 is for walls between anchored diaphragms: "
            + ("nothing anchors the top of this facade" if part.element == "facade" else f"this is none ({part.element})")
        )  # fmt: skip
    if part.height is not None and part.thickness is not None:
        demand = part.height / part.thickness
    limit = SLENDER[storey][0 if s_x1 <= 0.24 * GRAVITY else 1 if s_x1 <= 0.37 * GRAVITY else 2]
    return Line(
        "ASCE 41 slenderness", "h/t", float(limit), demand, "", "ASCE 41-13 Table 11-5 (verify clause)",
        f"{storey}, S_X1 {s_x1 / GRAVITY:.3g} g", "ASCE 41", scope="wall between anchored diaphragms; held at foot and top; any storey",
        barred=barred,
    )  # fmt: skip


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


def nzsee(part: Part, spectrum: Callable[[float, float], float] | None) -> Line:
    """A parapet: displacement of its top, gamma (T_p/2 pi)^2 C_p g with C_p = C(0) C_Hi C_i(T_p), at 0.3 of instability."""
    h, t = float(part.height or 0.0), float(part.thickness or 0.0)
    slope = 1.0 + (t / h) ** 2
    period = float(np.sqrt(0.65 * h * slope))
    barred, demand, note = "", None, f"T_p {period:.3f} s"
    if part.element != "parapet":
        note = ""
        barred = f"the constants are those of a parapet of one thickness, this is none ({part.element})"
    elif not part.elevated:
        barred = "the height of the parapet above the ground is not given (base_height, building_height): its demand is not known"
    else:
        assert part.building is not None
        at, by = height_coefficient(part.place, part.building), shape_coefficient(period)
        note += f", C_Hi {at:.3g}, C_i {by:.3g}"
        if spectrum is not None:
            demand = 1.5 / slope * spectrum(0.0, 0.05) * at * by * (period / (2.0 * np.pi)) ** 2
    return Line(
        "NZSEE C8 parapet", "displacement", USABLE * t if part.element == "parapet" else None, demand, "m",
        "NZSEE/MBIE 2017 C8: D_m = 0.3 D_i, D_i = t, T_p = sqrt(0.65 h (1 + (t/h)^2)), gamma = 1.5/(1 + (t/h)^2) (verify clause); "
        "NZS 1170.5 section 8: C_p = C(0) C_Hi C_i", note, "NZSEE", scope="parapet; cantilever; on a building, at z > 0", barred=barred,
    )  # fmt: skip
