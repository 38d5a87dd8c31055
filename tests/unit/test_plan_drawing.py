"""Decks from the plans of drawings: walls by faces and by axes, openings by gaps and by a layer; what cannot be read."""

import ezdxf
import numpy as np
import pytest

from extrados.bridges.plan_drawing import DrawnWall, deck_of_plan, joined
from extrados.decks.reader import read_text
from extrados.model.errors import BadGeometry
from extrados.schema.files import File

#: Two rooms, 10 by 6 m outside, walls 0.4 m, a partition 0.3 m whose axis is at x = 6, a door in the front (2 to 3 m), one in the partition
FACES = [
    [
        (0, 0),
        (2, 0),
        (2, 0.4),
        (0.4, 0.4),
        (0.4, 5.6),
        (5.85, 5.6),
        (5.85, 4),
        (6.15, 4),
        (6.15, 5.6),
        (9.6, 5.6),
        (9.6, 0.4),
        (6.15, 0.4),
        (6.15, 3),
        (5.85, 3),
        (5.85, 0.4),
        (3, 0.4),
        (3, 0),
        (10, 0),
        (10, 6),
        (0, 6),
        (0, 0),
    ]
]
WINDOW = [[(7, 0.05), (8.2, 0.05), (8.2, 0.35), (7, 0.35), (7, 0.05)]]


def drawn(tmp_path, faces=FACES, windows=WINDOW, scale=1000.0, unit=4):
    document = ezdxf.new()
    document.header["$INSUNITS"] = unit
    for layer, lines in (("A-WALL", faces), ("A-GLAZ", windows)):
        for points in lines:
            document.modelspace().add_lwpolyline(scale * np.array(points, dtype=float), dxfattribs={"layer": layer})
    document.saveas(tmp_path / "plan.dxf")
    return File(tmp_path / "plan.dxf", (tmp_path / "plan.dxf").read_bytes())


def walls_in(text):
    deck = read_text(text.encode())
    return {tuple(np.round([*w.start, *w.end], 3)): w for w in deck.structure.walls}, deck


def test_faces_of_two_rooms(tmp_path):
    found, deck = walls_in(deck_of_plan(drawn(tmp_path), ["A-WALL"], ["A-GLAZ"], None, [3.0, 2.8]))
    assert set(found) == {(0.2, 0.2, 9.8, 0.2), (0.2, 5.8, 9.8, 5.8), (0.2, 0.2, 0.2, 5.8), (9.8, 0.2, 9.8, 5.8), (6.0, 0.2, 6.0, 5.8)}
    front, inner = found[0.2, 0.2, 9.8, 0.2], found[6.0, 0.2, 6.0, 5.8]
    assert front.thickness == pytest.approx(0.4) and inner.thickness == pytest.approx(0.3)
    assert [o.x for o in front.openings if o.storey == 1] == [pytest.approx([1.8, 2.8]), pytest.approx([6.8, 8.0])]
    assert [o.x for o in inner.openings if o.storey == 2] == [pytest.approx([2.8, 3.8])]
    assert not found[0.2, 5.8, 9.8, 5.8].openings  # the partition interrupts its inner face: no opening
    frame = deck.building.frame(deck.analyses[0].frame)
    assert frame.piers == 2 * (3 + 1 + 1 + 1 + 2) and len(frame.links) == 2 * 6
    assert any("gives no heights" in text for text in deck.structure.assumed)


def test_axes_with_gaps(tmp_path):
    axes = [[(0, 0), (2, 0)], [(3, 0), (9, 0)], [(9, 0), (9, 6)], [(9, 6), (0, 6)], [(0, 6), (0, 0.1)]]
    found, _ = walls_in(deck_of_plan(drawn(tmp_path, axes, [], 1.0, 6), ["A-WALL"], [], 0.5, [3.0]))
    assert set(found) == {(0, 0, 9, 0), (9, 0, 9, 6), (0, 6, 9, 6), (0, 0, 0, 6)}
    (door,) = found[0, 0, 9, 0].openings
    assert door.x == pytest.approx([2, 3]) and door.z == pytest.approx([0, 2.1])


@pytest.mark.parametrize("angle", [0.3, 1.2])
def test_a_turned_plan_is_the_same(tmp_path, angle):
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    straight, _ = walls_in(deck_of_plan(drawn(tmp_path), ["A-WALL"], ["A-GLAZ"], None, [3.0]))
    turned, deck = walls_in(
        deck_of_plan(drawn(tmp_path, [np.array(FACES[0]) @ turn], [np.array(WINDOW[0]) @ turn]), ["A-WALL"], ["A-GLAZ"], None, [3.0])
    )

    def described(walls):
        return sorted((round(w.length, 2), w.thickness, len(w.openings)) for w in walls.values())

    assert described(turned) == described(straight)
    assert not any("do not meet" in remark for remark in deck.building.frame(deck.analyses[0].frame).remarks)


@pytest.mark.parametrize(
    "faces, walls, why",
    [
        (FACES, ["WALLS"], "layer 'WALLS' does not exist"),
        ([[(0, 0), (5, 0)]], ["A-WALL"], "no two parallel lines"),
        ([[(0, 0), (5, 0)], [(0, 0.01), (5, 0.01)]], ["A-WALL"], "no two parallel lines"),
    ],
)
def test_what_cannot_be_read(tmp_path, faces, walls, why):
    with pytest.raises(BadGeometry, match=why):
        deck_of_plan(drawn(tmp_path, faces, WINDOW), walls, [], None, [3.0])


def test_assumed_masonry_and_short_pieces_are_stated(tmp_path):
    pier = [(20, 0), (20.5, 0), (20.5, 0.4), (20, 0.4), (20, 0)]
    _, deck = walls_in(deck_of_plan(drawn(tmp_path, [*FACES, pier]), ["A-WALL"], ["A-GLAZ"], None, [3.0]))
    assumed = " ".join(deck.structure.assumed)
    assert "compressive strength 3 MPa" in assumed and "diagonal strength 50 kPa" in assumed
    assert deck.building.material.density == 1800 and deck.building.joints.cohesion == 1e5
    assert "The longest of these pieces has a length of 0.50 m" in assumed


def test_too_many_walls_are_refused_before_they_are_joined(tmp_path, monkeypatch):
    monkeypatch.setattr("extrados.bridges.plan_drawing.MOST_WALLS", 4)
    monkeypatch.setattr("extrados.bridges.plan_drawing.joined", lambda _: pytest.fail("joined"))
    with pytest.raises(BadGeometry, match="has 5 walls, more than the 4"):
        deck_of_plan(drawn(tmp_path), ["A-WALL"], ["A-GLAZ"], None, [3.0])


def test_a_wall_as_short_as_another_is_thick_keeps_its_ends():
    """Both of its ends meet the same axis: cut there, the wall would have no length."""
    thick = DrawnWall(np.array([0.0, -3.0]), np.array([0.0, 3.0]), 1.5)
    short = DrawnWall(np.array([-0.3, 0.0]), np.array([0.3, 0.0]), 0.3)
    assert [wall.length for wall in joined([short, thick])] == pytest.approx([0.6, 6.0])
