"""The first page of a report: conclusion, governing mechanism, demand against capacity, confidence, and what to do next."""

import re
from typing import Any

from extrados import kinds
from extrados.results.assess import Assess
from extrados.results.codes import Checked, LocalMechanism
from extrados.results.store import Stored
from extrados.results.strengthen import Strengthen, size_told
from extrados.results.verdict import OUTCOMES
from extrados.show.document import Block, Figure, Table, Words
from extrados.show.language import Language
from extrados.show.verification import COLUMNS, WIDTHS, rows_of

Figures = list[tuple[str, str]]
#: Ends of the names of figures that show a mechanism
MECHANISMS = ("-collapse", "-mechanism")
#: Within the names of figures that show the walls of a frame with their damage, the weakest direction first
WALLS = "-walls-"
#: Kinds of analysis in words
TITLES = {
    "tilt": "Collapse acceleration by limit analysis",
    "thrust": "Thrust lines",
    "thrust-network": "Thrust network",
    "sweep": "Variation of one value",
    "survey": "Survey of sections",
    "imperfections": "Uncertainty of the survey",
    "supports": "Moving supports",
    "moving-load": "Moving load",
    "rocking": "Rocking under the motion",
    "failure-domain": "Failure domain of a pulse",
    "failure-curves": "Failure curves of sines",
    "assessment": "Assessment by primary impulses",
    "fragility": "Fragility",
    "resonance": "Resonance",
    "rocking-spectrum": "Rocking spectrum",
    "harmonic-map": "Map of harmonic motions",
    "code-checks": "Checks of codes",
    "local-mechanism": "Local mechanism by codes",
    "motion": "Ground motion",
    "shake-table": "Shake table",
    "sla": "Sequentially linear analysis",
    "pushover": "Pushover",
    "dem": "Discrete elements",
    "dem-domain": "Failure domain of discrete elements",
    "dem-fragility": "Fragility by discrete elements",
    "assess": "Comparison of the strategies",
    "strengthen": "Strengthening",
    "dem-parameters": "Parameters of discrete elements",
    "frame-modes": "Modes of the frame",
    "frame-pushover": "Pushover of the frame",
    "frame-history": "Response of the frame to the motion",
    "frame-fragility": "Fragility of the frame",
    "modes": "Natural frequencies",
}
#: A safety factor below this is thin
THIN = 1.5
#: Analyses that the table of the first page lists
MOST = 8


def opening(run: Stored, drawn: dict[str, Figures], building: Figures, words: Language) -> list[Block]:
    """Blocks of the first page; empty where no analysis has a verdict."""
    lead = leading(run)
    if lead is None:
        return []
    grave = lead["verdict"]["outcome"] in ("collapses", "cannot-stand")
    found: list[Block] = [Words(_conclusion(run, lead, words), "bad" if grave else "answer")]
    found.append(_comparison(run, lead, words))
    if (picture := governing_figure(run, drawn, building)) is not None:
        found.append(picture)
    found.append(Words(f"{words('Confidence.')} {_confidence(run, lead, words)}"))
    found.append(Words(f"{words('Next step.')} {_next_step(run, lead, words)}{_strengthening(run, lead, words)}"))
    return found


def leading(run: Stored) -> dict[str, Any] | None:
    """The analysis by which the report concludes: an assessment, else the gravest verdict, of these the least ratio, then one
    with a capacity; None without any."""
    judged = [a for a in run.analyses if a["verdict"]]
    whole = [a for a in judged if a["kind"] == "assess"]
    order = list(OUTCOMES)

    def gravity(a: dict[str, Any]) -> tuple[int, float, bool]:
        v = a["verdict"]
        return order.index(v["outcome"]), float("inf") if v["ratio"] is None else v["ratio"], v["capacity"] is None

    return min(whole or judged, key=gravity, default=None)


def governing_figure(run: Stored, drawn: dict[str, Figures], building: Figures) -> Figure | None:
    """The picture of the governing mechanism: of the strategy of least margin, of limit analysis, else of the building."""
    lead = leading(run)
    if lead is None:
        return None
    r, names = run[lead["name"]], [lead["name"]]
    if isinstance(r, Assess):
        names = [v.part for v in r.verdicts if v.part is not None and v.strategy == r.least_margin_strategy]
        names += [a["name"] for a in run.analyses if a["kind"] == "tilt"]
    if isinstance(r, LocalMechanism) and r.mechanism == "building":
        names += [a["name"] for a in run.analyses if a["kind"] == "tilt"]
    every = [f for name in names for f in drawn.get(name, [])]
    shows = [f for f in every if f[0].endswith(MECHANISMS)] + [f for f in every if WALLS in f[0]]
    chosen = next(iter(shows or every or building), None)
    # The scale of the building's drawing holds at its full width.
    return None if chosen is None else Figure(f"figures/{chosen[0]}", chosen[1], 1.0 if chosen in building else 0.8)


