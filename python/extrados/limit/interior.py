"""Collapse of joints that press, slide and crush: an interior-point method for the whole complementarity problem.

Equilibrium of the blocks, the laws of the joints, and a motion that goes with the forces are solved for together:
ends part only where they do not press (or crush), joints slide only where |s| = mu N. Where sliding dilates by the
angle of friction this is a linear programme and its dual, and Mehrotra's method with Gondzio's corrections; where it
does not, the same Newton steps lead to a state, though to one of several. The unknowns of the joints are eliminated
joint by joint, which leaves three equations per block, as sparse as the wall. Near the end joints at rest are so much
stiffer than those that move that these equations would drown in rounding: in the linear programme, a step of the forces is
charged for its opening of the joints, and a step of the motion for its force, a little each. Both vanish with the steps
(Friedlander and Orban 2012: a primal-dual regularisation that is exact in the end).

Joints without dilatancy are no linear programme, which HiGHS and Clarabel need. Where they dilate HiGHS takes 3 to 7 times as
long on walls of 100 to 250 stones, Clarabel, without the mechanism, 0.9 to 1.5 times (`python tests/bench solvers`).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from extrados.core.calls import stop_if_asked
from extrados.limit.normal import NormalMatrix
from extrados.limit.systems import Sparse

GAP = 1e-9  # of the work of the load: where the iteration may end
RESIDUAL = 1e-8  # a hundredth of it of the total load, and of the fastest motion
WORK = 20.0  # that what is left of the forces times the fastest motion must stay below RESIDUAL
ROUNDS = 150
PATIENCE, POLISH = 25, 8  # rounds without a better state, before and after the gap is closed
FLOOR = 0.2  # of GAP
TOWARDS_EDGE = 0.9995  # of the way to the nearest bound
CORRECTIONS = 3  # of the centring, each a solve with the factor of the step
FAR, FURTHER, GAINED = 0.95, 0.3, 0.03  # steps that need none; how much longer they should be, and at least become
LEAST_FRICTION = 1e-6  # what joints without friction have
FLAT = 1e-9  # of the strength: so near to half of it the bounds of both ends are one
LEAST_STIFF = 1e-10  # of what never yields either way
SOFT, FIRM = 1e-8, 1e-9  # charged for steps: opening per force, force per motion
CHARGES = (1.0, 1e2, 1e4)  # so many times, where rounding asks for it
SHIFT = 1e-13  # where steps are free, keeps the factor alive if a block hangs by an edge
SIDES = np.array([[1.0], [-1.0]])  # of the least and the greatest share
SLIGHT = 0.25  # of the strength: joints pressed by less are taken as uncrushed by the formulas of small forces


Products = tuple[np.ndarray | float, np.ndarray | float, np.ndarray | float]


@dataclass(frozen=True)
class Residuals:
    """How far a state is from the laws; forces over the total load, motions over the fastest joint.

    equilibrium; friction, |s| - mu N; tension (or crushing), or a tie beyond its yield force; overlap; complementarity:
    opening where a joint is pressed, sliding where friction holds, a tie that grows longer below its yield force, each
    as the lesser of force and motion; work: of the load against what weight, friction and ties take, over the former.
    """

    equilibrium: float
    friction: float
    tension: float
    overlap: float
    complementarity: float
    work: float

    @property
    def worst(self) -> float:
        """The greatest of them."""
        return max(self.equilibrium, self.friction, self.tension, self.overlap, self.complementarity, self.work)


@dataclass
class Point:
    """Iterate of the interior-point method, or a step of it.

    n (joints, 2) and s: forces; v, w (joints, 2): how far the ends are from tension (or crushing) and the shear from
    +-mu N; o, slip (joints, 2): the motions that go with v and w; u: twists; gamma. share (k) of the forces that answer
    to movement, room (2, k) how far it is above its least and below its greatest, hold (2, k) the work that goes with it.
    """

    n: np.ndarray
    s: np.ndarray
    v: np.ndarray
    w: np.ndarray
    o: np.ndarray
    slip: np.ndarray
    u: np.ndarray
    gamma: float
    share: np.ndarray
    room: np.ndarray
    hold: np.ndarray

    def moved(self, step: "Point", force: float, motion: float) -> "Point":
        """The iterate after a step, lengthened by one factor for forces and one for motions."""
        return Point(
            self.n + force * step.n,
            self.s + force * step.s,
            self.v + force * step.v,
            self.w + force * step.w,
            self.o + motion * step.o,
            self.slip + motion * step.slip,
            self.u + motion * step.u,
            self.gamma + force * step.gamma,
            self.share + force * step.share,
            self.room + force * step.room,
            self.hold + motion * step.hold,
        )

    @property
    def gap(self) -> float:
        """Complementarity gap: forces times motions that should exclude each other, in all."""
        return self.gap_of_joints + float((self.room * self.hold).sum())

    @property
    def gap_of_joints(self) -> float:
        """The part of the gap that joints have."""
        return float((self.v * self.o).sum() + (self.slip * self.w).sum())

    @property
    def corners(self) -> np.ndarray:
        """Normal forces at the corners and shear (joints, 3)."""
        return np.column_stack([self.n, self.s])


class CollapseProblem:
    """Forces and motion of an assembly under the load sense * gamma at which it gives way.

    friction (joints). crush (joints), if given: the ends press n_p, n_q >= crush N^2, and crush by the flow of that
    bound. dilates: sliding opens the joint by the friction it overcomes.
    """

    def __init__(self, system: Sparse, friction: np.ndarray, sense: int, crush: np.ndarray | None = None, *, dilates: bool):
        self.system, self.friction, self.sense, self.dilates = system, friction, sense, dilates
        self.crush = np.zeros(len(friction)) if crush is None else crush
        self.crushes = crush is not None
        self.charged = dilates and not self.crushes
        self.corner = system.corner_matrix
        self.corner_t = sparse.csr_array(self.corner.T)
        self.live = sense * system.matrix[:, [-1]].toarray().ravel()
        self.normal = NormalMatrix(system)
        self.joints = len(friction)
        answers = system.loads.resistance
        self.answers = sparse.csr_array(system.matrix[:, system.shares])
        self.answers_t = sparse.csr_array(self.answers.T)
        self.bounds = np.zeros((2, 0)) if answers is None else np.stack([answers.low, answers.high])
        self.bounded = np.isfinite(self.bounds)
        self.pairs = 4 * self.joints + int(self.bounded.sum())

    def state(self, scatter: np.random.Generator | None = None) -> tuple[Point, float]:
        """The best iterate from a start that `scatter` chooses, and how far it is from a state: done below RESIDUAL."""
        friction = np.maximum(self.friction, LEAST_FRICTION)
        dilatancy = friction if self.dilates else np.zeros(self.joints)
        point = self._start(friction, scatter)
        best, least, since = point, np.inf, 0
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # an iteration that runs away is given up
            for _ in range(ROUNDS):
                stop_if_asked()
                rest = self._rest(point, friction, dilatancy)
                fastest = max(1.0, float(np.abs(point.u).max()))
                misfit = max(
                    point.gap / max(1.0, abs(point.gamma)) * RESIDUAL / GAP,
                    max(100.0, WORK * fastest) * max(float(np.abs(r).max()) for r in (rest.u, rest.v, rest.w)),
                    max(float(np.abs(r).max(initial=0.0)) for r in (rest.o, rest.s, rest.share)) / fastest,
                )
                if not np.isfinite(misfit):
                    break
                since += 1
                if misfit < least:
                    best, least, since = point, misfit, 0
                if misfit < RESIDUAL or since > (PATIENCE if point.gap > GAP else POLISH):
                    break
                found = self._stepped(point, rest, friction, dilatancy)
                if found is None:
                    break
                point = found
        return best, least

    def _start(self, friction: np.ndarray, scatter: np.random.Generator | None) -> Point:
        m = self.joints
        n, o, slip = np.full((m, 2), 3.0 / m), np.ones((m, 2)), np.ones((m, 2))
        if self.crushes:  # inside the bounds
            n = np.minimum(n, 0.1 / np.maximum(self.crush, 1e-300)[:, None])
        if scatter is not None:
            n = n * 10.0 ** scatter.uniform(-1.0, 1.0, (m, 1) if not self.crushes else (1, 1))
            o, slip = o * 10.0 ** scatter.uniform(-1.0, 1.0, (m, 2)), slip * 10.0 ** scatter.uniform(-1.0, 1.0, (m, 2))
        normal = n.sum(axis=1)
        v = np.maximum(n - (self.crush * normal**2)[:, None], 0.1 * n)
        w = np.repeat((friction * normal)[:, None], 2, axis=1)
        # In the middle of its bounds, or one whole away from the only one.
        low, high = np.where(self.bounded, self.bounds, np.where(self.bounded[::-1], self.bounds[::-1], 0.0) + 2.0 * -SIDES)
        share = 0.5 * (low + high)
        room = np.where(self.bounded, SIDES * (share - self.bounds), 1.0)
        return Point(n, np.zeros(m), v, w, o, slip, np.zeros(self.system.equations), 0.0, share, room, self.bounded.astype(float))

    def _rest(self, x: Point, friction: np.ndarray, dilatancy: np.ndarray) -> Point:
        """What is left of the equations, each under the name of the unknown it would fix."""
        normal, motion = _sums(x.n), self.motion(x.u)
        bend = 2.0 * self.crush * normal
        return Point(
            n=np.empty(0),
            u=self.system.right - self.corner @ x.corners.ravel() - self.answers @ x.share - self.live * x.gamma,
            v=x.n - (self.crush * normal**2)[:, None] - x.v,
            w=np.column_stack([friction * normal - x.s, friction * normal + x.s]) - x.w,
            o=x.o + (dilatancy * _sums(x.slip) - bend * _sums(x.o))[:, None] - motion[:, :2],
            s=x.slip[:, 1] - x.slip[:, 0] - motion[:, 2],
            slip=np.empty(0),
            gamma=1.0 - float(self.live @ x.u),
            share=self.answers_t @ x.u - (SIDES * x.hold).sum(axis=0),
            room=np.empty(0),
            hold=np.empty(0),
        )

    def _stepped(self, x: Point, rest: Point, friction: np.ndarray, dilatancy: np.ndarray) -> Point | None:
        """The next iterate, by the least charge at which the matrix has a factor; None where it has none."""
        for charge in CHARGES if self.charged else (0.0,):
            try:
                return self._step(x, rest, friction, dilatancy, SOFT * charge, FIRM * charge if charge else SHIFT)
            except RuntimeError:  # a pivot was lost in rounding, or is zero
                continue
        return None

    def _step(self, x: Point, rest: Point, friction: np.ndarray, dilatancy: np.ndarray, soft: float, shift: float) -> Point:
        """The next iterate; RuntimeError where the matrix has no factor."""
        stiff = x.slip / x.w
        both = _sums(stiff)
        share = stiff / both[:, None]
        lean, press = share[:, 0] - share[:, 1], x.o / x.v
        # What slips both ways at once, which only the iteration knows, opens the joint and stiffens it.
        between = 4.0 * stiff[:, 0] * share[:, 1]
        bend = 2.0 * self.crush * _sums(x.n)
        curve = 2.0 * self.crush * _sums(x.o)
        # Inverse of the joint's law: openings to normal forces, a 2 x 2 without cancellation; slip to shear.
        t_p, t_q, far, level = (press[:, 0] + soft, press[:, 1] + soft, 1.0 - bend, curve + dilatancy * friction * between)
        det = (1.0 - 2.0 * bend) ** 2 * t_p * t_q + level * (t_p + t_q)
        give = np.empty((self.joints, 2, 2))
        give[:, 0, 0] = (far**2 * t_q + bend**2 * t_p + level) / det
        give[:, 1, 1] = (bend**2 * t_q + far**2 * t_p + level) / det
        give[:, 0, 1] = give[:, 1, 0] = (bend * far * (t_p + t_q) - level) / det
        # Of all of it: its columns' sums, (far t_q + bend t_p, bend t_q + far t_p) / det.
        total = np.column_stack([far * t_q + bend * t_p, bend * t_q + far * t_p]) / det[:, None]
        spring = np.empty((self.joints, 3, 3))
        spring[:, :2, :2] = give
        spring[:, 2, :2] = (friction * lean)[:, None] * total
        spring[:, :2, 2] = (dilatancy * lean)[:, None] * total
        spring[:, 2, 2] = 1.0 / (both + soft) + friction * dilatancy * lean**2 * (t_p + t_q) / det
        yields = 1.0 / np.maximum((x.hold / x.room).sum(axis=0), LEAST_STIFF)
        solver = self.normal.factor(spring, yields, shift, symmetric=self.dilates, positive=self.charged)
        along = solver.solve(self.live)

        def newton(aim: float, second: Products) -> Point:
            """Step towards complementarity `aim`, with the products of the predictor taken off."""
            want_v, want_w = aim - x.v * x.o - second[0], aim - x.w * x.slip - second[1]
            want = np.where(self.bounded, aim - x.room * x.hold - second[2], 0.0)
            held = (SIDES * want / x.room).sum(axis=0) - rest.share
            opens, slips = (want_v - x.o * rest.v) / x.v, (want_w - x.slip * rest.w) / x.w
            free = np.empty((self.joints, 3))
            free[:, :2] = rest.o + opens + (dilatancy * _sums(slips) - bend * _sums(opens))[:, None]
            free[:, 2] = rest.s + slips[:, 1] - slips[:, 0]
            pushed = self.corner @ np.einsum("jkl,jl->jk", spring, free).ravel() + self.answers @ (yields * held)
            part = solver.solve(pushed - rest.u)
            dgamma = (rest.gamma - float(self.live @ part)) / float(self.live @ along)
            du = part + along * dgamma
            moved = self.motion(du)
            left = free - moved
            shear = left[:, 2] / (both + soft)
            driven = left[:, :2] + (dilatancy * lean * left[:, 2])[:, None]
            dn = np.einsum("jkl,jl->jk", give, driven)
            dv = dn - (bend * _sums(dn))[:, None] + rest.v
            do = (want_v - x.o * dv) / x.v
            more = friction * _sums(total * driven)
            # (1 - lean) / 2 is the share of the other sense: no differences of nearly equal numbers.
            dw = np.column_stack([2.0 * more * share[:, 1] - shear, 2.0 * more * share[:, 0] + shear]) + rest.w
            dslip = slips - 0.5 * (more * between)[:, None]
            dslip += np.column_stack([stiff[:, 0] * shear, -stiff[:, 1] * shear])
            # Where an end opens its force is small and its opening known: the better of two equal formulas.
            opening = (x.v < x.o) & (bend < SLIGHT)[:, None]
            known = moved[:, :2] - rest.o + (curve * _sums(dn) - dilatancy * _sums(dslip))[:, None]
            do = np.where(opening, self._unbent(known, bend), do)
            dv = np.where(opening, (want_v - x.v * do) / x.o, dv)
            dn = np.where((bend < SLIGHT)[:, None], self._unbent(dv - rest.v, bend), dn)
            dshare = yields * (held - self.answers_t @ du)
            dhold = np.where(self.bounded, (want - x.hold * SIDES * dshare) / x.room, 0.0)
            droom = np.where(self.bounded, SIDES * dshare, 0.0)
            return Point(dn, more * lean + shear, dv, dw, do, dslip, du, dgamma, dshare, droom, dhold)

        mean = x.gap / self.pairs
        guess = newton(0.0, (0.0, 0.0, 0.0))
        reached = x.moved(guess, *_reaches(x, guess))
        # Not far below what ends the iteration: the forces must not vanish before the equations are met.
        aim = max(min(1.0, max(reached.gap, 0.0) / x.gap) ** 3 * mean, FLOOR * GAP / self.pairs)
        second = _products(guess)
        step = newton(aim, second)
        step, reach = _corrected(x, step, second, aim, newton)
        force, motion = (1.0 if r >= 1.0 else TOWARDS_EDGE * r for r in reach)
        if not self.dilates:  # forces and motions bear on each other: they go together
            force = motion = min(force, motion)
        return x.moved(step, force, motion)

    @staticmethod
    def _unbent(value: np.ndarray, bend: np.ndarray) -> np.ndarray:
        """The (joints, 2) that less `bend` times their sum are `value`."""
        return value + (bend / np.where(bend < SLIGHT, 1.0 - 2.0 * bend, 1.0) * _sums(value))[:, None]

    def motion(self, twist: np.ndarray) -> np.ndarray:
        """Motion (joints, 3) of block a against b: opening at p, at q, slip."""
        return (self.corner_t @ twist).reshape(-1, 3)

    def residuals(self, gamma: float, corners: np.ndarray, share: np.ndarray, twist: np.ndarray) -> Residuals:
        """Of a state whose load is sense * gamma."""
        motion = self.motion(twist)
        fastest = max(float(np.abs(motion).max()), 1e-300)
        motion, moved = motion / fastest, self.answers_t @ twist / fastest
        # A force that answers is whole where the motion works against it, and at its least where it works with it.
        beyond = SIDES * (self.bounds - share)
        inner = np.where(SIDES * moved > 0.0, np.minimum(-beyond, np.abs(moved)), 0.0)
        normal, shear = corners[:, :2].sum(axis=1), corners[:, 2]
        room, opening = corners[:, :2] - (self.crush * normal**2)[:, None], motion[:, :2]
        slip = motion[:, 2]
        if self.dilates:
            opening = opening - (self.friction * np.abs(slip))[:, None]
        if self.crushes:
            opening = self._straightened(opening, normal)
        limit = self.friction * normal
        held = np.minimum(limit + np.sign(slip) * shear, np.abs(slip))
        forced, dead = float(gamma * (self.live @ twist)), float(self.system.right @ twist)
        taken = dead - float((corners * self.motion(twist)).sum()) - fastest * float(share @ moved)
        left = self.corner @ corners.ravel() + self.answers @ share + gamma * self.live - self.system.right
        return Residuals(
            equilibrium=float(np.abs(left).max()),
            friction=max(0.0, float((np.abs(shear) - limit).max())),
            tension=max(0.0, float(-room.min()), float(beyond.max(initial=0.0))),
            overlap=max(0.0, float(-opening.min())),
            complementarity=max(0.0, float(held.max()), float(np.minimum(room, np.abs(opening)).max()), float(inner.max(initial=0.0))),
            work=abs(forced - taken) / max(abs(forced), abs(dead), 1e-300),
        )

    def _straightened(self, opening: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Rates of the bounds n - crush N^2 >= 0 from openings: the flow is their gradient."""
        bend = 2.0 * self.crush * normal
        turn = opening[:, 0] - opening[:, 1]
        mean = opening.sum(axis=1) / np.where(np.abs(1.0 - 2.0 * bend) > FLAT, 1.0 - 2.0 * bend, np.inf)
        mean = np.maximum(mean, np.abs(turn))
        return 0.5 * np.column_stack([mean + turn, mean - turn])


