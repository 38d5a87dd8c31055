"""Bars that are embedded, ties that go slack, steel that yields."""

from itertools import pairwise

import numpy as np
import pytest
from test_sla_events import run_deck

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.analyses.sla.bar_forces import along, bar_rows, history
from extrados.analyses.sla.curve import states
from extrados.analyses.sla.events import run_curves
from extrados.analyses.sla.model import build
from extrados.core.sla import Softening, teeth
from extrados.decks.reader import make_deck

AREA, YIELD = 2e-4, 500e6
ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
BLOCK = {"kind": "block", "width": 1.0, "height": 4.0}


def prism(bars: list[dict], **analysis) -> dict:
    """1 m x 0.1 m x 0.1 m, pulled at its end."""
    return {
        "structure": {"kind": "panel", "width": 1.0, "height": 0.1, "thickness": 0.1, "bars": bars},
        "material": {"young": 30e9, "poisson": 0.0, "density": 2400, "tensile_strength": 2e6, "fracture_energy": 60.0},
        "materials": {"steel": {"young": 200e9, "poisson": 0.3, "density": 7850}},
        "supports": {"held": [{"edge": "left", "fix": "x"}, {"x": [0, 0], "y": [0.05, 0.05], "fix": "y"}]},
        "analysis": {
            "kind": "sla",
            "mesh": {"size": 0.05},
            "constant": [],
            "target_displacement": 5e-3,
            "events": 300,
            "ripple": 0.2,
            "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "right"}]}],
            **analysis,
        },
    }


def bar(start: float, end: float, height: float = 0.05, **more) -> dict:
    return {"start": [start, height], "end": [end, height], "area": AREA, "material": "steel"} | more


def test_teeth_of_steel_never_carry_more_than_its_yield_strength() -> None:
    """They end at it; the last at the ultimate strain, their energy that of the plateau less the ripple."""
    young, ultimate, ripple = 200e9, 0.02, 0.05
    law = Softening(YIELD, YIELD * (ultimate - 0.5 * YIELD / young), "yielding", ripple)
    modulus, strength = teeth(law, young, 1.0)
    assert modulus[0] == young and (strength[:-1] == YIELD).all() and strength[-1] <= YIELD
    assert strength[-1] / modulus[-1] == pytest.approx(ultimate, rel=1e-12)
    assert np.diff(modulus).max() < 0.0
    strain = strength / modulus
    area = 0.5 * strength[0] * strain[0] + np.sum(
        0.5 * (strength[1:] + modulus[1:] * strain[:-1]) * np.diff(strain)
    )  # of the curve through the teeth
    assert area == pytest.approx(law.energy, rel=1.1 * ripple) and area < law.energy


def test_an_embedded_bar_moves_with_the_wall() -> None:
    """Along a mesh line it is the bars from node to node; askew and between nodes it has the stiffness of its section."""
    steel = {"yield_strength": YIELD, "ultimate_strain": 0.02}
    whole = run_deck(prism([bar(0, 1, bonded=True, **steel)]))
    places = np.linspace(0.0, 1.0, 21).round(6)
    pieces = run_deck(prism([bar(a, b, **steel) for a, b in pairwise(places.tolist())]))
    np.testing.assert_allclose(whole["event_load"], pieces["event_load"], rtol=1e-6)
    stiffness = whole["event_load"][0] / whole["event_displacement"][0]
    assert stiffness == pytest.approx(30e9 * 0.01 + 200e9 * AREA, rel=1e-9)
    # Askew, through the sides of elements: its strain is that of the prism times the square of a cosine, its force along
    # the prism has one more, and it is longer than that
    cosine = 1.0 / np.hypot(1.0, 0.06)
    for mesh in ({"size": 0.04}, {"size": 0.04, "pattern": "random", "element": "T3"}):
        deck = prism([bar(0, 1, bonded=True) | {"end": [1.0, 0.11]}], mesh=mesh, events=1)
        deck["structure"]["height"] = 0.2
        deck["supports"]["held"] = [{"edge": "left", "fix": "x"}, {"x": [0, 1], "y": [0, 0.2], "fix": "y"}]
        askew = run_deck(deck)
        stiffness = askew["event_load"][0] / askew["event_displacement"][0]
        assert stiffness == pytest.approx(30e9 * 0.02 + 200e9 * AREA * cosine**3, rel=1e-3)


def test_a_bar_yields_and_breaks() -> None:
    """What is left of the concrete's teeth carries a few per cent beside it."""
    found = run_deck(prism([bar(0, 1, bonded=True, yield_strength=YIELD, ultimate_strain=0.02)], ripple=0.1, events=3000))
    load, moved = found["event_load"], found["event_displacement"]
    assert load.max() == pytest.approx(AREA * YIELD, rel=0.035)
    yields = load > 0.9 * AREA * YIELD
    # It yields where it is torn last, at least one element of 5 cm of it as far as it can
    assert moved[yields].min() < 3e-3 and np.ptp(moved[yields]) > 0.02 * 0.05
    assert found.results["stop"] == "mechanism" and found.results["energy_residual_ratio"] < 1e-9


def capacity(kind: str, structure: dict, tie: dict, **more):
    deck = {"structure": structure, "joints": {"friction": "no-sliding"}, "ties": [tie], "analysis": {"kind": kind, **more}}
    return run_analyses(Context(make_deck(deck)))[0]


