"""The first page of a report: conclusion, governing mechanism, demand against capacity, confidence, and what to do next."""

import re
from typing import Any

from extrados import kinds
from extrados.results.assess import Assess
from extrados.results.codes import Checked, LocalMechanism
from extrados.results.store import Stored
from extrados.results.strengthen import Strengthen
from extrados.results.verdict import OUTCOMES
from extrados.show.document import Block, Figure, Table, Words

Figures = list[tuple[str, str]]
#: Ends of the names of figures that show a mechanism
MECHANISMS = ("-collapse", "-mechanism")
#: A safety factor below this is thin
THIN = 1.5


def opening(run: Stored, drawn: dict[str, Figures], building: tuple[str, str] | None) -> list[Block]:
    """Blocks of the first page; empty where no analysis has a verdict."""
    lead = leading(run)
    if lead is None:
        return []
    found: list[Block] = [
        Words(
            _conclusion(run, lead), "bad" if lead["verdict"]["outcome"] in ("collapses", "cannot-stand") else "answer"
        )
    ]
    found.append(_comparison(run, lead))
    if (picture := governing_figure(run, drawn, building)) is not None:
        found.append(picture)
    found.append(Words(f"Confidence. {_confidence(run, lead)}"))
    found.append(Words(f"Next step. {_next_step(run, lead)}"))
    return found


def leading(run: Stored) -> dict[str, Any] | None:
    """The analysis by which the report concludes: an assessment, else the gravest verdict, of these the least ratio; None without any."""
    judged = [a for a in run.analyses if a["verdict"]]
    whole = [a for a in judged if a["kind"] == "assess"]
    order = list(OUTCOMES)

    def gravity(a: dict[str, Any]) -> tuple[int, float]:
        ratio = a["verdict"]["ratio"]
        return order.index(a["verdict"]["outcome"]), float("inf") if ratio is None else ratio

    return min(whole or judged, key=gravity, default=None)


def governing_figure(run: Stored, drawn: dict[str, Figures], building: tuple[str, str] | None) -> Figure | None:
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
    chosen = next((f for f in every if f[0].endswith(MECHANISMS)), every[0] if every else building)
    return None if chosen is None else Figure(f"figures/{chosen[0]}", chosen[1], 0.7)


def _conclusion(run: Stored, lead: dict[str, Any]) -> str:
    r = run[lead["name"]]
    if isinstance(r, Checked):
        return r.conclusion()
    first, *rest = re.split(r"(?<=\.) (?=[A-Z])", str(lead["verdict"]["statement"]))
    # the strategies one by one and their reasons follow in the table and behind the contents
    least = (
        [one for one in rest if one.startswith(("The least critical scale factor", "Probability of collapse"))]
        if isinstance(r, Assess)
        else rest
    )
    return " ".join([first, *least])


def _comparison(run: Stored, lead: dict[str, Any]) -> Table:
    """Demand, capacity and safety factor; of an assessment a row for each strategy."""
    r, v = run[lead["name"]], lead["verdict"]

    def number(value: float | None, unit: str) -> str:
        if value is None:
            return ""
        return f"{value / 1e3:.3g} kN" if unit == "N" else f"{value:.3g} {unit}".strip()

    if isinstance(r, Assess):
        rows = [
            (s.label, s.verdict_words, number(s.demand, s.unit), number(s.capacity, s.unit), s.margin_told(""))
            for s in r.verdicts
        ]  # fmt: skip
        return Table(("strategy", "verdict", "demand", "capacity", "margin"), rows, (2.4, 1.2, 1.2, 1.2, 1.2))
    head: tuple[str, ...] = ("demand", "capacity", "safety factor")
    row: tuple[str, ...] = (number(v["demand"], v["unit"]), number(v["capacity"], v["unit"]), number(v["ratio"], ""))
    if isinstance(r, Checked) and r.clause:
        head, row = (*head, "clause"), (*row, r.clause)
    return Table(head, [row], (1.0, 1.0, 1.0, 4.0)[: len(head)])


def _confidence(run: Stored, lead: dict[str, Any]) -> str:
    r, v = run[lead["name"]], lead["verdict"]
    said = []
    if isinstance(r, Assess):
        judged = [s for s in r.verdicts if s.status == "ok" and s.outcome != "not-applicable"]
        groups: dict[str, int] = {}
        for s in judged:
            groups[s.verdict_words] = groups.get(s.verdict_words, 0) + 1
        told = ", ".join(f"{n} {word}" for word, n in groups.items()) or "none"
        said.append(f"{len(judged)} of {len(r.verdicts)} strategies have a verdict: {told}.")
        said.append(
            f"Unexplained differences between strategies: {len(r.unexplained)}."
            if r.unexplained
            else "Every difference between strategies has a stated reason."
        )
        if r.not_done:
            said.append(f"Steps not done: {len(r.not_done)}.")
    if isinstance(r, Checked):
        if r.confidence_factor is not None:
            said.append(f"Confidence factor {r.confidence_factor:.3g}.")
        if r.by_default:
            said.append(f"The deck names no code; the report applies {r.code}.")
        if "verify clause" in (r.clause or ""):
            said.append("The clause was not verified against the standard. Compare it before use.")
        open_parts = [
            a["name"] for a in run.analyses if isinstance(run[a["name"]], Checked) and a["verdict"]["ratio"] is None
        ]
        if open_parts:
            said.append(f"No check decides for: {', '.join(open_parts)}.")
    if v["bound"] in ("upper", "lower"):
        said.append(f"The capacity is {'an upper' if v['bound'] == 'upper' else 'a lower'} bound.")
    if v["violated"]:
        said.append(f"Assumptions that do not hold: {len(v['violated'])}; the first: {v['violated'][0]}")
    warnings = sum(len(a["warnings"]) for a in run.analyses)
    if warnings:
        said.append(f"Warnings in this report: {warnings}.")
    return " ".join(said) or "No checked assumption is violated."


def _next_step(run: Stored, lead: dict[str, Any]) -> str:
    r, v = run[lead["name"]], lead["verdict"]
    outcome, factor = v["outcome"], v["ratio"]
    if outcome == "cannot-stand":
        return "Check the geometry, the density and the supports of the deck. If they are right, prop the structure before anything else."
    if outcome == "collapses":
        sized = "Size the intervention with an analysis of kind strengthen." if "strengthen" in kinds.ANALYSES else (
            "Add ties, thickness or a buttress to the deck, and run it again."
        )  # fmt: skip
        grown = f"The capacity must grow by a factor of {1.0 / factor:.3g}. " if factor else ""
        return f"{grown}{sized}"
    if outcome == "open":
        if v["violated"]:
            return f"Resolve the first assumption that does not hold: {v['violated'][0]}"
        if isinstance(r, Assess) and r.not_done:
            return f"Finish the steps that the time limit cut off, with a larger budget: {r.not_done[0]}."
        return "Compare the reasons below, and refine the model that decides: measured friction, thickness and restraints first."
    if outcome == "stands":
        if factor is not None and factor < THIN:
            return f"The safety factor of {factor:.3g} is small. Check its sensitivity to thickness, friction and strength (sensitivity = true)."
        return "This result requires no intervention. It covers the stated mechanism and hazard only: check the other parts of the building too."
    if isinstance(r, Strengthen):
        return "Check the anchorage, assess the strengthened building by all strategies (assess = true), and check the mechanism that governs afterwards."
    if isinstance(r, Checked) and any(c.verdict == "" for c in r.checks.values()):
        return "Give the seismic action of the site in [code]."
    return "No implemented rule covers this element. Use limit analysis and rocking dynamics (kind assess)."
