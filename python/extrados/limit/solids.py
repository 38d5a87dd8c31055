"""Limit analysis of solid blocks: the push at which they become a mechanism, by second-order cones, with both bounds.

Unknown are the forces at the corners of the contact polygons, each within Coulomb's cone. Nothing is lost by that if the pressure may concentrate: a force
(n, t) of a pressure at any place within a polygon, shared to its corners in the proportion that makes their centre that
place, keeps force, moment and cone. Where the pressure of a face spreads, its torsion is
less: limit.face_law. The dual of the programme is a motion of rigid blocks whose contacts open at least mu
times as fast as they slide (associated friction); its virtual work is the bound from above.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import clarabel
import highspy
import numpy as np
from scipy import sparse

from extrados.core.threads import Worker
from extrados.limit.certificate import Certificate, certify_solids
from extrados.limit.contact_points import ContactPoints, SlidingState
from extrados.limit.errors import Immovable, NoAnswer, NoEquilibrium
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.strands import Strand
from extrados.schema.constants import GRAVITY

Found = TypeVar("Found")
LOOK = 0.1  # s between looks whether somebody wants to stop
ACCURACY = 1e-10  # of forces, powers and the gap between the programmes, over the scale of the weights
LOOSE = 1e-6  # a solution that is no better than this is none
PROOF = 1e-7  # of the fastest contact: what overlap a motion that proves something may have
METHODS = ("qdldl", "faer")  # factorisations of the conic solver; the second pivots otherwise where the first gives up
POWERLESS = 1e-7  # of the power of all weights falling: less is rounding


@dataclass(frozen=True)
class Programme:
    """What one push of a structure gave.

    gamma: the multiplier borne [g]; upper: the bound of the motion's virtual work [g]. force (nv, 3): compression (tension of mortar
    negative) and both shears at the corners, key_force (nk, 2): shears of the dowels [N]; tension (nt): of the strands [N]; motion (nb, 6): velocity of the centroids and spin,
    with a power of the push of one. equilibrium: greatest force or moment (over the size) left over at a block, over the
    total weight; cone: greatest excess of shear over friction or of tension, over the same; overlap: greatest rate of
    overlap (or of sliding without the dilatancy that goes with it) over the fastest rate of a contact.
    """

    gamma: float
    upper: float
    force: np.ndarray
    key_force: np.ndarray
    tension: np.ndarray
    motion: np.ndarray
    equilibrium: float
    cone: float
    overlap: float

    @property
    def gap(self) -> float:
        """Difference between both bounds [g]."""
        return abs(self.upper - self.gamma)


@dataclass(frozen=True)
class Falls:
    """Proof that no forces hold the blocks at rest: a motion (nb, 6) that no contact hinders and in which the weights have
    `power`, over that of all of them falling as fast as the fastest. overlap: what it violates, over the fastest contact."""

    motion: np.ndarray
    power: float
    overlap: float


@dataclass(frozen=True)
class Stated:
    """A programme: least cost x with right - matrix x within the cones. lines: column of the matrix of forces that each row after the
    first is the rate of, -1 for a bound (of a sliding corner the opening is over mu). sized: of each unknown that bounds the
    lengthening of a strand that is sized its number, else -1."""

    matrix: sparse.csr_array
    cost: np.ndarray
    right: np.ndarray
    cones: list[Any]
    lines: np.ndarray
    sized: np.ndarray


def solve_conic(matrix: sparse.csr_array, cost: np.ndarray, right: np.ndarray, cones: list[Any], method: str) -> "clarabel.DefaultSolution":
    """The solution of a conic programme, see Stated."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = 200
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = ACCURACY
    settings.tol_infeas_abs = settings.tol_infeas_rel = 1e-9
    settings.max_threads = 1
    settings.direct_solve_method = method
    nothing = sparse.csc_array((len(cost), len(cost)))
    solver = clarabel.DefaultSolver(nothing, cost, matrix.tocsc(), right, cones, settings)
    return _waited(solver.solve)[0]


