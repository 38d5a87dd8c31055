"""Blocks in stored results: outlines, also displaced to a pose."""

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from extrados.results.store import Stored
from extrados.show import style


def outlines(run: Stored, name: str, what: str = "outline") -> list[np.ndarray]:
    """Outlines of the blocks of an analysis."""
    vertices, start = run.array(name, what), run.array(name, what + "_start")
    return [vertices[a:b] for a, b in itertools.pairwise(start)]


def moved(outline: np.ndarray, centroid: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """An outline carried to a pose x, y, rotation of its centroid."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return (outline - centroid) @ np.array([[c, s], [-s, c]]) + pose[:2]


class Stones:
    """Stones of an analysis in some axes, which take poses."""

    def __init__(self, run: Stored, name: str, ax: Axes):
        self.outlines, self.centroid = outlines(run, name), run.array(name, "centroid")
        self.drawn = PolyCollection(self.outlines, facecolors=style.STONE, edgecolors=style.EDGE, linewidths=0.7, zorder=2)
        ax.add_collection(PolyCollection(self.outlines, facecolors="none", edgecolors="#cccccc", linewidths=0.5, zorder=1))
        ax.add_collection(self.drawn)

    def place(self, pose: np.ndarray, turn: float = 0.0) -> None:
        """Put the stones into poses (blocks, 3), all of it turned by an angle [rad] about the origin."""
        shapes = [moved(o, c, p) for o, c, p in zip(self.outlines, self.centroid, pose, strict=True)]
        self.drawn.set_verts([turned(s, turn) for s in shapes] if turn else shapes)


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    """Points turned counter-clockwise about the origin [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def window(ax: Axes, points: np.ndarray, room: float = 0.06) -> None:
    """Limits that hold all points, the same in all pictures."""
    points = points[np.isfinite(points).all(axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    more = room * float((high - low).max())
    ax.set_xlim(low[0] - more, high[0] + more)
    ax.set_ylim(low[1] - more, high[1] + more)
    style.section_axes(ax)
