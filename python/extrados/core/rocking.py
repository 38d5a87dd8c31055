"""Rocking responses in the core (fortran/rocking): one with its history, or an ensemble."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, cast

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.arch import FourHinge
from extrados.core.calls import indices, long_call, real, room_for, thread_count
from extrados.core.errors import check, status_code, status_list
from extrados.core.ground import Ground, MotionSet, as_motion_set
from extrados.core.handles import Owner

__all__ = [
    "EVENTS",
    "FAILED",
    "OUTCOMES",
    "Body",
    "BodyList",
    "Ensemble",
    "Ground",
    "JointDemand",
    "MotionSet",
    "Response",
    "arch_body",
    "block_body",
    "ensemble",
    "history",
    "limits",
    "watched_body",
]

#: Outcomes by their number, from 0; events by theirs.
#: End of a motion, and its words in the order of the core
Outcome = Literal["no-hinging", "recovery", "collapse"]
OUTCOMES = cast(tuple[Outcome, ...], tuple(lists.words("rocking_outcome").values()))
#: Outcome of a run that failed or was not run
FAILED = -1
EVENTS = lists.words("rocking_event")


@dataclass(frozen=True)
class Body:
    """A rocking structure as the core knows it: its kind, its flat parameter list, and how many restraints it has."""

    kind: int
    parameters: np.ndarray
    restraints: int = 0


def arch_body(mechanism: FourHinge, restitution: float) -> Body:
    """The symmetric arch; restitution c_v in [0, 1]."""
    if not 0.0 <= restitution <= 1.0:
        raise ValueError(f"restitution is {restitution}, expected 0 to 1")
    hinge, (mass, x, y, inertia) = mechanism.links()
    centroid = np.vstack([x, y])
    return Body(lists.number("rocking_body", "arch"), np.concatenate([hinge.T.ravel(), mass, centroid.T.ravel(), inertia, [restitution]]))


def block_body(
    mass: float,
    inertia: float,
    height: float,
    toe_right: float,
    toe_left: float,
    restitution: tuple[float, float],
    linear: bool = False,
    slope: float = 0.0,
) -> Body:
    """A rigid block: mass [kg], inertia about its centre of mass [kg m^2], height of that centre and its
    distance from the toes [m], restitution of the impacts after which it rocks to +x and to -x; `linear` for
    the slender form of the equations; slope of the base up to the right [rad], on which height and distances are counted."""
    values = [float(linear), mass, inertia, height, toe_right, toe_left, *restitution, slope]
    if not (np.isfinite(values).all() and min(values[1:6]) > 0.0):
        raise ValueError(f"mass, inertia, height and toes of a block must be above zero, got {values[1:6]}")
    if not all(0.0 <= c <= 1.0 for c in restitution):
        raise ValueError(f"restitution is {restitution}, expected 0 to 1")
    return Body(lists.number("rocking_body", "block"), np.array(values))


@dataclass(frozen=True)
class JointDemand:
    """What runs demanded of the joints of a watched structure, up to its critical rotation; of one run or one entry for each.

    friction: greatest coefficient needed while it rocks, infinite in tension; outside: how far the thrust line left a joint
    over its length, below 0 where it stayed inside. slips_at, leaves_at: first time [s] at which the joints lack friction
    (also at rest), at which the line leaves by more than the tolerance (also at rest); -1: never. slips, leaves: place of that joint
    among those watched, -1 at rest, or never.
    """

    friction: Any
    outside: Any
    slips_at: Any
    leaves_at: Any
    slips: Any
    leaves: Any


def _demand(numbers: np.ndarray) -> JointDemand:
    """From the core's list (6) or (6, runs)."""
    huge = 0.5 * np.finfo(float).max
    friction, outside = (np.where(x > huge, np.inf, x) for x in numbers[:2])
    slips, leaves = (x.astype(int) - 1 for x in numbers[4:])
    return JointDemand(friction, outside, numbers[2], numbers[3], slips, leaves)


