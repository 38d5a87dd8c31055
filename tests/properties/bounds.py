"""What is never more than something else: stouter sections, friction, ties, strengths, cuts, bounds, energies."""

import itertools
import math

import numpy as np
from asking import Deck, ask, at_most, must, near
from buildings import SMALL, SOLIDS, arches, changed, cut, decks, drawn, number, pulses, sections
from conservation import building
from hypothesis import reject
from hypothesis import strategies as st
from relations import CRACKS, GRAVITY, MASONRY, PUSH, RECTANGLES, RIGID, SLOW, STONES, WEAK, ok, relation, statics

#: What makes a structure of a kind stouter
STOUT = {
    "arch": ("thickness",),
    "pointed-arch": ("thickness",),
    "elliptical-arch": ("thickness",),
    "block": ("width",),
    "column": ("width", "top_width"),
    "brickwork": ("unit_length",),
}


@relation("tilt", st.tuples(decks(*STOUT), number(1.01, 1.5)), 2e-3)
def stouter(deck: Deck, factor: float, within: float) -> None:
    """A stouter section has no smaller capacity."""
    keys = {k: deck["structure"][k] * factor for k in STOUT[deck["structure"]["kind"]]}
    at_most("stouter", ask(deck, "tilt").capacity, ask(changed(deck, structure=keys), "tilt").capacity, within)


@relation("tilt", st.tuples(STONES, number(0.05, 0.6), number(0.01, 0.5)), 1e-5)
def rougher(deck: Deck, friction: float, more: float, within: float) -> None:
    """More friction gives no smaller capacity, and excluded sliding the greatest."""
    found = [statics(changed(deck, joints={"friction": mu})) for mu in (friction, friction + more, "no-sliding")]
    if deck["structure"]["kind"] in SOLIDS and found[2].status == "refused":
        found = found[:2]
    for less, most in itertools.pairwise(found):
        if "refused" in (less.outcome, most.outcome):
            continue
        at_most("rougher", less.capacity, most.capacity, within, 1e-2)


@st.composite
def hung(draw: st.DrawFn) -> Deck:
    """A stone between two piers, which friction alone carries; sizes of all differ."""
    left, right, held = (draw(number(0.3, 1.5)) for _ in range(3))
    tall, drop = draw(number(0.5, 2.0)), draw(number(0.1, 0.5))
    boxes = {
        "left": (0.0, 0.0, left, tall),
        "right": (left + held, 0.0, right, tall * draw(number(0.8, 1.2))),
        "held": (left, 0.5 * tall, held, 0.3 * tall * (1.0 + drop)),
    }
    blocks = [{"name": name, "points": [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]} for name, (x, y, w, h) in boxes.items()]
    return {"structure": {"kind": "blocks", "block": blocks}, "joints": {"friction": draw(number(0.4, 0.9))}}


#: Seed 109 of the trial of friction: a wall with a window and no lintel, of which one unit hangs between two others
WINDOW = {
    "structure": {
        "kind": "brickwork",
        "unit_length": 0.4174968996,
        "unit_height": 0.2651099460,
        "units": 4,
        "courses": 8,
        "begins": "half",
        "lintels": False,
        "openings": [{"x": [0.5341465752, 0.8478716508], "y": [0.1237541100, 0.8685346457]}],
    },
    "joints": {"friction": 0.8903153421},
}


@relation("tilt", hung(), 1e-9, examples=(WINDOW,))
def rest_has_no_sense(deck: Deck, within: float) -> None:
    """A block that slides out at rest gives a capacity of zero to +x and to -x."""
    found = ask(deck, "tilt", friction_rule="non-associated")
    if not found.answers:
        reject()
    names = [
        f"is carried only by friction between its neighbours. In a state without dilatancy, this block slides out at any load, so no horizontal load {way}"
        for way in ("to +x", "to -x")
    ]
    told = [name in found.warnings for name in names]
    must(told[0] == told[1] == bool((found.capacity == 0.0).all()), f"{told}, {found.capacity}")


TIED = st.tuples(decks("arch", "pointed-arch", "elliptical-arch", "column"), number(0.001, 0.3), number(1.0, 3.0))


