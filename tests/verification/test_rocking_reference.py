"""Blocks under 200 random motions against SciPy's DOP853 at rtol 1e-10, restarted at every sample."""

import numpy as np
import pytest
from rocking_oracle import reference

from extrados.core import rocking
from extrados.core.rocking import Ground
from extrados.model.structures.block import make_block
from extrados.views.rockers.block import BlockModel
from trials import Trial

STEP, POINTS = 0.02, 301


def motions(count: int, seed: int) -> np.ndarray:
    """Fifteen sines of random phase under an arctangent window, peak accelerations from 0.15 to 0.6 g."""
    rng = np.random.default_rng(seed)
    t = STEP * np.arange(POINTS)
    window = (np.arctan((t - 0.5) / 0.1) - np.arctan((t - 5.0) / 0.1)) / np.pi
    lines = np.geomspace(0.4, 10.0, 15)
    raw = np.array([np.sin(2 * np.pi * np.outer(t, lines) + rng.uniform(0, 2 * np.pi, 15)).sum(axis=1) * window for _ in range(count)])
    return raw / np.abs(raw).max(axis=1, keepdims=True) * rng.uniform(0.15, 0.6, (count, 1)) * 9.80665


def compare(count: int, seed: int, width: float, height: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Difference of peak over alpha, whether the outcomes agree, and which runs are on the edge.

    On the edge: the outcome, or the peak by more than 1e-3, changes when the motion is scaled by 1 +- 1e-6.
    """
    m = BlockModel(make_block(width, height))
    alpha, p, c_v = float(m.alpha[0]), float(m.frequency[0]), float(m.restitution[0])
    samples, start, end = motions(count, seed), float(m.alpha[0]) / 32.0, STEP * (POINTS - 1) + 1.0
    grounds = [Ground(samples=row[None, :], step=STEP) for row in samples]

    def run(scale: float):
        return rocking.ensemble(
            [m.body], grounds, np.zeros(count, int), np.arange(count), scale, end, start_rotation=start, stop_when_safe=False, threads=2
        )

    ours, more, less = run(1.0), run(1.0 + 1e-6), run(1.0 - 1e-6)
    edge = np.zeros(count, bool)
    for other in (more, less):
        edge |= (other.outcome != ours.outcome) | (np.abs(other.peak_ratio - ours.peak_ratio) > 1e-3)
    found = [reference(p, alpha, c_v, row, STEP, start, end) for row in samples]
    peak, outcome = np.array([f[0] for f in found]), np.array([f[1] for f in found])
    # The start already rocks, which the reference counts as moved from the beginning.
    return np.abs(peak - np.minimum(ours.peak_ratio, 2.0)), outcome == ours.outcome, edge


def test_a_few_motions() -> None:
    difference, same, edge = compare(3, 11, 0.1, 0.4)
    assert same[~edge].all() and difference[~edge].max() < 1e-6


@pytest.mark.verify
@pytest.mark.parametrize(("width", "height", "seed"), [(0.1, 0.4, 1), (1.0, 4.0, 2)])
def test_two_hundred_motions(width: float, height: float, seed: int) -> None:
    """Half of the 200 on each of two sizes."""
    difference, same, edge = compare(100, seed, width, height)
    print(f"{width} x {height} m: greatest difference {difference[~edge].max():.1e}, {edge.sum()} of 100 on the edge of collapse")
    assert edge.sum() <= 10
    trial = Trial(
        f"random_motions_{seed}",
        f"random motions of a block of {width:g} x {height:g} m that end otherwise than by DOP853, or in another peak",
    )
    trial.tried = len(same)
    trial.notes.append(f"greatest difference of the peak {difference[~edge].max():.0e} alpha; {edge.sum()} on the edge of collapse")
    for k in np.flatnonzero(~edge & ~(same & (difference < 1e-6))):
        trial.fail(f"motion {k}: difference {difference[k]:.1e}")
    trial.close(100, keep=True)
