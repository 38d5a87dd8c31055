"""Processes of this machine that compute batches: members whose work is done in Python run side by side.

Each is `python -m extrados.analyses.workers`, told its job and its batches through a pipe of its own. They import nothing
of the caller's program, so a script needs no guard around its main part.
"""

import contextlib
import os
import queue
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, Pipe
from typing import Any

import numpy as np

from extrados import interrupts
from extrados.core.calls import stop_if_asked
from extrados.schema.isolated import environment, python_command

LOOK = 0.05  # s between two looks whether the user has asked for the end
ENDS = 5.0  # s: a process that has closed its pipe ends by then


@dataclass(frozen=True)
class Worker:
    """A process and our end of its pipe."""

    process: "subprocess.Popen[bytes]"
    pipe: Any


@dataclass(frozen=True)
class Elsewhere:
    """A job whose batches are computed by the first of its processes that is free."""

    free: "queue.SimpleQueue[Worker]"

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """Rows of a batch; what the job raised is raised here, RuntimeError where its process has ended."""
        worker = self.free.get()
        try:
            worker.pipe.send((first, count, threads))
            while not worker.pipe.poll(LOOK):
                stop_if_asked()  # who leaves the block ends the process
            rows, error = worker.pipe.recv()
        except (OSError, EOFError):
            with contextlib.suppress(subprocess.TimeoutExpired):
                worker.process.wait(ENDS)
            raise RuntimeError(
                f"a process that computed members {first} to {first + count - 1} ended with code {worker.process.returncode}. A "
                "negative code is the number of a signal; -9 often means that memory was exhausted"
            ) from None
        finally:
            self.free.put(worker)
        if error is not None:
            raise error
        return rows


@contextmanager
def processes(job: Any, count: int) -> Iterator[Elsewhere]:
    """The job in `count` processes, which end with the block."""
    started: list[Worker] = []
    # They find what we find
    found = environment(PYTHONPATH=os.pathsep.join(path for path in sys.path if path))
    free: queue.SimpleQueue[Worker] = queue.SimpleQueue()
    try:
        for _ in range(count):
            ours, theirs = Pipe()
            with theirs:
                number = theirs.fileno()
                command = python_command("extrados.analyses.workers", str(number))
                started.append(Worker(subprocess.Popen(command, stdin=subprocess.DEVNULL, pass_fds=[number], env=found), ours))
            ours.send(job)
            free.put(started[-1])
        yield Elsewhere(free)
    finally:
        for worker in started:
            worker.process.kill()
            worker.process.wait()
            worker.pipe.close()


def main() -> None:
    """Answer batches until the pipe ends; Ctrl-C is left to the process that asked."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    interrupts.end_with(os.getppid())
    pipe = Connection(int(sys.argv[1]))
    job = pipe.recv()
    while True:
        try:
            batch = pipe.recv()
        except EOFError:
            return
        told: tuple[Any, Exception | None]
        try:
            told = (job.run(*batch), None)
        except Exception as error:
            told = (None, error)
        pipe.send(told)


if __name__ == "__main__":
    main()
