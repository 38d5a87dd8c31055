"""The drawing of the building to scale: section, cross-section and elevation, or plan and elevations of the walls."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np

from extrados.results.store import Stored
from extrados.schema.text import printable
from extrados.show import elevation, style
from extrados.show.language import Language
from extrados.show.limit.section import FILL, PAVED
from extrados.show.sheet import INK, LINE, Sheet, View, scale_of

NAME, ELEVATION = "building", "building-elevation"
#: Figures with their captions
Figures = list[tuple[str, str]]


def draw_building(run: Stored, folder: Path, words: Language | None = None) -> Figures:
    """The section with spans, rises, widths and height, a cross-section and an elevation; the plan of a building and elevations of its
    walls; or a wall with its openings; to scale, whether or not an analysis has a result. Empty for other decks."""
    words = words or Language()
    deck = run.summary["deck"]
    structure = deck["resolved"].get("structure") or {}
    if structure.get("kind") == "building":
        return _plan(deck, structure, folder, words)
    drawing = deck.get("drawing")
    if drawing:
        return _section(deck, drawing, folder, words)
    return _panel(deck, structure, folder, words) if structure.get("kind") == "panel" and structure.get("width") else []


def _section(deck: dict[str, Any], drawing: dict[str, Any], folder: Path, words: Language) -> Figures:
    """The front of a bridge has a sheet of its own if it would make the scale smaller."""
    rows = [row for row in deck.get("dimensions", []) if "start" in row]
    outlines = [np.array(outline) for outline in drawing["outlines"]]
    earth, depth = drawing["earth"], drawing["depth_m"]
    points = np.concatenate(outlines)
    low, high = points.min(axis=0), points.max(axis=0)
    if earth is not None:
        high[1] = max(high[1], earth["road"])
    levels = _levels([row for row in rows if row["aside"] == "below"])
    beside_it = sum(row["aside"] == "left" for row in rows)
    section = View(words("Section"), low, high, LINE * (1.2 + max(beside_it, 1)), LINE * (1.0 + max(levels, default=0)))
    cut = drawing["crown_m"] if drawing["crown_m"] is not None else 0.5 * float(low[0] + high[0])
    pieces = _cut(outlines, cut + 1e-4)
    upright = np.array([[0.0, low[1]], [depth, high[1]]])
    across = View(words("Cross-section A–A"), upright[0], upright[1], LINE, 2.0 * LINE)
    front = View(words("Elevation"), low, high, 2.0 * LINE, 2.0 * LINE)
    if earth is None:
        front = View(words("Side elevation"), upright[0], upright[1], 2.0 * LINE, 2.0 * LINE)
    # A cut through blocks over the whole height has the outline of the side.
    whole = earth is None and sum(b - a for a, b in pieces) > (1.0 - 1e-3) * (high[1] - low[1])
    beside = not whole and (earth is None or scale_of([section, across, front]) == scale_of([section, across]))
    blocks = _blocks(words, len(outlines))
    with style.canvas() as fig:
        sheet = Sheet(fig, [section, across, front] if beside else [section, across])
        _draw_section(sheet, section, outlines, drawing)
        _draw_across(sheet, across, outlines, pieces, cut, drawing)
        if beside:
            elevation.draw_front(sheet, front, outlines, earth, depth, words)
        _cut_marks(sheet, section, cut)
        _dimensions(sheet, section, rows, levels, words)
        foot = sheet.to_paper(across, [[0.0, low[1]], [depth, low[1]]])
        sheet.dimension(foot[0], foot[1], words.number(depth), -LINE)
        sheet.finish(words, _titled(deck), blocks)
        saved = style.save(fig, folder, NAME)
    told = (" ; " if words.code == "fr" else "; ").join(
        words.pair(name_of(words, row["name"]), f"{words.number(row['length_m'])} m") for row in rows
    )
    told = f" {told[:1].upper()}{told[1:]}." if told else ""
    views = words(
        "The building: section, cross-section and elevation at scale 1:{scale} on A4."
        if beside
        else "The building: section and cross-section at scale 1:{scale} on A4.",
        scale=sheet.scale,
    )
    found = [(saved, f"{views}{told}")]
    if not whole and not beside:
        with style.canvas() as fig:
            sheet = Sheet(fig, [front])
            elevation.draw_front(sheet, front, outlines, earth, depth, words)
            sheet.finish(words, _titled(deck), blocks)
            found.append((style.save(fig, folder, ELEVATION), words("Elevation at scale 1:{scale} on A4.", scale=sheet.scale)))
    if earth is not None and not drawing.get("spandrel_m"):
        saved, caption = found[-1]
        found[-1] = saved, f"{caption} {words('The deck has no spandrel walls: the elevation shows the outline of the fill.')}"
    return found


def _draw_section(sheet: Sheet, view: View, outlines: list[np.ndarray], drawing: dict[str, Any]) -> None:
    """Blocks, fill and supports."""
    if drawing["earth"] is not None:
        _earth(sheet, view, drawing["earth"])
    for outline in outlines:
        sheet.stone(view, outline, len(outlines) > MOST_THICK)
    for support in drawing["supports"]:
        sheet.ax.plot(*sheet.to_paper(view, support).T, color="black", linewidth=1.6, zorder=3, solid_capstyle="butt")


def _draw_across(
    sheet: Sheet, view: View, outlines: list[np.ndarray], pieces: list[tuple[float, float]], cut: float, drawing: dict[str, Any]
) -> None:
    """What a cut at x meets, `pieces` from and to [m], and the blocks behind it."""
    earth, depth, thin = drawing["earth"], drawing["depth_m"], len(outlines) > MOST_THICK
    if earth is not None:
        top = max((b for _, b in pieces), default=earth["formation"])
        wall = drawing.get("spandrel_m", 0.0)
        level = earth["formation"]
        for a, b, colour in ((top, level, FILL), (level, earth["road"], PAVED)):
            if b > a:
                box = [[0, a], [depth, a], [depth, b], [0, b]]
                sheet.fill(view, box, colour, edgecolor=style.EDGE, linewidth=0.3, zorder=1)
        for left, right in ((0.0, wall), (depth - wall, depth)) if wall else ():
            sheet.stone(view, [[left, top], [right, top], [right, level], [left, level]], thin)
    behind = [outline * (-1.0, 1.0) for outline in outlines if outline[:, 0].mean() > cut]
    elevation.draw_side(sheet, view, behind, depth, elevation.BEYOND, 0.5)
    for a, b in pieces:
        sheet.stone(view, [[0.0, a], [depth, a], [depth, b], [0.0, b]], thin)


def heading(deck: dict[str, Any]) -> str:
    """The title of a deck, else the name of its file, or that of its folder where the file is called after no building."""
    path = Path(deck["path"])
    name = path.absolute().parent.name if path.stem.lower() in NAMELESS else path.stem
    return str(deck.get("title") or name or "extrados run")


def _titled(deck: dict[str, Any]) -> str:
    return printable(heading(deck))


#: Blocks up to which their outlines are thick
MOST_THICK = 200
#: Names of files that are called after no building
NAMELESS = ("deck", "common", "summary")


def _blocks(words: Language, count: int) -> str:
    return words("1 block") if count == 1 else words("{count} blocks", count=count)


def name_of(words: Language, name: str) -> str:
    """A dimension's name: "rise of chain 3" by its two parts."""
    what, of, where = name.partition(" of ")
    for known in DIMENSIONS:
        if name == known:
            return words(name)
    part, _, number = where.rpartition(" ")
    if part in PARTS:
        return f"{words(what)}{words(PARTS[part], number=number)}"
    return f"{words(what)}{words(' of {part}', part=where)}" if of else words(name)


