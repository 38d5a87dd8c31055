"""Figures of many sections: a key that varies, a survey, random surveys of one."""

from pathlib import Path

import numpy as np

from extrados.results.store import Stored
from extrados.results.sweeps import Imperfections, Sweep
from extrados.show import solids, style
from extrados.show.limit import section

MOST_NAMED = 8  # mechanisms in a legend


def draw_sweep(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Capacity curve with numbered mechanisms, and one section of each mechanism."""
    r = run.results_of(name, Sweep)
    value, gamma, number = run.array(name, "value"), run.array(name, "gamma"), run.array(name, "mechanism")
    tilt = np.degrees(np.arctan(gamma))
    with style.figure(7.5, 4.2) as (fig, (ax,)):
        ax.plot(value, tilt, "-", color=style.EDGE, linewidth=1.0, zorder=2)
        seen = [k for k in range(1, int(number.max()) + 1) if (number == k).any()]
        for k in seen:
            here = number == k
            colour = section.CHAIN_COLOURS[(k - 1) % len(section.CHAIN_COLOURS)]
            label = f"mechanism {k}" if k in seen[:MOST_NAMED] else None
            ax.plot(value[here], tilt[here], "o", markersize=3.5, color=colour, label=label, zorder=3)
        if "fractured" in run.arrays[name]:
            cracked = np.degrees(np.arctan(run.array(name, "fractured")))
            ax.plot(value, cracked, "--", color=style.HINGE, linewidth=1.0, label="buttress cracked")
        if "buttress_alone" in run.arrays[name]:
            alone = np.degrees(np.arctan(run.array(name, "buttress_alone")))
            ax.plot(value, alone, "-.", color=style.GROUND, linewidth=1.0, label="buttress alone")
        crowded = 0.04 * (value[-1] - value[0])
        shown = -np.inf
        for change in r.changes:
            ax.axvline(change.value, color=style.EDGE, linestyle=":", linewidth=0.7)
            if change.value - shown < crowded:
                continue
            shown = change.value
            ax.annotate(
                "|".join({0: "falls", "unknown": "?"}.get(side, str(side)) for side in (change.before, change.after)),
                (change.value, 1.0),
                xycoords=("data", "axes fraction"),
                ha="center",
                va="bottom",
                fontsize=7,
            )
        ax.plot(
            r.optimum_value, r.optimum_tilt_angle_deg, "*", color="black", markersize=9, zorder=4, label=f"greatest: {r.optimum_value:.4g}"
        )
        for gap in r.gaps:
            ax.plot(gap.value, 0.0, "x" if gap.status == "cannot-stand" else ".", color=style.THRUST, markersize=4)
        if r.upper_bound_values:
            bounded = np.isin(value, r.upper_bound_values)
            ax.plot(
                value[bounded],
                tilt[bounded],
                "v",
                markersize=6,
                fillstyle="none",
                color=style.HINGE,
                zorder=4,
                label="upper bound (dilatant friction)",
            )
        ax.set_ylim(bottom=0.0)
        ax.set_xlabel(f"{spoken(r.vary)} [{r.unit}]" if r.unit else spoken(r.vary))
        ax.set_ylabel("tilt at collapse [deg]")
        ax.legend(loc="best")
        found = [
            (
                style.save(fig, folder, f"{name}-curve"),
                (
                    "Tilt at collapse. Dotted: values at which another mechanism begins (?: no result). Crosses: the structure "
                    "collapses under self-weight. Points on the axis: no result, or no collapse at any tilt."
                ),
            )
        ]
    if "example" not in run.arrays[name]:  # solids
        return found + solids.draw_examples(run, name, folder, {m.number: m.hinges for m in r.mechanisms})
    if len(run.array(name, "example")):
        examples, moved = (list(section.paths(run, name, what).values()) for what in ("example", "example_moved"))
        of = run.array(name, "example_mechanism")
        numbers = np.unique(of)[:6]
        with style.figure(3.4 * len(numbers), 3.8, columns=len(numbers)) as (fig, axes):
            for ax, k in zip(axes, numbers, strict=True):
                section.stone(ax, [examples[i] for i in np.flatnonzero(of == k)], ghost=True)
                section.stone(ax, [moved[i] for i in np.flatnonzero(of == k)])
                ax.set_title(f"Mechanism {k}")
                style.section_axes(ax)
            found.append((style.save(fig, folder, f"{name}-mechanisms"), "; ".join(f"{m.number}: {m.hinges}" for m in r.mechanisms[:6])))
    return found


def spoken(key: str) -> str:
    """A key of a deck as an axis calls it: "ties.0.yield_force" is the yield force of tie 1."""
    *way, last = key.replace("_", " ").split(".")
    of = ""
    for part in way:
        if part.isdigit():
            of = f"{of.removesuffix('s')} {int(part) + 1}"
        elif part in ("left", "right"):
            last = f"{part} {last}"
        elif part != "structure":
            of += f" {'of' if not of else 'in'} {'the ' if part in ('joints', 'material') else ''}{part}"
    return last + of


def draw_survey(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Capacities of all sections in order."""
    gamma = run.array(name, "gamma")
    names = run.array(name, "section_name")
    order = np.argsort(gamma)
    order = order[np.isfinite(gamma[order])]
    if not len(order):
        return []
    few = len(order) <= 40
    with style.figure(7.5, max(3.0, 0.22 * len(order) + 1.0) if few else 4.0) as (fig, (ax,)):
        if few:
            ax.barh(np.arange(len(order)), gamma[order], color=style.STONE, edgecolor=style.EDGE)
            ax.set_yticks(np.arange(len(order)), [str(names[i]) for i in order])
            ax.set_xlabel("collapse acceleration [g]")
        else:
            ax.plot(gamma[order], (np.arange(len(order)) + 1.0) / len(order), color=style.THRUST)
            ax.set_xlabel("collapse acceleration [g]")
            ax.set_ylabel("share of sections with a collapse\nacceleration of at most this value")
        return [(style.save(fig, folder, name), "Collapse acceleration of the sections that carry their self-weight.")]


def draw_imperfections(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Capacities of the random surveys: distribution, band, and the value of the given survey."""
    r = run.results_of(name, Imperfections)
    gamma = run.array(name, "gamma")
    lesser = np.sort(np.nan_to_num(gamma.min(axis=1), nan=0.0))
    with style.figure(7.5, 3.8) as (fig, (ax,)):
        share = np.arange(1, len(lesser) + 1) / len(lesser)
        ax.axvspan(
            r.low_collapse_acceleration_g,
            r.high_collapse_acceleration_g,
            color=style.STONE,
            zorder=0,
            label=f"90 % of the random geometries: {r.low_collapse_acceleration_g:.4f} to {r.high_collapse_acceleration_g:.4f} g",
        )
        ax.step(
            lesser,
            share,
            where="post",
            color=style.THRUST,
            label=f"{r.count} random geometries, corners displaced by up to {1e3 * r.deviation_m:.3g} mm",
        )
        given = r.given_collapse_acceleration_g
        ax.axvline(given, color=style.HINGE, linestyle="--", label=f"geometry of the deck: {given:.4f} g")
        ways = "along the direction and opposite" if "solid_vertex" in run.arrays[name] else "to +x and to -x"
        ax.set_xlabel(f"lower of the two collapse accelerations ({ways}) [g]")
        ax.set_ylabel("share of the random geometries")
        ax.set_ylim(0.0, 1.0)
        ax.set_title("Capacity within the deviation of the survey")
        style.legend_below(fig, ax)
        return [
            (
                style.save(fig, folder, name),
                (
                    "Share of the random geometries whose capacity is at most the value on the axis. All have the "
                    "same blocks; their corners and joints are displaced within the deviation of the survey."
                ),
            )
        ]
