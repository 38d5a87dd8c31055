"""Write the verification book: docs/verification.md with the agreement of strategies and quantities, a page for each strategy in
docs/verification/ with every row of every case, and the table of model uncertainty of the package.

    python tools/verification_book.py [--pages | --trials]

Runs the cases of cases/ whose values are not kept (build/verification, filled by the tests of cases too), so that an interrupted run
continues, and writes the book with a plot for each strategy and quantity. `--pages` writes the book from the kept results: values found
before the program's last change are marked, those of another deck, of other data or of other rows are skipped, and both are
reported. `--trials` writes the section of trials alone anew.
"""

import argparse
import csv
import json
import math
import re
import sys
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import mean, stdev
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
BOOK = ROOT / "docs" / "verification.md"
PLOTS = ROOT / "docs" / "verification"
UNCERTAINTY = ROOT / "python" / "extrados" / "results" / "model_uncertainty.csv"
NOTES = ROOT / "build" / "trials"
sys.path[:0] = [str(ROOT / "tests" / "cases"), str(ROOT / "tools")]

import kept  # noqa: E402
from expectations import KINDS, LOOSE, PROOFS, Case, Row, load_cases, origin_of, origins  # noqa: E402
from verification_quantities import QUANTITIES, quantity_of  # noqa: E402

TRIALS = "## Trials"
RELATIONS = "## Relations between strategies"
TITLES = {
    "exact": "Verification: exact solutions",
    "peer": "Verification: independent programs, and unlike methods of this one",
    "thesis": "Reproduction of the dissertation",
    "experiment": "Validation: experiments",
    "bound": "Bounds: one-sided statements",
    "inferred": "Inferred: sizes chosen so that a printed number comes out, no verification",
    "calibration": "Calibrations: fitted, no verification",
    "regression": "Regression: unchanged numbers",
}
#: Other kinds, as the tables of agreement count them
COUNTED = ("bound", "inferred", "calibration", "regression")
HEAD = "exact | other programs and methods | dissertation | experiments | bounds | inferred | calibrated | regression |"
COLOURS = {"exact": "#0072B2", "peer": "#009E73", "thesis": "#E69F00", "experiment": "#D55E00"}
MARKS = {"exact": "o", "peer": "s", "thesis": "^", "experiment": "D"}
#: Seconds from which on the book states the time of a case
LONG = 60.0
#: Mark of results found before the program's last change
OLDER = "*"
#: Quantity compared by a row of a measured curve
COMPARED = {
    "peak_ratio": "peak",
    "tail_ratios[0]": "tail at 75 % of the peak",
    "tail_ratios[1]": "tail at 50 %",
    "tail_ratios[2]": "tail at 25 %",
}


#: Tables of tested walls, predicted by one fixed rule (tools/wall_tests.py), the method of each strategy, and the analysis that it uses
WALLS = ROOT / "tests" / "verification"
WALL_TABLES = ("wall-tests.csv", "stone-walls.csv")
WALL_METHODS = {"frame": "frame-pushover", "NTC": "code-checks", "membrane": "sla", "units": "sla"}
#: Predictions by units and joints, recorded because a wall takes minutes of processor time
UNITS = "wall-tests-units.csv"


@dataclass(frozen=True)
class Found:
    """A row of a case and the value of the program; `older`: before the program's last change; `series`: of a table of tests, which
    bias and scatter judge, and no tolerance of a single test."""

    case: str
    row: Row
    value: Any
    older: bool = False
    series: bool = False

    @property
    def wrong(self) -> bool:
        """Whether the value is outside the tolerance of its row."""
        return not self.series and not self.row.fits(self.value)

    @property
    def quantity(self) -> str:
        return quantity_of(self.row.quantity)

    @property
    def ratio(self) -> float | None:
        """Found over expected; None for words, and where zero is expected."""
        if isinstance(self.row.value, str) or not isinstance(self.value, int | float) or not self.row.value:
            return None
        return float(self.value) / float(self.row.value)


