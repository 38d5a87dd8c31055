"""Walls that are given whole, without stones: `panel` (rectangles with openings, or an outline) and `mesh` (a file)."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.building.places import Placed, Range
from extrados.building.structure import Structure
from extrados.schema.quantities import Angle, Length
from extrados.schema.table import Table, key


class Region(Placed):
    """Elements whose centres lie within x and y differ from the rest."""

    material: str | None = key(None, "a name of [materials]")
    linear: bool = key(False, "the elements stay linear")
    thickness: Length | None = key(None, "thickness of the region", gt=0)
    gauss: list[Annotated[int, Field(ge=1, le=4)]] | None = key(
        None, "Gauss points [along, across] of its quadrilaterals", min_length=2, max_length=2
    )
    crack_normal: Angle | None = key(None, "the only direction of crack normals allowed, from x", ge=-180, le=180)


class Opening(Table):
    """A rectangle cut out: an opening, or a notch where it reaches an edge."""

    x: Range = key(about="[from, to]")
    y: Range = key(about="[from, to]")

    @model_validator(mode="after")
    def _area(self) -> "Opening":
        if self.x[0] == self.x[1] or self.y[0] == self.y[1]:
            raise ValueError("an opening needs a width and a height: expected x = [from, to] and y = [from, to]")
        return self


class Tie(Placed):
    """Nodes that move as one in a direction: an edge that stays planar."""

    direction: Literal["x", "y"] = key(about="direction of the common displacement")


class Bar(Table):
    """A straight bar between the nodes nearest to two places (a tie rod, a reinforcement)."""

    start: list[Length] = key(about="[x, y] of one end", min_length=2, max_length=2)
    end: list[Length] = key(about="[x, y] of the other end", min_length=2, max_length=2)
    area: Annotated[float, Field(gt=0)] = key(about="cross-section in m^2")
    material: str = key(about="a name of [materials]")


class Wall(Structure):
    """What all finite-element walls share. starter_beside: values of the other tables in a starter deck."""

    starter_beside: ClassVar = {
        "material": {"tensile_strength": '"0.2 MPa"', "fracture_energy": '"50 N/m"'},
        "analysis": {
            "constant": '[{ kind = "gravity" }, { kind = "pressure", edge = "top", value = "0.1 MPa" }]',
            "reference": '[{ kind = "spread", edge = "top", fx = "1 kN" }]',
            "target_displacement": '"2 mm"',
            "ripple": "0.2",
        },
    }
    thickness: Length = key(about="thickness out of plane", gt=0)
    regions: list[Region] = key([], "parts that differ; a later one overrides an earlier", max_length=1000)
    ties: list[Tie] = key([], "nodes that move as one", max_length=100)
    bars: list[Bar] = key([], "bars between two places", max_length=1000)


class Panel(Wall):
    """A rectangular wall or beam with rectangular openings and notches, meshed here; x from left, y from bottom."""

    kind: Literal["panel"]
    starter: ClassVar = {
        "thickness": '"30 cm"',
        "width": "3.0",
        "height": "3.0",
        "openings": "[{ x = [1.05, 1.95], y = [0.9, 2.1] }]",
    }
    width: Length | None = key(None, "length along x; needed unless an outline is given", gt=0)
    height: Length | None = key(None, "length along y; needed unless an outline is given", gt=0)
    openings: list[Opening] = key([], "rectangles cut out", max_length=1000)
    outline: str | None = key(
        None, "DXF file of closed polylines: the outer one and the openings; replaces width, height, openings"
    )
    outline_unit: Literal["m", "cm", "mm", "in", "ft"] | None = key(None, "unit of the drawing where it names none")

    @model_validator(mode="after")
    def _sensible(self) -> "Panel":
        if self.outline:
            given = {"width", "height", "openings"} & self.model_fields_set
            if given:
                raise ValueError(f"an outline replaces {', '.join(sorted(given))}: give one or the other")
            return self
        if self.width is None or self.height is None:
            raise ValueError("width and height are missing (or an outline)")
        for o in self.openings:
            if o.x[1] <= 0 or o.x[0] >= self.width or o.y[1] <= 0 or o.y[0] >= self.height:
                raise ValueError(f"the opening x {o.x}, y {o.y} lies outside the panel")
        return self


class MeshFile(Wall):
    """A wall from a mesh file (gmsh, Abaqus and others; needs the extra `extrados[mesh]`)."""

    kind: Literal["mesh"]
    starter: ClassVar = {"thickness": '"30 cm"', "file": '"wall.msh"', "scale": "0.001"}
    lacks: ClassVar = dict.fromkeys(
        ("blocks", "rocker"), "a mesh file holds elements, no stones: describe the wall as `panel` or `blocks`"
    )
    file: str = key(about="mesh file of triangles or quadrilaterals in the x, y plane", min_length=1, max_length=1000)
    scale: float = key(1.0, "metres per unit of the file", gt=0, le=1e6)
