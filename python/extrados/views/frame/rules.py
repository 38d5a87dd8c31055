"""Deformable heights of piers between openings: the rules of Dolce (1991) and of Lagomarsino and others (2013)."""

from dataclasses import dataclass

import numpy as np

#: Tangent of the greatest slope of the lines that join corners of openings
SLOPE = float(np.tan(np.radians(30.0)))


@dataclass(frozen=True)
class Side:
    """What stands beside a pier: an opening from sill to head [m] above the floor, or nothing (the end of the wall)."""

    sill: float | None = None
    head: float | None = None

    @property
    def free(self) -> bool:
        """Whether the wall ends there."""
        return self.sill is None


def deformable(rule: str, depth: float, storey: float, left: Side, right: Side) -> tuple[float, float]:
    """Foot above the floor and height [m] of the deformable part of a pier of a depth along the wall.

    dolce: h = h' + D (H - h')/(3 h'), at most H, about the middle of the quadrilateral whose lines join the corners of the
    openings, sloped by at most 30 degrees; toward a free end they rise and fall by 30 degrees, cut at the floors; h' is its
    mean height. lagomarsino: from the mean sill to the mean head, those of a free end at the floors.
    """
    if left.free and right.free:
        return 0.0, storey
    if rule == "lagomarsino":
        sill = 0.5 * ((left.sill or 0.0) + (right.sill or 0.0))
        head = 0.5 * sum(storey if side.head is None else side.head for side in (left, right))
        return sill, head - sill
    fall = depth * SLOPE
    if left.free or right.free:
        side = right if left.free else left
        assert side.sill is not None and side.head is not None
        sills, heads = (side.sill, max(0.0, side.sill - fall)), (side.head, min(storey, side.head + fall))
    else:
        assert left.sill is not None and right.sill is not None and left.head is not None and right.head is not None
        # Where the slope is capped, the line starts at the corner that makes the pier shorter
        sills = (max(left.sill, right.sill), max(min(left.sill, right.sill), max(left.sill, right.sill) - fall))
        heads = (min(left.head, right.head), min(max(left.head, right.head), min(left.head, right.head) + fall))
    sill, head = float(np.mean(sills)), float(np.mean(heads))
    mean = head - sill
    height = min(storey, mean + depth * (storey - mean) / (3.0 * mean))
    foot = 0.5 * (sill + head) - 0.5 * height
    return float(np.clip(foot, 0.0, storey - height)), height
