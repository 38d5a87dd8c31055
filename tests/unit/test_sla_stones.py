"""Buildings of stones as finite elements: their meshes, and the load at which they become a mechanism."""

import math
import random

import numpy as np
import pytest

import extrados
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.conclude import assumptions_of
from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.polygons import properties, signed_area
from extrados.results.verdict import SelfWeight
from extrados.views.mesh.mesh import Mesh, element_areas
from extrados.views.mesh.options import MeshOptions
from extrados.views.mesh.triangles import fill_ring

BLOCKS = [
    {"name": "left", "points": [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0]]},
    {"name": "right", "points": [[3.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0]]},
    {"name": "lintel", "points": [[0.2, 3.0], [3.8, 3.0], [3.8, 3.5], [0.2, 3.5]]},
    {"name": "load", "points": [[1.5, 3.5], [2.5, 3.5], [2.0, 4.2]]},
]
STRUCTURES = {
    "arch": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7},
    "pointed-arch": {"kind": "pointed-arch", "span": 6.0, "radius": 6.0, "thickness": 0.5, "voussoirs": 12},
    "elliptical-arch": {"kind": "elliptical-arch", "span": 8.0, "rise": 3.0, "thickness": 0.6, "voussoirs": 12},
    "vault": {"kind": "vault", "preset": "dejong-a"},
    "aisled-vault": {"kind": "aisled-vault", "preset": "vezelay-like"},
    "block": {"kind": "block", "width": 1.0, "height": 4.0},
    "column": {"kind": "column", "width": 1.0, "height": 4.0, "drums": 4, "top_width": 0.8},
    "brickwork": {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 3, "courses": 4},
    "blocks": {"kind": "blocks", "block": BLOCKS},
}


def context(structure: dict, folder=None, joints: dict | None = None, **analysis) -> Context:
    data = {"structure": structure, "analysis": [{"kind": "sla", **analysis}]}
    if joints:
        data["joints"] = joints
    return Context(make_deck(data, folder) if folder else make_deck(data))


def sla(structure: dict, folder=None, joints: dict | None = None, **analysis):
    return run_analyses(context(structure, folder, joints, **analysis))[0]


def tilt(structure: dict, folder=None) -> float:
    data = {"structure": structure, "joints": {"friction": "no-sliding"}, "analysis": {"kind": "tilt"}}
    found = run_analyses(Context(make_deck(data, folder) if folder else make_deck(data)))[0]
    return found.results["collapse_acceleration_g"]


def edges(connect: np.ndarray) -> np.ndarray:
    """Directed sides of elements, each as from and to."""
    return np.concatenate([np.column_stack([c, np.roll(c, -1)]) for c in connect])


def check_mesh(mesh: Mesh, assembly, thickness: float) -> None:
    """Elements turn the right way, meet side to side and nowhere else, fill the stones, and stand along every joint."""
    for group in mesh.groups:
        assert (element_areas(mesh.xy, group.kind, group.connect) > 0.0).all()
    assert len(np.unique(np.concatenate([g.connect.ravel() for g in mesh.groups]))) == len(mesh.xy)
    sides = np.concatenate([edges(g.connect) for g in mesh.groups])
    # No side is used twice the same way round: elements do not overlap where they meet
    assert len(np.unique(sides, axis=0)) == len(sides)

    (rows,) = [g for g in mesh.groups if g.joint is not None]
    assert set(rows.joint.tolist()) == set(range(len(assembly.a)))
    stones = np.concatenate([edges(g.connect) for g in mesh.groups if g.joint is None])
    there = {tuple(side) for side in stones.tolist()}
    ground = set(mesh.ground.tolist())
    for quad, j in zip(rows.connect.tolist(), rows.joint.tolist(), strict=True):
        along = mesh.xy[quad[1]] - mesh.xy[quad[0]]
        assert abs(along @ assembly.tangent[j]) > 0.9 * np.hypot(*along)  # integration points lie along the joint
        for a, b in ((quad[1], quad[0]), (quad[3], quad[2])):  # both long sides lie on a stone, or on the ground
            on_ground = a in ground and b in ground
            assert on_ground or (a, b) in there
            assert not on_ground or GROUND in (assembly.a[j], assembly.b[j])
    length = np.array(
        [np.hypot(*np.diff(mesh.xy[rows.connect[rows.joint == j][:, :2]], axis=1)[:, 0].T).sum() for j in range(len(assembly.a))]
    )
    assert np.abs(length - assembly.length).max() < 12.0 * thickness  # at sharp corners more than at right ones

    area = sum(element_areas(mesh.xy, g.kind, g.connect).sum() for g in mesh.groups)
    stones_area = sum(signed_area(o) for o in assembly.outlines)
    pores = 4.0 * thickness**2 * sum(len(o) + 2 * len(assembly.joints_of(i)) for i, o in enumerate(assembly.outlines))
    # Arcs are drawn by chords of the elements
    assert abs(area - stones_area) < pores + 0.003 * stones_area

    total, fill = assembly.mass.sum(), 0.0 if assembly.fill is None else assembly.fill[:, 0].sum()
    assert mesh.mass.sum() == pytest.approx(total + fill, rel=1e-12)
    moment = assembly.mass @ assembly.centroid
    if assembly.fill is not None:
        moment = moment + assembly.fill[:, 0] @ assembly.fill[:, 1:]
    assert mesh.mass @ mesh.xy == pytest.approx(moment, rel=1e-9, abs=1e-9 * total * assembly.size)


