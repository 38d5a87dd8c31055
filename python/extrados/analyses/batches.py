"""The one layer under everything that takes long: batches of about a second, progress, Ctrl-C, checkpoint, cluster.

`sweep` runs independent members. A job is a picklable object with `run(first, count, threads) -> {name: array}`
whose arrays have one row for each of its members first .. first + count - 1. The rows of a member must not depend
on how the members are cut into batches: then neither threads nor workers nor resuming change a bit of the result.
A search, whose next question depends on the answers so far, is one sweep for each round of questions.

`Chain` keeps the state of a computation whose steps follow from one another.
"""

import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from extrados.analyses import workers
from extrados.analyses.context import Context, Refused
from extrados.core.calls import cancel_requested, interruptible, thread_count
from extrados.core.calls import stop_if_asked as stop_if_asked
from extrados.core.errors import Cancelled
from extrados.core.threads import Worker
from extrados.model.errors import WHOLE
from extrados.results.checkpoint import fingerprint
from extrados.results.model import Streamed

#: A batch should take about this long [s]; the first one has few members, to learn their speed.
BATCH_SECONDS, FIRST_BATCH, LARGEST_BATCH = 1.0, 32, 1_000_000
CONNECT_SECONDS = 10.0
#: Between two looks whether a batch in a thread is over [s]
LOOK = 0.01
#: Rows that are kept in memory; of more, where a sweep may have them, so many are looked at at a time
IN_MEMORY, PIECE = 200_000, 100_000


class Job(Protocol):
    """What a sweep does for its members, told from 0."""

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """The rows of members first .. first + count - 1: arrays (count, ...) by name, which depend on neither batch nor threads."""


class Unfinished(Exception):
    """Some members of a sweep are missing; the text says why. `interrupted`: the user asked for it."""

    def __init__(self, why: str, interrupted: bool):
        super().__init__(why)
        self.interrupted = interrupted


@dataclass(frozen=True)
class Swept:
    """Rows of all finished members in their order; `members` names them. `stopped` says why some are missing.

    parts: first member and number of rows of each batch; pick(first, names): rows of a batch, from memory or from disk.
    """

    parts: list[tuple[int, int]]
    names: tuple[str, ...]
    pick: Callable[[int, Sequence[str]], dict[str, np.ndarray]]
    count: int
    on_disk: bool = False
    stopped: str = ""
    interrupted: bool = False

    @property
    def status(self) -> str:
        """The status of a result of these members."""
        return "interrupted" if self.interrupted else "failed" if self.stopped else "ok"

    @property
    def finished(self) -> int:
        """Number of members with rows."""
        return sum(rows for _, rows in self.parts)

    @property
    def complete(self) -> bool:
        """Whether every member is there."""
        return self.finished == self.count

    @cached_property
    def members(self) -> np.ndarray:
        """Numbers of the finished members."""
        found = [np.arange(first, first + rows) for first, rows in self.parts]
        return np.concatenate(found) if found else np.zeros(0, int)

    @cached_property
    def arrays(self) -> dict[str, np.ndarray]:
        """All rows, in memory."""
        parts = [self.pick(first, self.names) for first, _ in self.parts]
        return {n: np.concatenate([part[n] for part in parts]) for n in self.names}

    def __getitem__(self, name: str) -> np.ndarray:
        return self.arrays[name]

    def pieces(self, *names: str) -> Iterator[tuple[np.ndarray, dict[str, np.ndarray]]]:
        """Members and their rows, all at once where they are in memory, else PIECE after PIECE: sums over pieces do not
        depend on how the sweep was cut."""
        if not self.on_disk:
            if len(self.members):
                yield self.members, {n: self.arrays[n] for n in names}
            return
        members = np.zeros(0, int)
        rows: dict[str, list[np.ndarray]] = {n: [] for n in names}
        for first, length in self.parts:
            part = self.pick(first, names)
            members = np.concatenate([members, np.arange(first, first + length)])
            for n in names:
                rows[n].append(part[n])
            while len(members) >= PIECE:
                whole = {n: np.concatenate(found) for n, found in rows.items()}
                yield members[:PIECE], {n: found[:PIECE] for n, found in whole.items()}
                members, rows = members[PIECE:], {n: [found[PIECE:]] for n, found in whole.items()}
        if len(members):
            yield members, {n: np.concatenate(found) for n, found in rows.items()}

    def column(self, name: str, change: Callable[[np.ndarray], np.ndarray] = lambda rows: rows) -> np.ndarray | Streamed:
        """One row of each member, changed; to be read from disk where the rows lie there."""
        if not self.on_disk:
            return change(self[name])
        kind = change(self.pick(self.parts[0][0], [name])[name][:1]).dtype
        return Streamed(self.finished, kind, lambda: (change(rows[name]) for _, rows in self.pieces(name)))

    def whole(self) -> "Swept":
        """Itself; Unfinished where members are missing."""
        if not self.complete:
            raise Unfinished(self.stopped, self.interrupted)
        return self


