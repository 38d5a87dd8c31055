"""Ties, chains, hoops and loads of a deck on blocks in space, and the programmes of the blocks with them."""

from dataclasses import replace
from typing import Literal

import numpy as np

from extrados.analyses.limit.applied import place_of
from extrados.analyses.limit.common import SLACK
from extrados.analyses.limit.tables import SpatialLimit, Tilt
from extrados.limit.crushing import CrushingLimit
from extrados.limit.mortar import mortared
from extrados.limit.solids import SolidLimit
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.results.limit import TieForce
from extrados.results.model import Array
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.solids.strands import strand_names


def solid_limit(
    building: Building, options: SpatialLimit, beams: np.ndarray | None = None, assembly: SolidAssembly | None = None
) -> SolidLimit:
    """The programmes of a building's blocks with its ties, the strengths of its contacts and the loads of an analysis; loads that
    sway rest on the blocks as fill does, and so do `beams` (n, 5): block, mass [kg] and place [m] of parts of ring beams.
    assembly: the blocks, by default those of the building."""
    assembly = building.solids() if assembly is None else assembly
    fill, resting = [assembly.fill, np.empty((0, 5)) if beams is None else beams], np.zeros((len(assembly.mass), 6))
    for k, load in enumerate(options.load):
        block, point = place_of(assembly, load, k)
        force = np.array([load.horizontal, 0.0, 0.0 if load.sways else -load.force])
        resting[block] += np.concatenate([force, np.cross(point - assembly.centroid[block], force)])
        if load.sways:
            fill.append(np.array([[block, load.force / GRAVITY, *point]]))
    loaded = replace(assembly, fill=np.concatenate(fill))
    friction, tension = building.friction(assembly), np.zeros(len(assembly.a))
    if isinstance(options, Tilt) and options.mortar == "ductile":
        loaded, tension = mortared(loaded, friction, *(building.joint_property(name, assembly) for name in ("cohesion", "tension")))
    if (strength := building.material.compressive_strength) is not None:
        return CrushingLimit(loaded, friction, np.full(len(tension), strength), building.strands(), resting, tension)
    return SolidLimit(loaded, friction, building.strands(), resting, tension)


def warn_of_mortar(building: Building, limit: SolidLimit) -> str | None:
    """Told where contacts bear less tension than the deck gives."""
    given = building.joint_property("tension", limit.assembly)
    less = np.flatnonzero(limit.tension < given)
    if not len(less):
        return None
    j = int(less[(given - limit.tension)[less].argmax()])
    return (
        f"{len(less)} contacts carry less tension than the deck gives, because Coulomb's law allows at most cohesion / friction: "
        f"{limit.assembly.joint_names[j]} carries {limit.tension[j] / 1000.0:.3g} kPa instead of {given[j] / 1000.0:.3g} kPa"
    )


def strand_rows(building: Building, limit: SolidLimit, tension: np.ndarray) -> list[TieForce]:
    """Tension of each strand in a state [N]; the segments of a bonded chain are numbered."""
    rows = []
    names = strand_names(building, limit.strands)
    for name, strand, force in zip(names, limit.strands, tension.tolist(), strict=True):
        whole = max(b for b in (strand.high, -strand.low, 0.0) if np.isfinite(b)) or float(limit.weight.sum())
        yields = force > strand.high - SLACK * whole or force < strand.low + SLACK * whole
        state: Literal["slack", "carries", "yields"] = "slack" if abs(force) < SLACK * whole else "yields" if yields else "carries"
        rows.append(TieForce(name=name, force_N=force, state=state))
    return rows


def strand_arrays(limit: SolidLimit, tension: np.ndarray) -> dict[str, Array]:
    """The strands as figures show them, segment by segment, with their tensions; nothing without any."""
    if not limit.strands:
        return {}
    ends = [s.point[[k, n]] for s in limit.strands for k, n in s.segments]
    of = [i for i, s in enumerate(limit.strands) for _ in s.segments]
    return {
        "strand_segment": Array(np.array(ends), ("segment", "tie_end", "axis3"), "m", "both ends of each segment of ties and chains"),
        "strand_tension": Array(tension[of], ("segment",), "N", "tension in them at collapse"),
    }
