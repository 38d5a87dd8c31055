"""One event curve: stages A and B in batches, with the states that are wanted.

Every KEPT events the factor is made anew and the state is kept, in every run: one that is resumed there gives the
same bits as one that was never interrupted.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.context import Refused
from extrados.analyses.sla.contact import NotCarried, settle
from extrados.analyses.sla.curve import AXIAL, FALLEN, FAR, FELL, SLID_ALONG, SLID_OFF, TOO_FAR, envelope, fallen, states
from extrados.analyses.sla.incremental import run_incremental
from extrados.analyses.sla.kept import State, UnderWay
from extrados.analyses.sla.model import MECHANISM, MECHANISM_OF_STONES, EventModel, SlaModel
from extrados.analyses.sla.tables import Sla, Staged
from extrados.core import lists
from extrados.core import sla as core
from extrados.core.errors import Cancelled, CoreError, status_code
from extrados.core.sla import EVENT
from extrados.model.errors import WHOLE
from extrados.results.sla import DROP
from extrados.schema.quantities import engineering

BATCH_SECONDS = 0.7
#: Events between two states that are kept; a new factor takes as long as some tens of events of a large wall.
KEPT = 1000
#: The peak's state is run again from the damage at the multiple of this number before it.
GRID = 100
#: Events beyond the peak's number among which its load is looked for, where it comes in another order
MORE = 30
NOTHING = np.zeros(0)
NOTHING_DONE = (0.0, 0.0, 0.0)  # of the energies of a ledger
STRAINS_AND_STRESSES = core.REPORT[:6]
#: States that a film shows, to its target
PICTURES = 80
#: Drift to which a run goes on that has lost equilibrium under its constant loads; longest step of equilibrium iterations, and
#: displacement below which nothing counts as running away, over the extent across the control displacement
DRIFT, LONGEST_STEP, RUNAWAY = 0.01, 1e-4, 2.5e-3
#: Continuations that begin with the first load
FROM_THE_START = ("steps", "dissipation")
#: Part of the work of the loads by which the energies of steps may differ without a warning
UNBALANCED = 0.06
#: Part of the greatest load that a step of the arc length may lose without a warning
LARGE_DROP = 0.25
#: How a run ends in which the load can grow for ever, and one that has reached a displacement
UNBOUNDED, MECHANISM_REACHED, REACHED = (core.STOPS[lists.number("sla_stop", name)] for name in ("unbounded", "mechanism", "displacement"))
SPENT = "budget of processor time"
DRIFTED = f"a drift of {100 * DRIFT:g} %"


@dataclass
class Curve:
    """One run of stage B (stage A before it, if any)."""

    events: core.Events
    stage_a: core.Events | None
    states: list[State]
    damage_start: np.ndarray
    damage_end: np.ndarray
    seconds: float
    sign: int
    warnings: list[str] = field(default_factory=list)
    equations: int = 0
    points: int = 0
    events_before: int = 0  # of the runs that this one goes on from
    before: float = 0.0  # control displacement of the constant loads alone, in the sense of the load [m]
    most_compliance: float = np.inf  # beyond it only the floor of the stiffness carries
    name: str = ""  # of a stage
    unit: float = 1.0  # resultant of the reference load [N]
    extent: float = np.inf  # greatest extent of the structure [m]
    releases: bool = False  # events between states are on the way of forces that are released
    acceleration: float | None = None  # of the reference load of a stage
    control: core.Monitor | None = None  # of a stage, across which its drift is counted
    already: float = 0.0  # load in the direction of the reference load that was on before [N]
    driven: bool = False  # the multiplier is a displacement of supports, the load their force
    residual: float | None = None  # measured at the end; None where the end is a mechanism without displacements
    histories: np.ndarray | None = None  # (2, points) at the end, of a run that ended with equilibrium iterations
    last_line: tuple[float, float] | None = None  # control displacement [m] after the last event: constant, per multiplier

    @property
    def sense(self) -> str:
        """Its sign as a deck writes it: "+" or "-"."""
        return "+" if self.sign > 0 else "-"

    def force(self, unit: float) -> np.ndarray:
        """The load of each event [N]."""
        return self.events.pull if self.driven else self.already + self.events.load * unit

    @property
    def judged(self) -> tuple[np.ndarray, np.ndarray]:
        """Which events are states, and which lie out of reach (curve.states)."""
        e = self.events
        way = np.abs(e.monitors[:, 0] - self.before)
        return states(e.equilibrium, self.force(self.unit), way, e.compliance, FAR * self.extent, self.most_compliance)

    @property
    def state(self) -> np.ndarray:
        """Which events are states of the structure: all that is read off a curve rests on these."""
        return self.judged[0]

    @property
    def dissipated(self) -> np.ndarray:
        """Energy dissipated up to each event [J], a sum of parts none of which is negative.

        From one state to the next it is what the work of the loads does not store. Through events that are no states that
        way is not gone: the area of the teeth that pass counts, and out of reach nothing does.
        """
        e = self.events
        if not len(e):
            return np.zeros(0)
        state, out = self.judged
        known = state | self.releases
        teeth = np.where(out[:-1], 0.0, np.diff(e.crack))
        steps = np.where(known[1:] & known[:-1], np.maximum(np.diff(e.lost), 0.0), teeth)
        return np.cumsum(np.append(max(float(e.lost[0]), float(e.crack[0])), steps))

    def envelope(self, unit: float) -> tuple[np.ndarray, np.ndarray]:
        """Displacements [m] and loads [N] of the envelope; it begins at the constant loads' displacement."""
        fine = self.state
        d, p = envelope(self.events.monitors[fine, 0], self.force(unit)[fine] - self.already, self.before)
        return d, p + self.already

    @property
    def peak(self) -> int:
        """The event of the greatest load of a state, passed or not; -1 where there is none."""
        load = np.where(self.state, self.force(self.unit), -np.inf)
        return int(load.argmax()) if len(load) and np.isfinite(load.max()) else -1

    @property
    def held(self) -> np.ndarray:
        """Events in equilibrium within reach: the states, and those on the way of a mechanism that begins."""
        return self.events.equilibrium & ~self.judged[1]

    @property
    def last(self) -> int:
        """The last event in equilibrium within reach; -1 where there is none."""
        found = np.flatnonzero(self.held)
        return int(found[-1]) if len(found) else -1

    def passed(self, unit: float) -> bool:
        """Was the greatest load a peak: did the load fall after it, or the structure become a mechanism under it?"""
        if self.peak < 0 or (self.name and not self.force(unit)[self.peak] > 0.0):
            return False  # a stage may begin under a load of the opposite sense and never leave it
        if self.events.reason in ("mechanism", FELL, AXIAL, SLID_OFF, SLID_ALONG) or self.flat():
            return True
        return fallen(*self.envelope(unit)) or self.levels_off(unit)

    def levels_off(self, unit: float) -> bool:
        """Do steps end on a plateau: has the load grown by no more than FALLEN over the second half of the way?"""
        if not self.events.steps[-1:].any():
            return False
        d, p = self.envelope(unit)
        half = np.interp(0.5 * (d[0] + d[-1]), d, p)
        return bool(p[-1] > 0.0 and p[-1] - half <= FALLEN * p[-1])

    def flat(self) -> bool:
        """Is the structure a mechanism at the end, by its stiffness: does the load grow by no more than FALLEN within small
        displacements, or is less than 1 / MECHANISM of the stiffness at the start left?"""
        if self.last_line is None or self.driven or self.peak < 0:
            return False
        constant, slope = self.last_line
        if not abs(slope) > 0.0:
            return False
        ends = [(side * FAR * self.extent + self.before - constant) / slope for side in (1.0, -1.0)]
        peak = float(self.force(self.unit)[self.peak])
        softer = abs(slope) * self.unit / float(self.events.compliance[0])
        return softer > MECHANISM or self.already + max(ends) * self.unit <= (1.0 + FALLEN) * peak

    def leads_on(self, left: list[str]) -> bool:
        """Does this stage end in a state from which another can go on, not before its own end by the budget or the number of
        events? If not, a warning names those that are `left`."""
        events = self.events
        if events.interrupted:
            return False
        limited = events.reason in (SPENT, "")
        if len(events) and self.state[-1] and not limited and events.reason not in ("mechanism", AXIAL, DRIFTED, SLID_OFF, SLID_ALONG):
            return True
        if left:
            how = "before its target" if limited else "without an equilibrium state from which the run could continue"
            self.warnings.append(
                f"stage {self.name} ended {how} ({events.reason or 'number of events'}). These stages were not run: {', '.join(left)}"
            )
        return False

    @staticmethod
    def stopped(core_model: core.Model, stage_a: core.Events) -> "Curve":
        """No event of the reference load: the run was interrupted under the constant loads."""
        none = core.Events.none()
        none.interrupted = True
        damage = core_model.damage()
        return Curve(none, stage_a, [], damage, damage, 0.0, 1, [], core_model.equations, core_model.points)


