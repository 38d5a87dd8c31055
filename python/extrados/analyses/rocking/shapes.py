"""What a rocking structure looks like at chosen times: places of its stones, and the line of thrust or of the ground's force."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.rocking import arch, block
from extrados.analyses.rocking.tables import Rocking
from extrados.core import arch as core_arch
from extrados.model.geometry.assembly import Assembly
from extrados.results.model import Array, Result
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.mechanism import MechanismModel
from extrados.views.rockers.rocker import Rocker

#: Pictures of a film in a second of real time, and the most that are kept
RATE, MOST = 30.0, 900


class States(NamedTuple):
    """States of a rocking structure (n each): rotation [rad], rate, acceleration, ground and vertical [m/s^2]."""

    rotation: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    ground: np.ndarray
    vertical: np.ndarray


class Shapes(NamedTuple):
    """Poses (n, blocks, 3) [m, m, rad]; the line (n, points, 2) [m], NaN where there is none, None where statics tells
    none; friction needed at the joints (n, joints), None likewise."""

    pose: np.ndarray
    line: np.ndarray | None
    friction: np.ndarray | None


def shapes(rocker: Rocker, states: States) -> Shapes:
    """The structure in given states."""
    model, rotation = rocker.model, states.rotation
    if isinstance(model, ArchModel):
        thrust = arch.thrust_line(model, states)
        placed = core_arch.pose(model.four_hinge, model.arch.centroid, np.abs(rotation))
        left = rotation < 0.0
        placed[left] = placed[left, ::-1] * np.array([-1.0, 1.0, -1.0])
        return Shapes(placed, thrust.point, thrust.friction)
    if isinstance(model, BlockModel):
        tangential, normal = block.toe_forces(model, states)
        line = block.force_line(model, rotation, tangential, normal)
        friction = np.abs(tangential) / np.where(normal > 0.0, normal, np.nan)
        return Shapes(block.pose(model, rotation)[:, None, :], line, friction[:, None])
    assert isinstance(model, MechanismModel)
    forces = model.hinge_forces(rotation, states.rate, states.acceleration, states.ground, states.vertical)
    return Shapes(model.pose(rotation), None, np.where(np.isnan(forces.normal), np.nan, forces.friction))


def pictures(time: np.ndarray) -> np.ndarray:
    """Which output times are the pictures of a film."""
    step = max(1.0 / RATE, (time[-1] - time[0]) / MOST)
    return np.unique(np.searchsorted(time, np.arange(time[0], time[-1] + 0.5 * step, step)).clip(max=len(time) - 1))


def film(time: np.ndarray, pose: np.ndarray) -> dict[str, Array]:
    """What a film shows: times [s], and poses (times, blocks, 3) [m, m, rad] of the stones."""
    return {
        "film_time": Array(time, ("film",), "s", "times of the pictures of the animation"),
        "film_pose": Array(pose, ("film", "block", "component"), "m, m, rad", "x, y and rotation of the blocks"),
    }


def drawn_times(time: np.ndarray, rotations: np.ndarray, options: Rocking) -> np.ndarray:
    """Output times at which several coordinates (coordinates, times) are drawn: the requested ones, or up to six crests."""
    if not len(time):
        return np.zeros(0, dtype=int)
    if options.thrust_line_times:
        return np.unique(np.clip(np.searchsorted(time, options.thrust_line_times), 0, len(time) - 1))
    crests: list[int] = [k for q in np.abs(rotations) for k in (np.flatnonzero((q[1:-1] >= q[:-2]) & (q[1:-1] > q[2:])) + 1).tolist()]
    size = np.abs(rotations).max(axis=0)
    chosen = sorted(dict.fromkeys([*crests, int(size.argmax())]), key=lambda k: -size[k])[:6]
    return np.array(sorted(chosen))


def course_arrays(options: Rocking, time: np.ndarray, rotations: np.ndarray, pose: Callable[[np.ndarray], np.ndarray]) -> dict[str, Array]:
    """Shapes at the drawn times, and the film where the deck requests one; pose(index): (times, blocks, 3) [m, m, rad] at output
    times; rotations (coordinates, times) [rad]."""
    index = drawn_times(time, rotations, options)
    found = {
        "snapshot_time": Array(time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(pose(index), ("snapshot", "block", "component"), "m, m, rad", "x, y, rotation"),
    }
    if options.animation != "none" and len(time):
        shown = pictures(time)
        found |= film(time[shown], pose(shown))
    return found


def film_arrays(rocker: Rocker, result: Result) -> dict[str, Array]:
    """The shapes of a stored history at the pictures of a film."""
    get = {name: np.asarray(array.data) for name, array in result.arrays.items()}
    time = get["time"]
    if not len(time):
        return {}
    index = pictures(time)
    made = shapes(rocker, States(*(get[k][index] for k in ("rotation", "rate", "acceleration", "ground", "vertical"))))
    arrays = film(time[index], made.pose)
    if made.line is not None:
        arrays["film_line"] = Array(made.line, ("film", "line_point", "axis"), "m", "thrust line, or line of the reaction of the ground")
    return arrays


def on_contacts(assembly: Assembly, result: Result) -> dict[str, Array]:
    """Shapes of a structure whose blocks rigid contacts took over: six, and the film where the analysis made one of the mechanism."""
    time, place = np.asarray(result.arrays["contacts_time"].data), np.asarray(result.arrays["contacts_place"].data)
    if not len(time):
        return {}
    away = np.abs(place - place[-1]).max(axis=(1, 2))
    last = int(np.flatnonzero(away >= 0.01 * away.max())[-1])
    index = np.unique(np.linspace(0, last, 6).round().astype(int))
    found = {
        **geometry_arrays(assembly),
        "snapshot_time": Array(time[index], ("snapshot",), "s"),
        "snapshot_pose": Array(place[index], ("snapshot", "block", "component"), "m, m, rad", "x, y and rotation of the blocks"),
    }
    if "film_pose" in result.arrays:
        shown = pictures(time)
        times, poses = time[shown], place[shown]
        before = result.arrays["film_pose"].data
        if before.shape[1] == poses.shape[1]:  # else a column, whose mechanism is one body
            early = result.arrays["film_time"].data < times[0]
            times = np.concatenate([result.arrays["film_time"].data[early], times])
            poses = np.concatenate([before[early], poses])
        found |= film(times, poses)
    return found
