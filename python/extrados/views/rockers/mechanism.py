"""Any section as the rocking core sees it: the two collapse mechanisms of limit analysis, carried through their motion."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from extrados.core import mechanism as core_mechanism
from extrados.core.errors import CoreError
from extrados.core.mechanism import Coefficients, Table, table_body
from extrados.core.rocking import Body
from extrados.limit.answer import cannot_stand
from extrados.limit.errors import without_restraints
from extrados.limit.linkage import CannotRock, Linkage, laden, linkage
from extrados.limit.loads import tilt_loads
from extrados.limit.programme import LimitAnalysis, Mechanism, State
from extrados.limit.solver import Immovable, NoEquilibrium
from extrados.model.errors import WHOLE, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.earth import passive_left_out
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.impact import MOST_BLOCKS, energy_kept

if TYPE_CHECKING:
    from extrados.views.rockers.restraints import Restraints

SIDES = (1, -1)
WORD = {1: "+x", -1: "-x"}
#: Relative: capacity by limit analysis and by the work of the tables at rest.
SAME = 1e-6
#: Share of the kinetic energy that a blow may leave beyond what the next mechanism takes, without a warning.
LOST = 0.2
#: Of the size: joints that part and then overlap by more than this touch again.
OVERLAP = 1e-9
#: Rotations up to the critical one at which hinges are looked at.
LOOKS = 60


class NoMotion(NoView):
    """The mechanism is known at rest, but not its finite motion."""


@dataclass(frozen=True)
class HingeForces:
    """Forces across the hinges at a number of states: normal and shear (states, joints) [N], NaN at other joints,
    and at all where statics does not fix them. miss: what is left of the equations of the parts over the weight."""

    normal: np.ndarray
    shear: np.ndarray
    miss: np.ndarray

    @property
    def friction(self) -> np.ndarray:
        """Coefficient of friction needed (states, joints); infinite in tension."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.normal <= 0.0, np.inf, np.abs(self.shear) / self.normal)


