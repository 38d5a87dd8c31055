"""A model of what code checks conclude: the overall verdict and its explanations follow from the checks."""

from assess_model import BOUNDS, FACTORS, QUICK, checks, concluded
from hypothesis import given
from hypothesis import strategies as st

from extrados.analyses.assess import strategies
from extrados.results.assess import StrategyVerdict
from extrados.results.codes import Check, Checked, LocalMechanism
from extrados.results.limit import Tilt
from extrados.results.model import Result


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
    assert [(margin, check) for margin, _, check in found.governing()] == [(margin, rules[name]) for margin, name in decided]
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
        strategy=name,
        label=strategy.label,
        part=None,
        status="ok",
        reason="",
        axis=strategy.axis,
        demand=1.0,
        capacity=margin,
        unit="g",
        outcome=outcome,
        bound=None,
        violated=[],
        margin=margin,
        margin_at_least=None,
        margin_below=None,
        parameters="",
        assumes="",
        statement="So.",
    )


@QUICK
@given(checks(), FACTORS, st.none() | st.sampled_from([1.0, 0.8]))
def test_what_the_codes_explain_follows_from_their_checks(rules: dict[str, Check], multiplier: float, part: float | None) -> None:
    """The check that governs and the next are those of the rules; no reason names another number."""
    if part is not None:  # by the multiplier of statics
        capacity = 2.0 * multiplier / 1.2 / part
        rules["NTC linear"] = Check(
            capacity=capacity,
            demand=0.2,
            unit="g",
            verdict="holds" if capacity > 0.2 else "fails",
            source="",
            note="",
            code="NTC 2018",
            quantity="",
            limit_state="",
            scope="",
            alternative="",
            reason="",
        )
    decided = governing(rules)
    if not decided:
        return
    codes = LocalMechanism.model_construct(
        checks=rules, confidence_factor=1.2, behaviour_factor=2.0, bound=None, violated=[], participating_part=part or 1.0, walls=None
    )
    tilt = Tilt.model_construct(collapse_acceleration_g=multiplier, collapse_acceleration_opposite_g=multiplier, fracture=None)
    (margin, name), least = decided[0], multiplier / 0.2
    found = concluded(
        [row_of_margin("tilt", least), row_of_margin("code-checks", margin)],
        {"tilt": Result("tilt", results=tilt), "code-checks": Result("local-mechanism", results=codes)},
    )
    told = {reason.rule: reason for reason in found.reasons}
    check, by_multiplier = rules[name], ("NTC linear", "NTC activation")
    starts = [
        c.capacity / c.demand
        for n, c in rules.items()
        if n.startswith(by_multiplier) and c.code == check.code and c.verdict in ("holds", "fails")
    ]
    if "code-check" in told:
        numbers = told["code-check"].numbers
        assert not name.startswith(by_multiplier)
        assert (numbers["governing_margin"], numbers["demand"], numbers["capacity"]) == (margin, check.demand, check.capacity)
        assert numbers["other_margin"] == (starts[0] if starts else decided[1][0])
        turns = (numbers["other_margin"] > 1.0) != (margin > 1.0)  # a check that turns no verdict explains none that differ
        assert turns or found.agreement["tilt"]["code-checks"] != "disagree"
    elif found.agreement["tilt"]["code-checks"] == "disagree" and not name.startswith(by_multiplier) and (starts or decided[1:]):
        assert ((starts[0] if starts else decided[1][0]) > 1.0) == (margin > 1.0)
    if "code-factors" in told:
        numbers = told["code-factors"].numbers
        factor = numbers["factor"] / numbers["participating_part"]
        assert abs(numbers["code_capacity"] / (numbers["static_capacity"] * factor) - 1.0) < 0.03
        assert ("e* =" in told["code-factors"].text) == (abs(numbers["participating_part"] - 1.0) > 0.005)
    elif part is not None and name == "NTC linear" and found.agreement["tilt"]["code-checks"] != "agree":
        assert abs(check.capacity / multiplier - 1.0) < 0.05
