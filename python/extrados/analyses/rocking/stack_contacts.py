"""Two stacked blocks from where a joint slides or parts as a whole: rigid contacts follow them."""

import numpy as np

from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import of_pair
from extrados.analyses.rocking.hand_over import contacts_of, follow_contacts, outcome_of, stored
from extrados.analyses.rocking.shapes import on_contacts
from extrados.analyses.rocking.stack import SETTLE
from extrados.analyses.rocking.tables import Rocking
from extrados.core.rocking import OUTCOMES, ensemble
from extrados.results import rocking as out
from extrados.results.model import Result


def with_contacts(context: Context, options: Rocking, result: Result) -> Result:
    """The result of `stack.run` with its conditions; where one fails, with the rest of the motion on rigid contacts."""
    r, rocker = result.of(out.Rocking), context.building.rocker(soft_base=True)
    if result.status != "ok":
        return result
    ground, one = context.motion.ground, np.zeros(1, dtype=int)
    end = options.end_time or context.motion.end + SETTLE * rocker.time_unit
    demand = ensemble(
        [rocker.body], [ground], one, one, [1.0], end, start_rotation=rocker.start_rotation, tolerance=options.tolerance, threads=1
    ).joints
    contacts = contacts_of(rocker, context.building, tolerance=options.tolerance) if options.hand_over else None
    left = None if contacts is None else contacts.leaving.leave(ground, end, 1.0)
    if contacts is None or left is None or left.time is None:
        conditions = of_pair(rocker, demand, handed=False)
        result.results = r.model_copy(update={"conditions": conditions})
        result.warnings += [text for text in conditions.violated if text not in result.warnings]
        return result
    conditions = of_pair(rocker, demand, handed=True)
    try:
        run, further = follow_contacts(context, contacts, contacts.begin(ground, left.time), options.end_time, options.output_step)
    except (Refused, Unfinished) as error:
        result.warnings.append(f"Rigid contacts gave no result from {left.time:.3f} s: {error}")
        result.results = r.model_copy(update={"conditions": of_pair(rocker, demand, handed=False)})
        return result
    outcome = outcome_of(left.rocks, run.outcome)
    over = out.HandOver(
        time_s=left.time, reason=conditions.violated[0], outcome=outcome, fixed_hinges_outcome=OUTCOMES[left.outcome], contacts=run
    )
    result.results = r.model_copy(
        update={
            "conditions": conditions,
            "hand_over": over,
            "outcome": outcome,
            "settled": not run.still_moving,
            "collapse_half_cycle": None,
            "collapse_time_s": run.collapse_time_s,
            "decided_by_last_digits": run.decided_by_last_digits,
            "perturbation_growth": run.perturbation_growth or 0.0,
            "violated": list(run.violated),
        }
    )
    if further.status != "ok":
        result.status, result.reason = further.status, f"rigid contacts: {further.reason}"
    kept = [text for text in result.warnings if text not in r.violated]
    told = [*conditions.violated, *run.violated, f"Rigid contacts follow the blocks from {left.time:.3f} s on.", *further.warnings]
    result.warnings = list(dict.fromkeys([*kept, *told]))
    result.arrays |= stored(further)
    result.arrays |= on_contacts(context.building.blocks(), result)
    result.answer = (
        f"By rigid contacts: {further.answer} The blocks {'rock' if left.rocks else 'rest'} without sliding until {left.time:.3f} s, from when on "
        f"contacts follow them. "
        f"{over.reason}"
    )
    return result
