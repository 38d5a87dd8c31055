"""shake-table: capacity curves (thesis Fig. C-1), drive displacement, scales that make a motion fit."""

from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.motion.tables import ShakeTable
from extrados.core import motion as core
from extrados.motions import export
from extrados.motions.shake_table import Table, fit, make_drive
from extrados.results import motion as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY


def run(context: Context, options: ShakeTable) -> Result:
    """Capacity of the table; with a [motion], whether and how it can be played."""
    velocity = options.max_velocity if options.max_velocity is not None else options.flow / options.piston_area
    table = Table(options.stroke, velocity, options.max_force)
    frequency = np.geomspace(options.lowest, options.highest, 400)
    curves = [table.amplitudes(frequency, mass) for mass in options.masses]
    corners = [table.corner_frequencies(mass) for mass in options.masses]
    capacity = np.array([np.min(list(c.values()), axis=0) for c in curves])
    result = Result("shake-table")
    r = {
        "max_velocity_m_s": velocity,
        "masses_kg": list(options.masses),
        "stroke_to_flow_Hz": corners[0]["stroke_to_flow"],
        "flow_to_force_Hz": [c["flow_to_force"] for c in corners],
    }
    result.arrays = {
        "frequency": Array(frequency, ("frequency",), "Hz"),
        "mass": Array(np.array(options.masses), ("mass",), "kg"),
        "stroke_limit": Array(curves[0]["stroke"], ("frequency",), "m", "displacement amplitude by the stroke"),
        "flow_limit": Array(curves[0]["flow"], ("frequency",), "m", "displacement amplitude by the flow"),
        "force_limit": Array(np.array([c["force"] for c in curves]), ("mass", "frequency"), "m", "displacement amplitude by the force"),
        "capacity": Array(capacity, ("mass", "frequency"), "m", "least of the three"),
    }
    result.tables["capacity"] = TableData(
        {
            "frequency": frequency,
            "stroke": curves[0]["stroke"],
            "flow": curves[0]["flow"],
            **{f"force_{mass:.4g}kg": c["force"] for mass, c in zip(options.masses, curves, strict=True)},
        },
        {"frequency": "Hz", **{n: "m" for n in ("stroke", "flow", *(f"force_{mass:.4g}kg" for mass in options.masses))}},
    )
    result.answer = (
        (
            f"Below {corners[0]['stroke_to_flow']:.3g} Hz, the stroke limits the table to {100 * table.stroke:.3g} cm. Above this "
            f"frequency, the velocity limits the table to {100 * velocity:.3g} cm/s; "
        )
        + "; ".join(
            f"with {mass:.4g} kg, the force limits the table above {c['flow_to_force']:.3g} Hz"
            for mass, c in zip(options.masses, corners, strict=True)
        )
        + "."
    )
    if context.deck.motion is not None:
        r |= _play(context, options, table, result)
    result.results = out.ShakeTable(**r)
    return result


def _play(context: Context, options: ShakeTable, table: Table, result: Result) -> dict[str, Any]:
    """Whether the motion fits and what makes it fit: arrays, tables and words into `result`; the further results."""
    motion = context.motion
    time, acceleration = motion.series()
    step = float(time[1] - time[0])
    try:
        drive = make_drive(acceleration, step, options.low_cut)
    except ValueError as error:
        raise Refused(str(error), ("analysis", "low_cut")) from None
    fits = [fit(table, drive, mass, options.keep) for mass in options.masses]
    # one drive for all masses: the scales of the heaviest suit the lighter ones
    heaviest = int(np.argmax(options.masses))
    chosen = fits[heaviest]
    played = drive.squeezed(chosen.time_scale, chosen.amplitude)
    inside = (drive.time >= 0.0) & (drive.time <= time[-1] + 0.5 * step)
    wanted = core.measures(acceleration, step)
    missing = drive.acceleration[inside][: len(acceleration)] - acceleration
    r = {
        "fits": all(f.fits for f in fits),
        "low_cut_Hz": options.low_cut,
        "peak_displacement_m": float(np.abs(drive.displacement).max()),
        "peak_velocity_m_s": float(np.abs(drive.velocity).max()),
        "peak_acceleration_g": float(np.abs(drive.acceleration).max()) / GRAVITY,
        "motion_peak_acceleration_g": float(wanted.pga[0]) / GRAVITY,
        "rms_taken_out_ratio": float(np.sqrt(np.mean(missing**2) / max(np.mean(acceleration**2), 1e-300))),
        "use_of_limits": [
            out.UseOfLimits(mass_kg=m, stroke=f.stroke, flow=f.flow, force=f.force, governing=f.governing)
            for m, f in zip(options.masses, fits, strict=True)
        ],
        "time_scale": chosen.time_scale,
        "amplitude_factor": chosen.amplitude,
        "played_displacement_m": float(np.abs(played.displacement).max()),
        "played_velocity_m_s": float(np.abs(played.velocity).max()),
        "played_acceleration_g": float(np.abs(played.acceleration).max()) / GRAVITY,
        "rest_error_m": float(max(abs(played.displacement[0]), abs(played.displacement[-1]))),
    }
    result.arrays |= {
        "drive_time": Array(played.time, ("drive_time",), "s", "displacement of the scaled motion, starting from zero"),
        "drive_displacement": Array(played.displacement, ("drive_time",), "m"),
        "drive_velocity": Array(played.velocity, ("drive_time",), "m/s"),
        "drive_acceleration": Array(played.acceleration, ("drive_time",), "m/s^2"),
        "motion_time": Array(time * chosen.time_scale, ("motion_time",), "s"),
        "motion_acceleration": Array(acceleration * chosen.amplitude, ("motion_time",), "m/s^2", "requested motion, scaled alike"),
    }
    result.tables["drive"] = TableData(
        {
            "time": played.time - played.time[0],
            "displacement": played.displacement,
            "velocity": played.velocity,
            "acceleration": played.acceleration,
        },
        {"time": "s", "displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"},
    )
    result.files["table_motion.AT2"] = export.at2(
        f"{motion.name}, scaled to the limits of the shake table", played.acceleration, played.step
    )
    if r["fits"]:
        result.answer += (
            f" {motion.name} is within the limits: the motion requires {100 * r['peak_displacement_m']:.3g} cm and "
            f"{100 * r['peak_velocity_m_s']:.3g} cm/s."
        )
        return r
    worst = max(fits, key=lambda f: max(f.stroke, f.flow, f.force))
    result.answer += (
        f" {motion.name} exceeds the limits: the motion requires {100 * r['peak_displacement_m']:.3g} cm and "
        f"{100 * r['peak_velocity_m_s']:.3g} cm/s. The limit of {worst.governing} is exceeded most, "
        f"{max(worst.stroke, worst.flow, worst.force):.2f} times. To fit the motion, scale time by {chosen.time_scale:.3f} and acceleration by {chosen.amplitude:.3f}."
    )
    return r
