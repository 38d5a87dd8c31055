"""Results of the rocking statistics: fragility, resonance, rocking-spectrum, harmonic-map."""

from typing import Literal

from extrados.results.dem import Convergence
from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.rocking import Conditions, RockingOutcome
from extrados.results.verdict import Demand, KindResults, Outcome, Verdict, judge

#: Name of the levels that are sizes of the structure
SIZE_FACTOR = "factor of all lengths"


class Sensitivity(ResultModel):
    """Sobol indices of one uncertain value: its own share of the variance, and that of all in which it is involved."""

    rotation_first: float | None = fact("first-order Sobol index of the greatest rotation; a run that collapses counts as 1")
    rotation_first_interval: list[float | None] = fact("its bootstrap interval")
    rotation_total: float | None = fact("total Sobol index of the greatest rotation")
    rotation_total_interval: list[float | None] = fact("its bootstrap interval")
    collapse_first: float | None = fact(
        "first-order Sobol index of the outcome (collapse 1, otherwise 0); null if all runs have the same outcome"
    )
    collapse_first_interval: list[float | None] = fact("its bootstrap interval")
    collapse_total: float | None = fact("total Sobol index of the outcome (collapse 1, otherwise 0)")
    collapse_total_interval: list[float | None] = fact("its bootstrap interval")


class Annual(KindResults):
    """What a curve of collapse and the hazard of a site give."""

    annual_collapse_rate: float = maybe(
        "mean annual rate of collapse", "1/year", source="Cornell and Krawinkler 2000, PEER Center News 3(2)"
    )
    annual_collapse_rate_interval: list[float | None] = maybe(
        "confidence interval of the annual collapse rate, due to the uncertainty of the fitted fragility curve", "1/year"
    )
    annual_collapse_rate_left_out: float = maybe(
        "part of the collapse rate that intensities beyond the ends of the hazard curve may add", "1/year"
    )
    collapse_return_period_years: float | None = maybe("return period of collapse: 1 divided by the annual collapse rate", "year")
    years: float = maybe("number of years to which `collapse_probability_in_years` refers", "year")
    collapse_probability_in_years: float = maybe("probability of collapse within `years`, if earthquakes are independent events")
    collapse_probability_in_years_interval: list[float | None] = maybe("confidence interval of `collapse_probability_in_years`")
    decisive_intensity: float = maybe("intensity at which the contribution to the collapse rate is greatest, in `intensity_unit`")
    acceptable_annual_rate: float | None = maybe("annual collapse rate that the deck accepts", "1/year")

    def judged_by_rate(self, violated: list[str]) -> Verdict | None:
        """The annual rate against the accepted one; open where the interval holds both. None without a hazard."""
        rate, accepted = self.annual_collapse_rate, self.acceptable_annual_rate
        if rate is None:
            return None
        text = f"The mean annual rate of collapse is {rate:.3g}"
        if accepted is None:
            return judge(f"{text}. The deck gives no acceptable rate for comparison.", rate, None, "1/year", violated=violated)
        low, high = self.annual_collapse_rate_interval
        outcome: Outcome = "stands" if rate < accepted else "collapses"
        if low is not None and high is not None and low < accepted <= high:
            outcome = "open"
            text += f", between {low:.2g} and {high:.2g}"
        return judge(f"{text}; {accepted:.3g} is accepted.", rate, accepted, "1/year", outcome, violated=violated)


class RotationLimit(ResultModel):
    """The curve of rotations beyond a limit."""

    rotation_ratio: float = fact("limit of the rotation, divided by the critical rotation")
    median: float = fact("median of the lognormal fragility curve for this limit, in `intensity_unit`")
    dispersion: float = fact("dispersion of the curve of `median` (standard deviation of the logarithm)")
    median_interval: list[float | None] = fact("profile-likelihood interval of `median`")
    annual_rate: float = maybe("mean annual rate at which the limit is exceeded", "1/year")
    annual_rate_interval: list[float | None] = maybe("its profile-likelihood interval", "1/year")


