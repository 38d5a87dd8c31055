"""Walls laid in running bond: geometry, capacity against an outside programme, macro-blocks, chains among free blocks."""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

import extrados
from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.limit import programme
from extrados.limit.answer import assess
from extrados.limit.graphic import thrust_of
from extrados.limit.programme import LimitAnalysis, NoAnswer
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.drawing import Polygon
from extrados.model.geometry.polygons import properties
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import make_blocks
from extrados.model.structures.brickwork import Bond, make_brickwork
from extrados.model.structures.piers import make_piers
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY

PANEL = {"kind": "panel", "width": 3.0, "height": 2.4, "thickness": 0.25}
UNIT = {"unit_length": "25 cm", "unit_height": "12 cm"}
WINDOW = {"x": [0.9, 1.8], "y": [0.7, 1.73]}


def run(structure: dict[str, Any], *analyses: dict[str, Any], folder: Path | None = None, **tables: Any) -> list[Result]:
    deck = make_deck({"structure": structure, "analysis": list(analyses), **tables}, folder)
    return run_analyses(Context(deck, threads=1))


def outside_capacity(a: Assembly, friction: float) -> float:
    """Greatest gamma by a programme of three forces a joint and three equations a block, written apart."""
    m, n = len(a.a), len(a.mass)
    equations, right = np.zeros((3 * n, 3 * m + 1)), np.zeros(3 * n)
    for j in range(m):
        for block, sign in ((a.a[j], 1.0), (a.b[j], -1.0)):
            if block == GROUND:
                continue
            for k, (force, point) in enumerate(((a.normal[j], a.p[j]), (a.normal[j], a.q[j]), (a.tangent[j], a.middle[j]))):
                arm = point - a.centroid[block]
                equations[3 * block : 3 * block + 3, 3 * j + k] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
    weight = a.mass / a.mass.sum()
    equations[0::3, -1] = weight
    right[1::3] = weight
    cone = np.zeros((2 * m, 3 * m + 1))
    for j in range(m):
        cone[2 * j : 2 * j + 2, 3 * j : 3 * j + 2] = -friction
        cone[2 * j : 2 * j + 2, 3 * j + 2] = 1.0, -1.0
    cost = np.zeros(3 * m + 1)
    cost[-1] = -1.0
    bounds = [(0, None), (0, None), (None, None)] * m + [(None, None)]
    found = linprog(cost, A_ub=cone, b_ub=np.zeros(2 * m), A_eq=equations, b_eq=right, bounds=bounds)
    assert found.success
    return -found.fun


WALLS = [
    ({"begins": "whole"}, []),
    ({"begins": "half"}, [(0.9, 1.8, 0.7, 1.73)]),
    ({"lintels": False}, [(0.9, 1.8, 0.7, 1.73), (2.3, 2.7, 0.0, 1.9)]),
    ({"lintel_height": 0.2, "lintel_bearing": 0.3}, [(0.5, 1.0, 0.0, 1.5), (1.2, 1.9, 0.51, 1.5), (2.5, 3.5, 1.0, 1.8)]),
    ({}, [(-0.5, 0.7, -1.0, 1.1), (1.5, 2.0, 2.0, 3.0)]),
]


@pytest.mark.parametrize(("keys", "openings"), WALLS)
def test_stones_fill_the_wall(keys: dict, openings: list) -> None:
    wall = make_brickwork(Bond(0.25, 0.12, **keys), 3.0, 2.4, openings, 2000.0, 0.25)
    cut = sum((min(b, 3.0) - max(a, 0.0)) * (min(d, 2.4) - max(c, 0.0)) for a, b, c, d in openings)
    assert wall.mass.sum() == pytest.approx((3.0 * 2.4 - cut) * 2000.0 * 0.25, rel=1e-12)
    assert len(set(wall.block_names)) == len(wall.mass) and len(set(wall.joint_names)) == len(wall.a)
    # The contact search of free polygons finds the same joints, and no stone in another.
    polygons = [Polygon(n, o) for n, o in zip(wall.block_names, wall.outlines, strict=True)]
    again = make_blocks(polygons, np.array([[-1.0, 0.0, 4.0, 0.0]]), tolerance=1e-7)
    assert len(again.a) == len(wall.a)
    assert again.length.sum() == pytest.approx(wall.length.sum(), rel=1e-9)
    sizes = np.array([np.ptp(o, axis=0) for o in wall.outlines])
    assert (sizes >= 0.25 * np.array([0.25, 0.12]) - 1e-9).all()


