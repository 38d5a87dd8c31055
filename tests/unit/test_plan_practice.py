"""Gables, roofs, openings through storeys and walls that cross, on a plan: weights and forces by hand, alike in frames and shells."""

import copy
import itertools

import numpy as np
import pytest

from extrados.analyses.codes.walls import wall_parts
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry
from extrados.schema.constants import GRAVITY
from extrados.views.frame.options import FrameOptions
from extrados.views.shell.options import ShellOptions

ROOF = {"storey": 1, "young": 5e7, "thickness": 0.05, "load": 800.0, "pitch": 30.0, "roof": "rafters", "bears_on": ["south", "north"]}


def deck(**structure):
    """A room of 6 m by 4 m and 3 m; the walls are 0.4 m thick, east and west have gables 1.2 m high."""
    corners = [[0, 0], [6, 0], [6, 4], [0, 4]]
    walls = [
        {"name": name, "start": corners[k], "end": corners[(k + 1) % 4], "thickness": 0.4}
        | ({"gable": {"rise": 1.2}} if name in ("east", "west") else {})
        for k, name in enumerate(("south", "east", "north", "west"))
    ]
    return {
        "structure": {"kind": "building", "storeys": [3.0], "walls": walls, "floors": [copy.deepcopy(ROOF)]} | structure,
        "material": {"density": 2000.0, "young": 1.5e9, "tensile_strength": 1e5, "fracture_energy": 30.0},
        "joints": {"cohesion": 1e5},
        "analysis": [{"kind": "frame-modes"}],
    }


def building(**structure):
    return make_deck(deck(**structure)).building


def shell_weight(mesh):
    """Weight of masonry and floors [N]."""
    density = np.array([m.density for m in mesh.materials])
    total = mesh.floor_mass.sum()
    for part in mesh.parts:
        corner = mesh.xyz[part.connect]
        sides = [corner[:, k] - corner[:, 0] for k in range(1, corner.shape[1])]
        area = sum(0.5 * np.linalg.norm(np.cross(a, b), axis=1) for a, b in itertools.pairwise(sides))
        total += float((area * part.thickness * density[part.material]).sum())
    return GRAVITY * total


MASONRY = 2000.0 * GRAVITY * 0.4
WEIGHT = MASONRY * (2 * 6 * 3 + 2 * 4 * 3 + 2 * 0.5 * 4 * 1.2) + 24 * 800 / np.cos(np.pi / 6)


def test_weight_of_gables_and_slopes_by_hand():
    assert building().frame(FrameOptions()).total_weight == pytest.approx(WEIGHT)
    assert shell_weight(building().shell(ShellOptions(size=0.5))) == pytest.approx(WEIGHT)


def test_a_gable_loads_the_frame_under_its_centre():
    """Ridge at a quarter: the centre of the triangle lies at (0 + L/4 + L)/3."""
    plan = deck()["structure"]["walls"]
    plan[1]["gable"] = {"rise": 1.2, "ridge": 1.0}
    frame = building(walls=plan, floors=[{"storey": 1, "kind": "rigid"}]).frame(FrameOptions())
    loads = [(force, 0.5 * (a + b)) for w, level, a, b, force in frame_loads(frame) if (w, level) == (1, 1)][1:]
    assert sum(f for f, _ in loads) == pytest.approx(MASONRY * 2.4)
    assert sum(f * s for f, s in loads) / sum(f for f, _ in loads) == pytest.approx((1.0 + 4.0) / 3.0, rel=0.01)


def frame_loads(frame):
    """Vertical forces of the masses: wall, level, place, place and force."""
    for one in frame.masses:
        x, y, _ = one.place
        if abs(x - 6.0) < 1e-9 and 0.0 < y < 4.0:
            yield 1, one.level, y, y, one.mass * GRAVITY


THRUST = 24 * 800 / np.cos(np.pi / 6) / (4 * np.tan(np.pi / 6))


def test_rafters_push_their_walls_apart_by_the_thrust_of_three_hinges():
    """w l^2/(8 f) with f = l/2 tan(pitch), on each of the two walls."""
    mesh = building().shell(ShellOptions(size=0.5))
    south, north = (np.abs(mesh.xyz[:, 1] - y) < 1e-9 for y in (0.0, 4.0))
    assert mesh.push[south].sum(axis=0) == pytest.approx([0.0, -THRUST, 0.0], abs=1e-6)
    assert mesh.push[north].sum(axis=0) == pytest.approx([0.0, THRUST, 0.0], abs=1e-6)
    frame = building().frame(FrameOptions())
    assert f"{THRUST / 6e3:.3g} kN/m" in " ".join(frame.remarks)
    for roof in ("trusses", "purlins"):
        tied = building(floors=[ROOF | {"roof": roof, "bears_on": ["south", "north"] if roof == "trusses" else ["east", "west"]}])
        assert not tied.shell(ShellOptions(size=0.5)).push.any()
        assert not any("push" in remark for remark in tied.frame(FrameOptions()).remarks)


