"""sla: sequentially linear analysis of a wall or of stones (thesis 4.2, 4.3)."""

from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.codes.verification import with_design_strengths
from extrados.analyses.context import Context
from extrados.analyses.limit.common import loads_of
from extrados.analyses.limit.self_weight import open_at_rest
from extrados.analyses.sla.bar_forces import bar_arrays
from extrados.analyses.sla.contact import NotCarried
from extrados.analyses.sla.events import Curve, run_curves
from extrados.analyses.sla.measured import arrays, compare, read_measured
from extrados.analyses.sla.measures import joint_openings, numbers_of, out_of_reach, tooth_counts
from extrados.analyses.sla.model import SlaModel, build, strength_factors
from extrados.analyses.sla.repetitions import repeat
from extrados.analyses.sla.resume import carry_on, makeup, start_of
from extrados.analyses.sla.stages import run_stages
from extrados.analyses.sla.stored import curve_arrays, field_files, mesh_arrays, sections
from extrados.analyses.sla.tables import Sla
from extrados.analyses.sla.verified import verify_wall
from extrados.analyses.sla.words import answer_of_stones, answer_of_wall
from extrados.core.calls import interruptible
from extrados.limit.answer import cannot_stand
from extrados.limit.equilibrium import Disconnected
from extrados.limit.programme import LimitAnalysis, NoAnswer
from extrados.results import sla as out
from extrados.results.model import Result
from extrados.results.sla import PREFIXES
from extrados.schema.quantities import engineering
from extrados.views.building import Building

#: States that an animation shows
FILM = 80
#: Joints up to which limit analysis takes little beside the elements
MOST_JOINTS = 3000


def run(context: Context, options: Sla) -> Result:
    """All curves: both senses of the load, and the repetitions with other seeds."""
    if options.animation != "none" and options.solution != "incremental" and not options.states:
        options = options.model_copy(update={"states": _film_events(options.events)})
    with interruptible():  # Ctrl-C between two batches too only ends the events: what was found is kept
        return _run(context, options)


def _film_events(events: int) -> list[int]:
    """Events whose states an animation shows: each at first, ever fewer later, as cracks grow."""
    return np.unique(np.geomspace(1.0, max(events, 1), FILM).astype(int)).tolist()


def _run(context: Context, options: Sla) -> Result:
    verified = options.by_inertia and not context.building.meshed_by_stones
    if verified:
        context = with_design_strengths(context, options.verification)
    mesh = context.building.mesh(options.mesh)
    measured = read_measured(context, options.measured) if options.measured is not None else None
    result = Result("sla")
    model = build(mesh, options, strength_factors(mesh, options, options.strength_seed))
    context.warnings += mesh.warnings
    if any(len({part.ratio for part in load.parts}) > 1 for load in options.reference or []):
        context.warnings.append(
            "The parts of the imposed displacement move by different ratios. The load is therefore the work "
            "of all parts divided by the displacement, not the sum of their forces."
        )
    damage, earlier = start_of(context, options, model)

    def chain(of: Any) -> Chain:
        mesh_of = [model.mesh.xy, [group.connect for group in model.mesh.groups], model.constant, model.reference]
        return Chain(context, "sla", [options, of, damage, model.freedoms, *mesh_of])

    stones = context.building.meshed_by_stones
    if stones and _dry(context.building):
        certify(context.building, model)
    try:
        if options.stages:
            curves = run_stages(model, options, context.threads, context.progress, chain)
        else:
            curves = run_curves(model, options, context.threads, context.progress, damage, chain)
    except NotCarried as error:
        if stones:
            certify(context.building, model)
        return open_at_rest("sla", str(error))  # a run of events proves no collapse
    if options.stages:
        main = curves[min(options.main, len(curves) - 1)]
        model = replace(model, unit=main.unit, acceleration=main.acceleration, control=main.control or model.control)
        numbers = _describe(result, model, options, [main], stones)
        numbers["stages"] = _stages(result, model, options, curves, main)
    else:
        main = curves[0]
        for curve in curves:
            carry_on(curve, earlier, model.unit)
        numbers = _describe(result, model, options, curves, stones)
    if verified and not curves[-1].events.interrupted:
        if (found := verify_wall(context, result, model, options, curves)) is not None:
            numbers["verification"] = found
    if measured is not None:
        numbers["measured"] = compare(measured, *main.envelope(model.unit))
        result.arrays |= arrays(measured)
    if options.seeds and not curves[-1].events.interrupted:
        numbers |= repeat(context, options, result)
    result.results = out.Sla(**numbers)
    if any(c.events.interrupted for c in curves):
        again = "; --resume continues from them" if context.checkpoint is not None else ""
        result.status, result.reason = "interrupted", f"interrupted; the events up to then are saved{again}"
    return result


