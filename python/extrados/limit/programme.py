"""The linear programmes of limit analysis, solved by HiGHS; its options and tolerances are set here only."""

from dataclasses import dataclass

import highspy
import numpy as np

from extrados.limit.equilibrium import JointForces, joint_forces
from extrados.structures.assembly import GROUND, Assembly

FEASIBILITY = 1e-9
BOUND = 1e4  # of the scaled unknowns; reached only where the structure cannot be moved at all


class NoEquilibrium(ValueError):
    """No admissible thrust line exists for the loads asked for."""


@dataclass(frozen=True)
class State:
    """One admissible state of the joints: forces in N, positions as fractions of the joints.

    normal, shear (joints); position 0 at p (intrados), 1 at q (extrados); gamma load multiplier.
    """

    gamma: float
    normal: np.ndarray
    shear: np.ndarray
    position: np.ndarray

    @property
    def friction(self) -> np.ndarray:
        """Coefficient of friction needed at each joint."""
        return np.abs(self.shear) / np.maximum(self.normal, 1e-12 * self.normal.max())

    def points(self, assembly: Assembly) -> np.ndarray:
        """Where the thrust line meets the joints (joints, 2) [m]."""
        return assembly.p + self.position[:, None] * (assembly.q - assembly.p)


@dataclass(frozen=True)
class Mechanism:
    """Velocities of the blocks at collapse (nb, 3): x, y [m/s], spin [rad/s], scaled to unit live-load work.

    hinges: (joint, "intrados" | "extrados"); sliding: joints that slide; opening_p, opening_q, slip of the
    joints. upper_bound is gamma by the work of these velocities, `defect` the misfit of the loops.
    """

    velocity: np.ndarray
    hinges: list[tuple[int, str]]
    sliding: list[int]
    opening_p: np.ndarray
    opening_q: np.ndarray
    slip: np.ndarray
    upper_bound: float
    defect: float


