"""Which events are states, and what rests on them: envelopes, ends of runs, energies, and the limit of sliding."""

from types import SimpleNamespace

import numpy as np
import pytest

import extrados
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.shell.model import build
from extrados.analyses.shell.sliding import sliding_limits
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.sla.curve import envelope, has_fallen
from extrados.model.properties import Joints, Material
from extrados.model.structures.plan import Plan
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.shell.options import ShellOptions

FACADE = {
    "structure": {
        "kind": "building",
        "storeys": [3.3, 3.3],
        "walls": [
            {
                "name": "front",
                "start": [0, 0],
                "end": [7, 0],
                "thickness": 0.3,
                "openings": [
                    {"storey": 1, "x": [1.2, 2.2], "z": [0.0, 2.2]},
                    {"storey": 1, "x": [3.4, 4.6], "z": [0.9, 2.3]},
                    {"storey": 2, "x": [1.2, 2.2], "z": [0.9, 2.3]},
                    {"storey": 2, "x": [3.4, 4.6], "z": [0.9, 2.3]},
                ],
            }
        ],
    },
    "material": {"density": 1800, "young": 1.7e9, "poisson": 0.0, "tensile_strength": 1e5, "fracture_energy": 50},
}


@pytest.fixture(scope="module")
def facade():
    """A facade that loses equilibrium after its peak: multipliers run away to a thousand times it."""
    push = {
        "kind": "pushover",
        "mesh": {"size": 0.4, "layers": 3},
        "ripple": 0.2,
        "events": 8000,
        "directions": ["+", "-"],
        "without_equilibrium": "load-unload",
    }
    return extrados.run({**FACADE, "analysis": [push]}).results[0]


@pytest.mark.parametrize("prefix", ["", "minus_"])
def test_no_result_rests_on_what_is_no_state(facade, prefix: str) -> None:
    get = {n: np.asarray(facade[f"{prefix}event_{n}"]) for n in ("load", "displacement", "state", "dissipated", "crack")}
    r = facade.results if not prefix else facade.results.minus
    out, state = get["state"] == -1, get["state"] == 1
    size = 7.0
    assert np.abs(get["load"]).max() > 100.0 * r.greatest_load_N and out.any()  # what was kept before
    assert r.events_out_of_reach == out.sum() and any("not valid states" in w for w in facade.warnings)
    for name, bound in (("load", 10.0 * r.greatest_load_N), ("displacement", 0.1 * size + 1e-3)):
        assert np.abs(get[name][~out]).max() <= bound
    assert r.greatest_load_N == get["load"][state].max()
    # Energies: never negative, never falling, and no more than all cracks of the wall can take
    assert get["dissipated"][0] >= 0.0 and (np.diff(get["dissipated"]) >= 0.0).all() and (np.diff(get["crack"]) >= 0).all()
    assert 0.0 < r.dissipated_energy_J < 50.0 * 0.3 * 7.0 * 6.6 / 0.4


def test_what_is_dissipated_is_the_work_that_is_not_stored(facade) -> None:
    """As long as all events are states; what is lost through events that are none falls far below zero."""
    get = {n: np.asarray(facade[f"event_{n}"]) for n in ("external", "stored", "dissipated", "lost", "state", "crack")}
    upto = slice(0, int(np.argmax(get["state"] != 1)))
    assert upto.stop > 500
    balance = get["external"] - get["stored"]
    # From one state to a far one the loss may fall, which is not dissipation: here once, by .3 %
    above = get["dissipated"][upto] - balance[upto]
    assert above.min() > -1e-9 * balance[upto].max() and above.max() < 4e-3 * balance[upto].max()
    assert np.abs(above[:1800]).max() < 1e-9 * balance[upto].max()
    assert 0.5 * balance[upto][-1] < get["crack"][upto][-1] < balance[upto][-1]
    assert get["lost"].min() < -1e4