def watched_body(
    bare: Body,
    values: tuple[np.ndarray, np.ndarray],
    critical: tuple[float, float],
    friction: np.ndarray,
    tolerance: float,
    slides: tuple[float, float] = (np.inf, np.inf),
    opens: tuple[float, float] = (np.inf, np.inf),
) -> Body:
    """A structure whose joints are watched while it rocks (fortran/rocking/watch.f90).

    values (steps + 1, joints, 3 + restraints, 3), rocking to +x and to -x, at equal steps from rest to the `critical` rotation [rad]:
    forces at each joint by input (1 + a_v/g; side a_h [m/s^2]; squared rate [rad^2/s^2]; force of each restraint [N, N m]) and quantity
    (compression [N]; shear [N]; moment about the joint's first end over its length [N]). friction (joints): coefficient that they
    have; tolerance: how far the thrust line may leave a joint, over its length; slides, opens: ground acceleration that slides the
    resting structure, or opens hinges of another mechanism, the way it would rock to +x, to -x [m/s^2].
    """
    steps, joints = values[0].shape[0] - 1, values[0].shape[1]
    if values[1].shape != values[0].shape or values[0].shape[2:] != (3 + bare.restraints, 3) or steps < 4:
        raise ValueError(
            f"the two arrays of values have the shapes {values[0].shape} and {values[1].shape}, with {bare.restraints} restraints"
        )
    most = np.finfo(float).max
    numbers = [
        [bare.kind, len(bare.parameters)],
        bare.parameters,
        np.minimum([tolerance, *slides, *opens, joints, steps, *critical, bare.restraints, *friction], most),
        *(v.transpose(0, 2, 3, 1).ravel() for v in values),
    ]
    return Body(lists.number("rocking_body", "watched"), np.concatenate([np.asarray(x, dtype=float) for x in numbers]), bare.restraints)


class BodyList(Owner):
    """Rocking structures in the core, to be used by any number of calls and threads."""

    what = "list of rocking structures"

    def __init__(self, bodies: Sequence[Body]):
        if not bodies:
            raise ValueError("a list of rocking structures must contain at least one")
        handle, status = _core.api_rocking.create(len(bodies))
        check(status, self.what)
        super().__init__(handle)
        self.count = len(bodies)
        try:
            for k, body in enumerate(bodies):
                status = _core.api_rocking.body(handle, k + 1, body.kind, real("body", body.parameters, (None,)))
                check(status, f"rocking structure {k}")
        except BaseException:
            self.close()
            raise

    def __len__(self) -> int:
        return self.count


def _as_body_list(bodies: "Sequence[Body] | BodyList") -> BodyList:
    return bodies if isinstance(bodies, BodyList) else BodyList(bodies)


def limits(body: Body) -> tuple[tuple[float, float], tuple[float, float]]:
    """Rotations of unstable equilibrium and those taken as collapse, each to +x and to -x [rad]."""
    with BodyList([body]) as bodies:
        critical, limit, status = _core.api_rocking.limits(bodies.handle, 1)
    check(status, "rocking structure")
    return (float(critical[0]), float(critical[1])), (float(limit[0]), float(limit[1]))


@dataclass(frozen=True, kw_only=True)
class Course:
    """What every response has: at `time` (points) [s] ground and vertical acceleration [m/s^2], kinetic and potential energy and the
    ledger, work of the ground minus what the structure lost [J]; events: (kind, time [s], value); see EVENTS."""

    outcome: Outcome
    half_cycles: int
    stop_time: float
    steps: int
    time: np.ndarray
    ground: np.ndarray
    vertical: np.ndarray
    kinetic: np.ndarray
    potential: np.ndarray
    ledger: np.ndarray
    events: list[tuple[str, float, float]]
    events_found: int  # may exceed the room for them
    work: float
    interrupted: bool = False