def check_interfaces(mesh: Mesh, assembly) -> None:
    """Pairs of nodes at one place along every joint, which stand for all of its area; stones that fill their outlines."""
    (joints,) = [g for g in mesh.groups if g.joint is not None]
    stones = [g for g in mesh.groups if g.joint is None]
    below, above = joints.connect[:, :2], joints.connect[:, :1:-1]
    assert np.abs(mesh.xy[below] - mesh.xy[above]).max() < 1e-9 * assembly.size
    assert (below != above).all()
    area = np.bincount(joints.joint, joints.law.area.sum(axis=1))
    assert area == pytest.approx(assembly.length * assembly.depth, rel=1e-6)
    assert (joints.law.normal == assembly.normal[joints.joint]).all()
    sides = {tuple(side) for side in np.concatenate([edges(g.connect) for g in stones]).tolist()}
    ground = set(mesh.ground.tolist())
    for a, b in (*below.tolist(), *above.tolist()):
        assert (a, b) in sides or (b, a) in sides or (a in ground and b in ground)
    filled = sum(element_areas(mesh.xy, g.kind, g.connect).sum() for g in stones)
    assert filled == pytest.approx(sum(signed_area(o) for o in assembly.outlines), rel=3e-3)


@pytest.mark.parametrize("element", ["Q4", "T3"])
@pytest.mark.parametrize("kind", STRUCTURES)
def test_the_mesh_of_every_kind(kind: str, element: str) -> None:
    building = context(STRUCTURES[kind]).building
    mesh = building.mesh(MeshOptions(element=element, joints="rows"))
    (rows,) = [g for g in mesh.groups if g.joint is not None]
    check_mesh(mesh, building.blocks(), rows.band)
    check_interfaces(building.mesh(MeshOptions(element=element)), building.blocks())
    if element == "T3":
        assert {g.kind for g in mesh.groups if g.joint is None} == {"T3"}


def random_wall(seed: int) -> list[list[tuple[float, float]]]:
    """Courses of stones of random lengths between level beds, their heads askew; some stones cut into two triangles."""
    rng = random.Random(seed)
    found, low = [], 0.0
    for _ in range(4):
        high = low + rng.uniform(0.3, 0.8)
        cuts = sorted(rng.uniform(0.4, 3.6) for _ in range(rng.randint(1, 4)))
        cuts = [c for k, c in enumerate(cuts) if k == 0 or c - cuts[k - 1] > 0.4]
        feet = [0.0, *cuts, 4.0]
        heads = [0.0, *(c + rng.uniform(-0.15, 0.15) for c in cuts), 4.0]
        for k in range(len(feet) - 1):
            quad = [(feet[k], low), (feet[k + 1], low), (heads[k + 1], high), (heads[k], high)]
            found += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] if rng.random() < 0.3 else [quad]
        low = high
    return found


@pytest.mark.parametrize("seed", range(12))
def test_the_mesh_of_random_drawings(tmp_path, seed: int) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new(units=6)
    for ring in random_wall(seed):
        drawing.modelspace().add_lwpolyline(ring, close=True)
    drawing.saveas(tmp_path / "wall.dxf")
    building = context({"kind": "blocks", "file": "wall.dxf"}, tmp_path).building
    mesh = building.mesh(MeshOptions(joints="rows"))
    (rows,) = [g for g in mesh.groups if g.joint is not None]
    check_mesh(mesh, building.blocks(), rows.band)
    check_interfaces(building.mesh(), building.blocks())


