"""What an answer must say: assumptions that do not hold, clauses beyond their scope, whole verdicts."""

import itertools
from typing import Any

from asking import Deck, ask, at_most, must, near, same
from bounds import SOLE
from buildings import SOLIDS, changed, decks, number, pulses
from hypothesis import reject
from hypothesis import strategies as st
from relations import MASONRY, PUSH, RECTANGLES, RIGID, SLIDERS, SLIDES, STONES, WEAK, WEAK_SET, ok, relation

import extrados


@relation("rocking dem", SLIDERS, 0.02, examples=(SLIDES,))
def rocking_of_a_block_that_slides(deck: Deck, within: float) -> None:
    """If a block slides before it rocks, the verdict is that of rigid contacts, with the slip of rigid contacts used from the start."""
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": "1.5 g", "period": 0.6})
    answer = ask(moving, "rocking")
    if answer.outcome not in ("stands", "collapses"):
        return
    handed = answer.results.hand_over
    must(handed is not None, f"rocking says {answer.outcome}: {answer.verdict.statement}")
    must(handed.contacts.peak_slip_m > 0.0 and "slide" in answer.verdict.statement, f"{answer.verdict.statement}")
    alone = ask(moving, "dem", perturbed=False, **RIGID)
    ok(alone)
    d = alone.results
    if d.peak_displacement_m < d.collapse_displacement_m:
        same("rigid contacts", answer, alone)
    else:  # a displacement that counts as collapse, by sliding alone
        must(alone.outcome == "open" and "exceeds" in alone.verdict.statement, f"{alone.outcome}: {alone.verdict.statement}")
    near("slip", handed.contacts.peak_slip_m, alone.results.peak_slip_m, within, 1e-3)


DROPPED = ("fragility", "failure-domain", "failure-curves", "rocking-spectrum", "harmonic-map", "resonance", "assessment")


TALL = {"structure": {"kind": "block", "width": 1.0, "height": 2.0}, "joints": {"friction": 0.3}}


@relation(" ".join(DROPPED), st.tuples(RECTANGLES, st.sampled_from(DROPPED)), 0.0, examples=tuple(((1.0, 2.0), k) for k in DROPPED[:2]))
def friction_is_not_dropped(size: tuple, kind: str, within: float) -> None:
    """If friction is below that required by rocking, every analysis of rocking states this."""
    width, height = size
    friction = round(0.6 * width / height, 4)
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": friction}}
    keys: dict[str, dict] = {
        "fragility": {"count": 4, "bootstrap": 0},
        "failure-domain": {"durations": [0.5], "amplitudes": 2, "accuracy": 0.05},
        "failure-curves": {"durations": [0.4, 0.8], "accuracy": 0.05},
        "rocking-spectrum": {"periods": [2.0, 4.0]},
        "harmonic-map": {"amplitudes": 3, "frequencies": [0.5, 1.0]},
        "resonance": {},
        "assessment": {"impulses": 1},
    }
    if kind != "resonance":
        deck["motion"] = WEAK_SET | {"mmi": 8} if kind == "fragility" else {"kind": "sine-pulse", "amplitude": "1 g", "period": 0.6}
    if kind in ("failure-domain", "harmonic-map"):
        del deck["motion"]
    if kind == "assessment":
        deck["structure"] = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
        deck["joints"] = {"friction": 0.3}
    answer = ask(deck, kind, **keys[kind])
    said = " ".join([answer.said, *(answer.verdict.violated if answer.verdict is not None else []), *answer.result.warnings])
    spoken = said.replace("joints.friction", "")
    must("friction" in spoken or "joints slide in" in spoken, f"{kind} says nothing of a friction of {friction}")


@relation(
    "rocking",
    st.tuples(number(0.5, 1.5), number(4.0, 6.0), number(0.8, 1.3), number(1.5, 2.5)),
    0.0,
    examples=((1.005, 5.01, 1.0525, 1.625), (1.15, 4.62, 1.165, 1.725)),
)
def chaos_is_told(width: float, slenderness: float, amplitude: float, frequency: float, within: float) -> None:
    """If amplitudes that differ by 1e-5 g give different outcomes, every run between them is reported as chaotic."""
    deck = {"structure": {"kind": "block", "width": width, "height": width * slenderness}, "joints": {"friction": 0.9}}
    runs = [
        ask(
            changed(
                deck, motion={"kind": "harmonic", "amplitude": f"{amplitude + k * 1e-5!r} g", "frequency": frequency, "duration": 10.0}
            ),
            "rocking",
        )
        for k in range(8)
    ]
    ok(*runs)
    turns = [k for k, (a, b) in enumerate(itertools.pairwise(runs)) if a.results.outcome != b.results.outcome]
    if len(turns) > 1:  # one alone is the edge of collapse
        silent = sum(not r.results.decided_by_last_digits for r in runs[turns[0] : turns[-1] + 2])
        must(silent == 0, f"{silent} of {len(runs)} say nothing of it: {[r.results.outcome for r in runs]}")


