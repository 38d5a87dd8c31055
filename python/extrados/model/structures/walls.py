"""Walls that are given whole, without stones: `panel` (rectangles with openings, or an outline) and `mesh` (a file)."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from extrados.model.errors import NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.places import Placed
from extrados.model.structure import RocksAs, Structure
from extrados.model.structures.brickwork import Laid, make_brickwork
from extrados.model.structures.piers import make_piers
from extrados.schema.quantities import Angle, Force, Length, Stress
from extrados.schema.table import Table, key


class Region(Placed):
    """Elements whose centres lie within x and y differ from the rest."""

    material: str | None = key(None, "material of the region: a name in [materials]")
    linear: bool = key(False, "whether the elements of the region remain linear (no cracks)")
    thickness: Length | None = key(None, "thickness of the region", gt=0)
    gauss: list[Annotated[int, Field(ge=1, le=4)]] | None = key(
        None, "numbers of Gauss points of each quadrilateral [along its first side, across this side]", min_length=2, max_length=2
    )
    crack_normal: Angle | None = key(None, "angle from x to the crack normal, if cracks can have this direction only", ge=-180, le=180)

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which of the points (k, 2) [m] lie within it."""
        inside = np.ones(len(points), dtype=bool)
        for axis, ends in enumerate((self.x, self.y)):
            if ends is not None:
                inside &= (points[:, axis] > ends[0]) & (points[:, axis] < ends[1])
        return inside


class TiedNodes(Placed):
    """Nodes that move as one in a direction: an edge that stays planar."""

    direction: Literal["x", "y"] = key(about="direction of the common displacement")


class Bar(Table):
    """A straight bar between the nodes nearest to two places (a tie rod, a reinforcement)."""

    start: list[Length] = key(about="[x, y] of one end", min_length=2, max_length=2)
    end: list[Length] = key(about="[x, y] of the other end of the bar", min_length=2, max_length=2)
    area: Annotated[float, Field(gt=0)] = key(about="cross-section in m^2")
    material: str = key(about="material of the bar: a name in [materials]")
    bonded: bool = key(
        False, "true: the bar is embedded and moves with each element that it crosses; false: it is attached only at its ends"
    )
    yield_strength: Stress | None = key(
        None, "yield stress of the bar in tension and compression; replaces the strengths of its material", gt=0
    )
    ultimate_strain: float = key(0.05, "strain at which the bar breaks after yielding", gt=0, le=1)


class MeshedWall(Structure):
    """What walls share that finite elements see whole."""

    thickness: Length = key(about="thickness out of plane", gt=0)
    regions: list[Region] = key([], "parts of the wall with other properties; if regions overlap, the last one counts", max_length=1000)
    ties: list[TiedNodes] = key([], "groups of nodes that move together", max_length=100)
    bars: list[Bar] = key([], "bars between two places", max_length=1000)


