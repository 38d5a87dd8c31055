"""What rocks in two coordinates, two stacked blocks or a block on a compliant base, on contacts from where a joint slides or parts as a
whole."""

from collections.abc import Callable

from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import demand_of, of_pair
from extrados.analyses.rocking.hand_over import Contacts, Left, contacts_of, follow_contacts, outcome_of, stored
from extrados.analyses.rocking.shapes import on_contacts
from extrados.analyses.rocking.tables import Rocking
from extrados.core.rocking import OUTCOMES, JointDemand
from extrados.results import rocking as out
from extrados.results.model import Result
from extrados.views.rockers.rocker import Rocker

#: The analysis of the mechanism alone
Before = Callable[[Context, Rocking], Result]


def run(context: Context, options: Rocking, before: Before, settle: float) -> Result:
    """What `before` finds with its conditions; where one fails, the rest of the motion on contacts. settle: time units in which it rocks
    itself to rest after the motion."""
    rocker = context.building.rocker(options.form == "linear", soft_base=True)
    ground = context.motion.ground
    end = options.end_time or context.motion.end + settle * rocker.time_unit
    demand = demand_of(rocker, ground, end, options.tolerance).joints
    contacts = contacts_of(rocker, context.building, tolerance=options.tolerance) if options.hand_over else None
    left = None if contacts is None else contacts.leaving.leave(ground, end, 1.0)
    if contacts is not None and left is not None and left.time is not None:
        try:
            return _handed(context, options, rocker, demand, contacts, left, left.time, before)
        except (Refused, Unfinished) as error:
            context.warnings.append(f"The run with {contacts.name}, from {left.time:.3f} s on, gave no result: {error}")
    result = before(context, options)
    conditions = of_pair(rocker, demand, handed=False)
    result.results = result.of(out.Rocking).model_copy(update={"conditions": conditions})
    result.warnings += [text for text in conditions.violated if text not in result.warnings]
    return result


def _handed(
    context: Context, options: Rocking, rocker: Rocker, demand: JointDemand, contacts: Contacts, left: Left, time: float, before: Before
) -> Result:
    """The blocks until a time [s], then contacts. Refused or Unfinished where contacts have no result."""
    begin = contacts.begin(context.motion.ground, time)
    run, further = follow_contacts(context, contacts, begin, options.end_time, options.output_step)
    result = before(context, options.model_copy(update={"end_time": max(time, 1e-9 * rocker.time_unit)}))
    conditions = of_pair(rocker, demand, handed=True)
    outcome = outcome_of(left.rocks, run.outcome)
    over = out.HandOver(
        time_s=time, reason=conditions.violated[0], outcome=outcome, fixed_hinges_outcome=OUTCOMES[left.outcome], contacts=run
    )
    result.results = result.of(out.Rocking).model_copy(
        update={
            "conditions": conditions,
            "hand_over": over,
            "outcome": outcome,
            "settled": not run.still_moving,
            "collapse_time_s": run.collapse_time_s,
            "decided_by_last_digits": run.decided_by_last_digits,
            "perturbation_growth": run.perturbation_growth or 0.0,
            "violated": list(run.violated),
        }
    )
    if further.status != "ok":
        result.status, result.reason = further.status, f"{contacts.name}: {further.reason}"
    told = [
        *conditions.violated,
        *run.violated,
        f"From {time:.3f} s on, the motion of the blocks is calculated with {contacts.name}.",
        *further.warnings,
    ]
    result.warnings = list(dict.fromkeys(told))
    result.arrays |= stored(further)
    result.arrays |= on_contacts(context.building.blocks(), result)
    result.answer = (
        f"By {contacts.name}: {further.answer} {('Rocking' if left.rocks else 'The rest')} without sliding lasts until {time:.3f} s. "
        f"From then on, the motion of the blocks is calculated with {contacts.name}. {over.reason}"
    )
    return result
