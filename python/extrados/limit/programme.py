"""The questions of limit analysis put to an assembly: collapse, standing, thrust, safety (thesis chapter 3)."""

from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy import sparse

from extrados.core.calls import stop_if_asked
from extrados.limit.conic import collapse_of_crushing
from extrados.limit.contact_points import ContactPoints
from extrados.limit.coulomb import CoulombProblem, CoulombState
from extrados.limit.equilibrium import hanging_stones, spanning_tree
from extrados.limit.graphic import senses, thrust_joint
from extrados.limit.interior import RESIDUAL, CollapseProblem
from extrados.limit.loads import Loads, tilt_loads
from extrados.limit.solver import BOUND, INFINITY, MADE_UP, Immovable, NoAnswer, NoEquilibrium, Programme, Solution, linear_programme
from extrados.limit.states import Mechanism, State, read_mechanism, read_state
from extrados.limit.systems import LOOPS_REDUCED, Constraints, Reduced, Sparse
from extrados.model.geometry.assembly import Assembly

__all__ = ["Immovable", "LimitAnalysis", "Mechanism", "NoAnswer", "NoEquilibrium", "State"]

# Of the total load: how far crushing may be from its law when iteration ends.
LAW = 1e-9
ROUNDS, ROUNDS_SPARSE = 300, 40
# Joints of a wall for which a programme would take long: a tenth of the precision is enough there, less for larger ones.
MANY = 600
# Of the total load times the size: less work than this proves nothing.
PROVES = 1e-7
# Joints that move less than this part of the fastest block are at rest to an interior-point method.
INNER_REST = 1e-5


# Of the total load: joints pressed by less carry nothing but rounding.
CARRIES = 1e-7
# Of a step's gain to that of the step before: more is creeping.
CREEPS = 0.25
# Of the joints' length: where the search for the most central line may end.
SETTLED = 1e-9

# Of the joints' length: room for a line through a place that rounding has found
HAIR = 1e-9

# Of the joints' length: to which the most central line of a wall, and one at which the programmes stall, is found.
LEAST_PART = 1e-3


# Bounds and mechanism agree this closely, relative to gamma, or an answer is none; in walls of so many joints, whose forces
# round at that, so closely
GAP, VERY_MANY, GAP_OF_MANY = 1e-8, 5000, 1e-7


def closed(joints: int, gamma: float) -> float:
    """How far the bounds of an answer may lie apart [g]."""
    return (GAP if joints < VERY_MANY else GAP_OF_MANY) * max(1.0, abs(gamma))


def _mixed(one: State, two: State, gamma: float, part: float) -> State | None:
    """The state at gamma between two of joints cut down to a part; None where gamma does not lie between theirs."""
    if not two.gamma <= gamma <= one.gamma:
        return None
    share = (gamma - two.gamma) / (one.gamma - two.gamma)
    normal = share * one.normal + (1.0 - share) * two.normal
    lean = share * one.normal * (one.position - 0.5) + (1.0 - share) * two.normal * (two.position - 0.5)
    position = 0.5 + part * lean / np.maximum(normal, 1e-300)
    shear = share * one.shear + (1.0 - share) * two.shear
    mobilised = share * one.mobilised + (1.0 - share) * two.mobilised
    return State(gamma, normal, shear, position, mobilised)


def _eccentric(lean: np.ndarray, normal: np.ndarray) -> float:
    """Greatest |n_q - n_p| / N over the joints that carry anything."""
    carries = normal > CARRIES
    return float((np.abs(lean[carries]) / normal[carries]).max()) if carries.any() else 0.0


