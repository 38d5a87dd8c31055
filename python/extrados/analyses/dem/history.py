"""dem under a motion: from rest under the own weight to the end, to rest or to collapse."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import files as dem_files
from extrados.analyses.dem import measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.friction import friction_threshold
from extrados.analyses.dem.job import watched
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.trial import Trial
from extrados.analyses.dem.variations import vary
from extrados.analyses.dem.words import motion_answer
from extrados.analyses.limit.common import geometry_arrays
from extrados.core import dem
from extrados.model.structures.block import BlockAssembly
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData
from extrados.views.rockers.block import BlockModel


@dataclass(frozen=True)
class Seen:
    """What is read off a run: openings and slip of the joints (time, joint) [m] and what these do (results.dem), rotations
    of the blocks (time, block) [rad] and those followed, displacements and losses of height [m] and rotations [rad] of the
    bodies (time, body), how far joints that touch slide, blocks off their footings, and the ground's acceleration (time) [m/s^2]."""

    gap_p: np.ndarray
    gap_q: np.ndarray
    slip: np.ndarray
    state: np.ndarray
    rotation: np.ndarray
    tracked: list[int]
    moved: tuple[np.ndarray, np.ndarray, np.ndarray]
    sliding: measures.Slip
    off_footing: list[int]
    ground: np.ndarray

    @property
    def farthest(self) -> float:
        """Greatest displacement of any block at any time [m]."""
        return float(self.moved[0].max(initial=0.0))


def run(context: Context, options: Dem, model: Model) -> Result:
    """The run, and with it what else the deck asks: variations, the least friction."""
    trial = Trial(context, options, model)
    # The rates after and before impacts of a single block need a fine history.
    step = min(options.output_step, 0.002) if model.rigid.count == 1 else options.output_step
    job = trial.job([model.values], output_step=step)
    found = dem_model.checked(watched(context, "dem-motion", job, "discrete elements"), model)
    ground = context.motion.sample(found.time) if context.deck.motion else np.zeros(len(found.time))
    seen = _look(options, model, found, ground)
    result = Result("dem", status="interrupted" if found.interrupted else "ok")
    again = "; --resume goes on from here" if context.checkpoint is not None and len(found.time) else ""
    result.reason = f"interrupted at {found.stop_time:.3f} s{again}" if found.interrupted else ""
    numbers = _numbers(options, trial, found, seen) | {"animation": options.animation}
    _store(options, model, found, seen, result)
    if seen.sliding.ratio > measures.SLIDES:
        result.warnings.append(f"joints slide by up to {1e3 * seen.sliding.peak:.3g} mm")
    if who := numbers["off_footing"]:
        result.warnings.append(
            f"{', '.join(who[:6])} slides off its footing: floor = {measures.ground_level(model):.4g} names a floor to slide on"
        )
    if found.residual > 0.01:
        result.warnings.append(
            f"the energy ledger is off by {100 * found.residual:.2g} % of the energy that went round"
        )
    result.warnings += dem_model.unconverged(found.effort)
    if numbers["still_moving"]:
        result.warnings.append("it still moves at the end of the run: a longer end_time may show another outcome")
    if trial.idle:
        result.warnings.append("nothing moves it: add [motion], [[initial.movements]] or [initial] rotation_ratio")
    if not found.interrupted:
        _further(context, options, trial, result, numbers)
    result.results = out.DemRun(**numbers)
    result.files |= dem_files.files(model, found, options)
    result.answer = motion_answer(result.results, trial.idle)
    return result


def _look(options: Dem, model: Model, found: dem.Run, ground: np.ndarray) -> Seen:
    gap_p, gap_q, slip = measures.openings(model, found)
    state = measures.hinges(model, gap_p, gap_q, slip)
    body = model.rigid.body_of_block
    off = [] if options.floor is not None else measures.off_their_footings(model, state, slip)
    return Seen(
        gap_p, gap_q, slip, state, -(found.place[:, body, 2] - found.settled[body, 2]),
        measures.tracked(model, options, found), measures.movements(model, found),
        measures.Slip.of(state, slip, model.assembly.length), off, ground,
    )  # fmt: skip


