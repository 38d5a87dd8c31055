"""rocking of a block on a compliant base without tension (Psycharis and Jennings 1983)."""

from typing import Any

import numpy as np

from extrados.analyses.chaos import growth, growth_step, over_critical, perturbed, turning, violated_by_chaos
from extrados.analyses.context import Context
from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.rocking.conditions import demand_of
from extrados.analyses.rocking.course import Course, build_result, keep_events, refuse_long_history
from extrados.analyses.rocking.history import count
from extrados.analyses.rocking.shapes import course_arrays
from extrados.analyses.rocking.tables import Rocking
from extrados.core.rocking import FAILED, OUTCOMES, Ensemble, Outcome, ensemble
from extrados.core.soft_base import SoftBaseResponse, soft_base_history, soft_base_start
from extrados.results import rocking as out
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.rocker import Rocker
from extrados.views.rockers.soft_base import UNDAMPED, SoftBaseModel

#: After the motion it rocks within this many of the block's own time units 1/p
SETTLE = 30.0
#: A base that presses with less than this share of the weight lets the block fly (fortran/rocking/soft_base_response.f90)
FLIES = 0.01


def run(context: Context, options: Rocking) -> Result:
    """History, edges that lift and land, energies, pressures, friction needed, and the outcome on a rigid base."""
    building = context.building
    rocker = building.rocker(options.form == "linear", soft_base=True)
    model = rocker.model
    assert isinstance(model, SoftBaseModel)
    if building.structure is not None and building.structure.kind == "column":
        context.warnings.append("the column is modelled as one rigid body; use `dem` for joints that open")
    if not model.core.damping:
        context.warnings.append(UNDAMPED)
    end_time = options.end_time or context.motion.end + SETTLE / float(model.rigid.frequency.min())
    refuse_long_history(end_time, options.output_step, 20)
    start = soft_base_start(model.core, model.turned(building.initial.rotation_ratio))
    settings: dict[str, Any] = {"tolerance": options.tolerance, "start": start}

    def rock(step: float, scale: float = 1.0) -> SoftBaseResponse:
        return keep_events(
            lambda room: soft_base_history(model.core, context.motion.ground, end_time, step, scale=scale, room=room, **settings)
        )

    r = rock(options.output_step)
    grown, turns = 0.0, 0.0
    rigid: tuple[Outcome, float] | None = None
    if not r.interrupted:
        step = growth_step(rocker.time_unit, end_time)
        own, *probes = [rock(step, factor) for factor in (1.0, *perturbed())]
        critical = (model.critical(1), -model.critical(-1))
        grown = growth([over_critical(one.rotation, critical) for one in (own, *probes[:2])])
        turns = turning(r.outcome, [one.outcome for one in probes])
        rigid = _on_rigid_base(context, options, model, end_time)
    seen = demand_of(rocker, context.motion.ground, end_time, options.tolerance)
    result = _result(context, rocker, r, seen, (grown, turns), rigid)
    result.arrays |= {
        **geometry_arrays(model.block),
        **course_arrays(options, r.time, r.rotation[None], lambda index: model.pose(r.rotation[index], r.sinking[index])),
    }
    result.answer = _answer(context, model, r, result.of(out.Rocking), rigid)
    return result


