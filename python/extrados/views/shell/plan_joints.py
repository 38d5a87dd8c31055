"""Joints between walls of a plan, along their beds and under their soles."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry
from extrados.model.properties import NO_SLIDING
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, Corner, PlanWall, Seat
from extrados.views.shell.mesh import ShellJoint, ShellPart
from extrados.views.shell.plan_grid import WallGrid, thickness_at

#: Bond of a seat over the pressure on it, and the slip [m] over which it is lost: friction alone carries a load
SEAT_BOND, SEAT_SLIP = 1e-3, 1e-5
#: A joint without a stiffness has that of a layer of masonry, as thick as this part of the elements' size
LAYER = 1.0 / 25.0


def make_joints(
    plan: Plan, grids: list[WallGrid], junctions: dict, number: np.ndarray, parts: list[ShellPart], nodes: int
) -> tuple[list[ShellJoint], np.ndarray]:
    """Joints between walls and bed joints; above a bed joint the walls stand on copies of its nodes, numbered from `nodes`
    on. The nodes that are copied."""
    copies: dict[tuple[int, int], int] = {}  # row of the grids and node: its copy
    beds: list[tuple[str, int, list[int]]] = []  # name, row of the grids, walls
    for k, (bed, name) in enumerate(zip(plan.beds, plan.joint_names[len(plan.joint_names) - len(plan.beds) :], strict=True)):
        walls = [
            w
            for w, wall in enumerate(plan.walls)
            if (wall.name in bed.walls or not bed.walls) and plan.reach(wall)[0] <= bed.storey <= plan.reach(wall)[1]
        ]
        row = int(np.abs(grids[0].z - plan.bed_height(bed)).argmin())
        on = {w: _cells_above(grids[w], row, number) for w in range(len(grids))}
        if not any(len(on[w]) for w in walls):
            raise BadGeometry(
                f"bed joint at {plan.bed_height(bed):g} m: no wall of the joint has masonry above this height", ("structure", "beds", k)
            )
        stay = {n for w in on if w not in walls for n in on[w].ravel().tolist()}  # there a wall passes through the joint
        for n in sorted({n for w in walls for n in on[w].ravel().tolist()} - stay):
            copies[row, n] = nodes + len(copies)
        for w in walls:
            part = parts[w]
            connect, base = part.connect.copy(), np.nonzero(grids[w].there)[1] == row
            connect[base, :2] = [[copies.get((row, n), n) for n in pair] for pair in connect[base, :2].tolist()]
            parts[w] = replace(part, connect=connect)
        beds.append((name, row, walls))

    def foot(row: int, n: int) -> int:
        return copies.get((row, n), n)

    found = []
    for corner in plan.corners:
        if corner.bond == "joint":
            found.append(_between(plan, corner, grids, junctions, number, foot))
    for name, row, walls in beds:
        for w in walls:
            grid, wall = grids[w], plan.walls[w]
            beside = grid.there[:, row] & (grid.there[:, row - 1] if row > 0 else True)
            i = np.flatnonzero(beside)
            if not len(i):
                continue
            lower = np.column_stack([number[grid.number(i, np.full(len(i), row))], number[grid.number(i + 1, np.full(len(i), row))]])
            upper = np.array([[foot(row, n) for n in pair] for pair in lower.tolist()])
            along = np.append(wall.direction, 0.0)
            found.append(
                _stretches(
                    name,
                    np.column_stack([lower, upper[:, ::-1]]),
                    np.diff(grid.s)[i],
                    np.array([0.0, 0.0, 1.0]),
                    along,
                    thickness_at(plan, wall, np.full(len(i), 0.5 * (grid.z[row] + grid.z[row + 1]))),
                    wall.name,
                )
            )
    sources = np.array([n for _, n in copies], dtype=int)
    return found, sources


#: What the joints of a building take from [joints], and what [[joints.types]] may say of some
STRENGTHS = ("tension", "fracture_energy", "friction", "cohesion", "shear_energy", "compressive_strength", "crushing_energy")


def strength_of_joint(plan: Plan, building: Description, name: str, size: float) -> dict[str, float]:
    """What [joints] and [[joints.types]] say of a joint; NaN where they say nothing, of friction where it excludes sliding."""
    own = {what: getattr(building.joints, what) for what in (*STRENGTHS, "normal_stiffness")}
    named: dict[str, int] = {}
    for k, kind in enumerate(building.joints.types):
        for joint in kind.joints:
            key = ("joints", "types", k, "joints")
            if joint not in plan.joint_names:
                raise BadGeometry(f"joint '{joint}' does not exist; the joints are {', '.join(plan.joint_names)}", key)
            if named.setdefault(joint, k) != k:
                raise BadGeometry(f"joint '{joint}' is named twice, in joints.types {named[joint] + 1} and {k + 1}", key)
        if name in kind.joints:
            own |= {what: value for what in own if (value := getattr(kind, what)) is not None}
    for strength, energy in (("tension", "fracture_energy"), ("cohesion", "shear_energy")):
        if own[strength] > 0.0 and own[energy] is None:
            raise BadGeometry(f"joint '{name}' has a {strength} but no {energy}", ("joints", energy))
    if (own["compressive_strength"] is None) != (own["crushing_energy"] is None):
        raise BadGeometry(f"joint '{name}': `compressive_strength` and `crushing_energy` require each other", ("joints",))
    if not own["tension"] > 0.0:
        raise BadGeometry(
            f"joint '{name}' has no `tension`. A joint between shells must hold until it opens: give a "
            "`tension`, however small, with a `fracture_energy`",
            ("joints", "tension"),
        )
    if own["friction"] == NO_SLIDING:
        own["friction"] = None
    if own["normal_stiffness"] is None:
        own["normal_stiffness"] = building.material.young / (LAYER * size)
    shear = building.joints.shear_stiffness
    own["shear_stiffness"] = building.joints.shear_ratio * own["normal_stiffness"] if shear is None else shear
    return {what: np.nan if value is None else float(value) for what, value in own.items()}


def make_seat(
    seat: Seat, floor: str, wall: PlanWall, s: np.ndarray, nodes: np.ndarray, inward: np.ndarray, pressure: float, stiffness: float
) -> ShellJoint:
    """The seat of a floor on a wall. s: places along the wall (n) [m]; nodes (n, 2) of the wall and of the floor there; inward: horizontal
    unit vector (3) towards the floor; pressure on the seat [Pa]; stiffness of a layer of masonry as thick as an element [Pa/m]."""
    count, bond = len(s) - 1, SEAT_BOND * pressure
    lower, upper = nodes.T
    strength = dict.fromkeys(("compressive_strength", "crushing_energy"), np.nan) | {
        "tension": bond,
        "fracture_energy": bond * SEAT_SLIP,
        "cohesion": bond,
        "shear_energy": bond * SEAT_SLIP,
        "friction": seat.friction,
        "normal_stiffness": stiffness / LAYER,
        "shear_stiffness": stiffness / LAYER,
    }
    return ShellJoint(
        f"{floor} on {wall.name}",
        np.column_stack([lower[:-1], lower[1:], upper[1:], upper[:-1]]),
        np.tile([0.0, 0.0, 1.0], (count, 1)),
        np.tile(np.append(wall.direction, 0.0), (count, 1)),
        np.tile(inward, (count, 1)),
        np.diff(s),
        np.full(count, seat.length),
        wall.name,
        strength,
        "linear",
        floor,
    )


def _cells_above(grid: WallGrid, row: int, number: np.ndarray) -> np.ndarray:
    """Lower nodes (cells, 2) of the cells of a wall that stand on a line of the grid."""
    i = np.flatnonzero(grid.there[:, row]) if row < grid.there.shape[1] else np.empty(0, dtype=int)
    row_of = np.full(len(i), row)
    return np.column_stack([number[grid.number(i, row_of)], number[grid.number(i + 1, row_of)]])


def _between(
    plan: Plan, corner: Corner, grids: list[WallGrid], junctions: dict, number: np.ndarray, foot: Callable[[int, int], int]
) -> ShellJoint:
    """The joint at which the second wall of a corner abuts on the first; foot: the node above a bed joint of a node at it."""
    names = [wall.name for wall in plan.walls]
    one, two = (names.index(name) for name in corner.walls)
    at = junctions[min(one, two), max(one, two)]
    s, t = at if one < two else at[::-1]
    wall, grid, other = plan.walls[two], grids[two], grids[one]
    key = ("structure", "corners", plan.corners.index(corner))
    if MEETS < t < wall.length - MEETS:
        raise BadGeometry(
            f"walls: wall '{wall.name}' passes through wall '{names[one]}'. A joint requires that wall '{wall.name}' "
            f"ends on wall '{names[one]}'",
            key,
        )
    first = t <= MEETS  # it begins there
    j = 0 if first else len(grid.s) - 1
    i = int(np.abs(other.s - s).argmin())
    own = grid.there[0 if first else -1]
    beside = np.zeros(len(own), dtype=bool)
    for column in (i - 1, i):
        if 0 <= column < other.there.shape[0]:
            beside |= other.there[column]
    k = np.flatnonzero(own & beside)
    if not len(k):
        raise BadGeometry(f"walls: '{names[one]}' and '{wall.name}' have no common height at this joint", key)
    lower, upper = (
        np.array([[foot(int(r), int(low)), int(high)] for r, low, high in zip(k, nodes[k], nodes[k + 1], strict=True)])
        for nodes in (number[g.number(np.array(c), np.arange(len(g.z)))] for g, c in ((other, i), (grid, j)))
    )
    normal = np.append(wall.direction if first else -wall.direction, 0.0)
    return _stretches(
        "-".join(corner.walls),
        np.column_stack([lower, upper[:, ::-1]]),
        np.diff(grid.z)[k],
        normal,
        np.array([0.0, 0.0, 1.0]),
        thickness_at(plan, wall, 0.5 * (grid.z[k] + grid.z[k + 1])),
        wall.name,
    )


def _stretches(
    name: str, connect: np.ndarray, length: np.ndarray, normal: np.ndarray, along: np.ndarray, thickness: np.ndarray, wall: str
) -> ShellJoint:
    n, t, out = (np.tile(axis, (len(connect), 1)) for axis in (normal, along, np.cross(along, normal)))
    return ShellJoint(name, connect, n, t, out, length, thickness, wall)
