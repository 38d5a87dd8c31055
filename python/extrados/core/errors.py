"""The only place where a status of the compiled core becomes an exception."""

from functools import cache

from extrados import _core


class CoreError(RuntimeError):
    """The core refused or could not finish; `status` is its code, see c/include/extrados_status.h."""

    def __init__(self, status: int, text: str):
        super().__init__(text)
        self.status = status


class CoreMemoryError(CoreError, MemoryError):
    """The core ran out of memory."""


class Cancelled(CoreError):
    """The user asked to stop; results up to that point are valid."""


@cache
def status_list() -> dict[int, tuple[str, str]]:
    """Code -> (name, text), as compiled into the core."""
    entries = {}
    index = 0
    while True:
        found, code, name, text = _core.api_support.status_entry(index)
        if not found:
            return entries
        entries[code] = tuple(s.decode().rstrip("\0 ").split("\0")[0] for s in (name, text))
        index += 1


@cache
def status_code(name: str) -> int:
    """The code of a status by its name."""
    return next(code for code, (known, _) in status_list().items() if known == name)


def check(status: int, what: str) -> None:
    """Raise unless status is 0; `what` says what was being computed."""
    if status == 0:
        return
    name, text = status_list().get(status, ("unknown", f"unknown status {status}"))
    kind = {"cancelled": Cancelled, "out_of_memory": CoreMemoryError}.get(name, CoreError)
    raise kind(status, f"{what}: {text}")
