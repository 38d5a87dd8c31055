"""The progress of a long calculation on the terminal."""

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

EVERY = 5.0  # s between lines


def in_words(seconds: float) -> str:
    """A remaining time in words, rounded up."""
    for unit, length, most in (("s", 1.0, 90.0), ("min", 60.0, 90.0 * 60.0)):
        if seconds < most:
            return f"{math.ceil(seconds / length)} {unit}"
    return f"{seconds / 3600.0:.1f} h"


class Progress:
    """A bar on a terminal, plain lines every few seconds elsewhere, nothing before the first second; with the time left at the
    mean pace so far.

    console: makes the console when it is first needed; say: prints a line there.
    """

    def __init__(self, quiet: bool, console: "Callable[[], Console]", say: Callable[[str], None]):
        self.quiet, self._console, self._say = quiet, console, say
        self.begin = time.monotonic()
        self.last = self.begin - EVERY
        self.part: tuple[str, float, float] = ("", self.begin, 0.0)  # text, when it began and what was done by then
        self.bar: Any = None
        self.task: Any = None

    def __call__(self, done: float, total: float, text: str) -> None:
        now = time.monotonic()
        if text != self.part[0] or done < self.part[2]:
            self.part = (text, now, done)
        if self.quiet or now - self.begin < 1.0:
            return
        if self._console().is_terminal:
            if self.bar is None:
                from rich.progress import Progress as Bar

                # without its refreshing thread: a process with threads of its own draws its figures alone
                self.bar = Bar(console=self._console(), transient=True, auto_refresh=False)
                self.bar.start()
                self.task = self.bar.add_task(text, total=total)
            self.bar.update(self.task, completed=done, total=total, description=text, refresh=True)
        elif now - self.last > EVERY:
            self._say(f"{text}: {100 * done / max(total, 1e-300):.3g} %{self._left(now, done, total)}")
            self.last = now

    def _left(self, now: float, done: float, total: float) -> str:
        """Time left in words, nothing where no progress shows the pace."""
        _, begin, before = self.part
        if done <= before:
            return ""
        return f", about {in_words((now - begin) * (total - done) / (done - before))} left"

    def stop(self) -> None:
        """Take the bar away."""
        if self.bar is not None:
            self.bar.stop()
