"""A building with its blocks and joints, which all other views are made from."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from extrados import kinds
from extrados.model.description import Description
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.anchors import Anchored, moved_joints, stone_at
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import in_order
from extrados.model.properties import NO_SLIDING, NO_SLIDING_COEFFICIENT, JointType
from extrados.schema.table import Table

if TYPE_CHECKING:
    from extrados.model.geometry.solids.assembly import SolidAssembly


def make_blocks(building: Description) -> Assembly:
    """Stones and joints of a structure, weighed by [material] and [materials]."""
    structure, density = building.require_structure(), building.material.density
    named = {name: material.density for name, material in building.materials.items()}
    return structure.weighed(structure.assembly(density, building.folder), density, named)


def make_piers(building: Description) -> Assembly:
    """A wall as few rigid bodies: piers between its openings, spandrels over them."""
    return building.require_structure().pier_assembly(building.material.density)


def maker_of(view: kinds.View) -> Any:
    """The maker of a view; NoView with the reason where the kind of structure has none."""
    if isinstance(view, kinds.Lacks):
        raise NoView(view.reason, ("structure", "kind"))
    return kinds.load(view)


@dataclass(frozen=True)
class Masonry(Description):
    """A building as blocks and joints, with the properties of the joints.

    The views are made when first asked for and kept, also for buildings made from this one by `having`, as long as
    nothing that they depend on has changed. They raise BadGeometry with the part and the bound where they cannot
    be made, and NoView with the reason where such a building has none.
    """

    views: dict[Any, Any] = field(default_factory=dict, repr=False, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        """Pickled without its views, which are made again where it arrives."""
        return {**self.__dict__, "views": {}}

    def apart(self) -> Self:
        """The same building that keeps its views for itself: one of many in a sweep, whose views nobody asks for again."""
        return replace(self, views={})

    def blocks(self) -> Assembly:
        """Stones and joints."""
        return self.made("blocks", self._stones, lambda: maker_of(self.kind.blocks)(self))

    @property
    def _stones(self) -> tuple[Any, ...]:
        """What its stones depend on."""
        return (self.structure, self.material.density, *self.materials.items())

    def told(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Remarks and notes on its stones, where something has looked at them; else nothing."""
        made = self.views.get(self._key("blocks", self._stones)) or self.views.get(self._key("solids", self._stones))
        return (made.remarks, made.notes) if made is not None else ((), ())

    def pier_blocks(self) -> Assembly:
        """A wall as few rigid bodies: piers between its openings, spandrels over them."""
        return self.made("piers", (self.structure, self.material.density), lambda: maker_of(self.kind.piers)(self))

    def refuse_mixture(self) -> None:
        """BadGeometry where stones are of a named material that gives more than a density: what looks at their elastic
        constants and strengths takes those of [material] for all stones."""
        for name in sorted({m for m in self.blocks().materials if m}):
            more = sorted(self.materials[name].model_fields_set - {"density"})
            if more:
                raise BadGeometry(
                    f"[materials.{name}] gives blocks a different {more[0]}. Discrete and finite elements use one elastic material for "
                    "all blocks, that of [material]: remove this value, or give the stiffness of the joints",
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
                f"block '{stones.block_names[int(stones.mass.argmin())]}' has no weight, but the analysis "
                "requires one: give a density above zero",
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
                    raise BadGeometry(
                        f"joints.types {k} names joint '{name}', which does not exist; the joints are {known}, and {groups}", key
                    )

    def anchored(self) -> Anchored:
        """The stones at the ends of its ties, in their order; BadGeometry where an end is in none, or in several."""
        assembly = self.blocks()
        block, point = np.full((len(self.ties), 2), GROUND), np.zeros((len(self.ties), 2, 2))
        for k, tie in enumerate(self.ties):
            point[k] = tie.flat()
            block[k, 0] = stone_at(assembly, point[k, 0], tie.start_stone, f"{tie.name}, start", ("ties", k), "start")
            if tie.ground is None:
                block[k, 1] = stone_at(assembly, point[k, 1], tie.end_stone, f"{tie.name}, end", ("ties", k), "end")
            if block[k, 0] == block[k, 1]:
                raise BadGeometry(f"{tie.name}: both ends of the tie are in block '{assembly.block_names[block[k, 0]]}'", ("ties", k))
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
        for k, one in enumerate(self.initial.movements):
            if one.dz:
                raise BadGeometry("`dz` is only for blocks in space: in a plane section, `dy` is upward", ("initial", "movements", k, "dz"))
        return moved_joints(self.blocks(), [one.joint for one in self.initial.movements])

    @property
    def kind(self) -> kinds.StructureKind:
        """The entry of the kind of this structure; NoView where the deck has no [structure]."""
        return kinds.STRUCTURES[self.require_structure().kind]

    def made(self, name: str, depends: tuple, make: Any) -> Any:
        """A view, made where nothing that it depends on has changed since it was."""
        key = self._key(name, depends)
        if key not in self.views:
            self.views[key] = make()
        return self.views[key]

    def _key(self, name: str, depends: tuple) -> tuple[Any, ...]:
        return (name, str(self.folder), *(_fingerprint(part) for part in depends))


def _fingerprint(part: Any) -> Any:
    """What a view depends on, as something a dictionary can hold."""
    if isinstance(part, Table):
        return part.model_dump_json()
    if isinstance(part, tuple):
        return tuple(_fingerprint(p) for p in part)
    return part.tobytes() if isinstance(part, np.ndarray) else part
