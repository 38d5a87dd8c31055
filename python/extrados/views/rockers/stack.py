"""Two stacked blocks as the rocking core sees them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core.stack import Stack
from extrados.model.geometry.assembly import Assembly
from extrados.schema.constants import GRAVITY


@dataclass(frozen=True)
class StackModel:
    """Two blocks of an assembly of kind `stack`; pairs are (lower, upper). Impacts are without rebound at all edges."""

    assembly: Assembly

    @cached_property
    def core(self) -> Stack:
        """For the core."""
        a = self.assembly
        (low, high), (inner, outer) = a.mass, a.inertia
        foot, middle = a.p[0, 1], a.p[1, 1]
        return Stack(
            (float(low), float(high)), (float(inner), float(outer)),
            (float(a.centroid[0, 1] - foot), float(a.centroid[1, 1] - middle)), 0.5 * float(a.length[0]),
            float(middle - foot), 0.5 * float(a.length[1]),
        )  # fmt: skip

    @property
    def whole(self) -> tuple[float, float]:
        """Slenderness angle of both as one block [rad], and the time 1/p in which it turns [s]."""
        s = self.core
        m, c = np.array(s.mass), np.array(s.centre) + np.array([0.0, s.height])
        middle = float(m @ c / m.sum())
        inertia = sum(s.inertia) + float(m @ (c**2 + s.half_foot**2))
        return float(np.arctan2(s.half_foot, middle)), float(
            np.sqrt(inertia / (m.sum() * GRAVITY * np.hypot(s.half_foot, middle)))
        )

    @property
    def alone(self) -> tuple[float, float]:
        """The same of the upper block by itself."""
        s = self.core
        radius = np.hypot(s.half_contact, s.centre[1])
        inertia = s.inertia[1] + s.mass[1] * radius**2
        return float(np.arctan2(s.half_contact, s.centre[1])), float(np.sqrt(inertia / (s.mass[1] * GRAVITY * radius)))

    @property
    def uplift(self) -> tuple[float, float]:
        """Horizontal acceleration at which both as one begin to rock, and the upper alone [g]."""
        return float(np.tan(self.whole[0])), float(np.tan(self.alone[0]))

    def pose(self, rotation: np.ndarray, state: np.ndarray) -> np.ndarray:
        """x, y [m] and counter-clockwise rotation [rad] of both centres (states, 2, 3); rotation, state as StackResponse."""
        s = self.core
        foot, edge = s.half_foot * state[:, 0], s.half_contact * state[:, 1]

        def turned(x: np.ndarray, y: float, angle: np.ndarray) -> np.ndarray:
            c, sn = np.cos(angle), np.sin(angle)
            return np.column_stack([c * x + sn * y, -sn * x + c * y])

        origin = np.column_stack([foot, 0.0 * foot])
        lower = origin + turned(-foot, s.centre[0], rotation[:, 0])
        corner = origin + turned(edge - foot, s.height, rotation[:, 0])
        upper = corner + turned(-edge, s.centre[1], rotation[:, 1])
        return np.stack([np.column_stack([lower, -rotation[:, 0]]), np.column_stack([upper, -rotation[:, 1]])], axis=1)
