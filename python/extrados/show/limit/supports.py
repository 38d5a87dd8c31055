"""Figures of moving supports: states of an arch during the movement, and the joints that open."""

from pathlib import Path

import numpy as np

from extrados.results.limit import MovingSupports
from extrados.results.store import Stored
from extrados.show import film, style
from extrados.show.limit import section
from extrados.show.stones import Stones, outlines

MOST_OPENINGS = 12  # openings that are written beside their joints


def draw(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The arch on the way to its fall, and how the thrust changes; of any structure, the joints that open."""
    film_supports(run, name, folder)
    r = run.results_of(name, MovingSupports)
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    if "settled_pose" in run.arrays[name]:
        return [_draw_settled(run, name, folder, blocks, centroid)]
    movement, pose, points = (run.array(name, f"shown_{what}") for what in ("movement", "pose", "point"))
    with style.figure(11.0, 5.6, rows=2, columns=3) as (fig, axes):
        for ax in axes[len(movement) :]:
            ax.set_axis_off()
        for ax, u, at, line in zip(axes, movement, pose, points, strict=False):
            section.stone(ax, section.carried(blocks, centroid, at))
            ax.plot(*line.T, color=style.THRUST, zorder=3)
            ax.set_title(f"{u:.3f} m")
            style.section_axes(ax)
        found = [
            (
                style.save(fig, folder, f"{name}-states"),
                "The arch at several movements of its right support (true scale), with the thrust line through its three hinges.",
            )
        ]
    with style.figure(7.5, 3.4) as (fig, (ax,)):
        u, force = run.array(name, "movement"), run.array(name, "force")
        ax.plot(u, force[:, 0] / 1e3, color=style.THRUST, label="horizontal")
        ax.plot(u, -force[:, 1] / 1e3, color=style.HINGE, label="vertical")
        for stage in r.stages[1:]:
            ax.axvline(stage.movement_m, color=style.EDGE, linestyle=":", linewidth=0.7)
        ax.set_xlabel("movement of the right support [m]")
        ax.set_ylabel("force on the support [kN]")
        ax.legend()
        found.append(
            (
                style.save(fig, folder, f"{name}-thrust"),
                "Force of the arch on the moving support. At dotted lines, a hinge moves to another joint.",
            )
        )
    return found


def _draw_settled(run: Stored, name: str, folder: Path, blocks: list[np.ndarray], centroid: np.ndarray) -> tuple[str, str]:
    """The structure before and after its supports gave way, magnified, with the widest openings in mm."""
    r, pose = run.results_of(name, MovingSupports), run.array(name, "settled_pose")
    place = np.column_stack([centroid, np.zeros(len(centroid))])
    size = float(np.ptp(np.concatenate(blocks), axis=0).max())
    raw = 0.05 * size / max(float(np.hypot(*(pose - place)[:, :2].T).max()), 1e-300)
    power = 10.0 ** np.floor(np.log10(raw))
    factor = max(1.0, power * max(step for step in (1.0, 2.0, 5.0) if step * power <= raw * (1.0 + 1e-9)))
    moved = place + factor * (pose - place)
    openings = run.array(name, "settled_opening")
    p, q = run.array(name, "joint_p"), run.array(name, "joint_q")
    with style.figure(7.5, 5.2) as (fig, (ax,)):
        section.stone(ax, blocks, ghost=True)
        section.stone(ax, section.carried(blocks, centroid, moved))
        section.ties(ax, run, name, "settled", moved)
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
                f"{o.opening_mm:.3g} mm",
                at,
                textcoords="offset points",
                xytext=tuple(22.0 * away),
                ha="center",
                va="center",
                fontsize=7,
                color=style.HINGE,
                arrowprops={"arrowstyle": "-", "linewidth": 0.6, "color": style.HINGE},
            )
        ax.set_title(f"Movements and openings magnified {factor:g} times")
        style.section_axes(ax)
        ax.margins(0.12)  # room for the openings beside the outermost stones
        return (
            style.save(fig, folder, f"{name}-openings"),
            f"Openings of joints due to the movement of supports, magnified {factor:g} times. Dotted: before the movement.",
        )


def film_supports(run: Stored, name: str, folder: Path) -> None:
    """The arch follows the movement of its support, with its line of thrust, beside the thrust."""
    kind, speed = film.asked(run, name)
    arrays = run.arrays[name]
    if kind == "none":
        return
    follows = "film_movement" in arrays
    if follows:
        movement, pose = 1e3 * run.array(name, "film_movement"), run.array(name, "film_pose")
    else:
        centroid = run.array(name, "centroid")
        rest = np.column_stack([centroid, np.zeros(len(centroid))])
        share = np.linspace(0.0, 1.0, 60)
        movement, pose = 100.0 * share, rest + share[:, None, None] * (run.array(name, "settled_pose") - rest)
    with style.canvas(film.PIXELS[0] / film.DPI, film.PIXELS[1] / film.DPI) as fig:
        ax, charts = film.axes(fig, 1)
        stones = Stones(run, name, ax)
        film.poses_window(ax, stones, pose)
        (thrust,) = ax.plot([], [], color=style.THRUST, linewidth=1.6, zorder=4, label="line of thrust")
        if follows:
            ax.legend(loc="upper right")
        if follows:
            x, y = 1e3 * run.array(name, "movement"), run.array(name, "force")[:, 0] / 1e3
            charts[0].set_xlabel("movement of the support [mm]")
            charts[0].set_ylabel("thrust [kN]")
        else:
            opening = run.array(name, "settled_opening")[:, :2].max(axis=1)
            x, y = movement, movement / 100.0 * 1e3 * float(opening.max())
            charts[0].set_xlabel("share of the movement [%]")
            charts[0].set_ylabel("widest joint [mm]")
        charts[0].plot(x, y, color=style.HINGE)
        cursor = charts[0].axvline(0.0, color=style.THRUST, linewidth=1.0)
        title = ax.set_title("")

        def draw(k: int) -> None:
            stones.place(pose[k])
            if follows:
                thrust.set_data(*run.array(name, "film_line")[k].T)
            cursor.set_xdata([movement[k], movement[k]])
            title.set_text(f"support moved by {movement[k]:.1f} mm" if follows else f"{movement[k]:.0f} % of the movement")

        frames, rate = film.pictures(np.linspace(0.0, film.LASTS, len(movement)), kind, speed)
        film.write(fig, folder / "figures" / f"{name}.{kind}", kind, rate, frames, draw, [stones.drawn, thrust, cursor, title])