def _on_rigid_base(context: Context, options: Rocking, model: SoftBaseModel, end_time: float) -> tuple[Outcome, float] | None:
    """Outcome and greatest rotation [rad] on a rigid base with Housner's impact; None without a result."""
    ratio = context.building.initial.rotation_ratio
    side = 0 if ratio >= 0.0 else 1
    found = ensemble(
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
    return None if found.interrupted or found.outcome[0] == FAILED else (OUTCOMES[found.outcome[0]], float(found.peak[0]))


def _result(
    context: Context, rocker: Rocker, r: SoftBaseResponse, seen: Ensemble, chaos: tuple[float, float], rigid: tuple[Outcome, float] | None
) -> Result:
    """Results on the compliant base; seen: the same run by the steps of the core; chaos: growth of a perturbation, and the least one that
    changes the outcome."""
    model = rocker.model
    assert isinstance(model, SoftBaseModel)
    potential = r.potential - model.potential(model.rest)
    energy = r.kinetic + potential
    critical = model.critical(1), model.critical(-1)
    flies = r.force[:, 1] < FLIES * model.weight
    friction = np.where(flies, 0.0, np.abs(r.force[:, 0]) / np.maximum(r.force[:, 1], 1e-300))
    needed = float(seen.joints.friction[0])
    violated = violated_by_chaos(*chaos)
    course = Course(
        of="the block",
        settled=bool(seen.settled[0]),
        moves="the block can still overturn",
        half_cycles=r.half_cycles,
        potential=potential,
        energy=energy,
        scale=max(float(np.ptp(energy)) if len(energy) else 0.0, abs(r.work), 1e-300),
        lost="the energy absorbed by the compliant base",
        friction=friction[:, None],
        coordinates={"rotation": (r.rotation, "rad"), "rotation_rate": (r.rate, "rad/s"), "sinking": (r.sinking, "m")},
        further={"force_up": (r.force[:, 1], "N")},
        event_value="edge that lifts or lands: -1 left, 1 right",
        chaotic=bool(violated),
        growth=chaos[0],
        violated=violated,
    )
    result = build_result(
        context,
        r,
        course,
        impacts=sum(r.landings),
        peak_rotation_rad=r.peak[0],
        peak_rotation_ratio=float(abs(r.peak[0] / critical[0 if r.peak[0] >= 0.0 else 1])),
        energy_lost_at_impacts_J=0.0,
        restitution=None,
        critical_rotation_rad=critical[0],
        critical_rotation_left_rad=-critical[1],
        frequency_parameter_rad_s=float(model.rigid.frequency[0]),
        uplift_acceleration_g=min(model.uplift(1), model.uplift(-1)),
        required_friction=needed if np.isfinite(needed) else None,
        soft_base=_base_results(model, r, flies, rigid),
    )
    result.warnings += violated
    if rigid is not None and rigid[0] != r.outcome:
        result.warnings.append(f"on a rigid base (impact rule of Housner), the outcome is different: {rigid[0]}")
    pressed = np.where(flies[:, None], np.nan, r.range)
    result.arrays |= {
        "rotation": Array(r.rotation, ("time",), "rad", "rotation of the block, positive to +x"),
        "rate": Array(r.rate, ("time",), "rad/s"),
        "sinking": Array(r.sinking, ("time",), "m", "settlement of the base below the centre of the block"),
        "pressed": Array(
            pressed,
            ("time", "end"),
            "m",
            "both ends of the part of the base that is in contact, measured from the point below the centre of the block",
        ),
    }
    return result


def _base_results(model: SoftBaseModel, r: SoftBaseResponse, flies: np.ndarray, rigid: tuple[Outcome, float] | None) -> out.SoftBaseRocking:
    """Results of the base; flies: whether the block is airborne (times)."""
    lifted = r.range[:, 1] - r.range[:, 0] < (1.0 - 1e-9) * (model.core.toe_left + model.core.toe_right)
    most = float(r.most.max(initial=0.0))
    force = {"greatest_pressure_Pa": most / model.block.depth}
    if model.core.edges:
        far = np.stack([-model.core.toe_left * np.ones_like(r.rotation), model.core.toe_right * np.ones_like(r.rotation)])
        sine = r.rotation if model.core.linear else np.sin(r.rotation)
        lifted = (r.sinking + far * sine < 0.0).any(axis=0)
        force = {"greatest_edge_force_N": most}
    rocking, vertical = model.periods
    return out.SoftBaseRocking(
        foundation="two-spring" if model.core.edges else "winkler",
        rocking_period_s=rocking,
        vertical_period_s=vertical,
        sinking_at_rest_m=model.sinking(model.rest),
        lift_rotation_rad=min(model.lifted(1), -model.lifted(-1)),
        capacity_g=min(model.capacity(1), model.capacity(-1)),
        peak_sinking_m=r.peak[1],
        lifted_share=float(lifted.mean()) if len(lifted) else 0.0,
        free_share=float(flies.mean()) if len(flies) else 0.0,
        energy_taken_up_J=r.spent,
        rigid_outcome=rigid[0] if rigid else None,
        rigid_peak_rotation_rad=rigid[1] if rigid else None,
        **force,
    )


def _answer(context: Context, model: SoftBaseModel, r: SoftBaseResponse, found: out.Rocking, rigid: tuple[Outcome, float] | None) -> str:
    """The outcome in words."""
    way = "+x" if r.peak[0] > 0 else "-x"
    greatest = (
        f"greatest rotation {1e3 * abs(r.peak[0]):.3g} mrad to {way}, {100 * found.peak_rotation_ratio:.0f} % of the "
        "rotation from which gravity causes collapse"
    )
    said = {
        "collapse": f"overturns to {way}: from {r.stop_time:.2f} s on, the block can no longer recover",
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
            "collapse": " On a rigid base, with Housner's impact, the block would overturn.",
            "recovery": f" On a rigid base, with Housner's impact, the block would rock by {1e3 * abs(rigid[1]):.3g} mrad and recover.",
            "no-hinging": " On a rigid base, the block would not rock.",
        }[rigid[0]]
    word = context.building.structure.word if context.building.structure is not None else "block"
    return (
        f"On its compliant base the {word} {said}. An edge lifts {count(lifts, 'time')}. The peak ground "
        f"acceleration is {context.motion.peak / GRAVITY:.3f} g. A constant acceleration of {found.uplift_acceleration_g:.3f} "
        f"g lifts an edge, and a constant acceleration of {found.soft_base.capacity_g:.3f} g overturns the block.{rigidly}"
    )
