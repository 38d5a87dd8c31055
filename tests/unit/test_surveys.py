"""Surveys as they come: drawings of loose lines, blocks and layers, assemblies of COMPAS, gaps and overlaps."""

import csv
import itertools
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from typer.testing import CliRunner

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.cli import app
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.answer import assess
from extrados.limit.places import place_of
from extrados.limit.programme import LimitAnalysis
from extrados.limit.supports import support_movement
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.contacts import find_contacts
from extrados.model.geometry.drawing import Drawing, Polygon
from extrados.model.geometry.inspection import inspect
from extrados.model.geometry.linework import net_of
from extrados.model.geometry.polygons import inside, signed_area
from extrados.model.properties import Joints, Material
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import Blocks, assemble, make_blocks
from extrados.results.model import Result
from extrados.running.check import check_building
from extrados.show import style
from extrados.views.building import Building
from extrados.views.mesh.mesh import element_areas

ezdxf = pytest.importorskip("ezdxf")

ROOT = Path(__file__).resolve().parents[2]
CHURCH = ROOT / "cases" / "limit" / "church.toml"
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def box(name: str, x: float, y: float, w: float = 1.0, h: float = 1.0) -> Polygon:
    return Polygon(name, SQUARE * [w, h] + [x, y])


def run(structure: dict[str, Any], folder: Path | None = None, **analysis: Any) -> Result:
    deck = make_deck({"structure": {"kind": "blocks", **structure}, "analysis": {"kind": "tilt", **analysis}}, folder)
    return run_analyses(Context(deck, threads=1))[0]


def rows(*blocks: Polygon) -> list[dict[str, Any]]:
    return [{"name": b.name, "points": b.points.tolist()} for b in blocks]


# --- gaps and overlaps


def leaning(gap: float) -> list[dict[str, Any]]:
    """A tall pier beside a buttress, with a gap between."""
    return rows(box("pier", 0.0, 0.0, 1.0, 4.0), box("buttress", 1.0 + gap, 0.0, 0.8, 2.0))


def test_a_gap_changes_no_capacity_in_silence() -> None:
    closed, apart = run({"block": leaning(0.0)}), run({"block": leaning(3e-4)})
    assert closed.warnings == [] and closed["collapse_acceleration_g"] > 1.1 * apart["collapse_acceleration_g"]
    told, both = apart.warnings
    for words in ("'pier' and 'buttress' are 0.3 mm apart", "x = 1 m", 'contact_tolerance = "0.31 mm" would close it'):
        assert words in told
    mended = run({"block": leaning(3e-4), "contact_tolerance": "0.31 mm"})
    assert mended["collapse_acceleration_g"] == pytest.approx(closed["collapse_acceleration_g"], rel=1e-3)
    assert "closed within contact_tolerance" in mended.warnings[0]
    assert f"the collapse acceleration to +x is {mended['collapse_acceleration_g']:.4f} g" in both
    # A mended joint lies midway between the two faces.
    assert mended["joint_p"][:, 0].tolist().count(1.00015) == 1


def test_every_gap_and_overlap_with_the_tolerance_that_mends_it() -> None:
    blocks = [box("a", 0, 0), box("b", 1.0004, 0), box("c", 0, 0.9985, 2.0004, 0.5), box("far", 0, 1.51, 1.0, 0.5)]
    found = inspect(Drawing(blocks), None, 1e-4)
    told = {(found.between(f), f.kind): (f.depth, found.mends(f)) for f in found.flaws}
    assert told["'a' and 'b'", "gap"] == (pytest.approx(4e-4), pytest.approx(4.1e-4))
    assert told["'a' and 'c'", "overlap"] == (pytest.approx(1.5e-3), pytest.approx(1.6e-3))
    assert told["'c' and 'far'", "gap"][0] == pytest.approx(0.0115)  # beyond near misses, but nothing else holds it
    text = " ".join(found.complaints())
    assert "2 overlaps" in text and '"1.6 mm" would close all' in text and "'far'" in text
    # With the tolerance that is named, it is closed.
    assert inspect(Drawing(blocks[:3]), None, 1.6e-3).complaints() == []
    assert inspect(Drawing(blocks), None, 0.012).complaints() == []
    # What no tolerance mends is said so.
    over = inspect(Drawing([box("one", 0, 0), box("two", 0.5, 0.5)]), None, 1e-4)
    assert over.mends(over.of("overlap")[0]) is None and "draw them anew" in over.complaints()[0]


