"""Whether a run is chaotic: one further run, under the motion times 1 + 1e-6, which takes as long as the run itself; where the
perturbation has grown, nine more under other factors that no instrument distinguishes."""

from collections.abc import Callable
from typing import Any

import numpy as np

from extrados.analyses.batches import Unfinished
from extrados.analyses.chaos import CHAOTIC, NUDGE, growth, perturbed, turning, violated_by_chaos
from extrados.analyses.context import Context
from extrados.analyses.dem import measures
from extrados.analyses.dem.job import Runs, SolidRuns, answered
from extrados.analyses.dem.seen import BlocksSeen
from extrados.core import dem, dem3
from extrados.results.model import Result

#: Factor on what moves the building
FACTOR = 1.0 + NUDGE
#: Greatest growth of a perturbation in a smooth response (analyses.chaos): beyond it other factors are tried
SMOOTH = 1e3


def chaos_of(other: str, grown: float, turns: float) -> dict[str, Any]:
    """Results on chaos, by the outcome under the motion times FACTOR, the growth of the perturbation and the least one that turns
    the outcome, 0 where none does (see analyses.chaos)."""
    violated = violated_by_chaos(
        grown,
        turns,
        "the displacement of a block",
        "the displacement that counts as collapse",
        "repeat the run with other scale factors of the motion",
    )
    return {"decided_by_last_digits": bool(violated), "perturbation_growth": grown, "perturbed_outcome": other, "violated": violated}


def probe_chaos(
    context: Context,
    job_of: Callable[[float], Runs | SolidRuns] | None,
    idle: bool,
    found: dem.Run | dem3.Run,
    count: int,
    collapse: measures.Collapse,
    look: Callable[[Any], BlocksSeen],
    result: Result,
    name: str = "dem-perturbed",
) -> dict[str, Any]:
    """Results on chaos of a run of `count` bodies. job_of: the run under the motion times a factor, None where it is not wanted;
    idle: no motion or movement acts on the building; look: the reader of a run; name: name under which runs are saved. `result` states an
    interruption."""

    def outcome_of(run: Any) -> str:
        return look(run).fate(collapse).outcome

    if idle:
        return chaos_of(outcome_of(found), 0.0, 0.0)
    unknown: dict[str, Any] = {"decided_by_last_digits": False, "perturbation_growth": None, "perturbed_outcome": None, "violated": []}
    if job_of is None or result.status != "ok":
        return unknown
    outcome, limit = outcome_of(found), collapse.displacement

    def grown(run: Any) -> float:
        # until one of them has collapsed, by the measure of the outcome
        gone = [np.flatnonzero(collapse.reached(*look(one).moved).any(axis=1)) for one in (found, run)]
        until = min((int(one[0]) for one in gone if len(one)), default=len(found.time))
        return growth([measures.shares(one, count, limit) for one in (found, run)], until)

    try:
        (first,) = answered(context, name, job_of(FACTOR), "perturbed motion")
        most, ends = grown(first), {FACTOR: outcome_of(first)}
        turns = NUDGE if turning(outcome, list(ends.values())) else 0.0
        if not turns and SMOOTH < most <= CHAOTIC:
            for k, factor in enumerate(perturbed()):
                if factor != FACTOR:
                    (other,) = answered(context, f"{name}-{k}", job_of(factor), "perturbed motion")
                    ends[factor] = outcome_of(other)
                    most = max(most, grown(other)) if abs(factor - 1.0) < 1.5 * NUDGE else most
            turns = turning(outcome, [ends[factor] for factor in perturbed()])
    except Unfinished as error:
        result.status = "interrupted" if error.interrupted else "failed"
        result.reason = f"the run under the given motion is complete, but the run under the perturbed motion failed: {error}"
        return unknown
    return chaos_of(ends[FACTOR], most, turns)
