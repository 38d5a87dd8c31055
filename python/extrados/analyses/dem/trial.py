"""The run that a deck asks for: options of the core, movements of supports, the start, and the same with other joints."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.job import Runs, Task
from extrados.analyses.dem.measures import Collapse, farthest_move
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.settlement import farthest_settlement
from extrados.analyses.dem.tables import Dem
from extrados.core import dem
from extrados.core.dem_run import SupportMove
from extrados.core.ground import Ground
from extrados.model.errors import NoView
from extrados.model.structures.block import BlockAssembly
from extrados.views.rockers.mechanism import MechanismModel


@dataclass(frozen=True)
class Begin:
    """A run that does not begin at rest: its time [s] by the clock of the motion; state: displacements and velocities (bodies, 3)
    [m, m, rad] of all bodies then, under the motion times a factor."""

    time: float
    state: Callable[[float], tuple[np.ndarray, np.ndarray]]


def domain_of(model: Model, options: Dem | None = None, far: float = 0.0) -> tuple[float, float, float, float]:
    """Least and greatest x and y [m] beyond which a block is no longer followed; options: default those of the table; far: how far
    supports move [m]."""
    outline = np.concatenate(model.assembly.outlines)
    reach = (options or Dem(kind="dem")).domain * model.size + far
    (left, low), (right, high) = (outline.min(axis=0) - reach).tolist(), (outline.max(axis=0) + reach).tolist()
    return left, right, low, high


def core_options(context: Context, options: Dem, model: Model, begin: float = 0.0, far: float = 0.0) -> dem.Options:
    """Options of the core for a run of this deck; begin: its time by the clock of the motion [s]; far: how far supports move [m]."""
    moved = [m.start + m.duration for m in context.building.initial.movements]
    quiet = max([context.motion.end if context.deck.motion else 0.0, *moved])
    return dem.Options(
        end_time=(options.end_time or quiet + dem_model.settle_time(model)) - begin,
        output_step=options.output_step,
        step=options.time_step or 0.0,
        fraction=options.step_fraction(space=False),
        settle_damping=model.values.settle_damping,
        domain=domain_of(model, options, far),
        stop_at_rest=options.end_time is None,
        moving_base=options.base == "moving",
        mass_damping=options.mass_damping,
        rigid=options.rigid,
        rebound=options.rebound,
        quasi_static=options.quasi_static,
        **(Collapse.of(options.collapse_displacement, model.size).beyond(far).options if options.stop_at_collapse else {}),
    )


def _moves(context: Context, model: Model) -> tuple[SupportMove, ...]:
    """Movements of supports, by the names of joints on them."""
    found = []
    for k, (j, one) in enumerate(zip(context.building.moved(), context.building.initial.movements, strict=True)):
        pair = model.rigid.joints[j]
        if pair is None or max(pair) < model.rigid.count:
            raise Refused(f"joint '{one.joint}' is not on the ground: name a joint at a support", ("initial", "movements", k, "joint"))
        found.append(SupportMove(max(pair), (one.dx, one.dy, float(np.radians(one.turn))), one.start, one.duration))
    return tuple(found)


def start(context: Context, model: Model) -> np.ndarray | None:
    """Initial displacements (bodies, 3) [m, m, rad] of a structure that starts rotated; None: from rest.

    A block turns about a toe, any other structure takes the pose of its collapse mechanism to that side. Refused
    where it has none.
    """
    ratio = context.building.initial.rotation_ratio
    block = model.assembly
    if not ratio:
        return None
    side = 0 if ratio > 0.0 else 1
    if isinstance(block, BlockAssembly):
        return about_a_toe(block, side, ratio, len(model.rigid.mass))
    try:
        mechanism = MechanismModel(block)
        pose = mechanism.pose([ratio * mechanism.critical[side]])[0]
    except NoView as error:
        raise Refused(f"`rotation_ratio` requires a collapse mechanism: {error}", ("initial", "rotation_ratio")) from None
    shift = np.zeros((len(model.rigid.mass), 3))  # the supports stay
    shift[: len(pose)] = pose
    shift[: len(pose), :2] -= block.centroid
    return shift


def about_a_toe(block: BlockAssembly, side: int, ratio: float, bodies: int) -> np.ndarray:
    """Displacements (bodies, 3) [m, m, rad] of a block that has turned about a toe by a share of its critical angle."""
    turn = -ratio * block.alpha[side]  # positive to +x is clockwise
    toe = block.q[0] if side == 0 else block.p[0]
    arm = block.centroid[0] - toe
    c, s = np.cos(turn), np.sin(turn)
    shift = np.zeros((bodies, 3))
    shift[0, :2] = np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]]) - arm
    shift[0, 2] = turn
    return shift


class Trial:
    """What a deck's motion does to its model, with any joint values; from rest or from another beginning."""

    def __init__(self, context: Context, options: Dem, model: Model, begin: Begin | None = None):
        self.model = model
        self.begin = begin
        self.places = options.thrust
        self.starts = begin.time if begin else 0.0
        self.moves = () if begin else _moves(context, model)  # a rocking structure feels them as motion of its ground
        self.options = core_options(context, options, model, self.starts, farthest_move(self.moves, 2))
        self.collapse = Collapse.of(options.collapse_displacement, model.size)
        self.ground: Ground | None = context.motion.ground.seen_from(self.starts) if context.deck.motion else None
        self.shift = None if begin else start(context, model)

    @property
    def idle(self) -> bool:
        """Does nothing move it?"""
        return self.ground is None and not self.moves and self.shift is None

    def job(self, values: list[JointValues], factor: float = 1.0, **change: Any) -> Runs:
        """A run with each of these joint values; what moves the building times a factor; `change` replaces options of the core."""
        options = replace(self.options, **change)
        shift, rate = (None if self.shift is None else factor * self.shift), None
        if self.begin:
            shift, rate = self.begin.state(factor)
        moves = tuple(move.times(factor) for move in self.moves)
        tasks = [
            Task(
                k,
                replace(options, settlement=farthest_settlement(self.model, v, options.rigid), settle_damping=v.settle_damping),
                self.ground,
                factor,
                shift,
                rate,
                moves,
            )
            for k, v in enumerate(values)
        ]
        drawn = self.model.drawn() if self.places else None
        return Runs([replace(self.model.bodies(v), drawn=drawn) for v in values], tasks)
