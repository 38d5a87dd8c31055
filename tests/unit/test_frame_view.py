"""Piers, spandrels and rigid nodes of walls on a plan; loads, floors and modes of the frame."""

import numpy as np
import pytest
from scipy.linalg import eigh

from extrados.analyses.frame.modes import modes_of
from extrados.decks.reader import make_deck, read_deck
from extrados.model.errors import BadGeometry
from extrados.schema.constants import GRAVITY
from extrados.views.frame.options import FrameOptions
from extrados.views.frame.rules import Side, deformable

WINDOW, DOOR, FREE = Side(0.9, 2.3), Side(0.0, 2.2), Side()


@pytest.mark.parametrize(
    ("depth", "left", "right", "dolce", "lagomarsino"),
    [(1.5, FREE, WINDOW, (0.373, 2.744), 2.2), (1.3, WINDOW, DOOR, (0.365, 2.410), 1.8), (1.0, DOOR, FREE, (0.0, 2.557), 2.6)],
)
def test_worked_wall(depth, left, right, dolce, lagomarsino):
    """A wall of 6 m and 3 m height with a window and a door, worked by hand; and its mirror image."""
    for sides in ((left, right), (right, left)):
        foot, height = deformable("dolce", depth, 3.0, *sides)
        assert (foot, foot + height) == pytest.approx(dolce, abs=6e-4)
        assert deformable("lagomarsino", depth, 3.0, *sides)[1] == pytest.approx(lagomarsino, abs=1e-9)


def box(floor="rigid", **changes):
    """Four walls of one storey around a room of 6 by 4 m; the front wall has a door."""
    kind = {"rigid": {"kind": "rigid"}, "soft": {"young": 1e3, "thickness": 0.01}}[floor]
    walls = [
        {"name": "front", "start": [0, 0], "end": [6, 0], "thickness": 0.4, "openings": [{"storey": 1, "x": [2, 3], "z": [0, 2.2]}]},
        {"name": "right", "start": [6, 0], "end": [6, 4], "thickness": 0.3},
        {"name": "back", "start": [6, 4], "end": [0, 4], "thickness": 0.4},
        {"name": "left", "start": [0, 4], "end": [0, 0], "thickness": 0.3},
    ]
    structure = {
        "kind": "building",
        "storeys": [3.0],
        "walls": walls,
        "floors": [{"storey": 1, "load": 4e3, "bears_on": ["front", "back"], **kind}],
    } | changes
    return make_deck(
        {
            "structure": structure,
            "material": {"density": 1800, "young": 2e9, "poisson": 0.25, "compressive_strength": 4e6},
            "joints": {"cohesion": 0.1e6},
            "analysis": [{"kind": "frame-modes"}],
        }
    ).building


def test_weight_is_that_of_the_drawing():
    frame = box().frame()
    masonry = 0.4 * (2 * 6 * 3 - 2.2) + 2 * 0.3 * 4 * 3
    weight = masonry * 1800 * GRAVITY + 4e3 * 24
    assert frame.total_weight == pytest.approx(weight, rel=1e-12)
    with frame.core() as core:
        force = core.at_rest().force
    feet = sum(f[0] for f, s in zip(force, frame.strips, strict=True) if s.kind == "pier" and s.storey == 1)
    # The lower halves of the piers go to the ground at once
    lower = 0.5 * 1800 * GRAVITY * (0.4 * 3 * (6 + 5) + 2 * 0.3 * 4 * 3)
    assert feet == pytest.approx(weight - lower, rel=1e-6)


@pytest.mark.parametrize("name", ["building/two-rooms", "building/yi"])
def test_weight_is_that_of_the_shells(name):
    building = read_deck(f"cases/{name}.toml").building
    shell = building.shell()
    assert building.frame(FrameOptions(cohesion=1e5)).total_weight == pytest.approx(shell.mass().sum() * GRAVITY, rel=1e-3)