@relation(
    "dem",
    st.tuples(number(0.5, 1.5), number(4.0, 6.0), number(0.8, 1.3), number(1.5, 2.5), st.booleans()),
    0.0,
    examples=((1.0, 5.0, 1.0, 2.0, True),),
)
def chaos_of_elements_is_told(width: float, slenderness: float, amplitude: float, frequency: float, rigid: bool, within: float) -> None:
    """Discrete elements, too, report every run between the first and the last change of the outcome as chaotic."""
    joints = {"friction": 2.0, **({} if rigid else {"normal_stiffness": 1e9})}
    deck = {"structure": {"kind": "block", "width": width, "height": width * slenderness}, "joints": joints}
    motion = {"kind": "harmonic", "frequency": frequency, "duration": 8.0}
    runs = [
        ask(changed(deck, motion={**motion, "amplitude": f"{amplitude + k * 1e-5!r} g"}), "dem", end_time=10.0, **(RIGID if rigid else {}))
        for k in range(8)
    ]
    ok(*runs)
    turns = [k for k, (a, b) in enumerate(itertools.pairwise(runs)) if a.results.outcome != b.results.outcome]
    if len(turns) > 1:
        silent = [k for k in range(turns[0], turns[-1] + 2) if not runs[k].results.decided_by_last_digits]
        must(not silent, f"{silent} say nothing of it: {[(r.results.outcome, r.results.perturbation_growth) for r in runs]}")


@relation("dem", st.tuples(decks("block", "column"), st.sampled_from([0.0, 0.01])), 0.0)
def little_damping(deck: Deck, ratio: float, within: float) -> None:
    """A block or column at rest is also calculated on springs with little damping, and not refused."""
    moving = changed(deck, motion=WEAK, joints={"normal_stiffness": 1e9, "damping_ratio": ratio})
    answer = ask(moving, "dem", end_time=0.5)
    must(answer.status == "ok", f"{answer.status}: {answer.said}")


@relation(
    "pushover",
    decks("building", material=MASONRY).map(lambda d: changed(d, motion=WEAK)),
    0.0,
    examples=(changed({k: v for k, v in SOLE.items() if k != "joints"}, motion=WEAK, structure={"beds": []}),),
)
def a_push_is_no_verdict_on_a_peak(deck: Deck, within: float) -> None:
    """A base shear over the weight is not compared with the peak of a motion."""
    answer = ask(deck, "pushover", **PUSH)
    ok(answer)
    must(answer.outcome not in ("stands", "collapses") and answer.verdict.ratio is None, f"{answer.outcome}: {answer.verdict.statement}")


@relation(
    "failure-domain rocking",
    st.tuples(number(1.0, 8.0), number(0.1, 0.12), number(170.0, 180.0)),
    0.0,
    share=0.3,
    examples=((1.0, 0.1, 175.0),),
)
def the_impact_rule_is_told(radius: float, share: float, embrace: float, within: float) -> None:
    """A failure domain of a thin arch gives the same range of impact rules as rocking."""
    arch = {"kind": "arch", "radius": radius, "thickness": round(share * radius, 4), "embrace": embrace, "voussoirs": 36}
    deck = {"structure": arch, "motion": {"kind": "sine-pulse", "amplitude": "0.6 g", "period": 0.4}}
    one = ask(deck, "rocking", hand_over=False)  # rigid contacts have one rule of impact
    other = ask({"structure": arch}, "failure-domain", durations=[0.4], amplitudes=2, accuracy=0.05, hand_over_cells=0)
    ok(one, other)
    if "impact" not in one.warnings:
        reject()
    must("impact" in other.warnings, f"rocking: {one.warnings}; the failure domain: {other.warnings or 'nothing'}")


@relation(
    "local-mechanism",
    st.tuples(number(0.2, 0.6), number(1.0, 10.0), st.sampled_from(["parapet", "wall"])),
    0.0,
    examples=((0.3, 2.0, "parapet"),),
)
def clauses_within_their_scope(thickness: float, height: float, mechanism: str, within: float) -> None:
    """Table 11-5 of ASCE 41, for walls between anchored diaphragms, is not applied to a cantilever."""
    keys = {"mechanism": mechanism, "thickness": thickness, "height": height, "one_second_acceleration": "0.2 g"}
    answer = ask({"code": {"jurisdiction": "ASCE41"}}, "local-mechanism", **keys)
    ok(answer)
    check = answer.results.checks["ASCE 41 slenderness"]
    must(check.verdict == "not-applicable" and check.reason, f"{check.demand} against {check.capacity}: {check.verdict}")


