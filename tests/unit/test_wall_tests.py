"""The tool that predicts tested walls: rules for empty cells, a closed form, the statistics."""

import math
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
import wall_tests as tool

from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.views.mesh.options import MeshOptions

HEAD = (
    "# a source\nn,reference,name,units,height_m,length_m,thickness_m,unit_length_mm,unit_height_mm,masonry_compressive_MPa,"
    "masonry_tensile_diagonal_MPa,young_MPa,shear_strength_initial_MPa,friction,shear_span_over_height,vertical_stress_MPa,"
    "failure,peak_pos_kN,peak_neg_kN\n"
)


def walls(tmp_path: Path, *rows: str) -> list[tool.Wall]:
    file = tmp_path / "walls.csv"
    file.write_text(HEAD + "\n".join(rows), encoding="utf-8")
    return tool.read_walls(file)


def test_empty_cells_are_taken_by_rule(tmp_path) -> None:
    (wall,) = walls(tmp_path, "7,someone,A,brick,2.5,1.25,0.2,250,125,10,,,0.3,,0.5,1.0,H-FS,80,90")
    assert (wall.friction, wall.tensile, wall.young) == pytest.approx((0.4, 0.3e6, 600 * 10e6))
    assert wall.peak == 85e3 and wall.axial == pytest.approx(250e3) and wall.mode == "H"


@pytest.mark.parametrize("span", [0.5, 1.0])
def test_limit_analysis_of_a_slender_wall_is_its_flexure(tmp_path, span: float) -> None:
    """V H_0 = N (L - N/(0.85 f t))/2 of one or two bricks a course, with ample friction."""
    (wall,) = walls(tmp_path, f"1,x,A,brick,3,1,0.25,1000,250,5,,,0.3,0.9,{span},0.6,F,40,40")
    found = tool.by_limit_analysis(wall)["limit"]
    pressed = wall.axial / (0.85 * 5e6 * 0.25)
    flexure = wall.axial * (1.0 - pressed) / (2.0 * span * 3.0)
    assert 0.96 * flexure < found.strength <= flexure * (1.0 + 1e-4)  # the bricks weigh 1 kg/m^3
    assert found.failure == "F"


def test_statistics() -> None:
    def pair(failure: str, ratio: float, said: str) -> tuple[tool.Wall, tool.Predicted]:
        wall = tool.Wall("w", 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, failure, 100.0, 0.01)
        return wall, tool.Predicted(100.0 * ratio, said)

    pairs = [pair("S", 2.0, "S"), pair("S", 0.5, "F"), pair("F", 1.0, "F"), pair("H-FS", 1.0, "S")]
    bias, scatter, count = tool.statistics(pairs)
    assert (bias, count) == (pytest.approx(1.0), 4)
    assert scatter == pytest.approx(math.log(2.0) * math.sqrt(2.0 / 3.0))
    assert tool.count_right_modes(pairs) == (2, 3)
    assert tool.statistics([*pairs, pair("S", math.nan, "")])[2] == 4


@pytest.mark.parametrize(
    ("row", "failure"),
    [
        # Slender and lightly loaded: N (L - N/(.85 f t))/(2 H_0), H_0 = 3 m
        ("1,x,A,brick,3,1,0.25,250,65,5,,,0.3,0.9,1,0.2,F,40,40", "F"),
        # Squat: L t f_t/b sqrt(1 + s/f_t) with f_t .1 MPa, b 1
        ("1,x,A,brick,2,3,0.25,250,65,5,0.1,,0.5,0.6,0.5,0.5,S,40,40", "S"),
    ],
)
def test_the_macro_element_has_the_strength_of_its_formula(tmp_path, row: str, failure: str) -> None:
    (wall,) = walls(tmp_path, row)
    found = tool.by_macro_element(wall)["frame"]
    if failure == "F":
        pressed = wall.axial / (0.85 * wall.compressive * wall.thickness)
        expected = wall.axial * (wall.length - pressed) / (2.0 * wall.height)
    else:
        area = wall.length * wall.thickness
        expected = area * wall.tensile * math.sqrt(1.0 + wall.pressure / wall.tensile)
    assert found.failure == failure
    assert found.strength == pytest.approx(expected, rel=5e-3)


def moved_wall(slip: float, rotation: float) -> tuple[tool.Wall, dict]:
    """Two rigid units of 1 m x 1 m, one on the other; the upper one slides and rotates about the right end of the bed between them."""
    wall = tool.Wall("w", 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, "S", 100.0, 0.01)
    node = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    moved = np.zeros((1, 8, 2))
    moved[0, 4:, 0] = slip + rotation * (node[4:, 1] - 1.0)
    moved[0, 4:, 1] = rotation * (1.0 - node[4:, 0])
    elements = np.array([[0, 1, 2, 3], [4, 5, 6, 7], [3, 2, 5, 4]])
    return wall, {"node": node, "elements_0": elements, "state_event": np.array([7]), "state_displacement": moved}


