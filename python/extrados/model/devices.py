"""Dampers of a building, [[dampers]], and what is added at its joints, [[hinges]], said once for every strategy."""

from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.ties import Place
from extrados.schema.quantities import AxialStiffness, Damping, Force, Moment, TurningDamping
from extrados.schema.table import Table, key


class Damper(Table):
    """A damper between two blocks, or from a block to the ground: [[dampers]].

    Viscous: F = c |v|^n. Friction behind a brace: elastic up to the slip force, then sliding under this force in both senses.
    """

    name: str | None = key(None, "name in the results; default: damper 1, damper 2 and so on", max_length=80)
    start: Place = key(about="[x, y], in space [x, y, z], of the anchorage in a block")
    end: Place | None = key(None, "position of the other end, if it is anchored in a block; otherwise give `ground`")
    ground: Place | None = key(None, "position of the other end, if it is anchored in the ground; this end moves with the supports")
    start_stone: str | None = key(None, "name of the block at `start`; required if this point lies between two blocks", max_length=80)
    end_stone: str | None = key(None, "name of the block at `end`; required if this point lies between two blocks", max_length=80)
    damping: Damping | None = key(
        None, "c of a viscous damper, in N (s/m)^n: force = c v^n, with the rate of elongation v and n = `power`", gt=0, le=1e10
    )
    power: float = key(1.0, "exponent n of the rate of elongation; 1 for a linear damper", source="EN 15129", ge=0.1, le=2)
    slip_force: Force | None = key(None, "force at which a friction damper slides", gt=0)
    stiffness: AxialStiffness | None = key(None, "stiffness of a friction damper before it slides (stiffness of its brace)", gt=0)

    @model_validator(mode="after")
    def _whole(self) -> "Damper":
        if (self.end is None) == (self.ground is None):
            raise ValueError("expected either the key `end` (anchorage in another block) or the key `ground`")
        if self.start == self.far:
            raise ValueError("start: both ends have the same position")
        if len(self.start) != len(self.far):
            raise ValueError("start: expected the same number of coordinates at both ends")
        if (self.damping is None) == (self.slip_force is None):
            raise ValueError(
                "expected either the key `damping` (viscous damper), or the keys `slip_force` and `stiffness` (friction damper)"
            )
        if (self.slip_force is None) != (self.stiffness is None):
            raise ValueError("`slip_force` and `stiffness` require each other: give both")
        return self

    @property
    def far(self) -> list[float]:
        """The point at its other end, in a stone or in the ground [m]."""
        return (self.end if self.ground is None else self.ground) or []

    def flat(self) -> list[list[float]]:
        """Both ends in a plane section [m]; BadGeometry of a damper in space."""
        if len(self.start) != 2:
            raise BadGeometry(f"{self.name}: in a plane section a damper requires points [x, y]; this damper has points [x, y, z]")
        return [self.start, self.far]

    @property
    def most(self) -> float:
        """Force at which a friction damper slides [N], in both senses; 0 of a viscous one, which has no spring."""
        return self.slip_force or 0.0


class AddedHinge(Table):
    """Stiffness and damping added at joints, which act on the relative rotation of the adjacent blocks: [[hinges]]."""

    name: str | None = key(None, "name in the results; default: hinge 1, hinge 2 and so on", max_length=80)
    joints: list[str] = key(
        about='names of joints; "ground" means all joints at the ground, "all" means every joint', min_length=1, max_length=10000
    )
    stiffness: Moment | None = key(None, "moment per radian of rotation", gt=0)
    yield_moment: Moment | None = key(None, "moment at which the hinge yields, for both senses of rotation; requires `stiffness`", gt=0)
    damping: TurningDamping | None = key(None, "viscous damping of the hinge: moment divided by angular velocity", gt=0)

    @model_validator(mode="after")
    def _whole(self) -> "AddedHinge":
        if self.stiffness is None and self.damping is None:
            raise ValueError("expected stiffness or damping")
        if self.yield_moment is not None and self.stiffness is None:
            raise ValueError("yield_moment needs stiffness")
        return self
