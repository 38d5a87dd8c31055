"""The rocking frame as the core sees it: one larger block (Makris and Vassiliou 2013)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core import mechanism as core_mechanism
from extrados.core.mechanism import Table
from extrados.core.rocking import Body, block_body
from extrados.limit.linkage import Linkage
from extrados.model.structures.frame import FrameAssembly
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.mechanism import MechanismModel


@dataclass(frozen=True)
class FrameModel(MechanismModel):
    """Equal columns that rock together under a lintel that stays level.

    With m_c, I_c of a column, R and alpha of its toe, and m_b of the lintel, whose points move by twice the way of the
    middles of the columns, the equation is that of a block of the same alpha,

        (n (I_c + m_c R^2) + 4 m_b R^2) q'' + (n m_c + 2 m_b) R (g sin(alpha - q) + s a_h cos(alpha - q)) = 0,

    of rectangular columns p^2 (1 + 2 gamma)/(1 + 3 gamma) instead of p^2 = 3 g / (4 R), gamma = m_b/(n m_c): a block larger by
    (1 + 3 gamma)/(1 + 2 gamma). Rules of impact that are words take impulses that do no work on the frame as it rocks on,
    (1 - 3/2 sin^2 alpha + 3 gamma cos 2 alpha)/(1 + 3 gamma) of rectangular columns. Nothing slides.
    """

    assembly: FrameAssembly
    rule: str | float = "inelastic"

    @cached_property
    def linkages(self) -> tuple[Linkage, Linkage]:
        """Columns on their outer toes, the lintel on their inner corners."""
        a, n = self.assembly, self.assembly.columns
        made = []
        for side in (1, -1):
            foot, head = (a.q, a.p) if side > 0 else (a.p, a.q)
            point = np.concatenate([foot[:n], head[n:]])
            joined = np.array([[k + 1, 0] for k in range(n)] + [[n + 1, k + 1] for k in range(n)])
            # both equations of all feet and of the first head, and the height of the last: 3 (n + 1) - 1 with the turn
            # of the other columns from their heads along x
            rows = [(h + 1, axis) for h in range(n) for axis in (1, 2)] + [(n + 1, 1), (n + 1, 2), (2 * n, 2)]
            rows += [(n + 1 + k, 1) for k in range(1, n)]
            made.append(
                Linkage(
                    side,
                    np.arange(n + 1) + 1,
                    a.mass,
                    a.centroid,
                    a.inertia,
                    np.arange(2 * n),
                    joined,
                    point,
                    np.array(rows[: 3 * (n + 1) - 1]),
                    1,
                    -side,
                )
            )
        return made[0], made[1]

    @cached_property
    def tables(self) -> tuple[Table, Table]:
        right, left = (core_mechanism.table(one) for one in self.linkages)
        return right, left

    @property
    def uplift(self) -> tuple[float, float]:
        """That of one column, whatever the lintel weighs [g]."""
        return float(np.tan(self.assembly.alpha)), float(np.tan(self.assembly.alpha))

    @property
    def frequency(self) -> float:
        """p of the frame [rad/s]."""
        return 1.0 / self.time_unit

    @property
    def time_unit(self) -> float:
        """1/p [s]."""
        a = self.assembly
        moment = (a.mass[:-1].sum() + 2.0 * a.mass[-1]) * a.radius * GRAVITY
        return float(np.sqrt((a.inertia[:-1].sum() + a.mass[:-1].sum() * a.radius**2 + 4.0 * a.mass[-1] * a.radius**2) / moment))

    @property
    def energy_kept(self) -> None:
        """Not asked for: all rules that are words are one."""
        return None

    @cached_property
    def restitution(self) -> tuple[float, float]:
        if isinstance(self.rule, str):
            return max(0.0, self.projections[0]), max(0.0, self.projections[1])
        return float(self.rule), float(self.rule)

    @cached_property
    def warnings(self) -> list[str]:
        if min(self.projections) < 0.0 and isinstance(self.rule, str):
            return ["the columns are too stocky to rock after an impact: the frame comes to rest at the first impact"]
        return []

    @cached_property
    def body(self) -> Body:
        return self.rebounding(1.0)

    def rebounding(self, factor: float) -> Body:
        a, (right, left) = self.assembly, self.restitution
        columns, lintel = float(a.mass[:-1].sum()), float(a.mass[-1])
        inertia = float(a.inertia[:-1].sum()) + 2.0 * lintel * a.radius**2
        half = 0.5 * a.width
        return block_body(columns + 2.0 * lintel, inertia, 0.5 * a.height, half, half, (min(1.0, factor * right), min(1.0, factor * left)))
