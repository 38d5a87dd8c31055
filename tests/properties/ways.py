"""The same number by two ways: components of a motion, modes of a floor, dowels, files, arrays and tables, limits of keys, words."""

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Answer, Deck, ask, at_most, must, near, same
from buildings import changed, decks, drawn, number
from definitions_codes import code_spectrum
from definitions_keys import EFFECTS
from fields import dimension, leaning, numbers, questions
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, RIGID, ok, relation

import extrados
from extrados.decks.reader import DeckError, make_deck

STEP = 0.01
DRUM = {"kind": "column", "section": "round", "sides": 8, "drums": 2}


def two_components(folder: Path, first: np.ndarray, second: np.ndarray, angle: float) -> Deck:
    """A record of two horizontal components [g] in the folder, seen at an angle."""
    for name, values in (("first", first), ("second", second)):
        rows = [f"{k * STEP:.6f},{value:.12g}" for k, value in enumerate(values)]
        (folder / f"{name}.csv").write_text("time_s,acceleration_g\n" + "\n".join(rows) + "\n")
    return {"kind": "record", "file": "first.csv", "second": "second.csv", "angle": angle}


def wave(amplitude: float, period: float, cycles: int) -> np.ndarray:
    """Sines of zero ends [g]."""
    time = np.arange(round(cycles * period / STEP) + 1) * STEP
    return amplitude * np.sin(2.0 * math.pi * time / period)


@relation(
    "dem",
    st.tuples(number(0.6, 1.4), number(60.0, 150.0, 9), number(0.0, 60.0, 6), number(0.4, 0.6), number(0.4, 0.6), st.booleans()),
    0.02,
    share=0.5,
)
def two_components_are_one_motion(width: float, way: float, angle: float, one: float, two: float, rigid: bool, within: float) -> None:
    """In space: the same motion of the ground, described along a way and along one at a right angle to it, and as a single component along its own."""
    deck = {"structure": {**DRUM, "width": width, "height": float(f"{3.0 * width:.5g}")}, "joints": {"friction": 0.4}}
    keys = {"time_step": 1e-3, "output_step": 0.02, "end_time": 0.5, "perturbed": False, **(RIGID if rigid else {})}
    if not rigid:
        deck["joints"]["normal_stiffness"] = 1e9
    a, b = wave(one, 0.4, 1), wave(two, 0.2, 2)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        motion = two_components(folder, a, b, angle)
        first = ask({**deck, "motion": motion}, "dem", folder, direction=way, **keys)
        turned = ask({**deck, "motion": {**motion, "angle": angle + 90.0}}, "dem", folder, direction=way + 90.0, **keys)
        alone = ask({**deck, "motion": two_components(folder, a, wave(2e-4, 0.2, 2), angle)}, "dem", folder, direction=way, **keys)
        plain = ask({**deck, "motion": {"kind": "record", "file": "first.csv"}}, "dem", folder, direction=way - angle, **keys)
    ok(first, turned, alone, plain)
    must((first.results.horizontal_components, plain.results.horizontal_components) == (2, 1), f"{first.results}")
    arrays = {k: np.asarray(v.data) for k, v in first.result.arrays.items()}
    at = arrays["time"] < 0.39
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    x, y = (GRAVITY * np.interp(arrays["time"][at], np.arange(len(v)) * STEP, v) for v in (a, b))
    near("ground", arrays["ground"][at], c * x + s * y, 1e-6, 1.0)
    near("ground across", arrays["ground_across"][at], c * y - s * x, 1e-6, 1.0)
    size = within * 0.1 * width
    for told, this, that in (("turned", first, turned), ("alone", alone, plain)):
        p, q = (np.asarray(v.result.arrays["pose"].data)[:, :, :3] for v in (this, that))
        near(f"{told}: poses", p, q, within, max(size, float(np.abs(p).max())))
    other = np.asarray(alone.result.arrays["pose"].data)[:, :, :3]
    must(float(np.abs(arrays["pose"][:, :, :3] - other).max()) > 1e-4, "the second component moves nothing")


