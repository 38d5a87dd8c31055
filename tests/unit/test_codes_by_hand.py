"""Rules of codes against hand calculation by another route, and [code] as a table."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import extrados
from extrados.analyses.codes import ntc
from extrados.analyses.codes.bending import HorizontalBending, VerticalBending, vertical_bending
from extrados.analyses.codes.parts import Part, asce41, one_way
from extrados.analyses.codes.piers import Pier, asce41_piers, en1998_piers, ntc_piers, weakest
from extrados.decks.reader import DeckError, make_deck
from extrados.motions.code_spectra import nzs1170
from extrados.schema.code import Code, return_factor
from extrados.schema.constants import GRAVITY
from extrados.show import style
from extrados.show.codes import draw_local_mechanism

WALL = {"kind": "local-mechanism", "mechanism": "wall", "height": 3.0, "thickness": 0.5}


def test_a_wall_between_floors_by_the_equilibrium_of_its_two_bodies() -> None:
    """The crack as a hinge: moments of each body about its own hinge, the horizontal force at the top eliminated; not by work."""
    h, t, weight, load = 3.2, 0.35, 22e3, 8e3
    found = vertical_bending(h, t, 1.0, weight, load, 0.175, None)

    def multiplier(h1: float) -> float:
        h2 = h - h1
        p1, p2 = weight * h1 / h, weight * h2 / h

        def residual(a: float) -> float:
            # upper body about the inner edge of the crack: the reaction at the top (inward) balances inertia, weight and load
            r = (a * p2 * 0.5 * h2 + p2 * 0.5 * t + load * (t - 0.175)) / h2
            # whole wall about its outer edge at the foot
            return a * (p1 * 0.5 * h1 + p2 * (h1 + 0.5 * h2)) - r * h - (p1 + p2) * 0.5 * t - load * 0.175

        return residual(0.0) / (residual(0.0) - residual(1.0))

    grid = np.linspace(0.05 * h, 0.95 * h, 20001)
    least = min(grid, key=multiplier)
    assert found.crack == pytest.approx(least, abs=2e-3 * h) and found.multiplier() == pytest.approx(multiplier(least), rel=1e-6)


def test_a_wall_between_floors_moves_as_two_rigid_bodies() -> None:
    body = VerticalBending(3.0, 0.4, 20e3, 10e3, 0.15, 1.9, (0.02, 0.01))
    for q in (0.01, 0.06):
        (x0, y0), (x1, y1) = body.places(q - 1e-6), body.places(q + 1e-6)
        dx, dy = body.rates(q)
        assert (x1 - x0) / 2e-6 == pytest.approx(dx, abs=1e-7) and (y1 - y0) / 2e-6 == pytest.approx(dy, abs=1e-7)
    x, _ = body.places(0.06)
    assert x[2] == pytest.approx(-0.15), "the floor holds the top"
    assert body.multiplier(body.ultimate()) == pytest.approx(0.0, abs=1e-9)
    crushed = vertical_bending(3.0, 0.4, 1.0, 20e3, 10e3, 0.2, 1e6)
    assert crushed.multiplier() < vertical_bending(3.0, 0.4, 1.0, 20e3, 10e3, 0.2, None).multiplier()


def test_arching_between_side_walls_by_moments_of_half_a_strip() -> None:
    """Half of a uniformly loaded three-hinged arch: H t = q L^2/8; and it becomes straight where its rise is used up."""
    strip = HorizontalBending(6.0, 0.45, 30e3, 12e3)
    assert strip.multiplier() == pytest.approx(12e3 * 0.45 / (30e3 * 6.0 / 8.0))
    assert math.tan(strip.ultimate()) == pytest.approx(0.45 / 3.0, rel=1e-9)
    pushed = HorizontalBending(6.0, 0.45, 30e3, 12e3, push=2e3)
    assert pushed.multiplier() == pytest.approx(strip.multiplier() - 2e3 / 30e3)
    keys = {"kind": "local-mechanism", "mechanism": "horizontal-bending", "height": 2.0, "thickness": 0.45, "width": 6.0}
    crushing = {"material": {"density": 1800.0, "compressive_strength": 1e6}, "analysis": {**keys, "abutment_force": "90 kN"}}
    free = {"material": {"density": 1800.0}, "analysis": {**keys, "abutment_force": "90 kN"}}
    low, high = (extrados.run(d)["local-mechanism"].multiplier for d in (crushing, free))
    assert low / high == pytest.approx((0.45 - 0.045) / 0.45), "90 kN compress 45 mm of 2 m at 1 MPa"


def test_a_flanked_strip_arches_until_it_crushes() -> None:
    """Side walls that do not move: of all compressed depths a the moment f h a (t - a) is greatest at t/2, by a search here."""
    table = {
        "kind": "local-mechanism",
        "mechanism": "horizontal-bending",
        "height": 2.0,
        "thickness": 0.45,
        "width": 6.0,
        "peak_acceleration": "0.2 g",
    }
    material = {"density": 1800.0, "compressive_strength": 0.2e6}
    r = extrados.run({"material": material, "analysis": table})["local-mechanism"]
    weight = 1800.0 * GRAVITY * 0.45 * 2.0 * 6.0
    most = max(0.2e6 * 2.0 * 0.45 * k / 1000 * (0.45 - 0.45 * k / 1000) for k in range(1, 1000))
    assert r.multiplier == pytest.approx(8.0 * most / (weight * 6.0), rel=1e-9)
    assert r.zero_displacement_m is None, "blocks that crush are not rigid: the linear check decides"
    checks = {name for name, c in r.checks.items() if c.verdict in ("holds", "fails")}
    assert checks and not any("nonlinear" in name for name in checks)
    held = extrados.run({"material": material, "analysis": {**table, "abutment_force": "50 kN"}})["local-mechanism"]
    assert held.multiplier < r.multiplier, "a force that the side walls limit is less than what crushing allows"
    bare = extrados.run({"material": {"density": 1800.0}, "analysis": table})
    assert bare.summary["analyses"][0]["status"] == "refused"
    assert "compressive_strength" in bare.summary["analyses"][0]["reason"]


def test_wings_of_a_facade_are_weights_about_its_hinge() -> None:
    wings = [{"height": 4.0, "thickness": 0.5, "width": 2.0}, {"foot": 6.0, "height": 8.0, "thickness": 0.3, "width": 3.0, "setback": 0.1}]
    table = {"kind": "local-mechanism", "mechanism": "facade", "height": 6.0, "thickness": 0.6, "width": 3.0, "wings": wings}
    r = extrados.run({"material": {"density": 1800.0}, "analysis": table})["local-mechanism"]
    parts = [(0.6 * 3 * 6, 0.3, 3.0), (0.5 * 2 * 4, 0.25, 2.0), (0.3 * 3 * 2, 0.25, 7.0)]
    held, drive = (sum(v * p[k] for v, *p in parts) for k in (0, 1))
    assert r.multiplier == pytest.approx(held / drive)


def test_the_floor_spectrum_of_several_modes_is_the_root_of_the_sum_of_squares() -> None:
    """[C7.2.5]: the single mode of the example, with a second one added by hand."""

    def ground(period: float, damping: float) -> float:
        return 4.0 * math.sqrt(10.0 / (5.0 + 100.0 * damping))

    first, second = ntc.FloorMode(0.4, 1.1), ntc.FloorMode(0.12, -0.3, 0.04)
    both = ntc.Floor(ground, (first, second))
    for period in (0.0, 0.1, 0.3, 0.4):
        single = [ntc.Floor(ground, (m,)) for m in (first, second)]
        # below T_1 no spectrum is bounded by that of the ground, the second mode's own by hand
        top = 1.1 / math.sqrt(0.04) * math.sqrt(10.0 / 13.0)
        a_2 = 0.3 * ground(0.12, 0.04) * math.sqrt(1.0 + 4e-4 * 16.0)
        late = period / (1.1 * 0.12)
        by_hand = (
            top * a_2 / (1.0 + (top - 1.0) * (1.0 - period / (0.8 * 0.12)) ** 1.6)
            if period < 0.096
            else top * a_2
            if period <= 1.1 * 0.12
            else top * a_2 / (1.0 + (top - 1.0) * (late - 1.0) ** 1.2)
        )
        assert both(period, 0.08) == pytest.approx(math.hypot(single[0](period, 0.08), by_hand))
    modes = [{"period": 0.4, "participation": 1.1, "shape": 1.0}]
    base = {**WALL, "base_height": 6.0, "building_height": 9.0}
    site = {"code": "EN1998-1", "ground": "B", "acceleration": "0.15 g"}
    r = extrados.run({"analysis": {**base, "modes": modes, "spectrum": site}})["local-mechanism"]
    assert r.floor_acceleration_g == pytest.approx(2.5 * 0.18 * 1.1 * math.sqrt(1.01))
    with pytest.raises(DeckError, match="the key `modes` already gives its value"):
        make_deck({"analysis": {**base, "modes": modes, "storeys": 3}})


def test_a_free_part_answers_at_its_own_period() -> None:
    """[C8.7.1.7]: 2 pi/1.8751^2 sqrt(rho A L^4/(E I)) of a cantilever; its demand is S_eZ(T_0) at SLD and SLV."""
    h, t, rho, young = 2.0, 0.3, 1800.0, 1.2e9
    exact = 2.0 * math.pi / 1.87510407**2 * math.sqrt(rho * 12.0 * h**4 / (young * t**2))
    assert ntc.own_period(h, t, rho, young) == pytest.approx(exact, rel=2e-3)
    code = {
        "jurisdiction": "NTC",
        "limit_states": ["SLD", "SLV"],
        "ground": "B",
        "accelerations": ["0.05 g", "0.15 g"],
        "corner_periods": [0.3, 0.33],
    }
    table = {"kind": "local-mechanism", "mechanism": "chimney", "height": h, "thickness": t, "base_height": 8.0, "building_height": 10.0}
    r = extrados.run({"material": {"density": rho, "young": young}, "code": code, "analysis": table})["local-mechanism"]
    low = r.checks["NTC activation at SLD (at height z)"]
    s_s = 1.2  # 1.40 - 0.40 F_0 a_g/g is above its bound of 1.2
    period, first = ntc.own_period(h, t, rho, young), 0.05 * 10.0**0.75
    a_z = 2.5 * 0.05 * s_s * 0.8 * 4.0 / 3.0 * math.sqrt(1.01)  # 10 m: four storeys
    assert 1.10 * 0.3**-0.20 * 0.3 > first > 1.10 * 0.3**-0.20 * 0.3 / 3.0, "on the plateau"
    amplified = 1.1 / math.sqrt(0.05)
    assert period < 0.8 * first
    asked = amplified * a_z / (1.0 + (amplified - 1.0) * (1.0 - period / (0.8 * first)) ** 1.6)
    assert low.demand == pytest.approx(asked) and low.limit_state == "SLD" and "T_0" in low.note
    high = r.checks["NTC activation (at height z)"]
    assert high.demand == pytest.approx(3.0 * asked), "a_g of SLV is three times that of SLD, S and the plateau are alike"
    rows = [r.checks[n] for n in ("NTC nonlinear", "NTC activation (at height z)")]
    assert r.zeta_E == pytest.approx(max(c.capacity / c.demand for c in rows))
    bare = extrados.run({"code": code, "analysis": table})["local-mechanism"].checks["NTC activation at SLD (at height z)"]
    assert bare.verdict == "not-applicable" and "Give `young` of [material]" in bare.reason


def test_the_peak_of_the_first_example_of_the_circolare() -> None:
    """Wall with P and Q of cases/codes/circolare: linear a_g,SLV = q a_0/S = 0.1220 g is over that of the deck."""
    floors = [{"height": 3.0, "load": "10 kN", "arm": 0.25}, {"height": 3.0, "pushing": "5 kN"}]
    table = {"kind": "local-mechanism", "mechanism": "facade", "height": 3.0, "thickness": 0.4, "floors": floors}
    deck = {"material": {"density": 18e3 / GRAVITY}, "analysis": {**table, "peak_acceleration": f"{0.1 * 1.2} g"}}
    assert extrados.run(deck)["local-mechanism"].zeta_E == pytest.approx(1.220, abs=1e-3)


def test_the_shear_of_a_cracked_foot_counts_on_its_compressed_length() -> None:
    """Equilibrium of the foot by bisection: a triangle of compression under N at the eccentricity V H_0/N."""
    pier = Pier(1.0, 2.0, 0.3, 60e3, 10e3, False, 3e6, 0.1e6, 0.4)
    f, c, n = 3e6 / 1.35, 0.1e6 / 1.35, 70e3

    def spare(v: float) -> float:
        pressed = min(1.0, 3.0 * (0.5 - v * 2.0 / n))
        return min(c + 0.4 * n / (pressed * 0.3), 0.065 * f) * pressed * 0.3 - v

    shear = brentq(spare, 1.0, n * 0.5 / 2.0 - 1e-6)
    line = next(x for x in en1998_piers(pier, 1.35, None, "SD") if x.rule == "EN 1998-3 shear")
    whole = min(c + 0.4 * n / 0.3, 0.065 * f) * 0.3
    assert line.capacity == pytest.approx(shear, rel=1e-9) and line.capacity < 0.5 * whole
    stocky = Pier(3.0, 0.5, 0.3, 60e3, 10e3, True, 3e6, 0.1e6, 0.4)
    assert stocky.sliding(0.1e6, None) == (pytest.approx(0.1e6 * 0.9 + 0.4 * 70e3), 3.0), "its foot does not crack"


def test_the_flexure_of_en_1998_3_and_its_drifts() -> None:
    """Note on codes, test 7: D 1.5, t 0.3, N 200 kN, H_0 1.25, f_d 3/1.35 MPa."""
    pier = Pier(1.5, 2.5, 0.3, 200e3, 0.0, True, 3e6, 0.2e6, 0.4)
    found = {x.rule: x.capacity for x in en1998_piers(pier, 1.35, None, "SD")}
    assert found["EN 1998-3 flexure"] == pytest.approx(92.40e3, rel=1e-4)
    assert found["EN 1998-3 drift in flexure"] == pytest.approx(0.006667, rel=1e-4)
    late = {x.rule: x.capacity for x in en1998_piers(pier, 1.35, None, "NC")}
    assert late["EN 1998-3 drift in flexure"] == pytest.approx(0.008889, rel=1e-4)


def test_the_confidence_factor_of_ntc_lowers_every_strength_of_a_pier() -> None:
    pier = Pier(1.0, 2.0, 0.4, 80e3, 14e3, False, 2.6e6, 0.13e6, 0.4, 0.05e6)
    bare, sure = ({x.rule: x.capacity for x in ntc_piers(pier, fc, 1.0, None, "SLV")} for fc in (1.0, 1.35))
    for name in ("NTC flexure", "NTC diagonal cracking"):
        assert sure[name] < bare[name], name
    assert sure["NTC sliding"] <= bare["NTC sliding"], "flexure bounds it in a slender pier"
    tension = 1.5 * 0.05e6 / 1.35
    assert sure["NTC diagonal cracking"] == pytest.approx(0.4 * tension / 1.5 * math.sqrt(1.0 + 94e3 / 0.4 / tension))


def test_a_peak_acceleration_is_a_demand_on_a_pier() -> None:
    deck = {
        "structure": {"kind": "panel", "width": 1.0, "height": 2.0, "thickness": 0.4},
        "joints": {"cohesion": 0.13e6},
        "material": {"density": 1800.0, "compressive_strength": 2.6e6},
        "analysis": {"kind": "code-checks", "axial_load": "80 kN", "diagonal_strength": 0.05e6, "peak_acceleration": "0.6 g"},
    }
    load = 80e3 + 1800.0 * 0.8 * GRAVITY
    r = extrados.run({**deck, "code": {"jurisdiction": "NTC"}})["code-checks"]
    check = r.checks["NTC diagonal cracking"]
    assert check.demand == pytest.approx(0.6 * load / 2.0) and "gamma_M 2" in check.note and check.verdict == "fails"
    free = extrados.run({**deck, "analysis": {**deck["analysis"], "peak_acceleration": "0.01 g"}})["code-checks"]
    assert free.overall().outcome == "stands" and r.overall().outcome == "collapses"
    lateral = extrados.run({**deck, "code": {"jurisdiction": "ASCE41", "knowledge_level": "usual"}})["code-checks"]
    assert lateral.checks["ASCE 41 toe crushing"].demand == pytest.approx(0.6 * load)
    nz = extrados.run({**deck, "code": {"jurisdiction": "NZSEE"}})["code-checks"].overall()
    assert nz.outcome == "not-applicable" and "was not available" in nz.statement


def test_residual_sliding_is_no_least_strength() -> None:
    """Wall 1 of the printed example: 5726, 8493, 5442, 4960, 7941 kg; V_bjs2 is what is left beyond IO."""
    stress = GRAVITY / 1e-4
    pier = Pier(0.93, 1.8, 0.35, 8000.0 * GRAVITY, 2864.0 * GRAVITY, True, 60.0 * stress, 2.5 * stress, 0.4, 2.0 / 1.5 * stress)
    rows = asce41_piers(pier, 1.0, None, 1.0, "LS")
    residual = next(x for x in rows if "residual" in x.rule)
    least = weakest(rows)
    assert least is not None and residual.capacity < least.capacity and residual.quantity == "residual strength"
    assert next(x for x in rows if "bed-joint" in x.rule).verdict == "not-applicable"
    early = {x.rule: x.verdict for x in asce41_piers(pier, 1.0, None, 1.0, "IO")}
    assert early["ASCE 41 residual sliding"] == "not-applicable" and early["ASCE 41 bed-joint sliding"] == ""
    doubtful = {x.rule: x.capacity for x in asce41_piers(pier, 1.0 / 0.75, None, 1.0, "LS")}
    assert doubtful["ASCE 41 toe crushing"] == pytest.approx(0.75 * next(x.capacity for x in rows if "toe" in x.rule))


def test_a_one_way_wall_by_nzsee() -> None:
    """Note on codes, test 10: W 12.42, t_e 0.2219, a 33.63, b 4.421, D_i 0.1972, J 1.089, gamma 1.308, T_p 0.7325; 135.7 %NBS at C_p 0.5."""
    w = one_way(3.0, 0.23, 12.42e3, 5e3)
    assert [w.effective, w.a, w.b, w.instability] == pytest.approx([0.2219, 33.63e3, 4.421e3, 0.1972], rel=3e-4)
    assert [w.inertia, w.participation, w.period] == pytest.approx([1089.0, 1.308, 0.7325], rel=6e-4)
    displaced = w.participation * (w.period / 2.0 / math.pi) ** 2 * 0.5 * 9.81
    assert 60.0 * w.instability / displaced == pytest.approx(135.7, rel=1e-3)


def test_the_spectrum_of_nzs_1170_5() -> None:
    """Values of its Table 3.1 as a public implementation prints them, classes A, C, D, E."""
    values = {
        "A": {0.0: 1.0, 0.1: 2.35, 0.5: 1.6, 1.5: 0.70, 3.0: 0.35, 4.0: 0.197},
        "C": {0.0: 1.33, 0.2: 2.93, 1.0: 1.19, 2.0: 0.66},
        "D": {0.0: 1.12, 0.4: 3.0, 1.0: 1.93, 3.0: 0.713},
        "E": {0.0: 1.12, 0.9: 3.0, 1.5: 2.21, 2.5: 1.33},
    }
    for ground, rows in values.items():
        spectrum = nzs1170(ground, 0.4, 1.3)
        for period, shape in rows.items():
            found = float(spectrum(np.array([period]))[0]) / (0.4 * 1.3 * GRAVITY)
            assert found == pytest.approx(shape, rel=0.01), (ground, period)
    assert return_factor(500.0) == 1.0 and return_factor(2500.0) == 1.8 and 1.0 < return_factor(700.0) < 1.3


def test_return_periods_of_ntc() -> None:
    """50 years of class II: 50, 475 and 975 years (NTC 2018, 3.2)."""
    code = Code(jurisdiction="NTC")
    assert [round(code.return_period(s)) for s in ("SLD", "SLV", "SLC")] == [50, 475, 975]
    school = Code(jurisdiction="NTC", importance="III")
    assert school.return_period("SLV") == pytest.approx(-75.0 / math.log(0.9))


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ({"jurisdiction": "NTC", "edition": "2008"}, "edition: this program includes edition 2018 of NTC"),
        ({"jurisdiction": "EN1998", "limit_states": ["SLV"]}, "SLV is not a limit state of EN1998"),
        ({"jurisdiction": "ASCE41", "knowledge_level": "LC1"}, "not a level of ASCE41; expected minimum, usual"),
        ({"jurisdiction": "ASCE41", "ground": "B"}, "ASCE41 does not use this key"),
        ({"jurisdiction": "NZSEE", "importance": "II"}, "NZSEE does not use this key"),
        ({"jurisdiction": "none", "confidence_factor": 1.2}, "none does not use this key"),
        ({"jurisdiction": "NTC", "limit_states": ["SLD", "SLV"], "accelerations": ["0.1 g"]}, "one value for each limit state"),
        ({"jurisdiction": "NTC", "amplifications": [2.5]}, "needs accelerations"),
        ({"jurisdiction": "ASCE41", "short_accelerations": ["0.5 g"]}, "go together"),
        ({"jurisdiction": "Italy"}, "input should be"),
    ],
)
def test_a_key_that_the_code_does_not_use_is_refused(code: dict, told: str) -> None:
    with pytest.raises(DeckError, match=told):
        make_deck({"code": code, "analysis": WALL})


def test_a_report_has_the_spectrum_of_its_own_code() -> None:
    site = {"code": "EN1998-1", "ground": "B", "acceleration": "0.15 g"}
    (row,) = extrados.run({"code": {"jurisdiction": "NTC"}, "analysis": {**WALL, "spectrum": site}}).analyses
    assert row["status"] == "refused" and "the checks are by NTC" in row["reason"]
    (row,) = extrados.run({"analysis": {**WALL, "one_second_acceleration": "0.2 g"}}).analyses
    assert row["status"] == "refused" and "a key of the checks by ASCE 41" in row["reason"]
    run = extrados.run({"analysis": {**WALL, "spectrum": site}})
    assert run["local-mechanism"].by_default and "The deck has no table [code]" in run.analyses[0]["verdict"]["statement"]
    (row,) = extrados.run(
        {"structure": {"kind": "block", "width": 1.0, "height": 3.0}, "code": {"jurisdiction": "NTC"}, "analysis": {"kind": "tilt"}}
    ).analyses
    assert any("code: no analysis of this deck uses this table" in w for w in row["warnings"])


def test_the_limits_of_asce_41_by_seismicity_and_limit_state() -> None:
    parapet = Part("parapet", 0.3, 0.9, 0.3, 6.0, 7.0)
    low, high = (asce41(parapet, s * GRAVITY, "one-story")[1] for s in (0.15, 0.25))
    assert (low.capacity, high.capacity) == (2.5, 1.5) and low.verdict == "fails"
    short = asce41(parapet, 0.15 * GRAVITY, "one-story", 0.6 * GRAVITY)[1]
    assert short.capacity == 1.5, "short periods make seismicity high"
    wall = Part("vertical-bending", 0.5, 3.9, 0.3, 0.0, None, anchored=True)
    assert asce41(wall, 0.15 * GRAVITY, "top")[0].verdict == "holds"
    assert asce41(wall, 0.15 * GRAVITY, "top", state="IO")[0].verdict == "not-applicable"


@pytest.mark.parametrize(
    ("keys", "joined"),
    [
        ({"mechanism": "facade", "height": 6.0, "thickness": 0.5, "hinge_height": 1.0}, {}),
        (
            {"mechanism": "vertical-bending", "height": 3.0, "thickness": 0.3, "floors": [{"height": 3.0, "load": 20e3}]},
            {1: ("lower", "upper")},
        ),
        (
            {"mechanism": "horizontal-bending", "height": 1.0, "thickness": 0.4, "width": 5.0, "abutment_force": 20e3},
            {1: ("left", "right")},
        ),
    ],
)
def test_the_drawn_bodies_are_rigid_and_meet_at_their_hinges(keys: dict, joined: dict) -> None:
    """Sides keep their lengths, two bodies share the hinge between them."""
    run = extrados.run({"material": {"density": 1800.0}, "analysis": {"kind": "local-mechanism", "peak_acceleration": "0.1 g", **keys}})

    def outlines(what: str) -> dict[str, np.ndarray]:
        points, start, names = (run.arrays["local-mechanism"][f"{what}{end}"].data for end in ("", "_start", "_of"))
        return {str(n): points[a:b] for n, a, b in zip(names, start[:-1], start[1:], strict=True)}

    rest, turned = outlines("section"), outlines("section_turned")
    hinges = run.arrays["local-mechanism"]["section_hinge"].data
    for name, outline in rest.items():
        sides = [np.linalg.norm(p - np.roll(p, 1, axis=0), axis=1) for p in (outline, turned[name])]
        assert sides[1] == pytest.approx(sides[0], abs=1e-12)
    for k, pair in joined.items():
        for name in pair:
            assert np.linalg.norm(turned[name] - hinges[k], axis=1).min() < 1e-9, name
    assert max(np.abs(turned[n] - rest[n]).max() for n in rest) > 0.02
    assert "below" not in rest or (turned["below"] == rest["below"]).all(), "the wall below the hinge is at rest"


def test_the_first_page_shows_the_governing_wall_of_a_plan() -> None:
    walls = [
        {"name": "front", "start": [0, 0], "end": [6, 0], "thickness": 0.4},
        {"name": "thin", "start": [6, 5], "end": [0, 5], "thickness": 0.2},
    ]
    plan = {"kind": "building", "storeys": [3.0], "walls": walls}
    run = extrados.run(
        {
            "structure": plan,
            "code": {"jurisdiction": "NTC", "accelerations": ["0.15 g"]},
            "analysis": {"kind": "local-mechanism", "mechanism": "building"},
        }
    )
    assert run["local-mechanism"].walls[0].wall == "thin"
    with style.kept():
        drawn = draw_local_mechanism(run, "local-mechanism", Path("."))
    assert drawn[0][0].endswith("-mechanism") and "about the foot of storey 1" in drawn[0][1]


@pytest.mark.parametrize("partial", [1.0, 1.5, 3.0])
def test_a_partial_factor_divides_the_strengths_of_a_pier(partial: float) -> None:
    """NTC 2018 7.8.2.2: 2 M_u / h with f_d = f_m / (FC gamma_M), and l' t (f_v0 / (FC gamma_M) + mu sigma_0) within f_b's limit."""
    width, h, t, n, fc = 1.5, 2.7, 0.4, 240e3, 1.35
    deck = {
        "structure": {"kind": "panel", "width": width, "height": h, "thickness": t},
        "material": {"density": 1e-6, "compressive_strength": 2.6e6},
        "code": {"jurisdiction": "NTC", "knowledge_level": "LC1"},
    }
    pier = {"kind": "code-checks", "axial_load": n, "fixity": "double", "partial_factor": partial}
    checks, limited = (
        extrados.run({**deck, "joints": {"cohesion": 0.13e6}, "analysis": {**pier, **more}})["code-checks"].checks
        for more in ({}, {"unit_strength": 2e5})
    )
    stress = n / (width * t)
    flexure = width**2 * t * stress / 2.0 * (1.0 - stress / (0.85 * 2.6e6 / (fc * partial))) * 2.0 / h
    assert checks["NTC flexure"].capacity == pytest.approx(flexure, rel=1e-6)
    assert limited["NTC sliding"].capacity < 0.2 * checks["NTC sliding"].capacity  # weak units
