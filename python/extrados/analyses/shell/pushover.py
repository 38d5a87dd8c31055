"""pushover: a building of walls and floors, or a vault, under growing horizontal forces (thesis 4.4)."""

import time
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.codes.actions import code_of
from extrados.analyses.codes.capacity_curve import CapacityCurve
from extrados.analyses.codes.verification import DRIFTS, Push, displaced_shape, unverified, verify, with_design_strengths
from extrados.analyses.context import Context
from extrados.analyses.shell.frame import capacities
from extrados.analyses.shell.model import ShellModel, build, first_mode
from extrados.analyses.shell.needs import pier_strength
from extrados.analyses.shell.sections import Section, cracks, drifts, place_axes, point_places, sections
from extrados.analyses.shell.sliding import sliding_limits
from extrados.analyses.shell.stages import run_stages
from extrados.analyses.shell.tables import Pushover, Variant
from extrados.analyses.sla.events import Curve, run_curves
from extrados.analyses.sla.kept import State
from extrados.analyses.sla.measures import numbers_of, out_of_reach
from extrados.analyses.sla.stored import events_of_curve
from extrados.core.calls import interruptible
from extrados.core.sla import EVENT, ShellJoints, Shells
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.results import shell as out
from extrados.results.model import Array, Result, TableData
from extrados.results.sla import PREFIXES
from extrados.results.verification import Verification
from extrados.results.vtu import pvd, vtu
from extrados.schema.quantities import engineering
from extrados.views.building import Building

#: Part of the weight that walls across the push must take up or down to count as working flanges
WORKING = 0.05
#: Forces below this part of the weight are rounding
ROUNDING = 1e-9
#: Cosine of the angle between a wall and the push below which the wall stands across
ACROSS = 0.5
#: What elements of a mesh file are called that are of no group
NO_GROUP = "shell"


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
        context.warnings.append("nothing in the structure can crack, because [material] has no tensile_strength or no fracture_energy")
    elastic = _elastic(model, options)
    if model.mesh.walls and not sliding_limits(model, context.building, options, elastic["under"]):
        why = "if imposed displacements load the walls, the shear force at these heights is not known"
        if context.building.joints.coefficient is None:
            why = "[joints] friction excludes it"
        context.warnings.append(f"Sliding of the whole building on a bed joint or on the base of a storey is not checked: {why}.")
    numbers: dict[str, Any] = {}
    if options.stages:
        curves, numbers = _stages(context, result, model, options, elastic)
    else:
        curves = _curves(context, model, options)
        for curve, prefix in zip(curves, PREFIXES, strict=False):
            own = _numbers(context, model, options, curve, elastic)
            if prefix:
                numbers["minus"] = own
            else:
                numbers |= own
            _describe(result, model, curve, prefix)
    _mesh_arrays(result, model)
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
        numbers |= _variants(context, options, result, numbers)
    if verified and not interrupted and (found := _verify(context, result, model, options, curves, numbers)) is not None:
        numbers["verification"] = found
    if options.frame is not None:
        numbers["frame"] = _frame(context, result, model, options, elastic)
    result.warnings += _no_base_shear(options, numbers)
    result.results = out.Pushover(**numbers)
    result.answer = _answer(context.building, options, numbers)
    if interrupted:
        again = "; --resume continues from them" if context.checkpoint is not None else ""
        result.status, result.reason = "interrupted", f"interrupted; the events up to then are saved{again}"
    return result


def _describe(result: Result, model: ShellModel, curve: Curve, prefix: str) -> None:
    """Warnings, arrays, tables and files of a curve."""
    result.warnings += [*curve.warnings, *_remarks(model, curve)]
    events_of_curve(result, model.unit, curve, prefix)
    _state_arrays(result, model, curve, prefix)


