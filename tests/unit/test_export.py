"""What other programs are handed: read back by extrados, by COMPAS and OpenSees where they are installed."""

import itertools
import json
import math
import re
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados
from extrados.bridges import compas
from extrados.decks.reader import Deck
from extrados.model.geometry.polygons import properties
from extrados.model.geometry.solids.polyhedra import moments

ARCH = extrados.Arch(radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7)
DECK = extrados.deck(ARCH, extrados.Tilt(), title='An "arch"')
BLOCK = extrados.deck(extrados.Block(width=1.0, height=4.0), extrados.Rocking(), motion=extrados.StepPulse(amplitude="0.5 g", duration=0.2))


PLANE = {
    "arch": (ARCH, 2e-3),  # COMPAS has chords for arcs
    "column": (extrados.Column(width=1.0, height=3.0, drums=3), 1e-9),
    "bond": ({"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 3, "courses": 4}, 1e-7),
}
SPACE: dict[str, dict[str, Any]] = {
    "cross-vault": {"kind": "cross-vault", "radius": 3.0, "thickness": 0.4, "embrace": 150.0, "voussoirs": 16, "stone_length": 0.9},
    "oblong bay": {"kind": "cross-vault", "radius": 3.0, "thickness": 0.5, "embrace": 140.0, "voussoirs": 8, "oblong": 1.4},
    "dome": {"kind": "dome", "radius": 5.0, "thickness": 0.6, "embrace": 170.0, "rings": 4, "lunes": 8, "oculus": 30.0},
    "dome in bond": {"kind": "dome", "radius": 5.0, "thickness": 0.6, "rings": 5, "lunes": 8, "bond": "running"},
    "corner": {
        "kind": "wall",
        "unit_length": 0.5,
        "unit_height": 0.25,
        "thickness": 0.25,
        "height": 1.0,
        "legs": [{"length": 1.75}, {"length": 1.75}],
    },
    "fluted drums": {"kind": "column", "section": "round", "width": 1.0, "height": 4.0, "drums": 4, "sides": 12, "flute_depth": 0.03},
}


def space(name: str) -> Deck:
    return extrados.deck(SPACE[name], extrados.Tilt(direction=20.0, starts=1), joints={"friction": 0.7})


@pytest.mark.parametrize("name", PLANE)
def test_compas_is_read_back_with_the_same_capacity(name: str, tmp_path: Path) -> None:
    stones, within = PLANE[name]
    extrados.export(extrados.deck(stones, extrados.Tilt()), "compas", tmp_path / "stones.json")
    blocks = extrados.Blocks(file="stones.json")
    back = extrados.run(extrados.deck(blocks, extrados.Tilt(), folder=tmp_path))["tilt"]
    there = extrados.run(extrados.deck(stones, extrados.Tilt()))["tilt"]
    assert back.collapse_acceleration_g == pytest.approx(there.collapse_acceleration_g, rel=within)
    assert back.weight_N == pytest.approx(there.weight_N, rel=within)
    assert extrados.export(DECK, "compas") == extrados.export(DECK, "compas")


@pytest.mark.parametrize("name", SPACE)
def test_compas_in_space_is_read_back_with_the_same_capacity(name: str, tmp_path: Path) -> None:
    """Stones of several convex parts among them: 104 of a cross-vault came back as 136, .6961 g as .4914 g."""
    deck = space(name)
    extrados.export(deck, "compas", tmp_path / "stones.json")
    tables = {"joints": {"friction": 0.7}, "folder": tmp_path}
    back = extrados.deck(extrados.Blocks(file="stones.json"), extrados.Tilt(direction=20.0, starts=1), **tables)
    one, two = deck.building.solids(), back.building.solids()
    assert len(two.parts) == len(one.parts) and len(two.a) == len(one.a)
    assert two.mass == pytest.approx(one.mass, rel=1e-12)
    assert two.centroid == pytest.approx(one.centroid, abs=1e-12)
    assert two.inertia == pytest.approx(one.inertia, rel=1e-9, abs=1e-9)
    there, here = (extrados.run(which)["tilt"] for which in (deck, back))
    assert here.blocks == there.blocks == len(one.mass)
    assert here.collapse_acceleration_g == pytest.approx(there.collapse_acceleration_g, rel=1e-7)


def test_concave_stones_of_a_section_are_read_back_in_space(tmp_path: Path) -> None:
    """The mesh of such a stone is one concave prism; a pier leans on it and is pushed in the plane and across it."""
    ell = {"points": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]}
    stones = {"kind": "blocks", "block": [ell, {"points": [[1, 1], [1.6, 1], [1.6, 3], [1, 3]]}], "depth": 0.8}
    extrados.export(extrados.deck(stones, extrados.Tilt()), "compas", tmp_path / "ell.json")
    for direction in (0.0, 90.0, 180.0):
        there = extrados.run(extrados.deck(stones, extrados.Tilt(direction=direction)))["tilt"]
        back = extrados.deck(extrados.Blocks(file="ell.json"), extrados.Tilt(direction=direction), folder=tmp_path)
        here = extrados.run(back)["tilt"]
        assert here.collapse_acceleration_g == pytest.approx(there.collapse_acceleration_g, rel=1e-7)
        assert here.weight_N == pytest.approx(there.weight_N, rel=1e-9)


def test_what_is_no_geometry_is_said_to_stay_behind(caplog: pytest.LogCaptureFixture) -> None:
    drums = {"kind": "column", "section": "round", "width": 1.0, "height": 3.0, "drums": 3, "dowels": 500.0}
    tied = extrados.deck(structure=ARCH, ties=[TIE], analysis=extrados.Tilt())
    for deck, words in ((extrados.deck(drums, extrados.Tilt()), "Not exported: dowels"), (tied, "Not exported: [[ties]]")):
        for form in ("compas", "udec" if deck is tied else "3dec"):
            caplog.clear()
            extrados.export(deck, form)
            assert words in caplog.text and form in caplog.text
    caplog.clear()
    extrados.export(DECK, "compas")
    assert caplog.text == ""


def test_what_somebody_else_wrote_stays(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    place = tmp_path / "stones.json"
    place.write_text("mine")
    text = extrados.export(DECK, "compas", place)
    assert place.read_text() == "mine" and (tmp_path / "stones-2.json").read_text() == text
    assert "stones-2.json" in caplog.text


def test_compas_loads_it(tmp_path: Path) -> None:
    reader = pytest.importorskip("compas")
    pytest.importorskip("compas_assembly")
    extrados.export(DECK, "compas", tmp_path / "arch.json")
    assembly = reader.json_load(tmp_path / "arch.json")
    blocks = [assembly.node_block(node) for node in assembly.nodes()]
    supports = [node for node in assembly.nodes() if assembly.graph.node_attribute(node, "is_support")]
    assert len(blocks) == 9 and len(supports) == 2
    volume = sum(block.volume() for block in blocks[:7])
    assert volume == pytest.approx(DECK.building.blocks().mass.sum() / 2000.0, rel=2e-2)  # arcs are drawn by chords


def test_udec_has_a_polygon_for_every_stone() -> None:
    lines = extrados.export(DECK, "udec").splitlines()
    polygons = [line for line in lines if line.startswith("block create polygon ")]
    assert "model new" in lines and len(polygons) == 7
    outlines = DECK.building.blocks().outlines
    for line, outline in zip(polygons, outlines, strict=True):
        found = np.array([[float(v) for v in pair.split(",")] for pair in line.split()[3:]])
        assert np.allclose(found, outline, atol=1e-7)


def test_udec_has_stones_of_the_area_and_centroid_of_the_section() -> None:
    assembly = DECK.building.blocks()
    lines = [x for x in extrados.export(DECK, "udec").splitlines() if x.startswith("block create polygon ")]
    for line, mass, centroid in zip(lines, assembly.mass, assembly.centroid, strict=True):
        area, middle, _ = properties(np.array([[float(v) for v in pair.split(",")] for pair in line.split()[3:]]))
        assert 2000.0 * area == pytest.approx(mass, rel=5e-3)  # arcs are drawn by chords
        assert middle == pytest.approx(centroid, abs=0.02)


@pytest.mark.parametrize("name", SPACE)
def test_3dec_has_closed_bodies_of_the_volume_and_centroid_of_the_stones(name: str) -> None:
    """Faces clockwise from outside: turned around they enclose the volume; every edge is passed once each way. Parts of one stone are
    joined."""
    deck = space(name)
    text = extrados.export(deck, "3dec")
    solids = deck.building.solids()
    bodies = re.findall(r"^block create group '([^']*)' poly (.*)$", text, re.M)
    assert [name for name, _ in bodies] == [solids.block_names[k] for k in solids.owner]
    mass, moment = np.zeros(len(solids.mass)), np.zeros((len(solids.mass), 3))
    for (_, faces), owner in zip(bodies, solids.owner, strict=True):
        rings = [tuple(corner.split()) for corner in faces.removeprefix("face ").split(" face ")]
        edges = [edge for ring in rings for edge in itertools.pairwise((*ring, ring[0]))]
        assert len(set(edges)) == len(edges) and all((b, a) in edges for a, b in edges)
        names = sorted({corner for ring in rings for corner in ring})
        places = np.array([[float(v) for v in name.split(",")] for name in names])
        fans = [(ring[0], ring[k + 1], ring[k]) for ring in rings for k in range(1, len(ring) - 1)]
        volume, middle, _ = moments(places, np.array([[names.index(corner) for corner in fan] for fan in fans]))
        mass[owner] += 2000.0 * volume
        moment[owner] += 2000.0 * volume * middle
    assert mass == pytest.approx(solids.mass, rel=1e-6)
    assert moment / mass[:, None] == pytest.approx(solids.centroid, abs=1e-6)
    several = [n for k, n in enumerate(solids.block_names) if (solids.owner == k).sum() > 1]
    assert re.findall(r"^block join range group '([^']*)'$", text, re.M) == several


class Recorded:
    """What a script asks of OpenSees."""

    def __init__(self) -> None:
        self.calls: dict[str, list[tuple[Any, ...]]] = {}

    def __getattr__(self, name: str) -> Any:
        return lambda *given: self.calls.setdefault(name, []).append(given) or 0


def recorded(script: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, list[tuple[Any, ...]]]:
    ops, package = Recorded(), types.ModuleType("openseespy")
    package.opensees = ops  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "openseespy", package)
    monkeypatch.setitem(sys.modules, "openseespy.opensees", ops)
    exec(compile(script, "model.py", "exec"), {})
    return ops.calls


def test_the_opensees_script_has_the_weight_and_the_contacts_of_the_stones(monkeypatch: pytest.MonkeyPatch) -> None:
    """The script run with a recorder in place of OpenSees: loads are the weight, elements the volume, contacts the joints."""
    calls = recorded(extrados.export(DECK, "opensees"), monkeypatch)
    section = DECK.building.blocks()
    weight = section.mass.sum() * 9.80665
    assert -sum(load[2] for load in calls["load"]) == pytest.approx(weight, rel=2e-3)
    at = {node: (x, y) for node, x, y in calls["node"]}
    quads = [np.array([at[k] for k in e[2:6]]) for e in calls["element"] if e[0] == "quad"]
    assert sum(properties(q)[0] for q in quads) == pytest.approx(section.mass.sum() / 2000.0, rel=2e-3)
    moment = sum(at[node][0] * -down for node, _, down in calls["load"])
    assert moment == pytest.approx(9.80665 * section.mass @ section.centroid[:, 0], abs=2e-3 * weight * 10.0)
    contacts = [e for e in calls["element"] if e[0] == "zeroLengthContact2D"]
    laws = [group.law for group in DECK.building.mesh(None).groups if group.law is not None]
    assert all(at[e[2]] == pytest.approx(at[e[3]], abs=1e-9) for e in contacts)
    stiffness = sum(law.normal_stiffness @ law.area.sum(axis=1) for law in laws)
    assert sum(e[4] for e in contacts) == pytest.approx(stiffness, rel=1e-9)
    assert sum(law.area.sum() for law in laws) == pytest.approx(8 * 1.5, rel=1e-9)
    calls = recorded(extrados.export(BLOCK, "opensees"), monkeypatch)
    assert calls["load"] == [(5, 0.0, pytest.approx(-2000.0 * 4.0 * 9.80665), 0.0)]


def test_a_script_of_opensees_is_python() -> None:
    for deck in (DECK, BLOCK):
        compile(extrados.export(deck, "opensees"), "model.py", "exec")


PUSHED = """
ops.timeSeries("Linear", 2)
ops.pattern("Plain", 2, 2)
ops.load(5, {weight}, 0.0, 0.0)
ops.integrator("DisplacementControl", 5, 1, 0.005)
print(failed, [(ops.analyze(1), ops.nodeDisp(5, 3), ops.getTime())[1:] for _ in range(50)])
"""
WEIGHED = """
ops.reactions()
ground = ops.getFixedNodes()
print(failed, [[ops.nodeReaction(k, axis) for k in ground] for axis in (1, 2)])
"""


def opensees(script: str, folder: Path) -> tuple[int, list]:
    """What a script prints last; OpenSees runs in a process of its own."""
    pytest.importorskip("openseespy")
    (folder / "model.py").write_text(script)
    done = subprocess.run([sys.executable, folder / "model.py"], capture_output=True, text=True, check=True)
    failed, _, rest = next(line for line in done.stdout.splitlines() if line.startswith("0 ")).partition(" ")
    return int(failed), json.loads(rest.replace("(", "[").replace(")", "]"))


def test_opensees_pushes_the_block_as_housner_says(tmp_path: Path) -> None:
    """An independent program: the push that keeps a rigid block at a rotation is tan(alpha - theta) of its weight."""
    weight = BLOCK.building.blocks().mass[0] * 9.80665
    _, pushed = opensees(extrados.export(BLOCK, "opensees") + PUSHED.format(weight=weight), tmp_path)
    assert len(pushed) == 50
    for rotation, share in pushed:
        assert share == pytest.approx(math.tan(math.atan(0.25) - abs(rotation)), rel=1e-6)


def test_opensees_finds_a_thrust_between_the_least_and_the_greatest(tmp_path: Path) -> None:
    """An independent program: the elastic arch on dry joints pushes within the bounds of limit analysis, and weighs the same."""
    _, (across, up) = opensees(extrados.export(DECK, "opensees") + WEIGHED, tmp_path)
    found = extrados.run(DECK)["tilt"]
    assert sum(up) == pytest.approx(found.weight_N, rel=2e-3)  # arcs are drawn by chords
    assert found.thrust_min_N < sum(map(abs, across)) / 2 < found.thrust_max_N


WALL = {"kind": "panel", "width": 2.0, "height": 1.0, "thickness": 0.2}
TIE = {"start": [-9.5, 2.0], "end": [9.5, 2.0], "yield_force": "10 kN"}


def test_a_script_of_opensees_holds_what_the_deck_holds() -> None:
    """The nodes of [[supports.held]], in their directions, in place of the bottom edge."""
    held = [{"edge": "left", "fix": "x"}, {"x": [0, 0], "y": [0, 0]}]
    wall = extrados.deck(WALL, extrados.Sla(mesh={"size": 0.5}), supports={"held": held})
    lines = extrados.export(wall, "opensees").splitlines()
    fixed = {line for line in lines if line.startswith("ops.fix")}
    mesh = wall.building.mesh(wall.analyses[0].mesh)
    left = np.flatnonzero(mesh.xy[:, 0] < 1e-9)
    corner = int(np.hypot(*mesh.xy.T).argmin())
    assert fixed == {f"ops.fix({n + 1}, 1, {int(n == corner)})" for n in left} and len(left) > 2


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"structure": extrados.Block(width=1.0, height=4.0, base_slope=3.0)}, "structure.base_slope: .*level ground"),
        ({"structure": ARCH, "ties": [TIE]}, r"ties.*: the export to OpenSees cannot include \[\[ties\]\]"),
        ({"structure": BLOCK.structure, "supports": {"abutting_wall": "left"}}, "supports.abutting_wall: the export to OpenSees"),
        ({"structure": WALL, "supports": {"held": [{"edge": "left", "stiffness": 1e9}]}}, "held.*stiffness: .*rigid"),
        ({"structure": WALL | {"ties": [{"edge": "top", "direction": "y"}]}}, "structure.ties: .*no ties of a wall"),
    ],
)
def test_opensees_leaves_nothing_out_in_silence(tables, words: str) -> None:
    with pytest.raises(extrados.DeckError, match=words):
        extrados.export(extrados.deck(analysis=extrados.Tilt(), **tables), "opensees")


