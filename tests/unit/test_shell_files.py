"""Shells in space from mesh files with groups: gmsh, Abaqus and VTU; what groups say, and what does not fit."""

import re
import textwrap

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.decks.reader import read_deck
from extrados.model.errors import BadGeometry
from extrados.model.properties import Material
from extrados.model.structures.walls import MeshFile
from extrados.running.check import check_building
from extrados.running.run import compute
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.shell.mesh import nodal_areas
from extrados.views.shell.options import ShellOptions

meshio = pytest.importorskip("meshio")
N = 4  # elements of a side


def corner():
    """Two walls of 2 m that meet in a corner, 2 m high: nodes, quadrilaterals of each, nodes on the ground, lines there."""
    s = np.linspace(0.0, 2.0, N + 1)
    first = np.array([[x, 0.0, z] for x in s for z in s])
    second = np.array([[0.0, y, z] for y in s[1:] for z in s])
    xyz = np.concatenate([first, second])

    def quads(columns):
        return np.array(
            [[columns[i] + k, columns[i + 1] + k, columns[i + 1] + k + 1, columns[i] + k + 1] for i in range(N) for k in range(N)]
        )

    along = [(N + 1) * i for i in range(N + 1)]
    beside = [0, *((N + 1) * (N + 1 + i) for i in range(N))]
    ground = np.flatnonzero(xyz[:, 2] == 0.0)
    lines = np.array([[c[i], c[i + 1]] for c in (along, beside) for i in range(N)])
    return xyz, quads(along), quads(beside), ground, lines


def written(folder, form):
    """The corner as a file of a format, its groups called alike but in VTU, where they are numbers."""
    xyz, one, two, ground, lines = corner()
    path = folder / f"corner.{form}"
    if form == "msh":
        data = [np.array([1] * len(one) + [2] * len(two)), np.full(len(lines), 7)]
        mesh = meshio.Mesh(
            xyz,
            [("quad", np.concatenate([one, two])), ("line", lines)],
            cell_data={"gmsh:physical": data, "gmsh:geometrical": data},
            field_data={"front": np.array([1, 2]), "side": np.array([2, 2]), "ground": np.array([7, 1])},
        )
        meshio.write(path, mesh, file_format="gmsh22", binary=False)
    elif form == "inp":
        path.write_text(abaqus(xyz, one, two, ground))
    else:
        group = [np.array([1] * len(one) + [2] * len(two)), np.full(len(lines), 7)]
        meshio.write(path, meshio.Mesh(xyz, [("quad", np.concatenate([one, two])), ("line", lines)], cell_data={"group": group}))
    return path


def abaqus(xyz, one, two, ground):
    """An input file as Abaqus and its pre-processors write it."""
    rows = ["*NODE"] + [f"{k}, {x:g}, {y:g}, {z:g}" for k, (x, y, z) in enumerate(xyz, 1)]
    number = 1
    for name, quads in (("front", one), ("side", two)):
        rows.append(f"*ELEMENT, TYPE=S4, ELSET={name}")
        for quad in quads:
            rows.append(f"{number}, " + ", ".join(str(n + 1) for n in quad))
            number += 1
    rows += ["*NSET, NSET=ground", ", ".join(str(n + 1) for n in ground)]
    return "\n".join(rows) + "\n"


def read(path, groups, **keys):
    structure = MeshFile(kind="mesh", file=str(path), thickness=0.3, groups=groups, **keys)
    light = Material(density=1000.0, young=1e9)
    return Building(structure, Material(density=2000.0), materials={"light": light}, folder=path.parent).shell(ShellOptions(layers=3))


