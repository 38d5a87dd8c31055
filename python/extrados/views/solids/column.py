"""A column in space."""

import numpy as np

from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.columns import doweled, drums
from extrados.model.geometry.solids.sections import drawn_out
from extrados.model.structures.masonry import Column, make_column
from extrados.views.blocks import Masonry


def solids_of_column(building: Masonry) -> SolidAssembly:
    """Drums, rectangular or round, with the dowels between them."""
    column = building.structure
    assert isinstance(column, Column)
    density = building.material.density
    if column.section == "round":
        made = drums(column.width, column.drum_heights, column.top_width, column.sides, column.flute_depth, density)
    else:
        made = drawn_out(make_column(column.width, column.drum_heights, column.top_width, density, column.depth))
    if column.dowels is None:
        return made
    bears = np.inf if column.dowels == "unbroken" else float(column.dowels)
    return doweled(made, bears, column.dowel_reach or np.inf)
