"""Rocking frames: free-standing columns under a lintel that lies freely on them."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structure import RocksAs, Structure
from extrados.model.structures.masonry import stones_and_joints
from extrados.schema.quantities import Length, Mass
from extrados.schema.table import key


@dataclass(frozen=True, repr=False)
class FrameAssembly(Assembly):
    """n equal columns, blocks 0 to n-1 from left to right, and their lintel, the last block; joints: n feet, n heads.

    width, height: of a column [m].
    """

    width: float
    height: float

    @property
    def columns(self) -> int:
        """How many."""
        return len(self.mass) - 1

    @property
    def radius(self) -> float:
        """R: from the toe of a column to its centre of mass [m]."""
        return 0.5 * float(np.hypot(self.width, self.height))

    @property
    def alpha(self) -> float:
        """Slenderness angle of a column [rad]."""
        return float(np.arctan2(self.width, self.height))

    @property
    def mass_ratio(self) -> float:
        """gamma of Makris and Vassiliou: mass of the lintel over that of all columns."""
        return float(self.mass[-1] / self.mass[:-1].sum())


def make_frame(
    columns: int,
    width: float,
    height: float,
    spacing: float,
    lintel_height: float,
    overhang: float = 0.0,
    lintel_mass: float | None = None,
    density: float = 2000.0,
    depth: float = 1.0,
) -> FrameAssembly:
    """Columns of width x height [m] at a spacing of their middles [m], the first at x = 0; the lintel reaches `overhang` [m]
    beyond the outer columns. lintel_mass [kg]: of the lintel with what rests on it; None by its size."""
    if spacing <= width:
        raise BadGeometry(f"structure: columns of {width:g} m overlap at a spacing of {spacing:g} m; the spacing must exceed the width")
    half, top = 0.5 * width, height + lintel_height
    x = spacing * np.arange(columns)
    left, right = -half - overhang, float(x[-1]) + half + overhang
    outlines = [np.array([[c - half, 0.0], [c + half, 0.0], [c + half, height], [c - half, height]]) for c in x]
    outlines.append(np.array([[left, height], [right, height], [right, top], [left, top]]))
    names = [f"column {k + 1}" for k in range(columns)]
    ends = [(np.array([c - half, y]), np.array([c + half, y])) for y in (0.0, height) for c in x]
    joints = [(f"foot of {name}", *ends[k], k, GROUND) for k, name in enumerate(names)]
    joints += [(f"head of {name}", *ends[columns + k], columns, k) for k, name in enumerate(names)]
    plain = stones_and_joints(outlines, [*names, "lintel"], joints, density, depth)
    if lintel_mass is not None:
        plain.inertia[-1] *= lintel_mass / plain.mass[-1]
        plain.mass[-1] = lintel_mass
    return FrameAssembly(**{f.name: getattr(plain, f.name) for f in fields(Assembly)} | {"measures": {}}, width=width, height=height)


class Frame(Structure):
    """Rocking frame: equal columns on the ground and a lintel that lies on them without connection; all columns rock together."""

    word: ClassVar = "frame"
    kind: Literal["frame"]
    rocks_as: ClassVar[RocksAs] = "frame"
    starter: ClassVar = {"width": "1.0", "height": "6.0", "spacing": "4.0", "lintel_height": "1.0"}
    columns: int = key(2, "number of columns", ge=2, le=100)
    width: Length = key(about="width of a column", gt=0)
    height: Length = key(about="height of a column", gt=0)
    spacing: Length = key(about="distance between the middles of neighbouring columns", gt=0)
    lintel_height: Length = key(about="height of the lintel", gt=0)
    overhang: Length = key(0.0, "length by which the lintel extends beyond the outer columns", ge=0)
    lintel_mass: Mass | None = key(None, "mass of the lintel with its loads; default: calculated from size and density", gt=0)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="after")
    def _columns_apart(self) -> "Frame":
        if self.spacing <= self.width:
            raise ValueError(
                f"spacing: columns of {self.width:g} m overlap at a spacing of {self.spacing:g} m; the spacing must exceed the width"
            )
        return self

    def assembly(self, density: float, folder: Path) -> FrameAssembly:
        return make_frame(density=density, **self.model_dump(exclude={"kind"}))