def test_a_room_on_a_rigid_floor_is_a_sum_of_its_walls():
    """Along y only the two solid walls resist: two cantilevers with no rotation of the other walls; stiffness by Timoshenko."""
    frame = box().frame()
    with frame.core() as core:
        tangent = core.at_rest().tangent
    own = [frame.along[w, 1] for w in (1, 3)]
    e, g, t, length, h = 1e9, 4e8, 0.3, 4.0, 3.0
    held = 1.0 / (h**3 / (12 * e * t * length**3 / 12) + 1.2 * h / (g * length * t))
    assert tangent[own[0], own[0]] - frame.linear[own[0], own[0]] == pytest.approx(held, rel=0.02)
    # The floor resists neither a translation nor a rotation as a whole
    for direction in ((1.0, 0.0), (0.0, 1.0)):
        unit = frame.unit(np.array(direction))
        assert np.abs(frame.linear @ unit).max() < 1e-6 * np.abs(frame.linear).max()
    turn = np.zeros(len(frame.weight))
    for w, wall in enumerate(frame.plan.walls):
        x, y = wall.start
        turn[frame.along[w, 1]] = wall.direction @ np.array([-y, x])
    assert np.abs(frame.linear @ turn).max() < 1e-6 * np.abs(frame.linear).max()


def test_masses_move_with_the_ground():
    for floor in ("rigid", "soft"):
        frame = box(floor).frame()
        for direction in np.eye(2):
            unit = frame.unit(direction)
            for one in frame.masses:
                assert one.rows @ unit == pytest.approx(direction, abs=1e-12)
            total = sum(one.mass for one in frame.masses)
            assert unit @ frame.mass @ unit == pytest.approx(total, rel=1e-12)
            assert frame.control(direction, 1) @ unit == pytest.approx(1.0)


def test_modes_take_all_the_mass_and_agree_with_a_penalty_for_freedoms_without():
    """All modes together take the whole mass; frequencies as of the whole matrices with small masses where there are none."""
    frame = box().frame()
    with frame.core() as core:
        tangent = core.at_rest().tangent
    modes = modes_of(frame, tangent, 4)
    total = sum(one.mass for one in frame.masses)
    for direction in np.eye(2):
        assert sum(m.participating(direction) for m in modes) == pytest.approx(total, rel=1e-9)
    small = frame.mass + 1e-6 * np.eye(len(frame.mass))
    whole = np.sqrt(eigh(0.5 * (tangent + tangent.T), small, eigvals_only=True)[:3]) / (2 * np.pi)
    assert [m.frequency for m in modes[:3]] == pytest.approx(whole, rel=1e-4)


def test_soft_floors_leave_walls_apart():
    """The front wall moves by itself: its frequency is that of its own frame and masses."""
    frame = box("soft").frame()
    with frame.core() as core:
        tangent = core.at_rest().tangent
    modes = modes_of(frame, tangent, 4)
    shapes = [m.shape[[frame.along[w, 1] for w in range(4)]] for m in modes]
    alone = [np.sort(np.abs(s) / np.abs(s).max())[-2] for s in shapes]
    assert min(alone) < 0.3


def test_what_a_frame_cannot_be_is_refused():
    walls = [
        {"name": "a", "start": [0, 0], "end": [3, 0], "thickness": 0.4, "storeys": [2, 2]},
        {"name": "b", "start": [0, 0], "end": [0, 3], "thickness": 0.4},
    ]
    with pytest.raises(BadGeometry, match="does not reach the ground"):
        box(walls=walls, storeys=[3.0, 3.0], floors=[]).frame()
    with pytest.raises(BadGeometry, match='shear = "turnsek-cacovic" requires `diagonal_strength`'):
        box().frame(FrameOptions(shear="turnsek-cacovic"))


def test_a_spandrel_between_misaligned_windows_has_their_mean_edges():
    openings = [{"storey": 1, "x": [2.0, 3.0], "z": [0.0, 2.2]}, {"storey": 2, "x": [2.4, 3.4], "z": [0.8, 2.0]}]
    walls = [
        {"name": "front", "start": [0, 0], "end": [6, 0], "thickness": 0.4, "openings": openings},
        {"name": "side", "start": [0, 0], "end": [0, 4], "thickness": 0.3},
    ]
    frame = box(walls=walls, storeys=[3.0, 3.0], floors=[]).frame()
    spandrel = next(s for s in frame.strips if s.kind == "spandrel")
    assert spandrel.part == pytest.approx((2.2, 3.2, 2.2, 3.8))
    node = frame.nodes[spandrel.nodes[0]]
    assert (node.start, node.end) == (0.0, 2.4)
