"""Forces that answer to movement: pressures of soil that push back, ties that pull until they yield."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Resistance:
    """Force k is anything from low[k] to high[k] times its whole; the programmes choose how much. low <= 0 <= high.

    A whole has one or more parts, each on one block: number (e), the force that it is part of; block (e); wrench (e, 3),
    force x, force y [N] and moment about the origin [N m]; point (e, 2) [m] where it acts.
    """

    number: np.ndarray
    block: np.ndarray
    wrench: np.ndarray
    point: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def count(self) -> int:
        """How many forces."""
        return len(self.low)

    def __add__(self, other: "Resistance") -> "Resistance":
        """Both, the forces of the other behind."""
        return Resistance(
            np.concatenate([self.number, other.number + self.count]),
            np.concatenate([self.block, other.block]),
            np.concatenate([self.wrench, other.wrench]),
            np.concatenate([self.point, other.point]),
            np.concatenate([self.low, other.low]),
            np.concatenate([self.high, other.high]),
        )

    def spread(self, blocks: int) -> np.ndarray:
        """The wholes as forces on all blocks (blocks, 3, k), one a column."""
        out = np.zeros((blocks, self.count, 3))
        np.add.at(out, (self.block, self.number), self.wrench)
        return out.transpose(0, 2, 1)

    def on_blocks(self, share: np.ndarray, blocks: int) -> np.ndarray:
        """Forces (blocks, 3) of given shares (k)."""
        out = np.zeros((blocks, 3))
        np.add.at(out, self.block, share[self.number, None] * self.wrench)
        return out

    def work(self, twist: np.ndarray) -> np.ndarray:
        """Work (k) of the wholes in twists (blocks, 3) about the origin."""
        parts = (self.wrench * twist[self.block]).sum(axis=1)
        return np.bincount(self.number, parts, self.count)

    def taken(self, work: np.ndarray) -> float:
        """What the forces take up of a motion in which their wholes do `work` (k): they resist as much as they can.

        What never yields takes nothing: a motion by which it would is none.
        """
        high, low = (np.where(np.isfinite(bound), bound, 0.0) for bound in (self.high, self.low))
        return float(np.maximum(-high * work, -low * work).sum())


def together(*parts: Resistance | None) -> Resistance | None:
    """All parts that there are, one behind the other."""
    found = None
    for part in parts:
        if part is not None and part.count:
            found = part if found is None else found + part
    return found
