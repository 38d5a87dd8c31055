"""How a building is cut into flat shells: [analysis.mesh]."""

from typing import Literal

from pydantic import model_validator

from extrados.schema.quantities import Length
from extrados.schema.table import Table, key


class ShellOptions(Table):
    """How a building is cut into shells: [analysis.mesh]."""

    size: Length | None = key(
        None, "target size of the elements; default: the lesser of 1/10 of the lowest storey and 1/8 of the shortest wall", gt=0
    )
    layers: int = key(5, "number of integration points through the thickness; 2 are enough for walls that do not bend", ge=1, le=15)
    through: Literal["gauss", "lobatto"] = key(
        "lobatto", "integration rule through the thickness; the Lobatto rule has a point on each face"
    )
    selective: bool = key(False, "whether quadrilaterals use the in-plane shear strain of their middle, which avoids shear locking")

    @model_validator(mode="after")
    def _bends(self) -> "ShellOptions":
        least = 2 if self.through == "gauss" else 3
        if self.layers < least:
            raise ValueError(f"`layers` is {self.layers}, but bending requires at least {least} points of the {self.through} rule")
        return self