def test_joints_of_faces_that_bend() -> None:
    """A face measured at several points is one joint, however its stretches are ordered; a step in it is not lost."""
    lower = np.array([[0, 0], [3, 0], [3, 1.0], [2, 1.004], [1, 0.997], [0, 1.0]])
    upper = np.array([[0, 1.001], [1.4, 0.999], [3, 1.002], [3, 2], [0, 2]])
    found = find_contacts([lower, upper], np.empty((0, 4)), 6e-3)
    assert len(found.a) == 1 and np.hypot(*(found.q - found.p)[0]) == pytest.approx(3.0, abs=1e-3)
    step = np.array([[0, 0], [2, 0], [2, 1.2], [1, 1.2], [1, 1.0], [0, 1.0]])
    above = np.array([[0, 1.0], [1, 1.0], [1, 1.2], [2, 1.2], [2, 2.0], [0, 2.0]])
    assert len(find_contacts([step, above], np.empty((0, 4)), 1e-4).a) == 3


# --- loose lines


def test_net_of_loose_lines() -> None:
    """Ends that nearly meet, stand on a line, cross or lead nowhere."""
    lines = np.array([
        [0, 0, 2, 0.0005], [2, 0, 2, 1], [2, 1, 0, 1], [0, 1, 0, 0], [1, 0.0003, 1, 0.9996], [0.5, -0.5, 0.5, 1.5],
        [3, 3, 4, 3], [1.5, 0, 1.5, 0.98],
    ])  # fmt: skip
    net = net_of(lines, 1e-3, 0.1)
    areas = sorted(round(signed_area(f), 2) for f in net.faces)
    assert areas == [0.5, 0.5, 1.0]
    gaps = {tuple(np.round(end.place, 3)): end.gap for end in net.loose}
    assert gaps[1.5, 0.98] == pytest.approx(0.02, abs=1e-3)
    assert gaps[3.0, 3.0] is None and (0.5, 1.5) in gaps
    assert len(net_of(lines, 0.025, 0.1).faces) == 4


def sketch(path: Path, draw: Any, unit: int = 6) -> Path:
    document = ezdxf.new("R2010", units=unit)
    draw(document, document.modelspace())
    document.saveas(path)
    return path


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
    assert any("7 blocks joined from 10 loose lines" in w for w in found.warnings)
    assert any("1 of text" in w for w in found.warnings)
    refused = run({"file": path.name}, tmp_path)
    assert refused.status == "refused" and "2 mm apart" in refused.reason and "join_tolerance" in refused.reason


