"""One event curve: stages A and B in batches, with the states that are wanted.

Every KEPT events the factor is made anew and the state is kept, in every run: one that is resumed there gives the
same bits as one that was never interrupted.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.context import Refused
from extrados.analyses.sla.contact import settle
from extrados.analyses.sla.curve import envelope
from extrados.analyses.sla.kept import State, UnderWay
from extrados.analyses.sla.model import SlaModel
from extrados.analyses.sla.tables import Sla
from extrados.core import sla as core
from extrados.core.errors import CoreError, status_code
from extrados.core.sla import EVENT

BATCH_SECONDS = 0.7
#: Events between two states that are kept; a new factor takes as long as some tens of events of a large wall.
KEPT = 1000
#: The peak's state is run again from the damage at the multiple of this number before it.
GRID = 100
#: Events beyond the peak's number among which its load is looked for, where it comes in another order
MORE = 30
NOTHING = np.zeros(0)


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
    residual: float | None = None  # measured at the end; None where the end is a mechanism without displacements

    @property
    def sense(self) -> str:
        return "+" if self.sign > 0 else "-"

    def envelope(self, unit: float) -> tuple[np.ndarray, np.ndarray]:
        """Displacements [m] and loads [N] of the envelope; it begins at the constant loads' displacement."""
        fine = self.events.equilibrium
        return envelope(self.events.monitors[fine, 0], self.events.load[fine] * unit, self.before)

    @property
    def peak(self) -> int:
        """The event of the greatest load in equilibrium; -1 where there is none."""
        load = np.where(self.events.equilibrium, self.events.load, -np.inf)
        return int(load.argmax()) if len(load) and np.isfinite(load.max()) else -1


def run_curves(
    model: SlaModel,
    options: Sla,
    threads: int,
    progress: Callable[[float, float, str], None],
    damage: np.ndarray | None = None,
    chain: Callable[[int], Chain] | None = None,
) -> list[Curve]:
    """The curves of all senses of B, each from the state that A leaves (or from a stored damage).

    chain: where the states of the curve of a sense, +1 or -1, are kept on its way; none are without it.
    """
    curves = []
    with model.open(options, threads) as core_model:
        stage_a, warnings, rubs = None, [], False
        if damage is not None:
            if damage.shape[1] != core_model.points:
                raise Refused(
                    f"resume_from: that wall has {damage.shape[1]} points with its bars, this one {core_model.points}"
                )
            core_model.set_damage(damage)
        else:
            rubs = settle(core_model, model, options, warnings)
        # Friction was found under the whole of A, and does not hold under a part of it
        if damage is None and not rubs and options.constant_damage and np.any(model.constant):
            stage_a = _constant_stage(core_model, model, options, progress)
        if stage_a is not None and len(stage_a):
            core_model.end_stage(float(stage_a.load[-1]))
        start = core_model.damage()
        ledger, events = _totals(stage_a)
        for number, sense in enumerate(options.directions):
            sign = 1 if sense == "+" else -1
            if number:
                core_model.set_damage(start)
            core_model.loads(
                model.constant, sign * model.reference, carried=stage_a is not None, events=events, ledger=ledger
            )
            watch = model.control
            before = sign * float(watch.share @ core_model.displacement(0.0)[watch.node, watch.direction])
            curve = _reference_stage(
                core_model, model, options, sign, progress, bool(stage_a is None and damage is None and not rubs),
                chain and chain(sign),
            )  # fmt: skip
            curve.stage_a, curve.before = stage_a, before
            curve.damage_start = start
            curve.warnings += warnings if not number else []
            curves.append(curve)
            if curve.events.interrupted:
                break
    return curves


def _totals(stage: core.Events | None) -> tuple[tuple[float, float, float], int]:
    if stage is None or not len(stage):
        return (0.0, 0.0, 0.0), 0
    return (float(stage.external[-1]), float(stage.dissipated[-1]), float(stage.crack[-1])), int(stage.number[-1])


def _constant_stage(
    core_model: core.Model, model: SlaModel, options: Sla, progress: Callable[[float, float, str], None]
) -> core.Events:
    """Bring the constant loads from 0 to 1, with damage where they ask for it."""
    core_model.loads(np.zeros_like(model.constant), model.constant)
    parts, done = [], 0
    stop = core.Stop(load=1.0, compliance=model.mechanism_ratio)
    while True:
        part = core_model.run(min(500, options.events - done), [model.control], stop)
        parts.append(part)
        done += len(part)
        progress(done, options.events, f"constant loads, event {done}")
        if part.reason or part.interrupted or done >= options.events:
            break
    events = core.Events.join(parts)
    if events.reason == "no point limits the load":
        return events  # nothing can crack under A: it is carried
    if events.reason != "target load" and not events.interrupted:
        most = float(events.load.max()) if len(events) else 0.0
        why = events.reason or f"{done} events were not enough"
        raise Refused(
            f"the constant loads are not carried: with damage the wall reaches {100 * most:.3g} % of them ({why})"
        )
    return events


