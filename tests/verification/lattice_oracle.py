"""A wall as a triangular lattice of bars that soften by saw-teeth: the algorithm for loads in two parts in a lattice framework, written
apart from the program (dissertation 8.3).

Bars of length a in three directions have the plane stiffness E and a Poisson ratio of 1/3 where E A = sqrt(3)/2 E a t. A bar breaks at
F = f_t a t / sqrt(3), the force in uniaxial tension across its rows, and softens linearly to an elongation of sqrt(3) G_f / f_t: a level
crack cuts two bars in each a, and they dissipate G_f a t. Level bars do not break: compression across the rows pulls at them, which
would split the lattice and not a continuum.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

TEETH = 20
GRAVITY = 9.80665


@dataclass(frozen=True)
class Wall:
    """Sizes [m], E, f_t and the pressure on the top [Pa], G_f [N/m], density [kg/m^3]."""

    length: float
    height: float
    thickness: float
    young: float
    strength: float
    energy: float
    pressure: float
    density: float


def lattice(wall: Wall, a: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) [m] and bars (m, 2): level rows, every other row shifted by half a bar and with a node at both edges."""
    rows = round(wall.height / (a * np.sqrt(3.0) / 2.0))
    rise, count = wall.height / rows, round(wall.length / a)
    places = []
    for k in range(rows + 1):
        x = np.arange(count + 1) * a if k % 2 == 0 else np.r_[0.0, (np.arange(count) + 0.5) * a, wall.length]
        places.append(np.column_stack([x, np.full(len(x), k * rise)]))
    nodes = np.concatenate(places)
    start = np.cumsum([0, *map(len, places)])
    bars = []
    for k, row in enumerate(places):
        bars += [(start[k] + i, start[k] + i + 1) for i in range(len(row) - 1)]
        if k < rows:
            bars += [
                (start[k] + i, start[k + 1] + j)
                for i in range(len(row))
                for j in range(len(places[k + 1]))
                if abs(row[i, 0] - places[k + 1][j, 0]) <= 0.5 * a + 1e-9
            ]
    return nodes, np.array(bars)


def push(wall: Wall, a: float, reach: float, events: int = 20000) -> tuple[np.ndarray, np.ndarray]:
    """Displacement [m] and force [N] of the top in the states in equilibrium, moved as one to +x until `reach`."""
    nodes, bars = lattice(wall, a)
    way = nodes[bars[:, 1]] - nodes[bars[:, 0]]
    long = np.hypot(*way.T)
    unit = way / long[:, None]
    edge = np.isin(nodes[bars], (0.0, wall.length))[:, :, 0].all(axis=1) | np.isclose(nodes[bars][:, :, 1], wall.height).all(axis=1)
    stiff = np.sqrt(3.0) / 2.0 * wall.young * a * wall.thickness / long * np.where(edge, 0.5, 1.0)
    top, foot = np.isclose(nodes[:, 1], wall.height), np.isclose(nodes[:, 1], 0.0)
    number = np.full(nodes.shape, -1)
    number[top, 0] = 0  # the top moves as one
    rest = (number < 0) & ~foot[:, None]
    number[rest] = 1 + np.arange(rest.sum())
    n = int(rest.sum()) + 1
    share = wall.length * wall.height * wall.thickness * wall.density * GRAVITY / len(nodes)
    down = np.full(len(nodes), -share)
    width = np.gradient(nodes[top, 0])
    width[[0, -1]] *= 0.5
    down[top] -= wall.pressure * wall.thickness * wall.length * width / width.sum()
    first, second = np.zeros(n), np.zeros(n)
    np.add.at(first, number[~foot, 1], down[~foot])
    second[0] = 1.0
    free = number[bars].reshape(len(bars), 4)
    shape = np.column_stack([-unit, unit])
    held = free >= 0
    b = sp.csr_matrix((shape[held], (np.nonzero(held)[0], free[held])), shape=(len(bars), n))
    force = wall.strength * a * wall.thickness / np.sqrt(3.0) * np.where(edge, 0.5, 1.0)
    teeth = np.where(np.abs(unit[:, 1]) < 1e-9, TEETH, 0)  # level bars stay whole: under compression they would split the lattice
    last = np.sqrt(3.0) * wall.energy / wall.strength
    begin = force / stiff
    limit, now = force.copy(), stiff.copy()
    path = []
    for _ in range(events):
        solve = splu((b.T @ sp.diags(now) @ b).tocsc())
        one, two = solve.solve(first), solve.solve(second)
        pull, more = now * (b @ one), now * (b @ two)
        with np.errstate(divide="ignore", invalid="ignore"):
            bound = (limit - pull) / more
        alive = teeth < TEETH
        upper = np.where(alive & (more > 1e-14), bound, np.inf)
        lower = np.where(alive & (more < -1e-14), bound, -np.inf)
        if lower.max() <= upper.min():
            worst, factor = int(upper.argmin()), float(upper.min())
            path.append((one[0] + factor * two[0], factor))
            if path[-1][0] > reach:
                break
        elif abs(one[0]) > 10.0 * reach:
            break  # a mechanism under its own weight
        else:
            worst = int(lower.argmax())
        teeth[worst] += 1
        left = 1.0 - teeth[worst] / TEETH
        # on the softening line at this part of the strength; the secant of the line there
        at = begin[worst] + (last - begin[worst]) * (1.0 - left)
        limit[worst] = left * force[worst] if teeth[worst] < TEETH else np.inf
        now[worst] = left * force[worst] / at if teeth[worst] < TEETH else 1e-9 * stiff[worst]
    return tuple(np.array(path).T)
