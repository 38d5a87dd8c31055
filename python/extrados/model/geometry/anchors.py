"""Where ties are anchored: the stones, or the ground, at their ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.model.errors import BadGeometry, Key
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.polygons import inside

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
    names = assembly.block_names
    if name is not None:
        if name not in names:
            more = ", ..." if len(names) > 8 else ""
            raise BadGeometry(f"{what}: block '{name}' does not exist; the blocks are {', '.join(names[:8])}{more}", (*key, f"{end}_stone"))
        return names.index(name)
    found = stones_at(assembly, point)
    place = f"x = {point[0]:.4g}, y = {point[1]:.4g} m"
    if not found:
        away = np.hypot(*(assembly.centroid - point).T)
        near = names[int(away.argmin())]
        raise BadGeometry(
            (f"{what}: no block is at {place}. If the anchorage is outside its block, give the name of the block; '{near}' is the nearest"),
            (*key, end),
        )
    if len(found) > 1:
        said = ", ".join(f"'{names[i]}'" for i in found)
        raise BadGeometry(f"{what}: {place} lies between {said}: give the name of the block of the anchorage", (*key, end))
    return found[0]


def moved_joints(assembly: Assembly, names: Sequence[str]) -> list[int]:
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
