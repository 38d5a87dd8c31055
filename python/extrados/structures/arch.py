"""The part-circular arch of ring-sector voussoirs (thesis 3.3 and 5.2)."""

from dataclasses import dataclass

import numpy as np

from extrados.structures.assembly import GROUND, Assembly


@dataclass(frozen=True)
class Arch(Assembly):
    """Voussoir i lies between joints i and i + 1; joint 0 is the left springing, joint n the right one.

    The arch centre is the origin, x to the right, y up. radius is that of the centre line, thickness
    the effective one [m]; embrace [rad].
    """

    radius: float
    thickness: float
    embrace: float

    @property
    def voussoirs(self) -> int:
        return len(self.mass)

    @property
    def intrados(self) -> np.ndarray:
        """Intrados ends of the joints (n + 1, 2) [m]."""
        return self.p

    @property
    def extrados(self) -> np.ndarray:
        """Extrados ends of the joints (n + 1, 2) [m]."""
        return self.q


def ring_sector(inner: float, outer: float, angle: float) -> tuple[float, float, float]:
    """Area, distance of the centroid from the centre, and polar moment of area about the centroid.

    inner, outer radius [m], angle [rad].
    """
    area = 0.5 * angle * (outer**2 - inner**2)
    centre = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2) * np.sin(0.5 * angle) / (0.5 * angle)
    polar = 0.25 * angle * (outer**4 - inner**4) - area * centre**2
    return area, centre, polar


def sector_outlines(centre: np.ndarray, inner: float, outer: float, angle: np.ndarray) -> np.ndarray:
    """Counter-clockwise outlines (n, 14, 2) of ring sectors between the joint angles, which fall from left to right."""
    share = np.linspace(0.0, 1.0, 7)
    first, step = angle[:-1, None], np.diff(angle)[:, None]
    along = first + step * share
    up = np.stack([np.cos(along), np.sin(along)], axis=-1)
    return np.concatenate([centre + inner * up, centre + outer * up[:, ::-1]], axis=1)


def make_arch(
    radius: float,
    thickness: float,
    embrace: float,
    voussoirs: int,
    density: float = 2000.0,
    depth: float = 1.0,
) -> Arch:
    """Arch of equal voussoirs with radial joints; embrace in degrees, lengths in m, density in kg/m^3."""
    if not (radius > 0.0 and 0.0 < thickness < 2.0 * radius and 0.0 < embrace <= 360.0 and voussoirs >= 1):
        raise ValueError(
            f"an arch needs 0 < thickness < 2 radius and 0 < embrace <= 360 deg, "
            f"got thickness {thickness} m, radius {radius} m, embrace {embrace} deg"
        )
    beta = np.radians(embrace)
    delta = beta / voussoirs
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    area, centre, polar = ring_sector(inner, outer, delta)
    joint = 0.5 * np.pi + 0.5 * beta - delta * np.arange(voussoirs + 1)
    middle = 0.5 * (joint[:-1] + joint[1:])

    def at(r: float, angle: np.ndarray) -> np.ndarray:
        return r * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    n = voussoirs
    return Arch(
        outlines=list(sector_outlines(np.zeros(2), inner, outer, joint)),
        mass=np.full(n, area * density * depth),
        centroid=at(centre, middle),
        inertia=np.full(n, polar * density * depth),
        p=at(inner, joint),
        q=at(outer, joint),
        a=np.append(np.arange(n), GROUND),
        b=np.append(GROUND, np.arange(n)),
        depth=depth,
        block_names=[f"voussoir {i + 1}" for i in range(n)],
        joint_names=[f"joint {i}" for i in range(n + 1)],
        radius=radius,
        thickness=thickness,
        embrace=beta,
        inward=np.full(n + 1, -1),
        chains={"arch": list(range(n + 1))},
    )
