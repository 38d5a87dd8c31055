"""dem of blocks in space under a motion: from rest under the own weight to the end, to rest or to collapse."""

from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import measures, solid_measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.files import MOST_FRAMES
from extrados.analyses.dem.forces import force_arrays, force_columns
from extrados.analyses.dem.job import SolidRuns, SolidTask, watched
from extrados.analyses.dem.measures import Collapse
from extrados.analyses.dem.perturbed import probe_chaos
from extrados.analyses.dem.seen import begun_result, doubts_of_run, moved_supports, numbers_of
from extrados.analyses.dem.solid_measures import SolidsSeen
from extrados.analyses.dem.solid_model import SolidModel, moves_of
from extrados.analyses.dem.solid_settlement import farthest_settlement
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.thrust import put_thrust
from extrados.analyses.dem.ties import segment_arrays, tie_arrays, tie_columns
from extrados.analyses.dem.words import solid_answer
from extrados.analyses.limit.solids import scene_arrays
from extrados.core import dem3
from extrados.motions.motion import Motion
from extrados.results.dem import APART, SolidDemRun
from extrados.results.model import Array, Result, TableData
from extrados.results.solid_files import glb, series
from extrados.schema.quantities import three_figures


def core_options(context: Context, options: Dem, model: SolidModel) -> dem3.Options:
    """Options of the core for a run of this deck."""
    moved = [one.start + one.duration for one in context.building.initial.movements]
    quiet = max([context.motion.end if context.deck.motion else 0.0, *moved])
    far = measures.farthest_move(moves_of(context.building, model), 3)
    return dem3.Options(
        end_time=options.end_time or quiet + dem_model.settle_time(model),
        output_step=options.output_step,
        step=options.time_step or 0.0,
        fraction=options.step_fraction(space=True),
        settle_damping=model.values.settle_damping,
        domain=options.domain * model.size + far,
        settlement=farthest_settlement(model, options.rigid),
        stop_at_rest=options.end_time is None,
        rigid=options.rigid,
        rebound=options.rebound,
        quasi_static=options.quasi_static,
        way=options.way,
        **(Collapse.of(options.collapse_displacement, model.size).beyond(far).options if options.stop_at_collapse else {}),
    )


def run(context: Context, options: Dem, model: SolidModel) -> Result:
    """The run of a deck on blocks in space."""
    moved = context.motion.ground if context.deck.motion else None
    across = context.motion.across if context.deck.motion else None
    moves = moves_of(context.building, model)
    idle = moved is None and not moves

    def job_of(factor: float) -> SolidRuns:
        larger = tuple(move.times(factor) for move in moves)
        bodies = replace(model.bodies(), drawn=model.drawn() if options.thrust else None)
        return SolidRuns(bodies, [SolidTask(core_options(context, options, model), moved, across, factor, larger)])

    collapse, job = Collapse.of(options.collapse_displacement, model.size), job_of(1.0)
    found = dem_model.checked(watched(context, "dem-solids", job, "discrete elements"), model)
    ground = context.motion.sample(found.time) if moved is not None else np.zeros(len(found.time))
    seen = solid_measures.look(model, found, options.floor is not None)
    result = begun_result(context, found)

    def look(one: dem3.Run) -> solid_measures.SolidsSeen:
        return solid_measures.look(model, one, options.floor is not None)

    chaos = probe_chaos(context, job_of if options.perturbed else None, idle, found, model.count, collapse, look, result)
    numbers = _numbers(options, seen, collapse) | chaos | put_thrust(options, seen, result)
    result.results = r = SolidDemRun(**numbers, horizontal_components=1 if across is None else 2)
    _store(options, seen, ground, result)
    if across is not None:
        result.arrays["ground_across"] = Array(
            Motion("", across).sample(found.time),
            ("time",),
            "m/s^2",
            "acceleration of the ground perpendicular to the direction of the motion",
        )
    if seen.slides:
        result.warnings.append(f"contacts slide by up to {three_figures(1e3 * seen.sliding.peak)} mm")
    result.warnings += doubts_of_run(model, found, chaos["violated"], r.still_moving)
    if idle:
        result.warnings.append("no motion acts on the structure: add [motion] or [[initial.movements]]")
    result.answer = solid_answer(r, idle) + moved_supports(seen, moves, 3, moved is not None)
    return result


