"""assess: every strategy that applies to a building under one hazard, cheap first, compared, with reasons."""

import numpy as np

from extrados import kinds
from extrados.analyses.assess import budget, hazard, strategies
from extrados.analyses.assess.advice import size_interventions
from extrados.analyses.assess.asking import no_row, scaled_margin
from extrados.analyses.assess.budget import Interrupted
from extrados.analyses.assess.closer import refine
from extrados.analyses.assess.conclusion import conclude
from extrados.analyses.assess.finer import check_finer
from extrados.analyses.assess.longer import prolong
from extrados.analyses.assess.reasons_of_statics import static_peak
from extrados.analyses.assess.tables import Assess
from extrados.analyses.assess.turning import move_values
from extrados.analyses.assess.words import table_of
from extrados.analyses.assess.work import Work
from extrados.analyses.context import Context
from extrados.results.model import Result
from extrados.results.statistics import OverLevels


def run(context: Context, options: Assess) -> Result:
    """The table of verdicts, their agreement, the reasons, and one overall statement; its parts are analyses of the run."""
    work = Work(context, options)
    result = Result("assess")
    try:
        ask_cheap(work)
        context.tell(f"First results:\n{table_of(list(work.rows.values()))}")
        work.further("additional runs that the results of the fast strategies require", lambda: look_early(work))
        ask_costly(work)
        work.further("longer runs", lambda: prolong(work))
        if options.advise and not work.advised:
            work.further("strengthening", lambda: advise(work))
        work.further("additional runs for strategies that differ", lambda: refine(work))
        work.further("finer checks of contradictions", lambda: check_finer(work))
        if options.moves:
            work.asker.deadline = budget.STOPPED_AFTER * options.budget
            work.further("sensitivity", lambda: move_values(work))
    except Interrupted:
        result.status, result.reason = "interrupted", "the assessment was interrupted; only the complete strategies are reported"
    conclude(work, result)
    return result


def ask_cheap(work: Work) -> None:
    """What takes seconds at most; of a set first its motions, which choose the one that single runs take."""
    if work.many:
        _scaled_set(work)
    for name in ("tilt", "rocking", "assessment", "code-checks"):
        if work.wants(name):
            work.ask(strategies.of(name))
            if name == "rocking" and "rocking" in work.results and not work.many:
                _scaled(work)
    work.context.progress(1.0, 3.0, "assess")


def look_early(work: Work) -> None:
    """Whatever the cheap strategies already call for, in seconds, before costly ones use up the budget: the least interventions, and the
    shortest constant push of the reason `static-peak`."""
    if work.options.advise:
        advise(work)
    facts = work.facts()
    static_peak(facts, facts.pairs())


def ask_costly(work: Work) -> None:
    """Strategies that take longer, each until the deadline."""
    for name in ("probability", "frame", "sla", "push-x", "push-y", "dem"):
        if not work.wants(name) or name in work.rows:
            continue
        if name == "probability" and "rocking" in work.rows and work.rows["rocking"].status == "refused":
            text = "this strategy counts collapses by rocking, but this building does not rock as a single mechanism"
            work.rows[name] = no_row(strategies.of(name), "left out", text)
        else:
            work.ask(strategies.of(name))
    work.context.progress(2.0, 3.0, "assess")


def _scaled(work: Work) -> None:
    """The factor on the one motion at which rocking brings it down: the margin of `rocking`."""
    found = work.ask(strategies.SCALED)
    row = work.rows.pop("scaled")
    if row.outcome == "cannot-stand":
        work.parts.pop()
        work.decks.pop()
        return
    if found is not None:  # a curve of one motion is none: its factors stand at the row of rocking
        work.parts.pop()
        work.decks.pop()
    if found is None:
        work.context.warnings.append(f"the critical scale factor by rocking is not known: {row.reason}")
        return
    curve = found.of(OverLevels)
    low, high = scaled_margin(curve)
    words = f"{work.rows['rocking'].parameters}; critical scale factor from {row.parameters}"
    if high is None and low != curve.levels[-1]:
        words += (
            ". At the next greater scale factor, blocks slide or hinges form outside the assumed mechanism. "
            "Rocking then gives only a lower bound of the scale factor that causes collapse"
        )
    work.rows["rocking"] = work.rows["rocking"].model_copy(update={"parameters": words})
    outcome = work.rows["rocking"].outcome  # the run under the hazard itself is a factor of 1, on contacts where blocks slide
    if high is None and outcome == "collapses":
        high = 1.0
    elif high is None and outcome == "stands":
        low = max(low or 0.0, 1.0)
    work.bracket("rocking", low, high)
    if curve.resurrections:
        work.context.warnings.append(
            "At some scale factors above the least one that causes collapse, the rocking structure recovers. "
            "Do not rely on these safe regions."
        )


def _scaled_set(work: Work) -> None:
    """The share of a set that brings it down, and the motion that strategies of one motion take."""
    found = row = None
    if strategies.SCALED.applies(work.context.building):
        found = work.ask(strategies.SCALED)
        row = work.rows.pop("scaled")
    member, how = 1, "the first motion, because the structure does not rock and rocking cannot select one"
    if row is not None and row.status == "ok":
        strategy = strategies.of("probability")
        work.rows["probability"] = row.model_copy(
            update={"strategy": "probability", "label": strategy.label, "axis": strategy.axis, "assumes": strategy.assumes}
        )
        work.parts[-1] = ("probability", *work.parts[-1][1:])
    if found is not None:
        work.results["probability"] = work.results.pop("scaled")
        member = _governing(found)
        how = f"the motion that causes a greater rotation than {100 * hazard.GOVERNING:g} % of the other motions of the set"
    work.chosen = {"member": member, "chosen_by": how}
    work.asker.motion = {**work.asker.motion, "member": member}
    if not isinstance(work.context.deck.motion, kinds.table("motion", "compatible")):
        work.peak, _ = hazard.peak_of(work.one_motion())
        work.peak_told = f"the greatest horizontal acceleration of motion {member}"


def advise(work: Work) -> None:
    """The least interventions, where the building does not stand under all strategies."""
    facts = work.facts()
    if all(facts.outcome(n) == "stands" for n in facts.judged()) or work.rows.get("tilt") is None:
        return
    work.advised = True
    found = size_interventions(work.asker, work.peak, "rocking" in work.results)
    if isinstance(found, str):
        work.not_done.append(f"strengthening: {found}")
    else:
        work.advice = found


def _governing(found: Result) -> int:
    """Which motion of a set, from 1, leaves so many with a smaller rotation; those that bring it down count as farthest."""
    table = found.tables["ensemble"].columns
    at_one = np.isclose(np.asarray(table["level"], dtype=float), 1.0)
    motion = np.asarray(table["motion"])[at_one]
    outcome = np.asarray(table["outcome"])[at_one]
    ratio = np.asarray(table["peak_ratio"], dtype=float)[at_one]
    ratio = np.where(outcome == "collapse", np.inf, np.where(np.isnan(ratio), -np.inf, ratio))
    order = np.argsort(ratio, kind="stable")
    return int(motion[order[min(len(order) - 1, int(np.ceil(hazard.GOVERNING * len(order))) - 1)]])
