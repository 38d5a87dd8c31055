"""Sweeps, surveys, thrust, supports, moving loads and tilt as a user runs them."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.limit import variation
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.errors import NoAnswer
from extrados.results.model import Result
from extrados.running.run import Run, compute
from extrados.show.charts import shown

ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 150.0, "voussoirs": 20}
VAULT = {"kind": "vault", "preset": "dejong-a"}
CHURCH = {"kind": "aisled-vault", "preset": "vezelay-like"}


NO_SLIDING = {"friction": "no-sliding"}


def run(structure: dict[str, Any], folder: Path | None = None, **analysis: Any) -> Result:
    deck = make_deck({"structure": structure, "analysis": analysis}, folder)
    return run_analyses(Context(deck, threads=1))[0]


def test_preset_may_be_overruled() -> None:
    plain = run(VAULT, kind="tilt")
    wider = run({**VAULT, "buttress_width": 8.0}, kind="tilt")
    assert plain.status == wider.status == "ok"
    assert wider["base_width_m"] == 8.0 and wider["collapse_acceleration_g"] > plain["collapse_acceleration_g"]
    assert "inferred" in plain.warnings[0]


def test_tilt_arrays_are_whole() -> None:
    result = run(CHURCH, kind="tilt")
    for name in ("collapse", "least", "most"):
        for what in ("line", "funicular", "polygon"):
            start = result[f"{name}_{what}_start"]
            assert start[-1] == len(result[f"{name}_{what}"]) and len(start) == len(result[f"{name}_{what}_of"]) + 1
    assert result["mechanism_pose"].shape == (len(result["centroid"]), 3)
    assert set(result["thrusts"]) == {"nave", "left aisle", "right aisle"}
    up = sum(r["vertical_N"] for r in result["reactions"])
    side = sum(r["horizontal_N"] for r in result["reactions"])
    assert up == pytest.approx(result["weight_N"], rel=1e-9)
    assert side == pytest.approx(-result["collapse_acceleration_g"] * result["weight_N"], rel=1e-7)


def test_fracture_beside_monolithic() -> None:
    result = run(VAULT, kind="tilt", fracture=True, joints=NO_SLIDING)
    assert result["fracture"]["ratio"] == pytest.approx(0.554, abs=1e-3)
    assert result["crack"][1] == pytest.approx([14.1667, -20.125], abs=1e-3)  # outer toe
    assert run(ARCH, kind="tilt", fracture=True).status == "refused"
    assert "crushing" in run(VAULT, kind="tilt", fracture=True, material={"compressive_strength": 1e7}).reason


def test_thrust_at_an_acceleration() -> None:
    result = run(ARCH, kind="thrust", gamma=0.2)
    low, high = result["admissible_interval_g"]
    assert low == pytest.approx(-high) and 0.2 < high
    assert result["least"]["horizontal_N"] < result["central"]["horizontal_N"] < result["most"]["horizontal_N"]
    beyond = run(ARCH, kind="thrust", gamma=0.6)
    assert beyond.status == "refused" and "-0.4333 to 0.4333 g" in beyond.reason
    table = result.tables["thrust_central"]
    assert len(table.columns["joint"]) == 21 and table.units["normal"] == "kN/m"
    assert "'porch' does not exist" in run(ARCH, kind="thrust", chain="porch").reason


def test_a_sweep_claims_no_optimum_where_there_is_none() -> None:
    """Density changes nothing; past the friction that its hinges need an arch bears the same."""
    told = [
        run(ARCH, kind="sweep", vary=vary, start=start, stop=stop, count=7).answer
        for vary, start, stop in (("material.density", 1500, 2500), ("joints.friction", 0.3, 0.9))
    ]
    assert "from 1500 to 2500 kg/m^3: the greatest collapse acceleration is 0.4333 g" in told[0] and ", the same for all values." in told[0]
    assert "acceleration is 0.4333 g" in told[1] and ", at values from 0.5 to 0.9." in told[1]


def test_a_sweep_of_no_number_is_refused() -> None:
    bridge = {"kind": "bridge", "spans": [{"span": 8.0, "rise": 2.5, "thickness": 0.5}]}
    refused = run(bridge, kind="sweep", vary="spans.²", start=1, stop=2)
    assert refused.status == "refused" and "give a number from 0 to 0" in refused.reason


def test_sweep_finds_changes_and_optimum() -> None:
    coarse = run(CHURCH, kind="sweep", vary="buttress_width", start=0.7, stop=3.0, count=11)
    fine = run(CHURCH, kind="sweep", vary="buttress_width", start=0.7, stop=3.0, count=60)
    for key in ("optimum_value", "optimum_collapse_acceleration_g"):
        assert coarse[key] == pytest.approx(fine[key], abs=1e-5)
    places = [[c["value"] for c in r["changes"]] for r in (coarse, fine)]
    assert places[0] == pytest.approx(places[1], abs=1e-5) and len(places[0]) == 3
    assert [m["number"] for m in fine["mechanisms"]] == [1, 2, 3]
    # On either side of a change the capacities agree: it is one curve.
    for change in fine["changes"][1:]:
        both = [run({**CHURCH, "buttress_width": change["value"] + d}, kind="tilt")["collapse_acceleration_g"] for d in (-1e-5, 1e-5)]
        assert both[0] == pytest.approx(both[1], abs=1e-5)
    assert all("cannot stand" in gap["reason"] for gap in fine["gaps"]) and len(fine["gaps"]) > 2


def test_sweep_through_impossible_geometry() -> None:
    result = run(CHURCH, kind="sweep", vary="buttress_width", values=[1.5, 5.0, 6.0, 7.0])
    reasons = {g["value"]: g["reason"] for g in result["gaps"]}
    assert "no width remains for the aisle" in reasons[7.0]
    assert result["collapse_accelerations_g"][0] > 0.06
    thick = run(ARCH, kind="sweep", vary="thickness", values=[0.5, 1.5, 11.0, -1.0])
    reasons = {g["value"]: g["reason"] for g in thick["gaps"]}
    assert "greater than 0" in reasons[-1.0] and "not below the radius" in reasons[11.0] and "cannot stand" in reasons[0.5]
    # Where the geometry ends no collapse under self-weight begins
    (limit,) = thick["stable_limits"]
    assert 0.5 < limit < 1.5 and thick.answer.count("begins or ends at") == 1 and not result["stable_limits"]
    sides = [(c.before, c.after) for c in thick.results.changes]
    assert sides[0] == ("unknown", 0) and sides[-1] == (len(thick["mechanisms"]), "unknown")
    assert thick.results.changes[0].value == pytest.approx(0.0, abs=1e-5) and thick.results.changes[1].value == limit
    assert "unknown" not in thick.answer


def test_a_collapse_that_is_not_proven_limits_no_range(monkeypatch: pytest.MonkeyPatch) -> None:
    def unproven(limit: Any) -> Any:
        raise NoAnswer("neither an equilibrium state nor a collapse mechanism was found")

    monkeypatch.setattr(variation, "cannot_stand", unproven)
    thick = run(ARCH, kind="sweep", vary="thickness", values=[0.5, 1.5])
    assert not thick["stable_limits"] and [gap["status"] for gap in thick["gaps"]] == ["no-answer"]
    assert thick.results.changes[0].before == "unknown" and 0 not in {side for c in thick.results.changes for side in (c.before, c.after)}


@pytest.mark.parametrize(
    ("vary", "words"), [("girth", "no key 'girth'"), ("kind", "holds no number"), ("right.girth", "no key 'right.girth'")]
)
def test_sweep_of_a_wrong_key(vary: str, words: str) -> None:
    result = run(CHURCH, kind="sweep", vary=vary, start=0.0, stop=1.0)
    assert result.status == "refused" and words in result.reason


def test_sweep_of_whole_numbers_and_nested_keys() -> None:
    result = run(ARCH, kind="sweep", vary="voussoirs", start=4, stop=12, count=30)
    assert result["values"] == [float(n) for n in range(4, 13)]
    nested = run({**CHURCH, "right": {"buttress_width": 1.8}}, kind="sweep", vary="right.buttress_width", values=[1.4, 1.8])
    assert nested["collapse_accelerations_g"][1] == pytest.approx(0.0681, abs=1e-4)


def test_sweep_of_friction() -> None:
    """Oppenheim's arch: below .495 the leeward springing slides."""
    arch = {**ARCH, "embrace": 157.5, "voussoirs": 7}
    result = run(arch, kind="sweep", vary="joints.friction", start=0.3, stop=0.6, count=13)
    assert result["changes"][-1]["value"] == pytest.approx(0.495, abs=1e-3)
    assert result["optimum_collapse_acceleration_g"] == pytest.approx(0.37000974, abs=1e-8)
    assert "slide" in result["mechanisms"][0]["hinges"]
    assert "holds no number" in run(arch, kind="sweep", vary="joints.damping", start=0.3, stop=0.6).reason
    strength = run(arch, kind="sweep", vary="material.compressive_strength", start=0.0, stop=1e6, count=3)
    assert "greater than 0" in strength["gaps"][0]["reason"]


