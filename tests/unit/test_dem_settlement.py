"""Discrete elements settle, they do not fall: what cannot stand is not reported standing."""

import itertools
import json

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.dem import standing
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.settlement import TIMES, closed_settlement, farthest_settlement
from extrados.analyses.dem.tables import IN_PLANE, IN_SPACE
from extrados.core import dem, dem_run
from extrados.core.ground import as_motion_set
from extrados.decks.reader import read_text
from extrados.model.geometry.convex import overlap_depth

#: name -> outlines of stones [m]
SLAB = {"slab": [[0, 0], [0.5, 0], [1.04, 1], [0.54, 1]]}  # centroid 2 cm outside the base
OVERHANG = {"base": [[0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5]], "slab": [[0.02, 0.5], [1.02, 0.5], [1.02, 0.7], [0.02, 0.7]]}


def keystone(spread):
    """Between two piers a stone 1 m high, whose sides spread downwards by a share of that."""
    top = 0.3 - spread
    return {
        "left": [[-1, 0], [-0.3, 0], [-0.3, 1], [-top, 2], [-1, 2]],
        "key": [[-0.3, 1], [0.3, 1], [top, 2], [-top, 2]],
        "right": [[0.3, 0], [1, 0], [1, 2], [top, 2], [0.3, 1]],
    }


def answered(tmp_path, stones, joints="friction = 0.7", analysis="", kind="dem"):
    blocks = [{"name": name, "points": points} for name, points in stones.items()]
    (tmp_path / "stones.json").write_text(json.dumps({"unit": "m", "blocks": blocks}))
    deck = tmp_path / "deck.toml"
    deck.write_text(f'[structure]\nkind = "blocks"\nfile = "stones.json"\n[joints]\n{joints}\n[[analysis]]\nkind = "{kind}"\n{analysis}')
    return extrados.run(deck).results[0]


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
@pytest.mark.parametrize(("stones", "who"), [(SLAB, "slab"), (OVERHANG, "slab")])
def test_what_falls_while_it_settles_cannot_stand_where_limit_analysis_proves_it(tmp_path, stones, who, solver) -> None:
    found = answered(tmp_path, stones, analysis=f'solver = "{solver}"\n')
    assert found.status == "ok" and found.verdict.outcome == "cannot-stand" and found.verdict.ratio == 0.0
    assert "certificate: " in found.answer
    assert f"does not stand under its own weight: {who} falls" in found.answer or (
        solver == "nonsmooth" and f"does not come to rest under its own weight in 20000 steps ({who}" in found.answer
    )


def test_what_falls_without_a_proof_is_refused(tmp_path) -> None:
    """Limit analysis finds forces that hold the stone; elements begin without."""
    found = answered(tmp_path, keystone(0.1))
    assert found.status == "refused" and "does not stand under its own weight: key falls" in found.reason
    assert "friction may hold a wedged block" in found.reason


def test_blocks_that_do_not_come_to_rest_are_refused_and_not_called_collapsing(tmp_path, monkeypatch) -> None:
    """In too few steps: limit analysis finds that the column stands."""
    stones = {f"drum {k}": [[0, k], [1, k], [1, k + 1], [0, k + 1]] for k in range(4)}
    monkeypatch.setattr(dem.Options, "__init__", _few_steps(dem.Options.__init__))
    found = answered(tmp_path, stones)
    assert found.status == "refused" and "does not come to rest under its own weight in 16 steps" in found.reason
    assert "falls" not in found.reason


def _few_steps(init):
    def of(self, *positional, **named):
        init(self, *positional, **named | {"settle_steps": 16})

    return of


@pytest.mark.parametrize("space", ["", "direction = 0.0\n"], ids=["plane", "space"])
def test_what_stands_settles_however_little_its_motion_is_damped(tmp_path, space) -> None:
    """Settling has damping of its own: as many steps without damping as with."""
    steps = []
    for ratio in (1.0, 0.0):
        deck = tmp_path / "deck.toml"
        deck.write_text(
            f"[structure]\n{STANDING['arch']}\n[joints]\nfriction = 1.0\ndamping_ratio = {ratio}\n[[analysis]]\n"
            f'kind = "dem"\nend_time = 1e-3\n{space}'
        )
        found = extrados.run(deck).results[0]
        assert found.status == "ok", found.reason
        steps.append(found["settling_steps"])
        assert found["damping_ratio_edge"] == pytest.approx(ratio)
    assert steps[1] == steps[0]


def test_elements_held_by_mortar_say_that_limit_analysis_disagrees(tmp_path) -> None:
    found = answered(tmp_path, OVERHANG, 'friction = 0.7\ncohesion = "0.5 MPa"\ntension = "0.5 MPa"')
    assert found.status == "ok"
    assert any("because of the cohesion and tension of the joints" in text for text in found.warnings)


