"""How a building is divided, and what is varied in it: rigid links, sections of solids, swept keys, tables of sections, overlaps, faults."""

import importlib
import itertools
import math
import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Deck, ask, at_most, must, near, run
from buildings import changed, decks, number, pulses
from conservation import building
from fields import leaning
from hypothesis import reject
from hypothesis import strategies as st
from relations import ok, relation

from extrados import kinds
from extrados.views.rigid import rigid_bodies

# ----- rigid links


def joined(outlines: list[np.ndarray]) -> list[list[float]]:
    """The outline of polygons that share whole edges."""
    edges: set[tuple] = set()
    for outline in outlines:
        x, y = outline.T
        ring = [tuple(p) for p in (outline if x @ np.roll(y, -1) > y @ np.roll(x, -1) else outline[::-1]).tolist()]
        for edge in zip(ring, ring[1:] + ring[:1], strict=True):
            edges ^= {edge[::-1]} if edge[::-1] in edges else {edge}
    after = dict(edges)
    first = next(iter(after))
    found = [first]
    while (point := after[found[-1]]) != first:
        found.append(point)
    if len(found) < len(edges):
        reject()  # a ring with a hole
    return [list(p) for p in found]


def linked(deck: Deck, velocity: np.ndarray) -> tuple[Deck, int]:
    """A drawn chain with one block for each of its rigid links, and how many of these move; velocity: of its blocks (n, 3)."""
    stones = building(deck).blocks()
    x, y = stones.centroid.T
    at_origin = np.column_stack([velocity[:, 0] + velocity[:, 2] * y, velocity[:, 1] - velocity[:, 2] * x, velocity[:, 2] * stones.size])
    small = 1e-6 * np.abs(at_origin).max()
    cuts = np.flatnonzero(np.abs(np.diff(at_origin, axis=0)).max(axis=1) > small) + 1
    parts = np.split(np.arange(len(x)), cuts)
    blocks = deck["structure"]["block"]
    made = [
        {
            "name": f"link{k}",
            "points": joined([np.array(blocks[i]["points"], dtype=float) for i in part]),
            "density": blocks[part[0]]["density"],
        }
        for k, part in enumerate(parts)
    ]
    return changed(deck, structure={"block": made}), sum(bool(np.abs(at_origin[part]).max() > small) for part in parts)


CHAINS = decks("arch", "pointed-arch", "elliptical-arch", friction=number(0.7, 0.9, 4))


@relation("local-mechanism tilt", st.tuples(CHAINS, number(0.02, 0.08), number(0.85, 1.15)), 1e-4)
def links_are_blocks_of_their_own(deck: Deck, lean: float, near_limit: float, within: float) -> None:
    """e* and the verdict with one weight for each rigid link are those of the building drawn with one block for each link."""
    bare = leaning(deck, lean)
    keys: Deck = {"mechanism": "building", "spectrum": {"code": "NTC", "acceleration": "0.2 g"}, "confidence_factor": 1.0}
    first = ask(bare, "local-mechanism", **keys)
    tilt = ask(bare, "tilt")
    ok(first, tilt)
    governing = first.results.governing()
    if not governing or not tilt.capacity[0] < 0.999 * tilt.capacity[1] or abs(first.results.multiplier - tilt.capacity[0]) > 1e-6:
        reject()
    keys["spectrum"]["acceleration"] = f"{0.2 * governing[0][0] * near_limit!r} g"
    one = ask(bare, "local-mechanism", **keys)
    coarse, moving = linked(bare, np.asarray(tilt.result.arrays["velocity"].data))
    other = ask(coarse, "local-mechanism", **keys)
    ok(one, other)
    r, links = one.results, other.results
    near("alpha_0", r.multiplier, links.multiplier, within)
    apart = links.participating_part / r.participating_part - 1.0
    said = re.search(r"each of the (\d+) rigid links .*? e\* is ([\d.]+), and a_0\* changes by ([+-]\d+) %", one.warnings)
    must(said is not None if abs(apart) > 0.021 else said is None or abs(apart) > 0.019, f"e* differs by {apart}: {one.warnings}")
    if said is not None:
        must(int(said[1]) == moving, f"{said[1]} links of {moving}")
        near("e* of links", float(said[2]), links.participating_part, 6e-3)
        must(abs(float(said[3]) - 100.0 * (r.participating_part / links.participating_part - 1.0)) < 0.51, said[0])
    turns = r.overall().outcome == "stands" and links.overall().outcome != "stands" and said is not None
    words = " ".join(one.verdict.violated)
    must(
        ("how the links are divided" in words) == turns,
        f"{r.overall().outcome}, {links.overall().outcome} by links: {one.verdict.statement}",
    )


