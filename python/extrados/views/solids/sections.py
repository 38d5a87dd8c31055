"""Blocks in space of the kinds that give a section, or give them whole."""

from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.sections import drawn_out
from extrados.model.structures.spatial import Spatial
from extrados.views.blocks import Masonry


def solids_of_section(building: Masonry) -> SolidAssembly:
    """The section of a plane structure, drawn out to its depth."""
    return drawn_out(building.blocks())


def solids_of_spatial(building: Masonry) -> SolidAssembly:
    """The blocks of a kind that stands in space alone."""
    assert isinstance(building.structure, Spatial)
    return building.structure.solids(building.material.density)
