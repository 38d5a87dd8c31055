"""Parts of the program that few decks reach: each against the same question asked in another way, or by hand."""

import csv
import itertools
import math
import tempfile
from pathlib import Path

import numpy as np
import tomlkit
from asking import Deck, ask, at_most, must, near
from buildings import changed, decks, drawn, number, pulses
from conservation import building
from definitions_codes import UNIT, code_spectrum, floor_spectrum
from definitions_keys import PULSE
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, RIGID, ok, relation
from scipy.optimize import linprog

from extrados.analyses.assess.asking import Asker
from extrados.analyses.assess.budget import OutOfTime
from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.results.store import StoreError
from extrados.running import survey

# ----- moving loads and applied loads

SERVICES = st.fixed_dictionaries(
    {"strength_share": number(0.3, 0.9, 6), "passive_share": st.sampled_from([0.0, 0.5, 1.0]), "live": st.sampled_from([1.0, 1.25])}
)
SPANS = st.tuples(number(4.0, 8.0, 8), number(0.3, 0.45, 3), st.booleans(), number(2e6, 6e6, 4), number(1.0, 3.0, 4))


@relation("moving-load", st.tuples(SPANS, SERVICES, st.sampled_from([1.0, 1.3])), 1e-4, share=0.5)
def permissible_loads_are_those_of_weaker_bridges(span: tuple, service: Deck, dynamic: float, within: float) -> None:
    """The permissible factor is the adequacy factor of the bridge whose strength and passive pressure are the permissible ones, without partial
    factors; it is zero where the bridge does not stand so."""
    length, rise, filled, strength, depth = span
    structure: Deck = {
        "kind": "bridge",
        "spans": [{"span": length, "rise": round(rise * length, 4), "thickness": round(0.12 * length, 4), "voussoirs": 8}],
        "depth": depth,
    }
    if filled:
        structure["fill"] = {"cover": 0.3, "passive": 1.0}
    deck: Deck = {"structure": structure, "joints": {"friction": 0.7}, "material": {"compressive_strength": strength}}
    low, high = (float(getattr(building(deck).blocks().p[:, 0], end)()) for end in ("min", "max"))
    train: Deck = {"axles": [0.0, 1.2], "places": [round(low + s * (high - low), 4) for s in (0.35, 0.5, 0.6)]}
    train["axle_loads"] = [2e4, 3e4]
    factors = {"masonry": 1.2, "fill": 1.3, "live": 1.5, "dynamic": dynamic, "strength": 1.4, "friction": 1.2}
    whole = ask(deck, "moving-load", **train, factors=factors, serviceability=service)
    weaker = changed(deck, material={"compressive_strength": strength * service["strength_share"]})
    if filled:
        weaker["structure"]["fill"]["passive"] = service["passive_share"]
    other = ask(weaker, "moving-load", **train, factors={"dynamic": dynamic})
    ok(whole, other)
    r = whole.results
    near("permissible stress", r.permissible_stress_Pa, strength * service["strength_share"], within)
    near("permissible factor", r.permissible_factor * service["live"], other.results.adequacy_factor, within)
    near("place", r.permissible_place_m, float(np.asarray(other.result.arrays["axle"].data)[0]), within, 1.0)
    words = whole.verdict.statement
    must(("exceeds the permissible" in words) == (r.permissible_factor < 1.0), words)
    crushed = changed(deck, material={"compressive_strength": 1e3 * strength})
    none = ask(crushed, "moving-load", **train, serviceability={"strength_share": 1e-6})
    ok(none)
    must(none.results.permissible_factor == 0.0, f"permissible {none.results.permissible_factor} of stones that cannot carry their weight")


def top_of(vertices: list[np.ndarray], x: float, y: float) -> float | None:
    """Height of the highest point at (x, y) of convex bodies given by their vertices [m]; None beside all."""
    found = []
    for points in vertices:
        if not (points[:, :2].min(axis=0) < [x, y]).all() or not (points[:, :2].max(axis=0) > [x, y]).all():
            continue
        n = len(points)
        equal = np.vstack([points[:, 0], points[:, 1], np.ones(n)])
        best = linprog(-points[:, 2], A_eq=equal, b_eq=[x, y, 1.0], bounds=[(0.0, None)] * n)
        found += [-best.fun] if best.status == 0 else []
    return max(found, default=None)