@pytest.mark.parametrize("prefix", ["", "minus_"])
def test_an_envelope_begins_at_the_origin_and_never_rises_faster_than_the_sound_wall(facade, prefix: str) -> None:
    """States that come back to small displacements after the peak are no part of it."""
    d, p = (np.asarray(facade[f"{prefix}envelope_{n}"]) for n in ("displacement", "load"))
    r = facade.results if not prefix else facade.results.minus
    way = np.abs(d - d[0])
    assert way[0] == 0.0 and p[0] == 0.0 and (p >= 0.0).all() and (np.diff(way) > 0.0).all()
    assert p.max() == pytest.approx(r.greatest_load_N)
    assert (p <= 1.001 * r.initial_stiffness_N_m * way + 1e-6).all()


def test_what_comes_back_after_the_peak_is_no_part_of_an_envelope() -> None:
    d = np.array([1.0, 2.0, 3.0, 0.2, 2.5, 3.2, -1.0, 4.0])
    p = np.array([10.0, 18.0, 20.0, 19.0, 15.0, 17.0, 18.0, 12.0])
    x, y = envelope(d, p)
    assert np.interp(0.2, x, y) == pytest.approx(2.0) and np.interp(1.0, x, y) == pytest.approx(10.0)
    assert y.max() == 20.0 and np.interp(3.2, x, y) == pytest.approx(17.0) and x[-1] == 4.0 and y[-1] == 12.0
    x, y = envelope(-d, p)  # of the other sense
    assert np.interp(1.0, np.abs(x), y) == pytest.approx(10.0)
    assert envelope(d, -p)[1].tolist() == [0.0]


def test_a_single_tooth_below_a_fraction_of_the_peak_is_no_fall() -> None:
    rising = np.linspace(0.1, 5.0, 50)
    load = 10.0 * rising
    load[30] *= 0.5  # a transient, and the curve goes on
    assert not has_fallen(rising, load, 0.0, 0.8)
    assert not has_fallen(rising[:31] + np.append(np.zeros(30), 0.05), load[:31], 0.0, 0.8)
    falling = np.append(load, [38.0, 37.0]), np.append(rising, [5.2, 5.6])
    assert not has_fallen(falling[1], falling[0], 0.0, 0.8)  # .4 beyond the first state below
    assert has_fallen(np.append(falling[1], 5.75), np.append(falling[0], 36.0), 0.0, 0.8)
    assert not has_fallen(np.append(falling[1], [5.65, 5.75]), np.append(falling[0], [41.0, 36.0]), 0.0, 0.8)


def test_a_push_ends_where_its_envelope_stays_below_the_fraction() -> None:
    """The facade in its weaker sense: the first state below 90 % of the peak so far does not end a run whose load goes on."""
    keys = {"kind": "pushover", "mesh": {"size": 0.4, "layers": 3}, "ripple": 0.2, "events": 8000, "without_equilibrium": "load-unload"}
    whole, told = (extrados.run({**FACADE, "analysis": [{**keys, "stop_fraction": fraction}]}).results[0] for fraction in (0.0, 0.95))
    load, way = (np.asarray(whole[f"event_{n}"]) for n in ("load", "displacement"))
    held, peak = np.asarray(whole["event_state"]) == 1, np.maximum.accumulate(whole["event_load"])
    ahead = np.maximum.accumulate(np.where(load == peak, way, 0.0))
    first = int(np.argmax(held & (load < 0.95 * peak) & (way > ahead)))  # where it would have ended by one state
    assert 0 < first and told.results.events > first + 1
    d, p = np.asarray(told["envelope_displacement"]), np.asarray(told["envelope_load"])
    if "below the fraction" in told.results.stop or "fell below" in told.results.stop:
        last = d >= d[-1] - 0.09 * abs(told.results.peak_displacement_m - d[0])
        assert (p[last][1:] < 0.95 * p.max() + 1e-6).all()
    assert told.results.greatest_load_N >= load[: first + 1][held[: first + 1]].max()


