"""How a building is cut into flat shells: [analysis.mesh]."""

from typing import Literal

from pydantic import model_validator

from extrados.schema.quantities import Length
from extrados.schema.table import Table, key


class ShellOptions(Table):
    """How a building is cut into shells: [analysis.mesh]."""

    size: Length | None = key(
        None, "wanted size of the elements; default a tenth of the lowest storey, and an eighth of the shortest wall", gt=0
    )
    layers: int = key(5, "integration points through the thickness; 2 suffice where walls do not bend", ge=1, le=15)
    through: Literal["gauss", "lobatto"] = key("lobatto", "their rule; Lobatto's have one on each face")
    selective: bool = key(False, "quadrilaterals with the in-plane shear strain of their middle (no shear locking)")

    @model_validator(mode="after")
    def _bends(self) -> "ShellOptions":
        least = 2 if self.through == "gauss" else 3
        if self.layers < least:
            raise ValueError(f"layers is {self.layers}: bending needs at least {least} of {self.through}'s points")
        return self