@pytest.mark.parametrize(("slip", "rotation", "failure"), [(1e-3, 0.0, "S"), (0.0, 1e-3, "F"), (1e-3, 3e-3, "F"), (3e-3, 1e-3, "S")])
def test_the_failure_of_a_state_is_that_by_which_its_top_moves(slip: float, rotation: float, failure: str) -> None:
    wall, arrays = moved_wall(slip, rotation)
    answer = {"greatest_load_event": 7, "greatest_load_N": 1.0, "initial_stiffness_N_m": 1e9}
    said, shares = tool.failure_of_state(wall, answer, arrays)
    assert said == failure
    assert shares.startswith(f"rotation {rotation / (slip + rotation):.0%}, slip {slip / (slip + rotation):.0%}")


def test_a_wall_of_many_units_has_units_twice_as_large(tmp_path, monkeypatch) -> None:
    """Unless a course would have fewer than five of them."""
    decks = []
    monkeypatch.setattr(tool, "_followed", lambda _, deck: decks.append(deck) or tool.Predicted())
    for height, length in ((2, 3), (2, 2), (1, 1)):  # 384, 256 and 64 units; a course has 12, 8 and 4
        row = f"1,x,A,brick,{height},{length},0.25,250,62.5,5,,,0.3,0.6,0.5,0.6,F,40,40"
        tool.by_units(walls(tmp_path, row)[0])
    sizes = [(deck["structure"]["unit_length"], deck["structure"]["unit_height"]) for deck in decks]
    assert sizes == [pytest.approx((0.5, 0.125)), pytest.approx((0.25, 0.0625)), pytest.approx((0.25, 0.0625))]


@pytest.mark.parametrize(
    ("height", "unit", "unfilled"), [(2.5, 248, True), (2.0, 250, True), (1.6, 190, False), (2.0, 55, False), (2.5, 238, False)]
)
def test_head_joints_of_blocks_in_thin_beds_are_unfilled(tmp_path, height: float, unit: float, unfilled: bool) -> None:
    """Courses of 250 mm of units of 248 mm; of 200 mm of 190 mm; of 250 mm of 238 mm; bricks."""
    (wall,) = walls(tmp_path, f"1,x,A,block,{height},1,0.2,250,{unit},5,,,0.3,0.6,0.5,0.6,F,40,40")
    types = tool.units_deck(wall)["joints"].get("types")
    assert types == ([{"joints": ["heads"], **tool.UNFILLED}] if unfilled else None)


def test_walls_of_units_have_a_bed_at_the_foot(tmp_path) -> None:
    """Held at both sides, the lowest bed could not open: a warning says so."""
    (wall,) = walls(tmp_path, "1,x,A,brick,1,1,0.2,500,500,5,,,0.3,0.6,0.5,0.6,F,40,40")
    deck = tool.units_deck(wall)
    held = deck | {"supports": {"held": [{"edge": "bottom"}]}}
    meshes = [Context(make_deck(one)).building.mesh(MeshOptions(**deck["analysis"][0]["mesh"])) for one in (deck, held)]
    assert [any("both sides of joints at the ground" in text for text in mesh.warnings) for mesh in meshes] == [False, True]
    assert len(meshes[0].ground) and meshes[1].ground is None


def test_walls_of_one_deck_are_run_once(tmp_path, monkeypatch) -> None:
    """Their names and measured peaks differ, and each has the prediction of the one run."""
    row = "brick,2,1,0.25,250,62.5,5,,,0.3,0.6,0.5,0.6"
    three = walls(tmp_path, f"1,x,A,{row},F,40,40", f"2,x,B,{row},S,50,50", f"3,x,C,{row.replace('0.5,0.6', '0.5,0.7')},S,50,50")
    ran: list[str] = []
    monkeypatch.setitem(tool.METHODS, "units", lambda wall: ran.append(wall.name) or {"units": tool.Predicted(wall.pressure)})
    monkeypatch.setattr(tool, "ProcessPoolExecutor", ThreadPoolExecutor)
    assert [by["units"].strength for by in tool.predict_all(three, ["units"], 1)] == [0.6e6, 0.6e6, 0.7e6]
    assert len(ran) == 2


def test_a_residual_strength_is_not_that_of_a_wall(tmp_path, monkeypatch) -> None:
    (wall,) = walls(tmp_path, "1,x,A,brick,3,1,0.25,250,65,5,,,0.3,0.9,1,0.2,F,40,40")
    strength = {"quantity": "lateral strength", "unit": "N", "capacity": 40e3}
    checks = {
        "ASCE 41 rocking of a pier": strength,
        "ASCE 41 residual sliding": strength | {"quantity": "residual strength", "capacity": 9e3},
    }
    monkeypatch.setattr(tool, "_answer", lambda deck: {"checks": checks})
    assert tool.by_codes(wall)["ASCE 41"].strength == 40e3
