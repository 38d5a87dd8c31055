"""What sweeps need to know of any rocking structure, block or arch."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from extrados.analyses.arch_model import ArchModel
from extrados.analyses.block_model import as_block, block_model, initial_ratio
from extrados.analyses.run import Context
from extrados.core.rocking import Body
from extrados.decks.table import Structure
from extrados.structures.from_deck import make_structure


@dataclass(frozen=True)
class RockingModel:
    """A structure ready for the rocking core.

    uplift: horizontal acceleration at which it starts to rock [g]; critical: rotation of unstable equilibrium
    to +x and -x [rad]; time_unit [s]: 1/p of a slender block; length: R of the toe or of the arch [m];
    start_rotation [rad], > 0 to +x.
    """

    what: str
    body: Body
    uplift: float
    critical: tuple[float, float]
    restitution: float
    time_unit: float
    length: float
    start_rotation: float = 0.0
    warnings: tuple[str, ...] = ()


def make_model(structure: Structure, folder: Path, ratio: float | None = None) -> RockingModel:
    """The model of a deck's [structure]; `ratio` replaces its initial rotation over the critical one."""
    made = make_structure(structure, folder)
    body = as_block(structure, made)
    if body is not None:
        block = block_model(body, structure)
        ratio = initial_ratio(structure) if ratio is None else ratio
        alpha = block.alpha
        return RockingModel(
            structure.kind, block.body, float(block.uplift.min()), (float(alpha[0]), float(alpha[1])), float(block.restitution[0]),
            float(1.0 / block.frequency[0]), float(body.radius[0]), ratio * float(alpha[0 if ratio >= 0.0 else 1]),
            tuple(block.warnings),
        )  # fmt: skip
    arch = ArchModel(made, structure.restitution)
    limits = arch.limits
    # V' falls from its value at rest to zero at the critical rotation, as m g R (alpha - q) does for a block
    unit = float(np.sqrt(limits.mass * limits.critical / limits.gravity_moment))
    return RockingModel(
        "arch", arch.body, arch.collapse[0].gamma, (limits.critical, limits.critical), arch.restitution, unit,
        made.radius, (ratio or 0.0) * limits.critical, tuple(arch.warnings),
    )  # fmt: skip


def rocking_model(context: Context, ratio: float | None = None) -> RockingModel:
    """The model of the deck's structure; its warnings go to the context."""
    model = make_model(context.deck.structure, context.deck.folder, ratio)
    context.warnings += model.warnings
    return model
