"""frame-history: motion of a frame of macro-elements under a ground acceleration."""

from typing import Literal

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.modes import Mode, modes_of, rest_of, way_of
from extrados.analyses.frame.pushover import MODES
from extrados.analyses.frame.tables import FrameHistory, FrameMotion
from extrados.core.calls import interruptible
from extrados.core.frame import STATE, Frame, Path
from extrados.results import frame as out
from extrados.results.model import Array, Result, TableData
from extrados.views.frame.frame import EquivalentFrame

#: Time after the motion [s]
AFTER = 2.0


def rayleigh(ratio: float, frequencies: tuple[float, float]) -> tuple[float, float]:
    """Factors alpha [1/s] of the mass and beta [s] of the stiffness that have a damping ratio at two frequencies [Hz]."""
    one, two = (2.0 * np.pi * f for f in frequencies)
    return 2.0 * ratio * one * two / (one + two), 2.0 * ratio / (one + two)


def damped(frame: EquivalentFrame, core: Frame, options: FrameMotion) -> tuple[Mode, tuple[float, float]]:
    """The mode of greatest participating mass along the motion, and Rayleigh's factors."""
    way = way_of(options.direction)
    mode = max(modes_of(frame, rest_of(frame, core).tangent, MODES), key=lambda m: m.participating(way))
    given = options.damping_frequencies
    pair = (given[0], given[1]) if given else (mode.frequency, 3.0 * mode.frequency)
    return mode, rayleigh(options.damping_ratio, pair)


def control_of(frame: EquivalentFrame, path: Path, way: np.ndarray) -> np.ndarray:
    """Displacement [m] over time of the highest level along a direction, beyond that at rest."""
    level = max(one.level for one in frame.masses)
    return np.asarray((path.displacement - path.displacement[0]) @ frame.control(way, level))


def run(context: Context, options: FrameHistory) -> Result:
    """Displacements, base shear and states of the elements over time."""
    result = Result("frame-history")
    frame = context.building.frame(options.frame)
    context.warnings += frame.remarks + frame.weaknesses
    motion = context.motion
    way = way_of(options.direction)
    end = options.end_time or motion.end + AFTER
    time = np.arange(0.0, end + 0.5 * options.time_step, options.time_step)
    ground = motion.sample(time)
    with interruptible(), frame.core() as core:
        mode, damping = damped(frame, core, options)
        path = core.move(frame.unit(way), ground, options.time_step, damping)
    if path.stop == "no equilibrium under the weight":
        raise Refused("the frame has no equilibrium under its own weight", ("structure", "walls"))
    count = len(path.displacement)
    time = time[:count]
    moved = control_of(frame, path, way)
    piers = frame.piers_at
    drift = path.drift[:, piers]
    at = np.unravel_index(int(drift.argmax()), drift.shape)
    failed = []
    for k, strip in enumerate(frame.strips):
        there = np.flatnonzero(path.state[:, k] >= STATE["failed_flexure"])
        if len(there):
            word: Literal["flexure", "shear"] = "shear" if path.state[there[0], k] == STATE["failed_shear"] else "flexure"
            failed.append((time[there[0]], out.FailedElement(element=strip.name, mode=word, control_displacement_m=float(moved[there[0]]))))
    failed.sort(key=lambda row: row[0])
    first = {"first_failure_s": float(failed[0][0])} if failed else {}
    result.results = out.FrameHistory(
        stop=path.stop,
        end_time_s=float(time[-1]),
        peak_displacement_m=float(np.abs(moved).max()),
        peak_base_shear_N=float(np.abs(path.shear).max()),
        residual_displacement_m=float(moved[-1]),
        peak_drift=float(drift[at]),
        peak_drift_element=frame.strips[piers[at[1]]].name,
        failed=[row for _, row in failed],
        period_s=1.0 / mode.frequency,
        damping=list(damping),
        weight_N=frame.total_weight,
        steps=count - 1,
        **first,
    )
    result.arrays["time"] = Array(time, ("time",), "s", "time")
    result.arrays["displacement"] = Array(
        moved, ("time",), "m", "control displacement along the direction of the motion, relative to the ground"
    )
    result.arrays["base_shear"] = Array(path.shear, ("time",), "N", "base shear by internal forces, along the direction of the motion")
    result.tables["frame_history"] = TableData(
        {"time": time, "ground_acceleration": ground[:count], "displacement": moved, "base_shear": path.shear},
        {"time": "s", "ground_acceleration": "m/s^2", "displacement": "m", "base_shear": "N"},
    )
    if path.stop == "interrupted":
        result.status, result.reason = "interrupted", "interrupted; the results up to then are saved"
    r = result.results
    result.answer = (
        f"Greatest displacement {1e3 * r.peak_displacement_m:.3g} mm, greatest base shear {r.peak_base_shear_N / 1e3:.3g} kN, greatest drift "
        f"of a pier {100 * r.peak_drift:.3g} % ({r.peak_drift_element}). Elements beyond their drift limits: {len(r.failed)}."
    )
    if path.stop != "target displacement":
        result.answer += f" The calculation ends at {r.end_time_s:.3g} s: {path.stop}."
    return result
