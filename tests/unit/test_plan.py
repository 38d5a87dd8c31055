"""Buildings on a plan: what decks may say, and how the mesher joins walls, openings and floors."""

import numpy as np
import pytest
from pydantic import ValidationError

from extrados.model.errors import BadGeometry, NoView
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import meeting
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.shell.mesh import nodal_areas
from extrados.views.shell.options import ShellOptions

WALLS = (
    {
        "name": "front",
        "start": [0.0, 0.0],
        "end": [6.0, 0.0],
        "thickness": 0.3,
        "openings": [{"storey": 1, "x": [1.0, 2.0], "z": [0.0, 2.1]}, {"storey": 2, "x": [1.0, 2.0], "z": [0.8, 2.0]}],
    },
    {"name": "right", "start": [6.0, 0.0], "end": [6.0, 5.0], "thickness": 0.3},
    {"name": "back", "start": [6.0, 5.0], "end": [0.0, 5.0], "thickness": 0.3},
    {"name": "left", "start": [0.0, 5.0], "end": [0.0, 0.0], "thicknesses": [0.3, 0.2]},
)
FLOOR = {"storey": 2, "young": 50e6, "thickness": 0.05, "load": 2e3}


def plan(walls=WALLS, **keys):
    return Plan(kind="building", storeys=[3.0, 2.8], walls=[dict(w) for w in walls], **keys)


def meshed(structure, size=0.5, **options):
    return Building(structure, Material(density=2000.0)).shell(ShellOptions(size=size, **options))


def edges_of(mesh, name):
    """Of a part, its edges and how many of its elements have each."""
    part = next(p for p in mesh.parts if p.name == name)
    sides = np.sort(
        np.concatenate([np.stack([part.connect[:, k], np.roll(part.connect, -1, 1)[:, k]], 1) for k in range(part.connect.shape[1])]), 1
    )
    return np.unique(sides, axis=0, return_counts=True)


def test_walls_meet_at_their_corners():
    """Every edge of one wall on a corner is an edge of the other too: the mesh conforms."""
    mesh = meshed(plan())
    for one, two, (x, y) in (("front", "right", (6, 0)), ("right", "back", (6, 5)), ("left", "front", (0, 0))):
        on = [{tuple(e) for e, n in zip(*edges_of(mesh, name), strict=True) if np.allclose(mesh.xyz[e, :2], (x, y))} for name in (one, two)]
        assert on[0] == on[1] and len(on[0]) >= 11
    assert len(np.unique(np.round(mesh.xyz, 9), axis=0)) == len(mesh.xyz)


def test_mass_is_that_of_the_walls_less_the_openings():
    mesh = meshed(plan(floors=[FLOOR]))
    front, right, left = 6 * 5.8 - 2.1 - 1.2, 5 * 5.8, 5 * (0.3 * 3.0 + 0.2 * 2.8)
    volume = 0.3 * (front + right + 6 * 5.8) + left
    assert mesh.mass().sum() == pytest.approx(2000.0 * volume + 2e3 * 30.0 / GRAVITY, rel=1e-12)


def test_open_corners_share_no_node_and_weak_ones_have_less_strength():
    bonded = meshed(plan())
    opened = meshed(plan(corners=[{"walls": ["front", "right"], "bond": "open"}]))
    assert len(opened.xyz) == len(bonded.xyz) + len(np.unique(np.round(bonded.xyz[:, 2], 9)))
    front, right = ({n for p in opened.parts if p.name == name for n in p.connect.ravel().tolist()} for name in ("front", "right"))
    assert not front & right
    weak = meshed(plan(corners=[{"walls": ["front", "right"], "bond": "weak", "strength": 0.4}]))
    part = next(p for p in weak.parts if p.name == "right")
    beside = weak.xyz[part.connect][..., 1].min(axis=1) < 1e-9
    assert np.allclose(part.strength[beside], 0.4) and np.allclose(part.strength[~beside], 1.0)
    assert all((p.strength == 1.0).all() for p in weak.parts if p.name != "right")


def test_a_floor_hangs_on_all_nodes_around_it():
    """No edge of the floor's rim is free, and its area is that of the room."""
    mesh = meshed(plan(floors=[FLOOR]))
    floor = next(p for p in mesh.parts if not p.bends)
    edges, count = edges_of(mesh, floor.name)
    rim = {tuple(e) for e in edges[count == 1].tolist()}
    walls = {tuple(e) for p in mesh.parts if p.bends for e in edges_of(mesh, p.name)[0].tolist()}
    assert rim <= walls
    assert nodal_areas(mesh.xyz, floor.connect).sum() == pytest.approx(30.0)
    inside = set(floor.connect.ravel().tolist()) - {n for e in walls for n in e}
    assert {(n, d) for n in inside for d in (2, 3, 4, 5)} <= set(mesh.held)


