"""Measured solids: faces that are not quite plane, contacts narrower than the tolerance, and what is said of both."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.solids import Programme, SolidLimit
from extrados.model.errors import BadGeometry
from extrados.model.geometry.solids.assembly import SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.meshes import read_obj, read_stl, stones_of
from extrados.model.geometry.solids.polyhedra import Polyhedron, box, fitted, moments
from extrados.model.structures.dome import make_dome
from extrados.results.model import Result

FRICTION = 0.65


def corner() -> list[Stone]:
    """Two walls of 1 m height and .25 m thickness, stack bond in both; the quoins bond them in turn."""
    stones = []
    for course in range(4):
        low, high = 0.25 * course, 0.25 * course + 0.25
        along, across = np.arange(0.0, 2.1, 0.5), np.arange(0.0, 1.6, 0.5)
        (across if course % 2 == 0 else along)[0] = 0.25
        for k, (a, b) in enumerate(itertools.pairwise(along)):
            stones.append(Stone(f"stone {k} along, course {course}", [box((a, 0, low), (b, 0.25, high))], 2000.0))
        for k, (a, b) in enumerate(itertools.pairwise(across)):
            stones.append(Stone(f"stone {k} across, course {course}", [box((0, a, low), (0.25, b, high))], 2000.0))
    return stones


def obj(stones: list[Stone], noise: float = 0.0, seed: int = 0, *, triangles: bool = False) -> str:
    """The stones as an OBJ, each corner of each moved by up to `noise` along each axis."""
    rng = np.random.default_rng(seed)
    lines, first = [], 1
    for stone in stones:
        lines.append(f"o {stone.name}")
        for k, part in enumerate(stone.parts):
            lines.append(f"g part {k}")
            places = part.vertices + rng.uniform(-noise, noise, part.vertices.shape)
            lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in places.tolist()]
            faces = part.triangles.tolist() if triangles else part.faces
            lines += ["f " + " ".join(str(i + first) for i in face) for face in faces]
            first += len(places)
    return "\n".join(lines)


def read(text: str, tolerance: float) -> SolidAssembly:
    return assemble(stones_of(read_obj(text, "w.obj"), 2000.0, None, "w.obj", tolerance), tolerance)


def pushed(solids: SolidAssembly, *directions: float) -> np.ndarray:
    found = [SolidLimit(solids, FRICTION).push(d) for d in directions]
    assert all(isinstance(one, Programme) for one in found)
    return np.array([one.gamma for one in found if isinstance(one, Programme)])


CLEAN = pushed(assemble(corner()), 90.0, 270.0)


def test_the_corner_of_the_reference() -> None:
    """Another program's cone programme found .4532 and .3419 g."""
    assert pytest.approx([0.4532, 0.3419], abs=5e-5) == CLEAN
    exact = read(obj(corner()), 1e-4)
    assert pushed(exact, 90.0, 270.0) == pytest.approx(CLEAN, rel=1e-8)
    assert exact.remarks == () and exact.notes == () and exact.deviation == 0.0


@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize(
    ("noise", "tolerance", "within"),
    [(1e-6, 4e-6, 1e-4), (1e-5, 4e-5, 1e-4), (1e-5, 1e-4, 1e-4), (1e-4, 4e-4, 5e-4), (3e-4, 2e-3, 2e-3), (1e-3, 4e-3, 3.5e-3)],
)
def test_noise_below_the_tolerance_changes_nothing(noise: float, tolerance: float, within: float, triangles: bool) -> None:
    """Surveys of the corner, ten of each noise; the errors that an independent program found with the same rule: 10 um added 8 to 25 % once."""
    for seed in range(5 if triangles else 10):
        solids = read(obj(corner(), noise, seed, triangles=triangles), tolerance)
        assert len(solids.a) == 55
        assert pushed(solids, 90.0, 270.0) == pytest.approx(CLEAN, rel=within)
        assert 0.5 * noise < solids.deviation < tolerance and "Corners were moved by up to" in solids.notes[0]
        (narrow,) = solids.remarks
        assert narrow.split()[1:4] == ["contacts", "are", "narrower"] and "carry no force" in narrow


