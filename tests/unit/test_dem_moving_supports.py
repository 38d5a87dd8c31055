"""Supports of blocks in space that move: work of the supports, blocks on three footings, and sections drawn out."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import three_figures

DRUMS = {"kind": "column", "section": "round", "sides": 6, "width": 0.8, "height": 1.2, "drums": 2}
ARCH = {"kind": "arch", "radius": 3.0, "thickness": 0.6, "embrace": 120.0, "voussoirs": 5, "depth": 0.5}


def run(structure: dict[str, Any], movements: list[dict[str, Any]], folder: Path | None = None, **keys: Any) -> Result:
    tables = {"structure": structure, "material": {"density": 2000.0}, "joints": {"friction": 0.7, "normal_stiffness": 1e9}}
    tables |= {"initial": {"movements": movements}, "analysis": {"kind": "dem", "perturbed": False, **keys}}
    (result,) = run_analyses(Context(make_deck(tables, folder), threads=1))
    return result


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_the_work_of_a_support_lifts_and_carries_what_stands_on_it(solver: str) -> None:
    """Up by 50 mm the support does weight times lift; sideways the drums go with it, and the ledger closes."""
    moves = [{"joint": "drum 1 on the ground", "dx": 0.03, "dy": -0.02, "dz": 0.05, "duration": 1.0}]
    found = run(DRUMS, moves, direction=0.0, end_time=1.2, solver=solver)
    assert found.status == "ok", found.reason
    weight = 2000.0 * GRAVITY * 1.2 * 3.0 * np.sin(np.pi / 3) * 0.16
    shift = found.arrays["shift"].numbers[-1]
    assert shift == pytest.approx(np.tile([0.03, -0.02, 0.05], (2, 1)), abs=2e-4)
    work = found.arrays["work_energy"].numbers
    assert work[-1] == pytest.approx(0.05 * weight, rel=0.01)
    assert found.results.energy_residual_ratio < 0.01
    assert found.results.peak_slip_m < 5e-4 and found.results.outcome == "at-rest"


@pytest.mark.parametrize("section", [{}, {"direction": 0.0}])
@pytest.mark.parametrize("dz", [50.0, -1.0])
def test_a_column_that_its_footing_carries_up_or_down_does_not_collapse(dz: float, section: dict[str, Any]) -> None:
    """Slowly by forty times its height, or down by most of it: the drums stay where they are on their footing."""
    upward = "dz" if section else "dy"
    found = run(
        {"kind": "column", "section": "rectangle", "width": 0.8, "height": 1.2, "drums": 2},
        [{"joint": "base", upward: dz, "duration": 20.0}],
        solver="nonsmooth",
        end_time=21.0,
        **section,
    )
    assert found.results.outcome == "at-rest" and found.results.peak_displacement_m < 0.01
    assert "no block rotates, no slip" in found.answer and f"Supports move by {three_figures(1e3 * abs(dz))} mm" in found.answer
    assert "weight times lift" in found.answer


def table(folder: Path) -> dict[str, Any]:
    """A slab on three posts on the ground, in a file of solids; the third post is not symmetric."""
    lines, first = [], 1

    def add(name: str, low: tuple[float, float, float], high: tuple[float, float, float]) -> None:
        nonlocal first
        lines.append(f"o {name}")
        lines.extend(f"v {(low, high)[i][0]} {(low, high)[j][1]} {(low, high)[k][2]}" for k in (0, 1) for j in (0, 1) for i in (0, 1))
        faces = ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6))
        lines.extend("f " + " ".join(str(first + v - 1) for v in face) for face in faces)
        first += 8

    for k, (x, y) in enumerate(((0.0, 0.0), (1.7, 0.1), (0.9, 1.5))):
        add(f"post{k}", (x, y, 0.0), (x + 0.2, y + 0.2, 0.5))
    add("slab", (0.0, 0.0, 0.5), (2.0, 1.8, 0.7))
    (folder / "table.obj").write_text("\n".join(lines) + "\n")
    return {"kind": "blocks", "file": "table.obj", "unit": "m"}


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_a_footing_that_settles_tilts_a_slab_on_three_posts(tmp_path: Path, solver: str) -> None:
    """The slab turns about the line of the other two posts: its lowest support goes down with the footing, and does negative work."""
    names = make_deck({"structure": table(tmp_path), "analysis": {"kind": "tilt"}}, tmp_path).building.solids().joint_names
    (joint,) = [name for name in names if name.startswith("post2") and "ground" in name]
    found = run(table(tmp_path), [{"joint": joint, "dz": -0.02, "duration": 1.0}], tmp_path, end_time=1.3, solver=solver)
    assert found.status == "ok", found.reason
    shift = found.arrays["shift"].numbers[-1]
    assert shift[2, 2] == pytest.approx(-0.02, abs=5e-4) and np.abs(shift[:2, 2]).max() < 1e-3
    sinks = shift[3, 2]  # of the middle of the slab, between the line of both posts and the third
    assert -0.02 < sinks < -0.005
    work = found.arrays["work_energy"].numbers[-1]
    lifted = -2000.0 * GRAVITY * (2.0 * 1.8 * 0.2 * sinks + 0.2 * 0.2 * 0.5 * shift[:3, 2].sum())
    assert work == pytest.approx(-lifted, rel=0.05)
    assert found.results.energy_residual_ratio < 0.01


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_a_spreading_arch_moves_as_its_section_does(tmp_path: Path, solver: str) -> None:
    """Elements of the plane and of space: the right springing spreads by 1 % of the span, hinges open alike.

    An even number of voussoirs has one joint at the crown; with a keystone the hinge opens at either of its joints.
    """
    arch = {**ARCH, "voussoirs": 6}
    section = make_deck({"structure": arch, "analysis": {"kind": "tilt"}}).building.blocks()
    plane_moves = [{"joint": section.joint_names[-1], "dx": 0.03, "dy": -0.01, "duration": 2.0}]
    text = extrados.export({"structure": arch, "material": {"density": 2000.0}, "analysis": [{"kind": "tilt"}]}, "compas")
    (tmp_path / "stones.json").write_text(text)
    file = {"kind": "blocks", "file": "stones.json", "unit": "m"}
    solids = make_deck({"structure": file, "analysis": {"kind": "tilt", "direction": 0.0}}, tmp_path).building.solids()
    right = int(np.argmax([p[:, 0].mean() for p in solids.polygon]))
    space_moves = [{"joint": solids.joint_names[right], "dx": 0.03, "dz": -0.01, "duration": 2.0}]
    plane = run(arch, plane_moves, end_time=2.3, solver=solver)
    space = run(file, space_moves, tmp_path, end_time=2.3, direction=0.0, solver=solver)
    assert plane.status == space.status == "ok", plane.reason or space.reason
    centroid = plane.arrays["place"].numbers[-1, :, :2] - plane.arrays["place"].numbers[0, :, :2]
    moved = space.arrays["shift"].numbers[-1][:, [0, 2]]
    order = np.argsort(solids.centroid[:, 0])
    assert moved[order] == pytest.approx(centroid[np.argsort(section.centroid[:, 0])], abs=1e-4)
    work = [one.arrays["work_energy"].numbers[-1] for one in (plane, space)]
    assert work[1] == pytest.approx(work[0], rel=3e-3)


def test_what_moves_in_space_is_refused_where_it_cannot() -> None:
    moves = [{"joint": "drum 1 on the ground", "dz": -0.01}]
    assert "floor" in run(DRUMS, moves, direction=0.0, floor=0.0).reason
    assert "turn" in run(DRUMS, [{**moves[0], "turn": 1.0}], direction=0.0).reason
    assert 'test = "motion"' in run(DRUMS, moves, direction=0.0, test="tilt").reason
    assert "does not exist" in run(DRUMS, [{"joint": "nowhere", "dz": 0.1}], direction=0.0).reason
    assert "dz" in run(ARCH, [{"joint": "joint 0", "dz": 0.1}]).reason


def test_a_settlement_of_a_plane_section_in_space_is_dz() -> None:
    """In the plane dy is upward, in space across the section: a deck that keeps dy is refused, not shoved sideways."""
    name = make_deck({"structure": ARCH, "analysis": {"kind": "tilt"}}).building.blocks().joint_names[-1]
    keys = {"end_time": 0.1, "solver": "nonsmooth"}
    found = run(ARCH, [{"joint": name, "dy": -0.05}], direction=0.0, **keys)
    assert found.status != "ok" and "give `dz` for a settlement" in found.reason
    for movement, more in (({"dy": -1e-4}, {}), ({"dz": -1e-4}, {"direction": 0.0})):
        assert run(ARCH, [{"joint": name, **movement}], **keys, **more).status == "ok"
