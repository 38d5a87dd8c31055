"""The mesher of buildings on a plan: walls as grids that meet at corners, openings and storeys, floors between them."""

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry, blaming
from extrados.model.properties import NO_SLIDING, Material
from extrados.model.structures.plan import MEETS, Corner, Plan, PlanWall, Prestress, RingBeam, Rod, StoreyFloor, meeting, nearly_meeting
from extrados.schema.constants import GRAVITY
from extrados.views.mesh.options import LARGEST_MESH
from extrados.views.mesh.triangles import fill_ring
from extrados.views.shell.mesh import Foot, ShellBar, ShellJoint, ShellMesh, ShellPart, WallPlane, pieces
from extrados.views.shell.options import ShellOptions

#: What a rigid floor is: a concrete slab
RIGID_YOUNG, RIGID_THICKNESS = 30e9, 0.2
#: Breaks of the grid nearer to each other than this part of the size are told
SLIVER = 0.2
#: A joint without a stiffness has that of a layer of masonry, as thick as this part of the elements' size
LAYER = 1.0 / 25.0


class _Grid:
    """One wall as a grid: its lines, and which cells are there."""

    def __init__(self, wall: PlanWall, s: np.ndarray, z: np.ndarray):
        self.wall, self.s, self.z = wall, s, z
        self.there = np.ones((len(s) - 1, len(z) - 1), dtype=bool)
        self.first = 0  # number of its first node, before walls are joined

    def number(self, i: np.ndarray, k: np.ndarray) -> np.ndarray:
        return self.first + i * len(self.z) + k

    def cells(self, s: tuple[float, float], z: tuple[float, float]) -> np.ndarray:
        """Cells (columns, rows) whose middles lie within two ranges."""
        x, y = 0.5 * (self.s[1:] + self.s[:-1]), 0.5 * (self.z[1:] + self.z[:-1])
        return ((x > s[0]) & (x < s[1]))[:, None] & ((y > z[0]) & (y < z[1]))

    def points(self) -> np.ndarray:
        place = np.asarray(self.wall.start) + self.s[:, None] * self.wall.direction
        return np.column_stack([np.repeat(place, len(self.z), axis=0), np.tile(self.z, len(self.s))])


#: Nodes (n, 3) [m] with their masses (n) [kg] and forces (n, 3) [N]
Nodes = tuple[np.ndarray, np.ndarray, np.ndarray]


def shell_of_plan(building: Description, options: ShellOptions) -> ShellMesh:
    """Walls on a plan with the floors between them; BadGeometry says what does not fit."""
    plan = building.structure
    assert isinstance(plan, Plan)
    size = options.size or min(0.1 * plan.storeys[0], min(wall.length for wall in plan.walls) / 8.0)
    area = sum(wall.length for wall in plan.walls) * plan.levels[-1]
    if area / size**2 > LARGEST_MESH:
        raise BadGeometry(
            f"the mesh would have about {area / size**2:.2g} elements of {size:g} m; at most {LARGEST_MESH:g} are allowed",
            ("analysis", "mesh", "size"),
        )
    warnings = plan.roof_remarks
    junctions = _junctions(plan, warnings)
    _check_corners(plan, junctions)
    grids = _grids(plan, junctions, size, warnings)
    xyz, number = _join(plan, grids, junctions)
    materials, names = [building.material, *building.materials.values()], list(building.materials)
    parts = _wall_parts(plan, grids, junctions, number, names)
    joints, sources = _joints(plan, grids, junctions, number, parts, len(xyz))
    joints = [replace(joint, strength=_strength(plan, building, joint.name, size), softening=building.joints.softening) for joint in joints]
    if joints and building.joints.coefficient is not None and not all(j.strength["cohesion"] > 0.0 for j in joints):
        warnings.append(
            "joints without cohesion slide only after they open. To let them slide under compression, give a cohesion of any "
            "value, with its shear_energy"
        )
    xyz = np.concatenate([xyz, xyz[sources]])
    planes = [_plane(plan, grid) for grid in grids]
    mass, push = np.zeros(len(xyz)), np.zeros((len(xyz), 3))
    bars: list[ShellBar] = []
    grown = xyz
    for w, wall in enumerate(plan.walls):
        if wall.gable is not None:
            grown = _add_gable(plan, w, grids[w], number, grown, parts, names, size)
    mass, push = (np.concatenate([of, np.zeros((len(grown) - len(of), *of.shape[1:]))]) for of in (mass, push))
    rings: dict[tuple[int, frozenset[int]], int] = {}
    for k, floor in enumerate(plan.floors):
        with blaming("floors", k):
            ring = _ring(plan, floor, grids, number, xyz)
            if (first := rings.setdefault((floor.storey, frozenset(ring)), k)) != k:
                raise BadGeometry(f"floor {first + 1} is given for the same walls on storey {floor.storey}")
            grown, mass, push = _add_floor(plan, floor, ring, grids, number, (grown, mass, push), parts, materials, bars, size)
    used = np.zeros(len(grown), dtype=bool)
    for connect in (*(part.connect for part in parts), *(joint.connect for joint in joints)):
        used[connect] = True
    above = np.zeros(len(grown), dtype=bool)  # a sole joint
    above[len(xyz) - len(sources) : len(xyz)] = True
    for k, load in enumerate(plan.prestress):
        with blaming("prestress", k):
            _prestress(plan, load, grids, number, used, push)
    for k, rod in enumerate(plan.rods):
        with blaming("rods", k):
            bars.append(_rod(rod, k + 1, grown, used, building, size))
    held, springs = _supports(plan, [*parts, *joints], grown, used, above)
    if any(beam.reinforcement is not None for beam in plan.ring_beams):
        warnings.append("ring beams remain elastic in shells: their reinforcement is not considered")
    warnings += _apart(plan, parts, bars, joints, grown)
    for prop in plan.props:
        w = next(i for i, wall in enumerate(plan.walls) if wall.name == prop.wall)
        nodes, _ = _level_nodes(plan, prop.storey, grids[w], number)
        held = sorted({*held, *((int(n), int(np.abs(plan.walls[w].direction).argmin())) for n in nodes)})
    kept = np.cumsum(used) - 1
    parts = [ShellPart(**{**part.__dict__, "connect": kept[part.connect]}) for part in parts]  # nodes within openings are dropped
    joints = [replace(joint, connect=kept[joint.connect]) for joint in joints]
    bars = [ShellBar(b.name, (int(kept[b.nodes[0]]), int(kept[b.nodes[1]])), b.area, b.material, b.prestress) for b in bars]
    return ShellMesh(
        grown[used],
        parts,
        planes,
        plan.levels,
        materials,
        size,
        [(int(kept[n]), d) for n, d in held],
        [(int(kept[n]), d, k) for n, d, k in springs],
        bars,
        mass[used],
        push[used],
        warnings,
        _feet(plan, grids, number, kept, used),
        joints,
    )


