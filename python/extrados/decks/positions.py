"""Where in a TOML text each key stands; tomllib tells values, not lines."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

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
        return f"{self.name}:{f'{line}:' if line else ''} {f'{shown}: ' if shown else ''}{what}"
