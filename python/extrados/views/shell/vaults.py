"""Vaults and domes as curved shells: barrels, barrels on walls, domes, groin vaults.

All lie where the stones of the same structure do: the centre of the circle at height 0, barrels along y. Their normals look
outward, so that the last layer is the extrados.
"""

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry, NoView
from extrados.model.properties import Material
from extrados.model.structures.arch import Arch
from extrados.model.structures.cross_vault import CrossVault
from extrados.model.structures.dome import Dome
from extrados.model.structures.vault import Vault
from extrados.schema.constants import IN_SPACE
from extrados.views.mesh.options import LARGEST_MESH
from extrados.views.shell.mesh import Foot, ShellMesh, ShellPart
from extrados.views.shell.options import ShellOptions

#: Elements along the arc of a section where no size is asked for
ALONG = 32
#: Nodes nearer to each other than this part of the size of an element are one
SAME = 1e-6
#: A wall under a vault thicker than this part of its height is no shell
THICK_WALL = 0.5


def count_along(length: float, size: float, least: int = 1) -> int:
    """How many elements of a size stand along a length."""
    return max(least, round(length / size))


def element_size(options: ShellOptions, arc: float, area: float) -> float:
    """The size of the elements; BadGeometry where that makes too many."""
    size = options.size or arc / ALONG
    if area / size**2 > LARGEST_MESH:
        raise BadGeometry(f"the mesh would have about {area / size**2:.2g} elements of {size:g} m; at most {LARGEST_MESH:g} are allowed")
    return size


def _grid(rows: int, columns: int, first: int = 0) -> np.ndarray:
    """Quadrilaterals of a grid of (rows + 1) x (columns + 1) nodes, numbered row after row."""
    i, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    at = first + i * (columns + 1) + j
    return np.column_stack([at, at + 1, at + columns + 2, at + columns + 1])


def _outward(xyz: np.ndarray, connect: np.ndarray, out: np.ndarray) -> np.ndarray:
    """The elements with their nodes in the order that makes the normal look to the side of `out` (elements, 3)."""
    c = xyz[connect]
    normal = np.cross(c[:, 2] - c[:, 0], c[:, -1] - c[:, 1])
    turned = np.roll(connect[:, ::-1], 1, axis=1)
    return np.where((np.einsum("ex,ex->e", normal, out) < 0.0)[:, None], turned, connect)


def shell_part(name: str, xyz: np.ndarray, connect: np.ndarray, out: np.ndarray, thickness: float, material: int = 0) -> ShellPart:
    """Elements of one thickness [m], their normals to the side of `out` (elements, 3)."""
    count = len(connect)
    return ShellPart(
        name,
        "Q4" if connect.shape[1] == 4 else "T3",
        _outward(xyz, connect, out),
        np.full(count, thickness),
        np.full(count, material),
        np.zeros(count, dtype=bool),
        np.ones(count),
    )


def clamped_mesh(
    xyz: np.ndarray, parts: list[ShellPart], feet: list[Foot], building: Description, size: float, extra: list[Material]
) -> ShellMesh:
    """The mesh on its feet, which are held in all freedoms."""
    held = sorted({(int(n), d) for foot in feet for n in foot.nodes for d in range(6)})
    materials = [building.material, *building.materials.values(), *extra]
    levels = np.array([xyz[:, 2].min(), xyz[:, 2].max()])
    return ShellMesh(xyz, parts, [], levels, materials, size, held, [], [], np.zeros(len(xyz)), np.zeros((len(xyz), 3)), feet=feet)


