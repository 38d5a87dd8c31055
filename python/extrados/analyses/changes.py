"""Keys of a deck given other values, and the tables made of them."""

import copy
from collections.abc import Iterable
from typing import Any

from pydantic import ValidationError

from extrados.analyses.context import Refused
from extrados.model.errors import WHOLE, BadGeometry
from extrados.schema.table import Table


def changed(data: Any, path: str, value: Any) -> Any:
    """A deck, or a table of one, with one key, dotted for a table within it or one of a list, set to another value."""
    data = copy.deepcopy(data)
    place: Any = data
    *way, last = path.split(".")
    for part in way:
        if isinstance(place, list) and part.isdecimal() and int(part) < len(place):
            place = place[int(part)]
        elif isinstance(place, dict):
            place = place.setdefault(part, {})
        if not isinstance(place, dict | list):
            raise Refused(f"'{path}' is not a key of the deck", WHOLE)
    if not isinstance(place, dict):
        raise Refused(f"'{path}' is not a key of the deck", WHOLE)
    place[last] = value
    return data


def read_table(model: type[Table], data: dict[str, Any]) -> Any:
    """The checked table; BadGeometry with the first complaint."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(p) for p in first["loc"])
        text = str(first.get("ctx", {}).get("error", first["msg"]))
        if first["type"] == "extra_forbidden":
            text = f"unknown key; the keys are {', '.join(model.model_fields)}"
        raise BadGeometry(f"{where}: {text}" if where else text) from None


def lacking(data: dict[str, Any], without: Iterable[str]) -> dict[str, Any]:
    """A deck's data without tables or keys, called as Building.special_keys calls them: "[[ties]]", "[supports] abutting_wall"."""
    data = dict(data)
    for what in without:
        table, _, name = what.replace("[", "").replace("]", "").partition(" ")
        if name:
            data[table] = {k: v for k, v in data[table].items() if k not in (name, "rebound")}
        else:
            data.pop(table, None)
    return data