def run_curves(
    model: EventModel,
    options: Staged,
    threads: int,
    progress: Callable[[float, float, str], None],
    damage: np.ndarray | None = None,
    chain: Callable[[int], Chain] | None = None,
) -> list[Curve]:
    """The curves of all senses of B, each from the state that A leaves (or from a stored damage).

    chain: where the states of the curve of a sense, +1 or -1, are kept on its way, and of 0, of the constant loads;
    none are without it.
    """
    if model.slides and (options.solution == "incremental" or options.without_equilibrium not in ("continue", "load-unload")):
        raise Refused(
            'only solution = "events" with without_equilibrium = "continue" or "load-unload" can follow joints that slide: give '
            'these keys, or give the joints friction = "no-sliding"',
            ("joints", "friction"),
        )
    curves = []
    with model.open(options, threads) as core_model:
        warnings: list[str] = []
        stage_a, rubs = None, False
        if damage is not None:
            if damage.shape[1] != core_model.points:
                raise Refused(
                    f"resume_from: the earlier wall has {damage.shape[1]} integration points (including those of bars), "
                    f"but this wall has {core_model.points}",
                    ("analysis", "resume_from"),
                )
            core_model.set_damage(damage)
        else:
            stage_a, rubs = bring_on_constant_loads(core_model, model, options, progress, warnings, chain and chain(0))
        start = core_model.damage()
        ledger, events = stage_a.ledger if stage_a is not None else NOTHING_DONE, _count(stage_a)
        for number, sense in enumerate(options.directions):
            sign = 1 if sense == "+" else -1
            if number or stage_a is not None:  # a new factor: a run that is resumed here has one too
                core_model.set_damage(start)
            _settled(core_model, model)
            core_model.loads(model.constant, sign * model.reference, carried=stage_a is not None, events=events, ledger=ledger)
            watch = model.control
            before = sign * float(watch.share @ core_model.displacement(0.0)[watch.node, watch.direction])
            if options.solution == "incremental":
                curve = _incremental_stage(core_model, model, options, sign, progress, before)
            else:
                curve = run_reference_loads(
                    core_model,
                    model,
                    options,
                    sign,
                    before,
                    progress,
                    bool(stage_a is None and damage is None and not rubs),
                    chain and chain(sign),
                    core.Stop(
                        displacement=np.inf if options.target_displacement is None else options.target_displacement,
                        fraction=options.stop_fraction or -1.0,
                        compliance=model.mechanism_ratio,
                    ),
                )
            curve.stage_a = stage_a
            curve.damage_start = start
            curve.warnings += warnings if not number else []
            curves.append(curve)
            if curve.events.interrupted:
                break
    return curves


