"""What is conserved and what closed forms say: masses, centres and inertias, multipliers of one body, tables and arrays."""

import itertools
import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Answer, Deck, ask, at_most, must, near, same
from buildings import SECTIONS, SOLIDS, changed, decks, drawn, number, pulses, signed_area
from hypothesis import reject
from hypothesis import strategies as st
from relations import EARTHQUAKES, GRAVITY, RECTANGLES, WEAK_SET, ok, recorded, relation

from extrados import kinds
from extrados.decks.reader import make_deck
from extrados.views.building import Building


def building(deck: Deck) -> Building:
    """The building of a deck."""
    return make_deck({**deck, "analysis": [{"kind": "tilt"}]}).building


#: Kinds whose thickness is called depth
DEEP = tuple(k for k in SECTIONS if "depth" in kinds.table("structure", k).model_fields and k not in ("blocks", "bridge"))


@relation("tilt", st.tuples(decks(*DEEP), number(0.2, 3.0), number(500.0, 3000.0)), 5e-3)
def blocks_hold_what_their_outlines_do(deck: Deck, depth: float, density: float, within: float) -> None:
    """Mass, centre and moment of inertia of each block are those of its outline, depth and density."""
    there = changed(deck, structure={"depth": depth}, material={"density": density})
    stones = building(there).blocks()
    for k, outline in enumerate(stones.outlines):
        area, centre, second = moments(outline)
        size = math.sqrt(area)
        near("mass", stones.mass[k], density * depth * area, within)
        near("centre", stones.centroid[k], centre, within, size)
        near("inertia", stones.inertia[k], density * depth * second, 4.0 * within)
    total = density * depth * sum(abs(signed_area(o)) for o in stones.outlines)
    answer, line = ask(there, "tilt"), ask(there, "thrust")
    ok(answer)
    near("weight", answer.results.weight_N, total * GRAVITY, within)
    if line.answers:
        near("depth", line.results.depth_m, depth, 1e-9)