def _wall_parts(plan: Plan, grids: list[_Grid], junctions: dict, number: np.ndarray, names: list[str]) -> list[ShellPart]:
    """The shells of all walls, with the ring beams in them; a wrong name of a material is refused at its key."""
    for k, beam in enumerate(plan.ring_beams):
        with blaming("ring_beams", k):
            _named(beam.material, names, f"ring beam of storey {beam.storey}")
    parts = []
    for w in range(len(grids)):
        with blaming("walls", w):
            parts.append(_wall_part(plan, w, grids, junctions, number, names))
    return parts


def _junctions(plan: Plan, warnings: list[str]) -> dict:
    """Where walls meet, by their indices; warnings: of those that nearly do."""
    found = {}
    for a, b in itertools.combinations(range(len(plan.walls)), 2):
        one, two = plan.walls[a], plan.walls[b]
        if (at := meeting(one, two)) is not None:
            found[a, b] = at
        elif (gap := nearly_meeting(one, two)) is not None:
            warnings.append(f"walls '{one.name}' and '{two.name}' end {gap:.3g} m apart, so they do not meet and are not connected")
    return found


def _check_corners(plan: Plan, junctions: dict) -> None:
    """BadGeometry where walls of a corner do not meet."""
    names = [wall.name for wall in plan.walls]
    for k, corner in enumerate(plan.corners):
        if tuple(sorted(map(names.index, corner.walls))) not in junctions:
            raise BadGeometry(f"walls '{corner.walls[0]}' and '{corner.walls[1]}' do not meet", ("structure", "corners", k))


def _apart(plan: Plan, parts: list[ShellPart], bars: list[ShellBar], joints: list[ShellJoint], xyz: np.ndarray) -> list[str]:
    """What to tell of walls that nothing joins with the others; BadGeometry where a wall does not reach the ground."""
    walls, ground = [part for part in parts if part.bends], xyz[:, 2] <= MEETS
    piece = pieces(len(xyz), walls, bars, joints)  # a floor holds no wall up
    stands = np.isin(piece, piece[ground & np.isin(np.arange(len(xyz)), np.concatenate([p.connect.ravel() for p in walls]))])
    for part in walls:
        loose = part.connect[~stands[part.connect[:, 0]]]
        if len(loose):
            x, y, z = xyz[loose].mean(axis=(0, 1))
            raise BadGeometry(
                f"wall '{part.name}': the part around x {x:.3g}, y {y:.3g}, z {z:.3g} m is not supported, because no masonry "
                "connects it with the ground",
                ("structure", "walls", part.wall),
            )
    piece = pieces(len(xyz), parts, bars, joints)
    joined: dict[frozenset[int], list[str]] = {}
    for part in walls:
        joined.setdefault(frozenset(piece[part.connect[:, 0]].tolist()), []).append(part.name)
    alone = [names for which, names in joined.items() if not any(which & other for other in joined if other != which)]
    if len(alone) < 2:
        return []
    return [(f"no corner, floor or rod connects {' with '.join(', '.join(names) for names in alone)}: each of these stands alone")]


