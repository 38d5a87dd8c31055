"""Stages one after the other on one wall: supports that change between them, loads that stay on, damage inherited.

A secant analysis is one of total displacements: a support that comes later holds its nodes at the displacement they have,
which acts on the rest as a constant load; one that is taken away leaves its force as a load, which goes to nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.sla.events import NOTHING_DONE, Curve, bring_on_constant_loads, run_reference_loads
from extrados.analyses.sla.model import AXES, SlaModel, acceleration_of, control_of, nodal_forces, refusal, resultant
from extrados.analyses.sla.tables import Hold, Sla, Stage
from extrados.core import sla as core
from extrados.model.errors import BadGeometry

#: Displacements at the start of a stage may differ from those at the end of the one before by this part of the greatest
SAME = 1e-6


@dataclass
class Wall:
    """Where the wall stands between two stages: displacements (nodes, 2) [m], nodal forces (nodes, 2) [N], damage,
    energies [J] and events so far; by equation, those of supports last, `fixed`; the loads of each stage and their
    multiplier."""

    displacement: np.ndarray
    applied: np.ndarray
    damage: np.ndarray
    ledger: tuple[float, float, float]
    events: int
    fixed: np.ndarray
    loads: list[tuple[np.ndarray, float]]
    histories: np.ndarray | None = None  # (2, points), of a stage that ended with equilibrium iterations: the next begins so


class Supports:
    """The freedoms of a wall, those of its supports too, each with an equation of its own."""

    def __init__(self, model: SlaModel):
        self.model = model
        equation = np.array(model.freedoms.equation)
        held = equation < 0
        count = int(equation.max()) + 1
        equation[held] = count + np.arange(int(held.sum()))
        self.equation, self.factor = equation, np.array(model.freedoms.factor)
        self.count = count + int(held.sum())
        self.held = np.arange(self.count) >= count
        order = np.argsort(np.abs(self.factor), axis=None, kind="stable")
        self.node_of = np.empty(self.count, dtype=int)  # the freedom, of all (node, direction), that has most of it
        self.node_of[equation.ravel()[order]] = order

    def at(self, places: list[Hold], what: str) -> np.ndarray:
        """The equations that places mean."""
        found = [
            self.equation[self.model.mesh.nodes_at(place, f"{what}[{i}]"), AXES[letter]]
            for i, place in enumerate(places)
            for letter in place.fix
        ]
        return np.unique(np.concatenate(found)) if found else np.empty(0, dtype=int)

    def values(self, displacement: np.ndarray) -> np.ndarray:
        """The displacement of each equation [m]."""
        return displacement.ravel()[self.node_of] / self.factor.ravel()[self.node_of]

    def forces(self, equation: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Forces on equations as nodal forces (nodes, 2) [N]."""
        nodal = np.zeros(self.equation.size)
        nodal[self.node_of[equation]] = force / self.factor.ravel()[self.node_of[equation]]
        return nodal.reshape(-1, 2)

    def freedoms(self, fixed: np.ndarray, moved: np.ndarray) -> core.Freedoms:
        """Freedoms of a stage: `fixed` equations are held, those that are `moved` too at a displacement."""
        number = np.full(self.count, -1)
        free = np.flatnonzero(~fixed)
        if not len(free):
            raise BadGeometry("every node is restrained, so nothing can move: remove supports")
        number[free] = np.arange(len(free))
        number[moved] = len(free) + np.arange(len(moved))
        return core.Freedoms(number[self.equation], self.factor, len(moved))

    def rates(self, stage: Stage, what: str) -> np.ndarray:
        """By equation how far it moves with the multiplier, of a stage that moves places."""
        rate = np.full(self.count, np.nan)
        load = stage.reference[0]
        for i, part in enumerate(load.parts):
            nodes = self.model.mesh.nodes_at(part, f"{what}.parts[{i}]")
            at, by = self.equation[nodes, AXES[load.direction]], part.ratio / self.factor[nodes, AXES[load.direction]]
            if (np.isfinite(rate[at]) & (rate[at] != by)).any():
                raise BadGeometry(f"{what}: two parts of the displacement move the same node, or nodes that are tied together")
            rate[at] = by
        if not np.nan_to_num(rate).any():
            raise BadGeometry(f"{what}: every `ratio` is 0, so nothing moves: give a `ratio` other than 0")
        return rate


