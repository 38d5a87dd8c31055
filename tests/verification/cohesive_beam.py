"""A notched beam with a discrete cohesive crack: what sequentially linear analysis is measured against.

Three-point bending, the crack straight up from the notch. Half of the beam is elastic (bilinear rectangles, graded away
from the crack) and condensed to the nodes of the crack's line; there the traction follows the opening by the softening
law, with no elastic part before it. The length of the crack controls the solution: for a crack that has just reached a
node the traction there is the strength and the opening zero, the nodes below are open by the law, those above are
closed; load and openings follow by Newton's method, past every snap-back.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

Law = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def law(kind: str, strength: float, energy: float) -> Law:
    """Traction [Pa] and its slope [Pa/m] of an opening [m]: Hordijk (1991), linear, exponential; area = energy [N/m]."""
    if kind == "linear":
        end = 2.0 * energy / strength
        return lambda w: (strength * np.clip(1.0 - w / end, 0.0, None), np.where(w < end, -strength / end, 0.0))
    if kind == "exponential":
        decay = energy / strength
        return lambda w: (strength * np.exp(-w / decay), -strength / decay * np.exp(-w / decay))
    c1, c2 = 3.0, 6.93
    end = 5.136 * energy / strength
    foot = (1.0 + c1**3) * np.exp(-c2)

    def hordijk(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        r = np.minimum(w / end, 1.0)
        fall = np.exp(-c2 * r)
        slope = (3.0 * c1**3 * r**2 - c2 * (1.0 + (c1 * r) ** 3)) * fall - foot
        return strength * ((1.0 + (c1 * r) ** 3) * fall - r * foot), np.where(w < end, strength * slope / end, 0.0)

    return hordijk


@dataclass(frozen=True)
class Beam:
    """Sizes [m]: the notch is `slot` wide, the opening is measured over `gauge` at the lower edge."""

    depth: float
    length: float
    span: float
    notch: float
    slot: float
    gauge: float
    thickness: float


@dataclass(frozen=True)
class Path:
    """Equilibrium states of a growing crack: opening over the gauge [m], load [N], deflection under it [m]."""

    opening: np.ndarray
    load: np.ndarray
    deflection: np.ndarray

    @property
    def peak(self) -> int:
        return int(self.load.argmax())

    def opening_after_peak(self, part: float) -> float:
        """Opening where the load has fallen to a part of its peak [m]; between two states a power of it."""
        fall = np.log(self.load[self.peak :] / self.load[self.peak])
        if not fall[-1] < np.log(part):
            raise ValueError(f"the crack ends at {np.exp(fall[-1]):.3f} of the peak load, above {part}")
        return float(np.exp(np.interp(-np.log(part), -fall, np.log(self.opening[self.peak :]))))


def _rectangle(a: float, b: float, young: float, nu: float) -> np.ndarray:
    """Stiffness (8, 8) of a bilinear rectangle a x b of unit thickness in plane stress."""
    elastic = young / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
    k = np.zeros((8, 8))
    for r in (-(3**-0.5), 3**-0.5):
        for s in (-(3**-0.5), 3**-0.5):
            x = 0.5 / a * np.array([-(1 - s), 1 - s, 1 + s, -(1 + s)])
            y = 0.5 / b * np.array([-(1 - r), -(1 + r), 1 + r, 1 - r])
            strain = np.zeros((3, 8))
            strain[0, 0::2] = strain[2, 1::2] = x
            strain[1, 1::2] = strain[2, 0::2] = y
            k += 0.25 * a * b * strain.T @ elastic @ strain
    return k


def _graded(marks: list[float], first: float, most: float) -> np.ndarray:
    """Distances from the crack through all marks, in steps that grow from `first` to `most`."""
    lines = [np.zeros(1)]
    step = first
    for start, end in pairwise(marks):
        steps = []
        while sum(steps) < end - start:
            steps.append(step)
            step = min(1.1 * step, most)
        lines.append(start + np.cumsum(steps) * (end - start) / sum(steps))
    return np.concatenate(lines)


@cache
def cohesive_path(beam: Beam, young: float, nu: float, strength: float, energy: float, kind: str, elements: int = 100) -> Path:
    """The path of a beam with so many elements over its ligament; young, strength [Pa], energy [N/m]."""
    step = (beam.depth - beam.notch) / elements
    below = round(beam.notch / step)
    y = np.concatenate([np.linspace(0.0, beam.notch, below + 1)[:-1], np.linspace(beam.notch, beam.depth, elements + 1)])
    x = _graded([0.0, beam.slot / 2, beam.gauge / 2, beam.span / 2, beam.length / 2], step, beam.depth / 12)
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(len(x) - 1), np.arange(len(y) - 1), indexing="ij"))
    solid = (x[i + 1] > beam.slot / 2 + 1e-12) | (y[j + 1] > beam.notch + 1e-12)
    i, j = i[solid], j[solid]
    nodes = np.stack([number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]], axis=1)
    freedoms = np.stack([2 * nodes, 2 * nodes + 1], axis=2).reshape(-1, 8)
    sizes, which = np.unique(np.round(np.stack([x[i + 1] - x[i], y[j + 1] - y[j]], axis=1), 12), axis=0, return_inverse=True)
    values = beam.thickness * np.stack([_rectangle(a, b, young, nu) for a, b in sizes])[which.ravel()]
    n = 2 * number.size
    k = coo_matrix((values.ravel(), (np.repeat(freedoms, 8, axis=1).ravel(), np.tile(freedoms, 8).ravel())), (n, n)).tocsc()

    crack = 2 * number[0, below:]
    at = lambda place: int(np.abs(x - place).argmin())  # noqa: E731
    load, gauge = 2 * number[0, -1] + 1, 2 * number[at(beam.gauge / 2), 0]
    inner = np.isin(np.arange(n), freedoms)
    inner[crack] = inner[2 * number[at(beam.span / 2), 0] + 1] = False
    inner = np.flatnonzero(inner)
    place = np.full(n, -1)
    place[inner] = np.arange(len(inner))
    solve = splu(k[inner][:, inner]).solve
    border = k[inner][:, crack].toarray()
    pull = np.zeros(len(inner))
    pull[place[load]] = -0.5  # half of a unit load on half of the beam
    by_crack, by_load = -solve(border), solve(pull)
    stiffness = k[crack][:, crack].toarray() + border.T @ by_crack
    drive = -border.T @ by_load
    share = np.full(len(crack), step * beam.thickness)
    share[[0, -1]] *= 0.5

    traction = law(kind, strength, energy)
    u, force, path = np.zeros(len(crack)), 0.0, []
    for tip in range(len(crack) - 2):
        rows = slice(tip + 1)
        for _ in range(60):
            pressure, slope = traction(2.0 * u[rows])
            gap = stiffness[rows, :tip] @ u[:tip] - force * drive[rows] + share[rows] * pressure
            tangent = np.column_stack([stiffness[rows, :tip], -drive[rows]])
            tangent[np.arange(tip), np.arange(tip)] += 2.0 * share[:tip] * slope[:tip]
            change = np.linalg.solve(tangent, -gap)
            u[:tip] += change[:-1]
            force += change[-1]
            if np.abs(change[:-1]).max(initial=0.0) <= 1e-12 * energy / strength and np.abs(gap).max() < 1e-9 * strength * share[1]:
                break
        else:
            raise ArithmeticError(f"no equilibrium with the crack at node {tip}")
        path.append(
            [
                2.0 * (by_load[place[gauge]] * force + by_crack[place[gauge]] @ u),
                force,
                -(by_load[place[load]] * force + by_crack[place[load]] @ u),
            ]
        )
    return Path(*np.array(path).T)
