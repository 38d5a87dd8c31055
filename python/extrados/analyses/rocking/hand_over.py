"""Where joints of a rocking structure slide, or hinges open elsewhere: its blocks go on by rigid contacts, from that state.

The mechanism is right up to the moment at which a condition fails. There the places and velocities of its blocks are handed to
contacts without springs (Moreau 1988), which open and slide wherever the state requires it, under the rest of the motion.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from extrados.analyses.batches import sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import history as dem_history
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.from_deck import joint_values
from extrados.analyses.dem.job import BODIES_FOR_THREADS
from extrados.analyses.dem.measures import Collapse
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.seen import Seen
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.ties import NO_TIES, element_ties, section_strands
from extrados.analyses.dem.trial import Begin, Trial, core_options, domain_of
from extrados.analyses.rocking.conditions import astray_of
from extrados.core import dem
from extrados.core import mechanism as core_mechanism
from extrados.core.errors import Cancelled, status_code
from extrados.core.ground import Ground
from extrados.core.restraints import LENGTH
from extrados.core.rocking import FAILED, OUTCOMES, Body, Response, ensemble, history
from extrados.core.soft_base import SoftBaseResponse, soft_base_history, soft_base_start
from extrados.core.stack import StackResponse, stack_history
from extrados.limit.linkage import Linkage
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.results.dem import APART, DemRun
from extrados.results.model import Array, Result
from extrados.results.rocking import COLLAPSE, NO_HINGING, RECOVERY, SLID, WholeOutcome
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.rockers.rocker import Rocker
from extrados.views.rockers.soft_base import SoftBaseModel
from extrados.views.rockers.stack import StackModel
from extrados.views.rockers.watch import LOST

#: Handed over so much before the condition fails, over the time unit of the structure: contacts take an impact themselves
BEFORE = 1e-3
#: Spacing of the history of contacts in maps, over the time unit of the structure
COARSE = 0.02
#: Time steps of contacts over the time unit of the structure, the coarsest first, 0 that of single runs; and the rotation over the critical
#: one up to which a recovery is accepted at this step. In 258 motions of one cycle the least rotations of wrong recoveries were 0.72, 1.1,
#: 2.4 and 2.8. Coarse steps lose more energy, but may also err to a collapse: it is accepted only if the next step collapses too.
STEPS = ((0.04, 0.4), (0.02, 0.7), (0.01, 1.2), (0.005, 1.8), (0.0, np.inf))
#: Share of the energy barrier below which blocks recover after the motion, in maps and ensembles
SAFE = 0.1
#: Blocks have collapsed beyond a fifth of the size, and so many times as far as at the critical rotation, from which they may recover
FALLEN, BEYOND = 0.2, 1.5
#: Rotation from which a block at the end of a run has overturned, where no critical rotation exceeds it [rad]
LIES = 0.25 * np.pi
#: Shear stiffness of the springs under edges, which do not slide in the mechanism, over their normal stiffness
SHEAR = 10.0
#: Heights of joints on the ground that differ by no more than this share of the size are one level
LEVEL = 1e-6
#: Outcome of `rocking` for one of contacts
WORDS: dict[str, WholeOutcome] = {"at-rest": "no-hinging", "slid": "slid", "rocked": "recovery", "collapse": "collapse"}
#: Outcome of a member whose contacts gave no result
UNKNOWN = -2
CODES: dict[WholeOutcome, int] = {"no-hinging": NO_HINGING, "slid": SLID, "recovery": RECOVERY, "collapse": COLLAPSE}


def leaving_time(response: Response, astray: float, time_unit: float) -> float | None:
    """When a response leaves its mechanism [s], just before the first condition fails; None where all conditions hold. astray: see
    rocking.conditions; time_unit: of the structure [s]."""
    if response.joints is None:
        return None
    times = [float(response.joints.slips_at), float(response.joints.leaves_at)]
    if astray > LOST:
        times += [t for kind, t, _ in response.events if kind == "impact"][:1]
    return _first(times, time_unit)


def _first(times: list[float], time_unit: float) -> float | None:
    """Just before the first of some times [s], of which those below zero never come."""
    come = [t for t in times if t >= 0.0]
    return max(min(come) - BEFORE * time_unit, 0.0) if come else None


class Left(NamedTuple):
    """When a run leaves its mechanism [s], None where all conditions hold; whether it rocks before, its outcome in OUTCOMES by the
    mechanism, FAILED where it has none, its greatest rotation [rad], and that over the critical one."""

    time: float | None
    rocks: bool
    outcome: int
    peak: float
    ratio: float


@dataclass(frozen=True)
class Leaving:
    """A rocking structure until one of its conditions fails: body of the core, mechanisms (to +x, to -x) of its blocks, share of
    energy astray (rocking.conditions), rotation at the start [rad], > 0 to +x, its time unit [s], and critical rotations (to +x, to -x)
    [rad]."""

    body: Body
    linkages: tuple[Linkage, Linkage]
    blocks: Assembly
    astray: float
    start: float
    time_unit: float
    limits: tuple[float, float]
    tolerance: float = 1e-8

    @property
    def critical(self) -> float:
        """The least critical rotation [rad]."""
        return min(self.limits)

    def plastic(self, ground: Ground, time: float, scale: float) -> np.ndarray:
        """Permanent elongations of the restraints at a time [s] (restraints) [m]."""
        if not self.body.restraints or time <= 0.0:
            return np.zeros(self.body.restraints)
        return self.respond(ground, time, time, scale).permanent

    @property
    def farthest(self) -> float:
        """The greatest critical rotation [rad]."""
        return max(self.limits)

    @property
    def unstable(self) -> np.ndarray:
        """Displacements (sides, blocks, 2) of the centres at the critical rotations [m]."""
        n, found = len(self.blocks.mass), []
        for one, limit in zip(self.linkages, self.limits, strict=True):
            place = core_mechanism.follow(one, [limit * (1.0 - 1e-9)])[0]  # it may lock at the critical rotation itself
            found.append(one.blocks(self.blocks, place)[0, :n, :2] - self.blocks.centroid)
        return np.array(found)

    def respond(self, ground: Ground, end_time: float, step: float, scale: float = 1.0) -> Response:
        """The response of the mechanism."""
        return history(
            self.body,
            ground,
            end_time,
            step,
            scale=scale,
            tolerance=self.tolerance,
            start_side=1 if self.start >= 0.0 else -1,
            start_rotation=abs(self.start),
        )

    def leave(self, ground: Ground, end_time: float, scale: float) -> Left:
        """When and how a run leaves the mechanism."""
        response = self.respond(ground, end_time, end_time, scale)
        time = leaving_time(response, self.astray, self.time_unit)
        rocks = bool(self.start) or any(kind == "uplift" and t <= (time or 0.0) for kind, t, _ in response.events)
        return Left(time, rocks, OUTCOMES.index(response.outcome), float(response.peak), float(response.peak_ratio))

    def greatest(self, rotation: np.ndarray) -> tuple[float, float]:
        """Greatest of rotations (times, blocks) [rad], positive to +x, and that over the critical one."""
        turned = rotation.ravel()
        peak = float(turned[np.abs(turned).argmax()]) if turned.size else 0.0
        return peak, abs(peak) / self.critical

    def state(self, ground: Ground, time: float, scale: float, bodies: int) -> tuple[np.ndarray, np.ndarray]:
        """Displacements and velocities (bodies, 3) of blocks and supports at a time [s] under the motion times a factor."""
        q, v = self.start, 0.0
        if time > 0.0:
            reached = self.respond(ground, time, time, scale)
            q, v = float(reached.rotation[-1]), float(reached.rate[-1])
        shift, rate = np.zeros((2, bodies, 3))
        one = self.linkages[0 if q > 0.0 or (q == 0.0 and v >= 0.0) else 1]
        place, first, _ = core_mechanism.follow(one, [abs(q)])
        n = len(self.blocks.mass)
        shift[:n] = one.blocks(self.blocks, place)[0]
        shift[:n, :2] -= self.blocks.centroid
        rate[:n] = one.block_rates(self.blocks, place, first * (one.side * v))[0]
        return shift, rate


@dataclass(frozen=True)
class PairLeaving(ABC):
    """A structure of two coordinates until a condition fails; see Leaving."""

    body: Body
    start: float
    time_unit: float
    tolerance: float = field(default=1e-8, kw_only=True)

    def leave(self, ground: Ground, end_time: float, scale: float) -> Left:
        """When and how a run leaves the assumption that joints neither slide nor part as a whole."""
        one = np.zeros(1, dtype=int)
        found = ensemble(
            [self.body],
            [ground],
            one,
            one,
            [scale],
            end_time,
            start_rotation=self.start,
            tolerance=self.tolerance,
            stop_when_safe=False,
            threads=1,
        )
        if found.interrupted:
            raise Cancelled(status_code("cancelled"), "rocking in two coordinates interrupted")
        outcome = int(found.outcome[0])
        if outcome == FAILED:
            return Left(None, False, outcome, 0.0, 0.0)
        time = _first([float(found.joints.slips_at[0]), float(found.joints.leaves_at[0])], self.time_unit)
        rocks = bool(self.start) or (bool(time) and self.rocked(ground, time or 0.0, scale))
        return Left(time, rocks, outcome, float(found.peak[0]), float(found.peak_ratio[0]))

    def plastic(self, _ground: Ground, _time: float, _scale: float) -> np.ndarray:
        """See Leaving: nothing holds it."""
        return np.zeros(0)

    @abstractmethod
    def rocked(self, ground: Ground, time: float, scale: float) -> bool:
        """Whether it rocks up to a time [s] above zero."""


@dataclass(frozen=True)
class StackLeaving(PairLeaving):
    """Two stacked blocks until a joint slides or parts as a whole; see Leaving."""

    pair: StackModel

    @property
    def blocks(self) -> Assembly:
        """The blocks."""
        return self.pair.assembly

    @property
    def farthest(self) -> float:
        """See Leaving: of both blocks as one, or of the upper alone."""
        return max(self.pair.whole[0], self.pair.alone[0])

    @property
    def unstable(self) -> np.ndarray:
        """See Leaving: of both blocks as one, and of the upper alone."""
        whole, alone = self.pair.whole[0], self.pair.alone[0]
        pose = self.pair.pose(np.array([[whole, whole], [0.0, alone]]), np.array([[1.0, 0.0], [0.0, 1.0]]))
        return np.asarray(pose[:, :, :2] - self.blocks.centroid)

    def greatest(self, rotation: np.ndarray) -> tuple[float, float]:
        """See Leaving: of the lower block as one with the upper, or of the upper against the lower, as in the core."""
        if not rotation.size:
            return 0.0, 0.0
        lower, upper = rotation[:, self.pair.order].T
        turned = np.stack([lower, upper - lower])
        ratio = np.abs(turned) / np.array([[self.pair.whole[0]], [self.pair.alone[0]]])
        k = int(ratio.argmax())
        return float(turned.ravel()[k]), float(ratio.ravel()[k])

    def _until(self, ground: Ground, time: float, scale: float) -> StackResponse:
        """The response up to a time [s] above zero."""
        start = (self.start, self.start, 0.0, 0.0)
        return stack_history(self.pair.core, ground, time, time, scale=scale, tolerance=self.tolerance, start=start)

    def rocked(self, ground: Ground, time: float, scale: float) -> bool:
        """See PairLeaving."""
        return self._until(ground, time, scale).outcome != "no-hinging"

    def state(self, ground: Ground, time: float, scale: float, bodies: int) -> tuple[np.ndarray, np.ndarray]:
        """See Leaving."""
        rotation, rate, contacts = np.full(2, self.start), np.zeros(2), np.array([np.sign(self.start), 0.0])
        if time > 0.0:
            r = self._until(ground, time, scale)
            rotation, rate, contacts = r.rotation[-1], r.rate[-1], r.state[-1]
        shift, speed = np.zeros((2, bodies, 3))
        n = len(self.blocks.mass)
        shift[:n] = self.pair.pose(rotation[None, :], contacts[None, :])[0]
        shift[:n, :2] -= self.blocks.centroid
        speed[:n] = self.pair.velocity(rotation, rate, contacts)
        return shift, speed


@dataclass(frozen=True)
class EdgesLeaving(PairLeaving):
    """A block on springs under its edges until it slides or lifts off as a whole; see Leaving."""

    base: SoftBaseModel

    @property
    def blocks(self) -> Assembly:
        """The block."""
        return self.base.block

    @property
    def _limits(self) -> np.ndarray:
        return np.array([self.base.critical(1), self.base.critical(-1)])

    @property
    def farthest(self) -> float:
        """See Leaving."""
        return float(np.abs(self._limits).max())

    @property
    def unstable(self) -> np.ndarray:
        """See Leaving."""
        sunk = np.array([self.base.sinking(float(q)) for q in self._limits])
        return np.asarray(self.base.pose(self._limits, sunk)[:, :, :2] - self.blocks.centroid)

    def greatest(self, rotation: np.ndarray) -> tuple[float, float]:
        """See Leaving."""
        turned = rotation.ravel()
        peak = float(turned[np.abs(turned).argmax()]) if turned.size else 0.0
        return peak, peak / float(self._limits[0 if peak >= 0.0 else 1])

    def _until(self, ground: Ground, time: float, scale: float) -> SoftBaseResponse:
        """The response up to a time [s] above zero."""
        start = soft_base_start(self.base.core, self.start)
        return soft_base_history(self.base.core, ground, time, time, scale=scale, tolerance=self.tolerance, start=start)

    def rocked(self, ground: Ground, time: float, scale: float) -> bool:
        """See PairLeaving."""
        return self._until(ground, time, scale).outcome != "no-hinging"

    def state(self, ground: Ground, time: float, scale: float, bodies: int) -> tuple[np.ndarray, np.ndarray]:
        """See Leaving."""
        reached = np.array(soft_base_start(self.base.core, self.start))
        if time > 0.0:
            reached = self._until(ground, time, scale).end
        shift, speed = np.zeros((2, bodies, 3))
        shift[0] = self.base.pose(reached[:1], reached[1:2])[0, 0]
        shift[0, :2] -= self.blocks.centroid[0]
        speed[0] = self.base.velocity(reached)
        return shift, speed


@dataclass(frozen=True)
class Contacts:
    """The blocks of a building on rigid contacts, and the mechanism that they leave; floor: height of the level ground on which they
    slide [m], None where they stand on footings."""

    leaving: Leaving | StackLeaving | EdgesLeaving
    model: Model
    floor: float | None

    @property
    def name(self) -> str:
        """What follows the blocks, in words."""
        return "discrete elements on the springs of the base" if isinstance(self.leaving, EdgesLeaving) else "rigid contacts"

    @cached_property
    def fallen(self) -> float:
        """Displacement from which a block that also rotates or loses height has collapsed [m]."""
        return max(FALLEN * self.model.size, BEYOND * float(np.hypot(*np.moveaxis(self.leaving.unstable, -1, 0)).max()))

    @cached_property
    def safe(self) -> float:
        """See core.dem_run.RunOptions [J]; 0 where springs hold energy too."""
        if not self.options.rigid:
            return 0.0
        return SAFE * max(GRAVITY * float((self.leaving.unstable[..., 1] @ self.leaving.blocks.mass).min()), 0.0)

    def above(self, shift: np.ndarray) -> float:
        """Energy of the places over those at rest, of displacements (bodies, 3) [J]."""
        return GRAVITY * float(self.model.rigid.mass @ shift[:, 1])

    @property
    def collapse(self) -> Collapse:
        """When a block has collapsed: a stout one on its side is nearer than `fallen`."""
        return replace(Collapse.of(self.fallen, self.model.size), lies=max(LIES, self.leaving.farthest))

    @property
    def options(self) -> Dem:
        """Table of an analysis that follows them."""
        solver: Literal["compliant", "nonsmooth"] = "compliant" if isinstance(self.leaving, EdgesLeaving) else "nonsmooth"
        return Dem(kind="dem", solver=solver, floor=self.floor, collapse_displacement=self.fallen)

    @cached_property
    def bodies(self) -> dem.Bodies:
        """Bodies of the core."""
        return self.model.bodies()

    def reached(self, ground: Ground, time: float, scale: float = 1.0) -> "Contacts":
        """The same with ties as long as they have become at a time [s] under the motion times a factor."""
        ties = self.model.ties.yielded(self.leaving.plastic(ground, time, scale))
        return self if ties is self.model.ties else replace(self, model=replace(self.model, ties=ties))

    def begin(self, ground: Ground, time: float) -> Begin:
        """The beginning of a run of contacts."""
        bodies = len(self.model.rigid.mass)
        return Begin(time, lambda factor: self.leaving.state(ground, time, factor, bodies))


def contacts_of(rocker: Rocker, building: Building, linear: bool = False, tolerance: float = 1e-8) -> Contacts | None:
    """The blocks of a rocking structure on rigid contacts, with its ties and dampers; None where its joints are not watched, where it is
    not made of blocks, where a wall or an added hinge acts on it, or where the equations are those of slender blocks."""
    watch, held = rocker.watch, rocker.restraints
    if isinstance(rocker.model, SoftBaseModel):
        return _on_edges(rocker, rocker.model, building, tolerance)
    pair = rocker.model if isinstance(rocker.model, StackModel) else None
    if pair is None and (watch is None or not len(watch.joints) or linear):
        return None
    if held is not None and (not all(held.open_sides) or any(one.sort != LENGTH for one in held.members)):
        return None
    try:
        blocks = building.blocks() if pair is None else pair.assembly
        floor = level_of(blocks)
        rigid = building.rigid((), floor)
        ties = NO_TIES if held is None else element_ties(building, section_strands(building), rigid.body_of_block, has_rates=True)
    except (BadGeometry, Refused):
        return None
    values = joint_values(building, rigid=True)
    nothing = np.zeros_like(values.cohesion)  # a mechanism has no mortar either
    model = Model(blocks, rigid, replace(values, cohesion=nothing, tension=nothing), ties)
    if pair is not None:
        return Contacts(StackLeaving(rocker.body, rocker.start_rotation, rocker.time_unit, pair, tolerance=tolerance), model, floor)
    assert watch is not None
    linkages = watch.linkages
    if len(blocks.mass) != len(watch.assembly.mass):  # a wall that rocks as one pier, of all of its bricks
        if any(len(one.mass) > 1 for one in linkages):
            return None
        right, left = (replace(one, part=np.ones(len(blocks.mass), dtype=int)) for one in linkages)
        linkages = right, left
    leaving = Leaving(rocker.body, linkages, blocks, astray_of(rocker), rocker.start_rotation, rocker.time_unit, rocker.critical, tolerance)
    return Contacts(leaving, model, floor)


def _on_edges(rocker: Rocker, base: SoftBaseModel, building: Building, tolerance: float) -> Contacts | None:
    """A block on springs under its edges, as discrete elements with these springs at its corners; None on a bed, whose force moves along the
    base, of a block of several parts, and where the equations are those of slender blocks."""
    blocks = building.blocks()
    core = base.core
    if not core.edges or core.linear or len(blocks.mass) != 1:
        return None
    values, floor = joint_values(building, rigid=True), level_of(blocks)
    stiffness, nothing = np.full_like(values.stiffness, core.stiffness / blocks.depth), np.zeros_like(values.cohesion)
    springs = replace(
        values,
        stiffness=stiffness,
        shear_stiffness=SHEAR * stiffness,
        beta=core.damping / core.stiffness,
        cohesion=nothing,
        tension=nothing,
    )
    leaving = EdgesLeaving(rocker.body, rocker.start_rotation, rocker.time_unit, base, tolerance=tolerance)
    return Contacts(leaving, Model(blocks, building.rigid((), floor), springs), floor)


def level_of(blocks: Assembly) -> float | None:
    """Height of the ground [m], 0 where it differs from 0 by rounding; None where joints on it are not level, or not at one height."""
    grounded = (blocks.a == GROUND) | (blocks.b == GROUND)
    heights = np.concatenate([blocks.p[grounded, 1], blocks.q[grounded, 1]])
    if np.ptp(heights) > LEVEL * blocks.size:
        return None
    return float(heights[0]) if abs(heights[0]) > LEVEL * blocks.size else 0.0


def follow_contacts(
    context: Context, contacts: Contacts, begin: Begin, end_time: float | None, output_step: float
) -> tuple[DemRun, Result]:
    """The run of contacts from a state, and what is stored of it. Refused where it has no result."""
    options = contacts.options.model_copy(update={"end_time": end_time, "output_step": output_step})
    context.warnings += dem_model.adjusted(contacts.model)
    trial = Trial(context, options, contacts.model, begin)
    trial.collapse = contacts.collapse
    result = dem_history.follow(context, options, trial, "rocking-contacts")
    assert isinstance(result.results, DemRun)
    return result.results, result


def outcome_of(rocked: bool, outcome: str) -> WholeOutcome:
    """The outcome of the whole motion: contacts that did not open any more leave what rocked before as recovered."""
    return "recovery" if rocked and outcome != "collapse" else WORDS[outcome]


def stored(result: Result) -> dict[str, Array]:
    """Histories of the blocks on contacts, by names of their own; no slip of joints that are open over their whole length."""
    get = dict(result.arrays)
    slip = get["slip"]
    get["slip"] = replace(slip, data=np.where(np.asarray(get["hinge"].data) == APART, np.nan, slip.data))
    axes = {"time": "contacts_time"}
    kept = ("time", "place", "rotation", "slip", "ground", "kinetic_energy", "friction_energy", "damping_energy")
    return {
        f"contacts_{name}": Array(get[name].data, tuple(axes.get(d, d) for d in get[name].dims), get[name].unit, get[name].about)
        for name in kept
    }


def word_of(code: int) -> WholeOutcome:
    """The outcome of a number in CODES."""
    return next(word for word, number in CODES.items() if number == code)


class Fate(NamedTuple):
    """How a run ends on contacts, in CODES or UNKNOWN, its greatest rotation from there on [rad], and that over the critical one."""

    outcome: int
    rotation: float
    ratio: float


@dataclass(frozen=True)
class Fates:
    """Outcomes on rigid contacts of the runs of one structure; options: of contacts, their end_time [s] counts from the end of each
    motion; steps: see STEPS."""

    contacts: Contacts
    options: dem.Options
    collapse: Collapse
    steps: tuple[tuple[float, float], ...] = STEPS[-1:]

    @classmethod
    def of(cls, context: Context, contacts: Contacts, steps: tuple[tuple[float, float], ...] = STEPS[-1:]) -> "Fates":
        """Of a structure of the deck."""
        options, model = contacts.options, contacts.model
        step = COARSE * contacts.leaving.time_unit
        asked = core_options(context, options, model)
        collapse = contacts.collapse
        brief = replace(asked, end_time=dem_model.settle_time(model), output_step=step, stop_at_rest=True)
        # springs have the step of their stability
        return cls(contacts, brief, collapse, steps if contacts.options.rigid else STEPS[-1:])

    def alike(self, contacts: Contacts) -> "Fates":
        """The same of another building of the same joints."""
        model, collapse = contacts.model, contacts.collapse
        options = replace(
            self.options,
            settle_damping=model.values.settle_damping,
            end_time=dem_model.settle_time(model),
            domain=domain_of(model),
            **collapse.options,
        )
        return replace(self, contacts=contacts, options=options, collapse=collapse)

    def follow(self, ground: Ground, scale: float, end: float, threads: int = 1) -> Fate:
        """The run of a motion times a factor, whose mechanism is followed until `end` [s]; its outcome is UNKNOWN where contacts have no
        result."""
        left = self.contacts.leaving.leave(ground, end, scale)
        if left.time is None:  # at the edge of its tolerance
            return Fate(left.outcome, left.peak, left.ratio)
        c = self.contacts.reached(ground, left.time, scale)
        shift, rate = c.begin(ground, left.time).state(scale)
        many = len(c.bodies.mass) >= BODIES_FOR_THREADS
        rest = max(ground.end, left.time) + self.options.end_time - left.time
        options = replace(self.options, end_time=rest, threads=threads if many else 1)
        if len(self.steps) > 1:  # the outcome alone is wanted, not the greatest rotation
            options = replace(options, safe=c.safe, above=c.above(shift))
        seen_ground = ground.seen_from(left.time)
        fate, fell = Fate(UNKNOWN, 0.0, 0.0), False
        for step, sure in self.steps:
            tried = replace(options, step=step * c.leaving.time_unit)
            run = dem.run(c.bodies, tried, seen_ground, scale=scale, shift=shift, rate=rate)
            fate = self._fate(run, left.rocks)
            falls = fate.outcome == COLLAPSE
            if (falls and fell) or not (falls or fell or fate.outcome == UNKNOWN or fate.ratio > sure):
                break
            fell = falls
        return fate

    def _fate(self, run: dem.Run, rocks: bool) -> Fate:
        """Of a run that rocked before or did not; its outcome is UNKNOWN where contacts have no result."""
        if run.interrupted:
            raise Cancelled(status_code("cancelled"), "rigid contacts interrupted")
        c = self.contacts
        try:
            dem_model.checked(run, c.model)
        except Refused:
            return Fate(UNKNOWN, 0.0, 0.0)
        seen = Seen.of(c.model, run, c.floor is not None)
        outcome = outcome_of(rocks, seen.fate(self.collapse).outcome)
        return Fate(CODES[outcome], *c.leaving.greatest(seen.rotation))


@dataclass(frozen=True)
class ContactRuns:
    """Member k: motion[k] times scale[k] until end[k] [s], whose mechanism a condition leaves: its outcome on contacts."""

    fates: Fates
    grounds: list[Ground]
    motion: np.ndarray
    scale: np.ndarray
    end: np.ndarray

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        members = range(first, first + count)
        found = [self.fates.follow(self.grounds[self.motion[k]], float(self.scale[k]), float(self.end[k]), threads) for k in members]
        return {"outcome": np.array([one.outcome for one in found], dtype=np.int8), "ratio": np.array([one.ratio for one in found])}


def decide(
    context: Context,
    name: str,
    contacts: Contacts,
    grounds: list[Ground],
    motion: np.ndarray,
    scale: np.ndarray,
    end: np.ndarray,
    steps: tuple[tuple[float, float], ...] = STEPS[-1:],
) -> dict[str, np.ndarray]:
    """On contacts, of runs whose mechanism a condition leaves (see ContactRuns): `outcome` (runs) in CODES, UNKNOWN where contacts gave no
    result, and `ratio` of the greatest rotation to the critical one (runs). steps: see STEPS."""
    job = ContactRuns(Fates.of(context, contacts, steps), grounds, motion, scale, end)
    return sweep(context, name, job, len(motion), "rigid contacts", slow=True, parallel=True).whole().arrays


def decide_cells(
    context: Context,
    rocker: Rocker,
    limit: int,
    linear: bool,
    grounds: list[Ground],
    index: np.ndarray,
    scale: np.ndarray,
    end: np.ndarray,
    steps: tuple[tuple[float, float], ...] = STEPS[-1:],
) -> dict[str, np.ndarray]:
    """See `decide`: of cells of a map whose mechanism a condition leaves, motion index[k] times scale[k] until end[k] [s]; UNKNOWN where
    contacts do not decide them, or where they are more than `limit`, with a warning."""
    unknown = {"outcome": np.full(len(index), UNKNOWN), "ratio": np.full(len(index), np.nan)}
    if not len(index):
        return unknown
    contacts = contacts_of(rocker, context.building, linear)
    if contacts is None:
        return unknown
    if len(index) > limit:
        context.warnings.append(
            f"Joints slide or hinges form outside the mechanism in {len(index)} cells of the map. This exceeds "
            f"`hand_over_cells` = {limit}, so these cells are not continued with rigid contacts."
        )
        return unknown
    return decide(context, "map-contacts", contacts, grounds, index, scale, end, steps)