@pytest.mark.parametrize("form", ["msh", "inp", "vtu"])
def test_groups_say_what_elements_are(tmp_path, form):
    """Thickness, material, support, pressure and force by group, whatever the format calls them."""
    front, side, ground = ("front", "side", "ground") if form != "vtu" else ("1", "2", "7")
    mesh = read(
        written(tmp_path, form),
        [
            {"name": front, "thickness": 0.2, "pressure": [0.0, 500.0, 0.0]},
            {"name": side, "material": "light", "force": [0.0, 0.0, -1e4]},
            {"name": ground, "support": "pinned"},
        ],
    )
    assert mesh.elements() == 2 * N * N and len(mesh.xyz) == (2 * N + 1) * (N + 1)
    assert mesh.mass().sum() == pytest.approx(4.0 * (0.2 * 2000.0 + 0.3 * 1000.0))
    assert mesh.push.sum(axis=0) == pytest.approx([0.0, 2000.0, -1e4])
    low = np.flatnonzero(mesh.xyz[:, 2] == 0.0)
    assert mesh.held == sorted((int(n), d) for n in low for d in range(3))
    assert [foot.name for foot in mesh.feet] == [ground] and mesh.feet[0].nodes.tolist() == low.tolist()


def test_a_file_carries_as_the_plan_does(tmp_path):
    """The same corner of two walls from a file and on a plan: the same weight, stiffness and first crack."""
    written(tmp_path, "msh")
    material = """
        [material]
        density = 2000
        young = "3 GPa"
        tensile_strength = "0.1 MPa"
        fracture_energy = "50 N/m"
        [[analysis]]
        kind = "pushover"
        ripple = 0.2
        events = 60
    """
    file = '[structure]\nkind = "mesh"\nfile = "corner.msh"\nthickness = 0.3\ngroups = [{ name = "ground", support = "fixed" }, { name = "side", thickness = 0.3 }]\n'
    plan = """
        [structure]
        kind = "building"
        storeys = [2.0]
        walls = [
          { name = "front", start = [0, 0], end = [2, 0], thickness = 0.3 },
          { name = "side", start = [0, 0], end = [0, 2], thickness = 0.3 },
        ]
    """
    found = []
    for name, text, more in (
        ("file", file, "mesh.layers = 3\n"),
        ("plan", plan, 'mesh = { size = 0.5, layers = 3 }\ncontrol = { wall = "front", storey = 1 }\n'),
    ):
        path = tmp_path / f"{name}.toml"
        path.write_text(textwrap.dedent(text) + textwrap.dedent(material) + more)
        result = extrados.run(path).results[0]
        found.append(result.results)
        where = {"file": "the first crack forms in group side at x", "plan": "the first crack forms in wall"}[name]
        assert where in result.answer
    of_file, of_plan = found
    assert of_file.weight_N == pytest.approx(of_plan.weight_N, rel=1e-12) == pytest.approx(2 * 4 * 0.3 * 2000 * GRAVITY)
    assert of_file.first_event_load_N == pytest.approx(of_plan.first_event_load_N, rel=1e-9)
    assert of_file.initial_stiffness_N_m == pytest.approx(of_plan.initial_stiffness_N_m, rel=1e-9)
    assert of_file.feet[0].vertical_N == pytest.approx(of_file.weight_N, rel=1e-9)


def test_a_thicker_variant_is_thicker_in_all_groups(tmp_path):
    """Its coefficient is that of a deck whose groups are told so, not that of the default thickness alone."""
    written(tmp_path, "msh")
    deck = """
        [structure]
        kind = "mesh"
        file = "corner.msh"
        thickness = {default}
        groups = [{{ name = "front", thickness = {front} }}, {{ name = "ground", support = "fixed" }}]
        [material]
        tensile_strength = "20 kPa"
        fracture_energy = "5 N/m"
        [[analysis]]
        kind = "pushover"
        ripple = 0.2
        events = 40
        mesh.layers = 3
        {more}
    """
    found = []
    for name, default, front, more in (("told", 0.6, 0.4, ""), ("variant", 0.3, 0.2, 'variants = [{ name = "thick", thickness = 2.0 }]')):
        path = tmp_path / f"{name}.toml"
        path.write_text(textwrap.dedent(deck).format(default=default, front=front, more=more))
        result = extrados.run(path).results[0]
        found.append(result.results)
        assert "the first crack forms in the shell at x" in result.answer  # in no group
    told, varied = found
    (thick,) = varied.variants
    assert thick.greatest_base_shear_N == pytest.approx(told.greatest_load_N, rel=1e-9)
    assert thick.greatest_base_shear_N > 1.5 * varied.greatest_load_N


