"""An independent rocking arch: positions by Newton, coefficients by splines, time by SciPy."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from scipy.optimize import fsolve

G = 9.80665


class Oracle:
    """The mechanism of an ArchModel, voussoir by voussoir (not link by link), with its own kinematics."""

    def __init__(self, model, restitution: float):
        arch, m = model.arch, model.four_hinge
        self.restitution = restitution
        a, b, c, d = m.hinge
        link = np.searchsorted(m.joint, np.arange(arch.voussoirs), side="right")
        qs = np.linspace(0.0, 2.2 * model.limits.critical, 120)
        sense = -1.0  # link AB turns clockwise when the arch goes to +x
        place = np.zeros((len(qs), arch.voussoirs, 2))
        turn = np.zeros((len(qs), arch.voussoirs))
        guess = np.zeros(2)
        for k, q in enumerate(qs):

            def rot(v, t):
                return np.array([np.cos(t) * v[0] - np.sin(t) * v[1], np.sin(t) * v[0] + np.cos(t) * v[1]])

            at_b = a + rot(b - a, sense * q)
            guess = fsolve(lambda t, at_b=at_b: at_b + rot(c - b, t[0]) - d - rot(c - d, t[1]), guess, xtol=1e-12)
            angles = [0.0, sense * q, guess[0], guess[1], 0.0]
            pivots = [(a, a), (a, a), (b, at_b), (d, d), (d, d)]
            for i in range(arch.voussoirs):
                old, new = pivots[link[i]]
                place[k, i] = new + rot(arch.centroid[i] - old, angles[link[i]]) if link[i] else arch.centroid[i]
                turn[k, i] = angles[link[i]]
        x = make_interp_spline(qs, place, k=7)
        t = make_interp_spline(qs, turn, k=7)
        dx, dt = x.derivative(), t.derivative()
        mass = np.einsum("kij,i->k", dx(qs) ** 2, arch.mass) + dt(qs) ** 2 @ arch.inertia
        self.mass = make_interp_spline(qs, mass, k=7)
        self.dmass = self.mass.derivative()
        self.dv = make_interp_spline(qs, G * dx(qs)[:, :, 1] @ arch.mass, k=7)
        self.dh = make_interp_spline(qs, dx(qs)[:, :, 0] @ arch.mass, k=7)
        self.limit = 2.0 * model.limits.critical

    def run(self, ground, start: float, side: int, end: float, max_step: float, rtol: float = 1e-10):
        """From uplift at `start` to `side`: impact times and peaks (time, rotation) until collapse, or eight impacts."""
        impacts, peaks = [], []
        t, y = start, np.zeros(2)
        while t < end and len(impacts) < 8:

            def rhs(t, y, side=side):
                q, v = y
                force = 0.5 * self.dmass(q) * v * v + self.dv(q) + side * ground(t) * self.dh(q)
                return [v, -force / self.mass(q)]

            def hit(t, y):
                return y[0]

            def turned(t, y):
                return y[1]

            def fallen(t, y):
                return y[0] - self.limit

            hit.terminal = fallen.terminal = True
            hit.direction = turned.direction = -1
            s = solve_ivp(rhs, (t, end), y, rtol=rtol, atol=1e-14, max_step=max_step, events=[hit, turned, fallen], method="DOP853")
            peaks += [(float(a), side * float(b[0])) for a, b in zip(s.t_events[1], s.y_events[1], strict=True) if b[0] > 1e-9]
            if len(s.t_events[2]):
                return impacts, peaks, float(s.t_events[2][0])
            if not len(s.t_events[0]):
                break
            t = float(s.t_events[0][-1])
            impacts.append(t)
            y = np.array([0.0, self.restitution * abs(s.y_events[0][-1][1])])
            side = -side
        return impacts, peaks, None
