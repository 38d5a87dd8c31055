"""Intervals and fragility curves against closed forms and SciPy."""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.stats import binomtest, norm

from extrados.analyses.statistics import likelihood
from extrados.analyses.statistics.likelihood import NoFit, bootstrap, first_collapses, fit_first_collapse, fit_stripes
from extrados.analyses.statistics.summaries import wilson


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
    fit = fit_stripes(x, z, n)

    def loss(c):
        p = norm.cdf(np.log(x / np.exp(c[0])) / np.exp(c[1]))
        return -np.sum(z * np.log(p) + (n - z) * np.log1p(-p))

    best = minimize(loss, [np.log(0.5), np.log(0.5)], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12})
    assert (fit.median, fit.dispersion) == pytest.approx(tuple(np.exp(best.x)), rel=1e-6)


def test_fit_recovers_the_truth() -> None:
    fit = fit_stripes(*stripes(0.6, 0.4, 200_000))
    assert (fit.median, fit.dispersion) == pytest.approx((0.6, 0.4), abs=3e-3)
    assert fit.freedom == 4 and fit.p_value > 0.01


def test_a_curve_that_is_not_lognormal_fits_badly() -> None:
    x = np.array([0.2, 0.3, 0.5, 0.7, 1.0, 1.5])
    assert fit_stripes(x, np.array([0, 900, 50, 900, 100, 1000]), np.full(6, 1000)).p_value < 1e-6


@pytest.mark.parametrize(
    ("x", "z", "n", "said"),
    [
        ([0.5], [3], [10], "at least two"),
        ([0.2, 0.5], [0, 0], [10, 10], "is 0 at every"),
        ([0.2, 0.5], [10, 10], [10, 10], "is 1 at every"),
        ([0.2, 0.3, 0.5], [0, 0, 10], [10, 10, 10], "from 0 at 0.3 to 1 at 0.5"),
        ([0.2, 0.3, 0.5], [0, 5, 10], [10, 10, 10], "from 0 below 0.3"),
        ([0.2, 0.3, 0.5], [9, 5, 1], [10, 10, 10], "does not increase"),
    ],
)
def test_what_determines_no_curve(x, z, n, said: str) -> None:
    with pytest.raises(NoFit, match=said):
        fit_stripes(np.array(x), np.array(z), np.array(n))


MEDIAN, DISPERSION = 0.456, 0.5


def seen_at(levels: np.ndarray, motions: int, random: np.random.Generator) -> np.ndarray:
    """Motions (rows) of known capacities that bring it down at the levels (columns)."""
    return np.exp(random.normal(np.log(MEDIAN), DISPERSION, motions))[:, None] <= levels


def negative(c: np.ndarray, seen: likelihood.Capacities) -> float:
    """Negative log-likelihood of ln(median), ln(dispersion), written out."""
    with np.errstate(divide="ignore"):
        p = np.diff(norm.cdf((np.log([seen.low, seen.high]) - c[0]) / np.exp(c[1])), axis=0)
    return -float(np.sum(seen.weight * np.log(p)))


@pytest.mark.parametrize(
    ("levels", "sets"),
    [
        ([0.15, 0.35, 0.7, 1.4], 100),
        *(
            pytest.param(levels, 500, marks=pytest.mark.verify)
            for levels in ([0.15, 0.35, 0.7, 1.4], [0.3, 0.6], [0.15, 0.25, 0.4, 0.6, 0.8, 1.1, 1.4])
        ),
    ],
)
def test_capacities_within_intervals_give_the_true_median_on_coarse_levels(levels: list[float], sets: int) -> None:
    """Sets of 40 motions of known capacities: no bias, and the band covers as often as it says. The mean logarithm
    of the levels that first bring it down, where all motions fall, is 15 to 40 % too high."""
    random = np.random.default_rng(3)
    x = np.array(levels)
    medians, dispersions, upper_ends, covered = [], [], [], 0
    slack = np.sqrt(500 / sets)
    for _ in range(sets):
        over = seen_at(x, 40, random)
        seen = first_collapses(x, over, np.ones_like(over))
        found = likelihood.fit(seen)
        low, high = likelihood.region(seen, found, 0.95).median
        covered += low <= MEDIAN <= high
        medians.append(found.median)
        dispersions.append(found.dispersion)
        if over.any(axis=1).all():
            upper_ends.append(np.log(x[over.argmax(axis=1)]).mean())
    assert np.exp(np.mean(np.log(medians))) == pytest.approx(MEDIAN, rel=0.02 * slack)
    assert np.mean(dispersions) == pytest.approx(DISPERSION, rel=0.05 * slack)
    assert covered / sets == pytest.approx(0.95, abs=0.03 * slack)
    assert not upper_ends or np.exp(np.mean(upper_ends)) > 1.15 * MEDIAN


