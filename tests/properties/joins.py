"""What passes from one part of the program to the next: remarks, violated assumptions, ties, load paths, sizes."""

import itertools

import numpy as np
from asking import Deck, ask, at_most, must, near
from buildings import SOLIDS, changed, decks, drawn, number, pulses, signed_area
from conservation import building
from definitions_keys import DRUMS, PULSE
from fields import compare_named, leaning, mirrored_question, questions
from hypothesis import reject
from hypothesis import strategies as st
from relations import EARTHQUAKES, RIGID, SLOW, ok, relation

from extrados.analyses.left_out import left_out
from extrados.decks.reader import make_deck
from extrados.model.geometry.convex import overlap_depth
from extrados.model.properties import Material
from extrados.views.rigid import rigid_bodies

LEFT_OUT = st.sampled_from(
    [
        ("joints", "cohesion", 1e5),
        ("joints", "restitution", 0.7),
        ("joints", "normal_stiffness", 1e8),
        ("material", "compressive_strength", 1e6),
        ("supports", "stiffness", 1e8),
    ]
)


@relation("tilt thrust rocking", st.tuples(st.permutations(["tilt", "thrust", "rocking", "supports"]), LEFT_OUT), 0.0)
def the_first_that_leaves_a_key_out_says_so(asked: list, given: tuple, within: float) -> None:
    """A remark on a key belongs to the first analysis of the deck that does not use it."""
    table, key, value = given
    rows = [{"kind": kind} for kind in asked]
    made = make_deck(changed({**DRUMS, "motion": PULSE}, **{table: {key: value}}, analysis=rows))
    uses = [f"{table}.{key}" in o.reckons_with(b) for o, b in zip(made.analyses, made.buildings, strict=True)]
    for remark in (r for r in left_out(made) if key in r.text):
        must(remark.analysis == uses.index(False), f"{key}: analysis {remark.analysis} of {asked}, which use it: {uses}")


@relation(
    "rocking fragility assessment failure-domain",
    st.tuples(decks("block", "column", "arch", friction=number(0.15, 0.9, 6)), pulses(0.1, 1.2), EARTHQUAKES),
    0.0,
)
def a_verdict_carries_what_is_violated(deck: Deck, motion: Deck, many: Deck, within: float) -> None:
    """Conditions of a result that do not hold are those of its verdict, whether it collapses or not."""
    domain = {"durations": [0.3, 0.6], "amplitudes": 3, "accuracy": 1e-2}
    asked = [
        ask({**deck, "motion": motion}, "rocking", hand_over=False, end_time=1.0),
        ask({**deck, "motion": many}, "fragility", count=4, bootstrap=0),
        ask({**deck, "motion": many}, "fragility", count=4, bootstrap=0, levels=[0.5, 1.5]),
        ask(deck, "failure-domain", **domain),
    ]
    if deck["structure"]["kind"] == "arch":
        asked.append(ask({**deck, "motion": motion}, "assessment", impulses=2))
    ok(asked[0])
    for answer in (a for a in asked if a.answers and a.results.conditions is not None):
        told = [*answer.results.conditions.violated, *(getattr(answer.results, "violated", None) or [])]
        said = " ".join(answer.verdict.violated)
        must(all(text in said for text in told), f"{answer.result.kind}: {told} against {answer.verdict.violated}")


@relation("tilt", st.tuples(decks("block", "arch", "column", "pointed-arch", "brickwork"), number(1e2, 1e4), st.booleans()), 1e-6)
def ties_of_a_tilt(deck: Deck, force: float, across: bool, within: float) -> None:
    """Forces of ties are those of their array, at most their strength, in the states that the words name; a tie never reduces the capacity."""
    bare = leaning(deck, 0.05)
    x, y = np.mean(bare["structure"]["block"][-1]["points"], axis=0)
    row = {
        "start": [round(float(x), 6), round(float(y), 6)],
        "ground": [round(float(x) + (9.0 if across else -9.0), 6), round(float(y) - 1.0, 6)],
        "works_in": "tension",
        "yield_force": force,
    }
    free, tied = ask(bare, "tilt"), ask({**bare, "ties": [row]}, "tilt")
    ok(free, tied)
    a, r = {k: np.asarray(v.data) for k, v in tied.result.arrays.items()}, tied.results
    must({"tie_point", "tie_block", "collapse_tie_force"} <= set(a), f"arrays of ties: {sorted(a)}")
    near("tie", a["collapse_tie_force"], [t.force_N for t in r.ties], within, 1e-3)
    at_most("tie", r.ties[0].force_N, force, within)
    at_most("slack", 0.0, r.ties[0].force_N, 0.0, 1e-6)
    sort = "yields" if r.ties[0].force_N > 0.999 * force else "slack" if r.ties[0].force_N < 1e-3 else "carries"
    must(r.ties[0].state == sort, f"{r.ties[0]}")
    at_most("capacity", free.capacity, tied.capacity, 1e-5, 1e-3)


