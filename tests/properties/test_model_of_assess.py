"""A model of what assess concludes, checked over random tables of rows: verdict, ranking and reasons follow from the rows."""

import itertools
import math
import tempfile
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from extrados.analyses.assess import reasons, strategies
from extrados.analyses.assess.asking import row_of, scaled_margin
from extrados.analyses.assess.driver import _Work
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.assess.reasons import Facts
from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.results.assess import Assess, StrategyVerdict
from extrados.results.codes import Check, Checked, LocalMechanism, WallMechanism
from extrados.results.dem import DemRun
from extrados.results.limit import Fracture, Tilt
from extrados.results.model import Array, Result
from extrados.results.rocking import (
    AssessedImpulse,
    Assessment,
    Conditions,
    FailureDomain,
    ModeCurve,
    PrimaryImpulse,
    Rocking,
    RuleOutcome,
)
from extrados.results.statistics import Ensemble, OverDurations, OverLevels
from extrados.results.verdict import KindResults, Verdict, judge
from extrados.running.survey import Assessed, decks_of
from trials import count_of

QUICK = settings(
    max_examples=count_of(500, 60),
    database=None,
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
    phases=(Phase.generate, Phase.shrink),
)
OUTCOMES = ("stands", "collapses", "cannot-stand", "open", "not-applicable")
BOUNDS = st.sampled_from([None, "exact", "upper", "lower"])
FACTORS = st.integers(1, 80).map(lambda k: k / 20.0)
NAMES = [s.name for s in strategies.ALL]


@st.composite
def rows(draw: st.DrawFn) -> StrategyVerdict:
    """A row of the table: one that was asked with any verdict, or one without a result."""
    strategy = strategies.of(draw(st.sampled_from(NAMES)))
    status = draw(st.sampled_from(["ok", "ok", "ok", "refused", "failed", "left out"]))
    outcome = draw(st.sampled_from(OUTCOMES)) if status == "ok" else "not-applicable"
    margin = low = high = None
    if outcome in ("stands", "collapses", "open") and draw(st.booleans()):
        above = 1.0 if outcome == "stands" else 0.0 if outcome == "collapses" else draw(st.sampled_from([0.0, 1.0]))
        margin = round(above + draw(st.integers(1, 19)) / 20.0 * (3.0 if above else 1.0), 4)
        if draw(st.booleans()):
            margin, low, high = None, margin, round(margin + 0.1, 4)
    elif outcome == "cannot-stand":
        margin = 0.0
    return StrategyVerdict(
        strategy=strategy.name, label=strategy.label, part=None, status=status, reason="" if status == "ok" else "no wish", axis=strategy.axis,
        demand=0.2 if status == "ok" else None, capacity=draw(FACTORS) if status == "ok" else None, unit="g", outcome=outcome,
        bound=None, violated=[], margin=margin, margin_at_least=low, margin_below=high, parameters="", assumes="",
        statement=f"The verdict of {strategy.label}.",
    )  # fmt: skip


TABLES = st.lists(rows(), max_size=9, unique_by=lambda row: row.strategy)
DECK = make_deck({
    "structure": {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 9},
    "motion": {"kind": "sine-pulse", "amplitude": "0.2 g", "period": 0.4}, "analysis": [{"kind": "assess"}],
})  # fmt: skip
CONTEXT = Context(DECK, 1)


def concluded(table: list[StrategyVerdict], results: dict[str, Result] | None = None) -> Assess:
    """What an assessment makes of rows, and results, that it did not ask for."""
    work = _Work(CONTEXT, DECK.analyses[0])
    work.rows, work.results = {row.strategy: row for row in table}, results or {}
    result = Result("assess")
    work.conclude(result)
    assert not work.not_done, work.not_done  # a rule that fails is a fault, though the others go on
    return result.results


def turns(row: StrategyVerdict) -> float:
    """The least factor on the hazard at which a row may turn to collapse, as it says."""
    if row.margin is not None:
        return row.margin
    known = row.margin_at_least if row.outcome == "stands" else row.margin_below
    return math.inf if known is None else known


@QUICK
@given(TABLES)
def test_the_overall_answer_follows_from_the_rows(table: list[StrategyVerdict]) -> None:
    found = concluded(table)
    judged = {row.outcome for row in table if row.status == "ok"} - {"not-applicable"}
    if "cannot-stand" in judged:
        want = "cannot stand"
    elif {"stands", "collapses"} <= judged:
        want = "depends"
    elif judged == {"stands"} or judged == {"collapses"}:
        want = f"{judged.pop()} under all"
    else:
        want = "open"
    assert found.overall == want
    verdict = found.judged(Demanded(0.2, "sine", 0.4, 0.2))
    assert verdict.outcome == {
        "stands under all": "stands",
        "collapses under all": "collapses",
        "cannot stand": "cannot-stand",
    }.get(want, "open")
    for row in table:
        if row.status == "ok" and row.outcome != "not-applicable" and (len(judged) > 1 or want == "open"):
            assert row.label in found.statement or (want == "cannot stand" and row.outcome == "collapses")
        if row.status != "ok":
            assert row.label in found.statement
    assert [(r.strategy, r.outcome) for r in found.verdicts] == [(r.strategy, r.outcome) for r in table]


@QUICK
@given(TABLES)
def test_the_least_margin_is_that_of_the_rows(table: list[StrategyVerdict]) -> None:
    found = concluded(table)
    known = {row.strategy: turns(row) for row in table if row.status == "ok" and row.outcome != "not-applicable"}
    least = min(known.values(), default=math.inf)
    if least == math.inf:
        assert found.least_margin is None and found.least_margin_strategy is None
    else:
        assert found.least_margin == least and known[found.least_margin_strategy] == least
        assert found.overall != "stands under all" or least >= 1.0
        assert found.overall not in ("collapses under all", "cannot stand") or least <= 1.1


