"""The first instructions of the command `extrados`: signals are answered before anything else is loaded."""

import gc
import os
import sys

from extrados import interrupts

MANY = 100_000  # objects made before garbage is looked for: a run makes as many within seconds, a short command never


def main() -> None:
    """Entry point of the `extrados` command."""
    interrupts.answer(interrupts.leave)
    # What imports make stays: looking through it for garbage every 700 objects takes a twentieth of a short command's time
    gc.set_threshold(MANY)
    # Looking for plugins of pydantic, which has none here, reads the metadata of every package that is installed
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # OpenBLAS takes a buffer for each thread as it is loaded; the threads are those of the core, and sums have one order
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from extrados.cli import main

    main()


if __name__ == "__main__":
    main()
    sys.exit()