@relation("tilt", st.tuples(decks("column", "brickwork", "blocks", "stack", friction=number(0.2, 0.6, 8)), st.booleans()), 1e-6)
def the_least_state_without_dilatancy(deck: Deck, associated: bool, within: float) -> None:
    """The value without dilatancy is no greater than the end of any certified load path, nor than the associated one; the design value is the least end."""
    answer = ask(deck, "tilt", starts=2, **({} if associated else {"friction_rule": "non-associated"}))
    ok(answer)
    for sense in ("", "_opposite"):
        r = answer.results
        least = (
            getattr(r, f"collapse_acceleration_non_associated{sense}_g") if associated else getattr(r, f"collapse_acceleration{sense}_g")
        )
        paths = getattr(r, f"load_paths{sense}") or []
        ends = [p.collapse_acceleration_g for p in paths if p.certified and p.collapse_acceleration_g is not None]
        if least is None:
            continue
        at_most("least state", least, min(ends, default=np.inf), within, 1.0)
        if associated:
            at_most("least state", least, getattr(r, f"collapse_acceleration{sense}_g"), 1e-5, 1.0)
        design = getattr(r, f"collapse_acceleration_load_path{sense}_g")
        must((design is None) == (not ends), f"design value {design} of {ends}")
        near("design value", design or 0.0, min(ends, default=0.0), within)


LEANING_PIERS = st.tuples(
    decks("block", "column", friction=number(0.4, 0.9, 6)), pulses(0.3, 0.8), st.booleans(), st.sampled_from([0.03, -0.05])
)


@relation("dem", LEANING_PIERS, 0.03)
def elements_in_a_mirror(deck: Deck, motion: Deck, rigid: bool, lean: float, within: float) -> None:
    """If left and right are exchanged and the motion reversed, a short run on rigid contacts or on springs has the same numbers."""
    if deck["structure"]["kind"] == "column":
        deck["structure"]["drums"] = min(2, deck["structure"]["drums"])
    joints = {} if rigid else {"normal_stiffness": 1e9}
    made = leaning(changed(deck, motion=motion, joints=joints), lean)
    keys = {"end_time": 0.5, "time_step": 1e-3, "output_step": 0.02, "perturbed": False, **(RIGID if rigid else {})}
    there, _ = mirrored_question(made, {})
    one, other = ask(made, "dem", **keys), ask(there, "dem", **keys)
    ok(one, other)
    if one.results.peak_displacement_m < 2e-3:
        reject()  # what is left of it is rounding
    stuck = one.results.peak_slip_m < 0.01 * one.results.peak_displacement_m  # strain of joints that do not slide, and what is left of it
    skip = ("residual", "astray", "step", "growth", "spring", "loss", "elastic", *(["slip"] if stuck else []))
    compare_named("mirrored", one, other, within, skip)
    for name, rotation in one.results.peak_rotation_rad.items():
        near(f"rotation of {name}", rotation, -other.results.peak_rotation_rad[name], within, 1e-3)


@relation("dem", decks("block", "column", friction=number(0.6, 0.9, 4)), 1e-9, share=0.3)
def a_tilt_of_elements_ends_by_collapse(deck: Deck, within: float) -> None:
    """A tilt test of discrete elements ends by collapse, which its outcome, sense and verdict state."""
    answer = ask(deck, "dem", **{**SLOW, "tilt_accuracy": 0.1, "time_step": 4e-3})
    ok(answer)
    r = answer.results
    must((r.test, r.outcome, r.load_direction) == ("tilt", "collapse", "+x"), f"{r.test} {r.outcome} {r.load_direction}")
    near("tilt of the ground", [r.tilt_angle_deg, r.tilt_angle_opposite_deg], np.degrees(np.arctan(answer.capacity)), 1e-9)
    must(answer.verdict.capacity is None or abs(answer.verdict.capacity - min(answer.capacity)) < within, f"{answer.verdict}")


