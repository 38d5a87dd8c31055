"""Kinematic analysis of local mechanisms: by hand, by the finite motion, and against what rocks."""

import numpy as np
import pytest

import extrados
from extrados.analyses.codes.code_rules import more_piers
from extrados.analyses.codes.kinematics import Overturning, Push, Weight, capacity
from extrados.schema.constants import GRAVITY


def test_the_capacity_curve_is_the_work_of_a_finite_rotation() -> None:
    """Potential energy of weights and pushes over a path gives the same multiplier, by differences."""
    body = Overturning((Weight(70e3, 0.3, 3.0), Weight(12e3, 0.4, 5.0, sways=False)), (Push(1e3, 6.0), Push(-2e3, 5.5)))

    def work(q: float) -> tuple[float, float]:
        up = sum(w.weight * (w.arm * np.sin(q) + w.height * np.cos(q)) for w in body.weights)
        out = sum(p.force * p.height * np.sin(q) for p in body.pushes)
        side = sum(w.weight * (w.height * np.sin(q) - w.arm * np.cos(q)) for w in body.weights if w.sways)
        return up - out, side

    for q in (0.0, 0.03, 0.06):
        (u1, s1), (u2, s2) = work(q - 1e-6), work(q + 1e-6)
        assert body.multiplier(q) == pytest.approx((u2 - u1) / (s2 - s1), rel=1e-6)
    end = body.ultimate()
    assert body.multiplier(end) == pytest.approx(0.0, abs=1e-12) and body.multiplier(0.9 * end) > 0.0


def test_a_single_block_is_what_the_rocking_block_is() -> None:
    b, h = 1.0, 5.0
    block = Overturning((Weight(2000.0 * GRAVITY * b * h, 0.5 * b, 0.5 * h),))
    weight, displacement = block.swaying
    found = capacity(block.multiplier(), weight, displacement, block.ultimate())
    assert (
        found.alpha0 == pytest.approx(b / h)
        and found.part == pytest.approx(1.0)
        and found.mass == pytest.approx(2000.0 * b * h)
    )
    assert found.d0 == pytest.approx(0.5 * h * np.arctan(b / h))
    rocking = {"structure": {"kind": "block", "width": b, "height": h}, "analysis": {"kind": "tilt"}}
    assert extrados.run(rocking)["tilt"].collapse_acceleration_g == pytest.approx(found.alpha0)


def mechanism(**keys) -> object:
    return extrados.run({"material": {"density": 2000.0}, "analysis": {"kind": "local-mechanism", **keys}})


def test_the_buildings_own_mechanism_is_that_of_the_table_where_both_are_known() -> None:
    table = mechanism(mechanism="wall", height=5.0, thickness=1.0)["local-mechanism"]
    deck = {
        "structure": {"kind": "column", "width": 1.0, "height": 5.0, "drums": 1},
        "analysis": {"kind": "local-mechanism", "mechanism": "building"},
    }
    own = extrados.run(deck)["local-mechanism"]
    for key in ("multiplier", "participating_mass_kg", "activation_acceleration_g", "zero_displacement_m"):
        assert own[key] == pytest.approx(table[key], rel=1e-6), key


def test_what_holds_and_what_pushes_moves_the_multiplier_the_right_way() -> None:
    base = {"mechanism": "facade", "height": 6.0, "thickness": 0.6}
    bare = mechanism(**base)["local-mechanism"].multiplier
    assert bare == pytest.approx(0.1)
    tied = mechanism(**base, ties=[{"height": 6.0, "force": 1e3}])["local-mechanism"].multiplier
    assert tied - bare == pytest.approx(1e3 * 6.0 / (2000.0 * GRAVITY * 0.6 * 6.0 * 3.0))
    pushed = mechanism(**base, floors=[{"height": 6.0, "thrust": 1e3}])["local-mechanism"].multiplier
    assert bare - pushed == pytest.approx(tied - bare)
    above = mechanism(**base, hinge_height=3.0)["local-mechanism"].multiplier
    assert above == pytest.approx(0.2), "a crack half way up: half the height turns"
    held = mechanism(**base, floors=[{"height": 6.0, "load": 1e4, "sways": False}])["local-mechanism"].multiplier
    carried = mechanism(**base, floors=[{"height": 6.0, "load": 1e4}])["local-mechanism"].multiplier
    assert held > bare > carried
    assert mechanism(**base, side_walls={"thickness": 0.5, "crack_angle": 20.0})["local-mechanism"].multiplier > bare
    crushed = extrados.run(
        {"material": {"density": 2000.0, "compressive_strength": 1e6}, "analysis": {"kind": "local-mechanism", **base}}
    )
    setback = 2.0 * 2000.0 * GRAVITY * 0.6 * 6.0 / (3.0 * 1e6)
    assert crushed["local-mechanism"].multiplier == pytest.approx((0.3 - setback) / 3.0)


def test_a_corner_says_that_its_stone_does_not_crush() -> None:
    corner = {"kind": "local-mechanism", "mechanism": "corner", "height": 6.0, "thickness": 0.5, "crack_angle": 30.0}
    hard, soft = (
        extrados.run({"material": material, "analysis": corner}).analyses[0]
        for material in ({}, {"compressive_strength": 1e5})
    )
    assert soft["results"]["multiplier"] == hard["results"]["multiplier"]
    assert not hard["warnings"] and any("did not crush" in text for text in soft["warnings"])


def test_refusals_name_what_is_missing() -> None:
    (told,) = mechanism(mechanism="gable", height=3.0, thickness=0.4).analyses
    assert told["status"] == "refused" and "needs width" in told["reason"]
    (told,) = mechanism(
        mechanism="facade", height=6.0, thickness=0.6, floors=[{"height": 6.0, "thrust": "10 kN"}]
    ).analyses
    assert told["status"] == "refused" and "does not stand at rest" in told["reason"]
    (told,) = mechanism(mechanism="building").analyses
    assert told["status"] == "refused" and "[structure]" in told["reason"]


def test_the_worked_example_of_a_pier() -> None:
    """Advanced Design Examples of Seismic Retrofit of Structures, after Eq. 2.31: 0.9 (10883 + 0.5 2864) 0.93/1.8 = 5726 kg."""
    rows = more_piers(0.93, 1.8, 0.35, 10883.0 * GRAVITY, 2864.0 * GRAVITY, 5e6, 0.1e6, 0.4, 0.05e6, double=True)
    found = {x.rule: x.capacity for x in rows}
    assert found["ASCE 41 rocking of a pier"] / GRAVITY == pytest.approx(5726.0, abs=1.0)
    load = (10883.0 + 2864.0) * GRAVITY
    assert found["EN 1998-3 flexure"] == pytest.approx(0.93 * load / 1.8 * (1.0 - 1.15 * load / (0.93 * 0.35) / 5e6))
    assert found["NTC diagonal cracking"] == pytest.approx(
        0.93 * 0.35 * 75e3 / 1.5 * np.sqrt(1.0 + load / (0.93 * 0.35) / 75e3)
    )
