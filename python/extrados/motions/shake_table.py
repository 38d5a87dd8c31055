"""What a shake table can play (thesis Appendix C) and what drives it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from extrados.core import motion as core
from extrados.motions import processing


@dataclass(frozen=True)
class Table:
    """Limits of a table: stroke each way [m], velocity [m/s], force [N]."""

    stroke: float
    velocity: float
    force: float

    def amplitudes(self, frequency: np.ndarray, mass: float) -> dict[str, np.ndarray]:
        """Greatest displacement amplitude [m] of harmonic motion by each limit, at frequencies [Hz], for a mass [kg]."""
        w = 2.0 * np.pi * np.asarray(frequency, dtype=float)
        return {"stroke": np.full_like(w, self.stroke), "flow": self.velocity / w, "force": self.force / (mass * w**2)}

    def corner_frequencies(self, mass: float) -> dict[str, float]:
        """Where one limit takes over from another [Hz]."""
        return {
            "stroke_to_flow": self.velocity / self.stroke / (2.0 * np.pi),
            "flow_to_force": self.force / (mass * self.velocity) / (2.0 * np.pi),
        }


@dataclass(frozen=True)
class Drive:
    """A motion as the table plays it, at rest before and after, without drift.

    time [s] from the motion's start (negative while the table leads in), displacement [m], velocity [m/s],
    acceleration [m/s^2].
    """

    step: float
    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    def squeezed(self, time_scale: float, amplitude: float) -> "Drive":
        """The same motion with time and acceleration multiplied: displacement goes with the square of time."""
        return Drive(
            self.step * time_scale,
            self.time * time_scale,
            self.displacement * time_scale**2 * amplitude,
            self.velocity * time_scale * amplitude,
            self.acceleration * amplitude,
        )


def make_drive(acceleration: np.ndarray, step: float, low_cut: float) -> Drive:
    """Drift-free drive of an acceleration (points) [m/s^2].

    A zero-phase high-pass takes out what no table of finite stroke can follow; the integration is then exact in the
    frequency domain, and the table is at rest at both ends of the padded motion.
    """
    if not 0.0 < low_cut < 0.5 / step:
        raise ValueError(f"`low_cut` is {low_cut:g} Hz, expected above 0 and below {0.5 / step:g} Hz")
    pad = int(np.ceil(5.0 / low_cut / step))  # the filter has died out by then
    long = np.pad(acceleration, pad)
    filtered = processing.band_pass(long, step, low_cut, None)
    points = len(long)
    length = 1 << int(np.ceil(np.log2(2 * points)))
    transform = core.fourier(filtered, length)
    w = 2.0 * np.pi * np.arange(length // 2 + 1) / (length * step)
    w[0], transform[0] = 1.0, 0.0  # the filter has taken the mean
    velocity = core.fourier_inverse(transform / (1j * w), length)[:points]
    displacement = core.fourier_inverse(-transform / w**2, length)[:points]
    # the integrals are known up to a constant each: the table rests at the start
    rest = slice(0, max(2, pad // 50))
    velocity -= velocity[rest].mean()
    displacement -= displacement[rest].mean()
    time = (np.arange(points) - pad) * step
    return Drive(step, time, displacement, velocity, filtered)


@dataclass(frozen=True)
class Fit:
    """How much of each limit a drive needs (1 is all of it), and the scales that bring it within."""

    stroke: float
    flow: float
    force: float
    time_scale: float
    amplitude: float

    @property
    def fits(self) -> bool:
        """Whether the table can play it."""
        return max(self.stroke, self.flow, self.force) <= 1.0 + 1e-9

    @property
    def governing(self) -> Literal["stroke", "flow", "force"]:
        """The limit that is nearest or exceeded most."""
        limits: tuple[Literal["stroke", "flow", "force"], ...] = ("stroke", "flow", "force")
        return max(limits, key=lambda name: float(getattr(self, name)))


def fit(table: Table, drive: Drive, mass: float, keep: str = "amplitude") -> Fit:
    """Scales for a mass [kg]; keep 'amplitude' squeezes time, 'time' scales the motion down.

    Squeezing time does not lower the force: where that is too large, the amplitude is scaled in either case.
    """
    stroke = float(np.abs(drive.displacement).max()) / table.stroke
    flow = float(np.abs(drive.velocity).max()) / table.velocity
    force = float(np.abs(drive.acceleration).max()) * mass / table.force
    if keep == "time":
        return Fit(stroke, flow, force, 1.0, 1.0 / max(1.0, stroke, flow, force))
    amplitude = 1.0 / max(1.0, force)
    return Fit(
        stroke, flow, force, min(1.0, 1.0 / np.sqrt(max(stroke * amplitude, 1e-300)), 1.0 / max(flow * amplitude, 1e-300)), amplitude
    )