class MeasureDispersion(ResultModel):
    """How well one intensity measure of the motions separates collapse from survival."""

    measure: str = fact("intensity measure")
    unit: str = fact("unit of its median")
    median: float = fact("median of the lognormal collapse fragility curve in terms of this measure, in `unit`")
    dispersion: float = fact("dispersion of the curve of `median` (standard deviation of the logarithm)")
    amplitude_dispersion: float = fact(
        "dispersion in terms of the amplitude of the motion, comparable between measures: half of "
        "`dispersion` for a measure that grows with the square of the amplitude"
    )
    deviance: float = fact("-2 ln(likelihood) of the outcomes, given this measure; the measure with the least value predicts collapse best")


class Ensemble(Annual):
    """fragility: one structure under many motions, each as it is."""

    count: int = fact("number of runs with a result")
    failed: int = fact("number of runs without a result")
    collapsed: int = fact("number of runs that collapse")
    collapse_probability: float | None = fact("collapse probability: share of the runs that collapse")
    confidence_interval: list[float] = fact(
        "confidence interval (Wilson score, level `confidence`) of `collapse_probability`", source="Wilson 1927"
    )
    uplifted: int = fact("number of runs in which rocking starts")
    uplift_probability: float | None = fact("share of the runs in which rocking starts")
    uplift_confidence_interval: list[float] = fact(
        "confidence interval (Wilson score, level `confidence`) of `uplift_probability`", source="Wilson 1927"
    )
    mean_peak_rotation_ratio: float | None = fact(
        "mean of the peak rotation divided by the critical rotation; a run that collapses counts as 1"
    )
    deviation_peak_rotation_ratio: float | None = fact("standard deviation of the peak rotation divided by the critical rotation")
    median_peak_rotation_ratio: float | None = fact("median of the peak rotation divided by the critical rotation")
    confidence: float = fact("level of all intervals")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    critical_rotation_rad: float = fact("critical rotation, beyond which gravity causes collapse", "rad")
    initial_rotation_ratio: float = fact("rotation at the start, divided by the critical rotation")
    motions: int = fact("number of motions")
    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, over all runs")
    handed_over: int = maybe(
        "number of runs that were continued with rigid contacts, because joints slide or hinges form outside the rocking mechanism",
        source="Moreau 1988",
    )
    collapse_probability_by_rule: dict[str, float] = maybe(
        "share of the runs that collapse, by each impact rule; given if the coefficients of restitution "
        "c_v of the rules differ by a factor of more than 1.3"
    )
    median_pga_g: float | None = fact("median, over all runs, of the peak ground acceleration", "g")
    median_pgv_m_s: float | None = fact("median, over all runs, of the peak ground velocity", "m/s")
    median_arias_m_s: float | None = fact("median, over all runs, of the Arias intensity", "m/s")
    expected_pga_g: float = maybe(
        "for generated motions: median peak acceleration observed in earthquakes of their intensity", "g", source="Worden et al. 2012"
    )
    expected_pgv_m_s: float = maybe(
        "for generated motions: median peak velocity observed in earthquakes of their intensity", "m/s", source="Worden et al. 2012"
    )

    sensitivity: dict[str, Sensitivity] = maybe(
        "Sobol indices of each uncertain value; `motion` is the random choice of the motion", source="Saltelli and others 2010"
    )
    sensitivity_runs: int = maybe("number of additional runs for the Sobol indices; they are not included in `count`")
    intensity: str = maybe("for a cloud analysis: intensity measure of the fragility curves; medians are in its unit")
    intensity_unit: str = maybe("unit of the intensities and of the medians")
    median: float | None = maybe(
        "median of the lognormal collapse fragility curve over the intensities of the motions", source="Jalayer and others 2017"
    )
    dispersion: float | None = maybe(
        "dispersion of the curve of `median` (standard deviation of the logarithm)", source="Jalayer and others 2017"
    )
    median_interval: list[float | None] = maybe("profile-likelihood interval of `median`")
    dispersion_interval: list[float | None] = maybe("profile-likelihood interval of `dispersion`")
    rotation_limits: list[RotationLimit] = maybe("curves of rotations beyond limits")
    measures: list[MeasureDispersion] = maybe(
        "for a cloud analysis: intensity measures, ranked by how well they separate collapse from survival; the best comes first",
        source="Luco and Cornell 2007",
    )

    def judged(self, demand: Demand) -> Verdict:
        """The share of motions that bring it down; open unless all agree."""
        if self.collapse_probability is None:
            return judge("No motion could be run.", outcome="open")
        if (by_rate := self.judged_by_rate(self.conditions.violated)) is not None:
            return by_rate
        outcome: Outcome = "stands" if not self.collapsed else "collapses" if self.collapsed == self.count else "open"
        text = f"{100.0 * self.collapse_probability:.3g} % of {self.count} motions cause collapse."
        violated = list(self.conditions.violated)
        if by_rule := self.collapse_probability_by_rule:
            told = ", ".join(f'"{rule}" {100.0 * share:.3g} %' for rule, share in by_rule.items())
            if min(by_rule.values()) < max(by_rule.values()):
                violated.append(f"The impact rule decides: {told}.")
        return judge(text, self.collapse_probability, None, "of all runs", outcome, violated=violated)