def test_a_thrust_does_work_in_the_frame_on_walls_that_move_apart():
    """Eaves on a wing of its own: the thrust moves the walls apart by what the frame calculates; the weight is unchanged."""
    floors = [ROOF | {"kind": "none", "young": None, "thickness": None}]
    pushed = building(floors=floors).frame(FrameOptions())
    tied = building(floors=[floors[0] | {"roof": "trusses"}]).frame(FrameOptions())
    added = pushed.weight - tied.weight
    along = {pushed.along[w, 1] for w in range(4)}
    assert np.delete(added, sorted(along)) == pytest.approx(0.0)
    # east and west are each pulled to both sides, and neither moves
    assert added == pytest.approx(np.zeros(len(added)), abs=1e-6 * THRUST)


def test_out_of_plane_parts_of_gables_and_of_walls_with_thrust():
    """A gable about its foot: (t/2)/(h/3). A wall with thrust T and roof load P: (W t/2 + P t/2 - T h)/(W h/2 + P h)."""
    light = [ROOF | {"load": 200.0, "pitch": 60.0}]
    parts = {part.words: part.body.multiplier() for part in wall_parts(building(floors=light))}
    assert parts["gable of wall east"] == pytest.approx(0.2 / 0.4)
    own, load = MASONRY * 6 * 3, 24 * 200 * 2 / 2
    thrust = 24 * 200 * 2 / (4 * np.tan(np.pi / 3))
    assert parts["wall south"] == pytest.approx(((own + load) * 0.2 - thrust * 3) / (own * 1.5 + load * 3))


def test_purlins_load_the_gable_and_a_rigid_roof_restrains_it():
    purlins = ROOF | {"roof": "purlins", "bears_on": ["east", "west"]}
    (east,) = (p.body.multiplier() for p in wall_parts(building(floors=[purlins])) if p.words == "gable of wall east")
    own, load = MASONRY * 2.4, 24 * 800 / np.cos(np.pi / 6) / 2
    assert east == pytest.approx((own + load) * 0.2 / (own * 0.4 + load * 0.6))
    slab = {k: v for k, v in purlins.items() if k not in ("young", "thickness")} | {"kind": "rigid"}
    held = building(floors=[slab])
    with pytest.raises(Exception, match="restrain the top"):
        wall_parts(held)


def tall(z, **more):
    """Two storeys; a stair window through the floor of the south wall."""
    made = deck(storeys=[3.0, 2.8], floors=[{"storey": k, "kind": "rigid", "load": 2e3} for k in (1, 2)])
    made["structure"]["walls"][0]["openings"] = [{"storey": 1, "x": [2.0, 3.5], "z": z} | more]
    return made


def test_an_opening_through_two_storeys():
    made = make_deck(tall([1.0, 4.4], through=True, lintel={"depth": 0.3}))
    plan = made.building.structure
    wall = plan.walls[0]
    assert [list(o.z) for storey in (1, 2) for o in plan.openings_in(wall, storey)] == [[1.0, 3.0], [0.0, pytest.approx(1.4)]]
    assert [o.lintel is None for storey in (1, 2) for o in plan.openings_in(wall, storey)] == [True, False]
    frame = made.building.frame(FrameOptions())
    masonry = MASONRY * (2 * 6 * 5.8 + 2 * 4 * 5.8 + 2 * 2.4 - 1.5 * 3.4) + 2 * 24 * 2e3
    assert frame.total_weight == pytest.approx(masonry)
    assert shell_weight(made.building.shell(ShellOptions(size=0.5))) == pytest.approx(masonry)
    own = [s for s in frame.strips if s.wall == 0]
    assert [s.storey for s in own if s.kind == "spandrel"] == [2]
    assert [s.masonry[:2] for s in own if s.kind == "pier" and s.storey == 1] == [(0.0, 2.0), (3.5, 6.0)]


@pytest.mark.parametrize(
    ("z", "more", "words"),
    [
        ([1.0, 4.4], {}, "through = true"),
        ([1.0, 2.2], {"through": True}, "wall 'south', opening 1.*does not pass through the floor at 3 m"),
        ([1.0, 5.8], {"through": True}, "wall 'south', opening 1.*below the top of the wall, 5.8 m"),
    ],
)
def test_bad_openings_through_storeys_name_wall_and_place(z, more, words):
    with pytest.raises(DeckError, match=words):
        make_deck(tall(z, **more))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"roof": None}, "both `pitch` and `roof`"),
        ({"bears_on": ["south"]}, "two different walls"),
        ({"bears_on": ["south", "east"]}, "'south' and 'east' are not parallel"),
        ({"bears_on": ["east", "west"]}, "wall 'east' has a gable on top of storey 1"),
        ({"load": 0.0}, "a roof of rafters requires `load`"),
    ],
)
def test_bad_roofs(change, words):
    with pytest.raises(DeckError, match=words):
        make_deck(deck(floors=[ROOF | change]))


def test_a_gable_rises_at_most_twice_the_length_of_its_wall():
    walls = deck()["structure"]["walls"]
    walls[1]["gable"] = {"rise": 8.0}
    assert building(walls=walls).structure.walls[1].gable.rise == 8.0
    walls[1]["gable"] = {"rise": 8.01}
    with pytest.raises(DeckError, match=r"wall 'east': 8\.01 m is more than 2 times the length of the wall, 4 m"):
        make_deck(deck(walls=walls))


