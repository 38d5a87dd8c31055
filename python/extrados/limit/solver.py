"""HiGHS behind one small class; its options and tolerances are set here only."""

from dataclasses import dataclass
from functools import lru_cache

import highspy
import numpy as np
from scipy import sparse

from extrados.limit.errors import Immovable as Immovable
from extrados.limit.errors import NoAnswer as NoAnswer
from extrados.limit.errors import NoEquilibrium as NoEquilibrium
from extrados.limit.systems import Constraints, Reduced, Sparse

FEASIBILITY = 1e-10
BOUND = 1e5  # of the scaled unknowns; reached only where the structure cannot be moved at all
MADE_UP = 1e-6  # of the value: what bounds may have of it by rounding
INFINITY = highspy.kHighsInf


@dataclass(frozen=True)
class Solution:
    """x, the duals of the constraint rows, those of the equations and of the bounds of the columns, and the value."""

    x: np.ndarray
    rows: np.ndarray
    equations: np.ndarray
    columns: np.ndarray
    value: float

    @property
    def made_up(self) -> float:
        """What the bounds of the unknowns have of the value: forces at the bound may hold each other, as in stones wedged
        without sliding, and count for nothing then."""
        bounded = np.abs(self.x) > 0.99 * BOUND
        return float(np.abs(self.columns * self.x)[bounded].sum())


class Programme:
    """Constraints over the unknowns of a system; solved for many costs from the last basis.

    `slack` (k), if given, adds a last unknown z with row k reading coefficient . c - slack z >= lower.
    """

    def __init__(self, system: Reduced | Sparse, constraints: Constraints, slack: np.ndarray | None = None):
        self.system = system
        self.columns = system.unknowns + (slack is not None)
        self._gamma = system.unknowns - 1
        self._index = np.arange(self.columns, dtype=np.int32)
        self._solver = highspy.Highs()
        self._solver.passOptions(_options(system.equations > 0, len(constraints.lower) > 2 * len(system.assembly.a)))
        self.pass_rows(constraints, slack)

    def pass_rows(self, constraints: Constraints, slack: np.ndarray | None = None) -> None:
        """Put the constraints in the place of as many earlier ones; the next solve starts from the last basis."""
        system, n = self.system, self.columns
        self.constraints = constraints
        matrix, constant = system.express(constraints)
        lower = constraints.lower - constant
        k, e = len(lower), system.equations
        if isinstance(system, Reduced):
            if slack is not None:
                matrix = np.concatenate([matrix, -slack[:, None]], axis=1)
            start = np.arange(0, k * n + 1, n, dtype=np.int32)
            index = np.broadcast_to(self._index, (k, n)).ravel()
            value = matrix.ravel()
            row_lower, row_upper = lower, np.full(k, INFINITY)
        else:
            equations = system.matrix
            if slack is not None:
                matrix = sparse.hstack([matrix, sparse.csr_array(-slack[:, None])], format="csr")
                equations = sparse.csr_array((equations.data, equations.indices, equations.indptr), shape=(e, n))
            whole = sparse.vstack([equations, matrix], format="csr")
            start, index, value = whole.indptr.astype(np.int32), whole.indices.astype(np.int32), whole.data
            row_lower = np.concatenate([system.right, lower])
            row_upper = np.concatenate([system.right, np.full(k, INFINITY)])
        most = np.full(n, BOUND if e == 0 else INFINITY)
        least = -most
        if (answers := system.loads.resistance) is not None:
            least[system.shares] = np.maximum(answers.low, least[system.shares])
            most[system.shares] = np.minimum(answers.high, most[system.shares])
        basis = self._solver.getBasis()
        passed = self._solver.passModel(
            n, e + k, len(value), int(highspy.MatrixFormat.kRowwise), int(highspy.ObjSense.kMinimize), 0.0,
            np.zeros(n), least, most, row_lower, row_upper, start, index, value,
            np.zeros(n, dtype=np.int32),
        )  # fmt: skip
        if passed == highspy.HighsStatus.kError:
            raise NoAnswer("the linear programme was not accepted: some number in it is not finite")
        if basis.valid:
            self._solver.setBasis(basis)

    def minimise(self, cost: np.ndarray, gamma: tuple[float, float]) -> Solution:
        """Minimise cost @ x with gamma in the given range."""
        self._solver.changeColsCost(self.columns, self._index, cost)
        self._solver.changeColBounds(self._gamma, *gamma)
        status = _decided(self._solver)
        if status in _INFEASIBLE:
            raise NoEquilibrium("no admissible thrust line")
        if status != highspy.HighsModelStatus.kOptimal:
            raise NoAnswer(f"the linear programme ended as: {self._solver.modelStatusToString(status)}")
        solution = self._solver.getSolution()
        dual = np.array(solution.row_dual)
        e = self.system.equations
        return Solution(
            np.array(solution.col_value), dual[e:], dual[:e], np.array(solution.col_dual), self._solver.getObjectiveValue()
        )  # fmt: skip