@relation("tilt", TIED, 1e-5)
def a_stronger_tie(deck: Deck, force: float, factor: float, within: float) -> None:
    """A tie does not reduce the capacity, and a stronger tie gives no smaller capacity."""
    section = drawn(deck)
    blocks = section["structure"]["block"]
    if len(blocks) < 2:
        reject()
    ends = [np.mean(blocks[k]["points"], axis=0).tolist() for k in (0, -1)]
    bare = ask(section, "tilt")
    ok(bare)
    weight = bare.results.weight_N
    tie = {"start": ends[0], "end": ends[1], "works_in": "tension"}
    found = [bare, *(ask({**section, "ties": [{**tie, "yield_force": f * weight}]}, "tilt") for f in (force, force * factor))]
    for less, most in itertools.pairwise(found):
        at_most("a tie", less.capacity, most.capacity, within)


VISCOUS = st.tuples(RECTANGLES, st.integers(2, 8), number(0.5, 1.0))


@relation("tilt dem", VISCOUS, 2e-3, share=0.3, examples=(((1.0, 4.0), 6, 0.875),))
def a_viscous_damper_in_statics(size: tuple[float, float], exponent: int, share: float, within: float) -> None:
    """A dashpot changes no state of equilibrium: discrete elements collapse at the load of limit analysis, with it and without it, and a warning states this.

    exponent: of the damping, 10^k N s/m; share: height of the damper over that of the block.
    """
    width, height = size
    bare = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": 2.0}}
    up = round(share * height, 4)
    damper = {"start": [0.5 * width, up], "ground": [4.0 * width, up], "start_stone": "block", "damping": 10.0**exponent}
    free, held = (ask(deck, "dem", **SLOW) for deck in (bare, {**bare, "dampers": [damper]}))
    ok(free)
    must((held.capacity == free.capacity).all(), f"{held.capacity} with the damper, {free.capacity} without it")
    must("no force in statics" in held.warnings, f"does not say it: {held.warnings}")
    near("limit analysis", held.capacity, ask(bare, "tilt").capacity, 2.0 * within)
    must(ask({**bare, "dampers": [damper]}, "tilt").status == "refused", "limit analysis takes a damper")


@relation("tilt", st.tuples(decks("arch", "column", "block"), number(3.0, 100.0), number(1.1, 4.0)), 1e-4)
def stronger_stone(deck: Deck, strength: float, factor: float, within: float) -> None:
    """A greater compressive strength gives no smaller capacity, and an unlimited strength the greatest. strength: over the mean pressure on the ground."""
    bare = ask(deck, "tilt")
    ok(bare)
    stones = drawn(deck)["structure"]
    length = sum(math.dist(row[:2], row[2:]) for row in stones["ground"])
    pressure = bare.results.weight_N / (length * stones["depth"])
    weak, strong = (ask(changed(deck, material={"compressive_strength": strength * f * pressure}), "tilt") for f in (1.0, factor))
    for less, most in ((weak, strong), (strong, bare)):
        if less.answers or less.outcome == "cannot-stand":
            at_most("stronger", less.capacity, most.capacity, within)


@relation("tilt", st.tuples(sections(*SMALL, "arch"), st.integers(0, 20), number(0.2, 0.8)), 1e-5)
def a_cut(deck: Deck, block: int, share: float, within: float) -> None:
    """A new joint through a block permits more motions and gives no greater capacity."""
    at_most("cut", ask(cut(deck, block, share), "tilt").capacity, ask(deck, "tilt").capacity, within)


@relation("tilt", decks("brickwork", "blocks", "column", "arch", "stack", friction=number(0.2, 0.9, 14)), 1e-4)
def dilatancy_helps(deck: Deck, within: float) -> None:
    """Associated friction gives no smaller capacity than friction without dilatancy."""
    less, most = ask(deck, "tilt", friction_rule="non-associated", starts=3), ask(deck, "tilt")
    if less.outcome in ("refused", "failed"):
        reject()
    at_most("non-associated", less.capacity, most.capacity, within)


@relation("tilt", decks(*SOLIDS), 1e-5)
def bounds_of_solids(deck: Deck, within: float) -> None:
    """Bounds by pyramids within and around the cones enclose the capacity, and its certificate holds."""
    answer = ask(deck, "tilt", direction=0.0, rose=4, starts=1, pyramids=8)
    ok(answer)
    r = answer.results
    at_most("lower bound", r.pyramids.lower_g or 0.0, r.collapse_acceleration_g, within)
    if r.pyramids.upper_g is not None:
        at_most("upper bound", r.collapse_acceleration_g, r.pyramids.upper_g, within)
    near("virtual work", r.upper_bound_g, r.collapse_acceleration_g, within)
    at_most("residuals", max(r.duality_gap, r.equilibrium_residual, r.friction_residual, r.overlap_residual), 1e-5, 0.0)
    at_most("least of all directions", r.least_acceleration_g, r.collapse_acceleration_g, within)


