"""Ties sized by limit analysis: the least force that a load needs, and the capacity over the force.

Equilibrium is linear in the forces of joints and ties, so that a tie force is one more column of the programme. The capacity is
a concave, piecewise linear function of the force at which a tie yields: each piece is a collapse mechanism, and its slope is the
extension of the tie in it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy import sparse

from extrados.limit.errors import NoAnswer, NoEquilibrium
from extrados.limit.loads import Loads
from extrados.limit.programme import LimitAnalysis
from extrados.limit.solver import linear_programme
from extrados.limit.states import Mechanism
from extrados.limit.systems import Constraints
from extrados.model.geometry.anchors import Anchored
from extrados.model.geometry.assembly import Assembly

#: Relative difference of capacities that rounding makes
SAME = 1e-7
#: Pieces of a curve: joints that crush make it smooth, and its tangents end here
MOST_PIECES = 24
#: Rounds of tangent planes of crushing
ROUNDS = 60
#: Of the total load: how far crushing may be from its law
LAW = 1e-8


@dataclass(frozen=True)
class Point:
    """The capacity [g] where ties yield at `force` [N], its slope [g/N] there, the sense (1 to +x, -1 to -x; in space the direction
    [deg]) and the mechanism that governs."""

    force: float
    capacity: float
    slope: float
    direction: float
    mechanism: Any

    def line(self, force: float) -> float:
        """The capacity of this mechanism at another force, an upper bound of that of the structure."""
        return self.capacity + self.slope * (force - self.force)


def taken_per_force(assembly: Assembly, loads: Loads, anchored: Anchored, mechanism: Mechanism, works_in: str) -> float:
    """Slope of the capacity over the force [g/N]: the work that ties of unit force take up of a motion, over that of the live
    load in it. Ties in tension take extension, struts shortening, springs both."""
    x, y = assembly.centroid.T
    speed = mechanism.velocity
    twist = np.column_stack([speed[:, 0] + speed[:, 2] * y, speed[:, 1] - speed[:, 2] * x, speed[:, 2]])
    work = abs(float((loads.live * twist).sum()))
    velocity = np.vstack([mechanism.velocity, np.zeros(3)])  # GROUND = -1 picks the row of zeros
    centroid = np.vstack([assembly.centroid, np.zeros(2)])
    ends = []
    for end in (0, 1):
        block, arm = anchored.block[:, end], anchored.point[:, end] - centroid[anchored.block[:, end]]
        spin = velocity[block, 2]
        ends.append(velocity[block, :2] + np.column_stack([-spin * arm[:, 1], spin * arm[:, 0]]))
    extension = ((ends[1] - ends[0]) * anchored.direction).sum(axis=1)
    taken = {"tension": extension, "compression": -extension, "both": np.abs(extension)}[works_in]
    return float(np.maximum(taken, 0.0).sum()) / work


def concave_curve(at: Callable[[float], Point], first: float, last: float, same: float = SAME) -> list[Point]:
    """Points of the curve between two forces [N] from which all its pieces follow, ascending.

    Tangents at two points meet above the curve or on it; where they meet on it no mechanism lies between. Otherwise the point
    below gives another tangent. same: relative distance of curve and tangents at which a smooth curve ends, as crushing gives.
    """
    points = [at(first), at(last)]
    spans = [(points[0], points[1])]
    while spans and len(points) < 2 * MOST_PIECES:
        low, high = spans.pop(0)
        turn = low.slope - high.slope
        scale = max(1e-12, abs(low.capacity), abs(high.capacity))
        if abs(low.line(high.force) - high.capacity) <= same * scale or turn <= 0.0:
            continue  # one mechanism from end to end
        force = low.force + (high.line(low.force) - low.capacity) / turn
        if not low.force < force < high.force:
            continue
        middle = at(force)
        points.append(middle)
        if low.line(force) - middle.capacity > same * scale:
            spans += [(low, middle), (middle, high)]
    return sorted(points, key=lambda p: p.force)


@dataclass(frozen=True)
class Piece:
    """One mechanism governs from `first` to `last` [N], where the capacity rises from `low` to `high` [g]."""

    first: float
    last: float
    low: float
    high: float
    point: Point


def pieces_of(points: list[Point]) -> list[Piece]:
    """The pieces of a concave curve of which points are given."""
    first, last = points[0].force, points[-1].force
    kept: list[Point] = []
    for point in sorted(points, key=lambda p: -p.slope):
        if kept and abs(kept[-1].line(first) - point.line(first)) + abs(kept[-1].line(last) - point.line(last)) <= (
            SAME * max(1e-12, abs(point.line(last)))
        ):
            continue  # the same mechanism
        kept.append(point)

    def meet(one: Point, two: Point) -> float:
        return one.force + (two.line(one.force) - one.capacity) / max(one.slope - two.slope, 1e-300)

    hull: list[Point] = []
    for point in kept:
        while hull and meet(hull[-1], point) <= (meet(hull[-2], hull[-1]) if len(hull) > 1 else first):
            hull.pop()
        hull.append(point)
    ends = [first, *(min(max(meet(a, b), first), last) for a, b in pairwise(hull)), last]
    return [
        Piece(a, b, point.line(a), point.line(b), point)
        for point, a, b in zip(hull, ends[:-1], ends[1:], strict=True)
        if b - a > SAME * max(last, 1e-12)
    ]


def least_force(limit: LimitAnalysis, gamma: float, sign: int) -> float:
    """Force [N] of the last tie of a structure with which it carries an acceleration gamma [g] to +x: its share is minimised in
    the programme of the structure itself. sign: 1 of a tie, -1 of a strut. Infinite where no force suffices."""
    cost = np.zeros(limit.system.unknowns)
    column = limit.system.shares.stop - 1
    cost[column] = sign
    try:
        share = limit.optimise(cost, (gamma, gamma))[0].x[column]
    except NoEquilibrium:
        return np.inf
    return max(0.0, sign * float(share)) * limit.loads.scale


def least_forces(limits: list[LimitAnalysis], gammas: list[float], ties: int, weight: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Yield forces (ties) [N], of least weighted sum, at which the structure carries all load cases, the accelerations `gammas`
    [g] to +x: one programme over the joint forces of all cases and the yield forces that they share.

    limits: the programmes of the cases, in which the last `ties` forces that answer are the ties, unlimited. weight, most (ties):
    cost per force, and the greatest force [N]. NoEquilibrium where no forces suffice.
    """
    scale = limits[0].loads.scale
    n = len(limits)
    cuts: list[Constraints | None] = [None] * n
    for _ in range(ROUNDS):
        x = _solved(limits, gammas, ties, weight * scale, most / scale, cuts)
        settled = True
        for k, limit in enumerate(limits):
            corners = x[k][:-1][: limit.equations.shares.start].reshape(-1, 3)
            if (more := limit.crushing_cuts(corners, LAW)) is not None:
                cuts[k] = more if (before := cuts[k]) is None else before + more
                settled = False
        if settled:
            return np.asarray(x[-1] * scale)
    raise NoAnswer("the iteration for crushing of the joints did not converge")


