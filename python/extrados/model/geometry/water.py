"""Pressure of still water on the blocks of a plane section: on the faces that it reaches, and in joints below its level."""

import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.schema.constants import GRAVITY

#: Of the size of the section: what lies nearer than this lies on a line
NEAR = 1e-6
#: Of a horizontal chord of the section: widest opening in it
OPENING = 0.01
#: Points whose horizontal lines are followed at once
CHUNK = 400
#: Gauss points of a piece: exact for the pressure on a face, and for linear uplift in horizontal joints and between vertical faces
GAUSS = np.polynomial.legendre.leggauss(4)

Uplift = Literal["none", "linear", "full"]


@dataclass(frozen=True)
class Pressure:
    """A pressure as forces (n, 2) [N] at points (n, 2) [m] of areas (n) [m^2] on blocks (n)."""

    block: np.ndarray
    point: np.ndarray
    force: np.ndarray
    area: np.ndarray

    def about_origin(self, count: int) -> np.ndarray:
        """Force [N] and moment about the origin [N m] on each of `count` blocks (count, 3)."""
        found = np.zeros((count, 3))
        np.add.at(found, self.block, np.column_stack([self.force, _moment(self.point, self.force)]))
        return found

    def on_bodies(self, body_of_block: np.ndarray, centroid: np.ndarray) -> np.ndarray:
        """Constant loads (bodies, 4) [N, N, N m, N m] of bodies that consist of blocks, as core.dem.Bodies has them; centroid
        (bodies, 2) [m]."""
        found = np.zeros((len(centroid), 4))
        body = body_of_block[self.block]
        arm = self.point - centroid[body]
        np.add.at(found, body, np.column_stack([self.force, _moment(arm, self.force), (arm * self.force).sum(axis=1)]))
        return found

    def on_solids(self, centroid: np.ndarray) -> np.ndarray:
        """Constant loads (blocks, 4, 3) of blocks drawn out along y, as core.dem3.Solids has them; centroid (blocks, 3) [m]."""
        force = np.insert(self.force, 1, 0.0, axis=1)
        # by symmetry the resultant acts at half the depth
        arm = np.insert(self.point - centroid[self.block][:, [0, 2]], 1, 0.0, axis=1)
        found = np.zeros((len(centroid), 4, 3))
        np.add.at(found, self.block, np.concatenate([force[:, None], arm[:, :, None] * force[:, None]], axis=1))
        return found