def test_a_line_that_closes_no_stone_is_told(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        space.add_lwpolyline((SQUARE * [2, 1]).tolist(), close=True)
        space.add_lwpolyline([(0, 1), (0, 2), (2, 2), (2, 1.004)])  # a stone upon it that is 4 mm open

    path = sketch(tmp_path / "open.dxf", draw)
    (told,) = (w for w in run({"file": path.name}, tmp_path).warnings if "nowhere" in w)
    assert "1 end of loose lines leads nowhere" in told
    assert "4 mm from the next line (see join_tolerance)" in told
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
    assert "lies within more than 16 others, or in itself" in run({"file": path.name}, tmp_path).reason


@pytest.mark.parametrize("grid", [False, True])
def test_references_to_blocks_are_counted_before_they_are_put_in_their_places(
    tmp_path: Path, monkeypatch, grid
) -> None:
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
    monkeypatch.setattr(
        "ezdxf.entities.Insert.virtual_entities", lambda *_: pytest.fail("they were put in their places")
    )
    assert "more than 200,000 entities, those of its references" in run({"file": "many.dxf"}, tmp_path).reason


def test_layers_for_material_friction_and_supports(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        for k, layer in enumerate(("STONE", "BRICK", "BRICK")):
            space.add_lwpolyline((SQUARE + np.array([0, k])).tolist(), close=True, dxfattribs={"layer": layer})
        space.add_lwpolyline((SQUARE + np.array([5, 0])).tolist(), close=True, dxfattribs={"layer": "OTHER"})
        space.add_line((0.1, 1.0), (0.9, 1.0), dxfattribs={"layer": "FELT"})
        space.add_line((-1, 0), (2, 0), dxfattribs={"layer": "ROCK"})

    path = sketch(tmp_path / "layers.dxf", draw)
    structure = {
        "kind": "blocks", "file": path.name,
        "layer": [
            {"name": "brick", "material": "brick"}, {"name": "FELT", "role": "joints"}, {"name": "ROCK", "role": "ground"},
            {"name": "OTHER", "role": "left-out"},
        ],
    }  # fmt: skip
    data = {
        "structure": structure, "materials": {"brick": {"density": 1000.0}}, "material": {"density": 2500.0},
        "joints": {"friction": 0.8, "types": [{"joints": ["FELT"], "friction": 0.3}, {"joints": ["BRICK"], "friction": 0.6}]},
        "analysis": {"kind": "tilt"},
    }  # fmt: skip
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
        with pytest.raises(BadGeometry, match=r"\[materials.brick\] gives stones another young"):
            view()
    assert deck.building.rigid().mass.sum() == pytest.approx(4500.0)
    with pytest.raises(DeckError, match="unknown material 'brick'"):
        make_deck({**data, "materials": {}}, tmp_path)
    for change, words in (
        ({"name": "NONE"}, "no layer 'NONE'"),
        ({"name": "OTHER", "role": "joints"}, "mark no joint"),
    ):
        wrong = make_deck({**data, "structure": {**structure, "layer": [*structure["layer"][:3], change]}}, tmp_path)
        assert words in run_analyses(Context(wrong, threads=1))[0].reason


def hidden(document: Any, space: Any) -> None:
    """A pier of two stones, and all ways of not showing a third."""
    layers = document.layers
    for name in ("STONE", "OLD", "SKETCH", "VIEW"):
        layers.add(name)
    layers.get("OLD").freeze()
    layers.get("SKETCH").off()
    layers.get("VIEW").dxf.flags |= 2  # frozen in new viewports, which hides nothing here

    def stone(place: Any, x: float, y: float, **attributes: Any) -> None:
        place.add_lwpolyline((SQUARE + np.array([x, y])).tolist(), close=True, dxfattribs=attributes)

    stone(space, 0, 0, layer="STONE")
    stone(space, 0, 1, layer="view")
    stone(space, 0, 2, layer="old")
    stone(space, 1, 0, layer="Sketch")
    stone(space, 1, 0, layer="SKETCH")
    stone(space, 0, 2, layer="STONE", invisible=1)
    space.add_lwpolyline([(0, 2), (1, 3)], dxfattribs={"layer": "OLD"})
    mixed = document.blocks.new("MIXED")
    stone(mixed, 0, 0, layer="0")
    stone(mixed, 1, 0, layer="OLD")
    stone(mixed, 2, 0, layer="STONE", invisible=1)
    space.add_blockref("MIXED", (4, 0), dxfattribs={"layer": "STONE"})  # shows its first stone alone
    space.add_blockref("MIXED", (8, 0), dxfattribs={"layer": "OLD"})  # shows nothing
    space.add_blockref("MIXED", (12, 0), dxfattribs={"layer": "STONE", "invisible": 1})
    space.add_blockref("MIXED", (16, 0), dxfattribs={"layer": "SKETCH"})  # its first stone lies on that layer
    own = document.blocks.new("OWN")
    stone(own, 0, 0, layer="STONE")
    space.add_blockref("OWN", (20, 0), dxfattribs={"layer": "SKETCH"})  # which hides no stone of another layer
    outer = document.blocks.new("OUTER")
    outer.add_blockref("MIXED", (0, 0), dxfattribs={"layer": "0"})
    space.add_blockref("OUTER", (24, 0), dxfattribs={"layer": "OLD"})
    space.add_blockref("OUTER", (24, 0), dxfattribs={"layer": "STONE"})
    document.blocks.new("ELSEWHERE", dxfattribs={"flags": 4, "xref_path": "site.dxf"})
    space.add_blockref("ELSEWHERE", (0, 0))
    space.add_3dface([(0, 0), (1, 0), (1, 1)], dxfattribs={"layer": "SKETCH"})  # no line, and refused where it is shown


HIDDEN = (
    "not read, since the drawing does not show it: 1 of layer '0' (reference to another drawing), 7 of layer 'OLD' (frozen), "
    "4 of layer 'SKETCH' (off), 5 of layer 'STONE' (invisible)"
)  # fmt: skip


def test_what_a_drawing_does_not_show_is_no_masonry(tmp_path: Path) -> None:
    path = sketch(tmp_path / "hidden.dxf", hidden)
    drawing, _ = Blocks(kind="blocks", file=path.name)._drawing(tmp_path)
    places = sorted(tuple(p.points.min(axis=0).round(6)) for p in drawing.blocks)
    assert places == [(0.0, 0.0), (0.0, 1.0), (4.0, 0.0), (20.0, 0.0), (24.0, 0.0)]
    assert [note for note in drawing.notes if "not read" in note] == [f"hidden.dxf: {HIDDEN}"]
    found = run({"file": path.name}, tmp_path)
    assert found.status == "ok" and len(found["centroid"]) == 5 and any(HIDDEN in w for w in found.warnings)
    deck = make_deck({"structure": {"kind": "blocks", "file": path.name}, "analysis": {"kind": "tilt"}}, tmp_path)
    assert any(HIDDEN in note for note in check_building(deck).notes)
    assert any(HIDDEN in w for w in run({"file": path.name}, tmp_path, direction=0.0).warnings)


def test_a_hidden_layer_that_the_deck_names_is_read(tmp_path: Path) -> None:
    """What is invisible by itself stays so."""
    path = sketch(tmp_path / "hidden.dxf", hidden)
    for keys in ({"layers": ["STONE", "VIEW", "OLD"]}, {"layer": [{"name": "OLD", "role": "stones"}]}):
        drawing, _ = Blocks(kind="blocks", file=path.name, **keys)._drawing(tmp_path)
        assert sum(p.layer.upper() == "OLD" for p in drawing.blocks) >= 3
        (note,) = [note for note in drawing.notes if "not read" in note]
        assert "(frozen)" not in note and "7 of layer 'STONE' (invisible)" in note


def test_a_drawing_that_shows_nothing_says_why(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        document.layers.add("STONE").freeze()
        space.add_lwpolyline(SQUARE.tolist(), close=True, dxfattribs={"layer": "STONE"})

    path = sketch(tmp_path / "frozen.dxf", draw)
    refused = run({"file": path.name}, tmp_path)
    assert refused.status == "refused" and "does not show it: 1 of layer 'STONE' (frozen)" in refused.reason


def test_hidden_ground_and_an_outline_with_a_hidden_opening(tmp_path: Path) -> None:
    """Ground on a frozen layer is no ground; a panel drawn as DXF has no opening where the drawing shows none."""

    def draw(document: Any, space: Any) -> None:
        document.layers.add("GROUND").freeze()
        document.layers.add("OLD").off()
        space.add_lwpolyline((SQUARE * [4, 3]).tolist(), close=True)
        space.add_lwpolyline((SQUARE + np.array([1, 1])).tolist(), close=True, dxfattribs={"layer": "OLD"})
        space.add_line((-1, 0), (1, 0), dxfattribs={"layer": "GROUND"})

    path = sketch(tmp_path / "panel.dxf", draw)
    drawing, _ = Blocks(kind="blocks", file=path.name)._drawing(tmp_path)
    assert len(drawing.blocks) == 1 and drawing.ground is None
    deck = make_deck({
        "structure": {"kind": "panel", "outline": path.name, "thickness": 0.3}, "material": {"young": 1e9},
        "analysis": {"kind": "sla", "mesh": {"element": "T3", "size": 0.5}},
    }, tmp_path)  # fmt: skip
    mesh = deck.building.mesh(deck.analyses[0].mesh)
    assert sum(element_areas(mesh.xy, g.kind, g.connect).sum() for g in mesh.groups) == pytest.approx(12.0)
    assert any("1 of layer 'GROUND' (frozen), 1 of layer 'OLD' (off)" in w for w in mesh.warnings)


def test_georeferenced(tmp_path: Path) -> None:
    far = np.array([431250.0, 5062480.0])
    blocks = [Polygon(b.name, b.points + far) for b in (box("a", 0, 0), box("b", 0, 1))]
    here, there = run({"block": rows(box("a", 0, 0), box("b", 0, 1))}), {"block": rows(*blocks)}
    assert "origin = [431250, 5062480] would bring it near" in run(there).reason
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
    assert any("level soles of 'high' at y = 1 m: foundation_levels" in w for w in hanging.warnings)
    found = run({"block": portal, "foundation_levels": [0.0, "1 m"]})
    assert found.warnings == [] and len(found["reactions"]) == 2
    # The same with segments of ground.
    same = run({"block": portal, "ground": [[0, 0, 1, 0], [3, 1, 4, 1]]})
    assert found["collapse_acceleration_g"] == pytest.approx(same["collapse_acceleration_g"], rel=1e-9)
    wrong = run({"block": portal, "foundation_levels": [0.5]})
    assert (
        wrong.status == "refused" and "no stone has a level sole at 0.5 m; there are soles at 0, 1, 3 m" in wrong.reason
    )


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

    nodes = {
        str(k): {"block": wrapped("Block", mesh(outline)), "is_support": k >= 7} for k, outline in enumerate(outlines)
    }
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
    assert "without nodes" in run({"file": "arch.json"}, tmp_path).reason


# --- the church, and `check`


@pytest.fixture(scope="module")
def church() -> Result:
    from extrados.decks.reader import read_deck

    deck = read_deck(CHURCH)
    data = {**deck.data, "analysis": {"kind": "tilt"}}
    return run_analyses(Context(make_deck(data, deck.folder), threads=1))[0]


def test_a_church_as_surveyed(church: Result) -> None:
    """125 stones in one try; what is measured of them bears what the true stones bear, within a tenth."""
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import draw_church
    finally:
        sys.path.remove(str(ROOT / "tools"))
    true = [
        Polygon(f"{layer} {k}", outline, 1900.0 if "BUTTRESS" in layer else 2300.0)
        for layer, outlines in draw_church.church().items()
        for k, outline in enumerate(outlines)
    ]
    exact = assemble(inspect(Drawing(true), None, 1e-6, [0.0, 0.4, -0.6]), 2300.0, 1.0)
    assert church.status == "ok" and len(church["centroid"]) == len(true) == 125
    assert len(church["joint_p"]) == len(exact.a)
    limit = LimitAnalysis(exact, 0.7)
    for direction, key in ((1, "collapse_acceleration_g"), (-1, "collapse_acceleration_opposite_g")):
        assert church[key] == pytest.approx(direction * limit.collapse(direction)[0].gamma, rel=0.1)
    assert church["weight_N"] == pytest.approx(float(exact.mass.sum()) * 9.80665, rel=2e-3)


def test_the_drawing_of_the_church_is_what_its_script_draws(tmp_path: Path) -> None:
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import draw_church
    finally:
        sys.path.remove(str(ROOT / "tools"))
    assert draw_church.draw(tmp_path / "church.dxf") == 125
    shipped, drawn = (
        Blocks(kind="blocks", file="church.dxf", origin=[431250.0, 5062480.0], join_tolerance=8e-3, contact_tolerance=6e-3)
        .assembly(2300.0, folder)
        for folder in (CHURCH.parent, tmp_path)
    )  # fmt: skip
    assert shipped.p == pytest.approx(drawn.p, abs=1e-9) and shipped.mass == pytest.approx(drawn.mass, rel=1e-9)


def test_check_lists_and_draws_what_run_refuses(tmp_path: Path) -> None:
    deck = tmp_path / "church.toml"
    deck.write_text(CHURCH.read_text().replace('"6 mm"', '"3 mm"'))
    (tmp_path / "church.dxf").write_bytes((CHURCH.parent / "church.dxf").read_bytes())
    found = CliRunner().invoke(app, ["check", str(deck), "--out", str(tmp_path / "seen")])
    assert found.exit_code == 2 and "overlaps" in found.output and "would close all" in found.output
    assert (tmp_path / "seen" / "geometry.png").stat().st_size > 10_000
    with (tmp_path / "seen" / "geometry.csv").open() as stream:
        listed = list(csv.DictReader(stream))
    assert [r["status"] for r in listed] == sorted(
        (r["status"] for r in listed), key=["overlap", "open", "closed"].index
    )
    deepest = max(float(r["depth_mm"]) for r in listed)
    assert 4.0 < deepest < 6.0
    good = CliRunner().invoke(app, ["check", str(CHURCH), "--out", str(tmp_path / "good")])
    assert good.exit_code == 0 and "0 places amiss" in good.output and good.output.rstrip().endswith("ok")


def test_a_crowd_of_blocks_in_one_place_is_refused_with_the_bound(tmp_path: Path) -> None:
    """Not looked at pair by pair: half a million of them would take a minute."""
    box = [[0, 0], [1, 0], [1, 1], [0, 1]]
    blocks = [{"name": f"b{k}", "points": box} for k in range(1000)]
    (tmp_path / "b.json").write_text(json.dumps({"blocks": blocks}))
    with pytest.raises(BadGeometry, match=r"1000 outlines.*more than 100,000 pairs"):
        Blocks(kind="blocks", file="b.json").assembly(2300.0, tmp_path)
    (tmp_path / "b.json").write_text(json.dumps({"blocks": blocks[:3]}))
    with pytest.raises(BadGeometry, match="3 overlaps: 'b0' and 'b1' overlap by 500 mm"):
        Blocks(kind="blocks", file="b.json").assembly(2300.0, tmp_path)


def test_lines_drawn_many_times_are_one() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.3, 1.0], [0.1, 1.1]])
    once = np.column_stack([corners, np.roll(corners, -1, axis=0)])
    many = np.concatenate([once, once[[1, 1, 2]], *(once[:, [2, 3, 0, 1]] for _ in range(2000))])
    net = net_of(many, 1e-3, 1e-2)
    assert len(net.faces) == 1 and not net.loose
    np.testing.assert_array_equal(net.faces[0], net_of(once, 1e-3, 1e-2).faces[0])
    assert set(net.source[0].tolist()) == {0, 1, 2, 3}
    # drawn twice, a line weighs no more where its end meets another's; it is firm where one of the two is
    bent = once.copy()
    bent[0, 3] += 4e-4
    twice = np.concatenate([bent, bent[:1]])
    np.testing.assert_array_equal(net_of(twice, 1e-3, 1e-2).faces[0], net_of(bent, 1e-3, 1e-2).faces[0])
    firm = np.array([False, False, False, False, True])
    assert net_of(twice, 1e-3, 1e-2, firm).faces[0][1] == pytest.approx([1.0, 4e-4], abs=1e-6)


