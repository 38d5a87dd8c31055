"""The probability of collapse of an assessment: closed forms of lognormal margins, and simulated tests."""

import csv
import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import t as student

from extrados.analyses.assess.asking import no_row
from extrados.analyses.assess.model_uncertainty import estimate_collapse, percent
from extrados.analyses.assess.strategies import of
from extrados.results import uncertainty
from extrados.results.assess import StrategyVerdict
from extrados.results.statistics import Ensemble, OverLevels
from extrados.results.uncertainty import ModelUncertainty, collapse_probability, uncertainties_of

WALLS = ModelUncertainty("walls", ("tilt",), "capacity in acceleration", "experiment", 21, 0.95, 0.2, "", 1.0)


def row(name: str, **values) -> StrategyVerdict:
    given = {"status": "ok", "outcome": "stands", **values}
    return no_row(of(name), "refused", "").model_copy(update=given)


@pytest.mark.parametrize("margin", [0.6, 0.95, 1.1, 1.6])
def test_many_tests_give_the_lognormal_margin(margin: float) -> None:
    """With many tests bias and scatter are known: Phi(ln(bias/margin)/scatter), by the error function."""
    many = replace(WALLS, count=1_000_000)
    exact = 0.5 * math.erfc(math.log(margin / 0.95) / 0.2 / math.sqrt(2.0))
    p, low, high = collapse_probability(margin, many)
    assert p == pytest.approx(exact, abs=1e-5)
    assert low < p < high and high - low < 3e-3


def test_the_margin_of_the_bias_is_even() -> None:
    for count in (2, 5, 21):
        p, low, high = collapse_probability(0.95, replace(WALLS, count=count))
        assert p == pytest.approx(0.5) and low + high == pytest.approx(1.0)


def test_two_tests_by_hand() -> None:
    """t of one degree of freedom is Cauchy's: 1/2 - arctan(k sqrt(2/3))/pi."""
    p, _, _ = collapse_probability(1.5, replace(WALLS, count=2))
    k = math.log(1.5 / 0.95) / 0.2
    assert p == pytest.approx(0.5 - math.atan(k * math.sqrt(2.0 / 3.0)) / math.pi, rel=1e-9)


@pytest.mark.parametrize("count", [4, 21])
@pytest.mark.parametrize("margin", [0.8, 1.2])
def test_simulated_series_of_tests(count: int, margin: float) -> None:
    """Series of tests on strategies of a known lognormal error: the interval encloses the true probability in 90 % of them."""
    rng = np.random.default_rng(7)
    mean, spread = math.log(0.9), 0.25
    truth = 1.0 - ndtr((math.log(margin) - mean) / spread)
    inside = 0
    for _ in range(4000):
        logs = rng.normal(mean, spread, count)
        seen = replace(WALLS, count=count, bias=math.exp(logs.mean()), scatter=logs.std(ddof=1))
        _, low, high = collapse_probability(margin, seen)
        inside += low <= truth <= high
    # binomial deviation of 4000 series: 0.005
    assert inside / 4000 == pytest.approx(0.9, abs=0.016)


@pytest.mark.parametrize("count", [4, 21])
def test_a_further_test_fails_as_often_as_stated(count: int) -> None:
    """Demands chosen so that 10 % are stated: of simulated buildings 10 % fail."""
    rng = np.random.default_rng(8)
    logs = rng.normal(math.log(0.9), 0.25, (40000, count))
    bias, scatter = logs.mean(axis=1), logs.std(axis=1, ddof=1)
    k = student.ppf(0.9, count - 1) * math.sqrt(1.0 + 1.0 / count)
    margin = np.exp(bias + k * scatter)
    seen = replace(WALLS, count=count, bias=math.exp(bias[0]), scatter=scatter[0])
    assert collapse_probability(margin[0], seen)[0] == pytest.approx(0.1, abs=1e-9)
    # computed over true capacity of one more building; it collapses where margin over this ratio is below 1
    assert np.mean(rng.normal(math.log(0.9), 0.25, 40000) > np.log(margin)) == pytest.approx(0.1, abs=0.005)


