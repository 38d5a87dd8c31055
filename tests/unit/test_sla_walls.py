"""Walls from files, repetitions, stored results and figures, Ctrl-C."""

import os
import signal
import threading
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from test_sla_events import run_deck, wall

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.results.store import read
from extrados.running.run import run_to


def write_mesh(path, clockwise: bool = False, extra=()):
    """A 6 x 4 grid of quadrilaterals in millimetres, 1200 mm x 900 mm."""
    meshio = pytest.importorskip("meshio")
    x, y = np.meshgrid(np.linspace(0, 1200, 7), np.linspace(0, 900, 5), indexing="ij")
    at = (np.arange(6)[:, None] * 5 + np.arange(4)).ravel()
    quads = np.column_stack([at, at + 5, at + 6, at + 1])
    form = "gmsh22" if path.suffix == ".msh" else None
    cells = [("quad", quads[:, ::-1] if clockwise else quads), ("line", np.array([[0, 1]])), *extra]
    meshio.write(path, meshio.Mesh(np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]), cells), form)


def from_file(file: str, folder, **structure):
    data = wall(events=30, constant=[])
    data["structure"] = {"kind": "mesh", "file": file, "scale": 0.001, "thickness": 0.2, **structure}
    return run_analyses(Context(make_deck(data, folder)))[0]


@pytest.mark.parametrize(("name", "clockwise"), [("wall.msh", False), ("wall.inp", False), ("wall.vtu", True)])
def test_mesh_files_agree_with_the_built_in_mesh(tmp_path, name, clockwise) -> None:
    write_mesh(tmp_path / name, clockwise)
    found = from_file(name, tmp_path)
    data = wall(events=30, constant=[])
    data["structure"] |= {"width": 1.2, "height": 0.9, "openings": [], "regions": []}
    data["analysis"][0]["mesh"] = {"lines_y": [0.225, 0.45, 0.675], "size": 0.2}
    built = run_deck(data)
    assert found.results["elements"] == built.results["elements"] == 24
    assert found.results["greatest_load_N"] == pytest.approx(built.results["greatest_load_N"], rel=1e-6)


def test_bad_mesh_files(tmp_path) -> None:
    write_mesh(tmp_path / "twice.vtu", extra=[("quad", np.array([[0, 5, 6, 1]]))])
    assert "occur twice" in from_file("twice.vtu", tmp_path).reason
    write_mesh(tmp_path / "bow.vtu", extra=[("quad", np.array([[0, 6, 5, 1]]))])
    assert "without area" in from_file("bow.vtu", tmp_path).reason or "inverted" in from_file("bow.vtu", tmp_path).reason
    write_mesh(tmp_path / "mixed.vtu", extra=[("triangle", np.array([[0, 5, 6]]))])
    assert "expected exactly one of" in from_file("mixed.vtu", tmp_path).reason
    (tmp_path / "noise.msh").write_text("no mesh at all")
    assert "this is not a mesh that meshio can read" in from_file("noise.msh", tmp_path).reason
    assert "no such file" in from_file("missing.msh", tmp_path).reason
    assert "out of the deck's folder" in from_file("../wall.msh", tmp_path).reason