def test_bond_and_cut_units() -> None:
    wall = make_brickwork(Bond(0.25, 0.12), 1.0, 0.36)
    lengths = [[float(np.ptp(o[:, 0])) for o in wall.outlines if o[0, 1] == pytest.approx(y)] for y in (0.0, 0.12, 0.24)]
    assert lengths == [[0.25] * 4, [0.125, 0.25, 0.25, 0.25, 0.125], [0.25] * 4]
    half = make_brickwork(Bond(0.25, 0.12, begins="half"), 1.0, 0.12)
    assert len(half.mass) == 5
    # 2 cm over: the last unit takes it in, and the last course the 1 cm above.
    odd = make_brickwork(Bond(0.25, 0.12), 1.02, 0.13)
    assert [tuple(np.ptp(o, axis=0).round(9)) for o in odd.outlines] == [(0.25, 0.13)] * 3 + [(0.27, 0.13)]
    # A quarter unit may stand by itself where the least is less.
    assert len(make_brickwork(Bond(0.25, 0.12, least_unit=0.05), 1.02, 0.12).mass) == 5


def test_lintels_rest_on_piers_and_share_them() -> None:
    bond = Bond(0.25, 0.12)
    wall = make_brickwork(bond, 3.0, 2.4, [(0.5, 1.0, 0.0, 1.2), (1.1, 1.6, 0.6, 1.2), (2.2, 2.6, 0.0, 2.4)])
    box = {n: o for n, o in zip(wall.block_names, wall.outlines, strict=True) if n.startswith("lintel")}
    assert set(box) == {"lintel 1", "lintel 2"}  # the third opening reaches the top
    assert box["lintel 1"][[0, 2]] == pytest.approx(np.array([[0.375, 1.2], [1.05, 1.32]]))
    assert box["lintel 2"][[0, 2]] == pytest.approx(np.array([[1.05, 1.2], [1.725, 1.32]]))
    with pytest.raises(BadGeometry, match="no place for a lintel"):
        make_brickwork(bond, 3.0, 2.4, [(0.5, 1.0, 0.0, 1.2), (0.8, 1.6, 1.0, 1.8)])
    with pytest.raises(BadGeometry, match="occupy the whole wall"):
        make_brickwork(bond, 3.0, 2.4, [(0.0, 3.0, 0.0, 2.4)])
    with pytest.raises(BadGeometry, match="are allowed"):
        make_brickwork(Bond(0.01, 0.01), 3.0, 2.4)


@pytest.mark.parametrize(("keys", "openings"), WALLS[:2])
@pytest.mark.parametrize("friction", [0.3, 0.7])
def test_capacity_of_walls(keys: dict, openings: list, friction: float) -> None:
    wall = make_brickwork(Bond(0.5, 0.3, **keys), 3.0, 2.4, openings)
    answer = assess(wall, friction)
    assert answer.gamma == pytest.approx(outside_capacity(wall, friction), abs=1e-8)


@pytest.mark.parametrize(("units", "courses"), [(3, 6), (3, 8), (5, 4), (6, 3), (8, 3), (2, 12)])
def test_walls_of_few_loops_are_answered_whole(units: int, courses: int) -> None:
    """27 to 38 loops: the most central line used to wander where head joints carry nothing."""
    wall = make_brickwork(Bond(0.5, 0.25), 0.5 * units, 0.25 * courses)
    answer = assess(wall, 0.65)
    assert answer.gamma == pytest.approx(outside_capacity(wall, 0.65), abs=1e-8)
    assert answer.warnings == () and np.isinf(answer.safety) and answer.central is not None


