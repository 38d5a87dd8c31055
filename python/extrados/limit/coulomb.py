"""Dry friction without dilatancy: states in which what moves opens or slides, and sliding does not dilate.

Such a state is in equilibrium, obeys Coulomb's law |s| <= mu N at every joint, and carries a motion by which no
joint overlaps, pressed ends do not part, and only joints at their limit slide, against their shear: a mixed
complementarity problem (Ferris and Tin-Loi 2001). Its load lies at or below that of associated friction and at
or above that of joints without friction (Drucker 1954), and is not unique. From each start an interior-point
method for the whole problem finds one state, and in small assemblies fictitious cohesion from random normal forces finds
a second one; from each, two linear programmes in turn bring the load down: the least load of the forces that go with this
motion, then a motion that goes with these forces and gives way where the forces ask for it. Every step is a state again,
so that the load only falls.
"""

from dataclasses import dataclass

import highspy
import numpy as np
from scipy import sparse

from extrados.core.calls import stop_if_asked
from extrados.limit.interior import RESIDUAL, SIDES, CollapseProblem, Residuals
from extrados.limit.solver import NoAnswer, NoEquilibrium, linear_programme
from extrados.limit.systems import Sparse

NEAR = 1e-2  # misfit of an iterate whose pattern is worth trying by programmes
TAKEN = 1e-5  # worst residual of a state that no programme has made exact
MOST_JOINTS = 1500  # walls of more are not brought down by programmes, which take too long
ACTIVE = 1e-9  # of the total load, or of the fastest motion: more than zero
NEUTRAL = 1e-9  # of the fastest motion: joints that move by more
COHESIONS = 60  # rounds of fictitious cohesion
GUESS_JOINTS = 100  # with more joints fictitious cohesion from random forces takes too long
GUESSES = (-2.0, 0.5)  # decades of random normal forces over the total load
MORE_STARTS = 12  # where none of those asked for leads to a state
DESCENTS = 20
FALLS = 1e-10  # of gamma: a descent of less is none
SCATTER = 1e-4  # of the costs by which a motion is chosen, so that each start may choose another
INFINITY = highspy.kHighsInf


@dataclass(frozen=True)
class CoulombState:
    """gamma, corner forces (joints, 3) over the total load, shares of the forces that answer to movement, twists
    (blocks, 3) and motion (joints, 3); starts: the gamma at which each start ended that gave a state; falling: the stone
    that slides out in a state at rest."""

    gamma: float
    corners: np.ndarray
    share: np.ndarray
    twist: np.ndarray
    motion: np.ndarray
    residuals: Residuals
    starts: tuple[float, ...]
    falling: int | None = None


Forces = tuple[float, np.ndarray, np.ndarray]  # load, corner forces, shares of the forces that answer
Found = tuple[float, np.ndarray, np.ndarray, np.ndarray]  # these and the twists of a state


@dataclass(frozen=True)
class Gives:
    """Where a motion gives way: ends (joints, 2) that part, senses (joints, 2) in which joints slide, and forces that
    answer (2, k) that are held at their least, or at their greatest, by the work it does with or against them."""

    parts: np.ndarray
    slides: np.ndarray
    held: np.ndarray


