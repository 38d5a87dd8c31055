"""Finite-element walls: `panel` (built-in mesher) and `mesh` (from a file), with materials, supports and ties."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from extrados.decks.quantities import Angle, Density, Energy, Length, Stress, parse
from extrados.decks.table import Structure, Table, key

LARGEST_MESH = 2_000_000  # elements


def _range(value: Any) -> Any:
    """A place along an axis: one length, or [from, to]."""
    ends = value if isinstance(value, list) else [value, value]
    if len(ends) != 2:
        raise ValueError("expected one length, or two as [from, to]")
    out = []
    for end in ends:
        if isinstance(end, bool) or not isinstance(end, int | float | str):
            raise ValueError("expected a length such as 1.2 or '20 mm', or two as [from, to]")
        out.append(parse(end, "m") if isinstance(end, str) else float(end))
    if out[0] > out[1]:
        raise ValueError(f"the range runs backward: from {out[0]:g} m to {out[1]:g} m")
    return out


Range = Annotated[list[float], BeforeValidator(_range), Field(json_schema_extra={"unit": "m"})]


class Placed(Table):
    """Something on the nodes of an edge, within ranges of x and y, or (x and y single) on the nearest node."""

    edge: Literal["left", "right", "bottom", "top"] | None = key(None, "an outer edge")
    x: Range | None = key(None, "x of the place, or [from, to]")
    y: Range | None = key(None, "y of the place, or [from, to]")

    @model_validator(mode="after")
    def _somewhere(self) -> "Placed":
        if self.edge is None and self.x is None and self.y is None:
            raise ValueError("the place is missing: expected edge, x or y")
        return self


class Material(Table):
    """Elastic constants, and the strengths of what may crack or crush."""

    young: Stress = key(about="modulus of elasticity, E0", gt=0)
    poisson: float = key(0.2, "Poisson's ratio", ge=0, lt=0.5)
    density: Density = key(0.0, "density; gravity needs it", ge=0, le=30000)
    tensile_strength: Stress | None = key(None, "tensile strength, ft; without it the material stays linear", gt=0)
    fracture_energy: Energy | None = key(None, "energy of a crack per area, Gf", gt=0)
    softening: Literal["linear", "exponential", "hordijk"] = key(
        "linear", "how the stress falls after the strength", source="thesis Fig. 4-1"
    )
    compressive_strength: Stress | None = key(None, "compressive strength; without it crushing is left out", gt=0)
    crushing_energy: Energy | None = key(None, "energy of crushing per area, Gc", gt=0)
    crushing: Literal["linear", "exponential", "hordijk"] = key("linear", "softening in compression")
    lateral_reduction: bool = key(
        False, "reduce ft under lateral compression, s1/ft - s2/fc <= 1; needs compressive_strength"
    )

    @model_validator(mode="after")
    def _complete(self) -> "Material":
        if (self.tensile_strength is None) != (self.fracture_energy is None):
            raise ValueError("tensile_strength and fracture_energy go together: one of them is missing")
        if self.crushing_energy is not None and self.compressive_strength is None:
            raise ValueError("crushing_energy needs compressive_strength")
        if self.lateral_reduction and self.compressive_strength is None:
            raise ValueError("lateral_reduction needs compressive_strength")
        return self


class Region(Placed):
    """Elements whose centres lie within x and y differ from the rest."""

    material: str | None = key(None, "a name of [structure.materials]")
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


class Refinement(Table):
    """Smaller elements within a range of x or y."""

    x: Range | None = key(None, "[from, to]")
    y: Range | None = key(None, "[from, to]")
    size: Length = key(about="size of the elements there", gt=0)


class Support(Placed):
    """Nodes that are held."""

    fix: Literal["x", "y", "xy"] = key("xy", "directions that are held")
    stiffness: Annotated[float, Field(gt=0)] | None = key(None, "spring in N/m at each node instead of a rigid support")


class Tie(Placed):
    """Nodes that move as one in a direction: an edge that stays planar."""

    direction: Literal["x", "y"] = key(about="direction of the common displacement")


class Bar(Table):
    """A straight bar between the nodes nearest to two places (a tie rod, a reinforcement)."""

    start: list[Length] = key(about="[x, y] of one end", min_length=2, max_length=2)
    end: list[Length] = key(about="[x, y] of the other end", min_length=2, max_length=2)
    area: Annotated[float, Field(gt=0)] = key(about="cross-section in m^2")
    material: str = key(about="a name of [structure.materials]")


class Wall(Structure):
    """What all finite-element walls share."""

    thickness: Length = key(about="thickness out of plane", gt=0)
    material: Material = key(about="the table [structure.material]")
    materials: dict[str, Material] = key({}, "further materials by name", max_length=100)
    regions: list[Region] = key([], "parts that differ; a later one overrides an earlier", max_length=1000)
    supports: list[Support] = key(about="held nodes, [[structure.supports]]", min_length=1, max_length=1000)
    ties: list[Tie] = key([], "nodes that move as one", max_length=100)
    bars: list[Bar] = key([], "bars between two places", max_length=1000)
    selective: bool = key(False, "Q4 with the shear strain of the element's middle (no shear locking)")

    @model_validator(mode="after")
    def _names(self) -> "Wall":
        for part in (*self.regions, *self.bars):
            if part.material is not None and part.material not in self.materials:
                known = ", ".join(sorted(self.materials)) or "none"
                raise ValueError(f"unknown material '{part.material}'; [structure.materials] holds {known}")
        return self


class Panel(Wall):
    """A rectangular wall or beam with rectangular openings and notches, meshed here; x from left, y from bottom."""

    kind: Literal["panel"]
    starter: ClassVar = {
        "thickness": '"30 cm"',
        "material": '{ young = "6.9 GPa", poisson = 0.25, density = 1900, tensile_strength = "0.2 MPa", '
        'fracture_energy = "50 N/m" }',
        "supports": '[{ edge = "bottom" }]',
        "width": "3.0",
        "height": "3.0",
        "size": '"15 cm"',
        "openings": "[{ x = [1.05, 1.95], y = [0.9, 2.1] }]",
    }
    width: Length | None = key(None, "length along x; needed unless an outline is given", gt=0)
    height: Length | None = key(None, "length along y; needed unless an outline is given", gt=0)
    element: Literal["T3", "T6", "Q4", "Q8"] = key("Q4", "kind of element")
    size: Length = key(about="wanted size of the elements", gt=0)
    mesh: Literal["structured", "random"] = key(
        "structured", "structured grid, or triangles on randomly moved points (no mesh lines for cracks to follow)"
    )
    seed: int = key(1, "of the random mesh", ge=0, le=2**31 - 1)
    openings: list[Opening] = key([], "rectangles cut out", max_length=1000)
    refine: list[Refinement] = key([], "ranges with smaller elements", max_length=100)
    lines_x: list[Length] = key([], "further mesh lines at these x", max_length=2000)
    lines_y: list[Length] = key([], "further mesh lines at these y", max_length=2000)
    outline: str | None = key(
        None, "DXF file of closed polylines: the outer one and the openings; replaces width, height, openings"
    )
    outline_unit: Literal["m", "cm", "mm", "in", "ft"] | None = key(None, "unit of the drawing where it names none")

    @model_validator(mode="after")
    def _sensible(self) -> "Panel":
        if self.mesh == "random" and self.element not in ("T3", "T6"):
            raise ValueError(f'a random mesh has triangles: element is {self.element}, expected "T3" or "T6"')
        if self.outline and self.element not in ("T3", "T6"):
            raise ValueError(f'an outline is filled with triangles: element is {self.element}, expected "T3" or "T6"')
        if self.outline:
            given = {"width", "height", "openings", "lines_x", "lines_y", "refine"} & self.model_fields_set
            if given:
                raise ValueError(f"an outline replaces {', '.join(sorted(given))}: give one or the other")
            return self
        if self.width is None or self.height is None:
            raise ValueError("width and height are missing (or an outline)")
        smallest = min([self.size, *(r.size for r in self.refine)])
        count = self.width * self.height / smallest**2
        if count > LARGEST_MESH:
            raise ValueError(
                f"about {count:.2g} elements of {smallest:g} m: the most are {LARGEST_MESH:g}; use larger elements"
            )
        for o in self.openings:
            if o.x[1] <= 0 or o.x[0] >= self.width or o.y[1] <= 0 or o.y[0] >= self.height:
                raise ValueError(f"the opening x {o.x}, y {o.y} lies outside the panel")
        return self


class Mesh(Wall):
    """A wall from a mesh file (gmsh, Abaqus and others; needs the extra `extrados[mesh]`)."""

    kind: Literal["mesh"]
    starter: ClassVar = {
        "thickness": '"30 cm"',
        "material": '{ young = "6.9 GPa", poisson = 0.25, density = 1900, tensile_strength = "0.2 MPa", '
        'fracture_energy = "50 N/m" }',
        "supports": '[{ edge = "bottom" }]',
        "file": '"wall.msh"',
        "scale": "0.001",
    }
    file: str = key(about="mesh file of triangles or quadrilaterals in the x, y plane", min_length=1, max_length=1000)
    scale: float = key(1.0, "metres per unit of the file", gt=0, le=1e6)
