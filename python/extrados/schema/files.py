"""The one door for files that a deck or a user names: opened once, and everything is asked of the open file."""

import contextlib
import contextvars
import hashlib
import os
import stat
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
#: Files that come with the program, by the name that follows `extrados:` in a deck; places below the package
SHIPPED = {
    "el-centro-1940": "motions/library/el-centro-1940.csv",
    "example-sections": "model/examples/sections.csv",
    "example-wall": "model/examples/wall.inp",
}
# Without O_NONBLOCK the opening of a FIFO waits for its writer, and without O_NOCTTY that of a terminal takes it.
_FLAGS = os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC
_FOLDER = getattr(os, "O_PATH", os.O_RDONLY) | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


#: Whether absolute paths are refused, as where decks come from a browser; see `confine`
_confined: contextvars.ContextVar[bool] = contextvars.ContextVar("confined", default=False)
_shipped_alone: contextvars.ContextVar[bool] = contextvars.ContextVar("shipped_alone", default=False)


class BadFile(ValueError):
    """The file that is named cannot be meant or read; the text names it and says why."""


@dataclass(frozen=True)
class File:
    """A file that has been read whole: where it lies, as messages name it, and its bytes."""

    path: Path
    content: bytes

    def text(self) -> str:
        """The content as UTF-8 text; BadFile where it is none."""
        try:
            return self.content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = self.content[: error.start].count(b"\n") + 1
            raise BadFile(f"{self.path}:{line}: this file is not UTF-8 text (byte {error.start})") from None

    @contextlib.contextmanager
    def copied(self) -> Iterator[Path]:
        """A private copy of the same suffix, alone in its folder: for libraries that only read files by name."""
        with tempfile.TemporaryDirectory(prefix="extrados-") as folder:
            copy = Path(folder) / f"file{self.path.suffix}"
            copy.write_bytes(self.content)
            yield copy


def confine(shipped_alone: bool = False) -> None:
    """From now on, in this context, decks name shipped files and those inside their folder alone: no absolute path is
    followed. shipped_alone: not those in the folder either."""
    _confined.set(True)
    _shipped_alone.set(shipped_alone)


def locate(file: str, folder: Path) -> Path:
    """The place a deck means: shipped, absolute as the user wrote it, or inside the deck's folder; BadFile else."""
    if file.startswith("extrados:"):
        name = file.removeprefix("extrados:")
        if name not in SHIPPED:
            raise BadFile(f"{file}: no such file is shipped; expected one of {', '.join(sorted(SHIPPED))}")
        return PACKAGE / SHIPPED[name]
    if _shipped_alone.get():
        raise BadFile(f"{file}: only shipped files can be read here, such as extrados:{min(SHIPPED)}")
    if "\0" in file:
        raise BadFile(f"{file!r}: a file name cannot contain a zero byte")
    path = Path(file)
    if path.is_absolute():
        if _confined.get():
            raise BadFile(f"{file}: this is an absolute path. Only files in the folder of the deck can be read here")
        return path
    try:
        inside, root = (folder / path).resolve(), folder.resolve()
    except (OSError, RuntimeError, ValueError) as error:  # links that go in circles
        raise BadFile(f"{file}: cannot be found: {error}") from None
    if not inside.is_relative_to(root):
        raise BadFile(f"{file}: this path leads out of the deck's folder. Give an absolute path if this is intended")
    return inside


def read(file: str | Path, largest: int | None, folder: Path | None = None) -> File:
    """The file that a deck in `folder` names, or, without a folder, the one at a path that the user gave.

    largest: the most bytes it may have, None for results of our own. BadFile where it is not there, leads out of the
    deck's folder (also by links, and also where a link is put there while we look), is no regular file or too large.
    """
    with _opened(file, largest, folder) as (path, stream):
        content = stream.read() if largest is None else stream.read(largest + 1)
        if largest is not None and len(content) > largest:  # it grew while it was read
            raise _too_large(path, len(content), largest)
        return File(path, content)


def sum_of(file: str | Path, folder: Path | None = None) -> str:
    """SHA-256 of a file that `read` would read, whose content need not fit into memory."""
    with _opened(file, None, folder) as (_, stream):
        return hashlib.file_digest(stream, "sha256").hexdigest()


@contextlib.contextmanager
def _opened(file: str | Path, largest: int | None, folder: Path | None) -> Iterator[tuple[Path, BufferedReader]]:
    """The place of a file and its bytes; BadFile as `read` has it."""
    path = Path(file) if folder is None else locate(str(file), folder)
    try:
        handle = _open(path, folder if folder is not None and not Path(file).is_absolute() else None)
        try:
            _refuse(os.fstat(handle), path, largest)
        except BadFile:
            os.close(handle)
            raise
        with os.fdopen(handle, "rb") as stream:
            yield path, stream
    except FileNotFoundError:
        raise BadFile(f"{path}: no such file") from None
    except (OSError, ValueError) as error:
        if isinstance(error, BadFile):
            raise
        raise BadFile(f"{path}: this file cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _open(path: Path, folder: Path | None) -> int:
    """A descriptor; below `folder` from one folder to the next, past no link: the path has none left."""
    root = None if folder is None else folder.resolve()
    if root is None or not path.is_relative_to(root):  # a shipped file
        return os.open(path, _FLAGS)
    parts = path.relative_to(root).parts or (".",)
    here = os.open(root, _FOLDER)
    try:
        for part in parts[:-1]:
            within = os.open(part, _FOLDER, dir_fd=here)
            os.close(here)
            here = within
        return os.open(parts[-1], _FLAGS | os.O_NOFOLLOW, dir_fd=here)
    finally:
        os.close(here)


def _refuse(found: os.stat_result, path: Path, largest: int | None) -> None:
    if not stat.S_ISREG(found.st_mode):
        kind = "a folder" if stat.S_ISDIR(found.st_mode) else "no plain file"
        raise BadFile(f"{path}: is {kind}; expected a file")
    if largest is not None and found.st_size > largest:
        raise _too_large(path, found.st_size, largest)


def _too_large(path: Path, size: int, largest: int) -> BadFile:
    return BadFile(f"{path}: this file has {size / 1e6:.1f} MB; at most {largest / 1e6:g} MB are read")
