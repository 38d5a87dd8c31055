"""Put a section of a building together from blocks, joints, rings of voussoirs and piers.

A survey makes hundreds of sections a second: numbers go by `math` and rings as a whole, many times faster than numpy one by one.
"""

from functools import cache
from itertools import repeat
from math import acos, asin, cos, sin
from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.polygons import cut, properties, signed_area
from extrados.model.geometry.sectors import directions, ring_sector, sector_outlines

ARC = 12  # points that draw a quarter or less of a circle in the outline of a pier
STEPS = np.arange(ARC)


class Builder:
    """Collects blocks and joints and makes the assembly."""

    def __init__(self, density: float, depth: float):
        self.density, self.depth = density, depth
        self._blocks: list[tuple[str, np.ndarray, float, np.ndarray, float]] = []
        self._joints: list[tuple[str, np.ndarray, np.ndarray, int, int, int]] = []

    def block(self, name: str, outline: np.ndarray, sector: tuple[float, np.ndarray, float] | None = None) -> int:
        """A block of an outline; `sector` gives area, centroid and inertia of a counter-clockwise one with arcs."""
        if sector is None:
            outline = outline if signed_area(outline) > 0.0 else outline[::-1]
        self._blocks.append((name, outline, *(sector or properties(outline))))
        return len(self._blocks) - 1

    def joint(self, name: str, p: np.ndarray, q: np.ndarray, a: int, b: int, inward: int) -> int:
        """A joint from p to q; inward is +1 where block a lies to the left of that direction."""
        self._joints.append((name, p, q, a, b, inward))
        return len(self._joints) - 1

    def ring(
        self, name: str, centre: np.ndarray, inner: float, outer: float, embrace: float, voussoirs: int, left: int, right: int
    ) -> list[int]:
        """An arch of sector voussoirs between blocks `left` and `right`; its joints from left to right."""
        delta = embrace / voussoirs
        area, reach, polar = ring_sector(inner, outer, delta)
        angle = 0.5 * np.pi + 0.5 * embrace - delta * np.arange(voussoirs + 1)
        toward = directions(angle)
        p, q = centre + inner * toward, centre + outer * toward
        centroid = centre + reach * directions(0.5 * (angle[:-1] + angle[1:]))
        outlines = sector_outlines(centre, inner, outer, angle)
        names, joint_names = _names(name, voussoirs)
        blocks, joints = len(self._blocks), len(self._joints)
        ends = [left, *range(blocks, blocks + voussoirs), right]
        self._blocks += zip(names, outlines, repeat(area), centroid, repeat(polar))
        self._joints += zip(joint_names, p, q, ends[1:], ends[:-1], repeat(-1))
        return list(range(joints, joints + voussoirs + 1))

    def reserve(self, name: str) -> int:
        """A place for a block whose outline comes later."""
        self._blocks.append((name, np.empty((0, 2)), 0.0, np.zeros(2), 0.0))
        return len(self._blocks) - 1

    def fill_in(self, index: int, outline: np.ndarray) -> None:
        """Give a block another outline (corners, 2) [m], either way round."""
        outline = outline if signed_area(outline) > 0.0 else outline[::-1]
        self._blocks[index] = (self._blocks[index][0], outline, *properties(outline))

    def name_of(self, block: int) -> str:
        """The name of a block by its index."""
        return self._blocks[block][0]

    def outline_of(self, block: int) -> np.ndarray:
        """Vertices of a block (k, 2) [m]."""
        return self._blocks[block][1]

    def place_of(self, block: int) -> float:
        """x of the middle of a block [m]."""
        return float(self._blocks[block][1][:, 0].mean())

    def assembly(self, **parts: Any) -> Assembly:
        """All blocks and joints; `parts` are the descriptive fields of the assembly."""
        names, outlines, areas, centroids, polars = zip(*self._blocks, strict=True)
        joint_names, p, q, a, b, inward = zip(*self._joints, strict=True)
        mass = self.density * self.depth
        return Assembly(
            outlines=list(outlines),
            mass=np.array(areas) * mass,
            centroid=np.array(centroids),
            inertia=np.array(polars) * mass,
            p=np.array(p),
            q=np.array(q),
            a=np.array(a),
            b=np.array(b),
            depth=self.depth,
            block_names=list(names),
            joint_names=list(joint_names),
            inward=np.array(inward),
            **parts,
        )


