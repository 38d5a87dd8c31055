"""Runs of the core as one job of the batch layer: each run is a member, its histories are rows."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from functools import partial
from typing import Any, Generic, TypeVar, overload

import numpy as np

from extrados.analyses.batches import Chain, stacked, sweep
from extrados.analyses.context import Context
from extrados.core import dem, dem3, dem_run
from extrados.core.calls import cancel_requested
from extrados.core.errors import Cancelled, status_code
from extrados.core.ground import Ground, as_motion_set

#: A run of fewer bodies is faster on one thread.
BODIES_FOR_THREADS = 100
SOLIDS_FOR_THREADS = 60
#: The state of a single run is kept so often [s]; the number under which one that has ended is kept
KEEP_SECONDS, ENDED = 10.0, 999_999_999_999
NUMBERS = ("stop_time", "step", "critical_step", "residual")
COUNTS = ("steps", "settling_steps", "searches", "most_pairs")
DRAWN = ("contact_force", "contact_normal", "contact_arm")
HISTORIES = ("time", "place", "rate", "tension", "joint_force", "joint_friction", "joint_damping", *DRAWN)
OF_BODIES = ("settled", "bounces", "airborne", "extreme", "joint_body")
NO_CONTACTS = dem.Contacts(*(np.zeros(shape) for shape in ((0, 2), (0, 2), (0, 2), 0, 0)))

Found = TypeVar("Found", bound=dem_run.FoundRun)


@dataclass(frozen=True)
class Task:
    """One run: the number of its bodies in the job, options, the ground times `scale`, displacements and velocities at the start
    (bodies, 3) [m, m, rad], none where it starts at rest, and supports that move."""

    bodies: int
    options: dem.Options
    ground: Ground | None = None
    scale: float = 1.0
    shift: np.ndarray | None = None
    rate: np.ndarray | None = None
    moves: tuple[dem_run.SupportMove, ...] = ()

    @property
    def times(self) -> np.ndarray:
        """Output times [s]."""
        return output_times(self.options.end_time, self.options.output_step)


class Job(ABC, Generic[Found]):
    """Runs of one sort of bodies."""

    @abstractmethod
    def one(self, k: int, threads: int = 1) -> Found:
        """A run, however it ends."""

    @abstractmethod
    def rows(self, found: Found) -> dict[str, np.ndarray]:
        """The row of a run."""

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        def member(k: int) -> dict[str, np.ndarray]:
            found = self.one(k, threads)
            if found.interrupted:
                raise Cancelled(status_code("cancelled"), "discrete elements interrupted")
            return self.rows(found)

        return stacked(member, first, count)


@dataclass(frozen=True)
class Runs(Job[dem.Run]):
    """Member k is tasks[k]; all have as many bodies."""

    bodies: list[dem.Bodies]
    tasks: list[Task]

    def one(
        self, k: int, threads: int = 1, state: np.ndarray | None = None, watch: Callable[[dem.Model, float], None] | None = None
    ) -> dem.Run:
        """A run, however it ends; from a state of it, and watched, where wanted (see core.dem.Model.run)."""
        task, bodies = self.tasks[k], self.bodies[self.tasks[k].bodies]
        many = len(bodies.mass) >= BODIES_FOR_THREADS
        options = replace(task.options, threads=threads if many else 1)
        with (
            dem.Model(bodies, options, shift=task.shift, rate=task.rate, moves=task.moves) as model,
            as_motion_set([task.ground or dem_run.STILL]) as motions,
        ):
            told = None if watch is None else partial(watch, model)
            return model.run(motions, scale=task.scale, times=task.times, state=state, watch=told)

    def rows(self, found: dem.Run) -> dict[str, np.ndarray]:
        """The row of a run; histories are as long as the longest that was asked for."""
        length = max(len(task.times) for task in self.tasks)
        return {**recorded(found, length), "blamed": np.array([*found.blamed, -1, -1][:2])}

    def run_of(self, rows: dict[str, np.ndarray], k: int = 0) -> dem.Run:
        """The run of row k, but for the forces in its contacts at the end."""
        row = {name: values[k] for name, values in rows.items()}
        return dem.Run(**record_of(row), contacts=NO_CONTACTS)


@dataclass(frozen=True)
class SolidTask:
    """One run of blocks in space: options, how the ground moves along their way and, horizontally, across it, each times
    `scale`, and supports that move."""

    options: dem3.Options
    ground: Ground | None = None
    across: Ground | None = None
    scale: float = 1.0
    moves: tuple[dem_run.SupportMove, ...] = ()

    @property
    def times(self) -> np.ndarray:
        """Output times [s]."""
        return output_times(self.options.end_time, self.options.output_step)


@dataclass(frozen=True)
class SolidRuns(Job[dem3.Run]):
    """Member k is tasks[k], all of the same bodies."""

    bodies: dem3.Solids
    tasks: list[SolidTask]

    def one(
        self, k: int, threads: int = 1, state: np.ndarray | None = None, watch: Callable[[dem3.Model, float], None] | None = None
    ) -> dem3.Run:
        """A run, however it ends; from a state of it, and watched, where wanted (see core.dem3.Model.run)."""
        task = self.tasks[k]
        options = replace(task.options, threads=threads if len(self.bodies.mass) >= SOLIDS_FOR_THREADS else 1)
        with (
            dem3.Model(self.bodies, options, moves=task.moves) as model,
            as_motion_set([task.ground or dem_run.STILL, task.across or dem_run.STILL]) as motions,
        ):
            told = None if watch is None else partial(watch, model)
            across = None if task.across is None else 1
            return model.run(motions, across=across, scale=task.scale, times=task.times, state=state, watch=told)

    def rows(self, found: dem3.Run) -> dict[str, np.ndarray]:
        """The row of a run; histories are as long as the longest that was asked for."""
        length = max(len(task.times) for task in self.tasks)
        return {
            **recorded(found, length),
            "blamed": np.array([*found.blamed, -1][:1]),
            "turn": padded(found.turn, length),
            "settled_turn": found.settled_turn,
            "dowel_slip": found.dowel_slip,
            "dowel_out": found.dowel_out,
        }

    def run_of(self, rows: dict[str, np.ndarray], k: int = 0) -> dem3.Run:
        """The run of row k."""
        row = {name: values[k] for name, values in rows.items()}
        rest = {name: row[name] for name in ("settled_turn", "dowel_slip", "dowel_out")}
        return dem3.Run(**record_of(row), turn=row["turn"][: int(row["points"])], **rest)


def recorded(found: dem_run.FoundRun, length: int) -> dict[str, np.ndarray]:
    """What a row tells of a run of any bodies, but for who is to blame."""
    energy = np.stack([found.energy[name] for name in dem_run.ENERGIES], axis=-1)
    return {
        "reason": np.array(found.reason),
        "points": np.array(len(found.time)),
        **{name: padded(getattr(found, name), length) for name in HISTORIES},
        "energy": padded(energy, length),
        "effort": np.array(astuple(found.effort), dtype=float),
        **{name: getattr(found, name) for name in OF_BODIES},
        **{name: np.array(getattr(found, name)) for name in NUMBERS + COUNTS},
    }


def record_of(row: dict[str, np.ndarray]) -> dict[str, Any]:
    """The run that `recorded` told of, by the names of core.dem_run.FoundRun."""
    points = int(row["points"])
    return {
        "reason": str(row["reason"]),
        "blamed": [int(b) for b in row["blamed"] if b >= 0],
        **{name: row[name][:points] for name in HISTORIES},
        "energy": {name: row["energy"][:points, i] for i, name in enumerate(dem_run.ENERGIES)},
        "effort": dem_run.Effort(*(int(v) for v in row["effort"][:4]), *(float(v) for v in row["effort"][4:])),
        **{name: row[name] for name in OF_BODIES},
        **{name: float(row[name]) for name in NUMBERS},
        **{name: int(row[name]) for name in COUNTS},
    }


def output_times(end: float, step: float) -> np.ndarray:
    """Times from nought to an end [s]."""
    return np.arange(round(end / step * (1 - 1e-12)) + 1) * step


def padded(history: np.ndarray, length: int) -> np.ndarray:
    """A history (nt, ...) made longer by NaN."""
    out = np.full((length, *history.shape[1:]), np.nan)
    out[: len(history)] = history
    return out


@overload
def watched(context: Context, name: str, job: Runs, text: str) -> dem.Run: ...
@overload
def watched(context: Context, name: str, job: SolidRuns, text: str) -> dem3.Run: ...
def watched(context: Context, name: str, job: Any, text: str) -> Any:
    """The one run of a job, with progress; its state is kept now and then and when it is interrupted, and the run when it
    has ended, so that one that is resumed goes on from there. Settling under the own weight is not kept."""
    chain = Chain(context, name, job)
    state = None
    if chain.state is not None:
        step, kept = chain.state
        if step == ENDED:
            return job.run_of(kept)
        state = kept["state"]
    step, last = (0 if chain.state is None else chain.state[0]), time.monotonic()
    end = job.tasks[0].options.end_time

    def watch(model: dem.Model | dem3.Model, reached: float) -> None:
        nonlocal step, last
        context.progress(min(reached, end), end, text)
        if chain.keeps and (time.monotonic() - last >= KEEP_SECONDS or cancel_requested()):
            step, last = step + 1, time.monotonic()
            chain.keep(step, {"state": model.state()})

    found = job.one(0, context.threads, state, watch)
    if not found.interrupted:
        chain.keep(ENDED, {name: values[None] for name, values in job.rows(found).items()})
    return found


@overload
def answered(context: Context, name: str, job: Runs, text: str, tell: Callable[[int], None] | None = None) -> list[dem.Run]: ...
@overload
def answered(context: Context, name: str, job: SolidRuns, text: str, tell: Callable[[int], None] | None = None) -> list[dem3.Run]: ...
def answered(context: Context, name: str, job: Any, text: str, tell: Callable[[int], None] | None = None) -> list[Any]:
    """All runs of the job, kept by the batch layer; Unfinished where some are missing."""
    swept = sweep(context, name, job, len(job.tasks), text, slow=True, parallel=True, tell=tell).whole()
    return [job.run_of(swept.arrays, k) for k in range(swept.count)]
