"""Bar and anchorage of a tie: section, bearing and punching of the plate, pull-out of an injected anchor.

Equilibrium on design strengths that the deck gives, as in engineering practice; no clause of a code is claimed.
"""

import numpy as np

from extrados.analyses.strengthen.tables import Anchorage
from extrados.results.strengthen import AnchorageCheck


def check_anchorage(force: float, given: Anchorage) -> list[AnchorageCheck]:
    """Capacity [N] of each part, and the size that the force [N] needs.

    Bearing f a b of the plate. Punching tau t 2 (a + b + 2 t), on the faces of a prism through the wall of thickness t, spread by
    t / 2 on every side of the plate. Pull-out tau pi d l.
    """
    found = []
    a, b, t = given.plate_width, given.plate_height, given.wall_thickness
    if given.steel_strength is not None:
        section = force / given.steel_strength
        found.append(AnchorageCheck(part="bar", capacity_N=None, needed=float(np.sqrt(4.0 * section / np.pi)), size="diameter [m]"))
    if a is not None and b is not None:
        if given.compressive_strength is not None:
            # sides in the ratio of the plate given
            side = float(np.sqrt(force / given.compressive_strength * a / b))
            found.append(
                AnchorageCheck(
                    part="bearing of the plate", capacity_N=given.compressive_strength * a * b, needed=side, size="plate width [m]"
                )
            )
        if given.shear_strength is not None and t is not None:
            around = force / (2.0 * given.shear_strength * t)
            found.append(
                AnchorageCheck(
                    part="punching of the wall",
                    capacity_N=given.shear_strength * t * 2.0 * (a + b + 2.0 * t),
                    needed=max((around - 2.0 * t) / (1.0 + b / a), 0.0),
                    size="plate width [m]",
                )
            )
    if given.bond_length is not None and given.bond_diameter is not None and given.bond_strength is not None:
        per_length = given.bond_strength * np.pi * given.bond_diameter
        found.append(
            AnchorageCheck(
                part="pull-out of the anchor", capacity_N=per_length * given.bond_length, needed=force / per_length, size="bond length [m]"
            )
        )
    return found
