"""What the deck models say of themselves: JSON Schema, `explain`, starter decks, the reference manual."""

import difflib
import textwrap
from typing import Any

from extrados.decks.kinds import SECTIONS
from extrados.decks.table import Table


def json_schema() -> dict[str, Any]:
    """JSON Schema of a whole deck, for editors."""
    definitions: dict[str, Any] = {}
    branches: dict[str, list] = {}
    for section, kinds in SECTIONS.items():
        branches[section] = []
        for kind, model in kinds.items():
            schema = model.model_json_schema(ref_template="#/$defs/{model}")
            definitions.update(schema.pop("$defs", {}))
            _allow_units(schema)
            definitions[f"{section}-{kind}"] = schema
            branches[section].append({"$ref": f"#/$defs/{section}-{kind}"})
    one = {section: {"oneOf": refs} for section, refs in branches.items()}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "extrados deck",
        "type": "object",
        "additionalProperties": False,
        "required": ["analysis"],
        "properties": {
            "title": {"type": "string"},
            "note": {"type": "string"},
            "structure": one["structure"],
            "motion": one["motion"],
            "analysis": {"anyOf": [one["analysis"], {"type": "array", "items": one["analysis"]}]},
        },
        "$defs": definitions,
    }


#: Bounds of keys of several types stay in pydantic's words; JSON Schema has its own.
_BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}


def _allow_units(schema: Any) -> None:
    """A key with a unit takes a number or text with a unit."""
    if isinstance(schema, dict):
        bounds = {json_word: schema.pop(word) for word, json_word in _BOUNDS.items() if word in schema}
        for branch in schema.get("anyOf", []) if bounds else []:
            if branch.get("type") in ("number", "integer"):
                branch.update(bounds)
        for value in schema.values():
            _allow_units(value)
        if "unit" in schema and schema.get("type") == "number":
            number = {
                k: schema.pop(k) for k in list(schema) if k not in ("unit", "description", "title", "default", "source")
            }
            schema["anyOf"] = [
                number,
                {"type": "string", "pattern": r"^[+-]?[0-9.]+([eE][+-]?[0-9]+)? +\S.*$"},
            ]
    elif isinstance(schema, list):
        for value in schema:
            _allow_units(value)


def _properties(model: type[Table]) -> dict[str, dict[str, Any]]:
    return model.model_json_schema()["properties"]


def _keys(
    schema: dict[str, Any], definitions: dict[str, Any] | None = None, depth: int = 0
) -> dict[str, dict[str, Any]]:
    """All keys of a table and, dotted, of the tables within it; each says whether it is `required`."""
    definitions = schema.get("$defs", {}) if definitions is None else definitions
    found: dict[str, dict[str, Any]] = {}
    for name, about in schema["properties"].items():
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
    """Type, unit, choices, bounds and default of one key in a few words."""
    facts = []
    branches = [about, *about.get("anyOf", []), about.get("items", {})]
    unit = next((b["unit"] for b in branches if "unit" in b), None)
    if unit:
        facts.append(unit)
    for branch in branches:
        if "enum" in branch:
            facts.append(" | ".join(f'"{c}"' for c in branch["enum"]))
        for word, sign in (
            ("exclusiveMinimum", ">"),
            ("minimum", ">="),
            ("exclusiveMaximum", "<"),
            ("maximum", "<="),
            *((word, sign) for word, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))),
        ):
            if word in branch:
                facts.append(f"{sign} {branch[word]:g}")
    if "default" in about and about["default"] is not None:
        facts.append(f"default {about['default']}")
    return ", ".join(facts)


def _entry(section: str, kind: str, name: str, about: dict[str, Any]) -> str:
    source = f" [{about['source']}]" if about.get("source") else ""
    facts = _facts(about)
    return f"{section}.{name} ({kind}): {about.get('description', '')}{source}" + (f"\n    {facts}" if facts else "")


