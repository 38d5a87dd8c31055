"""One probability of collapse from the agreement of each strategy with tests."""

import numpy as np

from extrados.analyses.assess.strategies import of
from extrados.analyses.statistics.summaries import wilson
from extrados.results.assess import CollapseInMotion, CollapseProbability, Contribution, StrategyVerdict
from extrados.results.statistics import Ensemble, OverLevels
from extrados.results.uncertainty import ModelUncertainty, collapse_probability, uncertainties_of
from extrados.results.verdict import KindResults

#: Quantities of the verification book that are a capacity under a horizontal load
CAPACITIES = ("capacity in acceleration", "peak load")
#: Strategies whose critical scale factor is a static capacity over the peak
STATIC = "acceleration"
#: Distance from 1 within which a factor on the motions is the hazard itself
SAME = 1e-9


def estimate_collapse(rows: list[StrategyVerdict], fragility: KindResults | None = None) -> CollapseProbability:
    """The weighted mean of the static strategies that experiments have tested, whose interval encloses those of all contributions, and
    the share of collapses under the motion itself. fragility: results of the strategy `probability`."""
    if proven := next((row for row in rows if row.outcome == "cannot-stand"), None):
        return CollapseProbability(
            probability=1.0,
            low=1.0,
            high=1.0,
            contributions=[],
            without={},
            statement="Probability of collapse 100 %: a certificate proves collapse under self-weight.",
            method=f"Within its assumptions, this certificate ({proven.label}) has no model uncertainty.",
        )
    tested: list[tuple[StrategyVerdict, ModelUncertainty]] = []
    without: dict[str, str] = {}
    for row in rows:
        entry = _entry(row)
        if isinstance(entry, str):
            without[row.strategy] = entry
        else:
            tested.append((row, entry))
    total = sum(entry.count for _, entry in tested)
    contributions = [_contribution(row, entry, entry.count / total) for row, entry in tested]
    moving = _in_motion(rows, fragility)
    dynamic = {} if moving is None else {"in_motion": moving}
    said = "" if moving is None else f"{_motion_told(moving)} "
    labels = {row.strategy: row.label for row in rows}
    reasons: dict[str, list[str]] = {}
    for name, reason in without.items():
        reasons.setdefault(reason, []).append(labels[name])
    told = "; ".join(f"{', '.join(names)} ({reason})" for reason, names in reasons.items())
    left = f" No contribution: {told}." if told else ""
    if not contributions:
        return CollapseProbability(
            probability=None,
            low=None,
            high=None,
            contributions=[],
            without=without,
            **dynamic,
            statement=said.strip()
            or (
                "No probability of collapse is given: no strategy has both a critical scale factor and a "
                "comparison with known results in the verification book."
            ),
            method=left.strip(),
        )
    p = sum(one.weight * one.probability for one in contributions)
    low, high = min(one.low for one in contributions), max(one.high for one in contributions)
    names = " and ".join(labels[one.strategy] for one in contributions)
    said += (
        "If the peak of the hazard acted as a constant horizontal acceleration, the probability of collapse would be "
        f"{percent(p)} (90 % confidence interval {percent(low)} to {percent(high)}). This probability follows from the model "
        f"uncertainty of {names}. This static number is not the probability of collapse in the earthquake."
    )
    if any(row.axis != STATIC and row.outcome == "stands" for row in rows):
        said += " A motion whose peak exceeds the capacity only briefly may cause no collapse."
    each = "; ".join(
        f"{labels[one.strategy]}: {one.count} tests, bias {one.bias:.3g}, scatter {one.scatter:.3g}, critical scale factor {one.margin:.3g}, "
        f"probability {percent(one.probability)} ({percent(one.low)} to {percent(one.high)}), weight {one.weight:.2g}"
        for one in contributions
    )
    method = (
        "The ratio of calculated to measured capacity is assumed lognormal. Its bias and scatter come from the tests of the "
        "verification book; the number of tests gives the confidence interval. The weight of a strategy is its share of all tests. The "
        f"overall interval encloses the intervals of all strategies. {each}.{left}"
    )
    return CollapseProbability(
        probability=p, low=low, high=high, contributions=contributions, without=without, statement=said, method=method, **dynamic
    )


def _in_motion(rows: list[StrategyVerdict], fragility: KindResults | None) -> CollapseInMotion | None:
    """The share of collapses at the hazard itself; None where no motion could be run, or no level is the hazard."""
    if isinstance(fragility, OverLevels):
        k = int(np.argmin(np.abs(np.array(fragility.levels) - 1.0)))
        if fragility.intensity != "scale" or abs(fragility.levels[k] - 1.0) > SAME:
            return None
        count, collapsed = fragility.count[k], fragility.collapsed[k]
    elif isinstance(fragility, Ensemble):
        count, collapsed = fragility.count, fragility.collapsed
    else:
        return None
    if not count:
        return None
    low, high = wilson(collapsed, count)
    violated = next((row.violated for row in rows if row.strategy == "probability"), [])
    return CollapseInMotion(
        collapsed=collapsed, count=count, probability=collapsed / count, low=float(low), high=float(high), violated=violated
    )


def _motion_told(one: CollapseInMotion) -> str:
    told = f"{percent(one.probability)} (95 % interval {percent(one.low)} to {percent(one.high)})"
    if one.collapsed == 0:  # a share of 0 in few runs is no probability
        told = f"at most {percent(one.high)}"
    elif one.collapsed == one.count:
        told = f"at least {percent(one.low)}"
    text = f"Probability of collapse under the hazard by rocking {told}: {one.collapsed} of {one.count} runs collapse."
    return f"{text} In these runs, assumptions of the rocking analysis are violated." if one.violated else text


def _entry(row: StrategyVerdict) -> ModelUncertainty | str:
    """The tests of a strategy with a critical scale factor, or the reason why it contributes nothing."""
    if row.status != "ok":
        return "no result"
    entries = [one for one in uncertainties_of(of(row.strategy).kind) if one.quantity in CAPACITIES]
    if row.axis != STATIC or not entries:
        return "the verification book does not compare the capacity of this strategy with known results"
    if row.violated:
        return "assumptions that do not hold"
    if row.margin is None:
        return "no critical scale factor"
    return max(entries, key=lambda one: one.count)


def _contribution(row: StrategyVerdict, entry: ModelUncertainty, weight: float) -> Contribution:
    margin = row.margin
    assert margin is not None
    p, low, high = collapse_probability(margin, entry)
    return Contribution(
        strategy=row.strategy,
        quantity=entry.quantity,
        count=entry.count,
        bias=entry.bias,
        scatter=entry.scatter,
        margin=margin,
        probability=p,
        low=low,
        high=high,
        weight=weight,
    )


def percent(p: float) -> str:
    """A probability in per cent; none is given as certain."""
    if p < 0.001:
        return "below 0.1 %"
    if p > 0.999:
        return "above 99.9 %"
    return f"{100.0 * p:.2g} %" if p < 0.99 else f"{100.0 * p:.3g} %"
