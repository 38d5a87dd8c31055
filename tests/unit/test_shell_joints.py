"""Joints between walls and bed joints of buildings of shells: friction, rocking, flanges, what is refused."""

import textwrap

import numpy as np
import pytest
from typer.testing import CliRunner

import extrados
from extrados.cli import app
from extrados.decks.reader import read_text
from extrados.views.shell.options import ShellOptions

BED = """
    [structure]
    kind = "building"
    storeys = [1.0]
    walls = [{ name = "a", start = [0, 0], end = [2, 0], thickness = 0.25 }]
    beds = [{ z = HEIGHT }]
    [material]
    density = 1900
    young = 3e9
    [joints]
    tension = TENSION
    fracture_energy = ENERGY
    cohesion = "30 kPa"
    shear_energy = 10
    friction = 0.4
    [[analysis]]
    kind = "pushover"
    mesh = { size = 0.5, layers = LAYERS }
    ripple = 0.1
    events = 4000
"""
FLANGE = """
    [structure]
    kind = "building"
    storeys = [2.0]
    walls = [
      { name = "web", start = [0, 0], end = [3, 0], thickness = 0.25 },
      { name = "flange", start = [0, -1], end = [0, 1], thickness = 0.25 },
    ]
    corners = [CORNER]
    [material]
    density = 1900
    young = 3e9
    tensile_strength = 1e5
    fracture_energy = 50
    [joints]
    tension = BOND
    fracture_energy = TOUGH
    cohesion = BOND
    shear_energy = TOUGH
    friction = 0.4
    [[analysis]]
    kind = "pushover"
    mesh = { size = 0.5, layers = 3 }
    ripple = 0.2
    events = 3000
    target_displacement = "1.5 mm"
"""


def run(folder, deck, more="", rule="load-unload", **values):
    """Results and answer of a deck with some words replaced; rule: without equilibrium."""
    text = textwrap.dedent(deck) + f'without_equilibrium = "{rule}"\n' + more + "\n"
    for name, value in values.items():
        text = text.replace(name, str(value))
    (folder / "deck.toml").write_text(text)
    found = extrados.run(folder / "deck.toml")
    assert found.analyses[0]["status"] == "ok", found.analyses[0]["reason"]
    return found["pushover"], found.analyses[0]["answer"], found.analyses[0]["warnings"]


@pytest.mark.parametrize("height, above", [(0.0, 1.0), (0.5, 0.5)])
def test_a_bed_joint_slides_under_its_friction(tmp_path, height, above):
    """When the bond is gone, the friction on what is above; the whole is a mechanism then."""
    push = 'drives = [{ wall = "a", storey = 1 }]'
    r, answer, warnings = run(tmp_path, BED, push, HEIGHT=height, TENSION=2e4, ENERGY=10, LAYERS=3)
    assert r.stop == "mechanism" and r.last_load_N == pytest.approx(0.4 * above * r.weight_N, rel=0.025)
    assert r.peak_load_N > 4.0 * r.last_load_N  # its cohesion
    (joint,) = r.joints
    assert joint.last_slip_m > 1e-3 > joint.opening_m and joint.broken_share == pytest.approx(1.0)
    assert abs(r.energy_residual_ratio) < 1e-9
    assert "joint bed 1 in wall a fails under" in answer and not warnings


@pytest.mark.parametrize("height, above", [(0.0, 1.0), (0.5, 0.5)])
def test_a_bed_joint_slides_in_equilibrium_iterations(tmp_path, height, above):
    """The rule by default, followed to a drift: Coulomb's law of the weight above."""
    push = 'drives = [{ wall = "a", storey = 1 }]'
    r, *_ = run(tmp_path, BED, push, rule="continue", HEIGHT=height, TENSION=2e4, ENERGY=10, LAYERS=3)
    assert r.stop == "a drift of 1 %" and r.last_load_N == pytest.approx(0.4 * above * r.weight_N, rel=0.025)
    assert r.joints[0].last_slip_m > 1e-3


def test_a_bed_joint_opens_as_the_wall_rocks_out_of_its_plane(tmp_path):
    """Pushed across, with hardly any bond: thickness over height of the weight."""
    r, *_ = run(tmp_path, BED, "direction = 90", HEIGHT=0.0, TENSION=100, ENERGY=0.01, LAYERS=9)
    assert r.greatest_load_N == pytest.approx(0.25 * r.weight_N, rel=0.01)
    assert r.joints[0].last_opening_m > 10 * r.joints[0].last_slip_m


def test_a_flange_behind_a_joint(tmp_path):
    """A strong joint is one masonry; one that is torn leaves the wall alone; one that is pressed lets the flange work."""
    joint = '{ walls = ["flange", "web"], bond = "joint" }'
    whole, *_ = run(tmp_path, FLANGE, CORNER="", BOND=0, TOUGH=1)
    strong, *_ = run(tmp_path, FLANGE, CORNER=joint, BOND=1e6, TOUGH=2000)
    assert strong.greatest_load_N == pytest.approx(whole.greatest_load_N, rel=0.005)
    assert strong.joints[0].first_base_shear_N is None
    both = 'directions = ["+", "-"]'
    weak, *_ = run(tmp_path, FLANGE, both, CORNER=joint, BOND=100, TOUGH=0.01)
    alone, *_ = run(tmp_path, FLANGE, both, CORNER=joint.replace("joint", "open"), BOND=0, TOUGH=1)
    assert weak.minus.greatest_load_N == pytest.approx(alone.minus.greatest_load_N, rel=0.03)
    assert 4.0 * alone.greatest_load_N < weak.greatest_load_N < 0.85 * whole.greatest_load_N
    assert weak.minus.joints[0].last_opening_m > 1e-3 > weak.joints[0].last_opening_m
    assert weak.joints[0].last_slip_m > 1e-3


