"""The base of every deck table."""

from math import ceil
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, create_model, field_validator, model_validator

from extrados.schema.quantities import Length, Time

#: Size of a number in SI that no structure and no motion reaches, and below which it can only be zero
LARGEST, SMALLEST = 1e15, 1e-15


def within_reason(value: Any) -> Any:
    """The value; ValueError for a number that is beyond reason, also within lists: products of such numbers are infinite or
    zero. In a list, of coordinates, a number below SMALLEST is the rounding of 0, and becomes 0."""
    if isinstance(value, list):
        return [0.0 if isinstance(item, float) and abs(item) < SMALLEST else within_reason(item) for item in value]
    if isinstance(value, float) and value != 0.0 and not SMALLEST <= abs(value) <= LARGEST:
        raise ValueError(f"{value:g} is not a plausible size; expected 0, or a size from {SMALLEST:g} to {LARGEST:g}")
    return value


class Table(BaseModel):
    """A TOML table: unknown keys, wrong types, NaN, infinity and numbers beyond reason are refused.

    `starter`: TOML values of keys in the decks that `new` writes, of optional keys too.
    """

    starter: ClassVar[dict[str, str]] = {}

    @field_validator("*")
    @classmethod
    def _within_reason(cls, value: Any) -> Any:
        return within_reason(value)

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)


def key(default: Any = ..., about: str = "", *, source: str = "", **limits: Any) -> Any:
    """A deck key: default, one-sentence meaning, source of the formula behind it, bounds."""
    extra: dict[str, Any] | None = {"source": source} if source else None
    return Field(default, description=about, json_schema_extra=extra, **limits)


#: Height of a storey where a deck does not give their number [m]: a default of this program
STOREY = 3.0


def storeys_in(height: float) -> int:
    """Storeys of a building so high [m] whose number is not given; more storeys amplify more, so that one alone is unsafe."""
    return max(1, ceil(height / STOREY - 1e-9))


class FloorBelow(Table):
    """The floor of a building on which the structure stands: it is shaken by the floor, not by the ground."""

    height: Length = key(about="height z of the floor above the foundation", gt=0)
    building_height: Length = key(about="height H of the building", gt=0)
    building_period: Time | None = key(None, "first period T_1 of the building; default 0.05 H^0.75", gt=0, source="EN 1998-1 Eq. 4.6")
    building_damping: float = key(0.05, "damping ratio of the building", gt=0, le=0.3)
    storeys: int | None = key(
        None,
        "number N of storeys of the building: gamma_1 = 3 N/(2 N + 1); default: one storey for each 3 m of its height, rounded up",
        ge=1,
        le=50,
        source="Circ. 7/2019 [C7.2.10]",
    )

    @property
    def levels(self) -> int:
        """Storeys of the deck, or by the height."""
        return self.storeys or storeys_in(self.building_height)

    @model_validator(mode="after")
    def _within(self) -> "FloorBelow":
        if self.height > self.building_height:
            raise ValueError(f"height: {self.height:g} m is above the top of the building ({self.building_height:g} m)")
        return self


class Motion(Table):
    """Base of the motion kinds."""

    kind: str
    floor: FloorBelow | None = key(
        None, "floor of a building on which the structure stands; each analysis then applies the motion of this floor"
    )


class _Built(Table):
    """A table whose validator is built at once: one that many tables hold would be built anew for each of them."""

    model_config = ConfigDict(defer_build=False)


def override_of(model: type[Table], module: str) -> type[Table]:
    """The table by which an analysis replaces values of a building's table for itself: every key optional.

    Rules over several keys are those of `model`, which the two together must meet. `module`: where it stands, by the name
    <model>Override, so that it can be pickled.
    """
    fields: dict[str, Any] = {}
    for name, field in model.model_fields.items():
        bounded: Any = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
        asked = Field(None, description=field.description, json_schema_extra=field.json_schema_extra)
        fields[name] = (bounded | None, asked)
    return create_model(f"{model.__name__}Override", __base__=_Built, __doc__=model.__doc__, __module__=module, **fields)
