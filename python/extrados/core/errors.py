"""The only place where a status of the compiled core becomes an exception."""

from functools import cache

from extrados.core import lists


class CoreError(RuntimeError):
    """The core refused or could not finish; `status` is its code, see c/include/extrados_status.h."""

    def __init__(self, status: int, text: str):
        super().__init__(text)
        self.status = status


class CoreMemoryError(CoreError, MemoryError):
    """The core ran out of memory."""


class Cancelled(CoreError):
    """The user asked to stop; results up to that point are valid."""


class HandleError(CoreError):
    """An object of the core was closed, is of another kind, is in use by another call, or not yet built."""


class CoreIndexError(CoreError, IndexError):
    """A number given to the core names no node, body, motion, law ... that is there."""


_KINDS: dict[str, type[CoreError]] = {
    "cancelled": Cancelled,
    "out_of_memory": CoreMemoryError,
    "bad_index": CoreIndexError,
    "closed_handle": HandleError,
    "wrong_handle": HandleError,
    "busy": HandleError,
    "not_ready": HandleError,
}


@cache
def status_list() -> dict[int, tuple[str, str]]:
    """Code -> (name, text), as compiled into the core."""
    return {entry.number: (entry.name, entry.word) for entry in lists.entries("status")}


@cache
def status_code(name: str) -> int:
    """The code of a status by its name."""
    return lists.number("status", name)


def check(status: int, what: str) -> None:
    """Raise unless status is 0; `what` says what was being computed."""
    if status == 0:
        return
    name, text = status_list().get(status, ("unknown", f"unknown status {status}"))
    raise _KINDS.get(name, CoreError)(status, f"{what}: {text}")