def test_check_leaves_the_files_of_others(tmp_path: Path) -> None:
    """What extrados did not write, or what was changed since, stays; what it wrote is replaced."""
    out = tmp_path / "mine"
    out.mkdir()
    (out / "geometry.png").write_text("my own picture")
    words = ["check", str(CHURCH), "--out", str(out)]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert (out / "geometry.png").read_text() == "my own picture" and (out / "geometry-2.png").exists()
    with (out / "geometry.csv").open("a") as stream:
        stream.write("a remark of mine\n")
    (out / "geometry.png").unlink()
    found = CliRunner().invoke(app, words)
    assert found.exit_code == 0 and "geometry-2.csv" in found.output
    assert (out / "geometry.csv").read_text().endswith("a remark of mine\n")
    assert sorted(p.name for p in out.glob("geometry*")) == [
        "geometry-2.csv", "geometry.csv", "geometry.png", "geometry.svg",
    ]  # fmt: skip
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine"]


def test_check_makes_buildings_that_are_no_surveys_too(tmp_path: Path) -> None:
    deck = tmp_path / "vault.toml"
    text = '[structure]\nkind = "vault"\npreset = "dejong-a"\n{}[[analysis]]\nkind = "tilt"\n'
    deck.write_text(text.format("buttress_width = 0.1\nface = 30.0\n"))
    found = CliRunner().invoke(app, ["check", str(deck)])
    assert found.exit_code == 2 and "vault.toml:1: structure: buttress: " in found.output
    deck.write_text(text.format("") + '[[joints.types]]\njoints = ["none"]\nfriction = 0.3\n')
    found = CliRunner().invoke(app, ["check", str(deck)])
    assert found.exit_code == 2 and "names no joint 'none'" in found.output


