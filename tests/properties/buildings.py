"""Random buildings as plain decks, a strategy of hypothesis for each kind of structure, and what may be done to a deck."""

import copy
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import strategies as st

from extrados.decks.reader import make_deck

Deck = dict[str, Any]
Strategy = st.SearchStrategy[Deck]


def number(low: float, high: float, steps: int = 200) -> st.SearchStrategy[float]:
    """A number between two bounds, of few digits; it shrinks to the lower one."""
    return st.integers(0, steps).map(lambda k: float(f"{low + (high - low) * k / steps:.5g}"))


def table(kind: str, **keys: st.SearchStrategy) -> Strategy:
    """A table of a structure; a key that is drawn as None is left out."""
    made = st.fixed_dictionaries(keys)
    return made.map(lambda t: {"kind": kind, **{k: v for k, v in t.items() if v is not None}})


@st.composite
def arches(draw: st.DrawFn, thin: bool = False) -> Deck:
    """Part-circular arches that stand by their weight, or, thin, ones that do not."""
    radius, embrace = draw(number(1.0, 12.0)), draw(number(120.0, 180.0, 12))
    least = 0.02 + 0.11 * ((embrace - 90.0) / 90.0) ** 3
    share = draw(number(0.5, 0.8)) if thin else draw(number(1.3, 4.0))
    if thin:
        embrace, least = max(embrace, 150.0), 0.04 if embrace < 165.0 else 0.07
    return {
        "kind": "arch",
        "radius": radius,
        "thickness": float(f"{least * share * radius:.4g}"),
        "embrace": embrace,
        "voussoirs": draw(st.integers(10, 24)) if thin else draw(st.integers(5, 20)),
    }


@st.composite
def vaults(draw: st.DrawFn) -> Deck:
    """Barrel vaults on buttresses, near the shape of the presets."""
    return {
        "kind": "vault",
        "preset": draw(st.sampled_from(["dejong-a", "dejong-b"])),
        "buttress_width": draw(number(2.0, 4.0)),
        "voussoirs": draw(st.sampled_from([8, 12, 16])),
    }


@st.composite
def pointed(draw: st.DrawFn) -> Deck:
    """Pointed arches between a semicircle and an equilateral one."""
    span = draw(number(2.0, 12.0))
    return {
        "kind": "pointed-arch",
        "span": span,
        "radius": float(f"{span * draw(number(0.55, 0.9)):.5g}"),
        "thickness": float(f"{span * draw(number(0.1, 0.2)):.4g}"),
        "voussoirs": 2 * draw(st.integers(3, 8)),
    }


@st.composite
def elliptical(draw: st.DrawFn) -> Deck:
    """Elliptical arches, flat and thick."""
    span = draw(number(2.0, 12.0))
    return {
        "kind": "elliptical-arch",
        "span": span,
        "rise": float(f"{span * draw(number(0.25, 0.4)):.5g}"),
        "thickness": float(f"{span * draw(number(0.1, 0.2)):.4g}"),
        "voussoirs": draw(st.integers(6, 16)),
    }


@st.composite
def bridges(draw: st.DrawFn) -> Deck:
    """Bridges of one or two spans, with or without backing and fill."""
    span = draw(number(3.0, 12.0))
    one = {
        "span": span,
        "rise": float(f"{span * draw(number(0.25, 0.45)):.4g}"),
        "thickness": float(f"{span * draw(number(0.08, 0.14)):.4g}"),
        "voussoirs": draw(st.integers(6, 14)),
    }
    deck: Deck = {"kind": "bridge", "spans": [one], "depth": draw(number(1.0, 4.0, 6))}
    if draw(st.booleans()):
        deck["fill"] = {"cover": draw(number(0.1, 0.6)), "passive": 0.0}
    if draw(st.booleans()):
        deck["spans"] = [one, dict(one)]
        deck["piers"] = [{"width": float(f"{0.35 * span:.4g}"), "height": draw(number(0.5, 3.0))}]
    return deck


@st.composite
def brickwork(draw: st.DrawFn) -> Deck:
    """Walls in running bond."""
    return {
        "kind": "brickwork",
        "unit_length": draw(number(0.3, 0.8)),
        "unit_height": draw(number(0.15, 0.4)),
        "units": draw(st.integers(2, 4)),
        "courses": draw(st.integers(2, 6)),
    }


