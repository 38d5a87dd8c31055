"""What is read off a state of a pushed building: forces in sections of its walls, drifts, cracks."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from extrados.analyses.shell.model import ShellModel, nodes_on


@dataclass(frozen=True)
class Section:
    """A horizontal section through a pier, or a whole wall: forces [N], moment about its middle [N m]."""

    wall: int
    storey: int  # from 1
    start: float  # along the wall [m]
    end: float
    normal: float  # compression negative
    shear: float  # in the wall's plane, along it
    moment: float


def plane_stresses(report: dict[str, np.ndarray]) -> np.ndarray:
    """Stresses x, y, xy (3, ...) in the axes of the elements [Pa]."""
    c, s = report["cos"], report["sin"]
    n, t, g = report["stress_n"], report["stress_s"], report["stress_ns"]
    return np.stack([c**2 * n + s**2 * t - 2 * c * s * g, s**2 * n + c**2 * t + 2 * c * s * g, c * s * (n - t) + (c**2 - s**2) * g])


def sections(model: ShellModel, report: dict[str, np.ndarray]) -> list[Section]:
    """Forces in all piers at the foot of each storey, from the lowest row of elements of the storey.

    Exact for the forces at the nodes by virtual work: all above the row moves along the wall, or up, and strains the row
    alone, evenly. The moment is that of the normal stresses about the middle of the pier.
    """
    return [
        section
        for wall in range(len(model.mesh.walls))
        for storey, level in enumerate(model.mesh.levels[:-1], 1)
        for section in _sections(model, report, wall, storey, partial(_begins_at, level))
    ]


def sections_at(model: ShellModel, report: dict[str, np.ndarray], wall: int, storey: int, height: float) -> list[Section]:
    """Forces in the piers of a wall that a height cuts, from the row of elements there."""
    return _sections(model, report, wall, storey, lambda low, high: (low <= height) & (high > height))


def _begins_at(level: float, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Whether elements have their lower end at a height [m]."""
    return np.abs(low - level) < 1e-6