def explain(word: str) -> str:
    """What a key, a kind or a section means; KeyError with the nearest known word where there is none."""
    if word in SECTIONS:
        rows = [f"{kind:16} {_summary(model)}" for kind, model in SECTIONS[word].items()]
        return f"[{word}] takes kind =\n  " + "\n  ".join(rows)
    found = []
    known: set[str] = set(SECTIONS)
    for section, kinds in SECTIONS.items():
        for kind, model in kinds.items():
            known.add(kind)
            if word == kind:
                rows = [
                    textwrap.indent(_entry(section, kind, name, about), "  ")
                    for name, about in _keys(model.model_json_schema()).items()
                    if name != "kind"
                ]
                found.append(f'[{section}] kind = "{kind}": {_summary(model)}\n' + "\n".join(rows))
            for name, about in _keys(model.model_json_schema()).items():
                last = name.rsplit(".", 1)[-1]
                known.update((name, last))
                if word in (name, last, f"{section}.{name}") and name != "kind":
                    found.append(_entry(section, kind, name, about))
    if not found:
        close = difflib.get_close_matches(word, sorted(known), n=3, cutoff=0.4)
        raise KeyError(f"no key or kind '{word}'" + (f"; near are {', '.join(close)}" if close else ""))
    return "\n".join(found)


def _summary(model: type[Table]) -> str:
    return " ".join((model.__doc__ or "").split())


def starter(kind: str) -> str:
    """A commented deck for an analysis or structure kind; KeyError where there is none."""
    if kind in SECTIONS["analysis"]:
        analysis = SECTIONS["analysis"][kind]
        structures = analysis.structures
        structure = None if structures == () else (structures[0] if structures else next(iter(SECTIONS["structure"])))
    elif kind in SECTIONS["structure"]:
        structure = kind
        analysis = next(a for a in SECTIONS["analysis"].values() if a.structures is None or kind in a.structures)
    else:
        close = difflib.get_close_matches(kind, [*SECTIONS["analysis"], *SECTIONS["structure"]], n=1, cutoff=0.4)
        raise KeyError(f"no kind '{kind}'" + (f"; did you mean '{close[0]}'?" if close else ""))
    lines = [f'title = "A first {kind} deck"', ""]
    if structure:
        lines += _section("structure", SECTIONS["structure"][structure], "[structure]")
    if analysis.needs_motion:
        lines += _section("motion", SECTIONS["motion"][analysis.starter_motion], "[motion]")
    lines += _section("analysis", analysis, "[[analysis]]")
    return "\n".join(lines)


#: Values of required keys in starter decks.
_STARTER = {
    "radius": "5.0", "thickness": '"90 cm"', "embrace": "170.0", "voussoirs": "34", "amplitude": '"1.0 g"',
    "duration": "0.2", "period": "0.5", "frequency": "2.0", "file": '"extrados:el-centro-1940"',
    "width": "1.0", "height": "4.0",
}  # fmt: skip


def _section(section: str, model: type[Table], header: str) -> list[str]:
    from extrados.decks.kinds import kind_of

    lines = [f"# {_summary(model)}", header, f'kind = "{kind_of(model)}"']
    for name, about in _properties(model).items():
        if name == "kind":
            continue
        facts = _facts(about)
        comment = f"  # {about.get('description', '')}" + (f" ({facts})" if facts else "")
        if name in model.starter:
            lines.append(f"{name} = {model.starter[name]}{comment}")
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
    return repr(value)


def manual() -> str:
    """The reference manual of all deck keys, in Markdown."""
    lines = [
        "# Deck reference",
        "",
        "Generated from the deck models (`extrados explain --manual`); do not edit.",
        "",
    ]
    for section, kinds in SECTIONS.items():
        lines += [f"## [{section}]", ""]
        for kind, model in kinds.items():
            lines += [
                f'### kind = "{kind}"',
                "",
                _summary(model),
                "",
                "| key | meaning | type and default |",
                "|---|---|---|",
            ]
            for name, about in _keys(model.model_json_schema()).items():
                if name == "kind":
                    continue
                source = f" ({about['source']})" if about.get("source") else ""
                text = f"{about.get('description', '')}{source}".replace("|", "\\|")
                required = ", required" if about["required"] else ""
                lines.append(f"| `{name}` | {text} | {_facts(about).replace('|', chr(92) + '|')}{required} |")
            lines.append("")
    return "\n".join(lines)
