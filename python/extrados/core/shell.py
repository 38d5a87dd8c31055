"""Flat shells in space: the axes of elements and of their nodes."""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core.calls import indices, real
from extrados.core.errors import check
from extrados.core.sla_groups import BadElement
from extrados.core.sla_parts import THROUGH

#: Normals that differ by less than this angle are those of one plane [rad]
FLAT = 1e-5


def shell_axes(xyz: npt.ArrayLike, connect: npt.ArrayLike) -> np.ndarray:
    """Axes (elements, 3, 3) of flat shells, rows x, y, normal: x is horizontal, y goes up; of horizontal ones x is x.

    xyz (nodes, 3) [m]; connect (elements, 3 or 4), from 0.
    """
    place = real("xyz", np.transpose(xyz), (3, None))
    nodes = indices("connect", np.transpose(connect), place.shape[1], (None, None))
    axes, bad, status = _core.api_shell.axes_of(place, nodes)
    if bad:
        raise BadElement(bad - 1, "shell")
    check(status, "axes of shells")
    return np.array(np.transpose(axes, (2, 0, 1)))


def node_frames(xyz: np.ndarray, groups: Iterable[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Axes of the rotations of each node (nodes, 3, 3), columns, and whether the shell is flat there (nodes).

    xyz (nodes, 3) [m]. groups: the nodes (elements, 3 or 4) of all shells that bend. Where they lie in one plane at a node, its axes are
    those of the plane, the third its normal; elsewhere they are x, y, z.
    """
    frames, flat = np.tile(np.eye(3), (len(xyz), 1, 1)), np.ones(len(xyz), dtype=bool)
    seen = np.zeros(len(xyz), dtype=bool)
    for connect in groups:
        axes = shell_axes(xyz, connect)
        for corner in connect.T:
            first = ~seen[corner]
            # Of several elements at a node the last one written stands, whichever: the others are compared with it
            frames[corner[first]] = np.transpose(axes[first], (0, 2, 1))
            seen[corner] = True
            away = np.linalg.norm(np.cross(frames[corner, :, 2], axes[:, 2]), axis=1)
            flat[corner[away > FLAT]] = False
    frames[~flat | ~seen] = np.eye(3)
    return frames, flat & seen


def layers_of(count: int, through: str) -> tuple[np.ndarray, np.ndarray]:
    """Heights (count) of the layers of a shell over its middle, in thicknesses, and their shares (count) of the thickness."""
    height, share, status = _core.api_shell.layers_of(THROUGH[through], count)
    check(status, f"{count} layers by {through}")
    return np.array(height[:count]), np.array(share[:count])
