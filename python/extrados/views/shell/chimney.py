"""Chimneys as conical shells on a clamped foot."""

import numpy as np

from extrados.model.description import Description
from extrados.model.structures.chimney import Chimney
from extrados.views.shell.mesh import Foot, ShellMesh, ShellPart
from extrados.views.shell.options import ShellOptions
from extrados.views.shell.vaults import clamped_mesh, count_along, element_size, shell_part


def shell_of_chimney(building: Description, options: ShellOptions) -> ShellMesh:
    """The middle surface of the wall, each ring of elements of the thickness at its middle."""
    chimney = building.structure
    assert isinstance(chimney, Chimney)
    wall = np.array(chimney.thicknesses)
    radius = 0.5 * np.array(chimney.widths) - 0.5 * wall
    size = element_size(options, 2.0 * np.pi * radius[0], 2.0 * np.pi * radius.mean() * chimney.height)
    around, up = 4 * count_along(0.5 * np.pi * radius[0], size, 2), count_along(chimney.height, size, 2)
    share, turn = np.linspace(0.0, 1.0, up + 1), 2.0 * np.pi * np.arange(around) / around
    r = np.interp(share, [0.0, 1.0], radius)
    xyz = np.column_stack([np.outer(r, np.cos(turn)).ravel(), np.outer(r, np.sin(turn)).ravel(), np.repeat(share * chimney.height, around)])
    k = np.arange(around)
    parts: list[ShellPart] = []
    for ring in range(up):
        here, above = ring * around + k, (ring + 1) * around + k
        on = (k + 1) % around
        connect = np.column_stack([here, ring * around + on, (ring + 1) * around + on, above])
        out = xyz[connect].mean(axis=1) * [1.0, 1.0, 0.0]
        thickness = float(np.interp(0.5 * (share[ring] + share[ring + 1]), [0.0, 1.0], wall))
        parts.append(shell_part(f"ring {ring + 1}", xyz, connect, out, thickness))
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(around)])
    return clamped_mesh(xyz, parts, [Foot("base", k, out, radius[0] * turn)], building, size, [])
