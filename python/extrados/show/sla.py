"""Figures of sequentially linear analysis: curve, cracks, stresses, ranges of the load, energies."""

from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from extrados.results.model import Array
from extrados.results.sla import DROP, PREFIXES, Sla, SlaCurve
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.cracked import CORNERS, CRACKS, at_points, polygons, scale
from extrados.show.sla_film import film_sla
from extrados.show.verification import draw_verification

LOST, ENVELOPE = "#d9822b", "#1f4e79"
#: Panels that stand beside each other at most; one more does before the next row begins
MOST_BESIDE = 3
STAGES = ("#7b93ab", "#b3342d", "#1f4e79", "#d9822b", "#3a7d44", "#7b2d8b")
#: What the names of the figures of each sense of the load have in them
SENSES = dict(zip(PREFIXES, ("", "-minus"), strict=True))
OPPOSITE = dict(zip(PREFIXES, ("", ", for the load in the opposite direction"), strict=True))
MOST_NAMED = 12  # bars that a legend still names
NOTHING = 1e-3  # of the greatest stress: less is drawn as none
#: A curve is drawn as far as so many times the way to nearly its greatest load
MOST_PLATEAU = 20.0
#: Part of the wall by which a state has moved that came apart
APART = 0.05


def _wall(ax: Axes, polygons: list[np.ndarray], **options: Any) -> PolyCollection:
    style_of = {"facecolors": style.STONE, "edgecolors": "#cfc6b4", "linewidths": 0.25, **options}
    drawn = PolyCollection(polygons, **style_of)
    ax.add_collection(drawn)
    ax.autoscale_view()
    return drawn


def _outline(run: Stored, name: str) -> np.ndarray:
    """Edges (edges, 2) of the outline and of openings, by nodes: those of one element alone."""
    sides = []
    for array in run.series(name, "elements"):
        corners = array.numbers[:, : CORNERS[array.numbers.shape[1]]]
        sides += [np.stack([corners[:, k], np.roll(corners, -1, axis=1)[:, k]], axis=1) for k in range(corners.shape[1])]
    edges, count = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_counts=True)
    return edges[count == 1]


