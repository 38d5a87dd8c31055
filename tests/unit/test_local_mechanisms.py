"""Kinematic analysis of local mechanisms: by hand, by the finite motion, and against what rocks."""

import numpy as np
import pytest

import extrados
from extrados.analyses.codes.kinematics import Overturning, Push, Weight, capacity
from extrados.analyses.codes.ntc import displacement, floor
from extrados.analyses.codes.piers import Pier, asce41_piers, en1998_piers, ntc_piers
from extrados.decks.reader import DeckError
from extrados.schema.constants import GRAVITY


def test_the_capacity_curve_is_the_work_of_a_finite_rotation() -> None:
    """Potential energy of weights and pushes over a path gives the same multiplier, by differences."""
    body = Overturning((Weight(70e3, 0.3, 3.0), Weight(12e3, 0.4, 5.0, sways=False)), (Push(1e3, 6.0), Push(-2e3, 5.5)))

    def work(q: float) -> tuple[float, float]:
        up = sum(w.weight * (w.arm * np.sin(q) + w.height * np.cos(q)) for w in body.weights)
        out = sum(p.force * p.height * np.sin(q) for p in body.pushes)
        side = sum(w.weight * (w.height * np.sin(q) - w.arm * np.cos(q)) for w in body.weights if w.sways)
        return up - out, side

    for q in (0.0, 0.03, 0.06):
        (u1, s1), (u2, s2) = work(q - 1e-6), work(q + 1e-6)
        assert body.multiplier(q) == pytest.approx((u2 - u1) / (s2 - s1), rel=1e-6)
    end = body.ultimate()
    assert body.multiplier(end) == pytest.approx(0.0, abs=1e-12) and body.multiplier(0.9 * end) > 0.0


def test_a_single_block_is_what_the_rocking_block_is() -> None:
    b, h = 1.0, 5.0
    block = Overturning((Weight(2000.0 * GRAVITY * b * h, 0.5 * b, 0.5 * h),))
    weight, displacement = block.swaying
    found = capacity(block.multiplier(), weight, displacement, float(block.travel(block.ultimate())))
    assert found.alpha0 == pytest.approx(b / h) and found.part == pytest.approx(1.0) and found.mass == pytest.approx(2000.0 * b * h)
    assert found.d0 == pytest.approx(0.5 * b), "its centre then stands above the toe"
    rocking = {"structure": {"kind": "block", "width": b, "height": h}, "analysis": {"kind": "tilt"}}
    assert extrados.run(rocking)["tilt"].collapse_acceleration_g == pytest.approx(found.alpha0)


def mechanism(**keys) -> object:
    return extrados.run({"material": {"density": 2000.0}, "analysis": {"kind": "local-mechanism", **keys}})


def test_the_buildings_own_mechanism_is_that_of_the_table_where_both_are_known() -> None:
    table = mechanism(mechanism="wall", height=5.0, thickness=1.0)["local-mechanism"]
    deck = {
        "structure": {"kind": "column", "width": 1.0, "height": 5.0, "drums": 1},
        "analysis": {"kind": "local-mechanism", "mechanism": "building"},
    }
    own = extrados.run(deck)["local-mechanism"]
    for key in ("multiplier", "participating_mass_kg", "activation_acceleration_g", "zero_displacement_m"):
        assert own[key] == pytest.approx(table[key], rel=1e-6), key


def test_what_holds_and_what_pushes_moves_the_multiplier_the_right_way() -> None:
    base = {"mechanism": "facade", "height": 6.0, "thickness": 0.6}
    bare = mechanism(**base)["local-mechanism"].multiplier
    assert bare == pytest.approx(0.1)
    tied = mechanism(**base, ties=[{"height": 6.0, "force": 1e3}])["local-mechanism"].multiplier
    assert tied - bare == pytest.approx(1e3 * 6.0 / (2000.0 * GRAVITY * 0.6 * 6.0 * 3.0))
    pushed = mechanism(**base, floors=[{"height": 6.0, "thrust": 1e3}])["local-mechanism"].multiplier
    assert bare - pushed == pytest.approx(tied - bare)
    above = mechanism(**base, hinge_height=3.0)["local-mechanism"].multiplier
    assert above == pytest.approx(0.2), "a crack half way up: half the height turns"
    held = mechanism(**base, floors=[{"height": 6.0, "load": 1e4, "sways": False}])["local-mechanism"].multiplier
    carried = mechanism(**base, floors=[{"height": 6.0, "load": 1e4}])["local-mechanism"].multiplier
    assert held > bare > carried
    assert mechanism(**base, side_walls={"thickness": 0.5, "crack_angle": 20.0})["local-mechanism"].multiplier > bare
    crushed = extrados.run({"material": {"density": 2000.0, "compressive_strength": 1e6}, "analysis": {"kind": "local-mechanism", **base}})
    setback = 2.0 * 2000.0 * GRAVITY * 0.6 * 6.0 / (3.0 * 1e6)
    assert crushed["local-mechanism"].multiplier == pytest.approx((0.3 - setback) / 3.0)


