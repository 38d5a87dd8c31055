"""Verification of pushed buildings by displacement: masses, confidence factor, verdicts and their conditions."""

import numpy as np
import pytest

import extrados
from extrados.analyses.codes.verification import displaced_shape
from extrados.analyses.shell.model import build, first_mode
from extrados.analyses.shell.tables import Pushover
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.results.verification import DisplacementCheck, IdealisedCurve, Verification
from extrados.views.building import Building
from extrados.views.shell.options import ShellOptions

WALLS = [
    {"name": "1", "start": [0, 0], "end": [3, 0], "thickness": 0.25, "openings": [{"storey": 1, "x": [1.0, 2.0], "z": [1.0, 2.0]}]},
    {"name": "A", "start": [0, 0], "end": [0, 3], "thickness": 0.25},
    {"name": "2", "start": [0, 3], "end": [3, 3], "thickness": 0.25},
    {"name": "B", "start": [3, 0], "end": [3, 3], "thickness": 0.25},
]
FLOOR = {"storey": 1, "walls": ["1", "B", "2", "A"], "young": 5e8, "thickness": 0.05, "load": 5000}
MASONRY = {"density": 1900, "young": 1.5e9, "poisson": 0.2, "tensile_strength": 3e4, "fracture_energy": 5}
CODE = {
    "jurisdiction": "NTC",
    "limit_states": ["SLD", "SLV", "SLC"],
    "ground": "C",
    "accelerations": ["0.05 g", "0.25 g", "0.32 g"],
    "amplifications": [2.4, 2.45, 2.5],
    "corner_periods": [0.28, 0.33, 0.35],
}
PUSH = {"kind": "pushover", "mesh": {"size": 0.75, "layers": 3}, "ripple": 0.2, "events": 1500, "stop_fraction": 0.75}


def deck(floor=None, material=None, code=None, **push):
    made = {
        "structure": {"kind": "building", "storeys": [3.0], "walls": WALLS, "floors": [{**FLOOR, **(floor or {})}]},
        "material": {**MASONRY, **(material or {})},
        "analysis": [{**PUSH, **push}],
    }
    return made | ({"code": {**CODE, **code}} if code is not None else {})


def pushed(data):
    """The typed results and the record of the analysis: status, verdict, warnings."""
    run = extrados.run(data, threads=1)
    found = run.analysis("pushover")
    return run["pushover"] if found["status"] == "ok" else None, found


@pytest.fixture(scope="module")
def verified():
    return pushed(deck(code={}))


def test_period_of_the_oscillator_is_that_of_the_mode_that_pushes():
    """Pushed by its own mode, T* = 2 pi sqrt(m*/k) of the uncracked building is the period by subspace iteration, as far as
    twelve rounds of that converge among neighbouring modes of walls out of plane."""
    options = Pushover(kind="pushover", mesh=ShellOptions(size=0.75, layers=3), pattern="modal")
    structure = Plan(kind="building", storeys=[3.0], walls=WALLS, floors=[{**FLOOR, "young": 5e10}])
    model = build(Building(structure, Material(**MASONRY)).shell(options.mesh), options)
    mass = model.mesh.mass()
    with model.open(options, 1) as core:
        shape, through = displaced_shape(core, model.reference, model.control, model.along, model.freedoms.equation >= 0)
        c = model.control
        stiffness = model.unit / float(core.displacement(1.0)[c.node, c.direction] @ c.share)
    _, frequency, ratio = first_mode(model, options, mass)
    assert through == pytest.approx(1.0, abs=1e-9)  # a mode is zero on supports
    assert 2.0 * np.pi * np.sqrt(mass @ shape / stiffness) == pytest.approx(1.0 / frequency, rel=2e-2)
    assert (mass @ shape) ** 2 / (mass @ shape**2) / mass.sum() == pytest.approx(ratio, rel=4e-2)


def test_demand_of_a_pushed_building_by_hand(verified):
    """N2 written out with the values of NTC 2018, ground C, on the oscillator of the result."""
    found = verified[0].verification
    curve = found.curves[0]
    for check, ag, f0, tc in zip(found.checks, (0.05, 0.25, 0.32), (2.4, 2.45, 2.5), (0.28, 0.33, 0.35), strict=True):
        soil = min(max(1.7 - 0.6 * f0 * ag, 1.0), 1.5)
        corner, period = 1.05 * tc**-0.33 * tc, curve.period_s
        felt = ag * soil * f0 * 9.80665
        felt *= period / (corner / 3.0) + (1.0 - period / (corner / 3.0)) / f0 if period < corner / 3.0 else 1.0
        elastic = felt * (period / (2.0 * np.pi)) ** 2
        q = felt * curve.equivalent_mass_kg / (curve.yield_load_N / curve.participation_factor)
        d = elastic / q * (1.0 + (q - 1.0) * corner / period) if q > 1.0 else elastic
        assert check.demand_pga_g == pytest.approx(ag * soil, rel=1e-9)
        assert (check.strength_ratio, check.demand_m) == pytest.approx((q, curve.participation_factor * d), rel=1e-4)