def shown(value: object) -> str:
    """A value in a table cell."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def percent(value: float) -> str:
    """A share in percent with two digits, as small as it may be."""
    return f"{100 * value:+.2g} %" if abs(value) < 0.1 else f"{100 * value:+.0f} %"


def line(found: Found) -> str:
    """One row of a table."""
    row = found.row
    change = ", ".join(f"{k} = {v}" for k, v in row.change)
    verdict = f"{OLDER if found.older else ''}{' **differs**' if found.wrong else ''}"
    allowed = "" if isinstance(row.value, str) or found.series else f" ± {row.allowed:.2g}"
    tests = f"; tests ± {100 * row.scatter:.2g} %" if isinstance(row.scatter, float) else f"; {row.scatter}" if row.scatter else ""
    note = f" ({row.note})" if row.note else ""
    origin = origin_of(row)
    return (
        f"| {found.case} | {change} | `{row.quantity}` | {shown(row.value)}{allowed}{tests} | {shown(found.value)}{verdict} "
        f"| {row.source}{note} | {origin['name'] if origin else ''} |"
    )


def table(rows: Iterable[Found]) -> list[str]:
    """Rows one by one."""
    rows = list(rows)
    last = "why there is no outside value" if rows and rows[0].row.kind == "regression" else "source"
    head = f"| case | change | quantity | expected | found | {last} | origin |\n|---|---|---|---|---|---|---|"
    return [head, *map(line, rows), ""]


def told(rows: list[Found], proof: str) -> str:
    """Agreement of the rows of one quantity and kind of comparison: number, and bias and scatter of found over expected or, for
    exact solutions, the greatest deviation."""
    if not rows:
        return ""
    ratios = [found.ratio for found in rows if found.ratio is not None]
    cell = str(len(rows))
    if not ratios:
        return cell
    if proof in ("exact", "peer"):
        return f"{cell}: within {100 * max(abs(ratio - 1.0) for ratio in ratios):.2g} %"
    spread = f" ± {100 * stdev(ratios):.2g} %" if len(ratios) > 1 else ""
    return f"{cell}: {percent(mean(ratios) - 1.0)}{spread}"


def agreement(rows: list[Found]) -> str:
    """Cells of a table: the agreement by kind of comparison, and the numbers of other rows."""
    cells = [told([found for found in rows if found.row.kind == proof], proof) for proof in PROOFS]
    return " | ".join([*cells, *(str(sum(found.row.kind == kind for found in rows) or "") for kind in COUNTED)])


def by_quantity(rows: list[Found]) -> list[str]:
    """The comparisons of every quantity, and their agreement."""
    lines = []
    for quantity in QUANTITIES:
        of = [found for found in rows if found.quantity == quantity]
        picture = f"[{quantity}](verification/{slug(quantity)}.svg)" if plotted(of) else quantity
        lines.append(f"| {picture} | {agreement(of)} |")
    return [
        "## Quantity by quantity",
        "",
        "Rows of each quantity, by the kind of comparison. Exact solutions and other programs: the greatest deviation;",
        "the dissertation and experiments: bias (mean of found / expected, minus one) and scatter (standard deviation).",
        "Zeros and words have no ratio and are in the tables of the strategies. Bounds are one-sided. Sizes of inferred rows",
        "and factors of calibrated rows were chosen to reproduce a value. Regressions compare the program with itself. None of these",
        "enters bias or scatter. Crack paths are compared by eye, because no numbers of a path are printed (docs/sla.md).",
        "",
        f"| quantity | {HEAD}",
        "|---|---|---|---|---|---|---|---|---|",
        *lines,
        "",
    ]


@cache
def strategies() -> list[dict[str, Any]]:
    """Strategies of the book, with their analyses and the conditions that they do not cover."""
    return tomllib.loads((ROOT / "tools" / "verification_strategies.toml").read_text(encoding="utf-8"))["strategy"]


@cache
def strategy_of(row: Row) -> str:
    """Name of the strategy of a row's analysis."""
    analysis = re.sub(r"-\d+$", "", row.quantity.split(".")[0])
    return next(s["name"] for s in strategies() if analysis in s["analyses"])


