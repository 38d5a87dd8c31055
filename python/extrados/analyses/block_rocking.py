"""rocking of a block on its toes (thesis 6.2, Eqs 6.1 to 6.4)."""

import numpy as np

from extrados.analyses.block_model import BlockModel, as_block, block_model, initial_ratio
from extrados.analyses.run import Context
from extrados.analyses.tilt import geometry_arrays
from extrados.core import rocking as core_rocking
from extrados.decks.analyses import Rocking
from extrados.motions.motion import GRAVITY
from extrados.results.model import Array, Result, TableData


def run(context: Context, options: Rocking) -> Result:
    """History, impacts, energies, and the friction that keeps the toe from sliding."""
    structure = context.deck.structure
    model = block_model(as_block(structure, context.structure), structure)
    context.warnings += model.warnings + context.motion.notes
    if structure.kind == "column":
        context.warnings.append(
            "the column is taken as one rigid body; joints that open are left to the analysis `dem`"
        )
    ratio = initial_ratio(structure)
    side = 1 if ratio >= 0.0 else -1
    p = float(model.frequency.min())
    end_time = options.end_time or context.motion.end + 30.0 / p
    response = core_rocking.history(
        model.body, context.motion.ground, end_time, options.output_step, tolerance=options.tolerance,
        start_side=side, start_rotation=abs(ratio) * float(model.alpha[0 if side > 0 else 1]),
    )  # fmt: skip
    tangential, normal = toe_forces(model, response)
    friction = np.abs(tangential) / np.maximum(normal, 1e-300)
    flying = normal <= 0.0
    needed = float(friction[~flying].max(initial=0.0))
    impacts = [(t, v) for kind, t, v in response.events if kind == "impact"]
    collapse = response.outcome == "collapse"
    energy = response.kinetic + response.potential
    scale = max(float(energy.max(initial=0.0)), abs(response.work), 1e-300)
    result = Result("rocking", status="interrupted" if response.interrupted else "ok")
    result.reason = f"interrupted at {response.stop_time:.3f} s" if response.interrupted else ""
    c_v = model.restitution
    result.results = {
        "rotation_of": "the block",
        "outcome": response.outcome,
        "collapse_half_cycle": response.half_cycles if collapse else None,
        "collapse_time_s": response.stop_time if collapse else None,
        "half_cycles": response.half_cycles,
        "impacts": response.impacts,
        "impact_times_s": [t for t, _ in impacts],
        "restitution": float(c_v[0]),
        "restitution_to_left": float(c_v[1]),
        "energy_ratio": float(c_v[0] ** 2 * model.block.toe_inertia[0] / model.block.toe_inertia[1]),
        "peak_rotation_rad": response.peak,
        "peak_rotation_ratio": response.peak_ratio,
        "critical_rotation_rad": float(model.alpha[0]),
        "critical_rotation_left_rad": float(model.alpha[1]),
        "frequency_parameter_rad_s": float(model.frequency[0]),
        "uplift_acceleration_g": float(model.uplift.min()),
        "peak_ground_acceleration_g": context.motion.peak / GRAVITY,
        "required_friction": needed,
        "energy_supplied_J": response.work,
        "energy_lost_at_impacts_J": response.loss,
        "energy_residual_ratio": float(np.abs(energy - response.ledger).max(initial=0.0)) / scale,
        "steps": response.steps,
        "rejected_steps": response.rejected,
    }
    if flying.any():
        first = response.time[flying.argmax()]
        result.warnings.append(
            f"from {first:.3f} s on the block would leave the ground for a while: rocking without flight is assumed"
        )
    result.tables["rocking"] = TableData(
        {
            "time": response.time, "rotation": response.rotation, "rotation_rate": response.rate,
            "ground_acceleration": response.ground, "vertical_acceleration": response.vertical,
            "kinetic_energy": response.kinetic, "potential_energy": response.potential,
            "energy_supplied_less_lost": response.ledger, "required_friction": friction,
        },
        {
            "time": "s", "rotation": "rad", "rotation_rate": "rad/s", "ground_acceleration": "m/s^2",
            "vertical_acceleration": "m/s^2", "kinetic_energy": "J", "potential_energy": "J",
            "energy_supplied_less_lost": "J",
        },
    )  # fmt: skip
    result.tables["rocking_events"] = TableData(
        {
            "event": [kind for kind, _, _ in response.events],
            "time": np.array([t for _, t, _ in response.events]),
            "value": np.array([v for _, _, v in response.events]),
        },
        {"time": "s", "value": "rad at peak and collapse; rad/s before impact; side at uplift"},
    )
    result.arrays = {
        **geometry_arrays(model.block),
        "time": Array(response.time, ("time",), "s", "output times"),
        "rotation": Array(response.rotation, ("time",), "rad", "rotation of the block, positive to +x"),
        "rate": Array(response.rate, ("time",), "rad/s"),
        "acceleration": Array(response.acceleration, ("time",), "rad/s^2"),
        "ground": Array(response.ground, ("time",), "m/s^2", "horizontal ground acceleration"),
        "vertical": Array(response.vertical, ("time",), "m/s^2", "vertical ground acceleration"),
        "kinetic": Array(response.kinetic, ("time",), "J"),
        "potential": Array(response.potential, ("time",), "J"),
        "ledger": Array(response.ledger, ("time",), "J", "work of the ground less the energy lost at impacts"),
        "impact_time": Array(np.array([t for t, _ in impacts]), ("impact",), "s"),
        "required_friction": Array(
            friction[:, None], ("time", "joint"), "", "coefficient of friction needed at the toe"
        ),
        **_snapshots(model, response, tangential, normal, options),
    }
    result.answer = _answer(result.results, response, model)
    return result