class CoulombProblem(CollapseProblem):
    """The complementarity problem of sliding without dilatancy."""

    def __init__(self, system: Sparse, friction: np.ndarray, sense: int, crush: np.ndarray | None = None):
        super().__init__(system, friction, sense, crush, dilates=False)

    def least(self, starts: int, at_least: float = -np.inf) -> CoulombState | None:
        """The state of least load to which `starts` starts lead; None where none leads to one.

        at_least: of sense * gamma; the programmes seek no lesser loads.
        """
        exactly = not self.crushes and self.joints <= MOST_JOINTS
        ended: list[tuple[Found, Residuals]] = []
        for start in range(starts + (MORE_STARTS if exactly else 0)):
            if start >= starts and ended:
                break
            if exactly and self.joints <= GUESS_JOINTS:
                scatter = np.random.default_rng([start, 1])
                held = 10.0 ** scatter.uniform(*GUESSES, self.joints)
                found = self._by_cohesion(held, scatter, at_least)
                if found is not None and (residuals := self.residuals(*found)).worst < RESIDUAL:
                    ended.append((found, residuals))
            scatter = np.random.default_rng(start)
            point, misfit = self.state(scatter if start else None)
            found = None
            if exactly:
                if misfit < NEAR:
                    gives = Gives(point.o > point.v, point.slip > point.w, self.bounded & (point.hold > point.room))
                    found = self._descent(None, gives, scatter, at_least)
                if found is None and misfit > RESIDUAL:
                    held = np.clip(point.n.sum(axis=1), 0.0, 1.0) * 10.0 ** scatter.uniform(-0.3, 0.3, self.joints)
                    found = self._by_cohesion(held, scatter, at_least)
            # A state that the programmes could not make exact stands for itself.
            itself = (point.gamma, point.corners, point.share, point.u), TAKEN
            for state, enough in ((found, RESIDUAL), itself) if found else (itself,):
                residuals = self.residuals(*state)
                if residuals.worst < enough:
                    ended.append((state, residuals))
                    break
        if not ended:
            return None
        (gamma, corners, share, u), residuals = min(ended, key=lambda one: one[0][0])
        return CoulombState(
            self.sense * gamma,
            corners,
            share,
            u.reshape(-1, 3),
            self.motion(u),
            residuals,
            tuple(self.sense * state[0] for state, _ in ended),
        )

    def neutral(self, stone: int) -> CoulombState | None:
        """The state at rest in which a stone slides down under its own weight against all that friction holds, whatever the
        load. None where there is none."""
        u = np.zeros(self.system.equations)
        u[3 * stone + 1] = -1.0
        motion = self.motion(u)
        least = NEUTRAL * float(np.abs(motion).max())
        slides = np.column_stack([motion[:, 2] < -least, motion[:, 2] > least])
        found = self._least_forces(Gives(motion[:, :2] > least, slides, SIDES * (self.answers_t @ u) > least), 0.0, 0.0)
        if found is None:
            return None
        (_, corners, share), _ = found
        residuals = self.residuals(0.0, corners, share, u)
        if residuals.worst > TAKEN:
            return None
        return CoulombState(0.0, corners, share, u.reshape(-1, 3), motion, residuals, (0.0,), stone)

    def _descent(self, u: np.ndarray | None, gives: Gives, scatter: np.random.Generator, at_least: float) -> Found | None:
        """The state to which alternate programmes lead from a motion, or from where it gives way if it is known to
        rounding only; None where no forces go with that."""
        best = None
        for _ in range(DESCENTS):
            least = self._least_forces(gives, at_least)
            if least is None:
                break
            forces, wishes = least
            falls = best is None or forces[0] < best[0] - FALLS
            if u is not None:
                best = (*forces, u)
            moves = self._motion_of(forces, wishes + SCATTER * scatter.uniform(0.0, 1.0, wishes.shape))
            if moves is None or not falls:
                break
            u, gives = moves
            best = (*forces, u)
        return best

    @property
    def _forces(self) -> sparse.csr_array:
        """Equations of the corner forces, the shares of the forces that answer, and the load."""
        return sparse.hstack([self.corner, self.answers, sparse.csr_array(self.live[:, None])], format="csr")

    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and greatest of these: joints press, ties do not exceed their yield force."""
        m = self.joints
        low = np.concatenate([np.zeros(3 * m), self.bounds[0], [-INFINITY]])
        high = np.concatenate([np.full(3 * m, INFINITY), self.bounds[1], [INFINITY]])
        low[2 : 3 * m : 3] = -INFINITY
        return low, high

    def _by_cohesion(self, held: np.ndarray, scatter: np.random.Generator, at_least: float) -> Found | None:
        """A state by fictitious cohesion (Gilbert, Casapulla and Ahmed 2006), from normal forces N0 `held` (joints).

        With |s| <= mu N0, sliding does not dilate and a linear programme gives the motion; N0 follows the normal
        forces. Of every motion on the way it is asked whether forces go with it that obey the true law.
        """
        m, system, equations = self.joints, self.system, self._forces
        cost = np.zeros(equations.shape[1])
        cost[-1] = -1.0
        low, high = self._bounds()
        for _ in range(COHESIONS):
            stop_if_asked()
            low[2 : 3 * m : 3], high[2 : 3 * m : 3] = -self.friction * held, self.friction * held
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
            gives = Gives(motion[:, :2] > least, slides, SIDES * (self.answers_t @ u) > least)
            state = self._descent(u, gives, scatter, at_least)
            if state is not None:
                return state
            normal = found.x[: 3 * m].reshape(-1, 3)[:, :2].sum(axis=1)
            held = held + scatter.uniform(0.1, 0.6) * (normal - held)
        return None

    def _least_forces(self, gives: Gives, at_least: float, at_most: float = INFINITY) -> tuple[Forces, np.ndarray] | None:
        """Least load of forces that are zero where ends part, and at their limit where joints slide or ties yield.

        Also, for each end and sense that gives way (4, joints), by how much the load would fall per force gained if it did
        not.
        """
        stop_if_asked()
        m, system = self.joints, self.system
        j, one = np.arange(m), np.ones(m)
        columns = np.concatenate([3 * j, 3 * j + 1, 3 * j + 2])
        equations = self._forces
        cones = [
            sparse.csr_array(
                (np.concatenate([self.friction, self.friction, sign * one]), (np.tile(j, 3), columns)), shape=(m, equations.shape[1])
            )
            for sign in (-1.0, 1.0)
        ]
        parts, slides = gives.parts, gives.slides
        lower = np.concatenate([system.right, np.zeros(2 * m)])
        upper = np.concatenate([system.right, np.where(slides.T.ravel(), 0.0, INFINITY)])
        low, high = self._bounds()
        low[-1], high[-1] = max(at_least, -INFINITY), at_most
        high[0 : 3 * m : 3][parts[:, 0]] = high[1 : 3 * m : 3][parts[:, 1]] = 0.0
        answers = slice(3 * m, -1)
        least, most = gives.held & self.bounded
        high[answers] = np.where(least, self.bounds[0], high[answers])
        low[answers] = np.where(most & ~least, self.bounds[1], low[answers])
        cost = np.zeros(equations.shape[1])
        cost[-1] = 1.0
        try:
            found = linear_programme(sparse.vstack([equations, *cones]), lower, upper, cost, low, high)
        except (NoEquilibrium, NoAnswer):
            return None
        corners = found.x[: 3 * m].reshape(-1, 3)
        pull = np.where(parts, np.maximum(-found.columns[: 3 * m].reshape(-1, 3)[:, :2], 0.0), 0.0)
        drag = np.where(slides, np.maximum(-found.rows[len(system.right) :].reshape(2, m).T, 0.0), 0.0)
        return (float(found.x[-1]), corners, found.x[answers]), np.concatenate([pull.T, drag.T])

    def _motion_of(self, forces: Forces, cost: np.ndarray) -> tuple[np.ndarray, Gives] | None:
        """A motion that goes with the forces, of least cost (4, joints) of its openings and slips; where it gives way."""
        _, corners, share = forces
        m, n = self.joints, self.system.equations
        one, none = sparse.eye_array(m, format="csr"), sparse.csr_array((m, m))
        turned = self.corner_t
        rows = sparse.vstack(
            [
                sparse.hstack([turned[0::3], -one, none, none, none]),
                sparse.hstack([turned[1::3], none, -one, none, none]),
                sparse.hstack([turned[2::3], none, none, one, -one]),
                sparse.hstack([sparse.csr_array(self.live[None, :]), sparse.csr_array((1, 4 * m))]),
                sparse.hstack([self.answers_t, sparse.csr_array((len(share), 4 * m))]),
            ]
        )
        # Forces that answer do no work within their bounds, at the greatest only against the motion, at the least only with it.
        above_least, below_greatest = SIDES * (share - self.bounds) > ACTIVE
        lower = np.concatenate([np.zeros(3 * m), [1.0], np.where(below_greatest, 0.0, -INFINITY)])
        upper = np.concatenate([np.zeros(3 * m), [1.0], np.where(above_least, 0.0, INFINITY)])
        limit = self.friction * corners[:, :2].sum(axis=1)
        room = np.concatenate([corners[:, 0], corners[:, 1], limit - corners[:, 2], limit + corners[:, 2]])
        low = np.concatenate([np.full(n, -INFINITY), np.zeros(4 * m)])
        high = np.concatenate([np.full(n, INFINITY), np.where(room > ACTIVE, 0.0, INFINITY)])
        try:
            found = linear_programme(rows, lower, upper, np.concatenate([np.zeros(n), cost.ravel()]), low, high)
        except (NoEquilibrium, NoAnswer):
            return None
        u, least = found.x[:n], ACTIVE * max(1.0, float(np.abs(found.x[:n]).max()))
        moves = found.x[n:].reshape(4, m) > least
        return u, Gives(moves[:2].T, moves[2:].T, SIDES * (self.answers_t @ u) > least)
