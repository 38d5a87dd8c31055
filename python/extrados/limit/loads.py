"""Loads on the blocks of an assembly: weight, fill and point loads at rest, and what the multiplier gamma scales."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.limit.fill import passive_pressure
from extrados.limit.resistance import Resistance
from extrados.model.geometry.assembly import Assembly
from extrados.schema.constants import GRAVITY


@dataclass(frozen=True)
class Loads:
    """dead and live: (nb, 3) force x, force y [N] and moment about the origin [N m] on each block; what else
    answers where blocks move, ties behind pressures. tied: the blocks that ties hold."""

    dead: np.ndarray
    live: np.ndarray
    resistance: Resistance | None = None
    tied: frozenset[int] = frozenset()

    @cached_property
    def scale(self) -> float:
        """The force by which the programmes are scaled [N]."""
        return float(np.abs(self.dead[:, :2]).sum())

    @property
    def pushes(self) -> int:
        """How many forces answer to movement."""
        return 0 if self.resistance is None else self.resistance.count


def forces_at(count: int, block: int, point: np.ndarray, force: tuple[float, float]) -> np.ndarray:
    """One force [N] at a point [m] of one of `count` blocks, as (count, 3)."""
    load = np.zeros((count, 3))
    load[block] = force[0], force[1], point[0] * force[1] - point[1] * force[0]
    return load


def tilt_loads(assembly: Assembly, fill_sways: bool = True) -> Loads:
    """Weight at rest; the live load is weight turned to +x, so that gamma is an acceleration in g.

    The fill of the assembly rests on its blocks; where fill_sways it is accelerated with them. Soil whose passive
    pressure counts resists.
    """
    x, y = assembly.centroid.T
    weight = assembly.mass * GRAVITY
    nothing = np.zeros_like(weight)
    dead = np.column_stack([nothing, -weight, -x * weight])
    live = np.column_stack([weight, nothing, -y * weight])
    if assembly.fill is not None:
        mass, x, y = assembly.fill.T
        weight = mass * GRAVITY
        dead = dead + np.column_stack([nothing, -weight, -x * weight])
        if fill_sways:
            live = live + np.column_stack([weight, nothing, -y * weight])
    earth, depth = assembly.earth, assembly.depth
    return Loads(dead, live, None if earth is None else passive_pressure(earth, depth, assembly.centroid))
