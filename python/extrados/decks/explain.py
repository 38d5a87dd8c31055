"""What the deck models say of themselves: JSON Schema, `explain`, starter decks, the reference manual."""

import difflib
import textwrap
from typing import Any

from extrados import kinds
from extrados.analyses.table import OVERRIDES
from extrados.building.properties import Initial, Joints, Material, Supports
from extrados.schema.table import Table

#: Tables without kinds that say what the building is besides its geometry
PLAIN: dict[str, type[Table]] = {"material": Material, "joints": Joints, "supports": Supports, "initial": Initial}


def sections() -> dict[str, dict[str, type[Table]]]:
    """Section -> kind -> table; a section without kinds has one table, under no name."""
    found = {name: {kind: kinds.table(name, kind) for kind in there} for name, there in kinds.TABLES.items()}
    return {"structure": found["structure"], **{n: {"": m} for n, m in PLAIN.items()},
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
        _allow_units(schema)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "extrados deck",
        "type": "object",
        "additionalProperties": False,
        "required": ["analysis"],
        "properties": {
            "title": {"type": "string"},
            "note": {"type": "string"},
            **one,
            "materials": {"type": "object", "additionalProperties": one["material"]},
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
    of = f" ({kind})" if kind else ""
    return f"{section}.{name}{of}: {about.get('description', '')}{source}" + (f"\n    {facts}" if facts else "")


def explain(word: str) -> str:
    """What a key, a kind or a section means; KeyError with the nearest known word where there is none."""
    everything = sections()
    if word in kinds.TABLES:
        rows = [f"{kind:16} {_summary(model)}" for kind, model in everything[word].items()]
        return f"[{word}] takes kind =\n  " + "\n  ".join(rows)
    found = []
    known: set[str] = set(everything)
    for section, there in everything.items():
        for kind, model in there.items():
            known.add(kind)
            keys = {name: about for name, about in _keys(model.model_json_schema()).items() if name != "kind"}
            if word == (kind or section):
                rows = [textwrap.indent(_entry(section, kind, name, about), "  ") for name, about in keys.items()]
                head = f'[{section}] kind = "{kind}"' if kind else f"[{section}]"
                found.append(f"{head}: {_summary(model)}\n" + "\n".join(rows))
            for name, about in keys.items():
                last = name.rsplit(".", 1)[-1]
                known.update((name, last))
                if word in (name, last, f"{section}.{name}"):
                    found.append(_entry(section, kind, name, about))
    if not found:
        close = difflib.get_close_matches(word, sorted(known), n=3, cutoff=0.4)
        raise KeyError(f"no key or kind '{word}'" + (f"; near are {', '.join(close)}" if close else ""))
    return "\n".join(found)


def _summary(model: type[Table]) -> str:
    return " ".join((model.__doc__ or "").split())


def starter(kind: str) -> str:
    """A commented deck for a kind; KeyError where there is none."""
    section = next((name for name in ("analysis", "structure", "motion") if kind in kinds.TABLES[name]), None)
    if section is None:
        known = [kind for there in kinds.TABLES.values() for kind in there]
        close = difflib.get_close_matches(kind, known, n=1, cutoff=0.4)
        raise KeyError(f"no kind '{kind}'" + (f"; did you mean '{close[0]}'?" if close else ""))
    structure = kind if section == "structure" else "arch"
    asked = kind if section == "analysis" else "motion" if section == "motion" else "tilt"
    if kind == "panel" or (section == "structure" and "blocks" in kinds.table("structure", kind).lacks):
        asked = "sla"  # a wall that is given whole is cut into elements
    analysis = kinds.table("analysis", asked)
    structure = analysis.structures[0] if section == "analysis" and analysis.structures else structure
    lines = [f'title = "A first {kind} deck"', ""]
    if analysis.view or analysis.structures:
        lines += _section(kinds.table("structure", structure), "[structure]", structure)
        for name in OVERRIDES:
            if any(use.startswith(f"{name}.") for use in analysis.uses):
                lines += _section(PLAIN[name], f"[{name}]")
    if analysis.needs_motion or section == "motion":
        motion = kind if section == "motion" else analysis.starter_motion
        lines += _section(kinds.table("motion", motion), "[motion]", motion)
    lines += _section(analysis, "[[analysis]]", asked)
    return "\n".join(lines)


#: Values of required keys in starter decks.
_STARTER = {
    "radius": "5.0", "thickness": '"90 cm"', "embrace": "170.0", "voussoirs": "34", "amplitude": '"1.0 g"',
    "duration": "0.2", "period": "0.5", "frequency": "2.0", "file": '"extrados:el-centro-1940"',
    "width": "1.0", "height": "4.0",
}  # fmt: skip


def _section(model: type[Table], header: str, kind: str = "") -> list[str]:
    lines = [f"# {_summary(model)}", header] + ([f'kind = "{kind}"'] if kind else [])
    for name, about in _properties(model).items():
        if name == "kind" or (kind and name in OVERRIDES):
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
    for section, there in sections().items():
        lines += [f"## [{section}]", ""]
        for kind, model in there.items():
            lines += [
                *([f'### kind = "{kind}"', ""] if kind else []),
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
