"""Ensembles of rocking blocks as of Yim, Chopra and Penzien 1980 (EESD 8:565-587).

They let blocks rock under twenty simulated motions, white noise under an envelope of Jennings' shape. Their motions and
figures are not at hand; their findings are: one block under one motion follows no trend, neither with its size nor with
its slenderness nor with the strength of the motion; the probability of overturning grows with the strength of the motion
and with the slenderness, and falls with the size.
"""

import numpy as np
import pytest

import extrados

LEVELS = [0.3, 0.4, 0.5, 0.6, 0.8, 1.0]  # PGA [g]
HEIGHTS = (1.5, 3.0, 6.0)  # [m]
SLENDERNESS = (4.0, 5.0, 6.0)  # height over width
MOTIONS = 160
pytestmark = pytest.mark.verify  # the quick rows are those of cases/fragility/yim-chopra-penzien
#: Probabilities of this many motions may disagree by chance
CHANCE = 0.05


@pytest.fixture(scope="module")
def fell() -> np.ndarray:
    """Whether each block comes down: (slenderness, height, motion, level)."""
    motion = {"kind": "generated", "mmi": 8, "duration": 15.0, "envelope": "jennings", "lines": 60, "seed": 20}
    found = []
    for slender in SLENDERNESS:
        for height in HEIGHTS:
            run = extrados.run(
                {
                    "structure": {"kind": "block", "width": height / slender, "height": height},
                    "motion": motion,
                    "analysis": [{"kind": "fragility", "count": MOTIONS, "levels": LEVELS, "bootstrap": 0}],
                },
                threads=2,
            )
            found.append(np.array(run.array("fragility", "outcome")).reshape(MOTIONS, len(LEVELS)) == 2)
    return np.array(found).reshape(len(SLENDERNESS), len(HEIGHTS), MOTIONS, len(LEVELS))


def test_probabilities_follow_strength_slenderness_and_size(fell: np.ndarray) -> None:
    p = fell.mean(axis=2)
    for slender, rows in zip(SLENDERNESS, p, strict=True):
        for height, row in zip(HEIGHTS, rows, strict=True):
            print(f"H/B {slender:g}, H {height:g} m: " + "  ".join(f"{v:.2f}" for v in row))
    assert (np.diff(p, axis=2) > -CHANCE).all() and (p[:, :, -1] >= p[:, :, 0]).all()
    assert (np.diff(p, axis=0) > -CHANCE).all() and (p[2, :2] > p[0, :2] - 1e-9).all()
    assert (np.diff(p, axis=1) < CHANCE).all() and (p[:, 0, 3] > p[:, 2, 3] + 0.3).all()


def test_single_motions_follow_no_trend(fell: np.ndarray) -> None:
    """Among the first twenty motions each rule of thumb is broken by some block."""
    few = fell[:, :, :20]
    assert (few[:, :, :, :-1] & ~few[:, :, :, 1:]).any(), "a stronger motion leaves standing what a weaker one overturns"
    assert (few[:, 1:] & ~few[:, :-1]).any(), "a larger block falls where the smaller one stands"
    assert (few[:-1] & ~few[1:]).any(), "a stockier block falls where the slenderer one stands"