def test_outline_from_a_drawing(tmp_path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    space.add_lwpolyline([(0, 0), (3000, 0), (3000, 1800), (1500, 2600), (0, 1800)], close=True)
    space.add_lwpolyline([(1100, 700), (1900, 700), (1900, 1500), (1100, 1500)], close=True)
    drawing.saveas(tmp_path / "gable.dxf")
    data = wall(events=40)
    data["structure"] = {"kind": "panel", "outline": "gable.dxf", "thickness": 0.2}
    data["analysis"][0] |= {
        "mesh": {"size": 0.15, "element": "T3", "pattern": "random"},
        "constant": [{"kind": "gravity"}],
        "reference": [{"kind": "gravity", "ax": "1 m/s^2", "ay": "0 m/s^2"}],
    }
    result = run_analyses(Context(make_deck(data, tmp_path)))[0]
    assert result.status == "ok", result.reason
    area = 3.0 * 1.8 + 0.5 * 3.0 * 0.8 - 0.8**2
    assert result.results["reference_load_N"] == pytest.approx(1950.0 * 0.2 * area, rel=1e-6)
    del data["structure"]["outline"]
    with pytest.raises(DeckError, match="`width` and `height` are missing"):
        make_deck(data, tmp_path)
    data["structure"] |= {"outline": "gable.dxf", "width": 3.0}
    with pytest.raises(DeckError, match="an outline replaces width"):
        make_deck(data, tmp_path)


def test_repetitions_give_a_band() -> None:
    """Random meshes and strengths: another seed is another wall, the same seed the same."""
    data = wall(0.3, events=60, seeds=[4, 9], strength_variation=0.2, strength_length=0.5)
    data["analysis"][0]["mesh"] |= {"element": "T3", "pattern": "random"}
    rising = run_deck(data)
    assert "scatter" not in rising.results and rising["scatter_load"].shape[0] == 2
    assert any("did not pass a peak" in text and "seeds 4, 9" in text for text in rising.warnings)
    data["analysis"][0] |= {"events": 4000, "stop_fraction": 0.97}
    scatter = run_deck(data)
    peaks = scatter.results["scatter"]["peak_loads_N"]
    assert peaks[0] != peaks[1]
    data["analysis"][0]["seeds"] = [4]
    assert run_deck(data).results["scatter"]["peak_loads_N"] == peaks[:1]
    assert scatter["scatter_load"].shape[0] == 2
    assert "`seeds` require a random mesh" in run_deck(wall(events=5, seeds=[1])).reason


def test_strength_field_has_its_mean_and_scatter() -> None:
    from extrados.analyses.sla.model import strength_factors

    deck = make_deck(wall(0.05, strength_variation=0.3))
    factors = strength_factors(Context(deck).building.mesh(deck.analyses[0].mesh), deck.analyses[0], 11)
    assert factors.mean() == pytest.approx(1.0, abs=0.02)
    assert factors.std() == pytest.approx(0.3, abs=0.02)


def test_results_fields_and_figures(tmp_path) -> None:
    """A run as a user makes it: CSV, VTU in a PVD series, figures, report; and going on from it."""
    data = wall(0.3, events=90, directions=["+", "-"], states=[20, 71], section_x=[0.5])
    run = run_to(Context(make_deck(data)), tmp_path / "run")
    out, result = run.folder, run.results[0]
    stored = read(out)
    assert stored["sla"]["events"] == 90
    lines = (out / "load_displacement.csv").read_text().splitlines()
    assert lines[0].startswith("event,load [N],displacement [m]")
    assert len(lines) == 91
    series = ET.parse(out / "fields.pvd").getroot().findall(".//DataSet")
    assert len(series) == len(result["state_event"])
    grid = ET.parse(out / series[0].get("file")).getroot().find(".//Piece")
    assert int(grid.get("NumberOfCells")) == result.results["elements"]
    names = {p.stem for p in (out / "figures").iterdir()}
    assert {"sla-curve", "sla-cracks", "sla-stress", "sla-energy", "sla-section-0", "sla-minus-cracks"} <= names
    again = wall(0.3, events=20, resume_from=str(out), resume_event=71)
    found = run_deck(again)
    np.testing.assert_allclose(found["event_load"], result["event_load"][70:90], rtol=1e-9)
    for name in ("external", "stored", "dissipated", "crack"):  # the ledger goes on
        np.testing.assert_allclose(found[f"event_{name}"], result[f"event_{name}"][70:90], rtol=1e-7)
    assert found.results["events_before_resume"] == 70
    assert found.results["energy_residual_ratio"] < 1e-9
    meshio = pytest.importorskip("meshio")
    field = meshio.read(out / series[0].get("file"))
    np.testing.assert_allclose(field.point_data["displacement"][:, :2], result["state_displacement"][0], rtol=1e-12)


def test_a_run_to_minus_alone_is_read_back(tmp_path) -> None:
    """The only curve has the plain names, whatever its sense, and can be gone on from."""
    run = run_to(Context(make_deck(wall(0.3, events=30, directions=["-"]))), tmp_path / "run")
    out, result = run.folder, run.results[0]
    assert (result.results["sense"], "minus" in result.results) == ("-", False)
    assert len((out / "load_displacement.csv").read_text().splitlines()) == 31
    assert (out / "figures" / "sla-curve.png").exists() or (out / "figures" / "sla-curve.svg").exists()
    rest = run_deck(wall(0.3, events=1, directions=["-"], resume_from=str(out)))
    np.testing.assert_allclose(rest["event_load"], result["event_load"][29:], rtol=1e-9)
    refused = run_deck(wall(0.3, events=5, directions=["-"], resume_from=str(out), resume_event=26))
    assert "the damage before event 26 was not saved" in refused.reason


def test_another_wall_cannot_be_gone_on_with(tmp_path) -> None:
    run = run_to(Context(make_deck(wall(events=5))), tmp_path / "run", figures=False)
    out, result = run.folder, run.results[0]
    finer = run_deck(wall(0.1, events=5, resume_from=str(out)))
    sizes = f"the earlier wall has {len(result['point_xy'])} integration points"
    assert (finer.status, sizes in finer.reason) == ("refused", True)
    moved = wall(events=5, resume_from=str(out))
    moved["structure"]["width"] = 3.01
    assert "are up to" in run_deck(moved).reason
    for words, change in (
        ("different stiffness", {"young": 7e9}),
        ("different tensile laws", {"tensile_strength": 0.25e6}),
        ("different tensile laws", {"tensile_strength_parallel": 0.4e6}),
        ("different crushing laws", {"compressive_strength": 3e6, "crushing_energy": 5e3}),
    ):
        other = wall(events=5, resume_from=str(out))
        other["material"] |= change
        found = run_deck(other)
        assert (found.status, words in found.reason) == ("refused", True), found.reason
    for words, change in {"different tensile laws": {"ripple": 0.1}, "different ways of cracking": {"shear_retention": 0.1}}.items():
        found = run_deck(
            wall(events=5, resume_from=str(out)) | {"analysis": [wall(events=5, resume_from=str(out))["analysis"][0] | change]}
        )
        assert (found.status, words in found.reason) == ("refused", True), found.reason


def test_a_wall_that_cannot_crack(tmp_path) -> None:
    data = wall(section_x=[0.5])
    del data["material"]["tensile_strength"], data["material"]["fracture_energy"]
    run = run_to(Context(make_deck(data)), tmp_path / "run")
    result = run.results[0]
    assert result.status == "ok", result.reason
    assert result.answer.startswith("The load has no limit")


def test_interrupt_keeps_the_events_so_far() -> None:
    """Ctrl-C in a long run: the partial curve comes back, the handler too."""
    before = signal.getsignal(signal.SIGINT)
    timers: list[threading.Timer] = []  # one only: a second Ctrl-C would reach the next test

    def progress(done: float, total: float, text: str) -> None:
        if text.startswith("event") and not timers:
            timers.append(threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)))
            timers[0].start()

    data = wall(0.03, events=1_000_000, mechanism_ratio=1e5)
    result = run_analyses(Context(make_deck(data), progress=progress))[0]
    timers[0].join()
    assert result.status == "interrupted"
    assert 0 < result.results["events"] < 1_000_000
    assert len(result["event_load"]) == result.results["events"]
    assert signal.getsignal(signal.SIGINT) is before


