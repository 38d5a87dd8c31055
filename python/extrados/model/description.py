"""A building as a deck describes it: geometry and properties said once for every strategy."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from extrados.model.devices import AddedHinge, Damper
from extrados.model.errors import WHOLE, Key, NoView
from extrados.model.properties import Initial, Joints, Material, Supports
from extrados.model.structure import Structure
from extrados.model.ties import Tie


@dataclass(frozen=True)
class Description:
    """Geometry, material, joints, supports, ties, dampers, added hinges and the state at the start."""

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

    def require_structure(self) -> Structure:
        """The table of [structure]; NoView where the deck has none."""
        if self.structure is None:
            raise NoView("the deck has no [structure]", WHOLE)
        return self.structure

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
        found: dict[str, Key] = {f"[[{section}]]": (section, 0) for section in ("ties", "dampers", "hinges") if getattr(self, section)}
        there = {
            "abutting_wall": self.supports.abutting_wall is not None,
            "foundation": "foundation" in self.supports.model_fields_set,
            "damping_ratio": self.supports.damping_ratio is not None,
        }
        return found | {f"[supports] {name}": ("supports", name) for name, given in there.items() if given}

    def having(self, **tables: Any) -> Self:
        """The same building with other tables: structure, material, joints, supports, initial, ties, dampers, hinges."""
        return replace(self, **tables)
