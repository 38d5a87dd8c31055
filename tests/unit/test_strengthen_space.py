"""Strengthening of blocks in space: ties, hoops and changes, held against hand calculation and bisection over runs."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from strengthen_decks import G, run

from extrados.analyses.context import Context
from extrados.analyses.strengthen import space
from extrados.analyses.strengthen.alternatives import tie_alternatives
from extrados.analyses.strengthen.driver import measure_of
from extrados.decks.reader import make_deck
from extrados.limit.solids import SolidLimit
from extrados.model.ties import Tie

DOME = {"structure": {"kind": "dome", "radius": 5.0, "thickness": 0.6, "rings": 4, "lunes": 6}, "joints": {"friction": 0.7}}


def in_space(data: dict[str, Any], tie: dict[str, Any], **keys: Any) -> tuple[Any, Any]:
    """The measure and the alternative of one tie among blocks in space."""
    asked = {"kind": "strengthen", "acceleration": "0.55 g", "ties": [tie], "directions": [0.0, 90.0], **keys}
    deck = make_deck({**data, "analysis": [asked]}, Path.cwd())
    statics = measure_of(Context(deck, 1), deck.analyses[0])
    (one,) = tie_alternatives(deck.building, deck.analyses[0])
    return statics, one


@pytest.mark.parametrize("bonded", [False, True])
def test_a_hoop_is_sized_as_by_bisection_over_its_yield_force(bonded):
    statics, one = in_space(DOME, {"start": [0.0, 0.0, 1.5], "hoop": True, "bonded": bonded})
    before = statics.of(statics.context.building)
    target = 1.1 * before.value
    force = statics.force(one, 0, target)
    low, high = 0.0, 2.0 * force
    while high - low > 1e-5 * force:
        middle = 0.5 * (low + high)
        carried = statics.of(one.having(statics.context.building, 0, middle)).value
        low, high = (low, middle) if carried >= target else (middle, high)
    assert force == pytest.approx(high, rel=1e-4)
    # the slope of the curve is the derivative of the capacity
    point, step = statics.point(one, 0, 0.5 * force), 1e-3 * force
    rise = statics.point(one, 0, 0.5 * force + step).capacity - statics.point(one, 0, 0.5 * force - step).capacity
    assert point.slope == pytest.approx(rise / (2.0 * step), rel=0.02)


def test_an_anchor_in_space_is_sized_as_by_moments_about_the_toe():
    block = {"structure": {"kind": "column", "width": 1.0, "height": 4.0, "drums": 1, "depth": 1.0}, "joints": {"friction": 5.0}}
    deck = make_deck({**block, "analysis": [{"kind": "tilt", "direction": 0.0}]}, Path.cwd())
    solids = deck.building.solids()
    tied = deck.building.having(
        ties=(
            Tie.model_validate(
                {"start": [-0.5, 0.0, 3.0], "ground": [-4.0, 0.0, 3.0], "start_stone": solids.block_names[0], "name": "anchor"}
            ),
        )
    )
    limit = SolidLimit(solids, 5.0, tied.strands())
    weight = float(solids.mass[0]) * G
    # load to +x about the toe at x = 0.5: 0.4 W 2 = 0.5 W + 3 F
    assert limit.least_force(0.0, 0.4, [0]) == pytest.approx(weight * (0.4 * 2.0 - 0.5) / 3.0, rel=1e-5)
    assert limit.least_force(0.0, 0.2, [0]) == pytest.approx(0.0, abs=1e-6 * weight)
    assert limit.least_force(180.0, 0.4, [0]) == np.inf  # a tie pulls one way
    assert limit.least_force(90.0, 0.4, [0]) == np.inf


ANCHORED = {
    "structure": {"kind": "chimney", "width": 1.0, "height": 4.0, "thickness": 0.3, "rings": 1, "facets": 4},
    "joints": {"friction": 5.0},
}


def toppling() -> tuple[float, float, str]:
    """Weight [N], distance [m] of the edge from the axis, and name of the one block of that chimney."""
    solids = make_deck({**ANCHORED, "analysis": [{"kind": "tilt"}]}, Path.cwd()).building.solids()
    edge = max(float(part.vertices[:, 0].max()) for part in solids.parts)
    return float(solids.mass.sum()) * G, edge, solids.block_names[0]


def anchor(side: float, height: float, **keys: Any) -> dict[str, Any]:
    """An anchor at a height [m] that holds the block back on the side of -x or +x."""
    _, edge, block = toppling()
    name = f"{'low' if height < 3.0 else 'high'} at {side:+g}"
    return {"name": name, "start": [edge * side, 0.0, height], "ground": [4.0 * side, 0.0, height], "start_stone": block, **keys}


def test_anchors_in_space_combine_as_by_moments_about_both_toes():
    """Load along 0 and 180 degrees: 0.4 W 2 = e W + 3 F + 2 G on each side, F at most 0.02 W, so that G carries the rest."""
    weight, edge, _ = toppling()
    limited = {"yield_force": 0.02 * weight}
    ties = [anchor(-1.0, 3.0, **limited), anchor(-1.0, 2.0), anchor(1.0, 3.0, **limited), anchor(1.0, 2.0)]
    asked = {"kind": "strengthen", "acceleration": "0.4 g", "directions": [0.0, 180.0], "ties": ties}
    r = run({**ANCHORED, "analysis": [asked]})
    rest = weight * (0.4 * 2.0 - edge - 3.0 * 0.02) / 2.0
    assert rest > 0.0
    found = {row.name: row.force_N for row in r.results.combination}
    expected = {"high at -1": 0.02 * weight, "low at -1": rest, "high at +1": 0.02 * weight, "low at +1": rest}
    assert found == pytest.approx(expected, rel=1e-4)
    assert not any(one.meets_target for one in r.results.interventions), "no tie alone holds both ways"
    assert not any("combination" in text for text in r.warnings)


def test_two_hoops_of_a_dome_need_no_more_than_the_better_one_alone():
    statics, low = in_space(DOME, {"name": "low", "start": [0.0, 0.0, 0.9], "hoop": True})
    _, high = in_space(DOME, {"name": "high", "start": [0.0, 0.0, 2.2], "hoop": True})
    target = 1.1 * statics.of(statics.context.building).value
    alone = [statics.force(one, 0, target) for one in (low, high)]
    for one, force in zip((low, high), alone, strict=True):
        (by_one,) = statics.forces([(one, 0)], target)  # two programmes of one question
        assert by_one == pytest.approx(force, rel=1e-4)
    forces = statics.forces([(low, 0), (high, 0)], target)
    assert forces.sum() <= min(alone) * (1.0 + 1e-6)

    def carried(share: float) -> float:
        held = statics.context.building
        for one, force in zip((low, high), share * forces, strict=True):
            if force > 1e-6 * forces.sum():
                held = one.having(held, 0, float(force))
        return statics.of(held).value

    assert carried(1.0) == pytest.approx(target, rel=1e-5) and carried(0.98) < target


def test_the_weight_of_a_ring_beam_in_space_acts_at_its_ends():
    """Half of the beam rests at the anchored face: 0.4 (W 2 + B/2 3) = e W + B/2 2 e + 3 F."""
    weight, edge, _ = toppling()
    beam = 0.2 * weight
    asked = {"kind": "strengthen", "acceleration": "0.4 g", "directions": [0.0], "ties": [anchor(-1.0, 3.0, beam_weight=beam)]}
    (one,) = run({**ANCHORED, "analysis": [asked]}).results.interventions
    assert one.required_N == pytest.approx((weight * (0.4 * 2.0 - edge) + 0.5 * beam * (0.4 * 3.0 - 2.0 * edge)) / 3.0, rel=1e-4)
    assert any("ring beam weighs" in text for text in one.adverse)


@pytest.mark.verify
def test_a_dome_without_interventions_of_its_own_gets_a_hoop_and_a_greater_thickness():
    asked = {"kind": "strengthen", "acceleration": "0.6 g", "directions": [0.0]}
    r = run({**DOME, "analysis": [asked]}).results
    assert {one.kind for one in r.interventions} == {"hoop", "change"}
    hoop = next(one for one in r.interventions if one.kind == "hoop")
    assert hoop.capacity_after == pytest.approx(0.6, rel=1e-5)
    assert not hoop.meets_target and "found without dilatancy" in hoop.reason, "its contacts slide"


def test_a_target_in_space_is_met_only_if_the_state_without_dilatancy_meets_it():
    """A rod pulls a block down on friction 0.3. Dilatant sliding stretches the rod: 0.3 (W + F) = 0.5 W. Without dilatancy it stays slack: 0.3 g."""
    squat = {**ANCHORED["structure"], "height": 1.0}
    solids = make_deck({"structure": squat, "analysis": [{"kind": "tilt"}]}, Path.cwd()).building.solids()
    rod = {"start": [0.0, 0.0, 0.9], "start_stone": solids.block_names[0], "ground": [0.0, 0.0, -1.0]}
    asked = {"kind": "strengthen", "acceleration": "0.5 g", "directions": [0.0], "ties": [rod]}
    (one,) = run({"structure": squat, "joints": {"friction": 0.3}, "analysis": [asked]}).results.interventions
    weight = float(solids.mass.sum()) * G
    assert one.required_N == pytest.approx(weight * (0.5 / 0.3 - 1.0), rel=1e-4) and one.capacity_after == pytest.approx(0.5, rel=1e-4)
    assert not one.meets_target and "upper bound" in one.reason and one.cost is not None
    assert any(
        "Without dilatancy, the lowest collapse acceleration found for the strengthened building is 0.3 g" in text for text in one.adverse
    )
    # as a rod of the existing building it does not meet a target of 0.4 g either
    existing = {"ties": [{**rod, "yield_force": one.required_N, "name": "rod"}]}
    before = run({"structure": squat, "joints": {"friction": 0.3}, **existing, "analysis": [{**asked, "acceleration": "0.4 g"}]}).results
    assert before.value_before == pytest.approx(0.5, rel=1e-4) and not before.met_before
    # an anchor across needs no dilatancy: 0.3 W + F = 0.5 W
    across = {"start": [-0.5, 0.0, 0.05], "start_stone": solids.block_names[0], "ground": [-4.0, 0.0, 0.05]}
    (held,) = run({"structure": squat, "joints": {"friction": 0.3}, "analysis": [{**asked, "ties": [across]}]}).results.interventions
    assert held.meets_target and held.required_N == pytest.approx(0.2 * weight, rel=1e-3)


def squat_across(**keys: Any) -> Any:
    """Strengthen a squat block in space that slides, by anchors across at its foot."""
    squat = {**ANCHORED["structure"], "height": 1.0}
    block = make_deck({"structure": squat, "analysis": [{"kind": "tilt"}]}, Path.cwd()).building.solids().block_names[0]
    across = {"name": "across", "start": [-0.5, 0.0, 0.05], "start_stone": block, "ground": [-4.0, 0.0, 0.05]}
    asked = {"kind": "strengthen", "acceleration": "0.5 g", "directions": [0.0], "ties": [across], **keys}
    return run({"structure": squat, "joints": {"friction": 0.3}, "analysis": [asked]})


@pytest.mark.parametrize("why", ["more than 0 contacts", "none is certified"])
def test_a_target_in_space_is_not_met_where_no_state_without_dilatancy_is_found(monkeypatch, why):
    if "contacts" in why:
        monkeypatch.setattr(space, "MOST_BESIDE", 0)
    else:
        uncertified = SimpleNamespace(load_path_g=None, least_g=None)
        monkeypatch.setattr(space, "slide", lambda *given, **keys: (uncertified, None))
    result = squat_across()
    (one,) = result.results.interventions
    assert one.capacity_after == pytest.approx(0.5, rel=1e-4) and one.bound == "upper" and not one.meets_target
    assert "friction governs, and no state without dilatancy was found" in one.reason and why in one.reason
    assert one.reason in result.answer
    # an existing building that meets a lower target by dilatant sliding alone
    before = squat_across(acceleration="0.25 g")
    assert before.results.value_before == pytest.approx(0.3, rel=1e-4) and not before.results.met_before
    assert any(text.startswith("Existing building: friction governs") for text in before.warnings)


def test_a_change_in_space_is_met_only_where_a_state_without_dilatancy_is_found(monkeypatch):
    rougher = {"ties": [], "changes": [{"vary": "joints.friction", "stop": 0.6, "count": 3}]}
    (met,) = squat_across(**rougher).results.interventions
    assert met.meets_target and met.required_size == pytest.approx(0.5, rel=1e-3)
    monkeypatch.setattr(space, "MOST_BESIDE", 0)
    (one,) = squat_across(**rougher).results.interventions
    assert one.required_size == met.required_size and not one.meets_target and "friction governs" in one.reason


@pytest.mark.parametrize(
    ("keys", "text"), [({"direction": "+x"}, "give `directions`"), ({"friction_rule": "non-associated"}, "dilatant sliding")]
)
def test_what_is_known_of_plane_sections_alone_is_refused_in_space(keys, text):
    asked = {"kind": "strengthen", "acceleration": "0.5 g", **keys}
    result = run({**DOME, "analysis": [asked]})
    assert result.status == "refused" and text in result.reason
