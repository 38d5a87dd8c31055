"""Stages of a building one after the other: pushes to either sense, ground that gives way; loads stay on, damage is inherited."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.context import Refused
from extrados.analyses.shell.model import ShellModel, how_far, mass_push
from extrados.analyses.shell.tables import Pushover, PushStage
from extrados.analyses.sla.events import NOTHING_DONE, Curve, bring_on_constant_loads, run_reference_loads
from extrados.core import sla as core

NOWHERE = np.empty(0)


def run_stages(
    model: ShellModel, options: Pushover, threads: int, progress: Callable[[float, float, str], None], chain: Callable[[Any], Chain]
) -> list[tuple[ShellModel, Curve]]:
    """The curves of all stages with the model of each, up to the first that leaves no state to go on from.

    chain: where the states of a stage are kept on its way, by what it depends on.
    """
    found: list[tuple[ShellModel, Curve]] = []
    with model.open(options, threads) as core_model:
        sound = {d: _compliance(core_model, mass_push(model, options, d)[0]) for d in _directions(options)}
        warnings: list[str] = []
        stage_a, _ = bring_on_constant_loads(core_model, model, options, progress, warnings, chain(["A"]))
        if stage_a is not None and stage_a.interrupted:
            curve = Curve.stopped(core_model, stage_a)
            curve.name = options.stage_names[0]
            return [(model, curve)]
        applied, moved, damage = model.constant, model.settled.copy(), core_model.damage()
        ledger, events = NOTHING_DONE, 0
        path: tuple[np.ndarray, np.ndarray] | None = None  # displacements and histories at the end of steps
        if stage_a is not None and len(stage_a):
            ledger, events = stage_a.ledger, int(stage_a.number[-1])
        pushed: list[tuple[np.ndarray, float]] = []  # the load of each push, and its multiplier
        for k, stage in enumerate(options.stages):
            name = options.stage_names[k]
            staged = _staged(model, options, stage, applied, moved, pushed)
            core_model.set_damage(damage)
            if len(moved):
                core_model.supports(moved, staged.rate if staged.driven else np.zeros(len(moved)))
            core_model.loads(staged.constant, staged.reference, carried=True, events=events, ledger=ledger)
            if path is not None:
                core_model.go_on(*path)
            start = core_model.displacement(0.0) if path is None else path[0]
            if staged.driven and path is None:
                staged.already = float(core_model.reactions()[:, 0] @ staged.rate)
            if staged.driven:
                staged.control = _of_ground(staged)
            watch = staged.control
            before = float(watch.share @ start[watch.node, watch.direction])
            own = options.model_copy(
                update={
                    "events": stage.events or options.events,
                    "stop_fraction": stage.stop_fraction,
                    "target_displacement": None,
                    "without_equilibrium": options.rule,
                    **({} if k == options.main else {"states": [], "probes": []}),
                }
            )
            told = lambda done, total, text, name=name: progress(done, total, f"stage {name}, {text}")  # noqa: E731
            stop = _stop(model, staged, stage, before, k)
            if not staged.driven and path is None:
                # A mechanism by the compliance of the building as it was: a stage may begin with little of it left
                softer = _softness(core_model, staged.reference, start) / sound[_direction(options, stage)]
                stop = replace(stop, compliance=max(model.mechanism_ratio / softer, 1.0))
            curve = run_reference_loads(core_model, staged, own, 1, before, told, False, chain([k, damage, moved]), stop)
            curve.name, curve.damage_start = name, damage
            curve.acceleration = staged.acceleration
            curve.sign = -1 if stage.sense == "-" else 1  # its displacements have it already
            if not found:
                curve.stage_a = stage_a
                curve.warnings += warnings
            found.append((staged, curve))
            if not curve.leads_on(options.stage_names[k + 1 :]):
                break
            if path is not None and staged.driven and len(curve.events):
                curve.already = float(curve.events.pull[0])
            path = None if curve.histories is None else (curve.states[-1].displacement, curve.histories)
            done = curve.events
            reached, damage = float(done.load[-1]), curve.damage_end
            ledger, events = done.ledger, int(done.number[-1])
            applied = staged.constant + reached * staged.reference
            if staged.driven:
                moved = moved + reached * staged.rate
            else:
                pushed.append((staged.reference, reached))
    return found


def _staged(
    model: ShellModel, options: Pushover, stage: PushStage, applied: np.ndarray, moved: np.ndarray, pushed: list[tuple[np.ndarray, float]]
) -> ShellModel:
    """The model of a stage; the supports stand where the core was told."""
    if stage.settlements:
        rate = how_far(model.mesh, model.grounds, stage.settlements)
        return replace(
            model, constant=applied, reference=np.zeros_like(applied), unit=1.0, acceleration=None, rate=rate, settled=NOWHERE, stands=moved
        )
    force, along = mass_push(model, options, _direction(options, stage))
    sign = 1.0 if stage.sense == "+" else -1.0
    axis, control = np.flatnonzero(along), model.control
    if options.control is None and stage.direction is not None:
        nodes = np.unique(control.node)
        share = np.array([np.abs(control.share[control.node == n]).max() for n in nodes])
        share /= share.sum()
        control = core.Monitor(np.repeat(nodes, len(axis)), np.tile(axis, len(nodes)), np.outer(share, along[axis]).ravel())
    unit = float(np.abs(force[:, :3] @ along).sum())
    reference = sign * force
    size = float((reference * reference).sum())
    already = sum(
        multiplier * float((other * reference).sum()) / size
        for other, multiplier in pushed
        if np.abs(np.abs(other) - np.abs(reference)).max() <= 1e-9 * np.abs(reference).max()
    )
    return replace(
        model,
        constant=applied,
        reference=reference,
        unit=unit,
        already=unit * already,
        along=along,
        settled=NOWHERE,
        stands=moved,
        control=core.Monitor(control.node, control.direction, sign * control.share),
    )


def _direction(options: Pushover, stage: PushStage) -> float:
    return options.direction if stage.direction is None else stage.direction


def _directions(options: Pushover) -> set[float]:
    """Of all pushes [deg]."""
    return {_direction(options, stage) for stage in options.stages if not stage.settlements}


def _compliance(core_model: core.Model, force: np.ndarray) -> float:
    """Work of forces through the displacements that they cause [J]."""
    core_model.loads(np.zeros_like(force), force)
    return float((force * core_model.displacement(1.0)).sum())


def _softness(core_model: core.Model, force: np.ndarray, start: np.ndarray) -> float:
    """The same in the state that the core has, beyond the displacements of what is on already [J]."""
    return float((force * (core_model.displacement(1.0) - start)).sum())


def _of_ground(staged: ShellModel) -> core.Monitor:
    """The way of the ground that moves most in a stage."""
    which = int(np.abs(staged.rate).argmax())
    equation = int(staged.freedoms.equation.max()) + 1 - len(staged.rate) + which
    node, direction = np.argwhere(staged.freedoms.equation == equation)[0]
    return core.Monitor(np.array([node]), np.array([direction]), np.array([1.0 / staged.freedoms.factor[node, direction]]))


def _stop(model: ShellModel, staged: ShellModel, stage: PushStage, now: float, number: int) -> core.Stop:
    """When a stage ends."""
    if staged.driven:
        return core.Stop(load=1.0, compliance=model.mechanism_ratio)
    load, target, side = np.inf, 0.0, 0
    if stage.base_shear is not None:
        load = (stage.base_shear - staged.already) / staged.unit
        if not load > 0.0:
            raise Refused(
                f"stages[{number}].base_shear: at the start of this stage, the base shear in this direction is "
                f"already {staged.already:.4g} N, which is not below the given {stage.base_shear:.4g} N. To reduce the "
                "base shear, apply the load in the opposite direction",
                ("analysis", "stages", number, "base_shear"),
            )
    if stage.target_displacement is not None:
        # The control displacement counts in the sense of the stage
        target = stage.target_displacement
        side = int(np.sign(target - now))
        if side == 0:
            raise Refused(
                f"stages[{number}].target_displacement: give another value. The control displacement is already {now:g} m when the stage starts",
                ("analysis", "stages", number, "target_displacement"),
            )
    return core.Stop(
        load=load,
        fraction=stage.stop_fraction or -1.0,
        compliance=model.mechanism_ratio,
        target=target,
        side=side,
        already=staged.already / staged.unit,
    )