def _stages(
    context: Context, result: Result, model: ShellModel, options: Pushover, elastic: dict[str, Any]
) -> tuple[list[Curve], dict[str, Any]]:
    """The curves of all stages, the main one first; the numbers of that one, those of each in `stages`."""
    staged = run_stages(model, options, context.threads, _progress(context, model, options), _chains(context, model, options))
    main = min(options.main, len(staged) - 1)
    if main != options.main:
        result.warnings.append(f"the reported results are those of stage {options.stage_names[main]}, the last stage that began")
    if {stage.sense for stage in options.stages if not stage.settlements} == {"+", "-"} and not options.closes:
        result.warnings.append(
            "cracks stay open when the load is reversed: a crack that opened in one sense carries no compression in the "
            "other. To let cracks close, give crack_closure = true"
        )
    rows, numbers = [], {}
    for k, (own, curve) in enumerate(staged):
        prefix = "" if k == main else f"stage_{k + 1}_"
        found = _numbers(context, own, options.model_copy(update={"probes": [] if prefix else options.probes}), curve, elastic)
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


def _curves(context: Context, model: ShellModel, options: Pushover) -> list[Curve]:
    return run_curves(model, options, context.threads, _progress(context, model, options), None, _chains(context, model, options))


def _chains(context: Context, model: ShellModel, options: Pushover) -> Callable[[Any], Chain]:
    """Where the states of a curve are kept on its way."""
    made = [np.concatenate([p.connect.ravel() for p in model.mesh.parts]), model.mesh.xyz, model.constant, model.reference]
    materials = [m.model_dump_json() for m in model.mesh.materials]
    thickness = [p.thickness for p in model.mesh.parts]

    def chain(of: Any) -> Chain:
        return Chain(context, "pushover", [options, of, model.freedoms, *made, materials, *thickness])

    return chain


def _progress(context: Context, model: ShellModel, options: Pushover) -> Callable[[float, float, str], None]:
    """Progress by base shear over the weight, and how long the events that are allowed would take."""
    begun: list[tuple[float, float]] = []  # when the first batch ended, and its events: what came before is no event

    def tell(done: float, total: float, text: str) -> None:
        now = time.perf_counter()
        if not begun or done <= begun[0][1]:
            begun[:] = [(now, done)]
            context.progress(done, total, f"{text}; {model.weight / 1e3:.4g} kN weight, {model.mesh.elements()} elements")
            return
        left = (now - begun[0][0]) / (done - begun[0][1]) * max(total - done, 0.0)
        hours = f"{left / 3600:.1f} h" if left > 5400 else f"{left / 60:.0f} min" if left > 90 else f"{left:.0f} s"
        context.progress(done, total, f"{text}; {model.weight / 1e3:.4g} kN weight; at most {hours} more")

    return tell


def _elastic(model: ShellModel, options: Pushover) -> dict[str, Any]:
    """Forces at the feet of the walls before anything cracks: under the constant loads, and of a unit of base shear."""
    with model.open(options, 1) as core_model:
        core_model.loads(model.constant, model.reference)
        under, more = core_model.report(0.0), core_model.report(1.0)
        bytes_of = 8 * core_model.factor_values
    constant, both = sections(model, under), sections(model, more)
    return {"constant": constant, "pushed": both, "bytes": bytes_of, "unit": model.unit, "under": under}


def _facing(model: ShellModel) -> np.ndarray:
    """Cosine of each wall's direction to the push: forces of a section act from the part above on the part below."""
    return np.array([float(wall.along @ model.along[:2]) for wall in model.mesh.walls])


def _by_wall(model: ShellModel, found: list[Section]) -> tuple[np.ndarray, np.ndarray]:
    """Shear along each wall and normal force at the feet [N]."""
    shear, normal = np.zeros(len(model.mesh.walls)), np.zeros(len(model.mesh.walls))
    for section in found:
        if section.storey == 1:
            shear[section.wall] += section.shear
            normal[section.wall] += section.normal
    return shear, normal


