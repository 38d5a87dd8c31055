"""An arch in space."""

import numpy as np

from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.sections import barrel
from extrados.model.structures.arch import Arch
from extrados.views.blocks import Masonry


def solids_of_arch(building: Masonry) -> SolidAssembly:
    """A barrel, whose courses may have several stones across and whose faces may be askew."""
    arch = building.structure
    assert isinstance(arch, Arch)
    return barrel(arch.section(building.material.density), arch.stones_across, np.radians(arch.skew))
