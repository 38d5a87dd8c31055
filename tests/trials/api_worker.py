"""Calls the core's Python API with arguments that are wrong at random; prints the number of each call before it is made.

    api_worker.py SEED FIRST COUNT
    api_worker.py unreached             which functions of the core it does not come to

Every call must end with a result or an exception; after it the core must still give the right bits. What would end the
process ends this one, and the last number tells where.
"""

import faulthandler
import random
import signal
import sys
from typing import Any

import numpy as np
from core_calls import valid_calls

from extrados import _core


def spoiled(value: Any, rng: random.Random) -> Any:
    """An argument that is wrong, or odd."""
    array = np.array(value) if not isinstance(value, str) and value is not None else np.zeros(3)
    flat = array.astype(float, copy=True) if array.dtype.kind in "iufb" else np.zeros(3)
    if flat.ndim and flat.size and rng.random() < 0.5:  # one entry
        k = rng.randrange(flat.size)
        put = rng.choice((-1, -2, 0, 1, 3, 4, 9, 77, 2**31 - 1, -(2**31), 2**40, 1e300, 5e-324, 1e-9, 0.5, np.nan, np.inf, -np.inf))
        if array.dtype.kind in "iu" and np.isfinite(put) and abs(put) < 2**62 and put == int(put):
            whole = array.astype(np.int64, copy=True)
            whole.flat[k] = int(put)
            return whole
        flat.flat[k] = put
        return flat
    return rng.choice(
        (
            None,
            "",
            "x",
            b"x",
            True,
            -1,
            0,
            1,
            2,
            3,
            64,
            10**6,
            2**31 - 1,
            -(2**31),
            2**63,
            10**30,
            0.5,
            -0.5,
            1e300,
            -1e300,
            5e-324,
            np.nan,
            np.inf,
            1j,
            [],
            [[]],
            {},
            (),
            [None],
            ["a"],
            object(),
            np.zeros(0),
            np.zeros((0, 2)),
            np.zeros((2, 0)),
            np.zeros((1, 1, 1)),
            np.ones(1),
            np.ones(2),
            np.ones((3, 3)),
            np.ones((4, 2)),
            np.array(2),
            np.array("x"),
            flat.T,
            np.flip(flat),
            flat.ravel(),
            flat.astype(np.float32),
            flat.astype(complex),
            flat.astype(object),
            np.asfortranarray(flat),
            np.concatenate([flat.ravel()] * 2),
            flat.ravel()[:-1],
            np.broadcast_to(np.float64(1.0), (4, 2)),
            np.ma.masked_array(flat, flat > 0),
            flat * 1e18,
            -flat,
            flat.tolist(),
        )
    )


def bits(value: Any) -> bytes:
    """The bytes of a result."""
    if isinstance(value, dict):
        return b"".join(bits(v) for _, v in sorted(value.items()))
    if isinstance(value, tuple | list):
        return b"".join(map(bits, value))
    return repr(value).encode() if isinstance(value, str) else np.asarray(value).tobytes()


PATIENCE = 3.0  # seconds of the processor; then a call is asked to stop, as by Ctrl-C: it may have an age to compute
HANG = 120.0  # seconds; a call that does not stop then ends the process, with the place where it was


class Watched:
    """A module of the compiled core that notes which of its functions are asked for."""

    def __init__(self, module: Any, name: str, seen: set[str]):
        self._module, self._name, self._seen = module, name, seen

    def __getattr__(self, function: str) -> Any:
        self._seen.add(f"{self._name}.{function}")
        return getattr(self._module, function)


def unreached() -> list[str]:
    """Functions of the compiled core that no valid call comes to."""
    seen: set[str] = set()
    there = {name: getattr(_core, name) for name in dir(_core) if name.startswith("api_")}
    for name, module in there.items():
        setattr(_core, name, Watched(module, name, seen))
    for function, keys in valid_calls():
        function(**keys)
    every = {f"{name}.{f}" for name, module in there.items() for f in dir(module) if not f.startswith("_")}
    return sorted(every - seen)


def main() -> None:
    signal.signal(signal.SIGPROF, lambda *_: _core.api_support.set_cancel(1))
    seed, first, count = map(int, sys.argv[1:])
    np.seterr(all="ignore")
    calls = valid_calls()
    right = [bits(function(**keys)) for function, keys in calls]
    for number in range(first, first + count):
        rng = random.Random(seed * 1_000_003 + number)
        k = rng.randrange(len(calls))
        function, keys = calls[k]
        changed = dict(keys)
        names = rng.sample(sorted(keys), rng.choice((1, 1, 1, 2, 3)))
        for name in names:
            changed[name] = spoiled(keys[name], rng)
        told = ", ".join(f"{name}={changed[name]!r:.60}".replace("\n", " ") for name in names)
        print(f"{number}\t{function.__name__}({told})", end="\t", flush=True)
        signal.setitimer(signal.ITIMER_PROF, PATIENCE, PATIENCE)
        faulthandler.dump_traceback_later(HANG, exit=True)
        try:
            function(**changed)
            end = "result"
        except MemoryError:
            end = "MemoryError"
        except Exception as error:
            end = type(error).__name__
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        faulthandler.cancel_dump_traceback_later()
        if number % 20 == 0 and bits(calls[k][0](**calls[k][1])) != right[k]:
            end = "WRONG: the core no longer gives the right bits"
        print(end, flush=True)
    print("end", flush=True)


if __name__ == "__main__":
    print(*unreached(), sep="\n") if sys.argv[1:] == ["unreached"] else main()
