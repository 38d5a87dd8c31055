"""Whether memory lacked: the room that an analysis needs before it starts, and which errors are memory that lacked."""

import contextlib
import errno
import mmap
import os
import sys
from pathlib import Path

#: Address space that an analysis needs to start [bytes]. Libraries take theirs as they are loaded: where a buffer of OpenBLAS
#: finds no room, loading SciPy waits for ever. Found with 128 MB left at one thread (`extrados.__main__`), 96 to 128 MB at two.
NEEDED = 256 << 20
#: With less the system is short of memory [bytes of address space]
_SHORT = 16 << 20


def has(size: int) -> bool:
    """Whether the system has room for so many bytes; they are not touched.

    Writable and private, because other pages count to no limit but that of addresses.
    """
    if sys.platform == "win32":
        return True  # the mapping is one of POSIX
    try:
        mmap.mmap(-1, size, mmap.MAP_PRIVATE, mmap.PROT_READ | mmap.PROT_WRITE).close()
    except (OSError, ValueError, MemoryError):
        return False
    return True


def total() -> int:
    """Memory of the machine, or of the group of processes that this one belongs to, in bytes."""
    found = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    for limit in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        with contextlib.suppress(OSError, ValueError):
            found = min(found, int(Path(limit).read_text(encoding="ascii")))
    return found


def lacked(error: Exception) -> bool:
    """Whether it was memory that lacked though the error says something else, as Python and its libraries do."""
    if isinstance(error, OSError) and error.errno is not None:
        return error.errno == errno.ENOMEM
    if isinstance(error, ImportError | OSError) and "failed to map" in str(error):  # by the loader of libraries
        return True
    thread = isinstance(error, RuntimeError) and "can't start new thread" in str(error)
    return (thread or isinstance(error, SystemError | OSError | ImportError)) and not has(_SHORT)


def words(error: Exception) -> str:
    """The message on a lack of memory; the texts of Python and numpy do not suffice."""
    said = str(error)
    return said if "not enough memory" in said else ": ".join(filter(None, ("not enough memory", said)))
