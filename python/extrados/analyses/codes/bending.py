"""A wall that bends out of its plane as two rigid bodies: upright between held floors, or level between side walls (arching)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from extrados.limit.errors import CannotStand
from extrados.model.errors import BadGeometry

#: The crack of vertical bending lies at least this part of the height from foot and top
LEAST_PART = 0.05
Carried = Callable[[float, float], tuple[float, float]]
#: Rotations at which the end of a capacity curve is looked for
STEPS = 721


def _end(multiplier: Callable[[float], float], last: float) -> float | None:
    """The first rotation [rad] up to `last` at which the multiplier vanishes."""
    before = 0.0
    if multiplier(0.0) <= 0.0:
        return 0.0
    for q in np.linspace(0.0, last, STEPS)[1:]:
        if multiplier(q) <= 0.0:
            return float(brentq(multiplier, before, q))
        before = float(q)
    return None


@dataclass(frozen=True)
class VerticalBending:
    """Wall of height h and thickness t [m] between a fixed foot and a top that cannot move sideways; weight P on it [N].

    It cracks at a height h_1. The lower body turns about its outer edge at the foot, the upper one about the inner edge of the crack
    and the point, `arm` behind the outer face, through which the floor holds and loads it with N [N]. setback: of the hinges at foot
    and crack within the wall, by crushing [m].
    """

    height: float
    thickness: float
    weight: float
    load: float
    arm: float
    crack: float
    setback: tuple[float, float] = (0.0, 0.0)

    @property
    def parts(self) -> tuple[float, float]:
        """Weights of lower and upper body [N]."""
        lower = self.weight * self.crack / self.height
        return lower, self.weight - lower

    def carried(self, rotation: float) -> tuple[Carried, Carried]:
        """Where a point (x, y) [m] of the lower and of the upper body lies at a rotation of the lower body [rad]; +x outward, the outer face at
        0."""
        q = rotation
        t, h1, h2 = self.thickness, self.crack, self.height - self.crack
        foot, inner = -self.setback[0], -t + self.setback[1]
        c, s = np.cos(q), np.sin(q)

        def lower(x: float, y: float) -> tuple[float, float]:
            return foot + (x - foot) * c + y * s, -(x - foot) * s + y * c

        bx, by = lower(inner, h1)
        # the top stays at -arm: (-arm - inner) cos p - h2 sin p = -arm - bx
        reach, size = -self.arm - inner, float(np.hypot(-self.arm - inner, h2))
        turn = float(np.arccos(np.clip((-self.arm - bx) / size, -1.0, 1.0)) - np.arctan2(h2, reach))
        cp, sp = np.cos(turn), np.sin(turn)

        def upper(x: float, y: float) -> tuple[float, float]:
            return bx + (x - inner) * cp - (y - h1) * sp, by + (x - inner) * sp + (y - h1) * cp

        return lower, upper

    def places(self, rotation: float) -> tuple[np.ndarray, np.ndarray]:
        """Horizontal and vertical positions [m] of both centres and of the top at a rotation of the lower body [rad]; +x outward."""
        lower, upper = self.carried(rotation)
        middle, h1 = -0.5 * self.thickness, self.crack
        found = np.array([lower(middle, 0.5 * h1), upper(middle, 0.5 * (h1 + self.height)), upper(-self.arm, self.height)])
        return found[:, 0], found[:, 1]

    def rates(self, rotation: float) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of `places` by the rotation."""
        x, y = self.places(rotation)
        inner = -self.thickness + self.setback[1]
        foot = -self.setback[0]
        c, s = np.cos(rotation), np.sin(rotation)
        px, py = inner - foot, self.crack
        bx, by = foot + px * c + py * s, -px * s + py * c
        dbx, dby = -px * s + py * c, -px * c - py * s
        # the top does not move sideways: dbx - turn' (y_top - by) = 0
        spin = dbx / (y[2] - by)
        dx = np.array([y[0], dbx - spin * (y[1] - by), 0.0])
        dy = np.array([-(x[0] - foot), dby + spin * (x[1] - bx), dby + spin * (x[2] - bx)])
        return dx, dy

    def work(self, rotation: float = 0.0) -> float:
        """Work [N m] per further rotation that the weights take."""
        _, dy = self.rates(rotation)
        return float(np.dot((*self.parts, self.load), dy))

    def multiplier(self, rotation: float = 0.0) -> float:
        """alpha at a rotation of the lower body [rad]."""
        dx, _ = self.rates(rotation)
        return self.work(rotation) / float(np.dot(self.parts, dx[:2]))

    @property
    def swaying(self) -> tuple[np.ndarray, np.ndarray]:
        """Weights of both bodies [N] and their horizontal virtual displacements for a unit rotation [m]."""
        return np.array(self.parts), self.rates(0.0)[0][:2]

    def travel(self, rotation: float | np.ndarray) -> float | np.ndarray:
        """d_C/delta_Cx of the centre of the weights at a rotation [rad]."""
        weights, slope = self.swaying
        start = self.places(0.0)[0][:2]
        moved = np.array([weights @ (self.places(float(q))[0][:2] - start) for q in np.atleast_1d(rotation)])
        found = moved / float(weights @ slope)
        return found if np.ndim(rotation) else float(found[0])

    @property
    def alone(self) -> "VerticalBending":
        """Itself: nothing but weights holds it."""
        return self

    def ultimate(self) -> float | None:
        """Rotation of the lower body [rad] at which the multiplier vanishes."""
        # the bodies lie in one line at most
        return _end(self.multiplier, 0.98 * min(1.0, 4.0 * self.thickness / self.crack))


