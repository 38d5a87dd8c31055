"""Whether limit analysis agrees with elements on what stands under its own weight."""

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.common import loads_of
from extrados.building.building import Building
from extrados.building.geometry.solids.assembly import SolidAssembly
from extrados.limit.answer import why_not
from extrados.limit.equilibrium import Disconnected
from extrados.limit.errors import NoAnswer
from extrados.limit.programme import LimitAnalysis
from extrados.limit.solids import SolidLimit

WEDGED = (
    "limit analysis finds forces by which it could stand, as friction holds a stone that is wedged in; elements begin "
    "without such forces"
)
#: Walls of more joints are not held against limit analysis, which would take as long as the elements.
MOST_JOINTS = 3000
#: Nor are more solids.
MOST_SOLIDS = 300


def against_limit_analysis(building: Building, stands: bool) -> str:
    """What is to be said of elements that found that a building stands, or that it falls; empty where limit analysis
    finds that it stands too, or has no answer."""
    try:
        if len(building.blocks().a) > MOST_JOINTS:
            return ""
        limit = LimitAnalysis(building.blocks(), building.friction(), loads=loads_of(building.blocks(), None, building))
        admissible = limit.stands()
        reason = "" if admissible else why_not(limit)
    except (NoAnswer, Disconnected, Refused):
        return ""
    if admissible:
        return "" if stands else WEDGED
    if not stands:
        return f"limit analysis agrees: {reason}"
    return f"elements stand {_held(building, None)}, but limit analysis finds that it cannot stand under its own weight: {reason}"


def _held(building: Building, assembly: SolidAssembly | None) -> str:
    """By what a building stands that limit analysis finds to fall."""
    for name in ("cohesion", "tension"):
        if np.nanmax(building.joint_property(name, assembly), initial=0.0) > 0.0:
            return "by the cohesion and tension of its joints, which limit analysis leaves out"
    return "for no reason known"


def solids_against_limit_analysis(building: Building, stands: bool) -> str:
    """The same of blocks in space."""
    assembly = building.solids()
    if len(assembly.mass) > MOST_SOLIDS:
        return ""
    try:
        found = SolidLimit(assembly, building.friction(assembly)).falls()
    except NoAnswer:
        return ""
    if found is None:
        return "" if stands else WEDGED
    name = assembly.block_names[int(np.linalg.norm(found.motion[:, :3], axis=1).argmax())]
    reason = f"a motion, fastest at {name}, that no contact hinders and by which the weights do work"
    if not stands:
        return f"limit analysis agrees: {reason}"
    return f"elements stand {_held(building, assembly)}, but limit analysis finds that it cannot stand under its own weight: {reason}"
