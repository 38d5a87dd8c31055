"""Collapse of dry joints along a load path: elastic joints, sliding without dilatancy, from self-weight to the mechanism.

Points of contact carry n = kn <-u_n> and a shear that follows the slip with kt and Coulomb's law |t| <= mu n (incremental
return along the radius). Self-weight acts first; then the live load does prescribed work and its multiplier follows. Small
displacements: the multiplier tends to a constant, at which the blocks move as a mechanism, and only the ratios of the
stiffnesses matter. Each step is solved by a semi-smooth Newton method (Qi and Sun 1993).
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from extrados.limit.contact_points import ContactPoints, SlidingState
from extrados.limit.errors import NoAnswer

#: Shear stiffness over normal stiffness of the joints; the least of their collapse loads is the design value
RATIOS = (0.1, 0.5, 1.0)
BALANCED = 1e-9  # of the total weight: forces left over after a step
ITERATIONS = 40
LEAST_SHARE = 0.02  # of a Newton step
GAINS, IDLE = 0.7, 6  # of the forces left over: iterations that gain less, and how many end the attempt
FIRST, ELASTIC_LOAD, GROWTH = 20.0, 1e-3, 1.15  # the first step, in steps of the elastic response to that multiplier
FLAT, FLAT_STEPS = 1e-7, 6  # relative change of the multiplier per step, in so many steps, where it is constant
MEETS = 1e-6  # of the fastest point: open contacts that approach faster will carry again
PROXIMAL, EASED, STIFFENED = (0.05, 0.4, 5.0)  # of the normal stiffness: elastic hold to the last iterate, and its changes
NEARLY_FREE, LOOSE = 5e-3, 1e-7  # holds below which a step without it is tried, and that count as none
HOLDS = 60
SHRUNK = 1e-3  # of the first step: no smaller step is tried
MOST_STEPS = 600
#: Linear systems of a whole path: where the deck requests it, and beside an upper bound
PATIENT, QUICK = 20000, 1500
STIFFENING = 1e-10  # of the normal stiffness, in the tangent alone: blocks without contact


@dataclass
class _State:
    """Displacements (equations), multiplier, opening and slip (points, d), forces (points, d), shortening and shares of the
    answers (k)."""

    u: np.ndarray
    gamma: float
    rate: np.ndarray
    force: np.ndarray
    moved: np.ndarray
    share: np.ndarray


class LoadPath:
    """The path of one structure under one live load at one ratio of joint stiffnesses."""

    def __init__(self, points: ContactPoints, ratio: float, effort: int = PATIENT):
        """effort: linear systems after which the path is given up."""
        self.points, self.effort = points, effort
        self.normal = points.stiffness
        held = points.stiffness.mean()
        self.shear = ratio * np.where(points.stiffness > 0.0, points.stiffness, held)
        self.least = BALANCED * points.weight
        self.solves = 0

    def follow(self) -> SlidingState:
        """The end of the path; NoAnswer where no step leads on."""
        p = self.points
        nothing = np.zeros(len(p.dead))
        state = _State(
            nothing,
            0.0,
            np.zeros((len(p.friction), p.dimension)),
            np.zeros((len(p.friction), p.dimension)),
            np.zeros(p.answers.shape[1]),
            np.zeros(p.answers.shape[1]),
        )
        bonded = self._factor(self._bonded(), 0.0, border=False)
        upright = self._held(state, bonded.solve(p.dead), 0.0, None)
        if upright is None:
            raise NoAnswer("no equilibrium with elastic joints was found under self-weight")
        state = upright
        first = step = FIRST * ELASTIC_LOAD * float(p.live @ bonded.solve(p.live))
        flat, moved = 0, nothing
        for _ in range(MOST_STEPS):
            start = state.u + moved
            found = self._held(state, start, state.gamma, step)
            if found is None:
                step, moved = 0.5 * step, 0.5 * moved
                if step < SHRUNK * first:
                    raise NoAnswer(f"the load path ended at {state.gamma:.4f} g, because no smaller step converges")
                continue
            moved = found.u - state.u
            change = abs(found.gamma - state.gamma)
            speed = found.rate - state.rate
            meets = -speed[state.rate[:, 0] > 0.0, 0].min(initial=0.0) > MEETS * np.abs(speed).max()
            constant = change <= FLAT * max(abs(found.gamma), 1e-3) and step >= first and not meets
            flat = flat + 1 if constant else 0
            state = found
            if flat >= FLAT_STEPS:
                return SlidingState(state.gamma, state.force, state.share, moved / step)
            step, moved = GROWTH * step, GROWTH * moved
        raise NoAnswer(f"the load still changes after {MOST_STEPS} steps of the load path: {state.gamma:.4f} g")

    def _held(self, old: _State, start: np.ndarray, gamma: float, work: float | None) -> _State | None:
        """The state after a step of `work` of the live load (None: gamma stays), by proximal steps where Newton's fail."""
        found = self._newton(old, start, gamma, work, 0.0, start)
        if found is not None:
            return found
        hold, about = PROXIMAL, old.u
        for _ in range(HOLDS):
            near = self._newton(old, about, gamma, work, hold, about)
            if near is None:
                hold *= STIFFENED
                if hold > 1e3:
                    return None
                continue
            about, gamma = near.u, near.gamma
            hold *= EASED
            if hold > NEARLY_FREE:
                continue
            free = self._newton(old, about, gamma, work, 0.0, about)
            if free is not None:
                return free
            if hold < LOOSE:
                return None
        return None

    def _newton(self, old: _State, u: np.ndarray, gamma: float, work: float | None, hold: float, about: np.ndarray) -> _State | None:
        """The state in equilibrium after a step, with springs `hold` to the displacements `about`; None without one."""
        if self.solves > self.effort:
            raise NoAnswer(f"the load path was stopped at {gamma:.4f} g, because more than {self.effort} linear systems had to be solved")
        p = self.points

        def left(u: np.ndarray, gamma: float) -> tuple[_State, np.ndarray, float, float]:
            state = self._forces(old, u, gamma)
            rest = p.matrix @ state.force.ravel() + p.answers @ state.share + p.dead + gamma * p.live - hold * (u - about)
            short = 0.0 if work is None else work - float(p.live @ (u - old.u))
            return state, rest, short, float(np.sqrt(rest @ rest + short * short))

        state, rest, short, misfit = left(u, gamma)
        least, since = misfit, 0
        for _ in range(ITERATIONS):
            if np.abs(rest).max() <= self.least and abs(short) <= 1e-9 * abs(work or 1.0):
                return state
            try:
                factor = self._factor(self._tangent(old, state), hold, border=work is not None)
            except RuntimeError:
                return None
            if work is None:
                du, dgamma = factor.solve(rest), 0.0
            else:
                both = factor.solve(np.append(rest, short))
                du, dgamma = both[:-1], float(both[-1])
            if not np.isfinite(du).all():
                return None
            share, best = 1.0, (1.0, left(u + du, gamma + dgamma))
            while best[1][3] >= (1.0 - 1e-4 * best[0]) * misfit and share > LEAST_SHARE:
                share *= 0.5
                trial = left(u + share * du, gamma + share * dgamma)
                if trial[3] < best[1][3]:
                    best = share, trial
            share, (state, rest, short, misfit) = best
            u, gamma = u + share * du, gamma + share * dgamma
            least, since = (misfit, 0) if misfit < GAINS * least else (least, since + 1)
            if since > IDLE:
                return None
        return None

    def _forces(self, old: _State, u: np.ndarray, gamma: float) -> _State:
        """Forces at displacements u after a step from `old`."""
        p = self.points
        rate = (p.rates @ u).reshape(old.rate.shape)
        force = np.empty_like(rate)
        force[:, 0] = self.normal * np.maximum(-rate[:, 0], 0.0)
        trial = old.force[:, 1:] - self.shear[:, None] * (rate[:, 1:] - old.rate[:, 1:])
        size = np.sqrt((trial * trial).sum(axis=1))
        most = self._most(force[:, 0])
        force[:, 1:] = trial * np.where(size > most, most / np.maximum(size, 1e-300), 1.0)[:, None]
        moved = p.answers.T @ u
        share = np.clip(old.share - (moved - old.moved), *p.bounds)
        return _State(u, gamma, rate, force, moved, share)

    def _most(self, normal: np.ndarray) -> np.ndarray:
        """The greatest shear under compressions."""
        p = self.points
        with np.errstate(invalid="ignore"):
            return np.where(normal > 0.0, p.friction * normal, 0.0) + p.grip

    def _tangent(self, old: _State, now: _State) -> tuple[np.ndarray, np.ndarray]:
        """Forces lost per opening and slip (points, d, d), and per shortening of the answers (k)."""
        p, d = self.points, self.points.dimension
        closed = now.rate[:, 0] < 0.0
        out = np.zeros((len(closed), d, d))
        out[:, 0, 0] = self.normal * closed
        trial = old.force[:, 1:] - self.shear[:, None] * (now.rate[:, 1:] - old.rate[:, 1:])
        size = np.sqrt((trial * trial).sum(axis=1))
        most = self._most(now.force[:, 0])
        slides = size > most
        way = trial / np.maximum(size, 1e-300)[:, None]
        part = self.shear * np.where(slides, most / np.maximum(size, 1e-300), 1.0)
        out[:, 1:, 1:] = part[:, None, None] * (
            np.eye(d - 1) - np.where(slides, 1.0, 0.0)[:, None, None] * way[:, :, None] * way[:, None, :]
        )
        drags = slides & closed & np.isfinite(p.friction)
        out[drags, 1:, 0] = (p.friction * self.normal)[drags, None] * way[drags]
        free = old.share - (now.moved - old.moved)
        return out, ((free >= p.bounds[0]) & (free <= p.bounds[1])).astype(float)

    def _bonded(self) -> tuple[np.ndarray, np.ndarray]:
        """The tangent of joints that neither open nor slide."""
        d = self.points.dimension
        out = np.zeros((len(self.normal), d, d))
        out[:, 0, 0] = self.normal
        out[:, 1:, 1:] = self.shear[:, None, None] * np.eye(d - 1)
        return out, np.ones(self.points.answers.shape[1])

    def _factor(self, tangent: tuple[np.ndarray, np.ndarray], hold: float, *, border: bool) -> SuperLU:
        """Factors of the stiffness of the blocks, bordered by the live load."""
        self.solves += 1
        p = self.points
        points, answers = tangent
        m, d = len(self.normal), p.dimension
        local = sparse.bsr_array((points, np.arange(m), np.arange(m + 1)), shape=(m * d, m * d))
        stiff = p.matrix @ local.tocsr() @ p.rates
        if p.answers.shape[1]:
            stiff = stiff + p.answers @ sparse.diags_array(answers) @ p.answers.T
        stiff = stiff + (hold + STIFFENING) * sparse.eye_array(len(p.dead))
        if border:
            stiff = sparse.block_array([[stiff, -p.live[:, None]], [p.live[None], None]])
        return splu(stiff.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.1)