@QUICK
@given(TABLES)
def test_agreement_and_reasons_follow_from_the_rows(table: list[StrategyVerdict]) -> None:
    found = concluded(table)
    judged = {row.strategy: row for row in table if row.status == "ok" and row.outcome != "not-applicable"}
    assert set(found.agreement) == set(judged)
    differing = set()
    for a, b in itertools.combinations(judged, 2):
        one, other = judged[a], judged[b]
        said = found.agreement[a][b]
        assert said == found.agreement[b][a]
        collapse = {"collapses", "cannot-stand"}
        alike = one.outcome == other.outcome or {one.outcome, other.outcome} == collapse
        if not alike:
            assert said == ("open" if "open" in (one.outcome, other.outcome) else "disagree")
        else:
            assert said in ("agree", "apart")
        if said != "agree":
            differing.add(frozenset((a, b)))
    explained = {frozenset(pair) for reason in found.reasons for pair in reason.explains}
    assert explained <= differing
    assert {frozenset(pair) for pair in found.unexplained} == differing - explained


ENDS = st.sampled_from(["no-hinging", "recovery", "collapse"])
RULES = ("thesis", "energy-safe", "inelastic")


@QUICK
@given(TABLES, FACTORS, FACTORS, st.none() | FACTORS, st.tuples(ENDS, ENDS, ENDS), st.booleans())
def test_reasons_follow_from_the_results(
    table: list[StrategyVerdict],
    right: float,
    left: float,
    cracked: float | None,
    ends: tuple[str, str, str],
    chaotic: bool,
) -> None:
    """Rules on a crack, on impacts and on last digits: spoken where their numbers show it, of the pairs that they explain."""
    asked = {row.strategy: row for row in table if row.status == "ok"}
    fracture = None if cracked is None else Fracture.model_construct(stands=None, collapse_acceleration_g=cracked)
    by_rule = [
        RuleOutcome.model_construct(rule=rule, restitution=0.8, outcome=end)
        for rule, end in zip(RULES, ends, strict=True)
    ]
    results = {
        "tilt": Tilt.model_construct(collapse_acceleration_g=right, collapse_acceleration_opposite_g=left, fracture=fracture),
        "rocking": Rocking.model_construct(
            outcome=ends[2], outcomes_by_rule=by_rule, decided_by_last_digits=chaotic, peak_rotation_ratio=0.3
        ),
    }  # fmt: skip
    found = concluded(table, {name: Result(name, results=r) for name, r in results.items() if name in asked})
    differing = {
        tuple(sorted((a, b))) for a, there in found.agreement.items() for b, said in there.items() if said != "agree"
    }
    told = {reason.rule: {tuple(sorted(pair)) for pair in reason.explains} for reason in found.reasons}
    dynamic = {
        pair for pair in differing if set(pair) <= {"rocking", "assessment", "probability", "dem"} and "rocking" in pair
    }
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
    rows_ = {
        row.strategy: row for row in draw(st.lists(rows(), min_size=4, max_size=9, unique_by=lambda row: row.strategy))
    }
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
        return Tilt.model_construct(
            collapse_acceleration_g=draw(FACTORS), collapse_acceleration_opposite_g=draw(FACTORS), fracture=None
        )

    impulse = PrimaryImpulse.model_construct(amplitude_g=0.3, period_s=0.5, goodness_of_fit=0.8)
    criterion = Assessment.model_construct(verdict=draw(st.sampled_from(["stands", "fails"])), primary_impulse=impulse)
    made = {"rocking": rocks(), "dem": falls(), "tilt": pushed(), "assessment": criterion}
    probes = {"sine": rocks(), "without-restraints": rocks(), "tilt-without": pushed(), "tilt-no-sliding": pushed(), "no-sliding": falls(),
              "monolith": falls()}  # fmt: skip
    kept = {name: Result(name, results=r) for name, r in probes.items() if draw(st.booleans())}
    bare = {name: draw(st.sampled_from([("a tie",), ("a tie", "a damper")])) for name in rows_ if draw(st.booleans())}
    return Facts(
        CONTEXT.building, CONTEXT.motion, CONTEXT.motion.peak / 9.80665, rows_, {n: Result(n, results=r) for n, r in made.items() if n in rows_},
        1.2, kept, lambda amplitude: draw(st.none() | st.sampled_from([0.01, 5.0])), bare,
    )  # fmt: skip


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
            assert found.text[-1] in ".!" and found.rule in reasons.HEADLINES

    def alike(a: DemRun, b: DemRun) -> bool:
        far = sorted((a.peak_displacement_m, b.peak_displacement_m))
        return (a.outcome == "collapse") is (b.outcome == "collapse") and far[1] - far[0] < 0.2 * far[1]

    rocking, dem, tilt, criterion = of("rocking"), of("dem"), of("tilt"), of("assessment")
    follow = {"rocking", "assessment", "probability", "dem"}
    both = [p for p in pairs if set(p) <= follow]
    sine = probe("sine")
    told(
        reasons.sine_for_record,
        rocking is not None and criterion is not None and sine is not None
        and (sine.outcome == "collapse") is (criterion.verdict == "fails")
        and (rocking.peak_rotation_ratio > 1.2 * sine.peak_rotation_ratio or rocking.outcome != sine.outcome),
        [p for p in both if "assessment" in p],
        **({"sine_rotation_ratio": sine.peak_rotation_ratio, "motion_rotation_ratio": rocking.peak_rotation_ratio} if sine and rocking else {}),
    )  # fmt: skip
    every = {w for there in facts.bare.values() for w in there}
    without = {n for n, there in facts.bare.items() if set(there) == every}
    free = probe("without-restraints")
    told(
        reasons.left_out, rocking is not None and free is not None and free.peak_rotation_ratio > 1.2 * rocking.peak_rotation_ratio,
        [p for p in pairs if "rocking" in p and set(p) & without],
        **({"rotation_ratio_without": free.peak_rotation_ratio, "rotation_ratio": rocking.peak_rotation_ratio} if free and rocking else {}),
    )  # fmt: skip
    bare, sla = probe("tilt-without"), facts.rows.get("sla")
    least = None if bare is None else min(bare.collapse_acceleration_g, bare.collapse_acceleration_opposite_g)
    told(
        reasons.ties_of_statics,
        bare is not None and sla is not None and "tilt" in facts.rows and sla.capacity is not None and abs(least - sla.capacity) <= 0.1 * least,
        [p for p in pairs if set(p) == {"tilt", "sla"} and "sla" in facts.bare],
        **({"without_ties": least, "elements": sla.capacity} if bare and sla and sla.capacity else {}),
    )  # fmt: skip
    chaotic = dem is not None and dem.decided_by_last_digits
    told(reasons.elements_of_last_digits, chaotic, [p for p in pairs if "dem" in p])
    share = facts.rows["probability"].demand if "probability" in facts.rows else None
    told(reasons.chance, share is not None and 0.05 < share < 0.95,
         [p for p in pairs if "probability" in p and not set(p) & {"tilt", "sla", "push-x", "push-y"}])  # fmt: skip
    stuck, shortest = probe("no-sliding"), float(CONTEXT.building.blocks().length.min())
    told(
        reasons.sliding,
        dem is not None and stuck is not None and not chaotic and dem.peak_slip_m >= 0.01 * shortest and not alike(dem, stuck),
        [p for p in pairs if "dem" in p and set(p) & {"rocking", "assessment", "probability", "tilt"}],
        **({"slip_m": dem.peak_slip_m, "displacement_without_sliding_m": stuck.peak_displacement_m} if dem and stuck else {}),
    )  # fmt: skip
    one = probe("monolith")
    told(
        reasons.drums,
        dem is not None and one is not None and not chaotic and rocking is not None
        and (one.outcome == "collapse") is (rocking.outcome == "collapse") and not alike(one, dem),
        [p for p in both if "dem" in p],
        **({"displacement_of_one_body_m": one.peak_displacement_m, "displacement_m": dem.peak_displacement_m} if one and dem else {}),
    )  # fmt: skip
    held = probe("tilt-no-sliding")
    if tilt is not None and sla is not None and sla.capacity is not None and not CONTEXT.building.meshed_by_stones:
        weak, stiff = (
            min(t.collapse_acceleration_g, t.collapse_acceleration_opposite_g) if t else 0.0 for t in (tilt, held)
        )
        told(reasons.membrane, held is not None and stiff > 1.05 * weak and abs(sla.capacity - stiff) < abs(sla.capacity - weak),
             [p for p in pairs if "sla" in p and set(p) & {"tilt", "dem"}], **({"with_sliding": weak, "without_sliding": stiff}))  # fmt: skip
    for found in reasons.static_peak(facts, pairs):
        mine = [tuple(p) for p in found.explains]
        assert mine and all(
            p in pairs and facts.split(p)[0] in ("tilt", "sla", "push-x", "push-y") and facts.split(p)[1] in follow
            for p in mine
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
                abs(found.numbers["peak"] - min(factors) * facts.peak_g) < 1e-9
                or len(names) > 1
                or "displacement_ratio" in found.numbers
            )


