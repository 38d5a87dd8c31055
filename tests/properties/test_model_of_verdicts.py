"""A model of the rows of strategies: each verdict follows from the results, their bounds and what is violated."""

import math

import numpy as np
from assess_model import BOUNDS, FACTORS, NAMES, OUTCOMES, QUICK, decided
from hypothesis import example, given
from hypothesis import strategies as st

from extrados.analyses.assess import strategies
from extrados.analyses.assess.asking import row_of
from extrados.analyses.assess.hazard import Demanded
from extrados.results.dem import DemDomain
from extrados.results.limit import Fracture, Tilt
from extrados.results.model import Result
from extrados.results.rocking import AssessedImpulse, Assessment, Conditions, FailureDomain, ModeCurve, Rocking
from extrados.results.statistics import Ensemble, HarmonicMap, OverDurations, OverLevels, Resonance, RockingSpectrum
from extrados.results.verdict import KindResults, Verdict, judge


@QUICK
@given(st.none() | FACTORS, st.none() | FACTORS, st.sampled_from([None, *OUTCOMES]), BOUNDS, st.lists(st.just("It slides."), max_size=1))
def test_a_verdict_is_no_better_than_what_it_rests_on(demand, capacity, outcome, bound, violated) -> None:
    found = judge("It is so.", demand, capacity, "g", outcome, bound, violated)
    assert (found.demand, found.capacity, found.unit, found.bound, found.violated) == (demand, capacity, "g", bound, violated)
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
    FACTORS,
    FACTORS,
    BOUNDS,
    st.lists(st.just("It slides."), max_size=1),
)


@QUICK
@given(VERDICTS, st.sampled_from(NAMES))
def test_a_row_says_what_its_strategy_says(verdict: Verdict, name: str) -> None:
    strategy = strategies.of(name)
    row = row_of(strategy, Result(strategy.kind, results=Judged(verdict=verdict)), "so", Demanded(0.2, "sine", 0.4, 0.2), 0.05)
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
def test_no_collapse_without_the_restraints_of_the_deck_decides(verdict: Verdict, name: str, without: list[str]) -> None:
    """Asked without a tie, a strategy looks at a weaker building: where that stands this one does, and no more follows."""
    strategy = strategies.of(name)
    result, demand = Result(strategy.kind, results=Judged(verdict=verdict)), Demanded(0.2, "sine", 0.4, 0.2)
    row, whole = (row_of(strategy, result, "", demand, 0.05, None, tuple(without)), row_of(strategy, result, "", demand, 0.05))
    restrained = {"[[ties]]", "[supports] abutting_wall"} & set(without)
    if whole.outcome == "collapses" and restrained:
        assert (row.outcome, row.margin) == ("open", None) and all(what in row.violated[-1] for what in restrained)
    else:
        assert row == whole


@QUICK
@given(VERDICTS, st.sampled_from(["left", "right", None]), FACTORS)
def test_no_row_stands_by_an_upper_bound_or_beside_what_is_violated(verdict: Verdict, wall: str | None, cracked: float) -> None:
    class Pushed(Tilt):
        def judged(self, demand: Demanded) -> Verdict:
            return verdict

    fracture = Fracture.model_construct(stands=None, collapse_acceleration_g=cracked)
    results = Pushed.model_construct(collapse_acceleration_g=cracked, collapse_acceleration_opposite_g=cracked, fracture=fracture)
    row = row_of(strategies.of("tilt"), Result("tilt", results=results), "", Demanded(0.2, "sine", 0.4, 0.2), 0.05, wall)
    assert not (row.outcome == "stands" and (row.bound == "upper" or row.violated))
    assert not (row.outcome == "collapses" and (row.bound == "lower" or row.violated))


@QUICK
@given(st.integers(0, 40), st.integers(0, 40), st.sampled_from([0.02, 0.05, 0.2]), st.lists(st.just("It slides."), max_size=1))
def test_a_share_of_collapses_decides_by_its_bounds(count: int, collapsed: int, acceptable: float, violated: list[str]) -> None:
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
        levels=[level for level, _ in rows],
        count=[0 if hits is None else 10 for _, hits in rows],
        collapsed=[hits or 0 for _, hits in rows],
        collapse_probability=[None if hits is None else hits / 10.0 for _, hits in rows],
    )
    row = row_of(strategies.of("probability"), Result("fragility", results=results), "", Demanded(0.2, "sine", 0.4, 0.2), acceptable)
    _, hits = min(rows, key=lambda r: (abs(r[0] - 1.0), rows.index(r)))
    assert row.demand == (None if hits is None else hits / 10.0)
    high = min((x for x, n in rows if n is not None and n / 10.0 > acceptable), default=None)
    low = max((x for x, n in rows if n is not None and n / 10.0 <= acceptable and (high is None or x < high)), default=None)
    assert (row.margin_at_least, row.margin_below) == (low, high)
    assert hits is not None or row.outcome == "open"


