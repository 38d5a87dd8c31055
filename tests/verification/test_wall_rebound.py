"""What throws a facade back from the wall behind it: three impacts beside discrete elements."""

import numpy as np
import pytest

import extrados
from extrados.model.properties import Supports
from extrados.model.structures.block import Block
from extrados.views.building import Building

pytestmark = pytest.mark.verify

WIDTH, HEIGHT = 0.6, 3.0


def rebound(friction: float, stiffness: float, damping_ratio: float) -> float:
    """Root of the energy at the second crest away from the wall over that at the first, after a pulse; elements between a
    ground and a wall of one joint each."""
    run = extrados.run(
        {
            "structure": {
                "kind": "blocks",
                "block": [{"name": "facade", "points": [[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]]}],
                "ground": [[0, 0, WIDTH, 0], [0, HEIGHT, 0, 0]],
            },
            "joints": {"friction": friction, "normal_stiffness": stiffness, "damping_ratio": damping_ratio},
            "motion": {"kind": "sine-pulse", "amplitude": f"{-3.0 * WIDTH / HEIGHT} g", "period": 0.5},
            "analysis": [{"kind": "dem", "end_time": 3.0, "output_step": 0.001}],
        },
        threads=1,
    )
    time, q = run.array("dem", "time"), run.array("dem", "rotation")[:, 0]
    alpha = np.arctan(WIDTH / HEIGHT)
    height = np.cos(alpha - q) - np.cos(alpha)
    crest = np.flatnonzero((q[1:-1] >= q[:-2]) & (q[1:-1] > q[2:]) & (q[1:-1] > 5e-4) & (time[1:-1] > 0.5)) + 1
    if len(crest) < 2:
        return 0.0
    return float(np.sqrt(max(height[crest[1]], 0.0) / height[crest[0]]))


def test_elements_are_thrown_back_less_than_by_three_impacts() -> None:
    block = Block(kind="block", width=WIDTH, height=HEIGHT)
    three = Building(block, supports=Supports(abutting_wall="left")).rocker().restraints.rebound[0]
    springy, damped = [], []
    for friction in (0.3, 2.0, 10.0):
        for stiffness in (1e9, 1e10, 1e11):
            springy.append(rebound(friction, stiffness, 0.05))
            damped.append(rebound(friction, stiffness, 1.0))
            print(
                f"friction {friction:g}, {stiffness:g} Pa/m: 5 % of critical {springy[-1]:.3f}, critical {damped[-1]:.3f}"
            )
    print(f"three impacts {three:.3f}")
    assert max(damped) < 0.05
    assert 0.1 < min(springy)
    assert max(springy) < three
