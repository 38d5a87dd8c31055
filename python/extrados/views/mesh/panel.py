"""The built-in mesher: rectangles with rectangular openings and notches."""

import itertools
from dataclasses import dataclass

import numpy as np

from extrados.model.description import Description
from extrados.model.errors import BadGeometry
from extrados.model.structures.walls import Panel
from extrados.views.blocks import Masonry
from extrados.views.mesh.mesh import Mesh, add_middles, build_mesh
from extrados.views.mesh.options import LARGEST_MESH, MeshOptions
from extrados.views.mesh.outline import JITTER, fill_outline
from extrados.views.mesh.stones import make_stones

#: Elements along the lesser side of a wall where no size is given
DEFAULT_DIVISIONS = 20


@dataclass(frozen=True)
class Layout:
    """A rectangle with what cuts it: openings, and places whose ends need mesh lines."""

    width: float
    height: float
    openings: list
    placed: list
    options: MeshOptions
    size: float


def mesh_panel(building: Masonry, options: MeshOptions, seed: int | None = None) -> Mesh:
    """Finite elements of a panel: of its units with joints between them where [analysis.mesh] joints asks for them."""
    panel = building.structure
    assert isinstance(panel, Panel)
    if options.joints is None:
        return make_panel(panel, building, options, seed)
    if panel.regions:
        raise BadGeometry("a panel meshed by units takes no regions: give the properties of its joints by [[joints.types]]")
    return make_stones(building, options)


def make_panel(panel: Panel, building: Description, options: MeshOptions, seed: int | None = None) -> Mesh:
    """Mesh of a panel; `seed` overrides that of the options. BadGeometry says what does not fit."""
    seed = options.seed if seed is None else seed
    notes: tuple[str, ...] = ()
    if panel.outline is not None:
        if options.element not in ("T3", "T6"):
            raise BadGeometry(f'a panel with an `outline` is meshed with triangles, but `element` is {options.element}: give "T3" or "T6"')
        if options.lines_x or options.lines_y or options.refine:
            raise BadGeometry(
                "a panel with an `outline` takes no `lines_x`, `lines_y` or `refine`, because the corners of the "
                "outline determine the mesh: remove them"
            )
        if options.size is None:
            raise BadGeometry("a panel with an `outline` requires the `size` of the elements")
        size = options.size
        xy, connect, notes = fill_outline(panel.outline, panel.outline_unit, building.folder, size, seed)
    else:
        width, height = panel.size
        size = options.size or min(width, height) / DEFAULT_DIVISIONS
        smallest = min([size, *(r.size for r in options.refine)])
        count = width * height / smallest**2
        if count > LARGEST_MESH:
            raise BadGeometry(
                f"the mesh would have about {count:.2g} elements of {smallest:g} m; at most {LARGEST_MESH:g} are allowed: use "
                "larger elements"
            )
        placed = [*panel.openings, *panel.regions, *options.refine, *building.supports.held, *panel.ties]
        layout = Layout(width, height, panel.openings, placed, options, size)
        columns, rows = grid_lines(layout, 0), grid_lines(layout, 1)
        if options.pattern == "random":
            fixed = [(part.x, part.y) for part in panel.regions]
            xy, connect = random_triangles(columns, rows, layout, fixed, seed)
        else:
            xy, connect = grid(columns, rows, layout)
    base = "T3" if options.element in ("T3", "T6") else "Q4"
    if options.element in ("T6", "Q8"):
        xy, connect = add_middles(xy, base, connect)
    mesh = build_mesh(panel, building, options, xy, options.element, connect, size)
    mesh.warnings.extend(notes)
    return mesh


def grid_lines(layout: Layout, axis: int) -> np.ndarray:
    """Mesh lines of one axis: through all corners of openings, supports and regions, then evenly between."""
    length = (layout.width, layout.height)[axis]
    word = "xy"[axis]
    breaks = {0.0, length, *(layout.options.lines_x, layout.options.lines_y)[axis]}
    for part in layout.placed:
        ends = getattr(part, word)
        breaks.update(ends or ())
    tolerance = 1e-9 * length
    kept = [0.0]
    for value in sorted(b for b in breaks if 0.0 < b <= length):
        if value - kept[-1] > tolerance:
            kept.append(value)
    kept[-1] = length
    lines = [np.zeros(1)]
    for a, b in itertools.pairwise(kept):
        size = layout.size
        for part in layout.options.refine:
            ends = getattr(part, word)
            if ends is not None and ends[0] - tolerance <= a and b <= ends[1] + tolerance:
                size = min(size, part.size)
        count = max(1, round((b - a) / size))
        lines.append(a + (b - a) * np.arange(1, count + 1) / count)
    return np.concatenate(lines)


