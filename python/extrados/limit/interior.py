"""An interior-point method for the collapse load of walls: many loops, friction, no crushing.

Mehrotra's predictor and corrector on the friction cones' edges: each joint carries four non-negative forces,
at either end along either edge of its cone, so that equilibrium (three equations per block) is all that is
left. The normal equations couple blocks that touch and stay as sparse as the wall; gamma is a free unknown
beside them. On a wall of a thousand stones this is several times faster than a general programme, whose
simplex and crossover labour over its many equal answers. Where it does not close the gap, HiGHS is asked.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from extrados.limit.systems import Sparse

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU

GAP = 5e-10  # of gamma: where the iteration may end
RESIDUAL = 1e-9  # of the total load
# What is still taken when the factor gives out on the last steps, where some weights are all but infinite.
LOOSE_GAP, LOOSE_RESIDUAL = 9e-10, 2e-8
ROUNDS = 90
SHIFT = 1e-13  # keeps the factor alive where a block hangs by an edge; far below the weights that matter
SMALLEST = 1e-150  # beyond, quotients overflow: the iteration has lost its way
TOWARDS_EDGE = 0.9995  # of the way to the nearest bound


@dataclass(frozen=True)
class Interior:
    """gamma, corner forces (joints, 3), multipliers of the equations, and the motion (joints, 3) they stand for."""

    gamma: float
    corners: np.ndarray
    twist: np.ndarray
    motion: np.ndarray


def collapse_load(system: Sparse, friction: np.ndarray, direction: int) -> Interior | None:
    """Greatest direction * gamma under friction (joints); None where the iteration does not settle."""
    corner = system.matrix[:, :-1].tocsc()
    live = system.matrix[:, [-1]].toarray().ravel()
    normal_p, normal_q, shear = (corner[:, k::3] for k in range(3))
    sheared = shear @ sparse.diags_array(friction)
    edges = [normal_p + sheared, normal_p - sheared, normal_q + sheared, normal_q - sheared]
    a = sparse.csr_array(sparse.hstack(edges))
    at = sparse.csr_array(a.T)
    found = _mehrotra(a, at, live, system.right, direction)
    if found is None:
        return None
    x, gamma, y = found
    pp, pm, qp, qm = x.reshape(4, -1)
    corners = np.column_stack([pp + pm, qp + qm, friction * (pp - pm + qp - qm)])
    return Interior(gamma, corners, -y.reshape(-1, 3), -(corner.T @ y).reshape(-1, 3))


@np.errstate(over="ignore", invalid="ignore")  # an iteration that runs away is seen by its numbers and given up
def _mehrotra(
    a: sparse.csr_array, at: sparse.csr_array, live: np.ndarray, right: np.ndarray, direction: int
) -> tuple[np.ndarray, float, np.ndarray] | None:
    """Minimise -direction * gamma subject to a x + live gamma = right, x >= 0: x, gamma and the multipliers."""
    from scipy.sparse.linalg import splu  # takes a tenth of a second to load, and most sections do without

    rows, n = a.shape

    def factor(weight: np.ndarray) -> "SuperLU":
        matrix = sparse.csc_array(a @ sparse.diags_array(weight) @ at)
        matrix = matrix + sparse.eye_array(rows, format="csc") * SHIFT
        return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    x, z, y, gamma = np.full(n, 10.0 / n), np.ones(n), np.zeros(rows), 0.0
    good = None
    for _ in range(ROUNDS):
        primal, dual, free = right - a @ x - live * gamma, -(at @ y) - z, -direction - live @ y
        gap, residual = abs(-direction * gamma - right @ y) / max(1.0, abs(gamma)), np.abs(primal).max()
        if gap < GAP and residual < RESIDUAL:
            return x, gamma, y
        if gap < LOOSE_GAP and residual < LOOSE_RESIDUAL:
            good = x, gamma, y
        if x.min() < SMALLEST or z.min() < SMALLEST:
            return good
        try:
            solver = factor(x / z)
        except RuntimeError:  # SuperLU met an exact zero
            return good
        along = solver.solve(live)

        def newton(
            complement: np.ndarray,
            solver: "SuperLU" = solver, along: np.ndarray = along, primal: np.ndarray = primal, dual: np.ndarray = dual,
            free: np.floating | np.ndarray = free, x: np.ndarray = x, z: np.ndarray = z,
        ) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:  # fmt: skip
            part = solver.solve(primal + a @ ((x * dual - complement) / z))
            dgamma = float((live @ part - free) / (live @ along))
            dy = part - along * dgamma
            dz = dual - at @ dy
            return (complement - x * dz) / z, dy, dz, dgamma

        dx, _, dz, _ = newton(-x * z)
        reach, reach_dual = _reach(x, dx), _reach(z, dz)
        mean = x @ z / n
        aimed = ((x + reach * dx) @ (z + reach_dual * dz) / n / mean) ** 3 * mean
        dx, dy, dz, dgamma = newton(aimed - x * z - dx * dz)
        step, step_dual = TOWARDS_EDGE * _reach(x, dx), TOWARDS_EDGE * _reach(z, dz)
        x, gamma, y, z = x + step * dx, gamma + step * dgamma, y + step_dual * dy, z + step_dual * dz
        if not (np.isfinite(gamma) and np.isfinite(y).all()):
            break
    return good


def _reach(value: np.ndarray, change: np.ndarray) -> float:
    """How much of a step keeps all values from going below zero, at most one over the edge factor."""
    falling = change < 0.0
    return min(1.0, float((-value[falling] / change[falling]).min())) if falling.any() else 1.0