def test_joint_types_of_layers_reach_every_strategy() -> None:
    blocks = [
        Polygon("a", SQUARE, layer="L"),
        Polygon("b", SQUARE + np.array([0, 1]), layer="L"),
        Polygon("c", SQUARE + np.array([0, 2])),
    ]
    made = assemble(inspect(Drawing(blocks), None, 1e-4), 2000.0, 1.0)
    assert {name: [made.joint_names[j] for j in joints] for name, joints in made.groups.items()} == {"L": ["a on b"]}
    assert make_blocks(blocks, None).groups == made.groups
    assert isinstance(Building(None, Material(), joints=Joints()), Building)


# --- the thrust line through every stone, places in words, letters


def test_the_line_runs_through_every_stone(church: Result) -> None:
    """Every stone of the church has a piece of it, or is a voussoir of a chain that has; all of it lies in the stones."""
    start, of, points = (church[f"collapse_line{end}"] for end in ("_start", "_of", ""))
    outline, edge = church["outline"], church["outline_start"]
    stones = [outline[a:b] for a, b in itertools.pairwise(edge)]
    grown = [o + 0.02 * (o - o.mean(axis=0)) / np.hypot(*(o - o.mean(axis=0)).T)[:, None] for o in stones]
    assert all(any(inside(o, p[None])[0] for o in grown) for p in points)
    through = set()
    for a, b, _ in zip(start[:-1], start[1:], of, strict=True):
        middles = 0.5 * (points[a : b - 1] + points[a + 1 : b])
        through |= {k for k, o in enumerate(grown) for m in middles if inside(o, m[None])[0]}
    assert len(through) == 125
    assert len(church["collapse_line_force"]) == len(of) and church["collapse_line_force"].min() > 0.0


