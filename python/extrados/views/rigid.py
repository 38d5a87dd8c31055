"""An assembly as rigid bodies made of convex parts, standing on supports of their own."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.contacts import shortest_joint
from extrados.model.geometry.convex import clean, convex_parts, crossings, hull, is_convex, overlap, overlap_depth, rounded
from extrados.model.geometry.mass import together
from extrados.model.geometry.polygons import crossing_edges, distance, following, inside
from extrados.model.geometry.polygons import signed_area as area
from extrados.views.blocks import Masonry

#: An outline is taken for its hull where that is bigger by no more than this, and no joint lies inside the hull:
#: the concave arc of a voussoir's intrados touches nothing.
HULL_EXCESS = 0.15
#: A footing is wider than the joint on it by this share of it on both sides, so that a block may slide a little. It is no
#: floor: what slides or falls farther finds one where the deck names it.
FOOTING = 0.25
#: Rounding, as a share of the size of the assembly: what lies nearer than this lies in the same place.
ROUNDING = 1e-9
#: Arcs that a structure kind draws by chords of its own overlap by less than this share of the size of a part.
CHORDS = 2e-3
#: Cosine of the angle below which two directions are those of one face (`contacts.SAME_WAY`).
ONE_FACE = 0.7


@dataclass(frozen=True)
class RigidBodies:
    """Bodies 0..count-1 are the blocks (or the groups of blocks), the rest supports of mass 0.

    parts[k] (vertices, 2) [m] belongs to body owner[k]; outer[k] masks its edges that lie on the outline.
    `body_of_block`: body of each block of the assembly; `joints`: bodies on both sides of each joint of the
    assembly (GROUND replaced by the support), or None where both are one body. `moved`: greatest distance by which a face
    was moved to the joint in it; `cut`: deepest overlap of two blocks that was cut back [m].
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
    moved: float = 0.0
    cut: float = 0.0

    def __repr__(self) -> str:
        return f"<RigidBodies: {self.count} bodies, {len(self.mass) - self.count} supports>"


def make_rigid(building: Masonry, groups: tuple[tuple[int, ...], ...], floor: float | None) -> "RigidBodies":
    """The blocks of a building as rigid bodies, their corners worn off as [joints] says."""
    return rigid_bodies(building.blocks(), groups, building.joints.worn_corners, floor)


def rigid_bodies(assembly: Assembly, groups: Sequence[Sequence[int]] = (), worn: float = 0.0, floor: float | None = None) -> RigidBodies:
    """Bodies of an assembly: `groups` of blocks move as one, corners are worn to a radius [m], a floor at a
    height [m] catches what falls. BadGeometry names a block that cannot be used.

    Blocks are as drawn. Within the tolerance of a survey faces are moved to the joints in them (`_dressed`)."""
    n = len(assembly.mass)
    body = _numbering(n, groups)
    count = int(body.max()) + 1
    mass, centroid, inertia = _lumped(assembly, body, count)
    names = [" + ".join(assembly.block_names[i] for i in np.flatnonzero(body == k)) for k in range(count)]
    parts, owner, outer = [], [], []
    lines = _faces(assembly)
    outlines = [_dressed(assembly, lines, i) for i in range(n)]
    moved = max((_apart_at_most(one, drawn) for one, drawn in zip(outlines, assembly.outlines, strict=True)), default=0.0)
    for i in range(n):
        for polygon, mask in _block_parts(assembly, outlines, i):
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
        raise BadGeometry("no block rests on the ground")
    cut = _cut_overlaps(parts, outer, owner, assembly.tolerance)
    middles = [polygon.mean(axis=0) for polygon in parts[len(stones) :]]
    if floor is not None:
        level = _floor(assembly, floor, parts[len(stones) :])
        for k, polygon in level.items():
            parts[len(stones) + k], outer[len(stones) + k] = polygon, np.ones(4, dtype=bool)
        if not level:
            parts.append(_rectangle(assembly, floor, -np.inf, np.inf))
            owner.append(len(names))
            outer.append(np.ones(4, dtype=bool))
            middles.append(parts[-1].mean(axis=0))
            names.append("floor")
    supports = len(names) - count
    joints: list[tuple[int, int] | None] = []
    for j, (a, b) in enumerate(zip(assembly.a.tolist(), assembly.b.tolist(), strict=True)):
        one, two = (support_of[j] if k == GROUND else int(body[k]) for k in (a, b))
        joints.append(None if one == two else (one, two))
    return RigidBodies(
        names,
        count,
        np.concatenate([centroid, np.reshape(middles, (supports, 2))]),
        np.concatenate([mass, np.zeros(supports)]),
        np.concatenate([inertia, np.zeros(supports)]),
        parts,
        owner,
        outer,
        body,
        joints,
        assembly.depth,
        moved,
        cut,
    )


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


