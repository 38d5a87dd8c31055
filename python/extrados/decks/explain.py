"""What the deck models say of themselves: JSON Schema, `explain`, starter decks, the reference manual."""

import difflib
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any, get_args

from extrados import kinds
from extrados.analyses.table import OVERRIDES
from extrados.building.properties import Initial, Joints, Material, Supports
from extrados.decks.plural import PLURAL
from extrados.schema import quantities
from extrados.schema.table import Table

#: Tables without kinds that say what the building is besides its geometry
PLAIN: dict[str, type[Table]] = {"material": Material, "joints": Joints, "supports": Supports, "initial": Initial}


def sections() -> dict[str, dict[str, type[Table]]]:
    """Section -> kind -> table; a section without kinds has one table, under no name."""
    found = {name: {kind: kinds.table(name, kind) for kind in there} for name, there in kinds.TABLES.items()}
    return {"structure": found["structure"], **{n: {"": m} for n, m in {**PLAIN, **PLURAL}.items()},
            "motion": found["motion"], "analysis": found["analysis"]}  # fmt: skip


def json_schema() -> dict[str, Any]:
    """JSON Schema of a whole deck, for editors."""
    definitions: dict[str, Any] = {}
    one: dict[str, dict[str, Any]] = {}
    for section, known in sections().items():
        refs = []
        for kind, model in known.items():
            schema = model.model_json_schema(ref_template="#/$defs/{model}")
            definitions.update(schema.pop("$defs", {}))
            definitions[f"{section}-{kind}" if kind else section] = schema
            refs.append({"$ref": f"#/$defs/{section}-{kind}" if kind else f"#/$defs/{section}"})
        one[section] = {"oneOf": refs} if len(refs) > 1 else refs[0]
    for schema in definitions.values():
        _as_in_decks(schema)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "extrados deck",
        "type": "object",
        "additionalProperties": False,
        "required": ["analysis"],
        "properties": {
            "title": {"type": "string"},
            **{word: {"type": "string"} for word in ("project", "author", "date")},
            "note": {"type": "string"},
            **one,
            **{name: {"type": "array", "items": one[name]} for name in PLURAL},
            "materials": {"type": "object", "additionalProperties": one["material"]},
            "analysis": {"anyOf": [one["analysis"], {"type": "array", "items": one["analysis"]}]},
        },
        "$defs": definitions,
    }


#: Bounds of keys of several types stay in pydantic's words; JSON Schema has its own.
_BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
#: Keywords of a schema that speak of a number, not of its key
_OF_NUMBER = {"type", *_BOUNDS.values(), "multipleOf"}


def _as_in_decks(schema: Any) -> None:
    """Say what a deck may hold where a table holds what was made of it: a quantity is a number, or text with its unit."""
    if isinstance(schema, dict):
        bounds = {json_word: schema.pop(word) for word, json_word in _BOUNDS.items() if word in schema}
        for branch in schema.get("anyOf", []) if bounds else []:
            if branch.get("type") in ("number", "integer"):
                branch.update(bounds)
        for value in schema.values():
            _as_in_decks(value)
        if "unit" in schema and schema.get("type") == "number":
            number = {word: schema.pop(word) for word in list(schema) if word in _OF_NUMBER}
            text = {"type": "string", "pattern": quantities.pattern(schema["unit"])}
            schema["anyOf"] = [number, text] if schema.pop("bare", True) else [text]
    elif isinstance(schema, list):
        for value in schema:
            _as_in_decks(value)


def _properties(model: type[Table]) -> dict[str, dict[str, Any]]:
    return model.model_json_schema()["properties"]


def _keys(
    schema: dict[str, Any], definitions: dict[str, Any] | None = None, depth: int = 0
) -> dict[str, dict[str, Any]]:
    """All keys of a table and, dotted, of the tables within it; each says whether it is `required`."""
    definitions = schema.get("$defs", {}) if definitions is None else definitions
    found: dict[str, dict[str, Any]] = {}
    for name, about in schema["properties"].items():
        if depth == 0 and "kind" in schema["properties"] and name in OVERRIDES:
            continue  # they repeat the keys of the building's own table
        found[name] = {**about, "required": name in schema.get("required", [])}
        places = [about, about.get("items", {}), about.get("additionalProperties", {}), *about.get("anyOf", [])]
        for place in [*places, *(p.get("items", {}) for p in places if isinstance(p, dict))]:
            if isinstance(place, dict) and "$ref" in place and depth < 3:
                inner = definitions[place["$ref"].rsplit("/", 1)[1]]
                if "properties" in inner:
                    within = _keys(inner, definitions, depth + 1)
                    found |= {f"{name}.{key}": value for key, value in within.items()}
    return found


