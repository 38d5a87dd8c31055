"""Lognormal curves of capacities known only to lie within intervals, by maximum likelihood.

A motion that leaves a building standing at one level and brings it down at the next tells an interval that holds its
capacity; one that never brings it down, that the capacity lies above the last level; a run at one level alone, on
which side of the level it lies. With z = b ln x - a, b = 1/dispersion, a = b ln(median), a capacity between l and u
has the probability Phi(z(u)) - Phi(z(l)), and the log-likelihood is concave in (a, b) (Burridge 1981, JRSS B 43:41-45):
there is one greatest value, and the points above any value form a convex set.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import log_ndtr, ndtr
from scipy.stats import chi2

MOST_STEPS = 200  # of Newton's method
DIRECTIONS = 120  # on which the border of a confidence region is found
FLAT = 1e-3  # a curve that grows by no more standard deviations between the least and the greatest intensity is flat


class NoFit(ValueError):
    """The observations do not determine a curve; the text says why."""


@dataclass(frozen=True)
class Lognormal:
    """P(capacity <= x) = Phi(ln(x / median) / dispersion).

    deviance, its degrees of freedom and p-value tell the fit, NaN where the observations fall into no common classes.
    """

    median: float
    dispersion: float
    deviance: float = np.nan
    freedom: int = 0
    p_value: float = np.nan

    def probability(self, x: np.ndarray) -> np.ndarray:
        """Probability (n) at intensities x (n), in the unit of the median."""
        with np.errstate(divide="ignore"):
            return ndtr(np.log(np.asarray(x, dtype=float) / self.median) / self.dispersion)


@dataclass(frozen=True)
class Capacities:
    """Capacities above low (0: nothing known) and up to high (infinity: nothing known), each `weight` times."""

    low: np.ndarray
    high: np.ndarray
    weight: np.ndarray

    @property
    def ends(self) -> np.ndarray:
        """The intensities at which something was seen, in order."""
        ends = np.concatenate([self.low, self.high])
        return np.unique(ends[(ends > 0.0) & np.isfinite(ends)])


@dataclass(frozen=True)
class Region:
    """Border of the likelihood region of (a, b): all curves that the observations do not exclude."""

    a: np.ndarray
    b: np.ndarray

    @property
    def median(self) -> np.ndarray:
        """Profile-likelihood interval of the median; NaN where the curve need not grow at all."""
        return self._interval(np.exp(self.a / self.b)) if self.b.min() > 0.0 else np.full(2, np.nan)

    @property
    def dispersion(self) -> np.ndarray:
        """Profile-likelihood interval of the dispersion."""
        return self._interval(1.0 / self.b) if self.b.min() > 0.0 else np.array([1.0 / self.b.max(), np.nan])

    @property
    def curves(self) -> tuple[np.ndarray, np.ndarray]:
        """Medians and dispersions on the border; none where a curve on it does not grow."""
        if self.b.min() <= 0.0:
            return np.empty(0), np.empty(0)
        return np.exp(self.a / self.b), 1.0 / self.b

    def band(self, x: np.ndarray) -> np.ndarray:
        """Profile-likelihood band of the probability at each x, shape (2, x): z is linear in (a, b)."""
        return ndtr(self._interval(self.b[:, None] * np.log(x) - self.a[:, None]))

    @staticmethod
    def _interval(values: np.ndarray) -> np.ndarray:
        return np.array([values.min(axis=0), values.max(axis=0)])


def stripes(x: np.ndarray, hits: np.ndarray, count: np.ndarray) -> Capacities:
    """`hits` of `count` runs that come down at intensity x; hits and count may have leading axes for further sets."""
    low = np.concatenate([np.zeros_like(x), x])
    high = np.concatenate([x, np.full_like(x, np.inf)])
    return Capacities(low, high, np.concatenate([hits, count - hits], axis=-1).astype(float))


def first_collapses(levels: np.ndarray, over: np.ndarray, valid: np.ndarray) -> Capacities:
    """Where each motion first brings it down, levels ascending, over and valid (motions, levels).

    Above the highest level without collapse below the first with one; levels without a result widen the interval.
    """
    index = np.arange(len(levels))
    fell = over & valid
    first = np.where(fell.any(axis=1), fell.argmax(axis=1), len(levels))
    stood = np.where(valid & ~fell & (index < first[:, None]), index, -1).max(axis=1)
    low = np.concatenate([levels, [0.0]])[stood]  # -1 takes the last
    high = np.concatenate([levels, [np.inf]])[first]
    known = valid.any(axis=1)
    pairs, weight = np.unique(np.stack([low, high], axis=1)[known], axis=0, return_counts=True)
    return Capacities(pairs[:, 0], pairs[:, 1], weight.astype(float))


def fit(seen: Capacities) -> Lognormal:
    """The curve of greatest likelihood; NoFit where there is none."""
    used = seen.weight > 0.0
    low, high, weight = seen.low[used], seen.high[used], seen.weight[used]
    if len(seen.ends) < 2:
        raise NoFit("a curve requires at least two intensities")
    if not len(low) or not np.isfinite(high).any():
        raise NoFit("the observed probability is 0 at every intensity")
    if not low.any():
        raise NoFit("the observed probability is 1 at every intensity")
    if low.max() <= high.min():
        raise NoFit(
            f"the observed probability jumps from 0 at {low.max():.4g} to 1 at {high.min():.4g}, so the dispersion cannot be estimated"
            if low.max() < high.min()
            else f"the observed probability jumps from 0 below {low.max():.4g} to 1 above it, so the dispersion cannot be estimated"
        )
    a, b = _greatest(low, high, weight[None, :])
    if not b[0] * np.log(seen.ends[-1] / seen.ends[0]) > FLAT:
        raise NoFit("the probability does not increase with the intensity")
    return Lognormal(float(np.exp(a[0] / b[0])), float(1.0 / b[0]))


def fit_stripes(x: np.ndarray, hits: np.ndarray, count: np.ndarray) -> Lognormal:
    """Multiple stripes: `hits` of `count` at intensity x (Baker 2015, Earthquake Spectra 31:579-599)."""
    x, hits, count = (np.asarray(v, dtype=float) for v in (x, hits, count))
    used = count > 0
    x, hits, count = x[used], hits[used], count[used]
    found = fit(stripes(x, hits, count))
    deviance = _deviance(hits, count * found.probability(x)) + _deviance(count - hits, count * _above(found, x))
    return _judged(found, deviance, len(x) - 2)


def fit_first_collapse(levels: np.ndarray, seen: Capacities) -> Lognormal:
    """Incremental analyses over ascending levels: one interval for each motion, see `first_collapses`."""
    found = fit(seen)
    place = {pair: k for k, pair in enumerate(pairwise([0.0, *levels, np.inf]))}
    pairs = list(zip(seen.low, seen.high, strict=True))
    if not all(pair in place for pair in pairs):
        return found  # a motion without a result at some level: no common classes
    hits = np.zeros(len(place))
    np.add.at(hits, [place[pair] for pair in pairs], seen.weight)
    below = np.concatenate([[0.0], found.probability(levels), [1.0]])
    above = np.concatenate([[1.0], _above(found, levels), [0.0]])
    share = np.where(below[1:] < 0.5, np.diff(below), -np.diff(above))  # of the smaller tail
    return _judged(found, _deviance(hits, hits.sum() * share), len(hits) - 3)


def _above(found: Lognormal, x: np.ndarray) -> np.ndarray:
    """P(capacity > x), exact where it is small."""
    return ndtr(np.log(found.median / x) / found.dispersion)


def region(seen: Capacities, found: Lognormal, confidence: float) -> Region:
    """All (a, b) whose log-likelihood is within chi2/2 of the greatest, one degree of freedom: the extremes over it of
    any one quantity are its profile-likelihood interval. The observations must be independent of each other.
    """
    used = seen.weight > 0.0
    low, high, weight = seen.low[used], seen.high[used], seen.weight[None, used]
    centre = np.log(found.median)
    below, above = _logarithms(low, high, centre)
    b = np.array([1.0 / found.dispersion])
    best, _, information = _likelihood(np.zeros(1), b, below, above, weight)
    angle = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    ray = np.linalg.solve(np.linalg.cholesky(information[0]).T, np.stack([np.cos(angle), np.sin(angle)]))
    drop = 0.5 * chi2.ppf(confidence, 1)

    def beyond(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the likelihood at t loses beyond the drop, and its slope: convex along a ray."""
        now, score, _ = _likelihood(t * ray[0], b + t * ray[1], below, above, weight)
        return best - now - drop, -(score * ray.T).sum(axis=1)

    # Newton's method comes from outside; where it leaves what is known of the border the middle is taken
    near, far = np.zeros(DIRECTIONS), np.full(DIRECTIONS, np.inf)
    t = np.full(DIRECTIONS, np.sqrt(2.0 * drop))
    for _ in range(MOST_STEPS):
        loss, slope = beyond(t)
        near, far = np.where(loss < 0.0, t, near), np.where(loss < 0.0, far, t)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = t - loss / slope
        step = np.where((step > near) & (step < far), step, np.where(np.isfinite(far), 0.5 * (near + far), 2.0 * t))
        if np.all(np.abs(step - t) <= 1e-10 * t):
            break
        t = step
    b = b + t * ray[1]
    return Region(t * ray[0] + b * centre, b)


