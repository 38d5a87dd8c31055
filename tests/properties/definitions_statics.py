"""Moving supports, moving loads and mechanisms of solids computed again from their definitions."""

import itertools
import math

import numpy as np
from asking import Deck, ask, must, near
from buildings import changed, decks, drawn, number
from conservation import building
from definitions_elements import masses_of_blocks, masses_of_solids
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, ok, relation


@relation(
    "supports", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(-1.0, 1.0, 8), number(-1.0, 1.0, 8)), 1e-3, share=2.0
)
def work_of_moving_supports(deck: Deck, spread: float, settle: float, within: float) -> None:
    """The potential energy of an arch changes by the work of its force on the right support; stages and numbers are those of the history."""
    if abs(spread) + abs(settle) < 0.2:
        reject()
    answer = ask(deck, "supports", spread=spread, settle=settle, steps=60)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    way = np.array([spread, -settle]) / math.hypot(spread, settle)
    movement, force, energy = a["movement"], a["force"], a["energy"]
    work, fine = -0.5 * (force[1:] + force[:-1]) @ way * np.diff(movement), np.diff(movement) < 1.5 * movement[1]
    fine &= (a["hinge"][1:] == a["hinge"][:-1]).all(axis=1)  # hinges of another stage are closed at once
    fine[-1] = False
    near("work", np.diff(energy)[fine], work[fine], 0.03, float(np.abs(work).max()))
    p = np.array([a["joint_p"][0], a["joint_p"][-1]])
    span = float(np.hypot(*(p[1] - p[0])))
    near(
        "movement at the fall",
        [r.movement_at_fall_m, r.movement_at_fall_over_span, r.span_change_at_fall_ratio],
        [movement[-1], movement[-1] / span, movement[-1] * way[0] / span],
        1e-9,
        1e-6,
    )
    near("thrust", [r.thrust_at_rest_N, r.thrust_at_fall_N], force[[0, -1], 0], 1e-9)
    hinge = a["hinge"].astype(int)
    must([h.joint for h in r.hinges_at_rest] == hinge[0].tolist(), f"{r.hinges_at_rest}")
    must([h.joint for h in r.hinges_at_fall] == hinge[-1].tolist(), f"{r.hinges_at_fall}")
    told = answer.result.tables["supports"].columns["hinges"]
    changes = [k for k in range(1, len(told)) if told[k] != told[k - 1]]
    near("stages", [s.movement_m for s in r.stages], [0.0, *movement[changes]], 1e-9, 1e-6)
    must(f"after {len(changes)} change" in answer.result.answer, answer.result.answer)
    limits = ask(deck, "thrust")
    ok(limits)
    if settle == 0.0:
        extreme = limits.results.least if spread > 0.0 else limits.results.most
        near("thrust at rest", r.thrust_at_rest_N, extreme.horizontal_N, 1e-4)
    shown = a["shown_movement"]
    near("shown", shown, [movement[np.abs(movement - s * movement[-1]).argmin()] for s in (0.0, 0.25, 0.5, 0.75, 1.0)], 1e-9, 1e-6)
    ends = a["shown_point"][-1]
    joint = np.array([a["joint_p"], a["joint_q"]])
    at = [np.clip((ends[k] - base) @ _unit(joint[:, k]), 0.0, None) for k, base in ((0, joint[0, 0]),)]
    must(at[0] <= np.hypot(*(joint[1, 0] - joint[0, 0])) * (1.0 + 1e-6), "a thrust line that leaves the left support")
    last = joint[:, -1] + movement[-1] * way
    line = last[1] - last[0]
    off = (ends[-1] - last[0]) @ np.array([-line[1], line[0]]) / np.hypot(*line)
    near("thrust line on the moved support", off, 0.0, 0.0, 1.0) if abs(off) > 1e-3 * span else None


def _unit(ends: np.ndarray) -> np.ndarray:
    return (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))


