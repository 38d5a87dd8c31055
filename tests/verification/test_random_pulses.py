"""A free block under random pulses and trains of them against SciPy's DOP853, integrated piece by piece."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from extrados.core import rocking
from extrados.model.structures.block import make_block
from extrados.motions import pulses
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.block import BlockModel
from trials import Trial

SHAPES = ("step", "sine", "half-sine", "rectangular", "cosine", "train")
#: Motions are on the edge where this share more or less of the amplitude changes outcome, impacts or peak
NUDGE = 1e-6


def pieces(shape: str, amplitude: float, length: float) -> list[tuple[float, float, object]]:
    """Begin, end and ground acceleration [m/s^2] of each smooth piece, written apart from extrados.motions.

    `length`: T_p of sines and cosines, t_p of the first part of a step and of a rectangle; a train has three sines.
    """
    w = 2.0 * np.pi / length

    def sine(t: float) -> float:
        return amplitude * np.sin(w * t)

    return {
        "step": [(0.0, length, lambda t: amplitude), (length, 3.0 * length, lambda t: -0.5 * amplitude)],
        "sine": [(0.0, length, sine)],
        "half-sine": [(0.0, 0.5 * length, sine)],
        "rectangular": [(0.0, length, lambda t: amplitude)],
        "cosine": [(0.0, length, lambda t: amplitude * np.cos(w * t))],
        "train": [(0.0, 3.0 * length, sine)],
    }[shape]


def ground(shape: str, amplitude: float, length: float):
    if shape == "step":
        return pulses.step_pulse(amplitude, length).ground
    if shape == "sine":
        return pulses.sine_pulse(amplitude, length).ground
    if shape == "train":
        return pulses.harmonic(amplitude, 1.0 / length, 3.0 * length).ground
    return pulses.pulse(shape, amplitude, length).ground


def by_dop853(p: float, alpha: float, c_v: float, shape: str, amplitude: float, length: float, settle: float):
    """Outcome (0 rest, 1 rocked, 2 down) and peak over alpha."""
    parts = pieces(shape, amplitude, length)
    parts.append((parts[-1][1], parts[-1][1] + settle, lambda t: 0.0))
    uplift = GRAVITY * np.tan(alpha)
    q = v = peak = 0.0
    side, resting, moved = 1.0, True, False
    for begin, end, acceleration in parts:
        t = begin
        while t < end:
            if resting:
                grid = np.linspace(t, end, 4001)
                over = np.flatnonzero([abs(acceleration(x)) > uplift for x in grid])
                if not len(over):
                    break
                k = over[0]
                if k:
                    low, high = grid[k - 1], grid[k]
                    for _ in range(60):
                        middle = 0.5 * (low + high)
                        low, high = (low, middle) if abs(acceleration(middle)) > uplift else (middle, high)
                    t = high
                side, resting, moved, q, v = -np.sign(acceleration(t + 1e-12)), False, True, 0.0, 0.0

            def rhs(x, y, side=side, acceleration=acceleration):
                turn = alpha - y[0]
                return (y[1], -p * p * (np.sin(turn) + side * acceleration(x) / GRAVITY * np.cos(turn)))

            def closes(x, y):
                return y[0]

            def turns(x, y):
                return y[1]

            def falls(x, y):
                return y[0] - 2.0 * alpha

            closes.terminal, closes.direction, turns.direction = True, -1, -1
            falls.terminal, falls.direction = True, 1
            s = solve_ivp(
                rhs, (t, end), (q, v), "DOP853", rtol=1e-11, atol=1e-14 * alpha, events=(closes, turns, falls), max_step=0.1 * length
            )
            peak = max([peak, s.y[0, -1], *(y[0] for y in s.y_events[1])])
            if len(s.t_events[2]):
                return 2, 2.0
            t = s.t[-1]
            q, v = s.y[:, -1]
            if s.status == 1:
                q, v, side = 0.0, -c_v * v, -side
                if v <= 1e-3 * p * alpha:
                    resting, v = True, 0.0
                # past the pulse with too little energy for the barrier: one more swing, known by its energy, then decay
                if acceleration is parts[-1][2] and 0.5 * v * v < p * p * (1.0 - np.cos(alpha)):
                    swing = alpha - np.arccos(np.cos(alpha) + 0.5 * v * v / (p * p))
                    return 1, max(peak, swing) / alpha
    return int(moved), peak / alpha


def compare(count: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Ours and DOP853's peaks over alpha with their outcomes, and which pulses are on the edge.

    Blocks of .2 to 4 m height and slenderness 1:2 to 1:8, amplitudes from 0.9 to 4 times uplift, lengths from 0.3 to 6 / p.
    """
    rng = np.random.default_rng(seed)
    ours, theirs, edge = np.zeros((count, 2)), np.zeros((count, 2)), np.zeros(count, bool)
    for k in range(count):
        height = 0.2 * 20.0 ** rng.uniform()
        model = BlockModel(make_block(height / rng.uniform(2.0, 8.0), height))
        p, alpha, c_v = float(model.frequency[0]), float(model.alpha[0]), float(model.restitution[0])
        shape = SHAPES[rng.integers(len(SHAPES))]
        amplitude = rng.choice([-1.0, 1.0]) * GRAVITY * np.tan(alpha) * (0.9 * 4.4 ** rng.uniform())
        length = 0.3 * 20.0 ** rng.uniform() / p
        settle = 60.0 / p
        motion = ground(shape, amplitude, length)
        end = {"step": 3.0, "half-sine": 0.5, "train": 3.0}.get(shape, 1.0) * length + settle
        found = rocking.ensemble([model.body], [motion], [0] * 3, [0] * 3, [1.0, 1.0 + NUDGE, 1.0 - NUDGE], end)
        outcome, peak = by_dop853(p, alpha, c_v, shape, amplitude, length, settle)
        ours[k] = min(found.peak_ratio[0], 2.0), found.outcome[0]
        theirs[k] = peak, outcome
        edge[k] = len(set(found.outcome)) > 1 or np.ptp(np.minimum(found.peak_ratio, 2.0)) > 1e-3
    return ours, theirs, edge, np.abs(ours[:, 0] - np.minimum(theirs[:, 0], 2.0))


