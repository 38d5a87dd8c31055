"""Fragility of a pushed building: N2 with the response spectrum of every motion of a set."""

from collections.abc import Sequence

import numpy as np

from extrados.analyses.codes import capacity_curve as cc
from extrados.analyses.codes.actions import spectrum_of_motion
from extrados.analyses.codes.tables import Verification
from extrados.analyses.context import Context, Refused
from extrados.analyses.motion_source import how_many, source_of
from extrados.core import motion as core
from extrados.motions.motion import Motion
from extrados.results import verification as out
from extrados.schema.constants import GRAVITY


def fragilities(
    context: Context, options: Verification, curves: Sequence[tuple[cc.CapacityCurve, cc.Oscillator]], states: Sequence[str]
) -> tuple[list[out.BuildingFragility], np.ndarray]:
    """Lognormal fragility at each limit state, and the peak ground accelerations (motions, states) [g] that are carried: of each
    motion its peak times the least factor of all curves at which N2 reaches the displacement capacity."""
    rows = []
    for samples, step in _motions(context, options):
        values = core.response_spectra(samples, step, cc.PERIODS, [cc.DAMPING]).psa.reshape(-1)
        corner, peak = cc.corner_of(values), float(np.abs(samples).max())
        spectrum = spectrum_of_motion(samples, step, peak)
        rows.append(
            [
                peak / GRAVITY * min(cc.n2_factor(o, spectrum, corner, cc.capacity_of(c, o, state) / o.participation) for c, o in curves)
                for state in states
            ]
        )
    carried = np.array(rows)
    log = np.log(carried)
    fitted = [
        out.BuildingFragility(
            limit_state=state, motions=len(carried), median_pga_g=float(np.exp(log[:, k].mean())), dispersion=float(log[:, k].std(ddof=1))
        )
        for k, state in enumerate(states)
    ]
    return fitted, carried


def _motions(context: Context, options: Verification) -> list[tuple[np.ndarray, float]]:
    """Accelerations [m/s^2] and step [s] of each motion; Refused where fewer than two can be had."""
    assert options.motions is not None
    there = how_many(context)
    count = options.motions if there is None else min(options.motions, there)
    source, _ = source_of(context, None)
    found, broken = [], 0
    for ground in source.grounds(0, count, context.threads):
        if isinstance(ground, str):
            broken += 1
            continue
        time, values = Motion("", ground).series()
        found.append((values, float(time[1] - time[0])))
    if broken:
        context.warnings.append(f"{broken} of {count} motions cannot be read and are not included in the fragility.")
    if len(found) < 2:
        raise Refused(f"a fragility requires at least two motions, and the deck has {len(found)}", ("analysis", "verification", "motions"))
    return found
