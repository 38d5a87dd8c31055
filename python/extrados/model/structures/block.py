"""The rigid block on two toes (thesis 6.2, Fig. 6-1)."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.mass import together
from extrados.model.structure import RocksAs, Structure
from extrados.schema.quantities import Angle, Inertia, Length, Mass
from extrados.schema.table import key

_BODY = ("mass", "inertia", "centre_height", "toe_right", "toe_left")
SIZES = {"width", "height", "depth", *_BODY}


@dataclass(frozen=True, repr=False)
class BlockAssembly(Assembly):
    """One block on the ground; the origin lies on the ground below its centre of mass, x to the right, y up.

    centre_height, toe_right, toe_left [m]: height of the centre of mass and its distances from the toes, on a base that
    slopes up to the right by `slope` [rad], about the origin.
    """

    centre_height: float
    toe_right: float
    toe_left: float
    slope: float = 0.0

    @property
    def toes(self) -> np.ndarray:
        """Distance of the toe about which it rocks to +x, and to -x [m]."""
        return np.array([self.toe_right, self.toe_left])

    @property
    def radius(self) -> np.ndarray:
        """R, from the toe to the centre of mass, rocking to +x and to -x [m]."""
        return np.hypot(self.toes, self.centre_height)

    @property
    def alpha(self) -> np.ndarray:
        """theta_cr, rocking to +x and to -x [rad]."""
        return np.arctan2(self.toes, self.centre_height) + self.slope * np.array([1.0, -1.0])

    @property
    def toe_inertia(self) -> np.ndarray:
        """Moment of inertia about the toe, rocking to +x and to -x [kg m^2]."""
        return self.inertia[0] + self.mass[0] * self.radius**2


def monolith(assembly: Assembly) -> BlockAssembly:
    """A stack of blocks taken as one rigid body that rocks on the ends of its base."""
    one = np.zeros(len(assembly.mass), dtype=int)
    (mass,), (centre,), (inertia,) = together(assembly.mass, assembly.centroid, assembly.inertia, one, 1)
    vertices = np.concatenate(assembly.outlines)
    ground, top = vertices[:, 1].min(), vertices[:, 1].max()
    base, head = (vertices[np.isclose(vertices[:, 1], y, atol=1e-9 * (top - ground)), 0] - centre[0] for y in (ground, top))
    height = float(top - ground)
    made = make_block(
        depth=assembly.depth,
        mass=float(mass),
        inertia=float(inertia),
        centre_height=float(centre[1] - ground),
        toe_right=float(base.max()),
        toe_left=float(-base.min()),
    )
    outline = np.array([[base.min(), 0.0], [base.max(), 0.0], [head.max(), height], [head.min(), height]])
    return replace(made, outlines=[outline])


def make_block(
    width: float | None = None,
    height: float | None = None,
    depth: float = 1.0,
    density: float = 2000.0,
    *,
    mass: float | None = None,
    inertia: float | None = None,
    centre_height: float | None = None,
    toe_right: float | None = None,
    toe_left: float | None = None,
    head_mass: float = 0.0,
    slope: float = 0.0,
) -> BlockAssembly:
    """A rectangle by width and height [m] and density [kg/m^3], or a body by mass [kg], inertia [kg m^2], height
    of its centre and distances of its toes [m], drawn as a rectangle on its toes of twice that height. head_mass [kg] moves with
    the middle of the head of a rectangle and turns freely on it; the base slopes up to the right by `slope` [rad]."""
    top = height
    if width is not None and height is not None:
        mass = density * width * height * depth
        if not mass > 0.0:
            raise NoView("the block has no weight, which the analysis requires: give a density above zero", ("material", "density"))
        inertia = mass * (width**2 + height**2) / 12.0
        centre_height, toe_right, toe_left = 0.5 * height, 0.5 * width, 0.5 * width
        inertia += head_mass * mass / (mass + head_mass) * (0.5 * height) ** 2
        centre_height = (mass * centre_height + head_mass * height) / (mass + head_mass)
        mass += head_mass
    toe_left = toe_right if toe_left is None else toe_left
    if mass is None or inertia is None or centre_height is None or toe_right is None or toe_left is None:
        raise ValueError("a block requires either `width` and `height`, or `mass`, `inertia`, `centre_height` and `toe_right`")
    if not min(mass, inertia, centre_height, toe_right, toe_left) > 0.0:
        raise ValueError("mass, inertia, height of the centre of mass and toes of a block must be above zero")
    top = 2.0 * centre_height if top is None else top
    c, s = np.cos(slope), np.sin(slope)
    turn = np.array([[c, s], [-s, c]])
    if not min(np.arctan2([toe_right, toe_left], centre_height) + slope * np.array([1.0, -1.0])) > 0.0:
        raise BadGeometry(
            f"on a base that slopes by {np.degrees(slope):.4g} degrees the block overturns under its own weight",
            ("structure", "base_slope"),
        )
    return BlockAssembly(
        outlines=[np.array([[-toe_left, 0.0], [toe_right, 0.0], [toe_right, top], [-toe_left, top]]) @ turn],
        mass=np.array([float(mass)]),
        centroid=np.array([[0.0, centre_height]]) @ turn,
        inertia=np.array([float(inertia)]),
        p=np.array([[-toe_left, 0.0]]) @ turn,
        q=np.array([[toe_right, 0.0]]) @ turn,
        a=np.array([0]),
        b=np.array([GROUND]),
        depth=depth,
        block_names=["block"],
        joint_names=["base"],
        chains={"stack": [0]},
        centre_height=float(centre_height),
        toe_right=float(toe_right),
        toe_left=float(toe_left),
        slope=float(slope),
    )


class Block(Structure):
    """Rigid block that rocks about its two toes: a rectangle, or a body given by mass, inertia, centre of mass and toes."""

    word: ClassVar = "block"
    kind: Literal["block"]
    rocks_as: ClassVar[RocksAs] = "block"
    starter: ClassVar = {"width": "1.0", "height": "4.0"}
    width: Length | None = key(None, "full width B of a rectangular block", gt=0)
    height: Length | None = key(None, "full height H of a rectangular block", gt=0)
    depth: Length = key(1.0, "depth out of plane", gt=0)
    mass: Mass | None = key(None, "mass of a body that is not a rectangle", gt=0)
    inertia: Inertia | None = key(None, "moment of inertia of the body about its centre of mass", gt=0)
    centre_height: Length | None = key(None, "height of the centre of mass of the body above its toes", gt=0)
    toe_right: Length | None = key(None, "horizontal distance of the right toe from the centre of mass", gt=0)
    toe_left: Length | None = key(
        None, "horizontal distance of the left toe from the centre of mass; default: the value of `toe_right`", gt=0
    )
    head_mass: Mass = key(0.0, "for a rectangular pier whose head rotates freely: mass that moves with the middle of the head", ge=0)
    base_slope: Angle = key(0.0, "slope of the ground below the block; positive if it rises to the right", gt=-60, lt=60)

    @model_validator(mode="after")
    def _complete(self) -> "Block":
        body = [name for name in _BODY if getattr(self, name) is not None]
        if self.width is not None or self.height is not None:
            if body:
                raise ValueError(
                    f"`width` and `height` describe a rectangle, but {', '.join(body)} describe another body: give only one of the two"
                )
            if self.width is None or self.height is None:
                raise ValueError("a rectangle requires `width` and `height`")
        elif missing := [name for name in _BODY[:-1] if getattr(self, name) is None]:
            raise ValueError(f"give either `width` and `height`, or {', '.join(_BODY[:-1])} ({', '.join(missing)} missing)")
        if self.head_mass and self.width is None:
            raise ValueError("`head_mass` is only for a rectangle with `width` and `height`; for another body, include this mass in `mass`")
        return self

    def assembly(self, density: float, folder: Path) -> BlockAssembly:
        return make_block(
            density=density, head_mass=self.head_mass, slope=float(np.radians(self.base_slope)), **self.model_dump(include=SIZES)
        )
