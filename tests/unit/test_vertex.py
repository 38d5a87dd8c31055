"""The core's dual simplex of few unknowns against HiGHS."""

import numpy as np
import pytest
from scipy.optimize import linprog

from extrados.core.limit import least_vertex


def programme(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rows, least values, cost and box: round numbers (degenerate), rows through the origin and fixed unknowns among them."""
    draw = np.random.default_rng(seed)
    n, k = int(draw.integers(2, 20)), int(draw.integers(3, 120))
    rows = draw.normal(size=(k, n))
    rows = np.round(rows) if seed % 3 == 0 else rows
    least = np.zeros(k) if seed % 4 == 0 else draw.normal(size=k) - 1.0
    cost = draw.normal(size=n) if seed % 2 else np.eye(n)[-1]
    low, high = np.full(n, -1e5), np.full(n, 1e5)
    if seed % 5 == 0:
        low[-1] = high[-1] = 0.3
    return rows, least, cost, low, high


def test_least_cost_and_multipliers() -> None:
    solved = 0
    for seed in range(120):
        rows, least, cost, low, high = programme(seed)
        found = least_vertex(rows, least, cost, low, high)
        peer = linprog(cost, A_ub=-rows, b_ub=-least, bounds=list(zip(low, high, strict=True)), method="highs")
        assert (found is not None) is (peer.status == 0), seed
        if found is None:
            continue
        solved += 1
        x, multipliers, sides = found
        assert cost @ x == pytest.approx(peer.fun, rel=1e-9, abs=1e-7), seed
        assert (rows @ x - least).min() > -1e-9 and (x >= low - 1e-9).all() and (x <= high + 1e-9).all()
        assert multipliers.min() >= 0.0 and rows.T @ multipliers + sides == pytest.approx(cost, abs=1e-8)
        value = multipliers @ least + np.maximum(sides, 0.0) @ low + np.minimum(sides, 0.0) @ high
        assert value == pytest.approx(cost @ x, rel=1e-8, abs=1e-6), seed  # strong duality
    assert solved > 40


def test_rows_that_contradict_each_other_are_left_to_others() -> None:
    rows = np.array([[1.0, 0.0], [-1.0, 0.0]])
    assert least_vertex(rows, np.array([1.0, 0.0]), np.ones(2), np.full(2, -9.0), np.full(2, 9.0)) is None


def test_sizes_that_do_not_go_together_are_refused() -> None:
    with pytest.raises(ValueError, match="2 rows of 2 unknowns"):
        least_vertex(np.eye(2), np.zeros(3), np.ones(2), np.zeros(2), np.ones(2))
