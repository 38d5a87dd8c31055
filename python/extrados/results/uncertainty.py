"""Model uncertainty of the strategies: bias and scatter against tests, as the verification book found them."""

import csv
from dataclasses import dataclass
from pathlib import Path

_TABLE = Path(__file__).with_name("model_uncertainty.csv")


@dataclass(frozen=True)
class ModelUncertainty:
    """Agreement of one quantity of a strategy with numbers from outside.

    bias: geometric mean of computed over outside values; scatter: standard deviation of the natural logarithm of this ratio.
    """

    strategy: str
    analyses: tuple[str, ...]
    quantity: str
    comparison: str  #: exact, peer, thesis or experiment
    count: int
    bias: float
    scatter: float
    worst_case: str
    worst_ratio: float


def read_uncertainties() -> list[ModelUncertainty]:
    """The whole table, written by tools/verification_book.py."""
    with _TABLE.open(encoding="utf-8", newline="") as file:
        return [
            ModelUncertainty(
                row["strategy"], tuple(row["analyses"].split()), row["quantity"], row["comparison"], int(row["count"]),
                float(row["bias"]), float(row["scatter"]), row["worst_case"], float(row["worst_ratio"]),
            )
            for row in csv.DictReader(file)
        ]  # fmt: skip


def uncertainties_of(analysis: str, comparison: str = "experiment") -> list[ModelUncertainty]:
    """The entries of an analysis of this kind, by quantity; empty where nothing was compared in this way."""
    return [row for row in read_uncertainties() if analysis in row.analyses and row.comparison == comparison]
