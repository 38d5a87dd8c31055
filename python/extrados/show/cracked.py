"""Walls of finite elements as they are drawn: corners of elements, enlarged displacements, colours of cracks."""

import numpy as np
from matplotlib.colors import LinearSegmentedColormap

from extrados.results.store import Stored

#: Of crack widths: its lightest colour stands out from white
CRACKS = LinearSegmentedColormap.from_list("cracks", ["#f4a261", "#d1495b", "#7b2d8b", "#10002b"])
CORNERS = {3: 3, 6: 3, 4: 4, 8: 4}


def polygons(run: Stored, name: str, xy: np.ndarray) -> list[np.ndarray]:
    """Corners of all elements, at nodes (nodes, 2)."""
    return [p for a in run.series(name, "elements") for p in xy[a.data[:, : CORNERS[a.data.shape[1]]]]]


def scale(span: np.ndarray, moved: np.ndarray, part: float = 0.06) -> float:
    """A round factor that makes the largest displacement a small part of the wall."""
    most = np.hypot(*moved.T).max()
    if not most > 0.0:
        return 1.0
    exact = part * span.max() / most
    power = 10.0 ** np.floor(np.log10(exact))
    return float(max(s for s in (1.0, 2.0, 5.0) if s * power <= exact or s == 1.0) * power)


def at_points(run: Stored, name: str, moved: np.ndarray) -> np.ndarray:
    """Displacements carried from the nodes to the points: the mean of their element's corners."""
    blocks = [a.data for a in run.series(name, "elements")]
    per_element = np.concatenate([moved[c[:, : CORNERS[c.shape[1]]]].mean(axis=1) for c in blocks])
    return per_element[run.array(name, "point_element")]
