"""The base of typed results: what an analysis gives, each value with its meaning, its unit and where it comes from.

One definition serves drivers, summary.json and its JSON Schema, `explain`, the manual and the figures.
"""

import math
from collections.abc import Iterator, KeysView
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator


def fact(about: str, unit: str = "", *, source: str = "", name: str | None = None) -> Any:
    """A value that the analysis always gives: one-sentence meaning, unit ("" where it has none), source of a formula.

    name: the key where Python cannot call it so.
    """
    return Field(..., description=about, json_schema_extra=_extra(unit, source), alias=name)


def maybe(about: str, unit: str = "", *, source: str = "") -> Any:
    """A value that is given only where the question or the building asks for it; elsewhere it is None in Python
    and has no key in summary.json."""
    return Field(None, description=about, json_schema_extra=_extra(unit, source))


#: Keyword arguments of a model of results: the keys that are given
Keys = dict[str, Any]


def given(**keys: Any) -> Keys:
    """The keys with a value, for the keys of a model that are given only where the question asks for them (`maybe`)."""
    return {name: value for name, value in keys.items() if value is not None}


def _extra(unit: str, source: str) -> dict[str, Any]:
    return {k: v for k, v in (("unit", unit), ("source", source)) if v}


class ResultModel(BaseModel):
    """Results of an analysis, or a row within them. They read as attributes and, by the keys of summary.json, as a
    mapping of what was given.

    A missing or unknown key fails at once. Arrays and numpy's numbers are taken as lists and numbers; what is not
    finite becomes None, which JSON writes as null, so a value that may be so says `| None`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, populate_by_name=True)

    @model_validator(mode="before")
    @classmethod
    def _taken(cls, values: Any) -> Any:
        return {name: plain(value) for name, value in values.items()} if isinstance(values, dict) else values

    def keys(self) -> KeysView[str]:
        """The keys that were given, as summary.json has them."""
        fields = type(self).model_fields.items()
        return {field.alias or name: None for name, field in fields if name in self.model_fields_set}.keys()

    def __getitem__(self, key: str) -> Any:
        for name, field in type(self).model_fields.items():
            if key == (field.alias or name) and name in self.model_fields_set:
                return getattr(self, name)
        raise KeyError(f"no result has the key '{key}'; the keys are: {', '.join(self.keys()) or 'none'}")

    def __contains__(self, key: str) -> bool:
        return key in self.keys()

    def get(self, key: str, default: Any = None) -> Any:
        """The value of a key, `default` where it was not given."""
        return self[key] if key in self else default

    def items(self) -> Iterator[tuple[str, Any]]:
        """Keys and values that were given."""
        return ((key, self[key]) for key in self.keys())

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """What was given, long lists by their length, models within it by their number of values."""
        for name in type(self).model_fields:
            if name in self.model_fields_set:
                value = getattr(self, name)
                if isinstance(value, ResultModel):
                    yield name, _Long(len(value.model_fields_set))
                else:
                    yield name, _Long(len(value)) if isinstance(value, list) and _is_long(value) else value

    def as_json(self) -> dict[str, Any]:
        """What summary.json holds."""
        return self.model_dump(by_alias=True, exclude_unset=True)


#: Values of a list that the representation of a model shows, and letters of texts in it
_SHOWN, _LETTERS = 8, 60


def _is_long(values: list[Any]) -> bool:
    return len(values) > _SHOWN or sum(len(one) for one in values if isinstance(one, str)) > _LETTERS


class _Long(int):
    """The length of a list that is too long to show."""

    def __repr__(self) -> str:
        return f"[... {int(self)} values]"


def plain(value: Any) -> Any:
    """Lists, dictionaries and Python's own numbers instead of numpy's; None for NaN and infinity, which JSON lacks."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    return value
