"""TOML as decks are written in it: what would take tomllib gigabytes, or us too deep, is refused."""

import re
import tomllib
from typing import Any

DEEPEST = 60  # parts of a key, tables within tables
_WORD = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
#: Of a key of n parts tomllib keeps n keys of 1 to n parts: 30 kB of a.a.a. ... took 3.6 GB
_LONG = re.compile(rf"""(?<![\w"'.-]){_WORD}(?:[ \t]*+\.[ \t]*+{_WORD}){{{DEEPEST}}}""")


class TooDeep(ValueError):
    """No deck is nested like this."""

    def __init__(self) -> None:
        super().__init__("this value is nested too deeply for a deck")


def loads(text: str) -> dict[str, Any]:
    """The values in a text; ValueError says why there are none."""
    if _LONG.search(text):
        raise TooDeep
    try:
        found = tomllib.loads(text)
    except RecursionError:
        raise TooDeep from None
    level: list[Any] = [found]
    for _ in range(DEEPEST):
        within = [v for one in level for v in (one.values() if isinstance(one, dict) else one)]
        level = [v for v in within if isinstance(v, dict | list)]
    if level:
        raise TooDeep
    return found
