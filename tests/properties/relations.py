"""Relations that must hold between what strategies say of random buildings: the registry.

A relation is a function of a case, which its strategy of hypothesis draws: a deck, or a deck and what is done to it. It
raises Broken where it does not hold, and calls `reject` where there is nothing to compare.
"""

import copy
import functools
import itertools
import json
import math
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import tomlkit
from asking import Answer, Deck, ask, at_most, must, near, run, same
from buildings import (
    KINDS,
    MESH,
    ROCKING,
    SECTIONS,
    SMALL,
    SOLIDS,
    arches,
    changed,
    cut,
    decks,
    drawn,
    in_words,
    mirrored,
    moved,
    number,
    on_plinth,
    pulses,
    scaled,
    sections,
    shaken,
)
from hypothesis import reject
from hypothesis import strategies as st

import extrados
from extrados import kinds
from extrados.decks.reader import read_text

GRAVITY = 9.80665
#: Discrete elements as rigid contacts
RIGID = {"solver": "nonsmooth"}
#: Accuracy of the tilt test of discrete elements in these relations [g]
SLOW = {"test": "tilt", "solver": "nonsmooth", "tilt_accuracy": 0.002, "time_step": 0.002}


@dataclass(frozen=True)
class Relation:
    """One relation: the strategies that it asks, the cases that it is asked of, what must hold, and within which tolerance.

    exception: a documented reason for which a strategy breaks it, which the function then leaves out. awaits: the fault that
    breaks it today, which is expected to be seen at the first of the examples. share: of the cases of the long run. examples: cases
    that broke it once.
    """

    name: str
    asks: tuple[str, ...]
    case: st.SearchStrategy
    holds: Callable[..., None]
    within: float
    exception: str = ""
    awaits: str = ""
    share: float = 1.0
    examples: tuple = ()

    def check(self, case: Any) -> None:
        """Broken where the case does not keep it."""
        self.holds(*(case if isinstance(case, tuple) else (case,)), self.within)


RELATIONS: dict[str, Relation] = {}


def relation(asks: str, case: st.SearchStrategy, within: float = 1e-6, **more: Any) -> Callable:
    """Register a function of a case and a tolerance under its name."""

    def registered(holds: Callable) -> Callable:
        name = holds.__name__.replace("_", "-")
        RELATIONS[name] = Relation(name, tuple(asks.split()), case, holds, within, **more)
        return holds

    return registered


def ok(*answers: Answer) -> None:
    """Go on only where all have a result."""
    if not all(a.answers for a in answers):
        reject()


def asked_of(deck: Deck) -> Deck:
    """The table of the quickest analysis without a motion that can look at the building."""
    kind = deck["structure"]["kind"]
    if kind == "building":
        return {"kind": "local-mechanism", "mechanism": "building"}
    return {"kind": "tilt", "direction": 0.0} if kind in SOLIDS else {"kind": "tilt"}


def statics(deck: Deck) -> Answer:
    """Its answer."""
    return ask(deck, **asked_of(deck))


def filled(there: Any) -> Any:
    """A table without the keys that hold nothing."""
    if isinstance(there, dict):
        return {k: filled(v) for k, v in there.items() if v is not None}
    return [filled(v) for v in there] if isinstance(there, list) else there


#: Of results: what depends on the way to the answer, or on the order of what is equal
OF_THE_WAY = (
    "gap",
    "residual",
    "joint",
    "hinge",
    "touching",
    "steps",
    "factor_bytes",
    "opening_contacts",
    "fastest",
    "sliding",
)


def alike(told: str, one: Answer, other: Answer, within: float) -> None:
    """Two answers have the same outcome and the same numbers; words and counts of work may differ."""
    same(told, one, other)
    a, b = (
        {k: v for k, v in _flat(x.numbers).items() if not any(word in k for word in OF_THE_WAY)} for x in (one, other)
    )
    must(set(a) == set(b), f"{told}: other results: {sorted(set(a) ^ set(b))}")
    scale: dict[str, float] = {}  # of all numbers of one unit: one of them may be what is left of a sum
    for name, value in a.items():
        if isinstance(value, float):
            scale[name.rpartition("_")[2]] = max(abs(value), scale.get(name.rpartition("_")[2], 1e-6))
    for name, value in a.items():
        if isinstance(value, float) and isinstance(b[name], float | int):
            near(f"{told}: {name}", value, b[name], within, scale[name.rpartition("_")[2]])


def _flat(there: Any, name: str = "") -> dict[str, Any]:
    if isinstance(there, dict):
        return {k: v for key, value in there.items() for k, v in _flat(value, f"{name}.{key}").items()}
    if isinstance(there, list):
        return {k: v for i, value in enumerate(there) for k, v in _flat(value, f"{name}.{i}").items()}
    return {name: there}


CRACKS = {"density": 2000.0, "young": 2e9, "tensile_strength": 1e5, "fracture_energy": 50.0}
ANY = decks(*KINDS).filter(lambda deck: deck["structure"]["kind"] != "mesh")
STONES = decks(*SECTIONS, *SOLIDS)


# ----- invariance


#: Why slow tilts of walls are not compared with each other, but with the bounds of limit analysis (a-slow-tilt)
INTERVAL = "states with friction without dilatancy are an interval: a wall of several blocks ends at any of them"


@relation("tilt", sections())
def mirror_of_a_section(deck: Deck, within: float) -> None:
    """Left and right exchanged exchange the two capacities."""
    one, other = ask(deck, "tilt"), ask(mirrored(deck), "tilt")
    same("mirrored", one, other)
    near("mirrored", one.capacity, other.capacity[::-1], within, 1e-3)


@relation("tilt", sections(*SMALL, friction=number(0.2, 0.9, 14)), 1e-4)
def mirror_without_dilatancy(deck: Deck, within: float) -> None:
    """Non-associated friction too."""
    one, other = (ask(d, "tilt", friction_rule="non-associated", starts=3) for d in (deck, mirrored(deck)))
    same("mirrored", one, other)
    ok(one, other)
    for sense in ("", "_opposite"):
        bound = getattr(one.results, f"collapse_acceleration{sense}_g")
        must(bound >= 0.0, f"a capacity of {bound} g")


@relation("dem", sections("block", "column"), 0.006, share=0.2, exception=INTERVAL)
def mirror_of_elements(deck: Deck, within: float) -> None:
    """The slow tilt of rigid contacts, to both sides."""
    one, other = ask(deck, "dem", **SLOW), ask(mirrored(deck), "dem", **SLOW)
    same("mirrored", one, other)
    near("mirrored", one.capacity, other.capacity[::-1], within, 1.0)


BODIES = st.tuples(number(0.2, 1.0), number(0.2, 1.0), number(1.0, 3.0), number(-0.6, 0.6), pulses()).map(
    lambda t: {
        "structure": {"kind": "block", "mass": 1000.0, "inertia": round(400.0 * t[2] ** 2, 3), "centre_height": t[2],
                      "toe_right": t[0], "toe_left": t[1]},
        "initial": {"rotation_ratio": t[3]}, "motion": t[4],
    }
)  # fmt: skip


@relation("rocking", BODIES, 1e-6)
def mirror_of_a_rocking_body(deck: Deck, within: float) -> None:
    """Toes exchanged, motion and start turned around: the rotation changes its sign."""
    s, m = deck["structure"], deck["motion"]
    there = changed(
        deck, structure={"toe_right": s["toe_left"], "toe_left": s["toe_right"]}, motion={"amplitude": f"-{m['amplitude']}"},
        initial={"rotation_ratio": -deck["initial"]["rotation_ratio"]},
    )  # fmt: skip
    one, other = ask(deck, "rocking"), ask(there, "rocking")
    ok(one, other)
    if one.results.decided_by_last_digits:
        reject()
    same("mirrored", one, other)
    near("peak rotation", one.results.peak_rotation_rad, -other.results.peak_rotation_rad, within, 1e-6)


@relation("tilt thrust", st.tuples(sections(), number(-900.0, 900.0), number(-50.0, 50.0)))
def translation_of_a_section(deck: Deck, dx: float, dy: float, within: float) -> None:
    """Where a survey has its origin changes nothing."""
    there = moved(deck, lambda p: p + np.array([dx, dy]))
    for kind in ("tilt", "thrust"):
        one, other = ask(deck, kind), ask(there, kind)
        same(kind, one, other)
        near(kind, one.capacity, other.capacity, within, 1e-3)
    near(
        "weight",
        ask(deck, "tilt").numbers.get("weight_N", 0.0),
        ask(there, "tilt").numbers.get("weight_N", 0.0),
        within,
    )


@relation("dem", st.tuples(sections("block", "column"), number(-90.0, 90.0)), 0.006, share=0.4)
def translation_of_elements(deck: Deck, dx: float, within: float) -> None:
    """Rigid contacts under a slow tilt."""
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
    """The walls out of their planes, whichever way the plan lies."""
    there = [ask(d, "local-mechanism", mechanism="building") for d in (deck, turned(deck, angle))]
    same("turned", *there)
    ok(*there)
    for name in ("multiplier", "margin"):  # which of two equal walls is called the worst is a matter of rounding
        near(name, *(sorted(getattr(w, name) or 0.0 for w in a.results.walls) for a in there), within)
    near("multiplier", *(a.results.multiplier for a in there), within)


PUSH = {"mesh": {"size": 1.2, "layers": 3}, "events": 15}
MASONRY = st.just(CRACKS)


@relation("pushover", st.tuples(decks("building", material=MASONRY), st.sampled_from([90.0, 180.0])), 1e-3)
def turned_plan_pushed(deck: Deck, angle: float, within: float) -> None:
    """The push turned with the plan."""
    one, other = (
        ask(deck, "pushover", direction=0.0, **PUSH),
        ask(turned(deck, angle), "pushover", direction=angle, **PUSH),
    )
    same("turned", one, other)
    ok(one, other)
    for name in ("initial_stiffness_N_m", "first_event_load_N", "weight_N"):
        near(name, getattr(one.results, name), getattr(other.results, name), within)


@relation("tilt", st.tuples(decks(*SOLIDS), number(0.0, 180.0, 12)), 1e-5)
def opposite_direction_of_solids(deck: Deck, angle: float, within: float) -> None:
    """What is borne along a direction is the opposite of what is borne against it."""
    one, other = ask(deck, "tilt", direction=angle, rose=4), ask(deck, "tilt", direction=angle - 180.0, rose=4)
    same("turned around", one, other)
    near("turned around", one.capacity, other.capacity[::-1], within, 1e-3)


