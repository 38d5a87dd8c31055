"""harmonic-map: a block or an arch under harmonic motion over frequency and amplitude (after Spanos and Koh 1984)."""

import numpy as np

from extrados.analyses.batches import sweep
from extrados.analyses.context import Context
from extrados.analyses.rocking.common import rocker_of
from extrados.analyses.rocking.conditions import Counted, astray_of, of_many, told
from extrados.analyses.rocking.doubts import too_fast
from extrados.analyses.rocking.hand_over import decide_cells
from extrados.analyses.rocking.job import runs_job
from extrados.analyses.statistics.tables import HarmonicMap
from extrados.motions import pulses
from extrados.results import statistics as out
from extrados.results.fields import given
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE, SLID
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker


def run(context: Context, options: HarmonicMap) -> Result:
    """At rest, rocking with its greatest rotation, or overturned, for each frequency and amplitude."""
    model = rocker_of(context, options)
    limit = model.model.fastest_beat if isinstance(model.model, ArchModel) else None
    if limit is not None:
        context.warnings.append(f"harmonic motion repeats itself: {too_fast(limit)}")
    p = 1.0 / model.time_unit
    frequency = np.array(options.frequencies) if options.frequencies else np.linspace(1.0, 12.0, 40) * p / (2.0 * np.pi)
    cap = options.max_amplitude or 6.0 * model.unit_acceleration * GRAVITY
    amplitude = np.linspace(0.0, cap, options.amplitudes + 1)[1:]
    grounds = [pulses.harmonic(1.0, f, options.cycles / f).ground for f in frequency]
    motion = np.repeat(np.arange(len(frequency)), len(amplitude))
    job = runs_job(
        [model.body],
        grounds,
        0,
        motion,
        np.tile(amplitude, len(frequency)),
        np.array([g.end for g in grounds])[motion],
        model.start_rotation,
        astray=astray_of(model),
    )
    swept = sweep(context, "harmonic-map", job, len(motion), "harmonic map")
    result = Result("harmonic-map", swept.status, swept.stopped)
    if not swept.complete:
        return result
    shape = (len(frequency), len(amplitude))
    outcome = swept["outcome"].copy()
    fails = (swept["slips"] > 0) | (swept["strays"] > 0)
    conditions = of_many(model, Counted.of([swept.arrays]), "motions of the map")["conditions"]
    handed = 0
    if options.hand_over_cells and fails.any():
        at = np.flatnonzero(fails)
        linear = options.form == "linear"
        runs = (grounds, motion[at], job.scale[at], job.end[at])
        found = decide_cells(context, model, options.hand_over_cells, linear, *runs)
        known = found["outcome"] >= 0
        outcome[at[known]], handed = found["outcome"][known], int(known.sum())
        swept["peak_ratio"][at[known]] = found["ratio"][known]
        if handed == len(at):
            conditions = conditions.model_copy(update={"violated": []})
        if handed:
            result.warnings.append(
                f"{handed} of {outcome.size} motions of the map were continued with rigid contacts: joints slide "
                f"in {conditions.sliding}, and hinges form outside the mechanism in {conditions.hinges_elsewhere}."
            )
    outcome = outcome.reshape(shape)
    over = outcome == COLLAPSE
    ratio = np.where(over, np.nan, swept["peak_ratio"].reshape(shape))
    lowest = np.where(over.any(axis=1), amplitude[over.argmax(axis=1)], np.nan) / GRAVITY
    pockets = int(((~over) & (amplitude / GRAVITY > lowest[:, None])).sum())
    result.results = out.HarmonicMap(
        cycles=options.cycles,
        uplift_acceleration_g=model.uplift,
        frequencies_Hz=frequency.tolist(),
        frequency_ratios=(2.0 * np.pi * frequency / p).tolist(),
        lowest_overturning_amplitude_g=lowest.tolist(),
        safe_pocket_cells=pockets,
        restitution=model.restitution,
        conditions=conditions,
        **given(handed_over=handed or None),
    )
    result.warnings += told(result.results.conditions)
    store_map(result, frequency, amplitude, outcome, ratio, lowest, swept["half_cycles"])
    result.answer = answer_of(options, model, result.results, cap)
    return result


def store_map(
    result: Result,
    frequency: np.ndarray,
    amplitude: np.ndarray,
    outcome: np.ndarray,
    ratio: np.ndarray,
    lowest: np.ndarray,
    half_cycles: np.ndarray,
) -> None:
    """Table and arrays of the map: outcome and greatest rotation over the critical one (frequencies, amplitudes), the lowest overturning
    amplitude (frequencies) [g], half cycles (cells) in order of the frequencies."""
    result.tables["harmonic_map"] = TableData(
        {
            "frequency": np.repeat(frequency, len(amplitude)),
            "amplitude": np.tile(amplitude, len(frequency)) / GRAVITY,
            "outcome": outcome.ravel(),
            "peak_ratio": ratio.ravel(),
            "half_cycles": half_cycles,
        },
        {"frequency": "Hz", "amplitude": "g"},
    )
    result.arrays = {
        "frequency": Array(frequency, ("frequency",), "Hz"),
        "amplitude": Array(amplitude / GRAVITY, ("amplitude",), "g"),
        "outcome": Array(outcome, ("frequency", "amplitude"), "", f"outcome: 0 at rest, 1 recovery, 2 collapse, {SLID} sliding alone"),
        "peak_ratio": Array(ratio, ("frequency", "amplitude"), "", "greatest rotation divided by the critical rotation"),
        "lowest": Array(lowest, ("frequency",), "g", "lowest overturning amplitude"),
    }


def answer_of(options: HarmonicMap, model: Rocker, found: out.HarmonicMap, cap: float) -> str:
    """The lowest amplitude of collapse in words; cap: greatest amplitude of the map [m/s^2]."""
    lowest = np.array(found.lowest_overturning_amplitude_g, dtype=float)
    if not np.isfinite(lowest).any():
        return (
            f"No harmonic motion of the map, up to {cap / GRAVITY:.3g} g, causes collapse of the {model.word} in {options.cycles} cycles."
        )
    k = int(np.nanargmin(lowest))
    return (
        f"Under {options.cycles} cycles, rocking of the {model.word} starts at {model.uplift:.3f} g. The lowest amplitude that causes "
        f"collapse is {lowest[k]:.3f} g, at {found.frequencies_Hz[k]:.3f} Hz (omega/p = {found.frequency_ratios[k]:.2f}). "
        f"{found.safe_pocket_cells} cells of the map are safe, although a lower amplitude causes collapse."
    )