@QUICK
@given(
    st.none() | FACTORS,
    st.none() | FACTORS,
    st.sampled_from([None, *OUTCOMES]),
    BOUNDS,
    st.lists(st.just("It slides."), max_size=1),
)
def test_a_verdict_is_no_better_than_what_it_rests_on(demand, capacity, outcome, bound, violated) -> None:
    found = judge("It is so.", demand, capacity, "g", outcome, bound, violated)
    assert (found.demand, found.capacity, found.unit, found.bound, found.violated) == (
        demand,
        capacity,
        "g",
        bound,
        violated,
    )
    whole = demand is not None and capacity is not None
    assert (found.ratio == capacity / demand) if whole else found.ratio is None
    assert all(text in found.statement for text in ["It is so.", *violated])
    if violated:
        assert found.outcome not in ("stands", "collapses")
    elif outcome is not None:
        assert found.outcome == outcome
    elif not whole:
        assert found.outcome == "not-applicable"
    else:
        want = "stands" if demand < capacity else "collapses"
        undecided = (bound, want) in {("upper", "stands"), ("lower", "collapses")}
        assert found.outcome == ("open" if undecided else want)


class Judged(KindResults):
    """Results of any strategy, with a verdict of their own."""

    verdict: Verdict

    def judged(self, demand: Demanded) -> Verdict:
        return self.verdict


VERDICTS = st.builds(
    lambda demand, capacity, bound, violated: judge("So it is.", demand, capacity, "g", None, bound, violated),
    FACTORS, FACTORS, BOUNDS, st.lists(st.just("It slides."), max_size=1),
)  # fmt: skip


@QUICK
@given(VERDICTS, st.sampled_from(NAMES))
def test_a_row_says_what_its_strategy_says(verdict: Verdict, name: str) -> None:
    strategy = strategies.of(name)
    row = row_of(
        strategy, Result(strategy.kind, results=Judged(verdict=verdict)), "so", Demanded(0.2, "sine", 0.4, 0.2), 0.05
    )
    for same in ("demand", "capacity", "unit", "outcome", "bound", "violated", "statement"):
        assert getattr(row, same) == getattr(verdict, same)
    assert row.status == "ok" and row.strategy == name
    assert row.margin == (verdict.ratio if strategy.axis in ("acceleration", "pulse", "check") else None)
    for status in ("refused", "failed", "interrupted"):
        bare = row_of(strategy, Result(strategy.kind, status, "no"), "", Demanded(0.2, "sine", 0.4, 0.2), 0.05)
        assert bare.status in ("refused", "failed") and bare.outcome == "not-applicable" and bare.reason == "no"


