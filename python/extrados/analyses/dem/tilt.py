"""dem as a tilt test: the constant acceleration that brings a structure down."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.job import Runs, Task, answered
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.settlement import farthest_settlement
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.ties import segment_arrays, tie_rows
from extrados.analyses.dem.trial import core_options
from extrados.analyses.dem.words import tilt_answer
from extrados.analyses.limit.common import geometry_arrays
from extrados.core import dem
from extrados.core.ground import Ground
from extrados.results import dem as out
from extrados.results.dem import HINGED_FIRST, HINGED_SECOND
from extrados.results.limit import NamedHinge
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY

#: Time in which the acceleration is brought in [s]; after it the structure is given time to come down.
RAMP = 2.0
SENSES = (1.0, -1.0)  # pushed to +x, pushed to -x
#: Of the size: displacement at which a structure begins to go; and of that: slip of joints that slide in its mechanism
GOES, TAKES_PART = 0.005, 0.1
#: Keys of the deck that a tilt test does not look at.
NOT_IN_TILT = (
    "end_time",
    "output_step",
    "stop_at_collapse",
    "snapshot_times",
    "animation",
    "animation_speed",
    "vtk",
    "vary_damping",
    "vary_stiffness",
    "vary_friction",
    "find_friction",
    "slip",
    "perturbed",
    "thrust",
)


def run(context: Context, options: Dem, model: Model) -> Result:
    """The constant acceleration that brings the structure down: brought in slowly, held, bisected, in both senses."""
    if without := unused(context, options):
        context.warnings.append(f"these tables or keys have no effect in a tilt test: {', '.join(without)}")
    settlement = farthest_settlement(model, rigid=options.rigid)
    base = replace(core_options(context, options, model), **held(options, model), settlement=settlement)
    bodies = [model.bodies()]
    found = capacities(
        context,
        options,
        lambda asked: Runs(bodies, [Task(0, base, pushed(a, base.end_time)) for a in asked]),
        lambda run: dem_model.checked(run, model),
    )
    last, back_run = (run for _, run in found)
    state, slip, at, found_hinges = _hinged(model, last)
    _, slip_back, at_back, back_hinges = _hinged(model, back_run)
    body = model.rigid.body_of_block
    rotation = -(last.place[:, body, 2] - last.settled[body, 2])
    peak = np.abs(rotation).argmax(axis=0)
    result = Result("dem")
    result.results = out.DemTilt(
        **numbers_of_tilt(options, model, found),
        **measures.water_force(model),
        load_direction="+x",
        hinges=found_hinges,
        hinges_opposite=back_hinges,
        peak_rotation_rad={model.assembly.block_names[i]: float(rotation[peak[i], i]) for i in measures.tracked(model, options, last)},
        peak_slip_m=float(np.nanmax(np.abs(slip[at]), initial=0.0)),
        interval=sum(pair is not None for pair in model.rigid.joints) > model.rigid.count
        and (slides(slip[at], model.size) or slides(slip_back[at_back], model.size)),
    )
    result.warnings += dem_model.unconverged(last.effort.with_(back_run.effort))
    result.arrays = {
        **geometry_arrays(model.assembly),
        "time": Array(last.time, ("time",), "s"),
        "place": Array(measures.block_places(model, last.place), ("time", "block", "component"), "m, m, rad"),
        "rate": Array(measures.block_rates(model, last), ("time", "block", "component"), "m/s, m/s, rad/s"),
        "hinge": Array(
            state,
            ("time", "joint"),
            "",
            "state of each joint: 0 closed, -1 hinge at the first end (intrados of an arch), 1 hinge at the second end (extrados), 2 open",
        ),
        "snapshot_time": Array(last.time[[at, -1]], ("snapshot",), "s"),
        **segment_arrays(model.ties, 2),
        **measures.support_arrays(model),
        **measures.water_arrays(model),
    }
    result.answer = tilt_answer(result.results)
    return result


def held(options: Dem, model: Model | SolidModel) -> dict[str, Any]:
    """Options of the core under a push that is brought in and held."""
    return {
        "end_time": RAMP + dem_model.settle_time(model),
        "stop_at_rest": False,
        "output_step": 0.05,
        "collapse": options.collapse_displacement or 0.05 * model.size,
        "collapse_turn": 0.0,
        "collapse_drop": 0.0,  # under a constant push a block that slides slides on
    }


def numbers_of_tilt(options: Dem, model: Model | SolidModel, found: list[tuple[float, Any]]) -> dict[str, Any]:
    """The results of a tilt test by their keys, but for what sections and solids have of their own; found: see `capacities`."""
    (collapse, last), (back, back_run) = found
    return {
        "test": "tilt",
        "outcome": "collapse",
        "collapse_acceleration_g": collapse,
        "collapse_acceleration_opposite_g": back,
        "tilt_angle_deg": float(np.degrees(np.arctan(collapse))),
        "tilt_angle_opposite_deg": float(np.degrees(np.arctan(back))),
        "energy_residual_ratio": max(last.residual, back_run.residual),
        "time_step_s": last.step,
        "steps": last.steps,
        **tie_rows(model.ties, last),
        "solver": options.solver,
        "beta_s": None if options.rigid else model.values.beta,
        "convergence": measures.convergence(last.effort.with_(back_run.effort)) if options.rigid else None,
    }


def slides(slip: np.ndarray, size: float) -> bool:
    """Whether joints slide in the mechanism, by their slips as it begins to go [m] (NaN: of one body)."""
    return float(np.nanmax(np.abs(slip), initial=0.0)) > TAKES_PART * GOES * size


def pushed(acceleration: float, end: float) -> Ground:
    """The ground accelerates to -x, which pushes the structure to +x [m/s^2], until `end` [s]."""
    return Ground(
        breaks=np.array([0.0, RAMP, end + 1.0]),
        linear=np.array([[[0.0, -acceleration / RAMP]], [[-acceleration, 0.0]]]),
        harmonic=np.zeros((2, 1, 0, 4)),
    )


def unused(context: Context, options: Dem) -> list[str]:
    """What of a deck a tilt test does not look at."""
    found = [key for key in NOT_IN_TILT if key in options.model_fields_set]
    if context.deck.motion:
        found.append("the [motion]")
    if context.building.initial.movements:
        found.append("[[initial.movements]]")
    if context.building.initial.rotation_ratio:
        found.append("[initial] rotation_ratio")
    return found


def capacities(context: Context, options: Dem, job: Callable[[list[float]], Any], checked: Callable[[Any], Any]) -> list[tuple[float, Any]]:
    """For each sense the acceleration [g] that brings it down and the last run that fell; both are bisected at once.

    job: runs under accelerations [m/s^2]; checked: the run, or Refused where it is none."""
    wanted = options.tilt_accuracy * GRAVITY
    total, rounds = 1.0 + float(np.log2(options.tilt_limit / wanted)), 0

    def falls(asked: list[float]) -> list[Any]:
        """The run where an acceleration [m/s^2] brings it down, else None."""
        nonlocal rounds
        runs = answered(context, "dem-tilt", job(asked), "", tell=lambda n: None)
        rounds += 1
        context.progress(min(rounds, total), total, "tilt test")
        return [run if checked(run).reason in ("collapse", "left") else None for run in runs]

    low, high = [0.0, 0.0], [options.tilt_limit, options.tilt_limit]
    last = falls([sense * options.tilt_limit for sense in SENSES])
    for sense, run in zip(SENSES, last, strict=True):
        if run is None:
            raise Refused(
                f"the structure is stable at {options.tilt_limit / GRAVITY:g} g towards {('+x' if sense > 0 else '-x')}: "
                "increase `tilt_limit`",
                ("analysis", "tilt_limit"),
            )
    while True:
        # as fine as numbers are where the middle is one of the ends
        wide = [k for k in (0, 1) if high[k] - low[k] > wanted and low[k] < 0.5 * (low[k] + high[k]) < high[k]]
        if not wide:
            return [(0.5 * (low[k] + high[k]) / GRAVITY, last[k]) for k in (0, 1)]
        middle = {k: 0.5 * (low[k] + high[k]) for k in wide}
        for k, run in zip(wide, falls([SENSES[k] * middle[k] for k in wide]), strict=True):
            if run is None:
                low[k] = middle[k]
            else:
                high[k], last[k] = middle[k], run


def _hinged(model: Model, run: dem.Run) -> tuple[np.ndarray, np.ndarray, int, list[NamedHinge]]:
    """States and slips of the joints, the output where it begins to go, and the hinges there."""
    gap_p, gap_q, slip = measures.openings(model, run)
    state = measures.hinges(model, gap_p, gap_q, slip)
    begun = np.searchsorted(measures.displacements(model, run).max(axis=1), GOES * model.size)
    at = min(int(begun), len(run.time) - 1)
    rows = [
        NamedHinge(joint=j, name=model.assembly.joint_names[j], side="intrados" if state[at, j] == HINGED_FIRST else "extrados")
        for j in np.flatnonzero(np.isin(state[at], (HINGED_FIRST, HINGED_SECOND))).tolist()
    ]
    return state, slip, at, rows
