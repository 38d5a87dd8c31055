"""Strength of spandrels without a calculated normal force, alone and with a tie or ring beam beside them."""

import numpy as np

from extrados.core.frame import UNLIMITED

#: Share of the compressive strength in the stress block of codes
BLOCK = 0.85
#: Greatest strut of a spandrel over f_h h t (NTC 2018, 7.8.2.2.4)
STRUT = 0.4


def flexural_strength(depth: float, thickness: float, pull: float, pressed: float) -> float:
    """Moment [N m] of a section without normal force: rectangular stress blocks, `pull` in tension, `pressed` in compression [Pa]."""
    area = depth * thickness
    return 0.5 * area * depth * pull * (1.0 if pressed >= UNLIMITED else pressed / (pull + pressed))


def strut_of(depth: float, thickness: float, tie: float, horizontal: float) -> float:
    """Greatest strut H_p [N] that a tie [N] balances: the lesser of its tension and 0.4 f_h h t; f_h `horizontal` [Pa]."""
    return min(tie, UNLIMITED if horizontal >= UNLIMITED else STRUT * horizontal * depth * thickness)


def strut_strength(depth: float, thickness: float, strut: float, horizontal: float) -> float:
    """Moment [N m] of a section under the strut H_p: H_p h/2 (1 - H_p/(0.85 f_h h t)) (NTC 2018, 7.8.2.2.4)."""
    if strut >= UNLIMITED:
        return UNLIMITED
    return 0.5 * strut * depth * (1.0 - strut / (BLOCK * horizontal * depth * thickness))


def shear_strength(depth: float, thickness: float, length: float, cohesion: float, tension: float, strut: float = 0.0) -> float:
    """Shear [N]: h t f_v0, and of diagonal cracking h t f_t/b sqrt(1 + H_p/(h t f_t)), b = l/h within 1 and 1.5. A strength of 0
    is not considered."""
    area = depth * thickness
    limits = [area * cohesion] if cohesion > 0.0 else []
    if tension > 0.0:
        limits.append(area * tension / float(np.clip(length / depth, 1.0, 1.5)) * float(np.sqrt(1.0 + strut / (area * tension))))
    return min(limits, default=0.0)
