"""A model of the reasons of assess: each follows from the results of its strategies, none names another number."""

import numpy as np
from assess_model import CONTEXT, FACTORS, QUICK, TABLES, concluded, rows, stated
from hypothesis import given
from hypothesis import strategies as st

from extrados.analyses.assess import facts as stating
from extrados.analyses.assess import reasons_of_buildings, reasons_of_motion, reasons_of_statics, strategies
from extrados.analyses.assess.asking import scaled_margin
from extrados.analyses.assess.facts import Facts
from extrados.decks.reader import make_deck
from extrados.results.assess import StrategyVerdict
from extrados.results.codes import Check, LocalMechanism, WallMechanism
from extrados.results.dem import DemRun
from extrados.results.frame import FramePush, FramePushover
from extrados.results.limit import Fracture, Tilt
from extrados.results.model import Array, Result
from extrados.results.rocking import Assessment, PrimaryImpulse, Rocking, RuleOutcome
from extrados.results.shell import Flanges, PushCurve, Pushover
from extrados.results.statistics import OverLevels

ENDS = st.sampled_from(["no-hinging", "recovery", "collapse"])


RULES = ("thesis", "energy-safe", "inelastic")


@QUICK
@given(TABLES, FACTORS, FACTORS, st.none() | FACTORS, st.tuples(ENDS, ENDS, ENDS), st.booleans())
def test_reasons_follow_from_the_results(
    table: list[StrategyVerdict], right: float, left: float, cracked: float | None, ends: tuple[str, str, str], chaotic: bool
) -> None:
    """Rules on a crack, on impacts and on last digits: spoken where their numbers show it, of the pairs that they explain."""
    asked = {row.strategy: row for row in table if row.status == "ok"}
    fracture = None if cracked is None else Fracture.model_construct(stands=None, collapse_acceleration_g=cracked)
    by_rule = [RuleOutcome.model_construct(rule=rule, restitution=0.8, outcome=end) for rule, end in zip(RULES, ends, strict=True)]
    results = {
        "tilt": Tilt.model_construct(collapse_acceleration_g=right, collapse_acceleration_opposite_g=left, fracture=fracture),
        "rocking": Rocking.model_construct(
            outcome=ends[2], outcomes_by_rule=by_rule, decided_by_last_digits=chaotic, peak_rotation_ratio=0.3
        ),
    }
    found = concluded(table, {name: Result(name, results=r) for name, r in results.items() if name in asked})
    differing = {tuple(sorted((a, b))) for a, there in found.agreement.items() for b, said in there.items() if said != "agree"}
    told = {reason.rule: {tuple(sorted(pair)) for pair in reason.explains} for reason in found.reasons}
    dynamic = {pair for pair in differing if set(pair) <= {"rocking", "assessment", "probability", "dem"} and "rocking" in pair}
    split = len({end == "collapse" for end in ends}) == 2
    assert told.get("impact-rule", set()) == (dynamic if split else set())
    assert told.get("last-digits", set()) == (dynamic if chaotic else set())
    order = {"cannot-stand": 0, "collapses": 1, "open": 2, "stands": 3}
    weaker = {
        pair
        for pair in differing
        if "tilt" in pair and order[asked["tilt"].outcome] < min(order[asked[n].outcome] for n in pair if n != "tilt")
    }
    if cracked is None or not (cracked < min(right, left) and min(right, left) > 0.2):
        assert "crack" not in told
    else:
        assert weaker <= told.get("crack", set()) <= differing