def test_lines_of_two_arches_meet_on_their_pier() -> None:
    answer = assess(make_aisled("vezelay-like"))
    state = answer.collapse_state
    pieces = [p for p in answer.lines(state) if p.name == "right pier"]
    trunk = max(pieces, key=lambda p: p.force)
    branch = next(p for p in pieces if p is not trunk)
    assert len(trunk.points) > 10 and (np.hypot(*(trunk.points - branch.points[-1]).T) < 1e-9).any()
    # Below the meeting the trunk carries both arches and the pier: at its foot it meets the base where the state says.
    block = answer.assembly.block_names.index("right pier")
    base = next(j for j in answer.assembly.joints_of(block) if GROUND in (answer.assembly.a[j], answer.assembly.b[j]))
    assert trunk.points[-1] == pytest.approx(state.points(answer.assembly)[base])


def make_aisled(preset: str):
    return make_deck(
        {"structure": {"kind": "aisled-vault", "preset": preset}, "analysis": {"kind": "tilt"}}
    ).building.blocks()


def test_a_stone_with_several_joints_shares_its_line() -> None:
    """A lintel stone on two others: the branches meet at the mean of their forces, and these balance the stone."""
    made = make_blocks([box("a", 0, 0), box("b", 2, 0), box("c", 0, 1, 3, 0.5), box("d", 1, 1.5, 1, 1)], None)
    answer = assess(made, 0.7)
    lines = {}
    for piece in answer.lines(answer.central):
        lines.setdefault(piece.name, []).append(piece)
    ends = {tuple(p.points[-1].round(9)) for p in lines["c"]}
    assert len(lines["c"]) == 3 and len(ends) == 1
    assert lines["d"][0].points[0] == pytest.approx([1.5, 2.0])  # the load of the topmost comes from its centroid
    assert lines["d"][0].force == pytest.approx(2000.0 * 9.80665)


