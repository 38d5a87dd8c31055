"""Surveys as they come: drawings of loose lines, blocks and layers, assemblies of COMPAS, gaps and overlaps."""

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from extrados.analyses.context import Context
from extrados.analyses.run import run_analyses
from extrados.building.building import Building
from extrados.building.geometry.contacts import find_contacts
from extrados.building.geometry.drawing import Drawing, Polygon
from extrados.building.geometry.inspection import inspect
from extrados.building.geometry.linework import net_of
from extrados.building.geometry.polygons import signed_area
from extrados.building.properties import Joints, Material
from extrados.building.templates.arch import make_arch
from extrados.building.templates.blocks import Blocks, assemble, make_blocks
from extrados.cli import app
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.programme import LimitAnalysis
from extrados.results.model import Result

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
    (told,) = apart.warnings
    for words in ("'pier' and 'buttress' are 0.3 mm apart", "x = 1 m", 'contact_tolerance = "0.31 mm" would close it'):
        assert words in told
    mended = run({"block": leaning(3e-4), "contact_tolerance": "0.31 mm"})
    assert mended["collapse_acceleration_g"] == pytest.approx(closed["collapse_acceleration_g"], rel=1e-3)
    assert "closed within contact_tolerance" in mended.warnings[0]
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
    names = dict(zip(assembly.joint_names, deck.building.friction().tolist(), strict=True))
    assert sorted(names.values()) == [0.3, 0.6, 0.8]
    assert names[next(n for n in names if n.endswith("the ground"))] == 0.8
    assert run_analyses(Context(deck, threads=1))[0]["collapse_acceleration_g"] == pytest.approx(0.3, abs=1e-6)
    with pytest.raises(DeckError, match="unknown material 'brick'"):
        make_deck({**data, "materials": {}}, tmp_path)
    for change, words in (
        ({"name": "NONE"}, "no layer 'NONE'"),
        ({"name": "OTHER", "role": "joints"}, "mark no joint"),
    ):
        wrong = make_deck({**data, "structure": {**structure, "layer": [*structure["layer"][:3], change]}}, tmp_path)
        assert words in run_analyses(Context(wrong, threads=1))[0].reason


def test_georeferenced(tmp_path: Path) -> None:
    far = np.array([431250.0, 5062480.0])
    blocks = [Polygon(b.name, b.points + far) for b in (box("a", 0, 0), box("b", 0, 1))]
    here, there = run({"block": rows(box("a", 0, 0), box("b", 0, 1))}), {"block": rows(*blocks)}
    assert "origin = [431250, 5062480] would bring it near" in run(there).reason
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
    for value, words in (
        (compas(skew=0.2), "no prisms across one plane"),
        ({"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": {"data": {}}}}, "without nodes"),
    ):
        (tmp_path / "arch.json").write_text(json.dumps(value))
        assert words in run({"file": "arch.json"}, tmp_path).reason


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


def test_check_makes_buildings_that_are_no_surveys_too(tmp_path: Path) -> None:
    deck = tmp_path / "vault.toml"
    text = '[structure]\nkind = "vault"\npreset = "dejong-a"\n{}[[analysis]]\nkind = "tilt"\n'
    deck.write_text(text.format("buttress_width = 0.1\nface = 30.0\n"))
    found = CliRunner().invoke(app, ["check", str(deck)])
    assert found.exit_code == 2 and "vault.toml: structure: " in found.output
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
