"""Motions written for other programs: PEER AT2 and two columns."""

import numpy as np

from extrados.schema.constants import GRAVITY


def at2(name: str, acceleration: np.ndarray, step: float) -> bytes:
    """PEER AT2 text of an acceleration (points) [m/s^2]."""
    head = [
        "PEER NGA STRONG MOTION DATABASE RECORD FORMAT, written by extrados",
        _plain(name),
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {len(acceleration):6d}, DT= {step:.9g} SEC",
    ]
    values = [f"{value:15.7E}" for value in acceleration / GRAVITY]
    rows = ["".join(values[k : k + 5]) for k in range(0, len(values), 5)]
    return ("\n".join([*head, *rows]) + "\n").encode("ascii")


def columns(name: str, acceleration: np.ndarray, step: float) -> bytes:
    """Time [s] and acceleration [m/s^2] in columns."""
    head = [f"# {_plain(name)}", "time (s),acceleration (m/s^2)"]
    return ("\n".join([*head, *(f"{k * step:.9g},{a:.9g}" for k, a in enumerate(acceleration))]) + "\n").encode("ascii")


def _plain(name: str) -> str:
    return name.encode("ascii", "replace").decode().replace("\n", " ")[:100]