@QUICK
@given(
    VERDICTS,
    st.sampled_from(NAMES),
    st.lists(st.sampled_from(["[[ties]]", "[supports] abutting_wall", "[supports] damping_ratio"]), unique=True),
)
def test_no_collapse_without_the_restraints_of_the_deck_decides(
    verdict: Verdict, name: str, without: list[str]
) -> None:
    """Asked without a tie, a strategy looks at a weaker building: where that stands this one does, and no more follows."""
    strategy = strategies.of(name)
    result, demand = Result(strategy.kind, results=Judged(verdict=verdict)), Demanded(0.2, "sine", 0.4, 0.2)
    row, whole = (
        row_of(strategy, result, "", demand, 0.05, None, tuple(without)),
        row_of(strategy, result, "", demand, 0.05),
    )
    restrained = {"[[ties]]", "[supports] abutting_wall"} & set(without)
    if whole.outcome == "collapses" and restrained:
        assert (row.outcome, row.margin) == ("open", None) and all(what in row.violated[-1] for what in restrained)
    else:
        assert row == whole


@QUICK
@given(VERDICTS, st.sampled_from(["left", "right", None]), FACTORS)
def test_no_row_stands_by_an_upper_bound_or_beside_what_is_violated(
    verdict: Verdict, wall: str | None, cracked: float
) -> None:
    class Pushed(Tilt):
        def judged(self, demand: Demanded) -> Verdict:
            return verdict

    fracture = Fracture.model_construct(stands=None, collapse_acceleration_g=cracked)
    results = Pushed.model_construct(
        collapse_acceleration_g=cracked, collapse_acceleration_opposite_g=cracked, fracture=fracture
    )
    row = row_of(
        strategies.of("tilt"), Result("tilt", results=results), "", Demanded(0.2, "sine", 0.4, 0.2), 0.05, wall
    )
    assert not (row.outcome == "stands" and (row.bound == "upper" or row.violated))
    assert not (row.outcome == "collapses" and (row.bound == "lower" or row.violated))


@QUICK
@given(
    st.integers(0, 40),
    st.integers(0, 40),
    st.sampled_from([0.02, 0.05, 0.2]),
    st.lists(st.just("It slides."), max_size=1),
)
def test_a_share_of_collapses_decides_by_its_bounds(
    count: int, collapsed: int, acceptable: float, violated: list[str]
) -> None:
    collapsed = min(collapsed, count)

    class Shares(Ensemble):
        def judged(self, demand: Demanded) -> Verdict:
            return judge("A share.", violated=violated)

    strategy = strategies.of("probability")
    results = Shares.model_construct(count=count, collapsed=collapsed)
    row = row_of(strategy, Result("fragility", results=results), "", Demanded(0.2, "sine", 0.4, 0.2), acceptable)
    share = collapsed / count if count else None
    assert row.demand == share and row.capacity == acceptable
    want = "open" if share is None else "stands" if share <= acceptable else "collapses" if share > 0.5 else "open"
    assert row.outcome == ("open" if violated else want) and row.violated == violated
    assert not violated or want == "open" or "It slides." in row.statement


@QUICK
@given(
    st.lists(st.tuples(FACTORS, st.none() | st.integers(0, 10)), min_size=1, max_size=6, unique_by=lambda row: row[0]),
    st.sampled_from([0.02, 0.2]),
)
def test_shares_over_factors_bracket_the_margin(rows: list, acceptable: float) -> None:
    """The margin of a set lies between the last factor of acceptable shares and the first that is not; the row tells that nearest to 1."""
    rows.sort()

    class Levels(OverLevels):
        def judged(self, demand: Demanded) -> Verdict:
            return judge("Shares.")

    results = Levels.model_construct(
        levels=[level for level, _ in rows], count=[0 if hits is None else 10 for _, hits in rows], collapsed=[hits or 0 for _, hits in rows],
        collapse_probability=[None if hits is None else hits / 10.0 for _, hits in rows],
    )  # fmt: skip
    row = row_of(
        strategies.of("probability"),
        Result("fragility", results=results),
        "",
        Demanded(0.2, "sine", 0.4, 0.2),
        acceptable,
    )
    _, hits = min(rows, key=lambda r: (abs(r[0] - 1.0), rows.index(r)))
    assert row.demand == (None if hits is None else hits / 10.0)
    high = min((x for x, n in rows if n is not None and n / 10.0 > acceptable), default=None)
    low = max(
        (x for x, n in rows if n is not None and n / 10.0 <= acceptable and (high is None or x < high)), default=None
    )
    assert (row.margin_at_least, row.margin_below) == (low, high)
    assert hits is not None or row.outcome == "open"


