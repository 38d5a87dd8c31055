"""Room for the OpenBLAS that SciPy brings: it is loaded with the first analysis that needs it, takes a buffer for each of
its threads as it loads, and where the system has none left it asks for ever."""

import mmap
import os
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

#: Addresses that a thread takes, buffer and stack; and what the libraries themselves do [bytes]
_THREAD, _LIBRARIES = 40 << 20, 128 << 20


class _Room(MetaPathFinder):
    """Finds nothing; looks whether there is room before others find SciPy's linear algebra."""

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        if fullname == "scipy.linalg":
            see_room(_LIBRARIES + _THREAD * _threads())


def _threads() -> int:
    """As many as OpenBLAS will take."""
    cores = os.cpu_count() or 1
    asked = os.environ.get("OPENBLAS_NUM_THREADS") or os.environ.get("OMP_NUM_THREADS") or ""
    return min(cores, int(asked)) if asked.isascii() and asked.isdigit() and int(asked) else cores


def see_room(size: int) -> None:
    """MemoryError where the system has not so many bytes of addresses left; they are not taken."""
    try:
        mmap.mmap(-1, size, mmap.MAP_PRIVATE, 0).close()
    except (OSError, ValueError):
        raise MemoryError(f"not enough memory: SciPy's linear algebra takes {size >> 20} MB of addresses") from None


sys.meta_path.insert(0, _Room())
