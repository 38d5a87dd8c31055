"""Surveys read from loose lines, blocks and layers of drawings, georeferenced places, and assemblies of COMPAS."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from surveys import SQUARE, box, rows, run, sketch

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry
from extrados.model.geometry.drawing import Polygon
from extrados.model.geometry.linework import net_of
from extrados.model.geometry.polygons import signed_area
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import Blocks

ezdxf = pytest.importorskip("ezdxf")


# --- loose lines


def test_net_of_loose_lines() -> None:
    """Ends that nearly meet, stand on a line, cross or lead nowhere."""
    lines = np.array(
        [
            [0, 0, 2, 0.0005],
            [2, 0, 2, 1],
            [2, 1, 0, 1],
            [0, 1, 0, 0],
            [1, 0.0003, 1, 0.9996],
            [0.5, -0.5, 0.5, 1.5],
            [3, 3, 4, 3],
            [1.5, 0, 1.5, 0.98],
        ]
    )
    net = net_of(lines, 1e-3, 0.1)
    areas = sorted(round(signed_area(f), 2) for f in net.faces)
    assert areas == [0.5, 0.5, 1.0]
    gaps = {tuple(np.round(end.place, 3)): end.gap for end in net.loose}
    assert gaps[1.5, 0.98] == pytest.approx(0.02, abs=1e-3)
    assert gaps[3.0, 3.0] is None and (0.5, 1.5) in gaps
    assert len(net_of(lines, 0.025, 0.1).faces) == 4


def test_an_arch_of_loose_lines_and_arcs(tmp_path: Path) -> None:
    """Two long arcs and the joints between them, drawn once, with ends 2 mm short: ring sectors within a tolerance."""
    arch = make_arch(10.0, 1.5, 157.5, 7)

    def draw(document: Any, space: Any) -> None:
        for radius in (9.25, 10.75):
            space.add_arc((0, 0), radius, 11.25, 168.75)
        for p, q in zip(arch.p, arch.q, strict=True):
            space.add_line(p + 0.002 / 1.5 * (q - p), q)
        for j in (0, 7):
            space.add_line(arch.p[j], arch.q[j], dxfattribs={"layer": "GROUND"})
        space.add_text("CROWN").set_placement((0, 10))

    path = sketch(tmp_path / "arch.dxf", draw)
    found = run({"file": path.name, "join_tolerance": "3 mm"}, tmp_path)
    assert len(found["centroid"]) == 7 and found["collapse_acceleration_g"] == pytest.approx(0.3700, abs=5e-4)
    assert any("7 blocks were joined from 10 loose lines" in w for w in found.warnings)
    assert any("1 of text" in w for w in found.warnings)
    refused = run({"file": path.name}, tmp_path)
    assert refused.status == "refused" and "2 mm apart" in refused.reason and "join_tolerance" in refused.reason


def test_a_line_that_closes_no_stone_is_reported(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        space.add_lwpolyline((SQUARE * [2, 1]).tolist(), close=True)
        space.add_lwpolyline([(0, 1), (0, 2), (2, 2), (2, 1.004)])  # a stone upon it that is 4 mm open

    path = sketch(tmp_path / "open.dxf", draw)
    (told,) = (w for w in run({"file": path.name}, tmp_path).warnings if "no other line" in w)
    assert "1 end of loose lines meets no other line" in told
    assert "4 mm from the next line (see `join_tolerance`)" in told
    assert len(run({"file": path.name, "join_tolerance": "5 mm"}, tmp_path)["centroid"]) == 2


# --- blocks, layers, places


def test_references_to_blocks_are_exploded(tmp_path: Path) -> None:
    """Rotated, scaled, repeated and nested; layer 0 of a block is the layer of the reference."""

    def draw(document: Any, space: Any) -> None:
        stone = document.blocks.new("STONE")
        stone.add_lwpolyline((SQUARE * [1, 0.5]).tolist(), close=True, dxfattribs={"layer": "0"})
        pair = document.blocks.new("PAIR")
        pair.add_blockref("STONE", (0, 0))
        pair.add_blockref("STONE", (0.5, 1.0), dxfattribs={"rotation": 270})  # 0.5 wide, 1 high, from y = 0
        space.add_blockref("PAIR", (0, 0), dxfattribs={"layer": "ASHLAR"})
        row = space.add_blockref("STONE", (4, 0), dxfattribs={"layer": "ASHLAR"})
        row.dxf.column_count, row.dxf.column_spacing = 3, 1.0
        loop = document.blocks.new("LOOP")
        loop.add_blockref("LOOP", (0, 0))

    path = sketch(tmp_path / "blocks.dxf", draw)
    reading = Blocks(kind="blocks", file=path.name, contact_tolerance=0.1)
    drawing, _ = reading._drawing(tmp_path)
    assert [p.layer for p in drawing.blocks] == ["ASHLAR"] * 5
    places = sorted(tuple(p.points.min(axis=0).round(6)) for p in drawing.blocks)
    assert places == [(0.0, 0.0), (0.5, 0.0), (4.0, 0.0), (5.0, 0.0), (6.0, 0.0)]
    document = ezdxf.readfile(path)
    document.modelspace().add_blockref("LOOP", (0, 0))
    document.saveas(path)
    assert "is nested more than 16 levels deep, or contains itself" in run({"file": path.name}, tmp_path).reason


@pytest.mark.parametrize("grid", [False, True])
def test_references_to_blocks_are_counted_before_they_are_put_in_their_places(tmp_path: Path, monkeypatch, grid) -> None:
    """30^5 lines or a grid of 30,000 x 30,000 took more than 45 s before they were found to be too many."""

    def draw(document: Any, space: Any) -> None:
        document.blocks.new("B0").add_line((0, 0), (1, 0))
        for k in range(1, 5):
            outer = document.blocks.new(f"B{k}")
            for i in range(30):
                outer.add_blockref(f"b{k - 1}", (i, 0))
        if grid:
            space.add_blockref("B0", (0, 0)).grid((30_000, 30_000), (1, 1))
        else:
            space.add_blockref("B4", (0, 0))

    sketch(tmp_path / "many.dxf", draw)
    monkeypatch.setattr("ezdxf.entities.Insert.virtual_entities", lambda *_: pytest.fail("they were put in their places"))
    assert "more than 200,000 entities, including those of inserted blocks" in run({"file": "many.dxf"}, tmp_path).reason


def test_layers_for_material_friction_and_supports(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        for k, layer in enumerate(("STONE", "BRICK", "BRICK")):
            space.add_lwpolyline((SQUARE + np.array([0, k])).tolist(), close=True, dxfattribs={"layer": layer})
        space.add_lwpolyline((SQUARE + np.array([5, 0])).tolist(), close=True, dxfattribs={"layer": "OTHER"})
        space.add_line((0.1, 1.0), (0.9, 1.0), dxfattribs={"layer": "FELT"})
        space.add_line((-1, 0), (2, 0), dxfattribs={"layer": "ROCK"})

    path = sketch(tmp_path / "layers.dxf", draw)
    structure = {
        "kind": "blocks",
        "file": path.name,
        "layer": [
            {"name": "brick", "material": "brick"},
            {"name": "FELT", "role": "joints"},
            {"name": "ROCK", "role": "ground"},
            {"name": "OTHER", "role": "left-out"},
        ],
    }
    data = {
        "structure": structure,
        "materials": {"brick": {"density": 1000.0}},
        "material": {"density": 2500.0},
        "joints": {"friction": 0.8, "types": [{"joints": ["FELT"], "friction": 0.3}, {"joints": ["BRICK"], "friction": 0.6}]},
        "analysis": {"kind": "tilt"},
    }
    deck = make_deck(data, tmp_path)
    assembly = deck.building.blocks()
    assert assembly.mass.tolist() == [2500.0, 1000.0, 1000.0]
    light = make_deck({**data, "material": {"density": 0.0}}, tmp_path).building.blocks()
    assert light.mass.tolist() == [0.0, 1000.0, 1000.0] and light.inertia[1] == pytest.approx(1000.0 / 6.0)
    names = dict(zip(assembly.joint_names, deck.building.friction().tolist(), strict=True))
    assert sorted(names.values()) == [0.3, 0.6, 0.8]
    assert names[next(n for n in names if n.endswith("the ground"))] == 0.8
    assert run_analyses(Context(deck, threads=1))[0]["collapse_acceleration_g"] == pytest.approx(0.3, abs=1e-6)
    stiff = make_deck({**data, "materials": {"brick": {"density": 1000.0, "young": 5e9}}}, tmp_path).building
    for view in (stiff.rigid, stiff.mesh):
        with pytest.raises(BadGeometry, match=r"\[materials.brick\] gives blocks a different young"):
            view()
    assert deck.building.rigid().mass.sum() == pytest.approx(4500.0)
    with pytest.raises(DeckError, match="material 'brick' does not exist"):
        make_deck({**data, "materials": {}}, tmp_path)
    for change, words in (({"name": "NONE"}, "layer 'NONE' does not exist"), ({"name": "OTHER", "role": "joints"}, "name no joint")):
        wrong = make_deck({**data, "structure": {**structure, "layer": [*structure["layer"][:3], change]}}, tmp_path)
        assert words in run_analyses(Context(wrong, threads=1))[0].reason


def test_georeferenced(tmp_path: Path) -> None:
    far = np.array([431250.0, 5062480.0])
    blocks = [Polygon(b.name, b.points + far) for b in (box("a", 0, 0), box("b", 0, 1))]
    here, there = run({"block": rows(box("a", 0, 0), box("b", 0, 1))}), {"block": rows(*blocks)}
    assert "origin = [431250, 5062480] would move the drawing near" in run(there).reason
    beyond = run({"block": rows(*(Polygon(b.name, b.points + 1e14) for b in blocks))}).reason
    assert "farther than" in beyond and "origin =" not in beyond  # in a file it may be 1e308
    for origin in (far.tolist(), "lower-left"):
        found = run({**there, "origin": origin})
        assert found["collapse_acceleration_g"] == pytest.approx(here["collapse_acceleration_g"], rel=1e-9)
        assert found["joint_p"] == pytest.approx(here["joint_p"], abs=1e-8)
    grounded = run({**there, "origin": "lower-left", "ground": [[*far, far[0] + 1.0, far[1]]]})
    assert grounded["collapse_acceleration_g"] == pytest.approx(here["collapse_acceleration_g"], rel=1e-9)


def test_foundations_at_unlike_levels() -> None:
    """The lowest level alone leaves the higher foundation hanging, which is told; the levels named make supports."""
    portal = rows(box("low", 0, 0, 1, 3), box("high", 3, 1, 1, 2), box("lintel", 0, 3, 4, 0.5))
    hanging = run({"block": portal})
    assert any(
        "horizontal soles of 'high' at y = 1 m have no support. If the ground supports them, give `foundation_levels`" in w
        for w in hanging.warnings
    )
    found = run({"block": portal, "foundation_levels": [0.0, "1 m"]})
    assert found.warnings == [] and len(found["reactions"]) == 2
    # The same with segments of ground.
    same = run({"block": portal, "ground": [[0, 0, 1, 0], [3, 1, 4, 1]]})
    assert found["collapse_acceleration_g"] == pytest.approx(same["collapse_acceleration_g"], rel=1e-9)
    wrong = run({"block": portal, "foundation_levels": [0.5]})
    assert wrong.status == "refused" and "no block has a horizontal sole at 0.5 m; soles are at 0, 1, 3 m" in wrong.reason


# --- assemblies of COMPAS


def compas(old: bool = False, axis: int = 1, skew: float = 0.0) -> dict[str, Any]:
    """Seven voussoirs half a metre deep between two supports, as compas_assembly writes them."""
    arch = make_arch(10.0, 1.5, 157.5, 7)
    outlines = [np.array([arch.p[i], arch.q[i], arch.q[i + 1], arch.p[i + 1]]) for i in range(7)]
    for j, way in ((0, -1.0), (7, 1.0)):
        across = np.array([arch.q[j] - arch.p[j]])[0] @ np.array([[0, 1], [-1, 0]]) * way
        outlines.append(np.array([arch.p[j], arch.q[j], arch.q[j] - across, arch.p[j] - across]))

    def mesh(outline: np.ndarray) -> dict[str, Any]:
        solid = np.zeros((8, 3))
        plane = [k for k in range(3) if k != axis]
        solid[:4, plane], solid[4:, plane] = outline, outline + skew
        solid[4:, axis] = 0.5
        faces = [[0, 1, 2, 3], [7, 6, 5, 4], *([a, (a + 1) % 4, 4 + (a + 1) % 4, 4 + a] for a in range(4))]
        return {
            "vertex": {str(k): dict(zip("xyz", v, strict=True)) for k, v in enumerate(solid.tolist())},
            "face": {str(k): face for k, face in enumerate(faces)},
        }

    def wrapped(sort: str, data: dict[str, Any]) -> dict[str, Any]:
        inner = {"value": {"data": data, "datatype": sort}} if old else {"data": data}
        return {"dtype": f"compas_assembly.datastructures/{sort}", **inner}

    nodes = {str(k): {"block": wrapped("Block", mesh(outline)), "is_support": k >= 7} for k, outline in enumerate(outlines)}
    if old:
        return wrapped("Assembly", {"node": nodes, "edge": {}})
    return wrapped("Assembly", {"graph": {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}})


@pytest.mark.parametrize("options", [{}, {"old": True}, {"axis": 0}])
def test_compas_assemblies(tmp_path: Path, options: dict[str, Any]) -> None:
    (tmp_path / "arch.json").write_text(json.dumps(compas(**options)))
    found = run({"file": "arch.json"}, tmp_path)
    assert found["collapse_acceleration_g"] == pytest.approx(0.3736, abs=5.1e-5)  # straight-sided voussoirs
    assert found["depth_m"] == 0.5 and len(found["reactions"]) == 2


def test_compas_that_is_no_section(tmp_path: Path) -> None:
    (tmp_path / "arch.json").write_text(json.dumps(compas(skew=0.2)))
    found = run({"file": "arch.json"}, tmp_path)  # of no section, the solids are looked at
    assert found.status == "ok" and found["blocks"] == 7
    empty = {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": {"data": {}}}}
    (tmp_path / "arch.json").write_text(json.dumps(empty))
    assert "has no nodes" in run({"file": "arch.json"}, tmp_path).reason
