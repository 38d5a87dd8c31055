"""The part-circular arch of ring-sector voussoirs (thesis 3.3 and 5.2)."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import NoView
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.sectors import ring_sector, sector_outlines
from extrados.model.structure import Structure
from extrados.schema.constants import IN_SPACE
from extrados.schema.quantities import Angle, Length
from extrados.schema.table import key


@dataclass(frozen=True, repr=False)
class ArchAssembly(Assembly):
    """Voussoir i lies between joints i and i + 1; joint 0 is the left springing, joint n the right one.

    The arch centre is the origin, x to the right, y up. radius is that of the centre line, thickness
    the effective one [m]; embrace [rad].
    """

    radius: float
    thickness: float
    embrace: float

    @property
    def voussoirs(self) -> int:
        """Number of voussoirs."""
        return len(self.mass)

    @property
    def intrados(self) -> np.ndarray:
        """Intrados ends of the joints (n + 1, 2) [m]."""
        return self.p

    @property
    def extrados(self) -> np.ndarray:
        """Extrados ends of the joints (n + 1, 2) [m]."""
        return self.q


def make_arch(radius: float, thickness: float, embrace: float, voussoirs: int, density: float = 2000.0, depth: float = 1.0) -> ArchAssembly:
    """Arch of equal voussoirs with radial joints; embrace in degrees, lengths in m, density in kg/m^3."""
    if not (radius > 0.0 and 0.0 < thickness < 2.0 * radius and 0.0 < embrace <= 360.0 and voussoirs >= 1):
        raise ValueError(
            f"an arch requires 0 < thickness < 2 radius and 0 < embrace <= 360 deg, found thickness {thickness} m, radius "
            f"{radius} m, embrace {embrace} deg"
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
    return ArchAssembly(
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


class Arch(Structure):
    """Part-circular arch of equal voussoirs on rigid springings."""

    word: ClassVar = "arch"
    kind: Literal["arch"]
    halved: ClassVar = {"voussoirs": 2, "stones_across": 2}
    radius: Length = key(about="radius of the centre line, R_A", ge=1e-3, le=1e4)
    thickness: Length = key(about="thickness of the ring, t_A", gt=0, le=1e4)
    embrace: Angle = key(about="angle of embrace, beta_A, from springing to springing", ge=20, le=270)
    voussoirs: int = key(about="number of voussoirs, n_A; it determines the joints at which hinges can form", ge=4, le=5000)
    thickness_factor: float = key(
        1.0, "effective thickness, divided by the real thickness; 0.8 for worn corners", source="thesis 5.3.3", gt=0, le=1
    )
    depth: Length = key(1.0, "depth out of plane", gt=0)
    skew: Angle = key(
        0.0,
        "for an arch in space: skew angle in plan between the faces of the arch and a section perpendicular to the "
        "springings; coursing joints remain parallel to the springings",
        gt=-75,
        lt=75,
    )
    stones_across: int = key(
        1, "for an arch in space: number of blocks in a course across the depth; every other course is offset by half a block", ge=1, le=200
    )

    @model_validator(mode="after")
    def _plausible(self) -> "Arch":
        if self.thickness >= self.radius:
            raise ValueError(f"thickness {self.thickness:g} m is not below the radius {self.radius:g} m")
        return self

    def assembly(self, density: float, folder: Path) -> ArchAssembly:
        if self.skew:
            raise NoView(f"a skew arch has no plane section; {IN_SPACE}", ("structure", "skew"))
        return self.section(density)

    def section(self, density: float) -> ArchAssembly:
        """The ring of voussoirs in the plane."""
        return make_arch(self.radius, self.thickness * self.thickness_factor, self.embrace, self.voussoirs, density, self.depth)