def run_stages(
    model: SlaModel, options: Sla, threads: int, progress: Callable[[float, float, str], None], chain: Callable[[list], Chain] | None = None
) -> list[Curve]:
    """The curves of all stages, up to the first that leaves no state to go on from.

    chain: where the states of a stage are kept on its way, by what it depends on.
    """
    supports = Supports(model)
    curves: list[Curve] = []
    with model.open(options, threads) as core_model:
        warnings: list[str] = []
        stage_a, _ = bring_on_constant_loads(core_model, model, options, progress, warnings, chain and chain(["A"]))
        if stage_a is not None and stage_a.interrupted:
            curve = Curve.stopped(core_model, stage_a)
            curve.name = options.stage_names[0]
            return [curve]
        wall = _under_constant_loads(core_model, supports, stage_a)
    for k, stage in enumerate(options.stages):
        name = options.stage_names[k]
        try:
            staged, stop, own = _prepare(supports, wall, stage, options, f"stages[{k}]", threads, k == options.main)
        except BadGeometry as error:
            raise refusal(error) from None
        told = lambda done, total, text, name=name: progress(done, total, f"stage {name}, {text}")  # noqa: E731
        with staged.open(own, threads) as core_model:
            core_model.set_damage(wall.damage)
            if len(staged.moved):
                core_model.supports(*staged.moved.T)
            core_model.loads(staged.constant, staged.reference, carried=True, events=wall.events, ledger=wall.ledger)
            if wall.histories is not None:
                core_model.go_on(wall.displacement, wall.histories)
            if staged.driven and wall.histories is None:
                staged = replace(staged, already=float(core_model.reactions()[:, 0] @ staged.moved[:, 1]))
            start = wall.displacement if wall.histories is not None else core_model.displacement(0.0)
            away, most = np.abs(start - wall.displacement).max(), np.abs(wall.displacement).max()
            watch = staged.control
            before = float(watch.share @ start[watch.node, watch.direction])
            curve = run_reference_loads(core_model, staged, own, 1, before, told, False, chain and chain([k, wall.damage]), stop)
            curve.name, curve.damage_start = name, wall.damage
            if wall.histories is not None and staged.driven and len(curve.events):
                curve.already = float(curve.events.pull[0])
            curve.acceleration = staged.acceleration
            if not curves:
                curve.stage_a = stage_a
                curve.warnings += warnings
            if away > SAME * most and most > 0.0:
                curve.warnings.append(
                    f"stage {name} does not start exactly at the end of the stage before: nodes are up to {away:.2g} m away"
                )
            curves.append(curve)
            events = curve.events
            if not curve.leads_on(options.stage_names[k + 1 :]):
                break
            reached = float(events.load[-1])
            wall.histories = curve.histories
            if wall.histories is not None:
                wall.displacement, wall.damage = curve.states[-1].displacement, curve.damage_end
                wall.applied = staged.constant + reached * staged.reference
                wall.ledger = events.ledger
                wall.events = int(events.number[-1])
                wall.loads.append((staged.reference, reached))
                continue
            core_model.set_damage(curve.damage_end)  # the state of the peak was found again since
            core_model.loads(staged.constant, staged.reference)
            wall.displacement = core_model.displacement(reached)
            core_model.end_stage(reached)
            wall.damage = core_model.damage()
            wall.applied = staged.constant + reached * staged.reference
            wall.ledger = events.ledger
            if model.slides:
                # Friction that slid is a spring again, whose energy was counted as dissipated
                gained = _stored(core_model, staged, wall.applied, reached) - float(events.stored[-1])
                wall.ledger = (wall.ledger[0], wall.ledger[1] - gained, wall.ledger[2])
        wall.events = int(events.number[-1])
        wall.loads.append((staged.reference, reached))
    return curves


def _under_constant_loads(core_model: core.Model, supports: Supports, stage_a: core.Events | None) -> Wall:
    """The wall at the start of the first stage; stage_a: events while the constant loads came on."""
    model = supports.model
    core_model.loads(model.constant, np.zeros_like(model.constant), carried=True)
    wall = Wall(core_model.displacement(0.0), model.constant, core_model.damage(), NOTHING_DONE, 0, supports.held.copy(), [])
    if stage_a is not None and len(stage_a):
        wall.ledger = stage_a.ledger
        wall.events = int(stage_a.number[-1])
    elif np.any(model.constant):  # they are on, and nothing cracked
        work = 0.5 * float((model.constant * wall.displacement).sum())
        wall.ledger = (work, 0.0, 0.0)
    return wall


def _stored(core_model: core.Model, staged: SlaModel, applied: np.ndarray, reached: float) -> float:
    """The elastic energy of a stage's last state, all loads constant [J]."""
    if len(staged.moved):
        core_model.supports(staged.moved[:, 0] + reached * staged.moved[:, 1], np.zeros(len(staged.moved)))
    core_model.loads(applied, np.zeros_like(applied), carried=True)
    return float(core_model.run_whole(1, staged.control, core.Stop(load=0.0)).stored[0])