def _reaches(x: Point, step: Point) -> tuple[float, float]:
    """How much of a step keeps the forces, and the motions, from going below zero; at most one."""
    force = min(1.0, _reach(x.v, step.v), _reach(x.w, step.w), _reach(x.room, step.room))
    return force, min(1.0, _reach(x.o, step.o), _reach(x.slip, step.slip), _reach(x.hold, step.hold))


def _products(x: Point) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What complementarity makes small: force times motion."""
    return x.v * x.o, x.w * x.slip, x.room * x.hold


def _reach(value: np.ndarray, change: np.ndarray) -> float:
    return float(np.where(change < 0.0, -value / change, np.inf).min(initial=np.inf))


def _sums(pairs: np.ndarray) -> np.ndarray:
    """Of pairs (joints, 2): numpy's sum over so short an axis takes many times as long."""
    return pairs[:, 0] + pairs[:, 1]


def _led_back(product: np.ndarray, aim: float) -> np.ndarray:
    """What brings products back between a tenth and ten times the aim, large ones no farther than that."""
    return np.maximum(np.clip(product, 0.1 * aim, 10.0 * aim) - product, -10.0 * aim)


def _corrected(
    x: Point, step: Point, second: Products, aim: float, newton: Callable[[float, Products], Point]
) -> tuple[Point, tuple[float, float]]:
    """The step and its reach in forces and motion, after corrections by Gondzio (1996): products that a longer step would carry far
    from the aim are led back to it."""
    reach = _reaches(x, step)
    for _ in range(CORRECTIONS):
        if min(reach) >= FAR:
            break
        tried = x.moved(step, *(min(1.0, r + FURTHER) for r in reach))
        corrected = [s - _led_back(product, aim) for s, product in zip(second, _products(tried), strict=True)]
        other = newton(aim, (corrected[0], corrected[1], corrected[2]))
        longer = _reaches(x, other)
        if sum(longer) < sum(reach) + GAINED:
            break
        step, reach, second = other, longer, (corrected[0], corrected[1], corrected[2])
    return step, reach
