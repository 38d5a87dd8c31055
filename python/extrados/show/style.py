"""One look for all figures."""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from matplotlib.ticker import AutoLocator, MaxNLocator

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

STEPS = "#3a7d44"  # states found by equilibrium iterations
STONE, EDGE, THRUST, HINGE, GROUND, SAFE = "#e8e2d4", "#6b6355", "#b3261e", "#1f4e79", "#3b7a57", "#3b7a57"
WATER = "#5b8fb9"
MODES = ("#f4f1ea", "#cfe3d6", "#f2c28b", "#c8553d", "#9db4cf")

#: Marks labels that are spread as a figure is saved
LETTER = "letter"
RINGS = (9.0, 12.0, 18.0, 26.0)  # points from the place
LEGEND_LINE, LEGEND_LETTER = 0.55, 0.062  # width of an entry of a legend without its letters, and of a letter [in]
RC: "dict[RcKeyType, Any]" = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.labelsize": 9,
    "legend.fontsize": 8,
    "figure.dpi": 150,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "svg.hashsalt": "extrados",
    "legend.frameon": False,
    "figure.constrained_layout.use": True,
}


@contextmanager
def canvas(width: float = 7.0, height: float = 4.0) -> Iterator[Figure]:
    """An empty figure in the common style."""
    with matplotlib.rc_context(RC):
        yield FigureCanvasAgg(Figure(figsize=(width, height))).figure


@contextmanager
def figure(width: float = 7.0, height: float = 4.0, rows: int = 1, columns: int = 1, **options: Any) -> Iterator[tuple[Figure, np.ndarray]]:
    """A figure in the common style; its axes come as a flat array."""
    with canvas(width, height) as fig:
        yield fig, fig.subplots(rows, columns, squeeze=False, **options).ravel()


def save(fig: Figure, folder: Path, name: str) -> str:
    """Write figures/NAME.png and .svg; returns the name."""
    target = folder / "figures"
    target.mkdir(exist_ok=True)
    return write(fig, target, name)


#: Where figures are kept instead of written, by their names; None where they are written
_kept: ContextVar[dict[str, Figure] | None] = ContextVar("kept", default=None)


@contextmanager
def kept() -> Iterator[dict[str, Figure]]:
    """Figures that are drawn meanwhile are not written: they come as objects of matplotlib, by their names."""
    found: dict[str, Figure] = {}
    before = _kept.set(found)
    try:
        yield found
    finally:
        _kept.reset(before)


def lay_out(fig: Figure) -> None:
    """Settle the places of axes and labels once and for all."""
    engine = fig.get_layout_engine()
    if engine is not None:
        # Axes of equal scales change their size when they are placed: only a second layout leaves room for their titles
        for _ in range(2 if any(ax.get_aspect() != "auto" for ax in fig.axes) else 1):
            engine.execute(fig)
    fig.set_layout_engine("none")


def write(fig: Figure, target: Path, name: str) -> str:
    """Write NAME.png and NAME.svg into a folder; returns the name."""
    # Laying out measures every label and takes longer than drawing: once, at the size of the PNG. Figure.savefig
    # would lay out and draw unseen anew for each format.
    lay_out(fig)
    _spread(fig)
    there = _kept.get()
    if there is not None:
        there[name] = fig
        return name
    # A tenth more bytes for half the time of compressing
    FigureCanvasAgg(fig).print_png(target / f"{name}.png", pil_kwargs={"compress_level": 2})
    FigureCanvasSVG(fig).print_svg(target / f"{name}.svg", metadata={"Date": None})
    return name


def legend_below(fig: Figure, ax: Axes) -> None:
    """The legend of `ax` below the whole figure, where a drawing has no room for it."""
    handles, labels = ax.get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=_columns(fig, labels))


def whole_figure(ax: Axes) -> Figure:
    """The figure that contains the axes."""
    fig = ax.get_figure(root=True)
    assert fig is not None  # axes are made by a figure
    return fig


def _columns(fig: Figure, labels: list[str]) -> int:
    """How many entries of a legend fit side by side."""
    entry = LEGEND_LINE + LEGEND_LETTER * max(map(len, labels), default=0)
    return max(1, min(len(labels), int(fig.get_figwidth() / entry)))


def legend_above(ax: Axes, handles: list | None = None, labels: list[str] | None = None) -> None:
    """The legend of `ax` over its upper right corner, in rows of up to four, where curves fill all of it."""
    if handles is None or labels is None:
        handles, labels = ax.get_legend_handles_labels()
    ax.legend(
        handles,
        labels,
        ncols=min(_columns(whole_figure(ax), labels), 4),
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=0.0,
        borderpad=0.1,
    )


def numbers(axis: Axis) -> None:
    """Ticks at whole numbers only: joints, events."""
    axis.set_major_locator(MaxNLocator(integer=True))


class InnerLocator(AutoLocator):
    """Ticks away from the ends of an axis whose limits follow its size ("datalim"): the layout, which settles that size,
    leaves no room for a number that only then comes to stand at the edge."""

    CLEAR = 0.05  # of the axis, at each end

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        ticks: Any = np.asarray(super().tick_values(vmin, vmax))
        clear = self.CLEAR * (vmax - vmin)
        kept: Sequence[float] = ticks[(ticks >= vmin + clear) & (ticks <= vmax - clear)]
        return kept


#: Energies below this are rounding, in J
NO_ENERGY = 1e-6


