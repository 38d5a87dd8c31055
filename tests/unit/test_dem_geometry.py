"""Discrete elements have the blocks of the drawing: what a survey's tolerance moves is bounded and reported."""

import numpy as np
import pytest

import extrados
from extrados.decks.reader import make_deck
from extrados.model.geometry.convex import crossings, overlap
from extrados.model.geometry.polygons import distance, properties
from extrados.views.rigid import _cut_overlaps

#: 1 x 3 m, both lower corners bevelled by 40 x 44 mm
BEVELLED = [[0.04, 0.0], [0.96, 0.0], [1.0, 0.044], [1.0, 3.0], [0.0, 3.0], [0.0, 0.044]]
TILT = [{"kind": "tilt"}, {"kind": "dem", "test": "tilt"}, {"kind": "dem", "test": "tilt", "solver": "nonsmooth"}]


def free(stones: dict[str, list], tolerance: float = 1e-4) -> dict:
    rows = [{"name": name, "points": points} for name, points in stones.items()]
    return {"kind": "blocks", "block": rows, "contact_tolerance": tolerance, "ground": [[-1, 0, 3, 0]]}


def answers(structure: dict, analyses: list[dict], friction: float = 0.7) -> list:
    return extrados.run({"structure": structure, "joints": {"friction": friction}, "analysis": analyses}).results


def test_a_bevelled_foot_carries_what_its_true_foot_carries() -> None:
    """The foot is 0.92 m wide: closed form 0.46 m over the height of the centroid."""
    _, (_, height), _ = properties(np.array(BEVELLED))
    for found in answers(free({"block": BEVELLED}), TILT):
        assert found["collapse_acceleration_g"] == pytest.approx(0.46 / height, abs=1e-3), found.kind
        assert not any("mm" in text for text in found.warnings)


@pytest.mark.parametrize("bevel", [0.3e-3, 1e-3, 5e-3, 0.04])
def test_no_bevel_is_straightened(bevel: float) -> None:
    """However small beside the joint, above the tolerance a bevel stays."""
    drawn = [[bevel, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0], [0.0, bevel]]
    rigid = make_deck({"structure": free({"block": drawn}), "analysis": {"kind": "dem"}}).building.rigid()
    assert rigid.parts[0] == pytest.approx(np.array(drawn), abs=0.0) and rigid.moved == 0.0


def test_courses_thinner_than_a_share_of_their_joint() -> None:
    """20 courses 1 m wide and 45 mm high vanished between their joints."""
    stones = {f"course {k}": [[0, 0.045 * k], [1, 0.045 * k], [1, 0.045 * (k + 1)], [0, 0.045 * (k + 1)]] for k in range(20)}
    rigid = make_deck({"structure": free(stones), "analysis": {"kind": "dem"}}).building.rigid()
    for part, points in zip(rigid.parts, stones.values(), strict=False):
        assert part == pytest.approx(np.array(points), abs=1e-12)
    for solver in ("compliant", "nonsmooth"):
        (found,) = answers(free(stones), [{"kind": "dem", "solver": solver, "end_time": 0.02}])
        assert found.status == "ok" and found["outcome"] == "at-rest"


@pytest.mark.parametrize("voussoirs", [300, 400])
def test_an_arch_of_thin_voussoirs_stands(voussoirs: int) -> None:
    structure = {"kind": "arch", "radius": 10.0, "thickness": 1.8, "embrace": 157.5, "voussoirs": voussoirs}
    building = make_deck({"structure": structure, "analysis": {"kind": "dem"}}).building
    rigid, assembly = building.rigid(), building.blocks()
    joints = np.concatenate([assembly.p, assembly.q])
    assert rigid.moved == rigid.cut == 0.0 and len(rigid.parts) == voussoirs + 2
    for part, outline in zip(rigid.parts, assembly.outlines, strict=False):
        assert distance(part, outline).max() < 1e-3  # the chord of the intrados fills its hollow
        assert (np.hypot(*(part[:, None] - joints[None]).transpose(2, 0, 1)).min(axis=1) < 1e-9).sum() == 4
    if voussoirs == 300:  # 400 take as long again and show no more
        (found,) = answers(structure, [{"kind": "dem", "solver": "nonsmooth", "end_time": 0.01}], friction=1.2)
        assert found.status == "ok" and found["outcome"] == "at-rest"