@dataclass(frozen=True)
class Draws:
    """Curves fitted to sets of motions drawn anew; those that determine none are left out. share: of draws with a curve."""

    median: np.ndarray
    dispersion: np.ndarray
    share: float
    confidence: float

    @property
    def curves(self) -> tuple[np.ndarray, np.ndarray]:
        """Medians and dispersions; none where fewer than half of the draws have a curve."""
        return (self.median, self.dispersion) if self.share >= 0.5 else (np.empty(0), np.empty(0))

    def interval(self, values: np.ndarray) -> np.ndarray:
        """Quantiles (2, ...) of a quantity over the draws; NaN where fewer than half of them have a curve."""
        if self.share < 0.5 or len(values) < 2:
            return np.full((2, *values.shape[1:]), np.nan)
        return np.quantile(values, [0.5 - 0.5 * self.confidence, 0.5 + 0.5 * self.confidence], axis=0)

    def band(self, x: np.ndarray) -> np.ndarray:
        """Band of the probability at each x, shape (2, x)."""
        return self.interval(ndtr(np.log(x / self.median[:, None]) / self.dispersion[:, None]))


def bootstrap(x: np.ndarray, over: np.ndarray, valid: np.ndarray, repeats: int, confidence: float, seed: int) -> Draws:
    """Stripes of motions drawn anew, each with all its levels, which depend on one another; over, valid (motions, levels)."""
    random = np.random.default_rng(seed)
    n = len(over)
    hits, count = np.zeros((repeats, len(x))), np.zeros((repeats, len(x)))
    # single precision holds the counts of up to 2^24 motions exactly
    over, valid = (over & valid).astype(np.float32), valid.astype(np.float32)
    for k in range(repeats):
        weight = np.bincount(random.integers(0, n, n), minlength=n).astype(np.float32)
        hits[k], count[k] = weight @ over, weight @ valid
    seen = stripes(x, hits, count)
    used = seen.weight > 0.0
    low = np.where(used, seen.low, 0.0).max(axis=1)
    high = np.where(used, seen.high, np.inf).min(axis=1)
    able = np.isfinite(high) & (low > high)
    a, b = _greatest(seen.low, seen.high, seen.weight[able])
    a, b = a[b > 1e-9], b[b > 1e-9]
    return Draws(np.exp(a / b), 1.0 / b, len(b) / repeats, confidence)


