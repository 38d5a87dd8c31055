"""Figures of a load that crosses: the worst place, the mechanism, what brings it down at every place."""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from extrados.results.limit import DILATANT, MovingLoad
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.limit import section
from extrados.show.stones import outlines

LONG = 0.5  # height over length: below it section and mechanism stand one over the other
MOST_LETTERS = 8  # hinges: letters of more would run into each other
EVEN = "#c98a2b"  # loads


def draw(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The worst place with its thrust line, the mechanism, and the capacity over place."""
    r = run.results_of(name, MovingLoad)
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    place, size = run.array(name, "place"), float(np.ptp(np.concatenate(blocks)[:, 0]))
    road = _road_of(run, name, blocks)
    start, joints = run.array(name, "chain_start"), run.array(name, "chain_joint")
    links = [joints[a:b] for a, b in itertools.pairwise(start)]
    point, envelope = run.array(name, "collapse_point"), run.array(name, "envelope_point")
    tall = (road - min(float(o[:, 1].min()) for o in blocks)) / size + 0.15
    long = tall < LONG
    height = float(np.clip((19.0 if long else 5.6) * tall + 1.5, 3.2, 8.0))
    with style.figure(9.0 if long else 11.5, height, rows=1 + long, columns=2 - long) as (fig, (ax, moved)):
        section.earth(ax, run, name)
        section.stone(ax, blocks)
        for i, link in enumerate(links):
            rows = envelope[:, link]
            ax.add_collection(
                LineCollection(
                    rows[np.isfinite(rows).all(axis=(1, 2))],
                    colors=style.EDGE,
                    linewidths=0.25,
                    alpha=0.5,
                    zorder=2.2,
                    label="thrust lines at all positions of the load" if i == 0 else "_",
                )
            )
        section.thrust_lines(ax, run, name, "collapse", style.THRUST, "thrust line")
        _zones(ax, run, name, links)
        _pushes(ax, run, name, size)
        section.ties(ax, run, name, "collapse")
        section.resting(ax, run, name, blocks)
        _load_marks(ax, run, name, blocks, size)
        hinged = [h.joint for h in r.hinges]
        lettered = len(hinged) <= MOST_LETTERS
        style.draw_hinges(ax, point[hinged], [chr(65 + i) for i in range(len(hinged))] if lettered else None)
        ax.set_title(f"Collapse at the most dangerous position: {_borne(r)}")
        if ax.get_legend_handles_labels()[0]:
            style.legend_below(fig, ax)
        section.earth(moved, run, name)
        section.stone(moved, blocks, ghost=True)
        section.stone(moved, section.carried(blocks, centroid, run.array(name, "mechanism_pose")))
        section.ties(moved, run, name, "collapse", run.array(name, "mechanism_pose"))
        _load_marks(moved, run, name, blocks, size)
        moved.set_title("Mechanism (finite rotations)")
        for drawn in (ax, moved):
            drawn.set_ylim(top=road + (0.15 if len(run.array(name, "axle")) else 0.06) * size)
            style.section_axes(drawn)
        letters = "; ".join(f"{f'{chr(65 + i)} ' if lettered else ''}{h.side} of {h.name}" for i, h in enumerate(r.hinges[:26]))
        found = [
            (
                style.save(fig, folder, f"{name}-worst"),
                f"The most dangerous position of the load: thrust line, hinges and mechanism at collapse. Hinges: {letters or 'none'}.",
            )
        ]
    return found if len(place) == 1 else [*found, _draw_places(run, name, folder)]


def _draw_places(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """The capacity over the place of the first axle."""
    place, way = run.array(name, "place"), run.array(name, "way")
    adequacy, moving = "adequacy" in run.arrays[name], "first axle" if len(run.array(name, "axle")) else "train"
    value = run.array(name, "adequacy") if adequacy else run.array(name, "capacity") / 1e3
    with style.figure(7.5, 3.6) as (fig, (curve,)):
        for sense, colour, label in ((1, style.THRUST, "heading to +x"), (-1, style.HINGE, "heading to -x")):
            if (way == sense).any():
                curve.plot(place[way == sense], value[way == sense], color=colour, marker=".", markersize=3, label=label)
        if (way < 0).any():
            curve.legend()
        if adequacy:
            curve.axhline(1.0, color=style.EDGE, linewidth=0.8, linestyle="--")
        low = float(np.nanmin(value))
        curve.set_ylim(0.0, max(1.1 * low, min(float(np.nanmax(value)) * 1.05, 8.0 * low), 1.1 if adequacy else 0.0))
        curve.set_xlabel(f"x of the {moving} [m]")
        curve.set_ylabel("adequacy factor" if adequacy else "load at collapse [kN]")
        curve.set_title("Adequacy factor over position" if adequacy else "Load at collapse over position")
        return (
            style.save(fig, folder, f"{name}-places"),
            f"Load that causes collapse, plotted over the position of the {moving}."
            + (
                f" At the most dangerous position joints slide, so the collapse load is an {DILATANT}."
                if run.results_of(name, MovingLoad).dilating_joints
                else ""
            ),
        )


def _borne(r: MovingLoad) -> str:
    load = f"{r.collapse_load_N / 1e3:.4g} kN"
    return load if r.adequacy_factor is None else f"{r.adequacy_factor:.3g} x the load ({load})"


def _road_of(run: Stored, name: str, blocks: list[np.ndarray]) -> float:
    """Level of the loads [m]: the top of the surfacing, the fill or the blocks."""
    tops = [run.array(name, what) for what in ("fill_outline", "surfacing_outline") if what in run.arrays[name]]
    return max(float(o[:, 1].max()) for o in [*blocks, *tops])


def _load_marks(ax: Axes, run: Stored, name: str, blocks: list[np.ndarray], size: float) -> None:
    """Axles as arrows and uniform loads as bands, on the road, or on the blocks of a structure without fill."""
    paved = any(what in run.arrays[name] for what in ("fill_outline", "surfacing_outline"))
    road = _road_of(run, name, blocks)
    for x in run.array(name, "axle"):
        y = road if paved else _surface(blocks, float(x), road)
        ax.annotate("", (x, y), (x, y + 0.12 * size), arrowprops={"arrowstyle": "-|>", "color": style.THRUST}, zorder=6)
    for i, (start, stop) in enumerate(run.array(name, "even_load")):
        x = np.linspace(start, stop, 60)
        top = np.full(len(x), road) if paved else np.array([_surface(blocks, float(one), road) for one in x])
        ax.fill_between(x, top, top + 0.03 * size, color=EVEN, alpha=0.7, linewidth=0.0, zorder=4, label="even load" if i == 0 else "_")


def _surface(blocks: list[np.ndarray], x: float, otherwise: float) -> float:
    """Height [m] of the highest stone at x; `otherwise` beside all stones."""
    found = []
    for outline in blocks:
        x0, y0 = outline.T
        x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
        met = (np.minimum(x0, x1) <= x) & (x <= np.maximum(x0, x1)) & (x0 != x1)
        found += (y0[met] + (x - x0[met]) / (x1[met] - x0[met]) * (y1[met] - y0[met])).tolist()
    return max(found, default=otherwise)


def _pushes(ax: Axes, run: Stored, name: str, size: float) -> None:
    """Passive pressures that push back, as arrows as long as they are great."""
    if "push_force" not in run.arrays[name]:
        return
    force, at = run.array(name, "push_force"), run.array(name, "push_point")
    greatest = max(float(np.abs(run.array(name, "push_most")).max()), 1e-300)
    for (x, y), f in zip(at, force, strict=True):
        if abs(f) > 0.01 * greatest:
            ax.annotate(
                "",
                (x, y),
                (x - 0.08 * size * f / greatest, y),
                zorder=5,
                arrowprops={"arrowstyle": "->", "color": style.GROUND, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
            )
    ax.plot([], [], color=style.GROUND, label="passive pressure")


def _zones(ax: Axes, run: Stored, name: str, links: list[np.ndarray]) -> None:
    """Zones of thrust along the chains: the part of each joint that carries the compression at the given strength."""
    if "zone_inner" not in run.arrays[name]:
        return
    inner, outer = run.array(name, "zone_inner"), run.array(name, "zone_outer")
    for i, joints in enumerate(links):
        band = np.concatenate([inner[joints], outer[joints][::-1]])
        ax.fill(*band.T, color=style.THRUST, alpha=0.35, linewidth=0.0, zorder=2.5, label="zone of thrust" if i == 0 else "_")
