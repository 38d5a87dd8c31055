"""What an assessment says: the table of verdicts as text, and one overall statement."""

from extrados.analyses.assess.facts import Facts, Pair
from extrados.results.assess import Overall, Reason, StrategyVerdict, TurningValue
from extrados.results.verdict import Outcome, outcome_words

_HEAD = ("strategy", "verdict", "demand", "capacity", "unit", "margin")


def _cells(row: StrategyVerdict) -> tuple[str, ...]:
    if row.status != "ok":
        return row.label, row.status, "", "", "", ""

    def number(value: float | None) -> str:
        return "" if value is None else f"{value:.3g}"

    return row.label, row.verdict_words, number(row.demand), number(row.capacity), row.unit, row.margin_told()


def table_of(rows: list[StrategyVerdict]) -> str:
    """The verdicts as lines of equal columns."""
    cells = [_HEAD, *(_cells(row) for row in rows)]
    widths = [max(len(c[i]) for c in cells) for i in range(len(_HEAD))]
    return "\n".join("  " + "  ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)).rstrip() for line in cells)


def answer(statement: str, rows: list[StrategyVerdict], reasons: list[Reason], moved: list[TurningValue]) -> str:
    """All that is told on the terminal: the statement, the table, the reasons, where verdicts turn."""
    return "\n".join([statement, table_of(rows), *(f"- {one.text}" for one in reasons), *turning(moved)])


def turning(moved: list[TurningValue]) -> list[str]:
    """Where the verdicts turn, a line for each value that turns one."""
    said = []
    for one in moved:
        unit = f" {one.unit}" if one.unit else ""
        told = [
            f"{label} at {value:.3g}{unit}"
            for label, value in (("limit analysis", one.tilt_turns), ("rocking", one.rocking_turns), ("discrete elements", one.dem_turns))
            if value is not None
        ]
        if told:
            said.append(f"- {one.key} ({one.base:.3g}{unit} here) would change the verdict of {' and of '.join(told)}.")
    return said


def conclusion(
    facts: Facts, reasons: list[Reason], unexplained: list[Pair], word: str, least: tuple, rows: list[StrategyVerdict]
) -> tuple[Overall, str]:
    """The overall answer, and its statement: which strategies say what, why they differ, and the least margin."""
    groups: dict[str, list[str]] = {}
    for name in facts.judged():
        groups.setdefault(facts.outcome(name), []).append(name)
    stands, collapses, left, proven = (groups.get(o, []) for o in ("stands", "collapses", "open", "cannot-stand"))

    def labels(names: list[str]) -> str:
        return list_labels([facts.rows[n].label for n in names])

    def verdict(names: list[str], outcome: Outcome, under: bool = False) -> str:
        """Of the building by strategies that analyse it, of the checks of codes as such."""
        checks = [n for n in names if facts.rows[n].axis == "check"]
        others = [facts.rows[n].label for n in names if n not in checks]
        told = [f"{outcome} {f'under {_count(others)}' if under else f'by {list_labels(others)}'}"] if others else []
        if others:
            told[0] = f"the {word} {told[0]}"
        if checks:
            told.append(f"the check by {labels(checks)} is {outcome_words(outcome, True)}")
        return " and ".join(told)

    said: list[str] = []
    overall: Overall
    if proven:
        overall = "cannot stand"
        first = next(facts.rows[n] for n in facts.judged() if facts.outcome(n) == "cannot-stand")
        said.append(f"The {word} cannot stand: {first.label} proves that it collapses under self-weight.")
        if others := proven[1:]:
            said.append(f"{labels(others)} gives the same conclusion by the same certificate. This certificate counts only once.")
        said.append(first.statement)
        if stands:
            said.append(f"This certificate leaves no doubt, so the opposite result of {labels(stands)} is not considered.")
    elif not stands and not collapses and not left:
        overall = "open"
        said.append(f"No strategy has a verdict on the {word} under this hazard.")
    elif not collapses and not left:
        overall = "stands under all"
        said.append(f"{_upper(verdict(stands, 'stands', True))}.")
    elif not stands and not left:
        overall = "collapses under all"
        said.append(f"{_upper(verdict(collapses, 'collapses', True))}.")
    elif stands and collapses:
        overall = "depends"
        said.append(f"The strategies disagree: {verdict(collapses, 'collapses')}; {verdict(stands, 'stands')}.")
    else:
        overall = "open"
        if stands or collapses:
            said.append(f"{_upper(verdict(stands or collapses, 'stands' if stands else 'collapses'))}.")
    if left:
        said.append(f"The outcome according to {labels(left)} is open.")
    decisive = [one for one in reasons if any(facts.relation(*p) in ("disagree", "open") for p in one.explains)]
    if decisive:
        said.append(f"The difference comes from {list_labels(list(dict.fromkeys(one.headline for one in decisive)))}.")
    bare = [p for p in unexplained if facts.relation(*p) == "disagree"]
    if bare:
        told = "; ".join(f"{facts.rows[a].label} and {facts.rows[b].label}" for a, b in bare)
        said.append(f"Unexplained differences: {told}.")
    if least[0] is not None and not proven:
        label = facts.rows[least[1]].label
        row = next(r for r in rows if r.strategy == least[1])
        said.append(f"The least critical scale factor of the hazard is {row.margin_told()}, by {label}.")
    none = [row.label for row in rows if row.status != "ok"]
    if none:
        said.append(f"No result from {list_labels(none)}.")
    idle = [row for row in rows if row.status == "ok" and row.outcome == "not-applicable"]
    said += [f"No verdict from {row.label}: {row.statement}" for row in idle if row.capacity is None]
    if able := [f"{row.label} {_capacity(row)}" for row in idle if row.capacity is not None]:
        said.append(f"Capacity without a verdict: {list_labels(able)}.")
    return overall, " ".join(s for s in said if s)


def _capacity(row: StrategyVerdict) -> str:
    bound = {"upper": "at most ", "lower": "at least "}.get(row.bound or "", "")
    value, unit = (row.capacity or 0.0, row.unit)
    return f"{bound}{value / 1e3:.3g} kN" if unit == "N" else f"{bound}{value:.3g} {unit}"


def _upper(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"


def _count(words: list[str]) -> str:
    if len(words) == 1:
        return f"the one strategy that has a verdict, {words[0]}"
    return f"all {len(words)} strategies that have a verdict"


def list_labels(words: list[str]) -> str:
    """Words with commas, and `and` before the last."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
