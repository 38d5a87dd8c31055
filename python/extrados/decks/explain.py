"""What the deck models say of themselves: their facts, JSON Schema, starter decks."""

import difflib
from collections.abc import Iterator, Mapping
from typing import Any

from extrados import kinds
from extrados.analyses.table import OVERRIDES
from extrados.decks.manual import KeyFacts, TableFacts
from extrados.decks.plural import PLURAL
from extrados.decks.words import WORDS
from extrados.model.properties import Initial, Joints, Material, Supports
from extrados.schema import quantities
from extrados.schema.code import Code
from extrados.schema.table import Table

#: Tables without kinds that say what the building is besides its geometry
PLAIN: dict[str, type[Table]] = {"material": Material, "joints": Joints, "supports": Supports, "initial": Initial}


def sections() -> dict[str, dict[str, type[Table]]]:
    """Section -> kind -> table; a section without kinds has one table, under no name."""
    found = {name: {kind: kinds.table(name, kind) for kind in there} for name, there in kinds.TABLES.items()}
    return {
        "structure": found["structure"],
        **{n: {"": m} for n, m in {**PLAIN, **PLURAL}.items()},
        "motion": found["motion"],
        "code": {"": Code},
        "analysis": found["analysis"],
    }


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
            **{word: {"type": "string", "description": about} for word, about in WORDS.items()},
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


def _keys(schema: dict[str, Any], definitions: dict[str, Any] | None = None, depth: int = 0) -> dict[str, dict[str, Any]]:
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


def _facts(about: dict[str, Any]) -> str:
    """Type, length of a list, unit, choices, bounds and default of one key in a few words."""
    facts = []
    branches = list(_branches(about))
    unit = next((b["unit"] for b in branches if "unit" in b), None)
    facts += [word for word in (_length(about), unit) if word]
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


def _branches(about: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A key, the types that it may have, and those of the values of its lists."""
    yield about
    for branch in (*about.get("anyOf", []), *([about["items"]] if "items" in about else [])):
        yield from _branches(branch)


def _length(about: dict[str, Any]) -> str:
    """How many values a list holds, as "list of 2 to 40" or "list of lists of 4"; "" for a single value and for tables."""
    ways = [about, *about.get("anyOf", [])]
    found = next((way for way in ways if way.get("type") == "array" and "$ref" not in way.get("items", {})), None)
    if found is None:
        return ""
    least, most = found.get("minItems", 0), found.get("maxItems")
    inner = _length(found.get("items", {}))
    if inner:
        return f"list of {inner.replace('list', 'lists', 1)}"
    count = f" of {least}" if least == most else f" of {least} to {most}" if least and most else ""
    count = count or (f" of {least} or more" if least > 1 else f" of at most {most}" if most else "")
    single = any(way.get("type") in ("number", "integer") for way in ways)
    return f"{'number or ' if single else ''}list{count}"


def facts() -> list[TableFacts]:
    """All that the tables say of themselves, in the order of the manual."""
    top = TableFacts(
        "deck",
        "The top of a deck",
        "",
        "Texts before the first table.",
        {word: KeyFacts(about, "", "text", "") for word, about in WORDS.items()},
    )
    tables = ((section, kind, model) for section, there in sections().items() for kind, model in there.items())
    return [top, *(table_facts(*table) for table in tables)]


def table_facts(section: str, kind: str, model: type[Table]) -> TableFacts:
    """All that one table says of itself."""
    schema = model.model_json_schema()
    unless_preset = {name for way in schema.get("anyOf", []) for name in way["required"] if name != "preset"}
    keys = {}
    for name, about in _keys(schema).items():
        required = "required" if about["required"] else "required without a preset" if name in unless_preset else ""
        keys[name] = KeyFacts(about.get("description", ""), about.get("source", ""), _facts(about), required)
    keys.pop("kind", None)
    header = f"[[{section}]]" if section in PLURAL else f"[{section}]"
    return TableFacts(section, header, kind, summary(model), keys)


def summary(model: type[Table]) -> str:
    """The table in one line."""
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
    if analysis.view or analysis.structures or "starter_structure" in vars(analysis):
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
    "radius": "5.0",
    "thickness": '"90 cm"',
    "embrace": "170.0",
    "voussoirs": "34",
    "amplitude": '"1.0 g"',
    "duration": "0.2",
    "period": "0.5",
    "frequency": "2.0",
    "file": '"extrados:el-centro-1940"',
    "width": "1.0",
    "height": "4.0",
}


def _section(model: type[Table], header: str, kind: str = "", starter: Mapping[str, str] | None = None) -> list[str]:
    """A table of a starter deck: keys that need a value have it, the others stand commented out."""
    starter = model.starter if starter is None else starter
    lines = [f"# {summary(model)}", header] + ([f'kind = "{kind}"'] if kind else [])
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
