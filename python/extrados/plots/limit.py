"""Figures of limit analysis: section, thrust lines, hinges, mechanisms, force polygons, capacity curves."""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from extrados.plots import animation, style
from extrados.results.limit import Hinge, MovingLoad, Tilt
from extrados.results.store import Stored

MOST_LETTERED = 26  # hinges: more are dots
MOST_FLOW = 3.0  # points: width of the greatest force between stones
MOST_OPENINGS = 12  # openings that are written beside their joints
HATCH = "#cfc6b2"
LONG = 0.5  # height over length: below it section and mechanism stand one over the other
MOST_LETTERS = 8  # hinges of a moving load: letters of more would run into each other
FILL, PAVED, EVEN = "#f3ead6", "#b9b4aa", "#c98a2b"
TIE, LOAD = "#2b5d8a", "#333333"
MOST_TIES_TOLD = 12  # ties whose forces are written beside them
CHAIN_COLOURS = (style.THRUST, style.HINGE, style.GROUND, "#8a5a00", "#6a3d8f", "#444444")


def paths(run: Stored, name: str, what: str) -> dict[str, np.ndarray]:
    """Packed paths by their names; points of one path together."""
    points, start, names = (run.array(name, what + end) for end in ("", "_start", "_of"))
    return {str(n): points[a:b] for n, a, b in zip(names, start[:-1], start[1:], strict=True)}


def outlines(run: Stored, name: str, what: str = "outline") -> list[np.ndarray]:
    """Outlines of the blocks of an analysis."""
    vertices, start = run.array(name, what), run.array(name, what + "_start")
    return [vertices[a:b] for a, b in itertools.pairwise(start)]


def carried(blocks: list[np.ndarray], centroid: np.ndarray, pose: np.ndarray) -> list[np.ndarray]:
    """Outlines carried to poses x, y, rotation of their centroids."""
    found = []
    for outline, c, (x, y, turn) in zip(blocks, centroid, pose, strict=True):
        cos, sin = np.cos(turn), np.sin(turn)
        found.append((outline - c) @ np.array([[cos, sin], [-sin, cos]]) + (x, y))
    return found


def stone(ax: Axes, blocks: list[np.ndarray], *, ghost: bool = False) -> None:
    """Blocks as hatched stone, or as dotted outlines where only their former place is meant."""
    if ghost:
        ax.add_collection(
            PolyCollection(blocks, facecolors="none", edgecolors=style.EDGE, linewidths=0.4, linestyles=":")
        )
    else:
        ax.add_collection(
            PolyCollection(blocks, facecolors=style.STONE, edgecolors=HATCH, hatch="////", linewidths=0.0, zorder=1)
        )
        width = 0.6 if len(blocks) < 200 else 0.25
        ax.add_collection(
            PolyCollection(blocks, facecolors="none", edgecolors=style.EDGE, linewidths=width, zorder=1.5)
        )
    ax.autoscale_view()


def ground(ax: Axes, run: Stored, name: str, joints: list[int]) -> None:
    """The supports: a stroke under each joint on the ground."""
    p, q = run.array(name, "joint_p"), run.array(name, "joint_q")
    for j in joints:
        ax.plot(*np.array([p[j], q[j]]).T, color=style.EDGE, linewidth=2.2, solid_capstyle="butt", zorder=2)


