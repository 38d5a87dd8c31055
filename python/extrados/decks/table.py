"""The base of every deck table."""

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field


class Table(BaseModel):
    """A TOML table: unknown keys, wrong types, NaN and infinity are refused.

    `starter`: TOML values of keys in the decks that `new` writes, of optional keys too.
    """

    starter: ClassVar[dict[str, str]] = {}
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class Structure(Table):
    """Base of the structure kinds."""

    kind: str


class Motion(Table):
    """Base of the motion kinds."""

    kind: str


class Analysis(Table):
    """Base of the analysis kinds. `structures` names the kinds it takes, None any, () needs none;
    `starter_motion` is the motion kind of the deck that `new` writes."""

    kind: str
    structures: ClassVar[tuple[str, ...] | None] = None
    needs_motion: ClassVar[bool] = False
    starter_motion: ClassVar[str] = "step-pulse"


def key(default: Any = ..., about: str = "", *, source: str = "", **limits: Any) -> Any:
    """A deck key: default, one-sentence meaning, source of the formula behind it, bounds."""
    extra = {"source": source} if source else None
    return Field(default, description=about, json_schema_extra=extra, **limits)
