"""Walls from mesh files, read by meshio (the extra `mesh`)."""

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry, blaming
from extrados.model.files import read
from extrados.model.geometry.mesh_files import ForeignMesh, read_mesh_file
from extrados.model.structures.walls import MeshFile
from extrados.views.mesh.mesh import Mesh, build_mesh, element_areas
from extrados.views.mesh.options import MeshOptions

KINDS = {"triangle": "T3", "triangle6": "T6", "quad": "Q4", "quad8": "Q8"}
LARGEST = 500_000_000  # bytes
#: Farther from the origin no place of a building is [m]: map coordinates (UTM: up to 1e7 m north) must be moved to the
#: building first
FARTHEST = 1e6


def open_mesh(wall: MeshFile, building: Description) -> tuple[str, ForeignMesh]:
    """The name of the file and what meshio finds in it, places in its own unit; BadGeometry says what is wrong."""
    file = read(wall.file, LARGEST, building.folder)
    path, mesh = file.path, read_mesh_file(file)
    points = mesh.points
    if not np.isfinite(points).all():
        raise BadGeometry(f"{path.name}: the coordinates of node {int(np.argwhere(~np.isfinite(points))[0, 0]) + 1} are not finite")
    far = np.abs(points).max(initial=0.0) * wall.scale
    if far > FARTHEST:
        node = int(np.abs(points).max(axis=1).argmax()) + 1
        raise BadGeometry(
            f"{path.name}: node {node} is {far:.3g} m from the origin, but at most {FARTHEST:g} m are allowed. Move "
            "the origin to the building"
        )
    for cells in mesh.cells:
        data = np.asarray(cells.data)
        if data.size and (data.min() < 0 or data.max() >= len(points)):
            raise BadGeometry(
                f"{path.name}: a cell of kind '{cells.type}' names a node that does not exist; the file has {len(points)} nodes"
            )
    return path.name, mesh


def mesh_file(building: Description, options: MeshOptions, seed: int | None = None) -> Mesh:
    """Finite elements of a mesh file, which draws no random pattern."""
    assert isinstance(building.structure, MeshFile)
    with blaming("file"):
        return read_mesh(building.structure, building, options)


def read_mesh(wall: MeshFile, building: Description, options: MeshOptions) -> Mesh:
    """The plane elements of a file, of one kind; other cells (lines, points) are passed over."""
    if wall.groups:
        raise BadGeometry(
            "the key `groups` is only for shells in space (`pushover`); for a plane wall give the key `regions`", ("structure", "groups")
        )
    name, mesh = open_mesh(wall, building)
    found: dict[str, list[np.ndarray]] = {}
    for cells in mesh.cells:
        if cells.type in KINDS:
            found.setdefault(cells.type, []).append(np.asarray(cells.data))
        elif cells.type not in ("line", "line3", "vertex"):
            raise BadGeometry(f"{name}: this file has cells of kind '{cells.type}'; expected {', '.join(KINDS)}")
    if len(found) != 1:
        kinds = ", ".join(found) or "none"
        raise BadGeometry(f"{name}: this file has plane cells of the kinds {kinds}; expected exactly one of {', '.join(KINDS)}")
    points = np.asarray(mesh.points, dtype=float)
    if points.shape[1] > 2 and np.ptp(points[:, 2]) > 1e-9 * np.ptp(points[:, :2]):
        raise BadGeometry(f"{name}: the mesh is not plane: z runs from {points[:, 2].min():g} to {points[:, 2].max():g}")
    ((word, parts),) = found.items()
    kind, connect = KINDS[word], np.concatenate(parts)
    xy = wall.scale * points[:, :2]
    area = element_areas(xy, kind, connect)
    if (area < 0).all():  # a mesh drawn clockwise throughout is only looked at from behind
        order = {"T3": [0, 2, 1], "T6": [0, 2, 1, 5, 4, 3], "Q4": [0, 3, 2, 1], "Q8": [0, 3, 2, 1, 7, 6, 5, 4]}[kind]
        connect = connect[:, order]
    return build_mesh(wall, building, options, xy, kind, connect, float(np.sqrt(np.median(np.abs(area)))))
