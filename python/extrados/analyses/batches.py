"""The one layer under every large sweep: batches of about a second, progress, Ctrl-C, checkpoint, cluster.

A job is a picklable object with `run(first, count, threads) -> {name: array}` whose arrays have one row for
each of its members first .. first + count - 1. The rows of a member must not depend on how the members are
cut into batches: then neither threads nor workers nor resuming change a bit of the result.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.core.calls import cancel_requested, interruptible
from extrados.core.errors import Cancelled
from extrados.results.checkpoint import fingerprint

#: A batch should take about this long [s]; the first one has few members, to learn their speed.
BATCH_SECONDS, FIRST_BATCH, LARGEST_BATCH = 1.0, 32, 1_000_000
CONNECT_SECONDS = 10.0


class Job(Protocol):
    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]: ...


@dataclass(frozen=True)
class Swept:
    """Rows of all finished members in their order; `members` names them. `stopped` says why some are missing."""

    members: np.ndarray
    arrays: dict[str, np.ndarray]
    count: int
    stopped: str = ""
    interrupted: bool = False

    @property
    def complete(self) -> bool:
        return len(self.members) == self.count

    def __getitem__(self, name: str) -> np.ndarray:
        return self.arrays[name]


class _Batches:
    """Finished rows, wherever they come from, and what is still to do."""

    def __init__(self, context: Context, name: str, job: Job, count: int, text: str):
        self.context, self.count, self.text = context, count, text
        self.parts: dict[int, dict[str, np.ndarray]] = {}
        self.name = ""
        self.again = "; --resume goes on from here" if context.checkpoint is not None else ""
        if context.checkpoint is not None:
            self.name = f"{name}-{fingerprint(job)[:16]}-{count}"
            for first, arrays in context.checkpoint.load(self.name):
                self.parts[first] = arrays
        self.done = sum(_rows(p) for p in self.parts.values())

    def missing(self) -> list[tuple[int, int]]:
        """Ranges (first, end) without rows."""
        gaps, at = [], 0
        for first in sorted(self.parts):
            if first > at:
                gaps.append((at, first))
            at = first + _rows(self.parts[first])
        return gaps + ([(at, self.count)] if at < self.count else [])

    def add(self, first: int, arrays: dict[str, np.ndarray]) -> None:
        self.parts[first] = arrays
        self.done += _rows(arrays)
        if self.name:
            self.context.checkpoint.keep(self.name, first, arrays)
        self.context.progress(self.done, self.count, self.text)

    def swept(self, stopped: str = "", interrupted: bool = False) -> Swept:
        order = sorted(self.parts)
        members = [np.arange(first, first + _rows(self.parts[first])) for first in order]
        names = self.parts[order[0]] if order else ()
        arrays = {n: np.concatenate([self.parts[first][n] for first in order]) for n in names}
        return Swept(np.concatenate(members) if members else np.zeros(0, int), arrays, self.count, stopped, interrupted)


def _rows(arrays: dict[str, np.ndarray]) -> int:
    return len(next(iter(arrays.values())))


class _Pace:
    """Batch sizes that take about a second."""

    def __init__(self) -> None:
        self.size = FIRST_BATCH

    def learn(self, count: int, seconds: float) -> None:
        ideal = count * BATCH_SECONDS / max(seconds, 1e-6)
        self.size = int(min(max(1.0, ideal), 8.0 * self.size, LARGEST_BATCH))


def sweep(context: Context, name: str, job: Job, count: int, text: str) -> Swept:
    """Run all `count` members of the job here, or on the scheduler of the context; see Swept for what may be missing."""
    if count < 1:
        raise ValueError(f"a sweep needs at least one member, got {count}")
    with interruptible():
        batches = _Batches(context, name, job, count, text)
        context.progress(batches.done, count, text)
        if context.scheduler:
            return _on_cluster(context, batches, job)
        pace = _Pace()
        for first, end in batches.missing():
            while first < end:
                if cancel_requested():
                    return _interrupted(batches)
                size = min(pace.size, end - first)
                begin = time.perf_counter()
                try:
                    rows = job.run(first, size, context.threads)
                except Cancelled:
                    return _interrupted(batches)
                pace.learn(size, time.perf_counter() - begin)
                batches.add(first, rows)
                first += size
        return batches.swept()


def _interrupted(batches: _Batches) -> Swept:
    return batches.swept(f"interrupted after {batches.done} of {batches.count}{batches.again}", True)


def _run_on_worker(job: Job, first: int, count: int) -> tuple[dict[str, np.ndarray], float]:
    begin = time.perf_counter()
    rows = job.run(first, count, 1)
    return rows, time.perf_counter() - begin


def _on_cluster(context: Context, batches: _Batches, job: Job) -> Swept:
    """The same on a dask.distributed scheduler: lost workers' batches run again elsewhere."""
    try:
        from distributed import Client
    except ImportError:
        raise Refused(
            "a scheduler was given, but dask.distributed is not installed: pip install 'extrados[cluster]'"
        ) from None
    address = context.scheduler
    try:
        client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise Refused(f"no dask scheduler answers at {address}: {error}") from None
    try:
        return _collect(context, batches, job, client, address)
    except OSError:  # what distributed raises where the connection breaks within a call
        return _lost(batches, address)
    finally:
        client.close(timeout=1.0)


def _collect(context: Context, batches: _Batches, job: Job, client: Any, address: str) -> Swept:
    """Two batches for each worker are out at any time; finished ones are kept as they come."""
    pace = _Pace()
    pending: dict[Any, int] = {}
    todo = _pieces(batches.missing(), lambda: pace.size)
    upcoming = next(todo, None)
    while upcoming is not None or pending:
        if cancel_requested():
            return _interrupted(batches)
        workers = max(1, sum(client.nthreads().values())) if client.status == "running" else 1
        while upcoming is not None and len(pending) < 2 * workers:
            first, count = upcoming
            pending[client.submit(_run_on_worker, job, first, count, pure=False, retries=5)] = first
            upcoming = next(todo, None)
        ready = [future for future in pending if future.done()]
        if not ready:
            if client.status != "running":
                break
            time.sleep(0.02)
        for future in ready:
            first = pending.pop(future)
            if future.status == "error":
                return batches.swept(f"a batch failed on the cluster: {future.exception()!r}{batches.again}")
            if future.status != "finished":
                return _lost(batches, address)
            rows, seconds = future.result()
            pace.learn(_rows(rows), seconds)
            batches.add(first, rows)
    return batches.swept() if batches.done == batches.count else _lost(batches, address)


def _lost(batches: _Batches, address: str) -> Swept:
    return batches.swept(
        f"the scheduler at {address} is gone; {batches.done} of {batches.count} members are finished and kept{batches.again}"
    )


def _pieces(gaps: list[tuple[int, int]], size: Callable[[], int]) -> Iterator[tuple[int, int]]:
    for first, end in gaps:
        while first < end:
            count = min(size(), end - first)
            yield first, count
            first += count