@pytest.mark.parametrize(
    "old, new, line, words",
    [
        ("tension = TENSION", "tension = 0", "joints.tension", "joint 'bed 1' has no `tension`"),
        ("shear_energy = 10", "", "joints.shear_energy", "joint 'bed 1' has a cohesion but no shear_energy"),
        ("beds = [{ z = HEIGHT }]", "beds = [{ z = 1.0 }]", "structure", "is not below the top of a storey"),
        ("beds = [{ z = HEIGHT }]", "beds = [{}, {}]", "structure", "bed 1 has the same height"),
        ("beds = [{ z = HEIGHT }]", 'beds = [{ walls = ["b"] }]', "structure", "wall 'b' does not exist"),
        ("ripple = 0.1", 'without_equilibrium = "force-release"', "without_equilibrium", "can follow"),
        (
            "friction = 0.4",
            'friction = 0.4\ntypes = [{ joints = ["x"], friction = 0.2 }]',
            "joints.types",
            "joint 'x' does not exist; the joints are bed 1",
        ),
    ],
)
def test_what_is_no_joint_is_refused_with_its_line(tmp_path, old, new, line, words):
    text = textwrap.dedent(BED).replace(old, new)
    for name, value in {"HEIGHT": 0.0, "TENSION": 2e4, "ENERGY": 10, "LAYERS": 3}.items():
        text = text.replace(name, str(value))
    (tmp_path / "deck.toml").write_text(text)
    told = CliRunner().invoke(app, ["check", str(tmp_path / "deck.toml")], env={"COLUMNS": "400"})
    assert told.exit_code == 2, told.output
    assert "deck.toml:" in told.output and line in told.output and words in told.output


def test_a_wall_that_passes_through_another_has_no_joint_with_it(tmp_path):
    text = textwrap.dedent(FLANGE).replace("CORNER", '{ walls = ["web", "flange"], bond = "joint" }')
    (tmp_path / "deck.toml").write_text(text.replace("BOND", "2e4").replace("TOUGH", "10"))
    told = CliRunner().invoke(app, ["check", str(tmp_path / "deck.toml")], env={"COLUMNS": "400"})
    assert told.exit_code == 2 and "wall 'flange' passes through wall 'web'" in told.output


def test_joints_without_a_bond_along_them_are_reported(tmp_path):
    text = BED.replace('cohesion = "30 kPa"', "").replace("shear_energy = 10", "")
    _, _, warnings = run(tmp_path, text, "events = 3".replace("events", "#"), HEIGHT=0.0, TENSION=2e4, ENERGY=10, LAYERS=3)
    assert any("joints without cohesion" in warning for warning in warnings)


def test_check_draws_the_joints_on_their_walls(tmp_path):
    """A bed joint along each wall, the joint of the corner up the wall that abuts."""
    text = textwrap.dedent(FLANGE).replace("CORNER", '{ walls = ["flange", "web"], bond = "joint" }')
    text = text.replace("[material]", '[[structure.beds]]\nz = 0.5\nwalls = ["web"]\n[material]')
    (tmp_path / "deck.toml").write_text(text.replace("BOND", "2e4").replace("TOUGH", "10"))
    told = CliRunner().invoke(app, ["check", str(tmp_path / "deck.toml"), "--out", str(tmp_path / "out")])
    assert told.exit_code == 0, told.output
    drawn = (tmp_path / "out" / "plan.svg").read_text(encoding="utf-8")
    for name in ("joint flange-web", "joint bed 1"):
        assert drawn.count(f"<!-- {name} -->") == 1


@pytest.mark.parametrize("walls, ends", [('["web"]', 1), ('["web", "flange"]', 0)])
def test_a_wall_that_a_bed_joint_does_not_cut_ends_it(walls, ends):
    """Where a bonded wall passes through, both sides are one node; where it is cut too, the joint runs around the corner."""
    plan = textwrap.dedent(FLANGE).replace("[CORNER]", f"[]\nbeds = [{{ z = 0.5, walls = {walls} }}]")
    building = read_text(plan.replace("BOND", "2e4").replace("TOUGH", "10").encode()).building
    mesh = building.shell(ShellOptions(size=0.5, layers=3))
    pairs = np.concatenate([np.vstack([j.connect[:, [0, 3]], j.connect[:, [1, 2]]]) for j in mesh.joints])
    one = np.unique(pairs[pairs[:, 0] == pairs[:, 1], 0])
    assert len(one) == ends and all(mesh.xyz[n] == pytest.approx([0.0, 0.0, 0.5]) for n in one)
    assert np.allclose(mesh.xyz[pairs[:, 0]], mesh.xyz[pairs[:, 1]]) and np.allclose(mesh.xyz[pairs[:, 0], 2], 0.5)
