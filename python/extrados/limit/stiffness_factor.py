"""Factors of the stiffness of rigid blocks on springs at their points of contact, as a band with one order for all.

K = M D M' + A diag(a) A' + hold I over the motions of the blocks: M the forces of the points, D (points, d, d) their springs, A
the answers. Beside the live load: [K, -live; live', 0], solved by its blocks with one refinement, so that K may be nearly
singular, as it is at collapse (Govaerts and Pryce 1993).
"""

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import reverse_cuthill_mckee

from extrados.core.limit import SpringBand
from extrados.limit.contact_points import ContactPoints


class StiffnessFactor:
    """The stiffness of one structure; `factor` replaces the factors by those of other springs."""

    def __init__(self, points: ContactPoints):
        n = len(points.dead)
        self._points = points
        arms, equation = _arms_of(points)
        answers = points.answers.tocsc()
        one, other = _pairs(answers.indptr)
        self._answer = np.repeat(np.arange(answers.shape[1]), np.diff(answers.indptr))[one]
        self._outer = answers.data[one] * answers.data[other]
        rows, columns = answers.indices[one], answers.indices[other]
        point, slot = np.nonzero(equation >= 0)
        reach = sparse.csr_array((np.ones(len(point)), (equation[point, slot], point)), shape=(n, len(equation)))
        coupled = sparse.coo_array(reach @ reach.T + sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=(n, n)))
        width, self._order = min(
            ((int(np.abs(np.subtract(*(place[i] for i in coupled.coords))).max(initial=0)), place) for place in _orders(coupled)),
            key=lambda one: one[0],
        )
        self._springs = SpringBand(arms, np.where(equation >= 0, self._order[equation], -1), n, width)
        self._place = (self._order[columns], 2 * width + self._order[rows] - self._order[columns])
        self._diagonal = 2 * width
        self._live = points.live

    def factor(self, springs: np.ndarray, answers: np.ndarray, hold: float) -> bool:
        """The factors for springs (points, d, d), answers (k) and `hold` on the diagonal; False where K is singular."""
        self._now = springs, answers, hold
        self._springs.lay(springs)
        np.add.at(self._springs.band, self._place, answers[self._answer] * self._outer)
        self._springs.band[:, self._diagonal] += hold
        return self._springs.factor()

    def solve(self, *rights: np.ndarray) -> np.ndarray:
        """The x (sides, n) of K x = right (n) of each side, by the last factors."""
        ordered = np.empty((len(rights), len(self._order)))
        ordered[:, self._order] = rights
        return self._springs.solve(ordered)[:, self._order]

    def solve_beside_load(self, rest: np.ndarray, short: float) -> tuple[np.ndarray, float]:
        """Motion u (n) and multiplier g of K u - g live = rest, live . u = short; not finite where no motion does work."""
        live = self._live
        u, unit = self.solve(rest, live)
        work = float(live @ unit)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            g = np.divide(short - float(live @ u), work)
            u = u + g * unit
            (more,) = self.solve(rest - self._times(u) + g * live)
            step = np.divide(short - float(live @ (u + more)), work)
            return u + more + step * unit, float(g + step)

    def _times(self, u: np.ndarray) -> np.ndarray:
        """K u."""
        p, (springs, answers, hold) = self._points, self._now
        force = np.matmul(springs, (p.rates @ u).reshape(len(springs), -1, 1))
        return p.matrix @ force.ravel() + p.answers @ (answers * (p.answers.T @ u)) + hold * u


def _orders(coupled: sparse.coo_array) -> tuple[np.ndarray, np.ndarray]:
    """Places of the equations (n) in two orders: as they come, and by Reverse Cuthill-McKee."""
    n = coupled.shape[0]
    by_levels = np.empty(n, dtype=np.int64)
    by_levels[reverse_cuthill_mckee(coupled.tocsr(), symmetric_mode=True)] = np.arange(n)
    return np.arange(n), by_levels


def _arms_of(points: ContactPoints) -> tuple[np.ndarray, np.ndarray]:
    """Forces of each point on the equations that it acts on, (points, d, most equations) with zeros beyond; these equations
    (points, most), -1 beyond."""
    m, d = len(points.friction), points.dimension
    entries = points.matrix.tocoo()
    entries.eliminate_zeros()
    point, axis = np.divmod(entries.coords[1].astype(np.int64), d)
    keys, slot = np.unique(point * len(points.dead) + entries.coords[0], return_inverse=True)
    of, row = np.divmod(keys, len(points.dead))
    begin = np.searchsorted(of, np.arange(m))
    slots = np.arange(len(keys)) - begin[of]
    most = int(slots.max(initial=0)) + 1
    arms = np.zeros((m, d, most))
    arms[point, axis, slots[slot]] = entries.data
    equation = np.full((m, most), -1)
    equation[of, slots] = row
    return arms, equation


def _pairs(start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All pairs of entries that lie in the same group; start (groups + 1) of the groups."""
    count = np.diff(start)
    each = np.repeat(count, count)
    one = np.repeat(np.arange(start[-1]), each)
    first = np.repeat(np.repeat(start[:-1], count), each)
    return one, first + np.arange(len(one)) - np.repeat(np.cumsum(each) - each, each)
