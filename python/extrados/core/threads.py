"""Threads that cannot leave the one who waits for them behind, whatever they find no room for."""

import _thread
import weakref
from collections.abc import Callable
from typing import Generic, TypeVar

Given = TypeVar("Given")
#: Between two looks whether a thread still lives [s]
_LOOK = 0.05


class _Life:
    """Held by a thread alone: gone with it."""

    __slots__ = ("__weakref__",)


class Worker(Generic[Given]):
    """A call in a thread of its own, begun when made; MemoryError where it could not begin.

    Not a threading.Thread, nor an executor of them: their start waits for ever, deaf to Ctrl-C, for a thread that found no
    memory to begin. Here such a thread is known by an object that went with it, which takes no memory to see.
    """

    def __init__(self, function: Callable[[], Given]) -> None:
        self._given: list[Given] = []
        self._error: BaseException | None = None
        begun, self._working = _thread.allocate_lock(), _thread.allocate_lock()
        begun.acquire()
        self._working.acquire()

        def work(_: _Life) -> None:
            begun.release()
            try:
                self._given.append(function())
            except BaseException as error:
                self._error = error
            finally:
                self._working.release()

        life = _Life()
        lives = weakref.ref(life)
        try:
            _thread.start_new_thread(work, (life,))
        except RuntimeError as error:  # the system has no room for its stack
            raise MemoryError(f"not enough memory: {error}") from None
        del life
        while not begun.acquire(timeout=_LOOK):
            if lives() is None and not begun.acquire(blocking=False):
                raise MemoryError("not enough memory: a thread could not begin")

    def over(self, seconds: float = _LOOK) -> bool:
        """Whether the call is over; waits for it so long at most."""
        if self._working.acquire(timeout=seconds):
            self._working.release()
            return True
        return False

    def result(self) -> Given:
        """What the call gave or raised; waits for it. Signals are answered meanwhile."""
        while not self.over():
            pass
        if self._error is not None:
            raise self._error
        return self._given[0]