def test_a_corner_says_that_its_stone_does_not_crush() -> None:
    corner = {"kind": "local-mechanism", "mechanism": "corner", "height": 6.0, "thickness": 0.5, "crack_angle": 30.0}
    hard, soft = (extrados.run({"material": material, "analysis": corner}).analyses[0] for material in ({}, {"compressive_strength": 1e5}))
    assert soft["results"]["multiplier"] == hard["results"]["multiplier"]
    assert not hard["warnings"] and any("without crushing" in text for text in soft["warnings"])


def test_refusals_name_what_is_missing() -> None:
    (told,) = mechanism(mechanism="gable", height=3.0, thickness=0.4).analyses
    assert told["status"] == "refused" and "requires width" in told["reason"]
    (told,) = mechanism(mechanism="facade", height=6.0, thickness=0.6, floors=[{"height": 6.0, "thrust": "10 kN"}]).analyses
    assert told["status"] == "ok" and told["verdict"]["outcome"] == "cannot-stand"
    (told,) = mechanism(mechanism="building").analyses
    assert told["status"] == "refused" and "[structure]" in told["reason"]


SQUARE = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0]]


def house(front: dict | None = None, **more) -> dict:
    """Four walls of 5 m and 0.5 m, two storeys of 3 m; the first wall, and the building, with other keys."""
    names = ("front", "right", "back", "left")
    sides = [{"name": n, "start": SQUARE[k], "end": SQUARE[(k + 1) % 4], "thickness": 0.5} for k, n in enumerate(names)]
    sides[0] |= front or {}
    return {"kind": "building", "storeys": [3.0, 3.0], "walls": sides, **more}


def walls_of(structure: dict, **keys) -> tuple[dict, object]:
    """Walls and storeys with their rows, and the whole run."""
    analysis = {"kind": "local-mechanism", "mechanism": "building", **keys}
    run = extrados.run({"material": {"density": 2000.0}, "structure": structure, "analysis": analysis})
    r = run["local-mechanism"]
    return {(w.wall, w.storey): w for w in r.walls}, run


def test_a_wall_on_a_plan_is_the_facade_of_the_table() -> None:
    """A floor of 2 kPa over 25 m^2 that two walls of 5 m bear: 5 kN on each metre of them."""
    floor = {"storey": 2, "young": "50 MPa", "thickness": 0.05, "load": "2 kPa", "bears_on": ["front", "back"]}
    found, run = walls_of(house(floors=[floor]), peak_acceleration="0.1 g")
    table = mechanism(mechanism="facade", height=6.0, thickness=0.5, floors=[{"height": 6.0, "load": "5 kN"}], peak_acceleration="0.1 g")
    own, alone = found["front", 1], table["local-mechanism"]
    assert own.multiplier == pytest.approx(alone.multiplier) and own.zero_displacement_m == pytest.approx(alone.zero_displacement_m)
    assert own.margin == pytest.approx(alone.governing()[0][0])
    assert found["left", 1].multiplier == pytest.approx(0.5 / 6.0), "which bears no floor"
    assert len(found) == 8 and run["local-mechanism"].multiplier == min(w.multiplier for w in found.values())


