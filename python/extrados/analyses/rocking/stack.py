"""rocking of two stacked blocks (the four modes of Psycharis 1990)."""

import numpy as np

from extrados.analyses.chaos import CHAOTIC, chaos_told, growth, perturbed, turning
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.rocking.history import LARGEST, count, drawn_times
from extrados.analyses.rocking.shapes import film, pictures
from extrados.analyses.rocking.tables import Rocking
from extrados.core.stack import StackResponse, stack_history
from extrados.results import rocking as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.stack import StackModel

#: After the motion it rocks itself to rest within this many of its own time units
SETTLE = 40.0
#: Modes by the states of both contacts
MODES = ("at rest", "both in the same sense", "both against each other", "upper alone", "both as one")


def run(context: Context, options: Rocking) -> Result:
    """History, impacts, modes, energies, and the friction needed at both joints."""
    building = context.building
    model = StackModel(building.blocks())
    alpha, unit = model.whole
    end_time = options.end_time or context.motion.end + SETTLE * max(unit, model.alone[1])
    if end_time / options.output_step * 20 > LARGEST:
        raise Refused(
            f"a history of {end_time:g} s in steps of {options.output_step:g} s is too long to store", ("analysis", "output_step")
        )
    turned = building.initial.rotation_ratio * alpha
    start = (turned, turned, 0.0, 0.0)

    def rock(scale: float = 1.0) -> StackResponse:
        return stack_history(
            model.core, context.motion.ground, end_time, options.output_step, scale=scale, tolerance=options.tolerance, start=start
        )

    r = rock()
    if r.interrupted:
        return _result(context, options, model, r, 0.0, 0.0)
    probes = [rock(factor) for factor in perturbed()]
    lower = [one.rotation[:, 0] / model.whole[0] for one in (r, *probes[:2])]
    upper = [(one.rotation[:, 1] - one.rotation[:, 0]) / model.alone[0] for one in (r, *probes[:2])]
    grown = max(growth(lower), growth(upper))
    return _result(context, options, model, r, grown, turning(r.outcome, [one.outcome for one in probes]))


def modes(state: np.ndarray) -> np.ndarray:
    """Number of the mode in MODES of states of the contacts (n, 2)."""
    low, high = state.T
    return np.select([(low == 0) & (high == 0), (low != 0) & (high == low), (low != 0) & (high != 0), low == 0], [0, 1, 2, 3], 4)


