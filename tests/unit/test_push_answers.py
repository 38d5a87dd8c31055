"""What a push answers: patterns, drifts, piers, the bilinear curve, fields for ParaView, curves of several analyses."""

import textwrap

import matplotlib
import numpy as np
import pytest

import extrados
from extrados.analyses.shell.model import build
from extrados.analyses.shell.sections import drifts
from extrados.analyses.shell.tables import Pushover
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.results.store import read
from extrados.schema.constants import GRAVITY
from extrados.show import shell as figures
from extrados.views.building import Building
from extrados.views.shell.options import ShellOptions

DECK = """
    [structure]
    kind = "building"
    storeys = [2.0, 2.0]
    walls = [
      { name = "long", start = [0, 0], end = [3, 0], thickness = 0.25 },
      { name = "low", start = [3, 0], end = [3, 2], thickness = 0.25, storeys = [1, 1] },
    ]
    [material]
    density = 1900
    young = 3e9
    tensile_strength = 1e5
    fracture_energy = 60
    [[analysis]]
    kind = "pushover"
    mesh = { size = 1.0, layers = 3 }
    ripple = 0.3
    events = 900
    drives = [{ wall = "long", storey = 2 }]
    target_displacement = "2 mm"
    [[analysis]]
    kind = "pushover"
    name = "triangular"
    pattern = "triangular"
    mesh = { size = 1.0, layers = 3 }
    ripple = 0.3
    events = 60
"""

