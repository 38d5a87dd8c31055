"""The base of the kinds that are solids and no plane section."""

from typing import ClassVar

from extrados.model.structure import Structure

NO_SECTION = "it is no plane section; `tilt` and `dem` look at its solids"


class Spatial(Structure):
    """What all kinds share that are solids alone."""

    lacks: ClassVar = dict.fromkeys(("blocks", "rocker", "mesh"), NO_SECTION)
