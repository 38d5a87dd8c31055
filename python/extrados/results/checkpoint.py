"""Finished batches of a long computation beside the results folder, so that a killed run can be resumed.

The name of a batch ends in a checksum of its bytes, its sweep and its place in it: one that was damaged, or copied to
another place, is seen, told and computed again.
"""

import contextlib
import hashlib
import importlib.util
import io
import json
import logging
import os
import re
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from extrados._build_info import VERSION
from extrados.results import written
from extrados.results.store import SUMMARY, StoreError
from extrados.schema import files

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

HEAD = "deck.json"
_TEMPORARY = ".new."
_NAME = re.compile(r"\d{12,}-[0-9a-f]{32}\.npz")
log = logging.getLogger(__name__)


def fingerprint(value: Any) -> str:
    """SHA-256 of what a sweep computes: numbers, text, arrays, lists, dictionaries and dataclasses of them.

    Fields of a dataclass that do not take part in comparisons are caches and do not count.
    """
    digest = hashlib.sha256()
    _feed(digest, value)
    return digest.hexdigest()


def _feed(digest: Any, value: Any) -> None:
    digest.update(type(value).__name__.encode() + b"\0")
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype.str}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif isinstance(value, dict):
        for key in sorted(value):
            _feed(digest, key)
            _feed(digest, value[key])
    elif isinstance(value, list | tuple):
        digest.update(f"{len(value)}".encode())
        for item in value:
            _feed(digest, item)
    elif is_dataclass(value):
        for item in (item for item in fields(value) if item.compare):
            _feed(digest, item.name)
            _feed(digest, getattr(value, item.name))
    else:
        digest.update(repr(value).encode() + b"\0")


def folder_of(out: Path) -> Path:
    """Where the batches of a run that writes to `out` are kept until it has finished."""
    out = Path(os.path.abspath(out))
    return out.with_name(f"{out.name}.checkpoint")


@cache
def program() -> str:
    """Which program computes: its version and a checksum of its code, by which two copies of a version are told apart."""
    digest = hashlib.sha256()
    package = Path(__file__).resolve().parents[1]
    core = importlib.util.find_spec("extrados._core")
    for path in [*sorted(package.rglob("*.py")), *([Path(core.origin)] if core is not None and core.origin else [])]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{VERSION} {digest.hexdigest()[:16]}"


#: Folders of this process' runs, and what holds each against another process; the children of a fork hold none
_held: dict[Path, int] = {}


def let_go(out: Path) -> None:
    """Let another process keep its batches beside `out`."""
    handle = _held.pop(folder_of(out), None)
    if handle is not None:
        os.close(handle)


def _forget() -> None:
    """In the child of a fork: closing a copy of the handle leaves the lock with the parent."""
    while _held:
        os.close(_held.popitem()[1])


if fcntl is not None:
    os.register_at_fork(after_in_child=_forget)


def _hold(out: Path) -> None:
    """Keep the batches beside `out` for this process until it lets go or ends, however that may be; StoreError where
    another process does."""
    let_go(out)
    folder = folder_of(out)
    if fcntl is None:
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise StoreError(
            f"{folder}: another run is writing its unfinished batches to this folder. Wait until that run ends, or give "
            "another folder with --out"
        ) from None
    except OSError:  # a file system that knows no locks
        os.close(handle)
        return
    _held[folder] = handle


def refuse_other_deck(out: Path, deck: str) -> None:
    """StoreError where results or batches in or beside `out` are of another deck than the one of hash `deck`, or where
    another version of the program began them."""
    for folder, name in ((Path(out), SUMMARY), (folder_of(out), HEAD)):
        path, results = folder / name, name == SUMMARY
        if not os.path.lexists(path):
            continue
        try:
            head = json.loads(files.read(name, None, folder).text())
            found = head["deck"]["sha256"] if results else head["sha256"]
            by = program() if results else head["program"]
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise StoreError(f"{path}: this file cannot be read, so the run cannot resume from it: {error}") from None
        if found != deck:
            raise StoreError(
                f"{folder}: holds {'results' if results else 'unfinished batches'} of another deck (sha256 {str(found)[:16]}, "
                f"this one is {deck[:16]}). The run cannot be resumed. Give another folder with --out"
            )
        if by != program():
            raise StoreError(
                f"{folder}: this run was begun by extrados {by}, and the present version is {program()}. The two versions can "
                "give different results, so the run is not resumed. Start again without --resume, or continue with that version"
            )


