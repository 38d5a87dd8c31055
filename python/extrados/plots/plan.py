"""The picture of a building before it is computed: its plan, and its walls with their mesh."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection

from extrados.plots import style

LINTEL = "#c9b48a"
MOST_BESIDE = 3


@dataclass(frozen=True)
class Elevation:
    """A wall: ends (2) on the plan [m], thickness [m], corners (elements, 4, 2) of its elements along it and up [m], and
    which of them stay elastic."""

    name: str
    start: np.ndarray
    end: np.ndarray
    thickness: float
    corner: np.ndarray
    linear: np.ndarray


def draw_plan(folder: Path, name: str, walls: list[Elevation], levels: np.ndarray) -> Path:
    """Write folder/NAME.png and .svg."""
    columns = min(MOST_BESIDE, int(np.ceil(np.sqrt(len(walls)))))
    rows = -(-len(walls) // columns)
    with style.canvas(3.0 * (columns + 1.4), max(3.4, 2.6 * rows)) as fig:
        grid = fig.add_gridspec(rows, columns + 1, width_ratios=[1.4, *[1.0] * columns])
        plan = fig.add_subplot(grid[:, 0])
        for wall in walls:
            along = (wall.end - wall.start) / np.linalg.norm(wall.end - wall.start)
            side = 0.5 * wall.thickness * np.array([-along[1], along[0]])
            outline = [wall.start + side, wall.end + side, wall.end - side, wall.start - side]
            plan.add_collection(
                PolyCollection([outline], facecolors=style.STONE, edgecolors=style.EDGE, linewidths=0.7)
            )
            plan.annotate(
                "", wall.start + 0.62 * (wall.end - wall.start), wall.start + 0.5 * (wall.end - wall.start),
                arrowprops={"arrowstyle": "->", "color": style.HINGE, "linewidth": 0.8},
            )  # fmt: skip
            plan.annotate(
                wall.name, 0.5 * (wall.start + wall.end), xytext=8 * np.array([-along[1], along[0]]),
                textcoords="offset points", ha="center", va="center", fontsize=8, color=style.HINGE,
            )  # fmt: skip
        plan.autoscale_view()
        plan.margins(0.15)
        plan.set_aspect("equal")
        plan.set_title("plan, walls from their starts")
        plan.set_xlabel("x [m]")
        plan.set_ylabel("y [m]")
        for k, wall in enumerate(walls):
            ax = fig.add_subplot(grid[k // columns, 1 + k % columns])
            shade = [LINTEL if elastic else style.STONE for elastic in wall.linear]
            ax.add_collection(PolyCollection(wall.corner, facecolors=shade, edgecolors="#b3a98f", linewidths=0.3))
            for height in levels:
                ax.axhline(height, color=style.HINGE, linewidth=0.6, linestyle=":")
            ax.autoscale_view()
            ax.set_aspect("equal")
            ax.grid(False)
            ax.set_title(f"wall {wall.name}, {wall.thickness:g} m, {len(wall.corner)} elements")
            ax.set_xlabel("along it [m]")
        style.write(fig, folder, name)
    return folder / f"{name}.png"
