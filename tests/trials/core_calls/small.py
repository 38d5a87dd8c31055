"""Calls of the functions that keep nothing."""

from typing import Any

import numpy as np

from core_calls.given import BOX, Calls
from extrados.core import arch, limit, mechanism, sla


def small(
    mass,
    centroid,
    inertia,
    joint,
    hinge,
    opposite,
    before,
    after,
    alpha,
    beta,
    a,
    b,
    kind,
    points,
    connect,
    force,
    band,
    right,
    rows,
    least,
    cost,
    low,
    high,
    arms,
    row,
    width,
    springs,
    sides,
) -> Any:
    """The functions that keep nothing."""
    stiffness = limit.SpringBand(np.array(arms), np.array(row), 4, width)
    stiffness.lay(np.array(springs))
    solved = stiffness.solve(np.array(sides)) if stiffness.factor() else None
    return (
        arch.restitution(mass, centroid, inertia, joint, hinge, opposite),
        mechanism.restitution(mass, inertia, before, after),
        sla.intervals(alpha, beta, a, b),
        sla.body_force(kind, points, BOX, connect, force),
        sla.teeth(sla.Softening(1e5, 50.0), alpha, beta),
        sla.largest_band(sla.Softening(1e5, 50.0), alpha),
        limit.BandFactor(np.array(band)).solve(right),
        limit.least_vertex(rows, least, cost, low, high),
        solved,
    )


def calls(rng: np.random.Generator) -> Calls:
    return [
        (
            small,
            dict(
                mass=np.ones(3),
                centroid=rng.normal(size=(3, 2)),
                inertia=np.ones(3),
                joint=np.array([0, 1, 2, 3]),
                hinge=rng.normal(size=(4, 2)),
                opposite=rng.normal(size=(4, 2)),
                before=rng.normal(size=(3, 3)),
                after=rng.normal(size=(3, 3)),
                alpha=1e9,
                beta=0.5,
                a=np.ones((2, 3)),
                b=np.ones((2, 3)),
                kind="Q4",
                points=(2, 2),
                connect=[[0, 1, 2, 3]],
                force=[[0.0, 1.0]],
                band=np.tile([4.0, 1.0, 0.5], (12, 1)),
                right=np.ones(12),
                rows=np.array([[1.0, 2.0], [3.0, 1.0]]),
                least=np.array([2.0, 3.0]),
                cost=np.array([1.0, 1.0]),
                low=np.zeros(2),
                high=np.full(2, 9.0),
                arms=rng.normal(size=(3, 2, 3)),
                row=np.array([[0, 1, 2], [1, 2, 3], [0, 2, -1]]),
                width=2,
                springs=np.tile(np.eye(2), (3, 1, 1)),
                sides=np.ones((2, 4)),
            ),
        )
    ]