def facts_of(draw: st.DrawFn) -> Facts:
    """Rows of all strategies, with results and probes whose few numbers the rules look at."""
    rows_ = {row.strategy: row for row in draw(st.lists(rows(), min_size=4, max_size=9, unique_by=lambda row: row.strategy))}
    ends, far = st.sampled_from(["recovery", "collapse"]), st.sampled_from([0.01, 0.3, 0.8, 1.5])

    def rocks() -> Rocking:
        return Rocking.model_construct(
            outcome=draw(ends), outcomes_by_rule=None, decided_by_last_digits=False, peak_rotation_ratio=draw(far)
        )

    def falls() -> DemRun:
        moved, slip = draw(far), draw(st.sampled_from([0.0, 1e-3, 0.2]))
        return DemRun.model_construct(
            outcome=draw(ends),
            peak_displacement_m=moved,
            collapse_displacement_m=2.0,
            peak_slip_m=slip,
            decided_by_last_digits=draw(st.booleans()),
            perturbed_outcome=draw(ends),
            perturbation_growth=1e5,
        )

    def pushed() -> Tilt:
        return Tilt.model_construct(collapse_acceleration_g=draw(FACTORS), collapse_acceleration_opposite_g=draw(FACTORS), fracture=None)

    impulse = PrimaryImpulse.model_construct(amplitude_g=0.3, period_s=0.5, goodness_of_fit=0.8)
    criterion = Assessment.model_construct(verdict=draw(st.sampled_from(["stands", "fails"])), primary_impulse=impulse)
    made = {"rocking": rocks(), "dem": falls(), "tilt": pushed(), "assessment": criterion}
    probes = {
        "sine": rocks(),
        "without-restraints": rocks(),
        "tilt-without": pushed(),
        "tilt-no-sliding": pushed(),
        "no-sliding": falls(),
        "monolith": falls(),
    }
    kept = {name: Result(name, results=r) for name, r in probes.items() if draw(st.booleans())}
    bare = {name: draw(st.sampled_from([("a tie",), ("a tie", "a damper")])) for name in rows_ if draw(st.booleans())}
    return Facts(
        CONTEXT.building,
        CONTEXT.motion,
        CONTEXT.motion.peak / 9.80665,
        rows_,
        {n: Result(n, results=r) for n, r in made.items() if n in rows_},
        1.2,
        kept,
        lambda amplitude: draw(st.none() | st.sampled_from([0.01, 5.0])),
        bare,
    )