def test_first_collapse_fit_and_bands_are_those_of_the_profile_likelihood() -> None:
    x = np.array([0.15, 0.35, 0.7, 1.4])
    over = seen_at(x, 200, np.random.default_rng(1))
    seen = first_collapses(x, over, np.ones_like(over))
    assert np.isinf(seen.high).any()
    found = fit_first_collapse(x, seen)
    best = minimize(negative, [-0.7, -0.7], (seen,), "Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12})
    assert (found.median, found.dispersion) == pytest.approx(tuple(np.exp(best.x)), rel=1e-6)
    expected = 200 * np.diff(norm.cdf(np.log([1e-300, *x, 1e300]) / found.dispersion - np.log(found.median) / found.dispersion))
    hits = np.bincount(np.where(over.any(axis=1), over.argmax(axis=1), 4), minlength=5)
    assert found.freedom == 2 and found.deviance == pytest.approx(2 * np.sum(hits * np.log(hits / expected)), rel=1e-6)
    region = likelihood.region(seen, found, 0.95)

    def excess(quantile: float, at: float) -> float:
        """Twice the likelihood lost where the quantile lies at a value, the dispersion free, less 3.84."""
        z = norm.ppf(quantile)
        free = minimize_scalar(
            lambda s: negative(np.array([at - z * np.exp(s), s]), seen), bounds=(-2.5, 1.0), method="bounded", options={"xatol": 1e-11}
        )
        return 2.0 * (free.fun - best.fun) - 3.841458820694124

    at = np.log(found.median)
    ends = [brentq(lambda m: excess(0.5, m), at + a, at + b) for a, b in ((-0.5, 0.0), (0.0, 0.5))]
    assert region.median == pytest.approx(np.exp(ends), rel=1e-4)
    # Where the upper border of the band has the probability 0.2, the 20 % quantile lies at the end of its interval
    grid = np.geomspace(0.1, 1.0, 4000)
    fifth = at + norm.ppf(0.2) * found.dispersion
    lowest = brentq(lambda m: excess(0.2, m), fifth - 0.5, fifth)
    assert np.interp(0.2, region.band(grid)[1], grid) == pytest.approx(np.exp(lowest), rel=1e-4)


def test_levels_without_a_result_widen_the_interval() -> None:
    x = np.array([0.2, 0.4, 0.8])
    over = np.array([[0, 0, 1], [0, 0, 1], [0, 0, 0], [1, 0, 1], [0, 0, 0]], bool)
    valid = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 0], [1, 1, 1], [0, 0, 0]], bool)
    seen = first_collapses(x, over, valid)
    assert sorted(zip(seen.low, seen.high, seen.weight, strict=True)) == [(0.0, 0.2, 1), (0.2, 0.8, 1), (0.4, 0.8, 1), (0.4, np.inf, 1)]


def test_bootstrap_covers_and_repeats() -> None:
    rng = np.random.default_rng(5)
    x = np.array([0.3, 0.45, 0.6, 0.8, 1.1])
    capacity = np.exp(rng.normal(np.log(0.6), 0.4, 400))
    over = capacity[:, None] <= x
    one, two = (bootstrap(x, over, np.ones_like(over), 200, 0.95, 7) for _ in range(2))
    assert np.array_equal(one.median, two.median) and one.share == 1.0
    median, dispersion = one.interval(one.median), one.interval(one.dispersion)
    assert median[0] < 0.6 < median[1] and dispersion[0] < 0.4 < dispersion[1]
    # The standard error of the mean of ln capacity is 0.4/20 if all capacities were known.
    assert 0.8 * 0.4 / 20 < np.log(median[1] / median[0]) / 3.92 < 0.6 / 20
    # Each draw has the curve that is fitted to it alone
    weight = np.bincount(np.random.default_rng(7).integers(0, 400, 400), minlength=400)
    alone = fit_stripes(x, weight @ over, np.full(5, 400))
    assert (one.median[0], one.dispersion[0]) == pytest.approx((alone.median, alone.dispersion), rel=1e-9)
    low, high = one.band(np.array([0.6]))
    assert low[0] < 0.5 < high[0] and high[0] - low[0] < 0.2


@pytest.mark.parametrize("hits", [(5, 5, 5), (5, 5, 5.0001), (6, 5, 5)])
def test_a_probability_that_does_not_increase_has_no_curve(hits: tuple[float, ...]) -> None:
    """Equal shares at all levels once gave a median of 0 and a curve of 1 everywhere."""
    with pytest.raises(NoFit, match="does not increase"):
        fit_stripes(np.array([0.4, 0.8, 1.2]), np.array(hits), np.array([6, 6, 6]))
