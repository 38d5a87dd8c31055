"""Typed results: what a driver must give, verdicts, assumptions, and what is generated from the models."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

import extrados
from extrados import kinds
from extrados.core import lists
from extrados.results import explain, limit, manual, rocking, store
from extrados.results.assumptions import spoken
from extrados.results.dem import DemDomain
from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.model import Array, Result
from extrados.results.rocking import FailureDomain, RuleCurve, between
from extrados.results.statistics import RockingSpectrum
from extrados.results.typed import shapes, typed
from extrados.results.verdict import Verdict, judge

ROOT = Path(__file__).resolve().parents[2]
ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
PULSE = {"kind": "step-pulse", "amplitude": "0.5 g", "duration": 0.2}


class Row(ResultModel):
    """A row."""

    before: int = fact("where it begins", name="from")


class Sample(ResultModel):
    """A sample."""

    a_g: float = fact("a", "g")
    b: float | None = fact("b")
    rows: list[Row] = fact("rows")
    extra_m: float = maybe("extra", "m")


def sample(**change) -> Sample:
    return Sample(**{"a_g": np.float64(0.5), "b": float("nan"), "rows": [{"from": np.int64(3)}], **change})


@dataclass
class Asked:
    """A demand."""

    peak_g: float | None = None
    pulse: str = ""
    duration_s: float = 0.0
    amplitude_g: float = 0.0


def test_results_read_as_attributes_and_as_a_mapping() -> None:
    r = sample()
    assert r.a_g == r["a_g"] == 0.5 and r.b is None and r.rows[0].before == r["rows"][0]["from"] == 3
    assert r.extra_m is None and "extra_m" not in r and r.get("extra_m", 1.0) == 1.0
    assert r.as_json() == {"a_g": 0.5, "b": None, "rows": [{"from": 3}]} and list(r.keys()) == ["a_g", "b", "rows"]
    assert Sample.model_validate(r.as_json()) == r and sample(extra_m=2.0)["extra_m"] == 2.0
    with pytest.raises(KeyError):
        r["extra_m"]


@pytest.mark.parametrize(
    ("change", "word"), [({"a_gg": 1.0}, "a_gg"), ({"a_g": float("nan")}, "a_g"), ({"a_g": True}, "a_g"), ({"rows": [{}]}, "from")]
)
def test_a_wrong_key_or_value_fails_at_once(change: dict, word: str) -> None:
    with pytest.raises(ValidationError, match=word):
        sample(**change)


def test_a_driver_that_forgets_a_key_fails(monkeypatch) -> None:
    whole = limit.Tilt

    def forgetful(**values) -> limit.Tilt:
        del values["tilt_angle_deg"]
        return whole(**values)

    monkeypatch.setattr(limit, "Tilt", forgetful)
    row = extrados.run({"structure": ARCH, "analysis": {"kind": "tilt"}}).analysis("tilt")
    assert row["status"] == "failed" and "tilt_angle_deg" in row["reason"] and row["verdict"] is None


def test_a_driver_that_gives_another_model_fails(monkeypatch) -> None:
    monkeypatch.setattr("extrados.analyses.limit.tilt.run", lambda context, options: Result("tilt", results=sample()))
    row = extrados.run({"structure": ARCH, "analysis": {"kind": "tilt"}}).analysis("tilt")
    assert row["status"] == "failed" and "gives Sample, expected Tilt" in row["reason"]


#: How keys end that have a unit
ENDS = {
    "mm": "_mm",
    "g": "_g",
    "deg": "_deg",
    "N": "_N",
    "m": "_m",
    "m/s": "_m_s",
    "s": "_s",
    "rad": "_rad",
    "J": "_J",
    "Hz": "_Hz",
    "kg": "_kg",
    "m^2": "_m2",
    "m^3": "_m3",
    "rad/s": "_rad_s",
    "N/m": "_N_m",
    "kN/m": "_kN_per_m",
    "Pa/m": "_Pa_per_m",
    "Pa": "_Pa",
    "N*m": "_Nm",
    "1/s": "_per_s",
    "1/year": ("_rate", "_rate_interval", "_rate_left_out"),
    "year": ("years",),
    "%": "_percent",
}


#: Keys that others rely on and that tell their unit otherwise
OTHERWISE = ("duality_gap", "seconds_per_event", "sections_per_second")


@pytest.mark.parametrize("kind", kinds.ANALYSES)
def test_keys_end_in_their_unit(kind: str) -> None:
    for model in shapes(kind):
        for f in explain.facts(model):
            assert f.about, f"{f.key} says nothing of itself"
            if f.unit and not f.key.endswith(OTHERWISE):
                assert f.key.endswith(ENDS[f.unit]), f"{kind}.{f.key} is in {f.unit}"
            if not f.unit:
                assert not f.key.endswith(("_g", "_deg", "_N", "_m", "_rad", "_J", "_Hz", "_kg")), f"{kind}.{f.key}"


def test_verdict_by_comparison() -> None:
    assert judge("", 0.5, 1.0, "g") == Verdict(
        demand=0.5, capacity=1.0, unit="g", ratio=2.0, outcome="stands", bound=None, violated=[], statement=""
    )
    assert judge("", 0.5, 1.0, bound="upper").outcome == "open" and judge("", 1.5, 1.0, bound="upper").outcome == "collapses"
    assert judge("", 0.5, 1.0, bound="lower").outcome == "stands" and judge("", 1.5, 1.0, bound="lower").outcome == "open"
    for demand, outcome in ((0.5, None), (1.5, None), (0.5, "stands"), (1.5, "collapses")):
        doubted = judge("Said.", demand, 1.0, "g", outcome, violated=["Friction is too low."])
        assert doubted.outcome == "open" and doubted.statement == "Said. Friction is too low."
    assert judge("", 1.0, 1.0).outcome == "collapses" and judge("", None, 1.0).outcome == "not-applicable"
    assert judge("", 0.0, 1.0).ratio is None and judge("", 0.5, None, outcome="open").ratio is None


def test_verdicts_of_one_deck() -> None:
    run = extrados.run(
        {"structure": ARCH, "motion": PULSE, "analysis": [{"kind": "tilt"}, {"kind": "rocking", "hand_over": False}, {"kind": "thrust"}]}
    )
    tilt, rocking, thrust = (run.analysis(name)["verdict"] for name in ("tilt", "rocking", "thrust"))
    assert tilt["outcome"] == "collapses" and tilt["demand"] == pytest.approx(0.5) and tilt["unit"] == "g"
    assert tilt["ratio"] == pytest.approx(run["tilt"].collapse_acceleration_g / 0.5)
    assert rocking["outcome"] == "open" and rocking["demand"] == run["rocking"].peak_rotation_ratio
    assert run["rocking"].outcome == "recovery" and "thrust line passes outside" in rocking["violated"][0]
    assert thrust["ratio"] == pytest.approx(run["thrust"].geometric_safety_factor)
    assert all(v["statement"].endswith(".") for v in (tilt, rocking, thrust))
    calm = extrados.run({"structure": ARCH, "analysis": {"kind": "tilt"}}).analysis("tilt")["verdict"]
    assert (calm["outcome"], calm["demand"], calm["ratio"]) == ("not-applicable", None, None) and calm["capacity"] > 0.0
    short = extrados.run({"structure": ARCH, "motion": PULSE, "analysis": {"kind": "rocking", "end_time": 0.3}})
    assert short.analysis("rocking")["verdict"]["outcome"] == "open"


def test_a_pulse_against_failure_curves() -> None:
    assert between([2.0, 1.0, 3.0], [20.0, 10.0, None], 1.5) == 15.0
    assert between([1.0, 2.0], [10.0, None], 1.5) is None and between([1.0, 2.0], [1.0, 2.0], 2.5) is None
    curve = {"durations_s": [0.2, 0.4], "amplitudes_g": [1.0, 0.5]}
    domain = FailureDomain(
        pulse="step",
        mode_I=curve,
        mode_II=curve,
        pocket_begins_g=[None, None],
        uplift_acceleration_g=0.3,
        restitution=0.9,
        natural_time_s=1.0,
        safe_pockets=0,
        sliding_from_g=[None, 0.9],
        hinges_elsewhere_from_g=[0.95, None],
        conditions={"not_checked": "", "violated": []},
    )
    slides = domain.judged(Asked(pulse="step", duration_s=0.4, amplitude_g=0.92))
    assert slides.outcome == "open" and slides.violated == [
        "For pulses of 0.4 s, blocks slide from an amplitude of 0.9 g upwards. Use dem, or check the friction."
    ]
    elsewhere = domain.judged(Asked(pulse="step", duration_s=0.3, amplitude_g=0.96))
    assert elsewhere.outcome == "open" and len(elsewhere.violated) == 2
    rules = domain.model_copy(
        update={
            "amplitudes_by_rule": [
                RuleCurve(rule=rule, restitution=0.5, amplitudes_g=a) for rule, a in (("thesis", [1.0, 0.5]), ("inelastic", [2.0, 1.0]))
            ]
        }
    )
    between_rules = rules.judged(Asked(pulse="step", duration_s=0.3, amplitude_g=0.8))
    assert between_rules.outcome == "open"
    assert between_rules.violated == ['The impact rule decides the outcome: "thesis" collapses, "inelastic" stands.']
    assert rules.judged(Asked(pulse="step", duration_s=0.3, amplitude_g=0.7)).outcome == "stands"
    assert domain.judged(Asked(pulse="step", duration_s=0.3, amplitude_g=0.7)).outcome == "stands"
    assert domain.judged(Asked(pulse="step", duration_s=0.3, amplitude_g=0.8)).outcome == "collapses"
    assert domain.judged(Asked(pulse="sine", duration_s=0.3, amplitude_g=0.8)).outcome == "not-applicable"
    blocks = DemDomain(
        pulse="step", amplitudes_g=[0.5, 1.0], shortest_durations_s=[0.4, 0.2], curves=[], energy_residual_ratio=0.0, steps=1
    )
    assert blocks.judged(Asked(pulse="step", duration_s=0.25, amplitude_g=0.75)).outcome == "stands"
    assert blocks.judged(Asked(pulse="step", duration_s=0.35, amplitude_g=0.75)).outcome == "collapses"


def test_assumptions_state_their_source() -> None:
    deck = {
        "structure": ARCH,
        "material": {"density": 2200.0},
        "analysis": [
            {"kind": "tilt"},
            {"kind": "tilt", "joints": {"friction": "no-sliding"}},
            {"kind": "sweep", "vary": "joints.friction", "values": [0.5, 0.6]},
        ],
    }
    run = extrados.run(deck)
    first, second, sweep = (run.analysis(name) for name in ("tilt", "tilt-2", "sweep"))
    assert first["assumptions"]["joints.friction"] == {"value": 0.7, "unit": "", "from": "default", "exceptions": False}
    assert first["assumptions"]["material.density"]["from"] == "deck"
    assert first["assumptions"]["material.density"]["unit"] == "kg/m^3"
    assert first["answer"].endswith(" Friction 0.7 (default), density 2200 kg/m^3 (deck).")
    assert second["assumptions"]["joints.friction"]["from"] == "analysis"
    assert second["answer"].endswith(" No sliding (analysis), density 2200 kg/m^3 (deck).")
    assert "joints.friction" not in sweep["assumptions"]
    assert spoken({}) == ""
    rocking = extrados.run({"structure": ARCH, "motion": PULSE, "analysis": {"kind": "rocking"}}).analysis("rocking")
    assert rocking["assumptions"]["joints.friction"]["from"] == "default" and " Friction 0.7 (default), " in rocking["answer"]
    typed_joints = {**deck, "joints": {"types": [{"joints": ["ground"], "friction": 0.4}]}, "analysis": {"kind": "tilt"}}
    assert "friction 0.7 (default, some differ)" in extrados.run(typed_joints).analysis("tilt")["answer"].lower()


def test_stored_results_of_another_version_are_reported(tmp_path) -> None:
    extrados.run({"structure": ARCH, "analysis": {"kind": "tilt"}}, tmp_path / "o")
    run = store.read(tmp_path / "o")
    assert run["tilt"].collapse_acceleration_g == run["tilt"]["collapse_acceleration_g"]
    del run.analysis("tilt")["results"]["duality_gap"]
    fresh = store.Stored(run.folder, run.head, run.analyses, run.arrays)
    with pytest.raises(store.StoreError, match="duality_gap"):
        fresh["tilt"]


def test_series_of_arrays_keep_their_order(tmp_path) -> None:
    values = RockingSpectrum(
        family=["x"],
        overturned=[0],
        longest_overturning_period_s=[None],
        size_m=[1.0],
        peak_ground_acceleration_g=0.1,
        conditions=[{"not_checked": "", "violated": []}],
    )
    result = Result("rocking-spectrum", results=values)
    result.arrays = {f"part_{k}": Array(np.full(2, k), (f"n_{k}",), series="part") for k in range(12)}
    with store.NewFolder(tmp_path / "o") as folder:
        head = {"extrados": {"version": ""}, "deck": {"path": "", "sha256": "", "resolved": {}}}
        store.write(folder, head, [result])
    found = store.read(tmp_path / "o").series("rocking-spectrum", "part")
    assert [int(a.data[0]) for a in found] == list(range(12))


def test_explain() -> None:
    results = explain.everything()

    def told(word: str) -> str:
        return manual.explain(word, results)

    assert told("results.tilt.collapse_acceleration_g").startswith("results.tilt.collapse_acceleration_g [g]: ")
    assert "hinges[].x_m [m]" in told("results.tilt") and "sla" in told("results")
    assert told("results.fragility").count("fragility:") == 3
    assert told("results.tilt.verdict") == told("results.verdict")
    assert "statement: the verdict" in told("results.verdict")
    with pytest.raises(KeyError, match="collapse_acceleration_g"):
        told("results.tilt.colapse_acceleration")
    with pytest.raises(KeyError, match="tilt"):
        told("results.tlit")


def test_schema_refuses_what_the_models_refuse() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    run = extrados.run({"structure": ARCH, "analysis": {"kind": "tilt"}})
    validator = jsonschema.Draft202012Validator(explain.json_schema())
    jsonschema.Draft202012Validator.check_schema(validator.schema)
    validator.validate(run.summary)
    for change in ({"results": {}}, {"verdict": None}, {"results": {**run["tilt"].as_json(), "x": 1}}, {"kind": "tlit"}):
        broken = {**run.summary, "analyses": [{**run.summary["analyses"][0], **change}]}
        assert not validator.is_valid(broken), change
    refused = {**run.summary["analyses"][0], "status": "refused", "reason": "r", "verdict": None, "results": {}}
    assert validator.is_valid({**run.summary, "analyses": [refused]})


def test_typed_takes_each_shape() -> None:
    assert typed("tilt", {}).keys() == set()
    with pytest.raises(ValidationError):
        typed("dem", {"outcome": "collapse"})


def test_results_have_a_short_repr_and_a_wrong_name_lists_the_right_ones() -> None:
    live = extrados.live(Path(__file__).parents[2] / "cases" / "arch" / "readme.toml")
    run, building = live.run(), live.deck.building
    shown = [run, live, live.deck, run["rocking"], run.results, run.arrays["rocking"]["rotation"]]
    for thing in [*shown, building.blocks(), building.rigid(), building.rocker()]:
        assert len(repr(thing)) < 1200 and "array(" not in repr(thing) and " object at " not in repr(thing)
    with pytest.raises(KeyError, match="rocking has no array 'rotaton'; the arrays are: time, ground, "):
        run.array("rocking", "rotaton")
    with pytest.raises(KeyError, match="no result has the key 'colapse'; the keys are: collapse_acceleration_g"):
        run["tilt"]["colapse"]


def test_stored_outcomes_are_numbered_as_in_the_core() -> None:
    """Figures read stored numbers by results.rocking, which may not ask the core."""
    numbers = lists.numbers("rocking_outcome")
    assert numbers == {word: k for k, word in enumerate(get_args(rocking.RockingOutcome))}
    assert (rocking.NO_HINGING, rocking.RECOVERY, rocking.COLLAPSE) == tuple(numbers.values())


def test_the_schema_distinguishes_models_of_one_name() -> None:
    """Two rooms may each have a Variation: what the schema of all says of a kind is what its own says."""

    def whole(part: Any, definitions: dict[str, Any]) -> Any:
        if isinstance(part, dict) and "$ref" in part:
            return whole(definitions[part["$ref"].rpartition("/")[2]], definitions)
        if isinstance(part, dict):
            return {key: whole(value, definitions) for key, value in part.items() if key != "$defs"}
        return [whole(value, definitions) for value in part] if isinstance(part, list) else part

    schema = explain.json_schema()
    branches = schema["properties"]["analyses"]["items"]["oneOf"]
    assert len(branches) == len(kinds.ANALYSES)
    for branch in branches:
        model = kinds.load(kinds.ANALYSES[branch["properties"]["kind"]["const"]].results)
        own = TypeAdapter(model).json_schema(mode="serialization")
        found = whole(branch["properties"]["results"]["anyOf"][0], schema["$defs"])
        assert found == whole(own, own.get("$defs", {})), branch["properties"]["kind"]
