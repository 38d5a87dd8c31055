"""Tasks in forked processes, side by side: their death is seen, and none of them outlives a signal or its parent."""

import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection, Pipe, wait
from multiprocessing.process import BaseProcess
from typing import TypeVar

from extrados import interrupts

Given = TypeVar("Given")
LONGEST = 3600.0  # s: a task that takes longer hangs
_LOOK = 0.1  # s between two looks for signals that came


class Lost(Exception):
    """A process ended before its task; the text says how."""


def side_by_side(tasks: list[Callable[[], Given]], workers: int, longest: float = LONGEST) -> list[Given]:
    """What the tasks give, in their order, each computed in a process of its own, `workers` of them at a time.

    What a task raises is raised here. Lost: its process was killed, or took more than `longest` [s]. KeyboardInterrupt: a
    signal asked to stop. The other processes are killed then. Nothing is shared with them but a pipe each, so that one which is
    killed leaves no lock behind for which others would wait.
    """
    given: dict[int, Given] = {}
    running: dict[Connection, tuple[int, BaseProcess, float]] = {}
    todo, asked = list(enumerate(tasks)), len(interrupts.asked)
    try:
        while todo or running:
            while todo and len(running) < workers:
                i, task = todo.pop(0)
                pipe, process = _begun(task)
                running[pipe] = i, process, time.monotonic()
            for ended in wait(list(running), _LOOK):
                assert isinstance(ended, Connection)
                pipe = ended
                i, process, _ = running[pipe]
                try:
                    value, error = pipe.recv()
                except (EOFError, OSError):
                    process.join(_LOOK)
                    raise Lost(
                        f"the process that draws the figures ended with exit code {process.exitcode} (-9: often a lack of memory)"
                    ) from None
                _end(pipe, process)
                del running[pipe]
                if error is not None:
                    raise error
                given[i] = value
            if len(interrupts.asked) > asked:  # a handler may note a signal and go on
                raise KeyboardInterrupt
            if any(time.monotonic() - begin > longest for _, _, begin in running.values()):
                raise Lost(f"the process that draws the figures did not end within {longest:g} s")
    finally:
        for pipe, (_, process, _) in running.items():
            process.kill()
            _end(pipe, process)
    return [given[i] for i in range(len(tasks))]


def _begun(task: Callable[[], Given]) -> tuple[Connection, BaseProcess]:
    """Our end of the pipe of a new process that computes a task, and the process."""
    ours, theirs = Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=_compute, args=(task, theirs, os.getpid()), daemon=True)
    with warnings.catch_warnings(), theirs:
        # Python warns of the idle threads of the numerical libraries, which drawing does not use
        warnings.filterwarnings("ignore", ".*multi-threaded.*fork", DeprecationWarning)
        # signals wait until the process has said how it answers them
        held = signal.pthread_sigmask(signal.SIG_BLOCK, interrupts.STOPS)
        try:
            process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, held)
    return ours, process


def _compute(task: Callable[[], Given], pipe: Connection, parent: int) -> None:
    """The process: the task, and what it gives or raises into the pipe."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is answered by the parent, which ends this process
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, interrupts.STOPS)
    interrupts.end_with(parent)
    try:
        told: tuple[Given | None, Exception | None] = task(), None
    except Exception as error:
        told = None, error
    pipe.send(told)
    pipe.close()


def _end(pipe: Connection, process: BaseProcess) -> None:
    """Leave no process behind; one that does not end by itself is killed."""
    pipe.close()
    process.join(5.0)
    if process.exitcode is None:
        process.kill()
        process.join(5.0)
