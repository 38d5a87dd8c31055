"""The live model recomputes what a changed value touches, and nothing else: calls are counted."""

from collections import Counter

import numpy as np
import pytest

import extrados
from extrados import kinds
from extrados.decks.reader import DeckError
from extrados.model.structures.arch import Arch
from extrados.motions import from_deck

ARCH = {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 9}
RECORD = {"kind": "record", "file": "extrados:el-centro-1940", "scale": 0.7}


def deck(*analyses: str, **tables) -> dict:
    return {"structure": ARCH, "motion": RECORD, "analysis": [{"kind": k} for k in analyses], **tables}


@pytest.fixture
def calls(monkeypatch) -> Counter:
    """How often stones were made, a motion was read, and each analysis ran."""
    counted: Counter = Counter()
    assembly, load, motion = Arch.assembly, kinds.load, from_deck.make_motion

    def count_stones(self, *args):
        counted["stones"] += 1
        return assembly(self, *args)

    def count_motion(*args):
        counted["motion"] += 1
        return motion(*args)

    def count_driver(place: str):
        found = load(place)
        if not place.endswith(":run"):
            return found

        def run(context, options):
            counted[options.kind] += 1
            return found(context, options)

        return run

    monkeypatch.setattr(Arch, "assembly", count_stones)
    monkeypatch.setattr(from_deck, "make_motion", count_motion)
    monkeypatch.setattr(kinds, "load", count_driver)
    return counted


def test_nothing_runs_before_a_result_is_requested(calls) -> None:
    live = extrados.live(deck("tilt", "rocking"))
    assert not calls
    first = live["tilt"]["collapse_acceleration_g"]
    assert live["tilt"]["collapse_acceleration_g"] == first
    assert calls == {"stones": 1, "tilt": 1}


def test_the_scale_of_a_record_touches_neither_stones_nor_limit_analysis(calls) -> None:
    live = extrados.live(deck("tilt", "rocking"))
    live.run()
    assert calls == {"stones": 1, "tilt": 1, "rocking": 1, "motion": 1}
    live.set("motion.scale", 0.9)
    peak = live["rocking"]["peak_rotation_rad"]
    live.run()
    assert calls == {"stones": 1, "tilt": 1, "rocking": 2, "motion": 2}
    assert peak == extrados.run(deck("rocking") | {"motion": {**RECORD, "scale": 0.9}})["rocking"]["peak_rotation_rad"]


def test_friction_remakes_no_stones(calls) -> None:
    live = extrados.live(deck("tilt"))
    before = live["tilt"]["collapse_acceleration_g"]
    live.set("joints.friction", 0.3)
    assert live["tilt"]["collapse_acceleration_g"] < before
    assert calls == {"stones": 1, "tilt": 2}


def test_a_table_that_an_analysis_does_not_read_leaves_its_result(calls) -> None:
    live = extrados.live(deck("tilt", "rocking"))
    live.run()
    live.set("initial.rotation_ratio", 0.2)
    live.set("title", "Another word")
    live.run()
    assert calls["tilt"] == 1 and calls["rocking"] == 2
    live.set("analysis.rocking.end_time", 3.0)
    live.run()
    assert calls["tilt"] == 1 and calls["rocking"] == 3


def test_a_value_that_was_there_before_is_not_computed_again(calls) -> None:
    live = extrados.live(deck("tilt"))
    first = live["tilt"]
    live.set("structure.thickness", "25 cm")
    assert live["tilt"]["collapse_acceleration_g"] > first["collapse_acceleration_g"]
    live.set("structure.thickness", 0.2)
    assert live["tilt"] == first
    assert calls == {"stones": 2, "tilt": 2}


