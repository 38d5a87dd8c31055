"""The result of an assessment: rows, agreement, reasons, overall statement, arrays and decks of the parts."""

from typing import Any

import numpy as np

from extrados.analyses.assess import hazard
from extrados.analyses.assess.budget import Interrupted
from extrados.analyses.assess.facts import Facts
from extrados.analyses.assess.model_uncertainty import estimate_collapse
from extrados.analyses.assess.reasons import explained
from extrados.analyses.assess.turning import rows_of
from extrados.analyses.assess.words import answer, conclusion
from extrados.analyses.assess.work import Work
from extrados.results import assess as out
from extrados.results.fields import given
from extrados.results.model import Array, Result, TableData
from extrados.results.store import group_names


def conclude(work: Work, result: Result) -> None:
    """Rows, agreement, reasons, overall statement, arrays and files into `result`."""
    facts = work.facts()
    try:
        reasons, unexplained = explained(facts, lambda rule, error: work.note_failure(f"reason {rule}", error))
    except Interrupted:
        reasons, unexplained = [], facts.pairs()
    there = [a.kind for a in work.context.deck.analyses]
    names = group_names(there + [r.kind for _, _, r in work.parts])[len(there) :]
    rows = []
    for row in work.rows.values():
        part = next((n for n, (s, _, _) in zip(names, work.parts, strict=True) if s == row.strategy), None)
        rows.append(row.model_copy(update={"part": part}))
    judged = facts.judged()
    agreement = {a: {b: facts.relation(a, b) for b in judged if b != a} for a in judged}
    # a strategy by which the building stands, although its factor is not known from below 1 on, has no least factor
    margins = [
        (low if row.margin is None else row.margin, row.strategy)
        for row in rows
        if row.outcome != "not-applicable"
        if (
            (low := row.margin_at_least if row.outcome == "stands" else row.margin_below) is not None
            and (row.outcome != "stands" or low >= 1.0)
        )
        or row.margin is not None
    ]
    least = min(margins, default=(None, None), key=lambda m: m[0] if m[0] is not None else np.inf)
    overall, statement = conclusion(facts, reasons, unexplained, work.context.building.require_structure().word, least, rows)
    fragility = work.results.get("probability")
    chance = estimate_collapse(rows, None if fragility is None else fragility.results)
    if work.finer_told:
        statement += f" {work.finer_told}"
    if overall != "cannot stand":
        statement += f" {chance.statement}"
    impulse = hazard.primary(facts.motion)
    model = work.context.deck.require_motion()
    found = out.Assess(
        overall=overall,
        statement=statement,
        hazard=out.AssessHazard(
            kind=model.kind,
            told=_hazard_told(work, facts.motion),
            motions=work.motions,
            **work.chosen,
            peak_ground_acceleration_g=work.peak,
            peak_told=work.peak_told,
            pulse_amplitude_g=impulse and impulse[0],
            pulse_period_s=impulse and impulse[1],
        ),
        verdicts=rows,
        agreement=agreement,
        collapse_probability=chance,
        reasons=reasons,
        unexplained=[list(p) for p in unexplained],
        parts=dict(zip(names, (words for _, words, _ in work.parts), strict=True)),
        probes=work.probes,
        **given(sensitivity=rows_of(work) if work.moved or work.shaken else None, advice=work.advice),
        not_done=work.not_done,
        least_margin=least[0],
        least_margin_strategy=least[1],
        budget_s=work.options.budget,
    )
    result.results = found
    result.parts = [r for _, _, r in work.parts]
    for name, deck in zip(names, work.decks, strict=True):
        head = f"# {name}: one part of an assessment of {work.context.deck.path}; run it in the folder of that deck.\n"
        result.files[f"assess/{name}.toml"] = (head + deck).encode(errors="replace")  # names of files may be no text
    result.files |= work.faults
    _arrays(work, facts, rows, result)
    result.answer = answer(statement, rows, reasons, found.sensitivity or [])
    if work.advice is not None:
        result.answer += f"\nStrengthening. {work.advice.statement}"
    result.warnings += [f"{row.label}: {row.status}: {row.reason}" for row in rows if row.status in ("failed", "left out")]


def _hazard_told(work: Work, motion: Any) -> str:
    name = work.context.deck.require_motion().kind
    if work.many:
        return (
            f"{work.motions} motions of kind {name}; strategies with a single motion use motion {work.chosen['member']}, "
            f"{work.chosen['chosen_by']}"
        )
    return f"{motion.name or name}, {motion.end:.3g} s"


def _arrays(work: Work, facts: Facts, rows: list[out.StrategyVerdict], result: Result) -> None:
    low, high = np.array([facts.interval(r.strategy) for r in rows]).reshape(-1, 2).T
    result.arrays = {
        "margin_low": Array(
            low, ("strategy",), "", "for each strategy: greatest scale factor of the hazard that is known to cause no collapse"
        ),
        "margin_high": Array(
            np.where(np.isinf(high), np.nan, high),
            ("strategy",),
            "",
            "for each strategy: least scale factor of the hazard that is known to cause collapse; NaN: not known",
        ),
    }
    time_s, ground = facts.motion.series()
    thin = slice(None, None, max(1, len(time_s) // 4000))
    result.arrays |= {"time": Array(time_s[thin], ("time",), "s"), "ground": Array(ground[thin], ("time",), "m/s^2", "the motion")}
    if work.moved:
        flat = [(m.what.key, value, *margins) for m in work.moved for value, margins in m.tried]
        names = ("key", "value", "margin_tilt", "margin_rocking")
        result.tables["sensitivity"] = TableData({n: [np.nan if row[k] is None else row[k] for row in flat] for k, n in enumerate(names)})
    columns = (
        "strategy",
        "part",
        "status",
        "axis",
        "demand",
        "capacity",
        "unit",
        "outcome",
        "margin",
        "margin_at_least",
        "margin_below",
        "parameters",
        "statement",
        "reason",
    )
    result.tables["assess"] = TableData(
        {c: [("" if c in ("part",) else np.nan) if row[c] is None else row[c] for row in rows] for c in columns}
    )
