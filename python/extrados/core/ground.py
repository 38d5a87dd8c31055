"""Ground motions as the core takes them: sampled, or piecewise analytic (fortran/common/signal.f90)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.core.calls import integers, real


@dataclass(frozen=True)
class Ground:
    """A ground motion as the core knows it, accelerations in m/s^2.

    Either `samples` (channels, points) at `step` from `start`, joined by straight lines; or, on each
    interval between `breaks`, `linear` (value and slope at its start: segments, channels, 2) plus
    `harmonic` ((a + b tau) sin(w tau + phi): segments, channels, terms, 4).
    Channels: 1 horizontal, or horizontal and vertical.
    """

    samples: np.ndarray | None = None
    step: float = 0.0
    start: float = 0.0
    breaks: np.ndarray | None = None
    linear: np.ndarray | None = None
    harmonic: np.ndarray | None = None

    @property
    def end(self) -> float:
        """When the motion is over [s]."""
        if self.samples is not None:
            return self.start + self.step * (self.samples.shape[1] - 1)
        return float(self.breaks[-1])

    @property
    def channels(self) -> int:
        return self.samples.shape[0] if self.samples is not None else self.linear.shape[1]

    @property
    def terms(self) -> int:
        return self.harmonic.shape[2] if self.harmonic is not None else 0


@dataclass(frozen=True)
class MotionSet:
    """Motions stored one behind the other, as the core reads them (fortran/rocking/ensemble.f90)."""

    sampled: np.ndarray
    first: np.ndarray
    segments: np.ndarray
    start: np.ndarray
    step: np.ndarray
    samples: np.ndarray
    breaks: np.ndarray
    linear: np.ndarray
    harmonic: np.ndarray


def motion_set(grounds: Sequence[Ground]) -> MotionSet:
    """Motions packed into flat arrays; ValueError where one is malformed."""
    channels = max(g.channels for g in grounds)
    terms = max(g.terms for g in grounds)
    samples, breaks, linear, harmonic = [], [], [], []
    sampled, first, segments = [], [], []
    n_sample = n_break = 0
    for ground in grounds:
        if ground.samples is not None:
            points = ground.samples.shape[1]
            if points < 2 or not ground.step > 0.0:
                raise ValueError("a sampled motion needs two samples and a step above zero")
            samples.append(ground.samples)
            sampled.append(1)
            first.append(n_sample + 1)
            segments.append(points - 1)
            n_sample += points
        else:
            edges = real("breaks", ground.breaks, (None,))
            count = len(edges) - 1
            if count < 1 or np.any(np.diff(edges) <= 0.0):
                raise ValueError("breaks of a motion must ascend")
            lines = np.zeros((count + 1, channels, 2))
            lines[:count, : ground.channels] = real("linear", ground.linear, (count, ground.channels, 2))
            sines = np.zeros((count + 1, channels, terms, 4))
            if ground.terms:
                sines[:count, : ground.channels, : ground.terms] = real(
                    "harmonic", ground.harmonic, (count, ground.channels, ground.terms, 4)
                )
            breaks.append(edges)
            linear.append(lines)
            harmonic.append(sines)
            sampled.append(0)
            first.append(n_break + 1)
            segments.append(count)
            n_break += count + 1

    # One array and one check for all: ensembles bring thousands of motions.
    rows = np.zeros((max(n_sample, 1), channels))
    start = 0
    for block in samples:
        rows[start : start + block.shape[1], : len(block)] = block.T
        start += block.shape[1]
    rows = real("samples", rows.T, (channels, None))

    def stack(parts: list, empty: tuple[int, ...]) -> np.ndarray:
        return np.concatenate(parts) if parts else np.zeros(empty)

    return MotionSet(
        integers("sampled", sampled),
        integers("first", first),
        integers("segments", segments),
        np.array([g.start for g in grounds], dtype=float),
        np.array([g.step for g in grounds], dtype=float),
        rows,
        stack(breaks, (1,)),
        stack(linear, (1, channels, 2)).T,
        stack(harmonic, (1, channels, terms, 4)).T,
    )
