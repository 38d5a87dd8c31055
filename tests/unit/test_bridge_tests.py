"""The table of load tests in docs/bridges.md is what the rows of cases/bridge say; bias and scatter from them."""

import math
import re
import statistics
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BRIDGES = ("Bridgemill", "Bargower", "Preston", "Prestwood", "Torksey", "Shinafoot", "Strathmashie", "Barlae")
#: Their loads are from memory: no source could be read, so no row calls them measured
FROM_MEMORY = ("Bridgemill", "Bargower")
MODELS = ("ring alone", "fill", "fill and passive pressure", "backing", "no crushing")


def ratios(bridge: str) -> dict[str, float | None]:
    """Test over computed by model; None where the model cannot stand."""
    rows = tomllib.loads((ROOT / f"cases/bridge/{bridge.lower()}.expect.toml").read_text(encoding="utf-8"))["expect"]
    found: dict[str, float | None] = {}
    for row in rows:
        model = row.get("note", row.get("source", "")).split(":")[0]
        if row["quantity"] == "moving-load.safety_factor":
            found[model] = 1.0 / row["value"] if row["value"] > 0.0 else None
    return found


def bias_and_scatter(values: list[float]) -> tuple[float, float]:
    """Geometric mean of test over computed, and the factor of one standard deviation of its logarithm."""
    logs = [math.log(v) for v in values]
    return math.exp(statistics.mean(logs)), math.exp(statistics.stdev(logs))


def table() -> str:
    """The table as the page shows it."""
    lines = ["| bridge | test [kN] | " + " | ".join(MODELS) + " |", "|---" * (2 + len(MODELS)) + "|"]
    columns: dict[str, list[float]] = {model: [] for model in MODELS}
    for bridge in BRIDGES:
        deck = tomllib.loads((ROOT / f"cases/bridge/{bridge.lower()}.toml").read_text(encoding="utf-8"))
        found = ratios(bridge)
        cells = []
        for model in MODELS:
            value = found[model]
            cells.append("does not stand" if value is None else f"{value:.2f}")
            if value is not None:
                columns[model].append(value)
        load = deck["analysis"][0]["force"].split()[0] + (" (memory)" if bridge in FROM_MEMORY else "")
        lines.append(f"| {bridge} | {load} | " + " | ".join(cells) + " |")
    both = [bias_and_scatter(columns[model]) for model in MODELS]
    lines.append("| bias (geometric mean) | | " + " | ".join(f"{bias:.2f}" for bias, _ in both) + " |")
    lines.append("| scatter (factor of one standard deviation) | | " + " | ".join(f"{s:.2f}" for _, s in both) + " |")
    return "\n".join(lines)


def test_the_page_shows_the_rows() -> None:
    page = (ROOT / "docs/bridges.md").read_text(encoding="utf-8")
    assert table() in page
    bias, scatter = bias_and_scatter([v for b in BRIDGES if (v := ratios(b)["fill and passive pressure"])])
    assert f"scatter by a factor of {scatter:.1f} about a bias of {bias:.1f}" in re.sub(r"\s+", " ", page)
    torksey = ratios("Torksey")
    assert f"carry {torksey['three rings'] / torksey['fill and passive pressure']:.1f} times less" in re.sub(r"\s+", " ", page)


def test_documented_loads_are_rows_of_experiments() -> None:
    for bridge in BRIDGES:
        rows = tomllib.loads((ROOT / f"cases/bridge/{bridge.lower()}.expect.toml").read_text(encoding="utf-8"))["expect"]
        deck = tomllib.loads((ROOT / f"cases/bridge/{bridge.lower()}.toml").read_text(encoding="utf-8"))
        measured = [row["value"] for row in rows if row["kind"] == "experiment"]
        load = 1e3 * float(deck["analysis"][0]["force"].split()[0])
        assert measured == ([] if bridge in FROM_MEMORY else [load])