@QUICK
@given(st.composite(facts_of)())
def test_each_reason_follows_from_its_probe(facts: Facts) -> None:
    """The rules that compare a further run: told where it shows, for the pairs that it concerns, with the numbers of both."""
    pairs = facts.pairs()
    of, probe = facts.of, lambda name: facts.probes[name].results if name in facts.probes else None

    def told(rule, want: bool, mine: list, **numbers: float) -> None:
        found = rule(facts, pairs)
        assert (found is not None) == bool(want and mine), rule.__name__
        if found is not None:
            assert [tuple(p) for p in found.explains] == mine, rule.__name__
            for name, value in numbers.items():
                assert found.numbers[name] == value, rule.__name__
            assert found.text[-1] in ".!" and found.rule in stating.HEADLINES
            stated(found)

    def alike(a: DemRun, b: DemRun) -> bool:
        far = sorted((a.peak_displacement_m, b.peak_displacement_m))
        return (a.outcome == "collapse") is (b.outcome == "collapse") and far[1] - far[0] < 0.2 * far[1]

    rocking, dem, tilt, criterion = of("rocking"), of("dem"), of("tilt"), of("assessment")
    follow = {"rocking", "assessment", "probability", "dem"}
    both = [p for p in pairs if set(p) <= follow]
    sine = probe("sine")
    told(
        reasons_of_motion.sine_for_record,
        rocking is not None
        and criterion is not None
        and sine is not None
        and (sine.outcome == "collapse") is (criterion.verdict == "fails")
        and (rocking.peak_rotation_ratio > 1.2 * sine.peak_rotation_ratio or rocking.outcome != sine.outcome),
        [p for p in both if "assessment" in p],
        **(
            {"sine_rotation_ratio": sine.peak_rotation_ratio, "motion_rotation_ratio": rocking.peak_rotation_ratio}
            if sine and rocking
            else {}
        ),
    )
    every = {w for there in facts.bare.values() for w in there}
    without = {n for n, there in facts.bare.items() if set(there) == every}
    free = probe("without-restraints")
    told(
        reasons_of_motion.left_out,
        rocking is not None and free is not None and free.peak_rotation_ratio > 1.2 * rocking.peak_rotation_ratio,
        [p for p in pairs if "rocking" in p and set(p) & without],
        **({"rotation_ratio_without": free.peak_rotation_ratio, "rotation_ratio": rocking.peak_rotation_ratio} if free and rocking else {}),
    )
    bare, sla = probe("tilt-without"), facts.rows.get("sla")
    least = None if bare is None else min(bare.collapse_acceleration_g, bare.collapse_acceleration_opposite_g)
    told(
        reasons_of_statics.ties_of_statics,
        bare is not None
        and sla is not None
        and "tilt" in facts.rows
        and sla.capacity is not None
        and abs(least - sla.capacity) <= 0.1 * least,
        [p for p in pairs if set(p) == {"tilt", "sla"} and "sla" in facts.bare],
        **({"without_ties": least, "elements": sla.capacity} if bare and sla and sla.capacity else {}),
    )
    chaotic = dem is not None and dem.decided_by_last_digits
    told(reasons_of_motion.elements_of_last_digits, chaotic, [p for p in pairs if "dem" in p])
    share = facts.rows["probability"].demand if "probability" in facts.rows else None
    told(
        reasons_of_motion.chance,
        share is not None and 0.05 < share < 0.95,
        [p for p in pairs if "probability" in p and not set(p) & {"tilt", "sla", "push-x", "push-y"}],
    )
    meshed = ("sla",) if CONTEXT.building.meshed_by_stones else ()  # such elements do not slide either
    stuck, shortest = probe("no-sliding"), float(CONTEXT.building.blocks().length.min())
    told(
        reasons_of_motion.sliding,
        dem is not None and stuck is not None and not chaotic and dem.peak_slip_m >= 0.01 * shortest and not alike(dem, stuck),
        [p for p in pairs if "dem" in p and set(p) & {"rocking", "assessment", "probability", "tilt", *meshed}],
        **({"slip_m": dem.peak_slip_m, "displacement_without_sliding_m": stuck.peak_displacement_m} if dem and stuck else {}),
    )
    one = probe("monolith")
    told(
        reasons_of_motion.drums,
        dem is not None
        and one is not None
        and not chaotic
        and rocking is not None
        and (one.outcome == "collapse") is (rocking.outcome == "collapse")
        and not alike(one, dem),
        [p for p in both if "dem" in p],
        **({"displacement_of_one_body_m": one.peak_displacement_m, "displacement_m": dem.peak_displacement_m} if one and dem else {}),
    )
    held = probe("tilt-no-sliding")
    if tilt is not None and sla is not None and sla.capacity is not None and not CONTEXT.building.meshed_by_stones:
        weak, stiff = (min(t.collapse_acceleration_g, t.collapse_acceleration_opposite_g) if t else 0.0 for t in (tilt, held))
        told(
            reasons_of_statics.membrane,
            held is not None and stiff > 1.05 * weak and abs(sla.capacity - stiff) < abs(sla.capacity - weak),
            [p for p in pairs if "sla" in p and set(p) & {"tilt", "dem"}],
            **({"with_sliding": weak, "without_sliding": stiff}),
        )
    for found in reasons_of_statics.static_peak(facts, pairs):
        mine = [tuple(p) for p in found.explains]
        assert mine and all(
            p in pairs and facts.split(p)[0] in ("tilt", "sla", "push-x", "push-y") and facts.split(p)[1] in follow for p in mine
        )
        names = {facts.split(p)[0] for p in mine}
        weakest = min((facts.rows[n].capacity for n in names), default=0.0)
        assert found.numbers["static_capacity"] == weakest
        stands = any(facts.outcome(n) == "stands" and facts.rows[n].capacity == weakest for n in names)
        if not stands:
            assert abs(found.numbers["peak"] - facts.peak_g) < 1e-12
        else:
            factors = [facts.interval(facts.split(p)[1])[0] for p in mine]
            assert (
                abs(found.numbers["peak"] - min(factors) * facts.peak_g) < 1e-9 or len(names) > 1 or "displacement_ratio" in found.numbers
            )


@QUICK
@given(TABLES, st.lists(st.booleans(), min_size=9, max_size=9))
def test_an_open_outcome_is_explained_by_its_violated_assumption(table: list[StrategyVerdict], broken: list[bool]) -> None:
    """Each strategy whose outcome is open by a violated assumption explains its own pairs with a decided one, and no others."""
    made = [r.model_copy(update={"violated": ["It slides."] if bad else []}) for r, bad in zip(table, broken, strict=False)]
    facts = Facts(CONTEXT.building, CONTEXT.motion, CONTEXT.motion.peak / 9.80665, {r.strategy: r for r in made}, {}, 1.2)
    told = {(one.text.split(" is open")[0], tuple(map(tuple, one.explains))) for one in reasons_of_motion.violated(facts, facts.pairs())}
    decided = {r.strategy for r in made if r.status == "ok" and r.outcome in ("stands", "collapses", "cannot-stand")}
    want = set()
    for row in made:
        pairs = tuple(p for p in facts.pairs() if row.strategy in p and set(p) & decided)
        if row.status == "ok" and row.outcome == "open" and row.violated and pairs:
            want.add((f"The outcome by {row.label}", pairs))
    assert told == want