def test_hinges_are_named_by_their_place(church: Result) -> None:
    places = [h.place for h in church["hinges"]]
    assert places[1] == "crown of chain 3, extrados"
    assert places[0].startswith("left haunch of chain 3 at ") and places[0].endswith("intrados")
    assert any(p.startswith("bed joint under ASHLAR #") and p.endswith("right edge") for p in places)
    assert "crown of chain 3, extrados" in church.answer and "right edge (x = 4." in church.answer
    one = run({"block": rows(box("pier", 0, 0, 1, 4))})
    assert [h.place for h in one["hinges"]] == ["foot of pier, right edge"]
    assert [h.place for h in one["hinges_opposite"]] == ["foot of pier, left edge"]
    arch = make_arch(10.0, 1.5, 157.5, 7)
    assert place_of(arch, 0, arch.p[0]) == "left springing of the arch, intrados"
    assert place_of(arch, 7, arch.q[7]) == "right springing of the arch, extrados"
    assert place_of(arch, 2, arch.p[2]).startswith("left haunch of the arch at ")


def test_letters_do_not_collide(tmp_path: Path) -> None:
    """Twelve hinges within a few millimetres of paper: no letter hides another, or the place of another."""
    random = np.random.default_rng(3)
    points = random.uniform(0.0, 0.3, (12, 2))
    with style.figure(5.0, 4.0) as (fig, (ax,)):
        ax.plot([-5, 5], [-5, 5])
        style.draw_hinges(ax, points, [chr(65 + k) for k in range(12)])
        style.save(fig, tmp_path, "letters")
        boxes = [t.get_window_extent(FigureCanvasAgg(fig).get_renderer()) for t in ax.texts]
        places = ax.transData.transform(points)
    for k, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[k + 1 :])
        assert not any(one.contains(*place) for place in places)


