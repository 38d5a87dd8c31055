"""States of stress of solid blocks under given loads, by second-order cones: least and greatest thrust, the most central state."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.limit.errors import NoAnswer, NoEquilibrium
from extrados.limit.solids import LOOSE, METHODS, Falls, SolidLimit, solve_conic

CLOSE = 1e-3  # of the contacts: how closely the least part of them is known
MIDDLE = 0.01  # of the contacts: a state within this part of them runs through their middles
MOST_ROUNDS = 60


@dataclass(frozen=True)
class SolidState:
    """Forces in equilibrium with given loads.

    force (nj, 3): on the first block of each contact [N]; centre (nj, 3): centre of its compression [m], the middle of a
    contact without any; key_force (nk, 2): shears of the dowels; tension (nt) of the strands [N]. friction (nj): shear over compression.
    equilibrium: greatest force, or moment over the size, left over at a block, over the weight; excess: greatest excess of
    shear over friction, or tension, at a corner, over the weight; gap: difference between both programmes of an extreme value [N].
    """

    force: np.ndarray
    centre: np.ndarray
    key_force: np.ndarray
    tension: np.ndarray
    friction: np.ndarray
    equilibrium: float
    excess: float
    gap: float = 0.0


class SolidStates:
    """The states of stress of blocks under one load (6 nb), over the scale of their programmes."""

    def __init__(self, limit: SolidLimit, load: np.ndarray):
        self.limit = limit
        self.load = load
        self.total = float(limit.weight.sum())
        assembly = limit.assembly
        self._frames = np.stack([assembly.normal, *assembly.tangents], axis=1)
        self.middle = assembly.middle

    def extreme(self, toward: np.ndarray) -> SolidState | None:
        """The state in which sum(force * toward) over all contacts is least; toward (nj, 3) gives the forces on their first blocks
        a value. None where it has no least value; NoEquilibrium where no state is in equilibrium with the load, NoAnswer where the
        solver gives up."""
        counted = np.zeros(self.limit.matrix.shape[1])
        joint = self.limit.assembly.corner_joint
        counted[: 3 * len(joint)] = np.einsum("vkx,vx->vk", self._frames[joint], toward[joint]).ravel()
        if (keys := self.limit.assembly.keys) is not None:
            counted[3 * len(joint) :] = np.einsum("vkx,vx->vk", self._frames[keys.joint, 1:], toward[keys.joint]).ravel()
        one = self.limit.stated(self.load, None, (), counted)
        status = ""
        for method in METHODS:
            solution = solve_conic(one.matrix, one.cost, one.right, one.cones, method)
            status = str(solution.status)
            if "PrimalInfeasible" in status:
                return None
            if "DualInfeasible" in status:
                raise NoEquilibrium("no state of stress is in equilibrium with the load")
            forces, tension = self.limit.forces_of(np.array(solution.z), one.lines)
            if not np.isfinite(forces).all():
                continue
            gap = abs(float(counted @ forces) + float(solution.obj_val)) * self.limit.scale
            found = self._state(self.limit, forces, tension, gap)
            if max(found.equilibrium, found.excess, gap / self.total) <= LOOSE:
                return found
        raise NoAnswer(f"the conic solver found no extreme state: {status}")

    def central(self) -> tuple[SolidState, float]:
        """The state within the least part of all contacts about their middles, and that part; NoEquilibrium where all of the
        contacts do not suffice.

        A part s suffices if and only if a multiplier t >= 0 exists of a compression F at the middles of all contacts, beside forces
        within s times the contacts. If F is that of the state, s (1 - t) suffices too. So each round takes F from the last state
        and steps to s (1 - t), within the bracket of parts that are known to suffice or not (Dinkelbach's method).
        """
        low, high, part = 0.0, 1.0, 1.0
        pressure = self.limit.assembly.area[:, None] * self.limit.assembly.normal
        pressure *= self.total / self.limit.scale / float(self.limit.assembly.area.sum())
        found = None
        for _ in range(MOST_ROUNDS):
            state, spare = self._within(part, pressure)
            if spare >= 0.0 and state is not None:
                high, found = part, state
                pressure = state.force / self.limit.scale
            else:
                low = part
            if found is None:
                raise NoEquilibrium("no state of stress is in equilibrium with the load")
            if high - low <= CLOSE * high or high <= MIDDLE:
                return found, high
            part = high * (1.0 - spare) if spare >= 0.0 else part * (1.0 - spare)
            if spare < CLOSE:
                part = high * (1.0 - 0.9 * CLOSE)
            if not low < part < high:
                part = 0.5 * (low + high)
        raise NoAnswer(
            f"the most central state was not found: the middle part of the contacts that it needs is between {100 * low:.3g} and {100 * high:.3g} %"
        )

    def _within(self, part: float, pressure: np.ndarray) -> tuple[SolidState | None, float]:
        """The state within a part of the contacts and its spare multiplier of `pressure` (nj, 3), a force at their middles."""
        one = self.limit.assembly
        polygon = [middle + part * (points - middle) for points, middle in zip(one.polygon, self.middle, strict=True)]
        narrow = SolidLimit(replace(one, polygon=polygon), self.limit.friction, self.limit.strands, self.limit.resting)
        joint = one.corner_joint
        press = np.zeros(self.limit.matrix.shape[1])
        at_corner = np.einsum("vkx,vx->vk", self._frames[joint], one.share[:, None] * pressure[joint])
        press[: 3 * len(joint)] = at_corner.ravel()
        found = narrow.most(self.load, self.limit.matrix @ press)
        if isinstance(found, Falls):
            return None, -1.0
        forces = np.concatenate([found.force.ravel(), found.key_force.ravel()]) / self.limit.scale
        tension = found.tension / self.limit.scale
        whole = self.limit.matrix @ press  # as above: the middles stay where they are
        rest = narrow.matrix @ forces + self.limit.pulls @ tension + found.gamma * whole + self.load
        at = self._sum(narrow, forces, found.gamma * pressure)
        state = self._stored(*at, forces, tension, float(np.abs(rest).max()), narrow.excess(forces, tension), 0.0)
        return state, found.gamma

    def _state(self, limit: SolidLimit, forces: np.ndarray, tension: np.ndarray, gap: float) -> SolidState:
        rest = limit.matrix @ forces + limit.pulls @ tension + self.load
        at = self._sum(limit, forces, np.zeros_like(self.middle))
        return self._stored(*at, forces, tension, float(np.abs(rest).max()), limit.excess(forces, tension), gap)

    def _sum(self, limit: SolidLimit, forces: np.ndarray, pressed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force on the first block of each contact (nj, 3), over the scale, and its place (nj, 3) [m]: of forces at the corners of
        `limit` and a force `pressed` (nj, 3) at the middles."""
        joint = self.limit.assembly.corner_joint
        corner = forces[: 3 * len(joint)].reshape(-1, 3)
        force = self._by_contact(np.einsum("vk,vkx->vx", corner, self._frames[joint])) + pressed
        normal = np.maximum(corner[:, 0], 0.0)
        middle = np.maximum(np.einsum("jx,jx->j", pressed, self.limit.assembly.normal), 0.0)
        moment = self._by_contact(normal[:, None] * limit.assembly.corner) + middle[:, None] * self.middle
        total = np.bincount(joint, normal, len(middle)) + middle
        presses = total > LOOSE * max(float(total.max(initial=0.0)), 1e-300)
        centre = self.middle.copy()
        centre[presses] = moment[presses] / total[presses, None]
        return force, centre

    def _stored(
        self, force: np.ndarray, centre: np.ndarray, forces: np.ndarray, tension: np.ndarray, rest: float, excess: float, gap: float
    ) -> SolidState:
        scale = self.limit.scale
        normal = np.einsum("jx,jx->j", force, self.limit.assembly.normal)
        shear = np.linalg.norm(force - normal[:, None] * self.limit.assembly.normal, axis=1)
        presses = normal > LOOSE * max(float(normal.max(initial=0.0)), 1e-300)
        friction = np.zeros(len(normal))
        friction[presses] = shear[presses] / normal[presses]
        keys = forces[3 * len(self.limit.mu) :].reshape(-1, 2)
        part = scale / self.total
        return SolidState(scale * force, centre, scale * keys, scale * tension, friction, part * rest, part * max(0.0, excess), gap)

    def _by_contact(self, values: np.ndarray) -> np.ndarray:
        """Sums over the corners of each contact of values (nv, 3)."""
        joint, count = self.limit.assembly.corner_joint, len(self.limit.assembly.a)
        return np.stack([np.bincount(joint, values[:, k], count) for k in range(3)], axis=1)
