"""Intervals and fragility curves against closed forms and SciPy."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import binomtest, norm

from extrados.analyses.statistics.summaries import NoFit, bootstrap, fit_lognormal, wilson


@pytest.mark.parametrize(("hits", "count"), [(0, 10), (1, 10), (5, 10), (10, 10), (450, 1000), (999, 1000)])
@pytest.mark.parametrize("confidence", [0.9, 0.95])
def test_wilson_is_that_of_scipy(hits: int, count: int, confidence: float) -> None:
    reference = binomtest(hits, count).proportion_ci(confidence, method="wilson")
    low, high = wilson(hits, count, confidence)
    assert (low, high) == pytest.approx((reference.low, reference.high), abs=1e-12)


def test_wilson_without_runs() -> None:
    assert [float(v) for v in wilson(0, 0)] == [0.0, 1.0]


def stripes(median: float, dispersion: float, count: int, seed: int = 1):
    x = np.array([0.2, 0.3, 0.5, 0.7, 1.0, 1.5])
    z = np.random.default_rng(seed).binomial(count, norm.cdf(np.log(x / median) / dispersion))
    return x, z, np.full(len(x), count)


def test_fit_finds_the_greatest_likelihood() -> None:
    x, z, n = stripes(0.6, 0.4, 40)
    fit = fit_lognormal(x, z, n)

    def loss(c):
        p = norm.cdf(np.log(x / np.exp(c[0])) / np.exp(c[1]))
        return -np.sum(z * np.log(p) + (n - z) * np.log1p(-p))

    best = minimize(loss, [np.log(0.5), np.log(0.5)], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12})
    assert (fit.median, fit.dispersion) == pytest.approx(tuple(np.exp(best.x)), rel=1e-6)


def test_fit_recovers_the_truth() -> None:
    fit = fit_lognormal(*stripes(0.6, 0.4, 200_000))
    assert (fit.median, fit.dispersion) == pytest.approx((0.6, 0.4), abs=3e-3)
    assert fit.freedom == 4 and fit.p_value > 0.01


def test_a_curve_that_is_not_lognormal_fits_badly() -> None:
    x = np.array([0.2, 0.3, 0.5, 0.7, 1.0, 1.5])
    assert fit_lognormal(x, np.array([0, 900, 50, 900, 100, 1000]), np.full(6, 1000)).p_value < 1e-6


@pytest.mark.parametrize(
    ("x", "z", "n", "said"),
    [
        ([0.5], [3], [10], "two or more"),
        ([0.2, 0.5], [0, 0], [10, 10], "nothing happened"),
        ([0.2, 0.5], [10, 10], [10, 10], "every run"),
        ([0.2, 0.3, 0.5], [0, 0, 10], [10, 10, 10], "step"),
        ([0.2, 0.3, 0.5], [9, 5, 1], [10, 10, 10], "does not grow"),
    ],
)
def test_what_determines_no_curve(x, z, n, said: str) -> None:
    with pytest.raises(NoFit, match=said):
        fit_lognormal(np.array(x), np.array(z), np.array(n))


def test_bootstrap_covers_and_repeats() -> None:
    rng = np.random.default_rng(5)
    x = np.array([0.3, 0.45, 0.6, 0.8, 1.1])
    capacity = np.exp(rng.normal(np.log(0.6), 0.4, 400))
    over = capacity[:, None] <= x
    grid = np.array([0.4, 0.6, 0.9])
    one = bootstrap(x, over, np.ones_like(over), 200, 0.95, 7, grid)
    two = bootstrap(x, over, np.ones_like(over), 200, 0.95, 7, grid)
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))
    assert one[0][0] < 0.6 < one[0][1] and one[1][0] < 0.4 < one[1][1]
    # The standard error of the mean of ln capacity is 0.4/20 if all capacities were known.
    assert 0.8 * 0.4 / 20 < np.log(one[0][1] / one[0][0]) / 3.92 < 0.6 / 20
