"""The base of the kinds that are solids and no plane section."""

from abc import abstractmethod

from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.structure import Structure


class Spatial(Structure):
    """What all kinds share that are solids alone."""

    @abstractmethod
    def solids(self, density: float) -> SolidAssembly:
        """Blocks in space, of a density [kg/m^3]; BadGeometry with the part and the bound."""