def _lines(breaks: Iterable[float], length: float, size: float, what: str, warnings: list[str]) -> np.ndarray:
    """Grid lines through all breaks within 0 and `length`, evenly in between."""
    kept = [0.0]
    for value in sorted(b for b in breaks if MEETS < b <= length + MEETS):
        if value - kept[-1] > MEETS:
            kept.append(min(value, length))
    kept[-1] = length
    thin = min((b - a for a, b in itertools.pairwise(kept)), default=length)
    if thin < SLIVER * size:
        warnings.append(f"{what}: two mesh lines are only {1e3 * thin:.3g} mm apart, but elements of {size:.3g} m were requested")
    parts = [np.zeros(1)]
    for a, b in itertools.pairwise(kept):
        count = max(1, round((b - a) / size))
        parts.append(a + (b - a) * np.arange(1, count + 1) / count)
    return np.concatenate(parts)


def _holes(plan: Plan, wall: PlanWall) -> list[tuple[float, float, float, float]]:
    """Openings of a wall: s from, to, z from, to [m]."""
    return [(*o.x, plan.levels[o.storey - 1] + o.z[0], plan.levels[o.storey - 1] + o.z[1]) for o in wall.openings]


def _lintels(plan: Plan, wall: PlanWall) -> list[tuple[float, float, float, float, str | None]]:
    """Lintels of a wall: s from, to, z from, to [m], material."""
    found = []
    for opening, hole in zip(wall.openings, _holes(plan, wall), strict=True):
        if opening.lintel is not None:
            beam = opening.lintel
            low, high = max(0.0, hole[0] - beam.bearing), min(wall.length, hole[1] + beam.bearing)
            found.append((low, high, hole[3], hole[3] + beam.depth, beam.material))
    return found


def _ring_beams(plan: Plan, wall: PlanWall) -> list[tuple[RingBeam, float, float, float, float]]:
    """Ring beams of a wall: s from, to, z from, to [m]."""
    tops = [(beam, float(plan.levels[beam.storey])) for beam in plan.ring_beams if wall in plan.of_ring_beam(beam)]
    return [(beam, 0.0, wall.length, top - beam.depth, top) for beam, top in tops]


def _loaded(plan: Plan, wall: PlanWall) -> list[float]:
    """Ends of the forces on parts of a wall [m]."""
    return [s for part in plan.prestress if part.wall == wall.name and part.x is not None for s in part.x]


def _plane(plan: Plan, grid: _Grid) -> WallPlane:
    wall = grid.wall
    return WallPlane(wall.name, np.asarray(wall.start, dtype=float), wall.direction, wall.length, _holes(plan, wall))


def _grids(plan: Plan, junctions: dict, size: float, warnings: list[str]) -> list[_Grid]:
    heights = {*plan.levels.tolist(), *(plan.bed_height(bed) for bed in plan.beds)}
    for wall in plan.walls:
        beams = (*(lintel[:4] for lintel in _lintels(plan, wall)), *(beam[1:] for beam in _ring_beams(plan, wall)))
        for box in (*_holes(plan, wall), *beams):
            heights.update(box[2:4])
    z = _lines(heights, float(plan.levels[-1]), size, "the heights of openings and of storeys", warnings)
    grids: list[_Grid] = []
    for w, wall in enumerate(plan.walls):
        breaks = {0.0, wall.length, *_loaded(plan, wall)}
        for beam in (*_holes(plan, wall), *(lintel[:4] for lintel in _lintels(plan, wall))):
            breaks.update(beam[:2])
        for (a, b), (s, t) in junctions.items():
            breaks.update([s] if a == w else [t] if b == w else [])
        grid = _Grid(wall, _lines(breaks, wall.length, size, f"wall '{wall.name}'", warnings), z)
        first, last = plan.reach(wall)
        grid.there &= grid.cells((-np.inf, np.inf), (plan.levels[first - 1], plan.levels[last]))
        for hole in _holes(plan, wall):
            grid.there &= ~grid.cells(hole[:2], hole[2:])
        grid.first = grids[-1].first + len(grids[-1].s) * len(z) if grids else 0
        grids.append(grid)
    return grids


