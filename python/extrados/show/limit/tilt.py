"""Figures of the collapse by a constant acceleration: section, mechanism, force polygons, the cracked buttress."""

from pathlib import Path

import numpy as np

from extrados.results.limit import DILATANT, Tilt
from extrados.results.store import Stored
from extrados.show import film, style
from extrados.show.limit import section
from extrados.show.stones import Stones, outlines, turned, window


def draw(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Section at collapse, mechanism, force polygon; thrust upright; monolithic beside fractured."""
    film_tilt(run, name, folder)
    r = run.results_of(name, Tilt)
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    points = np.concatenate(blocks)
    tall = float(np.ptp(points[:, 1]) / max(np.ptp(points[:, 0]), 1e-9))
    height = float(np.clip(3.4 * tall + 1.2, 3.6, 7.0))
    polygons = section.paths(run, name, "collapse_polygon")
    with style.figure(12.5 if polygons else 9.0, height, columns=3 if polygons else 2) as (fig, axes):
        section.earth(axes[0], run, name)
        section.stone(axes[0], blocks)
        section.ground(axes[0], run, name, section.standing(run, name))
        section.thrust_lines(axes[0], run, name, "collapse", style.THRUST, "thrust line")
        section.ties(axes[0], run, name, "collapse")
        section.resting(axes[0], run, name, blocks)
        if polygons:
            section.funiculars(axes[0], run, name, "collapse")
            style.legend_below(fig, axes[0])
        section.hinge_marks(axes[0], r.hinges)
        section.overall_dimensions(axes[0], blocks, section.beside(run, name, axes[0]))
        axes[0].set_title(_title(r))
        section.stone(axes[1], blocks, ghost=True)
        section.stone(axes[1], section.carried(blocks, centroid, run.array(name, "mechanism_pose")))
        section.ties(axes[1], run, name, "collapse", run.array(name, "mechanism_pose"))
        axes[1].set_title("Mechanism (finite rotations)")
        for ax in axes[:2]:
            style.section_axes(ax)
        if polygons:
            section.polygon(axes[2], polygons)
            axes[2].set_title("Force polygon at collapse")
        found = [(style.save(fig, folder, f"{name}-collapse"), _caption(r))]
    if "least_line" in run.arrays[name]:
        with style.figure(10.0, height, columns=2, width_ratios=[1.3, 1]) as (fig, (ax, forces)):
            section.earth(ax, run, name)
            section.stone(ax, blocks)
            section.ground(ax, run, name, section.standing(run, name))
            section.thrust_lines(ax, run, name, "least", style.THRUST, f"least thrust {_per_metre(r, r.thrust_min_N)}")
            section.thrust_lines(ax, run, name, "most", style.HINGE, f"greatest thrust {_per_metre(r, r.thrust_max_N)}")
            section.ties(ax, run, name, "least")
            style.legend_below(fig, ax)
            ax.set_title("Thrust lines upright")
            style.section_axes(ax)
            first = next(iter(r.thrusts))
            section.polygon(
                forces,
                {
                    f"least, {first}": section.paths(run, name, "least_polygon")[first],
                    f"greatest, {first}": section.paths(run, name, "most_polygon")[first],
                },
                (style.THRUST, style.HINGE),
            )
            forces.set_title("Force polygons upright")
            found.append(
                (
                    style.save(fig, folder, f"{name}-upright"),
                    ("Thrust lines of minimum and maximum horizontal thrust under self-weight, and their force polygons."),
                )
            )
    if r.fracture and r.fracture.cracks:
        found.append(_draw_fracture(run, name, folder, blocks, centroid, height))
    return found


def _per_metre(r: Tilt, force: float) -> str:
    return f"{force / r.depth_m / 1e3:.4g} kN/m"


def _caption(r: Tilt) -> str:
    letters = "; ".join(f"{chr(65 + i)} {h.told()}" for i, h in enumerate(r.hinges[: section.MOST_LETTERED]))
    free = (
        (" The mechanism determines the thrust line in its moving parts only; in the other parts the most central line is drawn.")
        if len(r.thrusts or {}) > 1
        else ""
    )
    slides = f" Joints slide, so the collapse acceleration is an {DILATANT}." if r.dilating_joints else ""
    least = r.collapse_acceleration_non_associated_g if r.dilating_joints else None
    if least is not None:
        slides += f" Without dilatancy, collapse is possible from {least:.4f} g (not drawn)."
        if r.collapse_acceleration_load_path_g is not None:
            slides += f" The analysis by load paths gives the design value {r.collapse_acceleration_load_path_g:.4f} g."
    return f"Thrust line, hinges and mechanism at the collapse acceleration. Hinges: {letters}.{free}{slides}"


def _title(r: Tilt) -> str:
    """The collapse acceleration; where joints slide both ends of its interval."""
    if not r.dilating_joints:
        return f"Collapse at {r.collapse_acceleration_g:.4f} g to +x (tilt {r.tilt_angle_deg:.2f} deg)"
    least = r.collapse_acceleration_non_associated_g
    design = r.collapse_acceleration_load_path_g
    value = "" if design is None else f"{design:.4f} g (design value),\n"
    without = "" if least is None else f"\nwithout dilatancy {value}{least:.4f} g (lowest found)"
    return f"Collapse to +x at or below {r.collapse_acceleration_g:.4f} g\n(dilatant friction: upper bound){without}"


def _draw_fracture(run: Stored, name: str, folder: Path, blocks: list[np.ndarray], centroid: np.ndarray, height: float) -> tuple[str, str]:
    r = run.results_of(name, Tilt)
    f = r.fracture
    with style.figure(9.5, height, columns=2) as (fig, (whole, cracked)):
        section.stone(whole, blocks, ghost=True)
        section.stone(whole, section.carried(blocks, centroid, run.array(name, "mechanism_pose")))
        whole.set_title(f"Monolithic: {r.collapse_acceleration_g:.4f} g ({r.tilt_angle_deg:.2f} deg)")
        section.stone(cracked, blocks, ghost=True)
        section.stone(
            cracked, section.carried(outlines(run, name, "crack_outline"), run.array(name, "crack_centroid"), run.array(name, "crack_pose"))
        )
        cracked.plot(*run.array(name, "crack").T, "--", color=style.HINGE, linewidth=1.4, zorder=4, label="fracture line")
        cracked.legend(loc="lower center")
        cracked.set_title(f"Buttress cracked: {f.collapse_acceleration_g:.4f} g ({f.tilt_angle_deg:.2f} deg)")
        for ax in (whole, cracked):
            style.section_axes(ax)
        return (
            style.save(fig, folder, f"{name}-fracture"),
            (
                f"Mechanisms with the uncracked buttress and with the cracked buttress. The crack begins {f.crack_height_m:.2f} "
                "m above the base. The wedge below the crack does not move."
            ),
        )


def film_tilt(run: Stored, name: str, folder: Path) -> None:
    """The ground is tilted until the lines of least and greatest thrust are one; then the mechanism moves."""
    kind, speed = film.asked(run, name)
    if kind == "none" or "mechanism_pose" not in run.arrays[name]:
        return
    arrays = run.arrays[name]
    centroid = run.array(name, "centroid")
    rest = np.column_stack([centroid, np.zeros(len(centroid))])
    falls = run.array(name, "mechanism_pose")
    last = np.radians(run.results_of(name, Tilt).tilt_angle_deg)
    lines = "film_tilt" in arrays
    tilt = np.radians(run.array(name, "film_tilt")) if lines else np.linspace(0.0, last, 40)
    moves = len(tilt) // 2
    with style.canvas(film.PIXELS[0] / film.DPI, film.PIXELS[1] / film.DPI) as fig:
        ax, charts = film.axes(fig, 1)
        stones = Stones(run, name, ax)
        corners = np.concatenate(stones.outlines)
        far = [turned(corners, -a) for a in (0.0, last)]
        window(ax, np.concatenate(far))
        drawn = {
            word: ax.plot([], [], style_of, color=colour, linewidth=1.6, zorder=4, label=f"{word} thrust")[0]
            for word, style_of, colour in (("least", "--", style.HINGE), ("greatest", ":", style.GROUND))
        }
        base = np.array([corners.min(axis=0), [corners[:, 0].max(), corners[:, 1].min()]])
        (ground,) = ax.plot(*base.T, color="#777777", linewidth=1.0)
        chart = charts[0]
        if lines:
            ax.legend(loc="upper right")
            for word, key_of, style_of, colour in (
                ("least", "film_thrust_min", "--", style.HINGE),
                ("greatest", "film_thrust_max", ":", style.GROUND),
            ):
                chart.plot(np.degrees(tilt), run.array(name, key_of) / 1e3, style_of, color=colour, label=f"{word} thrust")
            chart.set_ylabel("horizontal thrust [kN]")
            chart.legend()
        else:
            chart.plot(np.degrees(tilt), np.tan(tilt), color=style.HINGE)
            chart.set_ylabel("horizontal acceleration [g]")
        chart.set_xlabel("tilt [degrees]")
        cursor = chart.axvline(0.0, color=style.THRUST, linewidth=1.0)
        title = ax.set_title("")

        def draw(k: int) -> None:
            angle = tilt[min(k, len(tilt) - 1)]
            share = max(0.0, (k - len(tilt) + 1) / moves)
            stones.place(rest + share * (falls - rest), -angle)
            ground.set_data(*turned(base, -angle).T)
            for word, key_of in (("least", "film_least"), ("greatest", "film_most")) if lines else ():
                points = run.array(name, key_of)[min(k, len(tilt) - 1)]
                drawn[word].set_data(*(turned(points, -angle).T if share == 0.0 else np.empty((2, 0))))
            cursor.set_xdata([np.degrees(angle)] * 2)
            title.set_text(
                (
                    f"ground tilted by {np.degrees(angle):.2f} degrees, which corresponds to a horizontal acceleration of "
                    f"{np.tan(angle):.4f} g"
                )
                + (": collapse" if share else "")
            )

        count = len(tilt) + moves
        time = np.linspace(0.0, film.LASTS, count)
        frames, rate = film.pictures(time, kind, speed)
        film.write(
            fig, folder / "figures" / f"{name}.{kind}", kind, rate, frames, draw, [ground, stones.drawn, *drawn.values(), cursor, title]
        )
