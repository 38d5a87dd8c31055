"""A block with ties and dampers whose base slides: rigid contacts with the same ties follow it."""

import numpy as np
import pytest

import extrados
from extrados.schema.constants import GRAVITY

#: Outcomes of `dem` in the words of `rocking`
WORDS = {"at-rest": "no-hinging", "slid": "slid", "rocked": "recovery", "collapse": "collapse"}


def deck(width: float, height: float, friction: float, amplitude: float, period: float) -> dict:
    return {
        "structure": {"kind": "block", "width": width, "height": height},
        "joints": {"friction": friction},
        "motion": {"kind": "sine-pulse", "amplitude": f"{amplitude} g", "period": period},
    }


def line(width: float, level: float, side: int) -> dict:
    return {"start": [side * width / 2, level], "start_stone": "block", "ground": [side * (width / 2 + 4.0), level]}


def drawn(seed: int) -> tuple[dict, float]:
    """A deck with a tie, a prestressed tie or a dashpot, and its friction."""
    rng = np.random.default_rng([6, seed])

    def within(low: float, high: float) -> float:
        return float(f"{rng.uniform(low, high):.3g}")

    width = within(0.4, 1.0)
    height, friction = float(f"{width * within(2.5, 5.0):.3g}"), within(0.15, 0.4)
    given = deck(width, height, friction, float(f"{width / height * within(1.5, 4.0):.3g}"), within(0.4, 1.5))
    held = line(width, float(f"{height * within(0.5, 1.0):.3g}"), 1 if seed % 2 else -1)
    if seed % 3 == 2:
        return given | {"dampers": [held | {"name": "dashpot", "damping": within(1e3, 2e4)}]}, friction
    return given | {"ties": [held | {"name": "rod", "stiffness": within(2e5, 2e6), "prestress": 2e3 * (seed % 3)}]}, friction


@pytest.mark.parametrize("seeds", [(0, 1, 2), pytest.param(tuple(range(3, 24)), marks=pytest.mark.verify)])
def test_tied_blocks_that_slide_end_as_on_rigid_contacts_from_rest(seeds: tuple[int, ...]) -> None:
    """Outcome of each whose verdict is not open; where it only slides, the slip to 0.1 %."""
    compared = 0
    for seed in seeds:
        given, _ = drawn(seed)
        found = extrados.run(given | {"analysis": {"kind": "rocking"}}).results[0]
        over = found.results.model_dump(exclude_unset=True).get("hand_over")
        if over is None:
            assert found.verdict.outcome == "open" or found.results.required_friction <= given["joints"]["friction"]
            continue
        run = found.results.hand_over.contacts
        contacts = {"kind": "dem", "solver": "nonsmooth", "floor": 0.0, "collapse_displacement": run.collapse_displacement_m}
        rest = extrados.run(given | {"analysis": contacts}).results[0].results
        print(seed, found.results.outcome, rest.outcome, run.peak_slip_m, rest.peak_slip_m, found.verdict.outcome)
        compared += 1
        assert WORDS[rest.outcome] == found.results.outcome or rest.decided_by_last_digits or run.decided_by_last_digits, seed
        if found.results.outcome == "slid":
            assert run.peak_slip_m == pytest.approx(rest.peak_slip_m, rel=1e-3)
    assert compared >= len(seeds) // 2


def test_a_prestressed_tie_slides_at_the_force_of_coulomb() -> None:
    """At rest m a = mu m g + P if the tie pulls the way of the ground, mu m g - P if against it; 2000 kg/m^3, 1 m deep."""
    width, height, friction, amplitude, period, prestress = 1.0, 2.0, 0.2, 0.45, 1.0, 2e3
    weight = 2000.0 * GRAVITY * width * height
    for side in (1, -1):
        tie = line(width, 1.0, side) | {"name": "rod", "stiffness": 1e6, "prestress": prestress}
        given = deck(width, height, friction, amplitude, period) | {"ties": [tie], "analysis": {"kind": "rocking", "end_time": 0.3}}
        found = extrados.run(given).results[0]
        needed = friction + side * prestress / weight  # the ground moves to +x first
        assert found.results.hand_over.time_s == pytest.approx(period / (2.0 * np.pi) * np.arcsin(needed / amplitude), abs=2e-3)


def test_a_tie_that_yielded_before_is_handed_over_as_long_as_it_is() -> None:
    """It rocked, and its tie yielded, before the base slides: the permanent elongation at the end is that of contacts from rest."""
    tie = line(0.6, 2.5, 1) | {"name": "rod", "stiffness": 1e6, "yield_force": 2e3}
    given = deck(0.6, 3.0, 0.306, 0.6, 0.8) | {"ties": [tie]}
    found = extrados.run(given | {"analysis": {"kind": "rocking", "end_time": 2.0}}).results[0]
    run = found.results.hand_over.contacts
    contacts = {"kind": "dem", "solver": "nonsmooth", "floor": 0.0, "end_time": 2.0, "collapse_displacement": run.collapse_displacement_m}
    rest = extrados.run(given | {"analysis": contacts}).results[0].results
    print(found.results.hand_over.time_s, found.results.restraints, run.ties, rest.ties, run.outcome, rest.outcome)
    assert found.results.restraints[0].permanent_elongation_m > 0.0
    assert run.ties[0].plastic_elongation_m == pytest.approx(rest.ties[0].plastic_elongation_m, rel=0.01)
    assert run.peak_slip_m == pytest.approx(rest.peak_slip_m, rel=0.02)


@pytest.mark.parametrize("end", [5.9, 6.0, 6.1, 6.3])
def test_a_swing_that_reverses_at_the_end_has_not_come_to_rest(end: float) -> None:
    """Slid to +x, the block swings on its tie without loss, at 0.75 s and 46 mrad: it moves at any end."""
    tie = line(0.6, 2.5, -1) | {"name": "rod", "stiffness": 1e6}
    contacts = {"kind": "dem", "solver": "nonsmooth", "floor": 0.0, "end_time": end, "perturbed": False}
    found = extrados.run(deck(0.6, 3.0, 0.25, 0.5, 0.6) | {"ties": [tie], "analysis": contacts}).results[0]
    assert found.results.still_moving and "still move" in found.answer


@pytest.mark.parametrize("friction", [0.34, 0.36])
def test_the_step_of_output_does_not_decide_whether_a_tied_block_slides(friction: float) -> None:
    """Its toe needs the friction for some hundredths of a second only: time, requirement and outcome are the same at any step of output."""
    tie = {"name": "rod", "start": [0.0, 1.5], "start_stone": "block", "ground": [0.0, 0.0], "stiffness": 2e5, "prestress": 2e3}
    given = deck(0.5, 1.5, friction, 0.6, 0.4) | {"ties": [tie]}
    times, needed, ends = set(), set(), set()
    for step in ({}, {"output_step": 0.2}, {"output_step": 0.5}):
        found = extrados.run(given | {"analysis": {"kind": "rocking"} | step}).results[0]
        over = found.results.hand_over
        times.add(over.time_s)
        needed.add((found.results.required_friction, found.results.conditions.required_friction))
        ends.add((found.results.outcome, found.verdict.outcome))
    assert len(times) == len(needed) == len(ends) == 1
    assert found.results.conditions.required_friction > friction
    assert found.results.required_friction <= friction
