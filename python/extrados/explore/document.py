"""The text of a deck that a hand changes: values are put in their places, all else stays as its author wrote it."""

import re
from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.items import AoT, Item

from extrados.schema.quantities import factor

QUANTITY = re.compile(r"\s*([-+0-9.eE]+)\s*([^\d\s].*?)\s*")


def text_of(data: Mapping[str, Any]) -> str:
    """A deck in memory as TOML; keys without a value are not written."""

    def given(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: given(one) for key, one in value.items() if one is not None}
        return [given(one) for one in value] if isinstance(value, list | tuple) else value

    return tomlkit.dumps(given(data))


class Document:
    """The text of a deck: changes are written when the text is requested, with the last value of each key."""

    def __init__(self, text: str):
        self._text = text
        self._put: dict[tuple[str, ...], Any] = {}

    @property
    def text(self) -> str:
        """The deck as TOML."""
        if self._put:
            made = tomlkit.parse(self._text)
            for path, value in self._put.items():
                _put(made, path, value)
            self._text, self._put = tomlkit.dumps(made), {}
        return self._text

    def put(self, path: list[str], value: Any) -> None:
        """Give the key at a path another value; None takes it out. Elements of arrays are called by their number."""
        self._put.pop(tuple(path), None)  # what is put last is written last
        self._put[tuple(path)] = value


def _put(place: Any, path: tuple[str, ...], value: Any) -> None:
    """Give the key at a path of a TOML document a value."""
    *way, last = path
    for k, part in enumerate(way):
        if isinstance(place, list):
            place = place[int(part)]
        else:
            if part not in place:
                place[part] = tomlkit.array() if (way[k + 1 : k + 2] or [last])[0].isdecimal() else tomlkit.table()
            place = place[part]
    if isinstance(place, list):
        place[int(last)] = _item(value)
    elif value is None:
        place.pop(last, None)
    elif last in place:
        kept = place[last]
        place[last] = made = _item(value)
        if isinstance(kept, Item) and isinstance(made, Item) and not isinstance(made, AoT):
            made.trivia.comment, made.trivia.comment_ws = kept.trivia.comment, kept.trivia.comment_ws
            made.trivia.trail = kept.trivia.trail
    else:
        place[last] = _item(value)


def _item(value: Any) -> Any:
    """A value of TOML; floats as a reader writes them, tables within arrays in one line."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        made = tomlkit.array()
        for row in value:
            line = tomlkit.inline_table()
            line.update({k: _item(v) for k, v in row.items()})
            made.append(line)
        return made
    if isinstance(value, dict):
        table = tomlkit.table()
        for key, inner in value.items():
            table[key] = _item(inner)
        return table
    return tomlkit.item(value)


def as_written(value: Any, before: Any, si: str, bare: bool = True) -> Any:
    """A number in `si` in the unit that the author used for the former value."""
    if isinstance(before, str) and isinstance(value, int | float):
        found = QUANTITY.fullmatch(before)
        if found:
            try:
                return f"{tidy(value / factor(found[2], si))} {found[2]}"
            except ValueError:
                pass
    if not bare:
        return f"{tidy(value)} {si}"
    return float(tidy(value)) if isinstance(value, float) else value


def tidy(value: float) -> str:
    """A number with six digits and no more zeros than it needs."""
    text = f"{value:.6g}"
    return text if "e" in text or "." in text or "n" in text else text + ".0" if abs(value) < 1e6 else text
