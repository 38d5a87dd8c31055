"""Finite elements of buildings of stones: every stone meshed, along every joint an interface of no thickness.

The nodes along a joint are laid once and serve both of its stones, each with nodes of its own: pairs at the same place.
Rows of elements instead (`joints = "rows"`) fill a gap: each stone draws back from its joints by half their thickness (by
all of it on the ground). Where more than two stones meet nothing ties them.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.earth import passive_left_out
from extrados.model.geometry.polygons import following, signed_area
from extrados.model.properties import NO_SLIDING_COEFFICIENT, Material
from extrados.model.structures.walls import MeshedWall
from extrados.schema.constants import GRAVITY
from extrados.views.blocks import Masonry
from extrados.views.mesh.mesh import ElementGroup, JointLaw, Mesh, element_areas
from extrados.views.mesh.options import LARGEST_MESH, MeshOptions
from extrados.views.mesh.triangles import fill_ring

#: Elements along a joint where no size is given (fewer along those shorter than the median), and along the shortest
DIVISIONS, FEWEST = 8, 2
#: Thickness of the rows over the size of the elements, and at most over the shortest side along a joint
THICKNESS, THICKNESS_OF_SIDE = 0.04, 0.2
#: Integration points along and across the elements of a row
ROW_POINTS = (4, 1)
#: Turn of an outline from which it is a corner [rad]
CORNER = np.radians(30.0)
#: Strength over the mean joint stress of the weight by which rounding is measured in dry joints
DRY = 1e-3


@dataclass
class Piece:
    """A stretch of a stone's outline, counter-clockwise: points (k, 2) from end to end; a joint, or -1 where free."""

    points: np.ndarray
    joint: int = -1


@dataclass(frozen=True)
class Stone:
    """Mesh of one stone: nodes (n, 2), those of its ring first; elements; for each of its joints the nodes along it,
    in the joint's direction from p to q."""

    xy: np.ndarray
    quads: np.ndarray
    triangles: np.ndarray
    along: dict[int, np.ndarray]


def make_stones(building: Masonry, options: MeshOptions, seed: int | None = None) -> Mesh:
    """Mesh of the stones and joints of a building; BadGeometry says what does not fit.

    seed: of random patterns, of which there are none here.
    """
    _refuse(options)
    assembly = building.blocks()
    size, most, sizes = _sizes(assembly, options)
    lines = [_divided(p, q, size, most) for p, q in zip(assembly.p, assembly.q, strict=True)]
    shortest = min(float(np.hypot(*np.diff(line, axis=0).T).min()) for line in lines)
    rows_of_elements = options.joints == "rows"
    thickness = options.joint_thickness or min(THICKNESS * size, THICKNESS_OF_SIDE * shortest)
    if thickness > 0.5 * shortest:
        raise BadGeometry(
            f"`joint_thickness` = {thickness:g} m is too large for joint elements of {shortest:g} m length: give "
            f"at most {0.5 * shortest:g} m"
        )
    snap = max(1e-7 * assembly.size, 10.0 * assembly.tolerance)
    triangles_only = options.element == "T3"
    gap = thickness if rows_of_elements else 0.0
    stones = [_stone(assembly, i, lines, sizes[i], gap, snap, triangles_only) for i in range(len(assembly.mass))]

    first = np.cumsum([0, *(len(s.xy) for s in stones)])
    xy = [s.xy for s in stones]
    rows, row_joint, ground = [], [], []
    free = int(first[-1])
    for j, line in enumerate(lines):
        sides = []
        for stone in (int(assembly.a[j]), int(assembly.b[j])):
            if stone == GROUND:
                sides.append(free + np.arange(len(line)))
                ground.append(sides[-1])
                xy.append(line)
                free += len(line)
            else:
                sides.append(first[stone] + stones[stone].along[j])
        one, two = sides
        rows.append(np.column_stack([two[:-1], two[1:], one[1:], one[:-1]]))
        row_joint.append(np.full(len(line) - 1, j))
    nodes = np.concatenate(xy)
    row, joint = np.concatenate(rows), np.concatenate(row_joint)
    groups = []
    for kind, gauss in (("Q4", (2, 2)), ("T3", (1, 1))):
        parts = [first[i] + (s.quads if kind == "Q4" else s.triangles) for i, s in enumerate(stones)]
        if len(connect := np.concatenate(parts)):
            n = len(connect)
            groups.append(
                ElementGroup(
                    kind, connect, gauss, np.full(n, assembly.depth), np.zeros(n, dtype=int), np.zeros(n, dtype=bool), np.full(n, np.nan)
                )
            )
    building.refuse_mixture()
    materials, group = (_rows if rows_of_elements else _interfaces)(building, assembly, thickness, nodes, row, joint)
    groups.append(group)
    mass = np.concatenate([*(_masses(s, assembly, i) for i, s in enumerate(stones)), np.zeros(free - first[-1])])
    stone_of = np.repeat([*range(len(stones)), -1], [*(len(s.xy) for s in stones), free - first[-1]])
    walled = building.structure if isinstance(building.structure, MeshedWall) else None
    mesh = Mesh(
        nodes,
        groups,
        [building.material, *materials],
        size,
        building.supports.held,
        walled.ties if walled else [],
        walled.bars if walled else [],
        building.materials,
        options.selective,
        mass=mass,
        stone=stone_of,
        ground=None if building.supports.held else np.concatenate(ground),
        joint_names=assembly.joint_names,
        warnings=passive_left_out(assembly.earth),
    )
    grounded = (assembly.a[joint] == GROUND) | (assembly.b[joint] == GROUND)
    _tell_of_idle_joints(mesh, row[grounded])
    return mesh


