"""The dissertation's prestressed beam in four-point bending (4.3.1), written apart from the program: no file of extrados is used.

Quadrilaterals of 20 mm with 2 x 2 Gauss points, a centre column of 1 x 4 points that crack by isotropic damage, the teeth of a
ripple of half-width p about linear softening, and the dissertation's rule of the critical multiplier (Fig. 4-3).
Assumed, because the text prints them only as a drawing: length 500, span 460, load spacing 140 mm, and the depth.
"""

from dataclasses import dataclass

import numpy as np

YOUNG, POISSON, STRENGTH, ENERGY, BAND, THICKNESS = 32e9, 0.2, 3e6, 60.0, 0.02, 0.05
LENGTH, COLUMNS, ROWS = 0.5, 25, 4
ELASTICITY = YOUNG / (1 - POISSON**2) * np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, (1 - POISSON) / 2]])


@dataclass(frozen=True)
class Course:
    """Events one by one: multiplier of the loads, whether equilibrium holds, deflection of the bottom at midspan [m]."""

    multiplier: np.ndarray
    equilibrium: np.ndarray
    deflection: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


def make_teeth(ripple: float) -> list[tuple[float, float]]:
    """Secant modulus over Young's modulus, and strength [Pa], of each tooth: peaks lie p ft above the softening line, the drop at
    constant strain ends p ft below it."""
    start, end = STRENGTH / YOUNG, 2 * ENERGY / (BAND * STRENGTH)
    slope = STRENGTH / (end - start)
    teeth, secant = [], YOUNG
    while secant > 0.0:  # a rest below ft/1000 is no tooth: p = 0.1 gives the 16 of the text
        strain = (STRENGTH * (1 + ripple) + slope * start) / (secant + slope)
        teeth.append((secant / YOUNG, secant * strain))
        rest = secant * strain - 2 * ripple * STRENGTH
        secant = rest / strain if rest > STRENGTH / 1000 else 0.0
    return teeth


def strain_matrix(xi: float, eta: float, a: float, b: float) -> np.ndarray:
    """Strains of a rectangle a x b from the displacements of its corners, counter-clockwise."""
    x, y = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    dx, dy = x * (1 + eta * y) / 4 * 2 / a, y * (1 + xi * x) / 4 * 2 / b
    matrix = np.zeros((3, 8))
    matrix[0, 0::2], matrix[1, 1::2], matrix[2, 0::2], matrix[2, 1::2] = dx, dy, dy, dx
    return matrix


def follow_beam(depth: float, prestress: float, ripple: float = 0.1, events: int = 400) -> Course:
    """The events until the stiffness is that of a mechanism; depth [m], prestress [Pa], tension positive."""
    a, b = LENGTH / COLUMNS, depth / ROWS
    nodes = (COLUMNS + 1) * (ROWS + 1)

    def number(i: int, j: int) -> int:
        return i * (ROWS + 1) + j

    def place(i: int, j: int) -> np.ndarray:
        corners = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
        return np.array([[2 * n, 2 * n + 1] for n in corners]).ravel()

    def share(t: int) -> float:
        return teeth[t][0] if t < len(teeth) else 0.0

    root = 1 / np.sqrt(3)
    roots, weights = np.polynomial.legendre.leggauss(ROWS)
    whole = sum(
        B.T @ ELASTICITY @ B * (a * b / 4 * THICKNESS) for B in (strain_matrix(x, y, a, b) for x in (-root, root) for y in (-root, root))
    )
    fixed = np.zeros((2 * nodes, 2 * nodes))
    points = []
    for i in range(COLUMNS):
        for j in range(ROWS):
            at = place(i, j)
            if i == COLUMNS // 2:
                points += [(at, strain_matrix(0.0, y, a, b), w / 2 * a * b * THICKNESS) for y, w in zip(roots, weights, strict=True)]
            else:
                fixed[np.ix_(at, at)] += whole
    loads = np.zeros((2 * nodes, 2))  # A: prestress; B: two forces of 500 N
    for i, sign in ((0, -1.0), (COLUMNS, 1.0)):
        for j in range(ROWS):
            for k in (j, j + 1):
                loads[2 * number(i, k), 0] += sign * prestress * b * THICKNESS / 2
    for i in (9, 16):
        loads[2 * number(i, ROWS) + 1, 1] = -500.0
    held = [2 * number(1, 0), 2 * number(1, 0) + 1, 2 * number(24, 0) + 1]
    free = np.setdiff1d(np.arange(2 * nodes), held)
    teeth = make_teeth(ripple)
    tooth, found = np.zeros(len(points), dtype=int), []
    for _ in range(events):
        stiffness = fixed.copy()
        for (at, matrix, volume), t in zip(points, tooth, strict=True):
            stiffness[np.ix_(at, at)] += share(t) * volume * (matrix.T @ ELASTICITY @ matrix)
        moved = np.zeros((2 * nodes, 2))
        moved[free] = np.linalg.solve(stiffness[np.ix_(free, free)], loads[free])
        if not np.isfinite(moved).all() or abs(moved).max() > 1e2 * LENGTH:
            break
        lower, upper, weakest, strongest = -np.inf, np.inf, -1, -1
        for k, ((at, matrix, _), t) in enumerate(zip(points, tooth, strict=True)):
            if t == len(teeth):
                continue
            stress_a, stress_b = share(t) * (ELASTICITY @ matrix @ moved[at])[0]
            limit = (teeth[t][1] - stress_a) / stress_b
            if stress_b > 0 and limit < upper:
                upper, strongest = limit, k
            if stress_b < 0 and limit > lower:
                lower, weakest = limit, k
        stands = upper >= lower
        multiplier, critical = (upper, strongest) if stands else (lower, weakest)
        if critical < 0:
            break
        middle = number(12, 0)
        found.append((multiplier, stands, -(moved[2 * middle + 1] @ [1.0, multiplier]), lower, upper))
        tooth[critical] += 1
        if (tooth == len(teeth)).all():
            break
    return Course(*(np.array(column) for column in zip(*found, strict=True)))
