"""Figures of an assessment: margins on the one axis that all strategies share, who agrees with whom, and the hazard."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from extrados.results.assess import Agreement, Assess, StrategyVerdict
from extrados.results.store import Stored
from extrados.show import style

OUTCOMES = {"stands": style.SAFE, "collapses": style.THRUST, "cannot-stand": style.THRUST, "open": "#d98200", "not-applicable": "#9a9a9a"}
RELATIONS: dict[Agreement, tuple[str, str]] = {
    "agree": ("#cfe3d6", "same verdict"),
    "apart": ("#f7e7a8", "same verdict, different margins"),
    "open": ("#e4e4e4", "one verdict is open"),
    "disagree": ("#e9a79d", "stands against collapses"),
}
#: Where arrows end that show a margin of unknown end
REACH = 1.35


def draw_assess(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Margins of all strategies, their agreement, and the motion with the static capacities."""
    r = run.results_of(name, Assess)
    found = [_margins(r, folder, name), _agreement(r, folder, name), _hazard(run, r, name, folder), _tornado(r, folder, name)]
    return [one for one in found if one is not None]


def _margins(r: Assess, folder: Path, name: str) -> tuple[str, str] | None:
    """A bar or a point for each strategy over the factor on the hazard."""
    rows = [v for v in r.verdicts if v.status == "ok" and v.outcome != "not-applicable"]
    ends = [_ends(v) for v in rows]
    known = [x for low, high in ends for x in (low, high) if x is not None and x > 0.0]
    if not known:
        return None
    low, high = min(0.8, *known) / REACH, max(1.25, *known) * REACH
    with style.figure(7.2, 1.5 + 0.42 * len(rows)) as (fig, (ax,)):
        for k, (row, (left, right)) in enumerate(zip(rows, ends, strict=True)):
            colour = OUTCOMES[row.outcome]
            if left is not None and right is not None and right > 1.02 * left:
                ax.plot([left, right], [k, k], color=colour, linewidth=7.0, solid_capstyle="butt")
            elif left is not None or right is not None:
                at = (left if left is not None else right) or 0.0
                ax.plot(at, k, "o", color=colour, markersize=8)
                if right is None:
                    ax.annotate("", (at * 1.22, k), (at, k), arrowprops={"arrowstyle": "->", "color": colour})
                if left is None:
                    ax.annotate("", (at / 1.22, k), (at, k), arrowprops={"arrowstyle": "->", "color": colour})
            else:
                ax.plot(1.0, k, "s", color=colour, markersize=6, markerfacecolor="white")
        for outcome, colour in OUTCOMES.items():
            if any(v.outcome == outcome for v in rows):
                ax.plot(
                    [],
                    [],
                    "o",
                    color=colour,
                    label={"open": "open", "cannot-stand": "cannot stand"}.get(outcome, f"{outcome} under the hazard"),
                )
        if any(left is None and right is None for left, right in ends):
            ax.plot([], [], "s", color="#9a9a9a", markerfacecolor="white", label="margin not known")
        ax.axvline(1.0, color=style.EDGE, linewidth=1.0, linestyle="--")
        ax.set_xscale("log")
        ax.set_xlim(low, high)
        ticks = [t for t in (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0) if low <= t <= high]
        ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
        ax.set_xticks([], minor=True)
        ax.set_yticks(range(len(rows)), [v.label for v in rows])
        ax.set_ylim(len(rows) - 0.4, -0.6)
        ax.grid(axis="y", visible=False)
        ax.set_xlabel("critical scale factor of the hazard")
        ax.set_title("Margins of all strategies")
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-margins")
    return saved, (
        "Critical scale factor of the hazard by each strategy. Left of the dashed line (factor 1), the hazard itself causes collapse. "
        "Bar: the factor is between its ends. Arrow: the factor is beyond this point; its value was not searched."
    )


