"""Floors, roofs and gables of a plan: membranes, joists, masses and forces."""

from dataclasses import replace

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import signed_area
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, StoreyFloor
from extrados.schema.constants import GRAVITY
from extrados.views.mesh.triangles import fill_ring
from extrados.views.shell.mesh import ShellBar, ShellJoint, ShellPart
from extrados.views.shell.plan_grid import WallGrid, index_of, level_nodes
from extrados.views.shell.plan_joints import make_seat

#: What a rigid floor is: a concrete slab
RIGID_YOUNG, RIGID_THICKNESS = 30e9, 0.2


#: A wall, and the places along it [m] where a floor begins and ends
Part = tuple[int, float, float]
#: Nodes (n, 3) [m] with their masses (n) [kg] and forces (n, 3) [N]
Nodes = tuple[np.ndarray, np.ndarray, np.ndarray]


def add_gable(
    plan: Plan, w: int, grid: WallGrid, number: np.ndarray, xyz: np.ndarray, parts: list[ShellPart], names: list[str], size: float
) -> np.ndarray:
    """Triangles of the triangular top of a wall, on the nodes of its highest level; the nodes with those of the gable."""
    wall = plan.walls[w]
    last = plan.reach(wall)[1]
    foot, s = level_nodes(plan, last, grid, number)
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
            np.full(count, 0 if name is None else index_of(name, names, f"wall '{wall.name}'")),
            np.zeros(count, dtype=bool),
            np.ones(count),
            wall=w,
        )
    )
    on_plan = np.asarray(wall.start) + new[:, :1] * wall.direction
    return np.concatenate([xyz, np.column_stack([on_plan, plan.levels[last] + new[:, 1]])])


def ring_of_floor(plan: Plan, floor: StoreyFloor, grids: list[WallGrid], number: np.ndarray, xyz: np.ndarray) -> list[int]:
    """The nodes on the walls around a floor in order, counter-clockwise."""
    what = f"floor on storey {floor.storey}"
    walls = plan.around(floor)
    nodes: list[int] = []
    for w, start, end in walls:
        own, s = level_nodes(plan, floor.storey, grids[w], number)
        if not len(own):
            raise BadGeometry(f"{what}: wall '{plan.walls[w].name}' has no masonry at the level of the floor")
        inside = (s >= min(start, end) - MEETS) & (s <= max(start, end) + MEETS)
        order = np.argsort(s[inside] if end > start else -s[inside], kind="stable")
        nodes += own[inside][order].tolist()
    ring = [n for n, before in zip(nodes, nodes[-1:] + nodes[:-1], strict=True) if np.linalg.norm(xyz[n] - xyz[before]) > MEETS]
    if len(ring) < 3 or len(set(ring)) < len(ring):
        twice = next((n for k, n in enumerate(ring) if n in ring[:k]), None)
        fault = "encloses no area" if twice is None else f"passes twice through ({xyz[twice, 0]:.3g}, {xyz[twice, 1]:.3g}) m"
        raise BadGeometry(
            f"{what}: the walls {', '.join(plan.walls[w].name for w, _, _ in walls)} do not form a simple ring: this ring {fault}. "
            "Name the walls around the floor in order by `walls`"
        )
    x, y = xyz[ring, 0], xyz[ring, 1]
    if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0.0:
        ring.reverse()
    return ring


def seat_floor(
    plan: Plan, k: int, ring: list[int], grids: list[WallGrid], number: np.ndarray, nodes: Nodes, stiffness: float, joints: list[ShellJoint]
) -> tuple[Nodes, dict[int, int]]:
    """Nodes of floor k that rest on those of the walls around it, by these; its seats go into `joints`. None of a connected floor.

    stiffness: of a layer of masonry as thick as an element [Pa/m].
    """
    floor, (xyz, mass, push) = plan.floors[k], nodes
    if floor.seat is None:
        return nodes, {}
    above, outline = {n: len(xyz) + i for i, n in enumerate(ring)}, xyz[ring, :2]
    rows = [(part[0], *_beside(plan, floor, part, grids, number)) for part in plan.bearing(floor, plan.around(floor))]
    for n in (n for _, own, _ in rows for n in own.tolist() if n not in above):  # beside the node of another wall
        above[n] = above[ring[int(np.linalg.norm(xyz[ring] - xyz[n], axis=1).argmin())]]
    pressure = floor.weight * abs(signed_area(outline)) / (sum(float(np.ptp(s)) for _, _, s in rows) * floor.seat.length)
    for w, own, s in rows:
        wall = plan.walls[w]
        across = np.array([-wall.direction[1], wall.direction[0], 0.0])
        inward = across if across[:2] @ (outline.mean(axis=0) - np.asarray(wall.start)) > 0.0 else -across
        upper = np.array([above[n] for n in own.tolist()])
        name = f"floor {k + 1} of storey {floor.storey}"
        joints.append(make_seat(floor.seat, name, wall, s, np.column_stack([own, upper]), inward, pressure, stiffness))
    mass, push = (np.concatenate([of, np.zeros((len(ring), *of.shape[1:]))]) for of in (mass, push))
    return (np.concatenate([xyz, xyz[ring]]), mass, push), above