def _block_parts(assembly: Assembly, outlines: list[np.ndarray], i: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Convex parts of block i with the masks of their outer edges."""
    name, outline = assembly.block_names[i], outlines[i]
    if len(outline) < 3 or abs(area(outline)) < 1e-12 * float(np.ptp(outline, axis=0).max()) ** 2:
        raise BadGeometry(f"{name}: its area is zero")
    crossing = crossing_edges(outline)
    if crossing is not None:
        raise BadGeometry(f"{name}: the outline crosses itself (edges from vertices {crossing[0] + 1} and {crossing[1] + 1})")
    outline = clean(outline)
    if is_convex(outline):
        return [(outline, np.ones(len(outline), dtype=bool))]
    wrap = hull(outline)
    if area(wrap) <= (1.0 + HULL_EXCESS) * area(outline) and _hollows_are_free(assembly, outlines, i, wrap):
        return [(wrap, np.ones(len(wrap), dtype=bool))]
    try:
        return convex_parts(outline)
    except ValueError as error:
        raise BadGeometry(f"{name}: {error}") from None


def _hollows_are_free(assembly: Assembly, outlines: list[np.ndarray], i: int, wrap: np.ndarray) -> bool:
    """Do all joints of block i lie on the edges of its hull, and is no other block in what the hull adds to it?"""
    small = max(assembly.tolerance, ROUNDING * assembly.size)
    mine = np.flatnonzero((assembly.a == i) | (assembly.b == i))
    ends = np.concatenate([assembly.p[mine], assembly.q[mine]])
    if not _on_edges(wrap, ends, small).any(axis=0).all():
        return False
    low, high, small = wrap.min(axis=0), wrap.max(axis=0), max(small, CHORDS * float(np.sqrt(area(wrap))))
    for k, other in enumerate(outlines):
        if k == i or (other.max(axis=0) <= low).any() or (other.min(axis=0) >= high).any():
            continue
        points = np.concatenate([other, 0.5 * (other + following(other))])
        points = points[inside(wrap, points) & ~inside(outlines[i], points)]
        if len(points) and distance(wrap, points).max() > small:
            return False
    return True


def _cut_overlaps(parts: list[np.ndarray], outer: list[np.ndarray], owner: list[int], tolerance: float) -> float:
    """Cut back parts of different bodies that overlap as drawn, and return the deepest of those overlaps [m].

    Outlines that cross twice are cut along the line between the two places: each part loses no more than what lies in the
    other. Else each loses half along the edge of least overlap. In a survey overlaps up to its tolerance [m] are cut, else
    those by which chords of one arc differ; deeper overlaps stay: the drawing is wrong there.
    """
    low, high = (np.array([corner(p, axis=0) for p in parts]) for corner in (np.min, np.max))
    size = np.sqrt([area(p) for p in parts])
    body = np.array(owner)
    order = np.argsort(low[:, 0], kind="stable")
    last = np.searchsorted(low[order, 0], high[order, 0])
    deepest = 0.0
    for rank, i in enumerate(order.tolist()):
        others = order[rank + 1 : last[rank]]
        others = others[(low[others, 1] < high[i, 1]) & (high[others, 1] > low[i, 1]) & (body[others] != body[i])]
        for k in others.tolist():
            depth, direction, middle = overlap(parts[i], parts[k])
            small = min(size[i], size[k])
            if not 1e-7 * small < depth <= (tolerance or CHORDS * small):
                continue
            deepest = max(deepest, depth)
            if len(ends := crossings(parts[i], parts[k], 1e-9 * small)) == 2:
                middle, along = ends[0], (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
                across = np.array([-along[1], along[0]])
                direction = across * np.sign((parts[k].mean(axis=0) - parts[i].mean(axis=0)) @ across)
            for one, up in ((i, -direction), (k, direction)):
                parts[one], outer[one] = _cut_back(parts[one], outer[one], (parts[one] - middle) @ up)
    return deepest


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
    if not assembly.tolerance:
        return lines
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
            # A joint lies midway, so within half a tolerance of each face.
            if up[j] @ up[k] > ONE_FACE and np.abs(ends @ up[j]).max() < 2.0 * assembly.tolerance:
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
        if np.abs((ends - middle) @ across).max() <= assembly.tolerance:
            lines[joints, 0] = middle
            lines[joints, 1] = across * np.sign(assembly.normal[joints] @ across)[:, None]
    return lines


def _dressed(assembly: Assembly, lines: np.ndarray, i: int) -> np.ndarray:
    """Outline of block i as elements touch: in a survey its faces are moved to the lines of the joints in them, since a face
    measured at several points is bent, and a joint lies midway between two faces that gape or overlap.

    A vertex moves to the lines that it lies within the tolerance of: in the stretch of the joint, or at an end of an edge that
    runs along it; between the ends of a joint within the bend that `find_contacts` lets pass in a face. Without a tolerance
    the outline is as drawn.
    """
    drawn = np.asarray(assembly.outlines[i], dtype=float)
    if not (small := assembly.tolerance):
        return drawn
    bend = shortest_joint(small)
    mine = np.flatnonzero((assembly.a == i) | (assembly.b == i))
    length = assembly.length[mine]
    beside = np.einsum("vjx,jx->vj", drawn[:, None] - lines[mine, 0], lines[mine, 1])
    along = np.einsum("vjx,jx->vj", drawn[:, None] - assembly.p[mine], assembly.tangent[mine])
    close = np.abs(beside) <= small
    shared = np.minimum(np.maximum(along, following(along)), length) - np.maximum(np.minimum(along, following(along)), 0.0)
    edge = close & following(close) & (shared > np.minimum(bend, 0.5 * length))
    at_joint = edge | np.roll(edge, 1, axis=0) | (close & (along > -small) & (along < length + small))
    at_joint |= (np.abs(beside) <= bend) & (along > 0.0) & (along < length)
    outline = drawn.copy()
    for v in range(len(drawn)):
        near = np.flatnonzero(at_joint[v])
        kept: list[int] = []  # the nearest line, and that of another face where the vertex is a corner
        for j in near[np.argsort(np.abs(beside[v, near]), kind="stable")].tolist():
            if all(abs(lines[mine[j], 1] @ lines[mine[k], 1]) < ONE_FACE for k in kept):
                kept.append(j)
        if kept:
            outline[v] -= np.linalg.lstsq(lines[mine[kept[:2]], 1], beside[v, kept[:2]], rcond=None)[0]
    return _straightened(outline, small)


def _straightened(outline: np.ndarray, small: float) -> np.ndarray:
    """An outline without vertices that lie on the line between their neighbours to within `small` [m], and no vertex left out
    farther than that from the outline: two parts touch along one edge of each."""
    outline = clean(outline)
    kept = list(range(len(outline)))
    while len(kept) > 3:
        away = [np.inf] * len(kept)
        for k in range(len(kept)):
            begin, end = kept[k - 1], kept[(k + 1) % len(kept)]
            before, chord, after = (outline[kept[k]] - outline[begin], outline[end] - outline[begin], outline[end] - outline[kept[k]])
            if before @ after > ONE_FACE * np.hypot(*before) * np.hypot(*after):
                between = outline[np.arange(begin + 1, begin + 1 + (end - begin - 1) % len(outline)) % len(outline)]
                arm = between - outline[begin]
                away[k] = float(np.abs(chord[0] * arm[:, 1] - chord[1] * arm[:, 0]).max() / np.hypot(*chord))
        k = int(np.argmin(away))
        if away[k] > small:
            break
        del kept[k]
    return outline[kept]


def _apart_at_most(one: np.ndarray, drawn: np.ndarray) -> float:
    """Greatest distance of the vertices of two outlines of a block from the edges of the other [m]."""
    if one is drawn or np.array_equal(one, drawn):
        return 0.0
    return float(max(distance(drawn, one).max(), distance(one, drawn).max()))


def _on_edges(polygon: np.ndarray, points: np.ndarray, small: float) -> np.ndarray:
    """Which points lie on which edges of a polygon, to within `small` [m]: (edges, points)."""
    edge = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(*edge.T)[:, None]
    away = points[None] - polygon[:, None]
    along = (away * edge[:, None]).sum(axis=2) / length
    across = (edge[:, None, 0] * away[..., 1] - edge[:, None, 1] * away[..., 0]) / length
    return (np.abs(across) < small) & (along > -small) & (along < length + small)


def _glued(assembly: Assembly, body: np.ndarray, i: int, polygon: np.ndarray) -> np.ndarray:
    """Edges of a part of block i that are joints to a block of the same body."""
    inner = [
        j
        for j in np.flatnonzero((assembly.a == i) | (assembly.b == i))
        if assembly.a[j] != GROUND and assembly.b[j] != GROUND and body[assembly.a[j]] == body[assembly.b[j]]
    ]
    if not inner:
        return np.zeros(len(polygon), dtype=bool)
    small = max(assembly.tolerance, 1e-6 * float(np.ptp(polygon, axis=0).max()))
    return (_on_edges(polygon, assembly.p[inner], small) & _on_edges(polygon, assembly.q[inner], small)).any(axis=1)


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
        if all(overlap_depth(polygon, block) <= (assembly.tolerance or CHORDS * np.sqrt(area(block))) for block in blocks):
            return polygon, True
    return polygon, False


def _floor(assembly: Assembly, level: float, footings: list[np.ndarray]) -> dict[int, np.ndarray]:
    """Footings whose tops lie in a floor, by their numbers, each as wide as the floor around it: to the middle between two of them, and
    beyond the outer ones. Between a footing and a floor beside it a block that slides would catch on the seam."""
    extent = float(np.ptp(np.concatenate(assembly.outlines), axis=0).max())
    flush = [
        k
        for k, polygon in enumerate(footings)
        if (np.abs(polygon[:, 1] - level) < 1e-6 * extent).sum() == 2 and polygon[:, 1].max() < level + 1e-6 * extent
    ]
    flush.sort(key=lambda k: float(footings[k][:, 0].min()))
    between = [0.5 * (float(footings[a][:, 0].max()) + float(footings[b][:, 0].min())) for a, b in itertools.pairwise(flush)]
    ends = [-np.inf, *between, np.inf]
    return {k: _rectangle(assembly, level, ends[i], ends[i + 1]) for i, k in enumerate(flush)}


def _rectangle(assembly: Assembly, level: float, low: float, high: float) -> np.ndarray:
    """Ground up to a level [m] from low to high [m], at most so far as blocks may go."""
    points = np.concatenate(assembly.outlines)
    middle, extent = 0.5 * (points[:, 0].min() + points[:, 0].max()), float(np.ptp(points, axis=0).max())
    left, right = max(low, middle - 12.0 * extent), min(high, middle + 12.0 * extent)
    foot = level - 0.25 * extent
    return np.array([[left, foot], [right, foot], [right, level], [left, level]])