def _ends(v: StrategyVerdict) -> tuple[float | None, float | None]:
    return (v.margin, v.margin) if v.margin is not None else (v.margin_at_least, v.margin_below)


def _agreement(r: Assess, folder: Path, name: str) -> tuple[str, str] | None:
    """The matrix of who agrees with whom."""
    names = list(r.agreement)
    if len(names) < 2:
        return None
    labels = {v.strategy: v for v in r.verdicts}
    n = len(names)
    size = 1.9 + 0.55 * n
    with style.figure(size + 3.0, size + 0.5) as (fig, (ax,)):
        for i, a in enumerate(names):
            for j, b in enumerate(names):
                if i == j:
                    row = labels[a]
                    _cell(ax, j, i, OUTCOMES[row.outcome], row.verdict_words, "white")
                else:
                    relation = r.agreement[a][b]
                    _cell(ax, j, i, RELATIONS[relation][0], {"agree": "=", "apart": "~", "disagree": "x", "open": "?"}[relation])
        ax.set_xlim(-0.5, n - 0.5)
        ax.set_ylim(n - 0.5, -0.5)
        ax.set_aspect("equal")
        ax.grid(visible=False)
        words = [labels[a].label for a in names]
        ax.set_yticks(range(n), words)
        ax.set_xticks(range(n), [str(k + 1) for k in range(n)])
        ax.set_yticklabels([f"{w}  {k + 1}" for k, w in enumerate(words)])
        ax.tick_params(length=0)
        for side in ax.spines.values():
            side.set_visible(False)
        there = {r.agreement[a][b] for a in names for b in names if a != b}
        for relation, (colour, text) in RELATIONS.items():
            if relation in there:
                ax.plot([], [], "s", color=colour, markersize=9, label=text)
        ax.set_title("Agreement of the verdicts")
        handles, told = ax.get_legend_handles_labels()
        fig.legend(handles, told, loc="outside lower center", ncols=2)
        saved = style.save(fig, folder, f"{name}-agreement")
    return (
        saved,
        (
            "Verdicts of the strategies (diagonal) and comparison of each pair. Signs: = same verdict; x "
            "different verdicts; ~ same verdict with different safety factors; ? one verdict is open."
        ),
    )


def _cell(ax: Axes, x: int, y: int, colour: str, text: str, ink: str = style.EDGE) -> None:
    from matplotlib.patches import Rectangle

    ax.add_patch(Rectangle((x - 0.48, y - 0.48), 0.96, 0.96, facecolor=colour, edgecolor="none"))
    if text:
        ax.text(x, y, text, ha="center", va="center", fontsize=7.5, color=ink)


def _hazard(run: Stored, r: Assess, name: str, folder: Path) -> tuple[str, str]:
    """The motion of single runs, with the static capacities as constant accelerations and the primary impulse."""
    time, ground = run.array(name, "time"), run.array(name, "ground") / 9.80665
    rows = [v for v in r.verdicts if v.axis == "acceleration" and v.status == "ok" and v.capacity is not None]
    with style.figure(7.2, 3.2) as (fig, (ax,)):
        ax.plot(time, ground, color=style.EDGE, linewidth=0.7, label="ground acceleration")
        for row, line in zip(rows, ("--", ":", "-."), strict=False):
            for k, side in enumerate((1.0, -1.0)):
                ax.axhline(
                    side * (row.capacity or 0.0),
                    color=style.THRUST,
                    linewidth=1.0,
                    linestyle=line,
                    label=f"capacity by {row.label}" if k == 0 else None,
                )
        told = ""
        if r.hazard.pulse_amplitude_g is not None and r.hazard.pulse_period_s is not None:
            told = (
                f" The primary impulse of the motion is a sine with an amplitude of {r.hazard.pulse_amplitude_g:.3g} "
                f"g and a period of {r.hazard.pulse_period_s:.3g} s."
            )
        most = max([float(np.abs(ground).max()), *(row.capacity or 0.0 for row in rows)])
        ax.set_ylim(-1.15 * most, 1.15 * most)
        ax.set_xlim(time[0], time[-1])
        ax.set_xlabel("time [s]")
        ax.set_ylabel("acceleration [g]")
        ax.set_title("The hazard, compared with the capacities under constant horizontal acceleration")
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-hazard")
    return saved, f"{r.hazard.told[:1].upper()}{r.hazard.told[1:]}.{told}"


