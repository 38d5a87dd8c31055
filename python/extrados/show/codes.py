"""Figures of local mechanisms: the capacity curve, and the checks."""

from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection

from extrados.results.codes import LocalMechanism
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.statistics import draw_code_checks
from extrados.show.stones import outlines, window


def draw_local_mechanism(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The mechanism or the governing wall on the plan, a* over d* with the demands of the checks, and demand over capacity of
    each."""
    r = run.results_of(name, LocalMechanism)
    there = run.arrays.get(name, {})
    drawn = []
    if r.walls and "plan_wall" in there:
        drawn = _draw_walls(run, name, r, folder)
    elif "section" in there and len(run.array(name, "section_hinge")):
        drawn = _draw_bodies(run, name, r, folder)
    with style.figure(6.2, 3.6) as (fig, (ax,)):
        ax.plot(run.array(name, "displacement"), run.array(name, "acceleration"), color=style.EDGE, label="capacity at finite rotations")
        if r.zero_displacement_m is not None and r.jurisdiction == "NTC":
            ax.plot(
                [0.0, r.zero_displacement_m],
                [r.activation_acceleration_g, 0.0],
                color=style.HINGE,
                linestyle="--",
                label="straight, to d_0*",
            )
            ax.axvline(r.ultimate_displacement_m, color=style.THRUST, linewidth=1.0, linestyle=":", label="d_SLV = 0.4 d_0*")
        check = r.checks.get("NTC nonlinear")
        if check is not None and check.demand is not None:
            ax.axvline(check.demand, color="#d98200", linewidth=1.2, label="demand S_D(T_SLV)")
        ax.set_xlim(0.0, None)
        ax.set_ylim(0.0, None)
        ax.set_xlabel("displacement d* [m]")
        ax.set_ylabel("acceleration a* [g]")
        ax.set_title("Capacity of the mechanism" if r.mechanism == "building" else f"Capacity: {r.mechanism.replace('-', ' ')}")
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-capacity")
    straight = "; the straight line is assumed by the code" if r.jurisdiction == "NTC" else ""
    caption = f"Capacity curve of the equivalent oscillator, divided by the confidence factor{straight}."
    return [*drawn, (saved, caption), *draw_code_checks(run, name, folder)]


def _draw_bodies(run: Stored, name: str, r: LocalMechanism, folder: Path) -> list[tuple[str, str]]:
    """The bodies that turn, at rest and turned."""
    rest, turned = outlines(run, name, "section"), outlines(run, name, "section_turned")
    level = r.mechanism == "horizontal-bending"
    with style.figure(4.4, 2.6 if level else 4.6) as (fig, (ax,)):
        ax.add_collection(PolyCollection(rest, facecolors="none", edgecolors="#a0a0a0", linewidths=0.8, linestyles="--", zorder=1))
        style.draw_blocks(ax, turned)
        style.draw_hinges(ax, run.array(name, "section_hinge"))
        window(ax, np.vstack([*rest, *turned]))
        ax.set_xlabel("along the wall [m]" if level else "outward [m]")
        ax.set_ylabel("outward [m]" if level else "height [m]")
        ax.set_title(f"Mechanism: {r.mechanism.replace('-', ' ')}")
        saved = style.save(fig, folder, f"{name}-mechanism")
    view = "Plan" if level else "Section"
    return [(saved, f"{view} of the mechanism at rest (dashed) and rotated, with its hinges; alpha_0 = {r.multiplier:.3g}.")]


def _draw_walls(run: Stored, name: str, r: LocalMechanism, folder: Path) -> list[tuple[str, str]]:
    """The plan of the building with the wall that governs."""
    names = [str(wall) for wall in run.array(name, "plan_wall_of")]
    walls = dict(zip(names, outlines(run, name, "plan_wall"), strict=True))
    worst = r.walls[0]
    with style.figure(5.2, 4.6) as (fig, (ax,)):
        style.draw_blocks(ax, list(walls.values()))
        ax.add_collection(PolyCollection([walls[worst.wall]], facecolors=style.HINGE, edgecolors=style.EDGE, linewidths=0.7, zorder=2))
        window(ax, np.vstack(list(walls.values())))
        middle = walls[worst.wall].mean(axis=0)
        ax.annotate(worst.wall, middle, xytext=(8, 8), textcoords="offset points", color=style.HINGE, fontsize=9, zorder=4)
        ax.set_title(f"Governing wall (overturning): {worst.wall}, storey {worst.storey}")
        saved = style.save(fig, folder, f"{name}-mechanism")
    margin = "" if worst.margin is None else f", capacity over demand {worst.margin:.3g}"
    return [(saved, f"Plan: the governing wall rotates out of its plane about the foot of storey {worst.storey}{margin}.")]