@relation("local-mechanism", decks("block", "column", "arch", "frame", friction=number(0.2, 0.7, 10)), 1e-6, share=0.5)
def dilatant_multipliers_are_greater(deck: Deck, within: float) -> None:
    """A multiplier with dilatant friction is given beside the least one only where it is greater."""
    answer = ask(deck, "local-mechanism", mechanism="building")
    ok(answer)
    one, other = answer.results.multiplier, answer.results.multiplier_associated
    must(other is None or other > one * (1.0 + within), f"dilatant {other}, least {one}")


@relation("dem", st.tuples(decks("column", "frame"), st.integers(0, 10**6)), 1e-6, share=0.5)
def overlaps_of_a_survey_are_cut(deck: Deck, seed: int, within: float) -> None:
    """Stones whose overlaps lie within the tolerance no longer overlap as rigid bodies, and lose no more than what lies in others."""
    made = drawn(deck)
    rng = np.random.default_rng(seed)
    low = min(np.min(np.array(block["points"])[:, 1]) for block in made["structure"]["block"])
    for block in made["structure"]["block"]:
        points = np.array(block["points"])
        if points[:, 1].min() < low + 1e-3:
            continue  # on the ground
        middle = points.mean(axis=0)
        block["points"] = (middle + (points - middle) * (1.0 + rng.uniform(0.0, 1e-3))).tolist()
    made["structure"]["contact_tolerance"] = 0.02
    stones = building(made).blocks()
    made_rigid = rigid_bodies(stones)
    parts, owner = made_rigid.parts, made_rigid.owner
    for i, k in itertools.combinations(range(len(parts)), 2):
        if owner[i] != owner[k]:
            size = np.sqrt(min(abs(signed_area(parts[i])), abs(signed_area(parts[k]))))
            at_most("overlap", overlap_depth(parts[i], parts[k]), 0.0, within, size)
    whole = sum(abs(signed_area(o)) for o in stones.outlines)
    left = sum(abs(signed_area(p)) for p, o in zip(parts, owner, strict=True) if o < made_rigid.count)
    at_most("area lost", whole - left, 0.02 * whole, within)


@relation("tilt", decks(*SOLIDS), 1e-9, share=0.5)
def areas_of_contacts_in_space(deck: Deck, within: float) -> None:
    """The area of a contact of solids is that of its polygon, by triangles about its mean, wherever the building lies."""
    stones = building(deck).solids()
    for polygon, found in zip(stones.polygon, stones.area, strict=True):
        arm = np.asarray(polygon) - np.mean(polygon, axis=0)
        whole = 0.5 * np.cross(arm, np.roll(arm, -1, axis=0)).sum(axis=0)
        near("area", found, float(np.linalg.norm(whole)), within)


@relation("rocking dem tilt thrust", questions(), 0.0, share=0.5)
def axes_of_arrays_agree(deck: Deck, kind: str, table: Deck, within: float) -> None:
    """Each axis of an array has a name, and axes of one name are of one length."""
    answer = ask(deck, kind, **{key: value for key, value in table.items() if key != "kind"})
    ok(answer)
    lengths: dict[str, tuple[str, int]] = {}
    for name, array in answer.result.arrays.items():
        shape = np.asarray(array.data).shape
        must(len(shape) == len(array.dims), f"{name}: {array.dims} of shape {shape}")
        for axis, length in zip(array.dims, shape, strict=True):
            other, size = lengths.setdefault(axis, (name, length))
            must(size == length, f"{axis}: {length} in {name}, {size} in {other}")


DEEP = st.tuples(decks("block", "column", "brickwork", "frame", "stack"), number(0.1, 3.0))  # whose edges are no arcs


@relation("tilt", DEEP, 1e-9, share=3.0)
def masses_are_those_of_the_outlines(deck: Deck, depth: float, within: float) -> None:
    """The mass of each block is its density times its outline times the depth of the deck, and its centroid that of the outline."""
    stones = building(changed(deck, structure={"depth": depth}, material={"density": 1700.0})).blocks()
    near("depth", stones.depth, depth, within)
    for k, outline in enumerate(map(np.asarray, stones.outlines)):
        arm = outline - outline[0]
        after = np.roll(arm, -1, axis=0)
        cross = arm[:, 0] * after[:, 1] - arm[:, 1] * after[:, 0]
        near("mass", stones.mass[k], 1700.0 * depth * abs(signed_area(outline)), within)
        middle = outline[0] + (cross[:, None] * (arm + after)).sum(axis=0) / (3.0 * cross.sum())
        near("centroid", stones.centroid[k], middle, within, float(np.ptp(outline)))