def _settled(core_model: core.Model, model: EventModel, growing: bool = False) -> None:
    """Supports that have settled with the constant loads, or settle as these grow."""
    if len(model.settled):
        still = np.zeros(len(model.settled))
        core_model.supports(*((still, model.settled) if growing else (model.settled, still)))


def _count(stage: core.Events | None) -> int:
    return int(stage.number[-1]) if stage is not None and len(stage) else 0


def bring_on_constant_loads(
    core_model: core.Model,
    model: EventModel,
    options: Staged,
    progress: Callable[[float, float, str], None],
    warnings: list[str],
    chain: Chain | None,
) -> tuple[core.Events | None, bool]:
    """The constant loads are on: which dry joints touch and slide, and the events until then, None where there are none.

    True where joints can slide: their friction was found under the whole of A and does not hold under a part of it.
    NotCarried where they lead to a mechanism, or further than displacements that are small.
    """
    found, rubs = _bring_on(core_model, model, options, progress, warnings, chain)
    if np.any(model.constant) and not (found is not None and found.interrupted):
        _settled(core_model, model)
        core_model.loads(model.constant, np.zeros_like(model.constant))
        far = float(np.abs(core_model.displacement(0.0)[:, : model.place.shape[1]]).max())
        if not far <= FAR * model.extent:
            raise NotCarried(
                f"the structure cannot carry the constant loads. The displacement under these loads would be {far:.3g} m, more than 1/10 "
                f"of the size of the structure ({model.extent:.3g} m). The structure is a mechanism, held only "
                "by the residual stiffness of open joints and cracks",
                WHOLE,
            )
    return found, rubs


