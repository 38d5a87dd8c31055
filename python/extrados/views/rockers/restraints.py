"""What holds a rocking structure besides its weight, as the core wants it: ties, dampers, added hinges, a wall."""

import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from extrados.core import mechanism as core_mechanism
from extrados.core.errors import CoreError
from extrados.core.restraints import FREE, LENGTH, TURN, Law, paths, restrained_body
from extrados.core.rocking import Body
from extrados.limit.linkage import Linkage
from extrados.limit.loads import forces_at
from extrados.model.devices import AddedHinge, Damper
from extrados.model.errors import WHOLE, BadGeometry, Key, NoView
from extrados.model.geometry.anchors import stone_at
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structures.block import BlockAssembly
from extrados.model.ties import Tie
from extrados.views.blocks import Masonry
from extrados.views.rockers.block import BlockModel

#: Of a free block or arch the rotations that are tabulated, over the rotation of collapse
BEYOND = 1.5


@dataclass(frozen=True)
class Restraint:
    """A law on a path between two stones (GROUND for the ground), by the points where it is anchored [m] or across a joint.

    sort: LENGTH or TURN; blocks (2); points (2, 2).
    """

    name: str
    law: Law
    sort: int
    blocks: tuple[int, int]
    points: np.ndarray


@dataclass(frozen=True)
class Restraints:
    """All that holds a structure that rocks by two linkages (to +x, to -x); reach: last rotation and scale of each [rad].

    open_sides, rebound: see core.restraints.restrained_body.
    """

    members: tuple[Restraint, ...]
    linkages: tuple[Linkage, Linkage]
    reach: tuple[tuple[float, float], tuple[float, float]]
    open_sides: tuple[bool, bool] = (True, True)
    rebound: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def _tables(self) -> tuple[np.ndarray, np.ndarray] | None:
        if not self.members:
            return None
        sort = [m.sort for m in self.members]
        points = np.array([m.points for m in self.members])
        found = []
        for one, reach in zip(self.linkages, self.reach, strict=True):
            try:
                found.append(paths(one, sort, self._parts(one), points, reach))
            except CoreError as error:
                raise NoView(f"the restraints cannot be followed through the motion: {error}", WHOLE) from None
        return found[0], found[1]

    def _parts(self, one: Linkage) -> np.ndarray:
        """Parts (members, 2) at both ends of each, 0 the ground."""
        number = np.append(one.part, 0)
        return number[np.array([m.blocks for m in self.members], dtype=int).reshape(-1, 2)]

    def hold(self, body: Body) -> Body:
        """The structure of the core with what holds it."""
        laws = [m.law for m in self.members]
        return restrained_body(body, laws, self._tables, open_sides=self.open_sides, rebound=self.rebound)

    def paths(self, side: int, q: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Paths and their derivatives by q (states, members) of side 0 (+x) or 1 (-x), by the places of the parts."""
        one = self.linkages[side]
        place, first, _ = core_mechanism.follow(one, q)
        u, du = np.zeros((2, len(place), len(self.members)))
        for k, (member, parts) in enumerate(zip(self.members, self._parts(one), strict=True)):
            if member.sort == TURN:
                turns = [(place[:, p - 1, 2], first[:, p - 1, 2]) if p else (0.0, 0.0) for p in parts]
                u[:, k], du[:, k] = (np.asarray(a) - b for a, b in zip(*turns, strict=True))
                continue
            where, moves = zip(*(carried(one, place, first, p, x) for p, x in zip(parts, member.points, strict=True)), strict=True)
            line = where[1] - where[0]
            length = np.hypot(*line.T)
            u[:, k] = length - np.hypot(*(member.points[1] - member.points[0]))
            du[:, k] = (line * (moves[1] - moves[0])).sum(axis=1) / length
        return u, du

    @cached_property
    def moment_at_rest(self) -> tuple[float, float]:
        """Moment of prestress against rocking to +x and to -x [N m]."""
        force = np.array([m.law.prestress for m in self.members])
        right, left = (float(self.paths(side, [0.0])[1][0] @ force) for side in (0, 1))
        return right, left

    def prestress(self, count: int) -> np.ndarray:
        """Loads (count, 3) of the prestress on the blocks at rest: force x, y [N] and moment about the origin [N m]."""
        load = np.zeros((count, 3))
        for m in self.members:
            if m.sort != LENGTH:
                continue
            line = m.points[1] - m.points[0]
            for block, point, sign in zip(m.blocks, m.points, (1.0, -1.0), strict=True):
                if block != GROUND:
                    x, y = sign * m.law.prestress * line / np.hypot(*line)
                    load += forces_at(count, block, point, (float(x), float(y)))
        return load

    def pull(self, rotation: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Force x, y [N] on a structure of one part (states, 2), at signed rotations [rad]; force as Response.forces."""
        out = np.zeros((len(rotation), 2))
        for side, here in enumerate((rotation >= 0.0, rotation < 0.0)):
            if here.any() and self.members:
                place, _, _ = core_mechanism.follow(self.linkages[side], np.abs(rotation[here]))
                out[here] = self.wrenches(side, place, force[:, here])[:, 0, :2]
        return out

    def wrenches(self, side: int, place: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Force x, y [N] at, and moment about, the centroids of the parts (states, parts, 3) that the members exert.

        place (states, parts, 3) of the parts; force (members, states), as Response.forces.
        """
        one = self.linkages[side]
        out = np.zeros_like(place)
        for member, parts, f in zip(self.members, self._parts(one), force, strict=True):
            if member.sort == TURN:
                for p, sign in zip(parts, (-1.0, 1.0), strict=True):
                    if p:
                        out[:, p - 1, 2] += sign * f
                continue
            where = [carried(one, place, place, p, x)[0] for p, x in zip(parts, member.points, strict=True)]
            line = where[1] - where[0]
            pull = f[:, None] * line / np.hypot(*line.T)[:, None]
            for p, x, sign in zip(parts, where, (1.0, -1.0), strict=True):
                if p:
                    arm = x - place[:, p - 1, :2]
                    out[:, p - 1, :2] += sign * pull
                    out[:, p - 1, 2] += sign * (arm[:, 0] * pull[:, 1] - arm[:, 1] * pull[:, 0])
        return out


def carried(one: Linkage, place: np.ndarray, first: np.ndarray, part: int, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a point [m] of a part (0: the ground) lies at each state, and its derivative by q (states, 2)."""
    if not part:
        return np.broadcast_to(point, (len(place), 2)), np.zeros((len(place), 2))
    c, s = np.cos(place[:, part - 1, 2]), np.sin(place[:, part - 1, 2])
    x, y = point - one.centroid[part - 1]
    arm = np.column_stack([c * x - s * y, s * x + c * y])
    turned = np.column_stack([-arm[:, 1], arm[:, 0]])
    return place[:, part - 1, :2] + arm, first[:, part - 1, :2] + first[:, part - 1, 2, None] * turned


def block_linkages(block: BlockModel, stones: Assembly) -> tuple[Linkage, Linkage]:
    """A block, or all stones taken as one, as a linkage of one part that turns about its right toe (to +x) and its left."""
    b = block.block
    if isinstance(stones, BlockAssembly):
        centre, toes = stones.centroid[0], (stones.q[0], stones.p[0])
    else:
        foot = np.array([stones.mass @ stones.centroid[:, 0] / stones.mass.sum(), min(o[:, 1].min() for o in stones.outlines)])
        centre = foot + np.array([0.0, b.centre_height])
        toes = foot + np.array([b.toe_right, 0.0]), foot - np.array([b.toe_left, 0.0])
    made = [
        Linkage(
            side,
            np.ones(len(stones.mass), dtype=int),
            b.mass,
            centre[None],
            b.inertia,
            _nearest(stones, toe),
            np.array([[1, 0]]),
            toe[None],
            np.array([[1, 1], [1, 2]]),
            1,
            -side,
        )
        for side, toe in zip((1, -1), toes, strict=True)
    ]
    return made[0], made[1]


def _nearest(stones: Assembly, toe: np.ndarray) -> np.ndarray:
    """The joint on the ground (1) in which a toe [m] lies."""
    grounded = np.flatnonzero((stones.a == GROUND) | (stones.b == GROUND))
    apart = np.minimum(*(np.hypot(*(ends[grounded] - toe).T) for ends in (stones.p, stones.q)))
    return grounded[[int(apart.argmin())]]


def block_reach(block: BlockModel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Rotations of a block that are tabulated, and the scale of the table: it does not lock."""
    right, left = (min(2.0 * float(alpha), 0.5 * np.pi) for alpha in block.alpha)
    return (BEYOND * right, 4.0 * right), (BEYOND * left, 4.0 * left)


def members_of(building: Masonry, assembly: Assembly, linkages: tuple[Linkage, Linkage]) -> tuple[Restraint, ...]:
    """The ties, dampers and added hinges of a building, anchored in its stones; hinges at joints that stay shut are left out.

    NoView where one cannot be followed, BadGeometry where one is anchored nowhere.
    """
    number = [np.append(one.part, 0) for one in linkages]
    found = [m for make in restraints_of(building, lambda: assembly) for m in make()]
    return tuple(m for m in found if m.sort != TURN or any(part[m.blocks[0]] != part[m.blocks[1]] for part in number))


def restraints_of(building: Masonry, stones: Callable[[], Assembly]) -> Iterator[Callable[[], list[Restraint]]]:
    """What holds a building, each made when it is called: a tie or damper one restraint, an added hinge one at each of
    its joints."""
    for key, one in zip(building.restraint_keys, building.restraints, strict=True):
        yield functools.partial(_restraints, stones, one, key)


def _restraints(stones: Callable[[], Assembly], one: Tie | Damper | AddedHinge, key: Key) -> list[Restraint]:
    assembly, what = stones(), f"{one.name}"
    if isinstance(one, AddedHinge):
        law = _law_of_hinge(one)
        return [
            Restraint(f"{what}, {assembly.joint_names[j]}", law, TURN, (int(assembly.a[j]), int(assembly.b[j])), _twice(assembly, j))
            for j in joints_named(assembly, one.joints, what, (*key, "joints"))
        ]
    points = np.array(one.flat(), dtype=float)
    first = stone_at(assembly, points[0], one.start_stone, f"{what}, start", key, "start")
    last = GROUND if one.end is None else stone_at(assembly, points[1], one.end_stone, f"{what}, end", key, "end")
    if first == last:
        raise BadGeometry(f"{what}: both ends are in block '{assembly.block_names[first]}'", key)
    return [Restraint(what, _law(one, key), LENGTH, (first, last), points)]


def _twice(assembly: Assembly, joint: int) -> np.ndarray:
    return np.array([assembly.middle[joint], assembly.middle[joint]])


def _law(one: Tie | Damper, key: Key) -> Law:
    if isinstance(one, Damper):
        if one.damping is not None:
            return Law(viscous=one.damping, power=one.power)
        assert one.slip_force is not None and one.stiffness is not None
        return Law(one.stiffness, 0.0, one.slip_force, -one.slip_force)
    if one.stiffness is None:
        raise NoView(
            f"{one.name} has no stiffness EA/L and is therefore rigid until it yields, but rocking requires a stiffness: give `stiffness`",
            key,
        )
    slack = {"tension": 1, "compression": -1, "both": 0}[one.works_in]
    return Law(one.stiffness, one.prestress, min(one.most, FREE), max(one.least, -FREE), slack)


def _law_of_hinge(one: AddedHinge) -> Law:
    bound = FREE if one.yield_moment is None else one.yield_moment
    return Law(one.stiffness or 0.0, 0.0, bound, -bound, 0, one.damping or 0.0)


def joints_named(assembly: Assembly, names: Sequence[str], what: str, key: Key) -> list[int]:
    """Joints by their names, by those of groups, "ground" or "all"; BadGeometry, which begins with `what`, else."""
    found: list[int] = []
    for name in names:
        if name == "all":
            found += range(len(assembly.a))
        elif name == "ground":
            found += np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND)).tolist()
        elif name in assembly.joint_names:
            found.append(assembly.joint_names.index(name))
        elif name in assembly.groups:
            found += assembly.groups[name]
        else:
            known = ", ".join(assembly.joint_names[:8]) + (", ..." if len(assembly.joint_names) > 8 else "")
            raise BadGeometry(f"{what}: joint '{name}' does not exist; expected one of {known}, ground and all", key)
    return list(dict.fromkeys(found))


def three_impacts(block: BlockModel, side: int) -> float:
    """Rate after over rate before of a block that falls back against a wall on its other side, thrown back to side 0 (+x) or 1.

    Three impacts, each keeping the angular momentum about the corner that is struck: the change from the near to the far toe, the
    blow of the top (as high as twice the centre of mass) on the wall, and the change from the far to the near toe. For a rectangle
    (1 - 3/2 sin^2 a)^2 |1 - 3/2 cos^2 a|, a the slenderness angle. Derived here: the form is ascribed to Sorrentino, AlShawa and
    Decanini (2011), whose print was not at hand. After the second blow a rigid body would turn about the top, not about the far
    toe, and come to rest by more blows: an upper bound.
    """
    b = block.block
    mass, inertia, h = float(b.mass[0]), float(b.inertia[0]), b.centre_height
    near, far = (b.toe_right, b.toe_left) if side == 0 else (b.toe_left, b.toe_right)
    top = inertia + mass * (far**2 + h**2)
    landing = (inertia + mass * (h**2 - near * far)) / (inertia + mass * (far**2 + h**2))
    struck = (inertia + mass * (far**2 - h**2)) / top
    leaving = (inertia + mass * (h**2 - near * far)) / (inertia + mass * (near**2 + h**2))
    return max(0.0, -landing * struck * leaving)
