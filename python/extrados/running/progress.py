"""How far a long computation is, told on the terminal."""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console


class Progress:
    """A bar on a terminal, plain lines every few seconds elsewhere, nothing before the first second.

    console: makes the console when it is first needed; say: prints a line there.
    """

    def __init__(self, quiet: bool, console: "Callable[[], Console]", say: Callable[[str], None]):
        self.quiet, self._console, self._say = quiet, console, say
        self.begin = self.last = time.monotonic()
        self.bar: Any = None
        self.task: Any = None

    def __call__(self, done: float, total: float, text: str) -> None:
        now = time.monotonic()
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
        elif now - self.last > 5.0:
            self._say(f"{text}: {100 * done / max(total, 1e-300):.0f} %")
            self.last = now

    def stop(self) -> None:
        """Take the bar away."""
        if self.bar is not None:
            self.bar.stop()
