"""An arch whose right support moves: the three-hinge states it passes through until it falls.

Support movement opens three hinges at once; the arch then is statically determinate and stands as long as
the thrust line through the three hinges stays inside it. Where the line reaches another joint first, the
nearest hinge of that side moves there. No state is left at the fall, a fourth hinge (Ochsendorf 2006).
"""

from dataclasses import dataclass

import numpy as np

from extrados.limit.programme import LimitAnalysis, NoEquilibrium
from extrados.limit.solver import MADE_UP
from extrados.limit.states import Side
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.schema.constants import GRAVITY

ROOM = 1e-9  # of a joint's length: how far outside the line may lie by rounding
CLOSE = 1e-9  # of the size of the arch: how closely the fall is found

Hinges = tuple[tuple[int, Side], ...]


@dataclass(frozen=True)
class SupportState:
    """movement [m] of the right support; three hinges; force (2) [N] of the arch on that support;
    poses (nb, 3) of the blocks; thrust points (nj, 2) [m] on the displaced joints; position of
    each on its joint, 0 at the intrados to 1 at the extrados; potential energy [J] over that at rest."""

    movement: float
    hinges: Hinges
    force: np.ndarray
    pose: np.ndarray
    points: np.ndarray
    position: np.ndarray
    energy: float


class _Chain:
    """The arch as a chain from its left to its right springing."""

    def __init__(self, assembly: Assembly, direction: np.ndarray):
        self.assembly, self.direction = assembly, direction
        (self.joints,) = assembly.chains.values()
        count = len(assembly.mass)
        if len(self.joints) != count + 1 or assembly.a[self.joints[-1]] != GROUND:
            raise ValueError("support movements are calculated only for a single arch on two supports")
        self.p, self.q = assembly.p[self.joints], assembly.q[self.joints]
        self.weight = assembly.mass * GRAVITY

    def end(self, hinge: tuple[int, str]) -> np.ndarray:
        return (self.p if hinge[1] == "intrados" else self.q)[hinge[0]]

    def first(self) -> Hinges:
        """Hinges of the first small movement: the state of least work against it, from its dual."""
        a = self.assembly
        limit = LimitAnalysis(a)
        cost = np.zeros((len(a.a), 3))
        j = self.joints[-1]
        # Force of the arch on the right support, along the movement; the ground is block a there.
        cost[j] = a.normal[j] @ self.direction, a.normal[j] @ self.direction, a.tangent[j] @ self.direction
        solution, rows, _ = limit.optimise(limit.system.cost(cost), (0.0, 0.0))
        if solution.made_up > MADE_UP * max(1.0, abs(solution.value)):
            raise NoEquilibrium("the blocks are wedged: they cannot follow the movement without crushing")
        motion = rows.openings(np.maximum(solution.rows, 0.0), len(a.a))[self.joints]
        active = np.flatnonzero(np.abs(motion).max(axis=1) > 1e-9 * np.abs(motion).max())
        hinges: Hinges = tuple((int(k), "intrados" if motion[k, 0] < motion[k, 1] else "extrados") for k in active)
        if len(hinges) != 3:
            raise NoEquilibrium(f"the start of the movement opens {len(hinges)} hinges instead of three")
        return hinges

    def state(self, hinges: Hinges, movement: float) -> SupportState | None:
        """The arch on three hinges with its support moved; None where they cannot reach each other."""
        one, two, three = (self.end(h) for h in hinges)
        shift = movement * self.direction
        far = three + shift
        span, r1, r2 = np.hypot(*(far - one)), np.hypot(*(two - one)), np.hypot(*(three - two))
        along = (span**2 + r1**2 - r2**2) / (2.0 * span)
        if along**2 > r1**2 or span == 0.0:
            return None
        unit = (far - one) / span
        across = np.array([-unit[1], unit[0]])
        over = np.sign((three - one)[0] * (two - one)[1] - (three - one)[1] * (two - one)[0])
        middle = one + along * unit + over * np.sqrt(r1**2 - along**2) * across

        def turn(before: np.ndarray, after: np.ndarray) -> float:
            return float(np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after))

        k1, k2, k3 = (h[0] for h in hinges)
        n = len(self.weight)
        part = np.zeros(n, dtype=int)
        part[k1:k2], part[k2:k3], part[k3:] = 1, 2, 3
        rotation = np.array([0.0, turn(two - one, middle - one), turn(three - two, far - middle), 0.0])
        pivot, moved = np.array([one, one, two, three]), np.array([one, one, middle, far])

        def carried(points: np.ndarray, which: np.ndarray) -> np.ndarray:
            c, s = np.cos(rotation[which]), np.sin(rotation[which])
            arm = points - pivot[which]
            return moved[which] + np.column_stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]])

        centre = carried(self.assembly.centroid, part)
        w1, w2 = self.weight[k1:k2], self.weight[k2:k3]
        # Force at hinge 2 on the right part: moments of the left part about hinge 1, the right about hinge 3.
        m1 = float(w1 @ (centre[k1:k2, 0] - one[0]))
        m2 = float(w2 @ (centre[k2:k3, 0] - far[0]))
        d1, d3 = middle - one, middle - far
        matrix = np.array([[-d1[1], d1[0]], [-d3[1], d3[0]]])
        if abs(np.linalg.det(matrix)) < 1e-12 * span**2:
            return None
        h, v = np.linalg.solve(matrix, [-m1, m2])
        # (h, v): force on the right part at hinge 2. Across joint k: it, and the weights from there to k.
        sums = np.concatenate([[0.0], np.cumsum(self.weight)])
        moments = np.concatenate([[0.0], np.cumsum(self.weight * centre[:, 0])])
        vertical = v - (sums - sums[k2])
        turning = middle[0] * v - middle[1] * h - (moments - moments[k2])  # about the origin
        # Joints are carried by the block on their right, the last one and those at hinges by either.
        which = np.append(part, 3)
        p, q = carried(self.p, which), carried(self.q, which)

        def about(points: np.ndarray) -> np.ndarray:
            return turning - (points[:, 0] * vertical - points[:, 1] * h)

        at_p, at_q = about(p), about(q)
        position = at_p / (at_p - at_q)
        for k, side in hinges:
            position[k] = 0.0 if side == "intrados" else 1.0
        # A line that pulls is outside as well.
        inside = (at_p <= 0.0) & (at_q >= 0.0) | np.isin(np.arange(n + 1), [k1, k2, k3])
        position = np.where(inside | (np.abs(position - 0.5) > 0.5), position, np.inf)
        pose = np.column_stack([centre, rotation[part]])
        energy = float(self.weight @ (centre[:, 1] - self.assembly.centroid[:, 1]))
        force = np.array([h, vertical[-1]])
        return SupportState(movement, hinges, force, pose, p + position[:, None] * (q - p), position, energy)

    def settle(self, hinges: Hinges, movement: float) -> SupportState | None:
        """An admissible state at this movement, from the hinges of the last; None where there is none."""
        seen = set()
        while hinges not in seen:
            seen.add(hinges)
            state = self.state(hinges, movement)
            if state is None or not np.isfinite(state.position).all():
                return None
            over = np.maximum(-state.position, state.position - 1.0)
            worst = int(over.argmax())
            if over[worst] <= ROOM:
                return state
            side: Side = "intrados" if state.position[worst] < 0.0 else "extrados"
            nearest = min((i for i, h in enumerate(hinges) if h[1] == side), key=lambda i: abs(hinges[i][0] - worst), default=None)
            if nearest is None:
                return None
            changed = [h if i != nearest else (worst, side) for i, h in enumerate(hinges)]
            if [h[0] for h in changed] != sorted({h[0] for h in changed}):
                return None
            hinges = tuple(changed)
        return None