class Checkpoint:
    """The unfinished batches of one run. Without `resume` earlier ones are thrown away."""

    def __init__(self, out: Path, deck: str, resume: bool):
        self.folder = folder_of(out)
        try:
            if resume:
                refuse_other_deck(out, deck)
            elif os.path.lexists(self.folder):
                if not (self.folder / HEAD).exists():
                    raise StoreError(
                        f"{self.folder}: this folder exists and was not written by extrados. Remove it, or give another folder with --out"
                    )
                _hold(out)
                _clear(self.folder)
            self.folder.mkdir(parents=True, exist_ok=True)
            _hold(out)
            _write(self.folder / HEAD, json.dumps({"sha256": deck, "program": program()}).encode())
        except OSError as error:
            raise StoreError(f"{self.folder}: extrados cannot write to this folder: {error.strerror or error}") from None

    def load(self, name: str, warnings: list[str]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """(first member, arrays) of every batch of a sweep that was kept whole; `warnings` tells of damaged ones."""
        for first, arrays, _ in self.placed(name, warnings):
            yield first, arrays

    def placed(self, name: str, warnings: list[str]) -> Iterator[tuple[int, dict[str, np.ndarray], Path]]:
        """The same, with the place of each batch."""
        for path in sorted((self.folder / name).glob("*.npz")):
            if not _NAME.fullmatch(path.name):
                continue  # a stranger's
            arrays = _arrays(path)
            if arrays:
                yield int(path.name.partition("-")[0]), arrays, path
            else:
                told = f"{path.parent.name}/{path.name}"
                warnings.append(f"a saved batch of results is damaged and is calculated again. File {told} is renamed {path.name}.damaged")
                with contextlib.suppress(FileNotFoundError):  # another run may have done so
                    path.rename(path.with_name(f"{path.name}.damaged"))

    def pick(self, path: Path, names: Sequence[str]) -> dict[str, np.ndarray]:
        """Some arrays of a batch that this run has kept, or loaded, at a path."""
        try:
            with np.load(path, allow_pickle=False) as store:
                return {key: store[key] for key in names}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise StoreError(f"{path}: a saved batch of results cannot be read: {error}. Run again with --resume") from None

    def keep(self, name: str, first: int, arrays: dict[str, np.ndarray]) -> Path:
        """Store a batch; it is there whole or not at all."""
        stream = io.BytesIO()
        named: dict[str, Any] = dict(arrays)  # none is called as an option of savez
        np.savez(stream, **named)
        content = stream.getvalue()
        path = self.folder / name / f"{first:012d}-{_digest(name, first, content)}.npz"
        try:
            path.parent.mkdir(exist_ok=True)
            _write(path, content)
        except OSError as error:
            raise StoreError(f"{path.parent}: a batch of results could not be saved: {error.strerror or error}") from None
        return path


def _digest(name: str, first: int, content: bytes) -> str:
    return hashlib.sha256(f"{name}\0{first}\0".encode() + content).hexdigest()[:32]


def _arrays(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a batch; none where it was changed, or where a stranger gave its checksum to something else."""
    content = _sound(path)
    try:
        with np.load(io.BytesIO(content or b""), allow_pickle=False) as store:
            return {key: store[key] for key in store.files}
    except (OSError, ValueError, KeyError, EOFError, AttributeError, TypeError, MemoryError, zipfile.BadZipFile):
        return {}


def _sound(path: Path) -> bytes | None:
    """The content of a batch as it was kept; None where it was changed, or was kept for another place."""
    first, _, digest = path.stem.partition("-")
    try:
        content = files.read(path.name, None, path.parent).content
        return content if first.isdecimal() and digest == _digest(path.parent.name, int(first), content) else None
    except ValueError:  # BadFile is one
        return None


def discard(out: Path) -> None:
    """Remove the batches of a run that has finished, and nothing else; those of another run that goes on are left."""
    folder = folder_of(out)
    if (folder / HEAD).exists():
        with contextlib.suppress(StoreError, FileNotFoundError):
            _hold(out)
            _clear(folder)
    let_go(out)


def _clear(folder: Path) -> None:
    """Remove what was kept in the folder, and the folder where nothing else is left."""
    for path in folder.glob("*/*.npz"):
        if _sound(path) is not None:
            path.unlink()
    for path in (*folder.glob(f"*/{_TEMPORARY}*"), *folder.glob(f"{_TEMPORARY}*"), folder / HEAD):
        if path.is_file() and not path.is_symlink():
            path.unlink()
    if not written.prune(folder):
        log.warning("%s: this folder contains files that extrados did not write or that are damaged. They were not removed", folder)


def _write(path: Path, content: bytes) -> None:
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=_TEMPORARY)
    with os.fdopen(handle, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)
