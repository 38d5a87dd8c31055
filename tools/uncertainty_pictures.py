"""Pictures and table of docs/how-wrong.md, from the model uncertainty that `make verify` writes into the package."""

import math
from pathlib import Path

from matplotlib.figure import Figure

from extrados.results.uncertainty import ModelUncertainty, read_uncertainties

#: A one-sided quantile of the normal distribution: 95 %
Z95 = 1.6449
COMPARISONS = {"exact": "exact solutions", "peer": "other programs and methods", "thesis": "the dissertation", "experiment": "experiments"}
COLOURS = {"exact": "#6c757d", "peer": "#2a6f97", "thesis": "#c9a66b", "experiment": "#b02a1e"}


def label(row: ModelUncertainty) -> str:
    """Strategy, quantity and count of a row."""
    return f"{row.strategy}: {row.quantity} ({row.count})"


def experiments() -> Figure:
    """Bias, one and 1.645 standard deviations, and the worst case of each quantity that was compared with experiments."""
    rows = sorted((row for row in read_uncertainties() if row.comparison == "experiment"), key=lambda row: row.bias)
    figure = Figure(figsize=(9.0, 0.62 * len(rows) + 1.3), layout="constrained")
    ax = figure.subplots()
    for k, row in enumerate(rows):
        for width, deviations in ((1.5, Z95), (5.0, 1.0)):
            ends = [row.bias * math.exp(sign * deviations * row.scatter) for sign in (-1, 1)]
            ax.plot(ends, [k, k], color=COLOURS["experiment"], linewidth=width, alpha=0.75, solid_capstyle="butt")
        ax.plot(row.bias, k, "o", color="black", markersize=6)
        ax.plot(row.worst_ratio, k, "x", color="black", markersize=7)
    ax.axvline(1.0, color="black", linewidth=0.8)
    ax.set_xscale("log")
    ticks = [0.25, 0.33, 0.5, 0.67, 0.8, 1.0, 1.25, 1.5, 2.0]
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.minorticks_off()
    ax.set_yticks(range(len(rows)), [label(row) for row in rows])
    ax.set_ylim(-0.6, len(rows) - 0.4)
    ax.set_xlabel("computed / measured")
    ax.grid(axis="x", alpha=0.3)
    return figure


def deviations() -> Figure:
    """The greatest deviation of every strategy from each sort of comparison, over all its quantities."""
    rows = read_uncertainties()
    strategies = list(dict.fromkeys(row.strategy for row in rows))[::-1]
    figure = Figure(figsize=(9.0, 0.42 * len(strategies) + 1.3), layout="constrained")
    ax = figure.subplots()
    for shift, (comparison, name) in zip((-0.24, -0.08, 0.08, 0.24), COMPARISONS.items(), strict=True):
        worst = [
            (k + shift, max(abs(row.worst_ratio - 1.0), 1e-5))
            for k, strategy in enumerate(strategies)
            for row in rows
            if row.strategy == strategy and row.comparison == comparison
        ]
        ax.plot([x for _, x in worst], [y for y, _ in worst], "o", color=COLOURS[comparison], label=name, markersize=5)
    ax.set_xscale("log")
    ticks = [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0]
    ax.set_xticks(ticks, ["0.001 % or less", "0.01 %", "0.1 %", "1 %", "10 %", "100 %"])
    ax.set_yticks(range(len(strategies)), strategies)
    ax.set_xlabel("greatest deviation of a quantity")
    ax.legend(loc="lower center", bbox_to_anchor=(0.4, 1.0), ncols=4, frameon=False)
    ax.grid(axis="x", alpha=0.3)
    return figure


def table() -> str:
    """Rows of the experiments: bias, scatter, and the factor that a computed value has to be divided by for a 5 % fractile."""
    lines = ["| strategy | quantity | tests | bias | scatter | 5 % fractile / computed | worst case |", "|---|---|---|---|---|---|---|"]
    for row in read_uncertainties():
        if row.comparison == "experiment":
            fractile = math.exp(-Z95 * row.scatter) / row.bias
            lines.append(
                f"| {row.strategy} | {row.quantity} | {row.count} | {row.bias:.2f} | {row.scatter:.2f} | {fractile:.2f} | "
                f"`cases/{row.worst_case}`: {row.worst_ratio:.2f} |"
            )
    return "\n".join(lines) + "\n"


def write(folder: Path) -> None:
    """All of them, into a folder."""
    experiments().savefig(folder / "uncertainty-experiments.png", dpi=130)
    deviations().savefig(folder / "uncertainty-deviations.png", dpi=130)
    (folder / "uncertainty.md").write_text(table(), encoding="utf-8")
