"""Solids: mass properties, contacts, kinds, files, and the words for what is amiss."""

import json
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from extrados import kinds
from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.solids.assembly import SolidAssembly, Stone, assemble, mass_properties
from extrados.model.geometry.solids.contacts import touching
from extrados.model.geometry.solids.polyhedra import Polyhedron, box, cut, hull, moments, overlap_depth, prism
from extrados.model.structures.cross_vault import LEAST_PIECE
from extrados.running.check import check_building, write_solids
from extrados.schema.constants import IN_SPACE
from extrados.views.building import Building

CUBE = box((0, 0, 0), (1, 1, 1))


def building(structure: dict[str, Any], folder: Path | None = None) -> Building:
    return make_deck({"structure": structure, "analysis": {"kind": "tilt"}}, folder).building


def polygon(sides: int, radius: float) -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(sides) / sides
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def test_mass_of_a_box_and_a_tetrahedron() -> None:
    mass, centre, inertia = mass_properties([box((1, 2, 3), (1.4, 3.0, 6.0))], 1000.0)
    assert mass == pytest.approx(1200.0, rel=1e-14)
    assert centre == pytest.approx([1.2, 2.5, 4.5], rel=1e-14)
    assert np.diag(inertia) == pytest.approx([1000.0, 1200.0 * (0.16 + 9.0) / 12, 1200.0 * 1.16 / 12], rel=1e-13)
    assert inertia - np.diag(np.diag(inertia)) == pytest.approx(np.zeros((3, 3)), abs=1e-9)
    corner = hull(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]))
    volume, centre, second = moments(corner.vertices, corner.triangles)
    assert volume == pytest.approx(1 / 6, rel=1e-14)
    assert centre == pytest.approx([0.25] * 3, rel=1e-14)
    # integrals of x^2 and x y over the corner are 1/60 and 1/120
    exact = np.full((3, 3), 1 / 120) + np.eye(3) / 120 - 1 / 96
    assert second == pytest.approx(exact, rel=1e-12)


def test_a_cylinder_of_many_facets_and_a_turned_body() -> None:
    sides, radius, height = 400, 0.5, 2.0
    mass, _, inertia = mass_properties([prism(polygon(sides, radius), 0.0, height)], 1.0)
    area = 0.5 * sides * radius**2 * np.sin(2 * np.pi / sides)  # a regular polygon, its polar moment in closed form
    polar = area * radius**2 * (2.0 + np.cos(2 * np.pi / sides)) / 6.0
    assert mass == pytest.approx(area * height, rel=1e-12)
    assert inertia[2, 2] == pytest.approx(polar * height, rel=1e-12)
    assert inertia[0, 0] == pytest.approx(0.5 * polar * height + mass * height**2 / 12, rel=1e-12)
    turn = Rotation.from_rotvec([0.3, -0.7, 1.1]).as_matrix()
    _, _, turned = mass_properties([prism(polygon(sides, radius), 0.0, height).moved(turn, np.array([3.0, 1, 2]))], 1.0)
    assert turned == pytest.approx(turn @ inertia @ turn.T, rel=1e-10, abs=1e-12)


def test_cutting_keeps_the_volume_and_mirrors_keep_the_faces_outside() -> None:
    body = hull(np.random.default_rng(3).normal(size=(20, 3)))
    whole = moments(body.vertices, body.triangles)[0]
    for normal in np.random.default_rng(4).normal(size=(5, 3)):
        two = [cut(body, np.array([0.1, 0.0, -0.1]), s * normal) for s in (1, -1)]
        assert sum(moments(p.vertices, p.triangles)[0] for p in two if p) == pytest.approx(whole, rel=1e-12)
    mirrored = body.moved(np.diag([-1.0, 1.0, 1.0]))
    assert moments(mirrored.vertices, mirrored.triangles)[0] == pytest.approx(whole, rel=1e-12)
    assert cut(CUBE, np.array([0, 0, 2.0]), np.array([0, 0, 1.0])) is None


def test_two_cubes_turned_on_each_other_share_an_octagon() -> None:
    turn = Rotation.from_rotvec([0, 0, np.pi / 4]).as_matrix()
    upper = box((-0.5, -0.5, 1.0), (0.5, 0.5, 2.0)).moved(turn)
    made = assemble([Stone("lower", [box((-0.5, -0.5, 0), (0.5, 0.5, 1))], 1.0), Stone("upper", [upper], 1.0)])
    assert made.joint_names == ["upper on lower", "lower on the ground"]
    assert len(made.polygon[0]) == 8
    assert made.area == pytest.approx([2.0 * (np.sqrt(2.0) - 1.0), 1.0], rel=1e-12)  # a regular octagon of inradius 1/2
    assert made.normal[0] == pytest.approx([0, 0, -1.0 if made.a[0] == 0 else 1.0])


