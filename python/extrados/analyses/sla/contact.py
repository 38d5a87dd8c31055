"""Where dry joints touch and slide under the constant loads: the state from which the events start."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.sla.model import SlaModel
from extrados.analyses.sla.tables import Sla
from extrados.core import sla as core
from extrados.core.errors import CoreError, status_code

MOST_ROUNDS = 400
TOUCH = 1e-9  # of the greatest joint stress: less is rounding
WORST = 0.9  # of the greatest shear stress over its strength: what begins to slide in a round
#: Rows of the damage of a point: cracked, tension tooth, shut
CRACKED, TOOTH, SHUT = 2, 3, 7
STICKS, SLIDES_UP, SLIDES_DOWN = 0.0, 1.0, 2.0


@dataclass(frozen=True)
class DryPoints:
    """Integration points of dry joints, from 0; their friction (NaN: no sliding), shear stiffness [Pa/m] and the stress
    that counts as small [Pa]. Ties and struts that go slack are such points, too: `sense` is -1 of what bears tension,
    else +1."""

    number: np.ndarray
    friction: np.ndarray
    stiffness: np.ndarray
    small: np.ndarray
    sense: np.ndarray


def dry_points(core_model: core.Model, model: SlaModel) -> DryPoints:
    """The points of joints without tensile strength."""
    found = [(np.empty(0, dtype=int), *(np.empty(0) for _ in range(4)))]
    for group, (made, first, per) in zip(model.mesh.groups, core_model.plane_points, strict=True):
        if group.dry is None:
            continue
        at = np.flatnonzero(np.repeat(group.dry, per))
        each = np.ones(len(group.dry))
        values = (
            (made.friction, made.shear_stiffness, made.small) if isinstance(made, core.Joints) else (np.nan, 1.0, 1.0)
        )
        found.append((first + at, *(np.repeat(value * each, per)[at] for value in (*values, 1.0))))
    if any(len(number) for number, *_ in found):
        bars = [group for group in model.groups if isinstance(group, core.Bars)]
        first = np.cumsum(
            [core_model.points - sum(len(bar.connect) for bar in bars), *(len(bar.connect) for bar in bars)]
        )
        for bar, start in zip(bars, first[:-1].tolist(), strict=True):
            each = np.ones(len(bar.connect))
            if bar.bears != "both":
                values = (np.nan, 1.0, 1.0, -1.0 if bar.bears == "tension" else 1.0)
                found.append((start + np.arange(len(each)), *(value * each for value in values)))
    return DryPoints(*(np.concatenate(column) for column in zip(*found, strict=True)))


def settle(core_model: core.Model, model: SlaModel, options: Sla, warnings: list[str]) -> bool:
    """Make dry joints cracks that are there from the start, and find which of their points touch and which slide under A.

    Unilateral contact by its active set: points in tension open, points that overlap close, all at once, until none
    changes. Without friction the problem has one solution, since the stiffness is positive definite with any set of open
    points; a round that brings back an earlier set is followed by rounds that change the worst point alone. Then points
    beyond their friction slide; the solution is one of those that friction may leave. Where the rounds find none, all points stick and a warning says so.
    True where joints can slide.
    """
    if not model.mesh.has_joints:
        return False
    dry = dry_points(core_model, model)
    at = dry.number
    if not len(at):
        return False
    damage = core_model.damage()
    joints = at[
        at < core_model.damage().shape[1] - sum(len(g.connect) for g in model.groups if isinstance(g, core.Bars))
    ]
    damage[CRACKED, joints] = 1.0
    damage[TOOTH, joints] = core.MOST_TEETH + 1.0  # beyond the last tooth, whatever their number
    touching, mode = np.ones(len(at), dtype=bool), np.full(len(at), STICKS)
    mark = np.zeros(len(at))
    can_slide, fresh = np.isfinite(dry.friction), np.empty(0, dtype=int)
    seen, single, first, slides, sticking = set(), False, None, can_slide.any(), damage
    if slides:
        # What touches without sliding is a sound beginning
        groups = [replace(g, friction=np.nan) if isinstance(g, core.Joints) else g for g in model.groups]
        with replace(model, groups=groups).open(options, 1) as still:
            settle(still, replace(model, groups=groups), options, warnings)
            touching = still.damage()[SHUT, at] > 0.5
        damage[SHUT, at] = touching
        sticking = damage.copy()
    for _ in range(MOST_ROUNDS):
        damage[SHUT, at] = touching
        if can_slide.any():
            damage[core.MARK, at], damage[core.MODE, at] = mark, mode
        core_model.set_damage(damage)
        try:
            core_model.loads(np.zeros_like(model.constant), model.constant)
        except CoreError as error:
            if error.status != status_code("not_positive_definite") or not len(fresh):
                raise
            # All that slide at once drift off: the worst of those that began alone; if that drifts too, it sticks
            mode[fresh[1:] if len(fresh) > 1 else fresh] = STICKS
            can_slide[fresh] &= len(fresh) > 1
            fresh = fresh[:1] if len(fresh) > 1 else fresh[:0]
            continue
        report = core_model.report(1.0)
        stress = dry.sense * report["stress_n"][at] / np.where(touching, 1.0, core_model.behaviour.floor)
        noise = TOUCH * float(np.abs(stress[touching]).max(initial=0.0))
        wrong = np.where(touching, stress > noise, stress < -noise)
        # Work of A: the more open points, the more; what only the remains of open joints hold, moves far
        work = float((model.constant * core_model.displacement(1.0)).sum())
        first = work if first is None else first
        if not wrong.any():
            if work > model.mechanism_ratio * first:
                break
            if not slides:
                return False
        if slides:
            strength = np.where(touching & can_slide, -dry.friction * stress, 0.0)
            slip, tau = report["strain_ns"][at], report["stress_ns"][at]
            stuck = mode == STICKS
            sense = np.where(mode == SLIDES_DOWN, -1.0, 1.0)
            begins = can_slide & touching & stuck & (np.abs(tau) > strength + dry.small)
            # The worst first: a stone all of whose points slid at once, each its way, would drift off
            beyond = np.where(begins, np.abs(tau) / (strength + dry.small), 0.0)
            begins &= beyond >= WORST * beyond.max()
            plastic = slip - tau / dry.stiffness
            back = touching & ~stuck & (sense * (plastic - mark) < 0.0)
            if not (wrong | begins | back).any():
                core_model.end_stage(1.0)
                return True
            fresh = np.flatnonzero(begins)[np.argsort(-beyond[begins])]
            mark = np.where(back, plastic, mark)
            mode = np.where(begins, np.where(tau > 0.0, SLIDES_UP, SLIDES_DOWN), np.where(back, STICKS, mode))
            mode = np.where(wrong, STICKS, mode)
            mark = np.where(wrong, np.where(touching, mark, slip), mark)
        state = touching.tobytes()
        single |= wrong.any() and state in seen
        seen.add(state)
        if single and wrong.any():
            wrong &= np.arange(len(at)) == int(np.where(wrong, np.abs(stress), -1.0).argmax())
        touching = touching ^ wrong
    if slides:
        warnings.append(
            "which dry joints slide under the constant loads alone was not found: they stick there, and slide only as the "
            "reference load asks for it"
        )
        core_model.set_damage(sticking)
        return True
    raise Refused(
        "the constant loads are not carried: dry joints that only press cannot balance them, the stones would "
        "fall; limit analysis (tilt) says by how much"
    )
