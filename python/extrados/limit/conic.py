"""Collapse of joints that crush where sliding dilates: a second-order cone programme and its dual.

A joint of length L, depth B and strength f bears N at a distance of at least N/(2 f B) from its ends (a rectangular stress
block): with n_p and n_q the forces at the ends, n_p, n_q >= c N^2, c = 1/(2 f B L), each a rotated cone. Clarabel finds forces
and, as multipliers of equilibrium, the motion. The bound from the motion is computed apart from it (`work_of_joints`).
"""

from dataclasses import dataclass

import clarabel
import numpy as np
from scipy import sparse

from extrados.limit.systems import Sparse

#: Of the gap and of what is left of the equations, the sharpest first: what a wall of thousands of joints does not reach
ACCURACY = (1e-11, 1e-9)
ROUNDS = 200
#: Of the total load: about what joints bear, which scales their cones
NEAR = 0.1


@dataclass(frozen=True)
class ConicCollapse:
    """gamma; corner forces (joints, 3) over the total load and shares of the forces that answer to movement; twists
    (blocks, 3); motion of the joints (joints, 3); and the greatest work that forces within the laws take from it."""

    gamma: float
    corners: np.ndarray
    share: np.ndarray
    twist: np.ndarray
    motion: np.ndarray
    taken: float


def collapse_of_crushing(
    system: Sparse, friction: np.ndarray | None, crush: np.ndarray, bounds: np.ndarray, sense: int
) -> ConicCollapse | None:
    """The greatest load sense * gamma that joints bear which slide by `friction` (joints) and crush by n >= crush N^2.

    friction: None forbids sliding. bounds (2, k): of the shares of forces that answer to movement. None where the solver finds
    no such load, or none that is finite.
    """
    joints, answers = len(crush), bounds.shape[1]
    live = sense * system.matrix[:, [-1]].toarray()
    unknowns = 3 * joints + answers + 1
    at = 3 * np.arange(joints)

    def rows(*columns: tuple[int, np.ndarray]) -> sparse.csr_array:
        """One row per joint, of the coefficients of its forces n_p, n_q, s."""
        column = np.concatenate([at + which for which, _ in columns])
        value = np.concatenate([coefficient for _, coefficient in columns])
        return sparse.csr_array((value, (np.tile(np.arange(joints), len(columns)), column)), (joints, unknowns))

    parts = [sparse.hstack([system.corner_matrix, system.matrix[:, system.shares], sparse.csr_array(live)])]
    right, cones = [system.right], [clarabel.ZeroConeT(len(system.right))]
    if friction is not None:
        one = np.ones(joints)
        parts += [-rows((0, friction), (1, friction), (2, sign * one)) for sign in (1.0, -1.0)]
        right.append(np.zeros(2 * joints))
        cones.append(clarabel.NonnegativeConeT(2 * joints))
    for sign, bound in zip((1.0, -1.0), bounds, strict=True):
        bounded = np.flatnonzero(np.isfinite(bound))
        column = 3 * joints + bounded
        parts.append(sparse.csr_array((np.full(len(bounded), -sign), (np.arange(len(bounded)), column)), (len(bounded), unknowns)))
        right.append(-sign * bound[bounded])
        cones.append(clarabel.NonnegativeConeT(len(bounded)))
    # (n + b, n - b, 2 N sqrt(b c)) in the cone is n >= c N^2, for any b > 0
    b = np.minimum(1.0 / crush, NEAR)
    interleaved = np.arange(3 * joints).reshape(3, joints).T.ravel()
    both = rows(*((end, 2.0 * np.sqrt(b * crush)) for end in (0, 1)))
    for end in (0, 1):
        near = rows((end, np.ones(joints)))
        parts.append(-sparse.csr_array(sparse.vstack([near, near, both]))[interleaved])
        right.append(np.column_stack([b, -b, np.zeros(joints)]).ravel())
        cones += [clarabel.SecondOrderConeT(3)] * joints
    cost = np.zeros(unknowns)
    cost[-1] = -1.0
    matrix, nothing = sparse.csc_matrix(sparse.vstack(parts)), sparse.csc_matrix((unknowns, unknowns))
    for accuracy in ACCURACY:
        settings = clarabel.DefaultSettings()
        settings.verbose, settings.max_threads, settings.max_iter = False, 1, ROUNDS
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = accuracy
        found = clarabel.DefaultSolver(nothing, cost, matrix, np.concatenate(right), cones, settings).solve()
        if found.status in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved):
            break
    else:
        return None
    x = np.array(found.x)
    twist = np.array(found.z)[: len(system.right)]
    twist = twist / float(live.ravel() @ twist)  # the load works one
    motion = (system.corner_matrix.T @ twist).reshape(-1, 3)
    corners = x[: 3 * joints].reshape(-1, 3)
    return ConicCollapse(
        sense * float(x[-1]), corners, x[3 * joints : -1], twist.reshape(-1, 3), motion, work_of_joints(motion, friction, crush)
    )


def work_of_joints(motion: np.ndarray, friction: np.ndarray | None, crush: np.ndarray) -> float:
    """The greatest work that the forces of joints within their laws take from a motion (joints, 3): opening at p and at q, slip.

    With |s| = mu N the ends open by less; of N and what is left of the opening, a <= b, the bounds n_p, n_q >= c N^2 leave
    -a N - c (b - a) N^2, whose greatest value is at N = -a / (2 c (b - a)), at most 1 / (2 c).
    """
    ends = motion[:, :2] if friction is None else motion[:, :2] - (friction * np.abs(motion[:, 2]))[:, None]
    less, turn = ends.min(axis=1), np.ptp(ends, axis=1)
    normal = np.clip(-less / np.maximum(2.0 * crush * turn, 1e-300), 0.0, 0.5 / crush)
    return float(-(less * normal + crush * turn * normal**2).sum())
