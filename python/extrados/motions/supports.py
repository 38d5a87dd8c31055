"""A ground motion with supports that move during it, all alike: what moves with them feels one more acceleration."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from extrados.core.ground import Ground
from extrados.motions.motion import Motion


@dataclass(frozen=True)
class Shift:
    """All supports move by dx, dy [m] from `start` on within `duration` [s], the rate dx/T (1 - cos(2 pi t/T)), as in
    discrete elements."""

    dx: float
    dy: float
    start: float
    duration: float

    @property
    def acceleration(self) -> tuple[float, float, float]:
        """Amplitudes to +x and up of the sine that the acceleration is [m/s^2], and its circular frequency [rad/s]."""
        w = 2.0 * np.pi / self.duration
        return self.dx * w / self.duration, self.dy * w / self.duration, w


def with_shifts(motion: Motion | None, shifts: Sequence[Shift]) -> Motion:
    """The motion, or rest, with what supports that move add to it; on the straight lines and sines of both."""
    ground = motion.ground if motion is not None else Ground(samples=np.zeros((1, 2)), step=min(s.duration for s in shifts))
    if ground.samples is not None:
        given = ground.start + ground.step * np.arange(ground.samples.shape[1])
    else:
        given = np.asarray(ground.breaks)
    ends = [t for s in shifts for t in (s.start, s.start + s.duration)]
    breaks = np.unique(np.concatenate([given, ends]))
    # breaks that rounding sets apart are one
    breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-12 * breaks[-1]])]
    n, terms = len(breaks) - 1, ground.terms
    linear, harmonic = np.zeros((n, 2, 2)), np.zeros((n, 2, terms + len(shifts), 4))
    channels = ground.channels
    for k, (begin, end) in enumerate(itertools.pairwise(breaks)):
        middle = 0.5 * (begin + end)
        if given[0] <= middle < given[-1]:
            j = int(np.searchsorted(given, middle, side="right")) - 1
            late = begin - given[j]
            if ground.samples is not None:
                slope = (ground.samples[:, j + 1] - ground.samples[:, j]) / ground.step
                linear[k, :channels] = np.column_stack([ground.samples[:, j] + slope * late, slope])
            else:
                assert ground.linear is not None
                linear[k, :channels] = ground.linear[j]
                linear[k, :channels, 0] += ground.linear[j, :, 1] * late
                if terms:
                    assert ground.harmonic is not None
                    a, b, w, phase = np.moveaxis(ground.harmonic[j], -1, 0)
                    harmonic[k, :channels, :terms] = np.stack([a + b * late, b, w, phase + w * late], axis=-1)
        for i, s in enumerate(shifts):
            if s.start <= middle < s.start + s.duration:
                right, up, w = s.acceleration
                for channel, size in enumerate((right, up)):
                    harmonic[k, channel, terms + i] = size, 0.0, w, w * (begin - s.start)
    made = Ground(breaks=breaks, linear=linear, harmonic=harmonic)
    if motion is None:
        return Motion("supports that move", made)
    return replace(motion, ground=made, notes=list(motion.notes))