# ----- courses beside openings


@relation(
    "tilt", st.tuples(st.integers(1, 3), st.integers(4, 6), number(-0.024, 0.024, 12), number(-0.024, 0.024, 12), st.booleans()), 1e-9
)
def bed_joints_move_to_the_edges_of_openings(low: int, high: int, sill: float, head: float, lintels: bool, within: float) -> None:
    """An edge of an opening nearer to a bed joint than a quarter of a course takes this bed joint with it; all others stay."""
    height = 0.2
    levels = [k * height for k in range(9)]
    levels[low], levels[high] = low * height + sill, high * height + head
    structure = {"kind": "brickwork", "unit_length": 0.4, "unit_height": height, "units": 6, "courses": 8, "lintels": lintels}
    deck = {"structure": {**structure, "openings": [{"x": [0.8, 1.6], "y": [levels[low], levels[high]]}]}}
    found = np.unique(np.round(np.concatenate(building(deck).blocks().outlines)[:, 1], 12))
    if lintels:  # the top of the lintel, a course above its foot, is an edge too
        levels[high + 1] = levels[high] + height
    want = np.array(levels)
    must(all(np.abs(want - y).min() <= within for y in found), f"levels {found.tolist()} of {want.tolist()}")
    must(all(np.abs(found - y).min() <= within for y in want), f"levels {found.tolist()} of {levels}")


# ----- sections of solids


