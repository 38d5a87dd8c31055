"""Places on a wall: edges, ranges of x and y, openings."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, model_validator

from extrados.schema.quantities import Unit, parse
from extrados.schema.table import Table, key


def _range(value: Any) -> Any:
    """A place along an axis: one length, or [from, to]."""
    ends = value if isinstance(value, list) else [value, value]
    if len(ends) != 2:
        raise ValueError("expected one length, or two lengths as [from, to]")
    out = []
    for end in ends:
        if isinstance(end, bool) or not isinstance(end, int | float | str):
            raise ValueError("expected a length such as 1.2 or '20 mm', or two lengths as [from, to]")
        out.append(parse(end, "m") if isinstance(end, str) else float(end))
    if out[0] > out[1]:
        raise ValueError(f"the range goes from {out[0]:g} m down to {out[1]:g} m: give the smaller value first")
    return out


class _OneOrTwo(Unit):
    """The JSON Schema of a range: what a deck may hold, not what is made of it."""

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> dict[str, Any]:
        length = {"type": "number", "unit": "m"}
        return {"anyOf": [length, {"type": "array", "items": length, "minItems": 2, "maxItems": 2}], "unit": "m"}


Range = Annotated[list[float], BeforeValidator(_range), _OneOrTwo("m")]


class Placed(Table):
    """Something on the nodes of an edge, within ranges of x and y, or (x and y single) on the nearest node."""

    edge: Literal["left", "right", "bottom", "top"] | None = key(None, "outer edge of the wall")
    x: Range | None = key(None, "x of the place, or its range [from, to]")
    y: Range | None = key(None, "y of the place, or its range [from, to]")

    @model_validator(mode="after")
    def _somewhere(self) -> "Placed":
        if self.edge is None and self.x is None and self.y is None:
            raise ValueError("the place is missing: give `edge`, `x` or `y`")
        return self


class Opening(Table):
    """A rectangle cut out: an opening, or a notch where it reaches an edge."""

    x: Range = key(about="range [from, to] of x")
    y: Range = key(about="range [from, to] of y")

    @model_validator(mode="after")
    def _area(self) -> "Opening":
        if self.x[0] == self.x[1] or self.y[0] == self.y[1]:
            raise ValueError("an opening requires a width and a height: give x = [from, to] and y = [from, to]")
        return self

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top [m]."""
        return self.x[0], self.x[1], self.y[0], self.y[1]

    def is_outside(self, length: float, height: float) -> bool:
        """Whether it lies beside a wall of these sizes [m]."""
        return self.x[1] <= 0 or self.x[0] >= length or self.y[1] <= 0 or self.y[0] >= height
