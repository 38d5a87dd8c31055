"""What must change nothing: mirror, translation, rotation, units, order, names, immobile parts, motion after the end, threads."""

import copy
import functools
import json
import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Answer, Deck, ask, must, near, same
from buildings import SMALL, SOLIDS, changed, decks, drawn, in_words, mirrored, moved, number, on_plinth, pulses, sections
from hypothesis import reject
from hypothesis import strategies as st
from relations import ANY, EARTHQUAKES, GRAVITY, INTERVAL, MASONRY, PUSH, RIGID, SLOW, alike, ok, recorded, relation, statics


@relation("tilt", sections())
def mirror_of_a_section(deck: Deck, within: float) -> None:
    """If left and right are exchanged, the two capacities are exchanged."""
    one, other = ask(deck, "tilt"), ask(mirrored(deck), "tilt")
    same("mirrored", one, other)
    near("mirrored", one.capacity, other.capacity[::-1], within, 1e-3)


@relation("tilt", sections(*SMALL, friction=number(0.2, 0.9, 14)), 1e-4)
def mirror_without_dilatancy(deck: Deck, within: float) -> None:
    """The same holds for non-associated friction."""
    one, other = (ask(d, "tilt", friction_rule="non-associated", starts=3) for d in (deck, mirrored(deck)))
    same("mirrored", one, other)
    ok(one, other)
    for sense in ("", "_opposite"):
        bound = getattr(one.results, f"collapse_acceleration{sense}_g")
        must(bound >= 0.0, f"a capacity of {bound} g")


@relation("dem", sections("block", "column"), 0.006, share=0.2, exception=INTERVAL)
def mirror_of_elements(deck: Deck, within: float) -> None:
    """The same holds for rigid contacts in a slow tilt to both sides."""
    one, other = ask(deck, "dem", **SLOW), ask(mirrored(deck), "dem", **SLOW)
    same("mirrored", one, other)
    near("mirrored", one.capacity, other.capacity[::-1], within, 1.0)


BODIES = st.tuples(number(0.2, 1.0), number(0.2, 1.0), number(1.0, 3.0), number(-0.6, 0.6), pulses()).map(
    lambda t: {
        "structure": {
            "kind": "block",
            "mass": 1000.0,
            "inertia": round(400.0 * t[2] ** 2, 3),
            "centre_height": t[2],
            "toe_right": t[0],
            "toe_left": t[1],
        },
        "initial": {"rotation_ratio": t[3]},
        "motion": t[4],
    }
)


@relation("rocking", BODIES, 1e-6)
def mirror_of_a_rocking_body(deck: Deck, within: float) -> None:
    """If the toes are exchanged and motion and start reversed, the rotation changes its sign."""
    s, m = deck["structure"], deck["motion"]
    there = changed(
        deck,
        structure={"toe_right": s["toe_left"], "toe_left": s["toe_right"]},
        motion={"amplitude": f"-{m['amplitude']}"},
        initial={"rotation_ratio": -deck["initial"]["rotation_ratio"]},
    )
    one, other = ask(deck, "rocking"), ask(there, "rocking")
    ok(one, other)
    if one.results.decided_by_last_digits:
        reject()
    same("mirrored", one, other)
    near("peak rotation", one.results.peak_rotation_rad, -other.results.peak_rotation_rad, within, 1e-6)


@relation("tilt thrust", st.tuples(sections(), number(-900.0, 900.0), number(-50.0, 50.0)))
def translation_of_a_section(deck: Deck, dx: float, dy: float, within: float) -> None:
    """The origin of a survey changes no result."""
    there = moved(deck, lambda p: p + np.array([dx, dy]))
    for kind in ("tilt", "thrust"):
        one, other = ask(deck, kind), ask(there, kind)
        same(kind, one, other)
        near(kind, one.capacity, other.capacity, within, 1e-3)
    near("weight", ask(deck, "tilt").numbers.get("weight_N", 0.0), ask(there, "tilt").numbers.get("weight_N", 0.0), within)