@relation(
    "thrust", st.tuples(decks("wall", "dome"), number(0.1, 0.9, 40), number(0.2, 0.8, 40), number(-180.0, 180.0, 36)), 1e-5, share=0.5
)
def sections_of_solids_hold_what_they_cut(deck: Deck, up: float, along: float, toward: float, within: float) -> None:
    """Contacts of a level or upright section are those between centres on its two sides. Across a level one the weight above is carried; thrusts are
    sums of forces on the side that is named, between their least and greatest; contacts named one by one are the same section."""
    solids = building(deck).solids()
    points = np.concatenate([p.vertices for p in solids.parts])
    low, high = points.min(axis=0), points.max(axis=0)
    z, x = round(float(low[2] + up * (high[2] - low[2])), 4), round(float(low[0] + along * (high[0] - low[0])), 4)
    centre = np.vstack([solids.centroid, [np.nan, np.nan, -np.inf]])  # the last is the ground
    a, b = solids.a, solids.b
    with np.errstate(invalid="ignore"):
        level = (centre[a, 2] > z) != (centre[b, 2] > z)
        upright = ((centre[a, 0] > x) != (centre[b, 0] > x)) & (a >= 0) & (b >= 0)
    sections = [{"name": "feet", "joints": ["ground"], "toward": toward}]
    sections += [{"name": "level", "z": z, "toward": toward}] if level.any() else []
    sections += [{"name": "upright", "x": x}] if upright.any() else []
    if level.any():
        sections.append({"name": "named", "joints": [solids.joint_names[j] for j in np.flatnonzero(level)], "toward": toward})
    answer = ask(deck, "thrust", direction=0.0, section=sections)
    ok(answer)
    r, arrays = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    rows = {row.name: row for row in r.sections}
    way = np.array([math.cos(math.radians(toward)), math.sin(math.radians(toward)), 0.0])
    weight = float(solids.mass.sum()) * 9.80665
    expected = {
        "feet": ((a < 0) | (b < 0), way),
        "level": (level, way),
        "named": (level, way),
        "upright": (upright, np.array([1.0, 0.0, 0.0])),
    }
    for name, row in rows.items():
        inside, direction = expected[name]
        must(row.contacts == int(inside.sum()), f"{name}: {row.contacts} contacts of {int(inside.sum())}")
        if name == "upright":
            must(row.direction == "+x", row.direction)
            on_first = centre[a, 0] > x
        else:  # forces on the blocks or the ground below
            on_first = ~(centre[a, 2] >= centre[b, 2])
        if row.central_N is None:
            continue
        force = np.where(on_first[:, None], 1.0, -1.0) * arrays["central_force"]
        total = force[inside].sum(axis=0)
        near(f"thrust at {name}", row.central_N, float(total @ direction), within, weight)
        if row.least_N is not None:
            at_most(f"least at {name}", row.least_N, row.central_N, within, weight)
        if row.greatest_N is not None:
            at_most(f"central at {name}", row.central_N, row.greatest_N, within, weight)
        if name in ("level", "feet"):
            above = solids.mass[solids.centroid[:, 2] > z].sum() if name == "level" else solids.mass.sum()
            near(f"weight above {name}", -float(total[2]), float(above) * 9.80665, within, weight)
    if "level" in rows and rows["level"].central_N is not None:
        for key in ("least_N", "central_N", "greatest_N"):
            one, two = getattr(rows["level"], key), getattr(rows["named"], key)
            must((one is None) == (two is None), f"{key}: {one}, by names {two}")
            near(key, one or 0.0, two or 0.0, 1e-3, weight)
    empty = [] if level.any() else [{"name": "level", "z": z}]
    empty += [] if upright.any() else [{"name": "upright", "x": x}]
    for section in [*empty, {"name": "odd", "joints": ["no such joint"]}]:
        wrong = ask(deck, "thrust", direction=0.0, section=[section])
        must(wrong.status == "refused" and section["name"] in wrong.said, f"{section}: {wrong.outcome} {wrong.said}")


# ----- keys that vary

#: Paths of keys: (kinds of structure, table and path within it, values)
VARIED: dict[str, tuple[tuple[str, ...], str, tuple[float, float]]] = {
    "thickness": (("arch",), "structure.thickness", (1.0, 1.3)),
    "width": (("column",), "structure.width", (0.5, 1.5)),
    "spans.0.rise": (("bridge",), "structure.spans.0.rise", (0.9, 1.1)),
    "joints.friction": (("arch", "column", "brickwork"), "joints.friction", (0.5, 1.2)),
    "ties.0.yield_force": (("column",), "ties.0.yield_force", (0.5, 2.0)),
    "voussoirs": (("arch",), "structure.voussoirs", (0.8, 1.4)),
}
UNITS = {"structure.thickness": "m", "structure.width": "m", "structure.spans.0.rise": "m", "ties.0.yield_force": "N"}


def at_path(data: Any, path: str) -> tuple[Any, Any]:
    """What holds the last part of a dotted path, and this part."""
    *way, last = [int(part) if part.isdecimal() else part for part in path.split(".")]
    for part in way:
        data = data[part]
    return data, last


@st.composite
def varied(draw: st.DrawFn) -> tuple[Deck, str, list[float]]:
    """A deck, a key that varies, and its values."""
    vary = draw(st.sampled_from(sorted(VARIED)))
    structures, path, (low, high) = VARIED[vary]
    deck = draw(decks(*structures))
    if "ties" in vary:
        height = deck["structure"]["height"]
        deck["ties"] = [{"name": "stay", "start": [0.0, 0.9 * height], "end": [3.0, 0.2], "yield_force": draw(number(500.0, 3000.0, 5))}]
    place, last = at_path(deck, path)
    factors = draw(st.lists(number(low, high, 10), min_size=2, max_size=3, unique=True))
    values = sorted({round(place[last] * f) if vary == "voussoirs" else float(f"{place[last] * f:.5g}") for f in factors})
    if len(values) < 2:
        values = [values[0], values[0] + 1]
    return deck, vary, values


