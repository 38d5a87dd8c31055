"""rocking: a block, or the four-hinge arch, under a ground motion (thesis 5.2, Eqs 5.1-5.3, B.1-B.3)."""

from extrados.analyses.context import Context
from extrados.analyses.rocking import arch as arch_rocking
from extrados.analyses.rocking import block as block_rocking
from extrados.analyses.rocking import mechanism as mechanism_rocking
from extrados.analyses.rocking import pair_contacts
from extrados.analyses.rocking import soft_base as soft_base_rocking
from extrados.analyses.rocking import stack as stack_rocking
from extrados.analyses.rocking.common import with_moving_supports
from extrados.analyses.rocking.shapes import film_arrays, on_contacts
from extrados.analyses.rocking.tables import Rocking
from extrados.results import rocking as out
from extrados.results.model import Result
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.mechanism import MechanismModel
from extrados.views.rockers.stack import rocks_as_stack


def run(context: Context, options: Rocking) -> Result:
    """History, impacts, energies, friction needed; of an arch the dynamic thrust line too."""
    context = with_moving_supports(context)
    if rocks_as_stack(context.building):
        return _with_friction(context, pair_contacts.run(context, options, stack_rocking.run, stack_rocking.SETTLE))
    if context.building.supports.stiffness is not None:
        return _with_friction(context, pair_contacts.run(context, options, soft_base_rocking.run, soft_base_rocking.SETTLE))
    rocker = context.building.rocker(options.form == "linear")
    kinds = {BlockModel: block_rocking.run, MechanismModel: mechanism_rocking.run, ArchModel: arch_rocking.run}
    result = next(run for kind, run in kinds.items() if isinstance(rocker.model, kind))(context, options, rocker)
    if options.animation != "none":
        result.arrays |= film_arrays(rocker, result)
    if result.of(out.Rocking).hand_over is not None:
        result.arrays |= on_contacts(context.building.blocks(), result)
        for line in ("snapshot_thrust", "film_line"):  # of the mechanism
            result.arrays.pop(line, None)
    return _with_friction(context, result)


def _with_friction(context: Context, result: Result) -> Result:
    """The result; where its joints were not watched, with the condition that does not hold if they lack friction."""
    r, given = result.of(out.Rocking), context.building.joints.coefficient
    watched = r.conditions is not None and "friction" in r.conditions
    if watched or given is None or r.required_friction is None or r.required_friction <= given:
        return result
    told = (
        f"Friction {given:.2f} is below the {r.required_friction:.2f} that rocking requires: blocks slide. Use dem, or check the friction."
    )
    result.results = r.model_copy(update={"violated": [*r.violated, told]})
    result.warnings.append(told)
    return result