@dataclass(frozen=True, kw_only=True)
class Response(Course):
    """One response with its history.

    At the times of the course rotation [rad], rate, acceleration; the ledger subtracts the loss at impacts and what restraints
    took up, `spent` [J]. Of restraints: `stored` energy (points) beyond that of their prestress [J], `forces` (restraints,
    points), the least and greatest of them at any time, and the path that stays (restraints) [N, m; of turns N m, rad].
    """

    impacts: int
    peak: float
    peak_ratio: float
    rejected: int
    rotation: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    loss: float
    spent: float
    stored: np.ndarray
    forces: np.ndarray
    least_force: np.ndarray
    greatest_force: np.ndarray
    permanent: np.ndarray
    settled: bool  # it rests, has fallen, or can no longer fall
    joints: JointDemand | None = None  # of a watched structure


def check_run(end_time: float, output_step: float, tolerance: float, scale: float) -> None:
    """ValueError where a run has no end, no outputs, no tolerance or no scale."""
    if not (0.0 < end_time < np.inf and 0.0 < output_step < np.inf and 0.0 < tolerance < 1.0 and np.isfinite(scale)):
        raise ValueError("end time, output step and tolerance must be positive, and the scale must be a number")


def events_of(kinds: np.ndarray, event: np.ndarray, found: int) -> list[tuple[str, float, float]]:
    """The `found` events as (kind, time [s], value). kinds (room): their numbers; event (2, room): their times [s] and values."""
    return [(EVENTS[int(k)], float(t), float(x)) for k, (t, x) in zip(kinds[:found], event.T[:found], strict=True)]


def output_times(end_time: float, output_step: float, rows: int) -> np.ndarray:
    """Output times (steps) from 0 to the end [s]; refuses histories of `rows` values that do not fit into memory."""
    room_for(rows, int(min(end_time / output_step, 1e12)))
    return np.arange(int(np.floor(end_time / output_step * (1 + 1e-12))) + 1) * output_step


def history(
    body: Body,
    ground: Ground,
    end_time: float,
    output_step: float,
    *,
    scale: float = 1.0,
    tolerance: float = 1e-8,
    start_side: int = 1,
    start_rotation: float = 0.0,
    start_rate: float = 0.0,
    room: int = 20000,
) -> Response:
    """Rock `body` under `ground` times `scale` until collapse or `end_time` [s].

    It starts with `start_rotation` >= 0 [rad] and `start_rate` [rad/s] to the side `start_side`, 1 to +x or -1. `room`:
    events kept.
    """
    check_run(end_time, output_step, tolerance, scale)
    if start_side not in (1, -1) or not start_rotation >= 0.0:
        raise ValueError(f"start rotation is {start_rotation} rad to side {start_side}: expected 0 or above, to side 1 or -1")
    if not 0 <= room <= 10**7:
        raise ValueError(f"number of saved events is {room}, expected 0 to 10,000,000")
    times = output_times(end_time, output_step, 8)
    with MotionSet([ground]) as motions, BodyList([body]) as bodies:
        counts, measures, state, kept, kinds, event, status = long_call(
            _core.api_rocking.history,
            bodies.handle,
            motions.handle,
            np.array([1, 1], dtype=np.int32),
            np.array([scale, end_time, tolerance], dtype=float),
            real("start", [start_side, start_rotation, start_rate], (3,)),
            times,
            max(int(room), 1),
            body.restraints,
        )
    outcome, half_cycles, impacts, steps, rejected, settled, points, events = (int(k) for k in counts)
    interrupted = status == status_code("cancelled")
    if not interrupted:
        check(status, "rocking response")
    state = state[:, :points]
    if not (np.isfinite(state).all() and np.isfinite(measures).all()):
        check(status_code("not_finite"), "rocking response")
    peak, peak_ratio, stop_time, work, loss, spent = (float(x) for x in measures[:6])
    rotation, rate, acceleration, shaking, vertical, kinetic, potential, ledger, stored = state[:9]
    return Response(
        outcome=OUTCOMES[outcome],
        half_cycles=half_cycles,
        impacts=impacts,
        peak=peak,
        peak_ratio=peak_ratio,
        stop_time=stop_time,
        steps=steps,
        rejected=rejected,
        time=times[:points],
        rotation=rotation,
        rate=rate,
        acceleration=acceleration,
        ground=shaking,
        vertical=vertical,
        kinetic=kinetic,
        potential=potential,
        ledger=ledger,
        events=events_of(kinds, event, min(events, room)),
        events_found=events,
        work=work,
        loss=loss,
        spent=spent,
        stored=stored,
        forces=state[9:],
        least_force=kept[0],
        greatest_force=kept[1],
        permanent=kept[2],
        settled=bool(settled),
        interrupted=interrupted,
        joints=_demand(measures[6:]) if body.kind == lists.number("rocking_body", "watched") else None,
    )