@QUICK
@given(
    st.lists(rows(), min_size=3, max_size=7, unique_by=lambda r: r.strategy),
    rows(),
    FACTORS,
    FACTORS,
    FACTORS,
    st.none() | FACTORS,
    st.sampled_from(["m", "g", ""]),
)
def test_the_spectrum_of_the_site_explains_what_that_of_the_motion_would_change(
    table: list[StrategyVerdict], codes: StrategyVerdict, capacity: float, site: float, motion: float, other: float | None, unit: str
) -> None:
    """Codes against strategies of the motion or its peak: spoken where the codes would agree with the demand of the motion at the limit
    state that governs; `other`: margin of a second one."""

    def made(demand: float, **more: Check) -> LocalMechanism:
        check = Check.model_construct(
            capacity=capacity,
            demand=demand,
            unit=unit,
            code="NTC 2018",
            limit_state="SLV",
            alternative="",
            source="clause",
            verdict="holds" if capacity >= demand else "fails",
        )
        return LocalMechanism.model_construct(checks={"first": check, **more}, walls=None, bound=None, violated=[])

    second = {}
    if other is not None and other > capacity / site:
        keys = {"capacity": other, "demand": 1.0, "unit": "g", "code": "NTC 2018", "limit_state": "SLD", "alternative": "", "source": "b"}
        second = {"second": Check.model_construct(**keys, verdict="holds" if other >= 1.0 else "fails")}
    margin, then = capacity / site, min([capacity / motion, *([other or 0.0] if second else [])])
    of_codes = {
        "strategy": "code-checks",
        "status": "ok",
        "outcome": "stands" if margin >= 1.0 else "collapses",
        "margin": margin,
        "margin_at_least": None,
        "margin_below": None,
    }
    every = {r.strategy: r for r in [*(r for r in table if r.strategy != "code-checks"), codes.model_copy(update=of_codes)]}
    results = {"code-checks": Result("local-mechanism", results=made(site, **second))}
    facts = Facts(CONTEXT.building, CONTEXT.motion, CONTEXT.motion.peak / 9.80665, every, results, 1.2)
    assert reasons_of_buildings.code_spectrum(facts, facts.pairs()) is None, "the codes check the motion"
    facts.probes["codes-motion"] = Result("local-mechanism", results=made(motion))
    found = reasons_of_buildings.code_spectrum(facts, facts.pairs())
    want = []
    for pair in facts.pairs():
        if "code-checks" not in pair or not set(pair) & {
            "rocking",
            "assessment",
            "probability",
            "dem",
            "tilt",
            "sla",
            "push-x",
            "push-y",
            "frame",
        }:
            continue
        (name,) = set(pair) - {"code-checks"}
        low, high = facts.interval(name)
        same = (then >= 1.0) == (every[name].outcome == "stands")
        near = same and low <= 1.2 * then and then <= 1.2 * high
        if {"disagree": same, "apart": near}.get(facts.relation(*pair), False) and every[name].outcome in ("stands", "collapses"):
            want.append(list(pair))
        elif facts.relation(*pair) == "disagree" and every[name].outcome == "cannot-stand" and then < 1.0:
            want.append(list(pair))
    assert (found.explains if found else []) == want
    if found:
        stated(found)
        assert abs(found.numbers["other_margin"] / then - 1.0) < 1e-9 and found.numbers["governing_margin"] == margin


PLAN = make_deck(
    {
        "structure": {
            "kind": "building",
            "storeys": [3.0],
            "walls": [
                {"name": n, "start": a, "end": b, "thickness": t}
                for n, a, b, t in (
                    ("south", [0.0, 0.0], [5.0, 0.0], 0.4),
                    ("east", [5.0, 0.0], [5.0, 4.0], 0.3),
                    ("north", [5.0, 4.0], [0.0, 4.0], 0.4),
                    ("west", [0.0, 4.0], [0.0, 0.0], 0.3),
                )
            ],
        },
        "analysis": [{"kind": "local-mechanism", "mechanism": "building"}],
    }
)


STONES = make_deck(
    {
        "structure": {"kind": "column", "width": 1.0, "height": 3.0, "drums": 3},
        "joints": {"tension": 1e5, "cohesion": 2e5},
        "analysis": [{"kind": "tilt"}],
    }
)