@relation("tilt", decks("dome"), 1e-4)
def a_dome_turned_by_a_lune(deck: Deck, within: float) -> None:
    """A dome is the same from every lune."""
    angle = 360.0 / deck["structure"]["lunes"]
    one, other = ask(deck, "tilt", direction=0.0, rose=4), ask(deck, "tilt", direction=angle, rose=4)
    same("turned", one, other)
    near("turned", one.capacity, other.capacity, within, 1e-3)


@relation("tilt local-mechanism", ANY, 1e-7)
def units(deck: Deck, within: float) -> None:
    """Numbers as text in other units."""
    deck = changed(deck, material={"density": 1900.0}, joints={"friction": 0.7})
    alike("units", statics(deck), statics(in_words(deck)), within)


@relation("rocking dem", st.tuples(decks("block", "arch", "column"), pulses()), 1e-6)
def units_of_motion(deck: Deck, motion: Deck, within: float) -> None:
    """Periods in milliseconds, accelerations in cm/s^2."""
    deck = changed(deck, motion=motion)
    cm = float(motion["amplitude"].split()[0]) * GRAVITY * 100.0
    there = changed(in_words(deck), motion={"amplitude": f"{cm!r} cm/s^2"})
    one, other = ask(deck, "rocking"), ask(there, "rocking")
    same("units", one, other)
    ok(one, other)
    near("peak rotation", one.results.peak_rotation_rad, other.results.peak_rotation_rad, within, 1e-6)


@relation("tilt", st.tuples(sections(), st.randoms(use_true_random=False)))
def order_and_names_of_blocks(deck: Deck, rng: Any, within: float) -> None:
    """Blocks in another order, called otherwise, their outlines begun elsewhere and passed the other way round."""
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
    """A vertex in the middle of every edge splits joints into collinear ones."""
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
    """A block in two parts that two rigid bars and a joint without sliding hold together."""
    whole = {"structure": {"kind": "block", "width": width, "height": height}}
    level, inset = share * height, 0.1 * width
    parts = [
        {"name": name, "points": [[0.0, low], [width, low], [width, high], [0.0, high]]}
        for name, low, high in (("low", 0.0, level), ("high", level, height))
    ]
    bars = [
        {"start": [x, 0.5 * level], "end": [x, 0.5 * (level + height)], "works_in": "both"}
        for x in (inset, width - inset)
    ]
    glued = {"structure": {"kind": "blocks", "block": parts}, "joints": {"friction": "no-sliding"}, "ties": bars}
    one, other = ask(changed(whole, joints={"friction": "no-sliding"}), "tilt"), ask(glued, "tilt")
    same("glued", one, other)
    near("glued", one.capacity, other.capacity, within)


PLINTHS = st.tuples(
    sections("block", "column", "brickwork", "blocks", "stack"), number(3.0, 30.0, 27), number(0.3, 4.0)
)


@relation("tilt", PLINTHS, 1e-5)
def a_plinth_under_limit_analysis(deck: Deck, width: float, height: float, within: float) -> None:
    """A block that cannot move under what stands on it."""
    one, other = ask(deck, "tilt"), ask(on_plinth(deck, width, height), "tilt")
    same("on a plinth", one, other)
    near("on a plinth", one.capacity, other.capacity, within, 1e-3)


@relation("local-mechanism", PLINTHS, 1e-3, awaits="A1", examples=(
    ({"structure": {"kind": "blocks", "block": [{"name": "a", "points": [[0, 0], [0.4, 0], [0.4, 2], [0, 2]]}],
                    "ground": [[-1, 0, 2, 0]]}}, 20.0, 4.0),
))  # fmt: skip
def a_plinth_by_codes(deck: Deck, width: float, height: float, within: float) -> None:
    """The size of a part that does not move changes no result of a local mechanism."""
    there = [ask(d, "local-mechanism", mechanism="building") for d in (deck, on_plinth(deck, width, height))]
    same("on a plinth", *there)
    ok(*there)
    for name in (
        "multiplier",
        "participating_mass_kg",
        "participating_part",
        "activation_acceleration_g",
        "zero_displacement_m",
    ):
        near(f"on a plinth: {name}", *(getattr(a.results, name) for a in there), within)


@relation("dem", st.tuples(sections("block", "column"), number(3.0, 10.0), number(0.3, 2.0)), 0.006, share=0.4, awaits="A18", examples=(
    ({"structure": {"kind": "blocks", "block": [{"name": "a", "points": [[0, 0], [1.8, 0], [1.8, 3.4], [0, 3.4]]}],
                    "ground": [[-1, 0, 2, 0]]}}, 5.4, 0.47),
))  # fmt: skip
def a_plinth_under_elements(deck: Deck, width: float, height: float, within: float) -> None:
    """Rigid contacts under a slow tilt."""
    one, other = ask(deck, "dem", **SLOW), ask(on_plinth(deck, width, height), "dem", **SLOW)
    same("on a plinth", one, other)
    near("on a plinth", one.capacity, other.capacity, within, 1.0)


def recorded(folder: Path, step: float, values: np.ndarray) -> Deck:
    """A motion of a file in the folder, values in g."""
    rows = [f"{k * step:.6f},{value:.9g}" for k, value in enumerate(values)]
    (folder / "motion.csv").write_text("time_s,acceleration_g\n" + "\n".join(rows) + "\n")
    return {"kind": "record", "file": "motion.csv"}


WAVES = st.tuples(decks("block", "arch", "column"), number(0.1, 1.0), number(0.5, 3.0))


@relation("rocking dem", WAVES, 1e-6)
def quiet_after_the_end(deck: Deck, amplitude: float, frequency: float, within: float) -> None:
    """Zeros after the end of a record."""
    time = np.arange(0.0, 2.0, 0.01)
    wave = amplitude * np.sin(2.0 * np.pi * frequency * time) * np.sin(0.5 * np.pi * time)
    found: list[dict[str, Answer]] = []
    for values in (wave, np.concatenate([wave, np.zeros(200)])):
        with tempfile.TemporaryDirectory() as folder:
            made = changed(deck, motion=recorded(Path(folder), 0.01, values))
            found.append({
                "rocking": ask(made, "rocking", Path(folder), end_time=5.0),
                "rigid contacts": ask(made, "dem", Path(folder), end_time=2.5, **RIGID),
            })  # fmt: skip
    for name, one in found[0].items():
        other = found[1][name]
        same(name, one, other)
        if one.answers:
            peaks = [
                np.max(np.abs(list(v.values()) if isinstance(v := a.results.peak_rotation_rad, dict) else v))
                for a in (one, other)
            ]
            near(f"{name}: peak rotation", *peaks, within, 1e-3)


@relation("tilt local-mechanism", ANY, 1e-12)
def a_deck_through_json(deck: Deck, within: float) -> None:
    """What summary.json keeps of a deck is that deck."""
    resolved = json.loads(json.dumps(run({**deck, "analysis": [asked_of(deck)]}).summary["deck"]["resolved"]))
    back = {name: filled(resolved[name]) for name in ("structure", "material", "joints")}
    alike("through JSON", statics(deck), statics(back), within)


@relation("tilt local-mechanism", ANY, 1e-12)
def a_deck_as_text_and_as_objects(deck: Deck, within: float) -> None:
    """A deck as a dictionary, as TOML, and made of objects."""
    analysis = asked_of(deck)
    whole = {**deck, "analysis": [analysis]}
    one = Answer(run(whole).results[0])
    alike("as text", one, Answer(extrados.run(read_text(tomlkit.dumps(whole).encode()), threads=1).results[0]), within)
    names = {kind: place.split(":")[1] for there in kinds.TABLES.values() for kind, place in there.items()}
    structure, table = dict(deck["structure"]), dict(analysis)
    made = extrados.deck(
        getattr(extrados, names[structure.pop("kind")])(**structure), getattr(extrados, names[table.pop("kind")])(**table),
        joints=extrados.Joints(**deck["joints"]),
    )  # fmt: skip
    alike("as objects", one, Answer(extrados.run(made, threads=1).results[0]), within)


@relation("tilt", sections(), 1e-4)
def a_section_through_files(deck: Deck, within: float) -> None:
    """As JSON, as a drawing, as an assembly of COMPAS, and as blocks of UDEC, read back."""
    one, there = ask(deck, "tilt"), deck["structure"]
    densities = {b.get("density") for b in there["block"]}
    if len(densities) > 1 and max(densities) - min(densities) > 1.0:
        reject()  # these files hold no densities
    ok(one)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "stones.json").write_text(json.dumps({
            "blocks": [{"name": b["name"], "points": b["points"]} for b in there["block"]], "ground": there["ground"],
        }))  # fmt: skip
        drawing = ezdxf.new()
        drawing.header["$INSUNITS"] = 6
        drawing.layers.add("GROUND")
        for block in there["block"]:
            drawing.modelspace().add_lwpolyline(block["points"], close=True)
        for row in there["ground"]:
            drawing.modelspace().add_line(row[:2], row[2:], dxfattribs={"layer": "GROUND"})
        drawing.saveas(folder / "stones.dxf")
        whole = {**deck, "analysis": [{"kind": "tilt"}]}
        (folder / "compas.json").write_text(extrados.export(whole, "compas"))
        lines = re.findall(r"^block create polygon (.*)$", extrados.export(whole, "udec"), re.M)
        polygons = [[[float(v) for v in pair.split(",")] for pair in line.split()] for line in lines]
        shape = {"kind": "blocks", "depth": there.get("depth", 1.0)}
        files = {
            "JSON": {**shape, "file": "stones.json"}, "DXF": {**shape, "file": "stones.dxf"},
            "COMPAS": {**shape, "file": "compas.json", "unit": "m"},
            "UDEC": {**shape, "block": [{"name": f"b{k}", "points": p} for k, p in enumerate(polygons)], "ground": there["ground"]},
        }  # fmt: skip
        for form, structure in files.items():
            back = ask({**deck, "structure": structure}, "tilt", folder)
            same(form, one, back)
            near(form, one.capacity, back.capacity, within, 1.0)