def _prepare(
    supports: Supports, wall: Wall, stage: Stage, options: Sla, what: str, threads: int, main: bool
) -> tuple[SlaModel, core.Stop, Sla]:
    """The model of a stage, when it ends, and its options. What only the main stage has: states, probes, sections."""
    model, mesh = supports.model, supports.model.mesh
    wall.fixed[supports.at(stage.hold, f"{what}.hold")] = True
    value, rate = supports.values(wall.displacement), np.zeros(supports.count)
    constant, reference = wall.applied, np.zeros_like(wall.applied)
    if stage.free:
        freed = supports.at(stage.free, f"{what}.free")
        if not wall.fixed[freed].all():
            raise BadGeometry(f"{what}.free: one of these places is not restrained when this stage begins: remove it")
        force = supports.forces(freed, _reactions(supports, wall, options, freed, threads))
        wall.fixed[freed] = False
        wall.loads.append((force, 1.0))
        constant, reference = constant + force, -force
    elif stage.moves:
        moves = supports.rates(stage, f"{what}.reference[0]")
        wall.fixed |= np.isfinite(moves)
        rate = np.nan_to_num(moves)
    else:
        reference = nodal_forces(mesh, stage.reference, f"{what}.reference")
        if not (~wall.fixed[supports.equation] & (reference != 0.0)).any():
            raise BadGeometry(f"{what}: the reference load acts only on nodes that are restrained: load other nodes")
    moved = np.flatnonzero(wall.fixed & ((value != 0.0) | (rate != 0.0)))
    unit = 1.0 if stage.moves else resultant(reference)
    own = options.model_copy(
        update={
            "control": stage.control or options.control,
            "events": stage.events or options.events,
            "stop_fraction": stage.stop_fraction,
            "target_displacement": None,
            **({} if main else {"states": [], "probes": []}),
        }
    )
    staged = replace(
        model,
        freedoms=supports.freedoms(wall.fixed, moved),
        constant=constant,
        reference=reference,
        unit=unit,
        moved=np.column_stack([value[moved], rate[moved]]),
        already=unit * _already(wall.loads, reference),
        control=_control(supports, own, reference, unit, rate),
        acceleration=acceleration_of(stage.reference),
    )
    target, side = 0.0, 0
    if stage.target_displacement is not None:
        watch = staged.control
        now = float(watch.share @ wall.displacement[watch.node, watch.direction])
        target = stage.target_displacement
        side = int(np.sign(target - now))
        if side == 0:
            raise BadGeometry(f"{what}.target_displacement: at the start of this stage the control displacement is already {now:g} m")
    multiplier = stage.target_multiplier or (1.0 if stage.free else np.inf)
    stop = core.Stop(
        load=multiplier,
        fraction=stage.stop_fraction or -1.0,
        compliance=model.mechanism_ratio,
        target=target,
        side=side,
        already=staged.already / unit,
    )
    return staged, stop, own


def _control(supports: Supports, options: Sla, reference: np.ndarray, unit: float, rate: np.ndarray) -> core.Monitor:
    """The control displacement of a stage: that of what it moves, where nothing else is said."""
    if options.control or not rate.any():
        return control_of(supports.model.mesh, options, reference, unit)
    equation = int(np.abs(rate).argmax())
    node, direction = divmod(int(supports.node_of[equation]), 2)
    return core.Monitor(np.array([node]), np.array([direction]), np.array([1.0 / (rate[equation] * supports.factor[node, direction])]))


def _reactions(supports: Supports, wall: Wall, options: Sla, equation: np.ndarray, threads: int) -> np.ndarray:
    """Forces [N] of supports on the wall as it stands."""
    value = supports.values(wall.displacement)
    asked = np.isin(np.arange(supports.count), equation)
    moved = np.flatnonzero(wall.fixed & (asked | (value != 0.0)))
    held = replace(supports.model, freedoms=supports.freedoms(wall.fixed, moved))
    with held.open(options, threads) as core_model:
        core_model.set_damage(wall.damage)
        core_model.supports(value[moved], np.zeros(len(moved)))
        core_model.loads(wall.applied, np.zeros_like(wall.applied), carried=True)
        force = core_model.reactions()[:, 0]
    # What acts on the support itself is not carried by the wall
    own = np.bincount(supports.equation.ravel(), (supports.factor * wall.applied).ravel(), supports.count)
    return force[np.searchsorted(moved, equation)] - own[equation]


def _already(loads: list[tuple[np.ndarray, float]], reference: np.ndarray) -> float:
    """Multiplier of loads in the direction of `reference` that earlier stages have left on."""
    size = float((reference * reference).sum())
    total = 0.0
    for other, multiplier in loads:
        if size > 0.0:
            part = float((other * reference).sum()) / size
            if np.abs(other - part * reference).max() <= 1e-9 * np.abs(reference).max():
                total += part * multiplier
    return total
