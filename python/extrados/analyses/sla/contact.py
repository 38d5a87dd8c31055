"""Where dry joints touch and slide under the constant loads: the state from which the events start."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.sla.model import SlaModel
from extrados.analyses.sla.tables import Sla
from extrados.core import sla as core
from extrados.core.errors import CoreError, status_code
from extrados.model.errors import WHOLE

#: Rounds in which a state is looked for: without friction, with it, and from a state under a little more of it
MOST_ROUNDS, MOST_SLIDING, MOST_NEAR = 400, 60, 15
TOUCH = 1e-9  # of the greatest joint stress: less is rounding
#: Times the asked friction from which it falls, the first of them that has a state; by which part at a time
MORE_FRICTION = (1.5, 2.0, 4.0)
FALL, LEAST_FALL = 0.1, 1e-3
WORST = 0.9  # of the greatest shear stress over its strength: what begins to slide in a round
#: Rows of the damage of a point: cracked, tension tooth, shut
CRACKED, TOOTH, SHUT = 2, 3, 7
STICKS, SLIDES_UP, SLIDES_DOWN = 0.0, 1.0, 2.0


class NotCarried(Refused):
    """The constant loads lead to no state: to a mechanism, to displacements that are not small, or to the end of a limit of the run."""


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
        values = (made.friction, made.shear_stiffness, made.small) if isinstance(made, core.Joints) else (np.nan, 1.0, 1.0)
        found.append((first + at, *(np.repeat(value * each, per)[at] for value in (*values, 1.0))))
    if any(len(number) for number, *_ in found):
        bars = [group for group in model.groups if isinstance(group, core.Bars)]
        begins = np.cumsum([core_model.points - sum(len(bar.connect) for bar in bars), *(len(bar.connect) for bar in bars)])
        for bar, start in zip(bars, begins[:-1].tolist(), strict=True):
            each = np.ones(len(bar.connect))
            if bar.bears != "both":
                alike = (np.nan, 1.0, 1.0, -1.0 if bar.bears == "tension" else 1.0)
                found.append((start + np.arange(len(each)), *(value * each for value in alike)))
    return DryPoints(*(np.concatenate(column) for column in zip(*found, strict=True)))


@dataclass(frozen=True)
class Contact:
    """Of dry points: which touch, how their friction is (STICKS, SLIDES_UP, SLIDES_DOWN), and the slip at which it carries
    nothing [m]."""

    touching: np.ndarray
    mode: np.ndarray
    mark: np.ndarray

    def into(self, damage: np.ndarray, at: np.ndarray, slides: bool) -> np.ndarray:
        """The damage of all points with this one of the points `at`."""
        damage[SHUT, at] = self.touching
        if slides:
            damage[core.MARK, at], damage[core.MODE, at] = self.mark, self.mode
        return damage


def settle(core_model: core.Model, model: SlaModel, options: Sla, warnings: list[str]) -> bool:
    """Make dry joints cracks that are there from the start, and find which of their points touch and which slide under A.

    Without friction the problem has one solution, since the stiffness is positive definite with any set of open points.
    With it the state is one of those that friction may leave: where rounds from the state that only touches find none,
    friction falls from more than is asked, as in a building whose joints lose it, each state the start of the next.
    Where that finds none either, all points stick and a warning says so. True where joints can slide.
    """
    if not model.mesh.has_joints:
        return False
    dry = dry_points(core_model, model)
    at = dry.number
    if not len(at):
        return False
    damage = core_model.damage()
    joints = at[at < core_model.damage().shape[1] - sum(len(g.connect) for g in model.groups if isinstance(g, core.Bars))]
    damage[CRACKED, joints] = 1.0
    damage[TOOTH, joints] = core.MOST_TEETH + 1.0  # beyond the last tooth, whatever their number
    start = Contact(np.ones(len(at), dtype=bool), np.full(len(at), STICKS), np.zeros(len(at)))
    slides = bool(np.isfinite(dry.friction).any())
    if not slides:
        if _rounds(core_model, model, dry, damage, start, MOST_ROUNDS) is None:
            raise NotCarried(
                "the structure cannot carry the constant loads: dry joints that act only in compression cannot balance them", WHOLE
            )
        return False
    # What touches without sliding is a sound beginning
    still = _with_friction(model, np.nan)
    with still.open(options, 1) as sticking:
        settle(sticking, still, options, warnings)
        start = replace(start, touching=sticking.damage()[SHUT, at] > 0.5)
    found = _rounds(core_model, model, dry, damage, start, MOST_SLIDING)
    if found is None:
        begun = _falling_friction(model, options, damage, start)
        found = None if begun is None else _rounds(core_model, model, dry, damage, begun, MOST_NEAR)
    if found is not None:
        core_model.end_stage(1.0)
        return True
    warnings.append(
        "under the constant loads alone, no consistent set of dry joints that slide was found. The analysis therefore "
        "assumes that the joints do not slide before the reference load acts"
    )
    core_model.set_damage(start.into(damage, at, True))
    return True


def _with_friction(model: SlaModel, times: float) -> SlaModel:
    """The model with so many times the friction of its joints; NaN: none of them slides."""
    groups = [
        replace(group, friction=np.asarray(group.friction) * times) if isinstance(group, core.Joints) else group for group in model.groups
    ]
    return replace(model, groups=groups)


def _falling_friction(model: SlaModel, options: Sla, damage: np.ndarray, start: Contact) -> Contact | None:
    """The state under the asked friction, by friction that falls to it; None where that leads to none."""
    found, times = None, 1.0
    for times in MORE_FRICTION:
        found = _at(model, options, damage, start, times, MOST_SLIDING)
        if found is not None:
            break
    fall = FALL
    while found is not None and times > 1.0:
        less = max(times * (1.0 - fall), 1.0)
        further = _at(model, options, damage, found, less, MOST_NEAR)
        if further is not None:
            found, times = further, less
        elif fall > LEAST_FALL:
            fall *= 0.5
        else:
            return None
    return found


def _at(model: SlaModel, options: Sla, damage: np.ndarray, start: Contact, times: float, most: int) -> Contact | None:
    """The state under so many times the friction, from another one."""
    other = _with_friction(model, times)
    with other.open(options, 1) as core_model:
        return _rounds(core_model, other, dry_points(core_model, other), damage.copy(), start, most)


def _rounds(core_model: core.Model, model: SlaModel, dry: DryPoints, damage: np.ndarray, start: Contact, most: int) -> Contact | None:
    """Unilateral contact and friction under A by their active sets; None where the rounds end without a state.

    Points in tension open, points that overlap close, all at once, until none changes; a round that brings back an earlier
    set is followed by rounds that change the worst point alone. Points beyond their friction slide, those that turn back
    stick.
    """
    at = dry.number
    touching, mode, mark = start.touching.copy(), start.mode.copy(), start.mark.copy()
    can_slide, fresh = np.isfinite(dry.friction), np.empty(0, dtype=int)
    seen, single, first, slides = set(), False, None, bool(np.isfinite(dry.friction).any())
    for _ in range(most):
        core_model.set_damage(Contact(touching, mode, mark).into(damage, at, slides))
        try:
            core_model.loads(np.zeros_like(model.constant), model.constant)
        except CoreError as error:
            if error.status != status_code("not_positive_definite") or not slides:
                raise
            if not len(fresh):
                return None
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
                return Contact(touching, mode, mark)
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
                return Contact(touching, mode, np.where(stuck, mark, plastic))
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
    return None
