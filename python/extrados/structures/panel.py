"""The built-in mesher: rectangles with rectangular openings and notches."""

import itertools
from pathlib import Path

import numpy as np

from extrados.decks.walls import Panel
from extrados.structures.wall import BadWall, WallMesh, add_middles, build_wall

JITTER = 0.33  # of the spacing: Delaunay triangles stay well shaped and keep to straight edges


def make_panel(model: Panel, folder: Path | None = None, seed: int | None = None) -> WallMesh:
    """Mesh of a panel; `seed` overrides the deck's."""
    if model.outline is not None:
        from extrados.structures.outline import fill_outline

        xy, connect = fill_outline(model, folder or Path.cwd(), model.seed if seed is None else seed)
    else:
        columns, rows = grid_lines(model, 0), grid_lines(model, 1)
        if model.mesh == "random":
            xy, connect = random_triangles(columns, rows, model, model.seed if seed is None else seed)
        else:
            xy, connect = grid(columns, rows, model)
    base = "T3" if model.element in ("T3", "T6") else "Q4"
    if model.element in ("T6", "Q8"):
        xy, connect = add_middles(xy, base, connect)
    return build_wall(model, xy, model.element, connect, model.size)


def grid_lines(model: Panel, axis: int) -> np.ndarray:
    """Mesh lines of one axis: through all corners of openings, supports and regions, then evenly between."""
    length = (model.width, model.height)[axis]
    word = "xy"[axis]
    breaks = {0.0, length, *(model.lines_x, model.lines_y)[axis]}
    for part in (*model.openings, *model.regions, *model.refine, *model.supports, *model.ties):
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
        size = model.size
        for part in model.refine:
            ends = getattr(part, word)
            if ends is not None and ends[0] - tolerance <= a and b <= ends[1] + tolerance:
                size = min(size, part.size)
        count = max(1, round((b - a) / size))
        lines.append(a + (b - a) * np.arange(1, count + 1) / count)
    return np.concatenate(lines)


def _cut(centre: np.ndarray, model: Panel) -> np.ndarray:
    out = np.zeros(len(centre), dtype=bool)
    for o in model.openings:
        out |= (centre[:, 0] > o.x[0]) & (centre[:, 0] < o.x[1]) & (centre[:, 1] > o.y[0]) & (centre[:, 1] < o.y[1])
    return out


def grid(columns: np.ndarray, rows: np.ndarray, model: Panel) -> tuple[np.ndarray, np.ndarray]:
    """Structured quadrilaterals, or triangles by alternating diagonals."""
    nx, ny = len(columns) - 1, len(rows) - 1
    x, y = np.meshgrid(columns, rows, indexing="ij")
    xy = np.column_stack([x.ravel(), y.ravel()])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij"))
    at = i * (ny + 1) + j
    quads = np.column_stack([at, at + ny + 1, at + ny + 2, at + 1])
    quads = quads[~_cut(xy[quads].mean(axis=1), model)]
    if model.element in ("Q4", "Q8"):
        return xy, quads
    odd = ((i + j) % 2 == 1)[: len(at)]
    odd = odd[~_cut(xy[np.column_stack([at, at + ny + 1, at + ny + 2, at + 1])].mean(axis=1), model)]
    a, b = quads[~odd], quads[odd]
    return xy, np.concatenate([a[:, [0, 1, 2]], a[:, [0, 2, 3]], b[:, [0, 1, 3]], b[:, [1, 2, 3]]])


def random_triangles(columns: np.ndarray, rows: np.ndarray, model: Panel, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Delaunay triangles on the grid's points, those inside moved at random."""
    from scipy.spatial import Delaunay

    x, y = np.meshgrid(columns, rows, indexing="ij")
    xy = np.column_stack([x.ravel(), y.ravel()])
    tolerance = 1e-9 * max(model.width, model.height)
    hollow = np.zeros(len(xy), dtype=bool)
    fixed = np.zeros(len(xy), dtype=bool)
    # Points on the outline, on openings and on mesh lines that supports or loads need stay where they are.
    fixed |= (np.abs(xy) <= tolerance).any(axis=1) | (np.abs(xy - [model.width, model.height]) <= tolerance).any(axis=1)
    for o in model.openings:
        near = (xy[:, 0] >= o.x[0] - tolerance) & (xy[:, 0] <= o.x[1] + tolerance)
        near &= (xy[:, 1] >= o.y[0] - tolerance) & (xy[:, 1] <= o.y[1] + tolerance)
        inner = (xy[:, 0] > o.x[0] + tolerance) & (xy[:, 0] < o.x[1] - tolerance)
        inner &= (xy[:, 1] > o.y[0] + tolerance) & (xy[:, 1] < o.y[1] - tolerance)
        hollow |= inner
        fixed |= near
    for part in model.regions:
        for axis, ends in enumerate((part.x, part.y)):
            for end in ends or ():
                fixed |= np.abs(xy[:, axis] - end) <= tolerance
    spacing = np.column_stack(
        [
            np.minimum(*_gaps(columns))[np.searchsorted(columns, xy[:, 0])],
            np.minimum(*_gaps(rows))[np.searchsorted(rows, xy[:, 1])],
        ]
    )
    move = np.random.default_rng(seed).uniform(-JITTER, JITTER, xy.shape) * spacing
    xy = np.where(fixed[:, None], xy, xy + move)[~hollow]
    triangles = Delaunay(xy).simplices
    centre = xy[triangles].mean(axis=1)
    triangles = triangles[~_cut(centre, model)]
    a, b, c = (xy[triangles[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    triangles = np.where((area < 0)[:, None], triangles[:, [0, 2, 1]], triangles)
    flat = np.abs(area) < 1e-6 * model.size**2
    triangles = triangles[~flat]
    if not len(triangles):
        raise BadWall("the openings leave nothing of the panel")
    return xy, triangles


def _gaps(lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance of each mesh line to the one before and after it."""
    step = np.diff(lines)
    return np.append(step[0], step), np.append(step, step[-1])
