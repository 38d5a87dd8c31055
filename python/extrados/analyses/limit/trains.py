"""Trains of axles and even loads: those of EN 1991-2, and what a deck gives."""

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.tables import MovingLoad
from extrados.views.building import Building

KN = 1e3
FOR_EVER = 1e6  # m: even loads without an end


@dataclass(frozen=True)
class Train:
    """Loads that move together; places behind the first axle [m].

    axles (n) with their forces (n) [N]; even loads (k, 3): from, to [m], load [N/m]. known: false where only the
    shares of a load are given, which then add up to one.
    """

    name: str
    axles: np.ndarray
    forces: np.ndarray
    even: np.ndarray
    known: bool

    @property
    def marks(self) -> np.ndarray:
        """Axles, and ends of even loads where they have one, from the front to the rear [m]. A load without a front that ends before
        the first axle has none: it is on all of the way then, as nearly with the first axle at its end."""
        front = min(self.axles, default=-np.inf)
        ends = [end for start, stop, _ in self.even for end in (start, stop) if start > -FOR_EVER or stop > front]
        found = np.unique([*self.axles, *ends])
        return found[np.abs(found) < FOR_EVER]

    def within(self, low: float, high: float, place: float) -> float:
        """Load between two places when the first axle, heading to +x, is at a place [m]: [N], a share where no load is given."""
        at = place - self.axles
        ends = np.clip(place - self.even[:, :2], low, high)
        return float(self.forces[(low <= at) & (at <= high)].sum() + self.even[:, 2] @ (ends[:, 0] - ends[:, 1]))


def train_of(options: MovingLoad, depth: float) -> Train:
    """The train of a deck on a structure of a depth [m], without partial factors; Refused where it does not fit."""
    none = np.empty((0, 3))
    if options.train is None:
        even = np.array(
            [
                (-FOR_EVER if u.start is None else u.start, FOR_EVER if u.stop is None else u.stop, options.alpha * u.load)
                for u in options.uniform
            ]
        ).reshape(-1, 3)
        axles = np.array(options.axles, dtype=float)
        if options.axle_loads is not None or options.uniform:
            loads = options.alpha * np.array(options.axle_loads or [], dtype=float)
            return Train("train", axles, loads, even, True)
        shares = np.array(options.shares or np.ones(len(axles)))
        shares = shares / shares.sum()
        if options.force is None:
            return Train("load", axles, shares, none, False)
        return Train("load", axles, options.alpha * options.force * shares, none, True)
    if options.train == "LM1":
        axle, even_load = _lm1(options.width or depth, options.lanes)
        axles, forces = np.array([0.0, 1.2]), np.full(2, axle)
        even = np.array([[-FOR_EVER, FOR_EVER, even_load]])
    else:
        axles, forces, even = _listed(options.train, options.gap)
    even = even * (1.0, 1.0, options.alpha)
    return Train(options.train, axles, options.alpha * forces, even, True)


@cache
def _library() -> dict[str, Any]:
    return tomllib.loads((Path(__file__).parent / "trains.toml").read_text(encoding="utf-8"))


def unverified(train: str | None) -> str:
    """The source of a train whose clause nobody has read; "" of any other."""
    listed = _library().get(train or "", {})
    return "" if listed.get("verified", True) else str(listed["source"])


def _listed(train: str, gap: float | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Axles [m], their forces [N] and even loads [m, m, N/m] of a train of the library."""
    listed = _library()[train]
    axles, forces = np.array(listed["axles"], dtype=float), KN * np.array(listed["axle_loads"], dtype=float)
    if gap is not None:
        k = listed["gap_after"]
        axles[k:] += gap - (axles[k] - axles[k - 1])
    even = np.array(listed.get("uniform", []), dtype=float).reshape(-1, 3)
    even[:, :2] = np.clip(even[:, :2], -FOR_EVER, FOR_EVER)
    return axles, forces, even * (1.0, 1.0, KN)


def _lm1(width: float, lanes: int | None) -> tuple[float, float]:
    """Weight of an axle of the tandem systems [N] and even load [N/m] of LM1 over a carriageway [m] (Tables 4.1, 4.2)."""
    most = 1 if width < 5.4 else 2 if width < 6.0 else int(width / 3.0)
    if lanes is not None and lanes > most:
        raise Refused(
            f"lanes: a carriageway with a width of {width:g} m has space for {most}, not {lanes} (EN 1991-2 Table 4.1)",
            ("analysis", "lanes"),
        )
    count = most if lanes is None else lanes
    lane = min(width, 0.5 * width if 5.4 <= width < 6.0 else 3.0)
    axle = sum((300.0, 200.0, 100.0)[:count])
    even = 9.0 * lane + 2.5 * (width - lane if lanes is None else (count - 1) * lane)
    return axle * KN, even * KN


def fitting_train(building: Building, options: MovingLoad) -> Train:
    """The train of a deck on its structure; Refused where it is wider."""
    depth, structure = building.blocks().depth, building.structure
    if options.width is not None and options.width > depth and structure is not None:
        raise Refused(f"width: {options.width:g} m exceeds the depth of the {structure.word}, {depth:g} m", ("analysis", "width"))
    return train_of(options, depth)
