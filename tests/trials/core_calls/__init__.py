"""Valid calls of the core's Python API. Each file holds those of a room of the core; `valid_calls` joins them."""

import numpy as np

from core_calls import arch, dem, frame, joints, mechanism, motion, rocking, shell, sla, small, two_coordinates
from core_calls.given import Calls
from extrados.model.structures.arch import make_arch


def valid_calls() -> Calls:
    """Functions with right arguments. Another order draws other numbers, and tries other wrong calls by the same seed."""
    rng = np.random.default_rng(3)
    stones = make_arch(10.0, 1.5, 157.5, 7)
    shaken = 3.0 * rng.normal(size=(2, 9))
    return [
        *sla.calls(),
        *frame.calls(),
        *shell.calls(),
        *joints.calls(),
        *mechanism.calls(stones, shaken),
        *two_coordinates.calls(rng),
        *arch.calls(stones, shaken),
        *dem.calls(),
        *rocking.calls(rng),
        *motion.calls(rng),
        *small.calls(rng),
    ]