def draw_sla(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """All figures of one analysis."""
    figures = [*draw_verification(run, name, folder), _curve(run, name, folder)]
    film_sla(run, name, folder)
    for prefix in PREFIXES:
        if f"{prefix}state_event" in run.arrays[name]:
            figures += [_cracks(run, name, folder, prefix), _stresses(run, name, folder, prefix)]
    sections = zip(*(run.series(name, f"section_{what}") for what in ("y", "lo", "hi")), strict=True)
    figures += [_section(run, name, folder, i, *arrays) for i, arrays in enumerate(sections)]
    if run.results_of(name, Sla).bars:
        figures += [_bars(run, name, folder, prefix) for prefix in PREFIXES if _has_bars(run, name, prefix)]
    figures.append(_energy(run, name, folder))
    if run.results_of(name, Sla).stages:
        figures += [_all_stages(run, name, folder), *_cracks_by_stage(run, name, folder)]
    return figures


def _all_stages(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Loads against displacements of all stages; those in one direction, or its opposite, share a panel."""
    stages = run.results_of(name, Sla).stages
    panels = _panels_of_stages(run, name)
    columns = min(len(panels), 2)
    rows = -(-len(panels) // columns)
    with style.figure(4.8 * columns + 0.4, 3.8 * rows, rows=rows, columns=columns) as (fig, axes):
        for ax in axes[len(panels) :]:
            ax.set_axis_off()
        for ax, panel in zip(axes, panels, strict=False):
            for k, sense in panel:
                stage = stages[k]
                get = partial(_array_of, run, name, stage.prefix)
                fine = get("event_state") > 0
                d = sense * 1e3 * np.append(stage.displacement_of_constant_loads_m, get("event_displacement")[fine])
                p = sense * 1e-3 * np.append(stage.start_load_N, get("event_load")[fine])
                color = STAGES[k % len(STAGES)]
                ax.plot(d, p, color=color, linewidth=0.25, alpha=0.45)
                low, high = get("envelope_displacement"), get("envelope_load")
                ax.plot(1e3 * sense * low, 1e-3 * sense * high, color=color, linewidth=1.4, label=stage.name)
                ax.plot(d[:1], p[:1], "o", color=color, markersize=4)
            _measured(run, name, ax, any(not stages[k].prefix for k, _ in panel))
            ax.axhline(0.0, color="#999", linewidth=0.5)
            ax.set_xlabel("control displacement [mm]")
            ax.set_ylabel("load [kN]")
            ax.legend(title="stage")
        title = style.save(fig, folder, f"{name}-stages")
    return title, (
        "Load over displacement in all stages. Thin lines: every event in equilibrium. Thick lines: envelopes. A dot marks the start "
        "of a stage. A stage that begins where an earlier stage ended is drawn in the panel of that stage. Signs refer to the first stage "
        "of a panel."
    )


def _panels_of_stages(run: Stored, name: str) -> list[list[tuple[int, int]]]:
    """The stages (from 0) of each panel with their sense: one that begins with the displacement and the load at which
    an earlier one ended, or with their opposites, goes on in its panel."""
    panels: list[list[tuple[int, int]]] = []
    stages = run.results_of(name, Sla).stages
    for k, stage in enumerate(stages):
        begin = np.array([stage.displacement_of_constant_loads_m, stage.start_load_N])
        for panel in panels:
            last, sense = panel[-1]
            end = np.array([stages[last].last_displacement_m, stages[last].end_load_N])
            size = 1e-6 * np.abs(end) + 1e-15
            turn = next((t for t in (1, -1) if (np.abs(t * end - begin) <= size).all() and np.abs(end).all()), 0)
            if turn:
                panel.append((k, sense * turn))
                break
        else:
            panels.append([(k, 1)])
    return panels


def _cracks_by_stage(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Cracks at the end of each stage, one magnification and one scale of widths for all; none where no state was kept."""
    shown = []
    for stage in run.results_of(name, Sla).stages:
        if f"{stage.prefix}state_event" in run.arrays[name]:
            held = run.array(name, f"{stage.prefix}event_state")[run.array(name, f"{stage.prefix}state_event") - 1]
            shown += [(stage.prefix, int(s), f"end of stage {stage.name}") for s in np.flatnonzero(held > 0)[-1:]]
    if not shown:
        return []
    title = _draw_cracks(run, name, folder, shown, f"{name}-stage-cracks")
    return [(title, "Cracks on the deformed shape at the end of each stage. All stages have one scale.")]


def _curve(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    get, r = partial(run.array, name), run.results_of(name, Sla)
    with style.figure(7.0, 4.2) as (fig, (ax,)):
        if "scatter_load" in run.arrays[name]:
            grid, rows = get("scatter_displacement") * 1e3, get("scatter_load") / 1e3
            ax.fill_between(grid, rows.min(axis=0), rows.max(axis=0), color="#dfe7ef", label=f"{len(rows)} repetitions")
            ax.plot(grid, rows.mean(axis=0), color="#7b93ab", linestyle=":", label="their mean")
        for other in _incremental(run, name):
            at, load = (run.array(other, f"event_{n}") for n in ("displacement", "load"))
            ax.plot(
                at * 1e3,
                load / 1e3,
                "o-",
                color="#8a8a8a",
                markersize=3,
                linewidth=0.8,
                label=f"incremental, {run.results_of(other, Sla).stop}",
            )
        _measured(run, name, ax, True)
        for prefix, numbers in zip(PREFIXES, (r, r.minus), strict=True):
            if numbers is not None:
                _draw_sense(ax, run, name, prefix, numbers)
        most = _frame_curve(ax, run, name)
        ax.axhline(0.0, color="#999", linewidth=0.5)
        ax.set_xlabel(f"control displacement [mm]{f', curve continues to {1e3 * most:.0f}' if most else ''}")
        ax.set_ylabel("load [kN]")
        ax.legend()
        return style.save(fig, folder, f"{name}-curve"), (
            "Load over displacement. Thin lines: every state. Thick lines: envelopes. Dashed lines: bilinear idealisations. Dots: states "
            f"found by equilibrium iterations. Grey, if present: steps of an incremental solution of the same deck.{_dropped(r)}"
        )


def _draw_sense(ax: Axes, run: Stored, name: str, prefix: str, numbers: SlaCurve) -> None:
    """States, envelope and idealisation of the curve of one sense of the load."""

    def get(key: str) -> np.ndarray:
        return run.array(name, f"{prefix}{key}")

    d, p = get("event_displacement") * 1e3, get("event_load") / 1e3
    fine = get("event_state") > 0
    color = style.SAFE if prefix else style.THRUST
    begin = 1e3 * numbers.displacement_of_constant_loads_m
    on = next((1e-3 * s.start_load_N for s in numbers.get("stages", []) if not s.prefix), 0.0)
    ax.plot(np.append(begin, d[fine]), np.append(on, p[fine]), color=color, linewidth=0.25, alpha=0.4)
    none = get("event_state") == 0  # states out of reach are not drawn
    if none.any():
        known = "no equilibrium" in ax.get_legend_handles_labels()[1]
        ax.plot(d[none], p[none], "x", color=LOST, markersize=3, label=None if known else "no equilibrium")
    ax.plot(
        get("envelope_displacement") * 1e3,
        get("envelope_load") / 1e3,
        color=color,
        linewidth=1.4,
        label=f"envelope, load to {numbers.sense}",
    )

    def label(text: str) -> str | None:
        return None if prefix else text

    step = (get("event_step") > 0) & fine
    if step.any():
        ax.plot(d[step], p[step], ".", color=style.STEPS, markersize=4, zorder=3, label=label("equilibrium iterations"))
    for key, line, colour, text in (
        ("drop_displacement_m", ":", "#777", "drop to 80 % of the peak"),
        ("axial_loss_displacement_m", "--", style.THRUST, "axial capacity lost"),
    ):
        if numbers.get(key) is not None:
            ax.axvline(1e3 * numbers[key], color=colour, linestyle=line, linewidth=0.9, label=label(text))
    idea = numbers.bilinear
    if idea:
        shift = get("envelope_displacement")[0]
        ax.plot(
            (shift + np.array([0, idea.yield_displacement_m, idea.ultimate_displacement_m])) * 1e3,
            np.array([0, idea.yield_load_N, idea.yield_load_N]) / 1e3,
            color=color if prefix else ENVELOPE,
            linestyle="-." if prefix else "--",
            linewidth=0.9,
            label=f"bilinear idealisation of equal area, load to {numbers.sense}",
        )


def _frame_curve(ax: Axes, run: Stored, name: str) -> float:
    """Set the limits of the axes; the greatest displacement [m] if the axis ends before it, else 0.

    Events without equilibrium of a wall that comes apart lie far beyond: they must not shrink the curve.
    """
    get = partial(run.array, name)
    there = [p for p in PREFIXES if f"{p}envelope_load" in run.arrays[name]]
    far = np.concatenate([get(f"{p}envelope_displacement") for p in there])
    loads = np.concatenate([get(f"{p}event_load")[get(f"{p}event_state") > 0] for p in there])
    least, most = min(far.min(), 0.0), max(far.max(), 1e-12)
    enough = max(near_the_peak(*(get(f"{p}envelope_{n}") for n in ("displacement", "load"))) for p in there)
    cut = most > MOST_PLATEAU * enough > 0.0
    ax.set_xlim(1.05e3 * max(least, -MOST_PLATEAU * enough) if cut else 1.05e3 * least, 1.05e3 * (MOST_PLATEAU * enough if cut else most))
    if len(loads):
        if "measured_greatest" in run.arrays[name]:
            loads = np.append(loads, get("measured_greatest"))
        low, high = min(loads.min(), 0.0), max(loads.max(), 0.0)
        ax.set_ylim((low - 0.08 * (high - low)) / 1e3, (high + 0.08 * (high - low)) / 1e3)
    return most if cut else 0.0


def _dropped(r: Sla) -> str:
    """A sentence on the events of all curves that are not drawn, because they lie out of reach."""
    count = sum(curve.events_out_of_reach for curve in (r, r.minus) if curve is not None)
    return (f" Not drawn: {count} events with large displacements, or with loads above ten times the peak load.") if count else ""


def near_the_peak(displacement: np.ndarray, load: np.ndarray) -> float:
    """How far an envelope had come from its start when it first bore nearly all of its greatest load [m]."""
    there = int(np.argmax(load >= 0.98 * load.max()))
    return float(abs(displacement[there] - displacement[0]))


def _measured(run: Stored, name: str, ax: Axes, here: bool) -> None:
    """The measured curve in grey, behind, where there is one and it belongs `here`."""
    if not here or "measured_displacement" not in run.arrays[name]:
        return
    test = run.array(name, "measured_displacement") * 1e3
    least, greatest = (run.array(name, f"measured_{end}") / 1e3 for end in ("least", "greatest"))
    band = bool((greatest > least).any())
    if band:
        ax.fill_between(test, least, greatest, color="#d9d9d9", linewidth=0, zorder=0.5, label="range of the tests")
    ax.plot(test, 0.5 * (least + greatest), color="#8c8c8c", linewidth=1.2, zorder=0.6, label="tests, mean" if band else "test")


def _incremental(run: Stored, name: str) -> list[str]:
    """The incremental analyses of the same run, to be drawn behind a curve of events."""
    steps = [n for n, a in run.arrays.items() if "event_scale" in a and not run.array(n, "event_code").any()]
    return [] if name in steps else steps


def _peak_state(run: Stored, name: str, prefix: str) -> list[int]:
    """The states to draw: at the greatest load, at the drop from it where it was kept, and the last in equilibrium."""
    events = run.array(name, f"{prefix}state_event")
    held = np.flatnonzero(run.array(name, f"{prefix}event_state")[events - 1] > 0)
    peak = _peak(run, name, prefix)
    load = run.array(name, f"{prefix}state_load")
    step = run.array(name, f"{prefix}event_step")[events - 1] > 0
    drop = [int(s) for s in held if s > peak and step[s] and load[s] < DROP * load[peak]]
    return sorted({peak, *drop[:1], *held[-1:].tolist()})


def _peak(run: Stored, name: str, prefix: str) -> int:
    """The state at the peak, or of the greatest load where that was not kept."""
    numbers = run.results_of(name, Sla).get("minus", {}) if prefix else run.results_of(name, Sla)
    there = np.flatnonzero(run.array(name, f"{prefix}state_event") == numbers.get("greatest_load_event"))
    return int(there[0]) if len(there) else int(run.array(name, f"{prefix}state_load").argmax())


def _cracks(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    shown = [(prefix, s, f"event {run.array(name, f'{prefix}state_event')[s]}") for s in _peak_state(run, name, prefix)]
    title = _draw_cracks(run, name, folder, shown, f"{name}{SENSES[prefix]}-cracks")
    return (
        title,
        f"Cracks on the deformed shape{OPPOSITE[prefix]}, at the peak and at the end. Colour and line width show the crack width.",
    )


def _draw_cracks(run: Stored, name: str, folder: Path, shown: list[tuple[str, int, str]], file: str) -> str:
    """Cracks of some states: how the names of their arrays begin, number, words. One magnification and one scale of
    widths for the series; what came apart has a magnification of its own, and cracks beyond the scale."""
    by = "point_reach" if "point_reach" in run.arrays[name] else "point_band"
    xy, at, reach = (run.array(name, n) for n in ("node", "point_xy", by))
    span = np.ptp(xy, axis=0)

    def get(prefix: str, what: str, s: int) -> np.ndarray:
        return run.array(name, f"{prefix}state_{what}")[s]

    moves = [get(prefix, "displacement", s) for prefix, s, _ in shown]
    apart = [bool(np.abs(moved).max() > APART * span.max()) for moved in moves]
    whole = [k for k in range(len(shown)) if not apart[k]] or list(range(len(shown)))
    common = scale(span, np.concatenate([moves[k] for k in whole]))
    widest = [max(float(get(prefix, f"width_{d}", s).max()) for d in "ns") for prefix, s, _ in shown]
    most = max(widest[k] for k in whole)
    edges = _outline(run, name)
    with _panels(span, len(shown)) as (fig, axes):
        drawn = None
        for ax in axes[len(shown) :]:
            ax.set_axis_off()
        for k, (ax, (prefix, s, words)) in enumerate(zip(axes, shown, strict=False)):
            moved, load = moves[k], get(prefix, "load", s)
            factor = common if k in whole else scale(span, moved)
            shape = xy + factor * moved
            _wall(ax, polygons(run, name, shape), facecolors="white", edgecolors="#e4e4e4")
            ax.add_collection(LineCollection(shape[edges], colors=style.EDGE, linewidths=0.7))
            angle = get(prefix, "angle", s)
            widths = [get(prefix, f"width_{d}", s) for d in "ns"]
            place = at + factor * at_points(run, name, moved)
            for width, turn in zip(widths, (0.5 * np.pi, 0.0), strict=True):
                # A crack runs across its normal; those too fine to matter are left out
                wide = width > max(1e-3 * most, 1e-9)
                if not wide.any():
                    continue
                along = angle[wide] + turn
                half = 0.42 * reach[wide][:, None] * np.column_stack([np.cos(along), np.sin(along)])
                lines = LineCollection(
                    list(np.stack([place[wide] - half, place[wide] + half], axis=1)),
                    cmap=CRACKS,
                    norm=Normalize(0.0, 1e3 * most),
                    linewidths=0.5 + 2.0 * np.minimum(width[wide] / max(most, 1e-12), 1.0),
                )
                lines.set_array(1e3 * width[wide])
                ax.add_collection(lines)
                drawn = lines
            style.section_axes(ax)
            ax.set_title(f"{words}, {load / 1e3:.4g} kN\ndisplacements x {factor:g}")
        if drawn is not None:
            beyond = "max" if max(widest) > 1.001 * most else "neither"
            fig.colorbar(drawn, ax=list(axes), shrink=0.7, label="crack width [mm]", extend=beyond)
        return style.save(fig, folder, file)


def _panels(span: np.ndarray, count: int) -> AbstractContextManager[tuple[Figure, np.ndarray]]:
    """Panels side by side for upright walls, one below the other for long ones."""
    if span[0] > 2.2 * span[1]:
        return style.figure(8.0, count * min(8.0 * span[1] / span[0] + 1.1, 5.0), rows=count)
    columns = count if count <= MOST_BESIDE + 1 else MOST_BESIDE
    rows = -(-count // columns)
    return style.figure(4.8 * columns, rows * (min(4.8 * span[1] / span[0], 9.0) + 0.6), rows=rows, columns=columns)


def _stresses(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    xy, at = run.array(name, "node"), run.array(name, "point_xy")
    load = run.array(name, f"{prefix}state_load")
    s = _peak(run, name, prefix)
    span = np.ptp(xy, axis=0)
    # Where one of both is all but nothing, the scale of the other keeps it from showing how it is rounded
    stresses = [run.array(name, f"{prefix}state_{key}")[s] / 1e6 for key in ("stress_1", "stress_2")]
    least = max(NOTHING * max(float(np.abs(np.percentile(v, [2, 98])).max()) for v in stresses), 1e-9)
    with _panels(span, 2) as (fig, axes):
        for ax, value, title, cmap in zip(axes, stresses, ("greater", "lesser"), ("Reds", "Blues_r"), strict=True):
            low, high = np.percentile(value, [2, 98])
            limits = (0.0, max(high, least)) if title == "greater" else (min(low, -least), 0.0)
            _wall(ax, polygons(run, name, xy), facecolors="none", linewidths=0.1)
            size = np.clip(9000.0 / len(at), 0.3, 40.0)
            drawn = ax.scatter(*at.T, c=value, s=size, cmap=cmap, vmin=limits[0], vmax=limits[1], linewidths=0)
            fig.colorbar(drawn, ax=ax, shrink=0.7, label="stress [MPa]")
            style.section_axes(ax)
            ax.set_title(f"{title} principal stress")
        title = style.save(fig, folder, f"{name}{SENSES[prefix]}-stress")
    return (title, f"Principal stresses{OPPOSITE[prefix]}, at the peak load ({load[s] / 1e3:.4g} kN); tension is positive.")


def _section(run: Stored, name: str, folder: Path, i: int, height: Array, least: Array, greatest: Array) -> tuple[str, str]:
    y, about, lo, hi = height.numbers, height.about, least.numbers / 1e3, greatest.numbers / 1e3
    events = run.array(name, "state_event")
    # A section that is cracked through admits everything: nothing to show
    shown = np.flatnonzero((np.isfinite(lo) | np.isfinite(hi)).any(axis=1))[:6]
    lo, hi, events = lo[shown], hi[shown], events[shown]
    count = max(len(events), 1)
    with style.figure(2.4 * count + 1.0, 4.0, columns=count, sharey=True) as (fig, axes):
        for ax, low, high, event in zip(axes, lo, hi, events, strict=True):
            ends = np.concatenate([low[np.isfinite(low)], high[np.isfinite(high)]])
            reach = 1.2 * np.abs(ends).max() if len(ends) else 1.0
            bounded = np.isfinite(low) | np.isfinite(high)
            left, right = np.where(np.isfinite(low), low, -reach), np.where(np.isfinite(high), high, reach)
            ax.hlines(y[bounded], left[bounded], right[bounded], color="#9fb7c9", linewidth=2.0)
            ax.plot(low, y, "<", color=style.SAFE, markersize=4, label="lower limit")
            ax.plot(high, y, ">", color=style.THRUST, markersize=4, label="upper limit")
            for value, color in (
                (np.nanmax(low), style.SAFE) if np.isfinite(low).any() else (None, ""),
                (np.nanmin(high), style.THRUST) if np.isfinite(high).any() else (None, ""),
            ):
                if value is not None:
                    ax.axvline(value, color=color, linestyle=":", linewidth=1.0)
            ax.set_title(f"event {event}")
            ax.set_xlabel("load [kN]")
        axes[0].set_ylabel("y [m]")
        axes[0].legend(fontsize=7)
        title = style.save(fig, folder, f"{name}-section-{i}")
    return title, (
        f"Range of load multipliers that each point permits, {about}. Equilibrium is possible if the "
        "greatest lower limit (dotted, green) is below the least upper limit (dotted, red)."
    )


def _array_of(run: Stored, name: str, prefix: str, which: str) -> np.ndarray:
    """An array whose name begins with a prefix."""
    return run.array(name, f"{prefix}{which}")


def _called(array: Array) -> str:
    """The bar of an array of forces."""
    return array.about.removeprefix("force in ").removeprefix("force along ").split(",")[0]


def _has_bars(run: Stored, name: str, prefix: str) -> bool:
    return any(key.startswith((f"{prefix}bar_force_", f"{prefix}bar_along_")) for key in run.arrays[name])


def _bars(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    """Forces of bars and ties: from event to event, and along those that are embedded."""
    follow = run.series(name, f"{prefix}bar_force")
    places, forces = (run.series(name, f"{prefix}bar_{what}") for what in ("place", "along"))
    count = bool(follow) + bool(forces)
    with style.figure(7.0, 3.4 * count, rows=count) as (fig, axes):
        if follow:
            ax = axes[0]
            fine = run.array(name, f"{prefix}event_state") > 0
            # The displacements of stones run away as they become a mechanism
            axis, scale, words = (
                ("load", 1e-3, "load [kN]")
                if run.results_of(name, Sla).hinges is not None
                else ("displacement", 1e3, "control displacement [mm]")
            )
            way = scale * run.array(name, f"{prefix}event_{axis}")[fine]
            for k, array in enumerate(follow):
                ax.plot(
                    way,
                    1e-3 * array.numbers[fine],
                    color=STAGES[k % len(STAGES)],
                    label=_called(array),
                    linestyle=("-", "--", ":")[k // len(STAGES) % 3],
                )
            ax.axhline(0.0, color="#999", linewidth=0.5)
            ax.set_xlabel(words)
            ax.set_ylabel("force [kN], tension +")
            if len(follow) <= MOST_NAMED:
                style.legend_above(ax)
        if forces:
            ax, events = axes[-1], run.array(name, f"{prefix}state_event")
            shown = _peak_state(run, name, prefix)
            for k, (place, force) in enumerate(zip(places, forces, strict=True)):
                for s, line in zip(shown, ("-", "--"), strict=False):
                    ax.step(
                        place.numbers,
                        1e-3 * force.numbers[s],
                        line,
                        where="mid",
                        color=STAGES[k % len(STAGES)],
                        label=f"{_called(force)}, event {events[s]}",
                    )
            ax.axhline(0.0, color="#999", linewidth=0.5)
            ax.set_xlabel("distance from the start of the bar [m]")
            ax.set_ylabel("force [kN], tension +")
            if len(forces) <= MOST_NAMED:
                style.legend_above(ax)
        title = style.save(fig, folder, f"{name}{SENSES[prefix]}-bars")
    return title, (
        "Forces of bars and ties. Bars fixed at their ends: force at each event in equilibrium. Embedded "
        "bars: force along the bar, at the greatest load and in the last state in equilibrium."
    )


def _energy(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    get = partial(_array_of, run, name, "event_")
    with style.figure(7.0, 3.4) as (fig, (ax,)):
        state = get("state") > 0
        number = np.arange(1, len(state) + 1)[state]
        ax.stackplot(number, get("stored")[state], get("dissipated")[state], colors=["#cfe3d6", "#f2c28b"], labels=["stored", "dissipated"])
        ax.plot(number, get("external")[state], color=style.EDGE, linewidth=0.9, linestyle="--", label="work of the loads")
        ax.plot(number, get("crack")[state], color=style.THRUST, linewidth=0.9, label="crack energy (area of the saw-tooth curves)")
        style.numbers(ax.xaxis)
        ax.set_xlabel("event")
        ax.set_ylabel("energy [J]")
        style.legend_below(fig, ax)
        title = style.save(fig, folder, f"{name}-energy")
    return title, (
        "Energies: the work of the loads is stored, dissipated, or lost when the structure changes from one state to another. The error "
        f"of the energy balance is {run.results_of(name, Sla).energy_residual_ratio:.1e} of the work."
    )