@relation("tilt", decks(*SOLIDS), 1e-4, awaits="A11", examples=(
    {"structure": {"kind": "cross-vault", "radius": 5.0, "thickness": 0.8, "embrace": 140.0, "voussoirs": 4}, "joints": {"friction": 0.7}},
))  # fmt: skip
def solids_through_compas(deck: Deck, within: float) -> None:
    """An assembly of COMPAS read back bears the same."""
    one = ask(deck, "tilt", direction=0.0, rose=4)
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "stones.json").write_text(
            extrados.export({**deck, "analysis": [{"kind": "tilt", "direction": 0.0}]}, "compas")
        )
        back = ask(
            {**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}},
            "tilt",
            Path(name),
            direction=0.0,
            rose=4,
        )
    same("COMPAS", one, back)
    must(
        one.numbers.get("blocks") == back.numbers.get("blocks"),
        f"{one.numbers.get('blocks')} stones, read back {back.numbers.get('blocks')}",
    )
    near("COMPAS", one.capacity, back.capacity, within, 1e-2)


EARTHQUAKES = st.tuples(st.integers(6, 10), st.integers(1, 10**6)).map(
    lambda t: {"kind": "generated", "mmi": t[0], "duration": 2.0, "seed": t[1], "lines": 8}
)


@relation("fragility failure-domain", st.tuples(decks("block", "arch", "column"), EARTHQUAKES), 0.0)
def one_thread_or_two(deck: Deck, motion: Deck, within: float) -> None:
    """Ensembles and domains, bit for bit."""
    domain = {"durations": [0.3, 0.6], "amplitudes": 4, "accuracy": 1e-2}
    for kind, keys in (("fragility", {"count": 6, "bootstrap": 0}), ("failure-domain", domain)):
        made = changed(deck, motion=motion) if kind == "fragility" else deck
        one, two = (ask(made, kind, threads=n, **keys) for n in (1, 2))
        must(one.numbers == two.numbers, f"{kind}: one thread {one.numbers}, two {two.numbers}")


FOREIGN = st.sampled_from([
    ("joints", "damping_ratio", 0.3), ("material", "poisson", 0.3), ("joints", "restitution", 0.7),
("joints", "normal_stiffness", 1e9), ("joints", "cohesion", 1e5),
    ("joints", "tension", 1e5), ("material", "young", 5e9), ("initial", "rotation_ratio", 0.4), ("joints", "shear_ratio", 0.4),
])  # fmt: skip


@relation(
    "tilt thrust rocking failure-domain local-mechanism",
    st.tuples(decks("arch", "column", "block"), pulses(), FOREIGN),
    0.0,
)
def keys_of_other_strategies(deck: Deck, motion: Deck, key: tuple, within: float) -> None:
    """What an answer says that it leaves out has no effect; what has an effect is not said to be left out."""
    table, name, value = key
    deck = changed(deck, motion=motion)
    there = changed(deck, **{table: {name: value}})
    calls = {"tilt": {}, "thrust": {}, "rocking": {}, "local-mechanism": {"mechanism": "building"},
             "failure-domain": {"durations": [0.5], "amplitudes": 2, "accuracy": 0.05}}  # fmt: skip
    for kind, keys in calls.items():
        one, other = ask(deck, kind, **keys), ask(there, kind, **keys)
        told = f" {table}.{name}: " in other.warnings and "not use it" in other.warnings
        if other.answers and one.answers and told:
            must(
                one.numbers == other.numbers, f"{kind} says that it leaves out {table}.{name}, which changes its answer"
            )


# ----- scale


SCALES = st.sampled_from([0.25, 2.0, 4.0])


@relation("rocking", st.tuples(decks(*ROCKING), pulses(0.1, 1.2), SCALES), 1e-4)
def similitude_of_rocking(deck: Deck, motion: Deck, factor: float, within: float) -> None:
    """Lengths times s, times times the root of s: the same rotations."""
    end, root = 4.0 * motion["period"] + 2.0, math.sqrt(factor)
    there = changed(scaled(deck, factor), motion=changed(motion, period=motion["period"] * root))
    one = ask(changed(deck, motion=motion), "rocking", end_time=end)
    other = ask(there, "rocking", end_time=end * root)
    ok(one, other)
    if one.results.decided_by_last_digits or other.results.decided_by_last_digits:
        reject()
    same("scaled", one, other)
    near("peak rotation", one.results.peak_rotation_ratio, other.results.peak_rotation_ratio, within, 1e-4)
    near("uplift", one.results.uplift_acceleration_g, other.results.uplift_acceleration_g, within)


@relation("dem", st.tuples(decks("block", "column"), pulses(0.1, 0.6), st.sampled_from([0.25, 4.0])), 1e-3, share=0.4)
def similitude_of_elements(deck: Deck, motion: Deck, factor: float, within: float) -> None:
    """Rigid contacts have no other scale of time than their size."""
    root = math.sqrt(factor)
    keys = {**RIGID, "end_time": 1.0, "time_step": 0.002, "output_step": 0.01}
    one = ask(changed(deck, motion=motion), "dem", **keys)
    there = changed(scaled(deck, factor), motion=changed(motion, period=motion["period"] * root))
    other = ask(there, "dem", **{**keys, **{k: keys[k] * root for k in ("end_time", "time_step", "output_step")}})
    ok(one, other)
    same("scaled", one, other)
    near(
        "peak displacement",
        one.results.peak_displacement_m * factor,
        other.results.peak_displacement_m,
        within,
        1e-3 * factor,
    )


@relation("tilt local-mechanism", st.tuples(STONES, SCALES), 1e-5)
def statics_of_another_size(deck: Deck, factor: float, within: float) -> None:
    """Collapse accelerations have no scale."""
    if deck["structure"].get("preset"):
        reject()  # sizes of a preset are not in the deck
    one, other = statics(deck), statics(scaled(deck, factor))
    same("scaled", one, other)
    near("scaled", one.capacity, other.capacity, within, 1e-3)


@relation("local-mechanism", st.tuples(decks("block", "column", "arch", "brickwork"), SCALES), 1e-4)
def codes_of_another_size(deck: Deck, factor: float, within: float) -> None:
    """a_0* has no scale, d_0* is a length, T_SLV goes by its root, M* by its square."""
    answers = [ask(d, "local-mechanism", mechanism="building") for d in (deck, scaled(deck, factor))]
    same("scaled", *answers)
    ok(*answers)
    one, other = (a.results for a in answers)
    for name, power in (
        ("multiplier", 0.0), ("participating_part", 0.0), ("activation_acceleration_g", 0.0), ("zero_displacement_m", 1.0),
        ("ultimate_displacement_m", 1.0), ("collapse_displacement_m", 1.0), ("equivalent_period_s", 0.5), ("swaying_weight_N", None), ("participating_mass_kg", None),
    ):  # fmt: skip
        a, b = getattr(one, name), getattr(other, name)
        if a is None or b is None:
            must(a is b, f"{name}: {a} against {b}")
            continue
        lengths = 3.0 if "depth" in deck["structure"] else 2.0
        near(name, a * factor ** (lengths if power is None else power), b, within)


@relation("tilt local-mechanism", st.tuples(STONES, number(0.3, 3.0)), 1e-5)
def statics_of_another_density(deck: Deck, factor: float, within: float) -> None:
    """Collapse accelerations do not know the density, weights go with it."""
    if deck["structure"]["kind"] in ("bridge", "aisled-vault"):
        reject()  # their fill has a density of its own
    one, other = (statics(changed(deck, material={"density": 2000.0 * f})) for f in (1.0, factor))
    same("density", one, other)
    near("density", one.capacity, other.capacity, within, 1e-3)
    if one.answers:
        near("weight", one.results.weight_N * factor, other.results.weight_N, within)


@relation("moving-load thrust", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(0.3, 3.0)), 1e-5)
def loads_in_proportion(deck: Deck, factor: float, within: float) -> None:
    """Collapse loads and thrusts go with the density, factors on the weight are densities, the safety factor goes by the load."""
    there = [changed(deck, material={"density": 2000.0 * f}) for f in (1.0, factor)]
    for name in ("least", "most"):
        thrusts = [ask(d, "thrust") for d in there]
        ok(*thrusts)
        lines = [getattr(a.results, name, None) for a in thrusts]
        if None not in lines:
            near(f"{name} thrust", lines[0].horizontal_N * factor, lines[1].horizontal_N, within)
    one, other = (ask(d, "moving-load", count=7) for d in there)
    ok(one, other)
    near("collapse load", one.results.collapse_load_N * factor, other.results.collapse_load_N, within)
    by_factor = ask(there[0], "moving-load", count=7, factors={"masonry": factor})
    near("factor on the weight", by_factor.results.collapse_load_N, other.results.collapse_load_N, within)
    safe = [ask(there[0], "moving-load", count=7, force=f).results.safety_factor for f in (1e3, 1e3 * factor)]
    near("safety factor", safe[0], safe[1] * factor, within)
    near("safety factor", safe[0] * 1e3, one.results.collapse_load_N, within)


@relation("fragility", st.tuples(decks("block"), EARTHQUAKES, number(0.5, 2.0)), 1e-6)
def a_factor_on_the_motion(deck: Deck, motion: Deck, factor: float, within: float) -> None:
    """A set at a level is the set scaled by it: the same share comes down."""
    whole = changed(deck, motion=motion)
    levels = ask(whole, "fragility", count=8, intensity="scale", levels=[1.0, round(factor, 6) + 0.01], bootstrap=0)
    plain = ask(changed(deck, motion={**motion, "factor": 1.0}), "fragility", count=8, bootstrap=0)
    ok(levels, plain)
    at_one = levels.results.collapsed[levels.results.levels.index(1.0)]
    must(
        at_one == plain.results.collapsed, f"{at_one} of a set at level 1 against {plain.results.collapsed} of the set"
    )


# ----- order


#: What makes a structure of a kind stouter
STOUT = {"arch": ("thickness",), "pointed-arch": ("thickness",), "elliptical-arch": ("thickness",), "block": ("width",),
         "column": ("width", "top_width"), "brickwork": ("unit_length",)}  # fmt: skip


@relation("tilt", st.tuples(decks(*STOUT), number(1.01, 1.5)), 2e-3)
def stouter(deck: Deck, factor: float, within: float) -> None:
    """A stouter section bears no less."""
    keys = {k: deck["structure"][k] * factor for k in STOUT[deck["structure"]["kind"]]}
    at_most("stouter", ask(deck, "tilt").capacity, ask(changed(deck, structure=keys), "tilt").capacity, within)


@relation("tilt", st.tuples(STONES, number(0.05, 0.6), number(0.01, 0.5)), 1e-5)
def rougher(deck: Deck, friction: float, more: float, within: float) -> None:
    """More friction bears no less, and no sliding at all most."""
    found = [statics(changed(deck, joints={"friction": mu})) for mu in (friction, friction + more, "no-sliding")]
    if deck["structure"]["kind"] in SOLIDS and found[2].status == "refused":
        found = found[:2]
    for less, most in itertools.pairwise(found):
        if "refused" in (less.outcome, most.outcome):
            continue
        at_most("rougher", less.capacity, most.capacity, within, 1e-2)


