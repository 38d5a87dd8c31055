"""Ties, struts and springs of a building, [[ties]], said once for every strategy."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from extrados.model.errors import BadGeometry
from extrados.schema.quantities import AxialStiffness, Force, Length
from extrados.schema.table import Table, key

Point = Annotated[list[Length], Field(min_length=2, max_length=2)]
#: [x, y] in a plane section, [x, y, z] among blocks in space
Place = Annotated[list[Length], Field(min_length=2, max_length=3)]


class Tie(Table):
    """A straight tie, strut or spring between two blocks, or from a block to the ground; in space also a chain or a hoop: [[ties]]."""

    name: str | None = key(None, "name in the results; default: tie 1, tie 2 and so on", max_length=80)
    start: Place = key(about="[x, y], in space [x, y, z], of the anchorage in a block; for a hoop, any point at its height")
    end: Place | None = key(None, "position of the other end, if it is anchored in a block; otherwise give `ground`")
    ground: Place | None = key(None, "position of the other end, if it is anchored in the ground; this end stays fixed when supports move")
    via: list[Place] = key([], "in space: points of the blocks over which a chain runs, in order from start to end", max_length=1000)
    hoop: bool = key(
        False, "in space: closed hoop around the convex outline of the structure, at the height z of `start`, like the chain of a dome"
    )
    bonded: bool = key(
        False,
        "for a chain or hoop. true: anchored at each point, so that each segment has its own force; "
        "false: slides over the points without friction",
    )
    start_stone: str | None = key(
        None, "name of the block at `start`; required if this point lies between two blocks or outside all blocks", max_length=80
    )
    end_stone: str | None = key(
        None, "name of the block at `end`; required if this point lies between two blocks or outside all blocks", max_length=80
    )
    works_in: Literal["tension", "compression", "both"] = key(
        "tension",
        "senses in which the tie acts. tension: a tie, slack in compression; compression: a strut, slack in tension; both: a spring",
    )
    yield_force: Force | None = key(
        None, "yield force, which remains constant after yielding; without this value, the tie never yields", gt=0
    )
    stiffness: AxialStiffness | None = key(
        None,
        "axial stiffness EA/L (force / elongation). Without this value the tie is rigid until it yields; "
        "limit analysis always assumes a rigid tie",
        gt=0,
    )
    prestress: Force = key(0.0, "force in the tie before any load acts, tension positive; a plastic collapse load does not depend on it")

    @model_validator(mode="after")
    def _whole(self) -> "Tie":
        if self.hoop:
            if self.end is not None or self.ground is not None or self.via or self.start_stone or self.end_stone:
                raise ValueError(
                    "hoop: a closed hoop takes none of the keys `end`, `ground`, `via`, `start_stone` and `end_stone`; `start` gives its height"
                )
            if len(self.start) != 3:
                raise ValueError("start: a hoop requires [x, y, z], where z is its height")
        elif (self.end is None) == (self.ground is None):
            raise ValueError("expected either the key `end` (anchorage in another block) or the key `ground`")
        if len({len(point) for point in (self.start, *self.via, *([] if self.hoop else [self.far]))}) != 1:
            raise ValueError("start: expected the same number of coordinates for all points of a tie")
        if self.bonded and not self.hoop and not self.via:
            raise ValueError("the key `bonded` is only for a hoop, or for a chain with `via`")
        if self.start == self.far:
            raise ValueError("start: both ends have the same position")
        if self.ground is not None and self.end_stone is not None:
            raise ValueError("`end_stone` requires the key `end`, but this tie has the key `ground`: remove `end_stone`")
        if self.prestress > self.most or self.prestress < self.least:
            raise ValueError(
                f"prestress: {self.prestress:g} N exceeds the range that the tie can carry, {self.least:g} to {self.most:g} N "
                "(tension positive)"
            )
        return self

    def flat(self) -> list[list[float]]:
        """Both ends in a plane section [m]; BadGeometry of a tie in space."""
        if len(self.start) != 2 or self.via:
            raise BadGeometry(f"{self.name}: in a plane section a tie must be straight, with points [x, y]")
        return [self.start, self.far]

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
