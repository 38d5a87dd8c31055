"""thrust, sweep, survey and imperfections of blocks in space: the plane, closed forms, pyramids by another solver."""

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog
from test_noisy_solids import corner, obj

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.errors import NoEquilibrium
from extrados.limit.solid_states import SolidState, SolidStates
from extrados.limit.solids import Programme, SolidLimit
from extrados.model.geometry.deviation import resurveyed_solids
from extrados.model.geometry.solids.assembly import SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import box, prism
from extrados.results.model import Result
from extrados.running.run import Run, compute
from extrados.schema.constants import GRAVITY
from extrados.show.charts import shown

ARCH = {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 15, "depth": 2.0}
DOME = {"kind": "dome", "radius": 5.0, "thickness": 0.5, "rings": 4, "lunes": 8}
PRISM = {"kind": "column", "section": "round", "sides": 5, "width": 1.0, "height": 4.0, "drums": 1}
GROUND = -1


def run(structure: dict[str, Any], friction: Any = 0.7, folder: Path | None = None, **analysis: Any) -> Result:
    deck = make_deck({"structure": structure, "joints": {"friction": friction}, "analysis": analysis}, folder)
    return run_analyses(Context(deck, threads=1))[0]


def limit_of(structure: dict[str, Any], friction: float = 0.7) -> SolidLimit:
    solids = make_deck({"structure": structure, "analysis": {"kind": "tilt"}}).building.solids()
    return SolidLimit(solids, friction)


def states_of(limit: SolidLimit, gamma: float = 0.0) -> SolidStates:
    dead, live = limit.ways(0.0)
    return SolidStates(limit, dead + gamma * live)


@pytest.mark.parametrize("gamma", [0.0, 0.08, -0.2])
@pytest.mark.parametrize("across", [1, 2])
def test_an_extruded_arch_has_the_thrust_of_its_section(gamma: float, across: int) -> None:
    plane = run(ARCH, kind="thrust", gamma=gamma).results
    structure = {**ARCH, "stones_across": across} if across > 1 else ARCH
    solids = make_deck({"structure": structure, "analysis": {"kind": "tilt"}}).building.solids()
    own = [n for n, p in zip(solids.joint_names, solids.polygon, strict=True) if p[:, 0].max() < 0 and "ground" in n]
    own = own or [solids.joint_names[0]]
    table = {"name": "left", "joints": own, "toward": 180.0}
    space = run(structure, kind="thrust", gamma=gamma, direction=0.0, section=[table]).results
    (section,) = space.sections
    assert section.least_N == pytest.approx(plane.least.horizontal_N, rel=1e-6)
    assert section.greatest_N == pytest.approx(plane.most.horizontal_N, rel=1e-6)
    assert space.least_part_of_joints == pytest.approx(plane.least_part_of_joints, rel=2e-3)
    assert space.admissible_interval_g == pytest.approx(plane.admissible_interval_g, abs=1e-7)
    if not gamma:  # elsewhere the central line may be one of several
        assert section.central_N == pytest.approx(plane.central.horizontal_N, rel=1e-2)
    assert max(space.duality_gap, space.equilibrium_residual, space.friction_residual) < 1e-8


def by_pyramids(solids: SolidAssembly, mu: float, toward: np.ndarray, gamma: float, sides: int, wider: float) -> float:
    """Least sum of the forces on the first blocks times `toward` (nj, 3) [N]: edges of pyramids, moments about the origin, HiGHS."""
    columns, cost = [], []
    for place, j in zip(solids.corner, solids.corner_joint.tolist(), strict=True):
        n = solids.normal[j]
        first = np.cross(n, [0.31, 0.52, 0.8])
        first /= np.linalg.norm(first)
        for turn in 2.0 * np.pi * np.arange(sides) / sides:
            edge = n + wider * mu * (np.cos(turn) * first + np.sin(turn) * np.cross(n, first))
            column = np.zeros((len(solids.mass), 6))
            for block, sense in ((solids.a[j], 1.0), (solids.b[j], -1.0)):
                if block != GROUND:
                    column[block] += sense * np.concatenate([edge, np.cross(place, edge)])
            columns.append(column.ravel())
            cost.append(float(edge @ toward[j]))
    load = np.zeros((len(solids.mass), 6))
    load[:, :3] = solids.mass[:, None] * GRAVITY * np.array([gamma, 0.0, -1.0])
    load[:, 3:] = np.cross(solids.centroid, load[:, :3])
    unit = float(solids.mass.mean()) * GRAVITY
    found = linprog(np.array(cost), A_eq=sparse.csr_array(np.array(columns).T), b_eq=-load.ravel() / unit, method="highs")
    assert found.status == 0
    return float(found.fun) * unit


