"""Discrete elements: closed forms of springs and friction, and elements in space as in the plane."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Answer, Broken, Deck, ask, at_most, must, near
from buildings import changed, decks, number
from conservation import building
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, RECTANGLES, RIGID, SLIDERS, SLOW, ok, relation

import extrados


def in_space(deck: Deck, kind: str, **keys: Any) -> Answer:
    """What a strategy says of the section drawn out to its depth, pushed along x."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "stones.json").write_text(extrados.export({**deck, "analysis": [{"kind": "tilt"}]}, "compas"))
        there = {**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}}
        return ask(there, kind, Path(folder), direction=0.0, **keys)


def waving(deck: Deck, amplitude: float, period: float) -> Deck:
    """A deck under one sine; amplitude in g."""
    return changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude:.5g} g", "period": period})


def places(answer: Answer, axis: int) -> np.ndarray:
    """Places of the centroids along x (0) or upward (1) (time, block) [m], of a run in the plane or in space."""
    arrays = answer.result.arrays
    if "place" in arrays:
        return np.asarray(arrays["place"].data)[:, :, axis]
    return (np.asarray(arrays["solid_centroid"].data) + np.asarray(arrays["pose"].data)[:, :, :3])[:, :, 2 * axis]


#: Time in which a springing moves [s]. An arch whose springing moves nearly across its last voussoir passes a fork: that voussoir turns
#: alone, or all turn. Dashpots and the last corner to close decide, in the plane too: of radius 1 m, thickness .0313 m, 120 degrees and
#: 5 voussoirs with both movements -1 %, blocks move by 7.31 mm in 3 s, 7.19 mm in 4 s and 11.77 mm in 6 s and 12 s; in space by
#: 11.83, 7.24, 11.77 and 11.76 mm. Both find both states, but not at the same pace.
PACES = (3.0, 6.0, 12.0)


def arch(thickness: float, rigid: bool) -> tuple[Deck, float, float, bool]:
    """One that passes a fork."""
    there = {"kind": "arch", "radius": 1.0, "thickness": thickness, "embrace": 120.0, "voussoirs": 5}
    return {"structure": there, "joints": {"friction": 0.5}}, -0.01, -0.01, rigid


@relation(
    "dem",
    st.tuples(decks("arch", friction=number(0.5, 0.9, 5)), number(-0.01, 0.01), number(-0.01, 0.01), st.booleans()),
    0.05,
    share=0.2,
    exception="where an arch passes a fork, the state that it takes at one pace may be one that the other takes at another",
    examples=(arch(0.0313, False), arch(0.045, False)),
)
def supports_that_move_in_space(deck: Deck, spread: float, lift: float, rigid: bool, within: float) -> None:
    """An arch whose springing moves does so in space as in the plane, where dz in space is dy, and the supports do the same work."""
    last = building(deck).blocks().joint_names[-1]
    size = deck["structure"]["radius"]
    least = 1e-4 * size * float(building(deck).blocks().mass.sum()) * GRAVITY
    deck = changed(deck, joints={} if rigid else {"normal_stiffness": 1e9})
    found: list[list[tuple[float, float]]] = [[], []]
    first: Broken | None = None
    for pace in PACES:
        move = {"joint": last, "dx": round(spread * size, 5), "duration": pace}
        flat, deep = (changed(deck, initial={"movements": [{**move, up: round(lift * size, 5)}]}) for up in ("dy", "dz"))
        keys: Deck = {"end_time": pace + 0.2, "perturbed": False, **(RIGID if rigid else {})}
        both = ask(flat, "dem", **keys), ask(deep, "dem", direction=0.0, **keys)
        if not all(one.answers and one.results.outcome != "collapse" for one in both):
            reject()
        for one, known in zip(both, found, strict=True):
            known.append((one.results.peak_displacement_m, float(np.asarray(one.result.arrays["work_energy"].data)[-1])))
        newest = [(found[0][-1], there) for there in found[1][::-1]] + [(there, found[1][-1]) for there in found[0][:-1]]
        for plane, space in newest:
            try:
                near("displacement", plane[0], space[0], within, 1e-3 * size)
                near("work of the supports", plane[1], space[1], within, least)
                return
            except Broken as broken:
                first = first or broken
    raise first or Broken("nothing asked")


