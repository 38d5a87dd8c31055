"""Motions as they are, each at its own intensity: curves of collapse and of rotations beyond limits (cloud analysis).

Each motion tells on which side of its intensity a capacity lies, for the collapse as for any rotation, so each has its
lognormal curve by maximum likelihood. Jalayer, Ebrahimian, Miano, Manfredi and Sezen 2017 (EESD 46:2639-2663) write a
logistic curve for the collapse, which is the same within the sampling error, and for the rest the regression ln(response)
= ln a + b ln x, which rocking does not follow: between uplift and collapse rotations grow by the factor 1000
(docs/rocking-statistics.md, Clouds).
"""

from typing import Any

import numpy as np

from extrados.analyses.statistics import likelihood
from extrados.analyses.statistics.annual import annual_collapse, rates, spoken
from extrados.analyses.statistics.likelihood import Lognormal, NoFit, Region
from extrados.analyses.statistics.tables import Hazard
from extrados.core.rocking import FAILED
from extrados.motions.hazard import HazardCurve
from extrados.results import statistics as out
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE

GRID = 200


def fit_cloud(x: np.ndarray, passed: np.ndarray, confidence: float) -> tuple[Lognormal, Region]:
    """The curve over intensities x of motions of which some `passed` a limit, and what the likelihood does not exclude
    beside it; NoFit where they determine none."""
    seen = likelihood.stripes(x, passed.astype(float), np.ones(len(x)))
    found = likelihood.fit(seen)
    return found, likelihood.region(seen, found, confidence)


def describe(
    x: np.ndarray,
    outcome: np.ndarray,
    ratio: np.ndarray,
    name: str,
    unit: str,
    limits: list[float],
    hazard: tuple[HazardCurve, Hazard] | None,
    confidence: float,
    result: Result,
) -> dict[str, Any]:
    """Curves over the intensities of the motions, as results; table, arrays, warnings and words into `result`.

    outcome, ratio: of each motion, and its greatest rotation over the critical one; name, unit: of the intensity;
    limits: rotation ratios.
    """
    ok = (outcome != FAILED) & (x > 0.0)
    fell = outcome[ok] == COLLAPSE
    r: dict[str, Any] = {"intensity": name, "intensity_unit": unit}
    result.arrays |= {"intensity": Array(x, ("member",), unit, name)}
    if not ok.any():
        return r
    grid = np.geomspace(x[ok].min() / 1.5, x[ok].max() * 1.5, GRID)
    result.arrays |= {"grid": Array(grid, ("grid",), unit, name)}
    columns = {"intensity": grid}
    try:
        found, region = fit_cloud(x[ok], fell, confidence)
    except NoFit as error:
        result.warnings.append(f"no fragility curve of collapse over {name} could be fitted: {error}")
        r |= {"median": None, "dispersion": None}
    else:
        r |= {
            "median": found.median,
            "dispersion": found.dispersion,
            "median_interval": region.median,
            "dispersion_interval": region.dispersion,
        }
        _curve("curve", "collapse", found, region, grid, columns, result)
        if np.isnan(region.median).any():
            result.warnings.append(
                f"The motions do not show that the probability of collapse increases with {name}: a constant probability lies within the "
                f"{100.0 * confidence:.3g} % confidence region. The fitted median and dispersion are not determined. Use more motions, or another "
                "`intensity`."
            )
        result.answer += (
            f" For the unscaled motions, the fragility curve of collapse over {name} has the median "
            f"{found.median:.4g}{f' {unit}' if unit else ''} and the dispersion {found.dispersion:.3f}."
        )
        if hazard is not None:
            r |= annual_collapse(*hazard, found, region.curves, None, unit, name, result)
            result.answer += f" {spoken(r, name, unit, confidence)}"
    rows = []
    for limit in sorted(limits):
        try:
            found, region = fit_cloud(x[ok], fell | (ratio[ok] > limit), confidence)
        except NoFit as error:
            result.warnings.append(
                f"no fragility curve over {name} could be fitted for rotations above {limit:g} times the critical rotation: {error}"
            )
            continue
        _curve(f"beyond_{limit:g}", f"a rotation ratio above {limit:g}", found, region, grid, columns, result)
        annual: dict[str, Any] = {}
        if hazard is not None:
            rate, interval = rates(hazard[0], found, region.curves, None)
            annual = {"annual_rate": rate, "annual_rate_interval": interval}
        rows.append(
            out.RotationLimit(
                rotation_ratio=limit, median=found.median, dispersion=found.dispersion, median_interval=region.median.tolist(), **annual
            )
        )
    if rows:
        r["rotation_limits"] = rows
    if len(columns) > 1:
        result.tables["cloud"] = TableData(columns, {"intensity": unit})
    return r


#: Measure -> its power of the amplitude of a motion
POWERS = {"PGA": 1, "PGV": 1, "Arias intensity": 2}


def compare(measures: dict[str, tuple[np.ndarray, str]], outcome: np.ndarray) -> list[out.MeasureDispersion]:
    """Intensity measures of the same motions, best first: how well each alone tells collapse from survival (efficiency, Luco and Cornell
    2007). measures: values of each motion, and their unit; outcome of each motion.

    Each has its curve by maximum likelihood; the one of the greatest likelihood predicts best. Dispersions are compared per amplitude: that
    of a measure that grows with its square counts half. A measure without a curve is left out.
    """
    ok = outcome != FAILED
    for values, _ in measures.values():
        ok &= np.isfinite(values) & (values > 0.0)
    fell = outcome[ok] == COLLAPSE
    rows = []
    for name, (values, unit) in measures.items():
        try:
            found = likelihood.fit(likelihood.stripes(values[ok], fell.astype(float), np.ones(len(fell))))
        except NoFit:
            continue
        p = np.clip(found.probability(values[ok]), 1e-300, 1.0 - 1e-16)
        loss = -2.0 * float(np.where(fell, np.log(p), np.log1p(-p)).sum())
        rows.append(
            out.MeasureDispersion(
                measure=name,
                unit=unit,
                median=found.median,
                dispersion=found.dispersion,
                amplitude_dispersion=found.dispersion / POWERS.get(name, 1),
                deviance=loss,
            )
        )
    return sorted(rows, key=lambda row: row.deviance)


def _curve(key: str, what: str, found: Lognormal, region: Region, grid: np.ndarray, columns: dict[str, np.ndarray], result: Result) -> None:
    """A curve with its band into the table and the arrays; those of rotations as series."""
    low, high = region.band(grid)
    for end, values in (("", found.probability(grid)), ("_lower", low), ("_upper", high)):
        columns[f"{key}{end}"] = values
        about = f"probability of {what}" if not end else "profile-likelihood band"
        series = "" if key == "curve" else f"limit{end}"
        result.arrays[f"{key}{end}"] = Array(values, ("grid",), "", about, series=series)
