"""Joints drawn as gaps: the faces on either side move to the middle of the mortar, in the plane and in space."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.contacts import facing_edges
from extrados.model.geometry.polygons import crossing_edges, following, signed_area
from extrados.model.geometry.snapping import Body, Face, snapped

#: A corner moves by half a gap along each of its faces; by up to this many gaps where these meet at an acute angle
FARTHEST = 2.0


def closed(
    parts: Sequence[Body], faces: Sequence[tuple[Face, Face]], gaps: np.ndarray, mortar: float, tolerance: float
) -> list[np.ndarray]:
    """Vertices (n, d) [m] of bodies whose faces that look at each other across gaps meet in the middle of these, and otherwise keep
    their planes. faces: pairs of them, with their gaps [m] up to `mortar` and the tolerance; one face has one plane towards all of its neighbours."""
    order = np.argsort(gaps, kind="stable").tolist()
    return snapped(parts, [faces[k] for k in order], {}, FARTHEST * mortar + tolerance, midway=True)[0]


def told(gaps: np.ndarray, mortar: float, grown: float) -> tuple[str, ...]:
    """The note on gaps [m] that were closed; grown: volume or area of the blocks after over before."""
    if not len(gaps):
        return (f"`mortar_gap` {1000.0 * mortar:.3g} mm: no joint is drawn as a gap, so the key has no effect",)
    least, most = (f"{1e3 * gap:.3g}" for gap in (gaps.min(), gaps.max()))
    return (
        (
            f"{len(gaps)} joints that are drawn as gaps of {(most if least == most else f'{least} to {most}')} mm were closed "
            f"(`mortar_gap` {1000.0 * mortar:.3g} mm): the faces on both sides were moved to the middle of the mortar. The "
            f"volume of the blocks increased by {100.0 * (grown - 1.0):.3g} %; their density is unchanged"
        ),
    )


@dataclass(frozen=True)
class _Ring:
    """A counter-clockwise outline as a body of the plane; edges in one line are one face."""

    vertices: np.ndarray
    faces: tuple[tuple[int, ...], ...]

    @cached_property
    def _along(self) -> np.ndarray:
        return np.array([self.vertices[face[-1]] - self.vertices[face[0]] for face in self.faces])

    @cached_property
    def areas(self) -> np.ndarray:
        return np.hypot(*self._along.T)

    @cached_property
    def normals(self) -> np.ndarray:
        return np.column_stack([self._along[:, 1], -self._along[:, 0]]) / self.areas[:, None]

    @cached_property
    def middles(self) -> np.ndarray:
        return np.array([0.5 * (self.vertices[face[0]] + self.vertices[face[-1]]) for face in self.faces])


def closed_outlines(outlines: Sequence[np.ndarray], names: Sequence[str], mortar: float, tolerance: float) -> tuple[list[np.ndarray], str]:
    """Counter-clockwise outlines (n, 2) [m] whose edges across joints of mortar meet in the middle of these, and a note on the joints.

    mortar [m]: the widest gap that is a joint; tolerance [m]: gaps below it touch as drawn. BadGeometry names a block that the
    movement turns inside out.
    """
    rings, face_of = zip(*(_ring(outline, tolerance) for outline in outlines), strict=True)
    start = np.cumsum([0, *map(len, outlines)])
    one, two, gap = facing_edges(list(outlines), mortar + tolerance, tolerance)
    owner = np.repeat(np.arange(len(outlines)), np.diff(start))
    pairs: dict[tuple[Face, Face], float] = {}
    for e, f, apart in zip(one.tolist(), two.tolist(), gap.tolist(), strict=True):
        first, second = ((int(owner[k]), int(face_of[owner[k]][k - start[owner[k]]])) for k in (e, f))
        pairs[first, second] = max(apart, pairs.get((first, second), 0.0))
    gaps = np.array(list(pairs.values()))
    moved = closed(rings, list(pairs), gaps, mortar, tolerance)
    for name, outline in zip(names, moved, strict=True):
        if signed_area(outline) <= 0.0 or crossing_edges(outline) is not None:
            raise BadGeometry(
                f"block '{name}': closing joints of {1000.0 * mortar:.3g} mm gives an outline that crosses itself; reduce `mortar_gap`",
                ("structure", "mortar_gap"),
            )
    area = [sum(map(signed_area, those)) for those in (outlines, moved)]
    return moved, told(gaps[gaps > tolerance], mortar, area[1] / area[0])[0]


def _ring(outline: np.ndarray, tolerance: float) -> tuple[_Ring, np.ndarray]:
    """An outline as a body, and the face of each of its edges (n). Edges are in one line where they bend by less than a tolerance [m]."""
    along = following(outline) - outline
    length = np.hypot(*along.T)
    before = np.roll(along, 1, axis=0)
    short = np.minimum(length, np.roll(length, 1))
    bend = np.abs(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0]) / np.maximum(length * np.roll(length, 1), 1e-300) * short
    corner = np.flatnonzero((bend > tolerance) | ((before * along).sum(axis=1) < 0.0))
    if len(corner) < 3:
        corner = np.arange(len(outline))
    face_of = np.empty(len(outline), dtype=int)
    faces = []
    for k, (a, b) in enumerate(itertools.pairwise([*corner.tolist(), int(corner[0]) + len(outline)])):
        run = np.arange(a, b + 1) % len(outline)
        face_of[run[:-1]] = k
        faces.append(tuple(run.tolist()))
    return _Ring(outline, tuple(faces)), face_of
