"""Ties in limit analysis: rigid until they yield, they carry anything up to their yield force in the senses they work in."""

from collections.abc import Sequence

import numpy as np

from extrados.limit.resistance import Resistance
from extrados.model.geometry.anchors import Anchored
from extrados.model.geometry.assembly import GROUND


def pulls(anchored: Anchored, least: Sequence[float], most: Sequence[float], scale: float) -> Resistance:
    """The pulls of ties on their stones, tension positive; least and most [N], infinite where one never yields.

    The whole of a tie is its yield force, or `scale` [N] where it has none.
    """
    low, high = np.asarray(least, dtype=float), np.asarray(most, dtype=float)
    greatest = np.maximum(-low, high)
    whole = np.where(np.isfinite(greatest), greatest, scale)
    ends = np.arange(len(low))
    number, end = np.concatenate([ends, ends]), np.repeat([0, 1], len(low))
    block, point = anchored.block[number, end], anchored.point[number, end]
    force = whole[number, None] * np.where(end == 0, 1.0, -1.0)[:, None] * anchored.direction[number]
    moment = point[:, 0] * force[:, 1] - point[:, 1] * force[:, 0]
    held = block != GROUND
    return Resistance(number[held], block[held], np.column_stack([force, moment])[held], point[held], low / whole, high / whole)


def tensions(answers: Resistance, share: np.ndarray, count: int) -> np.ndarray:
    """Tension (count) [N] of the last `count` of the forces that answer, which are ties."""
    whole = np.zeros(answers.count)
    whole[answers.number] = np.hypot(*answers.wrench[:, :2].T)
    return (share * whole)[answers.count - count :]
