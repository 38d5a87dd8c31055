"""pushover: a building of walls and floors, or a vault, under growing horizontal forces (thesis 4.4)."""

from typing import Any

from extrados.analyses.codes.verification import with_design_strengths
from extrados.analyses.context import Context
from extrados.analyses.shell.curves import chains_of, progress_of, push_curves
from extrados.analyses.shell.frame import capacities
from extrados.analyses.shell.measures import numbers_of_push
from extrados.analyses.shell.model import ShellModel, build, first_mode
from extrados.analyses.shell.needs import pier_strength
from extrados.analyses.shell.sections import sections
from extrados.analyses.shell.sliding import sliding_limits
from extrados.analyses.shell.stages import run_stages
from extrados.analyses.shell.stored import store_mesh, store_seats, store_states
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.shell.variants import run_variants
from extrados.analyses.shell.verified import verify_push
from extrados.analyses.shell.words import answer_of_push, remarks_of_curve, warn_unequal_drives
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.stored import events_of_curve
from extrados.core.calls import interruptible
from extrados.core.sla import ShellJoints, Shells
from extrados.model.structures.plan import Plan
from extrados.results import shell as out
from extrados.results.model import Result, TableData
from extrados.results.sla import PREFIXES


def run(context: Context, options: Pushover) -> Result:
    """The curves of all senses, and of the variants."""
    with interruptible():  # Ctrl-C between two batches only ends the events: what was found is kept
        return _run(context, options)


def _run(context: Context, options: Pushover) -> Result:
    result = Result("pushover")
    verified = isinstance(context.building.structure, Plan) and not options.stages and not options.drives
    if verified:
        context = with_design_strengths(context, options.verification)
    model = build(context.building.shell(options.mesh), options)
    context.warnings += model.warnings
    if not any(g.tension is not None for g in model.groups if isinstance(g, Shells | ShellJoints)):
        context.warnings.append(
            "nothing in the structure can crack, because [material] gives no `tensile_strength` or no `fracture_energy`"
        )
    elastic = _elastic(model, options)
    if model.mesh.walls and not sliding_limits(model, context.building, options, elastic["under"]):
        why = "with imposed displacements (`drives`), the shear force at these heights is not known"
        if context.building.joints.coefficient is None:
            why = "[joints] friction excludes it"
        context.warnings.append(f"Sliding of the whole building on a bed joint or on the base of a storey is not checked: {why}.")
    numbers: dict[str, Any] = {}
    if options.stages:
        curves, numbers = _stages(context, result, model, options, elastic)
    else:
        curves = push_curves(context, model, options)
        for curve, prefix in zip(curves, PREFIXES, strict=False):
            own = numbers_of_push(context, model, options, curve, elastic)
            if prefix:
                numbers["minus"] = own
            else:
                numbers |= own
            _describe(result, model, curve, prefix)
    store_mesh(result, model)
    first = curves[0]
    numbers |= {
        "weight_N": model.weight,
        "reference_load_N": model.unit,
        "direction_deg": float(options.direction),
        "pattern": "drives" if options.drives else options.pattern,
        "cracking": options.cracking,
        "layers": options.mesh.layers,
        "nodes": len(model.mesh.xyz),
        "elements": model.mesh.elements(),
        "equations": first.equations,
        "points": first.points,
        "factor_bytes": elastic["bytes"],
    }
    if options.pattern == "modal" and not options.drives:
        _, numbers["frequency_Hz"], numbers["modal_mass_ratio"] = first_mode(model, options, model.mesh.mass())
    interrupted = any(c.events.interrupted for c in curves)
    if options.variants and not interrupted:
        numbers |= run_variants(context, options, result, numbers)
    if verified and not interrupted and (found := verify_push(context, result, model, options, curves, numbers)) is not None:
        numbers["verification"] = found
    if options.frame is not None:
        numbers["frame"] = _frame(context, result, model, options, elastic)
    result.warnings += warn_unequal_drives(options, numbers)
    result.results = out.Pushover(**numbers)
    result.answer = answer_of_push(context.building, options, numbers)
    if interrupted:
        again = "; --resume continues from them" if context.checkpoint is not None else ""
        result.status, result.reason = "interrupted", f"interrupted; the events up to then are saved{again}"
    return result


def _describe(result: Result, model: ShellModel, curve: Curve, prefix: str) -> None:
    """Warnings, arrays, tables and files of a curve."""
    result.warnings += [*curve.warnings, *remarks_of_curve(model, curve)]
    events_of_curve(result, model.unit, curve, prefix)
    store_seats(result, model, curve, prefix)
    store_states(result, model, curve, prefix)


def _stages(
    context: Context, result: Result, model: ShellModel, options: Pushover, elastic: dict[str, Any]
) -> tuple[list[Curve], dict[str, Any]]:
    """The curves of all stages, the main one first; the numbers of that one, those of each in `stages`."""
    staged = run_stages(model, options, context.threads, progress_of(context, model, options), chains_of(context, model, options))
    main = min(options.main, len(staged) - 1)
    if main != options.main:
        result.warnings.append(
            f"the reported results are those of stage {options.stage_names[main]}, because it is the last stage that began"
        )
    if {stage.sense for stage in options.stages if not stage.settlements} == {"+", "-"} and not options.closes:
        result.warnings.append(
            "cracks stay open when the load is reversed: a crack that opened in one sense carries no compression in the "
            "other. To let cracks close, give crack_closure = true"
        )
    rows, numbers = [], {}
    for k, (own, curve) in enumerate(staged):
        prefix = "" if k == main else f"stage_{k + 1}_"
        found = numbers_of_push(context, own, options.model_copy(update={"probes": [] if prefix else options.probes}), curve, elastic)
        _describe(result, own, curve, prefix)
        held = curve.force(own.unit)[curve.held]
        rows.append(
            found
            | {
                "name": options.stage_names[k],
                "prefix": prefix,
                "of": "settlement" if own.driven else "push",
                "start_load_N": curve.already,
                "end_load_N": float(held[-1]) if len(held) else None,
            }
        )
        if not prefix:
            numbers = dict(found)
    numbers["stages"] = rows
    curves = [curve for _, curve in staged]
    return [curves[main], *(c for k, c in enumerate(curves) if k != main)], numbers


def _elastic(model: ShellModel, options: Pushover) -> dict[str, Any]:
    """Forces at the feet of the walls before anything cracks: under the constant loads, and of a unit of base shear."""
    with model.open(options, 1) as core_model:
        core_model.loads(model.constant, model.reference)
        under, more = core_model.report(0.0), core_model.report(1.0)
        bytes_of = 8 * core_model.factor_values
    constant, both = sections(model, under), sections(model, more)
    return {"constant": constant, "pushed": both, "bytes": bytes_of, "unit": model.unit, "under": under}


def _frame(context: Context, result: Result, model: ShellModel, options: Pushover, elastic: dict[str, Any]) -> list[dict[str, Any]]:
    """What the formulas of codes say of the piers; all of them as a table."""
    plan, rules = context.building.structure, options.frame
    strength = pier_strength(context.building, options)
    assert rules is not None and isinstance(plan, Plan)
    found, rows = capacities(model, plan, rules, strength, elastic["under"])
    result.tables["frame"] = TableData(
        {name: [row[name] for row in rows] for name in rows[0]},
        {"from": "m", "to": "m", "height": "m", "load": "N", "FEMA 356": "N", "NTC 2018": "N"},
    )
    return found
