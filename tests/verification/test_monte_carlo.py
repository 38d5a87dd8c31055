"""Statistics of a block that rocks or slides beside a Monte Carlo of its own: draws, integrator and friction written apart from the core."""

import numpy as np
import pytest
from scipy.stats import norm

import extrados
from extrados.decks.reader import make_deck
from extrados.motions.from_deck import generated_set

pytestmark = pytest.mark.verify
G = 9.80665
MOTION = {"kind": "generated", "mmi": 8, "duration": 6.0, "seed": 11}
WIDTH, HEIGHT, FRICTION = 0.5, 2.0, 0.35
SPREAD = {"width": 0.08, "friction": 0.3, "restitution": 0.05}
LEVELS = [0.3, 0.5, 0.8, 1.2]
MOTIONS, SUBSTEPS = 600, 5


def motions() -> tuple[np.ndarray, float]:
    """Accelerations (motions, points) [m/s^2] of peak 1, and their step [s]."""
    deck = make_deck({"structure": {"kind": "block", "width": WIDTH, "height": HEIGHT}, "motion": MOTION, "analysis": {"kind": "rocking"}})
    made = generated_set(deck.motion, deck.folder)
    rows = made.batch(0, MOTIONS, 1)
    return rows / np.abs(rows).max(axis=1)[:, None], made.step


def rock(ground: np.ndarray, step: float, width: np.ndarray, friction: np.ndarray, factor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whether each block (n) collapses under its ground motion (n, points) [m/s^2], and whether its base slides before that.

    Runge-Kutta steps of a fifth of the sampling; an impact lies where the chord of the rotation is zero.
    """
    alpha, radius = np.arctan2(width, HEIGHT), 0.5 * np.hypot(width, HEIGHT)
    p2, c_v = 3.0 * G / (4.0 * radius), np.minimum(1.0, factor * (1.0 - 1.5 * np.sin(alpha) ** 2))
    q, v, side = np.zeros((3, len(width)))
    fell, slid = np.zeros((2, len(width)), dtype=bool)
    quiet = np.zeros((len(width), int(6.0 / step)))
    whole = np.hstack([ground, quiet])
    h = step / SUBSTEPS
    for k in range(whole.shape[1] - 1):
        for j in range(SUBSTEPS):
            a0, a1 = (whole[:, k] + (whole[:, k + 1] - whole[:, k]) * (j + s) / SUBSTEPS for s in (0, 1))
            rest = side == 0.0
            slid |= rest & (np.abs(a1) > friction * G) & ~fell
            start = rest & (np.abs(a1) > G * np.tan(alpha))
            side = np.where(start, -np.sign(a1), side)
            moves = (side != 0.0) & ~fell

            def pull(x, a, side=side):
                return -p2 * (np.sin(alpha - x) + side * a / G * np.cos(alpha - x))

            middle = 0.5 * (a0 + a1)
            k1 = pull(q, a0)
            k2 = pull(q + 0.5 * h * v, middle)
            k3 = pull(q + 0.5 * h * v + 0.25 * h * h * k1, middle)
            k4 = pull(q + h * v + 0.5 * h * h * k2, a1)
            new_q = q + h * v + h * h / 6.0 * (k1 + k2 + k3)
            new_v = v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
            struck = moves & (new_q < 0.0) & ~start
            share = np.where(struck, q / np.where(struck, q - new_q, 1.0), 1.0)
            after = c_v * np.abs(v + share * (new_v - v))
            still = struck & (after < 1e-3 * np.sqrt(p2) * alpha)
            q = np.where(struck, np.where(still, 0.0, (1.0 - share) * h * after), np.where(moves, np.maximum(new_q, 0.0), q))
            v = np.where(struck, np.where(still, 0.0, after), np.where(moves, new_v, v))
            side = np.where(still, 0.0, np.where(struck, -side, side))
            lean, angular = alpha - q, pull(q, a1, side)
            normal = G + radius * (np.sin(lean) * angular - np.cos(lean) * v**2)
            tangent = side * a1 + radius * (np.cos(lean) * angular + np.sin(lean) * v**2)
            slid |= (side != 0.0) & ~fell & (q < alpha) & ((np.abs(tangent) > friction * normal) | (normal <= 0.0))
            fell |= q > 2.0 * alpha
    return fell, slid


def test_probabilities_are_those_of_a_monte_carlo_of_its_own() -> None:
    """Collapse without sliding, and the share that slides, at four levels: within the sampling error of both."""
    run = extrados.run(
        {
            "structure": {"kind": "block", "width": WIDTH, "height": HEIGHT},
            "joints": {"friction": FRICTION},
            "motion": MOTION,
            "analysis": {"kind": "fragility", "count": MOTIONS, "levels": LEVELS, "uncertain": SPREAD, "bootstrap": 0, "seed": 4},
        }
    )["fragility"]
    ground, step = motions()
    random = np.random.default_rng(71)
    spread = {name: np.sqrt(np.log1p(cov**2)) for name, cov in SPREAD.items()}
    factor = {name: np.exp(s * random.standard_normal(MOTIONS) - 0.5 * s**2) for name, s in spread.items()}
    bound = norm.ppf(1.0 - 0.01 / (4.0 * len(LEVELS)))  # one in a hundred of all rows may lie beyond
    for k, level in enumerate(LEVELS):
        fell, slid = rock(level * G * ground, step, WIDTH * factor["width"], FRICTION * factor["friction"], factor["restitution"])
        for name, own, found in (("collapse", fell.mean(), run.collapse_probability[k]), ("sliding", slid.mean(), run.sliding_share[k])):
            both = 0.5 * (own + found)
            error = np.sqrt(2.0 * max(both * (1.0 - both), 1.0 / MOTIONS) / MOTIONS)
            print(f"{level:g} g {name}: {found:.3f}, Monte Carlo {own:.3f}, {abs(found - own) / error:.1f} standard errors")
            assert abs(found - own) < bound * error
    assert max(run.collapse_probability) > 0.3 and 0.05 < min(run.sliding_share) < 0.9
