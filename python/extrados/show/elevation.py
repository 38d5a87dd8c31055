"""Elevations of a building on its sheet: the front and the side of a plane section, the walls of a plan with their openings."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from extrados.show import style
from extrados.show.language import Language
from extrados.show.sheet import INK, LINE, Sheet, View

#: Colours of what is seen beyond a cut, of a beam over an opening, of a spandrel wall, and of an opening
BEYOND, LINTEL, SPANDREL, OPEN = "#f3efe6", "#c9b48a", "#ddd3bd", "white"
#: Width and height of an opening on paper [mm] from which its size is written into it
LEAST = (3.9, 4.2)
#: Elevations of walls on one sheet
MOST_WALLS = 8


def seen_from_right(outlines: Sequence[np.ndarray]) -> list[tuple[float, float, int]]:
    """Faces seen against +x: lower and upper level [m], and the block, upwards. Levels without a block are absent.

    Between two neighbouring levels of vertices, the block that reaches farthest to +x hides the others.
    """
    if not outlines:
        return []
    levels = np.unique(np.round(np.concatenate([outline[:, 1] for outline in outlines]), 6))
    middle = 0.5 * (levels[1:] + levels[:-1])
    far, block = np.full(len(middle), -np.inf), np.full(len(middle), -1)
    for i, outline in enumerate(outlines):
        for (xa, ya), (xb, yb) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            here = slice(*np.searchsorted(middle, sorted((ya, yb))))
            if here.start < here.stop:
                x = xa + (middle[here] - ya) / (yb - ya) * (xb - xa)
                block[here] = np.where(x > far[here], i, block[here])
                far[here] = np.maximum(far[here], x)
    found: list[tuple[float, float, int]] = []
    for low, high, i in zip(levels[:-1].tolist(), levels[1:].tolist(), block.tolist(), strict=True):
        if i >= 0 and found and found[-1][1:] == (low, i):
            found[-1] = (found[-1][0], high, i)
        elif i >= 0:
            found.append((low, high, i))
    return found


def draw_side(sheet: Sheet, view: View, outlines: Sequence[np.ndarray], depth: float, colour: str, zorder: float) -> None:
    """The faces of a section of some depth [m] that are seen from its right."""
    for low, high, _ in seen_from_right(outlines):
        face = [[0.0, low], [depth, low], [depth, high], [0.0, high]]
        sheet.fill(view, face, colour, edgecolor=style.EDGE, linewidth=0.25, zorder=zorder)


def draw_front(
    sheet: Sheet, view: View, outlines: Sequence[np.ndarray], earth: dict[str, Any] | None, depth: float, words: Language
) -> None:
    """The front of a bridge: blocks, spandrel walls up to the formation, and the level of the road; without earth the side of the section."""
    dimension_around(sheet, view, words)
    if earth is None:
        draw_side(sheet, view, outlines, depth, style.STONE, 1.0)
        return
    under = np.stack([np.array(earth["start"]), np.array(earth["end"])], axis=1).reshape(-1, 2)
    (left, _), (right, _) = under[0], under[-1]
    level, road = earth["formation"], earth["road"]
    sheet.fill(view, [*under, [right, level], [left, level]], SPANDREL, edgecolor=style.EDGE, linewidth=0.4, zorder=1.5)
    if road > level:
        sheet.fill(
            view, [[left, level], [right, level], [right, road], [left, road]], OPEN, edgecolor=style.EDGE, linewidth=0.4, zorder=1.5
        )
    for outline in outlines:
        sheet.fill(view, outline, style.STONE, edgecolor=style.EDGE, linewidth=0.4, zorder=2)


def dimension_around(sheet: Sheet, view: View, words: Language) -> None:
    """The whole length below a view, and its whole height to the left."""
    low, high = sheet.to_paper(view, [view.low, view.high])
    across, up = view.high - view.low
    sheet.dimension(low, np.array([high[0], low[1]]), words.number(float(across)), -LINE, 0.25)
    sheet.dimension(low, np.array([low[0], high[1]]), words.number(float(up)), -LINE)


def place_beside(lines: np.ndarray, w: int, aside: float) -> tuple[np.ndarray, float]:
    """A place (2) for words beside wall w on the plan, at a distance [m] from its axis, outward and away from walls that cross it; and the
    angle of the words [deg]. lines (walls, 4): x, y of start and end [m]."""
    line, others = lines[w], np.delete(lines, w, axis=0)
    length = float(np.hypot(*(line[2:] - line[:2])))
    way = (line[2:] - line[:2]) / length
    across = np.array([-way[1], way[0]])
    outward = -1.0 if across @ (0.5 * (line[:2] + line[2:]) - lines.reshape(-1, 2).mean(axis=0)) < 0.0 else 1.0
    place, run = line[:2], others[:, 2:] - others[:, :2]
    for share in (0.5, 0.3, 0.7, 0.2, 0.8):
        place = line[:2] + share * length * way + outward * aside * across
        along = np.clip(np.einsum("kd,kd->k", place - others[:, :2], run) / np.square(run).sum(axis=1), 0.0, 1.0)
        if not len(others) or np.hypot(*(others[:, :2] + along[:, None] * run - place).T).min() > 0.1 * length:
            break
    return place, 90.0 - (90.0 - float(np.degrees(np.arctan2(way[1], way[0])))) % 180.0


def wall_views(walls: Sequence[dict[str, Any]], storeys: np.ndarray, words: Language) -> list[View]:
    """A view of each of the first walls; storeys: levels of the floors [m]."""
    found = []
    for wall in walls[:MOST_WALLS]:
        first, last = wall.get("storeys") or (1, len(storeys) - 1)
        length = float(np.linalg.norm(np.subtract(wall["end"], wall["start"])))
        name = words("Elevation of {wall}", wall=wall["name"])
        high = storeys[last] + ((wall.get("gable") or {}).get("rise") or 0.0)
        found.append(View(name, np.array([0.0, storeys[first - 1]]), np.array([length, high]), 2.0 * LINE, 1.5 * LINE))
    return found


def draw_wall(sheet: Sheet, view: View, wall: dict[str, Any], storeys: np.ndarray, words: Language) -> None:
    """A wall of a plan, its start at the left, with floors, openings, lintels, its length and the heights of its storeys."""
    openings = [
        {"x": hole["x"], "y": [storeys[hole["storey"] - 1] + z for z in hole["z"]], "lintel": hole.get("lintel")}
        for hole in wall.get("openings", [])
    ]
    gable, top = wall.get("gable"), float(storeys[(wall.get("storeys") or (1, len(storeys) - 1))[1]])
    draw_face(sheet, view, openings, words, top)
    ends = [level for level in storeys.tolist() if view.low[1] - 1e-9 <= level <= top + 1e-9]
    if gable:
        length, ridge = float(view.high[0]), gable.get("ridge")
        corners = [[0.0, top], [length, top], [0.5 * length if ridge is None else ridge, top + gable["rise"]]]
        sheet.fill(view, corners, style.STONE, edgecolor=style.EDGE, linewidth=0.6, zorder=1)
        eaves, peak = sheet.to_paper(view, [[0.0, top], [0.0, top + gable["rise"]]])
        sheet.dimension(eaves, peak, words.number(float(gable["rise"])), -LINE)
    for k, level in enumerate(ends):
        here = sheet.to_paper(view, [[0.0, level], [view.high[0], level]])
        sheet.ax.plot(*here.T, color="black", linewidth=1.6 if k == 0 else 0.5, linestyle="-" if k == 0 else (0, (6, 3)), zorder=3)
        if k:
            below = sheet.to_paper(view, [[0.0, ends[k - 1]]])[0]
            sheet.dimension(below, here[0], words.number(level - ends[k - 1]), -LINE)
    low, high = sheet.to_paper(view, [view.low, view.high])
    sheet.dimension(low, np.array([high[0], low[1]]), words.number(float(view.high[0])), -LINE)


def draw_face(sheet: Sheet, view: View, openings: Sequence[dict[str, Any]], words: Language, top: float | None = None) -> None:
    """A rectangular wall, up to `top` [m] or the whole view, with openings, x and y [m] from and to, and the beams over them; width
    and height in each opening."""
    (left, low), (right, high) = view.low, view.high
    high = high if top is None else top
    sheet.fill(view, [[left, low], [right, low], [right, high], [left, high]], style.STONE, edgecolor=style.EDGE, linewidth=0.6, zorder=1)
    for hole in openings:
        (a, b), (c, d) = hole["x"], hole["y"]
        sheet.fill(view, [[a, c], [b, c], [b, d], [a, d]], OPEN, edgecolor=style.EDGE, linewidth=0.5, zorder=2)
        beam = hole.get("lintel")
        if beam:
            start, end, top = a - beam["bearing"], b + beam["bearing"], d + beam["depth"]
            sheet.fill(view, [[start, d], [end, d], [end, top], [start, top]], LINTEL, edgecolor=style.EDGE, linewidth=0.4, zorder=2)
        near, far = sheet.to_paper(view, [[a, c], [b, d]])
        if (far - near >= LEAST).all():
            size = f"{words.number(b - a)}\n{words.number(d - c)}"
            look: dict[str, Any] = {"fontsize": 5, "linespacing": 1.1, "color": INK, "ha": "center", "va": "center", "zorder": 7}
            sheet.ax.text(*style.pair(0.5 * (near + far)), size, **look)
