"""One look for all figures."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

STONE, EDGE, THRUST, HINGE, GROUND, SAFE = "#e8e2d4", "#6b6355", "#b3261e", "#1f4e79", "#3b7a57", "#3b7a57"
MODES = ("#f4f1ea", "#cfe3d6", "#f2c28b", "#c8553d")

RC = {
    "font.size": 9, "axes.titlesize": 10, "axes.labelsize": 9, "legend.fontsize": 8, "figure.dpi": 150,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#e4e4e4", "grid.linewidth": 0.6, "lines.linewidth": 1.2, "svg.hashsalt": "extrados",
    "legend.frameon": False, "figure.constrained_layout.use": True,
}  # fmt: skip


@contextmanager
def figure(
    width: float = 7.0, height: float = 4.0, rows: int = 1, columns: int = 1, **options
) -> Iterator[tuple[Figure, np.ndarray]]:
    """A figure in the common style; its axes come as a flat array."""
    with matplotlib.rc_context(RC):
        fig = FigureCanvasAgg(Figure(figsize=(width, height))).figure
        yield fig, fig.subplots(rows, columns, squeeze=False, **options).ravel()


def save(fig: Figure, folder: Path, name: str) -> str:
    """Write figures/NAME.png and .svg; returns the name."""
    target = folder / "figures"
    target.mkdir(exist_ok=True)
    # Laying out measures every label and takes longer than drawing: once, at the size of the PNG. Figure.savefig
    # would lay out and draw unseen anew for each format.
    fig.get_layout_engine().execute(fig)
    fig.set_layout_engine("none")
    # A tenth more bytes for half the time of compressing
    FigureCanvasAgg(fig).print_png(target / f"{name}.png", pil_kwargs={"compress_level": 2})
    FigureCanvasSVG(fig).print_svg(target / f"{name}.svg", metadata={"Date": None})
    return name


def legend_below(fig: Figure, ax: Axes) -> None:
    """The legend of `ax` below the whole figure, where a drawing has no room for it."""
    handles, labels = ax.get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=len(labels))


def numbers(axis: Axis) -> None:
    """Ticks at whole numbers only: joints, events."""
    axis.set_major_locator(MaxNLocator(integer=True))


def section_axes(ax: Axes) -> None:
    """Axes for a drawing of a structure that is already in them: equal scales, metres."""
    ax.set_aspect("equal")
    slender = np.ptp(ax.get_xlim()) / np.ptp(ax.get_ylim())
    if slender < 0.5:  # the labels below a narrow drawing must not run into each other
        ax.xaxis.set_major_locator(MaxNLocator(nbins=2 if slender < 0.3 else 3))
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
    for point, label in zip(points, labels or [], strict=False):
        ax.annotate(label, point, textcoords="offset points", xytext=(6, 6), fontsize=8, color=HINGE)
