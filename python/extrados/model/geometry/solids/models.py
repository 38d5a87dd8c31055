"""Models in space that a library reads: glTF by trimesh (extra `scan`), IFC by ifcopenshell (extra `ifc`); a node or element is a block."""

import io
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.solids.meshes import MOST_VERTICES, Mesh, shells_of_triangles
from extrados.schema.contained import Unreadable


def parse_model(content: bytes, name: str, sort: str) -> list[dict[str, Any]]:
    """The fields of each Mesh of a glTF or IFC file; shells of a node or element are the convex parts of a block. The contained process
    calls this; Unreadable gives the reason."""
    try:
        rows = list(_elements(content) if sort == ".ifc" else _nodes(content, sort))
    except ImportError as error:
        extra = "ifc" if sort == ".ifc" else "scan"
        raise Unreadable(f"reading {sort} files requires {error.name}. Install it by pip install 'extrados[{extra}]'") from None
    seen: Counter[str] = Counter()
    solids: dict[str, np.ndarray] = {}
    for title, triangles in rows:
        own = title
        while own in solids:
            seen[title] += 1
            own = f"{title} ({seen[title] + 1})"
        solids[own] = triangles
    if not solids:
        raise Unreadable("the file has no bodies of triangles")
    if sum(map(len, solids.values())) > MOST_VERTICES // 3:
        raise Unreadable(f"the file has more than {MOST_VERTICES // 3} triangles")
    if not all(np.isfinite(triangles).all() for triangles in solids.values()):
        raise Unreadable("a coordinate is not a finite number")
    try:
        shells = shells_of_triangles(solids, name)
    except BadGeometry as error:
        raise Unreadable(str(error), error.at) from None
    return [
        asdict(Mesh(title if len(pieces) == 1 else f"part {k} of {title}", points, faces, title))
        for title, pieces in shells.items()
        for k, (points, faces) in enumerate(pieces, start=1)
    ]


def _nodes(content: bytes, sort: str) -> Iterator[tuple[str, np.ndarray]]:
    """Names and triangles (n, 3, 3) [m] of the nodes of a glTF in their places."""
    import trimesh

    scene: Any = trimesh.load(io.BytesIO(content), file_type=sort[1:], force="scene")
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if not hasattr(mesh, "faces"):  # lines and points
            continue
        points = np.asarray(mesh.vertices, dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]
        yield str(node), points[np.asarray(mesh.faces)]


def _elements(content: bytes) -> Iterator[tuple[str, np.ndarray]]:
    """Names and triangles (n, 3, 3) [m] of the elements of an IFC model with a body, less their openings."""
    import ifcopenshell
    import ifcopenshell.geom

    model = ifcopenshell.file.from_string(content.decode("utf-8", "replace"))
    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    for element in model.by_type("IfcElement"):
        if element.is_a("IfcFeatureElement") or not element.Representation:
            continue
        try:
            shape: Any = ifcopenshell.geom.create_shape(settings, element)
        except RuntimeError:
            raise Unreadable(f"the body of {element.is_a()} '{element.Name or element.GlobalId}' cannot be evaluated") from None
        points = np.array(shape.geometry.verts, dtype=float).reshape(-1, 3)
        yield str(element.Name or element.GlobalId), points[np.array(shape.geometry.faces, dtype=int).reshape(-1, 3)]
