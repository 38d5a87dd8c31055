"""What a driver is given, and how it refuses."""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from extrados.building.building import Building
from extrados.decks.reader import Deck
from extrados.motions.from_deck import is_set, make_motion
from extrados.motions.motion import Motion
from extrados.motions.records import RecordError
from extrados.results.checkpoint import Checkpoint
from extrados.schema.constants import GRAVITY


class Refused(Exception):
    """The question has no answer for this building or motion; the text says why and what would have one."""


@dataclass
class Context:
    """What every driver is given. `progress(done, total, text)` may be called often; `out` is the results
    folder of the run, `resume` asks to go on from a checkpoint beside it, `scheduler` is the address of a
    dask.distributed scheduler for sweeps. `building` is the deck's, as the running analysis sees it."""

    deck: Deck
    threads: int = 1
    progress: Callable[[float, float, str], None] = lambda done, total, text: None
    out: Path | None = None
    resume: bool = False
    scheduler: str = ""
    warnings: list[str] = field(default_factory=list)
    building: Building = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if self.building is None:
            self.building = self.deck.building

    @cached_property
    def checkpoint(self) -> Checkpoint | None:
        """Where sweeps keep finished batches; None without a results folder."""
        return None if self.out is None else Checkpoint(self.out, self.deck.identity, self.resume)

    @cached_property
    def motion(self) -> Motion:
        """The motion of the deck; Refused where its file is wrong."""
        try:
            return make_motion(self.deck.motion, self.deck.folder)
        except RecordError as error:
            raise Refused(str(error)) from None

    @cached_property
    def demand_g(self) -> float | None:
        """Peak horizontal acceleration of the deck's motion [g], to hold against a capacity; None where there is no
        motion, many, or one that cannot be read, which an analysis that needs none does not complain of."""
        if self.deck.motion is None or is_set(self.deck.motion):
            return None
        try:
            return self.motion.peak / GRAVITY
        except Refused:
            return None


def default_threads() -> int:
    """As many as this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