@st.composite
def coursed(draw: st.DrawFn) -> Deck:
    """Irregular coursed walls of free blocks, upright or oblique (a shear of the plane, so that all joints still close)."""
    width = draw(number(0.6, 3.0))
    heights = draw(st.lists(number(0.15, 0.8), min_size=2, max_size=5))
    shear = draw(st.sampled_from([0.0, 0.0, 0.05, -0.08]))
    blocks, level = [], 0.0
    for i, height in enumerate(heights):
        cuts = draw(st.lists(st.integers(2, 8), max_size=2, unique=True))
        xs = [0.0, *(width * k / 10.0 for k in sorted(cuts)), width]
        for k in range(len(xs) - 1):
            corners = [(xs[k], level), (xs[k + 1], level), (xs[k + 1], level + height), (xs[k], level + height)]
            blocks.append({"name": f"s{i}-{k}", "points": [[x + shear * y, y] for x, y in corners]})
        level += height
    return {"kind": "blocks", "block": blocks, "ground": [[-1.0, 0.0, width + 1.0, 0.0]]}


@st.composite
def piers(draw: st.DrawFn) -> Deck:
    """Columns of drums, straight or tapered."""
    width = draw(number(0.3, 2.0))
    return {
        "kind": "column",
        "width": width,
        "height": float(f"{width * draw(number(1.5, 7.0)):.4g}"),
        "drums": draw(st.integers(1, 5)),
        "top_width": float(f"{width * draw(st.sampled_from([1.0, 0.8, 0.6])):.4g}"),
    }


@st.composite
def panels(draw: st.DrawFn) -> Deck:
    """Panels of a given unit, with or without a window."""
    width, height = 0.6 * draw(st.integers(2, 5)), 0.4 * draw(st.integers(3, 6))
    deck = {
        "kind": "panel",
        "width": round(width, 3),
        "height": round(height, 3),
        "thickness": draw(number(0.2, 0.6)),
        "unit_length": 0.6,
        "unit_height": 0.4,
    }
    if width >= 1.8 and height >= 1.6 and draw(st.booleans()):
        deck["openings"] = [{"x": [0.6, 1.2], "y": [0.4, 1.2]}]
    return deck


@st.composite
def houses(draw: st.DrawFn) -> Deck:
    """Boxes of four walls, with floors or without, on a sole or not."""
    a, b = draw(number(2.5, 5.0, 10)), draw(number(2.5, 5.0, 10))
    storeys = draw(st.lists(number(2.5, 3.5, 10), min_size=1, max_size=2))
    corners = [[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]]
    names = ("south", "east", "north", "west")
    walls = [
        {"name": name, "start": corners[k], "end": corners[(k + 1) % 4], "thickness": draw(number(0.25, 0.6, 7))}
        for k, name in enumerate(names)
    ]
    if draw(st.booleans()):
        walls[0]["openings"] = [{"storey": 1, "x": [0.8, 1.6], "z": [0.0, 2.0]}]
    deck: Deck = {"kind": "building", "storeys": storeys, "walls": walls}
    if draw(st.booleans()):
        deck["floors"] = [{"storey": k + 1, "kind": "rigid", "load": 3000.0} for k in range(len(storeys))]
    return deck


@st.composite
def legs(draw: st.DrawFn) -> Deck:
    """Walls around a corner, or a straight one, in space."""
    unit = draw(number(0.4, 0.6, 4))
    deck: Deck = {
        "kind": "wall",
        "unit_length": unit,
        "unit_height": float(f"{0.5 * unit:.4g}"),
        "thickness": float(f"{0.5 * unit:.4g}"),
        "height": float(f"{0.5 * unit * draw(st.integers(2, 4)):.5g}"),
        "legs": [{"length": float(f"{unit * draw(st.integers(2, 3)):.5g}")}],
    }
    if draw(st.booleans()):
        deck["legs"].append({"length": float(f"{unit * draw(st.integers(2, 3)):.5g}"), "turn": draw(st.sampled_from(["left", "right"]))})
    return deck


@st.composite
def domes(draw: st.DrawFn) -> Deck:
    """Domes of few stones."""
    radius = draw(number(2.0, 10.0))
    return {
        "kind": "dome",
        "radius": radius,
        "thickness": float(f"{radius * draw(number(0.1, 0.2)):.4g}"),
        "rings": draw(st.integers(2, 4)),
        "lunes": draw(st.sampled_from([6, 8])),
        "oculus": draw(st.sampled_from([0.0, 40.0])),
    }


