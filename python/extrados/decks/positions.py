"""Where in a TOML text each key stands; tomllib tells values, not lines."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Any

_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\]]*[^\]\s])\s*\]\]?")
_KEY = re.compile(r"""\s*((?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*'))*)\s*=""")
_PART = re.compile(r"""[A-Za-z0-9_-]+|"[^"]*"|'[^']*'""")
_STRING = re.compile(r""""(?:\\.|[^"\\])*"|'[^']*'""")
_CLOSING = {'"""': re.compile(r'(?:\\.|[^\\])*?"""+'), "'''": re.compile(r".*?'''+")}

Path = tuple[str | int, ...]


def _parts(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip("\"'") for part in _PART.findall(dotted))


@dataclass
class _Open:
    """A list (index) or inline table (none) that a value has opened: its path, its line, and the path of its current value."""

    path: Path
    line: int
    index: int | None
    value: Path | None = None


def key_lines(text: str) -> dict[Path, int]:
    """Path -> line number (1-based) of every table header and key of a valid TOML text; within a value, of the entries of lists and
    inline tables that are on another line than the list or table itself."""
    lines: dict[Path, int] = {(): 1}
    tables: dict[tuple[str, ...], int] = {}
    here: Path = ()
    opened: list[_Open] = []
    quote = ""
    for number, line in enumerate(text.split("\n"), start=1):
        start, path = 0, here
        if not quote and not opened:
            if header := _HEADER.match(line):
                name = _parts(header[2])
                if header[1] == "[[":
                    tables[name] = tables.get(name, -1) + 1
                here = ()
                for i, part in enumerate(name, start=1):
                    here += (part,)
                    if name[:i] in tables:
                        here += (tables[name[:i]],)
                lines.setdefault(here, number)
                lines.setdefault(name, number)
                continue
            if found := _KEY.match(line):
                path = here + _parts(found[1])
                lines.setdefault(path, number)
                start = found.end()
        quote = _scan(line, start, number, quote, path, opened, lines)
    return lines


def _scan(line: str, start: int, number: int, quote: str, path: Path, opened: list[_Open], lines: dict[Path, int]) -> str:
    """Follow the value of a path, its strings, lists and inline tables, over one line; the multi-line quote that is open at its end."""
    i = start
    while i < len(line):
        if quote:
            end = _CLOSING[quote].match(line, i)
            if end is None:
                return quote
            quote, i = "", end.end()
            continue
        if line[i] == "#":
            break
        if line[i] not in " \t\r,]}" and opened and (key := _begin(opened[-1], line, i, number, lines)):
            i = key
            continue
        if line.startswith(('"""', "'''"), i):
            quote, i = line[i : i + 3], i + 3
            continue
        if line[i] in "\"'":
            found = _STRING.match(line, i)
            i = found.end() if found else len(line)
            continue
        if line[i] in "[{":
            opened.append(_Open((opened[-1].value or opened[-1].path) if opened else path, number, 0 if line[i] == "[" else None))
        elif line[i] in "]}" and opened:
            opened.pop()
        elif line[i] == "," and opened:
            one = opened[-1]
            one.value, one.index = None, None if one.index is None else one.index + 1
        i += 1
    return quote


def _begin(one: _Open, line: str, i: int, number: int, lines: dict[Path, int]) -> int:
    """Begin an entry of a list or inline table unless one has begun: its path and line; the place after the key of a table, else 0."""
    if one.value is not None:
        return 0
    found = None
    if one.index is None:
        found = _KEY.match(line, i)
        one.value = one.path + (_parts(found[1]) if found else ())
    else:
        one.value = (*one.path, one.index)
    if number != one.line:
        lines.setdefault(one.value, number)
    return found.end() if found else 0


def line_of(path: Path, lines: Mapping[Path, int]) -> int:
    """Line of the nearest known ancestor of a path."""
    while path not in lines:
        path = path[:-1]
    return lines[path]


@dataclass(frozen=True)
class Positions:
    """The keys of one deck by their lines, all 0 where it has no text."""

    name: str = "deck"
    lines: Mapping[Path, int] = field(default_factory=lambda: {(): 0})
    #: What the keys hold, for the names of the tables of a list
    data: Any = None

    def line(self, path: Path) -> int:
        """Line of a key, or of the nearest table around it; 0 without a text."""
        return line_of(path, self.lines)

    def tell(self, path: Path, what: str) -> str:
        """A complaint: "deck.toml:LINE: section.key: what is wrong"."""
        line = self.line(path)
        shown = ".".join(str(part) for part in path if not isinstance(part, int))
        named, colon, rest = what.partition(": ")
        if colon and f".{named}." in f".{shown}.":  # the words name the key themselves
            what = rest
        what += self.entry(path, what)
        return f"{self.name}:{f'{line}:' if line else ''} {f'{shown}: ' if shown else ''}{what}"

    def entry(self, path: Path, what: str) -> str:
        """Of a key within a list of tables that have names: name and number of the table, where the words do not have the name."""
        found, value, named = [], self.data, False
        for part, after in zip_longest(path, path[1:]):
            try:
                value = value[part]
            except (KeyError, IndexError, TypeError):
                break
            if isinstance(part, str) and isinstance(after, int) and isinstance(value, list) and after < len(value):
                one = value[after]
                name = one.get("name") if isinstance(one, dict) else None
                if isinstance(name, str) and f"'{name}'" not in what:
                    found.append(f"{part} '{name[:40]}'")
                    named = True
                elif named:
                    found.append(f"{part} {after + 1}")
        return f" ({', '.join(found)})" if found else ""
