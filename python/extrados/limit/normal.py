"""The matrix of interior-point methods on assemblies: springs at the joints between rigid blocks, and along ties."""

from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from extrados.core.limit import BandFactor
from extrados.limit.systems import Sparse
from extrados.model.geometry.assembly import GROUND

WIDEST = 300  # equations from the diagonal to which a symmetric matrix is factored as a band: beyond, sparse is faster


class Factor(Protocol):
    """A matrix that systems of equations can be solved with."""

    def solve(self, right: np.ndarray) -> np.ndarray: ...


class Ordered:
    """The factor of a band whose equations stand in an order of their own."""

    def __init__(self, band: np.ndarray, order: np.ndarray):
        self._factor, self._order = BandFactor(band), order

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x of K x = right."""
        x = np.empty(len(right))
        x[self._order] = self._factor.solve(right[self._order])
        return x


class NormalMatrix:
    """E S E' + P D P' over the twists of the blocks: E the equations of the corner forces, S (joints, 3, 3) at the joints, P
    those of forces that answer to movement, D (forces) on its diagonal.

    The places of its entries are found once; every S then only sums numbers into them.
    """

    def __init__(self, system: Sparse):
        assembly = system.assembly
        self.size = system.equations
        self._wrench = system.wrench  # (joints, corner, equation) on block a
        row, column, joint, sign = [], [], [], []
        blocks = (assembly.a, assembly.b)
        for one, ends in enumerate(blocks):
            for two, others in enumerate(blocks):
                held = np.flatnonzero((ends != GROUND) & (others != GROUND))
                joint.append(held)
                row.append(ends[held])
                column.append(others[held])
                sign.append(np.full(len(held), 1.0 if one == two else -1.0))
        self._joint, self._sign = np.concatenate(joint), np.concatenate(sign)
        if (answers := system.loads.resistance) is not None:  # every part of a force with every other, and itself
            part, other = np.nonzero(answers.number[:, None] == answers.number)
            row.append(answers.block[part])
            column.append(answers.block[other])
            wrench = answers.wrench / system.unit
            self._of, self._outer = answers.number[part], wrench[part, :, None] * wrench[other, None, :]
        self._block_row, self._block_column = np.concatenate(row), np.concatenate(column)

    def _values(self, spring: np.ndarray, answer: np.ndarray, shift: float) -> np.ndarray:
        """The numbers that sum to its entries: 3 x 3 by pairs of blocks, then the diagonal."""
        wrench = self._wrench
        product = np.matmul(wrench.transpose(0, 2, 1), np.matmul(spring, wrench))
        values = [(product[self._joint] * self._sign[:, None, None]).ravel()]
        if len(answer):
            values.append((answer[self._of, None, None] * self._outer).ravel())
        return np.concatenate([*values, np.full(self.size, shift)])

    def _places(self, rank: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Row and column of each of these numbers where block b is the rank[b]-th."""
        inner, diagonal = np.arange(3), np.arange(self.size)
        shape = (len(self._block_row), 3, 3)
        row = np.broadcast_to(3 * rank[self._block_row][:, None, None] + inner[:, None], shape)
        column = np.broadcast_to(3 * rank[self._block_column][:, None, None] + inner, shape)
        return np.concatenate([row.ravel(), diagonal]), np.concatenate([column.ravel(), diagonal])

    @cached_property
    def _pattern(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where each number goes among the entries, and the rows and starts of these by columns."""
        row, column = self._places(np.arange(self.size // 3))
        places, where = np.unique(column.astype(np.int64) * self.size + row, return_inverse=True)
        start = np.searchsorted(places, np.arange(self.size + 1, dtype=np.int64) * self.size)
        return where, (places % self.size).astype(np.int32), start.astype(np.int32)

    @cached_property
    def _band(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        """Order of the equations by which blocks that touch are near each other (reverse Cuthill and McKee); which numbers
        lie in the lower triangle, where in its band, and how many equations that goes down from the diagonal."""
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        blocks = self.size // 3
        pairs = np.ones(len(self._block_row), dtype=np.int8), (self._block_row, self._block_column)
        order = reverse_cuthill_mckee(sparse.csr_array(pairs, shape=(blocks, blocks)), symmetric_mode=True)
        rank = np.empty(blocks, dtype=np.int64)
        rank[order] = np.arange(blocks)
        row, column = self._places(rank)
        lower = np.flatnonzero(row >= column)
        row, column = row[lower], column[lower]
        width = int((row - column).max())
        return (3 * order[:, None] + np.arange(3)).ravel(), lower, column * (width + 1) + row - column, width

    def factor(self, spring: np.ndarray, answer: np.ndarray, shift: float, *, symmetric: bool, positive: bool) -> Factor:
        """The factor of the matrix of springs (joints, 3, 3), `answer` (forces) and `shift` on the diagonal; RuntimeError where
        it has none. symmetric: the springs are; positive: `shift` is enough to keep them so."""
        values = self._values(spring, answer, shift)
        if positive:
            order, lower, where, width = self._band
            if width <= WIDEST:
                band = np.bincount(where, weights=values[lower], minlength=self.size * (width + 1))
                return Ordered(band.reshape(self.size, width + 1), order)
        from scipy.sparse.linalg import splu  # takes a tenth of a second to load, and most sections do without

        where, rows, start = self._pattern
        data = np.bincount(where, weights=values, minlength=len(rows))
        # Without pivots where there is symmetry: positive then, and twice as fast.
        return splu(
            sparse.csc_array((data, rows, start), shape=(self.size, self.size)),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0 if symmetric else 0.01,
            options={"SymmetricMode": symmetric},
        )
