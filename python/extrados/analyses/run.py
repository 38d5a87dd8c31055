"""Run the analyses of a deck in order, on one structure and one motion."""

import importlib
import os
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from extrados.core.errors import Cancelled, CoreError
from extrados.decks.reader import Deck
from extrados.limit.solver import NoAnswer
from extrados.motions.from_deck import make_motion
from extrados.motions.motion import Motion
from extrados.motions.records import RecordError
from extrados.results.checkpoint import Checkpoint
from extrados.results.model import Result
from extrados.structures.builder import BadGeometry
from extrados.structures.from_deck import make_structure

#: Analysis kind -> module with run(context, options) -> Result
DRIVERS = {
    "tilt": "extrados.analyses.tilt",
    "thrust": "extrados.analyses.thrust",
    "sweep": "extrados.analyses.sweep",
    "survey": "extrados.analyses.survey",
    "supports": "extrados.analyses.supports",
    "moving-load": "extrados.analyses.moving_load",
    "rocking": "extrados.analyses.rocking",
    "failure-domain": "extrados.analyses.failure_domain",
    "assessment": "extrados.analyses.assessment",
    "fragility": "extrados.analyses.fragility",
    "resonance": "extrados.analyses.resonance",
    "rocking-spectrum": "extrados.analyses.rocking_spectrum",
    "harmonic-map": "extrados.analyses.harmonic_map",
    "code-checks": "extrados.analyses.code_checks",
    "motion": "extrados.analyses.motion_study",
    "shake-table": "extrados.analyses.shake_table",
    "sla": "extrados.analyses.sla",
    "dem": "extrados.analyses.dem",
    "dem-domain": "extrados.analyses.dem_domain",
    "dem-parameters": "extrados.analyses.dem_parameters",
}


class Refused(Exception):
    """The question has no answer for this structure or motion; the text says why and what would have one."""


@dataclass
class Context:
    """What every driver is given. `progress(done, total, text)` may be called often; `out` is the results
    folder of the run, `resume` asks to go on from a checkpoint beside it, `scheduler` is the address of a
    dask.distributed scheduler for sweeps."""

    deck: Deck
    threads: int = 1
    progress: Callable[[float, float, str], None] = lambda done, total, text: None
    out: Path | None = None
    resume: bool = False
    scheduler: str = ""
    warnings: list[str] = field(default_factory=list)

    @cached_property
    def structure(self) -> Any:
        """The structure of the deck as blocks and joints, or as a mesh; Refused where it cannot be built."""
        try:
            return make_structure(self.deck.structure, self.deck.folder)
        except BadGeometry as error:
            raise Refused(str(error)) from None

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


def default_threads() -> int:
    """As many as this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


def run_analyses(context: Context) -> list[Result]:
    """All analyses of the deck in order; after Ctrl-C the rest is marked interrupted."""
    results: list[Result] = []
    stopped = False
    for options in context.deck.analyses:
        if stopped:
            results.append(Result(options.kind, "interrupted", "not run: interrupted before"))
            continue
        begin = time.perf_counter()
        try:
            context.warnings = []
            result = importlib.import_module(DRIVERS[options.kind]).run(context, options)
            result.warnings = [*context.warnings, *result.warnings]
        except Refused as error:
            result = Result(options.kind, "refused", str(error))
        except (Cancelled, KeyboardInterrupt):
            result = Result(options.kind, "interrupted", "interrupted before it had a result")
        except MemoryError as error:
            result = Result(options.kind, "failed", str(error) or "not enough memory")
        except (CoreError, NoAnswer) as error:
            result = Result(options.kind, "failed", str(error))
        except Exception as error:  # a fault of ours: the other analyses of the deck still count
            name = f"internal-error-{options.kind}.txt"
            result = Result(
                options.kind, "failed", f"internal error, please report it with {name}: {type(error).__name__}: {error}"
            )
            result.files[name] = traceback.format_exc().encode()
        result.seconds = time.perf_counter() - begin
        stopped = result.status == "interrupted"
        results.append(result)
    return results
