"""A deck of a building from the plan in a drawing: walls by their two faces or by their axes, openings by gaps or by a layer.

Faces are paired along strips across parallel lines. A gap in both faces of a wall is an opening; a gap in one face is a wall that abuts.
Ends of axes are extended to the axes of the walls that they meet.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from extrados.decks.reader import DeckError
from extrados.model.errors import BadGeometry
from extrados.model.files import LARGEST_FILE
from extrados.model.geometry.drawing import Layer
from extrados.model.geometry.dxf import read_dxf
from extrados.schema.files import File, read

#: Thickness that two parallel faces may have between them, and the widest gap that is an opening [m]
THIN, THICK, WIDEST = 0.08, 1.5, 3.5
#: Lines are parallel within this sine, in line within this distance [m]; the least length of a wall [m]
ASKEW, CLOSE, LEAST = 5e-3, 0.02, 0.2
#: Sill and head of doors, and of windows [m]
DOOR, WINDOW = (0.0, 2.1), (0.9, 2.3)
MOST_LINES, MOST_WALLS = 5000, 200


@dataclass(frozen=True)
class DrawnWall:
    """A wall on the plan: its axis from a to b [m], thickness [m], openings from, to along it [m]."""

    a: np.ndarray
    b: np.ndarray
    thickness: float
    openings: list[tuple[float, float]] = field(default_factory=list)

    @property
    def length(self) -> float:
        """Of its axis [m]."""
        return float(np.hypot(*(self.b - self.a)))

    @property
    def way(self) -> np.ndarray:
        """Unit vector from a to b."""
        return np.asarray((self.b - self.a) / self.length)


def deck_of_file(
    drawing: Path, walls: Sequence[str], openings: Sequence[str], thickness: float | None, storeys: Sequence[float], unit: str | None = None
) -> str:
    """`deck_of_plan` of a file; DeckError gives the reason if it cannot be read."""
    try:
        return deck_of_plan(read(drawing, LARGEST_FILE), walls, openings, thickness, storeys, unit)
    except BadGeometry as error:
        raise DeckError([str(error)]) from None


def deck_of_plan(
    file: File, walls: Sequence[str], openings: Sequence[str], thickness: float | None, storeys: Sequence[float], unit: str | None = None
) -> str:
    """The text of a deck. walls, openings: layers of the drawing; thickness [m]: of walls that are drawn by their axes, None for
    walls drawn by their faces; storeys: heights [m]. BadGeometry says what cannot be read."""
    drawn = read_dxf(file, unit, [], {name: Layer("joints") for name in (*walls, *openings)})
    lines = _lines(drawn.marks, walls)
    if not len(lines):
        raise BadGeometry(f"{file.path.name}: the layers {', '.join(walls)} contain no lines")
    pieces = walls_of(lines, thickness)
    found = [wall for wall in pieces if wall.length > LEAST + wall.thickness]
    short = [wall.length for wall in pieces if wall.length <= LEAST + wall.thickness]
    if not found:
        raise BadGeometry(
            f"{file.path.name}: no two parallel lines are {THIN:g} to {THICK:g} m apart: draw both faces of each "
            "wall, or draw axes and give --thickness"
        )
    if len(found) > MOST_WALLS:
        raise BadGeometry(f"{file.path.name}: the drawing has {len(found)} walls, more than the {MOST_WALLS} allowed")
    marks = _lines(drawn.marks, openings)
    return _written([_opened(wall, marks) for wall in joined(found)], short, bool(openings), file.path.name, storeys)


def _lines(marks: Mapping[str, np.ndarray], layers: Sequence[str]) -> np.ndarray:
    """Lines (k, 4) of some layers [m]."""
    wanted = {name.upper() for name in layers}
    own = [np.asarray(lines).reshape(-1, 4) for layer, lines in marks.items() if layer.upper() in wanted]
    found = np.concatenate(own) if own else np.empty((0, 4))
    if len(found) > MOST_LINES:
        raise BadGeometry(f"the drawing has {len(found)} lines of walls or openings, more than the {MOST_LINES} allowed")
    return found[np.hypot(found[:, 2] - found[:, 0], found[:, 3] - found[:, 1]) > 1e-9]


def walls_of(lines: np.ndarray, thickness: float | None) -> list[DrawnWall]:
    """Walls of lines (k, 4) [m] that are their faces, or their axes where a thickness is given; with gaps as openings.
    Short pieces, such as the ends of walls, are among them."""
    way = lines[:, 2:] - lines[:, :2]
    way = way / np.hypot(*way.T)[:, None]
    way[(way[:, 0] < -1e-9) | ((np.abs(way[:, 0]) <= 1e-9) & (way[:, 1] < 0.0))] *= -1.0
    left, found = list(range(len(lines))), []
    while left:
        d = way[left[0]]
        own = [k for k in left if abs(d[0] * way[k, 1] - d[1] * way[k, 0]) < ASKEW]
        left = [k for k in left if k not in own]
        normal = np.array([-d[1], d[0]])
        ends = np.sort(lines[own].reshape(-1, 2, 2) @ d, axis=1)
        offset = (lines[own].reshape(-1, 2, 2) @ normal).mean(axis=1)
        strips = _axes(ends, offset, thickness) if thickness is not None else _between_faces(ends, offset)
        for mid, thick, parts in strips:
            found += _along(d, normal, mid, thick, parts, ends[np.abs(offset - mid) < 0.5 * thick + CLOSE])
    return found


#: Offset of an axis [m], thickness [m], intervals along it [m]
Strip = tuple[float, float, list[tuple[float, float]]]


def _axes(ends: np.ndarray, offset: np.ndarray, thickness: float) -> list[Strip]:
    """Axes in one line, by their offsets."""
    found: list[Strip] = []
    for k in np.argsort(offset, kind="stable"):
        part = (float(ends[k, 0]), float(ends[k, 1]))
        if found and offset[k] - found[-1][0] < CLOSE:
            found[-1][2].append(part)
        else:
            found.append((float(offset[k]), thickness, [part]))
    return found


def _between_faces(ends: np.ndarray, offset: np.ndarray) -> list[Strip]:
    """Strips between faces that follow each other across the lines; those of one axis and thickness together."""
    found: list[Strip] = []
    for a, b in itertools.pairwise(np.unique(np.round(ends, 6))):
        middle = 0.5 * (a + b)
        there = np.unique(np.round(offset[(ends[:, 0] <= middle) & (ends[:, 1] >= middle)], 4))
        gaps = np.diff(there)
        taken = np.zeros(len(there), bool)
        for k in np.argsort(gaps, kind="stable"):  # the nearest faces first
            if THIN <= gaps[k] <= THICK and not taken[k] and not taken[k + 1]:
                taken[k : k + 2] = True
                mid, thick = float(0.5 * (there[k] + there[k + 1])), float(gaps[k])
                same = [s for s in found if abs(s[0] - mid) < CLOSE and abs(s[1] - thick) < CLOSE]
                if same:
                    same[0][2].append((float(a), float(b)))
                else:
                    found.append((mid, thick, [(float(a), float(b))]))
    return found


def _along(
    d: np.ndarray, normal: np.ndarray, mid: float, thick: float, parts: list[tuple[float, float]], faces: np.ndarray
) -> list[DrawnWall]:
    """Walls of one axis. A gap in both faces up to WIDEST is an opening, in one face a wall that abuts; a wider one ends the wall."""
    merged: list[list[float]] = []
    for a, b in sorted(parts):
        if merged and a <= merged[-1][1] + CLOSE:
            merged[-1][1] = max(merged[-1][1], b)
        elif b - a > CLOSE:
            merged.append([a, b])
    walls: list[tuple[list[float], list[tuple[float, float]]]] = []
    for a, b in merged:
        gap = (walls[-1][0][1], a) if walls else (0.0, np.inf)
        if gap[1] - gap[0] > WIDEST:
            walls.append(([a, b], []))
            continue
        middle = 0.5 * (gap[0] + gap[1])
        if not ((faces[:, 0] < middle) & (faces[:, 1] > middle)).any():
            walls[-1][1].append(gap)
        walls[-1][0][1] = b
    return [DrawnWall(a * d + mid * normal, b * d + mid * normal, thick, [(p - a, q - a) for p, q in gaps]) for (a, b), gaps in walls]


def joined(walls: list[DrawnWall]) -> list[DrawnWall]:
    """Ends extended or cut to the axes that they meet; gaps where a wall crosses are no openings."""
    found = []
    for wall in walls:
        ends, crossed = [wall.a, wall.b], []
        for other in walls:
            sine = float(wall.way[0] * other.way[1] - wall.way[1] * other.way[0])
            if other is wall or abs(sine) < 0.1:
                continue
            between = other.a - wall.a
            s = float(between[0] * other.way[1] - between[1] * other.way[0]) / sine
            t = float(between[0] * wall.way[1] - between[1] * wall.way[0]) / sine
            reach = 0.5 * (wall.thickness + other.thickness) / abs(sine) + CLOSE
            if not -reach <= t <= other.length + reach:
                continue
            crossed.append((s, 0.5 * other.thickness / abs(sine) + CLOSE))
            for k, at in enumerate((0.0, wall.length)):
                if abs(s - at) <= reach:
                    ends[k] = wall.a + s * wall.way
        if (ends[1] - ends[0]) @ wall.way < CLOSE:  # both ends meet one axis, which is as thick as the wall is long
            ends = [wall.a, wall.b]
        moved = float((ends[0] - wall.a) @ wall.way)
        own = [
            (a - moved, b - moved)
            for a, b in wall.openings
            if not any(abs(0.5 * (a + b) - s) < half and b - a < 2.0 * half for s, half in crossed)
        ]
        found.append(replace(wall, a=ends[0], b=ends[1], openings=own))
    return found


def _opened(wall: DrawnWall, lines: np.ndarray) -> DrawnWall:
    """The wall with openings from lines of their layer: lines within its thickness, joined where they touch."""
    normal = np.array([-wall.way[1], wall.way[0]])
    parts = []
    for points in lines.reshape(-1, 2, 2):
        if (np.abs((points - wall.a) @ normal) > 0.5 * wall.thickness + CLOSE).any():
            continue
        a, b = np.sort((points - wall.a) @ wall.way)
        if b > CLOSE and a < wall.length - CLOSE:
            parts.append((max(float(a), 0.0), min(float(b), wall.length)))
    merged: list[tuple[float, float]] = []
    for a, b in sorted([*wall.openings, *parts]):
        if merged and a <= merged[-1][1] + CLOSE:
            merged[-1] = (merged[-1][0], max(merged[-1][1], b))
        else:
            merged.append((a, b))
    return replace(wall, openings=[(a, b) for a, b in merged if b - a > CLOSE])


def _written(walls: list[DrawnWall], short: Sequence[float], windows: bool, name: str, storeys: Sequence[float]) -> str:
    """The deck: openings of a layer are windows, gaps are doors in the first storey and windows above. short: lengths [m] of the
    pieces that are not considered."""
    sills = f"sills and heads of openings: doors {DOOR[0]:g} to {DOOR[1]:g} m, windows {WINDOW[0]:g} to {WINDOW[1]:g} m"
    said = [f"Walls are read from the drawing {name}; it gives no heights.", f"Assumed {sills}."]
    if short:
        said.append(
            f"Not considered: {len(short)} pieces whose length exceeds their thickness by at most {LEAST:g} m, "
            f"such as ends of walls. The longest of these pieces has a length of {max(short):.2f} m."
        )
    made = []
    for wall in walls:
        openings = []
        for storey, height in enumerate(storeys, 1):
            low, high = WINDOW if windows or storey > 1 else DOOR
            openings += [(storey, a, b, low, min(high, height - 0.3)) for a, b in wall.openings]
        made.append(WrittenWall(wall.a, wall.b, 1, [wall.thickness] * len(storeys), openings))
    return written_deck(made, storeys, name, said)


@dataclass
class WrittenWall:
    """A wall of a deck: its ends [m], first storey, thickness in each of its storeys [m], openings (storey, s from, to, z from, to)."""

    a: np.ndarray
    b: np.ndarray
    first: int
    thicknesses: list[float]
    openings: list[tuple[int, float, float, float, float]]

    @property
    def last(self) -> int:
        """Its last storey."""
        return self.first + len(self.thicknesses) - 1


def written_deck(walls: Sequence[WrittenWall], storeys: Sequence[float], name: str, said: Sequence[str]) -> str:
    """The text of a deck of walls with an assumed masonry; said: what else is assumed or neglected."""
    title = name.replace('"', "'").replace("\\", "/")
    masonry = (
        "Assumed masonry: density 1800 kg/m^3, modulus 1.5 GPa, Poisson 0.25, compressive strength 3 MPa, cohesion 0.1 MPa, diagonal "
        "strength 50 kPa."
    )
    text = [
        f'title = "Building of {title}"',
        "",
        "[structure]",
        'kind = "building"',
        f"storeys = [{', '.join(f'{h:g}' for h in storeys)}]",
        f"assumed = [{', '.join(_quoted(one.replace(chr(34), chr(39)).replace(chr(92), '/')) for one in (*said, masonry))}]",
    ]
    for k, wall in enumerate(walls, 1):
        text += ["", "[[structure.walls]]", f'name = "wall {k}"', f"start = {_point(wall.a)}", f"end = {_point(wall.b)}"]
        if len(set(np.round(wall.thicknesses, 3))) == 1:
            text.append(f"thickness = {wall.thicknesses[0]:.3f}")
        else:
            text.append(f"thicknesses = [{', '.join(f'{t:.3f}' for t in wall.thicknesses)}]")
        if (wall.first, wall.last) != (1, len(storeys)):
            text.append(f"storeys = [{wall.first}, {wall.last}]")
        if wall.openings:
            text.append("openings = [")
            text += [f"  {{ storey = {n}, x = [{a:.3f}, {b:.3f}], z = [{c:.3g}, {d:.3g}] }}," for n, a, b, c, d in wall.openings]
            text.append("]")
    text += [
        "",
        "[material]",
        "density = 1800",
        'young = "1.5 GPa"',
        "poisson = 0.25",
        'compressive_strength = "3 MPa"',
        "",
        "[joints]",
        'cohesion = "0.1 MPa"',
        "",
        "[[analysis]]",
        'kind = "frame-pushover"',
        'frame.diagonal_strength = "50 kPa"',
        "",
    ]
    return "\n".join(text)


def _point(at: np.ndarray) -> str:
    """Coordinates to a tenth of a micrometre: walls of a deck meet within one."""
    return f"[{', '.join(f'{round(float(v), 7) + 0.0:.12g}' for v in at)}]"


def _quoted(text: str) -> str:
    return '"' + text + '"'