@relation(
    "supports", st.tuples(decks("frame", "vault", "arch"), number(0.2, 1.0, 8), number(0.0, 0.6, 6), st.sampled_from([0.001, 0.003])), 1e-6
)
def right_support_spelled_out(deck: Deck, spread: float, settle: float, movement: float, within: float) -> None:
    """The right support of a structure that moves is the movement of its rightmost joints on the ground, spelled out."""
    plain = drawn(deck)
    blocks = ask(plain, "tilt")
    ok(blocks)
    a = {k: np.asarray(v.data) for k, v in blocks.result.arrays.items()}
    ground = np.flatnonzero((a["joint_block"] < 0).any(axis=1))
    ends = np.sort(np.array([a["joint_p"][ground, 0], a["joint_q"][ground, 0]]), axis=0)
    last = ground[(ends[1] >= ends[1].max() - 1e-9) | (ends[0] >= ends[0][ends[1].argmax()] - 1e-3)]
    far = math.hypot(spread, settle)
    one = ask(plain, "supports", spread=spread, settle=settle, movement=movement)
    if one.answers and one.results.openings is None:
        reject()  # an arch is followed to its fall
    rows = [{"joint": str(a["joint_name"][j]), "dx": movement * spread / far, "dy": -movement * settle / far} for j in last]
    other = ask(changed(plain, initial={"movements": rows}), "supports")
    must(one.outcome == other.outcome, f"{one.outcome} ({one.said}) against {other.outcome} ({other.said})")
    ok(one, other)
    near("work", one.results.work_J, other.results.work_J, within, 1e-3)
    p, q = ({o.name: o for o in x.results.openings} for x in (one, other))
    must(set(p) == set(q), f"{sorted(set(p) ^ set(q))}")
    b = {k: np.asarray(v.data) for k, v in one.result.arrays.items()}
    for name, row in p.items():
        near(name, [row.opening_mm, row.slip_mm], [q[name].opening_mm, q[name].slip_mm], within, 1e3 * movement)
        first, second, slip = b["settled_opening"][row.joint]
        near(name, [row.opening_mm, row.slip_mm], [1e3 * max(first, second), 1e3 * slip], within, 1e3 * movement)
        must(
            row.side in (("extrados", "second end") if second > first else ("intrados", "first end")),
            f"{name}: {row.side} of {first}, {second}",
        )
    down = sum(r.vertical_N for r in one.results.reactions)
    near(
        "reactions",
        [down, sum(r.horizontal_N for r in one.results.reactions)],
        [blocks.results.weight_N, 0.0],
        1e-6,
        blocks.results.weight_N,
    )
    near("work of the weight", one.results.work_J, -_fallen(b, plain), 1e-5, 1e-3 * blocks.results.weight_N * movement)


def _fallen(a: dict[str, np.ndarray], deck: Deck) -> float:
    """Weights times rises of the blocks of a small motion [J]."""
    masses, _ = masses_of_blocks(a, deck["structure"]["depth"])
    return float((a["settled_pose"][:, 1] - a["centroid"][:, 1]) @ masses * GRAVITY)


@st.composite
def trains(draw: st.DrawFn) -> tuple[Deck, Deck]:
    """An arch and a moving load of given axles with partial factors."""
    deck = draw(decks("arch", "pointed-arch", "elliptical-arch"))
    deck["structure"]["depth"] = draw(number(1.0, 3.0, 4))
    axles = [0.0, *draw(st.lists(number(0.1, 0.6, 5), max_size=1))]
    table: Deck = {"axles": axles, "both_ways": draw(st.booleans())}
    how = draw(st.sampled_from(["shares", "loads", "force"]))
    if how == "shares":
        table["shares"] = [1.0, 2.0][: len(axles)]
    if how == "force":
        table["force"] = draw(number(1e3, 5e4, 5))
    if how == "loads":
        table["axle_loads"] = [1e4, 2.5e4][: len(axles)]
        if draw(st.booleans()):
            table["width"] = round(deck["structure"]["depth"] * draw(number(0.4, 1.0, 6)), 4)
    table["factors"] = draw(st.sampled_from([{}, {"live": 1.3, "dynamic": 1.2, "masonry": 1.1}]))
    return deck, table