def moments(outline: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Area [m^2], centre [m] and polar second moment about it [m^4] of a polygon (n, 2)."""
    x, y = (outline - outline[0]).T
    u, v = np.roll(x, -1), np.roll(y, -1)
    cross = x * v - u * y
    area = 0.5 * cross.sum()
    centre = np.array([cross @ (x + u), cross @ (y + v)]) / (6.0 * area)
    second = cross @ (x * x + x * u + u * u + y * y + y * v + v * v) / 12.0
    return abs(float(area)), centre + outline[0], abs(float(second)) - abs(float(area)) * float(centre @ centre)


@st.composite
def barrels(draw: st.DrawFn) -> Deck:
    """Arches as barrels in space, of stones across their depth and skew in plan."""
    deck = draw(decks("arch"))
    return changed(
        deck,
        structure={
            "depth": draw(number(0.5, 3.0)),
            "voussoirs": draw(st.integers(5, 9)),
            "stones_across": draw(st.integers(1, 3)),
            "skew": draw(number(-40.0, 40.0, 8)),
        },
    )


@relation("tilt", st.one_of(barrels(), decks(*SOLIDS)), 5e-3)
def solids_hold_what_their_parts_do(deck: Deck, within: float) -> None:
    """Mass, centre and tensor of inertia of each stone in space are those of its parts."""
    there = changed(deck, material={"density": 1800.0})
    stones = building(there).solids()
    for k in range(len(stones.mass)):
        volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
        for part in itertools.compress(stones.parts, stones.owner == k):
            corner = part.vertices[part.triangles]
            share = np.linalg.det(corner) / 6.0  # of tetrahedra from the origin
            whole = corner.sum(axis=1)
            volume += share.sum()
            first += share @ whole / 4.0
            second += (
                np.einsum("t,tij->ij", share, (np.einsum("tki,tkj->tij", corner, corner) + np.einsum("ti,tj->tij", whole, whole))) / 20.0
            )
        centre = first / volume
        about = second - volume * np.outer(centre, centre)
        inertia = 1800.0 * (np.trace(about) * np.eye(3) - about)
        near("mass", stones.mass[k], 1800.0 * volume, within)
        near("centre", stones.centroid[k], centre, within, volume ** (1 / 3))
        near("inertia", stones.inertia[k], inertia, 4.0 * within, np.trace(inertia))


@relation("tilt", st.tuples(barrels(), number(0.2, 8.0), number(0.5, 30.0), number(0.2, 20.0)), 1e-5, share=0.5)
def strength_of_barrels(deck: Deck, crush: float, cohesion: float, tension: float, within: float) -> None:
    """Along its span a barrel with crushing has the capacity of its section with crushing; ductile mortar raises the capacity, crushing reduces it."""
    crushing = {"compressive_strength": 1e6 * crush}
    square, section = changed(deck, structure={"skew": 0.0}), changed(deck, structure={"skew": 0.0, "stones_across": 1})
    keys: Deck = {"direction": 0.0, "rose": 4, "starts": 1, "face_law": False}
    plane, space = ask(changed(section, material=crushing), "tilt"), ask(changed(square, material=crushing), "tilt", **keys)
    same("crushing", plane, space)
    ok(plane, space)
    near("crushing", plane.capacity, space.capacity, within, 1e-2)
    glued = changed(square, joints={"cohesion": 1e3 * cohesion, "tension": 1e3 * tension})
    mortar, both = (ask(one, "tilt", mortar="ductile", **keys) for one in (glued, changed(glued, material=crushing)))
    ok(mortar, both)
    at_most("crushing", space.capacity, both.capacity, within, 1e-2)
    at_most("mortar that crushes", both.capacity, mortar.capacity, within, 1e-2)
    dry = ask(square, "tilt", **keys)
    near("without mortar", mortar.results.collapse_acceleration_dry_g, dry.capacity[0], within, 1e-2)


@relation("tilt", barrels(), 1e-5, share=0.5)
def barrels_and_their_sections(deck: Deck, within: float) -> None:
    """Along its span a barrel of any bond has the capacity of its section; the capacity of a skew barrel is no greater."""
    square, section = changed(deck, structure={"skew": 0.0}), changed(deck, structure={"skew": 0.0, "stones_across": 1})
    plane, space, skew = (ask(section, "tilt"), *(ask(d, "tilt", direction=0.0, rose=4, starts=1) for d in (square, deck)))
    same("in space", plane, space)
    ok(plane, space)
    near("in space", plane.capacity, space.capacity, within, 1e-3)
    near("weight", plane.results.weight_N, space.results.weight_N, within)
    must(skew.outcome in (plane.outcome, "cannot-stand"), f"skew: {skew.outcome} ({skew.said})")
    at_most("skew", skew.capacity, plane.capacity, within, 1e-3)


@st.composite
def facades(draw: st.DrawFn) -> Deck:
    """Tables of a wall that turns out of its plane, with all that rests on it, pushes it or holds it."""
    height = draw(number(2.0, 8.0))
    table: Deck = {
        "mechanism": "facade",
        "thickness": draw(number(0.2, 1.0)),
        "height": height,
        "width": draw(number(0.5, 5.0)),
        "hinge_height": draw(st.sampled_from([0.0, 0.5])),
    }
    if draw(st.booleans()):
        table["side_walls"] = {
            "thickness": draw(number(0.2, 0.6)),
            "crack_angle": draw(number(5.0, 40.0, 7)),
            "count": draw(st.integers(1, 2)),
        }
    levels = number(1.0, height, 20)
    table["floors"] = [
        {
            "height": draw(levels),
            "load": draw(number(0.0, 3e4)),
            "pushing": draw(number(0.0, 2e4)),
            "thrust": draw(st.sampled_from([0.0, 200.0])),
            "sways": draw(st.booleans()),
            **({"arm": draw(number(0.05, 0.2))} if draw(st.booleans()) else {}),
        }
        for _ in range(draw(st.integers(0, 2)))
    ]
    table["ties"] = [{"height": draw(levels), "force": draw(number(10.0, 3e3))} for _ in range(draw(st.integers(0, 1)))]
    return table


@relation("local-mechanism", facades(), 1e-6)
def walls_by_virtual_work(table: Deck, within: float) -> None:
    """alpha_0 and e* of one wall about its hinge are the sums of moments and masses by hand."""
    t, hinge = table["thickness"], table["hinge_height"]
    h, density = table["height"] - hinge, 1900.0
    wall = density * GRAVITY * t * h * table["width"]
    rows = [(wall, 0.5 * t, 0.5 * h, True, True)]  # weight, arm, height, sways, rests
    if side := table.get("side_walls"):
        length = h * math.tan(math.radians(side["crack_angle"]))
        wedge = side["count"] * density * GRAVITY * side["thickness"] * 0.5 * h * length
        rows.append((wedge, t + length / 3.0, 2.0 / 3.0 * h, True, True))
    outward = 0.0
    for floor in table["floors"]:
        level = floor["height"] - hinge
        rows.append((floor["load"], floor.get("arm", 0.5 * t), level, floor["sways"], True))
        rows.append((floor["pushing"], 0.0, level, True, False))
        outward += floor["thrust"] * level
    held = sum(tie["force"] * (tie["height"] - hinge) for tie in table["ties"])
    back = sum(w * arm for w, arm, _, _, rests in rows if rests)
    sway = [(w, level) for w, _, level, sways, _ in rows if sways]
    drive = sum(w * level for w, level in sway)
    if back - outward <= 0.0:
        reject()
    answer = ask({"material": {"density": density}}, "local-mechanism", **table, confidence_factor=1.2)
    ok(answer)
    r = answer.results
    near("alpha_0", r.multiplier, (back + held - outward) / drive, within)
    part = drive**2 / (sum(w for w, _ in sway) * sum(w * level**2 for w, level in sway))
    near("e*", r.participating_part, part, within)
    near("weight", r.swaying_weight_N, sum(w for w, _ in sway), within)
    near("M*", r.participating_mass_kg, part * sum(w for w, _ in sway) / GRAVITY, within)
    near("a_0*", r.activation_acceleration_g, r.multiplier / part / 1.2, within)


TIES = st.tuples(RECTANGLES, number(0.3, 1.0), number(0.01, 0.5), st.sampled_from([-1.0, 1.0]))


@relation("rocking tilt", TIES, 1e-5)
def ties_by_rocking_and_limit_analysis(size: tuple, level: float, force: float, side: float, within: float) -> None:
    """A block with a prestressed tie begins to rock at the acceleration of limit analysis with the force of the tie."""
    width, height = size
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": "no-sliding"}}
    weight = 2000.0 * width * height * GRAVITY
    middle = 0.5 * width if min(p[0] for p in building(deck).blocks().outlines[0]) >= 0.0 else 0.0
    y = round(level * height, 4)
    pull = round(force * 0.5 * width * weight / y, 3)  # of the moment that its weight resists by
    tie = {"start": [middle, y], "ground": [middle + side * (width + 3.0), y], "works_in": "tension", "yield_force": pull}
    held = {**deck, "ties": [{**tie, "stiffness": 1e6, "prestress": pull}]}
    limit = ask({**deck, "ties": [tie]}, "tilt")
    rocks = ask(changed(held, motion={"kind": "sine-pulse", "amplitude": "0.3 g", "period": 0.5}), "rocking", end_time=1.0)
    ok(limit, rocks)
    moment = weight * 0.5 * width
    near("limit analysis", sorted(limit.capacity), [width / height, (moment + pull * y) / (0.5 * height * weight)], 1e-5)
    near("rocking", rocks.results.uplift_acceleration_g, (moment - pull * y) / (0.5 * height * weight), within)
    for wall, away in (("left", 1.0), ("right", -1.0)):
        beside = ask(
            changed(
                held, motion={"kind": "sine-pulse", "amplitude": "0.3 g", "period": 0.5}, supports={"abutting_wall": wall, "rebound": 0.0}
            ),
            "rocking",
            end_time=1.0,
        )
        ok(beside)
        want = (moment - side * away * pull * y) / (0.5 * height * weight)
        near(f"a wall to the {wall}", beside.results.uplift_acceleration_g, want, within)


#: Analyses whose tables and arrays are compared, with a motion
TOLD: dict[str, dict[str, Any]] = {
    "rocking": {},
    "dem": {"end_time": 0.5, "solver": "nonsmooth"},
    "tilt": {},
    "thrust": {},
    "fragility": {"count": 4, "bootstrap": 0},
    "failure-domain": {"durations": [0.3, 0.6], "amplitudes": 3, "accuracy": 0.05},
    "local-mechanism": {"mechanism": "building"},
    "moving-load": {"count": 5},
    "supports": {"steps": 10},
    "sla": {"events": 10},
    "motion": {},
}


@relation(
    " ".join(TOLD),
    st.tuples(decks("block", "stack", "arch", "column", "brickwork"), pulses(0.1, 1.0), st.sampled_from(sorted(TOLD))),
    1e-12,
)
def tables_and_arrays(deck: Deck, motion: Deck, kind: str, within: float) -> None:
    """Columns of one table have one length, and are the arrays of their names; peaks are those of histories."""
    whole = changed(deck, motion=WEAK_SET | {"mmi": 9} if kind == "fragility" else motion)
    answer = ask(whole, kind, **TOLD[kind])
    ok(answer)
    arrays = answer.result.arrays
    for name, table in answer.result.tables.items():
        must(len({len(c) for c in table.columns.values()}) <= 1, f"{name}: columns of {[len(c) for c in table.columns.values()]}")
        for column, values in table.columns.items():
            values = np.asarray(values)
            if column in arrays and values.dtype.kind == "f" and np.shape(arrays[column].data) == values.shape:
                near(f"{name}.{column}", np.asarray(arrays[column].data), values, within)
    _peaks(answer, kind, deck["structure"]["kind"])


def _peaks(answer: Answer, kind: str, structure: str) -> None:
    """The peaks of histories of rocking."""
    if kind != "rocking":
        return
    r, arrays = answer.results, answer.result.arrays
    time, rotation = (np.asarray(arrays[k].data) for k in ("time", "rotation"))
    must(bool(np.all(np.diff(time) >= 0.0)), "times that go back")
    at_most("peak rotation", np.abs(rotation).max(initial=0.0), abs(r.peak_rotation_rad), 1e-6, 1e-9)
    ratio = np.abs(rotation).max(initial=0.0) / r.critical_rotation_rad
    at_most("peak over the critical rotation", ratio, r.peak_rotation_ratio, 1e-6, 1e-9)
    if structure == "stack":
        upper = np.abs(np.asarray(arrays["rotation_upper"].data) - rotation).max(initial=0.0)
        at_most("the upper block", upper / r.stack.critical_rotation_upper_rad, r.peak_rotation_ratio, 1e-6, 1e-9)
    else:
        near("peak over the critical rotation", abs(r.peak_rotation_rad) / r.critical_rotation_rad, abs(r.peak_rotation_ratio), 1e-6, 1e-9)


LOADED = st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(0.2, 0.8), number(1.0, 3.0), st.sampled_from([False, True]))


@relation(
    "moving-load",
    LOADED,
    1e-5,
    share=0.5,
    examples=(
        (
            {"structure": {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 5}, "joints": {"friction": 0.7}},
            0.3,
            2.0,
            False,
        ),
        (
            {
                "structure": {"kind": "arch", "radius": 4.41, "thickness": 1.376, "embrace": 165.0, "voussoirs": 14},
                "joints": {"friction": 0.6},
            },
            0.29,
            1.61,
            False,
        ),
    ),
)
def even_loads_where_they_are_adverse(deck: Deck, share: float, factor: float, both: bool, within: float) -> None:
    """A uniform load on its adverse length gives no greater factor than on any other length."""
    outlines = building(deck).blocks().outlines
    low, high = (f(float(getattr(o[:, 0], end)()) for o in outlines) for f, end in ((min, "min"), (max, "max")))
    span = high - low
    place = round(low + share * span, 4)
    weight = float(building(deck).blocks().mass.sum()) * GRAVITY

    def asked(stretches: list[tuple[float, float]], **keys: Any) -> Answer:
        even = [{"load": weight / span, "start": round(place - b, 6), "stop": round(place - a, 6)} for a, b in stretches]
        return ask(deck, "moving-load", axle_loads=[0.2 * weight], uniform=even, places=[place], **keys)

    found = asked([(low - span, high + span)], both_ways=both)
    ok(found)
    heavier = ask(
        deck, "moving-load", axle_loads=[0.2 * weight * factor], uniform=[{"load": weight / span * factor}], places=[place], both_ways=both
    )
    near("in proportion", found.results.adequacy_factor, heavier.results.adequacy_factor * factor, 1e-4)
    chosen = np.asarray(found.result.arrays["even_load"].data)
    steps = (0.0, -0.02 * span, 0.02 * span)
    if len(chosen) == 1:
        first, last = chosen[0]
        for da, db in itertools.product(steps, steps):
            if last + db - first - da > 0.01 * span and (part := asked([(first + da, last + db)], adverse=False)).answers:
                at_most(f"shifted by {da:.3g} and {db:.3g} m", found.results.adequacy_factor, part.results.adequacy_factor, 2e-4)
                if da == db == 0.0:
                    near("on the stretch that is named", found.results.adequacy_factor, part.results.adequacy_factor, 5e-3)


@relation("moving-load", st.tuples(decks("arch", "elliptical-arch"), number(1.0, 8.0), number(1.0, 4.0), number(1.0, 1.4)), 1e-5)
def partial_factors_are_properties(deck: Deck, pressure: float, strength: float, friction: float, within: float) -> None:
    """A partial factor under strength or friction is a lower strength or friction. pressure: strength over the mean stress at rest."""
    stones = building(deck).blocks()
    least = float(stones.mass.sum()) * GRAVITY / (2.0 * stones.depth * stones.length.min())
    crushing = pressure * strength * least
    mu = deck["joints"]["friction"]
    one = ask(
        changed(deck, material={"compressive_strength": crushing}),
        "moving-load",
        count=3,
        factors={"strength": strength, "friction": friction},
    )
    other = ask(
        changed(deck, material={"compressive_strength": crushing / strength}, joints={"friction": mu / friction}), "moving-load", count=3
    )
    same("factored", one, other)
    ok(one, other)
    near("factored", one.results.collapse_load_N, other.results.collapse_load_N, within)


NAMES = st.text("abcxyz", min_size=3, max_size=8).map(lambda s: f"no-{s}")


@relation("tilt", st.tuples(decks("brickwork", "arch", "column", "blocks"), NAMES), 0.0)
def what_is_not_there_is_named(deck: Deck, name: str, within: float) -> None:
    """A name of a joint or block that does not exist is refused, and the message gives the name."""
    for tables in (
        {"joints": {"types": [{"joints": [name], "friction": 0.3}]}},
        {"ties": [{"start": [0.0, 0.1], "start_stone": name, "ground": [-9.0, 0.1]}]},
    ):
        answer = ask(changed(deck, **tables), "tilt")
        must(answer.status == "refused" and name in answer.said, f"{answer.status}: {answer.said}")


@relation("tilt", st.tuples(number(0.3, 2.0), number(0.2, 1.0), number(0.02, 0.5), number(-50.0, 50.0)), 1e-2)
def gaps_are_measured(width: float, height: float, gap: float, shift: float, within: float) -> None:
    """A block without contact is refused with the size of the gap, for any origin of the survey."""
    rows = [(0.0, height), (height + gap, 2.0 * height + gap)]
    blocks = [
        {"name": f"s{k}", "points": [[shift + x, shift + y] for x, y in ((0.0, low), (width, low), (width, high), (0.0, high))]}
        for k, (low, high) in enumerate(rows)
    ]
    ground = [[shift - 1.0, shift, shift + width + 1.0, shift]]
    answer = ask({"structure": {"kind": "blocks", "block": blocks, "ground": ground}}, "tilt")
    must(answer.status == "refused", answer.status)
    found = [float(w.strip(",;:()")) for w in answer.said.split() if w.strip(",;:()").replace(".", "", 1).replace("e-", "", 1).isdigit()]
    must(any(abs(v - scale * gap) <= within * scale * gap for v in found for scale in (1.0, 1e3)), f"a gap of {gap}: {answer.said}")


COMPATIBLE = st.tuples(number(0.1, 0.6), st.integers(1, 10**6)).map(
    lambda t: {
        "kind": "compatible",
        "code": "EN1998-1",
        "ground": "C",
        "acceleration": f"{t[0]:g} g",
        "duration": 3.0,
        "shortest": 0.1,
        "longest": 0.8,
        "tolerance": 0.4,
        "seed": t[1],
    }
)


@relation("fragility rocking", st.tuples(decks("block"), COMPATIBLE, EARTHQUAKES), 1e-6, share=0.5)
def members_of_a_set(deck: Deck, compatible: Deck, generated: Deck, within: float) -> None:
    """Each row of an ensemble is the single run of that member of the set."""
    for motion in (compatible, generated):
        whole = ask(changed(deck, motion=motion), "fragility", count=3, bootstrap=0)
        ok(whole)
        columns = whole.result.tables["ensemble"].columns
        for k in range(3):
            alone = ask(changed(deck, motion={**motion, "member": k + 1}), "rocking")
            ok(alone)
            r = alone.results
            near("peak ground acceleration", columns["pga"][k], r.peak_ground_acceleration_g, within)
            if r.decided_by_last_digits:
                continue
            must(columns["outcome"][k] == r.outcome, f"member {k + 1}: {columns['outcome'][k]} against {r.outcome}")
            if r.outcome == "recovery":
                near("peak rotation", columns["peak_ratio"][k], abs(r.peak_rotation_ratio), 1e-3, 1e-3)


@relation("local-mechanism tilt", decks("block", "column", "brickwork", "stack", friction=number(0.1, 0.3)), 1e-4)
def codes_where_joints_slide(deck: Deck, within: float) -> None:
    """alpha_0 of a section whose joints slide first equals the collapse acceleration of limit analysis with friction."""
    codes, limit = ask(deck, "local-mechanism", mechanism="building"), ask(deck, "tilt")
    same("codes", codes, limit) if "cannot-stand" in (codes.outcome, limit.outcome) else ok(codes, limit)
    ok(codes, limit)
    near("alpha_0", codes.results.multiplier, limit.capacity.min(), within)


@relation(
    "rocking",
    st.tuples(decks("stack", "block", "arch", "column"), pulses(0.3, 1.2)),
    1e-6,
    examples=(
        (
            {"structure": {"kind": "stack", "lower_width": 0.8, "lower_height": 1.0, "upper_width": 0.4, "upper_height": 1.6}},
            {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 0.5},
        ),
        (
            {"structure": {"kind": "stack", "lower_width": 0.6, "lower_height": 2.0, "upper_width": 0.6, "upper_height": 0.8}},
            {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 0.5},
        ),
        ({"structure": {"kind": "block", "width": 0.3, "height": 3.0}}, {"kind": "sine-pulse", "amplitude": "0.8 g", "period": 1.2}),
    ),
)
def peaks_are_those_of_histories(deck: Deck, motion: Deck, within: float) -> None:
    """Greatest rotations, over the critical ones too, are no less than those of the history."""
    answer = ask(changed(deck, motion=motion), "rocking")
    ok(answer)
    _peaks(answer, "rocking", deck["structure"]["kind"])
    r = answer.results
    near("peak ground acceleration", r.peak_ground_acceleration_g, float(motion["amplitude"].split()[0]), 1e-2)
    words = answer.result.answer.replace("from which gravity causes collapse", "")
    must(any(w in words for w in ("collapse", "overturn")) == (r.outcome == "collapse"), f"{r.outcome}: {words}")
    must(r.impacts == len(r.impact_times_s or []) or deck["structure"]["kind"] != "stack", f"{r.impacts} impacts at {r.impact_times_s}")


@relation("fragility", st.tuples(number(0.2, 0.6), number(1.0, 1.5)), 1e-6, share=0.3)
def a_record_that_cannot_be_read(amplitude: float, frequency: float, within: float) -> None:
    """An unreadable file of a suite is named in the result and at its member; the results of the others do not change."""
    with tempfile.TemporaryDirectory() as name:
        time = np.arange(0.0, 2.0, 0.01)
        recorded(Path(name), 0.01, amplitude * np.sin(2.0 * np.pi * frequency * time))
        (Path(name) / "bad.csv").write_text("no numbers\n")
        deck = {"structure": {"kind": "block", "width": 1.0, "height": 4.0}}
        files = (["motion.csv", "bad.csv"], ["motion.csv"])
        both, one = (ask({**deck, "motion": {"kind": "suite", "files": f}}, "fragility", Path(name), bootstrap=0) for f in files)
    ok(both, one)
    rows = both.result.tables["ensemble"].columns
    must(list(rows["outcome"]) == [*one.result.tables["ensemble"].columns["outcome"], "failed"], f"{list(rows['outcome'])}")
    must("bad.csv" in rows["reason"][1] and not rows["reason"][0] and "bad.csv" in both.warnings, f"{rows.get('reason')}: {both.warnings}")
    must((both.results.collapsed, both.results.uplifted) == (one.results.collapsed, one.results.uplifted), "another count")


@relation(
    "supports thrust rocking local-mechanism",
    st.tuples(decks("arch", "pointed-arch"), pulses(0.2, 0.8), st.randoms(use_true_random=False)),
    1e-5,
    share=0.5,
)
def an_arch_is_its_blocks(deck: Deck, motion: Deck, rng: Any, within: float) -> None:
    """The structure arch and its blocks drawn one by one in any order give the same results."""
    plain = drawn(deck)
    rng.shuffle(plain["structure"]["block"])
    for kind, keys, names in (
        ("supports", {"steps": 40}, ("movement_at_fall_m",)),
        ("thrust", {}, ()),
        ("rocking", {}, ("uplift_acceleration_g", "peak_rotation_ratio", "critical_rotation_rad", "restitution")),
        ("local-mechanism", {"mechanism": "building"}, ("multiplier", "participating_part", "zero_displacement_m")),
    ):
        one, other = (ask(changed(d, motion=motion) if kind == "rocking" else d, kind, **keys) for d in (deck, plain))
        if one.answers != other.answers or not one.answers:
            must(kind not in ("supports", "thrust") or one.outcome == other.outcome, f"{kind}: {one.said} against {other.said}")
            continue
        if kind == "thrust":
            near("least thrust", one.results.least.horizontal_N, other.results.least.horizontal_N, 1e-2)
            near("greatest thrust", one.results.most.horizontal_N, other.results.most.horizontal_N, 1e-2)
        for name in names:
            a, b = getattr(one.results, name), getattr(other.results, name)
            must((a is None) == (b is None), f"{kind}, {name}: {a} against {b}")
            if a is not None:
                near(f"{kind}, {name}", a, b, 0.02, 1e-2)


@relation(
    "tilt", st.tuples(st.integers(3, 6), st.integers(3, 6), st.integers(1, 2), st.sampled_from(["brickwork", "panel"])), 1e-9, share=0.5
)
def openings_at_either_end(units: int, courses: int, wide: int, kind: str, within: float) -> None:
    """A wall with a notch at one end has the weight of the wall with this notch at its other end."""
    length, height = units * 0.5, courses * 0.25
    keys = {"units": units, "courses": courses} if kind == "brickwork" else {"width": length, "height": height, "thickness": 0.25}
    level, size = [0.25, height - 0.25], 0.25 * wide
    wall = {"kind": kind, "unit_length": 0.5, "unit_height": 0.25, **keys}
    masses = [
        float(building({"structure": {**wall, "openings": [{"x": x, "y": level}]}}).blocks().mass.sum())
        for x in ([0.0, size], [length - size, length], [-0.1, size], [length - size, length + 0.1])
    ]
    near("masses", masses, [masses[0]] * 4, within)


@relation("local-mechanism", st.tuples(RECTANGLES, st.booleans()), 0.0, share=0.5)
def dampers_make_an_upper_bound_of_codes(size: tuple, held: bool, within: float) -> None:
    """A damper, which codes neglect, makes their multiplier an upper bound, and a satisfied check is open."""
    width, height = size
    deck: Deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": "no-sliding"}}
    x = float(building(deck).blocks().centroid[0, 0])
    if held:
        deck["dampers"] = [{"start": [x, 0.8 * height], "ground": [x - width - 2.0, 0.8 * height], "damping": 100.0}]
    answer = ask(deck, "local-mechanism", mechanism="building", peak_acceleration="0.001 g")
    ok(answer)
    bound = getattr(answer.results, "bound", None)
    must(bound == ("upper" if held else None), f"bound {bound}")
    must(not held or answer.outcome != "stands", answer.outcome)


@relation(
    "rocking tilt", decks("arch", "pointed-arch", "elliptical-arch", "frame", "column", "brickwork", friction=st.just("no-sliding")), 1e-4
)
def mechanisms_start_at_the_limit(deck: Deck, within: float) -> None:
    """Rocking starts at the lesser collapse acceleration of limit analysis; different values to both sides are no reason for a refusal."""
    limit = ask(deck, "tilt")
    rocks = ask(changed(deck, motion={"kind": "sine-pulse", "amplitude": "0.05 g", "period": 0.5}), "rocking")
    must("limit analysis says" not in rocks.said, rocks.said)
    ok(limit, rocks)
    near("uplift", rocks.results.uplift_acceleration_g, limit.capacity.min(), within)
