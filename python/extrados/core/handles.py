"""Objects that live in the core behind a handle: one owner each, closed once, never copied."""

import weakref
from types import TracebackType
from typing import Any, NoReturn, Self

from extrados import _core
from extrados.core.errors import check


def _drop(handle: int) -> None:
    """Give back what has no owner any more; a call that still uses it ends first."""
    _core.api_support.close_handle(handle, 1)


class Owner:
    """Owns an object of the core: close it, or use it in a `with`; forgotten ones are given back by themselves.

    The core checks the handle at every call: using a closed object, or one that another thread uses, raises
    HandleError and leaves everything as it is.
    """

    #: What it is, for messages.
    what = "object"

    def __init__(self, handle: int):
        self._handle = int(handle)
        self._release = weakref.finalize(self, _drop, self._handle)

    @property
    def handle(self) -> int:
        """The number by which the core knows it; 0 before it was made."""
        return getattr(self, "_handle", 0)

    @property
    def closed(self) -> bool:
        """True after `close`."""
        release = getattr(self, "_release", None)
        return release is None or not release.alive

    def close(self) -> None:
        """Give its memory back; HandleError while another thread uses it. Closing twice does nothing."""
        if self.closed:
            return
        check(_core.api_support.close_handle(self._handle, 0), f"closing the {self.what}")
        self._release.detach()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is None:
            self.close()
        else:
            self._release()  # a call that was left behind may still use it, and must not hide the error

    def _refuse(self) -> NoReturn:
        raise TypeError(f"this {self.what} cannot be copied or pickled, because it exists only in the core: create another one")

    def __copy__(self) -> NoReturn:
        self._refuse()

    def __deepcopy__(self, memo: dict[int, Any]) -> NoReturn:
        self._refuse()

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        self._refuse()
