"""Walls from mesh files, read by meshio (the extra `mesh`)."""

import contextlib
import io
from typing import TYPE_CHECKING

import numpy as np

from extrados.building.errors import BadGeometry
from extrados.building.files import locate
from extrados.building.mesh.mesh import Mesh, build_mesh, element_areas
from extrados.building.mesh.options import MeshOptions
from extrados.building.templates.walls import MeshFile

if TYPE_CHECKING:
    from extrados.building.building import Building

KINDS = {"triangle": "T3", "triangle6": "T6", "quad": "Q4", "quad8": "Q8"}
LARGEST = 500_000_000  # bytes


def read_mesh(wall: MeshFile, building: "Building", options: MeshOptions) -> Mesh:
    """The plane elements of a file, of one kind; other cells (lines, points) are passed over."""
    try:
        import meshio
    except ImportError:
        raise BadGeometry("reading meshes needs meshio: pip install 'extrados[mesh]'") from None
    path = locate(wall.file, building.folder)
    try:
        if path.stat().st_size > LARGEST:
            raise BadGeometry(f"{path.name}: larger than {LARGEST / 1e6:g} MB")
        # meshio prints its warnings and ends the process on some errors
        with contextlib.redirect_stdout(io.StringIO()):
            mesh = meshio.read(path)
    except OSError as error:
        raise BadGeometry(f"{path.name}: cannot be read: {error.strerror or error}") from None
    except (SystemExit, Exception) as error:
        if isinstance(error, BadGeometry):
            raise
        raise BadGeometry(f"{path.name}: is not a mesh that meshio reads: {str(error) or 'unknown format'}") from None
    found: dict[str, list[np.ndarray]] = {}
    for cells in mesh.cells:
        if cells.type in KINDS:
            found.setdefault(cells.type, []).append(np.asarray(cells.data))
        elif cells.type not in ("line", "line3", "vertex"):
            raise BadGeometry(f"{path.name}: cells of kind '{cells.type}'; expected {', '.join(KINDS)}")
    if len(found) != 1:
        kinds = ", ".join(found) or "none"
        raise BadGeometry(f"{path.name}: holds plane cells of kind {kinds}; expected exactly one of {', '.join(KINDS)}")
    points = np.asarray(mesh.points, dtype=float)
    if points.shape[1] > 2 and np.ptp(points[:, 2]) > 1e-9 * np.ptp(points[:, :2]):
        raise BadGeometry(
            f"{path.name}: the mesh is not plane: z runs from {points[:, 2].min():g} to {points[:, 2].max():g}"
        )
    if not np.isfinite(points).all():
        raise BadGeometry(f"{path.name}: node {int(np.argwhere(~np.isfinite(points))[0, 0]) + 1} has no finite place")
    ((name, parts),) = found.items()
    kind, connect = KINDS[name], np.concatenate(parts)
    xy = wall.scale * points[:, :2]
    area = element_areas(xy, kind, connect)
    if (area < 0).all():  # a mesh drawn clockwise throughout is only looked at from behind
        order = {"T3": [0, 2, 1], "T6": [0, 2, 1, 5, 4, 3], "Q4": [0, 3, 2, 1], "Q8": [0, 3, 2, 1, 7, 6, 5, 4]}[kind]
        connect = connect[:, order]
    return build_mesh(wall, building, options, xy, kind, connect, float(np.sqrt(np.median(np.abs(area)))))