PLAN = make_deck({
    "structure": {"kind": "building", "storeys": [3.0], "walls": [
        {"name": n, "start": a, "end": b, "thickness": t} for n, a, b, t in (
            ("south", [0.0, 0.0], [5.0, 0.0], 0.4), ("east", [5.0, 0.0], [5.0, 4.0], 0.3), ("north", [5.0, 4.0], [0.0, 4.0], 0.4), ("west", [0.0, 4.0], [0.0, 0.0], 0.3))]},
    "analysis": [{"kind": "local-mechanism", "mechanism": "building"}],
})  # fmt: skip
STONES = make_deck({
    "structure": {"kind": "column", "width": 1.0, "height": 3.0, "drums": 3}, "joints": {"tension": 1e5, "cohesion": 2e5},
    "analysis": [{"kind": "tilt"}],
})  # fmt: skip
MESHED = make_deck({
    "structure": {"kind": "panel", "width": 1.8, "height": 1.6, "thickness": 0.3, "unit_length": 0.6, "unit_height": 0.4}, "joints": {"friction": 0.6},
    "material": {"tensile_strength": 2e5, "fracture_energy": 50.0}, "analysis": [{"kind": "tilt"}],
})  # fmt: skip


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
        collapse_acceleration_g=draw(FACTORS), collapse_acceleration_opposite_g=draw(FACTORS), fracture=fracture,
        dilating_joints=draw(st.sampled_from([[], [1]])), dilating_joints_opposite=draw(st.sampled_from([[], [1]])), non_dilatant=None,
        non_dilatant_opposite=None, collapse_acceleration_non_associated_g=draw(FACTORS), collapse_acceleration_non_associated_opposite_g=draw(FACTORS),
    )  # fmt: skip
    dem = DemRun.model_construct(
        outcome=draw(st.sampled_from(["recovery", "slid", "collapse"])), peak_displacement_m=draw(FACTORS), peak_slip_m=draw(FACTORS),
        collapse_displacement_m=4.0, decided_by_last_digits=draw(st.booleans()), perturbed_outcome="slid", perturbation_growth=1e5,
    )  # fmt: skip
    wall = WallMechanism.model_construct(wall="south", storey=1, multiplier=draw(FACTORS))
    other = WallMechanism.model_construct(wall="east", storey=1, multiplier=9.0)
    codes = LocalMechanism.model_construct(walls=draw(st.sampled_from([[], [wall, other]])), checks={}, bound=None)
    line = np.array(
        draw(
            st.lists(
                st.lists(st.sampled_from([-0.5, 0.5, 1.2, np.nan]), min_size=3, max_size=3), min_size=4, max_size=4
            )
        )
    )
    rocking = Result(
        "rocking",
        results=Rocking.model_construct(
            outcome="recovery", outcomes_by_rule=None, decided_by_last_digits=False, peak_rotation_ratio=0.3
        ),
    )
    rocking.arrays = {"thrust_position": Array(line, ("time", "joint"), "")}
    made = {
        "tilt": Result("tilt", results=tilt),
        "dem": Result("dem", results=dem),
        "code-checks": Result("local-mechanism", results=codes),
        "rocking": rocking,
    }
    return Facts(
        deck.building, CONTEXT.motion, CONTEXT.motion.peak / 9.80665, rows_, {n: r for n, r in made.items() if n in rows_}, 1.2,
    )  # fmt: skip


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

    def weaker(p: tuple, name: str) -> bool:
        return name in p and facts.split(p)[0] == name

    tilt, dem, codes = facts.of("tilt"), facts.of("dem"), facts.of("code-checks")
    stones = building.meshed_by_stones
    if tilt is not None and tilt.fracture is not None:
        whole = min(tilt.collapse_acceleration_g, tilt.collapse_acceleration_opposite_g)
        cracked = 0.0 if tilt.fracture.stands is False else tilt.fracture.collapse_acceleration_g
        told(reasons.crack, cracked < whole and whole > facts.peak_g, [p for p in pairs if weaker(p, "tilt")], cracked=cracked, whole=whole, peak=facts.peak_g)  # fmt: skip
    else:
        told(reasons.crack, False, [])
    with_mortar = {"dem", "sla"} if stones else {"dem"}
    told(
        reasons.mortar, bool(building.joints.tension),
        [p for p in pairs if facts.split(p)[1] in with_mortar and facts.split(p)[0] not in with_mortar],
        **({"tension": 1e5, "cohesion": 2e5} if building.joints.tension else {}),
    )  # fmt: skip
    if tilt is not None and dem is not None:
        ends = [
            (None if joints else own, least, joints)
            for own, least, joints in (
                (tilt.collapse_acceleration_g, tilt.collapse_acceleration_non_associated_g, tilt.dilating_joints),
                (tilt.collapse_acceleration_opposite_g, tilt.collapse_acceleration_non_associated_opposite_g, tilt.dilating_joints_opposite),
            )
        ]  # fmt: skip
        upper = [tilt.collapse_acceleration_g, tilt.collapse_acceleration_opposite_g]
        least = min(up if end[0] is None else end[0] for end, up in zip(ends, upper, strict=True))
        slides = any(end[2] and end[0] == least for end in ends)
        told(
            reasons.sliding_as_collapse,
            slides and not dem.decided_by_last_digits and dem.outcome != "collapse" and dem.peak_slip_m >= 0.5 * dem.peak_displacement_m,
            [p for p in pairs if "dem" in p and facts.split(p)[0] in (("tilt", "sla") if stones else ("tilt",))],
            **({"static_capacity": least, "slip_m": dem.peak_slip_m} if slides else {}),
        )  # fmt: skip
    if "rocking" in facts.results and (mine := reasons.dynamic(pairs, "dem")):
        line = facts.results["rocking"].arrays["thrust_position"].data
        moving = line[~np.isnan(line).all(axis=1)]
        out = np.array([max(max(-x, x - 1.0) for x in row if not np.isnan(x)) for row in moving])
        share = float((out > 0.01).mean()) if len(out) else 0.0
        told(
            reasons.hinges_elsewhere,
            len(out) > 0 and share >= 0.1,
            mine,
            **({"share_of_time": share, "farthest_ratio": float(out.max())} if len(out) else {}),
        )
    reached = {
        n: r.capacity if r.capacity is not None else (None if (m := r.margin if r.margin is not None else r.margin_at_least) is None else m * facts.peak_g)
        for n, r in facts.rows.items()
    }  # fmt: skip
    mine = [p for p in pairs if weaker(p, "code-checks") and set(p) & {"push-x", "push-y"}]
    pushes = {n: reached[n] for p in mine for n in p if n != "code-checks" and reached[n] is not None}
    first = codes.walls[0].multiplier if codes is not None and codes.walls else None
    told(
        reasons.torn_off, first is not None and bool(pushes) and first < min(pushes.values(), default=0.0), mine,
        **({"multiplier": first, "whole_g": min(pushes.values())} if first is not None and pushes else {}),
    )  # fmt: skip
    both = [p for p in pairs if set(p) == {"push-x", "push-y"}]
    areas = {"push-x": 2.0 * 5.0 * 0.4, "push-y": 2.0 * 4.0 * 0.3}
    found = reasons.weaker_direction(facts, pairs)
    want = bool(both) and deck_of(facts) is PLAN and facts.split(both[0])[0] == "push-y"
    assert (found is not None) == want
    if found is not None:
        assert [tuple(p) for p in found.explains] == both
        assert (
            abs(found.numbers["weak_m2"] / areas["push-y"] - 1.0) < 0.3
            and found.numbers["weak_m2"] < found.numbers["strong_m2"]
        )