def _join(plan: Plan, grids: list[_Grid], junctions: dict) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of all walls, those of walls that hang together once; the number of each node of the grids."""
    xyz = np.concatenate([grid.points() for grid in grids])
    owner = np.arange(len(xyz))

    def root(n: int) -> int:
        while owner[n] != n:
            owner[n] = owner[owner[n]]
            n = int(owner[n])
        return n

    for (a, b), (s, t) in junctions.items():
        corner = plan.bond(plan.walls[a].name, plan.walls[b].name)
        if corner is not None and corner.bond in ("open", "joint"):
            continue
        one, two = grids[a], grids[b]
        i, j = int(np.abs(one.s - s).argmin()), int(np.abs(two.s - t).argmin())
        for k in range(len(one.z)):
            p, q = root(int(one.number(i, k))), root(int(two.number(j, k)))
            owner[max(p, q)] = min(p, q)
    found = np.array([root(n) for n in range(len(xyz))])
    alone, number = np.unique(found, return_inverse=True)
    return xyz[alone], number


def _wall_part(plan: Plan, w: int, grids: list[_Grid], junctions: dict, number: np.ndarray, names: list[str]) -> ShellPart:
    grid, wall = grids[w], plan.walls[w]
    i, k = np.nonzero(grid.there)
    if not len(i):
        raise BadGeometry(f"wall '{wall.name}': the openings occupy the whole wall")
    corners = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)]
    connect = np.column_stack([number[grid.number(a, b)] for a, b in corners])
    thickness = _thickness_at(plan, wall, 0.5 * (grid.z[k] + grid.z[k + 1]))
    reach = plan.reach(wall)
    of_storey = [plan.material_of(wall, storey) for storey in range(reach[0], reach[1] + 1)]
    index = np.array([0 if name is None else _named(name, names, f"wall '{wall.name}'") for name in of_storey])
    material = index[np.searchsorted(plan.levels, 0.5 * (grid.z[k] + grid.z[k + 1])) - reach[0]]
    linear, strength = np.zeros(len(i), dtype=bool), np.ones(len(i))
    for *box, name in _lintels(plan, wall):
        inside = grid.cells((box[0], box[1]), (box[2], box[3]))[i, k]
        if not inside.any():
            raise BadGeometry(
                f"wall '{wall.name}': a lintel at x {box[0]:g} to {box[1]:g}, z {box[2]:g} to {box[3]:g} m lies entirely within openings"
            )
        linear |= inside
        if name is not None:
            material[inside] = _named(name, names, f"a lintel of wall '{wall.name}'")
    for beam, *box in _ring_beams(plan, wall):
        inside = grid.cells((box[0], box[1]), (box[2], box[3]))[i, k]
        linear |= inside
        material[inside] = _named(beam.material, names, f"ring beam of storey {beam.storey}")
    for (a, b), (s, t) in junctions.items():
        corner = plan.bond(plan.walls[a].name, plan.walls[b].name) if w in (a, b) else None
        if corner is None or corner.bond != "weak" or corner.walls[1] != wall.name:
            continue
        column = int(np.abs(grid.s - (s if a == w else t)).argmin())
        strength[(i == column) | (i == column - 1)] *= corner.strength
    return ShellPart(wall.name, "Q4", connect, thickness, material, linear, strength, wall=w)


def _add_gable(
    plan: Plan, w: int, grid: _Grid, number: np.ndarray, xyz: np.ndarray, parts: list[ShellPart], names: list[str], size: float
) -> np.ndarray:
    """Triangles of the triangular top of a wall, on the nodes of its highest level; the nodes with those of the gable."""
    wall = plan.walls[w]
    last = plan.reach(wall)[1]
    foot, s = _level_nodes(plan, last, grid, number)
    left, ridge, right = np.array(wall.gable_outline)
    sides = []
    for a, b in ((right, ridge), (ridge, left)):
        share = np.linspace(0.0, 1.0, max(1, round(float(np.linalg.norm(b - a)) / size)) + 1)[1:, None]
        if np.linalg.norm(b - a) > MEETS:
            sides.append(a + share * (b - a))
    slope = np.concatenate(sides)[:-1]  # the left eave is a node of the wall
    if np.linalg.norm(ridge - right) < MEETS:
        slope = np.concatenate([[ridge], slope])
    place, triangles = fill_ring(np.concatenate([np.column_stack([s, np.zeros(len(s))]), slope]), size)
    new = place[len(s) :]
    nodes = np.concatenate([foot, len(xyz) + np.arange(len(new))])
    name = plan.material_of(wall, last)
    count = len(triangles)
    parts.append(
        ShellPart(
            f"{wall.name} gable",
            "T3",
            nodes[triangles],
            np.full(count, plan.thickness_of(wall, last)),
            np.full(count, 0 if name is None else _named(name, names, f"wall '{wall.name}'")),
            np.zeros(count, dtype=bool),
            np.ones(count),
            wall=w,
        )
    )
    on_plan = np.asarray(wall.start) + new[:, :1] * wall.direction
    return np.concatenate([xyz, np.column_stack([on_plan, plan.levels[last] + new[:, 1]])])


def _joints(
    plan: Plan, grids: list[_Grid], junctions: dict, number: np.ndarray, parts: list[ShellPart], nodes: int
) -> tuple[list[ShellJoint], np.ndarray]:
    """Joints between walls and bed joints; above a bed joint the walls stand on copies of its nodes, numbered from `nodes`
    on. The nodes that are copied."""
    copies: dict[tuple[int, int], int] = {}  # row of the grids and node: its copy
    beds: list[tuple[str, int, list[int]]] = []  # name, row of the grids, walls
    for k, (bed, name) in enumerate(zip(plan.beds, plan.joint_names[len(plan.joint_names) - len(plan.beds) :], strict=True)):
        walls = [
            w
            for w, wall in enumerate(plan.walls)
            if (wall.name in bed.walls or not bed.walls) and plan.reach(wall)[0] <= bed.storey <= plan.reach(wall)[1]
        ]
        row = int(np.abs(grids[0].z - plan.bed_height(bed)).argmin())
        on = {w: _cells_above(grids[w], row, number) for w in range(len(grids))}
        if not any(len(on[w]) for w in walls):
            raise BadGeometry(f"at {plan.bed_height(bed):g} m there is no wall", ("structure", "beds", k))
        stay = {n for w in on if w not in walls for n in on[w].ravel().tolist()}  # there a wall passes through the joint
        for n in sorted({n for w in walls for n in on[w].ravel().tolist()} - stay):
            copies[row, n] = nodes + len(copies)
        for w in walls:
            part = parts[w]
            connect, base = part.connect.copy(), np.nonzero(grids[w].there)[1] == row
            connect[base, :2] = [[copies.get((row, n), n) for n in pair] for pair in connect[base, :2].tolist()]
            parts[w] = replace(part, connect=connect)
        beds.append((name, row, walls))

    def foot(row: int, n: int) -> int:
        return copies.get((row, n), n)

    found = []
    for corner in plan.corners:
        if corner.bond == "joint":
            found.append(_between(plan, corner, grids, junctions, number, foot))
    for name, row, walls in beds:
        for w in walls:
            grid, wall = grids[w], plan.walls[w]
            beside = grid.there[:, row] & (grid.there[:, row - 1] if row > 0 else True)
            i = np.flatnonzero(beside)
            if not len(i):
                continue
            lower = np.column_stack([number[grid.number(i, np.full(len(i), row))], number[grid.number(i + 1, np.full(len(i), row))]])
            upper = np.array([[foot(row, n) for n in pair] for pair in lower.tolist()])
            along = np.append(wall.direction, 0.0)
            found.append(
                _stretches(
                    name,
                    np.column_stack([lower, upper[:, ::-1]]),
                    np.diff(grid.s)[i],
                    np.array([0.0, 0.0, 1.0]),
                    along,
                    _thickness_at(plan, wall, np.full(len(i), 0.5 * (grid.z[row] + grid.z[row + 1]))),
                    wall.name,
                )
            )
    sources = np.array([n for _, n in copies], dtype=int)
    return found, sources


#: What the joints of a building take from [joints], and what [[joints.types]] may say of some
STRENGTHS = ("tension", "fracture_energy", "friction", "cohesion", "shear_energy", "compressive_strength", "crushing_energy")


def _strength(plan: Plan, building: Description, name: str, size: float) -> dict[str, float]:
    """What [joints] and [[joints.types]] say of a joint; NaN where they say nothing, of friction where it excludes sliding."""
    own = {what: getattr(building.joints, what) for what in (*STRENGTHS, "normal_stiffness")}
    named: dict[str, int] = {}
    for k, kind in enumerate(building.joints.types):
        for joint in kind.joints:
            key = ("joints", "types", k, "joints")
            if joint not in plan.joint_names:
                raise BadGeometry(f"joint '{joint}' does not exist; the joints are {', '.join(plan.joint_names)}", key)
            if named.setdefault(joint, k) != k:
                raise BadGeometry(f"joint '{joint}' is named twice, in joints.types {named[joint] + 1} and {k + 1}", key)
        if name in kind.joints:
            own |= {what: value for what in own if (value := getattr(kind, what)) is not None}
    for strength, energy in (("tension", "fracture_energy"), ("cohesion", "shear_energy")):
        if own[strength] > 0.0 and own[energy] is None:
            raise BadGeometry(f"joint '{name}' has a {strength} but no {energy}", ("joints", energy))
    if (own["compressive_strength"] is None) != (own["crushing_energy"] is None):
        raise BadGeometry(f"joint '{name}': compressive_strength and crushing_energy require each other", ("joints",))
    if not own["tension"] > 0.0:
        raise BadGeometry(
            f"joint '{name}' has no tension. A joint between shells must hold until it opens: give a tension, however small, "
            "with a fracture_energy",
            ("joints", "tension"),
        )
    if own["friction"] == NO_SLIDING:
        own["friction"] = None
    if own["normal_stiffness"] is None:
        own["normal_stiffness"] = building.material.young / (LAYER * size)
    shear = building.joints.shear_stiffness
    own["shear_stiffness"] = building.joints.shear_ratio * own["normal_stiffness"] if shear is None else shear
    return {what: np.nan if value is None else float(value) for what, value in own.items()}


def _cells_above(grid: _Grid, row: int, number: np.ndarray) -> np.ndarray:
    """Lower nodes (cells, 2) of the cells of a wall that stand on a line of the grid."""
    i = np.flatnonzero(grid.there[:, row]) if row < grid.there.shape[1] else np.empty(0, dtype=int)
    row_of = np.full(len(i), row)
    return np.column_stack([number[grid.number(i, row_of)], number[grid.number(i + 1, row_of)]])


def _between(
    plan: Plan, corner: Corner, grids: list[_Grid], junctions: dict, number: np.ndarray, foot: Callable[[int, int], int]
) -> ShellJoint:
    """The joint at which the second wall of a corner abuts on the first; foot: the node above a bed joint of a node at it."""
    names = [wall.name for wall in plan.walls]
    one, two = (names.index(name) for name in corner.walls)
    at = junctions[min(one, two), max(one, two)]
    s, t = at if one < two else at[::-1]
    wall, grid, other = plan.walls[two], grids[two], grids[one]
    key = ("structure", "corners", plan.corners.index(corner))
    if MEETS < t < wall.length - MEETS:
        raise BadGeometry(
            f"walls: wall '{wall.name}' passes through wall '{names[one]}'. A joint requires that wall '{wall.name}' "
            f"ends on wall '{names[one]}'",
            key,
        )
    first = t <= MEETS  # it begins there
    j = 0 if first else len(grid.s) - 1
    i = int(np.abs(other.s - s).argmin())
    own = grid.there[0 if first else -1]
    beside = np.zeros(len(own), dtype=bool)
    for column in (i - 1, i):
        if 0 <= column < other.there.shape[0]:
            beside |= other.there[column]
    k = np.flatnonzero(own & beside)
    if not len(k):
        raise BadGeometry(f"walls: '{names[one]}' and '{wall.name}' have no common height at this joint", key)
    lower, upper = (
        np.array([[foot(int(r), int(low)), int(high)] for r, low, high in zip(k, nodes[k], nodes[k + 1], strict=True)])
        for nodes in (number[g.number(np.array(c), np.arange(len(g.z)))] for g, c in ((other, i), (grid, j)))
    )
    normal = np.append(wall.direction if first else -wall.direction, 0.0)
    return _stretches(
        "-".join(corner.walls),
        np.column_stack([lower, upper[:, ::-1]]),
        np.diff(grid.z)[k],
        normal,
        np.array([0.0, 0.0, 1.0]),
        _thickness_at(plan, wall, 0.5 * (grid.z[k] + grid.z[k + 1])),
        wall.name,
    )


def _stretches(
    name: str, connect: np.ndarray, length: np.ndarray, normal: np.ndarray, along: np.ndarray, thickness: np.ndarray, wall: str
) -> ShellJoint:
    n, t, out = (np.tile(axis, (len(connect), 1)) for axis in (normal, along, np.cross(along, normal)))
    return ShellJoint(name, connect, n, t, out, length, thickness, wall)


def _thickness_at(plan: Plan, wall: PlanWall, height: np.ndarray) -> np.ndarray:
    """Thickness of a wall at some heights [m]."""
    first, last = plan.reach(wall)
    thick = wall.thicknesses or [wall.thickness] * (last - first + 1)
    return np.asarray(thick, dtype=float)[np.searchsorted(plan.levels, height) - 1 - (first - 1)]


def _named(name: str, names: list[str], what: str) -> int:
    if name not in names:
        raise BadGeometry(f"{what}: the deck has no [materials.{name}]")
    return 1 + names.index(name)


def _level_nodes(plan: Plan, storey: int, grid: _Grid, number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nodes of a wall on top of a storey that are there, and their distances along it."""
    k = int(np.abs(grid.z - plan.levels[storey]).argmin())
    there = np.zeros(len(grid.s), dtype=bool)
    for row in (k - 1, k):
        if 0 <= row < grid.there.shape[1]:
            there[:-1] |= grid.there[:, row]
            there[1:] |= grid.there[:, row]
    i = np.flatnonzero(there)
    return number[grid.number(i, np.full(len(i), k))], grid.s[i]