def with_value(deck: Deck, path: str, value: float) -> Deck:
    """The deck with the value at a path."""
    made = changed(deck)
    place, last = at_path(made, path)
    place[last] = value
    return made


@relation("sweep survey tilt", varied(), 1e-5)
def varied_keys_are_decks_of_their_own(deck: Deck, vary: str, values: list, within: float) -> None:
    """Each value of a sweep, and each row of a table of sections, has the capacity of the deck with this value; quantities with a unit are the
    same numbers; keys that do not exist are named."""
    path = VARIED[vary][1]
    alone = [ask(with_value(deck, path, value), "tilt") for value in values]
    wanted = [None if not one.answers else one.results.collapse_acceleration_g for one in alone]
    if not any(wanted):
        reject()
    swept = ask(deck, "sweep", vary=vary, values=values, locate=False)
    ok(swept)
    arrays = {k: np.asarray(v.data) for k, v in swept.result.arrays.items()}
    must(swept.results.unit == UNITS.get(path, ""), f"unit {swept.results.unit}")
    for k, (value, capacity) in enumerate(zip(values, wanted, strict=True)):
        if capacity:
            near(f"{vary} = {value}", arrays["gamma"][k], capacity, within, 1e-3)
    if UNITS.get(path) == "m":
        text = ask(deck, "sweep", vary=vary, values=[f"{100.0 * value!r} cm" for value in values], locate=False)
        ok(text)
        near("as text", np.nan_to_num(np.asarray(text.result.arrays["gamma"].data)), np.nan_to_num(arrays["gamma"]), within, 1e-3)
    for wrong, word in ((f"{vary}x", vary.rpartition(".")[2] + "x"), ("kind", "kind"), ("joints.nothing", "nothing")):
        other = ask(deck, "sweep", vary=wrong, values=values, locate=False)
        must(other.status == "refused" and word in other.said, f"{wrong}: {other.outcome} {other.said}")
    if not path.startswith("structure."):
        return
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        lines = [f"name,{vary}", "", *(f"n{k},{value!r}" for k, value in enumerate(values)), " , ", ",", f",{values[0]!r}"]
        (folder / "rows.csv").write_text("\n".join(lines) + "\n")
        table = ask(deck, "survey", folder, file="rows.csv")
        ok(table)
        (folder / "rows.csv").write_text(f"name,{vary},nothing\na,{values[0]!r},1\n")
        odd = ask(deck, "survey", folder, file="rows.csv")
        (folder / "rows.csv").write_text(f"name,{vary}\na\n")
        short = ask(deck, "survey", folder, file="rows.csv")
    must(odd.status == "refused" and "nothing" in odd.said and "rows.csv:1" in odd.said, f"{odd.outcome} {odd.said}")
    must(short.status == "refused" and "rows.csv:2" in short.said, f"{short.outcome} {short.said}")
    gamma, names = np.asarray(table.result.arrays["gamma"].data), list(table.result.arrays["section_name"].data)
    must(names == [*(f"n{k}" for k in range(len(values))), f"section {len(values) + 1}"], f"{names}")
    for k, capacity in enumerate([*wanted, wanted[0]]):
        if capacity:
            near(f"row {names[k]}", gamma[k], capacity, within, 1e-3)
    must(table.results.standing == int((gamma > 0.0).sum()), f"{table.results.standing} stand of {gamma}")


