"""Drawings and blocks that are small as files and large to look at: memory and work are bounded, and the bound is told."""

import json
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extrados.model.errors import BadGeometry
from extrados.model.geometry.compas import read_compas
from extrados.model.geometry.contacts import find_contacts
from extrados.model.geometry.drawing import read_json
from extrados.model.geometry.dxf import read_dxf
from extrados.model.geometry.linework import net_of
from extrados.model.geometry.polygons import crossing_edges
from extrados.model.geometry.solids.assembly import Stone, assemble
from extrados.model.geometry.solids.meshes import read_solids, stones_of
from extrados.model.geometry.solids.polyhedra import ManyFaces, box, hull, overlap_depth
from extrados.model.structures.blocks import _marked as marked
from extrados.schema.files import File

NO_GROUND = np.empty((0, 4))
HEAD = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"


def peak(look: Callable[[], Any]) -> float:
    """The most memory that a look took beside what it began with [MB]."""
    tracemalloc.start()
    try:
        look()
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


def ring(count: int, radius: float) -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def square(x: float) -> np.ndarray:
    return np.array([[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]])


def drawing(*entities: str) -> File:
    return File(Path("a.dxf"), (HEAD + "".join(entities) + "0\nENDSEC\n0\nEOF\n").encode())


def polyline(*places: tuple[float, float, float], closed: int = 1) -> str:
    rows = "".join(f"10\n{x!r}\n20\n{y!r}\n42\n{bulge!r}\n" for x, y, bulge in places)
    return f"0\nLWPOLYLINE\n100\nAcDbEntity\n8\n0\n100\nAcDbPolyline\n90\n{len(places)}\n70\n{closed}\n{rows}"


def spline(*places: tuple[float, float]) -> str:
    rows = "".join(f"10\n{x!r}\n20\n{y!r}\n30\n0\n" for x, y in places)
    knots = "".join(f"40\n{k}\n" for k in (0, 0, 0, 0, 1, 1, 1, 1))
    return f"0\nSPLINE\n8\n0\n100\nAcDbEntity\n100\nAcDbSpline\n70\n8\n71\n3\n72\n8\n73\n4\n74\n0\n{knots}{rows}"


def test_outlines_of_many_points_take_little_memory() -> None:
    """All edges of two outlines of 1000 points beside each other would be 100 MB an array."""
    assert peak(lambda: find_contacts([ring(1000, 5.0 + 0.5 * k) for k in range(3)], NO_GROUND, 1e-4)) < 300.0
    assert peak(lambda: crossing_edges(ring(2000, 5.0))) < 100.0


def test_ground_of_many_segments_takes_little_memory() -> None:
    ground = np.array([[0.1 * k, 0.0, 0.1 * k + 0.1, 0.0] for k in range(3000)])
    found = []
    assert peak(lambda: found.append(find_contacts([square(x) for x in range(300)], ground, 1e-4))) < 300.0
    assert (found[0].b < 0).sum() == 300


def test_what_would_be_compared_too_often_is_reported(monkeypatch) -> None:
    monkeypatch.setattr("extrados.model.geometry.contacts.MOST_COMPARED", 10_000)
    with pytest.raises(BadGeometry, match=r"more than 10,000 pairs of edges .*fewer points"):
        find_contacts([ring(200, 5.0), ring(200, 5.5)], NO_GROUND, 1e-4)
    monkeypatch.setattr("extrados.model.geometry.contacts.MOST_KEPT", 100)
    monkeypatch.setattr("extrados.model.geometry.contacts.MOST_COMPARED", 10_000_000)
    with pytest.raises(BadGeometry, match="is doubled"):
        find_contacts([square(0.0)], np.tile([0.0, 0.0, 1.0, 0.0], (1000, 1)), 1e-4)


