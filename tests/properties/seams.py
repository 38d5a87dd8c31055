"""Seams between parts, asked directly: each function against its closed form, its mirror or the same question in the other dimension."""

import itertools
from types import SimpleNamespace
from unittest import mock

import numpy as np
from asking import Deck, ask, at_most, must, near
from buildings import changed, decks, number, signed_area
from conservation import building
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, ok, relation

from extrados.analyses.codes import local_mechanism
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import impact_rules
from extrados.analyses.dem import measures as of_elements
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.solid_model import solid_values
from extrados.analyses.limit.asked import deviation_of
from extrados.decks.reader import make_deck
from extrados.limit.errors import CannotStand, NoAnswer
from extrados.model.errors import NoView
from extrados.model.geometry.contacts import find_contacts, shortest_joint
from extrados.model.geometry.polygons import crossing_edges
from extrados.model.structures.block import make_block
from extrados.model.structures.brickwork import Bond, lintels_of
from extrados.results import dem as states
from extrados.views.rigid import rigid_bodies

# ----- outlines, contacts, solids


def _meet(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> bool:
    """Whether segments a-b and c-d cross at inner points of both, by the shares of them at which their lines meet."""
    lines = np.column_stack([b - a, c - d])
    if abs(np.linalg.det(lines)) < 1e-12:
        return False
    return bool(np.all(np.abs(np.linalg.solve(lines, c - a) - 0.5) < 0.5))


@relation("tilt", st.tuples(st.integers(4, 9), st.integers(0, 10**6), number(-1e3, 1e3)), 0.0)
def edges_that_cross(corners: int, seed: int, far: float, within: float) -> None:
    """Of random outlines two edges cross where their lines meet within both, wherever the outline lies and where it begins."""
    draw = np.random.default_rng(seed)
    angle = np.sort(draw.uniform(0.0, 2.0 * np.pi, corners))
    points = draw.uniform(0.5, 1.5, corners)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])  # simple
    if seed % 2:
        points = points[draw.permutation(corners)]
    edges = [(points[i], points[(i + 1) % corners]) for i in range(corners)]
    pairs = [(i, j) for i, j in itertools.combinations(range(corners), 2) if j - i > 1 and (i, j) != (0, corners - 1)]
    crossed = [(i, j) for i, j in pairs if _meet(*edges[i], *edges[j])]
    found = crossing_edges(points)
    must((found is None) == (not crossed) and (found is None or found in crossed), f"{found} of {crossed}")
    for same in (points + far, np.roll(points, 1, axis=0)):
        must((crossing_edges(same) is None) == (not crossed), "an outline elsewhere crosses itself otherwise")


@relation(
    "tilt", st.tuples(number(0.5, 3.0), number(0.5, 3.0), number(1.2, 4.0), number(-0.4, 0.4), st.sampled_from([0.0, 0.5, 3.0])), 1e-9
)
def gaps_of_two_boxes(width: float, height: float, share: float, aside: float, open_by: float, within: float) -> None:
    """Of two boxes on each other the faces that touch are a joint, those apart a gap of that depth and of the length that they share."""
    tolerance = 1e-4
    gap = open_by * tolerance
    low = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    high = low * [share, 1.0] + [aside * width, height + gap]
    found = find_contacts([low, high], np.array([[0.0, 0.0, width, 0.0]]), tolerance)
    shared = min(width, (aside + share) * width) - max(0.0, aside * width)
    between = [(a, b) for a, b in zip(found.a.tolist(), found.b.tolist(), strict=True) if b >= 0]
    must(len(between) == (gap <= tolerance), f"joints {between} at a gap of {open_by} tolerances")
    gaps = [(f.kind, f.first, f.second) for f in found.flaws]
    must(len(gaps) == (gap > 0.0), f"flaws {gaps} at a gap of {open_by} tolerances")
    for flaw in found.flaws:
        must(flaw.kind == "gap" and {flaw.first, flaw.second} == {0, 1}, f"{flaw}")
        near("depth", flaw.depth, gap, 1e-6)
        near("length", flaw.length, shared, within)
        must(flaw.length > shortest_joint(tolerance), f"{flaw}")


@st.composite
def bonded(draw: st.DrawFn) -> Deck:
    """Arches as barrels of stones in bond across their depth."""
    shape = {"depth": draw(number(0.5, 3.0)), "voussoirs": draw(st.integers(5, 8)), "stones_across": draw(st.integers(1, 3))}
    return changed(draw(decks("arch")), structure=shape)


