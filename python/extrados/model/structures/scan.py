"""A point cloud of a wall or a barrel vault as blocks: what the deck says of its courses."""

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.geometry.clouds import fit_barrel, fit_wall, uncertain
from extrados.model.geometry.solids.assembly import SolidAssembly, assemble
from extrados.model.geometry.solids.scanned import blocks_of_barrel, blocks_of_wall
from extrados.schema.quantities import Angle, Length
from extrados.schema.table import Table, key

EMPTY = 0.02  # share of the cells of a face without points from which openings are mentioned
POINTS_A_CELL = 20


class Scan(Table):
    """How the blocks of a point cloud are cut (`file` = PLY, XYZ, LAS or LAZ)."""

    starter: ClassVar = {"shape": '"wall"', "courses": "10"}
    shape: Literal["wall", "barrel"] = key(
        about="shape of the scanned part: a wall (two plane faces) or a barrel vault or arch (two coaxial cylinders)"
    )
    courses: int | None = key(None, "number of equal courses: over the height of a wall, or around the intrados of a barrel", ge=1, le=2000)
    beds: list[Length] | None = key(
        None, "heights of the bed joints of a wall above its foot, in increasing order; replaces `courses`", min_length=1, max_length=2000
    )
    block_length: Length | None = key(
        None, "length of a block along the course, in running bond, rounded to equal blocks; default: each course is a single block", gt=0
    )
    thickness: Length | None = key(None, "thickness, if the points show only one face of the wall, or only the intrados", gt=0)
    axis: Angle | None = key(
        None,
        "direction of the horizontal axis of a barrel in plan, from +x towards +y; default: direction with the least misfit",
        ge=-360,
        le=360,
    )

    @model_validator(mode="after")
    def _courses(self) -> "Scan":
        if (self.courses is None) == (self.beds is None):
            raise ValueError("expected either `courses` or `beds`")
        if self.shape == "barrel" and self.beds is not None:
            raise ValueError("beds: a barrel has `courses`")
        if self.shape == "wall" and self.axis is not None:
            raise ValueError('`axis` is only for shape = "barrel": remove `axis`')
        if self.beds is not None and (np.diff([0.0, *self.beds]) <= 0.0).any():
            raise ValueError("beds: expected increasing heights above 0")
        return self

    def solids(self, points: np.ndarray, density: float, name: str) -> SolidAssembly:
        """Blocks in space, of a density [kg/m^3], of points (n, 3) [m]; BadGeometry where the shape does not fit."""
        if self.shape == "wall":
            wall = fit_wall(points, self.thickness)
            middle = np.array([1.0, 0.5 * sum(wall.s), 0.5 * sum(wall.z)])
            stones = blocks_of_wall(wall, self.beds or self.courses or 1, self.block_length, density)
            lean = abs(float(np.degrees(np.arctan(0.5 * (wall.back[2] + wall.front[2])))))
            measures = {"thickness_m": float((wall.front - wall.back) @ middle), "lean_deg": lean}
            measures |= {"length_m": wall.s[1] - wall.s[0], "height_m": wall.z[1] - wall.z[0]}
            made, fits = assemble(stones, what=name), wall.fits
            remarks = _openings((points - wall.origin) @ wall.along, points[:, 2] - wall.origin[2], wall.s, wall.z)
        else:
            barrel = fit_barrel(points, self.thickness, None if self.axis is None else float(np.radians(self.axis)))
            stones, seats = blocks_of_barrel(barrel, self.courses or 1, self.block_length, density)
            measures = {"intrados_radius_m": float(barrel.inner[2]), "thickness_m": float(barrel.outer[2] - barrel.inner[2])}
            measures |= {"embrace_deg": float(np.degrees(barrel.angle[1] - barrel.angle[0])), "length_m": barrel.t[1] - barrel.t[0]}
            made, fits, remarks = assemble(stones, what=name, seats=seats), barrel.fits, ()
        notes = tuple(f"{name}: {fit.told()}" for fit in fits)
        remarks += uncertain(fits, measures["thickness_m"])
        return replace(made, measures=measures, notes=(*notes, *made.notes), remarks=(*remarks, *made.remarks))


def _openings(s: np.ndarray, z: np.ndarray, length: tuple[float, float], height: tuple[float, float]) -> tuple[str, ...]:
    """A remark on the part of a wall between its ends [m] that has no points (n), as openings have none."""
    cells = max(1, int(np.sqrt(len(s) / POINTS_A_CELL)))
    count = np.histogram2d(s, z, bins=cells, range=(length, height))[0]
    empty = float(np.mean(count == 0.0))
    if empty < EMPTY:
        return ()
    return ((f"no points cover {100.0 * empty:.2g} % of the wall. Openings are not modelled: the wall is solid there"),)