@relation("dem", st.tuples(sections("block", "column"), number(-90.0, 90.0)), 0.006, share=0.4)
def translation_of_elements(deck: Deck, dx: float, within: float) -> None:
    """The same holds for rigid contacts in a slow tilt."""
    one, other = ask(deck, "dem", **SLOW), ask(moved(deck, lambda p: p + np.array([dx, 0.0])), "dem", **SLOW)
    same("moved", one, other)
    near("moved", one.capacity, other.capacity, within, 1.0)


@functools.cache
def _turned(text: str, angle: float) -> str:
    deck = json.loads(text)
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    for wall in deck["structure"]["walls"]:
        for end in ("start", "end"):
            x, y = wall[end]
            wall[end] = [round(c * x - s * y, 9) + 0.0, round(s * x + c * y, 9) + 0.0]
    return json.dumps(deck)


def turned(deck: Deck, angle: float) -> Deck:
    """A building turned on its plan by an angle [deg]."""
    return json.loads(_turned(json.dumps(deck), angle))


@relation("local-mechanism", st.tuples(decks("building"), number(0.0, 360.0, 24)))
def turned_plan_by_codes(deck: Deck, angle: float, within: float) -> None:
    """A rotated plan gives the same results for walls out of their planes."""
    there = [ask(d, "local-mechanism", mechanism="building") for d in (deck, turned(deck, angle))]
    same("turned", *there)
    ok(*there)
    for name in ("multiplier", "margin"):  # which of two equal walls is called the worst is a matter of rounding
        near(name, *(sorted(getattr(w, name) or 0.0 for w in a.results.walls) for a in there), within)
    near("multiplier", *(a.results.multiplier for a in there), within)


@relation("pushover", st.tuples(decks("building", material=MASONRY), st.sampled_from([90.0, 180.0])), 5e-3)
def turned_plan_pushed(deck: Deck, angle: float, within: float) -> None:
    """Plan and load direction rotated together give the same pushover; only the triangles of floors differ."""
    one, other = (ask(deck, "pushover", direction=0.0, **PUSH), ask(turned(deck, angle), "pushover", direction=angle, **PUSH))
    same("turned", one, other)
    ok(one, other)
    for name in ("initial_stiffness_N_m", "first_event_load_N", "weight_N"):
        near(name, getattr(one.results, name), getattr(other.results, name), within)


@relation("tilt", st.tuples(decks(*SOLIDS), number(0.0, 180.0, 12)), 1e-5)
def opposite_direction_of_solids(deck: Deck, angle: float, within: float) -> None:
    """The capacity along a direction is the opposite capacity of the reversed direction."""
    one, other = (ask(deck, "tilt", direction=angle, rose=4, starts=1), ask(deck, "tilt", direction=angle - 180.0, rose=4, starts=1))
    same("turned around", one, other)
    near("turned around", one.capacity, other.capacity[::-1], within, 1e-3)


@relation("tilt", decks("dome"), 1e-4)
def a_dome_turned_by_a_lune(deck: Deck, within: float) -> None:
    """A dome rotated by a lune has the same capacity."""
    angle = 360.0 / deck["structure"]["lunes"]
    one, other = (ask(deck, "tilt", direction=0.0, rose=4, starts=1), ask(deck, "tilt", direction=angle, rose=4, starts=1))
    same("turned", one, other)
    near("turned", one.capacity, other.capacity, within, 1e-3)


@relation("tilt local-mechanism", ANY, 1e-5)
def units(deck: Deck, within: float) -> None:
    """Numbers given as text in other units change no result."""
    deck = changed(deck, material={"density": 1900.0}, joints={"friction": 0.7})
    alike("units", statics(deck), statics(in_words(deck)), within)