def _numbers(context: Context, model: ShellModel, options: Pushover, curve: Curve, elastic: dict[str, Any]) -> dict[str, Any]:
    """Results of one curve."""
    numbers = numbers_of(model, options, curve)
    state = shown_state(model, curve)
    force = curve.force(model.unit)
    greatest = numbers["greatest_load_N"]
    limits = sliding_limits(model, context.building, options, elastic["under"])
    least = min(limits, key=lambda row: (round(row.base_shear_N / model.weight, 9), row.height_m), default=None)
    capacity = greatest
    if least is not None:
        capacity = None if greatest is None else min(greatest, least.base_shear_N)
        numbers |= {
            "sliding_capacity_N": least.base_shear_N,
            "sliding_level": least.level,
            "sliding": [asdict(row) | {"base_shear_N": row.base_shear_N} for row in limits],
        }
    numbers |= {
        "capacity_N": None if model.driven else capacity,
        "base_shear_coefficient": None if capacity is None or model.driven else capacity / model.weight,
        "roof_drift": None,
        "storey_drifts": [],
        "walls": [],
        "cracked_points_by_storey": [],
    }
    crack = _first_crack(model, curve)
    if crack is not None:
        numbers["first_crack"] = crack
    if state is None:
        return numbers
    base = float(force[state.event])
    seen = cracks(model, state.report)["part"] > 0.0
    storey = point_places(model)["storey"]
    numbers["cracked_points_by_storey"] = np.bincount(storey[seen], minlength=len(model.mesh.levels))[1:].tolist()
    if model.mesh.joints:
        numbers["joints"] = _joints(model, curve, state)
    if not model.mesh.walls:
        numbers["feet"] = _feet(context, model, options, curve, state)
        return numbers
    if not model.driven:
        height = float(model.mesh.xyz[model.control.node, 2].mean())
        numbers["roof_drift"] = numbers["greatest_load_displacement_m"] / height
    every, walls = drifts(model, state.displacement, curve.sign)
    numbers["storey_drifts"] = every.tolist()
    shear, normal = _by_wall(model, sections(model, state.report))
    shear0, normal0 = _by_wall(model, elastic["constant"])
    shear1, _ = _by_wall(model, elastic["pushed"])
    base = 0.0 if model.driven else base
    facing = _facing(model)
    carried = curve.sign * shear * facing
    numbers["walls"] = [
        {
            "wall": wall.name,
            "shear_N": float(carried[w]),
            "share": float(carried[w] / base) if base else 0.0,
            "normal_N": float(normal[w]),
            "normal_change_N": float(normal[w] - normal0[w]),
            "elastic_share": float((shear1[w] - shear0[w]) * facing[w] / elastic["unit"]),
            "drifts": walls[w].tolist(),
        }
        for w, wall in enumerate(model.mesh.walls)
    ]
    across = np.abs(facing) < ACROSS
    if across.any() and not across.all() and base:
        change = (normal - normal0)[across]
        up, down = float(change[change > 0].sum()), float(-change[change < 0].sum())
        numbers["flanges"] = {
            "share": float(1.0 - carried[~across].sum() / base),
            "uplift_N": up,
            "pressure_N": down,
            "working": max(up, down) > WORKING * model.weight,
        }
    return numbers


def shown_state(model: ShellModel, curve: Curve) -> State | None:
    """The state that stands for a curve: of the greatest load, where supports move the last."""
    if model.driven:
        return curve.states[-1] if curve.states else None
    return next((s for s in curve.states if s.event == curve.peak), None)


def _gave_way(row: dict[str, Any]) -> str:
    """When a joint gave way: under the constant loads, where no event of the push did it."""
    load = row["first_base_shear_N"]
    return "" if load is None else f" fails under {load / 1e3:.3g} kN and"


def _joints(model: ShellModel, curve: Curve, state: State) -> list[dict[str, Any]]:
    """How far each joint has come apart in a state, and in the last one that is in equilibrium."""
    last = next((s for s in reversed(curve.states) if curve.held[s.event]), state)
    rows, force = [], curve.force(model.unit)
    for joint, points in model.joints():
        hits = np.flatnonzero((curve.events.point >= points.start) & (curve.events.point < points.stop))
        found: dict[str, Any] = {"joint": joint.name, "wall": joint.wall}
        for prefix, at in (("", state), ("last_", last)):
            found[f"{prefix}opening_m"] = max(float(at.report["strain_n"][points].max()), 0.0)
            slip = np.hypot(at.report["strain_ns"][points], at.report["strain_s"][points])
            found[f"{prefix}slip_m"] = float(slip.max())
        area = last.report["volume"][points]
        broken = (last.report["tooth_n"][points] > 1) | (last.report["tooth_s"][points] > 1)
        found["first_base_shear_N"] = float(force[hits[0]]) if len(hits) else None
        found["broken_share"] = float(area[broken].sum() / area.sum())
        rows.append(found)
    return rows


