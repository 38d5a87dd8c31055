"""Assemblies of COMPAS: blocks that are prisms across one plane, read as their section in it.

The layout is that of compas.json_dump of a compas_assembly Assembly: a graph whose nodes hold a block, a mesh of
vertices and faces, and `is_support`. Interfaces are found anew.
"""

from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.drawing import MOST_BLOCKS, UNITS, Drawing, Polygon
from extrados.model.geometry.polygons import following, signed_area

FLAT = 1e-6  # of the size of a block: how far its two faces may differ from a prism's
AXES = "xyz"
FARTHEST = 1e9  # of its unit from the origin: what solids of other files may have, too


def is_compas(value: Any) -> bool:
    """True for the JSON of a COMPAS assembly."""
    return isinstance(value, dict) and str(value.get("dtype", "")).endswith("/Assembly")


def read_compas(value: Any, name: str, unit: str | None = None) -> tuple[Drawing, float | None]:
    """The section of an assembly, and its depth [m] where all blocks have the same; COMPAS names no unit, metres unless
    one is given.

    The plane is xz or yz, or xy where all have a height in z alone: all blocks are prisms across it. Cuboids are prisms along
    every axis. They have one section only across an axis along which all share an interval: that axis is taken first. Supports
    become ground along their faces. NoView names the block that is no prism.
    """
    scale = UNITS[unit or "m"]
    nodes = nodes_of(value, name)
    if len(nodes) > MOST_BLOCKS:
        raise BadGeometry(f"{name}: this file has {len(nodes)} blocks; at most {MOST_BLOCKS} are allowed")
    meshes = {key: mesh_of(node, f"{name}: block {key}") for key, node in nodes.items()}
    lowest = np.max([xyz.min(axis=0) for xyz, _ in meshes.values()], axis=0)
    highest = np.min([xyz.max(axis=0) for xyz, _ in meshes.values()], axis=0)
    by_axis = {a: {key: section_of(*mesh, a) for key, mesh in meshes.items()} for a in (1, 0, 2)}
    across = [a for a in sorted(by_axis, key=lambda a: lowest[a] >= highest[a]) if None not in by_axis[a].values()]
    if not across:
        faults = {AXES[a]: next(key for key, one in found.items() if one is None) for a, found in by_axis.items()}
        told = ", ".join(f"block {key} along {a}" for a, key in faults.items())
        raise NoView(
            f"{name}: a plane section requires blocks that are prisms perpendicular to one plane, and these blocks are not ({told})",
            ("structure", "file"),
        )
    axis = across[0]
    blocks, ground, depths = [], [], []
    for key, found in by_axis[axis].items():
        assert found is not None
        outline, depth = scale * found[0], scale * found[1]
        depths.append(depth)
        if nodes[key].get("is_support"):
            ground.append(np.column_stack([outline, following(outline)]))
        else:
            blocks.append(Polygon(f"block {key}", outline))
    if not blocks:
        raise BadGeometry(f"{name}: all blocks are supports")
    one_depth = depths[0] if np.ptp(depths) < 1e-6 * max(depths) else None
    notes = [f"{name}: {len(blocks)} blocks and {len(ground)} supports, section across {AXES[axis]}"]
    if other := [AXES[a] for a in across[1:] if a != 2 and lowest[a] < highest[a]]:
        notes.append(
            f"{name}: the blocks are prisms along {other[0]} too. To use the section across {other[0]}, exchange x and y in the file"
        )
    if one_depth is None:
        notes.append(
            f"{name}: the blocks have depths of {min(depths):.4g} to {max(depths):.4g} m across the section; the value of "
            "`depth` is used for all of them"
        )
    return Drawing(blocks, np.concatenate(ground) if ground else None, notes=tuple(notes)), one_depth


def _inner(value: Any) -> Any:
    """What an object of COMPAS holds, with or without its wrapping (`data` since 1.0, `value` and `data` before)."""
    while isinstance(value, dict) and not ({"node", "vertex", "graph"} & set(value)):
        inner = value.get("data", value.get("value"))
        if not isinstance(inner, dict):
            return value
        value = inner
    return value


def nodes_of(value: Any, name: str) -> dict[str, dict[str, Any]]:
    """The nodes of an assembly by their keys; `name` is what complaints call the file."""
    inner = _inner(value)
    if isinstance(inner, dict) and "graph" in inner:
        inner = _inner(inner["graph"])
    nodes = inner.get("node") if isinstance(inner, dict) else None
    if not isinstance(nodes, dict) or not nodes or not all(isinstance(n, dict) for n in nodes.values()):
        raise BadGeometry(f"{name}: this assembly of COMPAS has no nodes")
    return dict(sorted(nodes.items(), key=lambda item: (len(item[0]), item[0])))


def mesh_of(node: dict[str, Any], where: str) -> tuple[np.ndarray, list[list[int]]]:
    """Vertices (n, 3) and the faces as indices of them."""
    mesh = _inner(node.get("block"))
    try:
        vertices = mesh["vertex"]
        order = {str(k): i for i, k in enumerate(vertices)}
        xyz = np.array([[float(v.get(a, 0.0)) for a in AXES] for v in vertices.values()])
        faces = [[order[str(k)] for k in face] for face in mesh["face"].values()]
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        raise BadGeometry(f"{where}: expected a mesh with the keys `vertex` and `face`") from None
    if xyz.ndim != 2 or len(xyz) < 6 or not (np.abs(xyz) <= FARTHEST).all():  # NaN too
        raise BadGeometry(
            f"{where}: the mesh has {len(xyz)} vertices; expected the vertices of a solid, with finite coordinates up to {FARTHEST:g}"
        )
    return xyz, faces


def section_of(xyz: np.ndarray, faces: list[list[int]], axis: int) -> tuple[np.ndarray, float] | None:
    """Outline (n, 2), counter-clockwise, and depth of a block that is a prism along an axis; None where it is none."""
    along = xyz[:, axis]
    size = float(np.ptp(xyz, axis=0).max())
    low, high = float(along.min()), float(along.max())
    front, back = np.abs(along - low) < FLAT * size, np.abs(along - high) < FLAT * size
    if high - low < FLAT * size or not (front | back).all() or front.sum() != back.sum():
        return None
    plane = [k for k in (0, 1, 2) if k != axis]
    one, two = (xyz[side][:, plane] for side in (front, back))
    if max(_apart(one, two), _apart(two, one)) > FLAT * size:
        return None
    edges = [(a, b) for f in faces if all(front[f]) for a, b in zip(f, f[1:] + f[:1], strict=True)]
    known = set(edges)
    rim = {a: b for a, b in edges if (b, a) not in known}  # several faces in front, as triangles, share inner edges
    if len(rim) < 3:
        return None
    start = next(iter(rim))
    way = [start]
    while (step := rim.get(way[-1])) is not None and step != start and len(way) <= len(rim):
        way.append(step)
    outline = xyz[way][:, plane]
    if len(way) != len(rim):
        return None
    return (outline if signed_area(outline) > 0.0 else outline[::-1]), high - low


def _apart(points: np.ndarray, others: np.ndarray) -> float:
    """How far that of the points (n, 2) is from the nearest of others that is farthest from them."""
    from scipy.spatial import cKDTree  # takes a third of a second to load

    return float(cKDTree(others).query(points)[0].max())