def test_a_picture_that_fails_is_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up(self: LimitAnalysis, *args: Any, **options: Any) -> None:
        raise NoAnswer("it wandered")

    arch = make_arch(10.0, 1.5, 157.5, 7)
    whole = assess(arch, 0.7)
    for name in ("central", "thrust", "recentred"):
        monkeypatch.setattr(programme.LimitAnalysis, name, gives_up)
    (bare,) = run({"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}, {"kind": "tilt"})
    assert bare["collapse_acceleration_g"] == pytest.approx(whole.gamma, abs=1e-12)
    assert sum("not given: it wandered" in w for w in bare.warnings) == 3


@pytest.mark.parametrize("gamma", [0.0, 0.2])
@pytest.mark.parametrize("courses", [5, 6])
def test_most_central_state_of_both_forms(gamma: float, courses: int) -> None:
    wall = make_brickwork(Bond(0.5, 0.25), 2.0, 0.25 * courses)
    (_, fine), (state, coarse) = (LimitAnalysis(wall, 0.7, form=form).central(gamma) for form in ("reduced", "sparse"))
    assert coarse == pytest.approx(fine, abs=1.1e-3)
    carries = state.normal > 1e-6 * state.normal.max()
    assert (np.abs(2.0 * state.position - 1.0)[carries] <= coarse + 1.1e-3).all()
    assert (np.abs(state.shear) <= 0.7 * state.normal * (1.0 + 1e-6) + 1e-6 * state.normal.max()).all()


def test_panel_as_stones() -> None:
    tilt, thrust = run({**PANEL, **UNIT, "openings": [WINDOW]}, {"kind": "tilt"}, {"kind": "thrust", "gamma": 0.1})
    assert tilt.status == "ok" and 0.2 < tilt["collapse_acceleration_g"] < 0.7
    assert "thrusts" not in tilt.results
    assert thrust["chain"] is None and "no minimum and maximum thrust are given" in thrust.answer
    up = sum(r["vertical_N"] for r in thrust["central"]["reactions"])
    side = sum(r["horizontal_N"] for r in thrust["central"]["reactions"])
    assert up == pytest.approx(thrust["weight_N"], rel=1e-6) and side == pytest.approx(-0.1 * up, rel=1e-5)
    (refused,) = run({**PANEL, **UNIT}, {"kind": "thrust", "chain": "arch"})
    assert "no blocks form an arch or column" in refused.reason
    (refused,) = run(PANEL, {"kind": "tilt"})
    assert refused.status == "refused" and "give `unit_length` and `unit_height`" in refused.reason
    with pytest.raises(DeckError, match="give both `unit_length` and `unit_height`, or neither"):
        run({**PANEL, "unit_length": 0.25}, {"kind": "tilt"})


def test_what_falls_without_lintels() -> None:
    (result,) = run(
        {
            "kind": "brickwork",
            "unit_length": 0.4,
            "unit_height": 0.2,
            "units": 4,
            "courses": 5,
            "lintels": False,
            "openings": [{"x": [0.4, 1.2], "y": [0.0, 0.8]}],
        },
        {"kind": "tilt"},
        joints={"friction": 0.5},
    )
    assert result.verdict.outcome == "cannot-stand" and "Only friction carries unit 2 of course 5" in result.answer


def test_regions_of_another_density() -> None:
    heavy = {"x": [0.0, 3.0], "y": [1.2, 2.4], "material": "stone"}
    tables = {"material": {"density": 1000.0}, "materials": {"stone": {"density": 2500.0}}}
    (plain,) = run({**PANEL, **UNIT}, {"kind": "tilt"}, material={"density": 1000.0})
    (mixed,) = run({**PANEL, **UNIT, "regions": [heavy]}, {"kind": "tilt"}, **tables)
    assert mixed["weight_N"] == pytest.approx(1.75 * plain["weight_N"])
    (refused,) = run({**PANEL, **UNIT, "regions": [{**heavy, "thickness": 0.5}]}, {"kind": "tilt"}, **tables)
    assert "its own thickness" in refused.reason


def test_macro_blocks() -> None:
    wall = make_piers(5.0, 3.0, [(1.0, 2.0, 0.0, 2.1), (3.0, 4.0, 0.9, 2.1)], 2000.0, 0.25)
    assert wall.block_names == ["pier 1", "pier 2", "pier 3", "pier 4", "spandrel 1"]
    assert wall.joint_names[0] == "base of pier 1" and len(wall.a) == 7
    assert wall.mass.sum() == pytest.approx((15.0 - 2.1 - 1.2) * 500.0)
    window = make_piers(5.0, 3.0, [(1.0, 2.0, 0.9, 2.1)], 2000.0, 0.25)
    assert window.block_names == ["base", "pier 1", "pier 2", "spandrel 1"]
    # Two slender piers and a beam, hinged at their toes: a parallelogram falls at its piers' width over height.
    portal = make_piers(3.0, 3.0, [(0.3, 2.7, 0.0, 2.4)], 2000.0, 0.25)
    assert LimitAnalysis(portal).collapse()[0].gamma == pytest.approx(0.3 / 2.4, rel=1e-9)
    with pytest.raises(BadGeometry, match="no masonry remains there"):
        make_piers(3.0, 3.0, [(0.0, 3.0, 0.0, 1.0)], 2000.0, 0.25)


def test_a_wall_rocks_as_one_pier() -> None:
    pulse = {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 0.8}
    shapes = (
        {"kind": "block", "width": 1.0, "height": 4.0},
        {"kind": "panel", "width": 1.0, "height": 4.0, "thickness": 0.3},
        {"kind": "brickwork", "unit_length": 0.25, "unit_height": 0.1, "units": 4, "courses": 40},
    )
    block, *walls = (run(shape, {"kind": "rocking", "hand_over": False}, motion=pulse)[0] for shape in shapes)
    for wall in walls:
        assert wall["outcome"] == block["outcome"]
        assert wall["impact_times_s"] == pytest.approx(block["impact_times_s"], rel=1e-9)
    # Two piers and the spandrel over a wide door rock as a parallelogram, from the piers' width over height on.
    door = {"x": [0.4, 2.6], "y": [0.0, 2.4]}
    wall = {**shapes[1], "width": 3.0, "height": 3.0, "openings": [door]}
    deck = make_deck({"structure": wall, "analysis": {"kind": "tilt"}})
    assert deck.building.rocker().uplift == pytest.approx(0.4 / 2.4, rel=1e-9)


def test_arch_of_free_blocks_has_its_chain(tmp_path: Path) -> None:
    """Stones in any order and turned any way: thrusts and hinges are those of the arch that they are."""
    arch = make_arch(10.0, 1.5, 157.5, 7)
    stones = [np.array([arch.p[i], arch.q[i], arch.q[i + 1], arch.p[i + 1]]) for i in range(7)]
    order = [3, 0, 6, 1, 5, 2, 4]
    blocks = [{"name": f"s{i}", "points": np.roll(stones[i], i, axis=0)[:: (-1) ** i].tolist()} for i in order]
    ground = [[*arch.p[j], *arch.q[j]] for j in (7, 0)]
    (tmp_path / "arch.json").write_text(json.dumps({"blocks": blocks, "ground": [list(map(float, g)) for g in ground]}))
    thrust, tilt, load = run(
        {"kind": "blocks", "file": "arch.json"}, {"kind": "thrust"}, {"kind": "tilt"}, {"kind": "moving-load"}, folder=tmp_path
    )
    assert thrust["chain"] == "chain"
    # The arch with the weight of straight-sided stones
    area, centroid, polar = zip(*(properties(s if properties(s)[0] > 0 else s[::-1]) for s in stones), strict=True)
    object.__setattr__(arch, "mass", np.array(area) * 2000.0)
    object.__setattr__(arch, "centroid", np.array(centroid))
    object.__setattr__(arch, "inertia", np.array(polar) * 2000.0)
    limit = LimitAnalysis(arch, 0.7)
    for which, state in zip(("least", "most"), limit.thrust(arch.chains["arch"]), strict=True):
        wanted = thrust_of(arch, state, arch.chains["arch"])
        assert thrust[which]["horizontal_N"] == pytest.approx(wanted, rel=1e-9) and wanted > 0.0
    state, mechanism = limit.collapse()
    assert tilt["collapse_acceleration_g"] == pytest.approx(state.gamma, rel=1e-10)
    assert sorted(h["side"] for h in tilt["hinges"]) == sorted(side for _, side in mechanism.hinges)
    assert load.status == "ok" and load["chain"] == "chain"


def test_chains_of_other_assemblies() -> None:
    def box(name: str, x: float, y: float, b: float, h: float) -> Polygon:
        return Polygon(name, np.array([[x, y], [x + b, y], [x + b, y + h], [x, y + h]]))

    two = make_blocks([box("a", 0, 0, 1, 1), box("b", 0, 1, 1, 1), box("c", 3, 0, 1, 1)], None)
    names = {name: [two.joint_names[j] for j in joints] for name, joints in two.chains.items()}
    assert names == {"stack 1": ["a on the ground", "a on b"], "stack 2": ["c on the ground"]}
    gate = make_blocks([box("a", 0, 0, 1, 2), box("b", 2, 0, 1, 2), box("c", 0, 2, 3, 1)], None)
    assert [gate.joint_names[j] for j in gate.chains["chain"]] == ["a on the ground", "a on c", "b on c", "b on the ground"]
    # Its piers are pushed apart as far as they are pulled together: least and greatest thrust are opposite.
    least, most = (thrust_of(gate, s, gate.chains["chain"]) for s in LimitAnalysis(gate, 0.7).thrust(gate.chains["chain"]))
    assert least == pytest.approx(-most, rel=1e-9) and most > 0.0
    bonded = make_brickwork(Bond(0.5, 0.25), 2.0, 1.0)
    assert bonded.chains == {}
    polygons = [Polygon(n, o) for n, o in zip(bonded.block_names, bonded.outlines, strict=True)]
    assert make_blocks(polygons, None).chains == {}


def test_stacks_and_loads_on_a_wall() -> None:
    (column,) = run({"kind": "column", "width": 1.0, "height": 4.0, "drums": 5}, {"kind": "thrust", "gamma": 0.1})
    assert column["least"]["horizontal_N"] == pytest.approx(column["most"]["horizontal_N"], rel=1e-9)
    assert abs(column["most"]["horizontal_N"]) == pytest.approx(0.1 * column["weight_N"], rel=1e-9)
    # At 0.1 g the resultant of 4 m of stone is 0.2 m off the middle of the base: 40 % of the joint.
    assert column["least_part_of_joints"] == pytest.approx(0.4, abs=1e-8)
    cornice = [
        {"name": "wall", "points": [[0, 0], [1, 0], [1, 2], [0, 2]]},
        {"name": "cornice", "points": [[0, 2], [1.8, 2], [1.8, 2.5], [0, 2.5]], "density": 4000.0},
    ]
    (load,) = run({"kind": "blocks", "block": cornice}, {"kind": "moving-load", "count": 5})
    # At its end the load has a lever of 0.8 m about the edge of the wall, the cornice of 3600 kg one of 0.1 m.
    assert load["worst_place_m"] == pytest.approx(1.8, abs=1e-6)
    assert load["collapse_load_N"] == pytest.approx(450.0 * GRAVITY, rel=1e-6)
    (tapered,) = run({"kind": "column", "width": 0.4, "top_width": 1.4, "height": 3.0}, {"kind": "moving-load"})
    assert tapered["worst_place_m"] == pytest.approx(-0.7, abs=1e-6) or tapered["worst_place_m"] == pytest.approx(0.7)


def test_the_most_central_line_of_the_smallest_wall_ends() -> None:
    """Its joints may come to carry nothing, where the programmes no longer tell nearer parts apart."""
    wall = {"kind": "brickwork", "unit_length": 0.3, "unit_height": 0.15, "units": 2, "courses": 2}
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        found = extrados.run({"structure": wall, "joints": {"friction": 0.7}, "analysis": {"kind": "thrust"}}).results[0]
    assert found.status == "ok" and found.results.geometric_safety_factor is None, "through all middles"
    assert found.results.central.greatest_eccentricity_ratio < 1e-3


def test_a_wall_without_its_most_central_line_keeps_its_bounds(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    wall = {"kind": "brickwork", "unit_length": 0.3, "unit_height": 0.15, "units": 2, "courses": 2}

    def asked(gamma: float) -> extrados.running.run.Run:
        deck = {"structure": wall, "joints": {"friction": 0.7}, "analysis": {"kind": "thrust", "gamma": gamma}}
        return extrados.run(deck, out=tmp_path / f"{gamma:g}")

    whole = asked(0.1).results[0]

    def gives_up(*_: object, **__: object) -> None:
        raise NoAnswer("the iteration for the most central thrust line did not converge")

    monkeypatch.setattr(LimitAnalysis, "central", gives_up)
    found = asked(0.1).results[0]
    assert found.status == "ok" and any("did not converge" in w for w in found.warnings) and found.results.central is None
    assert found.results.admissible_interval_g == whole.results.admissible_interval_g and "admissible" in found.answer
    assert asked(0.8).results[0].status == "refused"