def support_movement(assembly: Assembly, direction: tuple[float, float], steps: int = 200) -> list[SupportState]:
    """States from rest to the fall as the right support moves along `direction` (x, y); its length is one unit.

    The last state is the last that stands. The first has no movement. NoEquilibrium where it cannot stand.
    """
    unit = np.asarray(direction, dtype=float)
    chain = _Chain(assembly, unit / np.hypot(*unit))
    state = chain.settle(chain.first(), 0.0)
    if state is None:
        raise NoEquilibrium("the three hinges at the start of the movement permit no admissible thrust line")
    # The fall, by doubling and bisection, each state starting from the hinges of the last that stood.
    step, last = 1e-4 * assembly.size, state
    while (after := chain.settle(last.hinges, last.movement + step)) is not None:
        last = after
        step *= 1.3
        if last.movement > 2.0 * assembly.size:
            break
    fail = last.movement + step
    while fail - last.movement > CLOSE * assembly.size:
        middle = 0.5 * (last.movement + fail)
        after = chain.settle(last.hinges, middle)
        if after is None:
            fail = middle
        else:
            last = after
    states = [state]
    for movement in np.linspace(0.0, last.movement, steps + 1)[1:-1]:
        after = chain.settle(states[-1].hinges, float(movement))
        if after is None:
            break
        states.append(after)
    return [*states, last]
