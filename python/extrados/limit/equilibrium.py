"""Joint forces of an assembly as affine functions of its redundants: the force method.

Every loop of the block graph adds three redundants, the resultant across the joint that closes it. All
other joint forces follow from equilibrium, so that an arch of any number of voussoirs is a programme of
four unknowns: (H, V, M) and the load multiplier gamma (thesis 3.3; the reduction is our own).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from extrados.limit.loads import Loads
from extrados.model.geometry.assembly import GROUND, Assembly

LEVEL = 1e-6  # of a unit normal: a joint that leans this little carries nothing


class Disconnected(ValueError):
    """A block hangs on no joint that leads to the ground."""


@dataclass(frozen=True)
class Tree:
    """A spanning tree of the blocks, rooted at the ground.

    parent_joint[block] is the joint that carries it; `order` lists the blocks from the ground outward,
    `preorder` depth first, so that what hangs on the block at place i are places i .. i + subtree[i] - 1.
    """

    parent_joint: np.ndarray
    order: list[int]
    preorder: np.ndarray
    subtree: np.ndarray

    def loops(self, joints: int) -> np.ndarray:
        """The joints that close a loop."""
        closing = np.ones(joints, dtype=bool)
        closing[self.parent_joint] = False
        return np.flatnonzero(closing)


def spanning_tree(assembly: Assembly) -> Tree:
    """Breadth first from the ground, which keeps the chains short and the numbers well conditioned."""
    tree, lost = _tree(assembly.a.astype(int).tobytes(), assembly.b.astype(int).tobytes(), len(assembly.mass))
    if tree is None:
        names = [assembly.block_names[i] for i in lost]
        more = f" and {len(names) - 5} more" if len(names) > 5 else ""
        raise Disconnected(f"these blocks are not connected to the ground by any joint: {', '.join(names[:5])}{more}")
    return tree


@lru_cache(maxsize=8)
def _tree(a: bytes, b: bytes, blocks: int) -> tuple[Tree | None, list[int]]:
    """The tree of joints between blocks a and b, or the blocks that none reaches: all sections of a sweep have one."""
    joint_a, joint_b = np.frombuffer(a, dtype=int).tolist(), np.frombuffer(b, dtype=int).tolist()
    touching: list[list[tuple[int, int]]] = [[] for _ in range(blocks + 1)]
    for j, (one, two) in enumerate(zip(joint_a, joint_b, strict=True)):
        touching[one].append((j, two))  # GROUND = -1 is the last list
        touching[two].append((j, one))
    parent = [-1] * blocks
    children: list[list[int]] = [[] for _ in range(blocks + 1)]
    order: list[int] = []
    front = [GROUND]
    while front:
        reached = []
        for here in front:
            for j, block in touching[here]:
                if block != GROUND and parent[block] < 0:
                    parent[block] = j
                    children[here].append(block)
                    reached.append(block)
        order += reached
        front = reached
    if len(order) < blocks:
        return None, [i for i in range(blocks) if parent[i] < 0]
    size = [1] * blocks
    for block in reversed(order):
        j = parent[block]
        below = joint_b[j] if joint_a[j] == block else joint_a[j]
        if below != GROUND:
            size[below] += size[block]
    preorder: list[int] = []
    stack = children[GROUND][::-1]
    while stack:
        block = stack.pop()
        preorder.append(block)
        stack += children[block][::-1]
    pre = np.array(preorder)
    return Tree(np.array(parent), order, pre, np.array(size)[pre]), []


@dataclass(frozen=True)
class JointForces:
    """Corner forces of joint j: n_p, n_q (compression at the ends p and q) and the shear s from p to q.

    Each is `rows @ x`, x = (redundants..., shares of the pushes..., gamma, 1), forces divided by `weight` and redundant moments by
    weight times `size`, so that the numbers stay near one. rows has shape (joints, 3, len(x)).
    """

    rows: np.ndarray
    weight: float
    size: float
    tree: Tree

    @property
    def unknowns(self) -> int:
        """Redundants, shares and gamma."""
        return self.rows.shape[2] - 1


def joint_forces(assembly: Assembly, loads: Loads, tree: Tree) -> JointForces:
    """Corner forces of all joints under the dead loads, gamma times the live loads, and pushes that answer."""
    parent = tree.parent_joint
    n_joint = len(assembly.a)
    loops = tree.loops(n_joint)
    columns = 3 * len(loops) + loads.pushes + 2
    weight, size = loads.scale, assembly.size
    unit = weight * np.array([1.0, 1.0, size])

    # Resultant on block a of each joint: force x, force y, moment about the origin.
    resultant = np.zeros((n_joint, 3, columns))
    load = np.zeros((len(assembly.mass), 3, columns))
    load[:, :, -2] = loads.live / unit
    load[:, :, -1] = loads.dead / unit
    if loads.resistance is not None:
        load[:, :, 3 * len(loops) : -2] = loads.resistance.spread(len(load)) / unit[:, None]
    if len(loops):
        k = 3 * np.arange(len(loops))
        middle = assembly.middle[loops] / size
        resultant[loops, 0, k] = resultant[loops, 1, k + 1] = resultant[loops, 2, k + 2] = 1.0
        resultant[loops, 2, k] = -middle[:, 1]  # the redundant moment is taken about the joint's middle
        resultant[loops, 2, k + 1] = middle[:, 0]
        for ends, sign in ((assembly.a[loops], 1.0), (assembly.b[loops], -1.0)):
            held = ends != GROUND
            np.add.at(load, ends[held], sign * resultant[loops[held]])
    # A parent joint hands on all that hangs on it: a difference of running sums along the preorder.
    running = np.cumsum(load[tree.preorder], axis=0)
    place = np.arange(len(parent))
    carried = running[place + tree.subtree - 1]
    carried[1:] -= running[:-1]
    joints = parent[tree.preorder]
    on_a = assembly.a[joints] == tree.preorder
    resultant[joints] = carried * np.where(on_a, -1.0, 1.0)[:, None, None]

    p, q = assembly.p / size, assembly.q / size
    length = assembly.length / size
    normal, tangent = assembly.normal, assembly.tangent
    chi = (tangent[:, 0] * normal[:, 1] - tangent[:, 1] * normal[:, 0]) / length

    def moment_about(point: np.ndarray) -> np.ndarray:
        return resultant[:, 2] - (point[:, 0, None] * resultant[:, 1] - point[:, 1, None] * resultant[:, 0])

    rows = np.empty((n_joint, 3, columns))
    rows[:, 0] = -chi[:, None] * moment_about(q)
    rows[:, 1] = chi[:, None] * moment_about(p)
    rows[:, 2] = tangent[:, 0, None] * resultant[:, 0] + tangent[:, 1, None] * resultant[:, 1]
    return JointForces(rows, weight, size, tree)


def hanging_stones(assembly: Assembly) -> list[int]:
    """Stones that no joint bears from below: they touch others at upright joints and from above only."""
    up = assembly.normal[:, 1]
    borne = np.concatenate([assembly.a[up > LEVEL], assembly.b[up < -LEVEL]])
    return sorted(set(range(len(assembly.mass))) - set(borne.tolist()))