@relation("tilt", bonded(), 1e-6, share=2.0)
def contacts_lie_in_both_stones(deck: Deck, within: float) -> None:
    """A contact of stones of a barrel lies in the box around either stone, on its face: stones lie on both sides of its plane; all stones fill
    the depth."""
    solids = building(deck).solids()
    size = float(solids.size)
    points = [np.concatenate([solids.parts[i].vertices for i in np.flatnonzero(solids.owner == k)]) for k in range(len(solids.mass))]
    for polygon, normal, a, b in zip(solids.polygon, solids.normal, solids.a, solids.b, strict=True):
        for block, sense in ((int(a), 1.0), (int(b), -1.0)):
            if block < 0:
                continue
            low, high = points[block].min(axis=0), points[block].max(axis=0)
            must(
                bool((polygon >= low - within * size).all() and (polygon <= high + within * size).all()), f"a contact beside stone {block}"
            )
            at_most("face", 0.0, sense * float((points[block].mean(axis=0) - polygon[0]) @ normal), 0.0)
    for k, there in enumerate(points):
        near("middle across", solids.centroid[k, 1], 0.5 * (there[:, 1].min() + there[:, 1].max()), within, size)


@relation("dem", st.tuples(decks("arch", "block", "column"), number(1e8, 1e10)), 1e-6)
def stones_of_contacts_in_plane_and_space(deck: Deck, young: float, within: float) -> None:
    """The stiffness of a contact of solids is Young's modulus over the length of stone that its joint has in the section."""
    if deck["structure"]["kind"] == "arch":
        deck = changed(deck, structure={"stones_across": 1})
    made = building(changed(deck, material={"young": young}))
    section, solids = made.blocks(), made.solids()
    if len(section.a) != len(solids.a):
        reject()
    found = solid_values(made, solids)
    near("stiffness", np.asarray(found.stiffness), young / impact_rules.joint_lengths(section), within)


# ----- walls and blocks


@relation(
    "tilt", st.tuples(number(0.1, 0.6), st.lists(st.tuples(number(0.2, 0.8), number(0.4, 1.2)), min_size=1, max_size=3), st.data()), 1e-9
)
def lintels_in_a_mirror(bearing: float, row: list, data: st.DataObject, within: float) -> None:
    """Lintels of a mirrored wall are the mirrored lintels of the wall. Each has a bearing on both sides, and no two overlap."""
    at, holes, heads = 0.0, [], []
    for pier, wide in row:
        head = data.draw(st.sampled_from([1.6, 2.0, 2.4]))
        holes.append((at + pier, at + pier + wide, 0.8, head))
        heads.append(head)
        at += pier + wide
    length, height = at + row[0][0], 3.0
    bond = Bond(0.5, 0.2, lintel_height=0.2, lintel_bearing=bearing)
    found = lintels_of(bond, length, height, holes)
    back = lintels_of(bond, length, height, [(length - right, length - left, *more) for left, right, *more in holes])
    must(set(found) == set(back) == set(range(len(holes))), f"lintels {sorted(found)} and {sorted(back)}")
    for k, (low, high, foot, top) in found.items():
        near("mirrored lintel", [low, high, foot, top], [length - back[k][1], length - back[k][0], *back[k][2:]], within, 1.0)
        must(low < holes[k][0] and high > holes[k][1], f"lintel {k} from {low} to {high} over {holes[k]}")
    for i, k in itertools.combinations(found.values(), 2):
        apart = i[1] <= k[0] + within or k[1] <= i[0] + within or i[3] <= k[2] + within or k[3] <= i[2] + within
        must(apart, f"lintels {i} and {k} overlap")


BODY = ("mass", "inertia", "centre_height", "toe_right", "toe_left")


@relation(
    "rocking", st.tuples(st.lists(number(0.1, 3.0), min_size=5, max_size=5), st.sampled_from(BODY), st.sampled_from([0.0, -0.2])), 0.0
)
def bodies_without_mass_or_size(values: list, name: str, wrong: float, within: float) -> None:
    """A body without mass, inertia, height or a toe is refused. Other bodies have the given values."""
    keys = dict(zip(BODY, values, strict=True))
    made = make_block(**keys)
    near("mass", made.mass, [keys["mass"]], 1e-12)
    near("foot", [-made.p[0, 0], made.q[0, 0]], [keys["toe_left"], keys["toe_right"]], 1e-12)
    try:
        make_block(**{**keys, name: wrong})
    except ValueError:
        return
    must(False, f"a body whose {name} is {wrong}")