def _result(context: Context, options: Rocking, model: StackModel, r: StackResponse, grown: float, turns: float) -> Result:
    energy = r.kinetic + r.potential
    scale = max(float(np.abs(energy).max(initial=0.0)), abs(r.work), 1e-300)
    normal, shear = _normal_and_shear(r)
    moving = (r.state != 0).any(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        friction = np.where(normal > 0.0, np.abs(shear) / normal, np.inf)
    flies = moving & (normal <= 0.0).any(axis=1)
    needed = np.where(flies[:, None] | ~moving[:, None], 0.0, friction)
    found = modes(r.state)
    impacts = [t for kind, t, _ in r.events if kind == "impact"]
    alpha, unit = model.whole
    result = Result("rocking", status="interrupted" if r.interrupted else "ok")
    result.reason = f"interrupted at {r.stop_time:.3f} s" if r.interrupted else ""
    uplifts = [k for kind, _, k in r.events if kind == "uplift"]
    fell = r.outcome == "collapse"
    chaotic = grown > CHAOTIC or turns > 0.0
    violated = [chaos_told(grown, turns)] if chaotic else []
    if flies.any():
        violated.append(f"A joint parts as a whole from {r.time[flies.argmax()]:.3f} s on: rocking without flight is assumed. Use dem.")
    result.results = out.Rocking(
        rotation_of="the lower block",
        outcome=r.outcome,
        settled=r.settled,
        collapse_half_cycle=len(uplifts) + len(impacts) if fell else None,
        collapse_time_s=r.stop_time if fell else None,
        half_cycles=len(uplifts) + len(impacts),
        impacts=sum(r.impacts),
        impact_times_s=impacts,
        peak_rotation_rad=r.peak[0],
        peak_rotation_ratio=_greatest(model, r),
        peak_ground_acceleration_g=context.motion.peak / GRAVITY,
        energy_supplied_J=r.work,
        energy_lost_at_impacts_J=r.loss,
        energy_residual_ratio=float(np.abs(energy - energy[:1] - r.ledger).max(initial=0.0)) / scale,
        steps=r.steps,
        rejected_steps=0,
        restitution=_as_one(model),
        critical_rotation_rad=alpha,
        frequency_parameter_rad_s=1.0 / unit,
        uplift_acceleration_g=min(model.uplift),
        required_friction=float(needed.max(initial=0.0)),
        decided_by_last_digits=chaotic,
        perturbation_growth=grown,
        violated=violated,
        stack=out.StackRocking(
            peak_rotation_upper_rad=r.peak[1],
            critical_rotation_upper_rad=model.alone[0],
            uplift_as_one_g=model.uplift[0],
            uplift_upper_g=model.uplift[1],
            impacts_on_ground=r.impacts[0],
            impacts_between=r.impacts[1],
            modes=[
                out.ModeShare(mode=name, share=float((found[moving] == k).mean())) for k, name in enumerate(MODES) if k and moving.any()
            ],
        ),
    )
    result.warnings += violated
    if not r.settled and not r.interrupted:
        result.warnings.append(f"the blocks still rock at the end time of {r.stop_time:g} s: the outcome is open, set a longer end_time")
    index = drawn_times(r.time, r.rotation.T, options)
    result.tables["rocking"] = TableData(
        {
            "time": r.time,
            "rotation": r.rotation[:, 0],
            "rotation_upper": r.rotation[:, 1],
            "ground_acceleration": r.ground,
            "vertical_acceleration": r.vertical,
            "kinetic_energy": r.kinetic,
            "potential_energy": r.potential,
            "energy_supplied_less_lost": r.ledger,
            "mode": np.array(MODES)[found],
            "required_friction": needed.max(axis=1) if len(needed) else np.zeros(0),
        },
        {
            "time": "s",
            "rotation": "rad",
            "rotation_upper": "rad",
            "ground_acceleration": "m/s^2",
            "vertical_acceleration": "m/s^2",
            "kinetic_energy": "J",
            "potential_energy": "J",
            "energy_supplied_less_lost": "J",
        },
    )
    result.arrays = {
        "time": Array(r.time, ("time",), "s", "output times"),
        "rotation": Array(r.rotation[:, 0], ("time",), "rad", "rotation of the lower block, positive to +x"),
        "rotation_upper": Array(r.rotation[:, 1], ("time",), "rad", "rotation of the upper block, positive to +x"),
        "mode": Array(found, ("time",), "", ", ".join(f"{k} {name}" for k, name in enumerate(MODES))),
        "ground": Array(r.ground, ("time",), "m/s^2", "horizontal ground acceleration"),
        "vertical": Array(r.vertical, ("time",), "m/s^2", "vertical ground acceleration"),
        "kinetic": Array(r.kinetic, ("time",), "J"),
        "potential": Array(r.potential, ("time",), "J"),
        "ledger": Array(r.ledger, ("time",), "J", "work done by the ground motion, minus the energy lost at impacts"),
        "impact_time": Array(np.array(impacts), ("impact",), "s"),
        "required_friction": Array(needed, ("time", "joint"), "", "coefficient of friction needed"),
        **geometry_arrays(model.assembly),
        "snapshot_time": Array(r.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(
            model.pose(r.rotation[index], r.state[index]), ("snapshot", "block", "component"), "m, m, rad", "x, y, rotation"
        ),
    }
    if options.animation != "none" and len(r.time):
        shown = pictures(r.time)
        result.arrays |= film(r.time[shown], model.pose(r.rotation[shown], r.state[shown]))
    how = {"collapse": "collapses", "recovery": "rocks and recovers", "no-hinging": "does not rock"}[r.outcome]
    shares = sorted(((float((found[moving] == k).mean()), name) for k, name in enumerate(MODES) if k), reverse=True) if moving.any() else []
    result.answer = (
        f"The stack {how}"
        + (
            f": lower block {1e3 * abs(r.peak[0]):.3g} mrad, upper {1e3 * abs(r.peak[1]):.3g} mrad at most, {count(r.impacts[0], 'impact')} on "
            f"the ground and {r.impacts[1]} between, {100 * shares[0][0]:.0f} % of the rocking time {shares[0][1]}."
            if shares
            else "."
        )
        + f" Both as one begin to rock at {model.uplift[0]:.3f} g, the upper alone at {model.uplift[1]:.3f} g."
    )
    return result


def _greatest(model: StackModel, r: StackResponse) -> float:
    """Greatest rotation over the critical one: of the lower block as one with the upper, of the upper against the lower."""
    if not len(r.time):
        return 0.0
    own = np.abs(r.rotation[:, 0]).max() / model.whole[0]
    return float(max(own, np.abs(r.rotation[:, 1] - r.rotation[:, 0]).max() / model.alone[0]))


def _as_one(model: StackModel) -> float:
    """c_v of Housner of both as one block."""
    s = model.core
    m, c = np.array(s.mass), np.array(s.centre) + np.array([0.0, s.height])
    around = sum(s.inertia) + float(m @ c**2)
    share = s.half_foot**2 * m.sum()
    return max(0.0, float((around - share) / (around + share)))


def _normal_and_shear(r: StackResponse) -> tuple[np.ndarray, np.ndarray]:
    """Forces across both joints (times, 2) [N]; the joint between turns with the lower block."""
    c, s = np.cos(r.rotation[:, 0]), np.sin(r.rotation[:, 0])
    x, y = r.force[:, 1].T
    return np.column_stack([r.force[:, 0, 1], s * x + c * y]), np.column_stack([r.force[:, 0, 0], c * x - s * y])