@st.composite
def floors_of_modes(draw: st.DrawFn) -> tuple[Deck, list[Deck]]:
    """A wall in a building, and modes of the building."""
    mode = st.fixed_dictionaries(
        {
            "period": number(0.05, 0.8, 15),
            "participation": number(0.3, 1.5, 12),
            "shape": st.sampled_from([-0.6, 0.5, 1.0, 1.3]),
            "damping": number(0.02, 0.1, 8),
        }
    )
    table = {
        "mechanism": "facade",
        "height": draw(number(2.5, 5.0, 10)),
        "thickness": draw(number(0.4, 0.8, 4)),
        "spectrum": {"code": "NTC", "acceleration": f"{draw(number(0.05, 0.4, 7)):g} g"},
        "base_height": draw(number(2.0, 6.0, 4)),
        "building_height": 9.0,
    }
    return table, draw(st.lists(mode, min_size=1, max_size=3, unique_by=lambda m: m["period"]))


@relation("local-mechanism", floors_of_modes(), 1e-6, share=2.0)
def floors_of_several_modes(table: Deck, modes: list[Deck], within: float) -> None:
    """A floor spectrum is the root of the sum of the squares of its modes in any order, from the longest period on no less than that of the ground."""
    deck = {"structure": {"kind": "block", "width": 1.0, "height": 4.0}}
    answer = ask(deck, "local-mechanism", **table, modes=modes)
    back = ask(deck, "local-mechanism", **table, modes=modes[::-1])
    ok(answer, back)
    peak = float(table["spectrum"]["acceleration"].split()[0]) * GRAVITY

    def top(m: Deck) -> float:
        a = code_spectrum(peak, m["period"], m["damping"])
        return a * abs(m["participation"] * m["shape"]) * math.sqrt(1.0 + 4e-4 * (100.0 * m["damping"]) ** 2)

    def of_mode(m: Deck, period: float, damping: float) -> float:
        most = 1.1 / math.sqrt(m["damping"]) * max(math.sqrt(10.0 / (5.0 + 100.0 * damping)), 0.55)
        a, b = 0.8 * m["period"], 1.1 * m["period"]
        off = 1.0 + (most - 1.0) * ((1.0 - period / a) ** 1.6 if period < a else (period / b - 1.0) ** 1.2 if period >= b else 0.0)
        return most * top(m) / off

    first = max(m["period"] for m in modes)

    def floor(period: float, damping: float) -> float:
        found = math.sqrt(sum(of_mode(m, period, damping) ** 2 for m in modes))
        return found if period <= first else max(found, code_spectrum(peak, period, damping))

    a_z = math.sqrt(sum(top(m) ** 2 for m in modes))
    r = answer.results
    near("a_Z", r.floor_acceleration_g, a_z / GRAVITY, within)
    if r.equivalent_period_s is not None:
        times = [*(r.equivalent_period_s * np.arange(1, 61) / 60.0), *(1.1 * m["period"] for m in modes)]
        grid = [floor(t, 0.08) * (t / (2.0 * math.pi)) ** 2 for t in times if t <= r.equivalent_period_s]
        demand = r.checks["NTC nonlinear"].demand
        at_most("demand of displacement", max(grid[:60]), demand, 1e-3)
        at_most("demand of displacement", demand, max(grid), 1e-3)
    for name, check in r.checks.items():
        near(name, check.demand or 0.0, back.results.checks[name].demand or 0.0, 1e-9)
    if len(modes) == 1 and modes[0]["damping"] == 0.05:
        m = modes[0]
        level = m["participation"] * abs(m["shape"]) * table["building_height"] / 1.0
        plain = {**table, "building_height": max(level, table["base_height"]), "building_period": m["period"], "storeys": 1}
        other = ask(deck, "local-mechanism", **plain)
        ok(other)
        z = table["base_height"] / plain["building_height"]
        near("first mode", other.results.floor_acceleration_g * m["participation"] * abs(m["shape"]), r.floor_acceleration_g * z, 1e-6)


DOWELLED = st.tuples(number(0.6, 1.4), number(0.15, 0.4), number(0.3, 0.6), number(0.0, 80.0, 8), st.integers(2, 3))


