"""Restrained rocking by SciPy, written apart from the core: any one-coordinate structure, any springs between bounds."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = 9.80665


@dataclass
class Spring:
    """path(side, q) -> (u, du/dq); force prestress + k (u - set) between bounds, c |u'|^n beside it."""

    path: Callable[[int, float], tuple[float, float]]
    k: float = 0.0
    prestress: float = 0.0
    most: float = np.inf
    least: float = -np.inf
    slack: bool = False
    c: float = 0.0
    n: float = 1.0
    set: float = 0.0
    mode: str = "elastic"
    seen: list[float] = field(default_factory=list)

    def trial(self, u: float) -> float:
        return self.prestress + self.k * (u - self.set)

    def force(self, side: int, q: float, v: float) -> tuple[float, float]:
        u, du = self.path(side, q)
        spring = {"elastic": self.trial(u), "up": self.most, "down": self.least, "slack": 0.0}[self.mode]
        return spring + self.c * np.sign(du * v) * abs(du * v) ** self.n, du

    def margin(self, side: int, q: float, v: float) -> float:
        """Above zero while it stays in its mode."""
        u, du = self.path(side, q)
        if self.mode == "elastic":
            room = min(self.most - self.trial(u), self.trial(u) - self.least)
            return float(np.clip(room, -1e30, 1e30))
        return {"up": du * v, "down": -du * v, "slack": -self.trial(u)}[self.mode]

    def change(self, side: int, q: float) -> None:
        u, _ = self.path(side, q)
        if self.mode == "elastic":
            over = self.trial(u) - self.most > self.least - self.trial(u)
            self.mode = "up" if over else "slack" if self.slack else "down"
        elif self.mode == "slack":
            self.mode = "elastic"
        else:
            self.set = u - ({"up": self.most, "down": self.least}[self.mode] - self.prestress) / self.k
            self.mode = "elastic"


def rock(coefficients, springs, ground, end, *, side, q, v, restitution, limit, rest_rate, breaks=(), wall=None, rtol=1e-11):
    """Rotations at turning points and ends of phases [(time, signed rotation)], impacts [time], outcome of rocking from (q, v).

    coefficients(side, q) -> M, M'/2, V', H; ground(t) [m/s^2]; wall: rate after over before on the only open side.
    """
    t, peaks, impacts = 0.0, [], []
    stops = sorted({b for b in breaks if 0.0 < b < end} | {end})

    def rhs(x, y, side):
        m, half, dv, dh = coefficients(side, y[0])
        hold = sum(f * du for f, du in (s.force(side, y[0], y[1]) for s in springs))
        return [y[1], -(half * y[1] ** 2 + dv + side * ground(x) * dh + hold) / m]

    for _ in range(20000):
        if t >= end:
            return peaks, impacts, "open"
        stop = min(b for b in stops if b > t + 1e-13)
        events = [lambda x, y, side: y[0], lambda x, y, side: y[1], lambda x, y, side: y[0] - limit]
        for e, way, last in zip(events, (-1, -1, 1), (True, False, True), strict=True):
            e.direction, e.terminal = way, last
        for s in springs:  # on a bound at the start: does it go on beyond it?
            u, du = s.path(side, q)
            onward = du * (v if abs(v) > 1e-12 else rhs(t, [q, v], side)[1])
            near = 1e-8 * (s.k + abs(s.prestress) * 1e-3)
            if s.mode == "elastic" and s.k and s.trial(u) > s.most - near and onward > 0.0:
                s.mode = "up"
            elif s.mode == "elastic" and s.k and s.trial(u) < s.least + near and onward < 0.0:
                s.mode = "slack" if s.slack else "down"
            begun = t + 1e-9
            watch = lambda x, y, side, s=s, begun=begun: s.margin(side, y[0], y[1]) if x > begun else 1.0  # noqa: E731
            watch.direction, watch.terminal = -1, True
            events.append(watch)
        answer = solve_ivp(rhs, (t, stop), [q, v], "DOP853", args=(side,), rtol=rtol, atol=1e-14, events=events)
        peaks += [(x, side * y[0]) for x, y in zip(answer.t_events[1], answer.y_events[1], strict=True) if x > 1e-9 < y[0]]
        t, (q, v) = answer.t[-1], answer.y[:, -1]
        peaks.append((t, side * q))
        if answer.status != 1:
            continue
        if len(answer.t_events[2]):
            return peaks, impacts, "collapse"
        if len(answer.t_events[0]):
            impacts.append(t)
            for s in springs:
                if s.mode in ("up", "down"):
                    s.change(side, 0.0)
            q = 0.0
            if wall is None:
                side, v = -side, -restitution * v
            else:
                v = -wall * v
            if v <= rest_rate:
                return peaks, impacts, "rest"
        for s, found in zip(springs, answer.t_events[3:], strict=True):
            if len(found):
                s.change(side, q)
    raise RuntimeError("no progress")