def deck_of(facts: Facts) -> object:
    """The deck whose building the facts are of."""
    return next(d for d in (PLAN, STONES, MESHED) if d.building is facts.building)


@QUICK
@given(st.lists(st.tuples(FACTORS, st.booleans(), st.booleans()), min_size=1, max_size=8, unique_by=lambda row: row[0]))
def test_the_margin_of_a_motion_lies_below_the_first_factor_that_collapses(
    rows: list[tuple[float, bool, bool]],
) -> None:
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


OVERALL = st.sampled_from(["stands under all", "collapses under all", "cannot stand", "depends", "open"])
BUILDINGS = st.builds(
    lambda overall, margin, status: Assessed("a", overall if status == "ok" else "", margin if status == "ok" else np.nan, "", status, "", Path()),
    OVERALL, st.just(np.nan) | FACTORS, st.sampled_from(["ok", "ok", "failed", "refused"]),
)  # fmt: skip


@QUICK
@given(st.lists(BUILDINGS, max_size=8))
def test_a_ranking_puts_the_worst_first(buildings: list[Assessed]) -> None:
    ranked = sorted(buildings, key=lambda b: b.order)
    for worse, better in itertools.pairwise(ranked):
        assert better.overall != "cannot stand" or worse.overall == "cannot stand"
        if worse.overall == "stands under all" and not np.isfinite(worse.least_margin):
            assert better.overall == "stands under all" and not np.isfinite(better.least_margin)
        if (
            np.isfinite(worse.least_margin)
            and np.isfinite(better.least_margin)
            and "cannot stand" not in (worse.overall, better.overall)
        ):
            assert worse.least_margin <= better.least_margin
        if np.isfinite(worse.least_margin) and worse.overall != "cannot stand":
            assert np.isfinite(better.least_margin) or better.overall == "stands under all"


@settings(QUICK, max_examples=20)
@given(st.sets(st.sampled_from("abcdef"), min_size=1, max_size=4), st.booleans())
def test_a_folder_is_all_of_its_decks_and_nothing_else(names: set[str], common: bool) -> None:
    with tempfile.TemporaryDirectory() as place:
        structure = '[structure]\nkind = "block"\nwidth = 1.0\nheight = 3.0\n'
        motion = '[motion]\nkind = "sine-pulse"\namplitude = "0.2 g"\nperiod = 0.5\n'
        for name in names:
            (Path(place) / f"{name}.toml").write_text(structure + ("" if common else motion))
            (Path(place) / f"{name}.expect.toml").write_text("no deck")
        if common:
            (Path(place) / "common.toml").write_text(motion)
        (Path(place) / "notes.txt").write_text("no deck")
        found = decks_of(Path(place))
    assert list(found) == sorted(names)
    assert all("sine-pulse" in text and 'kind = "assess"' in text for text in found.values())


@st.composite
def checks(draw: st.DrawFn) -> dict[str, Check]:
    """Rules of codes, some of them alternatives, some without a demand or beyond their scope."""
    names = draw(
        st.lists(
            st.sampled_from(["NTC linear", "NTC activation", "NTC", "slenderness", "overturning", "q"]),
            min_size=1,
            max_size=6,
            unique=True,
        )
    )
    found = {}
    for name in names:
        capacity, demand = draw(FACTORS), draw(st.none() | FACTORS)
        code = draw(st.sampled_from(["NTC 2018", "NTC 2018", "ASCE 41", "EN 1998-1", ""]))
        verdict = "" if demand is None else "holds" if capacity > demand else "fails"
        found[name] = Check(
            capacity=capacity, demand=demand, unit=draw(st.sampled_from(["g", "m"])), verdict=draw(st.sampled_from([verdict] * 4 + ["not-applicable"])),
            source="", note="", code=code, quantity="", limit_state="", scope="", alternative=draw(st.sampled_from(["", "SLV"])), reason="",
        )  # fmt: skip
    return found


def governing(rules: dict[str, Check]) -> list[tuple[float, str]]:
    """Margin and name of the check by which each group of alternatives says what it says, where it is decided, the least first."""
    groups: dict[tuple[str, str], list[str]] = {}
    for name, check in rules.items():
        if check.code and check.verdict != "not-applicable":
            groups.setdefault((check.code, check.alternative or name), []).append(name)
    decided = []
    for names in groups.values():
        known = [(rules[n].capacity / rules[n].demand, n) for n in names if rules[n].demand is not None]
        if known and (max(known)[0] > 1.0 or len(known) == len(names)):
            decided.append(max(known, key=lambda row: row[0]))
    return sorted(decided, key=lambda row: row[0])