def test_the_pool_of_two_strategies() -> None:
    """Weights are shares of the tests, and the interval encloses both; the others are named with their reasons."""
    rows = [
        row("tilt", margin=1.2),
        row("sla", margin=0.7, outcome="collapses"),
        row("rocking", margin_at_least=1.5),
        row("code-checks", margin=0.5),
        row("dem", status="refused"),
    ]
    found = estimate_collapse(rows)
    (tilt,) = (u for u in uncertainties_of("tilt") if u.quantity == "capacity in acceleration")
    (sla,) = (u for u in uncertainties_of("sla") if u.quantity == "peak load")
    one, two = collapse_probability(1.2, tilt), collapse_probability(0.7, sla)
    pooled = (tilt.count * one[0] + sla.count * two[0]) / (tilt.count + sla.count)
    assert found.probability == pytest.approx(pooled)
    assert (found.low, found.high) == (min(one[1], two[1]), max(one[2], two[2]))
    assert sum(c.weight for c in found.contributions) == pytest.approx(1.0)
    assert set(found.without) == {"rocking", "code-checks", "dem"}
    assert "briefly" in found.statement and percent(pooled) in found.statement
    assert found.statement.startswith("If the peak of the hazard acted as a constant horizontal acceleration") and found.in_motion is None
    assert "not the probability of collapse in the earthquake" in found.statement
    assert "rocking" in found.method and "verification book" in found.method


def test_the_share_under_the_motion_itself_comes_first() -> None:
    """19 of 40: the score interval by its quadratic, (p + z^2/2n -+ z sqrt(p q/n + z^2/4n^2))/(1 + z^2/n)."""
    runs = Ensemble.model_construct(count=40, collapsed=19)
    rows = [row("tilt", margin=1.2), row("probability", violated=["Blocks slide in 12 % of the runs."])]
    found = estimate_collapse(rows, runs)
    z, n, p = 1.959963984540054, 40, 19 / 40
    middle, half = p + z * z / (2 * n), z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    assert found.in_motion.low == pytest.approx((middle - half) / (1 + z * z / n), rel=1e-6)
    assert found.in_motion.high == pytest.approx((middle + half) / (1 + z * z / n), rel=1e-6)
    assert found.statement.startswith("Probability of collapse under the hazard by rocking 48 %")
    assert "assumptions of the rocking analysis are violated" in found.statement and "constant horizontal acceleration" in found.statement
    alone = estimate_collapse([row("rocking", margin_at_least=1.5)], runs)
    assert alone.probability is None and "19 of 40 runs collapse" in alone.statement
    none = estimate_collapse(rows, Ensemble.model_construct(count=16, collapsed=0))
    assert f"at most {percent(z * z / (16 + z * z))}: 0 of 16" in none.statement
    every = estimate_collapse(rows, Ensemble.model_construct(count=16, collapsed=16))
    assert f"at least {percent(16 / (16 + z * z))}: 16 of 16" in every.statement
    assert estimate_collapse(rows, Ensemble.model_construct(count=0, collapsed=0)).in_motion is None


@pytest.mark.parametrize(
    ("intensity", "levels", "collapsed"), [("scale", [0.5, 1.0], 9), ("scale", [0.5, 1.2], None), ("pga", [0.5, 1.0], None)]
)
def test_levels_of_another_intensity_are_not_the_hazard(intensity: str, levels: list[float], collapsed: int | None) -> None:
    runs = OverLevels.model_construct(intensity=intensity, levels=levels, count=[20, 20], collapsed=[1, 9])
    moving = estimate_collapse([row("tilt", margin=1.2)], runs).in_motion
    assert (moving and moving.collapsed) == collapsed


def test_the_table_names_the_analyses_of_the_verification_book() -> None:
    book = Path(__file__).parents[2] / "tools" / "verification_strategies.toml"
    of_book = {one["name"]: one["analyses"] for one in tomllib.loads(book.read_text())["strategy"]}
    with Path(uncertainty.__file__).with_name("model_uncertainty.csv").open(newline="") as table:
        for line in csv.DictReader(table):
            assert line["analyses"].split() == of_book[line["strategy"]]


def test_violated_assumptions_and_unknown_margins_contribute_nothing() -> None:
    found = estimate_collapse([row("tilt", margin=1.2, violated=["Stones crush."]), row("sla", margin_at_least=2.0)])
    assert found.probability is None and not found.contributions
    assert found.without == {"tilt": "assumptions that do not hold", "sla": "no critical scale factor"}


def test_a_certificate_is_certain() -> None:
    found = estimate_collapse([row("tilt", outcome="cannot-stand", margin=0.0), row("sla", margin=2.0)])
    assert (found.probability, found.low, found.high) == (1.0, 1.0, 1.0)