def test_cross_walls_and_skew_walls_conform():
    """A wall that crosses another in its middle, and one at an angle."""
    walls = [
        *WALLS,
        {"name": "middle", "start": [3.0, 0.0], "end": [3.0, 5.0], "thickness": 0.2, "storeys": [1, 1]},
        {"name": "skew", "start": [3.0, 2.5], "end": [6.0, 4.0], "thickness": 0.2},
    ]
    mesh = meshed(plan(walls))
    middle, skew = ({n for p in mesh.parts if p.name == name for n in p.connect.ravel().tolist()} for name in ("middle", "skew"))
    front = {n for p in mesh.parts if p.name == "front" for n in p.connect.ravel().tolist()}
    assert {round(z, 9) for z in mesh.xyz[sorted(front & middle), 2]} == {z for z in np.round(mesh.xyz[:, 2], 9) if z <= 3.0}
    assert len(middle & skew) == len(front & middle)
    assert (mesh.xyz[sorted(middle), 2] <= 3.0 + 1e-9).all()


def test_lintels_stay_elastic():
    walls = [dict(w) for w in WALLS]
    walls[0]["openings"] = [{"storey": 1, "x": [1.0, 2.0], "z": [0.0, 2.1], "lintel": {"depth": 0.25, "bearing": 0.2}}]
    mesh = meshed(plan(walls))
    part = mesh.parts[0]
    box = mesh.xyz[part.connect[part.linear]].reshape(-1, 3)
    assert box[:, 0].min() == pytest.approx(0.8) and box[:, 0].max() == pytest.approx(2.2)
    assert box[:, 2].min() == pytest.approx(2.1) and box[:, 2].max() == pytest.approx(2.35)


def test_springs_of_the_ground_are_those_of_the_soles():
    mesh = meshed(plan(foundation_stiffness=1e8))
    sole = 0.3 * (5.0 + 5.0 + 6.0 + 5.0)  # the door takes a metre of the front
    assert sum(k for *_, k in mesh.springs) == pytest.approx(1e8 * sole)
    assert not any(d == 2 for _, d in mesh.held)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"walls": [{**WALLS[0], "openings": [{"storey": 1, "x": [5.0, 7.0], "z": [0.0, 2.0]}]}]}, "the wall is 6 m"),
        ({"walls": [{**WALLS[0], "openings": [{"storey": 1, "x": [1.0, 2.0], "z": [0.0, 3.0]}]}]}, "does not fit"),
        ({"walls": [{**WALLS[0], "openings": [{"storey": 3, "x": [1.0, 2.0], "z": [0.0, 2.0]}]}]}, "no storey 3"),
        ({"walls": [WALLS[0], WALLS[0]]}, "occurs twice"),
        ({"walls": [{**WALLS[1], "thicknesses": [0.3]}]}, "either thickness or thicknesses"),
        ({"walls": [{"name": "a", "start": [0.0, 0.0], "end": [1.0, 0.0], "thicknesses": [0.3]}]}, "1 thicknesses for 2"),
        ({"corners": [{"walls": ["front", "nowhere"], "bond": "open"}]}, "wall 'nowhere' does not exist"),
        ({"floors": [{"storey": 3, "kind": "none"}]}, "storey 3 does not exist"),
        ({"floors": [{"storey": 1, "kind": "flexible"}]}, "requires young"),
    ],
)
def test_wrong_plans_are_reported(change, words):
    with pytest.raises(ValidationError, match=words):
        plan(**{"walls": WALLS, **change})


def test_parts_that_do_not_fit_together_are_reported():
    with pytest.raises(BadGeometry, match="ring"):
        meshed(plan([WALLS[0], WALLS[1], WALLS[2]], floors=[FLOOR]))
    with pytest.raises(BadGeometry, match="overlap in plan"):
        meshed(plan([WALLS[0], {"name": "same", "start": [1.0, 0.0], "end": [3.0, 0.0], "thickness": 0.3}]))
    with pytest.raises(BadGeometry, match="ground"):
        meshed(plan([{**WALLS[1], "storeys": [2, 2]}]))
    with pytest.raises(NoView, match="plane"):
        Building(plan()).blocks()


@pytest.mark.parametrize("start, end", [(0, 6), (6, 0), (0, 3), (1, 3), (-1, 7), (5, 8), (3, 6)])
def test_walls_that_lie_on_each_other_are_refused(start, end):
    """Whichever of them is longer, and whether or not they have an end in common; end to end they meet."""
    beside = {"name": "same", "start": [float(start), 0.0], "end": [float(end), 0.0], "thickness": 0.3}
    with pytest.raises(BadGeometry, match="'front' and 'same' overlap in plan"):
        meshed(plan([WALLS[0], beside]))
    beside |= {"start": [6.0, 0.0], "end": [9.0, 0.0]}
    assert not meshed(plan([WALLS[0], beside])).warnings


def test_walls_that_end_short_of_each_other_are_reported():
    for gap, told in ((0.0, False), (0.05, True), (0.29, True), (0.31, False)):
        side = {"name": "side", "start": [6.0 + gap, 0.0], "end": [6.0 + gap, 5.0], "thickness": 0.3}
        warnings = meshed(plan([WALLS[0], side])).warnings
        assert any("end 0." in w and "are not connected" in w for w in warnings) == told, (gap, warnings)


def test_meeting_points():
    one, two = plan().walls[:2]
    assert meeting(one, two) == pytest.approx((6.0, 0.0))
    assert meeting(one, plan().walls[2]) is None
