"""Small linear programmes in the core (fortran/limit): few unknowns, many rows."""

import numpy as np

from extrados import _core


def least_vertex(
    rows: np.ndarray, least: np.ndarray, cost: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Minimise cost . x with rows (k, n) x >= least and low <= x <= high, all finite: x (n), the multipliers of the rows (k)
    and of the box (n), negative at its upper side. None where another method must decide.

    rows must be contiguous, whose transpose is then what the core takes.
    """
    k, n = rows.shape
    if len(least) != k or not len(cost) == len(low) == len(high) == n:
        raise ValueError(
            f"{k} rows of {n} unknowns do not go with {len(least)} and {len(cost)}, {len(low)}, {len(high)}"
        )
    x, multipliers, sides, solved = _core.api_limit.vertex(rows.T, least, cost, low, high)
    return (x, multipliers, sides) if solved else None
