"""Collapse of a plane section at the end of a load path of elastic joints."""

import numpy as np

from extrados.limit.errors import NoAnswer
from extrados.limit.least_load import rigid_motion
from extrados.limit.load_path import PATIENT, LoadPath
from extrados.limit.programme import LimitAnalysis
from extrados.limit.states import Mechanism, State


def collapse_along_path(limit: LimitAnalysis, direction: int, ratio: float, effort: int = PATIENT) -> tuple[State, Mechanism]:
    """State and mechanism under a push to +x (1) or -x (-1) of joints whose shear stiffness is `ratio` of the normal one;
    NoAnswer where the path does not lead to a collapse."""
    if limit.strength is not None:
        raise NoAnswer("load paths do not include crushing")
    points = limit.contact_points(direction)
    end = rigid_motion(points, LoadPath(points, ratio, effort).follow())
    corners = np.column_stack([end.force[0::2, 0], end.force[1::2, 0], end.force[0::2, 1] + end.force[1::2, 1]])
    rate = (points.rates @ end.motion).reshape(-1, 2)
    motion = np.column_stack([rate[0::2, 0], rate[1::2, 0], rate[0::2, 1]])
    taken = -float((corners * motion).sum())
    return limit.read_collapse(direction * end.gamma, corners, end.share, end.motion.reshape(-1, 3), motion, taken)
