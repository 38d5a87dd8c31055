"""What a field of a result means: fields that exist only with an outcome, senses of rotation, words that count a table."""

import re
import time

import numpy as np
from asking import Deck, ask, must, near, run
from buildings import decks, number, pulses
from hypothesis import reject
from hypothesis import strategies as st
from relations import RIGID, SLOW, ok, relation

from extrados.model.geometry.contacts import nearest


@relation("rocking dem", st.tuples(decks("block", "column", "stack", "arch"), pulses(0.2, 2.5)), 1e-9, share=2.0)
def fields_of_a_collapse(deck: Deck, motion: Deck, within: float) -> None:
    """A structure has a time of collapse if it collapses and else none; the time lies within the run and ends it."""
    shaken = {**deck, "motion": motion}
    for kind, keys in (("rocking", {"hand_over": False}), ("dem", {"perturbed": False, "end_time": 2.0, **RIGID})):
        if kind == "dem" and deck["structure"]["kind"] == "arch":
            continue
        answer = ask(shaken, kind, **keys)
        if not answer.answers:
            continue
        r = answer.results
        must((r.collapse_time_s is not None) == (r.outcome == "collapse"), f"{kind}: {r.outcome}, {r.collapse_time_s}")
        if r.collapse_time_s is not None:
            last = float(np.asarray(answer.result.arrays["time"].data)[-1])
            must(0.0 < r.collapse_time_s <= last * (1.0 + within) + 0.02, f"{kind}: {r.collapse_time_s} after {last}")


@relation("dem rocking", st.tuples(decks("block", "column"), number(1.1, 1.6)), 1e-9, share=0.5)
def the_sense_of_a_push(deck: Deck, factor: float, within: float) -> None:
    """A pier under a load to +x rotates to +x: rotations are > 0, of rocking under a step and of a slow tilt by elements."""
    narrow = {**deck, "joints": {"friction": 2.0}}
    pier = ask(narrow, "tilt")
    ok(pier)
    step = {"kind": "step-pulse", "amplitude": f"{-factor * pier.capacity[0]:.4g} g", "duration": 0.2}
    rocks = ask({**narrow, "motion": step}, "rocking", hand_over=False)
    falls = ask(narrow, "dem", **{**SLOW, "tilt_accuracy": 0.1, "time_step": 0.004})
    ok(rocks, falls)
    must(falls.results.peak_rotation_rad != {}, "no rotation")
    for name, rotation in falls.results.peak_rotation_rad.items():
        must(rotation > -1e-6, f"tilt to {falls.results.load_direction}: {name} rotates by {rotation}")
    must(max(falls.results.peak_rotation_rad.values()) > 0.0, f"{falls.results.peak_rotation_rad}")
    rotation = np.asarray(rocks.result.arrays["rotation"].data)
    first = rotation[np.flatnonzero(rotation)[:1]]
    must(len(first) == 1 and float(first[0]) > 0.0, f"ground to -x: {first}")


@relation(
    "supports", st.tuples(decks("arch", "frame", "vault", friction=st.sampled_from([0.3, 0.7, "no-sliding"])), number(-0.01, 0.01, 8)), 1e-3
)
def words_count_the_table(deck: Deck, spread: float, within: float) -> None:
    """The conclusion on moving supports names as many joints that open, and that slide, as its table."""
    if spread == 0.0:
        reject()
    answer = ask(deck, "supports", spread=spread)
    ok(answer)
    if "openings" not in answer.result.tables:
        reject()
    rows = answer.result.tables["openings"].columns
    opening, slip = (np.abs(np.asarray(rows[name], dtype=float)) for name in ("opening", "slip"))
    for word, count in (("open", opening > within * slip), ("slide", slip > within * opening)):
        said = re.search(rf"(no|\d+) joints? (?:of [^.;:]*? )?{word}s?\b", answer.result.answer)
        must((int(said[1]) if said and said[1] != "no" else 0) == int(count.sum()), f"{answer.result.answer}: {word} {count.sum()}")


def _moved(points: np.ndarray, bodies: np.ndarray, pose: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Points (n, 2) of bodies (n), -1 the ground, under poses (bodies, 3) of centres (bodies, 2)."""
    c, s = np.cos(pose[bodies, 2]), np.sin(pose[bodies, 2])
    x, y = (points - centre[bodies]).T
    there = pose[bodies, :2] + np.column_stack([c * x - s * y, s * x + c * y])
    return np.where((bodies < 0)[:, None], points, there)


@relation("rocking", st.tuples(decks("block", "column", "stack", "arch", "frame", "vault"), pulses(0.2, 1.0)), 1e-6, share=2.0)
def snapshots_hold_together(deck: Deck, motion: Deck, within: float) -> None:
    """In each snapshot of a mechanism both blocks of a joint share at least one of its ends."""
    answer = ask({**deck, "joints": {"friction": 2.0}, "motion": motion}, "rocking", hand_over=False)
    ok(answer)
    arrays = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    if "snapshot_pose" not in arrays or answer.verdict is None or answer.verdict.violated:
        reject()
    sides, centre = arrays["joint_block"].astype(int), arrays["centroid"]
    size = float(np.ptp(arrays["outline"], axis=0).max())
    for pose in arrays["snapshot_pose"]:
        apart = [
            np.hypot(*(_moved(arrays[end], sides[:, 0], pose, centre) - _moved(arrays[end], sides[:, 1], pose, centre)).T)
            for end in ("joint_p", "joint_q")
        ]
        worst = float(np.min(apart, axis=0).max())
        must(worst <= within * size, f"a joint parts at both ends by {worst} m")


BOXES = st.lists(st.tuples(number(0.0, 9.0), number(0.0, 9.0), number(0.1, 1.0), number(0.1, 1.0)), min_size=3, max_size=6)


@relation("tilt", BOXES, 1e-9)
def the_nearest_gap(boxes: list[tuple], within: float) -> None:
    """The gap of a block is the least distance from it to any other: of upright rectangles the hypotenuse of both clearances."""
    x, y, w, h = np.array(boxes).T
    across = np.maximum(np.maximum(x[1:] - (x + w)[0], x[0] - (x + w)[1:]), 0.0)
    up = np.maximum(np.maximum(y[1:] - (y + h)[0], y[0] - (y + h)[1:]), 0.0)
    apart = np.hypot(across, up)
    if apart.min() <= 0.0:
        reject()
    outlines = [np.array([[a, b], [a + c, b], [a + c, b + d], [a, b + d]]) for a, b, c, d in boxes]
    found = nearest(outlines, np.zeros((0, 4)), 0)
    must(found is not None and found.first == 0, f"{found}")
    near("gap", found.depth, float(apart.min()), within)
    near("gap to the block named", float(apart[found.second - 1]), float(apart.min()), within)


@relation("tilt thrust", decks("block", "arch", "column"), 0.0)
def seconds_lie_within_the_run(deck: Deck, within: float) -> None:
    """The seconds of all analyses are those of the run at most."""
    begin = time.perf_counter()
    results = run({**deck, "analysis": [{"kind": "tilt"}, {"kind": "thrust"}]}).results
    whole = time.perf_counter() - begin
    took = [r.seconds for r in results]
    must(min(took) >= 0.0 and sum(took) <= whole, f"{took} in {whole} s")
