"""rocking of any section by the collapse mechanisms that limit analysis finds to +x and to -x."""

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.rocking.history import answer_of, rest_time, rock, rocking_result, snapshot_index
from extrados.analyses.rocking.tables import Rocking
from extrados.results.model import Array, Result
from extrados.results.rocking import RockingHinge
from extrados.views.rockers.frame import FrameModel
from extrados.views.rockers.mechanism import MechanismModel
from extrados.views.rockers.rocker import Rocker


def run(context: Context, options: Rocking, rocker: Rocker) -> Result:
    """History, impacts, energies, and the friction needed at the hinges where statics tells it."""
    model = rocker.model
    assert isinstance(model, MechanismModel)
    context.warnings += rocker.warnings
    end_time = options.end_time or context.motion.end + rest_time(rocker)
    joints = len(model.assembly.a)
    ran = rock(context, options, rocker, end_time, 8 + joints)
    response = ran.response

    forces = model.hinge_forces(
        response.rotation,
        response.rate,
        response.acceleration,
        response.ground,
        response.vertical,
        None if rocker.restraints is None else (rocker.restraints, response.forces),
    )
    friction = np.where(np.isnan(forces.normal), 0.0, forces.friction)
    needed = float(friction.max(initial=0.0)) if response.joints is None else float(response.joints.friction)
    known = any(one.determinate for one in model.linkages)
    side = 0 if response.peak >= 0.0 else 1
    result = rocking_result(
        context,
        ran,
        rocker,
        model.driver(side),
        friction,
        restitution=model.restitution[0],
        restitution_to_left=model.restitution[1],
        critical_rotation_rad=rocker.critical[0],
        critical_rotation_left_rad=rocker.critical[1],
        uplift_acceleration_g=rocker.uplift,
        required_friction=needed if known and np.isfinite(needed) else None,
        hinges=_hinges(model, 0),
        hinges_opposite=_hinges(model, 1),
        **({"frequency_parameter_rad_s": model.frequency} if isinstance(model, FrameModel) else {}),
    )
    index = snapshot_index(response, options, result.warnings)
    result.arrays |= {
        **geometry_arrays(model.assembly),
        "snapshot_time": Array(response.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(
            model.pose(response.rotation[index]), ("snapshot", "block", "component"), "m, m, rad", "x, y and rotation of the blocks"
        ),
    }
    result.answer = answer_of(context, ran, f"The {rocker.word}", "collapses", rocker.uplift)
    return result


def _hinges(model: MechanismModel, side: int) -> list[RockingHinge]:
    """Where the mechanism of one side turns."""
    one = model.linkages[side]
    return [RockingHinge(joint=j, name=model.assembly.joint_names[j], x_m=x, y_m=y) for j, (x, y) in zip(one.joint, one.point, strict=True)]