@pytest.mark.parametrize(("sense", "gamma"), [(1.0, 0.0), (-1.0, 0.1)])
def test_thrust_of_a_dome_lies_between_pyramids(sense: float, gamma: float) -> None:
    limit = limit_of({**DOME, "rings": 3, "lunes": 6})
    solids = limit.assembly
    toward = np.zeros((len(solids.a), 3))
    ground = np.flatnonzero(solids.b == GROUND)
    out = np.array([solids.polygon[j].mean(axis=0) for j in ground]) * [1.0, 1.0, 0.0]
    toward[ground] = -sense * out / np.linalg.norm(out, axis=1)[:, None]
    state = states_of(limit, gamma).extreme(toward)
    assert isinstance(state, SolidState)
    value = float((state.force * toward).sum())
    outer = by_pyramids(solids, 0.7, toward, gamma, 8, 1.0 / np.cos(np.pi / 8))
    inner = by_pyramids(solids, 0.7, toward, gamma, 8, 1.0)
    assert outer <= value * (1.0 + 1e-7) and value <= inner + 1e-7 * abs(inner)
    assert inner - outer < 0.15 * abs(value)


def test_no_state_lies_within_a_lesser_part_of_the_contacts() -> None:
    """The programme of the motion on contacts shrunk about their middles by hand."""
    limit = limit_of(DOME)
    state, part = states_of(limit).central()
    assert 0.2 < part < 0.8 and state.friction.max() < 0.7 and state.equilibrium < 1e-8
    middle = states_of(limit).middle
    for share, falls in ((part * 0.998, True), (part, False)):
        polygon = [m + share * (p - m) for p, m in zip(limit.assembly.polygon, middle, strict=True)]
        narrow = SolidLimit(replace(limit.assembly, polygon=polygon), 0.7)
        assert (narrow.falls() is not None) == falls


def test_blocks_wedged_between_walls_have_no_greatest_thrust() -> None:
    stones = [Stone(f"stone {k}", [box((k, 0.0, 2.0), (k + 1.0, 1.0, 3.0))], 2000.0) for k in range(3)]
    ends = [
        np.array([(x, y, z) for y, z in order])
        for x, order in ((0.0, ((0, 2), (1, 2), (1, 3), (0, 3))), (3.0, ((0, 2), (0, 3), (1, 3), (1, 2))))
    ]
    solids = assemble(stones, seats=[(0, ends[0]), (2, ends[1])])
    limit = SolidLimit(solids, 0.7)
    toward = np.zeros((len(solids.a), 3))
    j = int(np.flatnonzero((solids.a == 0) & (solids.b == GROUND))[0])
    toward[j] = np.sign(solids.normal[j, 0]) * np.array([1.0, 0.0, 0.0])
    states = states_of(limit)
    least = states.extreme(toward)
    assert least is not None
    weight = float(limit.weight.sum())
    # half the weight at each wall by friction, or the moment of three stones: the greater governs
    assert float((least.force * toward).sum()) == pytest.approx(max(0.5 * weight / 0.7, weight * 3.0 / 8.0), rel=1e-6)
    assert states.extreme(-toward) is None


def test_a_push_beyond_the_interval_is_refused() -> None:
    found = run(ARCH, kind="thrust", direction=0.0, gamma=0.9)
    assert found.status == "refused" and "the blocks carry accelerations from -0." in str(found.reason)
    limit = limit_of(ARCH)
    with pytest.raises(NoEquilibrium):
        states_of(limit, 0.9).central()


def test_the_thrust_on_the_ground_of_one_block_is_its_push() -> None:
    """A contact under the middle has no direction outward: the default section takes that of the load, a given one needs `toward`."""
    block = {"kind": "block", "width": 1.0, "height": 3.0, "depth": 0.5}
    found = run(block, kind="thrust", direction=30.0, gamma=0.1).results
    ground = next(s for s in found.sections if s.name == "ground")
    weight = 1.0 * 3.0 * 0.5 * 2000.0 * GRAVITY
    assert max(abs(ground.least_N), abs(ground.greatest_N)) == pytest.approx(0.1 * weight, rel=1e-6)
    assert "(30 deg in plan) from 2.94 kN to 2.94 kN" in run(block, kind="thrust", direction=30.0, gamma=0.1).answer
    assert "from 0 kN to 0 kN, 0 kN in the most central state" in run(block, kind="thrust", direction=30.0).answer  # no rounding
    assert run(PRISM, kind="thrust", gamma=0.1).status == "ok"  # a round column, along +x by default
    refused = run(block, kind="thrust", direction=30.0, section=[{"name": "a", "joints": ["ground"]}])
    assert refused.status == "refused" and "give the key `toward`" in refused.reason


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"name": "a", "x": 99.0}, "section 'a': its cut crosses no contact between two blocks"),
        ({"name": "a", "joints": ["nowhere"]}, "no contact has the name 'nowhere'"),
    ],
)
def test_wrong_sections_are_refused(section: dict[str, Any], words: str) -> None:
    found = run(DOME, kind="thrust", section=[section])
    assert found.status == "refused" and words in str(found.reason)


