"""What other programs are handed: read back by extrados, by COMPAS and OpenSees where they are installed."""

import itertools
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.building.geometry.solids.polyhedra import moments

ARCH = extrados.Arch(radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7)
DECK = extrados.deck(ARCH, extrados.Tilt(), title='An "arch"')
BLOCK = extrados.deck(
    extrados.Block(width=1.0, height=4.0),
    extrados.Rocking(),
    motion=extrados.StepPulse(amplitude="0.5 g", duration=0.2),
)


@pytest.mark.parametrize(
    ("stones", "within"),
    [(ARCH, 2e-3), (extrados.Column(width=1.0, height=3.0, drums=3), 1e-9)],  # COMPAS has chords for arcs
)
def test_compas_is_read_back_with_the_same_capacity(stones, within: float, tmp_path: Path) -> None:
    extrados.export(extrados.deck(stones, extrados.Tilt()), "compas", tmp_path / "stones.json")
    blocks = extrados.Blocks(file="stones.json", depth=1.0)
    back = extrados.run(extrados.deck(blocks, extrados.Tilt(), folder=tmp_path))["tilt"]
    there = extrados.run(extrados.deck(stones, extrados.Tilt()))["tilt"]
    assert back.collapse_acceleration_g == pytest.approx(there.collapse_acceleration_g, rel=within)
    assert back.weight_N == pytest.approx(there.weight_N, rel=within)
    assert extrados.export(DECK, "compas") == extrados.export(DECK, "compas")


def test_what_somebody_else_wrote_stays(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    place = tmp_path / "stones.json"
    place.write_text("mine")
    text = extrados.export(DECK, "compas", place)
    assert place.read_text() == "mine" and (tmp_path / "stones-2.json").read_text() == text
    assert "stones-2.json" in caplog.text


def test_compas_loads_it(tmp_path: Path) -> None:
    compas = pytest.importorskip("compas")
    pytest.importorskip("compas_assembly")
    extrados.export(DECK, "compas", tmp_path / "arch.json")
    assembly = compas.json_load(tmp_path / "arch.json")
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


def test_3dec_has_closed_bodies_of_the_volume_of_the_stones() -> None:
    """Faces clockwise from outside: turned around they enclose the volume; every edge is passed once each way."""
    deck = extrados.deck(
        extrados.Dome(radius=5.0, thickness=0.5, embrace=180.0, rings=4, lunes=8), extrados.Tilt(direction=0.0)
    )
    text = extrados.export(deck, "3dec")
    solids = deck.building.solids()
    bodies = re.findall(r"^block create group '([^']*)' poly (.*)$", text, re.M)
    assert [name for name, _ in bodies] == [solids.block_names[k] for k in solids.owner]
    for (_, faces), part in zip(bodies, solids.parts, strict=True):
        rings = [tuple(corner.split()) for corner in faces.removeprefix("face ").split(" face ")]
        edges = [edge for ring in rings for edge in itertools.pairwise((*ring, ring[0]))]
        assert len(set(edges)) == len(edges) and all((b, a) in edges for a, b in edges)
        names = sorted({corner for ring in rings for corner in ring})
        places = np.array([[float(v) for v in name.split(",")] for name in names])
        fans = [(ring[0], ring[k + 1], ring[k]) for ring in rings for k in range(1, len(ring) - 1)]
        triangles = np.array([[names.index(corner) for corner in fan] for fan in fans])
        assert moments(places, triangles)[0] == pytest.approx(moments(part.vertices, part.triangles)[0], rel=1e-6)


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
        ({"structure": ARCH, "ties": [TIE]}, r"ties.*: OpenSees is given no \[\[ties\]\]"),
        ({"structure": BLOCK.structure, "supports": {"abutting_wall": "left"}}, "supports.abutting_wall: OpenSees"),
        ({"structure": WALL, "supports": {"held": [{"edge": "left", "stiffness": 1e9}]}}, "held.*stiffness: .*rigid"),
        ({"structure": WALL | {"ties": [{"edge": "top", "direction": "y"}]}}, "structure.ties: .*no ties of a wall"),
    ],
)  # fmt: skip
def test_opensees_leaves_nothing_out_in_silence(tables, words: str) -> None:
    with pytest.raises(extrados.DeckError, match=words):
        extrados.export(extrados.deck(analysis=extrados.Tilt(), **tables), "opensees")


def test_stones_as_a_scene_of_pyvista() -> None:
    pytest.importorskip("pyvista")
    scene = extrados.scene(DECK)
    assert next(iter(scene.keys())) == DECK.building.blocks().block_names[0] and len(scene) == 7


def test_what_cannot_be_exported_says_so() -> None:
    with pytest.raises(extrados.DeckError, match="no format 'abaqus'; there are compas, udec"):
        extrados.export(DECK, "abaqus")
    motion = {"motion": extrados.StepPulse(amplitude="0.5 g", duration=0.2), "analysis": extrados.MotionStudy()}
    with pytest.raises(extrados.DeckError, match="udec needs a"):
        extrados.export(motion, "udec")