@QUICK
@given(checks(), BOUNDS, st.lists(st.just("It slides."), max_size=1))
def test_codes_say_what_their_checks_say(rules: dict[str, Check], bound: str | None, violated: list[str]) -> None:
    found = Checked.model_construct(checks=rules, confidence_factor=1.35, bound=bound, violated=violated)
    decided, verdict = governing(rules), found.overall()
    assert [(margin, check) for margin, _, check in found.governing()] == [
        (margin, rules[name]) for margin, name in decided
    ]
    if not decided:
        assert verdict.ratio is None and verdict.outcome == "not-applicable"
        return
    margin = decided[0][0]
    assert verdict.ratio == margin
    if margin > 1.0:
        assert (verdict.outcome == "stands") == (bound != "upper" and not violated)
    else:
        assert verdict.outcome == ("open" if bound == "lower" else "collapses")


def row_of_margin(name: str, margin: float) -> StrategyVerdict:
    """A row of a strategy that has a verdict, by its margin."""
    strategy, outcome = strategies.of(name), "stands" if margin > 1.0 else "collapses"
    return StrategyVerdict(
        strategy=name, label=strategy.label, part=None, status="ok", reason="", axis=strategy.axis, demand=1.0, capacity=margin, unit="g",
        outcome=outcome, bound=None, violated=[], margin=margin, margin_at_least=None, margin_below=None, parameters="", assumes="",
        statement="So.",
    )  # fmt: skip


@QUICK
@given(checks(), FACTORS, st.none() | st.sampled_from([1.0, 0.8]))
def test_what_the_codes_explain_follows_from_their_checks(
    rules: dict[str, Check], multiplier: float, part: float | None
) -> None:
    """The check that governs and the next are those of the rules; no reason names another number."""
    if part is not None:  # by the multiplier of statics
        capacity = 2.0 * multiplier / 1.2 / part
        rules["NTC linear"] = Check(capacity=capacity, demand=0.2, unit="g", verdict="holds" if capacity > 0.2 else "fails", source="", note="",
                                    code="NTC 2018", quantity="", limit_state="", scope="", alternative="", reason="")  # fmt: skip
    decided = governing(rules)
    if not decided:
        return
    codes = LocalMechanism.model_construct(
        checks=rules,
        confidence_factor=1.2,
        behaviour_factor=2.0,
        bound=None,
        violated=[],
        participating_part=part or 1.0,
        walls=None,
    )
    tilt = Tilt.model_construct(
        collapse_acceleration_g=multiplier, collapse_acceleration_opposite_g=multiplier, fracture=None
    )
    (margin, name), least = decided[0], multiplier / 0.2
    found = concluded(
        [row_of_margin("tilt", least), row_of_margin("code-checks", margin)],
        {"tilt": Result("tilt", results=tilt), "code-checks": Result("local-mechanism", results=codes)},
    )
    told = {reason.rule: reason for reason in found.reasons}
    check, by_multiplier = rules[name], ("NTC linear", "NTC activation")
    starts = [
        c.capacity / c.demand for n, c in rules.items()
        if n.startswith(by_multiplier) and c.code == check.code and c.verdict in ("holds", "fails")
    ]  # fmt: skip
    if "code-check" in told:
        numbers = told["code-check"].numbers
        assert not name.startswith(by_multiplier)
        assert (numbers["governing_margin"], numbers["demand"], numbers["capacity"]) == (
            margin,
            check.demand,
            check.capacity,
        )
        assert numbers["other_margin"] == (starts[0] if starts else decided[1][0])
    elif (
        found.agreement["tilt"]["code-checks"] == "disagree"
        and not name.startswith(by_multiplier)
        and (starts or decided[1:])
    ):
        assert ((starts[0] if starts else decided[1][0]) > 1.0) == (margin > 1.0)
    if "code-factors" in told:
        numbers = told["code-factors"].numbers
        factor = numbers["factor"] / numbers["participating_part"]
        assert abs(numbers["code_capacity"] / (numbers["static_capacity"] * factor) - 1.0) < 0.03
        assert ("e* =" in told["code-factors"].text) == (abs(numbers["participating_part"] - 1.0) > 0.005)
    elif part is not None and name == "NTC linear" and found.agreement["tilt"]["code-checks"] != "agree":
        assert abs(check.capacity / multiplier - 1.0) < 0.05


CONDITIONS = st.sampled_from([[], ["It slides."]]).map(lambda v: Conditions.model_construct(violated=v))
DEMANDED = Demanded(0.2, "sine", 0.4, 0.2)


def decided(verdict: Verdict, outcome: str, violated: list[str]) -> None:
    """An outcome that no violated condition stands beside."""
    want = "open" if violated and outcome in ("stands", "collapses") else outcome
    assert (verdict.outcome, verdict.violated) == (want, violated) and all(
        text in verdict.statement for text in violated
    )


@QUICK
@given(
    CONDITIONS,
    st.sampled_from(["no-hinging", "recovery", "collapse"]),
    st.booleans(),
    FACTORS,
    st.lists(st.just("Chaos."), max_size=1),
)
def test_a_run_ends_as_its_outcome_says(
    conditions: Conditions, outcome: str, ends: bool, ratio: float, more: list[str]
) -> None:
    run = Rocking.model_construct(
        outcome=outcome, settled=ends, peak_rotation_ratio=ratio, conditions=conditions, violated=more
    )
    want = "collapses" if outcome == "collapse" else "stands" if ends else "open"
    found = run.judged(DEMANDED)
    decided(found, want, [*conditions.violated, *more])
    assert (found.demand, found.capacity) == (ratio, 1.0) and found.ratio == 1.0 / ratio
    says = {"collapses": "Collapse under", "stands": "No collapse under", "open": "ended before"}
    assert says[want] in found.statement


