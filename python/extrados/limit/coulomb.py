"""Dry friction without dilatancy: states in which what moves opens or slides, and sliding does not dilate.

Such a state is in equilibrium, obeys Coulomb's law |s| <= mu N at every joint, and carries a motion by which no
joint overlaps, pressed ends do not part, and only joints at their limit slide, against their shear: a mixed
complementarity problem (Ferris and Tin-Loi 2001). Its load lies at or below that of associated friction and at
or above that of joints without friction (Drucker 1954), and is not unique. From each start an interior-point
method for the whole problem finds one state; from there two linear programmes in turn bring the load down: the
least load of the forces that go with this motion, then a motion that goes with these forces and gives way where
the forces ask for it. Every step is a state again, so that the load only falls.
"""

from dataclasses import dataclass

import highspy
import numpy as np
from scipy import sparse

from extrados.limit.interior import RESIDUAL, CollapseProblem, Residuals
from extrados.limit.solver import NoAnswer, NoEquilibrium, linear_programme
from extrados.limit.systems import Sparse

NEAR = 1e-2  # misfit of an iterate whose pattern is worth trying by programmes
TAKEN = 1e-5  # worst residual of a state that no programme has made exact
MOST_JOINTS = 1500  # walls of more are not brought down by programmes, which take too long
ACTIVE = 1e-9  # of the total load, or of the fastest motion: more than zero
COHESIONS = 60  # rounds of fictitious cohesion
MORE_STARTS = 12  # where none of those asked for leads to a state
DESCENTS = 20
FALLS = 1e-10  # of gamma: a descent of less is none
SCATTER = 1e-4  # of the costs by which a motion is chosen, so that each start may choose another
INFINITY = highspy.kHighsInf


@dataclass(frozen=True)
class CoulombState:
    """gamma, corner forces (joints, 3) over the total load, twists (blocks, 3) and motion (joints, 3); starts: the gamma
    at which each start ended that gave a state."""

    gamma: float
    corners: np.ndarray
    twist: np.ndarray
    motion: np.ndarray
    residuals: Residuals
    starts: tuple[float, ...]


Found = tuple[float, np.ndarray, np.ndarray]  # load, corner forces and twists of a state