@relation(
    "tilt", st.tuples(decks("wall", "dome", "chimney"), number(0.02, 0.98, 96), number(0.02, 0.98, 96), number(0.05, 0.5)), 1e-6, share=0.5
)
def a_load_on_solids_acts_on_their_top(deck: Deck, along: float, across: float, share: float, within: float) -> None:
    """A load without a height acts on the highest surface below, and is refused if no surface is below."""
    solids = building(deck).solids()
    points = np.concatenate([p.vertices for p in solids.parts])
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = (round(float(low[k] + s * (high[k] - low[k])), 4) for k, s in ((0, along), (1, across)))
    top = top_of([p.vertices for p in solids.parts], x, y)
    force = round(share * GRAVITY * float(solids.mass.sum()), 1)
    keys: Deck = {"direction": 0.0, "rose": 4, "starts": 1, "face_law": False, "block_size": False}
    free = ask(deck, "tilt", **keys, load=[{"x": x, "y": y, "force": force}])
    if top is None:
        must(free.status == "refused" and "beside" in free.said, f"a load beside all blocks: {free.outcome} {free.said}")
        return
    given = ask(deck, "tilt", **keys, load=[{"x": x, "y": y, "z": top - 1e-7, "force": force}])
    must((free.status, free.outcome) == (given.status, given.outcome), f"{free.outcome} {free.said} against {given.outcome} {given.said}")
    ok(free, given)
    near("capacity", free.capacity, given.capacity, within, 1.0)


@relation("tilt", st.tuples(decks("arch", "pointed-arch", "brickwork"), number(0.1, 3.0), st.booleans()), 1e-3)
def loads_beside_the_structure(deck: Deck, away: float, left: bool, within: float) -> None:
    """A load beside the structure is refused, with the load, its place and the ends of the structure."""
    points = np.concatenate(building(deck).blocks().outlines)
    low, high = float(points[:, 0].min()), float(points[:, 0].max())
    x = round(low - away if left else high + away, 4)
    answer = ask(deck, "tilt", load=[{"x": round(0.5 * (low + high), 4), "force": 1.0}, {"x": x, "force": 1e3}])
    must(answer.status == "refused", f"a load at {x} of {low} to {high}: {answer.outcome}")
    said = [float(w.strip(",;:()")) for w in answer.said.split() if w.strip(",;:()-").replace(".", "", 1).isdigit()]
    for value in (x, low, high):
        must(any(abs(value - v) <= within * max(abs(value), 1.0) for v in said), f"no {value} in: {answer.said}")
    inside = ask(deck, "tilt", load=[{"x": round(0.5 * (low + high), 4), "y": round(float(points[:, 1].max()) + away, 4), "force": 1e3}])
    must(inside.status == "refused" and "no block" in inside.said, f"{inside.outcome} {inside.said}")