def test_keys_of_the_plane_are_refused_in_space() -> None:
    assert "thrust of solids cannot include chain" in str(run(DOME, kind="thrust", chain="arch").reason)
    assert "sweep of solids cannot include fracture" in str(
        run(DOME, kind="sweep", vary="thickness", start=0.4, stop=0.5, fracture=True).reason
    )
    assert "applies only to analyses of blocks in space" in str(run(ARCH, kind="thrust", section=[{"name": "a", "x": 0.0}]).reason)


def test_a_sweep_of_an_extruded_arch_is_that_of_its_section() -> None:
    keys: dict[str, Any] = {"kind": "sweep", "vary": "thickness", "values": [0.4, 0.7, 1.0], "locate": False}
    plane, space = run(ARCH, **keys).results, run(ARCH, direction=0.0, **keys).results
    assert space.collapse_accelerations_g == pytest.approx(plane.collapse_accelerations_g, abs=1e-7)
    assert [g.status for g in space.gaps] == [g.status for g in plane.gaps]
    assert "locate = true` locates them" in run(ARCH, direction=0.0, **keys).answer


def test_a_sweep_over_the_direction_of_a_prism(tmp_path: Path) -> None:
    """The reach of the polygon over the height of its centre, in each direction; figures and the page show it."""
    sweep = {"kind": "sweep", "vary": "direction", "start": 0, "stop": 180, "count": 7}
    deck = make_deck({"structure": PRISM, "joints": {"friction": 5.0}, "analysis": sweep})
    made = compute(Context(deck, threads=1))
    made.write(tmp_path / "out")
    r = made.results[0].results
    words, arrays = shown(Run.read(tmp_path / "out"), "sweep")
    assert words["charts"][0]["x"]["unit"] == "deg" and len(arrays["gamma"]) == 7
    base = deck.building.solids().polygon[0][:, :2]
    sides = np.roll(base, -1, axis=0) - base
    out = np.column_stack([sides[:, 1], -sides[:, 0]]) / np.linalg.norm(sides, axis=1)[:, None]
    apothem = np.abs((base * out).sum(axis=1))
    out *= np.sign((base * out).sum(axis=1))[:, None]
    for direction, gamma in zip(r.values, r.collapse_accelerations_g, strict=True):
        way = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
        along = out @ way
        assert gamma == pytest.approx(float(min(apothem[along > 1e-9] / along[along > 1e-9])) / 2.0, abs=1e-6)
    assert r.vary == "direction" and r.unit == "deg"


def test_a_sweep_of_friction_of_a_slab() -> None:
    slab = {"kind": "column", "section": "round", "sides": 6, "width": 2.0, "height": 0.5, "drums": 1}
    r = run(slab, kind="sweep", vary="joints.friction", values=[0.2, 0.4, 0.6], direction=33.0).results
    assert r.collapse_accelerations_g == pytest.approx([0.2, 0.4, 0.6], abs=1e-7) and r.upper_bound_values == [0.2, 0.4, 0.6]
    assert "1 blocks move" in r.mechanisms[0].hinges


def test_random_surveys_of_a_block_by_hand() -> None:
    """Its moment about the line through both corners of its base on the side of the push."""
    solids = assemble([Stone("block", [box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))], 2000.0)])
    for seed in range(20):
        one = resurveyed_solids(solids, 0.02, np.random.default_rng(seed))
        assert np.linalg.norm(one.polygon[0] - solids.polygon[0], axis=1).max() <= 0.02
        found = SolidLimit(one, 5.0).push(0.0)
        assert isinstance(found, Programme)
        first, second = one.polygon[0][one.polygon[0][:, 0] > 0.5]
        arm, edge = one.centroid[0] - first, second - first
        by_hand = -(edge @ np.cross(arm, [0.0, 0.0, -1.0])) / (edge @ np.cross(arm, [1.0, 0.0, 0.0]))
        assert found.gamma == pytest.approx(by_hand, abs=1e-7)