def vertical_bending(
    height: float, thickness: float, width: float, weight: float, load: float, arm: float, strength: float | None
) -> VerticalBending:
    """The mechanism of vertical bending with the crack at the height of the least multiplier; strength f_d [Pa], None: no crushing."""

    def at(crack: float) -> VerticalBending:
        setback = (0.0, 0.0)
        if strength is not None:
            upper = weight * (1.0 - crack / height) + load
            setback = (2.0 * (weight + load) / (3.0 * strength * width), 2.0 * upper / (3.0 * strength * width))
            if sum(setback) >= thickness:
                if weight + load > strength * width * thickness:
                    raise CannotStand(
                        f"the wall crushes under its weight: the load is {(weight + load) / 1000.0:.3g} kN, but the section "
                        f"carries at most {strength * width * thickness / 1000.0:.3g} kN",
                        neglects=(),
                    )
                raise BadGeometry(
                    "the stress under self-weight exceeds 0.75 of the compressive strength", ("material", "compressive_strength")
                )
        return VerticalBending(height, thickness, weight, load, arm, crack, setback)

    found = minimize_scalar(
        lambda crack: at(crack).multiplier(),
        bounds=(LEAST_PART * height, (1.0 - LEAST_PART) * height),
        method="bounded",
        options={"xatol": 1e-9 * height},
    )
    return at(float(found.x))


@dataclass(frozen=True)
class HorizontalBending:
    """A strip of wall of length L and thickness t [m] between side walls that resist its thrust with a force H [N].

    Two halves turn in plan about the edges at the side walls and meet at mid length at the opposite face. weight: of the strip and what
    sways with it [N]; push: outward thrust of roofs at rest [N]. depth: compressed depth of the arch at each hinge [m]. crushes: the side
    walls do not move, and the strip crushes at its hinges.
    """

    length: float
    thickness: float
    weight: float
    abutment: float
    push: float = 0.0
    depth: float = 0.0
    crushes: bool = False

    @property
    def rise(self) -> float:
        """Lever arm of the thrust at rest [m]."""
        return self.thickness - self.depth

    def _rates(self, q: float) -> tuple[float, float]:
        """Spread of the side walls, and mean horizontal displacement, per further rotation [m]."""
        half = 0.5 * self.length
        spread = 2.0 * (self.rise * np.cos(q) - half * np.sin(q))
        return float(spread), float(0.5 * half * np.cos(q) - 0.5 * self.rise * np.sin(q))

    def work(self, rotation: float = 0.0) -> float:
        """Work [N m] per further rotation that side walls and thrusts take."""
        spread, mean = self._rates(rotation)
        return self.abutment * spread - self.push * mean

    def multiplier(self, rotation: float = 0.0) -> float:
        """alpha at a rotation of the halves [rad]; at rest 8 H t/(W L)."""
        return self.work(rotation) / (self.weight * self._rates(rotation)[1])

    @property
    def swaying(self) -> tuple[np.ndarray, np.ndarray]:
        """Weights of both halves [N] and their horizontal virtual displacements for a unit rotation [m]."""
        return np.full(2, 0.5 * self.weight), np.full(2, 0.25 * self.length)

    def travel(self, rotation: float | np.ndarray) -> float | np.ndarray:
        """d_C/delta_Cx of the centre of a half at a rotation [rad]."""
        return np.sin(rotation) - 2.0 * self.rise / self.length * (1.0 - np.cos(rotation))

    @property
    def alone(self) -> "HorizontalBending":
        """Itself: without the thrust of its side walls it has no mechanism."""
        return self

    def ultimate(self) -> float | None:
        """Rotation [rad] at which the multiplier vanishes: without push atan(2 t/L), where the arch becomes straight; None for a strip
        that crushes, whose bodies are not rigid."""
        if self.crushes:
            return None
        return _end(self.multiplier, float(np.arctan2(2.0 * self.rise, self.length)) * 1.001)


Bending = VerticalBending | HorizontalBending
