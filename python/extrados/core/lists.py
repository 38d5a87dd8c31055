"""Names and numbers that the languages share, as compiled into the core (c/include/extrados_lists.h)."""

from functools import cache
from typing import NamedTuple

from extrados import _core


class Entry(NamedTuple):
    """One entry of a list: its number, its name in Fortran and C, its word in decks and results."""

    number: int
    name: str
    word: str


@cache
def _all() -> dict[str, tuple[Entry, ...]]:
    found: dict[str, list[Entry]] = {}
    position = 0
    while True:
        there, number, name, word = _core.api_support.list_entry(position)
        if not there:
            return {key: tuple(entries) for key, entries in found.items()}
        title, entry = name.decode().rstrip("\0 ").split(".")
        found.setdefault(title, []).append(Entry(int(number), entry, word.decode().rstrip("\0 ")))
        position += 1


def entries(title: str) -> tuple[Entry, ...]:
    """The entries of a list in their order; KeyError where there is none of this name."""
    return _all()[title]


def words(title: str) -> dict[int, str]:
    """Number -> word."""
    return {entry.number: entry.word for entry in entries(title)}


def numbers(title: str) -> dict[str, int]:
    """Word -> number."""
    return {entry.word: entry.number for entry in entries(title)}


def number(title: str, name: str) -> int:
    """The number of an entry by its name in Fortran and C."""
    return next(entry.number for entry in entries(title) if entry.name == name)
