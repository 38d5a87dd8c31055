"""Blocks of a scanned wall or barrel vault: the body between its fitted faces, cut by courses and by heads in running bond."""

import itertools
from collections.abc import Sequence

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.clouds import BarrelFit, WallFit
from extrados.model.geometry.solids.assembly import MOST_SOLIDS, Stone
from extrados.model.geometry.solids.polyhedra import hull

Seat = tuple[int, np.ndarray]


def blocks_of_wall(fit: WallFit, beds: Sequence[float] | int, length: float | None, density: float) -> list[Stone]:
    """Blocks [kg/m^3] of a wall between bed joints: their heights above the foot [m], or the number of equal courses. length [m]: of a
    block along the wall; None for whole courses. BadGeometry above MOST_SOLIDS blocks."""
    _refuse_many(fit.s, length, beds if isinstance(beds, int) else len(beds) + 1)
    low, high = fit.z
    levels = np.linspace(low, high, beds + 1) if isinstance(beds, int) else np.array([low, *(low + np.array(beds)), high])
    stones = []
    for course, (z0, z1) in enumerate(itertools.pairwise(levels.tolist())):
        for k, (s0, s1) in enumerate(itertools.pairwise(_heads(*fit.s, length, course))):
            corners = [
                fit.origin + s * fit.along + float(face @ np.array([1.0, s, z])) * fit.across + np.array([0.0, 0.0, z])
                for s, z, face in itertools.product((s0, s1), (z0, z1), (fit.back, fit.front))
            ]
            stones.append(Stone(f"block {k + 1} of course {course + 1}", [hull(np.array(corners))], density))
    return stones


def blocks_of_barrel(fit: BarrelFit, courses: int, length: float | None, density: float) -> tuple[list[Stone], list[Seat]]:
    """Voussoirs [kg/m^3] of a barrel in equal courses between radii of its intrados, and their faces on the springings. length [m]: of a
    voussoir along the axis; None for whole courses. BadGeometry above MOST_SOLIDS blocks."""
    _refuse_many(fit.t, length, courses)
    rays = np.linspace(*fit.angle, courses + 1)
    ways = np.column_stack([np.cos(rays), np.sin(rays)])
    inner = fit.inner[:2] + fit.inner[2] * ways
    arm = fit.outer[:2] - fit.inner[:2]
    along = ways @ arm
    outer = fit.inner[:2] + (along + np.sqrt(fit.outer[2] ** 2 - arm @ arm + along**2))[:, None] * ways

    def places(ray: int, t0: float, t1: float) -> np.ndarray:
        """The four corners of a joint at a ray, in a ring."""
        flat = [(inner[ray], t0), (outer[ray], t0), (outer[ray], t1), (inner[ray], t1)]
        return np.array([fit.origin + p[0] * fit.along + t * fit.axis + np.array([0.0, 0.0, p[1]]) for p, t in flat])

    stones: list[Stone] = []
    seats: list[Seat] = []
    for course in range(courses):
        for k, (t0, t1) in enumerate(itertools.pairwise(_heads(*fit.t, length, course))):
            ends = [places(course, t0, t1), places(course + 1, t0, t1)]
            middle = np.concatenate(ends).mean(axis=0)
            for ring in ends[:1] * (course == 0) + ends[1:] * (course == courses - 1):
                into = np.cross(ring[1] - ring[0], ring[2] - ring[1]) @ (middle - ring[0]) > 0.0
                seats.append((len(stones), ring if into else ring[::-1]))
            stones.append(Stone(f"voussoir {k + 1} of course {course + 1}", [hull(np.concatenate(ends))], density))
    return stones, seats


def _refuse_many(ends: tuple[float, float], length: float | None, courses: int) -> None:
    """BadGeometry where courses between ends [m] of blocks of a length [m] are more than MOST_SOLIDS blocks; none is made for it."""
    count = courses if length is None else courses * max(1.0, (ends[1] - ends[0]) / length)
    if count > MOST_SOLIDS:
        raise BadGeometry(
            f"{courses} courses of {ends[1] - ends[0]:.3g} m would have about {count:.3g} blocks, and at most {MOST_SOLIDS} are allowed. "
            "Increase `block_length`, or give fewer courses",
            ("structure", "scan", "block_length"),
        )


def _heads(low: float, high: float, length: float | None, course: int) -> list[float]:
    """Places of the head joints of a course and both of its ends [m], in running bond."""
    count = 1 if length is None else max(1, round((high - low) / length))
    cuts = np.linspace(low, high, count + 1)
    if count > 1 and course % 2:
        cuts = np.concatenate([[low], 0.5 * (cuts[1:] + cuts[:-1]), [high]])
    found: list[float] = cuts.tolist()
    return found
