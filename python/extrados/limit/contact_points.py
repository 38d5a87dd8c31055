"""Points of contact between rigid blocks, by which one method serves the plane and space."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse


@dataclass(frozen=True)
class ContactPoints:
    """Points of contact in the plane (d = 2) or in space (d = 3), and the loads on the blocks.

    matrix (equations, d points): forces on the blocks of unit compressions and shears, d columns a point; dead, live
    (equations); friction (points), infinite where nothing slides; grip (points): shear that a point carries without
    compression, as a dowel does; stiffness (points): normal, over their mean, 0 for a dowel. answers (equations, k): forces
    between bounds (2, k) that resist motion, as ties do. weight: of all blocks, in the unit of the forces.
    """

    matrix: sparse.csr_array
    dead: np.ndarray
    live: np.ndarray
    friction: np.ndarray
    grip: np.ndarray
    stiffness: np.ndarray
    answers: sparse.csr_array
    bounds: np.ndarray
    weight: float

    @property
    def dimension(self) -> int:
        """Components of a force."""
        return self.matrix.shape[1] // len(self.friction)

    @cached_property
    def rates(self) -> sparse.csr_array:
        """Opening and slip of the points by motions of the blocks."""
        return sparse.csr_array(self.matrix.T)


@dataclass(frozen=True)
class SlidingState:
    """Forces and a motion that belong to each other where sliding does not dilate: gamma; force (points, d) and share (k) of
    the answers; motion (equations), with a work of the live load of one."""

    gamma: float
    force: np.ndarray
    share: np.ndarray
    motion: np.ndarray
