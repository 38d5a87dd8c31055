"""Pairs of structures and motions as one job of the sweep layer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from extrados.analyses.rocking.conditions import rows_of
from extrados.core import rocking as core_rocking
from extrados.core.errors import Cancelled, CoreError, status_code
from extrados.core.rocking import Body, Ground


@dataclass(frozen=True)
class RunsJob:
    """Member k: body[k] under motion[k] times scale[k], from start[k] [rad] until end[k] [s].

    A member that fails has outcome -1 and its reason; with `strict` it stops the whole sweep. astray: share of the energy after an
    impact that the mechanism does not hold, see rocking.conditions.
    """

    bodies: list[Body]
    grounds: list[Ground]
    body: np.ndarray
    motion: np.ndarray
    scale: np.ndarray
    end: np.ndarray
    start: np.ndarray
    tolerance: float = 1e-8
    strict: bool = True
    astray: float = 0.0

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        part = slice(first, first + count)
        used, motion = np.unique(self.motion[part], return_inverse=True)
        bodies, body = np.unique(self.body[part], return_inverse=True)
        e = core_rocking.ensemble(
            [self.bodies[b] for b in bodies],
            [self.grounds[m] for m in used],
            body,
            motion,
            self.scale[part],
            self.end[part],
            start_rotation=self.start[part],
            tolerance=self.tolerance,
            threads=threads,
        )
        if e.interrupted:
            raise Cancelled(status_code("cancelled"), "interrupted")
        if e.failed and self.strict:
            raise CoreError(0, next(iter(e.failed.values())))
        reason = np.full(count, "", dtype=object)
        reason[list(e.failed)] = list(e.failed.values())
        return {
            "outcome": e.outcome.astype(np.int8),
            "half_cycles": e.half_cycles,
            "peak": e.peak,
            "peak_ratio": e.peak_ratio,
            "stop_time": e.stop_time,
            "reason": reason.astype(str),
            **rows_of(e.joints, e.half_cycles, self.astray),
        }


def runs_job(
    bodies: list[Body],
    grounds: list[Ground],
    body: ArrayLike,
    motion: ArrayLike,
    scale: ArrayLike,
    end: ArrayLike,
    start: ArrayLike = 0.0,
    *,
    tolerance: float = 1e-8,
    strict: bool = True,
    astray: float = 0.0,
) -> RunsJob:
    """The job of these runs; numbers are spread over all members."""
    n = max(np.size(v) for v in (body, motion, scale, end, start))

    def spread(value: ArrayLike, kind: type) -> np.ndarray:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=kind), n))

    return RunsJob(
        bodies,
        grounds,
        spread(body, int),
        spread(motion, int),
        spread(scale, float),
        spread(end, float),
        spread(start, float),
        tolerance,
        strict,
        astray,
    )
