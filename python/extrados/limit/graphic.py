"""Graphic statics of a state: force polygons, funicular polygons and thrust inside tall blocks."""

import numpy as np

from extrados.limit.loads import GRAVITY, Loads
from extrados.limit.states import State
from extrados.structures.assembly import GROUND, Assembly
from extrados.structures.polygons import crossings, cut, properties


def force_polygon(assembly: Assembly, state: State, joints: list[int]) -> np.ndarray:
    """Rays (k, 2) [N] from the pole: the force that the part left of each joint of a chain puts on the right.

    Their tips, joined, are the load line: from one tip to the next leads the load of the voussoir between.
    """
    force = state.force(assembly)[joints]
    to_right = assembly.middle[joints[-1], 0] - assembly.middle[joints[0], 0] >= 0.0
    towards_a = np.array([_leads_to(assembly, joints, i) for i in range(len(joints))])
    sign = np.where(towards_a == to_right, 1.0, -1.0)
    return force * sign[:, None]


def _leads_to(assembly: Assembly, joints: list[int], i: int) -> bool:
    """True where block a of the i-th joint of a chain is the next along it."""
    if i + 1 < len(joints):
        j = joints[i + 1]
        return int(assembly.a[joints[i]]) in (int(assembly.a[j]), int(assembly.b[j])) and assembly.a[joints[i]] != GROUND
    j = joints[i - 1]
    return int(assembly.b[joints[i]]) in (int(assembly.a[j]), int(assembly.b[j])) and assembly.b[joints[i]] != GROUND


def funicular(assembly: Assembly, loads: Loads, state: State, joints: list[int]) -> np.ndarray:
    """Vertices (k + 1, 2) [m] of the funicular polygon of a chain of k joints.

    Its corners lie on the lines of action of the loads; it starts and ends at the end joints.
    """
    points = state.points(assembly)[joints]
    rays = force_polygon(assembly, state, joints)
    corners = [points[0]]
    for i in range(len(joints) - 1):
        shared = {int(assembly.a[joints[i]]), int(assembly.b[joints[i]])} & {
            int(assembly.a[joints[i + 1]]), int(assembly.b[joints[i + 1]])
        }  # fmt: skip
        block = next(iter(shared - {GROUND}), None)
        middle = 0.5 * (points[i] + points[i + 1])
        if block is not None:
            load = loads.dead[block] + state.gamma * loads.live[block]
            middle = _meet(points[i], rays[i], load, middle)
        corners.append(middle)
    return np.array([*corners, points[-1]])


def _meet(point: np.ndarray, ray: np.ndarray, load: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
    """Where the ray through a point meets the line of action of a load (force and moment about the origin)."""
    across = ray[0] * load[1] - ray[1] * load[0]
    if abs(across) < 1e-12 * float(np.hypot(*ray) * np.hypot(*load[:2]) + 1e-300):
        return otherwise
    # x f_y - y f_x = m for points on the load's line
    share = (load[2] - (point[0] * load[1] - point[1] * load[0])) / across
    return point + share * ray


def section_force(
    assembly: Assembly, block: int, level: float, state: State, loads: Loads, sway: float = 1.0
) -> tuple[np.ndarray, float]:
    """Force (2) [N] that crosses a horizontal section of a block downward, and the x where it does [m].

    Sums the forces on the part above `level`: its joints there and its loads, less the weight below.
    sway: the part of gamma that accelerates the weight.
    """
    total = loads.dead[block] + state.gamma * loads.live[block]
    force, points = state.force(assembly), state.points(assembly)
    for j in assembly.joints_of(block):
        if GROUND in (assembly.a[j], assembly.b[j]) or assembly.middle[j, 1] < level:
            continue
        f = force[j] if assembly.a[j] == block else -force[j]
        total = total + np.array([f[0], f[1], points[j, 0] * f[1] - points[j, 1] * f[0]])
    outline = assembly.outlines[block]
    below = cut(outline, np.array([0.0, level]), np.array([0.0, -1.0]))
    if len(below) >= 3:
        area, (x, y), _ = properties(below)
        weight = area / properties(outline)[0] * assembly.mass[block] * GRAVITY
        side = sway * state.gamma * weight
        total = total - np.array([side, -weight, -x * weight - y * side])
    return total[:2], float((total[2] + level * total[0]) / total[1])


def pier_line(assembly: Assembly, loads: Loads, state: State, block: int, sections: int = 24) -> np.ndarray:
    """Thrust line (k, 2) [m] down a block that stands on the ground, on horizontal sections above its base."""
    base = [j for j in assembly.joints_of(block) if GROUND in (assembly.a[j], assembly.b[j])]
    if len(base) != 1 or abs(float(np.diff([assembly.p[base[0], 1], assembly.q[base[0], 1]])[0])) > 1e-9:
        return np.empty((0, 2))
    joints = [j for j in assembly.joints_of(block) if j != base[0]]
    if not joints:
        return np.empty((0, 2))
    foot = float(assembly.middle[base[0], 1])
    top = max(float(max(assembly.p[j, 1], assembly.q[j, 1])) for j in joints)
    start = max(joints, key=lambda j: assembly.middle[j, 1])
    line = [state.points(assembly)[start]]
    for level in np.linspace(top, foot, sections + 1)[1:-1]:
        if level >= line[0][1] or len(crossings(assembly.outlines[block], level)) != 2:
            continue
        force, x = section_force(assembly, block, float(level), state, loads)
        if force[1] < 0.0:
            line.append(np.array([x, level]))
    return np.array([*line, state.points(assembly)[base[0]]])
