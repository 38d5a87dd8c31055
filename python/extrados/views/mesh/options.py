"""How a building is cut into finite elements: [analysis.mesh]."""

from typing import Literal

from pydantic import model_validator

from extrados.model.places import Range
from extrados.schema.quantities import Length
from extrados.schema.table import Table, key

LARGEST_MESH = 2_000_000  # elements


class Refinement(Table):
    """Smaller elements within a range of x or y."""

    x: Range | None = key(None, "[from, to]")
    y: Range | None = key(None, "[from, to]")
    size: Length = key(about="size of the elements there", gt=0)


class MeshOptions(Table):
    """Kind, size and pattern of the elements."""

    size: Length | None = key(
        None, "wanted size of the elements; default a twentieth of a wall's lesser side, an eighth of the median joint of stones", gt=0
    )
    joints: Literal["interfaces", "rows"] | None = key(
        None,
        "of stones: joints of no thickness, which open and slide, or thin rows of elements, which only open; default "
        "interfaces. A panel has stones where this is given, and its unit is",
    )
    joint_thickness: Length | None = key(
        None,
        "thickness of the row of elements along each joint between stones; default 1/25 of the size, and at most a fifth "
        "of the shortest element along a joint. The stiffness of interfaces is by default that of the stone over it",
        gt=0,
    )
    element: Literal["T3", "T6", "Q4", "Q8"] = key("Q4", "kind of element; stones have triangles where quadrilaterals do not fit")
    pattern: Literal["structured", "random"] = key(
        "structured", "structured grid, or triangles on randomly moved points (no mesh lines for cracks to follow)"
    )
    seed: int = key(1, "of the random pattern", ge=0, le=2**31 - 1)
    refine: list[Refinement] = key([], "ranges with smaller elements", max_length=100)
    lines_x: list[Length] = key([], "further mesh lines at these x", max_length=2000)
    lines_y: list[Length] = key([], "further mesh lines at these y", max_length=2000)
    selective: bool = key(False, "Q4 with the shear strain of the element's middle (no shear locking)")

    @model_validator(mode="after")
    def _triangles(self) -> "MeshOptions":
        if self.pattern == "random" and self.element not in ("T3", "T6"):
            raise ValueError(f'a random pattern has triangles: element is {self.element}, expected "T3" or "T6"')
        return self
