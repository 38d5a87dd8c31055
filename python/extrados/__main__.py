"""The first instructions of the command `extrados`: signals are answered before anything else is loaded."""

import sys

from extrados import interrupts


def main() -> None:
    """Entry point of the `extrados` command."""
    interrupts.answer(interrupts.leave)
    from extrados.cli import main

    main()


if __name__ == "__main__":
    main()
    sys.exit()