@relation("dem", DOWELLED, 0.15, share=0.5)
def dowels_hold_what_they_are_given(width: float, push: float, part: float, way: float, drums: int, within: float) -> None:
    """Drums almost without friction on accelerating ground: each dowel carries the inertia above it as a spring. Beyond its strength the part above slides as one body under the remaining force."""
    height = float(f"{0.5 * width * drums:.5g}")
    structure = {**DRUM, "width": width, "height": height, "drums": drums}
    area = 2.0 * math.sqrt(2.0) * (0.5 * width) ** 2
    above = 2000.0 * area * height * (drums - 1) / drums
    force = above * push * GRAVITY
    deck = {
        "structure": structure,
        "material": {"density": 2000.0},
        "joints": {"friction": 1e-3, "normal_stiffness": 1e9, "shear_ratio": 0.5, "types": [{"joints": ["ground"], "friction": 3.0}]},
        "motion": {"kind": "step-pulse", "amplitude": f"{push:.6g} g", "duration": 0.2},
    }
    keys = {"direction": way, "end_time": 0.2, "output_step": 0.01, "perturbed": False}
    held, weak, none, lost = (
        ask(changed(deck, structure=more), "dem", **keys)
        for more in ({"dowels": "unbroken"}, {"dowels": float(f"{part * force:.6g}")}, {}, {"dowels": 1e-3 * force})
    )
    ok(held, weak, none, lost)
    must((held.results.dowels, none.results.dowels, held.results.dowels_out) == (drums - 1, 0, 0), f"{held.results}")
    must(held.results.dowel_slip_m == 0.0, f"unbroken dowels yield by {held.results.dowel_slip_m} m")
    slip = force / (0.5 * 1e9 * area)
    moved = np.asarray(held.result.arrays["pose"].data)[:, :, :2]
    elastic = float(np.linalg.norm(moved[:, 1] - moved[:, 0], axis=1).max())
    at_most("spring of a dowel", elastic, 8.0 * slip, 0.0)
    at_most("spring of a dowel", slip, elastic, 0.0)
    free = 0.5 * (1.0 - part) * push * GRAVITY * 0.2**2
    near("slip over the strength", weak.results.peak_slip_m, free, within, free + 10.0 * slip)
    at_most("slip with a weaker dowel", weak.results.peak_slip_m, none.results.peak_slip_m, within)
    at_most("slip with dowels", held.results.peak_slip_m, weak.results.peak_slip_m, 0.05)
    near("dowels of no account", lost.results.peak_slip_m, none.results.peak_slip_m, 0.02)


@relation("tilt", st.tuples(number(0.6, 1.4), number(2.0, 5.0), number(0.05, 0.3), number(0.0, 80.0, 8), number(1.1, 3.0)), 1e-5)
def dowels_of_a_column_at_rest(width: float, slender: float, friction: float, way: float, factor: float, within: float) -> None:
    """Stronger dowels never lower a capacity; unbroken ones are those of friction that suffices; beyond the strength drums slide by Coulomb and dowel."""
    structure = {**DRUM, "width": width, "height": float(f"{slender * width:.5g}"), "drums": 2}
    deck = {
        "structure": structure,
        "material": {"density": 2000.0},
        "joints": {"friction": friction, "types": [{"joints": ["ground"], "friction": 3.0}]},
    }
    area = 2.0 * math.sqrt(2.0) * (0.5 * width) ** 2
    above = 0.5 * 2000.0 * area * structure["height"] * GRAVITY
    strength = float(f"{0.05 * above:.6g}")
    made = [{}, {"dowels": strength}, {"dowels": strength * factor}, {"dowels": "unbroken"}]
    free, weak, more, unbroken = (ask(changed(deck, structure=m), "tilt", direction=way, starts=1) for m in made)
    ok(free, weak, more, unbroken)
    rough = ask(changed(deck, joints={"friction": 3.0, "types": []}), "tilt", direction=way, starts=1)
    ok(rough)
    for told, less, greater in (("a dowel", free, weak), ("a stronger dowel", weak, more), ("an unbroken one", more, unbroken)):
        at_most(told, less.capacity, greater.capacity, within, 1.0)
    near("unbroken", unbroken.capacity, rough.capacity, 1e-3, 1.0)
    near("sliding", free.capacity, np.minimum(friction, rough.capacity), 1e-3, 1.0)
    near("dowel", weak.capacity, np.minimum(friction + strength / above, rough.capacity), 1e-3, 1.0)


