"""Peers of the rocking core, written apart from it: SciPy's solve_ivp and a numba RK4 on a fixed step.

Both know the same model: Housner's block under samples joined by straight lines, rest where the rate after an
impact is below 1e-3 p alpha, uplift from rest where |a| exceeds g tan alpha, collapse at twice alpha.
"""

import numba
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


@numba.njit
def rk4(p, alpha, c_v, samples, step, start, end_time, parts):
    """The same with `parts` classical Runge-Kutta steps a sample; impacts at the straight line between two steps."""
    s = 1.0 if start >= 0.0 else -1.0
    q, v = abs(start), 0.0
    resting = q == 0.0
    peak, moved = q, 0 if resting else 1
    h = step / parts
    limit = GRAVITY * np.tan(alpha)
    n = int(end_time / step + 0.5)
    p2 = p * p
    for k in range(n):
        a0 = samples[k] if k < len(samples) else 0.0
        a1 = samples[k + 1] if k + 1 < len(samples) else 0.0
        for j in range(parts):
            b0 = a0 + (a1 - a0) * j / parts
            b1 = a0 + (a1 - a0) * (j + 1) / parts
            bm = 0.5 * (b0 + b1)
            if resting:
                if abs(b0) <= limit:
                    continue
                s = -1.0 if b0 > 0.0 else 1.0
                resting = False
                moved = 1
                q = 0.0
                v = 0.0
            g0, gm, g1 = s * b0 / GRAVITY, s * bm / GRAVITY, s * b1 / GRAVITY
            r = alpha - q
            k1 = -p2 * (np.sin(r) + g0 * np.cos(r))
            r = alpha - (q + 0.5 * h * v)
            k2 = -p2 * (np.sin(r) + gm * np.cos(r))
            r = alpha - (q + 0.5 * h * (v + 0.5 * h * k1))
            k3 = -p2 * (np.sin(r) + gm * np.cos(r))
            r = alpha - (q + h * (v + 0.5 * h * k2))
            k4 = -p2 * (np.sin(r) + g1 * np.cos(r))
            q_new = q + h * (v + h * (k1 + k2 + k3) / 6.0)
            v_new = v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
            if q_new < 0.0:
                share = q / (q - q_new) if q > q_new else 1.0
                v_hit = v + share * (v_new - v)
                s = -s
                v_new = -c_v * v_hit
                if v_new <= 1e-3 * p * alpha:
                    resting = True
                    v_new = 0.0
                    q_new = 0.0
                else:
                    q_new = v_new * (1.0 - share) * h
            q, v = q_new, v_new
            peak = max(peak, q)
            if q > 2.0 * alpha:
                return 2.0, 2
    return peak / alpha, moved


@numba.njit(parallel=True)
def rk4_many(p, alpha, c_v, motions, step, start, end_time, parts):
    """`rk4` for many motions on numba's threads: peak ratios and outcomes."""
    n = len(motions)
    peak, outcome = np.empty(n), np.empty(n, np.int64)
    for i in numba.prange(n):
        peak[i], outcome[i] = rk4(p, alpha, c_v, motions[i], step, start, end_time, parts)
    return peak, outcome
