"""Figures of the rocking statistics: fragility, resonance, rocking spectra, harmonic maps, code checks."""

from pathlib import Path

import numpy as np

from extrados.results.codes import Checked
from extrados.results.rocking import COLLAPSE, RECOVERY, SLID
from extrados.results.statistics import DemFragility, Ensemble, HarmonicMap, LevelShares, OverDurations, Resonance, RockingSpectrum
from extrados.results.store import Stored
from extrados.schema.constants import GRAVITY
from extrados.show import style

PERCENTILES = (16, 50, 84)
FALLEN = 1.12  # where a figure draws the rotation ratio of what has come down, see `place_of_collapse`


#: Incremental curves that are drawn one by one: more are a cloud
HAIRS = 40


def place_of_collapse(recovered: np.ndarray) -> float:
    """Where an axis of rotation ratios draws collapse: beyond all that recovered, some from past the critical rotation."""
    return max(FALLEN, 1.08 * float(recovered.max(initial=0.0)))


def draw_fragility(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Histogram (Fig. 6-7), single histories (Fig. 6-6) and cloud; over levels the curves with their stripes and the
    incremental picture; the annual rate; or Fig. 6-8."""
    arrays = run.arrays[name]
    if isinstance(run[name], OverDurations):
        return _durations(run, name, folder)
    found = []
    if "stripe_level" in arrays:
        found += [_curve(run, name, folder), _incremental(run, name, folder)]
    if "bin_edge" in arrays and run[name].get("count"):
        found.append(_histogram(run, name, folder))
    if "intensity" in arrays and "grid" in arrays:
        found.append(_cloud(run, name, folder))
    if "contribution" in arrays:
        found.append(_annual(run, name, folder))
    if run.series(name, "history_time"):
        found.append(_histories(run, name, folder))
    if "sensitivity_rotation_total" in arrays:
        found.append(_sensitivity(run, name, folder))
    return found


def _histogram(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    r = run.results_of(name, Ensemble)
    edges, counts = run.array(name, "bin_edge"), run.array(name, "bin_count")
    n = max(r.count, 1)
    with style.figure(6.0, 3.8) as (fig, (ax,)):
        width = edges[1] - edges[0]
        ax.bar(edges[:-1], 100 * counts / n, width=width, align="edge", color=style.STONE, edgecolor=style.EDGE, linewidth=0.6)
        ax.bar([1.0 + width], [100 * r.collapsed / n], width=1.6 * width, align="edge", color=style.THRUST, label="collapse")
        ax.set_axisbelow(True)
        ax.set_xticks([0, 0.2, 0.4, 0.6, 0.8, 1.0])
        ax.set_xlabel("greatest rotation / critical rotation")
        ax.set_ylabel("share of the runs [%]")
        ax.set_title(f"{r.count} runs, {100 * (r.collapse_probability or 0.0):.1f} % collapse")
        full = np.flatnonzero(counts)
        if len(full) == 1:  # one bar says nothing by its height
            where = f"{edges[full[0]]:.2f} to {edges[full[0] + 1]:.2f}"
            ax.text(
                0.5,
                0.5,
                f"{int(counts[full[0]])} runs have greatest rotations of {where} times the critical rotation",
                transform=ax.transAxes,
                ha="center",
                fontsize=8,
            )
        ax.legend()
        return style.save(fig, folder, f"{name}-histogram"), (
            "Greatest rotations of all runs. The last bin contains all rotations beyond the critical "
            "rotation; the red bar counts the runs that collapse."
        )


def _ensemble(run: Stored, name: str) -> Ensemble | LevelShares:
    """Results of a fragility, at one intensity of each motion or at several levels."""
    found = run[name]
    assert isinstance(found, Ensemble | LevelShares)
    return found


def _axis(r: Ensemble | LevelShares) -> str:
    """What an axis of intensities says."""
    return f"{r.intensity} [{r.intensity_unit}]" if r.intensity_unit else r.intensity


def _cloud(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """The motions at their own intensities; the curves over them."""
    r = run.results_of(name, Ensemble)
    x, ratio, outcome = (run.array(name, k) for k in ("intensity", "peak_ratio", "outcome"))
    grid = run.array(name, "grid")
    with style.figure(9.0, 4.2, columns=2, sharex=True) as (fig, (left, right)):
        up, fell = outcome == RECOVERY, outcome == COLLAPSE
        place = place_of_collapse(ratio[up])
        left.plot(x[up], ratio[up], "o", color=style.HINGE, markersize=3, alpha=0.6, label=f"{int(up.sum())} motions: rocking and recovery")
        left.plot(x[fell], np.full(int(fell.sum()), place), "x", color=style.THRUST, markersize=4, label=f"{int(fell.sum())} collapse")
        rest = int((outcome == 0).sum())
        left.set_xscale("log")
        left.set_yscale("log")
        left.set_ylim(max(1e-4, 0.5 * ratio[up].min()) if up.any() else 1e-3, 1.35 * place)
        left.axhline(1.0, color=style.THRUST, linewidth=0.8, linestyle=":")
        left.set_ylabel("greatest rotation / critical rotation")
        left.set_title(f"{r.count} motions; {rest} of them cause no rocking" if rest else f"{r.count} motions")
        left.legend(loc="center left", frameon=True)
        share = np.where(fell, 1.0, 0.0)
        right.plot(x, share, "|", color=style.EDGE, alpha=0.4, markersize=5)
        if r.median is not None:
            right.plot(grid, run.array(name, "curve"), color=style.THRUST, label=f"collapse: median {r.median:.3g}")
            low, high = run.array(name, "curve_lower"), run.array(name, "curve_upper")
            right.fill_between(grid, low, high, color=style.THRUST, alpha=0.15, linewidth=0)
        limits = zip(r.rotation_limits or [], *(run.series(name, f"limit{e}") for e in ("", "_lower", "_upper")), strict=True)
        for k, (limit, curve, low, high) in enumerate(limits):
            line = right.plot(
                grid,
                curve.numbers,
                ("--", "-.", ":")[k % 3],
                label=f"rotation beyond {limit.rotation_ratio:g} of the critical rotation: median intensity {limit.median:.3g}",
            )[0]
            right.fill_between(grid, low.numbers, high.numbers, color=line.get_color(), alpha=0.12, linewidth=0)
        right.set_xscale("log")
        right.set_ylim(-0.02, 1.02)
        right.set_ylabel("probability")
        right.set_title("fitted curves")
        style.legend_below(fig, right)
        for ax in (left, right):
            ax.set_xlabel(_axis(r))
        return style.save(fig, folder, f"{name}-cloud"), (
            f"Unscaled motions, each at its own intensity, and the fitted fragility curves. Bands: {100 * r.confidence:g} "
            "% confidence by profile likelihood."
        )


def _annual(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Hazard, curve of collapse, and what each intensity adds to the annual rate."""
    r = _ensemble(run, name)
    x, rate = run.array(name, "hazard_intensity"), run.array(name, "hazard_rate")
    at, share = run.array(name, "contribution_intensity"), run.array(name, "contribution")
    with style.figure(9.0, 3.8, columns=2) as (fig, (left, right)):
        left.plot(x, rate, "o-", color=style.GROUND, markersize=4)
        left.axhline(r.annual_collapse_rate, color=style.THRUST, linestyle="--", label=f"collapse, {r.annual_collapse_rate:.2g} per year")
        low, high = (np.nan if v is None else v for v in r.annual_collapse_rate_interval)
        if np.isfinite(low):
            left.axhspan(low, high, color=style.THRUST, alpha=0.15, linewidth=0)
        if r.acceptable_annual_rate is not None:
            left.axhline(r.acceptable_annual_rate, color=style.EDGE, linestyle=":", label="accepted")
        left.set_xscale("log")
        left.set_yscale("log")
        left.set_ylabel("annual rate of exceedance [1/year]")
        left.set_title("hazard of the site")
        left.legend()
        right.fill_between(at, 0.0, share, color=style.THRUST, alpha=0.3, linewidth=0)
        right.plot(at, share, color=style.THRUST)
        right.axvline(r.median, color=style.HINGE, linestyle="--", label=f"median of collapse, {r.median:.3g}")
        right.set_xscale("log")
        right.set_ylim(bottom=0.0)
        right.set_ylabel("collapse rate per ln(intensity) [1/year]")
        right.set_title("Intensities of collapse")
        right.legend()
        for ax in (left, right):
            ax.set_xlabel(_axis(r))
        return style.save(fig, folder, f"{name}-annual"), (
            f"Left: hazard curve, and annual rate of collapse with its {100 * r.confidence:g} % confidence "
            "band. Right: contribution of each intensity to this rate, per unit of ln(intensity); the area under the curve is the rate."
        )


def _histories(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Ground motions and the responses to them, side by side (Fig. 6-6)."""
    series = [run.series(name, f"history_{what}") for what in ("motion_time", "motion", "time", "rotation")]
    n = len(series[0])
    stands = [np.abs(one.numbers).max(initial=0.0) for one in series[3] if not one.about.endswith("collapse")]
    place = place_of_collapse(np.array(stands))
    with style.figure(9.0, 1.0 + 1.35 * n, rows=n, columns=2, sharex=True, sharey="col") as (fig, axes):
        for (left, right), at, ground, time, rotation in zip(axes.reshape(n, 2), *series, strict=True):
            left.plot(at.numbers, ground.numbers, color=style.GROUND, linewidth=0.8)
            fell = rotation.about.endswith("collapse")
            right.plot(time.numbers, np.clip(rotation.numbers, -place, place), color=style.THRUST if fell else style.HINGE)
            left.set_title(f"{at.about}: ground [g]", fontsize=8, loc="left")
            right.set_title(f"rotation / critical rotation: {'overturns' if fell else 'recovers'}", fontsize=8, loc="left")
            right.axhline(1.0, color=style.EDGE, linewidth=0.6, linestyle=":")
            right.axhline(-1.0, color=style.EDGE, linewidth=0.6, linestyle=":")
            right.set_ylim(-place, place)
        for ax in axes[-2:]:
            ax.set_xlabel("time [s]")
        return style.save(fig, folder, f"{name}-histories"), (
            f"The first {n} motions and the rotation under each, divided by the critical rotation (Fig. 6-6)."
        )


def _sensitivity(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """First-order and total Sobol indices of each uncertain value, for the rotation and the collapse."""
    r = run.results_of(name, Ensemble)
    values = list(r.sensitivity or {})
    place = np.arange(len(values))
    with style.figure(7.5, 1.6 + 0.45 * len(values), columns=2, sharey=True) as (fig, axes):
        for ax, what, title in zip(axes, ("rotation", "collapse"), ("greatest rotation", "collapse"), strict=True):
            for order, shift, color, text in (("total", 0.18, style.HINGE, "with interactions"), ("first", -0.18, style.SAFE, "alone")):
                index, low, high = (run.array(name, f"sensitivity_{what}_{order}{e}") for e in ("", "_lower", "_upper"))
                ax.barh(place + shift, index, 0.34, color=color, label=text)
                bars = np.maximum([index - low, high - index], 0.0)
                ax.errorbar(index, place + shift, xerr=bars, fmt="none", ecolor="k", capsize=2, linewidth=0.8)
            ax.set_axisbelow(True)
            ax.set_title(title)
            ax.set_xlabel("share of the variance (Sobol index)")
            ax.axvline(0.0, color="k", linewidth=0.8)
        axes[0].set_yticks(place, values)
        axes[0].invert_yaxis()
        style.legend_below(fig, axes[0])
        return style.save(fig, folder, f"{name}-sensitivity"), (
            f"Sobol indices of the uncertain values and of the choice of the motion, from {r.sensitivity_runs} "
            f"runs, with {100 * r.confidence:g} % bootstrap intervals."
        )


def _risen(r: LevelShares) -> str:
    """What counts as rocking: blocks have joints, a mechanism has one."""
    return "rocking of a joint, or collapse" if isinstance(r, DemFragility) else "uplift"


def _curve(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    r, arrays = run.results_of(name, LevelShares), run.arrays[name]
    level = run.array(name, "stripe_level")
    unit = arrays["stripe_level"].unit
    grid = run.array(name, "grid") if "grid" in arrays else np.zeros(0)
    with style.figure(6.5, 4.2) as (fig, (ax,)):
        for key, lower, upper, color, label in (
            ("stripe_uplift_probability", "stripe_uplift_lower", "stripe_uplift_upper", style.GROUND, _risen(r)),
            ("stripe_collapse_probability", "stripe_lower", "stripe_upper", style.THRUST, "collapse"),
        ):
            value, low, high = (run.array(name, k) for k in (key, lower, upper))
            bars = np.maximum([value - low, high - value], 0.0)
            ax.errorbar(level, value, yerr=bars, fmt="o", color=color, markersize=4, capsize=2, linewidth=0.9, label=f"{label}, counted")
        if isinstance(r, DemFragility) and any(r.censored):
            low, high = run.array(name, "stripe_bound_low"), run.array(name, "stripe_bound_high")
            ax.vlines(level, low, high, color=style.THRUST, alpha=0.3, linewidth=6, label="collapse: range with censored runs")
        if "stripe_rule_least" in arrays:
            ax.fill_between(
                level,
                run.array(name, "stripe_rule_least"),
                run.array(name, "stripe_rule_most"),
                color=style.STONE,
                linewidth=0,
                label="collapse: range over all impact rules",
            )
        for curve, band, color, style_, text, median, dispersion in (
            ("curve", "curve", style.THRUST, "-", "collapse at this level", r.median, r.dispersion),
            (
                "first_collapse_curve",
                "first_collapse",
                style.HINGE,
                "-.",
                "collapse at this or a lower level",
                r.first_collapse_median,
                r.first_collapse_dispersion,
            ),
        ):
            if curve not in arrays:
                continue
            label = f"{text}: median {median:.3g}, dispersion {dispersion:.2f}"
            ax.plot(grid, run.array(name, curve), style_, color=color, label=label)
            if f"{band}_lower" in arrays:
                low, high = run.array(name, f"{band}_lower"), run.array(name, f"{band}_upper")
                ax.fill_between(grid, low, high, color=color, alpha=0.15, linewidth=0)
        if "uplift_curve" in arrays:
            ax.plot(grid, run.array(name, "uplift_curve"), color=style.GROUND, linewidth=0.9)
        if "two_stage_curve" in arrays:
            ax.plot(grid, run.array(name, "two_stage_curve"), "--", color=style.EDGE, label="P(uplift) P(collapse | uplift)")
        ax.set_xlim(0.0, 1.1 * level[-1])
        ax.set_ylim(-0.02, 1.02)
        ax.set_xlabel(f"{r.intensity}{f' [{unit}]' if unit else ''}")
        ax.set_ylabel("probability")
        ax.set_title(f"{r.motions} motions at {len(level)} levels")
        ax.legend(loc="best")
        points = f"Points: share of the motions that cause collapse at each intensity, with {100 * r.confidence:g} % Wilson intervals."
        if isinstance(r, DemFragility) and any(r.censored):
            points += " Wide bars: this share if no censored run collapses, and if all of them collapse."
        curves = (
            "Solid curve: fitted probability of collapse at an intensity, with its bootstrap band. Dash-dotted curve: fitted probability "
            "that a motion causes collapse at this intensity or a lower one (interval-censored likelihood)."
        )
        return style.save(fig, folder, f"{name}-curve"), f"{points} {curves}" if len(grid) else points


def _incremental(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    r = run.results_of(name, LevelShares)
    level, ratio, over = (run.array(name, key) for key in ("stripe_level", "incremental_ratio", "incremental_over"))
    risen = run.array(name, "incremental_risen") if "incremental_risen" in run.arrays[name] else np.zeros_like(over)
    unit = run.arrays[name]["stripe_level"].unit
    percentiles = [run.array(name, f"stripe_peak_ratio_{p}") for p in PERCENTILES]  # infinite for collapse
    stands = np.concatenate([ratio[over == 0], *(x[np.isfinite(x)] for x in percentiles)])
    place = place_of_collapse(stands[np.isfinite(stands)])
    quantile = [np.minimum(x, place) for x in percentiles]
    with style.figure(6.5, 4.2) as (fig, (ax,)):
        for row in np.where(over == 1, place, ratio)[:HAIRS]:
            ax.plot(row, level, color=style.EDGE, alpha=0.15, linewidth=0.5)
        low, middle, high = quantile
        ax.fill_betweenx(level, low, high, color=style.HINGE, alpha=0.2, linewidth=0, label="16 to 84 % of the motions")
        ax.plot(middle, level, "-", color=style.HINGE, linewidth=2.0, label="median of the motions")
        i, j = np.nonzero(risen)
        if len(i):
            ax.plot(ratio[i, j], level[j], "o", color=style.GROUND, markersize=3, label="no overturning, although a lower level overturns")
        ax.axvline(1.0, color=style.THRUST, linewidth=0.9)
        ax.axvline(place, color=style.EDGE, linewidth=0.6, linestyle=":")
        ax.set_xlim(-0.02, place + 0.03)
        ticks = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, place]
        ax.set_xticks(ticks, [*(f"{x:g}" for x in ticks[:-1]), "collapse"])
        ax.set_xlabel(
            "greatest displacement / displacement of collapse" if isinstance(r, DemFragility) else "greatest rotation / critical rotation"
        )
        ax.set_ylabel(f"{r.intensity}{f' [{unit}]' if unit else ''}")
        style.legend_below(fig, ax)
        if r.resurrections is None:
            return style.save(fig, folder, f"{name}-incremental"), (
                f"Greatest displacements under {min(len(ratio), HAIRS)} motions, plotted over the size of the structure, with the "
                f"percentiles of all {r.motions} motions."
            )
        return style.save(fig, folder, f"{name}-incremental"), (
            f"Incremental curves of {min(len(ratio), HAIRS)} motions, with the percentiles of all {r.motions} motions. "
            f"{r.resurrections} motions overturn the structure at one level but not at a higher level."
        )


def _durations(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    r = run.results_of(name, OverDurations)
    d, mean, deviation = (run.array(name, k) for k in ("duration", "mean_peak_rotation_ratio", "deviation_peak_rotation_ratio"))
    p, low, high = (run.array(name, k) for k in ("collapse_probability", "lower", "upper"))
    with style.figure(7.5, 3.6, columns=2) as (fig, (left, right)):
        left.errorbar(d, mean, yerr=deviation, fmt="o-", color=style.HINGE, capsize=3, markersize=4)
        left.set_ylim(bottom=0.0)
        left.set_ylabel("greatest rotation / critical rotation")
        left.set_title("mean and standard deviation")
        right.errorbar(d, p, yerr=np.maximum([p - low, high - p], 0.0), fmt="o-", color=style.THRUST, capsize=3, markersize=4)
        right.set_ylim(-0.02, 1.02)
        right.set_ylabel("probability of collapse")
        right.set_title(f"motions that cause collapse, {100 * r.confidence:g} % interval")
        for ax in (left, right):
            ax.set_xlabel("duration of the motion t_d [s]")
        return [
            (
                style.save(fig, folder, f"{name}-durations"),
                (
                    "Left: greatest rotation (Fig. 6-8). Right: share of the motions that cause collapse, with "
                    f"{100 * r.confidence:g} % intervals. Both are plotted over the duration of the motion."
                ),
            )
        ]


def draw_resonance(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Figs 6-2, 6-3 and 6-4."""
    r, arrays = run.results_of(name, Resonance), run.arrays[name]
    found = []
    with style.figure(7.0, 4.6, rows=2, sharex=True, height_ratios=[1, 2]) as (fig, (ground, rotation)):
        t = run.array(name, "time")
        ground.plot(t, run.array(name, "ground") / GRAVITY, color=style.GROUND)
        ground.set_ylabel("ground [g]")
        rotation.plot(t, run.array(name, "rotation"), color=style.THRUST)
        rotation.set_ylabel("rotation [rad]\n+ to +x")
        rotation.set_xlabel("time [s]")
        found.append(
            (
                style.save(fig, folder, f"{name}-motion"),
                (
                    f"The motion that supplies most energy, with accelerations up to the cap of {r.cap_g:.3f} g, and the response to "
                    "this motion (Fig. 6-2)."
                ),
            )
        )
    if "least_cap_ratio" not in arrays:
        return found
    with style.figure(6.0, 4.2) as (fig, (ax,)):
        x, aspect, table = (run.array(name, "initial_ratio"), run.array(name, "aspect"), run.array(name, "least_cap_ratio"))
        drawn = ax.contourf(x, aspect, table, levels=np.linspace(0.0, 0.5, 11), cmap="YlOrBr_r", extend="max")
        lines = ax.contour(x, aspect, table, levels=np.linspace(0.05, 0.5, 10), colors="k", linewidths=0.5)
        ax.clabel(lines, fontsize=7)
        fig.colorbar(drawn, ax=ax, label="least acceleration / uplift acceleration")
        ax.plot(r.initial_rotation_ratio, 0.5, "k+")
        ax.set_xlabel("initial rotation / critical rotation")
        ax.set_ylabel("B/H")
        ax.grid(False)
        found.append(
            (
                style.save(fig, folder, f"{name}-least-cap"),
                ("Least cap of the ground acceleration with which the motion that supplies most energy increases the rotation (Fig. 6-3)."),
            )
        )
    with style.figure(8.0, 3.6, columns=2, sharey=True) as (fig, (left, right)):
        s = run.array(name, "impulse_start")
        for value, row in zip(run.array(name, "impulse_period_ratio"), run.array(name, "energy_by_period"), strict=True):
            left.plot(s, row, label=f"T_p = {value:g} T_n")
        for value, row in zip(run.array(name, "impulse_rotation"), run.array(name, "energy_by_rotation"), strict=True):
            right.plot(s, row, label=f"initial / critical rotation = {value:g}")
        left.set_ylabel("energy supplied / energy at the start")
        for ax in (left, right):
            ax.axhline(0.0, color=style.EDGE, linewidth=0.8)
            ax.set_xlabel("start of the impulse t_start/T_n")
            ax.legend(fontsize=7)
        found.append(
            (
                style.save(fig, folder, f"{name}-impulse"),
                (
                    f"Energy that one sine impulse of {r.impulse_amplitude_g:.3f} g adds to free rocking (Fig. 6-4). a: "
                    "several periods T_p, from a quarter of the critical rotation. b: several initial rotations, with T_p = T_n/2."
                ),
            )
        )
    return found


def draw_rocking_spectrum(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Peak rotation over 2 pi/p for each slenderness."""
    period, ratio, over = (run.array(name, k) for k in ("period", "peak_ratio", "overturned"))
    place = place_of_collapse(np.nan_to_num(ratio[over == 0]))
    with style.figure(7.0, 4.0) as (fig, (ax,)):
        if "rule_least" in run.arrays[name]:
            least, most = (np.minimum(run.array(name, key), place) for key in ("rule_least", "rule_most"))
            ax.fill_between(period, least, most, color=style.STONE, linewidth=0, label="range of the impact rules")
        for member, row, fell in zip(run.results_of(name, RockingSpectrum).family, ratio, over, strict=True):
            line = ax.plot(period, np.where(fell == 1, np.nan, row), ".-", markersize=3, label=member)[0]
            ax.plot(period[fell == 1], np.full(int(fell.sum()), place), "x", color=line.get_color(), markersize=5)
        ax.axhline(1.0, color=style.EDGE, linewidth=0.8, linestyle=":")
        ax.set_ylim(0.0, place + 0.05)
        ax.set_xlabel("2 pi/p [s], proportional to the square root of the size")
        ax.set_ylabel("greatest rotation / alpha")
        ax.legend()
        return [(style.save(fig, folder, name), "Rocking spectra of the motion. Crosses: the block overturns.")]


def draw_harmonic_map(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Rest, rocking and overturning over frequency and amplitude."""
    r = run.results_of(name, HarmonicMap)
    f, a, outcome, ratio = (run.array(name, k) for k in ("frequency", "amplitude", "outcome", "peak_ratio"))
    with style.figure(7.0, 4.4) as (fig, (ax,)):
        shown = np.where(outcome == RECOVERY, np.minimum(ratio, 1.0), np.nan)
        drawn = ax.pcolormesh(f, a, shown.T, cmap="YlGnBu", vmin=0.0, vmax=1.0, shading="nearest", rasterized=True)
        from matplotlib.colors import ListedColormap

        for code, color, text in ((COLLAPSE, style.MODES[3], "overturned"), (SLID, style.MODES[SLID], "blocks only slide")):
            here = np.where(outcome == code, 1.0, np.nan)
            if code == COLLAPSE or np.isfinite(here).any():
                ax.pcolormesh(f, a, here.T, cmap=ListedColormap([color]), shading="nearest", rasterized=True)
                ax.plot([], [], "s", color=color, label=text)
        fig.colorbar(drawn, ax=ax, label="greatest rotation / critical rotation")
        ax.axhline(r.uplift_acceleration_g, color=style.EDGE, linestyle="--", linewidth=0.8)
        ax.legend(loc="upper left", frameon=True)
        ax.set_xlabel("frequency [Hz]")
        ax.set_ylabel("amplitude [g]")
        ax.grid(False)
        return [
            (
                style.save(fig, folder, name),
                (f"Greatest rotation under {r.cycles} cycles of harmonic motion. Dashed: acceleration at which rocking starts."),
            )
        ]


def draw_code_checks(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Demand over capacity of each rule of `code-checks` or of a local mechanism."""
    found = run.results_of(name, Checked)
    rows = [
        (rule, c.demand / c.capacity, c.code)
        for rule, c in found.checks.items()
        if c.verdict in ("holds", "fails") and c.demand is not None and c.capacity is not None and c.capacity > 0.0
    ]
    if not rows:
        return []
    with style.figure(6.5, 0.6 + 0.35 * len(rows)) as (fig, (ax,)):
        for k, (_, value, code) in enumerate(rows):
            ax.barh(k, value, color=style.STONE if not code else style.THRUST if value > 1.0 else style.SAFE)
        ax.set_axisbelow(True)
        ax.axvline(1.0, color="k", linewidth=0.9)
        ax.set_yticks(range(len(rows)), [rule for rule, _, _ in rows])
        ax.invert_yaxis()
        ax.set_xlabel("demand over capacity")
        alternatives = (
            " The NTC checks at SLV are alternatives: one satisfied check is sufficient."
            if any(check.alternative for check in found.checks.values())
            else ""
        )
        pale = " Pale bars: formulas shown for comparison only." if any(not code for _, _, code in rows) else ""
        return [
            (
                style.save(fig, folder, name),
                (
                    f"Demand / capacity for each rule that applies; above 1, the check is not satisfied.{alternatives}{pale} "
                    f"{found.overall().statement}"
                ),
            )
        ]