def test_verdict_is_that_of_the_least_factor(verified):
    results, record = verified
    found, verdict = results.verification, record["verdict"]
    factors = {c.limit_state: c.factor for c in found.checks}
    assert found.zeta_E == factors["SLV"]
    assert verdict["ratio"] == pytest.approx(min(factors.values()))
    assert verdict["violated"] and "limit drift of piers in shear (0.5 %)" in verdict["violated"][0], "piers in shear end their curve there"
    assert verdict["outcome"] == ("open" if min(factors.values()) > 1.0 else "collapses")
    # the base shear of the oscillator is without the forces on the supports, half a row of elements of 0.75 m
    assert found.curves[0].yield_load_N < 0.95 * results.greatest_load_N


def test_strengths_are_divided_by_the_confidence_factor(verified):
    """The same as a deck of strengths over 1.35 with full knowledge."""
    by_hand, _ = pushed(deck(material={"tensile_strength": 3e4 / 1.35}, code={"knowledge_level": "LC3"}))
    results, record = verified
    assert by_hand.verification.confidence_factor == 1.0
    assert by_hand.greatest_load_N == pytest.approx(results.greatest_load_N, rel=1e-9)
    assert any("1.35" in text for text in record["warnings"])


def test_a_deck_without_an_action_keeps_its_strengths_and_has_no_verdict():
    _, plain = pushed(deck(events=200))
    assert plain["verdict"]["outcome"] == "not-applicable"
    assert "seismic action in [code]" in plain["verdict"]["statement"]
    assert not any("confidence" in text for text in plain["warnings"])


def made(factor, ended="drop", violated=(), state="SLV", jurisdiction="NTC"):
    curve = IdealisedCurve(
        push="+",
        equivalent_mass_kg=1e5,
        participation_factor=1.2,
        mass_ratio=0.8,
        period_s=0.2,
        yield_load_N=3e5,
        yield_displacement_m=3e-3,
        ultimate_displacement_m=0.02,
        ended_by=ended,
    )
    check = DisplacementCheck(
        push="+",
        limit_state=state,
        demand_m=0.01,
        capacity_m=0.01 * factor,
        strength_ratio=1.5,
        greatest_strength_ratio=3.0,
        factor=factor,
        demand_pga_g=0.2,
        capacity_pga_g=0.2 * factor,
        return_period_years=475.0,
        capacity_return_period_years=None,
        verdict="holds" if factor >= 1.0 else "fails",
        clause="",
    )
    return Verification(
        jurisdiction=jurisdiction,
        code="NTC 2018",
        by_default=False,
        method="N2",
        confidence_factor=1.0,
        curves=[curve],
        checks=[check],
        zeta_E=factor,
        violated=list(violated),
    )


@pytest.mark.parametrize(
    ("factor", "ended", "violated", "outcome"),
    [
        (1.4, "drop", (), "stands"),
        (0.7, "drop", (), "collapses"),
        (1.4, "end", (), "stands"),
        (0.7, "end", (), "open"),
        (1.4, "drop", ("It slides.",), "open"),
        (0.7, "drop", ("It slides.",), "collapses"),
    ],
)
def test_conditions_of_the_verdict(factor, ended, violated, outcome):
    """A curve that ends early is a lower bound; a violated assumption opens a check that holds, never one that fails."""
    verdict = made(factor, ended, violated).judged("")
    assert (verdict.outcome, verdict.ratio) == (outcome, pytest.approx(factor))


def test_a_capacity_that_the_strength_ratio_limits_is_said_so():
    limited = made(2.0)
    assert "zeta_E 2, governed by q* (1.5; at most 3); peak ground" in limited.told(limited.checks[0])