def _feet(context: Context, model: ShellModel, options: Pushover, curve: Curve, state: State) -> list[dict[str, Any]]:
    """What each foot of a vault bears in a state: thrust outward and weight."""
    borne = model.borne(options, curve, state, context.threads)
    by = {(ground.foot, ground.way): borne[k] for ground, k in model.grounds.items() if ground.x is None}
    return [
        {"foot": foot.name, "thrust_N": float(by.get((f, "out"), 0.0)), "vertical_N": float(by.get((f, "down"), 0.0))}
        for f, foot in enumerate(model.mesh.feet)
    ]


def _first_crack(model: ShellModel, curve: Curve) -> dict[str, Any] | None:
    """Where the first tooth of the push passes, or of the weight before it."""
    for events, loads in ((curve.stage_a, lambda e: np.zeros(len(e))), (curve.events, lambda _: curve.force(model.unit))):
        if events is None or not len(events):
            continue
        hits = np.flatnonzero(np.isin(events.code, [EVENT["tension"], EVENT["tension_s"]]) & (events.point >= 0))
        for k in hits:
            at = _place_of(model, int(events.point[k]))
            if at is not None:
                return at | {"base_shear_N": float(loads(events)[k])}
    return None


def _place_of(model: ShellModel, point: int) -> dict[str, Any] | None:
    """The wall, storey and place of a point; None of floors and bars."""
    place, places = 0, point_places(model)
    for part, points, layers in model.places():
        if points.start <= point < points.stop:
            k = place + (point - points.start) // layers
            at = place_axes(model)["xyz"][k]
            where = {"wall": part.name, "storey": int(places["storey"][k]), "place_m": at.tolist()}
            if part.wall < 0:
                return where | {"height_m": float(at[2] - model.mesh.levels[0])}
            return where | {"along_m": float(places["s"][k]), "height_m": float(places["z"][k])}
        place += (points.stop - points.start) // layers
    return None


def _no_base_shear(options: Pushover, numbers: dict[str, Any]) -> list[str]:
    """A warning where drives of unequal ratios make the load another quantity than the base shear."""
    if len({drive.ratio for drive in options.drives}) < 2 or not numbers["walls"]:
        return []
    carried, load = sum(row["shear_N"] for row in numbers["walls"]), numbers["greatest_load_N"]
    return [
        (
            "The drives move their storeys by different ratios. The load of the curve is therefore the work of all drives "
            f"divided by the control displacement, not the base shear. At the greatest load of {engineering(load, 'N')}, the "
            f"walls carry {engineering(carried, 'N')} along the load at their feet. Compare this shear of the walls with "
            "measured base shears."
        )
    ]


def _remarks(model: ShellModel, curve: Curve) -> list[str]:
    events, sense = curve.events, f" (stage {curve.name})" if curve.name else f" (push to {curve.sense})"
    said = [far] if (far := out_of_reach(curve)) else []
    if model.driven or (curve.name and events.reason == "target load"):
        return said  # a stage that ends where it is told to
    if curve.peak >= 0 and not events.interrupted and not curve.passed(model.unit):
        said.append(
            f"the base shear{sense} had not passed a peak when the run ended ({events.reason or 'number of events'}). Its "
            f"greatest value, {engineering(curve.force(model.unit)[curve.peak], 'N')}, is therefore not a capacity"
        )
    return said


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