LOPSIDED = st.fixed_dictionaries(
    {"kind": st.just("block"), "mass": number(500.0, 5e3), "inertia": number(500.0, 5e3), "centre_height": number(1.0, 3.0)}
    | {"toe_right": number(0.2, 0.6), "toe_left": number(0.2, 0.6)}
)


@relation("rocking", st.tuples(LOPSIDED, st.sampled_from(["left", "right"]), number(0.2, 0.8)), 1e-9)
def lopsided_blocks_beside_a_wall(shape: Deck, side: str, rebound: float, within: float) -> None:
    """Beside an abutting wall a block starts to rock at the ratio of its free toe to the height of its centre, and never rotates into the wall."""
    deck = {"structure": shape, "supports": {"abutting_wall": side, "rebound": rebound}}
    free = {"left": "toe_right", "right": "toe_left"}[side]
    slope = shape[free] / shape["centre_height"]
    near("uplift", building(deck).rocker().uplift, slope, within)
    both = building({"structure": shape}).rocker().uplift
    near("without a wall", both, min(shape["toe_left"], shape["toe_right"]) / shape["centre_height"], within)
    motion = {"kind": "sine-pulse", "amplitude": f"{1.5 * slope:.5g} g", "period": 0.6}
    answer = ask({**deck, "motion": motion}, "rocking", end_time=1.5, hand_over=False)
    ok(answer)
    turned = np.asarray(answer.result.arrays["rotation"].data) * {"left": 1.0, "right": -1.0}[side]
    at_most("rotation into the wall", -float(turned.min()), 0.0, 0.0, 1e-9)


@relation("rocking", st.tuples(decks("stack", friction=st.just("no-sliding")), st.sampled_from([0.5, 1.2, 8.0])), 1e-9)
def stacks_by_their_slopes(deck: Deck, factor: float, within: float) -> None:
    """A stack starts to rock at the half width of its foot over the height of the common centre, the upper block at its own width over height; the
    answer states the outcome."""
    shape = deck["structure"]
    low, high = (np.array([shape[f"{name}_{side}"] for name in ("lower", "upper")]) for side in ("width", "height"))
    masses, middles = low * high, np.array([0.5 * high[0], high[0] + 0.5 * high[1]])
    whole, alone = 0.5 * low[0] / float(masses @ middles / masses.sum()), low[1] / high[1]
    near("uplift", building(deck).rocker(soft_base=True).model.uplift, [whole, alone], 1e-6)
    motion = {"kind": "sine-pulse", "amplitude": f"{factor * min(whole, alone):.5g} g", "period": 1.5}
    answer = ask({**deck, "motion": motion}, "rocking", end_time=4.0, hand_over=False)
    ok(answer)
    r = answer.results
    words = {"collapse": "The stack collapses", "recovery": "The stack rocks and recovers", "no-hinging": "The stack does not rock"}
    must(words[r.outcome] in answer.result.answer, f"{r.outcome}: {answer.result.answer}")
    must((r.outcome == "no-hinging") == (factor < 1.0), f"{r.outcome} at {factor} times its uplift")


@relation("rocking", st.tuples(decks("block", "column"), number(8.0, 10.0)), 1e-9, share=0.5)
def compliant_bases_apply_if_requested(deck: Deck, exponent: float, within: float) -> None:
    """A block on a compliant base has two coordinates if the analysis requests the base, otherwise it rocks on rigid ground. Stiff bases
    agree with rigid ground."""
    soft = changed(deck, supports={"stiffness": 10.0**exponent, "damping_ratio": 0.05})
    rigid = building(deck).rocker()
    made = building(soft).rocker(soft_base=True)
    must(type(made.model) is not type(rigid.model), f"a {type(made.model).__name__} on a compliant base")
    near("uplift on rigid ground", made.unit_acceleration, rigid.uplift, 1e-6)
    at_most("uplift", made.uplift, rigid.uplift, 1e-6)


# ----- discrete elements


