"""Forces between blocks of the plane over time: reactions, momentum, work of friction, and blocks in space beside them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY

SLAB = {"kind": "block", "width": 2.0, "height": 0.4, "depth": 0.7}
WEIGHT = 2.0 * 0.4 * 0.7 * 2000.0 * GRAVITY
DRUMS = {"kind": "column", "width": 0.8, "height": 2.4, "drums": 3}
PULSE = {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.5}


def run(structure: dict[str, Any], friction: float, motion: dict[str, Any], folder: Path | None = None, **keys: Any) -> Result:
    tables = {"structure": structure, "joints": {"friction": friction, "normal_stiffness": 1e9}, "material": {"density": 2000.0}}
    deck = make_deck({**tables, "motion": motion, "analysis": {"kind": "dem", "perturbed": False, **keys}}, folder)
    (result,) = run_analyses(Context(deck, threads=1))
    assert result.status == "ok", result.reason
    return result


def numbers(result: Result) -> dict[str, np.ndarray]:
    return {name: array.numbers for name, array in result.arrays.items() if np.asarray(array.data).dtype.kind in "fi"}


def record(folder: Path, **waves: np.ndarray) -> dict[str, Any]:
    """A motion of waves `along` and `up` [g], every .01 s, in files."""
    for name, wave in waves.items():
        np.savetxt(folder / f"{name}.csv", np.column_stack([0.01 * np.arange(len(wave)), wave]), delimiter=",")
    return {"kind": "record", "file": "along.csv", "unit": "g", **({"vertical": "up.csv"} if "up" in waves else {})}


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_forces_and_work_of_friction_of_a_sliding_slab(tmp_path: Path, solver: str) -> None:
    """The reaction is weight and mu times it, against the slip; friction loses their product with the way."""
    motion = record(tmp_path, along=np.full(100, 0.5))
    found = run(SLAB, 0.3, motion, tmp_path, end_time=0.5, floor=0.0, solver=solver)
    a, late = numbers(found), slice(30, None)
    assert a["reaction"][late, 1] == pytest.approx(WEIGHT, rel=0.01)
    assert a["reaction"][late, 0] == pytest.approx(0.3 * WEIGHT, rel=0.02)
    assert found.results.peak_base_shear_over_weight == pytest.approx(0.3, rel=0.05)
    slid = abs(a["place"][-1, 0, 0] - a["place"][0, 0, 0])
    assert slid == pytest.approx(0.5 * 0.2 * GRAVITY * 0.25, rel=0.02)
    (row,) = found.results.joint_work
    assert row.name.endswith("/ ground") and row.friction_J == pytest.approx(0.3 * WEIGHT * slid, rel=0.01)
    assert a["pair_friction_work"][-1].sum() == pytest.approx(found.results.friction_loss_J, rel=1e-9)


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_what_a_contact_lost_is_kept_while_it_is_open(tmp_path: Path, solver: str) -> None:
    """A slab slides, is dropped by the ground, flies and lands: its losses never fall, and are those of the whole."""
    time = np.arange(0.0, 1.0, 0.01)
    motion = record(tmp_path, along=np.full(100, 0.5), up=np.where((time > 0.15) & (time < 0.25), -2.5, 0.0))
    found = run(SLAB, 0.3, motion, tmp_path, end_time=0.7, floor=0.0, solver=solver)
    a, r = numbers(found), found.results
    assert a["place"][:, 0, 1].max() > 0.13 and r.energy_residual_ratio < 0.02
    for name, whole in (("pair_friction_work", r.friction_loss_J), ("pair_damping_work", r.damping_loss_J)):
        assert np.diff(a[name], axis=0).min() >= -1e-9 * whole
        assert a[name][-1].sum() == pytest.approx(whole, rel=1e-9)


@pytest.mark.parametrize(
    ("structure", "friction", "solver"),
    [
        (DRUMS, 0.7, "nonsmooth"),
        ({"kind": "arch", "radius": 3.0, "thickness": 0.5, "embrace": 130.0, "voussoirs": 6}, 0.5, "compliant"),
        ({"kind": "brickwork", "units": 3, "courses": 4, "unit_length": 0.4, "unit_height": 0.2, "begins": "half"}, 0.4, "compliant"),
    ],
)
def test_forces_of_every_block_are_its_momentum(structure: dict[str, Any], friction: float, solver: str) -> None:
    """The forces of its pairs, less its weight and inertia, are the rate of the momentum of each block of columns, arches and walls."""
    found = run(structure, friction, PULSE, end_time=0.3, output_step=0.001, solver=solver)
    a = numbers(found)
    mass = make_deck({"structure": structure, "material": {"density": 2000.0}, "analysis": {"kind": "tilt"}}).building.blocks().mass
    step, blocks = np.diff(a["time"])[:, None], len(mass)
    inertia = np.column_stack([a["ground"], np.full(len(a["ground"]), GRAVITY)])
    for k in range(blocks):
        first, second = (a["pair_block"] == k).T
        force = a["pair_force"][:, first].sum(axis=1) - a["pair_force"][:, second].sum(axis=1)
        moves = force - mass[k] * inertia
        gained = np.cumsum(0.5 * (moves[1:] + moves[:-1]) * step, axis=0)
        momentum = mass[k] * a["rate"][:, k, :2]
        greatest = max(float(np.abs(momentum).max()), 0.01 * mass[k] * GRAVITY * float(a["time"][-1]))
        assert gained == pytest.approx((momentum[1:] - momentum[0]), abs=0.03 * greatest)
    assert a["pair_friction_work"][-1].sum() == pytest.approx(found.results.friction_loss_J, rel=1e-9, abs=1e-12)


def test_a_section_and_its_solids_have_the_same_reactions() -> None:
    """Springs of the plane and of space: reactions, forces and lost energy of drums that rock and slide, drawn out."""
    keys = {"end_time": 0.4, "output_step": 0.002, "joints": {"normal_stiffness": 1e9, "friction": 0.35}}
    plane, space = (run(DRUMS, 0.35, PULSE, **keys, **more) for more in ({}, {"direction": 0.0}))
    one, other = numbers(plane), numbers(space)
    weight = 0.8 * 2.4 * 2000.0 * GRAVITY
    impulse, drawn_out = (np.cumsum(r, axis=0) * 0.002 for r in (one["reaction"], other["reaction"][:, [0, 2]]))  # impacts last less
    assert impulse == pytest.approx(drawn_out, abs=0.005 * weight * 0.4)
    assert one["pair_friction_work"][-1] == pytest.approx(other["pair_friction_work"][-1], rel=0.03, abs=1e-3 * weight)
    assert plane.results.peak_base_shear_over_weight == pytest.approx(space.results.peak_base_shear_over_weight, rel=0.02)
    assert {"pair_name", "pair_block", "pair_force", "pair_friction_work", "pair_damping_work", "reaction"} <= set(plane.arrays) & set(
        space.arrays
    )


@pytest.mark.parametrize("keys", [{"solver": "compliant"}, {"solver": "nonsmooth"}, {"solver": "compliant", "direction": 0.0}])
def test_ties_to_the_ground_are_part_of_the_base_shear(keys: dict[str, Any]) -> None:
    """A block on slippery ground between two stiff ties: reactions, less inertia, are its momentum; contacts carry a tenth alone."""
    far = {"stiffness": "20 MN/m", "prestress": "1 kN"}
    middle = [0.0, 0.5] if "direction" in keys else [0.5]
    ties = [
        {"name": name, "start": [x, *middle], "start_stone": "block", "ground": [end, *middle], **far}
        for name, x, end in (("left", 0.0, -3.0), ("right", 1.0, 3.0))
    ]
    tables = {"structure": {"kind": "block", "width": 1.0, "height": 1.0}, "material": {"density": 2000.0}, "ties": ties}
    tables |= {"joints": {"friction": 0.05, "normal_stiffness": 1e9}, "motion": PULSE | {"period": 0.6}}
    deck = make_deck({**tables, "analysis": {"kind": "dem", "perturbed": False, "end_time": 0.5, "output_step": 0.0005, **keys}})
    (found,) = run_analyses(Context(deck, threads=1))
    assert found.status == "ok", found.reason
    a = numbers(found)
    moves = a["reaction"][:, 0] - 2000.0 * a["ground"]
    gained = np.cumsum(0.5 * (moves[1:] + moves[:-1]) * 0.0005)
    momentum = 2000.0 * a["rate"][:, 0, 0]
    assert gained == pytest.approx(momentum[1:] - momentum[0], abs=0.02 * 2000.0 * 0.5 * GRAVITY * 0.3)
    assert found.results.peak_base_shear_N == pytest.approx(2000.0 * 0.5 * GRAVITY, rel=0.1)
    assert not any("formed during the motion" in text for text in found.warnings)


@pytest.mark.parametrize("keys", [{}, {"direction": 0.0}])
def test_blocks_that_fall_on_a_floor_are_stated(keys: dict[str, Any]) -> None:
    """The upper of two drums falls over and lies on a floor: it is named, since the floor is no part of the reactions."""
    motion = {"kind": "sine-pulse", "amplitude": "0.9 g", "period": 0.8}
    fallen = {"kind": "column", "width": 0.15, "height": 0.6, "drums": 2}
    found = run(fallen, 0.6, motion, end_time=1.6, floor=0.0, stop_at_collapse=False, **keys)
    (stated,) = [text for text in found.warnings if "formed during the motion" in text]
    assert "carry drum 2;" in stated