CONDITIONS = st.sampled_from([[], ["It slides."]]).map(lambda v: Conditions.model_construct(violated=v))


DEMANDED = Demanded(0.2, "sine", 0.4, 0.2)


@QUICK
@given(CONDITIONS, st.sampled_from(["no-hinging", "recovery", "collapse"]), st.booleans(), FACTORS, st.lists(st.just("Chaos."), max_size=1))
def test_a_run_ends_as_its_outcome_says(conditions: Conditions, outcome: str, ends: bool, ratio: float, more: list[str]) -> None:
    run = Rocking.model_construct(outcome=outcome, settled=ends, peak_rotation_ratio=ratio, conditions=conditions, violated=more)
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
        pulse="sine",
        mode_I=ModeCurve.model_construct(durations_s=durations, amplitudes_g=amplitudes),
        conditions=conditions,
        sliding_from_g=[slides] * len(curve),
        hinges_elsewhere_from_g=[leaves] * len(curve),
        amplitudes_by_rule=None,
    )
    found = made.judged(pulse)
    order = sorted(zip(durations, amplitudes, strict=True), key=lambda p: p[0])
    ends = [
        max((p for p in order if p[0] <= pulse.duration_s), default=None),
        min((p for p in order if p[0] >= pulse.duration_s), default=None),
    ]
    if same and None not in ends and None not in (ends[0][1], ends[1][1]):
        want = float(np.interp(pulse.duration_s, [p[0] for p in order], [np.nan if p[1] is None else p[1] for p in order]))
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
def test_the_impulse_of_the_least_margin_decides(rows: list, conditions: Conditions, static: str, more: list[str]) -> None:
    impulses = [
        AssessedImpulse.model_construct(margin=None if a is None else a / size, failing_amplitude_g=a, amplitude_g=-size, period_s=0.5)
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
@given(st.lists(SHARES, min_size=1, max_size=4), CONDITIONS, st.none() | FACTORS, st.none() | st.tuples(*[st.sampled_from([0.0, 0.5])] * 2))
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
        assert len(known) == 1 or f" {100.0 * max(known):.3g} % of the motions of" in found.statement
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
        decided(one, "stands" if share == 0.0 else "collapses" if share == 1.0 else "open", [*conditions.violated, *told])
        assert f"{100.0 * share:.3g} % of {count}" in one.statement and one.demand == share
    levels = OverLevels.model_construct(
        count=[count],
        median=middle,
        intensity="PGA",
        intensity_unit="g",
        collapse_probability=[share if share is not None else 0.5, *([None] if None in shares else [])],
        conditions=conditions,
    ).judged(DEMANDED)
    assert middle is not None or f"{100.0 * (0.5 if share is None else share):.3g} %" in levels.statement
    assert (levels.outcome, levels.capacity, levels.violated) == ("not-applicable", middle, conditions.violated)


@QUICK
@given(
    FACTORS,
    st.none() | FACTORS,
    st.sampled_from([(None, None), (0.5, 1.5), (0.9, 0.95), (1.1, 2.0)]),
    CONDITIONS,
    st.sampled_from([Ensemble, OverLevels]),
)
def test_a_rate_is_compared_with_the_accepted_one(
    rate: float, accepted: float | None, around: tuple, conditions: Conditions, of: type[Ensemble | OverLevels]
) -> None:
    """An annual rate stands below the accepted one, collapses above, and is open where its interval holds the accepted one."""
    interval = [None if factor is None else factor * rate for factor in around]
    shares = (
        {"collapse_probability": 0.25, "collapsed": 1, "count": 4} if of is Ensemble else {"collapse_probability": [0.25], "count": [4]}
    )
    found = of.model_construct(
        **shares,
        annual_collapse_rate=rate,
        annual_collapse_rate_interval=interval,
        acceptable_annual_rate=accepted,
        conditions=conditions,
        collapse_probability_by_rule=None,
        rule_band=None,
    ).judged(DEMANDED)
    assert (found.demand, found.capacity, found.unit) == (rate, accepted, "1/year") and f"{rate:.3g}" in found.statement
    if accepted is None:
        assert found.outcome not in ("stands", "collapses") and "gives no acceptable rate" in found.statement
        return
    holds = interval[0] is not None and interval[0] < accepted <= interval[1]
    decided(found, "open" if holds else "stands" if rate < accepted else "collapses", conditions.violated)
    assert f"{accepted:.3g} is accepted" in found.statement and (f"between {interval[0] or 0.0:.2g} and" in found.statement) == holds


@QUICK
@given(st.sampled_from(["no-hinging", "recovery", "collapse"]), FACTORS, st.none() | FACTORS, CONDITIONS, st.integers(1, 20))
def test_the_worst_motion_under_a_cap(outcome: str, cap: float, least: float | None, conditions: Conditions, cycles: int) -> None:
    """A resonance collapses as its run does; it stands below the least cap that makes the rotation grow; else it is open."""
    found = Resonance.model_construct(outcome=outcome, cap_g=cap, least_cap_g=least, conditions=conditions, half_cycles=cycles)
    verdict = found.judged(DEMANDED)
    want = "collapses" if outcome == "collapse" else "stands" if least is not None and cap < least else "open"
    decided(verdict, want, conditions.violated)
    assert (verdict.demand, verdict.capacity, verdict.unit) == (cap, least, "g")
    assert ("does not cause collapse" in verdict.statement) == (want != "collapses")
    assert (f"exceeds {least or 0.0:.3g} g" in verdict.statement) == (least is not None)


@QUICK
@given(st.lists(st.none() | FACTORS, min_size=1, max_size=5), CONDITIONS, st.sampled_from(["sine", "step"]), st.integers(4, 80))
@example([0.05, None], Conditions.model_construct(violated=[]), "sine", 16)  # at an amplitude of the map, beside one without collapse
def test_maps_name_their_least_amplitude_and_duration(cells: list, conditions: Conditions, pulse: str, place: int) -> None:
    """A harmonic map, a spectrum and a domain of elements name the least value that causes collapse, or none; a domain compares the deck's own pulse
    with its curve."""
    least = min((a for a in cells if a is not None), default=None)
    found = HarmonicMap.model_construct(lowest_overturning_amplitude_g=cells, conditions=conditions).judged(DEMANDED)
    assert (found.demand, found.capacity, found.unit, found.violated) == (None, least, "g", conditions.violated)
    assert (f"{least or 0.0:.3g} g" in found.statement) == (least is not None) and found.outcome not in ("stands", "collapses")

    amplitudes = [float(k + 1) for k in range(len(cells))]
    domain = DemDomain.model_construct(pulse=pulse, amplitudes_g=amplitudes, shortest_durations_s=cells)
    asked = Demanded(0.2, "sine", 0.9, place / 16.0)
    verdict = domain.judged(asked)
    below = max((a for a in amplitudes if a <= asked.amplitude_g), default=None)
    above = min((a for a in amplitudes if a >= asked.amplitude_g), default=None)
    ends = [None if a is None else cells[amplitudes.index(a)] for a in (below, above)]
    if pulse == "sine" and None not in ends:
        at = float(np.interp(asked.amplitude_g, [below, above], ends)) if below != above else ends[0]
        assert math.isclose(verdict.capacity, at) and verdict.demand == 0.9
        assert verdict.outcome == ("stands" if at > 0.9 else "collapses")
        assert ("at least as long" in verdict.statement) == (at <= 0.9)
    else:
        assert (verdict.demand, verdict.capacity) == (None, least) and verdict.outcome not in ("stands", "collapses")
        assert (f"{least or 0.0:.3g} s" in verdict.statement) == (least is not None)

    spectrum = RockingSpectrum.model_construct(
        family=["a", "b"], overturned=[len(cells), 0], size_m=[1.0] * 5, conditions=[conditions, Conditions.model_construct(violated=[])]
    ).judged(DEMANDED)
    assert f"{len(cells)} of the 10 " in spectrum.statement and spectrum.violated == [f"a: {text}" for text in conditions.violated]
