"""Figures of thrust networks: branches in plan, as wide as their thrust, and a section through the supports."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from extrados.results.networks import ThrustNetwork
from extrados.results.store import Stored
from extrados.show import style

WIDEST = 7.0  # of a branch [pt]
FAINT = 1e-4  # of the greatest thrust: branches that carry less are drawn thin
ON_LINE = 1e-3  # of the size: nodes so near the section belong to it
COLOURS = {"least": style.THRUST, "central": "#444444", "greatest": style.HINGE, "horizontal": "#7a5195"}
TITLES = {"least": "least thrust", "central": "most central", "greatest": "greatest thrust", "horizontal": "greatest horizontal load"}


def draw(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Plans of the networks of least thrust, of the most central one, of greatest thrust and of the greatest horizontal load; their
    heights along a section."""
    r = run.results_of(name, ThrustNetwork)
    there = [aim for aim in COLOURS if f"{aim}_density" in run.arrays[name] and (aim != "horizontal" or r.horizontal_load_g)]
    point, branch = run.array(name, "network_point"), run.array(name, "network_branch")
    support = run.array(name, "network_support")
    length = np.linalg.norm(point[branch[:, 0]] - point[branch[:, 1]], axis=1)
    thrust = {aim: run.array(name, f"{aim}_density") * length for aim in there}
    most = max(float(one.max()) for one in thrust.values())
    tall = float(np.clip(np.ptp(point[:, 1]) / np.ptp(point[:, 0]), 0.15, 1.5))
    with style.figure(3.4 * len(there) + 0.4, 3.2 * tall + 1.4, columns=len(there)) as (fig, axes):
        for ax, aim in zip(axes, there, strict=True):
            _plan(ax, point[branch], thrust[aim] / most, COLOURS[aim])
            ax.plot(*point[support].T, "^", color=style.EDGE, markersize=4, zorder=4)
            ax.set_title(f"{TITLES[aim]}\n{_value(r, aim)}")
            ax.set_xlabel("x [m]")
        axes[0].set_ylabel("y [m]")
        caption = f"Plans of the networks. The width of a branch shows its thrust (at most {most / 1000.0:.3g} kN); triangles are supports."
        found = [(style.save(fig, folder, f"{name}-plan"), caption)]
    found.append(_draw_section(run, name, folder, there))
    return found


def _value(r: ThrustNetwork, aim: str) -> str:
    """The value of a network in words."""
    if aim == "central":
        return f"in the middle {100.0 * r.least_part_of_depth:.1f} % of the depth"
    if aim == "horizontal":
        return f"{r.horizontal_load_g:.3g} times the weight"
    return f"{((r.least_thrust_N if aim == 'least' else r.greatest_thrust_N) or 0.0) / 1e3:.4g} kN"


def _plan(ax: Axes, ends: np.ndarray, share: np.ndarray, colour: str) -> None:
    """Branches (m, 2, 2) [m] with widths by their share of the greatest thrust (m)."""
    ax.add_collection(LineCollection(list(ends), colors=style.STONE, linewidths=0.5))
    carries = share > FAINT
    ax.add_collection(
        LineCollection(list(ends[carries]), colors=colour, linewidths=0.4 + WIDEST * share[carries], capstyle="round", zorder=3)
    )
    ax.autoscale_view()
    ax.margins(0.06)
    ax.set_aspect("equal")


def _draw_section(run: Stored, name: str, folder: Path, there: list[str]) -> tuple[str, str]:
    """Heights along the vertical plane through the middle of the plan and the first support."""
    point, support = run.array(name, "network_point"), run.array(name, "network_support")
    middle = point.mean(axis=0)
    arms = point[support] - middle
    way = arms[int(np.linalg.norm(arms, axis=1).argmin())]
    way = way / np.linalg.norm(way)
    across = (point - middle) @ np.array([-way[1], way[0]])
    nearest = across[int(np.abs(across).argmin())]
    on = np.flatnonzero(np.abs(across - nearest) <= ON_LINE * np.ptp(point, axis=0).max())
    along = (point[on] - middle) @ way
    order = on[along.argsort()]
    along = np.sort(along)
    low, high = run.array(name, "network_low")[order], run.array(name, "network_high")[order]
    heights = [run.array(name, f"{aim}_height")[order] for aim in there]
    bottom, top = min(low.min(), np.min(heights)), max(high.max(), np.max(heights))  # reactions end below the blocks
    tall = float(np.clip((top - bottom) / np.ptp(along), 0.25, 1.0))
    with style.figure(7.0, 6.0 * tall + 1.8) as (fig, (ax,)):
        ax.fill_between(along, low, high, color=style.STONE, linewidth=0.0, label="masonry")
        for aim, height in zip(there, heights, strict=True):
            ax.plot(along, height, color=COLOURS[aim], marker=".", markersize=3, label=TITLES[aim])
        ax.set_aspect("equal")
        ax.set_xlabel(f"distance from the middle of the plan, along {np.degrees(np.arctan2(way[1], way[0])):.0f} deg [m]")
        ax.set_ylabel("z [m]")
        ax.set_title("Networks in the vertical section through the middle and one support")
        style.legend_below(fig, ax)
        return style.save(
            fig, folder, f"{name}-section"
        ), "Heights of the networks between intrados and extrados, along one vertical section."