@pytest.mark.parametrize(
    "entity",
    [
        "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n1e12\n",
        "0\nARC\n8\n0\n10\n0\n20\n0\n40\n1e9\n50\n0\n51\n359\n",
        "0\nELLIPSE\n8\n0\n100\nAcDbEllipse\n10\n0\n20\n0\n30\n0\n11\n1e12\n21\n0\n31\n0\n40\n1e-3\n41\n0\n42\n6.28\n",
        polyline((0.0, 0.0, 1.0), (1e14, 0.0, 1.0)),
        polyline((0.0, 0.0, 1e-300), (1e300, 0.0, 1.0)),
        spline((0.0, 0.0), (1e9, 1e9), (-1e9, 2e9), (5.0, 5.0)),
    ],
    ids=["circle", "arc", "ellipse", "bulge", "flat bulge", "spline"],
)
def test_a_curve_of_too_many_chords_is_reported(entity) -> None:
    def look() -> None:
        with pytest.raises(BadGeometry, match=r"a\.dxf: layer '0', .*more than 200,000 chords"):
            read_dxf(drawing(entity))

    look()  # the library is loaded
    assert peak(look) < 50.0


@pytest.mark.parametrize(
    "entity",
    [
        "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\nnan\n",
        polyline((0.0, 0.0, float("nan")), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)),
        spline((0.0, 0.0), (float("nan"), 1.0), (-1.0, 2.0), (5.0, 5.0)),
    ],
)
def test_a_curve_of_no_numbers_is_reported(entity) -> None:
    with pytest.raises(BadGeometry, match=r"layer '0', .*not .*finite"):
        read_dxf(drawing(entity))


def test_a_nearly_straight_arc_of_a_great_radius_is_followed() -> None:
    arc = "0\nARC\n8\n0\n10\n0\n20\n-1e7\n40\n1e7\n50\n89.99999\n51\n90.00001\n"
    sides = polyline((1.7453, 0.0, 0.0), (1.7453, -2.0, 0.0), (-1.7453, -2.0, 0.0), (-1.7453, 0.0, 0.0), closed=0)
    (block,) = read_dxf(drawing(arc, sides)).blocks
    assert np.ptp(block.points, axis=0) == pytest.approx([3.4907, 2.0], abs=1e-3)


def test_whole_numbers_of_hundreds_of_digits_are_no_places() -> None:
    huge = int("9" * 400)
    with pytest.raises(BadGeometry, match="expected a list of rows of 2 numbers"):
        read_json(File(Path("a.json"), json.dumps({"blocks": [{"points": [[huge, 0], [1, 0], [1, 1]]}]}).encode()))
    mesh = {"vertex": {str(k): {"x": huge, "y": 0, "z": 0} for k in range(8)}, "face": {}}
    with pytest.raises(BadGeometry, match="expected a mesh"):
        read_compas({"graph": {"node": {"0": {"block": mesh}}}}, "a.json")


def test_lines_that_mark_joints_take_little_memory() -> None:
    """Every line beside every joint would be 100 MB an array."""
    places = np.column_stack([np.arange(3000.0), np.zeros(3000)])
    lines = np.array([[k + 0.5, -0.1, k + 0.5, 0.1] for k in range(3000)])
    lines[7] = 7.005, -1.0, 7.005, 1.0
    found = []
    assert peak(lambda: found.append(marked(places, lines, 0.01))) < 50.0
    assert found == [[7]]


def test_hanging_lines_are_taken_away_one_by_one() -> None:
    """A chain that ends nowhere hangs by one line after another; what it hangs on stays."""
    chain = np.array([[0.1 * k, 0.0, 0.1 * k + 0.1, 0.0] for k in range(10, 300)])
    around = np.column_stack([square(0.0), np.roll(square(0.0), -1, axis=0)])
    net = net_of(np.concatenate([chain, around, [[5.0, 0.05, 6.0, 1.0]]]), 1e-3, 0.1)
    assert len(net.faces) == 1 and len(net.faces[0]) == 4
    loose = sorted(net.loose, key=lambda end: end.place)
    assert np.array([end.place for end in loose]) == pytest.approx(np.array([[5.0, 0.05], [6.0, 1.0], [30.0, 0.0]]))
    assert loose[0].gap == pytest.approx(0.05)