def test_of_a_wall_on_a_plan_openings_thicknesses_and_what_holds_it_count() -> None:
    bare, _ = walls_of(house())
    window = {"storey": 2, "x": [1.0, 4.0], "z": [1.0, 2.5]}
    pierced, _ = walls_of(house({"openings": [window]}))
    area, lever = 30.0 - 4.5, 30.0 * 3.0 - 4.5 * (3.0 + 1.75)
    assert pierced["front", 1].multiplier == pytest.approx(0.25 * area / lever)
    stepped, _ = walls_of(house({"thickness": None, "thicknesses": [0.5, 0.3]}))
    assert stepped["front", 1].multiplier == pytest.approx(0.25 * 2.4 / (1.5 * 1.5 + 0.9 * 4.5))
    assert stepped["front", 2].multiplier == pytest.approx(0.1) and bare["front", 2].foot_m == 3.0
    pressed, _ = walls_of(house(prestress=[{"wall": "front", "force": "100 kN"}]))
    weight = 2000.0 * GRAVITY * 15.0
    assert pressed["front", 1].multiplier == pytest.approx(0.25 * (weight + 1e5) / (3.0 * weight))
    propped, _ = walls_of(house(props=[{"wall": "front", "storey": 1}]))
    assert ("front", 1) not in propped and ("front", 2) in propped
    slab = [{"storey": 1, "kind": "rigid", "load": "3 kPa"}]
    assert {storey for _, storey in walls_of(house(floors=slab))[0]} == {2}


def test_each_storey_of_a_wall_has_the_density_of_its_material() -> None:
    """Moments about the toe by hand; an unknown name is refused at its wall."""
    deck = {"structure": house({"materials": ["light", "heavy"]}), "analysis": {"kind": "local-mechanism", "mechanism": "building"}}
    materials = {"light": {"density": 800.0}, "heavy": {"density": 2600.0}}
    found = extrados.run({**deck, "materials": materials})["local-mechanism"].walls
    multiplier = {(w.wall, w.storey): w.multiplier for w in found}
    assert multiplier["front", 1] == pytest.approx(0.25 * (800.0 + 2600.0) / (800.0 * 1.5 + 2600.0 * 4.5))
    assert multiplier["front", 2] == pytest.approx(0.25 / 1.5)
    (told,) = extrados.run({**deck, "materials": {"light": materials["light"]}}).analyses
    assert told["status"] == "refused" and "wall 'front': the deck has no [materials.heavy]" in told["reason"]


def test_walls_that_are_all_held_have_no_mechanism_and_the_crushing_hinge_is_set_back() -> None:
    slabs = [{"storey": k, "kind": "rigid"} for k in (1, 2)]
    run = extrados.run({"structure": house(floors=slabs), "analysis": {"kind": "local-mechanism", "mechanism": "building"}})
    (told,) = run.analyses
    assert told["status"] == "ok" and told["verdict"]["outcome"] == "not-applicable"
    assert "restrain the top of each wall" in told["verdict"]["statement"] == run["local-mechanism"].statement()
    soft = {"density": 2000.0, "compressive_strength": "1 MPa"}
    whole = {"structure": house(), "material": soft, "analysis": {"kind": "local-mechanism", "mechanism": "building"}}
    table = {"material": soft, "analysis": {"kind": "local-mechanism", "mechanism": "facade", "height": 6.0, "thickness": 0.5}}
    own, alone = (extrados.run(d)["local-mechanism"] for d in (whole, table))
    found = {(w.wall, w.storey): w.multiplier for w in own.walls}
    assert [found[name, 1] for name in ("front", "right", "back", "left")] == pytest.approx([alone.multiplier] * 4)


def test_the_common_part_of_openings_is_deducted_once() -> None:
    """Two that overlap, and one that leaves nothing but what the other leaves, are one opening."""
    whole = {"storey": 1, "x": [1.0, 4.0], "z": [1.0, 2.5]}
    parts = [{**whole, "x": [1.0, 3.0]}, {**whole, "x": [2.0, 4.0]}, {**whole, "x": [2.5, 2.8], "z": [1.5, 2.0]}]
    soft = {"density": 2000.0, "compressive_strength": "1 MPa"}
    found = []
    for openings in ([whole], parts):
        structure = house({"openings": [*openings, {"storey": 1, "x": [0.2, 0.9], "z": [0.0, 2.0]}]})
        deck = {"structure": structure, "material": soft, "analysis": {"kind": "local-mechanism", "mechanism": "building"}}
        found.append(extrados.run(deck)["local-mechanism"].as_json())
    assert found[0] == found[1]