WALL = """
    [structure]
    kind = "panel"
    width = 1.0
    height = 1.0
    thickness = 0.2
    [material]
    young = 3e9
    tensile_strength = 1e5
    fracture_energy = 60
    [[analysis]]
    kind = "sla"
    mesh.size = 0.25
    reference = [{ kind = "displacement", direction = "x", parts = [{ edge = "top" }] }]
    directions = ["+", "-"]
    ripple = 0.3
    target_displacement = "0.2 mm"
    [[analysis]]
    kind = "sla"
    solution = "incremental"
    mesh.size = 0.25
    reference = [{ kind = "displacement", direction = "x", parts = [{ edge = "top" }] }]
    ripple = 0.3
    target_displacement = "0.2 mm"
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("push")
    (folder / "house.toml").write_text(textwrap.dedent(DECK).replace('name = "triangular"\n', ""))
    found = extrados.run(folder / "house.toml")
    found.write(folder / "out", figures=False)
    return found, folder / "out"


def model_of(**options):
    walls = [{"name": "a", "start": [0.0, 0.0], "end": [3.0, 0.0], "thickness": 0.3}]
    plan = Plan(kind="building", storeys=[2.0, 2.5], walls=walls)
    mesh = Building(plan, Material(density=2000.0)).shell(ShellOptions(size=0.5, layers=3))
    return build(mesh, Pushover(kind="pushover", mesh=ShellOptions(size=0.5, layers=3), **options))


@pytest.mark.parametrize("direction", [0.0, 30.0, 180.0])
def test_patterns_are_what_they_say(direction):
    """In proportion to masses and to masses times heights, in the direction asked for; both come to the weight."""
    way = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    for pattern, by in (("mass", lambda m, z: m), ("triangular", lambda m, z: m * z * m.sum() / (m @ z))):
        model = model_of(direction=direction, pattern=pattern)
        mass, z = model.mesh.mass(), model.mesh.xyz[:, 2]
        assert model.reference[:, :2] == pytest.approx(GRAVITY * by(mass, z)[:, None] * way, abs=1e-6)
        assert model.unit == pytest.approx(model.weight)
    modal = model_of(direction=0.0, pattern="modal")
    force = modal.reference[:, 0] / modal.mesh.mass()
    z = modal.mesh.xyz[:, 2]
    assert force.sum() > 0.0 and force[z > 4.4].min() > force[(z > 1.9) & (z < 2.1)].max()  # it grows upward


def test_drifts_of_storeys_and_walls():
    """Of given displacements: a lean of 1 in 100 in the lower storey, of 1 in 50 in the upper one."""
    model = model_of()
    z = model.mesh.xyz[:, 2]
    moved = np.zeros((len(z), 6))
    moved[:, 0] = np.where(z < 2.0, 0.01 * z, 0.02 + 0.02 * (z - 2.0))
    every, walls = drifts(model, moved, 1)
    assert every == pytest.approx([0.01, 0.02]) and walls == pytest.approx(np.array([[0.01, 0.02]]))
    assert drifts(model, moved, -1)[0] == pytest.approx([-0.01, -0.02])


def test_walls_share_the_push(run):
    """Shares along the push come to one, but for what walls across bend by; a wall of one storey has one drift."""
    r = run[0].results[0].results
    long, low = r.walls
    assert long.share + r.flanges.share == pytest.approx(1.0) and low.share == pytest.approx(0.0, abs=1e-9)
    assert long.drifts[1] is not None and low.drifts[1] is None
    assert r.storey_drifts[0] > 0.0 and r.roof_drift == pytest.approx(r.greatest_load_displacement_m / 4.0)
    assert r.capacity_N == min(r.greatest_load_N, r.sliding_capacity_N)
    assert r.base_shear_coefficient == pytest.approx(r.capacity_N / r.weight_N)
    assert r.first_crack.wall in ("long", "low") and 0.0 <= r.first_crack.height_m < 1.0
    assert r.flanges is not None and sum(r.cracked_points_by_storey) > 0
    piers = run[0].results[0].tables["piers"].columns
    foot = [k for k, (wall, storey) in enumerate(zip(piers["wall"], piers["storey"], strict=True)) if (wall, storey) == ("long", 1)]
    assert sum(piers["shear"][k] for k in foot) == pytest.approx(long.shear_N, rel=1e-9)


def test_the_bilinear_curve_has_the_area_of_the_envelope(run):
    r = run[0].results[0]
    idea = r.results.bilinear
    d, p = r["envelope_displacement"], r["envelope_load"]
    d = d - d[0]
    ultimate = idea.ultimate_displacement_m
    area = np.trapezoid(np.interp(x := np.linspace(0.0, ultimate, 4001), d, p), x)
    own = idea.yield_load_N * (ultimate - 0.5 * idea.yield_displacement_m)
    assert own == pytest.approx(area, rel=0.01)
    assert idea.ductility == pytest.approx(ultimate / idea.yield_displacement_m) and idea.ductility > 1.0


def test_the_fields_open_in_other_programs(run):
    """VTU of every kept state, in a series: nodes, displacements, widths of cracks."""
    meshio = pytest.importorskip("meshio")
    series = (run[1] / "fields.pvd").read_text()
    files = sorted(run[1].glob("fields/*.vtu"))
    assert files and all(file.name in series for file in files)
    result = run[0].results[0]
    mesh = meshio.read(files[-1])
    assert mesh.points == pytest.approx(result["node"])
    assert np.asarray(mesh.point_data["displacement"]) == pytest.approx(result["state_displacement"][-1])
    width = np.concatenate(mesh.cell_data["crack_width"])
    assert width.max() == pytest.approx(result["state_width"][-1].max()) and width.max() > 0.0


def test_one_picture_has_the_curves_of_all_analyses(run, monkeypatch, tmp_path):
    """That of the other analysis of the run lies behind, with its name."""
    matplotlib.use("Agg")
    stored = read(run[1])
    seen = []
    kept = figures.style.save

    def save(fig, folder, name):
        if name.endswith("curve"):
            seen.append([text.get_text() for text in fig.axes[0].get_legend().get_texts()])
        return kept(fig, folder, name)

    monkeypatch.setattr(figures.style, "save", save)
    figures._curves(stored, "pushover", tmp_path)
    assert any(label.startswith("bilinear") for label in seen[0])
    assert any(label == "analysis pushover-2" for label in seen[0])


def test_curves_of_several_runs_stand_in_one_picture(run, tmp_path) -> None:
    """A push of shells, a wall of plane stress and its incremental solution, each curve as it is stored."""
    from typer.testing import CliRunner

    from extrados.cli import app
    from extrados.show import style
    from extrados.show.together import draw, pushes

    found, pushed = run
    wall = tmp_path / "wall.toml"
    wall.write_text(textwrap.dedent(WALL))
    extrados.run(wall).write(tmp_path / "wall", figures=False)
    stored = [("house", read(pushed)), ("wall", read(tmp_path / "wall"))]
    curves = pushes(stored)
    assert [(c.analysis, c.sense, c.incremental) for c in curves] == [
        ("house, pushover", "+", False),
        ("house, pushover-2", "+", False),
        ("wall, sla", "+", False),
        ("wall, sla", "-", False),
        ("wall, sla-2", "+", True),
    ]
    assert curves[0].greatest()[0] == pytest.approx(found["pushover"].greatest_load_N, rel=1e-12)
    with style.kept() as pictures:
        draw(curves, tmp_path / "together.png")
    ax = pictures["together"].axes[0]
    marked = [float(line.get_ydata()[0]) for line in ax.lines if len(line.get_xdata()) == 1]
    carried = [row.shear_N / 1e3 for name in ("pushover", "pushover-2") for row in found[name].walls if row.share > 0.05]
    assert marked == pytest.approx(carried) and marked
    lines = [line for line in ax.lines if len(line.get_xdata()) > 2]
    assert len(lines) == len(curves)
    for line, curve in zip(lines, curves, strict=True):
        np.testing.assert_allclose(line.get_ydata(), curve.load / 1e3)
        assert (line.get_linestyle() == "--") == (curve.sense == "-")
    legend = [text.get_text() for text in pictures["together"].legends[0].get_texts()]
    assert legend[:2] == ["house, pushover", "house, pushover-2"] and "load to -" in legend

    def call(*words):
        return CliRunner().invoke(app, ["plot", *map(str, words)], env={"COLUMNS": "150"})

    told = call(pushed, tmp_path / "wall", "--together", tmp_path / "new" / "curves.svg")
    assert told.exit_code == 0, told.output
    assert {"greatest", "load", "[kN]", "sla-2"} <= set(told.output.split())
    assert {path.name for path in (tmp_path / "new").iterdir()} == {"curves.png", "curves.svg", ".written.json"}
    (tmp_path / "new" / "curves.svg").write_text("mine")  # what another drew there stays
    assert call(pushed, tmp_path / "wall", "--together", tmp_path / "new" / "curves.png").exit_code == 0
    assert (tmp_path / "new" / "curves.svg").read_text() == "mine" and (tmp_path / "new" / "curves-2.svg").exists()
    arch = tmp_path / "arch.toml"
    arch.write_text('[structure]\nkind = "arch"\nradius = 10\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n[analysis]\nkind = "tilt"\n')
    extrados.run(arch).write(tmp_path / "arch", figures=False)
    refused = call(tmp_path / "arch", "--together", tmp_path / "none.png")
    assert refused.exit_code == 3 and "the run has no analysis with a capacity curve" in refused.output
