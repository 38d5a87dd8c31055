"""Walls under constant axial load, followed past the events that find no equilibrium."""

from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.core.sla import EVENT
from extrados.decks.reader import make_deck

CASES = Path(__file__).parents[2] / "cases"

#: Steps of equilibrium iterations: tolerance of the residual, and of the energy balance that the trapezium rule allows
RESIDUAL, BALANCE = 1e-3, 5e-3


def run_deck(data: dict):
    return run_analyses(Context(make_deck(data)))[0]


def pier(strength: float, energy: float, size: float, crushing: bool = False, height: float = 2.0, **options) -> dict:
    """A pier of 1 m in double bending under 0.6 MPa; strength [MPa], energy [N/m], size of the elements [m]."""
    crush = {"compressive_strength": 3e6, "crushing_energy": 5000.0, "crushing": "exponential"} if crushing else {}
    return {
        "structure": {"kind": "panel", "width": 1.0, "height": height, "thickness": 0.25, "ties": [{"edge": "top", "direction": "y"}]},
        "material": {"young": 1.7e9, "poisson": 0.0, "tensile_strength": 1e6 * strength, "fracture_energy": energy, **crush},
        "supports": {"held": [{"edge": "bottom"}]},
        "analysis": [
            {
                "kind": "sla",
                "constant": [{"kind": "pressure", "edge": "top", "value": 6e5}],
                "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "top"}]}],
                "target_displacement": 6e-3,
                "ripple": 0.1,
                "events": 20000,
                "mesh": {"size": size},
                **options,
            }
        ],
    }


def array(result, name: str) -> np.ndarray:
    return result.arrays[name].data


def check_steps(result) -> None:
    """Residual and energies of the steps, which have all converged; what is dissipated never falls."""
    r = result.results
    assert r["equilibrium_steps"] > 0
    assert r["step_residual_ratio"] <= RESIDUAL
    assert r["step_balance_ratio"] <= BALANCE
    assert np.diff(array(result, "event_dissipated")).min() >= 0.0
    step = array(result, "event_step") > 0
    assert np.diff(array(result, "event_lost")[step]).min() >= 0.0
    assert "mechanism" not in result.answer


@pytest.mark.parametrize("size", [0.125, 0.1, 0.2 / 3.0])
@pytest.mark.parametrize(("strength", "energy", "expected"), [(0.1, 50.0, 66.9e3), (0.03, 10.0, 58.7e3), (0.01, 3.0, 57.3e3)])
def test_pier_meets_an_independent_rotating_solution(strength, energy, expected, size) -> None:
    """A rotating total-strain solution in displacement control by another program, on elements of 0.1 m."""
    result = run_deck(pier(strength, energy, size))
    r = result.results
    assert r["stop"] == "target displacement"
    assert r["last_displacement_m"] == pytest.approx(6e-3, rel=1e-6)
    assert r["last_load_N"] == pytest.approx(expected, rel=0.05)
    assert r["last_load_N"] < 75e3  # the no-tension limit, N B / H
    assert r["unbalanced_steps"] == 0
    check_steps(result)


@pytest.mark.parametrize(
    ("height", "loads", "loss"),
    [(2.0, [33.1e3, 59.9e3, 57.9e3, 55.2e3], [16.1e-3, 16.6e-3]), (1.35, [61.8e3, 83.8e3, 83.0e3, 64.7e3], [10.8e-3, 11.2e-3])],
)
def test_crushing_wall_is_followed_to_the_loss_of_axial_capacity(height, loads, loss) -> None:
    """Prototypes of three methods, run to convergence; they differ by 2 % in the load, by 3 % in the displacement of the loss."""
    options = {"probes": [1e-3, 3e-3, 6e-3, 10e-3], "target_displacement": 0.01 * height}
    result = run_deck(pier(0.1, 50.0, 0.1, crushing=True, height=height, **options))
    r = result.results
    assert r["probe_loads_N"] == pytest.approx(loads, rel=0.02)
    assert r["stop"] == "axial capacity lost"
    assert 0.98 * loss[0] <= r["axial_loss_displacement_m"] <= 1.02 * loss[1]
    assert r["axial_loss_drift"] == pytest.approx(r["axial_loss_displacement_m"] / height)
    assert r["peak_displacement_m"] < r["drop_displacement_m"] < r["axial_loss_displacement_m"]
    d, p = array(result, "envelope_displacement"), array(result, "envelope_load")
    assert np.interp(r["drop_displacement_m"], d, p) == pytest.approx(0.8 * r["peak_load_N"], rel=1e-3)
    assert "axial capacity lost" in result.answer
    check_steps(result)


