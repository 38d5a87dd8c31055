"""Fill and surfacing over stones: the line of the stones' tops, what rests on each, and what soil it is."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

BESIDE = -1  # a piece of the line that lies beside the stones
FINEST = 400  # pieces of the line over its length, at least


@dataclass(frozen=True)
class Skyline:
    """The highest faces of stones from left to right: straight stretches between start and end (k, 2) [m], each the
    top of a `block` (k)."""

    start: np.ndarray
    end: np.ndarray
    block: np.ndarray


def skyline(outlines: Sequence[np.ndarray]) -> Skyline:
    """The line along which rain would fall on stones of counter-clockwise outlines that do not overlap."""
    first = np.concatenate(outlines)
    last = np.concatenate([np.roll(o, -1, axis=0) for o in outlines])
    owner = np.repeat(np.arange(len(outlines)), [len(o) for o in outlines])
    size = float(np.ptp(first[:, 0]))
    tops = first[:, 0] - last[:, 0] > 1e-9 * size  # counter-clockwise: tops run from right to left
    right, left, owner = first[tops], last[tops], owner[tops]
    x = np.unique(np.round(np.concatenate([left[:, 0], right[:, 0]]) / size, 12)) * size
    middle = 0.5 * (x[:-1] + x[1:])
    slope = (right[:, 1] - left[:, 1]) / (right[:, 0] - left[:, 0])
    covers = (left[:, 0] <= middle[:, None]) & (middle[:, None] <= right[:, 0])
    height = np.where(covers, left[:, 1] + slope * (middle[:, None] - left[:, 0]), -np.inf)
    top = height.argmax(axis=1)
    there = covers.any(axis=1)
    top, a, b = top[there], x[:-1][there], x[1:][there]

    def at(place: np.ndarray) -> np.ndarray:
        return np.column_stack([place, left[top, 1] + slope[top] * (place - left[top, 0])])

    return Skyline(at(a), at(b), owner[top])


@dataclass(frozen=True)
class Earth:
    """Fill up to a level `formation` [m] and surfacing of a thickness on it, over a line of stones.

    density of both [kg/m^3]; friction_angle [deg] and cohesion [Pa] of the fill; passive: the share of its passive
    pressure that resists; dispersal of loads to the stones: by Boussinesq's stresses within `angle` [deg] of the
    vertical, or evenly within it.
    """

    line: Skyline
    formation: float
    density: float
    surfacing: float
    surfacing_density: float
    friction_angle: float
    cohesion: float
    passive: float
    dispersal: Literal["boussinesq", "even"]
    angle: float

    @property
    def road(self) -> float:
        """Level at which loads stand [m]."""
        return self.formation + self.surfacing

    @property
    def passive_coefficient(self) -> float:
        """Rankine's K_p = (1 + sin phi) / (1 - sin phi)."""
        sine = np.sin(np.radians(self.friction_angle))
        return float((1.0 + sine) / (1.0 - sine))

    def masses(self, count: int, depth: float) -> tuple[np.ndarray, np.ndarray]:
        """Fill and surfacing on each of `count` blocks: mass [kg] and centroid x, y [m], (count, 3) each.

        The fill on a block is the column above its tops.
        """
        x0, y0 = self.line.start.T
        x1, y1 = self.line.end.T
        fill = _columns(self.line.block, count, x0, x1, y0, y1, np.full(len(x0), self.formation))
        level = np.full(len(x0), self.formation)
        paved = _columns(self.line.block, count, x0, x1, level, level, np.full(len(x0), self.road))
        fill[:, 0] *= self.density * depth
        paved[:, 0] *= self.surfacing_density * depth
        return fill, paved

    @cached_property
    def pieces(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Fine pieces of the line for spreading loads: x of both ends, cover above the middle [m], block.

        Beside the stones the line goes on level as far as a load within it can spread.
        """
        line = self.line
        low, high = float(line.start[0, 0]), float(line.end[-1, 0])
        cover = self.road - min(line.start[0, 1], line.end[-1, 1])
        away = (high - low) + 2.0 * cover * np.tan(np.radians(self.angle)) + 2.0
        start = np.concatenate([[[low - away, line.start[0, 1]]], line.start, [[high, line.end[-1, 1]]]])
        end = np.concatenate([[[low, line.start[0, 1]]], line.end, [[high + away, line.end[-1, 1]]]])
        block = np.concatenate([[BESIDE], line.block, [BESIDE]])
        parts = np.maximum(np.ceil((end - start)[:, 0] / ((high - low) / FINEST)).astype(int), 1)
        of = np.repeat(np.arange(len(parts)), parts)
        k = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
        one, two = k / parts[of], (k + 1) / parts[of]
        x0 = start[of, 0] + one * (end - start)[of, 0]
        x1 = start[of, 0] + two * (end - start)[of, 0]
        y = start[of, 1] + 0.5 * (one + two) * (end - start)[of, 1]
        return x0, x1, np.maximum(self.road - y, 0.0), block[of]


def passive_left_out(earth: Earth | None) -> list[str]:
    """The warning of strategies that know the weight of fill, but not what it resists."""
    if earth is None or earth.passive <= 0.0:
        return []
    return [
        (
            "the fill acts only by its weight and moves with the blocks; this analysis neglects its passive "
            "pressure, which limit analysis includes"
        )
    ]


def _columns(block: np.ndarray, count: int, x0: np.ndarray, x1: np.ndarray, y0: np.ndarray, y1: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Area and centroid (count, 3) of the columns from sloping feet up to level tops, those on one block together."""
    width, h0, h1 = x1 - x0, np.maximum(top - y0, 0.0), np.maximum(top - y1, 0.0)
    area = 0.5 * width * (h0 + h1)
    total = np.maximum(h0 + h1, 1e-300)
    x = x0 + width * (h0 + 2.0 * h1) / (3.0 * total)
    y = top - (h0**2 + h0 * h1 + h1**2) / (3.0 * total)
    sums = np.stack([np.bincount(block, value, count) for value in (area, area * x, area * y)], axis=1)
    out = np.zeros((count, 3))
    laden = sums[:, 0] > 0.0
    out[:, 0] = sums[:, 0]
    out[laden, 1:] = sums[laden, 1:] / sums[laden, :1]
    return out