def test_survey(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(
        "name,thickness,embrace\nfirst,1.5,157.5\nthin,0.2,180\nsilly,twelve,150\nunit,150 cm,157.5\n,,\nempty,,157.5\n"
    )
    result = run({**ARCH, "voussoirs": 7}, tmp_path, kind="survey", file="s.csv")
    gamma = result["gamma"]
    assert gamma[0] == gamma[3] == gamma[4] == pytest.approx(0.37000974, abs=1e-8)
    assert gamma[1] == 0.0 and np.isnan(gamma[2]) and result["standing"] == 3
    assert [r["row"] for r in result["cannot_stand"]] == [3] and "certificate" in result["cannot_stand"][0]["reason"]
    assert [r["row"] for r in result["without_answer"]] == [4] and "thickness" in result["without_answer"][0]["reason"]
    assert result["weakest"] == "thin" and result["weakest_collapse_acceleration_g"] == 0.0
    assert result.tables["survey"].columns["status"] == ["ok", "cannot-stand", "no-answer", "ok", "ok"]
    for text, words in (
        (
            "name,girth\na,1\n",
            "s.csv:1: [structure] of kind 'arch' has no key 'girth'; its keys are radius, thickness, embrace, voussoirs, "
            "thickness_factor, depth, skew, stones_across and 'name'",
        ),
        ("name,thickness\na\n", "s.csv:2"),
        ("", "expected a header"),
        ("name,name\na,b\n", "occurs twice"),
    ):
        (tmp_path / "s.csv").write_text(text)
        assert words in run(ARCH, tmp_path, kind="survey", file="s.csv").reason
    assert "none.csv" in run(ARCH, tmp_path, kind="survey", file="none.csv").reason


def test_cracked_buttress_that_cannot_stand(tmp_path: Path) -> None:
    """A slender buttress stands whole, but not once it cracks."""
    whole = run({**VAULT, "buttress_width": 3.6}, kind="tilt", fracture=True, joints=NO_SLIDING)
    assert (
        whole.status == "ok"
        and whole["fracture"].as_json() == {"stands": False}
        and "the structure cannot stand, even without a horizontal load" in whole.warnings[0]
    )
    (tmp_path / "s.csv").write_text("name,buttress_width\nslender,3.6\nstout,6.0\n")
    table = run(VAULT, tmp_path, kind="survey", file="s.csv", fracture=True, joints=NO_SLIDING).tables["survey"].columns
    assert table["fractured_collapse_acceleration"][0] == 0.0 and "cracked" in table["reason"][0]
    assert table["fractured_collapse_acceleration"][1] > 0.07 and table["reason"][1] == ""


def test_survey_file_of_the_case() -> None:
    folder = Path(__file__).parents[2] / "cases" / "limit"
    with (folder / "survey.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 12


def test_supports() -> None:
    result = run(ARCH, kind="supports")
    assert result.status == "ok" and len(result["hinges_at_fall"]) == 3 and result["joints_touched_at_fall"]
    assert result["thrust_at_fall_N"] > result["thrust_at_rest_N"]
    closing = run(ARCH, kind="supports", spread=-1.0)
    assert closing["thrust_at_rest_N"] > 1.5 * result["thrust_at_rest_N"]
    assert "no support moves" in run(ARCH, kind="supports", spread=0.0).reason
    thin = run({**ARCH, "thickness": 0.4, "embrace": 180.0}, kind="supports")
    assert thin["safety_factor"] == 0.0 and "certificate: a mechanism" in thin["certificate"]


def test_moving_load() -> None:
    one = run(ARCH, kind="moving-load", count=41)
    assert one["capacity"][5] == pytest.approx(one["capacity"][-6], rel=1e-6)  # a symmetric arch
    two = run(ARCH, kind="moving-load", axles=[0.0, 2.0], force=5e4, count=41)
    assert two["collapse_load_N"] > one["collapse_load_N"]  # spread loads hurt less
    assert two["safety_factor"] == pytest.approx(two["collapse_load_N"] / 5e4)
    with pytest.raises(DeckError, match="shares"):
        run(ARCH, kind="moving-load", axles=[0.0, 1.0], shares=[1.0])


def test_load_at_rest() -> None:
    plain = run(ARCH, kind="tilt")["collapse_acceleration_g"]
    loaded = run(ARCH, kind="tilt", load=[{"x": 0.0, "force": 2e5}])
    assert loaded["weight_N"] == pytest.approx(run(ARCH, kind="tilt")["weight_N"] + 2e5)
    assert loaded["collapse_acceleration_g"] != pytest.approx(plain, abs=1e-3)
    assert "lies outside the structure" in run(ARCH, kind="tilt", load=[{"x": 50.0, "force": 1.0}]).reason


def test_what_cannot_stand_is_an_answer_with_its_proof() -> None:
    """A certificate of collapse under self-weight is no refusal: safety factor 0, with where and why."""
    leaning = {"kind": "blocks", "block": [{"points": [[0, 0], [1, 0], [4, 4], [3, 4]]}]}
    for words, structure, keys in (
        ("% thicker", {**ARCH, "thickness": 0.9, "embrace": 180.0}, {}),
        ("friction must be at least 0.", ARCH, {"joints": {"friction": 0.15}}),
        ("strength", ARCH, {"material": {"compressive_strength": 2e5}}),
        ("only under a horizontal load", leaning, {}),
    ):
        for kind in ("tilt", "thrust"):
            found = run(structure, kind=kind, **keys)
            assert (found.status, found.verdict.outcome, found.verdict.ratio) == ("ok", "cannot-stand", 0.0)
            assert words in found.verdict.statement and "certificate" in found.results.certificate
            assert found.results.collapse_acceleration_g == 0.0
    pulse = {"kind": "sine-pulse", "amplitude": "0.1 g", "period": 1.0}
    deck = make_deck({"structure": {**ARCH, "thickness": 0.9, "embrace": 180.0}, "motion": pulse, "analysis": {"kind": "rocking"}})
    rocked = run_analyses(Context(deck, threads=1))[0]
    assert "least thickness for 180 deg" in rocked.verdict.statement and rocked.verdict.outcome == "cannot-stand"


def test_strength_that_the_proof_neglects_leaves_it_open() -> None:
    """Without tension the arch collapses; with mortar the proof does not hold, and the verdict says so."""
    thin = {**ARCH, "thickness": 0.9, "embrace": 180.0}
    found = run(thin, kind="tilt", joints={"tension": 1e5, "cohesion": 1e5})
    assert found.verdict.outcome == "open" and len(found.verdict.violated) == 2
    assert "tension of the joints, 0.1 MPa" in found.verdict.statement


def test_refusals_say_why() -> None:
    blocks = {"kind": "blocks", "block": [{"name": "up", "points": [[0, 1], [1, 1], [1, 2], [0, 2]]}], "ground": [[0, 0, 1, 0]]}
    assert "no block touches the ground" in run(blocks, kind="tilt").reason


@pytest.mark.parametrize(
    ("structure", "words"),
    [
        ({"kind": "blocks"}, "either a file, or"),
        ({"kind": "vault", "radius": 5.0}, "thickness is missing"),
        ({"kind": "aisled-vault", "preset": "vezelay-like", "aisle_span": 3.0}, "either aisle_span or half_width"),
        ({"kind": "vault", "preset": "dejong-c"}, "dejong-a"),
        ({"kind": "blocks", "block": [{"points": [[0, 0], [1, 0]]}]}, "at least 3"),
        ({"kind": "pointed-arch", "span": 5.0, "radius": 5.0, "thickness": 0.5, "voussoirs": "many"}, "voussoirs"),
    ],
)
def test_wrong_decks(structure: dict, words: str) -> None:
    with pytest.raises(DeckError, match=words):
        run(structure, kind="tilt")


def test_same_run_same_bits() -> None:
    one, two = (run(CHURCH, kind="tilt", joints={"friction": 0.6}) for _ in range(2))
    assert one.results == two.results
    assert all(np.array_equal(a.data, two.arrays[n].data) for n, a in one.arrays.items())


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("buttress_width", "buttress width"),
        ("structure.thickness", "thickness"),
        ("ties.0.yield_force", "yield force of tie 1"),
        ("spans.1.rise", "rise of span 2"),
        ("right.buttress_width", "right buttress width"),
        ("joints.friction", "friction of the joints"),
    ],
)
def test_axes_call_keys_by_words(key: str, words: str) -> None:
    from extrados.show.limit.sweep import spoken

    assert spoken(key) == words