def test_ways_of_descent_that_run_away_end_no_wall() -> None:
    """Staggered steps alone, without ways of descent, follow this wall to 25.04 mm at -10.6 kN; at 24.66 mm it carries 14 kN."""
    r = run_deck(pier(0.05, 1.0, 0.2, crushing=True, height=3.0, target_displacement=3e-2, events=3000)).results
    assert r["stop"] == "axial capacity lost" and r["unbalanced_steps"] == 0
    assert r["axial_loss_displacement_m"] == pytest.approx(25.04e-3, rel=5e-3)
    assert r["last_load_N"] < 0.0
    assert r["step_residual_ratio"] <= RESIDUAL and r["step_balance_ratio"] <= BALANCE


def test_implicit_explicit_integration_agrees() -> None:
    options = {"probes": [6e-3, 10e-3], "target_displacement": 10e-3}
    loads = [
        run_deck(pier(0.1, 50.0, 0.1, crushing=True, continuation=how, **options)).results["probe_loads_N"]
        for how in ("newton", "implicit-explicit")
    ]
    assert loads[1] == pytest.approx(loads[0], rel=0.01)


def test_a_section_without_tension_in_uniform_bending() -> None:
    """Plane sections, linear in compression: M = N (B / 2 - sqrt(2 N / (9 E t kappa))) once a third of it is cracked."""
    n, b, t, young, height = 150e3, 1.0, 0.25, 1.7e9, 0.5
    data = {
        "structure": {
            "kind": "panel",
            "width": b,
            "height": height + 0.1,
            "thickness": t,
            "regions": [{"y": [height, height + 0.1], "linear": True, "material": "cap"}],
        },
        "material": {"young": young, "poisson": 0.0, "tensile_strength": 2e3, "fracture_energy": 0.2},
        "materials": {"cap": {"young": 1000.0 * young, "poisson": 0.0}},
        "supports": {"held": [{"edge": "bottom"}]},
        "analysis": [
            {
                "kind": "sla",
                "constant": [{"kind": "pressure", "edge": "top", "value": n / (b * t)}],
                "reference": [
                    {"kind": "point", "x": 0, "y": height + 0.1, "fy": "1 kN"},
                    {"kind": "point", "x": b, "y": height + 0.1, "fy": "-1 kN"},
                ],
                "control": [
                    {"x": 0, "y": height, "direction": "y", "weight": 1.0},
                    {"x": b, "y": height, "direction": "y", "weight": -1.0},
                ],
                "ripple": 0.1,
                "target_displacement": 5e-3,
                "events": 5000,
                "mesh": {"size": 0.1, "selective": True},
            }
        ],
    }
    result = run_deck(data)
    step = array(result, "event_step") > 0
    moment = array(result, "event_load")[step] * b
    curvature = array(result, "event_displacement")[step] / b / height
    expected = n * (0.5 * b - np.sqrt(2.0 * n / (9.0 * young * t * curvature)))
    assert moment.min() < 30e3 < 60e3 < moment.max() < 0.5 * n * b  # from the loss of equilibrium to near the limit
    cracked = curvature > 2.0 * n / (young * t * b**2)
    assert moment[cracked] == pytest.approx(expected[cracked], rel=0.015)
    check_steps(result)


def test_poissons_ratio_hardly_matters() -> None:
    data = pier(0.1, 50.0, 0.1, crushing=True, probes=[6e-3], target_displacement=8e-3)
    plain = run_deck(data).results["probe_loads_N"][0]
    data["material"]["poisson"] = 0.2
    result = run_deck(data)
    assert result.results["probe_loads_N"][0] == pytest.approx(plain, rel=0.02)
    check_steps(result)


def move(ratio: float, target: float) -> dict:
    return {
        "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "top", "ratio": ratio}]}],
        "target_displacement": target,
    }


def test_load_reversal() -> None:
    """To +6 mm, -6 mm and again: each stage begins where the one before ended, and energies continue."""
    data = pier(0.1, 50.0, 0.1)
    analysis = data["analysis"][0]
    del analysis["reference"], analysis["target_displacement"]
    analysis["stages"] = [{"name": "push", **move(1.0, 6e-3)}, {"name": "back", **move(-1.0, 6e-3)}, {"name": "again", **move(1.0, 6e-3)}]
    result = run_deck(data)
    push, back, again = result.results["stages"]
    assert [s["stop"] for s in (push, back, again)] == ["target displacement"] * 3
    assert back["start_load_N"] == pytest.approx(-push["end_load_N"], rel=1e-3)
    assert again["start_load_N"] == pytest.approx(-back["end_load_N"], rel=1e-3)
    assert back["end_load_N"] == pytest.approx(push["end_load_N"], rel=0.02)  # the pier is symmetric, its other diagonal cracks
    assert back["dissipated_energy_J"] > push["dissipated_energy_J"]
    assert again["dissipated_energy_J"] == pytest.approx(back["dissipated_energy_J"], rel=0.05)  # nothing new is cracked
    assert max(s["step_balance_ratio"] for s in (push, back, again)) < BALANCE
    # Cracks unload to the origin: without displacement the pier carries no shear
    d, v = array(result, "stage_2_event_displacement"), array(result, "stage_2_event_load")
    assert abs(np.interp(0.0, d, v)) < 0.05 * push["end_load_N"]


