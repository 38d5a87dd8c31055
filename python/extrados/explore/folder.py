"""The working folder of the page, and the shipped cases: which files may be read and written."""

import contextlib
import os
import queue
import re
import secrets
import signal
import subprocess
import threading
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from extrados.decks.reader import LARGEST
from extrados.results.store import SUMMARY, Stored, StoreError, read
from extrados.schema import files
from extrados.schema.isolated import environment, python_command
from extrados.schema.places import CASES

#: How deep decks and runs are looked for, how many are listed, how many folders are looked into
DEEP, MOST, MOST_FOLDERS = 4, 500, 2000
#: Bytes of a run that a page is shown
LARGEST_RUN = 400_000_000
#: Bytes and number of the figures of an analysis that a page is shown
LARGEST_FIGURES, MOST_FIGURES = 12_000_000, 60
WAITS = 10.0  # s: a run ends so long after its last line
SKIPPED = {"node_modules", "__pycache__", "build", "dist"}
PLACE = re.compile(r"(?:[\w][\w .+-]{0,100}/){0,6}[\w][\w .+-]{0,100}")


class NotThere(ValueError):
    """A requested file is not in the folder, or must not be read; the text gives the reason."""


class Folder:
    """A folder in which a page reads decks and runs and writes decks and runs: never outside of it, never past a link."""

    def __init__(self, root: Path):
        self.root = root.resolve()

    def inside(self, path: str) -> Path:
        """The place of a relative path; NotThere if it leads out of the folder."""
        if not PLACE.fullmatch(path) or ".." in path:
            raise NotThere(f"{path[:100]!r} is not a path within the working folder")
        target = self.root / path
        with contextlib.suppress(OSError, RuntimeError):
            if target.resolve().is_relative_to(self.root):
                return target
        raise NotThere(f"{path[:100]!r} leads out of the working folder")

    def _walk(self) -> Iterator[tuple[Path, list[str]]]:
        """Folders and the names of their files, hidden ones and links left out."""
        count = 0
        for here, folders, names in os.walk(self.root):
            count += 1
            depth = len(Path(here).relative_to(self.root).parts)
            folders[:] = sorted(f for f in folders if not f.startswith(".") and f not in SKIPPED) if depth < DEEP else []
            yield Path(here), names
            if count >= MOST_FOLDERS:
                return

    def decks(self) -> list[str]:
        """Decks below the folder."""
        found = []
        for here, names in self._walk():
            found += [
                (here / n).relative_to(self.root).as_posix()
                for n in sorted(names)
                if n.endswith(".toml") and not n.endswith(".expect.toml") and n not in ("pyproject.toml", "ruff.toml")
            ]
        return [p for p in found if PLACE.fullmatch(p)][:MOST]

    def runs(self) -> list[dict[str, Any]]:
        """Stored runs below the folder, the newest first."""
        found = []
        for here, names in self._walk():
            if SUMMARY in names:
                with contextlib.suppress(OSError):
                    found.append((here.joinpath(SUMMARY).stat().st_mtime, here.relative_to(self.root).as_posix()))
        return [{"path": path, "time": at} for at, path in sorted(found, reverse=True)[:MOST] if PLACE.fullmatch(path)]

    def deck(self, path: str) -> tuple[bytes, Path, str]:
        """A deck of the folder: its bytes, the folder of its files, its name."""
        target = self.inside(path)
        if target.suffix != ".toml":
            raise NotThere(f"{path}: the name of a deck must end in .toml")
        try:
            return (files.read(target.relative_to(self.root).as_posix(), LARGEST, self.root).content, target.parent, target.name)
        except files.BadFile as error:
            raise NotThere(str(error)) from None

    def beside(self, place: Path, name: str) -> bytes:
        """A file that a deck in `place` names; NotThere if it cannot be read."""
        try:
            return files.read(name, 50_000_000, place).content
        except files.BadFile as error:
            raise NotThere(str(error)) from None

    def presets(self) -> list[dict[str, str]]:
        """All shipped cases: name and title."""
        global _presets
        if _presets is None:
            found = []
            for path in sorted(CASES.rglob("*.toml")):
                if path.name.endswith(".expect.toml"):
                    continue
                try:
                    data = tomllib.loads(path.read_text("utf-8"))
                except (OSError, ValueError):
                    continue
                structure = data.get("structure") or {}
                found.append(
                    {
                        "name": path.relative_to(CASES).with_suffix("").as_posix(),
                        "title": str(data.get("title", "")),
                        "kind": str(structure.get("kind", "")),
                    }
                )
            _presets = found
        return _presets

    def preset(self, name: str) -> tuple[bytes, Path, str]:
        """A shipped case by its name: its content, the folder of its files, its file name."""
        if not any(row["name"] == name for row in self.presets()):
            raise NotThere(f"no shipped case has the name {name[:100]!r}")
        path = CASES / f"{name}.toml"
        return path.read_bytes(), path.parent, path.name

    def save(self, path: str, text: str, beside: dict[str, bytes], replace: bool) -> str:
        """Write a deck, and the files it names where they are not there yet; the path within the folder."""
        target = self.inside(path if path.endswith(".toml") else f"{path}.toml")
        if target.exists() and not replace:
            raise NotThere(f"{target.relative_to(self.root)} exists already: choose to replace it, or choose another name")
        try:
            for name, content in beside.items():
                place = self.inside((target.parent.relative_to(self.root) / name).as_posix())
                if not place.exists():
                    place.parent.mkdir(parents=True, exist_ok=True)
                    place.write_bytes(content)
                elif place.read_bytes() != content:
                    raise NotThere(f"a different file {name} exists already beside the deck: save the deck in another folder")
            target.parent.mkdir(parents=True, exist_ok=True)
            _replace(target, text)
        except OSError as error:
            raise NotThere(f"{path}: could not be written: {error.strerror or error}") from None
        return target.relative_to(self.root).as_posix()

    def run(self, path: str) -> Stored:
        """A stored run; StoreError if it is damaged or too large for a page."""
        target = self.inside(path)
        size = sum(f.stat().st_size for f in target.glob("*") if f.is_file() and not f.is_symlink()) if target.is_dir() else 0
        if size > LARGEST_RUN:
            raise StoreError(f"{path} has {size / 1e6:.0f} MB, more than the {LARGEST_RUN / 1e6:g} MB that the page shows")
        return read(target)

    def figures(self, path: str, name: str) -> list[tuple[str, str]]:
        """The figures of an analysis as the report of a stored run has them: name and SVG text."""
        target, names = self.inside(path), [row["name"] for row in self.run(path).analyses]
        if name not in names:
            raise NotThere(f"the run has no analysis {name[:60]!r}")
        longer = tuple(f"{other}-" for other in names if other.startswith(f"{name}-"))
        found, left = [], LARGEST_FIGURES
        for place in sorted(target.glob(f"figures/{name}-*.svg"))[:MOST_FIGURES]:
            if place.name.startswith(longer):
                continue
            try:
                text = files.read(place.relative_to(self.root).as_posix(), left, self.root).content.decode("utf-8")
            except (files.BadFile, UnicodeDecodeError) as error:
                raise NotThere(f"{place.name}: {error}") from None
            left -= len(text)
            found.append((place.stem.removeprefix(f"{name}-"), text))
        return found

    def compute(self, deck: str) -> Iterator[tuple[str, bool]]:
        """Run a deck of the folder by the command line; lines as they come, empty ones meanwhile; at
        the end ("", True). What is left of it is ended when nobody listens any more."""
        target = self.inside(deck)
        child = subprocess.Popen(
            python_command("extrados", "run", str(target.relative_to(self.root))),
            cwd=self.root,
            env=environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
        lines: queue.Queue[str | None] = queue.Queue()

        def pump() -> None:
            assert child.stdout is not None
            for line in child.stdout:
                lines.put(line.rstrip("\n"))
            lines.put(None)

        threading.Thread(target=pump, daemon=True).start()
        try:
            while True:
                try:
                    line = lines.get(timeout=0.05)
                except queue.Empty:
                    yield "", False
                    continue
                if line is None:
                    break
                yield line, False
            code: int | str
            try:
                code = child.wait(WAITS)
            except subprocess.TimeoutExpired:
                code = "unknown, because the process did not end after its output"
            yield "" if code in (0, 3) else f"the run ended with exit code {code}", True
        finally:
            if child.poll() is None:
                child.send_signal(signal.SIGINT)
                end = time.monotonic() + 5.0
                while child.poll() is None and time.monotonic() < end:
                    time.sleep(0.05)
                if child.poll() is None:
                    child.kill()
                    child.wait()


def _replace(target: Path, text: str) -> None:
    """Write a text in place of a file, whole or not at all; two writers at once do not mix. OSError where it fails."""
    scratch = target.with_name(f".{secrets.token_hex(8)}.part")
    try:
        with scratch.open("x", encoding="utf-8", newline="") as file:
            file.write(text)
        scratch.replace(target)
    finally:
        scratch.unlink(missing_ok=True)


_presets: list[dict[str, str]] | None = None
