"""How walls become macro-elements: [analysis.frame]."""

from typing import Literal

from extrados.schema.quantities import Stress
from extrados.schema.table import Table, key


class FrameOptions(Table):
    """Macro-elements of piers and spandrels: [analysis.frame]."""

    heights: Literal["dolce", "lagomarsino"] = key(
        "dolce",
        "deformable height of piers: Dolce's effective height, or the mean height of the openings beside (outer piers: of "
        "opening and storey)",
        source="Dolce 1991; Lagomarsino and others 2013",
    )
    shear: Literal["least", "mohr-coulomb", "turnsek-cacovic", "reversed", "damage", "none"] = key(
        "least",
        "shear strength of piers: Mohr-Coulomb on the compressed part, Turnsek-Cacovic, or the lesser of both; reversed: that, with "
        "cohesion on the part alone that opens in neither sense; damage: friction with damage and softening; none: flexure alone",
        source="NTC 2018, 7.8.2.2; Circ. 7/2019, C8.7.1.3.1; Gambarotta and Lagomarsino 1997",
    )
    cohesion: Stress | None = key(None, "shear strength of bed joints without pressure, f_v0; default that of [joints]", gt=0)
    friction: float = key(0.4, "coefficient of friction of bed joints in that strength", gt=0, le=1.5, source="EN 1996-1-1")
    diagonal_strength: Stress | None = key(
        None, "tau_0 of diagonal cracking, without pressure; f_t is 1.5 times it", gt=0, source="Circ. 7/2019, C8.7.1.16"
    )
    stiffness: float = key(0.5, "part of the elastic stiffness that cracked masonry has", gt=0, le=1, source="NTC 2018, 7.2.6")
    confidence_factor: float = key(1.0, "divides all strengths", ge=1, le=2)
    sections: Literal[3, 5] = key(5, "sections of a pier, at Gauss-Lobatto points")
    drift_flexure: float = key(
        0.01, "chord rotation of a pier at which flexural strength is lost", gt=0, le=0.1, source="NTC 2018, 7.8.2.2.1"
    )
    drift_shear: float = key(0.005, "that at which shear strength is lost", gt=0, le=0.1, source="NTC 2018, 7.8.2.2.2")
    spandrels: Literal["all", "lintels", "none"] = key(
        "all", "spandrels that couple piers: all, those whose openings have lintels, or none"
    )
    spandrel_drift_tied: float = key(
        0.02,
        "chord rotation at which the flexural strength of a spandrel with a tie or ring beam drops",
        gt=0,
        le=0.1,
        source="Circ. 7/2019, C8.7.1.3.1.1",
    )
    horizontal_strength: Stress | None = key(
        None,
        "compressive strength of masonry along the wall, f_h, of the strut in spandrels with a tie or ring beam; default half of "
        "compressive_strength, a default of this program",
        gt=0,
        source="NTC 2018, 7.8.2.2.4",
    )
    interlocking: float = key(1.0, "phi of spandrels: unit height over overlap", gt=0, le=5, source="Circ. 7/2019, C8.7.1.17")
    spandrel_drift_flexure: float = key(
        0.015, "chord rotation of a spandrel at which its flexural strength drops", gt=0, le=0.1, source="Circ. 7/2019, C8.7.1.3.1.1"
    )
    spandrel_drift_shear: float = key(0.005, "that at which its shear strength drops", gt=0, le=0.1, source="Circ. 7/2019, C8.7.1.3.1.1")
    spandrel_residual: float | None = key(
        None, "part of its strength that a spandrel keeps beyond; default 0.6 with a lintel, 0.1 without", ge=0, le=1
    )
    flange_strength: Stress | None = key(
        None, "shear strength of the vertical section between walls that meet at corners; default the cohesion, unlimited without one", gt=0
    )
    flanges: Literal["effective", "whole", "none"] = key(
        "effective",
        "flanges at corners: effective lifts at most the weight on the effective width of the other wall; whole: its whole pier; none: "
        "corners transfer no vertical force",
        source="after EN 1996-1-1, 5.5.3",
    )
    softening: float = key(0.5, "beta of the law damage: exponent of its resistance beyond the peak", gt=0, lt=2)
    damage_compliance: float = key(3.0, "c_t G of the law damage: inelastic over elastic shear compliance", gt=0, le=100)
    second_order: bool = key(True, "effect of the weight on displaced piers (P-Delta)")
