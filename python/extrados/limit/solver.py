"""HiGHS behind one small class; its options and tolerances are set here only."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import highspy
import numpy as np
from scipy import sparse

from extrados.core.limit import least_vertex
from extrados.limit.errors import Immovable as Immovable
from extrados.limit.errors import NoAnswer as NoAnswer
from extrados.limit.errors import NoEquilibrium as NoEquilibrium
from extrados.limit.systems import Constraints, Reduced, Sparse

FEASIBILITY = 1e-10
BOUND = 1e5  # of the scaled unknowns; reached only where the structure cannot be moved at all
FEW = 32  # unknowns: more are left to HiGHS
MADE_UP = 1e-6  # of the value: what bounds may have of it by rounding
STEPS, STEPS_EACH, STEPS_INSIDE = 10_000, 10, 500  # of the simplex and the interior-point method: some programmes cycle
INFINITY = highspy.kHighsInf
_NONE = np.empty(0)


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
    """Constraints over the unknowns of a system, solved for many costs: of few unknowns from vertex to vertex in the core,
    else, and where that gives up, by HiGHS from the last basis.

    `slack` (k), if given, adds a last unknown z with row k reading coefficient . c - slack z >= lower.
    """

    def __init__(self, system: Reduced | Sparse, constraints: Constraints, slack: np.ndarray | None = None):
        self.system = system
        self.columns = system.unknowns + (slack is not None)
        self._gamma = system.unknowns - 1
        self._small = isinstance(system, Reduced) and self.columns <= FEW
        self._highs: highspy.Highs | None = None
        self.pass_rows(constraints, slack)

    def pass_rows(self, constraints: Constraints, slack: np.ndarray | None = None) -> None:
        """Put the constraints in the place of as many earlier ones; HiGHS goes on from the last basis."""
        system = self.system
        self.constraints, self._slack = constraints, slack
        self._matrix: Any
        self._matrix, constant = system.express(constraints)
        self._lower = constraints.lower - constant
        self._most = np.full(self.columns, BOUND if system.equations == 0 else INFINITY)
        self._least = -self._most
        if (answers := system.loads.resistance) is not None:
            self._least[system.shares] = np.maximum(answers.low, self._least[system.shares])
            self._most[system.shares] = np.minimum(answers.high, self._most[system.shares])
        if self._small and slack is not None:
            self._matrix = np.concatenate([self._matrix, -slack[:, None]], axis=1)
        if self._highs is not None:
            self._pass_to(self._highs)

    def _pass_to(self, solver: highspy.Highs) -> None:
        """The rows for HiGHS, which keeps its basis."""
        system, n, matrix, lower = self.system, self.columns, self._matrix, self._lower
        k, e = len(lower), system.equations
        if isinstance(system, Reduced):
            if self._slack is not None and matrix.shape[1] < n:
                matrix = np.concatenate([matrix, -self._slack[:, None]], axis=1)
            start = np.arange(0, k * n + 1, n, dtype=np.int32)
            index = np.broadcast_to(np.arange(n, dtype=np.int32), (k, n)).ravel()
            value = matrix.ravel()
            row_lower, row_upper = lower, np.full(k, INFINITY)
        else:
            equations = system.matrix
            if self._slack is not None:
                matrix = sparse.hstack([matrix, sparse.csr_array(-self._slack[:, None])], format="csr")
                equations = sparse.csr_array((equations.data, equations.indices, equations.indptr), shape=(e, n))
            whole = sparse.vstack([equations, matrix], format="csr")
            start, index, value = whole.indptr.astype(np.int32), whole.indices.astype(np.int32), whole.data
            row_lower = np.concatenate([system.right, lower])
            row_upper = np.concatenate([system.right, np.full(k, INFINITY)])
        basis = solver.getBasis()
        _pass_model(solver, (start, index, value), (row_lower, row_upper), np.zeros(n), (self._least, self._most))
        if basis.valid:
            solver.setBasis(basis)

    def minimise(self, cost: np.ndarray, gamma: tuple[float, float]) -> Solution:
        """Minimise cost @ x with gamma in the given range."""
        if self._small:
            least, most = self._least.copy(), self._most.copy()
            least[self._gamma], most[self._gamma] = gamma
            if found := least_vertex(self._matrix, self._lower, cost, least, most):
                x, rows, sides = found
                return Solution(x, rows, _NONE, sides, float(cost @ x))
        solver = self._highs or self._start()
        solver.changeColsCost(self.columns, np.arange(self.columns, dtype=np.int32), cost)
        solver.changeColBounds(self._gamma, *gamma)
        solution = _optimum(solver)
        dual = np.array(solution.row_dual)
        e = self.system.equations
        return Solution(np.array(solution.col_value), dual[e:], dual[:e], np.array(solution.col_dual), solver.getObjectiveValue())

    def _start(self) -> highspy.Highs:
        """HiGHS with these rows."""
        self._highs = highspy.Highs()
        more_than_pressing = len(self._lower) > 2 * len(self.system.assembly.a)
        self._highs.passOptions(_options(self.system.equations > 0, more_than_pressing))
        self._pass_to(self._highs)
        return self._highs


def _pass_model(
    solver: highspy.Highs,
    rows: tuple[np.ndarray, np.ndarray, np.ndarray],
    sides: tuple[np.ndarray, np.ndarray],
    cost: np.ndarray,
    bounds: tuple[np.ndarray, np.ndarray],
) -> None:
    """Minimise `cost` @ x within `bounds`, with rows (starts, columns, values) between their `sides`; NoAnswer of numbers that
    are not finite."""
    start, index, value = rows
    passed = solver.passModel(
        len(cost),
        len(sides[0]),
        len(value),
        int(highspy.MatrixFormat.kRowwise),
        int(highspy.ObjSense.kMinimize),
        0.0,
        cost,
        *bounds,
        *sides,
        start,
        index,
        value,
        np.zeros(len(cost), dtype=np.int32),
    )
    if passed == highspy.HighsStatus.kError:
        raise NoAnswer("the solver rejected the linear programme, because it contains a number that is not finite")


def _optimum(solver: highspy.Highs) -> Any:
    """The solution of HiGHS; NoEquilibrium or NoAnswer without one."""
    status = _decided(solver)
    if status in _INFEASIBLE:
        raise NoEquilibrium("no admissible thrust line")
    if status != highspy.HighsModelStatus.kOptimal:
        raise NoAnswer(f"the linear programme ended with this status: {solver.modelStatusToString(status)}")
    return solver.getSolution()


def _decided(solver: highspy.Highs) -> highspy.HighsModelStatus:
    """Status of the solve from the last basis; where that ends without a word, from scratch by other methods."""
    size = solver.getNumRow() + solver.getNumCol()
    solver.setOptionValue("simplex_iteration_limit", STEPS + STEPS_EACH * size)
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
) -> Optimum:
    """Minimise cost . x with row_lower <= matrix x <= row_upper and lower <= x <= upper.

    NoEquilibrium where nothing obeys all of them, NoAnswer where the solver gives up.
    """
    rows = sparse.csr_array(matrix)
    solver = highspy.Highs()
    solver.passOptions(_options(True, False))
    matrix_rows = rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data
    _pass_model(solver, matrix_rows, (row_lower, row_upper), cost, (lower, upper))
    found = _optimum(solver)
    return Optimum(np.array(found.col_value), solver.getObjectiveValue(), np.array(found.row_dual), np.array(found.col_dual))


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
    options.ipm_iteration_limit = STEPS_INSIDE
    return options