def mesh_barrel(
    building: Description,
    options: ShellOptions,
    radius: float,
    thickness: float,
    embrace: float,
    length: float,
    walls: tuple[float, float, float] | None = None,
) -> ShellMesh:
    """Barrel vault of a circular section, `length` along y; embrace in degrees, lengths in m.

    It stands on its springings, or on walls: their thickness, the distance of their middle planes from the axis, and the
    height of their soles; a stiff ledge joins the springing to a wall that does not stand right below it.
    """
    half = np.radians(0.5 * embrace)
    size = element_size(options, 2.0 * half * radius, (2.0 * half * radius + (2.0 * abs(walls[2]) if walls else 0.0)) * length)
    along, across = count_along(2.0 * half * radius, size, 4), count_along(length, size)
    angle = np.linspace(-half, half, along + 1)
    y = np.linspace(0.0, length, across + 1)

    def sheet(section: np.ndarray) -> np.ndarray:
        """Nodes of a line (x, z) of the section drawn out along y."""
        return np.column_stack([np.repeat(section[:, 0], across + 1), np.tile(y, len(section)), np.repeat(section[:, 1], across + 1)])

    xyz = sheet(radius * np.column_stack([np.sin(angle), np.cos(angle)]))
    connect = _grid(along, across)
    middle = xyz[connect].mean(axis=1)
    parts = [shell_part("vault", xyz, connect, middle * [1.0, 0.0, 1.0], thickness)]
    ends = {-1: np.arange(across + 1), 1: along * (across + 1) + np.arange(across + 1)}
    extra: list[Material] = []
    if walls is not None:
        wide, away, sole = walls
        springing = radius * np.array([np.sin(half), np.cos(half)])
        if wide > THICK_WALL * (springing[1] - sole):
            raise BadGeometry(
                f"the walls are {wide:g} m thick and {springing[1] - sole:.4g} m high. Shells require a thickness below "
                f"{THICK_WALL:g} of the height"
            )
        extra = [Material(density=0.0, young=building.material.young, poisson=building.material.poisson)]
        ledge, up = abs(away - springing[0]), count_along(springing[1] - sole, size, 2)
        for side, word in ((-1, "left"), (1, "right")):
            top = ends[side]
            if ledge > SAME * size:
                xyz, top = (np.concatenate([xyz, sheet(np.array([[side * away, springing[1]]]))]), len(xyz) + np.arange(across + 1))
                strip = np.column_stack([ends[side][:-1], ends[side][1:], top[1:], top[:-1]])
                stiff = shell_part(f"{word} ledge", xyz, strip, np.tile([0.0, 0.0, 1.0], (across, 1)), wide, 1 + len(building.materials))
                stiff.linear[:] = True
                parts.append(stiff)
            level = np.linspace(springing[1], sole, up + 1)[1:]
            first = len(xyz)
            xyz = np.concatenate([xyz, sheet(np.column_stack([np.full(up, side * away), level]))])
            below = np.column_stack([top[:-1], top[1:], first + np.arange(1, across + 1), first + np.arange(across)])
            connect = np.concatenate([below, _grid(up - 1, across, first)])
            parts.append(shell_part(f"{word} wall", xyz, connect, np.tile([side, 0.0, 0.0], (len(connect), 1)), wide))
            ends[side] = first + (up - 1) * (across + 1) + np.arange(across + 1)
    feet = [Foot(word, ends[side], np.tile([float(side), 0.0, 0.0], (across + 1, 1)), y) for side, word in ((-1, "left"), (1, "right"))]
    return clamped_mesh(xyz, parts, feet, building, size, extra)


def mesh_dome(building: Description, options: ShellOptions, radius: float, thickness: float, embrace: float, oculus: float) -> ShellMesh:
    """Spherical dome on its springing; embrace and oculus in degrees. Without an oculus triangles close the crown."""
    half, top = np.radians(0.5 * embrace), np.radians(0.5 * oculus)
    area = 2.0 * np.pi * radius**2 * (np.cos(top) - np.cos(half))
    size = element_size(options, 2.0 * half * radius, area)
    around = 4 * count_along(0.5 * np.pi * radius * np.sin(half), size, 2)
    up = count_along(radius * (half - top), size, 2)
    polar = np.linspace(half, top, up + 1)
    rows = up + 1 if oculus > 0.0 else up
    turn = 2.0 * np.pi * np.arange(around) / around
    xyz = radius * np.column_stack(
        [
            np.outer(np.sin(polar[:rows]), np.cos(turn)).ravel(),
            np.outer(np.sin(polar[:rows]), np.sin(turn)).ravel(),
            np.repeat(np.cos(polar[:rows]), around),
        ]
    )
    i, k = (x.ravel() for x in np.meshgrid(np.arange(rows - 1), np.arange(around), indexing="ij"))
    on = (k + 1) % around
    connect = np.column_stack([i * around + k, i * around + on, (i + 1) * around + on, (i + 1) * around + k])
    if rows == up:
        xyz = np.concatenate([xyz, [[0.0, 0.0, radius]]])
    parts = [shell_part("dome", xyz, connect, xyz[connect].mean(axis=1), thickness)]
    if rows == up:
        k = np.arange(around)
        cap = np.column_stack([(up - 1) * around + k, (up - 1) * around + (k + 1) % around, np.full(around, len(xyz) - 1)])
        parts.append(shell_part("crown", xyz, cap, xyz[cap].mean(axis=1), thickness))
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(around)])
    foot = Foot("springing", np.arange(around), out, radius * np.sin(half) * turn)
    return clamped_mesh(xyz, parts, [foot], building, size, [])