class CoulombProblem(CollapseProblem):
    """The complementarity problem of sliding without dilatancy."""

    def __init__(self, system: Sparse, friction: np.ndarray, sense: int, crush: np.ndarray | None = None):
        super().__init__(system, friction, sense, crush, dilates=False)

    def least(self, starts: int, at_least: float = -np.inf) -> CoulombState | None:
        """The state of least load to which `starts` starts lead; None where none leads to one.

        at_least: of sense * gamma; the programmes seek no lesser loads.
        """
        exactly = not self.crushes and self.joints <= MOST_JOINTS
        ended: list[tuple[float, np.ndarray, np.ndarray, Residuals]] = []
        for start in range(starts + (MORE_STARTS if exactly else 0)):
            if start >= starts and ended:
                break
            scatter = np.random.default_rng(start)
            point, misfit = self.state(scatter if start else None)
            found = None
            if exactly:
                if misfit < NEAR:
                    slides = point.slip > point.w
                    found = self._descent(None, point.o > point.v, slides, scatter, at_least)
                if found is None and misfit > RESIDUAL:
                    found = self._by_cohesion(point.n.sum(axis=1), scatter, at_least)
            # A state that the programmes could not make exact stands for itself.
            itself = (point.gamma, point.corners, point.u), TAKEN
            for (gamma, corners, u), enough in ((found, RESIDUAL), itself) if found else (itself,):
                residuals = self.residuals(gamma, corners, u)
                if residuals.worst < enough:
                    ended.append((gamma, corners, u, residuals))
                    break
        if not ended:
            return None
        gamma, corners, u, residuals = min(ended, key=lambda state: state[0])
        return CoulombState(
            self.sense * gamma, corners, u.reshape(-1, 3), self.motion(u), residuals,
            tuple(self.sense * state[0] for state in ended),
        )  # fmt: skip

    def _descent(
        self, u: np.ndarray | None, parts: np.ndarray, slides: np.ndarray, scatter: np.random.Generator, at_least: float
    ) -> Found | None:
        """The state to which alternate programmes lead from a motion, or from ends (joints, 2) that part and senses
        (joints, 2) in which joints slide where it is known to rounding only; None where no forces go with these."""
        best = None
        for _ in range(DESCENTS):
            forces = self._least_forces(parts, slides, at_least)
            if forces is None:
                break
            gamma, corners, wishes = forces
            falls = best is None or gamma < best[0] - FALLS
            if u is not None:
                best = (gamma, corners, u)
            moves = self._motion_of(corners, wishes + SCATTER * scatter.uniform(0.0, 1.0, wishes.shape))
            if moves is None or not falls:
                break
            u, parts, slides = moves
            best = (gamma, corners, u)
        return best

    def _by_cohesion(self, normal: np.ndarray, scatter: np.random.Generator, at_least: float) -> Found | None:
        """A state by fictitious cohesion (Gilbert, Casapulla and Ahmed 2006), from guessed normal forces (joints).

        With |s| <= mu N0 held, sliding does not dilate and a linear programme gives the motion; N0 follows the normal
        forces. Of every motion on the way it is asked whether forces go with it that obey the true law.
        """
        m, system = self.joints, self.system
        equations = sparse.hstack([self.corner, sparse.csr_array(self.live[:, None])])
        cost = np.zeros(3 * m + 1)
        cost[-1] = -1.0
        held = np.clip(normal, 0.0, 1.0) * 10.0 ** scatter.uniform(-0.3, 0.3, m)
        for _ in range(COHESIONS):
            low, high = np.zeros(3 * m + 1), np.full(3 * m + 1, INFINITY)
            low[2:-1:3], high[2:-1:3] = -self.friction * held, self.friction * held
            low[-1] = -INFINITY
            try:
                found = linear_programme(equations, system.right, system.right, cost, low, high)
            except (NoEquilibrium, NoAnswer):
                held = held + 0.1 * scatter.uniform(0.0, 1.0, m) / m
                continue
            u = -found.rows
            u = u / float(self.live @ u)
            motion = self.motion(u)
            least = ACTIVE * max(1.0, float(np.abs(u).max()))
            slides = np.column_stack([motion[:, 2] < -least, motion[:, 2] > least])
            state = self._descent(u, motion[:, :2] > least, slides, scatter, at_least)
            if state is not None:
                return state
            normal = found.x[:-1].reshape(-1, 3)[:, :2].sum(axis=1)
            held = held + scatter.uniform(0.1, 0.6) * (normal - held)
        return None

    def _least_forces(
        self, parts: np.ndarray, slides: np.ndarray, at_least: float
    ) -> tuple[float, np.ndarray, np.ndarray] | None:
        """Least load of forces that are zero where ends part and at their limit where joints slide (joints, 2 each).

        Also, for each such end and sense (4, joints), by how much the load would fall per force gained if it did not.
        """
        m, system = self.joints, self.system
        j, one = np.arange(m), np.ones(m)
        columns = np.concatenate([3 * j, 3 * j + 1, 3 * j + 2])
        cones = [
            sparse.csr_array(
                (np.concatenate([self.friction, self.friction, sign * one]), (np.tile(j, 3), columns)),
                shape=(m, 3 * m + 1),
            )
            for sign in (-1.0, 1.0)
        ]
        equations = sparse.hstack([self.corner, sparse.csr_array(self.live[:, None])])
        lower = np.concatenate([system.right, np.zeros(2 * m)])
        upper = np.concatenate([system.right, np.where(slides.T.ravel(), 0.0, INFINITY)])
        low, high = np.zeros(3 * m + 1), np.full(3 * m + 1, INFINITY)
        low[2:-1:3], low[-1] = -INFINITY, max(at_least, -INFINITY)
        high[0:-1:3][parts[:, 0]] = high[1:-1:3][parts[:, 1]] = 0.0
        cost = np.zeros(3 * m + 1)
        cost[-1] = 1.0
        try:
            found = linear_programme(sparse.vstack([equations, *cones]), lower, upper, cost, low, high)
        except (NoEquilibrium, NoAnswer):
            return None
        corners = found.x[:-1].reshape(-1, 3)
        pull = np.where(parts, np.maximum(-found.columns[:-1].reshape(-1, 3)[:, :2], 0.0), 0.0)
        drag = np.where(slides, np.maximum(-found.rows[len(system.right) :].reshape(2, m).T, 0.0), 0.0)
        return float(found.x[-1]), corners, np.concatenate([pull.T, drag.T])

    def _motion_of(self, corners: np.ndarray, cost: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """A motion that goes with the forces, of least cost (4, joints) of its openings and slips; which part and slide."""
        m, n = self.joints, self.system.equations
        one, none = sparse.eye_array(m, format="csr"), sparse.csr_array((m, m))
        turned = self.corner_t
        rows = sparse.vstack([
            sparse.hstack([turned[0::3], -one, none, none, none]),
            sparse.hstack([turned[1::3], none, -one, none, none]),
            sparse.hstack([turned[2::3], none, none, one, -one]),
            sparse.hstack([sparse.csr_array(self.live[None, :]), sparse.csr_array((1, 4 * m))]),
        ])  # fmt: skip
        right = np.append(np.zeros(3 * m), 1.0)
        limit = self.friction * corners[:, :2].sum(axis=1)
        room = np.concatenate([corners[:, 0], corners[:, 1], limit - corners[:, 2], limit + corners[:, 2]])
        low = np.concatenate([np.full(n, -INFINITY), np.zeros(4 * m)])
        high = np.concatenate([np.full(n, INFINITY), np.where(room > ACTIVE, 0.0, INFINITY)])
        try:
            found = linear_programme(rows, right, right, np.concatenate([np.zeros(n), cost.ravel()]), low, high)
        except (NoEquilibrium, NoAnswer):
            return None
        moves = found.x[n:].reshape(4, m)
        moves = moves > ACTIVE * max(1.0, float(np.abs(found.x[:n]).max()))
        return found.x[:n], moves[:2].T, moves[2:].T
