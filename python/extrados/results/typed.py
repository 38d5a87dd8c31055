"""Results of every kind by their models: from the keys of summary.json, and as the list of shapes they may have."""

from typing import Any, get_args

from pydantic import TypeAdapter

from extrados import kinds
from extrados.results.verdict import KindResults, SelfWeight


def shapes(kind: str) -> tuple[type[KindResults], ...]:
    """The models that the results of an analysis kind may have, SelfWeight for all; KeyError where there is no such kind."""
    model = kinds.load(kinds.ANALYSES[kind].results)
    return *(get_args(model) or (model,)), SelfWeight


def typed(kind: str, values: dict[str, Any]) -> KindResults:
    """Results of a kind from their keys and values; an empty dictionary, where there is no result, gives an empty model.

    pydantic's ValidationError says what is missing, unknown or of a wrong type.
    """
    if not values:
        return KindResults()
    fields = SelfWeight.model_fields
    if {name for name, field in fields.items() if field.is_required()} <= values.keys() <= fields.keys():
        return SelfWeight.model_validate(values)
    return TypeAdapter(kinds.load(kinds.ANALYSES[kind].results)).validate_python(values)