def test_noise_far_from_the_origin() -> None:
    """National coordinates: the planes of faces that are not quite parallel lie anywhere at the origin."""
    far = np.array([431250.0, 5062480.0, 310.0])
    moved = [Stone(s.name, [p.moved(np.eye(3), far) for p in s.parts], s.density) for s in corner()]
    solids = read(obj(moved, 3e-4, 1), 2e-3)
    assert len(solids.a) == 55 and pushed(solids, 90.0, 270.0) == pytest.approx(CLEAN, rel=2e-3)


def test_noise_of_a_dome_in_bond() -> None:
    """Stones of two parts each, faces that are no rectangles, a keystone of sixteen sides."""
    made = make_dome(5.0, 0.6, 180.0, 5, 8, running=True)
    stones = [Stone(name, [made.parts[k] for k in np.flatnonzero(made.owner == i)], 2000.0) for i, name in enumerate(made.block_names)]
    exact = pushed(made, 0.0)
    for noise, within in ((1e-6, 1e-4), (1e-3, 2e-3)):
        for seed in range(3):
            assert pushed(read(obj(stones, noise, seed), 4.0 * noise), 0.0) == pytest.approx(exact, rel=within)


def test_noise_of_an_stl_of_single_precision() -> None:
    rng = np.random.default_rng(2)
    lines = []
    for stone in corner():
        (part,) = stone.parts
        places = (part.vertices + rng.uniform(-3e-4, 3e-4, part.vertices.shape)).astype(np.float32)
        lines.append(f"solid {stone.name}")
        for triangle in places[part.triangles]:
            corners = [f"vertex {x} {y} {z}" for x, y, z in triangle.tolist()]
            lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
        lines.append(f"endsolid {stone.name}")
    stones = stones_of(read_stl("\n".join(lines).encode(), "w.stl"), 2000.0, None, "w.stl", 2e-3)
    assert {len(stone.parts[0].faces) for stone in stones} == {6}
    assert pushed(assemble(stones, 2e-3), 90.0, 270.0) == pytest.approx(CLEAN, rel=2e-3)


def test_noise_that_is_much_for_the_stones_is_said() -> None:
    for noise, said in ((1e-3, False), (5e-3, True)):
        remarks = read(obj(corner(), noise, 3), 4.0 * noise).remarks
        assert any("capacities are uncertain by about" in remark for remark in remarks) == said, remarks
    (said_so,) = [remark for remark in remarks if "uncertain" in remark]
    assert "from their common plane (stone" in said_so and "The thinnest block has a thickness of 24" in said_so


def test_a_stone_on_slivers_alone_is_refused_by_name() -> None:
    base = Stone("base", [box((0, 0, 0), (1, 1, 1))], 2000.0)
    slab = Stone("slab", [box((0.999, 0, 1), (2, 1, 1.3))], 2000.0)
    with pytest.raises(BadGeometry, match=r"slab touches neither another block.*: the width of its widest contact is 1 mm, less than 2 mm"):
        assemble([base, slab], 2e-3)
    assert len(assemble([base, slab], 1e-4).a) == 2


def test_the_tolerance_that_is_reported_closes_the_gap() -> None:
    """A slab that lies askew by noise: the hint counts its slant, too."""
    askew = box((0, 0, 1), (1, 1, 1.3))
    tilt = np.array([[1, 0, 0], [0, 1, 0], [4e-3, 0, 1]])
    stones = [Stone("base", [box((0, 0, 0), (1, 1, 1))], 1.0), Stone("slab", [askew.moved(tilt)], 1.0)]
    with pytest.raises(BadGeometry, match="slab touches neither another block nor the ground; the nearest face is 2 mm away"):
        assemble(stones, 5e-4)
    made = assemble(stones, 2.01e-3)
    (across,) = [n for n, b in zip(made.normal, made.b, strict=True) if b >= 0]
    assert abs(across[0]) == pytest.approx(2e-3, rel=0.01)  # midway between both faces


