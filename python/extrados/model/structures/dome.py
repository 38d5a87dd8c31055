"""Domes of stones in rings."""

from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.geometry.solids.assembly import MOST_SOLIDS, SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import loft
from extrados.model.structures.spatial import Spatial
from extrados.schema.quantities import Angle, Length
from extrados.schema.table import key


def make_dome(
    radius: float,
    thickness: float,
    embrace: float,
    rings: int,
    lunes: int,
    oculus: float = 0.0,
    density: float = 2000.0,
    running: bool = False,
) -> SolidAssembly:
    """Spherical dome of flat-faced stones: radius of the middle surface and thickness [m], embrace and oculus [deg].

    Its plan is a polygon as large as the circle; meridians are chords. With an oculus of 0 a stone closes the crown.
    running: rings are set off by half a stone, each stone then spans two facets; else stones stand in lunes.
    """
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    half = np.radians(0.5 * embrace)
    top = np.radians(0.5 * oculus) if oculus > 0.0 else 0.5 * half / (rings + 0.5)
    polar = np.linspace(half, top, rings + 1)
    facets = 2 * lunes if running else lunes
    turn = 2.0 * np.pi / facets
    plan = np.sqrt(turn / np.sin(turn))  # a polygon of the same area as the circle

    def point(r: float, phi: float, k: int) -> list[float]:
        return [plan * r * np.sin(phi) * np.cos(k * turn), plan * r * np.sin(phi) * np.sin(k * turn), r * np.cos(phi)]

    def bed(phi: float, k: int) -> np.ndarray:
        """The corners of a facet's bed, counter-clockwise from above."""
        return np.array([point(inner, phi, k), point(outer, phi, k), point(outer, phi, k + 1), point(inner, phi, k + 1)])

    stones: list[Stone] = []
    seats: list[tuple[int, np.ndarray]] = []
    for ring in range(rings):
        low, high = polar[ring], polar[ring + 1]
        for k in range(lunes):
            first = 2 * k + ring % 2 if running else k
            here = [first, first + 1] if running else [first]
            if ring == 0:
                seats += [(len(stones), bed(low, j)) for j in here]
            parts = [loft(bed(low, j), bed(high, j)) for j in here]
            stones.append(Stone(f"stone {k + 1} of ring {ring + 1}", parts, density))
    if oculus <= 0.0:
        ends = [np.array([point(r, top, k) for k in range(facets)]) for r in (inner, outer)]
        stones.append(Stone("keystone", [loft(*ends)], density))
    return assemble(stones, seats=seats, what="dome")


class Dome(Spatial):
    """Spherical dome of stones in rings on a level springing; closed, or with an oculus at the crown."""

    word: ClassVar = "dome"
    kind: Literal["dome"]
    halved: ClassVar = {"rings": 2, "lunes": 2}
    bonds: ClassVar = {"bond": ("lunes", "running")}
    starter: ClassVar = {"radius": "5.0", "thickness": "0.5", "rings": "8", "lunes": "16"}
    radius: Length = key(about="radius of the middle surface", gt=0, le=1e4)
    thickness: Length = key(about="thickness of the shell", gt=0, le=1e4)
    embrace: Angle = key(180.0, "angle of embrace of a meridian section, from springing to springing", ge=20, le=180)
    oculus: Angle = key(0.0, "angle of embrace of the opening (oculus) at the crown; with 0, a keystone closes it", ge=0, le=170)
    rings: int = key(about="number of rings of blocks from the springing to the crown", ge=1, le=400)
    lunes: int = key(about="number of stones in a ring", ge=4, le=400)
    bond: Literal["lunes", "running"] = key(
        "lunes",
        "position of the head joints. lunes: above each other, as in a dome that is cracked into lunes; "
        "running: every other ring is offset by half a block",
    )
    thickness_factor: float = key(1.0, "effective thickness, divided by the real thickness; 0.8 for worn corners", gt=0, le=1)

    @model_validator(mode="after")
    def _plausible(self) -> "Dome":
        if self.thickness >= self.radius:
            raise ValueError(f"thickness {self.thickness:g} m is not below the radius {self.radius:g} m")
        if self.oculus >= self.embrace - 1.0:
            raise ValueError(
                f"an `oculus` of {self.oculus:g} deg leaves nothing of an `embrace` of {self.embrace:g} deg: give a smaller oculus"
            )
        if self.rings * self.lunes > MOST_SOLIDS:
            raise ValueError(f"rings: the dome would have {self.rings * self.lunes} blocks; at most {MOST_SOLIDS} are allowed")
        return self

    def solids(self, density: float) -> SolidAssembly:
        return make_dome(
            self.radius,
            self.thickness * self.thickness_factor,
            self.embrace,
            self.rings,
            self.lunes,
            self.oculus,
            density,
            self.bond == "running",
        )