#: Sentences of an assessment on the first page: with a probability under the motion itself, and without
DYNAMIC = ("The least critical scale factor", "Probability of collapse")
STATIC = (*DYNAMIC, "If the peak of the hazard", "This static number")


def _conclusion(run: Stored, lead: dict[str, Any], words: Language) -> str:
    """In English the sentences of the analysis; in another language the same numbers in sentences of the report."""
    r, v = run[lead["name"]], lead["verdict"]
    if words.code != "en":
        said = [words("Outcome: {outcome}.", outcome=words(OUTCOMES[v["outcome"]]))]
        said.append(words("Governing analysis: {name}.", name=title_of(words, lead["name"], lead["kind"])))
        if v["ratio"] is not None:
            said.append(words("Safety factor: {factor}.", factor=words.number(v["ratio"])))
        return " ".join(said)
    if isinstance(r, Checked):
        return r.conclusion()
    first, *rest = re.split(r"(?<=\.) (?=[A-Z])", str(v["statement"]))
    # the strategies one by one and their reasons follow in the table and behind the contents
    if not isinstance(r, Assess):
        return " ".join([words("Outcome: {outcome}.", outcome=OUTCOMES[v["outcome"]]), first, *rest])
    # a static probability beside a dynamic one would be read as that of the earthquake
    kept = STATIC if r.collapse_probability.in_motion is None else DYNAMIC
    return " ".join([first, *(one for one in rest if one.startswith(kept))])


def title_of(words: Language, name: str, kind: str) -> str:
    """An analysis by its kind in words, with its number where there are several: "moving-load-2" is the second."""
    number = name.removeprefix(kind).removeprefix("-")
    return f"{words(TITLES.get(kind, kind))}{f' {number}' if number.isdigit() else ''}"


def _comparison(run: Stored, lead: dict[str, Any], words: Language) -> Table:
    """Demand, capacity and safety factor; of an assessment a row for each strategy."""
    r, v = run[lead["name"]], lead["verdict"]

    def number(value: float | None, unit: str) -> str:
        if value is None:
            return ""
        return words.quantity(value, unit)

    if isinstance(r, Assess):
        rows = [
            (
                s.label,
                words(s.verdict_words if s.status == "ok" else s.status),
                number(s.demand, s.unit),
                number(s.capacity, s.unit),
                s.margin_told(""),
            )
            for s in r.verdicts
        ]
        return Table(tuple(map(words, ("strategy", "verdict", "demand", "capacity", "margin"))), rows, (2.4, 1.2, 1.2, 1.2, 1.2))
    verified = getattr(r, "verification", None)
    if verified is not None and verified.checks:
        return Table(tuple(map(words, COLUMNS)), rows_of(verified), WIDTHS)
    judged = [a for a in run.analyses if a["verdict"]]
    if len(judged) > 1 and not isinstance(r, Checked):
        rows = [
            (
                title_of(words, a["name"], a["kind"]),
                words(OUTCOMES[w["outcome"]]),
                number(w["demand"], w["unit"]),
                number(w["capacity"], w["unit"]),
                number(w["ratio"], ""),
            )
            for a in [lead, *(a for a in judged if a is not lead)][:MOST]
            for w in [a["verdict"]]
        ]
        return Table(tuple(map(words, ("analysis", "verdict", "demand", "capacity", "safety factor"))), rows, (2.6, 1.3, 1.2, 1.2, 1.2))
    head: tuple[str, ...] = tuple(map(words, ("demand", "capacity", "safety factor")))
    row: tuple[str, ...] = (number(v["demand"], v["unit"]), number(v["capacity"], v["unit"]), number(v["ratio"], ""))
    if isinstance(r, Checked) and r.clause:
        head, row = (*head, words("clause")), (*row, r.clause)
    if isinstance(r, Checked) and r.checks:
        stated = {c.words for c in r.checks.values() if c.code and c.verdict != "not-applicable"}
        head, row = (*head, words("limit state")), (*row, ", ".join(sorted(stated)))
    return Table(head, [row], (1.0, 1.0, 1.0, 3.0, 2.0)[: len(head)])


