"""Measured blocks made to fit, in the plane and in space: faces in contact get one plane, and corners move onto the planes of their faces."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

Face = tuple[int, int]  # part, and its face
#: Singular values of the planes at a corner, over the greatest, below which it does not move along: planes that cross at less than 11
#: degrees would throw it far
SHALLOW = 0.1


class Body(Protocol):
    """A body of d dimensions: vertices (n, d) [m], faces as numbers of vertices; outward normals (nf, d), areas and middles of faces."""

    @property
    def vertices(self) -> np.ndarray: ...
    @property
    def faces(self) -> tuple[tuple[int, ...], ...]: ...
    @property
    def normals(self) -> np.ndarray: ...
    @property
    def areas(self) -> np.ndarray: ...
    @property
    def middles(self) -> np.ndarray: ...


def snapped(
    parts: Sequence[Body], contacts: Sequence[tuple[Face, Face]], levels: Mapping[Face, float], tolerance: float, *, midway: bool = False
) -> tuple[list[np.ndarray], float]:
    """Vertices (n, d) [m] of the parts on the planes of their faces, and the farthest way that a corner moved [m], at most the tolerance.

    contacts: faces that get one plane where all of their corners lie within half the tolerance of it, in this order.
    levels: heights [m] of the faces that stand on level ground. What is drawn without noise stays to the last bit.
    midway: the plane lies in the middle between the faces of either side, not in that of all corners.
    """
    planes = _planes(parts, contacts, levels, 0.5 * tolerance, midway)
    found, farthest = [], 0.0
    for i, part in enumerate(parts):
        at: list[list[int]] = [[] for _ in part.vertices]
        for k, face in enumerate(part.faces):
            for corner in face:
                at[corner].append(k)
        normals = np.zeros((len(at), max(map(len, at)), part.vertices.shape[1]))
        short = np.zeros(normals.shape[:2])
        for corner, faces in enumerate(at):
            for row, k in enumerate(faces):
                normal, middle = planes[i, k]
                normals[corner, row], short[corner, row] = normal, normal @ (middle - part.vertices[corner])
        way = (np.linalg.pinv(normals, rcond=SHALLOW) @ short[:, :, None])[:, :, 0]
        length = np.linalg.norm(way, axis=1)
        way[length > tolerance] = 0.0
        farthest = max(farthest, float(length[length <= tolerance].max(initial=0.0)))
        found.append(part.vertices + way)
    return found, farthest


def _planes(
    parts: Sequence[Body], contacts: Sequence[tuple[Face, Face]], levels: Mapping[Face, float], within: float, midway: bool
) -> dict[Face, tuple[np.ndarray, np.ndarray]]:
    """Normal and a point [m] of the plane of each face. Faces together: the sums of Newell's vectors, and of their middles by area."""
    group = {(i, k): (i, k) for i, part in enumerate(parts) for k in range(len(part.faces))}
    members: dict[Face, list[tuple[Face, float]]] = {face: [(face, 1.0)] for face in group}  # and which way they look

    def plane(those: Sequence[tuple[Face, float]]) -> tuple[np.ndarray, np.ndarray] | None:
        """The plane of some faces; None where ground at unlike heights would have to be one."""
        area = np.array([parts[i].areas[k] for (i, k), _ in those])
        sense = np.array([s for _, s in those])
        normal = sum(a * s * parts[i].normals[k] for a, ((i, k), s) in zip(area, those, strict=True))
        normal = normal / np.linalg.norm(normal)
        middles = np.array([parts[i].middles[k] for (i, k), _ in those])
        middle = (area[:, None] * middles).sum(axis=0) / area.sum()
        heights = {levels[face] for face, _ in those if face in levels}
        if len(heights) > 1:
            return None
        if heights:
            return np.eye(len(middle))[-1], np.array([*middle[:-1], heights.pop()])
        if midway and np.ptp(sense) > 0.0:
            sides = [np.average(middles[sense == s] @ normal, weights=area[sense == s]) for s in (1.0, -1.0)]
            middle = middle + (0.5 * sum(sides) - middle @ normal) * normal
        return normal, middle

    for one, two in contacts:
        a, b = group[one], group[two]
        if a == b:
            continue
        sense = dict(members[a])[one] * dict(members[b])[two]
        both = [*members[a], *((face, -sense * s) for face, s in members[b])]
        of_both = plane(both)
        if of_both is None:
            continue
        corners = np.concatenate([parts[i].vertices[list(parts[i].faces[k])] for (i, k), _ in both])
        if np.abs((corners - of_both[1]) @ of_both[0]).max() > within:
            continue
        for face, _ in members.pop(b):
            group[face] = a
        members[a] = both
    found = {}
    for those in members.values():
        of_these = plane(those)
        assert of_these is not None
        for face, _ in those:
            found[face] = of_these
    return found
