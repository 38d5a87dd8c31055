"""The base of the structure kinds: geometry as a deck table, and the makers of what strategies look at."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

from extrados.model.errors import NoView
from extrados.schema.table import Table

if TYPE_CHECKING:
    from extrados.model.geometry.assembly import Assembly
    from extrados.model.geometry.inspection import Inspection
    from extrados.model.geometry.solids.assembly import SolidAssembly
    from extrados.views.building import Building
    from extrados.views.mesh.mesh import Mesh
    from extrados.views.mesh.options import MeshOptions
    from extrados.views.shell.mesh import ShellMesh, ShellOptions

RocksAs = Literal["mechanism", "block", "piers", "frame", "stack"]
Crossed = Literal["arch", "top"]


class Structure(Table):
    """Base of the structure kinds. `word`: what answers call it, after "the"; `lacks`: views that the kind cannot
    have, with the reason in words.

    rocks_as: its stones by the mechanism that limit analysis finds, all of it as one block, its piers, as a frame, or as two stacked blocks.
    crossed: where a moving load goes unless a deck names a chain, over the first arch or along the whole top.
    starter_analysis: the analysis of the deck that `new` writes.
    """

    kind: str
    word: ClassVar[str] = "structure"
    lacks: ClassVar[Mapping[str, str]] = {}
    rocks_as: ClassVar[RocksAs] = "mechanism"
    crossed: ClassVar[Crossed] = "arch"
    starter_analysis: ClassVar[str] = "tilt"

    def assembly(self, density: float, folder: Path) -> "Assembly":
        """Stones and joints, of a density [kg/m^3]; `folder` is where its files are looked for.

        Raises BadGeometry with the part and the bound, NoView where the kind has no stones.
        """
        raise NoView(self.lacks["blocks"], ("structure", "kind"))

    def inspection(self, folder: Path) -> "Inspection | None":
        """Gaps, overlaps and near misses of a surveyed structure; None where its geometry is exact by its making."""
        return None

    def mended(self, folder: Path) -> "Structure | None":
        """The structure with the tolerance that closes its open gaps; None where there are none that one closes."""
        return None

    def weighed(self, made: "Assembly", density: float, densities: Mapping[str, float]) -> "Assembly":
        """The stones made of one density [kg/m^3], with the weights of parts that are of a named material."""
        return made

    def solids(self, building: "Building") -> "SolidAssembly":
        """Blocks in space: of a plane structure its section drawn out to its depth.

        building: the one of this structure. BadGeometry with the part and the bound, NoView where it has no solids.
        """
        from extrados.model.geometry.solids.sections import drawn_out

        return drawn_out(building.blocks())

    def pier_assembly(self, density: float) -> "Assembly":
        """A wall as few rigid bodies, of a density [kg/m^3]; NoView where the kind is no wall."""
        raise NoView(f"a structure of kind '{self.kind}' has no piers", ("structure", "kind"))

    def shell(self, building: "Building", options: "ShellOptions") -> "ShellMesh":
        """Flat shells in space; NoView where the kind stands in a plane. BadGeometry says what is wrong."""
        raise NoView(
            f"a structure of kind '{self.kind}' has no shells; they are made of the kinds building, arch, vault, dome, "
            "cross-vault and mesh",
            ("structure", "kind"),
        )

    def mesh(self, building: "Building", options: "MeshOptions", seed: int | None) -> "Mesh":
        """Finite elements: of the stones, with a row of elements along every joint, where a kind does not mesh itself.

        building: the one of this structure; seed: instead of that of a random pattern. BadGeometry says what is wrong.
        """
        from extrados.views.mesh.stones import make_stones

        return make_stones(building, options)