WALLS = decks("brickwork", "arch", "column", "blocks", friction=number(0.2, 0.9, 14))


@relation("dem", st.tuples(WALLS, number(0.1, 0.8), number(0.2, 0.6), st.booleans()), 0.05, share=0.3)
def forces_of_blocks_are_their_momentum(deck: Deck, amplitude: float, period: float, rigid: bool, within: float) -> None:
    """The forces of the pairs of a block, less weight and inertia, add up to its momentum; the losses of the pairs add up to that of the run."""
    moving = waving(changed(deck, joints={} if rigid else {"normal_stiffness": 1e9}), amplitude, period)
    answer = ask(moving, "dem", end_time=0.2, output_step=0.001, perturbed=False, **(RIGID if rigid else {}))
    if not answer.answers or answer.results.stopped != "end":
        reject()
    a = {name: np.asarray(array.data) for name, array in answer.result.arrays.items()}
    mass = building(moving).blocks().mass
    inertia = np.column_stack([a["ground"], np.full(len(a["ground"]), GRAVITY)])
    for k in range(len(mass)):
        first, second = (a["pair_block"] == k).T
        force = a["pair_force"][:, first].sum(axis=1) - a["pair_force"][:, second].sum(axis=1)
        moves = force - mass[k] * inertia
        gained = 0.0005 * (moves[1:] + moves[:-1]).sum(axis=0)
        near("momentum", gained, mass[k] * (a["rate"][-1, k, :2] - a["rate"][0, k, :2]), within, 0.2 * mass[k] * GRAVITY)
    near("friction of the pairs", a["pair_friction_work"][-1].sum(), answer.results.friction_loss_J, 1e-8, 1e-6)


PIERS = st.tuples(decks("block", "column", friction=number(0.5, 0.9, 8)), number(1.2, 1.8), number(0.3, 0.6, 12), st.booleans())


@relation("dem", PIERS, 0.15)
def elements_in_space_and_in_the_plane(deck: Deck, ratio: float, period: float, rigid: bool, within: float) -> None:
    """A pier under one sine rocks or slides in space as in the plane, with the same losses of energy."""
    there = deck["structure"]
    there["height"] = float(f"{there['width'] * 2.5:.5g}")
    there |= {"drums": min(there["drums"], 2), "top_width": there["width"]} if there["kind"] == "column" else {}
    there["depth"] = 1.5
    amplitude = ratio * min(0.4, deck["joints"]["friction"])
    keys = RIGID if rigid else {}
    moving = waving(changed(deck, joints={} if rigid else {"normal_stiffness": 1e9}), amplitude, period)
    plane, space = (how(moving, "dem", end_time=2.0 * period, time_step=5e-4, **keys) for how in (ask, in_space))
    ok(plane, space)
    a, b = plane.results, space.results
    if min(a.peak_displacement_m, b.peak_displacement_m) > 0.3 * there["width"]:
        reject()  # on the edge of collapse last digits decide
    must(a.outcome == b.outcome, f"{a.outcome} in the plane, {b.outcome} in space")
    size = there["width"]
    near("peak displacement", a.peak_displacement_m, b.peak_displacement_m, within, 0.02 * size)
    near("slip", a.peak_slip_m, b.peak_slip_m, within, 0.02 * size)
    if rigid:  # dampers of springs act at other points in space
        scale = a.peak_kinetic_energy_J
        near("peak kinetic energy", scale, b.peak_kinetic_energy_J, 2.0 * within)
        near("losses", a.friction_loss_J + a.damping_loss_J, b.friction_loss_J + b.damping_loss_J, within, 0.5 * scale)
    for told, r in (("plane", a), ("space", b)):
        at_most(f"residual of energy in {told}", r.energy_residual_ratio, 0.02, 0.0)


STACKS = st.tuples(decks("block", "column", friction=number(0.6, 0.9)), number(7.0, 10.0), number(0.5, 2.0), st.booleans())


