"""Discrete elements settle, they do not fall: what cannot stand is not reported standing."""

import json

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.dem.model import make_model
from extrados.analyses.dem.settlement import TIMES, closed_settlement, farthest_settlement
from extrados.core import dem
from extrados.core.ground import as_motion_set
from extrados.decks.reader import read_text

#: name -> outlines of stones [m]
SLAB = {"slab": [[0, 0], [0.5, 0], [1.04, 1], [0.54, 1]]}  # centroid 2 cm outside the base
OVERHANG = {
    "base": [[0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5]],
    "slab": [[0.02, 0.5], [1.02, 0.5], [1.02, 0.7], [0.02, 0.7]],
}
KEYSTONE = {  # wider below than above
    "left": [[-1, 0], [-0.3, 0], [-0.3, 1], [-0.2, 2], [-1, 2]],
    "key": [[-0.3, 1], [0.3, 1], [0.2, 2], [-0.2, 2]],
    "right": [[0.3, 0], [1, 0], [1, 2], [0.2, 2], [0.3, 1]],
}


def answered(tmp_path, stones, joints="friction = 0.7"):
    blocks = [{"name": name, "points": points} for name, points in stones.items()]
    (tmp_path / "stones.json").write_text(json.dumps({"unit": "m", "blocks": blocks}))
    deck = tmp_path / "deck.toml"
    deck.write_text(
        f'[structure]\nkind = "blocks"\nfile = "stones.json"\n[joints]\n{joints}\n[[analysis]]\nkind = "dem"\n'
    )
    return extrados.run(deck).results[0]


@pytest.mark.parametrize(("stones", "who"), [(SLAB, "slab"), (OVERHANG, "slab"), (KEYSTONE, "key")])
def test_what_falls_while_it_settles_is_refused(tmp_path, stones, who) -> None:
    found = answered(tmp_path, stones)
    assert found.status == "refused"
    assert f"does not stand under its own weight: {who} falls" in found.reason


def test_limit_analysis_is_asked_too(tmp_path) -> None:
    assert "limit analysis agrees: it stands only when pushed sideways" in answered(tmp_path, SLAB).reason
    assert "as friction holds a stone that is wedged in" in answered(tmp_path, KEYSTONE).reason


def test_elements_held_by_mortar_say_that_limit_analysis_disagrees(tmp_path) -> None:
    found = answered(tmp_path, OVERHANG, 'friction = 0.7\ncohesion = "0.5 MPa"\ntension = "0.5 MPa"')
    assert found.status == "ok"
    assert any("by the cohesion and tension of its joints" in text for text in found.warnings)


STANDING = {
    "column": 'kind = "column"\nwidth = 0.5\nheight = 4.0\ndrums = 8',
    "wall": 'kind = "brickwork"\nunit_length = 0.5\nunit_height = 0.25\nunits = 4\ncourses = 6',
    "arch": 'kind = "arch"\nradius = 1.0\nthickness = 0.2\nembrace = 170.0\nvoussoirs = 24',
    "least thickness": 'kind = "arch"\nradius = 1.0\nthickness = 0.1085\nembrace = 180.0\nvoussoirs = 24',
    "leaning": 'kind = "block"\nmass = 8000.0\ninertia = 11000.0\ncentre_height = 2.0\ntoe_right = 0.02\ntoe_left = 0.98',
}


@pytest.mark.parametrize("name", STANDING)
def test_what_stands_settles_as_its_closed_joints_give(name) -> None:
    deck = read_text(f'[structure]\n{STANDING[name]}\n[joints]\nfriction = 2.0\n[[analysis]]\nkind = "dem"\n'.encode())
    model = make_model(Context(deck), deck.analyses[0])
    closed, gaps = closed_settlement(model, model.values)
    options = dem.Options(end_time=1e-6, output_step=1e-3, settlement=farthest_settlement(model))
    with dem.Model(model.bodies(), options) as elements, as_motion_set([dem.STILL]) as motions:
        found = elements.run(motions)
    n = model.rigid.count
    settled = np.hypot(*(found.settled[:n, :2] - model.rigid.centroid[:n]).T).max()
    assert found.reason == "end"
    assert 0.3 * closed < settled < 1.5 * closed
    assert gaps < 1e-9
    assert farthest_settlement(model) == pytest.approx(TIMES * closed, rel=1e-6)


def test_gaps_of_a_survey_may_close(tmp_path) -> None:
    """A lintel on two piers, 2 mm above both."""
    stones = {
        "left": [[0, 0], [0.5, 0], [0.5, 2], [0, 2]],
        "right": [[1.5, 0], [2, 0], [2, 2], [1.5, 2]],
        "lintel": [[0, 2.002], [2, 2.002], [2, 2.4], [0, 2.4]],
    }
    deck = "friction = 0.7"
    refused = answered(tmp_path, stones, deck)
    assert refused.status == "refused"  # nothing bears the lintel
    text = (
        (tmp_path / "deck.toml")
        .read_text()
        .replace('file = "stones.json"', 'file = "stones.json"\ncontact_tolerance = "3 mm"')
    )
    (tmp_path / "deck.toml").write_text(text)
    assert extrados.run(tmp_path / "deck.toml").results[0].status == "ok"
