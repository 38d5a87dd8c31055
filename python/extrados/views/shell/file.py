"""Shells in space from mesh files with groups, read by meshio (the extra `mesh`)."""

from typing import TYPE_CHECKING

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry, Key, blaming
from extrados.model.structures.walls import MeshFile, MeshGroup
from extrados.schema.constants import GRAVITY
from extrados.views.mesh.file import open_mesh
from extrados.views.mesh.options import LARGEST_MESH
from extrados.views.shell.mesh import Foot, ShellMesh, ShellPart, nodal_areas, pieces
from extrados.views.shell.options import ShellOptions

if TYPE_CHECKING:
    import meshio


#: Where a deck says what its groups are
GROUPS = ("structure", "groups")
KINDS = {"triangle": "T3", "quad": "Q4"}
PASSED_OVER = ("line", "line3", "vertex")
#: Cell data that number groups, of the formats that have no names: gmsh, medit, VTK
NUMBERED = ("gmsh:physical", "medit:ref", "CellEntityIds", "group", "material", "region")
#: Directions that a support holds
HOLDS = {"fixed": range(6), "pinned": range(3), "vertical": (2,)}
#: Distance of the corners of a quadrilateral from its plane, over its size, from which it is told
WARPED = 0.1
#: Area of a corner, over the square of the longest side, up to which an element is none
LEAST = 1e-9
#: Cosine of the angle at an edge below which two elements lie on each other
ON_EACH_OTHER = 1.0 - 1e-6
#: Nodes nearer to each other than this part of the size lie at one place
APART = 1e-6


def shell_of_file(building: Description, options: ShellOptions) -> ShellMesh:
    """Flat shells of a mesh file."""
    assert isinstance(building.structure, MeshFile)
    with blaming("file"):
        return read_shell(building.structure, building, options)


def open_shells(structure: MeshFile, building: Description, options: ShellOptions) -> "tuple[str, meshio.Mesh]":
    """Name and content of a file of shells; BadGeometry if it holds anything else, or too many."""
    for name in ("regions", "ties", "bars"):
        if getattr(structure, name):
            raise BadGeometry(
                f"the key `{name}` is only for a wall in a plane: remove it; `groups` gives the properties of parts of shells",
                ("structure", name),
            )
    file, mesh = open_mesh(structure, building)
    if options.size is not None:
        raise BadGeometry(f"{file}: the mesh file determines the elements: remove mesh.size", ("analysis", "mesh", "size"))
    if mesh.points.shape[1] != 3:
        raise BadGeometry(f"{file}: the points have {mesh.points.shape[1]} coordinates; shells in space require 3")
    for cells in mesh.cells:
        if cells.type not in KINDS and cells.type not in PASSED_OVER:
            raise BadGeometry(f"{file}: this file has cells of kind '{cells.type}'; expected {' and '.join(KINDS)}")
    count = sum(len(cells.data) for cells in mesh.cells if cells.type in KINDS)
    if not count:
        raise BadGeometry(f"{file}: this file contains no shells; expected cells of kind {' or '.join(KINDS)}")
    if count > LARGEST_MESH:
        raise BadGeometry(f"{file}: this file has {count} elements; at most {LARGEST_MESH:g} are allowed")
    return file, mesh


