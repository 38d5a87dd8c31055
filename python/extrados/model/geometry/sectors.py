"""Ring sectors: their area, centroid, inertia and outlines."""

import numpy as np

SHARES = np.linspace(0.0, 1.0, 7)  # of the angle of a sector, where its outline has vertices


def ring_sector(inner: float, outer: float, angle: float) -> tuple[float, float, float]:
    """Area, distance of the centroid from the centre, and polar moment of area about the centroid.

    inner, outer radius [m], angle [rad].
    """
    area = 0.5 * angle * (outer**2 - inner**2)
    centre = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2) * np.sin(0.5 * angle) / (0.5 * angle)
    polar = 0.25 * angle * (outer**4 - inner**4) - area * centre**2
    return area, centre, polar


def directions(angle: np.ndarray) -> np.ndarray:
    """Unit vectors (n, 2) at angles [rad] from the x axis."""
    found = np.empty((len(angle), 2))
    np.cos(angle, out=found[:, 0])
    np.sin(angle, out=found[:, 1])
    return found


def sector_outlines(centre: np.ndarray, inner: float, outer: float, angle: np.ndarray) -> np.ndarray:
    """Counter-clockwise outlines (n, 14, 2) of ring sectors between the joint angles, which fall from left to right."""
    first, step = angle[:-1, None], np.diff(angle)[:, None]
    along = first + step * SHARES
    up = np.stack([np.cos(along), np.sin(along)], axis=-1)
    return np.concatenate([centre + inner * up, centre + outer * up[:, ::-1]], axis=1)