def moved_model(text: str, shift: list[float], turn: int, skew: float, noise: float = 0.0) -> str:
    """A model of COMPAS moved, its axes exchanged, the far side of its first block moved by `skew`, and of every block by a `noise` of its size."""
    import json

    data = json.loads(text)

    def meshes(there: Any) -> list[dict]:
        if isinstance(there, dict):
            own = [there["vertex"]] if isinstance(there.get("vertex"), dict) else []
            return own + [m for v in there.values() for m in meshes(v)]
        return [m for v in there for m in meshes(v)] if isinstance(there, list) else []

    for k, vertices in enumerate(meshes(data)):
        depth = max(v["y"] for v in vertices.values())
        size = max(max(v[c] for v in vertices.values()) - min(v[c] for v in vertices.values()) for c in "xyz")
        for v in vertices.values():
            x, y, z = v["x"], v["y"], v["z"]
            x += noise * size if y == depth else 0.0
            x += skew if k == 0 and y == depth else 0.0
            one = [x + shift[0], y + shift[1], z + shift[2]]
            v["x"], v["y"], v["z"] = [one, [one[1], one[0], one[2]]][turn]
    return json.dumps(data)


#: A wall whose stones are prisms along every axis
CUBOIDS: Deck = {
    "structure": {"kind": "brickwork", "unit_length": 0.3, "unit_height": 0.15, "units": 2, "courses": 2},
    "joints": {"friction": 0.6},
}


@relation(
    "tilt",
    st.tuples(
        decks("block", "column", "arch", "brickwork"),
        st.tuples(number(-20.0, 20.0), number(-20.0, 20.0), number(-5.0, 5.0)),
        st.integers(0, 1),
        st.sampled_from([1e-3, -1e-3, 0.05]),
    ),
    1e-4,
    share=0.5,
    examples=[(CUBOIDS, (0.0, 0.0, 0.0), 1, 0.05)],
)
def models_anywhere(deck: Deck, shift: tuple, turn: int, skew: float, within: float) -> None:
    """A model of COMPAS at any place, across x or y, is the same section; a block that is no prism is refused by its name. Cuboids above
    each other have a section across each axis, of which the program says that it takes that across y."""
    turn = turn if deck["structure"]["kind"] in ("arch", "brickwork") else 0
    one = ask(drawn(deck), "tilt")  # an export has chords in place of arcs
    text = extrados.export({**deck, "analysis": [{"kind": "tilt"}]}, "compas")
    with tempfile.TemporaryDirectory() as name:
        there = {**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}}
        (Path(name) / "stones.json").write_text(moved_model(text, list(shift), turn, 0.0, 8e-7))
        back = ask(there, "tilt", Path(name))
        (Path(name) / "stones.json").write_text(moved_model(text, list(shift), turn, skew))
        try:
            other = ask(there, "tilt", Path(name))
            must(deck["structure"]["kind"] != "arch" or other.status != "ok", f"a block that is no prism: {other.capacity}")
        except DeckError:
            pass
    ok(one)
    must(back.answers, f"read back: {back.outcome} {back.said}")
    capacities = [one.capacity, one.capacity[::-1]]
    must(any(np.allclose(back.capacity, c, rtol=within, atol=within) for c in capacities), f"{one.capacity}, read back {back.capacity}")


def compare_names(answer: Answer) -> None:
    """Arrays, columns of tables and results of one name hold the same numbers."""
    arrays = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    units = {k: v.unit for k, v in answer.result.arrays.items()}
    for title, table in answer.result.tables.items():
        for name, column in table.columns.items():
            there, values = arrays.get(name), np.asarray(column)
            if there is not None and there.ndim == 1 and there.shape == values.shape and there.dtype.kind == "f" == values.dtype.kind:
                near(f"{answer.result.kind}: {title}.{name}", there, values, 1e-9, 1e-12)
    for name, value in vars(answer.results).items():
        stem, _, unit = name.rpartition("_")
        there = arrays.get(name, arrays.get(stem))
        if there is None or not isinstance(value, list) or there.ndim != 1 or len(value) != len(there):
            continue
        if all(v is None or isinstance(v, float) for v in value) and there.dtype.kind == "f":
            factor = GRAVITY if unit == "g" and units.get(stem) == "m/s^2" else 1.0
            want = np.array([np.nan if v is None else v * factor for v in value])
            near(f"{answer.result.kind}: {name}", there, want, 1e-9, 1e-12)
    interval = getattr(answer.results, "confidence_interval", None)
    if isinstance(interval, list) and interval and isinstance(interval[0], list | tuple) and {"lower", "upper"} <= set(arrays):
        near("interval", np.column_stack([arrays["lower"], arrays["upper"]]), np.array(interval, dtype=float), 1e-9, 1e-12)
        must(bool((arrays["lower"] <= arrays["upper"] + 1e-12).all()), "an interval is turned")


