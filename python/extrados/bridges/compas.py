"""Assemblies of COMPAS: the stones as meshes in the layout of compas.json_dump, which compas.json_load reads.

The ground is a thin support below every contact with it. extrados reads such a file back (`kind = "blocks"`, `file`).
"""

import json
import uuid
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from extrados.decks.reader import Deck
from extrados.model.errors import NoView
from extrados.model.geometry.solids.contacts import GROUND

THIN = 0.05  # of the size of the structure: thickness of the supports


def written(deck: Deck) -> str:
    """The JSON of an Assembly: a block for each stone, in space the closed shells of its convex parts in one mesh."""
    solids = deck.building.solids()
    nodes: dict[str, Any] = {}

    def add(vertices: np.ndarray, faces: Sequence[tuple[int, ...]], name: str, is_support: bool = False) -> None:
        nodes[str(len(nodes))] = _node(vertices, faces, name, is_support)

    for name, vertices, faces in bodies(deck):
        add(vertices, faces, name)
    for j in np.flatnonzero((solids.a == GROUND) | (solids.b == GROUND)):
        top, upward = solids.polygon[j], solids.normal[j]
        if solids.a[j] == GROUND:
            top, upward = top[::-1], -upward
        add(*_between(top, top - THIN * solids.size * upward), solids.joint_names[j], is_support=True)
    defaults = {"x": 0.0, "y": 0.0, "z": 0.0, "block": None, "is_support": False}
    graph = _object(
        "compas.datastructures/Graph",
        attributes={},
        default_node_attributes=defaults,
        default_edge_attributes={"interfaces": None},
        node=nodes,
        edge={key: {} for key in nodes},
        max_node=len(nodes) - 1,
    )
    title = deck.title or "extrados"
    return json.dumps(_object("compas_assembly.datastructures/Assembly", attributes={"name": title}, graph=graph)) + "\n"


def bodies(deck: Deck) -> Iterator[tuple[str, np.ndarray, list[tuple[int, ...]]]]:
    """Name, vertices (n, 3) [m] and faces, counter-clockwise from outside, of each stone: of a plane section drawn out to its
    depth; in space those of its convex parts, one closed shell after the other."""
    try:
        section = deck.building.blocks()
    except NoView:
        solids = deck.building.solids()
        for k, name in enumerate(solids.block_names):
            parts = [solids.parts[i] for i in np.flatnonzero(solids.owner == k)]
            first = np.cumsum([0, *(len(part.vertices) for part in parts)]).tolist()
            faces = [tuple(i + n for i in face) for part, n in zip(parts, first, strict=False) for face in part.faces]
            yield name, np.concatenate([part.vertices for part in parts]), faces
        return
    for name, outline in zip(section.block_names, section.outlines, strict=True):
        front, back = (np.insert(outline, 1, y, axis=1) for y in (-0.5 * section.depth, 0.5 * section.depth))
        yield name, *_between(front, back)


def _between(one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """Vertices and faces, counter-clockwise from outside, of the body between a polygon that is so seen from outside and its
    like (k, 3) [m] behind it."""
    n = len(one)
    sides = [(k, k + n, (k + 1) % n + n, (k + 1) % n) for k in range(n)]
    return np.concatenate([one, two]), [tuple(range(n)), tuple(reversed(range(n, 2 * n))), *sides]


def _node(vertices: np.ndarray, faces: Sequence[tuple[int, ...]], name: str, is_support: bool) -> dict[str, Any]:
    block = _object(
        "compas_assembly.datastructures/Block",
        attributes={"name": name},
        default_vertex_attributes=dict.fromkeys("xyz", 0.0),
        default_edge_attributes={},
        default_face_attributes={},
        vertex={str(k): dict(zip("xyz", xyz, strict=True)) for k, xyz in enumerate(vertices.tolist())},
        face={str(k): list(map(int, face)) for k, face in enumerate(faces)},
        facedata={str(k): {} for k in range(len(faces))},
        edgedata={},
        max_vertex=len(vertices) - 1,
        max_face=len(faces) - 1,
    )
    return {"block": block, "is_support": is_support, **dict(zip("xyz", vertices.mean(axis=0).tolist(), strict=True))}


def _object(dtype: str, **data: Any) -> dict[str, Any]:
    """An object of COMPAS; its identity follows from its content, so that the same deck gives the same file."""
    content = json.dumps(data, sort_keys=True)
    return {"dtype": dtype, "data": data, "inheritance": [], "guid": str(uuid.uuid5(uuid.NAMESPACE_OID, dtype + content))}
