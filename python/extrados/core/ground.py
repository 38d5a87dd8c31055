"""Ground motions as the core takes them: sampled, or piecewise analytic (fortran/common/signal.f90)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from extrados import _core
from extrados.core.calls import real
from extrados.core.errors import check
from extrados.core.handles import Owner


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
        return float(_given("breaks", self.breaks)[-1])

    def seen_from(self, time: float) -> "Ground":
        """The same motion by a clock that starts at a time [s]."""
        breaks = None if self.breaks is None else self.breaks - time
        return replace(self, start=self.start - time, breaks=breaks)

    @property
    def channels(self) -> int:
        """1, or 2 with a vertical one."""
        return int(self.samples.shape[0] if self.samples is not None else _given("linear", self.linear).shape[1])

    def sample(self, time: np.ndarray, channel: int = 0) -> np.ndarray:
        """Acceleration (n) [m/s^2] of a channel at the times `time` (n) [s]; zero outside the motion."""
        if self.samples is not None:
            axis = self.start + self.step * np.arange(self.samples.shape[1])
            return np.interp(time, axis, self.samples[channel], left=0.0, right=0.0)
        breaks, linear = _given("breaks", self.breaks), _given("linear", self.linear)
        k = np.clip(np.searchsorted(breaks, time, side="right") - 1, 0, len(breaks) - 2)
        tau = time - breaks[k]
        value = linear[k, channel, 0] + linear[k, channel, 1] * tau
        for i in range(self.terms):
            a, b, w, phi = _given("harmonic", self.harmonic)[k, channel, i].T
            value = value + (a + b * tau) * np.sin(w * tau + phi)
        return np.where((time >= breaks[0]) & (time < breaks[-1]), value, 0.0)

    @property
    def fine_step(self) -> float:
        """A step [s] that follows the segments and the fastest sine; that of the samples where there are any."""
        if self.samples is not None:
            return self.step
        fastest = float(np.abs(_given("harmonic", self.harmonic)[..., 2]).max(initial=0.0)) if self.terms else 0.0
        return min(0.01, float(np.diff(_given("breaks", self.breaks)).min()) / 50, np.pi / 32 / max(fastest, 1e-9))

    @property
    def terms(self) -> int:
        """Sines on each segment."""
        return int(self.harmonic.shape[2]) if self.harmonic is not None else 0


def _given(name: str, value: np.ndarray | None) -> np.ndarray:
    if value is None:
        raise ValueError(f"a ground motion requires samples or {name}")
    return value


class MotionSet(Owner):
    """Ground motions in the core, to be used by any number of calls and threads.

    ValueError where a motion is malformed, with its number (from 0) where there are several.
    """

    what = "set of ground motions"

    def __init__(self, grounds: Sequence[Ground]):
        if not grounds:
            raise ValueError("a set of ground motions must contain at least one motion")
        handle, status = _core.api_signal.create(len(grounds))
        check(status, self.what)
        super().__init__(handle)
        self.count = len(grounds)
        try:
            for k, ground in enumerate(grounds):
                self._put(k + 1, ground)
        except BaseException:
            self.close()
            raise

    def __len__(self) -> int:
        return self.count

    def _put(self, number: int, ground: Ground) -> None:
        if ground.samples is not None:
            rows = real("samples", ground.samples, (None, None))
            _check_channels(rows.shape[0])
            if rows.shape[1] < 2 or not ground.step > 0.0:
                raise ValueError("a sampled motion requires at least two samples and a time step above zero")
            status = _core.api_signal.samples(self.handle, number, float(ground.start), float(ground.step), rows)
        else:
            edges = real("breaks", _given("breaks", ground.breaks), (None,))
            count = len(edges) - 1
            if count < 1 or not (edges[1:] > edges[:-1]).all():
                raise ValueError("the break times of a motion must increase")
            lines = real("linear", np.transpose(_given("linear", ground.linear)), (2, None, count))
            _check_channels(lines.shape[1])
            if ground.terms:
                curve = np.transpose(_given("harmonic", ground.harmonic))
                sines = real("harmonic", curve, (4, ground.terms, lines.shape[1], count))
            else:
                sines = np.zeros((4, 0, lines.shape[1], count), order="F")
            status = _core.api_signal.pieces(self.handle, number, edges, lines, sines)
        check(status, f"ground motion {number - 1}")


def _check_channels(channels: int) -> None:
    if channels not in (1, 2):
        raise ValueError(f"a ground motion has {channels} channels, expected 1 (horizontal) or 2 (with vertical)")


def as_motion_set(grounds: "Sequence[Ground] | MotionSet") -> MotionSet:
    """`grounds` itself where it is a set already, else a new one that is given back when forgotten."""
    return grounds if isinstance(grounds, MotionSet) else MotionSet(grounds)
