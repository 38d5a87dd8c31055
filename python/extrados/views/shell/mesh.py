"""A building or a vault as flat shells in space: nodes, elements by part, masses, and what holds it."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from extrados.model.properties import Material


def nodal_areas(xyz: np.ndarray, connect: np.ndarray) -> np.ndarray:
    """Area (elements, corners) [m^2] that each corner stands for: the integral of its shape function."""
    c = xyz[connect]
    if connect.shape[1] == 3:
        area = 0.5 * np.linalg.norm(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]), axis=1)
        return np.repeat(area[:, None] / 3.0, 3, axis=1)
    at = np.sqrt(1.0 / 3.0)
    share = np.zeros((len(connect), 4))
    for r, s in ((-at, -at), (at, -at), (at, at), (-at, at)):
        n = 0.25 * np.array([(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)])
        dr = 0.25 * np.array([-(1 - s), 1 - s, 1 + s, -(1 + s)])
        ds = 0.25 * np.array([-(1 - r), -(1 + r), 1 + r, 1 - r])
        size = np.linalg.norm(np.cross(np.einsum("c,ecx->ex", dr, c), np.einsum("c,ecx->ex", ds, c)), axis=1)
        share += size[:, None] * n
    return share


def spread(nodes: int, connect: np.ndarray, share: np.ndarray, density: np.ndarray) -> np.ndarray:
    """Nodal forces (nodes, 6) [N] of a force per area (elements, 3) [N/m^2]; share as of nodal_areas."""
    force = np.zeros((nodes, 6))
    for k, corner in enumerate(connect.T):
        np.add.at(force[:, :3], corner, share[:, k, None] * density)
    return force


@dataclass(frozen=True)
class ShellPart:
    """Elements of one wall, floor or piece. Arrays by element."""

    name: str
    kind: str
    connect: np.ndarray  # (elements, 3 or 4) 0-based
    thickness: np.ndarray  # [m]
    material: np.ndarray  # index into ShellMesh.materials
    linear: np.ndarray  # bool, nothing cracks there
    strength: np.ndarray  # factor of the tensile strength
    bends: bool = True  # a floor is a membrane
    wall: int = -1  # index into ShellMesh.walls, -1 none


@dataclass(frozen=True)
class ShellJoint:
    """A joint of no thickness between two rows of nodes, stretch by stretch. Arrays by stretch.

    connect (stretches, 4) along the lower and back along the upper side; normal from the lower to the upper side, along the
    joint in the plane of the wall, and out of it.
    """

    name: str
    connect: np.ndarray
    normal: np.ndarray  # (stretches, 3)
    along: np.ndarray
    out: np.ndarray
    length: np.ndarray  # [m]
    thickness: np.ndarray  # [m]
    wall: str  # that it is in, or that abuts there
    strength: dict[str, float] = field(default_factory=dict)  # its values of [joints], stiffnesses too; NaN where none
    softening: str = "exponential"
    floor: str = ""  # of a seat: the floor on its upper side, which rests on the wall below

    @property
    def inward(self) -> np.ndarray:
        """Horizontal unit vector (3) of a seat across the wall, towards its floor."""
        return np.asarray(self.out[0])


@dataclass(frozen=True)
class ShellBar:
    """A bar between two nodes."""

    name: str
    nodes: tuple[int, int]
    area: float  # [m^2]
    material: Material
    prestress: float = 0.0  # [N]


def pieces(nodes: int, parts: list[ShellPart], bars: list[ShellBar], joints: Iterable[ShellJoint] = ()) -> np.ndarray:
    """Which piece each node is of, from 0: nodes of one piece are joined by elements, bars and joints."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = [np.column_stack([p.connect, np.roll(p.connect, -1, axis=1)]).reshape(len(p.connect), 2, -1) for p in parts]
    ends += [np.stack([j.connect[:, :2], j.connect[:, [3, 2]]], axis=1) for j in joints]
    one = np.concatenate([*(e[:, 0].ravel() for e in ends), np.array([bar.nodes[0] for bar in bars], dtype=int)])
    two = np.concatenate([*(e[:, 1].ravel() for e in ends), np.array([bar.nodes[1] for bar in bars], dtype=int)])
    return connected_components(coo_array((np.ones(len(one)), (one, two)), shape=(nodes, nodes)), directed=False)[1]


@dataclass(frozen=True)
class WallPlane:
    """Where a wall stands: its plane, by which it is unfolded. place = origin + s along + z up."""

    name: str
    origin: np.ndarray  # (2) on the plan [m]
    along: np.ndarray  # (2) unit vector
    length: float  # [m]
    openings: list[tuple[float, float, float, float]] = field(default_factory=list)  # s from, to, z from, to [m]

    def unfolded(self, xyz: np.ndarray) -> np.ndarray:
        """(s, z) of points (n, 3) [m]."""
        return np.column_stack([(xyz[:, :2] - self.origin) @ self.along, xyz[:, 2]])


@dataclass(frozen=True)
class Foot:
    """Nodes on the ground that move as one where it gives way: those under a wall, or of a vault's springing."""

    name: str
    nodes: np.ndarray
    out: np.ndarray  # (nodes, 3) horizontal unit vectors away from the building
    along: np.ndarray  # (nodes) place along the foot [m]


@dataclass(frozen=True)
class ShellMesh:
    """xyz (nodes, 3) [m]; held: (node, direction) of supports, springs (node, direction, N/m); floor_mass (nodes) [kg];
    push (nodes, 3): constant forces that are no weight [N]; feet: what may settle. A vault has no walls: its parts bend and
    lie in no plane."""

    xyz: np.ndarray
    parts: list[ShellPart]
    walls: list[WallPlane]
    levels: np.ndarray
    materials: list[Material]
    size: float
    held: list[tuple[int, int]]
    springs: list[tuple[int, int, float]]
    bars: list[ShellBar]
    floor_mass: np.ndarray
    push: np.ndarray
    warnings: list[str] = field(default_factory=list)
    feet: list[Foot] = field(default_factory=list)
    joints: list[ShellJoint] = field(default_factory=list)
    has_joints = False  # dry ones, of stones

    def __repr__(self) -> str:
        return f"<ShellMesh: {len(self.xyz)} nodes, {self.elements()} elements>"

    def elements(self) -> int:
        """Number of elements."""
        return sum(len(part.connect) for part in self.parts)

    def mass(self) -> np.ndarray:
        """Mass (nodes) [kg] of walls and floors."""
        mass = self.floor_mass.copy()
        for part in self.parts:
            density = np.array([m.density for m in self.materials])[part.material]
            share = nodal_areas(self.xyz, part.connect) * (density * part.thickness)[:, None]
            np.add.at(mass, part.connect, share)
        return mass

    def wall_nodes(self, wall: int) -> np.ndarray:
        """The nodes of a wall."""
        return np.unique(np.concatenate([p.connect.ravel() for p in self.parts if p.wall == wall]))

    def nearest(self, place: np.ndarray) -> int:
        """The node nearest to a place."""
        return int(np.linalg.norm(self.xyz - place, axis=1).argmin())
