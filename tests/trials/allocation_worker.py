"""Lets every allocation of the core fail once, call by call; run with the shim preloaded, whose path is the argument."""

import ctypes
import gc
import json
import sys

from api_worker import _valid, bits

from extrados import _core


def main() -> None:
    shim = ctypes.CDLL(sys.argv[1])
    shim.shim_allocations.restype = ctypes.c_long
    shim.shim_allocations.argtypes = [ctypes.c_long]
    for function, keys in _valid():
        keys = {**keys, "threads": 1} if "threads" in keys else keys
        right = bits(function(**keys))
        shim.shim_allocations(-1)
        function(**keys)
        count = shim.shim_allocations(-1)
        wrong, ends = [], {}
        for k in range(count):
            gc.collect()
            before = _core.api_support.handle_count()
            print(f"{function.__name__} {k}", file=sys.stderr, flush=True)
            shim.shim_allocations(k)
            try:
                end = "result" if bits(function(**keys)) == right else "another result"
            except Exception as error:
                end = type(error).__name__
            shim.shim_allocations(-1)
            gc.collect()
            ends[end] = ends.get(end, 0) + 1
            if end not in ("result", "MemoryError", "CoreMemoryError"):
                wrong.append(f"allocation {k}: {end}")
            if _core.api_support.handle_count() != before:
                wrong.append(f"allocation {k}: an object is left in the core")
            if bits(function(**keys)) != right:
                wrong.append(f"allocation {k}: the next call gives other bits")
        print(json.dumps([function.__name__, count, ends, wrong]), flush=True)


if __name__ == "__main__":
    main()
