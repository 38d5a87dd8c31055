"""The one block-and-joint model of any plane assembly, shared by limit analysis, rocking and discrete elements."""

from dataclasses import dataclass

import numpy as np

GROUND = -1


@dataclass(frozen=True)
class Assembly:
    """Rigid blocks that touch along straight joints; out of plane it is `depth` thick.

    outlines: vertices of each block, counter-clockwise [m]; mass (nb) [kg]; centroid (nb, 2) [m];
    inertia (nb) about the centroids [kg m^2]. Joint j runs from p[j] to q[j] [m] (for arches p is the
    intrados end, q the extrados end) between blocks a[j] and b[j], GROUND for the ground.
    """

    outlines: list[np.ndarray]
    mass: np.ndarray
    centroid: np.ndarray
    inertia: np.ndarray
    p: np.ndarray
    q: np.ndarray
    a: np.ndarray
    b: np.ndarray
    depth: float
    block_names: list[str]
    joint_names: list[str]

    @property
    def length(self) -> np.ndarray:
        """Length of each joint [m]."""
        return np.hypot(*(self.q - self.p).T)

    @property
    def tangent(self) -> np.ndarray:
        """Unit vector of each joint from p to q."""
        return (self.q - self.p) / self.length[:, None]

    @property
    def normal(self) -> np.ndarray:
        """Unit normal of each joint, pointing into block a.

        Taken from the position of block a itself relative to the joint: the direction between the two
        centroids turns the wrong way where a tall pier meets a flat arch.
        """
        n = np.stack([-self.tangent[:, 1], self.tangent[:, 0]], axis=1)
        inner = np.where(self.a != GROUND, self.a, self.b)
        side = np.einsum("ij,ij->i", self.centroid[inner] - 0.5 * (self.p + self.q), n)
        side = np.where(self.a != GROUND, side, -side)
        return n * np.sign(side)[:, None]