def test_stones_as_a_scene_of_pyvista() -> None:
    pytest.importorskip("pyvista")
    scene = extrados.scene(DECK)
    assert next(iter(scene.keys())) == DECK.building.blocks().block_names[0] and len(scene) == 7
    assert len(extrados.scene(space("cross-vault"))) == 104


@pytest.mark.parametrize("name", SPACE)
def test_bodies_for_other_programs_are_stones(name: str) -> None:
    """A mesh for each stone, whatever its parts: closed shells that enclose its volume, by which pyvista and COMPAS draw it."""
    solids = space(name).building.solids()
    found = list(compas.bodies(space(name)))
    assert [title for title, _, _ in found] == solids.block_names
    for (_, vertices, faces), mass in zip(found, solids.mass, strict=True):
        triangles = np.array([(f[0], b, c) for f in faces for b, c in itertools.pairwise(f[1:])])
        assert 2000.0 * moments(vertices, triangles)[0] == pytest.approx(mass, rel=1e-9)


def test_what_cannot_be_exported_says_so() -> None:
    with pytest.raises(extrados.DeckError, match="no format 'abaqus'; there are compas, udec"):
        extrados.export(DECK, "abaqus")
    motion = {"motion": extrados.StepPulse(amplitude="0.5 g", duration=0.2), "analysis": extrados.MotionStudy()}
    with pytest.raises(extrados.DeckError, match="udec needs a"):
        extrados.export(motion, "udec")