def test_other_rules_remain_and_what_cannot_be_followed_is_reported() -> None:
    result = run_deck(pier(0.1, 50.0, 0.125, without_equilibrium="load-unload", events=2000))
    assert "equilibrium_steps" not in result.results
    result = run_deck(pier(0.01, 3.0, 0.125, cracking="orthotropic", events=3000))
    assert "equilibrium_steps" not in result.results
    assert any("equilibrium iterations require rotating cracks" in text for text in result.warnings)


@pytest.mark.verify
def test_shells_are_followed_by_the_same_iterations() -> None:
    """A box of four walls, whose walls in the push have openings: beyond the last event the load continues where it was."""
    opening = [{"storey": 1, "x": [1.0, 2.0], "z": [1.0, 2.0]}]
    corners = [[0, 0], [3, 0], [3, 3], [0, 3]]
    walls = [
        {"name": name, "start": corners[k], "end": corners[(k + 1) % 4], "thickness": 0.25, **({"openings": opening} if k % 2 == 0 else {})}
        for k, name in enumerate("abcd")
    ]
    data = {
        "structure": {"kind": "building", "storeys": [3.0], "walls": walls},
        "material": {"density": 1900.0, "young": 3e9, "tensile_strength": 1e5, "fracture_energy": 40.0},
        "analysis": [
            {
                "kind": "pushover",
                "mesh": {"size": 0.5, "layers": 3},
                "ripple": 0.2,
                "events": 6000,
                "crack_closure": True,
                "target_displacement": 1.4e-3,
                "without_equilibrium": "continue",
            }
        ],
    }
    result = run_deck(data)
    r = result.results
    assert r["equilibrium_steps"] > 3 and r["unbalanced_steps"] == 0
    assert r["step_residual_ratio"] <= RESIDUAL
    assert r["step_balance_ratio"] <= 2 * BALANCE
    step = array(result, "event_step") > 0
    first = int(np.argmax(step))
    load = array(result, "event_load")
    assert load[first] == pytest.approx(load[first - 1], rel=0.1)
    assert np.diff(array(result, "event_lost")[step]).min() >= 0.0


@pytest.mark.parametrize(("at", "end"), [(0.25, 6e-3), (1.0, 1e-2), (2.0, 2e-2)])
def test_a_free_pier_pushed_anywhere_keeps_its_axial_load(at: float, end: float) -> None:
    """Masonry that is linear in compression loses no axial capacity, though its top moves farther than what is pushed."""
    ends = []
    for strength, energy in ((0.1, 50.0), (0.01, 3.0)):
        deck = pier(strength, energy, 0.125, target_displacement=end)
        del deck["structure"]["ties"]
        deck["analysis"][0]["reference"] = [{"kind": "point", "x": [0.0, 1.0], "y": [at, at], "fx": "1 kN"}]
        r = run_deck(deck).results
        assert r["stop"] == "target displacement" and r["unbalanced_steps"] == 0
        assert r["greatest_load_N"] < 150e3 * 0.5 / at  # N b/2h
        lost = r["dissipated_energy_J"] - r["crack_energy_J"]
        assert r["released_energy_J"] == pytest.approx(lost, rel=2e-3, abs=0.1), "what no crack takes is lost as motion"
        ends.append(r["last_load_N"])
    if at == 2.0:  # once torn, the pressure of a free top stays where it is, whatever the strength was
        assert ends[0] == pytest.approx(ends[1], rel=0.02)


@pytest.mark.verify
def test_a_stage_has_the_drift_of_the_same_run_without_stages() -> None:
    whole = pier(0.1, 50.0, 0.125, crushing=True, target_displacement=2e-2)
    staged = pier(0.1, 50.0, 0.125, crushing=True)
    push = {key: staged["analysis"][0].pop(key) for key in ("reference", "target_displacement")}
    staged["analysis"][0]["stages"] = [{"name": "push", **push, "target_displacement": 2e-2}]
    one, other = run_deck(whole).results, run_deck(staged).results
    assert other["drift_height_m"] == one["drift_height_m"] == 2.0
    assert other["axial_loss_drift"] == pytest.approx(one["axial_loss_drift"], rel=0.02)


def test_a_budget_ends_a_run_with_the_results_so_far() -> None:
    result = run_deck(pier(0.1, 50.0, 0.2, budget=0.01))
    assert result.status == "ok"
    assert result.results["stop"] == "budget of processor time"
    assert result.results["greatest_load_N"] > 0.0
    assert any("`budget` of 0.01 s" in warning for warning in result.warnings)