def _ring(plan: Plan, floor: StoreyFloor, grids: list[_Grid], number: np.ndarray, xyz: np.ndarray) -> list[int]:
    """The nodes on the walls around a floor in order, counter-clockwise."""
    what = f"floor on storey {floor.storey}"
    walls = plan.around(floor)
    nodes: list[int] = []
    for w, start, end in walls:
        own, s = _level_nodes(plan, floor.storey, grids[w], number)
        if not len(own):
            raise BadGeometry(f"{what}: wall '{plan.walls[w].name}' has no masonry there")
        inside = (s >= min(start, end) - MEETS) & (s <= max(start, end) + MEETS)
        order = np.argsort(s[inside] if end > start else -s[inside], kind="stable")
        nodes += own[inside][order].tolist()
    ring = [n for n, before in zip(nodes, nodes[-1:] + nodes[:-1], strict=True) if np.linalg.norm(xyz[n] - xyz[before]) > MEETS]
    if len(ring) < 3 or len(set(ring)) < len(ring):
        twice = next((n for k, n in enumerate(ring) if n in ring[:k]), None)
        at = "" if twice is None else f" twice at ({xyz[twice, 0]:.3g}, {xyz[twice, 1]:.3g}) m"
        raise BadGeometry(
            f"{what}: the walls {', '.join(plan.walls[w].name for w, _, _ in walls)} do not form a simple ring: it passes{at or ' no area'}. "
            "Name the walls around the floor in order by `walls`"
        )
    x, y = xyz[ring, 0], xyz[ring, 1]
    if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0.0:
        ring.reverse()
    return ring