def _decided(solver: highspy.Highs) -> highspy.HighsModelStatus:
    """Status of the solve from the last basis; where that ends without a word, from scratch by other methods."""
    solver.run()
    status = solver.getModelStatus()
    if status in _DECIDED:
        return status
    kept = solver.getOptions()
    for method in ("simplex", "ipm"):
        solver.clearSolver()
        solver.setOptionValue("presolve", "on")
        solver.setOptionValue("solver", method)
        solver.run()
        status = solver.getModelStatus()
        if status in _DECIDED:
            break
    solver.passOptions(kept)
    return status


@dataclass(frozen=True)
class Optimum:
    """x, its value, and by how much the value would change per unit of each row and of each bound of a column."""

    x: np.ndarray
    value: float
    rows: np.ndarray
    columns: np.ndarray


def linear_programme(
    matrix: sparse.sparray, row_lower: np.ndarray, row_upper: np.ndarray, cost: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> Optimum:  # fmt: skip
    """Minimise cost . x with row_lower <= matrix x <= row_upper and lower <= x <= upper.

    NoEquilibrium where nothing obeys all of them, NoAnswer where the solver gives up.
    """
    rows = sparse.csr_array(matrix)
    count = len(cost)
    solver = highspy.Highs()
    solver.passOptions(_options(True, False))
    passed = solver.passModel(
        count, rows.shape[0], rows.nnz, int(highspy.MatrixFormat.kRowwise), int(highspy.ObjSense.kMinimize), 0.0, cost,
        lower, upper, row_lower, row_upper, rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data,
        np.zeros(count, dtype=np.int32),
    )  # fmt: skip
    if passed == highspy.HighsStatus.kError:
        raise NoAnswer("the linear programme was not accepted: some number in it is not finite")
    status = _decided(solver)
    if status in _INFEASIBLE:
        raise NoEquilibrium("no admissible thrust line")
    if status != highspy.HighsModelStatus.kOptimal:
        raise NoAnswer(f"the linear programme ended as: {solver.modelStatusToString(status)}")
    found = solver.getSolution()
    return Optimum(
        np.array(found.col_value), solver.getObjectiveValue(), np.array(found.row_dual), np.array(found.col_dual)
    )


_INFEASIBLE = (highspy.HighsModelStatus.kInfeasible, highspy.HighsModelStatus.kUnboundedOrInfeasible)
_DECIDED = (highspy.HighsModelStatus.kOptimal, *_INFEASIBLE)


@lru_cache(maxsize=4)
def _options(sparse_form: bool, more_than_pressing: bool) -> highspy.HighsOptions:
    """Small programmes: the bare simplex method from the last basis. Large ones: presolve, no scaling of what is
    scaled already; with friction the interior-point method and crossover, ten times faster on a wall of 1000 stones."""
    options = highspy.HighsOptions()
    options.output_flag, options.threads = False, 1
    options.solver = "ipm" if sparse_form and more_than_pressing else "simplex"
    options.presolve = "on" if sparse_form else "off"
    if sparse_form:
        options.simplex_scale_strategy = 0
    options.primal_feasibility_tolerance = options.dual_feasibility_tolerance = FEASIBILITY
    options.small_matrix_value = 1e-12
    return options
