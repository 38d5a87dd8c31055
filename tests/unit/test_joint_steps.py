"""Joints in equilibrium iterations: Coulomb's law in any direction of the joint, its energy, load reversal."""

from typing import Any

import numpy as np
import pytest

import extrados
from extrados.schema.constants import GRAVITY

WALLS = [
    {"name": n, "start": s, "end": e, "thickness": 0.3}
    for n, s, e in (("a", [0, 0], [4, 0]), ("b", [4, 0], [4, 4]), ("c", [4, 4], [0, 4]), ("d", [0, 4], [0, 0]))
]
BRICK = {"density": 1800, "young": 1.7e9, "poisson": 0.0, "tensile_strength": 1e6, "fracture_energy": 500}
SOLE = {"friction": 0.4, "cohesion": 1e3, "shear_energy": 1.0, "tension": 1e3, "fracture_energy": 0.1}
WEIGHT, FEET = 1800 * GRAVITY * 16.0 * 0.3 * 3.0, 16.0 * 0.3


def box(**more: Any) -> Any:
    """4 x 4 x 3 m on a bed joint under all walls, hardly cracking."""
    structure = {"kind": "building", "storeys": [3.0], "walls": WALLS, "beds": [{"name": "sole"}]}
    push = {"kind": "pushover", "mesh": {"size": 1.0, "layers": 3}, "target_displacement": 6e-3, **more}
    deck = {"structure": structure, "material": BRICK, "joints": SOLE, "analysis": [push]}
    return extrados.run(deck).results[0]


@pytest.mark.parametrize("direction", [0.0, 45.0])
def test_a_box_slides_on_its_sole_by_coulombs_law(direction: float) -> None:
    """Walls along and across the push slide alike: friction on the weight, and what is left of the cohesion on all feet.

    A limit for each direction of its own would carry 1.4 times as much at 45 degrees."""
    found = box(direction=direction)
    load = np.asarray(found["event_load"])
    assert WEIGHT == pytest.approx(found.results.weight_N)
    assert 0.4 * WEIGHT <= load.max() <= 1.03 * (0.4 * WEIGHT + 1e3 * FEET)
    assert load[-1] == pytest.approx(0.4 * WEIGHT, rel=2e-3)  # 2 mm of slip have taken the bond
    assert found.results.capacity_N == pytest.approx(load.max())
    assert all(row.last_slip_m == pytest.approx(6e-3, rel=0.12) for row in found.results.joints)  # also those across
    assert found.results.unbalanced_steps == 0 and found.results.step_balance_ratio < 0.02


COUPLET = {
    "structure": {
        "kind": "blocks",
        "depth": 0.1,
        "block": [
            {"name": "lower", "points": [[0.0, 0.0], [0.2, 0.0], [0.2, 0.05], [0.0, 0.05]]},
            {"name": "upper", "points": [[0.0, 0.05], [0.2, 0.05], [0.2, 0.1], [0.0, 0.1]]},
        ],
    },
    "material": {"density": 0.0, "young": 16.7e9, "poisson": 0.15},
    "joints": {
        "friction": 0.75,
        "cohesion": 0.87e6,
        "shear_energy": 58.0,
        "tension": 0.5e6,
        "fracture_energy": 20.0,
        "normal_stiffness": 82e9,
        "shear_stiffness": 36e9,
        "types": [{"joints": ["ground"], "friction": "no-sliding", "tension": 1e8, "fracture_energy": 1e9}],
    },
}


def couplet(ways: list[float], **more: Any) -> Any:
    """Two bricks under 0.5 MPa, their joint sheared to one displacement after the other [m]."""
    stages = [
        {
            "reference": [{"kind": "displacement", "direction": "x", "parts": [{"y": [0.06, 0.1], "ratio": float(np.sign(way))}]}],
            "target_displacement": abs(way),
        }
        for way in ways
    ]
    analysis = {
        "kind": "sla",
        "constant": [{"kind": "pressure", "edge": "top", "value": 0.5e6}],
        "overshoot": False,
        "ripple": 0.05,
        "mesh": {"size": 0.01},
        "stages": stages,
        **more,
    }
    return extrados.run({**COUPLET, "analysis": [analysis]}).results[0]


def test_steps_follow_a_joint_as_events_do() -> None:
    """The same softening by teeth and without, from the first loss of equilibrium on, and the friction at the end."""
    steps, events = couplet([0.6e-3]), couplet([0.6e-3], without_equilibrium="load-unload")
    assert steps.results.stages[0].equilibrium_steps > 20
    way, load = (np.asarray(steps[f"event_{name}"]) for name in ("displacement", "load"))
    other, its_load = (np.asarray(events[f"envelope_{name}"]) for name in ("displacement", "load"))
    at = np.array([0.12e-3, 0.2e-3, 0.3e-3])
    assert np.interp(at, way, load) == pytest.approx(np.interp(at, other, its_load), rel=0.04)
    assert load[-1] == pytest.approx(0.75 * 0.5e6 * 0.02, rel=2e-3)


def test_a_sheared_joint_has_the_hysteresis_of_friction() -> None:
    """Under load reversal slip stays: each cycle of amplitude A costs 4 F (A - F / k), F the friction, k the elastic stiffness."""
    amplitude, friction = 0.5e-3, 0.75 * 0.5e6 * 0.02
    found = couplet([amplitude, -amplitude, amplitude, -amplitude])
    stages = found.results.stages
    stiff = found["stage_1_event_load"][0] / found["stage_1_event_displacement"][0]
    for stage in stages[1:]:
        assert stage.end_load_N == pytest.approx(friction, rel=1e-3)
        assert stage.start_load_N == pytest.approx(-friction, rel=2e-3)
    cycle = stages[3].dissipated_energy_J - stages[1].dissipated_energy_J
    assert cycle == pytest.approx(4.0 * friction * (amplitude - friction / stiff), rel=0.01)
    assert all(stage.step_balance_ratio < 0.02 for stage in stages)