def test_what_a_wall_on_a_plan_cannot_be_asked_is_refused_with_its_key() -> None:
    def refused(structure: dict, more: dict | None = None, **keys: object) -> str:
        analysis = {"kind": "local-mechanism", "mechanism": "building", **keys}
        (told,) = extrados.run({"structure": structure, "analysis": analysis, **(more or {})}).analyses
        assert told["status"] == "refused"
        return told["reason"]

    whole = [{"storey": 1, "x": [0.0, 5.0], "z": [0.0, 2.0]}]
    assert "structure.walls.openings: wall 'front' has no masonry at the foot of storey 1" in refused(house({"openings": whole}))
    inner = {"name": "inner", "start": [2.0, 1.0], "end": [2.0, 4.0], "thickness": 0.5}
    floor = {"storey": 1, "kind": "none", "load": "2 kPa", "walls": ["front", "right", "back", "left"], "bears_on": ["inner"]}
    apart = house(floors=[floor])
    apart["walls"].append(inner)
    assert "wall 'inner' of `bears_on` is not adjacent to the floor" in refused(apart)
    for name, value in {"height": 5.0, "width": 2.0, "ties": [{"height": 2.0, "force": 1e3}], "storeys": 3, "building_height": 9.0}.items():
        assert f"remove `{name}`" in refused(house(), **{name: value})
    tie = {"ties": [{"from": "front", "to": "back", "area": 1e-3}]}
    abutting = {"supports": {"abutting_wall": "left"}}
    assert "supports.abutting_wall" in refused(house(), abutting), tie


def test_what_goes_for_every_wall_is_said_once() -> None:
    _, run = walls_of(house(), peak_acceleration="0.1 g")
    told = run.results[0].warnings
    assert len(told) == len(set(told)) and any("Without a spectrum" in text for text in told)


def test_the_worked_example_of_a_pier() -> None:
    """Advanced Design Examples of Seismic Retrofit of Structures, section 2.7.5, its wall 1, Eqs 2.31 to 2.36 [kg, cm]."""
    stress = GRAVITY / 1e-4  # kg/cm^2
    pier = Pier(0.93, 1.8, 0.35, 10883.0 * GRAVITY, 2864.0 * GRAVITY, True, 30.0 * stress, 2.5 * stress, 0.4, 2.0 / 1.5 * stress)
    rows = [*asce41_piers(pier, 1.0, None, 1.0, "LS"), *en1998_piers(pier, 1.0, None, "SD"), *ntc_piers(pier, 1.0, 1.0, None, "SLV")]
    found = {x.rule: x.capacity for x in rows}
    printed = {
        "ASCE 41 rocking of a pier": 5726.0,
        "ASCE 41 residual sliding": 5441.0,
        "ASCE 41 bed-joint sliding": 8493.0,
        "ASCE 41 toe crushing": 4961.0,
        "ASCE 41 diagonal tension": 7957.0,
    }
    # they round v_me to 2.61, and press the pier with 4.63 where 1.1 (P_D + P_W)/A_n is 4.65
    within = {"ASCE 41 bed-joint sliding": 6e-4, "ASCE 41 toe crushing": 1.5e-3, "ASCE 41 diagonal tension": 1e-3}
    for name, value in printed.items():
        assert found[name] / GRAVITY == pytest.approx(value, rel=within.get(name, 2e-4)), name
    load = (10883.0 + 2864.0) * GRAVITY
    nu = load / (0.93 * 0.35) / (30.0 * stress)
    assert found["EN 1998-3 flexure"] == pytest.approx(0.93 * load / 1.8 * (1.0 - 1.15 * nu))
    tension = 2.0 * stress
    assert found["NTC diagonal cracking"] == pytest.approx(0.93 * 0.35 * tension / 1.5 * np.sqrt(1.0 + load / (0.93 * 0.35) / tension))


SITE = {"code": "EN1998-1", "ground": "B", "acceleration": "0.15 g"}


