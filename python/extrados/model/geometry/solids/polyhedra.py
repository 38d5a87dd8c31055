"""Convex polyhedra: makers, cutting, mass properties, overlap. x and y are level, z is up."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

FLAT = 1e-7  # facets of a hull whose normals and offsets (over its size) differ less are one face

SAME_WAY = 0.7  # cosine of the angle by which parts of one measured face may differ

AT_ONCE = 2_000_000  # corners along axes that are looked at together


@dataclass(frozen=True)
class Polyhedron:
    """A convex body: vertices (n, 3) [m], and each face as the numbers of its vertices, counter-clockwise from outside."""

    vertices: np.ndarray
    faces: tuple[tuple[int, ...], ...]

    def __repr__(self) -> str:
        return f"<Polyhedron: {len(self.vertices)} vertices, {len(self.faces)} faces>"

    @cached_property
    def normals(self) -> np.ndarray:
        """Outward unit normals of the faces (nf, 3) (Newell's, which a vertex off the plane hardly turns)."""
        return self._newell / np.sqrt((self._newell * self._newell).sum(axis=1))[:, None]

    @cached_property
    def areas(self) -> np.ndarray:
        """Area of each face (nf) [m^2]."""
        return 0.5 * np.sqrt((self._newell * self._newell).sum(axis=1))

    @cached_property
    def _newell(self) -> np.ndarray:
        """Newell's vector of each face (nf, 3): twice its area, along its normal [m^2]."""
        arm = self.vertices[self.triangles] - self.vertices[self.triangles[:, :1]]
        x, y = arm[:, 1], arm[:, 2]
        across = x[:, [1, 2, 0]] * y[:, [2, 0, 1]] - x[:, [2, 0, 1]] * y[:, [1, 2, 0]]
        start = np.cumsum([0, *(len(face) - 2 for face in self.faces)])[:-1]
        return np.add.reduceat(across, start)

    @cached_property
    def offsets(self) -> np.ndarray:
        """Distance of each face from the origin along its normal (nf) [m]."""
        numbers, counts, first = self._corners
        heights = (self.vertices[numbers] * np.repeat(self.normals, counts, axis=0)).sum(axis=1)
        return np.add.reduceat(heights, first) / counts

    @cached_property
    def middles(self) -> np.ndarray:
        """Mean of the corners of each face (nf, 3) [m]."""
        numbers, counts, first = self._corners
        return np.add.reduceat(self.vertices[numbers], first, axis=0) / counts[:, None]

    @cached_property
    def widths(self) -> np.ndarray:
        """Area of each face over its diameter (nf) [m], which is twice the way from its middle to its farthest corner."""
        numbers, counts, first = self._corners
        arm = self.vertices[numbers] - np.repeat(self.middles, counts, axis=0)
        return 0.5 * self.areas / np.maximum.reduceat(np.linalg.norm(arm, axis=1), first)

    @cached_property
    def _corners(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The vertices of all faces in a row, how many each face has, and where it begins."""
        counts = np.array([len(face) for face in self.faces])
        return np.concatenate([np.array(face) for face in self.faces]), counts, np.cumsum([0, *counts[:-1]])

    @cached_property
    def triangles(self) -> np.ndarray:
        """The faces as fans of triangles (nt, 3), numbers of vertices."""
        return np.array([(f[0], b, c) for f in self.faces for b, c in itertools.pairwise(f[1:])], dtype=int)

    @cached_property
    def edges(self) -> np.ndarray:
        """Each edge once (ne, 2), numbers of vertices."""
        pairs = {(min(e), max(e)) for f in self.faces for e in zip(f, (*f[1:], f[0]), strict=True)}
        return np.array(sorted(pairs))

    @property
    def low(self) -> np.ndarray:
        """Least x, y, z [m]."""
        return self.vertices.min(axis=0)

    @property
    def high(self) -> np.ndarray:
        """Greatest x, y, z [m]."""
        return self.vertices.max(axis=0)

    def moved(self, matrix: np.ndarray, shift: np.ndarray | None = None) -> "Polyhedron":
        """The body under x -> matrix x + shift; a matrix that mirrors turns the faces round."""
        vertices = self.vertices @ np.asarray(matrix, dtype=float).T + (0.0 if shift is None else shift)
        mirrors = np.linalg.det(matrix) < 0.0
        return Polyhedron(vertices, tuple(f[::-1] for f in self.faces) if mirrors else self.faces)


def prism(outline: np.ndarray, low: float, high: float) -> Polyhedron:
    """The prism over a convex outline (k, 2) of x and y, either way round, from z = low to z = high [m]."""
    outline = np.asarray(outline, dtype=float)
    x, y = outline.T
    turn = float(x[:-1] @ y[1:] - y[:-1] @ x[1:] + x[-1] * y[0] - y[-1] * x[0])
    ring = outline if turn > 0.0 else outline[::-1]
    k = len(ring)
    vertices = np.concatenate([np.column_stack([ring, np.full(k, float(z))]) for z in (low, high)])
    sides = tuple((i, (i + 1) % k, k + (i + 1) % k, k + i) for i in range(k))
    return Polyhedron(vertices, (tuple(range(k - 1, -1, -1)), tuple(range(k, 2 * k)), *sides))


def loft(below: np.ndarray, above: np.ndarray) -> Polyhedron:
    """The body between two convex polygons (k, 3) of as many corners, counter-clockwise from the side of `above`.

    Its sides must be plane: edges that belong together parallel, or meeting in one point.
    """
    k = len(below)
    sides = tuple((i, (i + 1) % k, k + (i + 1) % k, k + i) for i in range(k))
    return Polyhedron(np.concatenate([below, above]), (tuple(range(k - 1, -1, -1)), tuple(range(k, 2 * k)), *sides))


class ManyFaces(ValueError):
    """A hull has more faces than were asked for."""


def hull(points: np.ndarray, flat: float = FLAT, most: float = np.inf) -> Polyhedron:
    """The convex hull of points (n, 3); facets that turn by less than `flat` are one face. ValueError where it has no volume,
    ManyFaces where it has more than `most`: their number times that of the facets is the work."""
    from scipy.spatial import ConvexHull, QhullError  # takes a third of a second to load, and few decks need a hull

    points = np.asarray(points, dtype=float)
    middle, size = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    try:
        found = ConvexHull((points - middle) / (size or 1.0))
    except QhullError:
        raise ValueError("all points lie in one plane") from None
    planes: np.ndarray = np.empty((0, 4))
    groups: list[list[int]] = []  # facets that lie in one plane
    for k, plane in enumerate(found.equations):
        near = np.flatnonzero(np.abs(planes - plane).max(axis=1, initial=0.0) < flat)
        if len(near):
            groups[near[0]].append(k)
        else:
            planes = np.vstack([planes, plane])
            groups.append([k])
            if len(planes) > most:
                raise ManyFaces(f"the convex hull has more than {most:g} faces")
    scaled = (points - middle) / (size or 1.0)
    faces = []
    for plane, facets in zip(planes, groups, strict=True):
        corners = np.unique(found.simplices[facets])
        normal = plane[:3]
        u = np.linalg.svd(normal[None])[2][1]
        arm = scaled[corners] - scaled[corners].mean(axis=0)
        faces.append(corners[np.argsort(np.arctan2(arm @ np.cross(normal, u), arm @ u))])
    used = np.unique(np.concatenate(faces))
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    return Polyhedron(points[used], tuple(tuple(number[f].tolist()) for f in faces))


def fitted(body: Polyhedron, within: float) -> Polyhedron:
    """The body with adjacent faces made one where all of their corners lie within a distance [m] of the plane fitted to them:
    the triangles of a measured face. No corner moves; those within a face are dropped.

    The least bent edges come first. Newell's vector of two faces together is the sum of theirs.
    """
    if within <= 0.0:
        return body
    beside = {edge: k for k, face in enumerate(body.faces) for edge in zip(face, (*face[1:], face[0]), strict=True)}
    pairs = np.array([(k, beside[j, i]) for (i, j), k in beside.items() if i < j and (j, i) in beside])
    bent = (body.normals[pairs[:, 0]] * body.normals[pairs[:, 1]]).sum(axis=1)
    vector = {k: normal for k, normal in enumerate(body.normals * body.areas[:, None])}
    group = list(range(len(body.faces)))
    members = {k: [k] for k in group}
    corners = {k: set(face) for k, face in enumerate(body.faces)}
    for one, two in pairs[np.argsort(-bent, kind="stable")][np.sort(-bent) < -SAME_WAY].tolist():
        a, b = group[one], group[two]
        if a == b:
            continue
        total, both = vector[a] + vector[b], corners[a] | corners[b]
        heights = body.vertices[list(both)] @ (total / np.linalg.norm(total))
        if np.abs(heights - heights.mean()).max() > within or _loop(body, [*members[a], *members[b]]) is None:
            continue
        vector[a], corners[a] = total, both
        members[a] += members[b]
        for k in members.pop(b):
            group[k] = a
    loops = [loop for f in members.values() if (loop := _loop(body, f) if len(f) > 1 else body.faces[f[0]]) is not None]
    used = sorted({corner for loop in loops for corner in loop})  # a corner within a face is none any more
    number = {corner: k for k, corner in enumerate(used)}
    return Polyhedron(body.vertices[used], tuple(tuple(number[corner] for corner in loop) for loop in loops))


def _loop(body: Polyhedron, faces: list[int]) -> tuple[int, ...] | None:
    """The outline of faces that hang together; None where it is not one ring."""
    edges = {edge for k in faces for edge in zip(body.faces[k], (*body.faces[k][1:], body.faces[k][0]), strict=True)}
    rim = {i: j for i, j in edges if (j, i) not in edges}
    start = next(iter(rim), None)
    if start is None:
        return None
    ring = [start]
    while (here := rim.get(ring[-1])) not in (start, None) and len(ring) <= len(rim):
        ring.append(here)
    return tuple(ring) if len(ring) == len(rim) else None


def cut(body: Polyhedron, point: np.ndarray, normal: np.ndarray, slack: float = 1e-9) -> Polyhedron | None:
    """What of a body lies on the side of the plane through `point` that `normal` points to; None where nothing does.

    Vertices within `slack` of its size from the plane lie in it.
    """
    size = float(np.ptp(body.vertices, axis=0).max())
    side = (body.vertices - point) @ normal / np.linalg.norm(normal)
    side[np.abs(side) < slack * size] = 0.0
    if (side >= 0.0).all():
        return body
    if (side <= 0.0).all():
        return None
    i, j = body.edges.T
    crossed = side[i] * side[j] < 0.0
    i, j = i[crossed], j[crossed]
    new = body.vertices[i] + (side[i] / (side[i] - side[j]))[:, None] * (body.vertices[j] - body.vertices[i])
    return hull(np.concatenate([body.vertices[side >= 0.0], new]))


def box(low: Sequence[float], high: Sequence[float]) -> Polyhedron:
    """The box between two corners [m]."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return prism(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), z0, z1)


def moments(vertices: np.ndarray, triangles: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume [m^3], centroid (3) [m] and second moments about the centroid (3, 3), integral of x_i x_j [m^5], of the body
    within closed triangles, counter-clockwise from outside.

    Tetrahedra from one point (Tonon 2004): the second moments of each are those of its corners and its centroid.
    """
    origin = vertices.mean(axis=0)
    a, b, c = (vertices[triangles] - origin).transpose(1, 0, 2)
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = float(volume.sum())
    middle = 0.25 * (a + b + c)
    centroid = (volume[:, None] * middle).sum(axis=0) / total
    second = np.zeros((3, 3))
    for p in (a, b, c, 4.0 * middle):
        second += np.einsum("t,ti,tj->ij", volume / 20.0, p, p)
    return total, centroid + origin, second - total * np.outer(centroid, centroid)


def inertia_of(second: np.ndarray) -> np.ndarray:
    """Inertia tensor from second moments, both (..., 3, 3): trace on the diagonal less the moments."""
    trace = np.trace(second, axis1=-2, axis2=-1)
    return trace[..., None, None] * np.eye(3) - second


def overlap_depth(one: Polyhedron, other: Polyhedron) -> float:
    """How deep two bodies overlap [m]; negative: the gap along the best separating direction.

    Faces of both, then pairs of their edges (separating axes), which decide between bodies that pass edge over edge.
    """

    def depth(axes: np.ndarray) -> float:
        # as many at a time as have some millions of places of corners, so that the memory is bounded
        least = []
        for k in range(0, len(axes), at_once):
            p, q = one.vertices @ axes[k : k + at_once].T, other.vertices @ axes[k : k + at_once].T
            least.append(float(np.minimum(p.max(axis=0) - q.min(axis=0), q.max(axis=0) - p.min(axis=0)).min()))
        return min(least)

    at_once = max(1, AT_ONCE // max(len(one.vertices), len(other.vertices)))
    found = depth(np.concatenate([one.normals, other.normals]))
    if found <= 0.0:
        return found
    u = one.vertices[one.edges[:, 1]] - one.vertices[one.edges[:, 0]]
    v = other.vertices[other.edges[:, 1]] - other.vertices[other.edges[:, 0]]
    u, v = u / np.linalg.norm(u, axis=1)[:, None], v / np.linalg.norm(v, axis=1)[:, None]
    some = max(1, at_once // len(v))
    for k in range(0, len(u), some):
        axes = np.cross(u[k : k + some, None], v[None]).reshape(-1, 3)
        length = np.linalg.norm(axes, axis=1)
        axes = axes[length > 1e-6] / length[length > 1e-6, None]
        found = min(found, depth(axes)) if len(axes) else found
    return found