def computed(context: Context | None, name: str, job: Job, count: int, text: str, threads: int = 1, **how: Any) -> Any:
    """All rows of a job: by `sweep` where there is a context, Unfinished where some are missing; else at once."""
    if context is None:
        return job.run(0, count, threads)
    return sweep(context, name, job, count, text, **how).whole()


def stacked(rows: Callable[[int], dict[str, np.ndarray]], first: int, count: int) -> dict[str, np.ndarray]:
    """The rows of a batch from those of single members: for jobs whose members take long."""
    found = []
    for k in range(first, first + count):
        stop_if_asked()
        found.append(rows(k))
    return {name: np.stack([one[name] for one in found]) for name in found[0]}


class _Batches:
    """Finished rows, wherever they come from, and what is still to do."""

    def __init__(self, context: Context, name: str, job: Job, count: int, tell: Callable[[int], None], large: bool = False):
        self.context, self.count, self.tell = context, count, tell
        self.kept = context.checkpoint
        #: first member -> rows, or where they lie
        self.parts: dict[int, dict[str, np.ndarray] | Path] = {}
        self.rows: dict[int, int] = {}
        self.names: tuple[str, ...] = ()
        self.on_disk = large and self.kept is not None and count > IN_MEMORY
        self.name = ""
        self.again = "; --resume continues from here" if self.kept is not None else ""
        if self.kept is not None:
            self.name = f"{name}-{fingerprint(job)[:16]}-{count}"
            end = 0
            for first, arrays, path in self.kept.placed(self.name, context.warnings):
                if _are_rows(arrays) and not end <= first <= count - _rows(arrays):  # of another run that was going on at the same time
                    context.warnings.append(f"the saved batch that begins at run {first} is not used, because it overlaps another batch")
                elif not _are_rows(arrays) or (self.names and set(arrays) != set(self.names)):  # of a stranger
                    context.warnings.append(
                        f"the saved batch that begins at run {first} is not used, because its results are not of this analysis"
                    )
                else:
                    self._put(first, arrays, path)
                    end = first + _rows(arrays)
        self.done = sum(self.rows.values())
        tell(self.done)

    def _put(self, first: int, arrays: dict[str, np.ndarray], path: Path | None) -> None:
        self.rows[first], self.names = _rows(arrays), tuple(arrays)
        self.parts[first] = path if self.on_disk and path is not None else arrays

    def _pick(self, first: int, names: Sequence[str]) -> dict[str, np.ndarray]:
        part = self.parts[first]
        if not isinstance(part, Path):
            return {n: part[n] for n in names}
        assert self.kept is not None  # rows lie on disk in a checkpoint alone
        return self.kept.pick(part, names)

    def missing(self) -> list[tuple[int, int]]:
        """Ranges (first, end) without rows."""
        gaps, at = [], 0
        for first in sorted(self.parts):
            if first > at:
                gaps.append((at, first))
            at = first + self.rows[first]
        return gaps + ([(at, self.count)] if at < self.count else [])

    def add(self, first: int, arrays: dict[str, np.ndarray]) -> None:
        path = None if self.kept is None else self.kept.keep(self.name, first, arrays)
        self._put(first, arrays, path)
        self.done += _rows(arrays)
        self.tell(self.done)

    def swept(self, stopped: str = "", interrupted: bool = False) -> Swept:
        parts = [(first, self.rows[first]) for first in sorted(self.parts)]
        return Swept(parts, self.names, self._pick, self.count, self.on_disk, stopped, interrupted)


