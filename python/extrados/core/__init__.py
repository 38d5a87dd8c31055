"""The only importer of the compiled module: SI arrays in, statuses turned into exceptions."""

import os

if "OMP_WAIT_POLICY" not in os.environ:
    # libgomp reads it when it is loaded. Threads that wait poll about 20 us and then sleep; its default of 15 ms takes the
    # cores from the thread that is awaited where other processes run.
    os.environ.setdefault("GOMP_SPINCOUNT", "1000")

# As it is loaded, the OpenBLAS of scipy waits for ever for a buffer that finds no room: early, before memory is short
import scipy.linalg  # noqa: F401