def test_a_wall_that_slides_as_a_whole_says_so() -> None:
    wall = {"kind": "brickwork", "units": 8, "courses": 2, "unit_length": 0.5, "unit_height": 0.25}
    answer = run(wall, kind="tilt", joints={"friction": 0.2}).answer
    assert "at its whole base (8 joints)" in answer and "more" not in answer


def test_what_cannot_stand_moves_on_the_page(tmp_path: Path) -> None:
    """A stored run of any kind that cannot stand shows the collapse motion, which goes down."""
    leaning = {"kind": "blocks", "block": [{"points": [[0, 0], [1, 0], [4, 4], [3, 4]]}]}
    pulse = {"kind": "sine-pulse", "amplitude": "0.1 g", "period": 1.0}
    kinds = [{"kind": "tilt"}, {"kind": "rocking"}]
    made = compute(Context(make_deck({"structure": leaning, "motion": pulse, "analysis": kinds}), threads=1))
    made.write(tmp_path / "out", figures=False)
    for name in ("tilt", "rocking"):
        words, arrays = shown(Run.read(tmp_path / "out"), name)
        assert words["body"]["sort"] == "stones"
        assert arrays["body_pose"][-1, 0, 1] < arrays["body_pose"][0, 0, 1]


@pytest.mark.parametrize("strength", [2e5, 5e4])
def test_a_buttress_that_is_crushed_by_itself_carries_nothing(strength: float) -> None:
    """Weak stone: proven for the section, and at 50 kPa for its buttress alone too."""
    vault = {"kind": "vault", "radius": 5.0, "thickness": 0.6, "embrace": 157.5, "voussoirs": 12, "face": 4.65, "height": 8.0}
    asked = {"kind": "sweep", "vary": "buttress_width", "values": [2.0, 3.0], "buttress_alone": True}
    deck = {"structure": vault | {"buttress_width": 2.0}, "material": {"compressive_strength": strength}, "analysis": asked}
    found = extrados.run(deck).results[0]
    assert found.status == "ok" and found.verdict.outcome == "cannot-stand"