def test_the_nonlinear_check_of_the_circolare() -> None:
    """C8.7.1.2.1.8: d_SLV = 0.4 d_0 against S_De at 8 % and 1.68 pi sqrt(d_SLV/a(d_SLV)), [C8.7.1.10]."""
    r = mechanism(mechanism="wall", height=2.5, thickness=0.5, spectrum=SITE)["local-mechanism"]
    d0, a0 = 0.25, 0.2 * GRAVITY / 1.35
    period = 1.68 * np.pi * np.sqrt(0.4 * d0 / (0.6 * a0))
    assert r.equivalent_period_s == pytest.approx(period) and r.collapse_displacement_m == pytest.approx(0.6 * d0)
    check = r.checks["NTC nonlinear"]
    assert check.capacity == pytest.approx(0.4 * d0) and 0.5 < period < 2.0
    asked = np.sqrt(10.0 / 13.0) * 2.5 * 0.18 * GRAVITY * 0.5 / period * (period / (2.0 * np.pi)) ** 2
    assert check.demand == pytest.approx(asked) and "verify" not in check.source


def test_the_check_at_collapse_stands_beside_those_of_life_safety() -> None:
    """C8.7.1.2.1.8: d_SLC = 0.6 d_0 against S_De of SLC at 10 % and 1.56 pi sqrt(d_SLC/a(d_SLC)), [C8.7.1.11]."""
    rare = {**SITE, "acceleration": "0.4 g"}
    keys = {"mechanism": "wall", "height": 2.5, "thickness": 0.5, "spectrum": SITE}
    r = mechanism(**keys, collapse_spectrum=rare)["local-mechanism"]
    d0, a0 = 0.25, 0.2 * GRAVITY / 1.35
    period = 1.56 * np.pi * np.sqrt(0.6 * d0 / (0.4 * a0))
    check = r.checks["NTC nonlinear at SLC"]
    assert check.capacity == pytest.approx(r.collapse_displacement_m) == pytest.approx(0.6 * d0)
    of_life = r.checks["NTC nonlinear"]
    assert period > 2.0, "beyond T_D the displacement is the same for all"
    asked = 0.4 * 1.2 * GRAVITY * np.sqrt(10.0 / 15.0) * 2.5 * 0.5 * 2.0 / (4.0 * np.pi**2)
    assert check.demand == pytest.approx(asked)
    assert f"T_SLC = {period:.3f} s" in check.note
    # what holds at SLV does not make up for it, nor the other way round
    worse = mechanism(**keys, collapse_spectrum={**SITE, "acceleration": "4 g"})["local-mechanism"]
    assert worse.checks["NTC nonlinear"].verdict == of_life.verdict and worse.overall().outcome == "collapses"
    assert "SLC governs" in worse.overall().statement
    # a building that sways as slowly as the wall turns amplifies, a stiff one moves with the ground
    above = {**keys, "collapse_spectrum": rare, "base_height": 4.0, "building_height": 8.0}
    stiff, slow = (mechanism(**above, building_period=t)["local-mechanism"] for t in (0.2, 2.4))
    assert stiff.checks["NTC nonlinear at SLC"].demand == pytest.approx(check.demand)
    assert slow.checks["NTC nonlinear at SLC"].demand > 2.0 * check.demand
    with pytest.raises(DeckError, match=r"collapse_spectrum\.code: code EN1998-1 requires acceleration"):
        mechanism(**keys, collapse_spectrum={"code": "EN1998-1", "ground": "B"})


def test_the_floor_spectrum_of_the_circolare() -> None:
    """[C7.2.5] to [C7.2.7] by hand: rises to a T_1, flat to b T_1, falls, and from T_1 on is that of the ground at least."""

    def ground(period: float, damping: float) -> float:
        return 2.0 * np.sqrt(10.0 / (5.0 + 100.0 * damping)) if period > 0.0 else 1.0

    place = floor(ground, 8.0, 10.0, 3, 0.4)
    a_z = 2.0 * 0.8 * 9.0 / 7.0 * np.sqrt(1.01)
    assert place.acceleration == pytest.approx(a_z)
    eta = np.sqrt(10.0 / 13.0)
    top = 1.1 / np.sqrt(0.05) * eta * a_z
    assert place(0.35, 0.08) == place(0.4, 0.08) == pytest.approx(top)
    assert place(0.0, 0.05) == pytest.approx(a_z), "a rigid body feels the floor"
    # "una forte amplificazione in corrispondenza del periodo fondamentale", of stiff buildings 5 times by Table C7.2.II
    assert place(0.4, 0.05) == pytest.approx(5.0 * a_z, rel=0.02)
    rise = 1.1 / np.sqrt(0.05) * eta - 1.0
    assert place(0.2, 0.08) == pytest.approx(top / (1.0 + rise * (1.0 - 0.2 / 0.32) ** 1.6))
    assert place(9.0, 0.08) == pytest.approx(ground(9.0, 0.08)), "not below the ground"
    # the demand does not fall where the floor spectrum does [C8.7.1.12]
    late = displacement(place, 0.46, 0.08, peak=0.44)
    assert late >= place(0.44, 0.08) * (0.44 / (2.0 * np.pi)) ** 2