# ----- sliding

WALLS = [
    {"name": n, "start": s, "end": e, "thickness": 0.3}
    for n, s, e in (("a", [0, 0], [4, 0]), ("b", [4, 0], [4, 4]), ("c", [4, 4], [0, 4]), ("d", [0, 4], [0, 0]))
]
SOLE = {"friction": 0.4, "cohesion": 1e3, "shear_energy": 10.0, "tension": 1e3, "fracture_energy": 1.0}
BRICK = {"density": 1800, "young": 1.7e9, "poisson": 0.0, "tensile_strength": 1e5, "fracture_energy": 50}


def box(beds: bool = True, events: int = 9000, **more):
    structure = {"kind": "building", "storeys": [3.0], "walls": WALLS, **({"beds": [{"name": "sole"}]} if beds else {})}
    push = {"kind": "pushover", "mesh": {"size": 0.5, "layers": 3}, "events": events, "ripple": 0.2, **more}
    deck = {"structure": structure, "material": BRICK, "joints": SOLE, "analysis": [push]}
    return extrados.run(deck).results[0]


def test_a_box_without_bed_joints_is_capped_by_coulombs_limit() -> None:
    """4 x 4 x 3 m of masonry that does not slide: 0.4 of the weight and 1 kPa on the feet of all walls."""
    found = box(beds=False, without_equilibrium="load-unload")
    r = found.results
    weight, feet = 1800 * GRAVITY * 16.0 * 0.3 * 3.0, 16.0 * 0.3
    limit = 0.4 * weight + 1e3 * feet
    assert r.weight_N == pytest.approx(weight)
    assert r.greatest_load_N > 1.1 * limit
    assert r.capacity_N == r.sliding_capacity_N == pytest.approx(limit, rel=1e-6)
    assert r.sliding_level == "the base of storey 1"
    assert r.base_shear_coefficient == pytest.approx(limit / weight, rel=1e-6)
    assert r.sliding[0].area_m2 == pytest.approx(feet) and r.sliding[0].normal_N == pytest.approx(weight, rel=1e-6)
    verdict = r.judged(Demanded(0.1))
    assert verdict.outcome == "not-applicable" and verdict.bound == "upper" and verdict.demand is None
    assert verdict.capacity == pytest.approx(limit / weight, rel=1e-6) and len(verdict.violated) == 1
    assert f"Sliding at {r.sliding_level}" in verdict.statement and "Coulomb" in found.answer and "at most" in found.answer


def test_a_box_slides_on_its_sole_by_itself() -> None:
    """On a bed joint under all walls it slides: no upper bound is left, and no more than 1.03 of Coulomb's limit."""
    found = box(beds=True, target_displacement=5e-3)
    r = found.results
    limit = 0.4 * r.weight_N + 1e3 * 4.8
    assert 0.4 * r.weight_N <= r.greatest_load_N <= 1.03 * limit and r.capacity_N == r.greatest_load_N
    verdict = r.judged(Demanded(0.1))
    assert verdict.bound != "upper" and not verdict.violated and "at most" not in found.answer


@pytest.mark.verify
def test_a_sole_under_some_walls_does_not_lift_the_limit_of_all() -> None:
    """Walls without a bed joint resist by the friction and cohesion of [joints], those on one by its own."""
    structure = {"kind": "building", "storeys": [3.0], "walls": WALLS, "beds": [{"name": "sole", "walls": ["a", "b"]}]}
    push = {"kind": "pushover", "mesh": {"size": 0.5, "layers": 3}, "target_displacement": 2e-3, "ripple": 0.2}
    weight = 1800 * GRAVITY * 16.0 * 0.3 * 3.0
    for of_sole in (0.4, 0.2):
        joints = {**SOLE, "types": [{"joints": ["sole"], "friction": of_sole}]}
        deck = {"structure": structure, "material": BRICK, "joints": joints, "analysis": [push]}
        found = extrados.run(deck).results[0]
        r = found.results
        limit = (0.4 + of_sole) / 2.0 * weight + 1e3 * 4.8
        assert r.sliding_level == "the base of storey 1" and not any("not checked" in text for text in found.warnings)
        assert r.capacity_N == r.sliding_capacity_N == pytest.approx(limit, rel=1e-6 if of_sole == 0.4 else 0.03)


