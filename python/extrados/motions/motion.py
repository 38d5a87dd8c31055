"""One ground motion, analytic or sampled."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from extrados.core.ground import Ground
from extrados.motions.directions import rotated

#: An analytic motion is never sampled at more points than this.
MOST_SAMPLES = 1_000_000


@dataclass(frozen=True)
class Motion:
    """A ground motion with its name and origin; `ground` is what the core integrates [m/s^2].

    horizontal: both horizontal components (2, points) as recorded [m/s^2], of a record that has them, and `angle` from the
    first to the plane of the structure [deg]. title, station: of a record, as its file says.
    """

    name: str
    ground: Ground
    notes: list[str] = field(default_factory=list)
    horizontal: np.ndarray | None = None
    angle: float = 0.0
    title: str = ""
    station: str = ""

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.ground.end

    @property
    def across(self) -> Ground | None:
        """What is left of a record with two horizontal components: the part a quarter turn from that in the plane."""
        if self.horizontal is None:
            return None
        return Ground(samples=rotated(self.horizontal[0], self.horizontal[1], self.angle + 90.0)[None], step=self.ground.step)

    def sample(self, time: np.ndarray, channel: int = 0) -> np.ndarray:
        """Acceleration at the given times [m/s^2]; zero outside the motion."""
        return self.ground.sample(np.asarray(time, dtype=float), channel)

    def series(self, step: float | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and horizontal accelerations [m/s^2]; sampled motions keep their own step."""
        g = self.ground
        if g.samples is not None and step is None:
            return g.start + g.step * np.arange(g.samples.shape[1]), g.samples[0].copy()
        if step is None:
            step = max(g.fine_step, self.end / MOST_SAMPLES)
        time = np.arange(0.0, self.end + 0.5 * step, step)
        return time, self.sample(time)

    @cached_property
    def peak(self) -> float:
        """Greatest absolute horizontal acceleration [m/s^2]."""
        return float(np.abs(self.series()[1]).max())