def _reference_stage(
    core_model: core.Model,
    model: SlaModel,
    options: Sla,
    sign: int,
    progress: Callable[[float, float, str], None],
    fresh: bool,
    chain: Chain | None,
) -> Curve:
    """Events under A + lambda B; states at the wanted events, at the peak and at the end."""
    begin = time.perf_counter()
    target = np.inf if options.target_displacement is None else options.target_displacement
    stop = core.Stop(
        displacement=target, fraction=options.stop_fraction or -1.0, compliance=model.mechanism_ratio,
        refuse_overload=fresh and bool(np.any(model.constant)),
    )  # fmt: skip
    wanted = sorted({e - 1 for e in options.states if 1 <= e <= options.events})
    way = UnderWay((core_model.damage(), 0))
    if chain is not None and chain.state is not None:
        kept = chain.state[1]
        way = UnderWay.of(kept)
        core_model.renew(kept["damage"], kept["standing"])
    before = way.seconds
    batch, start = GRID, way.before_best
    while (done := way.done) < options.events:
        if done % KEPT == 0 and done:
            damage, standing = core_model.damage(), core_model.standing()
            try:
                core_model.renew(damage, standing)
            except core.FreeNode:
                way.parts[-1].reason = "mechanism"
                break
            way.seconds = before + time.perf_counter() - begin
            if chain is not None:
                chain.keep(done, way.arrays(damage, standing))
        if done % GRID == 0:
            # The event chosen last is not applied yet: a run from this damage records it again first
            start = (core_model.damage(), max(done - 1, 0))
        room = min(batch, GRID - done % GRID, options.events - done)
        ahead = [e for e in wanted if e >= done]
        if ahead:
            room = min(room, ahead[0] + 1 - done)
        clock = time.perf_counter()
        try:
            part = core_model.run(room, [model.control], stop)
        except CoreError as error:
            if error.status != status_code("beyond_strength"):
                raise
            raise Refused(
                "the constant loads alone exceed the strength, and no multiplier of the reference load relieves "
                "them: let constant_damage = true bring them on with damage, or lower them"
            ) from None
        spent = time.perf_counter() - clock
        way.parts.append(part)
        if len(part):
            load = np.where(part.equilibrium, part.load, -np.inf)
            if part.reason == "mechanism" and model.mesh.has_joints:
                load[-1] = -np.inf  # on the way of the mechanism
            if load.max() > way.best:
                way.best, way.before_best = float(load.max()), start
        done += len(part)
        if done and done - 1 in wanted:
            way.states.append(_state(core_model, done - 1, float(part.load[-1])))
        progress(done, options.events, f"event {done}, load {part.load[-1] * model.unit:.4g} N" if len(part) else "")
        if part.reason or part.interrupted or not len(part):
            break
        batch = int(np.clip(len(part) * BATCH_SECONDS / max(spent, 1e-3), 10, GRID))
    events, states = core.Events.join(way.parts), way.states
    events.monitors *= sign  # positive in the sense of the load
    collapsed = events.reason == "mechanism" and events.compliance[-1] > model.mechanism_ratio * events.compliance[0]
    if collapsed and model.mesh.has_joints:
        # Found on the way of the mechanism, which carries no more than the event before: it shows how the stones move
        events.equilibrium[-1] = False
    damage_end = core_model.damage()
    curve = Curve(events, None, states, NOTHING, damage_end, 0.0, sign, [], core_model.equations, core_model.points)
    if len(events):
        # A mechanism found while its event is applied leaves the displacements of the event before
        if events.reason != "mechanism" or (collapsed and not model.mesh.has_joints):
            curve.residual = core_model.residual()
        if not (done - 1 in wanted and states):
            states.append(_state(core_model, len(events) - 1, float(events.load[-1])))
        peak = curve.peak
        if peak >= 0 and peak not in {s.event for s in states} and not events.interrupted:
            state = _replay(core_model, model, sign, events, peak, way.before_best)
            if state is None:
                curve.warnings.append("the state at the peak could not be reproduced from the batch before it")
            else:
                states.append(state)
        states.sort(key=lambda s: s.event)
    curve.seconds = before + time.perf_counter() - begin
    return curve


def _state(core_model: core.Model, event: int, load: float) -> State:
    return State(event, load, core_model.displacement(load), core_model.report(load), core_model.damage())


def _replay(
    core_model: core.Model, model: SlaModel, sign: int, events: core.Events, event: int, before: tuple[np.ndarray, int]
) -> State | None:
    """The state of an event that has passed, run again from the damage kept before it."""
    damage, first = before

    def begin() -> None:
        core_model.set_damage(damage)
        core_model.loads(model.constant, sign * model.reference)
        if first:  # friction that slides looks on from the multiplier reached
            core_model.renew(damage, core_model.standing_at(float(events.load[first - 1])))

    begin()
    again = core_model.run(event - first + 1, [model.control], core.Stop())
    # Near a mechanism of stiff stones the last digits of the load, and so the order of events, depend on the way there
    tolerance = 1e-4 if model.mesh.has_joints else 1e-6
    away = np.abs(again.load - events.load[event]) > tolerance * abs(events.load[event])
    if not len(again) or ((away[-1] or len(again) != event - first + 1) and not model.mesh.has_joints):
        return None
    if away[-1]:
        begin()
        again = core_model.run(event - first + 1 + MORE, [model.control], core.Stop())
        away = np.abs(again.load - events.load[event]) > tolerance * abs(events.load[event])
        near = np.flatnonzero(~away & again.equilibrium)
        if not len(near):
            return None
        begin()
        again = core_model.run(int(near[-1]) + 1, [model.control], core.Stop())
    return _state(core_model, event, float(again.load[-1]))


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