TIED = st.tuples(decks("arch", "pointed-arch", "elliptical-arch", "column"), number(0.001, 0.3), number(1.0, 3.0))


@relation("tilt", TIED, 1e-5)
def a_stronger_tie(deck: Deck, force: float, factor: float, within: float) -> None:
    """A tie bears no less than none, and a stronger one no less than a weak one."""
    section = drawn(deck)
    blocks = section["structure"]["block"]
    if len(blocks) < 2:
        reject()
    ends = [np.mean(blocks[k]["points"], axis=0).tolist() for k in (0, -1)]
    bare = ask(section, "tilt")
    ok(bare)
    weight = bare.results.weight_N
    tie = {"start": ends[0], "end": ends[1], "works_in": "tension"}
    found = [
        bare,
        *(ask({**section, "ties": [{**tie, "yield_force": f * weight}]}, "tilt") for f in (force, force * factor)),
    ]
    for less, most in itertools.pairwise(found):
        at_most("a tie", less.capacity, most.capacity, within)


@relation("tilt", st.tuples(decks("arch", "column", "block"), number(3.0, 100.0), number(1.1, 4.0)), 1e-4)
def stronger_stone(deck: Deck, strength: float, factor: float, within: float) -> None:
    """A greater compressive strength bears no less, and an unlimited one most. strength: over the mean pressure on the ground."""
    bare = ask(deck, "tilt")
    ok(bare)
    stones = drawn(deck)["structure"]
    length = sum(math.dist(row[:2], row[2:]) for row in stones["ground"])
    pressure = bare.results.weight_N / (length * stones["depth"])
    weak, strong = (
        ask(changed(deck, material={"compressive_strength": strength * f * pressure}), "tilt") for f in (1.0, factor)
    )
    for less, most in ((weak, strong), (strong, bare)):
        if less.answers or less.outcome == "cannot-stand":
            at_most("stronger", less.capacity, most.capacity, within)


@relation("tilt", st.tuples(sections(*SMALL, "arch"), st.integers(0, 20), number(0.2, 0.8)), 1e-5)
def a_cut(deck: Deck, block: int, share: float, within: float) -> None:
    """A new joint through a block lets it move in more ways: it bears no more."""
    at_most("cut", ask(cut(deck, block, share), "tilt").capacity, ask(deck, "tilt").capacity, within)


@relation("tilt", decks("brickwork", "blocks", "column", "arch", "stack", friction=number(0.2, 0.9, 14)), 1e-4)
def dilatancy_helps(deck: Deck, within: float) -> None:
    """Associated friction bears no less than friction without dilatancy."""
    less, most = ask(deck, "tilt", friction_rule="non-associated", starts=3), ask(deck, "tilt")
    if less.outcome in ("refused", "failed"):
        reject()
    at_most("non-associated", less.capacity, most.capacity, within)


@relation("tilt", decks(*SOLIDS), 1e-5)
def bounds_of_solids(deck: Deck, within: float) -> None:
    """Bounds from within and around enclose the capacity, and its certificate is kept."""
    answer = ask(deck, "tilt", direction=0.0, rose=4, pyramids=8)
    ok(answer)
    r = answer.results
    at_most("lower bound", r.pyramids.lower_g or 0.0, r.collapse_acceleration_g, within)
    if r.pyramids.upper_g is not None:
        at_most("upper bound", r.collapse_acceleration_g, r.pyramids.upper_g, within)
    near("virtual work", r.upper_bound_g, r.collapse_acceleration_g, within)
    at_most("residuals", max(r.duality_gap, r.equilibrium_residual, r.friction_residual, r.overlap_residual), 1e-5, 0.0)
    at_most("least of all directions", r.least_acceleration_g, r.collapse_acceleration_g, within)


CONVEX = "files of solids take convex parts: stones between curves are refused in words"
#: The solver of central thrust lines gives up on some walls
UNSETTLED = "did not settle"
GIVES_UP = "the most central thrust line of a wall of several blocks does not always settle: `thrust` fails in words"


@relation("tilt thrust", sections(friction=st.just("no-sliding")), 1e-5, exception=GIVES_UP)
def equilibrium_at_collapse(deck: Deck, within: float) -> None:
    """Reactions carry the weight and the push; both bounds meet; beyond the interval nothing is admissible."""
    answer = ask(deck, "tilt")
    ok(answer)
    r = answer.results
    if r.collapse_acceleration_g > 4.8:
        reject()  # `thrust` takes 5 g at most
    up = sum(one.vertical_N for one in r.reactions)
    along = sum(one.horizontal_N for one in r.reactions)
    near("vertical reactions", up, r.weight_N, within)
    near("horizontal reactions", abs(along), r.collapse_acceleration_g * r.weight_N, within, 1e-3 * r.weight_N)
    at_most("gap of the bounds", r.duality_gap, 1e-6, 0.0)
    for gamma, stands in ((0.98 * r.collapse_acceleration_g, True), (1.02 * r.collapse_acceleration_g + 1e-3, False)):
        there = ask(deck, "thrust", gamma=gamma)
        must(
            UNSETTLED in there.said or (there.outcome == "stands") == stands,
            f"a thrust line at {gamma} g of {r.collapse_acceleration_g}: {there.outcome}",
        )


@relation("tilt", decks("block", "column", "brickwork", "arch", "stack", "frame"), 1e-4, exception=CONVEX)
def a_section_drawn_out(deck: Deck, within: float) -> None:
    """A plane section as solids bears the same."""
    deck = drawn(deck)
    one = ask(deck, "tilt")
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "stones.json").write_text(extrados.export({**deck, "analysis": [{"kind": "tilt"}]}, "compas"))
        other = ask(
            {**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}},
            "tilt",
            Path(name),
            direction=0.0,
            rose=4,
        )
    if "not convex" in other.said:
        reject()
    same("drawn out", one, other)
    near("drawn out", one.capacity, other.capacity, within, 1e-2)


@relation("rocking", st.tuples(decks(*ROCKING), pulses(0.1, 1.2)), 1e-4)
def a_finer_integrator(deck: Deck, motion: Deck, within: float) -> None:
    """A hundredth of the tolerance changes nothing."""
    one, other = (ask(changed(deck, motion=motion), "rocking", tolerance=t) for t in (1e-8, 1e-10))
    ok(one, other)
    if one.results.decided_by_last_digits or other.results.decided_by_last_digits:
        reject()
    same("finer", one, other)
    near("peak rotation", one.results.peak_rotation_ratio, other.results.peak_rotation_ratio, within, 1e-4)


@relation(
    "dem", st.tuples(decks("block", "column"), st.sampled_from([0.001, 0.002])), 0.01, share=0.15, exception=INTERVAL
)
def half_the_time_step(deck: Deck, step: float, within: float) -> None:
    """Rigid contacts under a slow tilt, in steps half as long."""
    one, other = (ask(deck, "dem", **{**SLOW, "time_step": s}) for s in (step, 0.5 * step))
    same("half the step", one, other)
    near("half the step", one.capacity, other.capacity, within, 1.0)


@relation("tilt", st.tuples(sections(), st.integers(0, 10**6), st.sampled_from([1e-6, 3e-5])), 0.01)
def noise_below_the_tolerance(deck: Deck, seed: int, deviation: float, within: float) -> None:
    """Vertices that stray by less than the contact tolerance."""
    one, other = ask(deck, "tilt"), ask(shaken(deck, deviation, seed), "tilt")
    same("noise", one, other)
    near("noise", one.capacity, other.capacity, within, 1e-2)


def stray_solids(text: str, deviation: float, seed: int) -> str:
    """An assembly of COMPAS whose stones' vertices stray each by itself, up to the deviation [m]; supports stay."""
    data, rng = json.loads(text), np.random.default_rng(seed)
    for node in data["data"]["graph"]["data"]["node"].values():
        if not node["is_support"]:
            for vertex in node["block"]["data"]["vertex"].values():
                for axis in "xyz":
                    vertex[axis] += float(rng.uniform(-deviation, deviation))
    return json.dumps(data)


CORNER = {"structure": {"kind": "wall", "unit_length": 0.5, "unit_height": 0.25, "thickness": 0.25, "height": 1.0,
                        "legs": [{"length": 1.5}, {"length": 1.5, "turn": "left"}]}, "joints": {"friction": 0.65}}  # fmt: skip


@relation("tilt", st.tuples(decks("wall"), st.integers(0, 10**6)), 0.01, awaits="A10", examples=((CORNER, 1),))
def noise_of_solids(deck: Deck, seed: int, within: float) -> None:
    """Corners of solids that stray by 10 micrometres."""
    text = extrados.export({**deck, "analysis": [{"kind": "tilt", "direction": 90.0}]}, "compas")
    found = []
    for deviation in (0.0, 1e-5):
        with tempfile.TemporaryDirectory() as name:
            (Path(name) / "stones.json").write_text(stray_solids(text, deviation, seed))
            structure = {"kind": "blocks", "file": "stones.json", "unit": "m"}
            found.append(ask({**deck, "structure": structure}, "tilt", Path(name), direction=90.0, rose=4))
    same("noise", *found)
    near("noise", found[0].capacity, found[1].capacity, within, 1e-2)


# ----- agreement


#: Strategies that say whether a building stands by its weight or under a motion, by what they are called
STANDING: dict[str, dict[str, Any]] = {
    "rigid contacts": {"kind": "dem", "end_time": 1.0, **RIGID}, "springs": {"kind": "dem", "end_time": 1.0, "joints": {"normal_stiffness": 1e9}},
    "rocking": {"kind": "rocking"}, "assessment": {"kind": "assessment", "impulses": 1}, "fragility": {"kind": "fragility", "count": 4, "bootstrap": 0},
    "codes": {"kind": "local-mechanism", "mechanism": "building", "motion_spectrum": True},
    "failure domain": {"kind": "failure-domain", "durations": [0.5], "amplitudes": 2, "accuracy": 0.05},
    "stones with joints": {"kind": "sla", "events": 30},
}  # fmt: skip
WEAK = {"kind": "sine-pulse", "amplitude": "0.02 g", "period": 0.3}
WEAK_SET = {"kind": "generated", "mmi": 4, "duration": 1.0, "lines": 5}