@st.composite
def groins(draw: st.DrawFn) -> Deck:
    """Cross-vaults of few courses."""
    radius = draw(number(2.0, 8.0))
    return {
        "kind": "cross-vault",
        "radius": radius,
        "thickness": float(f"{radius * draw(number(0.12, 0.2)):.4g}"),
        "embrace": draw(number(110.0, 160.0, 10)),
        "voussoirs": draw(st.sampled_from([4, 6])),
    }


@st.composite
def chimneys(draw: st.DrawFn) -> Deck:
    """Tapered chimneys of rings that are whole, or of blocks."""
    width = draw(number(1.0, 3.0))
    blocks = draw(st.sampled_from([1, 1, 4]))
    return {
        "kind": "chimney",
        "width": width,
        "height": float(f"{width * draw(number(3.0, 6.0)):.4g}"),
        "thickness": float(f"{width * draw(number(0.15, 0.3)):.4g}"),
        "rings": draw(st.integers(2, 4)),
        "blocks": blocks,
        "top_width": float(f"{width * draw(st.sampled_from([1.0, 0.8])):.4g}"),
        "facets": 8,
    }


#: Two elements of a wall as an Abaqus file, written beside decks of kind `mesh`
MESH = """*NODE
1, 0, 0
2, 1, 0
3, 2, 0
4, 0, 1
5, 1, 1
6, 2, 1
7, 0, 2
8, 1, 2
9, 2, 2
*ELEMENT, TYPE=CPS4
1, 1, 2, 5, 4
2, 2, 3, 6, 5
3, 4, 5, 8, 7
4, 5, 6, 9, 8
"""

#: A strategy for each kind of structure
KINDS: dict[str, Callable[[], Strategy]] = {
    "arch": arches,
    "block": lambda: table("block", width=number(0.3, 2.0), height=number(2.5, 6.0), depth=st.sampled_from([1.0, 0.5])),
    "vault": vaults,
    "aisled-vault": lambda: table(
        "aisled-vault",
        preset=st.sampled_from(["vezelay-like", "colombier-like"]),
        voussoirs=st.sampled_from([10, 14]),
        aisle_voussoirs=st.just(8),
    ),
    "pointed-arch": pointed,
    "elliptical-arch": elliptical,
    "bridge": bridges,
    "blocks": coursed,
    "panel": panels,
    "mesh": lambda: table("mesh", file=st.just("wall.inp"), thickness=number(0.2, 0.6), scale=number(0.5, 2.0)),
    "column": piers,
    "brickwork": brickwork,
    "frame": lambda: table(
        "frame",
        columns=st.integers(2, 4),
        width=number(0.3, 1.0),
        height=number(2.5, 5.0),
        spacing=number(2.0, 3.0),
        lintel_height=number(0.3, 1.0),
    ),
    "stack": lambda: table(
        "stack", lower_width=number(0.6, 1.0), lower_height=number(0.5, 2.0), upper_width=number(0.3, 0.6), upper_height=number(0.8, 2.0)
    ),
    "building": houses,
    "wall": legs,
    "dome": domes,
    "chimney": chimneys,
    "cross-vault": groins,
}
#: Those with a plane section of stones, those whose stones have none, those that are one rocking body or a mechanism
SECTIONS = (
    "block",
    "column",
    "brickwork",
    "stack",
    "blocks",
    "arch",
    "frame",
    "panel",
    "pointed-arch",
    "elliptical-arch",
    "bridge",
    "vault",
    "aisled-vault",
)
SOLIDS = ("wall", "dome", "chimney", "cross-vault")
ROCKING = ("block", "column", "arch", "frame", "brickwork", "pointed-arch", "elliptical-arch", "vault")
SMALL = ("block", "column", "brickwork", "stack", "blocks")


def structures(*kinds: str) -> Strategy:
    """A structure of one of these kinds."""
    return st.sampled_from(kinds).flatmap(lambda kind: KINDS[kind]())


@st.composite
def decks(draw: st.DrawFn, *kinds: str, friction: st.SearchStrategy | None = None, material: st.SearchStrategy | None = None) -> Deck:
    """A building of one of these kinds: its structure, joints and material."""
    deck = {"structure": draw(structures(*kinds))}
    mu = draw(number(0.6, 0.9, 6) if friction is None else friction)
    if mu is not None:
        deck["joints"] = {"friction": mu}
    if material is not None:
        deck["material"] = draw(material)
    return deck


