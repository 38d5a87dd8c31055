"""Finished batches of a long computation beside the results folder, so that a killed run can be resumed.

The name of a batch ends in the SHA-256 of its bytes: one that was damaged is seen, told and computed again.
"""

import contextlib
import hashlib
import io
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from extrados.results.store import SUMMARY, StoreError

HEAD = "deck.json"


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


def refuse_other_deck(out: Path, deck: str) -> None:
    """StoreError where results or batches in or beside `out` are of another deck than the one of hash `deck`."""
    for path, key in ((Path(out) / SUMMARY, "summary"), (folder_of(out) / HEAD, "batches")):
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            try:
                head = json.loads(path.read_text(encoding="utf-8"))
                found = head["deck"]["sha256"] if key == "summary" else head["sha256"]
            except (ValueError, KeyError, TypeError) as error:
                raise StoreError(f"{path}: cannot be read, so nothing is resumed from it: {error}") from None
            if found != deck:
                raise StoreError(
                    f"{path.parent}: holds {'results' if key == 'summary' else 'unfinished batches'} of another deck "
                    f"(sha256 {found[:16]}, this one is {deck[:16]}): not resumed; name another folder with --out"
                )


class Checkpoint:
    """The unfinished batches of one run. Without `resume` earlier ones are thrown away."""

    def __init__(self, out: Path, deck: str, resume: bool):
        self.folder = folder_of(out)
        try:
            if resume:
                refuse_other_deck(out, deck)
            elif self.folder.exists():
                if not (self.folder / HEAD).exists():
                    raise StoreError(
                        f"{self.folder}: is in the way and was not written by extrados; remove it or use --out"
                    )
                shutil.rmtree(self.folder)
            self.folder.mkdir(parents=True, exist_ok=True)
            _write(self.folder / HEAD, json.dumps({"sha256": deck}).encode())
        except OSError as error:
            raise StoreError(f"{self.folder}: cannot write here: {error.strerror or error}") from None

    def load(self, name: str, warnings: list[str]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """(first member, arrays) of every batch of a sweep that was kept whole; `warnings` tells of damaged ones."""
        for path in sorted((self.folder / name).glob("*.npz")):
            try:
                content = path.read_bytes()
            except OSError as error:
                raise StoreError(f"{path}: cannot be read: {error.strerror or error}") from None
            first, _, digest = path.stem.partition("-")
            if digest == _digest(content):
                with np.load(io.BytesIO(content), allow_pickle=False) as store:
                    yield int(first), {key: store[key] for key in store.files}
            else:
                warnings.append(f"a kept batch was damaged and is computed again: {path.parent.name}/{path.name}")
                path.unlink()

    def keep(self, name: str, first: int, arrays: dict[str, np.ndarray]) -> Path:
        """Store a batch; it is there whole or not at all."""
        stream = io.BytesIO()
        named: dict[str, Any] = dict(arrays)  # none is called as an option of savez
        np.savez(stream, **named)
        content = stream.getvalue()
        path = self.folder / name / f"{first:012d}-{_digest(content)}.npz"
        try:
            path.parent.mkdir(exist_ok=True)
            _write(path, content)
        except OSError as error:
            raise StoreError(f"{path.parent}: a batch could not be kept: {error.strerror or error}") from None
        return path


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:32]


def discard(out: Path) -> None:
    """Remove the batches of a run that has finished."""
    if (folder_of(out) / HEAD).exists():
        shutil.rmtree(folder_of(out), ignore_errors=True)


def _write(path: Path, content: bytes) -> None:
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".new.")
    with os.fdopen(handle, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)
