"""Strengthening in comparison and report: usual interventions, anchorages, margins, and the advice of an assessment."""

import numpy as np
import pytest
from strengthen_decks import ANCHOR, NAVE, WALL, G, run

from extrados.analyses.strengthen.anchorage import check_anchorage
from extrados.analyses.strengthen.tables import Anchorage


def test_without_ties_and_changes_usual_ones_are_taken():
    r = run(
        {"structure": NAVE["structure"], "joints": NAVE["joints"], "analysis": [{"kind": "strengthen", "acceleration": "0.2 g"}]}
    ).results
    assert {one.name for one in r.interventions} == {"horizontal tie", "greater thickness", "greater buttress width"}
    wall = run({"structure": WALL, "analysis": [{"kind": "strengthen", "acceleration": "0.3 g"}]}).results
    assert {one.name for one in wall.interventions} == {
        "anchor to an existing structure behind, in tension and compression",
        "greater width",
    }
    assert wall.best is not None and wall.best.kind == "spring"


def test_the_anchorage_follows_by_hand():
    # a bar of 24 mm, plate 300 x 300 mm on a wall of 400 mm, design strengths as in the example of the reference
    given = Anchorage(
        steel_strength=235e6 / 1.05,
        plate_width=0.3,
        plate_height=0.3,
        wall_thickness=0.4,
        compressive_strength=2.6e6 / 2.7,
        shear_strength=88148.148,
        bond_length=0.5,
        bond_diameter=0.04,
        bond_strength=0.3e6,
    )
    bar, bearing, punching, pull = check_anchorage(101.2e3, given)
    assert bar.needed == pytest.approx(0.024, rel=1e-3)
    assert bearing.capacity_N == pytest.approx(86.67e3, rel=1e-3)
    assert punching.capacity_N == pytest.approx(98.73e3, rel=1e-3)
    assert pull.capacity_N == pytest.approx(0.3e6 * np.pi * 0.04 * 0.5)
    wider = Anchorage(
        plate_width=bearing.needed,
        plate_height=bearing.needed,
        compressive_strength=2.6e6 / 2.7,
        wall_thickness=0.4,
        shear_strength=88148.148,
    )
    assert check_anchorage(101.2e3, wider)[0].capacity_N == pytest.approx(101.2e3)
    enough = wider.model_copy(update={"plate_width": punching.needed, "plate_height": punching.needed})
    assert check_anchorage(101.2e3, enough)[1].capacity_N == pytest.approx(101.2e3)


def test_a_weak_anchorage_is_an_adverse_effect():
    weak = {"plate_width": "10 cm", "plate_height": "10 cm", "compressive_strength": "0.05 MPa"}
    asked = {"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [{**ANCHOR, "anchorage": weak}]}
    (one,) = run({"structure": WALL, "analysis": [asked]}).results.interventions
    assert any("bearing of the plate carries" in text for text in one.adverse)


FACADE_BESIDE_A_WALL = {
    "structure": {"kind": "block", "width": 0.6, "height": 8.0},
    "supports": {"abutting_wall": "left", "rebound": 0.4},
    "ties": [{"start": [-0.3, 7.4], "start_stone": "block", "ground": [-5.3, 7.4], "stiffness": "8 MN/m", "yield_force": "4 kN"}],
    "motion": {"kind": "record", "file": "extrados:el-centro-1940"},
}


def test_a_tie_force_that_is_varied_beside_a_wall_has_margins_at_all_values():
    """The margin of limit analysis was NaN there: `tilt` refuses an abutting wall, and does not push towards it."""
    asked = {"kind": "assess", "strategies": ["tilt", "rocking"], "vary": {"ties.0.yield_force": 0.2}, "budget": 20, "advise": False}
    result = run({**FACADE_BESIDE_A_WALL, "analysis": [asked]})
    (row,) = result.results.sensitivity
    assert (row.key, row.unit, row.base) == ("ties.0.yield_force", "N", 4000.0)
    weight, peak = 2000.0 * 0.6 * 8.0 * G, result.results.hazard.peak_ground_acceleration_g
    for margin, force in ((row.tilt_low, 3200.0), (row.tilt_base, 4000.0), (row.tilt_high, 4800.0)):
        assert margin == pytest.approx((weight * 0.3 + force * 7.4) / (weight * 4.0) / peak, rel=1e-6)
    assert not np.isnan(result.tables["sensitivity"].columns["margin_tilt"]).any()


def test_margins_neglect_what_a_strategy_cannot_consider():
    """A sibling: dampers, which limit analysis neglects, left no margin either."""
    damper = {"start": [-0.3, 7.4], "start_stone": "block", "ground": [-5.3, 7.4], "damping": "20 kN*s/m"}
    tables = {k: v for k, v in FACADE_BESIDE_A_WALL.items() if k not in ("ties", "supports")}
    asked = {"kind": "assess", "strategies": ["tilt", "rocking"], "vary": {"structure.width": 0.1}, "budget": 20, "advise": False}
    (row,) = run({**tables, "dampers": [damper], "analysis": [asked]}).results.sensitivity
    assert row.tilt_base is not None and row.tilt_low is not None and row.rocking_base is not None


def test_an_assessment_says_what_to_do():
    asked = {"kind": "assess", "strategies": ["tilt", "rocking"], "budget": 20}
    result = run({**FACADE_BESIDE_A_WALL, "analysis": [asked]})
    advice = result.results.advice
    assert advice is not None and advice.mechanism and advice.target_g == result.results.hazard.peak_ground_acceleration_g
    anchor = next(one for one in advice.interventions if one.kind == "spring")
    weight = 2000.0 * 0.6 * 8.0 * G
    height = (anchor.start_m or [0.0, 0.0])[1]
    needed = (advice.target_g * weight * 4.0 - weight * 0.3 - 4000.0 * 7.4) / height
    assert anchor.required_N == pytest.approx(needed, rel=1e-5)
    assert advice.rocking[anchor.name] == "rocks and recovers"
    assert "Strengthening." in result.answer and anchor.name in result.answer


def test_an_assessment_in_which_all_is_well_advises_nothing():
    strong = {"structure": {"kind": "block", "width": 3.0, "height": 3.0}, "motion": FACADE_BESIDE_A_WALL["motion"]}
    result = run({**strong, "analysis": [{"kind": "assess", "strategies": ["tilt"], "budget": 20}]})
    assert result.results.overall == "stands under all" and result.results.advice is None


def test_the_advice_states_the_least_tie_by_rocking():
    """With the least force rocking recovers, with 10 % less the wall overturns; the sustained peak needs far more."""
    motion = {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 1.0}
    wall = {"structure": {"kind": "block", "width": 0.5, "height": 2.0}, "joints": {"friction": 0.9}, "motion": motion}
    result = run({**wall, "analysis": [{"kind": "assess", "strategies": ["tilt", "rocking"], "budget": 60}]})
    advice = result.results.advice
    least, static = advice.by_rocking, advice.interventions[0]
    assert least.meets_target and 0.0 < least.required_N < static.required_N
    tie = {"start": static.start_m, "ground": static.end_m, "works_in": "both", "stiffness": static.stiffness_N_m}
    outcome = {
        share: run({**wall, "ties": [{**tie, "yield_force": share * least.required_N}], "analysis": [{"kind": "rocking"}]})
        for share in (1.0, 0.9)
    }
    assert outcome[1.0].verdict.outcome == "stands" and outcome[0.9].verdict.outcome == "collapses"
    assert f"{least.required_N / 1e3:.3g} kN" in advice.statement and "only for this motion" in advice.statement
