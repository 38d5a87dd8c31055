"""Lets every write of a command fail once; run with the shim preloaded.

    write_worker.py SHIM STRIDE COMMAND...     the words of a command after `extrados`, which ends with --out FOLDER

Prints a line of JSON for each failure: its number, the exit code, what was said, and the files left beside the folder
that were not there before. Each is tried in a child, first into no folder, then into one that holds earlier results.
"""

import ctypes
import json
import os
import shutil
import sys
import tempfile
import traceback
from pathlib import Path

from extrados import cli
from extrados.results import store

shim = ctypes.CDLL(sys.argv[1])
shim.shim_writes.restype = ctypes.c_long
shim.shim_writes.argtypes = [ctypes.c_long]


def child(words: list[str], k: int) -> tuple[int, str, int]:
    """Exit code, what was said, and the writes of a command whose write k fails (-1 none)."""
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as counted:
        number = os.fork()
        if number == 0:
            os.dup2(said.fileno(), 1)
            os.dup2(said.fileno(), 2)
            sys.argv = ["extrados", *words]
            shim.shim_writes(k)
            code = 99
            try:
                cli.main()
            except SystemExit as left:
                code = int(left.code or 0)
            except BaseException:
                traceback.print_exc()
            finally:
                count = shim.shim_writes(-1)
                os.write(counted.fileno(), str(count).encode())
                os._exit(code)
        _, status = os.waitpid(number, 0)
        said.seek(0)
        counted.seek(0)
        text = said.read().decode(errors="replace")
        return os.waitstatus_to_exitcode(status), text, int(counted.read() or b"-1")


def state(out: Path) -> str:
    """What a folder holds: nothing, whole results, or something else."""
    if not out.exists():
        return "nothing"
    try:
        store.read(out)
    except store.StoreError as error:
        return f"damaged: {error}"
    return "whole"


def main() -> None:
    stride, words = int(sys.argv[2]), sys.argv[3:]
    out = Path(words[-1])
    beside = {p.name for p in out.parent.iterdir()}
    code, text, count = child(words, -1)
    assert code == 0, text
    shutil.copytree(out, earlier := out.with_name("earlier"))
    for before in (False, True):
        for k in range(0, count, stride):
            shutil.rmtree(out, ignore_errors=True)
            if before:
                shutil.copytree(earlier, out)
            code, text, _ = child(words, k)
            left = sorted({p.name for p in out.parent.iterdir()} - beside - {out.name, earlier.name})
            print(json.dumps([k, before, code, text[-300:], state(out), left]), flush=True)
            for name in left:
                place = out.with_name(name)
                shutil.rmtree(place) if place.is_dir() else place.unlink()
    shutil.rmtree(earlier)


if __name__ == "__main__":
    main()
