"""Where ties are anchored: the stones, or the ground, at their ends."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from extrados.model.errors import BadGeometry, Key
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.polygons import inside

if TYPE_CHECKING:
    from extrados.model.geometry.solids.assembly import SolidAssembly

HAIR = 1e-6  # of the size of the assembly: so near to a face a point lies on it


@dataclass(frozen=True)
class Anchored:
    """Ties by their ends: block (ties, 2), the second GROUND where one ends in the ground, and point (ties, 2, 2) [m]."""

    block: np.ndarray
    point: np.ndarray

    @property
    def direction(self) -> np.ndarray:
        """Unit vectors (ties, 2) from the first end to the second."""
        along = self.point[:, 1] - self.point[:, 0]
        return along / np.hypot(*along.T)[:, None]


def stones_at(assembly: Assembly, point: np.ndarray) -> list[int]:
    """The blocks that hold a point (2) [m] or have it on their face."""
    hair = HAIR * assembly.size
    around = point + hair * np.array([[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])
    return [i for i, outline in enumerate(assembly.outlines) if inside(outline, around).any()]


def stone_at(assembly: Assembly, point: np.ndarray, name: str | None, what: str, key: Key, end: str) -> int:
    """The block at a point (2) [m], or the one of a name; BadGeometry, which begins with `what`, where that is not one.

    key: the table of the deck whose `end` ("start", "end") and stone of that end are meant.
    """
    if name is not None:
        return named_stone(assembly.block_names, name, what, key, end)
    return only_stone(assembly.block_names, assembly.centroid, stones_at(assembly, point), point, what, key, end)


def named_stone(names: Sequence[str], name: str, what: str, key: Key, end: str) -> int:
    """The block of a name; BadGeometry, see `stone_at`, where there is none."""
    if name not in names:
        more = ", ..." if len(names) > 8 else ""
        raise BadGeometry(f"{what}: block '{name}' does not exist; the blocks are {', '.join(names[:8])}{more}", (*key, f"{end}_stone"))
    return names.index(name)


def only_stone(
    names: Sequence[str],
    centroid: np.ndarray,
    found: Sequence[int],
    point: np.ndarray,
    what: str,
    key: Key,
    end: str,
    cures: tuple[str, str] | None = None,
) -> int:
    """The one block of those `found` at a point (2 or 3) [m]; BadGeometry, see `stone_at`, of none, with the nearest of the
    centroids (blocks, 2 or 3) [m], or of several. cures: advice for none and for several; without it that of an anchored end."""
    outside, between = cures or (
        f"If this end is anchored outside its block, give the name of the block as {end}_stone",
        "give the name of the block in which this end is anchored",
    )
    place = ", ".join(f"{axis} = {value:.4g}" for axis, value in zip("xyz", point, strict=False)) + " m"
    if not found:
        near = names[int(np.linalg.norm(centroid - point, axis=1).argmin())]
        raise BadGeometry(f"{what}: no block is at {place}; the nearest block is '{near}'. {outside}", (*key, end))
    if len(found) > 1:
        said = ", ".join(f"'{names[i]}'" for i in found)
        raise BadGeometry(f"{what}: {place} lies between {said}; {between}", (*key, end))
    return found[0]


def moved_joints(assembly: "Assembly | SolidAssembly", names: Sequence[str]) -> list[int]:
    """The joints on the ground that [[initial.movements]] name; BadGeometry where one is not there or not on the ground."""
    grounded = (assembly.a == GROUND) | (assembly.b == GROUND)
    found = []
    for k, name in enumerate(names):
        key = ("initial", "movements", k, "joint")
        if name not in assembly.joint_names:
            there = [n for n, on in zip(assembly.joint_names, grounded, strict=True) if on]
            raise BadGeometry(f"joint '{name}' does not exist; the joints on the ground are {', '.join(there[:8])}", key)
        found.append(assembly.joint_names.index(name))
        if not grounded[found[-1]]:
            raise BadGeometry(f"joint '{name}' is not on the ground", key)
    return found