@relation("dem", st.tuples(decks("block", "column", "arch", "frame"), number(0.0, 0.5)), 1e-9)
def floors_below_what_stands(deck: Deck, below: float, within: float) -> None:
    """The outline of a floor ends at its level, is counter-clockwise, and extends below the whole building."""
    stones = building(deck).blocks()
    points = np.concatenate(stones.outlines)
    level = float(points[:, 1].min()) - below
    bodies = rigid_bodies(stones, floor=level)
    extent = float(np.ptp(points, axis=0).max())
    floors = [
        p for p, o in zip(bodies.parts, bodies.owner, strict=True) if o >= bodies.count and np.ptp(np.asarray(p)[:, 0]) > 5.0 * extent
    ]
    must(bool(floors), "no floor")
    for polygon in map(np.asarray, floors):
        near("level", polygon[:, 1].max(), level, within, extent)
        must(signed_area(polygon) > 0.0, "a clockwise floor")
        at_most("depth of the ground", 0.1 * extent, level - polygon[:, 1].min(), 0.0)


@relation("dem", number(0.01, 100.0), 1e-12)
def times_to_settle(size: float, within: float) -> None:
    """The time to settle is 15 sqrt(size/g), 15 times the time scale of a body of this size."""
    near("time", dem_model.settle_time(SimpleNamespace(size=size)), 15.0 * np.sqrt(size / GRAVITY), within)


@relation("dem", st.tuples(st.integers(1, 5), st.integers(1, 12), st.integers(0, 10**6)), 0.0)
def changes_of_hinges(joints: int, steps: int, seed: int, within: float) -> None:
    """The table of hinges lists each change of the state of a joint: open, closed, or hinged at its first or second end."""
    kinds = [states.CLOSED, states.HINGED_FIRST, states.HINGED_SECOND, states.APART]
    told = {states.CLOSED: "closed", states.APART: "open", states.HINGED_FIRST: "first", states.HINGED_SECOND: "second"}
    state = np.random.default_rng(seed).choice(kinds, size=(steps, joints))
    time, names = 0.1 * np.arange(steps), [f"joint {j}" for j in range(joints)]
    table = of_elements.hinge_table(SimpleNamespace(assembly=SimpleNamespace(joint_names=names)), time, state).columns
    got = iter(zip(table["time"], table["joint"], table["state"], strict=True))
    for k, j in itertools.product(range(steps), range(joints)):
        if state[k, j] != (state[k - 1, j] if k else states.CLOSED):
            when, joint, words = next(got)
            must((when, joint) == (time[k], names[j]) and told[state[k, j]] in words, f"{when} {joint} {words} for {state[k, j]}")
    must(next(got, None) is None, "a change that is none")


# ----- limit analysis and codes


@relation("moving-load supports tilt", st.tuples(decks("arch"), number(1e2, 1e4)), 1e-6)
def forces_of_ties_in_their_arrays(deck: Deck, force: float, within: float) -> None:
    """The array of tie forces at collapse (moving load, tilt) or after settlement of supports equals the forces of the results."""
    deck = changed(deck, joints={"friction": 0.8}, structure={"voussoirs": 6})
    stones = building(deck).blocks()
    x, y = (round(float(v), 6) for v in stones.centroid[2])
    tie = {"start": [x, y], "ground": [x - 9.0, y - 1.0], "works_in": "tension", "yield_force": force}
    tied = changed(deck, ties=[tie])
    ends = [float(end) for end in (stones.p[:, 0].min(), stones.p[:, 0].max())]
    place = round(ends[0] + 0.3 * (ends[1] - ends[0]), 4)
    for kind, keys, name in (("moving-load", {"places": [place]}, "collapse"), ("tilt", {}, "collapse"), ("supports", {}, "settled")):
        answer = ask(tied, kind, **keys)
        ok(answer)
        arrays = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
        must(f"{name}_tie_force" in arrays, f"{kind}: {sorted(arrays)}")
        near(f"{kind}: tie", arrays[f"{name}_tie_force"], [t.force_N for t in answer.results.ties], within, 1e-3)


@relation("imperfections", st.tuples(decks("chimney", "dome", "wall"), st.sampled_from([0.5, 0.95, 1.05, 2.0])), 1e-9)
def the_narrowest_joint_bounds_the_deviation(deck: Deck, share: float, within: float) -> None:
    """A deviation of more than a quarter of the narrowest contact of solids, its area over the greatest distance of its corners, is refused."""
    stones = building(deck).solids()
    wide = [max(float(np.linalg.norm(p - q)) for p, q in itertools.combinations(np.asarray(polygon), 2)) for polygon in stones.polygon]
    deviation = 0.25 * share * float((stones.area / np.array(wide)).min())
    made = make_deck({**deck, "analysis": [{"kind": "imperfections", "deviation": deviation, "direction": 0.0}]})
    try:
        found = deviation_of(made.building, made.analyses[0])
    except Refused:
        must(share > 1.0, f"{share} of the greatest deviation is refused")
        return
    must(share < 1.0, f"{share} times the greatest deviation is not refused")
    near("deviation", found, deviation, within)


