"""How walls become macro-elements: [analysis.frame]."""

from typing import Literal

from extrados.schema.quantities import Stress
from extrados.schema.table import Table, key


class FrameOptions(Table):
    """Macro-elements of piers and spandrels: [analysis.frame]."""

    heights: Literal["dolce", "lagomarsino"] = key(
        "dolce",
        "method for the deformable height of piers. dolce: effective height by Dolce; lagomarsino: mean "
        "height of the adjacent openings (for outer piers: mean of opening and storey)",
        source="Dolce 1991; Lagomarsino and others 2013",
    )
    shear: Literal["least", "mohr-coulomb", "turnsek-cacovic", "reversed", "damage", "none"] = key(
        "least",
        "method for the shear strength of piers. mohr-coulomb: on the compressed part; turnsek-cacovic: diagonal cracking; least: the "
        "lesser of both; reversed: as least, but cohesion acts only on the part that opens in neither sense of the load; damage: "
        "friction with damage and softening; none: flexure only",
        source="NTC 2018, 7.8.2.2; Circ. 7/2019, C8.7.1.3.1; Gambarotta and Lagomarsino 1997",
    )
    cohesion: Stress | None = key(None, "f_v0: shear strength of bed joints at zero compression; default: `cohesion` of [joints]", gt=0)
    friction: float = key(0.4, "coefficient of friction of bed joints in the shear strength", gt=0, le=1.5, source="EN 1996-1-1")
    diagonal_strength: Stress | None = key(
        None,
        "tau_0: shear strength for diagonal cracking at zero compression; f_t is 1.5 times tau_0",
        gt=0,
        source="Circ. 7/2019, C8.7.1.16",
    )
    stiffness: float = key(0.5, "stiffness of the cracked masonry, divided by its elastic stiffness", gt=0, le=1, source="NTC 2018, 7.2.6")
    confidence_factor: float = key(1.0, "confidence factor, by which all strengths are divided", ge=1, le=2)
    sections: Literal[3, 5] = key(5, "number of sections of a pier, at Gauss-Lobatto points")
    drift_flexure: float = key(
        0.01, "drift (chord rotation) of a pier at which its flexural strength is lost", gt=0, le=0.1, source="NTC 2018, 7.8.2.2.1"
    )
    drift_shear: float = key(
        0.005, "drift (chord rotation) of a pier at which its shear strength is lost", gt=0, le=0.1, source="NTC 2018, 7.8.2.2.2"
    )
    spandrels: Literal["all", "lintels", "none"] = key(
        "all", "spandrels that couple piers: all, only those above openings with lintels, or none"
    )
    spandrel_drift_tied: float = key(
        0.02,
        "drift (chord rotation) at which the flexural strength of a spandrel drops, if it has a tie or ring beam",
        gt=0,
        le=0.1,
        source="Circ. 7/2019, C8.7.1.3.1.1",
    )
    horizontal_strength: Stress | None = key(
        None,
        "f_h: compressive strength of masonry along the wall, for the strut in spandrels with a tie or "
        "ring beam; default (of this program): half of `compressive_strength`",
        gt=0,
        source="NTC 2018, 7.8.2.2.4",
    )
    interlocking: float = key(
        1.0, "phi of spandrels: height of a unit divided by the overlap of the units", gt=0, le=5, source="Circ. 7/2019, C8.7.1.17"
    )
    spandrel_drift_flexure: float = key(
        0.015,
        "drift (chord rotation) of a spandrel at which its flexural strength drops",
        gt=0,
        le=0.1,
        source="Circ. 7/2019, C8.7.1.3.1.1",
    )
    spandrel_drift_shear: float = key(
        0.005, "drift (chord rotation) of a spandrel at which its shear strength drops", gt=0, le=0.1, source="Circ. 7/2019, C8.7.1.3.1.1"
    )
    spandrel_residual: float | None = key(
        None,
        "share of its strength that a spandrel keeps beyond its drift limit; default 0.6 with a lintel, 0.1 without a lintel",
        ge=0,
        le=1,
    )
    flange_strength: Stress | None = key(
        None, "shear strength of the vertical section between two walls that meet at a corner; default: the cohesion", gt=0
    )
    flanges: Literal["effective", "whole", "none"] = key(
        "effective",
        "flanges at corners. effective: a wall lifts at most the weight on the effective width of the transverse wall; whole: the "
        "weight on the whole pier of the transverse wall; none: corners transfer no vertical force",
        source="after EN 1996-1-1, 5.5.3",
    )
    softening: float = key(0.5, 'for shear = "damage": beta, exponent of the resistance beyond the peak', gt=0, lt=2)
    damage_compliance: float = key(
        3.0, 'for shear = "damage": c_t G, inelastic shear compliance divided by elastic shear compliance', gt=0, le=100
    )
    second_order: bool = key(True, "include the effect of the weight on displaced piers (P-Delta)")
