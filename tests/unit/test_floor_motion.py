"""A structure on a floor: its motion, and every analysis under it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import extrados
from extrados.analyses.codes.parts import Part, asce41, en1998, nzsee
from extrados.analyses.conclude import MotionDemand
from extrados.analyses.context import Context
from extrados.core import motion as core_motion
from extrados.decks.reader import DeckError, make_deck
from extrados.motions import pulses
from extrados.motions.floors import Sway, on_floor, sway_of
from extrados.motions.generated import generated
from extrados.schema.constants import GRAVITY
from extrados.schema.table import FloorBelow

BELOW = {"height": 8.0, "building_height": 10.0, "building_period": 0.3, "storeys": 3}
RECORD = {"kind": "record", "file": "extrados:el-centro-1940", "scale": 0.5}
BLOCK = {"kind": "block", "width": 0.5, "height": 2.0}


def floor(**keys: object) -> FloorBelow:
    return FloorBelow(**{**BELOW, **keys})


def test_the_floor_moves_as_the_oscillator_below_it() -> None:
    """Against an integration of u'' = -a_g - 2 xi w u' - w^2 u; the part of the mode is 3 n/(2 n + 1) z/H."""
    sway = sway_of(floor())
    assert sway.part == pytest.approx(9.0 / 7.0 * 0.8)
    motion = on_floor(pulses.sine_pulse(2.0, 0.5), floor())
    ground, w = pulses.sine_pulse(2.0, 0.5), 2.0 * np.pi / 0.3

    def rate(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -float(ground.sample(np.array([t]))[0]) - 0.1 * w * y[1] - w**2 * y[0]]

    time = motion.series()[0]
    y = solve_ivp(rate, (0.0, time[-1]), [0.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-12, max_step=0.005).y
    absolute = -0.1 * w * y[1] - w**2 * y[0]
    by_hand = (1.0 - sway.part) * ground.sample(time) + sway.part * absolute
    assert np.abs(motion.series()[1] - by_hand).max() < 2e-3 * np.abs(by_hand).max()
    assert np.abs(motion.series()[1][-20:]).max() < 0.03 * motion.peak, "it swings out"


@pytest.mark.parametrize(("jurisdiction", "rule"), [("EN1998", "EN 1998-1 part of a building"), ("NZSEE", "NZSEE C8 parapet")])
def test_codes_take_the_response_to_the_motion_of_the_floor_as_it_is(jurisdiction: str, rule: str) -> None:
    """The response at the period of the part, by hand; coefficients of height are for the motion of the ground."""
    h, t = 1.2, 0.3
    table = {"kind": "local-mechanism", "mechanism": "parapet", "height": h, "thickness": t, "period": 0.1, "motion_spectrum": True}
    deck = make_deck({"code": {"jurisdiction": jurisdiction}, "motion": {**RECORD, "floor": BELOW}, "analysis": table})
    check = extrados.run(deck)["local-mechanism"].checks[rule]
    motion, slope = Context(deck).motion, 1.0 + (t / h) ** 2
    time, acceleration = motion.series()
    period = 0.1 if jurisdiction == "EN1998" else float(np.sqrt(0.65 * h * slope))
    felt = float(core_motion.response_spectra(acceleration, time[1] - time[0], [period], [0.05]).psa[0, 0])
    by_hand = felt / GRAVITY if jurisdiction == "EN1998" else 1.5 / slope * felt * (period / (2.0 * np.pi)) ** 2
    assert check.demand == pytest.approx(by_hand) and "response to the motion of the floor" in check.note


def test_a_stiff_building_moves_with_the_ground() -> None:
    ground = np.sin(np.arange(400) * 0.01 * 6.0)
    moved = Sway(0.01, 0.05, 1.3).accelerations(ground, 0.001)
    assert moved[200:] == pytest.approx(ground[200:], abs=0.05), "once the start has died out"


def test_every_strategy_takes_the_motion_of_the_floor() -> None:
    asked = {"kind": "assess", "strategies": ["tilt", "rocking", "assessment", "code-checks"], "budget": 5.0}
    low, high = (extrados.run({"structure": BLOCK, "motion": {**RECORD, **more}, "analysis": asked}) for more in ({}, {"floor": BELOW}))
    rows = [{v.strategy: v for v in r["assess"].verdicts} for r in (low, high)]
    peak = high["assess"].hazard.peak_ground_acceleration_g
    assert peak > 1.5 * low["assess"].hazard.peak_ground_acceleration_g
    assert "floor" in high["assess"].hazard.peak_told
    assert rows[1]["tilt"].demand == pytest.approx(peak)
    assert low["rocking"].outcome == "no-hinging" and high["rocking"].outcome != "no-hinging"
    assert abs(high["assessment"].primary_impulse.amplitude_g) > abs(low["assessment"].primary_impulse.amplitude_g)
    checks = high["code-checks"].checks
    assert checks["NTC activation (on its floor)"].demand == pytest.approx(peak), "not amplified again"
    # with the spectrum of a code the floor spectrum is the demand, by the same building
    site = {"code": "EN1998-1", "ground": "B", "acceleration": "0.15 g"}
    coded = {"structure": BLOCK, "motion": {**RECORD, "floor": BELOW}, "analysis": {"kind": "code-checks", "spectrum": site}}
    demand = extrados.run(coded)["code-checks"].checks["NTC activation (at height z)"].demand
    assert demand == pytest.approx(2.5 * 0.18 * 9.0 / 7.0 * 0.8 * np.sqrt(1.01))
    table = {"kind": "local-mechanism", "mechanism": "building", "spectrum": site}
    own = extrados.run({**coded, "analysis": table})["local-mechanism"]
    assert own.base_height_m == 8.0 and own.floor_acceleration_g == pytest.approx(demand)


def test_sets_of_motions_stand_on_the_floor_too() -> None:
    keys = {"kind": "generated", "mmi": 7.0, "duration": 6.0, "seed": 3}
    ask = {"kind": "fragility", "count": 6}
    low, high = (
        extrados.run({"structure": BLOCK, "motion": {**keys, **more}, "analysis": ask})["fragility"] for more in ({}, {"floor": BELOW})
    )
    assert high.median_pga_g > 1.5 * low.median_pga_g
    made = generated(7.0, 6.0, seed=3).batch(0, 2)
    moved = sway_of(floor()).accelerations(made, 0.01)
    single = extrados.run({"motion": {**keys, "floor": BELOW, "member": 2}, "analysis": {"kind": "motion", "count": 2}})
    assert single is not None and np.abs(moved[1]).max() > np.abs(made[1]).max()
    spectrum = {"kind": "compatible", "code": "EN1998-1", "ground": "B", "acceleration": "0.1 g", "duration": 8.0, "tolerance": 0.3}
    low, high = (
        Context(make_deck({"structure": BLOCK, "motion": {**spectrum, **more}, "analysis": {"kind": "tilt"}})).motion.peak
        for more in ({}, {"floor": BELOW})
    )
    assert high > 1.5 * low


def test_a_floor_above_the_top_of_its_building_is_refused() -> None:
    with pytest.raises(DeckError, match="above the top of the building"):
        make_deck({"structure": BLOCK, "motion": {**RECORD, "floor": {**BELOW, "height": 12.0}}, "analysis": {"kind": "rocking"}})


def test_the_floor_spectrum_of_the_code_bounds_the_response_of_oscillators_on_the_floor() -> None:
    """A motion that matches S_e, filtered by the building: its spectrum below T_1 lies near [C7.2.6], which is an envelope of one mode."""
    from extrados.analyses.codes import ntc
    from extrados.motions.code_spectra import en1998
    from extrados.motions.compatible import CompatibleSet

    target = en1998(1, "B", 0.15 * GRAVITY)
    made = CompatibleSet(target, 0.05, 0.05, 2.0, 0.15, 15.0, 0.01, 1).ground(0).samples
    moved = sway_of(floor()).accelerations(made, 0.01)
    code = ntc.floor(lambda t, xi: float(target(np.array([t]))[0]), 8.0, 10.0, 3, 0.3)
    periods = [0.1, 0.3, 0.6]
    psa = core_motion.response_spectra(moved[0], 0.01, periods, [0.05]).psa[0]
    ratio = psa / [code(t, 0.05) for t in periods]
    assert (0.5 < ratio).all() and (ratio < 1.6).all(), ratio


def test_a_pulse_of_the_ground_is_no_pulse_of_the_floor() -> None:
    """The demand of an analysis that knows pulses is the floor's motion: its peak, and no pulse."""
    sine = {"kind": "sine-pulse", "amplitude": "0.15 g", "period": 0.4}
    free, held = (
        MotionDemand(Context(make_deck({"structure": BLOCK, "motion": {**sine, **more}, "analysis": {"kind": "tilt"}})))
        for more in ({}, {"floor": BELOW})
    )
    assert free.pulse == "sine" and held.pulse == "" and held.peak_g > free.peak_g


def test_an_assessment_takes_the_action_of_its_code() -> None:
    code = {"jurisdiction": "NTC", "ground": "B", "accelerations": ["0.1 g"]}
    asked = {"kind": "assess", "strategies": ["code-checks"], "budget": 5.0}
    run = extrados.run({"structure": BLOCK, "motion": RECORD, "code": code, "analysis": asked})
    (row,) = run["assess"].verdicts
    assert "action of [code]" in row.parameters and run["code-checks"].peak_ground_acceleration_g == pytest.approx(0.12)


def test_rules_that_the_motion_of_one_floor_does_not_answer_say_so() -> None:
    """Without T_a no response of the part; a wall between two floors; S_X1 is of the ground."""
    part = Part("parapet", 0.25, 1.2, 0.3, 8.0, 10.0, shaken=True)
    wall = replace(part, element="vertical-bending", weight=1e4)
    told = [
        (en1998(part, 3.0, spectrum=lambda t, xi: 3.0)[0], "T_a is not known"),
        (nzsee(wall, lambda t, xi: 3.0)[1], "floor above moves differently"),
    ]
    for line, words in told:
        assert line.verdict == "not-applicable" and line.demand is None and words in line.barred
    (_, parapet) = asce41(part, None, "top")
    assert "motion of a floor, not of the ground" in parapet.note and parapet.verdict not in ("holds", "fails")