def test_a_membrane_is_a_floor(tmp_path):
    """Level elements that do not bend: nodes of theirs alone only move in their plane."""
    xyz, one, two, ground, _ = corner()
    inner = np.array([[2.0, 2.0, 2.0]])
    roof = np.array([[N, (N + 1) * N + N, len(xyz), len(xyz) - 1]])
    group = [np.array([1] * (2 * N * N) + [3])]
    path = tmp_path / "roof.vtu"
    lines = np.array([[n, n] for n in ground])
    meshio.write(
        path,
        meshio.Mesh(
            np.concatenate([xyz, inner]),
            [("quad", np.concatenate([one, two, roof])), ("line", lines)],
            cell_data={"group": [*group, np.full(len(lines), 7)]},
        ),
    )
    mesh = read(path, [{"name": "3", "membrane": True, "thickness": 0.05, "pressure": [0.0, 0.0, -1e3]}, {"name": "7", "support": "fixed"}])
    # What weighs on the corner that no wall holds goes to those that walls do
    area = float(nodal_areas(mesh.xyz, mesh.parts[-1].connect).sum())
    inner = 0.25 * area * (1e3 + 0.05 * 2000.0 * GRAVITY)
    assert mesh.push[len(xyz), 2] == 0.0
    assert mesh.push[:, 2].sum() == pytest.approx(-0.75 * area * 1e3 - inner)
    assert {(len(xyz), d) for d in (2, 3, 4, 5)} <= set(mesh.held) and (len(xyz), 0) not in mesh.held
    assert [part.bends for part in mesh.parts].count(False) == 1


@pytest.mark.parametrize(
    "groups, words",
    [
        ([{"name": "back", "support": "fixed"}], "'back': the file has no such group; its groups are front, ground, side"),
        ([{"name": "front", "thickness": 0.2}], "the structure has no support: give a group `support`"),
        ([{"name": "ground", "thickness": 0.2}], "group 'ground': `thickness` is a key for elements"),
        ([{"name": "ground"}], "this group has no properties"),
        ([{"name": "front", "material": "steel"}, {"name": "ground", "support": "fixed"}], r"no \[materials.steel\]"),
        ([{"name": "front", "membrane": True}, {"name": "ground", "support": "fixed"}], "a membrane must be horizontal"),
    ],
)
def test_groups_that_do_not_fit_are_reported(tmp_path, groups, words):
    with pytest.raises(BadGeometry, match=words) as told:
        read(written(tmp_path, "msh"), groups)
    assert str(told.value).startswith("corner.msh")


def test_files_that_do_not_fit_are_reported(tmp_path):
    xyz, one, _, _, _ = corner()
    ground = [{"name": "7", "support": "fixed"}]
    for cells, words in (
        ([("quad8", np.array([[0, 1, 2, 3, 4, 5, 6, 7]]))], "cells of kind 'quad8'; expected triangle and quad"),
        ([("line", np.array([[0, 1]]))], "contains no shells"),
        ([("quad", np.array([[0, 1, 1, 0]])), ("line", np.array([[0, 1]]))], "the same node twice"),
        ([("quad", one), ("line", np.array([[44, 43]]))], "not a node of a shell"),
    ):
        path = tmp_path / "bad.vtu"
        group = [np.full(len(data), 7) if kind == "line" else np.full(len(data), 1) for kind, data in cells]
        meshio.write(path, meshio.Mesh(xyz, cells, cell_data={"group": group}))
        with pytest.raises(BadGeometry, match=words):
            read(path, ground)
    (tmp_path / "no.msh").write_text("nothing of a mesh")
    with pytest.raises(BadGeometry, match=r"no\.msh: this is not a mesh"):
        read(tmp_path / "no.msh", ground)
    flat = written(tmp_path, "vtu")
    with pytest.raises(BadGeometry, match="`groups` is only for shells"):
        Building(MeshFile(kind="mesh", file=str(flat), thickness=0.3, groups=ground), folder=tmp_path).mesh()
    with pytest.raises(BadGeometry, match=r"remove mesh\.size"):
        Building(MeshFile(kind="mesh", file=str(flat), thickness=0.3, groups=ground), folder=tmp_path).shell(ShellOptions(size=0.5))


