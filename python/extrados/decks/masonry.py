"""Columns of blocks and walls of units: assemblies for limit analysis and discrete elements."""

from typing import ClassVar, Literal

from pydantic import model_validator

from extrados.decks.quantities import Density, Length
from extrados.decks.table import Structure, key


class Column(Structure):
    """Blocks or drums stacked on the ground, tapered where asked for; dry joints between them."""

    kind: Literal["column"]
    starter: ClassVar = {"height": "4.0"}
    width: Length = key(about="width at the base", gt=0)
    height: Length | None = key(None, "total height, shared equally by the drums", gt=0)
    drums: int = key(1, "number of equal drums", ge=1, le=2000)
    heights: list[Length] = key([], "heights of the drums from below, instead of height and drums", max_length=2000)
    top_width: Length | None = key(None, "width at the top; default as at the base", gt=0)
    density: Density = key(2000.0, "density of the stone", gt=0, le=30000)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="after")
    def _one_height(self) -> "Column":
        if (self.height is None) == (not self.heights):
            raise ValueError("give height (and drums), or heights, one of the two")
        if self.heights and self.drums != 1:
            raise ValueError("heights already tells the number of drums")
        if any(h <= 0.0 for h in self.heights):
            raise ValueError("every one of heights must be above zero")
        return self


class BrickWall(Structure):
    """Wall of equal units in running bond on the ground, loaded in its plane; half units close every other course."""

    kind: Literal["wall"]
    unit_length: Length = key(about="length of a unit", gt=0)
    unit_height: Length = key(about="height of a unit", gt=0)
    units: int = key(about="units in a course", ge=1, le=500)
    courses: int = key(about="number of courses", ge=1, le=500)
    density: Density = key(1800.0, "density of the units", gt=0, le=30000)
    depth: Length = key(0.25, "thickness of the wall", gt=0)

    @model_validator(mode="after")
    def _not_too_many(self) -> "BrickWall":
        if self.units * self.courses > 20000:
            raise ValueError(f"{self.units * self.courses} units are too many, expected at most 20000")
        return self
