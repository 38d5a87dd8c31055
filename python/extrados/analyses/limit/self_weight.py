"""The answer of any analysis for a building that collapses under its own weight."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from extrados.analyses.limit.common import geometry_arrays
from extrados.limit.errors import CannotStand
from extrados.model.errors import NoView
from extrados.results.fields import given
from extrados.results.model import Array, Result
from extrados.results.verdict import SelfWeight
from extrados.views.building import Building

_RESTRAINTS = "the restraints of the deck (ties, dampers, hinges)"
_WALL = "the abutting wall"


def collapses_at_rest(kind: str, proof: CannotStand, building: Building) -> Result:
    """The result of an analysis of a kind whose building a certificate proves to collapse under its own weight, with the
    collapse motion of the certificate where blocks of the plane have one."""
    neglected = [text for name in proof.neglects if (text := _strength(building, name))]
    if building.supports.abutting_wall is not None:  # no statics takes the contact with the wall
        neglected.append(_WALL)
    text = str(proof)
    certificate = text[:1].upper() + text[1:]
    found = SelfWeight(
        collapse_acceleration_g=0.0,
        safety_factor=0.0,
        certificate=certificate,
        proven=True,
        neglected=neglected,
        **given(other_loads=proof.other_loads or None),
    )
    result = Result(kind, results=found, answer=found.statement())
    if proof.motion is not None:
        result.arrays = geometry_arrays(building.blocks()) | {
            "collapse_velocity": Array(
                proof.motion,
                ("block", "component"),
                "",
                "collapse mechanism of the certificate: x, y [m] and rotation, at an arbitrary scale",
            )
        }
    return result


def open_at_rest(kind: str, reason: str) -> Result:
    """The result of an analysis of a kind that did not find its building to carry the constant loads, without a proof that it collapses."""
    end = reason[:1].upper() + reason[1:]
    found = SelfWeight(collapse_acceleration_g=0.0, safety_factor=0.0, certificate=end, proven=False, neglected=[])
    return Result(kind, results=found, answer=found.statement())


def neglecting(result: Result, building: Building, without: Sequence[str]) -> Result:
    """The result on the building without some of what holds it, as a result on the building: a proof of collapse then
    neglects that."""
    found = result.results
    if not isinstance(found, SelfWeight):
        return result
    dropped = {f"[[{section}]]": _RESTRAINTS for section in ("ties", "dampers", "hinges") if getattr(building, section)}
    if building.supports.abutting_wall is not None:
        dropped["[supports] abutting_wall"] = _WALL
    told = [*found.neglected, *(dropped[what] for what in without if what in dropped)]
    found = found.model_copy(update={"neglected": list(dict.fromkeys(told))})
    return replace(result, results=found, answer=found.statement())


def _strength(building: Building, name: str) -> str:
    """What the proof neglects, in words, a strength with its greatest value; "" where the building has none of it."""
    if name == "restraints":
        return _RESTRAINTS if building.restraints else ""
    if name == "passive pressure":
        earth = building.blocks().earth
        return "the passive pressure of the fill" if earth is not None and earth.passive > 0.0 else ""
    try:
        values = building.joint_property(name)
    except NoView:
        values = building.joint_property(name, building.solids())
    greatest = float(np.nanmax(values, initial=0.0))
    return f"the {name} of the joints, {greatest / 1e6:.3g} MPa" if greatest > 0.0 else ""
