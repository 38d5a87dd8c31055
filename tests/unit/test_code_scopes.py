"""Each rule of a code says what it is for, and answers that it does not apply anywhere else; what applies and is worst governs."""

from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.analyses.codes.parts import Part, en1998, height_coefficient, nzsee, shape_coefficient
from extrados.analyses.codes.research import asce43
from extrados.results.codes import Check, CodeChecks
from extrados.schema.constants import GRAVITY

CASES = Path(__file__).parents[2] / "cases"
SITE = {"code": "EN1998-1", "ground": "B", "acceleration": "0.15 g"}
QUIET = {"code": "EN1998-1", "ground": "A", "acceleration": "0.08 g"}


ASCE, NZS, EN = ({"jurisdiction": name} for name in ("ASCE41", "NZSEE", "EN1998"))


def run(mechanism: str, material: dict | None = None, code: dict | None = None, **keys: object) -> object:
    analysis = {"kind": "local-mechanism", "mechanism": mechanism, **keys}
    deck = {"material": {"density": 2000.0, **(material or {})}, "analysis": analysis}
    return extrados.run({**deck, "code": code} if code else deck)


def judged(r: object) -> object:
    return r["local-mechanism"].overall()


@pytest.mark.parametrize(
    ("mechanism", "keys"),
    [
        ("parapet", {"height": 1.625, "thickness": 0.25, "base_height": 6.0, "building_height": 7.0}),
        ("wall", {"height": 2.0, "thickness": 0.4}),
        ("tower", {"height": 40.0, "thickness": 5.0}),
        ("gable", {"height": 3.0, "thickness": 0.4, "width": 6.0}),
        ("corner", {"height": 4.0, "thickness": 0.6, "crack_angle": 30.0}),
        ("facade", {"height": 4.0, "thickness": 0.4}),
    ],
)
def test_the_slenderness_of_asce_41_is_for_walls_between_anchored_diaphragms(mechanism: str, keys: dict) -> None:
    """A parapet of h/t 6.5, a garden wall, a tower of 40 m: within the limits of the table, and none of its business."""
    r = run(mechanism, code=ASCE, one_second_acceleration="0.2 g", **keys)["local-mechanism"]
    check = r.checks["ASCE 41 slenderness"]
    assert check.verdict == "not-applicable" and "between anchored diaphragms" in check.reason
    assert check.demand <= check.capacity, "it would hold"
    parapet = r.checks["ASCE 41 parapet"]
    assert (parapet.verdict == "not-applicable") == (mechanism != "parapet")
    verdict = r.overall()
    if mechanism == "parapet":
        assert parapet.capacity == 1.5 and parapet.demand == 6.5 and verdict.outcome == "collapses"
    else:
        assert verdict.outcome == "not-applicable" and "ASCE 41 governs" not in verdict.statement


def test_a_facade_that_ties_anchor_at_its_top_has_the_slenderness_of_asce_41() -> None:
    keys = {"height": 4.0, "thickness": 0.4, "ties": [{"height": 3.8, "force": 5e3}], "one_second_acceleration": "0.2 g"}
    r = run("facade", code=ASCE, **keys)["local-mechanism"]
    assert r.checks["ASCE 41 slenderness"].verdict == "holds" and r.overall().outcome == "stands"
    low = run("facade", code=ASCE, **(keys | {"ties": [{"height": 2.0, "force": 5e3}]}))["local-mechanism"]
    assert low.checks["ASCE 41 slenderness"].verdict == "not-applicable"


