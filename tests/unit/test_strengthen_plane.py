"""Strengthening by ties in the plane: forces by the linear programme, held against hand calculation, bisection over runs and other programmes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strengthen_decks import ANCHOR, BUILDINGS, COLUMN, NAVE, SLIDING, WALL, G, deck_of, run, strengthened

from extrados.analyses.context import Context
from extrados.analyses.limit import common
from extrados.analyses.limit.common import limit_of
from extrados.analyses.sequence import run_one
from extrados.analyses.strengthen.alternatives import TieAlternative, tie_alternatives
from extrados.analyses.strengthen.measures import Statics
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.errors import NoEquilibrium
from extrados.limit.strengthening import concave_curve, pieces_of


def tilt_of(building: dict[str, Any], force: float) -> Any:
    """What `tilt` says of the building with a tie of a given yield force, both ways [g]."""
    tables = {k: building[k] for k in ("structure", "joints", "material") if k in building}
    deck = {**tables, "ties": [{**building["tie"], "yield_force": force}], "analysis": [{"kind": "tilt"}]}
    return run(deck)


def capacity_of(building: dict[str, Any], force: float) -> float:
    r = tilt_of(building, force)
    least = [r["collapse_acceleration_g"], r["collapse_acceleration_opposite_g"]]
    for end in ("", "_opposite"):
        if (lower := r.results.get(f"collapse_acceleration_non_associated{end}_g")) is not None:
            least.append(lower)
    return min(least)


def test_an_anchor_is_sized_as_by_moments_about_the_toe():
    r = run(
        {
            "structure": WALL,
            "material": {"density": 1800.0},
            "analysis": [{"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [ANCHOR]}],
        }
    ).results
    weight = 1800.0 * 0.6 * 3.0 * G
    (anchor,) = r.interventions
    assert r.value_before == pytest.approx(0.2) and not r.met_before
    assert anchor.required_N == pytest.approx(weight * (0.3 * 1.5 - 0.3) / 2.5, rel=1e-6)
    assert anchor.capacity_after == pytest.approx(0.3, rel=1e-6) and anchor.capacity_after >= 0.3
    # overturning, then the same about the toe that the tie presses down: the slope is the arm of the tie over that of the weight
    first = anchor.ranges[0]
    slope = (first.capacity_last - first.capacity_first) / (first.last - first.first)
    assert slope == pytest.approx(2.5 / (weight * 1.5), rel=1e-6)


def test_a_tie_without_which_an_arch_slides_apart_carries_its_least_thrust():
    data = {
        "structure": {"kind": "arch", "radius": 5.0, "thickness": 1.0, "embrace": 180.0, "voussoirs": 24},
        "joints": {"friction": "no-sliding", "types": [{"joints": ["joint 0"], "friction": 0.0}]},
        "analysis": [
            {
                "kind": "strengthen",
                "acceleration": "0.05 g",
                "ties": [{"start": [-5.0, 0.0], "end": [5.0, 0.0], "start_stone": "voussoir 1", "end_stone": "voussoir 24"}],
            }
        ],
    }
    deck = make_deck(data, Path.cwd())
    statics = Statics(Context(deck, 1), deck.analyses[0])
    (tie,) = tie_alternatives(deck.building, deck.analyses[0])
    # by moments of the stones, as in cases/limit/tied-arch
    assert statics.forces([(tie, 0)], 0.0)[0] == pytest.approx(47455.59344928777, rel=1e-6)


@pytest.mark.parametrize("name", BUILDINGS)
def test_the_required_force_is_the_least_by_tilt(name):
    building = BUILDINGS[name]
    (one,) = strengthened(building).interventions
    assert one.meets_target and one.required_N is not None
    assert capacity_of(building, 1e-3) < building["target"] <= capacity_of(building, 4.0 * one.required_N)
    low, high = (capacity_of(building, factor * one.required_N) for factor in (1.0 - 1e-4, 1.0 + 1e-4))
    assert low < building["target"] <= high
    assert one.bound == ("upper" if name == "sliding" else "exact")
    if name == "sliding":  # the tie takes what friction leaves of the load
        assert one.required_N == pytest.approx((0.45 - 0.3) * 2000.0 * 0.8 * 1.2 * G, rel=1e-6)


@pytest.mark.parametrize("name", BUILDINGS)
def test_the_curve_is_that_of_tilt_at_any_force(name):
    building = BUILDINGS[name]
    deck = deck_of(building)
    statics = Statics(Context(deck, 1), deck.analyses[0])
    (tie,) = tie_alternatives(deck.building, deck.analyses[0])
    most = 2.0 * float(statics.forces([(tie, 0)], building["target"])[0])
    pieces = pieces_of(concave_curve(lambda force: statics.point(tie, 0, force), 0.0, most))
    assert pieces[0].first == 0.0 and pieces[-1].last == pytest.approx(most)
    ends = [p.first for p in pieces] + [most]
    values = [p.low for p in pieces] + [pieces[-1].high]
    slopes = [p.point.slope for p in pieces]
    assert slopes == sorted(slopes, reverse=True)
    smooth = 2e-3 if name == "crushing" else 1e-6  # crushing bends the curve: tangents lie above it
    for force in np.random.default_rng(5).uniform(1e-3, 1.0, 12) * most:
        assert np.interp(force, ends, values) == pytest.approx(statics.point(tie, 0, force).capacity, rel=smooth)


@pytest.mark.parametrize("name", BUILDINGS)
def test_two_programmes_agree_on_the_least_force(name):
    """That of the structure itself, case by case, and the one over all cases, by another solver and another form."""
    deck = deck_of(BUILDINGS[name])
    statics = Statics(Context(deck, 1), deck.analyses[0])
    (tie,) = tie_alternatives(deck.building, deck.analyses[0])
    target = BUILDINGS[name]["target"]
    assert statics.force(tie, 0, target) == pytest.approx(float(statics.forces([(tie, 0)], target)[0]), rel=1e-6)


def test_one_programme_serves_several_ties_and_both_senses():
    low = {**NAVE["tie"], "name": "low", "start": [-9.0, 0.0], "end": [9.0, 0.0]}
    high = {**NAVE["tie"], "name": "high"}
    deck = deck_of(NAVE, ties=[low, high])
    options = deck.analyses[0]
    statics = Statics(Context(deck, 1), options)
    ties = tie_alternatives(deck.building, options)
    alone = [float(statics.forces([(tie, 0)], 0.2)[0]) for tie in ties]
    both = statics.forces([(tie, 0) for tie in ties], 0.2)
    assert both.sum() <= min(alone) * (1.0 + 1e-9)
    added = tuple(
        tie.places[0].model_copy(update={"yield_force": max(float(force), 1e-6), "name": tie.name})
        for tie, force in zip(ties, both, strict=True)
    )
    limit = limit_of(deck.building.having(ties=added), options)
    assert min(limit.collapse(1)[0].gamma, -limit.collapse(-1)[0].gamma) == pytest.approx(0.2, rel=1e-6)


def test_what_no_tie_cures_says_so_with_the_greatest_capacity():
    r = strengthened({**NAVE, "target": 0.5})
    (one,) = r.interventions
    assert not one.meets_target and one.required_N is None and one.cost is None
    assert 0.2 < (one.greatest_capacity or 0.0) < 0.5 and one.next_mechanism and one.reason
    assert "None of the calculated interventions" in r.statement()
    deck = deck_of(NAVE)
    statics = Statics(Context(deck, 1), deck.analyses[0])
    (tie,) = tie_alternatives(deck.building, deck.analyses[0])
    with pytest.raises(NoEquilibrium):
        statics.forces([(tie, 0)], 0.5)


def test_a_range_of_places_finds_the_cheapest_one():
    anchor = {**ANCHOR, "start": [-0.3, 1.0], "ground": [-2.3, 1.0], "start_to": [-0.3, 2.8], "far_to": [-2.3, 2.8], "places": 7}
    r = run({"structure": WALL, "analysis": [{"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [anchor]}]})
    (one,) = r.results.interventions
    assert one.start_m == pytest.approx([-0.3, 2.8])
    heights, forces = r.arrays["range"].data[:, 1], r.arrays["range"].data[:, 2]
    assert forces * heights == pytest.approx(np.full(7, forces[0] * heights[0]), rel=1e-6)


def test_beside_a_wall_the_load_acts_away_from_it():
    r = run(
        {
            "structure": WALL,
            "supports": {"abutting_wall": "left"},
            "analysis": [{"kind": "strengthen", "acceleration": "0.3 g", "ties": [ANCHOR]}],
        }
    ).results
    assert r.direction == "+x" and r.interventions[0].meets_target


def test_one_sense_alone_is_warned_of():
    asked = {"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [ANCHOR]}
    warnings = run({"structure": WALL, "analysis": [asked]}).warnings
    assert any("Towards -x, the existing building carries 0.2 g" in text for text in warnings)


def test_a_tie_of_a_range_passes_over_places_between_stones():
    column = {**COLUMN["tie"], "start": [-0.39, 1.6], "start_to": [-0.39, 3.2], "ground": [-3.0, 1.6], "far_to": [-3.0, 3.2], "places": 4}
    deck = deck_of(COLUMN, ties=[column])
    (one,) = tie_alternatives(deck.building, deck.analyses[0])
    assert isinstance(one, TieAlternative) and len(one.places) == 2  # 1.6 and 3.2 m are joints


def test_a_target_in_the_plane_is_not_met_where_no_state_without_dilatancy_is_found(monkeypatch):
    """Two anchors, of which one yields early, combine to hold a block that slides."""
    early = {**SLIDING["tie"], "name": "early", "start": [-0.39, 0.2], "ground": [-3.0, 0.2], "yield_force": 1500.0}
    late = {**SLIDING["tie"], "name": "late", "yield_force": 2000.0}
    asked = {"ties": [early, late, {**SLIDING["tie"], "name": "alone"}]}

    def answer(ties: list[dict[str, Any]]) -> Any:
        deck = deck_of(SLIDING, ties=ties)
        return run_one(Context(deck, 1), deck.analyses[0], deck.buildings[0])

    alone = answer(asked["ties"][2:]).results.interventions[0]
    both = answer(asked["ties"][:2])
    assert alone.meets_target and alone.bound == "upper"
    assert len(both.results.combination) == 2 and both.results.combination_meets_target
    assert "Combination of ties with the least total force: " in both.answer
    monkeypatch.setattr(common, "MOST_BESIDE", 0)
    unmet = answer(asked["ties"][2:]).results.interventions[0]
    assert not unmet.meets_target and "friction governs, and no state without dilatancy was found" in unmet.reason
    both = answer(asked["ties"][:2])
    assert not both.results.combination_meets_target and "which may not meet the target (see the warnings): " in both.answer
    (warned,) = [text for text in both.warnings if "combination" in text]
    assert "no state without dilatancy was found" in warned and "unknown" not in warned


#: A block that leans to -x and falls so at rest; its tie to the right holds it, and a load to +x sets it upright
LEANING = {"kind": "blocks", "depth": 1.0, "block": [{"name": "leaning", "points": [[0, 0], [1, 0], [-0.4, 2], [-1.4, 2]]}]}
STAY = {"name": "stay", "start": [-0.27, 1.8], "start_stone": "leaning", "ground": [3.0, 1.8]}


def test_a_load_in_one_sense_still_needs_the_tie_of_rest():
    """At 0.3 g to +x the block leans against nothing; at rest its weight turns it to -x with W 0.2 m about its left toe."""
    asked = {"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [STAY]}
    r = run({"structure": LEANING, "joints": {"friction": "no-sliding"}, "analysis": [asked]}).results
    (one,) = r.interventions
    weight = 2000.0 * 2.0 * G
    assert r.value_before == 0.0 and one.meets_target
    assert one.required_N == pytest.approx(weight * 0.2 / 1.8, rel=1e-6)
    # towards -x the tie resists the load as well: W (0.2 + 0.3)/1.8
    (other,) = run(
        {"structure": LEANING, "joints": {"friction": "no-sliding"}, "analysis": [{**asked, "direction": "-x"}]}
    ).results.interventions
    assert other.required_N == pytest.approx(weight * 0.5 / 1.8, rel=1e-6)


@pytest.mark.parametrize(("works_in", "sense"), [("tension", "-x"), ("compression", "+x")])
def test_a_tie_that_the_mechanism_leaves_slack_has_no_slope(works_in, sense):
    """A tie to the left shortens where the wall turns to the left, a strut lengthens where the wall turns to the right."""
    tie = {**ANCHOR, "works_in": works_in}
    asked = {"kind": "strengthen", "acceleration": "0.3 g", "direction": sense, "ties": [tie]}
    deck = make_deck({"structure": WALL, "joints": {"friction": "no-sliding"}, "analysis": [asked]}, Path.cwd())
    statics = Statics(Context(deck, 1), deck.analyses[0])
    (one,) = tie_alternatives(deck.building, deck.analyses[0])
    for force in (1e3, 5e3):
        point = statics.point(one, 0, force)
        assert (point.slope, point.capacity) == (0.0, pytest.approx(0.2, rel=1e-6))
    assert statics.force(one, 0, 0.3) == np.inf and statics.force(one, 0, 0.19) == pytest.approx(0.0, abs=1.0)


def test_a_spreader_between_abutments_carries_the_push_of_both():
    """Two walls of 0.6 x 3 m, 4 m apart, with a strut at 2.5 m: under 0.3 g one wall leans on the other, whose reserve it uses up."""
    walls = [{"name": n, "points": [[x, 0], [x + 0.6, 0], [x + 0.6, 3], [x, 3]]} for n, x in (("left", 0.0), ("right", 4.6))]
    strut = {"name": "spreader", "start": [0.59, 2.5], "end": [4.61, 2.5], "works_in": "compression"}
    asked = {"kind": "strengthen", "acceleration": "0.15 g", "ties": [strut]}
    data = {"structure": {"kind": "blocks", "depth": 1.0, "block": walls}, "joints": {"friction": "no-sliding"}, "analysis": [asked]}
    weight = 2000.0 * 0.6 * 3.0 * G
    r = run({**data, "analysis": [{**asked, "acceleration": "0.19 g"}]}).results
    assert r.met_before, "each wall carries 0.2 g by itself"
    (one,) = run({**data, "material": {"density": 2000.0}, "analysis": [{**asked, "acceleration": "0.21 g"}]}).results.interventions
    assert not one.meets_target and one.greatest_capacity == pytest.approx(0.2, rel=1e-6), "equal walls do not help each other"
    thick = [walls[0], {"name": "right", "points": [[4.6, 0], [6.1, 0], [6.1, 3], [4.6, 3]]}]
    data["structure"] = {"kind": "blocks", "depth": 1.0, "block": thick}
    (one,) = run({**data, "analysis": [{**asked, "acceleration": "0.3 g", "direction": "+x"}]}).results.interventions
    assert one.required_N == pytest.approx(weight * (0.3 * 1.5 - 0.3) / 2.5, rel=1e-6)


def test_a_ring_beam_is_a_tie_with_its_weight():
    """Moments about the right toe: half of the beam rests on the wall at its anchorage, and sways at 2.9 m."""
    beam = {"start": [-0.2, 2.9], "start_stone": "block", "ground": [-4.0, 2.9], "beam_weight": "6 kN"}
    asked = {"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [beam]}
    data = {"structure": WALL, "joints": {"friction": "no-sliding"}, "analysis": [asked]}
    (one,) = run(data).results.interventions
    weight, half = 2000.0 * 0.6 * 3.0 * G, 3e3
    force = (0.3 * (weight * 1.5 + half * 2.9) - weight * 0.3 - half * 0.5) / 2.9
    assert (one.kind, one.name) == ("ring-beam", "ring beam 1")
    assert one.required_N == pytest.approx(force, rel=1e-6)
    assert any("6.00 kN" in text for text in one.adverse)
    # the same load by hand in the table of the analysis
    loaded = {**asked, "load": [{"x": -0.2, "y": 2.9, "force": half, "sways": True}]}
    plain = run({**data, "analysis": [{**loaded, "ties": [{k: v for k, v in beam.items() if k != "beam_weight"}]}]})
    assert plain.results.interventions[0].required_N == pytest.approx(one.required_N, rel=1e-9)


def test_a_heavy_ring_beam_needs_more_force():
    beam = {"start": [-0.2, 2.9], "start_stone": "block", "ground": [-4.0, 2.9]}
    force = {}
    for weight in (1e3, 20e3):
        asked = {"kind": "strengthen", "acceleration": "0.3 g", "direction": "+x", "ties": [{**beam, "beam_weight": weight}]}
        force[weight] = (
            run({"structure": WALL, "joints": {"friction": "no-sliding"}, "analysis": [asked]}).results.interventions[0].required_N
        )
    # per kN of weight on the wall 0.3 2.9 - 0.5 m over 2.9 m
    assert force[20e3] - force[1e3] == pytest.approx(9.5e3 * (0.3 * 2.9 - 0.5) / 2.9, rel=1e-5)


def test_a_debonding_force_needs_its_source_and_is_reported():
    strip = {**NAVE["tie"], "debonding_force": "400 kN"}
    with pytest.raises(DeckError, match="requires its source"):
        deck_of({**NAVE, "tie": strip})
    (one,) = strengthened({**NAVE, "tie": {**strip, "source": "pull-off test 3"}}).interventions
    assert one.meets_target and any("pull-off test 3" in text and "brittle" in text for text in one.adverse)
    (weak,) = strengthened({**NAVE, "tie": {**strip, "debonding_force": "20 kN", "source": "test"}}).interventions
    assert not weak.meets_target and "greatest one considered" in weak.reason