def energies(ax: Axes, what: str, curves: list[tuple[np.ndarray, np.ndarray, dict]]) -> None:
    """Energies [J] over times, each with the options of its line, in J or kJ by their size; rounding is drawn as zero."""
    most = max((float(np.abs(energy).max(initial=0.0)) for _, energy, _ in curves), default=0.0)
    factor, unit = (1e3, "kJ") if most >= 100.0 else (1.0, "J")
    for time, energy, options in curves:
        ax.plot(time, energy / factor, **options)
    ax.set_ylabel(f"{what} [{unit}]")
    if most < NO_ENERGY:
        ax.set_ylim(-1.0, 1.0)


def section_axes(ax: Axes) -> None:
    """Axes for a drawing of a structure that is already in them: equal scales, metres."""
    ax.set_aspect("equal")
    slender = np.ptp(ax.get_xlim()) / np.ptp(ax.get_ylim())
    if slender < 0.5:  # the labels below a narrow drawing must not run into each other
        ax.xaxis.set_major_locator(MaxNLocator(1 if slender < 0.15 else 2 if slender < 0.3 else 3, min_n_ticks=1))
    ax.grid(False)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")


def draw_blocks(ax: Axes, outlines: list[np.ndarray]) -> None:
    """Block outlines as stone."""
    ax.add_collection(PolyCollection(outlines, facecolors=STONE, edgecolors=EDGE, linewidths=0.7, zorder=1))
    ax.autoscale_view()


def draw_hinges(ax: Axes, points: np.ndarray, labels: list[str] | None = None) -> None:
    """Hinges as circles, with labels beside them."""
    ax.plot(*points.T, "o", color=HINGE, markersize=6, markerfacecolor="white", markeredgewidth=1.6, zorder=5)
    if labels:
        letters(ax, points, labels, HINGE)


def pair(point: np.ndarray) -> tuple[float, float]:
    """A place of the plane as two numbers."""
    x, y = point
    return float(x), float(y)


def letters(ax: Axes, points: Iterable[Any], labels: list[str], colour: str) -> None:
    """Labels beside points; their positions are determined when the figure is saved, so that they do not overlap."""
    for point, label in zip(points, labels, strict=False):
        ax.annotate(
            label,
            point,
            textcoords="offset points",
            xytext=(0, 0),
            fontsize=8,
            color=colour,
            ha="center",
            va="center",
            gid=LETTER,
            zorder=7,
            annotation_clip=False,
        )


def _spread(fig: Figure) -> None:
    """Put every letter beside its place where it hides least: no other letter, no other place, no line if that can be.

    Candidates stand on rings around the place; a letter far from it gets a hair line to it.
    """
    pixel, renderer = fig.dpi / 72.0, FigureCanvasAgg(fig).get_renderer()
    for ax in fig.axes:
        texts = [t for t in ax.texts if isinstance(t, Annotation) and t.get_gid() == LETTER]
        if not texts:
            continue
        ax.apply_aspect()  # as the drawing will, after the layout
        places = ax.transData.transform(np.array([t.xy for t in texts]))
        drawn = [
            _sampled(seen, 3.0 * pixel) for line in ax.lines if len(seen := _finite(line.get_transform().transform(line.get_xydata()))) > 1
        ]
        ink = np.concatenate([*drawn, np.empty((0, 2))])
        frame = ax.get_window_extent()
        # boxes: left, low, right, high; what else is written there stays where it is
        fixed = [t for t in ax.texts if t not in texts and t.get_visible() and t.get_text().strip()]
        taken = [np.ravel(t.get_window_extent(renderer).get_points()) for t in fixed]
        for text, place in zip(texts, places, strict=True):
            half = pixel * np.array([2.9 * len(text.get_text()) + 1.0, 5.0])
            best, least = np.zeros(2), np.inf
            for ring in RINGS:
                for k in range(12):
                    turn = np.pi / 4 + k * np.pi / 6
                    offset = pixel * ring * np.array([np.cos(turn), np.sin(turn)])
                    middle = place + offset
                    box = np.concatenate([middle - half, middle + half])
                    cost = 0.02 * ring + 0.002 * k
                    cost += 40.0 * sum(_hides(box, other) for other in taken)
                    apart = np.abs(places - middle) < half + 4.0 * pixel
                    cost += 20.0 * float(apart.all(axis=1).sum())
                    cost += 0.25 * min(8.0, float((np.abs(ink - middle) < half).all(axis=1).sum()))
                    cost += 100.0 * (not frame.x0 < middle[0] < frame.x1 or not frame.y0 < middle[1] < frame.y1)
                    if cost < least:
                        best, least = offset, cost
            taken.append(np.concatenate([place + best - half, place + best + half]))
            text.set_position(tuple(best / pixel))
            if np.hypot(*best) > 14.0 * pixel:
                text.arrow_patch = None
                ends = ax.transData.inverted().transform(np.array([place, place + best * 0.72]))
                limits = ax.get_xlim(), ax.get_ylim()
                ax.plot(*ends.T, color=text.get_color(), linewidth=0.5, zorder=4.5)
                ax.set_xlim(limits[0])
                ax.set_ylim(limits[1])


def _finite(points: np.ndarray) -> np.ndarray:
    return points[np.isfinite(points).all(axis=1)]


def _sampled(points: np.ndarray, step: float) -> np.ndarray:
    """Places along a path of pixels, about a step apart."""
    parts = [points]
    for a, b in itertools.pairwise(points):
        count = int(min(400.0, np.hypot(*(b - a)) / step)) if np.isfinite(a + b).all() else 0
        parts.append(a + (b - a) * (np.arange(1, count) / max(count, 1))[:, None])
    return np.concatenate(parts)


def _hides(box: np.ndarray, other: np.ndarray) -> bool:
    return bool((box[:2] < other[2:]).all() and (other[:2] < box[2:]).all())