def _solved(
    limits: list[LimitAnalysis], gammas: list[float], ties: int, weight: np.ndarray, most: np.ndarray, cuts: list[Constraints | None]
) -> list[np.ndarray]:
    """Unknowns of each case, then the shares of the yield forces in the total load."""
    blocks, low, high, least, greatest = [], [], [], [], []
    n = len(limits)
    for k, (limit, gamma, cut) in enumerate(zip(limits, gammas, cuts, strict=True)):
        system = limit.equations
        laws = limit.laws if cut is None else limit.laws + cut
        rows, constant = system.express(laws)
        columns = np.arange(system.shares.stop - ties, system.shares.stop)
        # yield force - |share| >= 0, for tension and compression
        pick = sparse.csr_array((np.ones(ties), (np.arange(ties), columns)), shape=(ties, system.unknowns))
        none, one = sparse.csr_array((system.equations + rows.shape[0], ties)), sparse.eye_array(ties)
        whole = sparse.vstack([system.matrix, rows, -pick, pick])
        yields = sparse.vstack([none, one, one])
        blocks.append([whole if i == k else None for i in range(n)] + [yields])
        low += [system.right, laws.lower - constant, np.zeros(2 * ties)]
        high += [system.right, np.full(len(laws.lower) + 2 * ties, np.inf)]
        a, b = np.full(system.unknowns, -np.inf), np.full(system.unknowns, np.inf)
        resistance = limit.loads.resistance
        assert resistance is not None
        a[system.shares], b[system.shares] = resistance.low, resistance.high
        a[-1] = b[-1] = gamma
        least.append(a)
        greatest.append(b)
    counts = [limit.equations.unknowns for limit in limits]
    cost = np.concatenate([np.zeros(sum(counts)), weight])
    found = linear_programme(
        sparse.block_array(blocks, format="csr"),
        np.concatenate(low),
        np.concatenate(high),
        cost,
        np.concatenate([*least, np.zeros(ties)]),
        np.concatenate([*greatest, most]),
    )
    return np.split(found.x, np.cumsum(counts))