@pytest.mark.parametrize("seed", range(4))
def test_contacts_turn_with_the_stones(seed: int) -> None:
    wall = building(
        {
            "kind": "wall",
            "unit_length": 0.4,
            "unit_height": 0.2,
            "thickness": 0.2,
            "height": 1.0,
            "legs": [{"length": 1.6}, {"length": 1.0}],
        }
    ).solids()
    rng = np.random.default_rng(seed)
    turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    shift = rng.normal(size=3) * 3.0
    parts = [p.moved(turn, shift) for p in wall.parts]
    found = touching(parts, wall.owner, 1e-6, 1e-5)
    stones = wall.b >= 0
    assert not found.overlaps
    pairs = {(a, b): (sum_area(p, n), n) for a, b, p, n in zip(found.a, found.b, found.polygon, found.normal, strict=True)}
    known = dict(
        zip(zip(wall.a[stones], wall.b[stones], strict=True), zip(wall.area[stones], wall.normal[stones], strict=True), strict=True)
    )
    assert set(pairs) == set(known)
    for pair, (area, normal) in known.items():
        assert pairs[pair][0] == pytest.approx(area, rel=1e-9)
        assert pairs[pair][1] == pytest.approx(turn @ normal, abs=1e-9)


def sum_area(points: np.ndarray, normal: np.ndarray) -> float:
    arm = points - points[0]
    return 0.5 * float(np.cross(arm[:-1], arm[1:]).sum(axis=0) @ normal)


def test_separating_axes_between_edges() -> None:
    """Two bars that cross above each other, edge over edge: no face separates them."""
    bar = prism(np.array([[0, -0.1], [0.1, 0], [0, 0.1], [-0.1, 0]]), -1, 1)
    along = bar.moved(Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix())
    across = bar.moved(Rotation.from_rotvec([np.pi / 2, 0, 0]).as_matrix(), np.array([0, 0, 0.21]))
    assert overlap_depth(along, across) == pytest.approx(-0.01, abs=1e-12)
    assert overlap_depth(along, across.moved(np.eye(3), np.array([0, 0, -0.03]))) == pytest.approx(0.02, abs=1e-12)


SOLIDS: dict[str, dict[str, Any]] = {
    "dome": {"kind": "dome", "radius": 5, "thickness": 0.5, "rings": 6, "lunes": 12},
    "dome in bond": {"kind": "dome", "radius": 5, "thickness": 0.5, "rings": 5, "lunes": 8, "bond": "running", "oculus": 20},
    "flat dome": {"kind": "dome", "radius": 5, "thickness": 0.5, "rings": 4, "lunes": 8, "embrace": 90},
    "cross-vault": {"kind": "cross-vault", "radius": 3, "thickness": 0.4, "embrace": 140, "voussoirs": 8, "stone_length": 0.8},
    "oblong vault": {"kind": "cross-vault", "radius": 3, "thickness": 0.4, "embrace": 150, "voussoirs": 8, "springers": 0, "oblong": 1.5},
    "barrel": {"kind": "arch", "radius": 3, "thickness": 0.5, "embrace": 150, "voussoirs": 9, "depth": 2, "stones_across": 3},
    "skew barrel": {
        "kind": "arch",
        "radius": 3,
        "thickness": 0.5,
        "embrace": 150,
        "voussoirs": 9,
        "depth": 2,
        "stones_across": 2,
        "skew": 25,
    },
    "round column": {"kind": "column", "width": 1, "top_width": 0.8, "height": 5, "drums": 4, "section": "round"},
    "fluted column": {"kind": "column", "width": 1, "height": 5, "drums": 3, "section": "round", "sides": 20, "flute_depth": 0.04},
    "room": {
        "kind": "wall",
        "unit_length": 0.4,
        "unit_height": 0.2,
        "thickness": 0.2,
        "height": 1.6,
        "closed": True,
        "legs": [{"length": 2.4, "openings": [{"x": [0.8, 1.4], "y": [0, 1.2]}]}, {"length": 2}, {"length": 2.4}, {"length": 2}],
    },
    "bent wall": {
        "kind": "wall",
        "unit_length": 0.5,
        "unit_height": 0.25,
        "thickness": 0.2,
        "height": 1,
        "legs": [{"length": 2}, {"length": 1.5, "turn": "right"}, {"length": 2, "turn": "left"}],
    },
}


