"""dem under a motion: from rest under the own weight to the end, to rest or to collapse."""

from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import files as dem_files
from extrados.analyses.dem import measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.forces import force_arrays, force_columns
from extrados.analyses.dem.friction import friction_threshold
from extrados.analyses.dem.job import Runs, watched
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.perturbed import probe_chaos
from extrados.analyses.dem.seen import Seen, begun_result, doubts_of_run, moved_supports, numbers_of
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.thrust import put_thrust
from extrados.analyses.dem.ties import segment_arrays, tie_arrays, tie_columns
from extrados.analyses.dem.trial import Trial
from extrados.analyses.dem.variations import vary
from extrados.analyses.dem.words import motion_answer
from extrados.analyses.limit.common import geometry_arrays
from extrados.core import dem
from extrados.model.structures.block import BlockAssembly
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.quantities import three_figures
from extrados.views.rockers.block import BlockModel


def run(context: Context, options: Dem, model: Model) -> Result:
    """The run, and with it what else the deck asks: variations, the least friction."""
    return follow(context, options, Trial(context, options, model))


def follow(context: Context, options: Dem, trial: Trial, name: str = "dem") -> Result:
    """What `run` does, of any trial; its times are those of the motion. name: of what is kept of it."""
    model = trial.model
    # The rates after and before impacts of a single block need a fine history.
    step = min(options.output_step, 0.002) if model.rigid.count == 1 else options.output_step
    job = trial.job([model.values], output_step=step)
    found = dem_model.checked(watched(context, f"{name}-motion", job, "discrete elements"), model)
    if trial.begin:
        found = replace(found, time=found.time + trial.starts, stop_time=found.stop_time + trial.starts)
    ground = context.motion.sample(found.time) if context.deck.motion else np.zeros(len(found.time))
    seen = Seen.of(model, found, options.floor is not None)
    result = begun_result(context, found)

    def look(one: dem.Run) -> Seen:
        return Seen.of(model, one, options.floor is not None)

    def job_of(factor: float) -> Runs:
        return trial.job([model.values], factor, output_step=step)

    chaos = probe_chaos(
        context,
        job_of if options.perturbed else None,
        trial.idle,
        found,
        model.rigid.count,
        trial.collapse,
        look,
        result,
        f"{name}-perturbed",
    )
    numbers = _numbers(options, trial, seen, ground) | chaos
    _store(options, seen, ground, result)
    numbers |= put_thrust(options, seen, result)
    if seen.slides:
        result.warnings.append(f"joints slide by up to {three_figures(1e3 * seen.sliding.peak)} mm")
    if who := numbers["off_footing"]:
        result.warnings.append(
            f"{', '.join(who[:6])} slides off its footing. If detached blocks can slide on a floor, give the "
            f"key `floor` = {measures.ground_level(model):.4g} of `dem`"
        )
    result.warnings += doubts_of_run(model, found, chaos["violated"], numbers["still_moving"])
    if trial.idle:
        result.warnings.append("no motion acts on the structure: add [motion], [[initial.movements]] or `rotation_ratio` of [initial]")
    if result.status == "ok":
        _further(context, options, trial, result, numbers)
    result.results = out.DemRun(**numbers)
    result.files |= dem_files.files(model, found, options)
    result.answer = motion_answer(result.results, trial.idle) + moved_supports(seen, trial.moves, 2, trial.ground is not None)
    return result


def _numbers(options: Dem, trial: Trial, seen: Seen, ground: np.ndarray) -> dict[str, Any]:
    """The results of the run itself; ground: its acceleration (time) [m/s^2]."""
    model, found, names = seen.model, seen.run, seen.model.assembly.block_names
    peak = np.abs(seen.rotation).argmax(axis=0)
    return numbers_of(options, seen, trial.collapse) | {
        "peak_rotation_rad": {names[i]: float(seen.rotation[peak[i], i]) for i in measures.tracked(model, options, found)},
        "restitution_measured": measures.restitution(found, seen.state, ground) if model.count == 1 else None,
        "restitution_housner": float(BlockModel(model.assembly).housner[0]) if isinstance(model.assembly, BlockAssembly) else None,
        **measures.water_force(model),
    }


def _store(options: Dem, seen: Seen, ground: np.ndarray, result: Result) -> None:
    """Arrays and tables of the run into `result`."""
    model, found, names = seen.model, seen.run, seen.model.assembly.block_names
    tracked = measures.tracked(model, options, found)
    result.tables["dem"] = TableData(
        {
            "time": found.time,
            **{f"rotation of {names[i]}": seen.rotation[:, i] for i in tracked},
            **{f"{name}_energy": values for name, values in found.energy.items() if name != "leapfrog"},
            **tie_columns(model.ties, found.tension),
            **force_columns(model, found),
        },
        {
            "time": "s",
            **{f"rotation of {names[i]}": "rad" for i in tracked},
            **{f"{name}_energy": "J" for name in found.energy if name != "leapfrog"},
            **dict.fromkeys(tie_columns(model.ties, found.tension) | force_columns(model, found), "N"),
        },
    )
    result.tables["dem_hinges"] = measures.hinge_table(model, found.time, seen.state)
    result.arrays = {
        **geometry_arrays(model.assembly),
        "time": Array(found.time, ("time",), "s", "output times"),
        "place": Array(
            measures.block_places(model, found.place), ("time", "block", "component"), "m, m, rad", "centroid and rotation of the blocks"
        ),
        "rate": Array(measures.block_rates(model, found), ("time", "block", "component"), "m/s, m/s, rad/s"),
        "rotation": Array(
            seen.rotation,
            ("time", "block"),
            "rad",
            "rotation of each block from its position at rest under the constant loads; positive towards +x",
        ),
        "tracked": Array(np.array(tracked), ("tracked",), "", "blocks whose rotation is reported"),
        "hinge": Array(
            seen.state,
            ("time", "joint"),
            "",
            "state of each joint: 0 closed, -1 hinge at the first end (intrados of an arch), 1 hinge at the second end (extrados), 2 open",
        ),
        "opening_p": Array(seen.gap_p, ("time", "joint"), "m", "gap at the first ends of the joints (intrados of an arch)"),
        "opening_q": Array(seen.gap_q, ("time", "joint"), "m", "gap at the second ends of the joints (extrados of an arch)"),
        "slip": Array(seen.slip, ("time", "joint"), "m", "slip at the closed ends"),
        **{f"{name}_energy": Array(values, ("time",), "J") for name, values in found.energy.items() if name != "leapfrog"},
        **tie_arrays(model.ties, found.tension),
        **force_arrays(model, found),
        **segment_arrays(model.ties, 2),
        "ground": Array(ground, ("time",), "m/s^2"),
        "snapshot_time": Array(measures.snapshot_times(options, found), ("snapshot",), "s"),
        **measures.support_arrays(model),
        **measures.water_arrays(model),
    }


def _further(context: Context, options: Dem, trial: Trial, result: Result, numbers: dict[str, Any]) -> None:
    """Variations and the search for the friction, into `numbers`; what stops them leaves the run itself as it is."""
    try:
        numbers |= vary(context, options, trial, result)
        if options.find_friction:
            numbers["friction_threshold"] = friction_threshold(context, trial, options.slip)
    except Unfinished as error:
        result.status = "interrupted" if error.interrupted else "failed"
        result.reason = f"the main run is complete, but the additional runs (variations, or search for the least friction) stopped: {error}"
    except Refused as error:
        numbers["friction_threshold"] = None
        result.warnings.append(f"the least coefficient of friction was not found: {error}")