@pytest.mark.parametrize(
    ("space", "spread"), [("", 0.15), ("direction = 0.0\n", 0.05), ("direction = 0.0\n", 0.01)], ids=["plane", "space", "slight"]
)
def test_what_rigid_contacts_hold_by_jamming_is_doubted(tmp_path, space, spread) -> None:
    """Or refused, where the impulses of the wedge are not found."""
    found = answered(tmp_path, keystone(spread), analysis=f'solver = "nonsmooth"\n{space}')
    if spread == 0.01:
        assert found.status == "refused" and "jam under high friction" in found.reason
        return
    assert found.status == "ok", found.reason
    assert "stands under its own weight" in found.answer
    assert "with springs, the structure collapses while it settles" in found.answer
    assert any("by forces that self-weight alone does not produce" in text and "key falls" in text for text in found.warnings)


def test_the_pulses_that_it_carries_are_doubted_too(tmp_path) -> None:
    pulses = 'solver = "nonsmooth"\nmode_II = false\npulse = "step"\namplitudes = ["0.2 g"]\ndurations = [0.1, 0.2]\nsettle = 0.5'
    found = answered(tmp_path, keystone(0.15), analysis=pulses, kind="dem-domain")
    assert found.status == "ok" and "with springs, the structure collapses while it settles" in found.answer


@pytest.mark.parametrize("space", ["", "direction = 0.0\n"], ids=["plane", "space"])
@pytest.mark.parametrize("spread", [-0.005, -0.01, -0.1, -0.3])
def test_a_keystone_that_sits_is_not_doubted(tmp_path, space, spread) -> None:
    """One of slight taper sinks farther than closed joints give, until it sits."""
    found = answered(tmp_path, keystone(spread), analysis=f'solver = "nonsmooth"\n{space}')
    assert found.status == "ok" and "stands under its own weight" in found.answer
    assert "jammed" not in found.answer and not any("wedged" in text for text in found.warnings)


@pytest.mark.parametrize("space", ["", "direction = 0.0\n"], ids=["plane", "space"])
@pytest.mark.parametrize("name", ["column", "arch", "leaning"])
def test_what_stands_by_its_weight_is_not_doubted(tmp_path, name, space) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text(f'[structure]\n{STANDING[name]}\n[[analysis]]\nkind = "dem"\nsolver = "nonsmooth"\nend_time = 0.05\n{space}')
    found = extrados.run(deck).results[0]
    assert found.status == "ok" and "jammed" not in found.answer
    assert not any("wedged" in text or "no second method" in text for text in found.warnings)


@pytest.mark.parametrize(("space", "fraction"), [("", IN_PLANE), ("direction = 0.0\n", IN_SPACE)], ids=["plane", "space"])
def test_springs_check_rigid_contacts_in_the_steps_of_springs(tmp_path, monkeypatch, space, fraction) -> None:
    taken = []
    name = "SolidTask" if space else "Task"
    task = getattr(standing, name)

    def noted(*given):
        taken.append(given[-1].fraction)
        return task(*given)

    monkeypatch.setattr(standing, name, noted)
    assert answered(tmp_path, keystone(-0.3), analysis=f'solver = "nonsmooth"\n{space}').status == "ok"
    assert taken == [fraction]


@pytest.mark.parametrize("space", ["", "direction = 0.0\n"], ids=["plane", "space"])
def test_springs_that_come_to_no_end_accuse_nothing(tmp_path, monkeypatch, space) -> None:
    monkeypatch.setattr(standing, "SETTLING", 16)
    found = answered(tmp_path, keystone(-0.3), analysis=f'solver = "nonsmooth"\n{space}')
    assert found.status == "ok" and "jammed" not in found.answer
    assert any("did not come to rest in 16 steps" in text for text in found.warnings)


@pytest.mark.parametrize(
    ("space", "told"),
    [
        ("", "such a check accepts at most 8 joints, and the structure has 9"),
        ("direction = 0.0\n", "such a check accepts at most 7 solids, and the structure has 8"),
    ],
    ids=["plane", "space"],
)
def test_what_is_too_large_for_other_methods_says_so(tmp_path, monkeypatch, space, told) -> None:
    monkeypatch.setattr(standing, "MOST_JOINTS", 8)
    monkeypatch.setattr(standing, "MOST_SOLIDS", 7)
    arch = 'kind = "arch"\nradius = 1.0\nthickness = 0.2\nembrace = 150.0\nvoussoirs = 8'
    deck = tmp_path / "deck.toml"
    text = f'[structure]\n{arch}\n[[analysis]]\nkind = "dem"\n{space}'
    for solver in ("compliant", "nonsmooth"):
        deck.write_text(f'{text}solver = "{solver}"\n')
        assert any(told in warning for warning in extrados.run(deck).results[0].warnings)


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
    model = make_model(Context(deck).building, deck.analyses[0])
    closed, gaps = closed_settlement(model, model.values)
    options = dem.Options(end_time=1e-6, output_step=1e-3, settlement=farthest_settlement(model))
    with dem.Model(model.bodies(), options) as elements, as_motion_set([dem_run.STILL]) as motions:
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
    text = (tmp_path / "deck.toml").read_text().replace('file = "stones.json"', 'file = "stones.json"\ncontact_tolerance = "3 mm"')
    (tmp_path / "deck.toml").write_text(text)
    assert extrados.run(tmp_path / "deck.toml").results[0].status == "ok"


