"""Strengthening by sizes, and its targets: changed keys, dampers and bases, by statics, codes, rocking and fragility."""

import pytest
from strengthen_decks import ANCHOR, NAVE, SLIDING, WALL, G, deck_of, run, strengthened

from extrados.analyses.context import Context
from extrados.analyses.strengthen import measures
from extrados.analyses.strengthen.driver import measure_of
from extrados.analyses.strengthen.measures import Worth, unmet_reason
from extrados.decks.reader import DeckError
from extrados.results.model import Result


def test_a_width_is_bracketed_to_its_closed_form():
    r = run(
        {
            "structure": WALL,
            "analysis": [{"kind": "strengthen", "acceleration": "0.3 g", "changes": [{"vary": "structure.width", "stop": "1.5 m"}]}],
        }
    ).results
    (one,) = r.interventions
    assert one.required_size == pytest.approx(0.9, rel=1e-4) and (one.required_size or 0.0) >= 0.9
    assert one.volume_m3 == pytest.approx(3.0 * ((one.required_size or 0.0) - 0.6), rel=1e-6)
    assert any("weight increases" in text for text in one.adverse)


FACADE = {
    "mechanism": "facade",
    "height": 6.0,
    "thickness": 0.6,
    "width": 1.0,
    "ties": [{"height": 5.5, "force": 1.0}],
    "spectrum": {"code": "EN1998-1", "ground": "B", "acceleration": "0.25 g"},
}


def test_a_safety_index_of_a_code_is_met_where_the_code_itself_says_so():
    asked = {
        "kind": "strengthen",
        "by": "local-mechanism",
        "safety_factor": 1.0,
        "options": FACADE,
        "changes": [{"vary": "options.ties.0.force", "stop": "40 kN"}, {"vary": "options.thickness", "stop": "1.5 m"}],
    }
    r = run({"analysis": [asked]}).results
    assert all(one.meets_target for one in r.interventions) and not r.met_before
    for one in r.interventions:
        for size, stands in ((one.required_size, True), (0.97 * (one.required_size or 0.0), False)):
            keys = {**FACADE, "thickness": size} if one.key == "options.thickness" else {**FACADE, "ties": [{"height": 5.5, "force": size}]}
            verdict = run({"analysis": [{"kind": "local-mechanism", **keys}]}).verdict
            assert verdict is not None and verdict.ratio is not None and (verdict.ratio >= 1.0) is stands


def test_an_interrupted_run_ends_the_sizing(monkeypatch):
    """An interruption is no statement about the building: no size is said to miss the target by it."""
    monkeypatch.setattr(measures, "run_one", lambda *given: Result("local-mechanism", "interrupted", "interrupted before"))
    tables = {
        "kind": "strengthen",
        "by": "local-mechanism",
        "safety_factor": 1.0,
        "options": FACADE,
        "changes": [{"vary": "options.thickness", "stop": "1.5 m"}],
    }
    assert run({"analysis": [tables]}).status == "interrupted"


STATUE = {
    "structure": {"kind": "block", "width": 0.5, "height": 2.0, "depth": 0.5},
    "material": {"density": 2500.0},
    "motion": {"kind": "generated", "mmi": 9, "duration": 10.0, "seed": 7},
}


