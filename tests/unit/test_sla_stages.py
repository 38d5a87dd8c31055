"""Stages of sequentially linear analysis: supports that change, reversed loads, energies, what a stop leaves."""

import numpy as np
import pytest
from test_sla_events import run_deck

from extrados.decks.reader import DeckError, make_deck

AREA, YOUNG = 0.2 * 0.1, 5e9
TOP, MIDDLE = {"edge": "top"}, {"y": 0.5}


def column(stages: list[dict], **analysis) -> dict:
    """An elastic column of 1 m, 0.2 m x 0.1 m, that does not widen."""
    return {
        "structure": {"kind": "panel", "width": 0.2, "height": 1.0, "thickness": 0.1},
        "material": {"young": YOUNG, "poisson": 0.0, "density": 0.0},
        "analysis": [
            {
                "kind": "sla",
                "mesh": {"size": 0.25},
                "control": [{**MIDDLE, "direction": "y"}],
                **({"stages": stages} if stages else {}),
                **analysis,
            }
        ],
    }


def middle_force(size: float) -> list[dict]:
    return [{"kind": "point", "y": [0.5, 0.5], "x": [0.0, 0.2], "fy": size}]


def test_a_support_holds_where_it_is_and_lets_its_force_go() -> None:
    """A bar: pressed from its free top, then held there and loaded in the middle, then let go. By hand."""
    press = {"name": "press", "reference": [{"kind": "pressure", "edge": "top", "value": 1e5}], "target_multiplier": 1.0}
    load = {"name": "load", "hold": [{**TOP, "fix": "y"}], "reference": middle_force(-8e3), "target_multiplier": 1.0}
    go = {"name": "go", "free": [{**TOP, "fix": "y"}]}
    found = run_deck(column([press, load, go])).results["stages"]
    down = 1e5 / YOUNG
    pushed = 8e3 / (AREA * YOUNG)
    ends = [-0.5 * down, -0.5 * down - 0.25 * pushed, -0.5 * down - 0.5 * pushed]
    assert [stage["last_displacement_m"] for stage in found] == pytest.approx(ends, rel=1e-9)
    assert [stage["displacement_of_constant_loads_m"] for stage in found] == pytest.approx([0.0, *ends[:2]], abs=1e-15)
    # Half of the load went into the support, and is the load of the last stage
    assert found[2]["end_load_N"] - found[2]["start_load_N"] == pytest.approx(4e3, rel=1e-9)
    work = (
        0.5 * 1e5 * AREA * down + 1e5 * AREA * 0.5 * pushed + 8e3 * (0.5 * down + 0.5 * pushed) - 0.5 * 8e3 * (0.0)
    )  # of both loads, had they come one after the other; the way there does not matter to what is stored
    stored = 0.5 * (1e5 * AREA) ** 2 / (AREA * YOUNG) * 0.5 + 0.5 * (1e5 * AREA + 8e3) ** 2 / (AREA * YOUNG) * 0.5
    assert found[2]["stored_energy_J"] == pytest.approx(stored, rel=1e-9) and work > 0.0
    assert all(stage["energy_residual_ratio"] < 1e-12 for stage in found)


def test_a_support_settles_and_stays() -> None:
    """The base of a bar that is held at both ends goes down: the force is that of the stretch, and stays for the next."""
    hold = {
        "hold": [{**TOP, "fix": "y"}],
        "reference": [{"kind": "displacement", "direction": "y", "parts": [{"edge": "bottom", "ratio": -1.0}]}],
        "target_displacement": 1e-4,
        "control": [{"edge": "bottom", "direction": "y", "weight": -1.0}],
    }
    found = run_deck(column([hold, {"reference": middle_force(-8e3), "target_multiplier": 1.0}])).results["stages"]
    assert found[0]["stop"] == "target displacement"
    assert found[0]["last_displacement_m"] == pytest.approx(1e-4, rel=1e-12)
    assert found[0]["end_load_N"] == pytest.approx(AREA * YOUNG * 1e-4, rel=1e-9)
    assert found[1]["last_displacement_m"] == pytest.approx(-0.5e-4 - 0.25 * 8e3 / (AREA * YOUNG), rel=1e-9)


