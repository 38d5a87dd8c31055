"""The kinematic analysis of local mechanisms: multiplier, participating mass, capacity curve (principle of virtual work)."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from extrados.schema.constants import GRAVITY

#: Of the fastest block: what moves less is at rest, its motion is rounding
MOVES = 1e-5


class NoMechanism(Exception):
    """The building has no local mechanism of the kind that is checked; the text says why."""


@dataclass(frozen=True)
class Weight:
    """A weight [N] at a body that turns about the hinge: arm, how far [m] its centre lies behind the hinge, height [m]
    above it. rests: whether it bears on the body (P_k); one that does not only pushes it by its mass (Q_k). sways: whether its
    mass is accelerated with the body (a floor that another wall holds back is not)."""

    weight: float
    arm: float
    height: float
    sways: bool = True
    rests: bool = True


@dataclass(frozen=True)
class Push:
    """A horizontal force [N] at a height [m] above the hinge that does not change: positive outward (a thrust), negative
    where it holds back (a tie that yields, friction of side walls)."""

    force: float
    height: float


@dataclass(frozen=True)
class Overturning:
    """One body that turns outward about a hinge; the multiplier is that of all weights that sway."""

    weights: tuple[Weight, ...]
    pushes: tuple[Push, ...] = ()

    @property
    def alone(self) -> "Overturning":
        """Without what holds it back: the actions whose presence until collapse is certain (Circ. 7/2019 C8.7.1.2.1.6)."""
        return Overturning(self.weights, tuple(p for p in self.pushes if p.force > 0.0))

    def multiplier(self, rotation: float = 0.0) -> float:
        """alpha at a rotation [rad], by the work of all forces in a further small one; at rest alpha_0 [C8.7.1.1]."""
        c, s = np.cos(rotation), np.sin(rotation)
        sway = sum(w.weight * (w.height * c + w.arm * s) for w in self.weights if w.sways)
        return float(self.work(rotation) / sway)

    def work(self, rotation: float = 0.0) -> float:
        """Work [N m] per further rotation that weights and pushes take from the body at a rotation [rad]; below 0 they drive it."""
        c, s = np.cos(rotation), np.sin(rotation)
        back = sum(w.weight * (w.arm * c - w.height * s) for w in self.weights if w.rests)
        return float(back - sum(p.force * p.height * c for p in self.pushes))

    def travel(self, rotation: float | np.ndarray) -> float | np.ndarray:
        """Horizontal displacement d_C of the control point over its virtual displacement delta_Cx per unit rotation, at a rotation
        [rad]: the control point is the centre of the weights that rest on the body."""
        height = sum(w.weight * w.height for w in self.weights if w.rests)
        arm = sum(w.weight * w.arm for w in self.weights if w.rests)
        return np.sin(rotation) + arm / height * (1.0 - np.cos(rotation))

    @property
    def swaying(self) -> tuple[np.ndarray, np.ndarray]:
        """Weights P + Q that sway [N], and their horizontal virtual displacements for a unit rotation [m]."""
        rows = [(w.weight, w.height) for w in self.weights if w.sways]
        weight, height = np.array(rows).T
        return weight, height

    def ultimate(self) -> float | None:
        """Rotation [rad] at which the multiplier vanishes; None where it has none (held back for ever, or less than 0 at rest)."""
        if self.multiplier() <= 0.0:
            return 0.0
        steps = np.linspace(0.0, np.pi / 2, 721)
        values = [self.multiplier(q) for q in steps]
        k = next((i for i, v in enumerate(values) if v <= 0.0), None)
        return None if k is None else float(brentq(self.multiplier, steps[k - 1], steps[k]))


@dataclass(frozen=True)
class Capacity:
    """alpha0; mass M* [kg]; part e*; acceleration a0* [m/s^2] before the confidence factor; d0 [m]: d0* at which the
    multiplier vanishes, None where it does not; alone: a0* without what holds it back, from which the curve falls to d0;
    weight [N] of the chain."""

    alpha0: float
    mass: float
    part: float
    acceleration: float
    d0: float | None
    alone: float
    weight: float


def in_chain(velocity: np.ndarray, size: float) -> np.ndarray:
    """Which blocks move in a mechanism (blocks), from their velocities x, y and rotations (blocks, 3) and a length [m]."""
    speed = np.maximum(np.hypot(velocity[:, 0], velocity[:, 1]), size * np.abs(velocity[:, 2]))
    return np.asarray(speed > MOVES * speed.max())


def spectral(weight: np.ndarray, displacement: np.ndarray, travel: float | np.ndarray) -> float | np.ndarray:
    """d* [m] of the equivalent oscillator [C8.7.1.4], from the weights [N] of the chain, their horizontal virtual displacements
    and d_C/delta_Cx of the control point."""
    return travel * float(weight @ displacement**2) / float(weight @ displacement)


def capacity(alpha0: float, weight: np.ndarray, displacement: np.ndarray, travel: float | None, alone: float | None = None) -> Capacity:
    """Of a mechanism by the weights [N] of its kinematic chain, P and Q, and their horizontal virtual displacements (with sign).

    e* = (sum P d)^2/(sum P sum P d^2) [C8.7.1.5], M* = e* sum P/g, a0* = alpha0 g/e* [C8.7.1.3] without FC. Weights that do not
    move have no place in it. travel: d_C/delta_Cx at which the multiplier vanishes, None where it does not; alone: its multiplier
    without what holds it back, where that is another.
    """
    first, second, total = float(weight @ displacement), float(weight @ displacement**2), float(weight.sum())
    part = first**2 / (total * second)
    return Capacity(
        alpha0,
        part * total / GRAVITY,
        part,
        alpha0 * GRAVITY / part,
        float(spectral(weight, displacement, travel)) if travel else None,
        (alpha0 if alone is None else alone) * GRAVITY / part,
        total,
    )