def by_strategy(rows: list[Found]) -> list[str]:
    """The comparisons of every strategy, and its page."""
    lines, pages = [], []
    for strategy in strategies():
        of = [found for found in rows if strategy_of(found.row) == strategy["name"]]
        page = f"verification/{slug(strategy['name'])}"
        lines.append(f"| [{strategy['name']}]({page}.md) | {agreement(of)} |")
        pages.append(page)
    return [
        "## Strategy by strategy",
        "",
        "Each strategy has a page with a plot, the worst case and its reason, the conditions that it does not cover, and all rows.",
        "`extrados.results.uncertainty` reads bias and scatter of each strategy from the package.",
        "",
        f"| strategy | {HEAD}",
        "|---|---|---|---|---|---|---|---|---|",
        *lines,
        "",
        "```{toctree}\n:hidden:\n",
        *pages,
        "```",
        "",
    ]


def worst(rows: list[Found]) -> Found | None:
    """The row farthest from its number: of the experiments, else of the dissertation, of other programs, of exact solutions."""
    for proof in reversed(PROOFS):
        of = [found for found in rows if found.row.kind == proof and (found.ratio or 0.0) > 0.0]
        if of:
            return max(of, key=lambda found: abs(math.log(found.ratio or 1.0)))
    return None


def page_of(strategy: dict[str, Any], rows: list[Found]) -> str:
    """The page of a strategy."""
    name = strategy["name"]
    parts = [f"# {name[0].upper()}{name[1:]}: verification", "", "Written by `make verify` from `cases/`; do not edit.", ""]
    analyses = ", ".join(f"`{analysis}`" for analysis in strategy["analyses"])
    parts += [f"Analyses: {analyses}. {len(rows)} rows.", ""]
    if plotted(rows):
        parts += [f"![predicted and measured](strategy-{slug(name)}.svg)", ""]
    parts += [f"| {HEAD}", "|---|---|---|---|---|---|---|---|", f"| {agreement(rows)} |", ""]
    if far := worst(rows):
        reason = far.row.wide or far.row.note or "within its tolerance"
        if far.series:
            reason = f"one test of a series ({far.row.note}); strengths are assumed by one rule for the whole series"
        parts += [
            f"**Worst case** ({far.row.kind}): {far.case}, `{far.row.quantity}`, found {shown(far.value)} for {shown(far.row.value)}, "
            f"{percent((far.ratio or 1.0) - 1.0)}. {reason[0].upper()}{reason[1:]}.",
            "",
        ]
    parts += ["## Not covered", "", *(f"- {text}" for text in strategy["not_covered"]), ""]
    for kind, title in TITLES.items():
        of = [found for found in rows if found.row.kind == kind]
        if of:
            parts += [f"## {title}", "", f"{len(of)} rows.", ""]
            parts += of_curves(of) if kind == "experiment" else []
            parts += table(of)
    return "\n".join(parts)


def statistics_of(rows: list[Found]) -> list[dict[str, Any]]:
    """Bias (geometric mean of found over expected) and scatter (standard deviation of its logarithm) by strategy, quantity and kind of
    comparison, where at least two rows have a ratio."""
    lines = []
    for strategy in strategies():
        for quantity in QUANTITIES:
            for proof in PROOFS:
                of = [
                    found
                    for found in rows
                    if (strategy_of(found.row), found.quantity, found.row.kind) == (strategy["name"], quantity, proof)
                    and (found.ratio or 0.0) > 0.0
                ]
                if len(of) > 1:
                    logs = [math.log(found.ratio or 1.0) for found in of]
                    far = max(of, key=lambda found: abs(math.log(found.ratio or 1.0)))
                    lines.append(
                        {
                            "strategy": strategy["name"],
                            "analyses": " ".join(strategy["analyses"]),
                            "quantity": quantity,
                            "comparison": proof,
                            "count": len(of),
                            "bias": f"{math.exp(mean(logs)):.4f}",
                            "scatter": f"{stdev(logs):.4f}",
                            "worst_case": far.case,
                            "worst_ratio": f"{far.ratio:.4f}",
                        }
                    )
    return lines


