"""dem of blocks in space under a motion: from rest under the own weight to the end, to rest or to collapse."""

from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import measures, solid_measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.files import MOST_FRAMES
from extrados.analyses.dem.job import SolidRuns, SolidTask, watched
from extrados.analyses.dem.perturbed import probe_chaos
from extrados.analyses.dem.solid_forces import force_arrays, force_keys, reactions
from extrados.analyses.dem.solid_measures import SolidsSeen
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.solid_settlement import farthest_settlement
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.ties import tie_arrays, tie_columns, tie_rows
from extrados.analyses.dem.words import solid_answer
from extrados.analyses.limit.solids import scene_arrays
from extrados.core import dem3
from extrados.motions.motion import Motion
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData
from extrados.results.solid_files import glb, series
from extrados.schema.constants import GRAVITY


def collapse_of(options: Dem, model: SolidModel) -> measures.Collapse:
    """When a block has collapsed."""
    return measures.Collapse.of(options.collapse_displacement or 0.2 * model.size, model.size)


def core_options(context: Context, options: Dem, model: SolidModel) -> dem3.Options:
    """Options of the core for a run of this deck."""
    quiet = context.motion.end if context.deck.motion else 0.0
    return dem3.Options(
        end_time=options.end_time or quiet + dem_model.settle_time(model),
        output_step=options.output_step,
        step=options.time_step or 0.0,
        fraction=options.fraction,
        settle_damping=model.values.settle_damping,
        domain=options.domain * model.size,
        settlement=farthest_settlement(model, options.rigid),
        stop_at_rest=options.end_time is None,
        rigid=options.rigid,
        rebound=options.rebound,
        quasi_static=options.quasi_static,
        way=options.way,
        **(collapse_of(options, model).options if options.stop_at_collapse else {}),
    )


def run(context: Context, options: Dem, model: SolidModel) -> Result:
    """The run of a deck on blocks in space."""
    moved = context.motion.ground if context.deck.motion else None
    across = context.motion.across if context.deck.motion else None

    def job_of(factor: float) -> SolidRuns:
        return SolidRuns(model.bodies(), [SolidTask(core_options(context, options, model), moved, across, factor)])

    collapse, job = collapse_of(options, model), job_of(1.0)
    found = dem_model.checked(watched(context, "dem-solids", job, "discrete elements"), model)
    ground = context.motion.sample(found.time) if moved is not None else np.zeros(len(found.time))
    seen = solid_measures.look(model, found, options.floor is not None)
    result = Result("dem", status="interrupted" if found.interrupted else "ok")
    again = "; --resume continues from here" if context.checkpoint is not None and len(found.time) else ""
    result.reason = f"interrupted at {found.stop_time:.3f} s{again}" if found.interrupted else ""

    def outcome_of(one: dem3.Run) -> str:
        return solid_measures.look(model, one, options.floor is not None).fate(collapse).outcome

    chaos = probe_chaos(context, job_of if options.perturbed else None, moved is None, found, model.count, collapse, outcome_of, result)
    numbers = _numbers(options, seen) | chaos
    result.results = r = out.SolidDemRun(**numbers, horizontal_components=1 if across is None else 2)
    _store(options, seen, ground, result)
    if across is not None:
        result.arrays["ground_across"] = Array(
            Motion("", across).sample(found.time), ("time",), "m/s^2", "acceleration of the ground at 90 degrees to the direction"
        )
    if seen.slides:
        result.warnings.append(f"contacts slide by up to {1e3 * seen.sliding.peak:.3g} mm")
    if found.residual > 0.01:
        result.warnings.append(f"the error of the energy balance is {100 * found.residual:.2g} % of the total energy exchanged")
    result.warnings += dem_model.unconverged(found.effort) + chaos["violated"]
    if r.still_moving:
        result.warnings.append("the structure still moves at the end of the run: a longer end_time may give another outcome")
    if moved is None:
        result.warnings.append("nothing moves it: add [motion]")
    result.answer = solid_answer(r, moved is None)
    return result