def test_damage_that_goes_ahead_in_staggered_steps_is_dissipated() -> None:
    """What steps lose in the drop to another equilibrium is motion; without the energy of extrapolated damage it was a third."""
    r = run_deck(pier(0.2, 10.0, 0.25, crushing=True, target_displacement=2e-2)).results
    assert r["stop"] == "axial capacity lost"
    assert r["released_energy_J"] < 0.1 * r["dissipated_energy_J"]


def test_a_film_has_states_on_the_whole_way_of_the_curve() -> None:
    """Events and steps: no two pictures are further apart than two parts of the way and a step."""
    plain, filmed = (run_deck(pier(0.1, 50.0, 0.25, target_displacement=3e-3, **more)) for more in ({}, {"animation": "gif"}))
    events = array(filmed, "state_event") - 1
    assert len(set(events.tolist())) == len(events) > 40 > len(array(plain, "state_event"))
    way = array(filmed, "event_displacement")[events]
    assert np.diff(way).max() <= 2.0 * 3e-3 / 80.0 + 2e-4
    assert np.array_equal(array(filmed, "event_load"), array(plain, "event_load"))


def test_a_notched_bar_snaps_back_on_its_closed_form() -> None:
    """Elongation s L / E and a crack w = w_c (1 - s / ft): from the peak on both decrease. Displacement control drops, and loses energy."""
    deck = extrados.live(CASES / "sla" / "snap-back.toml").deck.data
    result = run_deck(deck)
    way, load = array(result, "event_displacement"), array(result, "event_load")
    arc = array(result, "event_code") == EVENT["dissipated"]
    assert arc.sum() > 10 and result.results["released_energy_J"] == 0.0
    share = load[arc][:-1] / 25e3  # the last one is torn
    assert (np.diff(way[arc][:-1]) < 0.0).all() and share.min() < 0.1
    assert way[arc][:-1] == pytest.approx(1e-4 + 2e-4 * share, rel=2e-3)
    assert result.results["dissipated_energy_J"] == pytest.approx(5.0 * 0.25, rel=1e-3)  # Gf times the section


def test_a_step_that_passes_over_a_snap_back_is_stated() -> None:
    """A bar of one band, whose peak lies within a step of displacement control."""
    deck = {
        "structure": {
            "kind": "panel",
            "width": 2.0,
            "height": 0.2,
            "thickness": 0.5,
            "regions": [{"x": [0.0, 0.9], "linear": True}, {"x": [1.1, 2.0], "linear": True}],
        },
        "material": {"young": 2e9, "poisson": 0.0, "tensile_strength": 2e5, "fracture_energy": 10.0},
        "supports": {"held": [{"edge": "left", "fix": "x"}, {"edge": "bottom", "fix": "y"}]},
        "analysis": {
            "kind": "sla",
            "continuation": "dissipation",
            "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "right"}]}],
            "target_displacement": 4e-4,
            "mesh": {"size": 0.2, "lines_x": [0.9, 1.1]},
        },
    }
    result = run_deck(deck)
    assert result.results["peak_load_N"] < 0.98 * 20e3
    (stated,) = [text for text in result.warnings if "passes over a snap-back" in text]
    assert "from 19.4 kN" in stated


def test_an_arc_length_follows_the_curve_of_displacement_control() -> None:
    """A pier that does not snap back has the same curve, also by steps without events from the first load on."""
    ways = ("newton", "dissipation", "steps")
    curves = [run_deck(pier(0.1, 50.0, 0.25, target_displacement=3e-3, continuation=how)) for how in ways]
    at = np.linspace(0.2e-3, 3e-3, 15)
    one, two, three = (np.interp(at, array(c, "envelope_displacement"), array(c, "envelope_load")) for c in curves)
    assert two == pytest.approx(one, rel=0.02)
    assert three == pytest.approx(one, rel=0.02)
    assert array(curves[2], "event_step").all()
    check_steps(curves[1])
    check_steps(curves[2])


def test_steps_that_a_law_does_not_admit_are_stated() -> None:
    """Fixed cracks have no law of steps: the run consists of events, and a warning says so."""
    deck = pier(0.1, 50.0, 0.25, target_displacement=1e-4, continuation="steps", cracking="orthotropic")
    result = run_deck(deck)
    assert not array(result, "event_step").any()
    assert any("`continuation` = steps had no effect: equilibrium iterations can follow" in text for text in result.warnings)


def test_steps_that_another_rule_excludes_are_stated() -> None:
    deck = pier(0.1, 50.0, 0.25, target_displacement=1e-4, continuation="steps", without_equilibrium="load-unload")
    result = run_deck(deck)
    assert any('had no effect: `without_equilibrium` is not "continue"' in text for text in result.warnings)