def _names(model: type[Table]) -> set[str]:
    """The names of all keys of a table and of the tables within it."""
    names = set(model.model_fields) - ({"kind", *OVERRIDES} if "kind" in model.model_fields else set())
    for name in tuple(names):
        for inner in _tables_in(model.model_fields[name].annotation):
            names |= _names(inner)
    return names


def _tables_in(annotation: Any) -> Iterator[type[Table]]:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        yield annotation
    for part in get_args(annotation):
        yield from _tables_in(part)


def _facts(about: dict[str, Any]) -> str:
    """Type, unit, choices, bounds and default of one key in a few words."""
    facts = []
    branches = [about, *about.get("anyOf", []), about.get("items", {})]
    unit = next((b["unit"] for b in branches if "unit" in b), None)
    if unit:
        facts.append(unit)
    for branch in branches:
        if "enum" in branch:
            facts.append(" | ".join(f'"{c}"' for c in branch["enum"]))
        if "const" in branch:
            facts.append(f'or "{branch["const"]}"')
        for word, sign in (
            ("exclusiveMinimum", ">"),
            ("minimum", ">="),
            ("exclusiveMaximum", "<"),
            ("maximum", "<="),
            *((word, sign) for word, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))),
        ):
            if word in branch:
                facts.append(f"{sign} {branch[word]:g}")
    if about.get("default") not in (None, []) and not isinstance(about["default"], dict):
        facts.append(f"default {_toml(about['default'])}")
    return ", ".join(facts)


def _entry(section: str, kind: str, name: str, about: dict[str, Any]) -> str:
    source = f" [{about['source']}]" if about.get("source") else ""
    facts = _facts(about)
    of = f" ({kind})" if kind else ""
    return f"{section}.{name}{of}: {about.get('description', '')}{source}" + (f"\n    {facts}" if facts else "")


def explain(word: str) -> str:
    """What a key, a kind or a section means; KeyError with the nearest known word where there is none.

    A key may follow its table or its kind: "friction", "joints.friction", "analysis.tilt", "tilt.fracture".
    """
    everything = sections()
    if word == "materials":
        return "[materials.NAME]: Further materials, with the keys of [material], for the parts that name them."
    if word in kinds.TABLES:
        rows = [f"{kind:16} {_summary(model)}" for kind, model in everything[word].items()]
        return f"[{word}] takes kind =\n  " + "\n  ".join(rows)
    found = []
    known: set[str] = set(everything)
    for section, there in everything.items():
        for kind, model in there.items():
            names = _names(model)
            known |= {kind, *names}
            itself = word in (kind or section, f"{section}.{kind}")
            if not itself and word.rsplit(".", 1)[-1] not in names:
                continue  # to work out what it says takes long
            keys = {name: about for name, about in _keys(model.model_json_schema()).items() if name != "kind"}
            if itself:
                rows = [textwrap.indent(_entry(section, kind, name, about), "  ") for name, about in keys.items()]
                head = f'[{section}] kind = "{kind}"' if kind else _header(section)
                found.append(f"{head}: {_summary(model)}\n" + "\n".join(rows))
            asked = {name for name in keys if word in _called(section, kind, name)}
            found += [
                _entry(section, kind, name, about)
                for name, about in keys.items()
                if any(name == one or name.startswith(f"{one}.") for one in asked)
            ]
    if not found:
        close = difflib.get_close_matches(word, sorted(known), n=3, cutoff=0.4)
        raise KeyError(f"no key or kind '{word}'" + (f"; near are {', '.join(close)}" if close else ""))
    return "\n".join(found)


def _called(section: str, kind: str, name: str) -> set[str]:
    """What a user may call a key."""
    return {name, name.rsplit(".", 1)[-1], f"{section}.{name}", f"{kind}.{name}", f"{section}.{kind}.{name}"}


def _header(section: str) -> str:
    """The header of a section in a deck."""
    return f"[[{section}]]" if section in PLURAL else f"[{section}]"


