"""Columns of drums: stones one upon the other."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from extrados.model.errors import NoView
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.polygons import properties
from extrados.model.structure import RocksAs, Structure
from extrados.schema.constants import IN_SPACE
from extrados.schema.quantities import Force, Length
from extrados.schema.table import key


def stones_and_joints(
    outlines: list[np.ndarray], names: list[str], joints: list[tuple[str, np.ndarray, np.ndarray, int, int]], density: float, depth: float
) -> Assembly:
    """Blocks of straight outlines and their joints (name, p, q, block above or right, block below or left)."""
    mass, centroid, inertia = zip(*(properties(o) for o in outlines), strict=True)
    weight = density * depth
    label, p, q, a, b = zip(*joints, strict=True)
    return Assembly(
        outlines=outlines,
        mass=np.array(mass) * weight,
        centroid=np.array(centroid),
        inertia=np.array(inertia) * weight,
        p=np.array(p),
        q=np.array(q),
        a=np.array(a),
        b=np.array(b),
        depth=depth,
        block_names=names,
        joint_names=list(label),
    )


def make_column(
    width: float, heights: list[float], top_width: float | None = None, density: float = 2000.0, depth: float = 1.0
) -> Assembly:
    """Drums of the given heights [m] on the ground, from `width` at the base to `top_width` [m]."""
    levels = np.concatenate([[0.0], np.cumsum(heights)])
    half = 0.5 * np.interp(levels, [0.0, levels[-1]], [width, width if top_width is None else top_width])
    n = len(heights)
    outlines = [
        np.array([[-half[i], levels[i]], [half[i], levels[i]], [half[i + 1], levels[i + 1]], [-half[i + 1], levels[i + 1]]])
        for i in range(n)
    ]
    joints = [
        ("base" if i == 0 else f"joint {i}", np.array([-half[i], levels[i]]), np.array([half[i], levels[i]]), i, i - 1 if i else GROUND)
        for i in range(n)
    ]
    made = stones_and_joints(outlines, [f"drum {i + 1}" for i in range(n)], joints, density, depth)
    return replace(made, chains={"stack": list(range(n))})


class Column(Structure):
    """Column of blocks or drums stacked on the ground; it can be tapered."""

    word: ClassVar = "column"
    kind: Literal["column"]
    halved: ClassVar = {"drums": 2}
    rocks_as: ClassVar[RocksAs] = "block"
    starter: ClassVar = {"height": "4.0"}
    width: Length = key(
        about="width at the base; for round drums, the diameter over the corners of the facets (or arrises of the flutes)", gt=0
    )
    height: Length | None = key(None, "total height, which is divided equally among the drums", gt=0)
    drums: int = key(1, "number of equal drums", ge=1, le=2000)
    heights: list[Length] = key([], "heights of the drums, from the lowest upwards; replaces `height` and `drums`", max_length=2000)
    top_width: Length | None = key(None, "width at the top; default: as at the base", gt=0)
    depth: Length = key(1.0, "depth out of plane", gt=0)
    section: Literal["rectangle", "round"] = key("rectangle", "cross-section of the drums: rectangle of width and depth, or round")
    sides: int = key(24, "for round drums: number of flat facets, or of flutes, around the circumference", ge=3, le=96)
    flute_depth: Length = key(0.0, "for round drums: depth of the flutes at the base; two flat facets form each flute", ge=0)
    dowels: Annotated[Force, Field(gt=0)] | Literal["unbroken"] | None = key(
        None, 'shear strength of each dowel (on the axis, between two drums); "unbroken": dowels never break'
    )
    dowel_reach: Length | None = key(
        None,
        "for `dem`: length of each dowel in the drum above it. A dowel comes out if the drums separate "
        "by more than this length; default: never",
        gt=0,
    )

    @model_validator(mode="after")
    def _one_height(self) -> "Column":
        if (self.height is None) == (not self.heights):
            raise ValueError("give either the key `height` (with `drums`), or the key `heights`")
        if self.heights and self.drums != 1:
            raise ValueError("the key `heights` already determines the number of drums: remove the key `drums`")
        if any(h <= 0.0 for h in self.heights):
            raise ValueError("heights: each height must be above zero")
        given = self.model_fields_set
        if self.section == "rectangle" and (wrong := given & {"sides", "flute_depth"}):
            raise ValueError(f'`{min(wrong)}` is only for round drums: give section = "round", or remove this key')
        if self.section == "round" and "depth" in given:
            raise ValueError("the key `depth` is only for rectangular drums; the diameter of round drums is the key `width`")
        if self.dowel_reach is not None and self.dowels is None:
            raise ValueError("`dowel_reach` requires dowels: give the shear strength of the dowels")
        if self.flute_depth >= 0.25 * self.width:
            raise ValueError(f"`flute_depth` {self.flute_depth:g} m is not below 1/4 of the width {self.width:g} m")
        return self

    @property
    def drum_heights(self) -> list[float]:
        """Heights of the drums from below [m]."""
        return [self.height / self.drums] * self.drums if self.height is not None else self.heights

    def assembly(self, density: float, folder: Path) -> Assembly:
        if self.section == "round":
            raise NoView(f"a column of round drums has no plane section; {IN_SPACE}", ("structure", "section"))
        if self.dowels is not None:
            raise NoView("dowels exist only in space: give the key `direction` of `tilt`, or remove the dowels", ("structure", "dowels"))
        return make_column(self.width, self.drum_heights, self.top_width, density, self.depth)