class RuleShares(ResultModel):
    """Probabilities of collapse by an impact rule."""

    rule: str = fact("impact rule: a value of [joints] `restitution`")
    restitution: float = fact(
        "coefficient of restitution (angular velocity after / before impact), limited to values from 0 "
        "to 1; for a mechanism, at the impact that starts rocking towards +x"
    )
    collapse_probability: list[float] = fact("share of the motions that cause collapse, at each level of intensity")


class LevelShares(Annual):
    """Shares of one structure under the same motions scaled to levels of an intensity; lists hold one value a level."""

    intensity: str = fact("intensity measure to which motions are scaled; levels and medians are in its unit")
    intensity_unit: str = fact("unit of the levels and of the medians")
    levels: list[float] = fact("the levels, ascending, in intensity_unit")
    motions: int = fact("number of motions")
    sliding_share: list[float | None] = fact("share of the motions in which blocks slide, at each level of intensity")
    count: list[int] = fact("number of motions with a result, at each level of intensity")
    failed: int = fact("number of runs without a result")
    collapsed: list[int] = fact("number of motions that cause collapse, at each level of intensity")
    collapse_probability: list[float | None] = fact("share of the motions that cause collapse, at each level of intensity")
    confidence_interval: list[list[float]] = fact(
        "confidence intervals (Wilson score, level `confidence`) of the probability of collapse", source="Wilson 1927"
    )
    uplifted: list[int] = fact("number of motions under which rocking starts, at each level of intensity")
    uplift_probability: list[float | None] = fact("share of the motions under which rocking starts, at each level of intensity")
    uplift_confidence_interval: list[list[float]] = fact(
        "confidence intervals (Wilson score, level `confidence`) of the share of motions under which rocking starts", source="Wilson 1927"
    )
    median_pga_g: list[float | None] = fact("median peak acceleration of the scaled motions, at each level of intensity", "g")
    confidence: float = fact("level of all intervals")
    median: float | None = maybe(
        "median of the lognormal curve of the probability that a motion of a given level causes collapse, in `intensity_unit`",
        source="Baker 2015",
    )
    dispersion: float | None = maybe("dispersion of the curve of `median` (standard deviation of the logarithm)", source="Baker 2015")
    deviance: float | None = maybe("deviance of the curve of `median`")
    degrees_of_freedom: int = maybe("degrees of freedom of the curve of `median`")
    goodness_p_value: float | None = maybe("p-value of the goodness of fit: probability of a greater deviance if the fitted curve is true")
    median_interval: list[float | None] = maybe(
        "bootstrap confidence interval of `median`, resampled by motion (with all levels of each motion)"
    )
    dispersion_interval: list[float | None] = maybe("bootstrap confidence interval of `dispersion`")
    first_collapse_median: float | None = maybe(
        "median of the lognormal curve of the lowest intensity at which a motion causes collapse, in `intensity_unit`",
        source="interval-censored likelihood: Burridge 1981",
    )
    first_collapse_dispersion: float | None = maybe(
        "dispersion of the curve of `first_collapse_median` (standard deviation of the logarithm)",
        source="interval-censored likelihood: Burridge 1981",
    )
    first_collapse_deviance: float | None = maybe("deviance of the curve of `first_collapse_median`")
    first_collapse_degrees_of_freedom: int = maybe("degrees of freedom of the curve of `first_collapse_median`")
    first_collapse_goodness_p_value: float | None = maybe(
        "p-value of the goodness of fit: probability of a greater deviance if the fitted curve is true"
    )
    first_collapse_median_interval: list[float | None] = maybe("profile-likelihood interval of `first_collapse_median`")
    first_collapse_dispersion_interval: list[float | None] = maybe("profile-likelihood interval of `first_collapse_dispersion`")
    uplift_median: float | None = maybe(
        "median of the lognormal curve of the probability that rocking starts, in `intensity_unit`", source="Baker 2015"
    )
    uplift_dispersion: float | None = maybe(
        "dispersion of the curve of `uplift_median` (standard deviation of the logarithm)", source="Baker 2015"
    )
    uplift_deviance: float | None = maybe("deviance of the curve of `uplift_median`")
    uplift_degrees_of_freedom: int = maybe("degrees of freedom of the curve of `uplift_median`")
    uplift_goodness_p_value: float | None = maybe(
        "p-value of the goodness of fit: probability of a greater deviance if the fitted curve is true"
    )
    overturning_given_uplift_median: float | None = maybe(
        "median of the lognormal curve of the probability of collapse if rocking starts, in `intensity_unit`", source="Baker 2015"
    )
    overturning_given_uplift_dispersion: float | None = maybe(
        "dispersion of the curve of `overturning_given_uplift_median` (standard deviation of the logarithm)", source="Baker 2015"
    )
    overturning_given_uplift_deviance: float | None = maybe("deviance of the curve of `overturning_given_uplift_median`")
    overturning_given_uplift_degrees_of_freedom: int = maybe("degrees of freedom of the curve of `overturning_given_uplift_median`")
    overturning_given_uplift_goodness_p_value: float | None = maybe(
        "p-value of the goodness of fit: probability of a greater deviance if the fitted curve is true"
    )
    motions_that_collapse: int = fact("number of motions that cause collapse at one or more levels")
    resurrections: int = maybe("number of motions that cause collapse at one level but not at a higher level (levels of motions only)")

    def judged_over_levels(self, violated: list[str]) -> Verdict:
        """The fitted median is the capacity; levels are questions, not a demand."""
        if not any(self.count):
            return judge("No motion could be run.", outcome="open")
        if (by_rate := self.judged_by_rate(violated)) is not None:
            return by_rate
        unit = f" {self.intensity_unit}" if self.intensity_unit else ""
        if self.median is None:
            share = [p for p in self.collapse_probability if p is not None]
            return judge(
                f"At the highest level of {self.intensity}, {100.0 * share[-1]:.3g} % of the motions cause collapse. "
                "No fragility curve could be fitted.",
                None,
                None,
                self.intensity_unit,
                "not-applicable",
                violated=violated,
            )
        return judge(
            f"Half of the motions cause collapse at an intensity of {self.intensity} {self.median:.3g}{unit}.",
            None,
            self.median,
            self.intensity_unit,
            "not-applicable",
            violated=violated,
        )


