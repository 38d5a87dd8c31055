"""Flat shells in space: the axes of their nodes, and how forces spread over them."""

from collections.abc import Iterable

import numpy as np

from extrados.core.sla import shell_axes

#: Normals that differ by less than this angle are those of one plane [rad]
FLAT = 1e-5


def node_frames(xyz: np.ndarray, groups: Iterable[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Axes of the rotations of each node (nodes, 3, 3), columns, and whether the shell is flat there (nodes).

    groups: the nodes (elements, 3 or 4) of all shells that bend. Where they lie in one plane at a node, its axes are
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


def nodal_areas(xyz: np.ndarray, connect: np.ndarray) -> np.ndarray:
    """Area (elements, corners) [m^2] that each corner stands for: the integral of its shape function."""
    c = xyz[connect]
    if connect.shape[1] == 3:
        area = 0.5 * np.linalg.norm(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]), axis=1)
        return np.repeat(area[:, None] / 3.0, 3, axis=1)
    at = np.sqrt(1.0 / 3.0)
    share = np.zeros((len(connect), 4))
    for r, s in ((-at, -at), (at, -at), (at, at), (-at, at)):
        n = 0.25 * np.array([(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)])
        dr = 0.25 * np.array([-(1 - s), 1 - s, 1 + s, -(1 + s)])
        ds = 0.25 * np.array([-(1 - r), -(1 + r), 1 + r, 1 - r])
        size = np.linalg.norm(np.cross(np.einsum("c,ecx->ex", dr, c), np.einsum("c,ecx->ex", ds, c)), axis=1)
        share += size[:, None] * n
    return share


def spread(nodes: int, connect: np.ndarray, share: np.ndarray, density: np.ndarray) -> np.ndarray:
    """Nodal forces (nodes, 6) [N] of a force per area (elements, 3) [N/m^2]; share as of nodal_areas."""
    force = np.zeros((nodes, 6))
    for k, corner in enumerate(connect.T):
        np.add.at(force[:, :3], corner, share[:, k, None] * density)
    return force
