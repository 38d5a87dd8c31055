"""Ties, struts and springs of a building, [[ties]], said once for every strategy."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from extrados.schema.quantities import AxialStiffness, Force, Length
from extrados.schema.table import Table, key

Point = Annotated[list[Length], Field(min_length=2, max_length=2)]


class Tie(Table):
    """A straight tie, strut or spring between two stones, or from a stone to the ground: [[ties]]."""

    name: str | None = key(None, "name in results; default tie 1, tie 2 and so on", max_length=80)
    start: Point = key(about="[x, y] of the anchorage in a stone")
    end: Point | None = key(None, "[x, y] of the anchorage in another stone; or give `ground`")
    ground: Point | None = key(None, "[x, y] of the anchorage in the ground, which does not move with the supports")
    start_stone: str | None = key(
        None, "name of the stone at `start`; needed if that point lies between two stones or in none", max_length=80
    )
    end_stone: str | None = key(
        None, "name of the stone at `end`; needed if that point lies between two stones or in none", max_length=80
    )
    works_in: Literal["tension", "compression", "both"] = key(
        "tension", "a tie is slack in compression, a strut in tension; a spring works in both"
    )
    yield_force: Force | None = key(
        None, "force at which it yields and from then on carries on, in the senses it works in; without it it never yields",
        gt=0,
    )  # fmt: skip
    stiffness: AxialStiffness | None = key(
        None, "force per change of length, EA/L; without it it is rigid until it yields, as limit analysis takes every tie",
        gt=0,
    )  # fmt: skip
    prestress: Force = key(0.0, "force in it before any load, tension positive; it changes no load of plastic collapse")

    @model_validator(mode="after")
    def _whole(self) -> "Tie":
        if (self.end is None) == (self.ground is None):
            raise ValueError("expected either end, in another stone, or ground")
        if self.start == self.far:
            raise ValueError("start: both ends are at one point")
        if self.ground is not None and self.end_stone is not None:
            raise ValueError("end_stone: belongs to end, not to ground")
        if self.prestress > self.most or self.prestress < self.least:
            raise ValueError(
                f"prestress: {self.prestress:g} N is more than it can carry, {self.least:g} to {self.most:g} N (tension positive)"
            )
        return self

    @property
    def far(self) -> list[float]:
        """The point at its other end, in a stone or in the ground [m]."""
        return (self.end if self.ground is None else self.ground) or []

    @property
    def most(self) -> float:
        """Greatest tension that it carries [N]; infinite where it never yields."""
        if self.works_in == "compression":
            return 0.0
        return float("inf") if self.yield_force is None else self.yield_force

    @property
    def least(self) -> float:
        """Greatest compression that it carries [N], negative."""
        if self.works_in == "tension":
            return 0.0
        return -float("inf") if self.yield_force is None else -self.yield_force
