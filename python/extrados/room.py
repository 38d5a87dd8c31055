"""Room for the OpenBLAS that SciPy brings: it is loaded with the first analysis that needs it, takes a buffer for each of
its threads as it loads, and where the system has none left it asks for ever. Importing this installs the look at it."""

import errno
import mmap
import os
import re
import sys
from collections.abc import Sequence
from types import ModuleType

#: Packages of SciPy with modules that are linked with it
_USERS = {
    f"scipy.{name}" for name in ("integrate", "interpolate", "linalg", "odr", "optimize", "sparse.linalg", "special")
}
#: What the libraries take themselves; the buffer of a thread; less than this is short [bytes of address space]
_LIBRARIES, _BUFFER, _SHORT = 128 << 20, 32 << 20, 16 << 20
#: Threads that the OpenBLAS of SciPy's wheels can have at most (MAX_THREADS of its configuration)
_MOST = 64
#: Where it looks for their number, the first above zero counts
_ASKED = ("OPENBLAS_NUM_THREADS", "OPENBLAS_DEFAULT_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS")


class _Finder:
    """Finds nothing; looks whether there is room before others find what loads it the first time."""

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        if fullname not in _USERS or _USERS & sys.modules.keys():
            return
        pieces = [_LIBRARIES, *[_BUFFER + _stack()] * _threads()]
        if not _has(*pieces):
            size = sum(pieces) >> 20
            raise MemoryError(f"not enough memory: SciPy's linear algebra takes about {size} MB of address space")


def _threads() -> int:
    """As many as OpenBLAS will start."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    asked = next(filter(None, map(_number, _ASKED)), cores)
    return min(asked, cores, _MOST)


def _number(name: str) -> int:
    """The number in a variable of the environment, as C's atoi reads it; 0 where there is none above zero."""
    found = re.match(r"[ \t\n\v\f\r]*\+?([0-9]{1,9})", os.environ.get(name, ""))
    return int(found[1]) if found else 0


def _stack() -> int:
    """Stack of a thread [bytes]; without a limit the C library gives 2 to 8 MB, depending on the processor."""
    if sys.platform == "win32":
        return 8 << 20
    import resource

    soft, _ = resource.getrlimit(resource.RLIMIT_STACK)
    return 8 << 20 if soft == resource.RLIM_INFINITY else soft


def _has(*pieces: int) -> bool:
    """Whether the system has room for so many bytes at once; they are neither kept nor touched.

    Pages that cannot be written would count to no limit but that of addresses. In pieces, because Linux refuses a single
    mapping that is larger than the whole memory, used or not.
    """
    if sys.platform == "win32":
        return True  # the look is one of POSIX
    held = []
    try:
        for size in pieces:
            held.append(mmap.mmap(-1, size, mmap.MAP_PRIVATE, mmap.PROT_READ | mmap.PROT_WRITE))
    except (OSError, ValueError, MemoryError):
        return False
    finally:
        for piece in held:
            piece.close()
    return True


def lacked(error: Exception) -> bool:
    """Whether it was memory that lacked though the error says something else, as Python and its libraries do."""
    if isinstance(error, OSError) and error.errno is not None:
        return error.errno == errno.ENOMEM
    if isinstance(error, ImportError | OSError) and "failed to map" in str(error):  # by the loader of libraries
        return True
    thread = isinstance(error, RuntimeError) and "can't start new thread" in str(error)
    return (thread or isinstance(error, SystemError | OSError | ImportError)) and not _has(_SHORT)


def words(error: Exception) -> str:
    """What is told of it; Python's own says nothing, numpy's only what it could not allocate."""
    said = str(error)
    return said if "not enough memory" in said else ": ".join(filter(None, ("not enough memory", said)))


if not any(type(finder).__module__ == __name__ for finder in sys.meta_path):  # a reload comes here again
    sys.meta_path.insert(0, _Finder())