#: Panels of the tornado: names of the results, title, axis
PANELS = (
    ("tilt", "Margin of limit analysis", "factor on the hazard"),
    ("rocking", "Margin of rocking", "factor on the hazard"),
    ("dem", "Discrete elements", "displacement / displacement of collapse"),
)


def _tornado(r: Assess, folder: Path, name: str) -> tuple[str, str] | None:
    """Margins of limit analysis and rocking, and movements of elements, with each value moved down and up, the widest above."""
    rows = r.sensitivity or []
    if not rows:
        return None
    panels = [p for p in PANELS if any(getattr(row, f"{p[0]}_low") is not None for row in rows)]
    if not panels:
        return None
    with style.figure(2.2 + 2.6 * len(panels), 1.7 + 0.42 * len(rows), columns=len(panels), sharey=True) as (fig, axes):
        for ax, (strategy, title, axis) in zip(axes, panels, strict=True):
            here = next((v for row in rows if (v := getattr(row, f"{strategy}_base")) is not None), None)
            for k, row in enumerate(rows):
                low, high = getattr(row, f"{strategy}_low"), getattr(row, f"{strategy}_high")
                # where both ends lie to one side, each has half of the bar's height
                apart = None not in (low, high, here) and (low - here) * (high - here) > 0.0
                for value, colour, up in ((low, "#d98200", -1.0), (high, style.HINGE, 1.0)):
                    if value is not None and here is not None:
                        ax.plot(
                            [here, value], [k + 0.13 * up * apart] * 2, color=colour, linewidth=5.0 if apart else 8.0, solid_capstyle="butt"
                        )
            ax.plot([], [], color="#d98200", linewidth=8.0, label="value below")
            ax.plot([], [], color=style.HINGE, linewidth=8.0, label="value above")
            if here is not None:
                ax.axvline(here, color=style.EDGE, linewidth=0.8)
            ax.axvline(1.0, color=style.THRUST, linewidth=1.0, linestyle="--", label="the verdict changes")
            ax.set_title(title)
            ax.set_xlabel(axis)
            ax.grid(axis="y", visible=False)
        units = [f" {row.unit}" if row.unit else "" for row in rows]
        labels = [f"{_short(row.key)}\n{row.low:.4g} to {row.high:.4g}{u}" for row, u in zip(rows, units, strict=True)]
        axes[0].set_yticks(range(len(rows)), labels, fontsize=7.5)
        axes[0].set_ylim(len(rows) - 0.4, -0.6)
        style.legend_below(fig, axes[0])
        saved = style.save(fig, folder, f"{name}-sensitivity")
    turned = [
        f"{row.key} {value:.3g}{f' {row.unit}' if row.unit else ''} ({label})"
        for row in rows
        for label, value in (("limit analysis", row.tilt_turns), ("rocking", row.rocking_turns), ("discrete elements", row.dem_turns))
        if value is not None
    ]
    told = f" Verdicts change at: {'; '.join(turned)}." if turned else " None of the calculated values changes a verdict."
    if any(row.dem_base is not None for row in rows):
        told += " For discrete elements: displacement of the blocks, divided by the displacement that counts as collapse."
    return saved, f"Safety factors if one value of the deck varies and all others keep their values.{told}"


def _short(key: str) -> str:
    """A key of the deck as the tornado calls it."""
    return "right support moves" if key == "initial.movements.dx" else key.split(".", 1)[1]
