"""A building as every strategy sees it: the views of it, each by the maker of its kind of structure."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from extrados import kinds
from extrados.views.blocks import Masonry, maker_of

if TYPE_CHECKING:  # a view is loaded when it is asked for
    from extrados.model.geometry.solids.assembly import SolidAssembly
    from extrados.model.geometry.solids.strands import Strand
    from extrados.views.frame.frame import EquivalentFrame
    from extrados.views.frame.options import FrameOptions
    from extrados.views.mesh.mesh import Mesh
    from extrados.views.mesh.options import MeshOptions
    from extrados.views.rigid import RigidBodies
    from extrados.views.rockers.rocker import Rocker
    from extrados.views.shell.mesh import ShellMesh
    from extrados.views.shell.options import ShellOptions


@dataclass(frozen=True)
class Building(Masonry):
    """A building and its views: blocks, piers, solids, rigid bodies, the mechanism by which it rocks, finite elements,
    shells, frames of macro-elements."""

    def solids(self) -> "SolidAssembly":
        """Blocks in space and the polygons along which they touch."""
        return self.made("solids", self._stones, lambda: maker_of(self.kind.solids)(self))

    def strands(self) -> "tuple[Strand, ...]":
        """Its ties, chains and hoops in space; BadGeometry where an end is in no block, or in several."""
        found: tuple[Strand, ...] = kinds.load(kinds.STRANDS)(self)
        return found

    def rigid(self, groups: tuple[tuple[int, ...], ...] = (), floor: float | None = None) -> "RigidBodies":
        """Rigid bodies of convex parts on supports; `groups` of stones move as one, a floor at a height [m] catches
        what falls."""
        self.refuse_mixture()
        self.refuse_weightless()
        worn = self.joints.worn_corners
        return self.made(
            "rigid",
            (self.structure, self.material.density, *self.materials.items(), worn, groups, floor),
            lambda: maker_of(self.kind.rigid)(self, groups, floor),
        )

    def rocker(self, linear: bool = False, soft_base: bool = False) -> "Rocker":
        """The one degree of freedom in which it rocks; `linear` for the slender form of a block's equations. soft_base:
        also a block on a compliant base, which has two."""
        tables = (
            self.structure,
            self.material,
            self.joints,
            self.supports,
            self.initial.rotation_ratio,
            self.restraints,
            linear,
            soft_base,
        )
        return self.made("rocker", tables, lambda: maker_of(self.kind.rocker)(self, linear, soft_base=soft_base))

    def mesh(self, options: "MeshOptions | None" = None, seed: int | None = None) -> "Mesh":
        """Finite elements: of a wall, or of the stones with a row of elements along every joint; `seed` replaces that
        of a random pattern."""
        options = options or kinds.load(kinds.MESH_OPTIONS)()
        tables = (self.structure, self.material, *self.materials.items(), self.joints, self.supports, *self.ties, options, seed)
        return self.made("mesh", tables, lambda: self._meshed(options, seed))

    def _meshed(self, options: "MeshOptions", seed: int | None) -> "Mesh":
        mesh = maker_of(self.kind.mesh)(self, options, seed)
        return kinds.load(kinds.RODS)(self, mesh) if self.ties else mesh

    def shell(self, options: "ShellOptions | None" = None) -> "ShellMesh":
        """Flat shells in space: walls on a plan with the floors between them."""
        options = options or kinds.load(kinds.SHELL_OPTIONS)()
        tables = (self.structure, self.material, *self.materials.items(), options)
        return self.made("shell", tables, lambda: maker_of(self.kind.shell)(self, options))

    def frame(self, options: "FrameOptions | None" = None) -> "EquivalentFrame":
        """Macro-elements: piers and spandrels of walls on a plan between rigid nodes."""
        options = options or kinds.load(kinds.FRAME_OPTIONS)()
        tables = (self.structure, self.material, *self.materials.items(), self.joints, options)
        return self.made("frame", tables, lambda: maker_of(self.kind.frame)(self, options))

    @property
    def meshed_by_stones(self) -> bool:
        """Whether its finite elements are stones with joints between them."""
        return self.structure is not None and self.kind.mesh == kinds.MESH_OF_STONES
