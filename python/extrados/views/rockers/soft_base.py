"""A block on a compliant base, as the rocking core sees it, and its statics."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core.soft_base import SoftBase, base_held
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.properties import NO_SLIDING_COEFFICIENT
from extrados.model.structures.block import BlockAssembly
from extrados.schema.constants import GRAVITY
from extrados.views.blocks import Masonry
from extrados.views.rockers.block import BlockModel, block_model
from extrados.views.rockers.words import refuse_soft_base

#: Rotations tried up to the one taken as collapse, in the search for equilibria
LOOKS = 400
UNDAMPED = "the base has no damping, so no energy is lost and bounces continue: give `damping_ratio` of [supports]"


@dataclass(frozen=True)
class SoftBaseModel:
    """A block on a Winkler bed or on springs under its edges; pairs are (to +x, to -x)."""

    rigid: BlockModel
    core: SoftBase

    @property
    def block(self) -> BlockAssembly:
        """The block on its base."""
        return self.rigid.block

    @property
    def weight(self) -> float:
        """[N]"""
        return float(self.block.mass[0]) * GRAVITY

    def friction(self, given: float | np.ndarray | None) -> float:
        """Friction of the base, infinite where it does not slide; given: of the joints of the block, or of all."""
        least = np.inf if given is None else float(np.min(given))
        return least if least < NO_SLIDING_COEFFICIENT else np.inf

    @property
    def limit(self) -> np.ndarray:
        """Rotations taken as collapse [rad]."""
        return np.minimum(2.0 * np.arctan2(self.block.toes, self.block.centre_height), 0.5 * np.pi)

    def direction(self, q: float) -> tuple[float, float]:
        """Sine and cosine of a rotation."""
        return (q, 1.0) if self.core.linear else (float(np.sin(q)), float(np.cos(q)))

    def sinking(self, q: float) -> float:
        """How far it sinks [m] where it is held at a rotation [rad] and free to sink under its weight."""
        return float(base_held(self.core, q)[0][0])

    def restoring(self, q: float) -> float:
        """Moment that turns it back from a rotation to +x, of its weight and the base [N m]."""
        return float(base_held(self.core, q)[2][0])

    def lever(self, q: float) -> float:
        """Height at which a horizontal inertia force acts against `restoring` [m]."""
        sine, cosine = self.direction(q)
        edge = self.core.toe_right if q >= 0.0 else -self.core.toe_left
        return self.core.height if self.core.linear else edge * sine + self.core.height * cosine

    def potential(self, q: float) -> float:
        """Energy of weight and base at a rotation, free to sink, as histories count it [J]."""
        return float(base_held(self.core, q)[1][0])

    @cached_property
    def rest(self) -> float:
        """Rotation at which it stands [rad]: unlike edges sink unlike. BadGeometry where it cannot stand on this base."""
        from scipy.optimize import brentq

        if self.core.toe_left == self.core.toe_right:
            found = 0.0
        else:
            right, left = self.limit
            tried = np.linspace(-left, right, 2 * LOOKS + 1)[1:-1]
            sign = base_held(self.core, tried)[2] > 0.0
            stable = np.flatnonzero(~sign[:-1] & sign[1:])
            if not len(stable):
                raise BadGeometry(self._too_soft, ("supports", "stiffness"))
            k = stable[np.abs(tried[stable]).argmin()]
            found = float(brentq(self.restoring, tried[k], tried[k + 1], xtol=1e-15))
        if not self._stiffness_at_rest > 0.0:
            raise BadGeometry(self._too_soft, ("supports", "stiffness"))
        return found

    def turned(self, ratio: float) -> float:
        """The rotation at the start [rad]: that at which it stands, and a share of the way to the critical one of a side."""
        return self.rest + abs(ratio) * (self.critical(1 if ratio >= 0.0 else -1) - self.rest)

    @property
    def _stiffness_at_rest(self) -> float:
        """Of the whole base against turning about the foot, less what the weight takes [N m]."""
        return float(np.linalg.det(self._full_contact[1])) / float(self._full_contact[1][1, 1])

    @property
    def _too_soft(self) -> str:
        least = self.core.stiffness * self.weight * self.core.height / (self._stiffness_at_rest + self.weight * self.core.height)
        return (
            f"the stiffness of the base is {self.core.stiffness / self.block.depth:.4g} N/m^3, which is too low: "
            f"below about {least / self.block.depth:.3g} N/m^3 the block overturns under its own weight"
        )

    @property
    def _full_contact(self) -> tuple[np.ndarray, np.ndarray]:
        """Masses and stiffnesses of small rotation and sinking about the whole base."""
        c, b = self.core, self.block
        left, right, k = -c.toe_left, c.toe_right, c.stiffness
        if c.edges:
            half = 0.5 * k * (right - left)
            moments = [2.0 * half, half * (left + right), half * (left**2 + right**2)]
        else:
            moments = [k * (right**n - left**n) / n for n in (1, 2, 3)]
        mass = np.diag([float(b.inertia[0]) + c.mass * c.height**2, c.mass])
        return mass, np.array([[moments[2] - self.weight * c.height, moments[1]], [moments[1], moments[0]]])

    @cached_property
    def periods(self) -> tuple[float, float]:
        """Natural periods of small motion on the whole base, undamped: of rocking, and of up and down [s]."""
        from scipy.linalg import eigh

        mass, stiffness = self._full_contact
        squares, shapes = eigh(stiffness, mass)
        turning = int(np.abs(shapes[0] * np.sqrt(mass[0, 0])).argmax())
        found = 2.0 * np.pi / np.sqrt(squares)
        return float(found[turning]), float(found[1 - turning])

    def lifted(self, side: int) -> float:
        """Rotation to a side (1, -1) at which the far edge lifts, held there and free to sink [rad]."""
        from scipy.optimize import brentq

        far = -self.core.toe_left if side > 0 else self.core.toe_right

        def pressed(q: float) -> float:
            return self.sinking(q) + far * self.direction(q)[0]

        end = side * float(self.limit[0 if side > 0 else 1])
        return float(brentq(pressed, 0.0, end, xtol=1e-15)) if pressed(end) < 0.0 < pressed(0.0) else end

    def critical(self, side: int) -> float:
        """Rotation to a side from which gravity takes it down [rad]."""
        return self._way(side)[1]

    def capacity(self, side: int) -> float:
        """Greatest constant acceleration that it bears to a side, in equilibrium at some rotation [g]."""
        return self._way(side)[0]

    def uplift(self, side: int) -> float:
        """Constant acceleration at which the far edge lifts [g]."""
        q = self.lifted(side)
        return side * self.restoring(q) / (self.weight * self.lever(q))

    def _way(self, side: int) -> tuple[float, float]:
        """Greatest acceleration in equilibrium [g], and the rotation where none is left [rad], on the way to a side."""
        from scipy.optimize import brentq, minimize_scalar

        key = f"_way_{side}"
        if key not in self.__dict__:
            tried = self.rest + (side * self.limit[0 if side > 0 else 1] - self.rest) * np.linspace(0.0, 1.0, LOOKS + 1)[1:]
            back = side * base_held(self.core, tried)[2]
            ends = int(np.argmax(back <= 0.0)) if (back <= 0.0).any() else len(tried)
            if ends == 0:
                raise BadGeometry(self._too_soft, ("supports", "stiffness"))
            critical = float(tried[-1])
            if ends < len(tried):
                critical = float(brentq(self.restoring, tried[ends - 1], tried[ends], xtol=1e-15))

            def lost(q: float) -> float:
                return -side * self.restoring(q) / (self.weight * self.lever(q))

            # it may be greatest at the kink where the edge lifts
            places = [p for p in (self.lifted(side),) if 0.0 < (p - self.rest) * side < (critical - self.rest) * side]
            levers = np.array([self.lever(q) for q in tried[:ends]])
            best = int((back[:ends] / levers).argmax())
            low, high = tried[best - 1] if best else self.rest, tried[min(best + 1, len(tried) - 1)]
            found = minimize_scalar(lost, bounds=(min(low, high), max(low, high)), method="bounded", options={"xatol": 1e-13})
            self.__dict__[key] = -min([float(found.fun), *(lost(p) for p in places)]), critical
        return self.__dict__[key]

    def pose(self, rotation: np.ndarray, sinking: np.ndarray) -> np.ndarray:
        """x, y [m] and counter-clockwise rotation [rad] of the centre (n, 1, 3)."""
        edge = np.where(rotation < 0.0, -self.core.toe_left, self.core.toe_right)
        x = edge * (1.0 - np.cos(rotation)) + self.core.height * np.sin(rotation)
        return np.stack([x, self.core.height * np.cos(rotation) - sinking, -rotation], axis=1)[:, None, :]

    def velocity(self, state: np.ndarray) -> np.ndarray:
        """Velocity of the centre to +x and up [m/s] and counter-clockwise spin [rad/s] (3) in a state (4): rotation [rad], sinking [m] and
        their rates."""
        q, _, turning, sinking = state
        edge = -self.core.toe_left if q < 0.0 else self.core.toe_right
        x = edge * np.sin(q) + self.core.height * np.cos(q)
        return np.array([x * turning, -self.core.height * np.sin(q) * turning - sinking, -turning])


def soft_base_model(building: Masonry, linear: bool = False, stones: Assembly | None = None) -> SoftBaseModel:
    """A block, a column or a wall without openings taken as one body, on the base of [supports]; NoView where the
    building is none of these, or held by more. stones: instead of the building's own."""
    supports, structure = building.supports, building.structure
    assert supports.stiffness is not None and structure is not None
    refuse_soft_base(building)
    rigid = block_model(building, linear, stones)
    block = rigid.block
    if block.slope:
        raise NoView("a compliant base must be level: remove `base_slope`, or `stiffness` of [supports]", ("structure", "base_slope"))
    mass, width = float(block.mass[0]), block.toe_left + block.toe_right
    stiffness = supports.stiffness * block.depth
    damping = 2.0 * (supports.damping_ratio or 0.0) * float(np.sqrt(stiffness * mass / width))
    return SoftBaseModel(
        rigid,
        SoftBase(
            mass,
            float(block.inertia[0]),
            block.centre_height,
            block.toe_left,
            block.toe_right,
            stiffness,
            damping,
            supports.foundation == "two-spring",
            linear,
        ),
    )
