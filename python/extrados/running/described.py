"""What a run tells of its building for who reads the report: its dimensions, its properties with their units and sources."""

from typing import Any

from extrados.decks.reader import Deck
from extrados.model.dimensions import dimensions
from extrados.model.errors import BadGeometry
from extrados.motions.floors import floor_condition
from extrados.schema.quantities import unit_of
from extrados.schema.table import Table

#: Tables whose keys a report shows where they were given, and those that it shows whole
GIVEN, WHOLE = ("structure", "motion", "supports", "initial", "code"), ("material", "joints")
#: Keys of these that say nothing where they are as they are by default
QUIET: tuple[Any, ...] = (None, [], False)


def described(deck: Deck) -> dict[str, Any]:
    """`dimensions` of the drawing [m], `properties`: a row for each, with its unit and who set it, and `conditions` that hold for all
    analyses."""
    floor = None if deck.motion is None else deck.motion.floor
    conditions = [] if floor is None else [floor_condition(floor)]
    return {"dimensions": _dimensions(deck), "properties": _properties(deck), "conditions": conditions}


def _dimensions(deck: Deck) -> list[dict[str, Any]]:
    if deck.structure is None:
        return []
    try:
        found = dimensions(deck.building.blocks())
    except BadGeometry:  # a wall that is seen whole, or what could not be made
        size = [(name, getattr(deck.structure, name, None)) for name in ("width", "height", "thickness")]
        return [{"name": name, "length_m": float(value)} for name, value in size if isinstance(value, float)]
    return [{"name": d.name, "length_m": d.length, "start": d.start, "end": d.end, "aside": d.aside} for d in found]


def _properties(deck: Deck) -> list[dict[str, Any]]:
    building = deck.building
    tables: dict[str, Table | None] = {
        name: getattr(building, name) for name in ("structure", *WHOLE, "supports", "initial")
    }
    tables |= {f"materials.{name}": table for name, table in building.materials.items()}
    for name in ("ties", "dampers", "hinges"):
        tables |= {f"{name}.{one.name}": one for one in getattr(building, name)}
    tables |= {"motion": deck.motion, "code": deck.code}
    return [row for name, table in tables.items() if table is not None for row in _rows(name, table)]


def _rows(name: str, table: Table) -> list[dict[str, Any]]:
    found = []
    for key, field in type(table).model_fields.items():
        value = getattr(table, key)
        given = key in table.model_fields_set
        if not given and (name not in WHOLE or value in QUIET):
            continue
        extra = field.json_schema_extra
        found.append({
            "table": name, "key": key, "value": _plain(value), "unit": unit_of(type(table), key), "about": field.description or "",
            "from": "deck" if given else "default", "source": str(extra.get("source", "")) if isinstance(extra, dict) else "",
        })  # fmt: skip
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, Table):
        return value.model_dump(exclude_none=True)
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value