@pytest.mark.parametrize("seed", range(20))
def test_triangles_keep_the_ring(seed: int) -> None:
    """Star-shaped rings with edges far longer than the elements, which Delaunay alone would cut."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0.0, 2.0 * math.pi, 40))
    reach = rng.uniform(0.15, 1.0, 40)
    ring = np.column_stack([reach * np.cos(angle), reach * np.sin(angle)])
    xy, triangles = fill_ring(ring, 0.2)
    area = element_areas(xy, "T3", triangles)
    assert (area > 0.0).all()
    assert area.sum() == pytest.approx(properties(ring)[0], rel=1e-9)
    there = {tuple(side) for side in edges(triangles).tolist()}
    assert all((k, (k + 1) % len(ring)) in there for k in range(len(ring)))


@pytest.mark.parametrize("kind", STRUCTURES)
def test_stones_become_a_mechanism_where_limit_analysis_says(kind: str) -> None:
    """Hinges form at the ends of joints of no thickness, where limit analysis has them."""
    found = sla(STRUCTURES[kind], joints={"friction": "no-sliding"})
    assert not found.reason
    assert found.results["peak_acceleration_g"] == pytest.approx(tilt(STRUCTURES[kind]), rel=1e-5)
    assert found.results["energy_residual_ratio"] < 1e-4
    assert "do not slide" in found.answer


def test_rows_of_elements_converge_from_below() -> None:
    """There hinges form at the outermost integration point of a row, a little inside the end of the joint."""
    peaks = [sla(STRUCTURES["arch"], mesh={"size": 1.5 / n, "joints": "rows"}).results["peak_acceleration_g"] for n in (4, 6, 8, 12)]
    exact = tilt(STRUCTURES["arch"])
    lacking = 1.0 - np.array(peaks) / exact
    assert (lacking > 0.0).all() and (np.diff(lacking) < 0.0).all()
    assert lacking[-1] < 0.005


def test_both_ways_of_solving_agree() -> None:
    peaks = [sla(STRUCTURES["blocks"], algorithm=a).results["peak_acceleration_g"] for a in ("update", "refactor")]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-4)


def test_hinges_are_those_of_the_mechanism() -> None:
    found = sla(STRUCTURES["arch"], directions=["+", "-"])
    assert found.results["hinges"] == ["joint 0", "joint 3", "joint 5", "joint 7"]
    assert found.results["minus"]["peak_load_N"] == pytest.approx(found.results["peak_load_N"], rel=1e-6)
    table = found.tables["joints"].columns
    assert len(table["joint"]) == 8 and (np.asarray(table["open_part"]) <= 1.0).all()


def test_mortar_adds_strength_and_is_lost() -> None:
    """With mortar the peak lies above that of dry joints; once it is torn, the load is that of dry joints."""
    dry = sla(STRUCTURES["arch"]).results["peak_acceleration_g"]
    joints = {"tension": 3e5, "fracture_energy": 30.0}
    strong = sla(STRUCTURES["arch"], joints=joints, ripple=0.3)
    assert strong.results["peak_acceleration_g"] > 1.2 * dry
    weak = sla(STRUCTURES["arch"], joints={"tension": 1e3, "fracture_energy": 1.0}, ripple=0.3)
    assert weak.results["peak_acceleration_g"] == pytest.approx(dry, rel=0.005)


def test_the_row_carries_the_stiffness_of_the_joint() -> None:
    """A block pressed down by its weight sinks by the mean pressure over the stiffness, in series with the ground."""
    structure = {"kind": "block", "width": 2.0, "height": 1.0}
    data = {
        "structure": structure,
        "material": {"young": 1e13},
        "joints": {"normal_stiffness": 2e8},
        "supports": {"stiffness": 6e8},
        "analysis": {"kind": "sla", "control": [{"edge": "top", "direction": "y"}]},
    }
    found = run_analyses(Context(make_deck(data)))[0]
    pressure = 2000.0 * 9.80665 * 1.0
    assert found.results["displacement_of_constant_loads_m"] == pytest.approx(-pressure / 1.5e8, rel=1e-3)


def test_what_does_not_fit_is_refused() -> None:
    assert "no `fracture_energy`" in sla(STRUCTURES["arch"], joints={"tension": 1e5}).reason
    assert "isotropic" in sla(STRUCTURES["arch"], cracking="isotropic").reason
    assert "crack_closure" in sla(STRUCTURES["arch"], crack_closure=False).reason
    assert "joint_thickness" in sla(STRUCTURES["arch"], mesh={"joint_thickness": 0.5}).reason
    panel = {"kind": "panel", "width": 1.0, "height": 1.0, "thickness": 0.2}
    assert "no joints" in sla(panel, mesh={"joint_thickness": 0.01}).reason
    with pytest.raises(BadGeometry, match="Q4"):
        context(STRUCTURES["arch"]).building.mesh(MeshOptions(element="Q8"))


def test_an_arch_too_thin_for_its_weight_cannot_stand() -> None:
    """Elements lead to a mechanism, of which limit analysis of the same blocks holds a certificate."""
    found = sla({**STRUCTURES["arch"], "thickness": 0.5, "voussoirs": 20})
    assert found.status == "ok" and isinstance(found.results, SelfWeight) and "certificate" in found.results.certificate
    assert found.results.judged(Demanded(0.1)).outcome == "cannot-stand"


#: The least t/R of a dry semicircle of 40 voussoirs by limit analysis: .10746
SEMICIRCLE = {"kind": "arch", "radius": 10.0, "embrace": 180, "voussoirs": 40}


@pytest.mark.parametrize("friction", [0.7, "no-sliding"])
@pytest.mark.parametrize("thickness", [1.03, 1.05, 1.07, 1.0745])
def test_a_semicircle_below_the_least_thickness_cannot_stand(thickness: float, friction: float | str) -> None:
    """The work of the weight hardly grows as it becomes a mechanism: its displacements tell."""
    found = sla({**SEMICIRCLE, "thickness": thickness}, joints={"friction": friction})
    assert isinstance(found.results, SelfWeight) and found.results.judged(Demanded(None)).outcome == "cannot-stand"


@pytest.mark.parametrize("thickness", [1.0755, 1.08, 1.1, 1.3])
def test_a_semicircle_above_the_least_thickness_carries_what_limit_analysis_says(thickness: float) -> None:
    """The load that a mechanism reaches within small displacements; what it would reach at kilometres is no state."""
    structure = {**SEMICIRCLE, "thickness": thickness}
    found = sla(structure, joints={"friction": "no-sliding"})
    r = found.results
    assert r["peak_acceleration_g"] == pytest.approx(tilt(structure), rel=2e-3)
    assert abs(r["peak_displacement_m"] - r["displacement_of_constant_loads_m"]) < 0.1 * 2.0 * (10.0 + 0.5 * thickness)
    state = found["event_state"] == 1
    assert np.abs(found["event_displacement"][state]).max() < 0.1 * 2.0 * (10.0 + 0.5 * thickness)
    assert r["stop"] == "mechanism" and r["stones"]


def test_without_a_certificate_what_is_not_carried_is_open(monkeypatch) -> None:
    """Limit analysis finds equilibrium: elements prove no collapse."""
    monkeypatch.setattr("extrados.analyses.sla.driver.LimitAnalysis.stands", lambda self: True)
    found = sla({**SEMICIRCLE, "thickness": 1.05})
    assert (found.status, found.verdict.outcome, found.results.proven) == ("ok", "open", False)
    assert "cannot carry the constant loads" in found.verdict.statement and "1/10" in found.verdict.statement


def test_own_constant_loads_are_certified_as_limit_analysis_certifies_them() -> None:
    """A load on the crown of a sound semicircle proves collapse in tilt and in sla alike; a lesser one in neither."""
    arch = {**SEMICIRCLE, "thickness": 1.5, "voussoirs": 20}
    assert sla({**SEMICIRCLE, "thickness": 1.05}, constant=[{"kind": "gravity"}])["collapse_acceleration_g"] == 0.0
    for force, falls in ((4e5, True), (4e3, False)):
        crown = [{"kind": "gravity"}, {"kind": "point", "x": 0.0, "y": 10.75, "fy": -force}]
        found = sla(arch, constant=crown, reference=[{"kind": "gravity", "ax": "1 g", "ay": "0 g"}], events=3)
        deck = {"structure": arch, "analysis": [{"kind": "tilt", "load": [{"x": 0.0, "force": force}]}]}
        (by_limit,) = extrados.run(deck).results
        assert isinstance(found.results, SelfWeight) is isinstance(by_limit.results, SelfWeight) is falls


def test_only_rows_assume_that_nothing_slides() -> None:
    for joints, expected in (("rows", ("no-sliding", "method")), ("interfaces", (0.7, "default"))):
        data = {"structure": STRUCTURES["block"], "analysis": [{"kind": "sla", "mesh": {"joints": joints}}]}
        table = make_deck(data)
        told = assumptions_of(table.analyses[0], table.building, table.building)["joints.friction"]
        assert (told.value, told.origin) == expected
    wall = make_deck({"structure": {"kind": "panel", "width": 1.0, "height": 1.0, "thickness": 0.1}, "analysis": [{"kind": "sla"}]})
    assert "joints.friction" not in assumptions_of(wall.analyses[0], wall.building, wall.building)


def test_a_wall_takes_the_default_loads() -> None:
    """Gravity, and all masses times 1 g to +x: the first tooth of a slender cantilever wall by beam theory."""
    data = {
        "structure": {"kind": "panel", "width": 0.5, "height": 5.0, "thickness": 0.3},
        "material": {"density": 2000.0, "tensile_strength": 2e5, "fracture_energy": 100.0},
        "analysis": {"kind": "sla", "events": 3, "mesh": {"size": 0.05}},
    }
    found = run_analyses(Context(make_deck(data)))[0]
    weight = 2000.0 * 9.80665 * 5.0
    beam = (2e5 + weight) / (2000.0 * 9.80665 * 3.0 * 5.0**2 / 0.5)
    assert found.results["first_event_load_N"] / found.results["reference_load_N"] == pytest.approx(beam, rel=0.1)
    assert "peak_acceleration_g" in found.results