def _bring_on(
    core_model: core.Model,
    model: EventModel,
    options: Staged,
    progress: Callable[[float, float, str], None],
    warnings: list[str],
    chain: Chain | None,
) -> tuple[core.Events | None, bool]:
    """As bring_on_constant_loads, without asking where they lead."""
    kept = None if chain is None or chain.state is None else chain.state[1]
    if kept is None:
        rubs = False
        if isinstance(model, SlaModel) and isinstance(options, Sla):  # joints of shells are not dry from the start
            rubs = settle(core_model, model, options, warnings)
        if rubs or not options.constant_damage or not np.any(model.constant):
            return None, rubs
    way = UnderWay((core_model.damage(), 0)) if kept is None else UnderWay.of(kept)
    if kept is not None and not len(kept["standing"]):  # they were on already
        core_model.set_damage(kept["damage"])
        return core.Events.join(way.parts), False
    _settled(core_model, model, growing=True)
    core_model.loads(np.zeros_like(model.constant), model.constant)
    if kept is not None:
        core_model.renew(kept["damage"], kept["standing"])
    events = _constant_stage(core_model, model, options, progress, way, chain)
    if len(events):
        core_model.end_stage(float(events.load[-1]))
    if chain is not None and not events.interrupted:
        chain.keep(len(events), way.arrays(core_model.damage(), NOTHING))
    return events, False


def _constant_stage(
    core_model: core.Model,
    model: EventModel,
    options: Staged,
    progress: Callable[[float, float, str], None],
    way: UnderWay,
    chain: Chain | None,
) -> core.Events:
    """Bring the constant loads from 0 to 1, with damage where they ask for it; the state is kept on the way."""
    begin = len(way.parts)
    ends_at = time.process_time() + (options.budget or np.inf)
    stop = core.Stop(load=1.0, compliance=model.mechanism_ratio)
    while True:
        if way.done % KEPT == 0 and len(way.parts) > begin:
            damage, standing = core_model.damage(), core_model.standing()
            try:
                core_model.renew(damage, standing)
            except core.FreeNode:
                way.parts[-1].reason = "mechanism"
                break
            if chain is not None:
                chain.keep(way.done, way.arrays(damage, standing))
        part = core_model.run(min(GRID, options.events - way.done), [model.control], stop)
        way.parts.append(part)
        progress(way.done, options.events, f"constant loads, event {way.done}")
        if part.reason or part.interrupted or way.done >= options.events:
            break
        if time.process_time() > ends_at:
            part.reason = SPENT
            break
    events = core.Events.join(way.parts)
    if events.reason == "no point limits the load":
        return events  # nothing can crack under A: it is carried
    if events.reason != "target load" and not events.interrupted:
        most = float(events.load.max()) if len(events) else 0.0
        if events.reason == SPENT:
            raise NotCarried(
                f"the `budget` of {options.budget:.4g} s of processor time ended when {100 * most:.3g} % of the constant loads were "
                f"applied. Increase `budget`, or use larger elements",
                WHOLE,
            )
        why = events.reason or f"{way.done} events were not enough"
        raise NotCarried(
            f"the structure cannot carry the constant loads: with damage, it carries at most {100 * most:.3g} % of them ({why})", WHOLE
        )
    return events