@pytest.mark.parametrize(("element", "q_a"), [("parapet", 1.0), ("gable", 1.0), ("wall", 2.0), ("facade", 2.0)])
def test_the_factor_of_an_element_is_that_of_table_4_4(element: str, q_a: float) -> None:
    """alpha_0 q_a against S_a of Eq. 4.25: of a rigid part T_a = 0, and resonance, T_a = T_1, where the periods are not known."""
    line, in_plane = en1998(Part(element, 0.25, 1.2, 0.3, 9.0, 10.0, period=0.0, first=0.3), 0.18 * GRAVITY)
    assert in_plane.verdict == "not-applicable" and "only rules for in-plane failure" in in_plane.barred
    assert line.capacity == pytest.approx(0.25 * q_a) and line.demand == pytest.approx(0.18 * (3.0 * 1.9 / 2.0 - 0.5))
    assert line.verdict == ("holds" if 0.25 * q_a >= 0.423 else "fails")
    unknown, _ = en1998(Part(element, 0.25, 1.2, 0.3, 9.0, 10.0), 0.18 * GRAVITY)
    assert unknown.demand == pytest.approx(0.18 * (3.0 * 1.9 - 0.5)) and "is not known, so resonance is assumed" in unknown.note
    for other in (Part(element, 0.25, 1.2, 0.3, 0.0, None), Part(element, 0.25, 1.2, 0.3, 9.0, 10.0, loaded=True)):
        assert en1998(other, 0.18 * GRAVITY)[0].verdict == "not-applicable"
    assert en1998(Part("tower", 0.25, 1.2, 0.3, 9.0, 10.0), 0.18 * GRAVITY)[0].verdict == "not-applicable"


def test_a_parapet_at_twelve_metres_takes_the_demand_of_a_part() -> None:
    """NZS 1170.5 section 8 by hand: 0.25 x 1.625 m at 12 m, C(0) 0.08 g: 56 %NBS, where the spectrum of the ground gives 248 %."""
    h, t = 1.625, 0.25
    table = {"code": "NZS1170", "ground": "A", "hazard_factor": 0.08}
    keys = {"height": h, "thickness": t, "base_height": 12.0, "building_height": 12.0, "spectrum": table}
    r = run("parapet", code=NZS, **keys)["local-mechanism"]
    check = r.checks["NZSEE C8 parapet"]
    period, gamma = np.sqrt(0.65 * h * (1.0 + (t / h) ** 2)), 1.5 / (1.0 + (t / h) ** 2)
    part = 0.08 * 3.0 * 2.0 * (1.75 - period)
    displaced = gamma * (period / (2.0 * np.pi)) ** 2 * part * GRAVITY
    assert check.demand == pytest.approx(displaced) and check.capacity == pytest.approx(0.3 * t)
    assert 100.0 * check.capacity / check.demand == pytest.approx(30.0 * t / displaced) == pytest.approx(56.0, abs=0.5)
    ground = gamma * (period / (2.0 * np.pi)) ** 2 * 2.5 * 0.08 * GRAVITY * 0.4 / period
    assert 30.0 * t / ground == pytest.approx(248.0, abs=1.0)
    assert check.verdict == "fails" and r.overall().outcome == "collapses"
    assert r.nbs_percent == pytest.approx(56.0, abs=0.5) and r.clause == check.source


def test_the_coefficients_of_parts_of_nzs_1170() -> None:
    assert height_coefficient(0.0, 30.0) == 1.0 and height_coefficient(6.0, 60.0) == pytest.approx(2.0)
    assert height_coefficient(3.0, 10.0) == pytest.approx(1.5), "the lesser of both branches"
    assert height_coefficient(12.0, 12.0) == 3.0 and height_coefficient(12.0, 120.0) == pytest.approx(2.0)
    assert [shape_coefficient(t) for t in (0.0, 0.75, 1.25, 1.5, 3.0)] == pytest.approx([2.0, 2.0, 1.0, 0.5, 0.5])
    parapet, _ = nzsee(Part("parapet", 0.23, 1.0, 0.23, 0.0, None), None)
    assert "T_p 0.827 s" in parapet.note and parapet.capacity == pytest.approx(0.069), "Tp .8273, limit .0690 m"


@pytest.mark.parametrize("element", ["wall", "gable"])
def test_the_parapet_of_nzsee_is_no_other_wall(element: str) -> None:
    assert nzsee(Part(element, 0.2, 2.0, 0.4, 6.0, 9.0), lambda t, xi: 1.0)[0].verdict == "not-applicable"
    assert nzsee(Part("parapet", 0.2, 2.0, 0.4, 0.0, None), lambda t, xi: 1.0)[0].verdict == "not-applicable"


