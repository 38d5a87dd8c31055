"""Chimneys of blocks in rings: round, hollow, tapered."""

from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.geometry.solids.assembly import MOST_SOLIDS, SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import loft
from extrados.model.structures.spatial import Spatial
from extrados.schema.quantities import Length
from extrados.schema.table import key


def make_chimney(
    height: float, width: tuple[float, float], thickness: tuple[float, float], rings: int, blocks: int, facets: int, density: float = 2000.0
) -> SolidAssembly:
    """Rings of equal height on the ground: outer diameter over the corners and thickness of the wall at base and top [m].

    The plan is a regular polygon of `facets` sides. A ring has `blocks` blocks, each of facets / blocks facets, those of every
    other ring set off by half a block; one block is a whole ring. The thickness is measured along a radius through a corner.
    """
    levels = np.linspace(0.0, height, rings + 1)
    outer = 0.5 * np.interp(levels, [0.0, height], width)
    inner = outer - np.interp(levels, [0.0, height], thickness)
    turn = 2.0 * np.pi / facets

    def bed(level: int, facet: int) -> np.ndarray:
        """The corners of a facet's bed, counter-clockwise from above."""
        ends = turn * np.array([facet, facet, facet + 1, facet + 1])
        radius = np.array([inner[level], outer[level], outer[level], inner[level]])
        return np.column_stack([radius * np.cos(ends), radius * np.sin(ends), np.full(4, levels[level])])

    each = facets // blocks
    stones = []
    for ring in range(rings):
        offset = ring % 2 * (each // 2)
        for k in range(blocks):
            facets_of = range(offset + k * each, offset + (k + 1) * each)
            parts = [loft(bed(ring, f), bed(ring + 1, f)) for f in facets_of]
            name = f"ring {ring + 1}" if blocks == 1 else f"block {k + 1} of ring {ring + 1}"
            stones.append(Stone(name, parts, density))
    return assemble(stones, ground=[0.0], what="chimney")


class Chimney(Spatial):
    """Round hollow chimney or tower of blocks in rings on level ground; it can be tapered."""

    word: ClassVar = "chimney"
    kind: Literal["chimney"]
    halved: ClassVar = {"rings": 2, "blocks": 2}
    starter: ClassVar = {"height": "12.0", "width": "2.0", "thickness": "0.4", "rings": "6"}
    height: Length = key(about="height", gt=0, le=1e4)
    width: Length = key(about="outer diameter at the base, over the corners of the polygon", gt=0, le=1e4)
    top_width: Length | None = key(None, "outer diameter at the top; default: as at the base", gt=0, le=1e4)
    thickness: Length = key(about="thickness of the wall at the base", gt=0)
    top_thickness: Length | None = key(None, "thickness of the wall at the top; default: as at the base", gt=0)
    rings: int = key(about="number of rings from the ground to the top", ge=1, le=400)
    blocks: int = key(
        1,
        "number of blocks in a ring; every other ring is offset by half a block. 1: each ring is a "
        "single body, for instance if steel bands tie it",
        ge=1,
        le=100,
    )
    facets: int = key(16, "number of flat facets around the circumference: a multiple of twice the number of blocks", ge=3, le=200)

    @property
    def widths(self) -> tuple[float, float]:
        """Outer diameter at base and top [m]."""
        return self.width, self.width if self.top_width is None else self.top_width

    @property
    def thicknesses(self) -> tuple[float, float]:
        """Thickness of the wall at base and top [m]."""
        return self.thickness, self.thickness if self.top_thickness is None else self.top_thickness

    @model_validator(mode="after")
    def _plausible(self) -> "Chimney":
        for place, width, thickness in zip(("base", "top"), self.widths, self.thicknesses, strict=True):
            if thickness >= 0.5 * width:
                raise ValueError(
                    f"thickness {thickness:g} m at the {place} leaves no space for a flue in a width of {width:g} m: give a thickness "
                    "below half of the width"
                )
        if self.blocks == 2:
            raise ValueError("blocks: rings of 2 halves do not interlock; expected 1, or at least 3")
        if self.blocks > 1 and self.facets % (2 * self.blocks):
            raise ValueError(f"facets: {self.facets} is not a multiple of twice the {self.blocks} blocks of a ring")
        if self.rings * self.blocks > MOST_SOLIDS:
            raise ValueError(f"rings: the chimney would have {self.rings * self.blocks} blocks; at most {MOST_SOLIDS} are allowed")
        return self

    def solids(self, density: float) -> SolidAssembly:
        return make_chimney(self.height, self.widths, self.thicknesses, self.rings, self.blocks, self.facets, density)
