"""Draw cases/bridge/surveyed.dxf: the elevation of an arch bridge as a survey delivers it.

One span of 9.6 m with a rise of 2.9 m. The arch has settled: its crown lies 25 mm low and 10 mm to the right. Each of 31
voussoirs is measured for itself with 1 mm of noise; backing lies over both haunches on a layer of its own; lines of the
layer GROUND are the skewbacks and the ground behind the backing. Needs ezdxf.
"""

import itertools
import sys
from pathlib import Path

import ezdxf
import numpy as np

SPAN, RISE, THICKNESS, COUNT = 9.6, 2.9, 0.6, 31
BACKING = 1.3  # m above the springings
NOISE = 0.001  # m
SEED = 5


def settled(points: np.ndarray) -> np.ndarray:
    """Points of the designed arch as they lie today [m]: the crown moves down and to the right, the springings do not."""
    share = np.cos(np.pi * np.clip(points[:, :1] / SPAN, -0.5, 0.5)) ** 2
    return points + share * np.array([0.010, -0.025])


def ring(radius: float, centre: float, angles: np.ndarray) -> np.ndarray:
    """Points of a circle at angles [rad] from the vertical, as they lie today [m]."""
    return settled(np.column_stack([radius * np.sin(angles), centre + radius * np.cos(angles)]))


def haunch(outer: float, centre: float, low: float, side: int) -> np.ndarray:
    """Outline of the backing over one haunch, side -1 or 1 [m]."""
    high = np.arccos((BACKING - centre) / outer)
    along = ring(outer, centre, side * np.linspace(low, high, 25))
    along[-1, 1] = BACKING
    back = along[0, 0]
    return np.vstack([along, [[back, BACKING]]])


def main(path: Path) -> None:
    """Write the drawing [m]."""
    rng = np.random.default_rng(SEED)
    inner = (0.25 * SPAN**2 + RISE**2) / (2.0 * RISE)
    centre, outer = RISE - inner, inner + THICKNESS
    low = np.arcsin(0.5 * SPAN / inner)
    widths = 1.0 + 0.15 * rng.uniform(-1.0, 1.0, COUNT)
    angles = low * (2.0 * np.concatenate([[0.0], np.cumsum(widths) / widths.sum()]) - 1.0)
    document = ezdxf.new(units=6)
    space = document.modelspace()
    for a, b in itertools.pairwise(angles):
        between = np.linspace(a, b, 5)
        outline = np.vstack([ring(inner, centre, between), ring(outer, centre, between[::-1])])
        outline += NOISE * rng.uniform(-1.0, 1.0, outline.shape)
        space.add_lwpolyline(outline, close=True, dxfattribs={"layer": "ARCH"})
    for side in (-1, 1):
        outline = haunch(outer, centre, low, side)
        space.add_lwpolyline(outline, close=True, dxfattribs={"layer": "BACKING"})
        foot, head = ring(inner, centre, np.array([side * low]))[0], outline[0]
        space.add_line(foot, head, dxfattribs={"layer": "GROUND"})
        space.add_line(head, outline[-1], dxfattribs={"layer": "GROUND"})
    document.saveas(path)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "cases/bridge/surveyed.dxf"))