@relation(
    "tilt sweep",
    st.tuples(
        st.sampled_from(["dejong-a", "dejong-b"]),
        st.tuples(number(3.9, 6.5), st.just(0.8))  # slender ones do not stand with a crack
        | st.tuples(number(14.0, 24.0), st.just(0.8))
        | st.tuples(number(20.0, 26.0), st.just(0.2)),  # the vault slides before the buttress cracks
        number(1.05, 1.4),
        st.sampled_from([8, 12]),
    ),
    1e-5,
    share=0.5,
)
def cracked_buttresses_are_cut_blocks(preset: str, wide: tuple[float, float], more: float, voussoirs: int, within: float) -> None:
    """The capacity with a cracked buttress is that of the same blocks with the buttress cut along the crack; a sweep has both, and the buttress alone."""
    width, friction = wide
    deck: Deck = {
        "structure": {"kind": "vault", "preset": preset, "buttress_width": width, "voussoirs": voussoirs},
        "joints": {"friction": friction},
    }
    answer = ask(deck, "tilt", fracture=True)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    f = r.fracture
    name = drawn(deck)["structure"]["block"][-1]["name"] if f.buttress is None else f.buttress
    values = [width, round(width * more, 4)]
    swept = ask(deck, "sweep", vary="buttress_width", values=values, fracture=True, buttress_alone=True, locate=False)
    ok(swept)
    s = {k: np.asarray(v.data) for k, v in swept.result.arrays.items()}
    near("capacity of a sweep", s["gamma"][0], r.collapse_acceleration_g, within)
    blocks = drawn(deck)
    alone = changed(blocks, structure={"block": [b for b in blocks["structure"]["block"] if b["name"] == name]})
    by_itself = ask(alone, "tilt")
    ok(by_itself)
    near("buttress alone", s["buttress_alone"][0], by_itself.results.collapse_acceleration_g, within)
    if not f.stands and f.stands is not None:
        must("cannot stand" in answer.warnings, answer.warnings)
        return
    if not f.cracks:
        near("without a crack", [f.collapse_acceleration_g, f.ratio], [r.collapse_acceleration_g, 1.0], within)
        return
    near("tilt of the ground", f.tilt_angle_deg, math.degrees(math.atan(f.collapse_acceleration_g)), within)
    near("ratio", f.ratio, f.collapse_acceleration_g / r.collapse_acceleration_g, within)
    near("capacity of a sweep, cracked", s["fractured"][0], f.collapse_acceleration_g, within)
    at_most("cracked", f.collapse_acceleration_g, r.collapse_acceleration_g, within)
    near("third point", f.resultant_from_outer_face_ratio, 1.0 / 3.0, 1e-3)
    k = next(i for i, b in enumerate(blocks["structure"]["block"]) if b["name"] == name)
    starts = a["crack_outline_start"].astype(int)
    outline, line = a["crack_outline"][starts[k] : starts[k + 1]], a["crack"]
    whole = np.array(blocks["structure"]["block"][k]["points"])
    near("height of the crack", f.crack_height_m / float(np.ptp(whole[:, 1])), f.crack_height_ratio, within)
    near("height of its end", float(np.ptp(line[:, 1])), f.crack_height_m, within)
    blocks["structure"]["block"][k]["points"] = outline.tolist()
    foot = [
        row for row in blocks["structure"]["ground"] if not whole[:, 0].min() - 1e-6 <= 0.5 * (row[0] + row[2]) <= whole[:, 0].max() + 1e-6
    ]
    blocks["structure"]["ground"] = [*foot, [float(v) for v in line.ravel()]]
    cut = ask(blocks, "tilt")
    ok(cut)
    near("cut along the crack", cut.results.collapse_acceleration_g, f.collapse_acceleration_g, 1e-4)


@relation(
    "tilt", st.tuples(decks("arch", "pointed-arch", "brickwork", "column"), number(0.1, 0.9, 80), number(0.02, 0.2, 9), st.booleans()), 1e-6
)
def a_load_acts_on_the_surface_below(deck: Deck, share: float, part: float, sways: bool, within: float) -> None:
    """A horizontal or swaying load without a height acts at the highest point of the blocks below it."""
    blocks = building(deck).blocks()
    points = np.concatenate(blocks.outlines)
    x = round(float(points[:, 0].min() + share * np.ptp(points[:, 0])), 5)
    tops = []
    for one in blocks.outlines:
        for (xa, ya), (xb, yb) in zip(one, np.roll(one, -1, axis=0), strict=True):
            if xa != xb and min(xa, xb) <= x <= max(xa, xb):
                tops.append(float(ya + (x - xa) / (xb - xa) * (yb - ya)))
    force = round(part * GRAVITY * float(blocks.mass.sum()), 2)
    load: Deck = {"x": x, "force": force, "sways": True} if sways else {"x": x, "force": force, "horizontal": round(0.3 * force, 2)}
    free, given = (ask(deck, "tilt", load=[{**load, **more}]) for more in ({}, {"y": max(tops) - 1e-9}))
    must((free.status, free.outcome) == (given.status, given.outcome), f"{free.outcome} {free.said} against {given.outcome} {given.said}")
    ok(free, given)
    near("capacity", free.capacity, given.capacity, within, 1.0)


PANELS = st.tuples(number(1.0, 3.0, 8), number(1.0, 3.0, 8), number(0.2, 0.4, 4), number(5e4, 2e5, 6))


