"""The rigid block on two toes."""

from typing import ClassVar, Literal

from pydantic import model_validator

from extrados.decks.quantities import Density, Inertia, Length, Mass
from extrados.decks.table import Structure, key

_BODY = ("mass", "inertia", "centre_height", "toe_right", "toe_left")


class Block(Structure):
    """Rigid block that rocks on its two toes: a rectangle, or a body given by mass, inertia, centre and toes."""

    kind: Literal["block"]
    starter: ClassVar = {"width": "1.0", "height": "4.0"}
    width: Length | None = key(None, "full width B of a rectangle", gt=0)
    height: Length | None = key(None, "full height H of a rectangle", gt=0)
    depth: Length = key(1.0, "depth out of plane", gt=0)
    density: Density = key(2000.0, "density of a rectangle", gt=0, le=30000)
    mass: Mass | None = key(None, "mass of a body that is no rectangle", gt=0)
    inertia: Inertia | None = key(None, "its moment of inertia about the centre of mass", gt=0)
    centre_height: Length | None = key(None, "height of its centre of mass above the toes", gt=0)
    toe_right: Length | None = key(None, "horizontal distance of the right toe from the centre of mass", gt=0)
    toe_left: Length | None = key(None, "the same of the left toe; default as the right one", gt=0)
    restitution: Literal["housner"] | float = key(
        "housner",
        "impact rule, or the ratio c_v of the rates after and before an impact (0 to 1)",
        source="thesis Eqs 6.2, 6.3",
    )
    energy_ratio: float | None = key(
        None,
        "instead of restitution: c_E, the kinetic energy after over that before an impact",
        source="thesis Eq. 6.2",
    )
    form: Literal["nonlinear", "linear"] = key(
        "nonlinear", "full equations, or the linear form of slender blocks", source="Housner 1963"
    )
    initial_rotation_ratio: float = key(
        0.0, "rotation at the start over the critical one of that side; positive to +x", source="thesis 6.2.2"
    )

    @model_validator(mode="after")
    def _complete(self) -> "Block":
        body = [name for name in _BODY if getattr(self, name) is not None]
        if self.width is not None or self.height is not None:
            if body:
                raise ValueError(
                    f"width and height describe a rectangle, {', '.join(body)} another body: give one of the two"
                )
            if self.width is None or self.height is None:
                raise ValueError("a rectangle needs width and height")
        elif missing := [name for name in _BODY[:-1] if getattr(self, name) is None]:
            raise ValueError(f"give width and height, or {', '.join(_BODY[:-1])} ({', '.join(missing)} missing)")
        if self.energy_ratio is not None:
            if self.restitution != "housner":
                raise ValueError("give restitution or energy_ratio, not both")
            if not 0.0 <= self.energy_ratio <= 1.0:
                raise ValueError(f"energy_ratio is {self.energy_ratio:g}, expected 0 to 1")
        if not isinstance(self.restitution, str) and not 0.0 <= self.restitution <= 1.0:
            raise ValueError(f'restitution is {self.restitution:g}, expected 0 to 1 or "housner"')
        if not abs(self.initial_rotation_ratio) < 1.0:
            raise ValueError(
                f"initial_rotation_ratio is {self.initial_rotation_ratio:g}: at 1 the block is past its balance and falls "
                "by itself; expected between -1 and 1"
            )
        return self
