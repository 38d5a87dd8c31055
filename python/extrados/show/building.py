"""The drawing of the building to scale: section with dimensions, cross-section or plan, in a drawing frame with a scale bar."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from extrados.results.store import Stored
from extrados.schema.text import printable
from extrados.show import style
from extrados.show.language import Language
from extrados.show.limit.section import FILL, HATCH, PAVED

NAME = "building"
#: Colour of dimensions
INK = "#1f4e79"
#: Of the sheet [mm]: its width, the width of the text of a printed page; its greatest height; margin within the frame
WIDTH, HEIGHT, MARGIN = 170.0, 178.0, 4.0
#: Rows of the title strip, room for one line of dimensions, between views, and over a view for its name [mm]
STRIP, LINE, GAP, HEAD = 16.0, 6.0, 12.0, 10.0
#: Width of a letter of a view's name [mm]
LETTER = 2.0
SCALES = (5, 10, 20, 25, 50, 100, 200, 250, 500, 1000, 2000, 5000)
INCH = 25.4


@dataclass(frozen=True)
class View:
    """A part of the sheet: its name, ends of what it shows [m], and room for dimensions to the left and below [mm]."""

    name: str
    low: np.ndarray
    high: np.ndarray
    left: float = LINE
    below: float = LINE

    def size(self, scale: int) -> np.ndarray:
        """Width and height on paper [mm] with dimensions and name."""
        size = 1e3 / scale * (self.high - self.low) + (self.left + LINE, self.below + HEAD)
        return np.maximum(size, (LETTER * len(self.name), 0.0))


class Sheet:
    """Views on one sheet of paper at one scale; `to_paper` brings a view's points [m] to the paper [mm]."""

    def __init__(self, fig: Figure, views: Sequence[View]):
        self.scale, beside, height = _arranged(views)
        self.height = height + STRIP + 2.0 * MARGIN
        fig.set_size_inches(WIDTH / INCH, self.height / INCH)
        fig.set_layout_engine("none")  # nothing may change the scale
        self.ax: Axes = fig.add_axes((0.0, 0.0, 1.0, 1.0))
        self.ax.set_xlim(0.0, WIDTH)
        self.ax.set_ylim(0.0, self.height)
        self.ax.axis("off")
        sizes = [view.size(self.scale) for view in views]
        total = sum(size[0] for size in sizes) + GAP * (len(views) - 1) if beside else max(size[0] for size in sizes)
        x, top = 0.5 * (WIDTH - total), self.height - MARGIN
        self.corner: dict[str, np.ndarray] = {}
        for view, size in zip(views, sizes, strict=True):
            at = x if beside else 0.5 * (WIDTH - size[0])
            self.corner[view.name] = np.array([at + _aside(view, self.scale), top - size[1] + view.below]) - 1e3 / self.scale * view.low
            self.ax.text(at + 0.5 * size[0], top - 3.0, view.name, ha="center", va="center", fontsize=8, weight="bold")
            if beside:
                x += size[0] + GAP
            else:
                top -= size[1] + GAP

    def to_paper(self, view: View, points: Any) -> np.ndarray:
        """Points (n, 2) [m] of a view on the paper [mm]."""
        return self.corner[view.name] + 1e3 / self.scale * np.asarray(points, dtype=float)

    def fill(self, view: View, points: Any, colour: str, **look: Any) -> None:
        """A filled outline."""
        self.ax.add_patch(Polygon(self.to_paper(view, points), facecolor=colour, **look))

    def stone(self, view: View, points: Any, thin: bool) -> None:
        """A cut block."""
        self.fill(view, points, style.STONE, edgecolor=HATCH, hatch="/////", linewidth=0.0, zorder=2)
        self.fill(view, points, "none", edgecolor=style.EDGE, linewidth=0.25 if thin else 0.5, zorder=2.5)

    def dimension(self, a: np.ndarray, b: np.ndarray, text: str, aside: float = 0.0, at: float = 0.5) -> None:
        """A dimension line between two places on the paper [mm], moved aside from them, with witness lines and ticks; at: where along
        it its text stands."""
        along = (b - a) / max(float(np.hypot(*(b - a))), 1e-9)
        upright = abs(along[1]) > abs(along[0])
        shift = np.array([aside, 0.0]) if upright else np.array([0.0, aside])
        start, end = a + shift, b + shift
        tick = 1.0 * (along + np.array([-along[1], along[0]]))
        ink: dict[str, Any] = {"color": INK, "linewidth": 0.5, "zorder": 6, "solid_capstyle": "butt"}
        self.ax.plot(*np.array([start, end]).T, **ink)
        for here, there in ((a, start), (b, end)):
            self.ax.plot(*np.array([there - tick, there + tick]).T, **ink)
            if aside:
                self.ax.plot(*np.array([here, there]).T, **(ink | {"linewidth": 0.25}))
        middle = start + at * (end - start) + ((-1.6, 0.0) if upright else (0.0, 1.6 if aside else -1.8))
        self.ax.text(
            *style.pair(middle),
            text,
            fontsize=7,
            color=INK,
            ha="center",
            va="center",
            rotation=90 if upright else 0,
            zorder=7,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.75},
        )

    def finish(self, words: Language, title: str, cells: Sequence[str]) -> None:
        """Frame, title strip and scale bar."""
        frame: dict[str, Any] = {"color": "black", "linewidth": 0.8, "zorder": 1}
        box = np.array([[1.0, 1.0], [WIDTH - 1.0, 1.0], [WIDTH - 1.0, self.height - 1.0], [1.0, self.height - 1.0], [1.0, 1.0]])
        self.ax.plot(*box.T, **frame)
        self.ax.plot([1.0, WIDTH - 1.0], [STRIP, STRIP], **frame)
        edges = (1.0, 62.0, 124.0, WIDTH - 1.0)
        for x in edges[1:-1]:
            self.ax.plot([x, x], [1.0, STRIP], **frame)
        self.ax.text(3.0, 0.5 * (1.0 + STRIP), _folded(title, 31), fontsize=8, va="center", weight="bold")
        self.ax.text(edges[2] + 2.0, 0.5 * (1.0 + STRIP), "\n".join(cells), fontsize=7, va="center", linespacing=1.5)
        step = _round_below(40.0 * self.scale / 1e3)  # m
        x, y, long = edges[1] + 6.0, 5.0, 1e3 * step / self.scale
        for k in range(4):
            ends = np.array([[k, 0.0], [k + 1, 0.0], [k + 1, 1.0], [k, 1.0]]) * (0.25 * long, 1.2) + (x, y)
            self.ax.add_patch(Polygon(ends, facecolor="black" if k % 2 == 0 else "white", edgecolor="black", linewidth=0.5))
        for part, value in ((0.0, 0.0), (0.5, 0.5 * step), (1.0, step)):
            unit = " m" if part == 1.0 else ""
            self.ax.text(x + part * long, y + 2.0, f"{words.given(value)}{unit}", fontsize=7, ha="center", va="bottom")