def test_a_probability_is_met_under_the_same_motions():
    tie = {"start": [-0.25, 1.5], "start_stone": "block", "ground": [-1.25, 1.5], "works_in": "both", "stiffness": "1 MN/m"}
    asked = {
        "kind": "strengthen",
        "by": "fragility",
        "probability": 0.1,
        "options": {"count": 30},
        "fragility": True,
        "levels": [0.5, 1.0, 1.5],
        "ties": [{**tie, "yield_force": "2 kN"}],
    }
    r = run({**STATUE, "analysis": [asked]}).results
    (one,) = r.interventions
    assert r.value_before is not None and r.value_before > 0.3 and one.meets_target
    ties = [{**tie, "yield_force": one.required_N}]
    again = run({**STATUE, "ties": ties, "analysis": [{"kind": "fragility", "count": 30}]}).results
    assert again.collapse_probability == one.capacity_after and one.capacity_after <= 0.1
    pair = r.fragility
    assert pair is not None and all(a <= b for a, b in zip(pair.after, pair.before, strict=True))
    assert all(lo <= p <= hi for lo, p, hi in zip(pair.after_low, pair.after, pair.after_high, strict=True))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({}, "give exactly one target"),
        ({"acceleration": "0.3 g", "safety_factor": 1.0}, "give exactly one target"),
        ({"probability": 0.1}, "requires by"),
        ({"acceleration": "0.3 g", "by": "rocking"}, "give a `safety_factor`"),
        ({"safety_factor": 1.0}, "refers to the peak of one motion"),
        ({"acceleration": "0.3 g", "assess": True}, "the deck has no [motion]"),
        ({"acceleration": "0.3 g", "changes": [{"vary": "structure.heigth", "stop": 2.0}]}, "no value above 0"),
        ({"acceleration": "0.3 g", "changes": [{"vary": "structure.width", "stop": "2 kN"}]}, "kN"),
        ({"acceleration": "0.3 g", "ties": [{**ANCHOR, "start_stone": "stone"}]}, "block 'stone' does not exist"),
        ({"acceleration": "0.3 g", "ties": [{**ANCHOR, "prestress": "1 kN"}]}, "does not depend on `prestress`"),
        ({"acceleration": "0.3 g", "ties": [{**ANCHOR, "places": 4}]}, "the end of the range"),
        ({"by": "local-mechanism", "safety_factor": 1.0, "options": {"mechanisms": "facade"}}, "has no key 'mechanisms'"),
        ({"by": "code-checks", "safety_factor": 1.0}, "requires `ties` or `changes`"),
        ({"by": "code-checks", "safety_factor": 1.0, "ties": [ANCHOR]}, "give `yield_force`"),
        ({"acceleration": "0.3 g", "levels": [1.0, 2.0]}, "needs fragility"),
        ({"acceleration": "0.3 g", "ties": [{**ANCHOR, "anchorage": {"plate_width": 0.3}}]}, "plate_height"),
    ],
)
def test_wrong_decks_are_refused_with_the_reason(keys, said):

    try:
        result = run({"structure": WALL, "analysis": [{"kind": "strengthen", **keys}]})
        text = f"{result.status}: {result.reason}"
        assert result.status == "refused", text
    except DeckError as error:
        text = " ".join(error.complaints)
    assert said in text


def test_a_met_target_needs_nothing():
    r = strengthened({**NAVE, "target": 0.1})
    assert r.met_before and not r.interventions and "without an intervention" in r.statement()


ROCKING = {
    "structure": {"kind": "block", "width": 0.5, "height": 2.0, "depth": 0.5},
    "motion": {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 1.0},
}


def test_rocking_sizes_a_damper_and_a_base_by_its_own_verdict():
    damper = {"start": [-0.25, 1.5], "start_stone": "block", "ground": [-1.25, 1.5], "damping": "10 N*s/m"}
    asked = {
        "kind": "strengthen",
        "by": "rocking",
        "safety_factor": 1.0,
        "changes": [{"vary": "dampers.0.damping", "stop": "5 kN*s/m"}, {"vary": "structure.width", "stop": 1.0}],
    }
    r = run({**ROCKING, "dampers": [damper], "analysis": [asked]}).results
    sizes = {one.key: one for one in r.interventions}
    assert all(one.meets_target for one in r.interventions)
    assert sizes["dampers.0.damping"].cost is None and sizes["structure.width"].cost is not None
    stopped = {**damper, "damping": sizes["dampers.0.damping"].required_size}
    again = run({**ROCKING, "dampers": [stopped], "analysis": [{"kind": "rocking"}]}).results
    assert again.outcome == "recovery"
    wider = {**ROCKING, "structure": {**ROCKING["structure"], "width": sizes["structure.width"].required_size}}
    assert run({**wider, "dampers": [damper], "analysis": [{"kind": "rocking"}]}).results.outcome == "recovery"


