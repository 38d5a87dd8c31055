"""Flanges: the part of a wall that a wall which meets it can lift."""

from dataclasses import dataclass

from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS


@dataclass(frozen=True)
class Flange:
    """A flange: the wall that lifts it (web), the wall it is part of, the level, its extent along that wall from, to [m], and the
    weight on it on that level [N]."""

    web: int
    wall: int
    level: int
    start: float
    end: float
    weight: float


def side_width(thickness: float, storey: float, total: float, spacing: float, masonry: float) -> float:
    """Effective width [m] of a flange of a thickness on one side of a web: the least of 6 times the thickness, half the height of
    the storey, a fifth of the total height of the web, half the distance to the next parallel wall, and the masonry there
    (after EN 1996-1-1, 5.5.3)."""
    return min(6.0 * thickness, 0.5 * storey, 0.2 * total, 0.5 * spacing, masonry)


def effective_part(
    plan: Plan, junctions: dict[tuple[int, int], tuple[float, float]], web: int, wall: int, level: int, thickness: float, half: float
) -> tuple[float, float]:
    """Extent along `wall` of its part on a level that is a flange of `web`: on each side the effective width from the face of the
    web, `half` its half thickness [m]. Openings of the storey below the level end it."""
    own, at = plan.walls[wall], _place(junctions, web, wall)
    others = [_place(junctions, other, wall) for other in range(len(plan.walls)) if other != web and _meet(junctions, other, wall)]
    total = float(plan.levels[plan.reach(plan.walls[web])[1]])
    ends = []
    for sense in (-1.0, 1.0):
        limit = 0.0 if sense < 0.0 else own.length
        edges = [x for o in plan.openings_in(own, level) for x in o.x if sense * (x - at) > MEETS]
        masonry = min((abs(x - at) for x in (*edges, limit)), default=0.0)
        spacing = min((abs(s - at) for s in others if sense * (s - at) > MEETS), default=float("inf"))
        wide = min(masonry, half + side_width(thickness, plan.storeys[level - 1], total, spacing, masonry))
        ends.append(at + sense * wide)
    return ends[0], ends[1]


def _meet(junctions: dict[tuple[int, int], tuple[float, float]], one: int, two: int) -> bool:
    return (min(one, two), max(one, two)) in junctions


def _place(junctions: dict[tuple[int, int], tuple[float, float]], other: int, wall: int) -> float:
    """Where another wall meets a wall, along the latter [m]."""
    first, second = junctions[min(other, wall), max(other, wall)]
    return second if other < wall else first