@dataclass
class _Run:
    """Events under A + lambda B on their way. before: see run_reference_loads; wanted: events whose states are kept; variant: what happens
    without equilibrium; goes_on: equilibrium iterations follow; begin, ends_at: by the clocks of time and of the processor [s]. start: damage
    before the events of this batch, and the first of them. best_step, drop_step, last_step: states after steps of equilibrium iterations at
    the greatest load, after its drop, and the last. pictured: way of the control at the last picture of a film [m]."""

    core_model: core.Model
    model: EventModel
    options: Staged
    sign: int
    before: float
    stop: core.Stop
    way: UnderWay
    wanted: list[int]
    variant: str
    goes_on: bool
    spent_before: float
    begin: float
    ends_at: float
    start: tuple[np.ndarray, int]
    best_step: State | None = None
    drop_step: State | None = None
    last_step: State | None = None
    pictured: float = 0.0

    @property
    def release(self) -> bool:
        """Whether forces are released where equilibrium is lost."""
        return self.variant == "force-release"

    @property
    def floor(self) -> float:
        """Compliance over that of the first event beyond which the structure is a mechanism."""
        return MECHANISM_OF_STONES if self.model.mesh.has_joints else MECHANISM

    def loop(self, progress: Callable[[float, float, str], None], chain: Chain | None) -> None:
        """Run events until the run stops."""
        batch, begun = GRID, self.way.done
        while (done := self.way.done) < self.options.events:
            # Steps of equilibrium iterations are found again from the events before them
            due = done % KEPT == 0 and done > begun and not (self.release or self.core_model.iterates)
            if due and not self._renew(done, chain):
                break
            if done % GRID == 0:
                # The event chosen last is not applied yet: a run from this damage records it again first
                self.start = (self.core_model.damage(), max(done - 1, 0))
            clock = time.perf_counter()
            part = self._run_part(self._room(done, batch))
            spent = time.perf_counter() - clock
            if len(part):
                self._note(part, done)
            done += len(part)
            if len(part) and (done - 1 in self.wanted or self._is_pictured(part)):
                self.way.states.append(_state(self.core_model, done - 1, part))
            load = (part.pull if self.model.driven else self.model.already + part.load * self.model.unit)[-1:]
            progress(*self._told(part, done, load))
            part.reason = part.reason or self.model.ends(part)
            if part.reason or part.interrupted or not (len(part) or self.core_model.iterates):
                break
            if time.process_time() > self.ends_at:
                part.reason = SPENT
                break
            batch = int(np.clip(len(part) * BATCH_SECONDS / max(spent, 1e-3), 10, GRID))

    def _told(self, part: core.Events, done: int, load: np.ndarray) -> tuple[float, float, str]:
        """Progress: of events their number; of steps the way of the control to its target, by which the remaining time is estimated."""
        total = self.options.events
        if not len(part):
            return done, total, ""
        moved = abs(float(part.monitors[-1, 0]) - self.sign * self.before)
        if not part.steps[-1] or self.stop.displacement == np.inf:
            return done, total, f"event {done}, load {load[0]:.4g} N"
        share = min(moved / self.stop.displacement, 1.0)
        drifts = (100.0 * way / self.model.reach for way in (moved, self.stop.displacement))
        return max(done, share * total), total, "step {}, drift {:.3g} of {:.3g} %, load {:.4g} N".format(done, *drifts, load[0])

    def _is_pictured(self, part: core.Events) -> bool:
        """Is the state after these events a picture of the film: has the control moved on by its part of the way?"""
        if getattr(self.options, "animation", "none") == "none" or not part.equilibrium[-1]:
            return False
        target = DRIFT * self.model.reach if self.stop.displacement == np.inf else self.stop.displacement
        moved = abs(float(part.monitors[-1, 0]) - self.sign * self.before)
        if moved < self.pictured + target / PICTURES:
            return False
        self.pictured = moved
        return True

    def _renew(self, done: int, chain: Chain | None) -> bool:
        """Restart from the damage alone, because forces being redistributed between points are not stored. The record of the run is kept. False if a node is free."""
        damage, standing = self.core_model.damage(), self.core_model.standing()
        try:
            self.core_model.renew(damage, standing)
        except core.FreeNode:
            self.way.parts[-1].reason = "mechanism"
            return False
        self.way.seconds = self.spent_before + time.perf_counter() - self.begin
        if chain is not None:
            chain.keep(done, self.way.arrays(damage, standing))
        return True

    def _room(self, done: int, batch: int) -> int:
        """How many events are run at once."""
        room = min(batch, GRID - done % GRID, self.options.events - done)
        ahead = [e for e in self.wanted if e >= done]
        if ahead:
            room = min(room, ahead[0] + 1 - done)
        return 1 if self.core_model.iterates else room  # the state after a step may be that of the peak

    def _run_part(self, room: int) -> core.Events:
        """The next events. Refused where the constant loads exceed the strength."""
        try:
            part = self.core_model.run(room, self.model.watched, self.stop, variant=self.variant)
        except CoreError as error:
            if error.status != status_code("beyond_strength"):
                raise
            raise Refused(
                "the constant loads alone exceed the strength, and no multiplier of the reference load relieves "
                "them. Reduce the constant loads, or apply them with damage: constant_damage = true",
                WHOLE,
            ) from None
        if self.model.driven and not part.steps.any():  # as of a force that moves them
            part.compliance = 1.0 / np.maximum(part.compliance, np.finfo(float).tiny)
        self.way.parts.append(part)
        return part

    def _note(self, part: core.Events, done: int) -> None:
        """The greatest load so far, and states after steps of equilibrium iterations; done: events before this part."""
        model, way = self.model, self.way
        most = np.inf if model.driven else self.floor * way.parts[0].compliance[0]
        moved = np.abs(part.monitors[:, 0] - self.sign * self.before)
        load = part.pull if model.driven else part.load
        found, _ = states(part.equilibrium, load, moved, part.compliance, FAR * model.extent, most)
        load = np.where(found, load, -np.inf)
        if part.reason == "mechanism" and model.mesh.has_joints:
            load[-1] = -np.inf  # on the way of the mechanism
        if part.steps[-1] and np.isfinite(load[-1]):
            self.last_step = _state(self.core_model, done + len(part) - 1, part)
        if load.max() > way.best:
            way.best, way.before_best = float(load.max()), self.start
            self.best_step = self.last_step if part.steps[-1] else None
            self.drop_step = None
        elif part.steps[-1] and self.drop_step is None and load[-1] < DROP * way.best:
            self.drop_step = self.last_step

    def curve(self, ends_by_drift: bool) -> Curve:
        """The curve of all events, with its states and warnings. ends_by_drift: the displacement at which it stops is that of DRIFT."""
        core_model, model = self.core_model, self.model
        events = core.Events.join(self.way.parts)
        events.monitors[:, 0] *= self.sign  # positive in the sense of the load
        collapsed = (
            events.reason == "mechanism" and len(events) > 0 and events.compliance[-1] > model.mechanism_ratio * events.compliance[0]
        )
        if events.reason == "mechanism" and len(events) and model.driven:
            events.equilibrium[-1] = False  # the constant loads carry it away
        if collapsed and model.mesh.has_joints:
            # Found on the way of the mechanism, which carries no more than the event before: it shows how the stones move
            events.equilibrium[-1] = False
        damage, kept, size = core_model.damage(), self.way.states, (core_model.equations, core_model.points)
        curve = Curve(events, None, kept, NOTHING, damage, 0.0, self.sign, [], *size)
        if core_model.iterates and len(events):
            curve.histories = core_model.histories()
        curve.already, curve.driven, curve.releases = model.already, model.driven, self.release
        curve.before, curve.unit, curve.extent, curve.control = self.before, model.unit, model.extent, model.control
        if len(events) and not model.driven:
            curve.most_compliance = self.floor * float(events.compliance[0])
        if ends_by_drift and events.reason == REACHED:
            events.reason = DRIFTED
        self._warn(curve)
        if events.reason in (TOO_FAR, UNBOUNDED) and not events.steps[-1:].any():
            self._end_on_a_line(curve)
        if len(events):
            self._keep_states(curve, collapsed)
        curve.seconds = self.spent_before + time.perf_counter() - self.begin
        return curve

    def _warn_of_drops(self, curve: Curve) -> None:
        """Warning of the largest drop of the load that displacement control passed in one step before the arc length took over."""
        events = curve.events
        states = np.flatnonzero(events.equilibrium)
        if len(states) < 2:
            return
        load, moved = curve.force(self.model.unit)[states], events.monitors[states, 0]
        drop = np.where(events.steps[states[1:]], np.abs(load[:-1]) - np.abs(load[1:]), 0.0)
        k = int(drop.argmax())
        if drop[k] > LARGE_DROP * float(np.abs(load).max()):
            curve.warnings.append(
                f"Between {1000.0 * moved[k]:.3g} and {1000.0 * moved[k + 1]:.3g} mm, one step in displacement control "
                f"passes over a snap-back, in which the load drops from {engineering(float(load[k]), 'N')} to {engineering(float(load[k + 1]), 'N')}. "
                "The peak may be missed, and the energy of the drop counts as dissipated."
            )

    def _warn(self, curve: Curve) -> None:
        """Warnings of a budget that is spent, of equilibrium that is lost, and of work that does not balance."""
        events = curve.events
        if events.reason == SPENT and len(events):
            curve.warnings.append(
                f"The `budget` of {self.options.budget:.4g} s of processor time ended the run at a displacement of {1000.0 * events.monitors[-1, 0]:.3g} "
                "mm; peak and drifts are those up to this displacement. Increase `budget`, or use larger "
                "elements."
            )
        lost = np.flatnonzero(~events.equilibrium)
        if self.options.without_equilibrium == "continue" and not (self.goes_on or self.model.mesh.has_joints) and len(lost):
            curve.warnings.append(
                f"Equilibrium under the constant loads is lost at event {lost[0] + 1}. The later events are calculated "
                'with "load-unload", because equilibrium iterations require rotating cracks of isotropic masonry, without bed joints, '
                "lateral reduction, confinement, shear retention and bars."
            )
        if self.options.continuation in FROM_THE_START and not self.goes_on:
            why = "equilibrium iterations can follow only rotating cracks of isotropic masonry, and joints with mortar"
            if self.options.without_equilibrium != "continue":
                why = '`without_equilibrium` is not "continue"'
            curve.warnings.append(f"`continuation` = {self.options.continuation} had no effect: {why}. The run consists of events.")
        if self.options.continuation == "dissipation":
            self._warn_of_drops(curve)
        steps = events.steps & events.equilibrium
        if steps.any():
            # Work that unloading takes back is no measure
            work = np.maximum(np.maximum.accumulate(np.abs(events.external))[steps], np.finfo(float).tiny)
            gap = float((np.abs(events.external - events.stored - events.lost)[steps] / work).max())
            if gap > UNBALANCED:
                curve.warnings.append(
                    "In the steps with displacement control, the sum of stored and dissipated energy differs from the work of the loads "
                    f"by {100 * gap:.0f} %. Loads and displacements are in equilibrium, but the dissipated energy is not reliable."
                )

    def _end_on_a_line(self, curve: Curve) -> None:
        """The line on which the curve goes on after its last event; a mechanism where it is flat."""
        events, watch = curve.events, self.model.control
        ends = [self.core_model.displacement(load) for load in (0.0, 1.0)]
        constant, one = (self.sign * float(watch.share @ u[watch.node, watch.direction]) for u in ends)
        curve.last_line = (constant, one - constant)
        if events.reason == TOO_FAR and curve.flat():
            events.reason = MECHANISM_REACHED
            if self.model.mesh.has_joints:
                events.equilibrium[-1] = False  # on the way of the mechanism

    def _keep_states(self, curve: Curve, collapsed: bool) -> None:
        """The residual at the end, and states at the end, at the peak and after its drop; collapsed: the last event begins a mechanism."""
        core_model, events, kept = self.core_model, curve.events, curve.states
        # A mechanism found while its event is applied leaves the displacements of the event before
        if events.steps[-1]:
            curve.residual = float(events.residual[-1])
        elif events.reason != "mechanism" or (collapsed and not self.model.mesh.has_joints):
            curve.residual = core_model.residual()
        if not (self.way.done - 1 in self.wanted and kept):
            kept.append(_state(core_model, len(events) - 1, events))
        peak = curve.peak
        if self.best_step is not None and self.best_step.event == peak != len(events) - 1:
            kept.append(self.best_step)
        elif peak >= 0 and peak not in {s.event for s in kept} and not (events.interrupted or self.release):
            try:
                state = _replay(core_model, self.model, self.sign, events, peak, self.way.before_best, self.variant)
            except Cancelled:
                events.interrupted = True
            else:
                if state is None:
                    curve.warnings.append("the state at the peak could not be recalculated and is therefore not saved")
                else:
                    kept.append(state)
        for step in (self.drop_step, self.last_step):
            if step is not None and step.event not in {s.event for s in kept}:
                kept.append(step)
        kept[:] = [state for _, state in sorted({state.event: state for state in kept}.items())]


