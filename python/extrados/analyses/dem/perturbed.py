"""Whether a run is chaotic: one further run, under the motion times 1 + 1e-6, which takes as long as the run itself."""

from collections.abc import Callable
from typing import Any

from extrados.analyses.batches import Unfinished
from extrados.analyses.chaos import NUDGE, growth, violated_by_chaos
from extrados.analyses.context import Context
from extrados.analyses.dem import measures
from extrados.analyses.dem.job import Runs, SolidRuns, answered
from extrados.core import dem, dem3
from extrados.results.model import Result

#: Factor on what moves the building
FACTOR = 1.0 + NUDGE


def chaos_of(outcome: str, other: str, grown: float) -> dict[str, Any]:
    """Results on chaos, by both outcomes and the growth of the perturbation (see analyses.chaos)."""
    turns = NUDGE if (outcome == "collapse") != (other == "collapse") else 0.0
    violated = violated_by_chaos(
        grown, turns, "the displacement of a block", "the one that counts as collapse", "repeat it under other factors on the motion"
    )
    return {"decided_by_last_digits": bool(violated), "perturbation_growth": grown, "perturbed_outcome": other, "violated": violated}


def probe_chaos(
    context: Context,
    job: Runs | SolidRuns | None,
    idle: bool,
    found: dem.Run | dem3.Run,
    count: int,
    collapse: measures.Collapse,
    outcome_of: Callable[[Any], str],
    result: Result,
    name: str = "dem-perturbed",
) -> dict[str, Any]:
    """Results on chaos of a run of `count` bodies. job: the run under the motion times FACTOR, None where it is not wanted; idle:
    nothing moves the building; outcome_of: of a run; name: of what is kept of it. An interruption is told in `result`."""
    if idle:
        return chaos_of(outcome_of(found), outcome_of(found), 0.0)
    unknown: dict[str, Any] = {"decided_by_last_digits": False, "perturbation_growth": None, "perturbed_outcome": None, "violated": []}
    if job is None or result.status != "ok":
        return unknown
    try:
        (other,) = answered(context, name, job, "perturbed motion")
    except Unfinished as error:
        result.status = "interrupted" if error.interrupted else "failed"
        result.reason = f"under the perturbed motion: {error}; the run before it is complete"
        return unknown
    grown = growth([measures.shares(one, count, collapse.displacement) for one in (found, other)])
    return chaos_of(outcome_of(found), outcome_of(other), grown)
