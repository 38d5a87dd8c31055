"""How Python calls the core: arrays checked at the door, long calls that Ctrl-C can stop."""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from extrados import _core, interrupts
from extrados.core.errors import Cancelled, check, status_code
from extrados.core.threads import Worker

check(_core.api_support.init_libraries(), "loading the core")
# numpy's own BLAS ends the process where a buffer finds no room: its threads and we take theirs here, not amid a long run
np.ones((512, 16)) @ np.ones((16, 512))
np.linalg.solve(np.eye(2), np.ones(2))

#: Values an answer of the core may have: 2 GB.
MOST_VALUES = 250_000_000
_MOST_THREADS = max(64, os.cpu_count() or 1)


def real(name: str, value: npt.ArrayLike, shape: tuple[int | None, ...]) -> npt.NDArray[np.float64]:
    """`value` as a finite float64 array of a shape in Fortran order; None in `shape`, as in (None, 2), leaves a length open."""
    array = np.asfortranarray(value, dtype=np.float64)
    if array.ndim != len(shape) or any(want is not None and have != want for have, want in zip(array.shape, shape, strict=True)):
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name} is not finite at {where}")
    return array


def real_each(name: str, value: npt.ArrayLike, count: int) -> np.ndarray:
    """`value`, one for all elements or one for each, as a vector (count)."""
    return real(name, np.broadcast_to(np.asarray(value, dtype=float), (count,)).copy(), (count,))


def integers(name: str, value: npt.ArrayLike, length: int | None = None) -> npt.NDArray[np.int32]:
    """`value` as a vector (length) of int32; refuses fractions, which f2py would cut off silently."""
    array = np.asarray(value)
    if array.ndim != 1 or (length is not None and array.size != length):
        raise ValueError(f"{name} has shape {array.shape}, expected ({length},)")
    return _whole(name, array)


def indices(name: str, value: npt.ArrayLike, end: int, shape: tuple[int | None, ...]) -> npt.NDArray[np.int32]:
    """`value`, 0-based indices below `end`, as the core counts them, from 1, in Fortran order; IndexError for others.

    None in `shape`, as in (None, 2), leaves a length open.
    """
    array = np.asarray(value)
    if array.ndim != len(shape) or any(want is not None and have != want for have, want in zip(array.shape, shape, strict=True)):
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.size == 0:
        return np.zeros(array.shape, dtype=np.int32, order="F")
    bad = (array < 0) | (array >= end)
    if bad.any():
        raise IndexError(f"{name} contains the index {array[bad][0]}, expected 0 to {end - 1}")
    return np.asfortranarray(_whole(name, array) + np.int32(1))


def _whole(name: str, array: npt.NDArray[Any]) -> npt.NDArray[np.int32]:
    if array.dtype.kind not in "iu" and array.size:
        raise TypeError(f"{name} holds {array.dtype}, expected integers")
    if array.size and (array.max() > _INT32.max or array.min() < _INT32.min):
        raise ValueError(f"{name} contains a number that is too large")
    return np.ascontiguousarray(array, dtype=np.int32)


_INT32 = np.iinfo(np.int32)


def stack_rows(*rows: np.ndarray) -> np.ndarray:
    """Arrays by element (m) as the `rows` (n, m) of one, in Fortran order."""
    return np.asfortranarray(np.stack(rows))


def room_for(*lengths: int) -> None:
    """ValueError where an answer of these lengths would be larger than MOST_VALUES."""
    if float(np.prod([float(n) for n in lengths])) > MOST_VALUES:
        raise ValueError(f"{' x '.join(map(str, lengths))} values exceed the limit of {MOST_VALUES:,}: use smaller batches")


def thread_count(threads: int) -> int:
    """Threads to start: as asked, but not more than 64 or the machine's cores. Results do not depend on it."""
    if threads < 1:
        raise ValueError(f"threads is {threads}, expected at least 1")
    return min(int(threads), _MOST_THREADS)


_lock = threading.Lock()
_nesting = 0


def cancel_requested() -> bool:
    """True once the user asked to stop, while `interruptible` lasts."""
    return bool(_core.api_support.cancel_requested())


def stop_if_asked() -> None:
    """Cancelled where the user has asked for the end: for what takes long outside the core."""
    if cancel_requested():
        raise Cancelled(status_code("cancelled"), "interrupted")


def _ask(number: int = 0, _: object = None) -> None:
    interrupts.asked.append(number)
    _core.api_support.set_cancel(1)


class Deadline:
    """Tells whether the time of `within` has run out."""

    def __init__(self) -> None:
        self.over = threading.Event()

    @property
    def passed(self) -> bool:
        """Whether it has run out."""
        return self.over.is_set()


#: Between two looks of a deadline that has passed at computations that began since [s]
_AGAIN = 0.05


@contextlib.contextmanager
def within(seconds: float, clock: Callable[[], float] = time.monotonic) -> Iterator[Deadline]:
    """Stop what the core computes in this block once the seconds are over, as Ctrl-C would; the Deadline then says so.

    clock: counts the seconds, no faster than time passes.
    """
    deadline, left = Deadline(), threading.Event()
    end = clock() + seconds

    def watch() -> None:
        while (rest := end - clock()) > 0.0:
            if left.wait(rest):
                return
        deadline.over.set()
        while not left.wait(_AGAIN):
            _core.api_support.set_cancel(1)

    watcher = Worker(watch)
    try:
        yield deadline
    finally:
        left.set()
        watcher.result()
        if deadline.passed:
            _core.api_support.set_cancel(0)


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """While this lasts, Ctrl-C and SIGTERM set the core's cancel flag.

    In the main thread they do nothing else, and their handlers come back after; to them goes a signal that came too late for
    anything to look at it. Another thread may not touch Python's handlers: there the core looks at the signals itself and
    hands them on, so that Python answers them as ever, but the computation does not go on unseen.
    """
    global _nesting
    main = threading.current_thread() is threading.main_thread()
    with _lock:
        _nesting += 1
        if _nesting == 1:
            _core.api_support.set_cancel(0)
    before: dict[signal.Signals, Any] = {}
    signals = len(interrupts.asked)
    if main:
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, _ask)
    else:
        _core.api_support.watch_signals(1)
    try:
        yield
    finally:
        if not main:
            _core.api_support.watch_signals(0)
        for number, handler in before.items():
            signal.signal(number, handler)
        if before:  # another thread may rely on the core's look at the signals, which ours took the place of
            _core.api_support.watch_signals(1)
            _core.api_support.watch_signals(0)
        with _lock:
            _nesting -= 1
            late = _nesting == 0 and main and bool(_core.api_support.cancel_unheard())
            if _nesting == 0:  # what begins later was not asked to stop
                _core.api_support.set_cancel(0)
        if late and len(interrupts.asked) > signals:
            signal.raise_signal(interrupts.asked.pop())


def long_call(function: Callable[..., Any], *args: Any, **keywords: Any) -> Any:
    """Call a facade that may run long: in a thread of its own, so that signals reach Python meanwhile."""
    with interruptible():
        return Worker(lambda: function(*args, **keywords)).result()