class SolidLimit:
    """The programmes of solid blocks with a coefficient of friction: one for all contacts, one each, or None, which
    excludes sliding. strands: ties, chains and hoops. resting (nb, 6): loads that do not sway, forces [N] and moments about
    the centroids [N m]. tension (nj): of the mortar of the contacts [Pa]; compressions count from there (limit.mortar)."""

    def __init__(
        self,
        assembly: SolidAssembly,
        friction: float | np.ndarray | None,
        strands: Sequence[Strand] = (),
        resting: np.ndarray | None = None,
        tension: np.ndarray | None = None,
    ):
        self.assembly = assembly
        self.friction = friction
        self.strands = tuple(strands)
        self.tension = np.zeros(len(assembly.a)) if tension is None else tension
        self.resting = np.zeros((len(assembly.mass), 6)) if resting is None else resting
        joints = len(assembly.a)
        mu = np.full(joints, np.inf if friction is None else friction, dtype=float)
        self.mu = mu[assembly.corner_joint]
        self.weight = assembly.mass * GRAVITY
        #: Of the weight of a stone rather than of all: forces of the order of one
        self.scale = float(self.weight.sum() + assembly.fill[:, 1].sum() * GRAVITY) / np.sqrt(len(self.weight))

    @cached_property
    def matrix(self) -> sparse.csc_array:
        """Forces and moments about the centroids, over the size (6 nb), of unit forces at corners: columns n, t1, t2 of each
        corner, then both shears of each key."""
        one = self.assembly
        t1, t2 = one.tangents
        j = one.corner_joint
        frames = np.stack([one.normal, t1, t2], axis=1)
        places, vectors, joint = [one.corner] * 3, [frames[j, k] for k in range(3)], [j] * 3
        columns = [3 * np.arange(len(j)) + k for k in range(3)]
        if one.keys is not None:
            count = len(one.keys.joint)
            for k in (1, 2):
                places.append(one.keys.point)
                vectors.append(frames[one.keys.joint, k])
                joint.append(one.keys.joint)
                columns.append(3 * len(j) + 2 * np.arange(count) + k - 1)
        point, vector = np.concatenate(places), np.concatenate(vectors)
        contact, column = np.concatenate(joint), np.concatenate(columns)
        rows, cols, values = [], [], []
        for block, sense in ((one.a[contact], 1.0), (one.b[contact], -1.0)):
            on = np.flatnonzero(block != GROUND)
            arm = (point[on] - one.centroid[block[on]]) / one.size
            wrench = sense * np.concatenate([vector[on], np.cross(arm, vector[on])], axis=1)
            rows.append((6 * block[on][:, None] + np.arange(6)).ravel())
            cols.append(np.repeat(column[on], 6))
            values.append(wrench.ravel())
        shape = (6 * len(one.mass), 3 * len(j) + (0 if one.keys is None else 2 * len(one.keys.joint)))
        where = (np.concatenate(rows), np.concatenate(cols))
        return sparse.csc_array((np.concatenate(values), where), shape=shape)

    @cached_property
    def pulls(self) -> sparse.csc_array:
        """Forces and moments about the centroids, over the size (6 nb, nt), of unit tensions of the strands."""
        one = self.assembly
        found = np.zeros((len(one.mass), 6, len(self.strands)))
        for k, strand in enumerate(self.strands):
            block, place, force = strand.forces()
            arm = (place - one.centroid[block]) / one.size
            np.add.at(found[:, :, k], block, np.concatenate([force, np.cross(arm, force)], axis=1))
        return sparse.csc_array(found.reshape(6 * len(one.mass), len(self.strands)))

    @property
    def tension_bounds(self) -> np.ndarray:
        """Least and greatest tension of the strands (2, nt), over the scale."""
        return np.array([[s.low for s in self.strands], [s.high for s in self.strands]]).reshape(2, -1) / self.scale

    def loads(self, way: np.ndarray) -> np.ndarray:
        """Forces and moments (6 nb), over the scale, of the weights turned into the direction `way` (3)."""
        one = self.assembly
        found = np.zeros((len(one.mass), 6))
        found[:, :3] = self.weight[:, None] * way
        for block, mass, *place in one.fill.tolist():
            k = int(block)
            force = mass * GRAVITY * way
            found[k, :3] += force
            found[k, 3:] += np.cross((np.array(place) - one.centroid[k]) / one.size, force)
        return found.ravel() / self.scale

    def push(self, direction: float) -> Programme | Falls:
        """The greatest multiplier gamma of all weights, pushed along a direction [deg from +x to +y], or the proof that none is
        borne. Immovable where no push brings it down, NoAnswer where the solver gives up."""
        try:
            return self.most(*self.ways(direction))
        except NoAnswer:
            if (falls := self.falls()) is None:
                raise
            return falls

    def most(self, dead: np.ndarray, live: np.ndarray) -> Programme | Falls:
        """The greatest multiplier gamma of loads `live` that the blocks carry beside `dead`, both over the scale (6 nb), or the proof
        that none is. Immovable where no multiplier causes collapse, NoAnswer where the solver gives up."""
        complaint = NoAnswer("")
        for method in METHODS:
            try:
                return self._pushed(dead, live, method)
            except NoAnswer as error:
                complaint = error
        raise complaint

    def pushes(
        self, directions: Sequence[float], threads: int = 1, told: Callable[[int], None] = lambda done: None
    ) -> "list[Programme | Falls | None]":
        """What each of many directions [deg] gives, None where no push brings it down; `threads` at a time, which changes no
        bit of it. told(done) is called now and then."""
        _ = self.matrix  # made once, before threads ask for it
        found: dict[int, Programme | Falls | None] = {}
        left = iter(enumerate(directions))
        taking = threading.Lock()

        def work() -> None:
            while True:
                with taking:
                    k, direction = next(left, (-1, 0.0))
                if k < 0:
                    return
                try:
                    found[k] = self.push(direction)
                except Immovable:
                    found[k] = None

        _waited(*[work] * min(threads, len(directions)), told=lambda: told(len(found)))
        return [found[k] for k in range(len(directions))]

    def least_force(self, direction: float, gamma: float, sized: Sequence[int]) -> float:
        """Least yield force [N], common to the strands of the numbers `sized`, with which the blocks carry all weights pushed
        by gamma [g] along a direction [deg]; infinite where no force suffices. NoAnswer where the solver gives up. The strands that
        are sized have no limits of their own.

        The programme of the motion: most power of the loads, less that of dowels and other strands, where the strands that
        are sized lengthen by no more than one together. It is the dual of the least force.
        """
        dead, live = self.ways(direction)
        load = dead + gamma * live
        status = ""
        for method in METHODS:
            solution, _ = self._solved(load, None, method, sized)
            status, motion = str(solution.status), np.array(solution.x)[: len(dead)]
            if "DualInfeasible" in status and np.isfinite(motion).all():
                try:
                    self._proven(motion, load, sized)
                except NoAnswer:
                    continue
                return np.inf
            force, bound = float(solution.z[-1]), -float(solution.obj_val)
            if np.isfinite(force) and abs(force - bound) <= LOOSE * max(1.0, bound):
                return max(0.0, force, bound) * self.scale
        most = self.push(direction)  # of strands that never yield: proves near the greatest capacity that none suffices
        if isinstance(most, Falls) or most.gamma < gamma:
            return np.inf
        raise NoAnswer(f"the conic solver found no least force: {status}")

    def least_forces(self, directions: Sequence[float], gamma: float, ties: Sequence[Sequence[int]], most: np.ndarray) -> np.ndarray:
        """Yield forces [N] (ties) of least sum with which the blocks carry all weights pushed by gamma [g] along each direction [deg],
        in one programme. ties: numbers of the strands of each, which have no limits of their own; most: greatest forces [N].

        The dual, as in least_force: the motions of all directions, where the lengthening of a tie in all of them together is at most
        one, or beyond it costs the greatest force. NoEquilibrium where no forces suffice, NoAnswer where the solver gives up.
        """
        sized = [k for group in ties for k in group]
        cases = []
        for direction in directions:
            dead, live = self.ways(direction)
            cases.append(self.stated(dead + gamma * live, None, sized))
        among = [np.concatenate([np.isin(one.sized, group).astype(float) for one in cases]) for group in ties]
        limited = np.flatnonzero(np.isfinite(most))
        beyond = sparse.csr_array((-np.ones(len(limited)), (limited, np.arange(len(limited)))), shape=(len(ties), len(limited)))
        moves = sparse.block_diag([one.matrix for one in cases], format="csr")
        none = sparse.csr_array((moves.shape[0], len(limited)))
        slack = sparse.hstack([sparse.csr_array((len(limited), moves.shape[1])), -sparse.eye_array(len(limited))])
        matrix = sparse.vstack([sparse.hstack([moves, none]), slack, sparse.hstack([sparse.csr_array(np.array(among)), beyond])])
        cost = np.concatenate([*(one.cost for one in cases), most[limited] / self.scale])
        right = np.concatenate([*(one.right for one in cases), np.zeros(len(limited)), np.ones(len(ties))])
        cones = [cone for one in cases for cone in one.cones] + [clarabel.NonnegativeConeT(len(limited) + len(ties))]
        status = ""
        for method in METHODS:
            solution = solve_conic(matrix, cost, right, cones, method)
            status, forces = str(solution.status), np.array(solution.z)[len(right) - len(ties) :]
            total, bound = float(forces.sum()), -float(solution.obj_val)
            if np.isfinite(total) and abs(total - bound) <= LOOSE * max(1.0, bound):
                return np.maximum(forces, 0.0) * self.scale
            if "DualInfeasible" in status:
                raise NoEquilibrium("no forces of these ties are sufficient for equilibrium")
        raise NoAnswer(f"the conic solver found no least forces: {status}")

    def contact_points(self, direction: float) -> ContactPoints:
        """Corners of the contacts and dowels as points of contact under a push along a direction [deg]."""
        dead, live = self.ways(direction)
        corners, keys = len(self.mu), self.assembly.keys
        count = np.bincount(self.assembly.corner_joint)[self.assembly.corner_joint]
        area = self.assembly.area[self.assembly.corner_joint] / count
        matrix, dowels = self.matrix, 0 if keys is None else len(keys.joint)
        if dowels:  # a compression of dowels is none
            own = matrix[:, 3 * corners :]
            nothing = sparse.csc_array((matrix.shape[0], dowels))
            order = np.column_stack([2 * dowels + np.arange(dowels), np.arange(0, 2 * dowels, 2), np.arange(1, 2 * dowels, 2)])
            own = sparse.hstack([own, nothing]).tocsc()[:, order.ravel()]
            matrix = sparse.hstack([matrix[:, : 3 * corners], own])
        return ContactPoints(
            sparse.csr_array(matrix),
            dead,
            live,
            np.append(self.mu, np.zeros(dowels)),
            np.append(np.zeros(corners), [] if keys is None else keys.strength / self.scale),
            np.append(area / area.mean(), np.zeros(dowels)),
            sparse.csr_array(self.pulls),
            self.tension_bounds,
            float(self.weight.sum() + self.assembly.fill[:, 1].sum() * GRAVITY) / self.scale,
        )

    def certify(self, direction: float, state: SlidingState) -> tuple[Programme, Certificate]:
        """A state without dilatancy in N, and its certificate, which the geometry alone gives."""
        corners, size = len(self.mu), self.assembly.size
        force, keyed = state.force[:corners] * self.scale, state.force[corners:, 1:] * self.scale
        motion = self._rates(state.motion)
        unit = self.scale * np.array([1.0, 1.0, 1.0, size, size, size])
        dead, live = (load.reshape(-1, 6) * unit for load in self.ways(direction))
        tension = state.share * self.scale
        proof = certify_solids(self.assembly, self.mu, dead, live, state.gamma, force, keyed, motion, self.strands, tension)
        upper = state.gamma + proof.zero_gap
        return Programme(
            state.gamma, upper, force, keyed, tension, motion, proof.equilibrium, max(proof.friction, proof.tension), proof.closing
        ), proof

    def falls(self) -> Falls | None:
        """The proof that it cannot stand without a push; None where no motion proves that."""
        dead = self.at_rest
        for method in METHODS:
            solution, _ = self._solved(dead, None, method)
            motion = np.array(solution.x)[: len(dead)]
            if np.isfinite(motion).all():
                try:
                    return self._proven(motion, dead)
                except NoAnswer:
                    continue
        return None

    def ways(self, direction: float) -> tuple[np.ndarray, np.ndarray]:
        """The loads of the weights at rest and turned along a direction [deg]."""
        turn = np.radians(direction)
        return self.at_rest, self.loads(np.array([np.cos(turn), np.sin(turn), 0.0]))

    @property
    def at_rest(self) -> np.ndarray:
        """Forces and moments (6 nb), over the scale, of the weights, the loads that do not sway and the tension of mortar."""
        unit = self.scale * np.array([1.0, 1.0, 1.0, *[self.assembly.size] * 3])
        found: np.ndarray = self.loads(np.array([0.0, 0.0, -1.0])) + (self.resting / unit).ravel()
        if self.tension.any():
            found -= self.matrix[:, 0 : 3 * len(self.mu) : 3] @ (self._held() / self.scale)
        return found

    def _held(self) -> np.ndarray:
        """Tension of the mortar at the corners (nv) [N], from which their compressions count."""
        held: np.ndarray = (self.tension * self.assembly.area)[self.assembly.corner_joint] * self.assembly.share
        return held

    def _pushed(self, dead: np.ndarray, live: np.ndarray, method: str) -> Programme | Falls:
        solution, lines = self._solved(dead, live, method)
        status = str(solution.status)
        x = np.array(solution.x)[: len(dead)]
        if "DualInfeasible" in status:
            return self._proven(x, dead)
        if "PrimalInfeasible" in status:
            raise Immovable("no horizontal load causes collapse: the contacts restrain the blocks on all sides")
        power = float(live @ x)
        if not np.isfinite(x).all() or power <= 0.0:
            raise NoAnswer(f"the conic solver found no solution: {status}")
        z = np.array(solution.z)
        gamma = -float(z[0])
        found = self._measured(dead, live, x / power, gamma, *self.forces_of(z, lines))
        if max(found.equilibrium, found.cone, found.overlap) > LOOSE or found.gap > LOOSE * max(1.0, abs(gamma)):
            raise NoAnswer(
                f"the conic solver stopped without a solution ({status}): the unbalanced forces are {found.equilibrium:.1e} of "
                f"the weight, and the bounds differ by {found.gap:.1e} g"
            )
        return found

    def _measured(
        self, dead: np.ndarray, live: np.ndarray, motion: np.ndarray, gamma: float, forces: np.ndarray, tension: np.ndarray
    ) -> Programme:
        """A solution with its bounds and what it violates: a motion with a power of the push of one, forces and tensions of strands
        over the scale."""
        corners = len(self.mu)
        force, keys = forces[: 3 * corners].reshape(-1, 3), forces[3 * corners :].reshape(-1, 2)
        rest = self.matrix @ forces + self.pulls @ tension + gamma * live + dead
        overlap, spent = self._hindered(motion)
        # the scale is a stone's weight times the root of their number: over the weight of all it is one over that root
        part = 1.0 / np.sqrt(len(self.weight))
        stressed = force * self.scale
        stressed[:, 0] -= self._held()
        return Programme(
            gamma,
            float(-dead @ motion) + spent,
            stressed,
            keys * self.scale,
            tension * self.scale,
            self._rates(motion),
            float(np.abs(rest).max()) * part,
            self.excess(forces, tension) * part,
            overlap,
        )

    def _solved(
        self, dead: np.ndarray, live: np.ndarray | None, method: str, sized: Sequence[int] = ()
    ) -> "tuple[clarabel.DefaultSolution, np.ndarray]":
        """The programme of the motion, solved, and the column of each of its rows, see stated. The lengthening of the strands that
        are `sized` is together bounded by one, by a row at the very end whose multiplier is their force."""
        one = self.stated(dead, live, sized)
        if (one.sized < 0).all():
            return solve_conic(one.matrix, one.cost, one.right, one.cones, method), one.lines
        matrix = sparse.vstack([one.matrix, sparse.csr_array((one.sized >= 0).astype(float)[None])])
        cones = [*one.cones, clarabel.NonnegativeConeT(1)]
        return solve_conic(matrix, one.cost, np.append(one.right, 1.0), cones, method), np.append(one.lines, -1)

    def stated(self, dead: np.ndarray, live: np.ndarray | None, sized: Sequence[int] = (), counted: np.ndarray | None = None) -> Stated:
        """The programme of the motion: least power of the weights lifted, less what dowels take, with a power of the push of
        one and contacts that open mu times as fast as they slide. Its multipliers are the forces.

        Without a push the motion is bounded instead, each rate by one: then it is the one by which the weights fall most.
        It has a sixth of the unknowns of the programme of the forces, whose dual it is. The last rows are the limits of the
        strands, see _limits. With strands that are `sized` nothing bounds the motion: a row on their lengthening has to.
        counted: a value of each unit force (columns of the matrix), added to its rate: the multipliers are then the forces of
        least total value in equilibrium with `dead`, which is minus the least cost.
        """
        corners, rates = len(self.mu), self.matrix.T.tocsr()
        slides = np.flatnonzero((self.mu > 0.0) & np.isfinite(self.mu))
        stuck = np.flatnonzero(~np.isfinite(self.mu))
        smooth = np.flatnonzero(self.mu == 0.0)
        strength = np.empty(0) if self.assembly.keys is None else self.assembly.keys.strength / self.scale
        whole, weak = np.flatnonzero(~np.isfinite(strength)), np.flatnonzero(np.isfinite(strength))
        zero = np.concatenate([3 * stuck + 1, 3 * stuck + 2, 3 * corners + 2 * whole, 3 * corners + 2 * whole + 1])
        opening = np.concatenate([3 * stuck, 3 * smooth])
        sliding = (3 * slides[:, None] + np.arange(3)).ravel()
        over = np.ones((len(slides), 3))
        over[:, 0] = 1.0 / self.mu[slides]
        lines = np.concatenate([zero, opening, sliding])
        factor = np.concatenate([np.ones(len(zero) + len(opening)), over.ravel()])
        push = np.zeros_like(dead) if live is None else live
        rows = [sparse.csr_array(push[None]), -(sparse.diags_array(factor) @ rates[lines])]
        matrix = sparse.vstack(rows)
        cones = [clarabel.ZeroConeT(1 + len(zero)), clarabel.NonnegativeConeT(len(opening))]
        cones += [clarabel.SecondOrderConeT(3)] * len(slides)
        cost = -dead
        if len(weak):  # the rate of each dowel that may give way is bounded by an unknown that costs its strength
            own = np.column_stack([3 * corners + 2 * weak, 3 * corners + 2 * weak + 1])
            bound = sparse.csr_array(
                (-np.ones(len(weak)), (3 * np.arange(len(weak)), np.arange(len(weak)))), shape=(3 * len(weak), len(weak))
            )
            rate = sparse.csr_array(
                (np.ones(2 * len(weak)), ((3 * np.arange(len(weak))[:, None] + [1, 2]).ravel(), np.arange(2 * len(weak)))),
                shape=(3 * len(weak), 2 * len(weak)),
            )
            below = sparse.hstack([-(rate @ rates[own.ravel()]), bound])
            matrix = sparse.vstack([sparse.hstack([matrix, sparse.csr_array((matrix.shape[0], len(weak)))]), below])
            cones += [clarabel.SecondOrderConeT(3)] * len(weak)
            cost = np.concatenate([cost, strength[weak]])
            lines = np.concatenate([lines, np.column_stack([np.full(len(weak), -1), own]).ravel()])
            factor = np.concatenate([factor, np.ones(3 * len(weak))])
        right = np.zeros(matrix.shape[0])
        if counted is not None:
            on = np.flatnonzero(lines >= 0)
            right[1 + on] = factor[on] * counted[lines[on]]
        if live is not None:
            right[0] = 1.0
        elif not len(sized) and counted is None:
            own = sparse.eye_array(len(dead), len(cost))
            matrix = sparse.vstack([matrix, own, -own])
            right = np.concatenate([right, np.ones(2 * len(dead))])
            cones.append(clarabel.NonnegativeConeT(2 * len(dead)))
            lines = np.concatenate([lines, np.full(2 * len(dead), -1)])
        strand, sense, most = self._limits
        number = np.full(len(cost), -1)
        if len(strand):  # what each lengthens beyond an unknown that costs its strength is nothing
            free = np.isin(strand, sized)
            yields = np.flatnonzero(np.isfinite(most) | free)
            bound = sparse.csr_array((np.ones(len(yields)), (yields, np.arange(len(yields)))), shape=(len(strand), len(yields)))
            slack = sparse.hstack([sparse.csr_array((len(yields), len(cost))), -sparse.eye_array(len(yields))])
            rate = sparse.hstack(
                [sparse.diags_array(sense) @ self.pulls.T.tocsr()[strand], sparse.csr_array((len(strand), len(cost) - len(dead)))]
            )
            matrix = sparse.hstack([matrix, sparse.csr_array((matrix.shape[0], len(yields)))])
            matrix = sparse.vstack([matrix, slack, sparse.hstack([-rate, -bound])])
            cones.append(clarabel.NonnegativeConeT(len(yields) + len(strand)))
            number = np.concatenate([np.full(len(cost), -1), np.where(free[yields], strand[yields], -1)])
            cost = np.concatenate([cost, np.where(free, 0.0, most)[yields]])
            right = np.concatenate([right, np.zeros(len(yields) + len(strand))])
            lines = np.concatenate([lines, np.full(len(yields) + len(strand), -1)])
        return Stated(matrix, cost, right, cones, lines, number)

    @cached_property
    def _limits(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Strand, sense (1 tension, -1 compression) and greatest force over the scale of each way in which a strand acts."""
        low, high = self.tension_bounds
        pulled, pressed = np.flatnonzero(high > 0.0), np.flatnonzero(low < 0.0)
        sense = np.concatenate([np.ones(len(pulled)), -np.ones(len(pressed))])
        return np.concatenate([pulled, pressed]), sense, np.concatenate([high[pulled], -low[pressed]])

    def _tensions(self, forces: np.ndarray) -> np.ndarray:
        """Tensions of the strands, over the scale, of the forces of all ways in which they act."""
        strand, sense, _ = self._limits
        return np.bincount(strand, sense * forces, len(self.strands))

    def _rates(self, motion: np.ndarray) -> np.ndarray:
        """Velocities and spins (nb, 6) of a motion of the programme, whose moments are over the size."""
        rates = motion.reshape(-1, 6).copy()
        rates[:, 3:] /= self.assembly.size
        return rates

    def _hindered(self, motion: np.ndarray, rigid: Sequence[int] = ()) -> tuple[float, float]:
        """By how much a motion violates the contacts and strands, over the fastest rate of one, and the power that dowels and
        strands take; strands of the numbers `rigid` never yield."""
        rate = self.matrix.T @ motion
        corners = len(self.mu)
        at = rate[: 3 * corners].reshape(-1, 3)
        keyed = np.hypot(*rate[3 * corners :].reshape(-1, 2).T)
        slip = np.hypot(at[:, 1], at[:, 2])
        fastest = max(float(np.abs(at).max(initial=0.0)), float(np.abs(motion).max()))
        wrong, spent = self._denied(at, slip)
        if self.assembly.keys is not None:
            strong = ~np.isfinite(self.assembly.keys.strength)
            wrong = max(wrong, float(keyed[strong].max(initial=0.0)))
            spent += float((self.assembly.keys.strength[~strong] / self.scale * keyed[~strong]).sum())
        strand, sense, most = self._limits
        if len(strand):
            longer = np.maximum(-sense * (self.pulls.T @ motion)[strand], 0.0)
            yields = np.isfinite(most) & ~np.isin(strand, rigid)
            wrong = max(wrong, float(longer[~yields].max(initial=0.0)))
            spent += float(most[yields] @ longer[yields])
        return wrong / fastest, spent

    def _denied(self, at: np.ndarray, slip: np.ndarray) -> tuple[float, float]:
        """Greatest rate (nv, 3) of a corner that its contact does not allow, and the power over the scale that contacts take of them."""
        return denied(at, slip, self.mu), 0.0

    def forces_of(self, multipliers: np.ndarray, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces by the columns of the matrix and tensions of the strands, over the scale, of the multipliers of a programme."""
        forces = np.zeros(self.matrix.shape[1])
        forces[lines[lines >= 0]] = multipliers[1 : len(lines) + 1][lines >= 0]
        slides = np.flatnonzero((self.mu > 0.0) & np.isfinite(self.mu))
        forces[3 * slides] /= self.mu[slides]
        return forces, self._tensions(multipliers[len(multipliers) - len(self._limits[0]) :])

    def excess(self, forces: np.ndarray, tension: np.ndarray) -> float:
        """Greatest excess of shear over friction, of tension, or of a dowel or strand over its strength, over the scale."""
        corners = len(self.mu)
        force, keys = forces[: 3 * corners].reshape(-1, 3), forces[3 * corners :].reshape(-1, 2)
        shear = np.hypot(force[:, 1], force[:, 2])
        with np.errstate(invalid="ignore"):
            most = np.where(np.isfinite(self.mu), self.mu * force[:, 0], np.inf)
        found = max(float((shear - most).max(initial=0.0)), float(-force[:, 0].min(initial=0.0)))
        if self.assembly.keys is not None:
            found = max(found, float((np.hypot(*keys.T) - self.assembly.keys.strength / self.scale).max(initial=0.0)))
        low, high = self.tension_bounds
        return max(found, float(np.maximum(low - tension, tension - high).max(initial=0.0)))

    def _proven(self, motion: np.ndarray, dead: np.ndarray, rigid: Sequence[int] = ()) -> Falls:
        """A motion held to virtual work; NoAnswer where it proves nothing. rigid: strands that never yield."""
        falling = float(np.abs(dead).sum()) * max(float(np.abs(motion).max()), 1e-300)
        overlap, spent = self._hindered(motion, rigid)
        power = (float(dead @ motion) - spent) / falling
        if power < POWERLESS or overlap > PROOF:
            raise NoAnswer(
                "whether the blocks stand is not decided: neither equilibrium forces nor a collapse mechanism "
                f"were found (power {power:.1e}, overlap {overlap:.1e})"
            )
        return Falls(self._rates(motion), power, overlap)

    def pyramids(self, direction: float, sides: int) -> tuple[float, float]:
        """Bounds of the multiplier from below and above [g]: Coulomb's cones as pyramids of so many sides, within and around
        them, by HiGHS. A check by another method and another solver."""
        dead, live = self.ways(direction)
        inner = self._pyramid(dead, live, sides, 1.0)
        return inner, self._pyramid(dead, live, sides, 1.0 / np.cos(np.pi / sides))

    def _pyramid(self, dead: np.ndarray, live: np.ndarray, sides: int, wider: float) -> float:
        """Most gamma with forces that are sums of the edges of a pyramid, whose friction is `wider` than the cone's."""
        corners = len(self.mu)
        normal, first, second = (self.matrix[:, k : 3 * corners : 3] for k in range(3))
        slides = np.flatnonzero(np.isfinite(self.mu))
        rigid = np.flatnonzero(~np.isfinite(self.mu))
        columns, low, high = [], [], []
        angles = 2.0 * np.pi * np.arange(sides) / sides
        for angle in angles:
            friction = sparse.diags_array(wider * self.mu[slides])
            edge = np.cos(angle) * first[:, slides] + np.sin(angle) * second[:, slides]
            columns.append(normal[:, slides] + edge @ friction)
            low.append(np.zeros(len(slides)))
            high.append(np.full(len(slides), np.inf))
        columns += [normal[:, rigid], first[:, rigid], second[:, rigid]]
        low += [np.zeros(len(rigid)), *[np.full(len(rigid), -np.inf)] * 2]
        high += [np.full(len(rigid), np.inf)] * 3
        weak = np.empty(0)
        first_weak = sum(part.shape[1] for part in columns)
        if self.assembly.keys is not None:
            strength = self.assembly.keys.strength / self.scale
            keyed = self.matrix[:, 3 * corners :]
            give = np.flatnonzero(np.isfinite(strength))
            weak = wider * strength[give]
            for angle in angles:
                columns.append(np.cos(angle) * keyed[:, 2 * give] + np.sin(angle) * keyed[:, 2 * give + 1])
                low.append(np.zeros(len(give)))
                high.append(np.full(len(give), np.inf))
            hold = np.flatnonzero(~np.isfinite(strength))
            columns += [keyed[:, 2 * hold], keyed[:, 2 * hold + 1]]
            low += [np.full(len(hold), -np.inf)] * 2
            high += [np.full(len(hold), np.inf)] * 2
        columns.append(self.pulls)
        for bounds, own in zip((low, high), self.tension_bounds, strict=True):
            bounds.append(own)
        matrix = sparse.hstack([*columns, sparse.csc_array(live[:, None])])
        # the edges of the pyramid of a dowel that gives way add up to its strength at most
        count = len(weak)
        edges = sparse.csr_array(
            (np.ones(sides * count), (np.tile(np.arange(count), sides), first_weak + np.arange(sides * count))),
            shape=(count, matrix.shape[1]),
        )
        spare = sparse.vstack([sparse.csr_array((len(dead), count)), sparse.eye_array(count)])
        matrix = sparse.hstack([spare, sparse.vstack([matrix, edges])]).tocsc()
        low = [np.zeros(count), *low, np.array([-np.inf])]
        high = [np.full(count, np.inf), *high, np.array([np.inf])]
        return _most(matrix, np.append(-dead, weak), np.concatenate(low), np.concatenate(high))


def denied(at: np.ndarray, slip: np.ndarray, mu: np.ndarray) -> float:
    """Greatest rate of overlap, or of sliding without its dilatancy, of corners with rates (n, 3), slips and frictions (n)."""
    with np.errstate(invalid="ignore"):
        needed = np.where(np.isfinite(mu), mu * slip, 0.0)
    stuck = np.where(np.isfinite(mu), 0.0, slip)
    return max(float((needed - at[:, 0]).max(initial=0.0)), float(stuck.max(initial=0.0)))


def _waited(*calls: Callable[[], Found], told: Callable[[], None] = lambda: None) -> list[Found]:
    """What long calls give, each made in a thread of its own: so Ctrl-C is answered at once, and the threads left to
    themselves. told() is called while they work."""
    workers = [Worker(call) for call in calls]
    while not all([worker.over(LOOK) for worker in workers]):
        told()
    return [worker.result() for worker in workers]


def _most(matrix: sparse.csc_array, right: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """The most of the last unknown, by the interior-point method of HiGHS with its crossover to a vertex."""
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    solver.setOptionValue("solver", "ipm")
    solver.setOptionValue("threads", 1)
    solver.setOptionValue("primal_feasibility_tolerance", 1e-10)
    solver.setOptionValue("dual_feasibility_tolerance", 1e-10)
    programme = highspy.HighsLp()
    programme.num_col_, programme.num_row_ = matrix.shape[1], matrix.shape[0]
    cost = np.zeros(matrix.shape[1])
    cost[-1] = -1.0
    programme.col_cost_, programme.col_lower_, programme.col_upper_ = cost, low, high
    programme.row_lower_ = programme.row_upper_ = right
    programme.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    programme.a_matrix_.start_, programme.a_matrix_.index_ = matrix.indptr, matrix.indices
    programme.a_matrix_.value_ = matrix.data
    solver.passModel(programme)
    _waited(solver.run)
    status = solver.getModelStatus()
    if status == highspy.HighsModelStatus.kOptimal:
        return float(solver.getSolution().col_value[-1])
    if status == highspy.HighsModelStatus.kInfeasible:
        return -np.inf
    if status in (highspy.HighsModelStatus.kUnbounded, highspy.HighsModelStatus.kUnboundedOrInfeasible):
        return np.inf
    raise NoAnswer(f"the linear solver found no solution: {solver.modelStatusToString(status)}")
