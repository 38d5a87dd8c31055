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
    told: str = fact("in words")
    motions: int = fact("number of motions")
    member: int = maybe("of a set: the motion that strategies of one motion take, from 1")
    chosen_by: str = maybe("of a set: the rule by which it was taken")
    peak_ground_acceleration_g: float = fact("demand of strategies with a constant acceleration", "g")
    peak_told: str = fact("source of that peak")
    pulse_amplitude_g: float | None = fact("amplitude of the primary impulse; null: none", "g")
    pulse_period_s: float | None = fact("its period; null: none", "s")


class StrategyVerdict(ResultModel):
    """Verdict of one strategy."""

    strategy: str = fact("kind of analysis; `probability` is `fragility` with uncertain sizes or many motions")
    label: str = fact("its name in words")
    part: str | None = fact("name of the analysis of this run with its results; null without a result")
    status: RowStatus = fact("whether it has a result")
    reason: str = fact("reason without a result; else empty")
    axis: Axis = fact("quantity that is compared")
    demand: float | None = fact("demand, in `unit`")
    capacity: float | None = fact("capacity, in `unit`")
    unit: str = fact("unit of both")
    outcome: Outcome = fact("stands, collapses, cannot-stand, open or not-applicable")
    bound: Bound | None = fact("capacity as a bound: exact, upper or lower; null: an estimate")
    violated: list[str] = fact("assumptions of the strategy that were checked and do not hold; the outcome is then open")
    margin: float | None = fact("critical scale factor of the hazard; null: not known")
    margin_at_least: float | None = fact("greatest factor on the hazard that was run without collapse; null: none")
    margin_below: float | None = fact("least factor on the hazard that was run with collapse; null: none")
    parameters: str = fact("settings of the strategy, and the rule that gave them")
    assumes: str = fact("assumptions of the strategy")
    statement: str = fact("its verdict in one sentence")

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
    headline: str = fact("the reason in a few words")
    explains: list[list[str]] = fact("pairs of strategies whose difference it explains")
    text: str = fact("the reason in words, with the numbers")
    numbers: dict[str, float | None] = fact("the numbers that the rule has compared")


class Probe(ResultModel):
    """A further run that shows why strategies differ, or how large a margin is."""

    strategy: str = fact("kind of analysis")
    changed: str = fact("difference from the deck")
    outcome: Outcome = fact("its verdict")
    value: float | None = fact("its demand over its capacity; null: not known")


class TurningValue(ResultModel):
    """One value of the deck moved, all else as it is: margins of limit analysis and of rocking; of what only discrete elements
    know, how far their stones move."""

    key: str = fact("the key of the deck")
    base: float = fact("its value, in `unit`")
    unit: str = fact("unit of the value")
    low: float = fact("a value below")
    high: float = fact("a value above")
    tilt_base: float | None = fact("margin of limit analysis at the value of the deck; null: none")
    rocking_base: float | None = fact("margin of rocking at the value of the deck; null: none")
    tilt_low: float | None = fact("margin of limit analysis at the value below; null: none")
    tilt_high: float | None = fact("margin of limit analysis at the value above")
    rocking_low: float | None = fact("margin of rocking at the value below")
    rocking_high: float | None = fact("margin of rocking at the value above")
    tilt_turns: float | None = fact("value at which the verdict of limit analysis changes; null: at none that was run")
    rocking_turns: float | None = fact("value at which the verdict of rocking changes; null: at none that was run")
    dem_base: float | None = fact(
        "ratio of the displacement of discrete elements to the one that counts as collapse, at the value of the deck; null: not run"
    )
    dem_low: float | None = fact("ratio of the displacements at the value below")
    dem_high: float | None = fact("ratio of the displacements at the value above")
    dem_turns: float | None = fact(
        "value at which the verdict of discrete elements changes; null: at none that was run, or the response is chaotic"
    )


class Contribution(ResultModel):
    """Probability of collapse by one strategy, from its agreement with tests."""

    strategy: str = fact("strategy")
    quantity: str = fact("quantity of the verification book that the tests measured")
    count: int = fact("number of tests")
    bias: float = fact("geometric mean of computed over measured values")
    scatter: float = fact("standard deviation of the natural logarithm of computed over measured values")
    margin: float = fact("critical scale factor of the hazard by the strategy")
    probability: float = fact("probability that the true critical scale factor is below 1")
    low: float = fact("lower end of its 90 % confidence interval")
    high: float = fact("upper end of its 90 % confidence interval")
    weight: float = fact("weight in the overall probability: its share of the tests")


