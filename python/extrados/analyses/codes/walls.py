"""The walls of a building on a plan out of their planes: each, above the foot of each of its storeys, as one body that turns."""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes.kinematics import NoMechanism, Overturning, Weight
from extrados.analyses.codes.mechanisms import set_back
from extrados.analyses.context import Refused
from extrados.model.errors import BadGeometry
from extrados.model.properties import Material
from extrados.model.structures.plan import MEETS, Plan, PlanWall
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building


@dataclass(frozen=True)
class WallPart:
    """A wall above the foot of a storey (from 1), which stands `foot` [m] above the ground, as a body about its edge there."""

    wall: str
    storey: int
    foot: float
    body: Overturning


def wall_parts(building: Building) -> list[WallPart]:
    """Every wall above the foot of each storey above which nothing holds it.

    Simple overturning: walls across, flexible floors, joists and rods hold no wall; rigid floors and props do. Floors load the
    walls that carry them, by their length, on the middle plane. NoMechanism where every wall is held.
    """
    plan = building.structure
    assert isinstance(plan, Plan)
    loads, held = _floors(plan)
    parts = []
    for wall in plan.walls:
        first, last = plan.reach(wall)
        free = max((k + 1 for k in held[wall.name] if first <= k <= last), default=first)
        parts += [_part(building, plan, wall, storey, loads) for storey in range(free, last + 1)]
    if not parts:
        raise NoMechanism(
            "Rigid floors or props restrain the top of every wall, so no wall overturns out of its plane as one body. The "
            "bending of a wall between its floors is not checked"
        )
    return parts


def _floors(plan: Plan) -> tuple[dict[tuple[str, int], float], dict[str, set[int]]]:
    """Load [N] that each wall bears on top of each storey, and the storeys on top of which each wall is held."""
    loads: dict[tuple[str, int], float] = defaultdict(float)
    held: dict[str, set[int]] = defaultdict(set)
    for k, floor in enumerate(plan.floors):
        ring = plan.around(floor)
        corner = np.array([np.asarray(plan.walls[w].start) + s * plan.walls[w].direction for w, s, _ in ring])
        x, y = corner.T
        area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
        lengths = {plan.walls[w].name: abs(end - start) for w, start, end in ring}
        bearing = {name: lengths[name] for name in floor.bears_on if name in lengths} if floor.bears_on else lengths
        if floor.load > 0.0 and not bearing:
            raise BadGeometry(
                f"floor on storey {floor.storey}: none of the walls that carry its load is adjacent to it",
                ("structure", "floors", k, "bears_on"),
            )
        for name, length in bearing.items():
            loads[name, floor.storey] += floor.load * area * length / sum(bearing.values())
        if floor.kind == "rigid":
            for name in lengths:
                held[name].add(floor.storey)
    for prop in plan.props:
        held[prop.wall].add(prop.storey)
    return loads, held


def _material(building: Building, plan: Plan, wall: PlanWall, storey: int) -> Material:
    """The material of a wall in a storey; BadGeometry if the deck has no table of that name."""
    name = plan.material_of(wall, storey)
    if name is not None and name not in building.materials:
        raise BadGeometry(f"wall '{wall.name}': the deck has no [materials.{name}]", ("structure", "walls", plan.walls.index(wall)))
    return building.material if name is None else building.materials[name]


def _part(building: Building, plan: Plan, wall: PlanWall, storey: int, loads: dict[tuple[str, int], float]) -> WallPart:
    first, last = plan.reach(wall)
    materials = {k: _material(building, plan, wall, k) for k in range(storey, last + 1)}
    thickness = [plan.thickness_of(wall, k) for k in range(first, last + 1)]
    foot, arm = float(plan.levels[storey - 1]), 0.5 * thickness[storey - first]
    sole = plan.strips(wall, storey)[0][0]
    if not sole > MEETS:
        number = plan.walls.index(wall)
        raise Refused(
            f"wall '{wall.name}' has no masonry at the foot of storey {storey}: openings occupy its whole length",
            ("structure", "walls", number, "openings"),
        )
    mass = moment = 0.0  # kg, and about the foot kg m
    for k in range(storey, last + 1):
        floor = float(plan.levels[k - 1]) - foot
        for length, low, high in plan.strips(wall, k):
            part = materials[k].density * thickness[k - first] * length * (high - low)
            mass += part
            moment += part * (floor + 0.5 * (low + high))
    if not mass > 0.0:
        raise Refused("the moving part has no weight: give a density above zero", ("material", "density"))
    weights = [Weight(GRAVITY * mass, arm, moment / mass)]
    for k in range(storey, last + 1):
        top = float(plan.levels[k]) - foot
        if loads.get((wall.name, k), 0.0) > 0.0:
            weights.append(Weight(loads[wall.name, k], arm, top))
        weights += [Weight(p.force, arm, top, sways=False) for p in plan.prestress if p.wall == wall.name and (p.level or last) == k]
    strength = materials[storey].compressive_strength
    if strength is not None:
        weights = set_back(weights, strength, sole, 2.0 * arm)
    return WallPart(wall.name, storey, foot, Overturning(tuple(weights)))
