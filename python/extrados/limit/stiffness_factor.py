"""Factors of the stiffness of rigid blocks on springs at their points of contact, with one pattern and one order for all.

K = M D M' + A diag(a) A' + hold I over the motions of the blocks: M the forces of the points, D (points, d, d) their springs, A
the answers. With a border, K stands beside the live load: [K, -live; live', 0].
"""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from extrados.limit.contact_points import ContactPoints
from extrados.limit.errors import NoAnswer


class StiffnessFactor:
    """The stiffness of one structure; `factor` replaces the factors by those of other springs. NoAnswer for a border without live load."""

    def __init__(self, points: ContactPoints, *, border: bool):
        n = len(points.dead)
        self._border = border
        self.size = n + border
        self._arms, row, column, first = _arms_of(points)
        answers = points.answers.tocsc()
        one, other = _pairs(answers.indptr)
        self._answer = np.repeat(np.arange(answers.shape[1]), np.diff(answers.indptr))[one]
        self._outer = answers.data[one] * answers.data[other]
        inner, live = np.arange(n), np.flatnonzero(points.live) if border else np.empty(0, dtype=int)
        if border and not len(live):
            raise NoAnswer("no live load acts on a block, so no load path exists")
        edge = np.full(len(live), n)
        self._fixed = np.concatenate([-points.live[live], points.live[live]])
        rows = np.concatenate([row, answers.indices[one], inner, live, edge])
        columns = np.concatenate([column, answers.indices[other], inner, edge, live])
        self._used = first
        # The order that the solver finds for the whole pattern serves all springs.
        weights = np.concatenate([np.full(len(rows) - n - 2 * len(live), 1e-3), np.full(n, 1e3), self._fixed])
        whole = sparse.csc_array((weights, (rows, columns)), shape=(self.size, self.size))
        self._order = splu(whole, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).perm_c.astype(np.int64)
        places, self._place = np.unique(self._order[columns] * self.size + self._order[rows], return_inverse=True)
        self._rows = (places % self.size).astype(np.int32)
        self._start = np.searchsorted(places, np.arange(self.size + 1) * self.size).astype(np.int32)

    def factor(self, springs: np.ndarray, answers: np.ndarray, hold: float) -> "StiffnessFactor":
        """The factors for springs (points, d, d), answers (k) and `hold` on the diagonal; RuntimeError where K is singular."""
        pressed = np.matmul(self._arms.transpose(0, 2, 1), np.matmul(springs, self._arms))
        values = [pressed.ravel()[self._used], answers[self._answer] * self._outer]
        values += [np.full(self.size - self._border, hold), self._fixed]
        data = np.bincount(self._place, weights=np.concatenate(values), minlength=len(self._rows))
        matrix = sparse.csc_array((data, self._rows, self._start), shape=(self.size, self.size))
        self._factors = splu(matrix, permc_spec="NATURAL", options={"SymmetricMode": True}, diag_pivot_thresh=0.1)
        return self

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x of K x = right (size), by the last factors."""
        ordered = np.empty(self.size)
        ordered[self._order] = right
        return self._factors.solve(ordered)[self._order]


def _arms_of(points: ContactPoints) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Forces of each point on the equations that it acts on, (points, d, most equations) with zeros beyond; row and column of the
    products of these, and their places among (points, most, most)."""
    m, d = len(points.friction), points.dimension
    entries = points.matrix.tocoo()
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
    shape = (m, most, most)
    rows, columns = (np.broadcast_to(one, shape).ravel() for one in (equation[:, :, None], equation[:, None, :]))
    used = np.flatnonzero((rows >= 0) & (columns >= 0))
    return arms, rows[used], columns[used], used


def _pairs(start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All pairs of entries that lie in the same group; start (groups + 1) of the groups."""
    count = np.diff(start)
    each = np.repeat(count, count)
    one = np.repeat(np.arange(start[-1]), each)
    first = np.repeat(np.repeat(start[:-1], count), each)
    return one, first + np.arange(len(one)) - np.repeat(np.cumsum(each) - each, each)
