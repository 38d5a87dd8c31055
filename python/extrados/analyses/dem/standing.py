"""Whether limit analysis, and springs where contacts are rigid, agree with elements on what stands under its own weight."""

from collections.abc import Callable

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import settlement, solid_settlement
from extrados.analyses.dem.model import Falls, Model, checked
from extrados.analyses.dem.runs import Runs, SolidRuns, SolidTask, Task
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.limit.common import loads_of
from extrados.building.building import Building
from extrados.building.errors import WHOLE
from extrados.building.geometry.solids.assembly import SolidAssembly
from extrados.core import dem, dem3
from extrados.core.calls import interruptible
from extrados.limit.answer import why_not
from extrados.limit.equilibrium import Disconnected
from extrados.limit.errors import NoAnswer
from extrados.limit.programme import LimitAnalysis
from extrados.limit.solids import SolidLimit
from extrados.results.model import Result

WEDGED = (
    "limit analysis does not find that it must fall: friction may hold a stone that is wedged in, by forces that elements "
    "begin without"
)
JAMMED = (
    "it stands on rigid contacts by forces that its weight does not call up, as friction holds a stone that is wedged in; "
    "on springs, which begin without such forces,"
)
#: Steps of springs in which cases/solid/dem-cross-vault comes to rest, 14 times over
SETTLING = 20_000
#: Walls of more joints are not held against other methods, which would take as long as the elements.
MOST_JOINTS = 3000
#: Nor are more solids.
MOST_SOLIDS = 300


def compared(context: Context, rigid: bool, model: Model | SolidModel, find: Callable[[], Result]) -> Result:
    """What elements find, with what other methods say of their standing under the own weight; Refused where they fall."""
    alone, doubt, warning = left_out(model), "", ""
    against = against_limit_analysis if isinstance(model, Model) else solids_against_limit_analysis
    try:
        with interruptible():  # Ctrl-C between two runs stops the next one
            if rigid and not alone:  # first: Ctrl-C here loses nothing
                doubt, warning = jammed(model, context.threads)
            result = find()
    except Falls as error:
        told = alone or against(context.building, stands=False)
        raise Refused(f"{error}; {told}" if told else str(error), WHOLE) from None
    if doubt and result.status == "ok":
        result.answer += f" {doubt}"
    told = alone or against(context.building, stands=True)
    result.warnings += [text for text in (warning, told) if text]
    return result


def left_out(model: Model | SolidModel) -> str:
    """That no other method was asked whether it stands; empty where there is little enough to ask of."""
    if isinstance(model, Model):
        count, most, what = len(model.assembly.a), MOST_JOINTS, "joints"
    else:
        count, most, what = model.count, MOST_SOLIDS, "solids"
    if count <= most:
        return ""
    return f"whether it stands was asked of no other method: it has {count} {what}, and they are asked of up to {most}"


def jammed(model: Model | SolidModel, threads: int) -> tuple[str, str]:
    """A sentence for the answer, and a warning, on a building that stands on rigid contacts and falls as it settles on its
    springs; empty where it stands on them, too.

    Rigid contacts take any forces that hold; springs, which begin without force, find those that the weight calls up. A
    stone of slight taper sinks farther than springs give until it sits: it may go as far as on rigid contacts.
    """
    brief = {"end_time": 1e-6, "output_step": 1e-6}  # it ends as it has settled
    both = (False, True)
    if isinstance(model, Model):
        far = max(settlement.farthest_settlement(model, rigid=rigid) for rigid in both)
        options = dem.Options(settlement=far, settle_steps=SETTLING, **brief)
        found: dem.Run | dem3.Run = Runs([model.bodies()], [Task(0, options)]).one(0, threads)
    else:
        far = max(solid_settlement.farthest_settlement(model, rigid) for rigid in both)
        in_space = dem3.Options(settlement=far, settle_steps=SETTLING, **brief)
        found = SolidRuns(model.bodies(), [SolidTask(in_space)]).one(0, threads)
    try:
        checked(found, model)
    except Falls:
        if found.settling_steps >= SETTLING:
            return (
                "",
                f"on springs it does not come to rest in {SETTLING} steps: whether it stands by jamming alone is not known",
            )
        answer = "That it stands as it begins may be by jamming alone: settled on springs it falls."
        return answer, f"{JAMMED} {model.body_names[found.blamed[0]]} falls"
    return "", ""


def against_limit_analysis(building: Building, stands: bool) -> str:
    """What is to be said of elements that found that a building stands, or that it falls; empty where limit analysis
    finds that it stands too, or has no answer."""
    try:
        limit = LimitAnalysis(building.blocks(), building.friction(), loads=loads_of(building.blocks(), None, building))
        admissible = limit.stands()
        reason = "" if admissible else why_not(limit)
    except (NoAnswer, Disconnected, Refused):
        return ""
    if admissible:
        return "" if stands else WEDGED
    if not stands:
        return f"limit analysis agrees: {reason}"
    return f"elements stand {_held(building, None)}, but limit analysis finds that it cannot stand under its own weight: {reason}"


def _held(building: Building, assembly: SolidAssembly | None) -> str:
    """By what a building stands that limit analysis finds to fall."""
    for name in ("cohesion", "tension"):
        if np.nanmax(building.joint_property(name, assembly), initial=0.0) > 0.0:
            return "by the cohesion and tension of its joints, which limit analysis leaves out"
    return "for no reason known"


def solids_against_limit_analysis(building: Building, stands: bool) -> str:
    """The same of blocks in space."""
    assembly = building.solids()
    try:
        found = SolidLimit(assembly, building.friction(assembly)).falls()
    except NoAnswer:
        return ""
    if found is None:
        return "" if stands else WEDGED
    name = assembly.block_names[int(np.linalg.norm(found.motion[:, :3], axis=1).argmax())]
    reason = f"a motion, fastest at {name}, that no contact hinders and by which the weights do work"
    if not stands:
        return f"limit analysis agrees: {reason}"
    return f"elements stand {_held(building, assembly)}, but limit analysis finds that it cannot stand under its own weight: {reason}"