@pytest.mark.parametrize(
    ("code", "method"),
    [
        ({"jurisdiction": "EN1998", "ground": "C", "accelerations": ["0.2 g"]}, "N2"),
        ({"jurisdiction": "NZSEE", "ground": "C", "hazard_factor": 0.3}, "N2"),
        ({"jurisdiction": "ASCE41", "short_accelerations": ["0.6 g"], "one_second_accelerations": ["0.3 g"]}, "coefficient"),
    ],
)
def test_other_codes(code, method):
    results, record = pushed({**deck(events=400), "code": code})
    rows = results.verification
    assert (rows.method, len(rows.checks)) == (method, 1)
    assert rows.checks[0].demand_m > 0.0
    if code["jurisdiction"] == "ASCE41":
        assert (record["verdict"]["outcome"], rows.checks[0].factor) == ("not-applicable", None)
        assert "Table 11-4" in record["verdict"]["statement"]
    else:
        assert rows.checks[0].factor > 0.0
        assert ("nbs_percent" in rows) == (code["jurisdiction"] == "NZSEE")


def test_spectrum_of_another_code_is_refused():
    other = {"code": "EN1998-1", "ground": "C", "acceleration": "0.2 g"}
    _, record = pushed(deck(code={}, verification={"spectrum": other}))
    assert record["status"] == "refused"
    assert "EN1998-1" in record["reason"]


def panel(**more):
    return {
        "structure": {"kind": "panel", "width": 0.6, "height": 6.0, "thickness": 0.3},
        "material": {**MASONRY, "tensile_strength": 1e5, "fracture_energy": 20},
        "code": CODE,
        "analysis": [{"kind": "sla", "mesh": {"size": 0.15}, "ripple": 0.2, "stop_fraction": 0.7, "events": 800, **more}],
    }


def test_participating_mass_of_a_slender_wall_is_that_of_a_cantilever_under_its_masses():
    """phi (x^4 - 4 x^3 + 6 x^2)/3 of a cantilever of uniform mass: the mean displacement is 0.4, that of its square 0.2568 of
    the tip's, so that m* is the whole mass and m* Gamma 0.16/0.2568 of it (without shear)."""
    run = extrados.run(panel(), threads=1)
    found = run["sla"].verification
    (curve,) = found.curves
    mass = 0.6 * 6.0 * 0.3 * 1900.0
    assert curve.equivalent_mass_kg == pytest.approx(mass, rel=1e-2)
    assert curve.mass_ratio == pytest.approx(0.16 / 0.25679, rel=1e-2)
    assert [c.limit_state for c in found.checks] == ["SLD", "SLV", "SLC"]
    assert run.analysis("sla")["verdict"]["unit"] == "g"


def test_a_load_without_mass_opens_the_verdict():
    """A floor of 50 kN on the wall, whose mass does not push it."""
    loads = [{"kind": "gravity"}, {"kind": "spread", "edge": "top", "fy": -50e3}]
    found = extrados.run(panel(constant=loads), threads=1)["sla"].verification
    assert "50 kN" in found.violated[0]


def framed(code=None, material=None, **more):
    made = deck(material={"compressive_strength": 3e6, "tensile_strength": 1e5, "fracture_energy": 20, **(material or {})}, code=code)
    made["joints"] = {"cohesion": 1e5, "friction": 0.6}
    made["analysis"] = [
        {"kind": "frame-pushover", "directions": [0.0], "eccentricities": [0.0], "patterns": ["uniform"], **more},
        {"kind": "frame-modes"},
    ]
    return made


@pytest.fixture(scope="module")
def frame():
    return extrados.run(framed(code={}), threads=1)


def test_period_of_a_frame_is_that_of_its_mode(frame):
    """With one mass on one level phi is 1 there: m* is that mass, and T* of the secant is not below the period at rest."""
    found = frame["frame-pushover"].verification
    period = next(m.period_s for m in frame["frame-modes"].modes if m.mass_ratio_x > 0.5)
    for curve in found.curves:
        assert 0.98 * period < curve.period_s < 1.6 * period
        assert 0.9 < curve.mass_ratio <= 1.0 + 1e-9
    mode = extrados.run(framed(code={}, verification={"shape": "mode"}), threads=1)
    for one, other in zip(found.curves, mode["frame-pushover"].verification.curves, strict=True):
        assert other.period_s == pytest.approx(one.period_s, rel=0.03)


def test_least_factor_of_all_pushes_governs(frame):
    found, verdict = frame["frame-pushover"].verification, frame.analysis("frame-pushover")["verdict"]
    assert [c.push for c in found.curves] == ["+x uniform", "-x uniform"]
    assert len(found.checks) == 2 * 3
    assert verdict["ratio"] == pytest.approx(min(c.factor for c in found.checks))
    assert found.confidence_factor == 1.35