def toe_forces(model: BlockModel, response: core_rocking.Response) -> tuple[np.ndarray, np.ndarray]:
    """Horizontal (to +x) and vertical (up) force of the ground on the block at the output times [N]."""
    b = model.block
    side = np.where(response.rotation < 0.0, -1.0, 1.0)
    i = (side < 0.0).astype(int)
    moving = response.rotation != 0.0
    rest = b.alpha[i] - np.abs(response.rotation)
    rate, acceleration = side * response.rate, side * response.acceleration
    radius = b.radius[i] * moving
    # The centre of mass lies at (-side R sin(alpha - q), R cos(alpha - q)) from the toe.
    x = side * radius * (np.cos(rest) * acceleration + np.sin(rest) * rate**2)
    y = radius * (np.sin(rest) * acceleration - np.cos(rest) * rate**2)
    mass = b.mass[0]
    return mass * (response.ground + x), mass * (GRAVITY + response.vertical + y)


def pose(model: BlockModel, rotation: np.ndarray) -> np.ndarray:
    """x, y [m] and rotation [rad, counter-clockwise] of the centre of mass (n, 3)."""
    b = model.block
    left = rotation < 0.0
    i = left.astype(int)
    side = np.where(left, -1.0, 1.0)
    toe = side * b.toes[i]
    rest = b.alpha[i] - np.abs(rotation)
    return np.stack([toe - side * b.radius[i] * np.sin(rest), b.radius[i] * np.cos(rest), -rotation], axis=1)


def _snapshots(
    model: BlockModel, response: core_rocking.Response, tangential, normal, options: Rocking
) -> dict[str, Array]:
    """The block and the line of the ground's force at the times asked for, or at up to six telling ones."""
    if not len(response.time):
        return {}
    times = options.thrust_line_times
    if not times:
        peaks = [t for kind, t, _ in response.events if kind in ("peak", "collapse")]
        times = sorted(sorted(peaks, key=lambda t: -abs(np.interp(t, response.time, response.rotation)))[:6]) or [0.0]
    index = np.unique(np.clip(np.searchsorted(response.time, np.array(times) - 1e-9), 0, len(response.time) - 1))
    rotation = response.rotation[index]
    b = model.block
    toe = np.where(rotation < 0.0, -b.toe_left, b.toe_right)
    # From the toe along the force, as far up as the centre of mass; at rest through the middle of the base.
    toe = np.where(rotation == 0.0, 0.0, toe)
    rise = b.centre_height
    lean = np.clip(tangential[index] / np.maximum(normal[index], 1e-300), -3.0, 3.0)
    line = np.stack(
        [np.stack([toe, 0.0 * toe], axis=1), np.stack([toe + lean * rise, 0.0 * toe + rise], axis=1)], axis=1
    )
    return {
        "snapshot_time": Array(response.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(
            pose(model, rotation)[:, None, :], ("snapshot", "block", "component"), "m, m, rad", "x, y, rotation"
        ),
        "snapshot_thrust": Array(line, ("snapshot", "end", "axis"), "m", "line of the ground's force"),
    }


def _answer(r: dict, response: core_rocking.Response, model: BlockModel) -> str:
    pga, uplift = r["peak_ground_acceleration_g"], r["uplift_acceleration_g"]
    about = f"peak ground acceleration {pga:.3f} g, rocking starts at {uplift:.3f} g"
    if response.outcome == "no-hinging":
        return f"The block does not rock: {about}; it moves with the ground."
    sliding = f"It slides instead where friction is below {r['required_friction']:.2f}."
    if response.outcome == "collapse":
        times = r["impact_times_s"]
        after = (
            "without an impact"
            if not times
            else f"after {len(times)} impact{'s' if len(times) > 1 else ''}, the last at {times[-1]:.3f} s"
        )
        return f"The block overturns to {'+x' if response.peak > 0 else '-x'} {after} ({about}). {sliding}"
    return (
        f"The block rocks and stays up: {r['impacts']} impacts, greatest rotation {1e3 * abs(response.peak):.4g} mrad to "
        f"{'+x' if response.peak > 0 else '-x'}, {100 * response.peak_ratio:.1f} % of the rotation at which it would overturn "
        f"by itself ({about}). {sliding}"
    )