WORD = {2: "line", 3: "triangle", 4: "quad", 8: "quad8"}
TETRAHEDRON = ("tetra", [[0, 1, 5, 30]])
#: What is wrong with a file, the words of the complaint; nodes that lie elsewhere, more nodes and cells
WRONG = {
    "nowhere": ("the coordinates of node 13 are not finite", {12: [np.nan, 0, 1]}, [], []),
    "infinitely far": ("the coordinates of node 13 are not finite", {12: [np.inf, 0, 1]}, [], []),
    "beyond reason": ("node 13 is 1e[+]308 m from the origin, but at most", {12: [1e308, 0, 1]}, [], []),
    "an orphan nowhere": ("the coordinates of node 46 are not finite", {}, [[0, 0, np.nan]], []),
    "a node twice": ("quadrilateral of nodes 1, 2, 2, 7, .* has the same node twice; expected 4", {}, [], [[0, 1, 1, 6]]),
    "no area": ("quadrilateral of nodes 1, 2, 3, 4, .* has no area", {}, [], [[0, 1, 2, 3]]),
    "a triangle without area": ("triangle of nodes 1, 2, 3, .* has no area", {}, [], [[0, 1, 2]]),
    "crossed sides": ("overlaps itself", {}, [[5, 0, 0], [6, 0, 0], [5.2, 0, 1], [6, 0, 2]], [[45, 46, 47, 48]]),
    "a corner inward": (
        "nodes 7, 12, 13, 8, .* at a corner; expected its corners in order, all convex .2 such",
        {12: [0.2, 0, 0.6]},
        [],
        [],
    ),
    "an element twice": ("two elements overlap at the edge of nodes 1, 6, .* expected one element at each place", {}, [], [[1, 6, 5, 0]]),
    "a triangle on a quadrilateral": ("two elements overlap", {}, [], [[0, 5, 6]]),
    "an island": (
        "4 nodes around x 5.5, y 0, z 1 m are not supported",
        {},
        [[5, 0, 0], [6, 0, 0], [6, 0, 2], [5, 0, 2]],
        [[45, 46, 47, 48]],
    ),
    "solids": ("cells of kind 'tetra'; expected triangle and quad", {}, [], [TETRAHEDRON]),
    "curved sides": ("cells of kind 'quad8'; expected triangle and quad", {}, [], [[0, 1, 2, 3, 4, 5, 6, 7]]),
}


def corner_with(folder, elsewhere, nodes, cells):
    """The corner as a VTU file with nodes elsewhere, more nodes and more cells."""
    xyz, one, two, _, lines = corner()
    for node, place in elsewhere.items():
        xyz[node] = place
    blocks = [("quad", np.concatenate([one, two])), ("line", lines)]
    blocks += [cell if isinstance(cell, tuple) else (WORD[len(cell)], [cell]) for cell in cells]
    blocks = [(kind, np.array(of)) for kind, of in blocks]
    group = [np.full(len(of), 7 if kind == "line" else 1) for kind, of in blocks]
    path = folder / "corner.vtu"
    points = np.concatenate([xyz, np.array(nodes, dtype=float).reshape(-1, 3)])
    meshio.write(path, meshio.Mesh(points, blocks, cell_data={"group": group}))
    return path


