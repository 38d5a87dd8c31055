"""Figures of what rocks: history, failure domain, assessment."""

from pathlib import Path
from typing import Any

import numpy as np

from extrados.results.rocking import SLID, Assessment, FailureDomain, Rocking
from extrados.results.store import Stored
from extrados.schema.constants import GRAVITY
from extrados.show import film, style
from extrados.show.stones import Stones, moved, outlines


def draw_rocking(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """History of rotation, ground acceleration, energies and friction; shapes, of an arch with its thrust line."""
    r = run.results_of(name, Rocking)
    t = run.array(name, "time")
    found = [_draw_contacts(run, name, folder) if r.hand_over else _draw_history(run, name, folder)]
    if r.restraints:
        found.append(_draw_restraints(run, name, folder, t))
    if r.soft_base:
        found.append(_draw_base(run, name, folder, t))
    film_rocking(run, name, folder)
    moving = _rocks(run, name)
    if moving.any() and run.array(name, "required_friction").shape[1] > 1:
        found.append(_draw_friction(run, name, folder, t, moving))
    times = run.arrays[name].get("snapshot_time")
    if times is not None and len(times.numbers):
        blocks, centroid = outlines(run, name), run.array(name, "centroid")
        poses = run.array(name, "snapshot_pose")
        lines = run.arrays[name].get("snapshot_thrust")
        count = len(times.numbers)
        columns = min(3, count)
        rows = -(-count // columns)
        wide, high = np.ptp(np.concatenate(blocks), axis=0)
        tall = float(np.clip(3.0 * high / wide + 0.8, 2.0, 4.0))
        with style.figure(3.2 * columns, tall * rows, rows=rows, columns=columns, sharex=True, sharey=True) as (fig, axes):
            for ax in axes[count:]:
                ax.set_axis_off()
            for k, (ax, when, pose) in enumerate(zip(axes, times.numbers, poses, strict=False)):
                style.draw_blocks(ax, [moved(o, c, p) for o, c, p in zip(blocks, centroid, pose, strict=True)])
                if lines is not None:
                    ax.plot(*lines.numbers[k].T, color=style.THRUST, marker=".", markersize=3, scalex=False, scaley=False)
                ax.set_title(f"{when:.3f} s")
                style.section_axes(ax)
                ax.label_outer()
                if count <= k + columns < len(axes):  # nothing stands below it
                    ax.tick_params(labelbottom=True)
                    ax.set_xlabel("x [m]")
            found.append(
                (
                    style.save(fig, folder, f"{name}-shapes"),
                    f"Deformed shapes at true scale, {'calculated with rigid contacts' if r.hand_over else 'at the greatest rotations'}"
                    + ("." if lines is None else ", with the dynamic thrust line."),
                )
            )
    return found


def _draw_history(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Rotation, ground acceleration, energies and friction over time."""
    r = run.results_of(name, Rocking)
    t = run.array(name, "time")
    with style.figure(8.0, 7.0, rows=4, sharex=True, height_ratios=[1, 1.6, 1, 1]) as (fig, axes):
        ground, rotation, energy, friction = axes
        ground.plot(t, run.array(name, "ground") / GRAVITY, color=style.GROUND, linewidth=0.8)
        for sign in (1, -1):
            ground.axhline(sign * r.uplift_acceleration_g, color=style.EDGE, linestyle="--", linewidth=0.7)
        ground.set_ylabel("ground [g]")
        rotation.plot(t, 1e3 * run.array(name, "rotation"), color=style.THRUST, label="lower block" if r.stack else None)
        if r.stack:
            rotation.plot(t, 1e3 * run.array(name, "rotation_upper"), color=style.GROUND, linewidth=0.9, label="upper block")
        for sign in (1, -1):
            rotation.axhline(1e3 * sign * r.critical_rotation_rad, color=style.EDGE, linestyle=":", linewidth=0.8)
        reached = 1e3 * np.concatenate([run.array(name, what) for what in ("rotation", *(["rotation_upper"] if r.stack else []))])
        low, high = reached.min(initial=0.0), reached.max(initial=0.0)
        if low == high:  # it has not rocked
            low, high = -1e3 * r.critical_rotation_rad, 1e3 * r.critical_rotation_rad
        rotation.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
        rotation.plot(run.array(name, "impact_time"), np.zeros(len(run.array(name, "impact_time"))), "k|", markersize=8, label="impacts")
        rotation.set_ylabel("rotation [mrad]\n+ to +x")
        style.legend_above(rotation)
        style.energies(
            energy,
            "energy",
            [
                (t, run.array(name, "kinetic"), {"label": "kinetic"}),
                (t, run.array(name, "potential"), {"label": "potential"}),
                (
                    t,
                    run.array(name, "ledger"),
                    {"label": "energy supplied less energy lost", "color": "k", "linestyle": "--", "linewidth": 0.8},
                ),
            ],
        )
        style.legend_above(energy)
        needed = run.array(name, "required_friction").max(axis=1) if len(t) else t
        friction.plot(t, np.minimum(needed, 2.0), color=style.HINGE, linewidth=0.8)
        friction.set_ylabel("required\nfriction")
        friction.set_xlabel("time [s]")
        moving = np.flatnonzero(_rocks(run, name))
        if len(moving):
            pad = 0.5 + 0.05 * (t[moving[-1]] - t[moving[0]])
            friction.set_xlim(max(0.0, t[moving[0]] - pad), min(t[-1], t[moving[-1]] + pad))
        saved = style.save(fig, folder, f"{name}-history")
    return (
        saved,
        (
            f"Histories: ground motion, rotation of {r.rotation_of} with impacts, energies, required "
            "friction. Dashed: acceleration at which rocking starts. Dotted: critical rotation."
        ),
    )


#: Blocks whose rotation on contacts is drawn
MOST_BLOCKS = 6


def _turned_most(run: Stored, name: str) -> list[tuple[str, np.ndarray]]:
    """Names of the blocks that turn most on rigid contacts, and their rotations over time [rad]."""
    turned = run.array(name, "contacts_rotation")
    most = np.argsort(-np.abs(turned).max(axis=0, initial=0.0), kind="stable")[:MOST_BLOCKS]
    return [(str(run.array(name, "block_name")[k]), turned[:, k]) for k in sorted(most.tolist())]


def _draw_contacts(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Ground, rotations, energies and slip over time, of the mechanism and then of its blocks on rigid contacts."""
    r, over = run.results_of(name, Rocking), run.results_of(name, Rocking).hand_over
    t, time = run.array(name, "time"), run.array(name, "contacts_time")
    place = run.array(name, "contacts_place")
    with style.figure(8.0, 7.0, rows=4, sharex=True, height_ratios=[1, 1.6, 1, 1]) as (fig, axes):
        ground, rotation, energy, slip = axes
        for at, of in ((t, "ground"), (time, "contacts_ground")):
            ground.plot(at, run.array(name, of) / GRAVITY, color=style.GROUND, linewidth=0.8)
        for sign in (1, -1):
            ground.axhline(sign * r.uplift_acceleration_g, color=style.EDGE, linestyle="--", linewidth=0.7)
        ground.set_ylabel("ground [g]")
        rotation.plot(t, 1e3 * run.array(name, "rotation"), color="k", linewidth=1.5, label="mechanism")
        for who, turned in _turned_most(run, name):
            rotation.plot(time, 1e3 * turned, linewidth=0.8, label=who)
        rotation.set_ylabel("rotation [mrad]\n+ to +x")
        style.legend_above(rotation)
        style.energies(
            energy,
            "energy",
            [
                (time, run.array(name, "contacts_kinetic_energy"), {"label": "kinetic"}),
                (time, run.array(name, "contacts_friction_energy"), {"label": "lost in friction"}),
                (time, run.array(name, "contacts_damping_energy"), {"label": "lost at impacts"}),
            ],
        )
        style.legend_above(energy)
        most = np.abs(np.nan_to_num(run.array(name, "contacts_slip"))).max(axis=1)
        slip.plot(time, 1e3 * most, color=style.HINGE, linewidth=0.9)
        slip.set_ylabel("greatest slip\n[mm]")
        slip.set_xlabel("time [s]")
        for ax in axes:
            ax.axvline(over.time_s, color=style.THRUST, linestyle=":", linewidth=1.0)
        away = np.abs(place - place[-1]).max(axis=(1, 2))
        last = np.flatnonzero(away >= 0.01 * away.max())[-1]
        slip.set_xlim(max(0.0, over.time_s - 0.5), time[min(last + 20, len(time) - 1)])
        saved = style.save(fig, folder, f"{name}-history")
    return (
        saved,
        (
            "Histories: ground motion, rotations, energies, greatest slip of a joint. Dotted: start of the calculation with rigid "
            f"contacts at {over.time_s:.3f} s. Dashed: acceleration at which rocking starts."
        ),
    )


def film_rocking(run: Stored, name: str, folder: Path) -> None:
    """The stones as they rock, with the line of thrust, beside ground motion and rotation."""
    kind, speed = film.asked(run, name)
    if kind == "none" or "film_time" not in run.arrays[name]:
        return
    time, pose = run.array(name, "film_time"), run.array(name, "film_pose")
    line = run.arrays[name].get("film_line")
    history = run.array(name, "time")
    with style.canvas(film.PIXELS[0] / film.DPI, film.PIXELS[1] / film.DPI) as fig:
        ax, (ground, rotation) = film.axes(fig, 2)
        stones = Stones(run, name, ax)
        film.poses_window(ax, stones, pose)
        (thrust,) = ax.plot([], [], color=style.THRUST, linewidth=1.6, zorder=4, label="line of thrust")
        if line is not None:
            ax.legend(loc="upper right")
        ground.plot(history, run.array(name, "ground") / GRAVITY, color=style.GROUND, linewidth=0.8)
        ground.set_ylabel("ground [g]")
        upper = "rotation_upper" in run.arrays[name]  # of two stacked blocks
        rotation.plot(history, 1e3 * run.array(name, "rotation"), color=style.HINGE, linewidth=1.0, label="lower block" if upper else None)
        if run.results_of(name, Rocking).hand_over:
            after = run.array(name, "contacts_time")
            ground.plot(after, run.array(name, "contacts_ground") / GRAVITY, color=style.GROUND, linewidth=0.8)
            for _, turned in _turned_most(run, name):
                rotation.plot(after, 1e3 * turned, linewidth=0.8)
        if upper:
            rotation.plot(history, 1e3 * run.array(name, "rotation_upper"), "--", color=style.GROUND, linewidth=1.0, label="upper block")
            rotation.legend()
        rotation.set_ylabel("rotation [mrad], + to +x")
        rotation.set_xlabel("time [s]")
        rotation.set_xlim(0.0, float(time[-1]))
        cursors = [a.axvline(0.0, color=style.THRUST, linewidth=1.0) for a in (ground, rotation)]

        def show(k: int) -> None:
            stones.place(pose[k])
            if line is not None:
                thrust.set_data(*line.numbers[k].T)

        film.history(ax, folder / "figures" / f"{name}.{kind}", time, speed, show, cursors, [stones.drawn, thrust])


def _draw_restraints(run: Stored, name: str, folder: Path, t: np.ndarray) -> tuple[str, str]:
    """Forces of ties and dampers, moments of added hinges, over time."""
    arrays = [run.arrays[name][f"restraint_{k}"] for k in range(1, len(run.results_of(name, Rocking).restraints) + 1)]
    units = list(dict.fromkeys(a.unit for a in arrays))
    moving = np.flatnonzero(np.abs(run.array(name, "rotation")) > 0.0)
    with style.figure(8.0, 0.6 + 2.2 * len(units), rows=len(units), sharex=True) as (fig, axes):
        for ax, unit in zip(axes, units, strict=True):
            here = [a for a in arrays if a.unit == unit]
            for a in here[:12]:
                ax.plot(t, a.numbers / 1e3, linewidth=0.9, label=a.about)
            ax.set_ylabel("force [kN]\n+ tension" if unit == "N" else "moment [kN m]")
            if len({a.about for a in here}) <= 6:
                style.legend_above(ax, *_once(ax))
        axes[-1].set_xlabel("time [s]")
        if len(moving):
            axes[-1].set_xlim(max(0.0, t[moving[0]] - 0.2), min(t[-1], t[moving[-1]] + 0.2))
        saved = style.save(fig, folder, f"{name}-restraints")
    return saved, "Forces of the restraints over time" + (", the first twelve of each kind." if len(arrays) > 12 else ".")


def _draw_base(run: Stored, name: str, folder: Path, t: np.ndarray) -> tuple[str, str]:
    """Which part of a compliant base pushes, and how far the block sinks, over time."""
    low, high = run.array(name, "pressed").T
    edges = run.array(name, "outline")[:, 0]
    with style.figure(8.0, 4.4, rows=2, sharex=True) as (fig, (base, sinking)):
        base.fill_between(t, low, high, color=style.GROUND, alpha=0.5, linewidth=0.6)
        base.set_ylim(edges.min(), edges.max())
        base.set_ylabel("part in contact\nx [m]")
        sinking.plot(t, 1e3 * run.array(name, "sinking"), color=style.THRUST, linewidth=0.9)
        sinking.axhline(1e3 * run.results_of(name, Rocking).soft_base.sinking_at_rest_m, color=style.EDGE, linestyle=":", linewidth=0.8)
        sinking.set_ylabel("settlement of\nthe middle [mm]")
        sinking.invert_yaxis()
        sinking.set_xlabel("time [s]")
        moving = np.flatnonzero(np.abs(run.array(name, "rotation")) > 0.02 * np.abs(run.array(name, "rotation")).max(initial=0.0))
        if len(moving):
            sinking.set_xlim(max(0.0, t[moving[0]] - 0.5), min(t[-1], t[moving[-1]] + 0.5))
        saved = style.save(fig, folder, f"{name}-base")
    return saved, ("Above: share of the base that is in contact. Below: settlement of the base under the centre of mass (dotted: at rest).")


def _once(ax: Any) -> tuple[list[Any], list[str]]:
    """Lines and texts of a legend, without duplicates."""
    lines, words = ax.get_legend_handles_labels()
    first = {word: line for line, word in reversed(list(zip(lines, words, strict=True)))}
    return list(first.values()), list(first)


def _rocks(run: Stored, name: str) -> np.ndarray:
    """Whether it is off rest, of each time; of stacked blocks whether either is."""
    size = np.abs(run.array(name, "rotation"))
    # a compliant base lets it tremble long after
    rocks = size > (0.02 * size.max(initial=0.0) if run.results_of(name, Rocking).soft_base else 0.0)
    return rocks | (np.abs(run.array(name, "rotation_upper")) > 0.0) if run.results_of(name, Rocking).stack else rocks


def _draw_friction(run: Stored, name: str, folder: Path, t: np.ndarray, moving: np.ndarray) -> tuple[str, str]:
    """Friction needed at the joints over time, and its greatest value at each."""
    friction = run.array(name, "required_friction")
    first, last = np.flatnonzero(moving)[[0, -1]]
    part = slice(max(first - 1, 0), last + 2)
    shown = np.where(moving[part, None], np.minimum(friction[part], 1.0), np.nan)
    with style.figure(8.0, 3.6, columns=2, width_ratios=[2.4, 1]) as (fig, (over_time, along)):
        joints = np.arange(friction.shape[1])
        mesh = over_time.pcolormesh(t[part], joints, shown.T, cmap="YlOrBr", vmin=0.0, vmax=1.0, shading="nearest", rasterized=True)
        fig.colorbar(mesh, ax=over_time, label="required coefficient of friction", extend="max")
        over_time.set_xlabel("time [s]")
        over_time.set_ylabel("joint")
        over_time.grid(False)
        along.plot(np.minimum(friction[moving].max(axis=0), 2.0), joints, "o-", color=style.HINGE, markersize=3)
        along.set_xlabel("greatest required friction")
        along.set_ylabel("joint")
        for ax in (over_time, along):
            style.numbers(ax.yaxis)
        return style.save(
            fig, folder, f"{name}-friction"
        ), "Coefficient of friction required at the joints during rocking. White: the structure is at rest."


def draw_failure_domain(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Map of outcomes with the Mode I and Mode II curves (Figs 5-3 and 5-7)."""
    from matplotlib.colors import ListedColormap

    r = run.results_of(name, FailureDomain)
    order = np.argsort(run.array(name, "duration"))  # a deck may list them in any order
    d, a, codes = run.array(name, "duration")[order], run.array(name, "amplitude"), run.array(name, "outcome")[order]
    with style.figure(7.0, 4.6) as (fig, (ax,)):
        ax.pcolormesh(
            d if len(d) > 1 else d[0] * np.array([0.9, 1.1]),
            a,
            codes.T if len(d) > 1 else np.repeat(codes.T, 2, axis=1),
            cmap=ListedColormap(style.MODES),
            vmin=0,
            vmax=SLID,
            shading="nearest",
            rasterized=True,
        )
        mark = "o" if len(d) == 1 else ""
        ax.plot(d, run.array(name, "mode_I")[order], f"k-{mark}", label="Mode I (governs)")
        ax.plot(d, run.array(name, "mode_II")[order], f"k--{mark}", label="Mode II")
        for one in r.amplitudes_by_rule or []:
            curve = np.array(one.amplitudes_g, dtype=float)[order]
            ax.plot(d, curve, linewidth=1.2, linestyle="-.", label=f"rule {one.rule}, $c_v$ {one.restitution:.2f}")
        for values, text in ((r.sliding_from_g, "blocks slide from"), (r.hinges_elsewhere_from_g, "hinges elsewhere from")):
            if any(value is not None for value in values):
                ax.plot(d, np.array(values, dtype=float)[order], ".", markersize=3.0, label=text)
        ax.axhline(r.uplift_acceleration_g, color=style.EDGE, linewidth=0.8, linestyle=":")
        kinds = ["no rocking", "recovery", "collapse after impact (Mode I)", "collapse without impact (Mode II)", "blocks only slide"]
        for code, text in enumerate(kinds if (codes == SLID).any() else kinds[:SLID]):
            ax.plot([], [], "s", color=style.MODES[code], markeredgecolor=style.EDGE, label=text)
        ax.set_xlabel(
            {"step": "duration t_p of the first part of the pulse [s]", "rectangular": "duration t_p [s]"}.get(r.pulse, "period T_p [s]")
        )
        ax.set_ylabel("amplitude [g]")
        ax.set_ylim(0.0, a[-1])
        ax.set_xlim(*((d[0], d[-1]) if len(d) > 1 else (0.5 * d[0], 1.5 * d[0])))
        ax.grid(False)
        handles, labels = ax.get_legend_handles_labels()
        fig.legend(handles, labels, loc="outside lower center", ncols=3)
        title = f"Failure domain of {r.pulse} pulses"
        ax.set_title(title)
        return [
            (
                style.save(fig, folder, name),
                "Outcome of each pulse; the line is the lowest amplitude that causes collapse at each duration.",
            )
        ]


def draw_assessment(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Impulses against the failure curve (Fig. 5-15) and the fitted impulses on the record (Fig. 5-10)."""
    r = run.results_of(name, Assessment)
    gamma = r.uplift_acceleration_g
    with style.figure(8.5, 4.0, columns=2, width_ratios=[1.1, 1]) as (fig, (curve, record)):
        period = run.array(name, "period")
        curve.plot(period, run.array(name, "failing_amplitude"), "k-", label=f"Eq. 5.8, {r.coefficients_source}")
        own = run.array(name, "failing_amplitude_own")
        if np.any(own != run.array(name, "failing_amplitude")):
            curve.plot(period, own, "--", color=style.EDGE, label="Eq. 5.8, fitted to this structure")
        curve.plot(
            run.array(name, "computed_period"),
            run.array(name, "computed_amplitude"),
            ".",
            color=style.EDGE,
            markersize=3,
            label="calculated points of Mode I",
        )
        curve.axhline(gamma, linestyle=":", color=style.EDGE, linewidth=0.8)
        for k, i in enumerate(r.impulses):
            color = style.THRUST if i.verdict == "fails" else style.SAFE
            curve.plot(i.period_s, abs(i.amplitude_g), "o" if k == 0 else "s", color=color, markersize=7 if k == 0 else 5)
        at = [(i.period_s, abs(i.amplitude_g)) for i in r.impulses]
        style.letters(curve, at, [str(i.rank) for i in r.impulses], style.EDGE)
        top = max([3.0 * gamma, *(1.3 * abs(i.amplitude_g) for i in r.impulses)])
        curve.set_ylim(0.0, top)
        curve.set_xlim(0.0, period[-1])
        curve.set_xlabel("period of the impulse T_p [s]")
        curve.set_ylabel("amplitude A_p [g]")
        curve.set_title(f"Verdict: {'collapse' if r.verdict == 'fails' else 'no collapse'}")
        curve.legend(loc="upper right")
        t = run.array(name, "time")
        record.plot(t, run.array(name, "ground") / GRAVITY, color=style.GROUND, linewidth=0.6)
        for k, (amplitude, length, start) in enumerate(
            zip(run.array(name, "impulse_amplitude"), run.array(name, "impulse_period"), run.array(name, "impulse_start"), strict=True)
        ):
            s = np.linspace(0.0, length, 100)
            record.plot(
                start + s, amplitude / GRAVITY * np.sin(2 * np.pi * s / length), color=style.THRUST, linewidth=1.6 if k == 0 else 1.0
            )
            record.annotate(str(k + 1), (start + 0.25 * length, amplitude / GRAVITY), fontsize=8)
        if len(r.impulses):
            ends = [(i.start_s, i.start_s + i.period_s) for i in r.impulses]
            record.set_xlim(max(0.0, min(e[0] for e in ends) - 2.0), min(t[-1], max(e[1] for e in ends) + 3.0))
        record.set_xlabel("time [s]")
        record.set_ylabel("ground acceleration [g]")
        record.set_title("Impulses of the motion")
        return [
            (
                style.save(fig, folder, name),
                (
                    "Left: impulses of the motion, compared with the failure curve. Right: the same impulses, drawn "
                    "over the ground acceleration."
                ),
            )
        ]
