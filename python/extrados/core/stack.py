"""Two stacked blocks that rock, in the core (fortran/rocking/stack)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import long_call, real
from extrados.core.errors import check, status_code
from extrados.core.ground import Ground, MotionSet
from extrados.core.rocking import EVENTS, OUTCOMES, Body, Outcome, output_times


@dataclass(frozen=True)
class Stack:
    """Masses [kg], inertias about the centres [kg m^2] and heights of the centres above the feet [m] of the lower and the
    upper block; half width of the lower foot, height of the lower block, half width of the contact between them [m]."""

    mass: tuple[float, float]
    inertia: tuple[float, float]
    centre: tuple[float, float]
    half_foot: float
    height: float
    half_contact: float

    @property
    def numbers(self) -> np.ndarray:
        """The flat list (9,) of the core, SI."""
        rows = [v for pair in zip(self.mass, self.inertia, self.centre, strict=True) for v in pair]
        return np.array([*rows, self.half_foot, self.height, self.half_contact])

    @classmethod
    def of(cls, body: Body) -> "Stack":
        """The blocks of which `stack_body` made a body."""
        a, b, c, d, e, f, foot, height, contact = (float(x) for x in body.parameters[:9])
        return cls((a, d), (b, e), (c, f), foot, height, contact)


#: Kind of bodies of two blocks
KIND = lists.number("rocking_body", "stack")


def stack_body(stack: Stack, critical: tuple[float, float], friction: tuple[float, float]) -> Body:
    """The blocks for ensembles. critical: rotations of unstable equilibrium of both as one and of the upper block alone [rad]; friction of
    the joint on the ground and of the joint between, infinite where they do not slide. A member starts with both turned as one. A half
    cycle begins with each uplift from rest and with each instant of impact; `joints` numbers the ground 0, the joint between 1.
    """
    if not (np.isfinite(critical).all() and min(critical) > 0.0):
        raise ValueError(f"critical rotations are {critical}, expected two values above zero")
    return Body(KIND, np.concatenate([stack.numbers, critical, np.minimum(friction, np.finfo(float).max)]))


@dataclass(frozen=True)
class StackResponse:
    """A response: at `time` (points) [s] rotation (points, 2) of the lower and the upper block, positive to +x [rad], their
    rates, ground and vertical acceleration [m/s^2], kinetic and potential energy and the ledger, work of the ground less
    loss at impacts [J]; state (points, 2) of the contacts on the ground and between, 0 shut, 1 and -1 open about the right
    and the left edge; force (points, 2, 2) on the lower block from the ground and on the upper from the lower, x, y [N].
    half_cycles: one for each uplift from rest and for each instant of impact, as in ensembles.
    events: (kind, time [s], contact), 1 on the ground, 2 between.
    """

    outcome: Outcome
    half_cycles: int
    impacts: tuple[int, int]
    peak: tuple[float, float]
    stop_time: float
    steps: int
    settled: bool
    time: np.ndarray
    rotation: np.ndarray
    rate: np.ndarray
    ground: np.ndarray
    vertical: np.ndarray
    kinetic: np.ndarray
    potential: np.ndarray
    ledger: np.ndarray
    state: np.ndarray
    force: np.ndarray
    events: list[tuple[str, float, int]]
    events_found: int
    work: float
    loss: float
    interrupted: bool = False


def stack_history(
    stack: Stack,
    ground: Ground,
    end_time: float,
    output_step: float,
    *,
    scale: float = 1.0,
    tolerance: float = 1e-8,
    start: npt.ArrayLike = (0.0, 0.0, 0.0, 0.0),
    room: int = 20000,
) -> StackResponse:
    """Rock the stack under `ground` times `scale` until collapse or `end_time` [s]; start (4,): rotations [rad]
    of the lower and the upper block, then their rates [rad/s]; output_step [s]; room: most events that are kept."""
    if not (0.0 < end_time < np.inf and 0.0 < output_step < np.inf and 0.0 < tolerance < 1.0 and np.isfinite(scale)):
        raise ValueError("end time, output step and tolerance must be positive, and the scale must be a number")
    if not 1 <= room <= 10**7:
        raise ValueError(f"number of saved events is {room}, expected 1 to 10,000,000")
    rows = int(_core.api_stack.rows())
    times = output_times(end_time, output_step, rows)
    with MotionSet([ground]) as motions:
        counts, measures, state, kinds, event, status = long_call(
            _core.api_stack.history,
            real("stack", stack.numbers, (9,)),
            motions.handle,
            1,
            np.array([scale, end_time, tolerance], dtype=float),
            real("start", start, (4,)),
            times,
            rows,
            int(room),
        )
    interrupted = status == status_code("cancelled")
    if not interrupted:
        check(status, "rocking of two blocks")
    outcome, low, high, steps, settled, points, events, half_cycles = (int(k) for k in counts)
    s = state[:, :points].T
    if not (np.isfinite(s).all() and np.isfinite(measures).all()):
        check(status_code("not_finite"), "rocking of two blocks")
    found = min(events, room)
    first, second, stop, work, loss = (float(x) for x in measures)
    return StackResponse(
        OUTCOMES[outcome],
        half_cycles,
        (low, high),
        (first, second),
        stop,
        steps,
        bool(settled),
        times[:points],
        s[:, 0:2],
        s[:, 2:4],
        s[:, 4],
        s[:, 5],
        s[:, 6],
        s[:, 7],
        s[:, 8],
        s[:, 9:11].astype(int),
        s[:, 11:15].reshape(-1, 2, 2),
        [(EVENTS[int(k)], float(t), int(c)) for k, (t, c) in zip(kinds[:found], event.T[:found], strict=True)],
        events,
        work,
        loss,
        interrupted,
    )


def stack_impact(
    stack: Stack, pivots: npt.ArrayLike, rotation: npt.ArrayLike, rate: npt.ArrayLike, closing: npt.ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Pivots (2) and rates (2) [rad/s] after contacts close without rebound.

    pivots (2): 1, -1, or 0 shut, on the ground and between; rotation (2) [rad] and rate (2) [rad/s] of both blocks;
    closing (2): 1 where the contact closes.
    """
    after, rates, status = _core.api_stack.impact(
        real("stack", stack.numbers, (9,)),
        np.asarray(pivots, dtype=np.int32),
        real("rotation", rotation, (2,)),
        real("rate", rate, (2,)),
        np.asarray(closing, dtype=np.int32),
    )
    check(status, "impact of two blocks")
    return after, rates
