"""The first instructions of the command `extrados`: signals are answered before anything else is loaded."""

import os
import signal
import sys


def _leave(number: int, _: object) -> None:
    """Nothing has been begun yet that could be lost."""
    os.write(2, b"interrupted\n")
    os._exit(128 + number)


def main() -> None:
    """Entry point of the `extrados` command."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _leave)
    # Looking for plugins of pydantic, which has none here, reads the metadata of every package that is installed
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from extrados.cli import main

    main()


if __name__ == "__main__":
    main()
    sys.exit()