@relation("sla", st.tuples(PANELS, number(1.5, 6.0, 9), st.sampled_from([1.0, -1.0])), 1e-6, share=0.5)
def loads_that_a_panel_does_not_carry(panel: tuple, factor: float, side: float, within: float) -> None:
    """A panel under a constant horizontal load beyond that which tears or overturns it: its outcome is open, with the end of the run; under a
    hundredth of that load it has a capacity."""
    width, height, thickness, strength = panel
    deck: Deck = {
        "structure": {"kind": "panel", "width": width, "height": height, "thickness": thickness},
        "material": {"density": 2000.0, "young": 2e9, "tensile_strength": strength, "fracture_energy": 50.0},
    }
    # Twice the moment of the weight and of the whole section at its strength
    force = 2.0 * (UNIT * width * height * thickness * width + strength * thickness * width**2) / height
    found = []
    for times in (factor, 0.01):
        load = [{"kind": "gravity"}, {"kind": "spread", "edge": "top", "fx": side * times * force}]
        found.append(ask(deck, "sla", constant=load, mesh={"size": 0.5}, events=200, directions=["+"]))
    beyond, small = found
    must(beyond.status == "ok" and beyond.outcome == "open", f"beyond its strength {beyond.outcome} {beyond.said}")
    must(not beyond.results.proven and beyond.verdict.violated != [], f"{beyond.verdict}")
    must(small.answers, f"a small load is not carried: {small.said or small.outcome}")


# ----- codes


@st.composite
def strips(draw: st.DrawFn) -> tuple[Deck, float | None]:
    """A strip of wall between side walls, and its compressive strength."""
    table: Deck = {
        "mechanism": "horizontal-bending",
        "height": draw(number(1.0, 3.0, 8)),
        "thickness": draw(number(0.3, 0.8, 5)),
        "width": draw(number(3.0, 8.0, 10)),
        "hinge_height": draw(st.sampled_from([0.0, 0.5])),
        "confidence_factor": draw(st.sampled_from([1.0, 1.35])),
    }
    floor = st.fixed_dictionaries(
        {"height": st.just(0.8), "load": number(0.0, 1e4, 4)},
        optional={"pushing": number(1e3, 5e3, 3), "sways": st.just(False), "thrust": number(50.0, 200.0, 3)},
    )
    table["floors"] = draw(st.lists(floor, max_size=2))
    given = draw(st.booleans())
    if given:
        table["abutment_force"] = draw(number(2e3, 2e4, 6))
    return table, draw(number(5e5, 3e6, 5)) if not given or draw(st.booleans()) else None


@relation("local-mechanism", strips(), 1e-6)
def strips_between_side_walls_by_hand(table: Deck, strength: float | None, within: float) -> None:
    """Horizontal bending: two halves push their side walls apart; multiplier, e* and the displacement at which the arch is straight, by hand."""
    deck: Deck = {"structure": {"kind": "block", "width": 1.0, "height": 4.0}}
    if strength is not None:
        deck["material"] = {"compressive_strength": strength}
    answer = ask(deck, "local-mechanism", **table)
    h, t, length = table["height"] - table["hinge_height"], table["thickness"], table["width"]
    weight = UNIT * t * h * length + sum(f["load"] * f.get("sways", True) + f.get("pushing", 0.0) for f in table["floors"])
    thrust = sum(f.get("thrust", 0.0) for f in table["floors"])
    if "abutment_force" in table:
        force = table["abutment_force"]
        depth = 0.0 if strength is None else force / (strength * h)
    else:  # the depth a at which f h a (t - a) is greatest
        depths = np.linspace(0.0, t, 2001)
        depth = float(depths[np.argmax(strength * h * depths * (t - depths))])
        force = strength * h * depth
    if depth > 0.5 * t * (1.0 + 1e-9):
        must(answer.status == "refused", answer.outcome)
        return
    # Three hinges in plan: the thrust's couple at mid length against the load w = alpha W + V over the length
    alpha = (8.0 * force * (t - depth) / length - thrust) / weight
    if alpha <= 0.0:
        must(answer.outcome == "cannot-stand", f"alpha {alpha}, but {answer.outcome}")
        return
    ok(answer)
    r = answer.results
    near("alpha_0", r.multiplier, alpha, within)
    near("e*", r.participating_part, 1.0, within)
    near("M*", r.participating_mass_kg, weight / GRAVITY, within)
    near("a_0*", r.activation_acceleration_g, alpha / table["confidence_factor"], within)
    crushes = "abutment_force" not in table
    must((r.zero_displacement_m is None) == crushes, f"d_0* {r.zero_displacement_m}")
    if not crushes and not thrust:
        q = math.atan2(2.0 * (t - depth), length)
        near("d_0*", r.zero_displacement_m, 0.25 * length * math.sin(q) - 0.5 * (t - depth) * (1.0 - math.cos(q)), 1e-4)


