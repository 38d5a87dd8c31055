"""Joint forces of an assembly as affine functions of its redundants: the force method.

Every loop of the block graph adds three redundants, the resultant across the joint that closes it. All
other joint forces follow from equilibrium, so that an arch of any number of voussoirs is a programme of
four unknowns: (H, V, M) and the load multiplier gamma (thesis 3.3; the reduction is our own).
"""

from dataclasses import dataclass

import numpy as np

from extrados.structures.assembly import GROUND, Assembly

GRAVITY = 9.80665


class Disconnected(ValueError):
    """A block hangs on no joint that leads to the ground."""


@dataclass(frozen=True)
class JointForces:
    """Corner forces of joint j: n_p, n_q (compression at the ends p and q) and the shear s from p to q.

    Each is `rows @ x`, x = (redundants..., gamma, 1), forces divided by `weight` and redundant moments by
    weight times `size`, so that the numbers stay near one. rows has shape (joints, 3, len(x)).
    `parent_joint[block]`, `order`: the tree that carries each block, from the ground outward.
    """

    rows: np.ndarray
    weight: float
    size: float
    parent_joint: np.ndarray
    order: list[int]

    @property
    def unknowns(self) -> int:
        """Redundants plus gamma."""
        return self.rows.shape[2] - 1


def _tree(assembly: Assembly) -> tuple[np.ndarray, list[int]]:
    """Parent joint of each block and the blocks in breadth-first order from the ground."""
    touching: list[list[tuple[int, int]]] = [[] for _ in assembly.mass]
    grounded: list[tuple[int, int]] = []
    for j, (a, b) in enumerate(zip(assembly.a.tolist(), assembly.b.tolist(), strict=True)):
        for here, other in ((a, b), (b, a)):
            if here == GROUND:
                grounded.append((j, other))
            else:
                touching[here].append((j, other))
    parent = np.full(len(assembly.mass), -1)
    order: list[int] = []
    front = grounded
    while front:
        reached = []
        for j, block in front:
            if block != GROUND and parent[block] < 0:
                parent[block] = j
                order.append(block)
                reached.append(block)
        front = [(j, other) for block in reached for j, other in touching[block]]
    if len(order) < len(parent):
        lost = [assembly.block_names[i] for i in np.flatnonzero(parent < 0)[:5]]
        raise Disconnected(f"not connected to the ground: {', '.join(lost)}")
    return parent, order


def joint_forces(assembly: Assembly) -> JointForces:
    """Corner forces of all joints under gravity and gamma times gravity to +x."""
    parent, order = _tree(assembly)
    n_joint = len(assembly.a)
    in_tree = np.zeros(n_joint, dtype=bool)
    in_tree[parent] = True
    loops = np.flatnonzero(~in_tree)
    columns = 3 * len(loops) + 2
    weights = assembly.mass * GRAVITY
    weight = float(weights.sum())
    size = float(np.ptp(np.concatenate([assembly.p, assembly.q]), axis=0).max())

    # Resultant on block a of each joint: force x, force y, moment about the origin.
    resultant = np.zeros((n_joint, 3, columns))
    for k, j in enumerate(loops):
        middle = 0.5 * (assembly.p[j] + assembly.q[j]) / size
        resultant[j, 0, 3 * k] = resultant[j, 1, 3 * k + 1] = resultant[j, 2, 3 * k + 2] = 1.0
        resultant[j, 2, 3 * k] = -middle[1]  # the redundant moment is taken about the joint's middle
        resultant[j, 2, 3 * k + 1] = middle[0]
    # What each block still has to hand to its parent joint.
    load = np.zeros((len(weights), 3, columns))
    w = weights / weight
    x, y = assembly.centroid.T / size
    load[:, 0, -2] = w
    load[:, 2, -2] = -y * w
    load[:, 1, -1] = -w
    load[:, 2, -1] = -x * w
    for j in loops:
        if assembly.a[j] != GROUND:
            load[assembly.a[j]] += resultant[j]
        if assembly.b[j] != GROUND:
            load[assembly.b[j]] -= resultant[j]
    for block in reversed(order):
        j = parent[block]
        on_block = -load[block]
        is_a = assembly.a[j] == block
        resultant[j] = on_block if is_a else -on_block
        other = assembly.b[j] if is_a else assembly.a[j]
        if other != GROUND:
            load[other] -= on_block

    p, q = assembly.p / size, assembly.q / size
    length = assembly.length / size
    normal, tangent = assembly.normal, assembly.tangent
    chi = tangent[:, 0] * normal[:, 1] - tangent[:, 1] * normal[:, 0]
    force = resultant[:, :2]

    def moment_about(point: np.ndarray) -> np.ndarray:
        return resultant[:, 2] - (point[:, 0, None] * force[:, 1] - point[:, 1, None] * force[:, 0])

    rows = np.empty((n_joint, 3, columns))
    rows[:, 0] = -(chi / length)[:, None] * moment_about(q)
    rows[:, 1] = (chi / length)[:, None] * moment_about(p)
    rows[:, 2] = np.einsum("ij,ijk->ik", tangent, force)
    return JointForces(rows, weight, size, parent, order)