@st.composite
def certificates(draw: st.DrawFn) -> Deck:
    """Buildings that cannot stand by the proof of limit analysis: thin arches, and arches whose stones slide apart."""
    if draw(st.booleans()):
        return {"structure": draw(arches(thin=True)), "joints": {"friction": 0.7}}
    structure = {
        "kind": "arch",
        "radius": draw(number(2.0, 10.0)),
        "embrace": 180.0,
        "voussoirs": draw(st.integers(7, 15)),
    }
    structure["thickness"] = round(structure["radius"] * draw(number(0.12, 0.2)), 4)
    return {"structure": structure, "joints": {"friction": draw(number(0.05, 0.15, 10))}}


THIN = {
    "structure": {"kind": "arch", "radius": 10.0, "thickness": 0.5, "embrace": 180.0, "voussoirs": 20},
    "joints": {"friction": 0.7},
}
SLIPPERY = {
    "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7},
    "joints": {"friction": 0.2},
}


@relation(
    "tilt dem rocking assessment fragility local-mechanism failure-domain sla",
    certificates(),
    0.0,
    awaits="A4",
    examples=(THIN, SLIPPERY),
)
def certificates_of_collapse(deck: Deck, within: float) -> None:
    """What cannot stand by limit analysis stands by no strategy, and is called so by all that could know."""
    if ask(deck, "tilt").outcome != "cannot-stand":
        reject()
    for name, table in STANDING.items():
        motion = WEAK_SET if name == "fragility" else WEAK
        answer = ask(changed(deck, motion=motion), **table)
        must(
            answer.outcome not in ("stands", "open"),
            f"{name} says {answer.outcome}: {answer.verdict and answer.verdict.statement}",
        )
        must(
            answer.outcome in ("cannot-stand", "collapses", "not-applicable") or answer.status == "refused",
            f"{name} says {answer.outcome}",
        )


@relation("tilt", certificates(), 0.0, examples=(THIN, SLIPPERY))
def a_certificate_is_a_verdict(deck: Deck, within: float) -> None:
    """A proven collapse under the own weight is a result with a verdict, of safety factor 0, and no refusal."""
    answer = ask(deck, "tilt")
    if answer.outcome != "cannot-stand":
        reject()
    must(
        answer.status == "ok" and answer.verdict is not None and answer.verdict.ratio == 0.0,
        f"{answer.status}: {answer.said}",
    )


@relation(
    "tilt dem",
    st.tuples(decks("block", "column", "stack", "blocks", friction=number(0.3, 0.9, 12))).map(lambda t: t[0]),
    0.03,
    share=0.15,
)
def a_slow_tilt(deck: Deck, within: float) -> None:
    """Rigid contacts tilted slowly fall between the least state without dilatancy and the associated limit."""
    most, least = ask(deck, "tilt"), ask(deck, "tilt", friction_rule="non-associated", starts=3)
    found = ask(deck, "dem", **{**SLOW, "tilt_accuracy": 0.01})
    ok(most, found)
    at_most("rigid contacts", found.capacity, most.capacity, within, 0.3)
    if least.answers:
        at_most("rigid contacts", least.capacity, found.capacity, within, 0.3)


RECTANGLES = st.tuples(number(0.2, 2.0), number(1.5, 8.0)).map(lambda t: (t[0], float(f"{t[0] * t[1]:.5g}")))


@relation("tilt thrust dem rocking failure-domain local-mechanism fragility code-checks sla", RECTANGLES, 2e-3)
def one_block_by_every_strategy(width: float, height: float, within: float) -> None:
    """A block on ground that does not slip begins to rock at b/h g."""
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": 1.0}}
    want = width / height
    near("limit analysis", ask(deck, "tilt").capacity, [want, want], 1e-6)
    near("in space", ask(deck, "tilt", direction=30.0, rose=4).numbers.get("collapse_acceleration_g", want), want, 10.0)
    for name, keys in (
        ("rigid contacts", SLOW),
        ("springs", {"test": "tilt", "joints": {"normal_stiffness": 1e10}, "tilt_accuracy": 0.002}),
    ):
        near(name, ask(deck, "dem", **keys).capacity, [want, want], 0.01, 0.3)
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": "0.4 g", "period": 0.5})
    near("rocking", ask(moving, "rocking").results.uplift_acceleration_g, want, within)
    near(
        "failure domain",
        ask(deck, "failure-domain", durations=[0.5], amplitudes=2, accuracy=0.05).results.uplift_acceleration_g,
        want,
        within,
    )
    near(
        "fragility",
        ask(changed(deck, motion=WEAK_SET), "fragility", count=2, bootstrap=0).results.uplift_acceleration_g,
        want,
        within,
    )
    codes = ask(deck, "local-mechanism", mechanism="building").results
    near("codes", codes.multiplier, want, within)
    near("M* of one block", codes.participating_part, 1.0, within)
    mass = 2000.0 * width * height
    near("M*", codes.participating_mass_kg, mass, within)
    near("weight", ask(deck, "tilt").results.weight_N, mass * GRAVITY, within)
    near("Housner", ask(moving, "rocking").results.restitution, 1.0 - 1.5 * width**2 / (width**2 + height**2), within)
    near(
        "p",
        ask(moving, "rocking").results.frequency_parameter_rad_s,
        math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(width, height))),
        within,
    )


SLIDERS = st.tuples(number(0.5, 2.0), number(0.3, 0.9), number(0.1, 0.5)).map(
    lambda t: {"structure": {"kind": "block", "width": t[0], "height": float(f"{t[0] * t[1]:.4g}")}, "joints": {"friction": round(t[2], 4)}}
)  # fmt: skip
SLIDES = {"structure": {"kind": "block", "width": 0.5, "height": 0.3}, "joints": {"friction": 0.2}}


@relation("tilt dem", SLIDERS, 2e-3, awaits="A6", examples=(SLIDES,))
def a_block_that_slides(deck: Deck, within: float) -> None:
    """Friction below b/h: it slides at the friction coefficient, which is no collapse."""
    mu = deck["joints"]["friction"]
    for rule in ("associated", "non-associated"):
        near(rule, ask(deck, "tilt", friction_rule=rule).capacity, [mu, mu], within)
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{2.5 * mu:g} g", "period": 1.0})
    run_ = ask(moving, "dem", end_time=3.0, **RIGID)
    ok(run_)
    must(run_.results.outcome == "slid", f"rigid contacts call it {run_.results.outcome}: {run_.outcome}")


def slid(mu: float, amplitude: float, period: float, step: float = 1e-4) -> float:
    """Greatest slip of a rigid block under one cycle of a sine (Newmark 1965), accelerations in g [m]."""
    place = speed = most = 0.0
    for k in range(round((period + 20.0 * amplitude) / step)):
        ground = GRAVITY * amplitude * math.sin(2.0 * math.pi * k * step / period) if k * step < period else 0.0
        if speed == 0.0 and abs(ground) <= mu * GRAVITY:
            if k * step >= period:
                break
            continue
        rate = -ground - math.copysign(mu * GRAVITY, speed if speed else -ground)
        new = speed + step * rate
        if speed * new < 0.0:
            new = 0.0
        speed, place = new, place + step * new
        most = max(most, abs(place))
    return most


@relation("dem", st.tuples(SLIDERS, number(1.2, 2.0), number(0.2, 0.5)), 0.02, share=0.5)
def newmark(deck: Deck, ratio: float, period: float, within: float) -> None:
    """Rigid contacts slide as far as Newmark's block, as long as that is far from the size of the block."""
    mu = deck["joints"]["friction"]
    amplitude = float(f"{ratio * mu:.4g}")
    want = slid(mu, amplitude, period)
    if want > 0.15 * deck["structure"]["height"]:
        reject()
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude:g} g", "period": period})
    found = ask(moving, "dem", end_time=period + 1.0, time_step=5e-4, **RIGID)
    ok(found)
    near("slip", found.results.peak_slip_m, want, within, 1e-3 / within)


@relation("rocking", SLIDERS, 0.0, awaits="A4", examples=(SLIDES,))
def rocking_of_a_block_that_slides(deck: Deck, within: float) -> None:
    """What slides before it rocks does not rock: no plain verdict by rocking."""
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": "1.5 g", "period": 0.6})
    answer = ask(moving, "rocking")
    must(
        answer.outcome not in ("stands", "collapses"),
        f"rocking says {answer.outcome}: {answer.verdict and answer.verdict.statement}",
    )


DROPPED = (
    "fragility",
    "failure-domain",
    "failure-curves",
    "rocking-spectrum",
    "harmonic-map",
    "resonance",
    "assessment",
)
TALL = {"structure": {"kind": "block", "width": 1.0, "height": 2.0}, "joints": {"friction": 0.3}}


@relation(
    " ".join(DROPPED),
    st.tuples(RECTANGLES, st.sampled_from(DROPPED)),
    0.0,
    awaits="A4",
    examples=tuple(((1.0, 2.0), k) for k in DROPPED[:2]),
)
def friction_is_not_dropped(size: tuple, kind: str, within: float) -> None:
    """Where friction is less than rocking needs, every strategy that rests on rocking says so."""
    width, height = size
    friction = round(0.6 * width / height, 4)
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": friction}}
    keys: dict[str, dict] = {
        "fragility": {"count": 4, "bootstrap": 0}, "failure-domain": {"durations": [0.5], "amplitudes": 2, "accuracy": 0.05},
        "failure-curves": {"durations": [0.4, 0.8], "accuracy": 0.05}, "rocking-spectrum": {"periods": [2.0, 4.0]},
        "harmonic-map": {"amplitudes": 3, "frequencies": [0.5, 1.0]}, "resonance": {}, "assessment": {"impulses": 1},
    }  # fmt: skip
    if kind != "resonance":
        deck["motion"] = (
            WEAK_SET | {"mmi": 8} if kind == "fragility" else {"kind": "sine-pulse", "amplitude": "1 g", "period": 0.6}
        )
    if kind in ("failure-domain", "harmonic-map"):
        del deck["motion"]
    if kind == "assessment":
        deck["structure"] = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
        deck["joints"] = {"friction": 0.3}
    answer = ask(deck, kind, **keys[kind])
    said = " ".join(
        [answer.said, *(answer.verdict.violated if answer.verdict is not None else []), *answer.result.warnings]
    )
    must("friction" in said.replace("joints.friction", ""), f"{kind} says nothing of a friction of {friction}")


