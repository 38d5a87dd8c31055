"""Columns of round drums: polygons or flutes around, tapered, with dowels between."""

from dataclasses import replace

import numpy as np

from extrados.model.geometry.solids.assembly import Keys, SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import loft


def drums(
    width: float, heights: list[float], top_width: float | None, sides: int, flute_depth: float = 0.0, density: float = 2000.0
) -> SolidAssembly:
    """Drums of the given heights [m] on the ground, from a diameter `width` at the base to `top_width` [m], over corners.

    With a flute_depth [m] at the base, in proportion above, each of the `sides` is cut in by two flat facets that meet that
    deep in its middle; such a drum is a union of wedges around the axis.
    """
    levels = np.concatenate([[0.0], np.cumsum(heights)])
    radius = 0.5 * np.interp(levels, [0.0, levels[-1]], [width, width if top_width is None else top_width])
    turn = 2.0 * np.pi / sides
    deep = 1.0 - flute_depth / (0.5 * width * np.cos(0.5 * turn))  # of the middle of a side, what the flute leaves

    def ring(r: float, z: float) -> np.ndarray:
        angle = turn * np.arange(sides)
        return np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(sides, z)])

    def wedge(r: float, z: float, k: int) -> np.ndarray:
        """Axis, flute, arris, flute."""
        low = r * np.cos(0.5 * turn) * deep
        ends = [(0.0, 0.0), (low, turn * (k - 0.5)), (r, turn * k), (low, turn * (k + 0.5))]
        return np.array([[s * np.cos(a), s * np.sin(a), z] for s, a in ends])

    stones = []
    for i in range(len(heights)):
        low, high = (radius[i], levels[i]), (radius[i + 1], levels[i + 1])
        if flute_depth > 0.0:
            parts = [loft(wedge(*low, k), wedge(*high, k)) for k in range(sides)]
        else:
            parts = [loft(ring(*low), ring(*high))]
        stones.append(Stone(f"drum {i + 1}", parts, density))
    return assemble(stones, ground=[0.0], what="column")


def doweled(column: SolidAssembly, strength: float, reach: float) -> SolidAssembly:
    """The column with a dowel of a shear strength [N], which reaches as far into the upper stone [m], in the middle of each
    joint between two of its stones."""
    pairs: dict[tuple[int, int], list[int]] = {}
    for j, (one, two) in enumerate(zip(column.a.tolist(), column.b.tolist(), strict=True)):
        if two >= 0:
            pairs.setdefault((one, two), []).append(j)
    middle = [
        np.average([column.polygon[j].mean(axis=0) for j in joints], axis=0, weights=column.area[joints]) for joints in pairs.values()
    ]
    first = np.array([joints[0] for joints in pairs.values()], dtype=int)
    n = len(first)
    return replace(column, keys=Keys(np.array(middle).reshape(-1, 3), first, np.full(n, strength), np.full(n, reach)))
