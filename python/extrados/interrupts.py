"""Signals that ask the command to stop, from its first instruction to its exit code."""

import os
import signal
import sys
from collections.abc import Callable
from typing import Any

STOPS = (signal.SIGINT, signal.SIGTERM)
#: The numbers of those that came
asked: list[int] = []


def answer(handler: Callable[[int, Any], Any] | signal.Handlers) -> None:
    """Install a handler for all signals that request a stop."""
    for number in STOPS:
        signal.signal(number, handler)


def leave(number: int, _: object) -> None:
    """Leave at once: nothing has been begun yet that could be lost."""
    os.write(2, b"interrupted\n")
    os._exit(128 + number)


def stop(number: int, _: object) -> None:
    """Stop the present work by KeyboardInterrupt."""
    asked.append(number)
    raise KeyboardInterrupt


def insist() -> None:
    """Have a signal that Python let go unheard come again: KeyboardInterrupt raised amid a finaliser or a callback of the
    interpreter ends that alone, and Python prints that it was ignored."""

    def unheard(what: Any) -> None:
        if not (asked and isinstance(what.exc_value, KeyboardInterrupt)):
            sys.__unraisablehook__(what)
        elif hasattr(signal, "setitimer"):  # at once it would be unheard again
            signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(asked[-1]))
            signal.setitimer(signal.ITIMER_REAL, 0.01)

    sys.unraisablehook = unheard


def end_with(parent: int) -> None:
    """End this process once the process `parent`, which started it, has ended, however that ended."""
    import threading  # no instruction of the command goes before its answer to signals
    import time

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def exit_code() -> int:
    """The exit code after a signal: 130 after Ctrl-C, 143 after SIGTERM."""
    return 128 + (asked[-1] if asked else signal.SIGINT)