def resting(ax: Axes, run: Stored, name: str, blocks: list[np.ndarray]) -> None:
    """Loads at rest as arrows, as long as they are great, each with its force; nothing without them."""
    if "load_point" not in run.arrays[name]:
        return
    points, forces, number = (run.array(name, f"load_{what}") for what in ("point", "force", "number"))
    length = 0.1 * float(np.ptp(np.concatenate(blocks), axis=0).max()) / float(np.hypot(*forces.T).max())
    for k in np.unique(number):
        here = number == k
        for point, force in zip(points[here], forces[here], strict=True):
            ax.annotate(
                "", point, point - length * force, zorder=6,
                arrowprops={"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0},
            )  # fmt: skip
        tails = points[here] - length * forces[here]
        ax.update_datalim(tails)
        style.letters(ax, tails[[len(tails) // 2]], [f"{np.hypot(*forces[here].sum(axis=0)) / 1e3:.3g} kN"], LOAD)
    ax.plot([], [], color=LOAD, marker=">", markersize=4, label="load at rest")


def ties(ax: Axes, run: Stored, name: str, state: str, pose: np.ndarray | None = None) -> None:
    """Ties, struts and springs with their forces in a state, dashed where they are slack; nothing without them.

    pose (blocks, 3): where the stones have gone; the ties follow them, and tell no forces.
    """
    forces = f"{state}_tie_force"
    if forces not in run.arrays[name]:
        return
    ends, force = run.array(name, "tie_point"), run.array(name, forces)
    if pose is not None:
        ends = np.stack(
            [_moved(run, name, ends[:, k], run.array(name, "tie_block")[:, k], pose) for k in (0, 1)], axis=1
        )
    taut = np.abs(force) > 1e-6 * max(float(np.abs(force).max(initial=0.0)), 1e-300)
    for k, (one, two) in enumerate(ends):
        ax.plot(
            *np.array([one, two]).T, "-o" if taut[k] else "--o", color=TIE, linewidth=1.3, markersize=3, zorder=4,
            label="tie" if k == 0 else "_",
        )  # fmt: skip
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
    return f"{force / 1e3:.3g} kN" if force > 0.0 else f"{-force / 1e3:.3g} kN pressed"


def dimension(ax: Axes, one: tuple[float, float], two: tuple[float, float], text: str) -> None:
    """A dimension line with arrows at both ends and its length beside it."""
    ax.annotate(
        "",
        one,
        two,
        arrowprops={"arrowstyle": "<->", "linewidth": 0.7, "color": style.EDGE, "shrinkA": 0, "shrinkB": 0},
    )
    upright = abs(one[0] - two[0]) < abs(one[1] - two[1])
    ax.annotate(
        text, (0.5 * (one[0] + two[0]), 0.5 * (one[1] + two[1])), textcoords="offset points",
        xytext=(-5, 0) if upright else (0, 3), ha="right" if upright else "center", va="center" if upright else "bottom",
        fontsize=7, color=style.EDGE, rotation=90 if upright else 0,
    )  # fmt: skip


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
    (most_left, lowest), (most_right, highest) = (
        getattr(np.concatenate([points, others]), end)(axis=0) for end in ("min", "max")
    )
    ax.set_xlim(min(left - 2.6 * away, most_left - away), max(right, most_right) + 1.2 * away)
    ax.set_ylim(min(low - 2.0 * away, lowest - away), max(high, highest) + 1.2 * away)


def thrust_lines(ax: Axes, run: Stored, name: str, state: str, colour: str, label: str) -> None:
    """The thrust line of a state through every stone: where there are arches or stacks of one width, but for branches
    within a stone, which share it as they press; else as wide everywhere as it presses."""
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
        LineCollection(
            [lines[k] for k in shown], linewidths=width[shown], colors=colour, capstyle="round", zorder=3, label=label
        )
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


def _standing(run: Stored, name: str) -> list[int]:
    return [reaction.joint for reaction in run[name].reactions]


def draw_tilt(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Section at collapse, mechanism, force polygon; thrust upright; monolithic beside fractured."""
    animation.draw_tilt(run, name, folder)
    r = run[name]
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    points = np.concatenate(blocks)
    tall = float(np.ptp(points[:, 1]) / max(np.ptp(points[:, 0]), 1e-9))
    height = float(np.clip(3.4 * tall + 1.2, 3.6, 7.0))
    polygons = paths(run, name, "collapse_polygon")
    with style.figure(12.5 if polygons else 9.0, height, columns=3 if polygons else 2) as (fig, axes):
        earth(axes[0], run, name)
        stone(axes[0], blocks)
        ground(axes[0], run, name, _standing(run, name))
        thrust_lines(axes[0], run, name, "collapse", style.THRUST, "thrust line")
        ties(axes[0], run, name, "collapse")
        resting(axes[0], run, name, blocks)
        if polygons:
            funiculars(axes[0], run, name, "collapse")
            style.legend_below(fig, axes[0])
        hinge_marks(axes[0], r.hinges)
        overall_dimensions(axes[0], blocks, beside(run, name, axes[0]))
        axes[0].set_title(f"Collapse at {r.collapse_acceleration_g:.4f} g to +x (tilt {r.tilt_angle_deg:.2f} deg)")
        stone(axes[1], blocks, ghost=True)
        stone(axes[1], carried(blocks, centroid, run.array(name, "mechanism_pose")))
        ties(axes[1], run, name, "collapse", run.array(name, "mechanism_pose"))
        axes[1].set_title("Mechanism (finite rotations)")
        for ax in axes[:2]:
            style.section_axes(ax)
        if polygons:
            polygon(axes[2], polygons)
            axes[2].set_title("Force polygon at collapse")
        found = [(style.save(fig, folder, f"{name}-collapse"), _caption(r))]
    if "least_line" in run.arrays[name]:
        with style.figure(10.0, height, columns=2, width_ratios=[1.3, 1]) as (fig, (ax, forces)):
            earth(ax, run, name)
            stone(ax, blocks)
            ground(ax, run, name, _standing(run, name))
            thrust_lines(ax, run, name, "least", style.THRUST, f"least thrust {_per_metre(r, r.thrust_min_N)}")
            thrust_lines(ax, run, name, "most", style.HINGE, f"greatest thrust {_per_metre(r, r.thrust_max_N)}")
            ties(ax, run, name, "least")
            style.legend_below(fig, ax)
            ax.set_title("Thrust lines upright")
            style.section_axes(ax)
            first = next(iter(r.thrusts))
            polygon(forces, {
                f"least, {first}": paths(run, name, "least_polygon")[first],
                f"greatest, {first}": paths(run, name, "most_polygon")[first],
            }, (style.THRUST, style.HINGE))  # fmt: skip
            forces.set_title("Force polygons upright")
            found.append(
                (
                    style.save(fig, folder, f"{name}-upright"),
                    "Thrust lines of least and greatest horizontal thrust under self-weight, and their force polygons.",
                )
            )
    if r.fracture and r.fracture.cracks:
        found.append(_draw_fracture(run, name, folder, blocks, centroid, height))
    return found


def _per_metre(r: Tilt, force: float) -> str:
    return f"{force / r.depth_m / 1e3:.4g} kN/m"


def _caption(r: Tilt) -> str:
    letters = "; ".join(f"{chr(65 + i)} {h.told()}" for i, h in enumerate(r.hinges[:MOST_LETTERED]))
    free = (
        " Where the line is not fixed by the mechanism its most central course is drawn."
        if len(r.thrusts or {}) > 1
        else ""
    )
    return f"Thrust line, hinges and mechanism under the greatest constant acceleration. Hinges: {letters}.{free}"


def _draw_fracture(run: Stored, name: str, folder: Path, blocks, centroid, height: float) -> tuple[str, str]:
    r = run[name]
    f = r.fracture
    with style.figure(9.5, height, columns=2) as (fig, (whole, cracked)):
        stone(whole, blocks, ghost=True)
        stone(whole, carried(blocks, centroid, run.array(name, "mechanism_pose")))
        whole.set_title(f"Monolithic: {r.collapse_acceleration_g:.4f} g ({r.tilt_angle_deg:.2f} deg)")
        stone(cracked, blocks, ghost=True)
        stone(
            cracked,
            carried(
                outlines(run, name, "crack_outline"), run.array(name, "crack_centroid"), run.array(name, "crack_pose")
            ),
        )
        cracked.plot(
            *run.array(name, "crack").T, "--", color=style.HINGE, linewidth=1.4, zorder=4, label="fracture line"
        )
        cracked.legend(loc="lower center")
        cracked.set_title(f"Buttress cracked: {f.collapse_acceleration_g:.4f} g ({f.tilt_angle_deg:.2f} deg)")
        for ax in (whole, cracked):
            style.section_axes(ax)
        return (
            style.save(fig, folder, f"{name}-fracture"),
            f"Mechanisms with the buttress whole and cracked; the crack starts {f.crack_height_m:.2f} m above the base, the wedge below it stays.",
        )


def draw_thrust(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The three lines and their force polygons; friction needed along the joints."""
    r = run[name]
    blocks = outlines(run, name)
    colours = {"least": style.THRUST, "central": "#444444", "most": style.HINGE}
    lines_of = {which: line for which in colours if (line := getattr(r, which)) is not None}
    colours = {which: colours[which] for which in lines_of}
    arched = r.chain is not None
    sizes = {"width": 12.0, "columns": 2, "width_ratios": [1.4, 1]} if arched else {"width": 6.0}
    with style.figure(sizes.pop("width"), 4.6, **sizes) as (fig, (ax, *others)):
        earth(ax, run, name)
        stone(ax, blocks)
        ground(ax, run, name, [reaction.joint for reaction in (r.central or r.least).reactions])
        for which, colour in colours.items():
            label = f"{which}: {r[which]['horizontal_kN_per_m']:.4g} kN/m" if arched else f"{which} state"
            thrust_lines(ax, run, name, which, colour, label)
        resting(ax, run, name, blocks)
        ties(ax, run, name, "central" if r.central is not None else "least")
        overall_dimensions(ax, blocks, beside(run, name, ax))
        style.legend_below(fig, ax)
        safety = r.geometric_safety_factor
        told = f", safety factor {safety:.2f}" if safety is not None and np.isfinite(safety) else ""
        ax.set_title(f"{'Thrust lines' if arched else 'Thrust line'} at {r['gamma_g']:g} g{told}")
        style.section_axes(ax)
        for forces in others:
            polygons = {which: paths(run, name, f"{which}_polygon")[r.chain] for which in colours}
            polygon(forces, polygons, tuple(colours.values()))
            forces.set_title(f"Force polygons of the {r['chain']}")
        caption = "Thrust lines of least, greatest and most central thrust, and their force polygons."
        if not arched:
            caption = "The most central state: the thrust line through every stone, as wide as it presses."
        found = [(style.save(fig, folder, f"{name}-lines"), caption)]
    with style.figure(7.5, 3.4) as (fig, (ax,)):
        for which, colour in colours.items():
            ax.plot(run.array(name, f"{which}_friction"), color=colour, marker=".", markersize=3, label=which)
        ax.set_ylim(bottom=0.0)
        style.numbers(ax.xaxis)
        ax.set_xlabel("joint")
        ax.set_ylabel("friction needed")
        ax.legend()
        found.append((style.save(fig, folder, f"{name}-friction"), "Coefficient of friction needed at each joint."))
    return found


def draw_sweep(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Capacity curve with numbered mechanisms, and one section of each mechanism."""
    r = run[name]
    value, gamma, number = run.array(name, "value"), run.array(name, "gamma"), run.array(name, "mechanism")
    tilt = np.degrees(np.arctan(gamma))
    with style.figure(7.5, 4.2) as (fig, (ax,)):
        ax.plot(value, tilt, "-", color=style.EDGE, linewidth=1.0, zorder=2)
        for k in range(1, int(number.max()) + 1):
            here = number == k
            ax.plot(
                value[here],
                tilt[here],
                "o",
                markersize=3.5,
                color=CHAIN_COLOURS[(k - 1) % len(CHAIN_COLOURS)],
                label=f"mechanism {k}",
                zorder=3,
            )
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
                f"{change.before or 'falls'}|{change.after or 'falls'}", (change.value, 1.0), xycoords=("data", "axes fraction"),
                ha="center", va="bottom", fontsize=7,
            )  # fmt: skip
        ax.plot(
            r.optimum_value,
            r.optimum_tilt_angle_deg,
            "*",
            color="black",
            markersize=9,
            zorder=4,
            label=f"greatest: {r.optimum_value:.4g}",
        )
        for gap in r.gaps:
            ax.plot(gap.value, 0.0, "x", color=style.THRUST, markersize=4)
        ax.set_ylim(bottom=0.0)
        ax.set_xlabel(f"{r.vary} [{r.unit}]" if r.unit else r.vary)
        ax.set_ylabel("tilt at collapse [deg]")
        ax.legend(loc="best")
        found = [
            (
                style.save(fig, folder, f"{name}-curve"),
                "Tilt at collapse; dotted: changes of mechanism; crosses: values without a structure that stands.",
            )
        ]
    if len(run.array(name, "example")):
        examples, moved = (list(paths(run, name, what).values()) for what in ("example", "example_moved"))
        of = run.array(name, "example_mechanism")
        numbers = np.unique(of)[:6]
        with style.figure(3.4 * len(numbers), 3.8, columns=len(numbers)) as (fig, axes):
            for ax, k in zip(axes, numbers, strict=True):
                stone(ax, [examples[i] for i in np.flatnonzero(of == k)], ghost=True)
                stone(ax, [moved[i] for i in np.flatnonzero(of == k)])
                ax.set_title(f"Mechanism {k}")
                style.section_axes(ax)
            found.append(
                (
                    style.save(fig, folder, f"{name}-mechanisms"),
                    "; ".join(f"{m.number}: {m.hinges}" for m in r.mechanisms[:6]),
                )
            )
    return found


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
            ax.set_ylabel("share of sections at or below")
        return [(style.save(fig, folder, name), "Collapse acceleration of the sections that stand.")]


def draw_imperfections(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Capacities of the random surveys: how many bear at most how much, the band, and the survey that is given."""
    r = run[name]
    gamma = run.array(name, "gamma")
    lesser = np.sort(np.nan_to_num(gamma.min(axis=1), nan=0.0))
    with style.figure(7.5, 3.8) as (fig, (ax,)):
        share = np.arange(1, len(lesser) + 1) / len(lesser)
        ax.axvspan(
            r.low_collapse_acceleration_g, r.high_collapse_acceleration_g, color=style.STONE, zorder=0,
            label=f"nine in ten: {r.low_collapse_acceleration_g:.4f} to {r.high_collapse_acceleration_g:.4f} g",
        )  # fmt: skip
        ax.step(
            lesser,
            share,
            where="post",
            color=style.THRUST,
            label=f"{r.count} surveys within {1e3 * r.deviation_m:.3g} mm",
        )
        given = r.given_collapse_acceleration_g
        ax.axvline(given, color=style.HINGE, linestyle="--", label=f"as given: {given:.4f} g")
        ax.set_xlabel("collapse acceleration, the lesser of both senses [g]")
        ax.set_ylabel("share of surveys at or below")
        ax.set_ylim(0.0, 1.0)
        ax.set_title("Capacity within the tolerance of the survey")
        style.legend_below(fig, ax)
        return [(style.save(fig, folder, name), "Capacities of random surveys of the same stones.")]


def draw_supports(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The arch on the way to its fall, and how the thrust changes; of any structure, the joints that open."""
    animation.draw_supports(run, name, folder)
    r = run[name]
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    if "settled_pose" in run.arrays[name]:
        return [_draw_settled(run, name, folder, blocks, centroid)]
    movement, pose, points = (run.array(name, f"shown_{what}") for what in ("movement", "pose", "point"))
    with style.figure(11.0, 5.6, rows=2, columns=3) as (fig, axes):
        for ax in axes[len(movement) :]:
            ax.set_axis_off()
        for ax, u, at, line in zip(axes, movement, pose, points, strict=False):
            stone(ax, carried(blocks, centroid, at))
            ax.plot(*line.T, color=style.THRUST, zorder=3)
            ax.set_title(f"{u:.3f} m")
            style.section_axes(ax)
        found = [
            (
                style.save(fig, folder, f"{name}-states"),
                "The arch as its right support moves (true scale), with the thrust line through its three hinges.",
            )
        ]
    with style.figure(7.5, 3.4) as (fig, (ax,)):
        u, force = run.array(name, "movement"), run.array(name, "force")
        ax.plot(u, force[:, 0] / 1e3, color=style.THRUST, label="horizontal")
        ax.plot(u, -force[:, 1] / 1e3, color=style.HINGE, label="vertical")
        for stage in r.stages[1:]:
            ax.axvline(stage.movement_m, color=style.EDGE, linestyle=":", linewidth=0.7)
        ax.set_xlabel("movement of the right support [m]")
        ax.set_ylabel("force on it [kN]")
        ax.legend()
        found.append(
            (
                style.save(fig, folder, f"{name}-thrust"),
                "Force of the arch on the moving support; dotted: a hinge moves.",
            )
        )
    return found


def _draw_settled(run: Stored, name: str, folder: Path, blocks, centroid) -> tuple[str, str]:
    """The structure before and after its supports gave way, magnified, with the widest openings in mm."""
    r, pose = run[name], run.array(name, "settled_pose")
    place = np.column_stack([centroid, np.zeros(len(centroid))])
    size = float(np.ptp(np.concatenate(blocks), axis=0).max())
    raw = 0.05 * size / max(float(np.hypot(*(pose - place)[:, :2].T).max()), 1e-300)
    power = 10.0 ** np.floor(np.log10(raw))
    factor = max(1.0, power * max(step for step in (1.0, 2.0, 5.0) if step * power <= raw * (1.0 + 1e-9)))
    moved = place + factor * (pose - place)
    openings = run.array(name, "settled_opening")
    p, q = run.array(name, "joint_p"), run.array(name, "joint_q")
    with style.figure(7.5, 5.2) as (fig, (ax,)):
        stone(ax, blocks, ghost=True)
        stone(ax, carried(blocks, centroid, moved))
        ties(ax, run, name, "settled", moved)
        sides = run.array(name, "joint_block")
        for o in [o for o in r.openings if o.opening_mm > 0.0][:MOST_OPENINGS]:
            end = (p if openings[o.joint, 0] > openings[o.joint, 1] else q)[o.joint]
            block = int(sides[o.joint].max())
            cos, sin = np.cos(moved[block, 2]), np.sin(moved[block, 2])
            arm = end - centroid[block]
            at = moved[block, :2] + (cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1])
            other = (q if end is p[o.joint] or np.array_equal(end, p[o.joint]) else p)[o.joint]
            away = (end - other) / max(float(np.hypot(*(end - other))), 1e-300)
            ax.annotate(
                f"{o.opening_mm:.3g} mm", at, textcoords="offset points", xytext=tuple(22.0 * away), ha="center",
                va="center", fontsize=7, color=style.HINGE,
                arrowprops={"arrowstyle": "-", "linewidth": 0.6, "color": style.HINGE},
            )  # fmt: skip
        ax.set_title(f"Supports that give way: movements and openings {factor:g} times as large")
        style.section_axes(ax)
        ax.margins(0.12)  # room for the openings beside the outermost stones
        return (
            style.save(fig, folder, f"{name}-openings"),
            f"Where supports give way joints open; movements and openings are drawn {factor:g} times as large, dotted: before.",
        )


def earth(ax: Axes, run: Stored, name: str) -> None:
    """Fill and surfacing over the stones, where there are any."""
    for what, colour in (("fill_outline", FILL), ("surfacing_outline", PAVED)):
        if what in run.arrays[name]:
            ax.fill(*run.array(name, what).T, facecolor=colour, edgecolor=style.EDGE, linewidth=0.4, zorder=0.5)


def road_of(run: Stored, name: str, blocks: list[np.ndarray]) -> float:
    """Level at which loads stand [m]: the top of the surfacing, the fill or the stones."""
    tops = [run.array(name, what) for what in ("fill_outline", "surfacing_outline") if what in run.arrays[name]]
    return max(float(o[:, 1].max()) for o in [*blocks, *tops])


def _load_marks(ax: Axes, run: Stored, name: str, blocks: list[np.ndarray], size: float) -> None:
    """Axles as arrows and even loads as bands, on the road, or on the stones where there is no fill."""
    paved = any(what in run.arrays[name] for what in ("fill_outline", "surfacing_outline"))
    road = road_of(run, name, blocks)
    for x in run.array(name, "axle"):
        y = road if paved else _surface(blocks, float(x), road)
        ax.annotate("", (x, y), (x, y + 0.12 * size), arrowprops={"arrowstyle": "-|>", "color": style.THRUST}, zorder=6)
    for i, (start, stop) in enumerate(run.array(name, "even_load")):
        x = np.linspace(start, stop, 60)
        y = np.full(len(x), road) if paved else np.array([_surface(blocks, float(one), road) for one in x])
        ax.fill_between(
            x, y, y + 0.03 * size, color=EVEN, alpha=0.7, linewidth=0.0, zorder=4, label="even load" if i == 0 else "_"
        )


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
                "", (x, y), (x - 0.08 * size * f / greatest, y), zorder=5,
                arrowprops={"arrowstyle": "->", "color": style.GROUND, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
            )  # fmt: skip
    ax.plot([], [], color=style.GROUND, label="passive pressure")


def _zones(ax: Axes, run: Stored, name: str, links: list[np.ndarray]) -> None:
    """Zones of thrust along the chains: what of the joints the strength needs to carry the compression."""
    if "zone_inner" not in run.arrays[name]:
        return
    inner, outer = run.array(name, "zone_inner"), run.array(name, "zone_outer")
    for i, joints in enumerate(links):
        band = np.concatenate([inner[joints], outer[joints][::-1]])
        ax.fill(
            *band.T,
            color=style.THRUST,
            alpha=0.35,
            linewidth=0.0,
            zorder=2.5,
            label="zone of thrust" if i == 0 else "_",
        )


def draw_moving_load(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The worst place with its thrust line, the mechanism, and the capacity over place."""
    r = run[name]
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    place, size = run.array(name, "place"), float(np.ptp(np.concatenate(blocks)[:, 0]))
    road = road_of(run, name, blocks)
    start, joints = run.array(name, "chain_start"), run.array(name, "chain_joint")
    links = [joints[a:b] for a, b in itertools.pairwise(start)]
    point, envelope = run.array(name, "collapse_point"), run.array(name, "envelope_point")
    tall = (road - min(float(o[:, 1].min()) for o in blocks)) / size + 0.15
    long = tall < LONG
    height = float(np.clip((19.0 if long else 5.6) * tall + 1.5, 3.2, 8.0))
    with style.figure(9.0 if long else 11.5, height, rows=1 + long, columns=2 - long) as (fig, (ax, moved)):
        earth(ax, run, name)
        stone(ax, blocks)
        for i, link in enumerate(links):
            rows = envelope[:, link]
            ax.add_collection(LineCollection(
                rows[np.isfinite(rows).all(axis=(1, 2))], colors=style.EDGE, linewidths=0.25, alpha=0.5, zorder=2.2,
                label="thrust lines, all places" if i == 0 else "_",
            ))  # fmt: skip
        thrust_lines(ax, run, name, "collapse", style.THRUST, "thrust line")
        _zones(ax, run, name, links)
        _pushes(ax, run, name, size)
        ties(ax, run, name, "collapse")
        resting(ax, run, name, blocks)
        _load_marks(ax, run, name, blocks, size)
        hinged = [h.joint for h in r.hinges]
        lettered = len(hinged) <= MOST_LETTERS
        style.draw_hinges(ax, point[hinged], [chr(65 + i) for i in range(len(hinged))] if lettered else None)
        ax.set_title(f"Collapse at the worst place: {_borne(r)}")
        if ax.get_legend_handles_labels()[0]:
            style.legend_below(fig, ax)
        earth(moved, run, name)
        stone(moved, blocks, ghost=True)
        stone(moved, carried(blocks, centroid, run.array(name, "mechanism_pose")))
        ties(moved, run, name, "collapse", run.array(name, "mechanism_pose"))
        _load_marks(moved, run, name, blocks, size)
        moved.set_title("Mechanism (finite rotations)")
        for drawn in (ax, moved):
            drawn.set_ylim(top=road + (0.15 if len(run.array(name, "axle")) else 0.06) * size)
            style.section_axes(drawn)
        letters = "; ".join(
            f"{f'{chr(65 + i)} ' if lettered else ''}{h.side} of {h.name}" for i, h in enumerate(r.hinges[:26])
        )
        found = [(
            style.save(fig, folder, f"{name}-worst"),
            f"The most dangerous place: thrust line, hinges and mechanism at collapse. Hinges: {letters or 'none'}.",
        )]  # fmt: skip
    if len(place) == 1:
        return found
    adequacy = "adequacy" in run.arrays[name]
    value = run.array(name, "adequacy") if adequacy else run.array(name, "capacity") / 1e3
    way = run.array(name, "way")
    with style.figure(7.5, 3.6) as (fig, (curve,)):
        for sense, colour, label in ((1, style.THRUST, "heading to +x"), (-1, style.HINGE, "heading to -x")):
            if (way == sense).any():
                curve.plot(
                    place[way == sense], value[way == sense], color=colour, marker=".", markersize=3, label=label
                )
        if (way < 0).any():
            curve.legend()
        if adequacy:
            curve.axhline(1.0, color=style.EDGE, linewidth=0.8, linestyle="--")
        low = float(np.nanmin(value))
        curve.set_ylim(0.0, max(1.1 * low, min(float(np.nanmax(value)) * 1.05, 8.0 * low), 1.1 if adequacy else 0.0))
        curve.set_xlabel("x of the first axle [m]")
        curve.set_ylabel("adequacy factor" if adequacy else "load at collapse [kN]")
        curve.set_title("Adequacy over place" if adequacy else "Load at collapse over place")
        found.append(
            (style.save(fig, folder, f"{name}-places"), "What brings it down, over the place of the first axle.")
        )
    return found


def _borne(r: MovingLoad) -> str:
    load = f"{r.collapse_load_N / 1e3:.4g} kN"
    return load if r.adequacy_factor is None else f"{r.adequacy_factor:.3g} x the load ({load})"
