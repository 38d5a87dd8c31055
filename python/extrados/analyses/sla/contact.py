"""Where dry joints touch under the constant loads: the state from which the events start."""

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.sla.model import SlaModel
from extrados.core import sla as core

MOST_ROUNDS = 200
TOUCH = 1e-9  # of the greatest joint stress: less is rounding
FIRST_DIRECTION = (2, 3, 7)  # rows of the damage: crack fixed, tension tooth, shut


def dry_points(core_model: core.Model, model: SlaModel) -> np.ndarray:
    """Integration points of dry joints, from 0."""
    found = [np.empty(0, dtype=int)]
    for group, (_, first, per) in zip(model.mesh.groups, core_model.plane_points, strict=True):
        if group.dry is not None:
            found.append(first + np.flatnonzero(np.repeat(group.dry, per)))
    return np.concatenate(found)


def settle(core_model: core.Model, model: SlaModel) -> None:
    """Make dry joints cracks that are there from the start, and find which of their points touch under A.

    Unilateral contact by its active set: points in tension open, points that overlap close, all at once, until none
    changes. The problem has one solution, since the stiffness is positive definite with any set of open points; a round
    that brings back an earlier set is followed by rounds that change the worst point alone.
    """
    dry = dry_points(core_model, model)
    if not len(dry):
        return
    damage = core_model.damage()
    cracked, tooth, shut = FIRST_DIRECTION
    damage[cracked, dry] = 1.0
    damage[tooth, dry] = core.MOST_TEETH + 1.0  # beyond the last tooth, whatever their number
    damage[shut, dry] = 1.0
    touching = np.ones(len(dry), dtype=bool)
    seen, single, first = set(), False, None
    for _ in range(MOST_ROUNDS):
        damage[shut, dry] = touching
        core_model.set_damage(damage)
        core_model.loads(np.zeros_like(model.constant), model.constant)
        report = core_model.report(1.0)
        stress = report["stress_n"][dry] / np.where(touching, 1.0, core_model.behaviour.floor)
        noise = TOUCH * float(np.abs(stress[touching]).max(initial=0.0))
        wrong = np.where(touching, stress > noise, stress < -noise)
        # Work of A: the more open points, the more; what only the remains of open joints hold, moves far
        work = float((model.constant * core_model.displacement(1.0)).sum())
        first = work if first is None else first
        if not wrong.any():
            if work > model.mechanism_ratio * first:
                break
            return
        state = touching.tobytes()
        single |= state in seen
        seen.add(state)
        if single:
            wrong &= np.arange(len(dry)) == int(np.where(wrong, np.abs(stress), -1.0).argmax())
        touching = touching ^ wrong
    raise Refused(
        "the constant loads are not carried: dry joints that only press cannot balance them, the stones would fall; "
        "limit analysis (tilt) says by how much"
    )
