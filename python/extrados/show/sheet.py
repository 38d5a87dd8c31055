"""A sheet of paper with views at one scale: dimensions, drawing frame, title strip and scale bar."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from extrados.show import style
from extrados.show.language import Language
from extrados.show.limit.section import HATCH

#: Colour of dimensions
INK = "#1f4e79"
#: Of the sheet [mm]: its width, the width of the text of a printed page; its greatest height; margin within the frame
WIDTH, HEIGHT, MARGIN = 170.0, 178.0, 4.0
#: Rows of the title strip, room for one line of dimensions, between views, and over a view for its name [mm]
STRIP, LINE, GAP, HEAD = 16.0, 6.0, 8.0, 10.0
#: Width of a letter of a view's name [mm]
LETTER = 1.8
SCALES = (5, 10, 20, 25, 50, 100, 200, 250, 500, 1000, 2000, 5000)
INCH = 25.4


@dataclass(frozen=True)
class View:
    """A part of the sheet: its name, ends of what it shows [m], and room for dimensions to the left, below and above [mm]."""

    name: str
    low: np.ndarray
    high: np.ndarray
    left: float = LINE
    below: float = LINE
    above: float = 0.0

    def size(self, scale: int) -> np.ndarray:
        """Width and height on paper [mm] with dimensions and name."""
        size = 1e3 / scale * (self.high - self.low) + (self.left + LINE, self.below + HEAD + self.above)
        return np.maximum(size, (LETTER * max(map(len, self.label(scale).split("\n"))), 0.0))

    def label(self, scale: int) -> str:
        """The name, divided into two lines of similar length if it is wider than the view."""
        wide = 1e3 / scale * float(self.high[0] - self.low[0]) < LETTER * len(self.name)
        if not wide or " " not in self.name:
            return self.name
        words = self.name.split(" ")
        pairs = [(" ".join(words[:k]), " ".join(words[k:])) for k in range(1, len(words))]
        return "\n".join(min(pairs, key=lambda pair: max(map(len, pair))))


class Sheet:
    """Views on one sheet of paper at one scale; `to_paper` brings a view's points [m] to the paper [mm]."""

    def __init__(self, fig: Figure, views: Sequence[View]):
        self.scale, rows = _arranged(views)
        self.height = _height(rows, self.scale) + STRIP + 2.0 * MARGIN
        fig.set_size_inches(WIDTH / INCH, self.height / INCH)
        fig.set_layout_engine("none")  # nothing may change the scale
        self.ax: Axes = fig.add_axes((0.0, 0.0, 1.0, 1.0))
        self.ax.set_xlim(0.0, WIDTH)
        self.ax.set_ylim(0.0, self.height)
        self.ax.axis("off")
        top = self.height - MARGIN
        self.corner: dict[str, np.ndarray] = {}
        for row in rows:
            sizes = [view.size(self.scale) for view in row]
            x = 0.5 * (WIDTH - _width(row, self.scale))
            for view, size in zip(row, sizes, strict=True):
                foot = np.array([x + _aside(view, self.scale), top - size[1] + view.below])
                self.corner[view.name] = foot - 1e3 / self.scale * view.low
                self.ax.text(x + 0.5 * size[0], top - 3.0, view.label(self.scale), ha="center", va="center", fontsize=8, weight="bold")
                x += size[0] + GAP
            top -= max(size[1] for size in sizes) + GAP

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

    def finish(self, words: Language, title: str, *more: str) -> None:
        """Frame, title strip and scale bar; more: lines of its last cell."""
        cells = (f"{words('Scale')} 1:{self.scale} (A4)", words("Dimensions in m"), *more)
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


def scale_of(views: Sequence[View]) -> int:
    """The scale 1:n at which they fit on one sheet."""
    return _arranged(views)[0]


def _aside(view: View, scale: int) -> float:
    """From the left of a view to its drawing [mm], which stands in the middle of a wide name."""
    wide = 1e3 / scale * float(view.high[0] - view.low[0]) + view.left + LINE
    return view.left + 0.5 * max(0.0, float(view.size(scale)[0]) - wide)


def _arranged(views: Sequence[View]) -> tuple[int, list[list[View]]]:
    """The largest scale at which the views fit on the sheet, and its rows of views, in their order."""
    for scale in SCALES:
        rows: list[list[View]] = []
        for view in views:
            if rows and _width([*rows[-1], view], scale) <= WIDTH - 2.0 * MARGIN:
                rows[-1].append(view)
            else:
                rows.append([view])
        wide = max(_width(row, scale) for row in rows)
        if (wide <= WIDTH - 2.0 * MARGIN and _height(rows, scale) <= HEIGHT - STRIP - 2.0 * MARGIN) or scale == SCALES[-1]:
            return scale, rows
    raise AssertionError


def _width(row: Sequence[View], scale: int) -> float:
    """Of views side by side [mm]."""
    return float(sum(view.size(scale)[0] for view in row)) + GAP * (len(row) - 1)


def _height(rows: Sequence[Sequence[View]], scale: int) -> float:
    """Of rows of views, one below the other [mm]."""
    return float(sum(max(view.size(scale)[1] for view in row) for row in rows)) + GAP * (len(rows) - 1)


def _round_below(value: float) -> float:
    """The greatest of 1, 2 and 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(k * power for k in (1.0, 2.0, 5.0) if k * power <= value * (1.0 + 1e-9)))


def _folded(text: str, width: int) -> str:
    return "\n".join(textwrap.wrap(text, width)[:3])
