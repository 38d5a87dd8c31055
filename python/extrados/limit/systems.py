"""Two ways to write the equilibrium of an assembly for a linear programme, with one face.

`Reduced` keeps the redundants of the loops and gamma as the only unknowns: right for chains, arches and
churches. `Sparse` keeps three forces per joint and three equations per block: right for walls, where loops
are as many as blocks. Both speak of corner forces c = (n_p, n_q, s) per joint, scaled by the total load,
lengths by the size of the assembly. `shares` are the places among the unknowns of the shares of forces that answer to
movement, pressures and ties; gamma is the last unknown.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from extrados.limit.equilibrium import Tree, joint_forces
from extrados.limit.loads import Loads
from extrados.model.geometry.assembly import GROUND, Assembly

# More loops than this and the dense rows of the reduced form cost more than the equations they save.
LOOPS_REDUCED = 40


@dataclass(frozen=True)
class Constraints:
    """Rows `coefficient . c[joint] >= lower` on the corner forces: joint (k), coefficient (k, 3), lower (k)."""

    joint: np.ndarray
    coefficient: np.ndarray
    lower: np.ndarray

    def __add__(self, other: "Constraints") -> "Constraints":
        return Constraints(
            np.concatenate([self.joint, other.joint]),
            np.concatenate([self.coefficient, other.coefficient]),
            np.concatenate([self.lower, other.lower]),
        )

    def openings(self, dual: np.ndarray, joints: int) -> np.ndarray:
        """Relative motion (joints, 3) of the joints that the duals of these rows stand for."""
        motion = np.zeros((joints, 3))
        np.add.at(motion, self.joint, dual[:, None] * self.coefficient)
        return motion


class Reduced:
    """Unknowns: the redundants, the shares of forces that answer, then gamma. No equations are left."""

    equations = 0

    def __init__(self, assembly: Assembly, loads: Loads, tree: Tree):
        self.assembly, self.loads, self.tree = assembly, loads, tree
        forces = joint_forces(assembly, loads, tree)
        self.unknowns = forces.unknowns
        self.shares = slice(self.unknowns - 1 - loads.pushes, self.unknowns - 1)
        self._slope, self._constant = forces.rows[:, :, :-1], forces.rows[:, :, -1]

    def express(self, rows: Constraints) -> tuple[np.ndarray, np.ndarray]:
        """Rows as a dense matrix on the unknowns, and the constant of each."""
        c = rows.coefficient
        matrix = np.matmul(c[:, None, :], self._slope[rows.joint])[:, 0]
        return matrix, (c * self._constant[rows.joint]).sum(axis=1)

    def corners(self, x: np.ndarray) -> np.ndarray:
        """Corner forces (joints, 3) at values x (unknowns)."""
        return self._slope @ x + self._constant

    def cost(self, corner_cost: np.ndarray) -> np.ndarray:
        """Cost on the unknowns of a cost (joints, 3) on the corner forces, but for a constant."""
        return np.tensordot(corner_cost, self._slope, axes=2)

    def velocities(self, motion: np.ndarray) -> tuple[np.ndarray, float]:
        """Twists (nb, 3) about the origin from the relative motion of the joints; misfit of the loops."""
        a, size = self.assembly, self.assembly.size
        relative = _twists(a, motion)
        joint_a, joint_b, parent = a.a.tolist(), a.b.tolist(), self.tree.parent_joint.tolist()
        steps = relative.tolist()
        twist = [(0.0, 0.0, 0.0)] * len(parent)
        for block in self.tree.order:
            j = parent[block]
            first = joint_a[j] == block
            below = joint_b[j] if first else joint_a[j]
            sign = 1.0 if first else -1.0
            base, step = (twist[below] if below != GROUND else (0.0, 0.0, 0.0)), steps[j]
            twist[block] = (base[0] + sign * step[0], base[1] + sign * step[1], base[2] + sign * step[2])
        result = np.array(twist)
        return result, _misfit(a, result, relative) / size


class Sparse:
    """Unknowns: corner forces of all joints, the shares of forces that answer, then gamma; three equations per block."""

    def __init__(self, assembly: Assembly, loads: Loads, tree: Tree):
        self.assembly, self.loads, self.tree = assembly, loads, tree
        m, size = len(assembly.a), assembly.size
        self.unknowns = 3 * m + loads.pushes + 1
        self.shares = slice(3 * m, 3 * m + loads.pushes)
        self.equations = 3 * len(assembly.mass)
        n, t = assembly.normal, assembly.tangent
        p, q = assembly.p / size, assembly.q / size

        def wrench(direction: np.ndarray, point: np.ndarray) -> np.ndarray:
            moment = point[:, 0] * direction[:, 1] - point[:, 1] * direction[:, 0]
            return np.column_stack([direction, moment])

        on_a = np.stack([wrench(n, p), wrench(n, q), wrench(t, 0.5 * (p + q))], axis=1)
        self.wrench = on_a  # of unit corner forces on block a (m, corner, equation)
        row, column, value = [], [], []
        for ends, sign in ((assembly.a, 1.0), (assembly.b, -1.0)):
            held = np.flatnonzero(ends != GROUND)
            shape = (len(held), 3, 3)
            row.append(np.broadcast_to(3 * ends[held][:, None, None] + np.arange(3), shape).ravel())
            column.append(np.broadcast_to(3 * held[:, None, None] + np.arange(3)[:, None], shape).ravel())
            value.append(sign * on_a[held].ravel())
        self.unit = unit = loads.scale * np.array([1.0, 1.0, size])
        live = (loads.live / unit).ravel()
        moved = np.flatnonzero(live)
        row.append(moved)
        column.append(np.full(len(moved), self.unknowns - 1))
        value.append(live[moved])
        if loads.resistance is not None:
            row.append((3 * loads.resistance.block[:, None] + np.arange(3)).ravel())
            column.append(np.repeat(3 * m + loads.resistance.number, 3))
            value.append((loads.resistance.wrench / unit).ravel())
        entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
        self.matrix = sparse.csr_array(entries, shape=(self.equations, self.unknowns))
        self.right = -(loads.dead / unit).ravel()

    def express(self, rows: Constraints) -> tuple[sparse.csr_array, np.ndarray]:
        """Constraints on corner forces as rows over the unknowns, and their constants (rows)."""
        k = len(rows.joint)
        row, corner = np.nonzero(rows.coefficient)
        entries = rows.coefficient[row, corner], (row, 3 * rows.joint[row] + corner)
        return sparse.csr_array(entries, shape=(k, self.unknowns)), np.zeros(k)

    @property
    def corner_matrix(self) -> sparse.csr_array:
        """The columns of the corner forces."""
        return sparse.csr_array(self.matrix[:, : self.shares.start])

    def corners(self, x: np.ndarray) -> np.ndarray:
        """Corner forces (joints, 3) at values x (unknowns)."""
        return x[: self.shares.start].reshape(-1, 3)

    def cost(self, corner_cost: np.ndarray) -> np.ndarray:
        """A cost of corner forces (joints, 3) as one of the unknowns (unknowns)."""
        return np.concatenate([corner_cost.ravel(), np.zeros(self.unknowns - self.shares.start)])

    def velocities(self, motion: np.ndarray, dual: np.ndarray) -> tuple[np.ndarray, float]:
        """Twists (nb, 3) straight from the duals of the equations."""
        twist = -dual.reshape(-1, 3)
        return twist, _misfit(self.assembly, twist, _twists(self.assembly, motion)) / self.assembly.size


def _twists(assembly: Assembly, motion: np.ndarray) -> np.ndarray:
    """Motion of block a against block b at each joint (opening at p, at q, slip) as twists about the origin.

    Lengths are divided by the size of the assembly: x, y, spin with v = (x - spin Y, y + spin X).
    """
    size = assembly.size
    normal, tangent = assembly.normal, assembly.tangent
    chi = tangent[:, 0] * normal[:, 1] - tangent[:, 1] * normal[:, 0]
    spin = chi * (motion[:, 1] - motion[:, 0]) * size / assembly.length
    x, y = (assembly.p / size).T
    return np.column_stack(
        [
            motion[:, 0] * normal[:, 0] + motion[:, 2] * tangent[:, 0] + spin * y,
            motion[:, 0] * normal[:, 1] + motion[:, 2] * tangent[:, 1] - spin * x,
            spin,
        ]
    )


def _misfit(assembly: Assembly, twist: np.ndarray, relative: np.ndarray) -> float:
    """Greatest gap between the motion of the blocks and that of the joints, relative to the fastest block."""
    grounded = np.vstack([twist, np.zeros(3)])  # GROUND = -1 picks the row of zeros
    scale = np.abs(twist).max()
    return float(np.abs(grounded[assembly.a] - grounded[assembly.b] - relative).max() / max(scale, 1e-300))