@relation("imperfections", st.tuples(decks("column", "arch", "brickwork"), number(0.05, 0.6, 11)), 1e-6, share=0.5)
def surveys_deviate_by_a_quarter_of_a_joint_at_most(deck: Deck, share: float, within: float) -> None:
    """A deviation above a quarter of the shortest joint is refused with that joint; below it the capacities of the random geometries are a band."""
    stones = building(deck).blocks()
    length = np.hypot(*(stones.q - stones.p).T)
    deviation = float(f"{share * length.min():.6g}")
    answer = ask(deck, "imperfections", deviation=deviation, count=10)
    if share > 0.25 * (1.0 + within):
        must(answer.status == "refused" and f"({1e3 * length.min():.3g} mm)" in answer.said, f"{answer.outcome} {answer.said}")
        must(any(f"'{stones.joint_names[j]}'" in answer.said for j in np.flatnonzero(length < length.min() * (1.0 + 1e-9))), answer.said)
        return
    must(answer.status != "refused" or "deviation" not in answer.said, answer.said)
    none = ask(deck, "imperfections", count=10)
    must(none.status == "refused" and "deviation" in none.said, f"without a deviation {none.outcome} {none.said}")


# ----- senses of a tilt test


@relation("dem", st.tuples(decks("block", friction=st.just(2.0)), number(0.03, 0.06, 6), number(0.1, 0.9, 8)), 1e-9, share=0.3)
def the_weaker_sense_of_a_tilt_of_elements_decides(deck: Deck, lean: float, share: float, within: float) -> None:
    """Of a leaning block the lesser of both collapse accelerations is compared with a peak between them: it collapses."""
    bare = leaning(deck, lean)
    keys = {"test": "tilt", "solver": "nonsmooth", "tilt_accuracy": 0.02, "time_step": 4e-3}
    first = ask(bare, "dem", **keys)
    ok(first)
    less, more = sorted(first.capacity.tolist())
    if more < 1.1 * less:
        reject()
    motion = {"kind": "sine-pulse", "amplitude": f"{less + share * (more - less)!r} g", "period": 0.5}
    answer = ask(changed(bare, motion=motion), "dem", **keys)
    ok(answer)
    near("the capacity that decides", answer.verdict.capacity, less, within)
    must(answer.outcome in ("collapses", "open"), f"{answer.outcome} between {less} and {more} g")


# ----- chaos of two blocks


@relation("rocking", st.tuples(decks("stack", friction=st.just(2.0)), pulses(0.4, 1.2)), 0.2, share=0.5)
def perturbed_stacks_part_as_reported(deck: Deck, motion: Deck, within: float) -> None:
    """The growth of a perturbation is that of two further runs under the motion times 1 plus and minus 1e-6, over the critical rotations."""
    peak = float(motion["amplitude"].split()[0])
    runs = [
        ask(changed(deck, motion={**motion, "amplitude": f"{peak * f!r} g"}), "rocking", end_time=1.5)
        for f in (1.0, 1.0 - 1e-6, 1.0 + 1e-6)
    ]
    ok(*runs)
    r = runs[0].results
    if any(one.results.hand_over is not None for one in runs):
        reject()
    shares = []
    for one in runs:
        lower, upper = (np.asarray(one.result.arrays[name].data) for name in ("rotation", "rotation_upper"))
        shares.append(np.array([lower / r.critical_rotation_rad, (upper - lower) / r.stack.critical_rotation_upper_rad]))
    length = min(s.shape[1] for s in shares)
    whole = np.array([s[:, :length] for s in shares])
    found = 0.0
    for k in range(2):
        beyond = (np.abs(whole[:, k]) > 1.0).any(axis=0)
        until = int(beyond.argmax()) if beyond.any() else length
        found = max(found, 1e6 * float(np.abs(whole[1:, k, :until] - whole[0, k, :until]).max(initial=0.0)))
    if not 1.0 < found < 1e5:
        reject()  # rounding, or histories that have nothing in common
    near("growth", r.perturbation_growth, found, within)


# ----- faults of the program


class Fault(Exception):
    """What no analysis expects."""


