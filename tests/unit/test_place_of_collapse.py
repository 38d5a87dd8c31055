"""Where figures of rotation ratios draw collapse."""

import numpy as np

from extrados.show.statistics import FALLEN, place_of_collapse


def test_recoveries_from_past_the_critical_rotation_lie_on_the_side_of_recovery() -> None:
    """A block may return from up to twice its critical rotation (docs/rocking.md)."""
    for most in (0.4, 1.0, 1.1, 1.5, 1.99):
        assert place_of_collapse(np.array([0.1, most])) > max(most, 1.0)
    assert place_of_collapse(np.zeros(0)) == FALLEN
