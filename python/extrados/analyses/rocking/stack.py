"""rocking of two stacked blocks (the four modes of Psycharis 1990)."""

from typing import Any

import numpy as np

from extrados.analyses.chaos import growth, growth_step, perturbed, turning, violated_by_chaos
from extrados.analyses.context import Context
from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.rocking.conditions import demand_of
from extrados.analyses.rocking.course import Course, build_result, keep_events, refuse_long_history
from extrados.analyses.rocking.history import count
from extrados.analyses.rocking.shapes import course_arrays
from extrados.analyses.rocking.tables import Rocking
from extrados.core.stack import StackResponse, stack_history
from extrados.results import rocking as out
from extrados.results.model import Array, Result
from extrados.views.rockers.stack import StackModel

#: After the motion it rocks itself to rest within this many of its own time units
SETTLE = 40.0
#: Modes by the states of both contacts
MODES = ("at rest", "both in the same sense", "both against each other", "upper alone", "both as one")


def run(context: Context, options: Rocking) -> Result:
    """History, impacts, modes, energies, and the friction needed at both joints."""
    building = context.building
    rocker = building.rocker(options.form == "linear", soft_base=True)
    model = rocker.model
    assert isinstance(model, StackModel)
    end_time = options.end_time or context.motion.end + SETTLE * rocker.time_unit
    refuse_long_history(end_time, options.output_step, 20)
    turned = rocker.start_rotation
    settings: dict[str, Any] = {"tolerance": options.tolerance, "start": (turned, turned, 0.0, 0.0)}

    def rock(step: float, scale: float = 1.0) -> StackResponse:
        return keep_events(
            lambda room: stack_history(model.core, context.motion.ground, end_time, step, scale=scale, room=room, **settings)
        )

    r = rock(options.output_step)
    grown, turns = 0.0, 0.0
    if not r.interrupted:
        step = growth_step(rocker.time_unit, end_time)
        own, *probes = [rock(step, factor) for factor in (1.0, *perturbed())]
        lower = [one.rotation[:, 0] / model.whole[0] for one in (own, *probes[:2])]
        upper = [(one.rotation[:, 1] - one.rotation[:, 0]) / model.alone[0] for one in (own, *probes[:2])]
        grown = max(growth(lower), growth(upper))
        turns = turning(r.outcome, [one.outcome for one in probes])
    needed = float(demand_of(rocker, context.motion.ground, end_time, options.tolerance).joints.friction[0])
    result = _result(context, model, r, needed, grown, turns)
    result.arrays |= {
        **geometry_arrays(model.assembly),
        **course_arrays(options, r.time, r.rotation.T, lambda index: model.pose(r.rotation[index], r.state[index])),
    }
    result.answer = _answer(model, r)
    return result


def modes(state: np.ndarray) -> np.ndarray:
    """Number of the mode in MODES of states of the contacts (n, 2)."""
    low, high = state.T
    return np.select([(low == 0) & (high == 0), (low != 0) & (high == low), (low != 0) & (high != 0), low == 0], [0, 1, 2, 3], 4)


def _result(context: Context, model: StackModel, r: StackResponse, needed: float, grown: float, turns: float) -> Result:
    """Results of the stack; needed: friction by the steps of the core; grown, turns: growth of a perturbation, and the least one that
    changes the outcome."""
    energy = r.kinetic + r.potential
    found = modes(r.state)
    alpha, unit = model.whole
    violated = violated_by_chaos(grown, turns)
    chaotic = bool(violated)
    course = Course(
        of="the lower block",
        settled=r.settled,
        moves="the blocks still rock",
        half_cycles=r.half_cycles,
        potential=r.potential,
        energy=energy,
        scale=max(float(np.abs(energy).max(initial=0.0)), abs(r.work), 1e-300),
        lost="the energy lost at impacts",
        friction=_required_friction(r),
        coordinates={"rotation": (r.rotation[:, 0], "rad"), "rotation_upper": (r.rotation[:, 1], "rad")},
        further={"mode": (np.array(MODES)[found], "")},
        event_value="contact at which the event occurs: 1 on the ground, 2 between the blocks",
        chaotic=chaotic,
        growth=grown,
        violated=violated,
    )
    result = build_result(
        context,
        r,
        course,
        impacts=sum(r.impacts),
        peak_rotation_rad=r.peak[0],
        peak_rotation_ratio=_greatest(model, r),
        energy_lost_at_impacts_J=r.loss,
        restitution=_as_one(model),
        critical_rotation_rad=alpha,
        frequency_parameter_rad_s=1.0 / unit,
        uplift_acceleration_g=min(model.uplift),
        required_friction=needed if np.isfinite(needed) else None,
        stack=out.StackRocking(
            peak_rotation_upper_rad=r.peak[1],
            critical_rotation_upper_rad=model.alone[0],
            uplift_as_one_g=model.uplift[0],
            uplift_upper_g=model.uplift[1],
            impacts_on_ground=r.impacts[0],
            impacts_between=r.impacts[1],
            modes=[out.ModeShare(mode=name, share=share) for name, share in _shares(r)],
        ),
    )
    result.warnings += violated
    result.arrays |= {
        "rotation": Array(r.rotation[:, 0], ("time",), "rad", "rotation of the lower block, positive to +x"),
        "rotation_upper": Array(r.rotation[:, 1], ("time",), "rad", "rotation of the upper block, positive to +x"),
        "mode": Array(found, ("time",), "", ", ".join(f"{k} {name}" for k, name in enumerate(MODES))),
    }
    return result


def _answer(model: StackModel, r: StackResponse) -> str:
    """The outcome in words."""
    how = {"collapse": "collapses", "recovery": "rocks and recovers", "no-hinging": "does not rock"}[r.outcome]
    shares = sorted(((share, name) for name, share in _shares(r)), reverse=True)
    rocked = (
        (
            f": greatest rotation {1e3 * abs(r.peak[0]):.3g} mrad of the lower block and {1e3 * abs(r.peak[1]):.3g} mrad of "
            f"the upper block, {count(r.impacts[0], 'impact')} on the ground and {r.impacts[1]} between the blocks, "
            f"{100 * shares[0][0]:.0f} % of the rocking time {shares[0][1]}."
        )
        if shares
        else "."
    )
    return (
        f"The stack {how}{rocked} Rocking of both blocks as one body starts at {model.uplift[0]:.3f} g, and rocking of "
        f"the upper block alone at {model.uplift[1]:.3f} g."
    )


def _shares(r: StackResponse) -> list[tuple[str, float]]:
    """Each mode with its share of the rocking time; empty if the stack does not rock."""
    moving = (r.state != 0).any(axis=1)
    found = modes(r.state)[moving]
    return [(name, float((found == k).mean())) for k, name in enumerate(MODES) if k] if moving.any() else []


def _required_friction(r: StackResponse) -> np.ndarray:
    """Coefficient of friction needed at both joints while the stack rocks (times, 2), 0 where a joint is airborne."""
    normal, shear = _normal_and_shear(r)
    moving = (r.state != 0).any(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        friction = np.where(normal > 0.0, np.abs(shear) / normal, np.inf)
    still = (normal <= 0.0).any(axis=1) | ~moving
    return np.where(still.reshape(-1, 1), 0.0, friction)


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