def test_at_a_height_the_floor_is_used_and_either_check_suffices() -> None:
    base = {"mechanism": "wall", "height": 1.2, "thickness": 0.3, "spectrum": SITE}
    low = mechanism(**base)["local-mechanism"].checks
    high = mechanism(**base, base_height=9.0, building_height=10.0, storeys=3)["local-mechanism"]
    linear = high.checks["NTC linear (at height z)"]
    assert linear.demand == pytest.approx(high.floor_acceleration_g) and linear.demand > low["NTC linear (at the ground)"].demand
    assert {linear.code, high.checks["NTC nonlinear"].code} == {"NTC 2018"}
    near = mechanism(**base, base_height=0.1, building_height=10.0, storeys=3)["local-mechanism"].checks
    assert near["NTC linear (at height z)"].demand == pytest.approx(0.18), "not less than the ground itself"


def test_a_place_at_a_height_is_not_checked_as_if_it_stood_on_the_ground() -> None:
    """A peak alone does not say what the floor does: no check of NTC holds by it."""
    run = mechanism(mechanism="parapet", height=1.2, thickness=0.3, peak_acceleration="0.15 g", base_height=9.0, building_height=10.0)
    checks = run["local-mechanism"].checks
    assert checks["NTC linear (at height z)"].demand is None and not any("at the ground" in name for name in checks)
    table = {
        "kind": "local-mechanism",
        "mechanism": "parapet",
        "height": 1.2,
        "thickness": 0.3,
        "peak_acceleration": "0.15 g",
        "base_height": 9.0,
        "building_height": 10.0,
    }
    part = extrados.run({"code": {"jurisdiction": "EN1998"}, "analysis": table})["local-mechanism"].checks["EN 1998-1 part of a building"]
    assert part.capacity == pytest.approx(0.25) and part.verdict == "fails", "q_a of Table 4.4 is 1 of a parapet"
    assert any("Without a spectrum these checks have no demand" in w for w in run.results[0].warnings)


def test_the_motion_is_not_asked_where_a_code_gives_the_spectrum() -> None:
    deck = {
        "structure": {"kind": "block", "width": 1.0, "height": 5.0},
        "analysis": {"kind": "code-checks", "spectrum": SITE, "motion_spectrum": True},
    }
    found = extrados.run(deck)["code-checks"]
    assert found.peak_ground_velocity_m_s is None and found.peak_ground_acceleration_g == pytest.approx(0.18)


def test_the_spectrum_of_the_motion_where_a_deck_has_no_code() -> None:
    block = {"structure": {"kind": "block", "width": 1.0, "height": 5.0}, "motion": {"kind": "record", "file": "extrados:el-centro-1940"}}

    def checked(**keys) -> object:
        return extrados.run({**block, "analysis": {"kind": "code-checks", **keys}})

    found = checked(motion_spectrum=True)["code-checks"]
    assert found.peak_ground_acceleration_g == pytest.approx(0.319, abs=0.001)
    assert found.peak_ground_velocity_m_s == pytest.approx(0.36, abs=0.03), "of El Centro"
    assert all(c.demand is not None for c in found.checks.values())
    # the greatest displacement of an oscillator up to T_SLV, not that at T_SLV
    period = float(found.checks["NTC nonlinear"].note.removeprefix("T_SLV = ").removesuffix(" s"))
    motion = extrados.run({**block, "analysis": {"kind": "motion", "dampings": [0.08]}})
    axis, sd = motion.array("motion", "period"), motion.array("motion", "sd")[0]
    asked = max(sd[axis <= period].max(), np.interp(period, axis, sd))
    assert found.checks["NTC nonlinear"].demand == pytest.approx(asked, rel=0.01)
    assert checked()["code-checks"].checks["NTC nonlinear"].demand is None
    coded = checked(spectrum=SITE, motion_spectrum=True)["code-checks"]
    assert coded.peak_ground_acceleration_g == pytest.approx(0.18), "that of a code goes first"
    (told,) = mechanism(mechanism="wall", height=2.0, thickness=0.4, motion_spectrum=True).analyses
    assert told["status"] == "refused" and "[motion]" in told["reason"]


