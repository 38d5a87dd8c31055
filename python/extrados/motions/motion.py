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
        return Ground(samples=rotated(*self.horizontal, self.angle + 90.0)[None], step=self.ground.step)

    def sample(self, time: np.ndarray, channel: int = 0) -> np.ndarray:
        """Acceleration at the given times [m/s^2]; zero outside the motion."""
        g = self.ground
        time = np.asarray(time, dtype=float)
        if g.samples is not None:
            axis = g.start + g.step * np.arange(g.samples.shape[1])
            return np.interp(time, axis, g.samples[channel], left=0.0, right=0.0)
        k = np.clip(np.searchsorted(g.breaks, time, side="right") - 1, 0, len(g.breaks) - 2)
        tau = time - g.breaks[k]
        value = g.linear[k, channel, 0] + g.linear[k, channel, 1] * tau
        for i in range(g.terms):
            a, b, w, phi = g.harmonic[k, channel, i].T
            value = value + (a + b * tau) * np.sin(w * tau + phi)
        return np.where((time >= g.breaks[0]) & (time < g.breaks[-1]), value, 0.0)

    def series(self, step: float | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and horizontal accelerations [m/s^2]; sampled motions keep their own step."""
        g = self.ground
        if g.samples is not None and step is None:
            return g.start + g.step * np.arange(g.samples.shape[1]), g.samples[0].copy()
        if step is None:
            fastest = float(np.abs(g.harmonic[..., 2]).max(initial=0.0)) if g.terms else 0.0
            step = min(0.01, float(np.diff(g.breaks).min()) / 50, np.pi / 32 / max(fastest, 1e-9))
            step = max(step, self.end / MOST_SAMPLES)
        time = np.arange(0.0, self.end + 0.5 * step, step)
        return time, self.sample(time)

    @cached_property
    def peak(self) -> float:
        """Greatest absolute horizontal acceleration [m/s^2]."""
        return float(np.abs(self.series()[1]).max())