class CollapseInMotion(ResultModel):
    """Share of sampled buildings and motions that collapse by rocking under the hazard itself."""

    collapsed: int = fact("runs that collapse")
    count: int = fact("runs with a result")
    probability: float = fact("share that collapses")
    low: float = fact("lower end of its 95 % score interval", source="Wilson 1927")
    high: float = fact("upper end of its 95 % score interval", source="Wilson 1927")
    violated: list[str] = fact("assumptions of rocking that do not hold in these runs")


class CollapseProbability(ResultModel):
    """Probability of collapse, of static strategies if the peak of the hazard acted as a constant horizontal acceleration, and under the motion itself.

    The first comes from the model uncertainty of the strategies. The second is a count of dynamic runs.
    """

    in_motion: CollapseInMotion = maybe("probability of collapse under the motion itself, by rocking")
    probability: float | None = fact(
        "if the peak acted as a constant horizontal acceleration: weighted mean over the contributions; 1 for a certificate; null: no contribution"
    )
    low: float | None = fact("least lower end of the contributions' 90 % confidence intervals; null: no contribution")
    high: float | None = fact("greatest upper end of the contributions' 90 % confidence intervals; null: no contribution")
    contributions: list[Contribution] = fact("strategies whose capacity the verification book compares with known results")
    without: dict[str, str] = fact("strategies that contribute nothing, with the reason")
    statement: str = fact("the probability in words")
    method: str = fact("derivation of the probability in words")


class Advice(ResultModel):
    """What to do, by limit analysis: interventions that carry the peak of the hazard as a constant horizontal acceleration."""

    target_g: float = fact("constant horizontal acceleration that the interventions carry: the peak of the hazard", "g")
    capacity_g: float | None = fact("capacity of the existing building; null: none", "g")
    mechanism: str = fact("governing mechanism of the existing building")
    interventions: list[Intervention] = fact("alternatives, the cheapest that meets the target first")
    by_rocking: Intervention = maybe("the first tie, with the least force by which rocking under the hazard stands")
    rocking: dict[str, str] = fact("outcome of rocking under the hazard with each intervention that meets the target")
    statement: str = fact("recommendation in words")


class Assess(KindResults):
    """assess: every strategy that applies, compared."""

    whole_in_parts = True

    overall: Overall = fact("conclusion over all strategies")
    statement: str = fact("conclusion in words")
    hazard: AssessHazard = fact("the hazard")
    verdicts: list[StrategyVerdict] = fact("one row a strategy")
    agreement: dict[str, dict[str, Agreement]] = fact(
        "of each pair of strategies with a verdict: the same verdict, the same with margins far apart, another one, or open"
    )
    collapse_probability: CollapseProbability = fact("probability of collapse from the model uncertainty of the strategies")
    reasons: list[Reason] = fact("why strategies differ")
    unexplained: list[list[str]] = fact("pairs that differ without a reason that any rule has found")
    parts: dict[str, str] = fact("analyses of this run that the assessment requested: name -> description")
    probes: list[Probe] = fact("further runs")
    sensitivity: list[TurningValue] = maybe("sensitivity of the verdicts, the most decisive value first")
    advice: Advice = maybe("strengthening, if the building does not stand under all strategies")
    not_done: list[str] = fact("steps that the budget did not allow, and further runs that decided nothing")
    least_margin: float | None = fact(
        "least critical scale factor of the hazard of all strategies; 0 where the building cannot stand; null: none known"
    )
    least_margin_strategy: str | None = fact("whose it is")
    budget_s: float = fact("time that it was given", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The overall answer; the capacity is the least factor on the hazard."""
        decided: dict[str, Outcome] = {"stands under all": "stands", "collapses under all": "collapses", "cannot stand": "cannot-stand"}
        outcome = decided.get(self.overall, "open")
        return judge(self.statement, 1.0, self.least_margin, "hazard", outcome)