@relation(
    "rocking tilt thrust moving-load supports failure-domain fragility local-mechanism", st.integers(0, len(EFFECTS) - 1), 0.0, share=0.5
)
def arrays_tables_and_results_of_one_name(k: int, within: float) -> None:
    """Values of one name in arrays, tables and results are the same, with any one key of an analysis changed."""
    deck, kind, keys, changes = EFFECTS[k]
    for key in [None, *list(changes)[:6], *(c for c in ("durations", "levels", "histories") if c in changes)]:
        answer = ask(deck, kind, **{**keys, **({} if key is None else {key.split()[0]: changes[key]})})
        if answer.answers:
            compare_names(answer)


#: Tables, the key, and its last value that is accepted; the sign of what is beyond
LIMITS: tuple[tuple[Deck, str, str, float, float], ...] = (
    (
        {"material": {"tensile_strength": 2e5, "tensile_strength_parallel": 8e5, "fracture_energy": 50.0}},
        "material",
        "shear_strength",
        4e5,
        1.0,
    ),
    (
        {"material": {"tensile_strength": 3e5, "tensile_strength_parallel": 3e5, "fracture_energy": 50.0}},
        "material",
        "shear_strength",
        3e5,
        1.0,
    ),
    ({}, "joints", "friction", 10.0, 1.0),
    ({"motion": {"kind": "generated", "mmi": 6, "duration": 2.0}}, "motion", "lines", 2, -1.0),
    ({"motion": {"kind": "generated", "mmi": 6, "duration": 2.0}}, "motion", "lines", 2000, 1.0),
)


@relation("tilt", st.sampled_from(LIMITS), 0.0, share=0.3)
def limits_of_keys(tables: Deck, table: str, key: str, last: float, sign: float, within: float) -> None:
    """A value at the limit of a key is accepted, one beyond it is refused by a text that names the key."""
    base = {
        "structure": {"kind": "arch", "radius": 5.0, "thickness": 1.0, "embrace": 120.0, "voussoirs": 9},
        "analysis": [{"kind": "tilt"}],
    }
    base = changed(base, **tables)
    step = 1 if isinstance(last, int) else 1e-4 * abs(last)
    for value, good in ((last, True), (last - type(last)(sign * step), True), (last + type(last)(sign * step), False)):
        try:
            make_deck(changed(base, **{table: {key: value}}))
            must(good, f"{table}.{key} = {value} is accepted")
        except DeckError as error:
            must(not good and key in str(error), f"{table}.{key} = {value}: {error}")