def _add_floor(
    plan: Plan,
    floor: StoreyFloor,
    ring: list[int],
    grids: list[_Grid],
    number: np.ndarray,
    nodes: Nodes,
    parts: list[ShellPart],
    materials: list[Material],
    bars: list[ShellBar],
    size: float,
) -> Nodes:
    """Elements, bars and masses of a floor; the nodes with those within it. ring: the nodes of the walls around it."""
    xyz, mass, push = nodes
    level = float(plan.levels[floor.storey])
    outline = xyz[ring, :2]
    x, y = outline.T
    area = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    name = f"floor {floor.storey}"
    ends = plan.around(floor)
    bearing = [w for w, _, _ in plan.bearing(floor, ends)]
    if floor.load > 0.0:
        shares = np.sum([_shares(plan, floor, w, ring, grids, number, len(xyz)) for w in bearing], axis=0)
        mass = mass + floor.weight * area / GRAVITY * shares / shares.sum()
    for w, _, _, force in plan.thrusts(floor, ends):
        shares = _shares(plan, floor, w, ring, grids, number, len(xyz))
        push = push.copy()
        push[:, :2] += shares[:, None] / shares.sum() * force
    if floor.kind in ("flexible", "rigid"):
        thickness = floor.flatness * (RIGID_THICKNESS if floor.thickness is None else floor.thickness)
        young = floor.young if floor.kind == "flexible" else RIGID_YOUNG
        inner, triangles = fill_ring(outline, size)
        new = inner[len(ring) :]
        place = np.concatenate([ring, len(xyz) + np.arange(len(new))]).astype(int)
        xyz = np.concatenate([xyz, np.column_stack([new, np.full(len(new), level)])])
        mass = np.concatenate([mass, np.zeros(len(new))])
        push = np.concatenate([push, np.zeros((len(new), 3))])
        count = len(triangles)
        parts.append(
            ShellPart(
                name,
                "T3",
                place[triangles],
                np.full(count, thickness),
                np.full(count, len(materials)),
                np.ones(count, dtype=bool),
                np.ones(count),
                bends=False,
            )
        )
        materials.append(Material(density=0.0, young=young, poisson=floor.poisson))
    elif floor.kind == "joists":
        bars += _joists(plan, floor, grids, number, xyz, name, ring)
    return xyz, mass, push


