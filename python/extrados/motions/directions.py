"""Two horizontal components seen from one direction, or from all of them (RotD50, RotD100: Boore 2010)."""

import numpy as np

from extrados.core import motion as core

ANGLES = np.arange(180.0)  # deg; the other half turn gives the same peaks
_BATCH = 2_000_000  # values of rotated motion held at once


def rotated(first: np.ndarray, second: np.ndarray, angle: float) -> np.ndarray:
    """first cos(angle) + second sin(angle), angle in degrees; exact at every quarter turn."""
    quarters, rest = divmod(angle, 90.0)
    for _ in range(int(quarters % 4.0)):
        first, second = second, -first
    return first * np.cos(np.radians(rest)) + second * np.sin(np.radians(rest))


def peaks(horizontal: np.ndarray) -> np.ndarray:
    """RotD50 and RotD100 of the peak of two components (2, points): median and greatest over all directions."""
    return np.percentile([np.abs(rotated(horizontal[0], horizontal[1], angle)).max() for angle in ANGLES], (50, 100))


def spectra(horizontal: np.ndarray, step: float, periods: np.ndarray, damping: float, threads: int = 1) -> np.ndarray:
    """PSA (2, periods) [m/s^2] of RotD50 and RotD100, of components (2, points) [m/s^2] at `step` [s]."""
    parts = np.array_split(ANGLES, max(1, -(-len(ANGLES) * horizontal.shape[1] // _BATCH)))
    psa = [
        core.response_spectra(
            np.stack([rotated(horizontal[0], horizontal[1], angle) for angle in part]), step, periods, [damping], threads=threads
        ).psa[:, 0]
        for part in parts
        if len(part)
    ]
    return np.percentile(np.concatenate(psa), (50, 100), axis=0)