@pytest.mark.parametrize("name", SOLIDS)
def test_a_kind_is_a_sound_assembly(name: str) -> None:
    """Normals point into the first stone, polygons turn about them, every stone is held, masses are those of the parts."""
    made = building(SOLIDS[name]).solids()
    assert not made.remarks
    assert (made.area > 0.0).all()
    for points, normal, a, b in zip(made.polygon, made.normal, made.a, made.b, strict=True):
        assert np.abs((points - points[0]) @ normal).max() < 1e-7
        for block, sense in ((a, 1.0), (b, -1.0)):
            if block < 0:
                continue
            inside = [made.parts[k].vertices for k in np.flatnonzero(made.owner == block)]
            near = [p for p in inside if np.abs((p - points[0]) @ normal).min() < 1e-6]
            assert any((sense * ((p - points[0]) @ normal) > -1e-6).all() for p in near)
    assert set(made.a) | set(made.b) >= set(range(len(made.mass)))
    for k in range(0, len(made.mass), 7):
        mass, centre, inertia = mass_properties([made.parts[i] for i in np.flatnonzero(made.owner == k)], 2000.0)
        curved = 3e-3 if "barrel" in name else 1e-12  # voussoirs weigh as sectors, and are drawn by chords
        assert made.mass[k] == pytest.approx(mass, rel=curved)
        assert made.centroid[k] == pytest.approx(centre, abs=max(curved, 1e-9))
        assert made.inertia[k] == pytest.approx(inertia, abs=max(3 * curved, 1e-9) * np.trace(inertia))
    assert len(set(made.block_names)) == len(made.mass) and len(set(made.joint_names)) == len(made.a)


def test_a_dome_weighs_as_a_shell_in_the_end() -> None:
    shell = 2.0 / 3.0 * np.pi * (5.25**3 - 4.75**3) * 2000.0
    off = [building({**SOLIDS["dome"], "rings": n, "lunes": 2 * n}).solids().mass.sum() / shell - 1.0 for n in (4, 8, 16)]
    assert abs(off[2]) < 3e-3 and off[1] / off[0] == pytest.approx(0.25, abs=0.06) and off[2] / off[1] == pytest.approx(0.25, abs=0.06)


def test_corners_are_bonded() -> None:
    """At a corner the courses pass in turn: each quoin lies on one of the other leg, and half bond runs on both sides."""
    made = building(
        {
            "kind": "wall",
            "unit_length": 0.4,
            "unit_height": 0.2,
            "thickness": 0.2,
            "height": 1.6,
            "legs": [{"length": 2.0}, {"length": 2.0}],
        }
    ).solids()
    crossing = [n for n in made.joint_names if " on " in n and "leg 1 on" in n and n.endswith("leg 2")]
    assert len(crossing) >= 3
    beds = made.area[(np.abs(made.normal[:, 2]) > 0.5) & (made.b >= 0)]
    assert beds == pytest.approx(np.full(len(beds), 0.04), rel=1e-9)  # half a unit, everywhere


@pytest.mark.parametrize("lengths", [(3.0, 2.0), (2.37, 3.1), (2.4, 1.9, 2.6)])
def test_head_joints_do_not_stand_above_each_other(lengths: tuple[float, ...]) -> None:
    """Whatever the lengths, from the corners on; where the units do not come out even a closer is cut."""
    made = building(
        {"kind": "wall", "unit_length": 0.4, "unit_height": 0.2, "thickness": 0.2, "height": 1.0, "legs": [{"length": x} for x in lengths]}
    ).solids()
    upright = [j for j in range(len(made.a)) if abs(made.normal[j, 2]) < 0.5]
    middle = np.array([made.polygon[j].mean(axis=0) for j in upright])
    level = np.round(middle[:, 2] / 0.2 - 0.5).astype(int)
    for k in range(level.max()):
        below, above = middle[level == k], middle[level == k + 1]
        apart = np.linalg.norm(below[:, None, :2] - above[None, :, :2], axis=2)
        assert apart.min() > 0.09


