"""What a rocking structure takes for granted of its joints: that they do not slide, and that no other hinge opens."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core import mechanism as core_mechanism
from extrados.core.rocking import Body, watched_body
from extrados.limit.answer import cannot_stand
from extrados.limit.errors import Immovable, NoEquilibrium
from extrados.limit.linkage import Linkage, laden
from extrados.limit.loads import Loads
from extrados.limit.programme import LimitAnalysis
from extrados.model.geometry.assembly import Assembly
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.impact import MOST_BLOCKS, inelastic_impact
from extrados.views.rockers.joint_forces import STEPS, JointForces
from extrados.views.rockers.restraints import Restraints

#: How far the thrust line may leave a joint, as a fraction of its length, before another hinge opens there
OUTSIDE = 0.01
#: Share of the kinetic energy after an impact that may lie outside the mechanism that rocks on
LOST = 0.2
#: Rounding of a state of limit analysis, of its friction; and of its load
SAME, ALIKE = 1e-9, 1e-6


@dataclass(frozen=True)
class Watch:
    """The joints of a rocking structure, to +x and to -x.

    linkages: of both sides; critical: rotations up to which the joints are looked at [rad]; friction: of the joints of the
    assembly, infinite where they do not slide; capacity: horizontal acceleration of the ground that slides the resting
    structure the way it would rock to +x, -x, infinite where it rocks first [g]; opening: the same that opens hinges of another
    mechanism. strikes: whether impacts set blocks in motion (one block on a toe meets the ground as its impact rule says).
    restraints: what holds the structure besides its weight.
    """

    assembly: Assembly
    linkages: tuple[Linkage, Linkage]
    critical: tuple[float, float]
    friction: np.ndarray
    capacity: tuple[float, float]
    opening: tuple[float, float]
    strikes: bool
    restraints: Restraints | None = None

    @cached_property
    def _forces(self) -> tuple[JointForces, JointForces]:
        members = () if self.restraints is None else self.restraints.members
        right, left = (JointForces(self.assembly, one, members) for one in self.linkages)
        return right, left

    @cached_property
    def joints(self) -> np.ndarray:
        """Joints whose forces are known on either side."""
        return np.union1d(self._forces[0].joints, self._forces[1].joints).astype(int)

    @cached_property
    def unknown(self) -> int:
        """Joints that stay shut and whose forces equilibrium alone does not fix."""
        return len(self.assembly.a) - len(self.joints)

    @cached_property
    def tables(self) -> tuple[np.ndarray, np.ndarray]:
        """Forces at `joints` on both sides, see core.rocking.watched_body."""
        found = []
        for forces, critical in zip(self._forces, self.critical, strict=True):
            # a joint that is unknown on this side presses in its middle
            table = np.zeros((STEPS + 1, len(self.joints), 3 + len(forces.members), 3))
            table[:, :, 0, 0], table[:, :, 0, 2] = 1.0, 0.5
            # the mechanism may lock at the critical rotation itself
            at = np.linspace(0.0, critical * (1.0 - 1e-9), STEPS + 1)
            table[:, np.searchsorted(self.joints, forces.joints)] = forces.table(at)
            found.append(table)
        return found[0], found[1]

    def watched(self, body: Body) -> Body:
        """The structure of the core with what holds it and its joints watched; these as they are where none is known."""
        if self.restraints is not None:
            body = self.restraints.hold(body)
        if not len(self.joints):
            return body
        slides, opens = ((GRAVITY * one[0], GRAVITY * one[1]) for one in (self.capacity, self.opening))
        return watched_body(body, self.tables, self.critical, self.friction[self.joints], OUTSIDE, slides, opens)

    def name(self, place: int) -> str:
        """Name of a joint by its place among those watched."""
        return self.assembly.joint_names[self.joints[place]]

    @cached_property
    def astray(self) -> tuple[float, float]:
        """Share of the kinetic energy after the impacts that start rocking to +x and to -x which does not lie in the mechanism
        that is to rock on: all joints close at once without rebound, and hinges open where the impulses let them (Moreau 1988)."""
        if not self.strikes or len(self.assembly.mass) > MOST_BLOCKS:
            return 0.0, 0.0
        mass, centroid, inertia = laden(self.assembly)
        weight = np.stack([mass, mass, inertia], axis=1)
        fields = [one.velocities(centroid, core_mechanism.follow(one, [0.0])[1][0]) for one in self.linkages]
        found = []
        for opens, closes in (fields, fields[::-1]):
            after = inelastic_impact(self.assembly, -closes)
            energy = float((weight * after**2).sum())
            along = float((weight * after * opens).sum())
            kept = max(along, 0.0) ** 2 / float((weight * opens**2).sum())
            found.append(1.0 - kept / energy if energy > 0.0 else 0.0)
        return found[0], found[1]


def sliding_capacity(
    assembly: Assembly,
    friction: np.ndarray,
    rocking: tuple[float, float],
    needed: tuple[np.ndarray, ...] | None,
    loads: Loads | None = None,
) -> tuple[float, float]:
    """Horizontal acceleration [g] of the ground at which the resting structure slides the way it would rock to +x and to -x;
    infinite where it rocks first. CannotStand where friction does not carry its weight.

    friction (joints); rocking: acceleration that starts rocking [g]; needed: friction of the states in which it starts, where known.
    Sliding is taken as associated: an upper bound of what friction carries.
    """
    if np.isinf(friction).all():
        return np.inf, np.inf
    if needed is not None and all((state <= friction * (1.0 + SAME)).all() for state in needed):
        return np.inf, np.inf
    limit = LimitAnalysis(assembly, np.minimum(friction, 1e3), loads=loads)
    found = []
    for side, start in zip((1, -1), rocking, strict=True):
        try:
            capacity = side * limit.collapse(side)[0].gamma
        except Immovable:
            capacity = np.inf
        except NoEquilibrium:
            raise cannot_stand(limit) from None
        if capacity <= 0.0:
            raise cannot_stand(limit)
        found.append(capacity if capacity < start * (1.0 - ALIKE) else np.inf)
    return found[0], found[1]


def opening_capacity(assembly: Assembly, rocking: tuple[float, float], loads: Loads) -> tuple[float, float]:
    """Horizontal acceleration [g] of the ground at which hinges of another mechanism open in the resting structure, the way it would
    rock to +x and to -x; infinite where the assumed one opens first.

    rocking: acceleration that starts the assumed one [g]; loads: with the prestress of ties, under which the assumed mechanism, that of
    the weight alone, need not be the first.
    """
    limit, found = LimitAnalysis(assembly, loads=loads), []
    for side, start in zip((1, -1), rocking, strict=True):
        try:
            capacity = max(side * limit.collapse(side)[0].gamma, 0.0)
        except Immovable:
            capacity = np.inf
        except NoEquilibrium:
            capacity = 0.0
        found.append(capacity if capacity < start * (1.0 - ALIKE) else np.inf)
    return found[0], found[1]