class LimitAnalysis:
    """All programmes of one assembly; successive solves start from the last basis."""

    def __init__(
        self,
        assembly: Assembly,
        friction: float | np.ndarray | None = None,
        *,
        strength: float | None = None,
        associated: bool = True,
        loads: Loads | None = None,
        form: str | None = None,
        starts: int = 6,
    ):
        """`friction`: coefficient of all joints, or one each; None forbids sliding.

        strength: compressive [Pa], a rectangular stress block; associated: sliding dilates by the friction
        angle (an upper bound), else not, and the collapse load is the least that `starts` starts lead to; loads:
        gravity and the same turned to +x unless given; form: "reduced" or "sparse", by the number of loops unless given.
        """
        self.assembly = assembly
        self.friction, self.strength = friction, strength
        self.associated, self.starts = associated or friction is None, starts
        self.coulomb: dict[int, CoulombState] = {}  # states without dilatancy by the sense of the load, once found
        self.unfound: dict[int, NoAnswer] = {}  # and why none was found
        self.loads = tilt_loads(assembly) if loads is None else loads
        tree = spanning_tree(assembly)
        loops = len(assembly.a) - len(assembly.mass)
        if form is None:
            form = "reduced" if loops <= LOOPS_REDUCED else "sparse"
        self.system = (Reduced if form == "reduced" else Sparse)(assembly, self.loads, tree)
        m = len(assembly.a)
        self._joints = np.arange(m)
        self._base = self._rows(self._joints, (1.0, 0.0, 0.0)) + self._rows(self._joints, (0.0, 1.0, 0.0))
        self._cone = None
        if friction is not None:
            self._mu = np.broadcast_to(np.asarray(friction, dtype=float), m)
            self._cone = self._sliding(self._mu)
        self._crush = None if strength is None else self.loads.scale / (2.0 * strength * assembly.depth * assembly.length)
        self._cuts: Constraints | None = None
        self._programme: Programme | None = None

    @staticmethod
    def _rows(joint: np.ndarray, coefficient: tuple[float, float, float]) -> Constraints:
        k = len(joint)
        return Constraints(joint, np.tile(coefficient, (k, 1)), np.zeros(k))

    def _sliding(self, slope: np.ndarray) -> Constraints:
        """|s| <= slope (n_p + n_q)."""
        one = np.ones(len(slope))
        return Constraints(
            np.tile(self._joints, 2),
            np.concatenate([np.column_stack([slope, slope, -one]), np.column_stack([slope, slope, one])]),
            np.zeros(2 * len(slope)),
        )

    @property
    def laws(self) -> Constraints:
        """The laws of the joints but for crushing: pressure at both ends, and friction."""
        return self._base if self._cone is None else self._base + self._cone

    def _whole(self) -> Constraints:
        return self.laws if self._cuts is None else self.laws + self._cuts

    def optimise(self, cost: np.ndarray, gamma: tuple[float, float]) -> tuple[Solution, Constraints, np.ndarray]:
        """Minimise over the forces that obey all laws of the joints: solution, its rows, and the scaled corner forces.

        Whether sliding dilates is no question of forces alone: that bears on `collapse` only.
        """
        programme = self._own_programme()
        for _ in range(ROUNDS_SPARSE if isinstance(self.system, Sparse) else ROUNDS):
            solution = programme.minimise(cost, gamma)
            corners = self.system.corners(solution.x)
            cuts = self.crushing_cuts(corners, LAW)
            if cuts is None:
                return solution, programme.constraints, corners
            self._cuts = cuts if self._cuts is None else self._cuts + cuts
            programme = self._programme = Programme(self.system, self._whole())
        raise NoAnswer("the iteration for crushing of the joints did not converge")

    def crushing_cuts(self, corners: np.ndarray, law: float) -> Constraints | None:
        """Tangent planes of min(n_p, n_q) >= N^2 / (2 f L) where scaled corner forces (joints, 3) break it by more than `law` of
        the total load; None where they keep it, or nothing crushes."""
        if self._crush is None:
            return None
        normal = corners[:, 0] + corners[:, 1]
        need = self._crush * normal**2
        weak = np.flatnonzero(need - corners[:, :2].min(axis=1) > law)
        if not len(weak):
            return None
        slope, lower = 2.0 * (self._crush * normal)[weak], -need[weak]
        zero = np.zeros(len(weak))
        return Constraints(weak, np.column_stack([1.0 - slope, -slope, zero]), lower) + Constraints(
            weak, np.column_stack([-slope, 1.0 - slope, zero]), lower
        )

    def _own_programme(self) -> Programme:
        """The programme of the laws themselves, kept: other loads change its costs only."""
        if self._programme is None:
            self._programme = Programme(self.system, self._whole())
        return self._programme

    def _gamma_cost(self, value: float) -> np.ndarray:
        cost = np.zeros(self.system.unknowns)
        cost[-1] = value
        return cost

    def _state(self, solution: Solution, corners: np.ndarray) -> State:
        x = solution.x
        return read_state(float(x[self.system.unknowns - 1]), corners, self.loads.scale, x[self.system.shares])

    def collapse(self, direction: int = 1) -> tuple[State, Mechanism]:
        """Greatest gamma for the load gamma W to +x (direction 1) or -x (-1), and the mechanism.

        gamma is negative where the structure cannot stand upright and needs support from that side.
        """
        if not self.associated:
            return self._coulomb(direction)
        if self._crush is not None:
            # The programmes' tangent planes may not come to an end, but tell a load that nothing resists.
            return self._conic(direction, self._crush) or self._by_programme(direction)
        inner = self._cone is not None
        wall = isinstance(self.system, Sparse) and inner
        if wall and (found := self._interior(direction)):
            return found
        try:
            return self._by_programme(direction)
        except NoAnswer:
            found = self._interior(direction) if inner and not wall else None
            if found is None:
                raise
            return found

    def _by_programme(self, direction: int) -> tuple[State, Mechanism]:
        """Collapse by linear programmes."""
        solution, rows, corners = self.optimise(self._gamma_cost(-float(direction)), (-BOUND, BOUND))
        if abs(solution.x[-1]) > 0.99 * BOUND or solution.made_up > MADE_UP * max(1.0, abs(solution.value)):
            raise Immovable("no load of this kind causes collapse: the joints restrain the blocks on all sides")
        motion = rows.openings(np.maximum(solution.rows, 0.0), len(self.assembly.a))
        if isinstance(self.system, Reduced):
            twist, defect = self.system.velocities(motion)
        else:
            twist, defect = self.system.velocities(motion, solution.equations)
        mechanism = read_mechanism(self.assembly, self.loads, rows, np.maximum(solution.rows, 0.0), motion, twist, defect)
        return self._state(solution, corners), mechanism

    @cached_property
    def equations(self) -> Sparse:
        """The system with three equations per block."""
        if isinstance(self.system, Sparse):
            return self.system
        return Sparse(self.assembly, self.loads, self.system.tree)

    def _conic(self, direction: int, crush: np.ndarray) -> tuple[State, Mechanism] | None:
        """Collapse of joints that crush by cones; None where forces and motion do not prove each other."""
        answers = self.loads.resistance
        bounds = np.zeros((2, 0)) if answers is None else np.stack([answers.low, answers.high])
        found = collapse_of_crushing(self.equations, None if self._cone is None else self._mu, crush, bounds, direction)
        if found is None:
            return None
        read = self.read_collapse(found.gamma, found.corners, found.share, found.twist, found.motion, found.taken)
        apart = abs(found.gamma - read[1].upper_bound)
        return None if apart > closed(len(self.assembly.a), found.gamma) else read

    def _interior(self, direction: int) -> tuple[State, Mechanism] | None:
        """Collapse by the interior-point method; None where it does not settle."""
        problem = CollapseProblem(self.equations, self._mu, direction, dilates=True)
        allowed = RESIDUAL if problem.joints < MANY else 10.0 * RESIDUAL * np.sqrt(problem.joints / MANY)
        point, misfit = problem.state()
        if misfit > allowed and problem.joints >= MANY:  # a linear programme of a large wall takes ten times as long
            point, misfit = problem.state(np.random.default_rng(1))
        if misfit > allowed:
            return None
        motion = problem.motion(point.u)
        # No forces the joints bear take more work than these and what is left of the gap (weak duality).
        taken = point.gap_of_joints - float((point.corners * motion).sum())
        state, mechanism = self.read_collapse(direction * point.gamma, point.corners, point.share, point.u.reshape(-1, 3), motion, taken)
        apart = abs(state.gamma - mechanism.upper_bound)
        return None if apart > closed(len(self.assembly.a), state.gamma) else (state, mechanism)

    def _coulomb(self, direction: int) -> tuple[State, Mechanism]:
        """The least collapse load found without dilatancy, from rest on; its residuals stay in `coulomb`."""
        if direction in self.unfound:
            raise self.unfound[direction]
        if direction not in self.coulomb:
            self.coulomb[direction] = self._sought(direction)
        found = self.coulomb[direction]
        taken = -float((found.corners * found.motion).sum())
        return self.read_collapse(found.gamma, found.corners, found.share, found.twist, found.motion, taken)

    def _sought(self, direction: int) -> CoulombState:
        """That state; NoAnswer where no start leads to one, NoEquilibrium where nothing stands."""
        if self.strength is None and self.certificate() is not None:
            raise NoEquilibrium("no admissible thrust line")
        problem = CoulombProblem(self.equations, self._mu, direction, self._crush)
        # First: a stone that slides out at rest does so whatever the load and its sense, and no other state lies below.
        found = self._neutral(problem) or problem.least(self.starts, 0.0)
        if found is None:
            self._refuse_immovable(direction)
            lower, upper = ("nothing" if g is None else f"{direction * g:z.4f}" for g in self.without_dilatancy_between(direction))
            self.unfound[direction] = NoAnswer(
                "no collapse state without dilatancy was found. The collapse load lies between the value without "
                f"friction ({lower}) and the value with dilatancy ({upper}). If a block is carried only by "
                "friction between its neighbours, such a state may not exist"
            )
            raise self.unfound[direction]
        return found

    def contact_points(self, direction: int) -> ContactPoints:
        """The ends of the joints as points of contact, each with a shear along the joint; forces over the total load."""
        system, m = self.equations, len(self._joints)
        columns = 3 * np.repeat(self._joints, 4) + np.tile([0, 2, 1, 2], m)  # n_p, s, n_q, s
        length = self.assembly.length / self.assembly.length.mean()
        nothing = np.empty((2, 0))
        answers = self.loads.resistance
        return ContactPoints(
            sparse.csr_array(system.corner_matrix.tocsc()[:, columns]),
            -system.right,
            direction * (self.loads.live / system.unit).ravel(),
            np.repeat(self._mu, 2),
            np.zeros(2 * m),
            np.repeat(length, 2),
            sparse.csr_array(system.matrix.tocsc()[:, np.arange(system.shares.start, system.shares.stop)]),
            nothing if answers is None else np.stack([answers.low, answers.high]),
            1.0,
        )

    def dilating(self, mechanism: Mechanism) -> list[int]:
        """Joints that press and slide in a mechanism of associated friction: they open by the friction times the slip, so that
        the collapse load is an upper bound. Joints that open faster carry nothing, and are none of them."""
        if not self.associated or self._cone is None:
            return []
        opens, slips = np.minimum(mechanism.opening_p, mechanism.opening_q), np.abs(mechanism.slip)
        fastest = float(np.hypot(mechanism.velocity[:, 0], mechanism.velocity[:, 1]).max())
        slides = (slips > INNER_REST * fastest) & (opens <= self._mu * slips + INNER_REST * fastest)
        return np.flatnonzero(slides).tolist()

    def without_dilatancy(self) -> "LimitAnalysis":
        """The same question with sliding that does not dilate."""
        return LimitAnalysis(self.assembly, self.friction, strength=self.strength, associated=False, loads=self.loads, starts=self.starts)

    def _neutral(self, problem: CoulombProblem) -> CoulombState | None:
        """A state at rest in which a stone that friction alone holds between its neighbours slides out of them, by which the
        load does no work: the structure carries nothing that can be relied on. None where there is none."""
        if self._crush is not None:
            return None
        found = (problem.neutral(stone) for stone in hanging_stones(self.assembly))
        return next((state for state in found if state is not None), None)

    def without_dilatancy_between(self, direction: int) -> tuple[float | None, float | None]:
        """Drucker's bounds (1954) on the collapse load without dilatancy: of joints without friction, and of joints whose
        sliding dilates; None where nothing stands without friction, or no load brings down what dilates."""

        def load(friction: float | np.ndarray) -> float | None:
            stop_if_asked()
            limit = LimitAnalysis(self.assembly, friction, strength=self.strength, loads=self.loads)
            try:
                return limit.collapse(direction)[0].gamma
            except (NoEquilibrium, NoAnswer):
                return None

        return load(0.0), load(self._mu)

    def _refuse_immovable(self, direction: int) -> None:
        """Immovable where not even joints without friction let the load do work."""
        # However much soil and ties take, a greater load overcomes it.
        if self._certificate(direction * self.loads.live, np.zeros(len(self._mu)), taking=False) is None:
            raise Immovable("no load of this kind causes collapse: the joints restrain the blocks on all sides")

    def read_collapse(
        self, gamma: float, corners: np.ndarray, share: np.ndarray, twist: np.ndarray, motion: np.ndarray, taken: float
    ) -> tuple[State, Mechanism]:
        """State and mechanism of a collapse whose forces and motion were found together; taken: work of the joints."""
        nothing = Constraints(np.empty(0, dtype=int), np.empty((0, 3)), np.empty(0))
        _, defect = self.equations.velocities(motion, -twist.ravel())
        mechanism = read_mechanism(self.assembly, self.loads, nothing, np.empty(0), motion, twist, defect, INNER_REST, taken)
        return read_state(gamma, corners, self.loads.scale, share), mechanism

    def certificate(self, gamma: float = 0.0) -> np.ndarray | None:
        """A motion (blocks, 3) that proves that nothing can stand at gamma, or None where there is none.

        By it the loads do work, while no joint that presses or is held by friction could take any (Farkas' lemma):
        the openings are at least mu times the slip. Twists about the origin, lengths over the size of the assembly.
        Crushing is left out of account.
        """
        mu = None if self._cone is None else self._mu
        return self._certificate(self.loads.dead + gamma * self.loads.live, mu)

    def _certificate(self, force: np.ndarray, mu: np.ndarray | None, taking: bool = True) -> np.ndarray | None:
        """The motion of greatest work of `force`, every twist at most one, that joints take no work from.

        taking: what soil and ties that yield take of the work counts.
        """
        system = self.equations
        m, n = len(self._joints), system.equations
        turned = sparse.csr_array(system.corner_matrix.T)
        unit = self.loads.scale * np.array([1.0, 1.0, self.assembly.size])
        work = (force / unit).ravel()
        dilates = sparse.diags_array(np.zeros(m) if mu is None else mu)
        one, none = sparse.eye_array(m), sparse.csr_array((m, m))
        rows = sparse.vstack(
            [
                sparse.hstack([turned[0::3], -dilates, -dilates]),
                sparse.hstack([turned[1::3], -dilates, -dilates]),
                sparse.hstack([turned[2::3], one if mu is not None else none, -one if mu is not None else none]),
            ]
        )
        lower, upper = np.zeros(3 * m), np.concatenate([np.full(2 * m, INFINITY), np.zeros(m)])
        k, answers = self.loads.pushes, self.loads.resistance
        if answers is not None:  # what each can take of the work, whole or at its least; what never yields lets none be done
            works = sparse.csr_array(system.matrix[:, system.shares].T)
            blocks = [sparse.hstack([rows, sparse.csr_array((3 * m, k))])]
            for bound, sign in ((answers.low, -1.0), (answers.high, 1.0)):
                yields = np.isfinite(bound)
                share = sparse.diags_array(np.where(yields, bound if taking else 0.0, sign))
                blocks.append(sparse.hstack([share @ works, sparse.csr_array((k, 2 * m)), sparse.diags_array(yields.astype(float))]))
            rows = sparse.vstack(blocks)
            lower, upper = np.append(lower, np.zeros(2 * k)), np.append(upper, np.full(2 * k, INFINITY))
        bound = np.concatenate([np.ones(n), np.full(2 * m + k, INFINITY)])
        cost = np.concatenate([-work, np.zeros(2 * m), np.ones(k)])
        found = linear_programme(rows, lower, upper, cost, np.concatenate([-np.ones(n), np.zeros(2 * m + k)]), bound)
        twist = found.x[:n]
        motion = (turned @ twist).reshape(-1, 3)
        least = motion[:, :2].min(axis=1) - (0.0 if mu is None else mu) * np.abs(motion[:, 2])
        broken = max(0.0, -float(least.min()), 0.0 if mu is not None else float(np.abs(motion[:, 2]).max()))
        taken = 0.0 if answers is None or not taking else answers.taken(works @ twist)
        if float(work @ twist) - taken <= max(PROVES, 1e4 * broken):
            return None
        return twist.reshape(-1, 3)

    def stands(self, gamma: float = 0.0) -> bool:
        """True where an admissible thrust line exists, upright or at a given gamma."""
        try:
            if self._crush is not None:  # without a cost the tangent planes of crushing would be sought all around
                return self._greatest(-1) <= gamma <= self._greatest(1)
            self.optimise(np.zeros(self.system.unknowns), (gamma, gamma))
        except NoEquilibrium:
            return False
        return True

    def _greatest(self, direction: int) -> float:
        """Greatest gamma to +x (1) or -x (-1) that forces bear under crushing, however joints slide."""
        if self._crush is not None and (found := self._conic(direction, self._crush)):
            return found[0].gamma
        return -direction * self.optimise(self._gamma_cost(-float(direction)), (-BOUND, BOUND))[0].value

    def thrust(self, joints: list[int], gamma: float = 0.0) -> tuple[State, State]:
        """States of least and greatest horizontal thrust of a chain, across its `thrust_joint`, at a fixed gamma."""
        a, at = self.assembly, thrust_joint(self.assembly, self.loads, joints)
        joint, sense = joints[at], senses(a, joints)[at]
        corner_cost = np.zeros((len(a.a), 3))
        corner_cost[joint] = a.normal[joint, 0], a.normal[joint, 0], a.tangent[joint, 0]
        cost = self.system.cost(corner_cost * sense)
        found = [self.optimise(sign * cost, (gamma, gamma)) for sign in (1.0, -1.0)]
        least, greatest = (self._state(solution, corners) for solution, _, corners in found)
        return least, greatest

    def through(self, joint: int, position: float, gamma: float = 0.0) -> State:
        """The state at gamma whose line passes a joint as near to `position` (0 at p, 1 at q) as any line can, and keeps
        as far from the ends of the other joints as it may."""
        m = len(self.assembly.a)
        here = np.array([joint])
        near = self._rows(here, (-position, 1.0 - position, 0.0)) + self._rows(here, (position, position - 1.0, 0.0))
        whole = self._whole()
        rows = whole + near
        slack, cost = np.zeros(len(rows.lower)), np.zeros(self.system.unknowns + 1)
        # z >= |n_q - position N|, which is least
        slack[-2:], cost[-1] = -1.0, 1.0
        programme = Programme(self.system, rows, slack)
        corners = self.system.corners(programme.minimise(cost, (gamma, gamma)).x[:-1])
        found = corners[joint, 1] / max(corners[joint, :2].sum(), 1e-300)
        # A hair of room: the place was found to rounding.
        near = self._rows(here, (HAIR - found, 1.0 - found + HAIR, 0.0)) + self._rows(here, (found + HAIR, found - 1.0 + HAIR, 0.0))
        rows = whole + near
        slack, cost = np.zeros(len(rows.lower)), -cost
        others = np.setdiff1d(self._joints, here)
        share = np.maximum(corners[others, :2].sum(axis=1), CARRIES)
        slack[others] = slack[m + others] = share
        programme = Programme(self.system, rows, slack)
        return self._state(solution := programme.minimise(cost, (gamma, gamma)), self.system.corners(solution.x[:-1]))

    def central(self, gamma: float = 0.0, start: list[State] | None = None) -> tuple[State, float]:
        """The most central state at a given gamma, and the least part of the joints' length that holds it.

        The part is measured about the middle of each joint; its inverse is the geometric safety factor, and
        above one it says by how much the joints would have to grow. Dinkelbach's iteration on
        max |n_q - n_p| / N over the joints that carry anything, from the mean of admissible states where some
        are given; where it creeps, as in walls whose head joints come to carry nothing, by halving. Without
        crushing.
        """
        if isinstance(self.system, Sparse):
            return self._central_of_wall(gamma)
        m = len(self.assembly.a)
        cost = np.zeros(self.system.unknowns + 1)
        cost[-1] = -1.0
        # Wide of the joints a line could pull; inside them the rows below keep it pressing.
        fixed = None if start else self._rows(self._joints, (1.0, 1.0, 0.0))
        if self._cone is not None:
            fixed = self._cone if fixed is None else fixed + self._cone
        part, share = 1.0, np.ones(m)
        if start:
            normal = np.sum([s.normal for s in start], axis=0) / len(start) / self.loads.scale
            leans = [s.normal * (2.0 * s.position - 1.0) for s in start]
            lean = np.sum(leans, axis=0) / len(start) / self.loads.scale
            part, share = _eccentric(lean, normal), np.maximum(normal, CARRIES)
        programme, best, low, high, last = None, None, 0.0, np.inf, np.inf
        for _ in range(ROUNDS):
            rows = self._rows(self._joints, (part + 1.0, part - 1.0, 0.0)) + self._rows(self._joints, (part - 1.0, part + 1.0, 0.0))
            rows = rows if fixed is None else rows + fixed
            slack = np.concatenate([share, share, np.zeros(len(rows.lower) - 2 * m)])
            if programme is None:
                programme = Programme(self.system, rows, slack)
            else:
                programme.pass_rows(rows, slack)
            solution = programme.minimise(cost, (gamma, gamma))
            corners = self.system.corners(solution.x[:-1])
            normal = corners[:, 0] + corners[:, 1]
            new = _eccentric(corners[:, 1] - corners[:, 0], normal)
            if solution.x[-1] < -SETTLED:
                low = part
            # It gains ever more per step, or creeps.
            gain = part - new
            creeps, last = best is not None and gain > CREEPS * last, gain
            if new < high:
                best, high, share = self._unclipped(solution, corners), new, np.maximum(normal, CARRIES)
            if best is not None and (abs(part - new) < SETTLED or high - low < SETTLED):
                return best, high
            part = 0.5 * (low + high) if creeps else high
        # Where joints come to carry nothing the programmes do not tell nearer parts apart.
        if best is not None and high - low < LEAST_PART:
            return best, high if high > LEAST_PART else 0.0
        raise NoAnswer("the iteration for the most central thrust line did not converge")

    def _central_of_wall(self, gamma: float) -> tuple[State, float]:
        """The same of a wall, by halving: joints cut down to a part about their middles bear gamma, or do not.

        The state is the mixture, at gamma, of the two at which the wall of shorter joints collapses.
        """

        def held(part: float) -> State | None:
            a = self.assembly
            half = 0.5 * part * (a.q - a.p)
            limit = LimitAnalysis(replace(a, p=a.middle - half, q=a.middle + half), self.friction, loads=self.loads, form="sparse")
            try:
                right, left = (limit.collapse(direction)[0] for direction in (1, -1))
            except NoEquilibrium:
                return None
            return _mixed(right, left, gamma, part)

        low, high = 0.0, 1.0
        best = held(high)
        if best is None:
            raise NoEquilibrium("no admissible thrust line")
        trial = LEAST_PART
        while high - low > LEAST_PART:
            state = held(trial)
            if state is None:
                low = trial
            else:
                best, high = state, trial
            trial = 0.5 * (low + high)
        return best, high if high > LEAST_PART else 0.0

    def _unclipped(self, solution: Solution, corners: np.ndarray) -> State:
        """State whose line may leave the joints: positions below 0 or above 1; at the middle of joints that carry nothing."""
        normal, x = corners[:, 0] + corners[:, 1], solution.x
        position = np.divide(corners[:, 1], normal, out=np.full(len(normal), 0.5), where=normal > CARRIES)
        gamma, scale = float(x[self.system.unknowns - 1]), self.loads.scale
        return State(gamma, normal * scale, corners[:, 2] * scale, position, x[self.system.shares])

    def recentred(self, state: State, moving: list[int]) -> State:
        """A collapse state with the joints that do not move as far from their ends as may be.

        With one loop, or where stone crushes or slides without dilatancy, the state is left as it is.
        """
        loops = len(self.assembly.a) - len(self.assembly.mass)
        if loops < 2 or self._crush is not None or not self.associated or not moving:
            return state
        m = len(self.assembly.a)
        rows = self._whole()
        slack = np.zeros(len(rows.lower))
        still = np.setdiff1d(self._joints, moving)
        share = np.maximum(state.normal[still] / self.loads.scale, 1e-9)
        slack[still] = slack[m + still] = share
        cost = np.zeros(self.system.unknowns + 1)
        cost[-1] = -1.0
        # The capacity was found to rounding: the line must be allowed as much.
        room = 1e-10 * max(1.0, abs(state.gamma))
        solution = Programme(self.system, rows, slack).minimise(cost, (state.gamma - room, state.gamma + room))
        found = self._state(solution, self.system.corners(solution.x[:-1]))
        return replace(found, gamma=state.gamma)