def joint_of(words: Language, name: str) -> str:
    """The name of a joint: "a on b" by the names of its two blocks."""
    a, on, b = name.partition(" on ")
    if not on:
        return name
    return words("{a} on the ground", a=a) if b == "the ground" else words("{a} on {b}", a=a, b=b)


#: Numbered parts whose dimensions have names
PARTS = {"span": " of span {number}", "chain": " of chain {number}"}
#: Names of dimensions that report and drawing tell
DIMENSIONS = (
    "clear span",
    "rise",
    "thickness at the crown",
    "width at the base",
    "width",
    "height",
    "height of the masonry",
    "total height",
    "thickness",
    "width of the left buttress",
    "width of the right buttress",
    "width of the left pier",
    "width of the right pier",
)


def _earth(sheet: Sheet, view: View, earth: dict[str, Any]) -> None:
    """Fill over the line of the stones, and surfacing on it."""
    start, end = np.array(earth["start"]), np.array(earth["end"])
    under = np.empty((2 * len(start), 2))
    under[0::2], under[1::2] = start, end
    left, right = start[0, 0], end[-1, 0]
    level, road = earth["formation"], earth["road"]
    sheet.fill(view, [*under, [right, level], [left, level]], FILL, edgecolor="none", zorder=1)
    if road > level:
        paved = [[left, level], [right, level], [right, road], [left, road]]
        sheet.fill(view, paved, PAVED, edgecolor=style.EDGE, linewidth=0.3, zorder=1.2)