class OverLevels(LevelShares):
    """fragility: one structure under the same motions scaled to levels of an intensity; lists hold one value a level."""

    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, over all runs")
    handed_over: int = maybe(
        "number of runs that were continued with rigid contacts, because joints slide or hinges form outside the rocking mechanism",
        source="Moreau 1988",
    )
    hinges_elsewhere_share: list[float | None] = fact(
        "share of the motions for which hinges form outside the rocking mechanism, at each level of intensity"
    )
    mean_peak_rotation_ratio: list[float | None] = fact(
        "mean of the peak rotation divided by the critical rotation, at each level; a motion that causes collapse counts as 1"
    )
    deviation_peak_rotation_ratio: list[float | None] = fact(
        "standard deviation of the peak rotation divided by the critical rotation, at each level"
    )
    median_peak_rotation_ratio: list[float | None] = fact(
        "median of the peak rotation divided by the critical rotation, at each level; a motion that causes collapse counts as 1"
    )
    peak_rotation_ratio_16: list[float | None] = fact(
        "16th percentile of the peak rotation divided by the critical rotation, at each level; "
        "null if this percentile corresponds to collapse",
        source="Vamvatsikos and Cornell 2002",
    )
    peak_rotation_ratio_50: list[float | None] = fact(
        "median of the peak rotation divided by the critical rotation, at each level; null if the median corresponds to collapse"
    )
    peak_rotation_ratio_84: list[float | None] = fact(
        "84th percentile of the peak rotation divided by the critical rotation, at each level; "
        "null if this percentile corresponds to collapse"
    )
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    critical_rotation_rad: float = fact("critical rotation, beyond which gravity causes collapse", "rad")
    initial_rotation_ratio: float = fact("rotation at the start, divided by the critical rotation")
    collapse_by_rule: list[RuleShares] = maybe(
        "probability of collapse by each impact rule; given if the coefficients of restitution c_v of "
        "the rules differ by a factor of more than 1.3"
    )
    rule_band: float = maybe("greatest difference, at one level, between the probabilities of collapse by two impact rules")

    def judged(self, demand: Demand) -> Verdict:
        """The fitted median is the capacity; levels are questions, not a demand."""
        violated = list(self.conditions.violated)
        if self.rule_band:
            violated.append(
                "The outcome depends on the impact rule: the probabilities of collapse at one level differ by up "
                f"to {100.0 * self.rule_band:.3g} %."
            )
        return self.judged_over_levels(violated)


