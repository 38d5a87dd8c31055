"""Figures of frames of macro-elements: capacity curves, walls with their damage, modes, histories."""

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle

from extrados.results.frame import FrameFragility, FrameMode, FrameModes, FramePushover, Modes
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.elevation import place_beside
from extrados.show.verification import draw_verification

#: Colours of the states of elements, by their numbers
COLOURS = ("#e8e2d4", "#cfe3d6", "#f2c28b", "#e08b5a", "#e0342b", "#5b1136")
WORDS = ("elastic", "cracked", "flexural strength", "shear strength", "drift limit in flexure", "drift limit in shear")
#: Drifts beyond it are those of a collapsed frame, without meaning [%]
LARGEST_DRIFT = 5.0
#: Walls of which the acceleration out of plane is drawn, at most
MOST_WALLS = 20
#: Storeys whose plans are drawn, at most
MOST_PLANS = 3
#: Modes that are drawn, at most, and the colours of their levels
MOST_MODES, LEVELS = 3, matplotlib.colormaps["viridis"]
#: Ground of words on the plan
BEHIND = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.75}
#: Colours of the patterns
PATTERNS = {"uniform": style.THRUST, "static": style.HINGE, "modal": style.SAFE}


def draw_pushover(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Base shear over control displacement of all runs; for each direction the walls of its weakest run, at the last state."""
    r = run.results_of(name, FramePushover)
    angles = sorted({row.direction_deg for row in r.runs})
    made = [_plan(run, name, folder), *draw_verification(run, name, folder)]
    with style.figure(7.2, 3.4, 1, len(angles), sharey=True) as (fig, axes):
        for ax, angle in zip(axes, angles, strict=True):
            seen = set()
            for row in (row for row in r.runs if row.direction_deg == angle):
                sign = 1.0 if row.sense == "+" else -1.0
                label = row.pattern if row.pattern not in seen else None
                seen.add(row.pattern)
                main = row.eccentricity == 0.0
                ax.plot(
                    1e3 * sign * np.array(row.control_displacement_m),
                    1e-3 * sign * np.array(row.base_shear_N),
                    color=PATTERNS.get(row.pattern, style.EDGE),
                    linewidth=1.3 if main else 0.6,
                    label=label,
                )
                if row.ultimate_displacement_m is not None and main:
                    moved, shear = np.array(row.control_displacement_m), np.array(row.base_shear_N)
                    before = shear[moved < row.ultimate_displacement_m]
                    at = before[-1] if len(before) else shear[0]
                    ax.plot(1e3 * sign * row.ultimate_displacement_m, 1e-3 * sign * at, "o", color=style.EDGE, markersize=3.5)
            ax.axhline(0.0, color=style.EDGE, linewidth=0.6)
            ax.axvline(0.0, color=style.EDGE, linewidth=0.6)
            ax.set_xlabel("control displacement [mm]")
            ax.set_title({0.0: "along x", 90.0: "along y"}.get(angle, f"at {angle:g} degrees"))
        axes[0].set_ylabel("base shear [kN]")
        style.legend_below(fig, axes[0])
        saved = style.save(fig, folder, f"{name}-curves")
    made.append(
        (
            saved,
            (
                f"Capacity curves of {len(r.runs)} pushovers. Thin lines: with accidental eccentricity. Dots: ultimate displacement "
                "(base shear decreased by 20 %, or all piers of a wall in one storey at their drift limits)."
            ),
        )
    )
    if r.walls_out_of_plane:
        made.append(_out_of_plane(r, name, folder))
    weakest = [min((row.peak_base_shear_N, k) for k, row in enumerate(r.runs, 1) if row.direction_deg == angle) for angle in angles]
    for (_, number), angle in sorted(zip(weakest, angles, strict=True)):
        row = r.runs[number - 1]
        state = run.array(name, f"state_{number}")
        told = f"{row.name}, {1e3 * row.control_displacement_m[-1]:.3g} mm"
        made.append(_walls(run, name, folder, state[-1], f"{angle:g}", told))
    return made


def _out_of_plane(r: FramePushover, name: str, folder: Path) -> tuple[str, str]:
    """Greatest accelerations of the walls out of their planes, beside those of rigid bodies and the base shear of the frame."""
    walls = (r.walls_out_of_plane or [])[:MOST_WALLS]
    places = np.arange(len(walls))
    with style.figure(6.5, 1.6 + 0.28 * len(walls)) as (fig, (ax,)):
        ax.barh(places, [w.acceleration_g for w in walls], 0.6, color=style.STONE, edgecolor=style.EDGE, label="with deflection")
        rigid = [(w.rigid_acceleration_g, k) for k, w in enumerate(walls) if w.rigid_acceleration_g is not None]
        if rigid:
            ax.plot(*zip(*rigid, strict=True), "|", color=style.HINGE, markersize=12, markeredgewidth=2, label="rigid mechanism")
        ax.axvline(r.base_shear_N / r.weight_N, color=style.THRUST, linewidth=1.0, label="base shear of the frame divided by its weight")
        for k, w in enumerate(walls):
            ax.annotate(f"{1e3 * w.deflection_m:.3g} mm", (0.0, k), (4, 0), textcoords="offset points", va="center", fontsize=7)
        ax.set_yticks(places, [w.wall for w in walls])
        ax.invert_yaxis()
        ax.margins(x=0.15)
        ax.set_xlim(left=0.0)
        ax.grid(visible=False, axis="y")
        ax.set_xlabel("constant acceleration perpendicular to the plane of the wall [g]")
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-out-of-plane")
    return saved, (
        "Walls out of their planes: greatest constant acceleration that each wall carries, and its deflection at this acceleration."
    )


def _plan(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """The plan of each storey: piers between openings, flanges of effective width, floors, rods and ring beams."""
    line, thickness, flange = (run.array(name, word) for word in ("wall_line", "wall_thickness", "flange"))
    tops = np.cumsum(run.array(name, "storey_height"))
    shown = min(len(tops), MOST_PLANS)
    wide, high = np.ptp(line.reshape(-1, 2), axis=0) + 1.0
    width = float(np.clip(4.2 * shown, 6.5, 11.0))
    labels = run.results_of(name, FramePushover).walls
    with style.figure(width, width / shown * high / wide + 1.2, 1, shown) as (fig, axes):
        for ax, storey in zip(axes, range(1, shown + 1), strict=True):
            for w in range(len(line)):
                if thickness[w, storey - 1] > 0.0:
                    _plan_wall(ax, run, name, w, storey, labels[w])
            for _, w, level, a, b, _ in flange:
                if int(level) == storey:
                    box = _on_plan(line[int(w)], a, b, thickness[int(w), storey - 1])
                    ax.add_patch(Polygon(box, facecolor="none", edgecolor=style.HINGE, hatch="////", linewidth=0.6))
            for w, level in run.array(name, "ring_beam").astype(int):
                if level == storey:
                    ax.plot(line[w, [0, 2]], line[w, [1, 3]], color=style.SAFE, linewidth=1.4, linestyle="--")
            for x0, y0, z0, x1, y1, z1 in run.array(name, "rod"):
                if int(np.abs(tops - 0.5 * (z0 + z1)).argmin()) + 1 == storey:
                    ax.plot([x0, x1], [y0, y1], color=style.THRUST, linewidth=1.2)
            for level, kind, x, y, dx, dy, roof, pitch in run.array(name, "floor"):
                if int(level) != storey:
                    continue
                if dx or dy:
                    way = 0.12 * min(wide, high) * np.array([dx, dy])
                    ax.annotate(
                        "", (x + way[0], y + way[1]), (x - way[0], y - way[1]), arrowprops={"arrowstyle": "<->", "color": style.EDGE}
                    )
                word = ("load", "membrane", "rigid", "joists")[int(kind)]
                word += f"\n{('', 'rafters', 'trusses', 'purlins')[int(roof)]}, {pitch:.3g}°" if roof else ""
                look = {"va": "center", "fontsize": 7, "color": style.EDGE, "bbox": BEHIND, "zorder": 6}
                ax.annotate(
                    word, (x, y), (6 if dx or dy else 0, 0), textcoords="offset points", ha="left" if dx or dy else "center", **look
                )
            ax.set_aspect("equal")
            ax.margins(0.12)  # room for the names of walls
            ax.autoscale_view()
            ax.grid(False)
            ax.set_title(f"storey {storey}")
            ax.set_xlabel("x [m]")
        axes[0].set_ylabel("y [m]")
        drawn = {
            "opening": Patch(facecolor="white", edgecolor=style.EDGE, label="opening"),
            "flange": Patch(facecolor="none", edgecolor=style.HINGE, hatch="////", label="flange of effective width"),
            "ring_beam": Line2D([], [], color=style.SAFE, linestyle="--", label="ring beam"),
            "rod": Line2D([], [], color=style.THRUST, label="tie rod"),
        }
        handles: list[Artist] = [Patch(facecolor=style.STONE, edgecolor=style.EDGE, label="pier")]
        handles += [handle for part, handle in drawn.items() if len(run.array(name, part))]
        fig.legend(handles=handles, loc="outside lower center", ncols=3)
        saved = style.save(fig, folder, f"{name}-plan")
    return saved, ("The frame in plan: piers between openings, flanges that the walls lift at their corners, and floors.")


def _on_plan(line: np.ndarray, a: float, b: float, thickness: float) -> np.ndarray:
    """Corners of the part of a wall from a to b along it on the plan [m]."""
    way = line[2:] - line[:2]
    way = way / np.hypot(*way)
    across = 0.5 * thickness * np.array([-way[1], way[0]])
    start, end = line[:2] + a * way, line[:2] + b * way
    return np.array([start + across, end + across, end - across, start - across])


def _plan_wall(ax: Axes, run: Stored, name: str, w: int, storey: int, label: str) -> None:
    line, thickness = run.array(name, "wall_line")[w], float(run.array(name, "wall_thickness")[w, storey - 1])
    part, of, kind, at = (run.array(name, f"element_{word}") for word in ("part", "wall", "kind", "storey"))
    length = float(run.array(name, "wall_length")[w])
    ax.add_patch(Polygon(_on_plan(line, 0.0, length, thickness), facecolor="white", edgecolor=style.EDGE, linewidth=0.5))
    for a, b, _, _ in part[(of == w) & (kind == 1) & (at == storey)]:
        ax.add_patch(Polygon(_on_plan(line, a, b, thickness), facecolor=style.STONE, edgecolor=style.EDGE, linewidth=0.8))
    _wall_name(ax, run.array(name, "wall_line"), w, 0.5 * thickness + 0.22, label)


def _wall_name(ax: Axes, lines: np.ndarray, w: int, aside: float, label: str) -> None:
    """The name of a wall beside it on the plan, at a distance [m] from its axis."""
    place, turn = place_beside(lines, w, aside)
    ax.text(*style.pair(place), label, ha="center", va="center", fontsize=7, rotation=turn, bbox=BEHIND, zorder=6)


def _walls(run: Stored, name: str, folder: Path, state: np.ndarray, word: str, told: str) -> tuple[str, str]:
    """The walls unfolded side by side: nodes, piers and spandrels in the colours of their states."""
    length, height = run.array(name, "wall_length"), run.array(name, "wall_height")
    part, of, holes = run.array(name, "element_part"), run.array(name, "element_wall"), run.array(name, "opening")
    gap = 0.15 * float(length.mean())
    first = np.concatenate([[0.0], np.cumsum(length + gap)[:-1]])
    total = float(first[-1] + length[-1])
    wide = float(np.clip(0.55 * total, 5.0, 11.0))
    with style.figure(wide, wide * float(height.max() + run.array(name, "gable")[:, 2].max(initial=0.0)) / total + 1.5) as (fig, (ax,)):
        for w in range(len(length)):
            ax.add_patch(Rectangle((first[w], 0.0), length[w], height[w], facecolor="#b9b2a3", edgecolor=style.EDGE, linewidth=0.6))
        for (a, b, low, high), w, value in zip(part, of.astype(int), state.astype(int), strict=True):
            ax.add_patch(Rectangle((first[w] + a, low), b - a, high - low, facecolor=COLOURS[value], edgecolor=style.EDGE, linewidth=0.4))
        for w, a, b, low, high in holes:
            ax.add_patch(Rectangle((first[int(w)] + a, low), b - a, high - low, facecolor="white", edgecolor=style.EDGE, linewidth=0.6))
        tops = height.astype(float)
        for number, s, rise in run.array(name, "gable"):
            w = int(number)
            tops[w] += rise
            outline = [(first[w], height[w]), (first[w] + length[w], height[w]), (first[w] + s, height[w] + rise)]
            ax.add_patch(Polygon(outline, facecolor="#b9b2a3", edgecolor=style.EDGE, linewidth=0.6))
        for w, label in enumerate(run.results_of(name, FramePushover).walls):
            ax.text(first[w] + 0.5 * length[w], tops[w] + 0.01 * height[w], label, ha="center", va="bottom", fontsize=8)
        ax.set_xlim(-0.3, total + 0.3)
        ax.set_ylim(0.0, float(tops.max()) * 1.1)
        ax.set_aspect("equal")
        ax.grid(False)
        ax.set_xlabel("distance along the walls, which are drawn side by side [m]")
        ax.set_ylabel("height [m]")
        ax.set_title(told)
        handles: list[Artist] = [Patch(facecolor=c, edgecolor=style.EDGE, label=w) for c, w in zip(COLOURS, WORDS, strict=True)]
        handles.append(Patch(facecolor="#b9b2a3", edgecolor=style.EDGE, label="rigid node"))
        fig.legend(handles=handles, loc="outside lower center", ncols=4)
        saved = style.save(fig, folder, f"{name}-walls-{word}")
    return saved, f"Piers and spandrels between rigid nodes, {told}."


def draw_modes(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Displaced walls on the plan, or displacements of blocks in their section, in the first modes."""
    return _block_modes(run, name, folder) if isinstance(run[name], Modes) else _wall_modes(run, name, folder)


def _of_mode(k: int, mode: FrameMode) -> str:
    """Title of a mode: period, frequency and participating masses."""
    shares = ", ".join(f"$M_{{{axis}}}$ {100.0 * ratio:.1f} %" for axis, ratio in (("x", mode.mass_ratio_x), ("y", mode.mass_ratio_y)))
    return f"mode {k + 1}: T {mode.period_s:.3g} s, f {mode.frequency_Hz:.3g} Hz\n{shares}"


def _wall_modes(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    modes = run.results_of(name, FrameModes).modes[:MOST_MODES]
    line, thickness = (run.array(name, word) for word in ("wall_line", "wall_thickness"))
    labels = run.results_of(name, FrameModes).walls
    place, of, shape = (run.array(name, f"trace_{word}") for word in ("place", "of", "shape"))
    low, high = line.reshape(-1, 2).min(axis=0), line.reshape(-1, 2).max(axis=0)
    scale, room = 0.12 * float((high - low).max()), 0.22 * float((high - low).max())
    levels = range(1, thickness.shape[1] + 1)
    wide, tall = high - low + 2.0 * room
    with style.figure(3.3 * len(modes), 3.1 * tall / wide + 1.2, 1, len(modes), sharey=True) as (fig, axes):
        for k, (ax, mode) in enumerate(zip(axes, modes, strict=True)):
            for w, thick in enumerate(thickness.max(axis=1)):
                length = float(np.hypot(*(line[w, 2:] - line[w, :2])))
                ax.add_patch(Polygon(_on_plan(line[w], 0.0, length, thick), facecolor=style.STONE, edgecolor=style.EDGE, linewidth=0.4))
                _wall_name(ax, line, w, 0.5 * thick + 0.035 * wide, labels[w])
                for level in levels:
                    own = (of == (w, level)).all(axis=1)
                    colour = LEVELS(0.15 + 0.7 * (level - 1) / max(len(levels) - 1, 1))
                    ax.plot(*(place[own] + scale * shape[k, own]).T, color=colour, linewidth=1.3, zorder=3)
            ax.set_xlim(low[0] - room, high[0] + room)
            ax.set_ylim(low[1] - room, high[1] + room)
            ax.set_aspect("equal")
            ax.grid(False)
            ax.set_xlabel("x [m]")
            ax.set_title(_of_mode(k, mode), fontsize=8)
        axes[0].set_ylabel("y [m]")
        shades = [LEVELS(0.15 + 0.7 * (level - 1) / max(len(levels) - 1, 1)) for level in levels]
        handles: list[Artist] = [Patch(facecolor=style.STONE, edgecolor=style.EDGE, label="walls at rest")]
        handles += [Line2D([], [], color=shade, label=f"top of storey {level}") for level, shade in zip(levels, shades, strict=True)]
        fig.legend(handles=handles, loc="outside lower center", ncols=len(handles))
        saved = style.save(fig, folder, f"{name}-modes")
    return [
        (
            saved,
            (
                "Displaced walls in the first modes, in plan, not to scale. M: participating mass divided by the "
                "mass of all levels above the ground."
            ),
        )
    ]


def _block_modes(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    modes = run.results_of(name, Modes).modes[:MOST_MODES]
    place, shape = run.array(name, "place"), run.array(name, "shape")
    scale = 0.15 * float(np.ptp(place[:, :2], axis=0).max())
    with style.figure(2.6 * len(modes), 3.0, 1, len(modes)) as (fig, axes):
        for k, (ax, mode) in enumerate(zip(axes, modes, strict=True)):
            ax.plot(place[:, 0], place[:, 1], ".", color=style.STONE, markersize=3)
            moved = scale * shape[k]
            ax.quiver(*place[:, :2].T, *moved.T, angles="xy", scale_units="xy", scale=1.0, width=0.006, color=style.HINGE)
            ax.set_aspect("equal")
            for set_limit, axis in ((ax.set_xlim, 0), (ax.set_ylim, 1)):
                ends = np.concatenate([place[:, axis], place[:, axis] + moved[:, axis]])
                set_limit(ends.min() - 0.3 * scale, ends.max() + 0.3 * scale)
            ax.set_xlabel("x [m]")
            ax.set_title(_of_mode(k, mode), fontsize=8)
        saved = style.save(fig, folder, f"{name}-modes")
    return [(saved, ("Displacements of the blocks in the first modes, in section. M: participating mass divided by the total mass."))]


def draw_history(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Displacement over time, and base shear over displacement."""
    time, moved, shear = (run.array(name, word) for word in ("time", "displacement", "base_shear"))
    with style.figure(7.2, 2.9, 1, 2, width_ratios=[1.6, 1.0]) as (fig, (left, right)):
        left.plot(time, 1e3 * moved, color=style.EDGE, linewidth=0.8)
        left.set_xlabel("time [s]")
        left.set_ylabel("control displacement [mm]")
        right.plot(1e3 * moved, 1e-3 * shear, color=style.THRUST, linewidth=0.6)
        right.set_xlabel("control displacement [mm]")
        right.set_ylabel("base shear [kN]")
        saved = style.save(fig, folder, f"{name}-history")
    return [(saved, ("Left: displacement of the control level relative to the ground. Right: base shear, plotted over this displacement."))]


def draw_fragility(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Curves of the limit states over the intensity; of histories the runs: drift over intensity."""
    r, grid = run.results_of(name, FrameFragility), run.array(name, "grid")
    history = r.method == "history"
    made = 1 + int(history)
    with style.figure(3.6 * made, 3.0, 1, made) as (fig, axes):
        for state, colour in zip(r.limit_states, (style.SAFE, style.HINGE, style.EDGE), strict=True):
            if state.median_g is None or not state.dispersion:
                continue
            key = state.limit_state.replace("-", "_")
            axes[0].plot(grid, run.array(name, f"curve_{key}"), color=colour, label=state.limit_state.replace("-", " "))
            if state.probability is not None:
                shown = [(x, p) for x, p in zip(r.levels_g, state.probability, strict=True) if p is not None]
                axes[0].plot(*zip(*shown, strict=True), "o", color=colour, markersize=3)
            elif not history:
                k = [s.limit_state for s in r.limit_states].index(state.limit_state)
                carried = np.sort(run.array(name, "carried")[:, k])
                axes[0].step(carried, np.arange(1, len(carried) + 1) / len(carried), color=colour, linewidth=0.6)
        axes[0].set_ylim(0.0, 1.0)
        axes[0].set_xlabel(f"{r.intensity} [g]")
        axes[0].set_ylabel("probability of exceeding")
        style.legend_below(fig, axes[0])
        if history:
            drift, fell = 100.0 * run.array(name, "drift"), run.array(name, "exceeded")[:, -1] == 1
            for which, word, mark in ((~fell, "no collapse", "."), (fell, "collapse", "x")):
                shown = np.minimum(drift[which], LARGEST_DRIFT)
                axes[1].plot(run.array(name, "intensity")[which], shown, mark, color=style.THRUST, markersize=4, label=word)
            axes[1].set_yscale("log")
            axes[1].legend()
            axes[1].set_xlabel(f"{r.intensity} [g]")
            axes[1].set_ylabel("greatest drift of a pier [%]")
        saved = style.save(fig, folder, f"{name}-fragility")
    caption = f"Fragility from {r.motions} motions: fitted curves" + (
        ", and share of the motions that exceed the limit state at each level" if r.levels_g else ""
    )
    caption += (
        f". Right: greatest drift of each run, drawn up to {LARGEST_DRIFT:g} %."
        if history
        else ". Steps: shares of the motions that exceed the limit state."
    )
    return [(saved, caption)]