@dataclass(frozen=True)
class Ensemble:
    """Results of many runs, one entry each; `failed` maps a run to the reason why it has no result."""

    outcome: np.ndarray  # place in OUTCOMES, or FAILED
    half_cycles: np.ndarray
    impacts: np.ndarray
    peak: np.ndarray  # [rad], NaN where failed
    peak_ratio: np.ndarray
    stop_time: np.ndarray  # [s]
    steps: np.ndarray
    settled: np.ndarray  # False where end_time came before rest or fall
    joints: JointDemand  # of the structures that are watched
    interrupted: bool = False
    failed: dict[int, str] = field(default_factory=dict)


def ensemble(
    bodies: Sequence[Body] | BodyList,
    grounds: Sequence[Ground] | MotionSet,
    run_body: npt.ArrayLike,
    run_motion: npt.ArrayLike,
    run_scale: npt.ArrayLike,
    end_time: npt.ArrayLike,
    *,
    start_rotation: npt.ArrayLike = 0.0,
    tolerance: float = 1e-8,
    stop_when_safe: bool = True,
    threads: int = 1,
) -> Ensemble:
    """Run pairs of bodies and motions (0-based indices); results do not depend on `threads`.

    run_body, run_motion (runs): which body moves under which motion. bodies and grounds may be sets made before: they are
    then not handed over again. run_scale, end_time [s] and start_rotation (> 0 to +x) [rad] are one number or one for each
    run (runs).

    With `stop_when_safe` a run ends once the motion is over and the energy left is below the barrier:
    outcome and peak are known then, the number of impacts is not.
    """
    n = len(np.asarray(run_body))
    if not n:
        raise ValueError("an ensemble requires at least one run")
    with np.errstate(invalid="ignore"):
        values = {
            name: real(name, np.broadcast_to(np.asarray(value, dtype=float), (n,)), (n,))
            for name, value in (("run_scale", run_scale), ("end_time", end_time), ("start_rotation", start_rotation))
        }
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance is {tolerance}, expected between 0 and 1")
    structures, motions = _as_body_list(bodies), as_motion_set(grounds)
    out = long_call(
        _core.api_rocking.ensemble,
        structures.handle,
        motions.handle,
        indices("run_body", run_body, len(structures), (n,)),
        indices("run_motion", run_motion, len(motions), (n,)),
        *values.values(),
        float(tolerance),
        int(stop_when_safe),
        thread_count(threads),
    )
    outcome, peak, stop_time, demand, run_status, status = out
    cancelled = status_code("cancelled")
    if status != cancelled:
        check(status, "rocking ensemble")
    if not (np.isfinite(peak).all() and np.isfinite(stop_time).all()):
        check(status_code("not_finite"), "rocking ensemble")
    bad = run_status != 0
    failed = {int(k): status_list()[int(run_status[k])][1] for k in np.flatnonzero(bad & (run_status != cancelled))}
    gone = np.where(bad, np.nan, 1.0)
    return Ensemble(
        np.where(bad, FAILED, outcome[0]),
        outcome[1],
        outcome[2],
        peak[0] * gone,
        peak[1] * gone,
        stop_time * gone,
        outcome[3],
        outcome[4] != 0,
        _demand(demand),
        status == cancelled,
        failed,
    )
