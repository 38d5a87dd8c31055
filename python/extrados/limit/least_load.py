"""The least load of states of collapse in which sliding does not dilate, by two cone programmes in turn.

A motion v whose contacts do not overlap, and forces within Coulomb's cones in equilibrium, belong to each other where the gap
sum(N u_n + t . u_t + mu N |u_t|) = -dead . v - gamma + mu sum N |u_t| is zero; each of its terms is at least zero. The first
programme seeks the forces of least gamma that go with a motion: the gap is linear in them. The second seeks a motion that goes
with these forces: with |t| <= mu N at fixed N, sliding does not dilate, and the multipliers of the greatest load are a motion.
A state found once stays within reach, so that gamma does not rise. Local minima: the least of several starts counts.
"""

from collections.abc import Sequence
from dataclasses import replace

import clarabel
import numpy as np
from scipy import sparse

from extrados.limit.certificate import CLOSING
from extrados.limit.contact_points import ContactPoints, SlidingState

ROUNDS, TRIES = 12, 12
FOLLOWS = (0.2, 0.8)  # share by which compressions follow
ROOMS = (1e-7, 1e-6, 1e-5, 1e-4, 2e-3)  # of gamma: gaps that are let pass on the way
GUESSES = (-2.0, 0.5)  # decades of random compressions over the mean
FALLS = 1e-6  # of gamma: a descent of less is none
ACCURACY = 1e-10
EXACT = 1e-6  # gap of a state