def _dry(building: Building) -> bool:
    """Whether limit analysis knows all that holds the joints of a building, and these are few enough to ask it beforehand."""
    strengths = [float(np.nanmax(building.joint_property(name), initial=0.0)) for name in ("cohesion", "tension")]
    return not any(strengths) and len(building.blocks().a) <= MOST_JOINTS


def certify(building: Building, model: SlaModel) -> None:
    """CannotStand where limit analysis of the same blocks holds a certificate that they collapse under the constant loads."""
    if not np.any(model.constant):
        return
    assembly = building.blocks()
    try:
        loads = replace(loads_of(assembly, None, building), dead=resultants(model, len(assembly.mass)))
        limit = LimitAnalysis(assembly, building.friction(), loads=loads)
        if not limit.stands():
            raise cannot_stand(limit)
    except (NoAnswer, Disconnected):
        return


def resultants(model: SlaModel, stones: int) -> np.ndarray:
    """Resultants of the constant loads on each stone (stones, 3): force x, force y [N] and moment about the origin [N m]."""
    of, (x, y), (fx, fy) = model.mesh.stone, model.mesh.xy.T, model.constant[:, :2].T
    assert of is not None
    found = np.zeros((stones, 3))
    on = of >= 0
    np.add.at(found, of[on], np.column_stack([fx, fy, x * fy - y * fx])[on])
    return found


def _stages(result: Result, model: SlaModel, options: Sla, curves: list[Curve], main: Curve) -> list[dict[str, Any]]:
    """Numbers of all stages; arrays, tables, files and warnings of those that do not stand for the analysis."""
    found = []
    for k, curve in enumerate(curves, 1):
        own = replace(model, unit=curve.unit, acceleration=curve.acceleration, control=curve.control or model.control)
        prefix = "" if curve is main else f"stage_{k}_"
        if prefix:
            curve_arrays(result, own, curve, prefix)
            bar_arrays(result, own, curve, prefix)
            field_files(result, own, [curve], [prefix])
            result.warnings += curve.warnings
        last = len(curve.events) - 1
        found.append(
            numbers_of(own, options.model_copy(update={"probes": []}), curve)
            | {
                "name": curve.name,
                "prefix": prefix,
                "start_load_N": curve.already,
                "end_load_N": float(curve.force(own.unit)[last]) if last >= 0 else None,
            }
        )
    if options.stages[options.main :] and main.name != options.stage_names[options.main]:
        result.warnings.append(f"the reported results are those of stage {main.name}, because it is the last stage that began")
    ends = "; ".join(
        f"{stage['name']} at {stage['end_load_N'] / 1e3:.4g} kN ({stage['stop']})" for stage in found if stage["end_load_N"] is not None
    )
    if ends:
        result.answer = f"End of each stage: {ends}. Stage {main.name}: {result.answer}"
    return found


def _describe(result: Result, model: SlaModel, options: Sla, curves: list[Curve], stones: bool) -> dict[str, Any]:
    """Arrays, tables, files and words of all curves into `result`; their numbers."""
    first = curves[0]
    numbers = {
        **numbers_of(model, options, first),
        "reference_load_N": model.unit,
        "cracking": options.cracking,
        "teeth": tooth_counts(model),
        "nodes": len(model.mesh.xy),
        "elements": model.mesh.elements(),
        "equations": first.equations,
        "points": first.points,
        "makeup": makeup(model),
        "stones": stones,
    }
    for curve in curves[1:]:
        numbers["minus"] = numbers_of(model, options, curve)
    for curve in curves:
        result.warnings += curve.warnings
        events, sense = curve.events, f" (load to {curve.sense})"
        if curve.peak >= 0 and not events.interrupted and not curve.passed(model.unit):
            result.warnings.append(
                f"the run{sense} ended before the load decreased ({events.reason or 'number of events'}). The greatest value, "
                f"{engineering(curve.force(model.unit)[curve.peak], 'N')}, is therefore not a capacity"
            )
        if far := out_of_reach(curve):
            result.warnings.append(far)
        if len(events) and events.load[0] < 0.0 and not curve.name:
            result.warnings.append(
                f"the first event{sense} has a negative load, {engineering(events.load[0] * model.unit, 'N')}, because the "
                "constant loads alone exceed the strength at some point"
            )
    result.arrays = mesh_arrays(model)
    for curve, prefix in zip(curves, PREFIXES, strict=False):
        curve_arrays(result, model, curve, prefix)
        bar_arrays(result, model, curve, prefix)
    sections(result, model, options, first)
    field_files(result, model, curves, PREFIXES)
    if model.mesh.has_joints:
        numbers["hinges"] = joint_openings(result, model, first)
        result.answer = answer_of_stones(numbers, len(curves) > 1, model.slides)
    else:
        result.answer = answer_of_wall(numbers, len(curves) > 1, "event" if options.solution == "events" else "step")
    return numbers