@relation("rocking dem", st.tuples(decks("block", "column", "stack"), pulses(0.1, 0.8)), 1e-3)
def energies(deck: Deck, motion: Deck, within: float) -> None:
    """No energy is won: what friction, dampers and impacts take is never negative, and the ledger closes."""
    moving = changed(deck, motion=motion)
    for told, keys in (("rigid contacts", RIGID), ("springs", {"joints": {"normal_stiffness": 1e8}})):
        r = ask(moving, "dem", end_time=1.0, **keys)
        if r.answers:
            scale = max(r.results.peak_kinetic_energy_J, 1.0)
            at_most(f"{told}: friction", 0.0, r.results.friction_loss_J, within, scale)
            at_most(f"{told}: damping", 0.0, r.results.damping_loss_J, within, scale)
            at_most(f"{told}: residual", r.results.energy_residual_ratio, 0.02, 0.0)
    if (r := ask(moving, "rocking")).answers:
        at_most("impacts", 0.0, r.results.energy_lost_at_impacts_J, within, abs(r.results.energy_supplied_J) + 1e-6)
        at_most("rocking: residual", r.results.energy_residual_ratio, 1e-4, 0.0)


@relation("sla pushover", decks("panel", "building", material=MASONRY), 1e-6)
def dissipation(deck: Deck, within: float) -> None:
    """Saw-tooth laws dissipate: energies are not negative, residuals small, displacements within a tenth of the size."""
    if deck["structure"]["kind"] == "building":
        answer = ask(deck, "pushover", **PUSH)
        size = sum(deck["structure"]["storeys"])
    else:
        answer = ask(deck, "sla", mesh={"size": 0.4}, events=60)
        size = deck["structure"]["height"]
    ok(answer)
    r = answer.results
    at_most("crack energy", 0.0, r.crack_energy_J, 0.0)
    if r.dissipated_energy_J is not None:
        at_most("dissipated energy", 0.0, r.dissipated_energy_J, within, abs(r.external_work_J or 0.0) + 1e-9)
    if r.peak_displacement_m is not None:
        at_most("displacement at the peak", abs(r.peak_displacement_m), 0.1 * size, 0.0)


@relation("sla tilt", arches().map(lambda s: {"structure": s}), 0.02, awaits="A3", share=0.3, examples=(
    {"structure": {"kind": "arch", "radius": 10.0, "thickness": 1.07, "embrace": 180.0, "voussoirs": 40}},
    {"structure": {"kind": "arch", "radius": 10.0, "thickness": 1.05, "embrace": 180.0, "voussoirs": 40}},
))  # fmt: skip
def dry_stones_by_elements(deck: Deck, within: float) -> None:
    """Stones with dry joints bear no more by elements than by limit analysis."""
    most = ask(deck, "tilt").capacity[0]
    answer = ask(changed(deck, motion=WEAK), "sla", events=300, directions=["+"])
    if not answer.answers or answer.results.peak_acceleration_g is None:
        must(not (most == 0.0 and answer.outcome == "stands"), "it cannot stand, and stands by elements")
        return
    at_most("elements", answer.results.peak_acceleration_g, most, within, 0.1)


@relation("rocking dem", st.tuples(RECTANGLES, number(0.3, 0.8), number(0.3, 0.8)), 0.03, share=0.5)
def rocking_by_two_strategies(size: tuple, ratio: float, period: float, within: float) -> None:
    """A block under one sine by its equation of motion and by rigid contacts."""
    width, height = size
    amplitude = (1.5 + ratio) * width / height
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": "no-sliding"},
            "motion": {"kind": "sine-pulse", "amplitude": f"{amplitude:.4g} g", "period": period}}  # fmt: skip
    one = ask(deck, "rocking")
    ok(one)
    if one.results.decided_by_last_digits or not 1e-3 < abs(one.results.peak_rotation_ratio) < 0.7:
        reject()
    other = ask(deck, "dem", end_time=2.0 * period, time_step=2e-4, **RIGID)
    ok(other)
    peak = max(abs(v) for v in other.results.peak_rotation_rad.values())
    near("peak rotation", abs(one.results.peak_rotation_rad), peak, within, 0.05 * one.results.critical_rotation_rad)


@relation("failure-domain rocking", st.tuples(decks("block", "arch"), number(0.3, 1.2)), 0.0)
def domains_and_single_runs(deck: Deck, period: float, within: float) -> None:
    """Just above the curve of a failure domain a pulse brings it down; well below none does."""
    keys = {"pulse": "sine", "durations": [period], "amplitudes": 10, "accuracy": 1e-3}
    domain = ask(deck, "failure-domain", **keys)
    ok(domain)
    if (least := domain.results.mode_I.amplitudes_g[0]) is None:
        reject()
    for amplitude, falls in ((least + 1e-3, True), (0.9 * least - 1e-3, False)):
        run_ = ask(
            changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude!r} g", "period": period}), "rocking"
        )
        ok(run_)
        if not run_.results.decided_by_last_digits:
            must((run_.results.outcome == "collapse") == falls, f"{amplitude} g of {least} g: {run_.results.outcome}")


@relation("fragility rocking", st.tuples(decks("block", "arch"), EARTHQUAKES), 0.0)
def ensembles_and_single_runs(deck: Deck, motion: Deck, within: float) -> None:
    """A fragility counts what single runs of its motions do."""
    count = 5
    whole = ask(changed(deck, motion=motion), "fragility", count=count, bootstrap=0)
    ok(whole)
    runs = [ask(changed(deck, motion={**motion, "member": k}), "rocking") for k in range(1, count + 1)]
    ok(*runs)
    if any(r.results.decided_by_last_digits for r in runs):
        reject()
    collapsed = sum(r.results.outcome == "collapse" for r in runs)
    uplifted = sum(r.results.outcome != "no-hinging" for r in runs)
    must((whole.results.collapsed, whole.results.uplifted) == (collapsed, uplifted),
         f"{whole.results.collapsed} collapse and {whole.results.uplifted} rock, run one by one {collapsed} and {uplifted}")  # fmt: skip


@relation("rocking dem", st.tuples(decks("vault"), number(2.0, 4.0), number(0.7, 1.5)), 0.0, awaits="A5", share=0.05, examples=(
    ({"structure": {"kind": "vault", "preset": "dejong-a"}, "joints": {"friction": 0.7}}, 3.0, 1.1),
))  # fmt: skip
def hinges_elsewhere(deck: Deck, ratio: float, period: float, within: float) -> None:
    """A vault on buttresses that recovers by its one mechanism recovers by rigid contacts."""
    base = ask(deck, "tilt")
    ok(base)
    amplitude = ratio * base.capacity[0]
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude:.4g} g", "period": period})
    one = ask(moving, "rocking")
    ok(one)
    if one.outcome != "stands":
        reject()
    other = ask(moving, "dem", end_time=period + 4.0, **RIGID)
    must(other.outcome != "collapses", f"rocking: {one.verdict.statement}; rigid contacts: {other.verdict.statement}")


@relation("rocking", st.tuples(number(0.5, 1.5), number(4.0, 6.0), number(0.8, 1.3), number(1.5, 2.5)), 0.0, awaits="A7", examples=(
    (1.15, 4.62, 1.165, 1.725),
))  # fmt: skip
def chaos_is_told(width: float, slenderness: float, amplitude: float, frequency: float, within: float) -> None:
    """Where amplitudes 1e-5 g apart end otherwise, every such run says that last digits decide."""
    deck = {"structure": {"kind": "block", "width": width, "height": width * slenderness}, "joints": {"friction": 0.9}}
    runs = [
        ask(
            changed(
                deck,
                motion={
                    "kind": "harmonic",
                    "amplitude": f"{amplitude + k * 1e-5!r} g",
                    "frequency": frequency,
                    "duration": 10.0,
                },
            ),
            "rocking",
        )
        for k in range(8)
    ]
    ok(*runs)
    if len({r.results.outcome for r in runs}) > 1:
        silent = sum(not r.results.decided_by_last_digits for r in runs)
        must(silent == 0, f"{silent} of {len(runs)} say nothing of it: {[r.results.outcome for r in runs]}")


@relation("dem", st.tuples(decks("block", "column"), st.sampled_from([0.0, 0.01])), 0.0)
def little_damping(deck: Deck, ratio: float, within: float) -> None:
    """A wall that stands is looked at with springs that are not damped too."""
    moving = changed(deck, motion=WEAK, joints={"normal_stiffness": 1e9, "damping_ratio": ratio})
    answer = ask(moving, "dem", end_time=0.5)
    must(answer.status == "ok", f"{answer.status}: {answer.said}")


MORTAR = {"cohesion": 1e3, "shear_energy": 10.0, "tension": 1e3, "fracture_energy": 5.0}
SOLE = {"structure": {"kind": "building", "storeys": [3.0], "beds": [{"name": "sole", "storey": 1, "z": 0.0}], "walls": [
    {"name": name, "start": start, "end": end, "thickness": 0.4} for name, start, end in (
        ("south", [0.0, 0.0], [4.0, 0.0]), ("east", [4.0, 0.0], [4.0, 4.0]), ("north", [4.0, 4.0], [0.0, 4.0]), ("west", [0.0, 4.0], [0.0, 0.0]))]},
    "joints": {"friction": 0.4, **MORTAR}, "material": CRACKS}  # fmt: skip


@relation("pushover", decks("building", friction=number(0.2, 0.6), material=MASONRY).map(
    lambda d: changed(d, structure={"beds": [{"name": "sole"}]}, joints=MORTAR)
), 0.02, awaits="A8", share=0.2, examples=(SOLE,))  # fmt: skip
def no_more_than_coulomb(deck: Deck, within: float) -> None:
    """On a weak sole the base shear stays below friction times the weight and cohesion times the area, or says that it does not."""
    answer = ask(deck, "pushover", direction=0.0, mesh={"size": 1.0, "layers": 3}, events=20000)
    ok(answer)
    r = answer.results
    area = sum(math.dist(w["start"], w["end"]) * w["thickness"] for w in deck["structure"]["walls"])
    most = deck["joints"]["friction"] * r.weight_N + deck["joints"]["cohesion"] * area
    if r.greatest_load_N is not None and r.greatest_load_N > (1.0 + within) * most:
        must(
            answer.outcome not in ("stands", "not-applicable") and "friction" in answer.warnings,
            f"{r.greatest_load_N:.4g} N of at most {most:.4g} N, said: {answer.warnings}",
        )