def _sections(
    model: ShellModel, report: dict[str, np.ndarray], wall: int, storey: int, of_row: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> list[Section]:
    """Of the row of elements of a wall that their lower and upper ends say."""
    found = []
    for part, points, layers in model.places():
        if part.wall != wall or part.kind != "Q4":  # triangles are those of a gable
            continue
        corner = model.mesh.walls[wall].unfolded(model.mesh.xyz[part.connect.ravel()]).reshape(*part.connect.shape, 2)
        low, high = corner[..., 1].min(axis=1), corner[..., 1].max(axis=1)
        left, right = corner[..., 0].min(axis=1), corner[..., 0].max(axis=1)
        row = np.flatnonzero(of_row(low, high))
        row = row[np.argsort(left[row], kind="stable")]
        if not len(row):
            continue
        own = {name: values[points].reshape(len(left), -1)[row] for name, values in report.items()}
        stress, volume = plane_stresses(own), own["volume"]
        tall, at = (high - low)[row, None], _along(corner[row], layers)
        gaps = np.flatnonzero(left[row][1:] > right[row][:-1] + 1e-6) + 1
        for pier in np.split(np.arange(len(row)), gaps):
            start, end = float(left[row[pier[0]]]), float(right[row[pier[-1]]])
            up = stress[1, pier] * volume[pier] / tall[pier]
            found.append(
                Section(
                    wall,
                    storey,
                    start,
                    end,
                    float(up.sum()),
                    float((stress[2, pier] * volume[pier] / tall[pier]).sum()),
                    float((up * (0.5 * (start + end) - at[pier])).sum()),
                )
            )
    return found


def _along(corner: np.ndarray, layers: int) -> np.ndarray:
    """Place along the wall of all points (elements, points) [m]."""
    if corner.shape[1] == 3:
        share = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6.0
    else:
        g = np.sqrt(1.0 / 3.0)
        r, s = np.array([-g, g, -g, g]), np.array([-g, -g, g, g])
        share = 0.25 * np.column_stack([(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)])
    return np.repeat(np.einsum("pc,ec->ep", share, corner[..., 0]), layers, axis=1)


def point_places(model: ShellModel) -> dict[str, np.ndarray]:
    """Of each place in the plane of the walls: part, wall (-1 none), s and z on the wall [m], storey from 1."""
    columns: dict[str, list[np.ndarray]] = {"part": [], "wall": [], "s": [], "z": [], "storey": [], "element": []}
    first = 0
    for number, (part, _, _) in enumerate(model.places()):
        corner = model.mesh.xyz[part.connect]
        if part.wall >= 0:
            flat = model.mesh.walls[part.wall].unfolded(corner.reshape(-1, 3)).reshape(*part.connect.shape, 2)
        else:
            flat = corner[..., :2]
        s, z = _along(flat, 1), _along(flat[..., ::-1], 1)
        count = s.size
        columns["part"].append(np.full(count, number))
        columns["wall"].append(np.full(count, part.wall))
        columns["s"].append(s.ravel())
        columns["z"].append(z.ravel())
        height = _along(corner[..., 2][..., None], 1).ravel()
        columns["storey"].append(np.clip(np.searchsorted(model.mesh.levels, height), 1, len(model.mesh.levels) - 1))
        columns["element"].append(first + np.repeat(np.arange(len(part.connect)), s.shape[1]))
        first += len(part.connect)
    return {name: np.concatenate(column) for name, column in columns.items()}


def place_axes(model: ShellModel) -> dict[str, np.ndarray]:
    """Of each place in the shells: where it is [m], and the x and y axes of its element, all (places, 3)."""
    columns: dict[str, list[np.ndarray]] = {"xyz": [], "x_axis": [], "y_axis": []}
    for number, (part, _, _) in enumerate(model.places()):
        corner = model.mesh.xyz[part.connect]
        columns["xyz"].append(np.stack([_along(corner[..., d, None], 1).ravel() for d in range(3)], axis=1))
        per = 4 if part.kind == "Q4" else 3
        own = model.axes[[k for k, p in enumerate(model.mesh.parts) if p.bends][number]]
        columns["x_axis"].append(np.repeat(own[:, 0], per, axis=0))
        columns["y_axis"].append(np.repeat(own[:, 1], per, axis=0))
    return {name: np.concatenate(column) for name, column in columns.items()}


def cracks(model: ShellModel, report: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Of each place in the plane of the walls: greatest width of a crack through the thickness [m], the angle of its
    normal to the element's x axis [rad], where through the thickness that is, from -1 to 1 on the side of the normal, and the
    part of the thickness that has cracked."""
    young = []
    for part, _, layers in model.places():
        each = np.array([m.young for m in model.mesh.materials])[part.material]
        young.append(np.repeat(each, (4 if part.kind == "Q4" else 3) * layers))
    count = sum(len(y) for y in young)
    r = {name: _of_walls(model, values) for name, values in report.items()}
    modulus = np.concatenate(young)
    assert len(modulus) == count == len(r["cos"])
    widths = []
    for k in "ns":
        extra = np.maximum(r[f"strain_{k}"] - r[f"stress_{k}"] / modulus, 0.0) * r["band"]
        widths.append(np.where(r[f"ratio_{k}"] < 1.0, extra, 0.0))
    angle = np.arctan2(r["sin"], r["cos"])
    width, turned = np.maximum(*widths), np.where(widths[1] > widths[0], angle + 0.5 * np.pi, angle)
    cracked = (r["tooth_n"] > 1) | (r["tooth_s"] > 1)
    out: dict[str, list[np.ndarray]] = {"width": [], "angle": [], "side": [], "part": []}
    first = 0
    for part, _, layers in model.places():
        n = len(part.connect) * (4 if part.kind == "Q4" else 3) * layers
        rows = slice(first, first + n)
        first += n
        w = width[rows].reshape(-1, layers)
        at = w.argmax(axis=1)
        out["width"].append(w.max(axis=1))
        out["angle"].append(turned[rows].reshape(-1, layers)[np.arange(len(w)), at])
        out["side"].append(2.0 * at / max(layers - 1, 1) - 1.0)
        volume = r["volume"][rows].reshape(-1, layers)
        out["part"].append((cracked[rows].reshape(-1, layers) * volume).sum(axis=1) / volume.sum(axis=1))
    return {name: np.concatenate(column) for name, column in out.items()}


def _of_walls(model: ShellModel, values: np.ndarray) -> np.ndarray:
    """The points of parts that bend."""
    return np.concatenate([values[points] for _, points, _ in model.places()])


def drifts(model: ShellModel, displacement: np.ndarray, sign: int) -> tuple[np.ndarray, np.ndarray]:
    """Drift of each storey along the push, of the whole and (walls, storeys) of each wall: the difference of the mean
    displacements of its top and foot over its height; NaN where a wall has none."""
    mesh, along = model.mesh, model.along
    if not mesh.walls:
        return np.empty(0), np.empty((0, 0))
    moved = sign * (displacement[:, :3] @ along)
    levels = mesh.levels
    walls = np.full((len(mesh.walls), len(levels)), np.nan)
    every = np.full(len(levels), np.nan)
    for k, level in enumerate(levels):
        found = [nodes_on(mesh, w, level) for w in range(len(mesh.walls))]
        for w, nodes in enumerate(found):
            if len(nodes):
                walls[w, k] = moved[nodes].mean()
        every[k] = moved[np.unique(np.concatenate(found))].mean()
    return np.diff(every) / np.diff(levels), np.diff(walls, axis=1) / np.diff(levels)
