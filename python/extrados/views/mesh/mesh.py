"""A finite-element mesh: nodes, elements by group, boundary edges, and the nodes that a place in a deck means."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry
from extrados.model.places import Placed
from extrados.model.properties import Held, Material
from extrados.model.structures.walls import Bar, MeshedWall, TiedNodes
from extrados.views.mesh.options import MeshOptions

EDGES = {"T3": (0, 1, 2), "T6": (0, 1, 2), "Q4": (0, 1, 2, 3), "Q8": (0, 1, 2, 3)}


@dataclass(frozen=True)
class JointLaw:
    """What joints of no thickness are made of, each (elements); NaN where there is none."""

    normal: np.ndarray  # (elements, 2) from the lower to the upper side
    area: np.ndarray  # (elements, 2) of the pairs of nodes [m^2], 0 where the element before has it
    normal_stiffness: np.ndarray  # [Pa/m]
    shear_stiffness: np.ndarray  # [Pa/m]
    friction: np.ndarray  # NaN: no sliding
    cohesion: np.ndarray  # [Pa], 0 where there is none
    shear_energy: np.ndarray  # [N/m]
    tension: np.ndarray  # [Pa], 0 where there is none
    fracture_energy: np.ndarray  # [N/m]
    compressive_strength: np.ndarray  # [Pa]
    crushing_energy: np.ndarray  # [N/m]
    small: float  # stress by which overloads of dry joints are measured [Pa]
    softening: str


@dataclass(frozen=True)
class ElementGroup:
    """Elements of one kind and one integration rule."""

    kind: str
    connect: np.ndarray  # (elements, nodes) 0-based
    gauss: tuple[int, int]
    thickness: np.ndarray  # (elements) [m]
    material: np.ndarray  # (elements) index into Mesh.materials
    linear: np.ndarray  # (elements) bool
    axis: np.ndarray  # (elements) [rad], NaN where cracks choose
    band: float | None = None  # crack band [m]; None where the analysis sets it
    joint: np.ndarray | None = None  # (elements) the joint that a row of elements stands for
    dry: np.ndarray | None = None  # (elements) bool, of joints: no tensile strength
    law: JointLaw | None = None  # of joints of no thickness, whose elements are stretches: two nodes below, two above


@dataclass(frozen=True)
class Mesh:
    """xy (nodes, 2) [m]; size: typical element size [m]; held, ties and bars by the places where they act;
    named: further materials by name, for bars. Of stones: mass (nodes) [kg] that stands for the density of the
    elements, stone (nodes): the stone of each node, -1 where it is free of them, ground: nodes on the ground, held unless `held` says what is, joint_names of the rows of elements. rods: the [[ties]]
    of the building, each with its Rod (mesh/rods.py)."""

    xy: np.ndarray
    groups: list[ElementGroup]
    materials: list[Material]
    size: float
    held: list[Held]
    ties: list[TiedNodes] = field(default_factory=list)
    bars: list[Bar] = field(default_factory=list)
    named: dict[str, Material] = field(default_factory=dict)
    selective: bool = False
    warnings: list[str] = field(default_factory=list)
    mass: np.ndarray | None = None
    stone: np.ndarray | None = None
    ground: np.ndarray | None = None
    joint_names: list[str] = field(default_factory=list)
    rods: list[tuple[Any, Any]] = field(default_factory=list)

    def __repr__(self) -> str:
        return f"<Mesh: {len(self.xy)} nodes, {sum(len(group.connect) for group in self.groups)} elements>"

    @property
    def has_joints(self) -> bool:
        """Whether stones meet at interface elements."""
        return any(group.joint is not None for group in self.groups)

    @property
    def low(self) -> np.ndarray:
        """Least x and y (2) of the nodes [m]."""
        return self.xy.min(axis=0)

    @property
    def high(self) -> np.ndarray:
        """Greatest x and y (2) of the nodes [m]."""
        return self.xy.max(axis=0)

    def nodes_at(self, place: Placed, what: str) -> np.ndarray:
        """The nodes (0-based) a place means; BadGeometry where there are none."""
        tolerance = 1e-6 * float(np.max(self.high - self.low))
        inside = np.ones(len(self.xy), dtype=bool)
        if place.edge is not None:
            axis, end = {"left": (0, self.low), "right": (0, self.high), "bottom": (1, self.low), "top": (1, self.high)}[place.edge]
            inside &= np.abs(self.xy[:, axis] - end[axis]) <= tolerance
        point = [r[0] for r in (place.x, place.y) if r is not None and r[0] == r[1]]
        if len(point) == 2 and place.edge is None:
            distance = np.hypot(*(self.xy - point).T)
            nearest = int(distance.argmin())
            if distance[nearest] > 1.5 * self.size:
                raise BadGeometry(
                    f"{what}: no node near x {point[0]:g} m, y {point[1]:g} m; the nearest node is at {self.xy[nearest, 0]:g}, "
                    f"{self.xy[nearest, 1]:g}"
                )
            if distance[nearest] > 1e-3 * self.size:
                self.tell(
                    f"{what}: no node is at x {point[0]:g} m, y {point[1]:g} m. The nearest node is used instead, at {self.xy[nearest, 0]:g}, "
                    f"{self.xy[nearest, 1]:g}"
                )
            return np.array([nearest])
        for axis, ends in enumerate((place.x, place.y)):
            if ends is not None:
                inside &= (self.xy[:, axis] >= ends[0] - tolerance) & (self.xy[:, axis] <= ends[1] + tolerance)
        found = np.flatnonzero(inside)
        if not len(found):
            raise BadGeometry(f"{what}: no node lies within {words_of_place(place.edge, place.x, place.y)}. Add a mesh line there")
        return found

    def tell(self, warning: str) -> None:
        """A warning, once."""
        if warning not in self.warnings:
            self.warnings.append(warning)

    def shares_at(self, place: Placed, what: str) -> tuple[np.ndarray, np.ndarray]:
        """Nodes and shares (summing to 1) of a force on a place: equal ones of the nodes there; of a point between nodes
        those of the element it lies in, with the same resultant and moment."""
        point = [r[0] for r in (place.x, place.y) if r is not None and r[0] == r[1]]
        if len(point) == 2 and place.edge is None and np.hypot(*(self.xy - point).T).min() > 1e-6 * self.size:
            for group in self.groups:
                found = _within(self.xy, group, np.array(point))
                if found is not None:
                    return found
        nodes = self.nodes_at(place, what)
        return nodes, np.full(len(nodes), 1.0 / len(nodes))

    def boundary(self) -> tuple[np.ndarray, np.ndarray]:
        """Boundary edges (edges, 3): from, to, middle node or -1, counter-clockwise; and their thickness [m]."""
        rows, thick = [], []
        for group in self.groups:
            n = len(EDGES[group.kind])
            for i in range(n):
                middle = group.connect[:, n + i] if group.kind in ("T6", "Q8") else np.full(len(group.connect), -1)
                rows.append(np.column_stack([group.connect[:, i], group.connect[:, (i + 1) % n], middle]))
                thick.append(group.thickness)
        edges, thickness = np.concatenate(rows), np.concatenate(thick)
        ends = np.sort(edges[:, :2], axis=1)
        _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
        alone = np.sort(first[count == 1])
        return edges[alone], thickness[alone]

    def elements(self) -> int:
        """Number of elements, interfaces among them."""
        return sum(len(b.connect) for b in self.groups)


def _within(xy: np.ndarray, group: ElementGroup, point: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The triangle of an element's corners that a point lies in, and its area coordinates; None where it lies in none."""
    corners = group.connect[:, : corner_count(group.kind)]
    halves = [[0, 1, 2]] if corners.shape[1] == 3 else [[0, 1, 2], [0, 2, 3]]
    for half in halves:
        nodes = corners[:, half]
        a, b, c = (xy[nodes[:, k]] for k in range(3))
        one, two, to = b - a, c - a, point - a
        twice = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        s = (to[:, 0] * two[:, 1] - to[:, 1] * two[:, 0]) / twice
        t = (one[:, 0] * to[:, 1] - one[:, 1] * to[:, 0]) / twice
        inside = np.flatnonzero((s > -1e-9) & (t > -1e-9) & (s + t < 1.0 + 1e-9))
        if len(inside):
            k = int(inside[0])
            share = np.clip([1.0 - s[k] - t[k], s[k], t[k]], 0.0, 1.0)
            kept = share > 1e-9
            return nodes[k][kept], share[kept] / share.sum()
    return None


