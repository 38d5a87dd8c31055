"""Lets every allocation of the core fail once, call by call; run with the shim preloaded.

    allocation_worker.py SHIM [FUNCTION ...]

Prints a line of JSON for each function of core_calls: its name, the number of its allocations, how often the call ended
how, and what was wrong. Each failure is tried in a child, whose death ends nothing but itself. Of more than MOST
allocations, those are tried that are the first or the last of their place in the program.
"""

import ctypes
import gc
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

from api_worker import bits
from core_calls import valid_calls

from extrados import _core

shim = ctypes.CDLL(sys.argv[1])
shim.shim_allocations.restype = ctypes.c_long
shim.shim_allocations.argtypes = shim.shim_site.argtypes = [ctypes.c_long]
shim.shim_site.restype = ctypes.c_ulong
MOST = 400


def one(function: Callable[..., Any], keys: dict[str, Any], k: int, right: bytes) -> tuple[str, str]:
    """How a call ended whose allocation k failed, and what was wrong with that."""
    gc.collect()
    before = _core.api_support.handle_count()
    shim.shim_allocations(k)
    try:
        end = "result" if bits(function(**keys)) == right else "another result"
    except Exception as error:
        end = type(error).__name__
    shim.shim_allocations(-1)
    gc.collect()
    if end not in ("result", "MemoryError", "CoreMemoryError"):
        return end, end
    if _core.api_support.handle_count() != before:
        return end, "an object is left in the core"
    return end, "" if bits(function(**keys)) == right else "the next call gives other bits"


def in_children(function: Callable[..., Any], keys: dict[str, Any], todo: list[int], right: bytes) -> Iterator[tuple[int, str, str]]:
    """The same for many allocations, with their numbers; a child that dies is followed by one that goes on after it."""
    while todo:
        with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as told:
            child = os.fork()
            if child == 0:
                os.dup2(told.fileno(), 2)
                for k in todo:
                    os.ftruncate(2, 0)
                    os.lseek(2, 0, os.SEEK_SET)
                    end, wrong = one(function, keys, k, right)
                    place = os.pread(2, 1000, 0).decode(errors="replace").strip()
                    row = [k, end, f"{wrong} ({place})" if wrong else ""]
                    os.write(said.fileno(), json.dumps(row).encode() + b"\n")
                os._exit(0)
            _, status = os.waitpid(child, 0)
            said.seek(0)
            told.seek(0)
            rows = [json.loads(line) for line in said]
            place = told.read().decode(errors="replace").strip()
        yield from rows
        todo = todo[len(rows) :]
        if todo:
            yield todo.pop(0), f"signal {os.WTERMSIG(status)}", f"dies ({place})"


def main() -> None:
    for function, keys in valid_calls():
        if sys.argv[2:] and function.__name__ not in sys.argv[2:]:
            continue
        keys = {**keys, "threads": 1} if "threads" in keys else keys
        right = bits(function(**keys))
        shim.shim_allocations(-1)
        function(**keys)
        count = shim.shim_allocations(-1)
        wrong, ends = [], {}
        sites = [shim.shim_site(k) for k in range(count)]
        ends_of = {sites.index(s) for s in set(sites)} | {count - 1 - sites[::-1].index(s) for s in set(sites)}
        todo = list(range(count)) if count <= MOST else sorted(ends_of)
        for k, end, why in in_children(function, keys, todo, right):
            ends[end] = ends.get(end, 0) + 1
            if why:
                wrong.append(f"allocation {k}: {why}")
        print(json.dumps([function.__name__, sum(ends.values()), ends, wrong]), flush=True)


if __name__ == "__main__":
    main()
