"""rocking-spectrum: greatest rotation of blocks under a motion over 2 pi/p and alpha (Makris and Konstantinidis 2003)."""

import numpy as np

from extrados.analyses.batches import sweep
from extrados.analyses.run import Context
from extrados.analyses.runs import runs_job
from extrados.core.rocking import Body, block_body
from extrados.decks.statistics import RockingSpectrum
from extrados.motions.motion import GRAVITY
from extrados.results.model import Array, Result, TableData


def block_of(period: float, alpha: float, restitution: str | float, linear: bool) -> Body:
    """The rectangle of frequency parameter p = 2 pi/period [rad/s] and slenderness alpha [rad]; its mass does not matter."""
    p = 2.0 * np.pi / period
    radius = 0.75 * GRAVITY / p**2
    c_v = max(0.0, 1.0 - 1.5 * np.sin(alpha) ** 2) if isinstance(restitution, str) else float(restitution)
    half, height = radius * np.sin(alpha), radius * np.cos(alpha)
    return block_body(1.0, radius**2 / 3.0, height, half, half, (c_v, c_v), linear)


def run(context: Context, options: RockingSpectrum) -> Result:
    """Rotation spectra; an overturned block has none, its place is marked."""
    motion = context.motion
    context.warnings += motion.notes
    periods = np.array(options.periods) if options.periods else np.linspace(0.2, 8.0, 60)
    alphas = np.radians(options.slenderness)
    bodies = [block_of(t, a, options.restitution, options.form == "linear") for a in alphas for t in periods]
    n = len(bodies)
    settle = np.tile(periods, len(alphas)) * 6.0
    job = runs_job(bodies, [motion.ground], np.arange(n), 0, 1.0, motion.end + settle)
    swept = sweep(context, "rocking-spectrum", job, n, "rocking spectrum")
    result = Result("rocking-spectrum")
    if not swept.complete:
        result.status, result.reason = ("interrupted" if swept.interrupted else "failed"), swept.stopped
        return result
    shape = (len(alphas), len(periods))
    overturned = swept["outcome"].reshape(shape) == 2
    ratio = np.where(overturned, np.nan, swept["peak_ratio"].reshape(shape))
    rotation = np.where(overturned, np.nan, np.abs(swept["peak"].reshape(shape)))
    longest = [float(periods[row].max()) if row.any() else None for row in overturned]
    result.results = {
        "slenderness_deg": list(options.slenderness),
        "overturned": overturned.sum(axis=1),
        "longest_overturning_period_s": longest,
        "peak_ground_acceleration_g": motion.peak / GRAVITY,
    }
    result.tables["rocking_spectrum"] = TableData(
        {
            "slenderness": np.repeat(options.slenderness, len(periods)), "period": np.tile(periods, len(alphas)),
            "peak_rotation": rotation.ravel(), "peak_ratio": ratio.ravel(), "overturned": overturned.ravel().astype(int),
        },
        {"slenderness": "deg", "period": "s", "peak_rotation": "rad"},
    )  # fmt: skip
    result.arrays = {
        "slenderness": Array(np.array(options.slenderness), ("slenderness",), "deg", "alpha"),
        "period": Array(periods, ("period",), "s", "2 pi/p"),
        "peak_ratio": Array(ratio, ("slenderness", "period"), "", "greatest rotation over alpha; NaN where overturned"),
        "overturned": Array(overturned.astype(np.int8), ("slenderness", "period")),
    }
    words = []
    for a, row, last in zip(options.slenderness, overturned, longest, strict=True):
        size = (
            ""
            if last is None
            else f", up to 2 pi/p = {last:.3g} s (half-diagonal {0.75 * GRAVITY * (last / 2 / np.pi) ** 2:.3g} m)"
        )
        words.append(f"alpha {a:g} deg: {int(row.sum())} of {len(periods)} overturn{size}")
    result.answer = f"Peak ground acceleration {motion.peak / GRAVITY:.3f} g. " + "; ".join(words) + "."
    return result