def _are_rows(arrays: dict[str, np.ndarray]) -> bool:
    """Whether all arrays have the same number of members, at least one."""
    counts = {array.shape[:1] for array in arrays.values()}
    return len(counts) == 1 and counts.isdisjoint({(), (0,)})


def _rows(arrays: dict[str, np.ndarray]) -> int:
    return len(next(iter(arrays.values())))


class _Pace:
    """Batch sizes that take about a second."""

    def __init__(self, size: int = FIRST_BATCH) -> None:
        self.size = size

    def learn(self, count: int, seconds: float) -> None:
        ideal = count * BATCH_SECONDS / max(seconds, 1e-6)
        self.size = int(min(max(1.0, ideal), 8.0 * self.size, LARGEST_BATCH))


def sweep(
    context: Context,
    name: str,
    job: Job,
    count: int,
    text: str,
    *,
    slow: bool = False,
    parallel: bool = False,
    tell: Callable[[int], None] | None = None,
    large: bool = False,
    processes: int = 1,
) -> Swept:
    """Run all `count` members of the job here, or on the scheduler of the context; see Swept for what may be missing.

    slow: a member may take seconds, batches begin with one. parallel: each thread runs a batch of its own, for slow
    members that the core computes; else one batch after the other has all threads. tell: is given the number of
    finished members instead of the context's progress, where the sweep is one round of a search. large: rows of very many
    members stay in the checkpoint, where there is one. processes: so many of this machine run a batch each, for members
    whose work is done in Python; a scheduler comes first.
    """
    if count < 1:
        raise ValueError(f"a sweep requires at least one run, found {count}")
    with interruptible():
        batches = _Batches(context, name, job, count, tell or (lambda done: context.progress(done, count, text)), large)
        if batches.done == count:
            return batches.swept()
        pace = _Pace(1 if slow else FIRST_BATCH)
        if context.scheduler:
            return _on_cluster(context, batches, job, pace)
        if processes > 1:
            with workers.processes(job, processes) as elsewhere:
                return _in_threads(batches, elsewhere, pace, processes, context.threads)
        if parallel:
            threads = thread_count(max(1, context.threads))
            return _in_threads(batches, job, pace, threads, max(1, threads // (count - batches.done)))
        return _in_turn(context, batches, job, pace)


def _in_turn(context: Context, batches: _Batches, job: Job, pace: _Pace) -> Swept:
    """One batch after the other, each on all threads."""
    for first, count in _pieces(batches.missing(), lambda: pace.size):
        if cancel_requested():
            return _interrupted(batches)
        try:
            rows, seconds = _timed(job, first, count, context.threads)
        except Cancelled:
            return _interrupted(batches)
        pace.learn(count, seconds)
        batches.add(first, rows)
    return batches.swept()


def _in_threads(batches: _Batches, job: Job, pace: _Pace, threads: int, each: int) -> Swept:
    """A batch for each of `threads` at a time, kept as they come; a batch has `each` threads of the core."""
    todo = _pieces(batches.missing(), lambda: pace.size)
    pending: dict[Worker[tuple[dict[str, np.ndarray], float]], int] = {}
    stopped = False
    try:
        while True:
            while not stopped and len(pending) < threads and (piece := next(todo, None)):
                pending[Worker(partial(_timed, job, *piece, each))] = piece[0]
            if not pending:
                break
            for worker in [worker for worker in pending if worker.over(LOOK)]:
                first = pending.pop(worker)
                try:
                    rows, seconds = worker.result()
                except Cancelled:
                    stopped = True
                    continue
                pace.learn(_rows(rows), seconds)
                batches.add(first, rows)
            stopped = stopped or cancel_requested()
    finally:
        while not all([worker.over() for worker in pending]):
            pass
    return batches.swept() if batches.done == batches.count else _interrupted(batches)


def _interrupted(batches: _Batches) -> Swept:
    return batches.swept(f"interrupted after {batches.done} of {batches.count}{batches.again}", True)


def _timed(job: Job, first: int, count: int, threads: int) -> tuple[dict[str, np.ndarray], float]:
    """Rows of a batch and the seconds it took."""
    begin = time.perf_counter()
    rows = job.run(first, count, threads)
    return rows, time.perf_counter() - begin


def _on_cluster(context: Context, batches: _Batches, job: Job, pace: _Pace) -> Swept:
    """The same on a dask.distributed scheduler: lost workers' batches run again elsewhere."""
    try:
        from distributed import Client
    except ImportError:
        raise Refused(
            "a scheduler was given, but dask.distributed is not installed. Install it by pip install 'extrados[cluster]'", WHOLE
        ) from None
    address = context.scheduler
    try:
        client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise Refused(f"no dask scheduler responds at {address}: {error}", WHOLE) from None
    try:
        return _collect(batches, job, pace, client, address)
    except OSError:  # what distributed raises where the connection breaks within a call
        return _lost(batches, address)
    finally:
        with contextlib.suppress(OSError):  # a scheduler that is busy or gone says no goodbye in time; the rows are here
            client.close(timeout=1.0)


def _collect(batches: _Batches, job: Job, pace: _Pace, client: Any, address: str) -> Swept:
    """Two batches for each worker are out at any time; finished ones are kept as they come."""
    pending: dict[Any, tuple[int, int]] = {}

    def send(first: int, count: int) -> None:
        pending[client.submit(_timed, job, first, count, 1, pure=False, retries=5)] = first, count

    todo = _pieces(batches.missing(), lambda: pace.size)
    upcoming = next(todo, None)
    while upcoming is not None or pending:
        if cancel_requested():
            return _interrupted(batches)
        workers = max(1, sum(client.nthreads().values())) if client.status == "running" else 1
        while upcoming is not None and len(pending) < 2 * workers:
            send(*upcoming)
            upcoming = next(todo, None)
        ready = [future for future in pending if future.done()]
        if not ready:
            if client.status != "running":
                break
            time.sleep(0.02)
        for future in ready:
            piece = pending.pop(future)
            if future.status == "error":
                return batches.swept(f"a batch failed on the cluster: {future.exception()!r}{batches.again}")
            if future.status != "finished":  # its worker died with the rows before they were fetched
                if client.status != "running":
                    return _lost(batches, address)
                time.sleep(0.02)
                send(*piece)
                continue
            rows, seconds = future.result()
            pace.learn(_rows(rows), seconds)
            batches.add(piece[0], rows)
    return batches.swept() if batches.done == batches.count else _lost(batches, address)


def _lost(batches: _Batches, address: str) -> Swept:
    return batches.swept(
        f"the scheduler at {address} does not respond any more; {batches.done} of {batches.count} runs "
        f"are complete and saved{batches.again}"
    )


def _pieces(gaps: list[tuple[int, int]], size: Callable[[], int]) -> Iterator[tuple[int, int]]:
    for first, end in gaps:
        while first < end:
            count = min(size(), end - first)
            yield first, count
            first += count


class Chain:
    """The state of a computation whose steps follow from one another, kept now and then.

    `state` is the newest one that an interrupted run kept, with the number of its step; None begins anew. What the
    steps compute, `job`, names it as that of a sweep does.
    """

    def __init__(self, context: Context, name: str, job: Any):
        self._checkpoint = context.checkpoint
        self._name = f"{name}-{fingerprint(job)[:16]}"
        self._kept: list[Path] = []
        self.state: tuple[int, dict[str, np.ndarray]] | None = None
        if self._checkpoint is not None:
            for found in self._checkpoint.load(self._name, context.warnings):
                self.state = found

    @property
    def keeps(self) -> bool:
        """Whether there is a folder to keep states in."""
        return self._checkpoint is not None

    @property
    def again(self) -> str:
        """What to say to the user whose run was stopped."""
        return "; --resume continues from here" if self._checkpoint is not None else ""

    def keep(self, step: int, state: dict[str, np.ndarray]) -> None:
        """Keep the state after a step; of those before, one stays in case this one is damaged."""
        if self._checkpoint is None:
            return
        self._kept.append(self._checkpoint.keep(self._name, step, state))
        for old in self._kept[:-2]:
            old.unlink(missing_ok=True)
        del self._kept[:-2]
