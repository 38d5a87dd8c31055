"""Figures of ground motions and of the shake table."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from extrados.results.motion import MotionSet, OneMotion, ShakeTable
from extrados.results.store import Stored
from extrados.schema.constants import GRAVITY
from extrados.show import style


def draw_motion(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """A motion in depth, or the statistics of a set."""
    return _draw_set(run, name, folder) if isinstance(run[name], MotionSet) else _draw_one(run, name, folder)


def _draw_one(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    r = run.results_of(name, OneMotion)
    t = run.array(name, "time")
    found = []
    with style.figure(8.0, 7.0, rows=4, sharex=True, height_ratios=[1.5, 1, 1, 0.8]) as (fig, (acc, vel, dis, husid)):
        acc.plot(t, run.array(name, "acceleration") / GRAVITY, color=style.GROUND, linewidth=0.7)
        for k, impulse in enumerate(r.impulses):
            s = np.linspace(0.0, impulse.period_s, 100)
            acc.plot(
                impulse.start_s + s,
                impulse.amplitude_g * np.sin(2 * np.pi * s / impulse.period_s),
                color=style.THRUST,
                linewidth=1.6 if k == 0 else 0.9,
                label="strongest impulses" if k == 0 else None,
            )
        acc.set_ylabel("acceleration [g]")
        if said := ", ".join(part for part in (r.title, r.station) if part):
            acc.set_title(said)
        if r.impulses:
            acc.legend(loc="upper right")
        vel.plot(t, 100 * run.array(name, "velocity"), color=style.HINGE, linewidth=0.9)
        if r.wavelet_pulse.indicator > 0.5:
            vel.plot(t, 100 * run.array(name, "pulse_velocity"), color=style.THRUST, linewidth=0.9, label="extracted velocity pulse")
            vel.legend(loc="upper right")
        vel.set_ylabel("velocity\n[cm/s]")
        dis.plot(t, 100 * run.array(name, "displacement"), color=style.EDGE, linewidth=0.9)
        dis.set_ylabel("displacement\n[cm]")
        husid.plot(t, run.array(name, "husid"), "k", linewidth=0.9)
        for level in (0.05, 0.95):
            husid.axhline(level, color=style.EDGE, linewidth=0.6, linestyle=":")
        husid.set_ylabel("share of\nArias int.")
        husid.set_xlabel("time [s]")
        husid.set_xlim(0.0, t[-1])
        found.append(
            (
                style.save(fig, folder, f"{name}-history"),
                "Acceleration with its strongest impulses (single sines), velocity, displacement, and cumulative Arias intensity (dotted: 5 and 95 %).",
            )
        )
    period, damping = run.array(name, "period"), run.array(name, "damping")
    with style.figure(9.0, 3.6, columns=3) as (fig, (psa, sd, fourier)):
        for k, d in enumerate(damping):
            psa.semilogx(period, run.array(name, "psa")[k] / GRAVITY, label=f"{100 * d:g} %")
            sd.loglog(period, 100 * run.array(name, "sd")[k], label=f"{100 * d:g} %")
        caption = "Response spectra and Fourier amplitude of the acceleration"
        if "psa_rotd50" in run.arrays[name]:
            for key, label, line in (("psa_rotd50", "RotD50", "k--"), ("psa_rotd100", "RotD100", "k:")):
                psa.semilogx(period, run.array(name, key) / GRAVITY, line, linewidth=1.1, label=label)
            psa.set_ylim(top=1.35 * psa.get_ylim()[1])  # room for the longer legend
            caption += f"; black: median and maximum over all directions ({100 * r.rotd_damping:g} % damping)"
        psa.set_ylabel("pseudo-acceleration [g]")
        sd.set_ylabel("displacement [cm]")
        psa.legend(title="damping", loc="upper right", ncols=2 if "psa_rotd50" in run.arrays[name] else 1)
        for ax in (psa, sd):
            ax.set_xlabel("period [s]")
            ax.set_xlim(period[0], period[-1])
        smoothed = "fourier_smooth" in run.arrays[name]
        _fourier_axes(fourier, run.array(name, "frequency"), run.array(name, "fourier"), faint=smoothed)
        if smoothed:
            fourier.loglog(
                run.array(name, "smooth_frequency"),
                100 * run.array(name, "fourier_smooth"),
                color=style.THRUST,
                linewidth=1.2,
                label="smoothed (Konno and Ohmachi)",
            )
            fourier.legend(loc="lower left", fontsize=7)
            caption += ". Fourier amplitude: unsmoothed (faint), and smoothed by the window of Konno and Ohmachi (b = 40)"
        found.append((style.save(fig, folder, f"{name}-spectra"), f"{caption}."))
    return found


def _fourier_axes(ax: Axes, frequency: np.ndarray, amplitude: np.ndarray, faint: bool = False) -> None:
    """A raw Fourier spectrum; faint where a smoothed one is drawn over it."""
    inside = (frequency >= 0.05) & (frequency <= 50.0)
    ax.loglog(
        frequency[inside],
        100 * amplitude[inside],
        color=style.HINGE,
        linewidth=0.6,
        alpha=0.45 if faint else 1.0,
        label="raw" if faint else None,
    )
    top = 100 * amplitude[inside].max(initial=1e-12)
    ax.set_ylim(top * 1e-4, 2 * top)
    ax.set_xlabel("frequency [Hz]")
    ax.set_ylabel("Fourier amplitude [cm/s]")


def _draw_set(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    r, arrays = run.results_of(name, MotionSet), run.arrays[name]
    found = []
    shown = run.series(name, "shown")
    steps = run.array(name, "shown_step")
    with style.figure(8.0, 1.4 * len(shown) + 0.6, rows=len(shown), sharex=True, sharey=True) as (fig, axes):
        for ax, a, step in zip(axes, shown, steps, strict=True):
            ax.plot(step * np.arange(len(a.numbers)), a.numbers / GRAVITY, color=style.GROUND, linewidth=0.7)
            ax.set_ylabel("[g]")
            ax.set_title(a.about, loc="left", fontsize=8)
        axes[-1].set_xlabel("time [s]")
        found.append((style.save(fig, folder, f"{name}-motions"), f"The first of {r.count} motions."))
    period = run.array(name, "period")
    columns = 2 if "fourier" in arrays else 1
    with style.figure(4.6 * columns, 3.8, columns=columns) as (fig, axes):
        ax = axes[0]
        low, median, high = run.array(name, "psa_percentile") / GRAVITY
        ax.fill_between(period, low, high, color=style.STONE, label="16 to 84 %")
        ax.plot(period, median, color=style.HINGE, label="median")
        ax.plot(period, run.array(name, "psa_mean") / GRAVITY, "--", color=style.HINGE, linewidth=0.9, label="mean")
        if "target" in arrays:
            target = run.array(name, "target") / GRAVITY
            ax.plot(period, target, "k", label="target")
            if r.seed is not None:  # matched, not selected
                ax.plot(period, 0.9 * target, "k:", linewidth=0.7)
                ax.plot(period, 1.1 * target, "k:", linewidth=0.7)
            for at in (r.shortest_s, r.longest_s):
                ax.axvline(at, color=style.EDGE, linewidth=0.6, linestyle="--")
        ax.set_xscale("log")
        ax.set_xlim(period[0], period[-1])
        ax.set_xlabel("period [s]")
        ax.set_ylabel(f"pseudo-acceleration [g], {100 * r.damping:g} %")
        ax.legend(loc="upper right")
        if columns == 2:
            _fourier_axes(axes[1], run.array(name, "frequency"), run.array(name, "fourier"))
            if "line" in arrays:
                axes[1].loglog(
                    run.array(name, "line"), 100 * run.array(name, "line_spectrum"), "o-", color=style.THRUST, markersize=3, label="target"
                )
                axes[1].legend(loc="lower left")
        found.append(
            (
                style.save(fig, folder, f"{name}-spectra"),
                "Response spectra of the set"
                + (
                    ", and root mean square Fourier amplitude (generated motions with few spectral lines have a peak at each line)."
                    if columns == 2
                    else "."
                ),
            )
        )
    with style.figure(5.0, 3.6) as (fig, (ax,)):
        ax.plot(run.array(name, "impulse_period"), run.array(name, "impulse_amplitude"), ".", color=style.THRUST, markersize=4)
        ax.set_xlabel("period of the primary impulse [s]")
        ax.set_ylabel("amplitude [g]")
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        found.append((style.save(fig, folder, f"{name}-impulses"), "Primary impulses: for each motion, the single sine that fits best."))
    return found


def draw_shake_table(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Capacity curves (Fig. C-1) and the drive of the motion."""
    arrays = run.arrays[name]
    f = run.array(name, "frequency")
    w2 = (2 * np.pi * f) ** 2 / GRAVITY
    found = []
    with style.figure(8.5, 3.8, columns=2) as (fig, (dis, acc)):
        for ax, factor in ((dis, 100.0), (acc, w2)):
            ax.loglog(f, factor * run.array(name, "stroke_limit"), color=style.EDGE, label="stroke")
            ax.loglog(f, factor * run.array(name, "flow_limit"), color=style.HINGE, label="flow")
            for k, mass in enumerate(run.array(name, "mass")):
                ax.loglog(
                    f, factor * run.array(name, "force_limit")[k], "--" if k else "-", color=style.THRUST, label=f"force, {mass:.4g} kg"
                )
            ax.fill_between(
                f,
                factor * run.array(name, "capacity").min(axis=0),
                facecolor=style.STONE,
                edgecolor=style.EDGE,
                linewidth=0.5,
                label="can be played",
            )
            ax.set_xlabel("frequency [Hz]")
            ax.set_xlim(f[0], f[-1])
        top = 300 * arrays["stroke_limit"].numbers[0]
        dis.set_ylim(1e-3 * top, top)
        acc.set_ylim(1e-4, 5.0)
        dis.set_ylabel("displacement amplitude [cm]")
        acc.set_ylabel("acceleration amplitude [g]")
        dis.legend(loc="lower left")
        found.append(
            (
                style.save(fig, folder, f"{name}-capacity"),
                "Capacity of the shake table for harmonic motion, as displacement and as acceleration.",
            )
        )
    if "drive_time" in arrays:
        r = run.results_of(name, ShakeTable)
        t = run.array(name, "drive_time")
        with style.figure(8.0, 5.0, rows=3, sharex=True) as (fig, (dis, vel, acc)):
            dis.plot(t, 100 * run.array(name, "drive_displacement"), color=style.HINGE)
            for sign in (1, -1):
                dis.axhline(100 * sign * arrays["stroke_limit"].numbers[0], color=style.EDGE, linestyle="--", linewidth=0.8)
                vel.axhline(100 * sign * r.max_velocity_m_s, color=style.EDGE, linestyle="--", linewidth=0.8)
            vel.plot(t, 100 * run.array(name, "drive_velocity"), color=style.HINGE)
            acc.plot(
                run.array(name, "motion_time"),
                run.array(name, "motion_acceleration") / GRAVITY,
                color=style.EDGE,
                linewidth=0.6,
                label="target",
            )
            acc.plot(t, run.array(name, "drive_acceleration") / GRAVITY, color=style.THRUST, linewidth=0.6, label="played")
            acc.legend(loc="upper right", ncols=2)
            dis.set_ylabel("displacement\n[cm]")
            vel.set_ylabel("velocity\n[cm/s]")
            acc.set_ylabel("acceleration\n[g]")
            acc.set_xlabel("time [s]")
            moving = np.flatnonzero(np.abs(run.array(name, "drive_displacement")) > 2e-3 * r.played_displacement_m)
            acc.set_xlim(t[moving[0]] - 0.5, t[moving[-1]] + 0.5)
            found.append(
                (
                    style.save(fig, folder, f"{name}-drive"),
                    (
                        f"Motion of the shake table: time scaled by {r.time_scale:.3f}, acceleration scaled by {r.amplitude_factor:.3f}. "
                        "Dashed: limits of the table."
                    ),
                )
            )
    return found