# --- imperfect geometry


def test_random_surveys_give_a_band() -> None:
    """A block bears width over height; surveys within d of it differ by at most what the corners can do."""
    block = rows(box("block", 0, 0, 1.0, 4.0))
    found = run({"block": block}, kind="imperfections", deviation="10 mm", count=300)
    assert found["given_collapse_acceleration_g"] == pytest.approx(0.25)
    low, median, high = (found[f"{word}_collapse_acceleration_g"] for word in ("low", "median", "high"))
    assert 0.25 - 0.0075 < found["least_collapse_acceleration_g"] < low < median < high < 0.25 + 0.0025
    assert high - low > 0.001 and found["cannot_stand"] == 0 and found["gamma"].shape == (300, 2)
    again = run({"block": block}, kind="imperfections", deviation="10 mm", count=300)
    other = run({"block": block}, kind="imperfections", deviation="10 mm", count=300, seed=2)
    assert (found["gamma"] == again["gamma"]).all() and (found["gamma"] != other["gamma"]).all()
    small = run({"block": block}, kind="imperfections", deviation="0.1 mm", count=50)
    assert small["high_collapse_acceleration_g"] - small["low_collapse_acceleration_g"] < 0.02 * (high - low)
    # Without one given it is the contact tolerance; other structures must be told.
    assert run({"block": block}, kind="imperfections", count=10)["deviation_m"] == 1e-4
    arch = make_deck({
        "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 150.0, "voussoirs": 9},
        "analysis": {"kind": "imperfections"},
    })  # fmt: skip
    assert "give the deviation" in run_analyses(Context(arch, threads=1))[0].reason
    assert (
        "a quarter of the shortest joint" in run({"block": block}, kind="imperfections", deviation=0.3, count=10).reason
    )


def test_surveys_that_cannot_stand_belong_to_the_band() -> None:
    """An arch near its least thickness: some surveys fall, and count as nothing borne."""
    arch = make_deck({
        "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.09, "embrace": 180.0, "voussoirs": 36},
        "joints": {"friction": "no-sliding"}, "analysis": {"kind": "imperfections", "deviation": "60 mm", "count": 60},
    })  # fmt: skip
    found = run_analyses(Context(arch, threads=1))[0]
    assert 0 < found["cannot_stand"] < 60 and found["least_collapse_acceleration_g"] == 0.0
    assert found["cannot_stand"] == int(np.isnan(found["gamma"]).any(axis=1).sum())


def test_supports_of_free_blocks_move() -> None:
    """Voussoirs as polygons in any order and sense follow their support as the arch of the same stones does."""
    arch = make_arch(10.0, 1.5, 157.5, 7)
    stones = [Polygon(f"s{i}", np.array([arch.p[i], arch.q[i], arch.q[i + 1], arch.p[i + 1]])) for i in range(7)]
    ground = [[*arch.p[0], *arch.q[0]], [*arch.q[7], *arch.p[7]]]
    found = run({"block": rows(*stones), "ground": ground}, kind="supports")
    shuffled = [stones[i] for i in (3, 6, 0, 5, 1, 4, 2)]
    again = run(
        {"block": rows(*(Polygon(s.name, s.points[::-1]) for s in shuffled)), "ground": ground}, kind="supports"
    )
    assert again["movement_at_fall_m"] == pytest.approx(found["movement_at_fall_m"], rel=1e-6)
    assert [h.joint for h in again["hinges_at_rest"]] == [h.joint for h in found["hinges_at_rest"]]
    made = make_blocks(stones, np.array(ground))
    exact = support_movement(
        replace(arch, mass=made.mass, centroid=made.centroid, inertia=made.inertia), (1.0, 0.0), 200
    )  # fmt: skip
    assert found["movement_at_fall_m"] == pytest.approx(exact[-1].movement, rel=1e-6)
    assert "left haunch of the chain at 8 % of the span, intrados; crown of the chain, extrados" in found.answer
    pier = run({"block": rows(box("a", 0, 0), box("b", 0, 1))}, kind="supports")
    assert pier.status == "refused" and "it stands on one support" in pier.reason
