"""The walls of a building on a plan out of their planes: each, above the foot of each of its storeys, as one body that turns."""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes.kinematics import NoMechanism, Overturning, Push, Weight
from extrados.analyses.codes.mechanisms import set_back
from extrados.analyses.context import Refused
from extrados.model.errors import BadGeometry, blaming
from extrados.model.geometry.polygons import signed_area
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, PlanWall
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building


@dataclass(frozen=True)
class WallPart:
    """A wall above the foot of a storey (from 1), which stands `foot` [m] above the ground, as a body about its edge there; or
    its gable alone, above its highest storey."""

    wall: str
    storey: int
    foot: float
    body: Overturning
    gable: bool = False

    @property
    def words(self) -> str:
        """Name in results."""
        if self.gable:
            return f"gable of wall {self.wall}"
        return f"wall {self.wall}" if self.storey == 1 else f"wall {self.wall} above the foot of storey {self.storey}"


@dataclass
class FloorActions:
    """What floors and props do to walls. Of each wall and storey: load [N] on its top, the part of it that rests on the gable, thrust
    (2) [N] there; and whether a floor or a prop restrains the top, and a rigid roof the gable."""

    loads: dict[tuple[str, int], float]
    on_gable: dict[str, float]
    thrusts: dict[tuple[str, int], np.ndarray]
    held: dict[str, set[int]]
    held_gables: set[str]


def wall_parts(building: Building) -> list[WallPart]:
    """Every wall above the foot of each storey above which nothing holds it.

    Simple overturning: walls across, flexible floors, joists, rods and floors with a seat hold no wall; other rigid floors and props do.
    Floors load the walls that carry them, by their length, on the middle plane; purlins load a gable at half its rise. Rafters push
    on their walls.
    Every gable is also a part of its own, unless a rigid roof restrains it. NoMechanism where every wall is held.
    """
    plan = building.structure
    assert isinstance(plan, Plan)
    actions = floor_actions(plan)
    parts = [part for wall in plan.walls for part in parts_of_wall(building, wall, actions)]
    if not parts:
        raise NoMechanism(
            "Rigid floors or props restrain the top of each wall, so no wall overturns out of its plane as "
            "one body. The bending of a wall between two floors is not checked"
        )
    return parts


def parts_of_wall(building: Building, wall: PlanWall, actions: FloorActions) -> list[WallPart]:
    """A wall above the foot of each storey above which nothing holds it, and its free gable; none of a wall that is held. Refused or
    CannotStand where the masonry at a foot does not carry the weight."""
    plan = building.structure
    assert isinstance(plan, Plan)
    first, last = plan.reach(wall)
    free = max((k + 1 for k in actions.held[wall.name] if first <= k <= last), default=first)
    own = list(range(free, last + 1))
    if wall.gable is not None and wall.name not in actions.held_gables:
        own.append(last + 1)
    return [_part(building, plan, wall, storey, actions) for storey in own]


def floor_actions(plan: Plan) -> FloorActions:
    """What floors and props do to each wall; BadGeometry if a floor names a wall that is not adjacent to it."""
    found = FloorActions(defaultdict(float), defaultdict(float), defaultdict(lambda: np.zeros(2)), defaultdict(set), set())
    for k, floor in enumerate(plan.floors):
        with blaming("floors", k):
            ring = plan.around(floor)
            bearing = plan.bearing(floor, ring)
        area = abs(signed_area(plan.outline(ring)))
        total = sum(abs(b - a) for _, a, b in bearing)
        for w, a, b in bearing:
            wall = plan.walls[w]
            share = floor.weight * area * abs(b - a) / total
            found.loads[wall.name, floor.storey] += share
            if floor.roof == "purlins" and wall.gable is not None and floor.storey == plan.reach(wall)[1]:
                found.on_gable[wall.name] += share
        for w, _, _, force in plan.thrusts(floor, ring):
            found.thrusts[plan.walls[w].name, floor.storey] += force
        if floor.kind == "rigid" and floor.seat is None:  # a seat holds by friction alone
            for w, _, _ in ring:
                found.held[plan.walls[w].name].add(floor.storey)
                if floor.roof is not None and floor.storey == plan.reach(plan.walls[w])[1]:
                    found.held_gables.add(plan.walls[w].name)
    for prop in plan.props:
        found.held[prop.wall].add(prop.storey)
    return found