def test_cracks_of_path_4b_curve() -> None:
    """Thesis Fig. 4-7d: the two cracks leave the plane of the notches to either side."""
    import tomllib
    from pathlib import Path

    deck = Path(__file__).resolve().parents[2] / "cases" / "sla" / "nooru-mohamed.toml"
    result = run_deck(tomllib.loads(deck.read_text(encoding="utf-8")))
    assert result.status == "ok", result.reason
    width, at = result["state_width_n"][-1], result["point_xy"]
    wide = width > 0.3 * width.max()
    left, right = (wide & (at[:, 0] > 0.06) & (at[:, 0] < 0.1)), (wide & (at[:, 0] > 0.1) & (at[:, 0] < 0.14))
    assert at[left, 1].min() < 0.093
    assert at[right, 1].max() > 0.107


def test_the_starter_deck_runs(tmp_path) -> None:
    from extrados.decks.explain import starter
    from extrados.decks.reader import read_text

    result = run_analyses(Context(read_text(starter("panel").encode())))[0]
    assert result.status == "ok", result.reason
    assert result.results["stop"] == "target displacement"
    assert read_text(starter("mesh").encode()).structure.file == "extrados:example-wall"


def test_a_force_between_nodes_is_shared() -> None:
    """The resultant and its moment are those of the force; at a node it is that node's alone."""
    from extrados.analyses.sla.model import nodal_forces
    from extrados.analyses.sla.tables import Load

    deck = make_deck(wall(events=5))
    mesh = Context(deck).building.mesh(deck.analyses[0].mesh)
    corner = mesh.xy.max(axis=0)
    place = corner - [0.37 * mesh.size, 0.0]
    force = nodal_forces(mesh, [Load(kind="point", x=place[0], y=place[1], fy=-1.0)], "reference")
    assert np.count_nonzero(force) == 2
    assert force.sum(axis=0) == pytest.approx([0.0, -1.0])
    assert (mesh.xy[:, 0] * force[:, 1]).sum() == pytest.approx(-place[0])
    alone = nodal_forces(mesh, [Load(kind="point", x=corner[0], y=corner[1], fy=-1.0)], "reference")
    assert np.count_nonzero(alone) == 1