def _numbers(options: Dem, seen: SolidsSeen, collapse: Collapse) -> dict[str, Any]:
    """The results of the run itself."""
    model, found, names = seen.model, seen.run, seen.model.assembly.block_names
    angle = seen.angle.max(axis=0, initial=0.0)
    apart = solid_measures.displacements(model, found)
    return numbers_of(options, seen, collapse) | {
        "direction_deg": options.direction or 0.0,
        "blocks": model.count,
        "contacts": len(model.assembly.a),
        "dowels": len(found.dowel_slip),
        "dowel_slip_m": float(found.dowel_slip.max(initial=0.0)),
        "dowels_out": int(found.dowel_out.sum()),
        **measures.water_force(model),
        "peak_rotation_rad": {names[i]: float(angle[i]) for i in solid_measures.followed(seen, options.track)},
        "final_displacement_m": float(apart[-1].max(initial=0.0)) if len(found.time) else 0.0,
        "peak_opening_m": float(np.where(seen.state == APART, 0.0, seen.opening).max(initial=0.0)),
    }


def run_arrays(model: SolidModel, run: dem3.Run, shown: np.ndarray) -> dict[str, Array]:
    """The stones and their motion, for pictures and for other programs; `shown`: times of the drawings [s]."""
    return {
        **scene_arrays(model.assembly),
        **segment_arrays(model.ties, 3),
        **measures.water_arrays(model),
        "time": Array(run.time, ("time",), "s", "output times"),
        "pose": Array(
            solid_measures.poses(model, run),
            ("time", "block", "pose"),
            "m, m, m, rad, rad, rad",
            "displacements of the centroids and rotation vectors, from the initial position of the blocks",
        ),
        "rate": Array(
            run.rate[:, : model.count],
            ("time", "block", "motion"),
            "m/s, m/s, m/s, rad/s, rad/s, rad/s",
            "velocities of the centroids, and angular velocities",
        ),
        "snapshot_time": Array(shown, ("snapshot",), "s"),
    }


def contact_arrays(opening: np.ndarray, slip: np.ndarray, state: np.ndarray) -> dict[str, Array]:
    """What the contacts do over time; see SolidsSeen."""
    return {
        "state": Array(
            state.astype(np.int8), ("time", "contact"), "", "state of each contact: 0 closed, 1 open at some corners, 2 fully open"
        ),
        "opening": Array(opening, ("time", "contact"), "m", "greatest gap of each contact, over its corners"),
        "slip": Array(slip, ("time", "contact"), "m", "slip of each contact, at its corner with the smallest gap"),
    }


def _store(options: Dem, seen: SolidsSeen, ground: np.ndarray, result: Result) -> None:
    """Arrays, tables and files of the run into `result`; ground: its acceleration along the direction (time) [m/s^2]."""
    model, found, names = seen.model, seen.run, seen.model.assembly.block_names
    tracked = solid_measures.followed(seen, options.track)
    energies = {f"{name}_energy": values for name, values in found.energy.items() if name not in ("leapfrog", "mass_damping")}
    shift = found.place[:, : model.count] - found.settled[: model.count]
    columns = {"time": found.time}
    for i in tracked:
        columns |= {f"{axis} of {names[i]}": shift[:, i, k] for k, axis in enumerate("xyz")}
        columns[f"rotation of {names[i]}"] = seen.angle[:, i]
    units = {key: "rad" if key.startswith("rotation") else "m" for key in columns} | {"time": "s"}
    forces = tie_columns(model.ties, found.tension)
    forces |= force_columns(model, found)
    result.tables["dem"] = TableData(columns | energies | forces, units | dict.fromkeys(energies, "J") | dict.fromkeys(forces, "N"))
    result.arrays |= {
        **run_arrays(model, found, measures.snapshot_times(options, found)),
        "shift": Array(
            shift, ("time", "block", "axis3"), "m", "displacements of the centroids, from the position at rest under self-weight"
        ),
        "turn": Array(seen.turn, ("time", "block", "axis3"), "rad", "rotation vectors, from the position at rest under self-weight"),
        "tracked": Array(np.array(tracked), ("tracked",), "", "blocks whose rotation is reported"),
        **contact_arrays(seen.opening, seen.slip, seen.state),
        **{name: Array(values, ("time",), "J") for name, values in energies.items()},
        **tie_arrays(model.ties, found.tension),
        **force_arrays(model, found),
        "ground": Array(ground, ("time",), "m/s^2", "acceleration of the ground along the direction of the motion"),
    }
    if len(found.time):
        every = np.arange(0, len(found.time), max(1, int(np.ceil(len(found.time) / MOST_FRAMES))))
        one, poses, times = model.assembly, solid_measures.poses(model, found)[every], found.time[every]
        result.files["dem.glb"] = glb(one.parts, one.owner, one.centroid, one.block_names, times, poses)
        if options.vtk:
            result.files |= series("dem", one.parts, one.owner, one.centroid, times, poses)
