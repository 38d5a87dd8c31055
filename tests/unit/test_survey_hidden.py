"""Entities that a drawing does not show are no masonry, and are listed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from surveys import SQUARE, run, sketch

from extrados.decks.reader import make_deck
from extrados.model.structures.blocks import Blocks
from extrados.running.check import check_building
from extrados.views.mesh.mesh import element_areas


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
    "entities that the drawing does not display are not read: 1 of layer '0' (reference to another drawing), 7 of layer 'OLD' (frozen), "
    "4 of layer 'SKETCH' (off), 5 of layer 'STONE' (invisible)"
)


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
        (note,) = [note for note in drawing.notes if "does not display are not read" in note]
        assert "(frozen)" not in note and "7 of layer 'STONE' (invisible)" in note


def test_a_drawing_that_shows_nothing_says_why(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        document.layers.add("STONE").freeze()
        space.add_lwpolyline(SQUARE.tolist(), close=True, dxfattribs={"layer": "STONE"})

    path = sketch(tmp_path / "frozen.dxf", draw)
    refused = run({"file": path.name}, tmp_path)
    assert refused.status == "refused" and "does not display are not read: 1 of layer 'STONE' (frozen)" in refused.reason


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
    deck = make_deck(
        {
            "structure": {"kind": "panel", "outline": path.name, "thickness": 0.3},
            "material": {"young": 1e9},
            "analysis": {"kind": "sla", "mesh": {"element": "T3", "size": 0.5}},
        },
        tmp_path,
    )
    mesh = deck.building.mesh(deck.analyses[0].mesh)
    assert sum(element_areas(mesh.xy, g.kind, g.connect).sum() for g in mesh.groups) == pytest.approx(12.0)
    assert any("1 of layer 'GROUND' (frozen), 1 of layer 'OLD' (off)" in w for w in mesh.warnings)