def _verify(
    context: Context, result: Result, model: ShellModel, options: Pushover, curves: list[Curve], numbers: dict[str, Any]
) -> Verification | None:
    """Displacement demand and capacity of all senses; conditions that its curves do not know."""
    mass = model.mesh.mass()
    with model.open(options, 1) as core_model:
        shape, through = displaced_shape(core_model, model.reference, model.control, model.along, model.freedoms.equation >= 0)
    if options.verification.shape == "mode":
        shape, *_ = first_mode(model, options, mass)
        c = model.control
        shape = shape / float((c.share * model.along[c.direction]) @ shape[c.node])
    drifts_of_piers = DRIFTS.get(code_of(context).jurisdiction)
    pushes, violated = [], []
    for curve in curves:
        if curve.peak < 0:
            violated.append(unverified(curve.sense))
            continue
        d, p = curve.envelope(model.unit)
        found = CapacityCurve(d - d[0], through * p, mass, shape)
        if drifts_of_piers is not None:
            shear, flexure = (_drift_reached(model, curve, limit) for limit in drifts_of_piers)
            found = replace(found, limits={} if flexure is None else {"drift": flexure - curve.before})
            if shear is not None and shear - curve.before < found.ultimate:
                violated.append(
                    f"Towards {curve.sense}, a wall reaches the limit drift of piers in shear ({100 * drifts_of_piers[0]:.2g} %) at "
                    f"{1e3 * shear:.3g} mm, before the collapse displacement. If its piers fail in shear, the curve ends there."
                )
        pushes.append(Push(curve.sense, found, float(mass.sum())))
    for own in (numbers, numbers.get("minus")):
        if own is not None and own["capacity_N"] is not None and own["capacity_N"] < own["greatest_load_N"]:
            violated.append(
                f"Towards {own['sense']}, the building slides at {own['sliding_level']} under {own['capacity_N'] / 1e3:.3g} kN, "
                "but the capacity curve excludes this sliding."
            )
    return verify(context, result, options.verification, pushes, violated)


def _drift_reached(model: ShellModel, curve: Curve, limit: float) -> float | None:
    """Control displacement [m] at which a storey of a wall along the push has a drift, by straight lines between the kept
    states in equilibrium (the greatest load and the last among them); None where none reaches it."""
    along = [w for w, wall in enumerate(model.mesh.walls) if abs(float(wall.along @ model.along[:2])) >= ACROSS]
    at, most = [curve.before], [0.0]
    for state in curve.states:
        if curve.held[state.event]:
            at.append(float(curve.events.monitors[state.event, 0]))
            most.append(float(np.nanmax(drifts(model, state.displacement, curve.sign)[1][along], initial=0.0)))
    order = np.argsort(at)
    d, drift = np.array(at)[order], np.maximum.accumulate(np.array(most)[order])
    return float(np.interp(limit, drift, d)) if drift[-1] >= limit else None


def _variants(context: Context, options: Pushover, result: Result, numbers: dict[str, Any]) -> dict[str, Any]:
    """The first sense again with other assumptions."""
    rows, greatest = [], [numbers["greatest_load_N"]]
    once = options.model_copy(update={"directions": options.directions[:1], "variants": [], "states": []})
    for k, variant in enumerate(options.variants, 1):
        mesh = _varied(context.building, variant).shell(options.mesh)
        if not mesh.walls:  # a vault, or a mesh of shells: as it stands, but thicker
            parts = [replace(p, thickness=variant.thickness * p.thickness) if p.bends else p for p in mesh.parts]
            mesh = replace(mesh, parts=parts)
        model = build(mesh, once)
        curve = _curves(context, model, once)[0]
        d, p = curve.envelope(model.unit)
        found = numbers_of(model, once, curve)["greatest_load_N"]
        result.arrays[f"variant_{k}_displacement"] = Array(
            d, (f"variant_{k}",), "m", f"control displacement, {variant.name}", "variant_displacement"
        )
        result.arrays[f"variant_{k}_load"] = Array(p, (f"variant_{k}",), "N", f"base shear, {variant.name}", "variant_load")
        factors = {name: value for name, value in variant.model_dump().items() if name != "name" and value != 1.0}
        rows.append(
            {
                "name": variant.name,
                "factors": factors,
                "greatest_base_shear_N": found,
                "passed": curve.passed(model.unit),
                "base_shear_coefficient": None if found is None else found / model.weight,
            }
        )
        greatest.append(found)
        if curve.events.interrupted:
            break
    known = [value for value in greatest if value is not None]
    return {"variants": rows} | ({"band_N": [min(known), max(known)]} if known else {})


