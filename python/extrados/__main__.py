"""The first instructions of the command `extrados`: signals are answered before anything else is loaded."""

import os
import sys

from extrados import interrupts


def main() -> None:
    """Entry point of the `extrados` command."""
    interrupts.answer(interrupts.leave)
    # Looking for plugins of pydantic, which has none here, reads the metadata of every package that is installed
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from extrados.cli import main

    main()


if __name__ == "__main__":
    main()
    sys.exit()
