"""Outcomes of limit analysis that are no capacity, apart from its solvers: these take a while to load."""

import numpy as np


class NoEquilibrium(ValueError):
    """No admissible thrust line exists for the given loads."""


class Immovable(NoEquilibrium):
    """No load of the given kind causes collapse: the joints hold the structure from all sides."""


class NoAnswer(RuntimeError):
    """The solver gave up; never a statement about the structure."""


class CannotStand(Exception):
    """A certificate proves collapse under self-weight; the text says where equilibrium fails, and the proof.

    motion: the collapse motion of the certificate, velocities (blocks, 3) of the centroids in x, y and rotation, of
    arbitrary scale; None where another proof was found. neglects: joint properties that the proof sets to zero, and
    "restraints" and "passive pressure" where it neglects those. other_loads: constant loads besides the own weight, in words.
    """

    def __init__(
        self, text: str, motion: np.ndarray | None = None, neglects: tuple[str, ...] = ("cohesion", "tension"), other_loads: str = ""
    ):
        super().__init__(text)
        self.motion, self.neglects, self.other_loads = motion, neglects, other_loads


def without_restraints(proof: CannotStand) -> CannotStand:
    """The proof, of a view of the building without what holds it besides weight and joints."""
    return CannotStand(str(proof), proof.motion, (*proof.neglects, "restraints", "passive pressure"), proof.other_loads)
