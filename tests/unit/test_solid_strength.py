"""Strength of the contacts of solids in limit analysis: crushing, cohesion and tension against the plane, closed forms and other programmes."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, linprog
from test_noisy_solids import corner
from test_solid_limit import PLANE

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.crushing import CrushingLimit
from extrados.limit.mortar import mortared
from extrados.limit.solids import Programme, SolidLimit
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import box
from extrados.model.structures.dome import make_dome
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY

BLOCK = {"kind": "block", "width": 0.8, "height": 2.0, "depth": 0.5}
AREA, WEIGHT = 0.8 * 0.5, 0.8 * 0.5 * 2.0 * 2000.0 * GRAVITY


def run(structure: dict[str, Any], joints: dict[str, Any], material: dict[str, Any] | None = None, **keys: Any) -> Result:
    tables = {"structure": structure, "joints": joints, "material": {"density": 2000.0, **(material or {})}}
    (result,) = run_analyses(Context(make_deck({**tables, "analysis": {"kind": "tilt", **keys}}), threads=1))
    return result


def solids_of(structure: dict[str, Any]) -> SolidAssembly:
    return make_deck({"structure": structure, "material": {"density": 2000.0}, "analysis": {"kind": "tilt"}}).building.solids()


def crushed(solids: SolidAssembly, friction: float | None, strength: float, direction: float) -> Programme:
    found = CrushingLimit(solids, friction, np.full(len(solids.a), strength)).push(direction)
    assert isinstance(found, Programme)
    return found


@pytest.mark.parametrize(
    ("name", "strength"), [("arch", 1e6), ("arch", 3e6), ("vault", 1e6), ("wall", 1e5), ("frame", 3e5), ("column", 3e5)]
)
@pytest.mark.parametrize("friction", [0.65, "no-sliding"])
def test_extruded_sections_crush_as_in_the_plane(name: str, strength: float, friction: Any) -> None:
    plane, space = (
        run(PLANE[name], {"friction": friction}, {"compressive_strength": strength}, **keys).results
        for keys in ({}, {"direction": 0.0, "rose": 4, "starts": 1, "face_law": False})
    )
    assert space.collapse_acceleration_g == pytest.approx(plane.collapse_acceleration_g, abs=1e-6)
    assert space.collapse_acceleration_opposite_g == pytest.approx(plane.collapse_acceleration_opposite_g, abs=1e-6)
    assert space.duality_gap < 1e-6 and space.crushing_contacts > 0


def pressed_centre(polygon: np.ndarray, area: float, angle: float) -> np.ndarray:
    """Centre of the part of a polygon (k, 2) beyond a straight line across an angle [rad] that has a given area."""
    way = np.array([np.cos(angle), np.sin(angle)])

    def part(level: float) -> np.ndarray:
        points = []
        for p, q in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            a, b = p @ way - level, q @ way - level
            if a >= 0.0:
                points.append(p)
            if a * b < 0.0:
                points.append(p + (q - p) * a / (a - b))
        return np.array(points)

    def moments(points: np.ndarray) -> tuple[float, np.ndarray]:
        x, y = points.reshape(-1, 2).T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        whole = 0.5 * float(cross.sum())
        weighted = (points.reshape(-1, 2) + np.roll(points.reshape(-1, 2), -1, axis=0)) * cross[:, None]
        return whole, weighted.sum(axis=0) / (6.0 * max(whole, 1e-300))

    reach = polygon @ way
    level = brentq(lambda at: moments(part(at))[0] - area, reach.min(), reach.max(), xtol=1e-14)
    return moments(part(level))[1]


@pytest.mark.parametrize("sides", [3, 5, 7, 20])
def test_a_prism_crushes_on_the_segment_that_its_weight_needs(sides: int) -> None:
    """The pressed part lies beyond a straight line; its centre is where the resultant of weight and push meets the base."""
    solids = solids_of({"kind": "column", "width": 1.0, "height": 4.0, "drums": 1, "section": "round", "sides": sides})
    polygon = solids.polygon[0][:, :2] - solids.centroid[0, :2]
    if solids.normal[0, 2] < 0.0:
        polygon = polygon[::-1]
    weight, height = float(solids.mass[0]) * GRAVITY, float(solids.centroid[0, 2])
    for strength in (8.0, 3.0, 1.5):  # over the mean pressure
        for direction in (0.0, 11.0, 45.0):
            turn = np.radians(direction)
            cross = np.array([-np.sin(turn), np.cos(turn)])
            area = float(solids.area[0]) / strength
            angle = brentq(lambda at: pressed_centre(polygon, area, at) @ cross, turn - 1.2, turn + 1.2)  # noqa: B023
            want = float(pressed_centre(polygon, area, angle) @ [np.cos(turn), np.sin(turn)]) / height
            found = crushed(solids, None, strength * weight / float(solids.area[0]), direction)
            assert found.gamma <= want + 1e-8 and want <= found.upper + 1e-8
            assert found.upper - found.gamma < 0.012 * want


def test_strength_of_contacts_orders_capacities_of_a_corner_and_a_dome() -> None:
    """Oblique pushes of bonded blocks: never above dry blocks that do not crush, and more with more strength."""
    for solids, friction, weak, direction in (
        (assemble(corner()), 0.65, 2e5, 30.0),
        (assemble(corner()), 0.4, 2e5, 90.0),
        (make_dome(10.0, 1.0, 180.0, 6, 8), 0.7, 2e6, 0.0),
    ):
        dry = SolidLimit(solids, friction).push(direction)
        assert isinstance(dry, Programme)
        found = [
            crushed(solids, friction, weak * factor, direction) for factor in (1.0, 5.0, 1e5)
        ]  # the last beyond the patches that the solver can tell
        gammas = [one.gamma for one in found]
        assert gammas[0] < gammas[1] < gammas[2] <= dry.gamma + 1e-7
        assert gammas[2] == pytest.approx(dry.gamma, rel=5e-3)
        assert max(one.upper - one.gamma for one in found) < 0.03 * dry.gamma
        assert max(max(one.equilibrium, one.cone) for one in found) < 1e-8


def test_blocks_too_weak_for_their_weight_cannot_stand() -> None:
    """A column stands where its strength exceeds the pressure at its foot."""
    column = {"kind": "column", "width": 0.8, "height": 4.0, "drums": 4}
    pressure = 2000.0 * GRAVITY * 4.0
    keys = {"direction": 0.0, "rose": 4}
    weak, strong = (run(column, {"friction": 0.7}, {"compressive_strength": f * pressure}, **keys) for f in (0.99, 1.01))
    assert weak.verdict.outcome == "cannot-stand" and strong.results.collapse_acceleration_g < 0.01
    limit = CrushingLimit(solids_of(column), 0.7, np.full(4, 0.99 * pressure))
    falls = limit.falls()
    assert falls is not None and falls.power > 0.0
    assert CrushingLimit(solids_of(column), 0.7, np.full(4, 1.01 * pressure)).falls() is None


@pytest.mark.parametrize(("friction", "cohesion", "tension"), [(0.3, 5e3, 2e3), (0.7, 5e3, 2e4), (0.7, 5e4, 2e4), (0.0, 3e3, 9e3)])
@pytest.mark.parametrize("direction", [0.0, 37.0])
def test_a_glued_block_slides_or_turns_by_hand(friction: float, cohesion: float, tension: float, direction: float) -> None:
    """Sliding at mu + c A / W, turning about an edge where the tension of the whole base pulls at its middle."""
    found = run(
        BLOCK,
        {"friction": friction, "cohesion": cohesion, "tension": tension},
        direction=direction,
        mortar="ductile",
        rose=4,
        face_law=False,
    )
    borne = min(tension, cohesion / friction) if friction else tension
    slides = friction + cohesion * AREA / WEIGHT
    across, along = abs(np.cos(np.radians(direction))), abs(np.sin(np.radians(direction)))
    arm = min(0.4 / across if across > 1e-9 else np.inf, 0.25 / along if along > 1e-9 else np.inf)
    turns = arm * (1.0 + borne * AREA / WEIGHT)
    assert found.results.collapse_acceleration_g == pytest.approx(min(slides, turns), abs=1e-7)
    assert found.results.collapse_acceleration_dry_g == pytest.approx(min(friction, arm), abs=1e-7)
    assert found.verdict.bound == "upper"
    assert any("less tension" in text for text in found.warnings) == (borne < tension)


@pytest.mark.parametrize("strength", [None, 2e5])
def test_a_bonded_lintel_by_hand(strength: float | None) -> None:
    """Two blocks glued end to end over an opening, on bearings without friction: the moment at the middle of the span."""
    clear, bearing, depth, height, bond = 1.2, 0.2, 0.3, 0.25, 4e4
    half = 0.5 * clear + bearing
    stones = [Stone(f"half {k}", [box((x, 0.0, 1.0), (x + half, depth, 1.0 + height))], 2000.0) for k, x in enumerate((-half, 0.0))]
    for k, x in enumerate((-half, 0.5 * clear)):
        stones.append(Stone(f"bearing {k}", [box((x, 0.0, 0.0), (x + bearing, depth, 1.0))], 2000.0, ground=True))
    solids = assemble(stones)
    glued = np.abs(solids.normal[:, 0]) > 0.5
    friction = np.where(glued, 0.7, 0.0)
    bonded, tension = mortared(solids, friction, np.where(glued, 1e5, 0.0), np.where(glued, bond, 0.0))
    if strength is None:
        limit = SolidLimit(bonded, friction, tension=tension)
    else:
        limit = CrushingLimit(bonded, friction, np.where(glued, strength, np.inf), tension=tension)
    down = limit.loads(np.array([0.0, 0.0, -1.0]))
    found = limit.most(limit.at_rest - down, down)
    assert isinstance(found, Programme)
    weight = 2.0 * half * depth * height * 2000.0 * GRAVITY
    needed = 0.5 * weight * (0.5 * clear - 0.5 * half)
    pressed = 0.0 if strength is None else height * bond / (bond + strength)
    resisted = bond * depth * (height - pressed) * 0.5 * height
    assert found.gamma == pytest.approx(resisted / needed, rel=1e-6)
    assert found.force[np.flatnonzero(glued)[0] == bonded.corner_joint, 0].sum() == pytest.approx(0.0, abs=1e-5 * weight)


def plane_mortar(one: Assembly, friction: float, cohesion: float, tension: float) -> float:
    """Greatest push of a section with mortar: corner forces by a linear programme of its own."""
    joints, area = len(one.a), one.length * one.depth
    columns = np.zeros((3 * len(one.mass), 3 * joints + 1))
    for j in range(joints):
        for k, (place, way) in enumerate(((one.p[j], one.normal[j]), (one.q[j], one.normal[j]), (one.p[j], one.tangent[j]))):
            for block, sense in ((one.a[j], 1.0), (one.b[j], -1.0)):
                if block != GROUND:
                    moment = place[0] * way[1] - place[1] * way[0]
                    columns[3 * block : 3 * block + 3, 3 * j + k] += sense * np.array([way[0], way[1], moment])
    weight = one.mass * GRAVITY
    columns[:, -1] = np.column_stack([weight, 0 * weight, -weight * one.centroid[:, 1]]).ravel()
    dead = np.column_stack([0 * weight, -weight, -weight * one.centroid[:, 0]]).ravel()
    limits, right = [], []
    for j in range(joints):
        for sense in (1.0, -1.0):
            row = np.zeros(3 * joints + 1)
            row[3 * j : 3 * j + 3] = [-friction, -friction, sense]
            limits.append(row)
            right.append(cohesion * area[j])
    bounds = [b for a in area for b in ((-0.5 * tension * a, None), (-0.5 * tension * a, None), (None, None))] + [(None, None)]
    cost = np.append(np.zeros(3 * joints), -1.0)
    unit = float(weight.sum())  # forces of the order of one
    bounds = [tuple(None if side is None else side / unit for side in pair) for pair in bounds]
    columns[:, -1] /= unit
    found = linprog(
        cost, A_ub=np.array(limits), b_ub=np.array(right) / unit, A_eq=columns, b_eq=-dead / unit, bounds=bounds, method="highs"
    )
    assert found.status == 0
    return -float(found.fun)


@pytest.mark.parametrize("name", ["arch", "wall", "column"])
@pytest.mark.parametrize(("friction", "cohesion", "tension"), [(0.65, 2e4, 5e3), (0.3, 6e3, 2e4)])
def test_extruded_sections_with_mortar_as_in_the_plane(name: str, friction: float, cohesion: float, tension: float) -> None:
    keys = {"direction": 0.0, "rose": 4, "mortar": "ductile", "face_law": False}
    found = run(PLANE[name], {"friction": friction, "cohesion": cohesion, "tension": tension}, **keys).results
    section = make_deck({"structure": PLANE[name], "material": {"density": 2000.0}, "analysis": {"kind": "tilt"}}).building.blocks()
    want = plane_mortar(section, friction, cohesion, min(tension, cohesion / friction))
    assert found.collapse_acceleration_g == pytest.approx(want, rel=1e-6)
    assert found.collapse_acceleration_dry_g < found.collapse_acceleration_g


def test_cohesion_of_a_face_bears_no_more_torsion_than_an_even_shear() -> None:
    """Of a square: 92 % of .3826 a c A, of the half and the quarter distances of four parts."""
    solids = assemble([Stone("block", [box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))], 2000.0)])
    bonded, tension = mortared(solids, 0.0, np.array([1e4]), np.zeros(1))
    limit = SolidLimit(bonded, 0.0, tension=tension)
    twist = np.zeros(6)
    twist[5] = 1.0  # over the scale and the size, which is 1 m
    found = limit.most(limit.at_rest, twist)
    assert isinstance(found, Programme)
    even = 1e4 * 0.382598 / limit.scale
    assert 0.9 * even < found.gamma <= even
    assert found.gamma == pytest.approx(1e4 * np.sqrt(0.125) / limit.scale, rel=1e-7)


def test_what_strength_excludes_is_refused_by_name() -> None:
    arch = PLANE["arch"]
    assert "mortar" in run(arch, {"friction": 0.7, "cohesion": 1e4}, mortar="ductile").reason
    crush = {"compressive_strength": 3e6}
    assert "without dilatancy" in run(arch, {"friction": 0.7}, crush, direction=0.0, friction_rule="non-associated").reason
    assert "pyramids" in run(arch, {"friction": 0.7}, crush, direction=0.0, pyramids=8).reason
    assert "crushing" in run(arch, {"friction": 0.7}, crush, direction=0.0, kind="thrust").reason


def test_solids_are_swept_over_their_strength() -> None:
    keys = {"kind": "sweep", "direction": 0.0, "vary": "material.compressive_strength", "values": [1e6, 3e6], "locate": False}
    swept = run(PLANE["arch"], {"friction": 0.7}, {"compressive_strength": 2e6}, **keys)
    plane = [run(PLANE["arch"], {"friction": 0.7}, {"compressive_strength": f}).results.collapse_acceleration_g for f in (1e6, 3e6)]
    assert np.array(swept.arrays["gamma"].data) == pytest.approx(plane, abs=1e-6)
