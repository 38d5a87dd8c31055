"""Figures of a strengthening: capacity over the size, mechanisms before and after, cost against safety, fragility before and after."""

import textwrap
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from extrados.results.store import Stored
from extrados.results.strengthen import FragilityPair, Intervention, Strengthen, size_told
from extrados.show import scene, solids, style
from extrados.show.limit import section

#: Alternatives in one figure
MOST = 8
#: Buildings in the figure of mechanisms in space, the existing one among them
MOST_IN_SPACE = 3
#: Letters in a line of a title
WIDE = 44


def draw_strengthen(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Mechanisms before and after, capacity curves, forces over places, the comparison by cost, fragility."""
    r = run.results_of(name, Strengthen)
    found = [
        _mechanisms(run, r, name, folder),
        _mechanisms_in_space(run, r, name, folder),
        _curves(run, r, name, folder),
        _places(run, r, name, folder),
        _costs(run, r, name, folder),
    ]
    if r.fragility is not None:
        found.append(_fragility(r.fragility, name, folder))
    return [one for one in found if one is not None]


def _paths(run: Stored, name: str, what: str) -> dict[str, np.ndarray]:
    """Packed rows of numbers by the names of their alternatives; nothing where there are none."""
    if what not in run.arrays[name]:
        return {}
    return section.paths(run, name, what)


def _scale(unit: str) -> tuple[float, str]:
    """Factor and unit in which sizes are drawn."""
    return {"N": (1e-3, "kN"), "Pa": (1e-6, "MPa")}.get(unit, (1.0, unit))


def _mechanisms(run: Stored, r: Strengthen, name: str, folder: Path) -> tuple[str, str] | None:
    """The mechanism of the existing building, beside those with the cheapest interventions."""
    rest, moved = _paths(run, name, "stones"), _paths(run, name, "stones_moved")
    shown = [k for k in ("0", "1", "2", "3") if any(key.startswith(f"{k}/") for key in rest)]
    if not shown:
        return None
    points = np.concatenate(list(rest.values()))
    tall = float(np.ptp(points[:, 1]) / max(np.ptp(points[:, 0]), 1e-9))
    height = float(np.clip(10.0 / len(shown) * tall + 1.2, 3.2, 6.5))
    with style.figure(3.2 * len(shown) + 0.5, height, columns=len(shown), sharey=True) as (fig, axes):
        for ax, k in zip(axes, shown, strict=True):
            section.stone(ax, [v for key, v in rest.items() if key.startswith(f"{k}/")], ghost=True)
            section.stone(ax, [v for key, v in moved.items() if key.startswith(f"{k}/")])
            if k == "0":
                unit = f" {r.unit}" if r.unit else ""
                value = "none" if r.value_before is None else f"{r.value_before:.3g}{unit}"
                ax.set_title(f"Existing: {value}\n(target {r.target:.3g}{unit})")
            else:
                one = r.interventions[int(k) - 1]
                _tie(ax, one)
                ax.set_title("\n".join(textwrap.wrap(f"{one.name}: {_told(one)}", WIDE)))
            style.section_axes(ax)
        ends = [np.array([one.start_m, one.end_m]) for one in r.interventions[: len(shown) - 1] if one.start_m is not None]
        every = np.concatenate([points, *moved.values(), *ends])
        room = 0.05 * float(np.ptp(every, axis=0).max())
        for ax in axes:
            ax.set_xlim(every[:, 0].min() - room, every[:, 0].max() + room)
            ax.set_ylim(every[:, 1].min() - room, every[:, 1].max() + room)
        saved = style.save(fig, folder, f"{name}-mechanisms")
    return saved, (
        "Governing collapse mechanisms, magnified: the existing building, and the building with each intervention. Each has the size "
        "that meets the target (if no size meets it, the greatest size considered)."
    )


def _mechanisms_in_space(run: Stored, r: Strengthen, name: str, folder: Path) -> tuple[str, str] | None:
    """The same of blocks in space, each stone coloured by its speed."""
    arrays = run.arrays[name]
    shown = [k for k in range(MOST_IN_SPACE) if f"solid_pose_{k}" in arrays]
    if not shown:
        return None
    rest = [solids.faces_of(run, name, which=f"_{k}") for k in shown]
    poses = [run.array(name, f"solid_pose_{k}") for k in shown]
    moved = [solids.faces_of(run, name, pose, f"_{k}") for k, pose in zip(shown, poses, strict=True)]
    frame = scene.frame_of(np.concatenate([faces.vertices for faces in moved]), solids.VIEW)
    tall = (frame[3] - frame[2]) / (frame[1] - frame[0])
    with style.figure(3.6 * len(shown) + 0.4, float(np.clip(3.6 * tall + 1.2, 3.2, 6.5)), columns=len(shown)) as (fig, axes):
        for ax, k, still, faces, pose in zip(axes, shown, rest, moved, poses, strict=True):
            colours = solids.SPEED(solids.speeds(still, faces, len(pose)))[:, :3]
            scene.show(ax, scene.picture(faces, solids.VIEW, frame, colours), frame)
            scene.ground(ax, still.vertices, solids.VIEW)
            unit = f" {r.unit}" if r.unit else ""
            value = "none" if r.value_before is None else f"{r.value_before:.3g}{unit}"
            title = f"Existing: {value}\n(target {r.target:.3g}{unit})"
            if k:
                title = "\n".join(textwrap.wrap(f"{r.interventions[k - 1].name}: {_told(r.interventions[k - 1])}", WIDE))
            ax.set_title(title)
            if f"solid_strand_{k}" in arrays:
                lines = run.array(name, f"solid_strand_{k}") @ solids.VIEW.axes[:2].T
                ax.add_collection(LineCollection(lines, colors=section.TIE, linewidths=1.6, zorder=3))
        saved = style.save(fig, folder, f"{name}-mechanisms")
    return saved, (
        "Governing collapse mechanisms, magnified: the existing building, and the building with each intervention of the size that "
        "meets the target. Colours: speed of the blocks (red: fastest). Lines: hoops, chains and ties."
    )


def _told(one: Intervention) -> str:
    if one.required_size is None:
        return "not sufficient"
    factor, unit = _scale(one.unit)
    return f"{one.required_size * factor:.3g} {unit}".rstrip()


def _tie(ax: Axes, one: Intervention) -> None:
    if one.start_m is None or one.end_m is None:
        return
    ends = np.array([one.start_m, one.end_m])
    ax.plot(*ends.T, "-o", color=section.TIE, linewidth=1.6, markersize=3, zorder=5)


def _curves(run: Stored, r: Strengthen, name: str, folder: Path) -> tuple[str, str] | None:
    """Value over size, a panel for each unit of sizes."""
    curves = _paths(run, name, "curve")
    rows = [one for one in r.interventions if one.name in curves][:MOST]
    groups = list(dict.fromkeys((one.unit, one.key or "yield force") for one in rows))
    if not groups:
        return None
    with style.figure(1.2 + 3.6 * min(len(groups), 4), 3.9, columns=min(len(groups), 4), sharey=True) as (fig, axes):
        for ax, (unit, key) in zip(axes, groups, strict=False):
            factor, shown = _scale(unit)
            here = [one for one in rows if (one.unit, one.key or "yield force") == (unit, key)]
            for k, one in enumerate(here):
                colour = section.CHAIN_COLOURS[k % len(section.CHAIN_COLOURS)]
                size, value, _ = curves[one.name].T
                ax.plot(size * factor, value, "-", color=colour, label=one.name)
                turns = [piece.first * factor for piece in one.ranges[1:]]
                if one.kind != "change" and turns:
                    ax.plot(turns, [piece.capacity_first for piece in one.ranges[1:]], "o", color=colour, markersize=3.5)
                if one.required_size is not None and one.capacity_after is not None:
                    ax.plot(one.required_size * factor, one.capacity_after, "*", color=colour, markersize=10, zorder=4)
            ax.axhline(r.target, color=style.EDGE, linewidth=1.0, linestyle="--", label="target")
            ax.set_xlabel(f"{key.rpartition('.')[2].replace('_', ' ')} [{shown}]" if shown else key)
            ax.legend(loc="best")
        known = [v for one in rows for v in curves[one.name][:, 1] if np.isfinite(v)]
        axes[0].set_ylim(0.0, 1.1 * max([r.target, *known]))
        axes[0].set_ylabel(_axis(r))
        saved = style.save(fig, folder, f"{name}-curves")
    return saved, (
        "Capacity, plotted over the size of each intervention. Dots: sizes from which another mechanism "
        "governs. Stars: least size that meets the target."
    )


def _axis(r: Strengthen) -> str:
    words = "collapse acceleration" if r.by == "tilt" else r.quantity[:1].lower() + r.quantity[1:]
    return f"{words} [{r.unit}]" if r.unit else words


def _places(run: Stored, r: Strengthen, name: str, folder: Path) -> tuple[str, str] | None:
    """Required force over the place of a tie."""
    ranges = {k: v for k, v in _paths(run, name, "range").items() if np.isfinite(v[:, 2]).any()}
    if not ranges:
        return None
    with style.figure(5.5, 3.8) as (fig, (ax,)):
        for k, (label, rows) in enumerate(list(ranges.items())[:MOST]):
            across = np.ptp(rows[:, 0]) > np.ptp(rows[:, 1])
            place = rows[:, 0] if across else rows[:, 1]
            good = np.isfinite(rows[:, 2])
            colour = section.CHAIN_COLOURS[k % len(section.CHAIN_COLOURS)]
            ax.plot(rows[good, 2] / 1e3, place[good], "-o", color=colour, markersize=3.5, label=label)
            ax.plot(
                np.zeros((~good).sum()),
                place[~good],
                "x",
                color=colour,
                label=f"{label}: no yield force meets the target" if (~good).any() else "_",
            )
        ax.set_xlabel("required yield force [kN]")
        ax.set_ylabel("x of the middle of the tie [m]" if across else "height of the middle of the tie [m]")
        ax.set_xlim(left=0.0)
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-places")
    return saved, (
        "Yield force that meets the target, plotted over the place of the tie. Crosses: places at which no yield force meets the target."
    )


def _costs(run: Stored, r: Strengthen, name: str, folder: Path) -> tuple[str, str] | None:
    """Cost against value: curves of all alternatives, and the Pareto front."""
    curves = _paths(run, name, "curve")
    rows = [one for one in r.interventions if one.name in curves][:MOST]
    if len(rows) < 2:
        return None
    falls = r.by == "fragility"
    points = [] if r.value_before is None else [(0.0, r.value_before)]
    with style.figure(6.4, 4.2) as (fig, (ax,)):
        for k, one in enumerate(rows):
            _, value, cost = curves[one.name].T
            colour = section.CHAIN_COLOURS[k % len(section.CHAIN_COLOURS)]
            ax.plot(cost, value, "-", color=colour, linewidth=1.0, label=one.name)
            dense = np.linspace(0.0, len(cost) - 1.0, 40 * len(cost))
            known = np.isfinite(value)
            if known.sum() > 1:
                at = np.arange(len(cost))
                points += list(zip(np.interp(dense, at[known], cost[known]), np.interp(dense, at[known], value[known]), strict=True))
            if one.cost is not None and one.capacity_after is not None:
                ax.plot(one.cost, one.capacity_after, "*", color=colour, markersize=10, zorder=4)
        front = _front(points, falls)
        ax.plot(*front.T, color="black", linewidth=3.5, alpha=0.25, zorder=1, label="no alternative is both cheaper and safer")
        ax.axhline(r.target, color=style.EDGE, linewidth=1.0, linestyle="--", label="target")
        ax.set_xlabel("relative cost, by the weights in the deck")
        ax.set_ylabel(_axis(r))
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-costs")
    best = r.best
    told = "" if best is None else f" Cheapest alternative that meets the target: {best.name}, {size_told(best)}."
    return saved, f"Relative cost and safety factor of all alternatives (thick line: Pareto front).{told}"


def _front(points: list[tuple[float, float]], falls: bool) -> np.ndarray:
    """Points that no other beats in cost and value, by ascending cost."""
    kept: list[tuple[float, float]] = []
    for cost, value in sorted(points, key=lambda p: (p[0], p[1] if falls else -p[1])):
        if not kept or (value < kept[-1][1] if falls else value > kept[-1][1]):
            kept.append((cost, value))
    return np.array(kept).reshape(-1, 2)


def _fragility(pair: FragilityPair, name: str, folder: Path) -> tuple[str, str]:
    """Probabilities of collapse over the scale factor of the motions, with their intervals."""
    with style.figure(5.5, 3.8) as (fig, (ax,)):
        for word, colour, label in (("before", style.THRUST, "existing building"), ("after", style.SAFE, f"with {pair.name}")):
            share = np.array([np.nan if p is None else p for p in getattr(pair, word)])
            low, high = getattr(pair, f"{word}_low"), getattr(pair, f"{word}_high")
            ax.fill_between(pair.levels, low, high, color=colour, alpha=0.2, linewidth=0.0)
            ax.plot(pair.levels, share, "-o", color=colour, markersize=3.5, label=label)
        ax.set_xlabel("scale factor of the motions")
        ax.set_ylabel("probability of collapse")
        ax.set_ylim(-0.02, 1.02)
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-fragility")
    return saved, (
        f"Share of the {pair.motions} motions that cause collapse, before and after the intervention, "
        "with 95 % confidence intervals (Wilson score)."
    )
