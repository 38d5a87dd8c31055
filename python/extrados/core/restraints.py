"""Restraints of rocking structures in the core (fortran/rocking/restraint): laws, and the paths on which they act."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import real
from extrados.core.errors import check
from extrados.core.mechanism import Links, core_links
from extrados.core.rocking import Body

#: What a path measures, by the numbers of fortran/mechanism/path: the length of a line, the turn of one part against another
LENGTH, TURN = 1, 2
#: Stands for no bound
FREE = float(np.finfo(float).max)


@dataclass(frozen=True)
class Law:
    """Force on a path against its growth: prestress + stiffness u between `least` and `most`, and viscous |u'|^power.

    u is a length [m] or a turn [rad]: stiffness [N/m or N m/rad], prestress, most and least [N or N m], viscous
    [N (s/m)^power or N m (s/rad)^power]. slack: 1 where it is slack below `least` (a tie), -1 above `most` (a strut); 0
    where it yields at both bounds.
    """

    stiffness: float = 0.0
    prestress: float = 0.0
    most: float = FREE
    least: float = -FREE
    slack: int = 0
    viscous: float = 0.0
    power: float = 1.0

    @property
    def numbers(self) -> list[float]:
        """The flat list of the core."""
        return [self.stiffness, self.prestress, self.most, self.least, float(self.slack), self.viscous, self.power]


def paths(linkage: Links, sort: npt.ArrayLike, ends: npt.ArrayLike, points: npt.ArrayLike, reach: npt.ArrayLike) -> np.ndarray:
    """Paths of a mechanism as the core keeps them; CoreError where its hinges part before the last rotation.

    sort (n): LENGTH or TURN; ends (n, 2): parts at both ends, 0 the ground; points (n, 2, 2): x, y of both ends at rest
    [m]; reach: last rotation and scale of the table (numbers 2 and 3 of core.mechanism.Table) [rad].
    """
    n = np.size(sort)
    length = _core.api_mechanism.path_length(n)
    mass, centroid, inertia, *links = core_links(linkage)
    table, status = _core.api_mechanism.paths(
        np.asfortranarray(np.vstack([mass, centroid, inertia])),
        *links,
        np.asfortranarray(np.vstack([np.transpose(ends), np.ravel(sort)]), dtype=np.int32),
        real("points", np.transpose(points, (2, 1, 0)), (2, 2, n)),
        real("reach", reach, (2,)),
        int(length),
    )
    check(status, "paths of the mechanism")
    return table


def restrained_body(
    bare: Body,
    laws: Sequence[Law] = (),
    tables: tuple[np.ndarray, np.ndarray] | None = None,
    *,
    open_sides: tuple[bool, bool] = (True, True),
    rebound: tuple[float, float] = (0.0, 0.0),
) -> Body:
    """A rocking structure with restraints, and with a wall on a side that is not open.

    tables: paths rocking to +x (n) and to -x (m), of all laws in the core's order; rebound: rate after over before where it is thrown back to +x, -x.
    """
    if not any(open_sides) or not all(0.0 <= r <= 1.0 for r in rebound):
        raise ValueError(f"open side is {open_sides} and rebound is {rebound}: expected a valid open side, and a rebound from 0 to 1")
    if bool(laws) != (tables is not None):
        raise ValueError("each law of a restraint requires a path, and each path a law")
    numbers = [
        [bare.kind, len(bare.parameters)],
        bare.parameters,
        [float(side) for side in open_sides],
        rebound,
        [len(laws)],
        *(law.numbers for law in laws),
        *(tables or ()),
    ]
    return Body(lists.number("rocking_body", "restrained"), np.concatenate([np.asarray(x, dtype=float) for x in numbers]), len(laws))