@dataclass(frozen=True)
class MechanismModel:
    """An assembly that rocks by its collapse mechanisms to +x and to -x; pairs are (to +x, to -x).

    rule: "energy-safe", the projection of the velocities before impact on the next mechanism, and rest where it is
    below zero; "inelastic", which gives the next mechanism all energy that the blow would leave if hinges could open
    anywhere; or a number whose square is the share of the kinetic energy that an impact keeps (c_v where both sides
    are alike). Joints do not slide and stone does not crush. NoView says why a section does not rock.
    """

    assembly: Assembly
    rule: str | float = "inelastic"

    @cached_property
    def collapse(self) -> tuple[tuple[State, Mechanism], tuple[State, Mechanism]]:
        """State and mechanism at collapse, of both sides."""
        limit = LimitAnalysis(self.assembly, loads=replace(tilt_loads(self.assembly), resistance=None))
        try:
            found = limit.collapse(1), limit.collapse(-1)
            if not found[1][0].gamma < 0.0 < found[0][0].gamma:
                raise NoEquilibrium
        except Immovable as error:
            raise NoView(f"the structure does not rock: {error}", WHOLE) from None
        except NoEquilibrium:
            raise without_restraints(cannot_stand(limit)) from None
        return found

    @cached_property
    def linkages(self) -> tuple[Linkage, Linkage]:
        """Parts and hinges of both mechanisms."""
        made = []
        for side, (_, mechanism) in zip(SIDES, self.collapse, strict=True):
            try:
                made.append(linkage(self.assembly, mechanism, side))
            except CannotRock as error:
                raise NoView(f"the collapse mechanism towards {WORD[side]} does not rock: {error}", WHOLE) from None
        return made[0], made[1]

    @cached_property
    def tables(self) -> tuple[Table, Table]:
        """Equations of motion of both sides."""
        made = []
        for side, one, (state, _) in zip(SIDES, self.linkages, self.collapse, strict=True):
            try:
                table = core_mechanism.table(one)
            except CoreError as error:
                raise NoMotion(
                    f"the motion of the mechanism towards {WORD[side]} cannot be calculated to the critical rotation: {error}", WHOLE
                ) from None
            uplift = side * table.gravity_moment / (table.drive * GRAVITY)
            if abs(uplift - state.gamma) > SAME * abs(state.gamma):
                raise NoView(
                    f"under self-weight the mechanism towards {WORD[side]} starts at {uplift:.6g} g, but limit analysis "
                    f"gives {state.gamma:.6g} g: the structure carries a load that is not part of its mass",
                    WHOLE,
                )
            made.append(table)
        return made[0], made[1]

    @property
    def uplift(self) -> tuple[float, float]:
        """Size of the horizontal acceleration of the ground that starts rocking [g]; to +x the ground moves to -x."""
        return abs(self.collapse[0][0].gamma), abs(self.collapse[1][0].gamma)

    def driver(self, side: int) -> str:
        """The part whose rotation is the coordinate of side 0 (+x) or 1 (-x), by its first and last stone."""
        one = self.linkages[side]
        stones = np.flatnonzero(one.part == one.driver)
        names = [self.assembly.block_names[i] for i in stones[[0, -1]]]
        return names[0] if len(stones) == 1 else f"the part from {names[0]} to {names[1]}"

    @property
    def critical(self) -> tuple[float, float]:
        """Rotation of unstable equilibrium [rad]."""
        return self.tables[0].critical, self.tables[1].critical

    @property
    def time_unit(self) -> float:
        """sqrt(M q_cr / V') of the side that rocks first [s]: 1/p of a slender block."""
        first = self.tables[int(np.argmin(self.uplift))]
        return float(np.sqrt(first.mass * first.critical / first.gravity_moment))

    @property
    def length(self) -> float:
        """R of the slender rectangular block that rocks as slowly, 3 g / (4 p^2) [m]."""
        return 0.75 * GRAVITY * self.time_unit**2

    @cached_property
    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocities (blocks, 3) at rest per unit rate of the blocks with their fill, of both sides."""
        _, centroid, _ = laden(self.assembly)
        right, left = (one.velocities(centroid, core_mechanism.follow(one, [0.0])[1][0]) for one in self.linkages)
        return right, left

    @cached_property
    def projections(self) -> tuple[float, float]:
        """Rate over rate of the impacts that start rocking to +x and to -x by workless impulses; may be negative."""
        mass, _, inertia = laden(self.assembly)
        right, left = self.fields
        return (core_mechanism.restitution(mass, inertia, left, right), core_mechanism.restitution(mass, inertia, right, left))

    @cached_property
    def energy_kept(self) -> tuple[float, float] | None:
        """Share of the kinetic energy that the impacts that start rocking to +x and to -x would leave if hinges could
        open anywhere (rockers.impact); None for too many blocks. Above what the projection leaves, the blow sets more
        than the two mechanisms in motion, and what follows an impact is beyond a model of one coordinate.
        """
        if len(self.assembly.mass) > MOST_BLOCKS:
            return None
        right, left = self.fields
        return energy_kept(self.assembly, -left), energy_kept(self.assembly, -right)

    @cached_property
    def restitution(self) -> tuple[float, float]:
        """Rate after over rate before, of the impacts that start rocking to +x and to -x."""
        return self._by_rule(self.rule)

    def _by_rule(self, rule: str | float) -> tuple[float, float]:
        if rule == "energy-safe":
            return max(0.0, self.projections[0]), max(0.0, self.projections[1])
        ratio = float(np.sqrt(self.tables[1].mass / self.tables[0].mass))
        if rule == "inelastic":
            if self.energy_kept is None:
                raise NoView(
                    f'the impact rule "inelastic" is limited to {MOST_BLOCKS} blocks; give [joints] restitution = "energy-safe" or a '
                    "number",
                    ("joints", "restitution"),
                )
            right, left = np.sqrt(self.energy_kept)
            return float(right) * ratio, float(left) / ratio
        if isinstance(rule, str):
            raise NoView(
                f'the impact rule "{rule}" does not apply to this structure; expected "energy-safe", "inelastic", or a number',
                ("joints", "restitution"),
            )
        return float(rule) * ratio, float(rule) / ratio

    def rivals(self, factor: float) -> dict[str, tuple[float, Body]]:
        """Rule -> (c_v to +x, structure) of all rules where they differ by more than the factor; none for a number."""
        if not isinstance(self.rule, str) or self.energy_kept is None:
            return {}
        found = {rule: self._by_rule(rule) for rule in ("energy-safe", "inelastic")}
        one, other = found.values()
        if all(max(x, y) <= factor * min(x, y) for x, y in zip(one, other, strict=True)):
            return {}
        return {rule: (pair[0], table_body(*self.tables, pair)) for rule, pair in found.items()}

    @cached_property
    def warnings(self) -> list[str]:
        """What is doubtful: impacts that end the rocking, hinges that close again before the balance."""
        found = passive_left_out(self.assembly.earth)
        kept = (
            self.restitution[0] ** 2 * self.tables[0].mass / self.tables[1].mass,
            self.restitution[1] ** 2 * self.tables[1].mass / self.tables[0].mass,
        )
        if self.rule == "energy-safe" and max(self.projections) <= 0.0:
            found.append(
                f"after an impact, the mechanism towards the opposite side does not start (c_v = {self.projections[0]:.3f} "
                f"towards +x, {self.projections[1]:.3f} towards -x). The structure therefore comes to rest at each impact"
            )
        if self.energy_kept is not None and max(self.energy_kept) > max(kept) + LOST:
            found.append(
                f"after an impact, the mechanism towards the opposite side keeps {100 * max(kept):.0f} % of the "
                f"kinetic energy. If hinges could open at all joints, {100 * max(self.energy_kept):.0f} % would "
                "remain. This model then underestimates the rotations after an impact. "
                'Compare the result with restitution = "inelastic", which keeps all of this energy'
            )
        for side, one, table, (_, mechanism) in zip(SIDES, self.linkages, self.tables, self.collapse, strict=True):
            closing = self._closing(one, table, mechanism)
            if closing:
                q, name = closing
                found.append(
                    f"when the structure rocks towards {WORD[side]}, {name} closes again at {q / table.critical:.2f} "
                    "times the critical rotation. Beyond this rotation the section would move differently"
                )
        return found

    def _closing(self, one: Linkage, table: Table, mechanism: Mechanism) -> tuple[float, str] | None:
        """First rotation up to the critical one at which a joint that opened closes again, and its name."""
        a = self.assembly
        q = np.linspace(0.0, table.critical, LOOKS + 1)[1:] * (1.0 - 1e-9)
        turn = np.append(0.0, core_mechanism.follow(one, [0.0])[1][0, :, 2])
        opening = turn[one.joined[:, 0]] - turn[one.joined[:, 1]]
        place, _, _ = core_mechanism.follow(one, q)
        turned = np.concatenate([np.zeros((len(q), 1)), place[:, :, 2]], axis=1)
        shut = (turned[:, one.joined[:, 0]] - turned[:, one.joined[:, 1]]) * np.sign(opening) <= 0.0
        names = [a.joint_names[j] for j in one.joint]
        parted = np.array(mechanism.sliding, dtype=int)
        if len(parted):
            number = np.append(one.part, 0)
            gap = self._gaps(one, place, parted, number)
            shut = np.concatenate([shut, gap < -OVERLAP * a.size], axis=1)
            names += [a.joint_names[j] for j in parted]
        when, which = np.nonzero(shut)
        return (float(q[when[0]]), names[which[0]]) if len(when) else None

    def _gaps(self, one: Linkage, place: np.ndarray, joints: np.ndarray, number: np.ndarray) -> np.ndarray:
        """Least distance of the faces of joints that part (states, joints) [m], along the face of block b."""
        a = self.assembly
        out = np.full((len(place), len(joints)), np.inf)
        for k, j in enumerate(joints):
            part_a, part_b = number[a.a[j]], number[a.b[j]]
            for end in (a.p[j], a.q[j]):
                apart = carried(one, place, part_a, end) - carried(one, place, part_b, end)
                turn = np.zeros(len(place)) if part_b == 0 else place[:, part_b - 1, 2]
                out[:, k] = np.minimum(out[:, k], (apart * _turned(a.normal[j], turn)).sum(axis=1))
        return out

    @cached_property
    def body(self) -> Body:
        """The structure for the rocking core."""
        return self.rebounding(1.0)

    def rebounding(self, factor: float) -> Body:
        """The structure with c_v times a factor, but no more than leaves all energy."""
        (right, left), (to_right, to_left) = self.tables, self.restitution
        most = float(np.sqrt(left.mass / right.mass))
        return table_body(right, left, (min(most, factor * to_right), min(1.0 / most, factor * to_left)))

    def coefficients(self, side: int, q: npt.ArrayLike) -> Coefficients:
        """M, M'/2, V', H and V of one side at rotations q >= 0 [rad]."""
        return core_mechanism.coefficients(self.tables[SIDES.index(side)], q)

    def pose(self, rotation: npt.ArrayLike) -> np.ndarray:
        """Places (states, blocks, 3) of all blocks, x, y [m] and rotation [rad], at signed rotations [rad]."""
        turned_by = np.atleast_1d(np.asarray(rotation, dtype=float))
        out = np.zeros((len(turned_by), len(self.assembly.mass), 3))
        out[:, :, :2] = self.assembly.centroid
        for side, one in zip(SIDES, self.linkages, strict=True):
            here = side * turned_by > 0.0
            if here.any():
                out[here] = one.blocks(self.assembly, core_mechanism.follow(one, np.abs(turned_by[here]))[0])
        return out

    def hinge_forces(
        self,
        rotation: npt.ArrayLike,
        rate: npt.ArrayLike,
        acceleration: npt.ArrayLike,
        horizontal: npt.ArrayLike,
        vertical: npt.ArrayLike,
        held: "tuple[Restraints, np.ndarray] | None" = None,
    ) -> HingeForces:
        """Forces at the hinges while it rocks, by the equations of motion of the parts (Newton and Euler).

        rotation [rad], its rate and acceleration are signed, positive to +x; horizontal, vertical: acceleration of
        the ground [m/s^2]. All (states). held: what holds it, with its forces (members, states) [N, N m]. The forces inside
        the parts are statically indeterminate.
        """
        a = self.assembly
        given = [np.atleast_1d(np.asarray(x, dtype=float)) for x in (rotation, rate, acceleration, horizontal, vertical)]
        turned_by = given[0]
        normal, shear = np.full((2, len(turned_by), len(a.a)), np.nan)
        miss = np.zeros(len(turned_by))
        for side, one in zip(SIDES, self.linkages, strict=True):
            here = side * turned_by > 0.0
            if not (here.any() and one.determinate):
                continue
            q, v, acc, ground, up = (x[here] for x in given)
            place, first, second = core_mechanism.follow(one, side * q)
            needed = first * (side * acc)[:, None, None] + second * (v**2)[:, None, None]
            needed[..., 0] += ground[:, None]
            needed[..., 1] += (up + GRAVITY)[:, None]
            load = needed * np.stack([one.mass, one.mass, one.inertia], axis=1)
            if held is not None and held[0].members:
                load = load - held[0].wrenches(0 if side > 0 else 1, place, held[1][:, here])
            matrix = hinge_matrix(one, place)
            unit = np.array([1.0, 1.0, 1.0 / a.size])
            matrix = (matrix * unit[:, None, None]).reshape(len(q), 3 * len(one.mass), -1)
            right = (load * unit).reshape(len(q), -1, 1)
            force = np.linalg.pinv(matrix) @ right
            miss[here] = np.abs(matrix @ force - right).max(axis=(1, 2)) / (one.mass.sum() * GRAVITY)
            force = force.reshape(len(q), -1, 2)
            turned = np.concatenate([np.zeros((len(q), 1)), place[:, :, 2]], axis=1)
            for h, (j, pair) in enumerate(zip(one.joint, one.joined, strict=True)):
                mean = 0.5 * (turned[:, pair[0]] + turned[:, pair[1]])
                normal[here, j] = (force[:, h] * _turned(a.normal[j], mean)).sum(axis=1)
                shear[here, j] = (force[:, h] * _turned(a.tangent[j], mean)).sum(axis=1)
        return HingeForces(normal, shear, miss)


def hinge_matrix(one: Linkage, place: np.ndarray) -> np.ndarray:
    """Resultants (n, parts, 3, hinges, 2) at the centroids of parts of unit forces at the hinges, + on the first part of each.

    place (n, parts, 3): x, y [m] and rotation of the parts; the third resultant is the moment about the centroid [N m].
    """
    matrix = np.zeros((len(place), len(one.mass), 3, len(one.joint), 2))
    for h, pair in enumerate(one.joined):
        for k, sign in zip(pair, (1.0, -1.0), strict=True):
            if k:
                arm = carried(one, place, k, one.point[h]) - place[:, k - 1, :2]
                matrix[:, k - 1, 0, h, 0] += sign
                matrix[:, k - 1, 1, h, 1] += sign
                matrix[:, k - 1, 2, h] += sign * np.column_stack([-arm[:, 1], arm[:, 0]])
    return matrix


def carried(one: Linkage, place: np.ndarray, part: int, point: np.ndarray) -> np.ndarray:
    """Where a point [m] of a part (0: the ground) lies at each state (states, 2)."""
    if part == 0:
        return np.broadcast_to(point, (len(place), 2))
    return place[:, part - 1, :2] + _turned(point - one.centroid[part - 1], place[:, part - 1, 2])


def _turned(vector: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """A vector turned by angles [rad] (states, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
