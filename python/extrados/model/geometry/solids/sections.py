"""Plane assemblies seen as solids: their sections, in x and z, drawn out across to their depth in y."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from extrados.model.errors import NoView
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.convex import clean, convex_parts
from extrados.model.geometry.polygons import following
from extrados.model.geometry.solids.assembly import SolidAssembly, joint_names
from extrados.model.geometry.solids.polyhedra import Polyhedron, inertia_of, prism

#: The section's x, y and the way across become x, z and y; turned so that the frame stays right-handed.
RISEN = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def drawn_out(assembly: Assembly) -> SolidAssembly:
    """The solids of a plane assembly, from -depth/2 to depth/2 across; its joints are the contacts, so that limit analysis
    in the plane and in space ask for the same forces. NoView where earth pushes back, which is known in the plane alone."""
    if assembly.earth is not None:
        raise NoView(
            "the fill of a bridge is modelled only in the plane section, and `direction` requires an analysis in space: remove `direction`",
            ("analysis", "direction"),
        )
    half = 0.5 * assembly.depth
    parts, owner, inertia = [], [], []
    for i, outline in enumerate(assembly.outlines):
        pieces = convex_parts(clean(outline))
        parts += [prism(piece, -half, half).moved(RISEN) for piece, _ in pieces]
        owner += [i] * len(pieces)
        inertia.append(_inertia(outline, assembly.mass[i], assembly.inertia[i], assembly.depth))
    p, q = (np.insert(ends, 1, 0.0, axis=1) for ends in (assembly.p, assembly.q))
    normal = np.insert(assembly.normal, 1, 0.0, axis=1)
    across = np.array([0.0, half, 0.0])
    polygon = []
    for one, two, n in zip(p, q, normal, strict=True):
        corners = np.array([one - across, two - across, two + across, one + across])
        way = np.cross(corners[1] - corners[0], corners[2] - corners[1]) @ n
        polygon.append(corners if way > 0.0 else corners[::-1])
    fill = np.empty((0, 5))
    if assembly.fill is not None:
        bears = np.flatnonzero(assembly.fill[:, 0] > 0.0)
        mass, x, z = assembly.fill[bears].T
        fill = np.column_stack([bears, mass, x, np.zeros(len(bears)), z])
    return SolidAssembly(
        parts=parts,
        owner=np.array(owner),
        mass=assembly.mass,
        inertia=np.array(inertia),
        centroid=np.insert(assembly.centroid, 1, 0.0, axis=1),
        polygon=polygon,
        normal=normal,
        a=assembly.a,
        b=assembly.b,
        block_names=assembly.block_names,
        joint_names=assembly.joint_names,
        fill=fill,
        groups=assembly.groups,
        measures=assembly.measures,
        remarks=assembly.remarks,
        notes=assembly.notes,
    )


def barrel(section: Assembly, stones_across: int = 1, skew: float = 0.0) -> SolidAssembly:
    """The barrel of an arch, its voussoirs divided across the depth and set off by half in every other course, sheared in
    plan by a skew [rad] (the voussoirs' joints stay along the springings: a false skew arch).

    Under such a shear forces in equilibrium stay so, for it turns forces and their places alike.
    """
    whole = drawn_out(section)
    shear = np.array([[1.0, 0.0, 0.0], [np.tan(skew), 1.0, 0.0], [0.0, 0.0, 1.0]])
    if stones_across > 1:
        whole = _divided(section, whole, stones_across)
    if not skew:
        return whole
    normal = whole.normal @ np.linalg.inv(shear)
    second = 0.5 * np.trace(whole.inertia, axis1=1, axis2=2)[:, None, None] * np.eye(3) - whole.inertia
    return replace(
        whole,
        parts=[part.moved(shear) for part in whole.parts],
        centroid=whole.centroid @ shear.T,
        inertia=inertia_of(shear @ second @ shear.T),
        polygon=[points @ shear.T for points in whole.polygon],
        normal=normal / np.linalg.norm(normal, axis=1)[:, None],
    )


def _divided(section: Assembly, whole: SolidAssembly, count: int) -> SolidAssembly:
    """The courses of a barrel as stones: `count` across the depth, and half ones at both ends of every other course."""
    depth, n = section.depth, len(section.mass)
    step = depth / count
    ends = [
        np.array([0.0, *(step * (np.arange(count) + 0.5)), depth]) - 0.5 * depth
        if i % 2
        else np.linspace(-0.5 * depth, 0.5 * depth, count + 1)
        for i in range(n)
    ]
    first = np.cumsum([0, *(len(e) - 1 for e in ends)])
    share = np.concatenate([np.diff(e) for e in ends]) / depth
    course = np.repeat(np.arange(n), [len(e) - 1 for e in ends])
    middle = np.concatenate([0.5 * (e[1:] + e[:-1]) for e in ends])
    parts, owner = [], []
    for part, i in zip(whole.parts, whole.owner, strict=True):
        for k, (low, high) in enumerate(pairwise(ends[i])):
            across = np.where(part.vertices[:, 1] < 0.0, low, high)
            parts.append(Polyhedron(np.column_stack([part.vertices[:, 0], across, part.vertices[:, 2]]), part.faces))
            owner.append(first[i] + k)
    polygon, normal, a, b = [], [], [], []

    def add(points: np.ndarray, across: np.ndarray, one: int, two: int) -> None:
        way = np.cross(points[1] - points[0], points[2] - points[1]) @ across
        polygon.append(points if way > 0.0 else points[::-1])
        normal.append(across)
        a.append(one)
        b.append(two)

    for p, q, n3, one, two in zip(section.p, section.q, whole.normal, section.a, section.b, strict=True):
        rows = [ends[i] if i != GROUND else np.array([-0.5, 0.5]) * depth for i in (one, two)]
        for k, (u, v) in enumerate(pairwise(rows[0])):
            for m, (s, t) in enumerate(pairwise(rows[1])):
                low, high = max(u, s), min(v, t)
                if high - low > 1e-9 * depth:
                    corners = [[p[0], low, p[1]], [q[0], low, q[1]], [q[0], high, q[1]], [p[0], high, p[1]]]
                    add(np.array(corners), n3, *(GROUND if i == GROUND else first[i] + j for i, j in ((one, k), (two, m))))
    for i in range(n):  # head joints; the face of a voussoir as the quadrilateral of its joints' ends
        here = np.flatnonzero((section.a == i) | (section.b == i))[:2]
        face = np.concatenate([[section.p[here[0]], section.q[here[0]]], [section.q[here[1]], section.p[here[1]]]])
        for k, y in enumerate(ends[i][1:-1], start=1):
            add(np.insert(face, 1, y, axis=1), np.array([0.0, 1.0, 0.0]), first[i] + k, first[i] + k - 1)
    names = [f"stone {k - first[i] + 1} of {section.block_names[i]}" for k, i in enumerate(course)]
    one, two = np.array(a), np.array(b)
    second = 0.5 * np.trace(whole.inertia, axis1=1, axis2=2)[:, None, None] * np.eye(3) - whole.inertia
    second = second[course] * share[:, None, None]
    second[:, 1, 1] *= share**2
    centroid = whole.centroid[course].copy()
    centroid[:, 1] = middle
    return replace(
        whole,
        parts=parts,
        owner=np.array(owner),
        mass=whole.mass[course] * share,
        centroid=centroid,
        inertia=inertia_of(second),
        polygon=polygon,
        normal=np.array(normal),
        a=one,
        b=two,
        block_names=names,
        joint_names=joint_names(names, one, two, np.array(normal)),
        groups={},
    )


def _inertia(outline: np.ndarray, mass: float, polar: float, depth: float) -> np.ndarray:
    """Inertia of a block drawn out across: about y as in the plane, about x and z in the proportion of its outline."""
    p = outline - outline.mean(axis=0)
    r = following(p)
    cross = p[:, 0] * r[:, 1] - p[:, 1] * r[:, 0]
    area = 0.5 * float(cross.sum())
    centre = ((p + r) * cross[:, None]).sum(axis=0) / (6.0 * area)
    second = sum(np.einsum("e,ei,ej->ij", cross, u, v) for u, v in ((p, p), (r, r), (p + r, p + r))) / 24.0
    second = second - area * np.outer(centre, centre)
    (xx, xz), (_, zz) = second * polar / np.trace(second)
    yy = mass * depth**2 / 12.0
    return inertia_of(np.array([[xx, 0.0, xz], [0.0, yy, 0.0], [xz, 0.0, zz]]))


def body(outline: np.ndarray, low: float, high: float) -> Polyhedron:
    """The prism over a convex outline (k, 2) of x and z, from y = low to y = high [m]."""
    return prism(outline, -high, -low).moved(RISEN)
