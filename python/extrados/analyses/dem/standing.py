"""Whether limit analysis, and springs where contacts are rigid, agree with elements on what stands under its own weight."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import settlement, solid_settlement
from extrados.analyses.dem.job import Runs, SolidRuns, SolidTask, Task
from extrados.analyses.dem.model import Falls, Model, Restless, checked
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import IN_PLANE, IN_SPACE
from extrados.analyses.limit.common import loads_of
from extrados.core import dem, dem3, dem_run
from extrados.core.calls import interruptible
from extrados.limit.answer import cannot_stand
from extrados.limit.crushing import CrushingLimit
from extrados.limit.equilibrium import Disconnected
from extrados.limit.errors import CannotStand, NoAnswer
from extrados.limit.programme import LimitAnalysis
from extrados.limit.solids import SolidLimit
from extrados.model.errors import WHOLE
from extrados.model.geometry.water import Pressure
from extrados.results.model import Result
from extrados.results.verdict import loads_at_rest
from extrados.views.building import Building

WEDGED = (
    "limit analysis does not prove collapse: friction may hold a wedged block by forces that discrete elements do not have at the start"
)
JAMMED = (
    "with rigid contacts the structure is in equilibrium, but perhaps only by forces that self-weight alone does not produce (a block "
    "wedged by friction). Springs start without such forces, and with springs"
)
#: Steps of springs in which cases/solid/dem-cross-vault comes to rest, 14 times over
SETTLING = 20_000
#: Of the size: in that check a stone that sinks farther falls. A keystone sinks by .1 % with a taper of 1 %, by .25 % with .5 %
SEATED = 1e-2
#: s: a run that ends as it has settled
BRIEF = 1e-6
#: Walls of more joints are not held against other methods, which would take as long as the elements.
MOST_JOINTS = 3000
#: Nor are more solids.
MOST_SOLIDS = 300


def compared(context: Context, rigid: bool, model: Model | SolidModel, find: Callable[[], Result]) -> Result:
    """What elements find, with what other methods find under the own weight. Where the elements collapse: CannotStand where
    limit analysis of the same blocks proves it, else Refused."""
    alone, doubt, warning = left_out(model), "", ""
    of_kind = proof_of_section if isinstance(model, Model) else proof_of_solids
    proof_of: Callable[[Building], CannotStand | None] = partial(of_kind, strength=model.strength or None, water=model.water)
    try:
        with interruptible():  # Ctrl-C between two runs stops the next one
            if rigid and not alone:  # first: Ctrl-C here loses nothing
                doubt, warning = jammed(model, context.threads)
            result = find()
    except (Falls, Restless) as error:
        if alone:
            raise Refused(f"{error}; {alone}", WHOLE) from None
        try:
            proof = proof_of(context.building)
        except NoAnswer:
            raise Refused(str(error), WHOLE) from None
        if proof is not None:
            raise CannotStand(f"{proof}; discrete elements: {error}", proof.motion, proof.neglects, model.other_loads) from None
        wedged = f"; {WEDGED}" if isinstance(error, Falls) else ""
        raise Refused(f"{error}{wedged}", WHOLE) from None
    if doubt and result.status == "ok":
        result.answer += f" {doubt}"
    result.warnings += [text for text in (warning, alone or _contradiction(context.building, proof_of, model)) if text]
    return result


def _contradiction(building: Building, proof_of: Callable[[Building], CannotStand | None], model: Model | SolidModel) -> str:
    """That limit analysis proves collapse where elements stand; empty where it does not."""
    try:
        proof = proof_of(building)
    except NoAnswer:
        return ""
    if proof is None:
        return ""
    return (
        f"with discrete elements the structure stands {_held(building, isinstance(model, SolidModel))}, but limit analysis finds collapse "
        f"under {loads_at_rest(model.other_loads)}: {proof}"
    )


def left_out(model: Model | SolidModel) -> str:
    """That no other method was asked whether it stands; empty where there is little enough to ask of."""
    if isinstance(model, Model):
        count, most, what = len(model.assembly.a), MOST_JOINTS, "joints"
    else:
        count, most, what = model.count, MOST_SOLIDS, "solids"
    if count <= most:
        return ""
    return f"no second method checked whether the structure stands under {loads_at_rest(model.other_loads)}: such a check accepts at most {most} {what}, and the structure has {count}"


def jammed(model: Model | SolidModel, threads: int) -> tuple[str, str]:
    """A sentence for the answer, and a warning, on a building that stands on rigid contacts and falls as it settles on its
    springs; empty where it stands on them, too.

    Rigid contacts take any forces that hold; springs, which begin without force, find those that the weight calls up. A
    stone of slight taper sinks by the compression of its sides over the taper until it sits.
    """
    if isinstance(model, Model):
        far = max(settlement.farthest_settlement(model), SEATED * model.size)
        options = dem.Options(settlement=far, fraction=IN_PLANE, settle_steps=SETTLING, end_time=BRIEF, output_step=BRIEF)
        found: dem_run.FoundRun = Runs([model.bodies()], [Task(0, options)]).one(0, threads)
    else:
        far = max(solid_settlement.farthest_settlement(model), SEATED * model.size)
        in_space = dem3.Options(settlement=far, fraction=IN_SPACE, settle_steps=SETTLING, end_time=BRIEF, output_step=BRIEF)
        found = SolidRuns(model.bodies(), [SolidTask(in_space)]).one(0, threads)
    try:
        checked(found, model)
    except Restless:
        return ("", f"a check with springs did not come to rest in {SETTLING} steps, so the equilibrium found may depend on jammed blocks")
    except Falls:
        answer = "The initial equilibrium may depend on jammed blocks: with springs, the structure collapses while it settles."
        return answer, f"{JAMMED} {model.body_names[found.blamed[0]]} falls"
    return "", ""


def proof_of_section(building: Building, strength: float | None = None, water: Pressure | None = None) -> CannotStand | None:
    """The proof by limit analysis that a section collapses under its own weight; None where an admissible state was found.
    NoAnswer where neither was found. strength: at which joints crush [Pa]; water: its pressure, as constant loads."""
    try:
        loads = loads_of(building.blocks(), None, building)
        if water is not None:
            loads = replace(loads, dead=loads.dead + water.about_origin(len(loads.dead)))
        limit = LimitAnalysis(building.blocks(), building.friction(), strength=strength, loads=loads)
        return None if limit.stands() else cannot_stand(limit)
    except (Disconnected, Refused) as error:
        raise NoAnswer(str(error)) from None


def proof_of_solids(building: Building, strength: float | None = None, water: Pressure | None = None) -> CannotStand | None:
    """The same of blocks in space; None where no motion proves collapse."""
    assembly = building.solids()
    friction = building.friction(assembly)
    resting = None
    if water is not None:
        load = water.on_solids(assembly.centroid)
        arm = load[:, 1:]
        resting = np.concatenate([load[:, 0], np.stack([arm[:, i, j] - arm[:, j, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)], axis=1)
    found = (
        SolidLimit(assembly, friction, resting=resting)
        if strength is None
        else CrushingLimit(assembly, friction, np.full(len(assembly.a), strength), resting=resting)
    ).falls()
    if found is None:
        return None
    name = assembly.block_names[int(np.linalg.norm(found.motion[:, :3], axis=1).argmax())]
    return CannotStand(
        f"{name} cannot be in equilibrium; certificate: a mechanism, fastest at {name}, in which no "
        f"contact resists and the weights{' and the water pressure' if water is not None else ''} do positive work"
    )


def _held(building: Building, solid: bool) -> str:
    """By what a building stands that limit analysis finds to collapse."""
    assembly = building.solids() if solid else None
    for name in ("cohesion", "tension"):
        if np.nanmax(building.joint_property(name, assembly), initial=0.0) > 0.0:
            return "because of the cohesion and tension of the joints, which limit analysis neglects"
    return "for no known reason"
