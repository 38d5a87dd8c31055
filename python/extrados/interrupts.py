"""Signals that ask the command to stop, from its first instruction to its exit code."""

import os
import signal
from collections.abc import Callable
from typing import Any

STOPS = (signal.SIGINT, signal.SIGTERM)
#: The numbers of those that came
asked: list[int] = []


def answer(handler: Callable[[int, Any], Any] | signal.Handlers) -> None:
    """Have every signal that asks to stop answered so."""
    for number in STOPS:
        signal.signal(number, handler)


def leave(number: int, _: object) -> None:
    """Leave at once: nothing has been begun yet that could be lost."""
    os.write(2, b"interrupted\n")
    os._exit(128 + number)


def stop(number: int, _: object) -> None:
    """End what is being done by KeyboardInterrupt."""
    asked.append(number)
    raise KeyboardInterrupt


def exit_code() -> int:
    """The exit code after a signal: 130 after Ctrl-C, 143 after SIGTERM."""
    return 128 + (asked[-1] if asked else signal.SIGINT)