def _sizes(assembly: Assembly, options: MeshOptions) -> tuple[float, int, list[float]]:
    """Size of the elements [m], greatest number of them along a joint, and size in each stone [m]; BadGeometry beyond LARGEST_MESH."""
    size, most = options.size, LARGEST_MESH
    if size is None:
        size, most = float(np.median(assembly.length)) / DIVISIONS, DIVISIONS
    sizes = [max(size, float(assembly.length[assembly.joints_of(i)].max()) / most) for i in range(len(assembly.mass))]
    count = sum(abs(signed_area(o)) / s**2 for o, s in zip(assembly.outlines, sizes, strict=True))
    if count > LARGEST_MESH:
        raise BadGeometry(
            f"the mesh would have about {count:.2g} elements of {size:g} m; at most {LARGEST_MESH:g} are allowed: use larger elements"
        )
    return size, most, sizes


def _tell_of_idle_joints(mesh: Mesh, row: np.ndarray) -> None:
    """Warns if supports hold both sides of joints at the ground; `row` (n, 4) are their elements."""
    fixed = [mesh.nodes_at(place, f"supports.held[{k}]") for k, place in enumerate(mesh.held) if "y" in place.fix]
    held = np.zeros(len(mesh.xy), dtype=bool)
    held[np.concatenate([np.empty(0, dtype=int), *fixed])] = True
    if held[row].all(axis=1).any():
        mesh.tell(
            "supports.held holds both sides of joints at the ground, so these joints neither open nor slide. "
            "To let them open and slide, omit supports.held: the ground is then held"
        )


def _rows(
    building: Masonry, assembly: Assembly, thickness: float, nodes: np.ndarray, row: np.ndarray, joint: np.ndarray
) -> tuple[list[Material], ElementGroup]:
    """Joints as thin rows of elements that crack along their own direction."""
    turned = element_areas(nodes, "Q4", row) < 0.0
    row[turned] = row[turned][:, [1, 0, 3, 2]]  # the first side stays along the joint
    bad = np.flatnonzero(element_areas(nodes, "Q4", row) <= 0.0)
    if len(bad):
        raise BadGeometry(
            f"the row of elements along '{assembly.joint_names[joint[bad[0]]]}' overlaps itself: use a smaller `joint_thickness`"
        )
    materials, index, dry = _joint_materials(building, assembly, thickness)
    normal = assembly.normal[joint]
    n = len(row)
    return materials, ElementGroup(
        "Q4",
        row,
        ROW_POINTS,
        np.full(n, assembly.depth),
        1 + index[joint],
        np.zeros(n, dtype=bool),
        np.arctan2(normal[:, 1], normal[:, 0]),
        band=thickness,
        joint=joint,
        dry=dry[joint],
    )