def test_ties_and_a_wall_hold_the_buildings_own_mechanism() -> None:
    """b/h and the moment of both ties at what they bear, as tilt says; the displacement counts on the weight alone."""
    facade: dict = {
        "structure": {"kind": "block", "width": 0.6, "height": 8.0},
        "ties": [
            {"start": [-0.3, z], "start_stone": "block", "ground": [-5.3, z], "stiffness": "8 MN/m", "yield_force": f"{force} kN"}
            for z, force in ((3.8, 6), (7.4, 4))
        ],
    }
    asked = {"kind": "local-mechanism", "mechanism": "building", "peak_acceleration": "0.2 g"}
    weight = 2000.0 * GRAVITY * 0.6 * 8.0
    held = 0.075 + (6e3 * 3.8 + 4e3 * 7.4) / (weight * 4.0)
    free = extrados.run({**facade, "analysis": asked})["local-mechanism"]
    assert free.multiplier == pytest.approx(0.075, rel=1e-6), "ties do not hold it back from the cross walls"
    against = {**facade, "supports": {"abutting_wall": "left", "rebound": 0.4}}
    found = extrados.run({**against, "analysis": asked})["local-mechanism"]
    assert found.multiplier == pytest.approx(held, rel=1e-6)
    assert found.zero_displacement_m == pytest.approx(0.3, rel=1e-6)
    alone = 0.075 * GRAVITY / 1.35
    assert found.equivalent_period_s == pytest.approx(1.68 * np.pi * np.sqrt(0.4 * found.zero_displacement_m / (0.6 * alone)), rel=1e-6)
    facade["ties"][0].pop("yield_force")
    (told,) = extrados.run({**facade, "supports": {"abutting_wall": "left", "rebound": 0.4}, "analysis": asked}).analyses
    assert told["status"] == "refused" and "has no yield force" in told["reason"]


def test_a_mechanism_that_slides_is_not_taken_as_one_that_turns() -> None:
    block = {"structure": {"kind": "column", "width": 1.0, "height": 2.0, "drums": 1}}
    asked = {"kind": "local-mechanism", "mechanism": "building", "peak_acceleration": "0.2 g"}
    slides = extrados.run({**block, "joints": {"friction": 0.3}, "analysis": asked})
    r = slides["local-mechanism"]
    assert r.multiplier == pytest.approx(0.3, rel=1e-6) and r.participating_part == pytest.approx(1.0)
    assert r.zero_displacement_m is None and "slide" in slides.analyses[0]["warnings"][0]
    turns = extrados.run({**block, "joints": {"friction": 0.7}, "analysis": asked})
    assert turns["local-mechanism"].multiplier == pytest.approx(0.5, rel=1e-6) and not turns.analyses[0]["warnings"]


def test_ties_of_the_table_are_not_counted_on_to_collapse() -> None:
    """Circ. 7/2019 C8.7.1.2.1.6: d_0 on a curve of the actions that are there until collapse."""
    base = {"mechanism": "facade", "height": 6.0, "thickness": 0.6}
    bare, tied = (mechanism(**base, **more)["local-mechanism"] for more in ({}, {"ties": [{"height": 5.5, "force": 2e3}]}))
    assert tied.multiplier > bare.multiplier and tied.zero_displacement_m == pytest.approx(bare.zero_displacement_m)
    pushed = mechanism(**base, floors=[{"height": 6.0, "thrust": 1e3}])["local-mechanism"]
    assert pushed.zero_displacement_m < bare.zero_displacement_m
    only = mechanism(**base, floors=[{"height": 6.0, "thrust": 8e3}], ties=[{"height": 6.0, "force": 9e3}])
    assert only["local-mechanism"].zero_displacement_m is None and "no equilibrium without ties" in only.analyses[0]["warnings"][0]