def test_a_node_that_is_not_where_it_was_requested_is_reported() -> None:
    data = wall(events=5, control=[{"x": 0.0123, "y": 0.0, "direction": "x"}])
    assert any("no node is at x 0.0123 m" in w for w in run_deck(data).warnings)


def test_what_cracks_keep_is_never_the_peak() -> None:
    reason = run_deck(wall(events=5, mechanism_ratio=1e8)).reason
    assert "of their stiffness, which would carry the load. Give at most 100000" in reason


def test_nodes_that_stand_twice_are_named(tmp_path) -> None:
    """Two halves of a wall that only touch: the lower one is held, the upper one flies."""
    meshio = pytest.importorskip("meshio")
    x, y = np.meshgrid([0.0, 400.0, 800.0], [0.0, 300.0], indexing="ij")
    below = np.column_stack([x.ravel(), y.ravel(), np.zeros(6)])
    quads = np.array([[0, 2, 3, 1], [2, 4, 5, 3]])
    points = np.concatenate([below, below + np.array([0.0, 300.0, 0.0])])
    meshio.write(tmp_path / "halves.vtu", meshio.Mesh(points, [("quad", np.concatenate([quads, quads + 6]))]))
    reason = from_file("halves.vtu", tmp_path).reason
    assert "have the same position" in reason
    assert "(3 such pairs)" in reason


TEST = "# somebody (1999)\ndisplacement (mm),least (kN),greatest (kN)\n0.01,1,3\n0.1,18,22\n0.3,9,11\n0.5,4,6\n"


def with_test(tmp_path, text: str, **more):
    (tmp_path / "test.csv").write_text(text)
    return run_analyses(Context(make_deck(wall(events=60, measured="test.csv", **more), tmp_path)))[0]


def test_a_measured_curve_is_compared() -> None:
    """Mean 3, 20, 10, 5 kN at 0.01, 0.1, 0.3, 0.5 mm against a curve of 30 kN at 0.1 mm that stays there."""
    from extrados.analyses.sla.measured import Measured, compare

    test = Measured(np.array([1e-5, 1e-4, 3e-4, 5e-4]), *(1e3 * np.array(x) for x in ([1, 18, 9, 4], [5, 22, 11, 6])))
    found = compare(test, np.array([0.0, 1e-4, 4e-4]), np.array([0.0, 30e3, 30e3]))
    assert found.peak_ratio == pytest.approx(1.5)
    assert found.tail_ratios == [pytest.approx(30 / 15), pytest.approx(30 / 10), None]
    assert found.inside_ratio == pytest.approx(1 / 3)  # 3 kN at the first point alone
    assert found.half_band_ratio == pytest.approx((2 / 3 + 0.1 + 0.1) / 3)


def test_a_measured_curve_is_drawn(tmp_path) -> None:
    (tmp_path / "test.csv").write_text(TEST)
    run = run_to(Context(make_deck(wall(events=60, measured="test.csv"), tmp_path)), tmp_path / "run")
    assert run.results[0].results["measured"]["peak_ratio"] > 0.0
    assert read(run.folder).array("sla", "measured_greatest").max() == 22e3


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (TEST.replace("0.3,9,11", "0.05,9,11"), "must increase"),
        (TEST.replace("(kN)", "(psi)"), "expected a unit"),
        (TEST.replace("least", "lowest"), "expected displacement with load"),
        (TEST.replace("9,11", "9,eleven"), "test.csv:5: expected 3 numbers"),
        (TEST.replace("18,22", "22,18"), "`least` exceeds"),
        ("", "at least two lines of numbers"),
    ],
)
def test_bad_measured_curves(tmp_path, text, complaint) -> None:
    assert complaint in with_test(tmp_path, text).reason