@pytest.mark.parametrize(
    "given",
    [
        {"voussoirs": 16, "stone_length": 0.9},
        {"voussoirs": 8, "stone_length": 0.8, "oblong": 1.5},
        {"voussoirs": 12, "stone_length": 0.5, "embrace": 180, "springers": 2},
        {"voussoirs": 16, "stone_length": 0.7, "springers": 0},
    ],
    ids=["square", "oblong", "round", "without springers"],
)
def test_every_stone_of_a_groin_vault_has_a_bed(given: dict[str, Any]) -> None:
    """Its course's lower joint bears it on the course below or the ground, a groin voussoir in both webs, over at least a
    share of its length; and the bond cuts the vault into other stones, not into another vault."""
    vault = {"kind": "cross-vault", "radius": 3, "thickness": 0.4, "embrace": 150, **given}
    made = building(vault).solids()

    def course(block: int) -> int:
        if block < 0 or made.block_names[block].startswith("springer"):
            return 0
        return int(made.block_names[block].split("course ")[1].split(",")[0])

    least = LEAST_PIECE * vault["stone_length"] * vault["thickness"]
    for k, name in enumerate(made.block_names):
        if name.startswith("springer"):
            continue
        sides = ((made.a, made.b), (made.b, made.a))
        beds = [j for one, two in sides for j in np.flatnonzero(one == k) if course(two[j]) < course(k)]
        across = {tuple(np.abs(np.round(made.normal[j, :2], 9)).argsort()) for j in beds if made.area[j] > least}
        assert len(across) == (2 if name.startswith("groin") else 1), name
    whole = building({key: value for key, value in vault.items() if key != "stone_length"}).solids()
    assert made.mass.sum() == pytest.approx(whole.mass.sum(), rel=1e-12)
    assert made.mass @ made.centroid == pytest.approx(whole.mass @ whole.centroid, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(
    ("structure", "told"),
    [
        ({"kind": "dome", "radius": 1, "thickness": 1.2, "rings": 4, "lunes": 8}, "is not below the radius"),
        ({**SOLIDS["dome"], "oculus": 170, "embrace": 160}, "leaves nothing"),
        ({**SOLIDS["cross-vault"], "voussoirs": 9}, "expected an even number"),
        ({**SOLIDS["cross-vault"], "springers": 4}, "reach the crown"),
        ({**SOLIDS["round column"], "depth": 1.0}, "`depth` is only for rectangular drums"),
        ({"kind": "column", "width": 1, "height": 5, "flute_depth": 0.1}, 'section = "round"'),
        ({**SOLIDS["room"], "legs": SOLIDS["room"]["legs"][:3]}, "the key `closed` requires at least four legs"),
        ({**SOLIDS["bent wall"], "legs": [{"length": 0.3}, {"length": 2}]}, "less than two thicknesses"),
    ],
)
def test_wrong_keys_are_reported_in_words(structure: dict[str, Any], told: str) -> None:
    with pytest.raises(DeckError, match=told):
        building(structure)


def test_walls_that_do_not_fit_are_reported() -> None:
    legs = [{"length": 2.4}, {"length": 2}, {"length": 2.2}, {"length": 2}]
    with pytest.raises(BadGeometry, match=r"the legs are not closed: the last leg ends at x = 0\.2"):
        building({**SOLIDS["room"], "legs": legs}).solids()
    legs = [{"length": 2.0, "openings": [{"x": [1.5, 1.95], "y": [0.4, 0.8]}]}, {"length": 2}]
    with pytest.raises(BadGeometry, match=r"leg 1, x 1\.5 to 1\.95 m, overlaps a corner; expected 0 to 1\.8 m"):
        building({**SOLIDS["bent wall"], "legs": legs}).solids()


def test_kinds_in_space_refuse_what_looks_at_a_section() -> None:
    with pytest.raises(DeckError, match="rocking cannot analyse a structure of kind 'dome': this structure has no plane section"):
        make_deck({"structure": SOLIDS["dome"], "motion": {"kind": "constant", "amplitude": "0.1 g"}, "analysis": {"kind": "rocking"}})
    for name, words in (("skew barrel", "skew arch"), ("round column", "round drums")):
        with pytest.raises(NoView, match=f"{words}.*{re.escape(IN_SPACE)}"):
            building(SOLIDS[name]).blocks()


def test_refusals_name_the_analyses_that_take_solids() -> None:
    """All but `assess`, which runs these, and `thrust-network`, which takes vaults and domes alone."""
    takes = {kind for kind in kinds.ANALYSES if kinds.table("analysis", kind).solid} - {"assess", "thrust-network"}
    assert set(re.findall("`(.+?)`", IN_SPACE)) == takes


def obj(bodies: dict[str, Polyhedron]) -> str:
    lines, first = [], 1
    for name, body in bodies.items():
        lines.append(f"o {name}")
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in body.vertices.tolist()]
        lines += ["f " + " ".join(str(k + first) for k in face) for face in body.faces]
        first += len(body.vertices)
    return "\n".join(lines)


