"""Files of foreign formats are read by a process of their own, with limits: what a hostile file does to a library ends there.

The process gets the content and gives back values and arrays, which are checked for their size; it opens few files, writes none,
and has limits of memory and of the processor's time. What it raises as Unreadable is raised here.
"""

import importlib
import io
import json
import os
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

from extrados.schema.isolated import environment, python_command

#: Memory [bytes] and time of the processor [s] that are left to a reader; both grow with the file
ROOM, ROOM_PER_BYTE = 1_000_000_000, 12
SECONDS, SECONDS_PER_BYTE = 30, 1e-6
#: A reader that has not ended after so many times its time of the processor waits for something
PATIENCE = 20
LARGEST = 2_000_000_000  # bytes that a reader may give
FILES = 4  # that are open at a time: numpy and HDF5 open one twice
ARRAY = "\0array"  # the key under which an array's number stands; no text of a file begins so
TUPLE = "\0tuple"


class Unreadable(Exception):
    """The file cannot be read; the text says why, `at` is the key of the deck that is to blame where there is one."""

    def __init__(self, text: str, at: tuple[str | int, ...] = ()):
        super().__init__(text)
        self.at = at


def read_contained(reader: str, source: bytes | Path, **options: Any) -> Any:
    """What a function of this package, "module:function", finds in the content of a file; Unreadable says why it finds nothing.

    The function is given the content, or the path where that is given, and the options; it returns numbers, texts, arrays, and
    lists, tuples and dictionaries of them.
    """
    content = source if isinstance(source, bytes) else b""
    size = len(content) if isinstance(source, bytes) else source.stat().st_size
    room, seconds = ROOM + ROOM_PER_BYTE * size, SECONDS + int(SECONDS_PER_BYTE * size)
    path = None if isinstance(source, bytes) else str(source)
    given = json.dumps({"reader": reader, "path": path, "options": options, "room": room, "seconds": seconds})
    with tempfile.TemporaryFile() as file:  # a pipe of an unread content would block
        file.write(content)
        file.seek(0)
        child = subprocess.Popen(
            python_command("extrados.schema.contained", given), stdin=file, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, env=environment(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1"),
        )  # fmt: skip
    assert child.stdout is not None
    late = threading.Timer(PATIENCE * seconds, child.kill)
    late.daemon = True
    late.start()
    try:
        answer = b"".join(_pieces(child.stdout))
    finally:
        late.cancel()
        child.stdout.close()  # a reader that would give more ends by that
        if sys.exc_info()[0] is not None:
            child.kill()
        code = child.wait()
    if len(answer) > LARGEST:
        raise Unreadable(f"gives more than {LARGEST / 1e6:.0f} MB of numbers")
    if not answer:
        raise Unreadable(_reason(code, room, seconds))
    found = decode(answer)
    if "refused" in found:
        raise Unreadable(found["refused"], tuple(found["at"]))
    return found["value"]


def _pieces(stream: IO[bytes]) -> Iterator[bytes]:
    """What comes from a stream, up to LARGEST bytes and a piece."""
    size = 0
    while size <= LARGEST and (piece := stream.read(1 << 20)):
        size += len(piece)
        yield piece


def _reason(code: int, room: int, seconds: int) -> str:
    if code == -signal.SIGXCPU:
        return f"takes more than {seconds} s to be read"
    if code == -signal.SIGKILL:
        return f"cannot be read with {room / 1e6:.0f} MB of memory in the time that is left to it"
    return f"cannot be read: its reader ended with code {code}"


def encode(value: Any) -> bytes:
    """Values, lists, tuples, dictionaries and arrays of numbers as bytes: JSON, then the arrays in numpy's format."""
    arrays = io.BytesIO()
    count = 0

    def plain(one: Any) -> Any:
        nonlocal count
        if isinstance(one, np.ndarray):
            np.save(arrays, one, allow_pickle=False)
            count += 1
            return {ARRAY: count - 1}
        if isinstance(one, np.generic):
            return one.item()
        if isinstance(one, tuple):
            return {TUPLE: [plain(each) for each in one]}
        if isinstance(one, list):
            return [plain(each) for each in one]
        if isinstance(one, dict):
            return {str(key): plain(each) for key, each in one.items()}
        return one

    words = json.dumps(plain(value)).encode()
    return struct.pack("<I", len(words)) + words + arrays.getvalue()


def decode(data: bytes) -> Any:
    """What `encode` was given; Unreadable where the bytes are none of its own."""
    try:
        (length,) = struct.unpack_from("<I", data)
        stream = io.BytesIO(data[4 + length :])
        arrays: list[np.ndarray] = []
        while stream.tell() < len(data) - 4 - length:
            arrays.append(np.load(stream, allow_pickle=False))

        def whole(one: Any) -> Any:
            if isinstance(one, list):
                return [whole(each) for each in one]
            if isinstance(one, dict):
                if ARRAY in one:
                    return arrays[one[ARRAY]]
                if TUPLE in one:
                    return tuple(whole(each) for each in one[TUPLE])
                return {key: whole(each) for key, each in one.items()}
            return one

        return whole(json.loads(data[4 : 4 + length]))
    except (ValueError, struct.error, EOFError, IndexError, KeyError, TypeError, RecursionError) as error:
        raise Unreadable(f"its reader gave damaged output: {error}") from None


def limit_process(room: int, seconds: int) -> None:
    """From now on this process has `room` [bytes] more memory and `seconds` [s] of the processor, opens FILES files at a
    time and writes none."""
    with open("/proc/self/statm", encoding="ascii") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    lowest = os.dup(0)
    os.close(lowest)
    for what, most in (
        (resource.RLIMIT_AS, now + room),
        (resource.RLIMIT_CPU, seconds + 1),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, lowest + FILES),
        (resource.RLIMIT_NPROC, 0),
    ):
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        # at its soft limit of time the process is told, at the hard one it is killed without a word
        resource.setrlimit(what, (max(most - 1, 1) if what == resource.RLIMIT_CPU else most, most))


def main() -> None:
    """The process that reads: the content from its standard input, what it finds to its standard output."""
    answer: BinaryIO = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # libraries print
    given = json.loads(sys.argv[1])
    module, _, name = given["reader"].partition(":")
    reader: Callable[..., Any] = getattr(importlib.import_module(module), name)
    content = sys.stdin.buffer.read() if given["path"] is None else given["path"]
    limit_process(given["room"], given["seconds"])
    try:
        found: dict[str, Any] = {"value": reader(content, **given["options"])}
        answer.write(encode(found))
    except Unreadable as error:
        answer.write(encode({"refused": str(error), "at": list(error.at)}))
    except MemoryError:
        answer.write(encode({"refused": f"takes more than {given['room'] / 1e6:.0f} MB to be read", "at": []}))
    answer.close()


if __name__ == "__main__":
    from extrados.schema import contained  # whose Unreadable is that of the readers

    contained.main()
