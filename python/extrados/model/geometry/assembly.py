"""The one block-and-joint model of any plane assembly, shared by limit analysis, rocking and discrete elements."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from extrados.model.geometry.earth import Earth

GROUND = -1


@dataclass(frozen=True)
class Assembly:
    """Rigid blocks that touch along straight joints; out of plane it is `depth` thick.

    outlines: vertices of each block, counter-clockwise [m]; mass (nb) [kg]; centroid (nb, 2) [m];
    inertia (nb) about the centroids [kg m^2]. Joint j runs from p[j] to q[j] [m] (for arches p is the
    intrados end, q the extrados end) between blocks a[j] and b[j], GROUND for the ground.
    What drivers and pictures know of its parts: `chains`, name -> joints of an arch from springing to
    springing; `buttresses`, blocks that stand on the ground at the sides, from left to right, and may
    crack when tilted; `fill` (nb, 3), mass [kg] that rests on each block and its place x, y [m]; `earth`, the soil
    that this fill is where it spreads loads and pushes back; `measures`, derived lengths worth telling, by names that
    end in their unit; `materials`, for each block a name of [materials] or None, empty where all are of one; `groups`,
    name -> joints that [[joints.types]] may call by one name.
    `tolerance`: of a survey, how far faces may lie from the joints in them and in each other [m]; 0 where they are exact.
    `remarks` must be told beside every answer; `notes`, what was made of a survey, once.

    `inward` (nj) is +1 where the left side of p -> q lies in block a, -1 where the right side does; None
    lets the centroids decide, which is right for every block that is convex near its joints.
    """

    outlines: list[np.ndarray]
    mass: np.ndarray
    centroid: np.ndarray
    inertia: np.ndarray
    p: np.ndarray
    q: np.ndarray
    a: np.ndarray
    b: np.ndarray
    depth: float
    block_names: list[str]
    joint_names: list[str]
    inward: np.ndarray | None = field(default=None, kw_only=True)
    chains: dict[str, list[int]] = field(default_factory=dict, kw_only=True)
    buttresses: list[int] = field(default_factory=list, kw_only=True)
    fill: np.ndarray | None = field(default=None, kw_only=True)
    earth: Earth | None = field(default=None, kw_only=True)
    measures: dict[str, float] = field(default_factory=dict, kw_only=True)
    materials: list[str | None] = field(default_factory=list, kw_only=True)
    groups: dict[str, list[int]] = field(default_factory=dict, kw_only=True)
    tolerance: float = field(default=0.0, kw_only=True)
    remarks: tuple[str, ...] = field(default=(), kw_only=True)
    notes: tuple[str, ...] = field(default=(), kw_only=True)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.mass)} blocks, {len(self.a)} joints>"

    @cached_property
    def length(self) -> np.ndarray:
        """Length of each joint [m]."""
        return np.hypot(*(self.q - self.p).T)

    @cached_property
    def tangent(self) -> np.ndarray:
        """Unit vector of each joint from p to q."""
        return (self.q - self.p) / self.length[:, None]

    @cached_property
    def normal(self) -> np.ndarray:
        """Unit normal of each joint, pointing into block a.

        Taken from the position of block a itself relative to the joint: the direction between the two
        centroids turns the wrong way where a tall pier meets a flat arch.
        """
        tangent = self.tangent
        n = np.column_stack([-tangent[:, 1], tangent[:, 0]])
        if self.inward is not None:
            return n * np.asarray(self.inward, dtype=float)[:, None]
        on_a = self.a != GROUND
        inner = np.where(on_a, self.a, self.b)
        side = ((self.centroid[inner] - 0.5 * (self.p + self.q)) * n).sum(axis=1)
        return n * np.where(np.where(on_a, side, -side) >= 0.0, 1.0, -1.0)[:, None]

    @cached_property
    def middle(self) -> np.ndarray:
        """Midpoint of each joint (nj, 2) [m]."""
        return 0.5 * (self.p + self.q)

    @cached_property
    def size(self) -> float:
        """Greatest extent of the joints [m], the scale of lengths."""
        ends = np.concatenate([self.p, self.q])
        return float((ends.max(axis=0) - ends.min(axis=0)).max())

    @cached_property
    def ends(self) -> list[tuple[int, int]]:
        """Blocks a and b of each joint."""
        return list(zip(self.a.tolist(), self.b.tolist(), strict=True))

    @cached_property
    def bounds(self) -> list[list[int]]:
        """Joints that bound each block."""
        found: list[list[int]] = [[] for _ in self.mass]
        for j, pair in enumerate(self.ends):
            for block in pair:
                if block != GROUND:
                    found[block].append(j)
        return found

    def joints_of(self, block: int) -> np.ndarray:
        """Joints that bound a block."""
        return np.array(self.bounds[block], dtype=int)


def part_of(assembly: Assembly, blocks: list[int]) -> Assembly:
    """Some blocks by themselves, in the order given: with the joints between them and to the ground, without chains."""
    number = np.full(len(assembly.mass) + 1, len(assembly.mass))
    number[blocks] = np.arange(len(blocks))
    number[GROUND] = GROUND
    a, b = number[assembly.a], number[assembly.b]
    kept = np.flatnonzero((a < len(blocks)) & (b < len(blocks)))
    return replace(
        assembly,
        outlines=[assembly.outlines[i] for i in blocks],
        mass=assembly.mass[blocks],
        centroid=assembly.centroid[blocks],
        inertia=assembly.inertia[blocks],
        p=assembly.p[kept],
        q=assembly.q[kept],
        a=a[kept],
        b=b[kept],
        block_names=[assembly.block_names[i] for i in blocks],
        joint_names=[assembly.joint_names[j] for j in kept],
        inward=None if assembly.inward is None else np.asarray(assembly.inward)[kept],
        chains={},
        buttresses=[],
        fill=None if assembly.fill is None else assembly.fill[blocks],
        measures={},
        groups={},
        materials=[assembly.materials[i] for i in blocks] if assembly.materials else [],
    )
