"""Timing of one call."""

import statistics
import time
from collections.abc import Callable


def seconds(call: Callable[[], object], runs: int = 5) -> float:
    """Median wall time of a call after one warm-up [s]."""
    call()
    found = []
    for _ in range(runs):
        begin = time.perf_counter()
        call()
        found.append(time.perf_counter() - begin)
    return statistics.median(found)


def processor(call: Callable[[], object], runs: int = 5) -> float:
    """Least processor time of a call after one warm-up [s]: what others do on the machine counts little."""
    call()
    found = []
    for _ in range(runs):
        begin = time.process_time()
        call()
        found.append(time.process_time() - begin)
    return min(found)