def test_q_is_for_a_mechanism_without_a_displacement_check() -> None:
    """C8.7.1.2.1.7: where the curve is compared, the mechanism must keep within d_SLV or not start."""
    strong = {"code": "EN1998-1", "ground": "D", "acceleration": "0.2 g"}
    r = run("wall", height=3.0, thickness=0.5, spectrum=strong)["local-mechanism"]
    linear, nonlinear, starts = (r.checks[n] for n in ("NTC linear (at the ground)", "NTC nonlinear", "NTC activation (at the ground)"))
    assert linear.verdict == "not-applicable" and "C8.7.1.2.1.7" in linear.reason
    assert nonlinear.verdict == starts.verdict == "fails" and r.overall().outcome == "collapses"
    assert linear.capacity == pytest.approx(2.0 * starts.capacity)
    peak = run("wall", height=3.0, thickness=0.5, peak_acceleration="0.2 g")["local-mechanism"]
    assert peak.checks["NTC linear (at the ground)"].verdict == "holds" and "NTC activation (at the ground)" not in peak.checks
    weak = run("wall", height=3.0, thickness=0.5, spectrum={**strong, "acceleration": "0.05 g"})["local-mechanism"]
    assert weak.checks["NTC activation (at the ground)"].verdict == "holds" and weak.overall().outcome == "stands"


@pytest.mark.parametrize("mechanism", ["parapet", "gable"])
def test_what_is_free_to_vibrate_is_not_asked_by_the_acceleration_of_the_floor(mechanism: str) -> None:
    place = {"height": 1.0, "thickness": 0.5, "width": 2.0, "base_height": 6.0, "building_height": 7.0, "spectrum": QUIET}
    r = run(mechanism, **place)["local-mechanism"]
    for name in ("NTC linear (at height z)", "NTC activation (at height z)"):
        assert r.checks[name].verdict == "not-applicable" and "C8.7.1.9" in r.checks[name].reason


def test_a_parapet_on_the_ground_is_not_said_to_stand() -> None:
    keys = {"height": 0.6, "thickness": 0.5, "spectrum": QUIET}
    verdict = judged(run("parapet", **keys))
    assert verdict.outcome == "open" and "is part of a building" in verdict.violated[0]
    assert judged(run("wall", **keys)).outcome == "stands"


def test_the_confidence_factor_of_masonry_that_is_taken_not_to_crush_is_that_of_lc1() -> None:
    """C8.7.1.2.1.3; and a capacity without any factor says so."""
    keys = {"height": 2.5, "thickness": 1.0, "spectrum": QUIET}
    assert judged(run("wall", **keys)).outcome == "stands" and judged(run("wall", **keys)).violated == []
    bare = judged(run("wall", **keys, confidence_factor=1.0))
    assert bare.outcome == "open" and "C8.7.1.2.1.3" in bare.violated[0]
    tested = judged(run("wall", {"compressive_strength": "5 MPa"}, **keys, confidence_factor=1.0))
    assert tested.outcome == "stands" and "All partial factors and confidence factors are 1" in tested.statement
    block = {
        "structure": {"kind": "block", "width": 1.0, "height": 2.5},
        "analysis": {"kind": "code-checks", "spectrum": QUIET, "peak_velocity": 0.05, "confidence_factor": 1.0},
    }
    assert extrados.run(block)["code-checks"].overall().outcome == "open"
    assert (
        "All partial factors and confidence factors are 1" in extrados.run(CASES / "codes" / "pier.toml")["code-checks"].overall().statement
    )


def test_a_body_that_its_weight_overturns_cannot_stand() -> None:
    """1 m of wall, 0.6 m by 6 m, 2000 kg/m^3: 21.18 kNm hold, 60 kNm of thrust drive: 38.82 kNm per radian."""
    (told,) = run("facade", height=6.0, thickness=0.6, floors=[{"height": 6.0, "thrust": "10 kN"}]).analyses
    assert told["status"] == "ok" and told["verdict"]["outcome"] == "cannot-stand" and told["verdict"]["ratio"] == 0.0
    held = 2000.0 * GRAVITY * 0.6 * 6.0 * 0.3
    assert f"{(60e3 - held) / 1e3:.3g} kNm" in told["verdict"]["statement"]
    thin = {"kind": "arch", "radius": 10.0, "thickness": 0.5, "embrace": 180.0, "voussoirs": 24}
    deck = {"structure": thin, "analysis": {"kind": "local-mechanism", "mechanism": "building", "peak_acceleration": "0.1 g"}}
    assert extrados.run(deck).analyses[0]["verdict"]["outcome"] == "cannot-stand"


