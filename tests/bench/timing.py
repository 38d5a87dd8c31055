"""Timing of one call: the median of several."""

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