def _varied(building: Building, variant: Variant) -> Building:
    """The building with other material, and of walls on a plan with other thicknesses, floors and forces."""

    def material(of: Material) -> Material:
        scaled = {
            name: getattr(of, name) * factor
            for names, factor in (
                (("tensile_strength", "tensile_strength_parallel", "shear_strength"), variant.strength),
                (("fracture_energy", "fracture_energy_parallel"), variant.energy),
                (("young",), variant.young),
                (("density",), variant.density),
            )
            for name in names
            if getattr(of, name) is not None
        }
        return of.model_copy(update=scaled)

    plan = building.structure
    changed = replace(
        building, material=material(building.material), materials={name: material(of) for name, of in building.materials.items()}, views={}
    )
    if not isinstance(plan, Plan):
        return changed
    walls = [
        wall.model_copy(
            update={
                "thickness": None if wall.thickness is None else variant.thickness * wall.thickness,
                "thicknesses": [variant.thickness * t for t in wall.thicknesses],
            }
        )
        for wall in plan.walls
    ]
    floors = [f if f.young is None else f.model_copy(update={"young": f.young * variant.floors}) for f in plan.floors]
    prestress = [p.model_copy(update={"force": p.force * variant.prestress}) for p in plan.prestress if variant.prestress > 0.0]
    return changed.having(structure=plan.model_copy(update={"walls": walls, "floors": floors, "prestress": prestress}))


def _mesh_arrays(result: Result, model: ShellModel) -> None:
    """Nodes, elements of the walls and of the floors, and the places in the planes of the walls."""
    mesh = model.mesh
    result.arrays["node"] = Array(mesh.xyz, ("nodes", "axis"), "m", "nodes of the mesh")
    for k, part in enumerate(mesh.parts):
        corner = 3 if part.kind == "T3" else 4
        result.arrays[f"elements_{k}"] = Array(
            part.connect, (f"elements_of_{k}", f"corner_{corner}"), "", f"nodes of {part.name}, from 0", "elements"
        )
        result.arrays[f"wall_of_{k}"] = Array(
            np.array([part.wall]), ("one",), "", f"number of the wall that {part.name} belongs to, from 0; -1: none", "wall_of"
        )
        result.arrays[f"bends_{k}"] = Array(
            np.array([int(part.bends)]), ("one",), "", f"whether {part.name} resists bending; a floor does not", "bends"
        )
    walls = np.array([[*w.origin, *w.along, w.length] for w in mesh.walls]).reshape(-1, 5)
    result.arrays["wall"] = Array(walls, ("walls", "wall_row"), "m", "origin and direction in plan, and length")
    result.arrays["level"] = Array(mesh.levels, ("levels",), "m", "heights of the ground and the storeys")
    if not mesh.walls:
        for name, values in place_axes(model).items():
            unit = "m" if name == "xyz" else ""
            result.arrays[f"place_{name}"] = Array(
                values, ("places", "axis"), unit, f"value at the integration points of the shells: {name}"
            )
    for name, values in point_places(model).items():
        unit = "m" if name in "sz" else ""
        result.arrays[f"place_{name}"] = Array(values, ("places",), unit, f"value at the integration points of the walls: {name}")


def _state_arrays(result: Result, model: ShellModel, curve: Curve, prefix: str) -> None:
    """Displacements, cracks and the forces of the piers of the kept states, and their fields as VTU."""
    if not curve.states:
        return
    states, dims = curve.states, (f"{prefix}states",)
    force = curve.force(model.unit)
    result.arrays[f"{prefix}state_event"] = Array(np.array([s.event + 1 for s in states]), dims, "", "event, from 1")
    result.arrays[f"{prefix}state_load"] = Array(force[[s.event for s in states]], dims, "N", "base shear")
    result.arrays[f"{prefix}state_displacement"] = Array(
        np.stack([s.displacement[:, :3] for s in states]), (*dims, "nodes", "axis"), "m", "displacements of the nodes"
    )
    if model.mesh.walls:
        result.arrays[f"{prefix}state_wall_shear"] = Array(
            np.stack([curve.sign * _facing(model) * _by_wall(model, sections(model, s.report))[0] for s in states]),
            (*dims, "walls"),
            "N",
            "in-plane shear of each wall at its foot, along the load",
        )
    seen = [cracks(model, s.report) for s in states]
    for name, unit, about in (
        ("width", "m", "greatest crack width through the thickness"),
        ("angle", "rad", "direction of the crack normal in the wall"),
        ("part", "", "share of the thickness that has cracked"),
        ("side", "", "position of the greatest crack width through the thickness, from -1 to 1 on the side of the normal"),
    ):
        result.arrays[f"{prefix}state_{name}"] = Array(np.stack([s[name] for s in seen]), (*dims, "places"), unit, about)
    _pier_table(result, model, curve, states, prefix)
    _fields(result, model, states, seen, prefix)