@relation("rocking dem", st.tuples(decks("block", "arch", "column"), pulses()), 1e-6)
def units_of_motion(deck: Deck, motion: Deck, within: float) -> None:
    """Periods in milliseconds and accelerations in cm/s^2 change no result."""
    deck = changed(deck, motion=motion)
    cm = float(motion["amplitude"].split()[0]) * GRAVITY * 100.0
    there = changed(in_words(deck), motion={"amplitude": f"{cm!r} cm/s^2"})
    one, other = ask(deck, "rocking"), ask(there, "rocking")
    same("units", one, other)
    ok(one, other)
    near("peak rotation", one.results.peak_rotation_rad, other.results.peak_rotation_rad, within, 1e-6)


@relation("tilt", st.tuples(sections(), st.randoms(use_true_random=False)))
def order_and_names_of_blocks(deck: Deck, rng: Any, within: float) -> None:
    """Order and names of blocks, and start and sense of their outlines, change no result."""
    there = copy.deepcopy(deck)
    blocks = there["structure"]["block"]
    rng.shuffle(blocks)
    for k, block in enumerate(blocks):
        first = rng.randrange(len(block["points"]))
        block["points"] = [*block["points"][first:], *block["points"][:first]][:: rng.choice((1, -1))]
        block["name"] = f"z{k}"
    one, other = ask(deck, "tilt"), ask(there, "tilt")
    same("shuffled", one, other)
    near("shuffled", one.capacity, other.capacity, within, 1e-3)


@relation("tilt", sections())
def more_vertices_on_edges(deck: Deck, within: float) -> None:
    """A vertex in the middle of every edge, which divides joints into collinear ones, changes no result."""
    there = copy.deepcopy(deck)
    for block in there["structure"]["block"]:
        points = np.array(block["points"], dtype=float)
        between = 0.5 * (points + np.roll(points, -1, axis=0))
        block["points"] = (np.round(np.stack([points, between], axis=1).reshape(-1, 2), 12) + 0.0).tolist()
    one, other = ask(deck, "tilt"), ask(there, "tilt")
    same("more vertices", one, other)
    near("more vertices", one.capacity, other.capacity, within, 1e-3)


@relation("tilt", st.tuples(number(0.3, 1.5), number(1.0, 4.0), number(0.1, 0.9)), 1e-6)
def a_block_cut_and_glued(width: float, height: float, share: float, within: float) -> None:
    """A block divided into two parts, joined by two rigid bars and a joint without sliding, has the same capacity."""
    whole = {"structure": {"kind": "block", "width": width, "height": height}}
    level, inset = share * height, 0.1 * width
    parts = [
        {"name": name, "points": [[0.0, low], [width, low], [width, high], [0.0, high]]}
        for name, low, high in (("low", 0.0, level), ("high", level, height))
    ]
    bars = [{"start": [x, 0.5 * level], "end": [x, 0.5 * (level + height)], "works_in": "both"} for x in (inset, width - inset)]
    glued = {"structure": {"kind": "blocks", "block": parts}, "joints": {"friction": "no-sliding"}, "ties": bars}
    one, other = ask(changed(whole, joints={"friction": "no-sliding"}), "tilt"), ask(glued, "tilt")
    same("glued", one, other)
    near("glued", one.capacity, other.capacity, within)


PLINTHS = st.tuples(sections("block", "column", "brickwork", "blocks", "stack"), number(3.0, 30.0, 27), number(0.3, 4.0))


@relation("tilt", PLINTHS, 1e-5)
def a_plinth_under_limit_analysis(deck: Deck, width: float, height: float, within: float) -> None:
    """An immobile block below the structure changes no result."""
    one, other = ask(deck, "tilt"), ask(on_plinth(deck, width, height), "tilt")
    same("on a plinth", one, other)
    near("on a plinth", one.capacity, other.capacity, within, 1e-3)