@cache
def _names(ring: str, voussoirs: int) -> tuple[list[str], list[str]]:
    """Of the voussoirs and of the joints of a ring."""
    return [f"{ring}voussoir {i + 1}" for i in range(voussoirs)], [f"{ring}joint {j}" for j in range(voussoirs + 1)]


def springing_path(
    part: str, side: int, face: float, centre: np.ndarray, inner: float, outer: float, half: float, top: float
) -> np.ndarray:
    """The face of a pier from where the intrados of an arch meets it, around the arch's end joint, to the top.

    side +1 where the pier stands to the right of the arch, -1 to its left; face is the x of the pier's
    face, half the half angle of embrace. The piece of ring below the end joint belongs to the pier.
    """
    x, y = float(centre[0]), float(centre[1])
    reach = side * (face - x)
    low, high = inner * sin(half), inner
    slack = 1e-9 * outer
    if not low - slack <= reach <= high + slack:
        raise BadGeometry(
            f"{part}: the distance from the face to the vertical axis of the arch is {reach:.4g} m. Give a distance "
            f"between {low:.4g} m (intrados at the springing) and {high:.4g} m (radius of the intrados)"
        )
    if outer * sin(half) < reach - slack:
        raise BadGeometry(f"{part}: the extrados of the springing lies outside the pier")
    crown = y + outer * cos(half)
    if top < crown - slack:
        raise BadGeometry(f"{part}: the top at {top:.4g} m is below the extrados of the springing, which is at {crown:.4g} m")

    def arc(radius: float, start: float, end: float) -> np.ndarray:
        phi = start + STEPS * ((end - start) / (ARC - 1))  # np.linspace, at a fifth of its time
        phi[-1] = end
        points = np.empty((ARC, 2))
        points[:, 0] = x + side * radius * np.sin(phi)
        points[:, 1] = y + radius * np.cos(phi)
        return points

    at_face = asin(max(-1.0, min(reach / inner, 1.0)))
    path = [arc(inner, at_face, half) if at_face - half > 1e-9 else arc(inner, half, half)[:1]]
    path.append(np.array([[x + outer * (side * sin(half)), crown]]))
    if top > crown + slack:
        leaves = asin(max(-1.0, min(reach / outer, 1.0)))
        at_top = acos(max(-1.0, min((top - y) / outer, 1.0)))
        path.append(arc(outer, half, max(leaves, at_top))[1:])
        if leaves >= at_top:
            path.append(np.array([[face, top]]))
    return np.concatenate(path)


def fill_loads(assembly: Assembly, over: list[tuple[list[int], float]], density: float) -> np.ndarray:
    """Mass and centroid (nb, 3) of the fill over the voussoirs of chains, each from its extrados up to a level."""
    fill = np.zeros((len(assembly.mass), 3))
    fill[:, 1:] = assembly.centroid
    for joints, level in over:
        q = assembly.q[joints]
        for j, one, two in zip(joints[:-1], q[:-1], q[1:], strict=True):
            if two[0] <= one[0]:
                continue
            column = np.array([one, two, [two[0], level], [one[0], level]])
            below = cut(column, np.array([0.0, level]), np.array([0.0, -1.0]))
            if len(below) >= 3 and (area := abs(signed_area(below))) > 0.0:
                outline = below if signed_area(below) > 0.0 else below[::-1]
                fill[assembly.a[j]] = area * density * assembly.depth, *properties(outline)[1]
    return fill