def test_a_wider_base_on_soft_ground_is_said_to_settle():
    wall = {"structure": WALL, "supports": {"stiffness": "20 MPa/m"}}
    asked = {"kind": "strengthen", "acceleration": "0.3 g", "changes": [{"vary": "structure.width", "stop": 1.5}]}
    (one,) = run({**wall, "analysis": [asked]}).results.interventions
    settlement = one.volume_m3 * 2000.0 * G / (20e6 * 0.6)
    assert any(f"settlement of about {1e3 * settlement:.2g} mm" in text for text in one.adverse)


def test_a_change_that_helps_only_in_between_is_said_to():
    """A thicker vault between given faces loses capacity before it gains it; a target that the least thickness alone meets."""
    asked = {"kind": "strengthen", "acceleration": "0.133 g", "changes": [{"vary": "structure.thickness", "start": 1.4, "stop": 2.5}]}
    nave = {"structure": {**NAVE["structure"], "thickness": 2.0}, "joints": NAVE["joints"]}
    r = run({**nave, "analysis": [asked]}).results
    assert not r.met_before
    (one,) = r.interventions
    assert one.meets_target and any("A larger intervention is therefore not always safer" in text for text in one.adverse)


def test_why_a_target_is_not_met_is_said_of_what_failed():
    deck = deck_of(SLIDING)
    measure = measure_of(Context(deck, 1), deck.analyses[0])
    assert unmet_reason(measure, Worth(None, reason="the blocks overlap")) == "the blocks overlap"
    assert "the value is 0.4" in unmet_reason(measure, Worth(0.4)) and "upper" not in unmet_reason(measure, Worth(0.4, bound="exact"))
    assert "is 0.3 g" in unmet_reason(measure, Worth(0.5, bound="upper", beside=0.3))
    assert not unmet_reason(measure, Worth(0.5, bound="upper", beside=0.46))


def test_an_open_outcome_of_rocking_meets_no_target():
    """The chaotic wall has a safety factor above 1 in this one run, and no verdict: the target is not met."""
    asked = {
        "kind": "strengthen",
        "by": "rocking",
        "safety_factor": 1.0,
        "ties": [{**ANCHOR, "start": [-0.2, 1.9], "ground": [-2.0, 1.9], "yield_force": "2 kN"}],
    }
    record = {"kind": "record", "file": "extrados:el-centro-1940"}
    wall = {"structure": {"kind": "block", "width": 0.4, "height": 2.0}, "motion": record}
    alone = run({**wall, "analysis": [{"kind": "rocking"}]})
    assert alone.verdict.outcome == "open" and alone.verdict.ratio > 1.0
    result = run({**wall, "analysis": [asked]})
    assert not result.results.met_before and "does not decide" in result.warnings[0]


def test_a_fill_is_sized_as_any_key_of_the_structure():
    """The least cover on a bridge for a target between its capacities at two covers; `tilt` at the size, and 2 % less, says so."""
    fill = {"cover": 0.2, "density": 1900.0, "friction_angle": 32.0}
    span = {"span": 6.0, "rise": 2.0, "thickness": 0.6, "voussoirs": 16}
    bridge = {"kind": "bridge", "depth": 4.0, "spans": [span], "abutments": {"width": 3.0, "height": 1.5}}

    def carried(cover: float) -> float:
        r = run(
            {
                "structure": {**bridge, "fill": {**fill, "cover": cover}},
                "joints": {"friction": "no-sliding"},
                "analysis": [{"kind": "tilt"}],
            }
        )
        return min(r["collapse_acceleration_g"], r["collapse_acceleration_opposite_g"])

    low, high = carried(0.2), carried(1.2)
    assert abs(high - low) > 0.01 * low, "the fill matters"
    start, stop = (0.2, 1.2) if high > low else (1.2, 0.2)
    target = 0.5 * (low + high)
    asked = {
        "kind": "strengthen",
        "acceleration": f"{target!r} g",
        "changes": [{"vary": "structure.fill.cover", "start": start, "stop": stop}],
    }
    data = {"structure": {**bridge, "fill": {**fill, "cover": start}}, "joints": {"friction": "no-sliding"}}
    (one,) = run({**data, "analysis": [asked]}).results.interventions
    assert one.meets_target and min(start, stop) < one.required_size < max(start, stop)
    assert carried(one.required_size) >= target > carried(one.required_size + 0.02 * (start - stop))
