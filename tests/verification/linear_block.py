"""The slender block of the linear equation in closed form, piece by piece: no integrator, no step.

With x = q/alpha, tau = p t and side s the equation of motion x'' - x = -1 - s f(tau), f the ground acceleration over
g alpha, has the solution

    x = 1 + A cosh(tau) + B sinh(tau) + s F(tau),     F(tau) = f sin/cos part over 1 + w^2, or f itself where it is constant,

so that impacts are roots of known functions. Zhang and Makris, J. Eng. Mech. 127 (2001) 473-483, and Dimitrakopoulos
and DeJong, Proc. R. Soc. A 468 (2012) 2293-2318, write the same solution for single pulses.
"""

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

#: Pieces of a cycle in which roots are bracketed: half cycles of rocking last far longer
GRID = 0.01


@dataclass(frozen=True)
class Wave:
    """f = constant + amplitude sin(w tau + phase) from `start` to `end`."""

    start: float
    end: float
    constant: float = 0.0
    amplitude: float = 0.0
    w: float = 1.0
    phase: float = 0.0

    def value(self, tau: float) -> float:
        return self.constant + self.amplitude * np.sin(self.w * tau + self.phase)

    def particular(self, tau: np.ndarray | float) -> tuple:
        """F and F' with F'' - F = -f."""
        angle, share = self.w * tau + self.phase, self.amplitude / (1.0 + self.w**2)
        return self.constant + share * np.sin(angle), share * self.w * np.cos(angle)


def one_sine(amplitude: float, w: float) -> list[Wave]:
    """First to -x, so that the block first rocks to +x."""
    return [Wave(0.0, 2.0 * np.pi / w, amplitude=-amplitude, w=w)]


def one_cosine(amplitude: float, w: float) -> list[Wave]:
    return [Wave(0.0, 2.0 * np.pi / w, amplitude=-amplitude, w=w, phase=0.5 * np.pi)]


def rectangle(amplitude: float, length: float) -> list[Wave]:
    return [Wave(0.0, length, constant=-amplitude)]


def outcome(waves: list[Wave], c_v: float, most_impacts: int = 60) -> tuple[str, int]:
    """The word "rest", "safe" or "down", and the impacts before.

    From rest it lifts where |f| passes 1. Down: past x = 2 as the program has it; safe: after the pulse, with less
    energy than the barrier.
    """
    begin = next(((piece, t) for piece in waves if (t := _uplift(piece)) is not None), None)
    if begin is None:
        return "rest", 0
    pieces = [*waves[waves.index(begin[0]) :], Wave(waves[-1].end, np.inf)]
    tau, x, v = begin[1], 0.0, 0.0
    side = -np.sign(pieces[0].value(tau + 1e-9))
    impacts = 0
    for piece in pieces:
        while tau < piece.end:
            if np.isinf(piece.end) and v**2 < (x - 1.0) ** 2 and x < 1.0:  # it cannot pass the balance any more
                return "safe", impacts
            shift, slope = piece.particular(tau)
            a, b = x - 1.0 - side * shift, v - side * slope

            def state(t, piece=piece, a=a, b=b, tau=tau, side=side):
                shift, slope = piece.particular(t)
                c, s = np.cosh(t - tau), np.sinh(t - tau)
                return 1.0 + a * c + b * s + side * shift, a * s + b * c + side * slope

            ends = np.arange(tau, min(piece.end, tau + 40.0) + GRID, GRID)[1:]
            ends[-1] = min(piece.end, ends[-1])
            places = state(ends)[0]
            over = np.flatnonzero((places <= 0.0) | (places >= 2.0))
            if not len(over):
                tau = piece.end
                x, v = state(tau)
                continue
            k = over[0]
            if places[k] >= 2.0:
                return "down", impacts
            before = ends[k - 1] if k else tau + 1e-9
            if state(before)[0] <= 0.0:  # it only touched: the ground did not lift it
                return "safe", impacts
            tau = brentq(lambda t, state=state: state(t)[0], before, ends[k], xtol=1e-14, rtol=1e-14)
            x, v = 0.0, -c_v * state(tau)[1]
            side, impacts = -side, impacts + 1
            if impacts >= most_impacts:
                return "safe", impacts
    return "safe", impacts


def _uplift(piece: Wave) -> float | None:
    """When |f| first passes 1 within a piece."""
    t = np.linspace(piece.start, piece.end, 4001)
    f = np.abs(piece.value(t))
    k = np.flatnonzero(f > 1.0)
    if not len(k):
        return None
    if not k[0]:
        return piece.start
    return brentq(lambda x: abs(piece.value(x)) - 1.0, t[k[0] - 1], t[k[0]], xtol=1e-14)


def edges(pulse, c_v: float, amplitudes: np.ndarray, mode: str = "either") -> list[float]:
    """Amplitudes at which it changes between falling and standing, each by bisection within a cell of `amplitudes`.

    `pulse(amplitude)` gives the waves; mode "no impact": falling before any impact counts alone.
    """

    def falls(amplitude: float) -> bool:
        word, impacts = outcome(pulse(amplitude), c_v)
        return word == "down" and (mode == "either" or not impacts)

    found, before = [], falls(amplitudes[0])
    for low, high in itertools.pairwise(amplitudes):
        after = falls(high)
        if after != before:
            a, b = low, high
            for _ in range(40):
                middle = 0.5 * (a + b)
                a, b = (middle, b) if falls(middle) == before else (a, middle)
            found.append(0.5 * (a + b))
        before = after
    return found
