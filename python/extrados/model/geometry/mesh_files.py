"""Mesh files of other programs, read by meshio (the extra `mesh`) in a process of its own."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.files import File
from extrados.schema.hdf5 import is_hdf5, refuse_elsewhere

#: Formats that keep a mesh in several files: meshio would open whatever path the first one names
IN_PARTS = {".xdmf", ".xmf", ".node", ".ele"}
_INCLUDE = re.compile(rb"^\s*\*\s*include\b", re.IGNORECASE | re.MULTILINE)
EXPECTED = "expected a complete file of gmsh, Abaqus, VTU or another format that meshio reads, with the file extension of this format"


@dataclass(frozen=True)
class Cells:
    """Cells of one kind: its name at meshio, numbers of their nodes (cells, nodes)."""

    type: str
    data: np.ndarray


@dataclass(frozen=True)
class ForeignMesh:
    """What meshio finds in a file: places (n, d) in the file's unit, cells, and their groups by meshio's names."""

    points: np.ndarray
    cells: list[Cells]
    point_sets: dict[str, np.ndarray]
    cell_sets: dict[str, list[np.ndarray | None]]
    cell_data: dict[str, list[np.ndarray]]
    field_data: dict[str, np.ndarray]


def read_mesh_file(file: File) -> ForeignMesh:
    """The mesh in a file; BadGeometry says why there is none."""
    name = file.path.name
    if file.path.suffix.lower() in IN_PARTS or _INCLUDE.search(file.content):
        raise BadGeometry(f"{name}: the mesh consists of several files; save it as one file")
    try:
        with file.copied() as copy:
            found = read_contained("extrados.model.geometry.mesh_files:parse_mesh_file", copy, ["meshio"])
    except Unreadable as error:
        raise BadGeometry(f"{name}: this is not a mesh that meshio can read: {error}; {EXPECTED}") from None
    return ForeignMesh(**{**found, "cells": [Cells(*cells) for cells in found["cells"]]})


def parse_mesh_file(path: str) -> dict[str, Any]:
    """The fields of ForeignMesh. The contained process calls this; Unreadable gives the reason."""
    try:
        import meshio
    except ImportError:
        raise Unreadable("reading meshes requires meshio. Install it by pip install 'extrados[mesh]'") from None
    if is_hdf5(path):
        refuse_elsewhere(path)
    try:
        mesh = meshio.read(path)
    except SystemExit:  # meshio ends the process on some errors
        raise Unreadable("meshio does not recognise its content") from None
    except MemoryError:
        raise
    except Exception as error:
        text = re.sub(r"'?\S*extrados-\S*'?", "the file", str(error))  # the name of the copy
        raise Unreadable(text or "unknown format") from None
    return {
        "points": np.asarray(mesh.points, dtype=float),
        "cells": [(cells.type, _numbers(cells.data)) for cells in mesh.cells],
        "point_sets": {name: _numbers(points) for name, points in mesh.point_sets.items()},
        "cell_sets": {name: [None if rows is None else _numbers(rows) for rows in sets] for name, sets in mesh.cell_sets.items()},
        "cell_data": {name: [_numbers(values) for values in blocks] for name, blocks in mesh.cell_data.items()},
        "field_data": {name: _numbers(values) for name, values in mesh.field_data.items()},
    }


def _numbers(values: Any) -> np.ndarray:
    """An array of numbers; Unreadable where it holds anything else."""
    array = np.asarray(values)
    if array.dtype.kind not in "iufb":
        raise Unreadable(f"the file has an array of {array.dtype} instead of numbers")
    return array