MESHED = make_deck(
    {
        "structure": {"kind": "panel", "width": 1.8, "height": 1.6, "thickness": 0.3, "unit_length": 0.6, "unit_height": 0.4},
        "joints": {"friction": 0.6},
        "material": {"tensile_strength": 2e5, "fracture_energy": 50.0},
        "analysis": [{"kind": "tilt"}],
    }
)


@st.composite
def other_facts(draw: st.DrawFn) -> Facts:
    """Rows and results that the rules of walls, mortar, cracks, hinges and directions look at."""
    deck = draw(st.sampled_from([PLAN, STONES, MESHED]))
    table = draw(st.lists(rows(), min_size=3, max_size=8, unique_by=lambda row: row.strategy))
    rows_ = {row.strategy: row for row in table}
    fracture = draw(
        st.none()
        | st.builds(
            lambda g, stands: Fracture.model_construct(stands=stands, collapse_acceleration_g=g),
            FACTORS,
            st.sampled_from([None, True, False]),
        )
    )
    tilt = Tilt.model_construct(
        collapse_acceleration_g=draw(FACTORS),
        collapse_acceleration_opposite_g=draw(FACTORS),
        fracture=fracture,
        dilating_joints=draw(st.sampled_from([[], [1]])),
        dilating_joints_opposite=draw(st.sampled_from([[], [1]])),
        non_dilatant=None,
        non_dilatant_opposite=None,
        collapse_acceleration_non_associated_g=draw(FACTORS),
        collapse_acceleration_non_associated_opposite_g=draw(FACTORS),
    )
    dem = DemRun.model_construct(
        outcome=draw(st.sampled_from(["recovery", "slid", "collapse"])),
        peak_displacement_m=draw(FACTORS),
        peak_slip_m=draw(FACTORS),
        collapse_displacement_m=4.0,
        decided_by_last_digits=draw(st.booleans()),
        perturbed_outcome="slid",
        perturbation_growth=1e5,
    )
    wall = WallMechanism.model_construct(wall="south", storey=1, multiplier=draw(FACTORS))
    other = WallMechanism.model_construct(wall="east", storey=1, multiplier=9.0)
    codes = LocalMechanism.model_construct(walls=draw(st.sampled_from([[], [wall, other]])), checks={}, bound=None)
    line = np.array(draw(st.lists(st.lists(st.sampled_from([-0.5, 0.5, 1.2, np.nan]), min_size=3, max_size=3), min_size=4, max_size=4)))
    rocking = Result(
        "rocking",
        results=Rocking.model_construct(outcome="recovery", outcomes_by_rule=None, decided_by_last_digits=False, peak_rotation_ratio=0.3),
    )
    rocking.arrays = {"thrust_position": Array(line, ("time", "joint"), "")}
    made = {
        "tilt": Result("tilt", results=tilt),
        "dem": Result("dem", results=dem),
        "code-checks": Result("local-mechanism", results=codes),
        "rocking": rocking,
    }
    return Facts(deck.building, CONTEXT.motion, CONTEXT.motion.peak / 9.80665, rows_, {n: r for n, r in made.items() if n in rows_}, 1.2)


