"""A circular cylinder that rolls on its sharp rim without sliding, on a level floor: its equations of motion by SciPy.

With the arm a from the centroid to the lowest point of the rim, rolling says v = -w x a. The floor's force follows from m dv/dt,
and Euler's equations about the centroid give I dw/dt + m a x (dw/dt x a) = -w x I w + m a x (g z - w x da/dt) (Stefanou,
Vardoulakis and Mavraganis 2011 study these motions).
"""

import numpy as np
from scipy.integrate import solve_ivp

from extrados.schema.constants import GRAVITY

UP = np.array([0.0, 0.0, 1.0])


def arm(axis: np.ndarray, radius: float, height: float) -> np.ndarray:
    """From the centroid to the lowest point of the lower rim, of a cylinder with an upward axis [m]."""
    across = UP - (UP @ axis) * axis
    return -0.5 * height * axis - radius * across / np.linalg.norm(across)


def rolled(axis: np.ndarray, spin: np.ndarray, inertia: tuple[float, float], radius: float, height: float, times: np.ndarray) -> np.ndarray:
    """Axis of the cylinder at the times (t, 3).

    axis: at the start, spin [rad/s]; inertia over the mass about a diameter through the centroid and about the axis [m^2].
    """
    about, along = inertia

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        e, w = state[:3], state[3:]
        turning = about * np.eye(3) + (along - about) * np.outer(e, e)
        a, moved = arm(e, radius, height), np.cross(w, e)
        across = UP - (UP @ e) * e
        change = -(UP @ moved) * e - (UP @ e) * moved
        length = np.linalg.norm(across)
        da = -0.5 * height * moved - radius * (change / length - across * (across @ change) / length**3)
        matrix = turning + (a @ a) * np.eye(3) - np.outer(a, a)
        right = -np.cross(w, turning @ w) + np.cross(a, GRAVITY * UP - np.cross(w, da))
        return np.concatenate([moved, np.linalg.solve(matrix, right)])

    return solve_ivp(rates, (0.0, float(times[-1])), [*axis, *spin], rtol=1e-10, atol=1e-12, t_eval=times).y[:3].T


def steady(tilt: float, inertia: tuple[float, float], radius: float, height: float) -> tuple[np.ndarray, float]:
    """Spin [rad/s] of a cylinder whose axis leans by `tilt` [rad] towards +x while its centroid rests, and the rate [rad/s] at
    which its point of contact goes round: Euler's disk, 4 g / (r sin tilt) under the root where it is thin (Moffatt 2000)."""
    axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    a = arm(axis, radius, height)
    # w = rate (up + share axis) lies along the arm: what is square to the arm in their plane vanishes.
    square = np.array([-a[2], 0.0, a[0]])
    share = -(UP @ square) / (axis @ square)
    one = UP + share * axis
    about, along = inertia
    swing = about * one + (along - about) * (axis @ one) * axis
    rate = float(np.sqrt(np.linalg.norm(np.cross(a, GRAVITY * UP)) / np.linalg.norm(np.cross(UP, swing))))
    return rate * one, rate