@relation("pushover", decks("building", material=MASONRY).map(lambda d: changed(d, motion=WEAK)), 0.0, awaits="A15", examples=(
    changed({k: v for k, v in SOLE.items() if k != "joints"}, motion=WEAK, structure={"beds": []}),
))  # fmt: skip
def a_push_is_no_verdict_on_a_peak(deck: Deck, within: float) -> None:
    """A base shear over the weight is not compared with the peak of a motion."""
    answer = ask(deck, "pushover", **PUSH)
    ok(answer)
    must(
        answer.outcome not in ("stands", "collapses") and answer.verdict.ratio is None,
        f"{answer.outcome}: {answer.verdict.statement}",
    )


@relation("dem", st.tuples(number(0.6, 1.2), number(2.0, 4.0), number(0.02, 0.06), number(0.02, 0.06)), 0.01, awaits="A18", share=0.3, examples=(
    (1.0, 3.0, 0.04, 0.044),
))  # fmt: skip
def bevelled_corners(width: float, slenderness: float, dx: float, dy: float, within: float) -> None:
    """Elements take stones as drawn: a block with both lower corners cut off rocks on its narrower foot."""
    height = width * slenderness / 1.5
    dx, dy = dx * width, dy * width
    points = [[dx, 0.0], [width - dx, 0.0], [width, dy], [width, height], [0.0, height], [0.0, dy]]
    deck = {"structure": {"kind": "blocks", "block": [{"name": "a", "points": points}]}, "joints": {"friction": 2.0}}
    area = width * height - dx * dy
    level = (0.5 * width * height**2 - dx * dy * dy / 3.0) / area
    want = (0.5 * width - dx) / level
    near("limit analysis", ask(deck, "tilt").capacity, [want, want], 1e-6)
    near("rigid contacts", ask(deck, "dem", **SLOW).capacity, [want, want], within, 0.3)


@relation("failure-domain rocking", st.tuples(number(1.0, 8.0), number(0.1, 0.12), number(170.0, 180.0)), 0.0, awaits="A16", share=0.3, examples=(
    (1.0, 0.1, 175.0),
))  # fmt: skip
def the_impact_rule_is_told(radius: float, share: float, embrace: float, within: float) -> None:
    """A failure domain of a thin arch says as much of the impact rule as rocking does."""
    arch = {
        "kind": "arch",
        "radius": radius,
        "thickness": round(share * radius, 4),
        "embrace": embrace,
        "voussoirs": 36,
    }
    deck = {"structure": arch, "motion": {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 0.4}}
    one = ask(deck, "rocking")
    other = ask({"structure": arch}, "failure-domain", durations=[0.4], amplitudes=2, accuracy=0.05)
    ok(one, other)
    if "impact" not in one.warnings:
        reject()
    must("impact" in other.warnings, f"rocking: {one.warnings}; the failure domain: {other.warnings or 'nothing'}")


@relation(
    "local-mechanism",
    st.tuples(number(0.2, 0.6), number(1.0, 10.0), st.sampled_from(["parapet", "wall"])),
    0.0,
    awaits="A13",
    examples=((0.3, 2.0, "parapet"),),
)
def clauses_within_their_scope(thickness: float, height: float, mechanism: str, within: float) -> None:
    """Table 11-5 of ASCE 41, for walls between anchored diaphragms, decides nothing on a cantilever."""
    keys = {"mechanism": mechanism, "thickness": thickness, "height": height, "one_second_acceleration": "0.2 g"}
    answer = ask({}, "local-mechanism", **keys)
    ok(answer)
    for name, check in answer.results.checks.items():
        if check.code == "ASCE 41":
            must(
                check.demand is None or not check.verdict,
                f"{name}: {check.demand} against {check.capacity}: {check.verdict}",
            )


@relation(
    "rocking fragility motion",
    st.tuples(number(0.01, 0.05), st.sampled_from(["rocking", "dem"])),
    0.0,
    awaits="A14",
    examples=((0.02, "rocking"),),
)
def offsets_of_records_are_told(offset: float, kind: str, within: float) -> None:
    """A record whose velocity runs away is warned of by all that take it."""
    time = np.arange(0.0, 30.0, 0.01)
    wave = 0.15 * np.sin(2.0 * np.pi * 2.0 * time) * np.exp(-0.2 * time) + offset
    with tempfile.TemporaryDirectory() as name:
        deck = {"structure": {"kind": "block", "width": 0.6, "height": 1.2}, "motion": recorded(Path(name), 0.01, wave)}
        told = ask(deck, "motion", Path(name)).warnings
        must("drift" in told, f"motion says nothing of it: {told}")
        said = ask(deck, kind, Path(name), **({} if kind == "rocking" else {"end_time": 1.0, **RIGID})).warnings
    must("drift" in said, f"{kind} says nothing of it: {said}")


@relation("tilt", decks("brickwork", "blocks", friction=number(0.2, 0.5)), 0.0, awaits="A12", share=0.5, examples=(
    {"structure": {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 4, "courses": 5}, "joints": {"friction": 0.3}},
))  # fmt: skip
def dilatant_capacities_are_called_so(deck: Deck, within: float) -> None:
    """Where the mechanism of an associated limit slides, its verdict is an upper bound."""
    answer = ask(changed(deck, motion=WEAK), "tilt")
    ok(answer)
    if not answer.results.sliding_joints:
        reject()
    must(answer.verdict.bound == "upper", f"bound {answer.verdict.bound}: {answer.verdict.statement}")


#: Analyses of a stone building with a motion, quick
PLAIN: dict[str, dict[str, Any]] = {
    "tilt": {}, "thrust": {}, "rocking": {}, "dem": {"end_time": 0.3, **RIGID}, "local-mechanism": {"mechanism": "building"},
    "failure-domain": {"durations": [0.5], "amplitudes": 2, "accuracy": 0.05}, "assessment": {"impulses": 1}, "sla": {"events": 30},
    "moving-load": {"count": 5}, "supports": {},
}  # fmt: skip


@relation(
    " ".join(PLAIN),
    st.tuples(
        decks("arch", "block", "column", "brickwork", "pointed-arch", "frame"), pulses(), st.sampled_from(sorted(PLAIN))
    ),
    1e-9,
)
def verdicts_are_whole(deck: Deck, motion: Deck, kind: str, within: float) -> None:
    """A verdict follows from its demand and capacity, names its unit, and never stands beside a violated assumption."""
    answer = ask(changed(deck, motion=motion), kind, **PLAIN[kind])
    ok(answer)
    v = answer.verdict
    must(
        bool(v.statement.strip()) and v.statement.strip()[-1] in ".!",
        f"{kind}: a statement without an end: {v.statement!r}",
    )
    must(not (v.violated and answer.outcome == "stands"), f"{kind} stands though {v.violated}")
    must(not (v.bound == "upper" and answer.outcome == "stands"), f"{kind} stands by an upper bound")
    if v.demand is not None and v.capacity is not None:
        if v.ratio is not None and answer.outcome != "cannot-stand":
            near(f"{kind}: ratio", v.ratio, v.capacity / v.demand, within)
        if answer.outcome in ("stands", "collapses") and v.ratio is not None:
            must(
                (v.ratio > 1.0) == (answer.outcome == "stands"),
                f"{kind}: {answer.outcome} at a ratio of {v.ratio}: {v.statement}",
            )
        must(not v.unit or v.unit in v.statement, f"{kind}: no '{v.unit}' in {v.statement!r}")


@relation(
    "tilt sla rocking dem local-mechanism",
    st.tuples(STONES, pulses(), st.sampled_from(sorted(PLAIN))),
    0.0,
    exception=GIVES_UP,
)
def nobody_dies(deck: Deck, motion: Deck, kind: str, within: float) -> None:
    """Every strategy answers, or refuses in words: internal errors are faults of the program (`ask` sees to it)."""
    keys = dict(PLAIN[kind])
    if deck["structure"]["kind"] in SOLIDS and kind in ("tilt", "dem"):
        keys["direction"] = 0.0
    try:
        answer = ask(changed(deck, motion=motion), kind, **keys)
    except extrados.DeckError:
        reject()  # a kind of structure that the analysis never takes
    must(answer.status == "ok" or bool(answer.said.strip()), f"{kind}: {answer.status} without a word")
    must(answer.status != "failed" or UNSETTLED in answer.said, f"{kind}: {answer.said}")


@relation("assess", st.tuples(decks("block", "stack", "arch", "column"), pulses(0.05, 0.6)), 0.0, share=0.1)
def an_assessment_is_whole(deck: Deck, motion: Deck, within: float) -> None:
    """Each strategy has a row, and one that refuses ends nothing."""
    answer = ask(
        changed(deck, motion=motion), "assess", budget=5.0, strategies=["tilt", "rocking", "code-checks", "assessment"]
    )
    must(answer.status == "ok", f"{answer.status}: {answer.said}")
    rows = {row.strategy: row for row in answer.results.verdicts}
    must(set(rows) >= {"tilt", "rocking"}, f"rows of {sorted(rows)}")
    for name in ("tilt", "rocking"):
        alone = ask(changed(deck, motion=motion), name)
        if rows[name].status == "ok":
            must(
                rows[name].outcome == alone.verdict.outcome,
                f"{name}: {rows[name].outcome} in the table, {alone.verdict.outcome} alone",
            )


@relation("sla", decks("mesh", material=MASONRY), 1e-6)
def a_mesh_of_another_scale(deck: Deck, within: float) -> None:
    """Stiffness of a plane wall has no scale: twice as large under twice the stress per thickness is as stiff."""
    found = []
    for factor in (1.0, 2.0):
        with tempfile.TemporaryDirectory() as name:
            (Path(name) / "wall.inp").write_text(MESH)
            made = changed(deck, structure={"scale": deck["structure"]["scale"] * factor})
            found.append(ask(made, "sla", Path(name), events=5))
    same("scaled", *found)
    ok(*found)
    near("stiffness", found[0].results.initial_stiffness_N_m, found[1].results.initial_stiffness_N_m, within)


@relation("local-mechanism tilt", decks("block", "column", "brickwork", "arch", "pointed-arch", "frame"), 1e-4)
def codes_take_the_least_multiplier(deck: Deck, within: float) -> None:
    """alpha_0 of the whole section is its collapse acceleration, to the weaker side; a_0* and M* follow from it and e*."""
    codes = ask(deck, "local-mechanism", mechanism="building", confidence_factor=1.0)
    limit = ask(deck, "tilt")
    ok(codes, limit)
    r = codes.results
    near("alpha_0", r.multiplier, limit.capacity.min(), within)
    near("a_0*", r.activation_acceleration_g * r.participating_part, r.multiplier, within)
    near("M*", r.participating_mass_kg * GRAVITY, r.participating_part * r.swaying_weight_N, within)
    if r.zero_displacement_m is not None:
        near("d_SLV", r.ultimate_displacement_m, 0.4 * r.zero_displacement_m, within)
        near("d_SLC", r.collapse_displacement_m, 0.6 * r.zero_displacement_m, within)


