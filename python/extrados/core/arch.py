"""The four-hinge arch in the core (fortran/arch): impact, mechanism, deformed shape, dynamic thrust line."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core.calls import integers, real
from extrados.core.errors import check


@dataclass(frozen=True)
class FourHinge:
    """The mechanism that rocks to +x; its mirror image rocks to -x.

    hinge (4, 2): A, B, C, D from left to right [m]; joint (4): their joints, 0 = left springing;
    mass [kg], centroid (3, 2) [m] and inertia [kg m^2] of the links AB, BC, CD.
    """

    hinge: np.ndarray
    joint: np.ndarray
    mass: np.ndarray
    centroid: np.ndarray
    inertia: np.ndarray

    def links(self) -> tuple[np.ndarray, np.ndarray]:
        """What the core wants to know of the mechanism: hinges (2, 4); mass, centroid, inertia of the links (4, 3)."""
        return real("hinge", np.transpose(self.hinge), (2, 4)), _masses("link", self, 3)


def _masses(what: str, of: "FourHinge | Voussoirs", count: int) -> np.ndarray:
    """Mass, centroid and inertia of `count` parts as the core's (4, count)."""
    return np.asfortranarray(
        np.vstack(
            [
                real(f"{what} mass", of.mass, (count,)),
                real(f"{what} centroid", np.transpose(of.centroid), (2, count)),
                real(f"{what} inertia", of.inertia, (count,)),
            ]
        )
    )


class Voussoirs(Protocol):
    """What a thrust line needs of an arch: mass [kg], centroid (n, 2) [m], inertia [kg m^2] of its voussoirs and
    the ends of its joints, intrados and extrados (n + 1, 2) [m]."""

    @property
    def mass(self) -> np.ndarray: ...
    @property
    def centroid(self) -> np.ndarray: ...
    @property
    def inertia(self) -> np.ndarray: ...
    @property
    def intrados(self) -> np.ndarray: ...
    @property
    def extrados(self) -> np.ndarray: ...


@dataclass(frozen=True)
class Limits:
    """Critical and locking rotation of link AB [rad]; generalised mass [kg m^2], V' [N m] and H [kg m] at rest."""

    critical: float
    lock: float
    mass: float
    gravity_moment: float
    drive: float


def restitution(
    mass: npt.ArrayLike,
    centroid: npt.ArrayLike,
    inertia: npt.ArrayLike,
    joint: npt.ArrayLike,
    hinge: npt.ArrayLike,
    opposite: npt.ArrayLike,
) -> tuple[float, float]:
    """c_v of the impact: by the thesis (Eqs B.3a-e) and by the workless-impulse projection.

    mass (n), centroid (n, 2), inertia (n) of the voussoirs; joint (4), hinge (4, 2) and the opposite
    faces (4, 2) of A, B, C, D. The thesis' value may exceed 1 where A stands above the springing.
    """
    n = len(np.asarray(mass))
    thesis, projection, status = _core.api_arch.impact(
        real("mass", mass, (n,)),
        real("centroid", np.transpose(centroid), (2, n)),
        real("inertia", inertia, (n,)),
        integers("joint", joint, 4),
        real("hinge", np.transpose(hinge), (2, 4)),
        real("opposite", np.transpose(opposite), (2, 4)),
    )
    check(status, "impact of the arch")
    return float(thesis), float(projection)


def limits(mechanism: FourHinge) -> Limits:
    """How far the mechanism can turn, and its coefficients at rest (thesis Eq. B.2)."""
    *values, status = _core.api_arch.mechanism_limits(*mechanism.links())
    check(status, "four-hinge mechanism")
    return Limits(*(float(value) for value in values))


def pose(mechanism: FourHinge, centroid: npt.ArrayLike, q: npt.ArrayLike) -> np.ndarray:
    """Displaced centroid x, y [m] and rotation [rad] of every voussoir, shape (len(q), n, 3)."""
    n = len(np.asarray(centroid))
    placed, status = _core.api_arch.pose(
        *mechanism.links(),
        integers("joint", mechanism.joint, 4),
        real("centroid", np.transpose(centroid), (2, n)),
        real("q", np.atleast_1d(q), (None,)),
    )
    check(status, "deformed arch")
    return np.transpose(placed)


@dataclass(frozen=True)
class ThrustLine:
    """Forces across the joints at each state, arrays (states, n + 1).

    normal, shear [N]; position 0 at the intrados, 1 at the extrados; point (states, n + 1, 2) [m];
    miss (states): distance of the resultant from hinge D [m], zero up to the integration error.
    """

    normal: np.ndarray
    shear: np.ndarray
    position: np.ndarray
    point: np.ndarray
    miss: np.ndarray

    @property
    def friction(self) -> np.ndarray:
        """Coefficient of friction needed at each joint; infinite in tension, 0 where the state is at rest (NaN)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            needed = np.where(self.normal > 0.0, np.abs(self.shear) / self.normal, np.inf)
        return np.where(np.isnan(self.normal), 0.0, needed)


def thrust_line(
    mechanism: FourHinge,
    arch: Voussoirs,
    q: npt.ArrayLike,
    v: npt.ArrayLike,
    a: npt.ArrayLike,
    horizontal: npt.ArrayLike,
    vertical: npt.ArrayLike,
) -> ThrustLine:
    """Dynamic thrust line (thesis 5.2.3) of the mechanism that rocks to +x.

    At each of the states: rotation q (states) [rad], its rate v [rad/s] and acceleration a [rad/s^2], and the acceleration
    of the ground (states) [m/s^2], horizontal to +x and vertical up.
    """
    n = len(arch.mass)
    faces = np.stack([np.transpose(arch.intrados), np.transpose(arch.extrados)], axis=1)
    normal, shear, position, point, miss, status = _core.api_arch.thrust_line(
        *mechanism.links(),
        integers("joint", mechanism.joint, 4),
        _masses("voussoir", arch, n),
        real("joint ends", faces, (2, 2, n + 1)),
        real("states", [np.asarray(x, dtype=float) for x in (q, v, a, horizontal, vertical)], (5, None)),
    )
    check(status, "dynamic thrust line")
    return ThrustLine(normal.T, shear.T, position.T, point.transpose(2, 1, 0), miss)