def _shares(plan: Plan, floor: StoreyFloor, w: int, ring: list[int], grids: list[_Grid], number: np.ndarray, count: int) -> np.ndarray:
    """Length (count) [m] of a wall beside a floor at each of the nodes."""
    shares = np.zeros(count)
    own, s = _level_nodes(plan, floor.storey, grids[w], number)
    on = np.isin(own, ring)
    half = np.diff(s[on]) / 2.0
    np.add.at(shares, own[on], np.append(half, 0.0) + np.append(0.0, half))
    if not shares.sum() > 0.0:
        raise BadGeometry(f"floor on storey {floor.storey}: wall '{plan.walls[w].name}' has no masonry there to carry its load")
    return shares


def _joists(
    plan: Plan, floor: StoreyFloor, grids: list[_Grid], number: np.ndarray, xyz: np.ndarray, name: str, ring: list[int]
) -> list[ShellBar]:
    """Joists as bars from each node of a wall across to the nearest of the other, of the area that stands for it."""
    one, two = (next(i for i, w in enumerate(plan.walls) if w.name == word) for word in floor.bears_on)
    own, s = _level_nodes(plan, floor.storey, grids[one], number)
    far, _ = _level_nodes(plan, floor.storey, grids[two], number)
    own, s = own[np.isin(own, ring)], s[np.isin(own, ring)]
    across = np.array([-plan.walls[one].direction[1], plan.walls[one].direction[0]])
    material = Material(density=0.0, young=floor.young)
    half = np.diff(s) / 2.0
    wide = np.append(half, 0.0) + np.append(0.0, half)
    made = []
    for n, width in zip(own.tolist(), wide.tolist(), strict=True):
        gap = xyz[far, :2] - xyz[n, :2]
        aside = np.abs(gap @ plan.walls[one].direction)
        to = int(far[aside.argmin()])
        if aside.min() > 0.25 * max(abs(float(gap[aside.argmin()] @ across)), MEETS) or to == n:
            continue  # no wall opposite
        made.append(ShellBar(f"{name}, joists", (n, to), floor.joist_area * width / floor.joist_spacing, material))
    if not made:
        raise BadGeometry(f"{name}: no joist spans from wall '{floor.bears_on[0]}' to '{floor.bears_on[1]}'")
    return made


