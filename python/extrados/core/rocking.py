"""Rocking responses in the core (fortran/rocking): one with its history, or an ensemble."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from extrados import _core
from extrados.core.arch import FourHinge
from extrados.core.calls import integers, long_call, real
from extrados.core.errors import check, status_code, status_list
from extrados.core.ground import Ground, motion_set

OUTCOMES = ("no-hinging", "recovery", "collapse")
EVENTS = {1: "uplift", 2: "impact", 3: "peak", 4: "rest", 5: "collapse"}


@dataclass(frozen=True)
class Body:
    """A rocking structure as the core knows it: its kind and its flat parameter list."""

    kind: int
    parameters: np.ndarray


def arch_body(mechanism: FourHinge, restitution: float) -> Body:
    """The symmetric arch; restitution c_v in [0, 1]."""
    if not 0.0 <= restitution <= 1.0:
        raise ValueError(f"restitution is {restitution}, expected 0 to 1")
    hinge, mass, centroid, inertia = mechanism.links()
    return Body(1, np.concatenate([hinge.T.ravel(), mass, centroid.T.ravel(), inertia, [restitution]]))


def block_body(
    mass: float,
    inertia: float,
    height: float,
    toe_right: float,
    toe_left: float,
    restitution: tuple[float, float],
    linear: bool = False,
) -> Body:
    """A rigid block: mass [kg], inertia about its centre of mass [kg m^2], height of that centre and its
    distance from the toes [m], restitution of the impacts after which it rocks to +x and to -x; `linear` for
    the slender form of the equations."""
    values = [float(linear), mass, inertia, height, toe_right, toe_left, *restitution]
    if not (np.isfinite(values).all() and min(values[1:6]) > 0.0):
        raise ValueError(f"mass, inertia, height and toes of a block must be above zero, got {values[1:6]}")
    if not all(0.0 <= c <= 1.0 for c in restitution):
        raise ValueError(f"restitution is {restitution}, expected 0 to 1")
    return Body(2, np.array(values))


@dataclass(frozen=True)
class Response:
    """One response with its history.

    time (points) [s] and, at those times, rotation [rad], rate, acceleration, ground and vertical
    acceleration [m/s^2], kinetic and potential energy and the ledger (work of the ground minus loss at
    impacts) [J]. events: (kind, time [s], value); see core.rocking.EVENTS.
    """

    outcome: str
    half_cycles: int
    impacts: int
    peak: float
    peak_ratio: float
    stop_time: float
    steps: int
    rejected: int
    time: np.ndarray
    rotation: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    ground: np.ndarray
    vertical: np.ndarray
    kinetic: np.ndarray
    potential: np.ndarray
    ledger: np.ndarray
    events: list[tuple[str, float, float]]
    events_found: int  # may exceed the room for them
    work: float
    loss: float
    settled: bool  # it rests, has fallen, or can no longer fall
    interrupted: bool = False


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
    """Rock `body` under `ground` times `scale` until collapse or `end_time` [s]."""
    if not (end_time > 0.0 and output_step > 0.0 and 0.0 < tolerance < 1.0):
        raise ValueError("end time, output step and tolerance must be positive")
    motions = motion_set([ground])
    times = np.arange(int(np.floor(end_time / output_step * (1 + 1e-12))) + 1) * output_step
    out = long_call(
        _core.api_rocking.history,
        body.kind,
        real("body", body.parameters, (None,)),
        int(motions.sampled[0]),
        float(ground.start),
        float(ground.step),
        motions.samples,
        motions.breaks,
        motions.linear,
        motions.harmonic,
        float(scale),
        float(end_time),
        float(tolerance),
        int(start_side),
        float(start_rotation),
        float(start_rate),
        times,
        int(room),
    )
    outcome, state, points, kinds, event, events, summary, work, loss, status = out
    interrupted = status == status_code("cancelled")
    if not interrupted:
        check(status, "rocking response")
    found = min(events, room)
    state = state[:, :points]
    if not (np.isfinite(state).all() and np.isfinite(summary).all() and np.isfinite([work, loss]).all()):
        check(status_code("not_finite"), "rocking response")
    return Response(
        OUTCOMES[outcome[0]],
        int(outcome[1]),
        int(outcome[2]),
        *(float(x) for x in summary),
        int(outcome[3]),
        int(outcome[4]),
        times[:points],
        *state,
        [(EVENTS[int(k)], float(t), float(x)) for k, (t, x) in zip(kinds[:found], event.T[:found], strict=True)],
        int(events),
        work,
        loss,
        bool(outcome[5]),
        interrupted,
    )


@dataclass(frozen=True)
class Ensemble:
    """Results of many runs, one entry each; `failed` maps a run to the reason why it has no result."""

    outcome: np.ndarray  # 0 no hinging, 1 recovery, 2 collapse; -1 failed or not run
    half_cycles: np.ndarray
    impacts: np.ndarray
    peak: np.ndarray  # [rad], NaN where failed
    peak_ratio: np.ndarray
    stop_time: np.ndarray  # [s]
    steps: np.ndarray
    settled: np.ndarray  # False where end_time came before rest or fall
    interrupted: bool = False
    failed: dict[int, str] = field(default_factory=dict)


def ensemble(
    bodies: Sequence[Body],
    grounds: Sequence[Ground],
    run_body,
    run_motion,
    run_scale,
    end_time,
    *,
    start_rotation=0.0,
    tolerance: float = 1e-8,
    stop_when_safe: bool = True,
    threads: int = 1,
) -> Ensemble:
    """Run pairs of bodies and motions (0-based indices); results do not depend on `threads`.

    run_scale, end_time [s] and start_rotation (> 0 to +x) [rad] are one number or one for each run.

    With `stop_when_safe` a run ends once the motion is over and the energy left is below the barrier:
    outcome and peak are known then, the number of impacts is not.
    """
    motions = motion_set(grounds)
    n = len(run_body)
    run_body, run_motion = integers("run_body", run_body, n), integers("run_motion", run_motion, n)
    if n and not (
        0 <= run_body.min() and run_body.max() < len(bodies)
        and 0 <= run_motion.min() and run_motion.max() < len(grounds)
    ):  # fmt: skip
        raise ValueError("a run names a body or a motion that is not there")
    if threads < 1:
        raise ValueError(f"threads is {threads}, expected at least 1")
    out = long_call(
        _core.api_rocking.ensemble,
        integers("kind", [b.kind for b in bodies]),
        np.asfortranarray(np.stack([real("body", b.parameters, (None,)) for b in bodies], axis=1)),
        motions.sampled, motions.first, motions.segments, motions.start, motions.step,
        motions.samples, motions.breaks, motions.linear, motions.harmonic,
        run_body + np.int32(1), run_motion + np.int32(1),
        real("run_scale", np.broadcast_to(run_scale, n), (n,)),
        real("end_time", np.broadcast_to(end_time, n), (n,)),
        real("start_rotation", np.broadcast_to(start_rotation, n), (n,)),
        float(tolerance), int(stop_when_safe), int(threads),
    )  # fmt: skip
    outcome, peak, stop_time, run_status, status = out
    cancelled = status_code("cancelled")
    if status != cancelled:
        check(status, "rocking ensemble")
    if not (np.isfinite(peak).all() and np.isfinite(stop_time).all()):
        check(status_code("not_finite"), "rocking ensemble")
    bad = run_status != 0
    failed = {int(k): status_list()[int(run_status[k])][1] for k in np.flatnonzero(bad & (run_status != cancelled))}
    gone = np.where(bad, np.nan, 1.0)
    return Ensemble(
        np.where(bad, -1, outcome[0]),
        outcome[1],
        outcome[2],
        peak[0] * gone,
        peak[1] * gone,
        stop_time * gone,
        outcome[3],
        outcome[4] != 0,
        status == cancelled,
        failed,
    )
