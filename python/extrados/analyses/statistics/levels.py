"""Runs of motions scaled to levels of an intensity: counts and quantiles at each level, and the curves over them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from extrados.analyses.batches import Swept
from extrados.analyses.statistics import likelihood
from extrados.analyses.statistics.annual import annual_collapse, spoken
from extrados.analyses.statistics.likelihood import Lognormal, NoFit
from extrados.analyses.statistics.summaries import shares
from extrados.analyses.statistics.tables import Hazard
from extrados.core.rocking import FAILED
from extrados.motions.hazard import HazardCurve
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE, RECOVERY
from extrados.results.statistics import SIZE_FACTOR
from extrados.schema.constants import GRAVITY

#: Intensity -> (name in the results, unit of a level in SI, unit of the column)
INTENSITIES = {
    "pga": ("PGA", GRAVITY, "g"),
    "pga-ratio": ("PGA/(g tan alpha)", 1.0, ""),
    "pgv-ratio": ("p PGV/(g tan alpha)", 1.0, ""),
    "sa": ("SA", GRAVITY, "g"),
    "arias": ("Arias intensity", 1.0, "m/s"),
    "scale": ("factor", 1.0, ""),
    "size": (SIZE_FACTOR, 1.0, ""),
}
#: Of the peak rotation over all motions at a level: the median, and what a normal variable has at one deviation
PERCENTILES = (16, 50, 84)
SHOWN = 200  # incremental curves that a figure draws


@dataclass(frozen=True)
class Stripes:
    """Outcome, peak rotation ratio and PGA [m/s^2] of every motion (rows) at every level (columns, ascending)."""

    levels: np.ndarray
    outcome: np.ndarray
    ratio: np.ndarray
    pga: np.ndarray

    @cached_property
    def valid(self) -> np.ndarray:
        """Which runs came to an end (motions, levels)."""
        return self.outcome != FAILED

    @cached_property
    def over(self) -> np.ndarray:
        """Which runs collapsed (motions, levels)."""
        return self.outcome == COLLAPSE

    def percentile(self, percent: float) -> np.ndarray:
        """Peak rotation ratio that so many percent of the motions stay within, at each level; infinite for collapse."""
        found = np.full(len(self.levels), np.nan)
        for j, ok in enumerate(self.valid.T):
            if ok.any():
                ratio = np.where(self.over[ok, j], np.inf, self.ratio[ok, j])
                found[j] = np.quantile(ratio, percent / 100.0, method="inverted_cdf")
        return found


def arranged(levels: np.ndarray, swept: Swept) -> Stripes:
    """Stripes of the members of an ensemble, motion by motion with all their levels; missing ones of a motion count as failed.

    Motions without any finished member take no room: of an interrupted run of many motions few are there.
    """
    order, n = np.argsort(levels, kind="stable"), len(levels)
    column = np.argsort(order)  # of a level among the ascending ones
    motions = np.unique(np.concatenate([np.zeros(0, int), *(np.unique(m // n) for m, _ in swept.pieces("outcome"))]))
    shape = (len(motions), n)
    seen = Stripes(levels[order], np.full(shape, FAILED, np.int8), np.full(shape, np.nan), np.full(shape, np.nan))
    for members, rows in swept.pieces("outcome", "peak_ratio", "pga"):
        place = np.searchsorted(motions, members // n), column[members % n]
        seen.outcome[place], seen.ratio[place], seen.pga[place] = rows["outcome"], rows["peak_ratio"], rows["pga"]
    return seen


def shares_at(levels: np.ndarray, swept: Swept, *names: str) -> dict[str, np.ndarray]:
    """Sum of rows of 0 and 1 over the number of runs with a result, at each level in ascending order."""
    n = len(levels)
    runs, hits = np.zeros(n), {name: np.zeros(n) for name in names}
    for members, rows in swept.pieces("outcome", *names):
        good = rows["outcome"] != FAILED
        where = members[good] % n
        runs += np.bincount(where, minlength=n)
        for name in names:
            hits[name] += np.bincount(where, rows[name][good], n)
    order = np.argsort(levels, kind="stable")
    with np.errstate(invalid="ignore"):
        return {name: (found / runs)[order] for name, found in hits.items()}


def describe(
    seen: Stripes,
    intensity: str,
    word: str,
    initial: float,
    hazard: tuple[HazardCurve, Hazard] | None,
    confidence: float,
    repeats: int,
    seed: int,
    result: Result,
    ratio: str = "peak rotation divided by the critical rotation",
) -> dict[str, Any]:
    """Tables, arrays, warnings and answer of the levels into `result`; returns the results of levels alone.

    word: what the building is called; initial: rotation at the start over the critical one; hazard: that of the site
    in the measure of the levels; repeats: draws of the bootstrap; ratio: meaning of the ratios.
    """
    name, _, unit = INTENSITIES[intensity]
    n = len(seen.levels)
    rows = [shares(seen.outcome[:, j], seen.ratio[:, j], confidence, initial) for j in range(n)]
    r: dict[str, Any] = {"intensity": name, "intensity_unit": unit, "levels": seen.levels}
    r |= {key: [row[key] for row in rows] for key in rows[0]}
    r |= {f"peak_rotation_ratio_{p}": seen.percentile(p) for p in PERCENTILES}
    with np.errstate(invalid="ignore"):
        r["median_pga_g"] = [
            float(np.median(v[ok])) / GRAVITY if ok.any() else None for v, ok in zip(seen.pga.T, seen.valid.T, strict=True)
        ]
    fits, draws = ({}, None) if intensity == "size" else _curves(seen, confidence, repeats, seed, name, unit, r, result)
    _incremental(seen, unit, ratio, r, result, scaled=intensity != "size")
    _table(seen, unit, r, result)
    if intensity != "size":
        result.answer = _answer(seen, fits, name, unit, word, confidence, r)
    if hazard is not None and "" in fits:
        others = (np.empty(0),) * 2 if draws is None else draws.curves
        tails = (0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence)
        r |= annual_collapse(*hazard, fits[""], others, tails, unit, name, result)
        result.answer += f" {spoken(r, name, unit, confidence)}"
    return r


def _curves(
    seen: Stripes, confidence: float, repeats: int, seed: int, name: str, unit: str, r: dict[str, Any], result: Result
) -> tuple[dict[str, Lognormal], likelihood.Draws | None]:
    """The lognormal curves that the runs determine, by stage, with their intervals and bands; the draws of the bootstrap."""
    levels, valid, over = seen.levels, seen.valid, seen.over
    count, hits, lifted = valid.sum(axis=0), over.sum(axis=0), (seen.outcome >= RECOVERY).sum(axis=0)
    first = likelihood.first_collapses(levels, over, valid)
    grid = np.geomspace(levels[0] / 1.5, levels[-1] * 1.5, 200)
    curves = {"grid": Array(grid, ("grid",), unit, name)}
    fits: dict[str, Lognormal] = {}
    stages: tuple[tuple[str, str, Callable[[], Lognormal]], ...] = (
        ("", "collapse", lambda: likelihood.fit_stripes(levels, hits, count)),
        ("first_collapse_", "first collapse", lambda: likelihood.fit_first_collapse(levels, first)),
        ("uplift_", "uplift", lambda: likelihood.fit_stripes(levels, lifted, count)),
        ("overturning_given_uplift_", "collapse after uplift", lambda: likelihood.fit_stripes(levels, hits, lifted)),
    )
    for stage, text, make in stages:
        try:
            fits[stage] = fit = make()
        except NoFit as error:
            r |= {f"{stage}median": None, f"{stage}dispersion": None}
            result.warnings.append(f"no curve of {text}: {error}")
            continue
        r |= {
            f"{stage}median": fit.median,
            f"{stage}dispersion": fit.dispersion,
            f"{stage}deviance": fit.deviance,
            f"{stage}degrees_of_freedom": fit.freedom,
            f"{stage}goodness_p_value": fit.p_value,
        }
        curves[f"{stage}curve"] = Array(fit.probability(grid), ("grid",), "", f"fitted probability of {text}")
        if stage in ("", "first_collapse_") and fit.freedom > 0 and fit.p_value < 0.01:
            result.warnings.append(
                f"the lognormal curve of {text} does not fit well (deviance {fit.deviance:.1f} at {fit.freedom} degrees of "
                f"freedom, p = {fit.p_value:.2g})"
            )
    if "uplift_" in fits and "overturning_given_uplift_" in fits:
        product = fits["uplift_"].probability(grid) * fits["overturning_given_uplift_"].probability(grid)
        curves["two_stage_curve"] = Array(product, ("grid",), "", "P(uplift) P(collapse | uplift)")
    draws = None
    if "" in fits and repeats:
        draws = likelihood.bootstrap(levels, over, valid, repeats, confidence, seed)
        r |= {"median_interval": draws.interval(draws.median), "dispersion_interval": draws.interval(draws.dispersion)}
        low, high = draws.band(grid)
        curves |= {
            "curve_lower": Array(low, ("grid",), "", "bootstrap band of the probability of collapse"),
            "curve_upper": Array(high, ("grid",)),
        }
    if "first_collapse_" in fits:
        region = likelihood.region(first, fits["first_collapse_"], confidence)
        r |= {"first_collapse_median_interval": region.median, "first_collapse_dispersion_interval": region.dispersion}
        low, high = region.band(grid)
        curves |= {
            "first_collapse_lower": Array(low, ("grid",), "", "profile-likelihood band of the curve of the first collapse"),
            "first_collapse_upper": Array(high, ("grid",)),
        }
    result.arrays |= curves
    return fits, draws


def _incremental(seen: Stripes, unit: str, ratio: str, r: dict[str, Any], result: Result, *, scaled: bool) -> None:
    """Incremental dynamic analysis: where each motion first brings it down, and levels above that do not. scaled: levels scale the
    motions; larger structures, in contrast, are more stable, and those that survive above a smaller one are the rule."""
    levels, valid, over = seen.levels, seen.valid, seen.over
    fell = np.asarray(over.any(axis=1))
    r["motions_that_collapse"] = int(fell.sum())
    result.arrays |= {
        "incremental_ratio": Array(seen.ratio[:SHOWN], ("shown", "stripe"), "", f"{ratio}, for the first motions"),
        "incremental_over": Array(over[:SHOWN].astype(np.int8), ("shown", "stripe"), "", "1: collapse"),
    }
    if not scaled:
        return
    index = over.argmax(axis=1)
    risen = (np.arange(len(levels)) > index[:, None]) & fell[:, None] & valid & ~over
    r["resurrections"] = int(risen.any(axis=1).sum())
    result.tables["incremental"] = TableData(
        {
            "motion": np.arange(len(fell)) + 1,
            "first_collapse": np.where(fell, levels[index], np.nan),
            "resurrected_levels": risen.sum(axis=1),
        },
        {"first_collapse": unit},
    )
    result.arrays |= {
        "incremental_risen": Array(
            risen[:SHOWN].astype(np.int8),
            ("shown", "stripe"),
            "",
            "1: the structure survives at this level, although a lower level of the same motion overturns it",
        )
    }


def _table(seen: Stripes, unit: str, r: dict[str, Any], result: Result) -> None:
    """fragility.csv and the arrays of the stripes."""
    confidence = np.array(r["confidence_interval"])
    uplift = np.array(r["uplift_confidence_interval"])
    table = {
        "level": seen.levels,
        "count": r["count"],
        "uplifted": r["uplifted"],
        "collapsed": r["collapsed"],
        "collapse_probability": r["collapse_probability"],
        "lower": confidence[:, 0],
        "upper": confidence[:, 1],
        "uplift_probability": r["uplift_probability"],
        "uplift_lower": uplift[:, 0],
        "uplift_upper": uplift[:, 1],
        **{f"peak_ratio_{p}": r[f"peak_rotation_ratio_{p}"] for p in PERCENTILES},
    }
    table = {k: np.array(v, dtype=int if k in ("count", "uplifted", "collapsed") else float) for k, v in table.items()}
    result.tables["fragility"] = TableData(dict(table), {"level": unit})
    result.arrays |= {f"stripe_{k}": Array(v.astype(float), ("stripe",), unit if k == "level" else "") for k, v in table.items()}


def _answer(seen: Stripes, fits: dict[str, Lognormal], name: str, unit: str, word: str, confidence: float, r: dict[str, Any]) -> str:
    def told(stage: str) -> str:
        fit = fits[stage]
        text = f"{fit.median:.4g}{' ' + unit if unit else ''}, dispersion {fit.dispersion:.3f}"
        low, high = r.get(f"{stage}median_interval", (np.nan, np.nan))
        return text + (f" ({100 * confidence:g} % confidence interval of the median: {low:.4g} to {high:.4g})" if np.isfinite(low) else "")

    motions, n = seen.outcome.shape
    whole = int(seen.valid.all(axis=1).sum())
    whose = f"{motions} motions" if whole == motions else f"{whole} of {motions} motions (the others have no result at some level)"
    said = [
        f"{whose} at {n} level{'s' if n > 1 else ''} of {name}: "
        + (f"the probability of collapse has the median {told('')}" if "" in fits else "no fragility curve of collapse could be fitted")
    ]
    if "first_collapse_" in fits:
        said.append(
            f"If a motion is scaled up level by level, it first causes collapse of the {word} at the median {told('first_collapse_')}"
        )
    known = [p for p in r["collapse_probability"] if p is not None]
    if known:
        said.append(f"Collapse: {100 * known[0]:.1f} % of the motions at the lowest level, {100 * known[-1]:.1f} % at the highest level")
    said.append(
        f"{r['resurrections']} motion{' leaves' if r['resurrections'] == 1 else 's leave'} the {word} standing at a level "
        "although a lower level overturns it"
    )
    return ". ".join(said) + "."