def _summary(model: type[Table]) -> str:
    return " ".join((model.__doc__ or "").split())


def starter(kind: str) -> str:
    """A commented deck for a kind; KeyError where there is none."""
    section = next((name for name in ("analysis", "structure", "motion") if kind in kinds.TABLES[name]), None)
    if section is None:
        known = [kind for there in kinds.TABLES.values() for kind in there]
        close = difflib.get_close_matches(kind, known, n=1, cutoff=0.4)
        raise KeyError(f"no kind '{kind}'" + (f"; did you mean '{close[0]}'?" if close else ""))
    asked = kind
    if section == "structure":
        asked = kinds.table("structure", kind).starter_analysis
    elif section == "motion":
        asked = "motion"
    analysis = kinds.table("analysis", asked)
    structure = kind if section == "structure" else analysis.starter_structure
    if analysis.structures and structure not in analysis.structures:
        structure = analysis.structures[0]
    lines = [f'title = "A first {kind} deck"', ""]
    if analysis.view or analysis.structures:
        lines += _section(kinds.table("structure", structure), "[structure]", structure)
        for name in OVERRIDES:
            if any(use.startswith(f"{name}.") for use in analysis.uses):
                model = PLAIN[name]
                used = {key: value for key, value in model.starter.items() if f"{name}.{key}" in analysis.uses}
                lines += _section(model, f"[{name}]", starter=used)
    motion = kind if section == "motion" else analysis.starter_motion or ("step-pulse" if analysis.needs_motion else "")
    if motion:
        lines += _section(kinds.table("motion", motion), "[motion]", motion)
    lines += _section(analysis, "[[analysis]]", asked)
    return "\n".join(lines)


#: Values of required keys in starter decks.
_STARTER = {
    "radius": "5.0", "thickness": '"90 cm"', "embrace": "170.0", "voussoirs": "34", "amplitude": '"1.0 g"',
    "duration": "0.2", "period": "0.5", "frequency": "2.0", "file": '"extrados:el-centro-1940"',
    "width": "1.0", "height": "4.0",
}  # fmt: skip


def _section(model: type[Table], header: str, kind: str = "", starter: Mapping[str, str] | None = None) -> list[str]:
    """A table of a starter deck: keys that need a value have it, the others stand commented out."""
    starter = model.starter if starter is None else starter
    lines = [f"# {_summary(model)}", header] + ([f'kind = "{kind}"'] if kind else [])
    for name, about in _properties(model).items():
        if name == "kind" or (kind and name in OVERRIDES):
            continue
        facts = _facts(about)
        comment = f"  # {about.get('description', '')}" + (f" ({facts})" if facts else "")
        if name in starter:
            lines.append(f"{name} = {starter[name]}{comment}")
        elif "default" in about:
            default = about["default"]
            value = "..." if default is None else _toml(default)
            lines.append(f"# {name} = {value}{comment}")
        else:
            lines.append(f"{name} = {_STARTER.get(name, _toml('...'))}{comment}")
    return [*lines, ""]


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list):
        return f"[{', '.join(_toml(v) for v in value)}]"
    return f"{value:g}" if isinstance(value, float) and abs(value) >= 1e6 else repr(value)


def manual() -> str:
    """The reference manual of all deck keys, in Markdown."""
    lines = [
        "# Deck reference",
        "",
        "Generated from the deck models (`extrados explain --manual`); do not edit.",
        "",
    ]
    for section, there in sections().items():
        lines += [f"## {_header(section)}", ""]
        for kind, model in there.items():
            lines += [
                *([f'### kind = "{kind}"', ""] if kind else []),
                _summary(model),
                "",
                "| key | meaning | type and default |",
                "|---|---|---|",
            ]
            schema = model.model_json_schema()
            unless_preset = {name for way in schema.get("anyOf", []) for name in way["required"] if name != "preset"}
            for name, about in _keys(schema).items():
                if name == "kind":
                    continue
                source = f" ({about['source']})" if about.get("source") else ""
                text = f"{about.get('description', '')}{source}".replace("|", "\\|")
                required = (
                    ", required"
                    if about["required"]
                    else ", required without a preset"
                    if name in unless_preset
                    else ""
                )
                lines.append(f"| `{name}` | {text} | {_facts(about).replace('|', chr(92) + '|')}{required} |")
            lines.append("")
    return "\n".join(lines)
