"""What the result models say of themselves: their facts, and the JSON Schema of summary.json."""

from collections.abc import Iterator
from typing import Any, get_args

from pydantic import TypeAdapter
from pydantic.fields import FieldInfo

from extrados import kinds
from extrados.results.assumptions import Assumption
from extrados.results.fields import ResultModel
from extrados.results.manual import Fact, ResultFacts, ShapeFacts
from extrados.results.typed import shapes
from extrados.results.verdict import SelfWeight, Verdict


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


def everything() -> ResultFacts:
    """All that the models say of themselves."""

    def told(model: type[ResultModel]) -> ShapeFacts:
        return ShapeFacts(summary(model), list(facts(model)))

    return ResultFacts(
        {"verdict": told(Verdict), "assumptions": told(Assumption), "self-weight": told(SelfWeight)},
        {kind: [told(model) for model in shapes(kind) if model is not SelfWeight] for kind in kinds.ANALYSES},
    )


def json_schema() -> dict[str, Any]:
    """JSON Schema of summary.json."""
    models = {"verdict": Verdict, "assumption": Assumption, "self-weight": SelfWeight}
    models |= {f"results of {kind}": kinds.load(parts.results) for kind, parts in kinds.ANALYSES.items()}
    # all at once: models of one name in two rooms are told apart
    placed, shared = TypeAdapter.json_schemas(
        [(name, "serialization", TypeAdapter(model)) for name, model in models.items()], ref_template="#/$defs/{model}"
    )
    definitions: dict[str, Any] = shared.get("$defs", {})
    schemas = {name: schema for (name, _), schema in placed.items()}
    nothing = {"type": "object", "maxProperties": 0}
    branches = [
        {"properties": {"kind": {"const": kind}, "results": {"anyOf": [schemas[f"results of {kind}"], schemas["self-weight"], nothing]}}}
        for kind in kinds.ANALYSES
    ]
    text = {"type": "string"}
    analysis = {
        "type": "object",
        "additionalProperties": False,
        "required": ["name", "kind", "status", "reason", "seconds", "answer", "warnings", "verdict", "assumptions", "results"],
        "properties": {
            "name": text,
            "kind": {"enum": list(kinds.ANALYSES)},
            "status": {"enum": ["ok", "refused", "failed", "interrupted"]},
            "reason": text,
            "seconds": {"type": "number", "minimum": 0},
            "answer": text,
            "warnings": {"type": "array", "items": text},
            "verdict": {"anyOf": [schemas["verdict"], {"type": "null"}]},
            "assumptions": {"type": "object", "additionalProperties": schemas["assumption"]},
            "results": {"type": "object"},
        },
        "oneOf": branches,
        "if": {"properties": {"status": {"const": "ok"}}},
        "then": {"properties": {"verdict": {"type": "object"}, "results": {"minProperties": 1}}},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "extrados summary.json",
        "type": "object",
        "additionalProperties": False,
        "required": ["extrados", "deck", "analyses"],
        "properties": {
            "extrados": {"type": "object", "additionalProperties": text, "required": ["version", "commit", "compiler"]},
            "computed": {"type": "object", "additionalProperties": text, "required": ["at", "host"]},
            "deck": {"type": "object", "required": ["path", "sha256", "resolved"]},
            "analyses": {"type": "array", "items": analysis},
            "files": {"type": "object", "additionalProperties": text},
        },
        "$defs": definitions,
    }
