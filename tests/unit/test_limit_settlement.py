"""Supports that give way under any structure: openings, work, laws of the joints."""

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.programme import LimitAnalysis
from extrados.limit.settlement import settle
from extrados.limit.supports import support_movement
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structures.arch import make_arch
from extrados.model.structures.brickwork import Bond, make_brickwork
from extrados.model.structures.vault import make_vault


def moved(assembly: Assembly, joint: str, dx: float = 0.0, dy: float = 0.0, turn: float = 0.0) -> np.ndarray:
    movement = np.zeros((len(assembly.a), 3))
    movement[assembly.joint_names.index(joint)] = dx, dy, turn
    return movement


@pytest.fixture(scope="module")
def spreading() -> tuple[Assembly, list]:
    """An arch, and the states of its finite way when its right support moves outward."""
    arch = make_arch(10.0, 1.5, 157.5, 16)
    return arch, support_movement(arch, (1.0, 0.0), 20000)


@pytest.mark.parametrize("form", ["reduced", "sparse"])
def test_arch_as_its_first_three_hinges(form: str, spreading: tuple[Assembly, list]) -> None:
    """A spreading arch opens where the finite way of three hinges begins, by what their kinematics give."""
    arch, (rest, first, *_) = spreading
    last = arch.joint_names[arch.chains["arch"][-1]]
    small = 1e-4
    found = settle(LimitAnalysis(arch, form=form), moved(arch, last, dx=small))
    joints = arch.chains["arch"]
    opens = np.flatnonzero(found.motion.max(axis=1) > 1e-9)
    assert opens.tolist() == [joints[k] for k, _ in rest.hinges]
    # Rotations of first order against those of the finite way, per movement.
    rates = (first.pose[:, 2] - rest.pose[:, 2]) / first.movement
    assert found.pose[:, 2] / small == pytest.approx(rates, rel=2e-3, abs=1e-6)
    least, _ = LimitAnalysis(arch, form=form).thrust(joints)
    assert abs(found.state.force(arch)[joints[-1], 0]) == pytest.approx(abs(least.force(arch)[joints[-1], 0]), rel=1e-9)
    assert found.gap < 1e-9 * found.work


def test_openings_obey_the_laws() -> None:
    """A wall over a corner that sinks: no joint overlaps or dilates less than it slides, pressed ends stay closed."""
    wall = make_brickwork(Bond(0.4, 0.175), 2.0, 1.05)
    base = [n for j, n in enumerate(wall.joint_names) if wall.b[j] == GROUND]
    limit = LimitAnalysis(wall, 0.6)
    found = settle(limit, moved(wall, base[-1], dy=-0.01))
    opening, slip = found.motion[:, :2], found.motion[:, 2]
    assert opening.min() > -1e-12
    assert (opening.min(axis=1) >= 0.6 * np.abs(slip) - 1e-10).all()
    force = np.column_stack([1.0 - found.state.position, found.state.position]) * found.state.normal[:, None]
    dilated = opening - 0.6 * np.abs(slip)[:, None]
    assert float((force * dilated).sum()) < 1e-6 * found.work
    assert found.gap < 1e-9 * max(found.work, 1.0) and found.work > 0.0


def test_whole_structure_moves_with_its_ground() -> None:
    """Where all supports move alike nothing opens."""
    vault = make_vault(10.0, 1.5, 120.0, 24, 8.5, 5.67, 25.5)
    movement = moved(vault, "left base", dx=0.02, dy=-0.03) + moved(vault, "right base", dx=0.02, dy=-0.03)
    found = settle(LimitAnalysis(vault, 0.7), movement)
    assert np.abs(found.motion).max() < 1e-9
    assert found.pose - np.column_stack([vault.centroid, np.zeros(len(vault.mass))]) == pytest.approx(
        np.tile([0.02, -0.03, 0.0], (len(vault.mass), 1)), abs=1e-9
    )


def test_driver_and_refusals() -> None:
    def run(movement: dict | None, structure: dict):
        deck = {"structure": structure, "analysis": {"kind": "supports"}}
        if movement:
            deck["initial"] = {"movements": [movement]}
        return run_analyses(Context(make_deck(deck), threads=1))[0]

    vault = {"kind": "vault", "preset": "dejong-a"}
    result = run({"joint": "right base", "turn": -0.1}, vault)
    assert result.status == "ok" and result.results.openings[0].name == "joint 12"
    assert result["work_gap_J"] < 1e-6 * result["work_J"]
    assert "right base" in run({"joint": "nowhere", "dy": -0.1}, vault).reason
    assert "not on the ground" in run({"joint": "joint 3", "dy": -0.1}, vault).reason
    spread = run(None, vault)
    assert [o.name for o in spread.results.openings] and spread.results.movement_at_fall_m is None
    column = {"kind": "column", "width": 1.0, "height": 4.0, "drums": 4}
    assert "has only one support" in run(None, column).reason
    assert run(None, {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}).status == "ok"


def test_the_right_support_of_any_structure_spreads() -> None:
    """A wall over a door: its right pier moves out; what the stones of the pier do is what [[initial.movements]] asks."""
    structure = {
        "kind": "brickwork",
        "units": 6,
        "courses": 9,
        "unit_length": 0.5,
        "unit_height": 0.25,
        "openings": [{"x": [1.0, 2.0], "y": [0.0, 1.25]}],
    }

    def run(**tables):
        deck = make_deck({"structure": structure, "analysis": {"kind": "supports", **tables.pop("asked", {})}, **tables})
        return deck.building.blocks(), run_analyses(Context(deck, threads=1))[0]

    assembly, found = run(asked={"movement": "5 mm"})
    right = [
        assembly.joint_names[j] for j in range(len(assembly.a)) if GROUND in (assembly.a[j], assembly.b[j]) and assembly.middle[j, 0] > 1.5
    ]
    _, same = run(initial={"movements": [{"joint": name, "dx": 0.005} for name in right]})
    assert found.status == same.status == "ok"
    assert found.results.work_J == pytest.approx(same.results.work_J)
    assert found.results.work_gap_J < 1e-6 * abs(found.results.work_J) + 1e-9
    assert found.arrays["support_movement"].data == pytest.approx(same.arrays["support_movement"].data)


def test_stones_wedged_without_sliding_follow_where_they_can() -> None:
    """A wall without sliding, whose stones may press each other as they like: it settles, tells the least forces, and
    refuses only what would crush it."""
    structure = {"kind": "brickwork", "units": 4, "courses": 8, "unit_length": 0.5, "unit_height": 0.25}

    def run(**movement: float):
        deck = {
            "structure": structure,
            "joints": {"friction": "no-sliding"},
            "analysis": {"kind": "supports"},
            "initial": {"movements": [{"joint": "base of unit 4", **movement}]},
        }
        return run_analyses(Context(make_deck(deck), threads=1))[0]

    apart = run(dx=0.02)
    assert apart.status == "ok" and apart.results.work_gap_J < 1e-6 * abs(apart.results.work_J) + 1e-9
    deck = make_deck({"structure": structure, "analysis": {"kind": "supports"}})
    weight = 9.80665 * deck.building.blocks().mass.sum()
    assert sum(r.vertical_N for r in apart.results.reactions) == pytest.approx(weight)
    assert max(abs(r.horizontal_N) for r in apart.results.reactions) < weight
    together = run(dx=-0.02)
    assert together.status == "refused" and "without crushing" in together.reason