def _numbers(options: Dem, seen: SolidsSeen) -> dict[str, Any]:
    model, found, names = seen.model, seen.run, seen.model.assembly.block_names
    collapse = collapse_of(options, model)
    fate = seen.fate(collapse)
    mobile = slice(0, model.count)
    kinetic = found.energy["kinetic"]
    noise = 1e-6 * float(model.assembly.mass.sum()) * GRAVITY * model.size
    moving = bool(len(kinetic) and kinetic[-1] > max(1e-3 * kinetic.max(), noise))
    angle = seen.angle.max(axis=0, initial=0.0)
    apart = solid_measures.displacements(model, found)
    return {
        "outcome": fate.outcome,
        "collapse_criterion": fate.criterion,
        "collapse_time_s": fate.time,
        "governing_block": names[fate.block],
        "direction_deg": options.direction or 0.0,
        "stopped": found.reason,
        "stopped_by": [model.body_names[k] for k in found.blamed],
        "stop_time_s": found.stop_time,
        "still_moving": found.reason == "end" and moving,
        "blocks": model.count,
        "contacts": len(model.assembly.a),
        "dowels": len(found.dowel_slip),
        "dowel_slip_m": float(found.dowel_slip.max(initial=0.0)),
        "dowels_out": int(found.dowel_out.sum()),
        "peak_rotation_rad": {names[i]: float(angle[i]) for i in solid_measures.followed(seen, options.track)},
        "collapse_displacement_m": collapse.displacement,
        "peak_displacement_m": measures.peak_displacement(found, float(seen.away.max(initial=0.0)), collapse.displacement),
        "final_displacement_m": float(apart[-1].max(initial=0.0)) if len(found.time) else 0.0,
        "peak_opening_m": float(np.where(seen.state == out.APART, 0.0, seen.opening).max(initial=0.0)),
        "peak_slip_m": seen.sliding.peak,
        "residual_slip_m": seen.sliding.residual,
        "slip_ratio": seen.sliding.ratio,
        "slip_limit_ratio": out.SLIP_LIMIT,
        "slipped_joint": model.assembly.joint_names[seen.sliding.joint] if seen.slides else None,
        "off_footing": [names[i] for i in seen.off_footing],
        "peak_kinetic_energy_J": float(kinetic.max(initial=0.0)),
        "friction_loss_J": float(found.energy["friction"][-1]) if len(found.time) else 0.0,
        "damping_loss_J": float(found.energy["damping"][-1]) if len(found.time) else 0.0,
        **force_keys(model, found),
        "energy_residual_ratio": found.residual,
        "bounces": int(found.bounces[mobile].sum()),
        "airborne_time_s": float(found.airborne[mobile].max(initial=0.0)),
        **tie_rows(model.ties, found),
        "solver": options.solver,
        "convergence": measures.convergence(found.effort) if options.rigid else None,
        **measures.springs(options, model.values, found),
        "steps": found.steps,
        "settling_steps": found.settling_steps,
        "time_step_s": found.step,
        "contact_searches": found.searches,
        "animation": options.animation,
    }


def run_arrays(model: SolidModel, run: dem3.Run, shown: np.ndarray) -> dict[str, Array]:
    """The stones and their motion, for pictures and for other programs; `shown`: times of the drawings [s]."""
    return scene_arrays(model.assembly) | {
        "time": Array(run.time, ("time",), "s", "output times"),
        "pose": Array(
            solid_measures.poses(model, run),
            ("time", "block", "pose"),
            "m, m, m, rad, rad, rad",
            "shifts of the centroids and rotation vectors, from where the stones were drawn",
        ),
        "rate": Array(
            run.rate[:, : model.count],
            ("time", "block", "motion"),
            "m/s, m/s, m/s, rad/s, rad/s, rad/s",
            "velocities of the centroids and spins",
        ),
        "snapshot_time": Array(shown, ("snapshot",), "s"),
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
    forces |= {f"reaction {axis}": values for axis, values in zip("xyz", reactions(model, found).T, strict=True)}
    result.tables["dem"] = TableData(columns | energies | forces, units | dict.fromkeys(energies, "J") | dict.fromkeys(forces, "N"))
    result.arrays = {
        **run_arrays(model, found, measures.snapshot_times(options, found)),
        "shift": Array(shift, ("time", "block", "axis3"), "m", "of the centroids, from the settled state"),
        "turn": Array(seen.turn, ("time", "block", "axis3"), "rad", "rotation vectors from the settled state"),
        "tracked": Array(np.array(tracked), ("tracked",), "", "blocks whose rotation is reported"),
        "state": Array(seen.state.astype(np.int8), ("time", "contact"), "", "0 closed, 1 open at some corners, 2 apart"),
        "opening": Array(seen.opening, ("time", "contact"), "m", "gap at the corner of each contact that gapes most"),
        "slip": Array(seen.slip, ("time", "contact"), "m", "slip at its most closed corner"),
        **{name: Array(values, ("time",), "J") for name, values in energies.items()},
        **tie_arrays(model.ties, found.tension),
        **force_arrays(model, found),
        "ground": Array(ground, ("time",), "m/s^2", "acceleration of the ground along the direction"),
    }
    if len(found.time):
        every = np.arange(0, len(found.time), max(1, int(np.ceil(len(found.time) / MOST_FRAMES))))
        one, poses, times = model.assembly, solid_measures.poses(model, found)[every], found.time[every]
        result.files["dem.glb"] = glb(one.parts, one.owner, one.centroid, one.block_names, times, poses)
        if options.vtk:
            result.files |= series("dem", one.parts, one.owner, one.centroid, times, poses)
