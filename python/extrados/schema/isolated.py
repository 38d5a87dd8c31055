"""Commands that start this Python again, without the modules of the folder that it is started in."""

import os
import sys


def python_command(module: str, *arguments: str) -> list[str]:
    """The command that runs a module of this installation: the current folder is not on its path of modules (`-P`)."""
    return [sys.executable, "-P", "-m", module, *arguments]


def environment(**more: str) -> dict[str, str]:
    """The environment for such a command, with `more`.

    An empty entry of PYTHONPATH means the current folder: such entries are removed.
    """
    given = {**os.environ, **more}
    if path := given.get("PYTHONPATH"):
        given["PYTHONPATH"] = os.pathsep.join(entry for entry in path.split(os.pathsep) if entry)
    return given
