"""One structure of solids among many: its capacity along a direction, mechanism or the reason for none; random surveys of one."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.batches import stacked
from extrados.analyses.context import Refused
from extrados.analyses.limit.outcome import LOCKED, MOVES, UNKNOWN, Outcome, Signature, measures_of
from extrados.analyses.limit.solid_loads import solid_limit
from extrados.analyses.limit.solid_sliding import slide
from extrados.analyses.limit.solids import dilating_contacts, moving_blocks
from extrados.analyses.limit.tables import Imperfections, SpatialLimit
from extrados.limit.errors import Immovable, NoAnswer
from extrados.limit.solids import Falls, Programme, SolidLimit
from extrados.model.errors import BadGeometry
from extrados.model.geometry.deviation import resurveyed_solids
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.views.building import Building

EQUAL = 6  # decimals of speeds over the fastest: blocks that differ less are equally fast


def evaluate_solids(building: Building, options: SpatialLimit) -> Outcome:
    """Build the blocks and push them along the direction of the analysis, +x by default."""
    try:
        limit = solid_limit(building, options)
    except (BadGeometry, Refused, ValueError) as error:
        return Outcome(signature=UNKNOWN, reason=str(error))
    assembly, direction = limit.assembly, options.direction or 0.0
    measures = measures_of(assembly)
    try:
        found, dilating = push_by_rule(limit, direction, options)
    except Immovable as error:
        return Outcome(signature=LOCKED, reason=f"no collapse mechanism: {error}", assembly=assembly, locked=True, measures=measures)
    except NoAnswer as error:
        return Outcome(signature=UNKNOWN, reason=str(error), assembly=assembly, measures=measures)
    if isinstance(found, Falls) or found.gamma <= 0.0 or limit.falls() is not None:  # or only when it is pushed
        proof = "cannot stand: a mechanism exists that no contact hinders and in which the weights do positive work"
        return Outcome(0.0, reason=proof, assembly=assembly, measures=measures)
    return Outcome(found.gamma, None, _signature(assembly, found), found.gap, "", assembly, found, dilating=dilating, measures=measures)


def push_by_rule(limit: SolidLimit, direction: float, options: SpatialLimit) -> tuple[Programme | Falls, bool]:
    """The greatest push along a direction [deg], and whether it is an upper bound by dilatant friction; by a non-associated rule the
    least certified state without dilatancy. Immovable where no push causes collapse, NoAnswer without a certified state."""
    found = limit.push(direction)
    if isinstance(found, Falls) or not dilating_contacts(limit, found):
        return found, False
    if options.friction_rule == "associated":
        return found, True
    least = slide(limit, direction, found.gamma, options.starts)[1]
    if least is None:
        raise NoAnswer("no collapse state without dilatancy is certified")
    return least, False


def _signature(assembly: SolidAssembly, found: Programme) -> Signature:
    """A mechanism but for its rates: how many blocks move, and the first of the fastest."""
    speed = np.linalg.norm(found.motion[:, :3], axis=1)
    fastest = assembly.block_names[int(np.round(speed / speed.max(), EQUAL).argmax())]
    return ((f"{len(moving_blocks(assembly, found))} blocks move, {fastest} moves fastest", MOVES),)


@dataclass(frozen=True)
class SolidSurveys:
    """Member k is the k-th random survey of solids; its rows are the capacities along the direction and opposite [g], NaN
    where it cannot stand, and whether the programmes had an answer."""

    building: Building
    options: Imperfections
    deviation: float

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(self._member, first, count)

    def _member(self, k: int) -> dict[str, np.ndarray]:
        survey = resurveyed_solids(self.building.solids(), self.deviation, np.random.default_rng([self.options.seed, k]))
        return capacities(self.building, self.options, survey)


def capacities(building: Building, options: Imperfections, assembly: SolidAssembly) -> dict[str, np.ndarray]:
    """Capacities (2) along the direction and opposite [g], NaN where the blocks cannot stand; whether the programmes had an
    answer, and whether contacts slide in a mechanism."""
    limit = solid_limit(building, options, assembly=assembly)
    first, gamma, answered, dilates = options.direction or 0.0, np.full(2, np.nan), True, False
    try:
        ends = [push_by_rule(limit, way, options) for way in (first, first + 180.0)]
        found = [one.gamma for one, _ in ends if isinstance(one, Programme)]
        if len(found) == 2 and min(found) > 0.0:
            gamma, dilates = np.array(found), any(upper for _, upper in ends)
    except (Immovable, NoAnswer):
        answered = False
    return {"gamma": gamma, "answered": np.array(answered), "dilates": np.array(dilates)}
