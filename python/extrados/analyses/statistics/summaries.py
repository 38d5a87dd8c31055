"""Shares of runs that rock and come down, and how sure they are."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from scipy.stats import norm

from extrados.core.rocking import FAILED
from extrados.results.rocking import COLLAPSE, NO_HINGING

#: Numbers that come in pieces, from the first again at each call
Pieces = Callable[[], Iterator[np.ndarray]]
#: Of many numbers so many are sorted to find their median, and so many bins lead to them
FEW, BINS = 100_000, 65_536


def wilson(hits: np.ndarray | float, count: np.ndarray | float, confidence: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
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


def median(pieces: Pieces) -> float | None:
    """The median of numbers that come in pieces, NaN left out; None where there is none.

    Many are counted in bins between bounds that close in on the middle ones, so that never more than a piece and FEW of
    them are in memory.
    """
    low, high, below, n = -np.inf, np.inf, 0, None
    while True:
        kept, count, least, most = [], 0, np.inf, -np.inf
        for piece in pieces():
            x = piece[(piece >= low) & (piece <= high)]
            if not len(x):
                continue
            count += len(x)
            least, most = min(least, float(x.min())), max(most, float(x.max()))
            if count <= FEW:
                kept.append(x)
        n = count if n is None else n
        if not n:
            return None
        wanted = [(n - 1) // 2 - below, n // 2 - below]
        if least == most:
            return least
        if count <= FEW:
            return float(np.mean(np.partition(np.concatenate(kept), wanted)[wanted]))
        edges = np.linspace(least, most, BINS + 1)
        bins = np.zeros(BINS, int)
        for piece in pieces():
            x = piece[(piece >= low) & (piece <= high)]
            bins += np.bincount(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, BINS - 1), minlength=BINS)
        upto = np.cumsum(bins)
        first, last = (int(np.searchsorted(upto, k, side="right")) for k in wanted)
        if first < last:  # neighbours in rank: the greatest up to the one bin and the least from the other on
            ends = [(float(x[x < edges[first + 1]].max(initial=-np.inf)), float(x[x >= edges[last]].min(initial=np.inf))) for x in pieces()]
            return 0.5 * (max(end for end, _ in ends) + min(end for _, end in ends))
        below += int(upto[first] - bins[first])
        low = edges[first]
        high = most if last == BINS - 1 else float(np.nextafter(edges[last + 1], -np.inf))


def shares(outcome: np.ndarray, peak_ratio: np.ndarray, confidence: float, initial: float) -> dict[str, Any]:
    """Probabilities with Wilson intervals and the moments of the peak rotation over the critical one, of runs at one
    intensity; overturned ones count as 1. initial: rotation at the start over the critical one.
    """
    return shares_of(lambda: iter([(outcome, peak_ratio)]), confidence, initial)


def shares_of(runs: Callable[[], Iterator[tuple[np.ndarray, np.ndarray]]], confidence: float, initial: float) -> dict[str, Any]:
    """The same of runs that come in pieces, outcome and peak rotation ratio."""

    def ratios() -> Iterator[np.ndarray]:
        for outcome, peak_ratio in runs():
            yield np.minimum(peak_ratio[outcome != FAILED], 1.0)

    n = collapsed = lifted = 0
    for outcome, peak_ratio in runs():
        ok = outcome != FAILED
        n += int(ok.sum())
        collapsed += int((outcome == COLLAPSE).sum())
        # With a start off rest every member rocks: uplift then means that it rose beyond its start.
        rose = outcome > NO_HINGING if initial == 0.0 else peak_ratio > abs(initial) * (1 + 1e-9)
        lifted += int((ok & rose).sum())
    mean = sum(float(x.sum()) for x in ratios()) / n if n else None
    spread = sum(float(((x - mean) ** 2).sum()) for x in ratios())
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
        "mean_peak_rotation_ratio": mean,
        "deviation_peak_rotation_ratio": float(np.sqrt(spread / (n - 1))) if n > 1 else None,
        "median_peak_rotation_ratio": median(ratios),
    }