def test_friction_that_limits_a_push_is_among_its_assumptions() -> None:
    found = box(beds=False, events=50)
    assert found.assumptions["joints.friction"].value == 0.4 and found.assumptions["joints.cohesion"].value == 1e3
    assert not any("joints.friction" in text or "joints.cohesion" in text for text in found.warnings)


def test_what_cannot_slide_is_not_capped() -> None:
    found = extrados.run(
        {
            "structure": {"kind": "building", "storeys": [3.0], "walls": WALLS},
            "material": BRICK,
            "joints": {"friction": "no-sliding"},
            "analysis": [{"kind": "pushover", "mesh": {"size": 0.7, "layers": 3}, "events": 50}],
        }
    ).results[0]
    r = found.results
    assert r.capacity_N == r.greatest_load_N and r.sliding_capacity_N is None and r.sliding is None
    assert r.judged(Demanded(0.1)).bound == "lower" and not r.judged(Demanded(0.1)).violated
    assert any("Sliding" in text and "friction excludes" in text for text in found.warnings)


def test_sliding_limits_of_storeys_and_of_bed_joints() -> None:
    """Weights above each level, shears above it by the pattern, joints of unlike friction; a joint of one wall cuts not all."""
    walls = [{**w, "thickness": 0.3} for w in WALLS]
    floors = [{"storey": 1, "load": 4e3, "young": 1e8, "thickness": 0.05}]
    beds = [{"name": "low"}, {"name": "half", "storey": 2, "z": 1.0, "walls": ["a"]}]
    plan = Plan(kind="building", storeys=[3.0, 2.0], walls=walls, floors=floors, beds=beds)
    types = [{"joints": ["half"], "friction": 0.1}]
    building = Building(plan, Material(**BRICK), joints=Joints(**SOLE, types=types))
    wall, floor = 1800 * GRAVITY * 4.8, 4e3 * 16.0
    for pattern in ("mass", "triangular"):
        options = Pushover(kind="pushover", mesh=ShellOptions(size=0.5, layers=3), pattern=pattern)
        model = build(building.shell(options.mesh), options)
        with model.open(options, 1) as core:
            core.loads(model.constant, model.reference)
            rows = sliding_limits(model, building, options, core.report(0.0))
        assert [row.level for row in rows] == ["the base of storey 2", "bed joint low"]
        upper, low = rows
        assert upper.normal_N == pytest.approx(2.0 * wall) and low.normal_N == pytest.approx(5.0 * wall + floor, rel=1e-6)
        assert upper.resistance_N == pytest.approx(0.4 * 2.0 * wall + 1e3 * 4.8)
        # the floor's mass is below the base of the storey on it
        share = {"mass": 2.0 * wall / (5.0 * wall + floor), "triangular": 8.0 * wall / (12.5 * wall + 3.0 * floor)}[pattern]
        assert low.shear_share == pytest.approx(1.0) and upper.shear_share == pytest.approx(share, rel=0.02)
    driven = Pushover(
        kind="pushover", mesh=ShellOptions(size=0.5, layers=3), drives=[{"wall": "a", "storey": 1}, {"wall": "a", "storey": 2}]
    )
    model = build(building.shell(driven.mesh), driven)
    with model.open(driven, 1) as core:
        core.loads(model.constant, model.reference)
        assert [row.level for row in sliding_limits(model, building, driven, core.report(0.0))] == ["bed joint low"]


def test_a_vault_has_no_levels() -> None:
    assert sliding_limits(SimpleNamespace(mesh=SimpleNamespace(walls=[]), driven=False), None, None, {}) == []
