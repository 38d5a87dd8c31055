"""Files of foreign formats are read by a process of their own, with limits: what a hostile file does to a library ends there.

The process gets the content and gives back values and arrays, which are checked for their size; it opens few files, writes none,
and has limits of memory and of the processor's time. What it raises as Unreadable is raised here.

Python and the libraries take 0.1 s to load. One process, the server, loads them once and forks itself for each file. Per file:

    this process  --  a socket  --  the watcher, which ends the reader  --  the reader, which has the limits
"""

import atexit
import contextlib
import importlib
import io
import json
import os
import resource
import select
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from extrados.schema.isolated import environment, python_command

#: Memory [bytes] and time of the processor [s] that are left to a reader; both grow with the file
ROOM, ROOM_PER_BYTE = 1_000_000_000, 12
SECONDS, SECONDS_PER_BYTE = 30, 1e-6
#: A reader that has not ended after so many times its time of the processor waits for something
PATIENCE = 20
LARGEST = 2_000_000_000  # bytes that a reader may give of a small file
FILES = 4  # that are open at a time: numpy and HDF5 open one twice
ARRAY = "\0array"  # the key under which an array's number stands; no text of a file begins so
TUPLE = "\0tuple"
_LENGTH, _CODE = (struct.Struct("<Q"), struct.Struct("<i"))  # of the request before it; of the reader's end after its answer


class Unreadable(Exception):
    """The file cannot be read; the text says why, `at` is the key of the deck that is to blame where there is one."""

    def __init__(self, text: str, at: tuple[str | int, ...] = ()):
        super().__init__(text)
        self.at = at


def read_contained(
    reader: str, source: bytes | Path, libraries: Sequence[str] = (), most_seconds: int | None = None, **options: Any
) -> Any:
    """What a function of this package, "module:function", finds in the content of a file; Unreadable says why it finds nothing.

    The function is given the content, or the path where that is given, and the options; it returns numbers, texts, arrays, and
    lists, tuples and dictionaries of them. libraries: what it imports, loaded once for all files. most_seconds: time of the
    processor for a small file, default SECONDS.
    """
    content = source if isinstance(source, bytes) else b""
    size = len(content) if isinstance(source, bytes) else source.stat().st_size
    room, most = ROOM + ROOM_PER_BYTE * size, LARGEST + size
    seconds = (most_seconds or SECONDS) + int(SECONDS_PER_BYTE * size)
    path = None if isinstance(source, bytes) else str(source)
    given = {"reader": reader, "path": path, "options": options, "room": room, "seconds": seconds, "libraries": list(libraries)}
    words = json.dumps(given).encode()
    with tempfile.TemporaryFile() as file:  # a pipe of an unread content would block
        file.writelines((_LENGTH.pack(len(words)), words, content))
        file.flush()
        found, in_time = _server.answer(file.fileno(), most, PATIENCE * seconds)
        if not found and in_time:  # the server was killed
            _server.end()
            found, _ = _server.answer(file.fileno(), most, PATIENCE * seconds)
    if len(found) > most + _CODE.size:
        raise Unreadable(f"this file contains more than {most / 1000000.0:.0f} MB of numbers")
    answer, end = found[: -_CODE.size], found[-_CODE.size :]
    if not answer:
        raise Unreadable(_reason(_CODE.unpack(end)[0] if end else -signal.SIGKILL, room, seconds))
    decoded = decode(answer)
    if "refused" in decoded:
        raise Unreadable(decoded["refused"], tuple(decoded["at"]))
    return decoded["value"]


def _pieces(stream: socket.socket, most: int, until: float) -> Iterator[bytes]:
    """What comes from a socket until its end, up to `most` bytes and a piece; TimeoutError at a time of the monotonic clock."""
    size = 0
    while size <= most + _CODE.size:
        stream.settimeout(max(until - time.monotonic(), 0.01))
        if not (piece := stream.recv(1 << 20)):
            return
        size += len(piece)
        yield piece


def _reason(code: int, room: int, seconds: int) -> str:
    if code == -signal.SIGXCPU:
        return f"this file takes more than {seconds} s to read"
    if code == -signal.SIGKILL:
        return f"with {room / 1000000.0:.0f} MB of memory, this file cannot be read in the remaining time"
    return f"this file cannot be read: its reader ended with code {code}"