def _pier_table(result: Result, model: ShellModel, curve: Curve, states: list[State], prefix: str) -> None:
    state = next((s for s in states if s.event == curve.peak), states[-1])
    if not model.mesh.walls:
        return
    rows = sections(model, state.report)
    result.tables[f"piers_{prefix}".rstrip("_")] = TableData(
        {
            "wall": [model.mesh.walls[r.wall].name for r in rows],
            "storey": [r.storey for r in rows],
            "from": [r.start for r in rows],
            "to": [r.end for r in rows],
            "normal": [r.normal for r in rows],
            "shear": [r.shear for r in rows],
            "moment": [r.moment for r in rows],
        },
        {"from": "m", "to": "m", "normal": "N", "shear": "N", "moment": "N m"},
    )


def _fields(result: Result, model: ShellModel, states: list[State], seen: list[dict[str, np.ndarray]], prefix: str) -> None:
    """The states for ParaView; floors have no cracks."""
    name, series = f"fields_{prefix}".rstrip("_"), []
    walls = [part for part in model.mesh.parts if part.bends]
    cells = [(part.kind, part.connect) for part in [*walls, *(p for p in model.mesh.parts if not p.bends)]]
    element = point_places(model)["element"]
    count = sum(len(connect) for _, connect in cells)
    for state, crack in zip(states, seen, strict=True):
        width, part = np.zeros(count), np.zeros(count)
        np.maximum.at(width, element, crack["width"])
        np.maximum.at(part, element, crack["part"])
        file = f"{name}/event_{state.event + 1:06d}.vtu"
        result.files[file] = vtu(
            model.mesh.xyz, cells, {"displacement": state.displacement[:, :3]}, {"crack_width": width, "cracked_part": part}
        )
        series.append((state.event + 1, file))
    result.files[f"{name}.pvd"] = pvd(series)


def _answer(building: Building, options: Pushover, numbers: dict[str, Any]) -> str:
    word = "building" if building.structure is None else building.structure.word
    grouped = building.structure is not None and building.structure.kind == "mesh"
    parts = []
    if "stages" in numbers:
        ends = [_stage_told(stage) for stage in numbers["stages"]]
        parts.append(f"Stages, each with the damage of the stages before: {'; '.join(ends)}.")
    for curve in [numbers, *([numbers["minus"]] if "minus" in numbers else [])]:
        parts.append(_curve_told(options, numbers, curve, word, grouped))
    if numbers.get("band_N"):
        low, high = numbers["band_N"]
        parts.append(
            f"Under the other assumptions of {len(numbers['variants'])} variants, the base shear is {low / 1e3:.4g} to {high / 1e3:.4g} kN."
        )
    if "frame" in numbers:
        words = [f"{row['base_shear_N'] / 1e3:.4g} kN by {row['code']} (storey {row['storey']})" for row in numbers["frame"]]
        parts.append(f"The capacity of the piers by code formulas is {' and '.join(words)}.")
    assumed = getattr(building.structure, "assumed", [])
    if assumed:
        parts.append("Assumed values, not given by the sources of this building: " + "; ".join(assumed) + ".")
    return " ".join(part for part in parts if part)


def _stage_told(stage: dict[str, Any]) -> str:
    end = stage["end_load_N"]
    if end is None:
        return f"{stage['name']} without a state in equilibrium"
    if stage["of"] == "settlement":
        return f"{stage['name']}, settlement of the ground: {stage['damaged_points']} integration points crack"
    return f"{stage['name']}, load towards {stage['sense']}, ends at {end / 1e3:.4g} kN ({stage['stop']})"