@relation("local-mechanism", decks("arch", "frame", "pointed-arch", friction=st.just(0.9)), 1e-9)
def work_of_blocks_and_of_links(deck: Deck, within: float) -> None:
    """d0*, e* and the weight of the chain multiply to the work of the weights, whether blocks or links count as the weights."""
    table = {"kind": "local-mechanism", "mechanism": "building"}
    made = make_deck({**deck, "analysis": [table]})
    try:
        sides = local_mechanism._of_stones(Context(made), made.analyses[0])
    except (CannotStand, NoView):
        reject()
    seen = [(one.found, one.links) for one in sides if one.links is not None and one.found.d0 is not None]
    if not seen:
        reject()
    for found, links in seen:
        near("work", links.d0 * links.part * links.weight, found.d0 * found.part * found.weight, within)
        near("acceleration", links.acceleration * links.part, found.acceleration * found.part, within)


@relation("local-mechanism", decks("block", "frame", "column", friction=number(0.1, 0.2, 4)), 0.0)
def multipliers_whose_least_state_is_unknown(deck: Deck, within: float) -> None:
    """If joints slide and no state without dilatancy is found, the multiplier is an upper bound."""
    deck = changed(deck, structure={"height": 1.0}) if deck["structure"]["kind"] == "block" else deck
    made = make_deck({**deck, "analysis": [{"kind": "local-mechanism", "mechanism": "building"}]})
    with mock.patch.object(local_mechanism, "_without_dilatancy", side_effect=NoAnswer("none is known")):
        try:
            sides = [local_mechanism._at_rest(Context(made), made.analyses[0], side) for side in (0, 1)]
        except (CannotStand, NoView):
            reject()
    slide = [one for one in sides if one.slides]
    if not slide:
        reject()
    for one in slide:
        must(one.bound == "upper" and one.associated is None, f"bound {one.bound}")


# ----- ensembles


@relation("fragility", st.tuples(decks("block", "arch"), st.integers(1, 10**6)), 1e-9)
def tables_of_durations(deck: Deck, seed: int, within: float) -> None:
    """The table of durations has the confidence intervals of the results, and the medians are those of the peaks of the motions."""
    motion = {"kind": "generated", "mmi": 8, "duration": 1.0, "seed": seed, "lines": 5}
    deck = {**deck, "motion": motion}
    answer = ask(deck, "fragility", count=3, bootstrap=0, durations=[0.5, 1.0])
    ok(answer)
    r, t = answer.results, answer.result.tables["durations"].columns
    must({"lower", "upper"} <= set(t), f"columns {sorted(t)}")
    near("interval", np.column_stack([t["lower"], t["upper"]]), np.array(r.confidence_interval).reshape(-1, 2), within)
    rows = answer.result.tables["ensemble"].columns
    for duration, median in zip(r.durations_s, r.median_pga_g, strict=True):
        peaks = np.asarray(rows["pga"])[np.isclose(rows["duration"], duration)]
        near("median", median, np.median(peaks) / GRAVITY, within)
    alone = ask(deck, "fragility", count=3, bootstrap=0)
    ok(alone)
    near("median of one", alone.results.median_pga_g, np.median(alone.result.tables["ensemble"].columns["pga"]), within)


@relation("failure-domain", st.tuples(decks("arch", friction=st.just(2.0)), number(0.8, 1.6), number(0.01, 0.05, 8)), 1e-9)
def the_curve_by_the_rule_of_the_deck(deck: Deck, period: float, accuracy: float, within: float) -> None:
    """Of the curves by impact rules, that by the rule of the deck is the curve of the map, as both are refined to the same accuracy."""
    keys = {"pulse": "step", "durations": [period], "amplitudes": 5, "accuracy": accuracy, "hand_over_cells": 0}
    answer = ask(deck, "failure-domain", **keys)
    ok(answer)
    r = answer.results
    same = [one for one in r.amplitudes_by_rule or [] if abs(one.restitution - r.restitution) < within]
    if not same or same[0].amplitudes_g[0] is None:
        reject()
    near("amplitude", same[0].amplitudes_g[0], r.mode_I.amplitudes_g[0], within)