def _confidence(run: Stored, lead: dict[str, Any], words: Language) -> str:
    r, v = run[lead["name"]], lead["verdict"]
    said = []
    if isinstance(r, Assess):
        judged = [s for s in r.verdicts if s.status == "ok" and s.outcome != "not-applicable"]
        groups: dict[str, int] = {}
        for s in judged:
            groups[s.verdict_words] = groups.get(s.verdict_words, 0) + 1
        told = ", ".join(f"{n} {words(word)}" for word, n in groups.items()) or words("none")
        said.append(words("{judged} of {all} strategies have a verdict: {groups}.", judged=len(judged), all=len(r.verdicts), groups=told))
        said.append(
            words("Unexplained differences between strategies: {count}.", count=len(r.unexplained))
            if r.unexplained
            else words("Every difference between strategies has a stated reason.")
        )
        if r.not_done:
            said.append(words("Steps not done: {count}.", count=len(r.not_done)))
    if isinstance(r, Checked):
        if r.confidence_factor is not None:
            said.append(words("Confidence factor {factor}.", factor=words.number(r.confidence_factor)))
        if r.by_default:
            said.append(words("The deck names no code; the report applies {code}.", code=r.code))
        if "verify clause" in (r.clause or ""):
            said.append(words("The clause was not verified against the standard. Compare it with the standard before use."))
        open_parts = [a["name"] for a in run.analyses if isinstance(run[a["name"]], Checked) and a["verdict"]["ratio"] is None]
        if open_parts:
            said.append(words("These parts have no check with a verdict: {parts}.", parts=", ".join(open_parts)))
    verified = getattr(r, "verification", None)
    if verified is not None:
        if verified.confidence_factor is not None:
            factor = f"{verified.confidence_factor:.3g}"
            said.append(words("Strengths are divided by the confidence factor {factor}.", factor=factor))
        if verified.by_default:
            said.append(words("The deck names no code; the report applies {code}.", code=verified.code))
        clauses = {c.clause for c in verified.checks}
        said.append(words("Clauses: {clauses}.", clauses="; ".join(sorted(clauses))))
        if any("verify clause" in clause for clause in clauses):
            said.append(words("Marked clauses were not verified against the standard. Compare them with the standard before use."))
    if v["bound"] in ("upper", "lower"):
        said.append(words(f"The capacity is {'an upper' if v['bound'] == 'upper' else 'a lower'} bound."))
    if v["violated"]:
        said.append(f"{words('Assumptions that do not hold: {count}.', count=len(v['violated']))}{_first(words, v['violated'])}")
    warnings = sum(len(a["warnings"]) for a in run.analyses)
    if warnings:
        said.append(words("Warnings in this report: {count}.", count=warnings))
    return " ".join(said) or words("No checked assumption is violated.")


def _next_step(run: Stored, lead: dict[str, Any], words: Language) -> str:
    r, v = run[lead["name"]], lead["verdict"]
    outcome, factor = v["outcome"], v["ratio"]
    if outcome == "cannot-stand":
        return words(
            "Check the geometry, the density and the supports of the deck. If they are right, prop the structure before anything else."
        )
    if outcome == "collapses":
        sized = (
            words("To size the intervention, add an analysis of kind `strengthen` to the deck.")
            if "strengthen" in kinds.ANALYSES
            else (words("Add ties, thickness or a buttress to the deck, and run it again."))
        )
        grown = words("The capacity must grow by a factor of {factor}.", factor=words.number(1.0 / factor)) + " " if factor else ""
        return f"{grown}{sized}"
    if outcome == "open":
        if v["violated"]:
            if words.code != "en":
                return words("Resolve the first violated assumption.")
            return f"Resolve the first violated assumption: {v['violated'][0]}"
        if isinstance(r, Assess) and r.not_done:
            return words(
                "A step has no verdict: {step}. Run again with a larger `budget`, or with a later end of the run.", step=r.not_done[0]
            )
        return words(
            "Compare the reasons below. Then refine the data that decide the difference: first measure friction, thickness and restraints."
        )
    if outcome == "stands":
        if factor is not None and factor < THIN:
            return words(
                "The safety factor of {factor} is close to 1. Check its sensitivity to thickness, friction and strength.",
                factor=words.number(factor),
            )
        return words(
            "This result requires no intervention. It covers the stated mechanism and hazard only: check the other parts of the building too."
        )
    if isinstance(r, Strengthen):
        return words(
            "Check the anchorage, assess the strengthened building by all strategies, and check the "
            "mechanism that governs after strengthening."
        )
    if isinstance(r, Checked) and any(c.verdict == "" for c in r.checks.values()):
        return words("Give the seismic action of the site in [code].")
    return (
        words("No implemented rule covers this element. Use limit analysis and rocking dynamics (kind assess).")
        if isinstance(r, Checked)
        else words(
            "The report gives a capacity without a demand. Give a demand in the deck (action of the site, "
            "motion or load), and run the deck again."
        )
    )


def _strengthening(run: Stored, lead: dict[str, Any], words: Language) -> str:
    """The interventions of an assessment with their least sizes; nothing without advice."""
    r = run[lead["name"]]
    if not isinstance(r, Assess) or r.advice is None:
        return ""
    met = [one for one in r.advice.interventions if one.meets_target]
    if not met:
        return " " + words(
            "None of the interventions considered enables the building to carry the peak acceleration of the "
            "hazard as a constant horizontal acceleration."
        )
    told = "; ".join(f"{one.name}, {size_told(one)}" for one in met)
    text = words(
        "Strengthening for the peak acceleration of the hazard, applied as a constant horizontal acceleration: {interventions}.",
        interventions=told,
    )
    least = r.advice.by_rocking
    if least is not None and least.required_N is not None:
        force = words.quantity(least.required_N, "N")
        text += " " + words("To prevent collapse by rocking under this motion, the first of these ties requires {force}.", force=force)
    return f" {text}"


def _first(words: Language, violated: list[str]) -> str:
    return f" The first: {violated[0]}" if words.code == "en" else ""
