"""The rigid block on two toes (thesis 6.2, Fig. 6-1)."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.structures.assembly import GROUND, Assembly


@dataclass(frozen=True)
class Block(Assembly):
    """One block on the ground; the origin lies on the ground below its centre of mass, x to the right, y up.

    centre_height, toe_right, toe_left [m]: height of the centre of mass and its distances from the toes.
    """

    centre_height: float
    toe_right: float
    toe_left: float

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
        return np.arctan2(self.toes, self.centre_height)

    @property
    def toe_inertia(self) -> np.ndarray:
        """Moment of inertia about the toe, rocking to +x and to -x [kg m^2]."""
        return self.inertia[0] + self.mass[0] * self.radius**2


def monolith(assembly: Assembly) -> Block:
    """A stack of blocks taken as one rigid body that rocks on the ends of its base."""
    mass = float(assembly.mass.sum())
    centre = assembly.mass @ assembly.centroid / mass
    arm = assembly.centroid - centre
    inertia = float(assembly.inertia.sum() + assembly.mass @ (arm**2).sum(axis=1))
    vertices = np.concatenate(assembly.outlines)
    ground, top = vertices[:, 1].min(), vertices[:, 1].max()
    base, head = (
        vertices[np.isclose(vertices[:, 1], y, atol=1e-9 * (top - ground)), 0] - centre[0] for y in (ground, top)
    )
    height = float(top - ground)
    made = make_block(
        depth=assembly.depth, mass=mass, inertia=inertia, centre_height=float(centre[1] - ground),
        toe_right=float(base.max()), toe_left=float(-base.min()),
    )  # fmt: skip
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
) -> Block:
    """A rectangle by width and height [m] and density [kg/m^3], or a body by mass [kg], inertia [kg m^2], height
    of its centre and distances of its toes [m], drawn as a rectangle on its toes of twice that height."""
    if width is not None:
        mass = density * width * height * depth
        inertia = mass * (width**2 + height**2) / 12.0
        centre_height, toe_right, toe_left = 0.5 * height, 0.5 * width, 0.5 * width
    toe_left = toe_right if toe_left is None else toe_left
    if not min(mass, inertia, centre_height, toe_right, toe_left) > 0.0:
        raise ValueError("mass, inertia, height of the centre and toes of a block must be above zero")
    top = 2.0 * centre_height
    return Block(
        outlines=[np.array([[-toe_left, 0.0], [toe_right, 0.0], [toe_right, top], [-toe_left, top]])],
        mass=np.array([float(mass)]),
        centroid=np.array([[0.0, centre_height]]),
        inertia=np.array([float(inertia)]),
        p=np.array([[-toe_left, 0.0]]),
        q=np.array([[toe_right, 0.0]]),
        a=np.array([0]),
        b=np.array([GROUND]),
        depth=depth,
        block_names=["block"],
        joint_names=["base"],
        centre_height=float(centre_height),
        toe_right=float(toe_right),
        toe_left=float(toe_left),
    )