@pytest.mark.parametrize("width", [1.0, 1.5, 2.0, 5.0])
def test_a_block_too_squat_to_rock_is_no_matter_of_asce_43(width: float) -> None:
    """Housner's coefficient 1 - 3/2 sin^2(alpha) is below 0 from b/h = sqrt 2 on: no equivalent damping, and no crash."""
    deck = {
        "structure": {"kind": "block", "width": width, "height": 1.0},
        "analysis": {"kind": "code-checks", "spectrum": SITE},
        "code": {"jurisdiction": "none", "research": ["ASCE 43"]},
    }
    run_ = extrados.run(deck)
    assert run_.analyses[0]["status"] == "ok"
    check = run_["code-checks"].checks["ASCE 43 rocking"]
    assert (check.verdict == "not-applicable") == (width > np.sqrt(2.0))
    assert asce43(width, 1.0, None).barred == check.reason


def one(capacity: float, demand: float | None, code: str, alternative: str = "", reason: str = "") -> Check:
    verdict = "not-applicable" if reason else "" if demand is None else "holds" if demand <= capacity else "fails"
    return Check(
        capacity=capacity,
        demand=demand,
        unit="g",
        quantity="",
        verdict=verdict,
        source="",
        note="",
        code=code,
        limit_state="",
        scope="",
        alternative=alternative,
        reason=reason,
    )


def test_the_worst_check_that_applies_governs() -> None:
    """Of checks of one code that are no alternatives each must hold; what does not apply never governs, whatever it says."""
    checks = {"a": one(1.0, 0.5, "X"), "b": one(0.4, 0.5, "X"), "barred": one(0.1, 0.5, "Y", reason="no")}
    verdict = CodeChecks(checks=checks).overall()
    assert verdict.outcome == "collapses" and verdict.ratio == pytest.approx(0.8)
    either = {"a": one(1.0, 0.5, "X", "either"), "b": one(0.4, 0.5, "X", "either"), "c": one(0.75, 0.5, "Y")}
    verdict = CodeChecks(checks=either).overall()
    assert verdict.outcome == "stands" and verdict.ratio == pytest.approx(1.5)
    half = {"a": one(0.4, 0.5, "X", "either"), "b": one(1.0, None, "X", "either")}
    assert CodeChecks(checks=half).overall().outcome == "not-applicable"
    none = CodeChecks(checks={"barred": one(9.0, 0.5, "Y", reason="it is a tower")}).overall()
    assert none.outcome == "not-applicable" and "it is a tower" in none.statement


def test_a_block_that_slides_first_is_not_said_to_hold() -> None:
    """1 x 2 m: rocking needs a friction of 0.5."""
    deck = {
        "structure": {"kind": "block", "width": 1.0, "height": 2.0},
        "analysis": {"kind": "code-checks", "spectrum": QUIET, "peak_velocity": 0.05},
    }
    for friction, outcome in ((0.3, "open"), (0.6, "stands"), ("no-sliding", "stands")):
        verdict = extrados.run({**deck, "joints": {"friction": friction}})["code-checks"].overall()
        assert verdict.outcome == outcome, friction
        assert any("slides first" in text for text in verdict.violated) == (friction == 0.3)


def test_a_wall_that_its_weight_crushes_cannot_stand_and_one_near_it_is_refused() -> None:
    """0.5 m by 6 m of 2000 kg/m^3 weigh 117.7 kPa on their foot."""
    keys = {"height": 6.0, "thickness": 0.5, "peak_acceleration": "0.1 g"}
    for strength, outcome in ((110e3, "cannot-stand"), (150e3, None), (1e6, "stands")):
        (told,) = run("facade", {"compressive_strength": strength}, **keys).analyses
        assert (told["verdict"] or {}).get("outcome") == outcome, strength
