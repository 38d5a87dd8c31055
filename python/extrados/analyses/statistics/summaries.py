"""Probabilities of collapse and how sure they are."""

from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr, ndtr
from scipy.stats import chi2, norm


def wilson(
    hits: np.ndarray | float, count: np.ndarray | float, confidence: float = 0.95
) -> tuple[np.ndarray, np.ndarray]:
    """Score interval of a probability from `hits` in `count` (Wilson 1927, JASA 22:209-212)."""
    hits, count = np.asarray(hits, dtype=float), np.asarray(count, dtype=float)
    z = norm.ppf(0.5 + 0.5 * confidence)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = hits / count
        middle = (share + z**2 / (2.0 * count)) / (1.0 + z**2 / count)
        half = z / (1.0 + z**2 / count) * np.sqrt(share * (1.0 - share) / count + z**2 / (4.0 * count**2))
    low = np.where(count > 0, np.where(hits == 0, 0.0, middle - half), 0.0)
    high = np.where(count > 0, np.where(hits == count, 1.0, middle + half), 1.0)
    return low, high


@dataclass(frozen=True)
class Lognormal:
    """P(x) = Phi(ln(x / median) / dispersion). deviance, its degrees of freedom and p-value tell the fit."""

    median: float
    dispersion: float
    deviance: float = np.nan
    freedom: int = 0
    p_value: float = np.nan

    def probability(self, x: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore"):
            return ndtr(np.log(np.asarray(x, dtype=float) / self.median) / self.dispersion)


class NoFit(ValueError):
    """The observations do not determine a fragility curve; the text says why."""


def fit_lognormal(x: np.ndarray, hits: np.ndarray, count: np.ndarray) -> Lognormal:
    """Maximum likelihood over stripes: `hits` of `count` at intensity x (Baker 2015, Earthquake Spectra 31:579-599).

    It is the probit model Phi(a + b ln x): solved by Fisher scoring with halved steps, as its likelihood is concave.
    """
    x, hits, count = (np.asarray(v, dtype=float) for v in (x, hits, count))
    used = count > 0
    x, hits, count = x[used], hits[used], count[used]
    if len(np.unique(x)) < 2:
        raise NoFit("a curve needs two or more intensities")
    share = hits / count
    if share.max() == 0.0:
        raise NoFit("nothing happened at any intensity")
    if share.min() == 1.0:
        raise NoFit("it happened in every run at every intensity")
    order = np.argsort(x)
    mixed = (share > 0.0) & (share < 1.0)
    step = share[order]
    if not mixed.any() and np.all(np.diff(step) >= 0.0):
        raise NoFit("all runs agree at each intensity: the curve is a step, its dispersion cannot be told")
    design = np.stack([np.ones_like(x), np.log(x)], axis=1)

    def loss(c: np.ndarray) -> float:
        eta = design @ c
        return -float(np.sum(hits * log_ndtr(eta) + (count - hits) * log_ndtr(-eta)))

    start = np.clip((hits + 0.5) / (count + 1.0), 1e-3, 1.0 - 1e-3)
    c = np.linalg.lstsq(design, norm.ppf(start), rcond=None)[0]
    now = loss(c)
    for _ in range(100):
        eta = design @ c
        density = norm.pdf(eta)
        # logarithms keep the far tails finite
        p, q = np.exp(log_ndtr(eta)), np.exp(log_ndtr(-eta))
        weight = count * density**2 / np.maximum(p * q, 1e-300)
        score = design.T @ (density * (hits - count * p) / np.maximum(p * q, 1e-300))
        try:
            move = np.linalg.solve(design.T @ (weight[:, None] * design), score)
        except np.linalg.LinAlgError:
            raise NoFit("the observations do not determine both median and dispersion") from None
        scale = 1.0
        while scale > 1e-6 and not loss(c + scale * move) <= now:
            scale *= 0.5
        c = c + scale * move
        before, now = now, loss(c)
        if before - now <= 1e-12 * max(1.0, abs(now)):
            break
    if not c[1] > 1e-9:
        raise NoFit("the probability does not grow with the intensity")
    with np.errstate(divide="ignore", invalid="ignore"):
        best = np.sum(
            np.where(hits > 0, hits * np.log(share), 0.0)
            + np.where(hits < count, (count - hits) * np.log1p(-share), 0.0)
        )
    deviance = max(0.0, 2.0 * (float(best) + now))
    freedom = len(x) - 2
    p_value = float(chi2.sf(deviance, freedom)) if freedom > 0 else np.nan
    return Lognormal(float(np.exp(-c[0] / c[1])), float(1.0 / c[1]), deviance, freedom, p_value)


def bootstrap(
    x: np.ndarray, outcome: np.ndarray, valid: np.ndarray, repeats: int, confidence: float, seed: int, grid: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Whole motions are drawn anew, so that their dependence over the intensities is kept.

    outcome, valid (motions, intensities). Returns the interval of the median and of the dispersion (2 each), and the
    band of the curve over `grid` (low, high); NaN where fewer than half of the draws have a fit.
    """
    random = np.random.default_rng(seed)
    n = len(outcome)
    fits = []
    for _ in range(repeats):
        weight = np.bincount(random.integers(0, n, n), minlength=n)
        try:
            fits.append(fit_lognormal(x, weight @ (outcome & valid), weight @ valid))
        except NoFit:
            continue
    tails = [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence]
    if len(fits) < max(2, repeats // 2):
        nothing = np.full(2, np.nan)
        return nothing, nothing, np.full(len(grid), np.nan), np.full(len(grid), np.nan)
    curves = np.quantile([f.probability(grid) for f in fits], tails, axis=0)
    return (
        np.quantile([f.median for f in fits], tails), np.quantile([f.dispersion for f in fits], tails), curves[0], curves[1],
    )  # fmt: skip