FREE = st.tuples(
    st.sampled_from(["parapet", "gable"]), number(0.8, 2.5, 9), number(0.25, 0.6, 7), number(1e9, 4e9, 6), number(0.05, 0.4, 7)
)


@relation("local-mechanism", st.tuples(FREE, st.booleans(), st.none() | number(0.1, 0.6, 5)), 1e-5)
def free_parts_respond_at_their_period(part: tuple, raised: bool, building_period: float | None, within: float) -> None:
    """Parapets and gables start at the spectrum at their own period, that of a cantilever; on a building at that of their floor."""
    mechanism, height, thickness, young, peak = part
    table: Deck = {"mechanism": mechanism, "height": height, "thickness": thickness, "width": 1.0, "confidence_factor": 1.0}
    table["spectrum"] = {"code": "NTC", "acceleration": f"{peak:g} g"}
    if raised:
        table |= {"base_height": 6.0, "building_height": 9.0, "storeys": 3} | (
            {"building_period": building_period} if building_period else {}
        )
    deck: Deck = {"structure": {"kind": "block", "width": 1.0, "height": 4.0}, "material": {"young": young, "density": 2000.0}}
    answer = ask(deck, "local-mechanism", **table)
    ok(answer)
    # First bending frequency of a uniform cantilever: 1.8751^2/(2 pi) sqrt(EI/(m h^4))
    own = 2.0 * math.pi / 1.8751041**2 * height**2 * math.sqrt(12.0 * 2000.0 / young) / thickness
    ground = peak * GRAVITY
    first = building_period or 0.05 * 9.0**0.75
    a_z = code_spectrum(ground, first, 0.05) * 6.0 / 9.0 * 9.0 / 7.0 * math.sqrt(1.0 + 4e-4 * 25.0)
    felt = floor_spectrum(a_z, first, ground, own, 0.05) if raised else code_spectrum(ground, own, 0.05)
    starts = [c for n, c in answer.results.checks.items() if n.startswith(("NTC activation", "NTC linear"))]
    must(bool(starts), f"{sorted(answer.results.checks)}")
    for check in starts:
        near("S_eZ(T_0)", check.demand, felt / GRAVITY, 2e-3)
        at_most("capacity", answer.results.activation_acceleration_g, check.capacity, within)


# ----- motions, surveys, time


@relation("fragility", st.tuples(decks("block"), pulses(0.2, 0.8), st.sampled_from(["sa", "arias", "pga"]), number(0.2, 1.0, 8)), 1e-3)
def measures_of_a_pulse(deck: Deck, motion: Deck, intensity: str, period: float, within: float) -> None:
    """An ensemble of one pulse, scaled to a level of its own intensity, is the pulse: factor 1 at SA, Arias intensity or peak by `motion`."""
    shaken = changed(deck, motion=motion)
    own = ask(shaken, "motion")
    ok(own)
    r, a = own.results, {k: np.asarray(v.data) for k, v in own.result.arrays.items()}
    level = {"pga": r.pga_g, "arias": r.arias_m_s}.get(intensity)
    keys: Deck = {}
    k, i = int(np.abs(a["damping"] - 0.05).argmin()), int(np.abs(a["period"] - period).argmin())
    if intensity == "sa":
        level, keys = float(a["psa"][k, i]) / GRAVITY, {"sa_period": float(a["period"][i])}
    answer = ask(shaken, "fragility", levels=[level, 2.0 * level], intensity=intensity, bootstrap=0, **keys)
    ok(answer)
    grows = 2.0 if intensity != "arias" else math.sqrt(2.0)
    near("peak of the scaled motion", answer.results.median_pga_g, [r.pga_g, grows * r.pga_g], 1e-2 if intensity == "sa" else within)