def wall(stages: list[dict], **analysis) -> dict:
    return {
        "structure": {"kind": "panel", "width": 1.0, "height": 1.0, "thickness": 0.1},
        "material": {"young": 4e9, "poisson": 0.15, "density": 0.0, "tensile_strength": 0.25e6, "fracture_energy": 18.0},
        "analysis": [
            {"kind": "sla", "mesh": {"size": 0.125}, "ripple": 0.2, "events": 400, **({"stages": stages} if stages else {}), **analysis}
        ],
    }


def move(to: float, **more) -> dict:
    parts = [{"edge": "top", "ratio": float(np.sign(to))}]
    return {"reference": [{"kind": "displacement", "direction": "x", "parts": parts}], "target_displacement": abs(to), **more}


PRESS = {"name": "press", "reference": [{"kind": "pressure", "edge": "top", "value": 3e5}], "target_multiplier": 1.0}


@pytest.mark.parametrize("algorithm", ["update", "refactor"])
def test_a_support_that_moves_is_a_tie_that_is_pulled(algorithm) -> None:
    """A displacement as a stage, whose multiplier is the displacement, finds the events of the one whose multiplier is
    the force, with the same energies."""
    staged = run_deck(wall([move(3e-4, name="push")], algorithm=algorithm, crack_closure=False))
    tied = wall([PRESS], algorithm=algorithm, crack_closure=False)
    del tied["analysis"][0]["stages"]
    tied["analysis"][0] |= {"constant": [], "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "top"}]}]}
    other = run_deck(tied)
    n = len(staged["event_load"]) - 1  # the last is the target itself
    assert n > 100
    for name in ("point", "code"):
        assert (staged[f"event_{name}"][:n] == other[f"event_{name}"][:n]).all()
    for name in ("load", "displacement", "stored", "external", "dissipated"):
        a, b = staged[f"event_{name}"][:n], other[f"event_{name}"][:n]
        assert np.abs(a - b).max() < 1e-8 * np.abs(b).max(), name
    assert staged["event_displacement"][-1] == pytest.approx(3e-4, rel=1e-12)
    assert staged.results["energy_residual_ratio"] < 1e-10


def test_cyclic_loads_keep_the_energy() -> None:
    """Pressed, held, pushed, pushed back and forth again, with cracks that close: the work of the loads and of the
    supports is what is stored and dissipated, through all stages; nothing is lost where one ends."""
    stages = [PRESS, move(3e-4, name="push", hold=[{**TOP, "fix": "y"}]), move(-3e-4, name="back"), move(3e-4, name="again")]
    result = run_deck(wall(stages, without_equilibrium="load-unload", events=3000))
    found = result.results["stages"]
    assert [stage["stop"] for stage in found] == ["target load", *["target displacement"] * 3]
    for before, after, turn in zip(found, found[1:], (0, -1, -1), strict=False):
        assert after["energy_residual_ratio"] < 1e-10
        assert after["dissipated_energy_J"] > before["dissipated_energy_J"]
        if turn:
            assert after["start_load_N"] == pytest.approx(turn * before["end_load_N"], rel=1e-6)
            assert after["displacement_of_constant_loads_m"] == pytest.approx(-before["last_displacement_m"], rel=1e-6)
    push, back, again = found[1:]
    assert push["crack_energy_J"] < back["crack_energy_J"] <= again["crack_energy_J"]
    # What closed is stiff again: pushed back, the wall bears most of what it did on the way there
    assert 0.8 < back["greatest_load_N"] / push["greatest_load_N"] < 1.05
    assert sum(stage["closings"] for stage in found) > 0
    shown = [name for name in result.arrays if name.startswith("stage_")]
    assert {"stage_1_event_load", "stage_2_state_displacement", "stage_3_envelope_load"} <= set(shown)


#: A block on a joint that slides, under a pressure
SLIDING = {
    "structure": {
        "kind": "blocks",
        "depth": 1.0,
        "block": [
            {"name": "base", "points": [[0, 0], [1, 0], [1, 0.25], [0, 0.25]]},
            {"name": "top", "points": [[0, 0.25], [1, 0.25], [1, 0.5], [0, 0.5]]},
        ],
    },
    "material": {"density": 0.0, "young": 20e9, "poisson": 0.0},
    "joints": {
        "friction": 0.5,
        "normal_stiffness": 1e10,
        "shear_stiffness": 5e9,
        "types": [{"joints": ["ground"], "friction": "no-sliding", "tension": 1e8, "fracture_energy": 1e9}],
    },
}


def sliding(*stages: dict) -> dict:
    """The deck of SLIDING with stages after the pressure."""
    pressed = [{"kind": "pressure", "edge": "top", "value": 1e5}]
    return {**SLIDING, "analysis": [{"kind": "sla", "mesh": {"size": 0.25}, "constant": pressed, "events": 400, "stages": [*stages]}]}


def test_joints_that_slide_keep_their_friction_from_stage_to_stage() -> None:
    """A block on a joint: pushed until it slides, pushed back until it slides the other way; friction has no cohesion."""
    found = run_deck(sliding(move(2e-4, name="push"), move(-2e-4, name="back"))).results["stages"]
    assert found[0]["end_load_N"] == pytest.approx(0.5 * 1e5, rel=0.03)
    assert found[1]["start_load_N"] == pytest.approx(-found[0]["end_load_N"], rel=1e-6)
    assert found[1]["end_load_N"] == pytest.approx(0.5 * 1e5, rel=0.03)
    assert found[1]["energy_residual_ratio"] < 1e-10


def test_a_stage_without_an_end_ends_the_run() -> None:
    """Cracks that do not close: the wall is pushed until it is torn; the stage after it is not run, and a warning says so."""
    pull = {"reference": [{"kind": "spread", "edge": "top", "fy": 1e3}], "name": "pull"}
    result = run_deck(wall([pull, move(1e-3, name="push")], events=4000))
    assert [stage["name"] for stage in result.results["stages"]] == ["pull"]
    assert any("not run: push" in warning for warning in result.warnings)


@pytest.mark.parametrize(("limit", "why"), [({"budget": 0.01}, "budget of processor time"), ({"events": 20}, "number of events")])
def test_a_stage_that_a_limit_ends_before_its_target_ends_the_run(limit: dict, why: str) -> None:
    """A part of the support is still there: the wall is not pushed on it."""
    go = {"name": "go", "free": [{"edge": "bottom", "x": [0.5, 1.0], "fix": "y"}]}
    push = {"name": "push", "reference": [{"kind": "spread", "edge": "top", "fx": 1e3}]}
    result = run_deck(wall([PRESS, go, push], **limit))
    press, last = result.results["stages"]
    assert (press["stop"], last["name"]) == ("target load", "go")
    assert any(f"before its target ({why})" in text and "not run: push" in text for text in result.warnings)


def test_the_event_of_the_greatest_load_is_one_of_those_calculated() -> None:
    """The events that a budget leaves are no limit of the deck."""
    push = {"constant": [{"kind": "spread", "edge": "top", "fy": -1e4}], "reference": [{"kind": "spread", "edge": "top", "fx": 1e3}]}
    structure = {"kind": "panel", "width": 1.0, "height": 1.0, "thickness": 0.2}
    result = run_deck({**wall([PRESS]), "structure": structure, "analysis": {"kind": "sla", "mesh": {"size": 0.25}, "events": 12, **push}})
    assert f"(event {result.results['greatest_load_event']} of the 12 calculated)" in result.answer


def test_the_budget_ends_constant_loads_too() -> None:
    """Constant loads that crack the wall take more events than the budget has time for: the answer is open, and says why."""
    loads = {"constant": [{"kind": "spread", "edge": "top", "fx": 6.5e3}], "constant_damage": True}
    push = [{"name": "push", "reference": [{"kind": "spread", "edge": "top", "fx": 1e3}]}]
    result = run_deck(wall(push, budget=0.01, events=4000, ripple=0.01, mesh={"size": 0.0625}, **loads))
    assert "`budget` of 0.01 s" in result.answer
    assert result.verdict.outcome == "open"


@pytest.mark.parametrize(
    ("stage", "words"),
    [
        ({"reference": []}, "a load that increases"),
        ({"free": [TOP], "reference": middle_force(1.0)}, "give two stages"),
        ({"free": [TOP]}, "is not restrained"),
        ({"reference": [{"kind": "spread", "edge": "bottom", "fx": 1.0}]}, "only on nodes that are restrained"),
        ({**move(1e-4), "target_displacement": 0.0}, "at the start of this stage"),
    ],
)
def test_stages_that_make_no_sense_are_reported(stage, words) -> None:
    try:
        assert words in run_deck(wall([stage])).reason
    except DeckError as error:
        assert words in str(error)


def test_what_stands_beside_stages_is_reported() -> None:
    with pytest.raises(DeckError, match="directions cannot be used together with stages"):
        make_deck(wall([PRESS], directions=["+", "-"]))
    with pytest.raises(DeckError, match="a name occurs twice"):
        make_deck(wall([PRESS, PRESS]))
    with pytest.raises(DeckError, match="stage 'pull' does not exist"):
        make_deck(wall([PRESS], main_stage="pull"))
    with pytest.raises(DeckError, match=r"stages: .*expected at least 1"):
        make_deck({**(deck := wall([])), "analysis": [{**deck["analysis"][0], "stages": []}]})


@pytest.mark.parametrize("algorithm", ["update", "refactor"])
def test_force_release(algorithm) -> None:
    """What a tooth sets free goes onto the others at the displacement reached: it never comes back; the way ends in the
    equilibrium of a linear analysis; no state in equilibrium exceeds a strength, and the energies balance, of which more
    is dissipated than the teeth take. The peak is near that of load-unload."""
    stages = [PRESS, move(6e-4, name="push", hold=[{**TOP, "fix": "y"}])]
    found = {
        variant: run_deck(wall(stages, events=3000, without_equilibrium=variant, algorithm=algorithm, crack_closure=False))
        for variant in ("load-unload", "force-release")
    }
    back, on = (r.results["stages"][1] for r in found.values())
    r = found["force-release"]
    held = r["event_equilibrium"] > 0
    moved = r["event_displacement"][held]
    assert (np.diff(moved) > -1e-12).all() and (np.diff(found["load-unload"]["event_displacement"]) < 0.0).any()
    assert on["energy_residual_ratio"] < 1e-10 and on["residual_ratio"] < 1e-8
    assert on["dissipated_energy_J"] > on["crack_energy_J"] > 0.0
    assert on["greatest_load_N"] / back["greatest_load_N"] == pytest.approx(0.979, abs=0.01)
    assert on["end_load_N"] / back["end_load_N"] == pytest.approx(0.955, abs=0.02)


def test_where_nothing_moves_teeth_take_load_away() -> None:
    """Without constant loads and with cracks that stay: each release ends at the same displacement under a lower load."""
    r = run_deck(wall([move(4e-4)], events=600, cracking="orthotropic", without_equilibrium="force-release"))
    held = r["event_equilibrium"] > 0
    load, still = r["event_load"][held], np.abs(np.diff(r["event_displacement"][held])) < 1e-12
    assert still.sum() > 50
    assert (np.diff(load)[still] < 0.0).all()


def test_force_release_under_a_force_ends_at_the_peak() -> None:
    push = {"name": "push", "reference": [{"kind": "spread", "edge": "top", "fx": 1e3}]}
    found = {
        variant: run_deck(wall([push], events=3000, without_equilibrium=variant, ripple=0.1)).results
        for variant in ("load-unload", "force-release")
    }
    assert found["force-release"]["stop"] == "mechanism"
    peaks = [r["peak_load_N"] for r in found.values()]
    assert peaks[1] == pytest.approx(peaks[0], rel=0.02)
