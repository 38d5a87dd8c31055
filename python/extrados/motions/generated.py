"""Generated earthquakes: sine lines with random phases under an envelope (thesis 6.3.1, Eqs 6.6 to 6.8)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from extrados.core import motion as core
from extrados.core.ground import Ground
from extrados.motions.floors import Sway
from extrados.motions.line_spectra import SHIPPED, load_spectrum
from extrados.motions.point_source import worden_pga, worden_pgv

BATCH_VALUES = 4_000_000  # of a streamed batch: 32 MB


@dataclass(frozen=True)
class GeneratedSet:
    """A set of motions by seed: motion k is the same in any batch, on any number of threads, in any run.

    lines (n) [Hz] with the Fourier amplitude `spectrum` [m/s] and the amplitude of the sines [m/s^2];
    window (points): the envelope at 0, step, ... [s]. dispersion: of the logarithm of a further factor on each motion. floor: where
    the structure stands on one, which then moves so.
    """

    mmi: float
    seed: int
    step: float
    lines: np.ndarray
    widths: np.ndarray
    spectrum: np.ndarray
    amplitude: np.ndarray
    window: np.ndarray
    dispersion: float = 0.0
    floor: Sway | None = None

    @property
    def points(self) -> int:
        """Samples of a motion."""
        return len(self.window)

    @property
    def end_time(self) -> float:
        """When a motion is over [s]."""
        return self.step * (self.points - 1)

    def batch(self, first: int, count: int, threads: int = 1) -> np.ndarray:
        """Motions first .. first + count - 1 (count, points) [m/s^2]."""
        made = core.generate(self.lines, self.amplitude, self.window, self.step, self.seed, first, count, threads=threads)
        made = made * self.factors(first, count)[:, None] if self.dispersion > 0.0 else made
        return made if self.floor is None else self.floor.accelerations(made, self.step)

    def factors(self, first: int, count: int) -> np.ndarray:
        """Lognormal factors of median 1 on the strength of motions first .. first + count - 1."""
        seeds = ([self.seed % 2**64, k] for k in range(first, first + count))
        return np.exp(self.dispersion * np.array([np.random.default_rng(s).standard_normal() for s in seeds]))

    def batches(self, count: int, *, first: int = 0, size: int | None = None, threads: int = 1) -> Iterator[tuple[int, np.ndarray]]:
        """(number of its first motion, batch) until `count` motions are out; memory holds one batch."""
        size = size or max(1, min(2000, BATCH_VALUES // self.points))
        for start in range(first, first + count, size):
            yield start, self.batch(start, min(size, first + count - start), threads)

    def motion(self, k: int) -> np.ndarray:
        """Motion k alone (points) [m/s^2]."""
        return self.batch(k, 1)[0]

    def ground(self, k: int) -> Ground:
        """Motion k as the rocking core takes it."""
        return Ground(samples=self.batch(k, 1), step=self.step)

    def expected(self) -> dict[str, float]:
        """Medians that Worden et al. (2012) observed at this intensity, and the Arias intensity of the spectrum.

        pga [m/s^2], pgv [m/s], arias [m/s]: pi / 2g times the energy 2 sum |X|^2 df.
        """
        energy = 2.0 * float(np.sum(self.spectrum**2 * self.widths))
        return {"pga": worden_pga(self.mmi), "pgv": worden_pgv(self.mmi), "arias": np.pi / (2.0 * 9.80665) * energy}


def line_frequencies(lines: int | Sequence[float], spacing: str, band: tuple[float, float]) -> np.ndarray:
    """Frequencies [Hz]: the given ones, or so many over the band, equally spaced or in equal ratios."""
    if isinstance(lines, int):
        if lines < 2:
            raise ValueError(f"the key `lines` is {lines}; expected at least 2 sine lines")
        return np.linspace(*band, lines) if spacing == "uniform" else np.geomspace(*band, lines)
    given = np.array(lines, dtype=float)
    if given.ndim != 1 or len(given) < 2 or np.any(np.diff(given) <= 0.0) or given[0] <= 0.0:
        raise ValueError("the key `lines` must contain at least two increasing frequencies above zero")
    return given


def envelope_parameters(
    kind: str, duration: float, lead: float, rise: float | None, decay: float | None
) -> tuple[float, float, float, float]:
    """The core's parameters of an envelope; defaults: see `generated`."""
    if kind == "arctangent":
        return lead, duration, 0.1 if rise is None else rise, 0.0
    if kind == "trapezoid":
        return lead, duration, 0.15 * duration if rise is None else rise, 0.4 * duration if decay is None else decay
    if kind == "jennings":
        # decay is the time in which the envelope falls to 5 %
        fall = 0.4 * duration if decay is None else decay
        return lead, duration, 0.15 * duration if rise is None else rise, np.log(20.0) / fall
    if kind == "saragoni-hart":
        return lead, duration, 0.2 if rise is None else rise / duration, 0.05
    raise ValueError(f"unknown envelope '{kind}': expected one of {', '.join(core.ENVELOPES)}")