def sections(*kinds: str, friction: st.SearchStrategy | None = None) -> Strategy:
    """A plane section of free blocks, drawn from any kind that has one."""
    return decks(*(kinds or SECTIONS), friction=friction).map(drawn)


def pulses(low: float = 0.05, high: float = 0.8) -> Strategy:
    """One cycle of a sine; amplitude in g."""
    made = st.tuples(number(low, high), number(0.2, 1.2, 50))
    return made.map(lambda p: {"kind": "sine-pulse", "amplitude": f"{p[0]:g} g", "period": p[1]})


# ----- what may be done to a deck


def tidy(points: np.ndarray) -> list:
    """Coordinates without the rounding errors that decks refuse as sizes beyond reason."""
    return (np.round(points, 12) + 0.0).tolist()


def changed(deck: Deck, **tables: Any) -> Deck:
    """A copy with other values: changed(deck, joints={"friction": 0.5}, motion={...}); keys of a table are added to it."""
    made = copy.deepcopy(deck)
    for name, value in tables.items():
        there = made.get(name)
        made[name] = {**there, **value} if isinstance(there, dict) and isinstance(value, dict) else value
    return made


def drawn(deck: Deck) -> Deck:
    """The same building as free blocks: outlines as polygons, densities, the ground as segments."""
    if deck["structure"]["kind"] == "blocks":
        return deck
    building = make_deck(deck | {"analysis": [{"kind": "tilt"}]}).building
    stones = building.blocks()
    on_ground = (stones.a < 0) | (stones.b < 0)
    blocks = []
    for k, (name, outline) in enumerate(zip(stones.block_names, stones.outlines, strict=True)):
        x, y = outline.T
        area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
        blocks.append({"name": name, "points": tidy(outline), "density": float(stones.mass[k] / area / stones.depth)})
    ground = tidy(np.hstack([stones.p, stones.q])[on_ground])
    made = changed(deck, structure=None)
    made["structure"] = {"kind": "blocks", "block": blocks, "ground": ground, "depth": float(stones.depth)}
    return made


def moved(deck: Deck, place: Callable[[np.ndarray], np.ndarray]) -> Deck:
    """A drawn deck whose points, ground and ties are moved by a function of points (n, 2) [m]."""
    made = copy.deepcopy(deck)
    there = made["structure"]
    for block in there["block"]:
        block["points"] = tidy(place(np.array(block["points"], dtype=float)))
    there["ground"] = [tidy(place(np.array(row, dtype=float).reshape(2, 2)).ravel()) for row in there["ground"]]
    for tie in made.get("ties", []):
        for end in ("start", "end", "ground"):
            if end in tie:
                tie[end] = tidy(place(np.array([tie[end]], dtype=float))[0])
    return made


def mirrored(deck: Deck) -> Deck:
    """A drawn deck, left and right exchanged."""
    return moved(deck, lambda points: points * [-1.0, 1.0])


def scaled(deck: Deck, factor: float) -> Deck:
    """A deck with all lengths of its structure times a factor; a drawn one too."""
    from extrados import kinds

    def lengths(model: Any, there: Any) -> Any:
        return _converted(model, there, lambda value, unit: value * factor if unit == "m" else value)

    made = copy.deepcopy(deck)
    made["structure"] = lengths(kinds.table("structure", deck["structure"]["kind"]), made["structure"])
    return made


def _converted(model: Any, there: dict, change: Callable[[float, str], Any]) -> dict:
    """A table with its numbers changed by their units."""
    from extrados.decks.reader import _table_in
    from extrados.schema.quantities import unit_of

    def deep(value: Any, unit: str) -> Any:
        if isinstance(value, list):
            return [deep(v, unit) for v in value]
        return change(value, unit) if isinstance(value, float | int) and not isinstance(value, bool) and unit else value

    made = {}
    for name, value in there.items():
        inner = _table_in(model.model_fields[name].annotation) if name in model.model_fields else None
        if inner is not None and isinstance(value, dict):
            made[name] = _converted(inner, value, change)
        elif inner is not None and isinstance(value, list) and value and isinstance(value[0], dict):
            made[name] = [_converted(inner, v, change) for v in value]
        else:
            made[name] = deep(value, unit_of(model, name))
    return made


