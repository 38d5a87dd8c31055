"""The base of the structure kinds: geometry as a deck table, and the stones that it says."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

from extrados.model.errors import NoView
from extrados.model.geometry.assembly import Assembly
from extrados.schema.table import Table

if TYPE_CHECKING:  # slow to load
    from extrados.model.geometry.inspection import Inspection

RocksAs = Literal["mechanism", "block", "piers", "frame", "stack"]
Crossed = Literal["arch", "top"]


class Structure(Table):
    """Base of the structure kinds; the makers of their views, or why there is none, stand in `kinds.STRUCTURES`.

    word: name in results, after "the".
    rocks_as: its stones by the mechanism that limit analysis finds, all of it as one block, its piers, as a frame, or as two stacked blocks.
    crossed: where a moving load goes unless a deck names a chain, over the first arch or along the whole top.
    starter_analysis: the analysis of the deck that `new` writes.
    halved: keys of the size of its blocks, with the factor by which blocks are half as long; bonds: keys of their bond, with its values.
    """

    kind: str
    word: ClassVar[str] = "structure"
    rocks_as: ClassVar[RocksAs] = "mechanism"
    crossed: ClassVar[Crossed] = "arch"
    starter_analysis: ClassVar[str] = "tilt"
    halved: ClassVar[dict[str, float]] = {}
    bonds: ClassVar[dict[str, tuple[str, ...]]] = {}

    def assembly(self, density: float, folder: Path) -> Assembly:
        """Stones and joints, of a density [kg/m^3]; `folder` is where its files are looked for.

        Raises BadGeometry with the part and the bound, NoView where it has none.
        """
        raise NoView(f"a structure of kind '{self.kind}' has no blocks in a plane section", ("structure", "kind"))

    def inspection(self, folder: Path) -> "Inspection | None":
        """Gaps, overlaps and near misses of a surveyed structure; None where its geometry is exact by its making."""
        return None

    def mended(self, folder: Path) -> "Structure | None":
        """The structure with the tolerance that closes its open gaps; None where there are none that one closes."""
        return None

    def weighed(self, made: Assembly, density: float, densities: Mapping[str, float]) -> Assembly:
        """The stones made of one density [kg/m^3], with the weights of parts that are of a named material."""
        return made

    def pier_assembly(self, density: float) -> Assembly:
        """A wall as few rigid bodies, of a density [kg/m^3]; NoView where it is no wall."""
        raise NoView(f"a structure of kind '{self.kind}' is not a wall with piers", ("structure", "kind"))