def test_a_changed_model_answers_like_a_fresh_run() -> None:
    live = extrados.live(deck("tilt", "rocking", "assessment"))
    live.run()
    changed = deck("tilt", "rocking", "assessment", joints={"restitution": "energy-safe"}, material={"density": 1800.0})
    changed["structure"] = {**ARCH, "thickness": 0.18}
    live.update({"structure.thickness": 0.18, "joints.restitution": "energy-safe", "material.density": 1800.0})
    there, fresh = live.run(), extrados.run(changed)
    for one, two in zip(there.analyses, fresh.analyses, strict=True):
        assert {**one, "seconds": 0} == {**two, "seconds": 0}
    assert np.array_equal(live.array("rocking", "rotation"), fresh.array("rocking", "rotation"))
    assert there.summary["deck"]["resolved"] == fresh.summary["deck"]["resolved"]


def test_overrides_of_one_analysis_leave_the_other(calls) -> None:
    live = extrados.live(deck("tilt", "tilt"))
    live.run()
    live.set("analysis.tilt-2.joints.friction", 0.3)
    assert live["tilt-2"]["collapse_acceleration_g"] < live["tilt"]["collapse_acceleration_g"]
    assert (calls["stones"], calls["tilt"]) == (1, 2), "the two were equal at first, and the first stayed as it was"


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("structure.thickness", -1.0, "structure.thickness"),
        ("structure.thikness", 0.2, "did you mean 'thickness'"),
        ("structure.thickness", "20 s", "is not a unit of m"),
        ("analysis.dem.end_time", 3.0, "no analysis 'dem'; its analyses are tilt"),
        ("analysis", 3.0, "expected a table"),
        ("structure.radius.inner", 3.0, "'radius' is not a table"),
        ("joints.types.3.friction", 0.2, "joints.types"),
        ("structure.radius", None, "radius is missing"),
    ],
)
def test_a_wrong_value_is_named_and_changes_nothing(key, value, text) -> None:
    live = extrados.live(deck("tilt"))
    before, was = live["tilt"], live.deck
    with pytest.raises(DeckError, match=text):
        live.update({"joints.friction": 0.1, key: value})
    assert live.deck is was and live["tilt"] == before


def test_none_takes_a_key_out() -> None:
    live = extrados.live(deck("tilt", joints={"friction": 0.3}))
    slides = live["tilt"]["collapse_acceleration_g"]
    live.set("joints.friction", None)
    assert live["tilt"]["collapse_acceleration_g"] > slides


def test_a_refusal_is_an_answer_and_gives_way_to_the_next(calls) -> None:
    live = extrados.live(deck("tilt"))
    live.set("structure.thickness", 0.02)
    assert live.result("tilt").verdict.outcome == "cannot-stand" and live["tilt"]["safety_factor"] == 0.0
    live.set("structure.thickness", 0.2)
    assert live.result("tilt").status == "ok"


def test_what_there_is_not_is_named() -> None:
    live = extrados.live(deck("tilt"))
    with pytest.raises(KeyError, match=r"tilt has no array 'gama'; its arrays are .*outline"):
        live.array("tilt", "gama")


def test_a_refusal_reports_what_it_assumed_and_a_fault_in_a_verdict_is_no_traceback(monkeypatch) -> None:
    live = extrados.live(deck("tilt"))
    live.set("structure.thickness", 0.02)
    assert live.result("tilt").assumptions["joints.friction"].value == 0.7
    live.set("structure.thickness", 0.2)

    def fault(self, asked) -> None:
        raise ZeroDivisionError("of ours")

    monkeypatch.setattr(type(live["tilt"]), "judged", fault)
    found = live.result("tilt")
    assert found.status == "failed" and "ZeroDivisionError: of ours" in found.reason
    assert b"in fault" in found.files["internal-error-tilt.txt"]


def test_what_is_kept_is_bounded(monkeypatch) -> None:
    live = extrados.live(deck("tilt"))
    monkeypatch.setattr("extrados.running.live.MOST_VIEWS", 3)
    monkeypatch.setattr("extrados.running.live.MOST_RESULTS", 4)
    for k in range(8):
        live.set("structure.thickness", 0.2 + 0.001 * k)
        live["tilt"]
    assert len(live._views) <= 3 and sum(map(len, live._results.values())) <= 4
