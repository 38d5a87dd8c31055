"""Where a joint lies, in words an engineer finds on a drawing: springing, haunch, crown, foot, bed joint."""

import numpy as np

from extrados.model.dimensions import with_article
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import arch_of

CROWN = 0.1  # of the span to either side of its middle
LEVEL = 0.7  # least vertical part of the normal of a bed joint


def place_of(assembly: Assembly, joint: int, point: np.ndarray) -> str:
    """The place of a joint, and on which side of it the point (2) [m] is: "left haunch of the nave, intrados"."""
    for name, joints in assembly.chains.items():
        if joint in joints and joint in (arch := arch_of(assembly, joints)):
            near_p = np.hypot(*(point - assembly.p[joint])) < np.hypot(*(point - assembly.q[joint]))
            return f"{_along(assembly, name, arch, arch.index(joint))}, {'intrados' if near_p else 'extrados'}"
    side = _side(assembly, joint, point)
    a, b = int(assembly.a[joint]), int(assembly.b[joint])
    if GROUND in (a, b):
        return f"foot of {assembly.block_names[max(a, b)]}, {side}"
    bed = abs(assembly.normal[joint, 1]) > LEVEL
    if bed:
        upper = a if assembly.centroid[a, 1] >= assembly.centroid[b, 1] else b
        return f"bed joint under {assembly.block_names[upper]}, {side}"
    left, right = (a, b) if assembly.centroid[a, 0] <= assembly.centroid[b, 0] else (b, a)
    return f"head joint between {assembly.block_names[left]} and {assembly.block_names[right]}, {side}"


def _along(assembly: Assembly, name: str, joints: list[int], k: int) -> str:
    """Where the k-th joint of an arch, counted from its springing, lies along it."""
    first, last = assembly.middle[[joints[0], joints[-1]], 0].tolist()
    span = last - first
    share = (float(assembly.middle[joints[k], 0]) - first) / span
    name = with_article(name)
    if k == 0 or k == len(joints) - 1:
        return f"{'left' if (k == 0) == (span > 0.0) else 'right'} springing of {name}"
    if abs(share - 0.5) <= CROWN:
        return f"crown of {name}"
    hand = "left" if (share < 0.5) == (span > 0.0) else "right"
    return f"{hand} haunch of {name} at {100.0 * min(share, 1.0 - share):.0f} % of the span"


def _side(assembly: Assembly, joint: int, point: np.ndarray) -> str:
    """Which end of a joint a point is nearer to: left or right, lower or upper."""
    p, q = assembly.p[joint], assembly.q[joint]
    level = abs(q[0] - p[0]) >= abs(q[1] - p[1])
    axis = 0 if level else 1
    first = point[axis] < 0.5 * (p[axis] + q[axis])
    return ("left edge" if first else "right edge") if level else ("lower edge" if first else "upper edge")