def _pressing(row: dict[str, Any], weight: float) -> str:
    """What a foot hands to the ground; what is only rounding beside the weight is not told."""
    parts = []
    for force, ways in ((row["thrust_N"], ("outward", "inward")), (row["vertical_N"], ("down", "up"))):
        if abs(force) > ROUNDING * weight:
            parts.append(f"{ways[force < 0.0]} with {abs(force) / 1e3:.4g} kN")
    return f"presses {' and '.join(parts)}" if parts else "carries nothing"


def _curve_told(options: Pushover, numbers: dict[str, Any], curve: dict[str, Any], word: str, grouped: bool) -> str:
    """What a push of a building or a vault says; of ground that gives way what its feet bear. grouped: its parts are groups of
    a mesh file."""
    main = next((stage for stage in numbers.get("stages", []) if not stage["prefix"]), None)
    feet = "; ".join(f"its foot {row['foot']} {_pressing(row, numbers['weight_N'])}" for row in curve.get("feet", []))
    if main is not None and main["of"] == "settlement":
        return f"After stage {main['name']} {feet}." if feet else ""
    load = curve["greatest_load_N"]
    sense = (
        f"Under the load towards {curve['sense']} ({options.direction:g} degrees in plan)" if main is None else f"In stage {main['name']}"
    )
    if load is None:
        return f"{sense}: no equilibrium state was found."
    bears = "carries" if curve["peak_load_N"] is not None else "has reached, without a peak,"
    part = f"{curve['base_shear_coefficient']:.3g} of its weight of {numbers['weight_N'] / 1e3:.4g} kN"
    slides = curve["capacity_N"] < load
    if slides:
        text = (
            f"{sense}, the {word} carries a base shear of at most {curve['capacity_N'] / 1e3:.4g} kN({part}), and then slides "
            f"at {curve['sliding_level']} by Coulomb's law. Without this sliding the model {bears} {load / 1e3:.4g} kN"
        )
    else:
        text = f"{sense}, the {word} {bears} a base shear of {load / 1e3:.4g} kN, {part}"
    if curve["roof_drift"] is not None:
        text += f", at a drift of {100 * curve['roof_drift']:.2g} %"
    if "first_crack" in curve:
        crack = curve["first_crack"]
        if "along_m" in crack:
            text += (
                f"; the first crack forms in wall {crack['wall']}, storey {crack['storey']}, {crack['along_m']:.3g} m along the "
                f"wall and {crack['height_m']:.3g} m above the ground, under {crack['base_shear_N'] / 1e3:.3g} kN"
            )
        else:
            x, y, z = crack["place_m"]
            part = crack["wall"]
            where = f"group {part}" if grouped and part != NO_GROUP else f"the {part}"
            text += f"; the first crack forms in {where} at x {x:.3g}, y {y:.3g}, z {z:.3g} m, under {crack['base_shear_N'] / 1e3:.3g} kN"
    if any(r["share"] > 0.02 for r in curve["walls"]):
        most = sorted(curve["walls"], key=lambda row: -row["share"])[:4]
        text += "; " + ", ".join(f"wall {r['wall']} carries {100 * r['share']:.0f} %" for r in most if r["share"] > 0.02)
    if "flanges" in curve:
        flanges = curve["flanges"]
        text += (
            f"; transverse walls {'act as flanges' if flanges['working'] else 'hardly act as flanges'} "
            f"({flanges['uplift_N'] / 1e3:.3g} kN up, {flanges['pressure_N'] / 1e3:.3g} kN down)"
        )
    moved = [row for row in curve.get("joints", []) if row["broken_share"] > 0.0]
    for row in sorted(moved, key=lambda row: -max(row["last_slip_m"], row["last_opening_m"]))[:3]:
        text += (
            f"; joint {row['joint']} in wall {row['wall']}{_gave_way(row)} has slid by {1e3 * row['last_slip_m']:.2g} mm and opened by "
            f"{1e3 * row['last_opening_m']:.2g} mm at the end"
        )
    return f"{text}{'; ' if feet else ''}{feet}."