@relation("tilt thrust", sections(friction=st.just("no-sliding")), 1e-5)
def equilibrium_at_collapse(deck: Deck, within: float) -> None:
    """Reactions balance the weight and the lateral load, both bounds are equal, and beyond them no state is admissible."""
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
        must((there.outcome == "stands") == stands, f"a thrust line at {gamma} g of {r.collapse_acceleration_g}: {there.outcome}")


@relation(
    "rocking dem",
    st.tuples(decks("block", "column", "stack"), pulses(0.1, 0.8)),
    1e-3,
    examples=(
        (
            {"structure": {"kind": "block", "width": 0.3085, "height": 3.2525, "depth": 0.5}, "joints": {"friction": 0.6}},
            {"kind": "sine-pulse", "amplitude": "0.2505 g", "period": 1.06},
        ),
    ),
)
def energies(deck: Deck, motion: Deck, within: float) -> None:
    """Friction, dampers and impacts create no energy beyond errors of the time step, and the energy balance holds."""
    moving = changed(deck, motion=motion)
    for told, keys in (("rigid contacts", RIGID), ("springs", {"joints": {"normal_stiffness": 1e8}})):
        r = ask(moving, "dem", end_time=1.0, **keys)
        if r.answers:
            scale = max(r.results.peak_kinetic_energy_J, 1.0)
            for name in ("friction_loss_J", "damping_loss_J"):
                loss = getattr(r.results, name)
                if keys is RIGID and loss < -within * scale:  # the work of contacts is of first order in the step
                    at_most(f"{told}: {name}: at the time step of the analysis", 0.0, loss, 2.0 * within, scale)
                    finer = ask(moving, "dem", end_time=1.0, time_step=0.5 / r.results.steps, **keys)
                    ok(finer)
                    at_most(f"{told}: {name}: half the time step", 0.7 * loss, getattr(finer.results, name), 0.0)
                else:
                    at_most(f"{told}: {name}", 0.0, loss, within, scale)
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


@relation(
    "sla tilt",
    arches().map(lambda s: {"structure": s}),
    0.02,
    share=0.3,
    examples=(
        {"structure": {"kind": "arch", "radius": 10.0, "thickness": 1.07, "embrace": 180.0, "voussoirs": 40}},
        {"structure": {"kind": "arch", "radius": 10.0, "thickness": 1.05, "embrace": 180.0, "voussoirs": 40}},
    ),
)
def dry_stones_by_elements(deck: Deck, within: float) -> None:
    """Blocks with dry joints have no greater capacity by finite elements than by limit analysis."""
    most = ask(deck, "tilt").capacity[0]
    answer = ask(changed(deck, motion=WEAK), "sla", events=300, directions=["+"])
    if not answer.answers or answer.results.peak_acceleration_g is None:
        must(not (most == 0.0 and answer.outcome == "stands"), "it cannot stand, and stands by elements")
        return
    at_most("elements", answer.results.peak_acceleration_g, most, within, 0.1)


MORTAR = {"cohesion": 1e3, "shear_energy": 10.0, "tension": 1e3, "fracture_energy": 5.0}


SOLE = {
    "structure": {
        "kind": "building",
        "storeys": [3.0],
        "beds": [{"name": "sole", "storey": 1, "z": 0.0}],
        "walls": [
            {"name": name, "start": start, "end": end, "thickness": 0.4}
            for name, start, end in (
                ("south", [0.0, 0.0], [4.0, 0.0]),
                ("east", [4.0, 0.0], [4.0, 4.0]),
                ("north", [4.0, 4.0], [0.0, 4.0]),
                ("west", [0.0, 4.0], [0.0, 0.0]),
            )
        ],
    },
    "joints": {"friction": 0.4, **MORTAR},
    "material": CRACKS,
}


def on_a_sole(deck: Deck) -> Deck:
    """A house on a weak sole."""
    return changed(deck, structure={"beds": [{"name": "sole"}]}, joints=MORTAR)