def _prestress(plan: Plan, load: Prestress, grids: list[_Grid], number: np.ndarray, used: np.ndarray, push: np.ndarray) -> None:
    """The force along the top of a wall as nodal forces."""
    w = next(i for i, wall in enumerate(plan.walls) if wall.name == load.wall)
    storey = load.level or plan.reach(plan.walls[w])[1]
    nodes, s = _level_nodes(plan, storey, grids[w], number)
    if not len(nodes):
        raise BadGeometry(f"prestress: wall '{load.wall}' has no masonry on top of storey {storey}")
    part = load.x or [0.0, plan.walls[w].length]
    half = np.where((s[1:] > part[0] + MEETS) & (s[:-1] < part[1] - MEETS), np.diff(s) / 2.0, 0.0)
    share = np.append(half, 0.0) + np.append(0.0, half)
    if not share.sum() > 0.0:
        raise BadGeometry(f"prestress: wall '{load.wall}' has no masonry at x {part[0]:g} to {part[1]:g} m on top of storey {storey}")
    push[nodes, 2] -= load.force * share / share.sum()


def _rod(rod: Rod, k: int, xyz: np.ndarray, used: np.ndarray, building: Description, size: float) -> ShellBar:
    there, ends = np.flatnonzero(used), []
    for place in (rod.start, rod.end):
        away = np.linalg.norm(xyz[there] - np.asarray(place), axis=1)
        if away.min() > size:
            x, y, z = xyz[there[away.argmin()]]
            raise BadGeometry(
                f"rod {k}: its end at {', '.join(f'{v:g}' for v in place)} m lies {away.min():.3g} m from the nearest node, at "
                f"{x:g}, {y:g}, {z:g} m; expected a place on a wall, at a distance of at most one element ({size:g} m)"
            )
        ends.append(int(there[away.argmin()]))
    if ends[0] == ends[1]:
        raise BadGeometry(f"rod {k}: both ends of the rod are at one node")
    if rod.material not in building.materials:
        raise BadGeometry(f"rod {k}: the deck has no [materials.{rod.material}]")
    return ShellBar(f"rod {k}", (ends[0], ends[1]), rod.area, building.materials[rod.material], rod.prestress)


def _feet(plan: Plan, grids: list[_Grid], number: np.ndarray, kept: np.ndarray, used: np.ndarray) -> list[Foot]:
    """The soles of the walls on the ground; outward is across a wall, away from the middle of the plan."""
    middle = np.mean([end for wall in plan.walls for end in (wall.start, wall.end)], axis=0)
    feet = []
    for wall, grid in zip(plan.walls, grids, strict=True):
        nodes, s = _level_nodes(plan, 0, grid, number)
        there = used[nodes]
        across = np.array([-wall.direction[1], wall.direction[0], 0.0])
        if across[:2] @ (0.5 * np.add(wall.start, wall.end) - middle) < 0.0:
            across = -across
        feet.append(Foot(wall.name, kept[nodes[there]], np.tile(across, (int(there.sum()), 1)), s[there]))
    return feet


def _supports(
    plan: Plan, parts: Sequence[ShellPart | ShellJoint], xyz: np.ndarray, used: np.ndarray, above: np.ndarray
) -> tuple[list[tuple[int, int]], list[tuple[int, int, float]]]:
    """Nodes on the ground but those above a joint there are held, or stand on springs; nodes of floors alone only move in
    their plane."""
    held, springs = [], []
    bends = np.zeros(len(xyz), dtype=bool)
    for part in parts:
        if isinstance(part, ShellJoint) or part.bends:
            bends[part.connect] = True
    ground = np.flatnonzero((xyz[:, 2] <= MEETS) & used & ~above)
    if not len(ground):
        raise BadGeometry("no wall is on the ground: give a wall storeys from 1")
    rigid = plan.foundation_stiffness is None
    held += [(int(n), d) for n in ground for d in range(6) if rigid or d != 2]
    if not rigid:
        sole = np.zeros(len(xyz))
        for part in parts:
            low = part.connect[:, :2]
            on = (isinstance(part, ShellJoint) or part.bends) & (xyz[low, 2] <= MEETS).all(axis=1)
            half = 0.5 * np.linalg.norm(xyz[low[on, 0]] - xyz[low[on, 1]], axis=1) * part.thickness[on]
            np.add.at(sole, low[on], half[:, None])
        springs = [(int(n), 2, float(plan.foundation_stiffness * sole[n])) for n in ground]
    held += [(int(n), d) for n in np.flatnonzero(used & ~bends) for d in (2, 3, 4, 5)]
    return held, springs
