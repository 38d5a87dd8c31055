"""A trial beside the fixed hinges of `rocking`: an arch that rocks by other four-hinge mechanisms than that of limit analysis.

All mechanisms of four hinges are listed. Of those that may open under a force or an impulse f the one is taken whose
motion has the greatest share of it, f.v over the kinetic norm of v: by Gauss's principle the nearest that one mechanism
comes to the motion of the free stones. At the acceleration that starts rocking slowly it is that of limit analysis.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import combinations

import numpy as np

from extrados.core import mechanism as core_mechanism
from extrados.core.errors import CoreError
from extrados.limit.linkage import CannotRock, linkage
from extrados.limit.states import Mechanism
from extrados.model.structures.arch import ArchAssembly
from extrados.motions.motion import Motion
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.impact import inelastic_impact

#: Steps in the time of the arch, 1/p of a block; at twice as many no outcome of the sample changes.
STEPS = 80
#: Points of a table of coefficients.
POINTS = 1500
#: Best mechanisms that are tried until one can be carried through its motion.
TRIED = 50


@dataclass(frozen=True)
class Way:
    """How hinges are chosen. onset: "limit" (of limit analysis), "present" (at the acceleration that lifts it) or
    "strongest" (at the greatest acceleration until the ground turns). blow: chosen by the velocities after a blow at
    all joints, else the mirrored ones; keeps: the energy that this blow leaves, or what the projection keeps.
    moving: hinges are chosen anew up to this share of the critical rotation, by the momentum and what the forces add
    to it in `horizon` times the arch's own time."""

    onset: str = "limit"
    blow: bool = False
    keeps: str = "blow"
    moving: float = 0.0
    horizon: float = 0.1


@dataclass(frozen=True)
class Path:
    """A mechanism through its motion: coefficients (4, POINTS) M, M'/2, V', signed H at rotations `step` apart, the
    potential, and the root of M at rest."""

    critical: float
    limit: float
    step: float
    values: np.ndarray
    potential: np.ndarray
    norm: float

    def acceleration(self, q: float, rate: float, ground: float) -> float:
        x = max(q, 0.0) / self.step
        k = min(int(x), POINTS - 2)
        mass, half, weight, drive = self.values[:, k] + (x - k) * (self.values[:, k + 1] - self.values[:, k])
        return -(half * rate * rate + weight + ground * drive) / mass

    def energy(self, q: float, rate: float) -> float:
        k = min(int(max(q, 0.0) / self.step), POINTS - 1)
        return 0.5 * self.values[0, k] * rate**2 + self.potential[k] - self.potential[0]

    @cached_property
    def barrier(self) -> float:
        return float(self.potential.max() - self.potential[0])