@QUICK
@given(other_facts())
def test_each_reason_follows_from_the_results_of_its_strategies(facts: Facts) -> None:
    """Cracks, mortar, tension, sliding that ends, hinges elsewhere, walls torn off and directions: told where they show, of their pairs."""
    pairs, building = facts.pairs(), facts.building

    def told(rule, want: bool, mine: list, **numbers: float) -> None:
        found = rule(facts, pairs)
        assert (found is not None) == bool(want and mine), (rule.__name__, found, want, mine)
        if found is not None:
            assert [tuple(p) for p in found.explains] == mine, rule.__name__
            assert {k: found.numbers[k] for k in numbers} == numbers, rule.__name__
            stated(found)

    def weaker(p: tuple, name: str) -> bool:
        return name in p and facts.split(p)[0] == name

    tilt, dem, codes = facts.of("tilt"), facts.of("dem"), facts.of("code-checks")
    stones = building.meshed_by_stones
    if tilt is not None and tilt.fracture is not None:
        whole = min(tilt.collapse_acceleration_g, tilt.collapse_acceleration_opposite_g)
        cracked = 0.0 if tilt.fracture.stands is False else tilt.fracture.collapse_acceleration_g
        told(
            reasons_of_statics.crack,
            cracked < whole and whole > facts.peak_g,
            [p for p in pairs if weaker(p, "tilt")],
            cracked=cracked,
            whole=whole,
            peak=facts.peak_g,
        )
    else:
        told(reasons_of_statics.crack, False, [])
    with_mortar = {"dem", "sla"} if stones else {"dem"}
    told(
        reasons_of_statics.mortar,
        bool(building.joints.tension),
        [p for p in pairs if facts.split(p)[1] in with_mortar and facts.split(p)[0] not in with_mortar],
        **({"tension": 1e5, "cohesion": 2e5} if building.joints.tension else {}),
    )
    if tilt is not None and dem is not None:
        # Without a state of no dilatancy the associated value decides
        ends = [
            (tilt.collapse_acceleration_g, tilt.dilating_joints),
            (tilt.collapse_acceleration_opposite_g, tilt.dilating_joints_opposite),
        ]
        least = min(capacity for capacity, _ in ends)
        slides = any(joints and capacity == least for capacity, joints in ends)
        told(
            reasons_of_statics.sliding_as_collapse,
            slides and not dem.decided_by_last_digits and dem.outcome != "collapse" and dem.peak_slip_m >= 0.5 * dem.peak_displacement_m,
            [p for p in pairs if "dem" in p and facts.split(p)[0] in (("tilt", "sla") if stones else ("tilt",))],
            **({"static_capacity": least, "slip_m": dem.peak_slip_m} if slides else {}),
        )
    if "rocking" in facts.results and (mine := stating.dynamic(pairs, "dem")):
        line = facts.results["rocking"].arrays["thrust_position"].data
        moving = line[~np.isnan(line).all(axis=1)]
        out = np.array([max(max(-x, x - 1.0) for x in row if not np.isnan(x)) for row in moving])
        share = float((out > 0.01).mean()) if len(out) else 0.0
        told(
            reasons_of_motion.hinges_elsewhere,
            len(out) > 0 and share >= 0.1,
            mine,
            **({"share_of_time": share, "farthest_ratio": float(out.max())} if len(out) else {}),
        )
    reached = {
        n: r.capacity
        if r.capacity is not None
        else (None if (m := r.margin if r.margin is not None else r.margin_at_least) is None else m * facts.peak_g)
        for n, r in facts.rows.items()
    }
    mine = [p for p in pairs if weaker(p, "code-checks") and set(p) & {"push-x", "push-y", "frame"}]
    pushes = {n: reached[n] for p in mine for n in p if n != "code-checks" and reached[n] is not None}
    first = codes.walls[0].multiplier if codes is not None and codes.walls else None
    told(
        reasons_of_buildings.torn_off,
        first is not None and bool(pushes) and first < min(pushes.values(), default=0.0),
        mine,
        **({"multiplier": first, "whole_g": min(pushes.values())} if first is not None and pushes else {}),
    )
    both = [p for p in pairs if set(p) == {"push-x", "push-y"}]
    areas = {"push-x": 2.0 * 5.0 * 0.4, "push-y": 2.0 * 4.0 * 0.3}
    found = reasons_of_buildings.weaker_direction(facts, pairs)
    want = bool(both) and deck_of(facts) is PLAN and facts.split(both[0])[0] == "push-y"
    assert (found is not None) == want
    if found is not None:
        assert [tuple(p) for p in found.explains] == both
        assert abs(found.numbers["weak_m2"] / areas["push-y"] - 1.0) < 0.3 and found.numbers["weak_m2"] < found.numbers["strong_m2"]


def deck_of(facts: Facts) -> object:
    """The deck whose building the facts are of."""
    return next(d for d in (PLAN, STONES, MESHED) if d.building is facts.building)


@QUICK
@given(st.lists(st.tuples(FACTORS, st.booleans(), st.booleans()), min_size=1, max_size=8, unique_by=lambda row: row[0]))
def test_the_margin_of_a_motion_lies_below_the_first_factor_that_collapses(rows: list[tuple[float, bool, bool]]) -> None:
    """And below the first at which blocks slide: beyond it rocking does not say what brings the building down."""
    rows.sort()
    results = OverLevels.model_construct(
        levels=[level for level, _, _ in rows],
        collapsed=[int(down) for _, down, _ in rows],
        sliding_share=[float(slides) for _, _, slides in rows],
        hinges_elsewhere_share=[0.0] * len(rows),
    )
    low, high = scaled_margin(results)
    ends = [(level, down and not slides) for level, down, slides in rows if down or slides]
    below = [level for level, _, _ in rows if not ends or level < ends[0][0]]
    assert (low, high) == (max(below, default=None), ends[0][0] if ends and ends[0][1] else None)