#: Corners of a groin vault, as its springers are called, and their quadrants
CORNERS = {"north-east": (1, 1), "north-west": (-1, 1), "south-west": (-1, -1), "south-east": (1, -1)}


def mesh_cross_vault(
    building: Description, options: ShellOptions, radius: float, thickness: float, embrace: float, edge: float, oblong: float
) -> ShellMesh:
    """Two barrels that cross over a bay, mitred along the groins; each corner stands on the ends of its two webs.

    edge: how far the webs reach beyond the corner of the extrados [m]; oblong: length over width of the bay.
    """
    half = np.radians(0.5 * embrace)
    reach = (radius + 0.5 * thickness) * np.sin(half) + edge
    size = element_size(options, 2.0 * half * radius, 4.0 * half * radius * reach * max(oblong, 1.0))
    rows, columns = count_along(half * radius, size, 4), count_along(0.6 * reach, size, 2)
    angle = np.linspace(0.0, half, rows + 1)
    x, z = radius * np.sin(angle), radius * np.cos(angle)
    share = np.linspace(0.0, 1.0, columns + 1)
    y = x[:, None] + (reach - x[:, None]) * share  # of the half web x > 0, y > x
    half_web = np.stack([np.broadcast_to(x[:, None], y.shape), y, np.broadcast_to(z[:, None], y.shape)], axis=-1).reshape(-1, 3)
    points: list[np.ndarray] = []
    elements: list[np.ndarray] = []
    out: list[np.ndarray] = []
    quads = _grid(rows, columns)
    feet: dict[str, list[np.ndarray]] = {word: [] for word in CORNERS}
    for word, (right, ahead) in CORNERS.items():
        for swap in (False, True):
            own = (half_web[:, [1, 0, 2]] if swap else half_web) * [right, ahead, 1.0]
            count = len(points) * len(half_web)
            elements.append(quads + count)
            out.append(own[quads].mean(axis=1) * ([0.0, 1.0, 1.0] if swap else [1.0, 0.0, 1.0]))
            feet[word].append(count + rows * (columns + 1) + np.arange(columns + 1))
            points.append(own * [1.0, oblong, 1.0])
    every = np.concatenate(points)
    _, first, number = np.unique(np.round(every / (SAME * size)).astype(np.int64), axis=0, return_index=True, return_inverse=True)
    number = number.ravel()
    xyz, connect = every[first], number[np.concatenate(elements)]
    parts = [shell_part("vault", xyz, connect, np.concatenate(out), thickness)]
    made = []
    for word, (right, ahead) in CORNERS.items():
        nodes = np.unique(number[np.concatenate(feet[word])])
        way = np.array([right, ahead * oblong, 0.0]) / np.hypot(1.0, oblong)
        made.append(Foot(word, nodes, np.tile(way, (len(nodes), 1)), np.arange(len(nodes), dtype=float)))
    return clamped_mesh(xyz, parts, made, building, size, [])


def shell_of_arch(building: Description, options: ShellOptions) -> ShellMesh:
    """An arch as a barrel vault on its springings."""
    arch = building.structure
    assert isinstance(arch, Arch)
    if arch.skew:
        raise NoView(f"a skew arch cannot be modelled by shells; {IN_SPACE}", ("structure", "skew"))
    return mesh_barrel(building, options, arch.radius, arch.thickness * arch.thickness_factor, arch.embrace, arch.depth)


def shell_of_vault(building: Description, options: ShellOptions) -> ShellMesh:
    """A vault on walls as thick as the buttresses, their middle planes where those have them."""
    vault = building.structure
    assert isinstance(vault, Vault)
    section = vault.assembly(building.material.density, building.folder)
    outline = section.outlines[section.buttresses[1]]
    back, sole = float(outline[:, 0].max()), float(outline[:, 1].min())
    return mesh_barrel(
        building, options, vault.radius, vault.thickness, vault.embrace, vault.depth, (back - vault.face, 0.5 * (back + vault.face), sole)
    )


def shell_of_dome(building: Description, options: ShellOptions) -> ShellMesh:
    """A dome on its springing."""
    dome = building.structure
    assert isinstance(dome, Dome)
    return mesh_dome(building, options, dome.radius, dome.thickness * dome.thickness_factor, dome.embrace, dome.oculus)


def shell_of_cross_vault(building: Description, options: ShellOptions) -> ShellMesh:
    """A groin vault on its four corners."""
    vault = building.structure
    assert isinstance(vault, CrossVault)
    edge = vault.thickness if vault.edge is None else vault.edge
    thickness = vault.thickness * vault.thickness_factor
    return mesh_cross_vault(building, options, vault.radius, thickness, vault.embrace, edge, vault.oblong)