@relation(
    "local-mechanism",
    PLINTHS,
    1e-3,
    examples=(
        (
            {
                "structure": {
                    "kind": "blocks",
                    "block": [{"name": "a", "points": [[0, 0], [0.4, 0], [0.4, 2], [0, 2]]}],
                    "ground": [[-1, 0, 2, 0]],
                }
            },
            20.0,
            4.0,
        ),
    ),
)
def a_plinth_by_codes(deck: Deck, width: float, height: float, within: float) -> None:
    """The size of a part that does not move changes no result of a local mechanism."""
    there = [ask(d, "local-mechanism", mechanism="building") for d in (deck, on_plinth(deck, width, height))]
    same("on a plinth", *there)
    ok(*there)
    if there[0].results.multiplier > 0.999 * deck.get("joints", {}).get("friction", 9.0):
        reject()  # the plinth slides under the same push: the mechanism is not unique
    for name in ("multiplier", "participating_mass_kg", "participating_part", "activation_acceleration_g", "zero_displacement_m"):
        near(f"on a plinth: {name}", *(getattr(a.results, name) for a in there), within)


@relation(
    "dem",
    st.tuples(sections("block", "column"), number(3.0, 10.0), number(0.3, 2.0)),
    0.006,
    share=0.4,
    examples=(
        (
            {
                "structure": {
                    "kind": "blocks",
                    "block": [{"name": "a", "points": [[0, 0], [1.8, 0], [1.8, 3.4], [0, 3.4]]}],
                    "ground": [[-1, 0, 2, 0]],
                }
            },
            5.4,
            0.47,
        ),
    ),
)
def a_plinth_under_elements(deck: Deck, width: float, height: float, within: float) -> None:
    """The same holds for rigid contacts in a slow tilt."""
    one, other = ask(deck, "dem", **SLOW), ask(on_plinth(deck, width, height), "dem", **SLOW)
    same("on a plinth", one, other)
    near("on a plinth", one.capacity, other.capacity, within, 1.0)


WAVES = st.tuples(decks("block", "arch", "column"), number(0.1, 1.0), number(0.5, 3.0))


@relation("rocking dem", WAVES, 1e-6)
def quiet_after_the_end(deck: Deck, amplitude: float, frequency: float, within: float) -> None:
    """Zeros after the end of a record change no result."""
    time = np.arange(0.0, 2.005, 0.01)  # at whose end the wave is zero
    wave = amplitude * np.sin(2.0 * np.pi * frequency * time) * np.sin(0.5 * np.pi * time)
    found: list[dict[str, Answer]] = []
    for values in (wave, np.concatenate([wave, np.zeros(200)])):
        with tempfile.TemporaryDirectory() as folder:
            made = changed(deck, motion=recorded(Path(folder), 0.01, values))
            found.append(
                {
                    "rocking": ask(made, "rocking", Path(folder), end_time=5.0),
                    "rigid contacts": ask(made, "dem", Path(folder), end_time=2.5, **RIGID),
                }
            )
    for name, one in found[0].items():
        other = found[1][name]
        same(name, one, other)
        if one.answers:
            peaks = [np.max(np.abs(list(v.values()) if isinstance(v := a.results.peak_rotation_rad, dict) else v)) for a in (one, other)]
            near(f"{name}: peak rotation", *peaks, within, 1e-3)


@relation("fragility failure-domain", st.tuples(decks("block", "arch", "column"), EARTHQUAKES), 0.0)
def one_thread_or_two(deck: Deck, motion: Deck, within: float) -> None:
    """Ensembles and domains on one and two threads are bit-identical."""
    domain = {"durations": [0.3, 0.6], "amplitudes": 4, "accuracy": 1e-2}
    for kind, keys in (("fragility", {"count": 6, "bootstrap": 0}), ("failure-domain", domain)):
        made = changed(deck, motion=motion) if kind == "fragility" else deck
        one, two = (ask(made, kind, threads=n, **keys) for n in (1, 2))
        must(one.numbers == two.numbers, f"{kind}: one thread {one.numbers}, two {two.numbers}")


