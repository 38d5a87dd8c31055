"""Buildings of an ensemble as models of discrete elements: other sizes, and values that are not known exactly."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydantic import BaseModel

from extrados.analyses.context import Refused
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.solid_model import SolidModel, make_solid_model
from extrados.analyses.dem.tables import DemFragility
from extrados.analyses.needs import stones_of
from extrados.analyses.statistics.uncertain import BY_STONE, drawn_masses, drawn_stones, factors_of, refuse_mixed_friction
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly
from extrados.schema.quantities import unit_of
from extrados.views.building import Building
from extrados.views.rigid import rigid_bodies

#: Uncertain values of springs
SPRINGS = ("stiffness", "damping")


@dataclass(frozen=True)
class Sample:
    """Building k of an ensemble: its values at the point draws[k] of the unit cube, by the names of `uncertain` in order."""

    building: Building
    options: DemFragility
    draws: np.ndarray

    def building_of(self, k: int, size: float = 1.0) -> Building:
        """Building k with all lengths times `size`, its blocks as drawn."""
        return changed(self.building, factors_of(self.options.uncertain, self.draws[k])[0], size)

    def model(self, k: int, size: float = 1.0) -> Model | SolidModel:
        """The model of building k with all lengths times `size`; BadGeometry or Refused where it has none."""
        factor, seeds = factors_of(self.options.uncertain, self.draws[k])
        building, options = self.building_of(k, size), self.options
        if options.floor is not None:
            options = options.model_copy(update={"floor": size * options.floor})
        model = make_blocks(building, options)
        if seeds:
            model = _redrawn(model, building, options, seeds)
        springs = {name: factor[name] for name in SPRINGS if name in factor}
        if isinstance(model, Model):
            return replace(model, values=model.values.scaled(**springs))
        return replace(model, values=model.values.scaled(**springs))


def make_blocks(building: Building, options: DemFragility) -> Model | SolidModel:
    """The model of a section, or of solids."""
    if isinstance(stones_of(building, options), Assembly):
        return make_model(building, options)
    return make_solid_model(building, options)


def changed(building: Building, factor: dict[str, float], size: float) -> Building:
    """A building with its lengths times factors, and its friction; all lengths of its structure and joints times `size`."""
    structure, joints = building.require_structure(), building.joints
    update = {name: getattr(structure, name) * value for name, value in factor.items() if name in lengths_of(building)}
    if "friction" in factor and joints.coefficient is not None:
        joints = joints.model_copy(update={"friction": joints.coefficient * factor["friction"]})
    structure = structure.model_copy(update=update)
    if size != 1.0:
        structure, joints = resized(structure, size), resized(joints, size)
    return building.having(structure=structure, joints=joints).apart()


def lengths_of(building: Building) -> list[str]:
    """Keys of the structure that are one length each."""
    structure = building.require_structure()
    return [name for name in type(structure).model_fields if unit_of(type(structure), name) == "m" and _is_length(structure, name)]


def _is_length(structure: BaseModel, name: str) -> bool:
    """Tolerances and levels are no sizes."""
    value = getattr(structure, name)
    return isinstance(value, float) and value > 0.0 and not name.endswith(("tolerance", "gap"))


def resized(table: Any, factor: float) -> Any:
    """A table with all lengths, and lists of lengths, times a factor, in the tables within it, too."""
    update = {}
    kind: type[BaseModel] = type(table)
    for name in kind.model_fields:
        value = getattr(table, name)
        if unit_of(kind, name) == "m":
            update[name] = _times(value, factor)
        elif isinstance(value, BaseModel):
            update[name] = resized(value, factor)
        elif isinstance(value, list) and any(isinstance(one, BaseModel) for one in value):
            update[name] = [resized(one, factor) if isinstance(one, BaseModel) else one for one in value]
    return table.model_copy(update=update)


def _times(value: Any, factor: float) -> Any:
    """A number or the numbers of nested lists times a factor; words and None stay."""
    if isinstance(value, list | tuple):
        return type(value)(_times(one, factor) for one in value)
    return value * factor if isinstance(value, float | int) and not isinstance(value, bool) else value


def _redrawn(model: Model | SolidModel, building: Building, options: DemFragility, seeds: dict[str, int]) -> Model | SolidModel:
    """The model with the masses and the places of its blocks drawn anew; the springs stay those of the blocks as drawn."""
    if isinstance(model, SolidModel):
        return replace(model, assembly=drawn_masses(model.assembly, options.uncertain, seeds))
    stones = drawn_stones(model.assembly, options.uncertain, seeds)
    if "imperfection" in seeds:
        # Corners and ends of joints move apart by up to twice the deviation: faces follow the joints in them
        apart = 2.0 * options.uncertain["imperfection"] * float(model.assembly.length.min())
        stones = replace(stones, tolerance=max(stones.tolerance, apart))
    return replace(model, assembly=stones, rigid=rigid_bodies(stones, (), building.joints.worn_corners, options.floor))


def refuse_uncertain(building: Building, options: DemFragility) -> None:
    """Refused where the structure does not have an uncertain value, or cannot have another size."""
    try:
        section = isinstance(stones_of(building, options), Assembly)
    except BadGeometry:
        return  # told already
    structure = building.require_structure()
    known = [*lengths_of(building), "friction"]
    if options.merge == "none":
        known += BY_STONE if section else ["density"]
    if not options.rigid:
        known += SPRINGS
    for name in options.uncertain:
        key = ("analysis", "uncertain", name)
        if name in BY_STONE and options.merge != "none":
            raise Refused(f'`{name}` differs from block to block, and merge = "three-bars" joins the blocks: remove one of them', key)
        if name == "imperfection" and not section:
            raise Refused("faces of solids with moved corners would not be plane: vary the lengths of [structure] instead", key)
        if name in SPRINGS and options.rigid:
            raise Refused('rigid contacts have no springs: remove this value, or give solver = "compliant"', key)
        if name not in known:
            raise Refused(f"this {structure.word} has no uncertain value '{name}'; expected one of {', '.join(known)}", key)
    refuse_mixed_friction(building, options.uncertain)
    if options.intensity == "size":
        if getattr(structure, "file", None) is not None:
            raise Refused(
                "the size of blocks from a file cannot vary: use another intensity, or give the blocks in the deck",
                ("analysis", "intensity"),
            )
        if building.restraints:
            raise Refused(
                "ties and dampers do not change with the size of the structure: remove them, or use another intensity",
                ("analysis", "intensity"),
            )