def material_of(building: Building, plan: Plan, wall: PlanWall, storey: int) -> Material:
    """The material of a wall in a storey; BadGeometry if the deck has no table of that name."""
    name = plan.material_of(wall, storey)
    if name is not None and name not in building.materials:
        raise BadGeometry(f"wall '{wall.name}': the deck has no [materials.{name}]", ("structure", "walls", plan.walls.index(wall)))
    return building.material if name is None else building.materials[name]


def _masonry(building: Building, plan: Plan, wall: PlanWall, storey: int) -> list[tuple[float, float]]:
    """Masses [kg] of a wall above the foot of a storey, and the heights [m] of their centres above it; the gable is the last."""
    last = plan.reach(wall)[1]
    foot = float(plan.levels[storey - 1])
    found = []
    for k in range(storey, last + 1):
        unit = material_of(building, plan, wall, k).density * plan.thickness_of(wall, k)
        floor = float(plan.levels[k - 1]) - foot
        found += [(unit * length * (high - low), floor + 0.5 * (low + high)) for length, low, high in plan.strips(wall, k)]
    if wall.gable is not None:
        unit = material_of(building, plan, wall, last).density * plan.thickness_of(wall, last)
        found.append((0.5 * unit * wall.length * wall.gable.rise, float(plan.levels[last]) - foot + wall.gable.rise / 3.0))
    return found


def _part(building: Building, plan: Plan, wall: PlanWall, storey: int, actions: FloorActions) -> WallPart:
    """The part of a wall above the foot of a storey; of the storey above its highest, its gable."""
    last = plan.reach(wall)[1]
    base = min(storey, last)
    foot, arm = float(plan.levels[storey - 1]), 0.5 * plan.thickness_of(wall, base)
    sole = plan.strips(wall, storey)[0][0] if storey <= last else wall.length
    if not sole > MEETS:
        number = plan.walls.index(wall)
        raise Refused(
            f"wall '{wall.name}' has no masonry at the foot of storey {storey}: openings occupy its whole length",
            ("structure", "walls", number, "openings"),
        )
    parts = _masonry(building, plan, wall, storey)
    mass, moment = sum(m for m, _ in parts), sum(m * z for m, z in parts)
    if not mass > 0.0:
        raise Refused("the moving part has no weight: give a density above zero", ("material", "density"))
    weights = [Weight(GRAVITY * mass, arm, moment / mass)]
    on_gable, rise = actions.on_gable.get(wall.name, 0.0), 0.0 if wall.gable is None else wall.gable.rise
    if on_gable > 0.0:
        weights.append(Weight(on_gable, arm, float(plan.levels[last]) - foot + 0.5 * rise))
    pushes = []
    normal = np.array([-wall.direction[1], wall.direction[0]])
    for k in range(storey, last + 1):
        top = float(plan.levels[k]) - foot
        load = actions.loads.get((wall.name, k), 0.0) - (on_gable if k == last else 0.0)
        if load > 1e-9 * on_gable:
            weights.append(Weight(load, arm, top))
        weights += [Weight(p.force, arm, top, sways=False) for p in plan.prestress if p.wall == wall.name and (p.level or last) == k]
        thrust = abs(float(actions.thrusts.get((wall.name, k), np.zeros(2)) @ normal))
        pushes += [Push(thrust, top)] if thrust > 0.0 else []
    strength = material_of(building, plan, wall, base).compressive_strength
    if strength is not None:
        weights = set_back(weights, strength, sole, 2.0 * arm)
    return WallPart(wall.name, storey, foot, Overturning(tuple(weights), tuple(pushes)), storey > last)
