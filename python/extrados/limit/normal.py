"""The matrix of interior-point methods on assemblies: springs at the joints between rigid blocks, and along ties."""

from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from extrados.building.geometry.assembly import GROUND
from extrados.limit.systems import Sparse

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU

SHIFT = 1e-13  # keeps the factor alive where a block hangs by an edge; far below the weights that matter


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
        block_row, block_column = np.concatenate(row), np.concatenate(column)
        inner = np.arange(3)
        rows = np.broadcast_to(3 * block_row[:, None, None] + inner[:, None], (len(block_row), 3, 3)).ravel()
        columns = np.broadcast_to(3 * block_column[:, None, None] + inner, (len(block_row), 3, 3)).ravel()
        diagonal = np.arange(self.size)
        key = np.concatenate([columns, diagonal]).astype(np.int64) * self.size + np.concatenate([rows, diagonal])
        places, where = np.unique(key, return_inverse=True)
        self._where, self._count = where, len(places)
        self._indices = (places % self.size).astype(np.int32)
        self._indptr = np.searchsorted(places, np.arange(self.size + 1, dtype=np.int64) * self.size).astype(np.int32)
        self._shift = np.full(self.size, SHIFT)

    def matrix(self, spring: np.ndarray, answer: np.ndarray) -> sparse.csc_array:
        """The matrix of springs (joints, 3, 3), not necessarily symmetric, and `answer` (forces), with a hair on its diagonal."""
        wrench = self._wrench
        product = np.matmul(wrench.transpose(0, 2, 1), np.matmul(spring, wrench))
        values = [(product[self._joint] * self._sign[:, None, None]).ravel()]
        if len(answer):
            values.append((answer[self._of, None, None] * self._outer).ravel())
        data = np.bincount(self._where, weights=np.concatenate([*values, self._shift]), minlength=self._count)
        return sparse.csc_array((data, self._indices, self._indptr), shape=(self.size, self.size))

    def factor(self, spring: np.ndarray, answer: np.ndarray, symmetric: bool) -> "SuperLU":
        """Its factor; RuntimeError where it has none."""
        from scipy.sparse.linalg import splu  # takes a tenth of a second to load, and most sections do without

        # Without pivots where there is symmetry: positive then, and twice as fast.
        pivot = 0.0 if symmetric else 0.01
        return splu(
            self.matrix(spring, answer),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=pivot,
            options={"SymmetricMode": symmetric},
        )
