"""rocking of a block on its toes (thesis 6.2, Eqs 6.1 to 6.4)."""

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.tilt import geometry_arrays
from extrados.analyses.rocking.common import Moving
from extrados.analyses.rocking.history import answer_of, rest_time, rock, rocking_result, snapshot_index
from extrados.analyses.rocking.tables import Rocking
from extrados.core import rocking as core_rocking
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.restraints import Restraints
from extrados.views.rockers.rocker import Rocker


def run(context: Context, options: Rocking, rocker: Rocker) -> Result:
    """History, impacts, energies, and the friction that keeps the toe from sliding."""
    structure = context.building.require_structure()
    model = rocker.model
    assert isinstance(model, BlockModel)
    context.warnings += rocker.warnings
    if structure.kind == "column":
        context.warnings.append("the column is modelled as one rigid body; use `dem` for joints that open")
    end_time = options.end_time or context.motion.end + rest_time(rocker)
    ran = rock(context, options, rocker, end_time, 12)
    response = ran.response

    tangential, normal = toe_forces(model, response, rocker.restraints, response.forces)
    c_v = model.restitution
    assert response.joints is not None
    needed = max(float(response.joints.friction), _at_rest(context, rocker, response))
    result = rocking_result(
        context,
        ran,
        rocker,
        f"the {rocker.word}",
        _friction(model, tangential, normal)[:, None],
        restitution=c_v[0],
        restitution_to_left=c_v[1],
        energy_ratio=c_v[0] ** 2 * model.block.toe_inertia[0] / model.block.toe_inertia[1],
        critical_rotation_rad=rocker.critical[0],
        critical_rotation_left_rad=rocker.critical[1],
        frequency_parameter_rad_s=model.frequency[0],
        uplift_acceleration_g=rocker.uplift,
        required_friction=needed if np.isfinite(needed) else None,
    )
    index = snapshot_index(response, options, result.warnings)
    result.arrays |= {**geometry_arrays(model.block), **_snapshots(model, response, tangential, normal, index)}
    result.answer = answer_of(context, ran, f"The {rocker.word}", "overturns", rocker.uplift)
    if ran.conditions.slides_first is None and np.isfinite(needed):  # else the conditions state the friction that rocking requires
        result.answer += f" If friction is below {needed:.2f}, the {rocker.word} slides instead."
    return result


def _friction(model: BlockModel, tangential: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Friction that forces of the ground at the toe require (times), 0 where the block would fly; forces to +x and up [N]."""
    c, s = np.cos(model.block.slope), np.sin(model.block.slope)
    across = c * normal - s * tangential  # on a sloping base
    return np.where(across > 0.0, np.abs(c * tangential + s * normal) / np.maximum(across, 1e-300), 0.0)


def _at_rest(context: Context, rocker: Rocker, response: core_rocking.Response) -> float:
    """Greatest friction that the ground requires while the block rests, under the prestress of its restraints as given."""
    model, held = rocker.model, rocker.restraints
    assert isinstance(model, BlockModel)
    changes = [(t, kind == "rest") for kind, t, _ in response.events if kind in ("uplift", "rest")]
    begins = np.array([0.0, *(t for t, _ in changes), response.stop_time])
    rests = np.array([not rocker.start_rotation, *(rests for _, rests in changes), False])
    time = context.motion.series()[0]
    time = np.concatenate([begins, time[time <= response.stop_time]])
    time = time[rests[np.searchsorted(begins, time, side="right") - 1]]
    ground = context.motion.ground
    vertical = ground.sample(time, 1) if ground.channels > 1 else 0.0 * time
    pull = np.zeros(2) if held is None else held.prestress(1)[0, :2]
    mass = model.block.mass[0]
    friction = _friction(model, mass * ground.sample(time) - pull[0], mass * (GRAVITY + vertical) - pull[1])
    return float(friction.max(initial=0.0))


def toe_forces(
    model: BlockModel, response: Moving, held: Restraints | None = None, forces: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Horizontal (to +x) and vertical (up) force of the ground on the block at the output times [N]; held: its restraints, with their forces."""
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
    tangential, normal = mass * (response.ground + x), mass * (GRAVITY + response.vertical + y)
    if held is not None and forces is not None:
        pull = held.pull(response.rotation, forces)
        tangential, normal = tangential - pull[:, 0], normal - pull[:, 1]
    return tangential, normal


def pose(model: BlockModel, rotation: np.ndarray) -> np.ndarray:
    """x, y [m] and rotation [rad, counter-clockwise] of the centre of mass (n, 3)."""
    b = model.block
    left = rotation < 0.0
    i = left.astype(int)
    side = np.where(left, -1.0, 1.0)
    toe = side * b.toes[i]
    rest = b.alpha[i] - np.abs(rotation)
    x, y = toe * np.cos(b.slope), toe * np.sin(b.slope)
    return np.stack([x - side * b.radius[i] * np.sin(rest), y + b.radius[i] * np.cos(rest), -rotation], axis=1)


def force_line(model: BlockModel, rotation: np.ndarray, tangential: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The line of the ground's force (n, 2 ends, 2) [m]: from the toe along the force, as far up as the centre of mass; at rest
    through the middle of the base."""
    b = model.block
    toe = np.where(rotation < 0.0, -b.toe_left, b.toe_right)
    toe = np.where(rotation == 0.0, 0.0, toe)
    foot = toe * np.sin(b.slope)
    toe = toe * np.cos(b.slope)
    rise = b.centre_height
    lean = np.clip(tangential / np.maximum(normal, 1e-300), -3.0, 3.0)
    return np.stack([np.stack([toe, foot], axis=1), np.stack([toe + lean * rise, foot + rise], axis=1)], axis=1)


def _snapshots(
    model: BlockModel, response: core_rocking.Response, tangential: np.ndarray, normal: np.ndarray, index: np.ndarray
) -> dict[str, Array]:
    """The block and the line of the ground's force at some output times."""
    rotation = response.rotation[index]
    line = force_line(model, rotation, tangential[index], normal[index])
    return {
        "snapshot_time": Array(response.time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(pose(model, rotation)[:, None, :], ("snapshot", "block", "component"), "m, m, rad", "x, y, rotation"),
        "snapshot_thrust": Array(line, ("snapshot", "end", "axis"), "m", "line of the ground's force"),
    }
