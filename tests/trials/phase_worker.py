"""A command that gets a signal as a phase of it begins.

phase_worker.py SIGNAL MODULE:FUNCTION COMMAND...     the words of a command after `extrados`
"""

import importlib
import os
import sys


def main() -> None:
    number, place = int(sys.argv[1]), sys.argv[2]
    sys.argv = ["extrados", *sys.argv[3:]]
    from extrados import __main__ as command

    name, _, path = place.partition(":")
    owner = importlib.import_module(name)
    *inner, title = path.split(".")
    for part in inner:
        owner = getattr(owner, part)
    real, pid = getattr(owner, title), os.getpid()
    sent = []

    def begun(*words, **options):
        if not sent and os.getpid() == pid:
            sent.append(1)
            os.kill(pid, number)
        return real(*words, **options)

    setattr(owner, title, begun)
    command.main()


if __name__ == "__main__":
    main()