def surveyed(stones: dict, noise: float, seed: int = 0) -> dict:
    """Stones whose corners, and a point midway along each side, are measured each for itself with an error up to `noise`."""
    random = np.random.default_rng(seed)
    found = {}
    for name, points in stones.items():
        corners = np.array(points, dtype=float)
        both = np.stack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))], axis=1).reshape(-1, 2)
        on_ground = both[:, 1] == 0.0
        both += random.uniform(-noise, noise, both.shape)
        both[on_ground, 1] = 0.0
        found[name] = both.tolist()
    return found


PIERS = {
    f"{side} {k}": [[x, y], [x + 0.5, y], [x + 0.5, y + 0.4], [x, y + 0.4]]
    for side, x in (("left", 0.0), ("right", 1.5))
    for k, y in enumerate(np.linspace(0.0, 1.6, 5))
}
FRAME = PIERS | {"lintel": [[0, 2], [2, 2], [2, 2.4], [0, 2.4]]}


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_survey_with_faces_that_overlap_and_bend_stands(tmp_path, seed) -> None:
    blocks = [{"name": name, "points": points} for name, points in surveyed(FRAME, 1.5e-3, seed).items()]
    (tmp_path / "stones.json").write_text(json.dumps({"unit": "m", "blocks": blocks}))
    deck = tmp_path / "deck.toml"
    deck.write_text(
        '[structure]\nkind = "blocks"\nfile = "stones.json"\ncontact_tolerance = "4 mm"\n[joints]\nfriction = 0.7\n'
        '[[analysis]]\nkind = "dem"\n'
    )
    found = extrados.run(deck).results[0]
    assert found.status == "ok", found.reason
    assert found["outcome"] == "at-rest"
    rigid = extrados.decks.reader.read_deck(deck).building.rigid()
    assert [len(part) for part in rigid.parts] == [4] * len(rigid.parts)  # one edge a face
    deepest = max(
        overlap_depth(one, other)
        for (one, a), (other, b) in itertools.combinations(zip(rigid.parts, rigid.owner, strict=True), 2)
        if a != b
    )
    assert deepest < 1e-9


TOPPLING = (
    '[structure]\nkind = "block"\nwidth = 0.5\nheight = 2.0\n[motion]\nkind = "step-pulse"\namplitude = "1 g"\nduration = 0.4\n'
    '[[analysis]]\nkind = "dem"\nstop_at_collapse = false\nend_time = 2.5\n'
)


def test_no_floor_that_the_deck_does_not_name(tmp_path) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text(TOPPLING)
    falling = extrados.run(deck).array("dem", "place")[:, 0, 1]
    deck.write_text(TOPPLING + "floor = 0.0\n")
    caught = extrados.run(deck).array("dem", "place")[:, 0, 1]
    assert falling.min() < -1.0  # off its footing and on
    assert 0.2 < caught.min() < 0.3  # on its side


def test_two_piers_on_one_level_have_footings_of_their_own(tmp_path) -> None:
    blocks = [{"name": name, "points": points} for name, points in FRAME.items()]
    (tmp_path / "stones.json").write_text(json.dumps({"unit": "m", "blocks": blocks}))
    deck = read_text(b'[structure]\nkind = "blocks"\nfile = "stones.json"\n[[analysis]]\nkind = "dem"\n', folder=tmp_path)
    bare, floored = deck.building.rigid(), deck.building.rigid(floor=0.0)
    left, right = bare.parts[-2:]
    assert [left[:, 0].min(), left[:, 0].max()] == pytest.approx([-0.125, 0.625])
    assert [right[:, 0].min(), right[:, 0].max()] == pytest.approx([1.375, 2.125])
    # with a floor at their level each footing is as wide as the ground around it: no seam at which a block would catch
    left, right = floored.parts[-2:]
    assert left[:, 0].max() == right[:, 0].min() == pytest.approx(1.0)
    assert left[:, 0].min() < -20.0 and right[:, 0].max() > 20.0
    assert "floor" not in floored.names


def test_a_block_that_slides_off_its_footing_gets_a_hint_at_the_floor(tmp_path) -> None:
    deck = tmp_path / "deck.toml"
    sliding = TOPPLING.replace("height = 2.0", "height = 0.2").replace("[motion]", "[joints]\nfriction = 0.3\n[motion]")
    deck.write_text(sliding)
    off = extrados.run(deck).results[0]
    deck.write_text(sliding + "floor = 0.0\n")
    on = extrados.run(deck).results[0]
    assert any("slides off its footing. If detached blocks can slide on a floor, give the key `floor` = " in text for text in off.warnings)
    assert not any("footing" in text for text in on.warnings)
    assert on.arrays["place"].data[:, 0, 1].min() == pytest.approx(0.1, abs=1e-3)
    assert np.abs(on.arrays["place"].data[:, 0, 0] - 0.25).max() > 0.125
