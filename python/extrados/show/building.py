"""The drawing of the building with the dimensions that an engineer uses."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from extrados.results.store import Stored
from extrados.show import style
from extrados.show.limit.section import stone
from extrados.show.stones import outlines

NAME = "building"
#: Colour of dimensions
INK = "#1f4e79"
#: Of the extent of the drawing: how far a dimension stands from what it measures
OFF = 0.07


def draw_building(run: Stored, folder: Path) -> tuple[str, str] | None:
    """The stones with spans, rises, widths and height, or the plan of a building with the lengths of its walls; None where no
    analysis of the run looked at either."""
    structure = run.summary["deck"]["resolved"].get("structure") or {}
    if structure.get("kind") == "building":
        return _plan(structure, folder)
    name = next((n for n, there in run.arrays.items() if {"outline", "outline_start"} <= set(there)), None)
    rows = [d for d in run.summary["deck"].get("dimensions", []) if "start" in d]
    if name is None or not rows:
        return None
    blocks = outlines(run, name)
    points = np.concatenate(blocks)
    extent = np.ptp(points, axis=0)
    shape = float(extent[1] / max(extent[0], 1e-9))
    width = float(np.clip(5.5 / max(shape, 0.35), 3.4, 7.2))
    with style.figure(width, float(np.clip(width * shape + 1.2, 2.8, 6.5))) as (fig, (ax,)):
        stone(ax, blocks)
        ax.update_datalim(points)
        ax.autoscale_view()
        off = OFF * float(extent.max())
        taken: list[tuple[float, float]] = []  # widths below that are drawn: those that do not meet share a line
        for row in rows:
            ends = sorted((row["start"][0], row["end"][0]))
            level = 1 + sum(a < ends[1] and ends[0] < b for a, b in taken) if row["aside"] == "below" else 1
            if row["aside"] == "below":
                taken.append((ends[0], ends[1]))
            _dimension(ax, row, off, level)
        ax.set_aspect("equal")
        reach = 2.4 * off  # room for dimensions at the sides of what is slender
        low, high = points.min(axis=0), points.max(axis=0)
        ax.set_xlim(low[0] - reach, high[0] + reach)
        ax.set_ylim(low[1] - reach - off * max(0, len(taken) - 1), high[1] + 0.7 * reach)
        ax.grid(False)
        ax.set_xlabel("x [m]")
        ax.set_ylabel("y [m]")
        ax.set_title(f"{len(blocks)} stone{'s' if len(blocks) != 1 else ''}")
        if extent[0] < 0.5 * extent[1]:
            ax.locator_params(axis="x", nbins=3)
        saved = style.save(fig, folder, NAME)
    told = "; ".join(f"{d['name']} {d['length_m']:.4g} m" for d in rows)
    return saved, f"The building. {told[:1].upper()}{told[1:]}."


def _plan(structure: dict[str, Any], folder: Path) -> tuple[str, str]:
    """The walls of a building on its plan, with names, lengths and thicknesses; the heights of its storeys in the caption."""
    ends = np.array([[wall["start"], wall["end"]] for wall in structure["walls"]], dtype=float)
    low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
    span = np.maximum(high - low, 1.0)
    width = 6.0
    with style.figure(width, float(np.clip(width * span[1] / span[0], 2.4, 6.5))) as (fig, (ax,)):
        middle = 0.5 * (low + high)
        for wall, (start, end) in zip(structure["walls"], ends, strict=True):
            thick = wall.get("thickness") or max(wall["thicknesses"])
            along = (end - start) / np.linalg.norm(end - start)
            across = np.array([-along[1], along[0]])
            half = 0.5 * thick * across
            ax.add_patch(
                Polygon(
                    [start + half, end + half, end - half, start - half], facecolor=style.STONE, edgecolor=style.EDGE
                )
            )
            out = across if across @ (0.5 * (start + end) - middle) >= 0.0 else -across
            place = 0.5 * (start + end) + out * (0.5 * thick + OFF * span.max())
            turn = np.degrees(np.arctan2(along[1], along[0]))
            ax.text(
                *place, f"{wall['name']}: {np.linalg.norm(end - start):.4g} m, {1e2 * thick:.3g} cm", color=INK, ha="center", va="center",
                rotation=90.0 - (90.0 - turn) % 180.0, fontsize=8,
            )  # fmt: skip
        reach = 2.0 * OFF * span.max()
        ax.set_aspect("equal")
        ax.set_xlim(low[0] - reach, high[0] + reach)
        ax.set_ylim(low[1] - reach, high[1] + reach)
        ax.grid(False)
        ax.set_xlabel("x [m]")
        ax.set_ylabel("y [m]")
        ax.set_title("Plan")
        saved = style.save(fig, folder, NAME)
    *first, last = [f"{h:.4g}" for h in structure["storeys"]]
    storeys = f"Storeys, from the ground up: {', '.join(first)} and {last} m" if first else f"Storey: {last} m"
    told = "length of each wall on its middle plane, and its greatest thickness"
    return saved, f"Plan of the building: {told}. {storeys}."


def _dimension(ax: Axes, row: dict[str, Any], off: float, below: int) -> None:
    """A line with ticks at its ends and its length beside it."""
    start, end = np.array(row["start"]), np.array(row["end"])
    shift = {"below": (0.0, -off * below), "left": (-off, 0.0), "right": (0.0, 0.0)}.get(row["aside"], (0.0, 0.0))
    a, b = start + shift, end + shift
    ax.plot(
        *np.array([a, b]).T,
        color=INK,
        linewidth=0.8,
        marker="|" if abs(b[0] - a[0]) > abs(b[1] - a[1]) else "_",
        markersize=7,
        zorder=6,
    )
    for here, there in ((start, a), (end, b)):
        if np.hypot(*(there - here)) > 0.0:
            ax.plot(*np.array([here, there]).T, color=INK, linewidth=0.4, linestyle=":", zorder=6)
    middle = 0.5 * (a + b)
    upright = abs(b[1] - a[1]) > abs(b[0] - a[0])
    aside = "left" if row["aside"] in ("right",) or (upright and row["aside"] != "left") else "center"
    text = f"{row['length_m']:.4g}"
    if upright and row["aside"] == "left":
        ax.annotate(
            text,
            middle,
            textcoords="offset points",
            xytext=(-4, 0),
            ha="right",
            va="center",
            fontsize=8,
            color=INK,
            rotation=90,
        )
    elif upright or aside == "left":
        ax.annotate(text, b if row["aside"] == "right" else middle, textcoords="offset points", xytext=(5, 3 if row["aside"] == "right" else 0),
                    ha="left", va="bottom" if row["aside"] == "right" else "center", fontsize=8, color=INK, zorder=8)  # fmt: skip
    else:
        at = a + 0.25 * (b - a) if row["aside"] == "along" else middle
        ax.annotate(
            text,
            at,
            textcoords="offset points",
            xytext=(0, 3),
            ha="center",
            va="bottom",
            fontsize=8,
            color=INK,
            zorder=8,
        )