def test_triangles_of_a_measured_face_are_one() -> None:
    rng = np.random.default_rng(0)
    cube = box((0, 0, 0), (1, 1, 1))
    body = Polyhedron(cube.vertices + rng.uniform(-1e-3, 1e-3, (8, 3)), tuple(map(tuple, cube.triangles.tolist())))
    whole = fitted(body, 2e-3)
    assert sorted(map(len, whole.faces)) == [4] * 6
    assert moments(whole.vertices, whole.triangles)[0] == pytest.approx(1.0, abs=3e-3)
    assert len(fitted(body, 1e-9).faces) == 12


def test_what_is_concave_by_less_than_the_tolerance_is_read() -> None:
    """A dent of .5 mm is noise under 2 mm, and none under .1 mm: the fault is named."""
    dented = box((0, 0, 0), (1, 1, 1))
    points = np.concatenate([dented.vertices, [[0.5, 0.5, 0.9995]]])
    top = next(k for k, n in enumerate(dented.normals) if n[2] > 0.5)
    ring = dented.faces[top]
    faces = [*(f for k, f in enumerate(dented.faces) if k != top)]
    faces += [(a, b, 8) for a, b in zip(ring, (*ring[1:], ring[0]), strict=True)]
    text = obj([Stone("dented", [Polyhedron(points, tuple(faces))], 2000.0)])
    assert len(read(text, 2e-3).parts[0].faces) == 6
    with pytest.raises(BadGeometry, match="is not convex: its convex hull has"):
        read(text, 1e-4)


def run(folder: Path, noise: float, tolerance: float, seed: int = 0, **analysis: Any) -> Result:
    (folder / "wall.obj").write_text(obj(corner(), noise, seed))
    tables = {
        "structure": {"kind": "blocks", "file": "wall.obj", "contact_tolerance": tolerance},
        "joints": {"friction": FRICTION},
        "motion": {"kind": "constant", "amplitude": "0.05 g", "duration": 0.1},
        "analysis": {"direction": 90.0, **analysis},
    }
    return run_analyses(Context(make_deck(tables, folder), threads=1))[0]


def test_a_deck_of_measured_stones(tmp_path: Path) -> None:
    found = run(tmp_path, 3e-4, 2e-3, kind="tilt", starts=1)
    assert found.results["collapse_acceleration_g"] == pytest.approx(CLEAN[0], rel=2e-3)
    assert sum("narrower than 2 mm" in w for w in found.warnings) == 1
    assert sum("Corners were moved by up to 0." in w for w in found.warnings) == 1


@pytest.mark.parametrize("seed", [0, 1])
def test_measured_stones_settle(tmp_path: Path, seed: int) -> None:
    """They overlapped by what the survey was off, and springs threw them."""
    for noise in (0.0, 3e-4):
        found = run(tmp_path, noise, 2e-3, seed, kind="dem")
        assert found.status == "ok" and found.results["outcome"] == "at-rest", found.reason
        assert found.results["peak_displacement_m"] < 1e-5


def test_parts_of_a_stone_that_lie_in_each_other_are_refused() -> None:
    """A body drawn twice under one name weighed twice as much."""
    cube, foot = box((0, 0, 0), (1, 1, 1)), box((0, 0, 1), (1, 1, 2))
    with pytest.raises(BadGeometry, match=r"pier: two parts of the block overlap by 1e\+03 mm"):
        read(obj([Stone("pier", [cube, cube], 2000.0)]), 1e-4)
    assert read(obj([Stone("pier", [cube, foot], 2000.0)], 2e-5), 1e-4).mass == pytest.approx([4000.0], rel=1e-3)
