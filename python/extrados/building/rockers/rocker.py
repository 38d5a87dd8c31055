"""What analyses need to know of any rocking structure, block, arch or mechanism."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from extrados.building.errors import NoView
from extrados.building.geometry.assembly import Assembly
from extrados.building.rockers.arch import ArchModel
from extrados.building.rockers.block import BlockModel, block_model
from extrados.building.rockers.mechanism import MechanismModel
from extrados.building.templates.arch import ArchAssembly
from extrados.core.rocking import Body
from extrados.schema.constants import GRAVITY

if TYPE_CHECKING:
    from extrados.building.building import Building


@dataclass(frozen=True)
class Rocker:
    """A building ready for the rocking core.

    what: its kind; word: what answers call it; model: what it was made from. uplift: horizontal acceleration at which it starts to rock [g]; critical: rotation
    of unstable equilibrium to +x and -x [rad]; time_unit [s]: 1/p of a slender block; length: R of the toe or of the
    arch [m]; start_rotation [rad], > 0 to +x.
    """

    what: str
    word: str
    model: BlockModel | ArchModel | MechanismModel
    body: Body
    uplift: float
    critical: tuple[float, float]
    restitution: float
    time_unit: float
    length: float
    start_rotation: float = 0.0
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Rocker: {self.what}, rocks from {self.uplift:.4g} g>"

    def rebounding(self, factor: float) -> "Rocker":
        """The same with c_v times a factor, as long as an impact creates no energy."""
        return replace(self, body=self.model.rebounding(factor), restitution=min(1.0, factor * self.restitution))

    @property
    def scale(self) -> float:
        """Length [m] whose root scales durations, as R does for an arch (thesis Eq. 5.7): sqrt(scale/g) is 2.5 / p of
        a slender block."""
        return self.length if isinstance(self.model, ArchModel) else GRAVITY * (2.5 * self.time_unit) ** 2


def make_rocker(building: "Building", linear: bool = False, stones: Assembly | None = None) -> Rocker:
    """The building as one rocking mechanism; NoView says why there is none.

    stones: instead of the building's own, as they might be too; an arch of these need not be symmetric and rocks by
    two mechanisms.
    """
    structure, ratio = building.structure, building.initial.rotation_ratio
    if structure is None:
        raise NoView("the deck has no [structure]")
    piers = building.pier_blocks() if structure.rocks_as == "piers" else None
    if structure.rocks_as == "block" or (piers is not None and len(piers.mass) == 1):
        block = block_model(building, linear, stones)
        alpha = block.alpha
        return Rocker(
            structure.kind, structure.word, block, block.body, float(block.uplift.min()), (float(alpha[0]), float(alpha[1])),
            float(block.restitution[0]), float(1.0 / block.frequency[0]), float(block.block.radius[0]),
            ratio * float(alpha[0 if ratio >= 0.0 else 1]), tuple(block.warnings),
        )  # fmt: skip
    made = stones or (building.blocks() if piers is None else piers)
    if linear:
        raise NoView('form = "linear" is known of blocks and columns only')
    if stones is None and isinstance(made, ArchAssembly):
        arch = ArchModel(made, building.joints.restitution)
        limits = arch.limits
        # V' falls from its value at rest to zero at the critical rotation, as m g R (alpha - q) does for a block
        unit = float(np.sqrt(limits.mass * limits.critical / limits.gravity_moment))
        return Rocker(
            "arch", structure.word, arch, arch.body, arch.collapse[0].gamma, (limits.critical, limits.critical), arch.restitution, unit,
            made.radius, ratio * limits.critical, tuple(arch.warnings),
        )  # fmt: skip
    rule = building.joints.restitution
    model = MechanismModel(made, "energy-safe" if rule == "thesis" else rule)
    critical = model.critical
    return Rocker(
        structure.kind, structure.word, model, model.body, min(model.uplift), critical, model.restitution[0],
        model.time_unit, model.length, ratio * critical[0 if ratio >= 0.0 else 1], tuple(model.warnings),
    )  # fmt: skip