def run_reference_loads(
    core_model: core.Model,
    model: EventModel,
    options: Staged,
    sign: int,
    before: float,
    progress: Callable[[float, float, str], None],
    fresh: bool,
    chain: Chain | None,
    stop: core.Stop,
) -> Curve:
    """Events under A + lambda B until `stop`; states at the wanted events, at the peak and at the end.

    before: control displacement of A alone [m], in the sense of the load. fresh: A was not brought on with damage before;
    it must be carried.
    """
    begin, ends_at = time.perf_counter(), time.process_time() + (options.budget or np.inf)
    stop = replace(stop, refuse_overload=fresh and bool(np.any(model.constant)), far=FAR * model.extent)
    wanted = sorted({e - 1 for e in options.states if 1 <= e <= options.events})
    way = UnderWay((core_model.damage(), 0))
    if chain is not None and chain.state is not None:
        kept = chain.state[1]
        way = UnderWay.of(kept)
        core_model.renew(kept["damage"], kept["standing"])
    goes_on = options.without_equilibrium == "continue" and core_model.continues and model.continues
    variant = "load-unload" if options.without_equilibrium == "continue" else options.without_equilibrium
    follow(core_model, model, options.continuation if goes_on else None)
    if goes_on and (model.steps_alone or options.continuation in FROM_THE_START) and not core_model.iterates:
        core_model.go_on(core_model.displacement(0.0))
    ends_by_drift = goes_on and stop.displacement == np.inf and not stop.side
    if ends_by_drift:
        stop = replace(stop, displacement=DRIFT * model.reach)
    run = _Run(core_model, model, options, sign, before, stop, way, wanted, variant, goes_on, way.seconds, begin, ends_at, way.before_best)
    run.loop(progress, chain)
    return run.curve(ends_by_drift)