@relation("failure-curves failure-domain", st.tuples(decks("block", "arch"), number(0.3, 1.0)), 5e-3)
def curves_and_domains(deck: Deck, period: float, within: float) -> None:
    """A failure curve is the lower edge of the failure domain."""
    durations = [period, 1.5 * period]
    domain = ask(deck, "failure-domain", pulse="sine", durations=durations, amplitudes=10, accuracy=1e-3)
    curves = ask(deck, "failure-curves", pulse="sine", durations=durations, amplitudes=10, accuracy=1e-3)
    ok(domain, curves)
    pairs = zip(domain.results.mode_I.amplitudes_g, curves.results.curves[0].amplitudes_g, strict=True)
    for one, other in pairs:
        must((one is None) == (other is None), f"{one} g of the domain, {other} g of the curve")
        if one is not None:
            near("amplitude", one, other, within, 0.3)
    near("uplift", domain.results.uplift_acceleration_g, curves.results.curves[0].uplift_acceleration_g, 1e-9)


@relation("harmonic-map rocking", st.tuples(decks("block"), number(0.5, 2.0)), 0.0)
def maps_and_single_runs(deck: Deck, frequency: float, within: float) -> None:
    """What a map says of a frequency is what single runs at its amplitudes do."""
    keys = {"frequencies": [frequency], "amplitudes": 6, "cycles": 2}
    found = ask(deck, "harmonic-map", **keys)
    ok(found)
    if (least := found.results.lowest_overturning_amplitude_g[0]) is None:
        reject()
    motion = {"kind": "harmonic", "amplitude": f"{least!r} g", "frequency": frequency, "duration": 2.0 / frequency}
    one = ask(changed(deck, motion=motion), "rocking")
    ok(one)
    must(
        one.results.outcome == "collapse" or one.results.decided_by_last_digits, f"at {least} g: {one.results.outcome}"
    )


@relation("rocking", st.tuples(RECTANGLES, number(0.1, 0.9)), 1e-5)
def free_rocking(size: tuple, ratio: float, within: float) -> None:
    """A slender block let go falls back in acosh(1/(1 - r))/p, and loses 1 - c^2 of its energy (Housner 1963)."""
    width, height = size
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": 2.0},
            "initial": {"rotation_ratio": ratio}, "motion": {"kind": "constant", "amplitude": "0 g"}}  # fmt: skip
    answer = ask(deck, "rocking", form="linear")
    ok(answer)
    r = answer.results
    near("first impact", r.impact_times_s[0], math.acosh(1.0 / (1.0 - ratio)) / r.frequency_parameter_rad_s, within)
    near("peak", abs(r.peak_rotation_ratio), ratio, within)
    gaps = np.diff(r.impact_times_s[:2])
    after = math.sqrt(1.0 - r.restitution**2 * (1.0 - (1.0 - ratio) ** 2))
    near("half cycle", gaps[0], 2.0 * math.acosh(1.0 / after) / r.frequency_parameter_rad_s, within)


@relation("rocking", st.tuples(RECTANGLES, st.sampled_from(["winkler", "two-spring"])), 0.02)
def a_stiff_base(size: tuple, foundation: str, within: float) -> None:
    """A very stiff base is a rigid one; a softer one bears less."""
    width, height = size
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": 2.0},
            "motion": {"kind": "sine-pulse", "amplitude": "0.05 g", "period": 0.5}}  # fmt: skip
    capacity = []
    for stiffness in (1e9, 1e13):
        answer = ask(
            changed(deck, supports={"stiffness": stiffness, "foundation": foundation}), "rocking", end_time=0.02
        )
        ok(answer)
        capacity.append(answer.results.soft_base.capacity_g)
    near("stiff", capacity[1], width / height, within)
    at_most("soft", capacity[0], capacity[1], 1e-6)


@relation("dem", st.tuples(decks("block", "column"), pulses(0.1, 0.5)), 0.05, share=0.3)
def elements_in_space_and_in_the_plane(deck: Deck, motion: Deck, within: float) -> None:
    """A body that moves in a plane does so in space too."""
    keys = {"end_time": 0.5, "time_step": 0.001, **RIGID}
    moving = changed(deck, motion=motion, joints={"friction": 0.9})
    plane, space = ask(moving, "dem", **keys), ask(moving, "dem", direction=0.0, **keys)
    ok(plane, space)
    near("peak displacement", plane.results.peak_displacement_m, space.results.peak_displacement_m, within, 0.02)
    near("peak kinetic energy", plane.results.peak_kinetic_energy_J, space.results.peak_kinetic_energy_J, within, 2.0)


@relation("motion", st.tuples(pulses(), number(0.2, 3.0)), 1e-6)
def measures_in_proportion(motion: Deck, factor: float, within: float) -> None:
    """Twice the motion has twice the peaks and four times the Arias intensity; turned around it has the same."""
    with tempfile.TemporaryDirectory() as name:
        time = np.arange(0.0, 4.0, 0.01)
        wave = float(motion["amplitude"].split()[0]) * np.sin(2.0 * np.pi * time / motion["period"]) * np.exp(-time)
        record = recorded(Path(name), 0.01, wave)
        one, other, back = (ask({"motion": {**record, "scale": f}}, "motion", Path(name)) for f in (1.0, factor, -1.0))
    ok(one, other, back)
    for key, power in (("pga_g", 1), ("pgv_m_s", 1), ("arias_m_s", 2)):
        near(key, getattr(one.results, key) * factor**power, getattr(other.results, key), within)
        near(key, getattr(one.results, key), getattr(back.results, key), within)
    near("PGA", one.results.pga_g, np.abs(wave).max(), within)
    near("Arias", one.results.arias_m_s, np.pi / 2.0 * GRAVITY * np.trapezoid(wave**2, dx=0.01), 2e-3)


PIERS = st.tuples(number(0.8, 3.0), number(2.0, 4.0), number(0.2, 0.6), number(1e4, 3e5), number(0.5, 3.0))


@relation("code-checks", PIERS, 1e-6)
def strengths_of_piers_in_proportion(
    width: float, height: float, thickness: float, load: float, factor: float, within: float
) -> None:
    """Forces and strengths times f give capacities times f; so does the thickness with the force."""
    strengths = {"compressive_strength": 4e6, "tensile_strength": 1e5, "fracture_energy": 50.0, "density": 0.0}

    def pier(thick: float, f: float, force: float) -> Answer:
        material = {k: v * f for k, v in strengths.items()}
        return ask(
            {"structure": {"kind": "panel", "width": width, "height": height, "thickness": thick}, "material": material,
             "joints": {"cohesion": 1e5 * f, "friction": 0.4}},
            "code-checks", axial_load=force,
        )  # fmt: skip

    one, other, thick = (
        pier(thickness, 1.0, load),
        pier(thickness, factor, load * factor),
        pier(thickness * factor, 1.0, load * factor),
    )
    ok(one, other, thick)
    for name, check in one.results.checks.items():
        if check.unit == "N":
            near(name, check.capacity * factor, thick.results.checks[name].capacity, within, 1.0)
            if "ASCE" not in check.code and "psi" not in check.source:
                near(name, check.capacity * factor, other.results.checks[name].capacity, 0.05, 1.0)


@relation("supports", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), SCALES), 1e-3)
def spreading_supports_of_another_size(deck: Deck, factor: float, within: float) -> None:
    """The movement at which an arch falls is a length."""
    one, other = ask(deck, "supports", steps=50), ask(scaled(deck, factor), "supports", steps=50)
    same("scaled", one, other)
    ok(one, other)
    a, b = one.results.movement_at_fall_m, other.results.movement_at_fall_m
    must((a is None) == (b is None), f"{a} against {b}")
    if a is not None:
        near("movement", a * factor, b, within)
        near("over the span", one.results.movement_at_fall_over_span, other.results.movement_at_fall_over_span, within)


@relation("moving-load", decks("arch", "pointed-arch", "elliptical-arch"), 1e-4)
def a_load_from_either_side(deck: Deck, within: float) -> None:
    """On a symmetrical arch a load is as bad at either quarter, and worst at the place that is named."""
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


@relation("tilt", sections("block", "column", "brickwork", "blocks"), 1e-6, awaits="A11", examples=(SLIDES,))
def layers_that_are_switched_off(deck: Deck, within: float) -> None:
    """A drawing's frozen layers, layers that are off, and invisible entities are not masonry."""
    deck = drawn(deck)
    there = deck["structure"]
    found = []
    for hidden in (False, True):
        drawing = ezdxf.new()
        drawing.header["$INSUNITS"] = 6
        space = drawing.modelspace()
        for block in there["block"]:
            space.add_lwpolyline(block["points"], close=True)
        if hidden:
            drawing.layers.add("OLD").freeze()
            drawing.layers.add("OFF").off()
            top = max(p[1] for b in there["block"] for p in b["points"])
            for k, layer in enumerate(("OLD", "OFF")):
                low = top + 0.2 * k
                space.add_lwpolyline(
                    [(0.0, low), (0.2, low), (0.2, low + 0.2), (0.0, low + 0.2)],
                    close=True,
                    dxfattribs={"layer": layer},
                )
        with tempfile.TemporaryDirectory() as name:
            drawing.saveas(Path(name) / "stones.dxf")
            found.append(ask({**deck, "structure": {"kind": "blocks", "file": "stones.dxf"}}, "tilt", Path(name)))
    same("hidden", *found)
    near("weight", *(a.results.weight_N for a in found), within)


@relation("motion", st.tuples(st.integers(200, 400), number(0.1, 0.5)), 0.0, awaits="A14", examples=((300, 0.2),))
def columns_without_a_time_are_refused(count: int, amplitude: float, within: float) -> None:
    """Three columns of numbers without a time are not one series."""
    waves = amplitude * np.sin(np.arange(count)[:, None] * [0.1, 0.13, 0.17])
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "m.txt").write_text("\n".join(" ".join(f"{v:.6f}" for v in row) for row in waves) + "\n")
        answer = ask(
            {"motion": {"kind": "record", "file": "m.txt", "time_step": 0.01, "unit": "g"}}, "motion", Path(name)
        )
    must(answer.status == "refused", f"{answer.status}: read as one series")
