"""Analysis kind of the codes: code-checks."""

from typing import ClassVar, Literal

from extrados.analyses.table import BuildingAnalysis
from extrados.schema.quantities import Acceleration, Force, Length, Velocity
from extrados.schema.table import key


class CodeChecks(BuildingAnalysis):
    """Rules for rocking bodies, and for walls as piers, beside the dynamics; each with its source."""

    kind: Literal["code-checks"]
    uses: ClassVar = ("material.density", "material.compressive_strength", "joints.cohesion", "joints.restitution")
    view: ClassVar = ""
    structures: ClassVar = ("block", "column", "panel", "brickwork")
    peak_acceleration: Acceleration | None = key(None, "demand; default that of the motion", gt=0)
    peak_velocity: Velocity | None = key(None, "demand; default that of the motion", gt=0)
    behaviour_factor: float = key(2.0, "q of the linear check", ge=1, le=6, source="NTC 2018, C8.7.1")
    confidence_factor: float = key(1.35, "FC", ge=1, le=2, source="NTC 2018, C8.5.4")
    axial_load: Force | None = key(None, "vertical load on top of the wall; asks for the pier rules", ge=0)
    thickness: Length | None = key(None, "thickness of the pier; default the depth of the block", gt=0)
    sliding_friction: float = key(
        0.4, "coefficient of friction that the code gives for sliding along a bed joint", gt=0, le=2, source="NTC 2018"
    )
    fixity: Literal["cantilever", "double"] = key("cantilever", "rotation of the top: free or held")
