"""Calls in threads of their own, for which one can wait and still answer signals."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Given = TypeVar("Given")
#: Between two looks whether a call is over [s]
_LOOK = 0.05


class Worker(Generic[Given]):
    """A call in a thread of its own, begun when made; MemoryError where the system has no room for the thread."""

    def __init__(self, function: Callable[[], Given]) -> None:
        self._given: list[Given] = []
        self._error: BaseException | None = None

        def work() -> None:
            try:
                self._given.append(function())
            except BaseException as error:
                self._error = error

        self._thread = threading.Thread(target=work, daemon=True)
        try:
            self._thread.start()
        except RuntimeError as error:
            raise MemoryError(f"not enough memory: {error}") from None

    def over(self, seconds: float = _LOOK) -> bool:
        """Whether the call is over; waits for it so long at most."""
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def result(self) -> Given:
        """What the call gave or raised; waits for it. Signals are answered meanwhile."""
        while not self.over():
            pass
        if self._error is not None:
            raise self._error
        return self._given[0]