@pytest.mark.parametrize("wrong", WRONG)
def test_elements_that_are_none_are_reported(tmp_path, wrong):
    """With the line of the deck that names the file, by `check` as by a run."""
    words, *change = WRONG[wrong]
    corner_with(tmp_path, *change)
    deck = tmp_path / "deck.toml"
    deck.write_text(
        '[structure]\nkind = "mesh"\nthickness = 0.3\nfile = "corner.vtu"\ngroups = [{ name = "7", support = "fixed" }]\n'
        '[[analysis]]\nkind = "pushover"\nmesh.layers = 3\n'
    )
    (said,) = check_building(read_deck(deck)).complaints
    assert said.startswith(f"{deck}:4: structure.file: corner.vtu: ")
    assert re.search(words, said), said
    assert compute(Context(read_deck(deck))).results[0].reason == said


def test_unjoined_parts_are_reported(tmp_path):
    """Nodes at one place, a node on the edge of an element: a warning, since a joint may be open. Orphans count for nothing."""
    support = [{"name": "7", "support": "fixed"}]
    whole = read(written(tmp_path, "vtu"), support)
    assert whole.warnings == []
    orphan = read(corner_with(tmp_path, {}, [[9, 9, 9]], []), support)
    assert orphan.warnings == [] and len(orphan.xyz) == len(whole.xyz)
    (told,) = read(corner_with(tmp_path, {}, [[2, 0, 0.25], [2.25, 0, 0.25]], [[45, 46, 20], [45, 21, 46]]), support).warnings
    assert "node 46, at x 2, y 0, z 0.25 m, lies on the edge of an element" in told

    xyz, one, two, _, lines = corner()
    apart = np.where(two < N + 1, two + len(xyz), two)  # the second wall has its own nodes where they meet
    lines = np.where((np.arange(len(lines)) >= N)[:, None] & (lines == 0), len(xyz), lines)
    path = tmp_path / "split.vtu"
    group = [np.full(2 * N * N, 1), np.full(len(lines), 7)]
    meshio.write(
        path,
        meshio.Mesh(
            np.concatenate([xyz, xyz[: N + 1]]), [("quad", np.concatenate([one, apart])), ("line", lines)], cell_data={"group": group}
        ),
    )
    (told,) = read(path, support).warnings
    assert "are two nodes at the same position (5 such): the elements are not connected there" in told


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "",
        lambda text: text[: len(text) // 2],
        lambda text: text.replace("$Nodes\n45\n", "$Nodes\n45000000000\n"),
        lambda text: text.replace("\n45 ", "\n45 here ", 1),
        lambda text: re.sub(r"(\$Elements\n.*\n.*) \d+\n", r"\1 9999\n", text),
        lambda text: "\x00\x01" + text,
    ],
)
def test_damaged_files_are_reported(tmp_path, change, capfd):
    """And what meshio prints of them is not."""
    path = written(tmp_path, "msh")
    before = path.read_text()
    path.write_text(change(before))
    assert path.read_text() != before
    with pytest.raises(BadGeometry, match=r"corner\.msh: this is not a mesh that meshio can read.*; expected a complete file"):
        read(path, [{"name": "ground", "support": "fixed"}])
    assert capfd.readouterr() == ("", "")


def test_a_negative_count_of_nodes_is_reported_or_changes_nothing(tmp_path):
    """Older numpy takes it for all numbers that follow, which are those of the file."""
    path, support = written(tmp_path, "msh"), [{"name": "ground", "support": "fixed"}]
    whole = read(path, support)
    path.write_text(path.read_text().replace("$Nodes\n45\n", "$Nodes\n-45\n"))
    assert "$Nodes\n-45\n" in path.read_text()
    try:
        found = read(path, support)
    except BadGeometry as error:
        assert "this is not a mesh that meshio can read" in str(error)
    else:
        assert np.array_equal(found.xyz, whole.xyz) and found.elements() == whole.elements()
