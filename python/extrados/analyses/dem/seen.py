"""What is read off a run of blocks in the plane, and how it ends."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.dem import measures
from extrados.analyses.dem.model import Model
from extrados.core import dem
from extrados.results.dem import CLOSED


@dataclass(frozen=True)
class Seen:
    """What is read off a run: openings and slip of the joints (time, joint) [m] and what these do (results.dem), at which a block
    has slid off its footing, rotations of the blocks (time, block) [rad], displacements and losses of height [m] and rotations
    [rad] of the bodies (time, body), and how far joints that touch slide."""

    model: Model
    run: dem.Run
    gap_p: np.ndarray
    gap_q: np.ndarray
    slip: np.ndarray
    state: np.ndarray
    off: np.ndarray
    rotation: np.ndarray
    moved: tuple[np.ndarray, np.ndarray, np.ndarray]
    sliding: measures.Slip

    @classmethod
    def of(cls, model: Model, run: dem.Run, floor: bool) -> "Seen":
        """floor: blocks slide on a level floor, not off their footings."""
        gap_p, gap_q, slip = measures.openings(model, run)
        state = measures.hinges(model, gap_p, gap_q, slip)
        a, body = model.assembly, model.rigid.body_of_block
        off = np.zeros(state.shape, dtype=bool) if floor else measures.off_footing(a.a, a.b, state, slip, a.length)
        return cls(
            model,
            run,
            gap_p,
            gap_q,
            slip,
            state,
            off,
            -(run.place[:, body, 2] - run.settled[body, 2]),
            measures.movements(model, run),
            measures.Slip.of(state, slip, a.length),
        )

    @property
    def farthest(self) -> float:
        """Greatest displacement of any block at any time [m]."""
        return float(self.moved[0].max(initial=0.0))

    @property
    def slides(self) -> bool:
        """Whether some joint slid."""
        return self.sliding.ratio > measures.SLIDES

    @property
    def off_footing(self) -> list[int]:
        """Numbers of the blocks that slid off their footings."""
        return measures.blocks_off(self.model.assembly.a, self.model.assembly.b, self.off)

    def fate(self, collapse: measures.Collapse) -> measures.Fate:
        """How the run ends. A block that tips over the end of its footing has slid, and does not rock on its joint."""
        unsupported = {int(self.model.rigid.body_of_block[i]) for i in self.off_footing}
        rocks = bool(((self.state != CLOSED) & ~self.off).any())
        return measures.fate(self.run, collapse, *self.moved, unsupported, rocks, self.slides)