@dataclass(frozen=True)
class _Outlines:
    """Edges of all blocks (n, 2) [m] from start to end, with their blocks. x is measured from the water: sense -1 for water to the
    right."""

    start: np.ndarray
    end: np.ndarray
    block: np.ndarray
    near: float
    sense: float

    def lines(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where horizontal lines (n) [m] cross the edges: (n, edges) [m], NaN where they do not; +1 where a line leaves a block."""
        low, high = self.start[:, 1], self.end[:, 1]
        crosses = (low <= y[:, None]) != (high <= y[:, None])
        share = np.divide(y[:, None] - low, high - low, out=np.zeros_like(crosses, dtype=float), where=crosses)
        x = self.sense * (self.start[:, 0] + share * (self.end[:, 0] - self.start[:, 0]))
        return np.where(crosses, x, np.nan), self.sense * np.where(high > low, 1.0, -1.0)

    def wet(self, point: np.ndarray) -> np.ndarray:
        """Whether horizontal lines from points (n, 2) [m] towards the water cross no edge."""
        found = np.ones(len(point), dtype=bool)
        for k in range(0, len(point), CHUNK):
            x, _ = self.lines(point[k : k + CHUNK, 1])
            with np.errstate(invalid="ignore"):
                found[k : k + CHUNK] = ~(x < self.sense * point[k : k + CHUNK, :1]).any(axis=1)
        return found

    def chords(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and last face of the section along horizontal lines (n) [m] just above and just below a height, where both are
        nearest; BadGeometry where an opening lies between them."""
        first, last = np.full(len(y), -np.inf), np.full(len(y), np.inf)
        for k in range(0, len(y), CHUNK):
            for beside in (-self.near, self.near):
                x, leaves = self.lines(y[k : k + CHUNK] + beside)
                there = np.isfinite(x).any(axis=1)
                left = np.where(there, np.nanmin(np.where(there[:, None], x, 0.0), axis=1), -np.inf)
                right = np.where(there, np.nanmax(np.where(there[:, None], x, 0.0), axis=1), np.inf)
                filled = np.nansum(x * leaves, axis=1)
                with np.errstate(invalid="ignore"):
                    open_at = there & (right - left - filled > OPENING * (right - left))
                if open_at.any():
                    raise BadGeometry(
                        f'uplift = "linear" requires a section without openings below the water, but at a height of '
                        f'{y[k + int(open_at.argmax())]:.3g} m the section has an opening: give uplift = "full" or "none"'
                    )
                first[k : k + CHUNK] = np.maximum(first[k : k + CHUNK], left)
                last[k : k + CHUNK] = np.minimum(last[k : k + CHUNK], right)
        return first, last


def water_pressure(assembly: Assembly, level: float, side: Literal["left", "right"], uplift: Uplift, density: float) -> Pressure:
    """Pressure of still water [kg/m^3] up to a level [m] on one side of a section.

    A face is wet below the level where a horizontal line from it to that side meets no block. In joints below the level the
    pressure is that of the water (full), or decreases linearly along horizontal lines from the wet face to nothing at the other face of
    the section (linear). BadGeometry where a section with openings has linear uplift.
    """
    outlines = _outlines(assembly, 1.0 if side == "left" else -1.0)
    unit = density * GRAVITY
    heights = np.unique(np.round(outlines.start[:, 1] / outlines.near)) * outlines.near
    heights = np.append(heights[heights < level], level)
    block, start, end = _wet_faces(assembly, outlines, heights)
    found = [_pressed(block, start, end, np.ones(len(block)), unit, level, assembly.depth, None)]
    if uplift != "none":
        within = outlines if uplift == "linear" else None
        j, start, end = _pieces(np.arange(len(assembly.a)), assembly.p, assembly.q, heights, 2.0 * outlines.near)
        left = np.column_stack([-assembly.tangent[:, 1], assembly.tangent[:, 0]])
        into_a = np.sign((left * assembly.normal).sum(axis=1))[j]
        for blocks, inward in ((assembly.a[j], into_a), (assembly.b[j], -into_a)):
            on = blocks != GROUND
            found.append(_pressed(blocks[on], start[on], end[on], inward[on], unit, level, assembly.depth, within))
    return Pressure(*(np.concatenate([getattr(one, name) for one in found]) for name in ("block", "point", "force", "area")))


def _outlines(assembly: Assembly, sense: float) -> _Outlines:
    outlines = [np.asarray(one, dtype=float) for one in assembly.outlines]
    start, end = np.concatenate(outlines), np.concatenate([np.roll(one, -1, axis=0) for one in outlines])
    block = np.repeat(np.arange(len(outlines)), [len(one) for one in outlines])
    return _Outlines(start, end, block, NEAR * float(np.ptp(start, axis=0).max()), sense)


def _wet_faces(assembly: Assembly, outlines: _Outlines, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Blocks (n) and ends (n, 2) [m] of the pieces of faces that water reaches, up to the last of the heights [m]."""
    small = max(assembly.tolerance, outlines.near)
    block, start, end = [], [], []
    low = np.minimum(outlines.start[:, 1], outlines.end[:, 1])
    length = np.hypot(*(outlines.end - outlines.start).T)
    for k in np.flatnonzero((low < heights[-1]) & (length > 0.0)).tolist():
        i, origin, tangent = outlines.block[k], outlines.start[k], (outlines.end[k] - outlines.start[k]) / length[k]
        joints = assembly.joints_of(int(i))
        ends = np.stack([assembly.p[joints], assembly.q[joints]], axis=1) - origin
        within = (np.abs(ends[..., 0] * tangent[1] - ends[..., 1] * tangent[0]) <= small).all(axis=1)
        closed = np.sort(ends[within] @ tangent, axis=1)
        at = 0.0
        for low_end, high_end in [*closed[np.argsort(closed[:, 0])].tolist(), (length[k], length[k])]:
            if min(low_end, length[k]) > at + small:
                block.append(i)
                start.append(origin + at * tangent)
                end.append(origin + min(low_end, length[k]) * tangent)
            at = max(at, high_end)
    of, first, last = _pieces(
        np.array(block, dtype=int), np.reshape(start, (-1, 2)), np.reshape(end, (-1, 2)), heights, 2.0 * outlines.near
    )
    along = last - first
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    wet = outlines.wet(0.5 * (first + last) + 2.0 * small * outward)
    return of[wet], first[wet], last[wet]


def _pieces(
    of: np.ndarray, start: np.ndarray, end: np.ndarray, heights: np.ndarray, small: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Segments (n, 2) [m] cut at ascending heights [m], up to the last of them, with the numbers of what they belong to; no piece is
    lower than `small` [m]."""
    numbers, first, last = [], [], []
    for k, (a, b) in enumerate(zip(start, end, strict=True)):
        rise = b[1] - a[1]
        inner = heights[(heights > min(a[1], b[1]) + small) & (heights < max(a[1], b[1]) - small)]
        shares = np.sort(np.concatenate([[0.0], (inner - a[1]) / rise if len(inner) else inner, [1.0]]))
        for low, high in itertools.pairwise(shares):
            if a[1] + 0.5 * (low + high) * rise < heights[-1]:
                numbers.append(of[k])
                first.append(a + low * (b - a))
                last.append(a + high * (b - a))
    return np.array(numbers, dtype=int), np.reshape(first, (-1, 2)), np.reshape(last, (-1, 2))


def _pressed(
    block: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    inward: np.ndarray,
    unit: float,
    level: float,
    depth: float,
    within: _Outlines | None,
) -> Pressure:
    """Pressure `unit` [Pa per m of water] on segments (n, 2) [m]. inward (n): +1 where the block is to their left, -1 to
    their right. within: outlines through which the pressure decreases to nothing; None where it does not."""
    along = end - start
    push = np.column_stack([-along[:, 1], along[:, 0]]) * inward[:, None]
    points, forces, areas = [], [], []
    for place, weight in zip(*GAUSS, strict=True):
        at = start + 0.5 * (1.0 + place) * along
        pressure = unit * depth * np.maximum(level - at[:, 1], 0.0)
        if within is not None:
            first, last = within.chords(at[:, 1])
            pressure = pressure * np.clip((last - within.sense * at[:, 0]) / (last - first), 0.0, 1.0)
        points.append(at)
        forces.append(0.5 * weight * pressure[:, None] * push)
        areas.append(0.5 * weight * depth * np.hypot(*along.T))
    return Pressure(np.tile(block, len(points)), *(np.concatenate(found) for found in (points, forces, areas)))


def _moment(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Moments (n) [N m] of forces (n, 2) [N] at arms (n, 2) [m]."""
    found: np.ndarray = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    return found