@pytest.mark.parametrize(
    ("structure", "tie"),
    [
        (BLOCK, {"start": [0.1, 3.5], "ground": [-3.0, 0.0], "yield_force": 5e3, "stiffness": 1e8}),
        (BLOCK, {"start": [0.1, 3.5], "ground": [3.0, 0.0], "yield_force": 5e3}),  # slack
        (BLOCK, {"start": [0.1, 3.5], "ground": [3.0, 0.0], "yield_force": 5e3, "works_in": "compression"}),
        (ARCH, {"start": [-7.03, 7.03], "end": [7.03, 7.03], "yield_force": 1e5}),
        (ARCH, {"start": [-7.03, 7.03], "end": [3.81, 9.19], "yield_force": 2e4, "works_in": "both"}),
        (ARCH, {"start": [-3.81, 9.19], "end": [9.19, 3.81], "yield_force": 1e5}),  # slack in the mechanism
    ],
)
def test_ties_as_limit_analysis_has_them(structure: dict, tie: dict) -> None:
    limit = capacity("tilt", structure, tie).results["collapse_acceleration_g"]
    found = capacity("sla", structure, tie)
    assert found.results["peak_acceleration_g"] == pytest.approx(limit, rel=3e-4)
    without = 0.25 if structure is BLOCK else 0.37001
    if limit > 1.001 * without:
        assert capacity("sla", structure, tie | {"yield_force": 1.0}).results["peak_acceleration_g"] < 0.99 * limit


def test_bars_that_make_no_sense_are_reported() -> None:
    assert "ultimate_strain" in run_deck(prism([bar(0, 1, yield_strength=YIELD, ultimate_strain=1e-4)])).reason
    assert "runs through no element" in run_deck(prism([bar(2, 3, bonded=True)])).reason
    tie = {"start": [0.1, 3.5], "ground": [-3.0, 0.0], "prestress": 1e3}
    assert "prestress" in capacity("sla", BLOCK, tie).reason


def test_forces_of_bars_are_those_of_their_strains() -> None:
    """From event to event, by teeth and slackening counted from the log, as the core reports them at kept states; the
    force of a tie in the mechanism is that of limit analysis, a slack one has none."""
    rods = [bar(0, 1, yield_strength=YIELD, ultimate_strain=0.02), bar(0, 1, bonded=True, yield_strength=YIELD), bar(0, 0.5)]
    deck = prism(rods, states=[1, 5, 20, 60], ripple=0.05)
    del deck["material"]["tensile_strength"], deck["material"]["fracture_energy"]
    context = Context(make_deck(deck | {"ties": [{"start": [0.9, 0.02], "end": [0.1, 0.02], "works_in": "compression"}]}))
    options = context.deck.analyses[0]
    model = build(context.building.mesh(options.mesh), options)
    curve = run_curves(model, options, 1, lambda *_: None)[0]
    followed = history(model, curve)
    assert list(followed) == ["bar 1", "bar 3", "tie 1"]
    for named in model.bars:
        for state in curve.states:
            reported = along(named, model, curve, state)
            assert len(reported) == (20 if named.name == "bar 2" else 1)
            if named.held_at_ends:
                assert followed[named.name][state.event] == pytest.approx(reported[0], rel=1e-9, abs=1e-9)
    rows = {row.name: row for row in bar_rows(model, curve)}
    assert [rows[name].state for name in ("bar 1", "bar 2", "tie 1")] == ["yielded", "yielded", "slack"]
    assert 0.75 * AREA * YIELD < rows["bar 1"].greatest_force_N <= AREA * YIELD * (1 + 1e-12)
    assert rows["bar 2"].greatest_force_N is None and rows["bar 2"].last_force_N > 0.75 * AREA * YIELD
    tie = {"start": [-7.03, 7.03], "end": [7.03, 7.03], "yield_force": 1e5, "name": "tie at the haunches"}
    (limit,) = capacity("tilt", ARCH, tie).results["ties"]
    found = capacity("sla", ARCH, tie)
    (force,) = found.results["bars"]
    assert force.force_at_greatest_load_N == pytest.approx(limit.force_N, rel=1e-6) and force.state == "yielded"
    table = found.tables["bar_forces"]
    assert table.units["tie at the haunches"] == "N"
    assert table.columns["tie at the haunches"][found.results["greatest_load_event"] - 1] == force.force_at_greatest_load_N
    assert 1.0 < found.results["greatest_load_displacement_m"] < 0.1 * 21.1 and not found.warnings


def test_what_lies_out_of_reach_is_no_state() -> None:
    """Where nothing crushes, struts bear ever more with metres; and limits run away where equilibrium is lost. What counts is
    the way from the constant loads on, and ten times the greatest load within it."""
    load = np.array([1e3, 1e4, -2e4, 1e5, 4e8, -1.1e5, 9e4, 1.1e4])
    way = np.array([0.01, 0.1, 0.15, 1.0, 0.1, 0.1, 1e3, 0.12])
    held = np.array([1, 1, 1, 1, 0, 1, 0, 1], dtype=bool)
    state, out = states(held, load, way, np.array([1.0] * 7 + [1e5]), 0.2, 1e4)
    assert state.tolist() == [True, True, True, False, False, False, False, False]
    assert out.tolist() == [False, False, False, True, True, True, True, False]
    assert not states(held[4:5], load[4:5], way[4:5], np.ones(1), 0.2, 1e4)[0].any()
