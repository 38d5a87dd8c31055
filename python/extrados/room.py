"""Room for the OpenBLAS that SciPy brings: it is loaded with the first analysis that needs it, takes a buffer for each of
its threads as it loads, and where the system has none left it asks for ever."""

import mmap
import os
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

#: Packages of SciPy with modules that are linked with it
_USERS = {
    f"scipy.{name}" for name in ("integrate", "interpolate", "linalg", "odr", "optimize", "sparse.linalg", "special")
}
#: Addresses that a thread takes, buffer and stack; what the libraries themselves do; less than this is short [bytes]
_THREAD, _LIBRARIES, _SHORT = 40 << 20, 128 << 20, 16 << 20


class _Room(MetaPathFinder):
    """Finds nothing; looks whether there is room before others find what loads it the first time."""

    seen = False

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        if fullname in _USERS and not self.seen:
            size = _LIBRARIES + _THREAD * _threads()
            if not _has(size):
                raise MemoryError(f"not enough memory: SciPy's linear algebra takes {size >> 20} MB of addresses")
            self.seen = True  # it stays in the list, which is being walked through


def _threads() -> int:
    """As many as OpenBLAS will take."""
    cores = os.cpu_count() or 1
    asked = os.environ.get("OPENBLAS_NUM_THREADS") or os.environ.get("OMP_NUM_THREADS") or ""
    return min(cores, int(asked)) if asked.isascii() and asked.isdigit() and int(asked) else cores


def _has(size: int) -> bool:
    """Whether the system has so many bytes of addresses left; they are not taken."""
    try:
        mmap.mmap(-1, size, mmap.MAP_PRIVATE, 0).close()
    except (OSError, ValueError, MemoryError):
        return False
    return True


def is_short() -> bool:
    """Whether memory is so short that whatever else failed will have failed for it: Python and its libraries then raise
    SystemError, OSError, ImportError and others."""
    return not _has(_SHORT)


sys.meta_path.insert(0, _Room())