def words_of_place(edge: str | None, x: list[float] | None, y: list[float] | None) -> str:
    """A place in words, by the keys that are given: edge, ranges or values of x and y [m]."""
    ranges = [f"{name} {' to '.join(f'{end:g}' for end in dict.fromkeys(of))} m" for name, of in (("x", x), ("y", y)) if of is not None]
    return ", ".join([*([f"the {edge} edge"] if edge else []), *ranges])


def corner_count(kind: str) -> int:
    """Corners of an element kind."""
    return len(EDGES[kind])


def element_areas(xy: np.ndarray, kind: str, connect: np.ndarray) -> np.ndarray:
    """Areas [m^2] by the corners; negative where an element is inverted."""
    c = xy[connect[:, : corner_count(kind)]]
    x, y = c[..., 0], c[..., 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y, axis=1)


def add_middles(xy: np.ndarray, kind: str, connect: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements with a node in the middle of each side (T3 to T6, Q4 to Q8)."""
    n = corner_count(kind)
    sides = np.concatenate([np.column_stack([connect[:, i], connect[:, (i + 1) % n]]) for i in range(n)])
    ends, number = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    middles = 0.5 * (xy[ends[:, 0]] + xy[ends[:, 1]])
    number = number.reshape(n, len(connect)).T + len(xy)
    return np.concatenate([xy, middles]), np.column_stack([connect, number])


def build_mesh(
    wall: MeshedWall, building: Description, options: MeshOptions, xy: np.ndarray, kind: str, connect: np.ndarray, size: float
) -> Mesh:
    """Split the elements of a wall into groups by its regions; unused nodes are dropped, bad elements refused."""
    if options.joint_thickness is not None:
        raise BadGeometry(f"a structure of kind '{wall.kind}' has no joints: remove `joint_thickness` of the mesh")
    if options.joints is not None:
        raise BadGeometry(f"a structure of kind '{wall.kind}' has no blocks: remove `joints` of the mesh")
    if not len(connect):
        raise BadGeometry("the mesh has no elements")
    used, renumbered = np.unique(connect, return_inverse=True)
    xy, connect = xy[used], renumbered.reshape(connect.shape)
    area = element_areas(xy, kind, connect)
    scale = float(np.median(np.abs(area)))
    bad = np.flatnonzero(~(area > 1e-9 * scale))
    if len(bad):
        c = xy[connect[bad[0], : corner_count(kind)]].mean(axis=0)
        what = "inverted" if area[bad[0]] < -1e-9 * scale else "without area"
        raise BadGeometry(f"element {bad[0] + 1} at x {c[0]:g} m, y {c[1]:g} m is {what}; the mesh has {len(bad)} such elements")
    same = np.sort(connect, axis=1)
    _, counts = np.unique(same, axis=0, return_counts=True)
    if counts.max() > 1:
        raise BadGeometry(f"{int((counts - 1).sum())} elements occur twice in the mesh")

    names = list(building.materials)
    materials = [building.material, *building.materials.values()]
    count = len(connect)
    centre = xy[connect[:, : corner_count(kind)]].mean(axis=1)
    thickness, material = np.full(count, wall.thickness), np.zeros(count, dtype=int)
    linear, axis = np.zeros(count, dtype=bool), np.full(count, np.nan)
    default = (3, 3) if kind == "Q8" else (2, 2)
    rule = np.tile(default, (count, 1))
    warnings = []
    for i, region in enumerate(wall.regions):
        if region.edge is not None:
            raise BadGeometry("give a region by `x` and `y`, not by `edge`")
        inside = region.holds(centre)
        if not inside.any():
            warnings.append(f"region {i + 1} contains no element")
        if region.material is not None:
            material[inside] = 1 + names.index(region.material)
        if region.thickness is not None:
            thickness[inside] = region.thickness
        if region.gauss is not None:
            rule[inside] = region.gauss
        if region.crack_normal is not None:
            axis[inside] = np.radians(region.crack_normal)
        linear[inside] |= region.linear
    groups = []
    for gauss in np.unique(rule, axis=0):
        mine = (rule == gauss).all(axis=1)
        groups.append(
            ElementGroup(kind, connect[mine], (int(gauss[0]), int(gauss[1])), thickness[mine], material[mine], linear[mine], axis[mine])
        )
    held = building.supports.held or [Held(edge="bottom")]
    return Mesh(xy, groups, materials, size, held, wall.ties, wall.bars, building.materials, options.selective, warnings)
