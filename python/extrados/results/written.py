"""Which files of a folder extrados wrote: they alone, and only while nobody has changed them, are replaced or removed.

A hidden list in the folder holds the checksums.
"""

import contextlib
import itertools
import json
import logging
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from extrados.schema import files

LIST = ".written.json"

log = logging.getLogger(__name__)


def sums_of(folder: Path) -> dict[str, str]:
    """The checksums of all files below a folder by their place in it."""
    return {
        path.relative_to(folder).as_posix(): files.sum_of(path)
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != LIST
    }


def noted(folder: Path) -> dict[str, list[str]]:
    """The checksums that each file of a folder may have and still be ours; none where there is no sound list."""
    try:
        found = json.loads(files.read(LIST, 50_000_000, folder).text())["files"]
        return {str(name): [str(value) for value in values] for name, values in found.items()}
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def note(folder: Path, *sums: dict[str, str]) -> None:
    """Keep the list of what was written into a folder; a file of several checksums may have any of them."""
    names = sorted({name for one in sums for name in one})
    listed = {name: sorted({one[name] for one in sums if name in one}) for name in names}
    fresh = folder / f"{LIST}.new"
    fresh.write_text(json.dumps({"about": "checksums of the files that extrados wrote to this folder", "files": listed}), encoding="utf-8")
    fresh.replace(folder / LIST)


def is_ours(folder: Path, name: str, known: dict[str, list[str]]) -> bool:
    """Whether extrados wrote a file of the folder and nobody has changed it since."""
    if name not in known or not _within(folder, name):
        return False
    try:
        return files.sum_of(name, folder) in known[name]
    except files.BadFile:
        return False


def strange(folder: Path) -> list[str]:
    """Files and folders within `folder` that are not ours, in order; links, pipes and devices never are."""
    known = noted(folder)
    parents = {parent.as_posix() for name in known for parent in Path(name).parents}
    found = []
    for place, inner, names in os.walk(folder):
        here = Path(place).relative_to(folder)
        for name in inner:
            path = (here / name).as_posix()
            if path not in parents or (folder / path).is_symlink():
                found.append(f"{path}/")
        for name in names:
            path = (here / name).as_posix()
            if path not in (LIST, f"{LIST}.new") and not is_ours(folder, path, known):
                found.append(path)
    return sorted(found)


def remove(folder: Path) -> bool:
    """Remove what is ours of a folder, and the folder where nothing else is left in it; whether it is gone."""
    known = noted(folder)
    for name in known:
        if is_ours(folder, name, known):
            (folder / name).unlink()
    for name in (LIST, f"{LIST}.new"):
        (folder / name).unlink(missing_ok=True)
    return prune(folder)


def prune(folder: Path) -> bool:
    """Remove the empty folders from `folder` on; whether it is gone itself."""
    for place, _, _ in os.walk(folder, topdown=False):
        with contextlib.suppress(OSError):
            os.rmdir(place)
    return not os.path.lexists(folder)


def beside(path: Path) -> Path:
    """The first of NAME-2, NAME-3 ... beside a path that is not there."""
    stem, suffix = (path.name, "") if path.is_dir() else (path.stem, path.suffix)  # a folder tower-0.8 ends in no suffix
    numbered = (path.with_name(f"{stem}-{k}{suffix}") for k in itertools.count(2))
    return next(other for other in numbered if not os.path.lexists(other))


def _within(folder: Path, name: str) -> bool:
    """Whether the folders above a file of a folder are its own, no links and no files, or not there yet."""
    above = [folder / parent for parent in Path(name).parents[:-1]]
    return all(is_plain_folder(path) or not os.path.lexists(path) for path in above)


def _place(folder: Path, name: str) -> str:
    """A file's place in a folder: in NAME-2, NAME-3 ... where a folder that it lies in is somebody's link or file."""
    parent, _, own = name.rpartition("/")
    numbered = itertools.chain([name], (f"{parent}-{k}/{own}" for k in itertools.count(2)))
    return next(place for place in numbered if _within(folder, place))


def put(scratch: Path, folder: Path, belongs: Callable[[str], bool]) -> dict[str, str]:
    """Move the files of a scratch folder into a folder; the name that each got there.

    What is there and was not written by extrados, or was changed since, stays: the new file is put beside it, which is
    logged. Older files of ours that `belongs` knows by their names and that have no successor are removed.
    """
    new = sums_of(scratch)
    known = noted(folder)
    others = {name: sums[-1] for name, sums in known.items() if not belongs(name)}
    names = {}
    for name in new:
        place = _place(folder, name)
        taken = os.path.lexists(folder / place) and not is_ours(folder, place, known)
        names[name] = beside(folder / place).relative_to(folder).as_posix() if taken else place
        if names[name] != name:
            log.warning("%s: this file was not written by extrados or was changed later. The new file is %s", folder / name, names[name])
    fresh = {names[name]: value for name, value in new.items()}
    # noted before it is moved: whoever is killed in between leaves nothing that is taken for a stranger's
    note(folder, {name: value for name, sums in known.items() for value in sums[:1]}, fresh)
    for name in known:
        if belongs(name) and name not in fresh and is_ours(folder, name, known):
            (folder / name).unlink()
    for name, target in names.items():
        (folder / target).parent.mkdir(exist_ok=True)
        (scratch / name).replace(folder / target)
    note(folder, others, fresh)
    return names


def put_one(path: Path, content: bytes) -> Path:
    """Write a file that a user named, or beside it where another is there, as `put` does; the place that it got. What
    holds nothing to lose is written to: a device, a pipe, an empty file."""
    if path.exists() and not (path.is_file() and path.stat().st_size):
        path.write_bytes(content)
        return path
    with tempfile.TemporaryDirectory(prefix=f".{path.name}.", dir=path.parent) as scratch:
        (Path(scratch) / path.name).write_bytes(content)
        with alone(path.parent):
            names = put(Path(scratch), path.parent, lambda name: name == path.name)
    return path.with_name(names[path.name])


@contextlib.contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Nobody else puts results into a place within `folder` meanwhile, where the file system knows locks."""
    import fcntl

    handle = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        with contextlib.suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def is_plain_folder(path: Path) -> bool:
    """A folder, no link to one."""
    try:
        return stat.S_ISDIR(path.lstat().st_mode)
    except OSError:
        return False
