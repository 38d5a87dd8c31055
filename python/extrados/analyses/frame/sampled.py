"""Buildings of uncertain materials, drift limits and floors, as frames of macro-elements at points of the unit cube."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.frame.tables import MASONRY, OPTIONS
from extrados.analyses.statistics.uncertain import factors_of, sobol_draws
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.views.building import Building
from extrados.views.frame.frame import EquivalentFrame
from extrados.views.frame.options import FrameOptions

#: Strengths of the masonry, which the factor `strength` multiplies together
STRENGTHS = ("compressive_strength", "cohesion", "diagonal_strength")


@dataclass(frozen=True)
class Sample:
    """Building k has lognormal factors of mean 1 at the point draws[k] of the unit cube, by the sorted names of `uncertain`, whose
    values are coefficients of variation. Every factor holds for the whole building."""

    building: Building
    options: FrameOptions
    uncertain: dict[str, float]
    draws: np.ndarray

    def factors(self, k: int) -> dict[str, float]:
        """Name -> factor of building k."""
        return factors_of(self.uncertain, self.draws[k % len(self.draws)])[0]

    def frame(self, k: int) -> EquivalentFrame:
        """The frame of building k."""
        return varied(self.building, self.options, self.factors(k))


def sample_of(building: Building, options: FrameOptions, uncertain: dict[str, float], count: int, seed: int) -> Sample:
    """So many buildings by a scrambled Sobol sequence; without uncertain values one, the building itself."""
    building = building.apart()
    if not uncertain:
        return Sample(building, options, {}, np.zeros((1, 0)))
    return Sample(building, options, uncertain, sobol_draws(len(uncertain), count, seed))


def varied(building: Building, options: FrameOptions, factors: Mapping[str, float]) -> EquivalentFrame:
    """The frame of a building whose values are multiplied by factors, of UNCERTAIN."""
    if not factors:
        return building.frame(options)
    given = {**factors}
    for name in STRENGTHS if "strength" in given else ():
        given[name] = given.get(name, 1.0) * given["strength"]

    def times(table: Any, names: tuple[str, ...]) -> Any:
        known = {name: getattr(table, name) for name in names if name in given}
        return table.model_copy(update={n: value * given[n] for n, value in known.items() if value is not None})

    plan = building.structure
    assert isinstance(plan, Plan)
    of_walls = {name for wall in plan.walls for name in (wall.material, *wall.materials)}
    materials: dict[str, Material] = {name: times(one, MASONRY) if name in of_walls else one for name, one in building.materials.items()}
    if "floor_stiffness" in given:
        floors = [
            floor if floor.young is None else floor.model_copy(update={"young": floor.young * given["floor_stiffness"]})
            for floor in plan.floors
        ]
        plan = plan.model_copy(update={"floors": floors})
    changed = building.having(
        structure=plan, material=times(building.material, MASONRY), materials=materials, joints=times(building.joints, ("cohesion",))
    ).apart()
    return changed.frame(times(options, (*OPTIONS, "cohesion")))


def refuse_unknown(building: Building, options: FrameOptions, names: list[str]) -> None:
    """Refused where the building or the frame does not have an uncertain value."""
    plan = building.structure
    assert isinstance(plan, Plan)
    of_walls = [name for wall in plan.walls for name in wall.materials or [wall.material or ""]]
    tables = [building.materials.get(name, building.material) for name in of_walls]
    lacking = {
        "compressive_strength": all(one.compressive_strength is None for one in tables),
        "cohesion": options.cohesion is None and not building.joints.cohesion,
        "diagonal_strength": options.diagonal_strength is None,
        "floor_stiffness": all(floor.young is None for floor in plan.floors),
    }
    lacking["strength"] = all(lacking[name] for name in STRENGTHS)
    for name in names:
        if lacking.get(name, False):
            why = "no floor is flexible or made of joists" if name == "floor_stiffness" else "the deck gives no value for it"
            raise Refused(f"{name} cannot be uncertain: {why}", ("analysis", "uncertain", name))