def _judged(found: Lognormal, deviance: float, freedom: int) -> Lognormal:
    deviance = max(0.0, deviance)
    p_value = float(chi2.sf(deviance, freedom)) if freedom > 0 else np.nan
    return Lognormal(found.median, found.dispersion, deviance, max(0, freedom), p_value)


def _deviance(hits: np.ndarray, expected: np.ndarray) -> float:
    """Twice the log-likelihood that the expected numbers lose against those seen."""
    some = hits > 0.0
    with np.errstate(divide="ignore"):
        return 2.0 * float(np.sum(hits[some] * np.log(hits[some] / expected[some])))


def _logarithms(low: np.ndarray, high: np.ndarray, centre: float) -> tuple[np.ndarray, np.ndarray]:
    with np.errstate(divide="ignore"):
        return np.log(low) - centre, np.log(high) - centre


def _greatest(low: np.ndarray, high: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(a, b) of greatest likelihood for each row of weights, by Newton's method with halved steps.

    Each row must exclude a step; where the probability falls with the intensity, b <= 0.
    """
    ends = np.concatenate([low, high])
    ends = np.log(ends[(ends > 0.0) & np.isfinite(ends)])
    centre = 0.5 * (ends.min() + ends.max())
    below, above = _logarithms(low, high, centre)
    a, b = np.zeros(len(weight)), np.full(len(weight), 4.0 / max(np.ptp(ends), 1e-6))
    now, score, information = _likelihood(a, b, below, above, weight)
    for _ in range(MOST_STEPS):
        with np.errstate(divide="ignore", invalid="ignore"):
            det = information[:, 0, 0] * information[:, 1, 1] - information[:, 0, 1] ** 2
            move_a = (information[:, 1, 1] * score[:, 0] - information[:, 0, 1] * score[:, 1]) / det
            move_b = (information[:, 0, 0] * score[:, 1] - information[:, 0, 1] * score[:, 0]) / det
        gain = move_a * score[:, 0] + move_b * score[:, 1]
        open_ = gain > 1e-13 * np.maximum(1.0, np.abs(now))
        if not open_.any():
            break
        scale = np.where(open_, 1.0, 0.0)
        for _ in range(60):
            trial = _likelihood(a + scale * move_a, b + scale * move_b, below, above, weight)
            worse = open_ & ~(trial[0] >= now)
            if not worse.any():
                break
            scale = np.where(worse, 0.5 * scale, scale)
        # A row that no step improves is as good as its rounding lets it be
        scale = np.where(worse, 0.0, scale)
        a, b = a + np.where(scale > 0.0, scale * move_a, 0.0), b + np.where(scale > 0.0, scale * move_b, 0.0)
        before = now
        now, score, information = _likelihood(a, b, below, above, weight)
        if np.all(now - before <= 1e-15 * np.abs(now)):
            break
    return a + b * centre, b


def _likelihood(
    a: np.ndarray, b: np.ndarray, low: np.ndarray, high: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Log-likelihood (rows,), its gradient (rows, 2) and negative Hessian (rows, 2, 2) in (a, b).

    low, high: logarithms of the ends, -inf and inf where open. -inf where an interval has no probability left.
    """
    x = [np.where(np.isfinite(end), end, 0.0) for end in (low, high)]
    z = [np.where(np.isfinite(end), b[:, None] * end0 - a[:, None], end) for end, end0 in zip((low, high), x, strict=True)]
    # The lower tail holds its digits: an interval in the upper one is mirrored
    flip = z[0] > 0.0
    log_high = log_ndtr(np.where(flip, -z[0], z[1]))
    log_low = log_ndtr(np.where(flip, -z[1], z[0]))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        log_p = np.where(z[1] > z[0], log_high + np.log(-np.expm1(log_low - log_high)), -np.inf)
        seen = weight > 0.0
        total = np.sum(np.where(seen, weight * log_p, 0.0), axis=1)
        lower, upper = (np.where(np.isfinite(log_p), np.exp(-0.5 * end**2 - 0.5 * np.log(2.0 * np.pi) - log_p), 0.0) for end in z)
        finite = [np.where(np.isfinite(end), end, 0.0) for end in z]
        curved = (-finite[0] * lower + lower**2, -lower * upper, finite[1] * upper + upper**2)
    bend = [np.where(seen, weight * v, 0.0) for v in curved]
    lower, upper = (np.where(seen, weight * v, 0.0) for v in (lower, upper))
    score = np.stack([(lower - upper).sum(axis=1), (x[1] * upper - x[0] * lower).sum(axis=1)], axis=1)
    cross = -(x[0] * bend[0] + (x[0] + x[1]) * bend[1] + x[1] * bend[2]).sum(axis=1)
    information = np.empty((len(a), 2, 2))
    information[:, 0, 0] = (bend[0] + 2.0 * bend[1] + bend[2]).sum(axis=1)
    information[:, 0, 1] = information[:, 1, 0] = cross
    information[:, 1, 1] = (x[0] ** 2 * bend[0] + 2.0 * x[0] * x[1] * bend[1] + x[1] ** 2 * bend[2]).sum(axis=1)
    return total, score, information
