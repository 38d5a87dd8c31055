"""Ties, chains and hoops of solid blocks: where they act on which blocks."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from extrados.model.errors import BadGeometry, Key
from extrados.model.geometry.anchors import named_stone, only_stone
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.contacts import GROUND
from extrados.model.geometry.solids.polyhedra import Polyhedron

HAIR = 1e-6  # of the size: so near to a face a point lies on it
LEAST_TURN = 1e-6  # sine of the angle below which a hoop runs straight on


@dataclass(frozen=True)
class Strand:
    """One tension in a straight tie, or along a chain that runs without friction over its points.

    tie: number of the tie of the deck. point (k, 3) [m], in order; closed: the last is joined to the first. blocks: those that
    share the force at each point in equal parts, GROUND for the ground. low, high: least and greatest tension [N].
    """

    tie: int
    point: np.ndarray
    blocks: tuple[tuple[int, ...], ...]
    closed: bool
    low: float
    high: float

    @property
    def segments(self) -> list[tuple[int, int]]:
        """Points that follow each other."""
        count = len(self.point)
        return [(k, (k + 1) % count) for k in range(count if self.closed else count - 1)]

    @property
    def length(self) -> float:
        """Length of its line [m]."""
        return float(sum(np.linalg.norm(self.point[n] - self.point[k]) for k, n in self.segments))

    def forces(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Block (n), place (n, 3) [m] and force (n, 3) on it of a tension of one, without the ground."""
        pull = np.zeros_like(self.point)
        for k, n in self.segments:
            along = self._along(k, n)
            pull[k] += along
            pull[n] -= along
        rows = [
            (block, self.point[k], pull[k] / len(blocks)) for k, blocks in enumerate(self.blocks) for block in blocks if block != GROUND
        ]
        block, place, force = zip(*rows, strict=True)
        return np.array(block), np.array(place), np.array(force)

    def lengthening(self, centroid: np.ndarray, motion: np.ndarray) -> float:
        """Rate of its length in a motion (nb, 6) of centroids and spins, segment by segment."""
        speed = np.zeros_like(self.point)
        for k, blocks in enumerate(self.blocks):
            for block in blocks:
                if block != GROUND:
                    spin = np.cross(motion[block, 3:], self.point[k] - centroid[block])
                    speed[k] += (motion[block, :3] + spin) / len(blocks)
        return float(sum(self._along(k, n) @ (speed[n] - speed[k]) for k, n in self.segments))

    def _along(self, first: int, last: int) -> np.ndarray:
        along = self.point[last] - self.point[first]
        return along / np.linalg.norm(along)


def solid_at(
    assembly: SolidAssembly, point: np.ndarray, name: str | None, what: str, key: Key, end: str, cures: tuple[str, str] | None = None
) -> int:
    """The block at a point (3) [m], or the one of a name; BadGeometry, which begins with `what`, where that is not one.

    cures: see `only_stone`.
    """
    if name is not None:
        return named_stone(assembly.block_names, name, what, key, end)
    hair = HAIR * assembly.size
    holding = [k for k, part in enumerate(assembly.parts) if _outside(part, point) < hair]
    found = sorted({int(assembly.owner[k]) for k in holding})
    return only_stone(assembly.block_names, assembly.centroid, found, point, what, key, end, cures)


def _outside(part: Polyhedron, point: np.ndarray) -> float:
    """How far a point lies beyond the faces of a convex part at most, negative within it [m]."""
    first = part.vertices[[face[0] for face in part.faces]]
    return float(((point - first) * part.normals).sum(axis=1).max())


def hoop_at(assembly: SolidAssembly, height: float, what: str, key: Key) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    """Corners (k, 3) [m] of the convex outline of the structure at a height, and the blocks that have each.

    BadGeometry, which begins with `what`, where no block is cut there, as in a bed joint.
    """
    hair = HAIR * assembly.size
    points, owner = [], []
    for part, block in zip(assembly.parts, assembly.owner.tolist(), strict=True):
        level = part.vertices[:, 2] - height
        if level.min() > -hair or level.max() < hair:
            continue
        for face in part.faces:
            for i, j in zip(face, [*face[1:], face[0]], strict=True):
                if level[i] * level[j] <= 0.0 and level[i] != level[j]:
                    share = level[i] / (level[i] - level[j])
                    points.append((part.vertices[i] + share * (part.vertices[j] - part.vertices[i]))[:2])
                    owner.append(block)
    if not points:
        raise BadGeometry(f"{what}: no block exists at z = {height:.4g} m; a hoop must lie between two bed joints", key)
    plan, whose = np.array(points), np.array(owner)
    corners = plan[ConvexHull(plan).vertices]
    back, forth = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    turn = back[:, 0] * forth[:, 1] - back[:, 1] * forth[:, 0]
    corners = corners[turn > LEAST_TURN * np.linalg.norm(back, axis=1) * np.linalg.norm(forth, axis=1)]
    blocks = tuple(tuple(sorted(set(whose[np.linalg.norm(plan - corner, axis=1) < 2.0 * hair].tolist()))) for corner in corners)
    return np.column_stack([corners, np.full(len(corners), height)]), blocks
