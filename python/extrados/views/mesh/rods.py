"""Bars in a finite-element mesh: where a point lies in an element, and the strain of a bar by the nodes around it."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import inside
from extrados.model.ties import Tie
from extrados.views.blocks import Masonry
from extrados.views.mesh.mesh import Mesh

HAIR = 1e-6  # of an element: so near to its sides a point lies in it
LEAST = 1e-9  # of a bar: shorter pieces are rounding


@dataclass(frozen=True)
class Rod:
    """Pieces of one bar: connect (pieces, nodes) 0-based; gradient (pieces, nodes, 2), strain per displacement [1/m];
    length (pieces) [m]; place (pieces) of their middles, from its start [m]."""

    connect: np.ndarray
    gradient: np.ndarray
    length: np.ndarray
    place: np.ndarray


@dataclass(frozen=True)
class Corners:
    """The elements of a mesh by their corners: connect (elements, 4), of triangles the last stands twice."""

    xy: np.ndarray
    connect: np.ndarray

    @staticmethod
    def of(mesh: Mesh) -> "Corners":
        """The corners of all elements of a mesh but interfaces."""
        found = []
        for group in mesh.groups:
            if group.joint is None:
                corners = 3 if group.kind.startswith("T") else 4
                found.append(group.connect[:, [*range(corners), *([2] * (4 - corners))]])
        return Corners(mesh.xy, np.concatenate(found))

    @property
    def middle(self) -> np.ndarray:
        """Where the natural coordinates are zero."""
        return self.xy[self.connect].mean(axis=1)

    def at(self, point: np.ndarray, among: np.ndarray) -> tuple[int, np.ndarray | None]:
        """Of some elements the one that holds a point, and the natural coordinates there; else the nearest, and None."""
        near = among[np.argsort(np.hypot(*(self.middle[among] - point).T), kind="stable")]
        for e in near[:40].tolist():
            natural = self.natural(e, point)
            if natural is not None and (np.abs(natural) <= 1.0 + HAIR).all():
                return e, natural
        return int(near[0]), None

    def shares(self, point: np.ndarray, among: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (4) and their shares (4) in the displacement of a point; outside of all elements it moves on as the
        nearest one does in its middle."""
        e, natural = self.at(point, among)
        if natural is not None:
            return self.connect[e], _shapes(natural)[0]
        return self.connect[e], 0.25 + self.slopes(e, np.zeros(2)) @ (point - self.middle[e])

    def natural(self, element: int, point: np.ndarray) -> np.ndarray | None:
        """Natural coordinates of a point by Newton's method; None where they do not exist."""
        corner, where = self.xy[self.connect[element]], np.zeros(2)
        for _ in range(30):
            value, slope = _shapes(where)
            jacobian = slope @ corner
            if not abs(np.linalg.det(jacobian)) > 0.0:
                where = where * 0.999
                continue
            step = (point - value @ corner) @ np.linalg.inv(jacobian)
            where = where + step
            if np.abs(step).max() < 1e-12:
                return where
            if np.abs(where).max() > 100.0:
                return None
        return where if np.abs(step).max() < 1e-9 else None

    def slopes(self, element: int, natural: np.ndarray) -> np.ndarray:
        """Gradients (4, 2) of the shape functions in x and y [1/m]."""
        _, slope = _shapes(natural)
        return np.linalg.solve(slope @ self.xy[self.connect[element]], slope).T


def _shapes(natural: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bilinear shape functions (4) and their slopes (2, 4)."""
    r, s = natural
    value = 0.25 * np.array([(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)])
    slope = 0.25 * np.array([[s - 1, 1 - s, 1 + s, -1 - s], [r - 1, -1 - r, 1 + r, 1 - r]])
    return value, slope


def anchored(corners: Corners, ends: np.ndarray, among: list[np.ndarray | None]) -> Rod:
    """A bar held at its ends alone, each by the corners of the element it is in; None for an end in the ground."""
    along = ends[1] - ends[0]
    length = float(np.hypot(*along))
    nodes, gradient = [], []
    for sign, end, elements in zip((-1.0, 1.0), ends, among, strict=True):
        if elements is None:
            continue
        node, share = corners.shares(end, elements)
        nodes.append(node)
        gradient.append(sign * share[:, None] * along / length**2)
    return Rod(np.concatenate(nodes)[None], np.concatenate(gradient)[None], np.array([length]), np.array([0.5 * length]))


def bonded(corners: Corners, ends: np.ndarray, what: str) -> Rod:
    """A bar that moves with what it runs through: a piece in every element that it crosses, strained as that is in the
    middle of the piece (embedded reinforcement)."""
    along = ends[1] - ends[0]
    length = float(np.hypot(*along))
    box = corners.xy[corners.connect]
    near = ((box.max(axis=1) >= ends.min(axis=0)) & (box.min(axis=1) <= ends.max(axis=0))).all(axis=1)
    cuts = {0.0, 1.0}
    for corner in box[near]:
        for p, q in zip(corner, np.roll(corner, -1, axis=0), strict=True):
            side = q - p
            turn = along[0] * side[1] - along[1] * side[0]
            if abs(turn) <= 1e-12 * length * np.hypot(*side):
                continue
            off = p - ends[0]
            t, u = (off[0] * side[1] - off[1] * side[0]) / turn, (off[0] * along[1] - off[1] * along[0]) / turn
            if -HAIR <= u <= 1.0 + HAIR and 0.0 < t < 1.0:
                cuts.add(float(t))
    places = np.array(sorted(cuts))
    places = places[np.concatenate([[True], np.diff(places) > LEAST])]
    among = np.flatnonzero(near)
    nodes, gradient, lengths, middles = [], [], [], []
    unit = along / length
    for start, end in pairwise(places):
        middle = ends[0] + 0.5 * (start + end) * along
        e, natural = corners.at(middle, among) if len(among) else (0, None)
        if natural is None:
            continue  # an opening
        nodes.append(corners.connect[e])
        gradient.append((corners.slopes(e, natural) @ unit)[:, None] * unit)
        lengths.append((end - start) * length)
        middles.append(0.5 * (start + end) * length)
    if not nodes:
        raise BadGeometry(f"{what} runs through no element")
    return Rod(np.array(nodes), np.array(gradient), np.array(lengths), np.array(middles))


def add_rods(building: Masonry, mesh: Mesh) -> Mesh:
    """The mesh with the [[ties]] of its building as bars."""
    corners = Corners.of(mesh)
    everywhere = np.arange(len(corners.connect))
    stones = building.anchored().block if mesh.has_joints else np.zeros((len(building.ties), 2), dtype=int)
    found: list[tuple[Tie, Rod]] = []
    for tie, blocks in zip(building.ties, stones.tolist(), strict=True):
        among: list[np.ndarray | None] = []
        for block, grounded in zip(blocks, (False, tie.ground is not None), strict=True):
            elements = everywhere
            if mesh.has_joints and not grounded:
                elements = np.flatnonzero(inside(building.blocks().outlines[block], corners.middle))
            among.append(None if grounded else elements)
        found.append((tie, anchored(corners, np.array(tie.flat(), dtype=float), among)))
    return replace(mesh, rods=found)
