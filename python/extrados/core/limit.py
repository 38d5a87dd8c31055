"""Limit analysis in the core (fortran/limit): linear programmes of few unknowns and many rows; systems of banded equations."""

import numpy as np

from extrados import _core
from extrados.core.errors import check, status_code


def least_vertex(
    rows: np.ndarray, least: np.ndarray, cost: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Minimise cost . x with rows (k, n) x >= least and low <= x <= high, all finite: x (n), the multipliers of the rows (k)
    and of the box (n), negative at its upper side. None where another method must decide.

    rows must be contiguous, whose transpose is then what the core takes.
    """
    k, n = rows.shape
    if len(least) != k or not len(cost) == len(low) == len(high) == n:
        raise ValueError(f"{k} rows of {n} unknowns do not agree with the lengths {len(least)} and {len(cost)}, {len(low)}, {len(high)}")
    x, multipliers, sides, solved, status = _core.api_limit.vertex(rows.T, least, cost, low, high)
    check(status, "linear programme")
    return (x, multipliers, sides) if solved else None


class BandFactor:
    """Cholesky's factor of a symmetric positive matrix whose entries lie near its diagonal (c/sparse/band.c).

    band (n, width + 1): the lower triangle by columns, each from its diagonal down; it is used up. CoreError where the matrix
    is not positive, to rounding.
    """

    def __init__(self, band: np.ndarray):
        if band.ndim != 2 or not band.size or band.dtype != np.float64 or not band.flags.c_contiguous:
            raise ValueError(f"the band matrix has shape {band.shape} and type {band.dtype}; expected contiguous rows of doubles")
        self._band = band.T
        check(_core.api_limit.factor_band(self._band), "factor of a band")

    def solve(self, right: np.ndarray) -> np.ndarray:
        """The x (n) of K x = right."""
        if right.shape != self._band.shape[1:]:
            raise ValueError(f"{right.shape} values for {self._band.shape[1]} equations")
        x = np.array(right, dtype=np.float64)
        _core.api_limit.solve_band(self._band, x)
        return x


class SpringBand:
    """Stiffness of blocks on springs at their points of contact, as a band without symmetry, and its factors (fortran/limit/springs.f90).

    arms (points, d, most): forces of each point on its equations, zeros beyond their number; row (points, most): these equations,
    -1 beyond; n, width: equations, and entries of a row beside the diagonal.
    """

    def __init__(self, arms: np.ndarray, row: np.ndarray, n: int, width: int):
        if row.shape != (arms.shape[0], arms.shape[2]) or row.max(initial=-1) >= n or not 0 <= width < n:
            raise ValueError(f"equations {row.shape} and forces {arms.shape} of points do not fit {n} equations of width {width}")
        apart = np.where(row >= 0, row, row.max(axis=1, initial=-1, keepdims=True)).min(axis=1, initial=n)
        if (row.max(axis=1, initial=-1) - apart).max(initial=0) > width:
            raise ValueError(f"a point acts on equations that are further apart than {width}")
        self._arms = np.asfortranarray(arms.T, dtype=np.float64)
        self._row = np.asfortranarray(row.T + 1, dtype=np.int32)
        #: (n, 3 width + 1): entry i, j of the stiffness at [j, 2 width + i - j]
        self.band = np.zeros((n, 3 * width + 1))
        self._pivot = np.zeros(n, dtype=np.int32)

    def lay(self, springs: np.ndarray) -> None:
        """Replaces the band by the sum over the points of springs (points, d, d), forces by motions."""
        d = self._arms.shape[1]
        if springs.shape != (self._arms.shape[2], d, d):
            raise ValueError(f"springs have shape {springs.shape}, expected {(self._arms.shape[2], d, d)}")
        _core.api_limit.lay_springs(self._arms, self._row, np.ascontiguousarray(springs).T, self.band.T)

    def factor(self) -> bool:
        """Replaces the band by its factors; False where it is singular."""
        self._pivot, status = _core.api_limit.factor_springs(self.band.T)
        if status == status_code("singular"):
            return False
        check(status, "factor of a band")
        return True

    def solve(self, right: np.ndarray) -> np.ndarray:
        """The x (sides, n) of K x = right (sides, n), by the factors."""
        if right.ndim != 2 or right.shape[1] != len(self.band):
            raise ValueError(f"right-hand sides of shape {right.shape} for {len(self.band)} equations")
        x = np.array(right, dtype=np.float64, order="C")
        check(_core.api_limit.solve_springs(self.band.T, self._pivot, x.T), "solution by a band")
        return x
