"""What passes from one part of the program to the next: remarks, violated assumptions, ties, load paths, sizes."""

import numpy as np
from asking import Deck, ask, at_most, must, near
from buildings import changed, decks, number, pulses
from definitions_keys import DRUMS, PULSE
from fields import compare_named, leaning, mirrored_question
from hypothesis import reject
from hypothesis import strategies as st
from relations import EARTHQUAKES, RIGID, SLOW, ok, relation

from extrados.analyses.left_out import left_out
from extrados.decks.reader import make_deck

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
    must(answer.verdict.capacity is None or abs(answer.verdict.capacity - min(answer.capacity)) < within, f"{answer.verdict}")
