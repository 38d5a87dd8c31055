"""rocking of a block on a base that gives way and does not pull (Psycharis and Jennings 1983)."""

import numpy as np

from extrados.analyses.chaos import CHAOTIC, chaos_told, growth, over_critical, perturbed, turning
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.rocking.history import LARGEST, ROOM, count, drawn_times
from extrados.analyses.rocking.shapes import film, pictures
from extrados.analyses.rocking.tables import Rocking
from extrados.core.rocking import FAILED, OUTCOMES, Outcome, ensemble
from extrados.core.soft_base import SoftBaseResponse, soft_base_history, soft_base_start
from extrados.results import rocking as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.soft_base import UNDAMPED, SoftBaseModel, soft_base_model

#: After the motion it rocks within this many of the block's own time units 1/p
SETTLE = 30.0
#: A base that presses with less than this share of the weight lets the block fly, for the friction needed
FLIES = 0.01


def run(context: Context, options: Rocking) -> Result:
    """History, edges that lift and land, energies, pressures, and what it would do on a rigid base."""
    building = context.building
    model = soft_base_model(building, options.form == "linear")
    if building.structure is not None and building.structure.kind == "column":
        context.warnings.append("the column is taken as one rigid body; joints that open are left to the analysis `dem`")
    if not model.core.damping:
        context.warnings.append(UNDAMPED)
    p = float(model.rigid.frequency.min())
    end_time = options.end_time or context.motion.end + SETTLE / p
    if end_time / options.output_step * 20 > LARGEST:
        raise Refused(
            f"a history of {end_time:g} s in steps of {options.output_step:g} s is too long to store", ("analysis", "output_step")
        )
    ratio = building.initial.rotation_ratio
    start = soft_base_start(model.core, model.turned(ratio))
    room = ROOM

    def rock(scale: float = 1.0) -> SoftBaseResponse:
        return soft_base_history(
            model.core,
            context.motion.ground,
            end_time,
            options.output_step,
            scale=scale,
            tolerance=options.tolerance,
            start=start,
            room=room,
        )

    r = rock()
    if r.events_found > room and not r.interrupted:
        room = r.events_found
        r = rock()
    grown, turns = 0.0, 0.0
    if not r.interrupted:
        probes = [rock(factor) for factor in perturbed()]
        critical = (model.critical(1), -model.critical(-1))
        grown = growth([over_critical(one.rotation, critical) for one in (r, *probes[:2])])
        turns = turning(r.outcome, [one.outcome for one in probes])
    rigid: tuple[Outcome, float] | None = None
    if not r.interrupted:
        side = 0 if ratio >= 0.0 else 1
        same = ensemble(
            [model.rigid.body],
            [context.motion.ground],
            np.array([0]),
            np.array([0]),
            np.array([1.0]),
            end_time,
            start_rotation=ratio * float(model.rigid.alpha[side]),
            tolerance=options.tolerance,
            threads=context.threads,
        )
        if not same.interrupted and same.outcome[0] != FAILED:
            rigid = OUTCOMES[same.outcome[0]], float(same.peak[0])
    return _result(context, options, model, r, (grown, turns), rigid)