class _Server:
    """The server of this process: begun when the first file is read, ended with this process, however that ends."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.running: tuple[subprocess.Popen[bytes], socket.socket] | None = None

    def answer(self, file: int, most: int, patience: float) -> tuple[bytes, bool]:
        """The answer to the request in a file, up to `most` bytes and a piece, and whether it came within `patience` [s];
        empty where the server was killed."""
        ours, theirs = socket.socketpair()
        with theirs, self.lock:
            self.running = self.running or self._begun()
            with contextlib.suppress(OSError):  # it was killed: nothing will come
                socket.send_fds(self.running[1], [b"?"], [file, theirs.fileno()])
        with ours:  # a reader whose answer nobody reads any more is ended by its watcher
            try:
                return b"".join(_pieces(ours, most, time.monotonic() + patience)), True
            except TimeoutError:
                return b"", False

    @staticmethod
    def _begun() -> tuple["subprocess.Popen[bytes]", socket.socket]:
        ours, theirs = socket.socketpair()
        with theirs:
            process = subprocess.Popen(
                python_command("extrados.schema.contained"),
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=environment(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1"),
                start_new_session=True,  # Ctrl-C is for this process, whose sockets end the others
            )
        return process, ours

    def end(self) -> None:
        """End the server; the next file begins another."""
        with self.lock:
            running, self.running = self.running, None
        if running is not None:
            process, asks = running
            asks.close()
            process.wait()

    def forget(self) -> None:
        """In a fork of this process: its server is that of the parent."""
        self.lock = threading.Lock()
        if self.running is not None:
            process, asks = self.running
            self.running = None
            asks.close()
            process.returncode = 0  # whose end is none of ours


_server = _Server()
end_server = _server.end
atexit.register(end_server)
os.register_at_fork(after_in_child=_server.forget)


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
    except (ValueError, struct.error, EOFError, IndexError, KeyError, TypeError, RecursionError, MemoryError) as error:
        raise Unreadable(f"the reader of this file gave damaged output: {error}") from None


def limit_process(room: int, seconds: int) -> None:
    """From now on this process has `room` [bytes] more memory and `seconds` [s] of the processor, opens FILES files at a
    time and writes none."""
    with open("/proc/self/statm", encoding="ascii") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    numbers = [os.dup(0) for _ in range(FILES)]
    for number in numbers:
        os.close(number)
    for what, most in (
        (resource.RLIMIT_AS, now + room),
        (resource.RLIMIT_CPU, seconds + 1),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, max(numbers) + 1),
        (resource.RLIMIT_NPROC, 0),
    ):
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        # at its soft limit of time the process is told, at the hard one it is killed without a word
        resource.setrlimit(what, (max(most - 1, 1) if what == resource.RLIMIT_CPU else most, most))


def serve() -> None:
    """The server: it forks a watcher for every file whose number comes with a socket for the answer."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for watchers
    asks = socket.socket(fileno=os.dup(0))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    while True:
        question, numbers, _, _ = socket.recv_fds(asks, 1, 2)
        if not question:
            os._exit(0)
        file, answer = numbers
        (length,) = _LENGTH.unpack(os.pread(file, _LENGTH.size, 0))
        given = json.loads(os.pread(file, length, _LENGTH.size))
        os.lseek(file, _LENGTH.size + length, os.SEEK_SET)
        for name in (given["reader"].partition(":")[0], *given["libraries"]):
            with contextlib.suppress(Exception):  # the reader will find the same, and say so
                importlib.import_module(name)
        with contextlib.suppress(OSError):  # no memory for another process: the answer ends without a word
            if os.fork() == 0:
                asks.close()
                _watch(given, file, answer)
        os.close(file)
        os.close(answer)


def _watch(given: dict[str, Any], file: int, answer: int) -> None:
    """The watcher: it tells how the reader ended, and ends it where nobody waits for its answer."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    life, held = os.pipe()
    reader = os.fork()
    if reader == 0:
        code = 1
        try:
            os.close(life)
            _read(given, file, answer)
            code = 0
        finally:
            os._exit(code)
    os.close(held)
    ready, _, _ = select.select([life, answer], [], [])
    if life not in ready:
        os.kill(reader, signal.SIGKILL)
    code = os.waitstatus_to_exitcode(os.waitpid(reader, 0)[1])
    with contextlib.suppress(OSError):
        os.write(answer, _CODE.pack(code))
    os._exit(0)


def _read(given: dict[str, Any], file: int, answer: int) -> None:
    """The reader: the content from a file, what it finds to a socket."""
    module, _, name = given["reader"].partition(":")
    reader: Callable[..., Any] = getattr(importlib.import_module(module), name)
    with os.fdopen(file, "rb") as stream, os.fdopen(answer, "wb") as out:
        content = stream.read() if given["path"] is None else given["path"]
        limit_process(given["room"], given["seconds"])
        try:
            found: dict[str, Any] = {"value": reader(content, **given["options"])}
            out.write(encode(found))
        except Unreadable as error:
            out.write(encode({"refused": str(error), "at": list(error.at)}))
        except MemoryError:
            out.write(encode({"refused": f"this file needs more than {given['room'] / 1e6:.0f} MB of memory to read", "at": []}))
        except Exception as error:  # of a library, at a file that it does not foresee
            out.write(encode({"refused": f"cannot be read: {type(error).__name__}: {error}", "at": []}))


if __name__ == "__main__":
    from extrados.schema import contained  # whose Unreadable is that of the readers

    contained.serve()