@relation("pushover", decks("building", friction=number(0.2, 0.6), material=MASONRY).map(on_a_sole), 0.02, share=0.3, examples=(SOLE,))
def no_more_than_coulomb(deck: Deck, within: float) -> None:
    """On a weak sole the building slides: its capacity stays below friction times the weight and cohesion times the area. A model that
    carries more says that this is an upper bound."""
    # Of two storeys that soften, a step takes up to forty solutions: sixty steps of a coarse mesh pass the first sliding
    keys = {"mesh": {"size": 1.0}, "events": 2000} if len(deck["structure"]["storeys"]) == 1 else {"mesh": {"size": 1.5}, "events": 60}
    keys["mesh"] |= {"layers": 3}
    answer = ask(deck, "pushover", direction=0.0, **keys)
    ok(answer)
    r = answer.results
    area = sum(math.dist(w["start"], w["end"]) * w["thickness"] for w in deck["structure"]["walls"])
    most = deck["joints"]["friction"] * r.weight_N + deck["joints"]["cohesion"] * area
    at_most("capacity", r.capacity_N, most, within)
    if r.greatest_load_N is not None and r.greatest_load_N > (1.0 + within) * most:
        must(
            answer.verdict.bound == "upper" and "Coulomb" in answer.result.answer and bool(answer.verdict.violated),
            f"{r.greatest_load_N:.4g} N of at most {most:.4g} N, said: {answer.verdict.statement}",
        )


@relation("rocking", st.tuples(RECTANGLES, st.sampled_from(["winkler", "two-spring"])), 0.02)
def a_stiff_base(size: tuple, foundation: str, within: float) -> None:
    """A very stiff base equals a rigid base; a more compliant base gives less capacity."""
    width, height = size
    deck = {
        "structure": {"kind": "block", "width": width, "height": height},
        "joints": {"friction": 2.0},
        "motion": {"kind": "sine-pulse", "amplitude": "0.05 g", "period": 0.5},
    }
    capacity = []
    for stiffness in (1e9, 1e13):
        answer = ask(changed(deck, supports={"stiffness": stiffness, "foundation": foundation}), "rocking", end_time=0.02)
        ok(answer)
        capacity.append(answer.results.soft_base.capacity_g)
    near("stiff", capacity[1], width / height, within)
    at_most("soft", capacity[0], capacity[1], 1e-6)


@st.composite
def held_down(draw: st.DrawFn) -> Deck:
    """A squat hollow block that a rod through its axis holds down; it slides before it rocks."""
    height, width = draw(number(0.5, 0.8)), draw(number(1.0, 2.0))
    structure = {"kind": "chimney", "width": width, "height": height, "thickness": 0.3 * width, "rings": 1, "facets": 4}
    rod = {
        "name": "rod",
        "start": [0.0, 0.0, 0.9 * height],
        "start_stone": "",
        "ground": [0.0, 0.0, -1.0],
        "yield_force": draw(number(0.3, 1.0)),
    }
    return {"structure": structure, "joints": {"friction": draw(number(0.1, 0.35))}, "ties": [rod]}


@relation("strengthen", st.tuples(held_down(), number(0.05, 0.95)), 1e-3)
def a_target_is_met_by_the_state_without_dilatancy(deck: Deck, share: float, within: float) -> None:
    """Dilatant sliding stretches the rod, mu (1 + F/W); without dilatancy it is slack, mu. A target between both is not met."""
    bare = building({k: v for k, v in deck.items() if k != "ties"}).solids()
    friction, part = deck["joints"]["friction"], deck["ties"][0]["yield_force"]
    rod = {**deck["ties"][0], "start_stone": bare.block_names[0], "yield_force": part * float(bare.mass.sum()) * GRAVITY}
    for target, met in ((friction * (1.0 + share * part), False), (friction * (1.0 - share), True)):
        keys = {"acceleration": f"{target!r} g", "directions": [0.0, 90.0], "ties": [rod | {"name": "another", "yield_force": 1.0}]}
        found = ask(changed(deck, ties=[rod]), "strengthen", **keys)
        ok(found)
        near("the upper bound of a block that a rod holds down", found.results.value_before, friction * (1.0 + part), within)
        must(found.results.met_before is met, f"target {target} of {friction} and {friction * (1.0 + part)}: {found.results.met_before}")