def prism(corners: int, radius: float = 5.0) -> dict[str, Any]:
    """A block of COMPAS: the prism over a ring."""
    vertex = {
        str(k + corners * y): {"x": float(x), "y": y, "z": float(z)} for y in (0, 1) for k, (x, z) in enumerate(ring(corners, radius))
    }
    sides = [[k, (k + 1) % corners, corners + (k + 1) % corners, corners + k] for k in range(corners)]
    faces = [list(range(corners)), list(range(2 * corners - 1, corners - 1, -1)), *sides]
    return {"vertex": vertex, "face": {str(k): face for k, face in enumerate(faces)}}


def test_a_prism_of_many_corners_takes_little_memory() -> None:
    """Every corner beside every other would be 72 MB an array."""
    value = {"graph": {"node": {"0": {"block": prism(3000)}}}}
    found = []
    assert peak(lambda: found.append(read_compas(value, "a.json"))) < 50.0
    (block,), depth = found[0][0].blocks, found[0][1]
    assert len(block.points) == 3000 and depth == pytest.approx(1.0)


def test_bodies_of_many_corners_take_little_memory() -> None:
    """Axes across every edge of one and every edge of the other, along every corner, would be 2 GB."""
    height = np.linspace(-0.9, 0.9, 14)[:, None, None]
    level = np.broadcast_to(ring(22, 1.0)[None], (14, 22, 2)) * np.sqrt(1.0 - height**2)
    points = np.concatenate([level, np.broadcast_to(height, (14, 22, 1))], axis=2).reshape(-1, 3)
    one, two = hull(points, 1e-9), hull(points @ np.diag([1.0, 1.0, 1.01]) + [1.7, 0.3, 0.2], 1e-9)
    found = []
    assert peak(lambda: found.append(overlap_depth(one, two))) < 100.0
    assert found[0] == pytest.approx(2.0 - np.linalg.norm([1.7, 0.3, 0.2]), abs=0.03)


def test_a_body_of_too_many_corners_is_reported(monkeypatch) -> None:
    monkeypatch.setattr("extrados.model.geometry.solids.meshes.MOST_CORNERS", 100)
    few, many = (read_solids({"graph": {"node": {"0": {"block": prism(k)}}}}, "a.json") for k in (60, 400))
    with pytest.raises(BadGeometry, match="block 0 has more than 100 corners, the limit of this program"):
        stones_of(few, 2000.0, None, "a.json")
    # told before their faces are compared with each other, and before Qhull, which is as slow and hears no signal
    with pytest.raises(ManyFaces):
        hull(many[0].points, most=200)
    with pytest.raises(BadGeometry, match="block 0 has more than 100 corners"):
        stones_of(many, 2000.0, None, "a.json")
    monkeypatch.setattr("extrados.model.geometry.solids.meshes.MOST_POINTS", 500)
    with pytest.raises(BadGeometry, match="block 0 has 800 points; at most 500 are considered"):
        stones_of(many, 2000.0, None, "a.json")


def test_bodies_over_each_other_are_reported_before_all_pairs_are_looked_at(monkeypatch) -> None:
    monkeypatch.setattr("extrados.model.geometry.solids.contacts.MOST_PAIRS", 100)
    monkeypatch.setattr("extrados.model.geometry.solids.contacts.MOST_NEIGHBOURS", 1)
    stones = [Stone(f"block {k}", [box((0, 0, 0), (1, 1, 1))], 2000.0) for k in range(30)]
    with pytest.raises(BadGeometry, match="more than 100 pairs, the limit of this program"):
        assemble(stones, 1e-4)