@relation("fragility", st.tuples(decks("block", "column"), st.integers(1, 3), number(0.2, 0.6)), 0.0, share=0.5)
def motions_that_cannot_be_used_are_named(deck: Deck, zeros: int, amplitude: float, within: float) -> None:
    """Of records that are zero, the ensemble counts the others, and names each with its reason in full; it gives the shares of the others alone."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = []
        for k in range(zeros + 2):
            values = wave(0.0 if k < zeros else amplitude * (1.0 + k), 0.4, 2)
            rows = [f"{i * STEP:.6f},{v:.12g}" for i, v in enumerate(values)]
            (folder / f"r{k}.csv").write_text("time_s,acceleration_g\n" + "\n".join(rows) + "\n")
            files.append(f"r{k}.csv")
        every = ask({**deck, "motion": {"kind": "suite", "files": files}}, "fragility", folder, bootstrap=0, levels=[0.3, 0.8])
        good = ask({**deck, "motion": {"kind": "suite", "files": files[zeros:]}}, "fragility", folder, bootstrap=0, levels=[0.3, 0.8])
    if every.status == "refused":
        must("zero" in every.said, every.said)
        return
    ok(every, good)
    for k in range(zeros):
        must(f"r{k} has no result: r{k}.csv: the peak is 0 g with the unit 'g': below 0.0001 g" in every.warnings, every.warnings)
    must(every.results.failed == 2 * zeros, f"{every.results.failed} of {zeros} motions without acceleration")
    near("shares", every.results.collapse_probability, good.results.collapse_probability, 1e-9)


SECTIONED = questions("tilt", "thrust", "moving-load", "rocking", "failure-domain", "local-mechanism", "supports")


def deeper(deck: Deck, factor: float) -> Deck:
    """A drawn deck with its depth and all its forces times a factor."""
    made = changed(deck, structure={"depth": deck["structure"].get("depth", 1.0) * factor})
    for tie in made.get("ties", []):
        tie |= {k: tie[k] * factor for k in ("stiffness", "yield_force") if k in tie}
    return made


def per_depth(unit: str, factor: float) -> float:
    """What a number of a unit is multiplied by in a section that is so many times as deep: mass and force, but none per area or length of it."""
    length, mass, time = dimension(unit)
    return factor if mass > 0 and (length > 0 or time == 0) else 1.0


@relation(
    "tilt thrust moving-load rocking failure-domain local-mechanism supports", st.tuples(SECTIONED, number(0.4, 3.0), st.booleans()), 2e-5
)
def a_deeper_section_is_as_many_slices(question: tuple, factor: float, crushable: bool, within: float) -> None:
    """With depth and forces times a factor, forces, masses and energies go as the factor, and lengths, accelerations and times remain."""
    deck, kind, table = question
    if "depth" not in deck["structure"]:
        reject()
    if crushable:
        deck = changed(deck, material={"compressive_strength": 4e6})
    more = {k: [f * factor for f in v] if k == "axle_loads" else v * factor if k == "force" else v for k, v in table.items()}
    if kind == "moving-load" and "axle_loads" not in table:
        table, more = {**table, "axle_loads": [2e4]}, {**more, "axle_loads": [2e4 * factor]}
    one, other = ask(deck, kind, **table), ask(deeper(deck, factor), kind, **more)
    same("deeper", one, other)
    ok(one, other)
    a, b = numbers(one), numbers(other)
    must(set(a) == set(b), f"other results: {sorted(set(a) ^ set(b))[:8]}")
    loose = 50.0 if kind == "failure-domain" else 1.0
    for name, (unit, value) in a.items():
        if isinstance(value, float | np.ndarray) and "depth" not in name and "intercept" not in name:
            x, y = np.asarray(value, dtype=float) * per_depth(unit, factor), np.asarray(b[name][1], dtype=float)
            if x.shape == y.shape:
                scale = float(np.abs(x[np.isfinite(x)]).max(initial=0.0))
                near(f"{kind} {name} [{unit}]", x, y, within * loose, max(scale, 1e-3 if unit == "rad" else 1e-9 * abs(factor)))


@relation("moving-load", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(2.0, 8.0), number(0.5, 2.0)), 1e-5)
def zones_of_thrust_carry_their_forces(deck: Deck, strength: float, depth: float, within: float) -> None:
    """The zone of thrust at a joint is about the thrust line, as wide as its compression needs at the strength over the depth."""
    deck = changed(deck, structure={"depth": depth}, material={"compressive_strength": strength * 1e6})
    answer = ask(deck, "moving-load", count=5, axle_loads=[1e4], axles=[0.0])
    ok(answer)
    a = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    middle, width = 0.5 * (a["zone_inner"] + a["zone_outer"]), np.linalg.norm(a["zone_outer"] - a["zone_inner"], axis=1)
    same_ = [k for k in a if k.endswith("_point") and a[k].shape == middle.shape and np.allclose(a[k], middle, atol=1e-6, equal_nan=True)]
    must(bool(same_), f"the zone is about no thrust line: {sorted(k for k in a if k.endswith('_point'))}")
    normal = a["envelope_normal"][int(np.abs(a["place"] - answer.results.worst_place_m).argmin())]
    near("zone", width * depth * strength * 1e6, normal, within, float(np.nanmax(np.abs(normal))))


@relation(
    "moving-load", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), st.integers(5, 9), st.booleans(), number(0.1, 0.6)), 1e-5
)
def places_of_a_train(deck: Deck, count: int, both: bool, apart: float, within: float) -> None:
    """Places of a train go evenly from the first axle on the one end to the last on the other, with more beside the lowest factors; each
    by itself has the same factor; the least governs."""
    table = {"axle_loads": [2e4, 3e4], "axles": [0.0, apart], "both_ways": both}
    answer = ask(deck, "moving-load", count=count, **table)
    ok(answer)
    a = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    ahead = a["place"][: 1 + int(np.argmax(a["place"]))]
    steps = np.diff(ahead)
    even = np.linspace(ahead[0], ahead[-1], 1 + round(float((ahead[-1] - ahead[0]) / steps.max())))
    near("even places", np.array([ahead[np.abs(ahead - x).argmin()] for x in even]), even, 1e-6, 1.0)
    must(len(ahead) > count and steps.max() > 7.0 * steps.min(), f"{count} places are asked, and no interval is halved: {ahead}")
    if both:
        near("back", a["place"][len(ahead) :][[0, -1]], (ahead[0] + ahead[-1] - apart) - ahead[[0, -1]], 1e-6, 1.0)
    k = len(ahead) // 2
    alone = ask(deck, "moving-load", places=[float(ahead[k])], **{**table, "both_ways": False})
    ok(alone)
    near("one place", np.asarray(alone.result.arrays["capacity"].data)[0], a["capacity"][k], within)
    least = int(np.nanargmin(a["capacity"]))
    near("worst place", a["capacity"][least], np.asarray(a["capacity"])[np.abs(a["place"] - answer.results.worst_place_m).argmin()], within)


@relation(
    "moving-load", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(0.2, 3.0), number(2.0, 9.0), st.booleans()), 1e-5
)
def even_loads_without_axles(deck: Deck, share: float, far: float, adverse: bool, within: float) -> None:
    """An even load has its load on the span at every place, and a second one far behind crosses as it does."""
    tilted = ask(deck, "tilt")
    ok(tilted)
    x = np.asarray(tilted.result.arrays["outline"].data)[:, 0]
    stretch, behind = share * float(np.ptp(x)), (share + far) * float(np.ptp(x))
    one, other = ({"load": 2e4, "start": start, "stop": start + stretch} for start in (0.0, behind))
    alone, both = (ask(deck, "moving-load", count=5, axles=[], adverse=adverse, uniform=loads) for loads in ([one], [one, other]))
    ok(alone, both)
    place = np.asarray(alone.result.arrays["place"].data)
    must(bool(((place > x.min()) & (place - stretch < x.max())).all()), f"a place without load: {place}")
    near("factor", alone.results.adequacy_factor, both.results.adequacy_factor, within)
    at_most("factor", alone.results.adequacy_factor, 1e6, within)


@relation("failure-domain", st.tuples(number(1.0, 6.0), st.sampled_from(["step", "sine"])), 2e-3, share=0.3)
def durations_that_are_not_given(radius: float, pulse: str, within: float) -> None:
    """Without durations an arch is tried by those of its natural time: four times as large, twice as long, at the same amplitudes."""
    found = []
    for size in (radius, 4.0 * radius):
        deck = {"structure": {"kind": "arch", "radius": size, "thickness": 0.15 * size, "embrace": 157.5, "voussoirs": 7}}
        found.append(ask(deck, "failure-domain", pulse=pulse, amplitudes=2, accuracy=0.05, hand_over_cells=0))
    ok(*found)
    one, other = (np.asarray(f.result.arrays["duration"].data) for f in found)
    must(len(one) > 2, f"durations {one}")
    high = {"step": 1.0, "sine": 2.4}[pulse]
    unit = math.sqrt(radius / GRAVITY)
    near("durations", [one[0], one[-1]], [0.1 * high * unit, high * unit], within)
    near("durations", 2.0 * one, other, within)


@relation("local-mechanism", st.tuples(decks("arch", "column", "brickwork", "pointed-arch", "blocks", "stack"), number(0.02, 0.08)), 1e-9)
def heights_of_mechanisms(deck: Deck, lean: float, within: float) -> None:
    """A mechanism some blocks of which rest on the ground is at the ground, however the others hinge above; any other is not."""
    bare = leaning(deck, lean)
    answer = ask(bare, "local-mechanism", mechanism="building")
    ok(answer)
    ground = np.array(bare["structure"]["ground"], dtype=float)
    base = float(ground[:, [1, 3]].min())
    tilt = ask(bare, "tilt")
    ok(tilt)
    if not tilt.capacity[0] < 0.999 * tilt.capacity[1] or abs(answer.results.multiplier - tilt.capacity[0]) > 1e-6:
        reject()  # the mechanism to the other side, or either, or where joints slide that of the state without dilatancy is judged
    arrays = {k: np.asarray(v.data) for k, v in tilt.result.arrays.items()}
    speed = np.abs(arrays["velocity"]).max(axis=1)
    moving = [str(b) for b, v in zip(arrays["block_name"], speed, strict=True) if v > 1e-6 * speed.max()]
    points = {b["name"]: np.array(b["points"], dtype=float) for b in bare["structure"]["block"]}
    on = [b for b in moving if points[b][:, 1].min() < base + 1e-9]
    must((answer.results.base_height_m == 0.0) == bool(on), f"z {answer.results.base_height_m}, on the ground {on}")