def all_warnings(made):
    """Remarks on roofs, which the frame and the shell also state."""
    found = made.structure.floor_remarks
    assert set(found) <= set(made.frame(FrameOptions()).remarks)
    assert set(found) <= set(made.shell(ShellOptions(size=1.0)).warnings)
    return found


def test_a_pitch_and_a_gable_of_different_ridges_are_stated_with_both_heights():
    """2 m tan(60 deg) = 3.46 m of the roof, 1.2 m of the gables; at 30 degrees 1.15 m, within 5 %."""
    assert not all_warnings(building())
    found = all_warnings(building(floors=[ROOF | {"pitch": 60.0}]))
    assert [name in remark for name, remark in zip(("'east'", "'west'"), found, strict=True)] == [True, True]
    assert all("ridge of the rafters is 3.46 m" in remark and "rises 1.2 m" in remark for remark in found)


def test_purlins_follow_the_slope_of_either_side_of_a_gable():
    """A ridge at 1 m of 4 m: slopes of 1.2/1 and 1.2/3."""
    walls = deck()["structure"]["walls"]
    for k in (1, 3):
        walls[k]["gable"] = {"rise": 1.2, "ridge": 1.0}
    roof = ROOF | {"roof": "purlins", "bears_on": ["east", "west"]}
    for run in (1.0, 3.0):
        assert not all_warnings(building(walls=walls, floors=[roof | {"pitch": float(np.degrees(np.arctan(1.2 / run)))}]))
    assert len(all_warnings(building(walls=walls, floors=[roof | {"pitch": 36.0}]))) == 2


def test_a_rigid_floor_ties_the_rafters():
    slab = {k: v for k, v in ROOF.items() if k not in ("young", "thickness")} | {"kind": "rigid"}
    tied = building(floors=[slab])
    assert any("ties the rafters at the eaves, so the rafters have no thrust" in remark for remark in all_warnings(tied))
    assert not tied.shell(ShellOptions(size=1.0)).push.any()
    assert not any("push wall" in remark for remark in tied.frame(FrameOptions()).remarks)


def crossing(hole):
    """Two inner walls that cross at (3, 2), four floors between the walls."""
    made = deck()["structure"]
    walls = [
        *made["walls"],
        {"name": "a", "start": [3, 0], "end": [3, 4], "thickness": 0.2, "openings": hole},
        {"name": "b", "start": [0, 2], "end": [6, 2], "thickness": 0.2},
    ]
    rooms = [["south", "a", "b", "west"], ["south", "east", "b", "a"], ["b", "a", "north", "west"], ["b", "east", "north", "a"]]
    return building(walls=walls, floors=[{"storey": 1, "young": 3e7, "thickness": 0.05, "load": 2e3, "walls": room} for room in rooms])


def test_walls_that_cross_share_nodes_and_are_tied_in_the_frame():
    """In shells the crossing is one line of nodes; in the frame a link of the strength of cohesion on the common section."""
    whole = crossing([])
    mesh = whole.shell(ShellOptions(size=0.5))
    on = {part.name: set(np.unique(part.connect).tolist()) for part in mesh.parts}
    shared = mesh.xyz[sorted(on["a"] & on["b"])]
    assert shared[:, :2] == pytest.approx(np.tile([3.0, 2.0], (len(shared), 1)))
    assert (shared[:, 2].min(), shared[:, 2].max()) == (0.0, 3.0)
    frame = whole.frame(FrameOptions(flanges="whole"))
    p, q = (frame.nodes[k].freedoms for k in (frame_node(frame, 4, 2.0), frame_node(frame, 5, 3.0)))
    (link,) = [one for one in frame.links if set(one.freedoms) == {*p, *q}]
    assert link.strengths == pytest.approx((1e5 * 0.2 * 1.5,) * 2)
    assert frame.total_weight == pytest.approx(shell_weight(mesh))


def frame_node(frame, wall, s):
    return next(k for k, n in enumerate(frame.nodes) if (n.wall, n.level) == (wall, 1) and n.start <= s <= n.end)


def test_walls_that_cross_in_an_opening_are_said_to_be_apart():
    apart = crossing([{"storey": 1, "x": [1.5, 2.5], "z": [0.0, 2.9]}]).frame(FrameOptions())
    assert any("'a' and 'b' meet at (3, 2) m in an opening" in remark for remark in apart.remarks)


def test_a_floor_on_a_wall_that_is_not_adjacent_is_refused_by_all():
    walls = [*deck()["structure"]["walls"], {"name": "a", "start": [3, 0], "end": [3, 4], "thickness": 0.2}]
    floors = [{"storey": 1, "kind": "none", "load": 2e3, "walls": ["south", "a", "north", "west"], "bears_on": ["east"]}]
    made = building(walls=walls, floors=floors)
    for ask in (lambda: made.frame(FrameOptions()), lambda: made.shell(ShellOptions(size=0.5)), lambda: wall_parts(made)):
        with pytest.raises(BadGeometry, match="wall 'east' of `bears_on` is not adjacent"):
            ask()
