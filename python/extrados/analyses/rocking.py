"""rocking: a block, or the four-hinge arch, under a ground motion (thesis 5.2, Eqs 5.1-5.3, B.1-B.3)."""

import numpy as np

from extrados.analyses import block_rocking
from extrados.analyses.arch_model import ArchModel
from extrados.analyses.block_model import as_block
from extrados.analyses.run import Context
from extrados.analyses.tilt import geometry_arrays
from extrados.core import arch as core_arch
from extrados.core import rocking as core_rocking
from extrados.decks.analyses import Rocking
from extrados.motions.motion import GRAVITY
from extrados.results.model import Array, Result, TableData
from extrados.structures.arch import Arch

#: How far the thrust line may leave a joint, as a fraction of its length, before it is a warning.
OUTSIDE = 0.01
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def run(context: Context, options: Rocking) -> Result:
    """History, impacts, energies, dynamic thrust line and friction needed."""
    if as_block(context.deck.structure, context.structure) is not None:
        return block_rocking.run(context, options)
    model = ArchModel(context.structure, context.deck.structure.restitution)
    context.warnings += model.warnings + context.motion.notes
    gamma = model.collapse[0].gamma
    # After the motion the arch rocks itself to rest; ten of its own long periods suffice.
    period = 2.0 * np.pi * np.sqrt(model.limits.mass * model.limits.critical / model.limits.gravity_moment)
    end_time = options.end_time or context.motion.end + 10.0 * period
    response = core_rocking.history(
        model.body, context.motion.ground, end_time, options.output_step, tolerance=options.tolerance
    )
    return rocking_result(context, options, model, response, gamma)