def test_strengths_of_a_frame_are_divided_by_the_confidence_factor(frame):
    by_hand = framed(code={"knowledge_level": "LC3"}, material={"compressive_strength": 3e6 / 1.35, "tensile_strength": 1e5 / 1.35})
    by_hand["joints"]["cohesion"] = 1e5 / 1.35
    other = extrados.run(by_hand, threads=1)["frame-pushover"]
    peaks = [[row.peak_base_shear_N for row in one.runs] for one in (frame["frame-pushover"], other)]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-6)


def test_sliding_of_a_storey_by_hand():
    """Without cohesion the house slides at 0.1 of its weight, far below its piers' strength."""
    slippery = framed(code={"knowledge_level": "LC3"})
    slippery["joints"] = {"cohesion": 0.0, "friction": 0.1}
    slippery["analysis"][0]["frame"] = {"cohesion": 1e5}
    run = extrados.run(slippery, threads=1)
    found = run["frame-pushover"]
    limit = 0.1 * found.weight_N / 1e3
    assert f"{limit:.3g} kN" in found.verification.violated[0]
    assert run.analysis("frame-pushover")["verdict"]["outcome"] in ("open", "collapses")


def test_walls_out_of_plane_are_those_of_the_local_mechanism(frame):
    """The same check as an analysis of its own, with the period of the frame."""
    found = frame["frame-pushover"].out_of_plane
    alone = framed(code={})
    alone["analysis"] = [{"kind": "local-mechanism", "mechanism": "building", "building_period": found.building_period_s}]
    verdict = extrados.run(alone, threads=1).analysis("local-mechanism")["verdict"]
    assert (found.factor, found.outcome) == (verdict["ratio"], verdict["outcome"])
    assert found.building_period_s == pytest.approx(max(m.period_s for m in frame["frame-modes"].modes if m.mass_ratio_x > 0.5), rel=1e-6)
    violated = any("out-of-plane" in text for text in frame["frame-pushover"].verification.violated)
    assert violated == (found.outcome == "collapses")


def test_the_limit_state_of_operation_is_two_thirds_of_that_of_damage():
    """SLO has a return period of 30 years (V_R 50 years, 81 %), and no check of local mechanisms."""
    code = {
        "limit_states": ["SLO", "SLD"],
        "accelerations": ["0.04 g", "0.05 g"],
        "amplifications": [2.4, 2.4],
        "corner_periods": [0.27, 0.28],
    }
    run = extrados.run(framed(code=code), threads=1)
    for curve in run["frame-pushover"].verification.curves:
        slo, sld = (
            next(c for c in run["frame-pushover"].verification.checks if (c.push, c.limit_state) == (curve.push, state))
            for state in ("SLO", "SLD")
        )
        assert slo.capacity_m == pytest.approx(2.0 / 3.0 * sld.capacity_m, rel=1e-12)
        assert slo.return_period_years == pytest.approx(-50.0 / np.log(1.0 - 0.81), rel=1e-12)
    alone = framed(code=code)
    alone["analysis"] = [{"kind": "local-mechanism", "mechanism": "building"}]
    found = extrados.run(alone, threads=1)
    assert {c.limit_state for c in found["local-mechanism"].checks.values()} <= {"SLD", "SLV"}
    assert any("SLO" in text for text in found.analysis("local-mechanism")["warnings"])


def test_fragility_over_motions_is_that_of_each_motion_by_itself():
    """The accelerations carried of a set of three are those of three runs with the spectrum of one of its motions (SLV)."""
    motion = {"kind": "generated", "mmi": 7, "duration": 4.0, "seed": 3}
    whole = framed(verification={"motions": 3})
    run = extrados.run({**whole, "motion": motion, "code": {"jurisdiction": "NTC", "knowledge_level": "LC3"}}, threads=1)
    found, carried = run["frame-pushover"].verification, run.array("frame-pushover", "carried_pga")
    (row,) = found.fragility
    assert (row.limit_state, row.motions, carried.shape) == ("SLV", 3, (3, 1))
    assert row.median_pga_g == pytest.approx(np.exp(np.log(carried).mean()), rel=1e-12)
    assert row.dispersion == pytest.approx(np.log(carried).std(ddof=1), rel=1e-12)
    for k in range(3):
        one = {**framed(verification={"motion_spectrum": True}), "motion": {**motion, "member": k + 1}}
        one["code"] = {"jurisdiction": "NTC", "knowledge_level": "LC3"}
        check = extrados.run(one, threads=1)["frame-pushover"].verification.governing()
        if check.factor * check.strength_ratio < 2.99:  # else q* governs, which is a rule of the code
            assert carried[k, 0] == pytest.approx(check.capacity_pga_g, rel=5e-3)
