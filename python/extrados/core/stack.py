"""Two stacked blocks that rock, in the core (fortran/rocking/stack)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import real
from extrados.core.errors import check
from extrados.core.ground import Ground
from extrados.core.rocking import Body, Course
from extrados.core.two_coordinates import run_two


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


@dataclass(frozen=True, kw_only=True)
class StackResponse(Course):
    """A response: at the times of the course rotation (points, 2) of the lower and the upper block, positive to +x [rad], and their
    rates; state (points, 2) of the contacts on the ground and between, 0 shut, 1 and -1 open about the right and the left edge;
    force (points, 2, 2) on the lower block from the ground and on the upper from the lower, x, y [N].
    half_cycles: one for each uplift from rest and for each instant of impact, as in ensembles.
    events: (kind, time [s], contact), 1 on the ground, 2 between.
    """

    impacts: tuple[int, int]
    peak: tuple[float, float]
    settled: bool
    rotation: np.ndarray
    rate: np.ndarray
    state: np.ndarray
    force: np.ndarray
    loss: float


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
    run = run_two(
        _core.api_stack,
        stack.numbers,
        "two blocks",
        ground,
        end_time,
        output_step,
        scale=scale,
        tolerance=tolerance,
        start=start,
        room=room,
    )
    s = run.state
    _, low, high, _, settled, *_, half_cycles = run.counts
    first, second, _, work, loss = run.measures
    return StackResponse(
        **run.common,
        half_cycles=half_cycles,
        impacts=(low, high),
        peak=(first, second),
        settled=bool(settled),
        rotation=s[:, 0:2],
        rate=s[:, 2:4],
        state=s[:, 9:11].astype(int),
        force=s[:, 11:15].reshape(-1, 2, 2),
        work=work,
        loss=loss,
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
