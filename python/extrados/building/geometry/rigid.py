"""An assembly as rigid bodies made of convex parts, standing on supports of their own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.building.errors import BadGeometry
from extrados.building.geometry.assembly import GROUND, Assembly
from extrados.building.geometry.convex import (
    clean,
    convex_parts,
    hull,
    is_convex,
    overlap_depth,
    rounded,
)
from extrados.building.geometry.mass import together
from extrados.building.geometry.polygons import crossing_edges
from extrados.building.geometry.polygons import signed_area as area

#: An outline is taken for its hull where that is bigger by no more than this, and no joint lies inside the hull:
#: the concave arc of a voussoir's intrados touches nothing.
HULL_EXCESS = 0.15


@dataclass(frozen=True)
class RigidBodies:
    """Bodies 0..count-1 are the blocks (or the groups of blocks), the rest supports of mass 0.

    parts[k] (vertices, 2) [m] belongs to body owner[k]; outer[k] masks its edges that lie on the outline.
    `body_of_block`: body of each block of the assembly; `joints`: bodies on both sides of each joint of the
    assembly (GROUND replaced by the support), or None where both are one body.
    """

    names: list[str]
    count: int
    centroid: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    parts: list[np.ndarray]
    owner: list[int]
    outer: list[np.ndarray]
    body_of_block: np.ndarray
    joints: list[tuple[int, int] | None]
    depth: float

    def __repr__(self) -> str:
        return f"<RigidBodies: {self.count} bodies, {len(self.mass) - self.count} supports>"


def rigid_bodies(
    assembly: Assembly, groups: Sequence[Sequence[int]] = (), worn: float = 0.0, floor: float | None = None
) -> RigidBodies:
    """Bodies of an assembly: `groups` of blocks move as one, corners are worn to a radius [m], a floor at a
    height [m] catches what falls. BadGeometry names a block that cannot be used."""
    n = len(assembly.mass)
    body = _numbering(n, groups)
    count = int(body.max()) + 1
    mass, centroid, inertia = _lumped(assembly, body, count)
    names = [" + ".join(assembly.block_names[i] for i in np.flatnonzero(body == k)) for k in range(count)]
    parts, owner, outer = [], [], []
    for i in range(n):
        for polygon, mask in _block_parts(assembly, i):
            shape, edges = polygon, mask & ~_glued(assembly, body, i, polygon)
            if worn > 0.0:
                try:
                    shape = rounded(polygon, worn)
                except ValueError as error:
                    raise BadGeometry(f"{assembly.block_names[i]}: {error}") from None
                edges = np.ones(len(shape), dtype=bool)
            parts.append(shape)
            owner.append(int(body[i]))
            outer.append(edges)
    support_of = {}
    stones = [p for p, o in zip(parts, owner, strict=True) if o < count]
    for line, polygon in _supports(assembly, stones):
        support_of.update(dict.fromkeys(line, len(names)))
        owner.append(len(names))
        parts.append(polygon)
        outer.append(np.ones(len(polygon), dtype=bool))
        names.append("support of " + ", ".join(assembly.joint_names[j] for j in line))
    if not support_of:
        raise BadGeometry("no block stands on the ground")
    if floor is not None:
        owner.append(len(names))
        parts.append(_floor(assembly, floor))
        outer.append(np.ones(4, dtype=bool))
        names.append("floor")
    supports = len(names) - count
    middles = [parts[k].mean(axis=0) for k, o in enumerate(owner) if o >= count]
    joints: list[tuple[int, int] | None] = []
    for j, (a, b) in enumerate(zip(assembly.a.tolist(), assembly.b.tolist(), strict=True)):
        one, two = (support_of[j] if k == GROUND else int(body[k]) for k in (a, b))
        joints.append(None if one == two else (one, two))
    return RigidBodies(
        names, count, np.concatenate([centroid, np.reshape(middles, (supports, 2))]),
        np.concatenate([mass, np.zeros(supports)]), np.concatenate([inertia, np.zeros(supports)]),
        parts, owner, outer, body, joints, assembly.depth,
    )  # fmt: skip


def _numbering(n: int, groups: Sequence[Sequence[int]]) -> np.ndarray:
    """Body of each block: groups and single blocks in the order of their first blocks."""
    leader = np.arange(n)
    for group in groups:
        leader[list(group)] = min(group)
    return np.unique(leader, return_inverse=True)[1]


def _lumped(assembly: Assembly, body: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, centroid and inertia of the bodies, with the fill that rests on the blocks."""
    mass, centroid, inertia = assembly.mass, assembly.centroid, assembly.inertia
    owner = body
    fill = assembly.fill
    if fill is not None:
        mass = np.concatenate([mass, fill[:, 0]])
        centroid = np.concatenate([centroid, fill[:, 1:]])
        inertia = np.concatenate([inertia, np.zeros(len(fill))])
        owner = np.concatenate([body, body])
    return together(mass, centroid, inertia, owner, count)


