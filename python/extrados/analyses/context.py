"""What a driver is given, and how it refuses."""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from extrados.analyses.table import Analysis
from extrados.decks.reader import Deck
from extrados.model.errors import BadGeometry, Key
from extrados.motions import tables
from extrados.views.building import Building

if TYPE_CHECKING:
    from extrados.motions.motion import Motion
    from extrados.results.checkpoint import Checkpoint


class Refused(Exception):
    """The question has no answer for this building or motion; the text says why and what would have one.

    at: the key of the deck that is to blame, of the analysis' own table ("analysis", ...); empty where none is.
    """

    def __init__(self, text: str = "", at: Key = ()):
        super().__init__(text)
        self.at = at


@dataclass
class Context:
    """What every driver is given. `progress(done, total, text)` may be called often; `out` is the results
    folder of the run, `tell` shows words to the user before the end, `resume` asks to go on from a checkpoint beside it, `scheduler` is the address of a
    dask.distributed scheduler for sweeps. `threads_given`: the user named the number of threads. `building` is the deck's, as the running analysis sees it. `motions` keeps
    what was made of motion tables."""

    deck: Deck
    threads: int = 1
    progress: Callable[[float, float, str], None] = lambda done, total, text: None
    tell: Callable[[str], None] = lambda text: None
    out: Path | None = None
    resume: bool = False
    scheduler: str = ""
    warnings: list[str] = field(default_factory=list)
    threads_given: bool = False
    building: Building = None  # type: ignore[assignment]
    motions: "dict[str, Motion]" = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.building is None:
            self.building = self.deck.building

    @cached_property
    def checkpoint(self) -> "Checkpoint | None":
        """Where sweeps keep finished batches; None without a results folder."""
        from extrados.results.checkpoint import Checkpoint

        return None if self.out is None else Checkpoint(self.out, self.deck.identity, self.resume)

    @property
    def motion(self) -> "Motion":
        """The motion of the deck; its notes join the warnings of whoever takes it. Refused where its file is wrong."""
        made = self.given_motion
        self.warnings += [note for note in made.notes if note not in self.warnings]
        return made

    @cached_property
    def given_motion(self) -> "Motion":
        """The motion of the deck, made once."""
        from extrados.motions.formats.record import RecordError
        from extrados.motions.from_deck import make_motion

        model = self.deck.require_motion()
        known = f"{model.model_dump_json()} {self.deck.folder}"
        if known not in self.motions:
            try:
                self.motions[known] = make_motion(model, self.deck.folder)
            except RecordError as error:
                raise Refused(str(error), ("motion",)) from None
        return self.motions[known]

    def refuse_motion(self) -> None:
        """Refused where the motion of the deck cannot be made, or none of its set; pulses always can be."""
        model, folder = self.deck.motion, self.deck.folder
        if isinstance(model, tables.Record):
            _ = self.motion
        elif isinstance(model, tables.Suite | tables.Generated | tables.Compatible):
            from extrados.motions.formats.record import RecordError
            from extrados.motions.from_deck import refuse_set

            try:
                refuse_set(model, folder)
            except RecordError as error:
                raise Refused(str(error), ("motion",)) from None

    def complaint(self, options: Analysis, error: Refused | BadGeometry) -> str:
        """What an analysis is refused for, with file, line and key where a key is to blame."""
        return self.deck.complaint(options, error.at, str(error))


def default_threads() -> int:
    """As many as this process may use, and no more than OMP_NUM_THREADS."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
    asked = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    return min(cores, int(asked)) if asked.isdigit() and int(asked) > 0 else cores
