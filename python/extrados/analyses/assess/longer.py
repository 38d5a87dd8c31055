"""Longer runs, where a run ended while the structure still moved."""

from dataclasses import replace

import numpy as np

from extrados.analyses.assess import strategies
from extrados.analyses.assess.asking import row_of
from extrados.analyses.assess.budget import OutOfTime
from extrados.analyses.assess.work import Work
from extrados.analyses.context import Refused
from extrados.results.dem import DemRun
from extrados.results.model import Result
from extrados.results.rocking import Rocking as RockingResults

#: Runs that follow, each twice as long, where a structure still moves at the end
PROLONGED = 2


def prolong(work: Work) -> None:
    """Run anew, twice as long each time, strategies whose run ended while the structure still moved."""
    for name in ("rocking", "dem"):
        for _ in range(PROLONGED):
            end = _end_of_motion(work.results.get(name))
            if end is None or not _run_until(work, name, 2.0 * end):
                break


def _run_until(work: Work, name: str, end: float) -> bool:
    """Replace the run of a strategy by one until `end` [s]; False if the longer run has no result, and the former stays."""
    choice, place = work.choices[name], [s for s, _, _ in work.parts].index(name)
    former = work.rows[name]
    words = f"{former.parameters}; the run was extended to {end:.3g} s, because the structure still moved at {0.5 * end:.3g} s"
    keys = choice.keys | {"end_time": round(end, 3)}
    without = work.bare.get(name, ())
    strategy = strategies.of(name)
    try:
        result, deck = work.asker.ask(choice.kind or strategy.kind, keys, None, None, without)
    except (OutOfTime, Refused) as error:
        told = str(error) or f"stopped at the time limit of {work.options.for_strategies:g} s"
        work.not_done.append(f"{strategy.label} until {end:.3g} s: {told}")
        return False
    if result.status != "ok":
        work.not_done.append(f"{strategy.label} until {end:.3g} s: {result.reason}")
        return False
    words = words.removeprefix("; ")
    row = row_of(
        strategy,
        result,
        words,
        work.asker.demand(work.peak),
        work.options.acceptable_probability,
        work.context.building.supports.abutting_wall,
        without,
    )
    kept = {"margin_at_least": former.margin_at_least, "margin_below": former.margin_below}
    work.rows[name] = row.model_copy(update=kept if name == "rocking" else {})
    work.choices[name] = replace(choice, keys=keys, words=words, seconds=2.0 * choice.seconds)
    work.results[name], work.decks[place] = result, deck
    work.parts[place] = (name, f"{strategy.label}: {words}", result)
    return True


def _end_of_motion(result: Result | None) -> float | None:
    """End [s] of a run in which the structure still moved; None for others."""
    if result is None:
        return None
    r = result.results
    if isinstance(r, DemRun):
        return r.stop_time_s if r.still_moving else None
    if not isinstance(r, RockingResults) or r.outcome == "collapse":
        return None
    if r.hand_over is not None:
        contacts = r.hand_over.contacts
        return contacts.stop_time_s if contacts.still_moving else None
    return None if r.settled else float(np.asarray(result.arrays["time"].data)[-1])