def follow(core_model: core.Model, model: EventModel, how: str | None) -> None:
    """How a stage goes on without equilibrium under its constant loads, see core.Model.follow."""
    reach = 1.0 if how is None else model.reach
    core_model.follow("newton" if how == "steps" else how, LONGEST_STEP * reach, RUNAWAY * reach, 1.0 if model.driven else abs(model.unit))


def _incremental_stage(
    core_model: core.Model, model: EventModel, options: Staged, sign: int, progress: Callable[[float, float, str], None], before: float
) -> Curve:
    """The same loads by the incremental peer; its last state is kept."""
    begin = time.perf_counter()
    events = run_incremental(core_model, model, options, sign, progress)
    events.monitors *= sign
    kept_states = [_state(core_model, len(events) - 1, events)] if len(events) else []
    curve = Curve(
        events,
        None,
        kept_states,
        NOTHING,
        core_model.damage(),
        time.perf_counter() - begin,
        sign,
        [],
        core_model.equations,
        core_model.points,
        before=before,
        unit=model.unit,
        extent=model.extent,
        control=model.control,
    )
    if len(events):
        curve.residual = core_model.residual()
        curve.most_compliance = (MECHANISM_OF_STONES if model.mesh.has_joints else MECHANISM) * float(events.compliance[0])
    return curve


