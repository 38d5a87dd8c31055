"""Picture of a building before the calculation: plan, walls with their mesh; for a vault the mesh in space."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_hex
from matplotlib.patches import Patch

from extrados.show import scene, style

LINTEL = "#c9b48a"
MOST_BESIDE = 3


@dataclass(frozen=True)
class Elevation:
    """A wall: ends (2) on the plan [m], its thicknesses [m], corners (elements, 4, 2) of its elements along it and up [m], and
    which of them stay elastic; its joints by name, with the ends (stretches, 2, 2) of their stretches [m]."""

    name: str
    start: np.ndarray
    end: np.ndarray
    thickness: list[float]
    corner: np.ndarray
    linear: np.ndarray
    joints: list[tuple[str, np.ndarray]] = field(default_factory=list)


def draw_plan(folder: Path, name: str, walls: list[Elevation], levels: np.ndarray) -> Path:
    """Write folder/NAME.png and .svg."""
    columns = min(MOST_BESIDE, int(np.ceil(np.sqrt(len(walls)))))
    rows = -(-len(walls) // columns)
    with style.canvas(3.0 * (columns + 1.4), max(3.4, 2.6 * rows)) as fig:
        grid = fig.add_gridspec(rows, columns + 1, width_ratios=[1.4, *[1.0] * columns])
        plan = fig.add_subplot(grid[:, 0])
        for wall in walls:
            along = (wall.end - wall.start) / np.linalg.norm(wall.end - wall.start)
            for thick in sorted(wall.thickness, reverse=True):  # the thinner storeys are outlined within the thickest
                side = 0.5 * thick * np.array([-along[1], along[0]])
                outline = [wall.start + side, wall.end + side, wall.end - side, wall.start - side]
                plan.add_collection(PolyCollection([outline], facecolors=style.STONE, edgecolors=style.EDGE, linewidths=0.7))
            plan.annotate(
                "",
                wall.start + 0.62 * (wall.end - wall.start),
                wall.start + 0.5 * (wall.end - wall.start),
                arrowprops={"arrowstyle": "->", "color": style.HINGE, "linewidth": 0.8},
            )
            plan.annotate(
                wall.name,
                0.5 * (wall.start + wall.end),
                xytext=(-8 * along[1], 8 * along[0]),
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=8,
                color=style.HINGE,
            )
        plan.autoscale_view()
        plan.margins(0.15)
        plan.set_aspect("equal")
        plan.set_title("plan; arrows show the direction of each wall, from its start to its end")
        plan.set_xlabel("x [m]")
        plan.set_ylabel("y [m]")
        for k, wall in enumerate(walls):
            ax = fig.add_subplot(grid[k // columns, 1 + k % columns])
            shade = [LINTEL if elastic else style.STONE for elastic in wall.linear]
            ax.add_collection(PolyCollection(list(wall.corner), facecolors=shade, edgecolors="#b3a98f", linewidths=0.3))
            for joint, ends in wall.joints:
                ax.add_collection(LineCollection(list(ends), colors=style.THRUST, linewidths=1.6, zorder=3))
                ax.annotate(
                    f"joint {joint}",
                    ends.reshape(-1, 2).mean(axis=0),
                    xytext=(4, 4),
                    textcoords="offset points",
                    fontsize=7,
                    color=style.THRUST,
                    zorder=4,
                )
            for height in levels:
                ax.axhline(height, color=style.HINGE, linewidth=0.6, linestyle=":")
            ax.autoscale_view()
            ax.set_aspect("equal")
            ax.grid(False)
            given = " and ".join(f"{t:g}" for t in wall.thickness)
            ax.set_title(f"wall {wall.name}, {given} m, {len(wall.corner)} elements")
            ax.set_xlabel("along it [m]")
        style.write(fig, folder, name)
    return folder / f"{name}.png"


def draw_shells(folder: Path, name: str, parts: list[tuple[str, np.ndarray, np.ndarray]], feet: np.ndarray) -> Path:
    """Write folder/NAME.png and .svg: the mesh of a vault seen from a corner and from above, coloured by its thickness.

    parts: name, corners (elements, corners, 3) [m] and thickness (elements) [m] of each; feet: nodes (n, 3) that are held [m].
    """
    thick = np.unique(np.concatenate([np.unique(np.round(t, 9)) for _, _, t in parts]))
    shades = _shades(len(thick))
    with style.canvas(9.4, 4.6) as fig:
        for ax, view, title in zip(
            fig.subplots(1, 2), (scene.View(-60.0, 28.0), scene.View(-90.0, 90.0)), ("from a corner", "from above"), strict=True
        ):
            axes = view.axes
            shapes, depth, colors = [], [], []
            for _, corner, thickness in parts:
                place = corner @ axes.T
                shapes += list(place[..., :2])
                depth += place[..., 2].mean(axis=1).tolist()
                colors += [shades[int(np.abs(thick - t).argmin())] for t in thickness]
            order = np.argsort(depth, kind="stable")
            ax.add_collection(
                PolyCollection([shapes[k] for k in order], facecolors=[colors[k] for k in order], edgecolors="#b3a98f", linewidths=0.3)
            )
            held = feet @ axes.T
            ax.plot(*held[:, :2].T, "^", color=style.HINGE, markersize=4, linestyle="none", zorder=3.0 if view.elevation == 90.0 else 0.5)
            ax.autoscale_view()
            ax.margins(0.05)
            ax.set_aspect("equal")
            ax.grid(False)
            ax.set_title(title)
            ax.set_xlabel("x [m]" if view.elevation == 90.0 else "across the view [m]")
            ax.set_ylabel("y [m]" if view.elevation == 90.0 else "up the view [m]")
        fig.legend(
            [Patch(facecolor=shade, edgecolor="#b3a98f") for shade in shades],
            [f"{1e3 * t:.4g} mm thick" for t in thick],
            loc="outside lower center",
            ncols=min(6, len(thick)),
            title=f"{sum(len(c) for _, c, _ in parts)} elements; triangles mark supported nodes",
        )
        style.write(fig, folder, name)
    return folder / f"{name}.png"


def _shades(count: int) -> list[str]:
    """Colours of stone, from light to dark."""
    scale = LinearSegmentedColormap.from_list("thickness", [style.STONE, LINTEL, "#7a6844"])
    return [to_hex(scale(k / max(count - 1, 1))) for k in range(count)]
