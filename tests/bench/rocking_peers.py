"""A numba RK4 on a fixed step, a peer of the rocking core written apart from it.

Housner's block under samples joined by straight lines, rest where the rate after an impact is below 1e-3 p alpha, uplift
from rest where |a| exceeds g tan alpha, collapse at twice alpha.
"""

import numba
import numpy as np

GRAVITY = 9.80665


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