class Panel(Laid, MeshedWall):
    """Rectangular wall or beam with rectangular openings and notches; x from the left, y from the bottom.

    Finite elements model the wall as a continuum. If the size of the unit is given, analyses of blocks use units in running bond.
    """

    word: ClassVar = "panel"
    kind: Literal["panel"]
    rocks_as: ClassVar[RocksAs] = "piers"
    starter_analysis: ClassVar = "sla"
    starter: ClassVar = {"thickness": '"30 cm"', "width": "3.0", "height": "3.0", "openings": "[{ x = [1.05, 1.95], y = [0.9, 2.1] }]"}
    width: Length | None = key(None, "length along x; required if no outline is given", gt=0)
    height: Length | None = key(None, "length along y; required if no outline is given", gt=0)
    unit_length: Length | None = key(None, "length of a unit (brick or block), for analyses of blocks", gt=0)
    unit_height: Length | None = key(None, "height of a unit (brick or block)", gt=0)
    outline: str | None = key(
        None, "DXF file of closed polylines: the outline of the wall and of the openings; replaces `width`, `height` and `openings`"
    )
    outline_unit: Literal["m", "cm", "mm", "in", "ft"] | None = key(None, "unit of the drawing, if the file gives none")

    @model_validator(mode="after")
    def _sensible(self) -> "Panel":
        if self.outline:
            given = {"width", "height", "openings"} & self.model_fields_set
            if given:
                raise ValueError(f"an outline replaces {', '.join(sorted(given))}: give only one of them")
            return self
        if self.width is None or self.height is None:
            raise ValueError("`width` and `height` are missing: give both, or an `outline`")
        if (self.unit_length is None) != (self.unit_height is None):
            raise ValueError("give both `unit_length` and `unit_height`, or neither")
        self.check_openings(*self.size)
        return self

    @property
    def size(self) -> tuple[float, float]:
        """Length and height of the wall [m]; NoView where it is an outline."""
        if self.width is None or self.height is None:
            raise NoView("a panel with an outline is not a rectangle", ("structure", "outline"))
        return self.width, self.height

    def pier_assembly(self, density: float) -> Assembly:
        if self.outline:
            raise NoView(
                "piers of a panel are found between rectangular openings, but the panel has an `outline`: give the openings as rectangles",
                ("structure", "outline"),
            )
        if any(region.material or region.thickness for region in self.regions):
            raise NoView(
                "the piers of a panel require a uniform weight, but the panel has regions with another material or thickness",
                ("structure", "regions"),
            )
        return make_piers(*self.size, self.holes, density, self.thickness)

    def assembly(self, density: float, folder: Path) -> Assembly:
        if self.outline:
            raise NoView(
                "a panel with an outline has no blocks: draw the blocks, and read the drawing with kind `blocks`", ("structure", "outline")
            )
        if self.unit_length is None or self.unit_height is None:
            raise NoView("the units of the panel are not known: give `unit_length` and `unit_height`", ("structure", "unit_length"))
        bond = self.bond(self.unit_length, self.unit_height)
        return make_brickwork(bond, *self.size, self.holes, density, self.thickness)

    def weighed(self, made: Assembly, density: float, densities: Mapping[str, float]) -> Assembly:
        """The stones whose centres lie in a region weigh what its material does."""
        ratio = np.ones(len(made.mass))
        for i, region in enumerate(self.regions, start=1):
            if region.thickness not in (None, self.thickness):
                raise NoView(
                    f"region {i} of the panel has its own thickness, but all blocks must have the same thickness: remove the "
                    "thickness of the region",
                    ("structure", "regions", i - 1, "thickness"),
                )
            if region.material is None:
                continue
            if density == 0.0:
                raise NoView(
                    f"region {i} of the panel has its own material, but [material] has no density: give [material] a density",
                    ("structure", "regions", i - 1, "material"),
                )
            ratio[region.holds(made.centroid)] = densities[region.material] / density
        return replace(made, mass=made.mass * ratio, inertia=made.inertia * ratio)


Vector = Annotated[list[Stress], Field(min_length=3, max_length=3)]
Force3 = Annotated[list[Force], Field(min_length=3, max_length=3)]


class MeshGroup(Table):
    """What a named group of a mesh file is in space: its elements, or the nodes that its lines, points or elements have."""

    name: str = key(about="name of the group in the file, or its number if it has no name", min_length=1, max_length=200)
    thickness: Length | None = key(None, "thickness of the elements of the group", gt=0)
    material: str | None = key(None, "material of the elements of the group: a name in [materials]")
    linear: bool = key(False, "whether the elements of the group remain linear (no cracks)")
    membrane: bool = key(False, "whether the elements have no bending stiffness, as in a floor")
    support: Literal["fixed", "pinned", "vertical"] | None = key(
        None, "support of the nodes of the group: fixed, pinned (rotations free), or vertical only"
    )
    pressure: Vector | None = key(None, "[x, y, z] force per area on the elements of the group, applied together with the weight")
    force: Force3 | None = key(
        None, "[x, y, z] total force, applied together with the weight and distributed evenly over the nodes of the group"
    )


class MeshFile(MeshedWall):
    """A wall, or shells in space, from a mesh file (gmsh, Abaqus, VTU and others; needs the extra `extrados[mesh]`)."""

    word: ClassVar = "building"

    kind: Literal["mesh"]
    starter_analysis: ClassVar = "sla"
    starter: ClassVar = {"thickness": '"30 cm"', "file": '"extrados:example-wall"', "scale": "0.001"}
    file: str = key(
        about="mesh file of triangles or quadrilaterals: in the x, y plane for `sla`; in space, with z up, for `pushover`",
        min_length=1,
        max_length=1000,
    )
    groups: list[MeshGroup] = key(
        [],
        "for shells in space: properties of the groups of the file, [[structure.groups]]; if groups overlap, the last one counts",
        max_length=1000,
    )
    scale: float = key(1.0, "length in metres of one unit of the file", gt=0, le=1e6)
