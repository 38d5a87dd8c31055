"""An assembly as rigid bodies made of convex parts, standing on supports of their own."""

import itertools
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
    overlap,
    overlap_depth,
    rounded,
)
from extrados.building.geometry.mass import together
from extrados.building.geometry.polygons import crossing_edges
from extrados.building.geometry.polygons import signed_area as area

#: An outline is taken for its hull where that is bigger by no more than this, and no joint lies inside the hull:
#: the concave arc of a voussoir's intrados touches nothing.
HULL_EXCESS = 0.15
#: A footing is wider than the joint on it by this share of it on both sides, so that a block may slide a little. It is no
#: floor: what slides or falls farther finds one where the deck names it.
FOOTING = 0.25
#: Faces of a survey gape, overlap and bend by as much as its contact tolerance lets pass. They are taken to the joints in them
#: within this share of the joint's length, and parts that still overlap by less than this share of their size are cut back.
DRESSED = 0.05
#: What a survey calls straight bends by this share of its length at most.
SURVEYED = 5e-3


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
    lines = _faces(assembly)
    for i in range(n):
        for polygon, mask in _block_parts(assembly, lines, i):
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
    _apart(parts, outer, owner)
    if floor is not None:
        for polygon in _floor(assembly, floor, parts[len(stones) :]):
            owner.append(len(names))
            parts.append(polygon)
            outer.append(np.ones(4, dtype=bool))
        names.append("floor")
    supports = len(names) - count
    middles = [
        np.mean([p.mean(axis=0) for p, o in zip(parts, owner, strict=True) if o == k], axis=0)
        for k in range(count, len(names))
    ]
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


def _block_parts(assembly: Assembly, lines: np.ndarray, i: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Convex parts of block i with the masks of their outer edges."""
    name = assembly.block_names[i]
    outline = _dressed(assembly, lines, i)
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


def _apart(parts: list[np.ndarray], outer: list[np.ndarray], owner: list[int]) -> None:
    """Cut back parts of different bodies that overlap as drawn, each by half of it along the edge of least overlap. Deeper
    overlaps than `DRESSED` stay: the drawing is wrong there."""
    low, high = (np.array([corner(p, axis=0) for p in parts]) for corner in (np.min, np.max))
    size = np.sqrt([area(p) for p in parts])
    body = np.array(owner)
    order = np.argsort(low[:, 0], kind="stable")
    last = np.searchsorted(low[order, 0], high[order, 0])
    for rank, i in enumerate(order.tolist()):
        others = order[rank + 1 : last[rank]]
        others = others[(low[others, 1] < high[i, 1]) & (high[others, 1] > low[i, 1]) & (body[others] != body[i])]
        for k in others.tolist():
            depth, direction, middle = overlap(parts[i], parts[k])
            if not 1e-7 < depth / min(size[i], size[k]) <= DRESSED:
                continue
            for one, up in ((i, -direction), (k, direction)):
                parts[one], outer[one] = _cut_back(parts[one], outer[one], (parts[one] - middle) @ up)


def _cut_back(polygon: np.ndarray, mask: np.ndarray, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A convex part without what has a negative `side`, a linear function of the place; the new edge is an outer one."""
    kept, outer = [], []
    for k in range(len(polygon)):
        after = (k + 1) % len(polygon)
        if side[k] >= 0.0:
            kept.append(polygon[k])
            outer.append(bool(mask[k]) or (side[k] == 0.0 and side[after] < 0.0))
        if side[k] * side[after] < 0.0:
            kept.append(polygon[k] + side[k] / (side[k] - side[after]) * (polygon[after] - polygon[k]))
            outer.append(bool(mask[k]) or side[k] > 0.0)
    shape = np.array(kept)
    apart = np.hypot(*(np.roll(shape, -1, axis=0) - shape).T) > 1e-9 * float(np.ptp(shape, axis=0).max())
    return shape[apart], np.array(outer)[apart]


def _faces(assembly: Assembly) -> np.ndarray:
    """For each joint the point and the unit normal of the line that it lies in (joints, 2, 2): its own, or one line for all
    joints in one face of a stone, along which a survey has them nearly."""
    lines = np.stack([assembly.p, assembly.normal], axis=1)
    leader = list(range(len(lines)))

    def first(j: int) -> int:
        while leader[j] != j:
            leader[j] = leader[leader[j]]
            j = leader[j]
        return j

    for i in range(len(assembly.mass)):
        mine = np.flatnonzero((assembly.a == i) | (assembly.b == i)).tolist()
        up = {j: assembly.normal[j] if assembly.a[j] == i else -assembly.normal[j] for j in mine}
        for j, k in itertools.combinations(mine, 2):
            ends = np.array([assembly.p[k], assembly.q[k]]) - assembly.p[j]
            small = 2.0 * SURVEYED * max(assembly.length[j], assembly.length[k])
            if up[j] @ up[k] > 1.0 - DRESSED**2 and np.abs(ends @ up[j]).max() < small:
                leader[first(k)] = first(j)
    together: dict[int, list[int]] = {}
    for j in range(len(lines)):
        together.setdefault(first(j), []).append(j)
    for joints in together.values():
        if len(joints) == 1:
            continue
        ends = np.concatenate([assembly.p[joints], assembly.q[joints]])
        middle = ends.mean(axis=0)
        across = np.linalg.svd(ends - middle)[2][1]
        off = np.abs((ends - middle) @ across).max()
        if 1e-6 * assembly.length[joints].min() < off < DRESSED * assembly.length[joints].min():
            lines[joints, 0] = middle
            lines[joints, 1] = across * np.sign(assembly.normal[joints] @ across)[:, None]
    return lines


def _dressed(assembly: Assembly, lines: np.ndarray, i: int) -> np.ndarray:
    """Outline of block i with its faces taken to the lines of the joints in them: in a survey a face measured at several
    points is bent, and a joint lies midway between two faces that gape or overlap. What is drawn exactly stays as it is."""
    outline = np.asarray(assembly.outlines[i], dtype=float)
    for j in np.flatnonzero((assembly.a == i) | (assembly.b == i)).tolist():
        beside = (outline - lines[j, 0]) @ lines[j, 1]
        along = (outline - assembly.p[j]) @ assembly.tangent[j] / assembly.length[j]
        small = np.abs(beside) / assembly.length[j]
        near = (small > 1e-6) & (small < DRESSED) & (along > -DRESSED) & (along < 1.0 + DRESSED)
        outline = np.where(near[:, None], outline - beside[:, None] * lines[j, 1], outline)
    return outline if np.array_equal(outline, assembly.outlines[i]) else _straightened(outline)


def _straightened(outline: np.ndarray) -> np.ndarray:
    """An outline without the vertices that lie on the line between their neighbours as nearly as a survey knows: two parts
    touch along one edge of each."""
    outline = clean(outline)
    while len(outline) > 3:
        before, after = np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0)
        chord, arm = after - before, outline - before
        length = np.hypot(*chord.T)
        away = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / length
        k = int(np.argmin(away / length))
        if away[k] > SURVEYED * length[k]:
            break
        outline = np.delete(outline, k, axis=0)
    return outline