@relation("tilt thrust", st.tuples(decks("block", "column"), st.booleans()), 0.0, share=0.25)
def a_fault_of_one_analysis_is_reported(deck: Deck, lacks: bool, within: float) -> None:
    """An analysis at fault has the outcome failed, with the reason and a file to report; the others of the deck have their results. A lack of
    memory that was foreseen has no file."""
    del within
    place, name = kinds.ANALYSES["tilt"].driver.split(":")
    module = importlib.import_module(f"extrados.{place}")
    plain = getattr(module, name)

    def wrong(*_: Any) -> None:
        raise MemoryError("not enough memory: for a trial") if lacks else Fault("a trial")

    setattr(module, name, wrong)
    try:
        results = run(changed(deck, analysis=[{"kind": "thrust"}, {"kind": "tilt"}, {"kind": "thrust"}])).results
    finally:
        setattr(module, name, plain)
    must([r.status for r in results] == ["ok", "failed", "ok"], f"{[r.status for r in results]}")
    failed = results[1]
    must(failed.verdict is None and "trial" in failed.reason, failed.reason)
    must(("internal error" in failed.reason) != lacks, failed.reason)
    must(bool(failed.files) != lacks and (lacks or b"a trial" in next(iter(failed.files.values()))), f"{list(failed.files or {})}")


# ----- overlaps of drawn blocks


def clipped(polygon: np.ndarray, other: np.ndarray) -> np.ndarray:
    """What two convex polygons passed anticlockwise share (n, 2) [m]."""
    found = [tuple(p) for p in polygon]
    for p, q in itertools.pairwise([*other, other[0]]):
        side = [(q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) for x, y in found]
        kept = []
        for k, point in enumerate(found):
            after = (k + 1) % len(found)
            if side[k] >= 0.0:
                kept.append(point)
            if side[k] * side[after] < 0.0:
                share = side[k] / (side[k] - side[after])
                kept.append(tuple(np.array(point) + share * (np.array(found[after]) - point)))
        found = kept
    return np.array(found).reshape(-1, 2)


def area_of(polygon: np.ndarray) -> float:
    """Area [m^2]."""
    x, y = polygon.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


@relation("dem", st.tuples(number(0.5, 1.5, 10), number(0.3, 0.8, 10), number(-3.0, 3.0, 12), number(-3.0, 3.0, 12)), 1e-6)
def overlaps_are_cut_between_blocks(width: float, height: float, left: float, right: float, within: float) -> None:
    """Discrete elements cut two overlapping blocks of a survey back to shapes that touch; neither loses more than the overlap."""
    one = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    two = np.array([[0.0, height - 1e-3 * left], [width, height - 1e-3 * right], [width, 2.0 * height], [0.0, 2.0 * height]])
    deck = {
        "structure": {
            "kind": "blocks",
            "block": [{"name": "one", "points": one.tolist()}, {"name": "two", "points": two.tolist()}],
            "ground": [[-1.0, 0.0, width + 1.0, 0.0]],
            "contact_tolerance": 0.008,
        },
        "joints": {"friction": 0.6},
    }
    answer = ask(
        changed(deck, motion={"kind": "sine-pulse", "amplitude": "0.01 g", "period": 0.2}), "dem", end_time=0.02, solver="nonsmooth"
    )
    ok(answer)
    arrays = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    must(bool(np.isfinite(arrays["time"]).all()), "a run without an end")
    bodies = rigid_bodies(building(deck).blocks())
    shapes = [p for p, o in zip(bodies.parts, bodies.owner, strict=True) if o < 2]
    shared = area_of(s) if len(s := clipped(*shapes)) else 0.0
    must(shared <= within * width * height, f"parts still share {shared} m^2")
    common = area_of(c) if len(c := clipped(one, two)) else 0.0
    for name, shape, drawn_ in (("one", shapes[0], one), ("two", shapes[1], two)):
        lost = area_of(drawn_) - area_of(shape)
        at_most(f"what block {name} loses", lost, common, within, width * height)
