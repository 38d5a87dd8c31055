"""Upright rectangles that touch each other: openings of walls, units in courses, macro-blocks."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence

import numpy as np

from extrados.model.geometry.assembly import GROUND

SAME = 1e-6  # of a length that says what is small: edges nearer than this are one
Box = tuple[float, float, float, float]  # x from, x to, y from, y to [m]


def openings_within(length: float, height: float, openings: Sequence[Box], size: float) -> list[Box]:
    """The openings within a wall from the origin; edges nearer to each other or the wall's than SAME `size` are one."""
    xs, ys = [0.0, length], [0.0, height]

    def same(value: float, known: list[float]) -> float:
        value = min(max(value, known[0]), known[1])
        for other in known:
            if abs(value - other) < SAME * size:
                return other
        known.append(value)
        return value

    return [(same(left, xs), same(right, xs), same(low, ys), same(high, ys)) for left, right, low, high in openings]


def outline(box: Box) -> np.ndarray:
    """Vertices (4, 2) [m], counter-clockwise."""
    left, right, low, high = box
    return np.array([[left, low], [right, low], [right, high], [left, high]])


def contacts(boxes: Sequence[Box], size: float) -> list[tuple[int, int, np.ndarray, np.ndarray]]:
    """Where boxes touch: (box, box to its left or below or GROUND at y = 0, p, q), box by box, the left side first.

    Their edges must be the same numbers; stretches below SAME `size` [m] are no joints.
    """
    ends: dict[float, list[tuple[float, int]]] = {}
    tops: dict[float, list[tuple[float, int]]] = {}
    for i, (left, right, low, high) in enumerate(boxes):
        ends.setdefault(right, []).append((low, i))
        tops.setdefault(high, []).append((left, i))
    for line in (*ends.values(), *tops.values()):
        line.sort()

    def touching(line: list[tuple[float, int]], low: float, high: float, axis: int) -> list[tuple[int, float, float]]:
        """Boxes along a line that share some of low..high, and what they share."""
        start = max(0, bisect_right(line, (low, len(boxes))) - 1)
        shared = [(i, max(low, boxes[i][axis]), min(high, boxes[i][axis + 1])) for _, i in line[start : bisect_left(line, (high, -1))]]
        return [(i, one, two) for i, one, two in shared if two - one > SAME * size]

    found = []
    for i, (left, right, low, high) in enumerate(boxes):
        for k, one, two in touching(ends.get(left, []), low, high, 2):
            found.append((i, k, np.array([left, one]), np.array([left, two])))
        if low == 0.0:
            found.append((i, GROUND, np.array([left, low]), np.array([right, low])))
        for k, one, two in touching(tops.get(low, []), left, right, 0):
            found.append((i, k, np.array([one, low]), np.array([two, low])))
    return found
