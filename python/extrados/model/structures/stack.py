"""Two blocks, one upon the other, that rock each for itself."""

from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structure import RocksAs, Structure
from extrados.model.structures.masonry import stones_and_joints
from extrados.schema.quantities import Density, Length
from extrados.schema.table import key


class Stack(Structure):
    """Two blocks with dry joints, one centred on the other, such as a statue on its pedestal or two drums."""

    word: ClassVar = "stack"
    kind: Literal["stack"]
    rocks_as: ClassVar[RocksAs] = "stack"
    starter: ClassVar = {"lower_width": "1.0", "lower_height": "1.0", "upper_width": "0.5", "upper_height": "1.5"}
    lower_width: Length = key(about="width of the lower block", gt=0)
    lower_height: Length = key(about="height of the lower block", gt=0)
    upper_width: Length = key(about="width of the upper block", gt=0)
    upper_height: Length = key(about="height of the upper block", gt=0)
    upper_density: Density | None = key(None, "density of the upper block; default: density of [material]", gt=0)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    def assembly(self, density: float, folder: Path) -> Assembly:
        low, high = 0.5 * self.lower_width, 0.5 * self.upper_width
        contact, middle, top = min(low, high), self.lower_height, self.lower_height + self.upper_height
        outlines = [
            np.array([[-half, foot], [half, foot], [half, head], [-half, head]])
            for half, foot, head in ((low, 0.0, middle), (high, middle, top))
        ]
        joints = [
            ("base", np.array([-low, 0.0]), np.array([low, 0.0]), 0, GROUND),
            ("joint between", np.array([-contact, middle]), np.array([contact, middle]), 1, 0),
        ]
        made = stones_and_joints(outlines, ["lower block", "upper block"], joints, density, self.depth)
        if self.upper_density is not None:
            for values in (made.mass, made.inertia):
                values[1] *= self.upper_density / density
        return made