def _block_parts(assembly: Assembly, i: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Convex parts of block i with the masks of their outer edges."""
    name = assembly.block_names[i]
    outline = np.asarray(assembly.outlines[i], dtype=float)
    if len(outline) < 3 or abs(area(outline)) < 1e-12 * float(np.ptp(outline, axis=0).max()) ** 2:
        raise BadGeometry(f"{name}: its area is zero")
    crossing = crossing_edges(outline)
    if crossing is not None:
        raise BadGeometry(
            f"{name}: its outline crosses itself (edges from vertices {crossing[0] + 1} and {crossing[1] + 1})"
        )
    outline = clean(outline)
    if is_convex(outline):
        return [(outline, np.ones(len(outline), dtype=bool))]
    wrap = hull(outline)
    if area(wrap) <= (1.0 + HULL_EXCESS) * area(outline) and _joints_on(assembly, i, wrap):
        return [(wrap, np.ones(len(wrap), dtype=bool))]
    try:
        return convex_parts(outline)
    except ValueError as error:
        raise BadGeometry(f"{name}: {error}") from None


def _on_edges(polygon: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Which points lie on which edges of a polygon: (edges, points)."""
    edge = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(*edge.T)[:, None]
    away = points[None] - polygon[:, None]
    along = (away * edge[:, None]).sum(axis=2) / length
    across = (edge[:, None, 0] * away[..., 1] - edge[:, None, 1] * away[..., 0]) / length
    small = 1e-6 * float(length.max())
    return (np.abs(across) < small) & (along > -small) & (along < length + small)


def _joints_on(assembly: Assembly, i: int, polygon: np.ndarray) -> bool:
    """Do all joints of block i lie on the polygon's edges?"""
    mine = np.flatnonzero((assembly.a == i) | (assembly.b == i))
    ends = np.concatenate([assembly.p[mine], assembly.q[mine]])
    return bool(_on_edges(polygon, ends).any(axis=0).all())


def _glued(assembly: Assembly, body: np.ndarray, i: int, polygon: np.ndarray) -> np.ndarray:
    """Edges of a part of block i that are joints to a block of the same body."""
    inner = [
        j
        for j in np.flatnonzero((assembly.a == i) | (assembly.b == i))
        if assembly.a[j] != GROUND and assembly.b[j] != GROUND and body[assembly.a[j]] == body[assembly.b[j]]
    ]
    if not inner:
        return np.zeros(len(polygon), dtype=bool)
    return (_on_edges(polygon, assembly.p[inner]) & _on_edges(polygon, assembly.q[inner])).any(axis=1)


def _ground_lines(assembly: Assembly) -> list[list[int]]:
    """Joints to the ground, those on one line together."""
    lines: list[list[int]] = []
    size = float(np.ptp(np.concatenate([assembly.p, assembly.q]), axis=0).max())
    for j in np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND)).tolist():
        up = _inward(assembly, j)
        for line in lines:
            first = line[0]
            if (
                up @ _inward(assembly, first) > 1.0 - 1e-9
                and abs((assembly.p[j] - assembly.p[first]) @ up) < 1e-6 * size
            ):
                line.append(int(j))
                break
        else:
            lines.append([int(j)])
    return lines


def _inward(assembly: Assembly, j: int) -> np.ndarray:
    """Unit normal of a ground joint, from the ground into the block."""
    return assembly.normal[j] if assembly.a[j] != GROUND else -assembly.normal[j]


def _supports(assembly: Assembly, blocks: list[np.ndarray]) -> list[tuple[list[int], np.ndarray]]:
    """Joints to the ground with the support under them: one for a line, one each where a block stands between."""
    found = []
    for line in _ground_lines(assembly):
        polygon, clear = _support(assembly, line, blocks)
        if clear or len(line) == 1:
            found.append((line, polygon))
        else:
            found += [([j], _support(assembly, [j], blocks)[0]) for j in line]
    return found


def _support(assembly: Assembly, line: list[int], blocks: list[np.ndarray]) -> tuple[np.ndarray, bool]:
    """A support under the joints of one line, as wide as the other blocks allow; and whether they allow any."""
    up = _inward(assembly, line[0])
    along = np.array([up[1], -up[0]])
    origin = assembly.p[line[0]]
    ends = np.concatenate([assembly.p[line], assembly.q[line]]) - origin
    low, high = float((ends @ along).min()), float((ends @ along).max())
    everything = np.concatenate(blocks)
    extent = float(np.ptp(everything, axis=0).max())
    flat = up[1] > 1.0 - 1e-9
    deep = 0.25 * extent if flat else 0.5 * (high - low)
    for margin in ((1.5 * extent,) if flat else ()) + (0.25 * (high - low), 0.0):
        a, b = origin + (low - margin) * along, origin + (high + margin) * along
        polygon = np.array([a - deep * up, b - deep * up, b, a])
        if area(polygon) < 0.0:
            polygon = polygon[::-1]
        if all(overlap_depth(polygon, block) < 1e-6 * extent for block in blocks):
            return polygon, True
    return polygon, False


def _floor(assembly: Assembly, level: float) -> np.ndarray:
    """A wide floor below the structure."""
    points = np.concatenate(assembly.outlines)
    middle, extent = 0.5 * (points[:, 0].min() + points[:, 0].max()), float(np.ptp(points, axis=0).max())
    half = 4.0 * extent
    return np.array(
        [
            [middle - half, level - 0.25 * extent],
            [middle + half, level - 0.25 * extent],
            [middle + half, level],
            [middle - half, level],
        ]
    )
