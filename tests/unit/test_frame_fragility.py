"""Fragility of frames of macro-elements: batches, limit states, N2 by another way, uncertain values."""

import numpy as np
import pytest
from test_frame_analyses import deck

import extrados
from extrados.analyses.context import Context
from extrados.analyses.frame.fragility import Curves, Histories, last_exceeded
from extrados.analyses.frame.modes import NoEquilibrium
from extrados.analyses.frame.sampled import Sample, sample_of, varied
from extrados.analyses.motion_source import source_of
from extrados.decks.reader import make_deck

MOTION = {"kind": "generated", "mmi": 8, "duration": 1.0, "seed": 3}
FRAME = {"diagonal_strength": 20e3}
SPREAD = {"strength": 0.3, "young": 0.2, "drift_shear": 0.3}
FLOOR = [{"storey": 1, "young": 5e7, "thickness": 0.05, "load": 4e3}]


def given(**keys):
    analysis = {"kind": "frame-fragility", "direction": 90.0, "frame": FRAME, "count": 3, "time_step": 0.02} | keys
    return deck(analysis, floors=FLOOR) | {"motion": MOTION}


def results(data):
    (analysis,) = extrados.run(data, threads=1).analyses
    assert analysis["status"] == "ok", analysis["reason"]
    return analysis["results"]


def test_rows_do_not_depend_on_their_batch():
    made = make_deck(given(levels=[0.3, 0.8], uncertain=SPREAD))
    options = made.analyses[0]
    context = Context(made)
    source, _ = source_of(context, None)
    job = Histories(sample_of(made.building, options.frame, options.uncertain, 3, 0), options, source)
    whole = job.run(0, 6, 1)
    parts = [job.run(0, 1, 1), job.run(1, 4, 2), job.run(5, 1, 1)]
    assert all(np.array_equal(rows, np.concatenate([part[name] for part in parts])) for name, rows in whole.items())
    assert (np.diff(whole["exceeded"].reshape(3, 2, 3), axis=1) >= 0).all()  # more at the higher level
    assert (whole["exceeded"][:, 2] <= whole["exceeded"][:, 1]).all()  # a storey fails after its first pier


def test_curves_of_levels():
    r = results(given(levels=[0.8, 0.1], bootstrap=20))
    assert r["levels_g"] == [0.1, 0.8] and r["histories"] == 6
    strength, _, collapse = r["limit_states"]
    assert strength["probability"] == [0.0, 1.0] and collapse["probability"][0] == 0.0
    assert r["drift_50"][0] < 1e-3


def test_pushovers_carry_what_the_verification_gives():
    """N2 over the same motions by `frame-pushover` with `verification.motions`: the same collapse at SLC."""
    (fragile,) = extrados.run(given(by="pushover"), threads=1).analyses
    push = {
        "kind": "frame-pushover",
        "directions": [90.0],
        "eccentricities": [0.0],
        "frame": FRAME,
        "out_of_plane": False,
        "verification": {"motions": 3, "shape": "mode"},
    }
    code = {"jurisdiction": "NTC", "limit_states": ["SLC"], "confidence_factor": 1.0}
    (other,) = extrados.run(deck(push, floors=FLOOR) | {"motion": MOTION, "code": code}, threads=1).analyses
    (expected,) = other["results"]["verification"]["fragility"]
    found = fragile["results"]["limit_states"][2]
    assert found["median_g"] == pytest.approx(expected["median_pga_g"], rel=1e-9)
    assert found["dispersion"] == pytest.approx(expected["dispersion"], rel=1e-9)


def test_uncertain_values_multiply_what_they_name():
    made = make_deck(given())
    options, building = made.analyses[0].frame, made.building
    plain = varied(building, options, {})
    other = varied(building, options, {"strength": 1.2, "cohesion": 1.5, "young": 0.8, "drift_shear": 0.5, "density": 1.1})
    for a, b in zip(plain.elements, other.elements, strict=True):
        assert b.cohesion == pytest.approx(1.8 * a.cohesion) and b.tension == pytest.approx(1.2 * a.tension)
        assert b.strength == pytest.approx(1.2 * a.strength) and b.young == pytest.approx(0.8 * a.young)
        assert b.drifts == pytest.approx((a.drifts[0], 0.5 * a.drifts[1]))
    floor = 4e3 * 6 * 4
    assert other.total_weight - floor == pytest.approx(1.1 * (plain.total_weight - floor))
    stiff = varied(building, options, {"floor_stiffness": 3.0}).linear
    assert stiff == pytest.approx(3.0 * plain.linear, abs=1e-3)