def _cut(centre: np.ndarray, layout: Layout) -> np.ndarray:
    out = np.zeros(len(centre), dtype=bool)
    for o in layout.openings:
        out |= (centre[:, 0] > o.x[0]) & (centre[:, 0] < o.x[1]) & (centre[:, 1] > o.y[0]) & (centre[:, 1] < o.y[1])
    return out


def grid(columns: np.ndarray, rows: np.ndarray, layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Structured quadrilaterals, or triangles by alternating diagonals."""
    nx, ny = len(columns) - 1, len(rows) - 1
    x, y = np.meshgrid(columns, rows, indexing="ij")
    xy = np.column_stack([x.ravel(), y.ravel()])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij"))
    at = i * (ny + 1) + j
    quads = np.column_stack([at, at + ny + 1, at + ny + 2, at + 1])
    quads = quads[~_cut(xy[quads].mean(axis=1), layout)]
    if layout.options.element in ("Q4", "Q8"):
        return xy, quads
    odd = ((i + j) % 2 == 1)[: len(at)]
    odd = odd[~_cut(xy[np.column_stack([at, at + ny + 1, at + ny + 2, at + 1])].mean(axis=1), layout)]
    a, b = quads[~odd], quads[odd]
    return xy, np.concatenate([a[:, [0, 1, 2]], a[:, [0, 2, 3]], b[:, [0, 1, 3]], b[:, [1, 2, 3]]])


def random_triangles(columns: np.ndarray, rows: np.ndarray, layout: Layout, fixed_ranges: list, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Delaunay triangles on the grid's points, those inside moved at random."""
    from scipy.spatial import Delaunay

    x, y = np.meshgrid(columns, rows, indexing="ij")
    xy = np.column_stack([x.ravel(), y.ravel()])
    tolerance = 1e-9 * max(layout.width, layout.height)
    hollow = np.zeros(len(xy), dtype=bool)
    fixed = np.zeros(len(xy), dtype=bool)
    # Points on the outline, on openings and on mesh lines that supports or loads need stay where they are.
    fixed |= (np.abs(xy) <= tolerance).any(axis=1) | (np.abs(xy - [layout.width, layout.height]) <= tolerance).any(axis=1)
    for o in layout.openings:
        near = (xy[:, 0] >= o.x[0] - tolerance) & (xy[:, 0] <= o.x[1] + tolerance)
        near &= (xy[:, 1] >= o.y[0] - tolerance) & (xy[:, 1] <= o.y[1] + tolerance)
        inner = (xy[:, 0] > o.x[0] + tolerance) & (xy[:, 0] < o.x[1] - tolerance)
        inner &= (xy[:, 1] > o.y[0] + tolerance) & (xy[:, 1] < o.y[1] - tolerance)
        hollow |= inner
        fixed |= near
    for ranges in fixed_ranges:
        for axis, ends in enumerate(ranges):
            for end in ends or ():
                fixed |= np.abs(xy[:, axis] - end) <= tolerance
    spacing = np.column_stack(
        [np.minimum(*_gaps(columns))[np.searchsorted(columns, xy[:, 0])], np.minimum(*_gaps(rows))[np.searchsorted(rows, xy[:, 1])]]
    )
    move = np.random.default_rng(seed).uniform(-JITTER, JITTER, xy.shape) * spacing
    xy = np.where(fixed[:, None], xy, xy + move)[~hollow]
    triangles = Delaunay(xy).simplices
    centre = xy[triangles].mean(axis=1)
    triangles = triangles[~_cut(centre, layout)]
    a, b, c = (xy[triangles[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    triangles = np.where((area < 0)[:, None], triangles[:, [0, 2, 1]], triangles)
    flat = np.abs(area) < 1e-6 * layout.size**2
    triangles = triangles[~flat]
    if not len(triangles):
        raise BadGeometry("the openings occupy the whole panel")
    return xy, triangles


def _gaps(lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance of each mesh line to the one before and after it."""
    step = np.diff(lines)
    return np.append(step[0], step), np.append(step, step[-1])
