"""Size an intervention: the existing building as the reference, the interval in which a size meets the target, and the cost."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.strengthen.measures import Measure, Worth, reached
from extrados.analyses.strengthen.tables import Strengthen
from extrados.model.ties import Tie
from extrados.results import strengthen as out

#: Halvings of the interval in which a size meets the target, of cheap analyses and of others
HALVINGS, HALVINGS_OF_RUNS = 16, 5
#: Analyses that take milliseconds
CHEAP = ("tilt", "local-mechanism", "code-checks")


@dataclass
class Sized:
    """An alternative with its size: results, curve (sizes, values), and the deck with it."""

    row: out.Intervention
    curve: tuple[list[float], list[float]] = ((), ())  # type: ignore[assignment]
    places: tuple[list[float], list[float], list[float]] | None = None  # x, y of the middle, force
    data: dict[str, Any] | None = None
    worth: Worth | None = None
    tie: Tie | None = None
    costs: list[float] = field(default_factory=list)


class Sizing:
    """Sizes alternatives against the existing building."""

    def __init__(self, context: Context, options: Strengthen, measure: Measure, before: Worth):
        self.context, self.options, self.measure, self.before = context, options, measure, before

    @property
    def halvings(self) -> int:
        """Halvings by the cost of one value."""
        return HALVINGS if self.options.by in CHEAP else HALVINGS_OF_RUNS

    def bracket(
        self, at: Callable[[float], Worth], start: float, stop: float, count: int, whole: bool
    ) -> tuple[float | None, Worth, tuple[list[float], list[float]]]:
        """The size nearest to `start` that meets the target: values on a grid, then the first interval halved. The size, what it
        is worth (of the last one where none suffices), and all sizes tried with their values."""
        sizes = np.linspace(start, stop, count)
        if whole:
            sizes = np.unique(np.round(sizes))
            sizes = sizes if stop > start else sizes[::-1]
        tried = {float(size): at(float(size)) for size in sizes}
        grid = list(tried)

        def curve() -> tuple[list[float], list[float]]:
            found = sorted(tried)
            return found, [np.nan if (v := tried[size].value) is None else v for size in found]

        first = next((k for k, size in enumerate(grid) if reached(self.measure, tried[size])), None)
        if first is None:
            return None, tried[grid[-1]], curve()
        near, far = grid[max(first - 1, 0)], grid[first]
        for _ in range(self.halvings):
            if first == 0 or (whole and abs(far - near) <= 1.0):
                break
            middle = 0.5 * (near + far)
            middle = float(round(middle)) if whole else middle
            tried[middle] = at(middle)
            near, far = (near, middle) if reached(self.measure, tried[middle]) else (middle, far)
        return far, tried[far], curve()

    def cost(self, length: float, force: float, volume: float) -> float:
        w = self.options.weights
        return w.per_metre * length + w.per_kilonewton * force / 1e3 + w.per_cubic_metre * max(volume, 0.0)
