"""The keys of a deck as a form of the page."""

from typing import Any

from extrados.decks.reader import Deck
from extrados.schema.keys import branches_of, properties_of
from extrados.schema.table import Table

#: Sections of the form, those of the building first
SECTIONS = ("structure", "motion", "joints", "material", "supports", "initial")


def forms_of(deck: Deck) -> list[dict[str, Any]]:
    """Keys of a deck with single values: section, key, value as it stands or its default, unit, choices, meaning."""
    tables: dict[str, Table | None] = {"structure": deck.structure, "motion": deck.motion} | {
        name: getattr(deck.building, name) for name in SECTIONS[2:]
    }
    found = []
    for section in SECTIONS:
        table = tables[section]
        if table is None:
            continue
        given = deck.data.get(section, {})
        for key, about in properties_of(type(table))[0].items():
            branches = branches_of(about)
            if key == "kind" or any("$ref" in b or b.get("type") in ("array", "object") for b in branches):
                continue
            choices = [c for b in branches for c in (*b.get("enum", ()), *([b["const"]] if "const" in b else []))]
            sorts = {b.get("type") for b in branches}
            found.append(
                {
                    "section": section,
                    "key": key,
                    "value": given.get(key, getattr(table, key)),
                    "given": key in given,
                    "unit": next((b["unit"] for b in branches if "unit" in b), ""),
                    "choices": choices,
                    "sort": "choice" if choices and not sorts & {"number", "integer"} else "yes" if "boolean" in sorts else "text",
                    "about": about.get("description", ""),
                    "number": bool(sorts & {"number", "integer"}),
                }
            )
    return found