class FourHinges:
    """All mechanisms of four alternate hinges of an arch; velocities (mechanisms, blocks, 3) of unit kinetic norm."""

    def __init__(self, arch: ArchAssembly) -> None:
        self.arch = arch
        self.weight = np.stack([arch.mass, arch.mass, arch.inertia], axis=1)
        quads = np.array(list(combinations(range(arch.voussoirs + 1), 4)))
        found = []
        for first in (0, 1):
            outer = np.array([first, 1 - first] * 2, dtype=bool)
            velocity = self._velocities(quads, outer)
            ends = [self._openings(velocity, end) for end in (arch.p, arch.q)]
            least, most = np.minimum(*ends).min(axis=1), np.maximum(*ends).max(axis=1)
            sense = np.where(least > -1e-9, 1.0, np.where(most < 1e-9, -1.0, 0.0))
            norm = np.sqrt((velocity**2 * self.weight).sum(axis=(1, 2)))
            found += [(velocity[k] * sense[k] / norm[k], quads[k], outer) for k in np.flatnonzero((sense != 0.0) & (norm > 0.0))]
        self.velocity = np.array([v for v, _, _ in found])
        self.hinges = [
            [(int(j), "extrados" if out else "intrados") for j, out in zip(quad, outer, strict=True)] for _, quad, outer in found
        ]
        self.momentum = (self.velocity * self.weight).reshape(len(found), -1)
        self.drive = (self.velocity[:, :, 0] * arch.mass).sum(axis=1)
        self.fall = GRAVITY * (self.velocity[:, :, 1] * arch.mass).sum(axis=1)
        self.path = lru_cache(maxsize=None)(self._path)
        self.after = lru_cache(maxsize=None)(self._after)

    def _velocities(self, quads: np.ndarray, outer: np.ndarray) -> np.ndarray:
        """Velocities of all quadruples of joints, the first link turning by one; zero where links are in line."""
        a = self.arch
        first, second, third, last = np.where(outer[:, None, None], a.q[quads.T], a.p[quads.T])
        u, w, apart = second - first, third - last, third - second
        with np.errstate(divide="ignore", invalid="ignore"):
            centre = second + ((w[:, 0] * apart[:, 1] - w[:, 1] * apart[:, 0]) / (w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0]))[:, None] * u
            middle = (u * (second - centre)).sum(axis=1) / ((second - centre) ** 2).sum(axis=1)
            right = middle * ((third - centre) * w).sum(axis=1) / (w**2).sum(axis=1)
        whole = np.isfinite(middle) & np.isfinite(right)
        out = np.zeros((len(quads), a.voussoirs, 3))
        for k in np.flatnonzero(whole):
            for link, (about, spin) in enumerate(((first[k], 1.0), (centre[k], middle[k]), (last[k], right[k]))):
                stones = slice(quads[k, link], quads[k, link + 1])
                arm = a.centroid[stones] - about
                out[k, stones] = spin * np.column_stack([-arm[:, 1], arm[:, 0], np.ones(len(arm))])
        return out

    def _openings(self, velocity: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Speed at which joints open (mechanisms, joints) at one of their ends (joints, 2)."""
        a = self.arch
        moving = np.concatenate([velocity, np.zeros((len(velocity), 1, 3))], axis=1)  # GROUND = -1 is the last
        centroid = np.append(a.centroid, [[0.0, 0.0]], axis=0)

        def at(block: np.ndarray) -> np.ndarray:
            arm = end - centroid[block]
            return moving[:, block, :2] + moving[:, block, 2:] * np.column_stack([-arm[:, 1], arm[:, 0]])

        return ((at(a.a) - at(a.b)) * a.normal).sum(axis=2)

    def _path(self, k: int) -> Path | None:
        """None where gravity does not hold the mechanism shut or it cannot be carried on."""
        side = 1 if self.drive[k] > 0.0 else -1
        opening = [self._openings(self.velocity[k : k + 1], end)[0] for end in (self.arch.p, self.arch.q)]
        mechanism = Mechanism(self.velocity[k], self.hinges[k], [], *opening, np.zeros(len(self.arch.a)), 0.0, 0.0)
        try:
            one = linkage(self.arch, mechanism, side)
            table = core_mechanism.table(one)
        except (CannotRock, CoreError):
            return None
        q = np.linspace(0.0, table.limit * (1.0 - 1e-6), POINTS)
        c = core_mechanism.coefficients(table, q)
        values = np.array([c.mass, c.half_mass_slope, c.gravity_moment, side * c.drive])
        return Path(table.critical, table.limit, q[1], values, c.potential, float(np.sqrt(table.mass)))

    def of_limit_analysis(self, mechanism: Mechanism) -> int:
        return self.hinges.index([(int(j), face) for j, face in mechanism.hinges])

    def best(self, score: np.ndarray) -> int | None:
        """The mechanism of the greatest score above zero that can be carried through its motion."""
        order = np.argsort(-score)[:TRIED]
        return next((int(k) for k in order if score[k] > 0.0 and self.path(int(k)) is not None), None)

    def force(self, ground: float) -> np.ndarray:
        """Force along each mechanism at rest under an acceleration of the ground [m/s^2]."""
        return -ground * self.drive - self.fall

    def _after(self, k: int, mirrored: int, way: Way) -> tuple[int | None, float]:
        """Mechanism after the impact that closes k, and speed over speed in the kinetic norm."""
        before = -self.velocity[k]
        left = inelastic_impact(self.arch, before)
        chosen = mirrored
        if way.blow:
            found = self.best(self.momentum @ (left if way.keeps == "blow" else before).ravel())
            if found is None:
                return None, 0.0
            chosen = found
        if way.keeps == "blow":
            return chosen, float(np.sqrt((self.weight * left**2).sum()))
        return chosen, max(0.0, float(self.momentum[chosen] @ before.ravel()))


def falls(arch: FourHinges, limit: tuple[int, int], motion: Motion, way: Way, unit: float) -> bool:
    """Does the arch fall under a pulse? limit: the mechanisms of limit analysis to +x and -x; unit: its time [s].

    Runge-Kutta of fourth order in fixed steps, impacts on the chord of a step.
    """
    dt = unit / STEPS
    ground = motion.sample(np.arange(2 * int((motion.end + 25.0 * unit) / dt) + 3) * 0.5 * dt)
    k: int | None = None
    q = rate = 0.0
    for i in range(0, len(ground) - 2, 2):
        if k is None:
            k, q, rate = _onset(arch, limit, ground[i:], way), 0.0, 0.0
            if k is None:
                continue
        path = arch.path(k)
        if 0.5 * i * dt > motion.end and q < path.critical and path.energy(q, rate) < 0.5 * path.barrier:
            return False
        a = path.acceleration
        k1 = a(q, rate, ground[i])
        k2 = a(q + 0.5 * dt * rate, rate + 0.5 * dt * k1, ground[i + 1])
        k3 = a(q + 0.5 * dt * (rate + 0.5 * dt * k1), rate + 0.5 * dt * k2, ground[i + 1])
        k4 = a(q + dt * (rate + 0.5 * dt * k2), rate + dt * k3, ground[i + 2])
        to, then = q + dt * rate + dt * dt / 6.0 * (k1 + k2 + k3), rate + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        if to > 0.99 * path.limit:
            return True
        if to > 0.0:
            q, rate = to, then
            if rate > 0.0 and q < way.moving * path.critical:
                k, q, rate = _moved(arch, k, q, rate, ground[i + 2], way.horizon * unit)
            continue
        share = q / (q - to) if q > to else 0.0
        rate += share * (then - rate)
        if path.energy(0.0, rate) < 1e-5 * path.barrier or rate >= 0.0:
            k = None
            continue
        k, kept = arch.after(k, limit[int(arch.drive[k] > 0.0)], way)
        if k is not None:
            rate = -rate * path.norm * kept / arch.path(k).norm
            q = rate * (1.0 - share) * dt
            k = k if rate > 0.0 else None
    return False


def _onset(arch: FourHinges, limit: tuple[int, int], ahead: np.ndarray, way: Way) -> int | None:
    """The mechanism that starts under the first of the accelerations ahead; None where the arch stays at rest."""
    first = limit[int(ahead[0] > 0.0)]
    if arch.force(ahead[0])[first] <= 0.0:
        return None
    if way.onset == "limit":
        return first
    turned = np.flatnonzero(ahead * ahead[0] <= 0.0)
    push = ahead[: turned[0]] if len(turned) else ahead
    return arch.best(arch.force(ahead[0] if way.onset == "present" else push[np.abs(push).argmax()]))


def _moved(arch: FourHinges, k: int, q: float, rate: float, ground: float, horizon: float) -> tuple[int, float, float]:
    """The mechanism by the momentum and the forces of a horizon [s]: equal potential energy, velocities projected."""
    old = arch.path(k)
    speed = old.norm * rate
    new = arch.best(arch.momentum @ (speed * arch.velocity[k]).ravel() + horizon * arch.force(ground))
    if new is None or new == k or arch.drive[new] * arch.drive[k] <= 0.0:
        return k, q, rate
    path = arch.path(new)
    share = float(arch.momentum[new] @ arch.velocity[k].ravel())
    return new, min(old.values[2, 0] * q / path.values[2, 0], 0.9 * path.critical), speed * share / path.norm