def _interfaces(
    building: Masonry, assembly: Assembly, thickness: float, nodes: np.ndarray, row: np.ndarray, joint: np.ndarray
) -> tuple[list[Material], ElementGroup]:
    """Joints of no thickness. Their stiffness is the joint's, or that of a layer of stone of `thickness`."""
    names = ("tension", "fracture_energy", "friction", "cohesion", "shear_energy", "compressive_strength", "crushing_energy")
    value = {name: building.joint_property(name) for name in names}
    for strength, energy in (("tension", "fracture_energy"), ("cohesion", "shear_energy")):
        if (missing := np.flatnonzero((value[strength] > 0.0) & np.isnan(value[energy]))).size:
            raise BadGeometry(
                f"joint '{assembly.joint_names[missing[0]]}' has a `{strength}` but no `{energy}`: give `{energy}` of [joints], or {strength} = 0"
            )
    if (missing := np.flatnonzero(np.isnan(value["compressive_strength"]) != np.isnan(value["crushing_energy"]))).size:
        raise BadGeometry(f"joint '{assembly.joint_names[missing[0]]}': `compressive_strength` and `crushing_energy` require each other")
    stiffness = _in_series(building, assembly, 1.0 / thickness)
    joints = building.joints
    shear = np.full(len(stiffness), joints.shear_stiffness or np.nan)
    shear = np.where(np.isnan(shear), joints.shear_ratio * stiffness, shear)
    dry = value["tension"] == 0.0
    found, index = np.unique(stiffness, return_inverse=True)
    n = len(row)
    half = 0.5 * assembly.depth * np.hypot(*(nodes[row[:, 1]] - nodes[row[:, 0]]).T)
    begins, ends = np.ones(n, dtype=bool), np.ones(n, dtype=bool)
    begins[1:] = ends[:-1] = joint[1:] != joint[:-1]
    area = np.column_stack([np.where(begins, half, 0.0), half + np.where(ends, 0.0, np.roll(half, -1))])
    value["friction"][value["friction"] >= NO_SLIDING_COEFFICIENT] = np.nan
    law = JointLaw(
        normal=assembly.normal[joint],
        area=area,
        normal_stiffness=stiffness[joint],
        shear_stiffness=shear[joint],
        **{name: values[joint] for name, values in value.items()},
        small=_small_stress(assembly),
        softening=joints.softening,
    )
    # Of joints a material holds only the stiffness: their strain is the jump, over a band of 1 m
    materials = [Material(density=0.0, young=float(k), poisson=0.0) for k in found]
    return materials, ElementGroup(
        "Q4",
        row,
        (2, 1),
        np.full(n, assembly.depth),
        1 + index[joint],
        np.zeros(n, dtype=bool),
        np.arctan2(law.normal[:, 1], law.normal[:, 0]),
        band=1.0,
        joint=joint,
        dry=dry[joint],
        law=law,
    )


def _in_series(building: Masonry, assembly: Assembly, per_length: float) -> np.ndarray:
    """Normal stiffness of each joint [Pa/m]: given, or that of stone of a thickness 1 / per_length [m]; on the ground in
    series with the ground's."""
    given = building.joint_property("normal_stiffness")
    stiffness = np.where(np.isnan(given), building.material.young * per_length, given)
    if building.supports.stiffness is not None:
        grounded = (assembly.a == GROUND) | (assembly.b == GROUND)
        stiffness = np.where(grounded, 1.0 / (1.0 / stiffness + 1.0 / building.supports.stiffness), stiffness)
    return stiffness


def _small_stress(assembly: Assembly) -> float:
    """Stress [Pa] by which rounding is measured in dry joints."""
    area = float((assembly.length * assembly.depth).sum())
    return DRY * float(assembly.mass.sum()) * GRAVITY / area or 1.0


def _refuse(options: MeshOptions) -> None:
    if options.element not in ("Q4", "T3"):
        raise BadGeometry(
            f'`element` = {options.element} is not for blocks, which are meshed by "Q4" (with triangles if these do not fit) or "T3"'
        )
    if options.pattern == "random":
        raise BadGeometry('pattern = "random" is not for blocks, because cracks follow the joints between the blocks')
    if options.refine or options.lines_x or options.lines_y:
        raise BadGeometry("`refine`, `lines_x` and `lines_y` are not for blocks, because joints between blocks determine the mesh")


