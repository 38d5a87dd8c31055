"""The mesher of buildings on a plan: walls as grids that meet at corners, openings and storeys, floors between them."""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry, blaming
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, Prestress, Rod, meeting, nearly_meeting
from extrados.views.mesh.options import LARGEST_MESH
from extrados.views.shell.mesh import Foot, ShellBar, ShellJoint, ShellMesh, ShellPart, WallPlane, pieces
from extrados.views.shell.options import ShellOptions
from extrados.views.shell.plan_floors import add_floor, add_gable, ring_of_floor, seat_floor
from extrados.views.shell.plan_grid import (
    WallGrid,
    holes_of,
    index_of,
    join_grids,
    level_nodes,
    lintels_of,
    make_grids,
    ring_beams_of,
    thickness_at,
)
from extrados.views.shell.plan_joints import make_joints, strength_of_joint


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
    warnings = plan.floor_remarks
    junctions = _junctions(plan, warnings)
    _check_corners(plan, junctions)
    grids = make_grids(plan, junctions, size, warnings)
    xyz, number = join_grids(plan, grids, junctions)
    materials, names = [building.material, *building.materials.values()], list(building.materials)
    parts = _wall_parts(plan, grids, junctions, number, names)
    joints, sources = make_joints(plan, grids, junctions, number, parts, len(xyz))
    joints = [
        replace(joint, strength=strength_of_joint(plan, building, joint.name, size), softening=building.joints.softening)
        for joint in joints
    ]
    if joints and building.joints.coefficient is not None and not all(j.strength["cohesion"] > 0.0 for j in joints):
        warnings.append(
            "joints without cohesion slide only after they open. To let them slide under compression, give "
            "any `cohesion` with its `shear_energy`"
        )
    xyz = np.concatenate([xyz, xyz[sources]])
    planes = [_plane(plan, grid) for grid in grids]
    mass, push = np.zeros(len(xyz)), np.zeros((len(xyz), 3))
    bars, grown = list[ShellBar](), xyz
    for w, wall in enumerate(plan.walls):
        if wall.gable is not None:
            grown = add_gable(plan, w, grids[w], number, grown, parts, names, size)
    mass, push = (np.concatenate([of, np.zeros((len(grown) - len(of), *of.shape[1:]))]) for of in (mass, push))
    rings: dict[tuple[int, frozenset[int]], int] = {}
    for k, floor in enumerate(plan.floors):
        with blaming("floors", k):
            ring = ring_of_floor(plan, floor, grids, number, xyz)
            if (first := rings.setdefault((floor.storey, frozenset(ring)), k)) != k:
                raise BadGeometry(f"floor {first + 1} is given for the same walls on storey {floor.storey}")
            nodes, over = seat_floor(plan, k, ring, grids, number, (grown, mass, push), building.material.young / size, joints)
            grown, mass, push = add_floor(plan, floor, ring, grids, number, nodes, over, parts, materials, bars, size)
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
        warnings.append("ring beams remain elastic in the shell model: their reinforcement is not considered")
    warnings += _apart(plan, parts, bars, joints, grown)
    held = _propped(plan, grids, number, held)
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


def _wall_parts(plan: Plan, grids: list[WallGrid], junctions: dict, number: np.ndarray, names: list[str]) -> list[ShellPart]:
    """The shells of all walls, with the ring beams in them; a wrong name of a material is refused at its key."""
    for k, beam in enumerate(plan.ring_beams):
        with blaming("ring_beams", k):
            index_of(beam.material, names, f"ring beam of storey {beam.storey}")
    parts = []
    for w in range(len(grids)):
        with blaming("walls", w):
            parts.append(_wall_part(plan, w, grids, junctions, number, names))
    return parts