CURVE = st.lists(st.tuples(st.integers(1, 20), st.none() | FACTORS), min_size=1, max_size=5, unique_by=lambda p: p[0])


@QUICK
@given(CURVE, CONDITIONS, st.integers(1, 80), st.booleans(), st.none() | FACTORS, st.none() | FACTORS)
def test_a_motion_is_compared_with_the_curve_at_its_duration(
    curve: list, conditions: Conditions, place: int, same: bool, slides: float | None, leaves: float | None
) -> None:
    durations, amplitudes = [k / 4.0 for k, _ in curve], [a for _, a in curve]
    pulse = Demanded(0.2, "sine" if same else "step", place / 16.0, 0.6)
    made = FailureDomain.model_construct(
        pulse="sine", mode_I=ModeCurve.model_construct(durations_s=durations, amplitudes_g=amplitudes), conditions=conditions,
        sliding_from_g=[slides] * len(curve), hinges_elsewhere_from_g=[leaves] * len(curve), amplitudes_by_rule=None,
    )  # fmt: skip
    found = made.judged(pulse)
    order = sorted(zip(durations, amplitudes, strict=True), key=lambda p: p[0])
    ends = [
        max((p for p in order if p[0] <= pulse.duration_s), default=None),
        min((p for p in order if p[0] >= pulse.duration_s), default=None),
    ]
    if same and None not in ends and None not in (ends[0][1], ends[1][1]):
        want = float(
            np.interp(pulse.duration_s, [p[0] for p in order], [np.nan if p[1] is None else p[1] for p in order])
        )
        if ends[0] == ends[1]:
            want = ends[0][1]
        assert math.isclose(found.capacity, want) and found.demand == 0.6
        assert ("stays below" in found.statement) == (want > 0.6)
        over = any(level is not None and level <= 0.6 for level in (slides, leaves))
        if over or not (slides or leaves):
            assert bool(found.violated) == over
        decided(found, "stands" if want > 0.6 else "collapses", found.violated)
    else:
        known = [a for a in amplitudes if a is not None]
        assert (found.demand, found.capacity, found.violated) == (None, min(known, default=None), conditions.violated)


@QUICK
@given(
    st.lists(st.tuples(st.none() | FACTORS, FACTORS), max_size=4),
    CONDITIONS,
    st.sampled_from(["stands", "fails"]),
    st.lists(st.just("Chaos."), max_size=1),
)
def test_the_impulse_of_the_least_margin_decides(
    rows: list, conditions: Conditions, static: str, more: list[str]
) -> None:
    impulses = [
        AssessedImpulse.model_construct(
            margin=None if a is None else a / size, failing_amplitude_g=a, amplitude_g=-size, period_s=0.5
        )
        for a, size in rows
    ]
    found = Assessment.model_construct(
        impulses=impulses, static_verdict=static, conditions=conditions, violated=more, margin_conditions=[]
    ).judged(DEMANDED)
    known = [(a / size, a, size) for a, size in rows if a is not None]
    if known:
        margin, failing, size = min(known, key=lambda row: row[0])
        assert (found.demand, found.capacity) in [(s, a) for m, a, s in known if m == margin]
        decided(found, "stands" if size < failing else "collapses", [*conditions.violated, *more])
    else:
        decided(found, "stands" if static == "stands" else "open", [*conditions.violated, *more])


SHARES = st.sampled_from([None, 0.0, 0.25, 1.0])


@QUICK
@given(
    st.lists(SHARES, min_size=1, max_size=4),
    CONDITIONS,
    st.none() | FACTORS,
    st.none() | st.tuples(*[st.sampled_from([0.0, 0.5])] * 2),
)
def test_shares_of_collapses_decide_where_all_agree(
    shares: list, conditions: Conditions, middle: float | None, by_rule: tuple | None
) -> None:
    known = [p for p in shares if p is not None]
    agreed = "stands" if known and max(known) == 0.0 else "collapses" if known and min(known) == 1.0 else "open"
    found = OverDurations.model_construct(
        durations_s=[float(k + 1) for k in range(len(shares))], collapse_probability=shares, conditions=conditions
    ).judged(DEMANDED)
    decided(found, agreed, conditions.violated if known else [])
    if known:
        assert f"{100.0 * min(known):.3g} % of the motions of" in found.statement
        assert len(known) == 1 or f" {100.0 * max(known):.3g} % of those of" in found.statement
    share, count = shares[0], 4
    rules = None if by_rule is None else dict(zip(("energy-safe", "inelastic"), by_rule, strict=True))
    one = Ensemble.model_construct(
        collapse_probability=share,
        collapsed=round((share or 0.0) * count),
        count=count,
        conditions=conditions,
        collapse_probability_by_rule=rules,
    ).judged(DEMANDED)
    if share is None:
        assert one.outcome == "open"
    else:
        told = [*one.violated[len(conditions.violated) :]]
        assert bool(told) == (by_rule is not None and by_rule[0] != by_rule[1])
        decided(
            one, "stands" if share == 0.0 else "collapses" if share == 1.0 else "open", [*conditions.violated, *told]
        )
        assert f"{100.0 * share:.3g} % of {count}" in one.statement and one.demand == share
    levels = OverLevels.model_construct(
        count=[count],
        median=middle,
        intensity="PGA",
        intensity_unit="g",
        collapse_probability=[share if share is not None else 0.5],
        conditions=conditions,
    ).judged(DEMANDED)
    assert (levels.outcome, levels.capacity, levels.violated) == ("not-applicable", middle, conditions.violated)
