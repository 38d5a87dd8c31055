"""Limit analysis in the core (fortran/limit): linear programmes of few unknowns and many rows; systems of banded equations."""

import numpy as np

from extrados import _core
from extrados.core.errors import check


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