FOREIGN = st.sampled_from(
    [
        ("joints", "damping_ratio", 0.3),
        ("material", "poisson", 0.3),
        ("joints", "restitution", 0.7),
        ("joints", "normal_stiffness", 1e9),
        ("joints", "cohesion", 1e5),
        ("joints", "tension", 1e5),
        ("material", "young", 5e9),
        ("initial", "rotation_ratio", 0.4),
        ("joints", "shear_ratio", 0.4),
    ]
)


@relation("tilt thrust rocking failure-domain local-mechanism", st.tuples(decks("arch", "column", "block"), pulses(), FOREIGN), 0.0)
def keys_of_other_strategies(deck: Deck, motion: Deck, key: tuple, within: float) -> None:
    """A key that a result reports as not used has no effect; a key with an effect is not reported as not used."""
    table, name, value = key
    deck = changed(deck, motion=motion)
    there = changed(deck, **{table: {name: value}})
    calls = {
        "tilt": {},
        "thrust": {},
        "rocking": {},
        "local-mechanism": {"mechanism": "building"},
        "failure-domain": {"durations": [0.5], "amplitudes": 2, "accuracy": 0.05},
    }
    for kind, keys in calls.items():
        one, other = ask(deck, kind, **keys), ask(there, kind, **keys)
        told = f" {table}.{name}: " in other.warnings and "not use this key" in other.warnings
        if other.answers and one.answers and told:
            must(one.numbers == other.numbers, f"{kind} says that it leaves out {table}.{name}, which changes its answer")


@relation("moving-load", decks("arch", "pointed-arch", "elliptical-arch"), 1e-4)
def a_load_from_either_side(deck: Deck, within: float) -> None:
    """On a symmetrical arch the load factors at both quarters are equal, and the named place has the least factor."""
    places = [ask(deck, "moving-load", places=[x]) for x in _quarters(deck)]
    ok(*places)
    near("mirrored", places[0].results.collapse_load_N, places[1].results.collapse_load_N, within)
    whole = ask(deck, "moving-load", count=9)
    ok(whole)
    there = ask(deck, "moving-load", places=[whole.results.worst_place_m])
    ok(there)
    near("worst place", there.results.collapse_load_N, whole.results.collapse_load_N, within)
    near("per metre", whole.results.collapse_load_kN_per_m * 1e3, whole.results.collapse_load_N, within)


def _quarters(deck: Deck) -> list[float]:
    """Two places that mirror each other, of an arch about its middle [m]."""
    points = np.concatenate([b["points"] for b in drawn(deck)["structure"]["block"]])
    left, right = points[:, 0].min(), points[:, 0].max()
    return [float(left + share * (right - left)) for share in (0.3, 0.7)]


@relation("rocking", st.tuples(decks("block"), pulses(0.3, 1.0)), 1e-6)
def a_wall_on_one_side(deck: Deck, motion: Deck, within: float) -> None:
    """A block beside a wall rocks only away from it; with wall and motion on the other side the run is mirrored."""
    moving = changed(deck, motion=motion)
    turned_motion = {**motion, "amplitude": f"-{motion['amplitude']}"}
    one = ask(changed(moving, supports={"abutting_wall": "left"}), "rocking", end_time=2.0)
    other = ask(changed(deck, motion=turned_motion, supports={"abutting_wall": "right"}), "rocking", end_time=2.0)
    ok(one, other)
    must(one.results.peak_rotation_rad >= 0.0, f"a rotation of {one.results.peak_rotation_rad} into the wall")
    if one.results.decided_by_last_digits:
        reject()
    same("mirrored", one, other)
    near("peak rotation", one.results.peak_rotation_rad, -other.results.peak_rotation_rad, within, 1e-6)
    r = [ask(changed(moving, supports={"abutting_wall": side}), "tilt") for side in ("left", "right")]
    near("statics knows no wall", r[0].capacity, r[1].capacity, within)