@st.composite
def covered(draw: st.DrawFn) -> Deck:
    """Symmetric bridges of one span below fill, by either rule of dispersal."""
    deck = draw(decks("bridge", friction=number(0.6, 0.9, 4)))
    structure = {**deck["structure"], "spans": deck["structure"]["spans"][:1]}
    structure.pop("piers", None)
    fill = {"cover": draw(number(0.1, 0.6)), "passive": 0.0}
    if draw(st.booleans()):
        fill["dispersal"] = "even"
    return {**deck, "structure": {**structure, "fill": fill}}


#: Length over which a load at a place acts on fill [m]
FOOT = 0.3


@relation("tilt", st.tuples(covered(), number(0.1, 0.9), number(0.4, 2.0), number(1e4, 1e5)), 1e-5)
def stretches_of_load_on_fill(deck: Deck, share: float, length: float, force: float, within: float) -> None:
    """A load at a place of the fill is one spread over the length of its contact; in a mirror a spread load is that of the other sense."""
    ends = np.concatenate([np.array(block["points"])[:, 0] for block in drawn(deck)["structure"]["block"]])
    middle, span = 0.5 * (ends.min() + ends.max()), float(np.ptp(ends))
    off = (share - 0.5) * (span - length)

    def pushed(x: float, over: float) -> np.ndarray:
        stretch = {} if over == 0.0 else {"x_end": round(middle + x + 0.5 * over, 9)}
        answer = ask(deck, "tilt", load=[{"x": round(middle + x - 0.5 * over, 9), "force": force, **stretch}])
        ok(answer)
        return answer.capacity

    near("contact", pushed(off, 0.0), pushed(off, FOOT), within, 1e-3)
    near("mirror", pushed(off, length), pushed(-off, length)[::-1], within, 1e-3)


@relation("dem", st.tuples(decks("block", "column", friction=st.just(0.9)), number(1.5, 4.0)), 1e-9, share=0.5)
def a_run_that_ends_by_collapse_has_passed_its_limit(deck: Deck, factor: float, within: float) -> None:
    """Of a run that collapses, the greatest displacement is at least the limit, however seldom it is noted."""
    shape = deck["structure"]
    slender = shape["width"] / shape["height"]
    motion = {"kind": "sine-pulse", "amplitude": f"{factor * slender:g} g", "period": 1.2}
    keys = {**RIGID, "end_time": 4.0, "time_step": 2e-3, "output_step": 0.5, "perturbed": False}
    answer = ask({**deck, "motion": motion}, "dem", **keys)
    ok(answer)
    r = answer.results
    if r.outcome != "collapse":
        reject()
    at_most("limit", r.collapse_displacement_m, r.peak_displacement_m, within)


@relation("tilt", st.tuples(number(1e5, 1e6), number(1e5, 1e6), number(1e-6, 0.1)), 0.0)
def shear_strength_is_bounded_by_tension(across: float, along: float, more: float, within: float) -> None:
    """A shear strength up to the root of the product of both tensile strengths is accepted, a greater one refused."""
    most = (across * along) ** 0.5
    given = {"tensile_strength": across, "tensile_strength_parallel": along, "fracture_energy": 50.0, "fracture_energy_parallel": 50.0}
    Material.model_validate({**given, "shear_strength": most * (1.0 - 1e-10)})
    try:
        Material.model_validate({**given, "shear_strength": most * (1.0 + more)})
    except ValueError as error:
        must("shear_strength" in str(error), str(error))
    else:
        must(False, f"shear strength {1.0 + more} of the greatest is accepted")


MORTARED = st.tuples(decks("block", "column", friction=number(0.6, 0.9, 4)), number(0.0, 2e5, 3), number(0.0, 2e5, 3))


@relation("dem", MORTARED, 0.0, share=0.5)
def rigid_contacts_remark_on_mortar(deck: Deck, tension: float, cohesion: float, within: float) -> None:
    """On rigid contacts a remark says that mortar is found at its strongest: with tension or cohesion or both, and not of dry joints."""
    keys = {**RIGID, "end_time": 0.05, "time_step": 2e-3, "perturbed": False}
    made = changed(deck, motion=PULSE, joints={"tension": tension, "cohesion": cohesion})
    answer = ask(made, "dem", **keys)
    ok(answer)
    said = "mortar holds if an equilibrium within its strength exists" in answer.warnings
    must(said == (max(tension, cohesion) > 0.0), f"tension {tension}, cohesion {cohesion}: {answer.warnings}")
