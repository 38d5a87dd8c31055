"""A building as every strategy sees it: geometry and properties said once, and the views made of them."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from extrados.model.devices import AddedHinge, Damper
from extrados.model.errors import WHOLE, BadGeometry, Key, NoView
from extrados.model.geometry.anchors import Anchored, moved_joints, stone_at
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import in_order
from extrados.model.properties import (
    NO_SLIDING,
    NO_SLIDING_COEFFICIENT,
    Initial,
    Joints,
    JointType,
    Material,
    Supports,
)
from extrados.model.structure import Structure
from extrados.model.ties import Tie
from extrados.schema.table import Table

if TYPE_CHECKING:  # views are loaded when they are asked for
    from extrados.model.geometry.solids.assembly import SolidAssembly
    from extrados.views.mesh.mesh import Mesh
    from extrados.views.mesh.options import MeshOptions
    from extrados.views.rigid import RigidBodies
    from extrados.views.rockers.rocker import Rocker
    from extrados.views.shell.mesh import ShellMesh, ShellOptions


@dataclass(frozen=True)
class Building:
    """Geometry, material, joints, supports, ties, dampers, added hinges and the state at the start.

    The views are made when first asked for and kept, also for buildings made from this one by `having`, as long as
    nothing that they depend on has changed. They raise BadGeometry with the part and the bound where they cannot
    be made, and NoView with the reason where such a building has none.
    """

    structure: Structure | None
    material: Material = field(default_factory=Material)
    materials: dict[str, Material] = field(default_factory=dict)
    joints: Joints = field(default_factory=Joints)
    supports: Supports = field(default_factory=Supports)
    initial: Initial = field(default_factory=Initial)
    ties: tuple[Tie, ...] = ()
    dampers: tuple[Damper, ...] = ()
    hinges: tuple[AddedHinge, ...] = ()
    folder: Path = field(default_factory=Path.cwd)
    _views: dict[Any, Any] = field(default_factory=dict, repr=False, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        """Pickled without its views, which are made again where it arrives."""
        return {**self.__dict__, "_views": {}}

    @property
    def restraints(self) -> tuple[Tie | Damper | AddedHinge, ...]:
        """Whatever holds it besides its weight and its joints."""
        return (*self.ties, *self.dampers, *self.hinges)

    @property
    def restraint_keys(self) -> tuple[Key, ...]:
        """The table of the deck that says each of its restraints."""
        sections = {"ties": self.ties, "dampers": self.dampers, "hinges": self.hinges}
        return tuple((section, k) for section, tables in sections.items() for k in range(len(tables)))

    @property
    def special_keys(self) -> dict[str, Key]:
        """What of it only some strategies take into account, as decks call it, with the key that says so; what it has not is
        left out."""
        found: dict[str, Key] = {
            f"[[{section}]]": (section, 0) for section in ("ties", "dampers", "hinges") if getattr(self, section)
        }
        there = {
            "abutting_wall": self.supports.abutting_wall is not None,
            "foundation": "foundation" in self.supports.model_fields_set,
            "damping_ratio": self.supports.damping_ratio is not None,
        }
        return found | {f"[supports] {name}": ("supports", name) for name, given in there.items() if given}

    def having(self, **tables: Any) -> "Building":
        """The same building with other tables: structure, material, joints, supports, initial, ties, dampers, hinges."""
        return replace(self, **tables)

    def apart(self) -> "Building":
        """The same building that keeps its views for itself: one of many in a sweep, whose views nobody asks for again."""
        return replace(self, _views={})

    def blocks(self) -> Assembly:
        """Stones and joints."""
        return self._view("blocks", self._stones, self._blocks)

    def solids(self) -> "SolidAssembly":
        """Blocks in space and the polygons along which they touch."""
        return self._view("solids", self._stones, lambda: self._structure().solids(self))

    @property
    def _stones(self) -> tuple[Any, ...]:
        """What its stones depend on."""
        return (self.structure, self.material.density, *self.materials.items())

    def told(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Remarks and notes on its stones, where something has looked at them; else nothing."""
        made = self._views.get(self._key("blocks", self._stones)) or self._views.get(self._key("solids", self._stones))
        return (made.remarks, made.notes) if made is not None else ((), ())

    def _blocks(self) -> Assembly:
        structure, density = self._structure(), self.material.density
        named = {name: material.density for name, material in self.materials.items()}
        return structure.weighed(structure.assembly(density, self.folder), density, named)

    def pier_blocks(self) -> Assembly:
        """A wall as few rigid bodies: piers between its openings, spandrels over them."""
        return self._view(
            "piers",
            (self.structure, self.material.density),
            lambda: self._structure().pier_assembly(self.material.density),
        )

    def rigid(self, groups: tuple[tuple[int, ...], ...] = (), floor: float | None = None) -> "RigidBodies":
        """Rigid bodies of convex parts on supports; `groups` of stones move as one, a floor at a height [m] catches
        what falls."""
        from extrados.views.rigid import rigid_bodies

        self.refuse_mixture()
        self.refuse_weightless()
        worn = self.joints.worn_corners
        return self._view(
            "rigid", (self.structure, self.material.density, *self.materials.items(), worn, groups, floor),
            lambda: rigid_bodies(self.blocks(), groups, worn, floor),
        )  # fmt: skip

    def rocker(self, linear: bool = False, soft_base: bool = False) -> "Rocker":
        """The one degree of freedom in which it rocks; `linear` for the slender form of a block's equations. soft_base:
        also a block on a base that gives way, which has two."""
        from extrados.views.rockers.rocker import make_rocker

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
        return self._view("rocker", tables, lambda: make_rocker(self, linear, soft_base=soft_base))

    def refuse_mixture(self) -> None:
        """BadGeometry where stones are of a named material that gives more than a density: what looks at their elastic
        constants and strengths takes those of [material] for all stones."""
        for name in sorted({m for m in self.blocks().materials if m}):
            more = sorted(self.materials[name].model_fields_set - {"density"})
            if more:
                raise BadGeometry(
                    f"[materials.{name}] gives stones another {more[0]}; discrete and finite elements know one elastic "
                    "material for all stones, that of [material]: leave it out, or give the joints their stiffness",
                    ("materials", name, more[0]),
                )

    def friction(self, assembly: "SolidAssembly | None" = None) -> float | np.ndarray | None:
        """Coefficient of friction of the joints, one for each where they differ; None excludes sliding. `assembly`: of
        solids, in place of the plane stones."""
        if all(t.friction is None for t in self.joints.types):
            return self.joints.coefficient
        return self.joint_property("friction", assembly)

    def refuse_weightless(self, assembly: "Assembly | SolidAssembly | None" = None) -> None:
        """NoView where a stone of the building, or of the solids given, has no mass: weight is what makes stones stand,
        rock and fall."""
        stones = self.blocks() if assembly is None else assembly
        if not (stones.mass > 0.0).all():
            raise NoView(
                f"'{stones.block_names[int(stones.mass.argmin())]}' weighs nothing, and stones stand, rock and fall by their "
                "weight: give a density above zero",
                ("material", "density"),
            )

    def joint_property(self, name: str, assembly: "SolidAssembly | None" = None) -> np.ndarray:
        """Friction, cohesion, tension, fracture_energy or normal_stiffness of every joint (NaN where no value is given), of
        the plane stones or of the solids given.

        BadGeometry where [[joints.types]] names a joint that is not there, or one twice.
        """
        stones = self.blocks() if assembly is None else assembly

        def number(value: float | str | None) -> float:
            return np.nan if value is None else NO_SLIDING_COEFFICIENT if value == NO_SLIDING else float(value)

        values = np.full(len(stones.a), number(getattr(self.joints, name)))
        for joints, table in self._typed_joints(stones):
            given = getattr(table, name)
            if given is not None:
                values[joints] = number(given)
        return values

    def _typed_joints(self, assembly: "Assembly | SolidAssembly") -> Iterator[tuple[np.ndarray, JointType]]:
        """The joints that each of [[joints.types]] speaks of."""
        index = {name: j for j, name in enumerate(assembly.joint_names)}
        named: dict[str, int] = {}
        for k, kind in enumerate(self.joints.types, start=1):
            key = ("joints", "types", k - 1, "joints")
            for name in kind.joints:
                if name in named:
                    raise BadGeometry(f"joint '{name}' is named twice, in joints.types {named[name]} and {k}", key)
                named[name] = k
                if name == "ground":
                    yield np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND)), kind
                elif name in index:
                    yield np.array([index[name]]), kind
                elif name in assembly.groups:
                    yield np.array(assembly.groups[name], dtype=int), kind
                else:
                    known = ", ".join(assembly.joint_names[:8]) + (", ..." if len(index) > 8 else "")
                    groups = ", ".join([*assembly.groups, "ground"])
                    raise BadGeometry(f"joints.types {k} names no joint '{name}'; there are {known}, and {groups}", key)

    def anchored(self) -> Anchored:
        """The stones at the ends of its ties, in their order; BadGeometry where an end is in none, or in several."""
        assembly = self.blocks()
        block, point = np.full((len(self.ties), 2), GROUND), np.zeros((len(self.ties), 2, 2))
        for k, tie in enumerate(self.ties):
            point[k] = tie.start, tie.far
            block[k, 0] = stone_at(assembly, point[k, 0], tie.start_stone, f"{tie.name}, start", ("ties", k), "start")
            if tie.ground is None:
                block[k, 1] = stone_at(assembly, point[k, 1], tie.end_stone, f"{tie.name}, end", ("ties", k), "end")
            if block[k, 0] == block[k, 1]:
                raise BadGeometry(
                    f"{tie.name}: both of its ends are in the stone '{assembly.block_names[block[k, 0]]}'", ("ties", k)
                )
        return Anchored(block, point)

    @property
    def one_arch(self) -> bool:
        """Whether its stones are one arch, from springing to springing."""
        try:
            in_order(self.blocks())
        except BadGeometry:
            return False
        return True

    def moved(self) -> list[int]:
        """The joints that [[initial.movements]] name, in their order; BadGeometry where one is not on the ground."""
        return moved_joints(self.blocks(), [one.joint for one in self.initial.movements])

    def mesh(self, options: "MeshOptions | None" = None, seed: int | None = None) -> "Mesh":
        """Finite elements: of a wall, or of the stones with a row of elements along every joint; `seed` replaces that
        of a random pattern."""
        from extrados.views.mesh.options import MeshOptions

        options = options or MeshOptions()
        tables = (
            self.structure, self.material, *self.materials.items(), self.joints, self.supports, *self.ties, options, seed
        )  # fmt: skip
        return self._view("mesh", tables, lambda: self._meshed(options, seed))

    def _meshed(self, options: "MeshOptions", seed: int | None) -> "Mesh":
        from extrados.views.mesh.rods import rods_of

        mesh = self._structure().mesh(self, options, seed)
        return replace(mesh, rods=rods_of(self, mesh))

    def shell(self, options: "ShellOptions | None" = None) -> "ShellMesh":
        """Flat shells in space: walls on a plan with the floors between them."""
        from extrados.views.shell.mesh import ShellOptions

        options = options or ShellOptions()
        tables = (self.structure, self.material, *self.materials.items(), options)
        return self._view("shell", tables, lambda: self._structure().shell(self, options))

    @property
    def meshed_by_stones(self) -> bool:
        """Whether its finite elements are stones with joints between them."""
        return self.structure is not None and type(self.structure).mesh is Structure.mesh

    def _structure(self) -> Structure:
        if self.structure is None:
            raise NoView("the deck has no [structure]", WHOLE)
        return self.structure

    def _view(self, name: str, depends: tuple, make: Any) -> Any:
        key = self._key(name, depends)
        if key not in self._views:
            self._views[key] = make()
        return self._views[key]

    def _key(self, name: str, depends: tuple) -> tuple[Any, ...]:
        return (name, str(self.folder), *(_fingerprint(part) for part in depends))


def _fingerprint(part: Any) -> Any:
    """What a view depends on, as something a dictionary can hold."""
    if isinstance(part, Table):
        return part.model_dump_json()
    if isinstance(part, tuple):
        return tuple(_fingerprint(p) for p in part)
    return part.tobytes() if isinstance(part, np.ndarray) else part