def add_floor(
    plan: Plan,
    floor: StoreyFloor,
    ring: list[int],
    grids: list[WallGrid],
    number: np.ndarray,
    nodes: Nodes,
    above: dict[int, int],
    parts: list[ShellPart],
    materials: list[Material],
    bars: list[ShellBar],
    size: float,
) -> Nodes:
    """Elements, bars and masses of a floor; the nodes with those within it. ring: the nodes of the walls around it; above: its own nodes
    over them, of a floor on seats."""
    xyz, mass, push = nodes
    level = float(plan.levels[floor.storey])
    outline = xyz[ring, :2]
    x, y = outline.T
    area = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    name = f"floor {floor.storey}"
    ends = plan.around(floor)
    if floor.load > 0.0:
        shares = np.sum([_shares(plan, floor, part, grids, number, len(xyz)) for part in plan.bearing(floor, ends)], axis=0)
        own = np.flatnonzero(shares)
        mass = mass.copy()
        np.add.at(mass, [above.get(n, n) for n in own.tolist()], floor.weight * area / GRAVITY * shares[own] / shares.sum())
    for w, start, end, force in plan.thrusts(floor, ends):
        shares = _shares(plan, floor, (w, start, end), grids, number, len(xyz))
        push = push.copy()
        push[:, :2] += shares[:, None] / shares.sum() * force
    if floor.kind in ("flexible", "rigid"):
        thickness = floor.flatness * (RIGID_THICKNESS if floor.thickness is None else floor.thickness)
        young = floor.young if floor.kind == "flexible" else RIGID_YOUNG
        inner, triangles = fill_ring(outline, size)
        new = inner[len(ring) :]
        place = np.concatenate([[above.get(n, n) for n in ring], len(xyz) + np.arange(len(new))]).astype(int)
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
        for bar in _joists(plan, floor, grids, number, xyz, name):
            one, two = (above.get(n, n) for n in bar.nodes)
            bars.append(replace(bar, nodes=(one, two)))
    return xyz, mass, push


def _beside(plan: Plan, floor: StoreyFloor, part: Part, grids: list[WallGrid], number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nodes of a part of a wall beside a floor, and their distances along it [m], also where another wall meets it without a bond."""
    w, start, end = part
    own, s = level_nodes(plan, floor.storey, grids[w], number)
    on = (s >= min(start, end) - MEETS) & (s <= max(start, end) + MEETS)
    return own[on], s[on]


def _shares(plan: Plan, floor: StoreyFloor, part: Part, grids: list[WallGrid], number: np.ndarray, count: int) -> np.ndarray:
    """Length (count) [m] of a part of a wall beside a floor at each of the nodes."""
    shares = np.zeros(count)
    own, s = _beside(plan, floor, part, grids, number)
    half = np.diff(s) / 2.0
    np.add.at(shares, own, np.append(half, 0.0) + np.append(0.0, half))
    if not shares.sum() > 0.0:
        raise BadGeometry(
            f"floor on storey {floor.storey}: wall '{plan.walls[part[0]].name}' has no masonry at the level of the floor to carry its load"
        )
    return shares


def _joists(plan: Plan, floor: StoreyFloor, grids: list[WallGrid], number: np.ndarray, xyz: np.ndarray, name: str) -> list[ShellBar]:
    """Joists as bars from each node of a wall across to the nearest of the other, of the area that stands for it."""
    one, two = (next(i for i, w in enumerate(plan.walls) if w.name == word) for word in floor.bears_on)
    parts = {part[0]: part for part in plan.around(floor)}
    own, s = _beside(plan, floor, parts[one], grids, number)
    far, _ = _beside(plan, floor, parts[two], grids, number)
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
