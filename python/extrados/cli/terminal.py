"""Shared parts of all commands: consoles, exit codes, and the handling of errors and signals."""

import functools
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import TYPE_CHECKING, Any

import typer

from extrados import interrupts, room
from extrados.running.progress import Progress
from extrados.schema.text import printable

if TYPE_CHECKING:
    from rich.console import Console

WRONG_DECK, NOT_DONE = 2, 3


class _Console:
    """A console of rich that is made when it is first used."""

    def __init__(self, stderr: bool):
        self._stderr = stderr

    @cached_property
    def _rich(self) -> "Console":
        from rich.console import Console

        return Console(stderr=self._stderr, highlight=False, soft_wrap=True, emoji=False)

    def say(self, text: str, style: str | None = None) -> None:
        """Print words, some of which others wrote: nothing in them is obeyed by the terminal."""
        self._rich.print(printable(text, keep="\n"), style=style, markup=False)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rich, name)


out_console, err_console = _Console(stderr=False), _Console(stderr=True)


class Commands(typer.Typer):
    """Commands that a signal ends without a traceback, whatever they are doing, be it an import."""

    def command(self, *words: Any, **options: Any) -> Callable[[Callable], Callable]:  # type: ignore[override]
        add = super().command(*words, **options)

        def guarded(function: Callable) -> Callable:
            @functools.wraps(function)
            def call(*args: Any, **keywords: Any) -> Any:
                try:
                    return function(*args, **keywords)
                except KeyboardInterrupt:
                    err_console.say("interrupted")
                    raise typer.Exit(interrupts.exit_code()) from None

            add(call)
            return function

        return guarded


@contextmanager
def errors(json_out: bool = False) -> Iterator[None]:
    """Turn every error that a user can cause into a message and an exit code, without a traceback."""
    from extrados.decks.reader import DeckError
    from extrados.results.store import StoreError

    def tell(lines: list[str], code: int) -> None:
        if json_out:
            print(json.dumps({"error": lines, "exit": code}, indent=2))
        else:
            for line in lines:
                err_console.say(line)
        raise typer.Exit(code)

    try:
        yield
    except DeckError as error:
        tell(error.complaints, WRONG_DECK)
    except StoreError as error:
        tell([str(error)], NOT_DONE)
    except KeyboardInterrupt:
        tell(["interrupted"], interrupts.exit_code())
    except Exception as error:
        if not (isinstance(error, MemoryError) or room.lacked(error)):
            raise
        tell([room.words(error)], NOT_DONE)


def progress_shown(quiet: bool) -> Progress:
    """The progress display of a command."""
    return Progress(quiet, lambda: err_console._rich, err_console.say)


def usable_threads(asked: int | None) -> int:
    """The requested number of threads, at most the number of cores."""
    from extrados.analyses.context import default_threads

    cores = default_threads()
    if asked is not None and asked > cores:
        err_console.say(f"--threads {asked} exceeds the {cores} cores of this process, so {cores} threads are used")
    return min(asked or cores, cores)
