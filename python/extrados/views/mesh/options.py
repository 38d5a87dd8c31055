"""How a building is cut into finite elements: [analysis.mesh]."""

from typing import Literal

from pydantic import model_validator

from extrados.model.places import Range
from extrados.schema.quantities import Length
from extrados.schema.table import Table, key

LARGEST_MESH = 2_000_000  # elements


class Refinement(Table):
    """Smaller elements within a range of x or y."""

    x: Range | None = key(None, "range [from, to] of x")
    y: Range | None = key(None, "range [from, to] of y")
    size: Length = key(about="size of the elements in this range", gt=0)


class MeshOptions(Table):
    """Kind, size and pattern of the elements."""

    size: Length | None = key(
        None,
        "target size of the elements; default: 1/20 of the lesser side of the wall; for blocks, 1/8 of the median length of a joint",
        gt=0,
    )
    joints: Literal["interfaces", "rows"] | None = key(
        None,
        "for blocks: interfaces (joints without thickness), which open and slide, or thin rows of elements, which only open; default: "
        "interfaces. A panel is divided into blocks if this key and the size of its unit are given",
    )
    joint_thickness: Length | None = key(
        None,
        "thickness of the row of elements along each joint between blocks; default: 1/25 of `size`, and at most 1/5 of the shortest "
        "element along a joint. The default stiffness of interfaces is that of the block material with this thickness",
        gt=0,
    )
    element: Literal["T3", "T6", "Q4", "Q8"] = key("Q4", "kind of element; blocks also have triangles if quadrilaterals do not fit")
    pattern: Literal["structured", "random"] = key(
        "structured",
        "pattern of the mesh. structured: structured grid; random: triangles on randomly moved points (without mesh "
        "lines that cracks could follow)",
    )
    seed: int = key(1, "seed of the random pattern", ge=0, le=2**31 - 1)
    refine: list[Refinement] = key([], "ranges with smaller elements", max_length=100)
    lines_x: list[Length] = key([], "x of additional mesh lines", max_length=2000)
    lines_y: list[Length] = key([], "y of additional mesh lines", max_length=2000)
    selective: bool = key(False, "whether Q4 elements use the shear strain of their middle, which avoids shear locking")

    @model_validator(mode="after")
    def _triangles(self) -> "MeshOptions":
        if self.pattern == "random" and self.element not in ("T3", "T6"):
            raise ValueError(f'a random pattern consists of triangles, but `element` is {self.element}: give "T3" or "T6"')
        return self