def read_shell(structure: MeshFile, building: Description, options: ShellOptions) -> ShellMesh:
    """The triangles and quadrilaterals of a file with what its groups say; BadGeometry names file, group and what fits."""
    file, mesh = open_shells(structure, building, options)
    xyz = structure.scale * np.asarray(mesh.points, dtype=float)
    shells = {b: np.asarray(cells.data).astype(int) for b, cells in enumerate(mesh.cells) if cells.type in KINDS}
    for connect in shells.values():
        _check_corners(xyz, connect, file)
    _check_overlaps(xyz, list(shells.values()), file)
    known = _groups(mesh)
    there = ", ".join(sorted(known)) or "no groups"
    names = list(building.materials)
    thickness = {b: np.full(len(c), structure.thickness) for b, c in shells.items()}
    material = {b: np.zeros(len(c), dtype=int) for b, c in shells.items()}
    linear = {b: np.zeros(len(c), dtype=bool) for b, c in shells.items()}
    bends = {b: np.ones(len(c), dtype=bool) for b, c in shells.items()}
    owner = {b: np.full(len(c), -1) for b, c in shells.items()}
    push = np.zeros((len(xyz), 3))
    held: set[tuple[int, int]] = set()
    feet: list[Foot] = []
    middle = xyz[np.unique(np.concatenate([c.ravel() for c in shells.values()]))].mean(axis=0)
    for g, group in enumerate(structure.groups):
        what = f"{file}, group '{group.name}'"
        if group.name not in known:
            raise BadGeometry(f"{what}: the file has no such group; its groups are {there}", (*GROUPS, g, "name"))
        cells_of, nodes = known[group.name]
        own = {b: rows for b, rows in cells_of.items() if b in shells}
        _check(group, what, bool(own), (*GROUPS, g))
        for b, rows in own.items():
            owner[b][rows] = g
            if group.thickness is not None:
                thickness[b][rows] = group.thickness
            if group.material is not None:
                if group.material not in names:
                    raise BadGeometry(f"{what}: the deck has no [materials.{group.material}]", (*GROUPS, g, "material"))
                material[b][rows] = 1 + names.index(group.material)
            linear[b][rows] |= group.linear or group.membrane
            bends[b][rows] &= not group.membrane
            if group.pressure is not None:
                connect = shells[b][rows]
                np.add.at(push, connect, nodal_areas(xyz, connect)[..., None] * np.asarray(group.pressure))
        if group.force is not None:
            push[nodes] += np.asarray(group.force) / len(nodes)
        if group.support is not None:
            held |= {(int(n), d) for n in nodes for d in HOLDS[group.support]}
            feet.append(_foot(group.name, nodes, xyz, middle))
    if not held:
        raise BadGeometry(f"{file}: the structure has no support: give a group `support`; the groups are {there}")
    parts: list[ShellPart] = []
    warnings: list[str] = []
    for b, connect in shells.items():
        if (warped := _warping(xyz, connect)) > WARPED:
            warnings.append(f"{file}: corners of quadrilaterals are out of their plane by up to {warped:.2g} of their size")
        for g in np.unique(owner[b]):
            for bent in (True, False):
                rows = np.flatnonzero((owner[b] == g) & (bends[b] == bent))
                if len(rows):
                    parts.append(
                        ShellPart(
                            structure.groups[g].name if g >= 0 else "shell",
                            KINDS[mesh.cells[b].type],
                            connect[rows],
                            thickness[b][rows],
                            material[b][rows],
                            linear[b][rows],
                            np.ones(len(rows)),
                            bends=bent,
                        )
                    )
    return _mesh(building, xyz, parts, held, feet, push, warnings, file)


def _groups(mesh: "meshio.Mesh") -> dict[str, tuple[dict[int, np.ndarray], np.ndarray]]:
    """By name of a group its cells, by block of cells, and its nodes."""
    cells: dict[str, dict[int, np.ndarray]] = {}
    for name, sets in mesh.cell_sets.items():
        if not name.startswith("gmsh:"):
            cells[name] = {b: np.asarray(rows, dtype=int) for b, rows in enumerate(sets) if rows is not None and len(rows)}
    # Names of numbers, each of one dimension
    words = {(int(v[0]), int(v[1])): name for name, v in mesh.field_data.items() if np.size(v) == 2}
    for field in NUMBERED:
        for b, values in enumerate(mesh.cell_data.get(field, [])):
            values = np.asarray(values)
            if values.ndim != 1 or not np.array_equal(values, np.rint(values)):
                continue
            kind = mesh.cells[b].type
            dimension = 2 if kind in KINDS else 0 if kind == "vertex" else 1
            for number in np.unique(values).astype(int).tolist():
                name = words.get((number, dimension), str(number))
                cells.setdefault(name, {})[b] = np.flatnonzero(values == number)
    found = {}
    for name, of in cells.items():
        if of:
            nodes = [np.ravel(np.asarray(mesh.cells[b].data)[rows]) for b, rows in of.items()]
            found[name] = (of, np.unique(np.concatenate(nodes)).astype(int))
    for name, points in mesh.point_sets.items():
        found.setdefault(name, ({}, np.unique(np.asarray(points, dtype=int))))
    return found


def _check(group: MeshGroup, what: str, elements: bool, key: Key) -> None:
    """BadGeometry where a group of lines or points is told what only elements have, or nothing is said."""
    told = [key for key in ("thickness", "material", "linear", "membrane", "pressure") if getattr(group, key)]
    if told and not elements:
        raise BadGeometry(
            f"{what}: `{told[0]}` is a key for elements, but this group has no elements: give only the keys `support` and `force`",
            (*key, told[0]),
        )
    if not (told or group.support or group.force):
        raise BadGeometry(
            f"{what}: this group has no properties; expected thickness, material, linear, membrane, support, pressure or force", key
        )


def _foot(name: str, nodes: np.ndarray, xyz: np.ndarray, middle: np.ndarray) -> Foot:
    """A support as ground that may give way: outward is away from the middle of all, the same for all of its nodes."""
    way = xyz[nodes].mean(axis=0) - middle
    way[2] = 0.0
    length = float(np.linalg.norm(way))
    out = way / length if length > 1e-9 * float(np.ptp(xyz, axis=0).max()) else np.zeros(3)
    return Foot(name, nodes, np.tile(out, (len(nodes), 1)), np.arange(len(nodes), dtype=float))