class LeastLoad:
    """The programmes of one structure under one live load."""

    def __init__(self, points: ContactPoints):
        self.points = points
        p, d = points, points.dimension
        m, k = len(p.friction), p.answers.shape[1]
        self.unknowns = m * d + k + 1
        balance = sparse.hstack([p.matrix, p.answers, sparse.csr_array(p.live[:, None])])
        one = sparse.eye_array(self.unknowns, format="csr")
        self.normal = np.flatnonzero(p.stiffness > 0.0)
        self.limited = np.flatnonzero(np.isfinite(p.friction) & np.isfinite(p.grip))
        own = self.limited
        slope = sparse.csr_array((p.friction[own], (np.arange(len(own)), d * own)), shape=(len(own), self.unknowns))
        self.cone, self.cylinder = (
            sparse.vstack([part, *(one[d * own + i] for i in range(1, d))])[self._by_point(len(own))]
            for part in (slope, sparse.csr_array((len(own), self.unknowns)))
        )
        answers = one[m * d : m * d + k]
        self.low, self.high = np.isfinite(p.bounds)
        self.balance = balance
        self.linear = sparse.vstack([one[d * self.normal], answers[self.low], -answers[self.high]])
        self.least = np.concatenate([np.zeros(len(self.normal)), p.bounds[0][self.low], -p.bounds[1][self.high]])
        dowels = np.flatnonzero(p.stiffness == 0.0)
        self.none = one[d * dowels]

    def _by_point(self, count: int) -> np.ndarray:
        return np.arange(count * self.points.dimension).reshape(self.points.dimension, count).T.ravel()

    def with_motion(self, state: SlidingState) -> SlidingState | None:
        """The forces of a state with a motion that goes with them, of rigid blocks alone; None where the greatest load at the
        friction of its compressions is another."""
        moved = self._cylinder(np.maximum(state.force[:, 0], 0.0))
        return None if moved is None else replace(state, motion=moved[0])

    def descended(self, start: SlidingState) -> SlidingState:
        """The state to which the programmes lead from a state."""
        best, forces = start, self._forces(start.motion, ROOMS[:1])
        for _ in range(ROUNDS):
            if forces is None or forces[0] > best.gamma - FALLS * max(1.0, abs(best.gamma)):
                break
            gamma, force, share, _ = forces
            best = SlidingState(gamma, force, share, best.motion)
            moved = self._cylinder(np.maximum(force[:, 0], 0.0))
            forces = None if moved is None else self._forces(moved[0], ROOMS[:1])
            if moved is not None and forces is not None:
                best = replace(best, motion=moved[0])
        return best

    def guessed(self, draw: np.random.Generator) -> SlidingState | None:
        """A state from random compressions, which follow those of the greatest load at fixed friction; None without one."""
        p = self.points
        mean = p.weight / max(len(self.normal), 1)
        normal = mean * 10.0 ** draw.uniform(*GUESSES, len(p.friction))
        for _ in range(TRIES):
            moved = self._cylinder(normal)
            if moved is None:  # too little friction to stand
                normal = normal + mean * draw.uniform(0.0, 1.0, len(normal))
                continue
            motion, force = moved
            forces = self._forces(motion, ROOMS)
            if forces is not None:
                gamma, with_it, share, gap = forces
                if gap <= EXACT * max(abs(gamma), 0.01):
                    return self.descended(SlidingState(gamma, with_it, share, motion))
                force = with_it
            normal = normal + draw.uniform(*FOLLOWS) * (np.maximum(force[:, 0], 0.0) - normal)
        return None

    def _forces(self, motion: np.ndarray, rooms: Sequence[float]) -> tuple[float, np.ndarray, np.ndarray, float] | None:
        """Forces of least gamma that go with a motion, with the least of some gaps, and the gap; None beyond the last."""
        p, d = self.points, self.points.dimension
        rate = (p.rates @ motion).reshape(-1, d)
        slip = np.sqrt((rate[:, 1:] ** 2).sum(axis=1))
        own = self.limited
        work = np.zeros(self.unknowns)
        work[d * own] = p.friction[own] * slip[own]
        taken = -float(p.dead @ motion) + float((p.grip[own] * slip[own]).sum()) + self._taken(motion)
        cut = -work
        cut[-1] += 1.0
        for room in rooms:
            linear = sparse.vstack([self.linear, sparse.csr_array(cut[None])])
            x, _ = self._solve(1.0, linear, np.append(self.least, taken - room * max(1.0, abs(taken))), self.cone, p.grip[own])
            if x is not None:
                force, share = x[: -1 - p.answers.shape[1]].reshape(-1, d), x[len(x) - 1 - p.answers.shape[1] : -1]
                return float(x[-1]), force, share, abs(float(cut @ x) - taken)
        return None

    def _taken(self, motion: np.ndarray) -> float:
        """Work that the answers take of a motion at their bounds."""
        moved = self.points.answers.T @ motion
        low, high = (np.where(np.isfinite(bound), bound, 0.0) for bound in self.points.bounds)
        return float(np.maximum(-high * moved, -low * moved).sum())

    def _cylinder(self, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The motion, with a work of the live load of one, and the forces (points, d) of the greatest load at fixed friction
        mu N; None where the load does no work."""
        p = self.points
        own = self.limited
        x, dual = self._solve(-1.0, self.linear, self.least, self.cylinder, p.friction[own] * normal[own] + p.grip[own])
        if x is None or dual is None:
            return None
        work = float(p.live @ dual)
        if abs(work) < 1e-9 * np.abs(dual).max():
            return None
        return dual / work, x[: -1 - p.answers.shape[1]].reshape(-1, p.dimension)

    def _solve(
        self, cost: float, linear: sparse.csr_array, least: np.ndarray, cone: sparse.csr_array, radius: np.ndarray
    ) -> tuple[np.ndarray | None, np.ndarray | None]:
        """The forces of least cost times gamma in equilibrium, linear . x >= least, and the multipliers of equilibrium."""
        p, d = self.points, self.points.dimension
        right = np.zeros(cone.shape[0])
        right[::d] = radius
        matrix = sparse.vstack([self.balance, self.none, -linear, -cone]).tocsc()
        b = np.concatenate([-p.dead, np.zeros(self.none.shape[0]), -least, right])
        cones = [clarabel.ZeroConeT(len(p.dead) + self.none.shape[0]), clarabel.NonnegativeConeT(len(least))]
        cones += [clarabel.SecondOrderConeT(d)] * (cone.shape[0] // d)
        q = np.zeros(self.unknowns)
        q[-1] = cost
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = ACCURACY
        found = clarabel.DefaultSolver(sparse.csc_array((len(q), len(q))), q, matrix, b, cones, settings).solve()
        if "Solved" not in str(found.status):
            return None, None
        return np.array(found.x), np.array(found.z)[: len(p.dead)]


def rigid_motion(points: ContactPoints, end: SlidingState) -> SlidingState:
    """The end of a path, with a motion of rigid blocks where blocks without load approach each other in its last step."""
    rate = (points.rates @ end.motion).reshape(-1, points.dimension)
    if -rate[:, 0].min() <= CLOSING * np.abs(rate).max():
        return end
    return LeastLoad(points).with_motion(end) or end