def courses(seed: int, noise: float) -> dict[str, list]:
    """Six courses of stones of random lengths and heights, each measured for itself at its corners and at the middles of its
    sides with an error up to `noise` [m]."""
    random, shapes, y = np.random.default_rng(seed), np.random.default_rng(100 + seed), 0.0
    found = {}
    for course in range(6):
        height = shapes.uniform(0.18, 0.32)
        first, second, single = shapes.uniform([0.3, 0.9, 0.6], [0.7, 1.5, 1.4])
        cuts = [0.0, *([first, second] if course % 2 == 0 else [single]), 2.0]
        for k in range(len(cuts) - 1):
            corners = np.array([[cuts[k], y], [cuts[k + 1], y], [cuts[k + 1], y + height], [cuts[k], y + height]])
            points = np.stack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))], axis=1).reshape(-1, 2)
            measured = points + random.uniform(-noise, noise, points.shape)
            measured[points[:, 1] == 0.0, 1] = 0.0
            found[f"stone {course}.{k}"] = measured.tolist()
        y += height
    return found


@pytest.mark.parametrize("seed", range(4))
def test_noise_within_the_tolerance_changes_no_part_by_more(seed: int) -> None:
    """Against the same wall without noise; the warnings give the greatest change."""
    noise, tolerance = 1e-3, 3e-3
    exact = make_deck({"structure": free(courses(seed, 0.0)), "analysis": {"kind": "dem"}}).building.rigid()
    noisy = make_deck({"structure": free(courses(seed, noise), tolerance), "analysis": {"kind": "dem"}}).building.rigid()
    assert 0.0 < noisy.moved < tolerance and noisy.cut < tolerance
    for one, other in zip(exact.parts[: exact.count], noisy.parts, strict=False):
        assert max(distance(one, other).max(), distance(other, one).max()) < 3.0 * noise
    deepest = max(
        overlap(one, other)[0]
        for i, (one, a) in enumerate(zip(noisy.parts, noisy.owner, strict=True))
        for other, b in list(zip(noisy.parts, noisy.owner, strict=True))[:i]
        if a != b
    )
    assert deepest < 1e-9


@pytest.mark.verify
def test_a_noisy_wall_tilts_as_limit_analysis_finds() -> None:
    """In slow tilt, without dilatancy; and the result says by how many millimetres faces were moved."""
    structure = free(courses(1, 1e-3), 3e-3)
    analyses = [
        {"kind": "tilt", "friction_rule": "non-associated"},
        {"kind": "dem", "test": "tilt", "tilt_accuracy": 0.01, "tilt_limit": "1 g"},
    ]
    limit, found = answers(structure, analyses)
    assert found["collapse_acceleration_g"] == pytest.approx(limit["collapse_acceleration_g"], rel=0.015)
    told = [text for text in found.warnings if "moved faces of blocks by up to" in text]
    assert len(told) == 1 and "mm, so that they meet at their joints (`contact_tolerance` 3 mm)" in told[0]


def test_an_overlap_is_cut_where_it_is() -> None:
    """A corner in a face loses itself; the face keeps its place."""
    parts = [np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), np.array([[0.5, 0.999], [1.5, 1.5], [0.5, 2.0]])]
    outer = [np.ones(4, dtype=bool), np.ones(3, dtype=bool)]
    assert len(crossings(*parts, 1e-9)) == 2
    depth = _cut_overlaps(parts, outer, [0, 1], 2e-3)
    assert 0.5e-3 < depth < 1.01e-3
    assert parts[0] == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), abs=1e-12)
    assert parts[1][:, 1].min() == pytest.approx(1.0, abs=1e-12) and len(parts[1]) == 4
    deep = [parts[0], np.array([[0.5, 0.9], [1.5, 1.5], [0.5, 2.0]])]
    assert _cut_overlaps(deep, [np.ones(4, dtype=bool), np.ones(3, dtype=bool)], [0, 1], 2e-3) == 0.0


def test_a_stone_within_a_hollow_keeps_its_place() -> None:
    """A hollow in which another stone stands is not filled, though no joint lies in it."""
    stones = {
        "portal": [[0, 0], [0.4, 0], [0.4, 0.2], [1.6, 0.2], [1.6, 0], [2, 0], [2, 2], [0, 2]],
        "within": [[0.8, 0], [1.2, 0], [1.2, 0.15], [0.8, 0.15]],
    }
    bare = make_deck({"structure": free({"portal": stones["portal"]}), "analysis": {"kind": "dem"}}).building.rigid()
    both = make_deck({"structure": free(stones), "analysis": {"kind": "dem"}}).building.rigid()
    assert [sum(o == 0 for o in r.owner) for r in (bare, both)] == [1, 4]
    (found,) = answers(free(stones), [{"kind": "dem", "end_time": 0.01}])
    assert found.status == "ok", found.reason