def in_words(deck: Deck) -> Deck:
    """The same deck with its quantities as text in other units."""
    from extrados import kinds
    from extrados.decks.reader import PROPERTIES

    other = {
        "m": (100.0, "cm"),
        "Pa": (1e-6, "MPa"),
        "N": (1e-3, "kN"),
        "kg/m^3": (1e-3, "t/m^3"),
        "s": (1e3, "ms"),
        "deg": (math.pi / 180.0, "rad"),
        "N/m": (1e-3, "kN/m"),
        "kg": (1e-3, "t"),
        "Pa/m": (1e-6, "MPa/m"),
    }

    def change(value: float, unit: str) -> Any:
        factor, word = other.get(unit, (1.0, ""))
        return f"{value * factor!r} {word}" if word else value

    made = copy.deepcopy(deck)
    for name, there in deck.items():
        if name in ("structure", "motion"):
            made[name] = _converted(kinds.table(name, there["kind"]), there, change)
        elif name in PROPERTIES:
            made[name] = _converted(PROPERTIES[name], there, change)
    return made


def on_plinth(deck: Deck, width: float, height: float) -> Deck:
    """A drawn deck on a block that cannot move, of `width` times its own and of `height` [m], which lies on the ground."""
    points = np.concatenate([block["points"] for block in deck["structure"]["block"]])
    (left, bottom), (right, _) = points.min(axis=0), points.max(axis=0)
    middle, half = 0.5 * (left + right), 0.5 * width * (right - left)
    made = moved(deck, lambda p: p - [middle, bottom - height])
    plinth = {"name": "plinth", "points": [[-half, 0.0], [half, 0.0], [half, height], [-half, height]]}
    made["structure"]["block"].append(plinth)
    made["structure"]["ground"] = [[-half - 1.0, 0.0, half + 1.0, 0.0]]
    return made


def cut(deck: Deck, number: int, share: float) -> Deck:
    """A drawn deck with one block cut by an upright line at a share of its width; as it is where the block is not convex."""
    made = copy.deepcopy(deck)
    blocks = made["structure"]["block"]
    block = blocks[number % len(blocks)]
    points = np.array(block["points"], dtype=float)
    if signed_area(points) < 0.0:
        points = points[::-1]
    x = points[:, 0].min() + share * np.ptp(points[:, 0])
    left, right = clipped(points, x, -1.0), clipped(points, x, 1.0)
    if not convex(points) or min(len(left), len(right)) < 3:
        return made
    blocks.remove(block)
    blocks += [{**block, "name": f"{block['name']} {side}", "points": part.tolist()} for side, part in (("left", left), ("right", right))]
    return made


def signed_area(points: np.ndarray) -> float:
    """Area of a polygon (n, 2), positive where counter-clockwise [m^2]."""
    x, y = points.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def convex(points: np.ndarray) -> bool:
    """Whether a counter-clockwise polygon (n, 2) is convex."""
    edge = np.roll(points, -1, axis=0) - points
    after = np.roll(edge, -1, axis=0)
    return bool(np.all(edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0] >= -1e-12))


def clipped(points: np.ndarray, x: float, side: float) -> np.ndarray:
    """The part of a convex polygon (n, 2) on one side of the upright line at x: side -1 left, +1 right."""
    kept = []
    for one, two in zip(points, np.roll(points, -1, axis=0), strict=True):
        a, b = side * (one[0] - x), side * (two[0] - x)
        if a >= 0.0:
            kept.append(one)
        if a * b < 0.0:
            kept.append(one + (two - one) * a / (a - b))
    return np.array(kept)


def shaken(deck: Deck, deviation: float, seed: int) -> Deck:
    """A drawn deck whose vertices each stray by up to the deviation [m], shared ones alike."""
    rng = np.random.default_rng(seed)
    strays: dict[tuple, np.ndarray] = {}

    def stray(points: np.ndarray) -> np.ndarray:
        return np.array([p + strays.setdefault(tuple(np.round(p, 9)), rng.uniform(-1, 1, 2) * deviation) for p in points])

    made = copy.deepcopy(deck)
    for block in made["structure"]["block"]:
        block["points"] = stray(np.array(block["points"], dtype=float)).tolist()
    return made
