"""rocking: a block, or the four-hinge arch, under a ground motion (thesis 5.2, Eqs 5.1-5.3, B.1-B.3)."""

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.tilt import geometry_arrays
from extrados.analyses.rocking import block as block_rocking
from extrados.analyses.rocking import mechanism as mechanism_rocking
from extrados.analyses.rocking import soft_base as soft_base_rocking
from extrados.analyses.rocking import stack as stack_rocking
from extrados.analyses.rocking.common import with_moving_supports
from extrados.analyses.rocking.doubts import doubts
from extrados.analyses.rocking.history import answer, rest_time, rocking_result, run_history, snapshot_index
from extrados.analyses.rocking.tables import Rocking
from extrados.building.rockers.arch import ArchModel
from extrados.building.rockers.block import BlockModel
from extrados.building.rockers.mechanism import MechanismModel
from extrados.building.rockers.rocker import Rocker
from extrados.building.templates.arch import ArchAssembly
from extrados.core import arch as core_arch
from extrados.core import rocking as core_rocking
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY

#: How far the thrust line may leave a joint, as a fraction of its length, before it is a warning.
OUTSIDE = 0.01


def run(context: Context, options: Rocking) -> Result:
    """History, impacts, energies, friction needed; of an arch the dynamic thrust line too."""
    context = with_moving_supports(context)
    structure = context.building.structure
    if structure is not None and structure.rocks_as == "stack":
        return _with_friction(context, stack_rocking.run(context, options))
    if context.building.supports.stiffness is not None:
        return _with_friction(context, soft_base_rocking.run(context, options))
    rocker = context.building.rocker(options.form == "linear")
    kinds = {BlockModel: block_rocking.run, MechanismModel: mechanism_rocking.run, ArchModel: _arch}
    result = next(run for kind, run in kinds.items() if isinstance(rocker.model, kind))(context, options, rocker)
    if options.animation != "none":
        from extrados.analyses.rocking.shapes import film_arrays

        result.arrays |= film_arrays(rocker, result)
    return _with_friction(context, result)


def _with_friction(context: Context, result: Result) -> Result:
    """The result, with a warning where the joints do not have the friction that it needs."""
    needed, given = result.results.required_friction, context.building.joints.coefficient
    if given is not None and needed is not None and needed > given:
        result.warnings.append(
            f"a coefficient of friction of {needed:.2f} is needed, the joints have {given:g}: it slides, which rocking "
            "leaves out; see the analysis `dem`"
        )
    return result


def _arch(context: Context, options: Rocking, rocker: Rocker) -> Result:
    model = rocker.model
    context.warnings += model.warnings
    gamma = model.collapse[0].gamma
    end_time = options.end_time or context.motion.end + rest_time(rocker)
    joints = model.arch.voussoirs + 1
    response = run_history(context, options, rocker.body, end_time, 8 + 6 * joints, rocker.start_rotation)

    thrust = _thrust(model, response)
    needed = max(float(thrust.friction.max(initial=0.0)), _onset_friction(model, context, response))
    doubt = doubts(context, options, rocker, response, end_time)
    result = rocking_result(
        context,
        response,
        doubt,
        rocker,
        "link AB",
        thrust.friction,
        restitution=model.restitution,
        restitution_thesis=model.impacts.thesis,
        restitution_energy_safe=model.impacts.energy_safe,
        restitution_inelastic=model.impacts.inelastic,
        critical_rotation_rad=model.limits.critical,
        uplift_acceleration_g=gamma,
        required_friction=needed,
        thrust_line_residual_m=thrust.miss.max(initial=0.0),
    )
    result.warnings += _warnings(thrust, response, needed)
    result.arrays |= {
        **geometry_arrays(model.arch),
        "thrust_position": Array(thrust.position, ("time", "joint"), "", "thrust line: 0 intrados, 1 extrados"),
        **_snapshots(model, response, thrust, snapshot_index(response, options, result.warnings)),
    }
    result.answer = answer(context, response, f"The {rocker.word}", "collapses", gamma)
    return result


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
    up = context.motion.sample(time, 1) if context.motion.ground.channels > 1 else np.zeros(len(time))
    limits = model.limits
    acceleration = -(limits.gravity_moment * (1.0 + up / GRAVITY) + side * ground * limits.drive) / limits.mass
    still = np.zeros(len(time))
    line = core_arch.thrust_line(model.four_hinge, model.arch, still, still, acceleration, side * ground, up)
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
    model: ArchModel, response: core_rocking.Response, thrust: core_arch.ThrustLine, index: np.ndarray
) -> dict[str, Array]:
    """Deformed arch and thrust line at some output times."""
    rotation = response.rotation[index]
    arch: ArchAssembly = model.arch
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
