"""What limit analysis says of an assembly: admissible states and collapse mechanisms."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from extrados.limit.loads import Loads
from extrados.limit.systems import Constraints
from extrados.model.geometry.assembly import Assembly

#: Side of a joint on which the blocks touch
Side = Literal["intrados", "extrados"]
# A joint whose motion at one end is this much smaller than at the other turns about the former.
HINGE = 1e-4
# Of the work of the dead loads: less of the load is none.
NO_WORK = 1e-9
# Joints that move less than this part of the fastest block are at rest.
AT_REST = 1e-7
# Of the greatest compression of a joint: a force this small is rounding, and needs no friction.
NO_FORCE = 1e-9


@dataclass(frozen=True)
class State:
    """One admissible state of the joints: forces in N, positions as fractions of the joints.

    normal, shear (joints); position 0 at p (intrados), 1 at q (extrados); gamma load multiplier; mobilised: the shares
    of the forces that answer to movement, in the order of the loads.
    """

    gamma: float
    normal: np.ndarray
    shear: np.ndarray
    position: np.ndarray
    mobilised: np.ndarray

    @property
    def friction(self) -> np.ndarray:
        """Coefficient of friction needed at each joint; none where it carries nothing."""
        most = self.normal.max()
        carries = np.hypot(self.normal, self.shear) > NO_FORCE * most
        return np.where(carries, np.abs(self.shear) / np.maximum(self.normal, 1e-12 * most), 0.0)

    def points(self, assembly: Assembly) -> np.ndarray:
        """Where the thrust line meets the joints (joints, 2) [m]."""
        return assembly.p + self.position[:, None] * (assembly.q - assembly.p)

    def force(self, assembly: Assembly) -> np.ndarray:
        """Force on block a of each joint (joints, 2) [N]."""
        return self.normal[:, None] * assembly.normal + self.shear[:, None] * assembly.tangent


def blended(one: State, other: State, share: float) -> State:
    """The state between two at the same load, `share` of the way from one to the other: forces and moments are a mean, so
    it is in equilibrium too, and within every law whose limits are convex."""
    parts = (1.0 - share) * one.normal, share * other.normal
    normal = parts[0] + parts[1]
    moment = parts[0] * one.position + parts[1] * other.position
    even = (1.0 - share) * one.position + share * other.position
    return State(
        one.gamma,
        normal,
        (1.0 - share) * one.shear + share * other.shear,
        np.divide(moment, normal, out=even, where=normal > 0.0),
        (1.0 - share) * one.mobilised + share * other.mobilised,
    )


@dataclass(frozen=True)
class Mechanism:
    """Velocities of the blocks at collapse (nb, 3): x, y [m/s], spin [rad/s], scaled to unit live-load work.

    hinges: (joint, "intrados" | "extrados"); sliding: joints that slide or part; opening_p, opening_q, slip
    of the joints. upper_bound is gamma by the work of these velocities, `defect` the misfit of the loops.
    """

    velocity: np.ndarray
    hinges: list[tuple[int, Side]]
    sliding: list[int]
    opening_p: np.ndarray
    opening_q: np.ndarray
    slip: np.ndarray
    upper_bound: float
    defect: float

    @property
    def pivot(self) -> np.ndarray:
        """Place on each joint about which it turns, 0 at p to 1 at q; inside it where the stone crushes."""
        turn = self.opening_p - self.opening_q
        return np.divide(self.opening_p, turn, out=np.full_like(turn, np.nan), where=turn != 0.0)


def read_state(gamma: float, corners: np.ndarray, scale: float, mobilised: np.ndarray) -> State:
    """State from scaled corner forces (joints, 3); what is negative by rounding is taken as zero."""
    n_p, n_q = np.maximum(corners[:, :2].T * scale, 0.0)
    normal = n_p + n_q
    return State(gamma, normal, corners[:, 2] * scale, n_q / np.maximum(normal, 1e-300), mobilised)


def read_mechanism(
    assembly: Assembly,
    loads: Loads,
    constraints: Constraints,
    dual: np.ndarray,
    motion: np.ndarray,
    twist: np.ndarray,
    defect: float,
    at_rest: float = AT_REST,
    taken: float = 0.0,
) -> Mechanism:
    """Mechanism from the scaled twists about the origin and the duals of the constraints.

    Virtual work gives the bound: (taken - dead . u - sum dual * lower) / (live . u); taken is the work that the joints
    take up by sliding and crushing, where no constraint says so, and what pressures and ties take that the motion
    presses or stretches.
    """
    size = assembly.size
    unit = loads.scale * np.array([1.0, 1.0, size])
    live = float((loads.live / unit * twist).sum())
    dead = float((loads.dead / unit * twist).sum())
    if loads.resistance is not None:
        taken += loads.resistance.taken(loads.resistance.work(twist / unit))
    # Where the load does no work the motion is neutral at any load, and bounds that at rest.
    driven = live if abs(live) > NO_WORK * abs(dead) else abs(dead)
    upper = (taken - dead - float(dual @ constraints.lower)) / driven
    x, y = (assembly.centroid / size).T
    velocity = np.column_stack([twist[:, 0] - twist[:, 2] * y, twist[:, 1] + twist[:, 2] * x, twist[:, 2]])

    fastest = np.hypot(velocity[:, 0], velocity[:, 1]).max()
    opening_p, opening_q, slip = motion.T
    speed_p, speed_q = np.hypot(opening_p, slip), np.hypot(opening_q, slip)
    moves = np.maximum(speed_p, speed_q) > at_rest * fastest
    # A negative opening is crushing: the joint turns about a place inside it.
    turns = (np.minimum(speed_p, speed_q) < HINGE * np.maximum(speed_p, speed_q)) | (opening_p * opening_q < 0.0)
    hinges: list[tuple[int, Side]] = [
        (j, "intrados" if abs(opening_p[j]) < abs(opening_q[j]) else "extrados") for j in np.flatnonzero(moves & turns).tolist()
    ]
    scale = 1.0 / (abs(driven) * size)
    return Mechanism(
        velocity * np.array([size, size, 1.0]) * scale,
        hinges,
        np.flatnonzero(moves & ~turns).tolist(),
        opening_p * size * scale,
        opening_q * size * scale,
        slip * size * scale,
        upper,
        defect,
    )
