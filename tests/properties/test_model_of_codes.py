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


@QUICK
@given(checks(), BOUNDS, st.lists(st.just("It slides."), max_size=1), st.sampled_from(["NTC", "NZSEE", "EN1998"]), st.none() | FACTORS)
def test_a_conclusion_names_what_governs(rules: dict, bound: str | None, violated: list, jurisdiction: str, dilatant: float | None) -> None:
    """The first sentence of a report has margin, check and state of the check that governs; zeta_E and %NBS are margins; dilatant friction leaves a
    check that fails without it open."""
    states = {"NTC 2018": "SLV", "ASCE 41": "LS"}
    rules = {n: c.model_copy(update={"limit_state": states.get(c.code, ""), "source": f"clause of {n}"}) for n, c in rules.items()}
    found = Checked.model_construct(
        checks=rules, confidence_factor=1.35, bound=bound, violated=violated, jurisdiction=jurisdiction, code="", margin_associated=dilatant
    )
    decided, verdict, more = governing(rules), found.overall(), found.concluded()
    assert more["clause"] == (rules[decided[0][1]].source if decided else "")
    at_slv = [margin for margin, name in decided if rules[name].limit_state == "SLV"]
    assert more.get("zeta_E") == (min(at_slv, default=None) if jurisdiction == "NTC" else None)
    assert more.get("nbs_percent") == (100.0 * decided[0][0] if decided and jurisdiction == "NZSEE" else None)
    if decided and decided[0][0] <= 1.0 and dilatant is not None and bound != "lower":
        assert verdict.outcome == ("open" if dilatant >= 1.0 else "collapses")
    told = Checked.model_construct(**{**vars(found), "zeta_E": more.get("zeta_E"), "nbs_percent": more.get("nbs_percent")}).conclusion()
    if not decided or verdict.outcome not in ("stands", "collapses"):
        assert told == verdict.statement
        return
    margin, name = decided[0]
    word = "satisfies" if margin > 1.0 else "does not satisfy"
    assert f" {word} {rules[name].code}" in told and f"safety factor {margin:.3g} by {name}" in told
    assert (f"zeta_E {min(at_slv, default=0.0):.3g}" in told) == (jurisdiction == "NTC" and bool(at_slv))
    assert (f"{100.0 * margin:.0f} %NBS" in told) == (jurisdiction == "NZSEE")


@QUICK
@given(checks(), st.sampled_from(["NTC", "none"]))
def test_rules_beyond_their_scope_are_named(rules: dict[str, Check], jurisdiction: str) -> None:
    """Where no rule of a code applies the verdict names each of them with its reason, and no formula for comparison; without a code it names none."""
    barred = {
        name: check.model_copy(update={"verdict": "not-applicable", "reason": f"the reason of {name}"}) if check.code else check
        for name, check in rules.items()
    }
    found = Checked.model_construct(checks=barred, confidence_factor=1.35, bound=None, violated=[], jurisdiction=jurisdiction).overall()
    assert found.outcome == "not-applicable" and (found.demand, found.capacity) == (None, None)
    for name, check in barred.items():
        assert (f"{check.code}, {name}: {check.reason}" in found.statement) == (bool(check.code) and jurisdiction != "none")
        assert check.code or f", {name}: " not in found.statement


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
