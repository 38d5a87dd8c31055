"""The motions of a set, and what its statistics take of each of them, as jobs of the batch layer."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from extrados.analyses.batches import stacked
from extrados.analyses.context import Refused
from extrados.core import motion as core
from extrados.core.calls import stop_if_asked
from extrados.motions import directions
from extrados.motions import tables as models
from extrados.motions.from_deck import compatible_motion, generated_motion, numbered
from extrados.motions.generated import GeneratedSet
from extrados.motions.impulse import primary_impulses
from extrados.motions.measures import fourier_spectrum
from extrados.motions.motion import Motion
from extrados.schema.constants import GRAVITY

MOST_POINTS = 2_000_000


def series(motion: Motion) -> tuple[np.ndarray, float]:
    """Horizontal acceleration from time zero of the file [m/s^2], and its step [s]; Refused where it is too long."""
    time, acceleration = motion.series()
    if len(time) > MOST_POINTS:
        raise Refused(f"{motion.name} has {len(time)} samples, and at most {MOST_POINTS} can be analysed", ("motion",))
    return acceleration, float(time[1] - time[0])


def rotd_peaks(motion: Motion) -> dict[str, float]:
    """PGA over all directions [g]; NaN where only one component is known."""
    peaks = np.full(2, np.nan) if motion.horizontal is None else directions.peaks(motion.horizontal) / GRAVITY
    return {"rotd50_pga_g": float(peaks[0]), "rotd100_pga_g": float(peaks[1])}


class Members(Protocol):
    """The motions of a set by their numbers, from 0."""

    def motions(self, first: int, count: int, threads: int) -> Iterator[Motion]:
        """Motions first .. first + count - 1, in order."""

    def name(self, k: int) -> str:
        """What motion k is called."""


@dataclass(frozen=True)
class Held:
    """Motions that were read or made before."""

    held: list[Motion]

    def motions(self, first: int, count: int, threads: int) -> Iterator[Motion]:
        return islice(self.held, first, first + count)

    def name(self, k: int) -> str:
        return self.held[k].name


@dataclass(frozen=True)
class Generated:
    """Generated motions, made where they are needed."""

    made: GeneratedSet

    def motions(self, first: int, count: int, threads: int) -> Iterator[Motion]:
        for start, batch in self.made.batches(count, first=first, threads=threads):
            for k, row in enumerate(batch, start=start):
                yield generated_motion(self.made, k, row)

    def name(self, k: int) -> str:
        return numbered("generated", k)


@dataclass(frozen=True)
class Matched:
    """Member k is motion k of a compatible set: its matching takes seconds."""

    model: models.Compatible
    folder: Path

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        def member(k: int) -> dict[str, np.ndarray]:
            stop_if_asked()
            samples = compatible_motion(self.model, self.folder, k).ground.samples
            assert samples is not None  # of a compatible motion
            return {"acceleration": samples[0]}

        return stacked(member, first, count)


@dataclass(frozen=True)
class Measures:
    """Member k gives peaks and measures of motion k; with `components`, peaks of the directions a record has, else NaN."""

    members: Members
    components: bool

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return _columns(self._row(motion) for motion in self.members.motions(first, count, threads))

    def _row(self, motion: Motion) -> dict[str, float]:
        stop_if_asked()
        m = core.measures(*series(motion))
        row = {
            "pga_g": m.pga[0] / GRAVITY,
            "pgv_m_s": m.pgv[0],
            "pgd_m": m.pgd[0],
            "arias_m_s": m.arias[0],
            "cav_m_s": m.cav[0],
            "duration_5_95_s": m.duration[0],
        }
        if self.components:
            samples = motion.ground.samples
            assert samples is not None  # of a record
            row["vertical_pga_g"] = np.abs(samples[1]).max() / GRAVITY if len(samples) > 1 else np.nan
            row |= rotd_peaks(motion)
        return row


@dataclass(frozen=True)
class Spectra:
    """Member k gives psa (period) [m/s^2] of motion k; with `fourier`, also |X| (frequency) [m/s]."""

    members: Members
    periods: np.ndarray
    damping: float
    fourier: bool

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return _columns(self._row(motion, threads) for motion in self.members.motions(first, count, threads))

    def _row(self, motion: Motion, threads: int) -> dict[str, np.ndarray]:
        stop_if_asked()
        a, step = series(motion)
        row = {"psa": core.response_spectra(a, step, self.periods, [self.damping], threads=threads).psa[0]}
        if self.fourier:
            row["fourier"] = fourier_spectrum(a, step)[1]
        return row


@dataclass(frozen=True)
class PrimaryImpulses:
    """Member k gives amplitude [g] and period [s] of the primary impulse of motion k, NaN where there is none."""

    members: Members
    max_period: float

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return _columns(self._row(motion) for motion in self.members.motions(first, count, threads))

    def _row(self, motion: Motion) -> dict[str, float]:
        stop_if_asked()
        a, step = series(motion)
        found = primary_impulses(step * np.arange(len(a)), a, 1, None, self.max_period)
        if not found:
            return {"amplitude_g": np.nan, "period_s": np.nan}
        return {"amplitude_g": abs(found[0].amplitude) / GRAVITY, "period_s": found[0].period}


def _columns(rows: Iterable[dict[str, Any]]) -> dict[str, np.ndarray]:
    """Rows of equal keys as one array for each key."""
    found = list(rows)
    return {name: np.array([row[name] for row in found]) for name in found[0]}