def _nodes_told(nodes: np.ndarray) -> str:
    return ", ".join(str(n + 1) for n in nodes)


def _check_corners(xyz: np.ndarray, connect: np.ndarray, file: str) -> None:
    """BadGeometry where an element names a node twice, has no area, folds over itself or turns inward at a corner."""
    word = "triangle" if connect.shape[1] == 3 else "quadrilateral"
    c = xyz[connect]
    twice = (np.diff(np.sort(connect, axis=1), axis=1) == 0).any(axis=1)
    side = np.roll(c, -1, axis=1) - c
    at = np.cross(np.roll(side, 1, axis=1), side)  # twice the area of the triangle at each corner
    normal = at.sum(axis=1)
    size = np.linalg.norm(side, axis=2).max(axis=1)
    flat = np.linalg.norm(normal, axis=1) <= LEAST * size**2
    unit = normal / np.where(flat, 1.0, np.linalg.norm(normal, axis=1))[:, None]
    inward = (np.einsum("ecx,ex->ec", at, unit) <= LEAST * size[:, None] ** 2).any(axis=1)
    for wrong, what in (
        (twice, f"has the same node twice; expected {connect.shape[1]} different nodes"),
        (flat, "has no area"),
        (inward, "overlaps itself, or has an angle of 180 degrees or more at a corner; expected its corners in order, all convex"),
    ):
        if wrong.any():
            e = int(wrong.argmax())
            x, y, z = c[e].mean(axis=0)
            more = f" ({int(wrong.sum())} such elements)" if wrong.sum() > 1 else ""
            raise BadGeometry(f"{file}: a {word} of nodes {_nodes_told(connect[e])}, at x {x:.4g}, y {y:.4g}, z {z:.4g} m, {what}{more}")


def _check_overlaps(xyz: np.ndarray, shells: list[np.ndarray], file: str) -> None:
    """BadGeometry where two elements lie on the same side of an edge, in one plane: they would bear and weigh twice."""
    edge, inward = [], []
    for connect in shells:
        a, b = connect, np.roll(connect, -1, axis=1)
        way = xyz[b] - xyz[a]
        into = xyz[connect].mean(axis=1, keepdims=True) - xyz[a]
        into = into - (np.einsum("ecx,ecx->ec", into, way) / np.einsum("ecx,ecx->ec", way, way))[..., None] * way
        edge.append(np.sort(np.stack([a, b], axis=-1).reshape(-1, 2), axis=1))
        inward.append((into / np.linalg.norm(into, axis=2)[..., None]).reshape(-1, 3))
    edges, into = np.concatenate(edge), np.concatenate(inward)
    order = np.lexsort(edges.T)
    edges, into = edges[order], into[order]
    for step in range(1, int(np.unique(edges, axis=0, return_counts=True)[1].max())):
        same = (edges[step:] == edges[:-step]).all(axis=1)
        on = same & (np.einsum("ex,ex->e", into[step:], into[:-step]) > ON_EACH_OTHER)
        if on.any():
            nodes = edges[:-step][on.argmax()]
            x, y, z = xyz[nodes].mean(axis=0)
            raise BadGeometry(
                f"{file}: two elements overlap at the edge of nodes {_nodes_told(nodes)}, at x {x:.4g}, y {y:.4g}, z {z:.4g} m; "
                "expected one element at each place"
            )


def _unjoined(xyz: np.ndarray, parts: list[ShellPart], size: float) -> list[str]:
    """What to tell of nodes at which elements touch and do not hang together."""
    from scipy.spatial import cKDTree

    edges = np.concatenate([np.stack([p.connect, np.roll(p.connect, -1, axis=1)], axis=-1).reshape(-1, 2) for p in parts])
    each, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    free = each[count == 1]
    if not len(free):
        return []
    ends = np.unique(free)
    tree, near = cKDTree(xyz[ends]), APART * size
    told = []
    pairs = tree.query_pairs(near, output_type="ndarray")
    if len(pairs):
        a, b = ends[pairs[0]]
        told.append((f"nodes {a + 1} and {b + 1}", xyz[a], "are two nodes at the same position", len(pairs)))
    a, b = xyz[free[:, 0]], xyz[free[:, 1]]
    middle, way, length = 0.5 * (a + b), b - a, np.linalg.norm(b - a, axis=1)
    between = [
        (edge, node)
        for edge, found in enumerate(tree.query_ball_point(middle, 0.5 * length - near))
        for node in ends[found].tolist()
        if np.linalg.norm(np.cross(xyz[node] - a[edge], way[edge])) <= near * length[edge]
    ]
    if between:
        node = between[0][1]
        nodes = len({n for _, n in between})
        told.append((f"node {node + 1}", xyz[node], "lies on the edge of an element and is not one of its corners", nodes))
    return [
        (
            f"{who}, at x {at[0]:.4g}, y {at[1]:.4g}, z {at[2]:.4g} m, {what}{f' ({many} such)' if many > 1 else ''}: the "
            "elements are not connected there"
        )
        for who, at, what, many in told
    ]


