"""The kinematic analysis of local mechanisms: multiplier, participating mass, capacity curve (principle of virtual work)."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from extrados.schema.constants import GRAVITY


@dataclass(frozen=True)
class Weight:
    """A weight [N] of a body that turns about the hinge: arm, how far [m] its centre lies behind the hinge, height [m]
    above it; sways: whether its mass is accelerated with it (a floor that another wall holds back is not)."""

    weight: float
    arm: float
    height: float
    sways: bool = True


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
        """alpha at a rotation [rad], by the work of all forces in a further small one; at rest alpha_0."""
        c, s = np.cos(rotation), np.sin(rotation)
        back = sum(w.weight * (w.arm * c - w.height * s) for w in self.weights)
        out = sum(p.force * p.height * c for p in self.pushes)
        sway = sum(w.weight * (w.height * c + w.arm * s) for w in self.weights if w.sways)
        return float((back - out) / sway)

    @property
    def swaying(self) -> tuple[np.ndarray, np.ndarray]:
        """Weights that sway [N], and their virtual displacements for a unit rotation [m]."""
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
    multiplier vanishes, None where it does not; alone: a0* without what holds it back, from which the curve falls to d0."""

    alpha0: float
    mass: float
    part: float
    acceleration: float
    d0: float | None
    alone: float


def capacity(
    alpha0: float, weight: np.ndarray, displacement: np.ndarray, ultimate: float | None, alone: float | None = None
) -> Capacity:  # fmt: skip
    """Of a mechanism whose swaying weights [N] move sideways by `displacement` in a unit of its coordinate, and which
    vanishes at `ultimate` of it: M* = (sum P d)^2 / (g sum P d^2), e* = g M*/sum P, a0* = alpha0 g/e*,
    d* = d sum P d^2 / sum P d over the same unit; alone: its multiplier without what holds it back, where that is another."""
    first, second = float(weight @ displacement), float(weight @ displacement**2)
    mass = first**2 / (GRAVITY * second)
    part = GRAVITY * mass / float(weight.sum())
    return Capacity(
        alpha0, mass, part, alpha0 * GRAVITY / part, abs(ultimate * second / first) if ultimate else None,
        (alpha0 if alone is None else alone) * GRAVITY / part,
    )  # fmt: skip
