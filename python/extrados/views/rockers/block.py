"""The block of a deck as the rocking core sees it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core.rocking import Body, block_body
from extrados.model.geometry.assembly import Assembly
from extrados.model.structures.block import BlockAssembly, monolith
from extrados.schema.constants import GRAVITY
from extrados.views.blocks import Masonry


@dataclass(frozen=True)
class BlockModel:
    """A block and its impact rule: "housner", or c_v; or `energy_ratio` c_E. Pairs are (to +x, to -x)."""

    block: BlockAssembly
    rule: str | float = "housner"
    energy_ratio: float | None = None
    linear: bool = False

    @cached_property
    def housner(self) -> np.ndarray:
        """c_v of the impacts that start rocking to +x and to -x, from angular momentum about the new toe.

        Equal toes of a rectangle: 1 - 3/2 sin^2 alpha (thesis Eq. 6.3). Below zero the old toe would have to
        pull: the block lands flat and stays.
        """
        b = self.block
        mass, inertia = float(b.mass[0]), float(b.inertia[0])
        return (inertia + mass * (b.centre_height**2 - b.toe_right * b.toe_left)) / b.toe_inertia

    @cached_property
    def restitution(self) -> np.ndarray:
        """c_v used."""
        if self.energy_ratio is not None:
            return np.minimum(1.0, np.sqrt(self.energy_ratio * self.block.toe_inertia[::-1] / self.block.toe_inertia))
        if isinstance(self.rule, str):
            return np.clip(self.housner, 0.0, 1.0)
        return np.full(2, float(self.rule))

    @property
    def alpha(self) -> np.ndarray:
        """Critical rotation [rad]."""
        return self.block.alpha

    @property
    def frequency(self) -> np.ndarray:
        """p = sqrt(m g R / I_toe) [rad/s]; sqrt(3 g / 4 R) for a rectangle."""
        b = self.block
        return np.sqrt(b.mass[0] * GRAVITY * b.radius / b.toe_inertia)

    @property
    def uplift(self) -> np.ndarray:
        """Horizontal acceleration that starts rocking to +x (ground to -x) and to -x [g]."""
        return self.alpha if self.linear else np.tan(self.alpha)

    @property
    def warnings(self) -> list[str]:
        """What the reader of an answer should know of the impact rule."""
        if self.energy_ratio is None and isinstance(self.rule, str) and self.housner.min() < 0.0:
            return [
                (
                    "the block is too stocky for the impact rule of Housner, which gives c_v below zero. The block "
                    "then lands flat and stays in contact (c_v = 0)"
                )
            ]
        return []

    def rivals(self, factor: float) -> dict[str, tuple[float, Body]]:
        """None: all impact rules are Housner's for a block."""
        return {}

    @cached_property
    def body(self) -> Body:
        """What the integrator takes, without rebound at a wall."""
        return self.rebounding(1.0)

    def rebounding(self, factor: float) -> Body:
        """The structure with c_v times a factor, at most 1."""
        b, (right, left) = self.block, np.minimum(1.0, factor * self.restitution)
        return block_body(
            float(b.mass[0]), float(b.inertia[0]), b.centre_height, b.toe_right, b.toe_left, (right, left), self.linear, b.slope
        )


def block_model(building: Masonry, linear: bool = False, stones: Assembly | None = None) -> BlockModel:
    """A `block`, or a `column` or a wall taken as one body, with the impact that [joints] asks for.

    A wall is its only pier: one that openings divide rocks by a mechanism. stones: instead of the building's own.
    """
    piers = building.structure is not None and building.structure.rocks_as == "piers"
    made = stones or (building.pier_blocks() if piers else building.blocks())
    block = made if isinstance(made, BlockAssembly) else monolith(made)
    rule = building.joints.restitution
    # The energy-safe projection of a block that lands on both toes is Housner's balance.
    return BlockModel(block, "housner" if isinstance(rule, str) else rule, building.joints.energy_ratio, linear)