def write_uncertainty(rows: list[Found]) -> None:
    """The table of model uncertainty of the package."""
    lines = statistics_of(rows)
    with UNCERTAINTY.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(lines[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(lines)


def who_computed(rows: list[Found]) -> list[str]:
    """Who computed the other numbers, their basis and date, and the test that computes them anew."""
    lines = []
    for origin in origins():
        count = sum(origin_of(found.row) == origin for found in rows)
        lines.append(
            f"| {origin['name']} | {TITLES[origin['kind']].split(':')[0]} | {count} | {origin['who']} | {origin['basis']} | {origin['when']} | {origin['repeated']} |"
        )
    return [
        "## Who computed the other number",
        "",
        "The last column of the tables of each strategy names one of these.",
        "",
        "| origin | kind | rows | who | basis | when | repeated by |",
        "|---|---|---|---|---|---|---|",
        *lines,
        "",
    ]


def slug(quantity: str) -> str:
    """A quantity as the name of a file."""
    return quantity.replace(",", "").replace(" ", "-")


def plotted(rows: Iterable[Found]) -> list[Found]:
    """The rows that a plot can show: of numbers that were compared with something else."""
    return [found for found in rows if found.row.kind in PROOFS and found.ratio is not None]


def draw(rows: list[Found]) -> None:
    """A plot for each quantity: found over expected, row by row as the book's tables have them."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams |= {"svg.hashsalt": "verification", "svg.fonttype": "none", "font.size": 9}
    PLOTS.mkdir(exist_ok=True)
    for old in PLOTS.glob("*.svg"):
        old.unlink()
    for quantity in QUANTITIES:
        shown_rows = plotted(found for found in rows if found.quantity == quantity)
        if not shown_rows:
            continue
        figure, axes = plt.subplots(figsize=(5.4, 3.6), layout="constrained")
        axes.axhspan(1.0 - LOOSE, 1.0 + LOOSE, color="0.92", lw=0, label=f"within {100 * LOOSE:.0f} %")
        axes.axhline(1.0, color="0.3", lw=0.8)
        first = 1
        for proof in PROOFS:
            ratios = [found.ratio for found in shown_rows if found.row.kind == proof]
            if ratios:
                axes.plot(
                    range(first, first + len(ratios)),
                    ratios,
                    MARKS[proof],
                    ms=4.5,
                    mew=0.8,
                    mfc="none",
                    color=COLOURS[proof],
                    label=f"{proof} ({len(ratios)})",
                )
            first += len(ratios)
        low, high = axes.get_ylim()
        axes.set(
            xlim=(0.0, first),
            ylim=(min(low, 1.0 - 1.5 * LOOSE), max(high, 1.0 + 1.5 * LOOSE)),
            title=quantity,
            xlabel="row, by its kind of comparison",
            ylabel="found over expected",
        )
        axes.xaxis.get_major_locator().set_params(integer=True)
        figure.legend(frameon=False, fontsize=8, loc="outside lower center", ncols=3)
        figure.savefig(PLOTS / f"{slug(quantity)}.svg", metadata={"Date": None})
        plt.close(figure)


def draw_strategies(rows: list[Found]) -> None:
    """A plot for each strategy: predicted against measured (or printed, or exact) values on logarithmic axes, and the ratios of the kind
    of comparison that is nearest to reality, with the scatter of the tests themselves."""
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullFormatter

    for strategy in strategies():
        of = plotted(found for found in rows if strategy_of(found.row) == strategy["name"])
        if not of:
            continue
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 4.2), layout="constrained")
        nearest = next(proof for proof in reversed(PROOFS) if any(f.row.kind == proof for f in of))
        for proof in PROOFS:
            some = sorted((f for f in of if f.row.kind == proof and (f.ratio or 0.0) > 0.0), key=lambda f: f.ratio or 0.0)
            if not some:
                continue
            look = {"ms": 4.5, "mew": 0.8, "mfc": "none", "color": COLOURS[proof], "ls": "none", "marker": MARKS[proof]}
            left.plot([abs(f.row.value) for f in some], [abs(f.value) for f in some], label=f"{proof} ({len(some)})", **look)
            if proof == nearest:
                for place, f in enumerate(some, 1):
                    if isinstance(f.row.scatter, float):
                        band = [1.0 - f.row.scatter, 1.0 + f.row.scatter]
                        right.plot([place, place], band, color="0.8", lw=4, solid_capstyle="butt")
                right.plot(range(1, len(some) + 1), [f.ratio for f in some], **look)
        left.set(xscale="log", yscale="log", xlabel="expected: measured, printed or exact [SI]", ylabel="predicted [SI]")
        for axis in (left.xaxis, left.yaxis):  # numbers of minor ticks overlap
            axis.set_minor_formatter(NullFormatter())
        ends = [min(abs(f.row.value) for f in of), max(abs(f.row.value) for f in of)]
        left.plot(ends, ends, color="0.3", lw=0.8, zorder=0)
        right.axhline(1.0, color="0.3", lw=0.8, zorder=0)
        low, high = right.get_ylim()
        note = "; grey: scatter of the tests" if nearest == "experiment" else ""
        right.set(ylim=(min(low, 0.9), max(high, 1.1)), xlabel=f"row ({nearest}){note}", ylabel="predicted over expected")
        right.xaxis.get_major_locator().set_params(integer=True)
        figure.suptitle(strategy["name"])
        figure.legend(frameon=False, fontsize=8, loc="outside lower center", ncols=4)
        figure.savefig(PLOTS / f"strategy-{slug(strategy['name'])}.svg", metadata={"Date": None})
        plt.close(figure)


def of_curves(rows: list[Found]) -> list[str]:
    """Bias and scatter of the curves that were compared with measured ones, by the compared quantity."""
    groups: dict[str, list[tuple[str, float]]] = {}
    for found in rows:
        place, _, name = found.row.quantity.partition(".measured.")
        if found.row.kind == "experiment" and name and isinstance(found.value, int | float):
            groups.setdefault(f"{place}: {COMPARED[name]}", []).append((found.case, float(found.value)))
    lines = []
    for what, pairs in groups.items():
        values = [value for _, value in pairs]
        spread = f"{100 * stdev(values):.0f} %" if len(values) > 1 else "-"
        each = ", ".join(f"{case.rpartition('/')[2]} {value:.2f}" for case, value in pairs)
        lines.append(f"| {what} | {len(values)} | {100 * (mean(values) - 1):+.0f} % | {spread} | {each} |")
    if not lines:
        return []
    return [
        "Computed over measured, of whole measured curves (bias: mean less one; scatter: standard deviation):",
        "",
        "| | tests | bias | scatter | each |\n|---|---|---|---|---|",
        *lines,
        "",
    ]


def of_units() -> list[str]:
    """Bias and scatter of the recorded predictions of tested walls by units and joints, by measured failure."""
    import wall_tests as tool

    recorded = tool.read_recorded(WALLS / UNITS)
    walls = {wall.name.split()[0]: wall for wall in tool.read_walls(WALLS / WALL_TABLES[0])}
    pairs = [(wall, recorded[n]) for n, wall in walls.items() if n in recorded]
    lines = []
    for mode, name in (("", "all"), ("S", "shear"), ("H", "hybrid"), ("F", "flexure")):
        bias, scatter, count = tool.statistics([pair for pair in pairs if mode in ("", pair[0].mode)])
        lines.append(f"| {name} | {bias:.2f} | {scatter:.2f} | {count} |")
    right, pure = tool.count_right_modes(pairs)
    return [
        "## Tested walls of units and joints",
        "",
        f"Predicted over measured peak of {len(walls)} walls by one rule (`tools/wall_tests.py --method units`), recorded in `{UNITS}`. The",
        f"failure mode is right for {right} of {pure} walls that failed in one mode. "
        f"{sum(1 for n in walls if not recorded.get(n, tool.Predicted()).strength > 0.0)} walls have no prediction.",
        "",
        "| failure of the test | bias (geometric mean) | scatter (standard deviation of the logarithm) | walls |",
        "|---|---|---|---|",
        *lines,
        "",
    ]


def trials(book: str) -> list[str]:
    """Failures found by the trials of tests/trials and tools/seeded_faults.py; the entry of a trial that has not run
    since stays in the book."""
    section = book.partition(f"{TRIALS}\n")[2]
    lines = {row.split(" | ")[0]: row for row in section.split("\n") if row.startswith("| ") and "looked for" not in row}
    entries = [json.loads(p.read_text(encoding="utf-8")) for p in sorted(NOTES.glob("*.json"))]
    if asked := {p.stem: json.loads(p.read_text(encoding="utf-8")) for p in sorted((NOTES / "relations").glob("*.json"))}:
        broken = [name for name, one in asked.items() if one["broken"]]
        entries.append(
            {
                "what": "random buildings that break a relation between results",
                "tried": sum(one["asked"] for one in asked.values()),
                "failures": len(broken),
                "notes": [f"{len(asked)} relations", *broken],
            }
        )
    for r in entries:
        row = f"| {r['what']} | {r['tried']:,} | {r['failures']} | {'; '.join(r['notes'])} |".replace("\n", " ")
        lines[row.split(" | ")[0]] = row
    if not lines:
        return []
    return [
        TRIALS,
        "",
        "From fixed seeds; the first column defines a failure.",
        "",
        "| looked for | tried | found | |\n|---|---|---|---|",
        *sorted(lines.values()),
        "",
    ]


def relations() -> list[str]:
    """The relations of the property suite: each with the analyses that it runs, and its exception."""
    sys.path[:0] = [str(ROOT / "tests" / name) for name in ("properties", "trials") if str(ROOT / "tests" / name) not in sys.path]
    from test_properties import RELATIONS as REGISTRY
    from test_properties import most_of

    rows = [
        f"| {r.name} | {r.holds.__doc__.strip()} | {', '.join(r.asks)} | {r.within:g} | "
        f"{r.exception}{f'broken today, awaits {r.awaits}' if r.awaits else ''} |"
        for r in REGISTRY.values()
    ]
    whole = sum(most_of(r) for r in REGISTRY.values() if not r.awaits)
    return [
        RELATIONS,
        "",
        f"{len(REGISTRY)} relations hold between the results of different analyses of one random building, or of two buildings of which one",
        f"follows from the other. `make verify` draws about {whole:,} buildings of all kinds; the last count is in the table of trials.",
        "",
        "| relation | statement | analyses | tolerance | exception |\n|---|---|---|---|---|",
        *rows,
        "",
    ]


def processor_seconds() -> dict[str, float]:
    """Processor time of all changes of each case whose values are kept [s]."""
    entries = {case.name: [kept.values_of(case, change) for change in {row.change for row in case.rows}] for case in load_cases()}
    return {name: sum(was["seconds"] for was in of if was) for name, of in entries.items()}


def long_cases(seconds: dict[str, float]) -> list[str]:
    """Cases of more than a minute, `seconds` by name: `make verify` runs them and the quick suite does not."""
    lines = [(value, f"| {name} | {value:.0f} |") for name, value in seconds.items() if value > LONG]
    if not lines:
        return []
    return [
        "## Cases of more than a minute",
        "",
        f"Processor time of all changes of the case, on the machine of the last run. {len(lines)} cases.",
        "",
        "| case | seconds |",
        "|---|---|",
        *(line for _, line in sorted(lines, reverse=True)),
        "",
    ]


def with_trials_alone(book: str) -> str:
    """The book with the section of the trials written anew, and all else as it was."""
    return book.split(f"{TRIALS}\n")[0].rstrip() + "\n\n" + "\n".join(trials(book))


def overview(rows: list[Found], book: str) -> str:
    """docs/verification.md; `book`: its former text."""
    parts = ["# Verification book", "", "Written by `make verify` from `cases/`; do not edit.", "", *by_strategy(rows)]
    parts += by_quantity(rows)
    if older := sum(found.older for found in rows):
        parts += [f"{older} values, marked {OLDER}, were found before the program's last change.", ""]
    loose = [found for found in rows if found.row.loose and not found.series]
    parts += [
        f"## Rows that allow more than {100 * LOOSE:.0f} %",
        "",
        f"{len(loose)} rows prove less than the others.",
        "",
        "| case | quantity | expected | found | why |",
        "|---|---|---|---|---|",
        *(
            f"| {f.case} | `{f.row.quantity}` | {shown(f.row.value)} ± {f.row.allowed:.2g} | {shown(f.value)} | {f.row.wide} |"
            for f in loose
        ),
        "",
    ]
    return "\n".join([*parts, *of_units(), *who_computed(rows), *long_cases(processor_seconds()), *relations(), *trials(book)])


def write_book(rows: list[Found], before: str) -> None:
    """All pages, plots and the table of model uncertainty; `before`: the former overview."""
    draw(rows)
    draw_strategies(rows)
    BOOK.write_text(overview(rows, before), encoding="utf-8")
    for old in PLOTS.glob("*.md"):
        old.unlink()
    for strategy in strategies():
        of = [found for found in rows if strategy_of(found.row) == strategy["name"]]
        (PLOTS / f"{slug(strategy['name'])}.md").write_text(page_of(strategy, of), encoding="utf-8")
    write_uncertainty(rows)


def find(case: Case, compute: bool) -> list[Found]:
    """Values of the program for the rows of a case: the kept ones, computed anew where the program or the input has changed since.
    Without `compute` older values are marked, and a case without kept values has no row.
    """
    rows = []
    for change in dict.fromkeys(row.change for row in case.rows):
        was = kept.values_of(case, change)
        if compute and (was is None or was["program"] != kept.program()):
            kept.compute(case, change)
            was = kept.values_of(case, change)
        if was is None:
            print(f"{case.name}: no kept values of this deck, data and rows, skipped", file=sys.stderr)
            return []
        older = was["program"] != kept.program()
        of = [row for row in case.rows if row.change == change]
        rows += [Found(case.name, row, value, older) for row, value in zip(of, was["values"], strict=True)]
    return sorted(rows, key=lambda found: case.rows.index(found.row))


def tested_walls(compute: bool) -> list[Found]:
    """Strength of the walls of all tables by each method that the table's data suffice for: membranes need the bond of the units."""
    import wall_tests as tool

    rows = []
    for table in WALL_TABLES:
        walls = tool.read_walls(WALLS / table)
        methods = ["frame", "codes", *([] if any(math.isnan(wall.cohesion) for wall in walls) else ["membrane"])]
        identity = {"input": kept.checksum([WALLS / table, ROOT / "tools" / "wall_tests.py"])}
        was = kept.load(table)
        if was.get("input") != identity["input"] or (compute and was["program"] != kept.program()):
            if not compute:
                print(f"{table}: not kept, skipped", file=sys.stderr)
                continue
            values = [{name: one.strength for name, one in tool.predict(wall, methods).items()} for wall in walls]
            was = {"program": kept.program(), **identity, "values": values}
            kept.keep(table, was)
        if table == WALL_TABLES[0]:
            recorded = tool.read_recorded(WALLS / UNITS)
            for wall, by in zip(walls, was["values"], strict=True):
                strength = recorded.get(wall.name.split()[0], tool.Predicted()).strength
                by |= {"units": strength} if strength > 0.0 else {}
        for wall, by in zip(walls, was["values"], strict=True):
            for name, analysis in WALL_METHODS.items():
                if name in by:
                    row = Row(
                        f"{analysis}.peak_load_N",
                        wall.peak,
                        0.1,
                        True,
                        "experiment",
                        f"tests/verification/{table}",
                        (),
                        f"failure {wall.failure}",
                        scatter="one test",
                    )
                    case = f"wall {wall.name}" + (", of units" if name == "units" else "")
                    rows.append(Found(case, row, by[name], was["program"] != kept.program(), series=True))
    return rows


def main() -> int:
    """Run all cases; the number of rows that differ."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--pages", action="store_true", help="from the kept results, without computation")
    parser.add_argument("--trials", action="store_true", help="the section of trials alone")
    options = parser.parse_args()
    before = BOOK.read_text(encoding="utf-8") if BOOK.exists() else ""
    if options.trials:
        BOOK.write_text(with_trials_alone(before), encoding="utf-8")
        return 0
    rows: list[Found] = []
    for case in load_cases():
        rows += find(case, not options.pages)
        print(case.name, flush=True)
    rows += tested_walls(not options.pages)
    assert set(TITLES) == set(KINDS)
    write_book(rows, before)
    wrong = sum(found.wrong for found in rows)
    print(f"docs/verification.md: {len(rows)} rows, {wrong} differ")
    return wrong


if __name__ == "__main__":
    sys.exit(min(main(), 1))
