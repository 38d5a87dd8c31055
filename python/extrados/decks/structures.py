"""Structure kinds of the rocking and limit-analysis rooms."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from extrados.decks.quantities import Angle, Density, Length
from extrados.decks.table import Structure, key


class Arch(Structure):
    """Part-circular arch of equal voussoirs on rigid springings."""

    kind: Literal["arch"]
    radius: Length = key(about="radius of the centre line, R_A", ge=1e-3, le=1e4)
    thickness: Length = key(about="thickness of the ring, t_A", gt=0, le=1e4)
    embrace: Angle = key(about="angle of embrace, beta_A, from springing to springing", ge=20, le=270)
    voussoirs: int = key(about="number of voussoirs, n_A; they set where hinges can form", ge=4, le=5000)
    thickness_factor: float = key(
        1.0, "effective over real thickness; 0.8 for worn corners", source="thesis 5.3.3", gt=0, le=1
    )
    density: Density = key(2000.0, "density of the masonry", gt=0, le=30000)
    depth: Length = key(1.0, "depth out of plane", gt=0)
    restitution: Literal["thesis", "energy-safe"] | Annotated[float, Field(ge=0, le=1)] = key(
        "thesis",
        "impact rule, or the ratio c_v of the rates after and before an impact (0 to 1)",
        source="thesis Eqs 5.3, B.3",
    )

    @model_validator(mode="after")
    def _plausible(self) -> "Arch":
        if self.thickness >= self.radius:
            raise ValueError(f"thickness {self.thickness:g} m is not below the radius {self.radius:g} m")
        return self
