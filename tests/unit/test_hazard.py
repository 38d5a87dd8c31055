"""Annual rates of collapse from hazard curves; clouds of motions as they are; buildings that are not known exactly."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.special import ndtr
from scipy.stats import norm, qmc

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.analyses.statistics import cloud
from extrados.analyses.statistics.annual import rates
from extrados.analyses.statistics.cloud import describe, fit_cloud
from extrados.analyses.statistics.uncertain import Sample
from extrados.core import rocking
from extrados.decks.reader import DeckError, make_deck
from extrados.motions.from_deck import generated_set
from extrados.motions.hazard import HazardCurve
from extrados.results.model import Result
from extrados.results.rocking import COLLAPSE, NO_HINGING, RECOVERY
from extrados.views.rockers.arch import minimum_thickness

BLOCK = {"kind": "block", "width": 0.3, "height": 1.5}
ARCH = {"kind": "arch", "radius": 1.0, "thickness": 0.18, "embrace": 160.0, "voussoirs": 13, "thickness_factor": 0.85}
GENERATED = {"kind": "generated", "mmi": 8, "duration": 10.0, "seed": 4}
HAZARD = {"intensities": [0.05, 0.1, 0.2, 0.5, 1.0, 2.0], "annual_rates": [0.1, 0.04, 0.012, 0.002, 3e-4, 3e-5]}


def run(analysis: dict, structure: dict = BLOCK, motion: dict = GENERATED, folder: Path | None = None) -> Result:
    deck = {"structure": structure, "motion": motion, "analysis": {"kind": "fragility", **analysis}}
    return run_analyses(Context(make_deck(deck, folder), threads=2))[0]


# --- the integral -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("dispersion", [0.02, 0.3, 1.0])
def test_a_straight_hazard_curve_gives_the_closed_form(dispersion: float) -> None:
    """Rate at the median times exp(k^2 dispersion^2 / 2) (Cornell and others 2002)."""
    x, k = np.geomspace(1e-6, 1e5, 9), 2.5
    hazard = HazardCurve(x, 1e-4 * x**-k)
    rate = hazard.rate_of(lambda v: ndtr(np.log(v / 0.4) / dispersion))
    assert rate == pytest.approx(1e-4 * 0.4**-k * np.exp(0.5 * (k * dispersion) ** 2), rel=1e-9)


def test_a_bent_hazard_curve_against_quadrature() -> None:
    hazard = HazardCurve(np.array([0.1, 0.3, 0.5, 2.0]), np.array([1e-2, 3e-3, 4e-4, 1e-6]))

    def probability(v: np.ndarray) -> np.ndarray:
        return ndtr(np.log(v / 0.6) / 0.5)

    def by_rate(log_rate: float) -> float:
        """P at the intensity of a rate, which is read off the points by hand."""
        x = np.exp(np.interp(-log_rate, -np.log(hazard.rate), np.log(hazard.intensity)))
        return float(probability(x)) * np.exp(log_rate)

    ends = np.log(hazard.rate)
    total = sum(quad(by_rate, b, a, epsabs=1e-16)[0] for a, b in itertools.pairwise(ends))
    above = 1e-6 * float(probability(np.array(2.0)))
    assert hazard.rate_of(probability) == pytest.approx(total + above, rel=1e-8)
    assert hazard.at(np.array([0.1, np.sqrt(0.15), 2.0])) == pytest.approx([1e-2, np.sqrt(3e-3 * 4e-4), 1e-6])
    # What may be missing: above the last point all that P leaves, below the first one what its slope goes on to
    slope = np.log(10 / 3) / np.log(3)
    below = quad(lambda s: float(probability(np.exp(s))) * slope * 1e-2 * (np.exp(s) / 0.1) ** -slope, -9.0, np.log(0.1))[0]
    assert hazard.left_out(probability) == pytest.approx(1e-6 - above + below, rel=1e-6)


# --- from decks -------------------------------------------------------------------------------------------------


def test_levels_with_a_hazard_give_the_annual_rate_with_a_band(tmp_path: Path) -> None:
    levels = {"count": 80, "levels": [0.2, 0.3, 0.4, 0.6, 0.9], "bootstrap": 200, "seed": 4}
    result = run({**levels, "hazard": {**HAZARD, "years": 100.0}})
    r = result.results
    curve = HazardCurve(np.array(HAZARD["intensities"]), np.array(HAZARD["annual_rates"]))
    expected = float(curve.rate_of(lambda x: ndtr(np.log(x / r["median"]) / r["dispersion"])))
    assert r["annual_collapse_rate"] == pytest.approx(expected)
    assert r["collapse_return_period_years"] == pytest.approx(1.0 / expected)
    assert r["collapse_probability_in_years"] == pytest.approx(1.0 - np.exp(-100.0 * expected))
    low, high = r["annual_collapse_rate_interval"]
    assert 0.5 * expected < low < expected < high < 2.0 * expected
    # the band is that of motions drawn anew, each with all its levels: a stronger curve, a higher rate
    again = run({**levels, "hazard": HAZARD, "confidence": 0.5}).results
    assert low < again["annual_collapse_rate_interval"][0] < again["annual_collapse_rate_interval"][1] < high
    x, density = result.arrays["contribution_intensity"].data, result.arrays["contribution"].data
    assert np.trapezoid(density, np.log(x)) == pytest.approx(expected, rel=0.02)
    assert "a year" in result.answer or "annual rate" in result.answer
    # the same from a file, and with units
    (tmp_path / "h.csv").write_text("# PGA [g], rate\n" + "\n".join(f"{a},{b}" for a, b in zip(*HAZARD.values(), strict=True)))
    filed = run({**levels, "hazard": {"file": "h.csv"}}, folder=tmp_path).results
    assert filed["annual_collapse_rate"] == r["annual_collapse_rate"]
    texts = {**HAZARD, "intensities": [f"{100 * v:g} cm/s^2" for v in HAZARD["intensities"]]}
    other = run({**levels, "hazard": texts}).results
    scaled = HazardCurve(curve.intensity / 9.80665, curve.rate)
    assert other["annual_collapse_rate"] == pytest.approx(float(scaled.rate_of(lambda x: ndtr(np.log(x / r["median"]) / r["dispersion"]))))


def test_the_verdict_is_on_the_accepted_rate() -> None:
    levels = {"count": 60, "levels": [0.2, 0.3, 0.4, 0.6, 0.9], "bootstrap": 200}
    rate = run({**levels, "hazard": HAZARD}).results["annual_collapse_rate"]
    for accepted, outcome in ((0.3 * rate, "collapses"), (1.01 * rate, "open"), (3.0 * rate, "stands")):
        verdict = run({**levels, "hazard": {**HAZARD, "acceptable_rate": accepted}}).verdict
        assert (verdict.outcome, verdict.unit) == (outcome, "1/year")
        assert (verdict.demand, verdict.capacity) == (rate, accepted)
    assert run({**levels, "hazard": HAZARD}).verdict.outcome == "not-applicable"


def test_a_hazard_curve_that_ends_too_early_is_reported() -> None:
    short = {"intensities": [0.3, 0.4], "annual_rates": [1e-2, 8e-3]}
    result = run({"count": 40, "levels": [0.2, 0.3, 0.4, 0.6], "bootstrap": 0, "hazard": short})
    assert any("ends of the hazard curve" in text for text in result.warnings)
    assert result.results["annual_collapse_rate_interval"] == [None, None]


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"hazard": HAZARD}, "requires the key `levels`, or a cloud"),
        ({"cloud": True, "intensity": "scale"}, "not scaled"),
        ({"cloud": True, "levels": [0.1]}, "remove the keys `levels`"),
        ({"rotation_limits": [0.5]}, "is used only with cloud = true"),
        ({"histories": 3, "levels": [0.1]}, "unscaled motions"),
        ({"cloud": True, "hazard": {"intensities": [0.1, 0.2]}}, "give either `intensities`"),
        ({"cloud": True, "hazard": {**HAZARD, "file": "h.csv"}}, "give either `intensities`"),
        ({"cloud": True, "hazard": {"intensities": [0.1, 0.2], "annual_rates": [0.1, 0.1]}}, "decrease"),
        ({"cloud": True, "hazard": {"intensities": [0.2, 0.1], "annual_rates": [0.1, 0.01]}}, "increase"),
        ({"cloud": True, "hazard": {"intensities": [0.1, 0.2, 0.3], "annual_rates": [0.1, 0.01]}}, "equal numbers"),
    ],
)
def test_bad_questions(keys: dict, said: str) -> None:
    with pytest.raises(DeckError, match=said):
        run({"count": 2, **keys})


@pytest.mark.parametrize(
    ("text", "said"), [("0.1,0.1\n0.2\n", ":2: expected an intensity"), ("0.1,0.1\n", "1 pairs"), ("0.1,0.1\n0.2,0.2\n", "decrease")]
)
def test_bad_hazard_files_are_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(text)
    found = run({"count": 4, "levels": [0.2, 0.4], "hazard": {"file": "h.csv"}}, folder=tmp_path)
    assert found.status == "refused" and said in found.reason


# --- clouds -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sets", [40, pytest.param(200, marks=pytest.mark.verify)])
def test_cloud_finds_known_capacities_and_its_interval_covers(sets: int) -> None:
    """120 motions of scattered intensity against capacities of median .4 and dispersion .35."""
    slack = np.sqrt(200 / sets)
    random = np.random.default_rng(2)
    medians, covered, rate_covered = [], 0, 0
    hazard = HazardCurve(np.array(HAZARD["intensities"]), np.array(HAZARD["annual_rates"]))
    truth = hazard.rate_of(lambda v: ndtr(np.log(v / 0.4) / 0.35))
    for _ in range(sets):
        x = np.exp(random.normal(np.log(0.35), 0.6, 120))
        found, region = fit_cloud(x, np.exp(random.normal(np.log(0.4), 0.35, 120)) < x, 0.95)
        medians.append(found.median)
        low, high = region.median
        covered += low <= 0.4 <= high
        least, most = rates(hazard, found, region.curves, None)[1]
        rate_covered += least <= truth <= most
    assert np.exp(np.mean(np.log(medians))) == pytest.approx(0.4, rel=0.015 * slack)
    assert covered / sets == pytest.approx(0.95, abs=0.035 * slack)
    assert rate_covered / sets == pytest.approx(0.95, abs=0.035 * slack)


def test_a_cloud_that_shows_no_growth_is_said_not_to_determine_a_curve() -> None:
    """One collapse at a middle intensity of five: the fitted median, 384 g, is far beyond all motions."""
    x = np.array([0.135, 0.163, 0.266, 0.347, 1.48])
    outcome = np.array([NO_HINGING, NO_HINGING, RECOVERY, COLLAPSE, RECOVERY])
    for fallen, said in ((outcome, True), (np.where(np.arange(60) % 20 < 10, RECOVERY, COLLAPSE), False)):
        at = x if len(fallen) == 5 else np.geomspace(0.2, 0.4, 20)[np.arange(60) % 20] * np.repeat([0.9, 1.0, 1.3], 20)
        result = Result("fragility")
        describe(at, fallen, np.ones(len(at)), "PGA", "g", [], None, 0.95, result)
        assert any("do not show" in text for text in result.warnings) == said


@pytest.mark.verify
def test_cloud_curves_are_the_shares_of_many_motions() -> None:
    """Bins of 2,000 motions: the curves fit the shares of collapse and of rotations; a logistic curve of collapse is the
    same; the regression of the logarithms (Jalayer and others 2017) is wrong by more than .25 for rotations."""
    limits = [0.1, 0.25]
    result = run(
        {"count": 2000, "cloud": True, "intensity": "pgv-ratio", "rotation_limits": limits, "hazard": HAZARD},
        motion={**GENERATED, "dispersion": 0.6},
    )
    r, (x, outcome, ratio) = result.results, (result.arrays[k].data for k in ("intensity", "outcome", "peak_ratio"))
    fell = outcome == 2
    edges = np.quantile(x, np.linspace(0.02, 0.98, 11))
    bins = [(x >= a) & (x < b) for a, b in itertools.pairwise(edges)]

    def errors(passed: np.ndarray, curve: np.ndarray) -> np.ndarray:
        return np.array([passed[b].mean() - curve[b].mean() for b in bins])

    collapse = ndtr(np.log(x / r["median"]) / r["dispersion"])
    assert np.sqrt((errors(fell, collapse) ** 2).mean()) < 0.04
    z = np.log(x)
    best = minimize(lambda c: np.sum(np.logaddexp(0.0, c[0] + c[1] * z)) - np.sum(fell * (c[0] + c[1] * z)), [0.0, 2.0]).x
    assert np.abs(1.0 / (1.0 + np.exp(-best[0] - best[1] * z)) - collapse).max() < 0.035
    rocks = outcome == 1
    slope, level = np.polyfit(z[rocks], np.log(ratio[rocks]), 1)
    deviation = (np.log(ratio[rocks]) - level - slope * z[rocks]).std(ddof=2)
    lifted = np.array([(outcome[b] > 0)[~fell[b]].mean() if (~fell[b]).any() else 1.0 for b in bins])
    for row, limit in zip(r["rotation_limits"], limits, strict=True):
        passed = fell | (ratio > limit)
        assert np.sqrt((errors(passed, ndtr(np.log(x / row.median) / row.dispersion)) ** 2).mean()) < 0.03
        assert row.median_interval[0] < row.median < row.median_interval[1] and row.annual_rate > r["annual_collapse_rate"]
        by_regression = ndtr((level + slope * z - np.log(limit)) / deviation)
        composed = [collapse[b].mean() + ((1 - collapse) * by_regression)[b].mean() * u for b, u in zip(bins, lifted, strict=True)]
        shares = np.array([passed[b].mean() for b in bins])
        assert np.abs(shares - composed).max() > 0.25


def test_generated_motions_scatter_in_strength() -> None:
    def made(dispersion: float):
        deck = make_deck({"motion": {**GENERATED, "dispersion": dispersion}, "analysis": {"kind": "motion"}})
        return generated_set(deck.motion, Path())

    plain, some = made(0.0), made(0.5)
    factor = some.batch(3, 2) / plain.batch(3, 2)
    assert np.nanstd(factor, axis=1) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.nanmedian(factor, axis=1) == pytest.approx(some.factors(3, 2)) and factor[0, 100] != factor[1, 100]
    logs = np.log(some.factors(0, 4000))
    assert logs.mean() == pytest.approx(0.0, abs=0.03) and logs.std() == pytest.approx(0.5, rel=0.04)


def test_histories_are_those_of_single_runs() -> None:
    result = run({"count": 6, "histories": 2})
    peak = result.arrays["peak_ratio"].data
    for k in (1, 2):
        rotation, ground = (result.arrays[f"history_{n}_{k}"].data for n in ("rotation", "motion"))
        reached = np.abs(rotation).max()
        assert reached == pytest.approx(min(peak[k - 1], reached), rel=1e-2)
        single = generated_set(make_deck({"motion": GENERATED, "analysis": {"kind": "motion"}}).motion, Path()).motion(k - 1)
        assert np.abs(ground).max() == pytest.approx(np.abs(single).max() / 9.80665, rel=1e-9)


# --- buildings that are not known exactly -----------------------------------------------------------------------


def models(uncertain: dict, draws: list[list[float]], structure: dict = ARCH, **joints: object) -> list:
    deck = make_deck(
        {"structure": structure, "joints": joints, "motion": GENERATED, "analysis": {"kind": "fragility", "uncertain": uncertain}}
    )
    sample = Sample(deck.buildings[0], deck.analyses[0], np.array(draws))
    return [sample.rocker(k) for k in range(len(draws))]


def test_corners_change_the_thickness_that_is_left() -> None:
    """A draw of one half gives the median of the lognormal factor on the loss, 1/sqrt(1 + v^2)."""
    (found,) = models({"corners": 0.3}, [[0.5]])
    left = 1.0 - 0.15 / np.sqrt(1.09)
    deck = make_deck({"structure": {**ARCH, "thickness_factor": left}, "analysis": {"kind": "tilt"}})
    assert found.uplift == pytest.approx(deck.buildings[0].rocker().uplift, rel=1e-12)
    sharp = run({"count": 4, "uncertain": {"corners": 0.3}}, {**ARCH, "thickness_factor": 1.0})
    assert sharp.status == "refused" and "no lost thickness" in sharp.reason


def test_imperfect_stones_rock_about_as_the_perfect_ones() -> None:
    """Vanishing deviations: capacity, impact and response of the four-hinge arch; larger ones scatter about less."""
    deck = make_deck({"structure": ARCH, "analysis": {"kind": "tilt"}})
    perfect = deck.buildings[0].rocker()
    (near,) = models({"density": 1e-9, "imperfection": 1e-9}, [[0.3, 0.7]])
    assert (near.uplift, near.restitution) == pytest.approx((perfect.uplift, perfect.restitution), rel=1e-6)
    made = generated_set(make_deck({"motion": GENERATED, "analysis": {"kind": "motion"}}).motion, Path())
    grounds = [made.ground(k) for k in range(4)]
    peaks = [rocking.ensemble([m.body], grounds, np.zeros(4, int), np.arange(4), 1.0, 16.0).peak_ratio for m in (near, perfect)]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-3)
    draws = ((np.arange(16) + 0.5) / 16)[:, None]
    capacity = np.array([m.uplift for m in models({"imperfection": 0.02}, draws)])
    assert 0.01 < capacity.std() / perfect.uplift < 0.1 and capacity.mean() < perfect.uplift  # the weaker side counts
    weights = [m.model.assembly.mass for m in models({"density": 0.2}, draws)]
    share = np.array(weights) / weights[0].mean()
    assert np.std(np.log(share)) == pytest.approx(np.sqrt(np.log(1.04)), rel=0.15)


def test_no_impact_of_a_sample_creates_energy() -> None:
    draws = [[u, v] for u in (0.1, 0.6) for v in (0.01, 0.99)]
    for rocker in models({"imperfection": 0.02, "restitution": 0.3}, draws):
        right, left = rocker.model.tables
        to_right, to_left = rocker.body.parameters[:2]
        assert to_right**2 * right.mass / left.mass <= 1.0 + 1e-12 and to_left**2 * left.mass / right.mass <= 1.0 + 1e-12
    low, high = models({"restitution": 0.1}, [[0.1], [0.4]])
    assert low.restitution < high.restitution


def _sampled_thickness(count: int, mean: float, scatter: float, seed: int) -> np.ndarray:
    """Lognormal sizes of the same Sobol points as the sample takes."""
    spread = np.sqrt(np.log1p(scatter**2))
    draws = qmc.Sobol(1, scramble=True, seed=seed).random_base2(int(np.log2(count)))[:, 0]
    return mean * np.exp(spread * norm.ppf(draws) - 0.5 * spread**2)


def test_buildings_of_the_sample_that_cannot_stand_count_as_collapsed() -> None:
    thin = {**ARCH, "thickness": 0.13, "embrace": 180.0, "thickness_factor": 1.0}
    result = run({"count": 16, "uncertain": {"thickness": 0.2}, "seed": 1}, thin)
    least = minimum_thickness(180.0, 13)
    fallen = sum(t < least for t in _sampled_thickness(16, 0.13, 0.2, 1))
    assert result.status == "ok" and result.results["failed"] == 0 and 0 < fallen < 16
    assert result.results["collapsed"] >= fallen
    assert any(f"{fallen} of 16 sampled buildings cannot stand" in text for text in result.warnings)
    asked = run({"count": 4, "uncertain": {"thickness": 0.2}, "seed": 1, "sensitivity": 16}, thin)
    assert asked.status == "refused" and "do not rock" in asked.reason


def test_what_a_building_does_not_know_is_refused() -> None:
    assert "one rigid block" in run({"count": 4, "uncertain": {"density": 0.1}}).reason
    assert "has no value of this name" in run({"count": 4, "uncertain": {"corners": 0.1}}).reason
    column = {"kind": "column", "width": 0.4, "height": 2.0, "drums": 4}
    assert run({"count": 4, "uncertain": {"density": 0.1, "width": 0.05}}, column).status == "ok"
    thesis = {"uncertain": {"imperfection": 0.02}, "joints": {"restitution": "thesis"}}
    assert "unsymmetric" in run({"count": 4, **thesis}, ARCH).reason
    vault = {"kind": "pointed-arch", "span": 4.0, "radius": 3.0, "thickness": 0.6, "voussoirs": 12}
    assert run({"count": 4, "uncertain": {"imperfection": 0.02, "restitution": 0.05}}, vault).status == "ok"


@pytest.mark.verify
def test_structure_and_motion_together_by_sobol_indices() -> None:
    """Thickness, corners, impact, density and shape of an arch beside the motion: what has no scatter has no index."""
    uncertain = {"thickness": 0.05, "corners": 1e-6, "restitution": 0.05, "density": 1e-6, "imperfection": 0.01}
    found = run({"count": 16, "seed": 1, "uncertain": uncertain, "sensitivity": 16, "bootstrap": 0}, {**ARCH, "voussoirs": 9}).results
    index = {name: row.rotation_total for name, row in found["sensitivity"].items()}
    assert set(index) == {*uncertain, "motion"}
    assert index["corners"] == pytest.approx(0.0, abs=1e-3) and index["density"] == pytest.approx(0.0, abs=1e-3)
    assert max(index["thickness"], index["motion"]) > 0.2


def test_the_measure_that_decides_collapse_is_ranked_first() -> None:
    """Capacities in PGV of known scatter, PGA and Arias intensity related to it with more: order, dispersions, and the deviance."""
    random = np.random.default_rng(8)
    n = 4000
    pgv = np.exp(random.normal(0.0, 0.5, n))
    pga = pgv * np.exp(random.normal(0.0, 0.6, n))
    arias = (pgv * np.exp(random.normal(0.0, 0.3, n))) ** 2
    outcome = np.where(np.exp(random.normal(0.0, 0.2, n)) < pgv, 2, 1)
    found = cloud.compare({"PGA": (pga, "g"), "PGV": (pgv, "m/s"), "Arias intensity": (arias, "m/s")}, outcome)
    assert [one.measure for one in found] == ["PGV", "Arias intensity", "PGA"]
    assert found[0].dispersion == pytest.approx(0.2, abs=0.02) and found[0].median == pytest.approx(1.0, abs=0.02)
    p = ndtr(np.log(pgv / found[0].median) / found[0].dispersion)
    assert found[0].deviance == pytest.approx(-2.0 * np.log(np.where(outcome == 2, p, 1.0 - p)).sum(), rel=1e-9)
    assert found[1].amplitude_dispersion == pytest.approx(0.5 * found[1].dispersion)
    assert found[1].amplitude_dispersion < found[2].amplitude_dispersion
    assert [one.measure for one in cloud.compare({"PGA": (pga, "g"), "PGV": (pgv, "m/s")}, np.full(n, 1))] == []
