"""Stop a call of the core while it computes."""

import threading
import time
from collections.abc import Callable


def interrupted(long_call: Callable, seconds: float, stop: Callable[[], object]) -> Callable:
    """`long_call` that calls `stop` from another thread once the core has used `seconds` of processor time.

    Processor time, and counted from inside the call: wall time says nothing of how far a busy machine has come.
    """

    def call(function: Callable, *args, **keywords):
        over = threading.Event()

        def watch() -> None:
            begin = time.process_time()
            while not over.wait(0.01):
                if time.process_time() - begin > seconds:
                    stop()
                    return

        def work(*a, **k):
            watcher = threading.Thread(target=watch, daemon=True)
            watcher.start()
            try:
                return function(*a, **k)
            finally:
                over.set()
                watcher.join()

        return long_call(work, *args, **keywords)

    return call
