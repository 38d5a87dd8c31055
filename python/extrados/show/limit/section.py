"""Sections of stones as figures show them: outlines, supports, fill, loads, ties, thrust lines, force polygons, hinges."""

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from extrados.results.limit import Hinge
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.stones import moved

MOST_LETTERED = 26  # hinges: more are dots
MOST_FLOW = 3.0  # points: width of the greatest force between stones
HATCH = "#cfc6b2"
FILL, PAVED = "#f3ead6", "#b9b4aa"
TIE, LOAD = "#2b5d8a", "#333333"
MOST_ARROWS = 9  # of a load that is spread
MOST_TIES_TOLD = 12  # ties whose forces are written beside them
CHAIN_COLOURS = (style.THRUST, style.HINGE, style.GROUND, "#8a5a00", "#6a3d8f", "#444444")


def paths(run: Stored, name: str, what: str) -> dict[str, np.ndarray]:
    """Packed paths by their names; points of one path together."""
    points, start, names = (run.array(name, what + end) for end in ("", "_start", "_of"))
    return {str(n): points[a:b] for n, a, b in zip(names, start[:-1], start[1:], strict=True)}


def carried(blocks: list[np.ndarray], centroid: np.ndarray, pose: np.ndarray) -> list[np.ndarray]:
    """Outlines carried to poses x, y, rotation of their centroids."""
    return [moved(*one) for one in zip(blocks, centroid, pose, strict=True)]


def stone(ax: Axes, blocks: list[np.ndarray], *, ghost: bool = False) -> None:
    """Blocks as hatched stone, or as dotted outlines where only their former place is meant."""
    if ghost:
        ax.add_collection(PolyCollection(blocks, facecolors="none", edgecolors=style.EDGE, linewidths=0.4, linestyles=":"))
    else:
        ax.add_collection(PolyCollection(blocks, facecolors=style.STONE, edgecolors=HATCH, hatch="////", linewidths=0.0, zorder=1))
        width = 0.6 if len(blocks) < 200 else 0.25
        ax.add_collection(PolyCollection(blocks, facecolors="none", edgecolors=style.EDGE, linewidths=width, zorder=1.5))
    ax.autoscale_view()


def ground(ax: Axes, run: Stored, name: str, joints: list[int]) -> None:
    """The supports: a stroke under each joint on the ground."""
    p, q = run.array(name, "joint_p"), run.array(name, "joint_q")
    for j in joints:
        ax.plot(*np.array([p[j], q[j]]).T, color=style.EDGE, linewidth=2.2, solid_capstyle="butt", zorder=2)


def standing(run: Stored, name: str) -> list[int]:
    """The joints on the ground."""
    return [reaction.joint for reaction in run[name]["reactions"]]


def earth(ax: Axes, run: Stored, name: str) -> None:
    """Fill and surfacing over the blocks, if any."""
    for what, colour in (("fill_outline", FILL), ("surfacing_outline", PAVED)):
        if what in run.arrays[name]:
            ax.fill(*run.array(name, what).T, facecolor=colour, edgecolor=style.EDGE, linewidth=0.4, zorder=0.5)