@relation(
    "tilt",
    decks("brickwork", "blocks", friction=number(0.2, 0.5)),
    0.0,
    share=0.5,
    examples=(
        {
            "structure": {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 4, "courses": 5},
            "joints": {"friction": 0.3},
        },
    ),
)
def dilatant_capacities_are_called_so(deck: Deck, within: float) -> None:
    """If the mechanism slides with associated friction, the verdict is an upper bound or uses the state without dilatancy."""
    answer = ask(changed(deck, motion=WEAK), "tilt")
    ok(answer)
    r, verdict = answer.results, answer.verdict
    senses = {"": r.dilating_joints, "_opposite": r.dilating_joints_opposite}
    if not any(senses.values()):
        reject()
    for sense, joints in senses.items():
        most, least = (getattr(r, f"collapse_acceleration{word}{sense}_g") for word in ("", "_non_associated"))
        if not joints:
            continue
        if least is None:
            must(verdict.bound == "upper", f"bound {verdict.bound}: {verdict.statement}")
        else:
            at_most("least state against the bound", least, most, 1e-8, 1.0)
            at_most("capacity", verdict.capacity, least, 1e-8, 1.0)


#: Analyses of a stone building with a motion, quick
PLAIN: dict[str, dict[str, Any]] = {
    "tilt": {},
    "thrust": {},
    "rocking": {},
    "dem": {"end_time": 0.3, **RIGID},
    "local-mechanism": {"mechanism": "building"},
    "failure-domain": {"durations": [0.5], "amplitudes": 2, "accuracy": 0.05},
    "assessment": {"impulses": 1},
    "sla": {"events": 30},
    "moving-load": {"count": 5},
    "supports": {},
}


@relation(
    " ".join(PLAIN),
    st.tuples(decks("arch", "block", "column", "brickwork", "pointed-arch", "frame"), pulses(), st.sampled_from(sorted(PLAIN))),
    1e-9,
)
def verdicts_are_whole(deck: Deck, motion: Deck, kind: str, within: float) -> None:
    """A verdict follows from demand and capacity, names its unit, and is open if an assumption is violated."""
    answer = ask(changed(deck, motion=motion), kind, **PLAIN[kind])
    ok(answer)
    v = answer.verdict
    must(bool(v.statement.strip()) and v.statement.strip()[-1] in ".!", f"{kind}: a statement without an end: {v.statement!r}")
    must(not (v.violated and answer.outcome == "stands"), f"{kind} stands though {v.violated}")
    must(not (v.bound == "upper" and answer.outcome == "stands"), f"{kind} stands by an upper bound")
    if v.demand is not None and v.capacity is not None:
        if v.ratio is not None and answer.outcome != "cannot-stand":
            near(f"{kind}: ratio", v.ratio, v.capacity / v.demand, within)
        if answer.outcome in ("stands", "collapses") and v.ratio is not None:
            must((v.ratio > 1.0) == (answer.outcome == "stands"), f"{kind}: {answer.outcome} at a ratio of {v.ratio}: {v.statement}")
        must(not v.unit or v.unit in v.statement, f"{kind}: no '{v.unit}' in {v.statement!r}")


@relation("tilt sla rocking dem local-mechanism", st.tuples(STONES, pulses(), st.sampled_from(sorted(PLAIN))), 0.0)
def nobody_dies(deck: Deck, motion: Deck, kind: str, within: float) -> None:
    """Every strategy gives a result or a refusal with a reason; an internal error is a fault."""
    keys = dict(PLAIN[kind])
    if deck["structure"]["kind"] in SOLIDS and kind in ("tilt", "dem"):
        keys["direction"] = 0.0
    try:
        answer = ask(changed(deck, motion=motion), kind, **keys)
    except extrados.DeckError:
        reject()  # a kind of structure that the analysis never takes
    must(answer.status == "ok" or bool(answer.said.strip()), f"{kind}: {answer.status} without a word")
    must(answer.status != "failed", f"{kind}: {answer.said}")


@relation("assess", st.tuples(decks("block", "stack", "arch", "column"), pulses(0.05, 0.6)), 0.0, share=0.1)
def an_assessment_is_whole(deck: Deck, motion: Deck, within: float) -> None:
    """Each strategy of an assessment has a row, and a refusal does not stop the others."""
    answer = ask(changed(deck, motion=motion), "assess", budget=5.0, strategies=["tilt", "rocking", "code-checks", "assessment"])
    must(answer.status == "ok", f"{answer.status}: {answer.said}")
    rows = {row.strategy: row for row in answer.results.verdicts}
    must(set(rows) >= {"tilt", "rocking"}, f"rows of {sorted(rows)}")
    for name, row in rows.items():
        if row.outcome == "stands" and row.margin_below is None:
            must((row.margin or 1.0) >= 1.0 <= (row.margin_at_least or 1.0), f"{name} stands, with a margin above {row.margin_at_least}")
    for name in ("tilt", "rocking"):
        alone = ask(changed(deck, motion=motion), name)
        if rows[name].status == "ok":
            must(rows[name].outcome == alone.verdict.outcome, f"{name}: {rows[name].outcome} in the table, {alone.verdict.outcome} alone")