def stl_text(bodies: dict[str, Polyhedron]) -> str:
    lines = []
    for name, body in bodies.items():
        lines.append(f"solid {name}")
        for triangle in body.vertices[body.triangles]:
            lines += [
                "facet normal 0 0 0",
                "outer loop",
                *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in triangle.tolist()),
                "endloop",
                "endfacet",
            ]
        lines.append(f"endsolid {name}")
    return "\n".join(lines)


def stl_binary(bodies: dict[str, Polyhedron]) -> bytes:
    triangles = np.concatenate([b.vertices[b.triangles] for b in bodies.values()])
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0) for t in triangles)
    return b"solid of a binary kind".ljust(80) + struct.pack("<I", len(triangles)) + rows


def compas(bodies: dict[str, Polyhedron], supports: tuple[str, ...] = ()) -> str:
    nodes = {}
    for k, (name, body) in enumerate(bodies.items()):
        vertex = {str(i): dict(zip("xyz", v.tolist(), strict=True)) for i, v in enumerate(body.vertices)}
        face = {str(i): [str(j) for j in f] for i, f in enumerate(body.faces)}
        nodes[str(k)] = {"block": {"data": {"vertex": vertex, "face": face}}, "is_support": name in supports}
    return json.dumps({"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": {"data": {"node": nodes}}}})