def _joint_materials(building: Masonry, assembly: Assembly, thickness: float) -> tuple[list[Material], np.ndarray, np.ndarray]:
    """Materials of the rows, the index of each joint's, and which joints are dry.

    The modulus gives the row the normal stiffness of the joint, in series with that of the ground, or that of the
    stone where none is given. Dry joints have no strength: theirs only measures rounding.
    """
    stone = building.material
    tension, energy = (building.joint_property(name) for name in ("tension", "fracture_energy"))
    young = _in_series(building, assembly, 1.0 / thickness) * thickness
    dry = tension == 0.0
    if (missing := np.flatnonzero(~dry & np.isnan(energy))).size:
        raise BadGeometry(
            f"joint '{assembly.joint_names[missing[0]]}' has a `tension` but no `fracture_energy`: give "
            "`fracture_energy` of [joints], or tension = 0 for dry joints"
        )
    small = _small_stress(assembly)
    strength = np.where(dry, small, tension)
    # Far from the snap-back of the row itself, 2 E Gf / ft^2 > thickness; without meaning in a dry joint
    energy = np.where(dry, 5.0 * small**2 * thickness / young, energy)
    found: dict[tuple[float, float, float], int] = {}
    index = np.array([found.setdefault(values, len(found)) for values in zip(young, strength, energy, strict=True)], dtype=int)
    materials = [
        Material(density=0.0, young=float(e), poisson=0.0, tensile_strength=float(f), fracture_energy=float(g), softening=stone.softening)
        for e, f, g in found
    ]
    return materials, index, dry


def _masses(stone: Stone, assembly: Assembly, block: int) -> np.ndarray:
    """Masses [kg] at the nodes of a stone with its own mass and centroid, and those of the fill that rests on it."""
    xy = stone.xy
    share = np.zeros(len(xy))
    for kind, connect in (("Q4", stone.quads), ("T3", stone.triangles)):
        area = element_areas(xy, kind, connect)
        np.add.at(share, connect, (area / connect.shape[1])[:, None] if len(connect) else 0.0)

    middle = share @ xy / share.sum()
    shape = np.column_stack([np.ones(len(xy)), xy - middle])
    moments = shape.T @ (share[:, None] * shape)

    def placed(mass: float, at: np.ndarray) -> np.ndarray:
        return mass * share * (shape @ np.linalg.solve(moments, [1.0, *(at - middle)]))

    mass = placed(float(assembly.mass[block]), assembly.centroid[block])
    if assembly.fill is not None and assembly.fill[block, 0] > 0.0:
        mass = mass + placed(float(assembly.fill[block, 0]), assembly.fill[block, 1:])
    return mass


def _divided(p: np.ndarray, q: np.ndarray, size: float, most: int) -> np.ndarray:
    """Points along a joint, about `size` apart and closer toward its ends, where hinges form; at most `most` parts."""
    count = min(most, max(FEWEST, round(float(np.hypot(*(q - p))) / size)))
    share = 0.5 - 0.5 * np.cos(np.pi * np.arange(count + 1) / count)
    return p + share[:, None] * (q - p)


def _stone(
    assembly: Assembly, block: int, lines: list[np.ndarray], size: float, thickness: float, snap: float, triangles_only: bool
) -> Stone:
    pieces = _outline_pieces(assembly, block, lines, snap)
    name = assembly.block_names[block]
    sides = None if triangles_only else _four_sides(pieces, size)
    if sides is None:
        pieces = [p if p.joint >= 0 else Piece(_spaced(p.points, _count(p.points, size))) for p in pieces]
    else:
        pieces = [piece for side in sides for piece in side]
    ring = np.concatenate([p.points[:-1] for p in pieces])
    moved = ring + _withdrawal(assembly, block, pieces, thickness)
    along, start = {}, 0
    for piece in pieces:
        nodes = (start + np.arange(len(piece.points))) % len(ring)
        start += len(piece.points) - 1
        if piece.joint >= 0:
            forward = np.dot(piece.points[-1] - piece.points[0], assembly.tangent[piece.joint]) > 0.0
            along[piece.joint] = nodes if forward else nodes[::-1]
    if sides is not None:
        counts = [sum(len(p.points) - 1 for p in side) for side in sides]
        found = _mapped(moved, counts)
        if found is not None:
            return Stone(*found, np.empty((0, 3), dtype=int), along)
    try:
        xy, triangles = fill_ring(moved, size)
    except BadGeometry as error:
        raise BadGeometry(f"block '{name}': {error}") from None
    return Stone(xy, np.empty((0, 4), dtype=int), triangles, along)