@dataclass(frozen=True)
class Window:
    """Envelope of a motion of duration t_d over time, with lead and tail [s] before and after t_d.

    envelope: 'arctangent' (Eq. 6.7; rise is its width, 0.1 s), 'trapezoid' (Hou 1968; rise 0.15 t_d, decay 0.4 t_d, both within t_d),
    'jennings' (rise within t_d, then decay to 5 % in `decay`), 'saragoni-hart' (rise: time of the peak, 0.2 t_d; 5 % at t_d).
    """

    envelope: str = "arctangent"
    rise: float | None = None
    decay: float | None = None
    lead: float = 0.5
    tail: float = 2.0


def generated(
    mmi: float,
    duration: float,
    *,
    seed: int = 1,
    spectrum: str = SHIPPED,
    lines: int | Sequence[float] = 15,
    spacing: str = "log",
    scaling: str = "energy",
    factor: float = 1.0,
    dispersion: float = 0.0,
    window: Window = Window(),
    step: float = 0.01,
    folder: Path | None = None,
) -> GeneratedSet:
    """The set of motions of intensity `mmi` and duration t_d [s].

    spectrum: 'boore-worden' or a CSV file (of `folder`). lines: how many over the band of the spectrum
    (spacing 'log' or 'uniform'), or the frequencies [Hz]. scaling, of the sine amplitudes: 'thesis' factor |X| df
    (Eq. 6.6 as printed), 'fourier' 2 |X| df, 'energy' 2 |X| sqrt(df / int P^2 dt), which keeps the energy of the
    spectrum. dispersion: standard deviation of the logarithm of a further factor on each motion. window: shape over time.
    """
    if not (duration > 0.0 and step > 0.0 and window.lead >= 0.0 and window.tail >= 0.0):
        raise ValueError("`duration` and `step` must be above zero, `lead` and `tail` 0 or above")
    table = load_spectrum(spectrum, folder)
    frequency = line_frequencies(lines, spacing, table.band)
    if frequency[-1] >= 0.5 / step:
        raise ValueError(f"a spectral line at {frequency[-1]:g} Hz requires a time step below {0.5 / frequency[-1]:g} s")
    points = int(np.ceil((window.lead + duration + window.tail) / step - 1e-9)) + 1
    shape = envelope_parameters(window.envelope, duration, window.lead, window.rise, window.decay)
    envelope = core.envelope(window.envelope, shape, points, step)
    values, widths = table.at(mmi, frequency), core.line_widths(frequency, spacing)
    strong = float(np.sum(envelope**2) * step)
    amplitude = core.line_amplitudes(values, widths, scaling, factor, strong)
    return GeneratedSet(float(mmi), int(seed), float(step), frequency, widths, values, amplitude, envelope, float(dispersion))
