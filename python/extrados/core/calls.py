"""How Python calls the core: arrays checked at the door, long calls that Ctrl-C can stop."""

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator

import numpy as np

from extrados import _core

_core.api_support.init_libraries()


def real(name: str, value, shape: tuple[int | None, ...]) -> np.ndarray:
    """`value` as a finite float64 array in Fortran order; None in `shape` leaves a length open."""
    array = np.asfortranarray(value, dtype=np.float64)
    if array.ndim != len(shape) or any(
        want is not None and have != want for have, want in zip(array.shape, shape, strict=True)
    ):
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name} is not finite at {where}")
    return array


def integers(name: str, value, length: int | None = None) -> np.ndarray:
    """`value` as an int32 vector; refuses fractions, which f2py would cut off silently."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} holds {array.dtype}, expected integers")
    if array.ndim != 1 or (length is not None and array.size != length):
        raise ValueError(f"{name} has shape {array.shape}, expected ({length},)")
    return np.ascontiguousarray(array, dtype=np.int32)


_lock = threading.Lock()
_nesting = 0
_asked = threading.Event()


def cancel_requested() -> bool:
    """True once the user asked to stop, while `interruptible` lasts."""
    return _asked.is_set()


def _ask(*_: object) -> None:
    _asked.set()
    _core.api_support.set_cancel(1)


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """While this lasts, Ctrl-C and SIGTERM only set the core's cancel flag; the handlers come back after."""
    global _nesting
    main = threading.current_thread() is threading.main_thread()
    with _lock:
        _nesting += 1
        outermost = _nesting == 1
        if outermost:
            _asked.clear()
            _core.api_support.set_cancel(0)
    before = {}
    if main and outermost:
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, _ask)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        with _lock:
            _nesting -= 1


def long_call(function: Callable, *args, **keywords):
    """Call a facade that may run long: in a thread of its own, so that signals reach Python meanwhile.

    Waiting on an Event, not on Thread.join: an interrupted join lies about the thread on CPython
    3.9 to 3.12 (python/cpython#90882).
    """
    done = threading.Event()
    box: dict = {}

    def work() -> None:
        try:
            box["value"] = function(*args, **keywords)
        except BaseException as error:
            box["error"] = error
        finally:
            done.set()

    with interruptible():
        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        while not done.wait(0.05):
            pass
        thread.join()
    if "error" in box:
        raise box["error"]
    return box["value"]
