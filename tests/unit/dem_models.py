"""Small models and references for the tests of discrete elements."""

import numpy as np
from scipy.integrate import solve_ivp

from extrados.core import dem
from extrados.core.ground import Ground
from extrados.schema.constants import GRAVITY

G = GRAVITY


def rectangle(left: float, right: float, bottom: float, top: float) -> np.ndarray:
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])


def model(blocks: list[np.ndarray], supports: list[np.ndarray], law: dem.Law, density: float = 2000.0) -> dem.Bodies:
    """Bodies from rectangles: blocks first, supports after them."""
    shapes = [*blocks, *supports]
    centroid = np.array([s.mean(axis=0) for s in shapes])
    size = np.array([np.ptp(s, axis=0) for s in shapes])
    mass = density * size.prod(axis=1)
    inertia = mass * (size**2).sum(axis=1) / 12.0
    mass[len(blocks) :] = inertia[len(blocks) :] = 0.0
    edges = [np.ones(4, dtype=bool)] * len(shapes)
    return dem.Bodies(centroid, mass, inertia, shapes, list(range(len(shapes))), edges, 1.0, [law])


def block_on_floor(width: float, height: float, law: dem.Law) -> dem.Bodies:
    return model([rectangle(-width / 2, width / 2, 0.0, height)], [rectangle(-20.0, 20.0, -1.0, 0.0)], law)


def constant(value: float, duration: float = 100.0) -> Ground:
    return pieces([0.0, duration], [value])


def pieces(breaks: list[float], values: list[float]) -> Ground:
    """Accelerations that are constant between breaks."""
    linear = np.array([[[v, 0.0]] for v in values])
    return Ground(breaks=np.array(breaks), linear=linear, harmonic=np.zeros((len(values), 1, 0, 4)))


def cosine(amplitude: float, omega: float, duration: float = 100.0) -> Ground:
    return Ground(
        breaks=np.array([0.0, duration]),
        linear=np.zeros((1, 1, 2)),
        harmonic=np.array([amplitude, 0.0, omega, 0.5 * np.pi]).reshape(1, 1, 1, 4),
    )


def housner(width: float, height: float, amplitude: float, omega: float, times: np.ndarray) -> np.ndarray:
    """Rotation (positive to +x) of the rigid block under amplitude cos(omega t) from rest, c_v = 1 - 1.5 sin^2 alpha.

    theta'' = -p^2 [sin(s alpha - theta) + (u''/g) cos(s alpha - theta)] between impacts (Housner 1963).
    """
    alpha = np.arctan2(width, height)
    p2 = 1.5 * G / np.hypot(width, height)
    restitution = 1.0 - 1.5 * np.sin(alpha) ** 2
    out = np.zeros(len(times))
    t, state, side = 0.0, [0.0, 0.0], -1.0 if amplitude > 0.0 else 1.0

    def crossing(time, y):
        return y[0]

    crossing.terminal = True
    while True:

        def rate(time, y, side=side):
            turn = side * alpha - y[0]
            return [y[1], -p2 * (np.sin(turn) + amplitude * np.cos(omega * time) / G * np.cos(turn))]

        crossing.direction = -side
        part = solve_ivp(
            rate, (t, times[-1]), state, method="DOP853", rtol=1e-10, atol=1e-13, events=crossing, dense_output=True, max_step=0.01
        )
        now = (times >= t) & (times <= part.t[-1])
        out[now] = part.sol(times[now])[0]
        if part.status != 1:
            return out
        t, speed = part.t[-1], part.y[1, -1] * restitution
        side = np.sign(speed)
        state = [1e-13 * side, speed]