def test_a_mechanism_whose_stones_crush_is_not_said_to_slide() -> None:
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
    own = {"kind": "local-mechanism", "mechanism": "building"}
    deck = {"structure": arch, "material": {"compressive_strength": 1e6}, "joints": {"friction": "no-sliding"}, "analysis": own}
    found = extrados.run(deck).results[0]
    assert (
        any("Blocks crush at the hinges before the rigid-body mechanism starts" in w for w in found.warnings) and "crushes" in found.answer
    )
    assert found.results.multiplier == pytest.approx(extrados.run({**deck, "analysis": {"kind": "tilt"}})["tilt"].collapse_acceleration_g)


OWN = {"kind": "local-mechanism", "mechanism": "building"}


def test_a_building_that_slides_apart_cannot_stand_by_its_own_mechanism() -> None:
    """Oppenheim's arch needs a friction of 0.206 at rest: the proof of limit analysis, as of `tilt`."""
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
    deck = {"structure": arch, "joints": {"friction": 0.2}, "analysis": [{"kind": "tilt"}, OWN]}
    tilt, own = extrados.run(deck).results
    assert tilt.verdict.outcome == own.verdict.outcome == "cannot-stand"
    assert own.results.certificate == tilt.results.certificate and "0.206" in own.answer


def test_a_stone_without_a_weight_is_refused_by_its_own_mechanism() -> None:
    column = {"kind": "column", "width": 0.3, "height": 0.45, "drums": 1}
    found = extrados.run({"structure": column, "material": {"density": 0.0}, "analysis": OWN}).results[0]
    assert found.status == "refused" and "material.density" in found.reason


def test_a_tie_that_holds_what_cannot_stand_is_no_proof_of_collapse() -> None:
    """An arch below the least thickness stands by a tie that yields: its rocking mechanism, without ties, proves nothing."""
    deck = {
        "structure": {"kind": "arch", "radius": 10.0, "thickness": 0.9, "embrace": 180, "voussoirs": 20},
        "ties": [{"start": [-9.9, 1.0], "end": [9.9, 1.0], "yield_force": 1e6, "stiffness": 1e8}],
        "motion": {"kind": "sine-pulse", "amplitude": "0.05 g", "period": 1.0},
        "analysis": [{"kind": "tilt"}, OWN, {"kind": "rocking"}],
    }
    tilt, own, rocking = extrados.run(deck).results
    assert tilt.verdict.outcome == "stands"
    for found in (own, rocking):
        assert found.verdict.outcome == "open" and "restraints" in found.verdict.violated[0]
    bare = extrados.run({k: v for k, v in deck.items() if k != "ties"}).results
    assert {found.verdict.outcome for found in bare} == {"cannot-stand"}


def test_a_stocky_arch_continues_those_a_little_less_stocky() -> None:
    """alpha_0, e*, a_0* and d_0*; the motion of the stocky one is followed by tables of twice as many panels."""

    def arch(thickness: float, friction: float = 2.0):
        structure = {"kind": "arch", "radius": 1.0, "thickness": thickness, "embrace": 170.0, "voussoirs": 6}
        return extrados.run({"structure": structure, "joints": {"friction": friction}, "analysis": [OWN, {"kind": "tilt"}]})

    stocky = arch(0.2932)
    found = stocky["local-mechanism"]
    assert found.multiplier == pytest.approx(stocky["tilt"].collapse_acceleration_g, rel=1e-9)
    near, nearer = (arch(t)["local-mechanism"] for t in (0.28, 0.29))
    for key in ("multiplier", "participating_part", "activation_acceleration_g", "zero_displacement_m"):
        ahead = nearer[key] + (0.2932 - 0.29) / 0.01 * (nearer[key] - near[key])
        assert found[key] == pytest.approx(ahead, rel=1e-3), key
    slides = arch(0.2932, 0.5)
    least, most = slides["tilt"].interval()
    assert slides["local-mechanism"].multiplier == pytest.approx(least, rel=1e-9)
    assert (slides["local-mechanism"].multiplier_associated or least) == pytest.approx(most, rel=1e-6)
