"""Collapse of dry joints along a load path: elastic joints, sliding without dilatancy, from self-weight to the mechanism.

Points of contact carry n = kn <-u_n> and a shear that follows the slip with kt and Coulomb's law |t| <= mu n (incremental
return along the radius). Self-weight acts first; then the live load does prescribed work and its multiplier follows. Small
displacements: the multiplier tends to a constant, at which the blocks move as a mechanism, and only the ratios of the
stiffnesses matter. Each step is solved by a semi-smooth Newton method (Qi and Sun 1993).
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from extrados.core.calls import stop_if_asked
from extrados.limit.contact_points import ContactPoints, SlidingState
from extrados.limit.errors import NoAnswer
from extrados.limit.stiffness_factor import StiffnessFactor

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
RETRIED = 0.05  # of the hold at which a step without it failed: it is tried again below
HOLDS = 60
HALVINGS = 3  # of a step, before proximal ones are tried
SHRUNK = 1e-3  # of the first step: no smaller step is tried
MOST_STEPS = 600
#: Linear systems of a whole path: where the deck requests it, and beside an upper bound
PATIENT, QUICK = 20000, 1500
STIFFENING = 1e-10  # of the normal stiffness, in the tangent alone: blocks without contact


@dataclass
class _State:
    """Displacements (equations), multiplier, opening and slip (points, d), forces (points, d), shortening and shares of the
    answers (k); trial: shear without its limit (points, d - 1); size, most: its length and limit (points)."""

    u: np.ndarray
    gamma: float
    rate: np.ndarray
    force: np.ndarray
    moved: np.ndarray
    share: np.ndarray
    trial: np.ndarray
    size: np.ndarray
    most: np.ndarray


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
        if not points.live.any():
            raise NoAnswer("no live load acts on a block, so no load path exists")
        self.stiffness = StiffnessFactor(points)
        self.answers_t = sparse.csr_array(points.answers.T)

    def follow(self) -> SlidingState:
        """The end of the path; NoAnswer where no step leads on."""
        p = self.points
        nothing, m, k = np.zeros(len(p.dead)), len(p.friction), p.answers.shape[1]
        still = np.zeros((m, p.dimension))
        state = _State(nothing, 0.0, still, still, np.zeros(k), np.zeros(k), still[:, 1:], np.zeros(m), np.zeros(m))
        self._factor(self._bonded(), 0.0)
        start, unit = self.stiffness.solve(p.dead, p.live)
        response = float(p.live @ unit)
        upright = self._held(state, start, 0.0, None)
        if upright is None:
            raise NoAnswer("no equilibrium with elastic joints was found under self-weight")
        state = upright
        first = step = FIRST * ELASTIC_LOAD * response
        flat, moved, halvings = 0, nothing, 0
        for _ in range(MOST_STEPS):
            start = state.u + moved
            # A smaller step costs less than proximal ones and is nearer to the path.
            patient = halvings == HALVINGS or step < first
            found = self._held(state, start, state.gamma, step) if patient else self._newton(state, start, state.gamma, step, 0.0, start)
            if found is None and not patient:
                halvings, step, moved = halvings + 1, 0.5 * step, 0.5 * moved
                continue
            if found is None:
                step, moved = 0.5 * step, 0.5 * moved
                if step < SHRUNK * first:
                    raise NoAnswer(f"the load path ended at {state.gamma:.4f} g, because no smaller step converges")
                continue
            moved, halvings = found.u - state.u, 0
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
        hold, about, free_below = PROXIMAL, old.u, NEARLY_FREE
        for _ in range(HOLDS):
            near = self._newton(old, about, gamma, work, hold, about)
            if near is None:
                hold *= STIFFENED
                if hold > 1e3:
                    return None
                continue
            about, gamma = near.u, near.gamma
            hold *= EASED
            if hold > free_below and hold >= LOOSE:
                continue
            free = self._newton(old, about, gamma, work, 0.0, about)
            if free is not None:
                return free
            if hold < LOOSE:
                return None
            free_below = RETRIED * hold
        return None

    def _newton(self, old: _State, u: np.ndarray, gamma: float, work: float | None, hold: float, about: np.ndarray) -> _State | None:
        """The state in equilibrium after a step, with springs `hold` to the displacements `about`; None without one. Cancelled by Ctrl-C."""
        stop_if_asked()
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
            if not self._factor(self._tangent(old, state), hold):
                return None
            du, dgamma = (self.stiffness.solve(rest)[0], 0.0) if work is None else self.stiffness.solve_beside_load(rest, short)
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
        normal = self.normal * np.maximum(-rate[:, 0], 0.0)
        trial = old.force[:, 1:] - self.shear[:, None] * (rate[:, 1:] - old.rate[:, 1:])
        size = np.abs(trial[:, 0]) if p.dimension == 2 else np.hypot(trial[:, 0], trial[:, 1])
        with np.errstate(invalid="ignore"):  # no compression under infinite friction
            most = np.where(normal > 0.0, p.friction * normal, 0.0) + p.grip
        force[:, 0] = normal
        force[:, 1:] = trial * np.where(size > most, most / np.maximum(size, 1e-300), 1.0)[:, None]
        moved = self.answers_t @ u
        share = np.clip(old.share - (moved - old.moved), *p.bounds)
        return _State(u, gamma, rate, force, moved, share, trial, size, most)

    def _tangent(self, old: _State, now: _State) -> tuple[np.ndarray, np.ndarray]:
        """Forces lost per opening and slip (points, d, d), and per shortening of the answers (k)."""
        p, d = self.points, self.points.dimension
        closed = now.rate[:, 0] < 0.0
        out = np.zeros((len(closed), d, d))
        out[:, 0, 0] = self.normal * closed
        slides = now.size > now.most
        way = now.trial / np.maximum(now.size, 1e-300)[:, None]
        part = self.shear * np.where(slides, now.most / np.maximum(now.size, 1e-300), 1.0)
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

    def _factor(self, tangent: tuple[np.ndarray, np.ndarray], hold: float) -> bool:
        """Factors of the stiffness of the blocks; False where it is singular."""
        self.solves += 1
        return self.stiffness.factor(*tangent, hold + STIFFENING)