#: Two blocks on ground that shakes long enough to outlast any limit of these relations
LONG = {
    "structure": {"kind": "stack", "lower_width": 1.0, "lower_height": 1.0, "upper_width": 0.5, "upper_height": 1.5},
    "joints": {"friction": 0.8},
}


@relation("assess dem", st.tuples(number(10.0, 1000.0), number(0.02, 0.2)), 0.0, share=0.25)
def a_strategy_ends_at_its_deadline(start: float, seconds: float, within: float) -> None:
    """A strategy of an assessment that takes longer than the remaining budget is stopped; a shorter one has its result; after the deadline none begins."""
    del within
    deck = make_deck({**LONG, "motion": PULSE, "analysis": [{"kind": "assess"}]})
    passed = [start]

    def clock() -> float:
        passed[0] += 1e-3  # each look takes a millisecond
        return passed[0]

    keys = {"end_time": 40.0, "time_step": 5e-4, "perturbed": False, **RIGID}
    asker = Asker(Context(deck, 1), PULSE, start + seconds, clock)
    try:
        asker.ask("dem", keys)
    except OutOfTime:
        pass
    else:
        must(False, f"a run outlasts the {seconds} s that are left")
    late = Asker(Context(deck, 1), PULSE, start, clock)
    try:
        late.ask("tilt", {})
    except OutOfTime:
        pass
    else:
        must(False, "a strategy begins after the deadline")
    early = Asker(Context(deck, 1), PULSE, start + 1e9, lambda: start)
    must(early.ask("tilt", {})[0].status == "ok", "no result before the deadline")


class Stop(Exception):
    """What interrupts a survey."""


@relation("assess", st.permutations(["one", "two", "three"]), 0.0, share=0.25)
def a_survey_goes_on_where_it_was(names: list, within: float) -> None:
    """A survey that was interrupted continues with the buildings that are left, and only with the same decks; wrong decks are last, with their complaint."""
    del within
    block = {"structure": {"kind": "block", "width": 0.4, "height": 2.0}, "motion": PULSE}
    sizes = dict(zip(names, (0.3, 0.5, 0.7), strict=True))
    with tempfile.TemporaryDirectory() as place:
        folder, out = Path(place) / "decks", Path(place) / "out"
        folder.mkdir()
        for stem, width in sizes.items():
            one = {**changed(block, structure={"width": width}), "analysis": [{"kind": "assess", "strategies": ["tilt"]}]}
            (folder / f"{stem}.toml").write_text(tomlkit.dumps(one))
        (folder / "wrong.toml").write_text("[structure]\nkind = 'block'\nwidth = -1.0\nheight = 2.0\n")
        seen: list[float] = []

        def first(done: float, total: float, text: str) -> None:
            seen.append(done)
            if done >= 1.0 and text == "buildings":
                raise Stop

        def on(done: float, total: float, text: str) -> None:
            if text == "buildings":
                seen.append(done)

        try:
            survey.assess_folder(folder, out, progress=first, figures=False)
        except Stop:
            pass
        else:
            must(False, f"the survey does not report its buildings: {seen}")
        seen.clear()
        rows = survey.assess_folder(folder, out, progress=on, resume=True, figures=False)
        must(min(seen) >= 1.0, f"continued from {seen}")
        ranking = list(csv.DictReader((out / survey.RANKING).open()))
        try:
            (folder / f"{names[0]}.toml").write_text(tomlkit.dumps({**block, "analysis": [{"kind": "assess", "strategies": ["tilt"]}]}))
            survey.assess_folder(folder, Path(place) / "other", progress=first, figures=False)
        except Stop:
            (folder / f"{names[1]}.toml").write_text(tomlkit.dumps({**block, "analysis": [{"kind": "assess", "strategies": ["tilt"]}]}))
            try:
                survey.assess_folder(folder, Path(place) / "other", resume=True, figures=False)
            except StoreError:
                pass
            else:
                must(False, "a survey of other decks continues")
    by_name = {row.building: row for row in rows}
    must(set(by_name) == {*names, "wrong"} and [r["building"] for r in ranking] == [row.building for row in rows], f"{ranking}")
    must(by_name["wrong"].status == "wrong deck" and "width" in by_name["wrong"].statement, f"{by_name['wrong']}")
    for stem, width in sizes.items():
        peak = float(PULSE["amplitude"].split()[0])
        near(f"margin of {stem}", by_name[stem].least_margin, width / 2.0 / peak, 5e-3)
        must(by_name[stem].folder.name == stem, f"{by_name[stem]}")