def test_factors_have_their_mean_and_variation():
    sample = sample_of(make_deck(given()).building, None, {"strength": 0.4, "young": 0.2}, 4096, 1)
    found = np.array([list(sample.factors(k).values()) for k in range(4096)])
    assert found.mean(axis=0) == pytest.approx([1.0, 1.0], abs=5e-3)
    assert found.std(axis=0) == pytest.approx([0.4, 0.2], rel=0.02)
    assert isinstance(sample, Sample) and abs(np.corrcoef(found.T)[0, 1]) < 0.02


@pytest.mark.parametrize(
    "keys, why",
    [
        ({"uncertain": {"colour": 0.2}}, "uncertain.colour is unknown"),
        ({"uncertain": {"young": 2.0}}, "at most 1"),
        ({"by": "pushover", "levels": [0.2]}, "levels` is used only with by ="),
        ({"intensity": "sa"}, "requires `sa_period`"),
        ({"uncertain": {"diagonal_strength": 0.2}, "frame": {}}, "the deck gives no value for it"),
    ],
)
def test_what_is_refused(keys, why):
    with pytest.raises(Exception, match=why):
        (analysis,) = extrados.run(given(**keys), threads=1).analyses
        raise RuntimeError(analysis["reason"])  # refused, in words


def test_the_confidence_factor_is_a_factor_on_all_strengths():
    """The design building is the sampled one whose strengths are those of the deck over 1.35."""
    code = {"jurisdiction": "NTC", "knowledge_level": "LC1"}
    data = given(by="pushover", count=8, uncertain={"strength": 0.3}) | {"code": code}
    r = results(data)
    assert r["confidence_factor"] == 1.35 and r["buildings"] == 8
    assert 0.0 <= r["weaker_share"] <= 1.0 and r["design_intensity_g"] > 0.0
    made = make_deck(data)
    options = made.analyses[0].frame
    divided = made.building.frame(options.model_copy(update={"confidence_factor": 1.35}))
    sampled = varied(made.building, options, {"strength": 1.0 / 1.35})
    for a, b in zip(divided.elements, sampled.elements, strict=True):
        assert (a.cohesion, a.tension, a.strength) == pytest.approx((b.cohesion, b.tension, b.strength))


class Weak(Sample):
    """Its first building does not carry its weight."""

    def frame(self, k):
        if k == 0:
            raise NoEquilibrium("no equilibrium", ())
        return super().frame(k)


def test_buildings_that_do_not_carry_their_weight_count_as_collapsed(monkeypatch):
    made = make_deck(given(uncertain=SPREAD))
    options = made.analyses[0]
    source, _ = source_of(Context(made), None)
    plain = sample_of(made.building, options.frame, options.uncertain, 3, 0)
    weak = Weak(plain.building, plain.options, plain.uncertain, plain.draws)
    rows = Histories(weak, options, source).run(0, 2, 1)
    assert rows["exceeded"][0].all() and rows["unstable"].tolist() == [True, False] and (rows["reason"] == "").all()
    rows = Curves(weak, options).run(0, 2, 1)
    assert (rows["capacity"][0] == 0.0).all() and (rows["capacity"][1] > 0.0).all() and (rows["reason"] == "").all()
    monkeypatch.setattr("extrados.analyses.frame.fragility.sample_of", lambda *_: weak)
    (analysis,) = extrados.run(given(by="pushover", uncertain=SPREAD), threads=1).analyses
    states = analysis["results"]["limit_states"]
    assert all(one["exceeded"] >= 1 and one["median_g"] is None for one in states)
    assert any("count as collapsed" in text for text in analysis["warnings"])


def test_a_push_without_a_curve_makes_its_building_unknown(monkeypatch):
    from extrados.analyses.codes import capacity_curve

    plain, calls = capacity_curve.oscillator_of, []

    def fails_once(*arguments):
        calls.append(1)
        return None if len(calls) == 1 else plain(*arguments)

    monkeypatch.setattr(capacity_curve, "oscillator_of", fails_once)
    (analysis,) = extrados.run(given(by="pushover", uncertain=SPREAD), threads=1).analyses
    assert any("1 of 3 pairs of motion and building are not considered" in text for text in analysis["warnings"])
    assert any("has no rising branch" in text for text in analysis["warnings"])


def test_the_last_exceeded_state_names_a_run():
    hit = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [1, 1, 1]], bool)
    assert last_exceeded(hit).tolist() == ["", "strength", "first-limit", "first-limit", "collapse"]


def test_uncertain_strengths_are_not_divided_too():
    data = given(by="pushover", uncertain=SPREAD, frame=FRAME | {"confidence_factor": 1.2})
    (analysis,) = extrados.run(data, threads=1).analyses
    assert analysis["status"] == "refused" and "confidence_factor" in analysis["reason"]