def _result(
    context: Context,
    options: Rocking,
    model: SoftBaseModel,
    r: SoftBaseResponse,
    chaos: tuple[float, float],
    rigid: tuple[Outcome, float] | None,
) -> Result:
    potential = r.potential - model.potential(model.rest)
    energy = r.kinetic + potential
    scale = max(float(np.ptp(energy)) if len(energy) else 0.0, abs(r.work), 1e-300)
    critical = model.critical(1), model.critical(-1)
    fell = r.outcome == "collapse"
    quiet = r.stop_time >= context.motion.end
    least = min(model.potential(critical[0]), model.potential(critical[1])) - model.potential(model.rest)
    held = critical[1] < r.end[0] < critical[0]
    settled = fell or (quiet and held and len(energy) > 0 and float(energy[-1]) < least)
    friction = np.abs(r.force[:, 0]) / np.maximum(r.force[:, 1], 1e-300)
    flies = r.force[:, 1] < FLIES * model.weight
    friction[flies] = 0.0
    lifted = r.range[:, 1] - r.range[:, 0] < (1.0 - 1e-9) * (model.core.toe_left + model.core.toe_right)
    if model.core.edges:
        far = np.stack([-model.core.toe_left * np.ones_like(r.rotation), model.core.toe_right * np.ones_like(r.rotation)])
        sine = r.rotation if model.core.linear else np.sin(r.rotation)
        lifted = (r.sinking + far * sine < 0.0).any(axis=0)
    impacts = [t for kind, t, _ in r.events if kind == "impact"]
    end = critical[0] if r.peak[0] >= 0.0 else critical[1]
    uplift = min(model.uplift(1), model.uplift(-1))
    result = Result("rocking", status="interrupted" if r.interrupted else "ok")
    result.reason = f"interrupted at {r.stop_time:.3f} s" if r.interrupted else ""
    base = (
        {"greatest_edge_force_N": float(r.most.max(initial=0.0))}
        if model.core.edges
        else {"greatest_pressure_Pa": float(r.most.max(initial=0.0)) / model.block.depth}
    )
    vertical = model.periods
    chaotic = chaos[0] > CHAOTIC or chaos[1] > 0.0
    violated = [chaos_told(*chaos)] if chaotic else []
    if flies.any():
        violated.append(
            f"The base does not press in {100.0 * flies.mean():.2g} % of the time: the block is airborne, and its sides are assumed not to "
            "slide. Use dem."
        )
    result.results = out.Rocking(
        rotation_of="the block",
        outcome=r.outcome,
        settled=settled,
        collapse_half_cycle=r.half_cycles if fell else None,
        collapse_time_s=r.stop_time if fell else None,
        half_cycles=r.half_cycles,
        impacts=sum(r.landings),
        impact_times_s=impacts,
        peak_rotation_rad=r.peak[0],
        peak_rotation_ratio=float(abs(r.peak[0] / end)),
        peak_ground_acceleration_g=context.motion.peak / GRAVITY,
        energy_supplied_J=r.work,
        energy_lost_at_impacts_J=0.0,
        energy_residual_ratio=float(np.abs(energy - energy[:1] - r.ledger).max(initial=0.0)) / scale,
        steps=r.steps,
        rejected_steps=0,
        restitution=None,
        critical_rotation_rad=critical[0],
        critical_rotation_left_rad=-critical[1],
        frequency_parameter_rad_s=float(model.rigid.frequency[0]),
        uplift_acceleration_g=uplift,
        required_friction=float(friction.max(initial=0.0)),
        decided_by_last_digits=chaotic,
        perturbation_growth=chaos[0],
        violated=violated,
        soft_base=out.SoftBaseRocking(
            foundation="two-spring" if model.core.edges else "winkler",
            rocking_period_s=vertical[0],
            vertical_period_s=vertical[1],
            sinking_at_rest_m=model.sinking(model.rest),
            lift_rotation_rad=min(model.lifted(1), -model.lifted(-1)),
            capacity_g=min(model.capacity(1), model.capacity(-1)),
            peak_sinking_m=r.peak[1],
            lifted_share=float(lifted.mean()) if len(lifted) else 0.0,
            free_share=float(flies.mean()) if len(flies) else 0.0,
            energy_taken_up_J=r.spent,
            rigid_outcome=rigid[0] if rigid else None,
            rigid_peak_rotation_rad=rigid[1] if rigid else None,
            **base,
        ),
    )
    result.warnings += violated
    if not settled and not r.interrupted:
        result.warnings.append(
            f"the block still moves enough to overturn at the end time of {r.stop_time:g} s: the outcome is open, set a longer end_time"
        )
    if rigid is not None and rigid[0] != r.outcome:
        result.warnings.append(f"on a rigid base, with Housner's impact, the outcome is another one: {rigid[0]}")
    index = drawn_times(r.time, r.rotation[None], options)
    result.tables["rocking"] = TableData(
        {
            "time": r.time,
            "rotation": r.rotation,
            "rotation_rate": r.rate,
            "sinking": r.sinking,
            "ground_acceleration": r.ground,
            "vertical_acceleration": r.vertical,
            "kinetic_energy": r.kinetic,
            "potential_energy": potential,
            "energy_supplied_less_lost": r.ledger,
            "force_up": r.force[:, 1],
            "required_friction": friction,
        },
        {
            "time": "s",
            "rotation": "rad",
            "rotation_rate": "rad/s",
            "sinking": "m",
            "ground_acceleration": "m/s^2",
            "vertical_acceleration": "m/s^2",
            "kinetic_energy": "J",
            "potential_energy": "J",
            "energy_supplied_less_lost": "J",
            "force_up": "N",
        },
    )
    result.tables["rocking_events"] = TableData(
        {
            "event": [kind for kind, _, _ in r.events],
            "time": np.array([t for _, t, _ in r.events]),
            "value": np.array([e for _, _, e in r.events]),
        },
        {"time": "s", "value": "edge that lifts or lands: -1 left, 1 right"},
    )
    pressed = np.where(flies[:, None], np.nan, r.range)
    result.arrays = {
        "time": Array(r.time, ("time",), "s", "output times"),
        "rotation": Array(r.rotation, ("time",), "rad", "rotation of the block, positive to +x"),
        "rate": Array(r.rate, ("time",), "rad/s"),
        "sinking": Array(r.sinking, ("time",), "m", "settlement at the foot of its centre"),
        "ground": Array(r.ground, ("time",), "m/s^2", "horizontal ground acceleration"),
        "vertical": Array(r.vertical, ("time",), "m/s^2", "vertical ground acceleration"),
        "kinetic": Array(r.kinetic, ("time",), "J"),
        "potential": Array(potential, ("time",), "J", "with that of the springs, above that at rest"),
        "ledger": Array(r.ledger, ("time",), "J", "work done by the ground motion, minus the energy absorbed by the compliant base"),
        "impact_time": Array(np.array(impacts), ("impact",), "s", "an edge lands"),
        "pressed": Array(pressed, ("time", "end"), "m", "range of the base that pushes, from the foot of the centre"),
        "required_friction": Array(friction[:, None], ("time", "joint"), "", "coefficient of friction needed"),
        **geometry_arrays(model.block),
        "snapshot_time": Array(r.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(
            model.pose(r.rotation[index], r.sinking[index]), ("snapshot", "block", "component"), "m, m, rad", "x, y, rotation"
        ),
    }
    if options.animation != "none" and len(r.time):
        shown = pictures(r.time)
        result.arrays |= film(r.time[shown], model.pose(r.rotation[shown], r.sinking[shown]))
    result.answer = _answer(context, model, r, result.results, rigid)
    return result


def _answer(context: Context, model: SoftBaseModel, r: SoftBaseResponse, found: out.Rocking, rigid: tuple[Outcome, float] | None) -> str:
    """The outcome in words."""
    way = "+x" if r.peak[0] > 0 else "-x"
    greatest = (
        f"greatest rotation {1e3 * abs(r.peak[0]):.3g} mrad to {way}, {100 * found.peak_rotation_ratio:.0f} % of the "
        "rotation from which gravity causes collapse"
    )
    said = {
        "collapse": f"overturns to {way}: at {r.stop_time:.2f} s its rotation is past recovery",
        "recovery": f"rocks and recovers: {greatest}",
        "no-hinging": f"keeps its whole base on the ground: {greatest}",
    }[r.outcome]
    lifts = sum(kind == "uplift" for kind, _, _ in r.events)
    if not found.settled:
        said = f"still moves when the run ends at {r.stop_time:.2f} s: the outcome is open. So far {greatest}"
    assert found.soft_base is not None
    rigidly = ""
    if rigid is not None:
        rigidly = {
            "collapse": " On a rigid base, with Housner's impact, it would overturn.",
            "recovery": f" On a rigid base, with Housner's impact, it would rock by {1e3 * abs(rigid[1]):.3g} mrad and recover.",
            "no-hinging": " On a rigid base it would not rock.",
        }[rigid[0]]
    word = context.building.structure.word if context.building.structure is not None else "block"
    return (
        f"On its compliant base the {word} {said}; {count(lifts, 'time')} an edge lifts (peak ground "
        f"acceleration {context.motion.peak / GRAVITY:.3f} g; held on, {found.uplift_acceleration_g:.3f} g lift an edge and "
        f"{found.soft_base.capacity_g:.3f} g overturn it).{rigidly}"
    )
