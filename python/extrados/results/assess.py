"""Results of assess: verdicts of all strategies on one building under one hazard, and why they differ."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.strengthen import Intervention
from extrados.results.verdict import Bound, Demand, KindResults, Outcome, Verdict, judge, outcome_words

Axis = Literal["acceleration", "pulse", "displacement", "probability", "check"]
Overall = Literal["stands under all", "collapses under all", "cannot stand", "depends", "open"]
#: Whether a strategy has a result
RowStatus = Literal["ok", "refused", "failed", "left out"]
Agreement = Literal["agree", "apart", "disagree", "open"]


class AssessHazard(ResultModel):
    """What the ground does, as the strategies are asked."""

    kind: str = fact("kind of [motion]")
    told: str = fact("description of the hazard in words")
    motions: int = fact("number of motions")
    member: int = maybe("number of the motion in the set, counted from 1; only for strategies that use one motion")
    chosen_by: str = maybe("rule that selected this motion from the set")
    peak_ground_acceleration_g: float = fact("peak ground acceleration: the demand for strategies that apply a constant acceleration", "g")
    peak_told: str = fact("source of that peak")
    pulse_amplitude_g: float | None = fact("amplitude of the primary impulse; null if the motion has none", "g")
    pulse_period_s: float | None = fact("period of the primary impulse; null if the motion has none", "s")


class StrategyVerdict(ResultModel):
    """Verdict of one strategy."""

    strategy: str = fact("kind of analysis; `probability` means `fragility` with uncertain sizes or many motions")
    label: str = fact("name of the strategy in words")
    part: str | None = fact("name of the analysis of this run that holds the results; null without a result")
    status: RowStatus = fact("status of the strategy: whether it has a result")
    reason: str = fact("reason why the strategy has no result; empty if it has one")
    axis: Axis = fact("quantity that is compared")
    demand: float | None = fact("demand, in `unit`")
    capacity: float | None = fact("capacity, in `unit`")
    unit: str = fact("unit of demand and capacity")
    outcome: Outcome = fact("outcome: stands, collapses, cannot-stand, open (not decided) or not-applicable")
    bound: Bound | None = fact("type of the capacity: exact, lower bound or upper bound; null for an estimate")
    violated: list[str] = fact("violated assumptions of the strategy; if there are any, the outcome is open (not decided)")
    margin: float | None = fact("critical scale factor of the hazard: collapse occurs at greater factors; null if not known")
    margin_at_least: float | None = fact("greatest scale factor of the hazard that was run without collapse; null if no such run")
    margin_below: float | None = fact("least scale factor of the hazard that was run with collapse; null if no such run")
    parameters: str = fact("settings of the strategy, and the rule that selected them")
    assumes: str = fact("assumptions of the strategy")
    statement: str = fact("verdict of the strategy in one sentence")

    @property
    def verdict_words(self) -> str:
        """Its outcome in words, or why it has none."""
        return outcome_words(self.outcome, self.axis == "check") if self.status == "ok" else self.status

    def margin_told(self, nothing: str = "not known") -> str:
        """The margin in words: a factor, or between which ones it lies; `nothing` where none is known."""
        if self.margin is not None:
            return f"{self.margin:.3g}"
        low, high = self.margin_at_least, self.margin_below
        if low is not None and high is not None:
            digits = next((d for d in (3, 4, 5) if f"{low:.{d}g}" != f"{high:.{d}g}"), 6)
            return f"{low:.{digits}g} to {high:.{digits}g}"
        return f"above {low:.3g}" if low is not None else f"below {high:.3g}" if high is not None else nothing


class Reason(ResultModel):
    """Why strategies differ, by a rule whose numbers show it."""

    rule: str = fact("name of the rule")
    headline: str = fact("short form of the reason")
    explains: list[list[str]] = fact("pairs of strategies whose difference this reason explains")
    text: str = fact("full statement of the reason, with numbers")
    numbers: dict[str, float | None] = fact("numbers that the rule compared")


class Probe(ResultModel):
    """A further run that shows why strategies differ, or how large a margin is."""

    strategy: str = fact("kind of analysis")
    changed: str = fact("difference from the deck")
    outcome: Outcome = fact("verdict of this additional run")
    value: float | None = fact("ratio of demand to capacity in this additional run; null if not known")


class TurningValue(ResultModel):
    """One value of the deck moved, all else as it is: margins of limit analysis and of rocking; of what only discrete elements
    know, how far their stones move."""

    key: str = fact("the key of the deck")
    base: float = fact("value of the key in the deck, in `unit`")
    unit: str = fact("unit of the value")
    low: float = fact("lower value of the key, below `base`")
    high: float = fact("higher value of the key, above `base`")
    tilt_base: float | None = fact("safety factor by limit analysis, with the value `base` of the key; null without a result")
    rocking_base: float | None = fact("safety factor by rocking, with the value `base` of the key; null without a result")
    tilt_low: float | None = fact("safety factor by limit analysis, with the value `low` of the key; null without a result")
    tilt_high: float | None = fact("safety factor by limit analysis, with the value `high` of the key")
    rocking_low: float | None = fact("safety factor by rocking, with the value `low` of the key")
    rocking_high: float | None = fact("safety factor by rocking, with the value `high` of the key")
    tilt_turns: float | None = fact(
        "value of the key at which the verdict of limit analysis changes; null if no calculated value changes the verdict"
    )
    rocking_turns: float | None = fact(
        "value of the key at which the verdict of rocking changes; null if no calculated value changes the verdict"
    )
    dem_base: float | None = fact(
        "displacement by discrete elements, with the value `base` of the key, divided by the "
        "displacement that counts as collapse; null without a run"
    )
    dem_low: float | None = fact(
        "displacement by discrete elements, with the value `low` of the key, divided by the displacement that counts as collapse"
    )
    dem_high: float | None = fact(
        "displacement by discrete elements, with the value `high` of the key, divided by the displacement that counts as collapse"
    )
    dem_turns: float | None = fact(
        "value of the key at which the verdict of discrete elements changes; null if no calculated value changes the verdict, or if "
        "the response is chaotic"
    )


class Contribution(ResultModel):
    """Probability of collapse by one strategy, from its agreement with tests."""

    strategy: str = fact("strategy")
    quantity: str = fact("quantity measured in the tests, as named in the verification book")
    count: int = fact("number of tests")
    bias: float = fact("geometric mean of the ratio of calculated to measured values")
    scatter: float = fact("standard deviation of the natural logarithm of the ratio of calculated to measured values")
    margin: float = fact("critical scale factor of the hazard according to this strategy")
    probability: float = fact("probability that the true critical scale factor is below 1")
    low: float = fact("lower end of the 90 % confidence interval of `probability`")
    high: float = fact("upper end of the 90 % confidence interval of `probability`")
    weight: float = fact(
        "weight of this strategy in the overall probability of collapse: "
        "its share of the experiments with which the strategies were compared"
    )


class CollapseInMotion(ResultModel):
    """Share of sampled buildings and motions that collapse by rocking under the hazard itself."""

    collapsed: int = fact("runs that collapse")
    count: int = fact("runs with a result")
    probability: float = fact("share that collapses")
    low: float = fact("lower end of the 95 % confidence interval (Wilson score) of the share of runs that collapse", source="Wilson 1927")
    high: float = fact("upper end of the 95 % confidence interval (Wilson score) of the share of runs that collapse", source="Wilson 1927")
    violated: list[str] = fact("violated assumptions of the rocking analysis in these runs")


class CollapseProbability(ResultModel):
    """Probability of collapse, of static strategies if the peak of the hazard acted as a constant horizontal acceleration, and under the motion itself.

    The first comes from the model uncertainty of the strategies. The second is a count of dynamic runs.
    """

    in_motion: CollapseInMotion = maybe("probability of collapse under the motion itself: share of the rocking runs that collapse")
    probability: float | None = fact(
        "probability of collapse if the peak acceleration acts as a constant horizontal acceleration: weighted mean over the "
        "strategies; 1 if a certificate proves collapse; null if no strategy contributes"
    )
    low: float | None = fact(
        "lower end of the interval of `probability`: least of the lower ends of the 90 % confidence intervals of the strategies that "
        "contribute; null if no strategy contributes"
    )
    high: float | None = fact(
        "upper end of the interval of `probability`: greatest of the upper ends of the 90 % confidence intervals of the strategies that "
        "contribute; null if no strategy contributes"
    )
    contributions: list[Contribution] = fact(
        "strategies that contribute to `probability`: their capacities are compared with known results in the verification book"
    )
    without: dict[str, str] = fact("strategies that do not contribute to the probability, each with the reason")
    statement: str = fact("the probability in words")
    method: str = fact("text that explains how the probability is derived")


class Advice(ResultModel):
    """What to do, by limit analysis: interventions that carry the peak of the hazard as a constant horizontal acceleration."""

    target_g: float = fact(
        "constant horizontal acceleration that the strengthened building must carry: the peak acceleration of the hazard", "g"
    )
    capacity_g: float | None = fact("capacity of the existing building; null without a result", "g")
    mechanism: str = fact("governing collapse mechanism of the existing building")
    interventions: list[Intervention] = fact("alternative interventions; the cheapest that reaches the target comes first")
    by_rocking: Intervention = maybe(
        "the first tie of `interventions`, with the least yield force at which the building survives rocking under the hazard"
    )
    rocking: dict[str, str] = fact("outcome of rocking under the hazard, for each intervention that reaches the target")
    statement: str = fact("recommendation in words")


class Assess(KindResults):
    """assess: every strategy that applies, compared."""

    whole_in_parts = True

    overall: Overall = fact("conclusion over all strategies")
    statement: str = fact("conclusion in words")
    hazard: AssessHazard = fact("the hazard")
    verdicts: list[StrategyVerdict] = fact("one row a strategy")
    agreement: dict[str, dict[str, Agreement]] = fact(
        "comparison of the verdicts of each pair of strategies: same verdict, same verdict with very "
        "different safety factors, different verdicts, or open"
    )
    collapse_probability: CollapseProbability = fact("probability of collapse from the model uncertainty of the strategies")
    reasons: list[Reason] = fact("why strategies differ")
    unexplained: list[list[str]] = fact("pairs of strategies that differ for a reason that no rule of this program explains")
    parts: dict[str, str] = fact("analyses that the assessment added to this run: name and description")
    probes: list[Probe] = fact("additional runs")
    sensitivity: list[TurningValue] = maybe("sensitivity of the verdicts to each uncertain value; the most decisive value comes first")
    advice: Advice = maybe("strengthening, if not all strategies give the verdict `stands`")
    not_done: list[str] = fact("steps that were omitted or gave no result, for instance because the time `budget` was used up")
    least_margin: float | None = fact(
        "lowest critical scale factor of the hazard among all strategies; 0 if the building cannot stand; null if no factor is known"
    )
    least_margin_strategy: str | None = fact("strategy with the lowest critical scale factor")
    budget_s: float = fact("time limit of the assessment (key `budget`)", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The overall answer; the capacity is the least factor on the hazard."""
        decided: dict[str, Outcome] = {"stands under all": "stands", "collapses under all": "collapses", "cannot stand": "cannot-stand"}
        outcome = decided.get(self.overall, "open")
        return judge(self.statement, 1.0, self.least_margin, "hazard", outcome)
