"""What cannot be read in a figure: text cut by its edge, and text over text."""

import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from extrados.running.run import Run
from extrados.show import report, style

#: Pixels that a text may reach beyond the edge, and that two texts may reach into each other
CUT, INTO = 1.5, 2.0
#: Of the smaller of two texts, the share that may be covered
SHARE = 0.08


def drawn_ticks(fig: Figure) -> Iterator[Text]:
    """Labels of the ticks that are drawn."""
    for ax in fig.axes:
        for axis in (ax.xaxis, ax.yaxis):
            if ax.get_visible() and axis.get_visible() and ax.axison:
                for tick in axis._update_ticks():
                    yield from (label for label in (tick.label1, tick.label2) if label.get_visible())
                yield axis.get_offset_text()


def texts(fig: Figure) -> list[tuple[str, Bbox]]:
    """Every text that is drawn with its box in pixels; those of a slant, whose boxes are wider than they are, are left out."""
    renderer = FigureCanvasAgg(fig).get_renderer()
    of_axes = {id(t) for axis in fig.findobj(Axis) for tick in (*axis.majorTicks, *axis.minorTicks) for t in (tick.label1, tick.label2)}
    of_axes |= {id(axis.get_offset_text()) for axis in fig.findobj(Axis)}
    hidden = {id(t) for ax in fig.axes if not ax.get_visible() for t in ax.findobj(Text)}
    bare = {id(t) for ax in fig.axes if not ax.axison for axis in (ax.xaxis, ax.yaxis) for t in axis.findobj(Text)}
    free = [t for t in fig.findobj(Text) if id(t) not in of_axes | hidden | bare]
    found = []
    for text in [*drawn_ticks(fig), *free]:
        if text.get_visible() and text.get_text().strip() and text.get_rotation() % 90.0 == 0.0:
            box = Text.get_window_extent(text, renderer)
            if box.width > 0.0 and box.height > 0.0:
                found.append((text.get_text().replace("\n", " | "), box))
    return found


def faults(fig: Figure) -> list[str]:
    """Texts that are cut, and pairs that cover each other, in words; the figure is laid out."""
    fig.draw_without_rendering()  # legends and titles find their places as they are drawn
    seen, edge = texts(fig), fig.bbox
    told = [
        f"'{text}' is cut by the edge"
        for text, box in seen
        if box.x0 < edge.x0 - CUT or box.y0 < edge.y0 - CUT or box.x1 > edge.x1 + CUT or box.y1 > edge.y1 + CUT
    ]
    for (one, a), (two, b) in itertools.combinations(seen, 2):
        wide, high = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        if wide > INTO and high > INTO and wide * high > SHARE * min(a.width * a.height, b.width * b.height):
            told.append(f"'{one}' and '{two}' cover each other")
    return told


class Watch:
    """Takes the place of plots.style.write: lays a figure out once, looks at it, draws nothing."""

    def __init__(self) -> None:
        self.found: dict[str, list[str]] = {}

    def __call__(self, fig: Figure, target: Path, name: str) -> str:
        style.lay_out(fig)
        style._spread(fig)
        self.found[name] = faults(fig)
        return name

    @property
    def wrong(self) -> list[str]:
        """All faults, each with its figure."""
        return [f"{name}: {fault}" for name, there in self.found.items() for fault in there]


def watch_figures(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Watch:
    """All figures of a run, laid out in this process and not drawn."""
    watch = Watch()
    with monkeypatch.context() as patch:
        patch.setattr(style, "write", watch)
        patch.setattr(report, "_drawn", lambda tasks: [report._draw_one(*task) for task in tasks])
        report.draw(run, folder)
    return watch