def _warping(xyz: np.ndarray, connect: np.ndarray) -> float:
    """Greatest distance of a corner from the plane of its quadrilateral, over the root of its area."""
    if connect.shape[1] < 4:
        return 0.0
    c = xyz[connect]
    normal = np.cross(c[:, 2] - c[:, 0], c[:, 3] - c[:, 1])
    double = np.linalg.norm(normal, axis=1)
    away = np.abs(np.einsum("ex,ex->e", normal, c[:, 0] - c.mean(axis=1)))
    fine = double > 0.0
    return float((away[fine] / double[fine] / np.sqrt(0.5 * double[fine])).max(initial=0.0))


def _mesh(
    building: Description,
    xyz: np.ndarray,
    parts: list[ShellPart],
    held: set[tuple[int, int]],
    feet: list[Foot],
    push: np.ndarray,
    warnings: list[str],
    file: str,
) -> ShellMesh:
    """The mesh of the nodes that its elements have; nodes of membranes alone move in their plane, which is level."""
    used, bent = np.zeros(len(xyz), dtype=bool), np.zeros(len(xyz), dtype=bool)
    for part in parts:
        used[part.connect] = True
        if part.bends:
            bent[part.connect] = True
        elif np.ptp(xyz[part.connect][..., 2], axis=1).max() > 1e-6 * np.ptp(xyz, axis=0).max():
            raise BadGeometry(f"{file}, group '{part.name}': a membrane must be horizontal, and its elements are not")
    _to_the_rim(building, xyz, parts, bent, push, file)
    lonely = sorted(n for n, _ in held if not used[n])
    if lonely:
        raise BadGeometry(f"{file}: node {lonely[0] + 1} of a support is not a node of a shell")
    if push[~used].any():
        raise BadGeometry(f"{file}: a force acts on a node that is not a node of a shell")
    support, of_file = sorted(held), parts
    held |= {(int(n), d) for n in np.flatnonzero(used & ~bent) for d in (2, 3, 4, 5)}
    number = np.cumsum(used) - 1
    kept = xyz[used]
    parts = [ShellPart(**{**part.__dict__, "connect": number[part.connect]}) for part in parts]
    feet = [Foot(foot.name, number[foot.nodes], foot.out, foot.along) for foot in feet]
    areas = np.concatenate([nodal_areas(kept, part.connect).sum(axis=1) for part in parts])
    size = float(np.sqrt(np.median(areas)))
    loose = _unjoined(xyz, of_file, size)
    warnings += [f"{file}: {text}" for text in loose]
    piece = pieces(len(kept), parts, [])
    stands = np.isin(piece, piece[[number[n] for n, _ in support]])
    if not stands.all():
        x, y, z = kept[~stands].mean(axis=0)
        raise BadGeometry(
            f"{file}: {int((~stands).sum())} nodes around x {x:.4g}, y {y:.4g}, z {z:.4g} m are not supported: no elements connect them "
            f"with a support{f'; {loose[0]}' if loose else ''}"
        )
    levels = np.array([kept[:, 2].min(), kept[:, 2].max()])
    if not levels[1] > levels[0]:
        raise BadGeometry(f"{file}: all nodes have the same height, but z must point up")
    return ShellMesh(
        kept,
        parts,
        [],
        levels,
        [building.material, *building.materials.values()],
        size,
        sorted((int(number[n]), d) for n, d in held),
        [],
        [],
        np.zeros(len(kept)),
        push[used],
        warnings,
        feet,
    )


def _to_the_rim(building: Description, xyz: np.ndarray, parts: list[ShellPart], bent: np.ndarray, push: np.ndarray, file: str) -> None:
    """What weighs on the inner nodes of membranes goes to their nodes on walls, by the area that these stand for: a membrane
    does not bend, its inner nodes are held upright."""
    density = np.array([m.density for m in (building.material, *building.materials.values())])
    for part in parts:
        if part.bends:
            continue
        share = nodal_areas(xyz, part.connect)
        own, weight = np.zeros(len(xyz)), np.zeros(len(xyz))
        np.add.at(own, part.connect, share)
        np.add.at(weight, part.connect, GRAVITY * share * (density[part.material] * part.thickness)[:, None])
        inner, rim = (own > 0.0) & ~bent, (own > 0.0) & bent
        if not rim.any():
            raise BadGeometry(f"{file}, group '{part.name}': the membrane is not connected to a wall")
        down = float((push[inner, 2] - weight[inner]).sum())
        push[inner, 2] = 0.0
        push[rim, 2] += down * own[rim] / own[rim].sum()