def check(count: int, seed: int) -> None:
    ours, theirs, edge, difference = compare(count, seed)
    same = ours[:, 1] == theirs[:, 1]
    shares = [int((theirs[:, 1] == outcome).sum()) for outcome in range(3)]
    print(
        f"{count} pulses: {shares[0]} at rest, {shares[1]} rock, {shares[2]} down by DOP853; {int((~same).sum())} other outcomes, "
        f"{int(edge.sum())} on the edge; greatest difference of the peak {difference[~edge].max():.1e} alpha"
    )
    trial = Trial("random_pulses", "random pulses on free blocks whose outcome or peak is not that of DOP853")
    trial.tried = count
    trial.notes.append(
        f"{shares[0]} at rest, {shares[1]} rock, {shares[2]} down; greatest difference of the peak {difference[~edge].max():.0e} alpha; "
        f"{int(edge.sum())} on the edge, where a millionth of the amplitude decides"
    )
    for k in np.flatnonzero(~edge & ~(same & (difference < 1e-6))):
        trial.fail(f"pulse {k}: ours {ours[k]}, DOP853 {theirs[k]}")
    trial.close(count, keep=count >= 1000)
    assert edge.mean() < 0.02
    # The statistics that such runs are made for: the distributions of the peak, by their quantiles.
    one, other = (np.sort(np.minimum(x[~edge, 0], 2.0)) for x in (ours, theirs))
    assert np.abs(one - other).max() < 1e-6


def test_twenty_pulses() -> None:
    check(20, 3)


@pytest.mark.verify
def test_a_thousand_pulses() -> None:
    """Outcomes all equal, and so the statistics."""
    check(1000, 1)