STACK = {
    "lower": prism(np.array([[0, 0], [2, 0.2], [1.8, 1.5], [-0.2, 1.2]]), 0.0, 1.0),
    "upper": hull(np.array([[0.2, 0.2, 1], [1.6, 0.3, 1], [1.5, 1.1, 1], [0.1, 1.0, 1], [0.4, 0.4, 2], [1.2, 0.5, 2.2], [0.6, 0.9, 2.1]])),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same stack as every file."""
    place = tmp_path_factory.mktemp("solids")
    (place / "stack.obj").write_text(obj(STACK))
    (place / "text.stl").write_text(stl_text(STACK))
    (place / "binary.stl").write_bytes(stl_binary(STACK))
    (place / "stack.json").write_text(compas(STACK))
    base = {"base": box((-1, -1, -0.5), (3, 3, 0)), **STACK}
    (place / "supported.json").write_text(compas(base, ("base",)))
    return place


def of_file(folder: Path, file: str, **keys: Any) -> SolidAssembly:
    return building({"kind": "blocks", "file": file, **keys}, folder).solids()


def test_every_file_gives_the_same_solids(folder: Path) -> None:
    exact = of_file(folder, "stack.obj")
    assert exact.block_names == ["lower", "upper"] and exact.joint_names == ["upper on lower", "lower on the ground"]
    for file, precise in (("text.stl", 1e-12), ("binary.stl", 1e-6), ("stack.json", 1e-12), ("supported.json", 1e-12)):
        made = of_file(folder, file)
        assert made.mass == pytest.approx(exact.mass, rel=precise)
        assert made.centroid == pytest.approx(exact.centroid, rel=precise)
        assert sorted(made.area) == pytest.approx(sorted(exact.area), rel=precise)
    small = of_file(folder, "stack.obj", unit="mm")
    assert small.mass == pytest.approx(exact.mass * 1e-9, rel=1e-12)


def test_a_compas_assembly_without_a_plane_is_looked_at_in_space(folder: Path) -> None:
    """The upper stone is no prism: tilt and thrust take the solids of themselves, what needs a section says why it cannot."""
    tables = {
        "structure": {"kind": "blocks", "file": "stack.json"},
        "analysis": [{"kind": "tilt"}, {"kind": "thrust"}, {"kind": "moving-load"}],
    }
    tilt, thrust, moving = run_analyses(Context(make_deck(tables, folder), threads=1))
    assert tilt.status == "ok" and tilt.results["blocks"] == 2
    assert thrust.status == "ok" and moving.status == "refused" and "prisms perpendicular to one plane" in moving.reason
    assert check_building(make_deck({**tables, "analysis": tables["analysis"][:1]}, folder)).solids is not None


def test_groups_of_an_object_are_parts_of_one_stone(folder: Path) -> None:
    """An L of two boxes, which is not convex."""
    one, two = box((0, 0, 0), (2, 1, 1)), box((0, 0, 1), (1, 1, 2))
    text = obj({"foot": one, "leg": two}).replace("o foot", "o stone\ng foot").replace("o leg", "g leg")
    (folder / "ell.obj").write_text(text)
    made = of_file(folder, "ell.obj")
    assert made.block_names == ["stone"] and made.mass == pytest.approx([6000.0]) and len(made.parts) == 2
    assert made.centroid[0] == pytest.approx([(2 * 1 + 1 * 0.5) / 3, 0.5, (2 * 0.5 + 1.5) / 3])


def test_errors_of_a_file_are_reported(folder: Path) -> None:
    concave = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2.0]])
    n = len(concave)
    vertices = np.concatenate([np.column_stack([concave, np.full(n, z)]) for z in (0.0, 1.0)])
    sides = tuple((i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n))
    ell = Polyhedron(vertices, (tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *sides))
    lifted = {**STACK, "upper": STACK["upper"].moved(np.eye(3), np.array([0, 0, 5e-4]))}
    pressed = {**STACK, "upper": STACK["upper"].moved(np.eye(3), np.array([0, 0, -5e-3]))}
    wrong = {
        "concave.obj": (obj({"ell": ell}), "ell is not convex: its convex hull has 16.7 % more volume. Divide it into convex parts"),
        "open.obj": (
            obj({"cube": Polyhedron(CUBE.vertices, CUBE.faces[1:])}),
            "cube is not closed: 4 edges do not have a face on both sides",
        ),
        "short.obj": ("v 0 0\n", "short.obj:1: expected a vertex of three numbers"),
        "words.obj": ("v 0 0 0\nf 1 b 2\n", "words.obj:2: a face must give its vertices by numbers"),
        "none.obj": ("v 0 0 0\nf 1 2 3\n", "none.obj:2: a face has a vertex that does not exist"),
        "empty.obj": ("# nothing\n", "empty.obj: holds no faces"),
        "garbage.stl": ("solid nothing of the kind", "neither a text STL file nor a binary STL file of the right length"),
        "nan.stl": (stl_text({"a": CUBE}).replace("vertex 0.0", "vertex nan", 1), "expected a vertex of three numbers"),
        "lifted.obj": (
            obj(lifted),
            "upper touches neither another block nor the ground; the nearest face is 0.5 mm away (give a larger `contact_tolerance`",
        ),
        "pressed.obj": (obj(pressed), "lower and upper overlap by 5 mm, which exceeds 0.1 mm"),
    }
    for name, (text, told) in wrong.items():
        (folder / name).write_text(text)
        with pytest.raises(BadGeometry) as refused:
            of_file(folder, name)
        assert told in str(refused.value)
    assert len(of_file(folder, "lifted.obj", contact_tolerance=1e-3).a) == 2


def test_foundations_at_unlike_levels(folder: Path) -> None:
    steps = {"low": box((0, 0, 0), (1, 1, 2)), "high": box((1, 0, 1), (2, 1, 2))}
    (folder / "steps.obj").write_text(obj(steps))
    assert (of_file(folder, "steps.obj").b < 0).sum() == 1
    made = of_file(folder, "steps.obj", foundation_levels=[0.0, 1.0])
    assert [n for n, b in zip(made.joint_names, made.b, strict=True) if b < 0] == ["low on the ground", "high on the ground"]


def test_check_reports_and_draws_solids(folder: Path, tmp_path: Path) -> None:
    deck = make_deck({"structure": {"kind": "blocks", "file": "stack.obj"}, "analysis": {"kind": "tilt"}}, folder)
    checked = check_building(deck)
    assert checked.complaints == [] and checked.solids is not None and len(checked.solids.a) == 2
    assert write_solids(checked.solids, tmp_path / "check").stat().st_size > 10_000
    deck = make_deck({"structure": {"kind": "blocks", "file": "pressed.obj"}, "analysis": {"kind": "tilt"}}, folder)
    (folder / "pressed.obj").write_text(obj({**STACK, "upper": STACK["upper"].moved(np.eye(3), np.array([0, 0, -5e-3]))}))
    assert "overlap by 5 mm" in check_building(deck).complaints[0]