def resting(ax: Axes, run: Stored, name: str, blocks: list[np.ndarray]) -> None:
    """Loads at rest as arrows, as long as they are great, each with its force; of a load that is spread evenly a few, each for its
    share, under a line. Nothing without loads."""
    if "load_point" not in run.arrays[name]:
        return
    points, forces, number = (run.array(name, f"load_{what}") for what in ("point", "force", "number"))
    drawn = []
    for k in np.unique(number):
        here = np.flatnonzero(number == k)
        few = here[np.linspace(0, len(here) - 1, min(len(here), MOST_ARROWS)).round().astype(int)]
        drawn.append((points[few], forces[here].sum(axis=0)))
    greatest = max(float(np.hypot(*whole)) / len(heads) for heads, whole in drawn)
    length = 0.1 * float(np.ptp(np.concatenate(blocks), axis=0).max()) / greatest
    for heads, whole in drawn:
        tails = heads - length * whole / len(heads)
        for head, tail in zip(heads, tails, strict=True):
            ax.annotate(
                "", head, tail, zorder=6, arrowprops={"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
            )
        ax.plot(*tails.T, color=LOAD, linewidth=0.8, zorder=6)
        ax.update_datalim(tails)
        style.letters(ax, tails[[len(tails) // 2]], [f"{np.hypot(*whole) / 1e3:.3g} kN"], LOAD)
    ax.plot([], [], color=LOAD, marker=">", markersize=4, label="load at rest")


def ties(ax: Axes, run: Stored, name: str, state: str, pose: np.ndarray | None = None) -> None:
    """Ties, struts and springs with their forces in a state, dashed if slack.

    pose (blocks, 3): displaced blocks; the ties follow them, without forces.
    """
    forces = f"{state}_tie_force"
    if forces not in run.arrays[name]:
        return
    ends, force = run.array(name, "tie_point"), run.array(name, forces)
    if pose is not None:
        ends = np.stack([_moved(run, name, ends[:, k], run.array(name, "tie_block")[:, k], pose) for k in (0, 1)], axis=1)
    taut = np.abs(force) > 1e-6 * max(float(np.abs(force).max(initial=0.0)), 1e-300)
    for k, (one, two) in enumerate(ends):
        ax.plot(
            *np.array([one, two]).T,
            "-o" if taut[k] else "--o",
            color=TIE,
            linewidth=1.3,
            markersize=3,
            zorder=4,
            label="tie" if k == 0 else "_",
        )
    if pose is not None:
        return
    shown = ends[:MOST_TIES_TOLD].mean(axis=1)
    style.letters(ax, shown, [_pull(f) if t else "slack" for f, t in zip(force, taut, strict=True)], TIE)


def _moved(run: Stored, name: str, points: np.ndarray, block: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Points of blocks, -1 the ground, where these have gone."""
    arm = points - run.array(name, "centroid")[block]
    x, y, turn = pose[block].T
    cos, sin = np.cos(turn), np.sin(turn)
    gone = np.column_stack([x + cos * arm[:, 0] - sin * arm[:, 1], y + sin * arm[:, 0] + cos * arm[:, 1]])
    return np.where((block < 0)[:, None], points, gone)


def _pull(force: float) -> str:
    """A force in a tie as drawings tell it."""
    return f"{force / 1e3:.3g} kN" if force > 0.0 else f"{-force / 1e3:.3g} kN compression"


def dimension(ax: Axes, one: tuple[float, float], two: tuple[float, float], text: str) -> None:
    """A dimension line with arrows at both ends and its length beside it."""
    ax.annotate("", one, two, arrowprops={"arrowstyle": "<->", "linewidth": 0.7, "color": style.EDGE, "shrinkA": 0, "shrinkB": 0})
    upright = abs(one[0] - two[0]) < abs(one[1] - two[1])
    ax.annotate(
        text,
        (0.5 * (one[0] + two[0]), 0.5 * (one[1] + two[1])),
        textcoords="offset points",
        xytext=(-5, 0) if upright else (0, 3),
        ha="right" if upright else "center",
        va="center" if upright else "bottom",
        fontsize=7,
        color=style.EDGE,
        rotation=90 if upright else 0,
    )


def beside(run: Stored, name: str, ax: Axes) -> np.ndarray:
    """Points (k, 2) [m] that the drawing needs room for besides the blocks: what it has, and the ends of the ties."""
    ends = run.array(name, "tie_point").reshape(-1, 2) if "tie_point" in run.arrays[name] else np.empty((0, 2))
    return np.concatenate([ends, ax.dataLim.get_points()])


def overall_dimensions(ax: Axes, blocks: list[np.ndarray], others: np.ndarray) -> None:
    """Width below and height beside a section; the drawing has room for other points (k, 2)."""
    points = np.concatenate(blocks)
    (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
    away = 0.07 * max(right - left, high - low)
    dimension(ax, (left, low - away), (right, low - away), f"{right - left:.2f} m")
    dimension(ax, (left - away, low), (left - away, high), f"{high - low:.2f} m")
    (most_left, lowest), (most_right, highest) = (getattr(np.concatenate([points, others]), end)(axis=0) for end in ("min", "max"))
    ax.set_xlim(min(left - 2.6 * away, most_left - away), max(right, most_right) + 1.2 * away)
    ax.set_ylim(min(low - 2.0 * away, lowest - away), max(high, highest) + 1.2 * away)


def thrust_lines(ax: Axes, run: Stored, name: str, state: str, colour: str, label: str) -> None:
    """The thrust line of a state through every block. In arches and stacks it has one width, divided among branches within a
    block in proportion to their forces; elsewhere its width shows the zone in compression."""
    points, start = run.array(name, f"{state}_line"), run.array(name, f"{state}_line_start")
    lines = [points[a:b] for a, b in itertools.pairwise(start)]
    force = run.array(name, f"{state}_line_force")
    chained = f"{state}_polygon_of" if f"{state}_polygon_of" in run.arrays[name] else "chain_joint"
    if len(run.array(name, chained)):
        _, stone_of = np.unique(run.array(name, f"{state}_line_of").astype(str), return_inverse=True)
        greatest = np.zeros(len(lines))
        np.maximum.at(greatest, stone_of, force)
        shown, width = np.arange(len(lines)), 1.2 * np.maximum(force / np.maximum(greatest[stone_of], 1e-300), 0.2)
    else:
        width = MOST_FLOW * force / max(float(force.max(initial=0.0)), 1e-300)
        shown = np.flatnonzero(width > 0.01 * MOST_FLOW)
    ax.add_collection(
        LineCollection([lines[k] for k in shown], linewidths=width[shown], colors=colour, capstyle="round", zorder=3, label=label)
    )


def funiculars(ax: Axes, run: Stored, name: str, state: str) -> None:
    """Funicular polygons of the arches, dashed."""
    for k, line in enumerate(paths(run, name, f"{state}_funicular").values()):
        label = "funicular" if k == 0 else "_"
        ax.plot(*line.T, color=style.EDGE, linewidth=0.6, linestyle="--", label=label, zorder=2.8)


def polygon(ax: Axes, polygons: dict[str, np.ndarray], colours: tuple[str, ...] = CHAIN_COLOURS) -> None:
    """Force polygons, one colour each: rays from the common pole and load lines."""
    for i, (name, rays) in enumerate(polygons.items()):
        colour = colours[i % len(colours)]
        tips = rays / 1e3
        shown = [[(0.0, 0.0), tip] for tip in tips[:: max(1, len(tips) // 40)]]
        ax.add_collection(LineCollection(shown, linewidths=0.4, colors=colour, alpha=0.7, capstyle="projecting"))
        ax.plot(*tips.T, color=colour, linewidth=1.5, marker=".", markersize=2.5, label=name)
    ax.plot(0.0, 0.0, "o", color="black", markersize=3)
    ax.annotate("pole", (0.0, 0.0), textcoords="offset points", xytext=(-4, -9), ha="right", fontsize=7)
    ax.set_aspect("equal", adjustable="datalim")
    ax.xaxis.set_major_locator(style.InnerLocator())
    ax.set_xlabel("horizontal [kN/m]")
    ax.set_ylabel("vertical [kN/m]")
    ax.legend(loc="best")


def hinge_marks(ax: Axes, hinges: list[Hinge]) -> None:
    """Hinges as circles with letters."""
    points = np.array([[h.x_m, h.y_m] for h in hinges]).reshape(-1, 2)
    if len(points) > MOST_LETTERED:
        ax.plot(*points.T, ".", color=style.HINGE, markersize=2.0, zorder=5)
        return
    style.draw_hinges(ax, points, [chr(65 + i) for i in range(len(points))])