def _cut(outlines: list[np.ndarray], x: float) -> list[tuple[float, float]]:
    """Heights [m] between which an upright line at x lies within a block."""
    found = []
    for outline in outlines:
        a, b = outline, np.roll(outline, -1, axis=0)
        met = (a[:, 0] > x) != (b[:, 0] > x)
        share = (x - a[met, 0]) / (b[met, 0] - a[met, 0])
        y = np.sort(a[met, 1] + share * (b[met, 1] - a[met, 1]))
        found += [(float(y[k]), float(y[k + 1])) for k in range(0, len(y) - 1, 2)]
    return sorted(found)


def _levels(rows: list[dict[str, Any]]) -> list[int]:
    """The line below the drawing on which each dimension stands: those that do not meet share one."""
    taken: list[list[tuple[float, float]]] = []
    found = []
    for row in rows:
        a, b = sorted((row["start"][0], row["end"][0]))
        level = next((k for k, there in enumerate(taken) if all(b <= c + 1e-9 or d <= a + 1e-9 for c, d in there)), len(taken))
        if level == len(taken):
            taken.append([])
        taken[level].append((a, b))
        found.append(level + 1)
    return found


def _dimensions(sheet: Sheet, view: View, rows: list[dict[str, Any]], levels: list[int], words: Language) -> None:
    bottom = sheet.to_paper(view, [view.low])[0]
    free, upright = iter(levels), itertools.count(1.4)
    for row in rows:
        a, b = sheet.to_paper(view, [row["start"], row["end"]])
        text = words.number(row["length_m"])
        if row["aside"] == "below":
            sheet.dimension(np.array([a[0], bottom[1]]), np.array([b[0], bottom[1]]), text, -LINE * next(free))
        elif row["aside"] == "left":
            sheet.dimension(np.array([bottom[0], a[1]]), np.array([bottom[0], b[1]]), text, -next(upright) * LINE)
        elif row["aside"] == "right":  # a thickness: its number beside it
            middle = np.array([max(a[0], b[0]) + 5.0, max(a[1], b[1]) + 2.5])
            sheet.ax.plot(*np.array([a, b]).T, color=INK, linewidth=1.0, zorder=6)
            sheet.ax.annotate(
                text,
                style.pair(0.5 * (a + b)),
                xytext=style.pair(middle),
                textcoords="data",
                fontsize=7,
                color=INK,
                zorder=7,
                va="center",
                arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.4},
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.75},
            )
        else:
            sheet.dimension(a, b, text, at=0.6 if abs(b[1] - a[1]) > abs(b[0] - a[0]) else 0.25)