class LimitAnalysis:
    """All programmes of one assembly; successive solves start from the last basis."""

    def __init__(self, assembly: Assembly, friction: float | None = None):
        """`friction`: coefficient of all joints with associated (dilatant) sliding; None forbids sliding."""
        self.assembly = assembly
        self.friction = friction
        self.forces: JointForces = joint_forces(assembly)
        rows = self.forces.rows
        parts = [rows[:, 0], rows[:, 1]]
        if friction is not None:
            cone = friction * (rows[:, 0] + rows[:, 1])
            parts += [cone - rows[:, 2], cone + rows[:, 2]]
        self._rows = np.concatenate(parts)
        n = self.forces.unknowns
        solver = highspy.Highs()
        for option, value in (
            ("output_flag", False), ("threads", 1), ("presolve", "off"), ("solver", "simplex"),
            ("primal_feasibility_tolerance", FEASIBILITY), ("dual_feasibility_tolerance", FEASIBILITY),
        ):  # fmt: skip
            solver.setOptionValue(option, value)
        model = highspy.HighsLp()
        model.num_col_, model.num_row_ = n, len(self._rows)
        model.col_cost_ = np.zeros(n)
        model.col_lower_, model.col_upper_ = np.full(n, -BOUND), np.full(n, BOUND)
        model.row_lower_ = -self._rows[:, -1]
        model.row_upper_ = np.full(len(self._rows), highspy.kHighsInf)
        matrix = self._rows[:, :-1]
        row, column = np.nonzero(matrix)
        model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        model.a_matrix_.start_ = np.append(0, np.cumsum(np.bincount(row, minlength=len(matrix))))
        model.a_matrix_.index_ = column
        model.a_matrix_.value_ = matrix[row, column]
        solver.passModel(model)
        self._solver = solver
        self._columns = np.arange(n, dtype=np.int32)

    def _solve(self, cost: np.ndarray, gamma: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        """Minimise cost @ x with gamma in the given range; solution and row duals."""
        n = self.forces.unknowns
        self._solver.changeColsCost(n, self._columns, cost)
        self._solver.changeColBounds(n - 1, *gamma)
        self._solver.run()
        status = self._solver.getModelStatus()
        if status != highspy.HighsModelStatus.kOptimal:
            raise NoEquilibrium(self._solver.modelStatusToString(status))
        solution = self._solver.getSolution()
        return np.array(solution.col_value), np.array(solution.row_dual)

    def _state(self, x: np.ndarray) -> State:
        corner = self.forces.rows @ np.append(x, 1.0) * self.forces.weight
        n_p, n_q = np.maximum(corner[:, 0], 0.0), np.maximum(corner[:, 1], 0.0)
        normal = n_p + n_q
        return State(float(x[-1]), normal, corner[:, 2], n_q / np.maximum(normal, 1e-300))

    def collapse(self, direction: int = 1) -> tuple[State, Mechanism]:
        """Greatest gamma for the load gamma W to +x (direction 1) or -x (-1), and the mechanism.

        gamma is negative where the structure cannot stand upright and needs support from that side.
        """
        cost = np.zeros(self.forces.unknowns)
        cost[-1] = -float(direction)
        x, dual = self._solve(cost, (-BOUND, BOUND))
        if abs(x[-1]) > 0.99 * BOUND:
            raise NoEquilibrium("no horizontal load brings it down: the joints hold it from all sides")
        return self._state(x), self._mechanism(dual, direction)

    def stands(self) -> bool:
        """True where an admissible thrust line exists upright."""
        try:
            self._solve(np.zeros(self.forces.unknowns), (0.0, 0.0))
        except NoEquilibrium:
            return False
        return True

    def thrust(self, joint: int, gamma: float = 0.0) -> tuple[State, State]:
        """States of least and greatest horizontal force across `joint` at a fixed gamma."""
        direction = self.assembly.normal[joint, 0] * (self.forces.rows[joint, 0] + self.forces.rows[joint, 1])
        direction = direction + self.assembly.tangent[joint, 0] * self.forces.rows[joint, 2]
        sign = 1.0 if self.assembly.normal[joint, 0] >= 0.0 else -1.0
        states = [self._state(self._solve(s * sign * direction[:-1], (gamma, gamma))[0]) for s in (1.0, -1.0)]
        return states[0], states[1]

    def horizontal(self, state: State, joint: int) -> float:
        """Horizontal force across a joint in a state [N]."""
        a = self.assembly
        return abs(float(a.normal[joint, 0] * state.normal[joint] + a.tangent[joint, 0] * state.shear[joint]))

    def _mechanism(self, dual: np.ndarray, direction: int) -> Mechanism:
        a, m = self.assembly, len(self.assembly.a)
        opening_p, opening_q = np.maximum(dual[:m], 0.0), np.maximum(dual[m : 2 * m], 0.0)
        slip = np.zeros(m)
        if self.friction is not None:
            one, two = np.maximum(dual[2 * m : 3 * m], 0.0), np.maximum(dual[3 * m :], 0.0)
            opening_p = opening_p + self.friction * (one + two)
            opening_q = opening_q + self.friction * (one + two)
            slip = two - one
        # Motion of block a relative to block b at each joint, as a twist about the origin.
        length = a.length / self.forces.size
        chi = a.tangent[:, 0] * a.normal[:, 1] - a.tangent[:, 1] * a.normal[:, 0]
        spin = chi * (opening_q - opening_p) / length
        at_p = opening_p[:, None] * a.normal + slip[:, None] * a.tangent
        p = a.p / self.forces.size
        origin = at_p - spin[:, None] * np.stack([-p[:, 1], p[:, 0]], axis=1)
        relative = np.column_stack([origin, spin])
        twist = np.zeros((len(a.mass), 3))
        for block in self.forces.order:
            j = self.forces.parent_joint[block]
            first = a.a[j] == block
            other = a.b[j] if first else a.a[j]
            base = twist[other] if other != GROUND else 0.0
            twist[block] = base + (relative[j] if first else -relative[j])
        ends = [np.where((e != GROUND)[:, None], twist[e], 0.0) for e in (a.a, a.b)]
        scale = np.abs(twist).max()
        defect = float(np.abs(ends[0] - ends[1] - relative).max() / scale)
        c = a.centroid / self.forces.size
        velocity = np.column_stack(
            [twist[:, 0] - twist[:, 2] * c[:, 1], twist[:, 1] + twist[:, 2] * c[:, 0], twist[:, 2]]
        )
        w = a.mass / a.mass.sum()
        live = float(w @ velocity[:, 0])
        upper = float(w @ velocity[:, 1]) / live

        size = self.forces.size
        small = 1e-4
        at = np.hypot(*(velocity[:, :2]).T).max()
        hinges, sliding = [], []
        for j in range(m):
            speed_p, speed_q = np.hypot(opening_p[j], slip[j]), np.hypot(opening_q[j], slip[j])
            if max(speed_p, speed_q) < 1e-7 * at:
                continue
            if speed_p < small * speed_q:
                hinges.append((j, "intrados"))
            elif speed_q < small * speed_p:
                hinges.append((j, "extrados"))
            else:
                sliding.append(j)
        unit = 1.0 / (abs(live) * size)
        return Mechanism(
            velocity * np.array([size, size, 1.0]) * unit, hinges, sliding,
            opening_p * size * unit, opening_q * size * unit, slip * size * unit, upper, defect,
        )  # fmt: skip