def test_points_of_a_random_survey_lie_evenly_in_a_ball() -> None:
    """Of the radius mean 3/4 and variance 3/80, of each coordinate variance 1/5, in radii of the ball; the mass to first order."""
    solids = assemble([Stone("block", [box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))], 2000.0)])
    points = np.tile(solids.polygon[0], (5000, 1))
    way = resurveyed_solids(replace(solids, polygon=[points]), 0.02, np.random.default_rng(1)).polygon[0] - points
    radius = np.linalg.norm(way, axis=1) / 0.02
    assert radius.max() <= 1.0 + 1e-9
    # 20,000 points: five standard errors of the means
    assert radius.mean() == pytest.approx(3 / 4, abs=5 * np.sqrt(3 / 80 / 20000))
    assert radius.var() == pytest.approx(3 / 80, rel=0.04)
    assert way.mean(axis=0) / 0.02 == pytest.approx(np.zeros(3), abs=5 * np.sqrt(1 / 5 / 20000))
    assert np.cov(way.T) / 0.02**2 == pytest.approx(np.eye(3) / 5, abs=5 * np.sqrt(8 / 175 / 20000))
    assert np.mean((way / 0.02) ** 4) == pytest.approx(3 / 35, rel=0.04)  # in all directions
    (part,) = solids.parts
    slope = np.zeros_like(part.vertices)  # of the volume: each triangle adds det(a, b, c) / 6
    for a, b, c in part.triangles.tolist():
        for i, j, k in ((a, b, c), (b, c, a), (c, a, b)):
            slope[i] += np.cross(part.vertices[j], part.vertices[k]) / 6
    share = [float(resurveyed_solids(solids, 1e-3, np.random.default_rng(k)).mass[0] / solids.mass[0]) for k in range(500)]
    assert np.std(share) == pytest.approx(1e-3 / np.sqrt(5) * np.linalg.norm(slope) / 6.0, rel=0.1)


def test_the_middle_of_a_contact_is_its_centre_of_area() -> None:
    """A rectangle of 1 m x 2 m beside a triangle of equal area: ((1/2 + 5/3) / 2, (1 + 2/3) / 2), not the mean of the corners."""
    ring = np.array([(0.0, 0.0), (3.0, 0.0), (1.0, 2.0), (0.0, 2.0)])
    limit = SolidLimit(assemble([Stone("block", [prism(ring, 0.0, 1.0)], 2000.0)]), 0.7)
    assert states_of(limit).middle == pytest.approx(np.array([[13 / 12, 5 / 6, 0.0]]), abs=1e-12)


def test_imperfections_of_a_bonded_corner(tmp_path: Path) -> None:
    """The band of random surveys is narrow, and holds the capacity of the file."""
    (tmp_path / "corner.obj").write_text(obj(corner()))
    keys: dict[str, Any] = {"kind": "imperfections", "direction": 90.0, "deviation": 2e-3, "count": 20}
    found = run({"kind": "blocks", "file": "corner.obj"}, 0.65, tmp_path, **keys)
    r = found.results
    assert found.status == "ok" and r.given_collapse_acceleration_g == pytest.approx(0.3419, abs=1e-4)
    assert r.low_collapse_acceleration_g < r.given_collapse_acceleration_g < r.high_collapse_acceleration_g
    assert r.high_collapse_acceleration_g - r.low_collapse_acceleration_g < 0.03 * r.given_collapse_acceleration_g
    assert r.upper_bounds == 20 and "upper bound" in found.answer
    assert list(found.tables["imperfections"].columns) == ["survey", "along", "opposite"]


def test_a_survey_of_files_of_solids(tmp_path: Path) -> None:
    for k, noise in enumerate((0.0, 3e-4)):
        (tmp_path / f"corner-{k}.obj").write_text(obj(corner(), noise, k))
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    rows = [
        ["name", "file", "contact_tolerance"],
        *([f"corner {k}", f"corner-{k}.obj", "2 mm"] for k in range(2)),
        ["wrong", "open.obj", "2 mm"],
    ]
    with (tmp_path / "folder.csv").open("w", newline="") as file:
        csv.writer(file).writerows(rows)
    found = run({"kind": "blocks", "file": "corner-0.obj"}, 0.65, tmp_path, kind="survey", file="folder.csv", direction=90.0)
    gamma = found.arrays["gamma"].numbers
    assert gamma[0] == pytest.approx(0.4532, abs=5e-5) and gamma[1] == pytest.approx(gamma[0], rel=2e-3) and np.isnan(gamma[2])
    assert found.results.sections == 3 and found.results.standing == 2
    assert found.results.without_answer[0].name == "wrong" and "open.obj" in found.results.without_answer[0].reason


def test_thrust_of_solids_is_drawn(tmp_path: Path) -> None:
    deck = make_deck({"structure": DOME, "analysis": {"kind": "thrust"}})
    made = compute(Context(deck, threads=1))
    made.write(tmp_path / "out")
    assert {p.name for p in (tmp_path / "out" / "figures").glob("*.png")} == {"thrust-forces.png", "thrust-sections.png"}
    assert f"outward, sum over {made.results[0].results.sections[-1].contacts} contacts)" in made.results[0].answer
    words, _ = shown(Run.read(tmp_path / "out"), "thrust")
    assert words["body"]["sort"] == "space"
    assert [row[0] for row in words["tables"][0]["rows"]] == ["x = 0 m", "y = 0 m", "ground"]
