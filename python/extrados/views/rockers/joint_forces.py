"""Forces across the joints of a mechanism of one degree of freedom while it rocks, as its equations of motion fix them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from extrados.core import mechanism as core_mechanism
from extrados.core.restraints import TURN
from extrados.limit.linkage import Linkage, laden
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.mechanism import carried, hinge_matrix
from extrados.views.rockers.restraints import Restraint

#: Steps of the table from rest to the critical rotation
STEPS = 16


@dataclass(frozen=True)
class JointForces:
    """Normal, shear and place of the resultant at the joints that equilibrium fixes, of one side.

    With w = 1 + a_v/g, h = side a_h, a square of the rate and the forces of restraints, all forces are linear
    (fortran/rocking/watch.f90). Joints carry no moment at hinges, so the equations of the parts give their forces; a joint within a
    part is fixed where it alone ties the blocks on one side of it to the rest, which the blocks on that side then give. What several
    joints share is left out: `joints` holds the others. Soils that push are not in it.
    """

    assembly: Assembly
    linkage: Linkage
    members: tuple[Restraint, ...] = ()

    @cached_property
    def _cuts(self) -> list[tuple[int, np.ndarray]]:
        """Joint, and which blocks lie on its one side (blocks), not on that of the ground, joined by no other joint."""
        a, part = self.assembly, np.append(self.linkage.part, 0)
        hinged = set(self.linkage.joint.tolist())
        within = [j for j, (x, y) in enumerate(a.ends) if part[x] == part[y] and j not in hinged]
        blocks = len(a.mass)
        ends = np.array([[blocks if k == GROUND else k for k in a.ends[j]] for j in within], dtype=int).reshape(-1, 2)
        found = []
        for place, j in enumerate(within):
            others = np.delete(ends, place, axis=0)
            graph = coo_array((np.ones(len(others)), (others[:, 0], others[:, 1])), shape=(blocks + 1, blocks + 1))
            _, piece = connected_components(graph, directed=False)
            one, other = piece[ends[place]]
            if one == other:
                continue
            grounded = piece[blocks]
            found.append((j, piece[:-1] == (one if one != grounded else other)))
        return found

    @cached_property
    def joints(self) -> np.ndarray:
        """Joints whose forces are known, hinges first."""
        hinges = self.linkage.joint.tolist() if self.linkage.determinate else []
        return np.array([*hinges, *(j for j, _ in self._cuts)] if hinges else [], dtype=int)

    def table(self, rotations: np.ndarray) -> np.ndarray:
        """(rotations, joints, input w h rate^2 and force of each restraint, quantity N T M_p/L), of `joints` at rotations >= 0 [rad]."""
        a, one, n = self.assembly, self.linkage, len(rotations)
        place, first, second = core_mechanism.follow(one, rotations)
        mass, centroid, inertia = laden(a)
        # places, and derivatives by the coordinate, of the blocks with their fill (rotations, blocks, 3)
        moving = one.part > 0
        k = one.part[moving] - 1
        at, by, twice = np.zeros((3, n, len(mass), 3))
        at[:, :, :2] = centroid
        arm = _turned(np.broadcast_to(centroid[moving] - one.centroid[k], (n, int(moving.sum()), 2)), place[:, k, 2])
        cross = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        spin, change = first[:, k, 2, None], second[:, k, 2, None]
        at[:, moving, :2], at[:, moving, 2] = place[:, k, :2] + arm, place[:, k, 2]
        by[:, moving, :2], by[:, moving, 2] = first[:, k, :2] + spin * cross, first[:, k, 2]
        twice[:, moving, :2] = second[:, k, :2] + change * cross - spin**2 * arm
        twice[:, moving, 2] = second[:, k, 2]
        weight = np.stack([mass, mass, inertia], axis=1)
        # M q'' = -(M'/2 q'^2 + V' w + H h): acceleration of the coordinate by each input
        total = (weight * by**2).sum(axis=(1, 2))
        parts = [GRAVITY * (mass * by[..., 1]).sum(axis=1), one.side * (mass * by[..., 0]).sum(axis=1)]
        parts.append((weight * by * twice).sum(axis=(1, 2)))
        # generalised force of a restraint with force 1: the work of its wrenches in a unit rotation
        held = self._wrenches(place, at)
        parts += [-(wrench * by).sum(axis=(1, 2)) for wrench in held]
        acceleration = -np.stack(parts, axis=1) / total[:, None]
        # force and moment about the centroid that each block needs (rotations, inputs, blocks, 3)
        needed = acceleration[:, :, None, None] * by[:, None]
        needed[:, 0, :, 1] += GRAVITY
        needed[:, 1, :, 0] += one.side
        needed[:, 2] += twice
        needed = needed * weight
        for row, wrench in enumerate(held, start=3):
            needed[:, row] -= wrench
        hinge = self._hinge_forces(place, at, needed)
        out = np.zeros((n, len(self.joints), needed.shape[1], 3))
        turned = np.concatenate([np.zeros((n, 1)), place[:, :, 2]], axis=1)
        number = np.append(one.part, 0)
        points = [carried(one, place, pair[0], one.point[h]) for h, pair in enumerate(one.joined)]
        for row, j in enumerate(one.joint):
            mean = 0.5 * (turned[:, one.joined[row, 0]] + turned[:, one.joined[row, 1]])
            share = float((one.point[row] - a.p[j]) @ a.tangent[j]) / a.length[j]
            out[:, row, :, 0] = (hinge[:, :, row] * _turned(a.normal[j], mean)[:, None]).sum(axis=-1)
            out[:, row, :, 1] = (hinge[:, :, row] * _turned(a.tangent[j], mean)[:, None]).sum(axis=-1)
            out[:, row, :, 2] = share * out[:, row, :, 0]
        for row, (j, inside) in enumerate(self._cuts, start=len(one.joint)):
            end = carried(one, place, number[a.a[j]], a.p[j])
            lever = at[:, inside, :2] - end[:, None]
            load = needed[:, :, inside]
            force = load[..., :2].sum(axis=2)
            moment = (load[..., 2] + lever[:, None, :, 0] * load[..., 1] - lever[:, None, :, 1] * load[..., 0]).sum(axis=2)
            for h, pull in enumerate(np.moveaxis(hinge, 2, 0)):
                ends = (a.a[one.joint[h]], a.b[one.joint[h]])
                for block, sign in zip(ends, (1.0, -1.0), strict=True):
                    if block != GROUND and inside[block]:
                        way = points[h] - end
                        force = force - sign * pull
                        moment = moment - sign * (way[:, None, 0] * pull[..., 1] - way[:, None, 1] * pull[..., 0])
            # the joint pushes block a along its normal; here it is known how it pushes the blocks inside
            outward = 1.0 if a.a[j] != GROUND and inside[a.a[j]] else -1.0
            angle = turned[:, number[a.a[j]]]
            normal, tangent = _turned(a.normal[j], angle), _turned(a.tangent[j], angle)
            out[:, row, :, 0] = outward * (force * normal[:, None]).sum(axis=-1)
            out[:, row, :, 1] = outward * (force * tangent[:, None]).sum(axis=-1)
            turn = np.sign(a.tangent[j, 0] * a.normal[j, 1] - a.tangent[j, 1] * a.normal[j, 0])
            out[:, row, :, 2] = outward * turn * moment / a.length[j]
        return out

    def _wrenches(self, place: np.ndarray, at: np.ndarray) -> list[np.ndarray]:
        """Force [N] on each block and moment about its point `at` (rotations, blocks, 3) [N m] by a force of 1 of each restraint."""
        a, one, found = self.assembly, self.linkage, []
        pose = one.blocks(a, place)
        for member in self.members:
            out = np.zeros_like(at)
            found.append(out)
            if member.sort == TURN:
                for block, sign in zip(member.blocks, (-1.0, 1.0), strict=True):
                    if block != GROUND:
                        out[:, block, 2] += sign
                continue
            where = [
                np.broadcast_to(x, (len(place), 2))
                if block == GROUND
                else pose[:, block, :2] + _turned(x - a.centroid[block], pose[:, block, 2])
                for block, x in zip(member.blocks, member.points, strict=True)
            ]
            line = where[1] - where[0]
            pull = line / np.hypot(*line.T)[:, None]
            for block, x, sign in zip(member.blocks, where, (1.0, -1.0), strict=True):
                if block != GROUND:
                    arm = x - at[:, block, :2]
                    out[:, block, :2] += sign * pull
                    out[:, block, 2] += sign * (arm[:, 0] * pull[:, 1] - arm[:, 1] * pull[:, 0])
        return found

    def _hinge_forces(self, place: np.ndarray, at: np.ndarray, needed: np.ndarray) -> np.ndarray:
        """Forces on the first part of each hinge (rotations, inputs, hinges, 2) [N]."""
        a, one, n = self.assembly, self.linkage, len(place)
        count, inputs = len(one.mass), needed.shape[1]
        right = np.zeros((n, inputs, count, 3))
        for k in range(count):
            mine = one.part == k + 1
            load, lever = needed[:, :, mine], at[:, mine, :2] - place[:, k, None, :2]
            right[:, :, k, :2] = load[..., :2].sum(axis=2)
            turning = lever[:, None, :, 0] * load[..., 1] - lever[:, None, :, 1] * load[..., 0]
            right[:, :, k, 2] = (load[..., 2] + turning).sum(axis=2)
        matrix = hinge_matrix(one, place)
        unit = np.array([1.0, 1.0, 1.0 / a.size])
        matrix = (matrix * unit[:, None, None]).reshape(n, 3 * count, -1)
        force = np.linalg.pinv(matrix) @ np.moveaxis((right * unit).reshape(n, inputs, -1), 1, 2)
        return np.moveaxis(force, 1, 2).reshape(n, inputs, -1, 2)


def _turned(vector: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vectors (..., 2) turned by angles [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
