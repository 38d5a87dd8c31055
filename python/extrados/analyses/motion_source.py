"""The many motions of a deck, batch by batch; a broken one is its reason and the others go on."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.core import motion as core_motion
from extrados.core.rocking import Ground
from extrados.motions import tables as models
from extrados.motions.formats.record import RecordError
from extrados.motions.from_deck import generated_set, make_motion, member_name, suite_members, suite_motion
from extrados.motions.generated import GeneratedSet
from extrados.motions.motion import Motion

MOST_NOTES = 10  # of a suite, shown with the result


def shortened(notes: list[str]) -> list[str]:
    """The first MOST_NOTES, and how many more there are."""
    more = len(notes) - MOST_NOTES
    return notes[:MOST_NOTES] + ([f"{more} further remarks on records of the suite are not shown."] if more > 0 else [])


class Source(Protocol):
    """Motions 0 .. of a deck."""

    def grounds(self, first: int, count: int, threads: int) -> list[Ground | str]:
        """Motions first .. first + count - 1; text says why one is missing."""


@dataclass(frozen=True)
class GeneratedSource:
    """Generated earthquakes by seed."""

    made: GeneratedSet

    def grounds(self, first: int, count: int, threads: int) -> list[Ground | str]:
        rows = self.made.batch(first, count, threads)
        return [Ground(samples=row[None, :], step=self.made.step) for row in rows]


@dataclass(frozen=True)
class ListSource:
    """Motions held in memory, used again from the start when more are asked for; text is why one is missing."""

    motions: list[Ground | str]
    names: list[str]

    def grounds(self, first: int, count: int, threads: int) -> list[Ground | str]:
        return [self.motions[k % len(self.motions)] for k in range(first, first + count)]


@dataclass(frozen=True)
class CompatibleSource:
    """Spectrum-compatible motions of a deck's table, made where they are needed."""

    model: models.Compatible
    folder: str

    def grounds(self, first: int, count: int, threads: int) -> list[Ground | str]:
        members = (self.model.model_copy(update={"member": k + 1}) for k in range(first, first + count))
        return [_try(partial(make_motion, member, Path(self.folder))) for member in members]


def _try(make: Callable[[], Motion], notes: list[str] | None = None) -> Ground | str:
    """The ground of a motion, or why there is none; what is to be known of the motion goes to `notes`."""
    try:
        motion = make()
    except RecordError as error:
        return str(error)
    if notes is not None:
        notes += motion.notes
    return motion.ground


def how_many(context: Context) -> int | None:
    """Motions that the deck has; None where there are as many as are asked for. Refused where a suite has none."""
    model = context.deck.motion
    if isinstance(model, models.Generated | models.Compatible):
        return None
    try:
        return len(suite_members(model, context.deck.folder)) if isinstance(model, models.Suite) else 1
    except RecordError as error:
        raise Refused(str(error), ("motion",)) from None


def source_of(context: Context, seed: int | None, duration: float | None = None) -> tuple[Source, int | None]:
    """The motions of the deck and how many there are (None: as many as asked for); Refused where there are none."""
    model, folder = context.deck.motion, context.deck.folder
    try:
        if isinstance(model, models.Generated):
            if duration is not None:
                model = model.model_copy(update={"duration": duration})
            return GeneratedSource(generated_set(model, folder, seed)), None
        if isinstance(model, models.Compatible):
            if seed is not None:
                model = model.model_copy(update={"seed": seed})
            return CompatibleSource(model, str(folder)), None
        if isinstance(model, models.Suite):
            notes: list[str] = []
            members = suite_members(model, folder)
            grounds = [_try(partial(suite_motion, model, m, folder), notes) for m in members]
            if all(isinstance(g, str) for g in grounds):
                raise Refused(f"none of the {len(grounds)} records of the suite can be read. First reason: {grounds[0]}", ("motion",))
            context.warnings += shortened(notes)
            return ListSource(grounds, [member_name(m) for m in members]), len(grounds)
        return ListSource([context.motion.ground], ["motion"]), 1
    except RecordError as error:
        raise Refused(str(error), ("motion",)) from None


#: Names of the intensity measures that `measures` gives, in SI.
MEASURES = ("pga", "pgv", "arias")


def measures(grounds: list[Ground], sa: tuple[float, float] | None, threads: int) -> dict[str, np.ndarray]:
    """pga [m/s^2], pgv [m/s], arias [m/s] and, with sa = (period, damping), sa [m/s^2] of each motion."""
    out = {name: np.zeros(len(grounds)) for name in (*MEASURES, *(("sa",) if sa else ()))}
    series: dict[tuple[int, float], list[int]] = {}
    values: dict[int, np.ndarray] = {}
    for i, ground in enumerate(grounds):
        if ground.samples is not None:
            step, values[i] = ground.step, ground.samples[0]
        else:
            time, values[i] = Motion("", ground).series()
            step = float(time[1] - time[0])
        series.setdefault((len(values[i]), step), []).append(i)
    for (_, step), index in series.items():
        batch = np.stack([values[i] for i in index])
        found = core_motion.measures(batch, step, threads)
        for name in MEASURES:
            out[name][index] = getattr(found, name)
        if sa:
            out["sa"][index] = core_motion.response_spectra(batch, step, [sa[0]], [sa[1]], threads=threads).psa.reshape(len(index))
    return out
