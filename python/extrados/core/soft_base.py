"""A block on a compliant base, for the core."""

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
class SoftBase:
    """A block, mass [kg], inertia about its centre [kg m^2], height of the centre, distances of the left and the right edge
    from its foot [m], on a base of stiffness [N/m^2] and damping [N s/m^2] per length, no tension: a bed, or with `edges`
    half of both under each edge. linear: the form of slender blocks."""

    mass: float
    inertia: float
    height: float
    toe_left: float
    toe_right: float
    stiffness: float
    damping: float
    edges: bool = False
    linear: bool = False

    @property
    def numbers(self) -> np.ndarray:
        """The flat list (9,) of the core, SI."""
        return np.array(
            [
                self.mass,
                self.inertia,
                self.height,
                self.toe_left,
                self.toe_right,
                self.stiffness,
                self.damping,
                float(self.edges),
                float(self.linear),
            ]
        )

    @classmethod
    def of(cls, body: Body) -> "SoftBase":
        """What `soft_base_body` made a body of."""
        mass, inertia, height, left, right, stiffness, damping, edges, linear = (float(x) for x in body.parameters[:9])
        return cls(mass, inertia, height, left, right, stiffness, damping, bool(edges), bool(linear))


#: Kind of bodies on a compliant base
KIND = lists.number("rocking_body", "soft_base")


def soft_base_body(base: SoftBase, critical: tuple[float, float], friction: float = np.inf) -> Body:
    """The block for ensembles; critical: rotations from which gravity takes it down, to +x and to -x, both above zero [rad]; friction:
    coefficient of the base, infinite where it does not slide.

    A member starts at its rotation, free to sink. A half cycle begins where the edge away from which it leans lifts, unless
    the last one was to the same side. `joints`: what the base must carry, `leaves_at` where the block is airborne."""
    if not (np.isfinite(critical).all() and min(critical) > 0.0 and friction > 0.0):
        raise ValueError(f"critical rotations are {critical} and friction is {friction}: expected values above zero")
    return Body(KIND, np.array([*base.numbers, *critical, min(friction, np.finfo(float).max)]))


@dataclass(frozen=True)
class BaseContact:
    """What the base does: force up [N], its moment about the foot of the centre over the cosine of the rotation [N m], energy
    stored [J], power taken up [W], range that pushes, from the foot [m], greatest pressure per length [N/m] or force of an
    edge [N]."""

    force: float
    moment: float
    stored: float
    spent: float
    range: tuple[float, float]
    most: float


@dataclass(frozen=True, kw_only=True)
class SoftBaseResponse(Course):
    """A response: at the times of the course rotation, positive to +x [rad], sinking [m], their rates, force of the base (points, 2)
    to +x and up [N], range of the base that pushes (points, 2), from the foot of the centre [m], greatest pressure per length [N/m]
    or force of an edge [N]; the potential energy includes the springs', the ledger subtracts what the base took up, `spent` [J].
    peak: of both coordinates; end: rotation, sinking and their rates; landings of the left and the right edge; half_cycles: see
    soft_base_body; events: (kind, time [s], edge), -1 left, 1 right."""

    landings: tuple[int, int]
    peak: tuple[float, float]
    end: np.ndarray
    rotation: np.ndarray
    sinking: np.ndarray
    rate: np.ndarray
    sinking_rate: np.ndarray
    force: np.ndarray
    range: np.ndarray
    most: np.ndarray
    spent: float


def base_contact(base: SoftBase, rotation: float, sinking: float, rate: float = 0.0, sinking_rate: float = 0.0) -> BaseContact:
    """What the base does in a state: rotation [rad], sinking [m] and their rates."""
    values, status = _core.api_soft_base.contact(
        real("base", base.numbers, (9,)), real("state", [rotation, sinking, rate, sinking_rate], (4,))
    )
    check(status, "contact of a compliant base")
    force, moment, stored, spent, low, high, most = (float(x) for x in values)
    return BaseContact(force, moment, stored, spent, (low, high), most)


def base_held(base: SoftBase, rotation: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The block held at each rotation (n) [rad] and free to sink under its weight: how far it sinks [m], the energy of weight and
    springs [J], and the moment that turns it back from a rotation to +x [N m]."""
    values, status = _core.api_soft_base.held(real("base", base.numbers, (9,)), real("rotation", np.atleast_1d(rotation), (None,)))
    check(status, "statics of a compliant base")
    return values[0], values[1], values[2]


def soft_base_start(base: SoftBase, rotation: float) -> tuple[float, float, float, float]:
    """The state of a block that is held at a rotation [rad] and free to sink, for `soft_base_history`."""
    return rotation, float(base_held(base, rotation)[0][0]), 0.0, 0.0


def soft_base_history(
    base: SoftBase,
    ground: Ground,
    end_time: float,
    output_step: float,
    *,
    scale: float = 1.0,
    tolerance: float = 1e-8,
    start: npt.ArrayLike = (0.0, 0.0, 0.0, 0.0),
    room: int = 20000,
) -> SoftBaseResponse:
    """Rock the block under `ground` times `scale` until collapse or `end_time` [s]; start (4,): rotation [rad], sinking [m]
    and their rates; output_step [s]; room: most events that are kept."""
    run = run_two(
        _core.api_soft_base,
        base.numbers,
        "a block on a compliant base",
        ground,
        end_time,
        output_step,
        scale=scale,
        tolerance=tolerance,
        start=start,
        room=room,
    )
    s = run.state
    _, left, right, _, half_cycles, *_ = run.counts
    turn, sunk, _, *end, work, spent = run.measures
    return SoftBaseResponse(
        **run.common,
        half_cycles=half_cycles,
        landings=(left, right),
        peak=(turn, sunk),
        end=np.array(end),
        rotation=s[:, 0],
        sinking=s[:, 1],
        rate=s[:, 2],
        sinking_rate=s[:, 3],
        force=s[:, 9:11],
        range=s[:, 11:13],
        most=s[:, 13],
        work=work,
        spent=spent,
    )