def _plan(deck: dict[str, Any], structure: dict[str, Any], folder: Path, words: Language) -> Figures:
    """The walls of a building on its plan, with names, lengths and thicknesses, and the heights of its storeys."""
    walls = structure["walls"]
    ends = np.array([[wall["start"], wall["end"]] for wall in walls], dtype=float)
    # outer faces; the names of the walls are written outside of them
    outside = 0.5 * max(wall.get("thickness") or max(wall["thicknesses"]) for wall in walls)
    low, high = ends.min(axis=(0, 1)) - outside, ends.max(axis=(0, 1)) + outside
    plan = View(words("Plan"), low, high, 2.0 * LINE, 2.0 * LINE, LINE)
    storeys = np.concatenate([[0.0], np.cumsum(structure["storeys"])])
    with style.canvas() as fig:
        sheet = Sheet(fig, [plan])
        for number, (wall, (start, end)) in enumerate(zip(walls, ends, strict=True)):
            thicknesses = wall.get("thicknesses") or [wall["thickness"]]
            thick = max(thicknesses)
            along = (end - start) / np.linalg.norm(end - start)
            across = np.array([-along[1], along[0]])
            for each in sorted(set(thicknesses), reverse=True):
                half = 0.5 * each * across
                sheet.stone(plan, [start + half, end + half, end - half, start - half], each < thick)
            place, turn = elevation.place_beside(ends.reshape(-1, 4), number, 0.5 * thick)
            out = place - start - along * ((place - start) @ along)
            at = sheet.to_paper(plan, [place])[0] + 3.5 * out / np.linalg.norm(out)
            of_storeys = " / ".join(words.number(t) for t in dict.fromkeys(thicknesses))
            told = f"{wall['name']}: {words.number(float(np.linalg.norm(end - start)))} m, {of_storeys} m"
            sheet.ax.text(
                *style.pair(at),
                told,
                color=INK,
                ha="center",
                va="center",
                rotation=turn,
                fontsize=7,
                zorder=7,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.75},
            )
        sheet.finish(words, _titled(deck))
        saved = style.save(fig, folder, NAME)
    *first, last = [words.number(h) for h in structure["storeys"]]
    heights = words.pair(words("Storeys, from the ground up" if first else "Storey"), f"{', '.join([*first, last])} m")
    told = words("for each wall: length in its middle plane, and thickness in each storey (lowest storey first)")
    found = [(saved, f"{words.pair(words('Plan of the building'), told)}. {heights}.")]
    faces = elevation.wall_views(walls, storeys, words)
    with style.canvas() as fig:
        sheet = Sheet(fig, faces)
        for view, wall in zip(faces, walls, strict=False):
            elevation.draw_wall(sheet, view, wall, storeys, words)
        sheet.finish(words, _titled(deck))
        saved = style.save(fig, folder, ELEVATION)
    seen = words("Elevations of the walls; each wall starts at the left. Numbers in openings: width above height.")
    left = len(walls) - len(faces)
    found.append((saved, f"{seen} {words('Walls without an elevation: {count}.', count=left)}" if left else seen))
    return found


def _panel(deck: dict[str, Any], structure: dict[str, Any], folder: Path, words: Language) -> Figures:
    """A wall that is given whole: its elevation with openings, and its cross-section."""
    width, height, thick = structure["width"], structure["height"], structure["thickness"]
    front = View(words("Elevation"), np.zeros(2), np.array([width, height]), 2.0 * LINE, 2.0 * LINE)
    openings = structure.get("openings", [])
    cut = 0.5 * sum(openings[0]["x"]) if openings else 0.5 * width
    across = View(words("Cross-section A–A"), np.zeros(2), np.array([thick, height]), LINE, 2.0 * LINE)
    with style.canvas() as fig:
        sheet = Sheet(fig, [front, across])
        elevation.draw_face(sheet, front, openings, words)
        elevation.dimension_around(sheet, front, words)
        holes = sorted(hole["y"] for hole in openings if hole["x"][0] < cut < hole["x"][1])
        levels = [0.0, *(y for hole in holes for y in hole), height]
        elevation.draw_side(sheet, across, [np.array([[0.0, 0.0], [1.0, 0.0], [1.0, height], [0.0, height]])], thick, elevation.BEYOND, 0.5)
        for a, b in zip(levels[::2], levels[1::2], strict=True):
            if b > a:
                sheet.stone(across, [[0.0, a], [thick, a], [thick, b], [0.0, b]], False)
        _cut_marks(sheet, front, cut)
        foot = sheet.to_paper(across, [[0.0, 0.0], [thick, 0.0]])
        sheet.dimension(foot[0], foot[1], words.number(thick), -LINE)
        sheet.finish(words, _titled(deck))
        saved = style.save(fig, folder, NAME)
    told = words(
        "The wall: elevation and cross-section at scale 1:{scale} on A4. Numbers in openings: width above height.", scale=sheet.scale
    )
    return [(saved, told)]


def _cut_marks(sheet: Sheet, view: View, cut: float) -> None:
    """Where the cross-section is cut: a mark below and above a view."""
    for end, up in ((view.low[1], -1.0), (view.high[1], 1.0)):
        mark = sheet.to_paper(view, [[cut, end]])[0]
        line = np.array([[mark[0], mark[1] + 0.5 * up], [mark[0], mark[1] + 3.0 * up]])
        sheet.ax.plot(*line.T, color="black", linewidth=0.8, zorder=5)
        sheet.ax.text(mark[0] + 1.5, mark[1] + 2.0 * up, "A", fontsize=7, va="center", zorder=7)