def _on_edges(polygon: np.ndarray, points: np.ndarray, share: float = 1e-6) -> np.ndarray:
    """Which points lie on which edges of a polygon, within a share of its longest edge: (edges, points)."""
    edge = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(*edge.T)[:, None]
    away = points[None] - polygon[:, None]
    along = (away * edge[:, None]).sum(axis=2) / length
    across = (edge[:, None, 0] * away[..., 1] - edge[:, None, 1] * away[..., 0]) / length
    small = share * float(length.max())
    return (np.abs(across) < small) & (along > -small) & (along < length + small)


def _joints_on(assembly: Assembly, i: int, polygon: np.ndarray) -> bool:
    """Do all joints of block i lie on the polygon's edges, as nearly as a survey knows?"""
    mine = np.flatnonzero((assembly.a == i) | (assembly.b == i))
    ends = np.concatenate([assembly.p[mine], assembly.q[mine]])
    return bool(_on_edges(polygon, ends, SURVEYED).any(axis=0).all())


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
    """Joints to the ground, those together that share a footing: on one line, and near enough for their footings to meet."""
    lines: list[list[int]] = []
    for j in np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND)).tolist():
        meeting = [line for line in lines if any(_share_a_footing(assembly, j, k) for k in line)]
        lines = [line for line in lines if line not in meeting]
        lines.append(sorted([j, *(k for line in meeting for k in line)]))
    return sorted(lines)


def _share_a_footing(assembly: Assembly, i: int, j: int) -> bool:
    """Do the footings of two joints to the ground meet on one line?"""
    up = _inward(assembly, i)
    size = max(assembly.length[i], assembly.length[j])
    if up @ _inward(assembly, j) < 1.0 - 1e-9 or abs((assembly.p[j] - assembly.p[i]) @ up) > 1e-6 * size:
        return False
    along = np.array([up[1], -up[0]])
    ends = [np.sort(np.array([assembly.p[k], assembly.q[k]]) @ along) for k in (i, j)]
    apart = max(ends[0][0], ends[1][0]) - min(ends[0][1], ends[1][1])
    return bool(apart < FOOTING * (assembly.length[i] + assembly.length[j]))


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
    """The footing of the joints of one line, a little wider than they are where the other blocks allow; and whether they
    allow any."""
    up = _inward(assembly, line[0])
    along = np.array([up[1], -up[0]])
    origin = assembly.p[line[0]]
    ends = np.stack([assembly.p[line], assembly.q[line]], axis=1) @ along - origin @ along
    extent = float(np.ptp(np.concatenate(blocks), axis=0).max())
    deep = 0.25 * extent if up[1] > 1.0 - 1e-9 else 0.5 * float(np.ptp(ends))
    for share in (FOOTING, 0.0):
        margin = share * assembly.length[line]
        low, high = float((ends.min(axis=1) - margin).min()), float((ends.max(axis=1) + margin).max())
        a, b = origin + low * along, origin + high * along
        polygon = np.array([a - deep * up, b - deep * up, b, a])
        if area(polygon) < 0.0:
            polygon = polygon[::-1]
        if all(overlap_depth(polygon, block) < DRESSED * np.sqrt(area(block)) for block in blocks):
            return polygon, True
    return polygon, False


def _floor(assembly: Assembly, level: float, footings: list[np.ndarray]) -> list[np.ndarray]:
    """A wide floor below the structure: the rectangles that it leaves between footings whose tops lie in it."""
    points = np.concatenate(assembly.outlines)
    middle, extent = 0.5 * (points[:, 0].min() + points[:, 0].max()), float(np.ptp(points, axis=0).max())
    taken = sorted(
        (float(polygon[:, 0].min()), float(polygon[:, 0].max()))
        for polygon in footings
        if (np.abs(polygon[:, 1] - level) < 1e-6 * extent).sum() == 2 and polygon[:, 1].max() < level + 1e-6 * extent
    )
    left, pieces = middle - 12.0 * extent, []
    for low, high in [*taken, (middle + 12.0 * extent, np.inf)]:
        if low - left > 1e-6 * extent:
            pieces.append(
                np.array([[left, level - 0.25 * extent], [low, level - 0.25 * extent], [low, level], [left, level]])
            )
        left = max(left, high)
    return pieces
