"""One block that ties and dampers hold: where its base slides, rigid contacts with the same ties and dampers follow it.

The force of the ground at the toe follows from the motion and the forces of the ties, so that friction is known at every time. The
state is handed over only if no tie has yielded and no damper has slipped before: the ties of contacts begin as drawn.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.dem.from_deck import joint_values
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.ties import element_ties, section_strands
from extrados.analyses.rocking.hand_over import BEFORE, Contacts, Leaving, level_of
from extrados.core.restraints import LENGTH
from extrados.core.rocking import Response
from extrados.model.errors import BadGeometry
from extrados.results.fields import given
from extrados.results.rocking import Conditions, JointTime
from extrados.views.building import Building
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.rocker import Rocker

#: Permanent path of a restraint that is rounding, over the size of the structure
ROUNDING = 1e-9
#: Step of the history in which friction is looked at, over the time unit of the structure, and its times at most
WATCH, MOST_TIMES = 5e-3, 20000


@dataclass(frozen=True)
class Slides:
    """When the base of a block slides first [s], the greatest friction that rocking requires, and the block on contacts."""

    time: float
    needed: float
    given: float
    contacts: Contacts

    @property
    def leaves(self) -> float:
        """When contacts take over [s]: just before."""
        return max(self.time - BEFORE * self.contacts.leaving.time_unit, 0.0)

    @property
    def conditions(self) -> Conditions:
        """Friction was checked, and fails."""
        base = self.contacts.model.assembly.joint_names[0]
        text = f"Friction {self.given:.2f} is below the {self.needed:.2f} that rocking requires, first at {base} at {self.time:.3f} s: blocks slide."
        return Conditions(
            friction=self.given,
            required_friction=self.needed,
            **given(slides_first=JointTime(joint=base, time_s=self.time)),
            not_checked="",
            violated=[text],
        )


def watch_step(time_unit: float, end_time: float) -> float:
    """Step [s] of the history in which friction is looked at until `end_time` [s], whatever the step of output; time_unit: of the
    structure [s]."""
    return max(WATCH * time_unit, end_time / MOST_TIMES)


def sliding_of(
    rocker: Rocker,
    building: Building,
    seen: Response,
    until: Callable[[float, float], Response],
    demand: Callable[[Response], np.ndarray],
    tolerance: float,
) -> Slides | None:
    """When the base of a tied block slides first; None where it does not, where other than ties and dampers act on one block, or where one
    of these has yielded before.

    seen: the response to the end by watch_step; until: the response to a time with a step of output [s]; demand: friction that a response requires
    (times).
    """
    friction = building.joints.coefficient
    held = rocker.restraints
    if friction is None or held is None or not isinstance(rocker.model, BlockModel) or rocker.model.linear:
        return None
    if not all(held.open_sides) or any(one.sort != LENGTH for one in held.members):
        return None
    required = demand(seen)
    beyond = required > friction
    if not beyond.any():
        return None
    end = float(seen.time[beyond.argmax()])
    fine = until(max(end, BEFORE * rocker.time_unit), max(BEFORE * rocker.time_unit, end / MOST_TIMES))
    beyond = demand(fine) > friction
    time = float(fine.time[beyond.argmax()]) if beyond.any() else end
    contacts = contacts_of_tied(rocker, building, tolerance)
    if contacts is None or np.abs(fine.permanent).max(initial=0.0) > ROUNDING * contacts.model.size:
        return None
    return Slides(time, float(required.max()), float(friction), contacts)


def contacts_of_tied(rocker: Rocker, building: Building, tolerance: float) -> Contacts | None:
    """The block on rigid contacts with its ties and dampers; None where it is not one block, or where a tie has no stiffness."""
    held = rocker.restraints
    assert held is not None
    try:
        blocks = building.blocks()
        floor = level_of(blocks)
        rigid = building.rigid((), floor)
        ties = element_ties(building, section_strands(building), rigid.body_of_block, has_rates=True)
    except (BadGeometry, Refused):
        return None
    if len(blocks.mass) != 1:
        return None
    leaving = Leaving(rocker.body, held.linkages, blocks, 0.0, rocker.start_rotation, rocker.time_unit, rocker.critical, tolerance)
    return Contacts(leaving, Model(blocks, rigid, joint_values(building, rigid=True), ties), floor)