# ----- lines and energies

CROSSED = {"tilt": {}, "thrust": {}, "moving-load": {"count": 3}}


@relation(
    "tilt thrust moving-load", st.tuples(decks("arch", "vault", "bridge", "column", "pointed-arch"), st.sampled_from(sorted(CROSSED))), 1e-6
)
def thrust_lines_pass_through_their_points(deck: Deck, kind: str, within: float) -> None:
    """Each state of thrust that a result has at its joints has a line, which passes through these points, is whole and has a force on each part."""
    answer = ask(deck, kind, **CROSSED[kind])
    ok(answer)
    a = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    size = float(np.ptp(a["outline"], axis=0).max())
    states = [name.removesuffix("_point") for name in a if name.endswith("_point") and a[name].ndim == 2]
    must(bool(states), f"{kind}: no state of thrust in {sorted(a)}")
    for name in states:
        must({f"{name}_line", f"{name}_line_start", f"{name}_line_of", f"{name}_line_force"} <= set(a), f"{kind}: no line of {name}")
        line, start = a[f"{name}_line"], a[f"{name}_line_start"].astype(int)
        must(start[0] == 0 and start[-1] == len(line) and bool((np.diff(start) > 1).all()), f"{kind}, {name}: parts from {start}")
        ends = [(line[i:j][:-1], line[i:j][1:]) for i, j in itertools.pairwise(start)]
        one, two = (np.concatenate(side) for side in zip(*ends, strict=True))
        for j, point in enumerate(a[f"{name}_point"]):
            if not np.isfinite(point).all():
                continue
            along = two - one
            share = np.clip(((point - one) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0.0, 1.0)
            gap = float(np.hypot(*(one + share[:, None] * along - point).T).min())
            must(gap <= within * size, f"{kind}, {name}: the line passes joint {j} at {gap} m")


DAMPED = st.tuples(number(0.6, 1.2, 6), number(2.5, 4.0, 6), number(0.05, 0.4, 7), number(0.4, 0.8, 4), number(0.0, 80.0, 8))


@relation("dem", st.tuples(DAMPED, pulses(0.3, 0.6)), 0.005, share=0.5)
def energies_of_damped_solids(column: tuple, motion: Deck, within: float) -> None:
    """For blocks in space on damped springs the work of the ground equals motion, height, springs and losses; the losses never decrease."""
    width, slender, ratio, friction, way = column
    structure = {"kind": "column", "section": "round", "sides": 8, "drums": 2, "width": width, "height": round(width * slender, 4)}
    deck = {"structure": structure, "joints": {"friction": friction, "normal_stiffness": 1e8, "damping_ratio": ratio}, "motion": motion}
    answer = ask(deck, "dem", direction=way, end_time=0.8, output_step=0.01, perturbed=False)
    ok(answer)
    e = {k.removesuffix("_energy"): np.asarray(v.data) for k, v in answer.result.arrays.items() if k.endswith("_energy")}
    change = {k: v - v[0] for k, v in e.items()}
    left = change["kinetic"] + change["potential"] + change["elastic"] + change["friction"] + change["damping"] - change["work"]
    scale = float(max(np.abs(change[k]).max() for k in ("kinetic", "potential", "work")))
    if scale < 1.0:
        reject()  # at rest
    near("energy balance", left, np.zeros(len(left)), within, scale)
    near("residual", e["residual"], left + e["residual"][0], within, scale)
    for name in ("friction", "damping"):
        must(bool((np.diff(e[name]) >= -1e-3 * within * scale).all()), f"losses by {name} fall")