def _propped(plan: Plan, grids: list[WallGrid], number: np.ndarray, held: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Held nodes and directions, with those of the props: across their walls, along the nearer axis."""
    for prop in plan.props:
        w = next(i for i, wall in enumerate(plan.walls) if wall.name == prop.wall)
        nodes, _ = level_nodes(plan, prop.storey, grids[w], number)
        held = sorted({*held, *((int(n), int(np.abs(plan.walls[w].direction).argmin())) for n in nodes)})
    return held


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
    return [(f"no corner, floor or rod connects the following parts with each other: {' with '.join(', '.join(names) for names in alone)}")]


def _plane(plan: Plan, grid: WallGrid) -> WallPlane:
    wall = grid.wall
    return WallPlane(wall.name, np.asarray(wall.start, dtype=float), wall.direction, wall.length, holes_of(plan, wall))


def _wall_part(plan: Plan, w: int, grids: list[WallGrid], junctions: dict, number: np.ndarray, names: list[str]) -> ShellPart:
    grid, wall = grids[w], plan.walls[w]
    i, k = np.nonzero(grid.there)
    if not len(i):
        raise BadGeometry(f"wall '{wall.name}': the openings occupy the whole wall")
    corners = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)]
    connect = np.column_stack([number[grid.number(a, b)] for a, b in corners])
    thickness = thickness_at(plan, wall, 0.5 * (grid.z[k] + grid.z[k + 1]))
    reach = plan.reach(wall)
    of_storey = [plan.material_of(wall, storey) for storey in range(reach[0], reach[1] + 1)]
    index = np.array([0 if name is None else index_of(name, names, f"wall '{wall.name}'") for name in of_storey])
    material = index[np.searchsorted(plan.levels, 0.5 * (grid.z[k] + grid.z[k + 1])) - reach[0]]
    linear, strength = np.zeros(len(i), dtype=bool), np.ones(len(i))
    for *box, name in lintels_of(plan, wall):
        inside = grid.cells((box[0], box[1]), (box[2], box[3]))[i, k]
        if not inside.any():
            raise BadGeometry(
                f"wall '{wall.name}': a lintel at x {box[0]:g} to {box[1]:g}, z {box[2]:g} to {box[3]:g} m lies entirely within openings"
            )
        linear |= inside
        if name is not None:
            material[inside] = index_of(name, names, f"a lintel of wall '{wall.name}'")
    for beam, *box in ring_beams_of(plan, wall):
        inside = grid.cells((box[0], box[1]), (box[2], box[3]))[i, k]
        linear |= inside
        material[inside] = index_of(beam.material, names, f"ring beam of storey {beam.storey}")
    for (a, b), (s, t) in junctions.items():
        corner = plan.bond(plan.walls[a].name, plan.walls[b].name) if w in (a, b) else None
        if corner is None or corner.bond != "weak" or corner.walls[1] != wall.name:
            continue
        column = int(np.abs(grid.s - (s if a == w else t)).argmin())
        strength[(i == column) | (i == column - 1)] *= corner.strength
    return ShellPart(wall.name, "Q4", connect, thickness, material, linear, strength, wall=w)


def _prestress(plan: Plan, load: Prestress, grids: list[WallGrid], number: np.ndarray, used: np.ndarray, push: np.ndarray) -> None:
    """The force along the top of a wall as nodal forces."""
    w = next(i for i, wall in enumerate(plan.walls) if wall.name == load.wall)
    storey = load.level or plan.reach(plan.walls[w])[1]
    nodes, s = level_nodes(plan, storey, grids[w], number)
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


def _feet(plan: Plan, grids: list[WallGrid], number: np.ndarray, kept: np.ndarray, used: np.ndarray) -> list[Foot]:
    """The soles of the walls on the ground; outward is across a wall, away from the middle of the plan."""
    middle = np.mean([end for wall in plan.walls for end in (wall.start, wall.end)], axis=0)
    feet = []
    for wall, grid in zip(plan.walls, grids, strict=True):
        nodes, s = level_nodes(plan, 0, grid, number)
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
    their plane, on a seat up and down too."""
    held, springs = [], []
    bends, seated = np.zeros(len(xyz), dtype=bool), np.zeros(len(xyz), dtype=bool)
    for part in parts:
        if isinstance(part, ShellJoint) and part.floor:
            seated[part.connect[:, 2:]] = True
        elif isinstance(part, ShellJoint) or part.bends:
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
    held += [(int(n), d) for n in np.flatnonzero(used & ~bends) for d in ((3, 4, 5) if seated[n] else (2, 3, 4, 5))]
    return held, springs
