"""Housner's block by SciPy, written apart from the core; the same model as tests/bench/rocking_peers.py."""

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = 9.80665


def reference(p, alpha, c_v, samples, step, start, end_time, rtol=1e-10, atol=1e-13):
    """Peak rotation over alpha and outcome (0 at rest, 1 rocked, 2 collapse) by DOP853, restarted at every sample."""
    s = 1.0 if start >= 0.0 else -1.0
    q, v = abs(start), 0.0
    resting = q == 0.0
    peak, moved = q, not resting
    edges = np.arange(len(samples)) * step
    segments = [(edges[k], edges[k + 1], samples[k], samples[k + 1]) for k in range(len(samples) - 1)]
    if end_time > edges[-1]:
        segments.append((edges[-1], end_time, 0.0, 0.0))
    tan = np.tan(alpha)
    for t0, t1, a0, a1 in segments:
        if t0 >= end_time:
            break
        slope = (a1 - a0) / (t1 - t0)
        t, t1 = t0, min(t1, end_time)
        while t < t1:
            if resting:
                here, there = a0 + slope * (t - t0), a0 + slope * (t1 - t0)
                limit = GRAVITY * tan
                if abs(here) > limit:
                    s = -np.sign(here)
                elif abs(there) > limit:
                    t = t0 + (np.sign(there) * limit - a0) / slope
                    s = -np.sign(there)
                else:
                    break
                resting, moved, q, v = False, True, 0.0, 0.0

            def rhs(x, y, s=s, t0=t0, a0=a0, slope=slope):
                a = (a0 + slope * (x - t0)) / GRAVITY
                return [y[1], -p * p * (np.sin(alpha - y[0]) + s * a * np.cos(alpha - y[0]))]

            def down(x, y):
                return y[0]

            def turn(x, y):
                return y[1]

            def over(x, y):
                return y[0] - 2.0 * alpha

            down.terminal, down.direction = True, -1
            turn.direction = -1
            over.terminal, over.direction = True, 1
            answer = solve_ivp(rhs, (t, t1), [q, v], "DOP853", rtol=rtol, atol=atol, events=(down, turn, over))
            peak = max([peak, answer.y[0, -1], *(y[0] for y in answer.y_events[1])])
            if len(answer.t_events[2]):
                return 2.0, 2
            t = answer.t[-1]
            q, v = answer.y[:, -1]
            if len(answer.t_events[0]) and answer.status == 1:
                q, v, s = 0.0, -c_v * v, -s
                if v <= 1e-3 * p * alpha:
                    resting, v = True, 0.0
    return peak / alpha, int(moved)
