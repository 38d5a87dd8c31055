"""From the hazard of a site and a curve of collapse to the annual rate of collapse."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr

from extrados.analyses.context import Refused
from extrados.analyses.statistics.likelihood import Lognormal
from extrados.analyses.statistics.tables import Hazard, check_hazard
from extrados.motions.hazard import HazardCurve, Probability
from extrados.results.model import Array, Result
from extrados.schema import files

LARGEST = 10_000_000  # bytes of a file
#: The key of the deck that names it
FILE = ("analysis", "hazard", "file")
#: Share of the rate beyond the ends of the hazard curve that is told
TOLD = 0.05
GRID = 300


def hazard_curve(options: Hazard, folder: Path) -> HazardCurve:
    """The curve of a deck, from its lists or its file; Refused where the file holds none."""
    if options.file is None:
        return HazardCurve(np.array(options.intensities), np.array(options.annual_rates))
    try:
        text = files.read(options.file, LARGEST, folder).text()
    except files.BadFile as error:
        raise Refused(str(error), FILE) from None
    rows = []
    for k, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        try:
            x, rate = (float(cell) for cell in next(csv.reader([line])))
        except (ValueError, csv.Error):
            raise Refused(f"{options.file}:{k}: expected an intensity and an annual rate, found {line[:60]!r}", FILE) from None
        rows.append((x, rate))
    try:
        if len(rows) < 2 or not np.isfinite(rows).all():
            raise ValueError(f"the hazard curve has {len(rows)} pairs of finite numbers; expected two or more")
        check_hazard(*map(list, zip(*rows, strict=True)))
    except ValueError as error:
        raise Refused(f"{options.file}: {error}", FILE) from None
    return HazardCurve(*np.array(rows).T)


def curve_of(median: np.ndarray | float, dispersion: np.ndarray | float) -> Probability:
    """Lognormal curves (..., x) of these medians and dispersions."""
    median, dispersion = np.asarray(median)[..., None], np.asarray(dispersion)[..., None]
    return lambda x: ndtr(np.log(x / median) / dispersion)


def rates(
    hazard: HazardCurve, found: Lognormal, others: tuple[np.ndarray, np.ndarray], tails: tuple[float, float] | None
) -> tuple[float, np.ndarray]:
    """Annual rate of a curve, and its interval by the others, medians and dispersions that the runs do not exclude.

    tails: quantiles over them, as for draws of a bootstrap; None for their extremes, as for the border of a likelihood
    region. NaN without others.
    """
    interval = np.full(2, np.nan)
    if len(others[0]) > 1:
        interval = np.quantile(hazard.rate_of(curve_of(*others)), [0.0, 1.0] if tails is None else tails)
    return float(hazard.rate_of(curve_of(found.median, found.dispersion))), interval


def annual_collapse(
    hazard: HazardCurve,
    options: Hazard,
    found: Lognormal,
    others: tuple[np.ndarray, np.ndarray],
    tails: tuple[float, float] | None,
    unit: str,
    name: str,
    result: Result,
) -> dict[str, Any]:
    """The rate of collapse by a curve, its interval and what follows, as results; arrays and warnings into `result`.

    others, tails: see `rates`; name, unit: of the intensity.
    """
    probability = curve_of(found.median, found.dispersion)
    rate, interval = rates(hazard, found, others, tails)
    missing = float(hazard.left_out(probability))
    if missing > TOLD * rate:
        first, last = hazard.intensity[[0, -1]]
        result.warnings.append(
            f"intensities below {first:.4g} or above {last:.4g}{(f' {unit}' if unit else '')} are beyond the ends of "
            f"the hazard curve. They may add up to {missing:.2g} a year, {100 * missing / rate:.0f} % of the rate of "
            "collapse: give a hazard curve with a wider range"
        )
    x = np.geomspace(hazard.intensity[0], hazard.intensity[-1], GRID)
    density = probability(x) * hazard.density(x)
    result.arrays |= {
        "hazard_intensity": Array(hazard.intensity, ("hazard",), unit, name),
        "hazard_rate": Array(hazard.rate, ("hazard",), "1/year", "mean annual rate of exceedance"),
        "contribution_intensity": Array(x, ("contribution",), unit, name),
        "contribution": Array(density, ("contribution",), "1/year", "annual rate of collapse per unit of ln(intensity)"),
    }
    return {
        "annual_collapse_rate": rate,
        "annual_collapse_rate_interval": interval,
        "annual_collapse_rate_left_out": missing,
        "collapse_return_period_years": 1.0 / rate if rate > 0.0 else None,
        "years": options.years,
        "collapse_probability_in_years": -np.expm1(-rate * options.years),
        "collapse_probability_in_years_interval": -np.expm1(-interval * options.years),
        "decisive_intensity": float(x[density.argmax()]),
        "acceptable_annual_rate": options.acceptable_rate,
    }


def spoken(r: dict[str, Any], name: str, unit: str, confidence: float) -> str:
    """The annual rate in words."""
    low, high = r["annual_collapse_rate_interval"]
    band = f" ({low:.2g} to {high:.2g} at {100 * confidence:g} %)" if np.isfinite(low) else ""
    return (
        f"With the hazard of the site, the annual rate of collapse is {r['annual_collapse_rate']:.3g}{band}; the probability of "
        f"collapse is {100 * r['collapse_probability_in_years']:.2g} % in {r['years']:g} years. Motions with {name} about "
        f"{r['decisive_intensity']:.3g}{(f' {unit}' if unit else '')} contribute most."
    )