@relation("moving-load tilt", st.tuples(trains(), st.lists(number(0.15, 0.85, 14), min_size=2, max_size=3, unique=True)), 1e-4, share=2.0)
def a_moving_load_stands_still(question: tuple, shares: list, within: float) -> None:
    """At each place the structure stands under a little less than the collapse load laid there at rest, and not under a little more."""
    deck, table = question
    x = np.concatenate([np.array(b["points"]) for b in drawn(deck)["structure"]["block"]])[:, 0]
    places = [round(float(x.min() + s * np.ptp(x)), 4) for s in shares]
    answer = ask(deck, "moving-load", places=places, **table)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    capacity, factors, depth = a["capacity"], table["factors"], deck["structure"]["depth"]
    ways = np.repeat([1.0, -1.0][: 2 if table["both_ways"] else 1], len(places))
    near("places", a["place"], np.tile(places, len(ways) // len(places)), 1e-9, 1.0)
    near("ways", a["way"], ways, 0.0)
    live = factors.get("live", 1.0) * factors.get("dynamic", 1.0)
    loads = np.array(table.get("axle_loads", table.get("shares", np.ones(len(table["axles"])))), dtype=float)
    strip = depth / table.get("width", depth)
    heavier = changed(deck, material={"density": 2000.0 * factors.get("masonry", 1.0)})
    k = int(np.nanargmin(a["adequacy"] if "adequacy" in a else capacity))
    axles = places[k % len(places)] - ways[k] * np.array(table["axles"])
    near("axles", a["axle"], axles, 1e-9, 1.0)
    near("worst place", r.worst_place_m, a["place"][k], 1e-9, 1.0)
    must(r.worst_way == ("+x" if ways[k] > 0 else "-x"), f"{r.worst_way} of {ways[k]}")
    ends = a["joint_q"][[0, -1], 0]
    near("over the span", r.worst_place_over_span, (a["place"][k] - ends.min()) / np.ptp(ends), 1e-6, 1.0)
    near("collapse load", r.collapse_load_N, capacity[k], 1e-9)
    near("per metre", r.collapse_load_kN_per_m, capacity[k] / depth / 1e3, 1e-9)
    on = (axles >= ends.min()) & (axles <= ends.max())
    if "axle_loads" in table:
        near("adequacy", r.adequacy_factor, a["adequacy"][k], 1e-9)
        near("live", r.live_load_factor, live, 1e-9)
        near("on the structure", r.collapse_load_N, r.adequacy_factor * live * loads[on].sum(), 1e-6)
        laid = r.adequacy_factor * live * strip * loads
    else:
        laid = r.collapse_load_N * loads / (loads if "force" in table else loads[on]).sum()
        if "force" in table:
            near("safety", r.safety_factor, r.collapse_load_N / table["force"], 1e-9)
    must(getattr(r, "characteristic", None) == (not factors), f"characteristic: {getattr(r, 'characteristic', None)}, factors {factors}")
    for share, stands in ((1.0 - 1e-4, True), (1.0 + 1e-4, False)):
        rows = [
            {"x": float(place), "force": float(share * f), "sways": False} for place, f, there in zip(axles, laid, on, strict=True) if there
        ]
        still = ask(heavier, "tilt", load=rows)
        must((still.outcome != "cannot-stand") == stands, f"{share} of the collapse load {laid} at {axles}: {still.outcome} {still.said}")


SPACES = decks("wall", "dome", "cross-vault", friction=number(0.2, 0.9, 7))


@relation("tilt", st.tuples(SPACES, number(0.0, 360.0, 24)), 1e-6)
def mechanisms_of_solids_by_hand(deck: Deck, angle: float, within: float) -> None:
    """Rates, openings, slips, forces and counts of the mechanism of solids are those of its velocities and corner forces."""
    both = [ask(deck, "tilt", direction=d) for d in (angle, (angle + 180.0) % 360.0)]
    ok(*both)
    both.append(ask(deck, "tilt", direction=both[0].results.least_direction_deg % 360.0))
    ok(*both)
    one, back = (x.results for x in both[:2])
    near(
        "both ways",
        [one.collapse_acceleration_g, one.collapse_acceleration_opposite_g],
        [back.collapse_acceleration_opposite_g, back.collapse_acceleration_g],
        1e-5,
    )
    near(
        "angles",
        [one.tilt_angle_deg, one.tilt_angle_opposite_deg],
        [math.degrees(math.atan(g)) for g in (one.collapse_acceleration_g, one.collapse_acceleration_opposite_g)],
        within,
    )
    dilating = []
    for answer, direction in zip(both, (angle, (angle + 180.0) % 360.0, one.least_direction_deg % 360.0), strict=True):
        r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
        names, of = list(a["block_name"]), a["contact_of"].astype(int)
        blocks = [(names.index(x) if x in names else -1, y) for x, y in ((n, 0) for n in names)]
        masses = np.array(masses_of_solids(a))
        if deck["structure"]["kind"] == "wall":
            near("weight", r.weight_N, masses.sum() * GRAVITY, within)
        velocity, centre = a["velocity"], a["solid_centroid"]
        owner = np.zeros(len(a["solid_vertex"]), int)
        for k, (start, stop) in enumerate(itertools.pairwise(a["solid_face_start"].astype(int))):
            owner[a["solid_face"][start:stop].astype(int)] = int(a["solid_face_block"][k])
        rate = velocity[owner, :3] + np.cross(velocity[owner, 3:], a["solid_vertex"] - centre[owner])
        speed = np.linalg.norm(rate, axis=1)
        size = float(np.ptp(a["solid_vertex"], axis=0).max())
        near("pose", a["mechanism_pose"], velocity * 0.08 * size / speed.max(), 1e-6, size * 1e-3)
        share = np.array([speed[owner == i].max() for i in range(len(names))]) / speed.max()
        must(r.moving_blocks == int((share > 1e-3).sum()) and r.blocks == len(names), f"{r.moving_blocks} moving blocks: {share}")
        own = np.linalg.norm(velocity[:, :3], axis=1)
        must(own[names.index(r.fastest_block)] >= own.max() * (1.0 - 1e-9), f"{r.fastest_block} is not the fastest")
        a_, b_ = _pairs(deck)
        must(r.contacts == len(a_) and len(blocks) == len(names), f"{r.contacts} contacts of {len(a_)}")
        at = a["contact_point"]

        def of_block(which: np.ndarray, at: np.ndarray = at, velocity: np.ndarray = velocity, centre: np.ndarray = centre) -> np.ndarray:
            moved = velocity[which, :3] + np.cross(velocity[which, 3:], at - centre[which])
            return np.where((which >= 0)[:, None], moved, 0.0)

        apart = (of_block(a_[of]) - of_block(b_[of])) / speed.max()
        opening = (apart * a["contact_normal"][of]).sum(axis=1)
        sliding = np.linalg.norm(apart - opening[:, None] * a["contact_normal"][of], axis=1)
        most = np.zeros((2, len(a_)))
        for k in range(len(a_)):
            most[:, k] = max(opening[of == k].max(), 0.0), sliding[of == k].max()
        told = {c.joint: c for c in r.opening_contacts}
        moving = np.flatnonzero(most.max(axis=0) > 1e-6 * (1.0 + 1e-3))
        must(len(told) == min(20, len(moving)) or abs(len(told) - len(moving)) <= 1, f"{len(told)} of {len(moving)} contacts")
        for j, c in told.items():
            near(f"contact {j}", [c.opening, c.sliding], most[:, j], 1e-5, 1e-3)
            near(f"contact {j}", [c.x_m, c.y_m, c.z_m], at[of == j].mean(axis=0), 1e-6, size)
        if told and len(told) < len(moving):
            least = min(most[:, j].max() for j in told)
            must(least >= max(most[:, j].max() for j in moving if j not in told) - 1e-9, "a faster contact is not told")
        mu = deck["joints"]["friction"]
        slides = (sliding > 1e-6) & (opening <= mu * sliding + 1e-6)
        dilating.append(len(set(of[slides].tolist())))
        # forces
        force = np.zeros((len(a_), 3))
        along = np.array([math.cos(math.radians(direction)), math.sin(math.radians(direction)), 0.0])
        for k in range(len(a_)):
            n = a["contact_normal"][k]
            here = a["collapse_force"][of == k]
            must(bool((here[:, 0] >= -1e-6 * r.weight_N).all()), "tension at a corner")
            near("normal force", a["contact_force"][k] @ n, here[:, 0].sum(), 1e-6, 1e-3 * r.weight_N)
            shear = np.linalg.norm(a["contact_force"][k] - (a["contact_force"][k] @ n) * n)
            near("shear", shear, np.hypot(*here[:, 1:].sum(axis=0)), 1e-5, 1e-3 * r.weight_N)
            total = here[:, 0].sum()
            if total > 1e-3 * r.weight_N:
                near("centre", a["contact_centre"][k], here[:, 0] @ at[of == k] / total, 1e-6, size)
            force[k] = a["contact_force"][k]
        left = np.zeros((len(names), 3))
        for k in range(len(a_)):
            if a_[k] >= 0:
                left[a_[k]] += force[k]
            if b_[k] >= 0:
                left[b_[k]] -= force[k]
        if deck["structure"]["kind"] == "wall":
            weight = masses[:, None] * GRAVITY * (np.array([0.0, 0.0, -1.0]) + r.collapse_acceleration_g * along)
            near("equilibrium of each stone", left, -weight, 1e-4, r.weight_N * 0.1)
        near("least of the rose", r.least_acceleration_g, a["rose_capacity"].min(), 1e-6)
        near(
            "its direction", a["rose_capacity"][np.abs(a["rose_direction"] - r.least_direction_deg).argmin()], r.least_acceleration_g, 1e-5
        )
        near("rose", np.diff(a["rose_direction"]), np.full(len(a["rose_direction"]) - 1, 360.0 / len(a["rose_direction"])), 1e-9)
        near("first of the rose", [a["rose_direction"][0], a["rose_capacity"][0]], [direction, r.collapse_acceleration_g], 1e-5, 1.0)
    must(one.dilating_contacts == max(dilating), f"{one.dilating_contacts} contacts of {dilating} dilate")


def _pairs(deck: Deck) -> tuple[np.ndarray, np.ndarray]:
    """Blocks on both sides of the contacts of solids."""
    solids = building(deck).solids()
    return np.asarray(solids.a), np.asarray(solids.b)
