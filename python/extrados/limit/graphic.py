"""Graphic statics of a state: force polygons, funicular polygons and thrust inside tall blocks."""

import numpy as np

from extrados.limit.loads import Loads
from extrados.limit.states import State
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import inner_stones, is_stack
from extrados.model.geometry.polygons import below
from extrados.schema.constants import GRAVITY

ROUNDING = 1e-12  # of the greatest compression


def force_polygon(assembly: Assembly, state: State, joints: list[int]) -> np.ndarray:
    """Rays (k, 2) [N] from the pole: the force that the part left of each joint of a chain puts on the right.

    Their tips, joined, are the load line: from one tip to the next leads the load of the voussoir between.
    """
    return state.force(assembly)[joints] * senses(assembly, joints)[:, None]


def thrust_of(assembly: Assembly, state: State, joints: list[int], at: int = 0) -> float:
    """Horizontal thrust of a chain across its first joint, or the one `at` [N]; negative where it would pull."""
    thrust = float(force_polygon(assembly, state, joints)[at, 0])
    return thrust if abs(thrust) > ROUNDING * state.normal.max() else 0.0


def thrust_joint(assembly: Assembly, loads: Loads, joints: list[int]) -> int:
    """Which joint of a chain its thrust is told at: the first, an arch's left springing; or, where ties hold its stones
    and so take of the thrust before it reaches the springing, the highest, its crown."""
    if is_stack(assembly, joints) or not loads.tied & inner_stones(assembly, joints):
        return 0
    return int(assembly.middle[joints, 1].argmax())


def senses(assembly: Assembly, joints: list[int]) -> np.ndarray:
    """+1 for each joint of a chain whose force on block a is what its left part puts on its right part, else -1."""
    to_right = assembly.middle[joints[-1], 0] - assembly.middle[joints[0], 0] >= 0.0
    towards_a = np.array([_leads_to(assembly, joints, i) for i in range(len(joints))])
    return np.where(towards_a == to_right, 1.0, -1.0)


def _leads_to(assembly: Assembly, joints: list[int], i: int) -> bool:
    """True where block a of the i-th joint of a chain is the next along it."""
    ends = assembly.ends
    a, b = ends[joints[i]]
    if len(joints) == 1:
        return a != GROUND
    if i + 1 < len(joints):
        return a != GROUND and a in ends[joints[i + 1]]
    return b != GROUND and b in ends[joints[i - 1]]


def funicular(assembly: Assembly, loads: Loads, state: State, joints: list[int]) -> np.ndarray:
    """Vertices (k + 1, 2) [m] of the funicular polygon of a chain of k joints.

    Its corners lie on the lines of action of the loads; it starts and ends at the end joints.
    """
    points = state.points(assembly)[joints]
    rays = force_polygon(assembly, state, joints)
    corners = [points[0]]
    for i in range(len(joints) - 1):
        shared = {int(assembly.a[joints[i]]), int(assembly.b[joints[i]])} & {int(assembly.a[joints[i + 1]]), int(assembly.b[joints[i + 1]])}
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


def section_forces(
    assembly: Assembly, block: int, levels: np.ndarray, state: State, loads: Loads, sway: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Forces (k, 2) [N] that cross horizontal sections of a block downward, and the x where they do (k) [m], NaN
    where no vertical force crosses.

    Sums the forces on the part above each level: its joints there and its loads, less the weight below.
    sway: the part of gamma that accelerates the weight.
    """
    total = np.empty((len(levels), 3))
    total[:] = loads.dead[block] + state.gamma * loads.live[block]
    for j in assembly.bounds[block]:
        if GROUND in assembly.ends[j]:
            continue
        n, t = float(state.normal[j]), float(state.shear[j])
        (nx, ny), (tx, ty) = assembly.normal[j].tolist(), assembly.tangent[j].tolist()
        (px, py), (qx, qy), share = assembly.p[j].tolist(), assembly.q[j].tolist(), float(state.position[j])
        on = 1.0 if assembly.ends[j][0] == block else -1.0
        fx, fy = on * (n * nx + t * tx), on * (n * ny + t * ty)
        moment = (px + share * (qx - px)) * fy - (py + share * (qy - py)) * fx
        total[levels <= float(assembly.middle[j, 1])] += (fx, fy, moment)
    if (answers := loads.resistance) is not None:
        on = answers.block == block
        force = state.mobilised[answers.number[on], None] * answers.wrench[on]
        total = total + (answers.point[on, 1] >= levels[:, None]).astype(float) @ force
    found = below(assembly.outlines[block], np.append(levels, np.inf))
    weight, first, second = found[:-1].T * (assembly.mass[block] * GRAVITY / found[-1, 0])
    side = sway * state.gamma
    total[:, 0] -= side * weight
    total[:, 1] += weight
    total[:, 2] += first + side * second
    x = np.divide(total[:, 2] + levels * total[:, 0], total[:, 1], out=np.full(len(levels), np.nan), where=total[:, 1] != 0.0)
    return total[:, :2], x