def rocking_result(
    context: Context, options: Rocking, model: ArchModel, response: core_rocking.Response, gamma: float
) -> Result:
    """The response of an arch as a stored result."""
    arch = model.arch
    thrust = _thrust(model, response)
    friction = thrust.friction
    needed = max(float(friction.max(initial=0.0)), _onset_friction(model, context, response))
    impacts = [(t, v) for kind, t, v in response.events if kind == "impact"]
    collapse = response.outcome == "collapse"
    energy = response.kinetic + response.potential
    scale = max(float(energy.max(initial=0.0)), abs(response.work), 1e-300)
    residual = float(np.abs(energy - response.ledger).max(initial=0.0)) / scale
    thesis, projection = model.restitutions
    result = Result("rocking", status="interrupted" if response.interrupted else "ok")
    result.reason = f"interrupted at {response.stop_time:.3f} s" if response.interrupted else ""
    result.results = {
        "outcome": response.outcome,
        "collapse_half_cycle": response.half_cycles if collapse else None,
        "collapse_time_s": response.stop_time if collapse else None,
        "half_cycles": response.half_cycles,
        "impacts": response.impacts,
        "impact_times_s": [t for t, _ in impacts],
        "restitution": model.restitution,
        "restitution_thesis": thesis,
        "restitution_energy_safe": projection,
        "peak_rotation_rad": response.peak,
        "peak_rotation_ratio": response.peak_ratio,
        "critical_rotation_rad": model.limits.critical,
        "uplift_acceleration_g": gamma,
        "peak_ground_acceleration_g": context.motion.peak / GRAVITY,
        "required_friction": needed if np.isfinite(needed) else None,
        "thrust_line_residual_m": float(thrust.miss.max(initial=0.0)),
        "energy_residual_ratio": residual,
        "steps": response.steps,
        "rejected_steps": response.rejected,
    }
    result.warnings += _warnings(thrust, response, needed)
    result.tables["rocking"] = TableData(
        {
            "time": response.time,
            "rotation": response.rotation,
            "rotation_rate": response.rate,
            "ground_acceleration": response.ground,
            "kinetic_energy": response.kinetic,
            "potential_energy": response.potential,
            "energy_supplied_less_lost": response.ledger,
            "required_friction": friction.max(axis=1) if len(friction) else np.zeros(0),
        },
        {
            "time": "s", "rotation": "rad", "rotation_rate": "rad/s", "ground_acceleration": "m/s^2",
            "kinetic_energy": "J", "potential_energy": "J", "energy_supplied_less_lost": "J",
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
        **geometry_arrays(arch),
        "time": Array(response.time, ("time",), "s", "output times"),
        "rotation": Array(response.rotation, ("time",), "rad", "rotation of link AB, positive to +x"),
        "rate": Array(response.rate, ("time",), "rad/s"),
        "acceleration": Array(response.acceleration, ("time",), "rad/s^2"),
        "ground": Array(response.ground, ("time",), "m/s^2", "ground acceleration"),
        "kinetic": Array(response.kinetic, ("time",), "J"),
        "potential": Array(response.potential, ("time",), "J"),
        "ledger": Array(response.ledger, ("time",), "J", "work of the ground less the energy lost at impacts"),
        "impact_time": Array(np.array([t for t, _ in impacts]), ("impact",), "s"),
        "thrust_position": Array(thrust.position, ("time", "joint"), "", "thrust line: 0 intrados, 1 extrados"),
        "required_friction": Array(friction, ("time", "joint"), "", "coefficient of friction needed"),
        **_snapshots(model, response, thrust, options),
    }
    result.answer = _answer(context, result.results, response, gamma)
    return result


def ordinal(n: int) -> str:
    """first, second, ..., tenth, 11th, 12th, 21st."""
    if n <= len(ORDINALS):
        return ORDINALS[n - 1]
    ending = "th" if n % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(n % 10, "th")
    return f"{n}{ending}"


def _mirrored(values: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Joint values of states that rock to -x, read from the other end."""
    out = values.copy()
    out[left] = values[left, ::-1]
    return out


def _thrust(model: ArchModel, response: core_rocking.Response) -> core_arch.ThrustLine:
    """Dynamic thrust line at all output times; NaN at rest, where the mechanism does not define it."""
    side = np.sign(response.rotation)
    moving = side != 0.0
    n, nt = model.arch.voussoirs + 1, len(side)
    normal, shear, position, point = (np.full(s, np.nan) for s in ((nt, n), (nt, n), (nt, n), (nt, n, 2)))
    miss = np.zeros(nt)
    if moving.any():
        s = side[moving]
        line = core_arch.thrust_line(
            model.four_hinge,
            model.arch,
            np.abs(response.rotation[moving]),
            s * response.rate[moving],
            s * response.acceleration[moving],
            s * response.ground[moving],
            response.vertical[moving],
        )
        left = s < 0.0
        normal[moving] = _mirrored(line.normal, left)
        shear[moving] = _mirrored(line.shear, left) * np.where(left, -1.0, 1.0)[:, None]
        position[moving] = _mirrored(line.position, left)
        point[moving] = _mirrored(line.point, left) * np.where(left[:, None], [-1.0, 1.0], 1.0)[:, None, :]
        miss[moving] = line.miss
    return core_arch.ThrustLine(normal, shear, position, point, miss)


def _onset_friction(model: ArchModel, context: Context, response: core_rocking.Response) -> float:
    """Greatest friction needed at the instants of uplift: the ground may jump there (thesis 5.2.3, t = 0+)."""
    lifts = [(t, side) for kind, t, side in response.events if kind == "uplift"]
    if not lifts:
        return 0.0
    time, side = np.array(lifts).T
    ground = context.motion.sample(time)
    limits = model.limits
    acceleration = -(limits.gravity_moment + side * ground * limits.drive) / limits.mass
    still = np.zeros(len(time))
    line = core_arch.thrust_line(model.four_hinge, model.arch, still, still, acceleration, side * ground, still)
    return float(line.friction.max())


def _warnings(thrust: core_arch.ThrustLine, response: core_rocking.Response, needed: float) -> list[str]:
    out = np.maximum(-thrust.position, thrust.position - 1.0)
    out = np.where(np.isnan(out), -1.0, out)
    found = []
    if out.size and out.max() > OUTSIDE:
        when, joint = np.unravel_index(out.argmax(), out.shape)
        share = float((out.max(axis=1) > OUTSIDE)[response.rotation != 0.0].mean())
        found.append(
            f"the thrust line leaves the arch in {100 * share:.0f} % of the rocking time, most at joint {joint} at "
            f"{response.time[when]:.3f} s (by {100 * out.max():.0f} % of the thickness): hinges would form elsewhere"
        )
    if not np.isfinite(needed):
        found.append("a joint comes under tension during the motion: the assumed hinges do not hold there")
    return found


def _snapshots(
    model: ArchModel, response: core_rocking.Response, thrust: core_arch.ThrustLine, options: Rocking
) -> dict[str, Array]:
    """Deformed arch and thrust line at the times asked for, or at up to six telling ones."""
    if not len(response.time):
        return {}
    times = options.thrust_line_times
    if not times:
        peaks = [t for kind, t, _ in response.events if kind in ("peak", "collapse")]
        strongest = sorted(peaks, key=lambda t: -abs(np.interp(t, response.time, response.rotation)))[:6]
        times = sorted(strongest) or [0.0]
    index = np.unique(np.clip(np.searchsorted(response.time, np.array(times) - 1e-9), 0, len(response.time) - 1))
    rotation = response.rotation[index]
    arch: Arch = model.arch
    placed = core_arch.pose(model.four_hinge, arch.centroid, np.abs(rotation))
    left = rotation < 0.0
    placed[left] = placed[left, ::-1] * np.array([-1.0, 1.0, -1.0])
    return {
        "snapshot_time": Array(response.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(
            placed, ("snapshot", "block", "component"), "m, m, rad", "x, y, rotation of the voussoirs"
        ),
        "snapshot_thrust": Array(thrust.point[index], ("snapshot", "joint", "axis"), "m", "dynamic thrust line"),
    }


def _answer(context: Context, r: dict, response: core_rocking.Response, gamma: float) -> str:
    pga = r["peak_ground_acceleration_g"]
    if response.outcome == "no-hinging":
        return (
            f"The arch does not hinge: the ground acceleration of at most {pga:.3f} g stays below the "
            f"{gamma:.3f} g at which it becomes a mechanism; it moves with the ground as a rigid body."
        )
    times = r["impact_times_s"]
    if response.outcome == "collapse":
        cycle = ordinal(r["collapse_half_cycle"])
        if not times:
            after = "without an impact"
        elif len(times) == 1:
            after = f"after one impact at {times[0]:.3f} s"
        else:
            after = f"after {r['impacts']} impacts, the last at {times[-1]:.3f} s"
        return (
            f"The arch collapses in the {cycle} half cycle {after} (at {r['collapse_time_s']:.2f} s it has turned "
            f"past recall; peak ground acceleration {pga:.3f} g, hinging starts at {gamma:.3f} g)."
        )
    way = "+x" if response.peak > 0 else "-x"
    return (
        f"The arch rocks and recovers: {r['half_cycles']} half cycles, {r['impacts']} impacts, greatest rotation "
        f"{1e3 * abs(response.peak):.3g} mrad to {way}, {100 * response.peak_ratio:.0f} % of the rotation at which gravity "
        f"would take it down (peak ground acceleration {pga:.3f} g, hinging starts at {gamma:.3f} g)."
    )
