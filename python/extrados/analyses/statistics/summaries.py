"""Shares of runs that rock and come down, and how sure they are."""

from typing import Any

import numpy as np
from scipy.stats import norm

from extrados.core.rocking import FAILED
from extrados.results.rocking import COLLAPSE, NO_HINGING


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


def shares(outcome: np.ndarray, peak_ratio: np.ndarray, confidence: float, initial: float) -> dict[str, Any]:
    """Probabilities with Wilson intervals and the moments of the peak rotation over the critical one, of runs at one
    intensity; overturned ones count as 1. initial: rotation at the start over the critical one.
    """
    ok = outcome != FAILED
    n = int(ok.sum())
    collapsed = int((outcome == COLLAPSE).sum())
    # With a start off rest every member rocks: uplift then means that it rose beyond its start.
    rose = outcome > NO_HINGING if initial == 0.0 else peak_ratio > abs(initial) * (1 + 1e-9)
    lifted = int((ok & rose).sum())
    ratio = np.minimum(peak_ratio[ok], 1.0)
    low, high = wilson(collapsed, n, confidence)
    up_low, up_high = wilson(lifted, n, confidence)
    return {
        "count": n,
        "collapsed": collapsed,
        "collapse_probability": collapsed / n if n else None,
        "confidence_interval": [float(low), float(high)],
        "uplifted": lifted,
        "uplift_probability": lifted / n if n else None,
        "uplift_confidence_interval": [float(up_low), float(up_high)],
        "mean_peak_rotation_ratio": float(ratio.mean()) if n else None,
        "deviation_peak_rotation_ratio": float(ratio.std(ddof=1)) if n > 1 else None,
        "median_peak_rotation_ratio": float(np.median(ratio)) if n else None,
    }