def _state(core_model: core.Model, event: int, events: core.Events) -> State:
    """The state of the last of some events, which has this number; with the part of the loads that is on."""
    load, scale = float(events.load[-1]), float(events.scale[-1])
    report = core_model.report(load)
    if scale < 1.0:
        report |= {name: scale * report[name] for name in STRAINS_AND_STRESSES}
    return State(event, load, scale * core_model.displacement(load), report, core_model.damage())


def _replay(
    core_model: core.Model, model: EventModel, sign: int, events: core.Events, event: int, before: tuple[np.ndarray, int], variant: str
) -> State | None:
    """The state of an event that has passed, run again from the damage kept before it."""
    damage, first = before

    def begin() -> None:
        core_model.set_damage(damage)
        _settled(core_model, model)
        core_model.loads(model.constant, sign * model.reference)
        if first:  # friction that slides looks on from the multiplier reached
            core_model.renew(damage, core_model.standing_at(float(events.load[first - 1])))

    begin()
    again = core_model.run_whole(event - first + 1, model.control, variant=variant)
    # Near a mechanism of stiff stones the last digits of the load, and so the order of events, depend on the way there
    tolerance = 1e-4 if model.mesh.has_joints else 1e-6
    away = np.abs(again.load - events.load[event]) > tolerance * abs(events.load[event])
    if not len(again) or ((away[-1] or len(again) != event - first + 1) and not model.mesh.has_joints):
        return None
    if away[-1]:
        begin()
        again = core_model.run_whole(event - first + 1 + MORE, model.control, variant=variant)
        away = np.abs(again.load - events.load[event]) > tolerance * abs(events.load[event])
        near = np.flatnonzero(~away & again.equilibrium)
        if not len(near):
            return None
        begin()
        again = core_model.run_whole(int(near[-1]) + 1, model.control, variant=variant)
    return _state(core_model, event, again)


def damage_before(start: np.ndarray, end: np.ndarray, point: np.ndarray, code: np.ndarray) -> np.ndarray:
    """The damage after the events (point, code), from the damage before the first and one after the last.

    For cracks that stay as they are once they are fixed: their directions are taken from `end`.
    """
    damage = start.copy()
    for p, c in zip(point.tolist(), code.tolist(), strict=True):
        k = (c - EVENT["tension"]) % 2  # 0 across the first crack, 1 across the second
        if not damage[2, p]:
            damage[:3, p] = end[:3, p]
        if c <= EVENT["tension_s"]:
            damage[3 + k, p] += 1.0
        elif c <= EVENT["compression_s"]:
            damage[5 + k, p] += 1.0
        else:
            damage[7 + k, p] = 1.0 if c <= EVENT["close_s"] else 0.0
            damage[9 + k, p] += 1.0
    return damage