def _numbers(options: Dem, trial: Trial, found: dem.Run, seen: Seen) -> dict[str, Any]:
    """The results of the run itself."""
    model, names = trial.model, trial.model.assembly.block_names
    peak = np.abs(seen.rotation).argmax(axis=0)
    mobile = slice(0, model.rigid.count)
    unsupported = {int(model.rigid.body_of_block[i]) for i in seen.off_footing}
    slides = seen.sliding.ratio > measures.SLIDES
    fate = measures.fate(
        found, trial.collapse, *seen.moved, unsupported, bool((seen.state != out.CLOSED).any()), slides
    )
    return {
        "outcome": fate.outcome,
        "collapse_criterion": fate.criterion,
        "collapse_time_s": fate.time,
        "governing_block": model.rigid.names[fate.block],
        "stopped": found.reason,
        "stopped_by": [model.rigid.names[k] for k in found.blamed],
        "stop_time_s": found.stop_time,
        "still_moving": found.reason == "end" and measures.moving(found, model),
        "peak_rotation_rad": {names[i]: float(seen.rotation[peak[i], i]) for i in seen.tracked},
        "collapse_displacement_m": trial.collapse.displacement,
        "peak_displacement_m": measures.peak_displacement(found, seen.farthest, trial.collapse.displacement),
        "peak_slip_m": seen.sliding.peak,
        "residual_slip_m": seen.sliding.residual,
        "slip_ratio": seen.sliding.ratio,
        "slipped_joint": model.assembly.joint_names[seen.sliding.joint] if slides else None,
        "off_footing": [names[i] for i in seen.off_footing],
        "peak_kinetic_energy_J": float(found.energy["kinetic"].max(initial=0.0)),
        "friction_loss_J": float(found.energy["friction"][-1]) if len(found.time) else 0.0,
        "damping_loss_J": float(found.energy["damping"][-1]) if len(found.time) else 0.0,
        "energy_residual_ratio": found.residual,
        "restitution_measured": measures.restitution(found, seen.state, seen.ground)
        if model.rigid.count == 1
        else None,
        "restitution_housner": float(BlockModel(model.assembly).housner[0])
        if isinstance(model.assembly, BlockAssembly)
        else None,
        "bounces": int(found.bounces[mobile].sum()),
        "airborne_time_s": float(found.airborne[mobile].max(initial=0.0)),
        "solver": options.solver,
        "convergence": measures.convergence(found.effort) if options.rigid else None,
        **measures.springs(options, model.values, found),
        "steps": found.steps,
        "settling_steps": found.settling_steps,
        "time_step_s": found.step,
        "contact_searches": found.searches,
    }


def _store(options: Dem, model: Model, found: dem.Run, seen: Seen, result: Result) -> None:
    """Arrays and tables of the run into `result`."""
    names = model.assembly.block_names
    result.tables["dem"] = TableData(
        {
            "time": found.time,
            **{f"rotation of {names[i]}": seen.rotation[:, i] for i in seen.tracked},
            **{f"{name}_energy": values for name, values in found.energy.items() if name != "leapfrog"},
        },
        {
            "time": "s",
            **{f"rotation of {names[i]}": "rad" for i in seen.tracked},
            **{f"{name}_energy": "J" for name in found.energy},
        },
    )
    result.tables["dem_hinges"] = measures.hinge_table(model, found.time, seen.state)
    result.arrays = {
        **geometry_arrays(model.assembly),
        "time": Array(found.time, ("time",), "s", "output times"),
        "place": Array(
            measures.block_places(model, found.place),
            ("time", "block", "component"),
            "m, m, rad",
            "centroid and rotation of the blocks",
        ),
        "rate": Array(measures.block_rates(model, found), ("time", "block", "component"), "m/s, m/s, rad/s"),
        "rotation": Array(seen.rotation, ("time", "block"), "rad", "from the settled state, positive to +x"),
        "tracked": Array(np.array(seen.tracked), ("tracked",), "", "blocks whose rotation is reported"),
        "hinge": Array(
            seen.state, ("time", "joint"), "", "0 closed, -1 hinged at the first end, 1 at the second, 2 open"
        ),
        "opening_p": Array(seen.gap_p, ("time", "joint"), "m", "gap at the first ends of the joints"),
        "opening_q": Array(seen.gap_q, ("time", "joint"), "m", "gap at the second ends"),
        "slip": Array(seen.slip, ("time", "joint"), "m", "slip at the closed ends"),
        **{
            f"{name}_energy": Array(values, ("time",), "J")
            for name, values in found.energy.items()
            if name != "leapfrog"
        },
        "ground": Array(seen.ground, ("time",), "m/s^2"),
        "snapshot_time": Array(measures.snapshot_times(options, found), ("snapshot",), "s"),
        **measures.support_arrays(model),
    }


def _further(context: Context, options: Dem, trial: Trial, result: Result, numbers: dict[str, Any]) -> None:
    """Variations and the search for the friction, into `numbers`; what stops them leaves the run itself as it is."""
    try:
        numbers |= vary(context, options, trial, result)
        if options.find_friction:
            numbers["friction_threshold"] = friction_threshold(context, trial, options.slip)
    except Unfinished as error:
        result.status = "interrupted" if error.interrupted else "failed"
        result.reason = f"in the variations or the friction search: {error}; the run before them is complete"
    except Refused as error:
        numbers["friction_threshold"] = None
        result.warnings.append(f"the least friction was not found: {error}")