def _outline_pieces(assembly: Assembly, block: int, lines: list[np.ndarray], snap: float) -> list[Piece]:
    """The outline as joints and free stretches, counter-clockwise; joints that meet within `snap` share the point."""
    outline = assembly.outlines[block]
    edge = following(outline) - outline
    length = np.hypot(*edge.T)
    at = np.concatenate([[0.0], np.cumsum(length)])
    around = at[-1]
    found = []
    for j in assembly.joints_of(block):
        inward = assembly.normal[j] * (1.0 if assembly.a[j] == block else -1.0)
        t = assembly.tangent[j]
        line = lines[j]
        if t[0] * inward[1] - t[1] * inward[0] < 0.0:  # the block must lie to the left
            line, t = line[::-1], -t
        ends = []
        for point in (line[0], line[-1]):
            run = np.clip(((point - outline) * edge).sum(axis=1) / length**2, 0.0, 1.0)
            gap = np.hypot(*(outline + run[:, None] * edge - point).T)
            gap = np.where(edge @ t > 0.9 * length, gap, np.inf)
            k = int(gap.argmin())
            if gap[k] > max(snap, 1e-3 * assembly.length[j]):
                raise BadGeometry(f"joint '{assembly.joint_names[j]}' is not on the outline of block '{assembly.block_names[block]}'")
            ends.append(at[k] + run[k] * length[k])
        begin, end = ends
        found.append((begin, end if end > begin else end + around, int(j), line))
    if not found:  # a stone that nothing touches is refused before: it would fall
        raise BadGeometry(f"block '{assembly.block_names[block]}' has no joint")
    found.sort(key=lambda row: row[0])
    pieces = []
    for this, after in zip(found, [*found[1:], found[0]], strict=True):
        pieces.append(Piece(this[3].copy(), this[2]))
        begin, end = this[1], after[0] if after is not found[0] else after[0] + around
        if end - begin < -snap:
            raise BadGeometry(
                f"joints '{assembly.joint_names[this[2]]}' and '{assembly.joint_names[after[2]]}' overlap on block "
                f"'{assembly.block_names[block]}'"
            )
        if end - begin <= snap:
            continue
        twice = np.concatenate([at[:-1], at[:-1] + around, at[:-1] + 2.0 * around])
        within = np.flatnonzero((twice > begin + snap) & (twice < end - snap)) % len(outline)
        pieces.append(Piece(np.concatenate([this[3][-1:], outline[within], after[3][:1]])))
    for piece, following_one in zip(pieces, pieces[1:] + pieces[:1], strict=True):
        if piece.joint >= 0 and following_one.joint >= 0:
            piece.points[-1] = following_one.points[0] = 0.5 * (piece.points[-1] + following_one.points[0])
    return [part for piece in pieces for part in _at_corners(piece)]


def _at_corners(piece: Piece) -> list[Piece]:
    """A free stretch cut at its corners."""
    if piece.joint >= 0 or len(piece.points) < 3:
        return [piece]
    cuts = [0, *(1 + np.flatnonzero(_turns(np.diff(piece.points, axis=0)) > CORNER)), len(piece.points) - 1]
    return [Piece(piece.points[a : b + 1]) for a, b in itertools.pairwise(cuts)]


def _turns(edges: np.ndarray) -> np.ndarray:
    """Angles between successive edges, without their sense [rad]."""
    a, b = edges[:-1], edges[1:]
    return np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))


