"""Two stacked blocks as the rocking core sees them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core.stack import Stack
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.properties import NO_SLIDING_COEFFICIENT
from extrados.schema.constants import GRAVITY
from extrados.views.blocks import Masonry

#: Rounding of lengths, as a share of the size
SAME = 1e-9


def is_stack(assembly: Assembly) -> bool:
    """Whether two blocks stand upon each other, middle over middle, on level joints: one on the ground, one between."""
    grounded = (assembly.a == GROUND) | (assembly.b == GROUND)
    if len(assembly.mass) != 2 or len(grounded) != 2 or grounded.sum() != 1:
        return False
    level = np.abs(assembly.p[:, 1] - assembly.q[:, 1])
    middles = np.concatenate([0.5 * (assembly.p + assembly.q)[:, 0], assembly.centroid[:, 0]])
    return bool(max(level.max(), np.ptp(middles)) <= SAME * assembly.size)


def rocks_as_stack(building: Masonry) -> bool:
    """Whether a building rocks as two stacked blocks: a stack, and two free blocks that are drawn as one."""
    structure, joints = building.structure, building.joints
    if structure is None or structure.rocks_as == "stack":
        return structure is not None
    free = not building.restraints and building.supports.abutting_wall is None and building.supports.stiffness is None
    plastic = joints.energy_ratio is None and isinstance(joints.restitution, str)
    return structure.kind == "blocks" and free and plastic and is_stack(building.blocks())


@dataclass(frozen=True)
class StackModel:
    """Two blocks of an assembly, see `is_stack`; pairs are (lower, upper). Impacts are without rebound at all edges."""

    assembly: Assembly

    @cached_property
    def order(self) -> np.ndarray:
        """Numbers of the lower and of the upper block."""
        return np.argsort(self.assembly.centroid[:, 1])

    @cached_property
    def joints(self) -> np.ndarray:
        """Numbers of the joint on the ground and of that between."""
        return np.argsort(self.assembly.p[:, 1])

    @cached_property
    def core(self) -> Stack:
        """For the core."""
        a = self.assembly
        (low, high), (inner, outer), centre = a.mass[self.order], a.inertia[self.order], a.centroid[self.order, 1]
        (foot, middle), (base, contact) = a.p[self.joints, 1], a.length[self.joints]
        return Stack(
            (float(low), float(high)),
            (float(inner), float(outer)),
            (float(centre[0] - foot), float(centre[1] - middle)),
            0.5 * float(base),
            float(middle - foot),
            0.5 * float(contact),
        )

    def friction(self, given: float | np.ndarray | None) -> tuple[float, float]:
        """Friction of the joint on the ground and of the joint between, infinite where they do not slide; given: of the joints of the
        assembly, or of all."""
        if given is None or np.size(given) not in (1, 2):
            return np.inf, np.inf
        found = np.broadcast_to(np.asarray(given, dtype=float), 2)[self.joints]
        ground, between = np.where(found < NO_SLIDING_COEFFICIENT, found, np.inf).tolist()
        return ground, between

    @property
    def radius(self) -> float:
        """Distance of the centre of both blocks from an edge of the foot [m]."""
        return self.core.half_foot / float(np.sin(self.whole[0]))

    @property
    def whole(self) -> tuple[float, float]:
        """Slenderness angle of both as one block [rad], and the time 1/p in which it turns [s]."""
        s = self.core
        m, c = np.array(s.mass), np.array(s.centre) + np.array([0.0, s.height])
        middle = float(m @ c / m.sum())
        inertia = sum(s.inertia) + float(m @ (c**2 + s.half_foot**2))
        return float(np.arctan2(s.half_foot, middle)), float(np.sqrt(inertia / (m.sum() * GRAVITY * np.hypot(s.half_foot, middle))))

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
        """x, y [m] and counter-clockwise rotation [rad] of both centres (states, 2, 3), in the order of the assembly; rotation, state as
        StackResponse."""
        s = self.core
        foot, edge = s.half_foot * state[:, 0], s.half_contact * state[:, 1]

        def turned(x: np.ndarray, y: float, angle: np.ndarray) -> np.ndarray:
            c, sn = np.cos(angle), np.sin(angle)
            return np.column_stack([c * x + sn * y, -sn * x + c * y])

        origin = np.column_stack([foot, 0.0 * foot])
        lower = origin + turned(-foot, s.centre[0], rotation[:, 0])
        corner = origin + turned(edge - foot, s.height, rotation[:, 0])
        upper = corner + turned(-edge, s.centre[1], rotation[:, 1])
        at = np.stack([np.column_stack([lower, -rotation[:, 0]]), np.column_stack([upper, -rotation[:, 1]])], axis=1)
        ground = self.joints[0]
        at[:, :, :2] += 0.5 * (self.assembly.p[ground] + self.assembly.q[ground])
        return at[:, np.argsort(self.order)]

    def velocity(self, rotation: np.ndarray, rate: np.ndarray, state: np.ndarray) -> np.ndarray:
        """Velocity of both centres [m/s] and counter-clockwise rate of rotation [rad/s] (2, 3), in the order of the assembly; rotation (2)
        [rad], rate (2) [rad/s], state (2) as StackResponse."""
        s = self.core
        foot, edge = s.half_foot * state[0], s.half_contact * state[1]

        def moved(x: float, y: float, block: int) -> np.ndarray:
            c, sn = np.cos(rotation[block]), np.sin(rotation[block])
            return rate[block] * np.array([c * y - sn * x, -sn * y - c * x])

        lower = moved(-foot, s.centre[0], 0)
        upper = moved(edge - foot, s.height, 0) + moved(-edge, s.centre[1], 1)
        return np.array([[*lower, -rate[0]], [*upper, -rate[1]]])[np.argsort(self.order)]
