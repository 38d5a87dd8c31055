"""One section among many: its structure from changed deck keys, its capacity, mechanism or the reason for none."""

from dataclasses import replace

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.common import fracture_of, limit_of
from extrados.analyses.limit.outcome import LOCKED, MOVES, UNKNOWN, Outcome, Signature, measures_of
from extrados.analyses.limit.solid_variation import evaluate_solids
from extrados.analyses.limit.tables import LimitAnalysisTable, SpatialLimit
from extrados.analyses.needs import in_space
from extrados.limit.answer import cannot_stand
from extrados.limit.programme import LimitAnalysis, Mechanism, NoEquilibrium
from extrados.limit.solver import Immovable, NoAnswer
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly, part_of
from extrados.views.building import Building


def signature(assembly: Assembly, mechanism: Mechanism) -> Signature:
    """A mechanism but for the numbers of its joints: the order of hinges of each arch, and what else turns.

    A hinge that moves on by a voussoir makes no new mechanism; another part that moves does.
    """
    inside = {j: name for name, joints in assembly.chains.items() for j in joints}
    marks = {j: side[0] for j, side in mechanism.hinges} | {j: "s" for j in mechanism.sliding}
    found = [
        (name, "-".join(marks[j] for j in joints if j in marks))
        for name, joints in assembly.chains.items()
        if any(j in marks for j in joints)
    ]
    found += [(assembly.joint_names[j], mark) for j, mark in sorted(marks.items()) if j not in inside]
    return tuple(found)


def spoken(found: Signature) -> str:
    """A signature in words."""
    if found == LOCKED:
        return "none: no collapse mechanism exists"
    if found == UNKNOWN:
        return ""
    words = {"i": "intrados", "e": "extrados", "s": "slide"}
    return "; ".join(name if marks == MOVES else f"{name}: {'-'.join(words[m] for m in marks.split('-'))}" for name, marks in found)


def evaluate(
    building: Building, options: LimitAnalysisTable, *, fracture: bool = False, alone: bool = False, explain: bool = True
) -> Outcome:
    """Build the section and load it to +x, or solids along their direction."""
    try:
        if isinstance(options, SpatialLimit) and in_space(building, options):
            return evaluate_solids(building, options)
        assembly, limit = building.blocks(), limit_of(building, options)
    except (BadGeometry, Refused, ValueError) as error:
        return Outcome(signature=UNKNOWN, reason=str(error))
    found = _evaluate(building, options, assembly, limit, fracture, explain)
    return replace(found, alone=_buttress_alone(building, assembly)) if alone else found


def _buttress_alone(building: Building, assembly: Assembly) -> float:
    """Collapse load to +x of the leeward buttress by itself, with its own weight only; 0 where that is proven to bring it down."""
    friction = building.friction()
    if friction is not None and np.ndim(friction):
        kept = assembly.joints_of(assembly.buttresses[-1])
        on_ground = (assembly.a[kept] == GROUND) | (assembly.b[kept] == GROUND)
        friction = np.asarray(friction)[kept[on_ground]]
    buttress = replace(part_of(assembly, [assembly.buttresses[-1]]), fill=None)
    limit = LimitAnalysis(buttress, friction, strength=building.material.compressive_strength)
    try:
        gamma = limit.collapse(1)[0].gamma
    except Immovable:
        raise
    except NoEquilibrium:
        gamma = 0.0
    if gamma <= 0.0:
        cannot_stand(limit)  # NoAnswer without a proof
    return max(gamma, 0.0)


def _evaluate(
    building: Building, options: LimitAnalysisTable, assembly: Assembly, limit: LimitAnalysis, fracture: bool, explain: bool
) -> Outcome:
    """The section under load to +x."""
    try:
        state, mechanism = limit.collapse(1)
        if state.gamma <= 0.0 or not limit.stands():  # or only when it is pushed
            raise NoEquilibrium
    except Immovable as error:
        return Outcome(
            signature=LOCKED, reason=f"no collapse mechanism: {error}", assembly=assembly, locked=True, measures=measures_of(assembly)
        )
    except NoEquilibrium:
        if not explain:
            return Outcome(reason="not proven", assembly=assembly, measures=measures_of(assembly))
        try:
            reason = f"cannot stand: {cannot_stand(limit)}"
        except (NoEquilibrium, NoAnswer) as error:
            return Outcome(signature=UNKNOWN, reason=str(error), assembly=assembly, measures=measures_of(assembly))
        return Outcome(0.0, reason=reason, assembly=assembly, measures=measures_of(assembly))
    except NoAnswer as error:
        return Outcome(signature=UNKNOWN, reason=str(error), assembly=assembly, measures=measures_of(assembly))
    cracked, notes = None, []
    if fracture:
        try:
            found = fracture_of(building, options)
            cracked = state.gamma if found is None else found.gamma
            if cracked <= 0.0:
                raise NoEquilibrium("cannot stand upright")
        except (NoEquilibrium, NoAnswer, Refused) as error:
            cracked = 0.0 if isinstance(error, NoEquilibrium) else None
            notes.append(f"with the buttress cracked: {error}")
    return Outcome(
        state.gamma,
        cracked,
        signature(assembly, mechanism),
        abs(state.gamma - mechanism.upper_bound),
        "",
        assembly,
        mechanism,
        notes,
        dilating=bool(limit.dilating(mechanism)),
        measures=measures_of(assembly),
    )
