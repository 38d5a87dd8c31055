"""rocking of the four-hinge arch (thesis 5.2, Eqs 5.1-5.3, B.1-B.3)."""

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.tilt import geometry_arrays
from extrados.analyses.rocking.common import Moving
from extrados.analyses.rocking.history import answer_of, rest_time, rock, rocking_result, snapshot_index
from extrados.analyses.rocking.tables import Rocking
from extrados.core import arch as core_arch
from extrados.core import rocking as core_rocking
from extrados.model.structures.arch import ArchAssembly
from extrados.results.model import Array, Result
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker


def run(context: Context, options: Rocking, rocker: Rocker) -> Result:
    """History, impacts, energies and the dynamic thrust line."""
    model = rocker.model
    assert isinstance(model, ArchModel)
    context.warnings += model.warnings
    gamma = model.collapse[0].gamma
    end_time = options.end_time or context.motion.end + rest_time(rocker)
    joints = model.arch.voussoirs + 1
    ran = rock(context, options, rocker, end_time, 8 + 6 * joints)
    response = ran.response

    thrust = thrust_line(model, response)
    result = rocking_result(
        context,
        ran,
        rocker,
        "link AB",
        thrust.friction,
        restitution=model.restitution,
        restitution_thesis=model.impacts.thesis,
        restitution_energy_safe=model.impacts.energy_safe,
        restitution_inelastic=model.impacts.inelastic,
        critical_rotation_rad=model.limits.critical,
        uplift_acceleration_g=gamma,
        required_friction=None if response.joints is None else float(response.joints.friction),
        thrust_line_residual_m=thrust.miss.max(initial=0.0),
    )
    result.arrays |= {
        **geometry_arrays(model.arch),
        "thrust_position": Array(
            thrust.position, ("time", "joint"), "", "position of the thrust line in each joint: 0 intrados, 1 extrados"
        ),
        **_snapshots(model, response, thrust, snapshot_index(response, options, result.warnings)),
    }
    result.answer = answer_of(context, ran, f"The {rocker.word}", "collapses", gamma)
    return result


def _mirrored(values: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Joint values of states that rock to -x, read from the other end."""
    out = values.copy()
    out[left] = values[left, ::-1]
    return out


def thrust_line(model: ArchModel, response: Moving) -> core_arch.ThrustLine:
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


def _snapshots(model: ArchModel, response: core_rocking.Response, thrust: core_arch.ThrustLine, index: np.ndarray) -> dict[str, Array]:
    """Deformed arch and thrust line at some output times."""
    rotation = response.rotation[index]
    arch: ArchAssembly = model.arch
    placed = core_arch.pose(model.four_hinge, arch.centroid, np.abs(rotation))
    left = rotation < 0.0
    placed[left] = placed[left, ::-1] * np.array([-1.0, 1.0, -1.0])
    return {
        "snapshot_time": Array(response.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(placed, ("snapshot", "block", "component"), "m, m, rad", "x, y and rotation of the voussoirs"),
        "snapshot_thrust": Array(thrust.point[index], ("snapshot", "joint", "axis"), "m", "dynamic thrust line"),
    }