#: Base shear [kN] of a push of the frame, its direction [deg], pattern and eccentricity
PUSHED = st.tuples(
    st.integers(20, 60), st.sampled_from([0.0, 90.0]), st.sampled_from(["uniform", "uniform", "modal"]), st.sampled_from([0.0, 0.0, 0.05])
)
#: Greatest load [kN] of a push of the shells in one sense, None without one, and whether it has passed its peak
SENSES = st.lists(st.tuples(st.none() | st.integers(20, 60), st.booleans()), min_size=1, max_size=2)


@QUICK
@given(
    st.tuples(rows(), rows(), rows()),
    st.lists(PUSHED, min_size=1, max_size=6),
    st.dictionaries(st.sampled_from(["push-x", "push-y"]), st.tuples(SENSES, st.none() | st.sampled_from([0.1, 0.4]))),
    st.booleans(),
)
def test_base_shears_of_frame_and_shells_are_compared(drawn: tuple, runs: list, shells: dict, framed: bool) -> None:
    """Along each axis the least base shear of uniform pushes of the frame without eccentricity, and that of both senses of the shells."""
    names = ["frame", "push-x", "push-y"]
    made = [
        r.model_copy(update={"strategy": n, "label": (s := strategies.of(n)).label, "axis": s.axis})
        for r, n in zip(drawn, names, strict=True)
    ]
    results: dict[str, Result] = {}
    if framed:
        pushes = [
            FramePush.model_construct(direction_deg=way, pattern=pattern, eccentricity=off, peak_base_shear_N=1e3 * load)
            for load, way, pattern, off in runs
        ]
        results["frame"] = Result("frame-pushover", results=FramePushover.model_construct(runs=pushes))
    for name, (senses, share) in shells.items():
        first, *second = (
            {"greatest_load_N": None if load is None else 1e3 * load, "peak_load_N": 1e3 * (load or 0.0) if passed else None}
            for load, passed in senses
        )
        flanges = None if share is None else Flanges.model_construct(share=share)
        minus = PushCurve.model_construct(**second[0]) if second else None
        results[name] = Result("pushover", results=Pushover.model_construct(**first, minus=minus, flanges=flanges, walls=["south"]))
    facts = Facts(PLAN.building, CONTEXT.motion, CONTEXT.motion.peak / 9.80665, {r.strategy: r for r in made}, results, 1.2)
    pairs = facts.pairs()
    numbers, explained, without_peak = {}, [], []
    for axis, way in (("x", 0.0), ("y", 90.0)):
        senses, share = shells.get(f"push-{axis}", ([], None))
        of_frame = [load for load, w, pattern, off in runs if framed and (w, pattern, off) == (way, "uniform", 0.0)]
        of_shells = [load for load, _ in senses if load is not None]
        if not of_frame or not of_shells:
            continue
        frame, shell = min(of_frame), min(of_shells)
        if max(frame, shell) > 1.15 * min(frame, shell):
            numbers |= {f"frame_{axis}_N": 1e3 * frame, f"shells_{axis}_N": 1e3 * shell}
            numbers |= {} if share is None else {f"across_share_{axis}": share}
            explained.append({"frame", f"push-{axis}"})
            without_peak.append(not all(passed for _, passed in senses))
    found = reasons_of_buildings.frame_and_shells(facts, pairs)
    assert (found is not None) == bool(numbers)
    if found is None:
        return
    assert found.numbers == numbers and [set(p) for p in found.explains] == explained
    assert found.text.count("(the run of the shells ended before the load decreased)") == sum(without_peak)
    assert all(tuple(p) in pairs or tuple(p) == tuple(sorted(p)) for p in found.explains)
    for axis in ("x", "y"):
        if f"frame_{axis}_N" in numbers:
            one, other = numbers[f"frame_{axis}_N"], numbers[f"shells_{axis}_N"]
            assert f"Along {axis} the frame carries {one / 1e3:.3g} kN, and the shells carry {other / 1e3:.3g} kN" in found.text
