"""Files of meshes that are sections: faces drawn in one plane, or prisms across it."""

import re
from collections.abc import Sequence

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.compas import FLAT, section_of
from extrados.model.geometry.drawing import UNITS, Drawing, Plane, Polygon
from extrados.model.geometry.solids.meshes import Mesh

UNNAMED = re.compile(r"block \d+")


def flat_plane(meshes: Sequence[Mesh]) -> Plane | None:
    """The plane in which all points of some meshes lie; None for solids."""
    extent = np.ptp(np.concatenate([mesh.points for mesh in meshes]), axis=0)
    flat = extent <= FLAT * extent.max()
    planes: tuple[Plane, ...] = ("yz", "xz", "xy")
    return next((plane for plane, is_flat in zip(planes, flat.tolist(), strict=True) if is_flat), None)


def section_of_meshes(meshes: Sequence[Mesh], plane: Plane, unit: str | None, name: str) -> tuple[Drawing, float | None]:
    """The section of meshes in a plane, whose second axis is vertical, and its depth [m] where all blocks are prisms of one.

    A mesh in the plane is a block with the outline of its faces; of a file without names each face is a block. BadGeometry names meshes
    that are neither that nor prisms across the plane.
    """
    scale, axes = UNITS[unit or "m"], ["xyz".index(letter) for letter in plane]
    (across,) = {0, 1, 2} - set(axes)
    if flat_plane(meshes) is not None:
        blocks: list[Polygon] = []
        for mesh in meshes:
            pieces = [[face] for face in mesh.faces] if UNNAMED.fullmatch(mesh.stone) else [mesh.faces]
            for face in pieces:
                title = mesh.stone if len(pieces) == 1 else f"block {len(blocks) + 1}"
                blocks.append(Polygon(title, scale * mesh.points[_rim(face, f"{name}: {title}")][:, axes]))
        return Drawing(blocks, notes=(f"{name}: {len(blocks)} blocks, drawn in the plane {plane}",)), None
    found = {mesh.stone: section_of(mesh.points, mesh.faces, across) for mesh in meshes}
    if wrong := [title for title, one in found.items() if one is None]:
        raise BadGeometry(
            f"{name}: these blocks are not prisms perpendicular to the plane {plane}: {', '.join(wrong[:6])}{(' and others' if len(wrong) > 6 else '')}. "
            "Give another plane as `section`, or give `direction` to analyse solids",
            ("structure", "section"),
        )
    prisms = [(title, scale * one[0], scale * one[1]) for title, one in found.items() if one is not None]
    depths = [depth for _, _, depth in prisms]
    notes = [f"{name}: {len(prisms)} prisms, section in the plane {plane}"]
    if len(prisms) < len(meshes):
        raise BadGeometry(
            f"{name}: a block of a section must be a single prism, but one block consists of several bodies", ("structure", "section")
        )
    one_depth = depths[0] if np.ptp(depths) < 1e-6 * max(depths) else None
    if one_depth is None:
        notes.append(
            f"{name}: the blocks have depths of {min(depths):.4g} to {max(depths):.4g} m across the section; the value of "
            "`depth` is used for all of them"
        )
    return Drawing([Polygon(title, outline) for title, outline, _ in prisms], notes=tuple(notes)), one_depth


def _rim(faces: Sequence[Sequence[int]], where: str) -> list[int]:
    """The outline of faces of one plane, as numbers of points; BadGeometry where it is not one ring."""
    edges = [edge for face in faces for edge in zip(face, [*face[1:], face[0]], strict=True)]
    directed = set(edges)
    inner = {frozenset(edge) for edge in edges if (edge[1], edge[0]) in directed}
    rim = {a: b for a, b in edges if frozenset((a, b)) not in inner}
    ring = [next(iter(rim), -1)]
    while (step := rim.get(ring[-1])) is not None and step != ring[0] and len(ring) <= len(rim):
        ring.append(step)
    if len(ring) != len(rim) or len(ring) < 3:
        raise BadGeometry(f"{where}: the faces do not have one outline; draw each block as one face or as faces that share edges")
    return ring
