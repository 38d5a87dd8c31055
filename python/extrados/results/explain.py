"""What the result models say of themselves: JSON Schema of summary.json, `explain results.KIND`, the manual."""

import difflib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import TypeAdapter
from pydantic.fields import FieldInfo

from extrados import kinds
from extrados.results.assumptions import Assumption
from extrados.results.fields import ResultModel
from extrados.results.typed import shapes
from extrados.results.verdict import Verdict

#: How `explain` knows the results from the deck
SECTION = "results"


@dataclass(frozen=True)
class Fact:
    """One key of the results: dotted, [] for the rows of a list, NAME for those of a table of names."""

    key: str
    about: str
    unit: str
    source: str
    always: bool


def facts(model: type[ResultModel], before: str = "") -> Iterator[Fact]:
    """All keys of a model and of the rows within it."""
    for name, field in model.model_fields.items():
        key = before + (field.alias or name)
        yield fact_of(key, field)
        for inner, mark in _rows(field.annotation):
            yield from facts(inner, f"{key}{mark}.")


def fact_of(key: str, field: FieldInfo) -> Fact:
    """What a field says of itself, under a key."""
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    unit, source = (str(extra.get(name, "")) for name in ("unit", "source"))
    return Fact(key, field.description or "", unit, source, field.is_required())


def _rows(annotation: Any, mark: str = "") -> Iterator[tuple[type[ResultModel], str]]:
    """The models within a type, each with what stands between its key and theirs."""
    if isinstance(annotation, type) and issubclass(annotation, ResultModel):
        yield annotation, mark
    origin: Any = getattr(annotation, "__origin__", None)
    for part in get_args(annotation):
        yield from _rows(part, {list: "[]", dict: ".NAME"}.get(origin, mark))


def summary(model: type[ResultModel]) -> str:
    """The model in one line."""
    return " ".join((model.__doc__ or "").split())


#: What every analysis gives beside its results
BESIDE: dict[str, type[ResultModel]] = {"verdict": Verdict, "assumptions": Assumption}


def explain(word: str) -> str:
    """What "results", "results.KIND" or "results.KIND.KEY" mean, or "results.verdict"; KeyError with the nearest known word where there is none."""
    path = word.split(".", 2)[1:]
    if not path:
        rows = [
            f"{kind:16} {summary(model).removeprefix(f'{kind}: ')}" for kind in kinds.ANALYSES for model in shapes(kind)
        ]
        return "Results of an analysis, in summary.json and as run[NAME]:\n  " + "\n  ".join(rows)
    kind, *rest = path
    if path[-1] in BESIDE:
        model = BESIDE[path[-1]]
        return f"{path[-1]}: {summary(model)}\n" + "\n".join(f"  {_line(f)}" for f in facts(model))
    if kind not in kinds.ANALYSES:
        raise KeyError(f"no results of a kind '{kind}'" + _near(kind, list(kinds.ANALYSES)))
    if not rest:
        parts = [f"{summary(model)}\n" + "\n".join(f"  {_line(f)}" for f in facts(model)) for model in shapes(kind)]
        return "\n".join(parts)
    known = {f.key: f for model in shapes(kind) for f in facts(model)}
    within = (f"{rest[0]}.", f"{rest[0]}[].")
    found = [f for key, f in known.items() if key == rest[0] or key.startswith(within)]
    found = found or [f for key, f in known.items() if key.rsplit(".", 1)[-1] == rest[0]]
    if not found:
        raise KeyError(f"the results of {kind} have no key '{rest[0]}'" + _near(rest[0], list(known)))
    return "\n".join(f"{SECTION}.{kind}.{_line(f)}" for f in found)


def _near(word: str, known: list[str]) -> str:
    close = difflib.get_close_matches(word, known, n=3, cutoff=0.4)
    return f"; near are {', '.join(close)}" if close else ""


def _line(f: Fact) -> str:
    unit, source = f" [{f.unit}]" if f.unit else "", f" ({f.source})" if f.source else ""
    return f"{f.key}{unit}: {f.about}{source}" + ("" if f.always else "; where it applies")


def manual() -> str:
    """The reference manual of all results, in Markdown."""
    lines = [
        "# Results reference",
        "",
        "Generated from the result models (`extrados explain --results`); do not edit. Keys are those of `summary.json`;",
        "`[]` stands for the rows of a list, `.NAME` for the entries of a table of names. From Python they read as",
        '`run["tilt"].collapse_acceleration_g` or `run["tilt"]["collapse_acceleration_g"]`.',
        "",
        "## Every analysis",
        "",
        "Beside its results each analysis gives these.",
        "",
    ]
    of_each: dict[str, type[ResultModel]] = {"verdict": Verdict, "assumptions.KEY": Assumption}
    for head, model in of_each.items():
        lines += [f"### {head}", "", summary(model), "", *_table(model)]
    for kind in kinds.ANALYSES:
        lines += [f"## {kind}", ""]
        for shape in shapes(kind):
            lines += [summary(shape), "", *_table(shape)]
    return "\n".join(lines).rstrip() + "\n"


def _table(model: type[ResultModel]) -> list[str]:
    rows = ["| key | meaning | unit | given |", "|---|---|---|---|"]
    for f in facts(model):
        about = (f.about + (f" ({f.source})" if f.source else "")).replace("|", "\\|")
        rows.append(f"| `{f.key}` | {about} | {f.unit} | {'always' if f.always else 'where it applies'} |")
    return [*rows, ""]


def json_schema() -> dict[str, Any]:
    """JSON Schema of summary.json."""
    definitions: dict[str, Any] = {}

    def placed(model: Any) -> dict[str, Any]:
        schema = TypeAdapter(model).json_schema(ref_template="#/$defs/{model}", mode="serialization")
        definitions.update(schema.pop("$defs", {}))
        return schema

    nothing = {"type": "object", "maxProperties": 0}
    verdict, assumption = placed(Verdict), placed(Assumption)
    branches = [
        {
            "properties": {
                "kind": {"const": kind},
                "results": {"anyOf": [placed(kinds.load(parts.results)), nothing]},
            }
        }
        for kind, parts in kinds.ANALYSES.items()
    ]
    text = {"type": "string"}
    analysis = {
        "type": "object",
        "additionalProperties": False,
        "required": [
            "name", "kind", "status", "reason", "seconds", "answer", "warnings", "verdict", "assumptions", "results",
        ],
        "properties": {
            "name": text,
            "kind": {"enum": list(kinds.ANALYSES)},
            "status": {"enum": ["ok", "refused", "failed", "interrupted"]},
            "reason": text,
            "seconds": {"type": "number", "minimum": 0},
            "answer": text,
            "warnings": {"type": "array", "items": text},
            "verdict": {"anyOf": [verdict, {"type": "null"}]},
            "assumptions": {"type": "object", "additionalProperties": assumption},
            "results": {"type": "object"},
        },
        "oneOf": branches,
        "if": {"properties": {"status": {"const": "ok"}}},
        "then": {"properties": {"verdict": {"type": "object"}, "results": {"minProperties": 1}}},
    }  # fmt: skip
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "extrados summary.json",
        "type": "object",
        "additionalProperties": False,
        "required": ["extrados", "deck", "analyses"],
        "properties": {
            "extrados": {"type": "object", "additionalProperties": text, "required": ["version", "commit", "compiler"]},
            "deck": {"type": "object", "required": ["path", "sha256", "resolved"]},
            "analyses": {"type": "array", "items": analysis},
            "files": {"type": "object", "additionalProperties": text},
        },
        "$defs": definitions,
    }
