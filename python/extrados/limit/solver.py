"""HiGHS behind one small class; its options and tolerances are set here only."""

from dataclasses import dataclass

import highspy
import numpy as np
from scipy import sparse

from extrados.limit.systems import Constraints, Reduced, Sparse

FEASIBILITY = 1e-10
BOUND = 1e5  # of the scaled unknowns; reached only where the structure cannot be moved at all
INFINITY = highspy.kHighsInf


class NoEquilibrium(ValueError):
    """No admissible thrust line exists for the loads asked for."""


class NoAnswer(RuntimeError):
    """The solver gave up; never a statement about the structure."""


@dataclass(frozen=True)
class Solution:
    """x, the duals of the constraint rows, those of the equations, and the column duals."""

    x: np.ndarray
    rows: np.ndarray
    equations: np.ndarray
    value: float


class Programme:
    """Constraints over the unknowns of a system; solved for many costs from the last basis.

    `slack` (k), if given, adds a last unknown z with row k reading coefficient . c - slack z >= lower.
    """

    def __init__(self, system: Reduced | Sparse, constraints: Constraints, slack: np.ndarray | None = None):
        self.system, self.constraints = system, constraints
        matrix, constant = system.express(constraints)
        lower = constraints.lower - constant
        n = system.unknowns
        k, e = len(lower), system.equations
        if isinstance(system, Reduced):
            if slack is not None:
                matrix = np.column_stack([matrix, -slack])
                n += 1
            start = np.arange(0, k * n + 1, n, dtype=np.int32)
            index = np.tile(np.arange(n, dtype=np.int32), k)
            value = matrix.ravel()
            row_lower, row_upper = lower, np.full(k, INFINITY)
        else:
            if slack is not None:
                matrix = sparse.hstack([matrix, sparse.csr_array(-slack[:, None])], format="csr")
                n += 1
            equations = system.matrix
            if slack is not None:
                equations = sparse.csr_array(
                    (equations.data, equations.indices, equations.indptr), shape=(e, n)
                )
            whole = sparse.vstack([equations, matrix], format="csr")
            start, index, value = whole.indptr.astype(np.int32), whole.indices.astype(np.int32), whole.data
            row_lower = np.concatenate([system.right, lower])
            row_upper = np.concatenate([system.right, np.full(k, INFINITY)])
        self._free = np.full(n, BOUND if e == 0 else INFINITY)
        solver = highspy.Highs()
        for option, setting in _OPTIONS:
            solver.setOptionValue(option, setting)
        if e:
            solver.setOptionValue("presolve", "on")
        self.columns = n
        self._gamma = system.unknowns - 1
        solver.passModel(
            n, e + k, len(value), int(highspy.MatrixFormat.kRowwise), int(highspy.ObjSense.kMinimize), 0.0,
            np.zeros(n), -self._free, self._free, row_lower, row_upper, start, index, value,
            np.zeros(n, dtype=np.int32),
        )  # fmt: skip
        self._solver = solver
        self._index = np.arange(n, dtype=np.int32)

    def minimise(self, cost: np.ndarray, gamma: tuple[float, float]) -> Solution:
        """Minimise cost @ x with gamma in the given range."""
        self._solver.changeColsCost(self.columns, self._index, cost)
        self._solver.changeColBounds(self._gamma, *gamma)
        self._solver.run()
        status = self._solver.getModelStatus()
        if status in _INFEASIBLE:
            raise NoEquilibrium("no admissible thrust line")
        if status != highspy.HighsModelStatus.kOptimal:
            raise NoAnswer(f"the linear programme ended as: {self._solver.modelStatusToString(status)}")
        solution = self._solver.getSolution()
        dual = np.array(solution.row_dual)
        e = self.system.equations
        return Solution(np.array(solution.col_value), dual[e:], dual[:e], self._solver.getObjectiveValue())


_INFEASIBLE = (highspy.HighsModelStatus.kInfeasible, highspy.HighsModelStatus.kUnboundedOrInfeasible)
_OPTIONS = (
    ("output_flag", False), ("threads", 1), ("presolve", "off"), ("solver", "simplex"),
    ("primal_feasibility_tolerance", FEASIBILITY), ("dual_feasibility_tolerance", FEASIBILITY),
    ("small_matrix_value", 1e-12),
)  # fmt: skip