@relation("dem", STACKS, 1e-3)
def settlements_of_springs(deck: Deck, power: float, depth: float, solid: bool, within: float) -> None:
    """Piers settle on the springs of their joints by weight over stiffness and area, drum by drum; other blocks do not move."""
    there = deck["structure"]
    there["depth"] = depth
    if there["kind"] == "column":
        there["top_width"] = there["width"]
    stiffness = float(f"{10.0**power:.4g}")
    quiet = waving(changed(deck, joints={"normal_stiffness": stiffness}), 1e-6, 0.5)
    answer = (in_space if solid else ask)(quiet, "dem", end_time=0.02)
    ok(answer)
    drums = there.get("drums", 1)
    high = there["height"] / drums
    place = places(answer, 1)[0]
    above = np.arange(drums, 0, -1) * 2000.0 * GRAVITY * high
    want = (np.arange(drums) + 0.5) * high - np.cumsum(above / stiffness)
    near("settled places", np.sort(place), want, within * float(np.sum(above)) / stiffness / there["height"])


@relation(
    "dem",
    st.tuples(
        number(0.5, 2.0),
        number(0.3, 0.6),
        number(0.15, 0.4),
        number(1.3, 2.0),
        number(0.2, 0.5),
        st.sampled_from(["rigid", "springs"]),
        st.booleans(),
    ),
    0.04,
)
def work_of_friction(
    width: float, slenderness: float, mu: float, ratio: float, period: float, how: str, solid: bool, within: float
) -> None:
    """Friction dissipates the coefficient times the weight times the sliding distance of a block."""
    height = round(width * slenderness, 4)
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": mu}}
    keys = {"output_step": 0.002, "time_step": 5e-4, **(RIGID if how == "rigid" else {})}
    if how == "springs":
        deck["joints"]["normal_stiffness"] = 1e9
    answer = (in_space if solid else ask)(waving(deck, ratio * mu, period), "dem", end_time=period + 0.5, **keys)
    ok(answer)
    r = answer.results
    x = places(answer, 0)[:, 0]
    near("work of friction", r.friction_loss_J, mu * 2000.0 * GRAVITY * width * height * float(np.abs(np.diff(x)).sum()), within)
    near("slip", r.peak_slip_m, np.abs(x - x[0]).max(), within, 0.01 * width)
    at_most("residual of energy", r.energy_residual_ratio, 0.01, 0.0)


@relation("dem", st.tuples(RECTANGLES, number(0.2, 3.0), st.booleans()), 0.015, share=0.5)
def mortar_at_the_ends_of_a_joint(size: tuple, strength: float, solid: bool, within: float) -> None:
    """On springs with mortar a block separates when the tension at an edge reaches the tensile strength times half the area."""
    width, height = size
    weight = 2000.0 * GRAVITY * width * height
    tension = float(f"{strength * weight / width:.4g}")
    deck = {
        "structure": {"kind": "block", "width": width, "height": height},
        "joints": {"friction": 0.9, "normal_stiffness": 1e10, "tension": tension, "cohesion": 1e8},
    }
    keys = {"test": "tilt", "tilt_accuracy": 2e-3 * width / height, "tilt_limit": f"{10.0 * width / height:.4g} g"}
    answer = (in_space if solid else ask)(deck, "dem", **keys)
    ok(answer)
    want = width / height * (1.0 + tension * width / weight)
    near("collapse acceleration", answer.capacity, [want, want], within)


@relation("dem tilt", st.tuples(SLIDERS, st.booleans(), st.booleans()), 0.01, share=0.5)
def a_tilt_that_slides(deck: Deck, rigid: bool, solid: bool, within: float) -> None:
    """A flat block in a slow tilt slides at its coefficient of friction, on rigid contacts and springs, in the plane and in space."""
    mu = deck["joints"]["friction"]
    made = deck if rigid else changed(deck, joints={"normal_stiffness": 1e9})
    keys = SLOW if rigid else {"test": "tilt", "tilt_accuracy": 0.002}
    answer = (in_space if solid else ask)(made, "dem", **keys)
    ok(answer)
    near("collapse acceleration", answer.capacity, [mu, mu], within, 0.2)
