"""Where in a TOML text each key stands; tomllib tells values, not lines."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Any

_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\]]*[^\]\s])\s*\]\]?")
_KEY = re.compile(r"""^\s*((?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*'))*)\s*=""")
_PART = re.compile(r"""[A-Za-z0-9_-]+|"[^"]*"|'[^']*'""")

Path = tuple[str | int, ...]


def _parts(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip("\"'") for part in _PART.findall(dotted))


def key_lines(text: str) -> dict[Path, int]:
    """Path -> line number (1-based) of every table header and key of a valid TOML text."""
    lines: dict[Path, int] = {(): 1}
    tables: dict[tuple[str, ...], int] = {}
    here: Path = ()
    depth = 0
    quote = ""
    for number, line in enumerate(text.split("\n"), start=1):
        if not quote and depth == 0:
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
                lines.setdefault(here + _parts(found[1]), number)
                line = line[found.end() :]
        quote, depth = _scan(line, quote, depth)
    return lines


def _scan(line: str, quote: str, depth: int) -> tuple[str, int]:
    """Follow strings and brackets over one line: open multi-line quote and bracket depth at its end."""
    i = 0
    while i < len(line):
        if quote:
            if quote[0] == '"' and line[i] == "\\":
                i += 2
                continue
            if line.startswith(quote, i):
                i += len(quote)
                quote = ""
                continue
        elif line.startswith(('"""', "'''"), i):
            quote = line[i : i + 3]
            i += 3
            continue
        elif line[i] in "\"'":
            quote = line[i]
        elif line[i] == "#":
            break
        elif line[i] in "[{":
            depth += 1
        elif line[i] in "]}":
            depth = max(0, depth - 1)
        i += 1
    return (quote if len(quote) == 3 else ""), depth


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
