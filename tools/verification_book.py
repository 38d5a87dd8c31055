"""Write docs/verification.md: every row of every case with what was found, grouped by kind of proof."""

import json
import math
import sys
from pathlib import Path
from statistics import mean, stdev

ROOT = Path(__file__).resolve().parents[1]
BOOK = ROOT / "docs" / "verification.md"
sys.path.insert(0, str(ROOT / "tests" / "cases"))

from expectations import KINDS, Row, load_cases, pick, results_of  # noqa: E402

TRIALS = "## Trials"
TITLES = {
    "exact": "Verification: exact solutions",
    "peer": "Verification: independent programs, and unlike methods of this one",
    "thesis": "Reproduction of the dissertation",
    "experiment": "Validation: experiments",
    "regression": "Regression: unchanged numbers",
}


#: Measured numbers of one folder from which on bias and scatter are told
ENOUGH = 5
#: What a row of a measured curve compares
COMPARED = {
    "peak_ratio": "peak", "tail_ratios[0]": "tail at 75 % of the peak", "tail_ratios[1]": "tail at 50 %",
    "tail_ratios[2]": "tail at 25 %",
}  # fmt: skip


def shown(value: object) -> str:
    """A value in a table cell."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def line(case: str, row: Row, found: object) -> str:
    """One row of a table."""
    change = ", ".join(f"{k} = {v}" for k, v in row.change)
    verdict = "" if row.fits(found) else " **differs**"
    allowed = "" if isinstance(row.value, str) else f" ± {row.allowed:.2g}"
    note = f" ({row.note})" if row.note else ""
    return (
        f"| {case} | {change} | `{row.quantity}` | {shown(row.value)}{allowed} | {shown(found)}{verdict} "
        f"| {row.source}{note} |"
    )


def of_loads(ratios: dict[str, list[float]]) -> list[str]:
    """Bias and scatter of measured over computed, by folder of cases, where there are enough rows."""
    rows = []
    for folder, values in ratios.items():
        if len(values) >= ENOUGH:
            logs = [math.log(v) for v in values]
            middle, spread = math.exp(mean(logs)), math.exp(stdev(logs))
            rows.append(f"| {folder} | {len(values)} | {middle:.2f} | {spread:.2f} |")
    if not rows:
        return []
    head = "| cases | rows | bias (geometric mean of measured over computed) | scatter (factor of one standard deviation) |"
    return ["### Bias and scatter of single numbers", "", f"{head}\n|---|---|---|---|", *rows, ""]


def trials(book: str) -> list[str]:
    """What was tried and did not hold, as the trials of tests/trials and tools/seeded_faults.py noted it; what the book
    tells of a trial stays where that trial has not been run since."""
    section = book.partition(f"{TRIALS}\n")[2]
    lines = {
        row.split(" | ")[0]: row for row in section.split("\n") if row.startswith("| ") and "looked for" not in row
    }
    for path in sorted((ROOT / "build" / "trials").glob("*.json")):
        r = json.loads(path.read_text(encoding="utf-8"))
        row = f"| {r['what']} | {r['tried']:,} | {r['failures']} | {'; '.join(r['notes'])} |".replace("\n", " ")
        lines[row.split(" | ")[0]] = row
    if not lines:
        return []
    return [TRIALS, "", "From fixed seeds; a failure is one of what the first column says.", "",
            "| looked for | tried | found | |\n|---|---|---|---|", *sorted(lines.values()), ""]  # fmt: skip


def with_trials_alone(book: str) -> str:
    """The book with the section of the trials written anew, and all else as it was."""
    return book.split(f"{TRIALS}\n")[0].rstrip() + "\n\n" + "\n".join(trials(book))


def bias(rows: list[tuple[str, Row, object]]) -> list[str]:
    """Bias and scatter of the curves that were compared with measured ones, by what of them was compared."""
    groups: dict[str, list[tuple[str, float]]] = {}
    for case, row, found in rows:
        place, _, name = row.quantity.partition(".measured.")
        if row.kind == "experiment" and name and isinstance(found, int | float):
            groups.setdefault(f"{place}: {COMPARED[name]}", []).append((case, float(found)))
    lines = []
    for what, found in groups.items():
        values = [value for _, value in found]
        spread = f"{100 * stdev(values):.0f} %" if len(values) > 1 else "-"
        each = ", ".join(f"{case.rpartition('/')[2]} {value:.2f}" for case, value in found)
        lines.append(f"| {what} | {len(values)} | {100 * (mean(values) - 1):+.0f} % | {spread} | {each} |")
    return lines


def main() -> int:
    """Run all cases; the number of rows that differ."""
    tables: dict[str, list[str]] = {kind: [] for kind in KINDS}
    ratios: dict[str, list[float]] = {}
    all_rows: list[tuple[str, Row, object]] = []
    wrong = 0
    for case in load_cases():
        for change in dict.fromkeys(row.change for row in case.rows):
            results = results_of(case, change)
            for row in (r for r in case.rows if r.change == change):
                found = pick(results, row.quantity)
                wrong += not row.fits(found)
                measured = row.kind == "experiment" and ".measured." not in row.quantity
                if measured and isinstance(found, float) and row.value > 0.0 and found > 0.0:
                    ratios.setdefault(case.name.split("/")[0], []).append(row.value / found)
                tables[row.kind].append(line(case.name, row, found))
                all_rows.append((case.name, row, found))
        print(case.name, flush=True)
    parts = ["# Verification book", "", "Written by `make verify` from `cases/`; do not edit.", ""]
    for kind, title in TITLES.items():
        if tables[kind]:
            head = "| case | change | quantity | expected | found | source |\n|---|---|---|---|---|---|"
            parts += [f"## {title}", "", f"{len(tables[kind])} rows.", ""]
            if kind == "experiment" and (found := bias(all_rows)):
                parts += [
                    "Computed over measured, of whole measured curves (bias: mean less one; scatter: standard deviation):", "",
                    "| | tests | bias | scatter | each |\n|---|---|---|---|---|", *found, "",
                ]  # fmt: skip
            parts += [head, *tables[kind], ""]
        if kind == "experiment":
            parts += of_loads(ratios)
    parts += trials(BOOK.read_text(encoding="utf-8") if BOOK.exists() else "")
    BOOK.write_text("\n".join(parts), encoding="utf-8")
    print(f"docs/verification.md: {sum(map(len, tables.values()))} rows, {wrong} differ")
    return wrong


if __name__ == "__main__":
    if sys.argv[1:] == ["--trials"]:
        BOOK.write_text(with_trials_alone(BOOK.read_text(encoding="utf-8")), encoding="utf-8")
        sys.exit()
    sys.exit(min(main(), 1))
