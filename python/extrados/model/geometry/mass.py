"""Mass properties of bodies put together from parts."""

import numpy as np


def together(
    mass: np.ndarray, centroid: np.ndarray, inertia: np.ndarray, owner: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass (count) [kg], centroid (count, 2) [m] and inertia about it (count) [kg m^2] of bodies whose parts have
    `mass` (n), `centroid` (n, 2) and `inertia` (n); part i belongs to body owner[i] (Steiner's theorem)."""
    total = np.bincount(owner, mass, count)
    middle = np.stack([np.bincount(owner, mass * x, count) for x in centroid.T], axis=1) / total[:, None]
    arm = ((centroid - middle[owner]) ** 2).sum(axis=1)
    return total, middle, np.bincount(owner, inertia + mass * arm, count)