def _aside(view: View, scale: int) -> float:
    """From the left of a view to its drawing [mm], which stands in the middle of a wide name."""
    wide = 1e3 / scale * float(view.high[0] - view.low[0]) + view.left + LINE
    return view.left + 0.5 * max(0.0, float(view.size(scale)[0]) - wide)


def _arranged(views: Sequence[View]) -> tuple[int, bool, float]:
    """The largest scale at which the views fit on the sheet, whether side by side, and their height [mm]."""
    for scale in SCALES:
        sizes = np.array([view.size(scale) for view in views])
        spare = GAP * (len(views) - 1)
        for beside in (True, False):
            width = sizes[:, 0].sum() + spare if beside else sizes[:, 0].max()
            height = sizes[:, 1].max() if beside else sizes[:, 1].sum() + spare
            if (width <= WIDTH - 2.0 * MARGIN and height <= HEIGHT - STRIP - 2.0 * MARGIN) or scale == SCALES[-1]:
                return scale, beside, float(height)
    raise AssertionError


def _round_below(value: float) -> float:
    """The greatest of 1, 2 and 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(k * power for k in (1.0, 2.0, 5.0) if k * power <= value * (1.0 + 1e-9)))


def _folded(text: str, width: int) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(text, width)[:3])


def draw_building(run: Stored, folder: Path, words: Language | None = None) -> tuple[str, str] | None:
    """The section with spans, rises, widths and height beside a cross-section, or the plan of a building, to scale; whether or not an
    analysis has a result. None where the deck has no plane section."""
    words = words or Language()
    deck = run.summary["deck"]
    structure = deck["resolved"].get("structure") or {}
    if structure.get("kind") == "building":
        return _plan(deck, structure, folder, words)
    drawing = deck.get("drawing")
    return _section(deck, drawing, folder, words) if drawing else None


def _section(deck: dict[str, Any], drawing: dict[str, Any], folder: Path, words: Language) -> tuple[str, str]:
    rows = [row for row in deck.get("dimensions", []) if "start" in row]
    outlines = [np.array(outline) for outline in drawing["outlines"]]
    earth, depth = drawing["earth"], drawing["depth_m"]
    points = np.concatenate(outlines)
    low, high = points.min(axis=0), points.max(axis=0)
    if earth is not None:
        high[1] = max(high[1], earth["road"])
    levels = _levels([row for row in rows if row["aside"] == "below"])
    section = View(words("Section"), low, high, 2.2 * LINE, LINE * (1.0 + max(levels, default=0)))
    cut = drawing["crown_m"] if drawing["crown_m"] is not None else 0.5 * float(low[0] + high[0])
    pieces = _cut(outlines, cut + 1e-4)
    ends = [y for piece in pieces for y in piece] or [float(low[1]), float(high[1])]
    if earth is not None:
        ends.append(earth["road"])
    across = View(words("Cross-section A–A"), np.array([0.0, min(ends)]), np.array([depth, max(ends)]), LINE, 2.0 * LINE)
    with style.canvas() as fig:
        sheet = Sheet(fig, [section, across])
        thin = len(outlines) > 200
        if earth is not None:
            _earth(sheet, section, earth)
            top = max((b for _, b in pieces), default=earth["formation"])
            wall = drawing.get("spandrel_m", 0.0)
            level = earth["formation"]
            for a, b, colour in ((top, level, FILL), (level, earth["road"], PAVED)):
                if b > a:
                    box = [[0, a], [depth, a], [depth, b], [0, b]]
                    sheet.fill(across, box, colour, edgecolor=style.EDGE, linewidth=0.3, zorder=1)
            for left, right in ((0.0, wall), (depth - wall, depth)) if wall else ():
                sheet.stone(across, [[left, top], [right, top], [right, level], [left, level]], thin)
        for outline in outlines:
            sheet.stone(section, outline, thin)
        for a, b in pieces:
            sheet.stone(across, [[0.0, a], [depth, a], [depth, b], [0.0, b]], thin)
        for support in drawing["supports"]:
            sheet.ax.plot(*sheet.to_paper(section, support).T, color="black", linewidth=1.6, zorder=3, solid_capstyle="butt")
        for end, up in ((low[1], -1.0), (high[1], 1.0)):
            mark = sheet.to_paper(section, [[cut, end]])[0]
            line = np.array([[mark[0], mark[1] + 0.5 * up], [mark[0], mark[1] + 3.0 * up]])
            sheet.ax.plot(*line.T, color="black", linewidth=0.8, zorder=5)
            sheet.ax.text(mark[0] + 1.5, mark[1] + 2.0 * up, "A", fontsize=7, va="center", zorder=7)
        _dimensions(sheet, section, rows, levels, words)
        foot = sheet.to_paper(across, [[0.0, min(ends)], [depth, min(ends)]])
        sheet.dimension(foot[0], foot[1], words.number(depth), -LINE)
        cells = (f"{words('Scale')} 1:{sheet.scale} (A4)", words("Dimensions in m"), _blocks(words, len(outlines)))
        sheet.finish(words, _titled(deck), cells)
        saved = style.save(fig, folder, NAME)
    told = "; ".join(f"{name_of(words, row['name'])} {words.number(row['length_m'])} m" for row in rows)
    told = f" {told[:1].upper()}{told[1:]}." if told else ""
    return (saved, f"{words('The building: section and cross-section at scale 1:{scale} on A4.', scale=sheet.scale)}{told}")


def heading(deck: dict[str, Any]) -> str:
    """The title of a deck, else the name of its file, or that of its folder where the file is called after no building."""
    path = Path(deck["path"])
    name = path.absolute().parent.name if path.stem.lower() in NAMELESS else path.stem
    return str(deck.get("title") or name or "extrados run")


def _titled(deck: dict[str, Any]) -> str:
    return printable(heading(deck))


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
    return f"{words(what)}{words(' of {part}', part=where)}" if of else words(name)


#: Names of dimensions that report and drawing tell
DIMENSIONS = (
    "clear span",
    "rise",
    "thickness at the crown",
    "width at the base",
    "width",
    "height",
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
    free = iter(levels)
    for row in rows:
        a, b = sheet.to_paper(view, [row["start"], row["end"]])
        text = words.number(row["length_m"])
        if row["aside"] == "below":
            sheet.dimension(np.array([a[0], bottom[1]]), np.array([b[0], bottom[1]]), text, -LINE * next(free))
        elif row["aside"] == "left":
            sheet.dimension(np.array([bottom[0], a[1]]), np.array([bottom[0], b[1]]), text, -1.4 * LINE)
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


def _plan(deck: dict[str, Any], structure: dict[str, Any], folder: Path, words: Language) -> tuple[str, str]:
    """The walls of a building on its plan, with names, lengths and thicknesses, and the heights of its storeys."""
    walls = structure["walls"]
    ends = np.array([[wall["start"], wall["end"]] for wall in walls], dtype=float)
    low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
    plan = View(words("Plan"), low, high, 3.0 * LINE, 3.0 * LINE)
    storeys = np.concatenate([[0.0], np.cumsum(structure["storeys"])])
    upright = View(words("Storeys"), np.array([0.0, 0.0]), np.array([0.15 * storeys[-1], storeys[-1]]), 2.0 * LINE)
    with style.canvas() as fig:
        sheet = Sheet(fig, [plan, upright])
        middle = 0.5 * (low + high)
        for wall, (start, end) in zip(walls, ends, strict=True):
            thick = wall.get("thickness") or max(wall["thicknesses"])
            along = (end - start) / np.linalg.norm(end - start)
            across = np.array([-along[1], along[0]])
            half = 0.5 * thick * across
            sheet.stone(plan, [start + half, end + half, end - half, start - half], False)
            out = across if across @ (0.5 * (start + end) - middle) >= 0.0 else -across
            place = sheet.to_paper(plan, [0.5 * (start + end) + out * 0.5 * thick])[0] + 3.5 * out
            turn = np.degrees(np.arctan2(along[1], along[0]))
            told = f"{wall['name']}: {words.number(float(np.linalg.norm(end - start)))} m, {words.quantity(thick, 'm')}"
            sheet.ax.text(
                *style.pair(place),
                told,
                color=INK,
                ha="center",
                va="center",
                rotation=90.0 - (90.0 - turn) % 180.0,
                fontsize=7,
                zorder=7,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.75},
            )
        for a, b in itertools.pairwise(storeys):
            here = sheet.to_paper(upright, [[0.0, a], [0.0, b], [upright.high[0], a], [upright.high[0], b]])
            sheet.dimension(here[0], here[1], words.number(float(b - a)), -LINE)
            for left, right in ((here[0], here[2]), (here[1], here[3])):
                sheet.ax.plot(*np.array([left, right]).T, color="black", linewidth=0.8)
        cells = (f"{words('Scale')} 1:{sheet.scale} (A4)", words("Dimensions in m"))
        sheet.finish(words, _titled(deck), cells)
        saved = style.save(fig, folder, NAME)
    *first, last = [words.number(h) for h in structure["storeys"]]
    heights = f"{words('Storeys, from the ground up')}: {', '.join([*first, last])} m" if first else f"{words('Storey')}: {last} m"
    told = words("length of each wall on its middle plane, and its greatest thickness")
    return saved, f"{words('Plan of the building')}: {told}. {heights}."
