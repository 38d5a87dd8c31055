"""Factors of the stiffness of blocks on springs against the dense matrix by its definition."""

import numpy as np
import pytest
from scipy import sparse

from extrados.limit.contact_points import ContactPoints
from extrados.limit.stiffness_factor import StiffnessFactor


@pytest.mark.parametrize("d", [2, 3])
def test_solutions_are_those_of_the_dense_matrix(d: int) -> None:
    draw = np.random.default_rng(d)
    n, m, k = 18, 14, 3
    forces = np.where(draw.uniform(size=(n, m * d)) < 0.4, draw.normal(size=(n, m * d)), 0.0)
    answers = np.where(draw.uniform(size=(n, k)) < 0.5, draw.normal(size=(n, k)), 0.0)
    live = np.where(np.arange(n) % 3 == 0, draw.normal(size=n), 0.0)
    points = ContactPoints(
        sparse.csr_array(forces),
        draw.normal(size=n),
        live,
        np.full(m, 0.6),
        np.zeros(m),
        np.ones(m),
        sparse.csr_array(answers),
        np.zeros((2, k)),
        1.0,
    )
    factor = StiffnessFactor(points)
    for _ in range(2):  # the second springs replace the first
        springs, share = draw.normal(size=(m, d, d)) + 3.0 * np.eye(d), draw.uniform(size=k)
        local = np.zeros((m * d, m * d))
        for i, spring in enumerate(springs):
            local[d * i : d * i + d, d * i : d * i + d] = spring
        whole = forces @ local @ forces.T + answers @ np.diag(share) @ answers.T + 0.1 * np.eye(n)
        right, short = draw.normal(size=n), draw.normal()
        assert factor.factor(springs, share, 0.1)
        assert factor.solve(right, live) == pytest.approx(np.linalg.solve(whole, np.transpose([right, live])).T, rel=1e-8, abs=1e-10)
        beside = np.block([[whole, -live[:, None]], [live[None], np.zeros((1, 1))]])
        motion, multiplier = factor.solve_beside_load(right, short)
        assert [*motion, multiplier] == pytest.approx(np.linalg.solve(beside, [*right, short]), rel=1e-8, abs=1e-10)
