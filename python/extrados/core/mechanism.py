"""Mechanisms of rigid parts in the core (fortran/mechanism): tables of their equation of motion, motion, impact.

`linkage` is a limit.linkage.Linkage: rigid parts on hinges with one degree of freedom.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import real
from extrados.core.errors import check
from extrados.core.rocking import Body


class Links(Protocol):
    """What the core needs of a linkage, see limit.linkage.Linkage.

    mass (parts) [kg], centroid (parts, 2) [m], inertia (parts) [kg m^2]; point (hinges, 2) [m], joined (hinges, 2);
    row (3 parts - 1, 2).
    """

    @property
    def side(self) -> int: ...
    @property
    def mass(self) -> np.ndarray: ...
    @property
    def centroid(self) -> np.ndarray: ...
    @property
    def inertia(self) -> np.ndarray: ...
    @property
    def joined(self) -> np.ndarray: ...
    @property
    def point(self) -> np.ndarray: ...
    @property
    def row(self) -> np.ndarray: ...
    @property
    def driver(self) -> int: ...
    @property
    def sense(self) -> int: ...


@dataclass(frozen=True)
class Table:
    """The equation of motion of a mechanism on one side, as the core keeps it, and what became known meanwhile.

    critical: rotation of unstable equilibrium; limit: rotation taken as collapse; lock: the greatest that the
    hinges allow [rad], 1.6 where they do not lock before. mass M [kg m^2], gravity_moment V' [N m], drive H [kg m]:
    at rest. misfit, energy: greatest relative difference of table and kinematics, of M, V', H and of V, M'.
    """

    numbers: np.ndarray
    critical: float
    limit: float
    lock: float
    mass: float
    gravity_moment: float
    drive: float
    misfit: float
    energy: float


def core_links(linkage: Links) -> tuple[Any, ...]:
    """The arguments by which the facades describe a linkage."""
    n, h = len(linkage.mass), len(linkage.joined)
    return (
        real("part mass", linkage.mass, (n,)),
        real("part centroid", np.transpose(linkage.centroid), (2, n)),
        real("part inertia", linkage.inertia, (n,)),
        np.asfortranarray(np.transpose(linkage.joined), dtype=np.int32),
        real("hinge", np.transpose(linkage.point), (2, h)),
        np.asfortranarray(np.transpose(linkage.row), dtype=np.int32),
        int(linkage.driver),
        int(linkage.sense),
    )


def table(linkage: Links) -> Table:
    """Tabulate the mechanism from rest to past its collapse; CoreError where gravity does not hold it shut."""
    numbers, facts, status = _core.api_mechanism.tabulate(*core_links(linkage), int(linkage.side), int(_core.api_mechanism.table_length()))
    check(status, "motion of the mechanism")
    return Table(numbers, *(float(x) for x in facts))


@dataclass(frozen=True)
class Coefficients:
    """M [kg m^2], M'/2 [kg m^2], V' [N m], H [kg m] and V [J] at rotations q [rad]; NaN past the end of the table."""

    mass: np.ndarray
    half_mass_slope: np.ndarray
    gravity_moment: np.ndarray
    drive: np.ndarray
    potential: np.ndarray


def coefficients(side: Table, q: npt.ArrayLike) -> Coefficients:
    """What the integrator sees of one side at rotations q (n) [rad]."""
    values, inside, status = _core.api_mechanism.evaluate(side.numbers, real("q", np.atleast_1d(q), (None,)))
    check(status, "table of the mechanism")
    return Coefficients(*np.where(inside != 0, values, np.nan))


def follow(linkage: Links, q: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places (len(q), parts, 3) of the centroids x, y [m] and rotation [rad], and their first and second derivatives
    by q; NaN where the hinges cannot be closed."""
    rotations = real("q", np.atleast_1d(q), (None,))
    order = np.argsort(rotations, kind="stable")
    *arrays, reached, status = _core.api_mechanism.follow(*core_links(linkage), rotations[order])
    check(status, "motion of the mechanism")
    out = []
    for array in arrays:
        back = np.full((len(rotations), len(linkage.mass), 3), np.nan)
        back[order[:reached]] = array.transpose(2, 1, 0)[:reached]
        out.append(back)
    return out[0], out[1], out[2]


def restitution(mass: npt.ArrayLike, inertia: npt.ArrayLike, before: npt.ArrayLike, after: npt.ArrayLike) -> float:
    """c_v of the impact that closes the mechanism `before` and opens `after`, by workless impulses; may be negative.

    mass (n), inertia (n) of the blocks; before, after (n, 3): velocities x, y, spin at rest per unit rate.
    """
    n = np.size(mass)
    return float(
        _core.api_mechanism.restitution(
            real("mass", mass, (n,)),
            real("inertia", inertia, (n,)),
            real("before", np.transpose(before), (3, n)),
            real("after", np.transpose(after), (3, n)),
        )
    )


def inelastic_blow(
    mass: npt.ArrayLike,
    inertia: npt.ArrayLike,
    centroid: npt.ArrayLike,
    sides: npt.ArrayLike,
    ends: npt.ArrayLike,
    frame: npt.ArrayLike,
    before: npt.ArrayLike,
) -> np.ndarray:
    """Velocities (n, 3) x, y, spin of blocks after an impact without rebound at all joints (Moreau 1988).

    mass, inertia (n), centroid (n, 2) of the blocks; sides (joints, 2): blocks 0 to n-1 on both sides, -1 for the
    ground; ends (joints, 2, 2): x, y of both ends; frame (joints, 2, 2): unit normal into the first block, tangent;
    before (n, 3).
    """
    n = np.size(mass)
    side = np.asarray(sides)
    joints = len(side)
    if side.size and (side.min() < -1 or side.max() >= n):
        raise ValueError(f"sides of hinges must lie between -1 and {n - 1}")
    frames = np.asarray(frame, dtype=float)
    after, status = _core.api_mechanism.blow(
        real("mass", mass, (n,)),
        real("inertia", inertia, (n,)),
        real("centroid", np.transpose(centroid), (2, n)),
        np.asfortranarray(side.T + 1, dtype=np.int32),
        real("ends", np.transpose(ends, (2, 1, 0)), (2, 2, joints)),
        real("normal", frames[:, 0].T, (2, joints)),
        real("tangent", frames[:, 1].T, (2, joints)),
        real("before", np.transpose(before), (3, n)),
    )
    check(status, "impact at the joints")
    return after.T


def table_body(right: Table, left: Table, restitution: tuple[float, float]) -> Body:
    """The structure that rocks to +x by one table and to -x by the other.

    restitution: rate after over rate before the impacts that start rocking to +x and to -x; above 1 only where
    the coordinates of the two sides count differently, never so that energy grows.
    """
    energies = [restitution[0] ** 2 * right.mass / left.mass, restitution[1] ** 2 * left.mass / right.mass]
    if min(restitution) < 0.0 or max(energies) > 1.0 + 1e-9:
        raise ValueError(f"restitution is {restitution}: expected 0 or above, and an impact must not create energy")
    return Body(lists.number("rocking_body", "table"), np.concatenate([restitution, right.numbers, left.numbers]))
