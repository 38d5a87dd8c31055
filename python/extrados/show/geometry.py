"""The picture of a survey before the calculation: blocks, joints, supports, and gaps and overlaps between blocks."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

from extrados.results.solid_files import Solid
from extrados.show import scene, style

COLOURS = {"closed": style.GROUND, "open": "#d98200", "overlap": style.THRUST, "loose end": "#d98200", "sole": style.HINGE}
MOST_ZOOMS = 4
MOST_NUMBERED = 40


@dataclass(frozen=True)
class Mark:
    """A place [m] where something is amiss, how deep [m] (None: no depth), and of which status."""

    place: tuple[float, float]
    depth: float | None
    status: str
    between: str


def draw_survey(folder: Path, name: str, outlines: list[np.ndarray], joints: np.ndarray, ground: np.ndarray, marks: list[Mark]) -> Path:
    """Write folder/NAME.png and .svg; joints and ground (k, 4) x, y, x, y [m]. The worst places are shown enlarged."""
    points = np.concatenate(outlines)
    tall = float(np.ptp(points[:, 1]) / max(np.ptp(points[:, 0]), 1e-9))
    amiss = [m for m in marks if m.status != "closed"]
    zooms = [m for m in amiss if m.depth is not None][:MOST_ZOOMS] or [m for m in marks if m.depth is not None][:1]
    width = 6.5 + 2.6 * (len(zooms) > 0) + 2.6 * (len(zooms) > 2)
    height = float(np.clip(6.5 * tall + 1.4, 4.2, 8.0))
    with style.canvas(width, height) as fig:
        columns = 1 + (len(zooms) > 0) + (len(zooms) > 2)
        grid = fig.add_gridspec(2, columns, width_ratios=[6.5, *[2.6] * (columns - 1)])
        ax = fig.add_subplot(grid[:, 0])
        _stones(ax, outlines, joints, ground)
        number = {id(m): k for k, m in enumerate(amiss, start=1)}
        for status, colour in COLOURS.items():
            here = np.array([m.place for m in marks if m.status == status]).reshape(-1, 2)
            if len(here):
                small = status == "closed"
                ax.plot(
                    *here.T,
                    "." if small else "o",
                    color=colour,
                    markersize=2.0 if small else 7.0,
                    zorder=4,
                    markerfacecolor=colour if small else "none",
                    label=f"{status} ({len(here)})",
                )
        numbered = amiss[:MOST_NUMBERED]
        if numbered:
            style.letters(ax, np.array([m.place for m in numbered]), [str(number[id(m)]) for m in numbered], "black")
        ax.autoscale_view()
        style.section_axes(ax)
        ax.set_title(f"{len(outlines)} stones, {len(joints)} joints")
        style.legend_below(fig, ax)
        for k, mark in enumerate(zooms):
            zoom = fig.add_subplot(grid[k % 2, 1 + k // 2])
            _stones(zoom, outlines, joints, ground)
            reach = max(6.0 * (mark.depth or 0.0), 0.03)
            zoom.plot(*mark.place, "o", color=COLOURS[mark.status], markersize=9, markerfacecolor="none", zorder=4)
            zoom.set_xlim(mark.place[0] - reach, mark.place[0] + reach)
            zoom.set_ylim(mark.place[1] - reach, mark.place[1] + reach)
            label = f"{number[id(mark)]}: " if id(mark) in number else "widest: "
            zoom.set_title(f"{label}{mark.status}, {1e3 * (mark.depth or 0.0):.3g} mm", fontsize=8)
            zoom.set_aspect("equal")
            zoom.grid(False)
            zoom.tick_params(labelsize=6)
            zoom.locator_params(nbins=3)
            zoom.ticklabel_format(useOffset=False)
        style.write(fig, folder, name)
    return folder / f"{name}.png"


def _stones(ax: Axes, outlines: list[np.ndarray], joints: np.ndarray, ground: np.ndarray) -> None:
    # Seen through, so that an overlap is darker and both outlines show.
    ax.add_collection(PolyCollection(outlines, facecolors=style.STONE, edgecolors="none", alpha=0.6))
    ax.add_collection(PolyCollection(outlines, facecolors="none", edgecolors=style.EDGE, linewidths=0.5))
    ax.add_collection(LineCollection(list(joints.reshape(-1, 2, 2)), colors=style.HINGE, linewidths=1.0, zorder=2))
    ax.add_collection(LineCollection(list(ground.reshape(-1, 2, 2)), colors=style.EDGE, linewidths=2.2, zorder=1))
    points = np.concatenate(outlines)
    ax.update_datalim(points)


SHRUNK = 0.82  # of their size: stones of the exploded drawing, so that what lies between them shows


def draw_stones(
    folder: Path, name: str, parts: Sequence[Solid], owner: np.ndarray, contacts: Sequence[np.ndarray], grounded: np.ndarray
) -> None:
    """Write folder/NAME.png and .svg: solids as they stand, and shrunk about their middles with the contacts between them,
    those on the ground in another colour."""
    view = scene.View()
    points = np.concatenate([p.vertices for p in parts])
    frame = scene.frame_of(points, view)
    start = np.cumsum([0, *(len(p.vertices) for p in parts)])
    faces = [np.array(f) + k for p, k in zip(parts, start[:-1].tolist(), strict=True) for f in p.faces]
    block = np.repeat(owner, [len(p.faces) for p in parts])
    whole = scene.Faces(points, faces, block)
    whose = np.repeat(owner, [len(p.vertices) for p in parts])
    count = int(owner.max()) + 1
    middle = np.stack([np.bincount(whose, x, count) for x in points.T], axis=1) / np.bincount(whose, minlength=count)[:, None]
    shrunk = middle[whose] + SHRUNK * (points - middle[whose])
    first = len(points) + np.cumsum([0, *map(len, contacts)])
    sheets = [np.arange(a, a + len(c)) for a, c in zip(first[:-1].tolist(), contacts, strict=True)]
    both = scene.Faces(
        np.concatenate([shrunk, *contacts]),
        [*faces, *sheets, *(s[::-1] for s in sheets)],
        np.concatenate([block, *[np.where(grounded, count + 1, count)] * 2]),
    )
    stone = np.tile(to_rgb(style.STONE), (count, 1))
    colours = np.vstack([stone, to_rgb(style.HINGE), to_rgb(style.GROUND)])
    with style.figure(10.5, 5.0, columns=2) as (fig, axes):
        for ax, solids, title in (
            (axes[0], whole, f"{count} stones"),
            (axes[1], both, f"{len(contacts)} contacts, {int(grounded.sum())} of them on the ground"),
        ):
            scene.show(ax, scene.picture(solids, view, frame, colours), frame)
            scene.ground(ax, points, view)
            scene.compass(ax, view)
            ax.set_title(title)
        style.write(fig, folder, name)
