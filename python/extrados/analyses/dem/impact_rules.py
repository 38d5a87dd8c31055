"""Joint stiffness, impact frequencies and damping of discrete elements (thesis 7.3)."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from extrados.model.geometry.assembly import GROUND, Assembly

#: Least fractions of critical damping at the rotational and the edge impact frequency (thesis 7.4.2): below them
#: blocks bounce and walk.
LEAST_AT_ROTATION, LEAST_AT_EDGE = 0.10, 0.25


@dataclass(frozen=True)
class Impact:
    """Frequencies [rad/s] at which blocks strike a joint: on a corner, flat on the edge, by rotation."""

    corner: np.ndarray
    edge: np.ndarray
    rotation: np.ndarray

    def of(self, name: str) -> np.ndarray:
        """Frequency by its name."""
        return {"corner": self.corner, "edge": self.edge, "rotation": self.rotation}[name]


@dataclass(frozen=True)
class ContactValues:
    """Properties of all joints of a section, or of all contacts of solids (joints,), SI, the damping constant beta [s] and the
    frequencies of impact."""

    stiffness: np.ndarray
    shear_stiffness: np.ndarray
    friction: np.ndarray
    cohesion: np.ndarray
    tension: np.ndarray
    beta: float
    impact: Impact

    @property
    def settle_damping(self) -> float:
        """beta that is critical at edge impact, by which joints are damped until all rests under its own weight [s]."""
        return damping_constant(float(self.impact.edge.max()), 1.0)

    def ratios(self) -> dict[str, float]:
        """Least fraction of critical damping over the joints at each impact frequency."""
        return {name: float(damping_ratio(self.beta, self.impact.of(name)).min()) for name in ("rotation", "corner", "edge")}

    def scaled(self, stiffness: float = 1.0, damping: float = 1.0, friction: float | None = None) -> Self:
        """Other stiffnesses, beta and friction; the impact frequencies follow the stiffness."""
        root = np.sqrt(stiffness)
        impact = Impact(self.impact.corner * root, self.impact.edge * root, self.impact.rotation * root)
        return replace(
            self,
            stiffness=self.stiffness * stiffness,
            shear_stiffness=self.shear_stiffness * stiffness,
            beta=self.beta * damping,
            impact=impact,
            friction=self.friction if friction is None else np.full_like(self.friction, friction),
        )


def damping_constant(frequency: float, ratio: float = 1.0) -> float:
    """beta [s] that gives the fraction `ratio` of critical damping at a frequency [rad/s] (Eq. 7.17)."""
    return 2.0 * ratio / frequency


def damping_ratio(beta: float, frequency: np.ndarray, alpha: float = 0.0) -> np.ndarray:
    """Fraction of critical damping at a frequency [rad/s], beta [s], alpha [1/s] (Eq. 7.2)."""
    return 0.5 * (beta * frequency + alpha / frequency)


def joint_stiffness(modulus: float, length: np.ndarray, width: np.ndarray, convention: str) -> np.ndarray:
    """Normal stiffness per area [Pa/m] of joints that stand for a length of stone [m].

    "consistent": E/L. "thesis": E B/L with the width B of the joint [m], as Eqs 7.10 to 7.12 print it (its unit
    is Pa, taken for Pa/m there; the two agree for a joint of 1 m).
    """
    return modulus * (width if convention == "thesis" else 1.0) / length


def block_impact(stiffness: float, width: float, mass: float, inertia: float) -> Impact:
    """One block of mass [kg] on a rigid base: stiffness [Pa/m times depth], inertia about a corner (Eqs 7.4, 7.9)."""
    return two_block_impact(*(np.array([float(x)]) for x in (stiffness, width, 1.0 / mass, 1.0 / inertia)))


def two_block_impact(stiffness: np.ndarray, width: np.ndarray, mobility: np.ndarray, turning: np.ndarray) -> Impact:
    """Two blocks at a joint with a spring k_s = k B / 2 at each end.

    mobility: sum of 1/m of the blocks that can move; turning: sum of 1/J about the joint's end (Eq. 7.20).
    One block gives Eqs 7.4 and 7.9, two equal ones sqrt(2) times that (Eqs 7.18, 7.19).
    """
    spring = 0.5 * stiffness * width
    return Impact(np.sqrt(spring * mobility), np.sqrt(2.0 * spring * mobility), np.sqrt(spring * width**2 * turning))


def joint_lengths(assembly: Assembly) -> np.ndarray:
    """Length of stone that each joint stands for [m]: of each block half, or all of it where no joint faces it."""
    n_joint = len(assembly.a)
    total = np.zeros(n_joint)
    of_block: dict[int, list[tuple[int, np.ndarray]]] = {}
    for j in range(n_joint):
        for block, inward in ((assembly.a[j], assembly.normal[j]), (assembly.b[j], -assembly.normal[j])):
            if block != GROUND:
                of_block.setdefault(int(block), []).append((j, inward))
    for block, joints in of_block.items():
        outline = np.asarray(assembly.outlines[block])
        for j, inward in joints:
            facing = any(inward @ other < -0.3 for _, other in joints)
            total[j] += float(np.ptp(outline @ inward)) * (0.5 if facing else 1.0)
    return total


def joint_impact(assembly: Assembly, stiffness: np.ndarray) -> Impact:
    """Impact frequencies of all joints of an assembly with normal stiffnesses [Pa/m]."""
    mobility, turning = np.zeros(len(stiffness)), np.zeros(len(stiffness))
    for side in (assembly.a, assembly.b):
        here = np.flatnonzero(side != GROUND)
        block = side[here]
        mass = assembly.mass[block]
        arms = [((assembly.centroid[block] - end[here]) ** 2).sum(axis=1) for end in (assembly.p, assembly.q)]
        mobility[here] += 1.0 / mass
        turning[here] += 1.0 / (assembly.inertia[block] + mass * np.minimum(*arms))
    return two_block_impact(stiffness * assembly.depth, assembly.length, mobility, turning)