class DemFragility(LevelShares):
    """dem-fragility: blocks under many motions, at levels of an intensity or in several sizes; lists hold one value a level."""

    solver: Literal["compliant", "nonsmooth"] = fact("model of the joints")
    direction_deg: float | None = maybe("for solids: direction of the motions in plan, as an angle from +x towards +y", "deg")
    uncertain: list[str] = fact("names of the uncertain values; each motion acts on a building with its own sampled values")
    censored: list[int] = fact("runs without a result because blocks still move at their end, at each level; included in `failed`")
    collapse_probability_bounds: list[list[float | None]] = fact(
        "bounds of the share of motions that cause collapse, at each level: if none of the `censored` runs ends with collapse, "
        "and if all do; runs that fail for another reason are not counted"
    )
    unstable: int = fact("number of sampled buildings that collapse under their own weight; they count as collapsed")
    convergence: Convergence | None = maybe("accuracy of the contact solver over all runs (rigid contacts only)")
    mean_peak_displacement_ratio: list[float | None] = fact(
        "mean ratio of the peak displacement of a block to the displacement that counts as collapse, at each level; collapse counts as 1"
    )
    deviation_peak_displacement_ratio: list[float | None] = fact(
        "standard deviation of the ratio of peak displacement to collapse displacement, at each level"
    )
    median_peak_displacement_ratio: list[float | None] = fact(
        "median of the ratio of peak displacement to collapse displacement, at each level; collapse counts as 1"
    )
    peak_displacement_ratio_16: list[float | None] = fact(
        "16th percentile of the ratio of peak displacement to collapse displacement, at each level; "
        "null if this percentile corresponds to collapse",
        source="Vamvatsikos and Cornell 2002",
    )
    peak_displacement_ratio_50: list[float | None] = fact(
        "median of the ratio of peak displacement to collapse displacement, at each level; null if the median corresponds to collapse"
    )
    peak_displacement_ratio_84: list[float | None] = fact(
        "84th percentile of the ratio of peak displacement to collapse displacement, at each level; "
        "null if this percentile corresponds to collapse"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The fitted median is the capacity; censored runs are a doubt."""
        many = sum(self.censored)
        doubts = [f"Blocks still move at the end of {many} runs, so these runs have no outcome."] if many else []
        if self.intensity == SIZE_FACTOR and any(self.count):
            shares = (
                f"{100.0 * share:.3g} % at {level:g} times the size"
                for level, share in zip(self.levels, self.collapse_probability, strict=True)
                if share is not None
            )
            text = f"Share of the motions that cause collapse: {', '.join(shares)}."
            return judge(text, None, None, "", "not-applicable", violated=doubts)
        return self.judged_over_levels(doubts)


class OverDurations(KindResults):
    """fragility: generated motions of several durations; lists hold one value a duration."""

    durations_s: list[float] = fact("durations of the motions", "s")
    mean_peak_rotation_ratio: list[float | None] = fact("mean of the peak rotation divided by the critical rotation, at each duration")
    deviation_peak_rotation_ratio: list[float | None] = fact(
        "standard deviation of the peak rotation divided by the critical rotation, at each duration"
    )
    collapse_probability: list[float | None] = fact("share of the motions that cause collapse, at each duration")
    uplift_probability: list[float | None] = fact("share of the motions under which rocking starts, at each duration")
    confidence_interval: list[list[float]] = fact(
        "confidence intervals (Wilson score, level `confidence`) of the probability of collapse", source="Wilson 1927"
    )
    confidence: float = fact("level of these intervals")
    count: list[int] = fact("number of motions with a result, at each duration")
    failed: int = fact("number of runs without a result")
    collapsed: list[int] = fact("number of motions that cause collapse, at each duration")
    uplifted: list[int] = fact("number of motions under which rocking starts, at each duration")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    critical_rotation_rad: float = fact("critical rotation, beyond which gravity causes collapse", "rad")
    initial_rotation_ratio: float = fact("rotation at the start, divided by the critical rotation")
    median_pga_g: list[float | None] = fact("median peak acceleration of the motions, at each duration", "g")
    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, over all runs")
    handed_over: int = maybe(
        "number of runs that were continued with rigid contacts, because joints slide or hinges form outside the rocking mechanism",
        source="Moreau 1988",
    )

    def judged(self, demand: Demand) -> Verdict:
        """The least and greatest share of motions that bring it down; open unless all runs agree."""
        known = [(p, d) for p, d in zip(self.collapse_probability, self.durations_s, strict=True) if p is not None]
        if not known:
            return judge("No motion could be run.", outcome="open")
        (least, short), (most, long) = min(known), max(known)
        outcome: Outcome = "stands" if most == 0.0 else "collapses" if least == 1.0 else "open"
        text = f"{100.0 * least:.3g} % of the motions of {short:g} s"
        if len(known) > 1:
            text += f" and {100.0 * most:.3g} % of the motions of {long:g} s"
        return judge(f"{text} cause collapse.", None, None, "of all runs", outcome, violated=self.conditions.violated)


Fragility = Ensemble | OverLevels | OverDurations


class Resonance(KindResults):
    """resonance: the motion under a cap that feeds most energy to a rocking structure."""

    outcome: RockingOutcome = fact("outcome under that motion")
    cap_g: float = fact("cap of the ground acceleration", "g")
    cap_ratio: float = fact("cap of the ground acceleration, divided by the uplift acceleration")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    initial_rotation_ratio: float = fact("rotation at the start, divided by the critical rotation")
    half_cycles: int = fact("number of changes of sign of the motion")
    collapse_time_s: float | None = fact("time after which the structure can no longer recover", "s")
    switch_times_s: list[float] = fact("times at which the motion changes sign", "s")
    switch_spacing_s: list[float] = fact("time between changes of sign", "s")
    peak_rotation_rad: list[float] = fact("rotation at the start, and at each change of sign of the motion", "rad")
    energy_supplied_J: float = fact("work of the ground", "J")
    energy_lost_at_impacts_J: float = fact("energy lost at impacts", "J")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, under this motion")
    cap_ratio_for_collapse_within: dict[str, float] = maybe(
        "for a block, by number of half cycles: least cap of the ground acceleration with which the block "
        "collapses within this number of half cycles, divided by the uplift acceleration"
    )
    least_cap_g: float | None = maybe(
        "for a block: least cap of the ground acceleration with which the rotation grows; null for an unsymmetric block", "g"
    )
    least_cap_ratio: float | None = maybe(
        "least cap of the ground acceleration with which the rotation grows, divided by the uplift acceleration"
    )
    least_cap_ratios: list[list[float]] = maybe(
        "least caps of the ground acceleration with which the rotation grows, divided by the uplift acceleration. Rows: aspect "
        "ratios B/H; columns: initial rotations",
        source="thesis Fig. 6-3",
    )
    aspects: list[float] = maybe("aspect ratios B/H of the blocks in `least_cap_ratios`", source="thesis Fig. 6-3")
    initial_ratios: list[float] = maybe("rotations at the start, divided by the critical rotation", source="thesis Fig. 6-3")
    impulse_amplitude_g: float = maybe(
        "for a block: amplitude of the impulses of `share_of_starts_that_add`", "g", source="thesis Fig. 6-4"
    )
    share_of_starts_that_add: dict[str, float] = maybe(
        "share of the initial states in which an impulse adds energy, for each ratio of impulse period to natural period",
        source="thesis Fig. 6-4",
    )

    def judged(self, demand: Demand) -> Verdict:
        """The cap [g] against the least that makes the rotation grow; open where it grows without coming down."""
        least = self.least_cap_g
        outcome: Outcome
        if self.outcome == "collapse":
            outcome = "collapses"
            does = "causes collapse"
        else:
            outcome = "stands" if least is not None and self.cap_g < least else "open"
            does = f"does not cause collapse within {self.half_cycles} half cycles"
        known = "" if least is None else f". The rotation grows if the limit of the acceleration exceeds {least:.3g} g"
        return judge(
            f"The worst motion with accelerations up to {self.cap_g:.3g} g {does}{known}.",
            self.cap_g,
            least,
            "g",
            outcome,
            violated=self.conditions.violated,
        )


class RuleSpectrum(ResultModel):
    """Sizes that overturn by an impact rule."""

    rule: str = fact("impact rule: a value of [joints] `restitution`")
    restitution: float = fact("coefficient of restitution (angular velocity after / before impact), limited to 0 to 1")
    overturned: int = fact("sizes that collapse")


class RockingSpectrum(KindResults):
    """rocking-spectrum: greatest rotation of blocks or arches of many sizes under a motion."""

    family: list[str] = fact("families of structures: blocks of one slenderness, or arches of one shape")
    overturned: list[int] = fact("number of members that collapse, for each family")
    longest_overturning_period_s: list[float | None] = fact(
        "longest period 2 pi/p of the members that collapse; null if none collapses", "s"
    )
    size_m: list[float] = fact("sizes: half-diagonals of the blocks, or radii of the arches", "m")
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")
    conditions: list[Conditions] = fact(
        "for each family: number of sizes for which blocks slide, or hinges form outside the rocking mechanism"
    )
    by_rule: list[RuleSpectrum] = maybe(
        "spectrum by each impact rule; given if the coefficients of restitution c_v of the rules differ by a factor of more than 1.3"
    )
    decided_by_rule: int = maybe("number of sizes whose outcome depends on the impact rule")

    def judged(self, demand: Demand) -> Verdict:
        """How many collapse; a spectrum is about no one building."""
        total = len(self.family) * len(self.size_m)
        violated = [f"{name}: {text}" for name, one in zip(self.family, self.conditions, strict=True) for text in one.violated]
        if self.decided_by_rule:
            violated.append(f"The outcome of {self.decided_by_rule} sizes depends on the impact rule.")
        return judge(f"The motion overturns {sum(self.overturned)} of the {total} calculated sizes and shapes.", violated=violated)


class HarmonicMap(KindResults):
    """harmonic-map: response to harmonic motion over frequency and amplitude."""

    cycles: int = fact("number of cycles of the motion")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    frequencies_Hz: list[float] = fact("frequencies", "Hz")
    frequency_ratios: list[float] = fact("omega/p of the frequencies")
    lowest_overturning_amplitude_g: list[float | None] = fact(
        "lowest amplitude that causes collapse, at each frequency; null if none does", "g"
    )
    safe_pocket_cells: int = fact("number of cells of the map without collapse, although a lower amplitude causes collapse")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, over all cells of the map")
    handed_over: int = maybe(
        "number of cells of the map whose motion was continued with rigid contacts, because in these cells joints slide or "
        "hinges form outside the rocking mechanism",
        source="Moreau 1988",
    )

    def judged(self, demand: Demand) -> Verdict:
        """The lowest amplitude of all that brings it down [g]; the map asks for no demand."""
        least = min((a for a in self.lowest_overturning_amplitude_g if a is not None), default=None)
        text = (
            "None of the harmonic motions of the map causes collapse."
            if least is None
            else f"The lowest amplitude of a harmonic motion that causes collapse is {least:.3g} g."
        )
        return judge(text, None, least, "g", violated=self.conditions.violated)
