"""Thrust networks on a fixed form diagram: compression branches between nodes within a vault, by linear programmes.

Branch e between nodes i and j has a force density q_e >= 0 (its horizontal thrust over its length in plan). Equilibrium in plan is
linear in q; upright it is sum of q_e (z_i - z_j) = W_i, a product of q and the heights z (O'Dwyer 1999; Block and Ochsendorf 2007).
Two programmes enclose an extreme value over all networks on the diagram:

- bound: w = q_e z_i is an unknown of its own at either end of a branch, between q_e times the lowest and the highest place of the
  node; what all networks fulfil is linear in q and w. It leaves the branches of a node free to meet it at several heights, in
  equilibrium of moments, so it bounds the value from outside.
- network: q_e z_i is linearised about the last network, within a step that shrinks; the heights then follow from q, so that each
  network is in equilibrium.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from extrados.limit.errors import NoAnswer, NoEquilibrium
from extrados.limit.solver import linear_programme

Aim = Literal["least", "greatest", "central", "horizontal"]
INSIDE = 1e-6  # of the greatest depth: how far a node of a network may lie outside
ROUNDS = 80
SMALLEST = 1e-7  # step at which the search ends, over the greatest depth
SHRINKS = 0.3
GAINS = 1e-8  # of the value
PENALTY = 1e3  # of a node outside by the size, over the value
BELOW = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)  # of the part found: how far below it the bound is sought
FARTHEST = 64.0  # parts of the depth that are looked at
DEEP = 1.0  # of the size: how far below a bed the line of a reaction is followed
ZERO = 1e-9  # over the size
LEAST = 1e-10  # of the greatest density
MOST = 1e6  # density, and load over the weight, beyond which there is no limit


@dataclass(frozen=True)
class Diagram:
    """A form diagram in plan within a vault; lengths [m], weights [N].

    point (n, 2); branch (m, 2): its nodes; held (k): branches whose middles lie within the vault as well; low, high (n + k): between
    which a node and the middle of a held branch lies; above (n + k): those over a bed, which may lie below `low`, where the bed
    has taken the force already; weight (n). support (s): nodes on the
    ground; outward (s, 2): unit vectors of their thrust; seat (s, 2, 2): inner and outer end of the bed below each, along
    `outward` from the node and upward; the reaction crosses it between both.
    """

    point: np.ndarray
    branch: np.ndarray
    held: np.ndarray
    low: np.ndarray
    high: np.ndarray
    above: np.ndarray
    weight: np.ndarray
    support: np.ndarray
    outward: np.ndarray
    seat: np.ndarray


@dataclass(frozen=True)
class Network:
    """density (m) [N/m]; height (n) [m]; thrust: sum of the outward reactions [N]; part: of the depth about the middle that holds
    the nodes; load: horizontal load over the weight; residual: greatest unbalanced force at a node, over the weight."""

    density: np.ndarray
    height: np.ndarray
    thrust: float
    part: float
    load: float
    residual: float


@dataclass(frozen=True)
class Extreme:
    """The value of the best network found, None without one, and the bound that no network on the diagram passes, None without a
    limit; for the thrust [N], for the part of the depth and the load without unit."""

    network: Network | None
    value: float | None
    bound: float | None


@dataclass
class ThrustNetworks:
    """The networks of a diagram under its weights and a horizontal load along `direction` (2), a unit vector in plan."""

    diagram: Diagram
    direction: np.ndarray = field(default_factory=lambda: np.array([1.0, 0.0]))

    def __post_init__(self) -> None:
        one = self.diagram
        n, m = len(one.point), len(one.branch)
        self._total = float(one.weight.sum())
        self._size = float(np.ptp(one.point, axis=0).max())
        # Lengths over the size, heights from the lowest place, forces of the order of one at each node
        self._unit = self._total / n / self._size
        self._load = one.weight / (self._unit * self._size)
        self._base = float(one.low.min())
        self._low, self._high = (one.low - self._base) / self._size, (one.high - self._base) / self._size
        first, second = one.branch.T
        way = (one.point[second] - one.point[first]) / self._size
        # Both ends of the branches: node, branch, and sums over the ends at each node
        self._node, self._branch = np.concatenate([first, second]), np.tile(np.arange(m), 2)
        place = np.arange(2 * m)
        self._free = np.setdiff1d(np.arange(n), one.support)
        self._ends = sparse.csr_array((np.ones(2 * m), (self._node, place)), (n, 2 * m))
        self._at_ends = sparse.csr_array((np.ones(2 * m), (place, self._branch)), (2 * m, m))
        self._at_nodes = sparse.csr_array((np.ones(2 * m), (place, self._node)), (2 * m, n))
        self._half = sparse.csr_array(0.5 * self._at_ends.T)[one.held]
        self._places = sparse.csr_array(sparse.vstack([sparse.eye_array(n), self._half @ self._at_nodes]))
        self._sum = [sparse.csr_array(self._ends @ sparse.diags_array(np.concatenate([way[:, k], -way[:, k]]))) for k in range(2)]
        other = sparse.csr_array((np.ones(2 * m), (place, np.roll(place, m))), (2 * m, 2 * m))
        self._upright = sparse.csr_array(self._ends @ (sparse.eye_array(2 * m) - other))
        self._thrust = -sum(one.outward[:, k] @ (self._sum[k][one.support] @ self._at_ends).toarray() for k in range(2))

    def extreme(self, aim: Aim) -> Extreme:
        """least or greatest thrust; the least part of the depth about its middle that holds a network (central); the greatest
        horizontal load over the weight (horizontal). NoEquilibrium where the bound proves that no network exists on this
        diagram."""
        if aim == "central":
            return self._least_part()
        bound, start = self._bound(aim, 1.0)
        if max(float(start[0].max()), abs(bound)) > 0.5 * MOST:
            return Extreme(None, None, None)
        found = self._search(aim, *start)
        value = None if found is None else found.load + 0.0 if aim == "horizontal" else found.thrust
        sign = -1.0 if aim in ("greatest", "horizontal") else 1.0
        return Extreme(found, value, 0.0 + sign * bound * (1.0 if aim == "horizontal" else self._total))

    def _cost(self, aim: Aim) -> tuple[np.ndarray, float, float]:
        """Cost of the densities, of the part and of the load; thrust counts over the total weight."""
        if aim == "central":
            return np.zeros(len(self.diagram.branch)), 1.0, 0.0
        if aim == "horizontal":
            return np.zeros(len(self.diagram.branch)), 0.0, -1.0
        return (1.0 if aim == "least" else -1.0) * self._thrust / self._load.sum(), 0.0, 0.0

    def _seats(self) -> list[tuple[sparse.csr_array, sparse.csr_array, np.ndarray, np.ndarray, np.ndarray]]:
        """Rows (of q, of w, of load times height at the supports, of the load, constant) that are positive where the reactions cross
        their seats inside the outer, the inner end.

        A reaction of outward thrust H and downward force V through the node at z has the moment H (z - h) - r V about a point at r
        outward and h upward.
        """
        one, rows = self.diagram, []
        outward = sparse.csr_array(sum(sparse.diags_array(-one.outward[:, k]) @ self._sum[k][one.support] for k in range(2)))
        down = -self._upright[one.support]
        weight = self._load[one.support]
        pushed = weight * (one.outward @ self.direction)
        for end, sign in ((0, 1.0), (1, -1.0)):
            reach, height = one.seat[:, end, 0] / self._size, (one.seat[:, end, 1] - self._base) / self._size
            of_q = -sign * (sparse.diags_array(height) @ outward @ self._at_ends)
            of_w = sign * (outward - sparse.diags_array(reach) @ down)
            rows.append((of_q, of_w, sign * pushed, -sign * height * pushed, -sign * reach * weight))
        return rows

    def _bound(self, aim: Aim, part: float) -> tuple[float, tuple[np.ndarray, np.ndarray]]:
        """The bound of a value over the total weight, or with aim central how far the nodes lie outside the part, and densities
        (m) and heights (n) to begin from."""
        m, n, free = len(self.diagram.branch), len(self.diagram.point), len(self._free)
        half, middle = 0.5 * part * (self._high - self._low), 0.5 * (self._high + self._low)
        low, high = middle - half - DEEP * self.diagram.above, middle + half
        blank, zero, mass = sparse.csr_array, np.zeros(free), self._load[self._free]
        one = np.ones((2 * m, 1))
        # unknowns: q (m), w (2 m), load, load times height (n), slack
        rows, lower, upper = [], [], []

        def add(columns: list[sparse.sparray | None], least: np.ndarray, most: np.ndarray | None = None) -> None:
            sizes = (m, 2 * m, 1, n, 1)
            rows.append(sparse.hstack([blank((len(least), k)) if c is None else c for c, k in zip(columns, sizes, strict=True)]))
            lower.append(least)
            upper.append(np.full(len(least), np.inf) if most is None else most)

        for k in range(2):
            pushed = mass * self.direction[k]
            add([self._sum[k][self._free] @ self._at_ends, None, blank(-pushed[:, None]), None, None], zero, zero)
            add([None, self._sum[k][self._free], None, blank((-pushed, (range(free), self._free)), (free, n)), None], zero, zero)
        add([None, self._upright[self._free], None, None, None], mass, mass)
        for of_q, of_w, of_p, of_load, constant in self._seats():
            k = len(constant)
            at = blank((of_p, (range(k), self.diagram.support)), (k, n))
            add([of_q, of_w, blank(of_load[:, None]), at, blank(np.ones((k, 1)))], -constant)
        for limit, sign in ((low[:n], 1.0), (high[:n], -1.0)):
            bounded = -sign * sparse.diags_array(limit[self._node]) @ self._at_ends
            add([bounded, sign * sparse.eye_array(2 * m), None, None, blank(one)], np.zeros(2 * m))
            add([None, None, blank(-sign * limit[:, None]), sign * sparse.eye_array(n), None], np.zeros(n))
        for limit, sign in ((low[n:], 1.0), (high[n:], -1.0)):
            k, held = len(limit), self.diagram.held
            add([blank((-sign * limit, (range(k), held)), (k, m)), sign * self._half, None, None, blank(np.ones((k, 1)))], np.zeros(k))
        cost_q, _, cost_load = self._cost(aim)
        slack = aim == "central"
        cost = np.concatenate([cost_q, np.zeros(2 * m), [cost_load], np.zeros(n), [1.0 if slack else 0.0]])
        least = np.concatenate([np.zeros(m), np.full(2 * m, -np.inf), [0.0], np.full(n, -np.inf), [0.0]])
        most = np.concatenate(
            [
                np.full(m, MOST),
                np.full(2 * m, np.inf),
                [MOST if aim == "horizontal" else 0.0],
                np.full(n, np.inf),
                [np.inf if slack else 0.0],
            ]
        )
        found = linear_programme(sparse.vstack(rows), np.concatenate(lower), np.concatenate(upper), cost, least, most)
        q, w = found.x[:m], found.x[m : 3 * m]
        at = self._ends @ (self._at_ends @ q)
        z = np.where(at > LEAST, (self._ends @ w) / np.maximum(at, LEAST), middle[:n])
        return found.value, (q, np.clip(z, low[:n], high[:n]))

    def _least_part(self) -> Extreme:
        """The least part of the depth that holds a network found, and the greatest of the parts below it that holds none."""
        reach = 1.0
        outside, start = self._bound("central", reach)
        while outside > ZERO:
            reach *= 4.0
            outside, start = self._bound("central", reach)
            if reach > FARTHEST:
                raise NoEquilibrium(f"no network on this form diagram lies within {FARTHEST / 4.0:g} times the depth of the structure")
        found = self._search("central", *start)
        if found is None:
            return Extreme(None, None, None)
        below = (found.part * (1.0 - less) for less in BELOW)
        return Extreme(found, found.part, next((part for part in below if self._bound("central", part)[0] > ZERO), 0.0))

    def _search(self, aim: Aim, q: np.ndarray, z: np.ndarray) -> Network | None:
        """The best network that is found from densities and heights; None where none lies within the surfaces."""
        reach = float((self._high - self._low).max())
        lifted = self._heights(q, z)  # in equilibrium, so that the first linear programme has a solution
        z = lifted if np.isfinite(lifted).all() else z
        step, value = max(reach, self._outside(z, 1.0)), np.inf
        part, load = 1.0, 0.0
        best: tuple[np.ndarray, np.ndarray, float, float] | None = None
        for _ in range(ROUNDS):
            try:
                trial_q, trial_z, trial_load = self._linearised(aim, q, z, load, step)
            except NoEquilibrium:
                break
            except NoAnswer:
                step *= SHRINKS
                continue
            trial_z = self._heights(trial_q, trial_z)
            if not np.isfinite(trial_z).all():
                step *= SHRINKS
                continue
            part = self._part(trial_z) if aim == "central" else 1.0
            outside = max(self._outside(trial_z, part), self._off_seat(trial_q, trial_z, trial_load))
            cost_q, cost_part, cost_load = self._cost(aim)
            new = float(cost_q @ trial_q) + cost_part * part + cost_load * trial_load + PENALTY * outside
            if best is not None and abs(new - value) <= GAINS * abs(value):
                break
            if new < value - GAINS * abs(value) or (np.isfinite(new) and not np.isfinite(value)):
                q, z, load, value = trial_q, trial_z, trial_load, new
                step = min(2.0 * step, reach)
                if outside <= INSIDE * reach:
                    best = q, z, part, load
            else:
                step *= SHRINKS
            if step < SMALLEST * reach:
                break
        return None if best is None else self._network(*best)

    def _linearised(self, aim: Aim, q: np.ndarray, z: np.ndarray, load: float, step: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Densities, heights and load of the programme linearised about q, z and load, with heights that change by `step` at most."""
        m, n, blank = len(q), len(z), sparse.csr_array
        free, mass = self._free, self._load[self._free]
        of_z = sparse.diags_array(q[self._branch]) @ self._at_nodes
        of_q = sparse.diags_array(z[self._node]) @ self._at_ends
        constant = -q[self._branch] * z[self._node]
        half, middle = 0.5 * (self._high - self._low), 0.5 * (self._high + self._low)
        # unknowns: q, z, part, load, slack
        rows, lower, upper = [], [], []

        def add(columns: list[sparse.sparray], rest: tuple[np.ndarray, ...], least: np.ndarray, most: np.ndarray | None = None) -> None:
            rows.append(sparse.hstack([*columns, blank(np.column_stack(rest))]))
            lower.append(least)
            upper.append(np.full(len(least), np.inf) if most is None else most)

        zero, one = np.zeros(len(free)), np.ones(len(half))
        for k in range(2):
            add([self._sum[k][free] @ self._at_ends, blank((len(free), n))], (zero, -mass * self.direction[k], zero), zero, zero)
        upright = self._upright[free]
        add([upright @ of_q, upright @ of_z], (zero, zero, zero), mass - upright @ constant, mass - upright @ constant)
        at_support = z[self.diagram.support]
        for seat_q, seat_w, of_p, of_load, least in self._seats():
            nothing = np.zeros(len(least))
            at = blank((of_p * load, (range(len(least)), self.diagram.support)), (len(least), n))
            pushes = of_load + of_p * at_support
            right = -least - seat_w @ constant + of_p * load * at_support
            add([seat_q + seat_w @ of_q, seat_w @ of_z + at], (nothing, pushes, nothing + 1.0), right)
        for sign in (1.0, -1.0):
            deep = sign * middle - (DEEP * self.diagram.above if sign > 0.0 else 0.0)
            add([blank((len(half), m)), sign * self._places], (half, 0.0 * one, one), deep)
        cost_q, cost_part, cost_load = self._cost(aim)
        cost = np.concatenate([cost_q, np.zeros(n), [cost_part, cost_load, PENALTY]])
        central = aim == "central"
        least = np.concatenate([np.zeros(m), z - step, [0.0 if central else 1.0, 0.0, 0.0]])
        most = np.concatenate([np.full(m, MOST), z + step, [np.inf if central else 1.0, MOST if aim == "horizontal" else 0.0, np.inf]])
        found = linear_programme(sparse.vstack(rows), np.concatenate(lower), np.concatenate(upper), cost, least, most)
        return found.x[:m], found.x[m : m + n], float(found.x[m + n + 1])

    def _heights(self, q: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Heights of the free nodes in equilibrium with densities, those of the supports given."""
        dense = np.maximum(q, LEAST * float(q.max()))[self._branch]
        matrix = self._upright[self._free] @ sparse.diags_array(dense) @ self._at_nodes
        found = z.copy()
        right = self._load[self._free] - matrix[:, self.diagram.support] @ z[self.diagram.support]
        try:
            found[self._free] = splu(sparse.csc_array(matrix[:, self._free])).solve(right)
        except RuntimeError:  # singular: branches that carry nothing leave a node free
            found[self._free] = np.inf
        return found

    def _part(self, z: np.ndarray) -> float:
        """The least part of the depth about its middle that holds all nodes and middles."""
        off, half = self._off(z)
        return float((off / half).max())

    def _outside(self, z: np.ndarray, part: float) -> float:
        """How far heights lie outside a part of the depth, over the size."""
        off, half = self._off(z)
        return float(max(0.0, (off - part * half).max()))

    def _off(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance of nodes and middles from the middle of the depth, over a bed only upward, and half the depth."""
        off = self._places @ z - 0.5 * (self._high + self._low)
        return np.where(self.diagram.above, off, np.abs(off)), 0.5 * (self._high - self._low)

    def _off_seat(self, q: np.ndarray, z: np.ndarray, load: float) -> float:
        """The greatest moment by which a reaction misses its seat."""
        w, pushed = q[self._branch] * z[self._node], load * z[self.diagram.support]
        rows = self._seats()
        return max(
            0.0, *(float(-(of_q @ q + of_w @ w + of_p * pushed + of_load * load + rest).min()) for of_q, of_w, of_p, of_load, rest in rows)
        )

    def _network(self, q: np.ndarray, z: np.ndarray, part: float, load: float) -> Network:
        w = q[self._branch] * z[self._node]
        upright = (self._upright @ w - self._load)[self._free]
        plan = [(self._sum[k] @ self._at_ends @ q - load * self._load * self.direction[k])[self._free] for k in range(2)]
        rest = max(float(np.abs(one).max()) for one in (upright, *plan)) / float(self._load.sum())
        thrust = float(self._thrust @ q) * self._unit * self._size
        return Network(self._unit * q, self._base + self._size * z, thrust, part, load, rest)
