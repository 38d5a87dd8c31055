"""What the JSON schema of a table says of its keys."""

from functools import lru_cache
from typing import Any

from extrados.schema.table import Table


@lru_cache(maxsize=64)
def properties_of(model: type[Table]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The keys of a table in its JSON schema, and the definitions that they refer to."""
    schema = model.model_json_schema()
    return schema.get("properties", {}), schema.get("$defs", {})


def branches_of(about: dict[str, Any]) -> list[dict[str, Any]]:
    """What may stand at a key: its schema, its alternatives, and the items of lists."""
    found = [about, *about.get("anyOf", [])]
    return found + [b["items"] for b in found if isinstance(b.get("items"), dict)]


def unit_along(table: type[Table], way: list[str]) -> tuple[str, bool]:
    """The unit of the key that a way leads to within a table, and whether a number may stand there without it."""
    properties, definitions = properties_of(table)
    about: dict[str, Any] = {}
    for part in way:
        if part.isdecimal():
            continue
        if part not in properties:
            return "", True
        about = properties[part]
        reference = next((b["$ref"] for b in branches_of(about) if "$ref" in b), None)
        if reference is not None:
            properties = definitions[reference.rsplit("/", 1)[1]].get("properties", {})
    found = next((b for b in branches_of(about) if "unit" in b), {})
    return found.get("unit", ""), found.get("bare", True)
