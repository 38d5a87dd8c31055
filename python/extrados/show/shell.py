"""Figures of pushovers of buildings and vaults: capacity curves, cracks on unfolded walls, from above and in space, drifts and
damage by storey."""

from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from extrados.results.shell import PushCurve, Pushover
from extrados.results.sla import PREFIXES
from extrados.results.store import Stored
from extrados.show import scene, style
from extrados.show.cracked import CRACKS
from extrados.show.sla import LOST, SENSES
from extrados.show.verification import draw_verification

FLOOR = "#dbe3ea"
#: Where the building is looked at from
VIEW = scene.View(-60.0, 28.0)
#: Cracks of a vault that are widest at its extrados, and at its intrados
OUTSIDE, INSIDE = "#b3261e", "#1f4e9b"
#: Seats of floors
SEATS = (style.THRUST, style.SAFE, LOST, "#8a6d3b", "#7b93ab")
#: Gap between unfolded walls, in parts of the height
GAP = 0.12
#: Kept states from which on the shear of the walls is drawn as a curve
LEAST_STATES = 5
#: Part of the greatest width from which a crack is drawn
LEAST_WIDTH = 0.02


def draw_pushover(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """All figures of one analysis."""
    figures = [_stage_curves(run, name, folder) if run.results_of(name, Pushover).stages else _curves(run, name, folder)]
    figures = [*draw_verification(run, name, folder), *figures]
    for prefix in _prefixes(run, name):
        if f"{prefix}event_seat_slip" in run.arrays[name]:
            figures.append(_seats(run, name, folder, prefix))
        if f"{prefix}state_event" not in run.arrays[name]:
            continue
        if len(run.array(name, "wall")):
            figures += [_unfolded(run, name, folder, prefix), _space(run, name, folder, prefix)]
            figures.append(_storeys(run, name, folder, prefix))
        else:
            figures += [_from_above(run, name, folder, prefix), _space(run, name, folder, prefix)]
    return figures


def _prefixes(run: Stored, name: str) -> list[str]:
    """How the names of the arrays of each curve begin: of the senses, or of the stages in their order."""
    stages = run.results_of(name, Pushover).stages
    return [stage.prefix for stage in stages] if stages else list(PREFIXES)


def _numbers(run: Stored, name: str, prefix: str) -> PushCurve:
    """The numbers of a curve."""
    r = run.results_of(name, Pushover)
    if r.stages:
        return next(stage for stage in r.stages if stage.prefix == prefix)
    return r.minus if prefix else r


def _suffix(prefix: str) -> str:
    """What the names of the figures of a curve end in."""
    return SENSES[prefix] if prefix in SENSES else f"-{prefix.rstrip('_').replace('_', '-')}"


def _stage_curves(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """The base shear over the control displacement through all pushes, and the force that moves the ground in settlements."""
    stages = run.results_of(name, Pushover).stages
    kinds = [of for of in ("push", "settlement") if any(stage.of == of for stage in stages)]
    colors = [style.THRUST, style.SAFE, style.HINGE, LOST, "#7b93ab", "#8a6d3b"]
    with style.figure(5.4 * len(kinds) + 1.0, 4.2, columns=len(kinds)) as (fig, axes):
        for ax, of in zip(np.atleast_1d(axes), kinds, strict=True):
            for k, stage in enumerate(stages):
                if stage.of != of:
                    continue
                sign = -1.0 if stage.sense == "-" else 1.0
                fine = run.array(name, f"{stage.prefix}event_state") > 0
                d, p = (run.array(name, f"{stage.prefix}event_displacement"), run.array(name, f"{stage.prefix}event_load"))
                ax.plot(
                    1e3 * sign * d[fine], sign * p[fine] / 1e3, color=colors[k % len(colors)], linewidth=0.9, label=f"{k + 1}: {stage.name}"
                )
            ax.axhline(0.0, color="#999", linewidth=0.5)
            ax.axvline(0.0, color="#999", linewidth=0.5)
            push = of == "push"
            ax.set_xlabel("control displacement [mm]" if push else "greatest movement of the ground [mm]")
            ax.set_ylabel("base shear [kN]" if push else "force on the moving ground [kN]")
            ax.legend()
        return style.save(fig, folder, f"{name}-curve"), (
            "Stages in order; each starts with the damage of the stages before. Lateral loads: base shear over control displacement. "
            "Settlement: force along the movement, summed over the moving supports."
        )


def _seats(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    """Base shear over the displacement of floors off their seats, and the lengths of these."""
    fine, slips = run.array(name, f"{prefix}event_equilibrium") > 0, 1e3 * run.array(name, f"{prefix}event_seat_slip")
    load = run.array(name, f"{prefix}event_load")[fine] / 1e3
    seats = _numbers(run, name, prefix).seats or []
    with style.figure(7.0, 4.2) as (fig, (ax,)):
        for k, seat in enumerate(seats):
            color = SEATS[k % len(SEATS)]
            ax.plot(slips[fine, k], load, color=color, marker=".", markersize=3, linewidth=1.0, label=f"{seat.floor} on wall {seat.wall}")
        for length in sorted({seat.length_m for seat in seats}):
            ax.axvline(1e3 * length, color=style.HINGE, linestyle="--", linewidth=1.0)
            ax.annotate(f"seat of {1e3 * length:.3g} mm", (1e3 * length, 0.0), rotation=90, fontsize=8, ha="right", va="bottom")
        ax.set_xlabel("displacement of the floor away from its support [mm]")
        ax.set_ylabel("base shear [kN]")
        ax.legend()
        return style.save(fig, folder, f"{name}-seats{_suffix(prefix)}"), (
            "Base shear over the displacement of each floor away from its support on a wall (the greater "
            "value of its two ends). Beyond the dashed line the floor has slid off."
        )


def _wall_curves(ax: Axes, run: Stored, name: str, prefix: str) -> None:
    """The shear of each wall along the push at its foot, through the kept states in equilibrium under a displacement not reached before."""
    if f"{prefix}state_wall_shear" not in run.arrays[name]:
        return
    event = run.array(name, f"{prefix}state_event") - 1
    d = 1e3 * run.array(name, f"{prefix}event_displacement")[event]
    held = (run.array(name, f"{prefix}event_equilibrium")[event] > 0) & (d >= np.maximum.accumulate(d))
    if held.sum() < LEAST_STATES:
        return
    d, most = d[held], np.abs(run.array(name, f"{prefix}event_load")).max() / 1e3
    for k, wall in enumerate(_numbers(run, name, prefix).walls):
        shear = run.array(name, f"{prefix}state_wall_shear")[held, k] / 1e3
        if np.abs(shear).max() > 0.01 * most:
            ax.plot(d, shear, marker=".", markersize=3, linewidth=0.9, linestyle=("--", ":", "-.")[k % 3], color="#8a6d3b")
            height = shear[0]
            while any(abs(height - text.get_position()[1]) < 0.035 * most for text in ax.texts):
                height += 0.01 * most  # above the names that are there
            ax.text(d[0], height, f"wall {wall.wall}", fontsize=7, color="#8a6d3b", ha="right")


def _curves(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Capacity curves of both senses with their bilinear idealisation, the variants behind; others of the run in grey."""
    get, r = partial(run.array, name), run.results_of(name, Pushover)
    with style.figure(7.0, 4.4) as (fig, (ax,)):
        others = [n for n in run.arrays if n != name and "place_wall" in run.arrays[n]]
        for k, other in enumerate(others):
            d, p = run.array(other, "envelope_displacement"), run.array(other, "envelope_load")
            ax.plot(1e3 * d, p / 1e3, color="#8a8a8a", linestyle=("--", ":", "-.")[k % 3], label=f"analysis {other}")
        pairs = list(zip(run.series(name, "variant_displacement"), run.series(name, "variant_load"), strict=True))
        for k, (moved, carried) in enumerate(pairs):
            d, p = moved.numbers, carried.numbers
            label = r.variants[k].name if r.variants and len(pairs) <= 8 else None
            ax.plot(1e3 * d, p / 1e3, color="#7b93ab", linewidth=0.8, alpha=0.9, zorder=1)
            if label:
                at = int(p.argmax())
                ax.annotate(label, (1e3 * d[at], p[at] / 1e3), fontsize=6, color="#5d7288")
        for prefix, numbers in zip(PREFIXES, (r, r.minus), strict=True):
            if numbers is None:
                continue
            color = style.SAFE if prefix else style.THRUST
            d, p = 1e3 * get(f"{prefix}event_displacement"), get(f"{prefix}event_load") / 1e3
            fine = get(f"{prefix}event_state") > 0
            ax.plot(d[fine], p[fine], color=color, linewidth=0.25, alpha=0.4)
            _wall_curves(ax, run, name, prefix)
            none = get(f"{prefix}event_state") == 0
            if none.any():
                far = 1.1 * np.abs(get(f"{prefix}envelope_displacement")).max() * 1e3
                inside = none & (np.abs(p) < 1.2 * np.abs(p[fine]).max()) & (d >= 0.0) & (d < far)
                label = "no equilibrium" if not prefix or (get("event_state") != 0).all() else None
                ax.plot(d[inside], p[inside], "x", color=LOST, markersize=3, label=label)
            ax.plot(
                1e3 * get(f"{prefix}envelope_displacement"),
                get(f"{prefix}envelope_load") / 1e3,
                color=color,
                linewidth=1.5,
                label=f"push to {numbers.sense}",
            )
            step = (get(f"{prefix}event_step") > 0) & fine
            if step.any():
                label = "equilibrium iterations" if not prefix else None
                ax.plot(d[step], p[step], ".", color=style.STEPS, markersize=4, zorder=3, label=label)
            if numbers.drop_displacement_m is not None:
                label = "drop to 80 % of the peak" if not prefix else None
                ax.axvline(1e3 * numbers.drop_displacement_m, color="#777", linestyle=":", linewidth=0.9, label=label)
            idea = numbers.bilinear
            if idea:
                shift = get(f"{prefix}envelope_displacement")[0]
                x = shift + np.array([0.0, idea.yield_displacement_m, idea.ultimate_displacement_m])
                ax.plot(
                    1e3 * x,
                    np.array([0.0, idea.yield_load_N, idea.yield_load_N]) / 1e3,
                    color=color,
                    linestyle="--",
                    linewidth=0.9,
                    label=f"bilinear idealisation, ductility {idea.ductility:.2g}",
                )
        if r.sliding_capacity_N is not None and r.sliding_capacity_N < 1.2 * ax.get_ylim()[1] * 1e3:
            ax.axhline(r.sliding_capacity_N / 1e3, color=LOST, linestyle=":", linewidth=1.2, label=f"slides on {r.sliding_level}")
        ax.set_xlabel("control displacement [mm]")
        ax.set_ylabel("base shear [kN]")
        ax.set_ylim(bottom=0.0)
        ax.axhline(0.0, color="#999", linewidth=0.5)
        weight = r.weight_N
        right = ax.secondary_yaxis("right", functions=(lambda v: v * 1e3 / weight, lambda c: c * weight / 1e3))
        right.set_ylabel("base shear over weight")
        ax.legend()
        return style.save(fig, folder, f"{name}-curve"), (
            "Capacity curves. Thin lines: every state. Thick lines: envelopes. Dashed lines: bilinear idealisations of equal area. "
            "Dots: states found by equilibrium iterations. Horizontal dotted line: Coulomb limit of the level that slides first, which "
            "the curve does not include. Blue-grey: variants of the assumptions. Grey: other analyses of the run."
        )


def _state(run: Stored, name: str, prefix: str) -> int:
    """The state of the greatest base shear, else the last."""
    numbers = _numbers(run, name, prefix)
    events = run.array(name, f"{prefix}state_event")
    if getattr(numbers, "of", "push") == "settlement":
        return len(events) - 1
    there = np.flatnonzero(events == numbers.greatest_load_event)
    return int(there[0]) if len(there) else len(events) - 1


def _shown(run: Stored, name: str, prefix: str) -> list[int]:
    """The states to draw: that of the greatest base shear, and the last in equilibrium."""
    events = run.array(name, f"{prefix}state_event")
    held = np.flatnonzero(run.array(name, f"{prefix}event_state")[events - 1] > 0)
    return sorted({_state(run, name, prefix), *held[-1:].tolist()})


def _walls(run: Stored, name: str) -> list[tuple[int, np.ndarray]]:
    """All parts: the wall that each is of, -1 none, and its elements."""
    pairs = zip(run.series(name, "elements"), run.series(name, "wall_of"), strict=True)
    return [(int(wall.numbers[0]), elements.numbers) for elements, wall in pairs]


def _unfolded(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    """Cracks at the peak and the end on the walls, one beside the other as they follow on the plan."""
    node, walls, level = (run.array(name, n) for n in ("node", "wall", "level"))
    width, angle = run.array(name, f"{prefix}state_width"), run.array(name, f"{prefix}state_angle")
    load, event = run.array(name, f"{prefix}state_load"), run.array(name, f"{prefix}state_event")
    of, s, z = (run.array(name, f"place_{n}") for n in ("wall", "s", "z"))
    names = [row.wall for row in _numbers(run, name, prefix).walls] or [str(k + 1) for k in range(len(walls))]
    shown = _shown(run, name, prefix)
    gap = GAP * level[-1]
    start = np.concatenate([[0.0], np.cumsum(walls[:, 4] + gap)])
    most = max(float(width[shown].max()), 1e-12)
    total = start[-1] - gap
    length = 0.6 * np.sqrt(np.median(_areas(node, _walls(run, name))))
    # states of walls that are higher than long stand beside each other, with room for their words
    narrow = total < 1.5 * level[-1]
    tall = 3.6 if narrow else min(2.6, 9.0 * level[-1] / total + 0.9)
    room = 0.02 * total
    grid = (1, len(shown)) if narrow else (len(shown), 1)
    with style.canvas(3.6 * len(shown) + 1.4 if narrow else 10.0, tall * grid[0] + 0.8) as fig:
        axes = fig.subplots(*grid, squeeze=False).ravel()
        for ax, k in zip(axes, shown, strict=True):
            for wall, connect in _walls(run, name):
                if wall < 0:
                    continue
                place = node[connect]
                along = (place[..., :2] - walls[wall, :2]) @ walls[wall, 2:4] + start[wall]
                ax.add_collection(
                    PolyCollection(
                        list(np.stack([along, place[..., 2]], axis=-1)), facecolors="white", edgecolors="#ece9e2", linewidths=0.3
                    )
                )
            seen = np.flatnonzero((width[k] > LEAST_WIDTH * most) & (of >= 0))
            seen = seen[np.argsort(width[k][seen])]
            x, y = s[seen] + start[of[seen]], z[seen]
            way = 0.5 * length * np.column_stack([-np.sin(angle[k][seen]), np.cos(angle[k][seen])])
            middle = np.column_stack([x, y])
            drawn = LineCollection(
                list(np.stack([middle - way, middle + way], axis=1)),
                cmap=CRACKS,
                norm=Normalize(0.0, 1e3 * most),
                linewidths=0.6 + 1.8 * width[k][seen] / most,
                array=1e3 * width[k][seen],
            )
            ax.add_collection(drawn)
            for w, word in enumerate(names):
                ax.text(start[w] + 0.5 * walls[w, 4], level[-1] + 0.02 * level[-1], f"wall {word}", ha="center", va="bottom")
                ax.add_patch(_frame(start[w], walls[w, 4], level[-1]))
            for height in level[1:-1]:
                ax.axhline(height, color="#b9c4cf", linewidth=0.6, linestyle=":")
            ax.set_xlim(-room, total + room, auto=narrow)
            ax.set_ylim(-0.02 * level[-1], 1.14 * level[-1])
            ax.set_aspect("equal", adjustable="datalim" if narrow else "box")
            ax.grid(False)
            ax.set_ylabel("height [m]")
            if narrow:
                ax.set_xlabel("along the walls [m]")
            ax.set_title(f"event {event[k]}, base shear {load[k] / 1e3:.4g} kN")
        if not narrow:
            axes[-1].set_xlabel("distance along the walls, from the start of each [m]")
        fig.colorbar(drawn, ax=list(axes), label="crack width [mm]", shrink=0.7, pad=0.01)
        return style.save(fig, folder, f"{name}{_suffix(prefix)}-walls"), (
            "Cracks on the walls (side by side) at the greatest base shear and at the end. At each point the "
            "widest crack through the thickness is drawn. Colour and line width show the crack width."
        )


def _frame(x: float, length: float, height: float) -> Rectangle:
    return Rectangle((x, 0.0), length, height, fill=False, edgecolor=style.EDGE, linewidth=0.7)


def _areas(node: np.ndarray, walls: list[tuple[int, np.ndarray]]) -> np.ndarray:
    every = all(wall < 0 for wall, _ in walls)  # a vault
    c = np.concatenate([node[connect[:, :3]] for wall, connect in walls if every or wall >= 0])
    return np.linalg.norm(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]), axis=1)


def _from_above(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    """Cracks of a vault at the greatest load and at the end on its plan: red at the extrados, blue at the intrados."""
    node, at = run.array(name, "node"), run.array(name, "place_xyz")
    width, angle = run.array(name, f"{prefix}state_width"), run.array(name, f"{prefix}state_angle")
    side = run.array(name, f"{prefix}state_side")
    x_axis, y_axis = run.array(name, "place_x_axis"), run.array(name, "place_y_axis")
    shown = _shown(run, name, prefix)
    most = max(float(width[shown].max()), 1e-12)
    length = 0.7 * np.sqrt(np.median(_areas(node, _walls(run, name))))
    extent = np.ptp(node[:, :2], axis=0)
    tall = float(np.clip(5.0 * extent[1] / extent[0], 1.2, 5.0))
    with style.canvas(5.4 * len(shown) + 0.4, tall + 1.7) as fig:
        for ax, k in zip(fig.subplots(1, len(shown), squeeze=False).ravel(), shown, strict=True):
            for _, connect in _walls(run, name):
                ax.add_collection(PolyCollection(node[connect][..., :2], facecolors="white", edgecolors="#ddd8cc", linewidths=0.3))
            seen = np.flatnonzero(width[k] > LEAST_WIDTH * most)
            seen = seen[np.argsort(width[k][seen])]
            way = np.cos(angle[k][seen, None]) * y_axis[seen] - np.sin(angle[k][seen, None]) * x_axis[seen]
            ends = np.stack([at[seen] - 0.5 * length * way, at[seen] + 0.5 * length * way], axis=1)[..., :2]
            ax.add_collection(
                LineCollection(
                    list(ends), colors=[OUTSIDE if s > 0.0 else INSIDE for s in side[k][seen]], linewidths=0.5 + 2.2 * width[k][seen] / most
                )
            )
            ax.autoscale_view()
            ax.margins(0.04)
            ax.set_aspect("equal")
            ax.grid(False)
            ax.set_xlabel("x [m]")
            ax.set_ylabel("y [m]")
            if extent[1] < 0.1 * extent[0]:  # no room for two numbers one above the other
                top = float(node[:, 1].max())
                ax.set_yticks([top], [f"{top:.3g}"])
            ax.set_title(_state_word(run, name, prefix, k))
        marks = [Line2D([], [], color=color, linewidth=2.0) for color in (OUTSIDE, INSIDE)]
        fig.legend(
            marks,
            ["widest towards the extrados", "widest towards the intrados"],
            loc="outside lower center",
            ncols=2,
            title=f"cracks, up to {1e3 * most:.3g} mm wide",
        )
        return style.save(fig, folder, f"{name}{_suffix(prefix)}-plan"), (
            "Cracks seen from above, at the greatest load and at the end. At each point the widest crack through the thickness is "
            "drawn. Red: widest at the extrados. Blue: widest at the intrados. The line width is proportional to the crack width."
        )


def _state_word(run: Stored, name: str, prefix: str, k: int) -> str:
    """Where a state is on its curve."""
    if getattr(_numbers(run, name, prefix), "of", "push") == "settlement":
        event = run.array(name, f"{prefix}state_event")[k]
        return f"ground moved by {1e3 * run.array(name, f'{prefix}event_displacement')[event - 1]:.3g} mm"
    return f"base shear {run.array(name, f'{prefix}state_load')[k] / 1e3:.4g} kN"


def _space(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    """The deformed building at the peak and at the end, crack widths in colour, from two corners."""
    node = run.array(name, "node")
    width, element = run.array(name, f"{prefix}state_width"), run.array(name, "place_element")
    moved = run.array(name, f"{prefix}state_displacement")
    shown = _shown(run, name, prefix)
    most = max(float(width[shown].max()), 1e-12)
    factor = _magnified(node, moved[shown])
    axes_of = VIEW.axes
    with style.canvas(5.2 * len(shown) + 0.8, 5.0) as fig:
        panels = fig.subplots(1, len(shown), squeeze=False).ravel()
        for ax, k in zip(panels, shown, strict=True):
            place = (node + factor * moved[k]) @ axes_of.T
            values = np.zeros(int(element.max()) + 1)
            np.maximum.at(values, element, width[k])
            drawn = _paint(ax, run, name, place, 1e3 * values, 1e3 * most)
            ax.set_title(_state_word(run, name, prefix, k))
        fig.colorbar(drawn, ax=list(panels), label="crack width [mm]", shrink=0.7)
        return style.save(fig, folder, f"{name}{_suffix(prefix)}-space"), (
            f"The building at the greatest base shear and at the end, with displacements magnified {factor:g} times. The widest crack "
            "of each element is drawn. The fields are in the VTU files, for ParaView."
        )


def _paint(ax: Axes, run: Stored, name: str, place: np.ndarray, values: np.ndarray, most: float) -> PolyCollection:
    """Elements from the farthest to the nearest; place: (nodes, 3) to the right, up, towards the eye."""
    polygons, depth, value, walls = [], [], [], 0
    bends = [bool(part.numbers[0]) for part in run.series(name, "bends")]
    for bent, (_, connect) in zip(bends, _walls(run, name), strict=True):
        corner = place[connect]
        polygons += list(corner[..., :2])
        depth.append(corner[..., 2].mean(axis=1))
        count = len(connect)
        value.append(values[walls : walls + count] if bent else np.full(count, np.nan))
        walls += count if bent else 0
    order = np.argsort(np.concatenate(depth), kind="stable")
    shade = np.concatenate(value)[order]
    norm = Normalize(0.0, most)
    colors = CRACKS(norm(np.nan_to_num(shade)))
    colors[np.nan_to_num(shade) <= LEAST_WIDTH * most] = (0.97, 0.95, 0.91, 1.0)
    colors[np.isnan(shade)] = (*[int(FLOOR[i : i + 2], 16) / 255 for i in (1, 3, 5)], 0.65)
    drawn = PolyCollection([polygons[k] for k in order], facecolors=colors, edgecolors="#c9c2b4", linewidths=0.2)
    ax.add_collection(drawn)
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    scale = PolyCollection([], cmap=CRACKS, norm=norm)
    scale.set_array(np.empty(0))
    return scale


def _magnified(node: np.ndarray, moved: np.ndarray) -> float:
    """A round factor that makes the largest displacement about a twentieth of the building."""
    most = float(np.linalg.norm(moved, axis=-1).max())
    if not most > 0.0:
        return 1.0
    exact = 0.05 * float(np.ptp(node, axis=0).max()) / most
    power = 10.0 ** np.floor(np.log10(exact))
    return float(max(v for v in (1.0, 2.0, 5.0) if v * power <= exact or v == 1.0) * power)


def _storeys(run: Stored, name: str, folder: Path, prefix: str) -> tuple[str, str]:
    """Drifts of the storeys, what walls carry, and damage by storey at the greatest base shear."""
    numbers = _numbers(run, name, prefix)
    level = run.array(name, "level")
    with style.figure(9.0, 3.4, columns=3) as (fig, axes):
        middle = 0.5 * (level[1:] + level[:-1])
        drift = [np.nan if v is None else 100 * v for v in numbers.storey_drifts]
        for ax in axes:
            ax.set_axisbelow(True)
        if drift:
            axes[0].barh(middle, drift, height=0.5 * np.diff(level), color=style.HINGE)
        axes[0].set_xlabel("drift of the storey [%]")
        axes[0].set_ylabel("height [m]")
        rows = numbers.walls
        y = np.arange(len(rows))
        axes[1].barh(y, [100 * row.share for row in rows], height=0.5, color=style.THRUST, label="at the greatest")
        axes[1].plot([100 * row.elastic_share for row in rows], y, "|", color="black", markersize=12, label="uncracked")
        axes[1].set_yticks(y, [f"wall {row.wall}" for row in rows])
        axes[1].invert_yaxis()
        axes[1].set_xlabel("share of the base shear carried in the plane of the wall [%]")
        axes[1].legend()
        damage = numbers.cracked_points_by_storey
        if damage:
            axes[2].barh(np.arange(1, len(damage) + 1), damage, height=0.5, color=LOST)
            axes[2].set_yticks(np.arange(1, len(damage) + 1))
        axes[2].set_xlabel("cracked places in the walls")
        axes[2].set_ylabel("storey")
        return style.save(fig, folder, f"{name}{_suffix(prefix)}-storeys"), (
            "At the greatest base shear: drift of each storey, share of the base shear that each wall "
            "carries in its plane (black: before cracking), and number of cracked places in each storey."
        )