def _run(points: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _count(points: np.ndarray, size: float) -> int:
    return max(1, round(float(_run(points)[-1]) / size))


def _spaced(points: np.ndarray, count: int) -> np.ndarray:
    """`count` equal parts of a polyline."""
    run = _run(points)
    wanted = run[-1] * np.arange(count + 1) / count
    return np.column_stack([np.interp(wanted, run, points[:, axis]) for axis in (0, 1)])


def _four_sides(pieces: list[Piece], size: float) -> list[list[Piece]] | None:
    """The outline as four sides of as many elements on opposite ones, free stretches divided to suit; None where it
    has not four corners or joints stand against it."""
    last = np.array([p.points[-1] - p.points[-2] for p in pieces])
    first = np.array([p.points[1] - p.points[0] for p in pieces])
    n = len(pieces)
    corner = [k for k in range(n) if _turns(np.stack([last[k - 1], first[k]]))[0] > CORNER]
    if len(corner) != 4:
        return None
    turned = pieces[corner[0] :] + pieces[: corner[0]]
    cut = [c - corner[0] for c in corner] + [n]
    sides = [turned[a:b] for a, b in itertools.pairwise(cut)]
    for one, two in ((0, 2), (1, 3)):
        pair = (sides[one], sides[two])
        fixed = [sum(len(p.points) - 1 for p in side if p.joint >= 0) for side in pair]
        loose = [[k for k, p in enumerate(side) if p.joint < 0] for side in pair]
        least = [f + len(w) for f, w in zip(fixed, loose, strict=True)]
        if loose[0] and loose[1]:
            wanted = round(
                np.mean([f + sum(_count(side[k].points, size) for k in w) for f, w, side in zip(fixed, loose, pair, strict=True)])
            )
            wanted = max(wanted, *least)
        else:
            wanted = fixed[1] if loose[0] else fixed[0]
        for f, w, low, side in zip(fixed, loose, least, pair, strict=True):
            if (w and wanted < low) or (not w and wanted != f):
                return None
            spare = wanted - f
            for number, k in enumerate(w):  # shared by the order of the stretches
                share = spare // len(w) + (number < spare % len(w))
                side[k] = Piece(_spaced(side[k].points, share))
    return sides


def _withdrawal(assembly: Assembly, block: int, pieces: list[Piece], thickness: float) -> np.ndarray:
    """By how much each node of the ring leaves its joints (n, 2) [m]: half the thickness, all of it on the ground."""

    def joint_side(piece: Piece) -> tuple[np.ndarray, float] | None:
        if piece.joint < 0:
            return None
        j = piece.joint
        on_ground = GROUND in (assembly.a[j], assembly.b[j])
        into = assembly.normal[j] * (1.0 if assembly.a[j] == block else -1.0)
        return into, thickness if on_ground else 0.5 * thickness

    moves = []
    for before, piece in zip(pieces[-1:] + pieces[:-1], pieces, strict=True):
        here, there = joint_side(before), joint_side(piece)
        if here is not None and there is not None:
            normals = np.stack([here[0], there[0]])
            if abs(np.linalg.det(normals)) > 0.1:
                move = np.linalg.solve(normals, [here[1], there[1]])
            else:  # one face, two joints
                move = 0.5 * (here[0] * here[1] + there[0] * there[1])
        elif (only := here or there) is not None:
            # Along the free edge, so that the outline stays; where that runs on in the joint's line, across it
            normal, width = only
            ends = (piece.points[1] - piece.points[0]) if here is not None else (before.points[-2] - before.points[-1])
            free = ends / np.hypot(*ends)
            slope = float(free @ normal)
            move = free * width / slope if abs(slope) > 0.3 else normal * width
        else:
            move = np.zeros(2)
        inner = np.zeros((len(piece.points) - 2, 2)) if there is None else np.tile(there[0] * there[1], (len(piece.points) - 2, 1))
        moves += [move[None], inner]
    return np.concatenate(moves)


def _mapped(ring: np.ndarray, counts: Sequence[int]) -> tuple[np.ndarray, np.ndarray] | None:
    """Quadrilaterals between four sides of `counts` edges (Coons' patch), ring nodes first; None where one folds."""
    nx, ny = counts[0], counts[1]
    corner = np.cumsum([0, *counts])
    closed = np.concatenate([ring, ring[:1]])
    bottom, right = closed[: corner[1] + 1], closed[corner[1] : corner[2] + 1]
    top, left = closed[corner[2] : corner[3] + 1][::-1], closed[corner[3] : corner[4] + 1][::-1]

    def share(one: np.ndarray, two: np.ndarray) -> np.ndarray:
        a, b = _run(one), _run(two)
        return np.stack([a / a[-1], b / b[-1]])

    across, up = share(bottom, top), share(left, right)
    u0, v0 = across.mean(axis=0)[:, None], up.mean(axis=0)[None, :]
    u = ((1.0 - v0) * across[0][:, None] + v0 * across[1][:, None])[..., None]
    v = ((1.0 - u0) * up[0][None, :] + u0 * up[1][None, :])[..., None]
    grid = (1 - v) * bottom[:, None] + v * top[:, None] + (1 - u) * left[None] + u * right[None]
    grid -= (1 - u) * (1 - v) * bottom[0] + u * (1 - v) * bottom[-1] + (1 - u) * v * top[0] + u * v * top[-1]
    number = np.full((nx + 1, ny + 1), -1)
    order = np.arange(len(ring))
    number[:, 0] = order[: nx + 1]
    number[nx, :] = order[corner[1] : corner[2] + 1]
    number[:, ny] = order[corner[2] : corner[3] + 1][::-1]
    number[0, 1:] = order[corner[3] :][::-1]
    inner = np.argwhere(number < 0)
    number[number < 0] = len(ring) + np.arange(len(inner))
    xy = np.concatenate([ring, grid[inner[:, 0], inner[:, 1]]])
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    corners = xy[quads]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    convex = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return (xy, quads) if (convex > 0.0).all() else None
