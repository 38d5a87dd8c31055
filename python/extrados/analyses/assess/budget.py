"""The budget of an assessment: seconds of computing, and the errors by which it ends."""

import time

from extrados.analyses.batches import Unfinished
from extrados.core.errors import Cancelled

#: Strategies are stopped after this many budgets
STOPPED_AFTER = 1.0
#: Least share of the time on the clock that counts, however loaded the machine is
SHARED = 0.1


class Stopwatch:
    """Seconds of computing since the start: those of the clock, but those of the processor where other programs share it.

    A share of the clock always counts, because processes that this one waits for have time of their own.
    """

    def __init__(self) -> None:
        self.begun = time.monotonic(), time.process_time()

    def __call__(self) -> float:
        clock, processor = time.monotonic() - self.begun[0], time.process_time() - self.begun[1]
        return min(clock, max(processor, SHARED * clock))


class Interrupted(Exception):
    """The user has asked for the end."""


class OutOfTime(Exception):
    """The time limit has stopped a strategy."""


#: Errors that end a whole assessment; any other ends one strategy
ENDING = (Interrupted, Cancelled, Unfinished, MemoryError)
