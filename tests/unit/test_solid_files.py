"""Solids as files have them: blocks that share corners, blocks drawn twice, y upward."""

import time

import numpy as np
import pytest
from test_noisy_solids import corner, obj, pushed

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.model.geometry.solids.assembly import SolidAssembly, assemble
from extrados.model.geometry.solids.flat import section_of_meshes
from extrados.model.geometry.solids.meshes import read_obj, read_stl, stones_of
from extrados.results.model import Result


def stl(text: str) -> str:
    """The triangles of an OBJ as one solid of an STL."""
    lines = text.splitlines()
    points = [line.split()[1:] for line in lines if line.startswith("v ")]
    rows = ["solid survey"]
    for line in lines:
        if line.startswith("f "):
            rows += ["facet normal 0 0 0", "outer loop"]
            rows += [f"vertex {' '.join(points[int(k) - 1])}" for k in line.split()[1:]]
            rows += ["endloop", "endfacet"]
    return "\n".join([*rows, "endsolid survey"])


def loose(text: str) -> str:
    """An OBJ without names, in which blocks that touch share vertices."""
    points = np.array([line.split()[1:] for line in text.splitlines() if line.startswith("v ")], dtype=float)
    single, number = np.unique(np.round(points, 6), axis=0, return_inverse=True)
    rows = [f"v {x} {y} {z}" for x, y, z in single.tolist()]
    faces = [line.split()[1:] for line in text.splitlines() if line.startswith("f ")]
    return "\n".join([*rows, *("f " + " ".join(str(number[int(k) - 1] + 1) for k in face) for face in faces)])


def read(meshes: list, tolerance: float = 1e-4) -> SolidAssembly:
    return assemble(stones_of(meshes, 2000.0, None, "file", tolerance), tolerance)


@pytest.mark.parametrize("sort", ["stl", "obj"])
def test_blocks_that_share_corners_are_parted(sort: str) -> None:
    """28 blocks in one solid, of which neighbours have corners and edges in common: the capacity of the named blocks."""
    exact = assemble(corner())
    text = obj(corner(), triangles=True)
    found = read(read_stl(stl(text).encode(), "w.stl") if sort == "stl" else read_obj(loose(text), "w.obj"))
    assert len(found.mass) == 28 and len(found.a) == len(exact.a)
    assert pushed(found, 90.0) == pytest.approx(pushed(exact, 90.0), abs=1e-7)


def tilt(folder, text: str, **keys: object) -> Result:
    (folder / "w.obj").write_text(text)
    deck = {"structure": {"kind": "blocks", "file": "w.obj", **keys}, "joints": {"friction": 0.65}, "material": {"density": 2000.0}}
    deck["analysis"] = {"kind": "tilt", "direction": 90.0, "rose": 4, "friction_rule": "associated", "face_law": False}
    (result,) = run_analyses(Context(make_deck(deck, folder), threads=1))
    return result


def test_blocks_drawn_twice_count_once(tmp_path) -> None:
    """Two of 28 blocks again, one of them 20 um beside itself: they count once, and a remark names both."""
    text = obj(corner())
    last = text.count("\nv ")
    again = corner()[3]
    moved = obj([again]).replace(f"o {again.name}", "o copy")
    rows = []
    for line in moved.splitlines():
        words = line.split()
        if words[0] == "v":
            line = f"v {float(words[1]) + 2e-5} {words[2]} {words[3]}"
        elif words[0] == "f":
            line = "f " + " ".join(str(int(k) + last) for k in words[1:])
        rows.append(line)
    clean, twice = tilt(tmp_path, text), tilt(tmp_path, text + "\n" + "\n".join(rows))
    assert twice.results.blocks == 28
    assert twice.results.collapse_acceleration_g == pytest.approx(clean.results.collapse_acceleration_g, abs=1e-9)
    assert any(f"copy as {again.name}" in told for told in [*twice.warnings, twice.answer])
    assert not any("drawn twice" in told for told in [*clean.warnings, clean.answer])


def test_a_file_with_y_upward(tmp_path) -> None:
    """The same blocks written with y upward and read with `up`; without it the walls lie on their sides."""
    text = obj(corner())
    rows = []
    for line in text.splitlines():
        words = line.split()
        rows.append(f"v {words[1]} {words[3]} {-float(words[2])}" if words[0] == "v" else line)
    upright = tilt(tmp_path, text).results
    turned = tilt(tmp_path, "\n".join(rows), up="y").results
    assert turned.collapse_acceleration_g == pytest.approx(upright.collapse_acceleration_g, abs=1e-9)
    assert turned.contacts == upright.contacts


def test_up_is_refused_of_plane_drawings() -> None:
    square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    deck = make_deck({"structure": {"kind": "blocks", "up": "y", "block": [{"points": square}]}, "analysis": {"kind": "tilt"}})
    (found,) = run_analyses(Context(deck, threads=1))
    assert found.status == "refused" and "up` is only for" in found.reason


def test_an_outline_of_many_faces_is_found_at_once() -> None:
    """20,000 triangles of one plane, as a mesh of a survey has them: their outline is that of the square."""
    n = 100
    corners = [f"v {i} 0 {j}" for i in range(n + 1) for j in range(n + 1)]
    at = [i * (n + 1) + j + 1 for i in range(n) for j in range(n)]
    faces = [f"f {a} {a + n + 1} {a + n + 2}\nf {a} {a + n + 2} {a + 1}" for a in at]
    meshes = read_obj("\n".join(["o wall", *corners, *faces]), "wall.obj")
    began = time.process_time()
    drawing, _ = section_of_meshes(meshes, "xz", None, "wall.obj")
    assert time.process_time() - began < 1.0
    (outline,) = drawing.blocks
    assert len(outline.points) == 4 * n and np.ptp(outline.points, axis=0).tolist() == [n, n]
