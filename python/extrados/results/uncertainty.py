"""Model uncertainty of the strategies: bias and scatter against tests, as the verification book found them."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.special import nctdtrinc, ndtr, stdtr

#: Probability outside each end of the interval of a probability: 90 % lie between
TAIL = 0.05
#: Standardised margins beyond this have the ends of their interval there
_FARTHEST = 12.0
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
                row["strategy"],
                tuple(row["analyses"].split()),
                row["quantity"],
                row["comparison"],
                int(row["count"]),
                float(row["bias"]),
                float(row["scatter"]),
                row["worst_case"],
                float(row["worst_ratio"]),
            )
            for row in csv.DictReader(file)
        ]


def uncertainties_of(analysis: str) -> list[ModelUncertainty]:
    """The entries of an analysis of this kind against experiments, by quantity; empty if none was compared."""
    return [row for row in read_uncertainties() if analysis in row.analyses and row.comparison == "experiment"]


def collapse_probability(margin: float, row: ModelUncertainty) -> tuple[float, float, float]:
    """Probability that the true capacity lies below the demand, with the ends of its 90 % interval; margin: computed capacity over
    demand.

    Computed over true capacity is lognormal; bias and scatter are estimates from `count` tests. With k = ln(margin/bias)/scatter
    the probability is that of one more test, 1 - t_{n-1}(k/sqrt(1 + 1/n)). The interval follows from sqrt(n) k, which has a
    noncentral t distribution (Owen 1968). It is extended to the probability itself where the tests are few.
    """
    if margin <= 0.0:
        return 1.0, 1.0, 1.0
    n = row.count
    k = float(np.log(margin / row.bias) / row.scatter)
    estimate = float(stdtr(n - 1, -k / np.sqrt(1.0 + 1.0 / n)))
    shift = nctdtrinc(n - 1, np.array([1.0 - TAIL, TAIL]), np.sqrt(n) * np.clip(k, -_FARTHEST, _FARTHEST))
    high, low = ndtr(-shift / np.sqrt(n))
    return estimate, min(float(low), estimate), max(float(high), estimate)
